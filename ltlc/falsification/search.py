"""Where to look next: points of a unit cube, guided by how close properties came to failing at those before.

First everything is as it is by default, then come examples and points that are spread evenly; from the point with the
least loss of a property, CMA-ES then goes on (Hansen and Ostermeier, *Completely derandomized self-adaptation in
evolution strategies*, 2001). Properties take turns, a generation each, that which is closest to failing first: which of
them can fail is not known, and those that cannot may come closest.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Generator, Mapping, Sequence
from statistics import median
from typing import Any, NamedTuple

import numpy as np

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # that nothing is there to draw with
    import cma  # noqa: TID251

Point = tuple[float, ...]
Losses = Mapping[str, float]
"""How close each property came to failing, by its label: the less, the closer; infinite where that is not known."""

SPREAD = 0.2
"""The share of the budget that is spread evenly at most."""

LEAST_SPREAD = 8
"""So many points are spread at least."""

AT_RANDOM = 8
"""So many points are drawn at a time where nothing guides."""

STEP = 0.25
"""The standard deviation with which a descent begins: a quarter of each range."""


class Batch(NamedTuple):
    """Points to be simulated, none of which depends on another, and the property that is pursued, if one is."""

    points: Sequence[Point]
    pursued: str | None = None


class Tried(NamedTuple):
    """A point that was simulated."""

    point: Point
    losses: Losses


Batches = Generator[Batch, Sequence[Losses], None]
"""Takes what was found at the points of a batch before it gives the next one."""


def batches(begin: Sequence[Point], budget: int, seed: int) -> Batches:
    """Points to be simulated, without end, those of `begin` first; all follow from `seed` and from what was found."""
    rng = np.random.default_rng(seed)
    tried: list[Tried] = []
    dimension = len(begin[0])
    # Two points for each coordinate tell where a descent may begin; what more would tell, the descent tells sooner.
    count = max(min(2 * dimension + 1, round(budget * SPREAD)), LEAST_SPREAD)
    yield from _tried([*begin, *_spread(dimension, count, rng)], None, tried)
    descents: dict[str, _Descent] = {}
    while True:
        ranking = ranked(tried)
        for label in ranking:
            if label not in descents:
                descents[label] = _Descent(label, tried, rng)
            yield from descents[label].generation(tried)
        if not ranking:
            yield from _tried([_anywhere(dimension, rng) for _ in range(AT_RANDOM)], None, tried)


def _tried(
    points: Sequence[Point], pursued: str | None, tried: list[Tried]
) -> Generator[Batch, Sequence[Losses], Sequence[Losses]]:
    """A batch; `tried` gets what is found."""
    losses = yield Batch(points, pursued)
    tried += map(Tried, points, losses)
    return losses


def ranked(tried: Sequence[Tried]) -> list[str]:
    """The properties of which something is known, that which is closest to failing first.

    They have units of their own: what counts is the least loss beside the usual one.
    """
    closeness = {}
    for label in dict.fromkeys(label for each in tried for label in each.losses):
        known = [each.losses[label] for each in tried if math.isfinite(each.losses[label])]
        if known:
            usual = median(known)
            closeness[label] = min(known) / usual if usual > 0 else 0.0
    return sorted(closeness, key=lambda label: closeness[label])


def _spread(dimension: int, count: int, rng: np.random.Generator) -> list[Point]:
    """Points of which each coordinate has one in each of `count` equal parts (McKay, Beckman and Conover 1979)."""
    columns = [(rng.permutation(count) + rng.random(count)) / count for _ in range(dimension)]
    return [tuple(map(float, row)) for row in zip(*columns, strict=True)]


def _anywhere(dimension: int, rng: np.random.Generator) -> Point:
    return tuple(map(float, rng.random(dimension)))


class _Descent:
    """Descends for one property from the best point, and, when nothing gets better, from others."""

    def __init__(self, label: str, tried: Sequence[Tried], rng: np.random.Generator) -> None:
        self._label = label
        self._rng = rng
        start = min(tried, key=lambda each: each.losses[label]).point
        self._dimension = len(start)
        self._strategy = self._from(start)

    def generation(self, tried: list[Tried]) -> Batches:
        """The points that come next; `tried` gets what is found."""
        if self._strategy.stop():
            self._strategy = self._from(_anywhere(self._dimension, self._rng))
        population = self._strategy.ask()
        points = [tuple(map(float, each[: self._dimension])) for each in population]
        found = yield from _tried(points, self._label, tried)
        self._strategy.tell(population, _finite([losses[self._label] for losses in found]))

    def _from(self, start: Point) -> Any:
        options = {
            "bounds": [0, 1],
            "randn": lambda *shape: self._rng.standard_normal(shape),
            "seed": math.nan,  # of another generator
            "verbose": -9,
        }
        # CMA-ES takes no single coordinate: a second one, which nothing reads, is beside it.
        return cma.CMAEvolutionStrategy([*start, 0.5][: max(self._dimension, 2)], STEP, options)


def _finite(losses: Sequence[float]) -> list[float]:
    """The same, what is not known being greater than all that is."""
    known = [loss for loss in losses if math.isfinite(loss)]
    return [loss if math.isfinite(loss) else max(known, default=0.0) + 1.0 for loss in losses]
