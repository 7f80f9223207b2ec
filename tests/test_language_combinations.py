"""`any(… over (a), (b))`: every element of a list with every one of the others."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from stepping import from_text, session

from ltlc.base.source import Source
from ltlc.cli import main
from ltlc.frontend.language import load_text
from ltlc.specification import expressions
from ltlc.specification.evaluation import evaluate
from ltlc.specification.expressions import Count, Current, operands

DECLARATIONS = """decl ox /obstacles visualization_msgs/MarkerArray.markers[].pose.position.x
decl oy /obstacles visualization_msgs/MarkerArray.markers[].pose.position.y
decl tx /targets geometry_msgs/PoseArray.poses[].position.x
decl ty /targets geometry_msgs/PoseArray.poses[].position.y
decl scan /scan LaserScan.ranges
decl v /v Float64.data
"""


def counted(said: str, **arrays: tuple[float, ...]) -> float:
    compiled, _ = from_text(f"{DECLARATIONS}never count({said}) > 0\n")
    (atom,) = compiled[0].specification.atoms
    (count,) = (side for side in operands(atom.condition) if isinstance(side, Count))
    reads = set(compiled[0].specification.inputs())
    found = evaluate(count, {read: arrays[read.signal.name] for read in reads if isinstance(read, Current)})
    assert isinstance(found, float)
    return found


def test_every_element_is_combined_with_every_one_of_the_other_list() -> None:
    assert counted("ox < tx over (ox), (tx)", ox=(1.0, 2.0, 3.0), tx=(2.0, 3.0)) == 3


def test_the_elements_of_a_list_go_side_by_side() -> None:
    said = "hypot(ox - tx, oy - ty) < 1 over (ox, oy), (tx, ty)"
    assert counted(said, ox=(0.0, 5.0), oy=(0.0, 5.0), tx=(0.5, 5.0, 0.0), ty=(0.0, 0.0, 5.0)) == 1


def test_an_empty_list_has_no_combinations_and_nan_does_not_count() -> None:
    assert counted("ox < tx over (ox), (tx)", ox=(1.0, 2.0), tx=()) == 0
    assert counted("ox < tx over (ox), (tx)", ox=(math.nan, 2.0), tx=(9.0, math.nan)) == 1


def test_arrays_side_by_side_in_a_message_belong_together_up_to_the_end_of_the_shortest(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = "decl pos /joints JointState.position\ndecl vel /joints JointState.velocity\n"
    text += "p: never any(pos > 1 and vel > 1)\n"
    messages = [([2.0, 0.0], [0.0, 2.0]), ([2.0, 0.0, 2.0], [0.0]), ([0.0, 2.0], [0.0, 1.5, 5.0])]
    rows = session(text)
    for time, values in enumerate(messages):
        rows.samples(time * 10**9, ("pos", "vel"), [tuple(each) for each in values])
    (track,) = rows.tracks
    assert [verdict.value for verdict in track.verdicts or ()] == [*["presumably_satisfied"] * 2, "violated"]
    lines = [f'{{"time": {n}, "pos": {pos}, "vel": {vel}}}' for n, (pos, vel) in enumerate(messages)]
    (tmp_path / "props.txt").write_text(text)
    (tmp_path / "run.jsonl").write_text("\n".join(lines))
    assert main(["run", str(tmp_path / "props.txt"), str(tmp_path / "run.jsonl")]) == 1
    assert "p: violated at +2 s (step 2)" in capsys.readouterr().out


def test_three_lists_are_combined() -> None:
    assert counted("ox + tx > scan over (ox), (tx), (scan)", ox=(1.0, 2.0), tx=(1.0, 2.0), scan=(2.5, 3.5)) == 4


def test_too_many_combinations_have_no_count(monkeypatch: pytest.MonkeyPatch) -> None:
    """As many as six are counted here; that it is a million, the rows of a recording show below."""
    monkeypatch.setattr(expressions, "MOST_COMBINATIONS", 6)
    assert counted("ox > tx over (ox), (tx)", ox=(2.0, 2.0), tx=(1.0, 1.0, 3.0)) == 4
    assert math.isnan(counted("ox > tx over (ox), (tx)", ox=(2.0,) * 7, tx=(1.0,)))


@pytest.mark.parametrize(
    ("said", "message"),
    [
        ("any(ox < tx)", "`ox` and `tx` are not side by side in one message"),
        ("any(ox < tx over (ox), (v))", "`over` lists arrays, but `v` is a number"),
        ("any(ox < tx over (ox), (tx), (ox))", "`ox` is listed twice"),
        ("any(ox < tx over (ox), (scan))", "`tx` is missing from the lists of `over`"),
        ("any(ox < 1 over (ox), (tx))", "`over` lists `tx`, which the condition does not use"),
        ("any(ox < tx over (ox, tx))", "`ox` and `tx` are not side by side in one message"),
    ],
)
def test_lists_that_do_not_fit_are_reported(said: str, message: str) -> None:
    _, diagnostics = load_text(Source("props.txt", f"{DECLARATIONS}never {said}\n"))
    assert [each.message for each in diagnostics if each.code == "LTL230" and message in each.message]


def test_a_signal_can_be_called_over() -> None:
    found, _ = load_text(Source("props.txt", "decl over /over Float64.data\nnever over > 1\n"))
    assert found is not None


def test_rows_with_more_than_a_million_combinations_are_no_steps_and_counted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "props.txt").write_text(f"{DECLARATIONS}p: never any(ox > tx over (ox), (tx))\n")
    thousand = [2.0] * 1000
    lists = [([0], [1]), (thousand, thousand), ([*thousand, 2.0], thousand)]
    rows = [f'{{"time": {n}, "ox": {ox}, "tx": {tx}}}' for n, (ox, tx) in enumerate(lists)]
    (tmp_path / "run.jsonl").write_text("\n".join(rows))
    assert main(["run", str(tmp_path / "props.txt"), str(tmp_path / "run.jsonl")]) == 0
    assert "1 step left out" in capsys.readouterr().out
