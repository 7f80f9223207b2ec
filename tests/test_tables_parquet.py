"""Parquet: the same run, whatever table it is in; its types of times and values; damage."""

from __future__ import annotations

import json
import math
import random
from decimal import Decimal
from pathlib import Path
from typing import Any

import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyarrow import parquet
from stepping import from_text
from test_tables import read, signals

from ltlc.inputs.recordings import RecordingError, open_recording
from ltlc.inputs.recordings import parquet as module
from ltlc.monitoring.judging.run import run
from ltlc.specification.expressions import ValueType
from ltlc.specification.wire import PRIMITIVES


def written(folder: Path, columns: dict[str, Any], **options: Any) -> Path:
    path = folder / "run.parquet"
    parquet.write_table(pa.table(columns), path, **options)
    return path


DOUBLES = st.one_of(st.none(), st.floats(), st.sampled_from([0.0, -0.0, 5e-324]))
ROWS = st.lists(
    st.fixed_dictionaries(
        {
            "v": DOUBLES,
            "single": st.one_of(st.none(), st.floats(width=32)),
            "small": st.one_of(st.none(), st.integers(-128, 127)),
            "wide": st.one_of(st.none(), st.integers(0, 2**64 - 1)),
            "flag": st.one_of(st.none(), st.booleans()),
            "mode": st.one_of(st.none(), st.sampled_from(["a", "é, b"])),
            "scan": st.one_of(st.none(), st.lists(st.floats(width=32), max_size=3)),
            "names": st.one_of(st.none(), st.lists(st.sampled_from(["a", ""]), max_size=2)),
        }
    ),
    min_size=1,
    max_size=6,
)
TYPES = {
    "v": pa.float64(),
    "single": pa.float32(),
    "small": pa.int8(),
    "wide": pa.uint64(),
    "flag": pa.bool_(),
    "mode": pa.dictionary(pa.int8(), pa.string()),
    "scan": pa.list_(pa.float32()),
    "names": pa.large_list(pa.string()),
}


@given(ROWS, st.integers(1, 4), st.randoms())
def test_a_run_is_the_same_in_each_kind_of_table(
    tmp_path_factory: pytest.TempPathFactory, rows: list[dict[str, Any]], size: int, choice: random.Random
) -> None:
    folder = tmp_path_factory.mktemp("same")
    times = sorted(choice.uniform(1.6e9, 1.61e9) for _ in rows)
    columns: dict[str, Any] = {name: pa.array([row[name] for row in rows], type_) for name, type_ in TYPES.items()}
    path = written(folder, {**columns, "time": times}, row_group_size=size)
    objects = [{"time": time, **row} for time, row in zip(times, rows, strict=True)]
    (folder / "run.jsonl").write_text("\n".join(map(json.dumps, objects)))
    cells = [[str(time), *(cell(row[name]) for name in TYPES)] for time, row in zip(times, rows, strict=True)]
    lines = [",".join(line) for line in [["time", *TYPES], *cells]]
    (folder / "run.csv").write_text("\n".join(lines))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "ROWS", size)
        found = read(path, signals())
    assert found == read(folder / "run.jsonl", signals())
    assert found == read(folder / "run.csv", signals())


def cell(value: Any) -> str:
    if value is None:
        return ""
    text = json.dumps(value) if isinstance(value, list) else str(value)
    return '"' + text.replace('"', '""') + '"' if "," in text or '"' in text else text


INTEGERS = {
    name: (PRIMITIVES[name], getattr(pa, name)())
    for name in ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64")
}


@pytest.mark.parametrize("form", ["number", "list"])
@pytest.mark.parametrize("base", INTEGERS)
def test_the_ends_of_an_integer_type_are_its_values_and_what_is_beyond_is_none(
    tmp_path: Path, base: str, form: str
) -> None:
    numbers, _ = INTEGERS[base]
    least, most = int(numbers.least), int(numbers.most)
    is_list = form == "list"
    wanted = signals({"n": (ValueType.NUMBERS if is_list else ValueType.NUMBER, numbers)})
    tried = 0
    for stored, type_ in INTEGERS.values():
        for value in (least - 1, least, most, most + 1):
            if not stored.least <= value <= stored.most:
                continue
            cells = pa.array([[value]], pa.list_(type_)) if is_list else pa.array([value], type_)
            rows, told = read(written(tmp_path, {"time": [0.0], "n": cells}), wanted)
            kept = value if numbers.is_wide else float(value)
            expected = [(0, {"n": repr((kept,) if is_list else kept)})] if least <= value <= most else []
            assert (rows, told[:6]) == (expected, "" if expected else "LTL803"), (value, type_)
            tried += 1
    assert tried >= 2


NS = 1_700_000_000_100_000_001


@pytest.mark.parametrize(
    ("times", "exact"),
    [
        (pa.array([1700000000.1]), 1_700_000_000_100_000_000),
        (pa.array([1.5], pa.float32()), 1_500_000_000),
        (pa.array([1e-9]), 1),
        (pa.array([4e-30]), 0),
        (pa.array([0.1], pa.float32()), 100_000_000),
        (pa.array([NS]), NS),
        (pa.array([NS], pa.uint64()), NS),
        (pa.array([7], pa.int8()), 7),
        (pa.array([Decimal("1700000000.100000001")]), NS),
        (pa.array([Decimal("0.0000000015")]), 2),
        (pa.array([Decimal("1.5")], pa.decimal256(60, 9)), 1_500_000_000),
        (pa.array([Decimal("1.5")], pa.decimal128(3, 1)), 1_500_000_000),
        (pa.array([NS], pa.timestamp("ns", "Europe/Paris")), NS),
        (pa.array([1_700_000_000_100_000], pa.timestamp("us")), 1_700_000_000_100_000_000),
        (pa.array([1_700_000_000_100], pa.timestamp("ms")), 1_700_000_000_100_000_000),
        (pa.array([1_700_000_000], pa.timestamp("s")), 1_700_000_000_000_000_000),
    ],
)
@pytest.mark.parametrize("head", ["time", "__time", "timestamp"])
def test_each_type_of_times_has_its_unit(tmp_path: Path, times: pa.Array, exact: int, head: str) -> None:
    assert read(written(tmp_path, {"v": [1.0], head: times}), signals()) == ([(exact, {"v": "1.0"})], "")


@pytest.mark.parametrize(
    ("columns", "words"),
    [
        ({"v": [1.0]}, "LTL801: there is no column `time`"),
        ({"time": [0.0], "/s/a.0": [0.0], "/s/a[0]": [0.0]}, "LTL801: two columns are called `/s/a[0]`"),
        ({"time": ["0"]}, "LTL801: column `time` is of type string, which is not a time"),
        ({"time": [0.0, None]}, "LTL804: row 2: there is no time"),
        ({"time": [0.0, math.nan]}, "LTL804: row 2: `nan` is not a time"),
        ({"time": [0.0, 1e300]}, "LTL804: row 2: `1e+300` is not a time"),
        ({"time": [0, 2**62]}, "LTL804: row 2: `4611686018427387904` is not a time"),
        ({"time": pa.array([0, 2**63], pa.uint64())}, "LTL804: row 2: `9223372036854775808` is not a time"),
        ({"time": pa.array([0, 2**40], pa.timestamp("s"))}, "LTL804: row 2: `<value out of range"),
        ({"time": [Decimal(0), Decimal("99999999999")]}, "LTL804: row 2: `99999999999` is not a time"),
        ({"time": pa.array([0, 10**40], pa.decimal256(60, 0))}, "LTL804: row 2: `1" + "0" * 40 + "` is not a time"),
        ({"time": [0.5, 0.25]}, "LTL804: row 2: time goes back from 0.5 to 0.25"),
        ({"time": [0.0, 1.7e9]}, "LTL804: row 2: time jumps from 0 to 1700000000, by more than a year"),
        ({"time": [0.0, 1.0], "v": ["a", "1"]}, "LTL803: row 1: column `v`: `a` is not a number"),
        ({"time": [0.0, 1.0], "small": [1, 300]}, "LTL803: row 2: column `small`: `300` is not a whole number"),
        ({"time": [0.0, 1.0], "small": [1.0, 0.5]}, "LTL803: row 2: column `small`: `0.5` is not a whole number"),
        ({"time": [0.0, 1.0], "wide": [None, -1]}, "LTL803: row 2: column `wide`: `-1` is not a whole number"),
        ({"time": [0.0, 1.0], "flag": [1, 2]}, "LTL803: row 2: column `flag`: `2` is not true, false, 1 or 0"),
        ({"time": [0.0, 1.0], "mode": ["a", "b"], "scan": [[1.0], [None]]}, "LTL803: row 2: column `scan`: `[None]`"),
        ({"time": [0.0, 1.0], "scan": [1.0, 2.0]}, "LTL803: row 1: column `scan`: `1.0` is not an array of numbers"),
        (
            {"time": [0.0, 1.0], "v": [{"x": 1}, {"x": 2}]},
            "LTL803: row 1: column `v`: a value of type struct<x: int64>",
        ),
        ({"time": [0.0, 1.0], "v": pa.array([1, 2], pa.timestamp("ns"))}, "LTL803: row 1: column `v`: a value of type"),
        ({"time": [0.0, 1.0], "mode": [b"a", b"b"]}, "LTL803: row 1: column `mode`: a value of type binary"),
    ],
)
def test_what_is_wrong_with_parquet_is_told_with_its_row(tmp_path: Path, columns: dict[str, Any], words: str) -> None:
    rows, problem = read(written(tmp_path, columns), signals())
    assert problem[: len(words)] == words
    assert len(rows) == ("row 2" in words)


def test_a_mistake_is_told_after_the_rows_of_all_columns_before_it(tmp_path: Path) -> None:
    columns = {"time": [0.0, 1.0, 2.0, 3.0], "v": [1.0, 2.0, 3.0, 4.0], "small": [1, 2, 3, 999], "flag": [1, 0, 7, 0]}
    rows, problem = read(written(tmp_path, columns), signals())
    assert (len(rows), problem[:28]) == (2, "LTL803: row 3: column `flag`")


def test_columns_by_topic_and_field_are_found_and_only_they_are_read(tmp_path: Path) -> None:
    columns = {
        "timestamp": [0, 10**9],
        "/odom/twist/twist/linear/x": [0.5, 2.0],
        "/scan/ranges": [[0.75, 0.25], None],
        "other": [b"x", b"y"],
    }
    text = (
        "object robot /odom Odometry\ndecl beam /scan LaserScan.ranges[1]\n"
        "slow: never robot.velocity.x > 1\nnear: never beam < 0.5\n"
    )
    report = run(*from_text(text), written(tmp_path, columns))
    assert report.session is not None
    assert [(t.verdict.value, t.steps) for t in report.session.tracks] == [("violated", 2), ("violated", 1)]
    assert [d.message for d in report.diagnostics] == ["no property reads the column `other`"]


def test_a_name_with_dots_is_a_name(tmp_path: Path) -> None:
    columns = {"time": [0.0], "robot": [7.0], "robot.velocity.x": [2.0]}
    report = run(*from_text("object robot /odom Odometry\nnever robot.velocity.x > 1\n"), written(tmp_path, columns))
    assert report.exit_code == 1


def test_damaged_parquet_is_told(tmp_path: Path) -> None:
    path = written(tmp_path, {"time": [float(t) for t in range(20_000)], "v": [0.5] * 20_000}, row_group_size=5_000)
    content = path.read_bytes()
    path.write_bytes(content[:-100])
    assert read(path, signals())[1].startswith("LTL820")
    path.write_bytes(b"")
    assert read(path, signals())[1].startswith("LTL820")
    damaged = bytearray(content)
    third = parquet.ParquetFile(pa.BufferReader(content)).metadata.row_group(2).column(0).data_page_offset
    damaged[third : third + 100] = b"\xff" * 100
    path.write_bytes(damaged)
    rows, problem = read(path, signals())
    assert problem.startswith("LTL820")
    assert len(rows) <= 10_000


def test_fewer_rows_than_the_file_says_it_has_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(tmp_path, {"time": [0.0, 1.0], "v": [1.0, 2.0]})
    recording = open_recording(path, signals())
    monkeypatch.setattr(parquet.ParquetFile, "iter_batches", lambda *_, **__: iter(()))
    with pytest.raises(RecordingError, match="0 of its 2 rows could be read"):
        list(recording.blocks())


def test_compressed_parquet_is_no_recording(tmp_path: Path) -> None:
    path = tmp_path / "run.parquet.gz"
    path.write_bytes(b"")
    assert read(path, signals())[1].startswith("LTL807")


def test_a_table_without_rows_is_one(tmp_path: Path) -> None:
    assert read(
        written(tmp_path, {"time": pa.array([], pa.float64()), "v": pa.array([], pa.float64())}), signals()
    ) == ([], "")
