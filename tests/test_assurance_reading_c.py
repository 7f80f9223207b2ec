"""Reading C back: emitted text is accepted as it is, and refused once it does anything else."""

from __future__ import annotations

import random
import re
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any

import pytest
from c_mutants import read_back, runs_in_time, runs_of, text_mutants, verdicts_of, with_source
from emitted_mutants import c_mutants
from hypothesis import given, settings
from hypothesis import strategies as st
from stepping import from_text, machines, samples, specification
from test_assurance_reading import TEXTS
from test_assurance_time import KINDS, Kind
from test_backends_c import PATH, WRITTEN
from timed import Draw
from timed import compiled as compiled_in_time
from timed import specification as timed_specification

from ltlc import cli
from ltlc.assurance.gate import judge_all
from ltlc.assurance.messages import Messages
from ltlc.assurance.reading.c.files import written
from ltlc.assurance.reading.c.lexing import tokens
from ltlc.assurance.reading.outcomes import Difference, ReadBack
from ltlc.automata import Budget
from ltlc.backends import c
from ltlc.backends.c import emit
from ltlc.compiler import Compiled
from ltlc.inputs.messages.definitions import MessageTypes, shipped
from ltlc.specification.expressions import Signal
from ltlc.specification.specification import Specification

needs_compiler = pytest.mark.skipif(PATH is None, reason="there is no C compiler here")

ALL = TEXTS | WRITTEN
INTEGERS = "".join(
    f"decl {kind[0].lower()}{bits} /{kind}{bits} {kind}{bits}.data\n"
    for kind in ("Int", "UInt")
    for bits in (8, 16, 32, 64)
)


def differences(files: c.Files, compiled: list[Compiled], whole: Specification | None = None) -> list[str]:
    return [str(each) for each in read_back(files, compiled, whole) if isinstance(each, Difference)]


@pytest.mark.parametrize("text", ALL.values(), ids=ALL)
def test_emitted_c_is_read_back_as_its_monitors(text: str) -> None:
    compiled, whole = from_text(text)
    assert differences(emit(compiled, whole), compiled, whole) == []


def test_decisions_that_become_functions_are_read_back(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ltlc.backends.steps.MOST_BRANCHES", 2)
    compiled, whole = from_text(TEXTS["many states"] + "\n" + TEXTS["many states"].splitlines()[-1])
    files = emit(compiled, whole)
    assert "_decide_" in files.source
    assert differences(files, compiled, whole) == []
    wrong = files.source.replace("!= PROPS_PRESUMABLY_VIOLATED) {", "!= PROPS_SATISFIED) {")
    assert len(differences(with_source(files, wrong), compiled, whole)) == 2


def test_integers_of_all_types_are_compared_as_what_they_are() -> None:
    compiled, whole = from_text(
        INTEGERS + "decl f32 /f std_msgs/Float32.data\na: never i8 > 2.5 or u8 < 300 and i16 == 2.5\n"
        "b: never u64 > i64 or i64 >= 3.5 or u32 > i32\n"
        "c: never i8 + 0.5 > u16 and u64 > 3.5\nd: after_until u8 > 3, i8 < 2, never @{u8, opening} > i32\n"
        "e: never i64 > i8 + 0.5 or min(i8, 3) > 2\nf: never abs(f32) > u64 or -f32 < i64"
    )
    assert differences(emit(compiled, whole), compiled, whole) == []


@pytest.mark.parametrize("condition", ["-i + 0.5 > 3", "abs(i) * 2 > v", "min(i, j) + 0.5 > v", "max(a) + 0.5 > v"])
def test_doubles_made_of_wide_integers_are_read_back(condition: str) -> None:
    declared = "decl i /i Int64.data\ndecl j /j Int64.data\ndecl v /v Float64.data\ndecl a /a Int64MultiArray.data\n"
    compiled, whole = from_text(f"{declared}never {condition}")
    files = emit(compiled, whole)
    assert differences(files, compiled, whole) == []
    wrong = with_source(files, files.source.replace("least(", "greatest(").replace("(double)i ", "(double)j "))
    assert wrong == files or differences(wrong, compiled, whole) != []


@settings(max_examples=10)
@given(machines())
def test_any_machine_over_any_conditions_is_read_back(compiled: Compiled) -> None:
    assert differences(emit([compiled], specification([compiled])), [compiled]) == []


@pytest.mark.parametrize("number", range(8))
def test_any_property_with_clocks_is_read_back(number: int) -> None:
    compiled = compiled_in_time(Draw(number).property(2, 2))
    assert differences(emit([compiled], timed_specification([compiled])), [compiled]) == []


@needs_compiler
@pytest.mark.parametrize("kind", list(KINDS.values())[:3], ids=list(KINDS)[:3])
def test_no_change_of_c_with_clocks_that_alters_a_verdict_is_accepted(kind: Kind) -> None:
    compiled = compiled_in_time(kind(3))
    files, chance = emit([compiled], timed_specification([compiled])), random.Random(0)
    runs = runs_in_time(30, chance)
    right = verdicts_of(files, runs)
    for mutant in islice(text_mutants(files, chance), 8):
        if isinstance(read_back(mutant, [compiled])[0], ReadBack):
            assert verdicts_of(mutant, runs) in (right, None), mutant.source


@needs_compiler
@settings(max_examples=2)
@given(machines(), st.lists(samples(), min_size=4, max_size=4))
def test_no_change_of_c_that_alters_a_verdict_is_accepted(compiled: Compiled, drawn: list[dict[Signal, Any]]) -> None:
    files, chance = emit([compiled], specification([compiled])), random.Random(0)
    if "_is_due(" not in files.source:
        return
    runs = runs_of(drawn, 10, chance)
    right = verdicts_of(files, runs)
    for mutant in islice(text_mutants(files, chance), 6):
        if isinstance(read_back(mutant, [compiled])[0], ReadBack):
            assert verdicts_of(mutant, runs) in (right, None), mutant.source


STOP, RESPONSE, AGE, AGED = (TEXTS[name] for name in ("stop sign", "response", "age", "age beside values"))
CHANGED = {
    "a threshold": (STOP, "d > 3.0f", "d > 3.5f", "in state 1, `d > 3.5` is not a condition"),
    "a single that is none": (STOP, "d > 3.0f", "d > 0.1f", "`0.1f` does not occur in step functions"),
    "a successor": (
        STOP,
        "self->state = 3",
        "self->state = 0",
        "`verdict` is VIOLATED instead of PRESUMABLY_SATISFIED in state 0",
    ),
    "a state that is too large": (STOP, "self->state = 3", "self->state = 259", "it does not have"),
    "a verdict": (
        STOP,
        "self->verdict = PROPS_VIOLATED",
        "self->verdict = PROPS_SATISFIED",
        "in state 3, the verdict is SATISFIED instead of VIOLATED",
    ),
    "a relation": (STOP, "d < 1.0f", "d <= 1.0f", "`d <= 1.0` is not a condition"),
    "a conversion": (TEXTS["margins"], "(double)d <", "(double)(float)v <", "does not occur in step functions"),
    "a check for NaN": (
        STOP,
        "signals->v != signals->v",
        "signals->d != signals->d",
        "`d` in `line_3_is_due` is not `v`",
    ),
    "NaN where all comes together": (
        STOP,
        "&& signals->v == signals->v",
        "",
        "in `judge` is not `signals->has_started && all`",
    ),
    "when a step is due": (
        STOP,
        "!(samples->has_d || samples->has_v)",
        "!(samples->has_d)",
        "in `line_3_is_due` is not",
    ),
    "when there is a value": (
        STOP,
        "!(signals->has_d && signals->has_v)",
        "!(signals->has_d)",
        "in `line_3_is_due` is not",
    ),
    "what a step is given": (TEXTS["past"], "time, signals->b, signals->v", "time, signals->b, 2.0", "`2.0`"),
    "the first verdict": (
        STOP,
        "self->verdict = PROPS_PRESUMABLY_SATISFIED;\n        self->since",
        "self->verdict = PROPS_SATISFIED;\n        self->since",
        "`PROPS_SATISFIED` in `line_3_is_due` is not",
    ),
    "a duration": (RESPONSE, "INT64_C(5000000000)", "INT64_C(5000000001)", "a step does something else"),
    "a clock step": (
        RESPONSE,
        "self->state = 2;\n    self->verdict = PROPS_VIOLATED",
        "self->state = 2",
        "at a clock step",
    ),
    "a clock step not taken": (RESPONSE, "while (time > monitors->", "if (time > monitors->", "in `hold` is not"),
    "what is due at first": (
        RESPONSE,
        ".due = PROPS_NEVER",
        ".due = INT64_C(0)",
        "`INT64_C(0)` in `props_init` is not",
    ),
    "the session": (
        AGE,
        "time + INT64_C(2000000000);\n    return",
        "time + INT64_C(2);\n    return",
        "in `begin_session` is not",
    ),
    "an age": (AGE, "time + INT64_C(2000000000);\n    }", "time + INT64_C(2);\n    }", "in `line_2_hear` is not"),
    "a late age": (AGED, "self->due = time - 1", "self->due = time", "in `line_3_hear` is not"),
    "who hears": (AGED, "time, samples->has_v);", "time, true);", "`true` in `props_step` is not"),
    "when an age is late": (
        AGE,
        "if (time <= self->due_0) {",
        "if (time > self->due_0) {",
        "is not an outcome of a decision",
    ),
    "a value at an opening": (
        TEXTS["opening"],
        "self->state == 0 ? d",
        "self->state == 2 ? d",
        "when it takes values at openings",
    ),
    "a sample": (
        TEXTS["history"],
        "signals->v[past(signals->v_latest, 2u, 3u)]",
        "signals->v[0]",
        "`0` in `judge` is not",
    ),
    "which elements count": (
        TEXTS["elements"],
        "(double)each_scan <= v",
        "(double)each_scan < v",
        "is not a condition",
    ),
    "how many elements there are": (
        TEXTS["elements"],
        "i < elements_2.length",
        "i + 1 < elements_2.length",
        "`i + 1` in `any_1` is not `i`",
    ),
    "a function": (
        TEXTS["strings"],
        "return *left == *right;",
        "return true;",
        "the function `same_text` is not the shared one",
    ),
    "a macro": (
        STOP,
        "#include <float.h>",
        "#include <float.h>\n#define true false",
        "is not a preprocessor directive",
    ),
    "a function twice": (STOP, "static void judge(", "static void judge(void) {}\nstatic void judge(", "twice"),
}


@pytest.mark.parametrize(("text", "right", "wrong", "said"), CHANGED.values(), ids=CHANGED)
def test_a_changed_text_is_refused_and_the_change_is_named(text: str, right: str, wrong: str, said: str) -> None:
    compiled, whole = from_text(text)
    files = emit(compiled, whole, "props")
    assert right in files.source
    (found,) = read_back(with_source(files, files.source.replace(right, wrong)), compiled)
    assert isinstance(found, Difference)
    assert said in str(found)


RIGHT_TICKS = ("samples->has_x", "samples->has_x || samples->has_y", "signals", "signals_3")


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("have_begun && samples->has_x", "have_begun && (samples->has_x || samples->has_y)"),
        ("have_begun && (samples->has_x || samples->has_y)", "have_begun && samples->has_x"),
        ("    monitors->signals_3.ticks.have_begun = true;", "    monitors->signals_2.ticks.have_begun = true;"),
        ("!monitors->signals.ticks.have_begun", "!monitors->signals_2.ticks.have_begun"),
    ],
)
def test_ticks_that_begin_otherwise_than_those_of_their_properties_are_refused(right: str, wrong: str) -> None:
    declared = "_rate_ = 5\ndecl x /x Float64.data\ndecl y /y Float64.data\n"
    compiled, whole = from_text(f"{declared}a: never x > 2\nb: never x > y\nc: always age(y) < 1 s")
    files = emit(compiled, whole, "props")
    assert right in files.source
    found = read_back(with_source(files, files.source.replace(right, wrong)), compiled, whole)
    assert {str(each).split("` in `")[1] for each in found} & {
        f"{function}` is not `{right}`" for function in ("props_step", "begin_session") for right in RIGHT_TICKS
    }


def test_verdicts_in_another_order_are_refused() -> None:
    compiled, whole = from_text(STOP)
    files = emit(compiled, whole, "props")
    changed = files.header.replace("PROPS_NOT_STARTED,", "PROPS_X,").replace("PROPS_SATISFIED,", "PROPS_NOT_STARTED,")
    (found,) = written(changed, files.source, compiled)
    assert "`props_verdict` is not" in str(found)


def test_a_field_of_another_type_is_refused() -> None:
    compiled, whole = from_text(STOP)
    files = emit(compiled, whole, "props")
    assert "    float d;" in files.header
    (found,) = written(files.header.replace("float d;", "double d;"), files.source, compiled)
    assert isinstance(found, Difference) or "of another type" in str(found.read_back())


def test_without_a_compiler_c_is_read_back_each_property_by_itself() -> None:
    compiled, whole = from_text("decl v /v Float64.data\ndecl w /w Float64.data\na: never v > 1\nb: never w > 1")
    files = emit(compiled, whole, "props")
    wrong = with_source(files, files.source.replace("state == 0 && w > 1.0", "state == 0 && w > 2.0"))
    parts = written(wrong.header, wrong.source, compiled)
    found = judge_all(compiled, None, Messages(MessageTypes(shipped())), Budget(), written=lambda: parts)
    assert [getattr(each, "passed", None) for each in found] == [True, False]


def test_a_build_says_that_c_is_read_back(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "w.txt").write_text("never robot.velocity > 1\n")
    assert cli.main(["build", str(tmp_path / "w.txt"), "--target", "c", "-o", str(tmp_path / "w.c")]) == 0
    assert ", read back\n" in capsys.readouterr().out


def test_a_build_refuses_c_that_is_not_its_monitor(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def wrongly(*given: Any) -> c.Files:
        files = emit(*given)
        return with_source(files, files.source.replace("> 1.0", ">= 1.0"))

    monkeypatch.setattr("ltlc.backends.c.emit", wrongly)
    monkeypatch.setattr("ltlc.assurance.c_programs.compiler", lambda: None)
    (tmp_path / "w.txt").write_text("never robot.velocity > 1\n")
    assert cli.main(["build", str(tmp_path / "w.txt"), "--target", "c", "-o", str(tmp_path / "w.c")]) == 1
    assert "error[LTL707]" in capsys.readouterr().err
    assert not (tmp_path / "w.c").exists()


def test_a_property_called_like_the_file_is_emitted() -> None:
    compiled, whole = from_text("decl v /v Float64.data\nwatch: never v > 1")
    assert differences(emit(compiled, whole, "watch"), compiled) == []


def test_c_that_somebody_has_changed_is_found_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    properties, code, certificate = (tmp_path / name for name in ("w.txt", "w.c", "w.cert"))
    properties.write_text("never robot.velocity > 1\n")
    build = ["build", str(properties), "--target", "c", "-o", str(code), "--certificate", str(certificate)]
    assert cli.main(build) == 0
    certify = ["certify", str(properties), str(certificate), "--code", str(code)]
    assert cli.main(certify) == 0
    assert "match the certified monitor" in capsys.readouterr().out
    code.write_text(code.read_text().replace("> 1.0", "> 2.0"))
    assert cli.main(certify) == 1
    assert "`2.0` where ltlc emits `1.0`" in capsys.readouterr().out


def test_what_is_no_c_of_ours_is_refused_and_never_a_traceback() -> None:
    compiled, whole = from_text(STOP)
    files, chance = emit(compiled, whole, "props"), random.Random(0)
    for source in ("", "int x;", "int f(void) { return 1; }", "#define f", "typedef struct { int a; } props_monitors;"):
        assert isinstance(read_back(with_source(files, source), compiled)[0], Difference)
    words = files.source.split(" ")
    for _ in range(30):
        place = chance.randrange(len(words))
        read_back(with_source(files, " ".join(words[:place] + words[place + 1 :])), compiled)


HARMLESS = frozenset({"const", "(", ")", "void", "samples", "time", "self", ";"})
"""What may be left out: that a variable stays as it is, parentheses, and that a parameter is not used."""


@pytest.mark.parametrize("name", ["age beside values", "counts", "history", "rate", "ticks", "float"])
def test_every_change_of_a_token_of_c_is_refused_or_harmless(name: str) -> None:
    compiled, whole = from_text((WRITTEN | TEXTS)[name])
    files, chance = emit(compiled, whole, "props"), random.Random(0)
    for source, header in ((files.source, False), (files.header, True)):
        told = sorted(token.text for token in tokens(source) if token.text not in HARMLESS)
        for mutant in chance.sample(list(c_mutants(source)), 12):
            changed = replace(files, header=mutant) if header else with_source(files, mutant)
            if differences(changed, compiled, whole) == []:
                assert sorted(token.text for token in tokens(mutant) if token.text not in HARMLESS) == told, mutant


def test_reading_back_shares_the_known_functions_and_their_spellings_with_what_writes_and_nothing_else() -> None:
    folder = Path(__file__).parents[1] / "ltlc/assurance/reading"
    texts = "".join(path.read_text() for path in folder.rglob("*.py"))
    imported = set(re.findall(r"^(?:from|import) (ltlc\.(?:backends|automata|compiler)\S*)", texts, re.M))
    assert imported == {"ltlc.backends.c.library", "ltlc.backends.rust.functions"}
