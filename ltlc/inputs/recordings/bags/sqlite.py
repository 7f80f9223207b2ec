"""The database files of rosbag2's sqlite3 storage."""

from __future__ import annotations

import sqlite3
from collections.abc import Collection, Iterator
from contextlib import closing
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from ltlc.inputs.messages.texts import full_name
from ltlc.inputs.recordings.bags.chunked import Message
from ltlc.inputs.recordings.bags.mcap_records import Channel, Contents, Schema
from ltlc.inputs.recordings.bags.messages import LARGEST, LATEST, Batch, Messages, Room, Topic, span_of
from ltlc.inputs.recordings.rows import RecordingError, failure
from ltlc.runtime.mcap import metadata
from ltlc.semantics.durations import Nanoseconds

ENOUGH = 1 << 22
"""So many bytes of messages are taken together."""

MOST = 1 << 13
"""So many messages are taken together, at most about."""

FEW = 1 << 7
"""So many rows are fetched at once, fewer if they are large: their memory is used again for the next."""

_HASH = "type_description_hash"
"""The column with the hash of a topic's type, which databases have from version 4 of their schema on."""

_FAULTS = (sqlite3.Error, OSError, OverflowError, UnicodeDecodeError)
"""What comes of a file that is damaged: the last one where SQLite quotes what is not text."""


class SqliteStorage:
    """A database of topics and messages. Raises RecordingError if it is not one."""

    remarks = ()

    def __init__(self, path: Path) -> None:
        self._path = path
        try:
            with closing(self._opened()) as database:
                self._refuse_views(database)
                found = database.execute("select id, name, type, serialization_format from topics")
                rows = _of_types(found, int, str, str, str)
                definitions = _definitions(database)
                self.distribution = _distribution(database)
                self.span = _span(database)
        except _FAULTS as error:
            raise self._unusable(error) from None
        self._ids: dict[str, list[int]] = {}
        for number, name, _, _ in rows:
            self._ids.setdefault(name, []).append(number)
        self.topics = {name: self._topic(name, rows, definitions) for name in self._ids}

    def _opened(self) -> sqlite3.Connection:
        """The database; what a recorder that was killed has left in a journal beside it is taken, too."""
        journals = (self._path.with_name(self._path.name + end) for end in ("-wal", "-journal"))
        is_whole = not any(journal.exists() and journal.stat().st_size for journal in journals)
        path = str(self._path.absolute()).replace("%", "%25").replace("?", "%3f").replace("#", "%23")
        database = sqlite3.connect(f"file:{path}?mode=ro{'&immutable=1' if is_whole else ''}", uri=True)
        database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LARGEST)
        return database

    def _refuse_views(self, database: sqlite3.Connection) -> None:
        """Raise sqlite3.DataError if something is not a table: a view could make rows forever."""
        kinds = database.execute("select distinct type from sqlite_master where name in ('topics', 'messages')")
        if [kind for (kind,) in kinds if kind != "table"]:
            raise sqlite3.DataError("its topics or messages are not a table")

    def _topic(self, name: str, rows: list[Any], definitions: dict[str, tuple[str, str]]) -> Topic:
        of = [row for row in rows if row[1] == name]
        types = ", ".join(dict.fromkeys(full_name(row[2]) for row in of))
        form, text = definitions.get(types, ("", ""))
        return Topic(types, ", ".join(dict.fromkeys(row[3] for row in of)), form, text, None)

    def batches(self, topics: Collection[str], since: Nanoseconds, until: Nanoseconds) -> Iterator[Batch]:
        """The messages of `topics`. Raises RecordingError after those that could be read."""
        ids = {number: name for name in topics for number in self._ids.get(name, ())}
        columns = "timestamp, data" if len(set(ids.values())) == 1 else "timestamp, data, topic_id"
        query = f"select {columns} from messages where topic_id in ({', '.join('?' * len(ids))})"
        values: list[int] = [*ids]
        if since > -LATEST or until < LATEST:
            query += " and timestamp between ? and ? order by timestamp, id"
            values += [since, until]
        else:
            query += " order by id"
        try:
            with closing(self._opened()) as database:
                yield from _batches(database.execute(query, values), ids)
        except _FAULTS as error:
            raise self._damaged(error) from None
        except TypeError:
            raise self._damaged("a message is not a blob, or its time is not a number") from None

    def contents(self) -> Contents:
        """Its topics as schemas and channels of MCAP, each with the number that it has. Raises RecordingError."""
        contents = Contents()
        try:
            with closing(self._opened()) as database:
                definitions = _definitions(database)
                cursor = database.execute("select * from topics")
                names = [column[0] for column in cursor.description]
                rows = [dict(zip(names, row, strict=True)) for row in cursor]
        except _FAULTS as error:
            raise self._unusable(error) from None
        for row in rows:
            number, type_ = row["id"], row["type"]
            kept = {"offered_qos_profiles": row.get("offered_qos_profiles"), "topic_type_hash": row.get(_HASH)}
            more = metadata({key: text for key, text in kept.items() if isinstance(text, str)})
            form, text = definitions.get(full_name(type_), ("", ""))
            contents.schemas[number] = Schema(type_, form, text.encode())
            contents.channels[number] = Channel(number, row["name"], row["serialization_format"], more)
        return contents

    def items(self, since: Nanoseconds, until: Nanoseconds) -> Iterator[Message]:
        """The messages recorded from `since` to `until`. Raises RecordingError."""
        query = "select topic_id, timestamp, data from messages where timestamp between ? and ? order by timestamp, id"
        try:
            with closing(self._opened()) as database:
                for number, time, data in database.execute(query, (since, until)):
                    if not isinstance(data, bytes):
                        raise self._damaged("a message is not a blob")
                    yield Message(number, 0, time, time, data)
        except _FAULTS as error:
            raise self._damaged(error) from None

    def _unusable(self, error: Exception) -> RecordingError:
        message = f"`{self._path}` cannot be read as a database of rosbag2: {error}"
        return failure("LTL811", self._path, message, "is it complete, and was it recorded by `ros2 bag record`?")

    def _damaged(self, what: object) -> RecordingError:
        help = "`sqlite3 BAG .recover` saves what can be saved; the verdicts are about what comes before the damage"
        return failure("LTL811", self._path, f"`{self._path}` is damaged: {what}", help)


def _has(database: sqlite3.Connection, table: str) -> bool:
    return database.execute("select 1 from sqlite_master where name = ?", (table,)).fetchone() is not None


def _distribution(database: sqlite3.Connection) -> str:
    """The distribution of the recorder, which databases name from version 3 of their schema on."""
    if not _has(database, "schema"):
        return ""
    row = database.execute("select ros_distro from schema").fetchone()
    return row[0].lower() if row is not None and isinstance(row[0], str) else ""


def _definitions(database: sqlite3.Connection) -> dict[str, tuple[str, str]]:
    """The form and the text of each type's definition, where the database has them."""
    if not _has(database, "message_definitions"):
        return {}
    rows = database.execute("select topic_type, encoding, encoded_message_definition from message_definitions")
    return {full_name(name): (form, text) for name, form, text in _of_types(rows, str, str, str)}


def _of_types(found: sqlite3.Cursor, *types: type) -> list[Any]:
    """All rows that are found. Raises sqlite3.DataError if their values are not of these types."""
    rows = found.fetchall()
    if any(tuple(map(type, row)) != types for row in rows):
        raise sqlite3.DataError("its topics are malformed")
    return rows


def _span(database: sqlite3.Connection) -> tuple[Nanoseconds, Nanoseconds] | None:
    """The times of the first and the last message; each by itself, for then the index is used.

    Damage of the database shows when messages are read.
    """
    try:
        (first,) = database.execute("select min(timestamp) from messages").fetchone()
        (last,) = database.execute("select max(timestamp) from messages").fetchone()
    except sqlite3.DatabaseError:
        return None
    return span_of(first, last) if isinstance(first, int) and isinstance(last, int) else None


def _batches(cursor: sqlite3.Cursor, ids: dict[int, str]) -> Iterator[Batch]:
    """What the query finds, in parts of about the same size.

    Raises sqlite3.Error and TypeError after what could be read.
    """
    taken = _Taken(ids)
    try:
        few = 1
        while rows := cursor.fetchmany(few):
            size = taken.add(rows)
            few = max(1, min(2 * few, FEW, ENOUGH * len(rows) // max(1, size)))
            if taken.is_enough:
                yield taken.batch()
    except (sqlite3.Error, TypeError):
        yield taken.batch()
        raise
    yield taken.batch()


class _Taken:
    """Rows on the way to a batch."""

    def __init__(self, ids: dict[int, str]) -> None:
        self._ids = ids
        self._room = Room(ENOUGH)
        self._clear()

    def _clear(self) -> None:
        self._room.clear()
        self._numbers: list[int] = []
        self._times: list[int] = []
        self._sizes: list[int] = []

    @property
    def is_enough(self) -> bool:
        return self._room.size >= ENOUGH or len(self._times) >= MOST

    def add(self, rows: list[Any]) -> int:
        """Take the next ones: of each the time, the data and, if there are several, the topic's number.

        How many bytes the data have. Raises TypeError at one that is no message, after those before it.
        """
        times, data, *numbers = zip(*rows, strict=True)
        if {*map(type, times)} != {int} or {*map(type, data)} != {bytes}:
            good = next(n for n, row in enumerate(rows) if (type(row[0]), type(row[1])) != (int, bytes))
            if good:
                self.add(rows[:good])
            raise TypeError
        joined = b"".join(data)
        self._room.add(np.frombuffer(joined, np.uint8))
        self._numbers += chain.from_iterable(numbers)
        self._times += times
        self._sizes += map(len, data)
        return len(joined)

    def batch(self) -> Batch:
        """All of them, by topic."""
        sizes, places = np.array(self._sizes, np.int64), np.arange(len(self._sizes))
        times = np.array(self._times, np.int64)
        found = _by_topic(
            Messages(times, places, self._room.data, sizes.cumsum() - sizes, sizes), self._numbers, self._ids
        )
        self._clear()
        return Batch(found)


def _by_topic(messages: Messages, numbers: list[int], ids: dict[int, str]) -> dict[str, Messages]:
    names = set(ids.values())
    if len(names) == 1:
        return {names.pop(): messages}
    of = np.array(numbers, np.int64)
    found = {}
    for name in names:
        rows = np.flatnonzero(np.isin(of, [number for number, topic in ids.items() if topic == name]))
        if rows.size:
            found[name] = messages.taken(rows)
    return found
