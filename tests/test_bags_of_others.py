"""Bags that others have recorded, in a folder beside the project: what is known of them, and one clear line each."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from stepping import from_text

from ltlc.base.source import Source
from ltlc.cli import main
from ltlc.frontend.language import load_text
from ltlc.inputs.recordings import open_recording
from ltlc.inputs.recordings.reading import ReadOptions
from ltlc.inputs.recordings.rows import RecordingError
from ltlc.monitoring.judging.run import RunReport, run
from ltlc.runtime.times import SECOND
from ltlc.specification.expressions import Field, Signal, ValueType
from ltlc.specification.wire import PRIMITIVES

BAGS = Path(__file__).parents[2] / "shared" / "data" / "bags"
pytestmark = pytest.mark.skipif(not BAGS.is_dir(), reason="needs recordings made by others, in ../shared/data/bags")

ODOMETRY, STRING = "nav_msgs/msg/Odometry", "std_msgs/msg/String"


def signal(topic: str, message: str, *path: str | int, base: str = "float64") -> Signal:
    kinds = {"string": ValueType.STRING, "bool": ValueType.BOOLEAN}
    numbers = {"numbers": PRIMITIVES[base]} if base in PRIMITIVES else {}
    return Signal(f"{topic}{path}", kinds.get(base, ValueType.NUMBER), Field(topic, message, path, **numbers))


def column(bag: str, wanted: Signal) -> tuple[list[int], list[object]]:
    """The times and the values of a signal."""
    times: list[int] = []
    values: list[object] = []
    for block in open_recording(BAGS / bag, {wanted.name: wanted}).blocks():
        samples = block.samples.get(wanted.name)
        if samples is not None:
            times += block.times[samples.rows].tolist()
            values += samples.listed()
    return times, values


def judged(bag: str, text: str) -> RunReport:
    return run(*from_text(text), BAGS / bag)


def steps(report: RunReport) -> list[int]:
    assert report.session is not None
    return [track.steps for track in report.session.tracks]


@pytest.mark.parametrize(
    ("topic", "count", "jumps"), [("/odom", 1288, 0), ("/odom_noisy", 1289, 1013), ("/odom_kf", 1284, 100)]
)
def test_the_odometers_of_a_turtlebot_move_as_is_known(topic: str, count: int, jumps: int) -> None:
    position = [column("tb3_kf", signal(topic, ODOMETRY, "pose", "pose", "position", axis))[1] for axis in "xy"]
    moved = np.linalg.norm(np.diff(np.array(position, float)), axis=0)
    assert (len(position[0]), int((moved > 0.05).sum())) == (count, jumps)
    if topic == "/odom":
        assert moved.max() == pytest.approx(0.0215, abs=0.0005)
        times, _ = column("tb3_kf", signal(topic, ODOMETRY, "pose", "pose", "position", "x"))
        assert max(np.diff(times)) / SECOND == pytest.approx(0.836, abs=0.0005)
    if topic == "/odom_kf":
        assert set(column("tb3_kf", signal(topic, ODOMETRY, "twist", "twist", "linear", "x"))[1]) == {0.0}


def test_a_bag_gives_the_verdict_of_its_numbers() -> None:
    report = judged(
        "tb3_kf", "decl x /odom_noisy nav_msgs/Odometry.pose.pose.position.x\ncalm: never x - @{x, -1} > 0.05\n"
    )
    assert report.exit_code == 1
    log = "decl level /rosout rcl_interfaces/Log.level\nquiet: never level == 50\n"
    assert (judged("tb3_kf", log).exit_code, steps(judged("tb3_kf", log))) == (0, [17])


def test_an_export_of_a_bag_has_its_values() -> None:
    _, found = column("tb3_kf", signal("/odom", ODOMETRY, "pose", "pose", "position", "x"))
    with (BAGS / "tb3_kf" / "odom_gt.csv").open(newline="") as file:
        exported = {float(row[4]) for row in csv.reader(file)}
    assert len(set(found) & exported) > 0.85 * len(set(found))


def test_a_drive_of_a_robot_of_jazzy_is_read() -> None:
    times, _ = column("mobrob_odom", signal("/odom", ODOMETRY, "pose", "pose", "position", "x"))
    assert len(times) == 68
    assert times[-1] - times[0] == 7664204722


@pytest.mark.parametrize("letter", "ABCDEFGH")
def test_one_recording_in_both_storages_in_five_files_is_the_same(letter: str) -> None:
    text = signal(f"/{letter * 3}", STRING, "data", base="string")
    assert column("rosbag2/mcap_wbag", text) == column("rosbag2/sqlite3_wbag", text)


def test_no_message_of_a_split_recording_is_missing() -> None:
    topics = [signal(f"/{letter * 3}", STRING, "data", base="string") for letter in "ABCDEFGH"]
    assert sum(len(column("rosbag2/mcap_wbag", each)[0]) for each in topics) == 6074


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_a_bag_of_which_rosbags_reads_nothing_is_read(storage: str) -> None:
    times, values = column(f"rosbag2/{storage}_talker", signal("/topic", STRING, "data", base="string"))
    assert values == [f"Hello, world! {number}" for number in range(10)]
    assert times == sorted(times)


def test_a_database_whose_definition_has_only_a_part_of_the_message_is_refused() -> None:
    log = signal("/rosout", "rcl_interfaces/msg/Log", "level", base="uint8")
    assert column("rosbag2/mcap_talker", log)[1] == [20.0] * 10
    with pytest.raises(RecordingError, match="bytes longer than `rcl_interfaces/msg/Log` as the recording defines it"):
        column("rosbag2/sqlite3_talker", log)


def test_a_bag_without_messages_starts_nothing() -> None:
    report = judged("rosbag2/empty_bag", "decl level /rosout rcl_interfaces/Log.level\nquiet: never level == 50\n")
    assert (report.exit_code, steps(report), report.diagnostics) == (3, [0], ())


BASIC = """bool bool_value
byte byte_value
char char_value
float32 float32_value
float64 float64_value
int8 int8_value
uint8 uint8_value
int16 int16_value
uint16 uint16_value
int32 int32_value
uint32 uint32_value
int64 int64_value
uint64 uint64_value
"""


@pytest.mark.parametrize("base", [line.split()[0] for line in BASIC.splitlines()])
def test_all_primitive_types_and_nested_arrays_are_the_same_in_both_storages(base: str) -> None:
    for topic, message, path in (
        ("/test_topic", "test_msgs/msg/BasicTypes", (f"{base}_value",)),
        ("/array_topic", "test_msgs/msg/Arrays", (f"{base}_values", 1)),
        ("/array_topic", "test_msgs/msg/Arrays", ("basic_types_values", 2, f"{base}_value")),
    ):
        wanted = signal(topic, message, *path, base=base)
        found = [column(f"rosbag2/{storage}_cdr_test", wanted) for storage in ("mcap", "sqlite3")]
        assert found[0] == found[1]
        assert len(found[0][0]) == (3 if topic == "/test_topic" else 4)


def test_a_number_behind_all_arrays_is_where_it_should_be() -> None:
    _, values = column(
        "rosbag2/mcap_cdr_test", signal("/array_topic", "test_msgs/msg/Arrays", "alignment_check", base="int32")
    )
    assert len(values) == 4


def test_a_type_without_msg_in_its_name_is_that_type(tmp_path: Path) -> None:
    package = tmp_path / "test_msgs"
    (package / "msg").mkdir(parents=True)
    (package / "msg" / "BasicTypes.msg").write_text(f"{BASIC}string string_value\n")
    text = "decl n /topic1 test_msgs/BasicTypes.int32_value\nall: never n > 10000\n"
    specification, _ = load_text(Source("props.txt", text), [str(package)])
    assert specification is not None
    (declared,) = specification.properties[0].inputs()
    recording = open_recording(
        BAGS / "rosbag2/mcap_test_bag_for_seek", {"n": declared.signal}, ReadOptions(message_paths=(str(package),))
    )
    assert recording.columns == ("n",), recording.absence("n")
    assert sum(len(block.times) for block in recording.blocks()) == 5


def test_a_definition_that_rosbags_cannot_parse_harms_no_other_topic_and_can_be_read() -> None:
    bag = "rosbag2/mcap_bag_with_topics_and_service_events"
    for topic in ("/test_topic1", "/test_topic2"):
        wanted = signal(topic, "test_msgs/msg/Strings", "string_value_default3", base="string")
        assert column(bag, wanted)[1] == ['Hello"world!']
    event = signal(
        "/test_service1/_service_event", "test_msgs/srv/BasicTypes_Event", "info", "event_type", base="uint8"
    )
    assert len(column(bag, event)[0]) == 4


def test_a_recording_may_begin_at_time_zero() -> None:
    times, _ = column(
        "rosbag2/mcap_rewriter_b", signal("/c_strings", "test_msgs/msg/Strings", "string_value", base="string")
    )
    assert (len(times), min(times) < SECOND) == (50, True)


def the_lines(arguments: Sequence[str], capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    code = main(["run", *arguments])
    return code, capsys.readouterr().err


@pytest.mark.parametrize("name", ["laser_scan_matcher_demo.bag", "laser_scan_splitter_demo.bag"])
def test_a_broken_bag_of_ros_1_is_one_diagnostic(tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str) -> None:
    (tmp_path / "props.txt").write_text("decl r /scan sensor_msgs/LaserScan.ranges\nnear: never min(r) < 0.1\n")
    code, text = the_lines([str(tmp_path / "props.txt"), str(BAGS / "unreadable" / name)], capsys)
    assert (code, text.count("LTL811"), text.count("[LTL"), "Traceback" in text) == (2, 1, 1, False)


def test_each_message_of_an_odometer_has_an_answer_of_its_own_as_its_numbers_say() -> None:
    position = ("pose", "pose", "position", "x")
    noisy, filtered = (column("tb3_kf", signal(topic, ODOMETRY, *position)) for topic in ("/odom_noisy", "/odom_kf"))
    answers, values = np.array(filtered[0]), np.array(filtered[1], float)
    last = max(noisy[0][-1], filtered[0][-1])
    judged_ = [(t, x) for t, x in zip(noisy[0], np.array(noisy[1], float), strict=True) if t >= answers[0]]
    unanswered = [
        t
        for t, x in judged_
        if t + 3 * 10**8 < last
        and not np.any((answers >= t) & (answers <= t + 3 * 10**8) & (np.abs(values - x) < 0.05))
    ]
    x = "nav_msgs/Odometry.pose.pose.position.x"
    text = f"decl kx /odom_kf {x}\ndecl nx /odom_noisy {x}\nnear: each new nx: "
    report = judged("tb3_kf", f"{text}eventually (new kx and abs(kx - @{{nx, opening}}) < 0.05) within 300 ms\n")
    each = report.document()["properties"][0]["each"]
    assert (each["judged"], len(each["violated"])) == (len(judged_), len(unanswered))
    assert [v["opened_at"]["time_ns"] for v in each["violated"]] == unanswered
