"""Whether a recording has the letters that an evidence of it says it has: they are computed anew, and compared.

    python recorded.py EVIDENCE RECORDING… [--fill FILE]

EVIDENCE is what `ltlc run --evidence` wrote, of one recording or of many; a RECORDING is what was judged, by its old
name. With --fill, the evidence is written to FILE with lines in place of their digests, for the judge. Exit code: 0 if
all is as written, 1 if something is refused, 2 if something cannot be checked.

This is one file, to be read in an afternoon and run alone: it needs Python 3.11, numpy, for bags rosbags, for tables
pyarrow, and has nothing of ltlc. `docs/evidence.md` there describes the document; what is computed is what
`docs/language.md` says of steps.
"""

from __future__ import annotations

import argparse
import csv
import hashlib
import io
import itertools
import json
import math
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import closing, contextmanager, nullcontext, suppress
from decimal import Decimal
from fractions import Fraction
from functools import lru_cache, partial, reduce
from operator import attrgetter
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

SECOND = 1_000_000_000
EXACT = 2**53
"""Up to here integers are doubles."""
MOST_TICKS = 10**8
MOST_COMBINATIONS = 10**6
MOST_ROUNDS = 100
"""So often it is looked anew which steps there are, as that depends on values at openings."""
TIMES = ("time", "__time", "timestamp")
"""Heads of a column of times."""

Json = Any
Array = Any
"""An array of numpy."""


class Refused(Exception):  # noqa: N818
    """It is not as written."""


class NotCovered(Exception):  # noqa: N818
    """It cannot be checked by this program."""


@contextmanager
def covered(problem: str) -> Iterator[None]:
    """Whatever else goes wrong is not covered."""
    try:
        yield
    except (Refused, NotCovered):
        raise
    except Exception as error:
        raise NotCovered(f"{problem}: {type(error).__name__}: {str(error).partition(chr(10))[0]}") from None


# The document --------------------------------------------------------------------------------------------------------

HEX, TIME, LETTER = "[0-9a-f]{64}", "(?:0|[1-9][0-9]{0,18})", "(?: a(?:0|[1-9][0-9]?))*"
HEAD = rf"""ltlc-evidence 1
ltlc .+
specification .+ sha256 {HEX}
certificates sha256 {HEX}
(recording .+ {TIME} sha256 {HEX}
)+(definition .+ sha256 {HEX}
)*(signal \S+ \S+ {{.*}}
)*(rate [0-9.e+-]+
)?(timeout {TIME}
)?(stamp header
)?(from {TIME}
)?(to {TIME}
)?"""
JUDGED = rf"""(?:letters {TIME} sha256 {HEX}
|at {TIME}{LETTER}
(?:\+{TIME}{LETTER}
)*+)?until {TIME}
verdict [a-z_]+ {TIME}
"""
CLAIM = rf"""not-covered .+: .+
|property .+
text .+
(requirement .+
)?(verifies .+
)*(atom .+
is {{.*}}
)*(count .+
of .+
)*(scope {TIME}(?: {TIME}-(?:{TIME})?)*
)*(instances a[0-9]+
)?(key {{.*}}
)?session {TIME}
(slice .+
{JUDGED})*{JUDGED}"""


class Section:
    """The head of a document, or what it says of a property: by the first word of a line, what follows it.

    Equal `parts` of conditions are one object, so that each is computed once.
    """

    def __init__(self, text: str, form: str, parts: dict[str, Json]) -> None:
        if not re.fullmatch(form, text):
            raise ValueError(f"what begins with `{text.partition(chr(10))[0][:80]}` is not written as it should be")
        self.text, self.parts = text, parts
        self.said: dict[str, list[str]] = {}
        self.lines: list[str] = []
        """Those that were computed in place of digests, if they are as stated."""
        for row in text.split("\n"):
            word, _, rest = row.replace("+", "+ ", 1).partition(" ") if row[:1] == "+" else row.partition(" ")
            self.said.setdefault(word, []).append(rest)
        read = partial(json.loads, object_hook=lambda x: parts.setdefault(json.dumps(x), x))
        texts = [*self.said.get("is", []), *(each.split(" ", 2)[2] for each in self.said.get("signal", []))]
        self.data: list[Json] = [*map(read, texts)]
        """What the atoms are, or the signals of a table."""
        self.key: list[Json] = [*map(read, self.said.get("key", []))]
        """The field that has ids, if there are slices."""

    def one(self, word: str) -> str:
        """What follows a word that is there once, or not."""
        return self.said.get(word, [""])[0]

    def time(self, word: str) -> int | None:
        """What follows a word, as a number; None if it is not there."""
        return int(self.one(word)) if word in self.said else None

    def digests(self, word: str) -> dict[str, str]:
        """What stands before and behind the word `sha256`."""
        return {name: digest for name, _, digest in (each.rpartition(" sha256 ") for each in self.said.get(word, []))}

    @property
    def filled(self) -> str:
        """Its text, with the lines that were computed in place of their digests."""
        found, computed = re.compile("^letters .*\n", re.M), iter(self.lines)
        is_computed = len(found.findall(self.text)) == len(self.lines)
        return found.sub(lambda _: next(computed), self.text) if is_computed else self.text

    @property
    def slices(self) -> dict[str, Section]:
        """What it says of each slice, as of a property of its own; by the ids."""
        before, *blocks = re.split("^slice ", self.text, flags=re.M)
        before = re.sub("^key .*\n", "", before, flags=re.M)
        pairs = (re.match(f"(.+)\n({JUDGED})", block) for block in blocks)
        return {pair[1]: Section(before + pair[2], CLAIM, self.parts) for pair in pairs if pair}


class Document:
    """The evidence of one recording."""

    def __init__(self, text: str) -> None:
        parts: dict[str, Json] = {}
        head, *properties = (f"{each}\n" for each in text.removesuffix("\n").split("\n\n"))
        self.head = Section(head, HEAD, parts)
        self.properties = [Section(each, CLAIM, parts) for each in properties]
        self.claims = [each for each in self.properties if "property" in each.said]
        self.not_covered = [each.one("not-covered") for each in self.properties if "not-covered" in each.said]

    @property
    def filled(self) -> str:
        """The same text, with the lines that were computed in place of their digests."""
        text = "\n".join([self.head.text, *(each.filled for each in self.properties)])
        return f"{text}end sha256 {sha256(text)}\n"


def documents(text: str) -> list[Document]:
    """The documents in a text, each of which ends with the digest of its lines. Raises ValueError."""
    *pairs, rest = re.split(rf"^end sha256 ({HEX})\n", text, flags=re.M)
    if not text.startswith("ltlc-evidence "):
        raise ValueError("this is no evidence")
    if rest or not pairs:
        raise ValueError("the evidence does not end with its digest")
    if any(sha256(body) != digest for body, digest in zip(pairs[::2], pairs[1::2], strict=True)):
        raise ValueError("the last line has not the digest of the lines before it")
    return [Document(body) for body in pairs[::2]]


def sha256(text: str) -> str:
    """The digest of a text."""
    return hashlib.sha256(text.encode()).hexdigest()


# What is recorded ----------------------------------------------------------------------------------------------------


class Recording:
    """What a document needs of a recording: the `times` of its messages, and their places in this list.

    `topics` has the places of the messages on each topic; `samples`, by the identity of what is read, those of the
    messages that have it, and its values. The run begins at `first`, and ends at `last`; of a slice, no message before
    the place `begins` is a step. `kept` is what was computed.
    """

    def __init__(self) -> None:
        self.times: Array = []
        self.topics: dict[str, Array] = {}
        self.samples: dict[int, tuple[Array, Array]] = {}
        self.first = self.last = self.begins = 0
        self.kept: dict[Any, Values] = {}

    def settle(self, head: Section, span: tuple[int, int] | None) -> None:
        """All is read: put it in the order of time, and of the file among equal times, and take the part asked for.

        The recording lasts for this `span`, or as long as the messages that are read.
        """
        since, to, times = head.time("from"), head.time("to"), np.array(self.times, np.int64)
        order = times.argsort(kind="stable")
        if since is not None:
            order = order[times[order] >= since]
        if to is not None:
            order = order[times[order] <= to]
        if span is None and not len(order):
            raise Refused("the recording has no messages")
        first, last = span or times[order[[0, -1]]].tolist()
        self.first = first if since is None else max(first, since)
        self.last = last if to is None else to
        place_of = np.full(len(times), -1)
        place_of[order] = np.arange(len(order))
        self.times = times[order]
        for topic, numbers in self.topics.items():
            places = np.unique(place_of[np.array(numbers, np.int64)])
            self.topics[topic] = places[places >= 0]
        for what, (numbers, values) in self.samples.items():
            places = place_of[np.array(numbers, np.int64)]
            is_there = (places >= 0) & np.array([value is not None for value in values], bool)
            having = np.flatnonzero(is_there)[places[is_there].argsort()]
            self.samples[what] = places[having], column([values[n] for n in having.tolist()])


def parts(x: Json) -> Iterator[Json]:
    """An expression or a condition, and all that is in it."""
    if isinstance(x, dict):
        yield x
    if isinstance(x, dict | list):
        for part in x.values() if isinstance(x, dict) else x:
            yield from parts(part)


def topics_of(x: Json) -> set[str]:
    """The topics whose messages it reads, be it only that they come."""
    found = {part["topic"] for part in parts(x) if "path" in part}
    return found.union(*(part[key] for part in parts(x) for key in ("new", "message") if key in part))


def getter(path: list[Json]) -> Callable[[Any], Any]:
    """What takes the value at a path out of a message; None if there is none."""
    is_plain = bool(path) and all(isinstance(step, str) for step in path)
    return attrgetter(".".join(path)) if is_plain else partial(value_at, path=path)


def value_at(value: Any, path: list[Json], around: Any = None) -> Any:
    """The value at a path, None if there is none; `around` is the message that has it as a field."""
    for depth, step in enumerate(path):
        match step:
            case str():
                around, value = value, getattr(value, step)
            case int():
                value = value[step] if step < len(value) else None
            case ["match", key, name]:
                value = next((each for each in value if getattr(each, key) == name), None)
            case ["parallel", names, name]:
                pairs = zip(value, getattr(around, names), strict=False)
                value = next((each for each, other in pairs if other == name), None)
            case ["each"] | ["own"]:
                return [value_at(each, path[depth + 1 :], value) for each in value]
            case ["bytes"]:
                text = bytes(value).hex()
                return "-".join((text[:8], text[8:12], text[12:16], text[16:20], text[20:])) if text[31:] else text
            case _:
                raise Refused(f"what is this: {step}")
        if value is None:
            return None
    return value


def read(path: Path, document: Document) -> Recording:
    """Read what the claims of a document need."""
    if re.search(r"\.(csv|jsonl|ndjson|parquet)(\.gz|\.zst)?$", path.name, re.I) and path.is_file():
        with covered("it cannot be read as a table"):
            return read_table(path, document.head)
    with covered("what it reads is not to be found"):
        atoms = [each.data + each.key for each in document.claims]
        wanted: dict[str, dict[int, Json]] = {name: {} for name in topics_of(atoms)}
        for part in parts(atoms):
            if "path" in part:
                wanted[part["topic"]][id(part)] = part
    bags = [at for at in files_of(path) if at.name != "metadata.yaml"]
    for paths in ([path], bags):  # by some old metadata rosbags finds nothing, but by the files
        with covered("rosbags cannot read it"), closing(opened(paths, document.head)) as reader:
            if reader.message_count:
                return read_bag(reader, document.head, wanted)
    raise Refused("the recording has no messages")


def opened(paths: list[Path], head: Section) -> Any:
    """The bag at some paths; where it defines no messages, they are those of the release that the digests are of."""
    from rosbags.highlevel import AnyReader, AnyReaderError  # noqa: TID251
    from rosbags.typesys import Stores, get_typestore  # noqa: TID251

    wanted = head.digests("definition")
    releases = sorted(Stores, key=lambda store: store is not Stores.ROS2_JAZZY)
    for release in (None, *(each for each in releases if each.name.startswith("ROS2_"))):
        reader = AnyReader(paths, default_typestore=get_typestore(release) if release else None)
        with suppress(AnyReaderError) if release is None else nullcontext():
            reader.open()
            if wanted == {name: definition_digest(reader.typestore, name) for name in wanted}:
                return reader
            reader.close()
    raise Refused("its messages are not defined as written, neither by itself nor by a release of ROS 2")


def definition_digest(store: Any, name: str) -> str:
    """The digest of the definition of a message, and of all that is in it."""
    found, todo = {}, [name]
    while todo:
        of = todo.pop()
        if of not in found and of in store.fielddefs:
            fields = [(type_text(*kind), name) for name, kind in store.fielddefs[of][1]]
            found[of] = f"{of}: {', '.join(f'{kind} {name}' for kind, name in fields)}\n"
            todo += [kind.partition("[")[0] for kind, _ in fields]
    return sha256("".join(found[of] for of in sorted(found)))


def type_text(of: Any, what: Any) -> str:
    """The type of a field, as rosbags has it."""
    match of.name:
        case "BASE":
            return "uint8" if what[0] in ("byte", "octet", "char") else str(what[0])
        case "NAME":
            return str(what)
        case _:
            return f"{type_text(*what[0])}[{what[1] if of.name == 'ARRAY' else ''}]"


def read_bag(reader: Any, head: Section, wanted: dict[str, dict[int, Json]]) -> Recording:
    """The messages on the topics that are wanted, and of each of these the fields."""
    found, by_header, takers = Recording(), head.one("stamp") == "header", {}
    for name, fields in wanted.items():
        numbers = found.topics.setdefault(name, [])
        found.samples |= {what: (numbers, []) for what in fields}
    for connection in reader.connections:
        name = f"/{connection.topic.lstrip('/')}"
        types = {each["type"] for each in wanted.get(name, {}).values()}
        if types - {connection.msgtype}:
            raise NotCovered(f"{name} has messages of type {connection.msgtype}")
        if undefined := sorted(types - head.digests("definition").keys()):
            raise Refused(f"how messages are defined is not written: {', '.join(undefined)}")
        if name in wanted:
            keeps = [(found.samples[what][1].append, getter(each["path"])) for what, each in wanted[name].items()]
            takers[id(connection)] = found.topics[name].append, keeps
    first, last = 2**63, -(2**63)
    for connection, time, raw in reader.messages():
        first, last = min(first, time), max(last, time)
        if id(connection) not in takers:
            continue
        add, keeps = takers[id(connection)]
        message = reader.deserialize(raw, connection.msgtype) if keeps or by_header else None
        if by_header and (stamp := getattr(getattr(message, "header", None), "stamp", None)) is not None:
            time = stamp.sec * SECOND + stamp.nanosec
            if not time:
                continue
        add(len(found.times))
        found.times.append(time)
        for keep, get in keeps:
            keep(get(message))
    found.settle(head, None if by_header else (first, last))
    return found


def read_table(path: Path, head: Section) -> Recording:
    """The rows of a table: each is a message on the topics of every signal that has a cell in it."""
    found, (times, columns) = Recording(), table_at(path)
    found.times = times
    for row, x in zip(head.said.get("signal", []), head.data, strict=True):
        name, kind, _ = row.split(" ", 2)
        cells, index = cells_of(columns, name, kind, x)
        values = [None if cell is None else value_of(cell, kind, index) for cell in cells]
        numbers = [n for n, cell in enumerate(cells) if cell is not None and (x.get("path") != [] or values[n])]
        for topic in topics_of(x):
            found.topics[topic] = [*found.topics.get(topic, []), *numbers]
        if cells or "path" in x:  # what has no column is computed, unless it is a field
            found.samples[id(x)] = numbers, [values[n] for n in numbers]
    found.settle(head, None)
    return found


def table_at(path: Path) -> tuple[list[int], dict[str, list[Any]]]:
    """The times of the rows of a table in ns, and its cells by the heads of their columns, None if there is none."""
    import pyarrow as pa
    from pyarrow import parquet

    unit = SECOND
    if path.suffix.lower() == ".parquet":
        table = parquet.read_table(path)
        columns = {name: table[name].to_pylist() for name in table.column_names if name not in TIMES}
        [times] = (table[name] for name in table.column_names if name in TIMES)
        if pa.types.is_timestamp(times.type):
            times = times.cast(pa.timestamp("ns")).cast(pa.int64())
        unit = 1 if pa.types.is_integer(times.type) else SECOND
        columns["time"] = times.cast(pa.string()).to_pylist()
    else:
        with io.TextIOWrapper(pa.input_stream(str(path)), "utf-8-sig", newline="") as text:
            if ".csv" in path.name.lower():
                table = csv.DictReader(text, strict=True)
                rows = [{head: cell if cell.strip() else None for head, cell in row.items()} for row in table]
            else:
                rows = [json.loads(line, parse_float=Decimal) for line in text if line.strip()]
        columns = {head: [row.get(head) for row in rows] for head in dict.fromkeys(itertools.chain(*rows))}
    times = columns.pop(next(head for head in TIMES if head in columns))
    times = [int((Decimal(time) * unit).to_integral_value()) for time in times]
    return times, {as_by_topic(head) if head.startswith("/") else head: cells for head, cells in columns.items()}


def as_by_topic(head: str) -> str:
    """The head of a column by topic and field, which may stand after a dot, as an index with PlotJuggler did once."""
    return re.sub(r"\.([0-9]+)(?=[./]|$)", r"[\1]", head).replace(".", "/")


def cells_of(columns: dict[str, list[Any]], name: str, kind: str, x: Json) -> tuple[list[Any], int | None]:
    """The cells of a signal: of its own column, or that of its topic and field, or those of the elements of an array.

    Of an array of which it is an element, its index, too.
    """
    heads, path = [name], x.get("path", [None])
    if all(isinstance(step, str | int) or step == ["each"] for step in path):
        steps = (f"/{s}" if isinstance(s, str) else f"[{'' if s == ['each'] else s}]" for s in path)
        heads.append(x["topic"] + "".join(steps))
    for head in heads:
        if head in columns:
            return columns[head], None
        array, _, index = head.removesuffix("]").rpartition("[")
        if kind.endswith("[]"):
            numbered = (head if "[]" in head else f"{head}[]").replace("[]", "[{}]")
            elements = itertools.takewhile(columns.__contains__, map(numbered.format, itertools.count()))
            rows = [[*row] for row in zip(*(columns[each] for each in elements), strict=True)]
            if rows:
                return [list(itertools.takewhile(lambda cell: cell is not None, row)) or None for row in rows], None
        elif array in columns:
            return columns[array], int(index)
    return [], None


def value_of(cell: Any, kind: str, index: int | None) -> Any:
    """The value in a cell, as a field of a type has it; None if its array is too short."""
    if kind.endswith("[]") or index is not None:
        cells = json.loads(cell) if isinstance(cell, str) else cell
        values = [value_of(each, kind.removesuffix("[]"), None) for each in cells]
        return values if index is None else values[index] if index < len(values) else None
    match kind:
        case "string":
            return cell
        case "bool":
            word = str(cell).strip().lower()
            return word == "true" or (word != "false" and float(word) == 1)
        case "float32":
            return float(np.float32(float(cell)))
        case "float64":
            return float(cell)
        case _:
            return int(Decimal(cell))


# Values and functions ------------------------------------------------------------------------------------------------


def column(values: Any) -> Array:
    """Values of one type as an array: booleans; doubles; integers that are doubles; anything else as it is."""
    if len(values) and isinstance(values[0], list | np.ndarray):
        return as_objects([column(each) for each in values])
    found = np.asarray(values)
    is_rounded = found.dtype.kind == "f" and isinstance(values, list) and int in {*map(type, values)}
    if found.dtype.kind in "UO" or is_rounded:
        return as_objects(values)
    if found.dtype.kind in "iu":
        is_wide = found.size and (found.min() < -EXACT or found.max() > EXACT)
        return found.astype(object if is_wide else np.int64)
    return found.astype(np.float64 if found.dtype.kind == "f" else bool)


def as_objects(values: Any) -> Array:
    """Values as they are."""
    return np.fromiter(values, object, len(values))


def is_nan(values: Array) -> Array:
    """Where they are NaN."""
    return np.asarray(values != values).astype(bool)


COMPARISONS = {
    "<": np.less,
    "<=": np.less_equal,
    ">": np.greater,
    ">=": np.greater_equal,
    "==": np.equal,
    "same": np.equal,
}


def compared(op: str, left: Array, right: Array, margin: float) -> Array:
    """A comparison: exact without a margin, in doubles with one."""
    if op not in COMPARISONS:
        raise Refused(f"no such comparison: {op}")
    if not margin:
        return COMPARISONS[op](left, right).astype(bool)
    left, right = left.astype(np.float64), right.astype(np.float64)
    return (left == right) | (np.abs(left - right) <= margin) if op == "==" else COMPARISONS[op](left, right + margin)


def called(name: str, given: list[Array], of: list[Json]) -> Array:
    """A function of numbers `of` these expressions."""
    match name:
        case "neg":
            return -given[0]
        case "abs":
            return np.abs(given[0])
        case "min" | "max":  # of integers, and constants that are such, exactly
            pairs = zip(given, of, strict=True)
            if not all(each.dtype != np.float64 or (isinstance(x, float) and x.is_integer()) for each, x in pairs):
                given = [each.astype(np.float64) for each in given]
            is_better = np.less if name == "min" else np.greater
            best = reduce(lambda one, other: np.where(is_better(other, one), other, one), given)
            return np.where(reduce(np.logical_or, map(is_nan, given)), math.nan, best)
        case _ if name in FUNCTIONS:
            return FUNCTIONS[name](*(each.astype(np.float64) for each in given))
        case _:
            raise NotCovered(f"the function {name}")


def pointwise(function: Callable[..., float]) -> Callable[..., Array]:
    """A function of Python's: of NaN, and outside of its domain, it is NaN; too large, infinite."""

    def value(*given: float) -> float:
        if any(map(math.isnan, given)):
            return math.nan
        try:
            return function(*given)
        except ValueError:
            return math.nan
        except OverflowError:
            return math.inf

    return np.vectorize(value, otypes=[np.float64])


def unit(*q: float) -> list[float]:
    """The quaternion of length 1 that is the same orientation."""
    length = math.hypot(*q)
    if not 0 < length < math.inf:
        raise ValueError("no orientation")
    return [each / length for each in q]


def euler(name: str, *q: float) -> float:
    """The angle about an axis of an orientation, which is yaw about z, then pitch about y, then roll about x."""
    x, y, z, w = unit(*q)
    match name:
        case "roll":
            return math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
        case "pitch":
            return math.asin(max(-1.0, min(1.0, 2 * (w * y - z * x))))
        case _:
            return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def angle(*both: float) -> float:
    """Between two orientations, by half of it: the tangent is that of their difference and their sum."""
    p, q = unit(*both[:4]), unit(*both[4:])
    apart = math.hypot(*(a - b for a, b in zip(p, q, strict=True)))
    together = math.hypot(*(a + b for a, b in zip(p, q, strict=True)))
    return 4 * math.atan2(min(apart, together), max(apart, together))


def edges(corners: tuple[float, ...]) -> Iterator[tuple[float, ...]]:
    """From each corner to the next, and from the last to the first."""
    points = [corners[n : n + 2] for n in range(0, len(corners), 2)]
    return ((*one, *other) for one, other in zip(points, [*points[1:], points[0]], strict=True))


@lru_cache(1 << 16)
def inside(x: float, y: float, *corners: float) -> float:
    """Whether a point is on the border, or the border crosses the ray to its right an odd number of times, exactly."""
    if not math.isfinite(x) or not math.isfinite(y):
        return 0.0
    px, py, odd = Fraction(x), Fraction(y), False
    for edge in edges(corners):
        ax, ay, bx, by = map(Fraction, edge)
        turn = (bx - ax) * (py - ay) - (by - ay) * (px - ax)
        if turn == 0 and min(ax, bx) <= px <= max(ax, bx) and min(ay, by) <= py <= max(ay, by):
            return 1.0
        if (ay > py) != (by > py):
            odd ^= (turn > 0) == (by > ay)
    return float(odd)


def distance(x: float, y: float, *corners: float) -> float:
    """From the nearest edge; 0 inside."""
    if inside(x, y, *corners):
        return 0.0
    return min(from_edge(x - ax, y - ay, bx - ax, by - ay) for ax, ay, bx, by in edges(corners))


def from_edge(x: float, y: float, along: float, across: float) -> float:
    """Of a point from an edge that begins at 0."""
    if 0 < x * along + y * across < along * along + across * across:
        return abs(along * y - across * x) / math.hypot(along, across)
    return min(math.hypot(x, y), math.hypot(x - along, y - across))


FUNCTIONS: dict[str, Callable[..., Array]] = {
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.true_divide,
    "sqrt": np.sqrt,
    "floor": lambda x: np.floor(x) + 0.0,
    "ceil": lambda x: np.ceil(x) + 0.0,
    "sign": lambda x: np.sign(x) + 0.0,
    "gap": lambda x, y: np.where(x == y, 0.0, x - y),
    **{name: pointwise(getattr(math, name)) for name in ("exp", "sin", "cos", "tan", "asin", "acos", "atan2", "hypot")},
    "log": pointwise(lambda x: -math.inf if x == 0 else math.log(x)),
    "mod": lambda x, y: np.mod(x, y) + 0.0,
    "angle_between": pointwise(lambda one, other: abs(math.remainder(one - other, math.tau))),
    **{name: pointwise(partial(euler, name)) for name in ("roll", "pitch", "yaw")},
    "angle": pointwise(angle),
    "inside": pointwise(inside),
    "distance": pointwise(distance),
}
"""Functions of doubles, by numpy where that computes as IEEE 754 has it."""


def of_array(name: str, array: Array) -> Any:
    """A function of the elements of an array; but for their sum, of those that are not NaN."""
    if name == "len":
        return len(array)
    if name == "sum":
        return total(array.astype(np.float64).tolist())
    known = array[~is_nan(array)]
    if not len(known):
        return math.nan
    match name:
        case "min" | "max":
            return known[known.argmin() if name == "min" else known.argmax()]
        case "mean":
            return total(known.astype(np.float64).tolist()) / len(known)
        case "median":
            return median(known.astype(np.float64).tolist())
        case _:
            raise NotCovered(f"the function {name} of an array")


def total(values: list[float]) -> float:
    """The double nearest to the sum."""
    infinite = {value for value in values if not math.isfinite(value)}
    if infinite:
        return infinite.pop() if len(infinite) == 1 else math.nan
    with suppress(OverflowError):
        return math.fsum(values) + 0.0
    exact = sum(map(Fraction, values))
    with suppress(OverflowError):
        return float(exact)
    return math.inf if exact > 0 else -math.inf


def median(values: list[float]) -> float:
    """The middle one; of an even number the double nearest to the mean of the middle two."""
    values = sorted(values)
    low, high = values[(len(values) - 1) // 2], values[len(values) // 2]
    return float((Fraction(low) + Fraction(high)) / 2) if math.isfinite(low) and math.isfinite(high) else low + high


def nearest(sought: float, array: Array) -> float:
    """The first element that differs least."""
    known = array[~is_nan(array)].astype(np.float64)
    if math.isnan(sought) or not len(known):
        return math.nan
    return float(known[np.where(known == sought, 0.0, np.abs(known - sought)).argmin()])


# Expressions ---------------------------------------------------------------------------------------------------------

YES, NO = np.ones(1, bool), np.zeros(1, bool)


class Series(NamedTuple):
    """What an expression or a condition is at each instant; with one entry, it is that at all of them.

    It is `known` once all that is waited for has a value; until then it is anything. It is `fresh` where something that
    is read is new, and `wrong` where something compared is NaN, or a first value does not come with its message.
    """

    now: Array
    known: Array = YES
    fresh: Array = NO
    wrong: Array = NO


def combined(now: Array, *of: Series) -> Series:
    """What is made of others."""
    known = reduce(np.logical_and, [each.known for each in of], YES)
    fresh, wrong = (reduce(np.logical_or, [getattr(each, name) for each in of], NO) for name in ("fresh", "wrong"))
    return Series(now, known, fresh, wrong)


class Values:
    """The values of expressions at the instants of a run: the messages on some topics, or the ticks that see them."""

    def __init__(self, recorded: Recording, topics: Iterable[str], rate: Fraction | None, session: int | None) -> None:
        """With `session`, an instant of its own is the first, or the first tick is then."""
        places = np.unique(np.concatenate([np.zeros(0, np.int64), *(recorded.topics[name] for name in topics)]))
        own = np.array([] if session is None else [session], np.int64)
        self.recorded, self.is_ticks = recorded, rate is not None
        self.times: Array = np.append(own, recorded.times[places])
        self.seen = np.append(np.full(len(own), -1), places).searchsorted(np.arange(len(recorded.times)))
        """At which instant each message is seen; too large a number: at none."""
        if rate is not None and len(self.times):
            self.times = ticks(rate, int(self.times[0]), recorded.last)
            self.seen = self.times.searchsorted(recorded.times)
        self.count = len(self.times)
        self.found: dict[int, Series] = {}
        self.taken: dict[int, Array] = {}
        """Of each scope, at which instant the value at its opening was taken."""

    def heard(self, topics: Iterable[str], *, now: bool = False) -> Array:
        """Where there is news of some topics; with `now`, at this very time."""
        found = np.zeros(self.count + 1, bool)
        for places in (self.recorded.topics[name] for name in topics):
            found[self.seen[places[self.is_seen_at_once(places)] if now else places]] = True
        return found[:-1]

    def is_seen_at_once(self, places: Array) -> Array:
        """Whether messages are seen at their own time."""
        return np.append(self.times, -1)[self.seen[places]] == self.recorded.times[places]

    def value(self, x: Json, given: dict[int, Series] | None = None) -> Series:
        """What an expression or a condition is, or with elements of arrays, all of which are `given`."""
        found = self.found if given is None else given
        if not isinstance(x, dict):
            return Series(YES if x is True else column([x]))
        if id(x) not in found:
            found[id(x)] = self.made(x, lambda part: self.value(part, given))
        return found[id(x)]

    def made(self, x: Json, value: Callable[[Json], Series]) -> Series:
        """What it is, of the values of its parts."""
        match x:
            case _ if id(x) in self.recorded.samples:
                return self.latest(x)
            case {"not": operand}:
                return combined(~value(operand).now, value(operand))
            case {"and": of} | {"or": of}:
                operands = [value(each) for each in of]
                join = np.logical_and if "and" in x else np.logical_or
                return combined(reduce(join, [each.now for each in operands]), *operands)
            case {"op": "true", "left": of}:
                return combined(value(of).now.astype(bool), value(of))
            case {"op": op, "left": left, "right": right}:
                sides = value(left), value(right)
                is_missing = is_nan(sides[0].now) | is_nan(sides[1].now)
                holds = compared(op, sides[0].now, sides[1].now, x.get("margin", 0.0))
                return combined(holds, *sides, Series(holds, wrong=is_missing))
            case {"predicate": predicate}:
                return value(predicate)
            case {"count": predicate}:
                return self.count_of(predicate, x.get("over", []))
            case {"number": text}:
                return Series(column([float(text)]))
            case {"slice": [start, stop], "of": array}:
                return self.one_by_one(lambda of: of[start:stop], value(array))
            case {"call": "len" | "sum" | "min" | "max" | "mean" | "median" as name, "of": [array]}:
                return self.one_by_one(partial(of_array, name), value(array))
            case {"call": "nearest", "of": [sought, array]}:
                return self.one_by_one(nearest, value(sought), value(array))
            case {"call": name, "of": of}:
                given = [value(each) for each in of]
                return combined(called(name, [each.now for each in given], of), *given)
            case {"new": topics}:
                return Series(self.heard(topics), fresh=self.heard(topics))
            case {"message": topics}:
                return Series(self.heard(topics, now=True), fresh=self.heard(topics))
            case {"opening": of, "scope": number}:
                everywhere = np.broadcast_to(value(of).now, self.count)
                return Series(everywhere[self.taken[number]], value(of).known, value(of).fresh)
            case {"instead": constant, "of": of}:
                first = [self.heard([topic]) for topic in x.get("news", [])]
                is_late = reduce(np.logical_and, first) & ~value(of).known if first else NO
                now = np.where(value(of).known, value(of).now, value(constant).now)
                return Series(now, fresh=value(of).fresh, wrong=value(of).wrong | is_late)
            case _:
                return self.latest(x)

    def latest(self, x: Json) -> Series:
        """What is read of the samples of a signal."""
        of = x["of"] if x.keys() & {"ago", "recent", "slope"} else x
        ago = 1 if "slope" in x else x.get("ago", x.get("recent", 0))
        values, is_sample, fresh = self.samples(of)
        known, wrong = is_sample.cumsum() > ago, NO
        if "slope" in x:
            seconds = [past / SECOND or math.nan for past in np.diff(self.times[is_sample]).tolist()]
            values = np.append(math.nan, np.diff(values.astype(np.float64)) / seconds)
        elif "recent" in x:
            values = as_objects([values[max(n - ago, 0) : n + 1] for n in range(len(values))])
            wrong = self.held(as_objects([is_nan(each).any() for each in values]), is_sample).astype(bool)
        return Series(self.held(values, is_sample, x.get("ago", 0)), known, fresh, wrong)

    def held(self, values: Array, at: Array, ago: int = 0) -> Array:
        """The latest of some values at each instant, which come `at` some of them, or that so many before."""
        return values[np.maximum(at.cumsum() - 1 - ago, 0)] if len(values) else np.full(self.count, math.nan)

    def samples(self, x: Json) -> tuple[Array, Array, Array]:
        """The samples of a signal; at which instants there is one; where something of which they are made is new.

        What is computed has one where a part has one; with `when` only where that holds, and nothing compared is NaN.
        """
        if "when" not in x and id(x.get("sampled")) in self.recorded.samples:
            x = x["sampled"]
        if id(x) in self.recorded.samples:
            places, values = self.recorded.samples[id(x)]
            latest = self.seen[places].searchsorted(np.arange(self.count), "right") - 1
            at = (latest >= 0) & (self.is_ticks | (np.diff(latest, prepend=-1) > 0))
            return values[latest[at]], at, at
        of, when, *measured = map(self.value, [x["sampled"], x.get("when", True), *x.get("measured", [])])
        every = combined(when.now, of, when, *measured)
        at = every.fresh & every.known
        if "when" in x:
            at = reduce(np.logical_and, [~is_nan(each.now) for each in (of, *measured)], at & when.now & ~when.wrong)
        at, fresh, now = np.broadcast_arrays(at, every.fresh, of.now, np.zeros(self.count))[:3]
        return now[at], at, fresh

    def one_by_one(self, function: Callable[..., Any], *of: Series) -> Series:
        """What a function gives of some values; it is called where one of them may have changed."""
        every = combined(YES, *of)
        is_new = every.fresh | np.append(True, every.fresh[:-1])
        is_new, *given = np.broadcast_arrays(is_new & every.known, *(each.now for each in of), np.zeros(self.count))[
            :-1
        ]
        found = [function(*(each[n] for each in given)) for n in np.flatnonzero(is_new)]
        return combined(self.held(column(found), is_new), *of)

    def count_of(self, predicate: Json, over: list[list[Json]]) -> Series:
        """How many elements satisfy a predicate; NaN where something beside them is, or there are too many.

        Arrays in one group of `over` are taken side by side, and the groups all with all: each of them is an axis. No
        element satisfies the predicate for which something that is compared is NaN.
        """
        elements = [part for part in parts(predicate) if "element" in part]
        arrays, beside = [each["element"] for each in elements], [*beside_elements(predicate)]
        groups = over or [arrays]
        axes = [next(n for n, group in enumerate(groups) if each in group) for each in arrays]

        def count(*values: Any) -> float:
            lists, others = values[: len(axes)], [column([each]) for each in values[len(axes) :]]
            sizes = [min(len(a) for a, axis in zip(lists, axes, strict=True) if axis == n) for n in range(len(groups))]
            if any(is_nan(each)[0] for each in others) or (len(sizes) > 1 and math.prod(sizes) > MOST_COMBINATIONS):
                return math.nan
            given = {id(part): Series(value) for part, value in zip(beside, others, strict=True)}
            for part, array, axis in zip(elements, lists, axes, strict=True):
                shape = [-1 if n == axis else 1 for n in range(len(sizes))]
                given[id(part)] = Series(array[: sizes[axis]].reshape(shape))
            found = self.value(predicate, given)
            return int(np.count_nonzero(np.broadcast_to(found.now & ~found.wrong, sizes)))

        return self.one_by_one(count, *map(self.value, [*arrays, *beside]))


def beside_elements(x: Json) -> Iterator[Json]:
    """The largest expressions beside elements that read something."""
    if isinstance(x, list):
        for part in x:
            yield from beside_elements(part)
    elif isinstance(x, dict) and "element" not in x:
        if x.keys() & {"op", "not", "and", "or"} or any("element" in part for part in parts(x)):
            yield from beside_elements([*x.values()])
        elif topics_of(x):
            yield x


def ticks(rate: Fraction, start: int, end: int) -> Array:
    """The times of ticks, cut off to nanoseconds."""
    period = SECOND / rate
    count = max(0, ((end - start + 1) * period.denominator - 1) // period.numerator + 1)
    if count > MOST_TICKS:
        raise NotCovered(f"more than {MOST_TICKS} ticks")
    return np.array([start + k * period.numerator // period.denominator for k in range(count)], np.int64)


# Letters -------------------------------------------------------------------------------------------------------------


class Run(NamedTuple):
    """The instants of a property that may have lines: times and letters; since when ages count; the bits of news."""

    times: Array
    letters: Array
    session: int
    news: int

    def lines(self, until: int) -> tuple[int, str]:
        """How many instants have a line, and their text.

        That are the first, a letter that is not the one held, and a time that is that of the line before.
        """
        end = int(self.times.searchsorted(until, "right"))
        times, letters = self.times[:end], self.letters[:end]
        differs = np.append(True, letters[1:] != (letters[:-1] & ~self.news))[:end]
        for n in np.flatnonzero(times[1:] == times[:-1]) + 1:
            differs[n] |= differs[n - 1]
        times, letters = times[differs], letters[differs].tolist()
        words = {letter: "".join(f" a{n}" for n in range(63) if letter >> n & 1) for letter in {*letters}}
        gaps = np.diff(times, prepend=times[:1]).tolist()
        text = "".join([f"+{gap}{words[letter]}\n" for gap, letter in zip(gaps, letters, strict=True)])
        return len(times), f"at {times[0]}{text[2:]}" if text else ""


class Scope:
    """A scope of a property: its number, and from which steps up to which it is said to be open."""

    def __init__(self, text: str) -> None:
        self.text, [number, *spans] = text, text.split(" ")
        self.number, pairs = int(number), [span.split("-") for span in spans]
        self.spans = [slice(int(first), int(end) if end else None) for first, end in pairs]

    def open(self, count: int) -> Array:
        """At which steps it is open."""
        found = np.zeros(count, bool)
        for span in self.spans:
            found[span] = True
        return found

    def taken(self, is_step: Array) -> Array:
        """For each instant, at which one the value at the opening was taken: at itself unless it was open before."""
        before = np.append(False, self.open(int(np.count_nonzero(is_step))))[np.cumsum(is_step) - is_step]
        return np.maximum.accumulate(np.where(before, 0, np.arange(len(is_step))))

    def check(self, count: int) -> None:
        """Raise Refused if of so many steps it is not said as it should be."""
        turns = np.flatnonzero(np.diff(self.open(count).astype(np.int8), prepend=0)).tolist()
        spans = [f" {first}-{end}" for first, end in itertools.zip_longest(turns[::2], turns[1::2], fillvalue="")]
        if self.text != "".join([str(self.number), *spans]):
            raise Refused(f"from which steps on scope {self.number} is open is not written as it should be")


def run_of(claim: Section, recorded: Recording, head: Section, *, apart: bool) -> Run:
    """The run of a property. With `apart`, what begins with the session has an instant of its own there."""
    with covered("its atoms cannot be computed"), np.errstate(all="ignore"):
        atoms, rate = claim.data, Fraction(head.one("rate")) if head.one("rate") else None
        begins = not is_waited_for(atoms) and (apart or rate is not None)
        key = frozenset(topics_of(atoms)), begins
        if key not in recorded.kept:
            recorded.kept[key] = Values(recorded, key[0], rate, recorded.first if begins else None)
        values, scopes = recorded.kept[key], [Scope(each) for each in claim.said.get("scope", [])]
        is_step = np.zeros(values.count, bool)
        for _ in range(MOST_ROUNDS):
            if scopes:
                values, before = Values(recorded, key[0], rate, recorded.first if begins else None), is_step
                values.taken = {scope.number: scope.taken(before) for scope in scopes}
            every = combined(YES, *map(values.value, atoms))
            is_step = np.broadcast_to(every.fresh | values.is_ticks, values.count).copy()
            is_step[:1] |= begins
            is_step &= every.known & ~every.wrong
            is_step[: values.seen[recorded.begins] if recorded.begins else 0] = False
            if not scopes or np.array_equal(is_step, before):
                break
        else:
            raise NotCovered("which steps there are depends on values at openings")
        letters = np.zeros(values.count, np.int64)
        for n, scope in enumerate(scopes, len(atoms)):
            scope.check(int(values.times[is_step].searchsorted(claim.time("until") or 0, "right")))
            letters[is_step] |= scope.open(int(np.count_nonzero(is_step))).astype(np.int64) << n
        news, messages = 0, {}
        for n, atom in enumerate(atoms):
            letters |= values.value(atom).now.astype(np.int64) << n
            of = atom["left"] if atom["op"] == "true" and isinstance(atom["left"], dict) else {}
            news |= ("new" in of or "message" in of) << n
            if "message" in of:
                messages[1 << n] = of["message"]
        run = Run(values.times[is_step], letters[is_step], recorded.first, news)
        return with_messages(run, is_step, values, messages) if len(run.times) else run


def with_messages(run: Run, is_step: Array, values: Values, messages: dict[int, list[str]]) -> Run:
    """The steps, and between them the messages that make none, but from which ages count; of each the bit."""
    all_times, bits = values.recorded.times, np.zeros(len(values.recorded.times), np.int64)
    for bit, name in ((bit, name) for bit, names in messages.items() for name in names):
        bits[values.recorded.topics[name]] |= bit
    places = np.flatnonzero(bits)
    places = places[~(np.append(is_step, False)[values.seen[places]] & values.is_seen_at_once(places))]
    before = np.flatnonzero(is_step).searchsorted(values.seen[places])
    early, late = places[before == 0], places[before > 0]
    last = [all_times[early[bits[early] & bit > 0]][-1:].tolist() for bit in messages if not run.letters[0] & bit]
    if any(each != last[0] for each in last):
        raise NotCovered("its ages count from different messages before its first step")
    where, held = before[before > 0], run.letters & ~run.news
    return Run(
        np.insert(run.times, where, all_times[late]),
        np.insert(run.letters, where, held[where - 1] | bits[late]),
        last[0][0] if last and last[0] else run.session,
        run.news,
    )


def is_waited_for(x: Json) -> bool:
    """Whether something is read that has a first value, and nothing instead of it."""
    if isinstance(x, dict) and "instead" not in x:
        return "path" in x or any(map(is_waited_for, x.values()))
    return isinstance(x, list) and any(map(is_waited_for, x))


# The comparison ------------------------------------------------------------------------------------------------------


def check_document(document: Document, path: Path, say: Callable[[str], None]) -> int:
    """Check all claims, and say what is found; the exit code."""
    head, claims, codes = document.head, document.claims, [0]
    for each in document.not_covered:
        say(": nothing is claimed: ".join(each.split(": ", 1)))
    if not claims:
        return 0
    with answered("", say, codes):
        if ("stamp" in head.said or "timeout" in head.said) and document.not_covered:
            raise Refused("something is claimed of some properties only, though the run depends on all")
        recorded = read(path, document)
        ends = end_of(document, recorded)
        for claim in claims:
            label = claim.one("property")
            with answered(f"{label}: ", say, codes):
                counts = check_claim(claim, recorded, head, ends)
                say(f"{label}: the letters are as stated; {counts}")
    return 1 if 1 in codes else max(codes)


@contextmanager
def answered(label: str, say: Callable[[str], None], codes: list[int]) -> Iterator[None]:
    """Say what is refused or not covered."""
    try:
        yield
    except Refused as error:
        say(f"{label}REFUSED: {error}")
        codes.append(1)
    except NotCovered as error:
        say(f"{label}NOT COVERED: {error}")
        codes.append(2)


def end_of(document: Document, recorded: Recording) -> int:
    """When the run ends: with the recording, or so long after the first step of a property."""
    timeout = document.head.time("timeout")
    if timeout is None:
        return recorded.last
    runs = [run_of(claim, recorded, document.head, apart=True) for claim in document.claims]
    return min([recorded.last, *(int(run.times[0]) + timeout for run in runs if len(run.times))])


def slices_of(claim: Section, recorded: Recording) -> dict[str, Recording]:
    """The slices of all ids, as JSON, in the order of their first messages."""
    [key] = claim.key
    own = [each for each in parts(claim.data) if "path" in each and ["own"] in each["path"]]
    places, values = recorded.samples[id(key)]
    having = [dict(zip(*map(list, recorded.samples[id(each)]), strict=True)) for each in own]
    found: dict[str, list[tuple[int, int]]] = {}
    for place, ids in zip(places.tolist(), values, strict=True):
        is_array = isinstance(ids, np.ndarray)
        count = min([len(ids), *(len(each.get(place, [])) for each in having)]) if is_array else 1
        for at, value in enumerate(ids[:count] if is_array else [ids]):
            if (one := id_of(value)) is not None:
                found.setdefault(json.dumps(one), []).append((place, at))
    return {one: slice_of(recorded, key["topic"], messages, claim) for one, messages in found.items()}


def slice_of(recorded: Recording, topic: str, messages: list[tuple[int, int]], claim: Section) -> Recording:
    """A recording with some messages on a topic, of whose arrays each has one element; and all on other topics."""
    found = Recording()
    others = np.setdiff1d(np.arange(len(recorded.times)), recorded.topics[topic])
    numbers, elements = (np.array(each, np.int64) for each in zip(*messages, strict=True))
    old = np.append(others, numbers)
    order = old.argsort(kind="stable")
    new = np.empty(len(order), np.int64)
    new[order] = np.arange(len(order))
    ours = new[len(others) :]
    found.times, found.first, found.last, found.begins = (
        recorded.times[old[order]],
        recorded.first,
        recorded.last,
        ours[0],
    )
    for name, places in recorded.topics.items():
        found.topics[name] = ours if name == topic else new[others.searchsorted(places)]
    for field in (part for part in parts(claim.data) if "path" in part):
        places, values = recorded.samples[id(field)]
        if field["topic"] != topic:
            found.samples[id(field)] = new[others.searchsorted(places)], values
            continue
        value_of = dict(zip(places.tolist(), values, strict=True))
        having = [n for n, place in enumerate(numbers.tolist()) if place in value_of]
        given = [value_of[numbers[n]] for n in having]
        is_own = ["own"] in field["path"]
        some = [each[elements[n]] for n, each in zip(having, given, strict=True)] if is_own else given
        found.samples[id(field)] = ours[having], column(some)
    return found


def id_of(value: Any) -> Any:
    """A value as an id: whole numbers are integers, and NaN is none."""
    value = value.item() if isinstance(value, np.generic) else value
    if isinstance(value, float) and value.is_integer():
        return int(value)
    return None if value != value else value


def check_slices(claim: Section, recorded: Recording, head: Section, ends: int) -> str:
    """Compute what is claimed of each slice, and of all of them; how many there are."""
    if head.said.keys() & {"rate", "timeout", "signal"}:
        raise NotCovered("ids at ticks, with a timeout, or in tables")
    with covered("its ids cannot be computed"):
        found = slices_of(claim, recorded)
    stated = claim.slices
    if claim.said.get("slice", []) != [*found]:
        raise Refused(f"the ids are {', '.join(found)[:200]}")
    for one, part in stated.items():
        try:
            check_claim(part, found[one], head, ends)
        except Refused as error:
            raise Refused(f"slice {one}: {error}") from None
        claim.lines += part.lines
    [(until, verdict, decided)] = re.findall(r"^until (.+)\nverdict (.+) (.+)\n\Z", claim.text, re.M)
    if until != decided or (verdict != "violated" and until != str(ends)):
        raise Refused(f"the run ends at {ends}")
    return f"ids: {len(found)}"


def check_claim(claim: Section, recorded: Recording, head: Section, ends: int) -> str:
    """Compute what is claimed of a run that ends at `ends` at the latest; how many instants and lines it has."""
    if claim.key:
        return check_slices(claim, recorded, head, ends)
    verdict, _, decided = claim.one("verdict").partition(" ")
    until = int(claim.one("until"))
    if decided != str(until) or (until > ends if verdict in ("violated", "satisfied") else until != ends):
        raise Refused(f"the run ends at {ends}")
    problems = []
    # Where a message has the time at which the session begins, that may have an instant of its own, or not.
    for apart in (True, False):
        run = run_of(claim, recorded, head, apart=apart)
        count, lines = run.lines(until)
        found = f"letters {count} sha256 {sha256(lines)}\n" if "letters" in claim.said else lines
        stated = claim.text[claim.text.index("\nsession ") + 1 : claim.text.index("\nuntil ") + 1]
        pairs = itertools.zip_longest(stated.split("\n"), f"session {run.session}\n{found}".split("\n"), fillvalue="")
        wrong = [f"stated: {one or 'nothing'}; computed: {other or 'nothing'}" for one, other in pairs if one != other]
        if (verdict == "not_started") != (count == 0):
            wrong.append("it has started" if count else "it has not started")
        if not wrong:
            claim.lines = [lines] * ("letters" in claim.said)
            return f"instants: {len(run.times)}, lines: {count}"
        problems += wrong
    raise Refused(problems[0])


def main(arguments: list[str]) -> int:
    """What the command line asks for; the exit code."""
    parser = argparse.ArgumentParser(description="Check that recordings have the letters that an evidence states.")
    parser.add_argument("evidence", type=Path, help="what `ltlc run --evidence` wrote")
    parser.add_argument("recording", type=Path, nargs="+", help="what was judged, by its old name")
    parser.add_argument("--fill", type=Path, help="write the evidence here, with lines in place of their digests")
    options = parser.parse_args(arguments)
    try:
        return check(options.evidence, {path: digests_of(path) for path in options.recording}, options.fill)
    except (OSError, ValueError) as error:
        print(f"recorded.py: {error}", file=sys.stderr)
        return 2


def check(evidence: Path, recordings: Mapping[Path, Mapping[str, str]], fill: Path | None) -> int:
    """Check each document against the recording that has its digests; the exit code."""
    found, codes = documents(evidence.read_bytes().decode("utf-8")), [0]
    for document in found:
        wanted = document.head.digests("recording")
        if len(found) > 1:
            print(f"recording {', '.join(wanted)}")
        path = next((path for path, files in recordings.items() if files == wanted), None)
        with answered("", print, codes):
            if path is None:
                raise Refused(why_missing(wanted, recordings.values()))
            codes.append(check_document(document, path, print))
    if fill is not None:
        fill.write_text("".join(document.filled for document in found), encoding="utf-8", newline="\n")
    return 1 if 1 in codes else max(codes)


def why_missing(wanted: Mapping[str, str], recordings: Iterable[Mapping[str, str]]) -> str:
    """Why there is no recording with these digests: a file of it is another one, or not there."""
    given = {name: digest for files in recordings for name, digest in files.items()}
    names = [name.rpartition(" ")[0] for name, digest in wanted.items() if given.get(name) != digest]
    if names and any(name.startswith(f"{names[0]} ") for name in given):
        return f"{names[0]} is another file: it has not the size and the SHA-256 that are written"
    return f"there is no recording with the files {', '.join(name.rpartition(' ')[0] for name in wanted)}"


def digests_of(path: Path) -> dict[str, str]:
    """The files of a recording, by the names that evidence has for them and their sizes, with their digests."""
    files, folder, found = files_of(path), f"{path.resolve().name}/" if path.is_dir() else "", {}
    for at in files:
        with at.open("rb") as file:
            found[f"{folder}{at.name} {at.stat().st_size}"] = hashlib.file_digest(file, "sha256").hexdigest()
    return found


def files_of(path: Path) -> list[Path]:
    """The files of a recording: of a folder, all bags in it, and what is said of them."""
    name = re.compile(r"metadata\.yaml|.*\.(mcap|db3|bag)(\.zstd)?", re.I)
    return sorted(at for at in path.iterdir() if name.fullmatch(at.name)) if path.is_dir() else [path]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
