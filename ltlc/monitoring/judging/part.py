"""The part of a recording that is judged: that between `--from` and `--until`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.source import Source
from ltlc.inputs.recordings import Block, Recording
from ltlc.inputs.recordings.reading import ReadOptions
from ltlc.inputs.recordings.rows import outside
from ltlc.runtime.times import seconds_text
from ltlc.semantics.durations import Nanoseconds


class Part:
    """The rows of `recording`, which is at `path`, that `reading` asks for.

    When the recording has its `beginning`, and so `since` and `until`, is known from its first row on at the latest.
    """

    def __init__(self, path: Path, recording: Recording, reading: ReadOptions) -> None:
        self._path, self._recording, self._reading = path, recording, reading
        self._begin(recording.beginning)

    def _begin(self, beginning: Nanoseconds | None) -> None:
        self.beginning = beginning
        self.since, self.until = self._reading.limits(beginning)

    @property
    def zero(self) -> Nanoseconds | None:
        """When the recording began, if the run begins later."""
        return None if self._reading.since is None else self.beginning

    def blocks(self) -> Iterator[Block]:
        """The rows. Raises RecordingError, also if all others are before these, or after."""
        before = after = False
        judged = last = 0
        for block in self._recording.blocks():
            if self.beginning is None and len(block.times):
                self._begin(int(block.times[0]))
            of = block.between(self.since, self.until)
            judged += len(of.times)
            yield of
            if len(of.times) < len(block.times):
                last = int(block.times[-1])
                before |= self.since is not None and bool(block.times[0] < self.since)
                after |= self.until is not None and bool(block.times[-1] > self.until)
            if after:
                break
        if not judged and before != after:
            assert self.beginning is not None
            raise outside(self._path, self.beginning, last if before else None)

    def remarks(self) -> list[Diagnostic]:
        """That the time of `--from` is one before the recording, so that nothing was left out."""
        since, beginning = self._reading.since, self.beginning
        if not isinstance(since, int) or beginning is None or since >= beginning:
            return []
        times = f"{seconds_text(since)} s, is before the recording begins, at {seconds_text(beginning)} s"
        message = f"the time of `--from`, {times}: no row was left out"
        help = f"`--from +{seconds_text(since)}` counts from the beginning" if since >= 0 else ""
        return [diagnostic("LTL816", Source(str(self._path), ""), None, message, help=help)]
