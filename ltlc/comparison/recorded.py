"""On a recording: what the monitors of the candidates say, and from which step on the choice between them matters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from pathlib import Path

from ltlc.comparison.results import Answer, Monitored, Parting, Recorded
from ltlc.compiler import Compiled
from ltlc.diagnostics import Diagnostic
from ltlc.recordings.run import run
from ltlc.semantics.encodings import Encoding
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.specification import Specification


def judge_recording(
    path: Path, specification: Specification, answers: Sequence[Answer], encodings: Sequence[Encoding]
) -> tuple[list[Recorded] | None, tuple[Diagnostic, ...]]:
    """What the recording at `path` shows of each of `answers`, which are those of `specification` in its order.

    None if it cannot be used; the diagnostics say why, or what is odd about it.
    """
    by_name = {encoding.name: encoding for encoding in encodings}
    compiled, owners = [], []
    for number, (property_, answer) in enumerate(zip(specification.properties, answers, strict=True)):
        for measured in answer.measured:
            if isinstance(measured.monitored, Monitored):
                labelled = replace(property_, label=f"{property_.label} ({measured.name})")
                compiled.append(
                    Compiled(labelled, by_name[measured.name], measured.formula, measured.monitored.monitor)
                )
                owners.append((number, measured.name))
    report = run(compiled, specification, path, keep_verdicts=True)
    if report.session is None:
        return None, report.diagnostics
    verdicts: list[dict[str, list[Verdict]]] = [{} for _ in answers]
    for (number, name), track in zip(owners, report.session.tracks, strict=True):
        verdicts[number][name] = list(track.verdicts or ())
    return [_recorded(str(path), of_property) for of_property in verdicts], report.diagnostics


def _recorded(recording: str, verdicts: dict[str, list[Verdict]]) -> Recorded:
    steps = max(map(len, verdicts.values()), default=0)
    final = {name: each[-1] if each else Verdict.NOT_STARTED for name, each in verdicts.items()}
    pairs = combinations(verdicts, 2)
    partings = (_parting(left, right, verdicts[left], verdicts[right]) for left, right in pairs)
    return Recorded(recording, steps, final, tuple(parting for parting in partings if parting is not None))


def _parting(left: str, right: str, left_verdicts: list[Verdict], right_verdicts: list[Verdict]) -> Parting | None:
    for step, (in_left, in_right) in enumerate(zip(left_verdicts, right_verdicts, strict=True)):
        if in_left is not in_right:
            return Parting(left, right, step, in_left, in_right)
    return None
