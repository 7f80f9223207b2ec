"""Two guards side by side: what one lets through and the other does not, at all, and of recordings."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from ltlc.analysis.errors import NotDecidedError
from ltlc.analysis.guards.differences import Beside, Difference, Side
from ltlc.analysis.guards.reasons import Reasons
from ltlc.analysis.guards.replaying import Replay
from ltlc.analysis.guards.trying import Trial
from ltlc.assurance.messages import Messages
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.errors import UnusableInput
from ltlc.base.limits import Budget
from ltlc.base.provenance import provenance
from ltlc.base.render.table import example_lines
from ltlc.base.source import Source
from ltlc.dataclass import dataclass
from ltlc.frontend.language import types_for
from ltlc.inputs.messages.definitions import MessageTypes
from ltlc.inputs.recordings.reading import ReadOptions
from ltlc.interfaces.api.guard import guarding_of
from ltlc.interfaces.api.prepare import Prepared, prepare, read
from ltlc.monitoring.guarding.arrangement import Solved
from ltlc.monitoring.guarding.compared import Compared
from ltlc.monitoring.guarding.recording import Guarding
from ltlc.monitoring.judging.run import Judge, RunReport
from ltlc.semantics.encodings import EPISODE
from ltlc.specification.arenas import Property

MOST_LISTED = 10
"""So many commands of a recording are listed that only one guard lets through."""


@dataclass(frozen=True)
class OutCompared:
    """The guards of two files that send on `out`: runs at whose end only one lets a command through, and recordings.

    A run without an example may not be one that can happen. If a run was not found, and there may be one, `undecided`
    says why, and so many were `tried`.
    """

    out: str
    names: tuple[str, str]
    differences: tuple[Difference, ...]
    undecided: str
    tried: int
    recordings: tuple[Compared, ...]

    def lines(self) -> Iterator[str]:
        """It as text."""
        yield f"guard of {self.out}"
        found = {each.passes: each for each in self.differences}
        for name, other in (self.names, self.names[::-1]):
            yield ""
            if (difference := found.get(name)) is not None:
                lets = "lets" if difference.example is not None else "may let"
                how = " (found by trying)" if difference.by_trying else ""
                yield f"{name} {lets} a command through that {other} does not{how}: {difference.reason}"
                yield from (f"  {line}" for line in _run_lines(difference))
                if difference.example is None:
                    yield f"  no such run found: {self._effort}"
            elif self.undecided:
                yield f"no run found in which {name} lets a command through that {other} does not: {self._effort}"
            else:
                yield f"{name} lets nothing through that {other} does not, as long as they have done the same before"
        if self.undecided:
            yield ""
            yield f"not compared by a proof: {self.undecided}"
        for each in self.recordings:
            yield ""
            yield from each.lines(MOST_LISTED)

    @property
    def _effort(self) -> str:
        """That a run was looked for."""
        return f"{self.tried} tried; not decided"

    def document(self) -> dict[str, Any]:
        """It as JSON."""
        return {
            "out": self.out,
            "files": list(self.names),
            "undecided": self.undecided or None,
            "tried": self.tried,
            "differences": [_document(each) for each in self.differences],
            "recordings": [each.document() for each in self.recordings],
        }


def _run_lines(difference: Difference) -> list[str]:
    if difference.example is None:
        return list(difference.events)
    return example_lines(difference.example.as_json())[1:]


def _document(difference: Difference) -> dict[str, Any]:
    return {
        "passes": difference.passes,
        "refuses": difference.refuses,
        "reason": difference.reason,
        "by_trying": difference.by_trying,
        "events": list(difference.events),
        "example": None if difference.example is None else difference.example.as_json(),
    }


@dataclass(frozen=True)
class GuardsCompared:
    """The guards of two files, by the topics on which both send; what is to be said of the input."""

    topics: tuple[OutCompared, ...]
    diagnostics: tuple[Diagnostic, ...]
    sources: tuple[Source, Source]

    @property
    def is_complete(self) -> bool:
        """Whether all was decided."""
        return not any(
            each.undecided or any(difference.example is None for difference in each.differences) for each in self.topics
        )

    def text(self) -> str:
        """It as text."""
        return "\n\n".join("\n".join(each.lines()) for each in self.topics) + "\n"

    def json(self) -> str:
        """It as JSON."""
        made_of = provenance(self.sources)
        document = {"guards": [each.document() for each in self.topics], "provenance": made_of}
        return json.dumps(document, indent=2, allow_nan=False) + "\n"


def compare_guards(
    one: Path, two: Path, recordings: Sequence[Path], message_paths: Sequence[str], budget: Budget
) -> GuardsCompared:
    """The guards of the files `one` and `two` that send on the same topics. Raises UnusableInput and SpotMissing."""
    files = [prepare(read(path), message_paths, EPISODE, budget, recordings=recordings) for path in (one, two)]
    guardings = [guarding_of(each) for each in files]
    left, right = ({guard.out: some for some in each.solved for guard in some.guards} for each in guardings)
    if left.keys().isdisjoint(right):
        raise UnusableInput((), f"no guard of {one} sends on the topic of one of {two}")
    names = (str(one), str(two))
    pairs = list(zip(files, guardings, strict=True))
    reports = [[_judged(*each, path, message_paths) for each in pairs] for path in recordings]
    judges = [Judge(each.compiled, each.specification) for each in files]
    replays = [Replay(*each) for each in zip(names, guardings, judges, strict=True)]
    known = [types_for(each.specification.source, message_paths, recordings)[0].messages for each in files]
    messages = Messages(MessageTypes({**known[1], **known[0]}))
    found = []
    for out in (out for out in left if out in right):
        sides = _side(names[0], files[0], left[out]), _side(names[1], files[1], right[out])
        compared = tuple(_compared(out, names, pair) for pair in reports)
        found.append(_out_compared(*sides, out, Trial(replays, out, messages), compared))
    told = [d for each in files for d in each.diagnostics]
    return GuardsCompared(tuple(found), tuple(told), (files[0].specification.source, files[1].specification.source))


def _compared(out: str, names: tuple[str, str], reports: Sequence[RunReport]) -> Compared:
    left, right = (each.guard for each in reports)
    session = reports[0].session
    assert left is not None
    assert right is not None
    assert session is not None
    return Compared(out, reports[0].recording, names, (left, right), session)


def _side(name: str, prepared: Prepared, some: Solved) -> Side:
    assert isinstance(some.find_play, Reasons)
    properties = tuple(Property(each.specification, each.formula, each.monitor) for each in prepared.compiled)
    return Side(name, some.guards, properties, some.find_play)


def _out_compared(left: Side, right: Side, out: str, trial: Trial, recordings: tuple[Compared, ...]) -> OutCompared:
    """What is known of all runs, by the game of both and, where that decides nothing, by trying."""
    names, undecided = (left.name, right.name), ""
    try:
        beside = Beside(left, right, out)
        found = {each.passes: trial.checked(each) for each in beside.differences()}
        if beside.is_partial:
            undecided = "runs in which several clocks are running when one passes its bound"
    except NotDecidedError as error:
        found, undecided = {}, str(error)
    is_open = {name for name in names if (found[name].example is None if name in found else undecided)}
    tried = trial.differences(is_open)
    is_open -= tried.keys()
    differences = tuple({**found, **tried}.values())
    return OutCompared(out, names, differences, undecided if is_open else "", trial.tried, recordings)


def _judged(prepared: Prepared, guarding: Guarding, path: Path, message_paths: Sequence[str]) -> RunReport:
    """What the guards of a file do with a recording. Raises UnusableInput if it cannot be used, or is damaged."""
    reading = ReadOptions(message_paths=tuple(message_paths))
    found = Judge(prepared.compiled, prepared.specification, reading, guarding=guarding).judge(path)
    if found.session is None or found.is_damaged:
        raise UnusableInput(found.diagnostics)
    return found
