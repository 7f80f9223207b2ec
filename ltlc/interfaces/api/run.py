"""`ltlc.run`: recorded runs, judged as the command `ltlc run` judges them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import tee
from os import PathLike
from pathlib import Path
from typing import Protocol

from ltlc.base.errors import UnusableInput
from ltlc.base.limits import Budget
from ltlc.inputs.recordings import open_recording
from ltlc.inputs.recordings.given import TIME, GivenTable
from ltlc.inputs.recordings.parquet import arrow_table
from ltlc.inputs.recordings.reading import ReadOptions, Stamp
from ltlc.inputs.recordings.signals import FromTable
from ltlc.interfaces.api.prepare import Prepared, Text, encoding_of, folders, prepare, read
from ltlc.interfaces.api.results import Run
from ltlc.interfaces.api.times import Seconds, limit_of, needs_time
from ltlc.monitoring.columns.curves import Curve
from ltlc.monitoring.judging.run import Judge, Open, RunReport

Row = Mapping[str, object]
"""Values by signal; a signal that is missing or None has no sample."""

Rows = Iterable[Row] | Iterable[tuple[Seconds, Row]]
"""Rows with the key `time`, in seconds, or each after its time."""


class ArrowStream(Protocol):
    """A table that others can read as Arrow's: a data frame of pandas or polars, a table of pyarrow."""

    def __arrow_c_stream__(self, requested_schema: object = None) -> object: ...


Recorded = str | PathLike[str] | Rows | ArrowStream
"""A file, or the folder of a bag; rows; or a table, which is read as the same in a Parquet file would be."""

NAME = Path("rows")
"""What is called a recording that is in no file."""


def run(
    specification: Text,
    recording: Recorded,
    *,
    encoding: str = "episode",
    since: Seconds | None = None,
    until: Seconds | None = None,
    stamp: str = "log",
    message_paths: Sequence[str | PathLike[str]] = (),
    budget: Budget | None = None,
) -> Run:
    """What `recording` shows of the properties of `specification`.

    >>> import ltlc
    >>> rows = [{"time": 0.0, "robot.velocity": 1}, {"time": 0.1, "robot.velocity": 3}]
    >>> slow = ltlc.run("never robot.velocity > 2", rows)
    >>> slow.verdicts
    {'line 1': <Verdict.VIOLATED: 'violated'>}
    >>> print(slow["line 1"])
    Error at line 1 of specification:
      never robot.velocity > 2
    Failing state:
      robot.velocity: 3.0
    Because:
      robot.velocity > 2: true, 3.0 > 2.0 by 1
    At +0.1 s (step 1).

    A `str` is the text of a specification, a `pathlib.Path` a file; message types that a bag defines are known in it.
    Of the recording, `since` and `until` are the first and the last time that count, in its seconds, or, as in "+10",
    since its beginning; of a bag, `stamp` says whether messages have the time of `log` or that in their `header`.
    `budget` is what the translation of each property may use.

    Raises UnusableInput if nothing can be judged, and SpotMissing.
    """
    [found] = run_each(
        specification,
        [recording],
        encoding=encoding,
        since=since,
        until=until,
        stamp=stamp,
        message_paths=message_paths,
        budget=budget,
    )
    return found


def run_each(
    specification: Text,
    recordings: Iterable[Recorded],
    *,
    encoding: str = "episode",
    since: Seconds | None = None,
    until: Seconds | None = None,
    stamp: str = "log",
    message_paths: Sequence[str | PathLike[str]] = (),
    budget: Budget | None = None,
) -> Iterator[Run]:
    """What each of `recordings` shows, one after the other; the monitors are made once. Otherwise as `run`.

    >>> import ltlc
    >>> drives = [[(0.0, {"robot.velocity": speed})] for speed in (1, 3)]
    >>> [len(found.violations) for found in ltlc.run_each("never robot.velocity > 2", drives)]
    [0, 1]
    """
    paths, (recordings, ahead) = folders(message_paths), tee(recordings)
    files = _files(ahead)
    prepared = prepare(read(specification), paths, encoding_of(encoding), budget or Budget(), recordings=files)
    del ahead, files  # they would keep what the others have passed
    first, last = (None if each is None else limit_of(each) for each in (since, until))
    reading = ReadOptions(_stamp(stamp), tuple(paths), first, last)
    judge = Judge(prepared.compiled, prepared.specification, reading, remarks=prepared.late)
    return (_judged(prepared, judge, recording) for recording in recordings)


def _files(recordings: Iterator[Recorded]) -> Iterator[Path]:
    """Those at the beginning of `recordings` that are files."""
    for each in recordings:
        if not isinstance(each, str | PathLike):
            return
        yield Path(each)


def _stamp(name: str) -> Stamp:
    if name not in [stamp.value for stamp in Stamp]:
        raise UnusableInput((), f"`{name}` is not a time of a message: use `log` or `header`")
    return Stamp(name)


def _judged(prepared: Prepared, judge: Judge, recording: Recorded) -> Run:
    """What one recording shows. Raises UnusableInput."""
    path, opener = opening(prepared, recording)
    judge = judge if opener is judge.open else replace(judge, open=opener)
    return run_of(prepared, judge, path, judge.judge(path))


def opening(prepared: Prepared, recording: Recorded) -> tuple[Path, Open]:
    """What `recording` is called, and what opens it. Raises UnusableInput."""
    if isinstance(recording, str | PathLike):
        return Path(recording), open_recording
    return NAME, _opener(prepared, recording)


def run_of(prepared: Prepared, judge: Judge, path: Path, report: RunReport) -> Run:
    """What `judge` found in the recording at `path`. Raises UnusableInput if nothing could be judged."""
    if report.session is None:
        raise UnusableInput(report.diagnostics)
    told = replace(report, diagnostics=(*prepared.diagnostics, *report.diagnostics))
    return Run(told, partial(_page, judge, path), partial(_robustness, judge, path))


def _robustness(judge: Judge, path: Path) -> Mapping[str, Curve]:
    """By how much the properties hold, of a recording which is judged again for it."""
    return replace(judge, measures=True).judge(path).robustness


def _page(judge: Judge, path: Path, is_framed: bool) -> str:
    """The page about a recording, which is judged again for it, with all that its properties go through."""
    from ltlc.interfaces.pages.report import PageReport

    page = PageReport(judge.compiled, judge.specification)
    collected = page.collector()
    page.add(replace(judge, keep_trails=True).judge(path, [collected.take]), collected)
    return page.html(is_framed=is_framed)


def _opener(prepared: Prepared, recording: Rows | ArrowStream) -> Open:
    """What opens a recording that is in no file. Raises UnusableInput."""
    if hasattr(recording, "__arrow_c_stream__"):
        return lambda path, signals, _: FromTable(path, arrow_table(path, recording), signals)
    if not isinstance(recording, Iterable):
        raise UnusableInput((), f"{recording!r:.100} is not a recording: give a file, rows or a table")
    rows = [_row(number, row) for number, row in enumerate(recording, 1)]
    if not any(TIME in row for row in rows) and not needs_time(prepared.specification, prepared.compiled):
        rows = [{TIME: number, **row} for number, row in enumerate(rows)]
    return lambda path, signals, _: FromTable(path, GivenTable(path, rows), signals)


def _row(number: int, row: object) -> Row:
    match row:
        case Mapping():
            return row
        case (time, Mapping() as values):
            return {**values, TIME: time}
        case _:
            pass
    help = "a row must be a mapping from signals to values, or a time and such a mapping"
    raise UnusableInput((), f"row {number} is {row!r:.100}; {help}; give columns as `pyarrow.table(columns)`")
