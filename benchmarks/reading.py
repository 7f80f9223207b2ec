"""What share of changes of emitted text reading it back refuses: `python -m benchmarks.reading [c] [COUNT] [SEED]`.

A change counts if it alters a verdict of some run. In time that is decided nanosecond by nanosecond, of properties with
bounds of a few; of random machines over random conditions, on random runs. COUNT changes that count are tried of each.
With `c` before COUNT, changes of C, compiled and run to see which alter a verdict.
With `whole` before COUNT, COUNT changes all over each emitted file of the examples, compared as whole files.
With `rust` before COUNT, COUNT changes all over Rust with `_rate_`, `each` and `each new`, read back.
With `time`, instead: what reading back takes of a build, of the examples and of the files given.
"""

from __future__ import annotations

import random
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from itertools import islice
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

import c_mutants
import emitted_mutants
from hypothesis import HealthCheck, Phase, given, seed, settings
from read_mutants import read_back, read_in_time, text_mutants, verdicts_of
from stepping import machines, samples, specification
from test_assurance_time import KINDS
from timed import Draw
from timed import compiled as compiled_in_time
from timed import specification as specification_in_time
from timed_mutants import class_text, code_differs

from ltlc.assurance.afresh import c as whole_c
from ltlc.assurance.afresh import python as whole_python
from ltlc.assurance.afresh.outcomes import Equal
from ltlc.assurance.c_programs import c_programs
from ltlc.assurance.gate import Subject, judge
from ltlc.assurance.messages import Messages
from ltlc.assurance.programs import programs
from ltlc.assurance.reading.c.files import WrittenInC
from ltlc.assurance.reading.c.files import written as written_in_c
from ltlc.assurance.reading.c.lexing import tokens
from ltlc.assurance.reading.c.parsing import parsed
from ltlc.assurance.reading.files import written
from ltlc.assurance.reading.outcomes import Difference, ReadBack, Written
from ltlc.assurance.reading.rust import require_same
from ltlc.assurance.reading.rust import written as written_in_rust
from ltlc.assurance.reading.rust_text import tokens as rust_tokens
from ltlc.assurance.reading.trees import NotUnderstoodError
from ltlc.automata import Budget
from ltlc.backends import emit
from ltlc.backends.c import Files
from ltlc.backends.c import emit as emit_c
from ltlc.backends.python import standalone_classes
from ltlc.backends.rust import file_of
from ltlc.backends.spelling import NotInTargetError
from ltlc.base.source import Source
from ltlc.compiler import Compiled, compile_specification
from ltlc.frontend.language import load_text
from ltlc.inputs.messages.definitions import MessageTypes, shipped
from ltlc.semantics.encodings import EPISODE
from ltlc.semantics.timed_atoms import timed_atoms

EACH_OF_C = 15
EACH = 100
"""How many changes of one class are tried."""

Outcome = tuple[bool, bool, str]
"""Whether a change alters a verdict, whether it is refused, and the text."""


def of_machines(chance: random.Random) -> Iterator[Outcome]:
    """Changes of the classes of random machines."""
    while True:
        drawn = _drawn(samples(), 100, chance)
        for each in _drawn(machines(), 30, chance):
            text = emit("python", [each], specification([each]))
            (name,) = [c.name for c in standalone_classes([each], "props.txt")]
            if not isinstance(read_back(text, [each])[0], ReadBack):
                raise AssertionError(f"refused as it is emitted: {read_back(text, [each])[0]}\n{text}")
            runs = _runs(each, drawn, chance)
            right = verdicts_of(text, name, runs)
            for mutant in islice(text_mutants(text, name, chance), EACH):
                differs = verdicts_of(mutant, name, runs) != right
                yield differs, isinstance(read_back(mutant, [each])[0], Difference), mutant


def _drawn(strategy: Any, count: int, chance: random.Random) -> list[Any]:
    found: list[Any] = []

    @seed(chance.getrandbits(32))
    @settings(max_examples=count, database=None, deadline=None, phases=[Phase.generate],
              suppress_health_check=list(HealthCheck))  # fmt: skip
    @given(strategy)
    def collect(value: Any) -> None:
        found.append(value)

    collect()
    return found


def _runs(each: Compiled, drawn: list[Any], chance: random.Random) -> list[list[dict[str, Any]]]:
    [written_] = standalone_classes([each], "props.txt")
    frames = [{name: values[signal] for name, signal in written_.parameters} for values in drawn]
    return [[chance.choice(frames) for _ in range(10)] for _ in range(30)]


def in_time(chance: random.Random) -> Iterator[Outcome]:
    """Changes of classes with clocks, with bounds of a few nanoseconds."""
    draw = Draw(chance)
    kinds = list(KINDS.values())
    while True:
        each = compiled_in_time(chance.choice(kinds)(3) if chance.random() < 1 / 2 else draw.property(1, 2))
        text = class_text(each)
        if not timed_atoms(each.formula):
            continue
        if not isinstance(read_in_time(text, each), ReadBack):
            raise AssertionError(f"refused as it is emitted: {read_in_time(text, each)}\n{text}")
        for mutant in islice(text_mutants(text, "Emitted", chance), EACH):
            try:
                differs = code_differs(each, mutant)
            except (AssertionError, RecursionError, IndexError, ArithmeticError, SyntaxError):
                continue
            yield differs, isinstance(read_in_time(mutant, each), Difference), mutant


def of_c_machines(chance: random.Random) -> Iterator[Outcome]:
    """Changes of the C of random machines."""
    while True:
        drawn = _drawn(samples(), 100, chance)
        for each in _drawn(machines(), 30, chance):
            try:
                files = emit_c([each], specification([each]))
            except NotInTargetError:
                continue
            if each.specification.inputs():
                yield from _of_c(each, files, c_mutants.runs_of(drawn, 60, chance), chance)


def of_c_in_time(chance: random.Random) -> Iterator[Outcome]:
    """Changes of C with clocks, with bounds of a few nanoseconds."""
    draw = Draw(chance)
    kinds = list(KINDS.values())
    while True:
        each = compiled_in_time(chance.choice(kinds)(3) if chance.random() < 1 / 2 else draw.property(1, 2))
        if timed_atoms(each.formula) and each.specification.inputs():
            files = emit_c([each], specification_in_time([each]))
            yield from _of_c(each, files, c_mutants.runs_in_time(150, chance), chance)


def _of_c(each: Compiled, files: Files, runs: list[c_mutants.Run], chance: random.Random) -> Iterator[Outcome]:
    found = c_mutants.read_back(files, [each])[0]
    if not isinstance(found, ReadBack):
        raise AssertionError(f"refused as it is emitted: {found}\n{files.source}")
    right = c_mutants.verdicts_of(files, runs)
    for mutant in islice(c_mutants.text_mutants(files, chance), EACH_OF_C):
        verdicts = c_mutants.verdicts_of(mutant, runs)
        if verdicts is not None:  # else no compiler takes it
            yield verdicts != right, isinstance(c_mutants.read_back(mutant, [each])[0], Difference), mutant.source


PYTHON = (("random machines", of_machines), ("clocks", in_time))
C = (("random machines in C", of_c_machines), ("clocks in C", of_c_in_time))


def campaign(
    kinds: Sequence[tuple[str, Callable[[random.Random], Iterator[Outcome]]]], count: int, number: int
) -> None:
    """Try changes until `count` of each kind alter a verdict, and say what became of them."""
    for name, changes in kinds:
        outcomes = Counter[tuple[bool, bool]]()
        for differs, refused, text in changes(random.Random(number)):
            outcomes[differs, refused] += 1
            if differs and not refused:
                print(f"NOT refused, of {name}:\n{text}")
            if outcomes[True, True] + outcomes[True, False] >= count:
                break
        wrong, others = (
            {refused: outcomes[differs, refused] for refused in (True, False)} for differs in (True, False)
        )
        print(
            f"{name}: {sum(wrong.values())} changes alter a verdict, {wrong[True]} of them are refused; of "
            f"{sum(others.values())} that altered none, {others[True]} are",
            flush=True,
        )


def whole(paths: Sequence[Path], count: int, chance: random.Random) -> None:
    """Change one thing after the other in whole files; what is accepted has to be the same tree, or so grouped."""
    outcomes = Counter[tuple[str, str]]()
    for path in paths:
        loaded, _ = load_text(Source(path.name, path.read_text()))
        assert loaded is not None
        compiled, _ = compile_specification(loaded, EPISODE, Budget(60.0, 1024))
        for target in ("python", "ros2"):
            text = emit(target, compiled, loaded)
            right = emitted_mutants.bare(text)
            for mutant in _some(emitted_mutants.python_mutants(text, min(1.0, 300 * count / len(text))), count, chance):
                is_equal = isinstance(whole_python.compare(mutant, text), Equal)
                is_same = emitted_mutants.is_python(mutant) and emitted_mutants.bare(mutant) == right
                outcomes[target, _outcome(is_equal, is_same)] += 1
        files = emit_c(compiled, loaded)
        source, types = files.source, parsed(files.header).types
        plain = _plain(source)
        for mutant in _some(emitted_mutants.c_mutants(source), count, chance):
            is_equal = isinstance(whole_c.compare(mutant, source, types), Equal)
            outcomes["c", _outcome(is_equal, is_equal and _plain(mutant) == plain)] += 1
    for (target, outcome), number in sorted(outcomes.items()):
        print(f"{target}: {number} {outcome}")


HEAD = """
decl id /track sensor_msgs/JoyFeedback.id
decl kind /track sensor_msgs/JoyFeedback.type
decl goal /goal std_msgs/Float64.data
decl done /done std_msgs/Float64.data
"""
RUST = (
    f"_rate_ = 30\n{HEAD}always (kind == 1 implies eventually goal > @{{goal, -1}} within 1 s)\nalways age(done) < 1 s",
    f"{HEAD}each g of id limit 9: always (kind == 1 implies eventually (kind == 2 or goal > 1) within 1 s)",
    f"{HEAD}each new goal limit 9: eventually (new done and done > @{{goal, opening}}) within 1 s",
)


def of_rust(count: int, chance: random.Random) -> None:
    """Change one token after the other in files of Rust; what is read back has to be the same but for parentheses."""
    outcomes = Counter[str]()
    for text in RUST:
        loaded, _ = load_text(Source("props.txt", text))
        assert loaded is not None
        compiled, _ = compile_specification(loaded, EPISODE, Budget(60.0, 1024))
        file = file_of(compiled, loaded)
        (part, *_) = written_in_rust(file.text, file.c.header, file.c.source, compiled, loaded.rate)
        assert isinstance(part, WrittenInC)
        plain = _plain_rust(file.text)
        for mutant in _some(emitted_mutants.rust_mutants(file.text), count, chance):
            try:
                require_same(mutant, part.definitions, [each.specification.label for each in compiled])
            except NotUnderstoodError:
                outcomes["refused"] += 1
            else:
                is_same = _plain_rust(mutant) == plain
                is_refused = not is_same and not _compiles(mutant)
                outcomes["accepted, but no Rust" if is_refused else _outcome(True, is_same)] += 1
    for outcome, number in sorted(outcomes.items()):
        print(f"rust: {number} {outcome}")


def _compiles(text: str) -> bool:
    """Whether a compiler takes it."""
    with TemporaryDirectory() as folder:
        command = ["rustc", "--edition=2021", "--crate-type=lib", "--emit=metadata", "-"]
        done = subprocess.run(command, cwd=folder, input=text, capture_output=True, text=True, check=False)
    return done.returncode == 0


def _plain_rust(text: str) -> list[str]:
    return [token.text for token in rust_tokens(text) if token.text not in "()"]


def _some(changes: Iterator[str], count: int, chance: random.Random) -> list[str]:
    """COUNT of many changes, wherever they are; each is a whole file, so that not all are kept."""
    found: list[str] = []
    for number, each in enumerate(changes):
        if len(found) < count:
            found.append(each)
        elif (place := chance.randrange(number + 1)) < count:
            found[place] = each
    return found


def _plain(text: str) -> list[str]:
    return [token.text for token in tokens(text) if token.text not in "()"]


def _outcome(is_equal: bool, is_same: bool) -> str:
    if is_equal:
        return "accepted, the same" if is_same else "ACCEPTED, and not the same"
    return "refused, though the same" if is_same else "refused"


def shares(paths: list[Path]) -> None:
    """What reading back takes, beside all that is made and judged of the same properties."""
    messages = Messages(MessageTypes(shipped()))
    print(
        "| file | properties | target | made and judged, s | of that read back, ms | share |\n|---|---|---|---|---|---|"
    )
    for path in paths:
        for target in ("python", "ros2", "c"):
            took = [_share(path, target, messages) for _ in range(3)]
            whole, reading = (median(values) for values in zip(*[each[:2] for each in took], strict=True))
            share = f"{100 * reading / whole:.1f} %"
            print(
                f"| {path.name} | {took[0][2]} | {target} | {whole:.2f} | {1000 * reading:.0f} | {share} |", flush=True
            )


def _share(path: Path, target: str, messages: Messages) -> tuple[float, float, int]:
    start = time.process_time()
    loaded, _ = load_text(Source(path.name, path.read_text()))
    assert loaded is not None
    compiled, _ = compile_specification(loaded, EPISODE, Budget(60.0, 1024))
    parts: Sequence[Written | Difference]
    if target == "c":
        files = emit_c(compiled, loaded, "props")
        found = c_programs(files, compiled, loaded, messages)
        before = time.process_time()
        parts = written_in_c(files.header, files.source, compiled, loaded.rate, loaded.timeout)
    else:
        text = emit(target, compiled, loaded)
        found = programs(target, text, compiled, loaded, messages)
        before = time.process_time()
        parts = written(text, [each.machine for each in compiled], [each.specification for each in compiled])
    reading = time.process_time() - before
    assert found is not None
    for each, program, part in zip(compiled, found, parts, strict=True):
        judge(Subject(each, program, None), messages)
        before = time.process_time()
        assert not isinstance(part, Difference)
        part.read_back()
        reading += time.process_time() - before
    return time.process_time() - start, reading, len(compiled)


if __name__ == "__main__":
    examples = sorted((Path(__file__).parents[1] / "examples").glob("**/*.txt"))
    if sys.argv[1:2] == ["time"]:
        shares([Path(name) for name in sys.argv[2:]] or examples)
    elif sys.argv[1:2] == ["rust"]:
        of_rust(int(sys.argv[2]) if sys.argv[2:] else 100, random.Random(0))
    elif sys.argv[1:2] == ["whole"]:
        whole(examples, int(sys.argv[2]) if sys.argv[2:] else 100, random.Random(0))
    else:
        is_c = sys.argv[1:2] == ["c"]
        numbers = [int(each) for each in sys.argv[2 if is_c else 1 :]]
        campaign(C if is_c else PYTHON, numbers[0] if numbers else 500, numbers[1] if len(numbers) > 1 else 0)
