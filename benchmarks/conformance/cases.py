"""Cases: a specification of one property, a run, and the verdict that the run has at each time, by definition.

They are kept as JSON lines, which `docs/conformance.md` describes.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from benchmarks.differential.names import Kind, Said, said
from benchmarks.differential.samples import Recording, Row
from benchmarks.differential.values import single

FILE = Path(__file__).parent / "cases.jsonl"
VERSION = "1.0"
"""Of the suite: the first number changes if the verdict of a case does, the second if cases are added or withdrawn."""

Change = tuple[int, str]
"""A time in nanoseconds, and the verdict from then on."""


@dataclass(frozen=True)
class Verdicts:
    """What a run shows of a property: when its steps are, and the changes of verdict, at most one of each time."""

    changes: Sequence[Change]
    steps: Sequence[int]

    def at(self, time: int) -> str:
        """The verdict at a time, after all that happens then."""
        return next((verdict for since, verdict in reversed(self.changes) if since <= time), "not_started")


@dataclass(frozen=True)
class Case:
    """A numbered case, which tells the definition from the wrong `readings` that it names.

    It is `proved` if the extracted judge has accepted its verdicts, each with its time.
    """

    number: int
    readings: tuple[str, ...]
    text: str
    recording: Recording
    expected: Verdicts
    proved: bool = False

    @property
    def sentence(self) -> str:
        """The property alone."""
        return self.text.splitlines()[-1].removeprefix("p: ")

    @property
    def has_messages(self) -> bool:
        """Whether each row is one message, so that the run can be a bag."""
        return all(len(row.messages) == 1 for row in self.recording.rows)

    @cached_property
    def names(self) -> Said:
        """What its specification says."""
        return said(self.text)

    def document(self) -> dict[str, Any]:
        """The case as JSON has it."""
        return {
            "id": self.number,
            "readings": list(self.readings),
            "specification": self.text,
            **run_document(self.recording),
            "steps": list(self.expected.steps),
            "verdicts": [list(change) for change in self.expected.changes],
            "proved": self.proved,
        }

    def question(self) -> dict[str, Any]:
        """What a tool is given of the case: all but the answer."""
        return {"id": self.number, "specification": self.text, **run_document(self.recording)}


def run_document(recording: Recording) -> dict[str, Any]:
    """A run as JSON has it."""
    rows = [
        [row.time, {n: _plain(v) for values in row.messages.values() for n, v in values.items()}]
        for row in recording.rows
    ]
    return {"run": rows, "until": recording.end}


def _plain(value: Any) -> Any:
    """A value as JSON has it, which has no infinity and no NaN."""
    if isinstance(value, tuple):
        return [_plain(each) for each in value]
    if isinstance(value, float) and not math.isfinite(value):
        return "NaN" if math.isnan(value) else "Infinity" if value > 0 else "-Infinity"
    return value


def case_of(document: Mapping[str, Any]) -> Case:
    """The case that a line has."""
    text = document["specification"]
    names = said(text)
    rows = [Row(time, _messages(names, values)) for time, values in document["run"]]
    recording = Recording(rows, rows[0].time, document["until"])
    changes = [(time, verdict) for time, verdict in document["verdicts"]]
    expected = Verdicts(changes, document["steps"])
    return Case(document["id"], tuple(document["readings"]), text, recording, expected, document["proved"])


def _messages(names: Said, values: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    messages: dict[str, dict[str, Any]] = {}
    for name, value in values.items():
        signal = names.signals[name]
        assert signal.topic is not None
        messages.setdefault(signal.topic, {})[name] = _typed(value, signal.kind)
    return messages


def _typed(value: Any, kind: Kind | tuple[str, ...]) -> Any:
    match kind:
        case ("array", of):
            return tuple(_typed(each, (of,)) for each in value)
        case ("float32",):
            return single(float(value))
        case ("float64",):
            return float(value)
        case _:
            return value


def load(path: Path = FILE, numbers: Iterable[int] | None = None) -> list[Case]:
    """The cases of a file, all or those with these numbers; what is withdrawn is left out."""
    wanted = None if numbers is None else {*numbers}
    documents = map(json.loads, path.read_text().splitlines()[1:])
    return [case_of(each) for each in documents if "withdrawn" not in each and (wanted is None or each["id"] in wanted)]


def head(path: Path = FILE) -> dict[str, Any]:
    """The first line of a file of cases: what suite it is, its version, and its licence."""
    with path.open() as file:
        found: dict[str, Any] = json.loads(file.readline())
    return found


def save(cases: Iterable[Case], path: Path = FILE) -> None:
    """Write cases to a file, which is replaced as a whole."""
    first = {"suite": "ltlc conformance", "version": VERSION, "license": "GPL-3.0-or-later"}
    lines = [first, *(case.document() for case in cases)]
    text = "".join(json.dumps(line, separators=(",", ":"), allow_nan=False) + "\n" for line in lines)
    path.with_suffix(".new").write_text(text)
    path.with_suffix(".new").replace(path)
