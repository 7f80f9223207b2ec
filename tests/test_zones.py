"""Zones: what lies in a polygon, against its winding in exact numbers, in every target; what makes no polygon."""

from __future__ import annotations

import ctypes
import math
import random
import shutil
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from language_support import codes_of, compiled, findings

from benchmarks.differential.polygons import Polygon, away, is_within
from ltlc.backends.c.functions import texts
from ltlc.cli import main
from ltlc.monitoring.columns.functions import ROWS
from ltlc.program.functions import Primitive
from ltlc.runtime import functions as f
from ltlc.specification.evaluation import apply
from ltlc.specification.functions import Function

SQUARE: Polygon = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)]
NOTCHED: Polygon = [(0.0, 0.0), (2.0, 0.0), (2.0, 0.3), (1.1, 0.1), (-0.3, 3.0)]
LONG: Polygon = [(-1e300, 0.1), (5e-324, -5e-324), (1e300, 0.3), (1.7e308, 1e308), (0.0, 1.7e308)]
TINY: Polygon = [(0.0, 0.0), (5e-324, 0.0), (1e-323, 1.5e-323), (-5e-324, 2e-323)]
STAIRS: Polygon = [(0, 0), (3, 0), (3, 1), (2, 1), (2, 2), (1, 2), (1, 3), (0, 3)]
POLYGONS = [SQUARE, NOTCHED, LONG, TINY, STAIRS, NOTCHED[::-1]]

Points = list[tuple[float, float]]


def flat(polygon: Polygon) -> list[float]:
    return [float(coordinate) for corner in polygon for coordinate in corner]


def points(polygon: Polygon, chance: random.Random, count: int) -> Iterator[tuple[float, float]]:
    """Points at random, on corners, on edges as near as doubles are, and beside them; some infinite or NaN."""
    special = [0.0, -0.0, 5e-324, 0.1, 1e300, -1e308, math.inf, -math.inf, math.nan, *flat(polygon)]
    for _ in range(count):
        (a, b), (c, d) = chance.choice(list(zip(polygon, polygon[1:] + polygon[:1], strict=True)))
        share = chance.choice([0.0, 0.5, 1.0, chance.random(), chance.random() * 1e-17])
        x, y = a * (1 - share) + c * share, b * (1 - share) + d * share
        for _ in range(chance.choice([0, 0, 0, 1, 2])):
            y = math.nextafter(y, chance.choice([-math.inf, math.inf]))
        yield chance.choice(
            [(x, y), (x, y), (x, y), (chance.choice(special), chance.choice(special)), (x, chance.gauss(0, 2))]
        )


@pytest.mark.parametrize("polygon", POLYGONS)
def test_what_is_inside_is_decided_exactly(polygon: Polygon) -> None:
    inside = {True: 0, False: 0}
    for x, y in points(polygon, random.Random(1), 3000):
        found = f.inside_of(x, y, *flat(polygon))
        if math.isnan(x) or math.isnan(y):
            assert math.isnan(found)
            continue
        assert found == is_within((x, y), polygon) == apply(Function.INSIDE, [x, y, *flat(polygon)]), (x, y)
        inside[found == 1] += 1
    assert min(inside.values()) > 100


@pytest.mark.parametrize("polygon", [SQUARE, NOTCHED, STAIRS])
def test_a_distance_is_0_inside_and_else_that_from_the_nearest_edge(polygon: Polygon) -> None:
    for x, y in points(polygon, random.Random(2), 2000):
        found, said = f.distance_of(x, y, *flat(polygon)), apply(Function.DISTANCE, [x, y, *flat(polygon)])
        assert repr(found) == repr(said), (x, y)
        if math.isnan(x) or math.isnan(y):
            assert math.isnan(found)
        elif abs(x) < 1e9 and abs(y) < 1e9:
            assert found == pytest.approx(away((x, y), polygon), rel=1e-9, abs=1e-15), (x, y)
            assert found == 0 or not is_within((x, y), polygon)


@pytest.fixture(scope="module")
def in_c(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, list[float]], float]:
    """A function of a zone, of emitted C."""
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("there is no C compiler here")
    folder = tmp_path_factory.mktemp("zones")
    head = ["float.h", "math.h", "stdbool.h", "stddef.h", "stdint.h"]
    body = [text.replace("static double inside", "double inside") for text in texts("inside(distance(", [], "m")]
    body = [text.replace("static double distance", "double distance") for text in body]
    (folder / "zones.c").write_text("\n".join([*(f"#include <{each}>" for each in head), *body]))
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-O2", "-ffp-contract=off", "-fPIC", "-shared"]
    command = [compiler, *flags, "zones.c", "-o", "zones.so", "-lm"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.stderr == ""
    library = ctypes.CDLL(str(folder / "zones.so"))

    def call(name: str, arguments: list[float]) -> float:
        function = getattr(library, name)
        function.restype, function.argtypes = ctypes.c_double, [ctypes.c_void_p, ctypes.c_size_t]
        return float(function((ctypes.c_double * len(arguments))(*arguments), len(arguments)))

    return call


@pytest.mark.parametrize("polygon", POLYGONS)
def test_emitted_c_decides_as_python_does(polygon: Polygon, in_c: Callable[[str, list[float]], float]) -> None:
    for x, y in points(polygon, random.Random(3), 3000):
        for name, function in (("inside", f.inside_of), ("distance", f.distance_of)):
            assert repr(in_c(name, [x, y, *flat(polygon)])) == repr(function(x, y, *flat(polygon))), (name, x, y)


@pytest.mark.parametrize("primitive", [Primitive.INSIDE, Primitive.DISTANCE])
def test_columns_decide_as_rows_do(primitive: Primitive) -> None:
    drawn = list(points(NOTCHED, random.Random(4), 500))
    x, y = (np.array(side) for side in zip(*drawn, strict=True))
    function = f.inside_of if primitive is Primitive.INSIDE else f.distance_of
    expected = [function(*point, *flat(NOTCHED)) for point in drawn]
    np.testing.assert_array_equal(ROWS[primitive](x, y, *map(np.float64, flat(NOTCHED))), expected)


@given(st.lists(st.tuples(st.integers(0, 4), st.integers(0, 4)), min_size=3, max_size=7))
def test_a_border_that_meets_itself_is_refused_and_no_other_is(corners: list[tuple[int, int]]) -> None:
    """By another definition: no point of the border, taken at thirds and halves of a grid, lies on two edges."""
    edges = list(zip(corners, corners[1:] + corners[:1], strict=True))
    text = f"zone z = [{', '.join(map(str, corners))}]\ndecl x /x Float64.data\nnever inside(x, x, z)\n"
    assert ("LTL240" in codes_of(text)) == any(
        one == other or _common(edges[i], edges[j], is_next=j == i + 1 or (i, j) == (0, len(edges) - 1))
        for i in range(len(edges))
        for one, other in [edges[i]]
        for j in range(i + 1, len(edges))
    )


def _common(one: tuple[tuple[int, int], ...], other: tuple[tuple[int, int], ...], is_next: bool) -> bool:
    """Whether two edges have a point in common, by solving for it; of neighbours, more than one."""
    (ax, ay), (bx, by), (cx, cy), (dx, dy) = *one, *other
    across = (bx - ax) * (dy - cy) - (by - ay) * (dx - cx)
    if across == 0:
        if (cx - ax) * (by - ay) != (cy - ay) * (bx - ax):
            return False
        low, high = max(min(one), min(other)), min(max(one), max(other))
        return low < high if is_next else low <= high
    if is_next:
        return False
    first = ((cx - ax) * (dy - cy) - (cy - ay) * (dx - cx)) / across
    second = ((cx - ax) * (by - ay) - (cy - ay) * (bx - ax)) / across
    return 0 <= first <= 1 and 0 <= second <= 1


HEAD = "zone k = [(0, 0), (4, 0), (4, 3)]\ndecl x /x Float64.data\ndecl p /p PointStamped.point\n"


@pytest.mark.parametrize(
    ("text", "code", "message"),
    [
        ("zone z = [(0, 0), (4, 3)]", "LTL240", "a zone has 3 to 200 corners, but `z` has 2"),
        ("zone z = [(0, 0), (4, 3), (1e999, 0)]", "LTL240", "the corner `(1e999, 0)` is infinite"),
        ("zone z = [(0, 0), (x, 3), (1, 0)]", "LTL215", "`x` is a name, but a number is needed here"),
        ("never inside(x, k)", "LTL207", "`inside` takes a point, or its x and y, and a zone, not a number, a zone"),
        (
            "never distance(p, x) < 1",
            "LTL207",
            "`distance` takes a point, or its x and y, and a zone, not a vector, a number",
        ),
        ("never inside(p, k) > 1", "LTL206", "`inside(p, k)` is a property, which `>` cannot compare"),
        ("never abs(inside(p, k)) > 1", "LTL206", "`inside(p, k)` is a property, but a value is needed here"),
        ("never k > 1", "LTL205", "`>` cannot compare a zone and a number"),
        ("k = 3", "LTL102", "`k` is defined twice"),
    ],
)
def test_what_cannot_be_said_of_zones_is_answered(text: str, code: str, message: str) -> None:
    found = [(each.code, each.message) for each in findings(HEAD + text + "\nnever inside(x, x, k)\n")]
    assert (code, message) in found


def test_a_zone_that_is_not_defined_is_answered_with_how_to_define_it() -> None:
    (found,) = findings(HEAD + "never inside(p, kitchen) or inside(x, x, k)\n")
    assert found.code == "LTL101"
    assert "`zone kitchen = [(x, y), …]`" in str(found.help)


def test_a_zone_may_stand_behind_the_properties_that_use_it_and_be_called_as_its_keyword() -> None:
    text = "decl x /x Float64.data\nnever inside(x, x, zone)\nzone zone = [(0, 0),\n  (4, 0), (4, 3)]\n"
    assert len(compiled(text).properties) == 1


def test_a_report_says_whether_a_point_is_inside_and_compares_nothing(tmp_path: Path, capsys: Any) -> None:
    (tmp_path / "props.txt").write_text(HEAD + "never inside(p, k) and x > 2\n")
    (tmp_path / "run.csv").write_text("time,x,p.x,p.y\n0,3,4,2.5\n")
    assert main(["run", str(tmp_path / "props.txt"), str(tmp_path / "run.csv")]) == 1
    said = capsys.readouterr().out
    assert "  inside(p.x, p.y, k): true\n" in said
    assert "  x > 2: true, 3.0 > 2.0 by 1\n" in said


def test_zone_is_a_name_where_no_polygon_follows() -> None:
    text = "decl zone /zone Bool.data\ndecl b /b Bool.data\nnever zone\nx = b\nalways zone implies x\nzone: never b\n"
    assert [each.label for each in compiled(text).properties] == ["line 3", "line 5", "zone"]
