"""Runs jobs in child processes that can be stopped: each with a deadline and a limit on memory.

Spot holds the interpreter while it works, ignores signals of Python's, and ends the process when memory runs out; only
another process can bound it. A child bounds itself, by a timer and a resource limit of the system's, so it ends even if
its parent is gone; on Linux, at once. It does one job after the other, since another process for each costs
milliseconds and what one job has found out would be lost for the next; only where a limit has ended it, another takes
its place.
"""

from __future__ import annotations

import faulthandler
import gc
import math
import os
import pickle
import selectors
import signal
import struct
import sys
import threading
import time
import warnings
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import field, replace
from pathlib import Path
from typing import Any, NoReturn, Self, TypeVar

from ltlc.base.limits.budget import Budget, Exceeded, Limit
from ltlc.dataclass import dataclass

if sys.platform != "win32":
    import resource

Result = TypeVar("Result")

Watch = Callable[[int, int], None]
"""Called now and then with how many jobs are done, and how many there are."""

NESTING = 10_000
"""Python's recursion limit in a child: formulas may be nested a few thousand deep there."""

PATIENCE = 0.05
"""Seconds that jobs wait for a child to be free before another one is started, as long as there are CPUs: most jobs
take less time than starting one."""

LEAST_SECONDS = 0.01
"""A job that has less time than this is not begun."""

_STARTING = threading.RLock()
"""One thread starts a child at a time: another child would hold the ends of its pipes open, and hide its death."""

_DIE_WITH_PARENT = 1
"""`PR_SET_PDEATHSIG` of Linux."""

_CHUNK = 1 << 16
_NUMBER = struct.Struct(">Q")


def run_all(
    jobs: Sequence[Callable[[], Result]],
    budget: Budget,
    seconds: float = math.inf,
    watch: Watch | None = None,
    patience: float = PATIENCE,
) -> list[Result | Exceeded]:
    """The result of each job, in order; each may use `budget`, and all together `seconds` of time on the clock.

    Jobs wait `patience` seconds for a child to be free; none, where each of them takes long.
    An exception of a job is raised here, except for those that mean a limit; results and exceptions must be picklable.
    Whatever happens here, an interrupt included, no child is left behind. Raises OSError where there is no `os.fork`
    (Windows); where there is no `/proc` (macOS), memory is not bounded.
    """
    _refuse_without_fork()
    outcomes: dict[int, Any] = {}
    with _Children(jobs, budget, time.monotonic() + seconds, patience=patience) as children:
        while len(outcomes) < len(jobs):
            outcomes.update(children.reports())
            if watch:
                watch(len(outcomes), len(jobs))
    return [_value(outcomes[number]) for number in range(len(jobs))]


def run_each(
    jobs: Sequence[Callable[[], Result]], budget: Budget, workers: int | None = None, patience: float = PATIENCE
) -> Generator[tuple[int, Result | Exceeded], None, None]:
    """The number of each job and its result, as they come, from as many `workers` (default: one for each CPU).

    Otherwise as `run_all`. The caller may stop at any time: closing the iterator ends the children.
    """
    _refuse_without_fork()
    left = len(jobs)
    with _Children(jobs, budget, math.inf, workers, patience) as children:
        while left:
            for number, outcome in children.reports():
                left -= 1
                yield number, _value(outcome)


def in_order(numbered: Iterable[tuple[int, Result]]) -> Iterator[Result]:
    """What has the numbers 0, 1, and so on, in the order of these, each as soon as it is its turn."""
    early: dict[int, Result] = {}
    turn = 0
    for number, result in numbered:
        early[number] = result
        while turn in early:
            yield early.pop(turn)
            turn += 1


def _refuse_without_fork() -> None:
    if not hasattr(os, "fork"):
        raise OSError("a budget needs processes that can fork, which this system does not have")


@dataclass(slots=True)
class _Child:
    """A child, the pipes to and from it, the number of its job, and what has come of the outcome so far."""

    pid: int
    orders: int
    answers: int
    job: int = -1
    received: bytearray = field(default_factory=bytearray)

    def answer(self) -> Any | None:
        """The outcome of its job, pickled, if that is complete."""
        if len(self.received) < _NUMBER.size:
            return None
        end = _NUMBER.size + _NUMBER.unpack_from(self.received)[0]
        return bytes(self.received[_NUMBER.size : end]) if len(self.received) == end else None


class _Children:
    """The children that have a job, by the pipe on which they answer; on leaving, they are ended."""

    def __init__(
        self,
        jobs: Sequence[Callable[[], Any]],
        budget: Budget,
        deadline: float,
        workers: int | None = None,
        patience: float = PATIENCE,
    ) -> None:
        self._jobs = jobs
        self._budget = budget
        self._deadline = deadline
        self._workers = workers or _cpus()
        self._patience = patience
        self._waiting = list(range(len(jobs)))[::-1]
        self._running: dict[int, _Child] = {}
        self._last_start = -math.inf
        self._selector = selectors.DefaultSelector()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        for child in list(self._running.values()):
            self._end(child)
        self._selector.close()

    def reports(self) -> Iterator[tuple[int, Any]]:
        """The numbers and outcomes of the jobs that were done since the last time, after a short wait for one."""
        while self._waiting and self._is_another_wanted():
            self._start()
        for key, _ in self._selector.select(PATIENCE):
            child = self._running[key.fd]
            received = os.read(child.answers, _CHUNK)
            child.received += received
            if not received:
                yield child.job, self._death(child)
            elif (answer := child.answer()) is not None:
                number = child.job
                self._employ(child)
                yield number, pickle.loads(answer)

    def _is_another_wanted(self) -> bool:
        late = time.monotonic() - self._last_start >= self._patience
        return not self._running or (late and len(self._running) < self._workers)

    def _start(self) -> None:
        """Fork a child and give it the next job."""
        with _STARTING, _no_interrupt():
            (ordered, orders), (answers, answering) = os.pipe(), os.pipe()
            pid = _fork()
            if pid == 0:
                os.close(orders)
                os.close(answers)
                self._serve(ordered, answering)
            os.close(ordered)
            os.close(answering)
            child = self._running[answers] = _Child(pid, orders, answers)
        self._last_start = time.monotonic()
        self._selector.register(answers, selectors.EVENT_READ)
        self._employ(child)

    def _employ(self, child: _Child) -> None:
        """Give `child` the next job; without one, it is ended."""
        if not self._waiting:
            self._end(child)
            return
        child.job = self._waiting.pop()
        child.received.clear()
        with suppress(BrokenPipeError):  # it was killed, as the end of its answers is about to tell
            os.write(child.orders, _NUMBER.pack(child.job))

    def _forget(self, child: _Child) -> None:
        del self._running[child.answers]
        with suppress(KeyError):  # not yet registered, when an interrupt comes in between
            self._selector.unregister(child.answers)
        os.close(child.answers)
        os.close(child.orders)

    def _end(self, child: _Child) -> None:
        self._forget(child)
        os.kill(child.pid, signal.SIGKILL)
        os.waitpid(child.pid, 0)

    def _death(self, child: _Child) -> Exceeded:
        """The limit that `child`, which has closed its pipe, died of."""
        self._forget(child)
        _, status, usage = os.wait4(child.pid, 0)
        cause = os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0
        if cause == signal.SIGALRM:
            return Exceeded(Limit.TIME, self._budget)
        # A stack overflow comes with little memory in use; a failed allocation ends in an abort or in a null pointer.
        if cause == signal.SIGSEGV and usage.ru_maxrss < self._budget.megabytes * 2**10 // 2:
            return Exceeded(Limit.NESTING, self._budget)
        # A child that ends without an answer had no memory left to send one.
        if cause in (signal.SIGABRT, signal.SIGSEGV) or not cause:
            return Exceeded(Limit.MEMORY, self._budget)
        return Exceeded(Limit.ENGINE, self._budget, f"its process ended with signal {cause}")

    def _serve(self, ordered: int, answering: int) -> NoReturn:
        """In a child: do jobs as they are ordered, and end without any of the parent's exit handlers."""
        try:
            _settle()
            with os.fdopen(answering, "wb") as pipe:
                while order := os.read(ordered, _NUMBER.size):
                    outcome = self._bounded(*_NUMBER.unpack(order))
                    pipe.write(_NUMBER.pack(len(outcome)) + outcome)
                    pipe.flush()
        finally:
            os._exit(0)

    def _bounded(self, number: int) -> bytes:
        """The outcome, pickled, of the job with this number, done within the budget and what is left of the time."""
        left = self._deadline - time.monotonic()
        budget = replace(self._budget, seconds=max(LEAST_SECONDS, min(self._budget.seconds, left)))
        if left < LEAST_SECONDS:
            return pickle.dumps(Exceeded(Limit.TIME, budget))
        _bound_memory(budget.megabytes)
        signal.setitimer(signal.ITIMER_REAL, budget.seconds)
        outcome = _attempt(self._jobs[number], budget)
        signal.setitimer(signal.ITIMER_REAL, 0)
        return outcome


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


def _fork() -> int:
    """Fork this process: 0 in the child, and in the parent the child's process id."""
    with warnings.catch_warnings():
        # Python 3.12 warns of threads, whose locks a child would find held: this child takes none.
        warnings.simplefilter("ignore", DeprecationWarning)
        return os.fork()


def _settle() -> None:
    """Take on the system's default handling of signals, and silence: C++ reports its end on stderr."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGALRM):
        signal.signal(number, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_SETMASK, ())
    _die_with_parent()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    gc.freeze()  # to collect what the parent made would write to it, so that it is shared no longer
    sys.setrecursionlimit(NESTING)
    faulthandler.disable()
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)
    os.dup2(null, 2)


def _die_with_parent() -> None:
    """Let this process be killed when its parent ends: a child that is killed leaves none of its own behind."""
    if sys.platform == "linux":
        import ctypes

        ctypes.CDLL(None).prctl(_DIE_WITH_PARENT, signal.SIGKILL)


def _bound_memory(megabytes: int) -> None:
    """Let this process take so much memory beside what it has."""
    statistics = Path("/proc/self/statm")
    if statistics.exists():
        present = int(statistics.read_text(encoding="ascii").split()[0]) * resource.getpagesize()
        _, hard = resource.getrlimit(resource.RLIMIT_AS)
        wanted = present + megabytes * 2**20
        resource.setrlimit(resource.RLIMIT_AS, (wanted if hard == resource.RLIM_INFINITY else min(wanted, hard), hard))


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


def _value(outcome: Any) -> Any:
    if isinstance(outcome, _Raised):
        raise outcome.exception
    return outcome
