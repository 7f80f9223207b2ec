"""Zones as z3 understands them, against a polygon's winding and distance; runs that show a property of a zone."""

from __future__ import annotations

import math
import random
from fractions import Fraction
from pathlib import Path

import pytest
import z3  # noqa: TID251
from test_zones import NOTCHED, SQUARE, STAIRS, flat

from benchmarks.differential.polygons import Polygon, away, is_within
from ltlc.analysis.zones import zone_facts
from ltlc.cli import main
from ltlc.specification.functions import Function


def result_of(function: Function, polygon: Polygon, point: tuple[float, float]) -> float:
    """The one value that the facts leave."""
    solver, result = z3.Solver(), z3.Real("result")
    arguments = [z3.RealVal(str(Fraction(number))) for number in (*point, *flat(polygon))]
    solver.add(*zone_facts(function, result, arguments, exact=True))
    assert solver.check() == z3.sat
    found = solver.model().eval(result)
    solver.add(result != found)
    assert solver.check() == z3.unsat
    return float((found.approx(20) if z3.is_algebraic_value(found) else found).as_fraction())


def near(polygon: Polygon, chance: random.Random) -> tuple[float, float]:
    """A point in the middle of an edge, on a corner, or anywhere around, on a grid on which both are exact."""
    (a, b), (c, d) = chance.choice(list(zip(polygon, polygon[1:] + polygon[:1], strict=True)))
    anywhere = (chance.randint(-8, 40) / 8, chance.randint(-8, 40) / 8)
    return chance.choice([(float(a), float(b)), ((a + c) / 2, (b + d) / 2), anywhere, anywhere])


@pytest.mark.parametrize("polygon", [SQUARE, STAIRS, NOTCHED])
def test_a_point_is_inside_for_z3_if_it_is(polygon: Polygon) -> None:
    chance, found = random.Random(1), {True: 0, False: 0}
    for _ in range(60):
        point = near(polygon, chance)
        assert result_of(Function.INSIDE, polygon, point) == is_within(point, polygon), point
        found[is_within(point, polygon)] += 1
    assert min(found.values()) > 5


@pytest.mark.parametrize("polygon", [SQUARE, STAIRS, NOTCHED])
def test_a_distance_is_for_z3_what_it_is(polygon: Polygon) -> None:
    chance = random.Random(2)
    for _ in range(25):
        point = near(polygon, chance)
        distance = result_of(Function.DISTANCE, polygon, point)
        assert math.isclose(distance, away(point, polygon), abs_tol=1e-9), point


@pytest.mark.parametrize(
    "text",
    [
        "always inside(p, yard)",
        "never inside(p.x, p.y, far)",
        "never inside(p, yard) and inside(p, far)",
        "always distance(p, far) > 1",
        "always (inside(p, far) implies eventually inside(p, yard) and p.z > 1 within 2 s)",
    ],
)
def test_a_run_that_violates_a_property_of_a_zone_is_shown(
    text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "p.txt").write_text(
        "decl p /odom Odometry.pose.pose.position\n"
        "zone yard = [(-3, -3), (3, -3), (3, 3), (-3, 3)]\n"
        f"zone far = [(3, 3), (6, 3), (6, 6)]\na: {text}\n"
    )
    assert main(["explain", str(tmp_path / "p.txt")]) == 0
    shown = capsys.readouterr().out
    assert "violated at the earliest" in shown
    assert "none shown" not in shown
