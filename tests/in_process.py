"""Jobs of the gate in the process that runs the tests, rather than in children.

To fork a process that has collected all tests takes some 35 ms of a CPU, more than most of these jobs do.
"""

from __future__ import annotations

import math
import pickle
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import NoReturn, TypeVar
from unittest.mock import patch

from ltlc.base.limits import Budget, Exceeded, Limit, Watch, children, run_all

Result = TypeVar("Result")

CALLERS = ("ltlc.assurance.evidence.certified", "ltlc.assurance.gate")
"""Who has jobs in Python only: those of Spot and of compiled code stay in children, which can be stopped."""


class _LateError(BaseException):
    """The time of a job is over; no job catches this."""


def _stop(*_: object) -> NoReturn:
    raise _LateError


def run_here(
    jobs: Sequence[Callable[[], Result]],
    budget: Budget,
    seconds: float = math.inf,
    watch: Watch | None = None,
    patience: float = children.PATIENCE,
) -> list[Result | Exceeded]:
    """As `run_all`, but memory has no bound."""
    if threading.current_thread() is not threading.main_thread():
        return run_all(jobs, budget, seconds, watch, patience)
    deadline = time.monotonic() + seconds
    outcomes: list[Result | Exceeded] = []
    for job in jobs:
        outcomes.append(_outcome(job, budget, min(budget.seconds, deadline - time.monotonic())))
        if watch:
            watch(len(outcomes), len(jobs))
    return [children._value(outcome) for outcome in outcomes]


def _outcome(job: Callable[[], Result], budget: Budget, seconds: float) -> Result | Exceeded:
    """What comes of `job` in so many `seconds`, copied as from a child; a job may have jobs of its own."""
    late = Exceeded(Limit.TIME, budget)
    if seconds < children.LEAST_SECONDS:
        return late
    nesting, handler = sys.getrecursionlimit(), signal.signal(signal.SIGALRM, _stop)
    left, _ = signal.setitimer(signal.ITIMER_REAL, seconds)
    began = time.monotonic()
    try:
        sys.setrecursionlimit(children.NESTING)
        try:
            outcome = children._attempt(job, budget)
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
    except _LateError:
        return late
    finally:
        sys.setrecursionlimit(nesting)
        signal.signal(signal.SIGALRM, handler)
        if left:
            signal.setitimer(signal.ITIMER_REAL, max(0.001, left - (time.monotonic() - began)))
    return pickle.loads(outcome)  # type: ignore[no-any-return]


@contextmanager
def in_process() -> Iterator[None]:
    """What `CALLERS` have done in children, is done here."""
    with ExitStack() as stack:
        for module in CALLERS:
            stack.enter_context(patch(f"{module}.run_all", run_here))
        yield
