"""Small changes to emitted Python code: what the replay has to notice."""

from __future__ import annotations

import ast
import difflib
from collections.abc import Callable, Iterator
from functools import partial
from itertools import islice

Change = Callable[[], None]
VERDICTS = ("VIOLATED", "PRESUMABLY_VIOLATED", "PRESUMABLY_SATISFIED", "SATISFIED")
SWAPPED: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
}


def code_mutants(text: str, class_name: str) -> Iterator[str]:
    """The module `text` with one thing changed in the methods of one class, over and over.

    A comparison is turned or shifted, a number moved, a verdict or a branch exchanged, an `and` made an `or`; a clock
    is not set where it was, or set where it was not.
    """
    return (mutant() for mutant in mutations(text, class_name))


def mutations(text: str, class_name: str) -> list[Callable[[], str]]:
    """What makes each of the mutants: of many, few are tried."""
    (found,) = (node for node in ast.parse(text).body if isinstance(node, ast.ClassDef) and node.name == class_name)
    lines = text.splitlines(keepends=True)
    before, after = lines[: found.lineno - 1], lines[found.end_lineno :]
    written = "".join(lines[found.lineno - 1 : found.end_lineno])

    def mutant(number: int) -> str:
        changed = _class(written)
        change = next(islice(_places(changed), number, None))
        change()
        return "".join([*before, ast.unparse(changed), "\n", *after])

    return [partial(mutant, number) for number, _ in enumerate(_places(_class(written)))]


def difference(text: str, mutant: str) -> str:
    """The lines of `mutant` that are not those of `text`."""
    before, after = (ast.unparse(ast.parse(each)).splitlines() for each in (text, mutant))
    lines = difflib.ndiff(before, after)
    return " | ".join(line[2:].strip() for line in lines if line.startswith("+ "))


def _class(text: str) -> ast.ClassDef:
    (found,) = ast.parse(text).body
    assert isinstance(found, ast.ClassDef)
    return found


def _places(tree: ast.ClassDef) -> Iterator[Change]:
    """For each change that can be made to `tree`, what makes it."""
    assignments = [node for node in ast.walk(tree) if isinstance(node, ast.Assign) and _sets_clock(node)]
    starts = [node for node in assignments if isinstance(node.value, ast.BinOp)]
    for method in tree.body:
        for node in ast.walk(method):
            yield from _changes(node)
            if starts:
                yield from _resets(node, starts[-1])


def _sets_clock(node: ast.AST) -> bool:
    match node:
        case ast.Assign(targets=[ast.Attribute(attr=name)]) if name.startswith("due"):
            return True
    return False


def _resets(node: ast.AST, start: ast.stmt) -> Iterator[Change]:
    match node:
        case ast.Assign(targets=[ast.Attribute(value=owner, attr=name)]) if _sets_clock(node):
            yield partial(setattr, node, "value", ast.Attribute(owner, name, ast.Load()))
        case ast.If(body=body, orelse=orelse):
            for block in (body, orelse):
                if block and not any(map(_sets_clock, block)):
                    yield partial(block.append, start)
        case _:
            pass


def _changes(node: ast.AST) -> Iterator[Change]:
    match node:
        case ast.Compare(ops=ops):
            for index, operator in enumerate(ops):
                if type(operator) in SWAPPED:
                    yield partial(ops.__setitem__, index, SWAPPED[type(operator)]())
        case ast.BoolOp(op=operator):
            other = ast.Or() if isinstance(operator, ast.And) else ast.And()
            yield partial(setattr, node, "op", other)
        case ast.Constant(value=bool() | str() | None):
            return
        case ast.Constant(value=int() | float() as value):
            yield partial(setattr, node, "value", value + 1)
            if value >= 1:
                yield partial(setattr, node, "value", value - 1)
        case ast.Attribute(attr=attribute) if attribute in VERDICTS:
            for verdict in VERDICTS:
                if verdict != attribute:
                    yield partial(setattr, node, "attr", verdict)
        case ast.If(body=body, orelse=orelse) if orelse:
            yield partial(vars(node).update, body=orelse, orelse=body)
        case ast.UnaryOp(op=ast.Not()):
            yield partial(setattr, node, "op", ast.UAdd())
        case _:
            pass
