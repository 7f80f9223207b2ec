"""Whether a recording has the letters that an evidence of it says it has: they are computed anew, and compared.

    python recorded.py EVIDENCE [CERTIFICATES] RECORDING… [--fill FILE]

EVIDENCE is what `ltlc run --evidence` wrote, of one recording or of many; a RECORDING is what was judged, by its old
name. Of CERTIFICATES only the digest is compared. With --fill, the evidence is written to FILE with lines in place of
their digests. Exit code: 0 if all is as written, 1 if something is refused, 2 if something cannot be checked.

This is one file, to be read in an afternoon and run alone: it needs Python 3.11, numpy and rosbags, and has nothing of
ltlc. `docs/evidence.md` there describes the document; what is computed is what `docs/language.md` says of steps.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import math
import os
import re
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from fractions import Fraction
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np

SECOND = 1_000_000_000
EXACT = 2**53
"""Up to here integers are doubles."""
MOST_TICKS = 10**8
MOST_COMBINATIONS = 10**6
MOST_ROUNDS = 100
"""So often it is looked anew which steps there are, as that depends on values at openings."""
PIECE = 1 << 20
"""So many elements of arrays, or lines, are looked at at once."""
BAGS = (".mcap", ".db3", ".bag")

Json = Any
Array = Any
"""An array of numpy."""


class Refused(Exception):  # noqa: N818
    """It is not as written."""


class NotCovered(Exception):  # noqa: N818
    """Not to be told by this program."""


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

HEAD = {"ltlc", "specification", "certificates", "recording", "definition", "rate", "timeout", "stamp", "from", "to"}
MANY = {"recording", "definition", "verifies", "atom", "is", "count", "of", "scope"}
CLAIM = MANY - HEAD | {
    "instances",
    "key",
    "slice",
    "property",
    "text",
    "requirement",
    "session",
    "letters",
    "until",
    "verdict",
}


@dataclass
class Part:
    """The head of a document, or a claim: what follows each word. `lines` are times and letters, bits of the atoms."""

    said: dict[str, list[str]] = field(default_factory=dict)
    slices: list[Part] = field(default_factory=list)
    lines: list[tuple[int, int]] = field(default_factory=list)
    found: tuple[Array, Array] | None = None

    def one(self, word: str) -> str:
        """What follows a word that is there once, or not."""
        return self.said.get(word, [""])[-1]

    def time(self, word: str) -> int | None:
        """What follows a word, as a number; None if it is not there."""
        return number(self.one(word)) if word in self.said else None

    def digests(self, word: str) -> dict[str, str]:
        """What stands before and behind the word `sha256`."""
        found = (each.partition("sha256 ") for each in self.said.get(word, []))
        return {name.rstrip(): digest for name, _, digest in found}

    @property
    def atoms(self) -> list[Json]:
        """What the atoms are."""
        return [json.loads(each) for each in self.said.get("is", [])]

    @property
    def keys(self) -> list[Json]:
        """The field that has ids, if it is about each id."""
        return [json.loads(each) for each in self.said.get("key", [])]


@dataclass
class Document:
    """The evidence of one recording: all its `rows` of text, and what they say."""

    rows: list[str]
    head: Part
    claims: list[Part]
    not_covered: list[str]


def documents(text: str) -> Iterator[Document]:
    """The documents in a text, each of which ends with the digest of its lines."""
    rows: list[str] = []
    for row in text.split("\n"):
        if row.startswith("end sha256 "):
            body = "".join(f"{each}\n" for each in rows)
            if row != f"end sha256 {hashlib.sha256(body.encode()).hexdigest()}":
                raise Refused("the last line has not the digest of the lines before it")
            yield parsed(rows)
            rows = []
        else:
            rows.append(row)
    if rows != [""]:
        raise Refused("the evidence does not end with its digest")
    if not text:
        raise Refused("this is no evidence")


def parsed(rows: list[str]) -> Document:
    """What the lines of a document say."""
    if not rows or rows[0] != "ltlc-evidence 1":
        raise Refused("this is no evidence")
    found = Document(rows, Part(), [], [])
    for row in rows[1:]:
        word, _, rest = row.partition(" ")
        if word == "property":
            found.claims.append(Part())
        part, known = (found.claims[-1], CLAIM) if found.claims else (found.head, HEAD)
        if word == "slice":
            part.slices.append(Part())
        if part.slices and "verdict" not in part.slices[-1].said:
            part = part.slices[-1]
        if word in known:
            if word in part.said and word not in MANY:
                raise Refused(f"written twice: {word}")
            part.said.setdefault(word, []).append(rest)
        elif word == "not-covered":
            found.not_covered.append(rest)
        elif word == "at" and known is CLAIM and not part.lines:
            time, _, letter = rest.partition(" ")
            part.lines.append((number(time), bits_of(letter)))
        elif word.startswith("+") and part.lines:
            part.lines.append((part.lines[-1][0] + number(word[1:]), bits_of(rest)))
        elif word:
            raise Refused(f"what is this: {row[:80]}")
    return found


def number(text: str) -> int:
    """A number as it is written."""
    if not re.fullmatch(r"0|[1-9][0-9]{0,18}", text):
        raise Refused(f"not a number: {text[:80]}")
    return int(text)


def bits_of(letter: str) -> int:
    """The bits of the atoms in a line."""
    return sum(1 << number(each[1:]) for each in letter.split(" ")) if letter else 0


# Files ---------------------------------------------------------------------------------------------------------------


def files_of(path: Path) -> dict[str, Path]:
    """The files of a recording, by the names that evidence has for them."""
    if not path.is_dir():
        return {path.name: path}
    folder = path.resolve().name
    names = [name for name in sorted(os.listdir(path)) if name == "metadata.yaml" or is_bag(name)]
    return {f"{folder}/{name}": path / name for name in names}


def is_bag(name: str) -> bool:
    """Whether a file is one, by its name."""
    return name.lower().removesuffix(".zstd").endswith(BAGS)


def sha256(path: Path) -> str:
    """The digest of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def told(path: Path) -> dict[str, str]:
    """The files of a recording with their sizes, and their digests."""
    return {f"{name} {at.stat().st_size}": sha256(at) for name, at in files_of(path).items()}


# What is recorded ----------------------------------------------------------------------------------------------------


@dataclass
class Topic:
    """The messages on a topic: their times, their places in the recording, and by path the values in them."""

    times: Array = field(default_factory=list)
    places: Array = field(default_factory=list)
    values: dict[str, list[Any]] = field(default_factory=dict)


@dataclass
class Recording:
    """What a document needs of a recording: when it begins and ends, and the topics that are read."""

    first: int | None
    last: int | None
    topics: dict[str, Topic]
    sliced: str | None = None
    """If it is the slice of an id, the topic whose messages it has some of; it begins with the first of these."""
    kept: dict[Any, Any] = field(default_factory=dict)


def parts(x: Json) -> Iterator[Json]:
    """An expression or a condition, and all that is in it."""
    if isinstance(x, dict):
        yield x
        for part in x.values():
            yield from parts(part)
    elif isinstance(x, list):
        for part in x:
            yield from parts(part)


def fields_of(x: Json) -> list[Json]:
    """The fields that it reads."""
    return [part for part in parts(x) if "path" in part]


def topics_of(x: Json) -> set[str]:
    """The topics whose messages it reads, be it only that they come."""
    found = {part["topic"] for part in fields_of(x)}
    return found.union(*(part[key] for part in parts(x) for key in ("new", "message") if key in part))


def getter(path: list[Json]) -> Callable[[Any], Any]:
    """What takes the value at a path out of a message; None if there is none."""
    if path and all(isinstance(step, str) for step in path):
        return attrgetter(".".join(path))
    return lambda message: value_at(message, None, path)


def value_at(value: Any, around: Any, path: list[Json]) -> Any:
    """The value at a path; `around` is the message that has it as a field."""
    for depth, step in enumerate(path):
        match step:
            case str():
                around, value = value, getattr(value, step)
            case int():
                if step >= len(value):
                    return None
                value = value[step]
            case ["match", key, name]:
                value = next((each for each in value if getattr(each, key) == name), None)
            case ["parallel", names, name]:
                at = next((n for n, each in enumerate(getattr(around, names)) if each == name), len(value))
                value = value[at] if at < len(value) else None
            case ["each"] | ["own"]:
                return [value_at(each, value, path[depth + 1 :]) for each in value]
            case ["bytes"]:
                text = bytes(value).hex()
                split = (text[:8], text[8:12], text[12:16], text[16:20], text[20:])
                return "-".join(split) if len(text) == 32 else text
            case _:
                raise Refused(f"what is this: {step}")
        if value is None:
            return None
    return value


def read(path: Path, document: Document) -> Recording:
    """Read what the claims of a document need."""
    with covered("what it reads is not to be found"):
        wanted: dict[str, dict[str, Json]] = {
            name: {} for claim in document.claims for name in topics_of([*claim.atoms, *claim.keys])
        }
        for each in (each for claim in document.claims for each in fields_of([*claim.atoms, *claim.keys])):
            wanted[each["topic"]][json.dumps(each["path"])] = each
    with covered("rosbags cannot read it"), ExitStack() as stack:
        found = read_bag(open_bag([path], document, stack), document, wanted)
        if found.first is None and path.is_dir():  # rosbags finds nothing by some old metadata
            files = [at for name, at in files_of(path).items() if is_bag(name)]
            found = read_bag(open_bag(files, document, stack), document, wanted)
    return found


def open_bag(paths: list[Path], document: Document, stack: ExitStack) -> Any:
    """The bag at some paths; where it defines no messages, they are those of the release that the digests are of."""
    from rosbags.highlevel import AnyReader, AnyReaderError  # noqa: TID251
    from rosbags.typesys import Stores, get_typestore  # noqa: TID251

    releases = sorted(Stores, key=lambda store: store is not Stores.ROS2_JAZZY)
    wanted = document.head.digests("definition")
    for release in (None, *(each for each in releases if each.name.startswith("ROS2_"))):
        reader = AnyReader(paths, default_typestore=get_typestore(release) if release else None)
        try:
            stack.enter_context(reader)
        except AnyReaderError:
            if release is not None:
                raise
            continue  # it has no definitions
        if wanted == {name: definition_digest(reader.typestore, name) for name in wanted}:
            return reader
        reader.close()
        stack.pop_all()
    raise Refused("its messages are not defined as written, neither by itself nor by a release of ROS 2")


def definition_digest(store: Any, name: str) -> str:
    """The digest of the definition of a message, and of all that is in it."""
    found, todo = {}, [name]
    while todo:
        of = todo.pop()
        if of not in found and of in store.fielddefs:
            fields = [(type_text(kind), name) for name, kind in store.fielddefs[of][1]]
            found[of] = f"{of}: {', '.join(f'{kind} {name}' for kind, name in fields)}\n"
            todo += [kind.partition("[")[0] for kind, _ in fields]
    return hashlib.sha256("".join(found[of] for of in sorted(found)).encode()).hexdigest()


def type_text(kind: Any) -> str:
    """The type of a field, as rosbags has it."""
    of, what = kind
    if of.name == "BASE":
        return "uint8" if what[0] in ("byte", "octet", "char") else str(what[0])
    if of.name == "NAME":
        return str(what)
    return f"{type_text(what[0])}[{what[1] if of.name == 'ARRAY' else ''}]"


def read_bag(reader: Any, document: Document, wanted: dict[str, dict[str, Json]]) -> Recording:
    """All messages in the order of time, and of the file among equal times."""
    found = Recording(None, None, {name: Topic(values={path: [] for path in paths}) for name, paths in wanted.items()})
    by_header = document.head.one("stamp") == "header"
    takers: dict[int, tuple[Topic, list[tuple[list[Any], Callable[[Any], Any]]]]] = {}
    for connection in reader.connections:
        name = f"/{connection.topic.lstrip('/')}"
        if name in wanted:
            if any(each["type"] != connection.msgtype for each in wanted[name].values()):
                raise NotCovered(f"{name} has messages of type {connection.msgtype}")
            values = found.topics[name].values
            gets = [(values[path], getter(each["path"])) for path, each in wanted[name].items()]
            takers[id(connection)] = found.topics[name], gets
    for place, (connection, time, raw) in enumerate(reader.messages()):
        found.first = time if found.first is None else min(time, found.first)
        found.last = time if found.last is None else max(time, found.last)
        if id(connection) not in takers:
            continue
        topic, gets = takers[id(connection)]
        message = reader.deserialize(raw, connection.msgtype) if gets or by_header else None
        if by_header and (stamp := getattr(getattr(message, "header", None), "stamp", None)) is not None:
            time = stamp.sec * SECOND + stamp.nanosec
            if not time:
                continue
        topic.times.append(time)
        topic.places.append(place)
        for taken, get in gets:
            taken.append(get(message))
    read = {each["type"] for name, topic in found.topics.items() if topic.times for each in wanted[name].values()}
    if undefined := sorted(read - document.head.digests("definition").keys()):
        raise Refused(f"how messages are defined is not written: {', '.join(undefined)}")
    return part_of(found, document.head, by_header=by_header)


def part_of(found: Recording, head: Part, *, by_header: bool) -> Recording:
    """The messages in the times that are asked for, in their order."""
    since, to = head.time("from"), head.time("to")
    earliest, latest = -math.inf if since is None else since, math.inf if to is None else to
    for topic in found.topics.values():
        times, places = np.array(topic.times, np.int64), np.array(topic.places, np.int64)
        order = np.lexsort((places, times))
        order = order[(times[order] >= earliest) & (times[order] <= latest)]
        topic.times, topic.places = times[order], places[order]
        topic.values = {path: [of[n] for n in order.tolist()] for path, of in topic.values.items()}
    if by_header:
        spans = [(int(topic.times[0]), int(topic.times[-1])) for topic in found.topics.values() if len(topic.times)]
        found.first = min((first for first, _ in spans), default=None)
        found.last = max((last for _, last in spans), default=None)
    elif since is not None and found.first is not None:
        found.first = max(since, found.first)
    found.last = found.last if to is None else to
    return found


# Values --------------------------------------------------------------------------------------------------------------


@dataclass
class Lists:
    """Arrays of many lengths: their elements one after the other, where each begins and how long it is."""

    elements: Array
    starts: Array
    lengths: Array

    def taken(self, at: Array) -> Lists:
        """Some of them."""
        return Lists(self.elements, self.starts[at], self.lengths[at])

    def each(self) -> Iterator[list[Any]]:
        """One after the other."""
        for start, length in zip(self.starts.tolist(), self.lengths.tolist(), strict=True):
            yield self.elements[start : start + length].tolist()

    def packed(self) -> Array:
        """The elements of all of them."""
        return self.elements[self.starts.repeat(self.lengths) + within(self.lengths)]


def within(lengths: Array) -> Array:
    """0, 1, … for each length."""
    ends = lengths.cumsum()
    return np.arange(int(lengths.sum())) - (ends - lengths).repeat(lengths)


def as_lists(arrays: list[Any]) -> Lists:
    """Arrays as they come in messages."""
    lengths = np.array([len(each) for each in arrays], np.int64)
    some = [each for each in arrays if len(each)]
    if some and isinstance(some[0], np.ndarray):
        elements = column(np.concatenate(some).tolist())
    else:
        elements = column([value for each in some for value in each])
    return Lists(elements, lengths.cumsum() - lengths, lengths)


def column(values: list[Any]) -> Array:
    """Values of one type as an array: doubles, booleans, integers of 64 bits, or others as they are."""
    if not values:
        return np.zeros(0)
    if isinstance(values[0], (bool, np.bool_)):
        return np.array(values, bool)
    if isinstance(values[0], str):
        return as_objects(values)
    if isinstance(values[0], (int, np.integer)):
        if min(values) >= -EXACT and max(values) <= EXACT:
            return np.array(values, np.int64)
        return as_objects([int(value) for value in values])
    return np.array(values, np.float64)


def as_objects(values: list[Any]) -> Array:
    """Values as they are."""
    found = np.empty(len(values), object)
    found[:] = values
    return found


def doubles(values: Array) -> Array:
    """The nearest doubles."""
    return np.array([float(value) for value in values]) if values.dtype == object else values.astype(np.float64)


def is_nan(values: Array) -> Array:
    """Where they are NaN."""
    return np.isnan(values) if values.dtype == np.float64 else np.zeros(len(values), bool)


COMPARISONS = {"==": np.equal, "same": np.equal, "<": np.less, "<=": np.less_equal, ">": np.greater,
               ">=": np.greater_equal}  # fmt: skip


def compared(op: str, left: Array, right: Array, margin: float) -> Array:
    """A comparison: exact without a margin, in doubles with one."""
    if op not in COMPARISONS:
        raise Refused(f"no such comparison: {op}")
    if margin:
        left, right = doubles(left), doubles(right)
        if op == "==":
            return (left == right) | (np.abs(left - right) <= margin)
        right = right + margin
    return np.asarray(COMPARISONS[op](left, right)).astype(bool)


# Functions -----------------------------------------------------------------------------------------------------------


AT_ONCE: dict[str, Callable[..., Array]] = {
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.true_divide,
    "sqrt": np.sqrt,
    "floor": lambda x: np.floor(x) + 0.0,
    "ceil": lambda x: np.ceil(x) + 0.0,
    "sign": lambda x: np.sign(x) + 0.0,
    "gap": lambda x, y: np.where(x == y, 0.0, x - y),
}
"""What numpy computes as IEEE 754 has it, in doubles."""


def called(name: str, given: list[Array]) -> Array:
    """A function of numbers, of doubles unless it says otherwise."""
    if name in ("neg", "abs"):
        return -given[0] if name == "neg" else np.abs(given[0])
    if name in ("min", "max"):
        return extreme(name, given)
    given = [doubles(each) for each in given]
    if name in AT_ONCE:
        return AT_ONCE[name](*given)
    if name not in ONE_BY_ONE:
        raise NotCovered(f"the function {name}")
    known: dict[tuple[float, ...], float] = {}
    rows = list(zip(*(each.tolist() for each in given), strict=True))
    for values in {*rows}:
        known[values] = math.nan if any(map(math.isnan, values)) else ONE_BY_ONE[name](*values)
    return np.array([known.get(values, math.nan) for values in rows], np.float64)


def extreme(name: str, given: list[Array]) -> Array:
    """The least or greatest: of integers and constants that are such exactly, else in doubles."""
    if any(each.dtype == object for each in given) and all(are_integers(each) for each in given):
        choose = min if name == "min" else max
        return as_objects([choose(map(int, values)) for values in zip(*given, strict=True)])
    found, *others = [doubles(each) for each in given]
    wrong = np.isnan(found)
    for other in others:
        found = np.where(other < found if name == "min" else other > found, other, found)
        wrong |= np.isnan(other)
    return np.where(wrong, math.nan, found)


def are_integers(values: Array) -> bool:
    """Whether they are, or one constant that is one."""
    return values.dtype != np.float64 or bool(len(values) and (values == values[0]).all() and values[0] % 1 == 0)


def outside_nan(function: Callable[..., float]) -> Callable[..., float]:
    """Outside of its domain it is NaN; too large, infinite."""

    def found(*values: float) -> float:
        try:
            return function(*values)
        except ValueError:
            return math.nan
        except OverflowError:
            return math.inf

    return found


def remainder(x: float, y: float) -> float:
    """Of a division, with the sign of the divisor, rounded once."""
    if y == 0 or math.isinf(x):
        return math.nan
    if math.isinf(y):
        return y if x * y < 0 else x + 0.0
    return float(Fraction(x) % Fraction(y))


def between_angles(one: float, other: float) -> float:
    """How far apart two directions are."""
    turn = one - other
    return abs(math.remainder(turn, math.tau)) if math.isfinite(turn) else math.nan


def unit(*q: float) -> list[float]:
    """The quaternion of length 1 that is the same orientation."""
    length = math.hypot(*q)
    return [math.nan] * 4 if length == 0 or math.isinf(length) else [each / length for each in q]


def roll(*q: float) -> float:
    """About x, after yaw and pitch."""
    x, y, z, w = unit(*q)
    return math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))


def pitch(*q: float) -> float:
    """About y, after yaw."""
    x, y, z, w = unit(*q)
    return math.nan if math.isnan(x) else math.asin(max(-1.0, min(1.0, 2 * (w * y - z * x))))


def yaw(*q: float) -> float:
    """About z."""
    x, y, z, w = unit(*q)
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


ONE_BY_ONE: dict[str, Callable[..., float]] = {
    **{name: outside_nan(getattr(math, name)) for name in ("exp", "sin", "cos", "tan", "asin", "acos", "atan2")},
    "log": outside_nan(lambda x: -math.inf if x == 0 else math.log(x)),
    "hypot": math.hypot,
    "mod": remainder,
    "angle_between": between_angles,
    "roll": roll,
    "pitch": pitch,
    "yaw": yaw,
    "angle": angle,
    "inside": inside,
    "distance": distance,
}
"""What is computed by Python's mathematical library, for numbers none of which is NaN."""


def folded(name: str, lists: Lists) -> Array:
    """A function of each of many arrays."""
    if name == "len":
        return lists.lengths
    if name in ("min", "max") and lists.elements.dtype == object:
        found = [(min if name == "min" else max)(each, default=None) for each in lists.each()]
        return np.full(len(found), math.nan) if None in found else as_objects(found)
    function = {"min": least, "max": most, "sum": total, "mean": mean, "median": median}.get(name)
    if function is None:
        raise NotCovered(f"the function {name} of an array")
    if name in ("min", "max"):
        return fastest(name, function, Lists(doubles(lists.elements), lists.starts, lists.lengths))
    return np.array([function([float(value) for value in each]) for each in lists.each()], np.float64)


def fastest(name: str, function: Callable[[list[float]], float], lists: Lists) -> Array:
    """The extreme elements of all arrays; which of 0 and -0 it is, the first one says."""
    found, some = np.full(len(lists.lengths), math.nan), np.flatnonzero(lists.lengths)
    if len(some):
        of, lengths = lists.taken(some), lists.lengths[some]
        at = lengths.cumsum() - lengths
        found[some] = (np.fmin if name == "min" else np.fmax).reduceat(of.packed(), at)
    for n in np.flatnonzero(found == 0):
        [each] = lists.taken(np.array([n])).each()
        found[n] = function(each)
    return found


def measured(values: list[float]) -> list[float]:
    """Those that are not NaN."""
    return [value for value in values if not math.isnan(value)]


def least(values: list[float]) -> float:
    """The least element."""
    return min(measured(values), default=math.nan)


def most(values: list[float]) -> float:
    """The greatest element."""
    return max(measured(values), default=math.nan)


def total(values: list[float]) -> float:
    """The double nearest to the sum."""
    infinite = {value for value in values if not math.isfinite(value)}
    if infinite:
        return infinite.pop() if len(infinite) == 1 else math.nan
    try:
        return math.fsum(values) + 0.0
    except OverflowError:
        exact = sum(map(Fraction, values))
        return outside_nan(float)(exact) if exact > 0 else -outside_nan(float)(-exact)


def mean(values: list[float]) -> float:
    """The sum by the number."""
    known = measured(values)
    return total(known) / len(known) if known else math.nan


def median(values: list[float]) -> float:
    """The middle one; of an even number the double nearest to the mean of the middle two."""
    known = sorted(measured(values))
    if not known:
        return math.nan
    low, high = known[(len(known) - 1) // 2], known[len(known) // 2]
    return float((Fraction(low) + Fraction(high)) / 2) if math.isfinite(low) and math.isfinite(high) else low + high


def nearest(sought: float, values: list[float]) -> float:
    """The first that differs least."""
    known = measured(values)
    if math.isnan(sought) or not known:
        return math.nan
    return min(known, key=lambda value: 0.0 if value == sought else abs(value - sought))


# Instants ------------------------------------------------------------------------------------------------------------


@dataclass
class Samples:
    """The samples of a signal: their values, and at which instants there is one."""

    values: Any
    fresh: Array

    @property
    def numbers(self) -> Array:
        """Which is the latest at each instant; -1: none."""
        return self.fresh.cumsum() - 1


class Instants:
    """The messages of some topics one after the other, or the ticks that see them."""

    def __init__(self, recorded: Recording, topics: set[str], rate: Fraction | None, session: int | None) -> None:
        """With `session`, an instant of its own is the first, or the first tick is then."""
        self.topics = {name: recorded.topics[name] for name in sorted(topics)}
        self.is_ticks = rate is not None
        starts = [int(topic.times[0]) for topic in self.topics.values() if len(topic.times)]
        starts = starts if session is None else [session]
        if rate is not None:
            self.times = ticks(rate, min(starts), recorded.last or 0) if starts else np.zeros(0, np.int64)
        else:
            own = [] if session is None else [session]
            times = np.concatenate([np.array(own, np.int64), *(topic.times for topic in self.topics.values())])
            places = np.concatenate([np.full(len(own), -1), *(topic.places for topic in self.topics.values())])
            order = np.lexsort((places, times))
            self.times, place_of = times[order], np.empty(len(order), np.int64)
            place_of[order] = np.arange(len(order))
            ends = np.cumsum([len(own), *(len(topic.times) for topic in self.topics.values())]).tolist()
            pairs = itertools.pairwise(ends)
            self.places = {name: place_of[a:b] for name, (a, b) in zip(self.topics, pairs, strict=True)}
        self.count = len(self.times)

    def at(self, name: str) -> Array:
        """At which instants the messages of a topic come; of ticks, which is the first to see each."""
        return self.times.searchsorted(self.topics[name].times) if self.is_ticks else self.places[name]

    def heard(self, names: Iterable[str], *, now: bool = False) -> Array:
        """Where there is news of some topics; with `now`, at this very time."""
        found = np.zeros(self.count, bool)
        for name in names:
            at = self.at(name)
            seen = at < self.count
            if now and self.is_ticks:
                seen[seen] = self.times[at[seen]] == self.topics[name].times[seen]
            found[at[seen]] = True
        return found

    def samples(self, x: Json) -> Samples:
        """Those of a field."""
        values = self.topics[x["topic"]].values[json.dumps(x["path"])]
        having = np.array([n for n, value in enumerate(values) if value is not None], np.int64)
        known = [values[n] for n in having.tolist()]
        fresh = np.zeros(self.count, bool)
        if self.is_ticks:
            latest = self.topics[x["topic"]].times[having].searchsorted(self.times, "right") - 1
            fresh = latest >= 0
            taken = latest[fresh]
        else:
            fresh[self.at(x["topic"])[having]] = True
            taken = np.arange(len(known))
        if known and isinstance(known[0], (list, np.ndarray)):
            return Samples(as_lists(known).taken(taken), fresh)
        return Samples(column(known)[taken], fresh)


def ticks(rate: Fraction, start: int, end: int) -> Array:
    """The times of ticks, cut off to nanoseconds."""
    period = SECOND / rate
    count = max(0, ((end - start + 1) * period.denominator - 1) // period.numerator + 1)
    if count > MOST_TICKS:
        raise NotCovered(f"more than {MOST_TICKS} ticks")
    return np.array([start + k * period.numerator // period.denominator for k in range(count)], np.int64)


# Expressions ---------------------------------------------------------------------------------------------------------

READS = ("path", "sampled", "ago", "recent", "slope", "new", "message", "instead")


class Values:
    """The values of expressions at all instants."""

    def __init__(self, instants: Instants) -> None:
        self.instants = instants
        self.kept: dict[str, Any] = {}
        self.taken: dict[int, Array] = {}

    def take(self, taken: dict[int, Array]) -> None:
        """From now on, values at the openings of scopes are taken at these instants."""
        self.taken = taken
        self.kept = {key: value for key, value in self.kept.items() if '"opening"' not in key}

    def once(self, kind: str, x: Json, make: Callable[[], Any]) -> Any:
        """What is made once of an expression."""
        key = kind + json.dumps(x)
        if key not in self.kept:
            self.kept[key] = make()
        return self.kept[key]

    # Samples

    def samples(self, x: Json) -> Samples:
        """The samples of a signal: a field, or something computed from others."""
        found: Samples = self.once("samples", x, lambda: (self.instants.samples if "path" in x else self.computed)(x))
        return found

    def computed(self, x: Json) -> Samples:
        """There is one where a part has one, with `when` only where that holds and nothing is NaN."""
        values, fresh = self.number(x["sampled"]), self.fresh(x) & self.known([*x.values()])
        if "when" in x:
            fresh = fresh & self.predicate(x["when"]) & ~is_nan(values)
            asked = [side for part in parts(x["when"]) if "op" in part for side in sides(part)]
            for side in [*asked, *x.get("measured", [])]:
                fresh &= ~is_nan(self.number(side))
        return Samples(values[fresh], fresh)

    def fresh(self, x: Json) -> Array:
        """Where something that is read has a sample, or news."""
        found = np.zeros(self.instants.count, bool)
        for part in parts(x):
            if "path" in part:
                found |= self.samples(part).fresh
            for key in ("new", "message"):
                if key in part:
                    found |= self.instants.heard(part[key])
        return found

    def known(self, x: Json) -> Array:
        """Where all that is waited for has a value."""
        if isinstance(x, list):
            return np.logical_and.reduce([np.ones(self.instants.count, bool), *map(self.known, x)])
        if not isinstance(x, dict) or "new" in x or "message" in x or "instead" in x:
            return np.ones(self.instants.count, bool)
        if any(key in x for key in READS):
            of, ago = latest_of(x)
            return self.samples(of).numbers >= ago
        return self.known(list(x.values()))

    # Values

    def number(self, x: Json) -> Array:
        """The value of what is no array at each instant; anything where there is none."""
        return self.once("value", x, lambda: self.evaluate(x, None))

    def evaluate(self, x: Json, elements: Elements | None) -> Array:
        """The value at each instant, or of each of some `elements`."""
        count = self.instants.count if elements is None else elements.count
        if elements is not None and isinstance(x, dict) and not has_element(x):
            return elements.beside(self.number(x))
        match x:
            case bool():
                return np.full(count, x)
            case str():
                return as_objects([x]).repeat(count)
            case int() | float():
                return column([x]).repeat(count)
            case {"number": text}:
                return np.full(count, float(text))
            case {"element": array} if elements is not None:
                return elements.of(array)
            case {"opening": of, "scope": number}:
                return self.number(of)[self.taken[number]]
            case {"predicate": predicate}:
                return self.predicate(predicate, elements)
            case {"count": predicate}:
                return self.counted(predicate, x.get("over"))
            case {"call": "min" | "max" | "sum" | "mean" | "median" | "len" as name, "of": [array]}:
                lists, at = self.lists(array)
                return self.once("fold", x, lambda: folded(name, lists))[at]
            case {"call": "nearest", "of": [sought, array]}:
                lists, at = self.lists(array)
                found = zip(doubles(self.number(sought)).tolist(), lists.taken(at).each(), strict=True)
                return np.array([nearest(near, [float(v) for v in values]) for near, values in found])
            case {"call": name, "of": given}:
                return called(name, [self.evaluate(each, elements) for each in given])
            case _:
                return self.latest(x)

    def latest(self, x: Json) -> Array:
        """What is read of a signal, or of messages."""
        if "new" in x:
            return self.instants.heard(x["new"])
        if "message" in x:
            return self.instants.heard(x["message"], now=True)
        if "instead" in x:
            values, known = self.number(x["of"]), self.known(x["of"])
            stand_in = self.evaluate(x["instead"], None)
            return np.where(known, values, stand_in) if known.any() else stand_in
        of, ago = latest_of(x)
        samples, numbers = self.samples(of), self.samples(of).numbers
        if not len(samples.values):
            return nothing(self.instants.count)
        if "slope" not in x:
            return samples.values[np.maximum(numbers - ago, 0)]
        times, values = self.instants.times[samples.fresh], doubles(samples.values)
        last, before = np.maximum(numbers, 0), np.maximum(numbers - 1, 0)
        past = times[last] - times[before]
        return np.where(
            past == 0, math.nan, (values[last] - values[before]) / np.array([t / SECOND for t in past.tolist()])
        )

    def lists(self, x: Json) -> tuple[Lists, Array]:
        """Arrays, and which of them is the value at each instant; where there is none, any."""
        found: tuple[Lists, Array] = self.once("lists", x, lambda: self.arrays(x))
        return found

    def arrays(self, x: Json) -> tuple[Lists, Array]:
        """The same, computed."""
        if isinstance(x, list):
            return as_lists([x]), np.zeros(self.instants.count, np.int64)
        if "slice" in x:
            lists, at = self.lists(x["of"])
            (start, stop), lengths = x["slice"], lists.lengths
            first = np.clip(within_bounds(start, lengths, 0), 0, lengths)
            end = np.clip(within_bounds(stop, lengths, lengths), first, lengths)
            return Lists(lists.elements, lists.starts + first, end - first), at
        if "instead" in x:
            lists, at = self.lists(x["of"])
            values = [*lists.each(), x["instead"]]
            return as_lists(values), np.where(self.known(x["of"]), at, len(values) - 1)
        of, ago = latest_of(x)
        samples, numbers = self.samples(of), self.samples(of).numbers
        if "recent" in x:
            first = np.maximum(numbers - ago, 0)
            length = np.where(numbers >= ago, ago + 1, 0)
            return Lists(samples.values, first, length), np.arange(self.instants.count)
        if not isinstance(samples.values, Lists) or not len(samples.values.lengths):
            return as_lists([[]]), np.zeros(self.instants.count, np.int64)
        return samples.values, np.maximum(numbers - ago, 0)

    # Conditions

    def predicate(self, x: Json, elements: Elements | None = None) -> Array:
        """Where a state predicate holds."""
        match x:
            case True:
                return np.ones(self.instants.count if elements is None else elements.count, bool)
            case {"not": operand}:
                return ~self.predicate(operand, elements)
            case {"and": operands}:
                return np.logical_and.reduce([self.predicate(each, elements) for each in operands])
            case {"or": operands}:
                return np.logical_or.reduce([self.predicate(each, elements) for each in operands])
            case {"op": "true", "left": operand}:
                return self.evaluate(operand, elements).astype(bool)
            case {"op": op, "left": left, "right": right}:
                values = self.evaluate(left, elements), self.evaluate(right, elements)
                return compared(op, *values, x.get("margin", 0.0))
            case _:
                raise Refused(f"not a predicate: {json.dumps(x)[:80]}")

    def invalid(self, x: Json) -> Array:
        """Where a condition compares something that is NaN, or a first value did not come with its message."""
        found = np.zeros(self.instants.count, bool)
        for side in sides(x):
            found |= is_nan(self.number(side))
        for part in parts(x):
            if "recent" in part:
                lists, at = self.lists(part)
                wrong = is_nan(lists.packed())
                found |= (
                    np.array(folded("max", Lists(wrong * 1.0, lists.lengths.cumsum() - lists.lengths, lists.lengths)))[
                        at
                    ]
                    > 0
                )
            if "news" in part:
                came = np.logical_and.reduce([self.instants.heard([topic]) for topic in part["news"]])
                found |= came & ~self.known(part["of"])
        return found

    def counted(self, predicate: Json, over: Json) -> Array:
        """How many elements satisfy a predicate; NaN where something beside them is, or there are too many."""
        arrays = {json.dumps(p["element"]): p["element"] for p in parts(predicate) if "element" in p}
        groups = [[json.dumps(each) for each in group] for group in over] if over else [list(arrays)]
        alone = [self.number(x) for x in singles(predicate)]
        at = [self.lists(arrays[key])[1] for group in groups for key in group]
        new = np.ones(self.instants.count, bool)
        changes = [each[1:] != each[:-1] for each in (*at, *alone)]
        new[1:] = np.logical_or.reduce(changes) if changes else True
        chosen = np.flatnonzero(new)
        counts = np.zeros(len(chosen))
        lists = {key: self.lists(array)[0].taken(self.lists(array)[1][chosen]) for key, array in arrays.items()
                 if len(self.lists(array)[0].lengths)}  # fmt: skip
        if len(lists) == len(arrays):
            sizes = [np.minimum.reduce([lists[key].lengths for key in group]) for group in groups]
            combinations = np.multiply.reduce([size.astype(np.float64) for size in sizes])
            is_over = len(groups) > 1
            usable = combinations <= MOST_COMBINATIONS if is_over else np.ones(len(chosen), bool)
            for some in pieces(np.where(usable, combinations, 0)):
                some = some[usable[some]]
                here = {key: of.taken(some) for key, of in lists.items()}
                elements = Elements(groups, [size[some] for size in sizes], here, chosen[some])
                counts[some] = elements.sums(self.satisfied(predicate, elements))
            counts[~usable] = math.nan
        for each in alone:
            counts[is_nan(each[chosen])] = math.nan
        return counts[new.cumsum() - 1]

    def satisfied(self, predicate: Json, elements: Elements) -> Array:
        """Which elements satisfy a predicate: none for which something that is compared is NaN."""
        holds = self.predicate(predicate, elements)
        for part in parts(predicate):
            if "op" in part:
                for side in sides(part):
                    holds = holds & ~is_nan(self.evaluate(side, elements))
        return holds


class Elements:
    """The combinations of elements of some arrays at some instants: side by side in a group, all with all of others."""

    def __init__(self, groups: list[list[str]], sizes: list[Array], lists: dict[str, Lists], at: Array) -> None:
        self.groups, self.lists, self.at = groups, lists, at
        self.totals = np.multiply.reduce(sizes) if sizes else np.zeros(len(at), np.int64)
        self.count = int(self.totals.sum())
        self.indexes: list[Array] = []
        rest = within(self.totals)
        for size in reversed(sizes):
            repeated = size.repeat(self.totals)
            self.indexes.insert(0, rest % np.maximum(repeated, 1))
            rest = rest // np.maximum(repeated, 1)

    def of(self, array: Json) -> Array:
        """The elements of an array."""
        key = json.dumps(array)
        [group] = (n for n, each in enumerate(self.groups) if key in each)
        return self.lists[key].elements[self.lists[key].starts.repeat(self.totals) + self.indexes[group]]

    def beside(self, values: Array) -> Array:
        """What is no element, beside each of them."""
        return values[self.at].repeat(self.totals)

    def sums(self, holds: Array) -> Array:
        """How many there are at each instant."""
        return np.bincount(np.arange(len(self.at)).repeat(self.totals), holds, len(self.at))


def sides(condition: Json) -> list[Json]:
    """What a condition compares."""
    return [condition["left"], condition["right"]] if "right" in condition else [condition["left"]]


def latest_of(x: Json) -> tuple[Json, int]:
    """The signal that is read, and how many samples ago at the furthest."""
    if "path" in x or "sampled" in x:
        return x, 0
    return x["of"], 1 if "slope" in x else x.get("ago", x.get("recent", 0))


def has_element(x: Json) -> bool:
    """Whether it is about elements."""
    return any("element" in part for part in parts(x))


def singles(x: Json) -> Iterator[Json]:
    """The largest expressions beside elements that read something."""
    if isinstance(x, list):
        for part in x:
            yield from singles(part)
    elif isinstance(x, dict) and "element" not in x:
        if has_element(x) or any(key in x for key in ("op", "not", "and", "or")):
            yield from singles([x[key] for key in ("left", "right", "of", "not", "and", "or") if key in x])
        elif topics_of(x):
            yield x


def within_bounds(index: int | None, lengths: Array, default: Any) -> Array:
    """An index that counts from the end if it is negative."""
    return lengths * 0 + default if index is None else (lengths + index if index < 0 else lengths * 0 + index)


def nothing(count: int) -> Array:
    """No values."""
    return np.full(count, math.nan)


def pieces(sizes: Array) -> Iterator[Array]:
    """The numbers of all, some at a time, which are of limited size altogether."""
    numbers = np.arange(len(sizes))
    marks = (sizes.cumsum() // PIECE).astype(np.int64)
    for mark in np.unique(marks):
        yield numbers[marks == mark]


# Lines ---------------------------------------------------------------------------------------------------------------


@dataclass
class Run:
    """The instants of a property that may have lines: times and letters, and since when ages count."""

    times: Array
    letters: Array
    session: int
    news: int


def values_of(recorded: Recording, topics: set[str], rate: Fraction | None, session: int | None, alone: str) -> Values:
    """The values at the instants of some topics, made once, or once for a property alone."""
    key = frozenset(topics), session, alone
    if key not in recorded.kept:
        recorded.kept[key] = Values(Instants(recorded, topics, rate, session))
    found: Values = recorded.kept[key]
    return found


def run_of(claim: Part, recorded: Recording, head: Part, first: int, *, apart: bool) -> Run:
    """The run of a property. With `apart`, what begins with the session has an instant of its own there."""
    with covered("its atoms cannot be computed"):
        atoms, rate = claim.atoms, Fraction(head.one("rate")) if head.one("rate") else None
        begins = not is_waited_for(atoms) and (apart or rate is not None)
        scopes = [Scope(text) for text in claim.said.get("scope", [])]
        alone = claim.one("property") if scopes else ""
        values = values_of(recorded, topics_of(atoms), rate, first if begins else None, alone)
        instants, count = values.instants, values.instants.count
        begun, stepped = np.ones(count, bool), np.full(count, rate is not None)
        stepped[:1] |= begins
        news, messages = 0, {}
        after = 0 if recorded.sliced is None else int(instants.places[recorded.sliced][0])
        steps: Array = None
        with np.errstate(all="ignore"):
            for n, atom in enumerate(atoms):
                begun &= values.known(atom)
                stepped |= values.fresh(atom)
                of = atom["left"] if atom["op"] == "true" and isinstance(atom["left"], dict) else {}
                news |= ("new" in of or "message" in of) << n
                if "message" in of:
                    messages[1 << n] = of["message"]
            for _ in range(MOST_ROUNDS):
                before = np.zeros(0, np.int64) if steps is None else steps
                values.take({scope.number: scope.taken(before, count) for scope in scopes})
                valid = ~np.logical_or.reduce([np.zeros(count, bool), *map(values.invalid, atoms)])
                steps = after + np.flatnonzero((stepped & begun & valid)[after:])
                if not scopes or np.array_equal(steps, before):
                    break
            else:
                raise NotCovered("which steps there are depends on values at openings")
            letters = np.zeros(len(steps), np.int64)
            for n, atom in enumerate(atoms):
                letters |= values.predicate(atom)[steps].astype(np.int64) << n
            seen = int(instants.times[steps].searchsorted(claim.time("until") or 0, "right"))
            for n, scope in enumerate(scopes, len(atoms)):
                if not scope.is_canonical(seen):
                    raise Refused(f"from which steps on scope {scope.number} is open is not written as it should be")
                letters |= scope.open(len(steps)).astype(np.int64) << n
        return with_messages(Run(instants.times[steps], letters, first, news), steps, instants, messages)


class Scope:
    """A scope of a property: its number, and from which steps up to which it is said to be open."""

    def __init__(self, text: str) -> None:
        head, *spans = text.split(" ")
        self.text, self.number = text, number(head)
        pairs = [span.partition("-") for span in spans]
        self.spans = [(number(first), number(end) if end else None) for first, _, end in pairs]

    def open(self, count: int) -> Array:
        """At which steps it is open."""
        found = np.zeros(count, bool)
        for first, end in self.spans:
            found[first:end] = True
        return found

    def taken(self, steps: Array, count: int) -> Array:
        """For each instant, at which one the value at the opening was taken: at itself unless it was open before."""
        before = np.zeros(count, bool)
        if len(steps):
            last = steps.searchsorted(np.arange(count)) - 1
            before = (last >= 0) & self.open(len(steps))[last]
        return np.maximum.accumulate(np.where(before, 0, np.arange(count)))

    def is_canonical(self, count: int) -> bool:
        """Whether of so many steps it is said in no more words than it has to be."""
        turns = np.flatnonzero(np.diff(self.open(count).astype(np.int8), prepend=0)).tolist()
        spans = [f" {a}-{b}" for a, b in itertools.zip_longest(turns[::2], turns[1::2], fillvalue="")]
        return self.text == "".join([str(self.number), *spans])


def with_messages(run: Run, steps: Array, instants: Instants, messages: dict[int, list[str]]) -> Run:
    """The steps, and between them the messages that make none, but from which ages count; of each the bit."""
    if not len(steps):
        return run
    is_step = set(run.times.tolist() if instants.is_ticks else steps.tolist()) if messages else set()
    others: dict[tuple[int, int], tuple[int, int]] = {}
    for bit, name in ((bit, name) for bit, names in messages.items() for name in names):
        topic = instants.topics[name]
        for time, place, at in zip(
            *map(np.ndarray.tolist, (topic.times, topic.places, instants.at(name))), strict=True
        ):
            if (time if instants.is_ticks else at) not in is_step:
                others[time, place] = others.get((time, place), (0, 0))[0] | bit, at
    heard: dict[int, int | None] = {bit: None for bit in messages if not int(run.letters[0]) & bit}
    more = []
    for (time, _), (bits, at) in sorted(others.items()):
        before = int(run.times.searchsorted(time, "right") if instants.is_ticks else steps.searchsorted(at))
        if before:
            more.append((before, time, (int(run.letters[before - 1]) & ~run.news) | bits))
        else:
            heard |= {bit: time for bit in heard if bit & bits}
    if len({*heard.values()}) > 1:
        raise NotCovered("its ages count from different messages before its first step")
    ages = [time for time in heard.values() if time is not None]
    where, times, letters = zip(*more, strict=True) if more else ((), (), ())
    return Run(
        np.insert(run.times, where, times), np.insert(run.letters, where, letters), (ages or [run.session])[0], run.news
    )


def is_waited_for(x: Json) -> bool:
    """Whether something is read that has a first value, and nothing instead of it."""
    if isinstance(x, dict) and "instead" not in x:
        return "path" in x or any(map(is_waited_for, x.values()))
    return isinstance(x, list) and any(map(is_waited_for, x))


def lines_of(run: Run, until: int) -> tuple[Array, Array]:
    """The instants that have a line: the first, a letter that is not the one held, a time that is that of the last."""
    end = int(run.times.searchsorted(until, "right"))
    times, letters = run.times[:end], run.letters[:end]
    differs = np.ones(end, bool)
    differs[1:] = letters[1:] != (letters[:-1] & ~run.news)
    for n in np.flatnonzero(times[1:] == times[:-1]) + 1:
        differs[n] |= differs[n - 1]
    return times[differs], letters[differs]


def word_of(letter: int) -> str:
    """A letter as it is written."""
    return "".join(f" a{n}" for n in range(63) if letter >> n & 1)


def text_of(times: Array, letters: Array) -> Iterator[str]:
    """The lines as they are written."""
    words = {each: word_of(each) for each in set(letters.tolist())}
    for n in range(0, len(times), PIECE):
        gaps = np.diff(times[n : n + PIECE], prepend=times[max(n - 1, 0)]).tolist()
        some = zip(gaps, letters[n : n + PIECE].tolist(), strict=True)
        text = "".join([f"+{gap}{words[letter]}\n" for gap, letter in some])
        yield text if n else f"at {times[0]}{text[2:]}"


def summed(times: Array, letters: Array) -> str:
    """What stands in the place of many lines."""
    digest = hashlib.sha256()
    for text in text_of(times, letters):
        digest.update(text.encode())
    return f"{len(times)} sha256 {digest.hexdigest()}"


# The comparison ------------------------------------------------------------------------------------------------------


def check_document(document: Document, path: Path, say: Callable[[str], None]) -> int:
    """Check all claims; the exit code."""
    for label, _, reason in (each.partition(": ") for each in document.not_covered):
        say(f"{label}: nothing is claimed: {reason}")
    head, codes = document.head, [0]
    try:
        if not document.claims:
            return 0
        if ("stamp" in head.said or "timeout" in head.said) and document.not_covered:
            raise Refused("something is claimed of some properties only, though the run depends on all")
        recorded = read(path, document)
        if recorded.first is None or recorded.last is None:
            raise Refused("the recording has no messages")
        ends = end_of(document, recorded, recorded.first, recorded.last)
    except (NotCovered, Refused) as error:
        is_refused = isinstance(error, Refused)
        say(f"{'REFUSED' if is_refused else 'NOT COVERED'}: {error}")
        return 1 if is_refused else 2
    for claim in document.claims:
        label = claim.one("property")
        try:
            run = check_claim(claim, recorded, head, recorded.first, ends)
            assert claim.found is not None
            counts = plural(len(run.times), "instant"), plural(len(claim.found[0]), "line")
            say(f"{label}: the letters are as stated: {', '.join(counts)}")
        except NotCovered as error:
            say(f"{label}: NOT COVERED: {error}")
            codes.append(2)
        except Refused as error:
            say(f"{label}: REFUSED: {error}")
            codes.append(1)
    return 1 if 1 in codes else max(codes)


def end_of(document: Document, recorded: Recording, first: int, last: int) -> int:
    """When the run ends: with the recording, or so long after the first step of a property."""
    timeout = document.head.time("timeout")
    if timeout is None:
        return last
    runs = [run_of(claim, recorded, document.head, first, apart=True) for claim in document.claims]
    return min([last, *(int(run.times[0]) + timeout for run in runs if len(run.times))])


def slices_of(claim: Part, recorded: Recording) -> dict[str, Recording]:
    """The slices of all ids, in the order of their first messages: of the messages on the topic of the key, theirs."""
    [key] = claim.keys
    topic, path = recorded.topics[key["topic"]], json.dumps(key["path"])
    own = {json.dumps(each["path"]) for each in fields_of(claim.atoms) if ["own"] in each["path"]}
    found: dict[str, list[tuple[int, int]]] = {}
    for n, ids in enumerate(topic.values[path]):
        is_array = isinstance(ids, (list, np.ndarray))
        count = min([len(ids), *(len(topic.values[each][n]) for each in own)]) if is_array else ids is not None
        for at in range(count):
            if (one := id_of(ids[at] if is_array else ids)) is not None:
                found.setdefault(json.dumps(one), []).append((n, at))
    return {one: of_slice(recorded, key["topic"], places, own) for one, places in found.items()}


def of_slice(recorded: Recording, name: str, places: list[tuple[int, int]], own: set[str]) -> Recording:
    """What a slice has of a recording: at these places the messages on a topic, each with its element of arrays."""
    topic, numbers = recorded.topics[name], [n for n, _ in places]
    values = {path: [of[n][at] if path in own else of[n] for n, at in places] for path, of in topic.values.items()}
    topics = recorded.topics | {name: Topic(topic.times[numbers], topic.places[numbers], values)}
    return Recording(recorded.first, recorded.last, topics, name)


def id_of(value: Any) -> Any:
    """A value as an id: whole numbers are integers, and NaN is none."""
    value = value.item() if isinstance(value, np.generic) else value
    if isinstance(value, float) and value.is_integer():
        return int(value)
    return None if value != value else value


def check_claim(claim: Part, recorded: Recording, head: Part, first: int, ends: int) -> Run:
    """The run that is as claimed, which ends at `ends` at the latest; raises Refused if there is none."""
    if claim.keys:
        return check_slices(claim, recorded, head, first, ends)
    verdict, _, decided = claim.one("verdict").partition(" ")
    until = number(claim.one("until"))
    is_decided = verdict in ("violated", "satisfied")
    if decided != str(until) or (until > ends if is_decided else until != ends):
        raise Refused(f"the run ends at {ends}")
    problem = ""
    # Where a message has the time at which the session begins, that may have an instant of its own, or not.
    for apart in (True, False):
        run = run_of(claim, recorded, head, first, apart=apart)
        times, letters = lines_of(run, until)
        problem = problem or problem_with(claim, run, times, letters)
        if not problem_with(claim, run, times, letters):
            claim.found = times, letters
            return run
        if is_waited_for(claim.atoms):
            break
    raise Refused(problem)


def check_slices(claim: Part, recorded: Recording, head: Part, first: int, ends: int) -> Run:
    """The run of each id is as claimed; all of them together, with no letters of their own."""
    if "rate" in head.said or "timeout" in head.said:
        raise NotCovered("ticks or a timeout, for each id")
    with covered("its ids cannot be computed"):
        found = slices_of(claim, recorded)
    if [part.one("slice") for part in claim.slices] != list(found):
        raise Refused(f"the ids are {', '.join(found)}"[:200])
    runs = []
    for part, of in zip(claim.slices, found.values(), strict=True):
        alone = Part({**claim.said, "key": [], **part.said}, [], part.lines)
        try:
            runs.append(check_claim(alone, of, head, first, ends))
        except Refused as error:
            raise Refused(f"slice {part.one('slice')}: {error}") from None
        part.found = alone.found
    if claim.lines or claim.one("until") != (claim.one("verdict").partition(" ")[2]):
        raise Refused("it has letters of its own")
    if claim.time("until") != ends and not claim.one("verdict").startswith("violated "):
        raise Refused(f"the run ends at {ends}")
    claim.found = tuple(
        np.concatenate([np.zeros(0, np.int64), *(part.found[n] for part in claim.slices)]) for n in (0, 1)
    )
    times = np.concatenate([np.zeros(0, np.int64), *(run.times for run in runs)])
    return Run(times, times, first, 0)


def problem_with(claim: Part, run: Run, times: Array, letters: Array) -> str:
    """What is not as claimed, in words; nothing if all is."""
    if claim.time("session") != run.session:
        return f"ages count from {run.session}"
    if claim.one("verdict").startswith("not_started ") != (len(times) == 0):
        return "it has started" if len(times) else "it has not started"
    if "letters" in claim.said:
        found = summed(times, letters)
        return "" if claim.one("letters") == found and not claim.lines else f"the letters are {found}"
    found_lines = list(zip(times.tolist(), letters.tolist(), strict=True))
    if claim.lines == found_lines:
        return ""
    pairs = enumerate(zip(claim.lines, found_lines, strict=False))
    same = next((n for n, (one, other) in pairs if one != other), min(len(claim.lines), len(times)))
    if same == len(times):
        return f"there is no line {same + 1}"
    return f"line {same + 1} is at {times[same]}{word_of(int(letters[same]))}"


def plural(count: int, what: str) -> str:
    """So many of something."""
    return f"{count} {what}{'' if count == 1 else 's'}"


def filled(document: Document) -> Iterator[str]:
    """The document with the lines that were computed in place of their digests."""
    parts = iter([part for claim in document.claims for part in (claim, *claim.slices)])
    body, current = hashlib.sha256(), document.head
    for row in document.rows:
        current = next(parts) if row.startswith(("property ", "slice ")) else current
        has_lines = current.found is not None and row.startswith("letters ")
        for text in text_of(*current.found) if has_lines and current.found else [f"{row}\n"]:
            body.update(text.encode())
            yield text
    yield f"end sha256 {body.hexdigest()}\n"


def main(arguments: list[str]) -> int:
    """What the command line asks for; the exit code."""
    fill = None
    if "--fill" in arguments[:-1]:
        at = arguments.index("--fill")
        fill = Path(arguments[at + 1])
        arguments = arguments[:at] + arguments[at + 2 :]
    if len(arguments) < 2:
        print(str(__doc__).split("\n")[2].strip(), file=sys.stderr)
        return 2
    try:
        return check(Path(arguments[0]), [Path(each) for each in arguments[1:]], fill)
    except Refused as error:
        print(f"REFUSED: {error}")
        return 1
    except (OSError, ValueError, NotCovered) as error:
        print(f"recorded.py: {error}", file=sys.stderr)
        return 2


def check(evidence: Path, others: list[Path], fill: Path | None) -> int:
    """Check each document against the recording that has its digests; the exit code."""
    found = list(documents(evidence.read_bytes().decode("utf-8")))
    certificates = [path for path in others if is_certificates(path)]
    recordings = {path: told(path) for path in others if path not in certificates}
    codes = [0]
    for document in found:
        if any({"": sha256(path)} != document.head.digests("certificates") for path in certificates):
            raise Refused("these are not the certificates")
        wanted = document.head.digests("recording")
        path = next((path for path, files in recordings.items() if files == wanted), None)
        if len(found) > 1:
            print(f"recording {', '.join(wanted)}")
        if path is None:
            print(f"REFUSED: {missing(wanted, recordings.values())}")
            codes.append(1)
            continue
        codes.append(check_document(document, path, print))
    if fill is not None:
        with fill.open("w", encoding="utf-8", newline="\n") as file:
            for document in found:
                file.writelines(filled(document))
    return 1 if 1 in codes else max(codes)


def missing(wanted: dict[str, str], recordings: Iterable[dict[str, str]]) -> str:
    """Which file is another one, if there is a recording with files of these names."""
    names = {name.rpartition(" ")[0] for name in wanted}
    for files in recordings:
        if {name.rpartition(" ")[0] for name in files} == names:
            [other, *_] = (name for name in wanted if files.get(name) != wanted[name])
            return f"{other.rpartition(' ')[0]} is another file: it has not the size and the SHA-256 that are written"
    return f"there is no recording with the files {', '.join(sorted(names))}"


def is_certificates(path: Path) -> bool:
    """Whether a file has certificates, by its first line."""
    if not path.is_file():
        return False
    with path.open("rb") as file:
        return file.read(17) == b"ltlc-certificate "


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
