"""One random drive in every form of recording, judged by random specifications: all that is reported is the same."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Sequence
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from bag_support import FORMS, SCAN, TWIST, Sent, made, odometry
from effort import share_of
from stepping import from_text

from ltlc.monitoring.judging.run import run
from ltlc.runtime.times import SECOND, seconds_text

STRING, INTEGER, SINGLE = "std_msgs/msg/String", "std_msgs/msg/Int64", "std_msgs/msg/Float32"
EMPTY = "std_msgs/msg/Empty"

DECLARATIONS = """
decl x /odom nav_msgs/Odometry.pose.pose.position.x
decl v /odom nav_msgs/Odometry.twist.twist.linear.x
decl cmd /cmd geometry_msgs/Twist.linear.x
decl scan /scan sensor_msgs/LaserScan.ranges
decl mode /mode std_msgs/String.data
decl n /n std_msgs/Int64.data
decl f /f std_msgs/Float32.data
decl bump /bump std_msgs/Empty
decl twist /cmd geometry_msgs/Twist
"""

COLUMNS = {
    "x": pa.float64(),
    "v": pa.float64(),
    "cmd": pa.float64(),
    "scan": pa.list_(pa.float32()),
    "mode": pa.string(),
    "n": pa.int64(),
    "f": pa.float32(),
    "bump": pa.bool_(),
    "twist": pa.bool_(),
}

NUMBERS = (
    *("x", "v", "cmd", "f", "n", "abs(v)", "v / cmd", "min(v, 0.3)", "x + cmd * 2", "sqrt(x)"),
    *("min(scan)", "sum(scan)", "len(scan)", "count(scan < 0.5)", "scan[0]", "scan[2]", "scan[-1]", "min(scan[0:2])"),
    *("@{v, -1}", "v - @{v, -2}", "@{cmd, -2}"),
)

ATOMS = (
    *("NUMBER RELATION THRESHOLD",) * 4,
    *("any(scan RELATION THRESHOLD)", "all(scan RELATION THRESHOLD)", 'mode == "AUTO"', 'mode != "1"'),
    *("n RELATION 9007199254740993", "v =={0.1} THRESHOLD", "f RELATION v"),
)

PREDICATES = (
    *("ATOM",) * 4,
    *("not (ATOM)", "(ATOM) and (ATOM)", "previously (ATOM)", "(once (ATOM) within DURATION)", "age(TOPIC) > DURATION"),
    *("(historically (ATOM) for DURATION)", "((ATOM) since (ATOM) within DURATION)", "age(TOPIC) <= DURATION"),
    *("new TOPIC", "((ATOM) implies new TOPIC)"),
)

PROPERTIES = (
    *("never P", "eventually P", "until P, always P", "initially P", "eventually P within DURATION"),
    *("always (P implies eventually P within DURATION)", "always (P implies always P for DURATION)"),
    *("after P, eventually P within DURATION", "after_until P, P, (eventually P within DURATION)"),
    *("after_until P, P, never v > @{v, opening}", "after_until P, P, always P", "within DURATION, (always P)"),
)

WORDS = {
    "P": tuple(f"({each})" for each in PREDICATES),
    "ATOM": ATOMS,
    "NUMBER": NUMBERS,
    "RELATION": ("<", "<=", ">", ">=", "==", "!="),
    "THRESHOLD": ("0", "0.1", "0.3", "0.5", "1", "1.5", "-1"),
    "DURATION": ("1 us", "10 ms", "100 ms", "300 ms", "1 s"),
    "TOPIC": ("x", "cmd", "scan", "mode", "bump", "bump", "twist"),
}


def specification(chance: Random) -> tuple[Any, Any, str]:
    """A specification that is accepted, compiled, and its text."""
    while True:
        settings = chance.choice(("", "", "_rate_ = 7\n", "_rate_ = 100\n")) + chance.choice(
            ("", "", "_timeout_ = 1.5\n")
        )
        lines = [f"p{number}: {written(chance.choice(PROPERTIES), chance)}\n" for number in range(chance.randint(1, 4))]
        text = DECLARATIONS + settings + "".join(lines)
        try:
            return *from_text(text), text
        except AssertionError:
            continue


def written(form: str, chance: Random) -> str:
    """`form` with something in the place of each of the words."""
    for word, choices in WORDS.items():
        while word in form.replace('"AUTO"', ""):
            form = form.replace(word, chance.choice(choices), 1)
    return form


def drive(chance: Random) -> list[Sent]:
    """Messages of seven topics, some with NaN, infinite values, gaps or arrays of other lengths; no two at one time."""
    found, time, x = [], chance.choice((0, 1_700_000_000 * SECOND)), 0.0
    some = (0.0, -0.0, 0.1, 0.3, 0.5, 1.0, 1.5, -1.0, *chance.choice(((), (math.nan, math.inf, -math.inf))))
    for _ in range(chance.randint(3, 250)):
        time += chance.choice(
            (1000, 10_000_000, 33_333_333, 100_000_001, *((450_000_000,) if chance.random() < 0.2 else ()))
        )
        value = chance.choice((*some, chance.uniform(-2, 3)))
        match chance.randrange(8):
            case 0:
                found.append(Sent("/cmd", TWIST, time, made(TWIST, linear__x=value)))
            case 1:
                ranges = [chance.choice(some) for _ in range(chance.choice((1, 3, 3, 3, 8)))]
                found.append(Sent("/scan", SCAN, time, made(SCAN, ranges=np.array(ranges, np.float32))))
            case 2:
                found.append(
                    Sent("/mode", STRING, time, made(STRING, data=chance.choice(("AUTO", "1", "nan", 'a, "b"\n'))))
                )
            case 3:
                found.append(
                    Sent("/n", INTEGER, time, made(INTEGER, data=chance.choice((0, 2**53, 2**53 + 1, -(2**63)))))
                )
            case 4:
                found.append(Sent("/f", SINGLE, time, made(SINGLE, data=float(np.float32(value)))))
            case 5:
                found.append(Sent("/bump", EMPTY, time, made(EMPTY)))
            case _:
                x += value / 3 if math.isfinite(value) else 0
                found.append(odometry(time, pose__pose__position__x=x, twist__twist__linear__x=value))
    return found


def samples(sent: Sent) -> dict[str, Any]:
    """What a row of a table has of a message."""
    message = sent.message
    match sent.topic:
        case "/odom":
            return {"x": message.pose.pose.position.x, "v": message.twist.twist.linear.x}
        case "/cmd":
            return {"cmd": message.linear.x, "twist": True}
        case "/bump":
            return {"bump": True}
        case "/scan":
            return {"scan": [float(each) for each in message.ranges]}
        case _:
            return {sent.topic[1:]: message.data}


def as_csv(path: Path, sent: Sequence[Sent]) -> Path:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["time", *COLUMNS])
        for each in sent:
            row = {name: json.dumps(of) if isinstance(of, list) else of for name, of in samples(each).items()}
            writer.writerow([seconds_text(each.time), *(row.get(name, "") for name in COLUMNS)])
    return path


def as_json_lines(path: Path, sent: Sequence[Sent]) -> Path:
    lines = (f'{{"time": {seconds_text(each.time)}, {json.dumps(samples(each))[1:]}\n' for each in sent)
    path.write_text("".join(lines))
    return path


def as_parquet(path: Path, sent: Sequence[Sent]) -> Path:
    rows = [samples(each) for each in sent]
    columns = {name: pa.array([row.get(name) for row in rows], type_) for name, type_ in COLUMNS.items()}
    pq.write_table(pa.table({"time": [each.time for each in sent], **columns}), path, row_group_size=50)
    return path


@pytest.mark.parametrize("seed", range(share_of(60)))
def test_a_drive_is_judged_alike_in_every_form(tmp_path: Path, seed: int) -> None:
    chance = Random(seed)
    compiled, specified, text = specification(chance)
    sent, keep_verdicts = drive(chance), chance.random() < 0.5
    paths = [as_csv(tmp_path / "a.csv", sent), as_json_lines(tmp_path / "a.jsonl", sent)]
    paths.append(as_parquet(tmp_path / "a.parquet", sent))
    for form in (
        "ros1",
        "sqlite3",
        *chance.sample(["mcap", "mcap zstd", "mcap without summary", "mcap folder by file"], 1),
    ):
        folder = tmp_path / form
        folder.mkdir()
        paths.append(FORMS[form](folder, sent))
    first, *others = (outcome(compiled, specified, path, keep_verdicts) for path in paths)
    for path, other in zip(paths[1:], others, strict=True):
        assert other == first, f"{path} {text}"


def outcome(compiled: Any, specified: Any, path: Path, keep_verdicts: bool) -> Any:
    """What is reported of the recording, but its name, and what is said of columns and topics."""
    document = json.loads(run(compiled, specified, path, keep_verdicts).json())
    for each in document["properties"]:  # JSON lines have no column of a silent topic, a bag has the topic
        each["waiting_for"] = len(each.get("waiting_for") or ())
    of_the_file = ("recording", "definitions", "diagnostics", "provenance")
    return {name: value for name, value in document.items() if name not in of_the_file}
