"""What a property goes through in a run, for pictures: verdicts, episodes, deadlines and edges, with their times."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import field

from ltlc.dataclass import dataclass
from ltlc.runtime.episodes import Episodes
from ltlc.runtime.properties import Change, Moment, Opening
from ltlc.runtime.tracking import Track
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


class Trailing:
    """Keeps the `trail` of a property."""

    def __init__(self) -> None:
        self.trail = Trail()
        self._open: dict[Episodes, Span] = {}
        self._owed: tuple[int, ...] = ()

    def moved(self, track: Track, before: int, moment: Moment, change: Change | None) -> None:
        """The monitor has come to its state from the state `before`."""
        if change is not None:
            self.trail.changes.append(change)
        state = track.monitor.state
        self.trail.state = state
        self.trail.edges.setdefault((before, state), moment)
        if track.property.timed:
            self._note_owed(track, moment.time)

    def changed(self, change: Change) -> None:
        """The verdict on all slices is new."""
        self.trail.changes.append(change)

    def _note_owed(self, track: Track, time: Nanoseconds) -> None:
        """See whether there is another deadline; only clocks and states change it."""
        is_owed = track.verdict is Verdict.PRESUMABLY_VIOLATED
        dues = (getattr(track.monitor, clock.due) for clock in track.property.clocks)
        owed = (track.monitor.state, *dues) if is_owed else ()
        if owed != self._owed:
            self._owed = owed
            self._note_deadline(track.deadline() if is_owed else None, time)

    def _note_deadline(self, due: Nanoseconds | None, time: Nanoseconds) -> None:
        """From `time` on, time alone violates the property at `due`; None: never."""
        deadlines = self.trail.deadlines
        last = deadlines[-1] if deadlines and deadlines[-1].until is None else None
        if last is not None and last.due != due:
            last.until = time
        if due is not None and (last is None or last.due != due):
            deadlines.append(Deadline(time, due))

    def scoped(self, track: Track, moment: Moment) -> None:
        """Spans begin with the episodes that have opened, and end with those that have closed, or opened anew."""
        open_now = dict(_open_episodes(track.scopes, 0))
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
