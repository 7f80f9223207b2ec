"""A share of what tests could try, by default; all of it in a campaign."""

from __future__ import annotations

import pytest
from effort import ASKED, fewer_runs, limit_examples, share_of
from hypothesis import given, settings
from hypothesis import strategies as st

from ltlc.assurance import walks


@pytest.mark.parametrize(("share", "number", "drawn"), [(0.4, 80, 32), (0.4, 1, 1), (0.01, 80, 1), (3, 80, 240)])
def test_a_share_is_of_what_is_named_and_at_least_one_case(
    monkeypatch: pytest.MonkeyPatch, share: float, number: int, drawn: int
) -> None:
    monkeypatch.setattr(ASKED, "share", share)
    assert share_of(number) == drawn


def test_hypothesis_draws_its_share(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ASKED, "share", 0.2)
    drawn = []

    @settings(max_examples=50, database=None)
    @given(st.integers())
    def draw(number: int) -> None:
        drawn.append(number)

    limit_examples(draw)
    draw()
    assert 0 < len(drawn) <= 10


def test_the_gate_has_all_of_its_runs_again_afterwards(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ASKED, "share", 0.5)
    before = walks.MOST_WALKS
    with fewer_runs():
        assert before == 2 * walks.MOST_WALKS
    assert before == walks.MOST_WALKS
