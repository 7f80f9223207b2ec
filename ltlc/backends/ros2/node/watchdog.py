"""The parent of a node is its watchdog: it reports its verdicts if it hangs or dies."""

from __future__ import annotations

import ctypes
import json
import mmap
import os
import select
import sys
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from signal import (
    SIG_BLOCK,
    SIG_DFL,
    SIG_UNBLOCK,
    SIGCHLD,
    SIGINT,
    SIGKILL,
    SIGTERM,
    pthread_sigmask,
)
from signal import signal as on_signal
from typing import Any, NoReturn

from ltlc.backends.ros2.node.files import Lines, UnusableError, write_text

UNUSABLE = 2
"""The exit code of a node that cannot run, or not report, as asked."""


class Pulse:
    """What a node shows its watchdog: that it lives, its last words, and its exit code.

    Memory of both, since the watchdog looks at it when the node can do nothing any
    more. There are two places for words, filled in turn, so that one is always whole.
    """

    HEAD = 64
    PLACE = 1 << 24
    BEATS, CURRENT, LENGTHS, CODE = 0, 1, 2, 4

    def __init__(self) -> None:
        self._memory = mmap.mmap(-1, self.HEAD + 2 * self.PLACE)
        self._numbers = memoryview(self._memory)[: self.HEAD].cast("q")

    @property
    def beats(self) -> int:
        """How often the node has shown that it lives; 0: its loop has not begun."""
        return self._numbers[self.BEATS]

    def beat(self) -> None:
        """Show that the node lives."""
        self._numbers[self.BEATS] += 1

    @property
    def code(self) -> int | None:
        """The exit code, once the node has reported its verdicts."""
        return self._numbers[self.CODE] - 1 if self._numbers[self.CODE] else None

    def finish(self, code: int) -> None:
        """The node has reported its verdicts, and ends with this exit code."""
        self._numbers[self.CODE] = code + 1

    @property
    def words(self) -> dict[str, Any]:
        """What to report for the node; empty if it has left nothing."""
        current = self._numbers[self.CURRENT]
        start = self.HEAD + current * self.PLACE
        length = self._numbers[self.LENGTHS + current]
        found: dict[str, Any] = json.loads(self._memory[start : start + length] or "{}")
        return found

    def leave(self, words: dict[str, Any]) -> None:
        """Leave what to report if the node no longer can; too much is not taken."""
        data = json.dumps(words).encode()
        if len(data) > self.PLACE:
            return
        other = 1 - self._numbers[self.CURRENT]
        start = self.HEAD + other * self.PLACE
        self._memory[start : start + len(data)] = data
        self._numbers[self.LENGTHS + other] = len(data)
        self._numbers[self.CURRENT] = other


def with_watchdog(run: Callable[[Pulse], int]) -> int:
    """`run` a node in a child of this process; its exit code.

    A thread could not be the watchdog: rclpy holds the interpreter while it asks the
    middleware, so that a call that never returns stops every thread of Python.
    """
    pulse = Pulse()
    sys.stdout.flush()
    sys.stderr.flush()
    pthread_sigmask(SIG_BLOCK, (SIGINT, SIGTERM))
    on_signal(SIGCHLD, SIG_DFL)  # else nobody could ask how the child ended
    parent, (reading, writing) = os.getpid(), os.pipe()
    pid = os.fork()
    if pid == 0:
        os.close(reading)
        live(run, pulse, parent)
    os.close(writing)

    def pass_on(number: int, _: Any) -> None:
        with suppress(ProcessLookupError):
            os.kill(pid, number)

    for number in (SIGINT, SIGTERM):
        on_signal(number, pass_on)
    pthread_sigmask(SIG_UNBLOCK, (SIGINT, SIGTERM))
    return Watchdog(pid, reading, pulse).exit_code()


def live(run: Callable[[Pulse], int], pulse: Pulse, parent: int) -> NoReturn:
    """In the child: be the node, and end as it does, or with its parent."""
    code = UNUSABLE
    try:
        if sys.platform == "linux":
            ctypes.CDLL(None).prctl(1, SIGKILL)  # PR_SET_PDEATHSIG
        if os.getppid() == parent:
            code = run(pulse)
    except SystemExit as end:  # of --help, or of arguments that are refused
        code = end.code if isinstance(end.code, int) else UNUSABLE
    except BaseException:  # noqa: BLE001
        traceback.print_exc()
    finally:
        pulse.finish(code)
        with suppress(OSError):
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(code)


class Watchdog:
    """Waits for a node to end, and ends one that hangs.

    It hangs if it has not shown for `PATIENCE` s that it lives. Time in which the
    watchdog itself did not run, because the machine is busy or sleeps, is not counted,
    nor time in which the node has been stopped, as by a debugger, or waits for a disk.
    """

    LOOK = 0.1
    PATIENCE = 5.0

    def __init__(self, pid: int, pipe: int, pulse: Pulse) -> None:
        """The `pipe` is closed when the node ends."""
        self._pid = pid
        self._pipe = pipe
        self._pulse = pulse
        self._beats = 0
        self._silent = 0.0

    def exit_code(self) -> int:
        """That of the node, once it has ended; nothing else than its word counts."""
        self._wait()
        _, status = os.waitpid(self._pid, 0)
        os.close(self._pipe)
        if self._pulse.code is not None:
            return self._pulse.code
        if self._silent > self.PATIENCE:
            return self._tell(
                f"hung: its loop did not respond for {self.PATIENCE:.0f} s"
            )
        ended = os.waitstatus_to_exitcode(status)
        how = f"signal {-ended}" if ended < 0 else f"exit code {ended}"
        return self._tell(f"died with {how}")

    def _wait(self) -> None:
        """Wait until the node has ended; if it hangs, end it."""
        looked = time.monotonic()
        while not select.select([self._pipe], [], [], self.LOOK)[0]:
            now = time.monotonic()
            if self._pulse.beats != self._beats:
                self._beats, self._silent = self._pulse.beats, 0.0
            elif self._beats and now - looked < 2 * self.LOOK and self._is_free():
                self._silent += now - looked
            looked = now
            if self._silent > self.PATIENCE:
                os.kill(self._pid, SIGKILL)
                return

    def _is_free(self) -> bool:
        """Whether the node works or waits, and was not stopped."""
        try:
            text = Path(f"/proc/{self._pid}/stat").read_text(encoding="utf-8")
        except OSError:
            return True
        return text.rpartition(")")[2].split()[0] in ("R", "S")

    def _tell(self, what: str) -> int:
        """Tell the verdicts that the node last had; its exit code."""
        words = self._pulse.words
        say(f"the node {what}")
        if not words:
            return UNUSABLE
        say(f"its last verdicts:\n{words['summary']}")
        try:
            if words["jsonl"] is not None:
                line = json.dumps({**words["final"], "failed": f"the node {what}"})
                Lines(Path(words["jsonl"])).write(line)
            if words["junit"] is not None:
                write_text(Path(words["junit"]), words["suites"])
        except (OSError, UnusableError) as error:
            say(f"a report cannot be written: {error}")
        return 1 if words["is_violated"] else UNUSABLE


def say(text: str) -> None:
    """Write to stderr, if there is one."""
    with suppress(OSError):
        print(text, file=sys.stderr, flush=True)
