"""One line on the terminal that shows the progress of a command that takes longer than a moment."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from time import monotonic

from ltlc.base.limits import Watch

AFTER_SECONDS = 1.0
"""What takes less time than this goes without."""

EVERY_SECONDS = 0.1
"""How often the line is written anew."""

_CLEAR = "\r\x1b[K"


@contextmanager
def progress(what: str, quiet: bool) -> Iterator[Watch | None]:
    """What to tell how far `what` is, None where nobody reads it: in pipes, in CI, if `quiet`. At its end it goes."""
    with saying(what, quiet) as say:
        yield None if say is None else lambda done, of: say(f"{done} of {of}")


@contextmanager
def saying(what: str, quiet: bool) -> Iterator[Callable[[str], None] | None]:
    """As `progress`, where it is not known how much there is to do: what is told is shown as it is.

    Where nothing is told, the line has the time that it has taken.
    """
    if quiet or not sys.stderr.isatty() or os.environ.get("CI") or os.environ.get("TERM") == "dumb":
        yield None
        return
    line = _Line(what)
    try:
        with _every(EVERY_SECONDS, line.write):
            yield line.say
    finally:
        line.clear()


@contextmanager
def _every(seconds: float, call: Callable[[], None]) -> Iterator[None]:
    """Call again and again, by a signal: threads do not go with children that are forked, which inherit no timer."""
    if threading.current_thread() is not threading.main_thread() or not hasattr(signal, "setitimer"):
        yield
        return

    def alarm(*_: object) -> None:
        with suppress(RuntimeError):  # where it comes in the middle of writing to the same file
            call()

    before = signal.signal(signal.SIGALRM, alarm)
    signal.siginterrupt(signal.SIGALRM, False)
    signal.setitimer(signal.ITIMER_REAL, seconds, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


class _Line:
    def __init__(self, what: str) -> None:
        self._what = what
        self._state = ""
        self._start = monotonic()
        self._next = self._start + AFTER_SECONDS
        self._is_shown = False

    def say(self, state: str) -> None:
        self._state = f", {state}"
        self.write()

    def write(self) -> None:
        now = monotonic()
        if now < self._next:
            return
        self._next = now + EVERY_SECONDS
        self._is_shown = True
        sys.stderr.write(f"{_CLEAR}ltlc: {self._what}{self._state} ({now - self._start:.0f} s)")
        sys.stderr.flush()

    def clear(self) -> None:
        if self._is_shown:
            sys.stderr.write(_CLEAR)
            sys.stderr.flush()
