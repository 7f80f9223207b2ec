"""Recordings that take a monitor along all its edges: they do, they are judged as expected, and none is in vain."""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import pytest
from stepping import from_text

from ltlc.assurance.coverage import Edge, covering, possible
from ltlc.assurance.messages import Messages
from ltlc.assurance.traffic import Settings
from ltlc.cli import main
from ltlc.compiler import Compiled
from ltlc.frontend.language import types_for
from ltlc.interfaces.building import runs as target
from ltlc.semantics.monitor import Monitor

ROOT = Path(__file__).parent.parent
UNTIMED = """decl v /v std_msgs/Float64.data
decl mode /mode std_msgs/String.data
slow: never v > 2
stops: always (v > 2 implies eventually v < 1)
parks: after_until mode == "park", mode == "drive", eventually v == 0
settles: eventually always v < 1
again: always (v > 1 implies not (previously v > 1 and previously previously v > 1))
"""
TIMED = """decl v /v std_msgs/Float64.data
stops: always (v > 2 implies eventually v < 1 within 500 ms)
calm: never historically v > 1 for 2 s
fresh: always age(v) <= 1 s
met: after v > 3, eventually v < 0 within 1 s
"""


def cover_of(text: str) -> Iterator[tuple[Compiled, Any]]:
    compiled, whole = from_text(text)
    messages = Messages(types_for(whole.source, [])[0])
    for each in compiled:
        yield each, covering(each, messages, Settings(whole.rate, whole.timeout))


def reachable(monitor: Monitor, compiled: Compiled) -> set[Edge]:
    """The edges along letters that exist, letter by letter."""
    letters = list(compiled.specification.alphabet.letters())
    states, edges = [0], set()
    for state in states:
        if monitor.verdicts[state].is_permanent:
            continue
        for letter in letters:
            after = monitor.step(state, letter)
            edges.add((state, after))
            if after not in states:
                states.append(after)
    return edges


def test_the_edges_that_can_be_taken_are_those_along_letters_that_exist() -> None:
    compiled, _ = from_text(UNTIMED.rpartition("again")[0])
    for each in compiled:
        assert possible(each) == reachable(each.monitor, each)


@pytest.mark.parametrize("text", [UNTIMED, TIMED, "_rate_ = 10\n" + UNTIMED], ids=["untimed", "timed", "rate"])
def test_each_edge_is_taken_and_each_run_is_needed(text: str) -> None:
    for each, cover in cover_of(text):
        taken = [edges_of(each, run) for run in cover.runs]
        assert set().union(*taken) == cover.taken <= cover.can_be, each.specification.label
        assert cover.taken == cover.can_be, each.specification.label
        for number in range(len(taken)):
            assert set().union(*taken[:number], *taken[number + 1 :]) != cover.taken


def edges_of(compiled: Compiled, run: Any) -> set[Edge]:
    state, edges = 0, set()
    for letter in (letter for letters in run.steps for letter in letters if letter is not None):
        if compiled.monitor.verdicts[state].is_permanent:
            break
        after = compiled.monitor.step(state, letter)
        edges.add((state, after))
        state = after
    return edges


@pytest.mark.parametrize("file", ["stop_sign/stop_sign.txt", "evidence/props.txt"])
def test_ltlc_run_finds_in_each_file_what_is_expected(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], file: str
) -> None:
    properties, folder = ROOT / "examples" / file, tmp_path / "tests"
    assert main(["build", str(properties), "--target", "tests", "--output", str(folder)]) == 0
    assert "edges, in" in capsys.readouterr().out
    expected = json.loads((folder / "expected.json").read_text())
    listed = {name for each in expected["properties"] for run in each["runs"] for name in run["files"]}
    assert listed | {"expected.json"} == {path.name for path in folder.iterdir()}
    for each in expected["properties"]:
        assert each["edges"]["taken"] == each["edges"]["of"] == each["edges"]["taken"] + len(each["edges"]["not_taken"])
        for run, suffix in product(each["runs"], (".csv", ".mcap")):
            [name] = [name for name in run["files"] if name.endswith(suffix)]
            main(["run", str(properties), str(folder / name), "--format", "json"])
            document = json.loads(capsys.readouterr().out)
            [found] = [p for p in document["properties"] if p["label"] == each["label"]]
            assert found["verdict"] == run["verdict"]
            if run["verdict"] == "violated":
                assert found["decided_at"]["time"] == run["changes"][-1]["time"]


def test_messages_of_all_kinds_of_fields_are_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "own_msgs" / "msg").mkdir(parents=True)
    (tmp_path / "own_msgs" / "msg" / "Part.msg").write_text("string name\nbool[2] on\n")
    (tmp_path / "own_msgs" / "msg" / "Whole.msg").write_text(
        "byte b\nchar c\nfloat32 x\nuint8[] raw\nbyte[] bytes\nstring[] names\nPart[] parts\nPart part\n"
    )
    (tmp_path / "props.txt").write_text(
        "decl scan /scan sensor_msgs/LaserScan.ranges\n"
        "near: after_until min(scan) < -9, min(scan) > -8, never max(scan) > 7\n"
        "decl x /w own_msgs/Whole.x\ndecl raw /w own_msgs/Whole.raw\ndecl on /w own_msgs/Whole.parts[0].on\n"
        "decl ping /ping std_msgs/Empty\n"
        "p: always (x > 1 implies eventually max(raw) > 100)\nq: never on[1] and x < 0\nr: never new ping and x > 5\n"
    )
    arguments = ["build", str(tmp_path / "props.txt"), "--target", "tests", "--output", str(tmp_path / "tests")]
    assert main([*arguments, "--msg-path", str(tmp_path)]) == 0
    assert "p: 2 of 2 states, 4 of 4 edges" in capsys.readouterr().out


def test_what_is_judged_for_each_id_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "props.txt").write_text(
        "decl j /j sensor_msgs/JointState.name\ndecl v /j sensor_msgs/JointState.velocity\neach i of j: never v > 1\n"
    )
    output = tmp_path / "tests"
    assert main(["build", str(tmp_path / "props.txt"), "--target", "tests", "--output", str(output)]) != 0
    assert "LTL708" in capsys.readouterr().err
    assert not output.exists()


def test_a_folder_with_something_else_in_it_is_left_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "props.txt").write_text("slow: never robot.velocity > 2\n")
    arguments = ["build", str(tmp_path / "props.txt"), "--target", "tests", "--output"]
    assert main([*arguments, str(tmp_path)]) == 2
    assert "something other than tests" in capsys.readouterr().err
    assert main([*arguments, str(tmp_path / "props.txt")]) == 2
    for _ in range(2):
        assert main([*arguments, str(tmp_path / "tests")]) == 0


def test_a_recording_that_is_not_judged_as_expected_is_not_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "props.txt").write_text("slow: never robot.velocity > 2\n")
    whole = target.table
    monkeypatch.setattr(target, "table", lambda of: whole(of).splitlines()[0] + "\n0,,,\n")
    assert main(["build", str(tmp_path / "props.txt"), "-t", "tests", "-o", str(tmp_path / "tests")]) == 2
    assert "bug" in capsys.readouterr().err
    assert not (tmp_path / "tests").exists()
