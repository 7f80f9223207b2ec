"""Two guards side by side: what one lets through and the other does not, at all, and of recordings."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from ltlc.analysis.errors import NotDecidedError
from ltlc.analysis.guards.differences import Beside, Difference, Side
from ltlc.analysis.guards.reasons import Reasons
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.errors import UnusableInput
from ltlc.base.limits import Budget
from ltlc.base.provenance import provenance
from ltlc.base.render.table import example_lines
from ltlc.base.source import Source
from ltlc.dataclass import dataclass
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

    If a run was not found, and there may be one, `undecided` says why.
    """

    out: str
    names: tuple[str, str]
    differences: tuple[Difference, ...]
    undecided: str
    recordings: tuple[Compared, ...]

    def lines(self) -> Iterator[str]:
        """It as text."""
        yield f"guard of {self.out}"
        found = {each.passes: each for each in self.differences}
        for name, other in (self.names, self.names[::-1]):
            if (difference := found.get(name)) is not None:
                yield ""
                yield f"{name} lets a command through that {other} does not: {difference.reason}"
                yield from (f"  {line}" for line in _run_lines(difference))
            elif not self.undecided:
                yield ""
                yield f"{name} lets nothing through that {other} does not, as long as they have done the same before"
        if self.undecided:
            yield ""
            yield f"what they let through was not compared: {self.undecided}"
        for each in self.recordings:
            yield ""
            yield from each.lines(MOST_LISTED)

    def document(self) -> dict[str, Any]:
        """It as JSON."""
        return {
            "out": self.out,
            "files": list(self.names),
            "undecided": self.undecided or None,
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
        return not any(each.undecided for each in self.topics)

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
    found = []
    for out in (out for out in left if out in right):
        sides = _side(names[0], files[0], left[out]), _side(names[1], files[1], right[out])
        differences, undecided = _differences(*sides, out)
        compared = [_compared(out, names, pair) for pair in reports]
        found.append(OutCompared(out, names, tuple(differences), undecided, tuple(compared)))
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


def _differences(left: Side, right: Side, out: str) -> tuple[list[Difference], str]:
    """Shortest runs at whose end only one lets a command through, or why they are not known."""
    try:
        return Beside(left, right, out).differences(), ""
    except NotDecidedError as error:
        return [], str(error)


def _judged(prepared: Prepared, guarding: Guarding, path: Path, message_paths: Sequence[str]) -> RunReport:
    """What the guards of a file do with a recording. Raises UnusableInput if it cannot be used, or is damaged."""
    reading = ReadOptions(message_paths=tuple(message_paths))
    found = Judge(prepared.compiled, prepared.specification, reading, guarding=guarding).judge(path)
    if found.session is None or found.is_damaged:
        raise UnusableInput(found.diagnostics)
    return found
