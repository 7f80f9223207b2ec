"""Random specifications and recordings, judged by columns and row by row, and whether all is the same."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from random import Random
from typing import Any

from stepping import from_text

from ltlc.backends.python.load import load_plan
from ltlc.base.source import Source
from ltlc.frontend.language import load_text
from ltlc.inputs.recordings import lacks
from ltlc.inputs.recordings.blocks import Block, blocks_of
from ltlc.inputs.recordings.rows import Column, Row
from ltlc.inputs.recordings.trails import Trailing
from ltlc.monitoring.columns import arrays, bits, follow, kept, leaps, tables, thresholds
from ltlc.monitoring.columns import session as columns_session
from ltlc.monitoring.columns.prepared import prepare_all
from ltlc.monitoring.columns.session import ByBlocks
from ltlc.monitoring.later import JudgedTrack, all_violations
from ltlc.monitoring.restarting import restarting
from ltlc.runtime import documents, reports
from ltlc.runtime.episodes import Episodes
from ltlc.runtime.properties import MonitoredProperty
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Session
from ltlc.runtime.tracking import Observer, Track
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.expressions import Signal, ValueType
from ltlc.specification.wire import PRIMITIVES, SINGLES

DECLARATIONS = """
decl v /v Float64.data
decl w /w Float64.data
decl pair_x /pair Vector3.x
decl pair_y /pair Vector3.y
decl f /f Float32.data
decl n /n Int64.data
decl flag /flag Bool.data
decl mode /mode String.data
decl scan /scan LaserScan.ranges
decl ids /marks MarkerArray.markers[].id
decl kinds /marks MarkerArray.markers[].ns
decl locked /marks MarkerArray.markers[].frame_locked
"""

NUMBERS = ("v", "w", "pair_x", "pair_y", "f", "n", "robot.velocity", "robot.position.x")
PARTS = {
    "pair": ("pair_x", "pair_y"),
    "marks": ("ids", "kinds", "locked"),
    "robot.velocity": ("robot.velocity.x", "robot.velocity.y", "robot.velocity.z"),
    "robot.position.x": ("robot.position.x",),
}

KINDS: Mapping[str, Column] = {
    "f": Column(ValueType.NUMBER, SINGLES),
    "n": Column(ValueType.NUMBER, PRIMITIVES["int64"]),
    "flag": Column(ValueType.BOOLEAN),
    "mode": Column(ValueType.STRING),
    "scan": Column(ValueType.NUMBERS, SINGLES),
    "ids": Column(ValueType.NUMBERS, PRIMITIVES["int32"]),
    "kinds": Column(ValueType.STRINGS),
    "locked": Column(ValueType.BOOLEANS),
}

RECENT = ["@{v, -2:}", "@{w - v, -3:}[1:]"]
ARRAYS = (
    "min({a}) < {x}",
    "max({a}) >= {x}",
    "any({a} < {x})",
    "count({a} > {x}) >= 2",
    "all({a} < {number})",
    "count({a} > {number}) > {number}",
    "len({a}) > 2",
    "sum({a}) < {x}",
    "min({a}) < {number}",
    "any({a} - @{{scan, -1}} > {x})",
    "any({a} * {number} > 1 / {number})",
    "any({a} > min({a}) + 1)",
    "any(ids == 1 and kinds == mode)",
    "any(flag and not locked or ids[:2] > {x})",
    'any(kinds == "a" or {number} > 2)',
    "sum(ids) > {number}",
)


@dataclass(frozen=True)
class Drawn:
    """A specification, and the rows of a recording in the parts in which they come."""

    text: str
    parts: Sequence[Sequence[Row]]


class Draw:
    """Draws specifications and recordings."""

    def __init__(self, chance: Random) -> None:
        self.chance = chance

    def drawn(self) -> Drawn:
        settings = "_rate_ = 10\n" if self.chance.random() < 0.2 else ""
        settings += "_timeout_ = 1\n" if self.chance.random() < 0.2 else ""
        lines = [self._accepted() for _ in range(self.chance.randint(1, 4))]
        if self.chance.random() < 0.4:
            lines += [self._alike(self.chance.choice(lines)) for _ in range(self.chance.randint(2, 12))]
        text = DECLARATIONS + settings + "".join(f"p{number}: {line}\n" for number, line in enumerate(lines))
        return Drawn(text, self._cut(self._rows()))

    def _accepted(self) -> str:
        """A property that the language has."""
        while True:
            line = self._property()
            if load_text(Source("props.txt", DECLARATIONS + line))[0] is not None:
                return line

    def _alike(self, line: str) -> str:
        """A property of the shape of another, often with other signals and constants."""
        names = dict(zip("vw", self.chance.sample(["v", "w", "f", "pair_x"], 2), strict=True))
        alike = re.sub(r"(?<=[<>=] )[0125]\b(?!\.)", lambda found: self.chance.choice([*"0125", found[0]]), line)
        alike = re.sub(r"\b[vw]\b", lambda found: names[found[0]], alike)
        return alike if load_text(Source("props.txt", DECLARATIONS + alike))[0] is not None else line

    def _property(self) -> str:
        self.is_timed = self.chance.random() < 0.35
        few = self.chance.randint(1, 4) if self.chance.random() < 0.95 else 12
        self.pool = [self._atom() for _ in range(few)]
        if self.is_timed and self.chance.random() < 0.4:
            self.pool.append(self.chance.choice(["new v", "age(w) <= 200 ms", "age(v) > 1 s", "previously v > 1"]))
        if self.chance.random() < 0.15:
            return self._keeping()
        if few == 12:
            return f"always (({' or '.join(self.pool)}) implies eventually {self.pool[0]})"
        return self._temporal(self.chance.randint(1, 3))

    def _keeping(self) -> str:
        """A property that reads values at openings."""
        self.pool += [self._kept() for _ in range(self.chance.randint(1, 2))] * 2
        return self.chance.choice(
            [
                f"after_until {self._event()}, {self._event()}, {self._temporal(1)}",
                f"after_until {self._event()}, {self._event()}, (always {self._kept()})",
                f"after {self._event()}, after_until {self._event()}, {self._event()}, {self._temporal(0)}",
                f"after {self._event()}, {self._temporal(2)}",
                f"(always {self._kept()}) or (eventually {self._kept()})",
            ]
        )

    def _kept(self) -> str:
        at = f"@{{{self.chance.choice(NUMBERS)}, opening}}"
        return self.chance.choice(
            [
                f"{self._number()} <= {at}",
                f"abs({self._number()} - {at}) < {self.chance.choice('012')}",
                f"{self._number()} / {at} > 1",
                f"v == {at}",
                "mode == @{mode, opening}",
                "flag != @{flag, opening}",
                f"any(@{{scan, opening}} > {at})",
                "max(scan) > max(@{scan, opening}[:2])",
            ]
        )

    def _event(self) -> str:
        one, other = self.chance.choice(self.pool), self.chance.choice(self.pool)
        return self.chance.choice([one, one, f"not ({one})", f"({one} and {other})", f"({one} or {other})"])

    def _temporal(self, depth: int) -> str:
        if depth == 0:
            return f"({self.chance.choice(['always', 'eventually', 'never'])} {self._event()})"

        def body() -> str:
            return self._temporal(depth - 1)

        def event() -> str:
            return f"({self._event()})"

        bound = f" within {self.chance.choice([1, 3])} s" if self.is_timed else ""
        forms = [
            lambda: f"(always {self.chance.choice([body, event])()})",
            lambda: f"(never {body()})",
            lambda: f"(eventually {body()})",
            lambda: f"({body()} and {body()})",
            lambda: f"({body()} or {body()})",
            lambda: f"({body()} implies {body()})",
            lambda: f"(not {body()})",
            lambda: f"(after {event()}, {self.chance.choice([body, event])()})",
            lambda: f"(until {event()}, {body()})",
            lambda: f"(after_until {event()}, {event()}, {self.chance.choice([body, event])()})",
            lambda: f"(always (after_until {event()}, {event()}, {body()}))",
            lambda: f"(always ({event()} implies eventually {event()}{bound}))",
        ]
        if self.is_timed:
            forms += [
                lambda: f"(always ({event()} implies once {event()} within 2 s))",
                lambda: f"(never historically {event()} for 2 s)",
                lambda: f"(always ({event()} implies never {event()} within 1 s))",
                lambda: f"(always age({self.chance.choice('vw')}) <= 2 s)",
                lambda: f"(always (new v implies {event()}))",
                lambda: f"(always (age(v) <= 1 s or {event()}))",
                lambda: f"(always (previously {event()} implies {event()}))",
                lambda: f"(always eventually {event()} within 3 s)",
                lambda: f"(within 3 s, {body()})",
                lambda: f"(after_until historically {event()} for 2 s, {event()}, eventually {event()} within 1 s)",
                lambda: f"(after ({event()} since {event()}), {body()})",
            ]
        return self.chance.choice(forms)()

    def _atom(self) -> str:
        kind = self.chance.random()
        if kind < 0.06:
            past = f"@{{{self._number()} > 1 and not flag, -{self.chance.randint(1, 2)}}}"
            return self.chance.choice(["flag", "not flag", "@{flag, -1}", past if "@" not in past[2:] else "flag"])
        if kind < 0.12:
            return self.chance.choice(['mode == "a"', 'mode != "b"', "mode == @{mode, -1}"])
        if kind < 0.25:
            whole = ["scan", "scan[0:2]", "scan[-2:]", "scan[1:]", "scan[:-1]", "@{scan, -2}[:2]"]
            array = self.chance.choice([*whole, *RECENT])
            form, bound = self.chance.choice(ARRAYS), self.chance.choice(["0", "0.5", "1"])
            return form.format(a=array, x=bound, number=self._number())
        relation = self.chance.choice(["<", "<=", ">", ">=", "==", "!="])
        margin = "{0.1}" if relation in ("==", "!=") or self.chance.random() < 0.05 else ""
        return f"{self._number()} {relation}{margin} {self.chance.choice(['0', '1', '2', '0.5', '5', self._number()])}"

    def _number(self) -> str:
        one, other = self.chance.choice(NUMBERS), self.chance.choice(NUMBERS)
        rich = [
            f"@{{{one}, -{self.chance.randint(1, 3)}}}",
            f"@{{{one}, -{self.chance.randint(1, 3)} else 1}}",
            f"@{{{one} - {other} / 2, -{self.chance.randint(1, 2)}}}",
            f"@{{{one}, when {self.chance.choice([f'new {other}', f'{other} > 1', f'not {other} < 2 and flag'])}}}",
            f"{one} + {other}",
            f"abs({one})",
            f"{one} / {other}",
            f"1 / min({one}, {other})",
            f"max({one}, {other}, 1)",
            f"sqrt({one})",
            f"{one} * 2 - 1",
        ]
        return self.chance.choice([one, one, one, self.chance.choice(rich)])

    def _rows(self) -> list[Row]:
        count = self.chance.choice([1, 7, 8, 9, 30, 65, 200, 500])
        names = ["v", "w", "pair", "f", "n", "flag", "mode", "scan", "marks", "robot.velocity", "robot.position.x"]
        shares = {name: self.chance.choice([0.2, 0.5, 1, 1, 1]) for name in names}
        self.nan = self.chance.choice([0, 0, 0, 0.02, 0.3])
        self.smooth = self.chance.choice([0, 0.5, 0.9, 0.98])
        if self.chance.random() < 0.4:
            shares = dict.fromkeys(names, 1)
        time, rows = self.chance.choice([0, 17 * 10**17]), []
        held: dict[str, Any] = {}
        for _ in range(count):
            time += self.chance.choice([0, 1, 10**7, 10**8, 10**8, 3 * 10**9])
            values: dict[str, Any] = {}
            for name in names:
                if self.chance.random() < shares[name]:
                    values |= self._sample(name, held)
            rows.append(Row(time, values))
        return rows

    def _sample(self, name: str, held: dict[str, Any]) -> dict[str, Any]:
        parts = PARTS.get(name, (name,))
        for part in parts:
            if part not in held or self.chance.random() >= self.smooth:
                held[part] = self._value(part)
        if name == "marks":
            shortest = min(len(held[part]) for part in parts)
            held |= {part: held[part][:shortest] for part in parts}
        return {part: held[part] for part in parts}

    def _value(self, name: str) -> Any:
        match name:
            case "flag":
                return self.chance.random() < 0.5
            case "mode":
                return self.chance.choice("abc")
            case "scan":
                return tuple(self._double() for _ in range(self.chance.choice([0, 1, 3, 3])))
            case "ids" | "kinds" | "locked":
                of = {"ids": (0, 1, 2), "kinds": "abc", "locked": (False, True)}[name]
                return tuple(self.chance.choice(of) for _ in range(self.chance.choice([0, 1, 3, 3])))
            case "n":
                return self.chance.choice([0, 1, 2, -1, 5, 5, 2**53 + 1 if self.chance.random() < 0.1 else 3])
            case _:
                return self._double()

    def _double(self) -> float:
        if self.chance.random() < self.nan:
            return math.nan
        special = [math.inf, -math.inf, -0.0] if self.chance.random() < 0.1 else [0.0]
        return self.chance.choice([*special, 0.0, 1.0, 2.0, 0.5, 3.0, -1.0, 0.625, 5.0, 3.5, 4.0])

    def _cut(self, rows: list[Row]) -> list[list[Row]]:
        ends = sorted(self.chance.randint(0, len(rows)) for _ in range(self.chance.choice([0, 0, 1, 3])))
        return [rows[a:b] for a, b in zip([0, *ends], [*ends, len(rows)], strict=True)]


def signals_of(compiled: Sequence[Any]) -> dict[str, Signal]:
    return lacks.signals_of(c.specification for c in compiled)


def blocks(parts: Sequence[Sequence[Row]], names: Sequence[str]) -> list[Block]:
    kinds = {name: KINDS.get(name, Column(ValueType.NUMBER)) for name in names}
    return [block for part in parts for block in blocks_of(part, kinds)]


@contextmanager
def sizes(chance: Random) -> Iterator[None]:
    """Parts so small that short recordings have many, for a while."""
    small = {
        (arrays, "MOST_ELEMENTS"): [1, 5, 1 << 18],
        (tables, "SHORT"): [0, 3, 2000],
        (follow, "SHORT"): [0, 3, 2000],
        (follow, "TOGETHER"): [0, 2, 32],
        (leaps, "GUESSES"): [1, 2, 8],
        (bits, "BATCH"): [1, 50, 1 << 20],
        (thresholds, "PIECE"): [8, 64, 1 << 16],
        (thresholds, "PIECES"): [1, 2, 8],
        (thresholds, "APART"): [1, 3, 4091],
        (thresholds, "MANY"): [0, 2, 8],
        (thresholds, "SMALL"): [8, 16, 128],
        (thresholds, "MOST"): [1, 4, 1000],
        (thresholds, "WIDER"): [1, 4],
        (thresholds, "AT_ONCE"): [8, 64, 1 << 16],
        (bits, "FEW"): [1, 4, 32],
        (kept, "FIRST"): [1, 3, 64],
        (columns_session, "FIRST"): [1, 8, 256],
    }
    before = {place: getattr(*place) for place in small}
    for place, choices in small.items():
        setattr(*place, chance.choice(choices))
    yield
    for place, value in before.items():
        setattr(*place, value)


def judged(drawn: Drawn, observe: Callable[[], Observer] | None = None) -> tuple[Session, ByBlocks]:
    """Row by row, and by columns."""
    compiled, specification = from_text(drawn.text)
    given = {name for part in drawn.parts for row in part for name in row.values} | set(KINDS) | {"v", "w"}
    given -= set(PARTS) - {"robot.position.x"}
    plan = load_plan(compiled, specification, given)
    again = restarting(compiled)
    by_label = {each.label: each for each in load_plan(again, specification, given).properties}
    prepared = zip(again, prepare_all(again, specification.source), strict=True)
    prepared_again = {each.specification.label: of for each, of in prepared}

    def track(property_: MonitoredProperty, keep: bool, observer: Observer | None) -> Track:
        found = by_label.get(property_.label)
        return JudgedTrack(property_, keep, observer, property_.slicing is None, again=found)

    reference = ByRows(Session(plan, observe=observe, make=track))
    of = prepare_all(compiled, specification.source)
    fast = ByBlocks(Session(plan, observe=observe, make=track), of, prepared_again)
    wanted = [s.name for s in plan.signals if s.name in given]
    found = blocks(drawn.parts, wanted)
    for block in found:
        for time, names, values, topics in block.rows(set(wanted)):
            reference.samples(time, names, values, topics)
        fast.take(block)
    for session in (reference.session, fast.session):
        if session.time is not None:
            ByRows(session).advance(session.time + 5 * 10**8)
            for each in session.tracks:
                each.hold(session.time)
    return reference.session, fast


def trails(session: Session) -> list[str]:
    """What each property of a session went through."""
    return [repr(t.observer.trail) for t in session.tracks if isinstance(t.observer, Trailing)]


def state(session: Session) -> list[Any]:
    """All that a session knows and reports."""
    figures = [reports.figure(session, track) for track in session.tracks if track.verdict is Verdict.VIOLATED]
    sampler = session.sampler
    samples = {
        name: (list(map(repr, each.values(sampler.known))), list(each.times(sampler.known)))
        for name, each in sampler.samples.items()
    }
    known = [
        (
            repr(track.decided_at),
            track.open_since,
            dict(track.invalid_because),
            _kept(track),
            repr(list(track.judged_on)),
            [_episodes(one) for one in track.scopes],
            track.deadline(),
        )
        for track in session.tracks
    ]
    return [
        repr(documents.document("", session)),
        reports.summary(session),
        figures,
        samples,
        known,
        session.messages,
        session.unseen,
        session.time,
        session.is_over,
        session.sampler.not_measured,
        [repr(all_violations(track)) for track in session.tracks],
    ]


def _kept(track: Track) -> dict[str, Any]:
    """What a monitor has; once it has decided, rows go on counting, and columns do not."""
    hidden = ("_",) if track.decided_at is None else ("_", "due_")
    return {name: getattr(track.monitor, name) for name in track.monitor.__slots__ if not name.startswith(hidden)}


def _episodes(one: Episodes) -> Any:
    return one.count, one.is_open, one.opened, _inner(one)


def _inner(one: Episodes) -> list[Any]:
    return [(inner.is_open, inner.opened, _inner(inner)) for inner in one.inner]
