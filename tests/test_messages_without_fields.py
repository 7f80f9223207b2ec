"""A declaration without a path names messages that say nothing but that they came: `new`, `age`, and nothing else."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from bag_support import FORMS, Sent, made, odometry
from language_support import codes_of, findings, only_property
from stepping import emitted, from_text
from test_mining import mined

import ltlc
from ltlc.backends.ros2 import emit
from ltlc.cli import main
from ltlc.monitoring.judging.run import run
from ltlc.runtime.times import SECOND

EMPTY, CLOUD = "std_msgs/msg/Empty", "sensor_msgs/msg/PointCloud2"
DECLARED = """decl bump /bumper std_msgs/Empty
decl speed /odom Odometry.twist.twist.linear.x
model robot: cloud /points PointCloud2 ;
"""
PROPERTIES = """stops: always (new bump implies eventually abs(speed) < 0.01 within 500 ms)
alive: always age(bump) <= 2 s
sees: always age(robot.cloud) <= 1 s
"""
TEXT = DECLARED + PROPERTIES
VERDICTS = {"stops": ("violated", 3.500000001), "alive": ("violated", 2.500000001), "sees": ("violated", 1.700000001)}
"""Of a bump at 0.5 s and 3 s, a cloud at 0.5 s and 0.7 s, and a robot that stood at 0.7 s only."""

CSV = "time,bump,speed,robot.cloud\n0,,1,\n0.5,true,1,1\n0.7,false,0,true\n3,1,1,0\n4,,1,\n"
ROWS: list[dict[str, Any]] = [
    {"time": 0, "speed": 1},
    {"time": 0.5, "bump": True, "speed": 1, "robot.cloud": True},
    {"time": 0.7, "bump": False, "speed": 0, "robot.cloud": True},
    {"time": 3, "bump": True, "speed": 1, "robot.cloud": False},
    {"time": 4, "bump": None, "speed": 1},
]


def judged(path: Path, text: str = TEXT) -> dict[str, tuple[str, float | None]]:
    """The verdict on each property, and when it was decided."""
    document = json.loads(run(*from_text(text), path, False).json())
    return {each["label"]: (each["verdict"], (each["decided_at"] or {}).get("time")) for each in document["properties"]}


def sent() -> list[Sent]:
    bumps = [Sent("/bumper", EMPTY, round(t * SECOND), made(EMPTY)) for t in (0.5, 3)]
    clouds = [Sent("/points", CLOUD, round(t * SECOND), made(CLOUD, height=1)) for t in (0.5, 0.7)]
    odometer = [
        odometry(round(t * SECOND), twist__twist__linear__x=v) for t, v in ((0, 1.0), (0.7, 0.0), (3, 1), (4, 1))
    ]
    return sorted([*odometer, *bumps, *clouds], key=lambda each: each.time)


@pytest.mark.parametrize("form", FORMS)
def test_messages_in_bags_are_heard(form: str, tmp_path: Path) -> None:
    assert judged(FORMS[form](tmp_path, sent())) == VERDICTS


def test_in_tables_true_is_a_message_and_false_null_and_nothing_are_none(tmp_path: Path) -> None:
    table, lines, parquet = tmp_path / "a.csv", tmp_path / "a.jsonl", tmp_path / "a.parquet"
    table.write_text(CSV)
    lines.write_text("".join(json.dumps(row) + "\n" for row in ROWS))
    columns = {name: [row.get(name) for row in ROWS] for name in ROWS[1]}
    pq.write_table(pa.table(columns), parquet)
    assert [judged(path) for path in (table, lines, parquet)] == [VERDICTS] * 3


def test_a_column_may_be_headed_by_the_topic(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(CSV.replace("bump", "/bumper").replace("robot.cloud", "/points"))
    assert judged(path) == VERDICTS


def test_a_cell_that_is_no_boolean_is_an_error(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("time,bump\n0,2\n")
    report = run(*from_text("decl bump /bumper std_msgs/Empty\nnever new bump\n"), path, False)
    assert [each.code for each in report.diagnostics] == ["LTL803"]


def test_rows_given_to_a_monitor_are_read_like_tables() -> None:
    live = ltlc.monitor(TEXT)
    for row in ROWS:
        live.step(row)
    final = live.finish()
    decided = {label: each.decided and each.decided.time / SECOND for label, each in final.items()}
    assert {label: (each.verdict.value, decided[label]) for label, each in final.items()} == VERDICTS


def test_a_node_takes_nothing_from_the_message() -> None:
    text = emit(*from_text(TEXT))
    assert 'Topic("/bumper", "std_msgs/msg/Empty", read_bumper, ((),)),' in text
    assert 'Fields of /bumper, std_msgs/msg/Empty."""\n    return (True,)\n' in text


@pytest.mark.parametrize("target", ["ros2", "ament", "c", "rust"])
def test_what_is_built_is_replayed(target: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    specification = tmp_path / "props.txt"
    specification.write_text(TEXT)
    output = tmp_path / {"ros2": "monitor.py", "ament": "package", "c": "monitor.c", "rust": "monitor.rs"}[target]
    assert main(["build", str(specification), "--target", target, "-o", str(output)]) == 0
    assert capsys.readouterr().out.count("read back") == 3


def test_emitted_python_asks_for_news_alone() -> None:
    compiled, _ = from_text(
        "decl bump /bumper std_msgs/Empty\nonce_only: never new bump and previously once new bump\n"
    )
    monitor = emitted(compiled)["OnceOnly"](0)
    for time, new in ((0, False), (1, True), (2, False)):
        monitor.step(time, new)
    assert monitor.verdict.value == "presumably_satisfied"
    monitor.step(3, True)
    assert monitor.verdict.value == "violated"


@pytest.mark.parametrize(
    "used",
    [
        *(
            "never bump",
            "never bump > 3",
            "never @{bump, -1}",
            "never any(bump)",
            "never abs(bump) > 2",
            "never -bump > 1",
        ),
        *("never bump.x > 1", "never bump[0]", "never bump in {1, 2}", "never robot.cloud", "never new robot.cloud.x"),
        *("never age(bump.x) > 2 s", "never new bump[3]", "b = bump\nnever b", "until bump, always speed > 1"),
    ],
)
def test_a_message_without_a_field_has_no_value(used: str) -> None:
    assert set(codes_of(f"{DECLARED}{used}\n")) - {"LTL104"} == {"LTL220"}


def test_the_error_names_what_can_be_asked_and_how_a_value_is_declared() -> None:
    [found] = findings("decl cloud /points PointCloud2\nnever cloud > 2\n")
    assert str(found.help).startswith("use `new cloud` or `age(cloud)`; a value is declared with its path, as in ")
    [found] = findings("decl bump /bumper std_msgs/Empty\nnever bump\n")
    assert str(found.help) == "use `new bump` or `age(bump)`"


def test_a_type_that_is_a_value_by_itself_stays_one() -> None:
    assert codes_of("decl goal /goal geometry_msgs/Point\nnever goal.x > 2\n") == []


def test_what_ends_in_a_structure_within_a_message_is_no_value() -> None:
    assert codes_of("decl pose /odom Odometry.pose\nnever new pose\n") == ["LTL204"]


def test_such_a_signal_is_read_from_the_whole_message() -> None:
    [read] = only_property("decl bump /bumper std_msgs/Empty\nnever new bump\n").inputs()
    assert read.signal.is_message
    [read] = only_property("never new flag\n").inputs()
    assert not read.signal.is_message


def test_the_longest_silence_is_found_in_recordings(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(CSV)
    [found] = mined(tmp_path, "decl bump /bumper std_msgs/Empty\nalive: always age(bump) <= ?\n", path).findings
    assert found.trial is not None
    assert found.trial.text == "2.5 s"
