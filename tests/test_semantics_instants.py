"""What each form of the language with time means, instant by instant, in tables written by hand.

Times are nanoseconds; a run is written as its steps, `3 x` for a step at 3 ns with the atom x, and `| 9` for how far
has been looked. A table has a digit for each instant: 1 where the form holds.
"""

from __future__ import annotations

import pytest

from ltlc.semantics import properties as p
from ltlc.semantics.denotation import satisfies
from ltlc.semantics.durations import duration_text
from ltlc.semantics.instants import Step, instants, with_past
from ltlc.semantics.ltl import Atom, Not
from ltlc.semantics.properties import Property
from ltlc.semantics.timed_atoms import Age, Historically, News, Once, PastAtom, Previously, Since

X, Y, Z = Atom("x"), Atom("y"), Atom("z")
NEW = News("n")
S = 10**9


def read(run: str) -> tuple[list[Step], int]:
    """A run as it is written above."""
    steps, _, until = run.partition("|")
    found = [Step(int(time), frozenset(atoms)) for time, *atoms in (step.split() for step in steps.split(","))]
    return found, int(until)


def test_a_letter_is_held_up_to_and_including_the_time_of_the_next_step_and_news_is_not() -> None:
    steps, until = read("0 x n, 2 y | 3")
    found = [(each.time, "".join(sorted(each))) for each in instants(steps, until, [NEW])]
    assert found == [(0, "nx"), (1, "x"), (2, "x"), (2, "y"), (3, "y")]


def test_steps_at_one_time_follow_one_another_at_once() -> None:
    steps, until = read("0 x, 0 y | 1")
    assert [(each.time, *each) for each in instants(steps, until)] == [(0, "x"), (0, "y"), (1, "y")]


def test_held_instants_can_be_left_out() -> None:
    steps, until = read("0 x, 4 y | 9")
    assert [each.time for each in instants(steps, until, among={0, 3, 4, 8})] == [0, 3, 4, 4, 8]


ONE = "0, 2 x, 4, 9 x | 10"
"""The instants are at 0 1 2 | 2 3 4 | 4 5 6 7 8 9 | 9 10; x holds in the second and the fourth part."""

PAST = {
    "previously": (Previously("", X), ONE, "000 011 100000 01"),
    "previously, not yet": (Previously("", Not(X)), ONE, "011 100 011111 10"),
    "once": (Once("", X), ONE, "000 111 111111 11"),
    "once within 2": (Once("", X, 2), ONE, "000 111 111000 11"),
    "once within 1": (Once("", X, 1), ONE, "000 111 110000 11"),
    "historically": (Historically("", Not(X)), ONE, "111 000 000000 00"),
    "historically for 2": (Historically("", Not(X), 2), ONE, "001 000 001111 00"),
    "historically for 1": (Historically("", X, 1), ONE, "000 011 000000 01"),
    "since": (Since("", Not(X), Not(X)), ONE, "111 000 111111 00"),
    "since an event": (Since("", X, Y), "0, 1 x, 2 x y, 4 x, 6 y | 8", "00 00 111 111 111"),
    "since within 2": (Since("", X, Y, 2), "0, 1 x, 2 x y, 4 x | 8", "00 00 111 1110 0"),
    "age, session at -1": (Age("", NEW, 2), "0, 3 n | 7", "1100 1110 0"),
}


@pytest.mark.parametrize(("atom", "run", "table"), PAST.values(), ids=PAST)
def test_an_atom_of_the_past_holds_where_its_table_says(atom: PastAtom, run: str, table: str) -> None:
    steps, until = read(run)
    word = instants(steps, until, [NEW])
    held = "".join(str(int(atom.name in instant)) for instant in with_past(word, [atom], session=-1))
    assert held == table.replace(" ", "")


def test_an_atom_of_the_past_may_be_over_another() -> None:
    once = Once("once", X, 2)
    steps, until = read("0 x, 1 | 6")
    word = with_past(instants(steps, until), [once, Historically("long", Not(once), 2)])
    assert [each.time for each in word if "long" in each] == [6]
    assert [each.time for each in word if "once" in each] == [0, 1, 1, 2, 3]


def response(within: int) -> Property:
    return p.Always(p.Implies(p.Now(X), p.Within(within, p.Eventually(p.Now(Y)))))


def prevention(within: int) -> Property:
    return p.Always(p.Implies(p.Now(X), p.Within(within, p.Never(p.Now(Y)))))


PROPERTIES = {
    "at the bound is in time": (p.Within(2, p.Eventually(p.Now(X))), "0, 2 x | 5", True),
    "a nanosecond later is not": (p.Within(2, p.Eventually(p.Now(X))), "0, 3 x | 5", False),
    "nor is what is still open": (p.Within(2, p.Eventually(p.Now(X))), "0 | 1", False),
    "a bound after an event": (p.After(X, p.Within(2, p.Eventually(p.Now(Y)))), "0, 5 x, 7 y | 9", True),
    "a bound after an event, missed": (p.After(X, p.Within(2, p.Eventually(p.Now(Y)))), "0, 5 x, 8 y | 9", False),
    "always for": (p.Within(2, p.Always(p.Now(X))), "0 x, 2 | 5", False),
    "always for, held until it is over": (p.Within(2, p.Always(p.Now(X))), "0 x, 3 | 5", True),
    "initially": (p.Now(X), "0 x, 1 | 5", True),
    "initially, not later": (p.Now(X), "0, 0 x | 5", False),
    "each obligation has its own deadline": (response(2), "0 x, 2 y, 5 x, 5 y | 6", True),
    "a held trigger goes on asking": (response(2), "0 x, 1 y, 3 | 3", True),
    "the earliest obligation counts": (response(2), "0 x, 1 , 2 x, 3 y | 3", False),
    "the last trigger counts": (prevention(2), "0 x, 2 x, 4 y | 4", False),
    "a held trigger forbids after it ends": (prevention(2), "0 x, 2, 5 y | 5", True),
    "a held trigger forbids from its end": (prevention(2), "0 x, 2, 4 y | 4", False),
    "recurrence": (p.Always(p.Within(2, p.Eventually(p.Now(X)))), "0, 2 x, 3, 5 x | 5", True),
    "recurrence, a gap": (p.Always(p.Within(2, p.Eventually(p.Now(X)))), "0, 2 x, 3, 6 x | 6", False),
    "a scope takes an obligation with it": (p.Until(Y, p.Within(9, p.Eventually(p.Now(X)))), "0, 1 y, 2 x | 3", False),
    "an episode each": (p.AfterUntil(X, Y, p.Within(1, p.Never(p.Now(Y)))), "0 x, 2 y, 9 x, 11 y | 11", True),
    "within within": (p.Within(5, p.Within(1, p.Eventually(p.Now(X)))), "0, 2 x | 5", False),
    "an interval begins A later": (p.Within(5, p.Eventually(p.Now(X)), 2), "0, 2 x, 3 | 6", True),
    "not a nanosecond before": (p.Within(5, p.Eventually(p.Now(X)), 2), "0 x, 1, 6 x | 6", False),
    "what is held counts from A on": (p.Within(5, p.Eventually(p.Now(X)), 2), "0 x, 3 | 6", True),
    "and ends B later": (p.Within(5, p.Eventually(p.Now(X)), 2), "0, 5 x, 6 | 6", True),
    "not a nanosecond after": (p.Within(5, p.Eventually(p.Now(X)), 2), "0, 6 x | 6", False),
    "before A and after B nothing has to hold": (p.Within(5, p.Always(p.Now(X)), 2), "0, 1 x, 6 | 6", True),
    "what is held when A is over has to": (p.Within(5, p.Always(p.Now(X)), 2), "0, 2 x, 6 | 6", False),
    "and what comes at B": (p.Within(5, p.Always(p.Now(X)), 2), "0, 1 x, 5 | 6", False),
    "a run that ends before A": (p.Within(5, p.Eventually(p.Now(X)), 2), "0 x | 1", False),
    "of which nothing is asked": (p.Within(5, p.Always(p.Now(X)), 2), "0 | 1", True),
    "a scope that ends before A": (p.Until(Y, p.Within(5, p.Never(p.Now(X)), 2)), "0 x, 1 y | 1", True),
    "an interval after an event": (p.After(X, p.Within(3, p.Eventually(p.Now(Y)), 1)), "0, 5 x y, 6, 8 y | 9", True),
    "one of each episode": (p.AfterUntil(X, Y, p.Within(3, p.Never(p.Now(Z)), 1)), "0 x, 1 y, 5 x, 6 z | 9", False),
    "initially, in an interval": (p.Within(5, p.Now(X), 2), "0, 2 x, 3 | 6", False),
    "the empty part of a bound": (p.Within(1, p.Always(p.Now(X))), "0 x | 0", True),
}  # fmt: skip


@pytest.mark.parametrize(("property_", "run", "expected"), PROPERTIES.values(), ids=PROPERTIES)
def test_a_bound_means_what_is_said_of_it(property_: Property, run: str, expected: bool) -> None:
    assert satisfies(instants(*read(run)), property_) is expected


def test_a_bound_is_no_bound_on_letters_without_times() -> None:
    with pytest.raises(TypeError, match="instants"):
        satisfies((frozenset(),), p.Within(1, p.Now(X)))


@pytest.mark.parametrize(("start", "end"), [(0, 0), (2, 2), (-1, 2)])
def test_an_interval_ends_after_it_begins(start: int, end: int) -> None:
    with pytest.raises(ValueError, match=f"from {start} to {end} ns"):
        p.Within(end, p.Now(X), start)


@pytest.mark.parametrize(
    ("duration", "text"), [(0, "0 s"), (1, "1 ns"), (1500 * 10**6, "1.5 s"), (120 * S, "2 min"), (3600 * S, "1 h")]
)
def test_a_duration_is_written_with_decimals_rather_than_more_than_three_digits(duration: int, text: str) -> None:
    assert duration_text(duration) == text
