"""A property does not wait for what it reads with its news: in every target, and whatever the gate looks at."""

from __future__ import annotations

from dataclasses import replace

import pytest
from c_mutants import read_back as read_back_c
from read_mutants import read_back
from replaying import MESSAGES, is_right, outcomes
from stepping import from_text, session

from ltlc.assurance.c_library import compiler
from ltlc.assurance.c_programs import c_programs, rust_programs
from ltlc.assurance.lowered.equality import Equal, compare
from ltlc.assurance.lowered.letters import Judged
from ltlc.assurance.reading import rust as reading_rust
from ltlc.assurance.reading.c.files import WrittenInC
from ltlc.assurance.reading.outcomes import Difference, ReadBack
from ltlc.assurance.replay import Replayed
from ltlc.assurance.rust_library import compiler as rust_compiler
from ltlc.backends import c, emit, rust
from ltlc.program.expressions import Held, News
from ltlc.program.machine import Excused
from ltlc.program.types import DOUBLE
from ltlc.runtime import documents, junit, reports
from ltlc.runtime.times import SECOND
from ltlc.semantics.verdicts import Verdict

DECLARED = """
decl st /st std_msgs/Int32.data
decl v /v std_msgs/Float64.data
decl w /w std_msgs/Float64.data
decl scan /scan LaserScan.ranges
decl near /scan LaserScan.range_min
decl mode /mode std_msgs/String.data
decl on /on std_msgs/Bool.data
model robot: position /odom Odometry.pose.pose.position ;
object sign at (10, 0, 0)
object cart /cart PoseStamped
"""

WAITED_FOR = {
    "after new st and st == 1, never new v and not v == 0": set(),
    "always (new v and v > 0 implies once new w)": set(),
    'eventually (new mode and mode == "go") within 3 s': set(),
    "once (new st and st == 3) and new v": set(),
    "always age(v) < 1 s and not (new on and on)": set(),
    "always (new scan and min(scan) < 0.3 implies on)": {"on"},
    "always (new scan and min(scan[80:100]) < 0.3 implies new v)": set(),
    "always (new scan and near < 0.3 implies new v)": set(),
    "always (new v and abs(v - w) < 0.3 implies new w)": {"w"},
    "always (new v and new w and v > w implies new st)": set(),
    "always (new v and v > 1 or w > v implies new w)": {"v", "w"},
    "always (new v and once v > 1 implies new st)": {"v"},
    "always (new v and v > @{v, -1} implies new st)": {"v"},
    "after new v and v > 1, never new v and v > @{v, opening}": {"v"},
    "always (new v and 1 / v < 0.3 implies new w)": set(),
    "always (new v and sqrt(v - 5) < 0.3 implies new w)": set(),
    "always (new v and sqrt(v - w) < 0.3 implies new w)": {"v", "w"},
    "always (v < 3 and v > 4 or new v and (v < 1 or v >= 1) implies once new w)": set(),
    "always (v < 4 and v > 3 or new v and v < 1 implies once new w)": {"v"},
    "always (new robot.position and robot.distance.sign < 1 implies new v)": set(),
    "always (new robot.position and robot.distance.cart < 1 implies new v)": {"robot.distance.cart"},
    "always (new robot.position and new cart and robot.distance.cart < 1 implies new v)": set(),
}


@pytest.mark.parametrize("text", WAITED_FOR)
def test_a_property_waits_for_what_makes_a_difference_without_news(text: str) -> None:
    (of,), _ = from_text(f"{DECLARED}{text}\n")
    assert {each.signal for each in of.machine.waits_for} == WAITED_FOR[text]
    assert isinstance(compare(of.machine, Judged(of.specification, of.formula, of.monitor)), Equal)


def test_each_copy_of_forall_is_decided_for_itself() -> None:
    compiled, _ = from_text(
        f"{DECLARED}p: forall a, b in {{v, w}}: always (new v and a > b implies once new v and a > 0)\n"
    )
    assert [{each.signal for each in of.machine.waits_for} for of in compiled] == [{"w"}, {"w"}]


TOLD = f"""{DECLARED}
a: after new st and st == 1, never new v and not v == 0
b: always (new mode and mode == "go" implies once (new scan and min(scan) > 0.3 and on))
c: eventually (new v and 1 / v > 1) within 3 s
d: always (new on and on implies v < 3)
e: always 1 < 2
f: eventually 2 < 1 within 1 s
g: never once true 1 times
"""
BESIDE_NO_VALUE = """h: never (new v and v > w / w)
i: never (new scan and any(scan > w / w))
"""


@pytest.mark.parametrize("target", ["python", "ros2"])
def test_emitted_python_does_what_is_defined_while_signals_are_silent(target: str) -> None:
    assert all(isinstance(outcome, Replayed) for outcome in outcomes(TOLD + BESIDE_NO_VALUE, target))
    compiled, whole = from_text(TOLD + BESIDE_NO_VALUE)
    assert all(isinstance(found, ReadBack) for found in read_back(emit(target, compiled, whole), compiled))


@pytest.mark.skipif(compiler() is None, reason="there is no C compiler here")
@pytest.mark.parametrize("rate", ["", "_rate_ = 10\n"])
def test_emitted_c_does_what_is_defined_while_signals_are_silent(rate: str) -> None:
    compiled, whole = from_text(rate + TOLD + BESIDE_NO_VALUE)
    files = c.emit(compiled, whole)
    found = c_programs(files, compiled, whole, MESSAGES)
    assert found is not None
    assert all(is_right(of, program) for of, program in zip(compiled, found, strict=True))
    assert all(isinstance(each, ReadBack) for each in read_back_c(files, compiled, whole))


@pytest.mark.parametrize("rate", ["", "_rate_ = 10\n"])
def test_emitted_rust_does_what_is_defined_while_signals_are_silent(rate: str) -> None:
    compiled, whole = from_text(rate + TOLD + BESIDE_NO_VALUE)
    file = rust.file_of(compiled, whole)
    read = reading_rust.written(file.text, file.c.header, file.c.source, compiled, whole.rate)
    assert [isinstance(each, WrittenInC) and type(each.read_back()) for each in read] == [ReadBack] * 9
    if rust_compiler() is None:
        pytest.skip("there is no compiler for Rust here")
    found = rust_programs(file, compiled, whole, MESSAGES)
    assert found is not None
    assert all(is_right(of, program) for of, program in zip(compiled, found, strict=True))


@pytest.mark.parametrize(
    ("target", "right", "wrong"),
    [
        ("ros2", "excused=(Excused(1, (0,), 0.0, (0,)), Excused(3, (2,), 0.0, (1,))),", ""),
        ("ros2", "Excused(3, (2,), 0.0, (1,))", "Excused(3, (0,), 0.0, (1,))"),
        ("ros2", "Excused(3, (2,), 0.0, (1,))", "Excused(3, (2,), 1.0, (1,))"),
        ("python", "st = 0.0", "st = 1.0"),
        ("python", "if new_v:\n                self.invalid += 1", "if new_st:\n                self.invalid += 1"),
        (
            "python",
            "            if new_v:\n                self.invalid += 1\n                return self.verdict\n",
            "",
        ),
    ],
)
def test_what_a_text_says_of_signals_without_a_value_is_read_back(target: str, right: str, wrong: str) -> None:
    compiled, whole = from_text(TOLD)
    text = emit(target, compiled, whole)
    assert right in text
    assert isinstance(read_back(text.replace(right, wrong, 1), compiled)[0], Difference)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("if (!signals->has_v && signals->new_v) {", "if (!signals->has_v && signals->new_st) {"),
        ("if (!signals->has_st && signals->new_st) {", "if (!signals->has_st) {"),
        ('monitors->signals.mode = "";', ""),
        ("if (!signals->has_v) {\n        return false;", "if (!signals->has_on) {\n        return false;"),
    ],
)
def test_what_c_says_of_signals_without_a_value_is_read_back(right: str, wrong: str) -> None:
    compiled, whole = from_text(TOLD)
    files = c.emit(compiled, whole)
    assert right in files.source
    changed = replace(files, source=files.source.replace(right, wrong))
    assert any(isinstance(each, Difference) for each in read_back_c(changed, compiled, whole))


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("if !self.signals.has_v && self.signals.new_v {", "if !self.signals.has_v && self.signals.new_st {"),
        ("if !self.signals.has_st && self.signals.new_st {", "if !self.signals.has_st {"),
        ('new.signals.mode = "";', ""),
        ("if !self.signals.has_v {", "if !self.signals.has_on {"),
    ],
)
def test_what_rust_says_of_signals_without_a_value_is_read_back(right: str, wrong: str) -> None:
    compiled, whole = from_text(TOLD)
    file = rust.file_of(compiled, whole)
    assert right in file.text
    found = reading_rust.written(file.text.replace(right, wrong, 1), file.c.header, file.c.source, compiled)
    assert all(isinstance(each, Difference) for each in found)


def test_the_gate_refuses_a_machine_that_does_not_wait_for_what_matters() -> None:
    (of,), _ = from_text(f"{DECLARED}always (new v and v > 1 or w > v implies new w)\n")
    hasty = replace(of.machine, excused=(Excused(Held("v", 0, DOUBLE), (News("v"),), 0.0),))
    found = compare(hasty, Judged(of.specification, of.formula, of.monitor))
    assert "does not wait for `v`" in str(found)


def test_the_gate_refuses_a_machine_that_does_not_have_all_news() -> None:
    (of,), _ = from_text(
        f"{DECLARED}always (new robot.position and new cart and robot.distance.cart < 1 implies new v)\n"
    )
    (excused,) = of.machine.excused
    hasty = replace(of.machine, excused=(excused._replace(news=excused.news[:1]),))
    found = compare(hasty, Judged(of.specification, of.formula, of.monitor))
    assert "does not have all of its news" in str(found)


def test_a_message_without_the_first_value_is_no_step_and_counted() -> None:
    run = session(f"{DECLARED}never new v and v < 1\n")
    run.begin(0)
    run.judge(SECOND, "/v", None)
    [track] = run.tracks
    assert (track.verdict, track.steps, track.invalid) == (Verdict.PRESUMABLY_SATISFIED, 1, 1)
    assert track.invalid_because == {"a message had no value of v": 1}
    run.message(2 * SECOND, "/v", [0.5])
    assert track.verdict is Verdict.VIOLATED


@pytest.mark.parametrize("text", ["never (new v and v > w / w)", "never (new scan and any(scan > w / w))"])
def test_what_has_no_value_makes_no_step_beside_a_signal_that_has_not_come_too(text: str) -> None:
    run = session(f"{DECLARED}{text}\n")
    run.message(SECOND, "/w", [0.0])
    run.message(2 * SECOND, "/w", [1.0])
    [track] = run.tracks
    assert (track.verdict, track.steps, track.invalid) == (Verdict.PRESUMABLY_SATISFIED, 1, 1)


def test_a_violation_shows_no_value_where_there_was_none_and_does_not_give_it_as_a_reason() -> None:
    run = session(f"{DECLARED}initially (new v and v > 1 or new w and w < 1)\n")
    run.begin(0)
    [track] = run.tracks
    assert track.decided_at is not None
    assert dict(track.decided_at.values) == {"new v": False, "v": None, "new w": False, "w": None}
    assert [reason.text for reason in track.decided_at.because] == ["new v", "new w"]


WAITING = f"{DECLARED}p: never v > w and on\n"


def test_what_came_before_a_property_began_is_reported_with_its_verdict() -> None:
    run = session(WAITING)
    for number in range(12):
        run.message(number * SECOND // 4, "/v", [1.0])
    run.message(3 * SECOND, "/w", [0.0])
    run.message(7 * SECOND // 2, "/on", [True])
    run.message(4 * SECOND, "/v", [1.0])
    [track] = run.tracks
    missed = "12 messages on /v and 1 message on /w before that were not judged"
    told = f"began at +3.5 s, after the first message on /on; {missed}"
    assert told in reports.summary(run.session)
    assert told in junit.junit("run", run.session)
    [said] = documents.document("run", run.session)["properties"]
    assert (said["began_at"], said["began_at_ns"]) == (3.5, 3_500_000_000)
    assert said["not_judged"] == {"/v": 12, "/w": 1}
    assert track.steps == 2


def test_a_property_that_missed_nothing_says_nothing_of_its_beginning() -> None:
    run = session(f"{DECLARED}p: never v > 3\n")
    run.message(SECOND, "/v", [1.0])
    assert "began" not in reports.summary(run.session)
    [said] = documents.document("run", run.session)["properties"]
    assert said.keys().isdisjoint({"began_at", "not_judged"})


def test_messages_before_the_first_tick_with_a_step_are_counted_by_ticks_that_saw_them() -> None:
    run = session(f"_rate_ = 2\n{WAITING}")
    for number in range(4):
        run.message(number * SECOND // 2, "/v", [1.0])
    run.message(7 * SECOND // 4, "/w", [0.0])
    run.message(9 * SECOND // 4, "/on", [True])
    run.advance(3 * SECOND)
    assert (
        "began at +2.5 s, after the first message on /on; 4 messages on /v and 1 message on /w before that"
        in reports.summary(run.session)
    )
