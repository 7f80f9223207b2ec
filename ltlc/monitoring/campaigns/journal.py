"""The journal beside a table of results: what has arrived since that was written. One campaign has it at a time."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import suppress
from errno import ENOSPC
from io import FileIO
from pathlib import Path
from typing import Any


class InUseError(Exception):
    """Another process has the journal."""


class Journal:
    """The journal at `path`, which is made if it is not there. Raises OSError and InUseError."""

    def __init__(self, path: Path) -> None:
        self._path = path
        while True:
            self._file = path.open("ab", buffering=0)
            try:
                _lock(self._file)
                if self._is_there():
                    return
            except InUseError:
                self._file.close()
                raise
            self._file.close()  # its campaign has ended, and removed it, in between

    def _is_there(self) -> bool:
        with suppress(FileNotFoundError):
            return os.path.samestat(self._path.stat(), os.fstat(self._file.fileno()))
        return False

    def entries(self) -> Iterator[Any]:
        """What is in it, line by line; a line that is not JSON, such as a last one that is cut off, is passed over."""
        if not self._path.is_file():
            return
        for line in self._path.read_text(encoding="utf-8", errors="replace").splitlines():
            with suppress(ValueError, RecursionError):
                yield json.loads(line)

    def add(self, entry: Any) -> None:
        """Write a line. Raises OSError."""
        line = f"{json.dumps(entry)}\n".encode()
        if self._file.write(line) != len(line):
            raise OSError(ENOSPC, os.strerror(ENOSPC))

    def clear(self) -> None:
        """Begin anew. Raises OSError."""
        if self._path.is_file():
            self._file.truncate(0)

    def remove(self) -> None:
        """It is not needed any more."""
        self._path.unlink(missing_ok=True)

    def close(self) -> None:
        """Let others have it; one with nothing in it is removed."""
        if self._path.is_file() and not self._path.stat().st_size:
            self.remove()
        self._file.close()


def _lock(file: FileIO) -> None:
    """Take hold of a file. Raises InUseError; where files cannot be locked, nothing happens."""
    try:
        import fcntl
    except ImportError:  # Windows
        return
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise InUseError from None
    except OSError:
        return
