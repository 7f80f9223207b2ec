"""`ltlc compare ONE TWO`: a run that is shown makes the difference, and where none is shown, there is none."""

from __future__ import annotations

import json
import random
import re
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from itertools import permutations
from pathlib import Path

import pytest
from effort import share_of, some_of

import ltlc
from benchmarks.guarded import CMD, EXAMPLES, SCAN, SCANS, SPEEDS, Driven, Example
from ltlc.analysis.examples import Example as Shown
from ltlc.analysis.guards.trying import Trial
from ltlc.automata import Budget
from ltlc.cli import main
from ltlc.interfaces.api.compare_guards import OutCompared, compare_guards
from ltlc.runtime.guarding import Action, Deed

TEXTS = {
    "near": EXAMPLES["near"].text,
    "within": CMD + SCAN + "p: always (min(scan) < 0.5 implies eventually speed <= 0.2 within 100 ms)",
    "longer": CMD + SCAN + "p: always (min(scan) < 0.5 implies eventually speed <= 0.2 within 200 ms)",
    "strict": CMD + SCAN + "p: always (min(scan) < 0.5 implies speed <= 0.2)",
    "at once": EXAMPLES["near, an instant later"].text,
    "latched": CMD + SCAN + "p: after min(scan) < 0.5, always (not new speed or speed == 0)",
    "latched, and slow": CMD + SCAN + "p: after min(scan) < 0.5, always (not new speed or speed == 0)\n"
    "q: always (new speed implies speed <= 0.5)",
    "silent": CMD + SCAN + "p: always (age(scan) > 200 ms implies speed == 0)\nq: never min(scan) < 0 and speed > 9",
    "silent, later": CMD
    + SCAN
    + "r: always (age(scan) > 250 ms implies speed == 0)\nq: never min(scan) < 0 and speed > 9",
    "slew": CMD + SCAN + "p: always abs(speed - @{speed, -1 else 0}) <= 0.25\nq: never (new scan and min(scan) > 9)",
    "no fallback": CMD.replace(" else stop", "")
    + SCAN
    + "p: always (new speed and min(scan) < 0.5 implies speed <= 0.2)",
}


PAIRS = some_of(permutations(TEXTS, 2), 1)

HOT, TURN = EXAMPLES["no faster than when it got hot"].text, "decl turn /turn std_msgs/Float64.data\n"
RATE, FLAG = EXAMPLES["rate of commands"].text, "decl hot /hot std_msgs/Bool.data\n"
TRIED = {
    "counts": (
        CMD + "p: always (new speed implies not once new speed 3 times within 60 ms)",
        CMD + "p: always (new speed implies not once new speed 3 times within 50 ms)",
    ),
    "openings": (HOT, HOT.replace("opening})", "opening} + 0.1)")),
    "several signals": (
        CMD + TURN + "p: always (new speed implies abs(speed + turn) <= 1)",
        CMD + TURN + "p: always (new speed implies speed + turn <= 1)",
    ),
    "several clocks": (RATE.replace("20 ms", "30 ms"), RATE),
    "one instant": (
        CMD + FLAG + "p: never (previously new hot and speed >= 1)",
        CMD + FLAG + "p: never (hot and speed >= 9)",
    ),
}
"""By what the game does not decide: two guards of which the second lets a command through that the first does not."""


@cache
def driven(name: str) -> Driven:
    """The guard of that name, to be driven."""
    return Driven(Example(TEXTS[name], SPEEDS | SCANS))


def passes(name: str, rows: list[tuple[int, dict[str, object]]]) -> list[bool]:
    """Whether the guard of that name lets each command through, of messages that come at these times."""
    run = driven(name).begun()
    for time, values in rows:
        run.row(time, values, ())
    return [each.deed.action is Action.PASSED for each in run.done if each.deed.command is not None]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the files."""
    found = tmp_path_factory.mktemp("guards")
    for name, text in TEXTS.items():
        (found / name).write_text(text, encoding="utf-8")
    return found


@cache
def compared(folder: Path, one: str, two: str) -> OutCompared:
    (found,) = compare_guards(folder / one, folder / two, (), (), Budget()).topics
    return found


@pytest.mark.parametrize(("one", "two"), PAIRS)
def test_the_run_that_is_shown_makes_the_difference(folder: Path, one: str, two: str) -> None:
    for difference in compared(folder, one, two).differences:
        if difference.example is None:
            continue
        if difference.by_trying:
            assert lets_last_through(difference.passes, difference.example), difference
            assert not lets_last_through(difference.refuses, difference.example), difference
            continue
        columns, rows = difference.example.signals, list[tuple[int, dict[str, object]]]()
        shown = list(zip(difference.example.steps, difference.example.remarks, strict=True))
        time, first = 1_000_000_000, dict(zip(columns, shown[0][0], strict=True))
        if "/scan" not in shown[1][1]:
            rows.append((time, {"scan": tuple(map(float, first["scan"]))}))
        for step, remark in shown[1:]:
            values = dict(zip(columns, step, strict=True))
            time += 1
            if "/scan" in remark:
                rows.append((time, {"scan": tuple(map(float, values["scan"]))}))
            elif "/cmd_vel" in remark:
                rows.append((time, {"speed": float(values["speed"])}))
            elif later := re.match(r"more than (\d+) ms later", remark):
                time += int(later[1]) * 1_000_000
        assert passes(Path(difference.passes).name, rows)[-1], difference
        assert not passes(Path(difference.refuses).name, rows)[-1], difference


@pytest.mark.parametrize("name", TRIED)
def test_a_run_is_found_by_trying_where_the_game_of_both_finds_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    # Whether z3 finds numbers within its limits also depends on what it was asked before.
    monkeypatch.setattr(Trial, "checked", lambda _, difference: replace(difference, example=None))
    for file, text in zip(("one", "two"), TRIED[name], strict=True):
        (tmp_path / file).write_text(text, encoding="utf-8")
    first, *_ = compare_guards(tmp_path / "one", tmp_path / "two", (), (), Budget()).topics
    difference = {each.passes: each for each in first.differences}[str(tmp_path / "two")]
    assert difference.by_trying
    assert difference.example is not None
    assert lets_last_through(str(tmp_path / "two"), difference.example)
    assert not lets_last_through(str(tmp_path / "one"), difference.example)
    assert len(difference.example.steps) <= 4


@pytest.mark.parametrize(
    ("one", "two"),
    [
        (HOT, HOT),
        (RATE, RATE),
        (TRIED["counts"][0], TRIED["counts"][0]),
        (TRIED["several signals"][1], TRIED["several signals"][1].replace("speed + turn", "turn + speed")),
    ],
)
def test_no_run_is_found_for_guards_that_are_equal(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], one: str, two: str
) -> None:
    files = [tmp_path / "one", tmp_path / "two"]
    for file, text in zip(files, (one, two), strict=True):
        file.write_text(text, encoding="utf-8")
    code = main(["compare", *map(str, files), "--format", "json"])
    (of_cmd,) = json.loads(capsys.readouterr().out)["guards"]
    assert all(each["example"] is None for each in of_cmd["differences"])
    assert code == (3 if of_cmd["undecided"] or of_cmd["differences"] else 0)


def test_a_run_that_was_found_parts_the_guards_on_a_recording_too(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = [str(tmp_path / "one"), str(tmp_path / "two")]
    for file, text in zip(files, TRIED["openings"], strict=True):
        Path(file).write_text(text, encoding="utf-8")
    assert main(["compare", *files, "--format", "json"]) == 3
    (of_cmd,) = json.loads(capsys.readouterr().out)["guards"]
    ((passes, example),) = [(each["passes"], each["example"]) for each in of_cmd["differences"]]
    rows = [
        row_of([*step["values"]], [*step["values"].values()], step["remark"])
        | {"time": f"{1 + step['time_ns'] * 1e-9:.9f}"}
        for step in example["steps"]
    ]
    recording = tmp_path / "r.csv"
    columns = ["time", "hot", "/cmd_vel_raw/linear/x"]
    lines = [columns, *([str(row.get(column, "")).lower() for column in columns] for row in rows)]
    recording.write_text("".join(f"{','.join(line)}\n" for line in lines), encoding="utf-8")
    last = []
    for file in files:
        main(["run", "--guard", "--format", "json", file, str(recording)])
        (found,) = json.loads(capsys.readouterr().out)["guard"]
        last.append(
            max((each["time"] for each in found["passed"]), default=0)
            == pytest.approx(float(str(rows[-1]["time"])), abs=1e-10)
        )
    assert (passes, last) == (files[1], [False, True])
    assert main(["compare", *files]) == 3
    shown = capsys.readouterr().out
    assert (
        f"{files[1]} lets a command through that {files[0]} does not (found by trying): it would violate `p`" in shown
    )
    assert re.search(rf"no run found in which {files[0]} lets .* does not: {of_cmd['tried']} tried; not decided", shown)
    assert "one of them counts, or reads values at openings" in shown


def lets_last_through(file: str, example: Shown) -> bool:
    """Whether, row by row, the guard of a file lets the last command through of a run that was found by trying."""
    run, deeds = ltlc.guard(Path(file)), list[Deed]()
    rows = zip(example.times, example.steps, example.remarks, strict=True)
    for time, step, remark in (row for number, row in enumerate(rows) if number not in example.by_time):
        while run.due is not None and run.due <= time:
            run.step({}, time_ns=run.due)
        deeds = run.step(row_of(example.signals, step, remark), time_ns=time)
    return [each.action for each in deeds if each.command is not None] == [Action.PASSED]


def row_of(signals: Sequence[str], step: Sequence[object], remark: str) -> dict[str, object]:
    """What a row of a run says that was found by trying: on a topic, the signals that are called like it."""
    values = dict(zip(signals, step, strict=True))
    if "a command on /cmd_vel" in remark:
        return {"/cmd_vel_raw/linear/x": values["speed"]}
    return {name: value for name, value in values.items() if remark.endswith(f"/{name}")}


@pytest.mark.parametrize(("one", "two"), PAIRS)
def test_where_no_run_is_shown_none_makes_a_difference(folder: Path, one: str, two: str) -> None:
    found = compared(folder, one, two)
    if found.undecided or str(folder / one) in {each.passes for each in found.differences}:
        return
    for seed in range(share_of(10)):
        drawn = list(driven(one).rows(random.Random(seed), 60))
        runs = [driven(name).begun() for name in (one, two)]
        for time, values in drawn:
            for run in runs:
                run.row(time, values, ())
            left, right = ([(d.deed.time, d.deed.action, d.deed.values) for d in run.done] for run in runs)
            if left != right:
                last = [run.done[-1].deed.action is Action.PASSED for run in runs if "speed" in values]
                assert last != [True, False], (seed, time)
                break


def test_most_of_these_are_compared_to_the_end(folder: Path) -> None:
    found = [compared(folder, *pair) for pair in PAIRS]
    assert sum(not each.undecided for each in found) > len(found) / 2
    assert sum(d.example is not None for each in found for d in each.differences) > len(found) / 2


def test_two_guards_are_compared_on_a_recording_command_by_command(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("near", "within"):
        (tmp_path / name).write_text(TEXTS[name], encoding="utf-8")
    rows = [
        {"time": 1, "scan": [0.3]},
        {"time": 2, "/cmd_vel_raw/linear/x": 1},
        {"time": 3, "/cmd_vel_raw/linear/x": 0.1},
    ]
    recording = tmp_path / "r.jsonl"
    recording.write_text("".join(f"{json.dumps(row)}\n" for row in rows), encoding="utf-8")
    files = [str(tmp_path / "near"), str(tmp_path / "within")]
    assert main(["compare", *files, "--recording", str(recording), "--format", "json"]) == 0
    (of_cmd,) = json.loads(capsys.readouterr().out)["guards"]
    (on_recording,) = of_cmd["recordings"]
    assert [(each["passed"], each["changed"]) for each in on_recording["counts"]] == [(1, 1), (2, 0)]
    ((left, right),) = on_recording["differences"]
    assert (left["action"], left["reason"], right["action"]) == ("changed", "it would violate `q`", "passed")
    assert [each["passes"] for each in of_cmd["differences"]] == [files[1]]
    assert main(["compare", *files, "--recording", str(recording)]) == 0
    shown = capsys.readouterr().out
    assert f"{files[1]} lets a command through that {files[0]} does not: it would violate `q`" in shown
    assert f"{files[0]} lets nothing through that {files[1]} does not" in shown


@pytest.mark.parametrize(
    ("other", "options", "said"),
    [
        ("decl v /v std_msgs/Float64.data\nnever v > 1", (), "has no guard"),
        (CMD.replace("/cmd_vel", "/other") + "never speed > 1", (), "no guard of"),
        (TEXTS["near"], ("--format", "csv"), "compared without --format csv"),
        (TEXTS["near"], ("--encodings", "dwyer"), "compared without --encodings"),
    ],
)
def test_what_cannot_be_compared_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], other: str, options: tuple[str, ...], said: str
) -> None:
    (tmp_path / "one").write_text(TEXTS["near"], encoding="utf-8")
    (tmp_path / "two").write_text(other, encoding="utf-8")
    assert main(["compare", str(tmp_path / "one"), str(tmp_path / "two"), *options]) == 2
    assert said in capsys.readouterr().err


def test_a_file_with_an_error_is_reported_as_by_other_commands(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "one").write_text(TEXTS["near"], encoding="utf-8")
    (tmp_path / "two").write_text("never speed > 1", encoding="utf-8")
    assert main(["compare", str(tmp_path / "one"), str(tmp_path / "two")]) == 1
    assert "error[LTL101]" in capsys.readouterr().err


def test_a_name_that_means_two_things_is_not_compared(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "one").write_text(TEXTS["strict"], encoding="utf-8")
    (tmp_path / "two").write_text(
        TEXTS["strict"].replace("LaserScan.ranges", "LaserScan.intensities"), encoding="utf-8"
    )
    assert main(["compare", str(tmp_path / "one"), str(tmp_path / "two")]) == 3
    assert "is not the same condition in both files" in capsys.readouterr().out
