"""Recorded runs: each format is read, as a stream, into rows of a time and the values of signals.

recording = open_recording(path, known)     raises RecordingError; `known` says by their names what signals are
recording.columns                           what the file has values of, `time` aside
for row in recording.rows(): …              in the order of the file; raises RecordingError
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ltlc.recordings.arrays import WithArrays, columns_of
from ltlc.recordings.csv import CsvRecording
from ltlc.recordings.jsonl import JsonlRecording
from ltlc.recordings.rows import Column, Recording, RecordingError, failure

__all__ = ["Column", "Recording", "RecordingError", "open_recording"]

_FORMATS: dict[str, type[CsvRecording] | type[JsonlRecording]] = {
    ".csv": CsvRecording,
    ".jsonl": JsonlRecording,
    ".ndjson": JsonlRecording,
}
_BAGS = {".mcap", ".db3", ".bag"}


def open_recording(path: Path, known: Mapping[str, Column]) -> Recording:
    """The recording at `path`; its format is told by the end of its name.

    Raises RecordingError if it cannot be read, or cannot be a recording.
    """
    if not path.exists():
        raise failure("LTL901", path, f"there is no file `{path}`")
    if path.is_dir() or path.suffix.lower() in _BAGS:
        message = f"`{path}` looks like a bag, and bags cannot be read yet"
        raise failure("LTL807", path, message, help="export the topics to CSV or JSONL, a column for each signal")
    format_ = _FORMATS.get(path.suffix.lower())
    if format_ is None:
        raise failure("LTL807", path, f"`{path}` is not a recording", help="its name should end in .csv or .jsonl")
    return WithArrays(path, format_(path, columns_of(known)), known)
