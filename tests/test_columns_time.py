"""Properties with clocks by columns, many steps at a time, beside the session that judges them row by row."""

from __future__ import annotations

import math
from collections.abc import Sequence
from random import Random

import pytest
from columns_support import DECLARATIONS, Drawn, blocks, judged, sizes, state
from effort import share_of
from stepping import from_text

from ltlc.backends.python.load import load_plan
from ltlc.inputs.recordings.rows import Row
from ltlc.monitoring.columns import bits
from ltlc.monitoring.columns.prepared import prepare_all
from ltlc.monitoring.columns.session import ByBlocks
from ltlc.runtime.session import Session
from ltlc.runtime.tracking import Track

COUNTS = (
    "never once {p} 3 times within {D}",
    "eventually once {p} 4 times",
    "always ({p} implies once {q} 2 times)",
    "always ({p} implies once new v 3 times within {D})",
    "always ({p} implies eventually once new w 4 times within {D} within {E})",
    "always eventually once (new w and {q}) 5 times within {D}",
    "always (age(v) <= {D} or once {p} 2 times within {E})",
    "after_until {p}, {r}, always (once new w 2 times within {D} or {q})",
    "always (rate(v) >= 2 Hz over 1 s or {p})",
    "never (once {p} 2 times within {D} and once new w 20 times within {E} and {r})",
)
FORMS = (
    "always ({p} implies eventually {q} within {D})",
    "always ({p} implies never {q} within {D})",
    "always ({p} implies once {q} within {D})",
    "always ({p} implies historically {q} for {D})",
    "never historically {p} for {D}",
    "eventually historically {p} for {D}",
    "always eventually {p} within {D}",
    "after_until {p}, {q}, eventually {r} within {D}",
    "after {p}, always ({q} implies eventually {r} within {D})",
    "after {p}, after_until {q}, {r}, never {p} within {D}",
    "until {p}, always ({q} implies eventually {r} within {D})",
    "after_until {p}, {q}, (never {r} within {D}) and (eventually {p} within {E})",
    "after_until historically {p} for {D}, {q}, eventually {r} within {E}",
    "after once {p} within {D}, always ({q} implies eventually {r} within {E})",
    "always age(v) <= {D}",
    "always ({p} implies age(w) <= {D})",
    "always ({p} implies (age(w) <= {D} or {q}))",
    "always (new v implies eventually new w within {D})",
    "always (new v and {p} implies eventually {q} within {D})",
    "after new w, always (age(v) <= {D} or {p})",
    "(always ({p} implies eventually {q} within {D})) and (never historically {r} for {E})",
    "always (previously {p} implies {q})",
    "always ({p} implies new v)",
    *COUNTS,
)
NEWS = (
    "always (new v and once (new v and {p}) within {D} implies (new v implies {q}) since (new v and {p}))",
    "always (new v and {p} implies not once (new w and {q}) within {D})",
    "always (new v implies once (new v and {q}) within {D})",
    "always (new v and {p} and once new w implies (new w implies once (new v and {r}) within {D}) since new w)",
    "always (new v and {p} implies eventually (new w and {q}) within {D})",
    "always (new v implies (once (new w and {q}) within {D} or once (new w and {p}) within {E}))",
    "never (once (new v and {p}) within {D} and not once (new w and once (new v and {q}) within {E}) within {D})",
    "always (not once (new v and {p}) within {D} or age(w) <= {E} or {q})",
    "always (historically not new v for {D} implies {q})",
    "always eventually (new v and once (new w and {p}) within {D})",
    "always eventually not (new w or once (new v and {p}) within {D})",
    "always (new v implies (once new w 3 times within {D} or {q}))",
    "always (new v and {p} implies eventually (new w and {q} and once (new v and {q}) within {E}) within {D})",
    "after_until {p} and new v, {r} and new v, always (new w implies once (new v and {q}) within {D})",
    "never (previously once (new v and {p}) within {D} and new w and {r})",
    "never (new v and {p} and previously {r})",
    "always (new v implies previously {q})",
)
"""Properties whose letter changes at every message; in most of them clocks come due that do not decide."""
SECOND = 10**9
USUAL, VALUES = 1.0, (0.0, 0.5, 1.0, 1.5, 3.0)
SHORT, LONG = (1, 5, 10), (20, 50, 200)
"""Of bounds, in the usual time from one row to the next."""


def drawn(seed: int, forms: Sequence[str] = FORMS) -> Drawn:
    """A property with bounds, and some hundred rows, the times between which are often the bounds.

    Most values are the usual one, so that not all is decided in the beginning.
    """
    chance = Random(seed)
    bounds = [chance.choice(some) * SECOND // 10 for some in (SHORT, LONG, LONG)]
    p, r = (f"{chance.choice('vw')} {chance.choice(('< 0.2', '> 2', '> 1', '< 1'))}" for _ in range(2))
    q = f"{chance.choice('vw')} {chance.choice(('< 2', '> 0.2', '> 1', '< 1'))}"
    d, e = (f"{bound} ns" for bound in chance.sample(bounds, 2))
    text = chance.choice(forms).format(p=p, q=q, r=r, D=d, E=e)
    gaps = [SECOND // 10] * chance.choice((4, 40, 400))
    gaps += [0, 1, bounds[0], bounds[0] + 1, *[bounds[1], bounds[1] + 1] * chance.choice((0, 0, 1))]
    busy, often = chance.choice((0.01, 0.1, 0.5)), {name: chance.choice((0.1, 0.5, 0.95)) for name in "vw"}
    rows, time = [], 0
    for _ in range(chance.choice((40, 300, 700))):
        time += chance.choice(gaps)
        names = [name for name in "vw" if chance.random() < often[name]]
        unusual = (*VALUES, *[math.nan] * (chance.random() < 0.05))
        rows.append(Row(time, {name: chance.choice(unusual) if chance.random() < busy else USUAL for name in names}))
    first, second = sorted(chance.sample(range(len(rows) + 1), 2))
    return Drawn(f"{DECLARATIONS}p: {text}\n", [rows[:first], rows[first:second], rows[second:]])


@pytest.mark.parametrize("seed", range(share_of(40)))
def test_properties_with_clocks_are_judged_by_columns_as_row_by_row(seed: int) -> None:
    of = drawn(seed)
    with sizes(Random(seed)):
        reference, fast = judged(of)
    assert state(fast.session) == state(reference), of.text


@pytest.mark.parametrize("seed", range(share_of(40)))
def test_what_is_counted_by_columns_is_what_is_counted_row_by_row(seed: int) -> None:
    of = drawn(seed, COUNTS)
    with sizes(Random(seed)):
        reference, fast = judged(of)
    assert state(fast.session) == state(reference), of.text
    assert set(fast.ways[0].because) <= {"messages that make no step, from which ages count"}


@pytest.mark.parametrize("seed", range(share_of(60)))
def test_what_news_changes_for_a_nanosecond_is_judged_by_columns_as_row_by_row(seed: int) -> None:
    of = drawn(seed, NEWS)
    with sizes(Random(seed)):
        reference, fast = judged(of)
    assert state(fast.session) == state(reference), of.text


@pytest.mark.parametrize(
    "text", ["never once v > 2 3 times within 5 s", "always (once new v 8 times within 1 s or w > 2)"]
)
def test_what_is_counted_under_a_rate_is_counted_at_ticks(text: str) -> None:
    some = [row(i, **{"v" if i % 7 else "w": 3.0 * (i % 20 < 3)}) for i in range(300)]
    alike(f"{text}\n_rate_ = 10", some)


def test_a_scope_that_a_count_opens_is_judged_by_rows() -> None:
    some = [row(i, v=3.0 * (i % 20 < 3), w=3.0 * (i % 50 > 40)) for i in range(300)]
    reference, fast = judged(Drawn(f"{DECLARATIONS}p: after once v > 2 3 times, never w > 2\n", [some]))
    assert state(fast.session) == state(reference)
    assert set(fast.ways[0].because) == {"it counts, and is stepped"}


def test_ages_count_from_messages_between_ticks_beside_a_property_with_the_same_news() -> None:
    # At 0.25 s a message comes between ticks; with the news of ticks alone, the age would count from 0.5 s.
    some = [Row(0, {"v": 1.0}), Row(SECOND // 4, {"v": 1.0}), *(row(i, w=1.0) for i in range(10, 40, 10))]
    text = "always (new v implies eventually new v within 9 s)\nq: always age(v) <= 1 s\n_rate_ = 2"
    reference, fast = judged(Drawn(f"{DECLARATIONS}p: {text}\n", [some]))
    assert state(fast.session) == state(reference)
    times = {track.property.label: track.decided_at and track.decided_at.time for track in fast.session.tracks}
    assert times["q"] == SECOND // 4 + SECOND + 1


def alike(text: str, rows: list[Row]) -> None:
    reference, fast = judged(Drawn(f"{DECLARATIONS}p: {text}\n", [rows]))
    assert not fast.ways[0].because
    assert state(fast.session) == state(reference)


def row(number: int, **values: float) -> Row:
    """A row each 0.1 s."""
    return Row(number * SECOND // 10, values)


def test_a_clock_that_comes_due_after_many_steps_finds_the_values_of_the_last_one() -> None:
    both = [row(i, v=1.0, w=3.0 if i > 16 else 0.0) for i in range(100)]
    alike("always (w > 2 or age(v) <= 2 s)", both + [row(i, w=3.0) for i in range(100, 200)])


def test_an_age_counts_from_the_last_of_many_messages_in_a_row() -> None:
    some = [row(i, **{"v" if i % 25 < 10 else "w": 1.0}) for i in range(2400)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(bits, "FEW", 1)
        alike("always (age(v) <= 2 s or w > 2)", some)


def test_a_clock_with_several_bounds_is_due_at_the_first_of_them() -> None:
    flat = [row(i, v=3.0 if i == 20 else 1.0, w=3.0 if i == 45 else 1.0) for i in range(100)]
    alike("after_until v > 2, v < 0.2, (never w > 2 within 1 s) and (eventually w > 2 within 5 s)", flat)


def steps_taken(text: str, rows: list[Row]) -> int:
    """How many steps the monitor of a property itself takes, by columns."""
    compiled, specification = from_text(f"{DECLARATIONS}p: {text}\n")
    session = Session(load_plan(compiled, specification, {"v", "w"}))
    taken, step = [], Track.step
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Track, "step", lambda *given: taken.append(step(*given)))
        for block in blocks([rows], ("v", "w")):
            ByBlocks(session, prepare_all(compiled, specification.source)).take(block)
    assert session.tracks[0].steps == len(rows)
    assert session.tracks[0].decided_at is None
    return len(taken)


@pytest.mark.parametrize(
    "text",
    [
        "always (new v and v > 2 implies not once (new w and w > 2) within 1 s)",
        "always (new v implies once (new v and v < 2) within 5 s)",
        "always (new w and w > 2 implies not previously w > 2)",
        "never (v > 2 and not once w > 2 within 1500 ms)",
    ],
)
def test_a_clock_that_comes_due_again_and_again_stops_no_leap(text: str) -> None:
    some = [row(i, v=3.0 * (i % 40 == 30), w=3.0 * (i % 40 in (10, 17))) for i in range(8000)]
    assert steps_taken(text, some) < 100


def test_the_reason_says_when_a_clock_came_due_that_a_leap_passed() -> None:
    some = [row(i, v=3.0 * (i == 700), w=3.0 * (i == 100)) for i in range(800)]
    alike("never (v > 2 and not once w > 2 within 1500 ms)", some)


def test_two_clocks_that_come_due_between_two_messages_both_do() -> None:
    text = "always (new v and v > 1 implies once (new w and w > 2) within 1 s or once (new w and w < 1) within 1500 ms)"
    before = [row(i, v=0.5, w=3.0 * (i % 2) if i < 49 else 1.5) for i in range(50)]
    alike(text, before + [row(i, v=2.0 * (i == 160), w=1.5) for i in range(100, 200)])


def test_a_clock_that_is_due_at_the_very_time_of_a_message_passes_after_it() -> None:
    # The one of 3 s is due at 3.5 s, when the message says so, and the news is over, in the nanosecond after it.
    some = [row(i, v=1.0, w=3.0 * (i % 50 == 5)) for i in range(2000)]
    alike(
        "always (new v implies not (once (new w and w > 2) within 3 s and previously not once w > 2 within 3 s))", some
    )


def test_scopes_that_the_past_opens_are_stepped() -> None:
    alike(
        "after_until historically v > 2 for 1 s, v < 1, eventually w > 2 within 3 s",
        [row(i, v=3.0 * (i % 50 > 20), w=3.0 * (i % 50 > 45)) for i in range(300)],
    )


def beats(chance: Random, gaps: Sequence[int], count: int) -> list[Row]:
    """Rows so far apart, with `w` in each and `v` in some, that repeat what was there or change a little."""
    time, found, w = 0, [], 1.0
    for _ in range(count):
        time, w = time + chance.choice(gaps), chance.choice([w, w, 0.0, 1.0, 2.0])
        found.append(Row(time, {"w": w} | ({"v": w} if chance.random() < 0.3 else {})))
    return found


@pytest.mark.parametrize(
    "text",
    [
        "always eventually (new v and w > 1.5)",
        "always (after_until w < 1.5, w > 1.5, eventually (new v or new w))",
        "always eventually (previously new v and w > 1.5)",
        "always eventually (once new v within 250 ms and w > -1)",
        "always eventually (age(v) > 200 ms and w > 1.5 and not age(v) > 400 ms)",
    ],
)
@pytest.mark.parametrize("gaps", [[10**8], [0, 1, 2, 15, 10**8], [10**8, 10**8, 10**8, 5 * 10**8]], ids=str)
def test_what_follows_messages_by_a_nanosecond_is_where_it_is_row_by_row(text: str, gaps: list[int]) -> None:
    for seed in range(share_of(8)):
        found = beats(Random(seed), gaps, 300 + 17 * seed)
        reference, fast = judged(Drawn(f"{DECLARATIONS}p: {text}\n", [found[:100], found[100:]]))
        assert [way.because for way in fast.ways] == [{}]
        assert state(fast.session) == state(reference)
