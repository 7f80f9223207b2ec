"""The letters that lead from one state to another, as a list of cubes: for the formats that label edges."""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.semantics.monitor import Monitor, Target

Cube = tuple[tuple[int, bool], ...]
"""Some atoms, by number, and whether each holds; the others do not matter."""

MOST_CUBES = 10_000
"""A monitor with more ways through its decisions than this is not written out edge by edge."""


class TooManyCubesError(Exception):
    """The edges of a monitor cannot be listed: their number grows exponentially with that of the decisions."""


def cubes(monitor: Monitor, state: int) -> dict[int, list[Cube]]:
    """For each state that a step from `state` can lead to, the disjoint cubes of letters that do.

    Raises TooManyCubesError.
    """
    found: dict[int, list[Cube]] = {}
    for count, (cube, target) in enumerate(_paths(monitor, monitor.edges[state], ())):
        if count >= MOST_CUBES:
            raise TooManyCubesError
        found.setdefault(target, []).append(cube)
    return found


def _paths(monitor: Monitor, target: Target, cube: Cube) -> Iterator[tuple[Cube, int]]:
    if target >= 0:
        yield cube, target
        return
    atom, low, high = monitor.decisions[~target]
    yield from _paths(monitor, low, (*cube, (atom, False)))
    yield from _paths(monitor, high, (*cube, (atom, True)))
