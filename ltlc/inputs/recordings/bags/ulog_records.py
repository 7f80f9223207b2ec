"""What is in a flight log: formats, the places of messages, parameters and dropouts (PX4 Guide, 'ULog File Format')."""

from __future__ import annotations

import re
import struct
from dataclasses import field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.bags.messages import numbers_at
from ltlc.inputs.recordings.blocks import Array, Places
from ltlc.runtime.times import SECOND
from ltlc.semantics.durations import Nanoseconds

MAGIC = b"ULog\x01\x12\x35"
BEGIN = 16
"""So many bytes come before the first message: `MAGIC`, a version, and when the log begins, in µs."""

HEAD = 3
"""So many bytes begin a message: the size of what follows, and its kind."""

BODY = HEAD + 2
"""A logged message begins behind its head and the number of its topic."""

_KINDS = np.frombuffer(b"ABCDFILMOPQRS", np.uint8)
_DATA = ord("D")
MILLISECOND, MICROSECOND = SECOND // 10**3, SECOND // 10**6
_APPENDED = 1
"""The flag of a log to which data were appended, as after a crash."""

_FIELD = re.compile(r"([A-Za-z]\w*)(?:\[(0|[1-9]\d*)\])? (\w+)")
_PARAMETER = re.compile(r"(int32_t|float) (\w+)")


class DamageError(Exception):
    """What is wrong with a log."""


class Part(NamedTuple):
    """A field of a format: a primitive or another format, how many of them if it is an array, and its name."""

    base: str
    length: int | None
    name: str


class Subscription(NamedTuple):
    """From the byte `since` of the log on, messages with this number are in a format, of the topic's instance."""

    format: str
    instance: int
    number: int
    since: int


class Parameter(NamedTuple):
    """The value, four bytes, that a parameter has from the byte `since` of the log on; its type as in ULog."""

    type: str
    name: str
    value: bytes
    since: int


@dataclass
class Log:
    """What a log says of itself, up to the `damage`, if there is any.

    `begin` is when it begins, in ns. `places` are the bytes at which logged messages begin, in ascending order;
    `sizes` are those of their bodies, and `numbers` give their topics. `dropouts` are the bytes at which something
    could not be logged, and for how long, in ns.
    """

    begin: Nanoseconds
    formats: dict[str, list[Part]] = field(default_factory=dict)
    subscriptions: list[Subscription] = field(default_factory=list)
    parameters: list[Parameter] = field(default_factory=list)
    dropouts: list[tuple[int, Nanoseconds]] = field(default_factory=list)
    places: Places = field(default_factory=lambda: np.empty(0, np.int64))
    sizes: Places = field(default_factory=lambda: np.empty(0, np.int64))
    numbers: NDArray[np.uint16] = field(default_factory=lambda: np.empty(0, np.uint16))
    damage: str = ""


def read(data: Array) -> Log:
    """The log that these bytes are. Raises DamageError if they are none."""
    if data[: len(MAGIC)].tobytes() != MAGIC or len(data) < BEGIN:
        raise DamageError("it does not begin as one")
    log = Log(int.from_bytes(data[8:BEGIN].tobytes(), "little") * MICROSECOND)
    places, log.damage = _heads(data, _sections(data))
    sizes, kinds = numbers_at(data, places, "<u2").astype(np.int64), data[places + 2]
    is_data = kinds == _DATA
    wrong = np.flatnonzero(~np.isin(kinds, _KINDS) | (is_data & (sizes < BODY - HEAD)))
    if wrong.size:
        log.damage = f"there is no message at byte {places[wrong[0]]}"
        places, sizes, is_data = (each[: wrong[0]] for each in (places, sizes, is_data))
    for place, size in zip(places[~is_data].tolist(), sizes[~is_data].tolist(), strict=True):
        try:
            _take(log, place, chr(data[place + 2]), data[place + HEAD :][:size].tobytes())
        except (ValueError, IndexError, struct.error):
            raise DamageError(f"the message at byte {place} is malformed") from None
    log.places, log.sizes = places[is_data], sizes[is_data] - (BODY - HEAD)
    log.numbers = numbers_at(data, log.places + HEAD, "<u2")
    return log


def _take(log: Log, place: int, kind: str, body: bytes) -> None:
    """Take a message that is not logged data. Raises ValueError, IndexError and struct.error if it is malformed."""
    match kind:
        case "F":
            name, _, fields = body.decode("ascii").partition(":")
            log.formats[name] = [_part(field) for field in fields.split(";") if field]
        case "A":
            instance, number = struct.unpack_from("<BH", body)
            log.subscriptions.append(Subscription(body[3:].decode("ascii"), instance, number, place))
        case "P":
            end = 1 + body[0]
            if match := _PARAMETER.fullmatch(body[1:end].decode("ascii")):
                log.parameters.append(Parameter(match[1], match[2], body[end:].ljust(4, b"\0")[:4], place))
        case "O":
            log.dropouts.append((place, struct.unpack("<H", body)[0] * MILLISECOND))
        case _:
            pass


def _part(text: str) -> Part:
    match = _FIELD.fullmatch(text)
    if match is None or match[2] == "0":
        raise ValueError
    return Part(match[1], None if match[2] is None else int(match[2]), match[3])


def _sections(data: Array) -> list[int]:
    """Where parts of the log end; what comes before an end may be cut off, except at the last. Raises DamageError."""
    is_flagged = len(data) >= BEGIN + HEAD + 40 and data[BEGIN + 2] == ord("B")
    if not is_flagged:
        return [len(data)]
    flags = data[BEGIN + HEAD :][:40].tobytes()
    if flags[8] & ~_APPENDED or any(flags[9:16]):
        raise DamageError("it has features that are not known")
    appended = struct.unpack("<3Q", flags[16:]) if flags[8] & _APPENDED else ()
    ends = sorted(offset for offset in appended if BEGIN < offset < len(data))
    return [*ends, len(data)]


def _heads(data: Array, ends: list[int]) -> tuple[Places, str]:
    """Where messages begin, and what is wrong at the end."""
    text: memoryview = data.data
    places: list[int] = []
    damage, place = "", BEGIN
    for end in ends:
        add, last = places.append, end - HEAD
        while place <= last:
            add(place)
            place += HEAD + text[place] + (text[place + 1] << 8)
        if place != end:
            if place > end:
                places.pop()
            damage = "its last message is cut off" if end == ends[-1] else ""
        place = end
    return np.array(places, np.int64), damage
