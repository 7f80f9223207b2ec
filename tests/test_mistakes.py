"""The mistakes of new users in their first hour: what they wrote, and the line or the words that lead to the fix."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import pytest
from bag_support import LEVEL, Sent, made, mcap, odometry
from language_support import findings

from ltlc.base.fixes import with_fixes
from ltlc.base.source import Source
from ltlc.cli import main
from ltlc.frontend.language import load_text

NAMES = """decl v /odom Odometry.twist.twist.linear.x
decl scan /scan LaserScan.ranges
decl on /on Bool.data
decl goal /goal Bool.data
decl state /state String.data
model robot: position /odom Odometry.pose.pose.position ;
stopped = v == 0
"""
ALWAYS_SAID = ("LTL104", "LTL306")
"""That a name is not used, and that a file of declarations states no property."""


class Line(NamedTuple):
    """A line of a specification, the code of what is said of it, and the line that is offered instead."""

    written: str
    code: str
    answer: str


class Told(NamedTuple):
    """A line that nothing can be written instead of; the help says why, or what to choose from."""

    written: str
    code: str
    help: str


class Command(NamedTuple):
    """A command line, and what of the answer leads to the one that works."""

    written: str
    answer: str


MISTAKES: tuple[Line | Told | Command, ...] = (
    # Those whose message led straight to the fix before.
    Line("alway v < 1", "LTL101", "always v < 1"),
    Line("always v < 1 && on", "LTL004", "always v < 1 and on"),
    Line("always on -> goal", "LTL004", "always on implies goal"),
    Line("ALWAYS v < 1", "LTL004", "always v < 1"),
    Line("never v = 1", "LTL003", "never v == 1"),
    Line("never scan < 0.3", "LTL205", "never any(scan < 0.3)"),
    Line("never state == IDLE", "LTL101", 'never state == "IDLE"'),
    Line("never state == 'IDLE'", "LTL004", 'never state == "IDLE"'),
    Line("never v > 1 m/s", "LTL020", "never v > 1"),
    Line("never v > 5 km/h", "LTL020", "never v > 1.38889"),
    Line("never v > 90 degrees", "LTL020", "never v > 1.5708"),
    Line("eventually on within 2", "LTL216", "eventually on within 2 s"),
    Line("on within 2 s", "LTL016", "eventually on within 2 s"),
    Line("eventually on for 2 s", "LTL308", "eventually on within 2 s"),
    Line("always age(scan) <= 1", "LTL218", "always age(scan) <= 1 s"),
    Line("eventually on within 2 sec", "LTL004", "eventually on within 2 s"),
    Line("always 0 < v < 1", "LTL013", "always 0 < v and v < 1"),
    Line("never mean(v) > 1", "LTL207", "never mean(@{v, -9:}) > 1"),
    Line("_margin_ = 0.1 m", "LTL020", "_margin_ = 0.1"),
    Line("_rate_ = 10 Hz", "LTL020", "_rate_ = 10"),
    Command("run props.txt none.mcap", "there is no file `none.mcap`"),
    Command("run none.txt drive.mcap", "there is no file none.txt"),
    Command("run other.txt odom.mcap", "its only topic is `/odom`"),
    Command("run twist.txt odom.mcap", "`nav_msgs/msg/Odometry` in the recording, not `geometry_msgs/msg/Twist`"),
    Command("run typo.txt odom.mcap", "did you mean `/odom`?"),
    Line("decl w /odom Odometry.twist.twist.linear.q", "LTL203", "decl w /odom Odometry.twist.twist.linear.x"),
    Line("decl w /odom Odometry.linear.x", "LTL203", "decl w /odom Odometry.twist.twist.linear.x"),
    Line("decl w /odom Odometry.twist.linear.x", "LTL203", "decl w /odom Odometry.twist.twist.linear.x"),
    Told("decl w /odom Odometry.x", "LTL203", "its fields are `header`, `child_frame_id`, `pose`, `twist`"),
    Line("decl w /lamp Bool\nnever w", "LTL220", "decl w /lamp Bool.data\nnever w"),
    Line("decl w /w std_msgs/Float64\nnever w > 1", "LTL220", "decl w /w std_msgs/Float64.data\nnever w > 1"),
    Told("decl w /odom Odometry never w > 1", "LTL220", "as in `Odometry.pose.pose.position` or `Odometry.pose.pose."),
    Line("decl w /odom Odometri.twist.twist.linear.x", "LTL201", "decl w /odom Odometry.twist.twist.linear.x"),
    Command("run props.txt cell.csv", "line 3: column `v`: `abc` is not a number"),
    Command("run props.txt untimed.csv", "there is no column `time`"),
    Command("run props.txt nanoseconds.csv", "is it in nanoseconds? times must be in seconds"),
    Command("run props.txt milliseconds.csv", "is it in milliseconds? times must be in seconds"),
    Command("run props.txt unit.csv", "is it `time [s]`? rename it to `time`"),
    Command("run props.txt semicolons.csv", "columns are separated by commas"),
    Command("build props.txt --target cpp", "'ros2', 'ament', 'python', 'c', 'rust'"),
    Command("check props.txt --format xml", "'full', 'concise', 'json', 'sarif'"),
    # Half.
    Line("F[0,2] on", "LTL021", "eventually on within 2 s"),
    Line("eventually[0:2] on", "LTL021", "eventually on within 2 s"),
    Line("never vel > 1", "LTL101", "never v > 1"),
    Line("never state == 3", "LTL205", 'never state == "3"'),
    Line("always on == 1", "LTL205", "always on"),
    Line("on until goal", "LTL021", "until goal, always on"),
    Line("never derivative(v) > 1", "LTL107", "never (v - @{v, -1}) > 1"),
    Line("never v - previous(v) > 1", "LTL107", "never v - @{v, -1} > 1"),
    Line("never average(scan) > 1", "LTL107", "never mean(scan) > 1"),
    Line("never mean(@{v, -4}) > 1", "LTL207", "never mean(@{v, -4:}) > 1"),
    Told("never v[-1] > 1", "LTL212", "write `@{v, -1}`"),
    Told("never max(v[-5:]) > 1", "LTL212", "write `@{v, -9:}`"),
    Line(
        "zone z = (0, 0), (4, 0), (4, 3)\nnever inside(v, v, z)",
        "LTL021",
        "zone z = [(0, 0), (4, 0), (4, 3)]\nnever inside(v, v, z)",
    ),
    Line("[R-1] never v > 1", "LTL001", '[id "R-1"] never v > 1'),
    Told('[id = "R-1"] never v > 1', "LTL006", 'the form is `[id "REQ-1", severity high]`'),
    Line("never v.x > 1", "LTL105", "never v > 1"),
    Line(
        "decl w /odom nav_msgs::Odometry.pose.pose.position.x",
        "LTL021",
        "decl w /odom nav_msgs/Odometry.pose.pose.position.x",
    ),
    Line("never /odom/twist/twist/linear/x > 1", "LTL021", "never v > 1"),
    Line("decl w /odom Odometry pose.pose.position.x", "LTL021", "decl w /odom Odometry.pose.pose.position.x"),
    Line("decl w Odometry /odom.pose.pose.position.x", "LTL021", "decl w /odom Odometry.pose.pose.position.x"),
    Command("build props.txt -t json -o made.json", "wrote made.json"),
    Command("checks props.txt", "did you mean `check`?"),
    Command("run props.txt column.csv", "its other column is `speed`: rename it to `v`, or change the declaration"),
    Command(
        "run props.txt columns.csv", "its other columns are `vel`, `a`, `b`, `c`, `d` and 2 more: rename one to `v`"
    ),
    Command("run props.txt columns.jsonl", "its other columns are `vel`, `level`"),
    Command(
        "run props.txt topics.csv", "its other columns are `/odom/twist/twist/linear/y`, `/imu/x`: rename one to `v`"
    ),
    Command("run props.txt odom.mcap --from 2000000000", "the recording ends before"),
    # Not.
    Line("globally: no /odom {twist.twist.linear.x > 1} within 3 s", "LTL021", "never (new v and v > 1) within 3 s"),
    Line("/goal causes /on within 5 s", "LTL021", "always (new goal implies eventually new on within 5 s)"),
    Line("The robot shall always satisfy (v < 1)", "LTL021", "always (v < 1)"),
    Line(
        "when on, the robot shall within 2 seconds satisfy stopped",
        "LTL021",
        "always (on and not previously on implies (eventually stopped within 2 s))",
    ),
    Line("never scan.min < 0.3", "LTL105", "never min(scan) < 0.3"),
    Line(
        "always (on implies eventually stopped in 2 s)", "LTL021", "always (on implies eventually stopped within 2 s)"
    ),
    Line("always (on implies next stopped)", "LTL021", "always (@{on, -1} implies stopped)"),
    Line("never (on until v > 1)", "LTL021", "never (until v > 1, always on)"),
    Line("if on then stopped", "LTL021", "always (on implies stopped)"),
    Line("always if on then stopped", "LTL021", "always (on implies stopped)"),
    Line("always v between 0 and 1", "LTL021", "always (0 <= v and v <= 1)"),
    Line("never |v| > 2", "LTL021", "never abs(v) > 2"),
    Line("never v > 2;", "LTL021", "never v > 2"),
    Told("never v == NaN", "LTL101", "omit this comparison: a sample that is NaN makes no step"),
    Line("never v > inf", "LTL101", "never v > (1 / 0)"),
    Line("never robot.speed > 1", "LTL105", "never robot.velocity > 1"),
    Line("never v' > 2", "LTL021", "never (v - @{v, -1}) > 2"),
    Line("nav: fast: never v > 2", "LTL021", "fast: never v > 2"),
    Line("after on until goal, never v > 1", "LTL021", "after_until on, goal, never v > 1"),
    Line("between on and goal never v > 1", "LTL021", "after_until on, goal, never v > 1"),
    Line("on U goal", "LTL021", "until goal, always on"),
    Line("on W goal", "LTL021", "(until goal, always on) or always on"),
    Line("X on", "LTL021", "after once new on 2 times, initially on"),
    Line("G_[0,10] on", "LTL021", "always on for 10 s"),
    Line("on U[0,5] goal", "LTL021", "(until goal, always on) and (eventually goal within 5 s)"),
    Line("on until[0,3] goal", "LTL021", "(until goal, always on) and (eventually goal within 3 s)"),
    Line("never min(scan < .3)", "LTL021", "never any(scan < 0.3)"),
    Line("always age(/scan) < 1 s", "LTL021", "always age(scan) < 1 s"),
    Line("REQ-001: never v > 2", "LTL001", '[id "REQ-001"]\nnever v > 2'),
    Command("run drive.mcap props.txt", "give the specification first, then recordings: `ltlc run PROPS drive.mcap`"),
    Command("check own.txt", "`--msg-path` adds the messages of a package or a bag"),
    Line("w = /odom.pose.pose.position.x", "LTL021", "decl w /odom Odometry.pose.pose.position.x"),
    Command("run props.txt calendar.csv", "write it in seconds since 1970: `1769787125.5`, if it is in UTC"),
    Command("run props.txt flight.ulg", "cannot be read as a flight log: it does not begin as one"),
)

FILES = {
    "props.txt": "decl v /odom Odometry.twist.twist.linear.x\nslow: never v > 1\n",
    "own.txt": "decl level /level own_msgs/Level.state\nfull: eventually level == 3\n",
    "other.txt": "decl on /lamp Bool.data\nlit: eventually on\n",
    "twist.txt": "decl v /odom Twist.linear.x\nslow: never v > 1\n",
    "typo.txt": "decl v /odm Odometry.twist.twist.linear.x\nslow: never v > 1\n",
    "cell.csv": "time,v\n0,0.1\n1,abc\n",
    "untimed.csv": "v\n0.1\n",
    "nanoseconds.csv": "time,v\n1769787125000000000,0.1\n",
    "milliseconds.csv": "time,v\n1769787125000,0.1\n",
    "unit.csv": "time [s],v\n1,0.1\n",
    "semicolons.csv": "time;v\n0;0,1\n",
    "column.csv": "time,speed\n0,0.1\n1,0.2\n",
    "columns.csv": "time,a,b,c,d,e,vel,scan[0],scan[1]\n0,0,0,0,0,0,0.1,0,0\n",
    "columns.jsonl": '{"time": 0, "level": 0, "vel": 0.1}\n',
    "topics.csv": "time,/imu/x,/odom/twist/twist/linear/y\n0,0,0.1\n",
    "calendar.csv": "time,v\n2026-01-30T15:32:05.5,0.1\n",
    "flight.ulg": "ULog",
}


@pytest.mark.parametrize(
    "mistake", [each for each in MISTAKES if isinstance(each, Line)], ids=lambda each: each.written
)
def test_the_line_that_was_meant_is_offered_and_has_no_mistake(mistake: Line) -> None:
    text = f"{NAMES}{mistake.written}\n"
    found = [each for each in findings(text) if each.code not in ALWAYS_SAID]
    assert [each.code for each in found] == [mistake.code]
    fixed = with_fixes(text, found[0].fixes[:1])
    assert fixed.endswith(f"\n{mistake.answer}\n")
    _, diagnostics = load_text(Source("props.txt", fixed))
    assert [each.message for each in diagnostics if each.code not in ALWAYS_SAID] == []


@pytest.mark.parametrize(
    "mistake", [each for each in MISTAKES if isinstance(each, Told)], ids=lambda each: each.written
)
def test_the_help_says_what_is_to_be_chosen_where_no_line_can_be_offered(mistake: Told) -> None:
    text = f"{NAMES}{mistake.written}\n"
    [found] = [each for each in findings(text) if each.code not in ALWAYS_SAID]
    assert found.code == mistake.code
    assert mistake.help in found.help


@pytest.mark.parametrize(
    "mistake", [each for each in MISTAKES if isinstance(each, Command)], ids=lambda each: each.written
)
def test_the_answer_to_a_command_leads_to_the_one_that_works(
    mistake: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    for name, content in FILES.items():
        Path(name).write_text(content)
    mcap(Path("odom.mcap"), [odometry(10**9)])
    mcap(Path("drive.mcap"), [Sent("/level", LEVEL, 10**9, made(LEVEL))])
    assert mistake.answer in said_of(mistake.written.split(), capsys)


def said_of(arguments: Sequence[str], capsys: pytest.CaptureFixture[str]) -> str:
    """What a command says, on stderr and stdout."""
    try:
        main(arguments)
    except SystemExit as end:
        assert end.code == 2  # noqa: PT017  usage
    said = capsys.readouterr()
    return said.err + said.out
