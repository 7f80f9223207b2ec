"""The functions of `ltlc` in Python: the same answers as the commands give."""

from __future__ import annotations

import doctest
import json
import math
import pickle
from collections.abc import Mapping
from decimal import Decimal
from importlib import import_module
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from columns_support import Draw
from hypothesis import given
from hypothesis import strategies as st

import ltlc
from ltlc.cli import main
from ltlc.inputs.recordings.given import time_given
from ltlc.interfaces.api.build import Build
from ltlc.runtime.times import seconds_text

SLOW = "decl speed /speed Float64.data\nslow: never speed > 2"
SOON = "decl speed /speed Float64.data\nsoon: always (speed > 2 implies eventually speed < 1 within 1 s)"
SCAN = "decl scan /scan LaserScan.ranges\nfree: min(scan) > 0.3"
NORM = "slow: never robot.velocity > 2"


@pytest.mark.parametrize("module", ["build", "check", "falsify", "guard", "monitor", "run"])
def test_the_examples_of_the_documentation_are_so(module: str) -> None:
    found = doctest.testmod(import_module(f"ltlc.interfaces.api.{module}"))
    assert found.failed == 0
    assert found.attempted > 2


def judged(document: Mapping[str, Any]) -> dict[str, Any]:
    """What a document says of the run, whatever that is called, and whether or not it is in a file."""
    return {key: value for key, value in document.items() if key not in ("recording", "provenance")}


def first_only(document: dict[str, Any]) -> dict[str, Any]:
    """The same without the violations after the first, which steps do not look for."""
    properties = [{key: value for key, value in each.items() if key != "violations"} for each in document["properties"]]
    return {**document, "properties": properties}


@pytest.mark.parametrize("seed", range(6))
def test_rows_and_steps_have_the_verdicts_of_the_same_rows_in_a_file(seed: int, tmp_path: Path) -> None:
    drawn = Draw(Random(seed)).drawn()
    came = [(row.time, row.values) for part in drawn.parts for row in part]
    path = tmp_path / "run.jsonl"
    rows = [(seconds_text(time), values) for time, values in came]
    lines = (json.dumps({"time": 0, **values}).replace("0", time, 1) for time, values in rows)
    path.write_text("".join(f"{line}\n" for line in lines))
    live = ltlc.monitor(drawn.text, signals=dict.fromkeys(name for _, row in came for name in row))
    changes = [change for time, values in came for change in live.step(values, time_ns=time)]
    stepped, (of_file, of_rows) = live.finish(), ltlc.run_each(drawn.text, [path, rows])
    assert judged(of_rows.document()) == judged(of_file.document())
    assert first_only(judged(stepped.document())) == first_only(judged(of_file.document()))
    assert live.verdicts == {**live.verdicts, **{change.property.label: change.current for change in changes}}


def test_a_step_says_what_has_changed_and_when() -> None:
    run = ltlc.monitor(SLOW)
    assert [(c.property.label, c.current) for c in run.step({"speed": 1}, 0.5)] == [
        ("slow", ltlc.Verdict.PRESUMABLY_SATISFIED)
    ]
    assert run.step({"speed": 1.5}, 0.6) == []
    [change] = run.step({"speed": 3}, "0.7")
    assert (change.current, change.moment.step, change.moment.time) == (ltlc.Verdict.VIOLATED, 2, 700_000_000)


@given(st.floats(-10, 3e6) | st.integers(0, 3 * 10**15).map(lambda time: time / 1e9) | st.floats(0, 4e9))
def test_a_time_is_what_it_is_written_as_to_the_nearest_nanosecond(seconds: float) -> None:
    exact = int(Decimal(repr(seconds)).quantize(Decimal("1e-9")).scaleb(9))
    for same in (seconds, np.float64(seconds), repr(seconds), Decimal(repr(seconds))):
        time = time_given(Path("run"), 1, None, same)
        assert (time, type(time)) == (exact, int)


def test_a_row_is_taken_as_what_it_has_whether_that_is_usual_or_not() -> None:
    text = SLOW + "\nfast: never robot.velocity > 2"
    usual, unusual = ltlc.monitor(text), ltlc.monitor(text)
    rows: list[dict[str, Any]] = [
        {"speed": 1.0, "robot.velocity": 1.0},
        {"speed": 2.0, "robot.velocity": 3.0},
        {"speed": 3.0},
    ]
    for number, row in enumerate(rows):
        wrapped = {name: np.float64(value) for name, value in row.items()}
        usual.step(row, float(number))
        unusual.step({**wrapped, "other": None}, float(number))
        assert unusual.verdicts == usual.verdicts
    assert [v.decided and v.decided.time for v in usual.violations] == [10**9, 2 * 10**9]
    for run in (usual, unusual):
        with pytest.raises(ltlc.UnusableInput, match="never negative"):
            run.step({"robot.velocity": -1.0}, 3.0)


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ({"speed": 1.0}, {"battery": 0.0}),
        ({"speed": 1.0, "other": 0.0}, {"speed": 1.0, "battery": 0.0}),
        ({"speed": 1.0, "other": 0.0}, {"battery": 0.0, "time": 0.5}),
        ({"speed": 1.0, "time": 0.0}, {"speed": 1.0, "battery": 0.0}),
    ],
)
def test_a_row_with_as_many_but_other_names_is_read_by_its_own(
    first: dict[str, float], second: dict[str, float]
) -> None:
    run = ltlc.monitor(SLOW + "\ndecl battery /battery Float64.data\nfull: never battery < 0.1")
    for row, time in ((first, 0.0), (second, 0.5)):
        run.step(row, None if "time" in row else time)
    [found] = run.violations
    assert (found.label, found.decided and found.decided.time) == ("full", 500_000_000)


def test_a_deadline_that_passes_between_two_steps_is_told_at_its_time() -> None:
    run = ltlc.monitor(SOON)
    run.step({"speed": 3}, Decimal("1700000000.1"))
    [change] = run.step({}, "1700000002")
    assert change.current is ltlc.Verdict.VIOLATED
    assert (change.moment.time, change.moment.by_time) == (1_700_000_001_100_000_001, True)


def test_what_is_owed_when_a_run_is_finished_is_told() -> None:
    run = ltlc.monitor(SOON)
    run.step({"speed": 3}, 0.0)
    run.step({"speed": 3}, 0.5)
    found = run.finish()
    assert found.exit_code == 3
    assert str(found["soon"]).startswith("soon: presumably violated; unmet since +0 s (step 0)")
    assert "0.5 s left" in found.text()


def test_a_run_that_is_reset_begins_before_its_first_row() -> None:
    run = ltlc.monitor(SLOW)
    run.step({"speed": 3}, 5.0)
    run.finish()
    run.reset()
    assert run.verdicts == {"slow": ltlc.Verdict.NOT_STARTED}
    run.step({"speed": 1}, 0.0)
    assert run.violations == []


def test_rows_without_times_are_taken_where_no_property_needs_them() -> None:
    run = ltlc.monitor(SLOW)
    run.step({"speed": 1})
    run.step({"speed": 3})
    assert run.violations[0].decided is not None
    assert run.violations[0].decided.step == 1
    whole = ltlc.run(SLOW, [{"speed": 1}, {"speed": 3}])
    assert first_only(judged(whole.document())) == first_only(judged(run.finish().document()))


POSES = "decl speed /speed Float64.data\nobject robot /pose PoseStamped\n"


@pytest.mark.parametrize("text", [f"{POSES}near: never robot.position.x > 2", NORM])
def test_rows_without_times_are_taken_where_no_rate_of_change_is_computed(text: str) -> None:
    run = ltlc.monitor(text)
    run.step({"robot.position.x": 1, "robot.velocity": 1})
    run.step({"robot.position.x": 3, "robot.velocity": 3})
    assert [each.verdict for each in run.violations] == [ltlc.Verdict.VIOLATED]


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (SOON, "row 1 has no time, and `soon` depends on it"),
        ("_rate_ = 10\n" + SLOW, "row 1 has no time, and `_rate_` and `_timeout_` count it"),
        ("_timeout_ = 5\n" + SLOW, "row 1 has no time, and `_rate_` and `_timeout_` count it"),
        (f"{POSES}quick: never robot.velocity.x > 2 and speed > 1", "row 1 has no time, and `quick` depends on it"),
        (f"{POSES}quick: never robot.velocity > 2 and speed > 1", "row 1 has no time, and `quick` depends on it"),
        (f"{POSES}slow: never speed > 2\nquick: never robot.velocity > 2", "row 1 has no time, and `quick` depends"),
    ],
)
def test_rows_without_times_are_refused_where_they_matter(text: str, reason: str) -> None:
    with pytest.raises(ltlc.UnusableInput, match=reason):
        ltlc.monitor(text).step({"speed": 1})
    with pytest.raises(ltlc.UnusableInput, match="there is no `time`"):
        ltlc.run(text, [{"speed": 1}])


@pytest.mark.parametrize(
    ("values", "time", "reason"),
    [
        ({"speed": "fast"}, 1.0, "is not a number"),
        ({"speed": True}, 1.0, "is not a number"),
        ({"speed": [1]}, 1.0, "is not a number"),
        ({"speed": 1}, 0.1, "time goes back from 0.5 to 0.1"),
        ({"speed": 1}, math.nan, "is not a time in seconds"),
        ({"speed": 1}, "soon", "is not a time in seconds"),
        ({"speed": 1, "time": 0.5}, 0.6, "a row has one time"),
        (None, 1.0, "row 2 is None; a row must be a mapping from signals to values"),
        ("speed", 1.0, "row 2 is 'speed'; a row must be a mapping"),
        ({"speed": 1}, 1e8, "by more than a year"),
        ({"speed": 1}, None, "row 2 has no time, but the rows before have one"),
    ],
)
def test_a_row_that_cannot_be_taken_is_as_if_it_had_not_come(values: Any, time: Any, reason: str) -> None:
    run = ltlc.monitor(SLOW)
    run.step({"speed": 1}, 0.5)
    with pytest.raises(ltlc.UnusableInput, match=reason):
        run.step(values, time)
    run.step({"speed": 3}, 0.5)
    assert run.violations[0].steps == 2


@pytest.mark.parametrize("value", [[0.5, 0.2], (0.5, 0.2), np.array([0.5, 0.2]), np.array([0.5, 0.2], np.float32)])
def test_arrays_are_lists_tuples_or_those_of_numpy(value: Any) -> None:
    run = ltlc.monitor(SCAN)
    run.step({"scan": value}, 0.0)
    assert run.verdicts == {"free": ltlc.Verdict.VIOLATED}


def test_elements_of_an_array_may_come_one_by_one() -> None:
    run = ltlc.monitor(SCAN)
    run.step({"scan[0]": 0.5, "scan[1]": 0.2, "scan[2]": None})
    assert run.verdicts == {"free": ltlc.Verdict.VIOLATED}
    with pytest.raises(ltlc.UnusableInput, match="`scan\\[0\\]` is empty"):
        run.step({"scan[0]": None, "scan[1]": 0.2, "scan[2]": 0.3})


def test_a_signal_that_is_computed_from_others_comes_itself_or_its_parts_do() -> None:
    whole, parts = ltlc.monitor(NORM), ltlc.monitor(NORM)
    whole.step({"robot.velocity": 3})
    parts.step({"robot.velocity.x": 2, "robot.velocity.y": 2, "robot.velocity.z": 0})
    assert whole.verdicts == parts.verdicts == {"slow": ltlc.Verdict.VIOLATED}


def test_a_signal_whose_parts_are_computed_too_is_made_of_what_comes() -> None:
    run = ltlc.monitor("object robot /odom Odometry\nturned: never robot.orientation > 1")
    half = {"robot.orientation.x": 0, "robot.orientation.y": 0, "robot.orientation.z": 1, "robot.orientation.w": 0}
    run.step(half)
    assert run.verdicts == {"turned": ltlc.Verdict.VIOLATED}


def test_a_whole_may_come_first_after_rows_of_others_but_its_parts_have_to_be_announced() -> None:
    text = "decl battery /battery Float64.data\nfresh: never battery < 0.1\n" + NORM
    late = {"robot.velocity.x": 3, "robot.velocity.y": 0, "robot.velocity.z": 0}
    run = ltlc.monitor(text)
    run.step({"battery": 1})
    run.step({"robot.velocity": 1})
    with pytest.raises(ltlc.UnusableInput, match=r"`robot.velocity.x` is unexpected.*announce it with `signals`"):
        run.step(late)
    run = ltlc.monitor(text, signals=["battery", *late])
    run.step({"battery": 1})
    run.step(late)
    assert [result.label for result in run.violations] == ["slow"]


def test_a_negative_speed_is_refused_as_in_a_recording() -> None:
    with pytest.raises(ltlc.UnusableInput, match=r"`robot.velocity` is -1\.0, but this quantity"):
        ltlc.monitor(NORM).step({"robot.velocity": -1})


def test_names_that_no_property_reads_are_told_at_the_end() -> None:
    run = ltlc.monitor(NORM)
    run.step({"robot.velocty": 1})
    assert [d.code for d in run.finish().diagnostics] == ["LTL805", "LTL806"]
    assert run.finish().exit_code == 3


def test_tables_of_arrow_are_read_as_those_in_parquet_files_are() -> None:
    table = pa.table({"time": [0.0, 0.5, 1.0], "speed": np.array([1, 2, 3], np.int16)})
    assert [str(v.decided.time) for v in ltlc.run(SLOW, table).violations if v.decided] == ["1000000000"]
    with pytest.raises(ltlc.UnusableInput, match="there is no column `time`"):
        ltlc.run(SLOW, pa.table({"speed": [1.0]}))


def test_rows_after_a_mistake_are_not_judged() -> None:
    rows: list[tuple[int, dict[str, object]]] = [(0, {"speed": 3}), (1, {"speed": "x"})]
    found = ltlc.run(SLOW, rows)
    assert found.is_damaged
    assert found.verdicts == {"slow": ltlc.Verdict.VIOLATED}
    assert "row 2: `speed`" in found.diagnostics[-1].message


def test_a_text_is_not_taken_for_a_file_nor_a_file_for_a_text(tmp_path: Path) -> None:
    path = tmp_path / "props.txt"
    path.write_text(SLOW)
    of_file, of_text = ltlc.check(path).properties[0], ltlc.check(SLOW).properties[0]
    assert (of_file.file, of_text.file, of_file.label) == (str(path), "specification", of_text.label)
    for use in (ltlc.check, ltlc.monitor, ltlc.compare):
        with pytest.raises(ltlc.UnusableInput, match=r"give a file as a path: `pathlib.Path\("):
            use(str(path))


@pytest.mark.parametrize("use", [ltlc.check, ltlc.build, ltlc.monitor, lambda text: ltlc.run(text, [])])
@pytest.mark.parametrize("text", [None, b"never robot.velocity > 2"])
def test_what_is_neither_a_text_nor_a_path_is_no_specification(use: Any, text: Any) -> None:
    with pytest.raises(
        ltlc.UnusableInput, match=f"{text!r} is not a specification; a specification is a string, or the"
    ):
        use(text)


def test_what_is_neither_a_file_nor_rows_nor_a_table_is_no_recording() -> None:
    with pytest.raises(ltlc.UnusableInput, match="None is not a recording: give a file, rows or a table"):
        ltlc.run(SLOW, None)  # type: ignore[arg-type]


def test_one_name_is_not_taken_for_the_names_of_signals() -> None:
    with pytest.raises(ltlc.UnusableInput, match=r"`signals` must be a list of names: `\['speed'\]`"):
        ltlc.monitor(SLOW, signals="speed")


def test_nanoseconds_are_whole() -> None:
    with pytest.raises(ltlc.UnusableInput, match=r"1\.5 is not a time in nanoseconds, a whole number"):
        ltlc.monitor(SLOW).step({"speed": 1}, time_ns=1.5)  # type: ignore[arg-type]


def test_what_is_raised_in_another_process_arrives_whole() -> None:
    with pytest.raises(ltlc.UnusableInput) as raised:
        ltlc.run("never robot.velocty > 2", [])
    sent = pickle.loads(pickle.dumps(raised.value))
    assert (str(sent), sent.diagnostics) == (str(raised.value), raised.value.diagnostics)


def test_what_is_wrong_with_a_specification_is_raised_as_data_and_as_text() -> None:
    with pytest.raises(ltlc.UnusableInput, match="did you mean `velocity`") as raised:
        ltlc.run("never robot.velocty > 2", [])
    [diagnostic] = raised.value.diagnostics
    assert diagnostic.code == "LTL105"
    assert "--> specification:1:13" in str(raised.value)


def test_check_says_in_python_what_the_command_says(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "props.txt"
    path.write_text("a: never robot.velocity >= 0\nb: never robot.velocity > 2\n")
    main(["check", str(path), "--format", "json"])
    found = ltlc.check(path)
    assert found.document() == json.loads(capsys.readouterr().out)
    assert [(p.label, p.can_hold, p.can_fail) for p in found.properties] == [("a", False, True), ("b", True, True)]
    assert ltlc.check(tmp_path / "missing.txt").diagnostics[0].code == "LTL901"


def test_nothing_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    ltlc.check("never robot.velocty > 2")
    ltlc.run(SLOW, [{"speed": 3, "odd": 1}])
    ltlc.monitor(SLOW).finish()
    assert capsys.readouterr() == ("", "")


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Build:
    """Built from a file, to be written beside it."""
    folder = tmp_path_factory.mktemp("built")
    (folder / "props.txt").write_text(SLOW)
    return ltlc.build(folder / "props.txt", "hoa", output=folder / "slow.hoa")


def test_build_gives_the_text_that_the_command_writes(
    built: Build, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    [path] = built.files
    written, proof = tmp_path / "slow.hoa", tmp_path / "proof.txt"
    specification = str(path.parent / "props.txt")
    assert main(["build", specification, "--target", "hoa", "-o", str(written), "--certificate", str(proof)]) == 0
    assert (built.text, built.certificates) == (written.read_text(), proof.read_text())
    assert capsys.readouterr().out.startswith(f"{built}\n")


def test_a_build_is_written_where_its_output_was_said_to_be(built: Build) -> None:
    [path] = built.write()
    assert (path.name, path.read_text()) == ("slow.hoa", built.text)


def test_an_output_that_cannot_be_written_is_refused(built: Build) -> None:
    [path] = built.files
    path.unlink(missing_ok=True)
    path.mkdir()
    with pytest.raises(IsADirectoryError):
        built.write()
    assert list(path.iterdir()) == []
    path.rmdir()


def test_what_the_gate_refuses_is_not_built() -> None:
    recent = "decl seen /seen Bool.data\nrecent: within 1 s, always once seen within 3 s\n"
    with pytest.raises(ltlc.UnusableInput, match=r"error\[LTL705\]: the monitor of `recent` is not certified"):
        ltlc.build(recent, "hoa")
    with pytest.raises(ltlc.UnusableInput, match="there is no target `ros`: did you mean `ros2`"):
        ltlc.build(SLOW, "ros")


def test_names_that_are_no_strings_are_refused() -> None:
    with pytest.raises(ltlc.UnusableInput, match="`3` is not the name of a signal"):
        ltlc.run(SLOW, [{3: 1.0}])  # type: ignore[arg-type]
    with pytest.raises(ltlc.UnusableInput, match="`3` is not the name of a signal"):
        ltlc.monitor(SLOW).step({3: 1.0})  # type: ignore[dict-item]


def test_the_types_are_shipped() -> None:
    assert (Path(ltlc.__file__).parent / "py.typed").is_file()


def test_a_first_row_that_cannot_be_taken_does_not_say_which_signals_come_in() -> None:
    run = ltlc.monitor(NORM)
    with pytest.raises(ltlc.UnusableInput, match="is not a number"):
        run.step({"robot.velocity.x": "fast"})
    run.step({"robot.velocity": 3})
    assert run.verdicts == {"slow": ltlc.Verdict.VIOLATED}


def test_every_public_name_is_there() -> None:
    assert all(getattr(ltlc, name).__module__.startswith("ltlc.") for name in ltlc.__all__)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"encoding": None}, "there is no encoding `None`: the encodings are episode"),
        ({"message_paths": "msgs"}, r"`message_paths` must be a list of folders: `\['msgs'\]`"),
        ({"encoding": "episod"}, r"there is no encoding `episod`: did you mean `episode`\?"),
        ({"since": "noon"}, "'noon' is not a time in seconds, such as 12.5"),
        ({"stamp": "sent"}, "`sent` is not a time of a message: use `log` or `header`"),
        ({"since": 5}, "the recording ends before the time of `--from`"),
    ],
)
def test_options_that_cannot_be_are_refused_with_what_could_be(options: dict[str, Any], told: str) -> None:
    with pytest.raises(ltlc.UnusableInput, match=told):
        ltlc.run(SLOW, [(0, {"speed": 1})], **options)


def test_a_check_answers_whether_a_controller_can_keep_the_properties() -> None:
    text = "decl v /cmd_vel Twist.linear.x\np: always v <= 1\n"
    assert [each.code for each in ltlc.check(text, controls=["/cmd_vel"]).diagnostics] == ["LTL617"]
    with pytest.raises(ltlc.UnusableInput, match="did you mean `/cmd_vel`"):
        ltlc.check(text, controls=["/cmd_vl"])


def test_a_check_prints_its_findings_and_what_each_property_can_do() -> None:
    told = str(ltlc.check("a: never robot.velocity >= 0\nb: never robot.velocity > 2\n")).splitlines()
    assert told[0].startswith("error[LTL501]")
    assert told[-2:] == ["a: cannot hold", "b: can hold, can fail"]
