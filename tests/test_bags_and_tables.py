"""One drive, recorded as a table and as bags of every form: the verdicts are the same, and so are their times."""

from __future__ import annotations

import csv
import json
import random
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from bag_support import FORMS, SCAN, TWIST, Sent, made, odometry
from stepping import from_text

from ltlc.cli import main
from ltlc.monitoring.judging.run import run
from ltlc.runtime.times import SECOND, seconds_text

TEXT = """
decl x /odom nav_msgs/Odometry.pose.pose.position.x
decl v /odom nav_msgs/Odometry.twist.twist.linear.x
decl cmd /cmd geometry_msgs/Twist.linear.x
slow: never v > 1.5
stops: always (cmd == 0 implies eventually v < 0.1 within 300 ms)
zone: after_until x > 5, x > 8, eventually v < 0.5
jerk: never v - @{v, -2} > 0.9
alive: always age(cmd) <= 400 ms
answers: always (new cmd implies eventually new v within 150 ms)
"""


@cache
def compiled() -> tuple[Any, Any]:
    return from_text(TEXT)


def drive(seed: int) -> list[Sent]:
    chance = random.Random(seed)
    found, time, x = [], 1_700_000_000 * SECOND, 0.0
    for _ in range(chance.randint(5, 250)):
        time += chance.choice((10_000_000, 33_333_333, 100_000_001, 450_000_000 if seed % 4 == 0 else 1_000))
        if chance.random() < 0.5:
            found.append(
                Sent("/cmd", TWIST, time, made(TWIST, linear__x=chance.choice((0.0 if seed % 2 else 0.5, 1.0))))
            )
        else:
            v = chance.choice((0.0, 0.05, 0.4, 0.8, *((1.2, 1.4, 1.6) if seed % 3 == 0 else ())))
            x += v / 10
            found.append(odometry(time, pose__pose__position__x=x, twist__twist__linear__x=v))
    return found


def table(path: Path, sent: Sequence[Sent]) -> Path:
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["time", "x", "v", "cmd"])
        for each in sent:
            time = seconds_text(each.time)
            if each.topic == "/cmd":
                writer.writerow([time, "", "", repr(each.message.linear.x)])
            else:
                x, v = each.message.pose.pose.position.x, each.message.twist.twist.linear.x
                writer.writerow([time, repr(x), repr(v), ""])
    return path


def outcome(path: Path, judged_by: tuple[Any, Any] | None = None) -> Any:
    """All that is reported, but the name and digest of the recording, and who defines its messages."""
    document = json.loads(run(*(judged_by or compiled()), path, keep_verdicts=True).json())
    return {name: value for name, value in document.items() if name not in ("recording", "definitions", "provenance")}


@pytest.mark.parametrize("seed", range(len(FORMS)))
def test_a_bag_has_the_verdicts_of_the_table(tmp_path: Path, seed: int) -> None:
    sent = drive(seed)
    form = list(FORMS)[seed]
    assert outcome(FORMS[form](tmp_path, sent)) == outcome(table(tmp_path / "drive.csv", sent)), form


WATCHDOG = """
decl cmd /cmd geometry_msgs/Twist.linear.x
alive: always age(cmd) <= 100 ms
"""


@pytest.mark.parametrize("form", FORMS)
def test_a_watchdog_lives_as_long_as_the_recording_whoever_reads_the_other_topics(tmp_path: Path, form: str) -> None:
    start = 1_700_000_000 * SECOND
    odometer = [odometry(start + n * SECOND // 10) for n in range(20)]
    commands = [Sent("/cmd", TWIST, start + n * SECOND // 20 + 1, made(TWIST)) for n in range(20)]
    sent = sorted([*odometer, *commands], key=lambda each: each.time)
    compiled = from_text(WATCHDOG)
    path, as_table = FORMS[form](tmp_path, sent), table(tmp_path / "drive.csv", sent)
    (verdict,) = run(*compiled, path).document()["properties"]
    assert verdict["decided_at"]["time_ns"] == start + 19 * SECOND // 20 + 1 + SECOND // 10 + 1
    assert [verdict] == run(*compiled, as_table).document()["properties"]


@pytest.mark.parametrize("form", ["sqlite3", "mcap", "mcap without summary", "ros1"])
def test_of_a_part_of_a_bag_a_watchdog_watches_all(tmp_path: Path, form: str) -> None:
    start = 1_700_000_000 * SECOND
    path = FORMS[form](tmp_path, [odometry(start + n * SECOND // 10) for n in range(20)])
    (verdict,) = run(*from_text(WATCHDOG), path, since=start + SECOND).document()["properties"]
    assert verdict["decided_at"]["time_ns"] == start + SECOND + SECOND // 10 + 1


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("since", [1, 2, 5, 6])
def test_a_run_begins_at_the_time_that_is_asked_for_also_inside_a_chunk(tmp_path: Path, form: str, since: int) -> None:
    commands = [Sent("/cmd", TWIST, n * SECOND, made(TWIST)) for n in (0, 1, 5, 8)]
    path = FORMS[form](tmp_path, commands)
    compiled = from_text("decl cmd /cmd geometry_msgs/Twist.linear.x\nalive: always age(cmd) <= 2 s\n")
    (verdict,) = run(*compiled, path, since=since * SECOND).document()["properties"]
    expected = {1: 3, 2: 4, 5: 7, 6: None}[since]
    if expected is None:
        assert verdict["decided_at"] is None
    else:
        assert verdict["decided_at"]["time_ns"] == expected * SECOND + 1


@pytest.mark.parametrize("rate", ["", "_rate_ = 10\n"])
def test_a_message_whose_array_is_too_short_is_a_message_in_tables_too(tmp_path: Path, rate: str) -> None:
    compiled = from_text(
        f"decl third /scan sensor_msgs/LaserScan.ranges[2]\n{rate}never third > 1 or age(third) > 100 ms"
    )
    arrays = [(0.5,), (0.5,), (0.5, 0.5, 0.5), (0.5,), (0.5, 0.5, 2.0)]
    sent = [
        Sent("/scan", SCAN, n * SECOND // 4, made(SCAN, ranges=np.array(a, np.float32))) for n, a in enumerate(arrays)
    ]
    lines = [(each.time / SECOND, list(array)) for each, array in zip(sent, arrays, strict=True)]
    (tmp_path / "a.csv").write_text("time,/scan/ranges\n" + "".join(f'{t},"{a}"\n' for t, a in lines))
    (tmp_path / "a.jsonl").write_text("".join(json.dumps({"time": t, "/scan/ranges": a}) + "\n" for t, a in lines))
    pq.write_table(
        pa.table({"time": [t for t, _ in lines], "/scan/ranges": [a for _, a in lines]}), tmp_path / "a.parquet"
    )
    bag = outcome(FORMS["mcap"](tmp_path, sent), compiled)
    for name in ("a.csv", "a.jsonl", "a.parquet"):
        assert outcome(tmp_path / name, compiled) == bag, name


def test_ticks_before_the_first_sample_are_counted_by_columns_too(tmp_path: Path) -> None:
    compiled = from_text("decl third /scan sensor_msgs/LaserScan.ranges[2]\n_rate_ = 10\nnever third > 1")
    ranges = [np.zeros(3 if n > 10 else 1, np.float32) for n in range(20)]
    sent = [Sent("/scan", SCAN, n * SECOND // 4, made(SCAN, ranges=each)) for n, each in enumerate(ranges)]
    path = FORMS["mcap"](tmp_path, sent)
    by_columns, by_rows = (run(*compiled, path, keep_verdicts=slow).document()["steps"] for slow in (False, True))
    assert by_columns == by_rows == 48


def test_a_bag_of_ros_1_ends_with_its_last_message(tmp_path: Path) -> None:
    path = FORMS["ros1"](tmp_path, [Sent("/cmd", TWIST, 0, made(TWIST)), odometry(SECOND)])
    compiled = from_text("decl cmd /cmd geometry_msgs/Twist.linear.x\neventually cmd > 1 within 3 s")
    (found,) = run(*compiled, path).document()["properties"]
    assert found["left_ns"] == 2 * SECOND


def test_a_topic_that_is_not_in_the_bag_is_silent_to_its_watchdog(tmp_path: Path) -> None:
    path = FORMS["mcap"](tmp_path, [odometry(n * SECOND) for n in range(20)])
    found = run(*from_text(WATCHDOG), path)
    assert found.exit_code == 1
    assert [each.message for each in found.diagnostics] == [
        "the recording has no topic `/cmd`, so `alive` treats it as silent"
    ]


def test_a_topic_of_another_clock_that_nobody_reads_begins_nothing(tmp_path: Path) -> None:
    start = 1_700_000_000 * SECOND
    commands = [Sent("/cmd", TWIST, start + n * SECOND // 20, made(TWIST)) for n in range(20)]
    path = FORMS["mcap"](tmp_path, [odometry(0), *commands])
    assert run(*from_text(WATCHDOG), path).exit_code == 0


def test_the_drives_show_more_than_one_verdict_of_each_property(tmp_path: Path) -> None:
    """Else it would say little that they are equal."""
    found: dict[str, set[str]] = {}
    for seed in range(8):
        for each in outcome(table(tmp_path / f"{seed}.csv", drive(seed)))["properties"]:
            found.setdefault(each["label"], set()).add(each["verdict"])
    assert sum(len(verdicts) > 1 for verdicts in found.values()) >= 4


WINDOWS = [
    ("102", "102", 0, [1], ""),  # one instant, with a row
    ("102.5", "102.5", 3, [0], ""),  # one without
    ("102.3", "102.6", 3, [0], ""),
    ("103", "102", 2, [], "`--from`, 103 s, is after `--until`, 102 s"),
    ("105", "105", 2, [], "the recording ends before the time of `--from`: it begins at 100 s and lasts 4 s\n"),
    ("98", "99", 2, [], "the recording begins after the time of `--until`: it begins at 100 s\n"),
]


@pytest.mark.parametrize("form", ["csv", "jsonl", "parquet", "mcap", "mcap without chunks", "sqlite3", "ros1"])
def test_a_short_or_empty_window_of_time_is_the_same_in_every_form(
    form: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    times, values = [100.0 + k for k in range(5)], [float(k) for k in range(5)]
    path, rows = tmp_path / f"a.{form}", list(zip(times, values, strict=True))
    match form:
        case "csv":
            path.write_text("time,x\n" + "".join(f"{time},{value}\n" for time, value in rows))
        case "jsonl":
            path.write_text("".join(json.dumps({"time": time, "x": value}) + "\n" for time, value in rows))
        case "parquet":
            pq.write_table(pa.table({"time": times, "x": values}), path)
        case _:
            sent = [odometry(int(time) * SECOND, pose__pose__position__x=value) for time, value in rows]
            path = FORMS[form](tmp_path, sent)
    (tmp_path / "p.txt").write_text("decl x /odom Odometry.pose.pose.position.x\nnever x > 100\n")
    for since, until, code, steps, said in WINDOWS:
        window = ["--from", since, "--until", until]
        assert main(["run", str(tmp_path / "p.txt"), str(path), "--format", "json", *window]) == code
        shown = capsys.readouterr()
        assert [each["steps"] for each in json.loads(shown.out)["properties"] or ()] == steps
        assert said in shown.err
