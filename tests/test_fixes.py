"""Mends that findings bring: carried out, they leave a text without the fault, and without a new one."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ltlc.analysis.analyse import analyse
from ltlc.automata import Budget
from ltlc.base.diagnostics import Diagnostic, Fix
from ltlc.base.fixes import apart, with_fixes
from ltlc.base.source import Source, Span
from ltlc.frontend.language import load_text
from ltlc.frontend.language.suppression import suppress
from ltlc.semantics.encodings import EPISODE

FIXTURES = sorted(p for room in ("check", "robots") for p in (Path(__file__).parent / "fixtures" / room).glob("*.txt"))
OF_SYNTAX = "LTL0"

FIXES = [
    ("never robot.velocity = 0", "never robot.velocity == 0", "LTL003", True),
    ("robot.velocity = 0", "robot.velocity == 0", "LTL003", False),
    ("never robot.velocity > 2 && true", "never robot.velocity > 2 and true", "LTL004", True),
    ("never a.velocity>2&&!b.velocity>2", "never a.velocity>2 and !b.velocity>2", "LTL004", True),
    ("never robot.velocity === 2", "never robot.velocity == 2", "LTL004", True),
    ("never robot.velocity > 1 and\nslow = 2", "never robot.velocity > 1 and\nslow == 2", "LTL003", False),
    ("Within = 2\nnever robot.velocity > 1", "within = 2\nnever robot.velocity > 1", "LTL004", False),
    ("WITHIN = 2\nnever robot.velocity > WITHIN", "within = 2\nnever robot.velocity > WITHIN", "LTL004", False),
    ("G (robot.velocity > 2)", "always (robot.velocity > 2)", "LTL004", False),
    ("Never robot.velocity > 2", "never robot.velocity > 2", "LTL004", True),
    ("eventually robot.velocity > 2 within 5 secs", "eventually robot.velocity > 2 within 5 s", "LTL004", True),
    ("decl m /m String.data\nnever m == 'on'", 'decl m /m String.data\nnever m == "on"', "LTL004", True),
    ("after until true, true, true", "after_until true, true, true", "LTL010", True),
    ("never robot.velocity > .5", "never robot.velocity > 0.5", "LTL014", True),
    ("never robot.velocity > 36 km/h", "never robot.velocity > 10", "LTL020", False),
    ("after true never robot.velocity > 2", "after true, never robot.velocity > 2", "LTL002", False),
    ("never (robot.velocity > 2", "never (robot.velocity > 2)", "LTL005", False),
    ("model robot: position /odom Odometry.pose.pose.position\nnever robot.localization_error > 1",
     "model robot: position /odom Odometry.pose.pose.position ;\nnever robot.localization_error > 1", "LTL007", True),
    ("object robot /odom Odometry\nforall r in {\"robot\"}: never r.velocity > 1",
     "object robot /odom Odometry\nforall r in {robot}: never r.velocity > 1", "LTL018", True),
    ("forall r in {a, b}: slow: never r.velocity > 1",
     "slow: forall r in {a, b}: never r.velocity > 1", "LTL018", True),
    ("forall r in {a b}: never r.velocity > 1", "forall r in {a, b}: never r.velocity > 1", "LTL002", False),
    ("always robot.velocity not in {1, 2}", "always not robot.velocity in {1, 2}", "LTL001", True),
    ("within = robot.velocity > 1", "my_within = robot.velocity > 1", "LTL008", False),
    ("_margn_ = 0.1\nnever robot.velocity > 1", "_margin_ = 0.1\nnever robot.velocity > 1", "LTL401", True),
    ("_simulator_ = odometri\nnever robot.velocity > 1",
     "_simulator_ = odometry\nnever robot.velocity > 1", "LTL402", True),
    ("never sqrrt(robot.velocity) > 1", "never sqrt(robot.velocity) > 1", "LTL107", True),
    ("never evntually(robot.velocity) > 1", "never eventually(robot.velocity) > 1", "LTL107", False),
    ("decl s /s Odometry.pose.poze.position.x\nnever s > 1", "decl s /s Odometry.pose.pose.position.x\nnever s > 1",
     "LTL203", True),
    ("near = robot.velocity > 1\nnever naer", "near = robot.velocity > 1\nnever near", "LTL101", False),
    ("drift always robot.velocity > 1", "drift: always robot.velocity > 1", "LTL101", False),
    ("never robot.velocty > 1", "never robot.velocity > 1", "LTL105", False),
    ("decl s /s GoalStatus.status\nnever s > 1", "decl s /s action_msgs/msg/GoalStatus.status\nnever s > 1",
     "LTL202", False),
    ("near = robot.velocity > 1\nnear = 2\nnever near",
     "near = robot.velocity > 1\nnear == 2\nnever near", "LTL102", False),
    ("never @{robot.velocity, 1} > 1", "never @{robot.velocity, -1} > 1", "LTL211", False),
    ("eventually robot.velocity > 1 within 5", "eventually robot.velocity > 1 within 5 s", "LTL216", False),
    ("within 2 s, robot.velocity > 1", "within 2 s, eventually robot.velocity > 1", "LTL309", False),
    ("eventually once robot.velocity > 1 and true within 2 s",
     "eventually (once robot.velocity > 1 and true) within 2 s", "LTL309", False),
    ("eventually robot.velocity > 1 for 2 s", "eventually robot.velocity > 1 within 2 s", "LTL308", False),
    ("always robot.velocity =={0.1} 0 implies robot.velocity > 1 within 3 s",
     "always (robot.velocity =={0.1} 0 implies eventually robot.velocity > 1 within 3 s)", "LTL308", False),
    ("always robot.velocity > 1 or eventually robot.velocity < 1",
     "always (robot.velocity > 1 or eventually robot.velocity < 1)", "LTL311", False),
    ("decl scan /s LaserScan.ranges\nnever scan < 1",
     "decl scan /s LaserScan.ranges\nnever any(scan < 1)", "LTL205", False),
    ("decl scan /s LaserScan.ranges\nalways age(scan) < 1", "decl scan /s LaserScan.ranges\nalways age(scan) < 1 s",
     "LTL218", False),
    ("never robot.velocity > 1 never robot.velocity < 0", "never robot.velocity > 1\nnever robot.velocity < 0",
     "LTL019", False),
    ("object robot at (0, 0, 0)\nnever robto.position.x > 1 and robto.position.y > 1",
     "object robot at (0, 0, 0)\nnever robot.position.x > 1 and robot.position.y > 1", "LTL110", False),
]  # fmt: skip

FINDINGS = [
    ("eventually robot.velocity == 0", "eventually robot.velocity =={0.01} 0", "LTL520"),
    ("never robot.velocity > 2\nslow: never robot.velocity > 3  # legal\n", "never robot.velocity > 2\n", "LTL602"),
    ("never robot.velocity > 2\nslow:\n  always robot.velocity <= 2", "never robot.velocity > 2\n", "LTL603"),
    ("within 2 s, within 5 s, eventually robot.velocity > 1", "within 2 s, eventually robot.velocity > 1", "LTL507"),
    ("within 2 s, eventually robot.velocity > 1 within 5 s", "within 2 s, eventually robot.velocity > 1", "LTL507"),
    ("never @{robot.velocity, -1} > 2", "_rate_ = 30\nnever @{robot.velocity, -1} > 2", "LTL521"),
    ("never robot.velocity > 1  # ltlc: ignore LTL520\r\n", "never robot.velocity > 1\r\n", "LTL691"),
    ("# ltlc: ignore LTL520\r\nnever robot.velocity > 1", "never robot.velocity > 1", "LTL691"),
    ("eventually robot.velocity == 0  # ltlc: ignore LTL510 LTL520 hm",
     "eventually robot.velocity == 0  # ltlc: ignore LTL520 hm", "LTL691"),
]  # fmt: skip


def first(found: list[Diagnostic], code: str) -> Diagnostic:
    return next(each for each in found if each.code == code)


def of_text(text: str) -> list[Diagnostic]:
    return load_text(Source("props.txt", text))[1]


def analysed(text: str) -> list[Diagnostic]:
    specification, found = load_text(Source("props.txt", text))
    assert specification is not None
    return suppress(specification, [*found, *analyse(specification, EPISODE, Budget(60.0, 1024)).diagnostics])


@pytest.mark.parametrize(("text", "better", "code", "is_certain"), FIXES, ids=[fix[0] for fix in FIXES])
def test_the_first_mend_is_what_one_would_write(text: str, better: str, code: str, is_certain: bool) -> None:
    fix = first(of_text(text), code).fixes[0]
    assert with_fixes(text, [fix]) == better
    assert fix.is_certain is is_certain


@pytest.mark.parametrize(("text", "better", "code"), FINDINGS, ids=[finding[0] for finding in FINDINGS])
def test_what_analyses_find_is_mended_by_choice_only(text: str, better: str, code: str) -> None:
    fix = first(analysed(text), code).fixes[0]
    assert with_fixes(text, [fix]) == better
    assert code not in [each.code for each in analysed(better)]
    assert not fix.is_certain


@pytest.mark.parametrize(("text", "better", "code", "_"), FIXES, ids=[fix[0] for fix in FIXES])
def test_a_mended_text_has_the_fault_no_more(text: str, better: str, code: str, _: bool) -> None:
    assert [each.code for each in of_text(better)].count(code) < [each.code for each in of_text(text)].count(code)


@pytest.mark.parametrize("path", FIXTURES, ids=lambda path: path.stem)
def test_every_mend_of_a_fixture_takes_its_finding_away_and_breaks_no_syntax(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    found = of_text(text)
    for finding, fix in ((each, fix) for each in found for fix in each.fixes):
        after = of_text(with_fixes(text, [fix]))
        assert messages(after)[finding.code, finding.message] < messages(found)[finding.code, finding.message]
        assert not [line for _, line in new_faults(found, after) if line in lines(text, fix)]


def messages(found: list[Diagnostic]) -> Counter[tuple[str, str]]:
    return Counter((each.code, each.message) for each in found)


def faults(found: list[Diagnostic]) -> Counter[tuple[str, int]]:
    """The faults of syntax, each with its line."""
    places = [(each.code, each.source.position(each.primary.span.start).line) for each in found if each.primary]
    return Counter(place for place in places if place[0].startswith(OF_SYNTAX))


def new_faults(before: list[Diagnostic], after: list[Diagnostic]) -> set[tuple[str, int]]:
    return set(faults(after) - faults(before))


def lines(text: str, fix: Fix) -> set[int]:
    """The lines that a fix changes: what stands further down after an error may be read only now."""
    return {Source("", text).position(span.start).line for span, _ in fix.edits}


@pytest.mark.parametrize(
    "text",
    [
        "never neer",
        "decl near /n Bool.data\ndecl near2 /n Bool.data\nnever neear",
        "_tolerance_ = 1\nnever robot.velocity > 1",
        "never robot.batery > 1",
        "F (robot.velocity > 1) & robot.velocity < 0",
        "decl m /m String.data\nnever m == on",
        "decl o /o Odometri.pose.pose.position.x\nnever o > 1",
        "decl e /e Bool.data\nnever e <-> true",
        "never a.velocity == b.velocity not in {1}",
        "never robot.velocity > Until\nUntil = 2",
        "never robot.6 > 1",
        "never robot.velocity >& 1",
        "decl n /n Float64.da|ta\nnever n > 1",
        "never robot.velocity =={b0.6} 2",
        "decl scan = /scan LaserScan.ranges\nnever any(scan < 1)",
        "model robot: position = /odom Odometry.pose.pose.position ;\nnever robot.localization_error > 1",
        "model robot: position /odom Odometry.pose.pose.position\nnear = robot.velocity < 1\nnever near",
    ],
)
def test_what_may_be_meant_otherwise_is_not_certain(text: str) -> None:
    certain = [fix for each in of_text(text) for fix in each.fixes if fix.is_certain]
    assert all(fix.title == "write `and`" for fix in certain), certain


def test_of_two_mends_of_one_place_the_first_is_carried_out() -> None:
    one, two = (Fix("", ((Span(2, 3), text),)) for text in ("x", "yy"))
    other = Fix("", ((Span(0, 1), ""), (Span(5, 5), "!")))
    assert with_fixes("abcde", apart([one, two, other])) == "bxde!"


@given(st.lists(st.tuples(st.integers(0, 12), st.integers(0, 3)), max_size=6))
def test_fixes_apart_are_those_that_touch_no_earlier_one(places: list[tuple[int, int]]) -> None:
    fixes = [Fix(str(number), ((Span(at, at + length), "-"),)) for number, (at, length) in enumerate(places)]
    chosen: list[Fix] = []
    for fix in fixes:
        [(span, _)] = fix.edits
        if all(span.end < other.start or other.end < span.start for each in chosen for other, _ in each.edits):
            chosen.append(fix)
    assert apart(fixes) == chosen
