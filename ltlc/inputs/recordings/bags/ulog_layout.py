"""How messages lie in flight logs, where all fields are side by side, and how in CDR."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.bags.cdr import HEADER
from ltlc.inputs.recordings.bags.scalars import SCALARS
from ltlc.inputs.recordings.bags.ulog_records import DamageError, Part
from ltlc.inputs.recordings.blocks import Array

LITTLE_ENDIAN = b"\0\1\0\0"
"""How messages in CDR begin."""

TYPES = {
    **{f"{sign}int{size}_t": f"{sign}int{size}" for sign in ("", "u") for size in (8, 16, 32, 64)},
    "float": "float32",
    "double": "float64",
    "bool": "bool",
    "char": "uint8",
}
"""What the primitive types of ULog are in ROS 2."""

_LARGEST = 0xFFFF
"""No message of a log is larger."""

_TIME = Part("uint64_t", None, "timestamp")
"""The field that has the time of a message, in µs since the start of the autopilot."""


@dataclass(frozen=True, slots=True)
class _Place:
    """Where `count` numbers of a kind lie side by side, in a message of a log and in CDR."""

    kind: str
    count: int
    logged: int
    written: int


class Layout:
    """How the messages in a format lie in a log and in CDR, where numbers are aligned to their size.

    A message of a log has at least `least` bytes, and at most `most`: what fills up its end may be omitted. Raises
    DamageError if no message can be in that format.
    """

    def __init__(self, formats: Mapping[str, Sequence[Part]], name: str) -> None:
        self._formats = formats
        self._places: list[_Place] = []
        self.most = self._written = 0
        self.time = self._add(name, ())
        if self.time < 0:
            raise DamageError(f"the format `{name}` has no field `timestamp` of the type `uint64_t`")
        last = self._places[-1]
        self.least = last.logged + last.count * np.dtype(last.kind).itemsize

    def _add(self, name: str, outer: tuple[str, ...]) -> int:
        """Add the fields of a format, inside the `outer` ones; where its time is."""
        if name not in self._formats or name in outer:
            raise DamageError(f"the format `{name}` is not defined, or contains itself")
        time, first = -1, self.most
        for part in self._formats[name]:
            base, count = part.base, 1 if part.length is None else part.length
            if base not in TYPES:
                for _ in range(count):
                    self._add(base, (*outer, name))
                continue
            kind = SCALARS[TYPES[base]]
            size = np.dtype(kind).itemsize
            if part == _TIME:
                time = self.most
            if not is_padding(part):
                self._written = (self._written + size - 1) & -size
                self._places.append(_Place(kind, count, self.most, self._written))
                self._written += size * count
            self.most += size * count
        if not first < self.most <= _LARGEST:
            raise DamageError(f"no message can be in the format `{name}`")
        return time

    def written(self, logged: Array) -> tuple[Array, int]:
        """Messages of `least` bytes, side by side, as CDR, and how large each of these is."""
        size = HEADER + self._written
        found = np.zeros(len(logged) // self.least * size, np.uint8)
        found[1::size] = LITTLE_ENDIAN[1]
        of_log = [place.logged for place in self._places]
        of_cdr = [HEADER + place.written for place in self._places]
        found.view(self._fields(of_cdr, size))[:] = logged.view(self._fields(of_log, self.least))
        return found, size

    def _fields(self, offsets: list[int], size: int) -> np.dtype[np.void]:
        formats = [(f"<{place.kind}", (place.count,)) for place in self._places]
        names = [f"f{number}" for number in range(len(formats))]
        return np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": size})


def is_padding(part: Part) -> bool:
    """Whether it only fills up what a message of C++ has between and behind fields."""
    return part.name.startswith("_padding")
