"""What a property goes through in a run, for pictures: verdicts, episodes, deadlines and edges, with their times."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from ltlc.runtime.sampling import Value
from ltlc.runtime.tracking import Before, Change, Episodes, Moment, MonitoredProperty, Opening, Track
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.verdicts import Verdict


@dataclass(slots=True)
class Span:
    """An episode of a scope that is inside `depth` others; `closed` is None if it was open when the property ended."""

    opening: Opening
    depth: int
    closed: Moment | None = None


@dataclass(slots=True)
class Deadline:
    """What was owed from `since` on would have violated the property at `due`; from `until` on, it was not due then.

    `until` is None if the run ended before.
    """

    since: Nanoseconds
    due: Nanoseconds
    until: Nanoseconds | None = None


@dataclass(slots=True)
class Trail:
    """All of this of one property, in the order of time.

    `changes` has each change of the verdict, `spans` each episode. `edges` has, for each edge of the monitor's program
    that was taken, as the states that it leads from and to, when that was first; `state` is the last one.
    """

    changes: list[Change] = field(default_factory=list)
    spans: list[Span] = field(default_factory=list)
    deadlines: list[Deadline] = field(default_factory=list)
    edges: dict[tuple[int, int], Moment] = field(default_factory=dict)
    state: int = 0


class TrailingTrack(Track):
    """A track that leaves a `trail`."""

    def __init__(self, property_: MonitoredProperty, keep_verdicts: bool) -> None:
        self.trail = Trail()
        self._open: dict[Episodes, Span] = {}
        self._owed: tuple[int, ...] = ()
        super().__init__(property_, keep_verdicts)

    def step(self, time: Nanoseconds, values: Sequence[Value]) -> Change | None:
        """Judge one more step."""
        before, steps, is_decided = self.monitor.state, self.steps, self.decided_at is not None
        change = super().step(time, values)
        if self.steps > steps and not is_decided:
            self._note(before, steps, time)
        return change

    def _expire(self, moment: Moment) -> Change | None:
        before = self.monitor.state
        change = super()._expire(moment)
        self._note(before, moment.step, moment.time, by_time=True)
        return change

    def _change(self, before: Before, moment: Moment, values: Sequence[Value]) -> Change:
        change = super()._change(before, moment, values)
        self.trail.changes.append(change)
        return change

    def _note(self, before: int, step: int, time: Nanoseconds, *, by_time: bool = False) -> None:
        """The monitor has come here from the state `before`."""
        state = self.monitor.state
        self.trail.state = state
        if (before, state) not in self.trail.edges:
            self.trail.edges[before, state] = Moment(step, time, by_time=by_time)
        if self.property.timed:
            self._note_owed(time)

    def _note_owed(self, time: Nanoseconds) -> None:
        """See whether there is another deadline; only clocks and states change it."""
        is_owed = self.verdict is Verdict.PRESUMABLY_VIOLATED
        dues = (getattr(self.monitor, clock.due) for clock in self.property.clocks)
        owed = (self.monitor.state, *dues) if is_owed else ()
        if owed != self._owed:
            self._owed = owed
            self._note_deadline(self.deadline() if is_owed else None, time)

    def _note_deadline(self, due: Nanoseconds | None, time: Nanoseconds) -> None:
        """From `time` on, time alone violates the property at `due`; None: never."""
        deadlines = self.trail.deadlines
        last = deadlines[-1] if deadlines and deadlines[-1].until is None else None
        if last is not None and last.due != due:
            last.until = time
        if due is not None and (last is None or last.due != due):
            deadlines.append(Deadline(time, due))

    def _open_and_close(self, step: int, time: Nanoseconds, values: Sequence[Value], *, by_time: bool = False) -> None:
        super()._open_and_close(step, time, values, by_time=by_time)
        moment = Moment(step, time, by_time=by_time)
        open_now = dict(_open_episodes(self.scopes, 0))
        for episodes, span in list(self._open.items()):
            if open_now.get(episodes, (0, None))[1] is not span.opening:
                span.closed = moment
                del self._open[episodes]
        for episodes, (depth, opening) in open_now.items():
            if episodes not in self._open:
                self._open[episodes] = Span(opening, depth)
                self.trail.spans.append(self._open[episodes])


def _open_episodes(scopes: Sequence[Episodes], depth: int) -> Iterable[tuple[Episodes, tuple[int, Opening]]]:
    """The episodes that are open, with how many others each is inside."""
    for episodes in scopes:
        if episodes.is_open and episodes.opened is not None:
            yield episodes, (depth, episodes.opened)
            yield from _open_episodes(episodes.inner, depth + 1)
