"""Results of a campaign in one Parquet table, which is there as they arrive, and what is done once stays done.

Beside the table is a journal, to which each outcome is appended when it arrives; now and then both become the table,
written whole under another name first. Whenever the process ends, the table can be read, and table and journal
together have all that had arrived.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from hashlib import sha256
from itertools import chain, groupby
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any, Self

from ltlc import __version__
from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.libraries import command
from ltlc.base.source import Source
from ltlc.monitoring.campaigns.journal import InUseError, Journal
from ltlc.monitoring.campaigns.outcomes import Outcome
from ltlc.monitoring.campaigns.places import Location
from ltlc.monitoring.campaigns.rows import COLUMNS, Row, outcome_of, rows_of

if TYPE_CHECKING:
    from pyarrow import Table

SECONDS = 10.0
"""How old what is only in the journal may become, as long as writing the table takes far less than that."""

_MARK = b"ltlc.results"


class ResultsError(Exception):
    """There is no table of results, for the reason that `diagnostic` gives."""

    def __init__(self, path: Path, message: str, help: str = "") -> None:
        super().__init__(message)
        self.diagnostic: Diagnostic = diagnostic("LTL833", Source(str(path), ""), None, message, help=help)


class Results:
    """The table at `path`, of the recordings at `places` and no others, as they were `judged_with` one specification.

    What is there of earlier campaigns is kept as long as it `is_complete`.

    Raises ResultsError if there is something else, or it cannot be written.
    """

    def __init__(
        self,
        path: Path,
        judged_with: str,
        places: Iterable[Location],
        is_complete: Callable[[Outcome], bool] | None = None,
    ) -> None:
        self._path = path
        self._judged_with = judged_with
        self._is_complete = is_complete
        _refuse_without_pyarrow(path)
        with self._writing():
            self._journal = Journal(_journal_of(path))
        try:
            self._saved = self._standing({place.name: place for place in places})
            self._arrived: list[Row] = []
            self._save()
            with self._writing():
                self._journal.clear()
        except BaseException:
            self._journal.close()
            raise

    def names(self) -> set[str]:
        """The recordings that are in the table."""
        return set(self._saved.column("recording").to_pylist())

    def kept(self) -> Iterator[Outcome]:
        """What is in the table."""
        return _outcomes(self._path, self._saved)

    def add(self, outcome: Outcome) -> None:
        """Keep what has arrived. Raises ResultsError."""
        made = {"judged_with": self._judged_with, "ltlc": __version__}
        rows = [{name: _storable(cell) for name, cell in (row | made).items()} for row in rows_of(outcome)]
        self._arrived += rows
        with self._writing():
            self._journal.add(rows)
        if monotonic() > self._next:
            self._save()
            with self._writing():
                self._journal.clear()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        """Write the table; then there is no journal."""
        try:
            self._save()
            self._journal.remove()
        finally:
            self._journal.close()

    def _standing(self, places: Mapping[str, Location]) -> Table:
        """What is there of earlier campaigns, and still so of `places`. Raises ResultsError."""
        try:
            return self._complete(self._still_so(self._read(), _journaled(self._journal), places))
        except (UnicodeDecodeError, MemoryError) as error:
            raise _damaged(self._path, str(error)) from None

    def _still_so(self, saved: Table, later: Table, places: Mapping[str, Location]) -> Table:
        """The rows of the table, and those that came `later`, that are still so of `places`."""
        import pyarrow

        again = set(later.column("recording").to_pylist())
        both = pyarrow.concat_tables([saved, later])
        told = both.select(["recording", "size", "version", "error_code", "judged_with"]).to_pylist()
        standing = [
            number
            for number, row in enumerate(told)
            if self._stands(row, places.get(row["recording"]))
            and (number >= len(saved) or row["recording"] not in again)
        ]
        return both.take(pyarrow.array(standing, "int64"))

    def _complete(self, table: Table) -> Table:
        """The rows of the recordings of which all is there. Raises ResultsError."""
        import pyarrow

        if self._is_complete is None:
            return table
        complete = {each.place.name for each in _outcomes(self._path, table) if self._is_complete(each)}
        return table.filter(pyarrow.array([name in complete for name in table.column("recording").to_pylist()], "bool"))

    def _stands(self, row: Row, place: Location | None) -> bool:
        """Whether a row about the recording at `place` is still valid."""
        if place is None or not place.version or row["error_code"] is not None:
            return False
        was = (row["size"], row["version"], row["judged_with"])
        return was == (place.size, place.version, self._judged_with)

    def _read(self) -> Table:
        """The table as it was written last, empty if there is none of this version. Raises ResultsError."""
        table = _table_at(self._path) if self._path.exists() else _table(())
        return table if _is_of_this_version(table) else _table(())

    def _save(self) -> None:
        """Write the table as it is now. Raises ResultsError."""
        import pyarrow.parquet

        start = monotonic()
        self._saved = pyarrow.concat_tables([self._saved, _table(self._arrived)])
        self._arrived = []
        unfinished = self._path.with_name(f".{self._path.name}.{os.getpid()}.part")
        with self._writing():
            try:
                pyarrow.parquet.write_table(self._saved, unfinished, compression="zstd")
                os.replace(unfinished, self._path)
            finally:
                unfinished.unlink(missing_ok=True)
        now = monotonic()
        self._next = now + max(SECONDS, 20 * (now - start))

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """Raises ResultsError for errors of the system, and if another campaign has the journal."""
        try:
            yield
        except InUseError:
            message = f"another campaign is writing `{self._path}`"
            raise ResultsError(self._path, message, "wait until it ends, or give another name") from None
        except OSError as error:
            message = f"`{self._path}` cannot be written: {error.strerror or error}"
            raise ResultsError(self._path, message) from None


def is_unfinished(path: Path) -> bool:
    """Whether a campaign is writing the table at `path`, or was interrupted."""
    return _journal_of(path).exists()


def _journal_of(path: Path) -> Path:
    return path.with_name(f"{path.name}.journal")


def outcomes_at(path: Path) -> Iterator[Outcome]:
    """What campaigns have kept in the table at `path`, which stays as it is. Raises ResultsError."""
    _refuse_without_pyarrow(path)
    if not path.is_file():
        raise ResultsError(path, f"there is no table of results `{path}`", "`ltlc run … --results` writes one")
    table = _table_at(path)
    if not _is_of_this_version(table):
        message = f"`{path}` was written by another version of ltlc, which kept other columns"
        raise ResultsError(path, message, "judge the recordings again: `ltlc run … --results`")
    yield from _outcomes(path, table)


def _table_at(path: Path) -> Table:
    """The table at `path`, by whatever version of ltlc. Raises ResultsError."""
    import pyarrow.parquet

    try:
        table = pyarrow.parquet.ParquetFile(path).read()
    except (OSError, pyarrow.ArrowException) as error:
        message = f"`{path}` exists and is not a table of results: {error}"
        raise ResultsError(path, message, "give another name; the file was not changed") from None
    if _MARK not in (table.schema.metadata or {}):
        message = f"`{path}` exists and is not a table of results of ltlc"
        raise ResultsError(path, message, "give another name; the file was not changed")
    return table


def _is_of_this_version(table: Table) -> bool:
    is_so: bool = table.schema.equals(_table(()).schema)
    return is_so


def _outcomes(path: Path, table: Table) -> Iterator[Outcome]:
    """The outcomes in the rows of a table. Raises ResultsError."""
    rows = chain.from_iterable(batch.to_pylist() for batch in table.to_batches(max_chunksize=1000))
    for recording, of_one in groupby(rows, key=lambda row: str(row["recording"])):
        try:
            outcome = outcome_of(list(of_one))
            rows_of(outcome)  # which needs of it what others need
        except (LookupError, TypeError, ValueError, AttributeError, RecursionError):
            raise _damaged(path, f"its entry for `{recording}` cannot be read") from None
        yield outcome


def _damaged(path: Path, what: str) -> ResultsError:
    help = "remove it, or give another name: then everything is judged"
    return ResultsError(path, f"`{path}` is damaged: {what}", help)


def digest(parts: Iterable[str]) -> str:
    """What two campaigns share if they judged with the same specification, settings and version of ltlc."""
    return sha256(json.dumps([__version__, *parts]).encode()).hexdigest()


def _storable(cell: Any) -> Any:
    """`cell`, where a file name that is not text is written with escapes."""
    return cell.encode(errors="backslashreplace").decode() if isinstance(cell, str) else cell


def _table(rows: Iterable[Row]) -> Table:
    import pyarrow

    schema = pyarrow.schema(list(COLUMNS.items()), metadata={_MARK: b"1"})
    return pyarrow.Table.from_pylist(list(rows), schema)


def _journaled(journal: Journal) -> Table:
    """What arrived after the table was written last; what is not one of its rows is skipped."""
    import pyarrow

    tables = [_table(())]
    for entry in journal.entries():
        with suppress(pyarrow.ArrowException, AttributeError, LookupError, TypeError, ValueError):
            tables.append(_table(row for row in entry if row["recording"] is not None))
    return pyarrow.concat_tables(tables).combine_chunks()


def _refuse_without_pyarrow(path: Path) -> None:
    try:
        import pyarrow.parquet  # noqa: F401
    except ImportError:
        message = "a table of results is written by pyarrow, which is not installed"
        raise ResultsError(path, message, command("recordings")) from None
