"""The state of one property during a run, and what is recorded about it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Protocol

from ltlc.runtime.courses import Course
from ltlc.runtime.properties import Change, Moment, MonitoredProperty
from ltlc.runtime.reasons import Before
from ltlc.runtime.sampling import Value
from ltlc.semantics.verdicts import Verdict

if TYPE_CHECKING:
    from ltlc.runtime.slice_steps import Slices


class Observer(Protocol):
    """Is notified of what happens to a property until it is decided."""

    def moved(
        self, track: Track, before: int, moment: Moment, change: Change | None
    ) -> None:
        """A step or clock step was taken from the state `before`."""
        ...

    def scoped(self, track: Track, moment: Moment) -> None:
        """Episodes may have opened and closed."""
        ...

    def changed(self, change: Change) -> None:
        """The verdict on all slices is new."""
        ...


class Track(Course):
    """One property in one run.

    It `began` with its first step, before which so many messages were `skipped` of each
    topic that it reads, because something had no value yet. A verdict that time decided
    was told too late so many times (`delays`). If it is judged for each id, `slices`
    has what is known of these. What is recorded is empty but in a `RecordedTrack`.
    """

    __slots__ = (
        "began",
        "changes",
        "delays",
        "longest_delay",
        "observer",
        "skipped",
        "slices",
        "times",
        "values",
        "verdicts",
    )

    def __init__(self, property_: MonitoredProperty) -> None:
        super().__init__(property_, Counter())
        self.slices: Slices | None = None
        self.began: int | None = None
        self.skipped: dict[str, int] = {}
        self.delays = 0
        self.longest_delay = 0
        self.observer: Observer | None = None
        self.verdicts: list[Verdict] | None = None
        self.times: list[int] = []
        self.values: list[Sequence[Value]] = []
        self.changes: list[Change] = []

    def _change(
        self,
        before: Before,
        step: int,
        time: int,
        values: Sequence[Value],
        *,
        by_time: bool = False,
    ) -> Verdict:
        """The verdict is new, as it is at the first step."""
        if self.began is None:
            self.began = time
        return super()._change(before, step, time, values, by_time=by_time)

    def count_delay(self, delay: int) -> None:
        """A verdict that time decided was reported late by so much."""
        self.delays += 1
        self.longest_delay = max(self.longest_delay, delay)

    @property
    def episodes(self) -> int | None:
        """How many episodes opened; None for a property without scopes."""
        if not self.scopes:
            return None
        courses = () if self.slices is None else self.slices.courses()
        scopes = [*self.scopes, *(scope for one in courses for scope in one.scopes)]
        return sum(scope.count for scope in scopes)

    @property
    def times_violated(self) -> int:
        """How many violations are known; no more than the first is looked for here."""
        return int(self.verdict is Verdict.VIOLATED)

    @property
    def never_triggered(self) -> bool:
        """Whether the property holds only because no scope of it ever opened."""
        holds = self.verdict in (Verdict.SATISFIED, Verdict.PRESUMABLY_SATISFIED)
        return holds and self.episodes == 0


class RecordedTrack(Track):
    """The same, with all that happens told to an `observer`, or recorded.

    If they are kept, `verdicts`, `times` and `values` have one for each step, the last
    what it was judged on, and `changes` all changes of the verdict.
    """

    __slots__ = ()

    def __init__(
        self, property_: MonitoredProperty, keep: bool, observer: Observer | None
    ) -> None:
        super().__init__(property_)
        self.verdicts = [] if keep else None
        self.observer = observer

    def step(self, time: int, values: Sequence[Value]) -> Verdict | None:
        """Judge one more step, to whose time the property was held."""
        state, step = self.monitor.state, self.steps
        was_decided = self.decided_at is not None
        previous = super().step(time, values)
        if self.steps > step and self.verdicts is not None:
            self.verdicts.append(self.monitor.verdict)
            self.times.append(time)
            self.values.append((*self.property.shown(values), *self.kept()))
        if self.steps > step and not was_decided:
            change = None if previous is None else self.change(previous, time)
            self._moved(state, Moment(step, time), change)
        return previous

    def _expire(self, moment: Moment) -> Change | None:
        """Take the clock step that is due at `moment`."""
        state = self.monitor.state
        change = super()._expire(moment)
        self._moved(state, moment, change)
        return change

    def _moved(self, state: int, moment: Moment, change: Change | None) -> None:
        if change is not None and self.verdicts is not None:
            self.changes.append(change)
        if self.observer is not None:
            self.observer.moved(self, state, moment, change)

    def _open_and_close(
        self, step: int, time: int, values: Sequence[Value], *, by_time: bool = False
    ) -> None:
        super()._open_and_close(step, time, values, by_time=by_time)
        if self.observer is not None:
            self.observer.scoped(self, Moment(step, time, by_time=by_time))

    def repeat(self, times: int, at: Iterable[int]) -> None:
        """Judge the last step `times` more times, `at` the times that it gives."""
        steps = self.steps
        super().repeat(times, at)
        if self.steps > steps and self.verdicts is not None:
            self.verdicts += [self.verdict] * times
            self.times += at
            self.values += [self.values[-1]] * times
