"""Where to look next: points of a unit cube, guided by how close properties came to failing at those before.

First everything is as it is by default, then come examples and points that are spread evenly; from the point with the
least loss of a property, CMA-ES then goes on (Hansen and Ostermeier, *Completely derandomized self-adaptation in
evolution strategies*, 2001). The property that is closest to failing is pursued first; each has an equal share of what
is left of the budget.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Generator, Mapping, Sequence
from statistics import median
from typing import NamedTuple

import numpy as np

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # that nothing is there to draw with
    import cma  # noqa: TID251

Point = tuple[float, ...]
Losses = Mapping[str, float]
"""How close each property came to failing, by its label: the less, the closer; infinite where that is not known."""

SPREAD = 0.2
"""The share of the budget that is spread evenly."""

LEAST_SPREAD = 8
"""So many points are spread at least."""

STEP = 0.25
"""The standard deviation with which a descent begins: a quarter of each range."""


class Proposal(NamedTuple):
    """A point to be simulated, and the property that is pursued with it, if one is."""

    point: Point
    pursued: str | None = None


class Tried(NamedTuple):
    """A point that was simulated."""

    point: Point
    losses: Losses


Proposals = Generator[Proposal, Losses, None]
"""Takes what was found at each point before it gives the next one; without end."""


def proposals(begin: Sequence[Point], budget: int, seed: int) -> Proposals:
    """Points to be simulated, those of `begin` first; all follow from `seed` and from what was found."""
    rng = np.random.default_rng(seed)
    tried: list[Tried] = []
    dimension = len(begin[0])
    spread = _spread(dimension, max(round(budget * SPREAD), LEAST_SPREAD), rng)
    for point in [*begin, *spread]:
        losses = yield Proposal(point)
        tried.append(Tried(point, losses))
    done: list[str] = []
    while True:
        ranking = ranked(tried)
        left = [label for label in ranking if label not in done]
        if not ranking:
            point = _anywhere(dimension, rng)
            tried.append(Tried(point, (yield Proposal(point))))
        elif not left:
            done.clear()
        else:
            share = max((budget - len(tried)) // len(left), 1)
            yield from _pursue(left[0], share, tried, rng)
            done.append(left[0])


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


def _pursue(label: str, most: int, tried: list[Tried], rng: np.random.Generator) -> Proposals:
    """Descend for one property `most` times, from the best point, and then from others; `tried` gets what is found."""
    end = len(tried) + most
    start = min(tried, key=lambda each: each.losses[label]).point
    while len(tried) < end:
        yield from _descend(start, label, end, tried, rng)
        start = _anywhere(len(start), rng)


def _descend(start: Point, label: str, end: int, tried: list[Tried], rng: np.random.Generator) -> Proposals:
    """Descend from `start` until nothing gets better, or `end` points were tried."""
    dimension = len(start)
    options = {
        "bounds": [0, 1],
        "randn": lambda *shape: rng.standard_normal(shape),
        "seed": math.nan,  # of another generator
        "verbose": -9,
    }
    # CMA-ES takes no single coordinate: a second one, which nothing reads, is beside it.
    strategy = cma.CMAEvolutionStrategy([*start, 0.5][: max(dimension, 2)], STEP, options)
    while not strategy.stop():
        points = strategy.ask()
        losses: list[float] = []
        for coordinates in points:
            if len(tried) == end:
                return
            point = tuple(float(number) for number in coordinates[:dimension])
            found = yield Proposal(point, label)
            tried.append(Tried(point, found))
            losses.append(found[label])
        strategy.tell(points, _finite(losses))


def _finite(losses: Sequence[float]) -> list[float]:
    """The same, what is not known being greater than all that is."""
    known = [loss for loss in losses if math.isfinite(loss)]
    return [loss if math.isfinite(loss) else max(known, default=0.0) + 1.0 for loss in losses]
