"""`ltlc new`: a specification to start with, of which nothing is to be said, for any topics."""

from __future__ import annotations

import csv
import io
import json
import math
import re
import shutil
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from bag_support import LEVEL, ODOMETRY, SCAN, STORE, Sent, made, mcap, odometry, random_message, ros1, rosbag2
from effort import share_of
from hypothesis import given, settings
from hypothesis import strategies as st
from language_support import compiled
from pyarrow import parquet as pq

from ltlc.analysis.analyse import analyse
from ltlc.automata import Budget
from ltlc.base.source import Source
from ltlc.cli import main
from ltlc.frontend.language import load_text
from ltlc.frontend.layout import layout
from ltlc.frontend.starter import Draft
from ltlc.frontend.starter.measured import Probe
from ltlc.frontend.starter.topics import Topic, listed
from ltlc.inputs.messages.definitions import FieldType, Message, MessageTypes, shipped
from ltlc.inputs.messages.texts import comments_in
from ltlc.monitoring.measuring.measure import measure
from ltlc.monitoring.mining.mine import mine
from ltlc.monitoring.mining.template import load as load_template
from ltlc.semantics.encodings import EPISODE

BAGS = Path(__file__).parents[2] / "shared" / "data" / "bags"
TYPES = sorted(MessageTypes(shipped()).messages)
TYPES_OF_MESSAGES = [type_ for type_ in TYPES if type_ in STORE.types]
ROBOT = """/odom [nav_msgs/msg/Odometry]
/scan [sensor_msgs/msg/LaserScan]
/cmd_vel [geometry_msgs/msg/Twist]
/rosout [rcl_interfaces/msg/Log]

/mission [my_msgs/msg/Mission]
"""

Run = Callable[..., int]


@pytest.fixture
def new(monkeypatch: pytest.MonkeyPatch) -> Run:
    def run(topics: str, *arguments: str) -> int:
        monkeypatch.setattr(sys, "stdin", io.StringIO(topics))
        return main(["new", *arguments])

    return run


def with_all_that_is_offered(text: str) -> str:
    """A starter without the `#` before properties and declarations."""
    return re.sub(r"^# (?=decl |\w+: )", "", text, flags=re.MULTILINE)


def with_values(text: str) -> str:
    """A starter with a number or a duration in the place of each `?`."""
    timed = re.sub(r"^([^#].*(?:<=|within)) \?", r"\1 1 s", text, flags=re.MULTILINE)
    return re.sub(r"^([^#].*[<>]) \?", r"\1 1", timed, flags=re.MULTILINE)


def without_unknown(text: str) -> str:
    """A starter without the rules that have a `?`."""
    return re.sub(r"^\w+: .*\?.*\n", "", text, flags=re.MULTILINE)


def test_nothing_but_values_is_asked_for_in_what_is_written_for_all_types(
    new: Run, capsys: pytest.CaptureFixture[str]
) -> None:
    assert new("".join(f"/n{number}/topic [{type_}]\n" for number, type_ in enumerate(TYPES))) == 0
    text = capsys.readouterr().out
    assert {each.code for each in load_text(Source("props.txt", text))[1]} == {"LTL840"}
    specification, diagnostics = load_text(Source("props.txt", with_values(text)))
    assert diagnostics == []
    assert specification is not None
    assert analyse(specification, EPISODE, Budget(120.0, 1024)).diagnostics == ()
    assert len(specification.properties) > len(TYPES)
    assert layout(Source("props.txt", text)) == text
    assert len(compiled(with_values(with_all_that_is_offered(text))).properties) > 2 * len(TYPES)


@pytest.mark.parametrize("type_", [type_ for type_ in TYPES if type_.partition("/")[0] in ("std_msgs", "sensor_msgs")])
def test_the_front_end_finds_nothing_in_what_is_written_for_one_type(
    new: Run, type_: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert new(f"/a [{type_}]\n") == 0
    assert load_text(Source("props.txt", with_values(capsys.readouterr().out)))[1] == []


def test_the_page_shows_what_is_written(
    new: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    page = (Path(__file__).parents[1] / "docs" / "new.md").read_text(encoding="utf-8")
    before = page.partition("\n## Layout\n")[0]
    measured, unmeasured = re.findall(r"^```\n(.*?)^```", before, re.DOTALL | re.MULTILINE)
    assert new("/odom [nav_msgs/msg/Odometry]") == 0
    assert capsys.readouterr().out.endswith(f"\n\n{unmeasured}")
    monkeypatch.chdir(tmp_path)
    mcap(Path("drive.mcap"), drive())
    assert main(["new", "drive.mcap"]) == 0
    assert capsys.readouterr().out == measured


def test_what_is_left_out_is_said(new: Run, capsys: pytest.CaptureFixture[str]) -> None:
    assert new(ROBOT) == 0
    text = capsys.readouterr().out
    assert "# /rosout [rcl_interfaces/msg/Log]: it is about ROS, not about the robot\n" in text
    assert "# /mission [my_msgs/msg/Mission]: the type is unknown" in text


def test_a_scanner_and_odometry_of_one_robot_make_a_stop(new: Run, capsys: pytest.CaptureFixture[str]) -> None:
    assert new(ROBOT.replace("/scan ", "/other/scan ")) == 0
    assert "stops: " not in capsys.readouterr().out
    assert new(ROBOT) == 0
    found = compiled(with_values(with_all_that_is_offered(capsys.readouterr().out)))
    assert "stops" in [each.label for each in found.properties]


def test_a_message_path_makes_types_known(new: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "my_msgs" / "msg").mkdir(parents=True)
    (tmp_path / "my_msgs" / "msg" / "Mission.msg").write_text("bool done\n")
    assert new("/mission [my_msgs/msg/Mission]", "--msg-path", str(tmp_path)) == 0
    written = capsys.readouterr().out
    assert "decl mission /mission Mission.done\n" in written
    assert "from the bag" not in written


FROM_THE_BAG = "are defined in this recording alone"


def start_of(path: Path) -> str:
    """The comment at the beginning of a file, as running text."""
    return " ".join(path.read_text().partition("\n\n")[0].split("\n# "))


def test_a_file_made_of_a_bag_with_types_of_its_own_says_how_other_commands_know_them(tmp_path: Path) -> None:
    bag = mcap(tmp_path / "drive.mcap", [Sent("/level", LEVEL, 0, made(LEVEL))])
    assert main(["new", str(bag), "-o", str(tmp_path / "props.txt")]) == 0
    assert f"{FROM_THE_BAG}: `--msg-path {bag.name}` gives them to `ltlc check`" in start_of(tmp_path / "props.txt")


def test_a_file_made_of_a_bag_with_types_that_ros_brings_does_not(tmp_path: Path) -> None:
    bag = mcap(tmp_path / "drive.mcap", [odometry(0)])
    assert main(["new", str(bag), "-o", str(tmp_path / "props.txt")]) == 0
    assert FROM_THE_BAG not in start_of(tmp_path / "props.txt")


NAMES = (
    "/never",
    "/s",
    "/new",
    "/min",
    "/F",
    "/AND",
    "/opening",
    "/a_b",
    "/a/b",
    "/a__b",
    "/a",
    "/a/b_2",
    "/_rate_",
    "/_1",
)
ODD_NAMES = (
    "/2j",
    "/a/",
    "/ä",
    "/a#b",
    "/x/_action/status",
    "/odom",
    "/odom/speed",
    "/odom/speed_limit",
    "/scan",
    "~/x",
)


@settings(max_examples=40)
@given(
    st.lists(st.tuples(st.sampled_from(NAMES + ODD_NAMES), st.sampled_from([*TYPES, "a/msg/B, c/msg/D"])), max_size=9)
)
def test_any_names_of_topics_make_names_of_signals_and_properties(topics: list[tuple[str, str]]) -> None:
    draft = Draft(listed("".join(f"{name} [{type_}]\n" for name, type_ in topics)), MessageTypes(shipped()))
    if not draft.is_empty:
        text = draft.text("a list")
        assert load_text(Source("props.txt", with_values(text)))[1] == []
        assert compiled(with_values(with_all_that_is_offered(text)))


@pytest.mark.parametrize("line", ["/scan", "/scan sensor_msgs/msg/LaserScan", "scan []", "WARNING: no daemon"])
def test_a_line_that_is_no_topic_is_said_with_its_number(
    new: Run, line: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert new(f"/odom [nav_msgs/msg/Odometry]\n{line}\n") == 2
    found = capsys.readouterr()
    assert found.out == ""
    assert f"line 2 of the topics is {line!r}" in found.err


def test_types_are_known_by_their_names_in_ros_1_too(new: Run, capsys: pytest.CaptureFixture[str]) -> None:
    assert new("\ufeff/odom [nav_msgs/Odometry]\r\n") == 0
    assert "# /odom [nav_msgs/msg/Odometry]\n" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("topics", "said"),
    [
        ("", "there is no topic to write properties for\n"),
        ("/a [b/msg/C]", "properties for\n  /a [b/msg/C]: the type is unknown; `--msg-path` adds the messages of"),
        ("/rosout [rcl_interfaces/msg/Log]", "/rosout [rcl_interfaces/msg/Log]: it is about ROS, not about the robot"),
    ],
)
def test_without_a_topic_to_speak_of_nothing_is_written(
    new: Run, topics: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert new(topics, "-o", str(tmp_path / "props.txt")) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "props.txt").exists()


def test_nothing_is_written_over_a_file(new: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "props.txt"
    assert new(ROBOT, "-o", str(path)) == 0
    text = path.read_text()
    assert text.startswith("# A start for what the robot must do")
    assert new("/a [std_msgs/msg/Bool]", "-o", str(path)) == 2
    assert path.read_text() == text
    assert "already exists and is not overwritten" in capsys.readouterr().err


def test_a_file_that_cannot_be_written_is_said(new: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert new(ROBOT, "-o", str(tmp_path / "none" / "props.txt")) == 2
    assert "cannot be written" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["none.mcap", "drive.csv", "drive.txt", "damaged.mcap"])
def test_a_recording_that_cannot_be_read_is_reported(
    tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "drive.csv").write_text("time,x\n1,1\n0,1\n")
    (tmp_path / "drive.txt").write_text("time,x\n0,1\n")
    (tmp_path / "damaged.mcap").write_text("no bag")
    assert main(["new", str(tmp_path / name)]) == 2
    assert "LTL" in capsys.readouterr().err


def drive() -> list[Sent]:
    """A robot that reports where it is from 3 s on, its state from 200 ms on, and a button that is pressed once."""
    times = [3 * 10**9 + 50 * 10**6 * number for number in range(100)]
    sent = [
        odometry(
            time + (200 * 10**6 if number > 50 else 0),
            twist__twist__linear__x=number / 100,
            pose__pose__position__x=number / 20 - 1,
        )
        for number, time in enumerate(times)
    ]
    level = [
        Sent("/level", LEVEL, 2 * 10**8 * number, made(LEVEL, state=3 if number else 1)) for number in range(1, 42)
    ]
    sent += [*level, Sent("/go", "std_msgs/msg/Bool", 5, made("std_msgs/msg/Bool"))]
    return sorted(sent, key=lambda each: each.time)


def judged(text: str, bag: Path, capsys: pytest.CaptureFixture[str]) -> tuple[int, int, str]:
    """The exit codes of `ltlc check` and `ltlc run`, and what they say."""
    path = bag.parent / "props.txt"
    path.write_text(text)
    capsys.readouterr()
    codes = main(["check", "--recording", str(bag), str(path)]), main(["run", str(path), str(bag)])
    said = capsys.readouterr()
    return *codes, said.out + said.err


def passes(bag: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """What is made of the bag has nothing to be said of, and the bag passes it and all that it offers."""
    capsys.readouterr()
    assert main(["new", str(bag)]) == 0
    text = capsys.readouterr().out
    assert str(bag.parent) not in text
    checked, ran, said = judged(text, bag, capsys)
    assert (checked, ran) == (0, 0), said
    assert not re.search(r"^(?:warning|error)\[", said, re.MULTILINE), said
    assert "?" not in re.sub(r"#.*", "", text)
    _, ran, said = judged(without_unknown(with_all_that_is_offered(text)), bag, capsys)
    assert ran == 0, said


WRITERS: dict[str, Callable[[Path, Sequence[Sent]], Path]] = {"drive": rosbag2, "drive.mcap": mcap, "drive.bag": ros1}


@pytest.mark.parametrize("name", WRITERS)
def test_the_bag_that_it_was_made_of_passes_it(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bag = WRITERS[name](tmp_path / name, drive())
    assert main(["new", str(bag)]) == 0
    text = capsys.readouterr().out
    passes(bag, capsys)
    stated = {line.partition(":")[0]: line.partition(": ")[2] for line in text.splitlines() if re.match(r"\w+: ", line)}
    assert stated == {
        "go_comes": "eventually new go within 1 s",
        "level_fresh": "always age(level) <= 400 ms",
        "level_rate": "always rate(level) >= 4 Hz over 2 s",
        "level_named": "always level in {Level.LOW, Level.FULL}",
        "odom_comes": "eventually new odom_speed within 6 s",
        "odom_fresh": "after new odom_speed, always age(odom_speed) <= 500 ms",
        "odom_rate": "after once new odom_speed 12 times, always rate(odom_speed) >= 12 Hz over 1 s",
        "odom_speed_limit": "never abs(odom_speed) > 1.19",
        "odom_in_area": "never hypot(odom_position.x, odom_position.y) > 4.8",
    }
    assert "It was 0 throughout.\n# odom_turn_limit: never abs(odom_turn) > ?\n" in text


def rows() -> dict[str, list[Any]]:
    """Columns of a drive: a value for each row, None where there is none."""
    seconds = [number / 10 for number in range(60)]
    return {
        "time": seconds,
        "speed": [round(math.sin(time), 3) for time in seconds],
        "stopped": [abs(math.sin(time)) < 0.1 for time in seconds],
        "mode": ["AUTO" if time < 3 else "HAND" for time in seconds],
        "scan": [[1.5 + number % 3, 2.0, 0.5] for number in range(60)],
        "gear": [number % 2 if number % 4 == 0 else None for number in range(60)],
        "idle": [None] * 60,
        "min": seconds,
        "pos.x": seconds,
        "/odom/pose/strange": seconds,
    }


def as_csv(path: Path) -> Path:
    of = rows()
    arrays = {f"scan[{place}]": [array[place] for array in of["scan"]] for place in range(3)}
    columns = {**{name: column for name, column in of.items() if name != "scan"}, **arrays}
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*columns.values(), strict=True))
    path.write_text(path.read_text().replace("True", "true").replace("False", "false"))
    return path


def as_json_lines(path: Path) -> Path:
    of = rows()
    lines = (json.dumps(dict(zip(of, row, strict=True))) for row in zip(*of.values(), strict=True))
    path.write_text("".join(f"{line}\n" for line in lines))
    return path


def as_parquet(path: Path) -> Path:
    pq.write_table(pa.table({**rows(), "idle": pa.array([None] * 60, pa.float64())}), path)
    return path


TABLES: dict[str, Callable[[Path], Path]] = {
    "drive.csv": as_csv,
    "drive.jsonl": as_json_lines,
    "drive.parquet": as_parquet,
}


@pytest.mark.parametrize("name", TABLES)
def test_the_table_that_it_was_made_of_passes_it(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = TABLES[name](tmp_path / name)
    passes(table, capsys)
    assert main(["new", str(table)]) == 0
    text = capsys.readouterr().out
    assert "guessed from the columns of the table" in " ".join(text.split("\n# "))
    assert set(re.findall(r"^decl .*", text, re.MULTILINE)) == {
        "decl speed /speed Float64.data",
        "decl stopped /stopped Bool.data",
        "decl mode /mode String.data",
        "decl gear /gear Float64.data",
        "decl scan /scan Float64MultiArray.data",
    }
    for stated in ("never speed > 1.2", 'always mode in {"AUTO", "HAND"}', "always len(scan) == 3", "age(gear) <= "):
        assert stated in text
    omitted = text.partition("# Omitted:\n")[2]
    assert re.findall(r"^# column `(\S+)`: ", omitted, re.MULTILINE) == ["idle", "min", "pos.x", "/odom/pose/strange"]


def test_columns_by_topic_and_field_give_the_types_of_messages(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    columns = {
        "__time": [1.7e9 + number / 10 for number in range(40)],
        "/odom/header/stamp": [1.7e9] * 40,
        "/odom/pose/pose/position/x": [number / 9 for number in range(40)],
        "/odom/pose/pose/position/y": [1] * 40,
        "/odom/twist/twist/linear/x": [math.sin(number) for number in range(40)],
        "/r1/scan/ranges[0]": [2 + number % 3 for number in range(40)],
        "/r1/scan/ranges[1]": [3] * 40,
        "/go/data": ["true", "false"] * 20,
        "/cmd/linear/x": [number % 5 for number in range(40)],
        "/odd/nothing": [1] * 40,
        "/late/header/stamp": [1] * 40,
    }
    with (tmp_path / "drive.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*columns.values(), strict=True))
    passes(tmp_path / "drive.csv", capsys)
    assert main(["new", str(tmp_path / "drive.csv")]) == 0
    text = capsys.readouterr().out
    assert {line.partition("  #")[0] for line in re.findall(r"^decl .*", text, re.MULTILINE)} == {
        "decl odom_speed /odom Odometry.twist.twist.linear.x",
        "decl r1_scan /r1/scan LaserScan.ranges",
        "decl go /go Bool.data",
        "decl cmd_speed /cmd Twist.linear.x",
    }
    omitted = text.partition("# Omitted:\n")[2]
    assert re.findall(r"^# column `(\S+)`: ", omitted, re.MULTILINE) == ["/odd/nothing", "/late/header/stamp"]


def test_a_message_path_gives_the_types_of_columns(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "my_msgs" / "msg").mkdir(parents=True)
    (tmp_path / "my_msgs" / "msg" / "Mission.msg").write_text("float64 progress_made\n")
    (tmp_path / "a.csv").write_text("time,/mission/progress_made\n0,1\n1,2\n")
    assert main(["new", str(tmp_path / "a.csv")]) == 2
    assert "no known message type has such fields; `--msg-path`" in capsys.readouterr().err
    assert main(["new", str(tmp_path / "a.csv"), "--msg-path", str(tmp_path / "my_msgs")]) == 0
    assert "# /mission [my_msgs/msg/Mission]\n" in capsys.readouterr().out


def test_a_column_whose_values_change_their_type_is_not_guessed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = tmp_path / "drive.jsonl"
    lines = [{"time": number, "a": number, "b": number if number < 9 else "x"} for number in range(10)]
    table.write_text("".join(f"{json.dumps(line)}\n" for line in lines))
    assert main(["new", str(table)]) == 0
    text = capsys.readouterr().out
    assert "decl a /a Float64.data" in text
    assert "# column `b`: its values are not all numbers" in text


@pytest.mark.parametrize("seed", range(share_of(8)))
def test_any_bag_passes_what_is_made_of_it(seed: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    chance = Random(seed)
    topics = [(f"/t{number}", chance.choice([*TYPES_OF_MESSAGES, LEVEL])) for number in range(3)]
    sent, time = [], 0
    for topic, type_ in [*topics, *chance.choices(topics, k=chance.choice((0, 12, 60)))]:
        time += chance.choice((0, 1, 10**6, 10**8, 10**8, 3 * 10**9))
        sent.append(Sent(topic, type_, time, random_message(type_, chance)))
    passes(mcap(tmp_path / "drive.mcap", sent), capsys)


@pytest.mark.skipif(not BAGS.is_dir(), reason="needs recordings made by others, in ../shared/data/bags")
@pytest.mark.parametrize(
    "bag",
    [
        "mobrob_odom",
        "tb3_kf",
        "rosbag2/sqlite3_talker",
        "rosbag2/mcap_wbag",
        "rosbag2/mcap_rewriter_b",
        "rosbag2/mcap_bag_with_topics_and_service_events",
        "rosbag2/sqlite3_cdr_test",
    ],
)
def test_the_bags_of_others_pass_what_is_made_of_them(
    bag: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    place = tmp_path / "bag"
    shutil.copytree(BAGS / bag, place)
    passes(place, capsys)


EXPRESSIONS = ["abs(v)", "hypot(p.x, p.y)", "max(abs(o.roll), abs(o.pitch))", "min(scan)", "n"]


@pytest.mark.parametrize("seed", range(share_of(3)))
def test_what_is_measured_is_what_the_monitors_find(seed: int, tmp_path: Path) -> None:
    chance = Random(seed)
    declarations = (
        "decl v /odom Odometry.twist.twist.linear.x\ndecl p /odom Odometry.pose.pose.position\n"
        "decl o /odom Odometry.pose.pose.orientation\ndecl scan /scan LaserScan.ranges\ndecl n /n std_msgs/Int16.data\n"
    )
    types, time, sent = {"/odom": ODOMETRY, "/scan": SCAN, "/n": "std_msgs/msg/Int16"}, 10**9, []
    for topic in [*types, *chance.choices(list(types), k=40)]:
        time += chance.choice((0, 1, 10**6, 10**8, 10**9))
        sent.append(Sent(topic, types[topic], time, random_message(types[topic], chance)))
    bag = mcap(tmp_path / "drive.mcap", sent)
    probes = [Probe(text, "number") for text in EXPRESSIONS]
    measured = measure(declarations, probes, bag)
    path = tmp_path / "mine.txt"
    limits = [line for text in EXPRESSIONS for line in (f"never {text} > ?", f"never {text} < ?")]
    path.write_text("\n".join([declarations, *limits, "after new v, always age(v) <= ?", "eventually new v within ?"]))
    template, _ = load_template(path, ())
    assert template is not None
    mined = mine(template, [bag], Budget(60.0, 1024))
    *numbers, gap, start = [found.trial.sought.values.at(found.trial.number) for found in mined.findings]
    assert numbers == [extreme for p in probes for v in [measured.values[p]] for extreme in (v.most, v.least)]
    came = measured.arrivals["/odom"]
    assert (gap, start) == (came.gap, came.start or 1)


def test_a_rate_is_the_fewest_messages_in_any_window(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bag = mcap(tmp_path / "drive.mcap", drive())
    assert main(["new", str(bag)]) == 0
    (count, window) = re.findall(r"The fewest in (\d+) s were (\d+)\.\nodom_rate", capsys.readouterr().out)[0][::-1]
    declared = "decl v /odom Odometry.twist.twist.linear.x\n"
    for least, code in ((int(count), 0), (int(count) + 1, 1)):
        rule = f"after once new v {count} times, always once new v {least} times within {window} s\n"
        assert judged(declared + rule, bag, capsys)[1] == code


def test_strings_that_recur_sizes_and_remarks_are_told_and_counters_are_not(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sent = [
        each
        for number in range(30)
        for each in (
            Sent("/mode", "std_msgs/msg/String", number * 10**8, made("std_msgs/msg/String", data="AB"[number % 2])),
            Sent("/count", "std_msgs/msg/Int32", number * 10**8, made("std_msgs/msg/Int32", data=number)),
            Sent("/scan", SCAN, number * 10**8, made(SCAN, ranges=np.full(8, 1 + number / 9, np.float32))),
            Sent("/stop", "std_msgs/msg/Bool", number * 10**8, made("std_msgs/msg/Bool")),
        )
    ]
    bag = mcap(tmp_path / "drive.mcap", sent)
    assert main(["new", str(bag)]) == 0
    text = capsys.readouterr().out
    assert 'mode_known: always mode in {"A", "B"}\n' in text
    assert "scan_size: always len(scan) == 8\n" in text
    assert "scan_clear: never min(scan) < 0.8\n" in text
    assert "stop_off: never stop\n" in text
    assert "count_most" not in text


@pytest.mark.parametrize(
    ("times", "doubt"),
    [((0, 1, 2), "3 messages are too few to state it."), ((*range(11), 40), "That is too irregular to state it.")],
)
def test_a_limit_on_gaps_that_is_only_offered_says_why(
    times: Sequence[int], doubt: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    message = made("std_msgs/msg/String", data="A")
    bag = mcap(tmp_path / "drive.mcap", [Sent("/mode", "std_msgs/msg/String", t * 10**8, message) for t in times])
    assert main(["new", str(bag)]) == 0
    text = capsys.readouterr().out
    english = " ".join(
        text.partition("# There is a message at least every")[2].partition("\n# mode_fresh:")[0].split("\n# ")
    )
    assert english.endswith(doubt)
    assert ("# It never changes.\n" in text) == (len(times) > 10)


def test_comments_of_definitions_are_remarks_on_declarations() -> None:
    text = "float64 depth  # how deep it dives [m],\tbelow  the surface\n# alone\nfloat64 x\nuint8 A=1 # a constant\n"
    text += f"{'=' * 80}\nMSG: own_msgs/Part\nstring name # what it is called\n"
    found = comments_in("own_msgs/msg/Dive", "ros2msg", text)
    assert found == {
        ("own_msgs/msg/Dive", "depth"): "how deep it dives [m], below the surface",
        ("own_msgs/msg/Part", "name"): "what it is called",
    }
    types = MessageTypes({"own_msgs/msg/Dive": Message({"depth": FieldType("float64")}, {})})
    draft = Draft([Topic("/dive", "own_msgs/msg/Dive", comments=found)], types)
    assert "decl dive /dive Dive.depth  # how deep it dives [m], below the surface\n" in draft.text("a bag")


def test_a_list_of_topics_has_values_to_be_mined(tmp_path: Path, new: Run, capsys: pytest.CaptureFixture[str]) -> None:
    bag, path, full = mcap(tmp_path / "drive.mcap", drive()), tmp_path / "props.txt", tmp_path / "full.txt"
    assert new("/odom [nav_msgs/msg/Odometry]\n", "-o", str(path)) == 0
    path.write_text(path.read_text().replace("odom_turn_limit", "# odom_turn_limit"))
    assert main(["mine", str(path), str(bag), "--write", str(full)]) == 0
    assert main(["run", str(full), str(bag)]) == 0


def test_of_several_values_of_a_message_the_first_is_called_as_its_topic_and_the_others_by_their_fields(
    new: Run, capsys: pytest.CaptureFixture[str]
) -> None:
    assert new("/pressure [sensor_msgs/msg/FluidPressure]\n") == 0
    written = with_all_that_is_offered(capsys.readouterr().out)
    assert "decl pressure /pressure FluidPressure.fluid_pressure\n" in written
    assert "decl pressure_variance /pressure FluidPressure.variance\n" in written
    assert "pressure_most: never pressure > ?" in written
    assert "pressure_variance_least: never pressure_variance < ?" in written


def test_nothing_is_said_of_stamps_beside_other_values(new: Run, capsys: pytest.CaptureFixture[str]) -> None:
    assert new("/goal [action_msgs/msg/GoalStatus]\n") == 0
    assert "stamp" not in capsys.readouterr().out


def test_what_is_measured_can_be_asked_of_all_types() -> None:
    types = MessageTypes(shipped())
    draft = Draft([Topic(f"/n{number}", type_) for number, type_ in enumerate(TYPES)], types)
    found = compiled("\n".join([draft.declarations, *(probe.property for probe in draft.probes)]))
    assert len(found.properties) == len(draft.probes) > len(TYPES)
