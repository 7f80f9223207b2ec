"""Asks all questions about a specification, within a budget: what was found so far is never lost.

Letters and monitors first, once for all; then each property by itself, the quick questions first; then properties
together. Each stage has a share of the time and runs in child processes, which a question that explodes cannot outlive.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain, combinations
from typing import Any

from ltlc.analysis.findings import Finding, once_of_copies
from ltlc.analysis.letters import Letters, Solve, letters_of, real_letters, with_messages
from ltlc.analysis.questions import AMONG_OTHERS, OF_FILES, OF_ONE, OF_SEVERAL, PEDANTIC
from ltlc.analysis.search import Shut
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import listed
from ltlc.automata import translate
from ltlc.automata.batch import Known, once_for_each_shape
from ltlc.base.diagnostics import Diagnostic, Label
from ltlc.base.limits import Budget, Exceeded, Watch, run_all
from ltlc.base.source import Span
from ltlc.dataclass import dataclass
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.encodings import Encoding, encode
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.words import Letter
from ltlc.specification.atoms import Atom, with_openings
from ltlc.specification.expressions import Current, Expression, Opening
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
    """Something to find out, the question that it answers, and the properties that it is about.

    Where one finds nothing, neither does another that answers the same question of the same `shape`.
    """

    question: str
    about: tuple[Subject, ...]
    do: Callable[[], list[Finding]]
    shape: Hashable = None


def analyse(
    specification: Specification,
    encoding: Encoding,
    budget: Budget,
    watch: Watch | None = None,
    *,
    pedantic: bool = False,
    controls: Sequence[str] = (),
) -> Report:
    """All findings about `specification`, within `budget` for everything together.

    If `pedantic`, also report matters of opinion, and what a controller can do that sends on the topics `controls`, if
    there are any. `watch` gets the progress of each stage. Raises SpotMissing.
    """
    stages = _Stages(budget, watch)
    study = replace(_study(specification, encoding, stages), pedantic=pedantic, controls=tuple(controls))
    findings = [
        *_undecided_letters(study),
        *_without_monitor(study),
        *stages.ask(list(_alone(study)), ALONE),
        *stages.ask(list(_together(study)), TOGETHER),
    ]
    names = {name for p in specification.properties for name in (*p.names.values(), *p.written.values())}
    ordered = sorted(once_of_copies(findings, names), key=lambda finding: (finding.place.start, finding.code))
    return Report(study, tuple(finding.diagnostic(specification.source) for finding in ordered))


def study_of(specification: Specification, encoding: Encoding, budget: Budget) -> Study:
    """What the analyses of `specification` share, made within `budget`. Raises SpotMissing."""
    return _study(specification, encoding, _Stages(budget))


def _study(specification: Specification, encoding: Encoding, stages: _Stages) -> Study:
    from ltlc.automata import engine  # noqa: F401  once here, not in each child

    messages = frozenset[str]().union(*(p.messages() for p in specification.properties))
    found = letters_of([p.atoms for p in specification.properties], stages.solve)
    letters = with_messages(found, messages, specification.rate is not None)
    known: Known = {}
    subjects = _subjects(specification, encoding, letters, stages, known)
    made = {shape: outcome for shape, outcome in known.items() if not isinstance(outcome, Exceeded)}
    return Study(specification, encoding, letters, subjects, made)


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
        for job, outcome in zip(jobs, self._outcomes(jobs, share), strict=True):
            if isinstance(outcome, Exceeded):
                undecided.setdefault(job.question, []).append((job, outcome))
            else:
                yield from outcome
        for question, open_ in undecided.items():
            yield _not_decided(question, [s for job, _ in open_ for s in job.about], _sentence(open_[0][1].reason))

    def _outcomes(self, jobs: Sequence[_Job], share: float) -> list[list[Finding] | Exceeded]:
        """The outcome of each job: one of each shape first, then those of the others that this does not answer."""
        keys = [(job.question, job.shape) if job.shape else number for number, job in enumerate(jobs)]
        first = {key: number for number, key in reversed([*enumerate(keys)])}
        examples = sorted(first.values())
        known = dict(zip(examples, self.run([jobs[n].do for n in examples], share), strict=True))
        known |= {n: [] for n, key in enumerate(keys) if known[first[key]] == []}
        left = [n for n in range(len(jobs)) if n not in known]
        known |= dict(zip(left, self.run([jobs[n].do for n in left], share), strict=True))
        return [known[number] for number in range(len(jobs))]


def _subjects(
    specification: Specification, encoding: Encoding, letters: Letters, stages: _Stages, known: Known
) -> tuple[Subject, ...]:
    """Each property with its formula, its letters and its monitor, which is added to what is `known`."""
    formulas = [encode(p.property, encoding) for p in specification.properties]
    alphabets = [letters.alphabet(p.alphabet.atoms) for p in specification.properties]
    tasks = list(zip(formulas, alphabets, strict=True))
    monitors = once_for_each_shape(
        tasks, lambda some: stages.run([partial(translate, *t) for t in some], MONITORS), known
    )
    shut = [_shut(p, stages.solve) for p in specification.properties]
    parts = zip(specification.properties, formulas, alphabets, monitors, shut, strict=True)
    return tuple(_subject(number, *each) for number, each in enumerate(parts))


def _shut(specification: PropertySpecification, solve: Solve) -> Shut:
    """The letters where some of the scopes are not open at whose opening a property takes values."""
    openings = specification.openings()
    clocks = tuple(dict.fromkeys(openings.values()))
    subsets = chain.from_iterable(combinations(range(len(clocks)), count) for count in range(1, len(clocks) + 1))
    found: dict[frozenset[int], Alphabet] = {}
    for numbers in subsets:
        shut = {opening for opening, clock in openings.items() if clocks.index(clock) in numbers}
        current = partial(with_openings, change=partial(_current, shut))
        atoms = [replace(atom, condition=current(atom.condition)) for atom in specification.atoms]
        found[frozenset(numbers)] = real_letters(atoms, solve).alphabet(atom.name for atom in atoms)
    return Shut(specification.scopes(), found)


def _current(shut: Collection[Opening], opening: Opening) -> Expression:
    return Current(opening.signal) if opening in shut else opening


def _subject(
    number: int,
    specification: PropertySpecification,
    formula: Formula,
    alphabet: Alphabet,
    outcome: Monitor | Exceeded,
    shut: Shut,
) -> Subject:
    if isinstance(outcome, Exceeded):
        return Subject(number, specification, formula, alphabet, None, _sentence(str(outcome)), shut)
    return Subject(number, specification, formula, alphabet, outcome, shut=shut)


def _sentence(text: str) -> str:
    """The first sentence of an engine's message."""
    return text.partition(".  ")[0]


def _alone(study: Study) -> Iterator[_Job]:
    for question in OF_FILES:
        yield _Job(question.text, (), partial(_all, question.ask, study))
    shapes = [study.shape((subject,)) for subject in study.subjects]
    for question_ in OF_ONE + PEDANTIC * study.pedantic:
        for subject, shape in zip(study.subjects, shapes, strict=True):
            yield _Job(question_.text, (subject,), partial(_all, question_.ask, study, subject), shape)


def _together(study: Study) -> Iterator[_Job]:
    shapes = [study.shape(component) for component in study.components]
    for joint in OF_SEVERAL:
        for component, shape in zip(study.components, shapes, strict=True):
            if len(component) > 1:
                yield _Job(joint.text, component, partial(_all, joint.ask, study, component), shape)
    among = {s.number: (shape, k) for c, shape in zip(study.components, shapes, strict=True) for k, s in enumerate(c)}
    for question in AMONG_OTHERS:
        for subject in study.subjects:
            ask = partial(_all, question.ask, study, subject)
            yield _Job(question.text, (subject,), ask, among.get(subject.number))


def _all(ask: Callable[..., Iterable[Finding]], *about: object) -> list[Finding]:
    return list(ask(*about))


def _undecided_letters(study: Study) -> Iterator[Finding]:
    """Atoms whose arithmetic is too hard: of them, more is taken to be possible than may be."""
    for atoms in study.letters.undecided:
        yield Finding(
            "LTL690",
            atoms[0].span,
            f"not decided: which of {_some([atom.name for atom in atoms])} can hold together",
            help="their arithmetic is too hard to decide: findings that depend on it may be missing",
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
