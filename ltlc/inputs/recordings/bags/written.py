"""Messages written as a middleware sends them, in CDR."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ltlc.inputs.messages.definitions import STRINGS, FieldType, Message
from ltlc.inputs.recordings.bags.scalars import SCALARS

_LITTLE_ENDIAN = b"\0\1\0\0"


def written(message: str, types: Mapping[str, Message], values: object) -> bytes:
    """The message of the type `message`, which with all that it contains is in `types`.

    `values` are those of its fields, by their names or as attributes: numbers, bytes, strings, lists, and the same of
    messages in it. What is missing or None is zero, false or empty.
    """
    data = bytearray()
    _write(data, FieldType(message), types, values)
    return _LITTLE_ENDIAN + bytes(data)


def nested(values: Mapping[tuple[str, ...], object]) -> dict[str, Any]:
    """Values of fields by their names, those of messages in messages as well, of values by the ways to them."""
    found: dict[str, Any] = {}
    for path, value in values.items():
        inside = found
        for name in path[:-1]:
            inside = inside.setdefault(name, {})
        inside[path[-1]] = value
    return found


def _write(data: bytearray, type_: FieldType, types: Mapping[str, Message], value: Any) -> None:
    if type_.length is not None:
        elements = [] if value is None else list(value)
        if type_.length == 0:
            _append(data, "u4", len(elements))
        for each in elements or [None] * type_.length:
            _write(data, FieldType(type_.base), types, each)
    elif type_.base in SCALARS:
        _append(data, SCALARS[type_.base], value[0] if isinstance(value, bytes) else 0 if value is None else value)
    elif type_.base in STRINGS:
        text = (value or "").encode() + b"\0"
        _append(data, "u4", len(text))
        data += text
    else:
        for name, of in types[type_.base].fields.items():
            part = value.get(name) if isinstance(value, Mapping) else getattr(value, name, None)
            _write(data, of, types, part)


def _append(data: bytearray, kind: str, number: float) -> None:
    """A number of a kind, where its size divides the place."""
    number_ = np.array(number, f"<{kind}")
    data += bytes(-len(data) % number_.itemsize) + number_.tobytes()
