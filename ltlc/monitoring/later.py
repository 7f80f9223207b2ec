"""All violations of a property: the first one decides its verdict, and these come after it.

After a violation, from the next instant on, the rest of the run is judged anew, as if the property began there; what it
says of the past is said of the whole run. The violation lasts up to the first instant at which the property, judged so,
is neither violated nor owes anything. So of `never p` there is a violation for each stretch in which p holds; of a
response one for each trigger that has no answer in time, up to the answer; of `after_until` one for each episode, if
what opens it does not hold any more.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Iterable, Sequence
from copy import copy
from typing import TYPE_CHECKING, Any, NamedTuple

from ltlc.dataclass import dataclass
from ltlc.runtime.courses import Course
from ltlc.runtime.episodes import Episodes, latest
from ltlc.runtime.properties import Failure, Moment, MonitoredProperty
from ltlc.runtime.reasons import Before
from ltlc.runtime.sampling import New, Value
from ltlc.runtime.times import NEVER
from ltlc.runtime.tracking import Observer, RecordedTrack, Track
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.verdicts import Verdict

if TYPE_CHECKING:
    from ltlc.monitoring.letters import Letters

MOST = 1000
"""After so many violations of a property no more are looked for."""


class _Out(NamedTuple):
    """An instant that violated a property, and the state that this left; nothing has come since."""

    time: Nanoseconds
    state: tuple[object, ...]


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


class Later(Course):
    """A property before and after its first violation: all its `violations`.

    Where it `is_out`, the last instant, which was at `_last`, violated it, so that it begins anew at the next one. By
    itself it is followed from its first violation on; if its monitor `restarts`, from the beginning of the session.
    """

    __slots__ = ("_has_news", "_last", "_out", "_renewed_at", "is_out", "restarts", "skipped", "violations")

    def __init__(self, property_: MonitoredProperty, restarts: bool) -> None:
        super().__init__(property_, Counter())
        self.violations: list[Violation] = []
        self.skipped = 0
        """How many messages made no step before it was followed."""
        self.is_out = False
        self.restarts = restarts
        self._last = self._renewed_at = -NEVER
        self._out: _Out | None = None
        self._has_news = any(isinstance(wanted, New) for wanted in property_.inputs)

    @classmethod
    def after(cls, track: Track, first: Failure) -> Later:
        """What goes on from where a track was violated."""
        later = cls(track.property, restarts=False)
        later.monitor, later.watchers, later.skipped = copy(track.monitor), track.watchers.fork(), track.invalid
        later.steps, later.judged_on = track.steps, track.judged_on
        later.violations.append(violation_at(first))
        later.verdict, later.is_out, later._last = Verdict.VIOLATED, True, first.time
        return later

    @property
    def is_over(self) -> bool:
        """Whether no violation can come any more, or none is looked for."""
        is_satisfied = not self.is_out and self.verdict is Verdict.SATISFIED
        return is_satisfied or len(self.violations) >= MOST

    @property
    def lasts(self) -> bool:
        """Whether a violation goes on."""
        return bool(self.violations) and self.violations[-1].until is None

    @property
    def due(self) -> int:
        """When the next instant comes that is not as the last one, unless a step comes first."""
        return self._last + 1 if self.is_out else super().due

    def hear(self, time: int, signals: Container[str]) -> None:
        """Messages come: ages count anew. If no step is taken now, that is an instant of its own."""
        self.hold(time)
        super().hear(time, signals)
        self._renewed_at = time

    def renew(self, time: int) -> list[Any]:
        """Take the instant at which a late age is young, by what makes no step."""
        renewed, self._renewed = self._renewed, ()
        if renewed and self.steps:
            for monitor in renewed:
                monitor.due = time - 1
            if self.is_out:
                self._last = time - 1
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
            else:
                self._take(due)
                self._watch(due)
                self._expire(Moment(self.steps - 1, due, by_time=True))
            lasts, out = self.lasts, self._out
            if self._settle(due):
                self._out = _Out(due, self._state())
                if lasts and out is not None and out.state == self._out.state:
                    self._repeat(due - out.time, time)
        self._watch(time)

    def _try(self, time: Nanoseconds) -> None:
        """The property begins anew with what is held."""
        held, steps = self._held(), self.steps
        self._begin_anew(time)
        if not self.restarts:
            super().step(time, held[: len(self.property.inputs)])
            self.steps = steps
            return
        self.monitor.due = time - 1
        self._take(time)
        self._watch(time)
        self._open_and_close(steps - 1, time, self._held(), by_time=True)
        self._expire(Moment(steps - 1, time, by_time=True))

    def _repeat(self, period: Nanoseconds, until: Nanoseconds) -> None:
        """What is held has violated it once more, so long after: so it will, as long as it is held.

        Unless a clock of the past comes due. In between it may be open.
        """
        last = min((due for due in self._dues() if due >= self._last), default=NEVER)
        if period > 1:
            last = min(last, until)
        self._last += max(0, last - self._last) // period * period
        if self.restarts:
            self.monitor.due = self._last

    def step(self, time: int, values: Sequence[Value]) -> Verdict | None:
        """Judge one more step."""
        self.hold(time)
        if self.is_over:
            self.steps += 1
            return None
        was_out, last, steps, before = self.is_out, self.monitor, self.steps, self._state()
        if was_out:
            self._begin_anew(time)
        super().step(time, values)
        if self.steps == steps:  # it was no step
            if was_out:
                self.monitor, self.verdict = last, Verdict.VIOLATED
            return None
        self._out = None
        if self._settle(time) and not self._has_news:
            # Of what begins anew without news, the next instant says what this one did.
            self._out = _Out(time, self._state())
            if was_out and before == self._out.state:
                self._repeat(1, time)
        is_alike = self.is_out or not self.violations or self.due >= NEVER
        self.is_settled &= was_out == self.is_out and is_alike
        return None

    def _begin_anew(self, time: Nanoseconds) -> None:
        """The property begins at this instant."""
        self._passed, self.scopes = (), tuple(map(Episodes, self.property.scopes))
        if self.restarts:
            return
        last, make = self.monitor, self.property.monitor
        self.monitor = make(time) if self.property.timed else make()
        for age in self.property.ages:  # which count from messages, whatever begins anew
            setattr(self.monitor, age.due, getattr(last, age.due))
        self.verdict, self.decided_at = Verdict.NOT_STARTED, None

    def _dues(self) -> tuple[int, ...]:
        """When each clock is due."""
        return self.property.dues(self.monitor) if self.property.timed else ()

    def _state(self) -> tuple[object, ...]:
        """What decides how it goes on from a violation, as long as the same is held."""
        return (self.monitor.state, *self._dues())

    def _settle(self, time: Nanoseconds) -> bool:
        """Whether the instant violates the property; it may be the first one, or the first one after that."""
        lasts = self.lasts
        self.is_out = self.verdict is Verdict.VIOLATED
        if self.is_out:
            self._last = time
            if not lasts and self.decided_at is not None:
                self.violations.append(violation_at(self.decided_at))
            if len(self.violations) < MOST:
                self.decided_at = None  # it goes on
        elif lasts and self.verdict is not Verdict.PRESUMABLY_VIOLATED:
            self.violations[-1].until = time
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

    That is judged by `again`, the property with a machine that restarts, if it needs one. While it `is_apart`, what
    takes the track forward does not take `later` along. Its `letters` are kept if they are wanted.
    """

    __slots__ = ("can_recur", "is_apart", "later", "letters")

    def __init__(
        self,
        property_: MonitoredProperty,
        keep: bool,
        observer: Observer | None,
        can_recur: bool,
        letters: Letters | None = None,
        again: MonitoredProperty | None = None,
    ) -> None:
        self.can_recur, self.is_apart, self.letters = can_recur, False, letters
        self.later = None if again is None else Later(again, restarts=True)
        super().__init__(property_, keep, observer)

    @property
    def times_violated(self) -> int:
        """How many violations were found."""
        return super().times_violated if self.later is None else len(self.later.violations)

    @property
    def _along(self) -> Later | None:
        """What is taken along."""
        return None if self.is_apart else self.later

    def begin(self, session: int) -> None:
        """The session begins; ages count from then."""
        super().begin(session)
        if self.later is not None:
            self.later.begin(session)

    def step(self, time: int, values: Sequence[Value]) -> Verdict | None:
        """Judge one more step, to whose time the property was held."""
        later, steps = self._along, self.steps
        if later is not None:
            later.step(time, values)
        previous = super().step(time, values)
        if later is not None:
            self.is_settled &= later.is_settled
        if self.letters is not None:
            self.letters.step(time, self.property.given(values) if self.steps > steps else None)
        return previous

    def hold(self, time: int) -> list[Any]:
        """Take the clock steps up to and including `time`, with no step until then."""
        changes = super().hold(time)
        if (later := self._along) is not None:
            later.hold(time)
        return changes

    def hear(self, time: int, signals: Container[str]) -> None:
        """Messages come: the ages of these signals count anew, whatever the values."""
        super().hear(time, signals)
        if self.letters is not None:
            self.letters.hear(time, signals)
        if (later := self._along) is not None:
            later.hear(time, signals)

    def repeat(self, times: int, at: Iterable[int]) -> None:
        """Judge the last step `times` more times, `at` the times that it gives."""
        steps = self.steps
        super().repeat(times, at)
        if self.letters is not None:
            self.letters.repeat(self.steps - steps)
        if (later := self._along) is not None:
            later.repeat(times, ())

    def _change(
        self, before: Before, step: int, time: int, values: Sequence[Value], *, by_time: bool = False
    ) -> Verdict:
        previous = super()._change(before, step, time, values, by_time=by_time)
        is_first = self.verdict is Verdict.VIOLATED and self.later is None
        if self.can_recur and is_first and self.decided_at is not None:
            self.later = Later.after(self, self.decided_at)
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
