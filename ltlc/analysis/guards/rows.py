"""The rows of a run that parts two guards, as it is shown."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from ltlc.analysis.examples import Example, for_people
from ltlc.analysis.guards.replaying import Replay
from ltlc.monitoring.guarding.report import Done
from ltlc.semantics.durations import Nanoseconds
from ltlc.specification.evaluation import Value
from ltlc.specification.expressions import Field


class Rows:
    """One row for each message, and one for each that both guards send by themselves."""

    def __init__(self, side: Replay, columns: Mapping[Field, str]) -> None:
        """`side` is one of the guards; `columns` are headed by these names."""
        self._side, self._columns = side, columns
        self._known: dict[Field, Value] = {}
        self._rows: list[tuple[Nanoseconds, tuple[Any, ...], str, bool]] = []

    def message(self, time: Nanoseconds, values: Mapping[Field, Value], remark: str, *, by_time: bool = False) -> None:
        """A row in which some fields have new values."""
        self._known |= values
        told = tuple(for_people(self._known.get(field)) for field in self._columns)
        self._rows.append((time, told, remark, by_time))

    def sent(self, done: Iterable[Done]) -> None:
        """What both have sent, by themselves or in the place of the command before."""
        for deed in (each.deed for each in done if each.deed.message is not None):
            values = {self._side.fields[name]: value for name, value in (deed.values or {}).items()}
            if deed.command is None:
                self.message(deed.time, values, f"both send `{deed.message}` on {deed.outs[0]}", by_time=True)
            else:
                time, told, remark, by_time = self._rows[-1]
                self._rows[-1] = time, told, f"{remark}, changed to `{deed.message}` by both", by_time
                self._known |= values

    def example(self) -> Example:
        """The run."""
        times, told, remarks, by_time = zip(*self._rows, strict=True)
        held = frozenset(number for number, is_held in enumerate(by_time) if is_held)
        since = tuple(time - times[0] for time in times)
        return Example("", tuple(self._columns.values()), told, remarks, None, since, held)
