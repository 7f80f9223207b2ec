"""The gate: what `build` requires of every property before anything is written."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from ltlc.assurance.cross_check import Agreement, Mismatch, cross_check
from ltlc.assurance.replay import Deviation, Replayed, Stepper, replay
from ltlc.automata import Budget, Exceeded
from ltlc.automata.limits import run_all
from ltlc.compiler import Compiled

Starter = Callable[[], Stepper]
"""Makes the emitted code of a property ready for its first step."""


@dataclass(frozen=True, slots=True)
class Judgement:
    """What the gate found of one property; `replay` is None where the target is not code that can be stepped."""

    cross_check: Agreement | Mismatch
    replay: Replayed | Deviation | None

    @property
    def passed(self) -> bool:
        """Whether the property may be emitted."""
        return isinstance(self.cross_check, Agreement) and not isinstance(self.replay, Deviation)


def judge_all(
    compiled: Sequence[Compiled], starters: Sequence[Starter] | None, budget: Budget
) -> list[Judgement | Exceeded]:
    """The judgement of each property, in order, or the limit of `budget` that judging it ran into.

    `starters` are for the emitted code of each property, None where there is none. Properties are judged in child
    processes, as many at a time as there are CPUs.
    """
    starts = [None] * len(compiled) if starters is None else starters
    return run_all([partial(judge, *each) for each in zip(compiled, starts, strict=True)], budget)


def judge(compiled: Compiled, starter: Starter | None) -> Judgement:
    """The judgement of one property, in this process."""
    return Judgement(cross_check(compiled), None if starter is None else replay(compiled, starter))
