"""The definitions of a bag's messages: where they come from, and whether fields fit the specification."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ltlc.base.nearest import did_you_mean
from ltlc.dataclass import dataclass
from ltlc.inputs.messages.definitions import JAZZY, STRINGS, FieldType, Message, MessageTypes, shipped
from ltlc.inputs.messages.texts import defined
from ltlc.inputs.recordings.bags.messages import LARGEST, Topic
from ltlc.inputs.recordings.bags.scalars import SCALARS
from ltlc.specification.expressions import Bytes, Each, Field, Match, Parallel, PathStep, Signal, ValueType
from ltlc.specification.wire import PRIMITIVES

DEEPEST = 64
"""No message has more messages inside one another."""

_READABLE = {*SCALARS, "string"}

RECORDING, GIVEN = "the recording", "--msg-path"
"""Who defines messages; else it is a distribution of ROS 2."""


class UnknownTypeError(Exception):
    """Why it is not known what the messages of a topic look like, and what helps."""

    def __init__(self, reason: str, help: str) -> None:
        super().__init__(reason)
        self.reason = reason
        self.help = help


class NonsenseError(Exception):
    """What is wrong with the definition of a type that no message can have."""


@dataclass(frozen=True, slots=True)
class Layer:
    """The types defined by a source, such as `ROS 2 Humble`."""

    origin: str
    messages: Mapping[str, Message]


def distribution_name(distribution: str) -> str:
    """`ROS 2 Humble`."""
    return f"ROS 2 {distribution.capitalize()}"


def other_layers(message_paths: Sequence[str], distribution: str) -> list[Layer]:
    """What defines messages where a recording of that distribution does not, the first first."""
    from ltlc.inputs.recordings.bags.known import given_messages  # which may be bags themselves

    given, _ = given_messages(message_paths)
    layers = [Layer(GIVEN, given), Layer(distribution_name(distribution), shipped(distribution))]
    return layers if distribution == JAZZY else [*layers, Layer(distribution_name(JAZZY), shipped())]


def merged(layers: Sequence[Layer]) -> MessageTypes:
    """All that is defined, by the first that does."""
    return MessageTypes({name: message for layer in reversed(layers) for name, message in layer.messages.items()})


@dataclass(frozen=True, slots=True)
class Defined:
    """The types that the messages of a topic are made of, and who defines them."""

    types: MessageTypes
    origins: tuple[str, ...]


def types_of(topic: Topic, others: Sequence[Layer]) -> Defined:
    """The types that the messages of `topic` are made of: as the recording defines them, else the first of `others`.

    Raises UnknownTypeError and NonsenseError.
    """
    try:
        own = defined(topic.type, topic.form, topic.definition)
    except ValueError as error:
        help = "record it again, or give its definition with `--msg-path DIR` and a recording without one"
        raise UnknownTypeError(f"whose definition in the recording cannot be read: {error}", help) from None
    layers = [Layer(RECORDING, own), *others]
    types = merged(layers)
    origins: dict[str, None] = {}
    for name in _made_of(topic.type, types):
        if name in types.messages:
            origins[next(layer.origin for layer in layers if name in layer.messages)] = None
        elif name not in _READABLE:
            if name in STRINGS or name in PRIMITIVES:
                raise UnknownTypeError(f"which has a `{name}`: these cannot be read from a bag", "record another topic")
            missing = f"made of `{name}`, which" if name != topic.type else "which"
            help = "`--msg-path` adds the messages of a package or another bag"
            raise UnknownTypeError(f"{missing} neither the recording nor {others[-1].origin} defines", help)
    _values_in(topic.type, types, (), {})
    return Defined(types, tuple(origins))


def _values_in(name: str, types: MessageTypes, around: tuple[str, ...], known: dict[str, int]) -> int:
    """How many values a message has at least that is inside those `around` it. Raises NonsenseError.

    Of types that are `known` the number is.
    """
    if name in known:
        return known[name]
    if name in around or len(around) > DEEPEST:
        raise NonsenseError(f"`{name}` contains itself" if name in around else f"`{around[0]}` is nested too deeply")
    count = 0
    for field, type_ in types.messages[name].fields.items() if name in types.messages else ():
        inside = _values_in(type_.base, types, (*around, name), known)
        count += inside * (1 if type_.length is None else type_.length)
        if count > LARGEST:
            raise NonsenseError(f"`{field}` in `{name}` makes messages of more than {LARGEST} bytes")
    known[name] = max(1, count)
    return known[name]


def _made_of(name: str, types: MessageTypes) -> Iterator[str]:
    """`name` and all that is inside it: messages and primitives."""
    found, todo = {name}, [name]
    while todo:
        current = todo.pop()
        yield current
        fields = types.messages[current].fields.values() if current in types.messages else ()
        todo += [base for base in dict.fromkeys(type_.base for type_ in fields) if base not in found]
        found.update(todo)


def misfit(signal: Signal, field: Field, types: MessageTypes) -> str:
    """Why `field` does not lead to a value of `signal` in messages as `types` define them; empty if it does."""
    if not field.path:
        return ""
    current = FieldType(field.message)
    for number, step in enumerate(field.path):
        if isinstance(step, Bytes):
            is_fit = current.base == "uint8" and bool(current.length)
            return "" if is_fit else f"has a `{current}` where the specification has an array of bytes of fixed length"
        reason = _step_reason(step, current, types)
        if reason:
            return reason
        match step:
            case str():
                outer, current = types.messages[current.base], types.messages[current.base].fields[step]
            case Parallel(names, _) if outer.fields.get(names) != FieldType("string", 0):
                return f"has no list of strings `{names}`"
            case Match(key, _) if types.messages[current.base].fields.get(key) != FieldType("string"):
                return f"has no string `{key}` in `{current.base}`"
            case Each() if number == len(field.path) - 1:
                break
            case _:
                current = FieldType(current.base)
    return _value_reason(signal, field, FieldType(current.base, 0 if Each() in field.path else current.length))


def _step_reason(step: PathStep, type_: FieldType, types: MessageTypes) -> str:
    if not isinstance(step, str):
        return "" if type_.is_list else f"has one `{type_}` where the specification has an array"
    if type_.is_list or type_.base not in types.messages:
        return f"has a `{type_}` where the specification has a message with the field `{step}`"
    fields: Mapping[str, FieldType] = types.messages[type_.base].fields
    if step in fields:
        return ""
    near = did_you_mean(step, fields)
    return f"has no field `{step}` in `{type_.base}`{f' ({near})' if near else ''}"


_TYPES = {"string": ValueType.STRING, "bool": ValueType.BOOLEAN, "boolean": ValueType.BOOLEAN}


def _value_reason(signal: Signal, field: Field, type_: FieldType) -> str:
    """Why the field at the end of the path is not a value of the signal; arrays may have any length."""
    of_one = _TYPES.get(type_.base, ValueType.NUMBER)
    wanted = signal.type.element or signal.type
    is_known = type_.base in _READABLE
    if is_known and of_one is wanted and type_.is_list == (signal.type.element is not None):
        if of_one is not ValueType.NUMBER or PRIMITIVES[type_.base] == field.numbers:
            return ""
        return f"has a `{type_}` there, with other numbers than the specification was checked with"
    return f"has a `{type_}` there, not a {signal.type.value}"
