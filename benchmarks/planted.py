"""What share of planted faults the tests notice: `python -m benchmarks.planted --count 60 --seed 1`.

Each fault is one small change of the code of one room, chosen at random. The tests of that room run on a copy of the
project that has it; one that they pass with is a survivor. That they pass without any fault is seen to first.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from itertools import cycle, islice
from pathlib import Path
from queue import Queue

PROJECT = Path(__file__).parents[1]
COPIED = ("ltlc", "tests", "docs", "examples", "proofs", "benchmarks", "pyproject.toml", "README.md", "CHANGELOG.md")

ROOMS = {
    "semantics": "test_semantics_*.py test_diagrams.py test_runtime_episodes.py",
    "specification": "test_specification_*.py test_language_signals.py test_language_margins.py test_assurance_gate.py",
    "messages": "test_messages_definitions.py test_language_signals.py",
    "syntax": "test_syntax_parse.py test_language_files.py test_language_check.py",
    "language": "test_language_*.py test_ground_truth.py",
    "limits": "test_limits.py",
    "automata": "test_automata_*.py",
    "analysis": "test_analysis_*.py",
    "assurance": "test_assurance_*.py test_semantics_certificate.py",
    "comparison": "test_comparison_*.py test_commands_compare.py",
    "editor": "test_editor.py test_editor_server.py",
    "runtime": "test_runtime_*.py test_recordings.py",
    "recordings": "test_recordings*.py test_bags*.py test_tables.py",
    "columns": "test_columns*.py",
    "campaigns": "test_campaigns*.py",
    "mining": "test_mining.py",
    "backends": "test_backends_*.py test_assurance_replay.py test_ground_truth.py",
    "building": "test_commands_build.py test_assurance_reading_c.py test_backends_ament.py",
    "api": "test_api*.py",
    "serve": "test_serve.py",
    "commands": "test_commands_*.py test_recordings.py",
    "render": "test_render*.py",
}
"""The tests of each room."""

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


@dataclass(frozen=True)
class Fault:
    """Other code in the place of some in a file."""

    room: str
    path: Path
    line: int
    right: str
    wrong: str
    text: str
    """The whole file with the fault."""

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: `{shown(self.right)}` became `{shown(self.wrong)}`"


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
    return []


def faults(room: str, path: Path) -> Iterator[Fault]:
    """Every fault that can be planted in a file."""
    source = (PROJECT / path).read_text(encoding="utf-8")
    lines = source.encode().splitlines(keepends=True)
    tree = ast.parse(source)
    in_functions = [
        node for f in ast.walk(tree) if isinstance(f, ast.FunctionDef) for n in f.body for node in ast.walk(n)
    ]
    for node in dict.fromkeys(in_functions):
        found = [(node, wrong) for wrong in changes(node)]
        found += [(test, f"not ({ast.unparse(test)})") for test in conditions(node)]
        for place, wrong in found:
            assert isinstance(place, ast.expr | ast.stmt)
            assert place.end_lineno is not None
            assert place.end_col_offset is not None
            start = sum(map(len, lines[: place.lineno - 1])) + place.col_offset
            end = sum(map(len, lines[: place.end_lineno - 1])) + place.end_col_offset
            code = source.encode()
            right = code[start:end].decode()
            bracketed = wrong if isinstance(place, ast.stmt) else f"({wrong})"
            changed = (code[:start] + bracketed.encode() + code[end:]).decode()
            yield Fault(room, path, place.lineno, right, wrong, changed)


def chosen(rooms: Sequence[str], count: int, seed: int) -> list[Fault]:
    """Faults at random, as many in one room as in another; files by how many there can be in them."""
    chance = random.Random(seed)
    pools = {room: [f for path in files(room) for f in faults(room, path)] for room in rooms}
    return [chance.choice(pools[room]) for room in islice(cycle(rooms), count)]


def files(room: str) -> list[Path]:
    return sorted(path.relative_to(PROJECT) for path in (PROJECT / "ltlc" / room).rglob("*.py"))


def passes(folder: Path, room: str, seconds: float) -> bool:
    """Whether the tests of a room pass in a copy of the project; not if they take too long."""
    tests = sorted({str(t) for pattern in ROOMS[room].split() for t in (folder / "tests").glob(pattern)})
    command = [sys.executable, "-m", "pytest", "-x", "-q", *tests]
    environment = os.environ | {"PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1", "CI": "1"}
    process = subprocess.Popen(
        command,
        cwd=folder,
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    try:
        return process.wait(seconds) == 0
    except subprocess.TimeoutExpired:
        return False
    finally:
        with_children_ended(process)


def with_children_ended(process: subprocess.Popen[bytes]) -> None:
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def survives(copies: Queue[Path], seconds: float, fault: Fault) -> bool:
    folder = copies.get()
    place = folder / fault.path
    right = place.read_text(encoding="utf-8")
    try:
        place.write_text(fault.text, encoding="utf-8")
        survived = passes(folder, fault.room, seconds)
    finally:
        place.write_text(right, encoding="utf-8")
        copies.put(folder)
    print(f"{'SURVIVED' if survived else 'killed'}  {fault}", flush=True)
    return survived


def copied(folder: Path) -> Path:
    folder.mkdir()
    for name in COPIED:
        source = PROJECT / name
        if source.is_dir():
            shutil.copytree(source, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, folder / name)
    return folder


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rooms", nargs="+", choices=ROOMS, default=list(ROOMS))
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=300.0, help="how long the tests of a room may take")
    options = parser.parse_args()
    planted = chosen(options.rooms, options.count, options.seed)
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(options.jobs) as pool:
        copies: Queue[Path] = Queue()
        for number in range(options.jobs):
            copies.put(copied(Path(folder, f"copy{number}")))
        whole = copied(Path(folder, "whole"))
        passing = pool.map(lambda room: passes(whole, room, options.seconds), options.rooms)
        failing = [room for room, passed in zip(options.rooms, passing, strict=True) if not passed]
        if failing:
            sys.exit(f"without a fault the tests of these rooms do not pass: {', '.join(failing)}")
        survived = list(pool.map(partial(survives, copies, options.seconds), planted))
    lost = sum(survived)
    print(f"{options.count - lost} of {options.count} planted faults killed; survivors:")
    for fault, alive in zip(planted, survived, strict=True):
        if alive:
            print(f"  {fault}")


if __name__ == "__main__":
    main()
