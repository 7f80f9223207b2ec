"""Ages count from the message itself, where its value is NaN and between ticks as well, in whatever runs."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence

import pytest
from columns_support import DECLARATIONS, Drawn, judged, state
from stepping import emitted as python_module
from stepping import from_text, session

import ltlc
from ltlc.inputs.recordings.rows import Row
from ltlc.runtime.times import SECOND
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.expressions import New

NAN = math.nan
SCAN = "decl scan /scan LaserScan.range_min\ndecl v /v std_msgs/Float64.data\n"
WATCHDOG = f"{SCAN}w: always (age(scan) > 1 s implies v < 0.1 or scan > 2)\n"
BACK = f"{SCAN}w: eventually (age(scan) <= 100 ms and previously age(scan) > 100 ms and v > 5)\n"

Said = Sequence[tuple[float, str, float]]
"""Messages: when, in s, on which topic, and their value."""


def decided(text: str, said: Said, until: float) -> tuple[Verdict, float | None]:
    """The verdict on messages, up to a time in s, and since when it is final."""
    run = session(text)
    for time, topic, value in said:
        run.message(round(time * SECOND), topic, [value])
    run.advance(round(until * SECOND))
    [track] = run.tracks
    return track.verdict, None if track.decided_at is None else track.decided_at.time / SECOND


def test_a_topic_that_says_nan_is_not_silent() -> None:
    said = [(0.0, "/scan", 1.0), (0.0, "/v", 1.0), *((0.5 * n, "/scan", NAN) for n in range(1, 8))]
    assert decided(WATCHDOG, said, 4.5) == (Verdict.PRESUMABLY_SATISFIED, None)
    assert decided(WATCHDOG, said, 4.6) == (Verdict.VIOLATED, 4.500000001)


def test_nan_makes_an_age_that_was_late_young_at_its_own_time() -> None:
    said = [(0.0, "/scan", 1.0), (2.0, "/v", 9.0)]
    assert decided(BACK, said, 3) == (Verdict.PRESUMABLY_VIOLATED, None)
    assert decided(BACK, [*said, (2.5, "/scan", NAN)], 2.5) == (Verdict.SATISFIED, 2.5)


def test_a_message_that_makes_no_step_is_no_news() -> None:
    text = f"{SCAN}w: always (previously age(scan) > 1 s and age(scan) <= 1 s implies new scan or v > 5 or scan > 9)\n"
    said = [(0.0, "/scan", 1.0), (0.0, "/v", 1.0), (2.0, "/scan", 1.0)]
    assert decided(text, said, 9) == (Verdict.PRESUMABLY_SATISFIED, None)
    assert decided(text, [*said, (4.0, "/scan", NAN)], 9) == (Verdict.VIOLATED, 4.0)


def test_nan_before_the_first_step_renews_an_age() -> None:
    text = f"{SCAN}w: always (age(scan) <= 1 s or v < 5)\n"
    assert decided(text, [(0.0, "/scan", NAN), (0.9, "/scan", NAN), (1.5, "/v", 9.0)], 1.9)[0] is not Verdict.VIOLATED
    assert decided(text, [(0.0, "/scan", NAN), (1.5, "/v", 9.0), (1.6, "/v", 9.0)], 1.7)[0] is Verdict.VIOLATED


def test_what_is_decided_stays_so_whatever_messages_come() -> None:
    said = [(0.0, "/scan", 1.0), (0.0, "/v", 1.0), (3.0, "/scan", NAN), (5.0, "/scan", 1.0)]
    assert decided(WATCHDOG, said, 9) == (Verdict.VIOLATED, 1.000000001)


def test_with_a_rate_an_age_counts_from_the_message_and_not_from_the_tick() -> None:
    text = f"_rate_ = 1\n{SCAN}w: always (age(scan) <= 3 s or v > 5)\n"
    said = [(0.0, "/v", 1.0), (0.0, "/scan", 1.0), (1.75, "/scan", 1.0)]
    assert decided(text, said, 9) == (Verdict.VIOLATED, 4.750000001)


def test_with_a_rate_an_age_shorter_than_the_period_is_young_between_ticks() -> None:
    said = [(0.0, "/scan", 1.0), (0.0, "/v", 9.0), (1.25, "/scan", 1.0)]
    assert decided(f"_rate_ = 1\n{BACK}", said, 1.25) == (Verdict.SATISFIED, 1.25)


def test_a_tick_at_the_time_of_a_message_sees_it_and_nothing_comes_before() -> None:
    said = [(0.0, "/scan", 1.0), (0.0, "/v", 9.0), (2.0, "/scan", 1.0), (2.0, "/v", 1.0)]
    text = f"_rate_ = 1\n{BACK}".replace("eventually", "never")
    assert decided(text, said, 2.05) == (Verdict.PRESUMABLY_SATISFIED, None)


def test_a_tick_that_makes_no_step_leaves_what_a_message_renews_at_its_time() -> None:
    said = [(0.0, "/scan", 1.0), (0.0, "/v", 9.0), (2.0, "/scan", NAN)]
    assert decided(f"_rate_ = 1\n{BACK}", said, 2) == (Verdict.SATISFIED, 2.0)


TEXTS = [
    WATCHDOG,
    BACK,
    f"{SCAN}w: always age(scan) <= 1 s\n",
    f"{SCAN}w: always (v > 2 implies eventually age(scan) <= 1 s within 2 s)\n",
    f"{SCAN}w: always (previously age(scan) > 1 s and age(scan) <= 1 s implies new scan or v > 2)\n",
    f"{SCAN}w: after_until age(scan) > 1 s, v > 2, eventually (scan > 2 and age(scan) <= 2 s)\n",
    f"{SCAN}w: always (once (new scan and scan > 2) within 2 s or age(scan) <= 1 s or v > 2)\n",
]


def rows(chance: random.Random) -> list[Row]:
    """What comes at times in ns, some of it NaN, often a bound after what came before."""
    time, found = 0, [Row(0, {"scan": 1.0, "v": 1.0})]
    for _ in range(12):
        time += chance.choice([0, 1, SECOND // 2, SECOND, SECOND + 1, SECOND + 2, 2 * SECOND, 2 * SECOND + 1])
        names = chance.choice([["scan"], ["scan"], ["v"], ["scan", "v"]])
        found.append(Row(time, {name: chance.choice([NAN, 1.0, 3.0]) for name in names}))
    return found


@pytest.mark.parametrize("text", TEXTS)
def test_emitted_python_counts_ages_as_the_session_does(text: str) -> None:
    compiled, _ = from_text(text)
    made, chance = python_module(compiled)["Monitors"], random.Random(text)
    read = {i.signal.name for i in compiled[0].specification.inputs() if not isinstance(i, New)}
    for _ in range(60):
        run, monitors = session(text), made(0)
        run.begin(0)
        known: dict[str, float] = {}
        for row in rows(chance):
            values = {name: value for name, value in row.values.items() if f"/{name}" in run.session.messages}
            run.samples(row.time, tuple(values), tuple(values.values()))
            known |= {name: value for name, value in values.items() if name in read}
            new = {"new_scan": "scan" in values}
            (verdict,) = (monitors.step(row.time, **known, **new) if values else monitors.advance(row.time)).values()
            assert verdict == run.tracks[0].verdict.value, (text, row.time)


@pytest.mark.parametrize("text", TEXTS)
def test_columns_count_ages_as_rows_do(text: str) -> None:
    chance, of_w = random.Random(text), DECLARATIONS + text.partition(SCAN)[2].replace("scan", "w")
    for _ in range(4):
        found = [
            Row(row.time, {name.replace("scan", "w"): v for name, v in row.values.items()}) for row in rows(chance)
        ]
        reference, fast = judged(Drawn(of_w, [found[:4], found[4:]]))
        assert state(fast.session) == state(reference)


def test_an_age_is_no_bound_that_is_over_before_the_next_tick() -> None:
    bound = "always (scan > 2 implies eventually v > 2 within 300 ms)"
    found = ltlc.check(f"_rate_ = 2\n{SCAN}aged: always age(scan) <= 300 ms\nbound: {bound}\n")
    assert [each.code for each in found.diagnostics] == ["LTL522"]
    assert "within 300 ms" in str(found)
