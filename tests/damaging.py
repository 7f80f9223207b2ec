"""Damaged recordings: small ones of every form in which something is changed, and what `ltlc run` makes of them."""

from __future__ import annotations

import contextlib
import gzip
import io
import json
import random
import resource
import sqlite3
import struct
import tempfile
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import Any

import pyarrow as pa
import zstandard
from bag_support import FORMS, LEVEL, SCAN, Sent, mcap, odometry, random_message
from fuzzing import Case, broken_by, printed
from pyarrow import parquet

from ltlc.base.limits import Budget
from ltlc.runtime.times import SECOND

START = 1_700_000_000 * SECOND
MOST_MEGABYTES, MOST_SECONDS = 800, 20
"""Memory beside the 200 MB that a process has which has imported all."""

PROPERTIES = """decl x /odom Odometry.pose.pose.position.x
decl frame /odom Odometry.child_frame_id
decl scan /scan LaserScan.ranges
fast: never x > 5
lost: never any(scan < 0.1) or frame == "map" and x - @{x, -1} > 2
alive: always age(scan) <= 2 s
"""
OF_OWN = "decl part /level own_msgs/Level.parts[].share\nparts: never any(part > 5)\n"

CSV = "time,x,frame,scan\n" + "".join(f'{k / 10},{k % 7},odom,"[1, {k}, NaN]"\n' for k in range(40))
JSONL = "".join(
    json.dumps({"time": k / 10, "x": k % 7, "frame": "odom", "scan": [1, k, None]}) + "\n" for k in range(40)
)

Files = Mapping[str, bytes]


def sent() -> list[Sent]:
    """What is in each bag."""
    chance = random.Random(0)
    found = [odometry(START + k * SECOND // 10, pose__pose__position__x=k % 7) for k in range(30)]
    for name, topic in ((SCAN, "/scan"), (LEVEL, "/level")):
        found += [Sent(topic, name, START + k * SECOND // 10, random_message(name, chance)) for k in range(12)]
    return sorted(found, key=lambda each: each.time)


def _bag(write: Callable[[Path, Sequence[Sent]], Path], of: Sequence[Sent]) -> Files:
    with tempfile.TemporaryDirectory(prefix="damage") as folder:
        path = write(Path(folder), of)
        paths = sorted(path.iterdir()) if path.is_dir() else [path]
        return {("" if path.is_file() else "bag/") + each.name: each.read_bytes() for each in paths}


def _unchecked(folder: Path, of: Sequence[Sent]) -> Path:
    return mcap(folder / "a.mcap", of, enable_crcs=False)


def _table(compression: str, **columns: Any) -> Files:
    out = io.BytesIO()
    parquet.write_table(pa.table(columns), out, compression=compression, row_group_size=15)
    return {"a.parquet": out.getvalue()}


def _columns() -> dict[str, Any]:
    rows = [json.loads(line) for line in JSONL.splitlines()]
    return {name: [row[name] for row in rows] for name in rows[0]}


def _results() -> Files:
    """Two tables, and what a campaign has kept of them."""
    tables = {"a.csv": CSV.encode(), "b.csv": CSV.replace("odom", "map").encode()}
    with tempfile.TemporaryDirectory(prefix="damage") as folder, contextlib.chdir(folder):
        for name, content in {"props.txt": PROPERTIES.encode(), **tables}.items():
            Path(name).write_bytes(content)
        printed(["run", "props.txt", *tables, "--results", "r.parquet", "--jobs", "1"])
        return {"r.parquet": Path("r.parquet").read_bytes(), **tables}


def _journal() -> Files:
    """Two tables, and the journal of a campaign that has not written what it kept of them."""
    kept = dict(_results())
    rows = parquet.read_table(io.BytesIO(kept.pop("r.parquet"))).to_pylist()
    lines = [json.dumps([row for row in rows if row["recording"] == name]) for name in kept]
    return {"r.parquet.journal": "\n".join([*lines, ""]).encode(), **kept}


_MADE: dict[str, Callable[[], Files]] = {
    **{form: partial(_bag, write, sent()) for form, write in FORMS.items()},
    "mcap unchecked": partial(_bag, _unchecked, sent()),
    "csv": lambda: {"a.csv": CSV.encode()},
    "csv.gz": lambda: {"a.csv.gz": gzip.compress(CSV.encode(), mtime=0)},
    "jsonl": lambda: {"a.jsonl": JSONL.encode()},
    "jsonl.zst": lambda: {"a.jsonl.zst": zstandard.compress(JSONL.encode())},
    "parquet": lambda: _table("none", **_columns()),
    "parquet snappy": lambda: _table("snappy", **_columns()),
    "results": _results,
    "journal": _journal,
}


@cache
def whole(form: str) -> Files:
    """A recording of this form before anything is changed; the first file is the one to be damaged."""
    return _MADE[form]()


EXTREME = sorted(
    {0, 1, 2**31 - 1, 2**31, 2**32 - 1, 2**62, 2**63 - 1, 2**63, 2**64 - 1, *(1 << n for n in range(0, 64, 7))}
)
WORDS = (
    *(
        b"\xff\xfe",
        b"\xc3",
        b"\xed\xa0\x80",
        b"\0",
        b"\n",
        b'"',
        b"'",
        b",",
        b"[" * 3000,
        b"{" * 3000,
        b"}",
        b"null",
        b"nan",
    ),
    *(b"1e400", b"-inf", b"9" * 30, b"9" * 5000, b"1e-400", b"-1", b"0x10", b"1_0", b"true", b"9223372036854775808"),
)

Damage = Callable[[bytes, random.Random], bytes]


def _place(data: bytes, chance: random.Random) -> int:
    """A place in `data`: anywhere, or near its end, where what is about all of it stands."""
    return chance.randrange(max(0, len(data) - chance.choice([len(data), 600])), len(data))


def flipped(data: bytes, chance: random.Random) -> bytes:
    """A few bits are others."""
    changed = bytearray(data)
    for _ in range(chance.choice([1, 1, 2, 8])):
        changed[_place(data, chance)] ^= 1 << chance.randrange(8)
    return bytes(changed)


def replaced(data: bytes, chance: random.Random) -> bytes:
    """A part is something else, left out, or there twice."""
    start = _place(data, chance)
    end = min(len(data), start + chance.choice([1, 2, 4, 8, 64, 1000]))
    part = data[start:end]
    other = [bytes(len(part)), b"\xff" * len(part), chance.randbytes(len(part)), b"", part * 2, chance.choice(WORDS)]
    return data[:start] + chance.choice(other) + data[end:]


def cut(data: bytes, chance: random.Random) -> bytes:
    """The end is missing."""
    return data[: _place(data, chance)]


def numbered(data: bytes, chance: random.Random) -> bytes:
    """Somewhere a number is as large, or as small, as numbers get."""
    return _written(data, _place(data, chance), chance)


def _written(data: bytes, place: int, chance: random.Random) -> bytes:
    number = struct.pack("<Q", chance.choice(EXTREME))[: chance.choice([1, 2, 4, 8, 8])]
    return data[:place] + number + data[place + len(number) :]


MCAP_FIELDS = (-8, 0, 2, 4, 6, 8, 14, 16, 20, 22, 24, 28, 32)
"""Where numbers stand in records, from the beginning of what follows the length."""


def in_a_record(data: bytes, chance: random.Random) -> bytes:
    """A number in a record of MCAP: its length, a time, a size, a count."""
    kinds = chance.choice(_by_kind(data))
    return _written(data, max(0, chance.choice(kinds) + chance.choice(MCAP_FIELDS)), chance)


@cache
def _by_kind(data: bytes) -> list[list[int]]:
    """Where the records of each kind have their bodies, those within chunks that are not compressed included."""
    found: dict[int, list[int]] = {}

    def look(place: int, end: int) -> None:
        while place + 9 <= end:
            kind, length = struct.unpack_from("<BQ", data, place)
            if not 0 < kind < 16 or place + 9 + length > end:
                return
            found.setdefault(kind, []).append(place + 9)
            if kind == 6 and struct.unpack_from("<I", data, place + 9 + 28)[0] == 0:
                look(place + 9 + 40, place + 9 + length)
            place += 9 + length

    look(8, len(data))
    return list(found.values()) or [[8]]


ROS1_FIELDS = (
    b"time=",
    b"size=",
    b"count=",
    b"conn=",
    b"conn_count=",
    b"chunk_count=",
    b"index_pos=",
    b"chunk_pos=",
    b"ver=",
)


def in_a_header(data: bytes, chance: random.Random) -> bytes:
    """A number in the header of a record of ROS 1."""
    name = chance.choice(ROS1_FIELDS)
    places = [n for n in range(len(data)) if data.startswith(name, n)] or [0]
    return _written(data, chance.choice(places) + len(name), chance)


CELLS = ("timestamp", "topic_id", "data", "id", "name", "type", "serialization_format", "offered_qos_profiles")
VALUES = (0, -1, 2**62, 2**63 - 1, -(2**63), 1e300, None, "soon", b"", b"\xff\xfe", "x" * 100_000)


def in_a_database(data: bytes, chance: random.Random) -> bytes:
    """A cell of a database, or the shape of a table."""
    with tempfile.TemporaryDirectory(prefix="damage") as folder:
        path = Path(folder, "a.db3")
        path.write_bytes(data)
        with contextlib.closing(sqlite3.connect(path)) as database, contextlib.suppress(sqlite3.Error):
            table = chance.choice(["messages", "messages", "topics"])
            cell, value = chance.choice(CELLS), chance.choice(VALUES)
            shapes = [f"drop table {table}", f"alter table {table} drop column {cell}", f"delete from {table}"]
            if chance.random() < 0.2:
                database.execute(chance.choice(shapes))
            else:
                of = chance.choice(["1", "id % 7 = 3", "id = 1"])
                what = chance.choice(["?", "cast(? as text)", "cast(? as blob)"])
                database.execute(f"update {table} set {cell} = {what} where {of}", [value])
            database.commit()
        return path.read_bytes()


def _damages(name: str) -> list[Damage]:
    """What can be done to a file with this name."""
    special: dict[str, list[Damage]] = {
        ".mcap": [in_a_record] * 6,
        ".bag": [in_a_header] * 6,
        ".db3": [in_a_database] * 4,
    }
    return [flipped, replaced, cut, numbered, *special.get(Path(name).suffix, [])]


def repacked(name: str, data: bytes, chance: random.Random) -> bytes:
    """`data` damaged, or what is compressed in it."""
    inner = Path(name).stem
    if not data:
        return data
    match Path(name).suffix if chance.random() < 1 / 2 else "":
        case ".gz":
            with contextlib.suppress(EOFError, OSError, zlib.error):
                return gzip.compress(repacked(inner, gzip.decompress(data), chance), mtime=0)
        case ".zst" | ".zstd":
            with contextlib.suppress(zstandard.ZstdError):
                return zstandard.compress(repacked(inner, zstandard.decompress(data, 1 << 26), chance))
        case _:  # not compressed, or its compressed form is damaged
            pass
    return chance.choice(_damages(name))(data, chance)


@dataclass(frozen=True)
class Broken(Sent):
    """A message of which other bytes are recorded."""

    data: bytes = b""

    @property
    def cdr(self) -> bytes:
        """What is recorded."""
        return self.data


def with_broken_messages(form: str, chance: random.Random) -> Files:
    """A bag of ROS 2 that is whole, with messages that are not."""
    share, damage = chance.choice([0.05, 0.3]), chance.choice([flipped, replaced, cut, numbered])

    def recorded(each: Sent) -> Sent:
        if chance.random() > share:
            return each
        return Broken(each.topic, each.type, each.time, each.message, damage(each.cdr, chance))

    return _bag(FORMS[form], [recorded(each) for each in sent()])


def damaged(seed: int) -> Case:
    """A command line, and the recording that it names, in which something is damaged."""
    chance = random.Random(seed)
    form = chance.choice(list(_MADE))
    if form in FORMS and form != "ros1" and chance.random() < 1 / 5:
        files = dict(with_broken_messages(form, chance))
    else:
        files = dict(whole(form))
        for _ in range(chance.choice([1, 1, 1, 2, 3])):
            name = chance.choice([next(iter(files)), *files])
            files[name] = repacked(name, files[name], chance)
    properties = PROPERTIES + (OF_OWN if form in FORMS else "")
    return Case(_arguments(files, chance), (("props.txt", properties.encode()), *files.items()))


def _arguments(files: Files, chance: random.Random) -> tuple[str, ...]:
    options = [(), (), ("--stamp", "header"), ("--verdicts",), ("--from", "1700000001"), ("--until", "1700000001.5")]
    given: tuple[str, ...]
    first, *others = files
    if first in ("r.parquet", "r.parquet.journal"):
        given = (*others, "--results", "r.parquet", "--jobs", "1")
    else:
        given = (first.partition("/")[0], *chance.choice(options))
    return ("run", "props.txt", *given, "--format", "json")


def problem_with(case: Case) -> str | None:
    """What is wrong with what `ltlc run` does; None if it is as it should be.

    It may take `MOST_SECONDS` of a CPU and `MOST_MEGABYTES`, shows no traceback, and has the exit codes of runs: 1 only
    where a property is violated, 2 only with a word about what is unusable.
    """
    return broken_by(case, _look, Budget(6 * MOST_SECONDS, 4 * MOST_MEGABYTES))


def _look(arguments: Sequence[str]) -> str | None:
    before, begin = _peak(), _seconds()
    code, out, errors = printed(arguments)
    if (most := _peak() - before) > MOST_MEGABYTES:
        return f"{most} MB"
    if (took := _seconds() - begin) > MOST_SECONDS:
        return f"{took:.0f} s"
    if "Traceback" in errors or "this is a bug" in errors or code not in (0, 1, 2, 3):
        return f"exit code {code}\n{errors}"
    if (code == 1) != ('"verdict": "violated"' in out) and code != 2:
        return f"exit code {code}, and what is printed says otherwise\n{out}"
    if code == 2 and "error[LTL" not in errors and "ltlc: " not in errors:
        return f"exit code 2 without a word\n{errors}"
    return None


def _seconds() -> float:
    """What this process and its children have had of a CPU, which may be busy with others."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in used)


def _peak() -> int:
    """The most megabytes that this process had so far, or a child of it."""
    return max(resource.getrusage(who).ru_maxrss for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)) // 1000
