"""Bags: every form gives the rows that were written, and nothing that is missing or damaged passes silently."""

from __future__ import annotations

import random
import re
import sqlite3
import struct
from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bag_support import (
    FORMS,
    ODOMETRY,
    SCAN,
    STORE,
    TWIST,
    Sent,
    made,
    mcap,
    odometry,
    random_message,
    ros1,
    rosbag2,
)
from mcap.writer import IndexType, Writer
from rosbags.rosbag2 import Writer as Rosbag2  # noqa: TID251
from stepping import from_text

from ltlc.inputs.recordings import open_recording
from ltlc.inputs.recordings.bags import compressed, merging, sqlite
from ltlc.inputs.recordings.bags import mcap as mcap_storage
from ltlc.inputs.recordings.blocks import Block
from ltlc.inputs.recordings.reading import ReadOptions, Stamp
from ltlc.inputs.recordings.rows import RecordingError
from ltlc.monitoring.judging.run import Judge, RunReport
from ltlc.runtime.times import SECOND
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.expressions import Field, Signal, ValueType
from ltlc.specification.wire import SINGLES

START = 1_700_000_000 * SECOND

X = Signal("x", ValueType.NUMBER, Field("/odom", ODOMETRY, ("pose", "pose", "position", "x")))
FRAME = Signal("frame", ValueType.STRING, Field("/odom", ODOMETRY, ("header", "frame_id")))
SPEED = Signal("speed", ValueType.NUMBER, Field("/cmd", TWIST, ("linear", "x")))
RANGES = Signal("ranges", ValueType.NUMBERS, Field("/scan", SCAN, ("ranges",), SINGLES))
THIRD = Signal("third", ValueType.NUMBER, Field("/scan", SCAN, ("ranges", 2), SINGLES))
ALL = (X, FRAME, SPEED, RANGES, THIRD)

Rows = list[tuple[int, dict[str, Any], tuple[str, ...]]]


def rows(path: Path, signals: Sequence[Signal] = ALL, reading: ReadOptions | None = None) -> Rows:
    """The time of each message, its samples, and the topic of one that has no sample."""
    return list(_rows(path, signals, reading or ReadOptions()))


def _rows(path: Path, signals: Sequence[Signal], reading: ReadOptions) -> Iterator[tuple[int, dict[str, Any], Any]]:
    wanted = {signal.name: signal for signal in signals}
    for block in open_recording(path, wanted, reading).blocks():
        assert (np.diff(block.times) >= 0).all()
        assert all((np.diff(samples.rows) > 0).all() for samples in block.samples.values())
        for time, names, values, topics in block.rows(wanted):
            if names or topics:
                yield time, dict(zip(names, values, strict=True)), () if names else topics


def drive(count: int, seed: int = 0) -> list[Sent]:
    """Messages of three topics, of which some come at one time."""
    chance = random.Random(seed)
    found, time = [], START
    for _ in range(count):
        time += chance.choice((0, 1, 10_000_000, 20_000_001))
        match chance.randrange(3):
            case 0:
                found.append(odometry(time, pose__pose__position__x=chance.gauss(0, 1)))
            case 1:
                found.append(Sent("/cmd", TWIST, time, random_message(TWIST, chance)))
            case _:
                ranges = np.array([chance.random() for _ in range(chance.randrange(5))], np.float32)
                found.append(Sent("/scan", SCAN, time, made(SCAN, ranges=ranges)))
    return found


def expected(sent: Sequence[Sent]) -> Rows:
    found: Rows = []
    for each in sent:
        values: dict[str, Any] = {}
        match each.topic:
            case "/odom":
                values = {"x": each.message.pose.pose.position.x, "frame": each.message.header.frame_id}
            case "/cmd":
                values = {"speed": each.message.linear.x}
            case "/scan":
                ranges = tuple(each.message.ranges.tolist())
                values = {"ranges": ranges} | ({"third": ranges[2]} if len(ranges) > 2 else {})
            case _:
                pass
        found.append((each.time, values, ()))
    return found


def told(found: Rows, form: str) -> Rows:
    """`found`; of a bag of ROS 1 the order of messages at one time is not known."""
    return sorted(found, key=lambda row: (row[0], repr(row[1]))) if form == "ros1" else found


@pytest.mark.parametrize("form", FORMS)
def test_every_form_gives_the_rows_that_were_written(tmp_path: Path, form: str) -> None:
    sent = drive(300)
    assert told(rows(FORMS[form](tmp_path, sent)), form) == told(expected(sent), form)


@pytest.mark.parametrize("form", FORMS)
def test_an_empty_array_at_the_end_of_a_message_has_no_padding(tmp_path: Path, form: str) -> None:
    type_, numbers = "std_msgs/msg/Float64MultiArray", [[1.0], [], [2.0, 3.0], []]
    arrays = [made(type_, data=np.array(each, np.float64)) for each in numbers]
    sent = [Sent("/a", type_, START + number, array) for number, array in enumerate(arrays)]
    data = Signal("data", ValueType.NUMBERS, Field("/a", type_, ("data",)))
    found = rows(FORMS[form](tmp_path, sent), [data])
    assert [list(values["data"]) for _, values, _ in found] == numbers


@pytest.mark.parametrize("form", FORMS)
def test_topics_that_are_not_wanted_are_passed_over(tmp_path: Path, form: str) -> None:
    sent = drive(60, seed=1)
    assert rows(FORMS[form](tmp_path, sent), [SPEED]) == expected([each for each in sent if each.topic == "/cmd"])


@pytest.mark.parametrize("form", FORMS)
def test_parts_of_a_bag_are_joined_wherever_they_are_cut(
    tmp_path: Path, form: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in (sqlite, mcap_storage):
        monkeypatch.setattr(module, "ENOUGH", 500)
    monkeypatch.setattr(sqlite, "FEW", 3)
    monkeypatch.setattr(compressed, "ENOUGH", 400)
    monkeypatch.setattr(merging, "ENOUGH", 7)
    monkeypatch.setattr(merging, "MOST_BYTES", 4000)
    sent = drive(200, seed=2)
    assert told(rows(FORMS[form](tmp_path, sent)), form) == told(expected(sent), form)


def test_messages_of_a_database_are_fetched_one_by_one_where_they_are_large(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fetched, add = [], sqlite._Taken.add

    def counted(taken: Any, some: list[Any]) -> int:
        fetched.append(len(some))
        return add(taken, some)

    monkeypatch.setattr(sqlite._Taken, "add", counted)
    monkeypatch.setattr(sqlite, "ENOUGH", 500)
    sent = regular(20)
    path = FORMS["sqlite3"](tmp_path, sent)
    assert rows(path, [SPEED]) == expected([each for each in sent if each.topic == "/cmd"])
    assert max(fetched) <= 500 // len(sent[1].cdr)
    fetched.clear()
    monkeypatch.setattr(sqlite, "ENOUGH", 10)
    rows(path, [SPEED])
    assert fetched == [1] * 20


@pytest.mark.parametrize("form", FORMS)
def test_from_and_until_leave_out_the_rest(tmp_path: Path, form: str) -> None:
    sent = drive(300, seed=3)
    since, until = sent[100].time, sent[200].time
    path = FORMS[form](tmp_path, sent)
    found = [row for row in rows(path, reading=ReadOptions(since=since, until=until)) if since <= row[0] <= until]
    assert told(found, form) == told([row for row in expected(sent) if since <= row[0] <= until], form)


@pytest.mark.parametrize("form", [form for form in FORMS if "mcap" in form])
def test_chunks_that_begin_or_end_exactly_at_a_limit_are_read(tmp_path: Path, form: str) -> None:
    sent = [odometry(START + n * SECOND, pose__pose__position__x=float(n)) for n in range(40)]
    path = FORMS[form](tmp_path, sent)
    for number in range(40):
        time = sent[number].time
        found = [row for row in rows(path, [X], ReadOptions(since=time, until=time)) if row[0] == time and row[1]]
        assert found == [(time, {"x": float(number)}, ())], number


SPLIT = ["bag_0", "bag_1", "bag_9", "bag_10"]


@pytest.mark.parametrize("storage", ["db3", "mcap"])
def test_the_files_of_a_split_bag_follow_one_another_by_their_numbers(tmp_path: Path, storage: str) -> None:
    sent = drive(200, seed=4)
    folder = tmp_path / "split"
    folder.mkdir()
    for number, name in enumerate(SPLIT):
        part = sent[number * 50 : number * 50 + 50]
        if storage == "mcap":
            mcap(folder / f"{name}.mcap", part)
        else:
            (file,) = rosbag2(tmp_path / name, part).glob("*.db3")
            file.rename(folder / f"{name}.db3")
    assert rows(folder) == expected(sent)
    assert codes(folder) == ["LTL813", "LTL814"]
    metadata(folder, [f"{name}.{storage}" for name in SPLIT], {"/cmd": sum(each.topic == "/cmd" for each in sent)})
    assert "LTL813" not in codes(folder)


def metadata(folder: Path, files: Sequence[str], counts: dict[str, int]) -> None:
    topics = "".join(
        f"  - topic_metadata: {{name: {name}, type: {TWIST}, serialization_format: cdr}}\n    message_count: {count}\n"
        for name, count in counts.items()
    )
    names = "".join(f"  - {name}\n" for name in files)
    text = f"rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n{names}"
    (folder / "metadata.yaml").write_text(f"{text}  topics_with_message_count:\n{topics}")


PROPERTY = """
decl x /odom nav_msgs/Odometry.pose.pose.position.x
decl speed /cmd geometry_msgs/Twist.linear.x
near: never x > 5
slow: never speed > 1e300
"""


def judged(path: Path, text: str = PROPERTY, **options: Any) -> RunReport:
    return Judge(*from_text(text), ReadOptions(**options)).judge(path)


def codes(path: Path, **options: Any) -> list[str]:
    return [each.code for each in judged(path, **options).diagnostics]


def steps(report: RunReport) -> list[int]:
    assert report.session is not None
    return [track.steps for track in report.session.tracks]


def the_error(path: Path, text: str = PROPERTY, **options: Any) -> tuple[str, str, RunReport]:
    report = judged(path, text, **options)
    assert report.exit_code == 2
    last = report.diagnostics[-1]
    return last.code, last.message, report


def regular(count: int, first: int = START) -> list[Sent]:
    """Odometry and commands every 10 ms."""
    pairs = (
        (odometry(time, pose__pose__position__x=0.0), Sent("/cmd", TWIST, time + 1000, made(TWIST)))
        for time in range(first, first + count * 10_000_000, 10_000_000)
    )
    return [each for pair in pairs for each in pair]


@pytest.mark.parametrize("compression", ["NONE", "LZ4", "ZSTD"])
@pytest.mark.parametrize("share", [0.2, 0.7, 0.99])
def test_an_mcap_file_that_is_cut_off_is_judged_up_to_there(tmp_path: Path, compression: str, share: float) -> None:
    path = mcap(tmp_path / "a.mcap", regular(100), compression)
    data = path.read_bytes()
    path.write_bytes(data[: int(len(data) * share)])
    code, message, report = the_error(path)
    assert (code, "cut off" in message or "ends in the middle" in message) == ("LTL811", True)
    assert report.is_damaged
    assert 0 < steps(report)[0] <= 100


def test_a_file_that_is_cut_off_before_its_first_topic_is_damaged(tmp_path: Path) -> None:
    path = mcap(tmp_path / "a.mcap", regular(100))
    path.write_bytes(path.read_bytes()[:40])
    assert the_error(path)[0] == "LTL811"


@pytest.mark.parametrize("compression", ["NONE", "LZ4", "ZSTD"])
def test_a_recorder_that_was_killed_has_left_what_it_had_written(tmp_path: Path, compression: str) -> None:
    path = mcap(tmp_path / "a.mcap", regular(100), compression, is_finished=False)
    code, _, report = the_error(path)
    assert code == "LTL811"
    assert 80 < steps(report)[0] <= 100


def test_a_changed_byte_in_a_chunk_is_damage(tmp_path: Path) -> None:
    path = mcap(tmp_path / "a.mcap", regular(100))
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)
    code, message, report = the_error(path)
    assert (code, "checksum" in message) == ("LTL811", True)
    assert 30 < steps(report)[0] < 70


def test_an_index_that_leads_elsewhere_is_damage(tmp_path: Path) -> None:
    path = mcap(tmp_path / "a.mcap", regular(100), enable_crcs=False)
    data = bytearray(path.read_bytes())
    time = struct.pack("<Q", START + 50 * 10_000_000)
    found = (place.start() for place in re.finditer(re.escape(time), bytes(data)))
    place = next(place for place in found if int.from_bytes(data[place + 8 : place + 16], "little") < 4000)
    data[place : place + 8] = struct.pack("<Q", START + 50 * 10_000_000 + 1)
    path.write_bytes(data)
    code, message, report = the_error(path)
    assert (code, "does not point to its messages" in message) == ("LTL811", True)
    assert 30 < steps(report)[0] < 70


@pytest.mark.parametrize("form", ["indexed", "not indexed"])
def test_two_channels_of_one_topic_in_a_chunk_are_in_the_order_of_the_file(tmp_path: Path, form: str) -> None:
    sent = [odometry(START, pose__pose__position__x=float(number)) for number in range(20)]
    text, _ = STORE.generate_msgdef(ODOMETRY, ros_version=2)
    with (tmp_path / "a.mcap").open("wb") as file:
        writer = Writer(file, index_types=IndexType.ALL if form == "indexed" else IndexType.CHUNK)
        writer.start("ros2")
        schema = writer.register_schema(ODOMETRY, "ros2msg", text.encode())
        channels = [writer.register_channel("/odom", "cdr", schema) for _ in range(2)]
        for number, each in enumerate(sent):
            writer.add_message(channels[number % 2], each.time, each.cdr, each.time)
        writer.finish()
    assert rows(tmp_path / "a.mcap") == expected(sent)


def test_a_file_whose_index_leads_behind_its_chunks_is_read_without_it(tmp_path: Path) -> None:
    sent = drive(300)
    path = mcap(tmp_path / "a.mcap", sent)
    data = bytearray(path.read_bytes())
    (summary,) = struct.unpack_from("<Q", data, len(data) - 8 - 20)
    place = summary
    while data[place] != 8:  # the first index of a chunk
        place += 9 + struct.unpack_from("<Q", data, place + 1)[0]
    struct.pack_into("<Q", data, place + 9 + 24, summary)
    path.write_bytes(data)
    assert rows(path) == expected(sent)


@pytest.mark.parametrize("share", [0.3, 0.6, 0.9])
def test_a_database_that_is_cut_off_is_judged_up_to_there(tmp_path: Path, share: float) -> None:
    (path,) = rosbag2(tmp_path / "bag", regular(300)).glob("*.db3")
    data = path.read_bytes()
    path.write_bytes(data[: int(len(data) * share)])
    code, message, report = the_error(path)
    assert (code, "malformed" in message) == ("LTL811", True)
    assert report.session is None or steps(report)[0] < 300


def test_a_database_whose_topics_are_no_text_is_an_error(tmp_path: Path) -> None:
    (path,) = rosbag2(tmp_path / "bag", regular(3)).glob("*.db3")
    with closing(sqlite3.connect(path)) as database:
        database.execute("update topics set type = x'00ff'")
        database.commit()
    code, message, _ = the_error(path)
    assert (code, "its topics are malformed" in message) == ("LTL811", True)


def test_a_database_of_which_sqlite_quotes_what_is_no_text_is_an_error(tmp_path: Path) -> None:
    (path,) = rosbag2(tmp_path / "bag", regular(3)).glob("*.db3")
    path.write_bytes(path.read_bytes().replace(b"CREATE TABLE messages", b"CREATE TABLE\x9amessages"))
    code, message, _ = the_error(path)
    assert (code, "cannot be read as a database" in message) == ("LTL811", True)


@pytest.mark.parametrize("name", ["a.mcap", "a.db3", "a.bag", "a.mcap.zstd", "a.db3.zstd"])
@pytest.mark.parametrize("content", [b"", b"nothing of the kind" * 100])
def test_what_is_no_bag_but_named_like_one_is_one_error(tmp_path: Path, name: str, content: bytes) -> None:
    (tmp_path / name).write_bytes(content)
    code, _, report = the_error(tmp_path / name)
    assert (code, len(report.diagnostics), report.session) == ("LTL811", 1, None)


@pytest.mark.parametrize("stamp", Stamp)
@pytest.mark.parametrize("number", [0, 40])
@pytest.mark.parametrize("length", [0, 3, 10, 20])
def test_a_message_that_is_not_as_defined_ends_what_is_judged(
    tmp_path: Path, number: int, stamp: Stamp, length: int
) -> None:
    folder = rosbag2(tmp_path / "bag", regular(100))
    (path,) = folder.glob("*.db3")
    with closing(sqlite3.connect(path)) as database, database:
        query = "select id from messages where topic_id = 1 limit 1 offset ?"
        (row,) = database.execute(query, (number,)).fetchone()
        database.execute("update messages set data = substr(data, 1, ?) where id = ?", (length, row))
    code, message, report = the_error(folder, stamp=stamp)
    assert (code, "`/odom`" in message, "nav_msgs/msg/Odometry" in message) == ("LTL811", True, True)
    assert (report.session is None and number == 0) or steps(report)[0] == number


@pytest.mark.parametrize("storage", ["sqlite3", "mcap"])
def test_fewer_messages_than_the_metadata_counts_are_refused(tmp_path: Path, storage: str) -> None:
    folder = rosbag2(tmp_path / "bag", regular(100), storage)
    text = (folder / "metadata.yaml").read_text()
    (folder / "metadata.yaml").write_text(text.replace("message_count: 100", "message_count: 101"))
    code, message, _ = the_error(folder)
    assert (code, message) == ("LTL812", "100 messages on `/odom` were read, but its metadata counts 101")
    assert codes(folder, since=START) == []


@pytest.mark.parametrize("storage", ["sqlite3", "mcap"])
def test_a_topic_that_only_the_metadata_has_is_refused(tmp_path: Path, storage: str) -> None:
    folder = rosbag2(tmp_path / "bag", [each for each in regular(100) if each.topic == "/cmd"], storage)
    text = (folder / "metadata.yaml").read_text()
    (folder / "metadata.yaml").write_text(text.replace("/cmd", "/odom"))
    code, message, _ = the_error(folder)
    assert (code, message) == ("LTL812", "0 messages on `/odom` were read, but its metadata counts 100")


def test_fewer_messages_than_the_index_counts_are_refused(tmp_path: Path) -> None:
    path = mcap(tmp_path / "a.mcap", regular(100))
    data = path.read_bytes()
    counts = struct.pack("<HQHQ", 1, 100, 2, 100)
    assert counts in data
    path.write_bytes(data.replace(counts, struct.pack("<HQHQ", 1, 102, 2, 100)))
    code, message, _ = the_error(path)
    assert (code, message) == ("LTL812", "100 messages on `/odom` were read, but its index counts 102")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "is not in the format of rosbag2"),
        ("a: [", "is not in the format of rosbag2"),
        ("rosbag2_bagfile_information: {}", "there is no 'relative_file_paths'"),
        (
            "rosbag2_bagfile_information: {relative_file_paths: [gone.db3], topics_with_message_count: []}",
            "lists `gone.db3`, which does not exist",
        ),
    ],
)
def test_metadata_that_cannot_be_used_is_an_error(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "metadata.yaml").write_text(text)
    code, message, _ = the_error(tmp_path)
    assert (code, words in message) == ("LTL810", True)


def test_a_file_that_the_metadata_does_not_name_is_said_to_be_unread(tmp_path: Path) -> None:
    folder = rosbag2(tmp_path / "bag", regular(10))
    mcap(folder / "other.mcap", regular(10))
    report = judged(folder)
    assert [(each.code, "`" + str(folder / "other.mcap") in each.message) for each in report.diagnostics] == [
        ("LTL813", True)
    ]


@pytest.mark.parametrize(
    ("declared", "words", "help"),
    [
        ("v /odm nav_msgs/Odometry.twist.twist.linear.x", "has no topic `/odm`", "did you mean `/odom`?"),
        ("v /elsewhere nav_msgs/Odometry.twist.twist.linear.x", "has no topic", "its topics are `/odom`, `/cmd`"),
        ("v /elsewhere geometry_msgs/Twist.linear.x", "has no topic", "its topics are `/cmd`, `/odom`"),
        ("v ~/odom nav_msgs/Odometry.twist.twist.linear.x", "has no topic", "a private topic is recorded"),
        ("v /odom nav_msgs/Path.poses[0].pose.position.x", "are `nav_msgs/msg/Odometry` in the recording", "declare"),
    ],
)
def test_a_topic_that_does_not_fit_is_a_finding_on_the_property(
    tmp_path: Path, declared: str, words: str, help: str
) -> None:
    report = judged(rosbag2(tmp_path / "bag", regular(10)), f"decl {declared}\nlow: never v > 1\n")
    (found,) = report.diagnostics
    assert (found.code, words in found.message, help in found.help) == ("LTL806", True, True)
    assert found.message.endswith("so `low` cannot start")
    assert report.exit_code == 3


def test_of_a_topic_that_is_missing_one_finding_is_reported_whatever_is_read_of_it(tmp_path: Path) -> None:
    text = "decl place /elsewhere nav_msgs/Odometry.pose.pose.position\nnear: never hypot(place.x, place.y) > 1\n"
    (found,) = judged(rosbag2(tmp_path / "bag", regular(10)), text).diagnostics
    assert found.code == "LTL806"


def with_definition(path: Path, definition: str, form: str = "ros2msg") -> Path:
    """A bag of which `/odom` is defined otherwise, its messages being what they were."""
    folder = rosbag2(path, regular(10))
    (file,) = folder.glob("*.db3")
    with closing(sqlite3.connect(file)) as database, database:
        values = (form, definition, ODOMETRY)
        query = "update message_definitions set encoding = ?, encoded_message_definition = ? where topic_type = ?"
        database.execute(query, values)
    return folder


@pytest.mark.parametrize(
    ("definition", "words"),
    [
        ("float64 y", "has no field `pose` in `nav_msgs/msg/Odometry`"),
        ("float64 pose", "has a `float64` where the specification has a message with the field `pose`"),
        ("geometry_msgs/PoseWithCovariance[2] pose", "where the specification has a message with the field `pose`"),
        ("wstring name", "has a `wstring`"),
        ("other_msgs/Thing thing", "made of `other_msgs/msg/Thing`, which neither"),
        ("float64", "whose definition in the recording cannot be read"),
    ],
)
def test_a_field_that_does_not_fit_is_a_finding_on_the_property(tmp_path: Path, definition: str, words: str) -> None:
    report = judged(with_definition(tmp_path / "bag", definition))
    (found,) = report.diagnostics
    assert (found.code, words in found.message) == ("LTL806", True)
    assert steps(report) == [0, 10]


def test_numbers_of_another_type_are_a_finding(tmp_path: Path) -> None:
    text, _ = STORE.generate_msgdef(ODOMETRY, ros_version=2)
    folder = with_definition(tmp_path / "bag", text.replace("float64 x", "float32 x"))
    (found,) = judged(folder).diagnostics
    assert "has a `float32` there, with other numbers" in found.message


def test_a_definition_that_is_missing_is_that_of_jazzy(tmp_path: Path) -> None:
    assert steps(judged(with_definition(tmp_path / "bag", ""))) == [10, 10]


def test_a_definition_in_idl_is_read(tmp_path: Path) -> None:
    text = (
        f"{'=' * 80}\nIDL: nav_msgs/msg/Odometry\nmodule nav_msgs {{ module msg {{\n  struct Odometry {{\n"
        "    std_msgs::msg::Header header;\n    string child_frame_id;\n"
        "    geometry_msgs::msg::PoseWithCovariance pose;\n    geometry_msgs::msg::TwistWithCovariance twist;\n"
        "  };\n}; };\n"
    )
    folder = with_definition(tmp_path / "bag", text, "ros2idl")
    assert steps(judged(folder)) == [10, 10]


def test_messages_of_a_package_of_ones_own_are_read_by_a_message_path(tmp_path: Path) -> None:
    package = tmp_path / "own_msgs"
    (package / "msg").mkdir(parents=True)
    (package / "msg" / "Level.msg").write_text("string name\nfloat32 level\n")
    path = tmp_path / "a.mcap"
    sent = [Sent("/level", "own_msgs/msg/Level", START + k, b"") for k in range(5)]
    write_raw(path, sent, b"\0\1\0\0\4\0\0\0ab\0" + b"\0" + struct.pack("<f", 0.5))
    signal = Signal("v", ValueType.NUMBER, Field("/level", "own_msgs/msg/Level", ("level",), SINGLES))
    reading = ReadOptions(message_paths=(str(package),))
    assert [row[1] for row in rows(path, [signal], reading)] == [{"v": 0.5}] * 5
    assert "neither the recording nor ROS 2 Jazzy" in open_recording(path, {"v": signal}).absence("v")


def write_raw(path: Path, sent: Sequence[Sent], data: bytes, serialization: str = "cdr") -> None:
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start("ros2")
        schema = writer.register_schema(sent[0].type, "", b"")
        channel = writer.register_channel(sent[0].topic, serialization, schema)
        for each in sent:
            writer.add_message(channel, each.time, data, each.time)
        writer.finish()


def test_a_message_in_which_a_path_leads_nowhere_is_one_without_a_sample(tmp_path: Path) -> None:
    sent = [Sent("/scan", SCAN, START + k, made(SCAN, ranges=np.zeros(k, np.float32))) for k in range(5)]
    found = rows(rosbag2(tmp_path / "bag", sent), [THIRD])
    assert [(values, topics) for _, values, topics in found] == [({}, ("/scan",))] * 3 + [({"third": 0.0}, ())] * 2


def shifted(sent: Sequence[Sent], by: int) -> list[Sent]:
    return [Sent(each.topic, each.type, each.time + by, each.message) for each in sent]


@pytest.mark.parametrize("form", [form for form in FORMS if form != "ros1"])
def test_a_clock_that_is_set_back_ends_what_is_judged(tmp_path: Path, form: str) -> None:
    sent = regular(300)
    path = FORMS[form](tmp_path, [*sent, *shifted(sent, -5 * SECOND)])
    code, message, report = the_error(path)
    assert (code, "time goes back from 1700000002.99" in message) == ("LTL804", True)
    assert steps(report) == [300, 300]


@pytest.mark.parametrize("form", [form for form in FORMS if form != "ros1"])
def test_messages_that_came_late_are_taken_in_the_order_of_time_and_told(tmp_path: Path, form: str) -> None:
    sent = drive(300, seed=5)
    mixed = list(sent)
    for number in range(0, 290, 7):
        mixed[number], mixed[number + 3] = mixed[number + 3], mixed[number]
    path = FORMS[form](tmp_path, mixed)
    in_order = sorted(enumerate(mixed), key=lambda item: (item[1].time, item[0]))
    assert rows(path) == expected([each for _, each in in_order])
    assert any("came late, by at most 0.0" in each.message for each in judged(path).diagnostics)


@pytest.mark.parametrize("form", ["sqlite3 file", "mcap", "mcap without chunks"])
@pytest.mark.parametrize("seed", range(3))
def test_late_messages_are_taken_in_the_order_of_time_wherever_the_bag_is_cut(
    tmp_path: Path, form: str, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in (sqlite, mcap_storage):
        monkeypatch.setattr(module, "ENOUGH", 500)
    monkeypatch.setattr(sqlite, "FEW", 3)
    monkeypatch.setattr(compressed, "ENOUGH", 400)
    monkeypatch.setattr(merging, "ENOUGH", 7)
    monkeypatch.setattr(merging, "BETWEEN_TOPICS", SECOND // 4)
    sent = drive(300, seed)
    for number in range(0, 290, 7):
        sent[number], sent[number + 3] = sent[number + 3], sent[number]
    in_order = sorted(enumerate(sent), key=lambda item: (item[1].time, item[0]))
    path = FORMS[form](tmp_path, sent)
    assert rows(path) == expected([each for _, each in in_order])
    wanted = {signal.name: signal for signal in ALL}
    assert len([block for block in open_recording(path, wanted).blocks() if len(block.times)]) > 5


def test_a_topic_that_is_recorded_much_later_than_others_ends_what_is_judged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(merging, "ENOUGH", 7)
    monkeypatch.setattr(sqlite, "ENOUGH", 500)
    monkeypatch.setattr(sqlite, "FEW", 3)
    sent = [odometry(START + k * SECOND // 10) for k in range(300)]
    late = Sent("/cmd", TWIST, START + 2 * SECOND, made(TWIST))
    path = rosbag2(tmp_path / "bag", [*sent, late, odometry(START + 40 * SECOND)])
    code, message, report = the_error(path)
    assert (code, "to 1700000002, with a message on `/cmd`" in message) == ("LTL804", True)
    assert steps(report) == [300, 0]


def test_chunks_by_topic_are_merged_however_far_apart_they_lie(tmp_path: Path) -> None:
    sent = regular(3000)
    by_topic = sorted(sent, key=lambda each: each.topic)
    assert rows(mcap(tmp_path / "a.mcap", by_topic)) == expected(sent)


def test_rows_do_not_wait_for_earlier_ones_when_there_are_too_many_to_be_held(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sent = regular(3000)
    path = mcap(tmp_path / "a.mcap", sorted(sent, key=lambda each: each.topic))
    monkeypatch.setattr(mcap_storage, "ENOUGH", 500)
    monkeypatch.setattr(merging, "ENOUGH", 7)
    monkeypatch.setattr(merging, "MOST_BYTES", 20_000)
    code, message, report = the_error(path)
    assert (code, message[:15]) == ("LTL804", "time goes back ")
    assert "sort it first" in report.diagnostics[-1].help
    together = [odometry(START, pose__pose__position__x=float(k % 7)) for k in range(3000)]
    path = rosbag2(tmp_path / "bag", together)
    monkeypatch.setattr(compressed, "ENOUGH", 400)
    text = "decl x /odom nav_msgs/Odometry.pose.pose.position.x\nnever x > 5 and @{x, -1} > 5\nnever @{x, -2999} < 1\n"
    report = judged(path, text)
    assert steps(report) == [2999, 1]
    assert [row[1]["x"] for row in rows(path, [X])] == [float(k % 7) for k in range(3000)]


def test_messages_at_one_time_are_steps_of_their_own_and_told(tmp_path: Path) -> None:
    sent = [odometry(START, pose__pose__position__x=float(k)) for k in range(4)]
    path = rosbag2(tmp_path / "bag", sent)
    assert [row[1]["x"] for row in rows(path, [X])] == [0.0, 1.0, 2.0, 3.0]
    report = judged(path, "decl x /odom nav_msgs/Odometry.pose.pose.position.x\nnear: never x > 5\n")
    assert steps(report) == [4]
    (found,) = report.diagnostics
    assert (found.code, found.message[:10]) == ("LTL814", "3 messages")


def test_messages_at_one_time_are_one_note_with_topics_in_order(tmp_path: Path) -> None:
    sent = [Sent(f"/t{name}", TWIST, START, made(TWIST)) for name in "badc" for _ in range(2 + (name == "a"))]
    declared = "".join(f"decl {name} /t{name} Twist.linear.x\nnever {name} > 1\n" for name in "badc")
    (found,) = judged(mcap(tmp_path / "bag.mcap", sent), declared).diagnostics
    assert found.message == (
        "2 messages on `/ta`, 1 on `/tb`, 1 on `/tc`, 1 on `/td` came at the same time as the previous one: "
        "each is a step"
    )


def test_two_clocks_are_told_apart_by_a_jump_of_more_than_a_year(tmp_path: Path) -> None:
    path = rosbag2(tmp_path / "bag", [*regular(5, first=0), *regular(5)])
    code, message, report = the_error(path)
    assert (code, "time jumps from 0.040001 to 1700000000" in message) == ("LTL804", True)
    assert steps(report) == [5, 5]


def test_times_in_headers_are_those_of_rows_if_they_are_asked_for(tmp_path: Path) -> None:
    sent = [odometry(START + k * SECOND, stamp=START + k * SECOND - 300_000_000 * (k % 2)) for k in range(6)]
    path = rosbag2(tmp_path / "bag", sent)
    found = rows(path, [X], ReadOptions(stamp=Stamp.HEADER, since=START, until=START))
    assert [row[0] - START for row in found] == [k * SECOND - 300_000_000 * (k % 2) for k in range(6)]


def test_messages_without_a_stamp_are_left_out_and_told(tmp_path: Path) -> None:
    sent = [odometry(START + k, stamp=0 if k % 3 == 0 else START + k) for k in range(6)]
    path = rosbag2(tmp_path / "bag", [*sent, Sent("/cmd", TWIST, START + 7, made(TWIST))])
    report = judged(path, stamp=Stamp.HEADER)
    assert steps(report) == [4, 1]
    assert sorted(each.message for each in report.diagnostics if each.code == "LTL815") == [
        "2 messages on `/odom` were skipped: the time in their headers is 0",
        "the messages on `/cmd` have no header: the time of recording is used",
    ]


def simulated(pace: float) -> Iterator[Sent]:
    """Ten seconds of recording, with a `/clock` of that pace, and odometry."""
    for k in range(101):
        sec, nanosec = divmod(round(k * SECOND / 10 * pace), SECOND)
        message = made("rosgraph_msgs/msg/Clock", clock__sec=sec, clock__nanosec=nanosec)
        yield Sent("/clock", "rosgraph_msgs/msg/Clock", START + k * SECOND // 10, message)
        yield odometry(START + k * SECOND // 10)


@pytest.mark.parametrize("form", ["sqlite3", "sqlite3 by message", "mcap zstd", "ros1"])
@pytest.mark.parametrize(("pace", "is_reported"), [(0.5, True), (0.98, True), (0.995, False), (1, False), (10, True)])
def test_a_simulation_at_another_pace_than_its_recording_is_reported(
    tmp_path: Path, form: str, pace: float, is_reported: bool
) -> None:
    path = FORMS[form](tmp_path, list(simulated(pace)))
    found = [each.message for each in judged(path).diagnostics if each.code == "LTL817"]
    passed = f"by `/clock` {pace * 10:g} s passed while 10 s were recorded: times are those of recording"
    assert found == [passed] * is_reported
    assert not [each for each in judged(path, stamp=Stamp.HEADER).diagnostics if each.code == "LTL817"]


def test_a_time_outside_the_recording_is_an_error(tmp_path: Path) -> None:
    path = rosbag2(tmp_path / "bag", regular(5))
    assert "ends before the time of `--from`" in the_error(path, since=START + SECOND)[1]
    assert "begins after the time of `--until`" in the_error(path, until=START - SECOND)[1]


def test_a_bag_without_messages_starts_nothing(tmp_path: Path) -> None:
    folder = rosbag2(tmp_path / "bag", regular(1))
    (file,) = folder.glob("*.db3")
    with closing(sqlite3.connect(file)) as database, database:
        database.execute("delete from messages")
    text = (folder / "metadata.yaml").read_text()
    (folder / "metadata.yaml").write_text(text.replace("message_count: 1", "message_count: 0"))
    report = judged(folder)
    assert (report.exit_code, steps(report), report.diagnostics) == (3, [0, 0], ())


def test_a_name_of_a_topic_without_its_slash_is_the_same(tmp_path: Path) -> None:
    sent = [Sent("odom", ODOMETRY, each.time, each.message) for each in regular(5) if each.topic == "/odom"]
    assert len(rows(mcap(tmp_path / "a.mcap", sent), [X])) == 5


def test_messages_that_are_not_cdr_are_a_finding(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    write_raw(path, [odometry(START)], b"{}", "json")
    assert "are serialised as `json`" in open_recording(path, {"x": X}).absence("x")


def test_a_journal_that_cannot_be_taken_in_is_an_error_or_is_read(tmp_path: Path) -> None:
    """A recorder that was killed leaves messages in a journal: without it, a part would be passed over silently."""
    path = tmp_path / "a.db3"
    (whole,) = rosbag2(tmp_path / "bag", regular(50)).glob("*.db3")
    with closing(sqlite3.connect(whole)) as source:
        source.execute("pragma journal_mode = wal")
        source.execute("delete from messages where id > 60")
        source.commit()
        for end in ("", "-wal"):
            Path(f"{path}{end}").write_bytes(Path(f"{whole}{end}").read_bytes())
    report = judged(path)
    assert report.exit_code == 2 or steps(report) == [30, 30]


def what_is_told(path: Path) -> str | None:
    try:
        rows(path, [X])
    except RecordingError as error:
        return error.diagnostic.code
    return None


NOISE = ["mcap", "mcap zstd", "mcap without chunks", "sqlite3 file", "ros1"]


@pytest.mark.parametrize("form", NOISE)
def test_random_damage_is_told_or_does_no_harm(tmp_path: Path, form: str) -> None:
    chance = random.Random(form)
    sent = regular(40)
    whole = expected(sent)
    path = FORMS[form](tmp_path, sent)
    data = path.read_bytes()
    for _ in range(25):
        changed = bytearray(data)
        for _ in range(chance.choice((1, 3, 50))):
            changed[chance.randrange(len(changed))] = chance.randrange(256)
        path.write_bytes(changed[: chance.choice((len(changed), chance.randrange(len(changed))))])
        assert what_is_told(path) in (None, "LTL804", "LTL811", "LTL812", "LTL902")
    path.write_bytes(data)
    assert rows(path) == whole


def test_a_bag_of_ros_1_of_another_edition_is_named(tmp_path: Path) -> None:
    path = tmp_path / "old.bag"
    path.write_bytes(b"#ROSRECORD V1.2\n" + bytes(100))
    assert "1.2" in the_error(path)[1]


def test_a_bag_of_ros_1_that_is_cut_off_is_one_error(tmp_path: Path) -> None:
    path = ros1(tmp_path / "a.bag", regular(50))
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2])
    assert the_error(path)[0] == "LTL811"


ENTRIES = {"a": "status[0].level", "b": "header.stamp.sec"}


@pytest.mark.parametrize("more", ["", "never b > 1 and a > 3\n"])
def test_a_message_without_an_entry_is_news_of_what_it_may_have(tmp_path: Path, more: str) -> None:
    """As it is live: the first message alone has an entry, and messages go on to come."""
    array, status = (STORE.types[f"diagnostic_msgs/msg/Diagnostic{name}"] for name in ("Array", "Status"))
    stamp = STORE.types["builtin_interfaces/msg/Time"](sec=0, nanosec=0)
    header = STORE.types["std_msgs/msg/Header"](stamp=stamp, frame_id="")
    entry = status(level=1, name="", message="", hardware_id="", values=[])
    with Rosbag2(tmp_path / "bag", version=9) as writer:
        connection = writer.add_connection("/s", array.__msgtype__, typestore=STORE)
        for number in range(30):
            message = array(header=header, status=[] if number else [entry])
            writer.write(connection, number * SECOND // 10, STORE.serialize_cdr(message, array.__msgtype__))
    declared = (f"decl {name} /s diagnostic_msgs/DiagnosticArray.{path}\n" for name, path in ENTRIES.items())
    session = judged(tmp_path / "bag", f"{''.join(declared)}always age(a) <= 1 s\n{more}").session
    assert session is not None
    assert session.tracks[0].verdict is Verdict.PRESUMABLY_SATISFIED


def test_where_no_ends_are_known_no_time_is_watched() -> None:
    block = Block(np.array([-10, -5]), {}, {})
    assert list(merging.watched(iter([block]), None)) == [block]
