"""A run, judged in blocks of rows: by columns where that can be, and with the state that it would have by rows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from time import perf_counter_ns

import numpy as np

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Block, Ragged
from ltlc.monitoring.columns.afterwards import Afterwards
from ltlc.monitoring.columns.atoms import Compared, prepare
from ltlc.monitoring.columns.bits import unpack
from ltlc.monitoring.columns.leaps import walk_and_leap
from ltlc.monitoring.columns.others import Others
from ltlc.monitoring.columns.prepared import Prepared
from ltlc.monitoring.columns.series import Columns, Steps, UnsupportedError
from ltlc.monitoring.columns.slices import BySlices, refusal
from ltlc.monitoring.columns.ticks import Seen
from ltlc.monitoring.columns.tracks import Forward, Stretch, count_invalid, has_ages, stretch, take_together
from ltlc.monitoring.columns.views import View, views_of
from ltlc.monitoring.columns.walk import hear, walk
from ltlc.monitoring.later import is_followed, later_of, letters_of
from ltlc.runtime.properties import MonitoredProperty
from ltlc.runtime.rows import ByRows
from ltlc.runtime.sampling import Reading, Window
from ltlc.runtime.session import Session
from ltlc.runtime.slice_steps import Slices
from ltlc.runtime.ticks import Pace, Paces
from ltlc.runtime.tracking import Track

FIRST = 256
"""So many rows are taken one by one at first where the run must have begun before the end of it is known."""

READ = "the slices were read"
UNTIL_IT_BEGINS = "`_timeout_` counts from the first step"


@dataclass
class Way:
    """How a property is judged: by columns, or, for the reasons in `because` and in so many blocks, by rows.

    Those with the same number `reads` have the same steps. What comes after a violation is judged by the machine that
    is prepared `again`. If it is judged for each id, `slices` do that by columns, or it has the reason why rows do.
    """

    track: Track
    window: Window
    of: Prepared
    again: Prepared
    forward: Forward | None
    reads: int
    because: dict[str, int] = field(default_factory=dict)
    blocks: int = 0
    nanoseconds: int = 0
    slices: BySlices | str = ""

    @property
    def is_stepped(self) -> bool:
        """Whether not all that judges it has tables."""
        return self.forward is None or (later_of(self.track) is not None and self.again.tables is None)

    def count(self, reason: str) -> None:
        """A block more was judged by rows, for this reason."""
        self.because[reason] = self.because.get(reason, 0) + 1


class ByBlocks:
    """Judges a session in blocks.

    Between two blocks the session is as if it had been judged row by row. Where the verdict after each step is listed,
    it is, and so is a block, for those properties concerned, in which something is that columns do not do exactly.
    """

    def __init__(
        self, session: Session, prepared: Sequence[Prepared], again: Mapping[str, Prepared] | None = None
    ) -> None:
        """Take `session` forward, whose plan has the properties that are `prepared`.

        Of those with a machine that restarts, `again` has that one prepared, by label.
        """
        self._session, again = session, again or {}
        is_listed = any(track.verdicts is not None for track in session.tracks)
        self._why = "the verdict after each step is listed" if is_listed else ""
        reads: dict[object, int] = {}
        by_track = dict(zip(map(id, session.tracks), prepared, strict=True))
        self._whole = [
            Way(
                track,
                window,
                of := by_track[id(track)],
                again.get(track.property.label, of),
                None if of.tables is None or track.observer is not None else Forward(track, of, of.tables),
                reads.setdefault((_reads(track.property), has_ages(track)), len(reads)),
            )
            for track, window in session.stepped
        ]
        self._sliced = [self._slices(slices, by_track[id(slices.track)]) for slices in session.sliced]
        self._definitions = {name: definition for of in prepared for name, definition in of.definitions.items()}
        self.nanoseconds = self.by_rows = 0
        self._readings = [signal for signal in session.plan.signals if isinstance(signal, Reading)]
        self._wanted = {reading.name for reading in self._readings}

    @property
    def session(self) -> Session:
        """What is judged, up to the last block taken. Slices that were judged go by rows from then on."""
        for way in self._sliced:
            if isinstance(way.slices, BySlices) and self._session.time is not None:
                way.slices.settle()
                way.slices = READ
        return self._session

    @property
    def ways(self) -> list[Way]:
        """How each property is judged."""
        return [*self._whole, *self._sliced]

    def _slices(self, slices: Slices, of: Prepared) -> Way:
        """How a property is judged for each id."""
        others = Others(self._session, slices.cut, of)
        found: BySlices | str = self._why or refusal(self._session.plan, slices, of, others)
        if not found and of.tables is not None:
            [topic] = slices.cut.keys
            found = BySlices(slices, of, of.tables, self._session.fields[topic], others)
        return Way(slices.track, self._session.sampler.window(()), of, of, None, -1, slices=found)

    def take(self, block: Block) -> None:
        """Take the rows of `block`, all of which come after those before."""
        if not len(block.times):
            return
        for way in self.ways:
            way.blocks += 1
        if self._session.plan.timeout is None:
            self._take_all(block)
            return
        size = FIRST
        while not self._session.has_begun and len(block.times):
            self._by_rows(block.part(0, size), self.ways, "" if size < len(block.times) else UNTIL_IT_BEGINS)
            block, size = block.part(size, len(block.times)), 2 * size
        end = self._session.end
        self._take_all(block.between(None, end))
        self._by_rows(block.between(end + 1, None), self.ways, "")

    def _take_all(self, block: Block) -> None:
        """Take the rows of `block`, none of which is after the end of the run."""
        if not len(block.times):
            return
        if self._why:
            self._by_rows(block, self.ways, self._why)
            return
        rows = Columns(block, self._session.sampler, self._readings)
        try:
            views = views_of(self._session, rows, int(block.times[-1]))
        except UnsupportedError as error:
            self._by_rows(block, self.ways, str(error))
            return
        found: list[tuple[Way, Steps]] = []
        for view in views:
            view.derive(self._session, self._definitions)
            by_reads: dict[int, Steps | UnsupportedError] = {}
            steps = ((way, self._steps(way, view, by_reads)) for way in self._seeing(view))
            found += [(way, of) for way, of in steps if of is not None]
        self._prepare(found)
        taken = self._by_columns(found, rows)
        slow = [way for view in views for way in self._seeing(view) if id(way) not in taken]
        self._wait(views, rows)
        slow += [way for way in self._sliced if not self._take_slices(way, block)]
        if slow:
            self._by_rows(block, slow, "")
        else:
            self._count(rows, views)
        for view in views:
            view.columns.release()

    def _seeing(self, view: View) -> list[Way]:
        """The properties that see `view`."""
        tracks = {id(track) for track in view.tracks}
        return [way for way in self._whole if id(way.track) in tracks]

    def _wait(self, views: Sequence[View], rows: Columns) -> None:
        """What has no ticks yet waits for them."""
        ticking = {id(way) for view in views for way in self._seeing(view)}
        for way in self._whole:
            if id(way) not in ticking and way.track.property.timed and self._session.began is None:
                way.track.begin(int(rows.times[0]))

    def _steps(self, way: Way, view: View, by_reads: dict[int, Steps | UnsupportedError]) -> Steps | None:
        """The steps of a property; None, with the reason kept, if rows have to do."""
        if way.of.counts and way.is_stepped:
            way.count("it counts, and is stepped")
            return None
        if way.reads not in by_reads:
            by_reads[way.reads] = self._steps_of(way, view)
        found = by_reads[way.reads]
        if isinstance(found, Steps):
            return found
        way.count(str(found))
        return None

    def _steps_of(self, way: Way, view: View) -> Steps | UnsupportedError:
        try:
            return view.steps(self._session, way.track, way.window)
        except UnsupportedError as error:
            return error

    def _prepare(self, found: Sequence[tuple[Way, Steps]]) -> None:
        """Compare what properties with the same steps compare with constants."""
        start = perf_counter_ns()
        compare: dict[int, list[Compared]] = {}
        by_steps = {id(steps): steps for _, steps in found}
        for way, steps in found:
            if is_followed(way.track):
                compare.setdefault(id(steps), []).extend(way.of.compare)
        for number, wanted in compare.items():
            prepare(wanted, by_steps[number])
        self.nanoseconds += perf_counter_ns() - start

    def _by_columns(self, found: Sequence[tuple[Way, Steps]], rows: Columns) -> set[int]:
        """Take the steps of properties, and time up to the last of the `rows`.

        What comes back are the ids of those properties that did; of others, the reason is kept.
        """
        taken = [(way, *both) for way, steps in found if (both := self._stretch(way, steps, rows)) is not None]
        start = perf_counter_ns()
        for _, _, afterwards in taken:
            afterwards.begin()
        untimed = ((way.forward, part) for way, part, _ in taken if not way.track.property.timed)
        together = [(forward, part) for forward, part in untimed if forward is not None]
        take_together(together)
        each = (perf_counter_ns() - start) // max(1, len(together))
        for way, part, afterwards in taken:
            start = perf_counter_ns()
            if way.forward is None:
                walk(way.track, part)
            elif way.track.property.timed:
                walk_and_leap(way.forward, part)
            else:
                way.nanoseconds += each
            afterwards.follow(part)
            way.track.hold(int(rows.times[-1]))
            way.track.is_settled = way.track.is_settled and not len(part.steps)
            way.nanoseconds += perf_counter_ns() - start
        return {id(way) for way, _, _ in taken}

    def _stretch(self, way: Way, steps: Steps, rows: Columns) -> tuple[Stretch, Afterwards] | None:
        """The valid steps of a property, the others counted; None, with the reason kept, if rows have to do."""
        start = perf_counter_ns()
        try:
            found, afterwards = stretch(way.track, way.of, steps), Afterwards(way.track, way.again, steps)
        except UnsupportedError as error:
            way.count(str(error))
            return None
        if way.track.property.timed and self._session.began is None:
            way.track.begin(int(rows.times[0]))
        hear(way.track, steps)
        self._skip(way, steps, rows)
        count_invalid(way.track, found)
        if (letters := letters_of(way.track)) is not None:
            letters.take(found.times, [unpack(bits, len(found)) for bits in found.atoms])
        way.nanoseconds += perf_counter_ns() - start
        return found, afterwards

    def _skip(self, way: Way, steps: Steps, rows: Columns) -> None:
        """Count the messages at which something that a property waits for had no value, as rows do."""
        if not steps.first:
            return
        columns, paces = steps.columns, self._session.paces
        last = columns.listed(steps.base)[steps.first - 1]
        for topic in way.window.read:
            if paces is None:
                count = way.track.skipped.get(topic, 0) + _before(rows, topic, int(last))
            else:
                until = int(rows.times.searchsorted(columns.times[last], "right"))
                count = paces.taken[topic] + _before(rows, topic, until - 1)
            if count:
                way.track.skipped[topic] = count

    def _take_slices(self, way: Way, block: Block) -> bool:
        """Whether the slices of a property could take `block`; if not, they go by rows from now on."""
        start = perf_counter_ns()
        if isinstance(way.slices, BySlices):
            try:
                way.slices.take(block)
            except UnsupportedError as error:
                way.slices.settle()
                way.slices = str(error)
        way.nanoseconds += perf_counter_ns() - start
        if isinstance(way.slices, str):
            way.count(way.slices)
        return isinstance(way.slices, BySlices)

    def _by_rows(self, block: Block, ways: Sequence[Way], because: str) -> None:
        """Take the rows of `block` one after the other, for some of the properties."""
        start = perf_counter_ns()
        rows = ByRows(self._session, [way.track for way in ways])
        for time, names, values, topics in block.rows(self._wanted):
            rows.samples(time, names, values, topics)
        for way in ways:
            if because:
                way.count(because)
        self.by_rows += perf_counter_ns() - start

    def _count(self, rows: Columns, views: Sequence[View]) -> None:
        """Take the `rows` as far as no property is concerned; `views` are they, or what ticks see of them."""
        session = self._session
        for view in views:
            if session.paces is not None and view.pace is not None:
                self._count_ticks(rows, view, session.paces, view.pace)
                continue
            columns = view.columns
            together = columns.together(columns.series[each.name].rows for each in self._readings)
            session.steps += columns.number_of(together)
            for name, series in columns.series.items():
                series.add_to(session.sampler, name)
        session.time = int(rows.times[-1])
        session.began = session.began if session.began is not None else int(rows.times[0])
        session.has_begun = session.has_begun or any(track.steps for track in session.tracks)
        for topic in session.messages:
            count = rows.number_of(rows.messages(topic))
            session.messages[topic] += count
            if session.paces is not None:
                session.paces.taken[topic] += count
        not_measured = session.sampler.not_measured
        for name in not_measured:
            values = rows.series[name].values
            if isinstance(values, Ragged):
                not_measured[name] += int(np.isnan(values.elements.astype(np.float64, copy=False)).sum())

    def _count_ticks(self, rows: Columns, view: View, paces: Paces, pace: Pace) -> None:
        """Take the ticks that `view` is of, and keep what comes after them for the next."""
        times = view.columns.times
        paces.begin(pace, view.starting)
        pace.ticks.count += len(times)
        self._session.steps += len(times)
        seen = Seen(times, pace.waiting)
        for topic in pace.topics:
            seen.add(topic, rows, self._session.fields[topic], paces.taken[topic])
            pace.seen[topic] = pace.seen.get(topic, 0) + seen.counts[topic]
        heard = {topic for topic in pace.topics if topic in seen.waiting}
        pace.heard = heard if len(times) else heard | pace.heard
        pace.waiting = seen.waiting
        pace.quiet = 0
        for name in (each.name for each in self._readings if each.topic in pace.topics):
            series = rows.series[name]
            if len(series):
                pace.latest[name] = series.value(len(series) - 1)
        for name, series in view.columns.series.items():
            series.add_to(pace.sampler, name)


def _before(rows: Columns, topic: str, last: int) -> int:
    """How many messages on `topic` there are up to the row `last`."""
    return int(rows.listed(rows.messages(topic)).searchsorted(last, "right"))


def _reads(property_: MonitoredProperty) -> object:
    """What decides which steps a property has."""
    excused = frozenset((property_.inputs[each.place], each.instead) for each in property_.excused)
    return frozenset(property_.inputs), property_.from_session, excused
