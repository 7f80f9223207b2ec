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
    """The message `name` with the types of its fields, and theirs in it: `NAME(TYPE FIELD, TYPE FIELD)`.

    Primitives have the names of ROS 2, of several the first; lists end in `[]`, arrays of fixed length in `[N]`.
    """
    if name not in types.messages:
        return _BYTES.get(name, name)
    lengths = {None: "", 0: "[]"}
    fields = (
        f"{definition_text(of.base, types)}{lengths.get(of.length, f'[{of.length}]')} {field}"
        for field, of in types.messages[name].fields.items()
    )
    return f"{name}({', '.join(fields)})"


def digests(read: Iterable[tuple[str, MessageTypes]]) -> tuple[tuple[str, str], ...]:
    """The types of messages that were read, with the digests of their definitions, in the order of names."""
    return tuple(sorted(set(_digests(read))))


def _digests(read: Iterable[tuple[str, MessageTypes]]) -> Iterator[tuple[str, str]]:
    return ((name, digest(definition_text(name, types))) for name, types in read)
