"""An example run as a small table: a row for each step and a column for each signal or, if that is too wide, turned."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from ltlc.base.source import quoted
from ltlc.semantics.durations import seconds_text

WIDTH = 120
"""A table with longer lines is turned."""


def example_lines(example: dict[str, Any]) -> list[str]:
    """The lines of an example in the form in which diagnostics carry it: its caption, then its steps."""
    steps = example["steps"]
    remarks = [step["remark"] for step in steps]
    leading = list(_leading(steps, example["loop"]))
    head = [*leading[0], *steps[0]["values"], *([""] if any(remarks) else [])]
    rows = [
        [*first, *map(shown, step["values"].values()), *([remark] if any(remarks) else [])]
        for first, step, remark in zip(leading[1:], steps, remarks, strict=True)
    ]
    numbers = range(len(leading[0]) + len(steps[0]["values"]))
    table = aligned([head, *rows], right=numbers)
    if max(map(len, table)) > WIDTH:
        table = aligned(list(zip(head, *rows, strict=True)), right=range(1, 1 + len(rows)))
    repeated = ["the steps marked * repeat forever"] if example["loop"] is not None else []
    return [example["caption"], *table, *repeated]


def _leading(steps: Sequence[dict[str, Any]], loop: int | None) -> Iterator[list[str]]:
    """The first columns, with their head: the number of a step, and its time; where time alone passes, no number."""
    timed = "time_ns" in steps[0]
    yield ["step", "time in s"] if timed else ["step"]
    number = 0
    for row, step in enumerate(steps):
        mark = "*" if loop is not None and row >= loop else ""
        by_time = timed and step["by_time"]
        yield [f"{'' if by_time else number}{mark}", *([seconds_text(step["time_ns"])] if timed else [])]
        number += not by_time


def shown(value: Any) -> str:
    """A value as it is written in the language; nothing if there is none yet."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return quoted(value)
    return str(value)


def aligned(rows: Sequence[Sequence[str]], right: range) -> list[str]:
    """`rows` as lines with columns of one width; the columns with a number in `right` are set to the right."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    return [
        "  ".join(
            cell.rjust(width) if column in right else cell.ljust(width)
            for column, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]
