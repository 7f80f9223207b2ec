"""A session that takes blocks of rows: by columns where it can, and with the state that row by row it would have."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from time import perf_counter_ns

import numpy as np

from ltlc.backends.python.plan import ScopePart, scopes
from ltlc.columns.atoms import Compared, comparisons, prepare
from ltlc.columns.machine import Slot, machine
from ltlc.columns.series import Columns, Rows, Steps, UnsupportedError
from ltlc.columns.tables import Tables
from ltlc.columns.ticks import MOST, Seen, block_of, times_of
from ltlc.columns.tracks import Forward, Stretch, count_invalid, stretch, take_together
from ltlc.columns.values import value
from ltlc.columns.walk import hear, walk
from ltlc.compiler import Compiled
from ltlc.recordings.blocks import Block, Places, Ragged
from ltlc.recordings.trails import TrailingTrack
from ltlc.runtime.sampling import Derived, Reading, Window
from ltlc.runtime.session import Plan, Session, Ticks
from ltlc.runtime.tracking import Track
from ltlc.source import Source
from ltlc.specification.atoms import Atom
from ltlc.specification.expressions import Expression, Field, Signal, inputs
from ltlc.specification.shapes import renamed

Known = dict[object, Tables | None]
"""The tables of properties by their shapes; None where there are none."""


@dataclass
class Way:
    """How a property is judged: by columns, or, for the reasons in `because` and in so many blocks, by rows."""

    track: Track
    window: Window
    atoms: tuple[Atom, ...]
    forward: Forward | None
    because: dict[str, int] = field(default_factory=dict)
    blocks: int = 0
    nanoseconds: int = 0

    @cached_property
    def compare(self) -> tuple[Compared, ...]:
        """What is compared with constants."""
        return comparisons(self.atoms)

    def count(self, reason: str) -> None:
        """A block more was judged by rows, for this reason."""
        self.because[reason] = self.because.get(reason, 0) + 1


class BlockSession(Session):
    """A session over blocks.

    Between two blocks it is a session as any other. Where the verdict after each step is listed, all is judged row by
    row, and so is a block, for those properties concerned, in which something is that columns do not do exactly.
    """

    def __init__(
        self,
        plan: Plan,
        compiled: Sequence[Compiled],
        source: Source,
        known: Known,
        keep_verdicts: bool = False,
        track: type[Track] = Track,
    ) -> None:
        """`plan` has the properties `compiled`, of a file `source`; what is `known` saves work, and gets more."""
        super().__init__(plan, keep_verdicts, track)
        self._pairs = list(self._stepped)
        self._clocked = list(self._timed)
        self._why = "the verdict after each step is listed" if keep_verdicts else ""
        self.ways = [
            Way(track, window, of.specification.atoms, _forward(track, of, source, known))
            for (track, window), of in zip(self._pairs, compiled, strict=True)
        ]
        signals = (i.signal for of in compiled for i in of.specification.inputs())
        self._definitions = {name: definition for signal in signals for name, definition in _definitions(signal)}
        self.nanoseconds = self.by_rows = 0
        self._readings = [signal for signal in plan.signals if isinstance(signal, Reading)]
        self._wanted = {reading.name for reading in self._readings}

    def take(self, block: Block) -> None:
        """Take the rows of `block`, all of which come after those before."""
        if not len(block.times):
            return
        for way in self.ways:
            way.blocks += 1
        if self.plan.timeout is None:
            self._take_all(block)
        elif not self._has_begun:
            self._by_rows(block, self.ways, "`_timeout_` counts from the first step")
        else:
            self._take_all(block.between(None, self._end))
            self._by_rows(block.between(self._end + 1, None), self.ways, "")

    def _take_all(self, block: Block) -> None:
        """Take the rows of `block`, none of which is after the end of the run."""
        if not len(block.times):
            return
        if self._why:
            self._by_rows(block, self.ways, self._why)
            return
        rows = Columns(block, self.sampler, self._readings)
        try:
            columns = rows if self.plan.rate is None else self._at_ticks(rows)
        except UnsupportedError as error:
            self._by_rows(block, self.ways, str(error))
            return
        self._derive(columns)
        found = [(way, steps) for way in self.ways if (steps := self._steps(way, columns)) is not None]
        self._prepare(found)
        taken = self._by_columns(found, rows)
        slow = [way for way in self.ways if id(way) not in taken]
        if slow:
            self._by_rows(block, slow, "")
        else:
            self._count(rows, columns)
        columns.release()

    def _at_ticks(self, rows: Columns) -> Columns:
        """What the ticks before the last of the rows see. Raises UnsupportedError."""
        ticks = self._ticks or self._first_tick(rows)
        end = int(rows.times[-1])
        if ticks.before(end) > max(MOST, rows.count):
            raise UnsupportedError("there are far more ticks than rows")
        heard = {topic: topic in self._heard for topic in self.messages}
        block = block_of(rows, times_of(ticks, end), self._latest, heard)
        return Columns(block, self.sampler, self._readings, are_ticks=True)

    def _first_tick(self, rows: Columns) -> Ticks:
        """Ticks from the first row on, if there is a message in it. Raises UnsupportedError."""
        assert self.plan.rate is not None
        if not any(rows.number_of(of) and rows.listed(of)[0] == 0 for of in map(rows.messages, self.messages)):
            raise UnsupportedError("no message comes in the first row")
        return Ticks(self.plan.rate, int(rows.times[0]))

    def _derive(self, columns: Columns) -> None:
        """Compute the signals that are computed from others."""
        for signal in self.plan.signals:
            if not isinstance(signal, Derived):
                continue
            if not signal.inputs:
                columns.add_constant(signal.name)
                continue
            try:
                steps = columns.steps(signal.inputs)
                found = value(self._definitions[signal.name], steps)
                columns.add(signal.name, steps, np.broadcast_to(found, len(steps)))
            except UnsupportedError as error:
                columns.lack(signal.name, str(error))

    def _steps(self, way: Way, columns: Columns) -> Steps | None:
        """The steps of a property; None, with the reason kept, if rows have to do."""
        also: list[Rows] = []
        if self.plan.rate is not None:
            also += [None] if way.window.topics else []
        elif way.track.property.from_session and self.began is None:
            also += [np.zeros(1, np.int64)]
        try:
            return columns.steps(way.window.inputs, way.window.topics, also)
        except UnsupportedError as error:
            way.count(str(error))
            return None

    def _prepare(self, found: Sequence[tuple[Way, Steps]]) -> None:
        """Compare what properties with the same steps compare with constants."""
        start = perf_counter_ns()
        compare: dict[int, list[Compared]] = {}
        by_steps = {id(steps): steps for _, steps in found}
        for way, steps in found:
            if way.track.decided_at is None:
                compare.setdefault(id(steps), []).extend(way.compare)
        for number, wanted in compare.items():
            prepare(wanted, by_steps[number])
        self.nanoseconds += perf_counter_ns() - start

    def _by_columns(self, found: Sequence[tuple[Way, Steps]], rows: Columns) -> set[int]:
        """Take the steps of properties, and time up to the last of the `rows`.

        What comes back are the ids of those properties that did; of others, the reason is kept.
        """
        taken = [(way, part) for way, steps in found if (part := self._stretch(way, steps, rows)) is not None]
        start = perf_counter_ns()
        together = [(way.forward, part) for way, part in taken if way.forward is not None]
        take_together(together)
        each = (perf_counter_ns() - start) // max(1, len(together))
        for way, part in taken:
            start = perf_counter_ns()
            if way.forward is None:
                walk(way.track, part)
            way.track.hold(int(rows.times[-1]))
            way.track.is_settled = way.track.is_settled and not len(part.steps)
            way.nanoseconds += perf_counter_ns() - start + (each if way.forward is not None else 0)
        return {id(way) for way, _ in taken}

    def _stretch(self, way: Way, steps: Steps, rows: Columns) -> Stretch | None:
        """The valid steps of a property, the others counted; None, with the reason kept, if rows have to do."""
        start = perf_counter_ns()
        try:
            found = stretch(way.track, way.atoms, steps)
        except UnsupportedError as error:
            way.count(str(error))
            return None
        if way.track.property.timed and self.began is None:
            way.track.begin(int(rows.times[0]))
        hear(way.track, steps)
        count_invalid(way.track, found)
        way.nanoseconds += perf_counter_ns() - start
        return found

    def _by_rows(self, block: Block, ways: Sequence[Way], because: str) -> None:
        """Take the rows of `block` one after the other, for some of the properties."""
        start = perf_counter_ns()
        tracks = {id(way.track) for way in ways}
        self._stepped = [(way.track, way.window) for way in ways]
        self._timed = [track for track in self._clocked if id(track) in tracks]
        for time, names, values, topics in block.rows(self._wanted):
            self.samples(time, names, values, topics)
        self._stepped, self._timed = self._pairs, self._clocked
        for way in ways:
            if because:
                way.count(because)
        self.by_rows += perf_counter_ns() - start

    def _count(self, rows: Columns, columns: Columns) -> None:
        """Take the `rows` as far as no property is concerned; `columns` are they, or what ticks see of them."""
        if self.plan.rate is not None:
            self._count_ticks(rows, columns.times)
        self.steps += columns.number_of(columns.together(columns.series[each.name].rows for each in self._readings))
        self.time = int(rows.times[-1])
        self.began = self.began if self.began is not None else int(rows.times[0])
        self._has_begun = self._has_begun or any(track.steps for track in self.tracks)
        for topic in self.messages:
            count = rows.number_of(rows.messages(topic))
            self.messages[topic] += count
            self._taken[topic] += count
        for name in self.sampler.not_measured:
            values = rows.series[name].values
            if isinstance(values, Ragged):
                self.sampler.not_measured[name] += int(np.isnan(values.elements.astype(np.float64)).sum())
        for name, series in columns.series.items():
            series.add_to(self.sampler.samples[name])

    def _count_ticks(self, rows: Columns, times: Places) -> None:
        """Take the ticks at `times`, and keep what comes after them for the next."""
        self._ticks = self._ticks or self._first_tick(rows)
        self._ticks.count += len(times)
        seen = Seen(times, self._waiting)
        for topic, names in self._fields.items():
            seen.add(topic, rows, names, self._taken[topic])
            self._seen[topic] += seen.counts[topic]
        heard = {topic for topic in self._fields if topic in seen.waiting}
        self._heard = heard if len(times) else heard | self._heard
        self._waiting = seen.waiting
        self._quiet_ticks = 0
        for name in (each.name for each in self._readings):
            series = rows.series[name]
            if len(series):
                self._latest[name] = series.value(len(series) - 1)


def _forward(track: Track, of: Compiled, source: Source, known: Known) -> Forward | None:
    """What takes a track forward by tables; None if there are none."""
    if track.property.timed or isinstance(track, TrailingTrack):
        return None
    slots = tuple(_slots(scopes(of.specification, source), None, 0))
    names = {atom: str(number) for number, atom in enumerate(of.specification.alphabet.atoms)}
    key = renamed((of.monitor, of.specification.alphabet, slots), names)
    if key not in known:
        made = machine(*key)
        known[key] = Tables(made) if made is not None and made.stutters else None
    tables = known[key]
    if tables is None:
        return None
    return Forward(track, tables, slots, of.specification.alphabet.atoms, of.monitor.verdicts)


def _slots(parts: Sequence[ScopePart], parent: int | None, first: int) -> Iterator[Slot]:
    """The scopes of a property, each before those in its body; `first` is the number of the first one."""
    for part in parts:
        inside = list(_slots(part.inner, first, first + 1))
        yield Slot(part.opening, part.closing, part.overlapping, parent)
        yield from inside
        first += 1 + len(inside)


def _definitions(signal: Signal) -> Iterator[tuple[str, Expression]]:
    """What signals are computed from: `signal`, and those that it is computed from."""
    if not isinstance(signal.definition, Field):
        yield signal.name, signal.definition
        for part in inputs(signal.definition):
            yield from _definitions(part.signal)
