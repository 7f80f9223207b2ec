"""A property of each id, to be measured: the steps of its slices, which are kept though they are decided."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field, replace
from heapq import heapify, heappop, heappush

import numpy as np

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Array, Block, Places, Ragged
from ltlc.monitoring.columns.arrays import ByStep, side_by_side, views_of
from ltlc.monitoring.columns.bits import Mask
from ltlc.monitoring.columns.curves import Band, Curve, Run, first_with
from ltlc.monitoring.columns.margins import margins_of
from ltlc.monitoring.columns.prepared import Prepared
from ltlc.monitoring.columns.robustness import at_steps, still_possible
from ltlc.monitoring.columns.series import Columns, Given, UnsupportedError
from ltlc.monitoring.columns.timeline import Timeline
from ltlc.monitoring.columns.values import as_doubles, not_numbers
from ltlc.program.expressions import Read
from ltlc.runtime.rows import ByRows
from ltlc.runtime.sampling import Reading, Value, mark
from ltlc.runtime.session import Plan, Session
from ltlc.runtime.slice_ids import Ids, Slice
from ltlc.runtime.slice_keys import Cut, Id, Part
from ltlc.runtime.slice_steps import Slices
from ltlc.runtime.slices import Slicing
from ltlc.runtime.tracking import Track
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.robustness import TRUE
from ltlc.specification.specification import PropertySpecification


@dataclass(frozen=True)
class KeptSlicing:
    """Cuts a run as `by` does, and judges nothing."""

    by: Slicing

    def start(self, track: Track, session: Session) -> Slices:
        """Keep the steps of the property of `track`, in a session that begins."""
        cut = Cut(self.by.signals, self.by.keys, self.by.variable, track.property)
        return KeptSlices(track, session, cut, Ids(self.by.limit), frozenset())


@dataclass(frozen=True)
class Steps:
    """Those of a slice: their `times`, and the `values` of what the property reads.

    Before the first message at a step, ages count from `since`, by the names of signals.
    """

    times: list[Nanoseconds] = field(default_factory=list)
    values: list[Sequence[Value]] = field(default_factory=list)
    since: dict[str, Nanoseconds] = field(default_factory=dict)


class KeptSlices(Slices):
    """Slices with all of their steps. None is decided, since later steps change how much it is violated by."""

    def __init__(self, track: Track, session: Session, cut: Cut, ids: Ids, as_new: frozenset[int]) -> None:
        super().__init__(track, session, cut, ids, as_new)
        self.steps: dict[Id, Steps] = {}

    def _born(self, time: int, id_: Id) -> Slice:
        shared = {signal: self._last_heard.get(signal, self._begins) for signal in self.cut.shared_ages}
        self.steps[id_] = Steps(since=dict.fromkeys(self.cut.own_ages, time) | shared)
        return super()._born(time, id_)

    def _give(self, time: int, one: Slice, part: Part, given: Sequence[Value]) -> None:
        if not one.steps:
            self.steps[one.id].since.update(dict.fromkeys(part.aged, time))
        part.take(one.known, time, given)
        if part.is_step or self._begins_now(one):
            self._step(time, one)
        if part.news:
            mark(one.known, part.news, is_new=False)

    def _step(self, time: int, one: Slice) -> None:
        values = self._look(one.known)
        if not one.steps and None in values and not one.property.is_ready(values):
            return
        if not self.session.has_begun:
            self.session.begin_run(time)
        one.steps += 1
        kept = self.steps[one.id]
        kept.times.append(time)
        kept.values.append(self.track.property.given(values))


class OfIds:
    """By how much a property of each id holds: by the least of what it does on a slice."""

    def __init__(self, of: PropertySpecification, prepared: Prepared, slices: KeptSlices, reason: str) -> None:
        """If there is a `reason`, it cannot be measured."""
        self._of = of
        self._prepared = prepared
        self._slices = slices
        self._heard = {news: self._of.arrival(news).signal.name for news in self._of.messages()}
        self._reason = reason

    def curve(self, began: Nanoseconds, end: Nanoseconds) -> Curve:
        """What it comes to in a run up to `end`, in a session that `began` then."""
        try:
            runs = self._runs(began, end)
            found = {id_: at_steps(self._of.property, *run) for id_, run in runs.items()}
        except UnsupportedError as error:
            return Curve(reason=str(error))
        if not runs:
            return Curve()
        id_ = min(found, key=lambda each: float(found[each][0]))
        line, margins, _ = runs[id_]
        decided = first_with(abs(float(found[id_][0])), margins, line.times)
        times, least = _least([(runs[each][0].times, found[each]) for each in runs])
        return Curve(times, least, decided=decided and (decided[0], self._of.as_written(decided[1])), id=id_)

    def band(self, began: Nanoseconds, end: Nanoseconds) -> Band:
        """What it can still come to in a run that has got to `end`: another id can come, of which nothing is known."""
        try:
            runs = self._runs(began, end).values()
            return Band(high=min((still_possible(self._of.property, *run)[1] for run in runs), default=TRUE))
        except UnsupportedError as error:
            return Band(reason=str(error))

    def _runs(self, began: Nanoseconds, end: Nanoseconds) -> dict[Id, Run]:
        """The slices with a step by then, each as a run. Raises UnsupportedError."""
        if self._reason:
            raise UnsupportedError(self._reason)
        if self._slices.left_out:
            raise UnsupportedError("messages were ignored for which there was no place")
        kept = [(id_, steps) for id_, steps in self._slices.steps.items() if steps.times and steps.times[0] <= end]
        if not kept:
            return {}
        times = np.array([time for _, steps in kept for time in steps.times], np.int64)
        margins, valid = self._margins([values for _, steps in kept for values in steps.values])
        found: dict[Id, Run] = {}
        last = 0
        for id_, steps in kept:
            first, last = last, last + len(steps.times)
            there = first + np.flatnonzero(valid[first:last] & (times[first:last] <= end))
            if len(there):
                since = {news: steps.since.get(signal, began) for news, signal in self._heard.items()}
                of_slice = {name: each[there] for name, each in margins.items()}
                found[id_] = Timeline(times[there], end), of_slice, since
        return found

    def _margins(self, values: Sequence[Sequence[Value]]) -> tuple[dict[str, Array], Mask]:
        """Those of the atoms where inputs have these `values`, and whether that makes a step."""
        inputs = zip(self._prepared.inputs, zip(*values, strict=True), strict=True)
        known = {read: _column(read, of_read) for read, of_read in inputs}
        nothing = Columns(Block(np.empty(0, np.int64), {}, {}), self._slices.session.sampler, [])
        given = Given(nothing, None, 0, known, count=len(values))
        invalid = not_numbers(self._prepared.guards, given)
        if invalid is not None and self._heard:
            raise UnsupportedError("messages that make no step, from which ages count")
        margins = {atom.name: margins_of(atom.condition, given) for atom in self._of.atoms}
        return margins, np.ones(len(values), np.bool_) if invalid is None else ~invalid


def _least(curves: Sequence[tuple[Places, Array]]) -> tuple[Places, Array]:
    """The steps of all slices, and at each the least that a slice has from there on.

    That is what it has at its latest step, or at its first if that is still to come.
    """
    times = np.concatenate([times for times, _ in curves])
    slices = np.arange(len(curves)).repeat([len(times) for times, _ in curves])
    margins = np.concatenate([margins for _, margins in curves])
    order = times.argsort(kind="stable")
    firsts = np.cumsum([0, *(len(times) for times, _ in curves[:-1])])
    latest = firsts.tolist()
    waiting = [(float(margins[first]), first, number) for number, first in enumerate(latest)]
    heapify(waiting)
    found = np.empty(len(times))
    for place, step in enumerate(order.tolist()):
        of = int(slices[step])
        if latest[of] != step:
            latest[of] = step
            heappush(waiting, (float(margins[step]), step, of))
        while latest[waiting[0][2]] != waiting[0][1]:
            heappop(waiting)
        found[place] = waiting[0][0]
    return times[order], found


class KeptRuns:
    """The slices of a recording, whose rows it takes, of the properties of a `plan` that are judged for each id."""

    def __init__(self, plan: Plan) -> None:
        properties = tuple(
            replace(each, slicing=KeptSlicing(each.slicing))
            for each in plan.properties
            if isinstance(each.slicing, Slicing)
        )
        self._session = Session(replace(plan, properties=properties, guards=(), rate=None))
        self._wanted = {signal.name for signal in plan.signals if isinstance(signal, Reading)}

    def take(self, block: Block) -> None:
        """Take the rows of `block`, if any property is judged so."""
        rows = ByRows(self._session)
        for time, names, values, topics in block.rows(self._wanted) if self._session.sliced else ():
            rows.samples(time, names, values, topics)

    def of(self, label: str) -> KeptSlices | None:
        """The slices of a property; None if it is not judged for each id."""
        found = (each for each in self._session.sliced if each.track.property.label == label)
        slices = next(found, None)
        assert slices is None or isinstance(slices, KeptSlices)
        return slices


def _column(read: Read, values: Sequence[Value]) -> Array | ByStep:
    """What is `read` at steps, where it has these `values`. Raises UnsupportedError."""
    if not read.type.is_array:
        return as_doubles(side_by_side(values))
    arrays = [each for each in values if isinstance(each, tuple)]
    lengths = np.array([len(array) for array in arrays], np.int64)
    elements = side_by_side([element for array in arrays for element in array])
    return ByStep(views_of(Ragged(elements, lengths)), np.arange(len(arrays)))
