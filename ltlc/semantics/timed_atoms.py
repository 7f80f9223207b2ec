"""Atoms that time and the past decide: which of them hold at an instant follows from the letters and times so far.

Core LTL and all that is made of it see ordinary atoms. What these mean is said twice: at an instant of a run here, by
definition, and as the next step of a tracker in `trackers`, which is what monitors use.

Encodings, automata and verdicts are used as they are, and no size depends on a duration. Which words of letters are
runs in time, with fairness, the reset machine says (`reset_machine`); it takes the place that the alphabet has for
ordinary atoms: automata are multiplied with it, certificates speak of places (its state, and what remains), and the
checker computes it anew from the formula. It does not know how much time is left on a clock; that an outcome is
possible all the same is shown by strategies (`plays` checks them).

The clock of an age is asked, not set: whoever runs a monitor keeps the time of the last message, whatever made a step
of it. That a message comes is an atom of the formula, `message on s`, and of the certificate, but none that code
reads: where an age was late and is no more, one has come.

A count has no tracker, since a state for each number would be many: to automata and certificates it is an atom that may
change at any instant. Verdicts are right so, and may be later than they could be where only counting tells more.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ltlc.dataclass import dataclass
from ltlc.semantics.durations import Nanoseconds, duration_text
from ltlc.semantics.ltl import Atom, Formula, subformulas, to_text


@dataclass(frozen=True, slots=True)
class News(Atom):
    """`new s`: a message on the topic of s arrived at this very instant; the held instants after it have no news."""


@dataclass(frozen=True, slots=True)
class Previously(Atom):
    """`previously p`: `operand` held at the instant before; false at the first one."""

    operand: Formula


@dataclass(frozen=True, slots=True)
class Once(Atom):
    """`once p`: `operand` held at some instant so far, with `within` at some instant of that last duration."""

    operand: Formula
    within: Nanoseconds | None = None


@dataclass(frozen=True, slots=True)
class Historically(Atom):
    """`historically p`: `operand` held at every instant so far.

    With `lasting`: it has held without a break since some instant at least that long ago.
    """

    operand: Formula
    lasting: Nanoseconds | None = None


@dataclass(frozen=True, slots=True)
class Since(Atom):
    """`p since q`: `start` held at some instant so far, `kept` at every one after it, this one included.

    With `within`, the instant at which `start` held is one of that last duration.
    """

    kept: Formula
    start: Formula
    within: Nanoseconds | None = None


@dataclass(frozen=True, slots=True)
class Age(Atom):
    """`age(s) <= D`: the time since the last message on the topic of s is at most `most`.

    Before the first message, it is the time since the session began. `news` is that a message comes, at a step or at an
    instant between steps; it is not `new s`, which holds at steps only. `age(s) < D` is `age(s) <= D - 1 ns`, since
    times are integers.
    """

    news: News
    most: Nanoseconds


@dataclass(frozen=True, slots=True)
class Occurred(Atom):
    """`operand` occurred `times` times so far or, with `within`, in that last duration, this instant included.

    With `begins`, it occurs where it holds and did not at the instant before, the first one included; else at every
    instant at which it holds. It has no atom of time or of the past in it but news, without any of which it does not
    hold, or which does not decide it; so it occurs at steps only. What is `presumed` holds, too, as long as no more
    than `within` has passed since the first instant.
    """

    operand: Formula
    times: int
    within: Nanoseconds | None
    begins: bool
    presumed: bool = False


PastAtom = Previously | Once | Historically | Since | Age | Occurred
"""An atom that the run so far decides."""


class Clock:
    """What the property counts time from; equal clocks start and stop at the same instants, and have the same text."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class Beginning(Clock):
    """Time since the first instant of the run."""

    def __str__(self) -> str:
        return "the beginning"


BEGINNING = Beginning()


def _inside(outer: Clock) -> str:
    """The scopes that a clock belongs to, in its text: the same events may stand in several."""
    return "" if outer == BEGINNING else f", {outer}"


@dataclass(frozen=True, slots=True)
class AfterOpened(Clock):
    """Time since the scope of `after event, …` opened within `outer`."""

    outer: Clock
    event: Formula

    def __str__(self) -> str:
        return f"after {to_text(self.event)}{_inside(self.outer)}"


@dataclass(frozen=True, slots=True)
class UntilScope(Clock):
    """Time since `outer` opened, as long as `event` has not come: the scope of `until event, …`."""

    outer: Clock
    event: Formula

    def __str__(self) -> str:
        return f"until {to_text(self.event)}{_inside(self.outer)}"


@dataclass(frozen=True, slots=True)
class EpisodeOpened(Clock):
    """Time since the last episode of `after_until opening, closing, …` within `outer` opened."""

    outer: Clock
    opening: Formula
    closing: Formula

    def __str__(self) -> str:
        return f"after {to_text(self.opening)} until {to_text(self.closing)}{_inside(self.outer)}"


@dataclass(frozen=True, slots=True)
class FirstOpen(Clock):
    """Time since the first `trigger` that no `goal` has answered yet, in the scope `outer`."""

    outer: Clock
    trigger: Formula
    goal: Formula

    def __str__(self) -> str:
        return f"the first {to_text(self.trigger)} without {to_text(self.goal)}{_inside(self.outer)}"


@dataclass(frozen=True, slots=True)
class LastTrigger(Clock):
    """Time since the last instant with `trigger` in the scope `outer`."""

    outer: Clock
    trigger: Formula

    def __str__(self) -> str:
        return f"the last {to_text(self.trigger)}{_inside(self.outer)}"


@dataclass(frozen=True, slots=True)
class Late(Atom):
    """`clock` runs, and more than `bound` has passed on it."""

    clock: Clock
    bound: Nanoseconds


def late(clock: Clock, bound: Nanoseconds) -> Late:
    """The atom that `clock` is past `bound`."""
    return Late(f"more than {duration_text(bound)} since {clock}", clock, bound)


TimedAtom = News | Previously | Once | Historically | Since | Age | Occurred | Late


def operands(atom: Atom) -> tuple[Formula, ...]:
    """The state predicates that `atom` is decided by, as monitors see it; of an ordinary atom and a count, none."""
    match atom:
        case Previously(_, operand) | Once(_, operand, _) | Historically(_, operand, _):
            return (operand,)
        case Since(_, kept, start, _):
            return (kept, start)
        case Age(_, news, _):
            return (news,)
        case Late(_, clock, _):
            return clock_operands(clock)
        case _:
            return ()


def clock_operands(clock: Clock) -> tuple[Formula, ...]:
    """The state predicates that start and stop `clock`, those of the scopes around it first."""
    match clock:
        case AfterOpened(outer, event) | UntilScope(outer, event):
            return (*clock_operands(outer), event)
        case EpisodeOpened(outer, opening, closing):
            return (*clock_operands(outer), opening, closing)
        case FirstOpen(outer, trigger, goal):
            return (*clock_operands(outer), trigger, goal)
        case LastTrigger(outer, trigger):
            return (*clock_operands(outer), trigger)
        case _:
            return ()


def duration_of(atom: TimedAtom) -> Nanoseconds | None:
    """The duration in the definition of `atom`, if it has one."""
    match atom:
        case Once(within=duration) | Since(within=duration) | Historically(lasting=duration) | Age(most=duration):
            return duration
        case Occurred(within=duration):
            return duration
        case Late(bound=duration):
            return duration
        case _:
            return None


def timed_atoms(formula: Formula) -> tuple[TimedAtom, ...]:
    """The timed atoms among `atoms_within` `formula`."""
    return tuple(atom for atom in atoms_within(formula) if isinstance(atom, TimedAtom))


def counts_of(formula: Formula) -> tuple[Occurred, ...]:
    """What `formula` counts."""
    return tuple(atom for atom in atoms_within(formula) if isinstance(atom, Occurred))


def names_within(formula: Formula) -> frozenset[str]:
    """The names of the atoms within `formula`, and of those within what it counts."""
    counted = (each.operand for each in counts_of(formula))
    return frozenset(atom.name for part in (formula, *counted) for atom in atoms_within(part))


def news_of(formula: Formula) -> tuple[News, ...]:
    """What `formula` takes note of at the instant of its arrival."""
    return tuple(atom for atom in atoms_within(formula) if isinstance(atom, News))


def news_that_counts(formula: Formula) -> tuple[News, ...]:
    """The news of `formula`, and that of what it counts."""
    parts = (formula, *(count.operand for count in counts_of(formula)))
    return tuple(dict.fromkeys(news for part in parts for news in news_of(part)))


def messages_of(atoms: Iterable[object]) -> frozenset[str]:
    """The news, by name, from which ages among `atoms` count: nothing else reads it."""
    return frozenset(atom.news.name for atom in atoms if isinstance(atom, Age))


def atoms_within(formula: Formula) -> Iterator[Atom]:
    """Every atom that decides `formula`, those that decide an atom before it, each once."""
    seen: dict[str, None] = {}

    def visit(current: Formula) -> Iterator[Atom]:
        for part in subformulas(current):
            if isinstance(part, Atom) and part.name not in seen:
                for operand in operands(part):
                    yield from visit(operand)
                if part.name not in seen:
                    seen[part.name] = None
                    yield part

    return visit(formula)
