"""The replay accepts emitted code that does what its monitor does, and notices code that does not."""

from __future__ import annotations

import sys
from itertools import cycle, product

import pytest
from replaying import MESSAGES, missed_changes, outcomes, samples
from stepping import from_text

from ltlc.assurance.courses import Courses
from ltlc.assurance.programs import programs
from ltlc.assurance.replay import Deviation, Replayed
from ltlc.backends import emit
from ltlc.compiler import Compiled

SIMPLE = {
    "stop sign": "after_until robot.distance.sign < 1, robot.distance.sign > 1, eventually robot.velocity == 0",
    "margin": "never robot.velocity >{0.1} 2.0",
    "arithmetic": "after robot.velocity > 1, eventually 1 / robot.velocity > 3 or sqrt(robot.position.x) > 1",
    "array": "decl scan /scan LaserScan.ranges\nalways min(scan) > 0.3",
    "element": "decl scan /scan LaserScan.ranges\ndecl one /scan LaserScan.ranges[1]\n"
    "never min(scan) < 0.3 and one > 0.5",
    "fixed array": "decl all /odom Odometry.pose.covariance\ndecl one /odom Odometry.pose.covariance[7]\n"
    "always max(all) > one",
    "fields of messages": "decl id /s action_msgs/GoalStatusArray.status_list[].goal_info.stamp.sec\n"
    "decl state /s action_msgs/GoalStatusArray.status_list[].status\n"
    "never any(id == 3 and not state in {4, 5}) and state[1] == 4",
    "strings and bytes": "decl name /d DiagnosticArray.status[].name\ndecl level /d DiagnosticArray.status[].level\n"
    'until any(name == "motor" and level >= 2), len(name) < 3',
    "entries of an entry": 'decl key /d DiagnosticArray.status[1].values[].key\nalways all(key != "a")',
    "slice": "decl scan /scan LaserScan.ranges\nnever count(scan[2:5] < 0.3) >= 2 or sum(scan[-2:]) > 1",
    "fixed array by its elements": "decl all /odom Odometry.pose.covariance\n"
    "after any(all[30:] > all[3]), eventually all(abs(all) < 2)",
    "string": 'decl mode /mode String.data\nuntil mode == "done", mode != "fault"',
    "boolean": "decl enabled /enabled Bool.data\nafter enabled, eventually not enabled",
    "integer": "decl n /n Int8.data\nafter n > 2.5, eventually n * 2 == 6",
    "byte": "decl level /d DiagnosticArray.status[1].level\nafter level > 1, eventually level == 0",
    "places": "object a at (1, 2, 3)\nobject robot /gt Pose\nalways (after robot.distanceZ.a < 1, robot.velocity < 2)",
    "model states": "object robot /s ModelStates\nobject cone /s ModelStates\n"
    "after_until robot.distance.cone < 1, robot.velocity > 2, never robot.velocity_angular > 1",
    "angle": "object robot /a Pose\nobject cone /b Pose\n"
    "after robot.orientation_between.cone > 2, eventually robot.orientation < 1",
    "error": "model robot: position /amcl Odometry.pose.pose.position ;\nnever robot.localization_error > 0.5",
}
WITH_HISTORY = {
    "history": "never robot.position.x - @{robot.position.x, -2} > 0.2",
    "only history": "after @{robot.position.x, -2} > 1, eventually robot.position.x < 0",
    "slope": "object robot /tf TFMessage\n"
    "after_until robot.velocity.x > 1, robot.velocity.x < 0.5, eventually robot.position.y > 1",
    "past of a slope": "object robot /gt Pose\nnever @{robot.velocity, -1} > 1 and robot.velocity < 0.5",
}
SAMPLED = {"at every message": "", "at a rate": "_rate_ = 10\n", "for a while": "_rate_ = 10\n_timeout_ = 2\n"}
REPLAYED = [*zip(SIMPLE, cycle(SAMPLED)), *product(WITH_HISTORY, SAMPLED)]
"""What has a history with all settings, all else with one; `benchmarks/differential` draws both."""

MADE_UP = ("array", "fields of messages", "strings and bytes", "boolean", "byte", "model states", "angle")
"""Messages of all kinds of fields."""


@pytest.mark.parametrize("text", (SIMPLE | WITH_HISTORY).values(), ids=SIMPLE | WITH_HISTORY)
def test_emitted_classes_do_what_their_monitors_do(text: str) -> None:
    assert all(isinstance(outcome, Replayed) for outcome in outcomes(text, "python"))


@pytest.mark.parametrize(("name", "sampled"), REPLAYED)
def test_emitted_nodes_do_what_their_monitors_and_the_definitions_say(name: str, sampled: str) -> None:
    text = SAMPLED[sampled] + (SIMPLE | WITH_HISTORY)[name]
    assert all(isinstance(outcome, Replayed) for outcome in outcomes(text, "ros2"))


@pytest.mark.parametrize("sampled", SAMPLED.values(), ids=SAMPLED)
def test_what_reads_nothing_is_replayed_from_the_beginning_of_the_session_on(sampled: str) -> None:
    (outcome,) = outcomes(f"{sampled}always 1 < 2", "ros2")
    assert isinstance(outcome, Replayed)
    assert outcome.letters == 1


@pytest.mark.parametrize("target", ["python", "ros2"])
def test_what_reads_nothing_is_judged_in_time(target: str) -> None:
    assert all(isinstance(each, Replayed) for each in outcomes("eventually 2 < 1 within 1 s", target))


def test_messages_are_made_up_where_their_packages_are_not_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ltlc.assurance.messages.Messages.is_installed", lambda *_: False)
    monkeypatch.setattr("ltlc.assurance.messages.Messages._class", lambda *_: None)
    for name in MADE_UP:
        assert isinstance(outcomes(SIMPLE[name], "ros2")[0], Replayed)


def test_a_node_is_replayed_without_ros(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("rclpy", "nav_msgs.msg"):
        monkeypatch.setitem(sys.modules, name, None)
    assert isinstance(outcomes(SIMPLE["stop sign"], "ros2")[0], Replayed)


@pytest.mark.parametrize("text", WITH_HISTORY.values(), ids=WITH_HISTORY)
def test_a_property_with_history_is_led_through_every_transition_of_its_monitor(text: str) -> None:
    [compiled], _ = from_text(text)
    drawn = samples(compiled)
    taken = set()
    for course in Courses(drawn, compiled.monitor).guided():
        state = 0
        for end in range(drawn.reach, len(course) + 1):
            letter = drawn.letter(course[:end])
            assert letter is not None
            taken.add((state, letter))
            state = compiled.monitor.step(state, letter)
    open_states = [state for state, verdict in enumerate(compiled.monitor.verdicts) if not verdict.is_permanent]
    letters = list(compiled.specification.alphabet.letters())
    assert taken >= {(state, letter) for state in open_states for letter in letters}


SLOPE = WITH_HISTORY["slope"]
EPISODES = SIMPLE["stop sign"].replace("> 1", "> 0.5")
STATES = SIMPLE["model states"]
YAW = "never robot.orientation > 1"
FAULTS = {
    "the sign of a slope": (SLOPE, "value - known[first + 1]", "known[first + 1] - value"),
    "a slope without time": (SLOPE, "divide(change, seconds(last - before))", "change"),
    "an episode that opens and closes at one step": (EPISODES, "self.is_open = False\n            return", "pass"),
    "an episode that is not counted": (EPISODES, "self.count += 1", "self.count += 0"),
    "the order of a quaternion": (YAW, "orientation.x,", "orientation.w,"),
    "the formula of an angle": (YAW, "1 - 2 * (y * y + z * z)", "1 - 2 * (x * x + z * z)"),
    "linear and angular velocity": (STATES, ".linear", ".angular"),
    "the last of several entries": (
        STATES,
        "next((i for i, n in zip(items, names, strict=False) if n == value), None)",
        "([None] + [i for i, n in zip(items, names, strict=False) if n == value])[-1]",
    ),
    "history one sample short": (
        WITH_HISTORY["only history"],
        "return self.first + wanted.ago",
        "return self.first + max(wanted.ago - 1, 0)",
    ),
    "an old distance": (SIMPLE["stop sign"], "fresh += [self._derived[place][0] for place in more]", "pass"),
    "a rate that is not asked for": (SIMPLE["margin"], "rate=None", "rate=10.0"),
    "a run that does not end": ("_timeout_ = 2\n" + SIMPLE["margin"], "timeout=2000000000", "timeout=None"),
    "ticks that are late": (
        "_rate_ = 10\n" + SIMPLE["margin"],
        "pace if self._next < time",
        "pace if self._next <= time",
    ),
    "a gap that is not counted": ("_rate_ = 10\n" + SIMPLE["margin"], "ticks.count += times", "pass"),
}


@pytest.mark.parametrize(("text", "right", "wrong"), FAULTS.values(), ids=FAULTS)
def test_a_fault_in_what_is_around_the_monitors_of_a_node_is_noticed(text: str, right: str, wrong: str) -> None:
    assert any(isinstance(outcome, Deviation) for outcome in outcomes(text, "ros2", right, wrong))


@pytest.mark.parametrize("text", [SIMPLE["stop sign"], SIMPLE["margin"]], ids=["stop sign", "margin"])
def test_every_change_of_emitted_code_that_changes_a_verdict_is_caught(text: str) -> None:
    compiled, missed = missed_changes(text)
    assert [line for line in missed if not _changes_no_verdict(line, compiled)] == []


def _changes_no_verdict(line: str, compiled: Compiled) -> bool:
    """Counting invalid steps, and the name of a state that nothing leaves."""
    final = [state for state, verdict in enumerate(compiled.monitor.verdicts) if verdict.is_permanent]
    return "self.invalid" in line or line in [f"self.state = {state + 1}" for state in final]


def test_code_that_raises_is_a_deviation_and_not_an_accident() -> None:
    [outcome] = outcomes(SIMPLE["margin"], "ros2", "self.state = 0", "self.state = 1 / 0")
    assert isinstance(outcome, Deviation)
    assert str(outcome.emitted).startswith("ZeroDivisionError")
    assert outcome.events == 1


@pytest.mark.parametrize("target", ["hoa", "dot", "json"])
def test_an_output_that_is_no_code_is_not_replayed(target: str) -> None:
    compiled, specification = from_text(SIMPLE["margin"])
    assert programs(target, emit(target, compiled, specification), compiled, specification, MESSAGES) is None
