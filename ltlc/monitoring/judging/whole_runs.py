"""Runs that are followed for their letters only, beside the session that judges.

Of a property that is judged from each message on, that is the run which all its instances are parts of; of one for each
id, every slice.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from functools import partial

from ltlc.assurance.evidence.document import StatedSlice
from ltlc.backends.python.load import load_plan
from ltlc.compiler import Compiled
from ltlc.inputs.recordings import Block
from ltlc.monitoring.judging.slice_letters import LetteredSlices, LetteredSlicing
from ltlc.monitoring.later import JudgedTrack
from ltlc.monitoring.letters import Letters
from ltlc.runtime.properties import MonitoredProperty
from ltlc.runtime.rows import ByRows
from ltlc.runtime.sampling import Reading
from ltlc.runtime.session import Session
from ltlc.runtime.slices import Slicing
from ltlc.runtime.tracking import Observer, Track
from ltlc.semantics.durations import Nanoseconds
from ltlc.specification.specification import PropertySpecification, Specification


class WholeRuns:
    """A session of its own, row by row. `letters` are those of properties that are not judged for each id, by label."""

    def __init__(
        self,
        compiled: Sequence[Compiled],
        specification: Specification,
        given: Collection[str],
        kept: Callable[[PropertySpecification], Letters],
    ) -> None:
        """Where samples of the signals that are `given` come in themselves; letters are to be `kept` as this says."""
        specifications = {each.specification.label: each.specification for each in compiled}
        self.letters = {label: kept(of) for label, of in specifications.items() if of.slicing is None}
        plan = load_plan(compiled, specification, given)
        properties = tuple(
            replace(each, slicing=LetteredSlicing(each.slicing, partial(kept, specifications[each.label])))
            if isinstance(each.slicing, Slicing)
            else each
            for each in plan.properties
        )
        self._session = Session(replace(plan, properties=properties), False, None, self._track)
        self._wanted = {signal.name for signal in plan.signals if isinstance(signal, Reading)}

    def _track(self, property_: MonitoredProperty, keep: bool, observer: Observer | None) -> Track:
        return JudgedTrack(property_, keep, observer, False, self.letters.get(property_.label))

    def take(self, block: Block) -> None:
        """Take the rows of `block`."""
        rows = ByRows(self._session)
        for time, names, values, topics in block.rows(self._wanted):
            rows.samples(time, names, values, topics)

    def end(self, time: Nanoseconds) -> None:
        """Nothing comes up to `time` any more."""
        ByRows(self._session).advance(time)

    def slices(self, label: str, end: Nanoseconds) -> tuple[StatedSlice, ...] | str:
        """The slices of a property in a run that ends then; or why evidence does not have them."""
        [found] = (each for each in self._session.sliced if each.track.property.label == label)
        assert isinstance(found, LetteredSlices)
        return found.stated(end)
