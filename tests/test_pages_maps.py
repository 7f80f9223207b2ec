"""Zones on pages: where a point went among them, and what is said of it."""

from __future__ import annotations

from pathlib import Path

import pytest
from stepping import from_text

from ltlc.interfaces.pages import maps
from ltlc.interfaces.pages.maps import Map, courses, map_of
from ltlc.interfaces.pages.report import PageReport
from ltlc.interfaces.pages.series import Collector
from ltlc.monitoring.judging.run import Judge

DECLARATIONS = """decl x /x Float64.data
decl y /y Float64.data
decl scan /scan sensor_msgs/LaserScan.ranges
zone kitchen = [(0, 0), (4, 0), (4, 3), (0, 3)]
zone door = [(4, 1), (5, 1), (5, 2), (4, 2)]
"""


def zones_asked(property_: str) -> list[list[str]]:
    compiled, _ = from_text(f"{DECLARATIONS}{property_}\n")
    return [list(course.zones) for course in courses(compiled[0].specification)]


def recorded(folder: Path, *rows: str) -> Path:
    path = folder / "run.csv"
    path.write_text("".join(f"{row}\n" for row in rows))
    return path


def drawn(folder: Path, property_: str, *rows: str) -> Map:
    compiled, specification = from_text(f"{DECLARATIONS}{property_}\n")
    (course,) = courses(compiled[0].specification)
    collector = Collector({course.x: (), course.y: ()}, 10_000)
    judged = Judge(compiled, specification).judge(recorded(folder, *rows), [collector.take])
    assert judged.session is not None
    return map_of(course, collector.series, judged.session.scale, judged.session.tracks[0])


def test_zones_that_one_point_is_asked_of_share_a_map() -> None:
    assert zones_asked("never inside(x, y, kitchen) and distance(x, y, door) < 1") == [["kitchen", "door"]]
    assert zones_asked("never inside(x, y, kitchen) and inside(x + 1, y, door)") == [["kitchen"], ["door"]]


@pytest.mark.parametrize(
    "property_", ["never x > 1", "never any(inside(scan, scan, kitchen))", "never inside(@{x, opening}, y, kitchen)"]
)
def test_where_no_recorded_point_is_asked_of_a_zone_there_is_no_map(property_: str) -> None:
    assert zones_asked(property_) == []


def test_a_map_says_when_the_path_enters_and_leaves_a_zone(tmp_path: Path) -> None:
    rows = ("time,x,y", "0,-1,1", "1,1,1", "2,2,1", "3,2,5")
    found = drawn(tmp_path, "never inside(x, y, kitchen) within 1 ns", *rows)
    assert found.described == ("The path starts outside kitchen. At +1 s it enters kitchen. At +3 s it leaves kitchen.")
    assert "enters kitchen at +1 s" in found.svg
    assert "leaves kitchen at +3 s" in found.svg


def test_the_border_belongs_to_a_zone_on_a_map(tmp_path: Path) -> None:
    found = drawn(tmp_path, "never inside(x, y, kitchen) within 1 ns", "time,x,y", "0,-1,1", "1,0,1")
    assert "At +1 s it enters kitchen." in found.described


def test_the_point_at_which_a_property_is_violated_is_marked(tmp_path: Path) -> None:
    found = drawn(tmp_path, "never inside(x, y, kitchen)", "time,x,y", "0,-1,1", "2.5,1,1", "3,9,9")
    assert "violated at +2.5 s" in found.svg


def test_a_coordinate_keeps_its_value_until_the_next_and_what_is_not_finite_is_not_drawn(tmp_path: Path) -> None:
    rows = ("time,x,y", "0,,1", "1,-1,", "2,1,", "3,inf,", "4,nan,")
    found = drawn(tmp_path, "never inside(x, y, kitchen) within 1 ns", *rows)
    assert found.described == "The path starts outside kitchen. At +2 s it enters kitchen."


def test_a_point_that_was_not_recorded_has_no_path(tmp_path: Path) -> None:
    found = drawn(tmp_path, "eventually inside(x, y, kitchen)", "time,x", "0,1")
    assert found.described == "kitchen: no position was recorded."


def test_a_path_of_too_many_points_is_thinned_which_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(maps, "MOST_POINTS", 10)
    rows = ("time,x,y", *(f"{n},{n / 10},{n % 2}" for n in range(40)))
    found = drawn(tmp_path, "eventually inside(x, y, door) within 1 ns", *rows)
    assert found.remark == "10 of 40 points of the path are drawn."


def test_a_page_has_the_map_of_a_property_with_a_zone_and_of_no_other(tmp_path: Path) -> None:
    compiled, specification = from_text(f"{DECLARATIONS}a: never inside(x, y, kitchen)\nb: never x > 100\n")
    made = PageReport(compiled, specification)
    collected = made.collector()
    judge = Judge(compiled, specification, keep_trails=True)
    made.add(judge.judge(recorded(tmp_path, "time,x,y", "0,-1,1", "1,1,1"), [collected.take]), collected)
    assert made.html().count('class="map"') == 1
    assert "At +1 s it enters kitchen." in made.html()
