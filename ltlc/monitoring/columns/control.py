"""What a lowered machine does with the letters of its property, by letters as numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ltlc.monitoring.columns.bits import Mask
from ltlc.program.machine import Base, Outcome, State
from ltlc.program.properties import Question
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.monitor import Decision, Target

Letters = NDArray[np.int64]
"""A number for each letter, by the number of the letter: bit i is whether atom i holds."""


class Control(NamedTuple):
    """What a lowered machine does with the letters of its property, which its decisions ask by `questions`.

    Of each clock that is an age, `clocks` has the atom that says that a message has come, and the duration; of a count,
    the atom that it is not late. A slice of a run in one of the states `as_new` need not be kept.
    """

    questions: tuple[Question, ...]
    clocks: tuple[tuple[str, Nanoseconds] | str | None, ...]
    states: tuple[State, ...]
    decisions: tuple[Decision, ...]
    outcomes: tuple[Outcome, ...]
    as_new: frozenset[int]

    def asked(self, number: int, late: int | None) -> Question | bool:
        """What a decision asks of a letter; whether that is so if it asks about a clock that letters do not tell of."""
        if number < len(self.questions):
            return self.questions[number]
        clock = number - len(self.questions)
        told = self.clocks[clock]
        return Question(told, False) if isinstance(told, str) else clock == late

    def outcomes_of(
        self, targets: Sequence[Target], holds: Mapping[str, Mask], late: int | None = None
    ) -> NDArray[np.int64]:
        """For each of the `targets`, the number of the outcome of each letter, if no clock is late but that one."""
        known: dict[Target, Letters] = {}
        count = len(next(iter(holds.values()), np.zeros(1)))

        def outcomes(target: Target) -> Letters:
            if target >= 0:
                return np.full(count, target)
            if target not in known:
                number, low, high = self.decisions[~target]
                asked = self.asked(number, late)
                is_high = holds[asked.name] == asked.holds if isinstance(asked, Question) else np.bool_(asked)
                known[target] = np.where(is_high, outcomes(high), outcomes(low))
            return known[target]

        return np.array([outcomes(target) for target in targets])

    def sets(self, clock: int, base: Base) -> Mask:
        """By outcome, whether it sets a clock to count from this."""
        return np.array([any(s.clock == clock and s.base is base for s in each.sets) for each in self.outcomes])
