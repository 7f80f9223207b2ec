"""Recordings as files, in every format that `ltlc run` reads."""

from __future__ import annotations

import csv
import io
import json
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from benchmarks.differential.samples import Recording, Row
from benchmarks.differential.targets import Monitors
from ltlc.specification.expressions import Field

sys.path.append(str(Path(__file__).parents[2] / "tests"))

from bag_support import FORMS, Sent, made

TYPES = {
    **dict.fromkeys(("/v", "/w"), "std_msgs/msg/Float64"),
    **dict.fromkeys(("/f", "/g"), "std_msgs/msg/Float32"),
    "/small": "std_msgs/msg/Int8",
    "/byte": "std_msgs/msg/UInt8",
    "/i": "std_msgs/msg/Int64",
    "/u": "std_msgs/msg/UInt64",
    "/flag": "std_msgs/msg/Bool",
    "/mode": "std_msgs/msg/String",
    "/scan": "sensor_msgs/msg/LaserScan",
    "/many": "std_msgs/msg/Float64MultiArray",
    "/ints": "std_msgs/msg/Int64MultiArray",
    "/uints": "std_msgs/msg/UInt64MultiArray",
    "/marks": "visualization_msgs/msg/MarkerArray",
    "/bump": "std_msgs/msg/Empty",
    "/part": "sensor_msgs/msg/JoyFeedback",
    "/pair": "geometry_msgs/msg/Vector3",
    "/robot": "nav_msgs/msg/Odometry",
    "/cart": "nav_msgs/msg/Odometry",
}
KINDS = {"/scan": np.float32, "/many": np.float64, "/ints": np.int64, "/uints": np.uint64}
PLACES = {"position": "pose__pose__position", "velocity": "twist__twist__linear"}
PLACES |= {"velocity.angular": "twist__twist__angular", "orientation": "pose__pose__orientation"}


def _message(topic: str, values: Mapping[str, Any]) -> Any:
    """A message of ROS."""
    type_ = TYPES[topic]
    if topic in ("/robot", "/cart"):
        parts = [(name.split(".", 1)[1].rpartition("."), value) for name, value in values.items()]
        return made(type_, **{f"{PLACES[part]}__{axis}": value for (part, _, axis), value in parts})
    if topic == "/marks":
        found, [length] = made(type_), {len(each) for name, each in values.items() if name != "marks"} or {0}
        blank = {"ids": (0,) * length, "kinds": ("",) * length, "locked": (False,) * length, **values}
        for id_, kind, locked in zip(blank["ids"], blank["kinds"], blank["locked"], strict=True):
            found.markers.append(made("visualization_msgs/msg/Marker", id=id_, ns=kind, frame_locked=locked))
        return found
    if topic == "/bump":
        return made(type_)
    if topic == "/part":
        return made(type_, id=values.get("key", 0), type=values.get("part", 0), intensity=values.get("level", 0.0))
    if topic == "/pair":
        return made(type_, x=values.get("pair_x", 0.0), y=values.get("pair_y", 0.0))
    [value] = values.values()
    if topic in KINDS:
        return made(type_, **{"ranges" if topic == "/scan" else "data": np.array(value, KINDS[topic])})
    return made(type_, data=value)


def is_bag(form: str) -> bool:
    """Whether a form has messages of topics, one by one."""
    return form in FORMS


def bag_forms(rows: Sequence[Row]) -> list[str]:
    """Forms of bags that can hold the rows: one message each.

    In ROS 1 those of one time have no order, and a marker has other fields.
    """
    if any(len(row.messages) != 1 for row in rows):
        return []
    is_strict = len({row.time for row in rows}) == len(rows)
    has_markers = any("/marks" in row.messages for row in rows)
    return [form for form in FORMS if form != "ros1" or (is_strict and not has_markers)]


def write(form: str, folder: Path, of: Monitors, recording: Recording) -> Path:
    """A file with the rows of a recording."""
    return write_bag(form, folder, recording) if is_bag(form) else TABLES[form](folder, of, recording)


def write_bag(form: str, folder: Path, recording: Recording) -> Path:
    """A bag with the messages of a recording."""
    sent = [Sent(t, TYPES[t], row.time, _message(t, v)) for row in recording.rows for t, v in row.messages.items()]
    return FORMS[form](folder, sent)


def seconds(time: int) -> str:
    """A time in seconds, exactly."""
    return f"{time // 10**9}.{time % 10**9:09d}"


def _cell(value: Any) -> str:
    if isinstance(value, tuple):
        return json.dumps(value)
    return json.dumps(value) if isinstance(value, bool) else value if isinstance(value, str) else repr(value)


def write_csv(folder: Path, of: Monitors, recording: Recording) -> Path:
    """Cells by signal."""
    path = folder / "run.csv"
    path.write_text(csv_text(list(of.signals), recording), newline="")
    return path


def csv_text(names: Sequence[str], recording: Recording) -> str:
    """A table with a column for each of the signals with these names."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["time", *names])
    for row in recording.rows:
        cells = {n: v for values in row.messages.values() for n, v in values.items()}
        writer.writerow([seconds(row.time), *(_cell(cells[n]) if n in cells else "" for n in names)])
    return text.getvalue()


def _json_lines(folder: Path, of: Monitors, recording: Recording) -> Path:
    path = folder / "run.jsonl"
    lines = []
    for row in recording.rows:
        cells = json.dumps(of.cells(row))
        lines.append(f'{{"time": {seconds(row.time)}{", " if len(cells) > 2 else ""}{cells[1:]}\n')
    path.write_text("".join(lines))
    return path


def _parquet(folder: Path, of: Monitors, recording: Recording) -> Path:
    cells = [of.cells(row) for row in recording.rows]
    columns: dict[str, Any] = {"time": pa.array([row.time for row in recording.rows], pa.int64())}
    for name, signal in of.signals.items():
        assert isinstance(signal.definition, Field)
        columns[name] = pa.array([_listed(each.get(name)) for each in cells], _arrow(signal.definition, cells, name))
    path = folder / "run.parquet"
    pq.write_table(pa.table(columns), path, row_group_size=Random(len(cells)).choice([7, 64, 10_000]))
    return path


def _listed(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value


def _arrow(field: Field, cells: Sequence[Mapping[str, Any]], name: str) -> pa.DataType:
    topic, known = field.topic, {"/f": pa.float32(), "/g": pa.float32(), "/scan": pa.list_(pa.float32())}
    if topic in known:
        return known[topic]
    simple = {
        **dict.fromkeys(("/small",), pa.int8()),
        "/byte": pa.uint8(),
        "/i": pa.int64(),
        "/u": pa.uint64(),
        "/flag": pa.bool_(),
        "/mode": pa.string(),
        "/ints": pa.list_(pa.int64()),
        "/uints": pa.list_(pa.uint64()),
        "/many": pa.list_(pa.float64()),
    }
    marks = {"ids": pa.list_(pa.int32()), "kinds": pa.list_(pa.string()), "locked": pa.list_(pa.bool_())}
    marks |= dict.fromkeys(("marks", "bump"), pa.bool_())
    marks |= {"key": pa.uint8(), "part": pa.uint8(), "level": pa.float32()}
    return marks.get(name) or simple.get(topic, pa.float64())


TABLES: Mapping[str, Callable[[Path, Monitors, Recording], Path]] = {
    "csv": write_csv,
    "json lines": _json_lines,
    "parquet": _parquet,
}


def cut(recording: Recording, of_bag: bool, since: int | None, until: int | None) -> Recording | None:
    """What a run from `since` until `until` has of a file with the rows of a recording; None if there is nothing."""
    rows = [r for r in recording.rows if (since is None or r.time >= since) and (until is None or r.time <= until)]
    first, last = recording.rows[0].time, recording.rows[-1].time
    if not rows:
        return None
    begin = since if of_bag and since is not None and first <= since <= last else rows[0].time
    return Recording(rows, begin, rows[-1].time if until is None else until)


def ends(chance: Random, recording: Recording) -> tuple[int | None, int | None]:
    """Some times from and until which to judge, as the command takes them."""
    times = [row.time for row in recording.rows]
    near = [times[0] + 1, *(chance.choice(times) + chance.choice([0, 0, 1, -1, 10**7]) for _ in range(2))]
    since = chance.choice(near) if chance.random() < 0.4 else None
    until = chance.choice([*near, times[-1] + 10**9]) if chance.random() < 0.4 else None
    return since, until
