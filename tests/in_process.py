"""Jobs in the process that runs the tests, rather than in children.

To fork a process that has collected all tests takes some 35 ms of a CPU, more than most jobs do.
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

CALLERS = (
    "ltlc.analysis.analyse",
    "ltlc.analysis.comparison.answer",
    "ltlc.analysis.comparison.bounded",
    "ltlc.analysis.comparison.constructors",
    "ltlc.analysis.explanation",
    "ltlc.assurance.evidence.certified",
    "ltlc.assurance.exactness",
    "ltlc.assurance.gate",
    "ltlc.assurance.library",
    "ltlc.automata.batch",
    "ltlc.importing.conversion",
    "ltlc.interfaces.commands.emitted_code",
)
"""Whose jobs these are; those of servers can be given up at any time, and stay in children."""

AMPLE_SECONDS = 4.0
"""A job that has less time is meant to be stopped, which an engine can be in a child only."""


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
    if budget.seconds < AMPLE_SECONDS or threading.current_thread() is not threading.main_thread():
        return run_all(jobs, budget, seconds, watch, patience)
    _forget_numbers()
    deadline = time.monotonic() + seconds
    outcomes: list[Result | Exceeded] = []
    for job in jobs:
        outcomes.append(_outcome(job, budget, min(budget.seconds, deadline - time.monotonic())))
        if watch:
            watch(len(outcomes), len(jobs))
    return [children._value(outcome) for outcome in outcomes]


def _forget_numbers() -> None:
    """Let z3 begin anew, as in a child: which numbers it finds depends on what it was asked before."""
    if z3 := sys.modules.get("z3.z3"):
        vars(z3)["_main_ctx"] = None


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
