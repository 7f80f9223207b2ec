"""The definitions of messages as evidence has them: what decides how they are read, and nothing else."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ltlc.assurance.evidence.document import digest
from ltlc.inputs.messages.definitions import MessageTypes

_BYTES = {
    "byte": "uint8",
    "octet": "uint8",
    "char": "uint8",
    "boolean": "bool",
    "float": "float32",
    "double": "float64",
}


def definition_text(name: str, types: MessageTypes) -> str:
    """A line for the message `name` and each that is inside it, in the order of names: `NAME: TYPE FIELD, …`.

    Primitives have the names of ROS 2, of several the first; lists end in `[]`, arrays of fixed length in `[N]`.
    """
    found: dict[str, str] = {}
    todo = [name]
    while todo:
        of = todo.pop()
        if of in found or of not in types.messages:
            continue
        fields = types.messages[of].fields
        lengths = {None: "", 0: "[]"}
        said = (
            f"{_BYTES.get(type_.base, type_.base)}{lengths.get(type_.length, f'[{type_.length}]')} {field}"
            for field, type_ in fields.items()
        )
        found[of] = f"{of}: {', '.join(said)}\n"
        todo += [type_.base for type_ in fields.values()]
    return "".join(found[of] for of in sorted(found))


def digests(read: Iterable[tuple[str, MessageTypes]]) -> tuple[tuple[str, str], ...]:
    """The types of messages that were read, with the digests of their definitions, in the order of names."""
    return tuple(sorted(set(_digests(read))))


def _digests(read: Iterable[tuple[str, MessageTypes]]) -> Iterator[tuple[str, str]]:
    return ((name, digest(definition_text(name, types))) for name, types in read)
