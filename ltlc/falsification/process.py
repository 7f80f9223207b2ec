"""A command that runs beside us, with all that it starts, until it ends or takes too long."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from ltlc.runtime.reports import printable
from ltlc.semantics.durations import Nanoseconds, duration_text

MOST_SAID = 200
"""So many characters of what a command said last are shown."""


class Process:
    """A command, begun with these variables beside ours; what it says goes to the file `output`.

    Once it no longer runs, `failure` says why it did not end well; it is empty if it did.
    """

    def __init__(
        self, command: Sequence[str], environment: Mapping[str, str], output: Path, time_limit: Nanoseconds
    ) -> None:
        self._output = output
        self._time_limit = time_limit
        self._deadline = time.monotonic() + time_limit / 1e9
        self._process: subprocess.Popen[bytes] | None = None
        self.failure = ""
        with output.open("wb") as file:
            try:
                self._process = subprocess.Popen(
                    command,
                    stdin=subprocess.DEVNULL,
                    stdout=file,
                    stderr=subprocess.STDOUT,
                    env={**os.environ, **environment},
                    start_new_session=True,
                )
            except (OSError, ValueError) as error:
                reason = error.strerror if isinstance(error, OSError) else str(error)
                self.failure = f"`{command[0]}` cannot be started: {reason}"

    def is_running(self) -> bool:
        """Whether it still runs; what it left running is ended with it."""
        if self._process is None:
            return False
        code = self._process.poll()
        if code is None and time.monotonic() < self._deadline:
            return True
        if code is None:
            self.failure = f"it took more than {duration_text(self._time_limit)}{said(self._output)}"
        elif code:
            how = f"ended with exit code {code}" if code > 0 else f"was ended by {signal.Signals(-code).name}"
            self.failure = f"it {how}{said(self._output)}"
        self.end()
        return False

    def end(self) -> None:
        """End it, if it still runs."""
        if self._process is not None:
            with suppress(ProcessLookupError):
                os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()
            self._process = None


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Put off Ctrl-C and requests to end: a command that is started is also noted, so that it can be ended."""
    come: list[int] = []
    before = {each: signal.signal(each, lambda number, _: come.append(number)) for each in _ENDING}
    try:
        yield
    finally:
        for each, handler in before.items():
            signal.signal(each, handler)
    for number in come:
        signal.raise_signal(number)


_ENDING = (signal.SIGINT, signal.SIGTERM)


def said(output: Path) -> str:
    """The last line in a file of what a command said, after a colon; nothing if there is none."""
    with output.open("rb") as file:
        file.seek(max(0, file.seek(0, os.SEEK_END) - MOST_SAID * 4))
        lines = file.read().decode(errors="replace").split("\n")
    last = printable(next((line.strip() for line in reversed(lines) if line.strip()), ""))
    return f": {last[:MOST_SAID]}" if last else ""
