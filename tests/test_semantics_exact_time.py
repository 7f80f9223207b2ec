"""Monitors of properties with clocks against the exact oracle: permanent verdicts are right, and come at once."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from effort import share_of
from exact_time import judge
from timed import ARRIVAL, Draw, X, Y, clocks, monitor_of

from ltlc.semantics import properties as p
from ltlc.semantics.encodings import EPISODE, encode
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.verdicts import Verdict


def drawn(most_clocks: int) -> Iterator[tuple[Formula, Monitor]]:
    for seed in range(share_of(250)):
        property_ = Draw(seed).property(most_clocks=most_clocks)
        if clocks(property_):
            yield encode(property_, EPISODE), monitor_of(property_)


def test_a_permanent_verdict_is_right_whatever_follows_in_time() -> None:
    for formula, monitor in drawn(most_clocks=2):
        assert judge(formula, monitor).wrong == 0, formula


def test_with_one_clock_no_permanent_verdict_comes_late() -> None:
    for formula, monitor in drawn(most_clocks=1):
        assert judge(formula, monitor).missing == 0, formula


def test_a_clock_that_starts_with_a_message_does_not_run_out_before_the_message_is_over() -> None:
    """So messages without a break for 2 ns are impossible."""
    lasting = p.After(ARRIVAL, p.Within(2, p.Always(p.Now(ARRIVAL))))
    assert monitor_of(p.And(p.Eventually(p.Now(ARRIVAL)), lasting)).verdicts == (Verdict.VIOLATED,)


RESPONSE = p.Always(p.Implies(p.Now(X), p.Within(2, p.Eventually(p.Now(Y)))))


def test_the_oracle_notices_a_permanent_verdict_that_is_wrong_or_missing() -> None:
    formula = encode(RESPONSE, EPISODE)
    always, never = Verdict.PRESUMABLY_SATISFIED, Verdict.VIOLATED
    assert judge(formula, Monitor((), (always,), (0,), ())).missing > 0
    assert judge(formula, Monitor((), (always, never), (1, 1), ())).wrong > 0


@pytest.mark.parametrize("duration", [10**6, 5 * 10**9, 3600 * 10**9])
def test_a_monitor_does_not_depend_on_how_long_its_bound_is(duration: int) -> None:
    short = monitor_of(RESPONSE)
    long = monitor_of(p.Always(p.Implies(p.Now(X), p.Within(duration, p.Eventually(p.Now(Y))))))
    assert (short.verdicts, short.edges, short.decisions) == (long.verdicts, long.edges, long.decisions)
