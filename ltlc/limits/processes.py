"""Runs what may take too long in child processes that can be stopped: with a deadline and a bound on memory.

Spot holds the interpreter while it works, ignores signals of Python's, and ends the process when memory runs out; only
another process can bound it. A child bounds itself, by a timer and a resource limit of the system's, so it ends even if
its parent is gone.
"""

from __future__ import annotations

import faulthandler
import os
import pickle
import selectors
import signal
import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any, NoReturn, Self, TypeVar

Result = TypeVar("Result")

NESTING = 10_000
"""Python's recursion limit in a child: formulas may be nested a few thousand deep there."""

_CHUNK = 1 << 16


@dataclass(frozen=True, slots=True)
class Budget:
    """What one job may use: seconds of time on the clock, and megabytes of memory beside those the parent has."""

    seconds: float = 10.0
    megabytes: int = 1024

    def __post_init__(self) -> None:
        if not (self.seconds > 0 and self.megabytes > 0):
            raise ValueError(f"a budget must be positive: {self.seconds} s, {self.megabytes} MB")


class Limit(Enum):
    """Which limit a job ran into."""

    TIME = "time"
    MEMORY = "memory"
    NESTING = "nesting"
    """The formula is nested too deeply for the stack of Python or of Spot."""
    ENGINE = "engine"
    """Spot gave up, or the child ended in a way that names no other limit."""


@dataclass(frozen=True, slots=True)
class Exceeded:
    """There is no result, because of `limit`; `detail` is what the engine said, and may be empty."""

    limit: Limit
    budget: Budget
    detail: str = ""

    def __str__(self) -> str:
        match self.limit:
            case Limit.TIME:
                return f"takes longer than {self.budget.seconds:g} s"
            case Limit.MEMORY:
                return f"needs more than {self.budget.megabytes} MB of memory"
            case Limit.NESTING:
                return "is nested too deeply"
            case Limit.ENGINE:
                return f"is beyond the automata library: {self.detail}"


def run_all(jobs: Sequence[Callable[[], Result]], budget: Budget) -> list[Result | Exceeded]:
    """The result of each job, in order, each job in a child process of its own with `budget`, one per CPU at a time.

    An exception of a job is raised here, except for those that mean a limit; results and exceptions must be picklable.
    Whatever happens here, an interrupt included, no child is left behind. Raises OSError where there is no `os.fork`
    (Windows); where there is no `/proc` (macOS), memory is not bounded.
    """
    if not hasattr(os, "fork"):
        raise OSError("a budget needs processes that can fork, which this system does not have")
    outcomes: dict[int, Any] = {}
    waiting = list(enumerate(jobs))[::-1]
    with _Children(budget) as children:
        while len(outcomes) < len(jobs):
            while waiting and len(children.running) < _cpus():
                children.start(*waiting.pop())
            outcomes |= children.finished()
    return [_value(outcomes[number]) for number in range(len(jobs))]


@dataclass(frozen=True, slots=True)
class _Child:
    job: int
    pid: int
    received: list[bytes]


class _Children:
    """The children that are running, by the pipe on which their outcome comes; on leaving, they are ended."""

    def __init__(self, budget: Budget) -> None:
        self.running: dict[int, _Child] = {}
        self._budget = budget
        self._selector = selectors.DefaultSelector()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        for pipe, child in self.running.items():
            os.close(pipe)
            os.kill(child.pid, signal.SIGKILL)
            os.waitpid(child.pid, 0)
        self._selector.close()

    def start(self, number: int, job: Callable[[], Any]) -> None:
        with _no_interrupt():
            pipe, pid = _start(job, self._budget)
            self.running[pipe] = _Child(number, pid, [])
        self._selector.register(pipe, selectors.EVENT_READ)

    def finished(self) -> dict[int, Any]:
        """Wait until some child writes or ends: the outcomes, by number of the job, of those that have ended."""
        outcomes = {}
        for key, _ in self._selector.select():
            child = self.running[key.fd]
            if received := os.read(key.fd, _CHUNK):
                child.received.append(received)
                continue
            self._selector.unregister(key.fd)
            outcomes[child.job] = _outcome(child, self._budget)
            del self.running[key.fd]
            os.close(key.fd)
        return outcomes


def _cpus() -> int:
    """The CPUs that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def _no_interrupt() -> Iterator[None]:
    """Put off Ctrl-C: a child that is started is also noted."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _start(job: Callable[[], Any], budget: Budget) -> tuple[int, int]:
    """Fork a child that does `job`: the pipe on which its outcome comes, pickled, and its process id."""
    reading, writing = os.pipe()
    pid = fork()
    if pid == 0:
        _be_child(job, budget, writing)
    os.close(writing)
    return reading, pid


def fork() -> int:
    """Fork this process: 0 in the child, and in the parent the child's process id."""
    with warnings.catch_warnings():
        # Python 3.12 warns of threads, whose locks a child would find held: this child takes none.
        warnings.simplefilter("ignore", DeprecationWarning)
        return os.fork()


def _be_child(job: Callable[[], Any], budget: Budget, writing: int) -> NoReturn:
    """Do `job` within `budget`, write its outcome, and end without any of the parent's exit handlers."""
    try:
        _bound(budget)
        with os.fdopen(writing, "wb") as pipe:
            pipe.write(_attempt(job, budget))
    finally:
        os._exit(0)


def _bound(budget: Budget) -> None:
    """Take on the limits, the system's default handling of signals, and silence: C++ reports its end on stderr."""
    import resource  # here, since Windows has none

    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGALRM):
        signal.signal(number, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_SETMASK, ())
    signal.setitimer(signal.ITIMER_REAL, budget.seconds)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if Path("/proc/self/statm").exists():
        present = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0]) * resource.getpagesize()
        _, hard = resource.getrlimit(resource.RLIMIT_AS)
        wanted = present + budget.megabytes * 2**20
        resource.setrlimit(resource.RLIMIT_AS, (wanted if hard == resource.RLIM_INFINITY else min(wanted, hard), hard))
    sys.setrecursionlimit(NESTING)
    faulthandler.disable()
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)
    os.dup2(null, 2)


@dataclass(frozen=True, slots=True)
class _Raised:
    """An exception of a job, to be raised again in the parent."""

    exception: Exception


def _attempt(job: Callable[[], Any], budget: Budget) -> bytes:
    """The outcome of `job`, pickled."""
    try:
        return pickle.dumps(job())
    except MemoryError:
        return pickle.dumps(Exceeded(Limit.MEMORY, budget))
    except RecursionError:
        return pickle.dumps(Exceeded(Limit.NESTING, budget))
    except RuntimeError as error:  # what Spot's exceptions become
        return pickle.dumps(Exceeded(Limit.ENGINE, budget, str(error)))
    except Exception as error:
        return pickle.dumps(_Raised(error))


def _outcome(child: _Child, budget: Budget) -> Any:
    """What `child`, which has closed its pipe, has to say or has died of."""
    _, status, usage = os.wait4(child.pid, 0)
    if not os.WIFSIGNALED(status) and child.received:
        return pickle.loads(b"".join(child.received))
    cause = os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0
    if cause == signal.SIGALRM:
        return Exceeded(Limit.TIME, budget)
    # A stack overflow comes with little memory in use; a failed allocation ends in an abort or in a null pointer.
    if cause == signal.SIGSEGV and usage.ru_maxrss < budget.megabytes * 2**10 // 2:
        return Exceeded(Limit.NESTING, budget)
    # A child that ends by itself without a word had no memory left to say so.
    if cause in (signal.SIGABRT, signal.SIGSEGV) or not cause:
        return Exceeded(Limit.MEMORY, budget)
    return Exceeded(Limit.ENGINE, budget, f"its process ended with signal {cause}")


def _value(outcome: Any) -> Any:
    if isinstance(outcome, _Raised):
        raise outcome.exception
    return outcome
