"""By how much properties hold, as users see it: text, JSON and Python."""

from __future__ import annotations

import base64
import json
import math
import zlib
from pathlib import Path

import numpy as np
import pytest
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
    }
    live.finish()
    assert possible(live)["slow"] == (1.25, 1.25)
    assert live.robustness["each_"].reason == "`each`: every id has a run of its own"
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
