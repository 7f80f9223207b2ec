"""Emitted C, compiled, against the machines it is made of, the reference value of expressions, and the runtime."""

from __future__ import annotations

import ctypes
import math
import os
import random
import re
import shutil
import subprocess
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from errno import ENOSPC
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from effort import fewer_runs, share_of
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from replaying import MESSAGES, judged
from stepping import (
    FLAG,
    FLAGS,
    MODE,
    NAMES,
    SCAN,
    X,
    Y,
    Z,
    expected,
    from_text,
    machines,
    never,
    samples,
    specification,
)
from support import signal
from timed import Draw
from timed import compiled as timed_compiled
from timed import specification as timed_specification
from timed_sessions import NEWS, Row, rows

from ltlc import cli
from ltlc.assurance import c_library
from ltlc.assurance.c_library import FLAGS as C_FLAGS
from ltlc.assurance.c_library import Library, compiler
from ltlc.assurance.c_programs import c_programs
from ltlc.assurance.compiled_program import VERDICTS
from ltlc.assurance.replay import Deviation, Replayed
from ltlc.backends.c import Files, emit
from ltlc.backends.c.code import comment
from ltlc.backends.c.library import FUNCTIONS
from ltlc.backends.python.load import load_plan
from ltlc.compiler import Compiled
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Session
from ltlc.runtime.times import NEVER, SECOND
from ltlc.semantics import ltl
from ltlc.specification import expressions as e
from ltlc.specification.evaluation import compare, letter
from ltlc.specification.expressions import Comparison, Condition, Count, Relation
from ltlc.specification.functions import Function
from ltlc.specification.shapes import Shape
from ltlc.specification.specification import fields
from ltlc.specification.wire import PRIMITIVES, Kind


@dataclass(frozen=True)
class Shy:
    """What is drawn, without its long text."""

    value: Any

    def __repr__(self) -> str:
        return "..."


PATH = compiler()
pytestmark = pytest.mark.skipif(PATH is None, reason="there is no C compiler here")

SIGNALS = (X, Y, Z, FLAG, MODE, SCAN, NAMES, FLAGS)


def library(files: Files) -> Library:
    assert PATH is not None
    return Library(files, PATH)


GENERATED = settings(deadline=None, phases=[Phase.generate], suppress_health_check=list(HealthCheck))
"""A failure is shown as it was found: to compile smaller and smaller files in search of a nicer one takes minutes."""


@settings(GENERATED, max_examples=4)
@given(st.data())
def test_any_machines_over_any_conditions_are_stepped_as_defined(data: st.DataObject) -> None:
    compiled = [data.draw(machines(most_states=6).map(Shy)).value for _ in range(15)]
    run = [data.draw(samples().map(Shy)).value for _ in range(12)]
    compiled = [one for one in compiled if one.specification.inputs()]
    files = emit(compiled, specification(compiled))
    monitors = library(files).monitors()
    for end, sample in enumerate(run, 1):
        assert monitors.step(end, sample, ())
        for number, one in enumerate(compiled):
            verdicts, invalid = expected(one, run[:end])
            shown, _, none, _ = monitors.show(number)
            assert (VERDICTS[shown].value, none) == (verdicts[-1], invalid)


TYPES = {
    name: PRIMITIVES[name]
    for name in ("float64", "float32", *(f"{u}int{b}" for u in ("", "u") for b in (8, 16, 32, 64)))
}
TYPED = {
    name: [e.Signal(f"{name}_{n}", e.ValueType.NUMBER, e.Field("/t", "m", (f"{name}{n}",), numbers)) for n in (1, 2)]
    for name, numbers in TYPES.items()
}
EDGES = [
    0.0,
    0.1,
    -0.1,
    1.0,
    2.5,
    -1.0,
    127.0,
    128.0,
    255.5,
    256.0,
    65535.0,
    2.0**31,
    2.0**32,
    2.0**53,
    2.0**63,
    2.0**64,
]
EDGES += [-(2.0**31), -(2.0**63), 1e300, math.inf, -math.inf, 0.30000001192092896]
WHOLE = [2**53 + 1, 2**63 - 1, -(2**63), 2**64 - 1, 2**64, -(2**63) - 1]


def _values(chance: random.Random) -> dict[e.Signal, Any]:
    """A value for each of `TYPED`, near the edges of their types."""
    drawn: dict[e.Signal, Any] = {}
    for name, signals in TYPED.items():
        for one in signals:
            value = chance.choice([*EDGES, *WHOLE, math.nan, chance.uniform(-300, 300)])
            drawn[one] = TYPES[name].nearest(value if value == value or TYPES[name].kind is not Kind.INTEGER else 0.0)
    return drawn


SAME = [
    Comparison(e.Current(one), relation, e.Current(one))
    for one in (TYPED["uint8"][0], TYPED["int64"][0], TYPED["float32"][0])
    for relation in Relation
]
"""What compilers warn of."""


def _comparison(chance: random.Random) -> Comparison:
    """Two numbers of any types, or one and a constant, with a margin or without one."""
    one, other = (chance.choice(chance.choice(list(TYPED.values()))) for _ in range(2))
    right: e.Expression = e.Current(other)
    if chance.random() < 1 / 2:
        value = chance.choice([*EDGES, *WHOLE])
        right = e.Number(one.numbers.nearest(value) if one.numbers.kind is Kind.SINGLE else value)
    left: e.Expression = e.Current(one)
    if not one.numbers.is_wide and chance.random() < 1 / 4:
        left = e.Negative(left) if chance.random() < 1 / 2 else e.Call(Function.ABS, (left,))
    relation, margin = chance.choice(list(Relation)), chance.choice([0.0, 0.0, 0.1, -0.1])
    sides = (left, right) if chance.random() < 1 / 2 else (right, left)
    return Comparison(sides[0], relation, sides[1], abs(margin) if relation is Relation.EQUAL else margin)


def test_numbers_of_all_types_are_compared_as_the_language_says() -> None:
    chance = random.Random(1)
    compiled = [never(condition) for condition in (*SAME, *(_comparison(chance) for _ in range(share_of(160))))]
    built = library(emit(compiled, specification(compiled)))
    for _ in range(share_of(80)):
        drawn, monitors = _values(chance), built.monitors()
        monitors.step(0, drawn, ())
        for number, one in enumerate(compiled):
            read = {i: drawn[i.signal] for i in one.specification.inputs()}
            nan = any(value != value for value in read.values())
            seen = None if nan else letter(one.specification.atoms, read)
            right = "not_started" if seen is None else "violated" if seen else "presumably_satisfied"
            assert VERDICTS[monitors.show(number)[0]].value == right, (one.specification.atoms[0].condition, read)


ARRAYS = {
    name: e.Signal(f"{name}s", e.ValueType.NUMBERS, e.Field("/t", "m", (f"{name}s",), numbers))
    for name, numbers in TYPES.items()
}


def _of_an_element(chance: random.Random) -> e.Expression:
    """An element of an array, perhaps of the message before, or something that is computed from it."""
    array = ARRAYS[chance.choice(["float64", "float32", *ARRAYS])]
    element = e.Element(e.Past(array, 1) if chance.random() < 1 / 4 else e.Current(array))
    if array.numbers.is_wide:
        return element
    other = e.Current(TYPED["float64"][0])
    made: list[e.Expression] = [
        element,
        e.Negative(element),
        *(e.Call(function, (element,)) for function in (Function.ABS, Function.SQRT)),
        *(e.Call(function, (element, other)) for function in (Function.MIN, Function.MAX)),
        e.Arithmetic(e.Operator.MINUS, element, other),
    ]
    return chance.choice(made)


def _of_elements(chance: random.Random) -> Comparison:
    """How many elements there are that one or two comparisons hold of, any, or none."""
    named: dict[str, Condition] = {}
    for name in ("a", "b")[: chance.choice([1, 1, 2])]:
        single = e.Current(chance.choice(TYPED[chance.choice(["int64", "uint64", *TYPED])]))
        sides = [_of_an_element(chance), single if chance.random() < 2 / 3 else _of_an_element(chance)]
        chance.shuffle(sides)
        margin = chance.choice([0.0, 0.0, 0.0, 0.1])
        named[name] = Comparison(sides[0], chance.choice(list(Relation)), sides[1], margin)
    parts: list[ltl.Formula] = [
        ltl.Not(ltl.Atom(name)) if chance.random() < 1 / 2 else ltl.Atom(name) for name in named
    ]
    connectives: list[type[ltl.And | ltl.Or]] = [ltl.And, ltl.Or]
    joined = parts[0] if len(parts) == 1 else chance.choice(connectives)(*parts)
    count = Count(joined, tuple(named.items()))
    return Comparison(
        count, chance.choice([Relation.AT_LEAST, Relation.LESS]), e.Number(chance.choice([1.0, 1.0, 2.0]))
    )


def _sample(chance: random.Random) -> dict[e.Signal, Any]:
    """A value for each of `TYPED`, and an array for each of `ARRAYS` in which much is NaN."""
    drawn = {signal: 0.0 if value != value else value for signal, value in _values(chance).items()}
    for name, array in ARRAYS.items():
        elements = [chance.choice([*EDGES, 3.0, *[math.nan] * 9]) for _ in range(chance.choice([1, 1, 3]))]
        drawn[array] = tuple(TYPES[name].nearest(value) for value in elements)
    return drawn


def test_elements_that_are_nan_do_not_count_whatever_they_are_compared_with() -> None:
    chance = random.Random(2)
    compiled = [never(_of_elements(chance)) for _ in range(share_of(200))]
    built = library(emit(compiled, specification(compiled)))
    for _ in range(share_of(40)):
        run, monitors = [_sample(chance), _sample(chance)], built.monitors()
        for time, drawn in enumerate(run):
            monitors.step(time, drawn, ())
        for number, one in enumerate(compiled):
            verdicts, _ = expected(one, run)
            shown = VERDICTS[monitors.show(number)[0]].value
            assert shown == verdicts[-1], (one.specification.atoms[0].condition, run)


@pytest.mark.parametrize("name", ["order_signed", "order_unsigned", "order_integers"])
def test_a_function_that_orders_an_integer_and_another_number_is_what_reading_back_takes_it_for(name: str) -> None:
    """`order(a, b) < 0.0` is read as `a < b`: so it must be, of NaN as well, under every relation."""
    left, right = {"order_signed": "int64 float64", "order_unsigned": "uint64 float64"}.get(
        name, "int64 uint64"
    ).split()
    types = {"int64": ctypes.c_int64, "uint64": ctypes.c_uint64, "float64": ctypes.c_double}
    with TemporaryDirectory() as folder:
        source, built = Path(folder, "order.c"), Path(folder, "order.so")
        source.write_text(f"#include <math.h>\n#include <stdint.h>\n{FUNCTIONS[name].replace('static ', '')}")
        subprocess.run([str(PATH), "-std=c99", "-O2", "-fPIC", "-shared", str(source), "-o", str(built)], check=True)
        order = getattr(ctypes.CDLL(str(built)), name)
    order.restype, order.argtypes = ctypes.c_double, [types[left], types[right]]
    values = [*EDGES, *WHOLE, math.nan, 2.0**63 - 1024, 2.0**53 - 1, -0.5]
    for one, other in product(values, values):
        a, b = TYPES[left].nearest(one), TYPES[right].nearest(other)
        found = order(int(a), int(b) if right != "float64" else b)
        for relation in Relation:
            assert compare(found, relation, 0.0) == compare(a, relation, b), (a, relation, b)


@pytest.mark.parametrize("rate", [None, 3e8])
@settings(GENERATED, max_examples=2)
@given(st.integers(0, 2**32), st.lists(rows(), min_size=8, max_size=8))
def test_properties_with_clocks_have_the_verdicts_of_the_runtime(
    rate: float | None, seed: int, recorded: list[list[Row]]
) -> None:
    draw = Draw(seed, NEWS)
    compiled = [timed_compiled(draw.property(), f"p{number}") for number in range(25)]
    of = timed_specification(compiled, rate)
    built, plan = library(emit(compiled, of)), load_plan(compiled, of)
    for run in recorded:
        rows, careful, late = ByRows(Session(plan)), built.monitors(), built.monitors()
        if draw.chance.random() < 1 / 3:
            rows.begin(run[0].time - 1)
            careful.begin(run[0].time - 1)
            late.begin(run[0].time - 1)
        for row, end in zip(run, [*(r.time for r in run[1:]), run[-1].time + 9], strict=True):
            known = {name: value for name, value in row.values.items() if f"/{name}" in rows.session.messages}
            if rate is not None and not known:
                continue
            rows.samples(row.time, tuple(known), tuple(known.values()))
            for monitors in (careful, late):
                assert monitors.step(
                    row.time, {signal(name): value for name, value in known.items()}, [f"/{name}" for name in known]
                )
            assert _shown(careful, compiled) == _known(rows)
            assert rate is not None or _shown(late, compiled) == _known(rows)
            for time in range(row.time, end + 1):
                rows.advance(time)
                careful.advance(time)
                assert _shown(careful, compiled) == _known(rows)
                if rate is None:
                    assert careful.next_deadline() == min([NEVER, *(track.due for track in rows.tracks)])


def test_the_ticks_of_a_property_begin_with_what_it_reads_itself() -> None:
    compiled, of = from_text(
        "_rate_ = 5\ndecl x /x Float64.data\ndecl y /y Float64.data\n"
        "a: never x > 2\nb: never y > 2\nc: always age(y) < 1 s\nd: never x + @{y, -1} > 9"
    )
    monitors, (x, y) = library(emit(compiled, of)).monitors(), _fields(compiled)
    monitors.begin(0)
    monitors.step(SECOND, {x: 3.0}, ["/x"])
    monitors.step(SECOND * 11 // 10, {y: 3.0}, ["/y"])
    monitors.advance(2 * SECOND)
    shown = [monitors.show(number) for number in range(4)]
    assert [(VERDICTS[verdict].value, since / SECOND) for verdict, _, _, since in shown] == [
        ("violated", 1.0),
        ("violated", 1.1),
        ("violated", 1.0),
        ("presumably_satisfied", 1.4),
    ]
    assert [steps for _, steps, _, _ in shown] == [6, 5, 11, 4]


def test_the_run_ends_after_the_first_step_of_any_property_whatever_the_order_of_ticks() -> None:
    text = "_rate_ = 1\n_timeout_ = 1.5\ndecl x /x Float64.data\ndecl y /y Float64.data\na: never x + @{x, -1} > 9\n"
    compiled, of = from_text(text + "b: never y > 2")
    monitors, (x, y) = library(emit(compiled, of)).monitors(), _fields(compiled)
    monitors.step(0, {x: 1.0}, ["/x"])
    monitors.step(SECOND // 4, {y: 1.0}, ["/y"])
    assert not monitors.step(9 * SECOND, {y: 3.0}, ["/y"])
    assert [monitors.show(number)[1] for number in range(2)] == [1, 2]


def _fields(compiled: Sequence[Compiled]) -> list[e.Signal]:
    """The signals that are read from messages."""
    read = (signal for each in compiled for i in each.specification.inputs() for signal, _ in fields(i.signal))
    return list(dict.fromkeys(read))


def _shown(monitors: Any, compiled: Sequence[Compiled]) -> list[tuple[str, int, int]]:
    shown = (monitors.show(number) for number in range(len(compiled)))
    return [(VERDICTS[verdict].value, steps, invalid) for verdict, steps, invalid, _ in shown]


def _known(rows: ByRows) -> list[tuple[str, int, int]]:
    return [(track.verdict.value, track.steps, track.invalid) for track in rows.tracks]


def outcomes(text: str, *fault: str) -> list[Replayed | Deviation]:
    """What the replay says of each property; `fault` is a text of the emitted code and what it is replaced by."""
    compiled, specification = from_text(text)
    files = emit(compiled, specification)
    if fault:
        assert fault[0] in files.source
        object.__setattr__(files, "source", files.source.replace(fault[0], fault[1]))
    found = c_programs(files, compiled, specification, MESSAGES)
    assert found is not None
    with nullcontext() if fault else fewer_runs():
        return [judged(c, program) for c, program in zip(compiled, found, strict=True)]


WRITTEN = {
    "scope": "after_until robot.distance.sign < 1, robot.distance.sign > 1, eventually robot.velocity < 0.1",
    "end": "_timeout_ = 1\nnever robot.velocity > 1",
    "rate": "_rate_ = 29.97\nalways (robot.velocity > 1 implies eventually robot.velocity < 0.5 within 1 s)",
    "ticks": "_rate_ = 7\ndecl x /x Float64.data\ndecl goal /goal String.data\n"
    "never x > 1\nalways (new goal implies eventually x < @{x, -1} within 1 s)\nalways age(goal) < 2 s",
    "float": "decl scan /scan LaserScan.ranges\nnever min(scan) < 0.3 and count(scan[2:] < 0.5) > 2 or sum(scan) > 3",
    "history": "object robot /tf TFMessage\n"
    "never @{robot.velocity, -1} > 1 and robot.position.x < @{robot.position.x, -2}",
    "history of what is computed": "decl x /x Float64.data\ndecl n /n Int64.data\n"
    "never @{x - n / 2, -2} > x\nafter @{abs(n), -1} > 3, eventually @{2 * x, -1} < n within 2 s",
    "history of a predicate": "decl x /x Float64.data\ndecl n /n Int64.data\ndecl mode /mode String.data\n"
    "never @{x > 1 and not n < 3, -2} and x > 3\n"
    'after @{mode == "a", -1}, eventually not @{not x == n, -1}\n',
    "last samples": "decl x /x Float32.data\ndecl n /n Int64.data\ndecl mode /mode String.data\ndecl on /on Bool.data\n"
    "never all(@{x, -3:} > 1) and @{x, -5} > 3 and count(@{n, -2:}[1:] > 3) > 1\n"
    'after any(@{mode, -1:} == "a") and all(@{on, -2:}), eventually mean(@{n - x, -2:}) > 3\n',
    "latch": "decl x /x Float64.data\ndecl n /n Int64.data\ndecl mode /mode String.data\n"
    "never abs(x - @{x, when new mode}) > 2\n"
    'after @{mode, when n > 1 and x < 3} == "home", eventually @{n, when not x <= 1} == n\n',
    "opening": "after_until robot.velocity > 1, robot.velocity < 0.5, "
    "always robot.position.x / @{robot.position.x, opening} < 2",
    "news": 'decl goal /goal String.data\nalways (new goal implies eventually goal == "home" within 2 s)',
    "age": "decl scan /scan LaserScan.ranges\ndecl x /x Float64.data\nalways (x > 1 implies age(scan) <= 200 ms)",
    "age at first": "decl x /x Float64.data\ninitially age(x) < 1 ns",
    "angle": "object robot /a Pose\nobject cone /b Pose\n"
    "after robot.orientation_between.cone > 2, eventually robot.orientation.roll < 1",
}


@pytest.mark.parametrize("settings", ["", "_rate_ = 5\n", "_timeout_ = 1\n"])
@pytest.mark.parametrize(
    "beside", ["", "decl x /x Float64.data\nnever x > 2\n", "decl x /x Float64.data\nnever new x\n"]
)
def test_what_reads_nothing_compiles_without_a_warning_and_begins_with_the_session(settings: str, beside: str) -> None:
    for outcome in outcomes(f"{settings}{beside}always 1 < 2\neventually 2 < 1\n"):
        assert isinstance(outcome, Replayed), outcome


@pytest.mark.parametrize("settings", ["", "_rate_ = 5\n", "_timeout_ = 1\n"])
def test_what_reads_nothing_is_judged_in_time(settings: str) -> None:
    for outcome in outcomes(f"{settings}eventually 2 < 1 within 1 s\nalways previously 1 < 2\n"):
        assert isinstance(outcome, Replayed), outcome


@pytest.mark.parametrize("text", WRITTEN.values(), ids=WRITTEN)
def test_emitted_c_does_what_its_monitors_and_the_definitions_say(text: str) -> None:
    assert all(isinstance(outcome, Replayed) for outcome in outcomes(text))


FAULTS = {
    "a comparison": ("scope", " < 1.0", " <= 1.0"),
    "a state": ("scope", "self->state = 2;", "self->state = 0;"),
    "the time of a verdict": ("rate", "self->since = time;", "self->since = time + 1;"),
    "a duration": ("rate", "INT64_C(1000000000)", "INT64_C(1000000001)"),
    "the fraction of a tick": ("rate", "ticks->next++;", "ticks->next += 2;"),
    "the end of a run": (
        "end",
        "monitors->end = time + INT64_C(1000000000)",
        "monitors->end = time + INT64_C(999999999)",
    ),
    "history": ("history", "_latest, 2u, 3u)", "_latest, 1u, 3u)"),
    "what is kept of an opening": ("opening", "->robot_position_x_opening = ", "->robot_position_x_opening = 0.0 * "),
    "a sum": ("float", "digits[1] += sign", "digits[1] -= sign"),
    "news": ("news", "self->due = time;", ""),
    "an age before the first step": ("age", "self->due_0 = time + INT64_C(200000000)", "self->due_0 = time"),
    "an undefined value": ("opening", "if (value != value)", "if (false)"),
    "NaN": ("scope", "self->invalid++;", ""),
    "when steps begin": ("scope", "signals->has_model_robot_odometry && signals", "signals"),
    "steps of all that comes together": ("age", "together ? 1u : 0u", "together ? 2u : 0u"),
    "time that goes back": ("rate", "time >= PROPS_NEVER || time < monitors->time", "time >= PROPS_NEVER"),
    "a time that no run has": ("float", "time >= PROPS_NEVER", "time > PROPS_NEVER"),
    "a time before 0": ("history", "    monitors->time = INT64_MIN;\n", ""),
    "what a call answers": (
        "news",
        "    return true;\n}\n\nint64_t props_next",
        "    return false;\n}\n\nint64_t props_next",
    ),
}


@pytest.mark.parametrize("fault", FAULTS.values(), ids=FAULTS)
def test_a_fault_in_emitted_c_is_noticed(fault: tuple[str, str, str]) -> None:
    text, right, wrong = fault
    assert any(isinstance(outcome, Deviation) for outcome in outcomes(WRITTEN[text], right, wrong))


def test_a_build_writes_three_files_that_were_replayed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "w.txt").write_text("always (robot.velocity > 1 implies eventually robot.velocity < 0.5 within 1 s)\n")
    assert cli.main(["build", str(tmp_path / "w.txt"), "--target", "c", "-o", str(tmp_path / "w.c")]) == 0
    said = capsys.readouterr().out
    assert "code replayed on" in said
    assert "worst case: at most 1 condition a step\n" in said
    assert {path.name for path in tmp_path.iterdir()} == {"w.txt", "w.c", "w.h", "w.hpp"}


def test_without_a_compiler_it_is_said_that_nothing_was_replayed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("ltlc.assurance.c_programs.compiler", lambda: None)
    (tmp_path / "w.txt").write_text("never robot.velocity > 1\n")
    assert cli.main(["build", str(tmp_path / "w.txt"), "--target", "c", "-o", str(tmp_path / "w.c")]) == 0
    assert "code NOT replayed: no C compiler installed, read back" in capsys.readouterr().out


@pytest.mark.parametrize("condition", ["abs(id) > 3", "-id == 5", "min(id, id) == 5", "max(ids) == 5"])
def test_what_has_no_form_in_c_is_refused(condition: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    declared = "decl id /id std_msgs/Int64.data\ndecl ids /ids std_msgs/Int64MultiArray.data\n"
    (tmp_path / "w.txt").write_text(f"{declared}never {condition}\nnever id > 0 and max(ids) + 0.0 > 0.5 * id\n")
    assert cli.main(["build", str(tmp_path / "w.txt"), "--target", "c", "-o", str(tmp_path / "w.c")]) == 1
    assert "error[LTL708]" in capsys.readouterr().err
    assert not (tmp_path / "w.c").exists()


@pytest.mark.parametrize("name", ["gcc", "clang"])
def test_emitted_c_compiles_without_a_warning(name: str, tmp_path: Path) -> None:
    if shutil.which(name) is None:
        pytest.skip(f"there is no {name} here")
    text = "\n".join(line.removeprefix("_rate_ = 29.97\n").removeprefix("_timeout_ = 1\n") for line in _together())
    compiled, specification = from_text(text)
    files = emit(compiled, specification)
    (tmp_path / "props.h").write_text(files.header)
    (tmp_path / "props.c").write_text(files.source)
    for level in ("-O2", "-Os"):
        command = [name, *C_FLAGS, level, "-c", "props.c"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")


def _together() -> list[str]:
    """All that is written in `WRITTEN`, each declaration once."""
    lines = dict.fromkeys(line for text in WRITTEN.values() for line in text.split("\n"))
    kept = [line for line in lines if line and not line.startswith(("_", "decl x", "object"))]
    return [
        "decl x /x Float64.data",
        *(line for line in kept if line.startswith("decl")),
        *(f"p{n}: {line}" for n, line in enumerate(kept) if not line.startswith("decl")),
    ]


def test_comparisons_that_the_type_of_a_field_decides_give_no_warning() -> None:
    declared = "decl part /part UInt8.data\ndecl small /small Int8.data\n"
    compared = ("part < 0", "part <= 255", "255 < part", "0 <= part", "small <= 127", "small < -128")
    stated = (f"never @{{{text}, -1}} and part == 3\n" for text in compared)
    compiled, specification = from_text(f"{declared}{''.join(stated)}never any(@{{part, -2:}} < 0) and small > 1\n")
    files = emit(compiled, specification)
    path = compiler()
    assert path is not None
    monitors = Library(files, path).monitors()  # raises CompilerError where the compiler warns
    signals = {signal.name: signal for signal in files.samples.group_of}
    for time in range(2):
        monitors.step(time, {signals["part"]: 3.0, signals["small"]: 3.0}, ["/part", "/small"])
    shown = [VERDICTS[monitors.show(number)[0]].value for number in range(len(compiled))]
    holds = (False, True, False, True, True, False, False)
    assert [verdict == "violated" for verdict in shown] == list(holds)


def test_the_example_compiles_and_says_what_it_sees(tmp_path: Path) -> None:
    if shutil.which("g++") is None:
        pytest.skip("there is no g++ here")
    shutil.copytree(Path(__file__).parent.parent / "examples" / "c", tmp_path, dirs_exist_ok=True)
    compiled, specification = from_text((tmp_path / "watch.txt").read_text(), "watch.txt")
    files = emit(compiled, specification, "watch")
    for suffix, text in (("c", files.source), ("h", files.header), ("hpp", files.wrapper)):
        (tmp_path / f"watch.{suffix}").write_text(text)
    strict = ["-Wall", "-Wextra", "-pedantic", "-Wconversion", "-Werror"]
    for command in (
        ["cc", *C_FLAGS, "-c", "watch.c"],
        ["g++", "-std=c++17", *strict, "main.cpp", "watch.o", "-lm", "-o", "watch"],
    ):
        subprocess.run(command, cwd=tmp_path, check=True)
    said = subprocess.run(["./watch"], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert said.splitlines() == [
        "slow: presumably satisfied since 0 ms, 121 steps",
        "stops: violated since 850 ms, 121 steps",
        "alive: violated since 950 ms, 17 steps",
        "docked: presumably satisfied since 0 ms, 121 steps",
    ]


def test_time_that_goes_back_is_not_taken() -> None:
    compiled, specification = from_text("never robot.velocity > 1")
    monitors = library(emit(compiled, specification)).monitors()
    assert monitors.step(5, {}, ())
    assert not monitors.step(4, {}, ())


@pytest.mark.parametrize("settings_", ["", "_rate_ = 10\n", "_timeout_ = 1\n"])
@pytest.mark.parametrize("time", [2**62, 2**62 + 1, 2**63 - 1, -(2**62), -(2**63)])
def test_a_time_that_no_run_has_is_not_taken(time: int, settings_: str) -> None:
    text = f"{settings_}decl x /x Float64.data\np: eventually x > 3 within 2 s\nq: always (x < 9 or age(x) < 1 s)"
    compiled, specification = from_text(text)
    monitors = library(emit(compiled, specification)).monitors()
    assert not monitors.begin(time)
    assert not monitors.step(time, {}, ())
    assert monitors.begin(0)
    assert not monitors.step(time, {}, ())
    assert not monitors.advance(time)
    assert monitors.advance(10**9)


@pytest.mark.parametrize("name", ["gcc", "clang"])
@pytest.mark.parametrize(
    "flag",
    ["-ffast-math", "-Ofast", "-ffinite-math-only", "-funsafe-math-optimizations", "-freciprocal-math", "-mfpmath=387"],
)
def test_a_compiler_that_would_change_verdicts_is_refused(name: str, flag: str, tmp_path: Path) -> None:
    if shutil.which(name) is None:
        pytest.skip(f"there is no {name} here")
    files = emit(*from_text("never robot.velocity > 1"))
    (tmp_path / "props.h").write_text(files.header)
    (tmp_path / "props.c").write_text(files.source)
    command = [name, "-std=c99", "-O2", *flag.split(), "-c", "props.c"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    if "unsupported" in done.stderr or "unknown argument" in done.stderr:
        pytest.skip(f"{name} has no {flag}")
    assert done.returncode != 0
    assert "#error" in done.stderr or "error:" in done.stderr


@pytest.mark.parametrize("settings_", ["", "_rate_ = 5\n"])
def test_names_that_c_keeps_are_given_numbers(settings_: str) -> None:
    names = ["int", "signals", "samples", "verdict", "property", "norm", "NULL", "bool", "self", "step", "has_x", "x"]
    names += ["signals_2", "ticks", "tick", "judge", "judge_2", "started", "has_started", "together"]
    declared = "\n".join(f"decl {name} /{name} Float64.data" for name in names if name not in ("x",))
    text = "\n".join(f"{name}: never {name} > 1" for name in names if name != "x")
    library(emit(*from_text(f"{settings_}decl x /x Bool.data\n{declared}\n{text}\nx: never x"), "default"))


def test_two_properties_whose_decisions_become_functions_are_in_one_file_and_tell_when_verdicts_came(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("ltlc.backends.steps.MOST_BRANCHES", 2)
    declared = "".join(f"decl b{n} /b{n} Bool.data\n" for n in range(4))
    both = (
        " and ".join(f"(eventually b{n})" for n in range(4)),
        " and ".join(f"(eventually not b{n})" for n in range(4)),
    )
    files = emit(*from_text(declared + "\n".join(both)))
    assert files.source.count("_decide_") > 4
    monitors = library(files).monitors()
    signals = {signal.name: signal for signal in files.signals_of(0)}
    for time in range(1, 4):  # nothing is decided before the fourth holds
        monitors.step(time, {signals[f"b{n}"]: n < time for n in range(4)}, ())
    _, _, _, since = monitors.show(0)
    assert since == 1


def test_history_that_no_condition_asks_for_leaves_no_function_behind() -> None:
    text = 'decl m /m String.data\nnever m == "past("\ndecl x /x Bool.data\neventually (@{x, -2} or not @{x, -2})'
    library(emit(*from_text(text)))


def test_texts_that_would_end_a_comment_or_a_string_do_not() -> None:
    strange = r'"\"*/ ??/ \\ /* é"'
    compiled, specification = from_text(f"decl mode /mode String.data\nnever mode == {strange} # */")
    monitors = library(emit(compiled, specification)).monitors()
    [mode] = [i.signal for i in compiled[0].specification.inputs()]
    monitors.step(0, {mode: '"*/ ??/ \\ /* e'}, ())
    assert VERDICTS[monitors.show(0)[0]].value == "presumably_satisfied"
    monitors.step(1, {mode: '"*/ ??/ \\ /* é'}, ())
    assert VERDICTS[monitors.show(0)[0]].value == "violated"


@pytest.mark.parametrize("word", ["a" * 150, "-".join(["signal"] * 30)])
def test_no_word_of_a_comment_is_broken(word: str) -> None:
    assert any(word in line for line in comment(f"The text is {word}."))


def test_properties_that_differ_in_names_only_are_one_shape_in_c_and_others_are_not() -> None:
    each = "after_until r.distance.sign < 1, r.distance.sign > 3, eventually r.velocity < 0.01 within 1 s"
    compiled, specification = from_text(
        f"forall r in {{a, bb, c_3}}: {each}\n{each.replace('r.', 'd.').replace('1 s', '2 s')}"
    )
    found = c_programs(emit(compiled, specification), compiled, specification, MESSAGES)
    assert found is not None
    shapes = [Shape() for _ in compiled]
    for shape, program in zip(shapes, found, strict=True):
        program.describe(shape)
    assert len({shape.key for shape in shapes[:3]}) == 1
    assert shapes[3].key != shapes[0].key


@pytest.mark.parametrize("full", ["for the compiler", "for its input"])
def test_where_temporary_files_cannot_be_written_no_fault_is_reported_but_the_folder_and_what_helps(
    full: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cli, "_give_up_stdout", lambda: None)
    (tmp_path / "props.txt").write_text("decl speed /cmd Twist.linear.x\nnever speed > 1\n")
    if full == "for the compiler":
        fake = tmp_path / "bin" / "cc"
        fake.parent.mkdir()
        fake.write_text(
            "#!/bin/sh\necho 'cc1: fatal error: error writing to x.s: No space left on device' >&2\nexit 1\n"
        )
        fake.chmod(0o755)
        monkeypatch.setenv("PATH", str(fake.parent), prepend=":")
    else:
        monkeypatch.setattr(c_library, "_load", _full)
    code = cli.main(["build", str(tmp_path / "props.txt"), "--target", "c", "-o", str(tmp_path / "props.c")])
    err = capsys.readouterr().err
    assert code == 2
    assert re.search(r"ltlc: /.*: No space left on device; free some space, or set TMPDIR", err)
    assert "fault" not in err
    assert not (tmp_path / "props.c").exists()


def _full(*_: object) -> None:
    raise OSError(ENOSPC, os.strerror(ENOSPC))  # as of what is written to an open file


def test_a_timeout_that_begins_with_the_step_of_another_property_is_no_fault_of_the_code() -> None:
    text = (
        "_timeout_ = 3\ndecl a /a Float64.data\ndecl b /b Float64.data\n"
        "never a > 5\nalways (b > 1 implies eventually a < 1 within 1 s)\nnever b > 7"
    )
    assert all(isinstance(outcome, Replayed) for outcome in outcomes(text))
