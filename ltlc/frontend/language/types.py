"""The types of topics: from `Odometry.pose.pose.position` to a message, a path in it, and the kind of value there."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic, Help
from ltlc.base.fixes import respell, write, writing
from ltlc.base.nearest import is_slip
from ltlc.base.source import Source, Span
from ltlc.dataclass import dataclass
from ltlc.frontend.syntax import tree as syntax
from ltlc.inputs.messages.definitions import PLACEHOLDER, STRINGS, FieldType, Message, MessageTypes
from ltlc.specification.expressions import Bytes, Each, Field, PathStep
from ltlc.specification.wire import DOUBLES, PRIMITIVES, Numbers

_PART = re.compile(r"[^.\[\]]+|\[[^\]]*\]?|\.")
MOST_CHOICES = 5
"""A message of more fields is not one to choose a fix from."""

MAX_DIGITS = 9
"""How many digits an index may have; no message has so many elements."""

_INDEX = re.compile(rf"\[([0-9]{{1,{MAX_DIGITS}}})\]")


@dataclass(frozen=True, slots=True)
class TypePath:
    """A message type by its full name, a path in it, and what is at its end: a kind of value (see `value_kind`).

    The kind is `message` if there is no path and the message is not a value by itself.

    If that is a number, or made of them, `numbers` are the possible ones.
    """

    message: str
    path: tuple[PathStep, ...]
    kind: str
    numbers: Numbers


def value_kind(type_: FieldType, types: MessageTypes) -> str | None:
    """`number`, `boolean`, `string`, and these as a plural, `vector`, `orientation`; None for what is not a value."""
    if type_.is_list:
        return _plural(value_kind(FieldType(type_.base), types))
    if type_.base in PRIMITIVES:
        return "number"
    if type_.base in STRINGS:
        return "string"
    if type_.base in ("bool", "boolean"):
        return "boolean"
    return _structure_kind(type_.base, types)


def _plural(kind: str | None) -> str | None:
    return f"{kind}s" if kind in ("number", "boolean", "string") else None


def _structure_kind(message: str, types: MessageTypes) -> str | None:
    """The components of a vector are numbers of one type."""
    known = types.messages.get(message)
    if known is None or _component(known) is None:
        return None
    return {"x,y,z": "vector", "x,y,z,w": "orientation"}.get(",".join(known.fields))


def _component(message: Message) -> Numbers | None:
    """The numbers that every field of `message` is one of, if they are all of one type."""
    found = set(message.fields.values())
    only = found.pop() if len(found) == 1 else None
    return None if only is None or only.is_list else PRIMITIVES.get(only.base)


def numbers_of_type(type_: FieldType, types: MessageTypes) -> Numbers:
    """The numbers that a value of `type_`, or each number in it, can be."""
    structure = types.messages.get(type_.base)
    return PRIMITIVES.get(type_.base) or (structure and _component(structure)) or DOUBLES


def message_type(source: Source, name: syntax.Word, types: MessageTypes) -> str | Diagnostic:
    """The full name of the message type that `name` stands for."""
    found = types.find(name.text)
    if len(found) == 1:
        return found[0]
    if found:
        message = f"several packages define `{name.text}`: {', '.join(found)}"
        return diagnostic(
            "LTL202", source, name.span, message, help=write(*(writing(name.span, full) for full in found))
        )
    help = _made_of(name.text, types) or _with_path(name, types) or _near(name, types)
    return diagnostic(
        "LTL201", source, name.span, f"no known package defines the message type `{name.text}`", help=help
    )


def _with_path(name: syntax.Word, types: MessageTypes) -> Help | None:
    """The same name with a path after it, if `/` stands where `.` has to."""
    first, *rest = name.text.split("/")
    return write(writing(name.span, ".".join([first, *rest]))) if rest and types.find(first) else None


def _near(name: syntax.Word, types: MessageTypes) -> Help:
    """A name that may be meant, unless the whole package is unknown; otherwise, how to add messages."""
    adding = "`--msg-path` adds the messages of a package or a bag"
    package, slash, _ = name.text.partition("/")
    packages = {full.partition("/")[0] for full in types.messages}
    if not slash:
        near = respell(name.span, name.text, types.short_names)
    elif package in packages or any(is_slip(package, known) for known in packages):
        near = respell(name.span, _full(name.text), types.messages)
    else:
        near = None
    return Help(adding) if near is None else Help(f"{near.text} Otherwise, {adding}", near.fixes)


def _made_of(name: str, types: MessageTypes) -> str:
    """What the topics of an action or a service called `name` carry, if it is one."""
    if types.find(f"{name}_FeedbackMessage"):
        return f"its feedback comes as `{name}_FeedbackMessage`, its status as `action_msgs/GoalStatusArray`"
    return f"its calls come as `{name}_Event` on `…/_service_event`" if types.find(f"{name}_Event") else ""


def _full(name: str) -> str:
    package, slash, short = name.rpartition("/")
    return f"{package.removesuffix('/msg')}/msg/{short}" if slash else name


def type_path(source: Source, word: syntax.Word, types: MessageTypes) -> TypePath | Diagnostic:
    """The message, path and kind of value that `word` (`Odometry.pose.pose.position`) stands for."""
    parts = [syntax.Word(_part_span(word, m), m.group()) for m in _PART.finditer(word.text) if m.group() != "."]
    message = message_type(source, parts[0], types)
    if isinstance(message, Diagnostic):
        return message
    current, path = FieldType(message), []
    for part in parts[1:]:
        if Each() in path and current.length == 0:
            return _nested(source, part, current)
        step = _index(source, part, current) if part.text.startswith("[") else field_of(source, part, current, types)
        if isinstance(step, Diagnostic):
            return step
        path.append(step[0])
        current = step[1]
    if path[-1:] == [Each()]:
        path.pop()
        current = FieldType(current.base, 0)
    in_each = Each() in path
    if (inner := _bytes_in(current, types, in_each)) is not None:
        return TypePath(message, (*path, *inner, Bytes()), "strings" if in_each else "string", DOUBLES)
    if in_each and current.is_list:
        return _nested(source, parts[-1], current)
    kind = _plural(value_kind(current, types)) if in_each else value_kind(current, types)
    if kind is None and not path:
        return TypePath(message, (), "message", DOUBLES)
    if kind is None:
        return _no_value(source, word, current, types)
    return TypePath(message, tuple(path), kind, numbers_of_type(current, types))


def _bytes_in(type_: FieldType, types: MessageTypes, in_each: bool) -> tuple[str, ...] | None:
    """The way to the bytes of an id: a message of nothing else, or in each element of an array they themselves."""
    known = None if type_.is_list else types.messages.get(type_.base)
    if known is not None and len(known.fields) == 1:
        ((name, only),) = known.fields.items()
        return (name,) if _are_bytes(only) else None
    return () if in_each and _are_bytes(type_) else None


def _are_bytes(type_: FieldType) -> bool:
    return type_.base == "uint8" and bool(type_.length)


def _nested(source: Source, part: syntax.Word, type_: FieldType) -> Diagnostic:
    """An array in each message of an array."""
    message = f"`{type_}` in each element of an array: nested arrays have no value"
    return diagnostic("LTL204", source, part.span, message, help="choose an element of the outer array, as in `[0]`")


def messages_on(field: Field, types: MessageTypes) -> list[str]:
    """The messages that the path of `field` leads through, the outermost first."""
    found = [field.message]
    for step in field.path:
        if isinstance(step, str):
            found.append(types.messages[found[-1]].fields[step].base)
    return [message for message in found if message in types.messages]


def _part_span(word: syntax.Word, match: re.Match[str]) -> Span:
    return Span(word.span.start + match.start(), word.span.start + match.end())


def _index(source: Source, part: syntax.Word, type_: FieldType) -> tuple[PathStep, FieldType] | Diagnostic:
    index = _INDEX.fullmatch(part.text)
    if index is None and part.text != "[]":
        help = "an index is written `[0]`, all elements `[]`"
        if ":" in part.text:
            help = f"declare the whole array, and write `NAME{part.text}` where you use it"
        return diagnostic("LTL212", source, part.span, f"`{part.text}` is not an index", help=help)
    if type_.length is None:
        return diagnostic("LTL212", source, part.span, f"`{type_}` is not an array: it has no elements")
    if index is None:
        return Each(), FieldType(type_.base)
    number = int(index.group(1))
    if 0 < type_.length <= number:
        message = f"the array has {type_.length} elements, `[0]` to `[{type_.length - 1}]`"
        return diagnostic("LTL212", source, part.span, message)
    return number, FieldType(type_.base)


def field_of(
    source: Source, part: syntax.Word, type_: FieldType, types: MessageTypes
) -> tuple[PathStep, FieldType] | Diagnostic:
    """The field of a value of `type_` that `part` names, and its type."""
    if type_.is_list:
        choice = f"choose an element, as in `[0].{part.text}`, or all, as in `[].{part.text}`"
        return diagnostic("LTL203", source, part.span, f"`{type_}` is an array: its elements have fields", help=choice)
    known = types.messages.get(type_.base)
    if known is None:
        return diagnostic("LTL203", source, part.span, f"a value of type `{type_}` has no fields")
    if part.text in known.fields:
        return part.text, known.fields[part.text]
    near = respell(part.span, part.text, known.fields, is_closed=True)
    message = f"`{type_.base}` has no field `{part.text}`"
    help = near or _inside(part, known, types) or _fields_help(part, known)
    return diagnostic("LTL203", source, part.span, message, help=help)


def _inside(part: syntax.Word, known: Message, types: MessageTypes) -> Help | None:
    """The path to the field called `part` in the fields of a message; None if none, or several as deep, have one."""
    level = [("", known)]
    while level:
        inner = [
            (f"{path}{name}.", types.messages[field.base])
            for path, of in level
            for name, field in of.fields.items()
            if not field.is_list and field.base in types.messages and field.base != "std_msgs/msg/Header"
        ]
        found = [f"{path}{part.text}" for path, of in inner if part.text in of.fields]
        if found:
            return write(writing(part.span, found[0])) if len(found) == 1 else None
        level = inner
    return None


def _fields_help(part: syntax.Word, known: Message) -> Help:
    """The fields to choose from, each a fix if they are few."""
    if known.is_partial:
        return Help("only the fields that rule packs read are known of it: `--msg-path` adds its package or a bag")
    if not known.fields:
        return Help("it has no fields")
    fixes = tuple(writing(part.span, name) for name in known.fields) if len(known.fields) <= MOST_CHOICES else ()
    return Help(f"its fields are {', '.join(f'`{name}`' for name in known.fields)}", fixes)


def _no_value(source: Source, word: syntax.Word, type_: FieldType, types: MessageTypes) -> Diagnostic:
    message = f"the path ends in `{type_}`, which is not a value"
    whole = f"{word.text}[]" if type_.is_list else word.text
    inside = values_in(type_.base, types) if type_.base in types.messages else []
    help = (
        f"continue to a value, as in `{whole}.{inside[0]}`"
        if inside
        else "numbers, booleans, strings and vectors are values"
    )
    return diagnostic("LTL204", source, word.span, message, help=help)


def values_in(message: str, types: MessageTypes) -> list[str]:
    """The paths to single values in a message, numbers and vectors first."""
    singles = ("number", "vector", "orientation"), ("boolean", "string")
    found = values_of(message, types)
    return [path for kinds in singles for path, kind in found if kind in kinds]


def values_of(message: str, types: MessageTypes) -> list[tuple[str, str]]:
    """The paths in a message that lead to values, those of all elements of an array included, with their kinds.

    Those at the top come first, and times last; a header is omitted, and what stands for no field at all.
    """
    found = list(_values(message, types, in_each=False))
    return sorted(found, key=lambda value: (value[0].endswith("sec"), value[0].count(".")))


def _values(message: str, types: MessageTypes, in_each: bool) -> Iterator[tuple[str, str]]:
    for name, field in types.messages[message].fields.items():
        kind = _plural(value_kind(field, types)) if in_each else value_kind(field, types)
        if name == PLACEHOLDER or field.base == "std_msgs/msg/Header" or (in_each and field.is_list):
            continue
        if kind is not None:
            yield name, kind
        elif field.base in types.messages:
            inner = _values(field.base, types, in_each or field.is_list)
            yield from ((f"{name}{'[]' if field.is_list else ''}.{path}", kind) for path, kind in inner)
