"""Recorded runs: each format is read, as a stream, into blocks of rows by columns.

recording = open_recording(path, signals)       raises RecordingError; `signals` are those that are wanted, by name
recording.columns                               what the recording has values of, `time` aside
for block in recording.blocks(): ...            in its order; raises RecordingError, after what could be read before it
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Protocol

from ltlc.base.diagnostics import Diagnostic
from ltlc.inputs.recordings.bags import BagRecording, is_bag
from ltlc.inputs.recordings.bags.folders import METADATA
from ltlc.inputs.recordings.blocks import Block
from ltlc.inputs.recordings.fence import fenced
from ltlc.inputs.recordings.reading import DEFAULT, ReadOptions
from ltlc.inputs.recordings.rows import RecordingError, failure
from ltlc.inputs.recordings.signals import FromTable, Table
from ltlc.inputs.recordings.text import COMPRESSED
from ltlc.runtime.times import seconds_text
from ltlc.semantics.durations import Nanoseconds
from ltlc.specification.expressions import Signal

__all__ = ["Block", "Recording", "RecordingError", "is_recording", "open_recording"]


class Recording(Protocol):
    """A recorded run, of which the wanted signals are read."""

    @property
    def columns(self) -> tuple[str, ...]:
        """What it has values of: signals, and in a table columns that are not signals, too."""
        ...

    @property
    def definitions(self) -> Mapping[str, str]:
        """Who defines the messages on each topic that is read, if it has messages: `the recording`, `ROS 2 Humble`."""
        ...

    @property
    def beginning(self) -> Nanoseconds | None:
        """When it begins, if that is known before it is read."""
        ...

    def absence(self, name: str) -> str:
        """Why it has no sample of the signal `name`, which is not in `columns`."""
        ...

    def remedy(self, name: str) -> str:
        """What may help against that, as a sentence; or empty."""
        ...

    def remarks(self) -> list[Diagnostic]:
        """Further findings, once it has been read."""
        ...

    def blocks(self) -> Iterator[Block]:
        """Its rows, in its order; times do not decrease. Raises RecordingError after the rows that could be read."""
        ...


def is_recording(path: Path) -> bool:
    """Whether `path` is one recording, by its name: a file of a known form, or a bag's folder."""
    if os.path.isdir(path):
        return os.path.isfile(path / METADATA)  # False of a folder that may not be looked into
    return is_bag(path) or _table(path) is not None


def is_table(path: Path) -> bool:
    """Whether `path` is a table, by its name."""
    return not is_bag(path) and _table(path) is not None


def _table(path: Path) -> Callable[[Path], Table] | None:
    """What reads the table at `path`; None if its name is not that of one."""
    # Here, as a bag needs none of them: for a small one, what they import was a thirtieth of the time.
    from ltlc.inputs.recordings.csv import CsvTable
    from ltlc.inputs.recordings.jsonl import JsonlTable
    from ltlc.inputs.recordings.parquet import parquet_table

    is_compressed = path.suffix.lower() in COMPRESSED
    name = path.with_suffix("") if is_compressed else path
    match name.suffix.lower():
        case ".csv":
            return CsvTable
        case ".jsonl" | ".ndjson":
            return JsonlTable
        case ".parquet" if not is_compressed:
            return parquet_table
    return None


def open_recording(path: Path, signals: Mapping[str, Signal], reading: ReadOptions = DEFAULT) -> Recording:
    """The recording at `path`; the end of its name gives the format, a folder is a bag.

    Raises RecordingError if it cannot be read, cannot be a recording, or nothing of it can be wanted.
    """
    since, until = reading.limits(0)
    if type(reading.since) is type(reading.until) and since is not None and until is not None and since > until:
        message = f"`--from`, {seconds_text(since)} s, is after `--until`, {seconds_text(until)} s"
        raise failure("LTL804", path, message, "swap the two times")
    if not path.exists():
        raise failure("LTL901", path, f"there is no file `{path}`")
    if not (path.is_dir() or path.is_file()):
        raise failure("LTL807", path, f"`{path}` is not a regular file: a pipe or a device cannot be read twice")
    if is_bag(path):
        with fenced(path, "LTL811"):
            return BagRecording(path, signals, reading)
    table = _table(path)
    if table is None:
        help = (
            "a bag is a folder with metadata.yaml; file names end in .mcap, .db3, .bag, .ulg, .csv, .jsonl or "
            ".parquet; text may be compressed: .csv.gz, .csv.zst"
        )
        raise failure("LTL807", path, f"`{path}` is not a recording", help)
    with fenced(path, "LTL820"):
        return FromTable(path, table(path), signals, reading.stamp)
