"""`@{s, -n else c}`, a sample or what stands for it before there is one: `docs/language.md`, 'Signals'."""

from __future__ import annotations

import math
from random import Random

import pytest
from language_support import codes_of, only_property
from replaying import MESSAGES, is_right, outcomes
from stepping import from_text, ns, session

from ltlc.analysis.atom_words import atom_text
from ltlc.assurance.c_programs import c_programs, rust_programs
from ltlc.assurance.reading.c.files import written as written_in_c
from ltlc.assurance.reading.outcomes import Difference, ReadBack
from ltlc.assurance.reading.rust import written as written_in_rust
from ltlc.assurance.replay import Replayed
from ltlc.assurance.rust_library import compiler as rust_compiler
from ltlc.backends import c, rust
from ltlc.backends.spelling import NotInTargetError

DECLARED = """\
decl x /x Float64.data
decl g /g Float64.data
decl m /m String.data
decl on /on Bool.data
decl n /n Int64.data
"""


@pytest.mark.parametrize("samples", [0, 1, 3])
def test_it_is_the_sample_so_long_ago_and_else_the_other_value(samples: int) -> None:
    chance = Random(samples)
    for _ in range(20):
        written = f"@{{x, -{samples} else 7}}"
        run = session(f"{DECLARED}never {written} == 99 and g == 99\n")
        (track,) = run.tracks
        place = [str(wanted) for wanted in track.property.inputs].index(written.replace("-0", "0"))
        sampled: list[float] = []
        run.message(0, "/g", [0.0])
        for time in range(1, 12):
            topic = chance.choice(["/x", "/g"])
            value = chance.choice([1.0, 2.0, math.nan if topic == "/x" else 0.0])
            sampled += [value] if topic == "/x" else []
            steps = track.steps
            run.message(ns(float(time)), topic, [value])
            right = sampled[-samples - 1] if len(sampled) > samples else 7.0
            assert (track.steps > steps) == (not math.isnan(right))
            assert math.isnan(right) or track.values[-1][place] == right


def test_a_property_does_not_wait_for_the_sample() -> None:
    run = session(f"{DECLARED}always g > @{{x, -1 else 3}}")
    run.message(0, "/g", [2.0])
    assert run.tracks[0].verdict.value == "violated"


def test_a_property_that_reads_nothing_else_begins_with_the_session() -> None:
    run = session(f"{DECLARED}never @{{x, -1 else 3}} == 3\nnever g > 1")
    run.message(0, "/g", [0.0])
    assert run.tracks[0].verdict.value == "violated"


def test_integers_stay_exact_and_strings_and_predicates_have_another_value_too() -> None:
    run = session(
        f"{DECLARED}never @{{n, -1 else 9007199254740993}} == 9007199254740992 and on\n"
        'never @{m, -1 else "none"} != "none" and on\n'
        "always @{x > 1 and on, -1 else true}"
    )
    for topic, value in [("/on", True), ("/n", 0), ("/m", "a"), ("/x", 0.0), ("/on", True)]:
        run.message(0, topic, [value])
    assert [track.verdict.value for track in run.tracks] == ["presumably_satisfied", "presumably_satisfied", "violated"]


@pytest.mark.parametrize("target", ["ros2", "python"])
@pytest.mark.parametrize("rate", ["", "_rate_ = 5\n"])
@pytest.mark.parametrize(
    "stated",
    [
        "always (abs(x - @{x, -1 else 0}) > 1 implies eventually g > 2 within 2 s)",
        'always (m == "a" implies @{m, -1 else "none"} in {"none", "b"})',
        "never @{x - g, -2 else 1} > 1 and @{x > g, -1 else false}",
        "always (new x implies x >= @{x, -1 else 3})",
    ],
)
def test_the_replay_finds_nothing_in_what_is_emitted(stated: str, rate: str, target: str) -> None:
    assert all(isinstance(outcome, Replayed) for outcome in outcomes(rate + DECLARED + stated, target))


def test_the_replay_finds_another_value_at_first() -> None:
    stated = f"{DECLARED}never @{{x, -1 else 5}} > 4 and g > 1"
    (outcome,) = outcomes(stated, "ros2", "Excused(0, (), 5.0)", "Excused(0, (), 3.0)")
    assert not isinstance(outcome, Replayed)


EMITTED = f"""{DECLARED}
decl i /i Int32.data
decl u /u UInt64.data
decl f /f Float32.data
never @{{i, -1 else 3}} > 5
never @{{i, 0 else -2147483648}} > i
never @{{u, -2 else 18446744073709551615}} == 4 and u > 3
never @{{f, 0 else 0.1}} > f
always (new i implies @{{on, -1 else true}})
always (new i implies @{{m, -1 else "a\\"é"}} != "on")
never @{{f > 2, -2 else false}} and f < 1
never f - @{{f, -1 else -0.5}} > 1
never @{{n, -1 else -3}} > 5
always (x > 1 implies eventually @{{x, -1 else 0}} < 1 within 2 s)
never sqrt(x) - @{{x, -1 else 2}} > 1
"""


@pytest.mark.parametrize("settings", ["", "_rate_ = 10\n"])
def test_c_begins_with_the_other_value(settings: str) -> None:
    compiled, specification = from_text(f"{settings}{EMITTED}")
    files = c.emit(compiled, specification)
    found = written_in_c(files.header, files.source, compiled, specification.rate)
    assert [None if isinstance(each, Difference) else type(each.read_back()) for each in found] == [ReadBack] * len(
        found
    )
    programs = c_programs(files, compiled, specification, MESSAGES)
    assert programs is not None
    assert all(is_right(*pair) for pair in zip(compiled, programs, strict=True))


@pytest.mark.skipif(rust_compiler() is None, reason="there is no rustc here")
@pytest.mark.parametrize("settings", ["", "_rate_ = 10\n"])
def test_rust_begins_with_the_other_value(settings: str) -> None:
    compiled, specification = from_text(settings + EMITTED.replace("never sqrt(x) - @{x, -1 else 2} > 1\n", ""))
    file = rust.file_of(compiled, specification)
    found = written_in_rust(file.text, file.c.header, file.c.source, compiled, specification.rate)
    assert [None if isinstance(each, Difference) else type(each.read_back()) for each in found] == [ReadBack] * len(
        found
    )
    programs = rust_programs(file, compiled, specification, MESSAGES)
    assert programs is not None
    assert all(is_right(*pair) for pair in zip(compiled, programs, strict=True))


CHANGES = {
    "a number": ("i_1_else_3 = 3;", "i_1_else_3 = 4;"),
    "a large one": ("UINT64_C(18446744073709551615)", "UINT64_C(18446744073709551614)"),
    "a sign": ("= -0.5f;", "= 0.5f;"),
    "a boolean": ("on_1_else_true = true;", "on_1_else_true = false;"),
    "a boolean as a number": ("on_1_else_true = true;", "on_1_else_true = 1;"),
    "a string": ('"a\\"', '"b\\"'),
    "none": ("    monitors->signals.n_1_else_3 = INT64_C(-3);\n", ""),
    "a value that waits": (
        "if (samples->has_f && signals->has_f) {\n        signals->value",
        "if (samples->has_f && signals->has_f && signals->f_count >= 2u) {\n        signals->value",
    ),
}


@pytest.mark.parametrize(("right", "wrong"), CHANGES.values(), ids=CHANGES)
def test_another_value_at_first_is_not_read_back(right: str, wrong: str) -> None:
    compiled, specification = from_text(EMITTED)
    files = c.emit(compiled, specification)
    assert right in files.source
    found = written_in_c(files.header, files.source.replace(right, wrong), compiled)
    assert any(isinstance(each, Difference) or isinstance(each.read_back(), Difference) for each in found)


@pytest.mark.parametrize("emit", [c.emit, rust.emit])
def test_what_may_have_no_value_and_reads_such_values_alone_is_refused_by_name(emit: object) -> None:
    compiled, specification = from_text(f"{DECLARED}never 1 / @{{x, -1 else 0}} > 1")
    with pytest.raises(NotInTargetError, match=r"@\{x, -1 else 0\}"):
        emit(compiled, specification)  # type: ignore[operator]


@pytest.mark.parametrize(
    ("expression", "code"),
    [
        ("@{x, -1 else g} > 1", "LTL211"),
        ("@{x, -1 else true} > 1", "LTL211"),
        ("@{on, -1 else 0}", "LTL211"),
        ("@{n, -1 else 0.5} > 1", "LTL211"),
        ("@{robot.position, -1 else 0} == robot.position", "LTL211"),
        ("@{x, 1 else 0} > 1", "LTL211"),
        ("@{@{x, -1 else 0}, -1} > 1", "LTL210"),
        ("@{@{x, -1 else 0} + g, -1} > 1", "LTL210"),
        ("@{@{x, -1 else 0}, opening} > 1", "LTL210"),
    ],
)
def test_another_value_is_a_constant_of_the_signal_and_has_no_past(expression: str, code: str) -> None:
    assert codes_of(f"{DECLARED}never {expression}") == [code]


def test_else_is_a_name_everywhere_else() -> None:
    found = only_property("decl else /x Float64.data\nnever @{else, -1 else 0} > else")
    assert {wanted.signal.name for wanted in found.inputs()} == {"else", "@{else, -1 else 0}"}


def test_it_is_explained_in_words() -> None:
    (atom,) = only_property(f"{DECLARED}never @{{x, -2 else 0}} > 1").atoms
    assert atom_text(atom, holds=True) == "x 2 samples ago (0 before there is one) is more than 1"
