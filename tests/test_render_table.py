"""Example runs as tables."""

from __future__ import annotations

from typing import Any

from ltlc.base.render.table import example_lines


def example(values: list[dict[str, Any]], remarks: list[str], loop: int | None = None) -> dict[str, Any]:
    steps = [{"values": v, "remark": r} for v, r in zip(values, remarks, strict=True)]
    return {"caption": "a run", "steps": steps, "loop": loop}


def test_a_step_is_a_row_and_a_signal_a_column() -> None:
    lines = example_lines(example([{"x": 1, "mode": "go"}, {"x": -0.5, "mode": "a\nb"}], ["fine", "violated"]))
    assert lines == [
        "a run",
        "step     x    mode",
        '   0     1    "go"  fine',
        '   1  -0.5  "a\\nb"  violated',
    ]


def test_a_loop_is_marked() -> None:
    lines = example_lines(example([{"on": True}, {"on": False}], ["", ""], loop=1))
    assert lines[1:] == ["step     on", "   0   true", "  1*  false", "the steps marked * repeat forever"]


def test_a_table_that_is_too_wide_is_turned() -> None:
    wide = {f"a_signal_with_a_long_name_{n}": n for n in range(6)}
    lines = example_lines(example([wide, wide], ["fine", "violated"]))
    assert max(map(len, lines)) < 60
    assert lines[1].split() == ["step", "0", "1"]
    assert lines[3].split() == ["a_signal_with_a_long_name_1", "1", "1"]
    assert lines[-1].split() == ["fine", "violated"]


def test_steps_that_time_alone_takes_have_a_time_and_no_number() -> None:
    steps = [
        {"values": {"x": x}, "remark": "", "time_ns": time, "by_time": by_time}
        for x, time, by_time in [(1, 0, False), (1, 1_500_000_000, True), (2, 3_000_000_000, False)]
    ]
    lines = example_lines({"caption": "a run", "steps": steps, "loop": None})
    assert [line.split() for line in lines[1:]] == [
        ["step", "time", "in", "s", "x"],
        ["0", "0", "1"],
        ["1.5", "1"],
        ["1", "3", "2"],
    ]
