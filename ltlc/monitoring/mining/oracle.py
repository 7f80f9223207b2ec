"""The verdicts of a recording on values: the properties with these are judged by their monitors, as in `ltlc run`."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import field
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING

from ltlc.assurance.exactness import late_verdicts
from ltlc.automata import Budget, Exceeded
from ltlc.base.diagnostics import Diagnostic
from ltlc.compiler import Compiled, compile_specification
from ltlc.dataclass import dataclass
from ltlc.inputs.recordings import Block, Recording, RecordingError, open_recording
from ltlc.inputs.recordings.blocks import Ragged
from ltlc.inputs.recordings.reading import DEFAULT, ReadOptions
from ltlc.monitoring.judging.run import Judge, RunReport
from ltlc.monitoring.mining.template import Template, Trial
from ltlc.runtime.session import Session
from ltlc.runtime.tracking import Track
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.encodings import EPISODE
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.expressions import Signal
from ltlc.specification.specification import Specification

if TYPE_CHECKING:
    from ltlc.monitoring.columns.curves import Curve

MOST_KEPT = 256 * 2**20
"""Bytes of a recording that are kept in memory; of a longer one, each look reads all."""


class Outcome(Enum):
    """A recording's verdict on a value: all properties that have it must pass."""

    PASSES = "passes"
    """At its end the property holds: it is not violated, and no obligation is open."""
    FAILS = "fails"
    NOT_STARTED = "not started"


@dataclass(frozen=True)
class Answer:
    """The properties that have the value of a trial, as they stand at the end of a recording.

    Where it was measured, `robustness` says by how much they hold, by label.
    """

    session: Session
    tracks: tuple[Track, ...]
    robustness: Mapping[str, Curve] = field(default_factory=dict)

    @property
    def outcome(self) -> Outcome:
        """What that means for the value; nothing if the property has not started."""
        verdicts = {track.verdict for track in self.tracks} - {Verdict.NOT_STARTED}
        if not verdicts:
            return Outcome.NOT_STARTED
        return Outcome.PASSES if all(verdict.holds for verdict in verdicts) else Outcome.FAILS

    @property
    def failing(self) -> Track:
        """The property that fails: the first that is violated, otherwise one with an open obligation."""
        failing = [t for t in self.tracks if not t.verdict.holds and t.verdict is not Verdict.NOT_STARTED]
        violated = [track for track in failing if track.decided_at is not None]
        return min(violated, key=lambda t: t.decided_at.time if t.decided_at else 0) if violated else failing[0]

    @property
    def compared(self) -> list[tuple[float, float]]:
        """The numbers that were compared where a property was violated that fails, if one was."""
        moment = self.failing.decided_at
        pairs = [(c.left, c.right) for c in moment.because] if moment else []
        return [(a, b) for a, b in pairs if isinstance(a, float | int) and isinstance(b, float | int)]


class TooHardError(Exception):
    """A monitor cannot be made; `diagnostics` say of which property."""

    def __init__(self, diagnostics: Sequence[Diagnostic]) -> None:
        super().__init__("a monitor cannot be made")
        self.diagnostics = diagnostics


class Oracle:
    """Asks recordings about the values of a specification; monitors of one shape are made once."""

    def __init__(self, template: Template, budget: Budget, reading: ReadOptions = DEFAULT) -> None:
        self.looks = 0
        self._reading = reading
        self._template = template
        self._budget = budget
        self._monitors: dict[Hashable, Monitor | Exceeded] = {}

    def answers(
        self, recording: Kept, trials: Sequence[Trial], finds_all: bool = False, measures: bool = False
    ) -> tuple[RunReport, dict[Trial, Answer]]:
        """The verdict of `recording` on each of `trials`; nothing if none of it can be read.

        If it `finds_all` violations, those after the first one are known, too. If it `measures`, answers have margins.

        Raises TooHardError and SpotMissing.
        """
        compiled, specification = self._compiled(trials)
        self.looks += 1
        judge = Judge(
            compiled, specification, self._reading, open=recording.open, finds_all=finds_all, measures=measures
        )
        report = judge.judge(recording.path)
        if report.session is None:
            return report, {}
        pairs = list(zip(specification.properties, report.session.tracks, strict=True))
        return report, {
            trial: Answer(report.session, tuple(track for of, track in pairs if trial.is_of(of)), report.robustness)
            for trial in trials
        }

    def late(self, trials: Sequence[Trial]) -> list[Diagnostic]:
        """A warning for each property with the values of `trials` whose verdicts may come late.

        Raises TooHardError and SpotMissing.
        """
        compiled, specification = self._compiled(trials)
        asked = [each for each in compiled if any(trial.is_of(each.specification) for trial in trials)]
        return late_verdicts(specification.source, asked, self._budget)

    def _compiled(self, trials: Sequence[Trial]) -> tuple[list[Compiled], Specification]:
        specification = self._template.specification(trials)
        compiled, problems = compile_specification(specification, EPISODE, self._budget, known=self._monitors)
        if problems:
            raise TooHardError(problems)
        return compiled, specification


class Kept:
    """The recording at `path`, which stays in memory from the first look at it on, if it is not too large."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._recording: Recording | None = None
        self._blocks: list[Block] | None = None
        self._damage: RecordingError | None = None

    def open(self, path: Path, signals: Mapping[str, Signal], reading: ReadOptions) -> Recording:
        """Itself. The first look wants all `signals` that later ones want. Raises RecordingError."""
        if self._blocks is None:
            self._recording = open_recording(path, signals, reading)
        return self

    @property
    def columns(self) -> tuple[str, ...]:
        """See `Recording`."""
        assert self._recording is not None
        return self._recording.columns

    @property
    def definitions(self) -> Mapping[str, str]:
        """See `Recording`."""
        assert self._recording is not None
        return self._recording.definitions

    @property
    def beginning(self) -> Nanoseconds | None:
        """See `Recording`."""
        assert self._recording is not None
        return self._recording.beginning

    def absence(self, name: str) -> str:
        """See `Recording`."""
        assert self._recording is not None
        return self._recording.absence(name)

    def remedy(self, name: str) -> str:
        """See `Recording`."""
        assert self._recording is not None
        return self._recording.remedy(name)

    def remarks(self) -> list[Diagnostic]:
        """See `Recording`."""
        assert self._recording is not None
        return self._recording.remarks()

    def blocks(self) -> Iterator[Block]:
        """See `Recording`."""
        if self._blocks is None:
            yield from self._read()
            return
        yield from self._blocks
        if self._damage is not None:
            raise self._damage

    @property
    def length(self) -> Nanoseconds:
        """The time from its first row to its last, as far as it is kept."""
        times = [int(block.times[end]) for block in self._blocks or () if len(block.times) for end in (0, -1)]
        return times[-1] - times[0] if times else 0

    def until_row(self, time: Nanoseconds) -> Nanoseconds:
        """How long it is from `time` to the next row, as far as it is kept; 0 if there is none."""
        for block in self._blocks or ():
            if len(block.times) and block.times[-1] >= time:
                return int(block.times[block.times.searchsorted(time)]) - time
        return 0

    def _read(self) -> Iterator[Block]:
        """The blocks as they are read; at the end of them they are kept."""
        assert self._recording is not None
        kept: list[Block] = []
        size = 0
        try:
            for block in self._recording.blocks():
                size += _size(block)
                kept = [*kept, block] if size <= MOST_KEPT else []
                yield block
        except RecordingError as error:
            self._damage = error
        if size <= MOST_KEPT:
            self._blocks = kept
        if self._damage is not None:
            raise self._damage


def _size(block: Block) -> int:
    """The bytes of its arrays, of strings those of the references."""
    size = block.times.nbytes + sum(rows.nbytes for rows in block.messages.values())
    for samples in block.samples.values():
        values = samples.values
        arrays = [values.elements, values.lengths] if isinstance(values, Ragged) else [values]
        size += samples.rows.nbytes + sum(array.nbytes for array in arrays)
    return size
