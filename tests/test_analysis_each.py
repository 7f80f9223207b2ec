"""What `check` says of places that run out, beside what happens; and of counts, beside all ways in which they occur."""

from __future__ import annotations

from itertools import product

import pytest
from stepping import session

from ltlc.analysis.examine import examine
from ltlc.automata import Budget
from ltlc.base.source import Source
from ltlc.semantics.encodings import EPISODE

NAMES = """decl goal /status JoyFeedback.id
decl mode /status JoyFeedback.type
decl v /v Float64.data
heard: never v > 99 and mode > 99
"""


def codes(text: str) -> set[str]:
    return {found.code for found in examine(Source("p", text), [], EPISODE, Budget(30.0, 1024)).diagnostics}


@pytest.mark.parametrize(
    "property_",
    [
        "always (mode == 1 implies eventually mode == 4 within 5 s)",
        "never mode == 9",
        "never mode == 9 and g > 7",
        "eventually mode == 4",
        "after mode == 2, never mode == 9",
        "always age(mode) < 5 s",
        "never mode == 9 and v > 1",
        "always mode >= @{mode, -1}",
        "always mode != @{mode, opening} + 9",
        "_rate_ = 100\nnever mode == 9",
    ],
)
def test_ids_find_no_place_where_that_is_said_once_all_of_them_are_settled(property_: str) -> None:
    setting, _, body = property_.rpartition("\n")
    text = f"{NAMES}{setting}\neach g of goal limit 2: {body}\n"
    live = session(text)
    live.samples(0, ("v",), (0.0,))
    for number, (id_, mode) in enumerate(product(range(3), (1, 2, 4, 4))):
        live.samples(number * 10**7, ("goal", "mode"), (id_, mode))
    assert (live.session.sliced[0].left_out > 0) == ("LTL525" in codes(text))


@pytest.mark.parametrize(
    "body", ["eventually v > @{v, opening} within 5 s", "never v > @{v, opening} + 9", "never v > 9"]
)
def test_messages_find_no_place_where_that_is_said(body: str) -> None:
    text = f"{NAMES}each new v limit 9: {body}\n"
    live = session(text)
    for number in range(20):
        live.samples(number * 10**9, ("v",), (float(number % 10),))
    assert (live.session.sliced[0].left_out > 0) == ("LTL525" in codes(text))


@pytest.mark.parametrize("milliseconds", [1, 99, 100, 250, 300, 399, 400])
@pytest.mark.parametrize("event", ["p", "new p"])
def test_a_count_is_out_of_reach_if_no_ticks_have_it(milliseconds: int, event: str) -> None:
    times = [100 * tick for tick in range(8)]
    for number in range(1, 7):
        reached = any(
            sum(end - milliseconds <= time <= end for time in _occurrences(times, values, event)) >= number
            for values in product([False, True], repeat=8)
            for end in times
        )
        text = f"_rate_ = 10\ndecl p /p Bool.data\nnever once {event} {number} times within {milliseconds} ms\n"
        assert ("LTL526" in codes(text)) == (not reached)


def _occurrences(times: list[int], values: tuple[bool, ...], event: str) -> list[int]:
    before = (False, *values)
    return [t for t, was, holds in zip(times, before, values, strict=False) if holds and (event != "p" or not was)]
