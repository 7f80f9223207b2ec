"""Recorded runs: what is read from them, what is wrong with them, and what `ltlc run` says."""

from __future__ import annotations

import contextlib
import json
import math
import os
import textwrap
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from stepping import from_text, ns

from ltlc.cli import main
from ltlc.inputs.recordings import RecordingError, open_recording
from ltlc.inputs.recordings.rows import Row
from ltlc.monitoring.judging.run import RunReport, run
from ltlc.specification.expressions import Field, Signal, ValueType

FIXTURES = Path(__file__).parent / "fixtures" / "run"
TYPES = {
    "v": ValueType.NUMBER,
    "flag": ValueType.BOOLEAN,
    "mode": ValueType.STRING,
    "scan": ValueType.NUMBERS,
}


def signals(types: Mapping[str, ValueType]) -> dict[str, Signal]:
    return {name: Signal(name, type_, Field(f"/{name}", "", ("data",))) for name, type_ in types.items()}


def stream(path: Path, types: Mapping[str, ValueType] = TYPES) -> Iterator[Row]:
    for block in open_recording(path, signals(types)).blocks():
        for time, names, found, _ in block.rows(types):
            yield Row(time, dict(zip(names, found, strict=True)))


def rows(folder: Path, content: str | bytes, name: str = "run.csv") -> list[Row]:
    path = folder / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return list(stream(path))


def values(folder: Path, content: str | bytes, name: str = "run.csv") -> list[dict[str, Any]]:
    return [row.values for row in rows(folder, content, name)]


def problem(folder: Path, content: str | bytes, name: str = "run.csv") -> tuple[str, str]:
    with pytest.raises(RecordingError) as caught:
        rows(folder, content, name)
    return caught.value.diagnostic.code, caught.value.diagnostic.message


def test_a_row_has_a_time_and_the_values_of_its_cells(tmp_path: Path) -> None:
    assert rows(tmp_path, "v,time\n1.5,0.25\n") == [Row(ns(0.25), {"v": 1.5})]


@pytest.mark.parametrize("prefix", [b"\xef\xbb\xbf", b""])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_marks_of_byte_order_and_ends_of_lines_do_not_matter(tmp_path: Path, prefix: bytes, end: str) -> None:
    content = prefix + end.join(["time,v", "0,1", "", "1,2"]).encode()
    assert values(tmp_path, content) == [{"v": 1.0}, {"v": 2.0}]


def test_an_empty_cell_is_no_sample(tmp_path: Path) -> None:
    assert values(tmp_path, 'time,v,mode\n0,,a\n1, ,""\n') == [{"mode": "a"}, {}]


@pytest.mark.parametrize(
    ("cell", "value"),
    [("inf", math.inf), ("-Infinity", -math.inf), ("1e999", math.inf), (" 1e-3 ", 0.001), ("+2", 2.0)],
)
def test_numbers_are_read_as_doubles(tmp_path: Path, cell: str, value: float) -> None:
    assert values(tmp_path, f"time,v\n0,{cell}\n") == [{"v": value}]


def test_an_array_is_gathered_from_the_columns_of_its_elements(tmp_path: Path) -> None:
    text = "scan[1],time,scan[0],scan[2]\n2,0,1,3\n,1,4,\n,2,,\nnan,3,5,\n"
    *found, last = values(tmp_path, text)
    assert [row.get("scan") for row in found] == [(1.0, 2.0, 3.0), (4.0,), None]
    assert last["scan"][0] == 5.0
    assert math.isnan(last["scan"][1])


def test_an_element_is_read_from_its_own_column_or_from_the_array(tmp_path: Path) -> None:
    path = tmp_path / "run.jsonl"
    path.write_text('{"time": 0, "scan": [1, 2]}\n{"time": 1, "scan": [3]}\n{"time": 2, "names": ["a", "b"]}\n')
    types = {"scan[1]": ValueType.NUMBER, "names[0]": ValueType.STRING}
    assert open_recording(path, signals(types)).columns == ("scan[1]", "names[0]")
    kept = [row.values for row in stream(path, types)]
    assert kept == [{"scan[1]": 2.0}, {}, {"names[0]": "a"}]
    assert values(tmp_path, "time,scan[0],scan[1]\n0,1,2\n") == [{"scan": (1.0, 2.0)}]


def test_arrays_of_strings_and_booleans_are_arrays(tmp_path: Path) -> None:
    path = tmp_path / "run.jsonl"
    path.write_text('{"time": 0, "names": ["a", "b"], "flags": [true, 0]}\n')
    [row] = stream(path, {"names": ValueType.STRINGS, "flags": ValueType.BOOLEANS})
    assert row.values == {"names": ("a", "b"), "flags": (True, False)}


@pytest.mark.parametrize(
    ("content", "code", "words"),
    [
        ("time,scan[0],scan[2]\n0,1,2\n", "LTL801", "there is a column `scan[2]`, but no column `scan[1]`"),
        ("time,scan[0],scan[1]\n0,,2\n", "LTL803", "at 0 s `scan[0]` is empty, but `scan[1]` is not"),
        ("time,scan[0],scan[1]\n0,1,x\n", "LTL803", "line 2: column `scan[1]`: `x` is not a number"),
    ],
)
def test_what_is_wrong_with_columns_of_elements_is_told(tmp_path: Path, content: str, code: str, words: str) -> None:
    found, message = problem(tmp_path, content)
    assert (found, words in message) == (code, True)


ENTRIES = (
    "decl id /s action_msgs/GoalStatusArray.status_list[].goal_info.stamp.sec\n"
    "decl state /s action_msgs/GoalStatusArray.status_list[].status\n"
    "aborted: never any(id == 3 and state == 6)\n"
)


@pytest.mark.parametrize(
    ("lines", "verdict"),
    [
        (['{"time": 0, "id": [1, 3], "state": [6, 4]}'], "presumably_satisfied"),
        (['{"time": 0, "id": [1, 3], "state": [4, 6]}'], "violated"),
        (['{"time": 0, "id": [], "state": []}'], "presumably_satisfied"),
    ],
)
def test_fields_of_the_messages_of_an_array_are_judged_side_by_side(
    tmp_path: Path, lines: list[str], verdict: str
) -> None:
    path = tmp_path / "run.jsonl"
    path.write_text("\n".join(lines))
    session_ = run(*from_text(ENTRIES), path).session
    assert session_ is not None
    assert session_.tracks[0].verdict.value == verdict


@pytest.mark.parametrize(
    "line", ['{"time": 0, "id": [1, 3], "state": [6]}', '{"time": 0, "id": [1]}\n{"time": 1, "state": [1]}']
)
def test_fields_of_the_messages_of_an_array_come_together(tmp_path: Path, line: str) -> None:
    path = tmp_path / "run.jsonl"
    path.write_text(line)
    report = run(*from_text(ENTRIES), path)
    assert [d.code for d in report.diagnostics] == ["LTL803"]
    assert "they are fields of the messages of one array" in report.diagnostics[0].message


def test_an_empty_array_is_to_blame_only_where_a_measurement_of_it_is_needed(tmp_path: Path) -> None:
    path = tmp_path / "run.jsonl"
    path.write_text('{"time": 0, "a": [], "b": [], "c": [], "d": [], "e": []}\n')
    declared = "".join(f"decl {name} /{name} LaserScan.ranges\n" for name in "abcde")
    said = "any(a > min(b[1:])) and sum(c) > 1 and median(d) < nearest(3, e)"
    report = run(*from_text(f"{declared}p: never ({said})\n"), path)
    assert report.text().splitlines()[-1].endswith("no value: b was empty, d was empty, e was empty")


def test_elements_that_are_nan_are_told_and_why_there_was_no_step(tmp_path: Path) -> None:
    path = tmp_path / "run.jsonl"
    rows_ = ["[0.5, NaN, 3.0]", "[]", "[NaN, NaN]", "[0.05, NaN]"]
    path.write_text("".join(f'{{"time": {t}, "scan": {scan}}}\n' for t, scan in enumerate(rows_)))
    report = run(*from_text("decl scan /scan LaserScan.ranges\nnear: never min(scan) < 0.15\n"), path)
    assert report.text().splitlines()[-1] == (
        "near: violated at +3 s (step 1); 2 steps; 1 step left out: an expression had no value: scan was empty; "
        "1 step left out: an expression had no value: all of scan was NaN; 4 elements of scan were NaN, no measurements"
    )
    [told] = json.loads(report.json())["properties"]
    assert told["elements_not_measured"] == {"scan": 4}
    assert sum(told["invalid_because"].values()) == told["invalid_steps"] == 2


@pytest.mark.parametrize("rate", ["", "_rate_ = 10\n"])
def test_an_element_that_is_nan_is_counted_once_for_each_message(tmp_path: Path, rate: str) -> None:
    path = tmp_path / "run.jsonl"
    path.write_text('{"time": 0, "scan": [1, NaN]}\n{"time": 5, "scan": [1, 2]}\n')
    report = run(*from_text(f"{rate}decl scan /scan LaserScan.ranges\nnever min(scan) < 0.15\n"), path)
    assert report.session is not None
    assert report.session.sampler.not_measured == {"scan": 1}


def test_nan_is_a_sample_that_is_not_a_number(tmp_path: Path) -> None:
    assert math.isnan(values(tmp_path, "time,v\n0,NaN\n")[0]["v"])


@pytest.mark.parametrize(
    ("cell", "value"), [("true", True), ("False", False), ("1", True), ("0", False), ("1.0", True)]
)
def test_booleans_are_words_or_digits(tmp_path: Path, cell: str, value: bool) -> None:
    assert values(tmp_path, f"time,flag\n0,{cell}\n") == [{"flag": value}]


def test_quoted_cells_hold_commas_quotes_line_breaks_and_arrays(tmp_path: Path) -> None:
    text = 'time,mode,scan\n0,"a, ""b""\nc","[1, 2.5, NaN]"\n'
    [found] = values(tmp_path, text)
    assert found["mode"] == 'a, "b"\nc'
    assert found["scan"][:2] == (1.0, 2.5)
    assert math.isnan(found["scan"][2])


@pytest.mark.parametrize(
    ("content", "code", "words"),
    [
        ("", "LTL801", "the recording is empty"),
        ("v\n1\n", "LTL801", "line 1: there is no column `time`"),
        ("time;v\n0;1\n", "LTL801", "line 1: there is no column `time`"),
        ("time,v,v\n", "LTL801", "line 1: two columns are called `v`"),
        ("time,v\n0,1\n1\n", "LTL802", "line 3: 1 cells, but the header has 2"),
        ("time,v\n0,1,2\n", "LTL802", "line 2: 3 cells, but the header has 2"),
        ('time,v\n0,"1\n', "LTL802", "line 2: not CSV"),
        ('time,mode\n0,"a"b\n', "LTL802", "line 2: not CSV"),
        ("time,v\n0,1.5m\n", "LTL803", "line 2: column `v`: `1.5m` is not a number"),
        ("time,v\n0,1_000\n", "LTL803", "line 2: column `v`: `1_000` is not a number"),
        ("time,v\n0,true\n", "LTL803", "line 2: column `v`: `true` is not a number"),
        ("time,flag\n0,yes\n", "LTL803", "line 2: column `flag`: `yes` is not true, false, 1 or 0"),
        ('time,scan\n0,"[1, true]"\n', "LTL803", "line 2: column `scan`"),
        ("time,scan\n0," + "[" * 50_000 + "\n", "LTL803", "line 2: column `scan`"),
        ("time,v\n,1\n", "LTL804", "line 2: `` is not a time in seconds"),
        ("time,v\nnan,1\n", "LTL804", "line 2: `nan` is not a time in seconds"),
        ("time,v\n1,1\n\n0.5,1\n", "LTL804", "line 4: time goes back from 1 to 0.5"),
        ("time,v\n0,1\n1700000000,1\n", "LTL804", "line 3: time jumps from 0 to 1700000000, by more than a year"),
        ("time,v\n1e999999999,1\n", "LTL804", "line 2: `1e999999999` is not a time in seconds"),
        ("time,v\n1e308,1\n", "LTL804", "line 2: `1e308` is not a time in seconds"),
        (b"time,v\n0,\xff\n", "LTL903", "is not UTF-8"),
    ],
)
def test_what_is_wrong_with_a_csv_recording_is_told_with_its_place(
    tmp_path: Path, content: str | bytes, code: str, words: str
) -> None:
    found, message = problem(tmp_path, content)
    assert found == code
    assert words in message


def test_equal_times_are_allowed(tmp_path: Path) -> None:
    assert [row.time for row in rows(tmp_path, "time,v\n1,1\n1,2\n")] == [ns(1), ns(1)]


def test_a_recording_of_months_and_one_that_begins_today_are_fine(tmp_path: Path) -> None:
    assert len(rows(tmp_path, f"time,v\n1700000000,1\n{1700000000 + 300 * 86400},2\n")) == 2


def test_json_lines_are_objects_with_time_and_signals(tmp_path: Path) -> None:
    text = '{"time": 0, "v": 1, "mode": "a", "scan": [1, 2], "flag": true}\n\n{"v": null, "time": 0.5, "flag": 0}\n'
    assert rows(tmp_path, text, "run.jsonl") == [
        Row(0, {"v": 1.0, "mode": "a", "scan": (1.0, 2.0), "flag": True}),
        Row(ns(0.5), {"flag": False}),
    ]


def test_json_numbers_may_be_infinite_or_beyond_the_doubles(tmp_path: Path) -> None:
    lines = ('{"time": 0, "v": Infinity}', '{"time": 0, "v": "-inf"}', f'{{"time": 0, "v": {10**400}}}')
    found = values(tmp_path, "\n".join(lines), "run.jsonl")
    assert [value["v"] for value in found] == [math.inf, -math.inf, math.inf]


@pytest.mark.parametrize(
    ("content", "code", "words"),
    [
        ("[1]\n", "LTL802", "line 1: not a JSON object"),
        ('{"time": 0}\n{"time": 1,\n', "LTL802", "line 2: not JSON"),
        ('{"time": 0, "v": 1, "v": 2}\n', "LTL802", "line 1: `v` occurs twice"),
        ("[" * 100_000 + "\n", "LTL802", "line 1: unreadable JSON"),
        ('{"time": 0, "v": ' + "1" * 5000 + "}\n", "LTL802", "line 1: unreadable JSON"),
        ('{"v": 1}\n', "LTL804", "line 1: there is no `time`"),
        ('{"time": "now"}\n', "LTL804", 'line 1: `"now"` is not a time'),
        ('{"time": true}\n', "LTL804", "line 1: `true` is not a time"),
        ('{"time": 0, "v": true}\n', "LTL803", "line 1: `v`: `true` is not a number"),
        ('{"time": 0, "v": "1"}\n', "LTL803", 'line 1: `v`: `"1"` is not a number'),
        ('{"time": 0, "v": "-+inf"}\n', "LTL803", 'line 1: `v`: `"-+inf"` is not a number'),
        ('{"time": 1}\n{"time": 1e300}\n', "LTL804", "line 2: `1e300` is not a time in seconds"),
        ('{"time": 0, "mode": 1}\n', "LTL803", "line 1: `mode`: `1` is not a string"),
        ('{"time": 1}\n{"time": 0}\n', "LTL804", "line 2: time goes back"),
        (b'{"time": "\xff"}\n', "LTL903", "is not UTF-8"),
    ],
)
def test_what_is_wrong_with_a_jsonl_recording_is_told_with_its_place(
    tmp_path: Path, content: str | bytes, code: str, words: str
) -> None:
    found, message = problem(tmp_path, content, "run.jsonl")
    assert found == code
    assert words in message


@given(content=st.binary(max_size=60), name=st.sampled_from(["run.csv", "run.jsonl"]))
def test_no_file_whatever_is_in_it_gives_a_traceback(
    tmp_path_factory: pytest.TempPathFactory, content: bytes, name: str
) -> None:
    folder = tmp_path_factory.mktemp("any")
    for prefix in (b"", b"time,v\n0,", b'{"time": 0, "v": '):
        with contextlib.suppress(RecordingError):
            rows(folder, prefix + content, name)


@pytest.mark.parametrize("name", ["run.txt", "run", "run.zstd"])
def test_other_forms_are_refused(tmp_path: Path, name: str) -> None:
    assert problem(tmp_path, "", name)[0] == "LTL807"


def test_a_folder_without_a_bag_is_refused_and_what_is_not_there_is_not_found(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="is not a recording"):
        open_recording(tmp_path, signals(TYPES))
    with pytest.raises(RecordingError, match="no file"):
        open_recording(tmp_path / "none.csv", signals(TYPES))


def test_rows_are_read_one_by_one(tmp_path: Path) -> None:
    """A mistake at the end shows only once it is reached: nothing is read ahead, whatever the size of the file."""
    path = tmp_path / "run.csv"
    path.write_text("time,v\n" + "0,1\n" * 100_000 + "x,1\n")
    found = stream(path)
    assert next(found) == Row(0, {"v": 1.0})
    with pytest.raises(RecordingError, match="line 100002"):
        list(found)


DISTANCE = "object robot /gt Odometry\nobject sign at (3, 4, 0)\nclose: never robot.distance.sign < 1\n"


def judged(folder: Path, text: str, recording: str, name: str = "run.csv") -> RunReport:
    path = folder / name
    path.write_text(recording)
    return run(*from_text(text), path, keep_verdicts=True)


def verdicts(report: RunReport) -> list[str]:
    assert report.session is not None
    [track] = report.session.tracks
    return [verdict.value for verdict in track.verdicts or []]


def test_a_signal_is_read_from_its_own_column(tmp_path: Path) -> None:
    report = judged(tmp_path, DISTANCE, "time,robot.distance.sign\n0,5\n1,0.5\n")
    assert verdicts(report) == ["presumably_satisfied", "violated"]
    assert report.exit_code == 1


def test_or_computed_from_the_columns_of_its_parts(tmp_path: Path) -> None:
    report = judged(tmp_path, DISTANCE, "time,robot.position.x,robot.position.y\n0,0,0\n1,3,\n2,,4\n")
    assert verdicts(report) == ["presumably_satisfied", "presumably_satisfied", "violated"]
    assert report.diagnostics == ()


def test_a_column_of_its_own_wins_over_those_of_the_parts_and_that_is_said(tmp_path: Path) -> None:
    report = judged(tmp_path, DISTANCE, "time,robot.position.x,robot.distance.sign\n0,0,0.5\n")
    assert verdicts(report) == ["violated"]
    [remark] = report.diagnostics
    assert remark.code == "LTL805"
    assert remark.message.startswith("no property reads the column `robot.position.x`")


def test_a_row_is_a_step_only_of_properties_with_a_cell_in_it(tmp_path: Path) -> None:
    text = (
        "decl x /a Odometry.pose.pose.position.x\ndecl y /b Odometry.pose.pose.position.y\nnever x > 1\nnever y > 1\n"
    )
    report = judged(tmp_path, text, "time,x,y\n0,0,0\n1,0,\n2,,\n3,,0\n4,0,0\n")
    assert report.session is not None
    assert [track.steps for track in report.session.tracks] == [3, 3]


def test_with_a_rate_rows_are_sampled(tmp_path: Path) -> None:
    report = judged(tmp_path, "_rate_ = 2\n" + DISTANCE, "time,robot.distance.sign\n0,5\n0.2,0.5\n0.4,5\n2,5\n")
    assert verdicts(report) == ["presumably_satisfied"] * 5


def test_verdicts_are_kept_only_as_far_as_they_can_be_listed(tmp_path: Path) -> None:
    text = "_rate_ = 1000\n" + DISTANCE
    report = judged(tmp_path, text, "time,robot.distance.sign\n0,5\n20000,5\n")
    assert (report.exit_code, [d.code for d in report.diagnostics]) == (2, ["LTL804"])
    compiled, specification = from_text(text)
    report = run(compiled, specification, tmp_path / "run.csv")
    assert report.session is not None
    assert report.session.tracks[0].steps == 20_000_001
    ends = judged(tmp_path, "_timeout_ = 1\n" + text, "time,robot.distance.sign\n0,5\n20000,5\n")
    assert len(verdicts(ends)) == 1001


def test_the_timeout_ends_the_recording(tmp_path: Path) -> None:
    report = judged(tmp_path, "_timeout_ = 1\n" + DISTANCE, "time,robot.distance.sign\n0,5\n1,5\n1.5,0.5\n")
    assert verdicts(report) == ["presumably_satisfied"] * 2


def test_a_signal_without_a_column_leaves_its_property_not_started_and_is_reported(tmp_path: Path) -> None:
    report = judged(tmp_path, DISTANCE, "time,robot.distance.sgin\n0,5\n")
    assert verdicts(report) == []
    assert report.exit_code == 3
    unknown, missing = report.diagnostics
    assert (unknown.code, unknown.help) == ("LTL805", "did you mean `robot.distance.sign`?")
    assert (missing.code, missing.help) == ("LTL806", "did you mean `robot.distance.sgin`?")
    assert missing.primary is not None


def test_what_is_computed_from_one_missing_column_is_reported_with_it_once(tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text("time,v\n0,1\n", encoding="utf-8")
    declared = "decl v /v Float64.data\ndecl w /w Float64.data\n"
    for read in (
        "@{w > 1, -1} and @{w > 2, -2}",
        "@{w > 1, -1} and w > v",
        "w > @{w, when w > 1} and @{w - v, -1} > 0",
    ):
        compiled, specification = from_text(f"{declared}never v > 1 and {read}\n")
        report = run(compiled, specification, tmp_path / "run.csv")
        assert [found.code for found in report.diagnostics] == ["LTL806"]


def test_a_column_without_a_value_leaves_its_property_not_started(tmp_path: Path) -> None:
    report = judged(tmp_path, DISTANCE, "time,robot.distance.sign\n0,\n")
    assert report.exit_code == 3
    assert "no value of robot.distance.sign" in report.text()


@pytest.mark.parametrize("name", ["run.csv", "run.parquet", "run.mcap"])
def test_a_pipe_is_refused_and_not_waited_for(tmp_path: Path, name: str) -> None:
    os.mkfifo(tmp_path / name)
    report = run(*from_text(DISTANCE), tmp_path / name)
    assert [each.code for each in report.diagnostics] == ["LTL807"]


def test_an_unusable_recording_gives_no_verdict(tmp_path: Path) -> None:
    report = judged(tmp_path, DISTANCE, "time,robot.distance.sign\n0,x\n")
    assert (report.exit_code, report.text()) == (2, "")
    assert json.loads(report.json())["properties"] is None
    suite = ElementTree.fromstring(report.junit())
    assert [(case.get("name"), case[0].tag, case[0].get("type")) for case in suite.findall("testcase")] == [
        ("recording", "error", "LTL803")
    ]


def test_a_damaged_recording_is_judged_up_to_the_damage(tmp_path: Path) -> None:
    report = judged(tmp_path, DISTANCE, "time,robot.distance.sign\n0,0.5\n1,x\n")
    assert (report.exit_code, report.is_damaged, [d.code for d in report.diagnostics]) == (2, True, ["LTL803"])
    assert "close: violated at +0 s" in report.text()


@pytest.mark.parametrize(
    ("since", "until", "steps"), [(None, None, 4), (ns(1.0), None, 3), (None, ns(1.5), 2), (ns(0.5), ns(2.0), 2)]
)
def test_rows_outside_of_the_times_asked_for_are_not_taken(
    tmp_path: Path, since: int | None, until: int | None, steps: int
) -> None:
    path = tmp_path / "run.csv"
    path.write_text("time,robot.distance.sign\n0,5\n1,5\n2,5\n3,5\n")
    session = run(*from_text(DISTANCE), path, since=since, until=until).session
    assert session is not None
    assert session.tracks[0].steps == steps


@pytest.mark.parametrize(("since", "until"), [(ns(9.0), None), (None, ns(-1.0))])
def test_a_recording_that_has_nothing_at_the_times_asked_for_is_an_error(
    tmp_path: Path, since: int | None, until: int | None
) -> None:
    path = tmp_path / "run.csv"
    path.write_text("time,robot.distance.sign\n0,5\n1,5\n")
    report = run(*from_text(DISTANCE), path, since=since, until=until)
    assert (report.session, [d.code for d in report.diagnostics]) == (None, ["LTL804"])


def test_both_forms_of_a_recording_give_the_same_report(tmp_path: Path) -> None:
    lines = [
        '{"time": 0, "robot.position.x": 0, "robot.position.y": 0}',
        '{"time": 1, "robot.position.x": 3}',
        '{"time": 2, "robot.position.y": NaN}',
        '{"time": 3, "robot.position.y": 4, "robot.position.x": null}',
    ]
    csv = "time,robot.position.x,robot.position.y\n0,0,0\n1,3,\n2,,nan\n3,,4\n"
    one = judged(tmp_path, DISTANCE, "\n".join(lines), "run.jsonl")
    other = judged(tmp_path, DISTANCE, csv)
    first, second = (report.document() | {"recording": "", "provenance": {}} for report in (one, other))
    assert first == second
    assert one.text() == other.text()


def fixture_report() -> RunReport:
    compiled, specification = from_text((FIXTURES / "props.txt").read_text())
    return run(compiled, specification, FIXTURES / "run.csv", keep_verdicts=True)


def test_the_text_report_is_as_recorded() -> None:
    assert fixture_report().text() == (FIXTURES / "report.txt").read_text()


def test_the_json_report_is_as_recorded() -> None:
    found = json.loads(fixture_report().json())
    assert found.pop("recording") == str(FIXTURES / "run.csv")
    assert found.pop("provenance")["recordings"][0]["name"] == "run.csv"
    assert found == json.loads((FIXTURES / "report.json").read_text())


def test_the_junit_report_has_a_case_for_each_property() -> None:
    suite = ElementTree.fromstring(fixture_report().junit())
    assert (suite.get("tests"), suite.get("failures"), suite.get("errors")) == ("7", "3", "1")
    outcomes = {case.get("name"): [child.tag for child in case] for case in suite.findall("testcase")}
    assert outcomes["stop_at_sign"] == ["failure"]
    assert outcomes["no_speeding"] == ["system-out"]
    assert outcomes["low_battery"] == ["error"]


def test_reports_show_no_character_that_a_terminal_acts_on(tmp_path: Path) -> None:
    text = 'decl m /m std_msgs/String.data\nnever m == "\u202e\x1b[2J<&]]>"\n'
    report = judged(tmp_path, text, "time,m\n0,\u202e\x1b[2J<&]]>\n")
    assert report.exit_code == 1
    for shown in (report.text(), report.junit()):
        assert all(character == "\n" or character.isprintable() for character in shown)
    [case] = ElementTree.fromstring(report.junit()).findall("testcase")
    assert "<&]]>" in (case[0].text or "")


def test_infinite_values_do_not_break_json(tmp_path: Path) -> None:
    report = judged(tmp_path, "never robot.position.x < 0", "time,robot.position.x\n0,-inf\n")
    [found] = json.loads(report.json())["properties"]
    assert found["decided_at"]["values"] == {"robot.position.x": "-inf"}


def test_a_negative_distance_in_a_recording_is_refused_because_monitors_rely_on_it(tmp_path: Path) -> None:
    report = judged(tmp_path, DISTANCE, "time,robot.distance.sign\n0,1\n0.5,-3\n")
    assert report.exit_code == 2
    assert [(d.code, "-3" in d.message) for d in report.diagnostics] == [("LTL803", True)]


def test_a_specification_with_an_error_is_not_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "props.txt").write_text("decl x /x Float64.data\nnever x >\n")
    (tmp_path / "run.csv").write_text("time,x\n0,1\n")
    assert main(["run", str(tmp_path / "props.txt"), str(tmp_path / "run.csv")]) == 2
    shown = capsys.readouterr()
    assert "error[LTL006]" in shown.err
    assert shown.out == ""


def test_that_the_rows_of_a_table_have_no_headers_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "props.txt").write_text("decl v /v std_msgs/Float64.data\nnever v > 2\n")
    (tmp_path / "run.csv").write_text("time,v\n0,1\n")
    assert main(["run", "--stamp", "header", str(tmp_path / "props.txt"), str(tmp_path / "run.csv")]) == 0
    assert "warning[LTL815]: the rows of a table have no headers" in capsys.readouterr().err


def test_a_table_from_a_spreadsheet_is_judged_once_it_is_changed_as_the_page_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    page = (Path(__file__).parents[1] / "docs" / "recordings.md").read_text(encoding="utf-8")
    code = page.partition("**From a spreadsheet.**")[2].partition("\n\n")[2].partition("\n## ")[0]
    monkeypatch.chdir(tmp_path)
    Path("drive.csv").write_text("Zeit;speed\n27.11.2026 10:00:00;0,5\n27.11.2026 10:00:01;\n27.11.2026 10:00:02;2,5\n")
    Path("props.txt").write_text("decl speed /speed Float64.data\nlimit: never speed > 2\n")
    exec(textwrap.dedent(code), {})
    assert main(["run", "props.txt", "drive.parquet"]) == 1
    assert "limit: violated at +2 s (step 1); 2 steps" in capsys.readouterr().out
