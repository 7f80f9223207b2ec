"""What tests of the replay need: a specification, its emitted text, and the judgement of that text, faults and all."""

from __future__ import annotations

from contextlib import nullcontext

from code_mutants import code_mutants, difference
from effort import fewer_runs
from stepping import from_text

from ltlc.assurance.messages import Messages
from ltlc.assurance.programs import Program, Standalone, load, programs
from ltlc.assurance.replay import Deviation, Replayed, replay
from ltlc.assurance.sources import read, without_news
from ltlc.assurance.values import Samples
from ltlc.backends import emit
from ltlc.backends.python import standalone_classes
from ltlc.compiler import Compiled
from ltlc.inputs.messages.definitions import MessageTypes, shipped

MESSAGES = Messages(MessageTypes(shipped()))


def samples(compiled: Compiled) -> Samples:
    return Samples(without_news(compiled.specification), read(compiled.specification, MESSAGES))


def judged(compiled: Compiled, program: Program) -> Replayed | Deviation:
    return replay(compiled, program.start, program.runs(compiled, samples(compiled)))


def is_right(compiled: Compiled, program: Program) -> bool:
    """Whether the replay finds nothing, on a share of its runs."""
    with fewer_runs():
        return isinstance(judged(compiled, program), Replayed)


def outcomes(text: str, target: str, *fault: str) -> list[Replayed | Deviation]:
    """What the replay says of each property; `fault` is a text of the emitted code and what it is replaced by."""
    compiled, specification = from_text(text)
    emitted = emit(target, compiled, specification)
    if fault:
        right, wrong = fault
        assert right in emitted
        emitted = emitted.replace(right, wrong)
    found = programs(target, emitted, compiled, specification, MESSAGES)
    assert found is not None
    with nullcontext() if fault else fewer_runs():
        return [judged(c, program) for c, program in zip(compiled, found, strict=True)]


def missed_changes(text: str) -> tuple[Compiled, list[str]]:
    """The only property of `text`, and the lines of the `python` target that can be changed and pass the replay."""
    compiled, specification = from_text(text)
    emitted = emit("python", compiled, specification)
    (written,) = standalone_classes(compiled, specification.source.name)

    def program_of(module: str) -> Standalone:
        return Standalone(load(module, "mutant")[written.name], written.parameters)

    runs = list(program_of(emitted).runs(compiled[0], samples(compiled[0])))
    return compiled[0], [
        difference(emitted, mutant)
        for mutant in code_mutants(emitted, written.name)
        if isinstance(replay(compiled[0], program_of(mutant).start, runs), Replayed)
    ]
