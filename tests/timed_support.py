"""Timed properties over boolean signals, made by hand, and runs of them, judged by the denotation on instants."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from hypothesis import assume
from hypothesis import strategies as st

from ltlc.automata import translate
from ltlc.compiler import Compiled
from ltlc.semantics import ltl
from ltlc.semantics import properties as p
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.denotation import satisfies
from ltlc.semantics.encodings import EPISODE, ManyClocksError, encode
from ltlc.semantics.instants import Instant, Step, instants, with_past
from ltlc.semantics.ltl import Atom, Formula
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.properties import Property
from ltlc.semantics.timed_atoms import (
    Age,
    Historically,
    News,
    Once,
    PastAtom,
    Previously,
    Since,
    TimedAtom,
    atoms_within,
)
from ltlc.semantics.timed_run import TimedRun
from ltlc.semantics.trackers import trackers_of
from ltlc.semantics.verdicts import Verdict
from ltlc.source import Source, Span
from ltlc.specification.atoms import Atom as Condition
from ltlc.specification.atoms import IsTrue
from ltlc.specification.expressions import Current, Field, New, Signal, ValueType
from ltlc.specification.specification import PropertySpecification, Specification

X, Y, Z = Atom("x"), Atom("y"), Atom("z")
NEWS = (News("new n"), News("new x"))
LONG = 40
"""After so many ns nothing changes any more by itself in properties that are drawn here."""
MOST_CLOCKS = 2
"""More make monitors that take seconds to build."""


def signal(name: str) -> Signal:
    return Signal(name, ValueType.BOOLEAN, Field(f"/{name}", "std_msgs/msg/Bool", ("data",)))


def compiled(property_: Property, label: str = "p") -> Compiled:
    """`property_` as if it had been written: what is called `new s` is the news of s, else an atom is a signal."""
    formula = encode(property_, EPISODE)
    read = [a.name for a in atoms_within(formula) if isinstance(a, News) or not isinstance(a, TimedAtom)]
    ordinary = Alphabet(tuple(name for name in read if not name.startswith("new ")))
    conditions = {name: New(signal(name[4:])) if name.startswith("new ") else Current(signal(name)) for name in read}
    atoms = tuple(Condition(name, IsTrue(value), Span(0, 0)) for name, value in conditions.items())
    written = PropertySpecification(label, 1, Span(0, 0), "text", property_, atoms, ordinary, {})
    return Compiled(written, EPISODE, formula, translate(formula, ordinary))


def specification(of: Sequence[Compiled], rate: float | None = None) -> Specification:
    return Specification(Source("props.txt", ""), tuple(c.specification for c in of), (), rate)


@dataclass(frozen=True)
class Row:
    """What came in at a time, in ns: values by the names of signals, each on its own topic."""

    time: int
    values: Mapping[str, bool]


def rows() -> st.SearchStrategy[list[Row]]:
    """Rows some of which come at the same time; `w` is read by no property."""
    cells = st.dictionaries(st.sampled_from("xyznw"), st.booleans(), max_size=5)
    one = st.tuples(st.sampled_from([0, 1, 1, 2, 3, 5]), cells)

    def timed(drawn: list[tuple[int, dict[str, bool]]]) -> list[Row]:
        time, found = 10, []
        for gap, values in drawn:
            time += gap
            found.append(Row(time, values))
        return found

    return st.lists(one, min_size=1, max_size=7).map(timed)


_HOLDS = {
    Verdict.NOT_STARTED: None,
    Verdict.VIOLATED: False,
    Verdict.PRESUMABLY_VIOLATED: False,
    Verdict.PRESUMABLY_SATISFIED: True,
    Verdict.SATISFIED: True,
}


@dataclass
class Judge:
    """What a run of one property is by the language: its steps, one after the other, and what holds at a time."""

    property: Property
    formula: Formula = field(init=False)
    session: int | None = None
    steps: list[Step] = field(default_factory=list)
    values: dict[str, bool] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.formula = encode(self.property, EPISODE)
        found = list(atoms_within(self.formula))
        self.past: list[PastAtom] = [a for a in found if isinstance(a, Previously | Once | Historically | Since | Age)]
        self.news = [a for a in found if isinstance(a, News)]
        self.read = {a.name for a in found if not isinstance(a, TimedAtom)}

    def take(self, time: int, values: Mapping[str, bool], new: Iterable[str], is_step: bool = True) -> None:
        """`values` came in, and messages of the signals `new`: a step if `is_step`, once all that is read is known."""
        begins = self.session is None
        self.session = time if self.session is None else self.session
        self.values.update(values)
        heard = {f"new {name}" for name in new} & {news.name for news in self.news}
        wanted = bool(self.read & values.keys()) or bool(heard) or (begins and not self.read)
        if is_step and wanted and self.read <= self.values.keys():
            self.steps.append(Step(time, frozenset(n for n in self.read if self.values[n]) | heard))

    def holds(self, time: int) -> bool | None:
        """Whether the property holds on what has been seen up to `time`; None before its first step."""
        return satisfies(self.word(time), self.property) if self.steps else None

    def agrees(self, verdict: Verdict, time: int) -> bool:
        """Whether `verdict` on what has been seen up to `time` is right: if it is permanent, however time goes on."""
        return _HOLDS[verdict] == self.holds(time + LONG if verdict.is_permanent else time)

    def verdict(self, monitor: Monitor, time: int) -> Verdict:
        """The verdict of the reference: `monitor`, which reads timed atoms, along a timed run."""
        run = TimedRun(trackers_of(self.formula), self.news, self.session)
        state = 0
        for step in self.steps:
            for letter in run.step(*step):
                state = monitor.step(state, letter)
        for letter in run.hold(time):
            state = monitor.step(state, letter)
        return monitor.verdicts[state] if self.steps else Verdict.NOT_STARTED

    def word(self, time: int) -> tuple[Instant, ...]:
        return with_past(instants(self.steps, time, self.news), self.past, self.session)


def is_buildable(property_: Property) -> bool:
    """Whether one clock is enough at each bound, and there are few of them."""
    try:
        trackers = trackers_of(encode(property_, EPISODE))
    except ManyClocksError:
        return False
    return bool(trackers) and sum(bool(tracker.bounds) for tracker in trackers) <= MOST_CLOCKS


@st.composite
def timed_properties(draw: st.DrawFn) -> Property:
    """Properties with bounds, past operators, ages and news of the kinds that the language has."""
    past = [draw(_past_atoms(f"o{number}")) for number in range(draw(st.integers(0, 2)))]
    found = draw(_timed(draw(st.integers(0, 2)), st.sampled_from([*_PREDICATES, *past, *past, *NEWS])))
    assume(is_buildable(found))
    return found


_PREDICATES: list[Formula] = [X, Y, Z, ltl.Not(X), ltl.And(X, ltl.Not(Z)), ltl.Or(Y, Z)]
_DURATIONS = st.integers(1, 4)


@st.composite
def _past_atoms(draw: st.DrawFn, name: str) -> Formula:
    operand = st.sampled_from([*_PREDICATES, *NEWS])
    bound = st.none() | _DURATIONS
    match draw(st.integers(0, 4)):
        case 0:
            return Previously(name, draw(operand))
        case 1:
            return Once(name, draw(operand), draw(bound))
        case 2:
            return Historically(name, draw(operand), draw(bound))
        case 3:
            return Since(name, draw(operand), draw(operand), draw(bound))
    return Age(name, NEWS[0], draw(_DURATIONS))


def _untimed(predicates: st.SearchStrategy[Formula]) -> st.SearchStrategy[Property]:
    leaves = st.builds(p.Now, predicates) | st.builds(p.Throughout, predicates)
    return st.recursive(
        leaves,
        lambda inner: st.one_of(
            st.builds(p.Always, inner),
            st.builds(p.Eventually, inner),
            st.builds(p.Never, inner),
            st.builds(p.After, predicates, inner),
            st.builds(p.AfterUntil, predicates, predicates, inner),
        ),
        max_leaves=2,
    )


@st.composite
def _timed(draw: st.DrawFn, depth: int, predicates: st.SearchStrategy[Formula]) -> Property:
    def event() -> Formula:
        return draw(predicates)

    def bounded(kind: type[p.Eventually | p.Never | p.Always]) -> Property:
        return p.Within(draw(_DURATIONS), kind(p.Now(event())))

    if depth:
        inner = _timed(depth - 1, predicates)
        kinds = (p.After, p.Until, p.AfterUntil, p.Not, p.And, p.Or, p.Implies, p.Within)
        match draw(st.sampled_from(kinds)):
            case p.After | p.Until as scope:
                return scope(event(), draw(inner))
            case p.AfterUntil:
                return p.AfterUntil(event(), event(), draw(inner))
            case p.Not:
                return p.Not(draw(inner))
            case p.Within:
                return p.Within(draw(_DURATIONS), draw(inner))
            case both:
                return both(draw(inner), draw(inner))
    match draw(st.integers(0, 4)):
        case 0:
            return p.Within(draw(_DURATIONS), draw(_untimed(predicates)))
        case 1:
            return p.Always(p.Implies(p.Now(event()), bounded(p.Eventually)))
        case 2:
            return p.Always(bounded(p.Eventually))
        case 3:
            return p.Always(p.Implies(p.Now(event()), p.And(bounded(p.Never), bounded(p.Always))))
    return draw(_untimed(predicates))
