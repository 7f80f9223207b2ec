"""Does many small jobs in few child processes: a job that goes beyond its budget is given up, the next goes on.

A child for each job costs milliseconds, and what one job has found out is lost for the next. Here a child does one job
after the other, and is replaced only when a limit has ended it.
"""

from __future__ import annotations

import os
import pickle
import selectors
import signal
import struct
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NoReturn, TypeVar

from ltlc.limits import processes as limits
from ltlc.limits.processes import Budget, Exceeded, Limit

Result = TypeVar("Result")

LEAST_SECONDS = 0.01
"""A job that has less time than this is not begun."""

JOBS_OF_A_CHILD = 6
"""For fewer jobs than this, another child is not worth its start."""

_LENGTH = struct.Struct(">I")


def run_in_turn(
    jobs: Sequence[Callable[[], Result]], budget: Budget, seconds: float, most_children: int | None = None
) -> list[Result | Exceeded]:
    """The result of each job, in order; each may use `budget`, and all together `seconds` of time on the clock.

    Jobs with even and with odd numbers run side by side on two CPUs, and so on; those in one child share what they keep
    in memory. Exceptions, other than those that mean a limit, are raised here. No child is left behind.
    """
    deadline = time.monotonic() + seconds
    count = max(1, min(most_children or limits._cpus(), len(jobs) // JOBS_OF_A_CHILD))
    with _Turns(jobs, budget, deadline) as turns:
        for first in range(min(count, len(jobs))):
            turns.start(list(range(first, len(jobs), count)))
        outcomes = dict(turns.outcomes())
    return [limits._value(outcomes[number]) for number in range(len(jobs))]


@dataclass(slots=True)
class _Worker:
    """A child, the jobs that it has not yet reported on, and what has come from it so far."""

    pid: int
    waiting: list[int]
    received: bytearray = field(default_factory=bytearray)

    def reports(self) -> Iterator[tuple[int, Any]]:
        """The complete outcomes in what was received."""
        while len(self.received) >= _LENGTH.size:
            (length,) = _LENGTH.unpack_from(self.received)
            end = _LENGTH.size + length
            if len(self.received) < end:
                return
            yield self.waiting.pop(0), pickle.loads(bytes(self.received[_LENGTH.size : end]))
            del self.received[:end]


class _Turns:
    """The children that are running, by the pipe on which their outcomes come; on leaving, they are ended."""

    def __init__(self, jobs: Sequence[Callable[[], Any]], budget: Budget, deadline: float) -> None:
        self._jobs = jobs
        self._budget = budget
        self._deadline = deadline
        self._workers: dict[int, _Worker] = {}
        self._selector = selectors.DefaultSelector()

    def __enter__(self) -> _Turns:
        return self

    def __exit__(self, *exception: object) -> None:
        for pipe, worker in self._workers.items():
            os.close(pipe)
            os.kill(worker.pid, signal.SIGKILL)
            os.waitpid(worker.pid, 0)
        self._selector.close()

    def start(self, numbers: list[int]) -> None:
        """Begin a child that does the jobs with these numbers."""
        with limits._no_interrupt():
            reading, writing = os.pipe()
            pid = limits.fork()
            if pid == 0:
                self._be_child(numbers, writing)
            os.close(writing)
            self._workers[reading] = _Worker(pid, numbers)
        self._selector.register(reading, selectors.EVENT_READ)

    def outcomes(self) -> Iterator[tuple[int, Any]]:
        """The outcome of each job, as they come."""
        while self._workers:
            for key, _ in self._selector.select():
                worker = self._workers[key.fd]
                received = os.read(key.fd, 1 << 16)
                worker.received += received
                yield from worker.reports()
                if not received:
                    yield from self._ended(key.fd)

    def _ended(self, pipe: int) -> Iterator[tuple[int, Any]]:
        """A child has ended; if a limit did that, its job is given up and another child does the rest."""
        worker = self._workers.pop(pipe)
        self._selector.unregister(pipe)
        os.close(pipe)
        outcome = limits._outcome(limits._Child(0, worker.pid, []), self._budget)
        if worker.waiting:
            yield worker.waiting[0], outcome
        if worker.waiting[1:]:
            self.start(worker.waiting[1:])

    def _be_child(self, numbers: list[int], writing: int) -> NoReturn:
        """Do jobs, each within the budget and what is left of the time, and report on each."""
        try:
            limits._bound(self._budget)
            for number in numbers:
                left = min(self._budget.seconds, self._deadline - time.monotonic())
                budget = replace(self._budget, seconds=max(left, LEAST_SECONDS))
                signal.setitimer(signal.ITIMER_REAL, budget.seconds)
                outcome = limits._attempt(self._jobs[number] if left >= LEAST_SECONDS else _late(budget), budget)
                signal.setitimer(signal.ITIMER_REAL, 0)
                _write(writing, _LENGTH.pack(len(outcome)) + outcome)
        finally:
            os._exit(0)


def _late(budget: Budget) -> Callable[[], Exceeded]:
    return lambda: Exceeded(Limit.TIME, budget)


def _write(pipe: int, data: bytes) -> None:
    view = memoryview(data)
    while view:
        view = view[os.write(pipe, view) :]
