"""Faults that can be planted: each is one small change of the code, or of the text that becomes code, of one room."""

from __future__ import annotations

import ast
import random
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import cycle, islice
from pathlib import Path

from benchmarks.planted.rooms import PROJECT, files

FLIPPED: dict[type[ast.cmpop], ast.cmpop] = {
    ast.Lt: ast.LtE(),
    ast.LtE: ast.Lt(),
    ast.Gt: ast.GtE(),
    ast.GtE: ast.Gt(),
    ast.Eq: ast.NotEq(),
    ast.NotEq: ast.Eq(),
    ast.Is: ast.IsNot(),
    ast.IsNot: ast.Is(),
    ast.In: ast.NotIn(),
    ast.NotIn: ast.In(),
}


IN_TEXT = {
    "<": "<=",
    "<=": "<",
    ">": ">=",
    ">=": ">",
    "==": "!=",
    "!=": "==",
    "===": "!==",
    "!==": "===",
    "&&": "||",
    "||": "&&",
    " and ": " or ",
    " or ": " and ",
    "not ": "",
    "true": "false",
    "false": "true",
    "True": "False",
    "False": "True",
    " + ": " - ",
    " - ": " + ",
}
"""What can stand in the place of a word of a template or a script."""
WORD = re.compile(
    "(?<![<=!>&|-])(?:" + "|".join(sorted(map(re.escape, IN_TEXT), key=len, reverse=True)) + ")(?![<=>&|\\w])"
)
PROSE = re.compile(r"\s*(#|//|/?\*|[A-Z][a-z]* [a-z]|<)")
"""Lines of a template or a script that say something to people only, or are marked up."""


@dataclass(frozen=True)
class Fault:
    """Other code in the place of some in a file."""

    room: str
    path: Path
    lines: range
    """From where the statement begins to where what is changed ends."""
    right: str
    wrong: str
    text: str
    """The whole file with the fault."""

    def __str__(self) -> str:
        return f"{self.path}:{self.lines.stop - 1}: `{shown(self.right)}` became `{shown(self.wrong)}`"


def shown(code: str) -> str:
    line = " ".join(code.split())
    return line if len(line) <= 70 else f"{line[:67]}..."


def changes(node: ast.AST) -> Iterator[str]:
    """What can stand in the place of `node`."""
    match node:
        case ast.Compare(left, [operator], [right]):
            yield ast.unparse(ast.Compare(left, [FLIPPED[type(operator)]], [right]))
        case ast.Constant(bool(value)):
            yield str(not value)
        case ast.Constant(int() | float() as value):
            yield from (repr(value + 1), repr(value - 1))
        case ast.BoolOp(operator, values):
            yield ast.unparse(ast.BoolOp(ast.Or() if isinstance(operator, ast.And) else ast.And(), values))
        case ast.UnaryOp(ast.Not(), operand):
            yield ast.unparse(operand)
        case ast.Call(function, [first, second, *rest], keywords) if not isinstance(second, ast.Starred):
            yield ast.unparse(ast.Call(function, [second, first, *rest], keywords))
        case ast.Assign() | ast.AugAssign() | ast.Expr(ast.Call()) | ast.Raise() | ast.Continue() | ast.Break():
            yield "pass"
        case ast.Return(value) if value is not None:
            yield "return None"


def conditions(node: ast.AST) -> list[ast.expr]:
    """The conditions that `node` tests."""
    match node:
        case ast.If(test) | ast.While(test) | ast.IfExp(test):
            return [test]
        case ast.comprehension(ifs=tests):
            return tests
        case _:
            return []


def faults(room: str, path: Path) -> Iterator[Fault]:
    """Every fault that can be planted in a file."""
    source = (PROJECT / path).read_text(encoding="utf-8")
    return in_code(room, path, source) if path.suffix == ".py" else in_text(room, path, source)


def in_code(room: str, path: Path, source: str) -> Iterator[Fault]:
    code = source.encode()
    lines = code.splitlines(keepends=True)
    statements = [
        node
        for f in ast.walk(ast.parse(source))
        if isinstance(f, ast.FunctionDef)
        for n in f.body
        for node in within(n)
    ]
    for node, first in dict.fromkeys(statements):
        found: list[tuple[ast.AST, str]] = [(node, wrong) for wrong in changes(node)]
        found += [(test, f"not ({ast.unparse(test)})") for test in conditions(node)]
        for place, wrong in found:
            assert isinstance(place, ast.expr | ast.stmt)
            if wrong == ast.unparse(place):
                continue
            assert place.end_lineno is not None
            assert place.end_col_offset is not None
            start = sum(map(len, lines[: place.lineno - 1])) + place.col_offset
            end = sum(map(len, lines[: place.end_lineno - 1])) + place.end_col_offset
            bracketed = wrong if isinstance(place, ast.stmt) else f"({wrong})"
            changed = (code[:start] + bracketed.encode() + code[end:]).decode()
            yield Fault(room, path, range(first, place.end_lineno + 1), code[start:end].decode(), wrong, changed)


def within(statement: ast.stmt) -> Iterator[tuple[ast.AST, int]]:
    """What a statement consists of, each with the line on which the innermost statement that it is part of begins."""
    found: list[tuple[ast.AST, int]] = [(statement, statement.lineno)]
    while found:
        node, first = found.pop()
        yield node, first
        found += [
            (child, child.lineno if isinstance(child, ast.stmt) else first) for child in ast.iter_child_nodes(node)
        ]


def in_text(room: str, path: Path, source: str) -> Iterator[Fault]:
    place = 0
    for number, line in enumerate(source.splitlines(keepends=True), 1):
        if not PROSE.match(line):
            for found in WORD.finditer(line):
                start, end = place + found.start(), place + found.end()
                wrong = IN_TEXT[found[0]]
                changed = line[: found.start()] + wrong + line[found.end() :]
                yield Fault(room, path, range(number, number + 1), line, changed, source[:start] + wrong + source[end:])
        place += len(line)


def chosen(rooms: Sequence[str], count: int, seed: int) -> list[Fault]:
    """Faults at random, as many in one room as in another; files by how many there can be in them."""
    chance = random.Random(seed)
    inside = files()
    pools = {room: [f for path in inside[room] for f in faults(room, path)] for room in rooms}
    return [chance.choice(pools[room]) for room in islice(cycle(rooms), count)]
