"""Emitted step functions against the certified monitor: every state, every letter that exists, every way of the clocks.

The monitor and the trackers of its formula, which say when its clocks run and what they decide, are followed side by
side with the emitted class from its first step on. At each pair of places that is reached, what the text does is
compared with what they do, as decision diagrams: the verdict, where it goes on, when its clocks are due, what is kept.
How the class numbers its states does not matter, nor which letters it lumps together.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ltlc.assurance.reading.ages import Ages, Told
from ltlc.assurance.reading.attributes import Attributes, Instant, Place
from ltlc.assurance.reading.clocks import is_behind
from ltlc.assurance.reading.execution import CaughtUp, Execution, Openings
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
from ltlc.assurance.reading.letters import Judged, Letters
from ltlc.assurance.reading.outcomes import (
    Difference,
    DiffersError,
    ReadBack,
    left_by,
    require_equal,
    require_verdict_answered,
    state_in,
)
from ltlc.assurance.reading.times import DUE, HELD, TIME, late
from ltlc.semantics.diagrams import Diagram
from ltlc.semantics.reset_machine import Clocks, ResetMachine
from ltlc.semantics.trackers import Case
from ltlc.specification.expressions import Opening


def read_back(judged: Judged, monitor: StepClass, parameters: tuple[Term, ...]) -> ReadBack | Difference:
    """Compare `monitor`, whose step takes `parameters` after the time, with the monitor of `judged`."""
    try:
        return _Comparison(judged, monitor, parameters).outcome()
    except (NotUnderstoodError, DiffersError) as error:
        return Difference(str(error))


class _Comparison:
    def __init__(self, judged: Judged, monitor: StepClass, parameters: tuple[Term, ...]) -> None:
        self.monitor, self.judge = monitor, judged.monitor
        self.parameters = parameters
        self.time = ResetMachine(judged.formula, dict.fromkeys(judged.specification.openings().values()))
        self.attributes = Attributes(judged, monitor, parameters, self.time)
        short = [Apply("short", (Attribute(name), Constant(most))) for name, most in monitor.histories]
        self.letters = Letters(judged, self.time, short, tuple(self.attributes.symbols.values()), monitor.has_integers)
        self.diagrams = self.letters.diagrams
        self.ages = Ages(self.attributes, self.letters, self.time)
        self.executed: dict[Any, Diagram] = {}
        self.reached: dict[Place, Diagram] = {}
        self.todo: list[Place] = []

    def outcome(self) -> ReadBack | Difference:
        """Compare what is reached from the beginning until nothing new is."""
        self.reach(self.start(), self.diagrams.false)
        done: dict[Place, Diagram] = {}
        while self.todo:
            place = self.todo.pop()
            held = self.reached[place]
            try:
                found = None if place in done else self.at_steps(place)
                if found is None and done.get(place) != held and self.attributes.has_clock_steps(place):
                    found = self.at_clock_steps(place, held)
            except (NotUnderstoodError, DiffersError) as error:
                return Difference(str(error), place.state)
            if found is not None:
                return found
            done[place] = held
        return ReadBack(len(done))

    def reach(self, place: Place, letters: Diagram) -> None:
        """`letters` have led to `place`."""
        before = self.reached.get(place)
        found = letters if before is None else self.diagrams.disjunction(before, letters)
        if found != before:
            self.reached[place] = found
            self.todo.append(place)

    def start(self) -> Place:
        """The place before the first step, if all attributes have there what they should."""
        session = (Moment("session"),) if self.attributes.is_timed else ()
        made = Execution(self.monitor, self.letters.truths, {}, Openings({}, None)).run("start", session)
        if not self.diagrams.is_terminal(made):
            raise NotUnderstoodError("a monitor does not begin always the same")
        if self.diagrams.value(made).returned is not None:
            raise NotUnderstoodError("what makes a monitor ready answers with something")
        left = left_by(self.diagrams.value(made))
        state = state_in(left)
        require_equal(left, {**self.attributes.at_start(), "state": Constant(state)})
        return Place(state, 0, None if self.judge.verdicts[0].is_permanent else self.time.initial, first=True)

    def execute(self, method: str, place: Place, before: Mapping[str, Term], arguments: tuple[Term, ...]) -> Diagram:
        """What a method does at `place`; what is the same for several places is worked out once."""
        is_open = self.attributes.all_openings if method == "expire" else self.attributes.open(place)
        openings = Openings(self.attributes.kept, is_open)
        key = method, frozenset(before.items()), openings.open
        if key not in self.executed:
            execution = Execution(self.monitor, self.letters.truths, before, openings)
            self.executed[key] = execution.run(method, arguments)
        return self.executed[key]

    def at_steps(self, place: Place) -> Difference | None:
        """What differs at a step from `place`, and if it is told of messages."""
        letters, diagrams, before = self.letters, self.diagrams, self.attributes.before(place)
        time = (TIME,) if self.attributes.is_timed else ()
        whole = self.execute("step", place, before, (*time, *self.parameters))
        is_late = letters.level(late(DUE))
        if before.get("due") == DUE:
            self.require_catching_up(diagrams.given({is_late: True}, whole))
        now = diagrams.given({is_late: False}, whole)
        if not self.monitor.hears:
            self.require_hearing(place)
            return self.at_steps_told(place, now, self.attributes.sampled(before), None)
        for told in self.ages.messages():
            renewed = {**self.attributes.sampled(before), **self.ages.renewed(told)}
            now_told = diagrams.given(self.ages.telling(told), now)
            if found := self.at_steps_told(place, now_told, renewed, told):
                return found
        return None

    def at_steps_told(
        self, place: Place, now: Diagram, sampled: Mapping[str, Term], told: Told | None
    ) -> Difference | None:
        """What differs at a step if it is none, and if it is one; of messages it is `told`, unless it is None."""
        letters, diagrams = self.letters, self.diagrams
        if place.first:
            self.require_none(letters.short, now, sampled)
        enough = diagrams.given(letters.none_of(letters.short), now)
        self.require_invalid(place, enough, sampled, told or frozenset())
        if letters.undefined == diagrams.true:
            return None
        valid = diagrams.given(letters.defined, enough)
        if place.clocks is None:
            self.require_permanent(place, valid, sampled)
            return None
        possible = letters.possible if told is None else self.ages.coming(told, letters.possible)
        for among, cases in letters.side_by_side(place.clocks, possible):
            passing = {k for k in self.time.passing(place.clocks, cases) if k not in self.ages}
            if self.ages.fit(place, cases, told) and (place.first or not passing):
                answers = self.answers(place, cases, told) | ({} if place.first else self.in_time())
                instant = Instant(place, cases, sampled, by_time=False)
                if found := self.difference(instant, among, diagrams.given(answers, valid)):
                    return found
        return None

    def in_time(self) -> dict[int, bool]:
        """No clock that is set is late."""
        clocks = (k for k in self.attributes.clocks.values() if k not in self.ages)
        return {self.letters.level(late(self.attributes.symbols[k])): False for k in clocks}

    def require_invalid(self, place: Place, found: Diagram, sampled: Mapping[str, Term], told: Told) -> None:
        """A step that is none is counted; where a message renews an age that was late, a clock step is taken."""
        right = {**sampled, "invalid": Moment("invalid", 1)}
        undefined, was_late = self.letters.undefined, self.ages.late_before(place, told)
        self.require_none(self.diagrams.conjunction(undefined, self.diagrams.negation(was_late)), found, right)
        before = self.attributes.before(place)
        changes = {name: term for name, term in {**right, "due": HELD}.items() if before.get(name) != term}
        where = self.diagrams.conjunction(undefined, was_late)
        for each in self.diagrams.values(self.diagrams.choose(where, found, self.letters.nothing)):
            if each is None:
                continue
            if not isinstance(each, CaughtUp) or each.anew:
                raise DiffersError("a message that makes no step does not renew an age that is late")
            require_equal(dict(each.changes), changes)

    def require_hearing(self, place: Place) -> None:
        """Messages renew ages; where one was late, a clock step is due at once. Raises DiffersError."""
        if "hear" not in self.monitor.methods:
            return
        before = self.attributes.before(place)
        whole = self.execute("hear", place, before, (TIME, *self.parameters))
        for told in self.ages.messages():
            found, was_late = self.diagrams.given(self.ages.telling(told), whole), self.ages.late_before(place, told)
            for where, due in ((was_late, {"due": HELD}), (self.diagrams.negation(was_late), {})):
                for each in self.diagrams.values(self.diagrams.choose(where, found, self.letters.nothing)):
                    if each is not None:
                        require_equal(left_by(each), {**before, **self.ages.renewed(told), **due})

    def at_clock_steps(self, place: Place, held: Diagram) -> Difference | None:
        """What differs at a clock step from `place`, to which the letters `held` have led.

        The first clock is late, or a message has made a late age young.
        """
        assert place.clocks is not None
        diagrams, attributes = self.diagrams, self.attributes
        before = {**attributes.before(place), "due": HELD, **attributes.held()}
        whole = diagrams.given(self.letters.defined, self.execute("expire", place, before, ()))
        is_due = diagrams.terminal(place.again or bool(self.ages))
        for k in attributes.counting(place):
            is_due = diagrams.disjunction(is_due, self.letters.truths.truth(late(attributes.symbols[k])))
        for among, cases in self.letters.side_by_side(place.clocks, self.letters.without_news(held)):
            if not self.ages.fit(place, cases, None):
                continue
            answers = self.answers(place, cases, None)
            letters = diagrams.conjunction(among, diagrams.given(answers, is_due))
            instant = Instant(place, cases, before, by_time=True)
            differs = self.difference_in_taking if attributes.to_take(instant) else self.difference
            if found := differs(instant, letters, diagrams.given(answers, whole)):
                return found
        return None

    def answers(self, place: Place, cases: tuple[Case, ...], told: Told | None) -> dict[int, bool]:
        """Which clocks are late, as far as `cases` tell; of ages that are `told` to be young, none is asked."""
        assert place.clocks is not None
        found = self.ages.answers(cases, told)
        for k in self.attributes.counting(place):
            passed = cases[k].passed
            if passed is not None:
                found[self.letters.level(late(self.attributes.symbols[k]))] = passed > place.clocks.states[k].passed
        return found

    def where(self, found: Diagram, value: Any) -> Diagram:
        """True where `found` has that value."""
        return self.diagrams.combine(lambda other: other == value, found)

    def require_catching_up(self, due: Diagram) -> None:
        """Where a clock step is due, it is taken, and then the step, if it is one. Raises DiffersError."""
        for each in self.diagrams.values(due):
            if not isinstance(each, CaughtUp):
                raise DiffersError("a clock step that is due is not taken")
            counted = not each.anew and each.changes == {("invalid", Moment("invalid", 1))}
            where = self.where(due, each)
            is_none = self.diagrams.conjunction(where, self.letters.undefined) == where
            if not (each.anew and not each.changes) and not (counted and is_none):
                raise DiffersError("a clock step is taken in the midst of a step")

    def require_none(self, where: Diagram, found: Diagram, right: Mapping[str, Term]) -> None:
        """A step that is none leaves what is `right`. Raises DiffersError."""
        for each in self.diagrams.values(self.diagrams.choose(where, found, self.letters.nothing)):
            if each is not None:
                require_equal(left_by(each), right)
                require_verdict_answered(each)

    def require_permanent(self, place: Place, found: Diagram, before: Mapping[str, Term]) -> None:
        """Once it is permanent, the verdict stays, and no clock runs. Raises DiffersError."""
        self.require_left_permanent(place, found, before)
        for each in self.diagrams.values(found):
            require_verdict_answered(each)
        if self.ages and not place.first:
            renewed = {**self.attributes.before(place), "due": HELD, **self.attributes.held()}
            self.require_left_permanent(place, self.execute("expire", place, renewed, ()), {**renewed, "due": NEVER})

    def require_left_permanent(self, place: Place, found: Diagram, before: Mapping[str, Term]) -> None:
        names = ("verdict", "invalid", *(("due", *self.attributes.clocks) if self.attributes.is_timed else ()))
        right = {**before, "verdict": Constant(self.judge.verdicts[place.judged])}
        for each in self.diagrams.values(found):
            left = left_by(each)
            require_equal({name: left[name] for name in names}, {name: right[name] for name in names})
            self.reach(place._replace(state=state_in(left), first=False), self.diagrams.false)

    def difference(self, instant: Instant, among: Diagram, found: Diagram) -> Difference | None:
        """What differs at the letters `among`, at which the class does `found`; what they lead to is reached."""
        trackers = zip(self.time.trackers, instant.cases, strict=True)
        is_again = any(is_behind(*each) for each in trackers) or self.ages.are_renewed(instant.cases)
        again = self.diagrams.terminal(is_again)
        if not instant.by_time:
            again = self.diagrams.disjunction(again, self.letters.with_news())
        judged = self.letters.row(instant.place.judged, instant.cases)
        together: Callable[..., Any] = lambda *each: each  # noqa: E731
        inside = self.diagrams.choose(
            among, self.diagrams.combine(together, found, judged, again), self.letters.nothing
        )
        for each in self.diagrams.values(inside):
            if each is None:
                continue
            letters = self.where(inside, each)
            try:
                after = self.after(instant, *each)
            except (DiffersError, NotUnderstoodError) as error:
                letter = self.letters.example(letters, instant.cases)
                return Difference(str(error), instant.place.state, letter, instant.by_time)
            self.reach(after, self.letters.signals(letters))
        return None

    def difference_in_taking(self, instant: Instant, among: Diagram, found: Diagram) -> Difference | None:
        """What differs at a clock step, at the letters `among`, at which values have to be taken at openings first."""
        scopes = self.attributes.to_take(instant)
        taken = self.attributes.taken_at(scopes)
        inside = self.diagrams.choose(among, found, self.letters.nothing)
        for each in self.diagrams.values(inside):
            if each is None:
                continue
            letters = self.where(inside, each)
            try:
                left = left_by(each)
                state = state_in(left)
                right = {**self.attributes.after_taking(instant, taken), "state": Constant(state)}
                held = {name: left.get(name) for name in self.attributes.held()}
                require_equal({name: term for name, term in left.items() if name not in held}, right)
                self.require_held_anew(instant.before, held, taken)
            except (DiffersError, NotUnderstoodError) as error:
                letter = self.letters.example(letters, instant.cases)
                return Difference(str(error), instant.place.state, letter, by_time=True)
            after = instant.place._replace(state=state, stale=instant.place.stale - scopes)
            self.reach(after, self.letters.whatever_is_taken(taken, self.letters.signals(letters)))
        return None

    def require_held_anew(
        self, before: Mapping[str, Term], held: Mapping[str, Term | None], taken: frozenset[Opening]
    ) -> None:
        """What is held for clock steps is as `before`, but for conditions on values `taken`. Raises DiffersError."""
        for name, term in held.items():
            right = self.letters.anew(before[name], taken)
            if term is None or (
                term != before[name] if right is None else self.letters.truth_where_defined(term) != right
            ):
                raise DiffersError(f"`{name}` is not what holds with the values that are taken")

    def after(self, instant: Instant, found: Any, judged: int, again: bool) -> Place:
        """The place after an instant, if the class does there what it should. Raises DiffersError."""
        left = left_by(found)
        state = state_in(left)
        require_equal(left, {**self.attributes.after(instant, judged, again, left), "state": Constant(state)})
        if not instant.by_time:
            require_verdict_answered(found)
        if self.judge.verdicts[judged].is_permanent:
            return Place(state, judged, None)
        clocks = Clocks(False, tuple(case.state for case in instant.cases))
        return Place(state, judged, clocks, again, stale=self.attributes.stale_after(instant))
