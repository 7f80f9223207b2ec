"""What a monitor has to remember at each place, by definition: state and verdict, due times, samples, kept values."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, NamedTuple

from ltlc.assurance.reading.clocks import counts, due_after, due_at_first, is_age
from ltlc.assurance.reading.execution import remembered
from ltlc.assurance.reading.language import (
    NEVER,
    Apply,
    Attribute,
    Constant,
    Moment,
    NotUnderstoodError,
    StepClass,
    Term,
)
from ltlc.assurance.reading.letters import Judged
from ltlc.assurance.reading.meaning import Given
from ltlc.assurance.reading.reopening import Reopening
from ltlc.assurance.reading.times import DUE, TIME, least
from ltlc.assurance.reading.truths import bare
from ltlc.semantics.reset_machine import Clocks, ResetMachine
from ltlc.semantics.timed_atoms import Clock, timed_atoms
from ltlc.semantics.trackers import Case
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.expressions import Current, New, Opening, Past


class Place(NamedTuple):
    """The states of the class and of the monitor, and where the clocks are, unless the verdict is permanent.

    `again`: the letter changes by itself in a nanosecond. `first`: nothing has been read. `stale` are the scopes that
    have closed, and at whose opening no value has been taken since.
    """

    state: int
    judged: int
    clocks: Clocks | None
    again: bool = False
    first: bool = False
    stale: frozenset[Clock] = frozenset()


class Instant(NamedTuple):
    """What happens at a place: what the trackers do, at a step or at a clock step; the attributes before it."""

    place: Place
    cases: tuple[Case, ...]
    before: Mapping[str, Term]
    by_time: bool


class Attributes:
    """The attributes of a class, by what they are for; `time` are the trackers that its clocks are of.

    `parameters` is what its step is given after the time. The order in which the class declares due times, kept values
    and histories is that of the clocks, openings and signals. Raises NotUnderstoodError if these are not as many.
    """

    def __init__(self, judged: Judged, monitor: StepClass, parameters: tuple[Term, ...], time: ResetMachine) -> None:
        self.is_timed = bool(timed_atoms(judged.formula))
        self._verdicts = judged.monitor.verdicts
        self._trackers = time.trackers
        self._scopes = dict(judged.specification.openings())
        self._reopening = Reopening(time.trackers, self._scopes.values())
        self.kept: dict[str, Opening] = _paired("values of openings", monitor.kept, tuple(self._scopes))
        clocks = tuple(k for k, tracker in enumerate(time.trackers) if tracker.bounds)
        is_only = len(clocks) == 1 and not monitor.dues
        self.clocks: dict[str, int] = _paired("due times", ("due",) if is_only else monitor.dues, clocks)
        self.symbols = {k: DUE if is_only else Moment(name) for name, k in self.clocks.items()}
        self._samples = _samples(judged, monitor, parameters)
        self._held: dict[str, Term] | None = None

    def at_start(self) -> dict[str, Term]:
        """All but the state, before the first step."""
        found: dict[str, Term] = {"verdict": Constant(Verdict.NOT_STARTED), "invalid": Constant(0)}
        if self.is_timed:
            found["due"] = NEVER
        for name, k in self.clocks.items():
            found[name] = NEVER if self._verdicts[0].is_permanent else due_at_first(self._trackers[k])
        return found

    def before(self, place: Place) -> dict[str, Term]:
        """All before an instant; a clock that does not count is never due."""
        counting = self.counting(place)
        found: dict[str, Term] = {
            "state": Constant(place.state),
            "verdict": Constant(Verdict.NOT_STARTED if place.first else self._verdicts[place.judged]),
            "invalid": Moment("invalid"),
        }
        if self.is_timed:
            found["due"] = DUE if self.has_clock_steps(place) else NEVER
        found |= {name: self.symbols[k] if k in counting else NEVER for name, k in self.clocks.items()}
        found |= {name: self.symbols[k] for name, k in self.ages.items()}
        found |= {name: Apply("history", (Attribute(name),)) for name in self._samples}
        return found | {name: remembered(opening) for name, opening in self.kept.items()}

    def counting(self, place: Place) -> list[int]:
        """The clocks that are set and have a bound yet to pass."""
        if place.clocks is None:
            return []
        states = place.clocks.states
        return [k for k in self.clocks.values() if counts(self._trackers[k], states[k])]

    @property
    def ages(self) -> dict[str, int]:
        """The clocks that messages renew; none if the verdict is permanent from the beginning."""
        if self._verdicts[0].is_permanent:
            return {}
        return {name: k for name, k in self.clocks.items() if is_age(self._trackers[k])}

    def has_clock_steps(self, place: Place) -> bool:
        """Whether something changes by itself after `place`, or by a message that makes no step."""
        is_open = place.clocks is not None and not place.first
        return is_open and (place.again or bool(self.counting(place)) or bool(self.ages))

    def to_take(self, instant: Instant) -> frozenset[Clock]:
        """The scopes, of those at whose opening values are taken, whose values a clock step has to take first."""
        place = instant.place
        assert place.clocks is not None
        taken = self._reopening.to_take(place.stale, place.clocks.states, instant.cases)
        return taken if instant.by_time else frozenset()

    def stale_after(self, instant: Instant) -> frozenset[Clock]:
        """The scopes that have closed and not taken values since."""
        place = instant.place
        assert place.clocks is not None
        return self._reopening.stale_after(place.stale, place.clocks.states, instant.cases, instant.by_time)

    def taken_at(self, scopes: Collection[Clock]) -> frozenset[Opening]:
        """The openings of `scopes`."""
        return frozenset(opening for opening, scope in self._scopes.items() if scope in scopes)

    def after_taking(self, instant: Instant, taken: Collection[Opening]) -> dict[str, Term]:
        """All but the state, and what is held, after the values held have been `taken`; the clock step is still due."""
        kept = {name: Given(Current(o.signal)) for name, o in self.kept.items() if o in taken}
        return {name: term for name, term in instant.before.items() if name not in self.held()} | kept

    def open(self, place: Place) -> frozenset[Opening] | None:
        """The openings whose scope is open; None where the verdict is permanent."""
        if place.clocks is None:
            return None
        are_open = self._reopening.open(place.clocks.states)
        return frozenset(opening for opening, scope in self._scopes.items() if scope in are_open)

    def sampled(self, before: Mapping[str, Term]) -> dict[str, Term]:
        """What a step makes of `before` if it is none: the samples are in the histories."""
        return {**before, **{name: Apply("pushed", (each,)) for name, each in self._samples.items()}}

    def after(self, instant: Instant, judged: int, again: bool, left: Mapping[str, Term]) -> dict[str, Term]:
        """All but the state after an instant at which the monitor goes to `judged`, given what the class has `left`.

        What that has more is what it holds for clock steps, the same after each step. Once the verdict is permanent,
        nothing has to be kept.
        """
        verdict = self._verdicts[judged]
        found = {**instant.before, "verdict": Constant(verdict)}
        found |= self._never() if verdict.is_permanent else self._due_after(instant, again, left)
        if not instant.by_time:
            found |= {name: Given(opening) for name, opening in self.kept.items()}
            held = {name: term for name, term in left.items() if name not in found}
            self._held = held if self._held is None else self._held
            found |= self._held
        if verdict.is_permanent:
            found |= {name: left[name] for name in self.kept}
        return found

    def _never(self) -> dict[str, Term]:
        """Once the verdict is permanent, nothing is due; ages may be renewed all the same."""
        return dict.fromkeys(("due", *(self.clocks.keys() - self.ages)), NEVER) if self.is_timed else {}

    def _due_after(self, instant: Instant, again: bool, left: Mapping[str, Term]) -> dict[str, Term]:
        """When clocks are due, and the next clock step: with the first of them, or a nanosecond after this instant."""
        clocks, before = instant.place.clocks, instant.before
        assert clocks is not None
        found: dict[str, Term] = {}
        for name, k in self.clocks.items():
            state, case = clocks.states[k], instant.cases[k]
            found[name] = due_after(self._trackers[k], state, case, before[name], instant.by_time)
        if not self.is_timed or "due" in found:
            return found
        is_as_before = not instant.place.again and all(found[name] == before[name] for name in found)
        if again:
            due: Term = TIME
        elif is_as_before and not self.ages and left.get("due") == before["due"]:
            due = before["due"]
        else:
            late = {name for name, k in self.ages.items() if not instant.cases[k].holding}
            due = least((NEVER, *(each for name, each in found.items() if name not in late)))
        return {**found, "due": due}

    @property
    def all_openings(self) -> frozenset[Opening]:
        """Every value at an opening that is kept."""
        return frozenset(self._scopes)

    def held(self) -> dict[str, Term]:
        """What a clock step finds of the values of the last step: nothing may be concluded from its news."""
        return {name: _without_news(term) for name, term in (self._held or {}).items()}


def _samples(judged: Judged, monitor: StepClass, parameters: tuple[Term, ...]) -> dict[str, Term]:
    """What each step adds to the histories, where the class keeps them itself."""
    given = {bare(each): each for each in parameters}
    past = [i for i in judged.specification.inputs() if isinstance(i, Past) and Given(i) not in given]
    depths = {i.signal: max(j.samples for j in past if j.signal == i.signal) + 1 for i in past}
    found = _paired("histories", monitor.histories, tuple(depths))
    for (name, most), signal in found.items():
        if most != depths[signal]:
            raise NotUnderstoodError(f"`{name}` holds {most} samples, not {depths[signal]}")
    return {name: given[Given(Current(signal))] for (name, _), signal in found.items()}


def _paired(what: str, names: tuple[Any, ...], things: tuple[Any, ...]) -> dict[Any, Any]:
    if len(names) != len(things):
        raise NotUnderstoodError(f"the class has {len(names)} {what}, not {len(things)}")
    return dict(zip(names, things, strict=True))


def _without_news(term: Term) -> Term:
    match term:
        case Apply(function, parts):
            return Apply(function, tuple(map(_without_news, parts)))
        case Given(New()):
            return Apply("over", (term,))
        case _:
            return term
