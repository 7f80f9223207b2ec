"""An example run as a small table: a row for each step, a column for each signal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ltlc.language.values import quoted


def example_lines(example: dict[str, Any]) -> list[str]:
    """The lines of an example in the form in which diagnostics carry it: its caption, then its steps."""
    steps = example["steps"]
    signals = list(steps[0]["values"])
    remarks = [step["remark"] for step in steps]
    head = ["step", *signals, *([""] if any(remarks) else [])]
    rows = [
        [_number(n, example["loop"]), *map(shown, step["values"].values()), *([remark] if any(remarks) else [])]
        for n, (step, remark) in enumerate(zip(steps, remarks, strict=True))
    ]
    lines = [example["caption"], *aligned([head, *rows], right=len(signals) + 1)]
    if example["loop"] is not None:
        lines.append("the steps marked * repeat for ever")
    return lines


def _number(step: int, loop: int | None) -> str:
    return f"{step}*" if loop is not None and step >= loop else str(step)


def shown(value: Any) -> str:
    """A value as it is written in the language."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return quoted(value)
    return str(value)


def aligned(rows: Sequence[Sequence[str]], right: int) -> list[str]:
    """`rows` as lines with columns of one width; the first `right` columns are set to the right."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    return [
        "  ".join(
            cell.rjust(width) if column < right else cell.ljust(width)
            for column, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]
