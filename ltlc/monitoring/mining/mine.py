"""Finds the tightest values with which every recording passes, by asking each recording in turn."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from enum import Enum
from itertools import product
from math import inf, isfinite, isnan
from pathlib import Path
from typing import Any

from ltlc.automata import Budget
from ltlc.base.diagnostics import Diagnostic, Severity
from ltlc.base.limits import Watch
from ltlc.dataclass import dataclass
from ltlc.frontend.language.parameters import Role
from ltlc.inputs.recordings.reading import DEFAULT, ReadOptions
from ltlc.monitoring.judging.run import RunReport
from ltlc.monitoring.mining.oracle import Answer, Kept, Oracle, Outcome
from ltlc.monitoring.mining.search import Search
from ltlc.monitoring.mining.template import Sought, Template, Trial
from ltlc.runtime.reports import explanation
from ltlc.semantics.verdicts import Verdict


class Result(Enum):
    """The result for a value that was sought."""

    FOUND = "found"
    NONE = "no value passes"
    EVERY = "every value passes"
    NOT_STARTED = "not started"


@dataclass(frozen=True, slots=True)
class Failure:
    """A recording that fails with the value of `trial`."""

    recording: Path
    trial: Trial
    answer: Answer


@dataclass(frozen=True, slots=True)
class Measured:
    """By how much a property with a value holds in a recording: its JSON object and its line, as in `ltlc run`.

    Of those that a `forall` stands for, `label` says which it is. `least` is a lower bound of the margin: the margin
    itself, −∞ if it cannot be measured, and ∞ if no number decides it.
    """

    recording: Path
    label: str
    least: float
    report: Mapping[str, Any]
    sentence: str


@dataclass
class Finding:
    """What the recordings so far show of what is `sought`: all values from `number` on pass.

    `failure` is the recording that decides, with the next tighter value; where no value passes, with the weakest.
    `not_started` has the remarks of `ltlc run` on what did not, all of it or a part of what a `forall` stands for.
    `alone` has, of each recording that was asked for it, the tightest value with which it passes, None if none does.
    `measured` says of the value that was found, and of the rounded one, by how much each recording passes with it.
    """

    sought: Sought
    number: int = 0
    passes: bool = True
    failure: Failure | None = None
    started: list[Path] = field(default_factory=list)
    not_started: dict[Path, list[str]] = field(default_factory=dict)
    never_triggered: bool = True
    alone: dict[Path, int | None] = field(default_factory=dict)
    measured: dict[Trial, list[Measured]] = field(default_factory=dict)

    @property
    def result(self) -> Result:
        """The end of it."""
        if not self.passes:
            return Result.NONE
        if not self.started:
            return Result.NOT_STARTED
        is_least = self.number == 0 and self.sought.parameter.role is not Role.MARGIN
        return Result.EVERY if is_least else Result.FOUND

    @property
    def trial(self) -> Trial:
        """The tightest value, if there is one."""
        return Trial(self.sought, self.number)

    def shown(self, exact: bool) -> Trial:
        """The tightest value if that is to be `exact`, or else this rounded outwards."""
        return self.trial if exact else self.trial.rounded


@dataclass(frozen=True)
class Mined:
    """The results for all that was sought.

    `unusable` are those that cannot be read to their end, which say nothing. How often one was looked through is in
    `looks`.
    """

    template: Template
    findings: tuple[Finding, ...]
    recordings: tuple[Path, ...]
    unusable: tuple[Path, ...]
    diagnostics: tuple[Diagnostic, ...]
    looks: int

    @property
    def exit_code(self) -> int:
        """0 all found; 1 no value of one passes; 2 a recording is unusable; 3 nothing was to be learned of one."""
        results = {finding.result for finding in self.findings}
        if self.unusable:
            return 2
        if Result.NONE in results:
            return 1
        return 0 if results == {Result.FOUND} else 3

    def values(self, exact: bool = False) -> list[Trial] | None:
        """What was found, if all of it was: the tightest values if `exact`, or else these rounded outwards."""
        found = [finding.shown(exact) for finding in self.findings if finding.result is Result.FOUND]
        return found if len(found) == len(self.findings) else None


def mine(
    template: Template,
    paths: Sequence[Path],
    budget: Budget,
    watch: Watch | None = None,
    each: bool = False,
    reading: ReadOptions = DEFAULT,
    measures: bool = False,
) -> Mined:
    """The tightest values with which every recording at `paths` passes; with `each` also those of each by itself.

    If it `measures`, recordings are then read once more, for by how much they pass.

    Raises TooHardError and SpotMissing.
    """
    oracle = Oracle(template, budget, reading)
    findings = tuple(map(Finding, template.sought))
    unusable, diagnostics = [], []
    rounds = (False, True) if measures else (False,)
    for done, (is_measured, path) in enumerate(product(rounds, paths)):
        if watch is not None:
            watch(done, len(rounds) * len(paths))
        recording = Kept(path)
        problems = _measure(oracle, recording, findings) if is_measured else _ask(oracle, recording, findings, each)
        unusable += [path] if problems else []
        diagnostics += problems
    diagnostics += oracle.late([finding.trial for finding in findings if finding.passes])
    return Mined(template, findings, tuple(paths), tuple(unusable), tuple(diagnostics), oracle.looks)


def _ask(oracle: Oracle, recording: Kept, findings: Sequence[Finding], each: bool) -> list[Diagnostic]:
    """Add the findings of `recording` to `findings`, and return nothing; otherwise its errors."""
    searches = [(f, Search(0 if each else f.number, f.sought.values.last)) for f in findings if f.passes or each]
    while asked := [(finding, search) for finding, search in searches if not search.is_done]:
        trials = [Trial(finding.sought, number) for finding, search in asked for number in search.numbers()]
        report, answers = oracle.answers(recording, trials)
        if problems := _errors(report):
            return problems
        for finding, search in asked:
            of_it = {trial.number: answer for trial, answer in answers.items() if trial.sought is finding.sought}
            if not _learn(finding, search, recording, of_it):
                searches = [pair for pair in searches if pair[0] is not finding]
    _conclude(oracle, recording, searches, each)
    return []


def _errors(report: RunReport) -> list[Diagnostic]:
    return [each for each in report.diagnostics if each.severity is Severity.ERROR]


def _learn(finding: Finding, search: Search, recording: Kept, answers: Mapping[int, Answer]) -> bool:
    """Take a recording's results for some values; whether it has any."""
    outcomes = {number: answer.outcome for number, answer in answers.items()}
    answer = next(iter(answers.values()))
    waiting = [track for track in answer.tracks if track.verdict is Verdict.NOT_STARTED]
    if waiting:
        finding.not_started[recording.path] = [each for t in waiting for each in explanation(answer.session, t)]
    if Outcome.NOT_STARTED in outcomes.values():
        return False
    passes = {number: outcome is Outcome.PASSES for number, outcome in outcomes.items()}
    search.learn(passes)
    weakest = max((number for number, does in passes.items() if not does), default=None)
    if weakest is not None:
        search.hints = list(_hints(Trial(finding.sought, weakest), answers[weakest], recording))
    tracks = [track for answer in answers.values() for track in answer.tracks]
    finding.never_triggered &= all(track.never_triggered for track in tracks)
    return True


def _hints(trial: Trial, answer: Answer, recording: Kept) -> Iterator[int]:
    """Where the next value may be that does not fail as that of `trial` does.

    For a number, that is what it was compared with; for a duration, how long it was until the next row.
    """
    values, role, moment = trial.sought.values, trial.sought.parameter.role, answer.failing.decided_at
    at = values.at(trial.number)
    if role is Role.DURATION:
        yield values.number(recording.length)
        if moment is not None and moment.by_time:
            yield values.number(at + 1 + recording.until_row(moment.time))
    for one, other in answer.compared:
        if role is not Role.MARGIN and at not in (one, other):
            continue
        near = abs(one - other) if role is Role.MARGIN else one if at == other else other
        if isfinite(near) or (role is not Role.DURATION and not isnan(near)):
            yield values.number(near)


def _conclude(oracle: Oracle, recording: Kept, searches: Sequence[tuple[Finding, Search]], each: bool) -> None:
    """Enter what was found in a recording, and how it fails with the next tighter value where that decides."""
    deciding = []
    for finding, search in searches:
        finding.started.append(recording.path)
        if each:
            finding.alone[recording.path] = search.found
        if finding.passes and search.high > finding.number:
            deciding.append((finding, Trial(finding.sought, search.high - 1)))
            finding.passes = search.found is not None
            finding.number = search.high if finding.passes else finding.number
    if deciding:
        _, answers = oracle.answers(recording, [trial for _, trial in deciding], finds_all=True)
        for finding, trial in deciding:
            finding.failure = Failure(recording.path, trial, answers[trial])


def _measure(oracle: Oracle, recording: Kept, findings: Sequence[Finding]) -> list[Diagnostic]:
    """Enter by how much `recording` passes with what was found, and return nothing; otherwise its errors."""
    found = [each for each in findings if each.result is Result.FOUND and recording.path in each.started]
    trials = {trial: each for each in found for trial in (each.trial, each.trial.rounded)}
    if not trials:
        return []
    from ltlc.monitoring.judging.robustness import robustness_report, robustness_sentence  # which few ask for

    report, answers = oracle.answers(recording, list(trials), measures=True)
    if problems := _errors(report):
        return problems
    for trial, finding in trials.items():
        session, curves = answers[trial].session, answers[trial].robustness
        for label in [track.property.label for track in answers[trial].tracks]:
            curve = curves[label]
            least = -inf if curve.reason else inf if curve.whole is None else curve.whole
            told = robustness_report(session, curve), robustness_sentence(session, curve)
            finding.measured.setdefault(trial, []).append(Measured(recording.path, label, least, *told))
    return []
