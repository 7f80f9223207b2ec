"""The gate: what `build` requires of every property before anything is written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
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
    """A property to be judged: its monitor and, where there is any, its code as it runs and as it is written."""

    compiled: Compiled
    program: Program | None
    written: Written | Difference | None


def judge_all(
    compiled: Sequence[Compiled],
    programs: Sequence[Program] | None,
    messages: Messages,
    budget: Budget,
    watch: Watch | None = None,
    written: Sequence[Written | Difference] | None = None,
) -> list[Judgement | Exceeded]:
    """The judgement of each property, in order, or the limit of `budget` that judging it ran into.

    `programs` are the emitted code of each property, `written` its text, None where there is none; `messages` those of
    the specification. Properties are judged in child processes, as many at a time as there are CPUs; of those of one
    shape (see `shapes`) only one, unless that fails.
    """
    none = [None] * len(compiled)
    subjects = list(map(Subject, compiled, programs or none, written or none))
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
    """The judgement of each of `subjects`, by its number: its monitor and its code as jobs of their own."""
    jobs = [partial(half, subject, messages) for subject in subjects.values() for half in (_of_monitor, _of_code)]
    halves = iter(run_all(jobs, budget, watch=watch and partial(_halved, watch), patience=0))
    return {number: _joined(next(halves), next(halves)) for number in subjects}


def _halved(watch: Watch, done: int, jobs: int) -> None:
    """Count properties rather than jobs."""
    watch(done // 2, jobs // 2)


def _joined(of_monitor: Any, of_code: Any) -> Judgement | Exceeded:
    for half in (of_monitor, of_code):
        if isinstance(half, Exceeded):
            return half
    return Judgement(**of_monitor, **of_code)


def judge(subject: Subject, messages: Messages) -> Judgement:
    """The judgement of one property, in this process."""
    return Judgement(**_of_monitor(subject, messages), **_of_code(subject, messages))


def _of_monitor(subject: Subject, messages: Messages) -> dict[str, Any]:
    """What is judged of a property before there is any code."""
    compiled = subject.compiled
    return {
        "certificate": checked_certificate(compiled),
        "alphabet": foresight(compiled, _samples(compiled, messages)),
        "cross_check": cross_check(compiled),
        "machine": compare(compiled.machine, Judged(compiled.specification, compiled.formula, compiled.monitor)),
    }


def _of_code(subject: Subject, messages: Messages) -> dict[str, Any]:
    """What is judged of its code, run and read."""
    compiled, program, written = subject.compiled, subject.program, subject.written
    replayed = program and replay(compiled, program.start, program.runs(compiled, _samples(compiled, messages)))
    read_back = written if written is None or isinstance(written, Difference) else written.read_back()
    return {"replay": replayed, "reading": read_back}


def _samples(compiled: Compiled, messages: Messages) -> Samples:
    return Samples(without_news(compiled.specification), read(compiled.specification, messages))
