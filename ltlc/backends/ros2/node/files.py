"""The files that verdicts are written to."""

from __future__ import annotations

import os
from collections.abc import Sequence
from errno import ENXIO
from pathlib import Path


class UnusableError(Exception):
    """The node cannot start with these options; the message says why."""


class Lines:
    """A file that lines are appended to, each whole or, if the disk is full, cut off.

    Opening a pipe waits neither for a reader nor for room.
    """

    FLAGS = os.O_WRONLY | os.O_APPEND | os.O_CREAT | os.O_NONBLOCK | os.O_CLOEXEC

    def __init__(self, path: Path) -> None:
        self._is_cut = False
        try:
            self._file = os.open(path, self.FLAGS, 0o666)
        except OSError as error:
            why = error.strerror
            if error.errno == ENXIO:
                why = "no process reads this pipe"
            raise UnusableError(f"jsonl is {str(path)!r}: {why}") from error

    def write(self, line: str) -> None:
        """Append `line`; what there is of one that was cut off keeps its own line."""
        start = "\n" if self._is_cut else ""
        rest = f"{start}{line}\n".encode()
        while rest:
            written = os.write(self._file, rest)
            self._is_cut = True
            rest = rest[written:]
        self._is_cut = False


def test_suites(suites: Sequence[str]) -> str:
    """One JUnit document with all `suites`, each of which is one itself."""
    if len(suites) == 1:
        return suites[0]
    head, _ = suites[0].split("\n", 1)
    bodies = "".join(suite.split("\n", 1)[1] for suite in suites)
    return f"{head}\n<testsuites>\n{bodies}</testsuites>\n"


def write_text(path: Path, text: str) -> None:
    """Write a file that others see either as it was or complete."""
    unfinished = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        unfinished.write_text(text, encoding="utf-8")
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)
