"""Zones as z3 understands them, for points that show something."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import reduce
from itertools import starmap
from typing import Any

import z3  # noqa: TID251

from ltlc.specification.evaluation import corners_of, edges_of
from ltlc.specification.functions import Function

Term = Any
"""A term of z3's."""

OF_ZONES = (Function.INSIDE, Function.DISTANCE)


def zone_facts(function: Function, result: Term, arguments: Sequence[Term], exact: bool) -> Iterator[Term]:
    """What is known of the `result` of a function of a point and a zone; of a distance, its square only if `exact`."""
    x, y = arguments[:2]
    edges = [(*one, *other) for one, other in edges_of(corners_of(arguments))]
    inside = _inside(x, y, edges)
    if function is Function.INSIDE:
        yield result == z3.If(inside, z3.RealVal(1), z3.RealVal(0))
        return
    yield result >= 0
    yield (result == 0) == inside
    if exact:
        squares = [_square_from(x, y, *edge) for edge in edges]
        least = reduce(lambda found, other: z3.If(other < found, other, found), squares)
        yield z3.Or(inside, result * result == least)


def _inside(x: Term, y: Term, edges: Sequence[tuple[Term, ...]]) -> Term:
    """The point lies on an edge, or an odd number of edges is to the right of it."""

    def is_on(x1: Term, y1: Term, x2: Term, y2: Term) -> Term:
        between = ((x1 - x) * (x2 - x) <= 0, (y1 - y) * (y2 - y) <= 0)
        return z3.And((x2 - x1) * (y - y1) == (x - x1) * (y2 - y1), *between)

    def is_right(x1: Term, y1: Term, x2: Term, y2: Term) -> Term:
        turn = (x2 - x1) * (y - y1) - (x - x1) * (y2 - y1)
        return z3.And((y1 <= y) != (y2 <= y), z3.If(y2 > y1, turn > 0, turn < 0))

    return z3.Or(*starmap(is_on, edges), reduce(z3.Xor, starmap(is_right, edges)))


def _square_from(x: Term, y: Term, x1: Term, y1: Term, x2: Term, y2: Term) -> Term:
    """The square of the distance from an edge."""
    along, across = x2 - x1, y2 - y1
    length = along * along + across * across
    reached = (x - x1) * along + (y - y1) * across
    turn = along * (y - y1) - (x - x1) * across
    ends = [(x - a) * (x - a) + (y - b) * (y - b) for a, b in ((x1, y1), (x2, y2))]
    return z3.If(reached <= 0, ends[0], z3.If(reached >= length, ends[1], turn * turn / length))
