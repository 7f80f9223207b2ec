"""The target `tests`: recordings that take each monitor along all its edges, with the verdicts that are expected.

For testing nodes and simulators of others: what sends such messages has to lead to these verdicts, what judges them has
to find them. Each recording is judged before it is written; its verdict has to be that of the definition.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping, Sequence
from errno import ENOTDIR
from functools import cache, partial
from os import strerror
from pathlib import Path
from typing import Any

from ltlc.assurance.coverage import Cover, covering
from ltlc.assurance.messages import Messages
from ltlc.assurance.replay import Expectation, Run
from ltlc.assurance.traffic import Event, Heard, Settings
from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.files import refuse_unwritable, scratch
from ltlc.base.provenance import provenance
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.inputs.messages.texts import text_of
from ltlc.inputs.recordings.bags.written import written
from ltlc.interfaces.building.targets import Made, UnfitError, Unit
from ltlc.monitoring.judging.output import Whole, mcap_of
from ltlc.monitoring.judging.run import Judge
from ltlc.runtime.reports import topic_names
from ltlc.runtime.times import seconds, seconds_text
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.evaluation import Value
from ltlc.specification.specification import Specification, fields

LIST = "expected.json"
"""The file that says what is expected of the others."""

SCHEMA = "ltlc-tests-1"

TIME = "/ltlc/time"
"""In bags, the topic of messages that show that time has passed."""

_EMPTY = "std_msgs/msg/Empty"


class WrongRunError(Exception):
    """A recording is not judged as the definition says: a bug in ltlc."""


@dataclass(frozen=True)
class Tests:
    """A folder of recordings: of each run a table in CSV and a bag in MCAP, and the list of what is expected."""

    path: Path
    name = "tests"

    @property
    def told(self) -> Sequence[Path]:
        """The folder."""
        return [self.path]

    def refuse(self) -> None:
        """Raise OSError if the folder cannot be written, or has something else in it."""
        if not self.path.exists():
            refuse_unwritable(self.path)
        elif not self.path.is_dir():
            raise NotADirectoryError(ENOTDIR, strerror(ENOTDIR))
        else:
            refuse_unwritable(self.path / LIST)
            if any(self.path.iterdir()) and not (self.path / LIST).is_file():
                raise OSError("the folder contains something other than tests made by ltlc")

    def make(self, unit: Unit) -> Made:
        """The recordings, which are no code; guards hold back nothing of them. Raises UnfitError for `each`."""
        specification, compiled = unit.specification, unit.compiled
        if unfit := [each for each in compiled if each.specification.slicing is not None]:
            raise UnfitError([_for_each_id(specification, each) for each in unfit])
        settings = Settings(specification.rate, specification.timeout)
        covers = [covering(each, unit.messages, settings) for each in compiled]
        labels = [each.specification.label for each in compiled]
        return Made(
            None,
            None,
            lambda: _files(self.path, unit, covers),
            "\n".join(f"{label}: {_said(cover)}" for label, cover in zip(labels, covers, strict=True)),
        )


def _for_each_id(specification: Specification, of: Compiled) -> Diagnostic:
    message = f"there are no tests of `{of.specification.label}` yet: it is judged for each id"
    help = "nothing was written; to get tests of the other properties, build them from a file of their own"
    return diagnostic("LTL708", specification.source, of.specification.span, message, help=help)


def _said(cover: Cover) -> str:
    missing = "".join(f"; not taken: {before} to {after}" for before, after in cover.missing)
    return f"{cover}{missing}"


def _files(folder: Path, unit: Unit, covers: Sequence[Cover]) -> Mapping[Path, str | bytes]:
    """All recordings, and the list of what is expected. Raises WrongRunError."""
    specification, compiled = unit.specification, unit.compiled
    found: dict[Path, str | bytes] = {}
    expected: list[dict[str, Any]] = []
    judge, made_of = Judge(compiled, specification, finds_all=False), provenance([specification.source])
    names = topic_names([each.specification.label for each in compiled])
    for each, name, cover in zip(compiled, names, covers, strict=True):
        expectation, runs = Expectation(each), []
        read = (pair for wanted in each.specification.inputs() for pair in fields(wanted.signal))
        topics = {field.topic: field.message for _, field in read}
        for number, of in enumerate(cover.runs, 1):
            files: dict[str, str | bytes] = {
                f"{name}_{number}.csv": table(of),
                f"{name}_{number}.mcap": bag(of, topics, unit.messages, made_of),
            }
            verdict, changes = _expected(expectation, of)
            _check(judge, files, each.specification.label, verdict)
            found |= {folder / file: content for file, content in files.items()}
            runs.append({"files": [*files], "verdict": verdict, "changes": changes})
        states, all_states = cover.states
        expected.append(
            {
                "label": each.specification.label,
                "states": {"reached": len(states), "of": len(all_states)},
                "edges": {"taken": len(cover.taken), "of": len(cover.can_be | cover.taken), "not_taken": cover.missing},
                "runs": runs,
            }
        )
    document = {
        "schema": SCHEMA,
        "source": specification.source.name,
        "properties": expected,
        "provenance": made_of,
    }
    return {folder / LIST: json.dumps(document, indent=2) + "\n", **found}


def _expected(expectation: Expectation, of: Run[Event]) -> tuple[str, list[dict[str, Any]]]:
    """The verdict at the end by definition, and the changes of verdict up to then, with their times in s."""
    shown = list(expectation.of(of))
    changes = [change for each in shown for change in each["settled"]]
    return shown[-1]["verdict"], [{"time": seconds(time), "verdict": verdict} for time, verdict in changes]


def _check(judge: Judge, files: Mapping[str, str | bytes], label: str, verdict: str) -> None:
    """Raise WrongRunError unless the property has this verdict on all recordings."""
    with scratch() as folder:
        for name, content in files.items():
            path = folder / name
            path.write_bytes(content if isinstance(content, bytes) else content.encode())
            session = judge.judge(path).session
            found = {} if session is None else {track.property.label: track.verdict.value for track in session.tracks}
            if found.get(label, Verdict.NOT_STARTED.value) != verdict:
                raise WrongRunError(f"{name}: `{label}` is {found.get(label)} instead of {verdict}")


def table(of: Run[Event]) -> str:
    """CSV with a column for each signal that is read from messages; a row is a message, or a time without one."""
    heard = [event for event in of.events if isinstance(event, Heard)]
    names = list(dict.fromkeys(signal.name for event in heard for signal in event.said.sample))
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(["time", *names])
    for event in of.events:
        said = {s.name: _cell(v) for s, v in event.said.sample.items()} if isinstance(event, Heard) else {}
        writer.writerow([seconds_text(event.time), *(said.get(name, "") for name in names)])
    return file.getvalue()


def _cell(value: Value) -> str:
    match value:
        case tuple():
            return json.dumps(value)
        case bool():
            return str(value).lower()
        case _:
            return str(value)


def bag(of: Run[Event], topics: Mapping[str, str], messages: Messages, made_of: Mapping[str, Any]) -> bytes:
    """MCAP with messages on `topics`, which have types; time that passes without one has messages of its own."""
    types = messages.types.messages
    definition = cache(partial(text_of, types=types))
    sent: list[tuple[Nanoseconds, str, str, Whole]] = []
    for event in of.events:
        topic, content = (event.said.topic, event.said.content) if isinstance(event, Heard) else (TIME, {})
        type_ = topics.get(topic, _EMPTY)
        data = written(type_, types, messages.build(type_, content))
        sent.append((event.time, topic, type_, Whole(data, definition(type_))))
    return mcap_of(sent, made_of)
