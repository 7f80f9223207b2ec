"""What the properties of a session see of a block of rows: these, or what ticks see of them; and their steps there."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from ltlc.dataclass import dataclass
from ltlc.monitoring.columns.derived import derive
from ltlc.monitoring.columns.prepared import Definition
from ltlc.monitoring.columns.series import Columns, Rows, Steps, UnsupportedError
from ltlc.monitoring.columns.ticks import MOST, block_of, times_of
from ltlc.monitoring.columns.tracks import has_ages
from ltlc.runtime.sampling import Derived, Reading, Window
from ltlc.runtime.session import Session
from ltlc.runtime.ticks import Pace, Paces, Waiting
from ltlc.runtime.tracking import Track
from ltlc.semantics.durations import Nanoseconds


@dataclass(frozen=True)
class View:
    """What the properties of `tracks` see of a block: its rows, or the ticks of `pace`.

    Those ticks begin for the properties in `starting`.
    """

    columns: Columns
    tracks: Sequence[Track]
    pace: Pace | None = None
    starting: Sequence[Waiting] = ()

    def has(self, topics: frozenset[str]) -> bool:
        """Whether it has what is read from `topics`."""
        return self.pace is None or topics <= self.pace.topics.union(*(read for _, read in self.starting))

    def derive(self, session: Session, definitions: Mapping[str, Definition]) -> None:
        """Compute the signals of `session` that are computed from others."""
        topics = session.sampler.topics
        signals = [s for s in session.plan.signals if isinstance(s, Derived) and self.has(topics[s.name])]
        derive(self.columns, signals, session.sampler, definitions)

    def steps(self, session: Session, track: Track, window: Window) -> Steps:
        """Those of a property, which looks at `window`. Raises UnsupportedError."""
        also: list[Rows] = []
        if self.pace is not None and has_ages(track):
            raise UnsupportedError("messages between ticks, from which ages count")
        if self.pace is not None:
            also += [None] if window.topics or track.property.from_session else []
        elif track.property.from_session and session.began is None:
            also += [np.zeros(1, np.int64)]
        return self.columns.steps(window.inputs, window.topics, also, track.property.excused)


def views_of(session: Session, rows: Columns, before: Nanoseconds) -> list[View]:
    """What is seen of `rows`, which `session` takes next: in ticks, those that come `before` a time.

    Raises UnsupportedError.
    """
    if session.paces is None:
        return [View(rows, [track for track, _ in session.stepped])]
    return _at_ticks(session, session.paces, rows, before)


def _at_ticks(session: Session, paces: Paces, rows: Columns, before: Nanoseconds) -> list[View]:
    """A view for each time at which ticks begin."""
    starting: dict[int, list[Waiting]] = {}
    for track, topics in paces.waiting:
        first = 0 if track.property.from_session and session.began is None else _first_row(rows, topics)
        if first is not None:
            starting.setdefault(int(rows.times[first]), []).append((track, topics))
    views = []
    for pace in paces.begun:
        more = [] if pace.ticks.count else starting.pop(pace.ticks.start, [])
        views.append(_view(session, pace, more, rows, before))
    return [
        *views,
        *(_view(session, paces.new(start), more, rows, before) for start, more in sorted(starting.items())),
    ]


def _view(session: Session, pace: Pace, starting: Sequence[Waiting], rows: Columns, before: Nanoseconds) -> View:
    """What the ticks of `pace`, which those of `starting` join, see of the rows."""
    if pace.ticks.before(before) > max(MOST, rows.count):
        raise UnsupportedError("there are far more ticks than rows")
    topics = pace.topics.union(*(read for _, read in starting))
    block = block_of(rows, times_of(pace.ticks, before), pace.latest, {topic: topic in pace.heard for topic in topics})
    readings = [each for each in session.plan.signals if isinstance(each, Reading) and each.topic in topics]
    columns = Columns(block, pace.sampler, readings, are_ticks=True)
    return View(columns, [track for track, _ in (*pace.stepped, *starting)], pace, starting)


def _first_row(rows: Columns, topics: Iterable[str]) -> int | None:
    """The first of the rows with a message on one of `topics`."""
    found = (rows.messages(topic) for topic in topics)
    return min((int(rows.listed(of)[0]) for of in found if rows.number_of(of)), default=None)
