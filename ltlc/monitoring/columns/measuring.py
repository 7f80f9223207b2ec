"""The margins of a recorded run, gathered block by block beside the session that judges it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import field

import numpy as np
from numpy.typing import NDArray

from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Array, Block, Places
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
from ltlc.runtime.session import Session
from ltlc.runtime.tracking import Track
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.encodings import EPISODE
from ltlc.semantics.properties import After
from ltlc.semantics.robustness import FALSE, TRUE
from ltlc.specification.specification import Instances, Slicing

Run = tuple[Timeline, Mapping[str, Array], Mapping[str, Nanoseconds]]

NOTHING = Block(np.empty(0, np.int64), {}, {})
"""No rows."""

PIECE = 1 << 14
"""So many margins are looked through at a time."""


@dataclass(frozen=True, slots=True)
class Curve:
    """By how much a property holds on the rest of the run from each of its steps on.

    `times`, in ns, and `margins` have one number for each step, in the order of the run; `margins[0]` is that of the
    whole run. A margin is in the unit of the values that decide it: positive where the property holds, negative where
    it is violated, infinite where no comparison of numbers decides it. `decided` has the time and the name of the first
    comparison with the margin of the whole run; of what is judged from each message on, it is that from the message at
    `opened_at`. Of a property that cannot be measured there are none, and `reason` says
    why.
    """

    times: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))
    margins: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))
    reason: str = ""
    decided: tuple[Nanoseconds, str] | None = None
    opened_at: Nanoseconds | None = None

    @property
    def whole(self) -> float | None:
        """That of the whole run; None if it did not begin, or cannot be measured."""
        return float(self.margins[0]) + 0.0 if len(self.margins) else None  # 0, not -0, however it came about


@dataclass(frozen=True, slots=True)
class Band:
    """Between which numbers the robustness of a property will be, however the run continues.

    Of a property that cannot be measured nothing is known, and `reason` says why.
    """

    low: float = FALSE
    high: float = TRUE
    reason: str = ""


class _Gathered:
    """The margins of the atoms of a property at its steps, in parts."""

    def __init__(
        self, compiled: Compiled, prepared: Prepared, track: Track, stepped: tuple[Track, Window] | None
    ) -> None:
        self._of = of = of_whole_run(compiled.specification)
        self._prepared = prepared
        self._slices = track.slices
        self._stepped = stepped
        self._judged = compiled.specification
        self._reason = _unmeasured(compiled)
        self._times: list[Places] = []
        self._margins: dict[str, list[Array]] = {atom.name: [] for atom in of.atoms}
        self._registers: Registers | None = None
        if compiled.specification.openings() and not self._reason:
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
        decided = _first_with(abs(float(found[0])), margins, line.times)
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


def _first_with(size: float, margins: Mapping[str, Array], times: Places) -> tuple[Nanoseconds, str] | None:
    """The first of the finite `margins` of this size, on either side of 0."""
    for start in range(0, len(times) if math.isfinite(size) else 0, PIECE):
        at = {name: np.flatnonzero(np.abs(each[start : start + PIECE]) == size) for name, each in margins.items()}
        found = [(int(steps[0]), name) for name, steps in at.items() if len(steps)]
        if found:
            step, name = min(found, key=lambda each: each[0])
            return int(times[start + step]), name
    return None


def _unmeasured(compiled: Compiled) -> str:
    """Why there are no margins of a property; empty if there are."""
    of = compiled.specification
    if compiled.encoding.name != EPISODE.name:
        return f"the encoding `{compiled.encoding.name}`"
    if isinstance(of.slicing, Slicing):
        return "`each`: every id has a run of its own"
    return "values at an opening, from each message on" if of.slicing is not None and of.openings() else ""


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
        stepped = [*session.stepped, *(() if self._opened is None else self._opened.session.stepped)]
        seen = {track.property.label: (track, window) for track, window in stepped}
        self._gathered = {
            track.property.label: _Gathered(of, needed, track, seen.get(track.property.label))
            for track, of, needed in zip(session.tracks, compiled, prepared, strict=True)
        }

    def take(self, block: Block) -> None:
        """Gather those of the rows of `block`, which the session takes next."""
        if len(block.times):
            self._take(self._session, block, int(block.times[-1]))
            if self._opened is not None:
                self._take(self._opened.session, block, int(block.times[-1]))
                self._opened.take(block)
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
                self._gathered[track.property.label].refuse(str(error))
            return
        for view in views:
            view.derive(session, self._definitions)
            for track in view.tracks:
                self._gathered[track.property.label].take(view, session)
            view.columns.release()

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
