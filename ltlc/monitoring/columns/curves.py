"""By how much a property holds: along a recorded run, and in one that goes on."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import field

import numpy as np
from numpy.typing import NDArray

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Array, Places
from ltlc.monitoring.columns.timeline import Timeline
from ltlc.runtime.slice_keys import Id
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.robustness import FALSE, TRUE

Run = tuple[Timeline, Mapping[str, Array], Mapping[str, Nanoseconds]]
"""When steps come, the margins of atoms there, and since when ages count, by the names of their news."""

PIECE = 1 << 14
"""So many margins are looked through at a time."""


@dataclass(frozen=True, slots=True)
class Curve:
    """By how much a property holds on the rest of the run from each of its steps on.

    `times`, in ns, and `margins` have one number for each step, in the order of the run; `margins[0]` is that of the
    whole run. A margin is in the unit of the values that decide it: positive where the property holds, negative where
    it is violated, infinite where no comparison of numbers decides it. `decided` has the time and the name of the first
    comparison with the margin of the whole run; of what is judged from each message on, it is that from the message at
    `opened_at`, and of what is judged for each id, that of `id`. Of a property that cannot be measured there are none,
    and `reason` says why.
    """

    times: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))
    margins: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))
    reason: str = ""
    decided: tuple[Nanoseconds, str] | None = None
    opened_at: Nanoseconds | None = None
    id: Id | None = None

    @property
    def whole(self) -> float | None:
        """That of the whole run; None if it did not begin, or cannot be measured."""
        return float(self.margins[0]) + 0.0 if len(self.margins) else None  # 0, not -0, however it came about


@dataclass(frozen=True, slots=True)
class Band:
    """Between which numbers the robustness of a property will be, however the run continues.

    Of a property that cannot be measured nothing is known, and `reason` says why.
    """

    low: float = FALSE
    high: float = TRUE
    reason: str = ""


def first_with(size: float, margins: Mapping[str, Array], times: Places) -> tuple[Nanoseconds, str] | None:
    """The first of the finite `margins` of this size, on either side of 0."""
    for start in range(0, len(times) if math.isfinite(size) else 0, PIECE):
        at = {name: np.flatnonzero(np.abs(each[start : start + PIECE]) == size) for name, each in margins.items()}
        found = [(int(steps[0]), name) for name, steps in at.items() if len(steps)]
        if found:
            step, name = min(found, key=lambda each: each[0])
            return int(times[start + step]), name
    return None
