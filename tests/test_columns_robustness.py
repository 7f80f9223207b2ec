"""By how much properties hold, by columns, beside what the definition says of each instant."""

from __future__ import annotations

import math
from collections.abc import Sequence
from random import Random
from typing import Any

import numpy as np
import pytest
from columns_support import DECLARATIONS, KINDS, PARTS, Draw, Drawn, blocks, sizes
from effort import share_of
from stepping import from_text
from test_semantics_robustness import measured_run

from ltlc.backends.python.load import load_plan
from ltlc.base.source import Source
from ltlc.frontend.language import load_text
from ltlc.inputs.recordings.rows import Row
from ltlc.monitoring.columns import extremes, timeline
from ltlc.monitoring.columns.curves import Band, Curve
from ltlc.monitoring.columns.extremes import Clamps
from ltlc.monitoring.columns.measuring import Measuring
from ltlc.monitoring.columns.past import Predicates
from ltlc.monitoring.columns.prepared import prepare_all
from ltlc.monitoring.columns.robustness import Robustness, at_steps, still_possible
from ltlc.monitoring.columns.series import UnsupportedError
from ltlc.monitoring.columns.session import ByBlocks
from ltlc.monitoring.columns.timeline import Timeline
from ltlc.monitoring.later import JudgedTrack
from ltlc.runtime.properties import MonitoredProperty
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Session
from ltlc.runtime.tracking import Observer, Track
from ltlc.semantics import ltl
from ltlc.semantics.properties import predicates
from ltlc.semantics.robustness import Measured, held, margin, robustness, with_past
from ltlc.semantics.timed_atoms import news_that_counts
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.margins import by_how_much


@pytest.mark.parametrize("seed", range(share_of(600)))
def test_columns_have_the_robustness_of_the_definition_at_every_step(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    for room, name in ((extremes, "BLOCK"), (extremes, "WINDOWS"), (timeline, "SEARCHED")):
        monkeypatch.setattr(room, name, seed % 3 + 1)
    monkeypatch.setattr(extremes, "LANE", seed % 3 + 2)
    monkeypatch.setattr(extremes, "LANES", seed % 3 + 3)
    property_, steps, until, past, seen = measured_run(seed)
    news = {each.name for part in predicates(property_) for each in news_that_counts(part)}
    line = Timeline(np.array([step.time for step in steps]), until)
    margins = {name: np.array([step.margins[name] for step in steps]) for name in steps[0].margins}
    run = with_past(held(steps, until, news), past, seen.session)
    assert len(run) == line.count
    try:
        since = dict.fromkeys(news, seen.session)
        found = Robustness(line, Predicates(line, margins, since)).of(property_)
        of_steps = at_steps(property_, line, margins, since)
    except UnsupportedError:
        assert "Within(" in repr(property_)
        return
    expected = [robustness(run[k:], property_) for k in range(line.count)]
    assert found.at(np.arange(line.count)).tolist() == expected
    assert of_steps.tolist() == [expected[k] for k in line.steps.tolist()]


@pytest.mark.parametrize("count", [1, 2, 7, 16, 50])
def test_clamps_in_lanes_make_what_they_make_one_after_the_other(count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(extremes, "LANE", 2)
    monkeypatch.setattr(extremes, "LANES", 19)
    low, high = np.random.default_rng(count).normal(size=(2, count))
    expected = [0.5]
    for least, most in zip(low[::-1], high[::-1], strict=True):
        expected.append(max(least, min(most, expected[-1])))
    assert extremes.backwards(Clamps(low, high), 0.5).tolist() == expected[:0:-1]


def continued(chance: Random, steps: Sequence[Measured], until: int, later: Sequence[Measured]) -> list[Measured]:
    """`steps` up to `until`, and some more, of which some have `later` margins and some larger ones."""
    names = steps[0].margins
    more, time = [], until
    for step in [*later, *chance.choices(steps, k=2)]:
        time += chance.choice((0, 1, 1, 2, 5))
        sizes = {name: chance.choice((0.25, 4.0, math.inf)) for name in names}
        drawn = {
            name: chance.choice((-1, 1)) * (math.inf if math.isinf(steps[0].margins[name]) else sizes[name])
            for name in names
        }
        more.append(Measured(time, chance.choice((step.margins, drawn))))
    return [*steps, *more[: chance.randrange(len(more) + 1)]]


@pytest.mark.parametrize("seed", range(share_of(600)))
def test_what_is_still_possible_contains_the_robustness_of_every_continuation(seed: int) -> None:
    property_, steps, until, past, seen = measured_run(seed)
    chance = Random(seed)
    news = {each.name for part in predicates(property_) for each in news_that_counts(part)}
    count = chance.randrange(1, len(steps) + 1)
    now = steps[count].time if count < len(steps) else until
    line = Timeline(np.array([step.time for step in steps[:count]]), now)
    margins = {name: np.array([step.margins[name] for step in steps[:count]]) for name in steps[0].margins}
    try:
        low, high = still_possible(property_, line, margins, dict.fromkeys(news, seen.session))
    except UnsupportedError:
        assert "Within(" in repr(property_)
        return
    for _ in range(30):
        longer = continued(chance, steps[:count], now, steps[count:])
        end = max(now, longer[-1].time) + chance.randrange(4)
        run = with_past(held(longer, end, news), past, seen.session)
        assert low <= robustness(run, property_) <= high


class Captured:
    """Takes the place of letters: the values of a property's inputs at each of its steps."""

    is_settled = False

    def __init__(self) -> None:
        self.steps: list[tuple[int, Sequence[Any]]] = []

    def step(self, time: int, values: Sequence[Any] | None) -> None:
        if values is not None:
            self.steps.append((time, values))

    def hear(self, *_: Any) -> None: ...


class EachStep(JudgedTrack):
    """Takes every tick by itself, whose time is then known."""

    is_settled = property(lambda self: False, lambda self, value: None)


def measured(drawn: Drawn) -> tuple[dict[str, Curve], dict[str, Captured], Session, Any, dict[str, Band]]:
    """The curves of what is drawn, the values that rows see, the session of the rows, and what is still possible."""
    compiled, specification = from_text(drawn.text)
    given = {name for part in drawn.parts for row in part for name in row.values} | set(KINDS) | {"v", "w"}
    given -= set(PARTS) - {"robot.position.x"}
    plan = load_plan(compiled, specification, given - {"v", "w", "flag"})  # the messages of which open instances
    captured: dict[str, Captured] = {each.specification.label: Captured() for each in compiled}

    def track(property_: MonitoredProperty, keep: bool, observer: Observer | None) -> Track:
        return EachStep(property_, keep, observer, False, captured[property_.label])  # type: ignore[arg-type]

    reference, prepared = ByRows(Session(plan, make=track)), prepare_all(compiled, specification.source)
    fast = ByBlocks(Session(plan), prepared)
    measuring = Measuring(fast.session, compiled, prepared)
    wanted = [s.name for s in plan.signals if s.name in given]
    for block in blocks(drawn.parts, wanted):
        for time, names, values, topics in block.rows(set(wanted)):
            reference.samples(time, names, values, topics)
        measuring.take(block)
        fast.take(block)
    end = fast.session.time
    if end is not None:
        measuring.finish(end)
        reference.advance(end)
    return measuring.curves(end), captured, reference.session, compiled, measuring.bands(end or 0)


class Counting(Draw):
    """Draws properties that count."""

    def _atom(self) -> str:
        counts = ("once v > 1 2 times within 300 ms", "once flag 2 times", "once (new w and w > 0) 3 times")
        return self.chance.choice(counts) if self.chance.random() < 0.3 else super()._atom()


@pytest.mark.parametrize("seed", range(share_of(120)))
def test_curves_begin_with_a_margin_whose_sign_is_the_verdict(seed: int) -> None:
    drawn = (Draw, Counting)[seed % 2](Random(seed)).drawn()
    with sizes(Random(seed)):
        curves, captured, session, *_ = measured(drawn)
    for track in session.tracks:
        curve = curves[track.property.label]
        if curve.reason:
            assert not len(curve.margins)
            continue
        assert curve.times.tolist() == [time for time, _ in captured[track.property.label].steps], drawn.text
        if curve.whole is None:
            assert track.verdict is Verdict.NOT_STARTED
        elif curve.whole != 0:
            holds = track.verdict in (Verdict.SATISFIED, Verdict.PRESUMABLY_SATISFIED)
            assert (curve.whole > 0) is holds, drawn.text


class Opening(Draw):
    """Draws properties that are judged from each message on."""

    def _property(self) -> str:
        return f"each new {self.chance.choice(('v', 'w', 'flag'))}: {super()._property()}"


@pytest.mark.parametrize("seed", range(share_of(200)))
def test_from_each_message_on_the_sign_is_the_verdict(seed: int) -> None:
    drawn = Opening(Random(seed)).drawn()
    with sizes(Random(seed)):
        curves, _, session, _, bands = measured(drawn)
    for track in session.tracks:
        curve, band = curves[track.property.label], bands[track.property.label]
        if curve.whole is None or not track.slices or not track.slices.ids.messages:
            continue  # as what has been put in the place of v, w or flag has no messages here
        assert band.low == -math.inf
        assert curve.whole <= band.high
        if curve.whole != 0:
            holds = track.verdict in (Verdict.NOT_STARTED, Verdict.PRESUMABLY_SATISFIED)
            assert (curve.whole > 0) is holds, drawn.text
        if band.high < 0:
            assert track.verdict is Verdict.VIOLATED, drawn.text


@pytest.mark.parametrize("rate", ["", "_rate_ = 10\n"])
def test_the_message_with_the_least_robustness_is_named(rate: str) -> None:
    tenth = 10**8
    given: list[dict[str, Any]] = [
        {"w": 1.0},
        {"v": 1.0},
        {"w": 2.5},
        {"v": 2.0},
        {"w": 1.75},
        {},
        {"v": 3.0},
        {"w": 3.0},
    ]
    rows = [Row(k * tenth, values) for k, values in enumerate(given)]
    text = DECLARATIONS + rate + "p: each new v: eventually (new w and w > 2) within 200 ms"
    for parts in ([rows], [rows[:2], rows[2:5], rows[5:]]):
        curve = measured(Drawn(text, parts))[0]["p"]
        assert (curve.whole, curve.decided, curve.opened_at) == (-0.25, (4 * tenth, "w > 2"), 3 * tenth)
        at = dict(zip(curve.times.tolist(), curve.margins.tolist(), strict=True))
        assert (at[tenth], at[4 * tenth], at[7 * tenth]) == (-0.25, 1.0, math.inf)


@pytest.mark.parametrize("seed", range(share_of(120)))
def test_what_is_still_possible_has_one_sign_only_if_the_verdict_is_permanent(seed: int) -> None:
    drawn = (Draw, Counting)[seed % 2](Random(seed)).drawn()
    with sizes(Random(seed)):
        curves, _, session, _, bands = measured(drawn)
    for track in session.tracks:
        curve, band = curves[track.property.label], bands[track.property.label]
        assert band.reason == curve.reason
        assert band.low <= (curve.whole or 0) <= band.high or curve.whole is None
        if band.low > 0:
            assert track.verdict is Verdict.SATISFIED, drawn.text
        if band.high < 0:
            assert track.verdict is Verdict.VIOLATED, drawn.text


@pytest.mark.parametrize("seed", range(share_of(120)))
def test_the_margins_of_conditions_are_those_of_the_reference(seed: int) -> None:
    draw = Draw(Random(seed))
    lines = [line for line in (f"initially ({draw._atom()})" for _ in range(8)) if is_accepted(line)]
    text = DECLARATIONS + "".join(f"p{number}: {line}\n" for number, line in enumerate(lines))
    with sizes(Random(seed)):
        curves, captured, _, compiled, _ = measured(Drawn(text, draw._cut(draw._rows())))
    for each in compiled:
        of = each.specification
        curve, steps = curves[of.label], captured[of.label].steps
        [predicate] = [part for part in predicates(of.property) if ltl.atoms(part)]
        expected = []
        for _, values in steps:
            given = dict(zip(of.reads(), values, strict=True))
            expected.append(margin(predicate, {a.name: by_how_much(a.condition, given) for a in of.atoms}))
        if not curve.reason:
            assert curve.margins.tolist() == expected, of.text


def is_accepted(line: str) -> bool:
    return load_text(Source("props.txt", DECLARATIONS + line))[0] is not None


@pytest.mark.parametrize(
    ("condition", "expected"),
    [
        ("v < 2", [1, -1, 0]),
        ("v <= 2", [1, -1, 0]),
        ("v >{0.5} 2", [-0.5, 1.5, 0.5]),
        ("v == 3", [-2, 0, -1]),
        ("v != 3", [2, 0, 1]),
        ("v =={1.5} 3", [-0.5, 1.5, 0.5]),
        ("any(scan < 2)", [1, -np.inf, 1.5]),
        ("all(scan < 2)", [-1, np.inf, -3]),
        ("count(scan < 2) >= 2", [-1, -2, -1]),
        ("len(scan) < 2", [-1, 1, 0]),
        ("flag", [np.inf, np.inf, np.inf]),
        ('mode == "a"', [np.inf, -np.inf, -np.inf]),
        ("new v", [np.inf, np.inf, np.inf]),
    ],
)
def test_a_condition_has_the_margin_that_the_documentation_says(condition: str, expected: list[float]) -> None:
    columns: dict[str, list[Any]] = {
        "v": [1.0, 3.0, 2.0],
        "scan": [(1.0, math.nan, 3.0), (math.nan,), (0.5, 5.0)],
        "flag": [True] * 3,
        "mode": ["a", "b", "b"],
    }
    rows = [Row(k, {name: column[k] for name, column in columns.items()}) for k in range(3)]
    curves, *_ = measured(Drawn(DECLARATIONS + f"p: initially ({condition})", [rows]))
    assert curves["p"].margins.tolist() == expected


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("_rate_ = 10\np: each i of n: never v > i", "the ticks of each id"),
        ("p: each i of n: after new n, never v > @{v, opening}", "values at an opening, of each id"),
        ("p: each new flag: never v > @{v, opening}", "values at an opening, from each message on"),
        ("p: each new v limit 1: eventually v > 2 within 1 s", "messages were ignored for which there was no place"),
        (
            "p: after historically flag for 1 ns, never v > @{v, opening}",
            "time opens or closes a scope, at whose opening a value is read, between two steps",
        ),
        ("p: within 1 s, after flag, never v > 1", "a bound on temporal operators inside one another"),
        ("_rate_ = 10\np: always age(v) < 1 s", "messages between ticks, from which ages count"),
    ],
)
def test_what_cannot_be_measured_has_no_margins_but_a_reason(text: str, reason: str) -> None:
    rows = [Row(k, {"v": 1.0, "flag": True, "n": 1}) for k in range(2)]
    curves, *_ = measured(Drawn(DECLARATIONS + text, [rows]))
    assert (curves["p"].whole, curves["p"].reason) == (None, reason)


def test_values_at_openings_are_those_of_the_run() -> None:
    flags, values = [False, True, True, False, True, True], [5.0, 1.0, 3.0, 0.5, 4.0, 4.5]
    rows = [Row(k, {"flag": flag, "v": v}) for k, (flag, v) in enumerate(zip(flags, values, strict=True))]
    text = DECLARATIONS + "p: after_until flag, not flag, always v <= @{v, opening} + 3"
    for parts in ([rows], [rows[:2], rows[2:5], rows[5:]]):
        curves, *_ = measured(Drawn(text, parts))
        assert curves["p"].margins.tolist() == [1, 1, 1, 2.5, 2.5, 2.5]
        assert curves["p"].decided == (2, "v <= @{v, opening} + 3")


def test_a_closing_event_reads_the_value_at_its_opening() -> None:
    rows = [
        Row(k, {"flag": True, "v": v, "w": w}) for k, (v, w) in enumerate([(1, 9), (1.5, 8), (3, 7), (3, 6), (3, 5)])
    ]
    text = DECLARATIONS + "p: after_until flag, v > @{v, opening} + 1, eventually w < 7.5"
    curves, *_ = measured(Drawn(text, [rows]))
    assert curves["p"].margins.tolist() == [-0.5, -0.5, 1, 1, 1]


def test_ticks_are_the_steps() -> None:
    rows = [Row(k * 10**8 // 4, {"v": v}) for k, v in enumerate([1.0, 5.0, 2.0, 3.0, 4.0, 1.5, 9.0, 9.0, 0.5])]
    curves, *_ = measured(Drawn(DECLARATIONS + "_rate_ = 10\np: always v < 5", [rows[:2], rows[2:]]))
    assert curves["p"].times.tolist() == [0, 10**8, 2 * 10**8]
    assert curves["p"].margins.tolist() == [1, 1, 4.5]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("never once v > 1 2 times", -0.25),
        ("never once v > 1 2 times within 2 s", 0.25),
        ("never once v > 1 3 times", 0.25),
        ("never once v > 1 7 times", math.inf),
        ("never once (new v and v > 1) 2 times within 2 s", 0.25),
        ("always rate(v) >= 1 Hz over 1 s", math.inf),
        ("always rate(v) >= 1 Hz over 1 s and v < 2", 0.25),
    ],
)
def test_a_count_has_the_margin_of_the_occurrence_that_reaches_it(text: str, expected: float) -> None:
    rows = [Row(k * 10**9, {"v": v}) for k, v in enumerate([1.5, 0.5, 0.75, 1.75, 0.25, 0.75])]
    curves, *_ = measured(Drawn(DECLARATIONS + f"p: {text}", [rows]))
    assert curves["p"].whole == expected


def test_a_message_without_a_value_has_no_margin() -> None:
    rows = [Row(k, {"v": value}) for k, value in enumerate([1.0, math.nan, 0.5])]
    curves, *_ = measured(Drawn(DECLARATIONS + "p: initially v < 2", [rows]))
    assert (curves["p"].times.tolist(), curves["p"].margins.tolist()) == ([0, 2], [1.0, 1.5])


def test_blocks_are_one_run() -> None:
    rows = [Row(k, {"v": float(k % 7)}) for k in range(40)]
    text = DECLARATIONS + "p: always (v > 5 implies eventually v < 1 within 2 ns)"
    whole, *_ = measured(Drawn(text, [rows]))
    parts, *_ = measured(Drawn(text, [rows[:13], rows[13:14], rows[14:]]))
    assert whole["p"].margins.tolist() == parts["p"].margins.tolist()
    assert whole["p"].whole == 1.0


@pytest.mark.parametrize(("text", "expected"), [("age(v) <= 2 ns", np.inf), ("age(v) <= 1 ns", -np.inf)])
def test_an_age_counts_from_messages_before_the_first_step(text: str, expected: float) -> None:
    rows = [Row(0, {"flag": True}), Row(5, {"v": 1.0}), Row(7, {"w": 1.0})]
    curves, *_ = measured(Drawn(DECLARATIONS + f"p: initially ({text} and w < 2)", [rows[:2], rows[2:]]))
    assert curves["p"].margins.tolist() == [min(expected, 1.0)]
