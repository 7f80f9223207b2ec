"""Whether a recording has the letters that an evidence of it says it has: they are computed anew, and compared.

    python recorded.py EVIDENCE RECORDING… [--fill FILE]

EVIDENCE is what `ltlc run --evidence` wrote, a RECORDING what was judged, by its old name. With --fill, the evidence is
written to FILE with lines in place of their digests, for the judge. Exit code: 0 if all is as written, 1 if something
is refused, 2 if something cannot be checked.

One file, to be read in an afternoon and run alone, with nothing of ltlc: it needs Python 3.11, numpy, rosbags for bags,
pyarrow for tables. `docs/evidence.md` describes the document, `docs/language.md` what a step is.
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
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, nullcontext, suppress
from decimal import Decimal
from fractions import Fraction
from functools import partial, reduce
from operator import add, attrgetter
from pathlib import Path
from typing import Any, NamedTuple
from uuid import UUID

import numpy as np

SECOND, EXACT = 10**9, 2**53  # in ns; up to here integers are doubles
MOST_TICKS, MOST_COMBINATIONS, MOST_ROUNDS = 10**8, 10**6, 100
Json = Any
Array = Any  # of numpy


class Refused(Exception):  # noqa: N818
    """It is not as written; after any other exception that is not known."""


# The document --------------------------------------------------------------------------------------------------------

# Which lines there are, by their first words.
SETTINGS, ATOMS = "( rate)?( timeout)?( stamp)?( from)?( to)?", "( atom is)*( count of)*( scope)*( instances)?( key)?"
HEAD = f"ltlc-evidence ltlc specification certificates( recording)+( definition)*( signal)*{SETTINGS}"
RUN = r"( letters| at( \+)*+)? until verdict"
CLAIM = f"not-covered|property text( requirement)?( verifies)*{ATOMS} session( slice{RUN})*{RUN}"
# What is stated of a run.
STATED = re.compile(
    r"(?m)^(?:slice (?P<id>.+)\n)?(?P<letters>(?:[al+].+\n)*+)until (?P<until>.+)\nverdict (?P<verdict>.+) (?P<at>.+)\n"
)


class Section:
    """The head of a document, or what it says of a property; equal `parts` in JSON are one object, computed once."""

    def __init__(self, text: str, form: str, parts: dict[str, Json]) -> None:
        lines = re.findall(r"^(\+|\S*) ?(.*)$", text.removesuffix("\n"), re.MULTILINE)
        if not re.fullmatch(form, " ".join(word for word, _ in lines)):
            raise ValueError(f"what begins with `{text.partition(chr(10))[0][:80]}` is not written as it should be")
        self.said: dict[str, list[str]] = {}
        for word, rest in lines:
            self.said.setdefault(word, []).append(rest)
        read = partial(json.loads, object_hook=lambda x: parts.setdefault(json.dumps(x), x))
        self.signals = [(*row.split(" ", 2)[:2], read(row.split(" ", 2)[2])) for row in self.said.get("signal", [])]
        self.atoms, self.key = ([read(each) for each in self.said.get(word, [])] for word in ("is", "key"))
        self.scopes = [each.split(" ") for each in self.said.get("scope", [])]
        self.runs = [found.groupdict() for found in STATED.finditer(text)]  # of slices, and at last the whole one

    def one(self, word: str) -> str:
        """What follows a word that is there once, or not."""
        return self.said.get(word, [""])[0]

    def time(self, word: str) -> int | None:
        """What follows a word, as a number; None if it is not there."""
        return int(self.one(word)) if word in self.said else None

    def digests(self, word: str) -> dict[str, str]:
        """What stands before and behind the word `sha256`."""
        return {name: digest for name, _, digest in (each.rpartition(" sha256 ") for each in self.said.get(word, []))}


class Document:
    """The evidence of one recording; `computed` are the lines that have the digests in it."""

    def __init__(self, text: str) -> None:
        parts: dict[str, Json] = {}
        head, *properties = text.removesuffix("\n").split("\n\n")
        self.text, self.head, self.computed = text, Section(head, HEAD, parts), dict[str, str]()
        if self.head.one("ltlc-evidence") != "2":
            raise ValueError("this is evidence of another version than 2")
        sections = [Section(f"{each}\n", CLAIM, parts) for each in properties]
        self.claims = [each for each in sections if "property" in each.said]
        self.not_covered = [each.one("not-covered") for each in sections if "not-covered" in each.said]

    @property
    def filled(self) -> str:
        """The same text, with these lines in place of their digests."""
        text = re.sub(r"(?m)^letters .*\n", lambda found: self.computed.get(found[0], found[0]), self.text)
        return f"{text}end sha256 {sha256(text)}\n"


def documents(text: str) -> list[Document]:
    """The documents in a text, each of which ends with the digest of its lines. Raises ValueError."""
    *pairs, rest = re.split(r"(?m)^end sha256 (.*)\n", text)
    bodies, digests = pairs[::2], pairs[1::2]
    if rest or not pairs or [*map(sha256, bodies)] != digests:
        raise ValueError("the last line has not the digest of the lines before it")
    return [Document(body) for body in bodies]


def sha256(text: str) -> str:
    """The digest of a text."""
    return hashlib.sha256(text.encode()).hexdigest()


# What is recorded ----------------------------------------------------------------------------------------------------


class Recording:
    """The `times` of the messages that a document needs, and by `topics` their places in this list.

    `samples` are, by the identity of what is read, the places of the messages that have it, and its values. The run
    lasts from `first` to `last`; before `begins`, a place, is no step.
    """

    def __init__(self, times: Array, topics: dict[str, Array], samples: dict[int, tuple[Array, Array]]) -> None:
        self.times, self.topics, self.samples = times, topics, samples
        self.first, self.last, self.begins = 0, 0, -1

    def part(self, old: Array, first: int, last: int) -> Recording:
        """The messages at these places, in this order, as a run from `first` to `last`."""
        topics = {name: np.flatnonzero(np.isin(old, places)) for name, places in self.topics.items()}
        found = Recording(self.times[old], topics, {})
        found.first, found.last = first, last
        for what, (places, values) in self.samples.items():
            having = np.flatnonzero(np.isin(old, places))
            found.samples[what] = having, values[places.searchsorted(old[having])]
        return found


Samples = dict[int, tuple[list[int], list[Any]]]  # by the identity of what is read: places of messages, and values


def recording(times: list[int], topics: dict[str, list[int]], samples: Samples, head: Section, span: Any) -> Recording:
    """What was read, in order, of the part that is asked for; without a `span`, it lasts as long as its messages."""
    whole = Recording(np.array(times, np.int64), {name: np.array(at, np.int64) for name, at in topics.items()}, {})
    for what, (places, values) in samples.items():
        whole.samples[what] = np.array(places, np.int64), column(values)
    since, to, order = head.time("from"), head.time("to"), whole.times.argsort(kind="stable")
    for end, is_within in ((since, np.greater_equal), (to, np.less_equal)):
        order = order if end is None else order[is_within(whole.times[order], end)]
    if span is None and not len(order):
        raise Refused("the recording has no messages")
    first, last = span or whole.times[order[[0, -1]]].tolist()
    return whole.part(order, first if since is None else max(first, since), last if to is None else to)


def parts(x: Json) -> Iterator[Json]:
    """An expression, and all that is in it."""
    if isinstance(x, dict):
        yield x
    if isinstance(x, dict | list):
        for part in x.values() if isinstance(x, dict) else x:
            yield from parts(part)


def fields(x: Json) -> dict[int, Json]:
    """The fields that it reads, by their identity."""
    return {id(part): part for part in parts(x) if "path" in part}


def topics_of(x: Json) -> set[str]:
    """The topics whose messages it reads, be it only that they come."""
    found = {part["topic"] for part in fields(x).values()}
    return found.union(*(part[key] for part in parts(x) for key in ("new", "message") if key in part))


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
                return str(UUID(bytes=bytes(value))) if len(value) == 16 else bytes(value).hex()
            case _:
                raise Refused(f"what is this: {step}")
        if value is None:
            return None
    return value.item() if isinstance(value, np.generic) else value


def read(path: Path, document: Document) -> Recording:
    """Read what claims need; where a bag defines no messages, they are those of the release with these digests."""
    if re.search(r"(?i)\.(csv|jsonl|ndjson|parquet)(\.gz|\.zst)?$", path.name) and path.is_file():
        return read_table(path, document.head)
    from rosbags.highlevel import AnyReader, AnyReaderError  # noqa: TID251
    from rosbags.interfaces import Nodetype  # noqa: TID251
    from rosbags.typesys import Stores, get_typestore  # noqa: TID251

    wanted = document.head.digests("definition")
    releases = sorted((each for each in Stores if each.name[:4] == "ROS2"), key=lambda each: each.name != "ROS2_JAZZY")
    bags = [at for at in files_of(path) if at.name != "metadata.yaml"]  # with old ones, rosbags finds no messages
    for paths, release in itertools.product(([path], bags), (None, *releases)):
        store = get_typestore(release) if release else None
        is_defined = suppress(AnyReaderError) if store is None else nullcontext()
        with is_defined, AnyReader(paths, default_typestore=store) as bag:
            found = {name: sha256(layout(bag.typestore, Nodetype.NAME, name)) for name in wanted}
            if found == wanted and bag.message_count:
                return read_bag(bag, document.head, [each.atoms + each.key for each in document.claims])
    raise Refused("it has no messages, or they are not defined as written, neither by itself nor by a release of ROS 2")


def layout(store: Any, kind: Any, of: Any) -> str:
    """How a type of rosbags is laid out in a message, with all that is in it."""
    match kind.name:
        case "BASE":
            return "uint8" if of[0] in ("byte", "octet", "char") else str(of[0])
        case "NAME":
            fields = (f"{layout(store, *field)} {name}" for name, field in store.fielddefs.get(of, ([], []))[1])
            return f"{of}({', '.join(fields)})"
        case _:
            return f"{layout(store, *of[0])}[{of[1] if kind.name == 'ARRAY' else ''}]"


def read_bag(reader: Any, head: Section, stated: Json) -> Recording:
    """The messages on the topics that are read, and of each of these the fields."""
    times: list[int] = []
    topics: dict[str, list[int]] = {name: [] for name in topics_of(stated)}
    samples: Samples = {what: ([], []) for what in fields(stated)}
    by_header, takers = "stamp" in head.said, {}
    for connection in reader.connections:
        name, keeps = f"/{connection.topic.lstrip('/')}", []
        for what, field in ((what, each) for what, each in fields(stated).items() if each["topic"] == name):
            if field["type"] != connection.msgtype or field["type"] not in head.digests("definition"):
                raise Refused(f"{name} has {connection.msgtype}, and how {field['type']} is defined has to be written")
            is_plain = field["path"] and all(isinstance(step, str) for step in field["path"])
            get = attrgetter(".".join(field["path"])) if is_plain else partial(value_at, path=field["path"])
            keeps.append((samples[what][0].append, samples[what][1].append, get))
        if name in topics:
            takers[id(connection)] = topics[name].append, keeps
    first, last, count = 2**63, -(2**63), 0
    for connection, time, raw in reader.messages():
        first, last, count = min(first, time), max(last, time), count + 1
        if id(connection) not in takers:
            continue
        (take, keeps), place = takers[id(connection)], len(times)
        message = reader.deserialize(raw, connection.msgtype) if keeps or by_header else None
        if by_header and (stamp := getattr(getattr(message, "header", None), "stamp", None)) is not None:
            time = stamp.sec * SECOND + stamp.nanosec
            if not time:
                continue
        take(place)
        times.append(time)
        for keep_place, keep, get in keeps:
            if (value := get(message)) is not None:
                keep_place(place)
                keep(value)
    if count != reader.message_count:
        raise NotImplementedError(f"rosbags reads only {count} of the {reader.message_count} messages")
    return recording(times, topics, samples, head, None if by_header else (first, last))


def read_table(path: Path, head: Section) -> Recording:
    """The rows of a table: each is a message on the topics of every signal that has a cell in it."""
    times, columns = table_at(path)
    topics: dict[str, list[int]] = {}
    samples: Samples = {}
    for name, kind, x in head.signals:
        cells, index = cells_of(columns, name, kind, x)
        pairs = [(place, value_of(cell, kind, index)) for place, cell in enumerate(cells) if cell is not None]
        pairs = [(place, value) for place, value in pairs if x.get("path") != [] or value]
        for topic in topics_of(x):
            topics.setdefault(topic, []).extend(place for place, _ in pairs)
        if cells or ("path" in x and id(x) not in samples):  # what has no column is computed, unless it is a field
            samples[id(x)] = [at for at, value in pairs if value is not None], [v for _, v in pairs if v is not None]
    return recording(times, topics, samples, head, None)


def table_at(path: Path) -> tuple[list[int], dict[str, list[Any]]]:
    """The times of the rows of a table in ns, and its cells by the heads of their columns, None if there is none."""
    import pyarrow as pa
    from pyarrow import parquet

    unit, names = SECOND, ("time", "__time", "timestamp")
    if path.suffix.lower() == ".parquet":
        table = parquet.read_table(path)
        columns = {name: table[name].to_pylist() for name in table.column_names if name not in names}
        [times] = (table[name] for name in table.column_names if name in names)
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
    times = columns.pop(next(head for head in names if head in columns))
    for head in [head for head in columns if head[0] == "/"]:  # or after dots, as an index with PlotJuggler once
        columns[re.sub(r"\.([0-9]+)(?=[./]|$)", r"[\1]", head).replace(".", "/")] = columns[head]
    return [int((Decimal(time) * unit).to_integral_value()) for time in times], columns


def cells_of(columns: dict[str, list[Any]], name: str, kind: str, x: Json) -> tuple[list[Any], int | None]:
    """The cells of the column of a signal, of those of its elements, or of an array whose element has this index."""
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
            rows = zip(*(columns[each] for each in elements), strict=True)
            if cells := [[*itertools.takewhile(lambda cell: cell is not None, row)] or None for row in rows]:
                return cells, None
        elif array in columns:
            return columns[array], int(index)
    return [], None


def value_of(cell: Any, kind: str, index: int | None) -> Any:
    """The value in a cell, as a field of a type has it; None if its array is too short."""
    if kind.endswith("[]") or index is not None:
        cells = json.loads(cell) if isinstance(cell, str) else cell
        values = [value_of(each, kind.removesuffix("[]"), None) for each in cells]
        return values if index is None else values[index] if index < len(values) else None
    if kind == "string":
        return cell
    if kind == "bool":
        word = str(cell).strip().lower()
        return word == "true" or (word != "false" and float(word) == 1)
    if kind.startswith("float"):
        return float(np.float32(float(cell)) if kind == "float32" else cell)
    return int(Decimal(cell))


# Functions -----------------------------------------------------------------------------------------------------------


def column(values: Any) -> Array:
    """Values as an array: booleans; numbers, if all of them are doubles; anything else as Python has it."""
    if isinstance(values, np.ndarray) and (values.dtype.kind in "bf" or values.dtype.itemsize < 8):
        return values if values.dtype.kind == "b" else values.astype(np.float64)
    values = values.tolist() if isinstance(values, np.ndarray) else values
    kinds = {*map(type, values)}
    if kinds == {bool}:
        return np.array(values, bool)
    is_wide = int in kinds and any(abs(value) > EXACT for value in values if isinstance(value, int))
    if all(issubclass(kind, float | int) for kind in kinds) and not is_wide:
        return np.array(values, np.float64)
    is_array = bool(kinds & {list, np.ndarray})
    return np.fromiter(map(column, values) if is_array else values, object, len(values))


def is_nan(values: Array) -> Array:
    """Where they are NaN."""
    return np.asarray(values != values).astype(bool)


def each(function: Callable[..., Any]) -> Callable[..., Array]:
    """A function of Python's as one of columns: of NaN, and outside of its domain, it is NaN; too large, infinite."""

    def value(*given: Any) -> Any:
        try:
            return function(*given)
        except (ValueError, IndexError, ZeroDivisionError):
            return math.nan
        except OverflowError:
            return math.inf

    def values(*columns: Array) -> Array:
        found, before, latest = list[Any](), None, None
        columns = np.broadcast_arrays(*columns)
        for row in zip(*(each.ravel().tolist() for each in columns), strict=True):
            now = [id(one) if isinstance(one, np.ndarray) else one for one in row]
            if now != before:
                before, latest = now, math.nan if any(one != one for one in now) else value(*row)
            found.append(latest)
        return column(found).reshape(columns[0].shape)

    return values


def known(array: Array) -> Array:
    """The elements that are not NaN."""
    return array[~is_nan(array)]


def total(array: Array) -> float:
    """The double nearest to the sum."""
    try:
        return math.fsum(array.tolist()) + 0.0
    except OverflowError:  # on the way, though perhaps not in the end
        return math.fsum((array / 2**64).tolist()) * 2.0**64


def median(array: Array) -> float:
    """The middle one; of an even number the double nearest to the mean of the middle two."""
    values = np.sort(known(array).astype(np.float64)).tolist()
    low, high = values[(len(values) - 1) // 2], values[len(values) // 2]
    return float((Fraction(low) + Fraction(high)) / 2) if math.isfinite(low) and math.isfinite(high) else low + high


def nearest(sought: float, array: Array) -> float:
    """The first element that differs least."""
    some = known(array).astype(np.float64)
    return float(some[np.where(some == sought, 0.0, np.abs(some - sought)).argmin()])


def best(is_better: Callable[..., Array], *given: Array) -> Array:
    """The least or the greatest of some numbers; NaN where one of them is."""
    found = reduce(lambda one, other: np.where(is_better(other, one), other, one), given)
    return np.where(reduce(np.logical_or, map(is_nan, given)), math.nan, found)


def unit(*q: float) -> list[float]:
    """The quaternion of length 1 that is the same orientation."""
    length = math.hypot(*q)
    if not 0 < length < math.inf:
        raise ValueError("no orientation")
    return [each / length for each in q]


def euler(*q: float) -> tuple[float, float, float]:
    """The angles of an orientation, which is yaw about z, then pitch about y, then roll about x; in reverse order."""
    x, y, z, w = unit(*q)
    roll = math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = math.asin(max(-1.0, min(1.0, 2 * (w * y - z * x))))
    return roll, pitch, math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def angle(*both: float) -> float:
    """Between two orientations, by half of it: the tangent is that of their difference and their sum."""
    p, q = unit(*both[:4]), unit(*both[4:])
    apart, together = math.dist(p, q), math.hypot(*map(add, p, q))
    return 4 * math.atan2(min(apart, together), max(apart, together))


def from_zone(x: float, y: float, *corners: float) -> tuple[bool, float]:
    """Whether a point is in a polygon, border included: exactly, by what the ray to its right crosses; and how far."""
    if not math.isfinite(x) or not math.isfinite(y):
        return False, math.inf
    points, is_in, ways = [*zip(corners[::2], corners[1::2], strict=True)], False, []
    for one, other in zip(points, points[1:] + points[:1], strict=True):
        px, py, ax, ay, bx, by = map(Fraction, (x, y, *one, *other))
        turn = (bx - ax) * (py - ay) - (by - ay) * (px - ax)
        if turn == 0 and min(ax, bx) <= px <= max(ax, bx) and min(ay, by) <= py <= max(ay, by):
            return True, 0.0
        is_in ^= (ay > py) != (by > py) and (turn > 0) == (by > ay)
        x0, y0, along, across = x - one[0], y - one[1], other[0] - one[0], other[1] - one[1]
        if 0 < x0 * along + y0 * across < along * along + across * across:
            ways.append(abs(along * y0 - across * x0) / math.hypot(along, across))
        else:
            ways.append(min(math.hypot(x0, y0), math.hypot(x0 - along, y0 - across)))
    return is_in, 0.0 if is_in else min(ways)


COMPARISONS = {"<": np.less, "<=": np.less_equal, ">": np.greater, ">=": np.greater_equal, "==": np.equal}

# Of columns; by numpy where that computes as IEEE 754 has it.
FUNCTIONS: dict[str, Callable[..., Array]] = {
    "not": np.logical_not,
    "and": lambda *given: reduce(np.logical_and, given),
    "or": lambda *given: reduce(np.logical_or, given),
    "neg": np.negative,
    "abs": np.abs,
    "min": partial(best, np.less),
    "max": partial(best, np.greater),
    "double": each(np.float64),
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.true_divide,
    "sqrt": np.sqrt,
    "floor": lambda x: np.floor(x) + 0.0,
    "ceil": lambda x: np.ceil(x) + 0.0,
    "sign": lambda x: np.sign(x) + 0.0,
    "mod": lambda x, y: np.mod(x, y) + 0.0,
    "gap": lambda x, y: np.where(x == y, 0.0, x - y),
    **{name: each(getattr(math, name)) for name in ("exp", "sin", "cos", "tan", "asin", "acos", "atan2", "hypot")},
    "log": each(lambda x: -math.inf if x == 0 else math.log(x)),
    "angle_between": each(lambda one, other: abs(math.remainder(one - other, math.tau))),
    **{name: each(lambda *q, n=n: euler(*q)[n]) for n, name in enumerate(("roll", "pitch", "yaw"))},
    "angle": each(angle),
    "inside": each(lambda *given: float(from_zone(*given)[0])),
    "distance": each(lambda *given: from_zone(*given)[1]),
    "number": each(float),
    "len": each(len),
    "slice": each(lambda array, *ends: array[slice(*(None if end is None else int(end) for end in ends))]),
    "sum": each(total),
    "least": each(lambda array: known(array).min()),
    "greatest": each(lambda array: known(array).max()),
    "mean": each(lambda array: total(known(array)) / len(known(array))),
    "median": each(median),
    "nearest": each(nearest),
}

# Expressions ---------------------------------------------------------------------------------------------------------

YES, NO = np.ones(1, bool), np.zeros(1, bool)


class Series(NamedTuple):
    """What an expression is at each instant, or with one entry at all; anything until all that it waits for is `known`.

    It is `fresh` where what is read is new, `wrong` where NaN is compared, or a first value comes without its message.
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


def applied(function: Callable[..., Array], *of: Series) -> Series:
    """What a function gives of others, as soon as they have values."""
    every = combined(NO, *of)
    return every._replace(now=function(*(each.now for each in of))) if every.known.any() else every


class Values:
    """The values of expressions at the instants of a run: the messages on some topics, or the ticks that see them."""

    def __init__(self, recorded: Recording, topics: Iterable[str], rate: Fraction | None, session: int | None) -> None:
        """With `session`, an instant of its own is the first, or the first tick is then."""
        is_read = np.zeros(len(recorded.times), bool)
        is_read[np.concatenate([np.zeros(0, np.int64), *(recorded.topics[name] for name in topics)])] = True
        places = np.flatnonzero(is_read)
        own = np.array([] if session is None else [session], np.int64)
        self.recorded, self.is_ticks = recorded, rate is not None
        self.times: Array = np.append(own, recorded.times[places])
        # At which instant each message is seen; too large a number: at none.
        self.seen = np.append(np.full(len(own), -1), places).searchsorted(np.arange(len(recorded.times)))
        if rate is not None and len(self.times):
            start, period = int(self.times[0]), SECOND / rate
            count = max(0, math.ceil((recorded.last - start + 1) / period))
            if count > MOST_TICKS:
                raise NotImplementedError(f"more than {MOST_TICKS} ticks")
            numbers = (number * period.numerator // period.denominator for number in range(count))
            self.times = np.fromiter((start + number for number in numbers), np.int64, count)
            self.seen = self.times.searchsorted(recorded.times)
        self.is_at_once = np.append(self.times, -1)[self.seen] == recorded.times
        self.count = len(self.times)
        self.found: dict[int, Series] = {}
        self.taken: dict[int, Array] = {}  # of each scope, at which instant the value at its opening was taken

    def heard(self, topics: Iterable[str], *, now: bool = False) -> Array:
        """Where there is news of some topics; with `now`, at this very time."""
        found = np.zeros(self.count + 1, bool)
        for places in (self.recorded.topics[name] for name in topics):
            found[self.seen[places[self.is_at_once[places]] if now else places]] = True
        return found[:-1]

    def value(self, x: Json, elements: list[Series] | None = None) -> Series:
        """What an expression is; the predicate of a count, of these `elements` of arrays and values beside them."""
        if not isinstance(x, dict):
            return Series(column([x]))
        if elements is not None:
            return elements[x["element"]] if "element" in x else self.made(x, partial(self.value, elements=elements))
        if id(x) not in self.found:
            self.found[id(x)] = self.made(x, self.value)
        return self.found[id(x)]

    def made(self, x: Json, value: Callable[[Json], Series]) -> Series:
        """What it is, of the values of its parts."""
        match x:
            case _ if id(x) in self.recorded.samples:
                return self.latest(x)
            case {"call": name, "of": of}:
                return self.called(name, [value(each) for each in of])
            case {"count": predicate, "over": groups, "beside": beside}:
                return self.count_of(predicate, groups, beside)
            case {"new": topics} | {"message": topics}:
                return Series(self.heard(topics, now="message" in x), fresh=self.heard(topics))
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

    def called(self, name: str, of: list[Series]) -> Series:
        """A function of some values, which are compared only if none is NaN."""
        if name not in COMPARISONS:
            return applied(FUNCTIONS[name], *of)
        wrong = is_nan(of[0].now) | is_nan(of[1].now)
        return applied(
            lambda one, other, _: COMPARISONS[name](one, other).astype(bool), *of, Series(wrong, wrong=wrong)
        )

    def latest(self, x: Json) -> Series:
        """What is read of the samples of a signal."""
        of = x["of"] if x.keys() & {"ago", "recent", "slope"} else x
        ago = 1 if "slope" in x else x.get("ago", x.get("recent", 0))
        values, is_sample, fresh = self.samples(of)
        known, wrong = is_sample.cumsum() > ago, NO
        if "slope" in x:
            seconds = np.diff(self.times[is_sample]) / SECOND
            values = np.append(math.nan, np.diff(values) / np.where(seconds == 0, math.nan, seconds))
        elif "recent" in x:
            values = column([values[max(n - ago, 0) : n + 1] for n in range(len(values))])
            wrong = self.held(np.array([is_nan(each).any() for each in values], bool), is_sample)
        return Series(self.held(values, is_sample, x.get("ago", 0)), known, fresh, wrong)

    def held(self, values: Array, at: Array, ago: int = 0) -> Array:
        """The latest of some values at each instant, which come `at` some of them, or that so many before."""
        return values[np.maximum(at.cumsum() - 1 - ago, 0)] if len(values) else np.zeros(self.count, bool)

    def samples(self, x: Json) -> tuple[Array, Array, Array]:
        """The samples of a signal; where there is one: a part of it is new, and `when` holds; where a part is new."""
        if "when" not in x and id(x.get("sampled")) in self.recorded.samples:
            x = x["sampled"]
        if id(x) in self.recorded.samples:
            places, values = self.recorded.samples[id(x)]
            latest = self.seen[places].searchsorted(np.arange(self.count), "right") - 1
            at = (latest >= 0) & (self.is_ticks | (np.diff(latest, prepend=-1) > 0))
            return values[latest[at]], at, at
        of, when = self.value(x["sampled"]), self.value(x.get("when", True))
        every = combined(when.now & ~when.wrong & ~is_nan(of.now) if "when" in x else YES, of, when)
        now, at, fresh = (np.broadcast_to(each, self.count) for each in (of.now, every.known & every.now, every.fresh))
        return now[at & fresh], at & fresh, fresh

    def count_of(self, predicate: Json, groups: list[list[Json]], beside: list[Json]) -> Series:
        """How many elements satisfy a predicate; NaN where something beside them is, or there are too many."""
        axes = [axis for axis, group in enumerate(groups) for _ in group]  # arrays in one group are side by side

        def count(*values: Any) -> float:
            arrays, others = values[: len(axes)], [Series(column([each])) for each in values[len(axes) :]]
            sizes = [min(len(a) for a, axis in zip(arrays, axes, strict=True) if axis == n) for n in range(len(groups))]
            if len(sizes) > 1 and math.prod(sizes) > MOST_COMBINATIONS:
                return math.nan
            shapes = np.where(np.eye(len(sizes), dtype=bool), -1, 1)
            elements = [Series(a[: sizes[n]].reshape(shapes[n])) for a, n in zip(arrays, axes, strict=True)]
            found = self.value(predicate, [*elements, *others])
            return float(np.count_nonzero(np.broadcast_to(found.now.astype(bool) & ~found.wrong, sizes)))

        return applied(each(count), *map(self.value, (*itertools.chain(*groups), *beside)))


# Letters -------------------------------------------------------------------------------------------------------------


def run_of(claim: Section, recorded: Recording, head: Section, until: int) -> tuple[Array, Array, int, int]:
    """The instants of a property that may have lines: times and letters; the bits of news; since when ages count."""
    values, is_step = steps_of(claim, recorded, head)
    letters, bits, news = np.zeros(values.count, np.int64), np.zeros(len(recorded.times), np.int64), 0
    for n, atom in enumerate(claim.atoms):
        letters |= values.value(atom).now.astype(bool).astype(np.int64) << n
        news |= bool(atom.keys() & {"new", "message"}) << n
        for name in atom.get("message", []):
            bits[recorded.topics[name]] |= 1 << n
    for n, (number, *spans) in enumerate(claim.scopes, len(claim.atoms)):
        said = is_open(spans, int(is_step.sum()))
        letters[is_step] |= said.astype(np.int64) << n
        turns = np.flatnonzero(np.diff(said[values.times[is_step] <= until], prepend=False)).tolist()
        if spans != [f"{one}-{end}" for one, end in itertools.zip_longest(turns[::2], turns[1::2], fillvalue="")]:
            raise Refused(f"from which steps on scope {number} is open is not written as it should be")
    times, letters = values.times[is_step], letters[is_step]
    # Between the steps are the messages that make none, but from which ages count.
    places = np.flatnonzero(bits)
    places = places[~(np.append(is_step, False)[values.seen[places]] & values.is_at_once[places])]
    before = np.flatnonzero(is_step).searchsorted(values.seen[places])
    early, late, where = places[before == 0], places[before > 0], before[before > 0]
    waiting = [n for n, atom in enumerate(claim.atoms) if "message" in atom and (letters[:1] >> n & 1 == 0).any()]
    last = {int(recorded.times[early[bits[early] >> n & 1 > 0]].max(initial=-1)) for n in waiting}
    if len(last) > 1:
        raise NotImplementedError("its ages count from different messages before its first step")
    session = recorded.first if last <= {-1} else max(last)
    letters = np.insert(letters, where, letters[where - 1] & ~news | bits[late])
    return np.insert(times, where, recorded.times[late]), letters, news, session


def lines_of(times: Array, letters: Array, news: int) -> tuple[int, str]:
    """The lines: of the first instant, of a letter that is not the one held, and at the time of the line before."""
    differs = np.append(True, letters[1:] != (letters[:-1] & ~news))[: len(times)]
    for n in np.flatnonzero(times[1:] == times[:-1]) + 1:
        differs[n] |= differs[n - 1]
    times, letters = times[differs], letters[differs].tolist()
    words = {letter: "".join(f" a{n}" for n in range(63) if letter >> n & 1) for letter in {*letters}}
    gaps = np.diff(times, prepend=times[:1]).tolist()
    text = "".join([f"+{gap}{words[letter]}\n" for gap, letter in zip(gaps, letters, strict=True)])
    return len(times), f"at {times[0]}{text[2:]}" if text else ""


def steps_of(claim: Section, recorded: Recording, head: Section) -> tuple[Values, Array]:
    """The values of a property at its instants, and which of these are steps."""
    rate, begins = Fraction(head.one("rate")) if "rate" in head.said else None, not is_waited_for(claim.atoms)
    topics, is_step = topics_of(claim.atoms), None
    for _ in range(MOST_ROUNDS):  # which steps there are depends on values at openings, and these on the steps before
        values = Values(recorded, topics, rate, recorded.first if begins else None)
        before = np.zeros(values.count, bool) if is_step is None else is_step
        for number, *spans in claim.scopes:
            was_open = np.append(False, is_open(spans, int(before.sum())))[np.cumsum(before) - before]
            values.taken[int(number)] = np.maximum.accumulate(np.where(was_open, 0, np.arange(values.count)))
        every = combined(YES, *map(values.value, claim.atoms))
        is_step = np.broadcast_to(every.fresh | values.is_ticks, values.count).copy()
        is_step[:1] |= begins
        is_step &= every.known & ~every.wrong
        is_step[: values.seen[recorded.begins] if recorded.begins >= 0 else 0] = False
        if not claim.scopes or np.array_equal(is_step, before):
            return values, is_step
    raise NotImplementedError("which steps there are depends on values at openings")


def is_open(spans: list[str], count: int) -> Array:
    """At which of so many steps a scope is said to be open."""
    found = np.zeros(count, bool)
    for first, _, end in (span.partition("-") for span in spans):
        found[int(first) : int(end) if end else None] = True
    return found


def is_waited_for(x: Json) -> bool:
    """Whether something is read that has a first value, and nothing instead of it."""
    if isinstance(x, dict) and "instead" not in x:
        return bool(x.keys() & {"path", "sampled"}) or any(map(is_waited_for, x.values()))
    return isinstance(x, list) and any(map(is_waited_for, x))


# The comparison ------------------------------------------------------------------------------------------------------


def main(arguments: list[str]) -> int:
    """Check each document against the recording that has its digests; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("evidence", type=Path)
    parser.add_argument("recording", type=Path, nargs="+")
    parser.add_argument("--fill", type=Path)
    options, codes = parser.parse_args(arguments), [0]
    try:
        recordings = [(digests_of(path), path) for path in options.recording]
        found = documents(options.evidence.read_bytes().decode("utf-8"))
        for document in found:
            if len(found) > 1:
                print(f"recording {', '.join(document.head.digests('recording'))}")
            with answered("", codes), np.errstate(all="ignore"):
                check_document(document, recordings, codes)
        if options.fill is not None:
            options.fill.write_text("".join(each.filled for each in found), encoding="utf-8", newline="\n")
    except (OSError, ValueError) as error:
        print(f"recorded.py: {error}", file=sys.stderr)
        return 2
    return 1 if 1 in codes else max(codes)


@contextmanager
def answered(label: str, codes: list[int]) -> Iterator[None]:
    """Print what is refused or not covered, and add the exit code; whatever else goes wrong is not covered."""
    try:
        yield
    except Refused as error:
        print(f"{label}REFUSED: {error}")
        codes.append(1)
    except Exception as error:
        kind = "" if isinstance(error, NotImplementedError) else f"{type(error).__name__}: "
        print(f"{label}NOT COVERED: {kind}{str(error).partition(chr(10))[0]}")
        codes.append(2)


def files_of(path: Path) -> list[Path]:
    """The files of a recording: of a folder, all bags in it, and what is said of them."""
    name = re.compile(r"(?i)metadata\.yaml|.*\.(mcap|db3|bag)(\.zstd)?")
    return sorted(at for at in path.iterdir() if name.fullmatch(at.name)) if path.is_dir() else [path]


def digests_of(path: Path) -> dict[str, str]:
    """The digests of the files of a recording, by the names that evidence has for them, and their sizes."""
    folder, found = f"{path.resolve().name}/" if path.is_dir() else "", {}
    for at in files_of(path):
        with at.open("rb") as file:
            found[f"{folder}{at.name} {at.stat().st_size}"] = hashlib.file_digest(file, "sha256").hexdigest()
    return found


def check_document(document: Document, recordings: list[tuple[dict[str, str], Path]], codes: list[int]) -> None:
    """Check all claims, print what is found, and add exit codes."""
    head, wanted = document.head, document.head.digests("recording")
    paths = [path for files, path in recordings if files == wanted]
    if not paths:
        raise Refused(f"no recording has the files, sizes and SHA-256 that are written: {', '.join(wanted)}")
    for each in document.not_covered:
        print(": nothing is claimed: ".join(each.split(": ", 1)))
    if not document.claims:
        return
    if ("stamp" in head.said or "timeout" in head.said) and document.not_covered:
        raise Refused("something is claimed of some properties only, though the run depends on all")
    recorded = read(paths[0], document)
    ends, timeout = [recorded.last], head.time("timeout")
    if timeout is not None:  # so long after the first step of a property
        runs = [run_of(claim, recorded, head, recorded.last) for claim in document.claims]
        ends += [int(run[0][0]) + timeout for run in runs if len(run[0])]
    for claim in document.claims:
        label = claim.one("property")
        with answered(f"{label}: ", codes):
            print(f"{label}: the letters are as stated; {check_claim(claim, recorded, document, min(ends))}")


def check_claim(claim: Section, recorded: Recording, document: Document, ends: int) -> str:
    """Compare what is claimed of a run, or of slices, that end at `ends` at the latest; how much was compared."""
    for stated in claim.runs:
        until, is_decided = int(stated["until"]), stated["verdict"] in ("violated", "satisfied")
        if stated["at"] != stated["until"] or (until > ends if is_decided else until != ends):
            raise Refused(f"the run ends at {ends}")
    if not claim.key:
        return check_run(claim, claim.runs[0], recorded, document)
    if document.head.said.keys() & {"rate", "timeout", "signal"}:
        raise NotImplementedError("ids at ticks, with a timeout, or in tables")
    slices, found = claim.runs[:-1], slices_of(claim, recorded)
    if [stated["id"] for stated in slices] != [*found]:
        raise Refused(f"the ids are {', '.join(found)[:200]}")
    for stated in slices:
        check_run(claim, stated, found[stated["id"]], document)
    return f"ids: {len(found)}"


def check_run(claim: Section, stated: dict[str, str], recorded: Recording, document: Document) -> str:
    """Compare the letters of a run with those that are stated; how many instants and lines it has."""
    until, begins, problems = int(stated["until"]), not is_waited_for(claim.atoms), []
    times, letters, news, session = run_of(claim, recorded, document.head, until)
    end = int(times.searchsorted(until, "right"))
    # Where a message has the time at which the session begins, that may have an instant of its own, or not.
    is_heard = any(recorded.first in recorded.times[recorded.topics[name]] for name in topics_of(claim.atoms))
    is_twice = begins and is_heard and recorded.first in times[:1] and "rate" not in document.head.said
    for start in range(2 if is_twice else 1):
        count, lines = lines_of(times[start:end], letters[start:end], news)
        found = f"letters {count} sha256 {sha256(lines)}\n" if stated["letters"][:1] == "l" else lines
        texts = f"session {claim.one('session')}\n{stated['letters']}", f"session {session}\n{found}"
        if texts[0] == texts[1]:
            document.computed[found] = lines
            return f"instants: {len(times)}, lines: {count}"
        pairs = itertools.zip_longest(*(text.split("\n") for text in texts), fillvalue="")
        problems += [f"stated: {one or 'nothing'}; computed: {two or 'nothing'}" for one, two in pairs if one != two]
    raise Refused(f"slice {stated['id']}: {problems[0]}" if stated["id"] else problems[0])


def slices_of(claim: Section, recorded: Recording) -> dict[str, Recording]:
    """The slices by their ids, in order: messages, once for each element that has the id, and all on other topics."""
    [key], own = claim.key, [what for what, field in fields(claim.atoms).items() if ["own"] in field["path"]]
    places, values = recorded.samples[id(key)]
    lengths = [dict(zip(at.tolist(), map(len, of), strict=True)) for at, of in map(recorded.samples.__getitem__, own)]
    messages: dict[str, list[tuple[int, int]]] = {}
    for place, ids in zip(places.tolist(), values.tolist(), strict=True):
        some = ids.tolist() if isinstance(ids, np.ndarray) else [ids]
        for element, value in enumerate(some[: min([len(some), *(each.get(place, 0) for each in lengths)])]):
            whole = int(value) if isinstance(value, float) and value.is_integer() else value
            if whole == whole:  # NaN is no id
                messages.setdefault(json.dumps(whole), []).append((place, element))
    others, found = np.setdiff1d(np.arange(len(recorded.times)), recorded.topics[key["topic"]]), {}
    for one, pairs in messages.items():
        own_places, elements = np.array(pairs, np.int64).T
        old = np.append(others, own_places)
        order = old.argsort(kind="stable")
        which = np.append(np.full(len(others), -1), elements)[order]
        found[one] = recorded.part(old[order], recorded.first, recorded.last)
        found[one].begins = int(np.argmax(which >= 0))
        for what in own:
            there, arrays = found[one].samples[what]
            some = [array[n : n + 1].tolist()[0] for array, n in zip(arrays, which[there], strict=True)]
            found[one].samples[what] = there, column(some)
    return found


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
