"""Messages written as a middleware sends them, in CDR: all zero, false or empty but for some values."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ltlc.inputs.messages.definitions import STRINGS, FieldType, Message
from ltlc.inputs.recordings.bags.scalars import SCALARS

Values = Mapping[tuple[str, ...], float | bool | str]
"""Values of single fields, by the way to them; they are such that the fields can have them."""

_LITTLE_ENDIAN = b"\0\1\0\0"


def written(message: str, types: Mapping[str, Message], values: Values) -> bytes:
    """The message of the type `message`, which with all that it contains is in `types`."""
    data = bytearray()
    _write(data, FieldType(message), types, values, ())
    return _LITTLE_ENDIAN + bytes(data)


def _write(
    data: bytearray, type_: FieldType, types: Mapping[str, Message], values: Values, path: tuple[str, ...]
) -> None:
    if type_.length == 0:
        _append(data, "u4", 0)
    elif type_.length is not None:
        for _ in range(type_.length):
            _write(data, FieldType(type_.base), types, {}, ())
    elif type_.base in SCALARS:
        _append(data, SCALARS[type_.base], values.get(path, 0))
    elif type_.base in STRINGS:
        text = str(values.get(path, "")).encode() + b"\0"
        _append(data, "u4", len(text))
        data += text
    else:
        for name, of in types[type_.base].fields.items():
            _write(data, of, types, values, (*path, name))


def _append(data: bytearray, kind: str, number: float | bool | str) -> None:
    """A number of a kind, where its size divides the place."""
    number_ = np.array(number, f"<{kind}")
    data += bytes(-len(data) % number_.itemsize) + number_.tobytes()
