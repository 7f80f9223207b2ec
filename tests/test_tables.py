"""Tables read by columns: the same as row by row, whatever stands in the cells."""

from __future__ import annotations

import gzip
import json
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pyarrow as pa
import pytest
import zstandard
from hypothesis import example, given
from hypothesis import strategies as st
from pyarrow import parquet as pq
from stepping import from_text

from ltlc.inputs.recordings import RecordingError, csv, open_recording, plain, text
from ltlc.inputs.recordings.csv import CsvTable
from ltlc.inputs.recordings.jsonl import JsonlTable
from ltlc.monitoring.judging.run import run
from ltlc.specification.expressions import Field, Signal, ValueType
from ltlc.specification.wire import PRIMITIVES, Numbers

SIGNALS = {
    "v": (ValueType.NUMBER, PRIMITIVES["float64"]),
    "single": (ValueType.NUMBER, PRIMITIVES["float32"]),
    "small": (ValueType.NUMBER, PRIMITIVES["int8"]),
    "wide": (ValueType.NUMBER, PRIMITIVES["uint64"]),
    "flag": (ValueType.BOOLEAN, PRIMITIVES["float64"]),
    "mode": (ValueType.STRING, PRIMITIVES["float64"]),
    "scan": (ValueType.NUMBERS, PRIMITIVES["float32"]),
    "names": (ValueType.STRINGS, PRIMITIVES["float64"]),
}


def signals(types: Mapping[str, tuple[ValueType, Numbers]] = SIGNALS) -> dict[str, Signal]:
    return {name: Signal(name, type_, Field(f"/{name}", "", ("data",), of)) for name, (type_, of) in types.items()}


Told = list[tuple[int, dict[str, Any]]]


def read(path: Path, wanted: Mapping[str, Signal]) -> tuple[Told, str]:
    """All rows, values as text, for NaN and -0.0 are to be told from others; and the diagnostic at the end."""
    found: Told = []
    try:
        recording = open_recording(path, wanted)
        for block in recording.blocks():
            for time, names, values, _ in block.rows(wanted):
                found.append((time, dict(zip(names, map(repr, values), strict=True))))
    except RecordingError as error:
        return found, f"{error.diagnostic.code}: {error.diagnostic.message}"
    return found, ""


def both_ways(path: Path, wanted: Mapping[str, Signal]) -> tuple[tuple[Told, str], tuple[Told, str]]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(plain, "WORTH", math.inf)
        by_rows = read(path, wanted)
        patch.setattr(plain, "WORTH", 0)
        return by_rows, read(path, wanted)


HARD = [
    "", " ", "  ", "\t", "0", "-0", "-0.0", "+1", "1", "1.0", "1.000000000", "0.0", "01", "1.", ".5", ".", "-", "1e3",
    "1E+3", "1e", "1e-400", "1e400", "-1e999", "4.9e-324", "2.4703282292062327e-324", "2.4703282292062328e-324",
    "1.7976931348623159e308", "9007199254740993", "9007199254740992.5", "9007199254740993.0000000000000001",
    "18446744073709551615", "18446744073709551616", "-9223372036854775808", "127", "128", "-128", "-129", "0.5", "nan",
    "NaN", "-nan", "nan(7)", "inf", "-inf", "+inf", "Infinity", "infinit", "1_0", "_1", "0x10", "0X1p3", "0b1", "1 0",
    " 1", "1 ", "1\t", "\u0661", "\uff11", "1e1_0", "1d3", "1f", "true", "True", "TRUE", "false", "yes", "a", "é",
    "\u00a0", "\u2028", "\x00", "\x1f1", "3.4028235e38", "3.4028236e38", "3.5e38", "1e-46", "16777217", "0.1",
    "[1, 2]", "[]", "[NaN, null]", '["a"]', "null", "None", "1.5e-10", "0." + "0" * 30 + "1", "1" * 400,
    "1" * 20 + "." + "3" * 40,
]  # fmt: skip
NUMBERS = st.one_of(
    st.floats().map(repr),
    st.floats(width=32).map(repr),
    st.floats().map(lambda value: f"{value:.30e}"),
    st.floats(-1e9, 1e9).map(lambda value: f"{value:.6f}"),
    st.integers(-(2**65), 2**65).map(str),
    st.text("0123456789.eE+-_ ", max_size=12),
)
CELLS = st.one_of(st.sampled_from(HARD), NUMBERS, st.text(max_size=4))


def quoted(cell: str) -> str:
    return '"' + cell.replace('"', '""') + '"' if any(c in cell for c in '",\r\n') else cell


@pytest.mark.parametrize("name", SIGNALS)
def test_a_cell_means_the_same_by_columns_as_by_rows(tmp_path: Path, name: str) -> None:
    path = tmp_path / "run.csv"
    for cell in HARD:
        path.write_bytes(f"time,{name}\n0,{quoted(cell)}\n".encode())
        by_rows, by_columns = both_ways(path, signals())
        assert by_columns == by_rows, cell


@given(st.lists(st.tuples(st.sampled_from(list(SIGNALS)), CELLS), min_size=1, max_size=6))
def test_columns_of_random_cells_are_read_as_rows_are(
    tmp_path_factory: pytest.TempPathFactory, cells: list[tuple[str, str]]
) -> None:
    path = tmp_path_factory.mktemp("cells") / "run.csv"
    heads = list(SIGNALS)
    lines = [",".join(["time", *heads])]
    for time, (name, cell) in enumerate(cells):
        lines.append(",".join([str(time), *(quoted(cell) if head == name else "" for head in heads)]))
    path.write_bytes("\n".join(lines).encode())
    by_rows, by_columns = both_ways(path, signals())
    assert by_columns == by_rows


TIMES = st.one_of(
    st.sampled_from(HARD),
    st.decimals(-5, 5, places=9).map(str),
    st.integers(0, 10**19).map(lambda ns: f"{ns // 10**9}.{ns % 10**9:09}"),
    st.floats(0, 4e9).map(lambda value: f"{value:.18e}"),
    st.floats(0, 4e9).map(repr),
    st.integers(0, 10**30).map(lambda part: f"1700000000.{part:030}"),
    st.sampled_from(["0.0000000005", "0.0000000015", "0.0000000025", "4611686018.427387903", "4611686018.427387904"]),
)


@st.composite
def aligned(draw: st.DrawFn) -> list[str]:
    """Times that are equally long, with the point at one place, but for what stands at one place of one of them."""
    whole, fraction = draw(st.integers(0, 11)), draw(st.integers(-1, 10))
    most = 10 ** (whole + max(0, fraction)) - 1
    near = draw(st.integers(0, most))
    numbers = draw(st.lists(st.integers(near, min(near + 10**12, most)), min_size=1, max_size=4))
    digits = [f"{number:0{whole + max(0, fraction)}}" for number in numbers]
    times = [of[:whole] + "." * (fraction >= 0) + of[whole:] for of in digits]
    if times[0] and draw(st.booleans()):
        place = draw(st.integers(0, len(times[0]) - 1))
        times[-1] = times[-1][:place] + draw(st.sampled_from("0.+-/:e \x85é")) + times[-1][place + 1 :]
    return times


@given(st.lists(TIMES, min_size=1, max_size=4) | aligned())
@example(["."])
@example(["4611686018.427387904"])
@example(["9000000000.5"])
@example(["9300000000.5"])
@example(["20000000000"])
def test_times_are_read_exactly_by_columns_too(tmp_path_factory: pytest.TempPathFactory, times: list[str]) -> None:
    path = tmp_path_factory.mktemp("times") / "run.csv"
    for some in (times, sorted(times, key=_number)):
        path.write_bytes("\n".join(["time,v", *(f"{quoted(time)},1" for time in some)]).encode())
        by_rows, by_columns = both_ways(path, signals())
        assert by_columns == by_rows


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return 0.0


@given(st.text('0,1"\r\n é', max_size=30), st.sampled_from(["v,time,mode\n", "time,mode\r\n", '"time",mode\n']))
def test_lines_and_quotes_are_parted_alike(tmp_path_factory: pytest.TempPathFactory, body: str, head: str) -> None:
    path = tmp_path_factory.mktemp("lines") / "run.csv"
    path.write_bytes((head + body).encode())
    by_rows, by_columns = both_ways(path, signals())
    assert by_columns == by_rows


QUOTED = [
    ',"a",0', ',"a,b",0', ',"a\nb",0', ',"a""b",0', ',"",0', ',"""",0', ',"a"b,0', ',a"b,0', ',a"b",0', ', "a",0',
    ',"a" ,0', '"a\n","b",0', ',a,"0"', 'x"y,",z"w",0', 'x","a",0', ',"a,0', '"', ',a,"0', ',"a"\r,0', ',"a",0\r',
]  # fmt: skip


@pytest.mark.parametrize("line", QUOTED)
def test_quotes_mean_the_same_by_columns_as_by_rows(tmp_path: Path, line: str) -> None:
    path = tmp_path / "run.csv"
    for body in (line, f"{line}\n", f",,0\n{line}\n,,1\n"):
        path.write_bytes(b"other,mode,time\n" + body.encode())
        by_rows, by_columns = both_ways(path, signals())
        assert by_columns == by_rows, body


def refuse(*_: object) -> None:
    raise AssertionError("this piece was read row by row")


def test_pieces_in_which_nothing_is_odd_are_read_by_columns(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plain, "WORTH", 0)
    monkeypatch.setattr(CsvTable, "_rows", refuse)
    path = tmp_path / "run.csv"
    path.write_text(
        "time,v,single,small,wide,flag,mode,scan[0],scan[1]\n\n"
        '1700000000.1,,0.1,7,18446744073709551615,True,"a,\nb",1,2\n1.7000000002e9,nan,,-0,,0,é,3,\n'
    )
    assert read(path, signals()) == (
        [
            (
                1700000000100000000,
                {
                    "single": "0.10000000149011612",
                    "small": "7.0",
                    "wide": "18446744073709551615",
                    "flag": "True",
                    "mode": repr("a,\nb"),
                    "scan": "(1.0, 2.0)",
                },
            ),
            (
                1700000000200000000,
                {"v": "nan", "small": "0.0", "flag": "False", "mode": repr("é"), "scan": "(3.0,)"},
            ),
        ],
        "",
    )


LINE = st.tuples(
    st.sampled_from(["1", "nan", "", "x", "1,2"]), st.just('x"y') | st.text('a"\n\ré,', max_size=9).map(quoted)
)


@given(st.lists(LINE, max_size=12), st.integers(1, 40), st.sampled_from(["\n", "\r\n", "\r"]), st.booleans())
def test_where_a_file_is_cut_into_pieces_changes_nothing(
    tmp_path_factory: pytest.TempPathFactory, lines: list[tuple[str, str]], size: int, end: str, is_cut: bool
) -> None:
    path = tmp_path_factory.mktemp("pieces") / "run.csv"
    body = [f"{time},{v},{mode}" for time, (v, mode) in enumerate(lines)]
    path.write_bytes(("\ufefftime,v,mode" + end + end.join(body)).encode()[: -2 if is_cut else None])
    by_rows, _ = both_ways(path, signals())
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(text, "SIZE", size)
        patch.setattr(csv, "SHORT", size)
        assert both_ways(path, signals()) == (by_rows, by_rows)


@pytest.mark.parametrize(
    ("end", "compress"), [(".gz", gzip.compress), (".zst", zstandard.compress), (".GZ", gzip.compress)]
)
@pytest.mark.parametrize(
    ("name", "content"), [("run.csv", b"time,v\n0,1\n1,2\n"), ("run.jsonl", b'{"time": 0, "v": 1}')]
)
def test_text_may_be_compressed(
    tmp_path: Path, end: str, compress: Callable[[bytes], bytes], name: str, content: bytes
) -> None:
    (tmp_path / name).write_bytes(content)
    (tmp_path / (name + end)).write_bytes(compress(content))
    rows, problem = read(tmp_path / (name + end), signals())
    assert (rows, problem) == read(tmp_path / name, signals())
    assert rows


@pytest.mark.parametrize(("end", "compress"), [(".gz", gzip.compress), (".zst", zstandard.compress)])
def test_a_compressed_file_that_is_cut_off_is_read_up_to_there(
    tmp_path: Path, end: str, compress: Callable[[bytes], bytes]
) -> None:
    path = tmp_path / f"run.csv{end}"
    content = b"time,v\n" + b"".join(b"%d,%d\n" % (t, hash(str(t)) % 10**9) for t in range(100_000))
    path.write_bytes(compress(content)[:-100])
    rows, problem = read(path, signals())
    assert 10_000 < len(rows) < 100_000
    assert problem.startswith("LTL820")
    path.write_bytes(b"not compressed")
    assert read(path, signals())[1].startswith("LTL820")


def test_a_quote_that_damage_leaves_open_ends_the_recording(tmp_path: Path) -> None:
    path = tmp_path / "run.csv.gz"
    path.write_bytes(gzip.compress(b'time,mode\n0,x"y\n1,"a\nb')[:-8])
    rows, problem = read(path, signals())
    assert rows[0] == (0, {"mode": repr('x"y')})
    assert problem.startswith("LTL8")


def test_a_mistake_deep_in_a_large_file_is_told_with_its_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(text, "SIZE", 1 << 17)
    path = tmp_path / "run.csv"
    lines = [f"{time}.5,{time % 7}" for time in range(100_000)]
    lines[80_000] = "80000.5,x"
    path.write_text("\n".join(["time,v", *lines]))
    rows, problem = read(path, signals())
    assert (len(rows), problem[:21]) == (80_000, "LTL803: line 80002: c")


HARD_JSON = [
    *HARD, "-0", "1E5", "-NaN", "Inf", "-Infinity", "[1, 2.5]", "[NaN, Infinity, -0.0]", "[[1]]", "[1, [2]]",
    "[true, 0]", "[9007199254740993]", '"nan"', '"-inf"', '"1"', '"\\u00e9\\ud83d\\ude00"', '"\\ud800"', '"a\tb"',
    '"a\\tb"', '"\x7f"', '"}\\n{"', '"{"', '"["', '"é"', "{}", '{"a": 1}', "1 2", "1,", "/**/ 1", "'a'", "[1,]",
    "[null]", '["a", ""]', '"2020-01-01"', "[-0]",
]  # fmt: skip


@pytest.mark.parametrize("name", [*SIGNALS, "other", "time"])
def test_a_value_in_json_means_the_same_by_columns_as_by_rows(tmp_path: Path, name: str) -> None:
    path = tmp_path / "run.jsonl"
    first, time = ("", "") if name == "time" else ('{"time": 0.5, "v": 1}\n', '"time": 0.5, ')
    for value in HARD_JSON:
        path.write_bytes(f'{first}{{{time}"{name}": {value}}}\n'.encode())
        by_rows, by_columns = both_ways(path, signals())
        assert by_columns == by_rows, value


OBJECTS = [
    '{"time": 0}{"time": 1}\n{"time": 2}',
    '{"time": 0,\n"v": 1}{"time": 1}',
    '{"time": 0}\n\n{"time": 1}',
    '{"time": 0} \r\n {"time": 1}\n\n',
    '{"time": 0,\n{"v": 1}',
    '{"time": 0}\n',
    "\n",
    '{"time": 0, "other": ' + "[" * 5_000 + "]" * 5_000 + "}",
]


@pytest.mark.parametrize("content", OBJECTS)
def test_a_line_is_an_object_by_columns_as_by_rows(tmp_path: Path, content: str) -> None:
    path = tmp_path / "run.jsonl"
    path.write_bytes(content.encode())
    by_rows, by_columns = both_ways(path, signals())
    assert by_columns == by_rows


def test_pieces_of_json_in_which_nothing_is_odd_are_read_by_columns(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(plain, "WORTH", 0)
    monkeypatch.setattr(JsonlTable, "_objects", refuse)
    path = tmp_path / "run.jsonl"
    path.write_text(
        '{"time": 1700000000.1, "v": 1, "wide": 18446744073709551615, "flag": true, "mode": "é", "other": null}\n'
        '{"scan": [1.5, NaN, -Infinity], "time": 1.7000000002e9, "names": ["a"], "single": 0.1, "v": null}'
    )
    assert read(path, signals()) == (
        [
            (
                1700000000100000000,
                {"v": "1.0", "wide": "18446744073709551615", "flag": "True", "mode": repr("é")},
            ),
            (
                1700000000200000000,
                {"scan": "(1.5, nan, -inf)", "names": "('a',)", "single": "0.10000000149011612"},
            ),
        ],
        "",
    )
    assert open_recording(path, {}).columns == ("v", "wide", "flag", "mode", "other", "scan", "names", "single")


NUMBER = st.one_of(st.floats().map(json.dumps), st.integers(-(2**70), 2**70).map(str), TIMES)
OBJECT = st.lists(
    st.tuples(st.sampled_from(["time", "v", "small", "single", "other", "mode"]), NUMBER | st.just("null")), max_size=4
)


@given(
    st.lists(OBJECT, min_size=1, max_size=4),
    st.sampled_from(["\n", "\r\n", "\r", "\n\n", " \n", ""]),
    st.integers(5, 99),
)
def test_objects_are_read_alike(
    tmp_path_factory: pytest.TempPathFactory, objects: list[list[tuple[str, str]]], end: str, size: int
) -> None:
    path = tmp_path_factory.mktemp("objects") / "run.jsonl"
    lines = ["{" + ", ".join(f'"{name}": {number}' for name, number in object_) + "}" for object_ in objects]
    timed = [
        line.replace("{", f'{{"time": {time}, ', 1) if '"time"' not in line else line for time, line in enumerate(lines)
    ]
    for some in (lines, timed):
        path.write_bytes(end.join(some).encode())
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(text, "SIZE", size)
            by_rows, by_columns = both_ways(path, signals())
        assert by_columns == by_rows


ODOMETRY = """object robot /odom Odometry
decl scan /scan LaserScan.ranges
decl beam /scan LaserScan.ranges[1]
decl id /s action_msgs/GoalStatusArray.status_list[].goal_info.stamp.sec
slow: never robot.velocity.x > 1
near: never min(scan) < 0.5
second: never beam < 0.5
one: never any(id == 1)
"""
BY_TOPIC = (
    "__time,/odom/twist/twist/linear/x,/odom/pose/pose/position/z,{0},/s/status_list[0]/goal_info/stamp/sec\n"
    "1.5,0.500000000,7,0.75,0.25,\n2.5,2.0,7,,,1.000000000\n"
)


@pytest.mark.parametrize("heads", ["/scan/ranges[0],/scan/ranges[1]", "/scan/ranges.0,/scan/ranges.1"])
@pytest.mark.parametrize("worth", [0, math.inf])
def test_columns_may_be_headed_by_topic_and_field_as_plotjuggler_writes_them(
    tmp_path: Path, heads: str, worth: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(plain, "WORTH", worth)
    path = tmp_path / "run.csv"
    path.write_text(BY_TOPIC.format(heads))
    report = run(*from_text(ODOMETRY), path)
    assert report.session is not None
    decided = [(t.verdict.value, t.steps) for t in report.session.tracks]
    assert decided == [("violated", 2), ("violated", 1), ("violated", 1), ("violated", 1)]
    assert report.diagnostics == ()


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_fields_in_heads_may_stand_after_dots_as_in_declarations(tmp_path: Path, ending: str) -> None:
    heads = ["/odom.twist.twist.linear.x", "/scan.ranges.0", "/scan.ranges[1]", "/s.status_list[0].goal_info.stamp.sec"]
    path = tmp_path / f"run.{ending}"
    if ending == "csv":
        path.write_text(f"time,{','.join(heads)}\n0,2,0.25,0.25,1\n")
    else:
        pq.write_table(pa.table({"time": [0.0], **dict(zip(heads, ([2.0], [0.25], [0.25], [1]), strict=True))}), path)
    report = run(*from_text(ODOMETRY), path)
    assert report.session is not None
    assert [track.verdict.value for track in report.session.tracks] == ["violated"] * 4
    assert report.diagnostics == ()


def test_a_column_of_the_name_of_a_signal_goes_before_that_of_its_topic(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("time,/odom/twist/twist/linear/x,robot.velocity.x\n0,2,0\n")
    text_ = "object robot /odom Odometry\nnever robot.velocity.x > 1\n"
    report = run(*from_text(text_), path)
    assert (report.exit_code, report.diagnostics) == (0, ())


def test_what_has_no_column_by_topic_either_is_told_with_both_heads(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("__time,/odom/twist/twist/linear/y\n0,2\n")
    report = run(*from_text("object robot /odom Odometry\nslow: never robot.velocity.x > 1\n"), path)
    assert [d.message for d in report.diagnostics] == [
        "the recording has no column `robot.velocity.x` or `/odom/twist/twist/linear/x`, so `slow` cannot start"
    ]


def test_what_ros2_topic_echo_writes_is_told_from_a_table_that_lacks_its_times(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("110,52000000,odom,base_footprint,0.5,0.0,0.0\n")
    with pytest.raises(RecordingError) as caught:
        open_recording(path, signals())
    assert caught.value.diagnostic.code == "LTL801"
    assert "ros2 topic echo --csv" in caught.value.diagnostic.help
