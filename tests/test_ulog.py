"""Flight logs of PX4: every field as pyulog has it, and the same verdicts as by a bag of the same messages."""

from __future__ import annotations

import random
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from effort import share_of
from pyulog import ULog
from ulog_support import LogWriter, random_log, speeds

from ltlc.cli import main
from ltlc.inputs.messages.definitions import MessageTypes
from ltlc.inputs.messages.texts import defined
from ltlc.inputs.recordings import RecordingError
from ltlc.inputs.recordings.bags import cdr, ulog_records
from ltlc.inputs.recordings.bags.choices import Path as FieldPath
from ltlc.inputs.recordings.bags.copying import Copier
from ltlc.inputs.recordings.bags.messages import LATEST
from ltlc.inputs.recordings.bags.ulog import RECENT, ULogStorage
from ltlc.inputs.recordings.blocks import Array
from ltlc.runtime.times import SECOND

FLIGHTS = Path(__file__).parents[2] / "shared" / "data" / "ulog"
SPEED = "decl speed /wheel px4_msgs/Wheel.speed\n"
SECOND_US = 1_000_000


def judged(tmp_path: Path, text: str, log: Path, capsys: pytest.CaptureFixture[str], *more: str) -> tuple[int, str]:
    """The exit code and what is printed when `text` is judged on `log`."""
    props = tmp_path / "props.txt"
    props.write_text(text)
    code = main(["run", str(props), str(log), *more])
    printed = capsys.readouterr()
    return code, printed.out + printed.err


def leaves(types: MessageTypes, message: str) -> dict[str, FieldPath]:
    """The fields of a message down to numbers, as pyulog calls them, and as ltlc does."""
    found: dict[str, FieldPath] = {}
    for name, type_ in types.messages[message].fields.items():
        for number in [None] if type_.length is None else range(type_.length):
            at = (name,) if number is None else (name, number)
            called = name if number is None else f"{name}[{number}]"
            if type_.base in types.messages:
                found |= {f"{called}.{below}": (*at, *path) for below, path in leaves(types, type_.base).items()}
            else:
                found[called] = at
    return found


def columns(storage: ULogStorage, topic: str) -> dict[str, Any]:
    """All numbers in the messages of a topic, and their times in ns."""
    of = storage.topics[topic]
    types = MessageTypes(defined(of.type, of.form, of.definition))
    [batch] = storage.batches([topic], -LATEST, LATEST)
    messages = batch.messages[topic]
    paths = leaves(types, of.type)
    if not len(messages):
        return {}
    found = cdr.columns(types, of.type, paths.values(), messages)
    return {"": messages.times} | {name: np.asarray(found[path].values) for name, path in paths.items()}


@pytest.mark.parametrize("seed", range(share_of(60)))
def test_every_field_of_a_random_log_is_as_pyulog_reads_it(tmp_path: Path, seed: int) -> None:
    assert_as_pyulog(random_log(random.Random(seed)).save(tmp_path / "flight.ulg"))


def test_a_log_is_looked_through_once_and_again_when_it_changes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    looks, read = [], ulog_records.read

    def counting(data: Array) -> ulog_records.Log:
        looks.append(len(data))
        return read(data)

    monkeypatch.setattr(ulog_records, "read", counting)
    for last, verdict in ((1.5, "presumably satisfied"), (2.5, "violated")):
        log = speeds([(0, 1.0), (5, last)]).save(tmp_path / "flight.ulg")
        assert f": {verdict}" in judged(tmp_path, f"{SPEED}never speed > 2\n", log, capsys)[1]
    assert len(looks) == 2


@pytest.mark.skipif(not FLIGHTS.is_dir(), reason="there are no flight logs of others here")
@pytest.mark.parametrize("name", ["sample.ulg", "gps_interference.ulg"])
def test_every_field_of_a_flight_is_as_pyulog_reads_it(name: str) -> None:
    assert_as_pyulog(FLIGHTS / name)


def assert_as_pyulog(path: Path) -> None:
    storage, peer = ULogStorage(path, {}), ULog(str(path), None, False)
    begin = peer.start_timestamp * 1000
    there = {f"/fmu/out/{each.name}{f'[{each.multi_id}]' * (each.multi_id > 0)}": each.data for each in peer.data_list}
    assert {topic for topic, of in storage.topics.items() if of.count} == {*there, "/fmu/out/parameters"} & {
        *storage.topics
    }
    if storage.topics.get("/fmu/out/parameters"):
        found = columns(storage, "/fmu/out/parameters")
        del found[""]
        latest = peer.initial_parameters | {name: value for _, name, value in peer.changed_parameters}
        assert {name: values[-1] for name, values in found.items()} == latest
        assert {name: values[0] for name, values in found.items() if name in peer.initial_parameters} == (
            peer.initial_parameters
        )
    recent = [time for data in there.values() for time in data["timestamp"].astype(np.int64) * 1000]
    first = min([begin, *(time for time in recent if time >= begin - RECENT)])
    for topic, data in there.items():
        times = data["timestamp"].astype(np.int64) * 1000
        times[times < begin - RECENT] = first
        order = times.argsort(kind="stable")
        found = columns(storage, topic)
        data = {name: values for name, values in data.items() if "_padding" not in name}
        assert (found.pop("") == times[order]).all()
        assert found.keys() == data.keys()
        for name, values in data.items():
            with np.errstate(invalid="ignore"):  # a signalling NaN is one like any other
                kept = values.astype(np.float64) if found[name].dtype == np.float64 else values
            assert np.array_equal(found[name], (kept if found[name].dtype != np.bool_ else values != 0)[order], True), (
                name
            )


def test_a_log_and_a_bag_of_the_same_messages_have_the_same_verdicts(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = speeds([(k * SECOND_US // 10, k / 10) for k in range(40)]).save(tmp_path / "flight.ulg")
    bag = tmp_path / "flight.mcap"
    with Copier(log) as copier, bag.open("wb") as file:
        assert copier.copy(0, LATEST, file) == 40
    text = "decl speed /fmu/out/wheel px4_msgs/Wheel.speed\nnever speed > 2.05\nalways age(speed) <= 0.1 s\n"
    of_log, of_bag = judged(tmp_path, text, log, capsys), judged(tmp_path, text, bag, capsys)
    assert of_log == of_bag
    assert of_log[0] == 1
    assert "At +2.1 s (step 21)" in of_log[1]


def test_only_the_last_part_of_a_topic_and_the_fields_of_its_type_have_to_be_those_of_the_log(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = speeds([(0, 1.0), (5000, 3.0)]).save(tmp_path / "flight.ulg")
    text = "decl speed /drone_1/fmu/out/wheel px4_msgs/Wheel.speed\nnever speed > 2\n"
    code, printed = judged(tmp_path, text, log, capsys)
    assert (code, "At +0.005 s (step 1)" in printed) == (1, True)


def test_the_second_instance_of_a_topic_has_its_number_in_brackets(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = speeds([(0, 1.0)])
    log.subscribe("wheel", 1, instance=1)
    log.message(1, struct.pack("<Qf", 5, 9.0))
    text = "decl first /fmu/out/wheel px4_msgs/Wheel.speed\ndecl second /fmu/out/wheel[1] px4_msgs/Wheel.speed\n"
    path = log.save(tmp_path / "flight.ulg")
    code, printed = judged(tmp_path, text + "one: never first > 2\ntwo: never second > 2\n", path, capsys)
    assert code == 1
    assert "one: presumably satisfied; 1 step" in printed
    assert "two: violated" in printed


def test_a_node_cannot_subscribe_to_an_instance(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    props = tmp_path / "props.txt"
    props.write_text("decl second /fmu/out/wheel[1] std_msgs/Float64.data\nnever second > 2\n")
    for target in ("ros2", "ament"):
        assert main(["build", str(props), "--target", target, "-o", str(tmp_path / "out")]) == 1
        assert "`/fmu/out/wheel[1]`" in (said := capsys.readouterr().err)
        assert "LTL708" in said
    assert not (tmp_path / "out").exists()


def test_padding_may_be_logged_and_a_char_is_a_byte_as_in_ros(tmp_path: Path) -> None:
    log = LogWriter()
    log.format("code", "uint64_t timestamp;char[2] text;uint8_t[6] _padding0;")
    log.subscribe("code", 0)
    log.message(0, struct.pack("<Q", 1) + b"a\xff")
    log.message(0, struct.pack("<Q", 2) + b"b\xfe" + bytes(6))
    found = columns(ULogStorage(log.save(tmp_path / "flight.ulg"), {}), "/fmu/out/code")
    assert (found["text[0]"].tolist(), found["text[1]"].tolist()) == ([97, 98], [255, 254])


def test_parameters_are_a_topic_with_a_message_at_the_beginning_and_at_each_change(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = speeds([])
    log.parameter("WHEEL_MAX", 2.5)
    log.parameter("WHEEL_SIZE", 0.5)
    log.parameter("WHEEL_ON", 1)
    log.message(0, struct.pack("<Qf", 0, 2.0))
    log.message(0, struct.pack("<Qf", 10_000, 2.05))
    log.parameter("WHEEL_MAX", 2.1)
    log.message(0, struct.pack("<Qf", 20_000, 2.2))
    text = (
        f"{SPEED}decl most /fmu/out/parameters px4_msgs/Parameters.WHEEL_MAX\n"
        "decl on /parameters px4_msgs/Parameters.WHEEL_ON\np: never on == 1 and speed > most\n"
    )
    code, printed = judged(tmp_path, text, log.save(tmp_path / "flight.ulg"), capsys)
    assert code == 1
    assert "speed > most: true, 2.2 > 2.1 by 0.1" in printed
    assert "At +0.02 s (step 4)" in printed


def test_a_signalling_nan_is_a_missing_value_without_a_warning(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = speeds([(0, 1.0)])
    log.message(0, struct.pack("<Q", 10_000) + bytes.fromhex("0100a07f"))
    code, printed = judged(tmp_path, f"{SPEED}never speed > 2\n", log.save(tmp_path / "flight.ulg"), capsys)
    assert (code, printed) == (0, "line 2: presumably satisfied; 1 step; 1 step left out: a value was NaN\n")


def test_a_message_from_before_the_log_keeps_its_time_unless_it_is_old(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    begin = 10 * SECOND_US
    log = speeds([(9_500_000, 1.0), (begin, 1.0), (begin + 1000, 3.0)], begin)
    log.format("mode", "uint64_t timestamp;uint8_t state;")
    log.subscribe("mode", 1)
    log.message(1, struct.pack("<QB", 0, 7))
    text = f"{SPEED}decl state /fmu/out/mode px4_msgs/Mode.state\none: never speed > 2\ntwo: never state == 7\n"
    _, printed = judged(tmp_path, text, log.save(tmp_path / "flight.ulg"), capsys)
    assert "one: violated at +0.501 s (step 2)" in printed
    assert "two: violated at +0 s (step 0)" in printed


def test_dropouts_are_reported_with_the_longest(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = speeds([(0, 1.0), (SECOND_US, 1.0)])
    log.dropout(12)
    log.message(0, struct.pack("<Qf", 2 * SECOND_US, 1.0))
    log.dropout(30)
    log.dropout(5)
    code, printed = judged(tmp_path, f"{SPEED}never speed > 2\n", log.save(tmp_path / "flight.ulg"), capsys)
    assert code == 0
    assert "messages are missing in the log: 3 dropouts, 0.047 s in all, the longest of 0.03 s" in printed
    assert "that one was at 2 s" in printed


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        (b"\x0e\x00D\x00\x00\x01", "its last message is cut off"),
        (b"\x01", "its last message is cut off"),
        (b"\x01\x00\xfe\x00", "there is no message at byte"),
        (b"\x01\x00D\x00", "there is no message at byte"),
        (b"\x03\x00D\x00\x00\x00", "is not in the format of its topic"),
        (b"\x03\x00D\x09\x00\x00", "is not in the format of its topic"),
    ],
    ids=["cut", "cut head", "unknown kind", "no topic", "too short", "unknown topic"],
)
def test_a_damaged_log_is_judged_up_to_the_damage(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], damage: bytes, said: str
) -> None:
    log = speeds([(0, 1.0), (SECOND_US, 3.0)])
    log.data += damage
    if not said.startswith("its last"):
        log.message(0, struct.pack("<Qf", 2 * SECOND_US, 1.0))
    code, printed = judged(tmp_path, f"{SPEED}never speed > 2\n", log.save(tmp_path / "flight.ulg"), capsys)
    assert code == 2
    assert said in printed
    assert "violated at +1 s (step 1); 2 steps" in printed


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda log: log.add("F", b"b:float x"), "the format `b` has no field `timestamp`"),
        (lambda log: log.add("F", b"b:c x;"), "the format `c` is not defined"),
        (
            lambda log: log.add("F", b"b:b[2] x;uint64_t timestamp;"),
            "the format `b` is not defined, or contains itself",
        ),
        (lambda log: log.add("F", b"b:uint64_t timestamp;float[60000] x;"), "no message can be in the format `b`"),
        (lambda log: log.add("F", b"b:uint64_t timestamp;float[0] x;"), "is malformed"),
        (lambda log: log.add("F", b"b:uint64_t timestamp;float-x;"), "is malformed"),
        (lambda log: log.add("F", b"b:\xff x;"), "is malformed"),
        (lambda log: log.add("A", b"\0"), "is malformed"),
        (lambda log: log.add("P", b""), "is malformed"),
    ],
)
def test_what_is_wrong_with_the_definitions_of_a_log_is_reported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], make: Any, said: str
) -> None:
    log = speeds([(0, 1.0)])
    make(log)
    log.subscribe("b", 7)
    code, printed = judged(tmp_path, f"{SPEED}never speed > 2\n", log.save(tmp_path / "flight.ulg"), capsys)
    assert code == 2
    assert f"definitions of messages: {tmp_path / 'flight.ulg'} cannot be read" in printed
    assert said in printed


def test_what_is_not_a_log_or_has_unknown_features_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "flight.ulg"
    path.write_bytes(b"#ROSBAG V2.0\n and more")
    with pytest.raises(RecordingError, match="does not begin as one"):
        ULogStorage(path, {})
    log = LogWriter()
    log.flags(unknown=1)
    with pytest.raises(RecordingError, match="features that are not known"):
        ULogStorage(log.save(path), {})


def test_evidence_says_that_it_does_not_cover_flight_logs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = speeds([(0, 1.0)]).save(tmp_path / "flight.ulg")
    evidence = tmp_path / "flight.evidence"
    code, printed = judged(tmp_path, f"{SPEED}never speed > 2\n", log, capsys, "--evidence", str(evidence))
    assert code == 0
    assert "LTL851" in printed
    assert "does not read flight logs" in printed
    assert "verdict" not in evidence.read_text()


def test_data_that_were_appended_after_a_crash_are_read_and_what_was_cut_off_before_them_is_left(
    tmp_path: Path,
) -> None:
    samples = [(0, 1.0), (SECOND_US, 3.0)]
    log = LogWriter()
    log.flags(appended=[0])
    log.data += speeds(samples).data[16:]
    log.data += b"\x0e\x00D\x00\x00\x01"
    at = len(log.data)
    log.data[16 + 3 + 16 : 16 + 3 + 24] = struct.pack("<Q", at)
    log.data[16 + 3 + 8] = 1
    log.message(0, struct.pack("<Qf", 2 * SECOND_US, 5.0))
    found = columns(ULogStorage(log.save(tmp_path / "flight.ulg"), {}), "/fmu/out/wheel")
    assert found["speed"].tolist() == [1.0, 3.0, 5.0]
    assert found[""].tolist() == [0, SECOND, 2 * SECOND]


def test_a_start_from_a_log_passes_on_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = speeds([(k * 100_000, (k % 7) / 2) for k in range(100)]).save(tmp_path / "flight.ulg")
    props = tmp_path / "start.txt"
    assert main(["new", str(log), "-o", str(props)]) == 0
    text = props.read_text()
    assert "decl wheel_speed /fmu/out/wheel Wheel.speed" in " ".join(text.split())
    capsys.readouterr()
    assert main(["run", str(props), str(log)]) == 0


@pytest.mark.skipif(not FLIGHTS.is_dir(), reason="there are no flight logs of others here")
def test_the_loss_of_gps_is_found_when_it_happened(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (
        "decl eph /fmu/out/vehicle_gps_position px4_msgs/SensorGps.eph\n"
        "always (eph > 10 implies eventually eph <= 10 within 2 s)\n"
    )
    code, printed = judged(tmp_path, text, FLIGHTS / "gps_interference.ulg", capsys, "--format", "json")
    assert code == 1
    assert '"time": 276.594637001' in printed
