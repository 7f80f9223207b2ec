"""What can stand after a dot: attributes of objects, components of values, constants and fields of messages."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from ltlc.base.source import Source
from ltlc.frontend.language.primitives import MODELLED, PRIMITIVES, RELATIONS, unit
from ltlc.frontend.language.values import Orientation, Vector
from ltlc.frontend.syntax import tree as syntax
from ltlc.frontend.syntax.parse import parse
from ltlc.inputs.messages.definitions import FieldType, MessageTypes
from ltlc.interfaces.editor.document import Document

_PART = re.compile(r"[^.\[\]]+|\[[^\]]*\]")
_TEMPLATE = re.compile(r"\{(\w+)\}")


class Suggestion(NamedTuple):
    """What may be written, its kind, and its description."""

    text: str
    kind: str
    detail: str = ""


def members(document: Document, base: str, variables: Mapping[str, str]) -> Iterator[Suggestion]:
    """What may follow `base` and a dot, where `variables` stand for names."""
    node = _reference(base, variables)
    if node is None:
        yield from _constants(document, base)
        return
    name, steps = node.name.text, [step.text for step in node.steps if isinstance(step, syntax.Word)]
    names = document.reading.checker.names
    if len(steps) < len(node.steps):
        return
    if name not in names.associations and name not in names.declarations:
        if not steps and not document.is_thing(name) and document.reading.checker.types.find(name):
            yield from _constants(document, base)
        elif not steps or steps[0] in PRIMITIVES:
            yield from _of_thing(document, name, steps)
            return
    yield from _components(document, node)


def _reference(base: str, variables: Mapping[str, str]) -> syntax.Reference | None:
    """`base` as a part of a specification."""
    written = _TEMPLATE.sub(lambda match: variables.get(match[1], match[1]), base)
    name, dot, rest = written.partition(".")
    tree, _ = parse(Source("", f"a = {variables.get(name, name)}{dot}{rest}"))
    value = tree.commands[0].value if tree.commands and isinstance(tree.commands[0], syntax.Association) else None
    return value if isinstance(value, syntax.Reference) else None


def _of_thing(document: Document, name: str, steps: list[str]) -> Iterator[Suggestion]:
    """The primitives of an object, or a robot."""
    match steps:
        case []:
            for primitive in PRIMITIVES:
                yield Suggestion(primitive, "attribute", unit([primitive]))
            added = document.reading.checker.names.models.get(name, {})
            yield from (
                Suggestion(attribute, "attribute", "of the model") for attribute in added if attribute not in MODELLED
            )
        case [relation] if relation in RELATIONS:
            yield from (Suggestion(other, "object") for other in document.things() if other != name)
        case ["orientation"]:
            yield from (Suggestion(angle, "attribute", "rad") for angle in ("roll", "pitch", "yaw"))
        case ["velocity"]:
            yield from (Suggestion(part, "attribute") for part in ("x", "y", "z", "linear", "angular"))
        case ["position"] | ["velocity", "linear" | "angular"]:
            yield from (Suggestion(axis, "attribute", unit(steps)) for axis in "xyz")
        case _:
            pass


def _components(document: Document, node: syntax.Reference) -> Iterator[Suggestion]:
    match document.value(node):
        case Vector():
            yield from (Suggestion(axis, "attribute") for axis in "xyz")
        case Orientation(_, _, angles):
            yield from (Suggestion(angle, "attribute", "rad") for angle, _ in angles)
            yield from (Suggestion(axis, "attribute") for axis in "xyzw")
        case _:
            pass


def _constants(document: Document, message: str) -> Iterator[Suggestion]:
    """The constants of the messages of that name."""
    types = document.reading.checker.types
    for full in types.find(message):
        for name, value in types.messages[full].constants.items():
            yield Suggestion(name, "constant", f"{value:g}" if isinstance(value, float) else str(value))


def fields_after(written: str, types: MessageTypes) -> Iterator[Suggestion]:
    """The fields of what the type and path `written` lead to."""
    message, *parts = _PART.findall(written)
    full = types.find(message)
    current = FieldType(full[0]) if len(full) == 1 else None
    for part in parts:
        current = current and _along(current, part, types)
    known = types.messages.get(current.base) if current is not None and not current.is_list else None
    for name, type_ in known.fields.items() if known else ():
        yield Suggestion(name, "field", str(type_))


def _along(type_: FieldType, part: str, types: MessageTypes) -> FieldType | None:
    """The type of a field, or of an element, of a value of `type_`."""
    if part.startswith("["):
        return FieldType(type_.base) if type_.is_list else None
    known = types.messages.get(type_.base)
    return known.fields.get(part) if known is not None and not type_.is_list else None
