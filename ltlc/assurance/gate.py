"""The gate: what `build` requires of every property before anything is written."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import islice
from typing import Any

from ltlc.assurance.certify import NotCertified
from ltlc.assurance.cross_check import cross_check
from ltlc.assurance.exactness import checked_certificate
from ltlc.assurance.foresight import Foreseen, Unforeseen, foresight
from ltlc.assurance.lowered.equality import Equal, compare
from ltlc.assurance.lowered.letters import Judged
from ltlc.assurance.messages import Messages
from ltlc.assurance.programs import Program
from ltlc.assurance.reading.outcomes import Difference, ReadBack, Written
from ltlc.assurance.replay import Deviation, Replayed, replay
from ltlc.assurance.runs import Agreement, Mismatch
from ltlc.assurance.shapes import renamed_certificate, shape_of
from ltlc.assurance.sources import read, without_news
from ltlc.assurance.values import Samples
from ltlc.automata import Budget, Exceeded
from ltlc.base.limits import Watch, run_all
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.semantics.certificate import Certificate
from ltlc.specification.shapes import Shape


@dataclass(frozen=True, slots=True)
class Judgement:
    """What the gate found of one property.

    `certificate` is one that the checker has accepted, as exact. `replay` is None where the target is not code that can
    be stepped, `reading` where it is not code that can be read back, `machine` where a property has no machine yet.
    """

    certificate: Certificate | NotCertified
    alphabet: Foreseen | Unforeseen
    cross_check: Agreement | Mismatch
    replay: Replayed | Deviation | None
    reading: ReadBack | Difference | None = None
    machine: Equal | Difference | None = None

    @property
    def passed(self) -> bool:
        """Whether the property may be emitted."""
        return (
            isinstance(self.certificate, Certificate)
            and isinstance(self.alphabet, Foreseen)
            and isinstance(self.cross_check, Agreement)
            and not isinstance(self.replay, Deviation)
            and not isinstance(self.reading, Difference)
            and not isinstance(self.machine, Difference)
        )


@dataclass(frozen=True)
class Subject:
    """A property to be judged: its monitor and, where there is any, its code as it runs and what is `written` in it."""

    compiled: Compiled
    program: Program | None
    written: Callable[[], Written | Difference] | None


def judge_all(
    compiled: Sequence[Compiled],
    programs: Sequence[Program] | None,
    messages: Messages,
    budget: Budget,
    watch: Watch | None = None,
    written: Callable[[], Sequence[Written | Difference]] | None = None,
) -> list[Judgement | Exceeded]:
    """The judgement of each property, in order, or the limit of `budget` that judging it ran into.

    `programs` are the emitted code of each property, None where there is none; `written` parses the output, and gives
    what it says of each. `messages` are those of the specification. Properties are judged in child processes, as many
    at a time as there are CPUs; of those of one shape (see `shapes`) only one, unless that fails.
    """
    parts = [written and partial(_part, written, number) for number in range(len(compiled))]
    none = [None] * len(compiled)
    subjects = list(map(Subject, compiled, programs or none, parts))
    if len(subjects) == 1:
        return [*_judge_each({0: subjects[0]}, messages, budget, watch).values()]
    shapes = [_shape(subject, number) for number, subject in enumerate(subjects)]
    first = {shape.key: number for number, shape in reversed([*enumerate(shapes)])}
    judged = _judge_each({n: subjects[n] for n in sorted(first.values())}, messages, budget, watch)
    for number, shape in enumerate(shapes):
        example = first[shape.key]
        found = judged[example]
        if isinstance(found, Exceeded):
            judged[number] = found
        elif number != example and (same := _renamed(found, shapes[example], shape, compiled[number])):
            judged[number] = same
    left = {n: subject for n, subject in enumerate(subjects) if n not in judged}
    judged |= _judge_each(left, messages, budget, watch)
    return [judged[number] for number in range(len(compiled))]


def _part(written: Callable[[], Sequence[Written | Difference]], number: int) -> Written | Difference:
    return written()[number]


def _shape(subject: Subject, number: int) -> Shape:
    """The shape of a property with its machine and its code.

    Of what is written and does not run, none other is known to have it.
    """
    shape = shape_of(subject.compiled)
    shape.add(subject.compiled.machine)
    if subject.program is not None:
        subject.program.describe(shape)
    elif subject.written is not None:
        shape.add(number)
    return shape


def _renamed(judgement: Judgement, example: Shape, shape: Shape, compiled: Compiled) -> Judgement | None:
    """The judgement of `example` as that of `compiled`, which has its shape; None if it is not good, or not that."""
    if not judgement.passed or not isinstance(judgement.certificate, Certificate):
        return None
    names = dict(zip(example.names, shape.names, strict=True))
    certificate = renamed_certificate(judgement.certificate, names, compiled)
    return None if certificate is None else replace(judgement, certificate=certificate)


def _judge_each(
    subjects: Mapping[int, Subject],
    messages: Messages,
    budget: Budget,
    watch: Watch | None,
) -> dict[int, Judgement | Exceeded]:
    """The judgement of each of `subjects`, by its number: each of the `_JUDGES` as a job of its own."""
    jobs = [partial(each, subject, messages) for subject in subjects.values() for each in _JUDGES]
    found = iter(run_all(jobs, budget, watch=watch and partial(_of_properties, watch), patience=0))
    return {number: _joined([*islice(found, len(_JUDGES))]) for number in subjects}


def _of_properties(watch: Watch, done: int, jobs: int) -> None:
    """Count properties rather than jobs."""
    watch(done // len(_JUDGES), jobs // len(_JUDGES))


def _joined(found: Sequence[dict[str, Any] | Exceeded]) -> Judgement | Exceeded:
    parts: dict[str, Any] = {}
    for each in found:
        if isinstance(each, Exceeded):
            return each
        parts |= each
    return Judgement(**parts)


def judge(subject: Subject, messages: Messages) -> Judgement:
    """The judgement of one property, in this process."""
    return Judgement(**{name: found for each in _JUDGES for name, found in each(subject, messages).items()})


def _of_monitor(subject: Subject, messages: Messages) -> dict[str, Any]:
    """What is judged of a property before there is any code."""
    compiled = subject.compiled
    return {
        "certificate": checked_certificate(compiled),
        "alphabet": foresight(compiled, _samples(compiled, messages)),
        "cross_check": cross_check(compiled),
        "machine": compare(compiled.machine, Judged(compiled.specification, compiled.formula, compiled.monitor)),
    }


def _of_program(subject: Subject, messages: Messages) -> dict[str, Any]:
    """What is judged of its code as it runs."""
    compiled, program = subject.compiled, subject.program
    return {"replay": program and replay(compiled, program.start, program.runs(compiled, _samples(compiled, messages)))}


def _of_text(subject: Subject, _: Messages) -> dict[str, Any]:
    """What is judged of its code as it is written."""
    written = subject.written and subject.written()
    return {"reading": written if written is None or isinstance(written, Difference) else written.read_back()}


_JUDGES = (_of_monitor, _of_program, _of_text)


def _samples(compiled: Compiled, messages: Messages) -> Samples:
    return Samples(without_news(compiled.specification), read(compiled.specification, messages))
