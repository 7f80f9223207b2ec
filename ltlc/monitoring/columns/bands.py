"""Between which numbers the robustness of properties will be in a run whose rows come one by one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ltlc.compiler import Compiled
from ltlc.inputs.recordings.blocks import ROWS, blocks_of
from ltlc.inputs.recordings.rows import Column, Row
from ltlc.monitoring.columns.curves import Band
from ltlc.monitoring.columns.measuring import Measuring
from ltlc.monitoring.columns.prepared import Prepared
from ltlc.monitoring.columns.session import ByBlocks
from ltlc.runtime.rows import ByRows
from ltlc.runtime.sampling import Value
from ltlc.runtime.session import Plan, Session
from ltlc.semantics.durations import Nanoseconds


class Bands:
    """Keeps the margins of all steps so far, 8 bytes for each comparison, and some rows that are not measured yet."""

    def __init__(
        self, plan: Plan, compiled: Sequence[Compiled], prepared: Sequence[Prepared], columns: Mapping[str, Column]
    ) -> None:
        """Of the properties of `plan`, which reads `columns`."""
        self._columns = columns
        self._judged = ByBlocks(Session(plan), prepared)
        self._measuring = Measuring(self._judged.session, compiled, prepared)
        self._rows: list[Row] = []

    def take(self, time: Nanoseconds, names: Sequence[str], values: Sequence[Value]) -> None:
        """Take the next row."""
        self._rows.append(Row(time, dict(zip(names, values, strict=True))))
        if len(self._rows) == ROWS:
            self._measure()

    def _measure(self) -> None:
        for block in blocks_of(self._rows, self._columns):
            self._measuring.take(block)
            self._judged.take(block)
        self._rows.clear()

    def now(self, time: Nanoseconds, is_over: bool) -> dict[str, Band]:
        """Those of all properties by label in a run that has got to `time`; exact if it `is_over`, or timed out."""
        self._measure()
        if not is_over and time <= self._judged.session.end:
            return self._measuring.bands(time)
        self._measuring.finish(time)
        ByRows(self._judged.session).advance(time)
        curves = self._measuring.curves(time).items()
        return {label: Band(reason=c.reason) if c.whole is None else Band(c.whole, c.whole) for label, c in curves}
