"""Flight logs in the format ULog, written by its description in the PX4 Guide."""

from __future__ import annotations

import random
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

PRIMITIVES = {
    "int8_t": "b",
    "uint8_t": "B",
    "int16_t": "h",
    "uint16_t": "H",
    "int32_t": "i",
    "uint32_t": "I",
    "int64_t": "q",
    "uint64_t": "Q",
    "float": "f",
    "double": "d",
    "bool": "?",
    "char": "B",
}


TIME = ("uint64_t", "timestamp", 0)


@dataclass
class LogWriter:
    """The bytes of a log that begins at `begin`, in µs."""

    begin: int = 0
    data: bytearray = field(default_factory=bytearray)

    def __post_init__(self) -> None:
        self.data += b"ULog\x01\x12\x35\x01" + struct.pack("<Q", self.begin)

    def add(self, kind: str, body: bytes) -> None:
        """A message of any kind."""
        self.data += struct.pack("<HB", len(body), ord(kind)) + body

    def format(self, name: str, fields: str) -> None:
        """That of a topic, as in `uint64_t timestamp;float speed;`."""
        self.add("F", f"{name}:{fields}".encode())

    def subscribe(self, name: str, number: int, instance: int = 0) -> None:
        """From here on, messages with this number are of that topic."""
        self.add("A", struct.pack("<BH", instance, number) + name.encode())

    def message(self, number: int, packed: bytes) -> None:
        """A message of a topic."""
        self.add("D", struct.pack("<H", number) + packed)

    def parameter(self, name: str, value: float) -> None:
        """The value of a parameter, from here on."""
        kind, code = ("int32_t", "i") if isinstance(value, int) else ("float", "f")
        key = f"{kind} {name}".encode()
        self.add("P", bytes([len(key)]) + key + struct.pack(f"<{code}", value))

    def dropout(self, milliseconds: int) -> None:
        """So long nothing could be logged."""
        self.add("O", struct.pack("<H", milliseconds))

    def flags(self, appended: Sequence[int] = (), unknown: int = 0) -> None:
        """The first message: where data are appended, and features that are not known."""
        offsets = [*appended, 0, 0, 0][:3]
        incompatible = bytes([bool(appended), unknown, 0, 0, 0, 0, 0, 0])
        self.add("B", bytes(8) + incompatible + struct.pack("<3Q", *offsets))

    def save(self, path: Path) -> Path:
        """Write it to a file."""
        path.write_bytes(self.data)
        return path


def speeds(samples: Sequence[tuple[int, float]], begin: int = 0) -> LogWriter:
    """A log of one topic, `wheel`, with a `speed` at each of these times, in µs."""
    log = LogWriter(begin)
    log.format("wheel", "uint64_t timestamp;float speed;")
    log.subscribe("wheel", 0)
    for time, speed in samples:
        log.message(0, struct.pack("<Qf", time, speed))
    return log


def random_log(chance: random.Random) -> LogWriter:
    """Formats in one another, arrays, padding, instances, parameters; messages of topics not in the order of time."""
    log = LogWriter(chance.randrange(2_000_000))
    formats: dict[str, list[tuple[str, int]]] = {}
    topics: list[tuple[str, list[tuple[str, str, int]]]] = []
    for number in range(3):
        fields = [_field(chance, formats, place) for place in range(chance.randint(1, 5))]
        if number == 2 or chance.random() < 0.7:
            fields.insert(chance.randrange(len(fields) + 1), TIME)
        if chance.random() < 0.5:
            fields.append(("uint8_t", "_padding0", chance.randint(1, 7)))
        name = f"part_{number}x"
        log.format(name, "".join(f"{kind}[{count}] {of};" if count else f"{kind} {of};" for kind, of, count in fields))
        formats[name] = [(kind, count or 1) for kind, _, count in fields]
        if TIME in fields:
            topics.append((name, fields))
    for _ in range(chance.randint(0, 5)):
        _set_parameter(chance, log)
    for number, (name, _) in enumerate(topics):
        log.subscribe(name, number)
        log.subscribe(name, 10 + number, instance=1)
    for _ in range(chance.randint(0, 20)):
        number = chance.randrange(len(topics))
        name, fields = topics[number]
        time = sum(_size(formats, of) * count for of, count in formats[name][: fields.index(TIME)])
        raw = bytearray(chance.randbytes(_size(formats, name)))
        raw[time : time + 8] = struct.pack("<Q", chance.randrange(3_000_000))
        padding = fields[-1][2] if fields[-1][1] == "_padding0" else 0
        log.message(chance.choice([number, 10 + number]), bytes(raw[: len(raw) - padding]))
    for _ in range(chance.randint(0, 2)):
        _set_parameter(chance, log)
    return log


def _set_parameter(chance: random.Random, log: LogWriter) -> None:
    number = chance.randrange(4)
    log.parameter(f"P_{number}", chance.choice([chance.randint(-9, 9), 2**24 + 1]) if number % 2 else chance.random())


def _field(chance: random.Random, formats: Mapping[str, object], place: int) -> tuple[str, str, int]:
    kind = chance.choice([*[kind for kind in PRIMITIVES if kind != "char"], *formats])
    return kind, f"field_{place}", chance.choice([0, 0, 1, 3])


def _size(formats: Mapping[str, Sequence[tuple[str, int]]], kind: str) -> int:
    if kind in PRIMITIVES:
        return struct.calcsize(f"<{PRIMITIVES[kind]}")
    return sum(_size(formats, of) * count for of, count in formats[kind])
