"""Changes of emitted text that reading it back has to refuse, and whether one changes a verdict of some run."""

from __future__ import annotations

import ast
import copy
import random
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from code_mutants import VERDICTS

from ltlc.assurance.lowered.letters import Judged
from ltlc.assurance.programs import load
from ltlc.assurance.reading.files import Written, told, written
from ltlc.assurance.reading.outcomes import Difference, ReadBack
from ltlc.assurance.reading.python import PythonFile
from ltlc.assurance.reading.trees import NotUnderstoodError
from ltlc.compiler import Compiled

FAULTS = (ArithmeticError, AttributeError, IndexError, NameError, RecursionError, RuntimeError, TypeError, ValueError)
"""What a changed class may raise: then it gives no verdict."""


def judged(compiled: Compiled) -> Judged:
    return Judged(compiled.specification, compiled.formula, compiled.monitor)


def read_back(text: str, compiled: Sequence[Compiled]) -> list[ReadBack | Difference]:
    """What reading `text` back says of each property."""
    parts = written(text, [each.machine for each in compiled], [each.specification for each in compiled])
    return [part if isinstance(part, Difference) else part.read_back() for part in parts]


BEFORE = """import math
from enum import Enum

INFINITY = math.inf
NEVER = 1 << 62

class Verdict(Enum):
    VIOLATED = "violated"
    PRESUMABLY_VIOLATED = "presumably_violated"
    PRESUMABLY_SATISFIED = "presumably_satisfied"
    SATISFIED = "satisfied"
    NOT_STARTED = "not_started"

VIOLATED, PRESUMABLY_VIOLATED, PRESUMABLY_SATISFIED, SATISFIED, NOT_STARTED = Verdict
"""


def read_in_time(text: str, compiled: Compiled) -> ReadBack | Difference:
    """What reading back says of the class `Emitted` in `text`, which stands alone there."""
    definitions = [node for node in ast.parse(text).body if isinstance(node, ast.FunctionDef | ast.ClassDef)]
    machine = compiled.machine
    try:
        file = PythonFile(BEFORE + "\n".join(map(ast.unparse, definitions)))
    except NotUnderstoodError as error:
        return Difference(str(error))
    if any(clock.age for clock in machine.clocks):  # such a class is called by programs
        return Written(machine, file, "Emitted", tuple(dict.fromkeys(map(told, machine.inputs)))).read_back()
    return Written(machine, file, "Emitted", machine.inputs, ages={}).read_back()


def text_mutants(text: str, class_name: str, chance: random.Random) -> Iterator[str]:
    """The module `text` with one thing changed in one class, of any kind at random, over and over."""
    classes = [node for node in ast.parse(text).body if isinstance(node, ast.ClassDef)]
    (written_,) = [ast.get_source_segment(text, node) or "" for node in classes if node.name == class_name]
    before, after = text.split(written_)
    right = ast.unparse(ast.parse(written_))
    while True:
        tree = ast.parse(written_)
        (found,) = tree.body
        assert isinstance(found, ast.ClassDef)
        if chance.choice(CHANGES)(found, chance):
            mutant = ast.unparse(ast.fix_missing_locations(tree))
            if mutant != right:
                yield f"{before}{mutant}{after}"


def _nodes(found: ast.ClassDef, kind: Any) -> list[Any]:
    return [node for node in ast.walk(found) if isinstance(node, kind)]


def _blocks(found: ast.ClassDef) -> list[list[ast.stmt]]:
    nodes = _nodes(found, (ast.FunctionDef, ast.If, ast.While))
    return [getattr(node, name) for node in nodes for name in ("body", "orelse") if getattr(node, name, None)]


def _without(found: ast.ClassDef, chance: random.Random) -> bool:
    """A statement is left out."""
    block = chance.choice(_blocks(found))
    del block[chance.randrange(len(block))]
    if not block:
        block.append(ast.Pass())
    return True


def _twice(found: ast.ClassDef, chance: random.Random) -> bool:
    """A statement is written twice, or in another place."""
    statement = copy.deepcopy(chance.choice(chance.choice(_blocks(found))))
    block = chance.choice(_blocks(found))
    block.insert(chance.randint(0, len(block)), statement)
    return True


def _exchanged(found: ast.ClassDef, chance: random.Random) -> bool:
    """Two statements change their places."""
    blocks = [block for block in _blocks(found) if len(block) > 1]
    if not blocks:
        return False
    block = chance.choice(blocks)
    at = chance.randrange(len(block) - 1)
    block[at], block[at + 1] = block[at + 1], block[at]
    return True


def _renamed(kind: Any, field: str) -> Callable[[ast.ClassDef, random.Random], bool]:
    def change(found: ast.ClassDef, chance: random.Random) -> bool:
        nodes = [node for node in _nodes(found, kind) if getattr(node, field) != "self"]
        if not nodes:
            return False
        setattr(chance.choice(nodes), field, getattr(chance.choice(nodes), field))
        return True

    return change


def _another_verdict(found: ast.ClassDef, chance: random.Random) -> bool:
    nodes = [node for node in _nodes(found, ast.Name) if node.id in VERDICTS]
    if nodes:
        chance.choice(nodes).id = chance.choice(VERDICTS)
    return bool(nodes)


def _another_number(found: ast.ClassDef, chance: random.Random) -> bool:
    """A number is moved, or that of another place."""
    nodes = [node for node in _nodes(found, ast.Constant) if type(node.value) in (int, float)]
    if not nodes:
        return False
    node, other = chance.choice(nodes), chance.choice(nodes)
    node.value = chance.choice(
        [node.value + 1, max(0, node.value - 1), other.value, node.value * 2, type(node.value)(0)]
    )
    return True


def _another_relation(found: ast.ClassDef, chance: random.Random) -> bool:
    nodes = [node for node in _nodes(found, ast.Compare) if len(node.ops) == 1 and not isinstance(node.ops[0], ast.In)]
    if not nodes:
        return False
    node = chance.choice(nodes)
    if chance.random() < 1 / 3:
        node.left, node.comparators = node.comparators[0], [node.left]
    else:
        node.ops = [chance.choice([ast.Lt, ast.LtE, ast.Gt, ast.GtE, ast.Eq, ast.NotEq])()]
    return True


def _another_logic(found: ast.ClassDef, chance: random.Random) -> bool:
    """A condition is negated, holds always or never, or is joined otherwise to another."""
    nodes = _nodes(found, (ast.If, ast.While))
    joined = _nodes(found, ast.BoolOp)
    if joined and chance.random() < 1 / 2:
        node = chance.choice(joined)
        if chance.random() < 1 / 2:
            node.op = ast.And() if isinstance(node.op, ast.Or) else ast.Or()
        else:
            del node.values[chance.randrange(len(node.values))]
        return len(node.values) > 1
    if not nodes:
        return False
    node = chance.choice(nodes)
    node.test = chance.choice([ast.UnaryOp(ast.Not(), node.test), ast.Constant(True), ast.Constant(False)])
    return True


def _another_operator(found: ast.ClassDef, chance: random.Random) -> bool:
    nodes = _nodes(found, (ast.BinOp, ast.AugAssign))
    if nodes:
        chance.choice(nodes).op = chance.choice([ast.Add, ast.Sub, ast.Mult])()
    return bool(nodes)


def _early_return(found: ast.ClassDef, chance: random.Random) -> bool:
    block = chance.choice(_blocks(found))
    value = chance.choice(["self.verdict", "SATISFIED", "VIOLATED"])
    block.insert(chance.randint(0, len(block)), ast.parse(f"return {value}").body[0])
    return True


CHANGES = (
    _without,
    _twice,
    _exchanged,
    _renamed(ast.Name, "id"),
    _renamed(ast.Attribute, "attr"),
    _another_verdict,
    _another_number,
    _another_relation,
    _another_logic,
    _another_operator,
    _early_return,
)


def verdicts_of(text: str, class_name: str, runs: Sequence[Sequence[dict[str, Any]]]) -> list[Any]:
    """The verdicts of the class in `text` on each of `runs`, steps by the names of their values; None after a fault."""
    found: list[Any] = []
    try:
        make = load(text, "emitted")[class_name]
    except (*FAULTS, SyntaxError):
        return [None]
    for run in runs:
        try:
            monitor = make()
            found.append([monitor.step(**step).value for step in run])
        except FAULTS:
            found.append(None)
    return found
