"""`ltlc run --guard --output`: what left guards as it was recorded, what did not pass, and why."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from bag_support import SCAN, STORE, TWIST, Sent, filled, made, mcap, rosbag2
from rosbags.highlevel import AnyReader  # noqa: TID251

from ltlc.cli import main
from ltlc.inputs.messages.definitions import shipped
from ltlc.inputs.recordings.bags.written import nested, written
from ltlc.runtime.times import SECOND

NEAR = """guard /cmd_vel_raw to /cmd_vel else stop
message stop {angular.z: 0.25}
decl speed /cmd_vel geometry_msgs/Twist.linear.x
decl scan /scan sensor_msgs/LaserScan.ranges
p: always (min(scan) < 0.5 implies eventually speed <= 0.2 within 100 ms)
q: always (new speed and min(scan) < 0.5 implies speed <= 0.2)
"""
SIDEWAYS = made(TWIST, linear__y=0.125)
FAST = made(TWIST, linear__x=1.0, angular__z=0.7)
STOP = written(TWIST, shipped(), nested({("angular", "z"): 0.25}))


def messages_in(path: Path, topic: str) -> list[tuple[int, bytes]]:
    """The messages on a topic of a bag, as bytes, with their times."""
    with AnyReader([path]) as reader:
        connections = [each for each in reader.connections if each.topic == topic]
        return [(time, bytes(data)) for _, time, data in reader.messages(connections)]


def written_output(folder: Path, recording: Path, text: str = NEAR) -> Path:
    """The file of `--output` of a guarded run."""
    (folder / "p.txt").write_text(text, encoding="utf-8")
    output = folder / "out.mcap"
    assert main(["run", "--guard", "-q", str(folder / "p.txt"), str(recording), "--output", str(output)]) == 0
    return output


@pytest.mark.parametrize("form", ["sqlite3", "zstd", "mcap"])
def test_what_left_a_guard_is_written_bit_for_bit_and_what_did_not_pass_beside_it(tmp_path: Path, form: str) -> None:
    sent = [
        Sent("/cmd_vel_raw", TWIST, 1 * SECOND, SIDEWAYS),
        Sent("/scan", SCAN, 2 * SECOND, filled(SCAN, {"ranges": [0.3]})),
        Sent("/cmd_vel_raw", TWIST, 3 * SECOND, SIDEWAYS),
        Sent("/cmd_vel_raw", TWIST, 4 * SECOND, FAST),
    ]
    path = tmp_path / "bag"
    bag = mcap(tmp_path / "bag.mcap", sent) if form == "mcap" else rosbag2(path, sent, mode=_MODES[form])
    output = written_output(tmp_path, bag)
    whole, fast = sent[0].cdr, sent[3].cdr
    assert messages_in(output, "/cmd_vel") == [(3 * SECOND, whole), (4 * SECOND, STOP)]
    assert messages_in(output, "/ltlc/guard/cmd_vel/not_passed") == [(1 * SECOND, whole), (4 * SECOND, fast)]
    actions = messages_in(output, "/ltlc/guard/cmd_vel/action")
    said = [STORE.deserialize_cdr(data, "std_msgs/msg/String").data for _, data in actions]
    assert said == ["held_back", "passed", "changed"]


_MODES = {"sqlite3": "NONE", "zstd": "MESSAGE"}


def test_the_reasons_of_a_guard_are_diagnostics(tmp_path: Path) -> None:
    sent = [
        Sent("/scan", SCAN, 1 * SECOND, filled(SCAN, {"ranges": [2.0]})),
        Sent("/cmd_vel_raw", TWIST, 2 * SECOND, FAST),
        Sent("/scan", SCAN, 3 * SECOND, filled(SCAN, {"ranges": [0.3]})),
        Sent("/scan", SCAN, 4 * SECOND, filled(SCAN, {"ranges": [0.3]})),
    ]
    output = written_output(tmp_path, rosbag2(tmp_path / "bag", sent))
    arrays = [
        STORE.deserialize_cdr(d, "diagnostic_msgs/msg/DiagnosticArray") for _, d in messages_in(output, "/diagnostics")
    ]
    found = [each.status[0] for each in arrays if each.status[0].name == "ltlc: guard of /cmd_vel"]
    assert [(each.level, each.message) for each in found] == [
        (0, "passed speed = 1.0"),
        (1, "sent by itself `stop`: ahead of a deadline of `p`"),
    ]
    assert messages_in(output, "/cmd_vel")[1] == (3 * SECOND + 90_000_000, STOP)


def test_of_a_table_what_left_a_guard_has_the_fields_that_are_read(tmp_path: Path) -> None:
    rows = [{"time": 1, "scan": [2]}, {"time": 2, "/cmd_vel_raw/linear/x": 0.5}]
    table = tmp_path / "r.jsonl"
    table.write_text("".join(f"{json.dumps(row)}\n" for row in rows), encoding="utf-8")
    half = written(TWIST, shipped(), nested({("linear", "x"): 0.5}))
    assert messages_in(written_output(tmp_path, table), "/cmd_vel") == [(2 * SECOND, half)]


def test_what_left_two_guards_is_on_two_topics_with_two_types(tmp_path: Path) -> None:
    text = (
        NEAR
        + "guard /horn_raw to /horn else quiet\nmessage quiet {}\ndecl horn /horn std_msgs/Bool.data\nr: never horn\n"
    )
    sent = [
        Sent("/scan", SCAN, 1 * SECOND, filled(SCAN, {"ranges": [2.0]})),
        Sent("/cmd_vel_raw", TWIST, 2 * SECOND, FAST),
        Sent("/horn_raw", "std_msgs/msg/Bool", 3 * SECOND, made("std_msgs/msg/Bool", data=True)),
    ]
    output = written_output(tmp_path, rosbag2(tmp_path / "bag", sent), text)
    assert messages_in(output, "/cmd_vel") == [(2 * SECOND, sent[1].cdr)]
    assert messages_in(output, "/horn") == [(3 * SECOND, written("std_msgs/msg/Bool", shipped(), {}))]
    assert messages_in(output, "/ltlc/guard/horn/not_passed") == [(3 * SECOND, sent[2].cdr)]
