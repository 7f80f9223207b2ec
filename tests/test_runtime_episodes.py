"""Counting episodes: the runtime against the denotation, on random runs."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import words

from ltlc.runtime.episodes import Episodes
from ltlc.runtime.properties import Scope
from ltlc.semantics.denotation import episodes, first_step, opened
from ltlc.semantics.ltl import Atom
from ltlc.semantics.properties import After, AfterUntil, Always, And, Eventually, Never, Now, Property, Until
from ltlc.semantics.words import Word

X, Y = Atom("x"), Atom("y")
RUNS = words(st.frozensets(st.sampled_from("xy")), max_size=12)
BODY = Now(Atom("z"))


def counted(scope: Scope, run: Word) -> Episodes:
    found = Episodes(scope)
    for step, letter in enumerate(run):
        found.step(step, step, ["x" in letter, "y" in letter])
    return found


def opens(x: bool, _: bool) -> bool:
    return x


def closes(_: bool, y: bool) -> bool:
    return y


@given(RUNS)
def test_episodes_are_those_of_the_denotation(run: Word) -> None:
    right = episodes(run, X, Y)
    found = counted(Scope("", opens, closes), run)
    assert found.count == len(right)
    assert (found.opened and found.opened.step) == (right[-1][0] if right else None)


@given(RUNS)
def test_under_always_every_step_that_opens_an_episode_on_some_rest_of_the_run_counts(run: Word) -> None:
    right = {start + k for start in range(len(run)) for k, _ in episodes(run[start:], X, Y)}
    assert counted(Scope("", opens, closes, overlapping=True), run).count == len(right)


@given(RUNS)
def test_an_episode_of_after_opens_once(run: Word) -> None:
    first = first_step(run, X)
    found = counted(Scope("", opens, limit=1), run)
    assert found.count == (first is not None)
    assert (found.opened and found.opened.step) == first


@given(RUNS.filter(bool), st.integers(0, 5), st.booleans())
def test_a_step_that_is_repeated_counts_as_often_as_it_is(run: Word, times: int, overlapping: bool) -> None:
    scope = Scope("", opens, closes, overlapping=overlapping)
    found = counted(scope, run)
    found.repeat(times)
    assert found.count == counted(scope, run + run[-1:] * times).count


RUN = tuple(map(frozenset, ("x", "xy", "", "x", "x", "y", "x")))


@pytest.mark.parametrize(
    ("property_", "count"),
    [
        (AfterUntil(X, Y, BODY), 3),
        (Always(AfterUntil(X, Y, BODY)), 4),
        (After(X, BODY), 1),
        (Never(After(X, BODY)), 5),
        (And(After(X, BODY), Eventually(After(Y, BODY))), 3),
        (AfterUntil(X, Y, AfterUntil(X, Y, BODY)), 3),
        (Until(X, After(X, BODY)), None),
        (Always(BODY), None),
    ],
)
def test_a_property_counts_the_episodes_of_its_outermost_scopes(property_: Property, count: int | None) -> None:
    assert opened(RUN, property_) == count
