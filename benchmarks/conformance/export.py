"""Cases as files: a specification, its run as CSV and, if each row is one message, as MCAP, and all of it as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path

from benchmarks.conformance.cases import Case
from benchmarks.differential import files


def export(cases: Iterable[Case], folder: Path) -> int:
    """Write a folder for each case, named by its number; how many there are. Raises OSError."""
    count = 0
    for case in cases:
        into = folder / f"{case.number:05}"
        into.mkdir(parents=True, exist_ok=True)
        names = [name for name, signal in case.names.signals.items() if signal.topic is not None]
        (into / "props.ltlc").write_text(case.text)
        (into / "run.csv").write_text(files.csv_text(names, case.recording))
        (into / "case.json").write_text(json.dumps(case.document(), allow_nan=False) + "\n")
        if case.has_messages:
            files.write_bag("mcap", into, case.recording).replace(into / "run.mcap")
        count += 1
    return count
