"""How much of what tests could try they try: a share; all of it, or more, in a campaign (`scripts/test --share 5`)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import Any, TypeVar
from unittest.mock import patch

from hypothesis import settings

from ltlc.assurance import courses, many_traffic, timed_program, traffic, walks

T = TypeVar("T")

SHARE = 0.2
"""By default; what tests say that they draw is a share of 1."""


@dataclass
class Effort:
    """What is asked of a run of pytest."""

    share: float = SHARE


ASKED = Effort()


def share_of(number: int) -> int:
    """The share of a `number` of cases."""
    return max(1, math.ceil(number * ASKED.share))


def some_of(items: Iterable[T], number: int) -> list[T]:
    """The share of `items`: every so many, from another one on for each `number` of a case."""
    step = max(1, round(1 / ASKED.share))
    return list(items)[number % step :: step]


LEAST_EXAMPLES = 10
"""Of fewer, hypothesis makes hardly more than the simplest."""


def limit_examples(function: Any) -> None:
    """Let hypothesis draw the share of its examples for a function that is a test."""
    if (said := getattr(function, _SETTINGS, None)) is not None:
        number = max(share_of(said.max_examples), min(said.max_examples, LEAST_EXAMPLES))
        setattr(function, _SETTINGS, settings(said, max_examples=number))


_SETTINGS = "_hypothesis_internal_use_settings"  # which hypothesis's own plugin for pytest reads, too


RUNS = {
    courses: ("RANDOM_COURSES", "MOST_GUIDED"),
    many_traffic: ("RUNS",),
    timed_program: ("RANDOM_RUNS", "RUNS_WITH_OPENINGS"),
    traffic: ("RANDOM_RUNS", "TIMED_RUNS", "RUNS_WITH_OPENINGS"),
    walks: ("MOST_WALKS",),
}
"""How many runs the gate takes of each kind."""


@contextmanager
def fewer_runs() -> Iterator[None]:
    """Code is replayed on a share of the runs, for tests of code in which there is no fault to be found."""
    with ExitStack() as stack:
        for module, names in RUNS.items():
            for name in names:
                stack.enter_context(patch.object(module, name, share_of(getattr(module, name))))
        yield
