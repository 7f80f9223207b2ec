"""`ltlc compare ONE TWO`: a run that is shown makes the difference, and where none is shown, there is none."""

from __future__ import annotations

import json
import random
import re
from functools import cache
from itertools import permutations
from pathlib import Path

import pytest
from effort import share_of

from benchmarks.guarded import CMD, EXAMPLES, SCAN, SCANS, SPEEDS, Driven, Example
from ltlc.automata import Budget
from ltlc.cli import main
from ltlc.interfaces.api.compare_guards import OutCompared, compare_guards
from ltlc.runtime.guarding import Action

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


PAIRS = list(permutations(TEXTS, 2))


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
