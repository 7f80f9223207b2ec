"""`ltlc.monitor`: a run that goes on, judged row by row as its values come."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from operator import index
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, SupportsIndex

from ltlc.base.errors import UnusableInput
from ltlc.base.limits import Budget
from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.checks import checks_of
from ltlc.inputs.recordings.given import DOUBLE, TIME, GivenTable, cells, time_given
from ltlc.inputs.recordings.rows import Column, RecordingError
from ltlc.inputs.recordings.signals import FromTable
from ltlc.interfaces.api.prepare import Prepared, Text, encoding_of, prepare, read
from ltlc.interfaces.api.results import PropertyResult, Run, violations_of
from ltlc.interfaces.api.times import Seconds, needs_time
from ltlc.monitoring.judging.run import Judge, RunReport, readings
from ltlc.runtime.properties import Change
from ltlc.runtime.rows import ByRows, Route
from ltlc.runtime.sampling import Value
from ltlc.runtime.session import Session
from ltlc.runtime.times import SECOND, Times, seconds_text
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.expressions import Signal

if TYPE_CHECKING:
    from ltlc.monitoring.columns.bands import Bands
    from ltlc.monitoring.columns.curves import Band

NAME = Path("run")
"""What is called a run that is in no file."""


def monitor(
    specification: Text,
    *,
    signals: Iterable[str] | None = None,
    encoding: str = "episode",
    message_paths: Sequence[str | PathLike[str]] = (),
    budget: Budget | None = None,
    robustness: bool = False,
) -> LiveRun:
    """A run that the properties of `specification` watch, before its first row.

    >>> import ltlc
    >>> run = ltlc.monitor("soon: always (robot.velocity > 2 implies eventually robot.velocity < 1 within 1 s)")
    >>> [(each.current.value, each.moment.time) for each in run.step({"robot.velocity": 0.5}, time=0.0)]
    [('presumably_satisfied', 0)]
    >>> run.step({"robot.velocity": 2.5}, time=0.1)[0].current.value
    'presumably_violated'
    >>> run.step({"robot.velocity": 2.0}, time=1.2)[0].current.value
    'violated'
    >>> print(run.violations[0])
    Error at line 1 of specification (soon):
      always (robot.velocity > 2 implies eventually robot.velocity < 1 within 1 s)
    Failing state:
      robot.velocity: 2.5
    Because:
      more than 1 s since the first "robot.velocity > 2" without "robot.velocity < 1": true
    Unmet since +0.1 s (step 1): eventually robot.velocity < 1 within 1 s
    At +1.1 s (after step 1).

    A `str` is the text of a specification, a `pathlib.Path` a file; otherwise as `LiveRun`. `budget` is what the
    translation of each property may use. With `robustness` the run keeps what `LiveRun.robustness` needs. Raises
    UnusableInput and SpotMissing.
    """
    encoding_, budget_ = encoding_of(encoding), budget or Budget()
    return LiveRun(prepare(read(specification), message_paths, encoding_, budget_), signals, robustness)


class LiveRun:
    """A run that goes on; its verdicts are those of `ltlc run` on the rows that came.

    A row has values by name, as a recording has columns. Of signals that are computed from others, such as
    `robot.velocity`, the first row says whether they come in themselves or their parts do (`robot.velocity.x`, ...);
    `signals` says it before. Where the time matters, each row has one; else rows without are taken to be 1 s apart.
    """

    def __init__(self, prepared: Prepared, signals: Iterable[str] | None = None, is_measured: bool = False) -> None:
        self._prepared = prepared
        self._is_measured = is_measured
        self._judge = Judge(prepared.compiled, prepared.specification, remarks=prepared.late)
        if isinstance(signals, str):
            raise UnusableInput((), f"`signals` must be a list of names: `[{signals!r}]`")
        self._told = None if signals is None else dict.fromkeys(signals)
        self._needs_time = needs_time(prepared.specification, prepared.compiled)
        self.reset()

    def reset(self) -> None:
        """Begin again, before the first row."""
        self._by_rows: ByRows | None = None
        self._bands: Bands | None = None
        self._run: Run | None = None
        self._columns: Collection[str] = ()
        self._heads: dict[str, None] = {}
        self._readers: dict[tuple[str, ...], _Reader] = {}
        self._reader: _Reader | None = None
        self._wanted: Mapping[str, Signal] = {}
        self._checks = checks_of(())
        self._rows = 0
        self._time: Nanoseconds | None = None
        self._is_counted: bool | None = None

    def step(
        self, values: Mapping[str, object], time: Seconds | None = None, *, time_ns: Nanoseconds | None = None
    ) -> list[Change]:
        """Take a row, of what was sampled at `time`, in s, or `time_ns`; what has changed by it, and by time before it.

        Values are numbers, booleans, strings, or lists of these; None is no sample. `values` may have the time, too, in
        s, as `time`. A row without samples only moves time on. Raises UnusableInput, and then the
        row is as if it had not come.
        """
        if self._run is not None:
            raise UnusableInput((), "the run is finished; call `reset` to begin another")
        try:
            # Written out, as this is most of what a row costs beside its properties.
            reader = self._reader
            if reader is None or values.__class__ is not dict or len(values) != reader.size:
                reader = self._reader_of(values)
            route, taken = reader.route, []
            for name in reader.doubles:
                value = values.get(name)
                if value.__class__ is not float:
                    route = None
                taken.append(value)
            for name in reader.others:
                if name not in values:
                    route = None
            if route is None:
                reader = self._reader_of(values)
            written: object = time
            if reader.has_time or time_ns is not None:
                written = written_time(values.get(TIME), time, time_ns)
            if (written is None) is not self._is_counted:
                self._is_counted = self._is_by_number(written is None)
            number = self._rows + 1
            moment = self._rows * SECOND if self._is_counted else time_given(NAME, number, self._time, written)
            if route is None:
                route, taken = self._read(moment, values, reader.table)
        except BaseException as error:
            if not self._rows:
                self.reset()
            if isinstance(error, RecordingError):
                raise UnusableInput([error.diagnostic]) from None
            raise
        self._rows, self._time = number, moment
        assert self._by_rows is not None
        if self._bands is not None:
            self._bands.take(moment, route.names, taken)
        return self._by_rows.follow(moment, route, taken)

    @property
    def verdicts(self) -> dict[str, Verdict]:
        """The verdict of each property now, by its label."""
        if self._by_rows is None:
            return {each.specification.label: Verdict.NOT_STARTED for each in self._prepared.compiled}
        return {track.property.label: track.verdict for track in self._by_rows.tracks}

    @property
    def robustness(self) -> dict[str, Band]:
        """Between which numbers the robustness of each property will be, by its label, however the run continues.

        After `finish` it is a number. It takes time in proportion to the steps so far, of which 8 bytes are kept for
        each comparison. Raises UnusableInput unless the run was begun with `robustness=True`.
        """
        if not self._is_measured:
            raise UnusableInput((), "nothing is kept for it; call `ltlc.monitor` with `robustness=True`")
        if self._bands is None or self._time is None:
            from ltlc.monitoring.columns.curves import Band  # which few ask for

            return {each.specification.label: Band() for each in self._prepared.compiled}
        return self._bands.now(self._time, self._run is not None)

    @property
    def violations(self) -> list[PropertyResult]:
        """The properties that are violated, in the order in which they were, each with its failing state."""
        return [] if self._by_rows is None else violations_of(self._by_rows.session)

    def finish(self) -> Run:
        """The run is over: what it has shown, and which obligations are still open."""
        if self._run is None:
            rows = self._by_rows or self._begin(self._told or {})
            session = rows.session
            if session.time is not None:
                rows.advance(session.time)
            remarks = self._judge.remarks_on(NAME, self._table(self._heads))
            told = (*self._prepared.diagnostics, *remarks)
            self._run = Run(RunReport(str(NAME), session, told, specification=self._judge.specification.source))
        return self._run

    def _read(self, time: Nanoseconds, row: Mapping[str, object], table: FromTable) -> tuple[Route, list[Value]]:
        """The samples of the next row, whatever they are, and where they lead to. Raises RecordingError."""
        taken = table.row(time, cells(NAME, self._rows + 1, row, table.cells))
        self._checks.check_row(time, taken, NAME)
        assert self._by_rows is not None
        return self._by_rows.route(tuple(taken)), [*taken.values()]

    def _is_by_number(self, is_counted: bool) -> bool:
        """Whether the times of rows are their numbers, which the first row says. Raises UnusableInput for others."""
        if is_counted and self._needs_time:
            raise UnusableInput((), f"row {self._rows + 1} has no time, and {self._needs_time}")
        if self._rows:
            this, others = ("no time", "have one") if is_counted else ("a time", "have none")
            raise UnusableInput((), f"row {self._rows + 1} has {this}, but the rows before {others}")
        return is_counted

    def _table(self, keys: Iterable[str], signals: Mapping[str, Signal] | None = None) -> FromTable:
        """What rows with these keys have of `signals`, or of all. Raises RecordingError."""
        of = self._judge.signals if signals is None else signals
        return FromTable(NAME, GivenTable(NAME, [dict.fromkeys(keys)]), of)

    def _reader_of(self, row: Mapping[str, object]) -> _Reader:
        """What reads a row. Raises RecordingError, UnusableInput."""
        keys = keys_of(row, self._rows + 1)
        self._reader = self._readers.get(keys) or self._meet(keys)
        return self._reader

    def _meet(self, keys: tuple[str, ...]) -> _Reader:
        """What reads rows with these keys, of which none has come. Raises RecordingError, UnusableInput."""
        table = self._table(keys)
        if self._by_rows is None:
            self._columns = (table if self._told is None else self._table(self._told)).columns
            self._by_rows = self._begin(self._columns)
            self._wanted = {name: self._judge.signals[name] for name in readings(self._by_rows.session.plan)}
        for name in table.columns:
            if name in self._judge.signals and name not in self._wanted and name not in self._columns:
                reason = "earlier rows gave the signal that contains it, or its parts"
                raise UnusableInput((), f"`{name}` is unexpected: {reason}; announce it with `signals`")
        self._heads |= dict.fromkeys(keys)
        known = self._table(self._heads).columns
        self._checks = checks_of(signal for name, signal in self._wanted.items() if name in known)
        found = self._table(keys, self._wanted)
        are_doubles = found.is_plain and all(column == DOUBLE for column in found.cells.values())
        is_simple = are_doubles and not any(name in found.cells for name in self._checks.unsigned)
        doubles = tuple(found.cells) if is_simple else ()
        others = tuple(key for key in keys if key not in doubles)
        route = self._by_rows.route(doubles) if is_simple else None
        self._readers[keys] = _Reader(len(keys), found, TIME in keys, doubles, others, route)
        return self._readers[keys]

    def _begin(self, columns: Collection[str]) -> ByRows:
        """Judges a session to which samples of `columns` come; what they tell nothing of comes in itself."""
        signals = self._judge.signals.values()
        untold = {signal.name for signal in signals if not any(name in columns for name in _family(signal))}
        session = Session(self._judge.plan({*columns, *untold}))
        session.times = Times.BOTH
        if self._is_measured:
            from ltlc.monitoring.columns.bands import Bands  # which few ask for

            read = {name: self._judge.signals[name] for name in readings(session.plan)}
            kinds = {name: Column(signal.type, signal.numbers) for name, signal in read.items()}
            self._bands = Bands(session.plan, self._prepared.compiled, self._judge.prepared, kinds)
        return ByRows(session)


@dataclass(frozen=True, slots=True)
class _Reader:
    """Reads rows with the same keys, so many, which `table` has as columns; they may have the time among them.

    If all that is read of them are `doubles`, as in most rows, `route` is where these lead to; `others` are not read.
    """

    size: int
    table: FromTable
    has_time: bool
    doubles: tuple[str, ...]
    others: tuple[str, ...]
    route: Route | None


def _family(signal: Signal) -> list[str]:
    """`signal` and all that it is computed from."""
    return [signal.name, *(name for part in signal.inputs for name in _family(part.signal))]


def keys_of(row: object, number: int) -> tuple[str, ...]:
    """The names of the values in a row. Raises UnusableInput."""
    if not isinstance(row, Mapping):
        raise UnusableInput((), f"row {number} is {row!r:.100}; a row must be a mapping from signals to values")
    return tuple(row)


def written_time(column: object, time: object, time_ns: Nanoseconds | None) -> object:
    """The time that was given, in seconds as they are written, or None. Raises UnusableInput for several."""
    if column is None and time_ns is None:
        return time
    if (column is not None) + (time is not None) + (time_ns is not None) > 1:
        raise UnusableInput((), "a row has one time: `time` in seconds (also among the values) or `time_ns`")
    if time_ns is None:
        return column
    if not isinstance(time_ns, SupportsIndex):
        raise UnusableInput((), f"{time_ns!r} is not a time in nanoseconds, a whole number")
    return seconds_text(index(time_ns))
