"""The margins of a recorded run, gathered block by block beside the session that judges it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ltlc.compiler import Compiled
from ltlc.inputs.recordings.blocks import Array, Block, Places
from ltlc.monitoring.columns.curves import Band, Curve, Run, first_with
from ltlc.monitoring.columns.each_id import KeptRuns, OfIds
from ltlc.monitoring.columns.margins import combined, margins_of
from ltlc.monitoring.columns.opening import of_whole_run, whole_runs
from ltlc.monitoring.columns.prepared import Prepared
from ltlc.monitoring.columns.registers import Registers
from ltlc.monitoring.columns.robustness import at_steps, still_possible
from ltlc.monitoring.columns.series import Columns, Steps, UnsupportedError
from ltlc.monitoring.columns.timeline import Timeline
from ltlc.monitoring.columns.values import not_numbers
from ltlc.monitoring.columns.views import View, views_of
from ltlc.runtime.rows import ByRows
from ltlc.runtime.sampling import Reading, Window
from ltlc.runtime.session import Plan, Session
from ltlc.runtime.tracking import Track
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.encodings import EPISODE
from ltlc.semantics.properties import After
from ltlc.specification.specification import Instances, PropertySpecification, Slicing

NOTHING = Block(np.empty(0, np.int64), {}, {})
"""No rows."""


class _Gathered:
    """The margins of the atoms of a property at its steps, in parts."""

    def __init__(
        self,
        judged: PropertySpecification,
        prepared: Prepared,
        track: Track,
        stepped: tuple[Track, Window] | None,
        reason: str,
    ) -> None:
        """If there is a `reason`, they cannot be gathered."""
        self._of = of = of_whole_run(judged)
        self._prepared = prepared
        self._slices = track.slices
        self._stepped = stepped
        self._judged = judged
        self._reason = reason
        self._times: list[Places] = []
        self._margins: dict[str, list[Array]] = {atom.name: [] for atom in of.atoms}
        self._registers: Registers | None = None
        if judged.openings() and not self._reason:
            try:
                self._registers = Registers(of, prepared)
            except UnsupportedError as error:
                self._reason = str(error)
        self._heard = {news: of.arrival(news).signal.name for news in of.messages()}
        self._since: dict[str, Nanoseconds] = {}

    def take(self, view: View, session: Session) -> None:
        """Gather those of a block, of which the property sees `view`."""
        if self._reason or self._stepped is None:
            return
        try:
            steps = view.steps(session, *self._stepped)
            if not self._times:
                self._hear(steps)
            if len(steps):
                self._add(steps)
        except UnsupportedError as error:
            self._reason = str(error)

    def refuse(self, reason: str) -> None:
        """They cannot be gathered."""
        self._reason = self._reason or reason

    def _hear(self, steps: Steps) -> None:
        """Messages come before the first of `steps`, from which ages count."""
        limit = steps.row(0) if len(steps) else steps.columns.count
        last = {news: steps.columns.last_heard(signal, limit) for news, signal in self._heard.items()}
        self._since |= {news: int(steps.columns.times[row]) for news, row in last.items() if row is not None}

    def _add(self, steps: Steps) -> None:
        parts = [(slice(None), steps)] if self._registers is None else self._registers.given(steps)
        for part, given in parts:
            mask, times = not_numbers(self._prepared.guards, given), steps.times[part]
            if mask is not None and self._heard:
                raise UnsupportedError("messages that make no step, from which ages count")
            valid = slice(None) if mask is None else ~mask
            self._times.append(times[valid])
            for parts_of, atom in zip(self._margins.values(), self._of.atoms, strict=True):
                parts_of.append(margins_of(atom.condition, given)[valid])

    def curve(self, began: Nanoseconds, end: Nanoseconds) -> Curve:
        """What they come to in a run up to `end`, in a session that `began` then."""
        if self._reason or not (run := self._run(began, end)):
            return Curve(reason=self._reason)
        try:
            self._require_all(end)
            found, opened_at = at_steps(self._of.property, *run), self._opened_at(*run)
        except UnsupportedError as error:
            return Curve(reason=str(error))
        line, margins, _ = run
        whole = np.require(found, requirements=("C", "W"))
        decided = first_with(abs(float(found[0])), margins, line.times)
        decided = decided and (decided[0], self._judged.as_written(decided[1]))
        return Curve(line.times, whole, decided=decided, opened_at=opened_at)

    def _opened_at(
        self, line: Timeline, margins: Mapping[str, Array], since: Mapping[str, Nanoseconds]
    ) -> Nanoseconds | None:
        """The first message from which on the property holds least, if it is judged from each on."""
        said = self._judged.property
        if not isinstance(self._judged.slicing, Instances) or not isinstance(said, After):
            return None
        opened = np.flatnonzero(combined(said.event, margins) > 0)
        found = at_steps(said.body, line, margins, since)[opened]
        return int(line.times[opened[found.argmin()]]) if len(opened) else None

    def band(self, began: Nanoseconds, end: Nanoseconds) -> Band:
        """What they can still come to in a run that has got to `end`."""
        if self._reason or not (run := self._run(began, end)):
            return Band(reason=self._reason)
        try:
            self._require_all(end)
            return Band(*still_possible(self._of.property, *run))
        except UnsupportedError as error:
            return Band(reason=str(error))

    def _require_all(self, end: Nanoseconds) -> None:
        """All messages are judged, and values at openings known, in a run up to `end`. Raises UnsupportedError."""
        if self._slices is not None and self._slices.left_out:
            raise UnsupportedError("messages were ignored for which there was no place")
        if self._registers is not None and not self._registers.are_known(end):
            raise UnsupportedError("time opens or closes a scope, at whose opening a value is read, between two steps")

    def _run(self, began: Nanoseconds, end: Nanoseconds) -> Run | None:
        """The run up to `end`, its margins, and since when ages count; None before the first step."""
        times = _joined(self._times or [np.empty(0, np.int64)])
        count = int(times.searchsorted(end, "right"))
        if not count:
            return None
        margins = {name: _joined(parts)[:count] for name, parts in self._margins.items()}
        return Timeline(times[:count], end), margins, dict.fromkeys(self._heard, began) | self._since


def _joined(parts: Sequence[Array]) -> Array:
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


def _unmeasured(compiled: Compiled, plan: Plan) -> str:
    """Why there are no margins of a property; empty if there are."""
    of = compiled.specification
    if compiled.encoding.name != EPISODE.name:
        return f"the encoding `{compiled.encoding.name}`"
    if isinstance(of.slicing, Slicing) and plan.rate is not None:
        return "the ticks of each id"
    each = "of each id" if isinstance(of.slicing, Slicing) else "from each message on"
    return f"values at an opening, {each}" if of.slicing is not None and of.openings() else ""


class Measuring:
    """Gathers margins from the blocks of a recording, each before the session takes it."""

    def __init__(self, session: Session, compiled: Sequence[Compiled], prepared: Sequence[Prepared]) -> None:
        """Of the properties of the session, which are given in its order."""
        self._session = session
        self._began: Nanoseconds | None = None
        self._readings = [signal for signal in session.plan.signals if isinstance(signal, Reading)]
        self._definitions = {name: each for of in prepared for name, each in of.definitions.items()}
        specifications = [each.specification for each in compiled]
        self._opened = whole_runs(session.plan, specifications, prepared)
        self._of_ids = KeptRuns(session.plan)
        stepped = [*session.stepped, *(() if self._opened is None else self._opened.session.stepped)]
        seen = {track.property.label: (track, window) for track, window in stepped}
        self._gathered: dict[str, _Gathered | OfIds] = {}
        for track, of, needed in zip(session.tracks, compiled, prepared, strict=True):
            label = track.property.label
            reason, slices = _unmeasured(of, session.plan), self._of_ids.of(label)
            self._gathered[label] = (
                _Gathered(of.specification, needed, track, seen.get(label), reason)
                if slices is None
                else OfIds(of.specification, needed, slices, reason)
            )

    def take(self, block: Block) -> None:
        """Gather those of the rows of `block`, which the session takes next."""
        if len(block.times):
            self._take(self._session, block, int(block.times[-1]))
            if self._opened is not None:
                self._take(self._opened.session, block, int(block.times[-1]))
                self._opened.take(block)
            self._of_ids.take(block)
            self._began = int(block.times[0]) if self._began is None else self._began

    def finish(self, end: Nanoseconds) -> None:
        """Gather those of the ticks up to `end`, which the session takes next."""
        if self._session.paces is not None and self._began is not None:
            self._take(self._session, NOTHING, min(end, self._session.end) + 1)
            if self._opened is not None:
                self._take(self._opened.session, NOTHING, min(end, self._session.end) + 1)
                ByRows(self._opened.session).advance(min(end, self._session.end))

    def _take(self, session: Session, block: Block, before: Nanoseconds) -> None:
        rows = Columns(block, session.sampler, self._readings)
        try:
            views = views_of(session, rows, before)
        except UnsupportedError as error:
            for track, _ in session.stepped:
                self._of(track).refuse(str(error))
            return
        for view in views:
            view.derive(session, self._definitions)
            for track in view.tracks:
                self._of(track).take(view, session)
            view.columns.release()

    def _of(self, track: Track) -> _Gathered:
        """What is gathered of a property that is judged along one run."""
        found = self._gathered[track.property.label]
        assert isinstance(found, _Gathered)
        return found

    def curves(self, end: Nanoseconds | None) -> dict[str, Curve]:
        """Those of all properties by label, in a run up to `end`; None if nothing has come."""
        if end is None or self._began is None:
            return dict.fromkeys(self._gathered, Curve())
        until = min(end, self._session.end)
        return {label: gathered.curve(self._began, until) for label, gathered in self._gathered.items()}

    def bands(self, end: Nanoseconds) -> dict[str, Band]:
        """What is still possible of all properties by label, in a run that has got to `end`, and is not over."""
        began, until = end if self._began is None else self._began, min(end, self._session.end)
        return {label: gathered.band(began, until) for label, gathered in self._gathered.items()}
