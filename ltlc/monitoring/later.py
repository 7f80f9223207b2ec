"""All violations of a property: the first one decides its verdict, and these come after it.

After a violation, from the next instant on, the rest of the run is judged anew, as if the property began there. The
violation lasts up to the first instant at which the property, judged so, is neither violated nor owes anything. So of
`never p` there is a violation for each stretch in which p holds; of a response one for each trigger that has no answer
in time, up to the answer; of `after_until` one for each episode, if what opens it does not hold any more.

What reads the past, or values at openings, has one violation only: they would begin anew as well.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Iterable, Sequence
from typing import TYPE_CHECKING, Any

from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.runtime.courses import Course
from ltlc.runtime.episodes import Episodes, latest
from ltlc.runtime.properties import Failure, Moment, Monitor, MonitoredProperty
from ltlc.runtime.reasons import Before
from ltlc.runtime.sampling import New, Value
from ltlc.runtime.times import NEVER
from ltlc.runtime.tracking import Observer, RecordedTrack, Track
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.timed_atoms import Age, Late, News, timed_atoms
from ltlc.semantics.verdicts import Verdict

if TYPE_CHECKING:
    from ltlc.monitoring.letters import Letters

MOST = 1000
"""After so many violations of a property no more are looked for."""


@dataclass(slots=True)
class Violation:
    """A property is violated at a moment, and `until` then; None if it still was when the run ended.

    An obligation that was open then had been since `owed`, which is that moment if none was; its episode had `opened`.
    """

    moment: Moment
    owed: Nanoseconds
    opened: Nanoseconds
    until: Nanoseconds | None = None

    def lasted(self, end: Nanoseconds) -> Nanoseconds:
        """For how long, in a run up to `end`; 0 if it was a single instant."""
        duration = (end if self.until is None else self.until) - self.moment.time
        return duration if duration > 1 else 0


def can_recur(compiled: Compiled) -> bool:
    """Whether violations after the first one are looked for."""
    is_timeless = all(isinstance(atom, News | Age | Late) for atom in timed_atoms(compiled.formula))
    of = compiled.specification
    return is_timeless and not of.openings() and of.slicing is None


class Later(Course):
    """A property after its first violation: all its `violations`, that one included.

    Where it `is_out`, the last instant, which was at `_last`, violated it, so that it begins anew at the next one. It
    `is_stuck` if that has been found to violate it as well: so will all up to a step, or a change of an age.
    """

    __slots__ = ("_began", "_has_news", "_last", "_renewed_at", "is_out", "is_stuck", "violations")

    def __init__(self, track: Track, first: Failure) -> None:
        """Go on from where a track was violated."""
        super().__init__(track.property, Counter(), first.time)
        self._keep_ages(track.monitor)
        self.steps, self.judged_on = track.steps, track.judged_on
        self.violations = [violation_at(first)]
        self.is_out, self.is_stuck = True, False
        self._last = self._renewed_at = first.time
        self._began = NEVER
        self._has_news = any(isinstance(wanted, New) for wanted in track.property.inputs)

    @property
    def is_over(self) -> bool:
        """Whether no violation can come any more, or none is looked for."""
        is_satisfied = not self.is_out and self.verdict is Verdict.SATISFIED
        return is_satisfied or len(self.violations) >= MOST

    @property
    def due(self) -> int:
        """When the next instant comes that is not as the last one, unless a step comes first."""
        if not self.is_out:
            return super().due
        if not self.is_stuck:
            return self._last + 1
        dues = (getattr(self.monitor, age.due) for age in self.property.ages)
        return min((due + 1 for due in dues if due >= self._last), default=NEVER)

    def hear(self, time: int, signals: Container[str]) -> None:
        """Messages come: ages count anew. If no step is taken now, that is an instant of its own."""
        self.hold(time)
        super().hear(time, signals)
        self._renewed_at = time

    def renew(self, time: int) -> list[Any]:
        """Take the instant at which a late age is young, by what makes no step."""
        renewed, self._renewed = self._renewed, ()
        if self.is_out and renewed:
            self._try(time)
        else:
            for monitor in renewed:
                monitor.due = time - 1
            self._pass(time)
        return []

    def hold(self, time: int) -> list[Any]:
        """Let time pass up to and including `time`, with no step until then."""
        if self._renewed and self._renewed_at < time:
            self.renew(self._renewed_at)
        self._pass(time)
        return []

    def _pass(self, time: Nanoseconds) -> None:
        while not self.is_over and (due := self.due) <= time:
            if self.is_out:
                self._try(due)
                continue
            began, lasts = self._began, self.violations[-1].until is None
            self._expire(Moment(self.steps - 1, due, by_time=True))
            if self._settle(due) and lasts and began < NEVER and not self.property.ages:
                # What is held has violated it once more: so it will, as long as it is held.
                self._last += max(0, time - due) // (due + 1 - began) * (due + 1 - began)

    def _try(self, time: Nanoseconds) -> None:
        """The property begins anew with what is held."""
        held, steps = self._held(), self.steps
        self._begin_anew(time)
        super().step(time, held)
        self.steps, self._began = steps, time
        self.is_stuck = self.verdict is Verdict.VIOLATED
        self._settle(time)

    def step(self, time: int, values: Sequence[Value]) -> Verdict | None:
        """Judge one more step."""
        self.hold(time)
        if self.is_over:
            self.steps += 1
            return None
        was_out, last, steps = self.is_out, self.monitor, self.steps
        if was_out:
            self._begin_anew(time)
        super().step(time, values)
        if self.steps == steps:  # it was no step
            if was_out:
                self.monitor, self.verdict = last, Verdict.VIOLATED
            return None
        # Of what begins anew without news, the next instant says what this one did.
        self._began = NEVER
        self.is_stuck = self._settle(time) and was_out and not self._has_news
        self.is_settled &= was_out == self.is_out and (self.is_out or self.due >= NEVER)
        return None

    def _begin_anew(self, time: Nanoseconds) -> None:
        """The property begins at this instant."""
        last = self.monitor
        self.begin(time)
        self._keep_ages(last)
        self.verdict, self.decided_at = Verdict.NOT_STARTED, None
        self._passed, self.scopes = (), tuple(map(Episodes, self.property.scopes))

    def _keep_ages(self, last: Monitor) -> None:
        """Ages count from messages, whatever begins anew."""
        for age in self.property.ages:
            setattr(self.monitor, age.due, getattr(last, age.due))

    def _settle(self, time: Nanoseconds) -> bool:
        """Whether the instant violates the property; it may be the first one, or the first one after that."""
        last = self.violations[-1]
        self.is_out = self.verdict is Verdict.VIOLATED
        if self.is_out:
            self._last = time
            if last.until is not None and self.decided_at is not None:
                self.violations.append(violation_at(self.decided_at))
            if len(self.violations) < MOST:
                self.decided_at = None  # it goes on
        elif self.verdict is not Verdict.PRESUMABLY_VIOLATED and last.until is None:
            last.until = time
        return self.is_out

    def _failure(self, before: Before, moment: Moment, values: Sequence[Value]) -> Failure:
        """Of later violations no more is kept than when they are, and since when."""
        since, opened = self.open_since, latest(self.scopes)
        return Failure(moment.step, moment.time, (), (), since, opened, by_time=moment.by_time)


def violation_at(failure: Failure) -> Violation:
    """The violation that a property, or a slice of it, was decided by."""
    moment = Moment(failure.step, failure.time, by_time=failure.by_time)
    owed = failure.time if failure.open_since is None else failure.open_since.time
    return Violation(moment, owed, min((each.time for each in failure.opened), default=owed))


class JudgedTrack(RecordedTrack):
    """A track of a recording: if the property `can_recur`, it has what is known `later` than its first violation.

    Its `letters` are kept if they are wanted.
    """

    __slots__ = ("can_recur", "later", "letters")

    def __init__(
        self,
        property_: MonitoredProperty,
        keep: bool,
        observer: Observer | None,
        can_recur: bool,
        letters: Letters | None = None,
    ) -> None:
        self.can_recur, self.letters = can_recur, letters
        self.later: Later | None = None
        super().__init__(property_, keep, observer)

    @property
    def times_violated(self) -> int:
        """How many violations were found."""
        return super().times_violated if self.later is None else len(self.later.violations)

    def step(self, time: int, values: Sequence[Value]) -> Verdict | None:
        """Judge one more step, to whose time the property was held."""
        later, steps = self.later, self.steps
        if later is not None:
            later.step(time, values)
        previous = super().step(time, values)
        if later is not None:
            self.is_settled &= later.is_settled
        if self.letters is not None:
            given = (*self.property.given(values), *self.kept()) if self.steps > steps else None
            self.letters.step(time, given)
        return previous

    def hold(self, time: int) -> list[Any]:
        """Take the clock steps up to and including `time`, with no step until then."""
        changes = super().hold(time)
        if self.later is not None:
            self.later.hold(time)
        return changes

    def hear(self, time: int, signals: Container[str]) -> None:
        """Messages come: the ages of these signals count anew, whatever the values."""
        super().hear(time, signals)
        if self.letters is not None:
            self.letters.hear(time, signals)
        if self.later is not None:
            self.later.hear(time, signals)

    def repeat(self, times: int, at: Iterable[int]) -> None:
        """Judge the last step `times` more times, `at` the times that it gives."""
        steps = self.steps
        super().repeat(times, at)
        if self.letters is not None:
            self.letters.repeat(self.steps - steps)
        if self.later is not None:
            self.later.repeat(times, ())

    def _change(
        self, before: Before, step: int, time: int, values: Sequence[Value], *, by_time: bool = False
    ) -> Verdict:
        previous = super()._change(before, step, time, values, by_time=by_time)
        if self.can_recur and self.verdict is Verdict.VIOLATED and self.decided_at is not None:
            self.later = Later(self, self.decided_at)
        return previous


def letters_of(track: Track) -> Letters | None:
    """Where the letters of a property are kept, as long as more can come."""
    letters = track.letters if isinstance(track, JudgedTrack) else None
    return None if letters is None or letters.is_settled else letters


def later_of(track: Track) -> Later | None:
    """What goes on after the first violation of a property, as long as more can come."""
    later = track.later if isinstance(track, JudgedTrack) else None
    return None if later is None or later.is_over else later


def is_followed(track: Track) -> bool:
    """Whether more steps of a property matter."""
    return track.decided_at is None or later_of(track) is not None or letters_of(track) is not None


def all_violations(track: Track) -> list[Violation] | None:
    """Those of a property in the order of time, at most `MOST`; None if no more than the first is looked for."""
    if not isinstance(track, JudgedTrack) or not track.can_recur:
        return None
    return [] if track.later is None else track.later.violations
