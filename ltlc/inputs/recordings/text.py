"""Recordings as text, compressed or not, read in pieces of whole lines, so that their size does not matter."""

from __future__ import annotations

import gzip
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ltlc.inputs.recordings.rows import RecordingError, failure

SIZE = 3 << 20
"""How many bytes a piece has: enough rows for work by columns, few enough to be held several times."""

LONGEST = 1 << 23
"""No line has more bytes: what decompresses to one would fill the memory."""

AT_ONCE = 1 << 16
"""How many are asked for at a time: where a compressed file is cut off, what was to come with the cut is lost."""

SHORT = 1 << 12
"""How many one has of which the first line is wanted."""

COMPRESSED = (".gz", ".zst")
"""How the names of files end that are compressed: by gzip, by zstd."""

_MARK = b"\xef\xbb\xbf"


class Text:
    """A text file that is open.

    `line` is how many lines come before the next piece; the consumer counts them.
    """

    def __init__(self, path: Path, file: Any) -> None:
        self._path = path
        self._file = file
        self._rest = b""
        self._least = 0
        self._damage: RecordingError | None = None
        self.line = 0
        self._is_read = False
        self._more(len(_MARK))
        self._rest = self._rest.removeprefix(_MARK)

    @property
    def is_at_end(self) -> bool:
        """Whether nothing comes after what has been taken."""
        return self._is_read and not self._rest

    def piece(self, size: int | None = None) -> bytes:
        """The next lines, of about `size` bytes; nothing when all have been taken.

        Raises RecordingError, after what could be read before it.
        """
        size = size or SIZE
        self._more(size)
        while not (end := self._end()) and not self._is_read:
            if len(self._rest) > LONGEST + self._least:
                raise self._too_long()
            self._more(max(size, len(self._rest)))
        if not end and self._damage is not None:
            raise self._damage
        piece, self._rest = self._rest[:end], self._rest[end:]
        return piece

    def _too_long(self) -> RecordingError:
        message = f"`{self._path}` is damaged: a line after line {self.line} is longer than {LONGEST} bytes"
        return failure("LTL820", self._path, message, "is a quote or the end of a line missing?")

    def put_back(self, lines: bytes) -> None:
        """Let the next piece begin with these lines, which were taken last, and have more than they."""
        self._rest = lines + self._rest
        self._least = len(lines)
        if self._least > LONGEST + SIZE and not self._is_read:
            raise self._too_long()

    def _more(self, size: int) -> None:
        """Read about `size` bytes: what decompresses gives fewer at a time."""
        if self._is_read:
            return
        parts = [self._rest]
        while size > 0 and not self._is_read:
            try:
                read = self._file.read1(min(size, AT_ONCE))
            except Exception as error:
                self._damage, read = _unreadable(self._path, error), b""
            self._is_read = not read
            parts.append(read)
            size -= len(read)
        self._rest = b"".join(parts)
        if self._damage is not None:
            self._rest = self._rest[: _last_end(self._rest)]

    def _end(self) -> int:
        """Where in what is left the last line ends of which the end is known."""
        if self._is_read:
            return len(self._rest)
        end = _last_end(self._rest)
        return end if end > self._least else _last_line(self._rest)


def _last_end(text: bytes) -> int:
    """Where the last line ends of which the end is known, but for a line break between two quotes; 0 if there is none.

    Quotes are not looked at closely: the reader of the lines finds out, and puts them back.
    """
    end = _last_line(text)
    if b'"' in text and text.count(b'"', 0, end) % 2:
        return text.rfind(b"\n", 0, text.rfind(b'"', 0, end)) + 1 or end
    return end


def _last_line(text: bytes) -> int:
    return text.rfind(b"\n") + 1 or text.rfind(b"\r", 0, -1) + 1


@contextmanager
def opened(path: Path) -> Iterator[Text]:
    """The text file at `path`. Raises RecordingError."""
    try:
        file = _file(path)
    except OSError as error:
        raise _unreadable(path, error) from None
    with file:
        yield Text(path, file)


def _file(path: Path) -> Any:
    """What reads the bytes at `path` as they were before they were compressed."""
    match path.suffix.lower():
        case ".gz":
            return gzip.open(path)
        case ".zst":
            import pyarrow  # zstandard's reader does not notice that a file is cut off

            return pyarrow.CompressedInputStream(str(path), "zstd")
        case _:
            return path.open("rb")


def _unreadable(path: Path, error: Exception) -> RecordingError:
    """The message about `error`, of the file or of the compressed data in it; each library has its own."""
    if isinstance(error, OSError) and error.strerror is not None:
        return failure("LTL902", path, f"`{path}` cannot be read: {error.strerror}")
    return failure(
        "LTL820", path, f"`{path}` is damaged: {error}", "is it cut off? compress it again, or decompress it"
    )


def in_utf8(path: Path, text: bytes) -> str:
    """`text` as characters. Raises RecordingError."""
    try:
        return text.decode()
    except UnicodeDecodeError:
        raise failure("LTL903", path, f"`{path}` is not UTF-8 text") from None
