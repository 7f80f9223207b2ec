"""Small mistakes about time, and whether one changes a verdict of some run: decided nanosecond by nanosecond."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator
from dataclasses import field, replace
from typing import Any, NamedTuple, Protocol

from exact_time import RunsOf, Situation
from test_backends_time import NEVER, PRELUDE

from ltlc.assurance.programs import load
from ltlc.backends.names import variable
from ltlc.backends.python.functions import function_texts
from ltlc.backends.python.monitors import runtime_class, standalone_class, told
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.semantics.ltl import FALSE, TRUE, Formula, Not
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.timed_atoms import (
    BEGINNING,
    AfterOpened,
    Age,
    Clock,
    EpisodeOpened,
    FirstOpen,
    Historically,
    LastTrigger,
    Once,
    Previously,
    Since,
    UntilScope,
)
from ltlc.semantics.trackers import (
    CLOSED,
    Case,
    Phase,
    Scope,
    State,
    Tracker,
    outer_clock,
    trackers_of,
)
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Letter
from ltlc.specification.expressions import inputs, operands

Trackers = tuple[Tracker, ...]

MOST_ASKED = 50_000
"""How often a mistaken tracker is asked at most; one whose clocks come to rest is asked 15,000 times or less."""


@dataclass(frozen=True, slots=True)
class Mistaken(Tracker):
    """A tracker of which one case, the one with this number after a phase, does something else."""

    phase: Phase = Phase.IDLE
    number: int = 0
    change: Callable[[Case], Case] = lambda case: case
    asked: list[None] = field(default_factory=list, compare=False)

    def step(self, state: State, around: Scope, letter: Letter, passed: int) -> tuple[Case, Letter]:
        """Raises ValueError where the mistake makes a clock ring for ever."""
        self.asked.append(None)
        if len(self.asked) > MOST_ASKED:
            raise ValueError("a clock rings again and again")
        return Tracker.step(self, state, around, letter, passed)

    def cases(self, state: State, around: Scope) -> list[Case]:
        found = Tracker.cases(self, state, around)
        if state.phase is self.phase and self.number < len(found):
            found[self.number] = self.change(found[self.number])
        return found


def clock_mutants(formula: Formula) -> Iterator[Trackers]:
    """The trackers of `formula` with one mistake: a bound, an event, a reset, what is counted from, or what holds."""
    right = trackers_of(formula)
    for k, tracker in enumerate(right):
        if tracker.subject == BEGINNING and not tracker.bounds:
            continue  # A run that begins anew only makes verdicts late, which the certificate is there to notice.
        for other in (*_other_bounds(tracker), *_other_subjects(tracker), *_other_cases(tracker)):
            inner = (_within(other.subject, tracker.subject, each) for each in right[k + 1 :])
            mutant = (*right[:k], other, *inner)
            if len({each.subject for each in mutant}) == len(mutant):
                yield mutant


def _within(scope: Any, instead_of: Any, tracker: Tracker) -> Tracker:
    """`tracker`, whose clock belongs to `scope` if it belonged to another."""
    subject: Any = tracker.subject
    return tracker if outer_clock(subject) != instead_of else replace(tracker, subject=replace(subject, outer=scope))


def _other_bounds(tracker: Tracker) -> Iterator[Tracker]:
    """What is closed taken for open, and the other way: times are integers."""
    for k, bound in enumerate(tracker.bounds):
        for other in (bound - 1, bound + 1):
            changed = (*tracker.bounds[:k], other, *tracker.bounds[k + 1 :])
            if other >= 0 and sorted(set(changed)) == list(changed):
                yield replace(tracker, bounds=changed)


def _other_subjects(tracker: Tracker) -> Iterator[Tracker]:
    return (replace(tracker, subject=subject) for subject in _subjects(tracker.subject) if subject != tracker.subject)


def _subjects(subject: Previously | Once | Historically | Since | Age | Clock) -> tuple[Any, ...]:
    """The earliest for the latest and the latest for the earliest; an event left out, or another one."""
    match subject:
        case Previously(name, p):
            return (Previously(name, Not(p)), Once(name, p))
        case Once(name, p, bound):
            return (Once(name, Not(p), bound), Historically(name, p, bound))
        case Historically(name, p, bound):
            return (Historically(name, Not(p), bound), Once(name, p, bound))
        case Since(name, p, q, bound):
            return (Since(name, TRUE, q, bound), Since(name, p, p, bound), Since(name, q, p, bound))
        case FirstOpen(outer, p, q):
            return (FirstOpen(outer, p, FALSE), FirstOpen(outer, TRUE, q), LastTrigger(outer, p))
        case LastTrigger(outer, p):
            return (FirstOpen(outer, p, FALSE), FirstOpen(outer, p, Not(p)), LastTrigger(outer, TRUE))
        case AfterOpened(outer, p) if outer == BEGINNING:
            return (AfterOpened(outer, TRUE), AfterOpened(outer, Not(p)))
        case EpisodeOpened(outer, p, q) if outer == BEGINNING:
            return (AfterOpened(outer, p), EpisodeOpened(outer, p, FALSE), EpisodeOpened(outer, TRUE, q))
        case UntilScope(outer, p) if outer == BEGINNING:
            return (UntilScope(outer, FALSE), UntilScope(outer, Not(p)))
    return ()


def _other_cases(tracker: Tracker) -> Iterator[Tracker]:
    """Each case of each phase that the tracker can be in, with a reset left out or added, or another state after it.

    But no bound that has passed is yet to pass: such a clock would expire at one time again and again.
    """
    found = {(phase, number): case for phase, number, case in _possible(tracker)}
    states = dict.fromkeys(case.state for case in found.values())
    for (phase, number), case in found.items():
        others = (state for state in states if state != case.state and state.passed >= (case.passed or 0))
        for change in (_reset, *map(_goes_to, others)):
            yield Mistaken(tracker.subject, tracker.atoms, tracker.bounds, phase, number, change)


def _possible(tracker: Tracker) -> Iterator[tuple[Phase, int, Case]]:
    states = [tracker.initial]
    for state in states:  # grows
        for around in (Scope(True, True), Scope(True, False), CLOSED):
            for number, case in enumerate(tracker.cases(state, around)):
                yield state.phase, number, case
                if case.state not in states:
                    states.append(case.state)


def _reset(case: Case) -> Case:
    return case._replace(starts=not case.starts)


def _goes_to(state: State) -> Callable[[Case], Case]:
    return lambda case: case._replace(state=state)


class Machine(Protocol):
    """What gives verdicts on runs, an instant at each nanosecond; a node is all that it remembers."""

    def first(self, signals: Letter, age: int) -> Hashable:
        """After the first step, in a session that began `age` ns before."""

    def next(self, node: Any, signals: Letter | None) -> Hashable:
        """After a step at once, or (None) after a nanosecond with the letter held."""

    def verdict(self, node: Any) -> Verdict:
        """The verdict there."""


class Judged(NamedTuple):
    """A machine: `monitor` reads what the trackers of `runs` say."""

    runs: RunsOf
    monitor: Monitor

    def first(self, signals: Letter, age: int) -> tuple[Situation, int]:
        letter, situation = self.runs.first(signals, age)
        return situation, self.monitor.step(0, letter)

    def next(self, node: tuple[Situation, int], signals: Letter | None) -> tuple[Situation, int]:
        situation, state = node
        letter, after = self.runs.after(situation, signals)
        return after, self.monitor.step(state, letter)

    def verdict(self, node: tuple[Situation, int]) -> Verdict:
        return self.monitor.verdicts[node[1]]


def progressing(make: Any) -> Any:
    """`make`, whose objects raise RuntimeError where a clock step brings no progress, and would be taken for ever."""

    class Progressing(make):  # type: ignore[misc]
        def expire(self) -> None:
            before = self.due
            super().expire()
            if self.due <= before:
                raise RuntimeError("a clock step after which the same is due")

    return Progressing


MOST = 10**5
"""More pairs of nodes are not looked at."""

AGES = range(6)
"""How many nanoseconds the session is older than the run."""

FAR = 50
"""From there on no number of nanoseconds matters in what is explored."""


class Emitted:
    """A machine: an emitted class with the attributes of its objects, the times among them as they are from now."""

    def __init__(self, make: Any, inputs: Iterable[str]) -> None:
        self._make = progressing(make)
        self._inputs = tuple(inputs)
        self._now = 1 << 40

    def first(self, signals: Letter, age: int) -> Hashable:
        return self._stepped(self._make(self._now - age), signals)

    def next(self, node: Any, signals: Letter | None) -> Hashable:
        attributes, held = node
        made = object.__new__(self._make)
        for name, at in attributes:
            setattr(made, name, self._now + at if name.startswith("due") else at)
        if signals is not None:
            return self._stepped(made, signals)
        while self._now + 1 > made.due:
            made.expire()
        return self._node(made, self._now + 1, held)

    def verdict(self, node: Any) -> Verdict:
        found: Verdict = dict(node[0])["verdict"]
        return found

    def _stepped(self, made: Any, signals: Letter) -> Hashable:
        made.step(self._now, *(name in signals for name in self._inputs))
        return self._node(made, self._now, signals)

    def _node(self, made: Any, now: int, held: Letter) -> Hashable:
        def kept(name: str, value: Any) -> Any:
            if not name.startswith("due"):
                return value
            return NEVER - self._now if value - now > FAR else max(-FAR, value - now)

        attributes = ((name, getattr(made, name)) for name in made.__slots__ if hasattr(made, name))
        return tuple((name, kept(name, value)) for name, value in attributes), held


def differ(one: Machine, other: Machine, letters: Iterable[Letter]) -> bool:
    """Whether some run gets another verdict; what raises an exception gives none."""
    letters = list(letters)
    seen: set[Any] = set()
    try:
        todo: list[Any] = [(one.first(s, age), other.first(s, age)) for s in letters for age in AGES]
        while todo:
            pair = todo.pop()
            if pair in seen:
                continue
            seen.add(pair)
            assert len(seen) < MOST
            if one.verdict(pair[0]) is not other.verdict(pair[1]):
                return True
            todo += [(one.next(pair[0], s), other.next(pair[1], s)) for s in (*letters, None)]
    except (AttributeError, NameError, RuntimeError, TypeError, ValueError):
        return True
    return False


def clocks_differ(made: Compiled, trackers: Trackers) -> bool:
    """Whether the monitor of `made`, which is right, gives another verdict on some run with these trackers."""
    right, other = RunsOf(made.formula, MOST), RunsOf(made.formula, MOST, trackers)
    return differ(Judged(right, made.monitor), Judged(other, made.monitor), right.letters)


def code_differs(made: Compiled, text: str) -> bool:
    """Whether the emitted class of `made`, changed to `text`, gives another verdict than its monitor on some run."""
    right = RunsOf(made.formula, MOST)
    of = {a.name: told(i) for a in made.specification.atoms for e in operands(a.condition) for i in inputs(e)}
    parameters = [told(i) for i in made.specification.inputs()]
    names = {s: [name for name, of_ in of.items() if of_ == s] for s in parameters}
    letters = [each for each in right.letters if all(each.isdisjoint(n) or each.issuperset(n) for n in names.values())]
    return differ(Judged(right, made.monitor), Emitted(emitted_class(text), [names[s][0] for s in parameters]), letters)


def class_text(made: Compiled) -> str:
    """The class that is emitted for `made`, with what it needs around it; where there are ages, that which hears."""
    signals = {told(i): variable(told(i).name) for i in made.specification.inputs()}
    is_aged = any(clock.age for clock in made.machine.clocks)
    name = "Emitted", "props.txt"
    text = (standalone_class(made, *name, signals) if is_aged else runtime_class(made, *name)).text
    return PRELUDE + "\n".join(function_texts(text)) + "\n" + text


def emitted_class(text: str) -> Any:
    """The class in `text`."""
    return load(text, "emitted")["Emitted"]
