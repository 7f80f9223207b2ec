"""By how much properties hold, as users see it: text, JSON and Python."""

from __future__ import annotations

import base64
import json
import math
import zlib
from collections.abc import Sequence
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from effort import share_of
from stepping import from_text

import ltlc
from ltlc.cli import main
from ltlc.interfaces.api.monitor import LiveRun
from ltlc.interfaces.pages.report import PageReport
from ltlc.monitoring.judging.run import Judge

PROPS = """
decl speed /speed std_msgs/Float64.data
decl armed /armed std_msgs/Bool.data

slow: never speed > 2
calm: never speed > 1 and not armed
seen: after armed, eventually armed
late: always age(speed) <= 9 s
none: eventually @{speed, -9} > 1
"""


@pytest.fixture
def drive(tmp_path: Path) -> Path:
    (tmp_path / "props.txt").write_text(PROPS, encoding="utf-8")
    (tmp_path / "drive.csv").write_text(
        "time,speed,armed\n10,0.5,true\n11,1.25,false\n12,1.75,true\n", encoding="utf-8"
    )
    return tmp_path


def ran(folder: Path, *options: str) -> int:
    return main(["run", str(folder / "props.txt"), str(folder / "drive.csv"), *options])


def test_text_ranks_what_is_violated_most_first(drive: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert ran(drive, "--robustness") == 1
    told = capsys.readouterr().out.partition("\nRobustness:\n")[2]
    assert told.splitlines() == [
        "  calm: -0.25 at +1 s: speed > 1",
        "  slow: 0.25 at +2 s: speed > 2",
        "  seen: none: no comparison of numbers decides it",
        "  late: none: no comparison of numbers decides it",
        "  none: none: not started",
    ]


def test_a_margin_of_nothing_has_no_sign(drive: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (drive / "props.txt").write_text("decl speed /speed std_msgs/Float64.data\nnever speed > 1.75\n", encoding="utf-8")
    assert ran(drive, "--robustness") == 0
    assert "  line 2: 0 at +2 s: speed > 1.75\n" in capsys.readouterr().out


def test_json_has_the_margin_or_why_there_is_none(drive: Path, capsys: pytest.CaptureFixture[str]) -> None:
    ran(drive, "--robustness", "--format", "json")
    found = {each["label"]: each["robustness"] for each in json.loads(capsys.readouterr().out)["properties"]}
    assert found["slow"] == {
        "margin": 0.25,
        "reason": None,
        "comparison": "speed > 2",
        "time": 12.0,
        "time_ns": 12 * 10**9,
        "offset": 2.0,
    }
    assert found["seen"] == {"margin": None, "reason": "no comparison of numbers decides it"}


def test_without_the_option_nothing_is_measured(drive: Path, capsys: pytest.CaptureFixture[str]) -> None:
    ran(drive, "--format", "json")
    assert "robustness" not in capsys.readouterr().out
    ran(drive)
    assert "Robustness" not in capsys.readouterr().out


def test_a_campaign_ranks_properties_by_their_least_margin(drive: Path, capsys: pytest.CaptureFixture[str]) -> None:
    other = drive / "other.csv"
    other.write_text("time,speed,armed\n10,0.5,true\n11,1.875,true\n", encoding="utf-8")
    summary, results = drive / "summary.html", drive / "results.parquet"
    assert ran(drive, str(other), "--robustness", "--summary", str(summary), "--results", str(results)) == 1
    told = capsys.readouterr().out
    lines = [line.split() for line in told.partition("closest to failing")[2].splitlines()]
    assert lines[0] == ["least", "margin", "median", "recording"]
    assert lines[1] == ["calm", "-0.25", "-0.25", str(drive / "drive.csv")]
    assert lines[2] == ["slow", "0.125", "0.1875", str(other)]
    assert 'points="0.0,2.0 200.0,12.0"' in summary.read_text(encoding="utf-8")
    ran(drive, str(other), "--robustness", "--results", str(results), "--format", "json")
    again = json.loads(capsys.readouterr().out)["summary"]
    assert again["judged_before"] == 2
    found = {each["label"]: each.get("robustness") for each in again["properties"]}
    assert found["slow"] == {"least": 0.125, "recording": str(other), "median": 0.1875, "measured": 2}
    assert found["late"] is None
    ran(drive, str(other), "--results", str(results), "--format", "json")
    assert "robustness" not in capsys.readouterr().out  # which is judged anew, since this is another question


def test_the_page_has_a_curve_under_the_verdict(drive: Path) -> None:
    compiled, specification = from_text(PROPS)
    page = PageReport(compiled, specification)
    for measures in (True, False):
        collected = page.collector()
        judge = Judge(compiled, specification, keep_trails=True, measures=measures)
        page.add(judge.judge(drive / "drive.csv", [collected.take]), collected)
    drawn = page._data.as_json()
    panels = [timeline["panels"] for timeline in drawn["timelines"]]
    assert [each[0]["title"] == "robustness" for each in panels] == [True, True, *[False] * 8]
    [line] = panels[0][0]["lines"]
    blob = zlib.decompress(base64.b64decode(drawn["blobs"][line["values"]["blob"]]))
    assert np.frombuffer(blob, line["values"]["type"]).tolist() == [0.25, 0.25, 0.25]
    assert panels[0][0]["limits"] == [{"text": "robustness > 0", "value": 0.0, "reach": 0.0}]


def test_another_encoding_is_not_measured(drive: Path, capsys: pytest.CaptureFixture[str]) -> None:
    ran(drive, "--robustness", "--encoding", "dwyer")
    assert "  slow: none: the encoding `dwyer`\n" in capsys.readouterr().out


def test_python_has_a_margin_for_each_step() -> None:
    rows = [{"time": 0.1 * k, "robot.velocity": speed} for k, speed in enumerate([1.0, 2.5, 1.5])]
    curve = ltlc.run("never robot.velocity > 2", rows).robustness["line 1"]
    assert (str(curve.times.dtype), str(curve.margins.dtype), curve.margins.shape) == ("int64", "float64", (3,))
    assert curve.times.tolist() == [0, 10**8, 2 * 10**8]
    assert curve.margins.tolist() == [-0.5, -0.5, 0.5]
    assert curve.whole == -0.5
    assert curve.decided == (10**8, "robot.velocity > 2")


def test_a_run_that_was_stepped_cannot_be_measured() -> None:
    monitor = ltlc.monitor("never robot.velocity > 2")
    monitor.step({"robot.velocity": 1.0}, time=0.0)
    with pytest.raises(ltlc.UnusableInput, match="to measure them"):
        _ = monitor.finish().robustness


DECLARED = """
decl speed /speed std_msgs/Float64.data
decl armed /armed std_msgs/Bool.data
decl count /count std_msgs/Int32.data
"""

LIVE = f"""{DECLARED}
slow:  never speed > 2
soon:  eventually speed > 1 within 2 s
later: eventually speed > 1 within [1 s, 2 s]
first: until armed, always speed < 1
each_: each n of count: never speed > n
"""


def possible(live: LiveRun) -> dict[str, tuple[float, float]]:
    return {label: (band.low, band.high) for label, band in live.robustness.items() if not band.reason}


def test_a_run_that_goes_on_has_what_its_robustness_can_still_be() -> None:
    live = ltlc.monitor(LIVE, robustness=True)
    anything = -math.inf, math.inf
    assert set(possible(live).values()) == {anything}
    live.step({"speed": 0.5, "armed": False, "count": 1}, time=0)
    assert possible(live) == {
        "slow": (-math.inf, 1.5),
        "soon": (-0.5, math.inf),
        "later": anything,
        "first": (-math.inf, 0.5),
        "each_": (-math.inf, 0.5),
    }
    live.step({"speed": 0.75}, time=1.5)
    assert possible(live)["later"] == (-0.25, math.inf)
    live.step({}, time=2)  # at which another message may come
    assert possible(live)["soon"] == (-0.25, math.inf)
    live.step({"armed": True}, time=2.5)
    assert possible(live) == {
        "slow": (-math.inf, 1.25),
        "soon": (-0.25, -0.25),
        "later": (-0.25, -0.25),
        "first": (0.25, 0.25),
        "each_": (-math.inf, 0.25),  # another id can come
    }
    live.finish()
    assert possible(live)["slow"] == (1.25, 1.25)
    assert possible(live)["each_"] == (0.25, 0.25)
    live.reset()
    assert possible(live)["slow"] == anything


def test_what_comes_after_a_timeout_changes_nothing() -> None:
    live = ltlc.monitor(f"{DECLARED}_timeout_ = 2 s\nslow: never speed > 2", robustness=True)
    live.step({"speed": 0.5}, time=0)
    live.step({"speed": 1.0}, time=2)
    assert possible(live) == {"slow": (-math.inf, 1.0)}
    live.step({"speed": 5.0}, time=3)
    assert possible(live) == {"slow": (1.0, 1.0)}


def test_nothing_is_kept_of_a_run_whose_robustness_was_not_asked_for() -> None:
    with pytest.raises(ltlc.UnusableInput, match="`robustness=True`"):
        assert ltlc.monitor(LIVE).robustness


def test_the_message_from_which_on_a_property_holds_least_is_reported(
    drive: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = "decl speed /speed std_msgs/Float64.data\np: each new speed: eventually speed > 1.5 within 1 s\n"
    (drive / "props.txt").write_text(text, encoding="utf-8")
    assert ran(drive, "--robustness") == 1
    assert "  p: -0.25 at +1 s, from the message at +0 s on: speed > 1.5\n" in capsys.readouterr().out
    ran(drive, "--robustness", "--format", "json")
    [found] = json.loads(capsys.readouterr().out)["properties"]
    assert found["robustness"]["opened_at"] == 10.0
    live = ltlc.monitor(text, robustness=True)
    for time, speed in ((0, 0.5), (1, 1.25), (2.5, 1.75)):
        live.step({"speed": speed}, time=time)
    assert possible(live)["p"] == (-math.inf, -0.25)
    live.finish()
    assert possible(live)["p"] == (-0.25, -0.25)


OF_EACH = """decl id /s geometry_msgs/Point.x
decl x  /s geometry_msgs/Point.y
decl v  /v std_msgs/Float64.data
"""

SLICED = (
    "always x < 1.5 + {g}",
    "never x > {g} and v > 1",
    "always (x > 1 implies eventually v < 1 within 300 ms)",
    "until x > 2.5, always v < 2 + {g}",
    "eventually x > 2 within 500 ms",
    "after x > 2, always (v < 2.5 or x < {g})",
    "never historically x > 1 for 200 ms",
    "never once x > 2 2 times within 1 s",
    "always x - @{{x, -1}} < 2",
    "after_until v < 1, v > 2, eventually x > {g}",
    "always (new x implies x < 2 since v < 1)",
    "never age(x) > 300 ms and x > 1",
    "always (mean(@{{x, -1:}}) < 2 or v < {g})",
)


IDS = (1, 2, 3)


def of_one(rows: Sequence[tuple[float, dict[str, Any]]], id_: float) -> list[tuple[float, dict[str, Any]]]:
    """What is said of an id: all but the messages with another one."""
    return [
        (time, {name: value for name, value in row.items() if name == "v" or row["id"] == id_}) for time, row in rows
    ]


def messages_of_ids(seed: int, *, have_nan: bool) -> list[tuple[float, dict[str, Any]]]:
    """Rows with messages of three ids, and of none."""
    chance, time = Random(seed), 0.0
    rows: list[tuple[float, dict[str, Any]]] = []
    for _ in range(chance.randrange(1, 25)):
        row: dict[str, Any] = {}
        kind = chance.randrange(4)
        if kind:
            x = chance.choice((0.25, 1.75, 2.25, 3.0, math.nan if have_nan else 2.0))
            row |= {"id": float(chance.choice(IDS)), "x": x}
        if kind < 2:
            row |= {"v": chance.choice((0.5, 1.25, 2.75))}
        rows.append((time, row))
        time += chance.choice((0.1, 0.3))
    return [*rows, (time, {"v": 1.5})]


@pytest.mark.parametrize("said", SLICED)
def test_each_id_has_the_robustness_of_its_part_of_the_run_and_the_least_is_that_of_all(said: str) -> None:
    alone = "".join(f"p{id_}: {said.format(g=id_)}\n" for id_ in IDS)
    text = f"{OF_EACH}{alone}p: each g of id: {said.format(g='g')}"
    drawn = [messages_of_ids(seed, have_nan="age(" not in said) for seed in range(share_of(30))]
    parts = [part for rows in drawn for part in (rows, *(of_one(rows, id_) for id_ in IDS))]
    runs = [found.robustness for found in ltlc.run_each(text, parts)]
    for whole, *of_ids in zip(*[iter(runs)] * 4, strict=True):
        found, curves = whole["p"], {id_: of[f"p{id_}"] for id_, of in zip(IDS, of_ids, strict=True)}
        assert not any(curve.reason for curve in (found, *curves.values()))
        expected = {id_: curve for id_, curve in curves.items() if curve.whole is not None}
        assert found.whole == min((float(curve.margins[0]) for curve in expected.values()), default=None)
        assert found.times.tolist() == sorted(time for curve in expected.values() for time in curve.times.tolist())
        if expected:
            assert found.id in expected
            assert expected[int(found.id or 0)].whole == found.whole
            assert found.margins[-1] == min(curve.margins[-1] for curve in expected.values())


def test_what_a_limit_left_out_is_not_measured() -> None:
    rows = [(0, {"id": 1, "x": 0.5}), (1, {"id": 2, "x": 0.5})]
    found = ltlc.run(f"{OF_EACH}p: each g of id limit 1: never x > g", rows).robustness["p"]
    assert (found.whole, found.reason) == (None, "messages were ignored for which there was no place")


def test_the_id_with_the_least_robustness_is_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "props.txt").write_text(f"{OF_EACH}p: each g of id: never x > g", encoding="utf-8")
    (tmp_path / "drive.csv").write_text("time,id,x\n10,1,0.5\n11,2,1.75\n12,1,0.25\n", encoding="utf-8")
    command = ["run", str(tmp_path / "props.txt"), str(tmp_path / "drive.csv"), "--robustness"]
    assert main(command) == 0
    assert "  p: 0.25 at +1 s, of id 2: x > g\n" in capsys.readouterr().out
    main([*command, "--format", "json"])
    [found] = json.loads(capsys.readouterr().out)["properties"]
    assert (found["robustness"]["margin"], found["robustness"]["id"]) == (0.25, 2)
