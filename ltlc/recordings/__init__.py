"""Recorded runs: each format is read, as a stream, into blocks of rows by columns.

recording = open_recording(path, signals)       raises RecordingError; `signals` are those that are wanted, by name
recording.columns                               what the recording has values of, `time` aside
for block in recording.blocks(): ...            in its order; raises RecordingError, after what could be read before it
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Protocol

from ltlc.recordings.blocks import Block
from ltlc.recordings.csv import CsvTable
from ltlc.recordings.jsonl import JsonlTable
from ltlc.recordings.parquet import ParquetTable
from ltlc.recordings.rows import RecordingError, failure
from ltlc.recordings.signals import FromTable, Table
from ltlc.recordings.text import COMPRESSED
from ltlc.specification.expressions import Signal

__all__ = ["Block", "Recording", "RecordingError", "is_recording", "open_recording"]


class Recording(Protocol):
    """A recorded run, of which the wanted signals are read."""

    @property
    def columns(self) -> tuple[str, ...]:
        """What it has values of: signals, and in a table what is no signal, too."""
        ...

    def absence(self, name: str) -> str:
        """Why it has no sample of the signal `name`, which is not in `columns`."""
        ...

    def blocks(self) -> Iterator[Block]:
        """Its rows, in its order; times do not decrease. Raises RecordingError after the rows that could be read."""
        ...


_TABLES: dict[str, Callable[[Path], Table]] = {
    ".csv": CsvTable,
    ".jsonl": JsonlTable,
    ".ndjson": JsonlTable,
    ".parquet": ParquetTable,
}
_BAGS = {".mcap", ".db3", ".bag"}


def is_recording(path: Path) -> bool:
    """Whether what is at `path` is one recording, as far as names tell: a file of a known form, or a bag's folder."""
    if path.is_dir():
        return (path / "metadata.yaml").is_file()
    return path.suffix.lower() in {*_FORMATS, *_BAGS}


def open_recording(path: Path, signals: Mapping[str, Signal]) -> Recording:
    """The recording at `path`; its format is told by the end of its name.

    Raises RecordingError if it cannot be read, or cannot be a recording.
    """
    if not path.exists():
        raise failure("LTL901", path, f"there is no file `{path}`")
    if path.is_dir() or path.suffix.lower() in _BAGS:
        message = f"`{path}` looks like a bag, and bags cannot be read yet"
        raise failure("LTL807", path, message, help="export the topics to CSV or JSONL, a column for each signal")
    name = path.with_suffix("") if path.suffix.lower() in COMPRESSED else path
    table = _TABLES.get(name.suffix.lower())
    if table is None or (table is ParquetTable and name is not path):
        help = "its name should end in .csv, .jsonl or .parquet; text may be compressed: .csv.gz, .csv.zst"
        raise failure("LTL807", path, f"`{path}` is not a recording", help)
    return FromTable(path, table(path), signals)
