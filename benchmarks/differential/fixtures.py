"""Small cases as files: `NAME.ltlc`, `NAME.csv`, and `NAME.expected`, which says what the definition says of them.

`NAME.expected` is JSON: until when the run is watched, and the changes of verdict of each property, by time in ns.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from benchmarks.differential import files, reference, targets
from benchmarks.differential.campaign import Difference
from benchmarks.differential.names import said
from benchmarks.differential.samples import Recording, Row
from benchmarks.differential.values import single

Expected = Mapping[str, list[tuple[int, str]]]


@dataclass(frozen=True)
class Fixture:
    """A specification, a recording of it, and the changes of verdict of each property."""

    text: str
    recording: Recording
    expected: Expected


def save(of: Difference, folder: Path, name: str) -> None:
    """Write a case, with what the reference says of it."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.ltlc").write_text(of.text)
    (folder / f"{name}.csv").write_text(table(of))
    judged = reference.judged(reference.properties(of.text), of.recording)
    changes = {label: each.changes for label, each in judged.items()}
    document = {"until": of.recording.end, "changes": changes}
    (folder / f"{name}.expected").write_text(json.dumps(document) + "\n")


def load(folder: Path, name: str) -> Fixture:
    """A case that was saved."""
    text = (folder / f"{name}.ltlc").read_text()
    document = json.loads((folder / f"{name}.expected").read_text())
    with (folder / f"{name}.csv").open(newline="") as file:
        rows = [_row(said(text), cells) for cells in csv.DictReader(file)]
    changes = {label: [(time, verdict) for time, verdict in found] for label, found in document["changes"].items()}
    return Fixture(text, Recording(rows, rows[0].time, document["until"]), changes)


def _row(names: Any, cells: Mapping[str, str]) -> Row:
    messages: dict[str, dict[str, Any]] = {}
    for name, cell in cells.items():
        if name != "time" and cell:
            signal = names.signals[name]
            messages.setdefault(signal.topic, {})[name] = _value(cell, signal.kind)
    return Row(int(Fraction(cells["time"]) * 10**9), messages)


def _value(cell: str, kind: tuple[str, ...]) -> Any:
    match kind:
        case ("array", "float32"):
            return tuple(single(each) for each in json.loads(cell))
        case ("array", of):
            return tuple(float(each) if of == "float64" else each for each in json.loads(cell))
        case ("integer",):
            return int(cell)
        case ("float32",):
            return single(float(cell))
        case ("float64",):
            return float(cell)
        case ("boolean" | "message",):
            return cell == "true"
        case _:
            return cell


def table(of: Difference) -> str:
    """The recording as CSV."""
    with TemporaryDirectory() as folder:
        return files.write_csv(Path(folder), targets.monitors(of.text), of.recording).read_text()
