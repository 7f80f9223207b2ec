"""Emitted Rust, compiled, against the machines it is made of, the reference for values, and runs with faults."""

from __future__ import annotations

import math
import random
import re
import shutil
import subprocess
import textwrap
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from conditions_support import CONDITIONS, DECLARED
from edges import drawn
from effort import share_of
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from lowered import texts
from replaying import MESSAGES, is_right, judged
from stepping import expected, from_text, machines, samples, specification

from ltlc.assurance.c_programs import rust_programs
from ltlc.assurance.compiled_program import VERDICTS
from ltlc.assurance.replay import Deviation, Replayed
from ltlc.assurance.rust_library import RustLibrary, compiler
from ltlc.backends.rust import MISSING, emit, file_of, in_c
from ltlc.backends.spelling import NotInTargetError
from ltlc.cli import main
from ltlc.compiler import Compiled
from ltlc.program.functions import ROWS, Exactness, Primitive
from ltlc.program.types import DOUBLE, SINGLE, type_of
from ltlc.specification.expressions import Signal
from ltlc.specification.specification import Specification, fields

needs_rustc = pytest.mark.skipif(compiler() is None, reason="there is no rustc here")


def fit(compiled: list[Compiled], of: Specification) -> list[Compiled]:
    """Those that have a form in Rust."""
    found = []
    for each in compiled:
        try:
            in_c([each], of)
        except NotInTargetError:
            continue
        found.append(each)
    return found


def library(compiled: list[Compiled], of: Specification) -> RustLibrary:
    path = compiler()
    assert path is not None
    return RustLibrary(file_of(compiled, of), path)


@needs_rustc
@settings(max_examples=2, deadline=None, phases=[Phase.generate], suppress_health_check=list(HealthCheck))
@given(st.data())
def test_any_machines_over_any_conditions_are_stepped_as_defined(data: st.DataObject) -> None:
    drawn_ = [data.draw(machines(most_states=6)) for _ in range(12)]
    compiled = fit([one for one in drawn_ if one.specification.inputs()], specification(drawn_))
    run = [data.draw(samples()) for _ in range(12)]
    monitors = library(compiled, specification(compiled)).monitors()
    for end, sample in enumerate(run, 1):
        assert monitors.step(end, sample, ())
        for number, one in enumerate(compiled):
            verdicts, invalid = expected(one, run[:end])
            shown, _, none, _ = monitors.show(number)
            assert (VERDICTS[shown].value, none) == (verdicts[-1], invalid)


@needs_rustc
def test_what_reads_nothing_is_judged_in_time() -> None:
    compiled, whole = from_text("always 1 < 2\neventually 2 < 1 within 1 s\n")
    for of, program in zip(
        compiled, rust_programs(file_of(compiled, whole), compiled, whole, MESSAGES) or (), strict=True
    ):
        assert is_right(of, program)


@needs_rustc
def test_every_spelling_is_what_the_reference_says() -> None:
    compiled, whole = from_text(DECLARED + "".join(f"never {text}\n" for text in CONDITIONS))
    some = fit(compiled, whole)
    assert len(some) > 90
    functions, chance = library(some, whole), random.Random(1)
    given_ = dict.fromkeys(s for each in some for i in each.specification.inputs() for s, _ in fields(i.signal))
    for _ in range(share_of(80)):
        sample = {signal: hostile(signal, chance) for signal in given_}
        monitors = functions.monitors()
        assert monitors.step(1, sample, ())
        for number, one in enumerate(some):
            verdicts, invalid = expected(one, [sample])
            shown, _, none, _ = monitors.show(number)
            assert (VERDICTS[shown].value, none) == (verdicts[-1], invalid), (one.specification.text, sample)


def hostile(signal: Signal, chance: random.Random) -> Any:
    type_ = type_of(signal)
    return math.nan if type_ in (SINGLE, DOUBLE) and chance.random() < 1 / 20 else drawn(type_, chance)


def test_what_has_no_spelling_is_refused_by_name() -> None:
    needs_more = {each for each in Primitive if ROWS[each].exactness is Exactness.LIBRARY}
    assert (
        needs_more
        | {
            Primitive.SQRT,
            Primitive.NORM,
            Primitive.SUM,
            Primitive.MEAN,
            Primitive.DISTANCE,
        }
        == MISSING
    )


@needs_rustc
def test_the_replay_finds_nothing_in_what_is_emitted_for_each_feature() -> None:
    compiled, whole = from_text(next(texts()))
    some = fit(compiled, whole)[::2]
    found = rust_programs(file_of(some, whole), some, whole, MESSAGES)
    assert found is not None
    assert len(some) > 12
    for each, program in zip(some, found, strict=True):
        assert is_right(each, program), each.specification.text


SIGNALS = """\
decl v /v std_msgs/Float64.data
decl scan /scan LaserScan.ranges
decl mode /mode String.data
"""
TIMED = "always (v > 2 implies within 2 s, eventually median(scan[2:]) < @{v, -1})"
OPENED = 'after_until mode == "a", mode == "b", always v < @{v, opening} or any(scan < v)'
KEPT = 'after_until mode == "a", mode == "b", always v <= @{v, opening}'
RECENT = "never all(@{v, -2:} > 1)"
AGED = "always age(scan) <= 1 s"
PAST = "always (new mode implies historically v > 2 for 1 s)"
RATED = [
    f"_rate_ = 30\n{SIGNALS}{TIMED}\n{AGED}\n{PAST}\nalways 1 < 2\n{RECENT}",
    f"_rate_ = 3\n_timeout_ = 5 s\n{SIGNALS}{OPENED}\n{PAST}",
]
"""Ticks that begin with several sets of topics and with the session, every third of which is a nanosecond later."""
FAULTS = [
    (TIMED, "time + 2000000000", "time + 2000000001"),
    (TIMED, "past(self.signals.v_latest, 1, 2)", "past(self.signals.v_latest, 0, 2)"),
    (TIMED, "if self.signals.v[self.signals.v_latest as usize].is_nan()\n", "if false\n"),
    (TIMED, "slice_floats(self.signals.scan, 2, ", "slice_floats(self.signals.scan, 1, "),
    (
        RECENT,
        "recent_doubles(&self.signals.v, self.signals.v_latest, 3, 3)",
        "recent_doubles(&self.signals.v, self.signals.v_latest, 3, 2)",
    ),
    (OPENED, "(each_scan as f64) < v", "(each_scan as f64) > v"),
    (KEPT, "self.v_opening = v_opening;", ""),
    (AGED, "self.due_0 = time + 1000000000;", ""),
    (PAST, "} else if new_mode {", "} else if true {"),
]


@needs_rustc
@pytest.mark.parametrize(("property_", "right", "wrong"), FAULTS)
def test_the_replay_finds_a_fault_in_the_text(property_: str, right: str, wrong: str) -> None:
    compiled, whole = from_text(SIGNALS + property_)
    file = file_of(compiled, whole)
    assert right in file.text
    found = rust_programs(replace(file, text=file.text.replace(right, wrong)), compiled, whole, MESSAGES)
    assert found is not None
    assert isinstance(judged(compiled[0], found[0]), Deviation)


@needs_rustc
@pytest.mark.parametrize("text", RATED)
def test_the_replay_finds_nothing_in_what_looks_at_samples_with_ticks(text: str) -> None:
    compiled, whole = from_text(text)
    for of, program in zip(
        compiled, rust_programs(file_of(compiled, whole), compiled, whole, MESSAGES) or (), strict=True
    ):
        assert is_right(of, program), of.specification.text


@needs_rustc
@pytest.mark.parametrize(
    ("property_", "right", "wrong"),
    [
        (TIMED, "self.fraction += 1;", "self.fraction += 2;"),
        (TIMED, "self.latest.v = samples.v;", ""),
        (TIMED, "&{ self.latest }", "&Samples { v: None, scan: None }"),
        (AGED, "self.signals.ticks.next = time;", "self.signals.ticks.next = time + 1;"),
        (PAST, "self.signals.new_mode = self.signals.new_mode || ", "self.signals.new_mode = "),
        (PAST, "self.signals.new_mode = false;", ""),
        (RECENT, "while next < time {", "while false {"),
        (RECENT, "if self.next_tick() < next {", "if false {"),
    ],
)
def test_the_replay_finds_a_fault_in_ticks(property_: str, right: str, wrong: str) -> None:
    compiled, whole = from_text(f"_rate_ = 30\n{SIGNALS}{property_}")
    file = file_of(compiled, whole)
    assert right in file.text
    (program,) = rust_programs(replace(file, text=file.text.replace(right, wrong)), compiled, whole, MESSAGES) or ()
    assert isinstance(judged(compiled[0], program), Deviation)


@needs_rustc
def test_a_run_ends_with_its_timeout() -> None:
    compiled, whole = from_text(f"_timeout_ = 5 s\n{SIGNALS}{TIMED}")
    for text, outcome in (("+ 5000000000", Replayed), ("+ 4000000000", Deviation)):
        file = file_of(compiled, whole)
        assert "self.end = time + 5000000000" in file.text
        changed = replace(file, text=file.text.replace("self.end = time + 5000000000", f"self.end = time {text}"))
        (program,) = rust_programs(changed, compiled, whole, MESSAGES) or ()
        assert isinstance(judged(compiled[0], program), outcome)


@needs_rustc
def test_a_property_may_be_called_as_what_the_functions_of_the_file_call_their_types() -> None:
    compiled, whole = from_text(SIGNALS + "n: never @{v, -1} > nearest(v, scan)\nt: never max(scan) > 2")
    for each, program in zip(
        compiled, rust_programs(file_of(compiled, whole), compiled, whole, MESSAGES) or (), strict=True
    ):
        assert is_right(each, program)


@needs_rustc
def test_the_file_needs_no_standard_library_and_gives_no_warning(tmp_path: Path) -> None:
    (tmp_path / "watch.rs").write_text(emit(*from_text("\n".join([SIGNALS, TIMED, OPENED, AGED, PAST]))))
    (tmp_path / "lib.rs").write_text("#![no_std]\n#![deny(warnings)]\npub mod watch;\n")
    command = [str(compiler()), "--edition=2018", "--crate-type=lib", "--emit=metadata", "lib.rs"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize(
    ("property_", "lacks"),
    [
        ("never sqrt(v) > 2", "the square root, for which `core` has no function"),
        ("never mod(v, 3) > 2 and sin(v) > 0", "the sine, for which `core` has no function"),
        ("never abs(id) > 3", "a comparison with `-`, `abs`, `min` or `max` of 64-bit integers, which is exact"),
    ],
)
def test_what_rust_cannot_say_is_refused_by_name(property_: str, lacks: str, tmp_path: Path, capsys: Any) -> None:
    props = tmp_path / "props.txt"
    props.write_text(f"decl v /v std_msgs/Float64.data\ndecl id /id std_msgs/Int64.data\n{property_}\n")
    assert main(["build", str(props), "--target", "rust", "-o", str(tmp_path / "props.rs")]) == 1
    said = capsys.readouterr().err
    assert "error[LTL708]" in said
    assert f"cannot be written in Rust: it has {lacks}" in said
    assert not (tmp_path / "props.rs").exists()


def test_the_summary_says_that_nothing_was_replayed_without_a_compiler_and_what_was_read(
    tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: None)
    declared = "decl v /v std_msgs/Float64.data\ndecl id /id std_msgs/Int64.data\n"
    (tmp_path / "props.txt").write_text(f"{declared}never abs(id) + 1 > v\n")
    assert main(["build", str(tmp_path / "props.txt"), "--target", "rust", "-o", str(tmp_path / "p.rs")]) == 0
    assert "code NOT replayed: no rustc installed, read back" in capsys.readouterr().out


@needs_rustc
@pytest.mark.parametrize(
    "name",
    [
        "self",
        "match",
        "move",
        "Some",
        "value",
        "Signals",
        "double",
        "time",
        "is_first",
        "ltlc",
        "monitors",
        "LIMIT",
        "ids",
    ],
)
def test_names_of_a_specification_hide_nothing_of_the_file(name: str) -> None:
    library(*from_text(f"decl {name} /{name} Float64MultiArray.data\n{name}: never any({name} > 2)\n"))


@needs_rustc
@pytest.mark.parametrize("name", ["watch", "motors", "answers"])
def test_the_programs_of_the_documentation_run(name: str, tmp_path: Path) -> None:
    page = (Path(__file__).parents[1] / "docs/rust.md").read_text(encoding="utf-8")
    found = re.findall(r"\n\n((?:    [^\n]*\n)+)\na program is\n\n```rust\n(.*?)```", page, re.S)
    texts_ = {re.findall(r"mod (\w+);", program)[0]: (text, program) for text, program in found}
    assert texts_.keys() == {"watch", "motors", "answers"}
    text, program = texts_[name]
    (tmp_path / f"{name}.rs").write_text(emit(*from_text(textwrap.dedent(text))))
    (tmp_path / "main.rs").write_text(program)
    done = subprocess.run(
        [str(compiler()), "--edition=2021", "-Dwarnings", "main.rs"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stderr == ""
    assert subprocess.run([tmp_path / "main"], check=False).returncode == 0
