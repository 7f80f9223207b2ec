"""A lowered machine against the certified monitor: every state, every letter that exists, every way of the clocks.

The monitor and the trackers of its formula, which say when its clocks run and what they decide, are followed side by
side with the machine from the first step on. At each pair of places that is reached, what the machine does is compared
with what they do, as decision diagrams. What its atoms and guards say is compared with the conditions as
`lowered.meaning` has them. Nothing is used of what folded the monitor, nor of what lowered its conditions.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import zip_longest
from typing import NamedTuple

from ltlc.assurance.lowered.clocks import HELD, NEVER, TIME, Moment, counts, due_after, is_behind
from ltlc.assurance.lowered.letters import Judged, Letters
from ltlc.assurance.lowered.meaning import said
from ltlc.assurance.lowered.news import require_excused
from ltlc.assurance.lowered.reopening import Reopening, Scopes
from ltlc.assurance.lowered.truths import DiffersError
from ltlc.assurance.reading.outcomes import Difference
from ltlc.backends.python.code import flat
from ltlc.backends.python.expressions import python_speller
from ltlc.dataclass import dataclass
from ltlc.program.expressions import Expression, reads_of
from ltlc.program.machine import Age, Base, Clock, Machine, Outcome
from ltlc.program.normal import reached
from ltlc.semantics import arenas
from ltlc.semantics.diagrams import Diagram, rows
from ltlc.semantics.monitor import Target, below
from ltlc.semantics.reset_machine import Clocks, ResetMachine
from ltlc.semantics.timed_atoms import Age as AgeAtom
from ltlc.semantics.timed_atoms import Occurred, timed_atoms
from ltlc.semantics.trackers import Case


@dataclass(frozen=True, slots=True)
class Equal:
    """The machine does what the monitor does, in all `situations`: its states, each with where its clocks can be.

    `places` has where the monitor and its clocks can be in each state, unless the verdict is permanent.
    """

    situations: int
    places: Mapping[int, frozenset[arenas.Place]]


def compare(machine: Machine, judged: Judged) -> Equal | Difference:
    """Whether `machine` does what the monitor of `judged` does."""
    try:
        return _Comparison(machine, judged).outcome()
    except DiffersError as error:
        return Difference(str(error))
    except (IndexError, KeyError, RecursionError) as error:
        return Difference(f"it is not a machine of this property: {error!r}")


class Place(NamedTuple):
    """The states of the machine and of the monitor, and where the clocks are, unless the verdict is permanent.

    `again`: the letter changes by itself in a nanosecond. `first`: nothing has been read. Scopes that are `stale` have
    closed, and at their opening no value has been taken since.
    """

    state: int
    judged: int
    clocks: Clocks | None
    again: bool = False
    first: bool = False
    stale: Scopes = frozenset()


class Instant(NamedTuple):
    """What the trackers do at a place; at a step, or `by_time` at a clock step."""

    place: Place
    clocks: Clocks
    cases: tuple[Case, ...]
    by_time: bool


class _Done(NamedTuple):
    """What the machine does, where the monitor goes, and whether a clock step comes a nanosecond later."""

    outcome: Outcome
    judged: int
    again: bool


class _Comparison:
    def __init__(self, machine: Machine, judged: Judged) -> None:
        self.machine, self.monitor, self.formula = machine, judged.monitor, judged.formula
        self.is_timed = bool(timed_atoms(judged.formula))
        self.arrival = judged.specification.arrival
        self.openings = judged.specification.openings()
        scopes = list(dict.fromkeys(self.openings.values()))
        self.time = ResetMachine(judged.formula, scopes)
        self.reopening = Reopening(self.time.trackers, scopes)
        self.clocks = [k for k, tracker in enumerate(self.time.trackers) if tracker.bounds]
        subjects = {k: self.time.trackers[k].subject for k in self.clocks}
        self.ages = {k: subject.news.name for k, subject in subjects.items() if isinstance(subject, AgeAtom)}
        self.due = {k: Moment(f"when clock {number} was due") for number, k in enumerate(self.clocks)}
        self.counts = {each: Moment(f"when {each.name} is over") for each in judged.specification.counts()}
        over = {each.name: moment for each, moment in self.counts.items()}
        self.letters = Letters(judged, self.time, tuple(self.due.values()), over)
        self.diagrams = self.letters.diagrams
        self.require_reads(judged)
        self.questions = [self._holds(atom) for atom in machine.atoms]
        asked = [*self.due.values(), *self.counts.values()]
        self.questions += [self.diagrams.variable(self.letters.level(moment)) for moment in asked]
        self._row = rows(self.diagrams, machine.decisions, self.questions.__getitem__, machine.outcomes.__getitem__)
        self.reached: dict[Place, Diagram] = {}
        self.todo: list[Place] = []

    def _late(self, k: int) -> int:
        """The level that asks whether the clock of tracker k is past its due time."""
        return self.letters.level(self.due[k])

    def _holds(self, atom: Expression) -> Diagram:
        try:
            return self.diagrams.given(self.letters.defined, self.letters.truths.holds(atom))
        except DiffersError as error:
            written = python_speller({read: read.signal for read in reads_of(atom)}).code(atom, True)
            raise DiffersError(f"`{flat(written)}`: {error}") from None

    def require_reads(self, judged: Judged) -> None:
        """Raise DiffersError unless what is read, kept, counted and asked not to be NaN is as in the property."""
        machine = self.machine
        if machine.inputs != tuple(map(said, judged.specification.inputs())):
            raise DiffersError("other inputs are read")
        if tuple(register.kept for register in machine.registers) != tuple(map(said, self.openings)):
            raise DiffersError("other values at openings are kept")
        require_excused(machine, judged.specification)
        if self.letters.truths.some(map(self.letters.truths.is_nan, machine.guards)) != self.letters.undefined:
            raise DiffersError("its guards do not determine which steps are invalid")

    def require_clocks(self) -> None:
        """It has the trackers' clocks, then the counts; where no clock step is taken, none. Raises DiffersError."""
        trackers = self.clocks if self.machine.is_timed else []
        own, counts = self.machine.clocks[: len(trackers)], self.machine.clocks[len(trackers) :]
        if list(own) != [Clock(self._age(k)) for k in trackers]:
            raise DiffersError("it has other clocks, or ages")
        self.require_counts(counts, self.counts if self.machine.is_timed else ())

    def _age(self, k: int) -> Age | None:
        """What age the tracker k is of; once the verdict is permanent, ages do not matter."""
        if k not in self.ages or self.monitor.verdicts[0].is_permanent:
            return None
        return Age(self.arrival(self.ages[k]).signal.name, self.time.trackers[k].bounds[0])

    def require_counts(self, clocks: Sequence[Clock], counts: Iterable[Occurred]) -> None:
        """These clocks are for these `counts` of the property. Raises DiffersError."""
        for clock, count in zip_longest(clocks, counts):
            found = clock and clock.occurrences
            if found is None or count is None or clock.age is not None:
                raise DiffersError("it counts something different")
            right = count.begins, count.times, count.within, count.presumed
            if (found.begins, found.times, found.duration, found.presumed) != right:
                raise DiffersError(f"it counts differently from `{count.name}`")
            if self._holds(found.condition) != self.letters.where(count.operand):
                raise DiffersError(f"it counts something other than `{count.name}`")

    def outcome(self) -> Equal | Difference:
        """Compare what is reached from the beginning until nothing new is."""
        self.require_states()
        self.require_clocks()
        self.require_verdict(0, 0)
        permanent = self.monitor.verdicts[0].is_permanent
        self.reach(Place(0, 0, None if permanent else self.time.initial, first=True), self.diagrams.false)
        done: dict[Place, Diagram] = {}
        while self.todo:
            place = self.todo.pop()
            held = self.reached[place]
            try:
                found = None if place in done else self.at_steps(place)
                if found is None and done.get(place) != held and self.waits(place):
                    found = self.at_clock_steps(place, held)
            except DiffersError as error:
                return Difference(str(error), place.state)
            if found is not None:
                return found
            done[place] = held
        return Equal(len(done), self.places(done))

    def places(self, done: Iterable[Place]) -> Mapping[int, frozenset[arenas.Place]]:
        """Where the monitor and its clocks are, without what only follows scopes at whose opening values are taken."""
        numbers = {tracker.subject: k for k, tracker in enumerate(self.time.trackers)}
        own = [numbers[tracker.subject] for tracker in ResetMachine(self.formula).trackers]
        found: dict[int, set[arenas.Place]] = {}
        for place in done:
            if place.clocks is not None and not place.first:
                clocks = Clocks(False, tuple(place.clocks.states[k] for k in own))
                found.setdefault(place.state, set()).add(arenas.Place(place.judged, clocks))
        return {state: frozenset(some) for state, some in found.items()}

    def reach(self, place: Place, letters: Diagram) -> None:
        """`letters` have led to `place`."""
        before = self.reached.get(place)
        found = letters if before is None else self.diagrams.disjunction(before, letters)
        if found != before:
            self.reached[place] = found
            self.todo.append(place)

    def require_states(self) -> None:
        """Raise DiffersError unless every state is reached, and defines clock steps if there can be one."""
        steps = [self._outcomes(state.step) for state in self.machine.states]
        expires = [[] if state.expire is None else self._outcomes(state.expire) for state in self.machine.states]
        states = enumerate(self.machine.states)
        aging = {number for number, state in states if (self.ages or self.counts) and not state.verdict.is_permanent}
        found = reached(steps.__getitem__, expires.__getitem__, aging.__contains__)
        for number, state in enumerate(self.machine.states):
            if state.expire is None and number in found.waiting:
                raise DiffersError(f"in state {number} a clock step is not announced")
            if state.expire is not None and number not in found.waiting:
                raise DiffersError(f"in state {number} a clock step is announced wrongly")
        if len(found.states) < len(self.machine.states):
            raise DiffersError("it has unreachable states")

    def _outcomes(self, target: Target) -> list[Outcome]:
        """Where `target` leads by the machine alone, whatever its atoms mean."""
        found = below(self.machine.decisions, [target])
        return [self.machine.outcomes[each] for each in found if each >= 0]

    def waits(self, place: Place) -> bool:
        """Whether something changes by itself after `place`."""
        if not self.is_timed or place.first or place.clocks is None:
            return False
        return place.again or bool(self.ages or self.counts) or any(self._runs(k, place.clocks) for k in self.clocks)

    def _runs(self, k: int, clocks: Clocks) -> bool:
        """Whether it is a clock that outcomes set, and a bound of it is yet to pass."""
        return counts(self.time.trackers[k], clocks.states[k])

    def at_steps(self, place: Place) -> Difference | None:
        """What differs at a step from `place`, before which the clock steps up to its time have been taken."""
        self.require_closed(place)
        set_clocks = {self._late(k): False for k in self.clocks if k not in self.ages}
        row = self.diagrams.given(set_clocks, self._row(self.machine.states[place.state].step))
        if place.clocks is None:
            self.require_permanent(place, row)
            return None
        for among, cases in self.letters.side_by_side(place.clocks, self.letters.possible):
            passing = self.time.passing(place.clocks, cases) - self.ages.keys()
            if self.matters(place.clocks, cases) and (place.first or not passing):
                answered = self.diagrams.given(self.answers(place.clocks, cases), row)
                found = self.difference(Instant(place, place.clocks, cases, by_time=False), among, answered)
                if found is not None:
                    return found
        return None

    def at_clock_steps(self, place: Place, held: Diagram) -> Difference | None:
        """What differs at a clock step from `place`, to which the letters `held` have led.

        The first clock is late, or an age gets so, or a message that makes no step renews one that was.
        """
        assert place.clocks is not None
        expire = self.machine.states[place.state].expire
        if expire is None:
            raise DiffersError("no clock step is taken")
        running = [k for k in self.clocks if self._runs(k, place.clocks)]
        late = self.letters.truths.some(self.diagrams.variable(self._late(k)) for k in running)
        for among, cases in self.letters.side_by_side(place.clocks, self.letters.without_news(held)):
            if not self.matters(place.clocks, cases):
                continue
            turns = any(cases[k].state.passed != place.clocks.states[k].passed for k in self.ages)
            is_due = self.diagrams.true if place.again or turns or self.counts else late
            answers = self.answers(place.clocks, cases)
            where = self.diagrams.conjunction(among, self.diagrams.given(answers, is_due))
            row = self.diagrams.given(answers, self._row(expire))
            found = self.difference(Instant(place, place.clocks, cases, by_time=True), where, row)
            if found is not None:
                return found
        return None

    def matters(self, clocks: Clocks, cases: Sequence[Case]) -> bool:
        """Whether only such messages come as renew an age that was late; the others tell nothing."""
        coming = {name for k, name in self.ages.items() if cases[k].starts}
        return coming == {name for k, name in self.ages.items() if cases[k].starts and clocks.states[k].passed}

    def answers(self, clocks: Clocks, cases: Sequence[Case]) -> dict[int, bool]:
        """Which clocks are late, as far as `cases` tell; those that do not run never are, and ages always tell."""
        found = {}
        for k in self.clocks:
            passed = cases[k].passed
            if k in self.ages:
                found[self._late(k)] = not cases[k].holding
            elif not self._runs(k, clocks):
                found[self._late(k)] = False
            elif passed is not None:
                found[self._late(k)] = passed > clocks.states[k].passed
        return found

    def require_closed(self, place: Place) -> None:
        """Which values a step takes from `place`: of scopes that are not open before it. Raises DiffersError.

        Once the verdict is permanent they stay or, if it was from the beginning, are the latest.
        """
        if place.clocks is not None:
            are_open = self.reopening.open(place.clocks.states)
        else:
            are_open = frozenset() if self.monitor.verdicts[0].is_permanent else frozenset(self.openings.values())
        for register, scope in zip(self.machine.registers, self.openings.values(), strict=True):
            if (place.state in register.closed) == (scope in are_open):
                raise DiffersError(f"a step does, or does not, take the value of {register.kept.signal} at the opening")

    def require_permanent(self, place: Place, row: Diagram) -> None:
        """Once it is permanent, the verdict stays, and no clock runs. Raises DiffersError."""
        verdict = self.monitor.verdicts[place.judged]
        inside = self.diagrams.choose(self.letters.possible, row, self.letters.nothing)
        for outcome in self.diagrams.values(inside):
            if outcome is not None:
                self.require_verdict(outcome.state, place.judged)
                if outcome.sets or outcome.again or outcome.taken:
                    raise DiffersError(f"something is done after the verdict {verdict.value}")
                self.reach(place._replace(state=outcome.state, first=False), self.diagrams.false)

    def require_verdict(self, state: int, judged: int) -> None:
        """The machine shows in `state` the verdict of the monitor. Raises DiffersError."""
        shown, right = self.machine.states[state].verdict, self.monitor.verdicts[judged]
        if shown is not right:
            raise DiffersError(f"the verdict is {shown.value} instead of {right.value}")

    def difference(self, instant: Instant, among: Diagram, row: Diagram) -> Difference | None:
        """What differs at the letters `among`, at which the machine does `row`; what they lead to is reached."""
        trackers = zip(self.time.trackers, instant.cases, strict=True)
        is_renewed = any(instant.cases[k].starts for k in self.ages)
        again = self.diagrams.terminal(is_renewed or any(is_behind(*each) for each in trackers))
        if not instant.by_time:
            again = self.diagrams.disjunction(again, self.letters.with_news)
        judged = self.letters.row(instant.place.judged, instant.cases)
        done = self.diagrams.combine(_Done, row, judged, again)
        inside = self.diagrams.choose(among, done, self.letters.nothing)
        for each in self.diagrams.values(inside):
            if each is None:
                continue
            where = self.diagrams.combine(lambda other, each=each: other == each, inside)
            letters = self.letters.signals(where)
            try:
                self.follow(instant, each, letters)
            except DiffersError as error:
                letter = self.letters.example(where, instant.cases)
                return Difference(str(error), instant.place.state, letter, instant.by_time)
        return None

    def follow(self, instant: Instant, done: _Done, letters: Diagram) -> None:
        """Go on with what the machine has done by `letters`, if that is right. Raises DiffersError."""
        place, clocks, cases, by_time = instant
        to_take = self.reopening.to_take(place.stale, clocks.states, cases) if by_time else frozenset()
        taken = frozenset(opening for opening, scope in self.openings.items() if scope in to_take)
        numbers = tuple(number for number, opening in enumerate(self.openings) if opening in taken)
        if done.outcome.taken != numbers:
            raise DiffersError("other values are taken at openings")
        if taken:
            if done.outcome.sets or done.outcome.again:
                raise DiffersError("something is done besides taking values at openings")
            after = place._replace(state=done.outcome.state, stale=place.stale - to_take)
            self.reach(after, self.letters.whatever_is_taken(taken, letters))
            return
        self.require_verdict(done.outcome.state, done.judged)
        self.require_dues(instant, done)
        if self.monitor.verdicts[done.judged].is_permanent:
            self.reach(Place(done.outcome.state, done.judged, None), letters)
            return
        stale = self.reopening.stale_after(place.stale, clocks.states, cases, by_time)
        states = tuple(case.state for case in cases)
        self.reach(Place(done.outcome.state, done.judged, Clocks(False, states), done.again, stale=stale), letters)

    def require_dues(self, instant: Instant, done: _Done) -> None:
        """When clocks are due after an instant; never, once the verdict is permanent. Raises DiffersError."""
        permanent = self.monitor.verdicts[done.judged].is_permanent
        if done.outcome.again != (done.again and self.is_timed and not permanent):
            raise DiffersError("whether a clock step comes a nanosecond later is stated wrongly")
        found = self.dues(instant, done.outcome)
        for number, k in enumerate(self.clocks):
            before = self._before(instant.clocks, k)
            right = before if k in self.ages else NEVER
            if not permanent:
                tracker, state = self.time.trackers[k], instant.clocks.states[k]
                right = due_after(tracker, state, instant.cases[k], before, instant.by_time)
            if found.get(number, before) != right:
                raise DiffersError(f"clock {number} is due {found.get(number, before)} instead of {right}")

    def _before(self, clocks: Clocks, k: int) -> Moment:
        return self.due[k] if k in self.ages or self._runs(k, clocks) else NEVER

    def dues(self, instant: Instant, outcome: Outcome) -> Mapping[int, Moment]:
        """When the clocks that an outcome sets are due. Raises DiffersError if one is set to what it is."""
        found: dict[int, Moment] = {}
        bases = {Base.NOW: TIME, Base.JUST_BEFORE: HELD, Base.NEVER: NEVER}
        for number, base, duration in outcome.sets:
            before = self._before(instant.clocks, self.clocks[number])
            counted = bases.get(base, before)
            due = Moment(counted.base, counted.offset + duration)
            if number in found or due == before:
                raise DiffersError(f"clock {number} is set twice, or to when it is due")
            found[number] = due
        return found
