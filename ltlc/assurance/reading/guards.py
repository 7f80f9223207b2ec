"""What an emitted plan has of guards, read back to their programs."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from typing import Any

from ltlc.assurance.reading.python import PythonFile
from ltlc.assurance.reading.signals import data, expression_of, input_data
from ltlc.assurance.reading.trees import NotUnderstoodError
from ltlc.program.expressions import Expression
from ltlc.program.guards import GuardProgram
from ltlc.program.lowering import read
from ltlc.specification.guards import Fallback


def require_guards(file: PythonFile, said: ast.expr | None, programs: Sequence[GuardProgram]) -> None:
    """Raise NotUnderstoodError unless `said` are these programs, and nothing else."""
    found = said.elts if isinstance(said, ast.Tuple) else []
    if len(found) != len(programs):
        raise NotUnderstoodError(f"`plan` has {len(found)} guards, not {len(programs)}")
    for node, program in zip(found, programs, strict=True):
        match node:
            case ast.Call(ast.Name("GuardPlan"), [], keywords):
                of = {each.arg or "": each.value for each in keywords}
            case _:
                raise NotUnderstoodError("`plan` has a guard that is none")
        conditions = of.pop("conditions", None)
        if {name: _data(value) for name, value in of.items()} != _right(program):
            raise NotUnderstoodError(f"the guard of {program.guards[0].out} is not as it was lowered")
        _require_conditions(file, conditions, program)


def require_guarded_topics(file: PythonFile, programs: Sequence[GuardProgram]) -> None:
    """Raise NotUnderstoodError unless `topics_to_guard` says where commands come from, and what may be sent instead."""
    guards = [guard for program in programs for guard in program.guards]
    right = tuple(("GuardedTopic", guard.raw, guard.out, tuple(map(_fallback, guard.fallbacks))) for guard in guards)
    match file.names.only("topics_to_guard"):
        case ast.FunctionDef(body=[ast.Expr(ast.Constant(str())), ast.Return(ast.expr() as said)]) if (
            data(said) == right
        ):
            return
        case _:
            raise NotUnderstoodError("`topics_to_guard` does not name the topics and fallbacks of the guards")


def _fallback(fallback: Fallback) -> tuple[Any, ...]:
    return "Fallback", fallback.name, tuple((path, constant.value) for path, constant in fallback.values.items())


def _right(program: GuardProgram) -> dict[str, Any]:
    resting = program.resting
    return {
        "outs": tuple(guard.out for guard in program.guards),
        "lead": program.lead,
        "parts": program.parts,
        "assumed": tuple(sorted(program.assumed)),
        "spoken": program.spoken,
        "awaited": tuple(input_data(read(each)) for each in program.awaited),
        "most": program.most,
        "questions": tuple(("Asked", asks.name, of, number) for asks, of, number in resting.questions),
        "decisions": tuple(map(tuple, resting.decisions)),
        "rests": resting.root,
    }


def _data(node: ast.expr) -> Any:
    """As `data`, with questions by name."""
    match node:
        case ast.Tuple(elts):
            return tuple(map(_data, elts))
        case ast.Call(ast.Name("Asked"), [ast.Attribute(ast.Name("Asks"), name), *numbers], []):
            return ("Asked", name, *map(data, numbers))
        case _:
            return data(node)


def _require_conditions(file: PythonFile, node: ast.expr | None, program: GuardProgram) -> None:
    """What is asked of values is what the conditions are."""
    found = node.elts if isinstance(node, ast.Tuple) else []
    if len(found) != len(program.resting.conditions):
        raise NotUnderstoodError(f"the guard of {program.guards[0].out} holds other conditions")
    for each, held in zip(found, program.resting.conditions, strict=True):
        match each:
            case ast.Call(ast.Name("HeldCondition"), [inputs, known, holds, *first], []):
                given = tuple(map(read, held.inputs))
                had = data(first[0]) if first else (None,) * len(given)
                right: list[tuple[ast.expr, Expression]] = [(known, held.known), (holds, held.holds)]
                if (data(inputs), repr(had)) == (tuple(map(input_data, given)), repr(held.first)) and all(
                    expression_of(file, function, given) == expression for function, expression in right
                ):
                    continue
            case _:
                pass
        raise NotUnderstoodError(f"the guard of {program.guards[0].out} holds another condition than it should")
