"""Asks all questions about a specification, within a budget: what was found so far is never lost.

Letters and monitors first, once for all; then each property by itself, the quick questions first; then properties
together. Each stage has a share of the time and runs in child processes, which a question that explodes cannot outlive.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from ltlc.analysis.findings import Finding
from ltlc.analysis.letters import Letters, letters_of
from ltlc.analysis.questions import AMONG_OTHERS, OF_FILES, OF_ONE, OF_SEVERAL, PEDANTIC
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import listed
from ltlc.automata import translate
from ltlc.diagnostics import Diagnostic, Label
from ltlc.limits import Budget, Exceeded, Watch, run_all
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.encodings import Encoding, encode
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.words import Letter
from ltlc.source import Span
from ltlc.specification.atoms import Atom
from ltlc.specification.specification import PropertySpecification, Specification

MONITORS, ALONE, TOGETHER = 0.3, 0.5, 1.0
"""The share of the time that is left that the stages may use: monitors, properties by themselves, and together."""

OF_A_STAGE = 0.25
"""The share of a stage that one job of it may use."""

MOST_NAMED = 3
"""So many properties, or atoms, are named when a question was not decided; of others, the number is given."""


@dataclass(frozen=True, slots=True)
class Report:
    """What was found, in the order of the text, and the properties with what was made of them."""

    study: Study
    diagnostics: tuple[Diagnostic, ...]


@dataclass(frozen=True, slots=True)
class _Job:
    """Something to find out, the question that it answers, and the properties that it is about."""

    question: str
    about: tuple[Subject, ...]
    do: Callable[[], list[Finding]]


def analyse(
    specification: Specification,
    encoding: Encoding,
    budget: Budget,
    message_paths: Sequence[str] = (),
    watch: Watch | None = None,
    *,
    pedantic: bool = False,
) -> Report:
    """All that is to be said about `specification`, within `budget` for everything together.

    If `pedantic`, also what is opinion rather than fault. `watch` is told how far each stage is. Raises SpotMissing.
    """
    stages = _Stages(budget, watch)
    study = replace(_study(specification, encoding, stages, message_paths), pedantic=pedantic)
    findings = [
        *_undecided_letters(study),
        *_without_monitor(study),
        *stages.ask(list(_alone(study)), ALONE),
        *stages.ask(list(_together(study)), TOGETHER),
    ]
    ordered = sorted(findings, key=lambda finding: (finding.place.start, finding.code))
    return Report(study, tuple(finding.diagnostic(specification.source) for finding in ordered))


def study_of(
    specification: Specification, encoding: Encoding, budget: Budget, message_paths: Sequence[str] = ()
) -> Study:
    """What the analyses of `specification` share, made within `budget`. Raises SpotMissing."""
    return _study(specification, encoding, _Stages(budget), message_paths)


def _study(specification: Specification, encoding: Encoding, stages: _Stages, message_paths: Sequence[str]) -> Study:
    from ltlc.automata import engine  # noqa: F401  once here, not in each child

    letters = letters_of([p.atoms for p in specification.properties], stages.solve)
    subjects = _subjects(specification, encoding, letters, stages)
    return Study(specification, encoding, letters, subjects, tuple(message_paths))


class _Stages:
    """Runs jobs in children, each stage within its share of what is left of the budget."""

    def __init__(self, budget: Budget, watch: Watch | None = None) -> None:
        self._budget = budget
        self._watch = watch
        self._deadline = time.monotonic() + budget.seconds

    def solve(self, atoms: Sequence[Atom]) -> Sequence[Letter] | None:
        """Ask z3 which of `atoms` can hold together."""
        from ltlc.analysis import solving

        (found,) = self.run([partial(solving.valuations, atoms)], MONITORS)
        return None if isinstance(found, Exceeded) else found

    def run(self, jobs: Sequence[Callable[[], object]], share: float) -> list[Any]:
        """The outcome of each job."""
        seconds = max(0.0, self._deadline - time.monotonic()) * share
        of_a_job = Budget(max(0.01, seconds * OF_A_STAGE), self._budget.megabytes)
        return run_all(jobs, of_a_job, seconds, self._watch)

    def ask(self, jobs: Sequence[_Job], share: float) -> Iterator[Finding]:
        """What the jobs find, and what they do not decide, question by question."""
        undecided: dict[str, list[tuple[_Job, Exceeded]]] = {}
        for job, outcome in zip(jobs, self.run([job.do for job in jobs], share), strict=True):
            if isinstance(outcome, Exceeded):
                undecided.setdefault(job.question, []).append((job, outcome))
            else:
                yield from outcome
        for question, open_ in undecided.items():
            yield _not_decided(question, [s for job, _ in open_ for s in job.about], _reason(open_[0][1]))


def _subjects(
    specification: Specification, encoding: Encoding, letters: Letters, stages: _Stages
) -> tuple[Subject, ...]:
    """Each property with its formula, its letters and its monitor."""
    formulas = [encode(p.property, encoding) for p in specification.properties]
    alphabets = [letters.alphabet(p.alphabet.atoms) for p in specification.properties]
    jobs = [partial(translate, formula, alphabet) for formula, alphabet in zip(formulas, alphabets, strict=True)]
    parts = zip(specification.properties, formulas, alphabets, stages.run(jobs, MONITORS), strict=True)
    return tuple(_subject(number, *each) for number, each in enumerate(parts))


def _subject(
    number: int,
    specification: PropertySpecification,
    formula: Formula,
    alphabet: Alphabet,
    outcome: Monitor | Exceeded,
) -> Subject:
    if isinstance(outcome, Exceeded):
        return Subject(number, specification, formula, alphabet, None, _sentence(str(outcome)))
    return Subject(number, specification, formula, alphabet, outcome)


def _reason(outcome: Exceeded) -> str:
    """Why a question was not decided, in the words of what gave up, or of the limit."""
    return _sentence(outcome.detail or f"it {outcome}")


def _sentence(text: str) -> str:
    """The first sentence of what an engine says."""
    return text.partition(".  ")[0]


def _alone(study: Study) -> Iterator[_Job]:
    for question in OF_FILES:
        yield _Job(question.text, (), partial(_all, question.ask, study))
    for question_ in OF_ONE + PEDANTIC * study.pedantic:
        for subject in study.subjects:
            yield _Job(question_.text, (subject,), partial(_all, question_.ask, study, subject))


def _together(study: Study) -> Iterator[_Job]:
    for joint in OF_SEVERAL:
        for component in study.components:
            if len(component) > 1:
                yield _Job(joint.text, component, partial(_all, joint.ask, study, component))
    for question in AMONG_OTHERS:
        for subject in study.subjects:
            yield _Job(question.text, (subject,), partial(_all, question.ask, study, subject))


def _all(ask: Callable[..., Iterable[Finding]], *about: object) -> list[Finding]:
    return list(ask(*about))


def _undecided_letters(study: Study) -> Iterator[Finding]:
    """Atoms whose arithmetic is too hard: of them, more is taken to be possible than may be."""
    for atoms in study.letters.undecided:
        yield Finding(
            "LTL690",
            atoms[0].span,
            f"not decided: which of {_some([atom.name for atom in atoms])} can hold together",
            help="their arithmetic is too hard: a finding that depends on it may be missing",
        )


def _some(names: Sequence[str]) -> str:
    """The first of `names`, and how many others there are."""
    shown = [f"`{name}`" for name in names[:MOST_NAMED]]
    others = len(names) - MOST_NAMED
    if others > 0:
        shown.append(f"{others} other{'' if others == 1 else 's'}")
    return listed(shown)


def _without_monitor(study: Study) -> Iterator[Finding]:
    subjects = [subject for subject in study.subjects if subject.monitor is None]
    for obstacle in dict.fromkeys(subject.obstacle for subject in subjects):
        hindered = [subject for subject in subjects if subject.obstacle == obstacle]
        yield _not_decided("any run satisfies it, and whether it can fail", hindered, f"its monitor {obstacle}")


def _not_decided(question: str, subjects: Sequence[Subject], reason: str) -> Finding:
    """A note that a question stays open, and about which properties."""
    if not subjects:
        return Finding("LTL690", Span(0, 0), f"not decided: whether {question} ({reason})")
    return Finding(
        "LTL690",
        subjects[0].specification.span,
        f"not decided for {_some([subject.label for subject in subjects])}: whether {question} ({reason})",
        secondary=tuple(Label(s.specification.span) for s in subjects[1:MOST_NAMED]),
        help="allow more time with `--budget SECONDS,MB`",
    )
