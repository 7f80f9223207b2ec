"""Exact in time: witnesses hold in whatever order clocks expire, and what is certified exactly is never late."""

from __future__ import annotations

import pytest
from effort import share_of
from exact_time import TooManyError, judge
from timed import ARRIVAL, Draw, X, Y, clocks, monitor_of, ordinary_atoms

from ltlc.assurance.certify import certify
from ltlc.semantics import ltl
from ltlc.semantics import properties as p
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.certificate import Answer, Certificate, check
from ltlc.semantics.encodings import EPISODE, encode
from ltlc.semantics.plays import LONGEST_STEM, Plays
from ltlc.semantics.properties import Property
from ltlc.semantics.reset_machine import ResetMachine
from ltlc.semantics.timed_atoms import Age, Once, Previously
from ltlc.semantics.words import Lasso


def certified(property_: Property) -> Certificate:
    formula = encode(property_, EPISODE)
    found = certify(formula, Alphabet(ordinary_atoms(formula)), monitor_of(property_))
    assert isinstance(found, Certificate), found
    return found


def test_a_monitor_that_is_certified_exactly_is_never_late() -> None:
    """And nearly all that are never late are certified so."""
    on_time = exact = 0
    for seed in range(share_of(250)):
        property_ = Draw(seed).property(most_clocks=3)
        if clocks(property_) < 2:
            continue
        found = certified(property_)
        try:
            is_late = judge(found.formula, found.monitor, most=300).missing > 0
        except TooManyError:
            continue
        answer = check(found)
        assert answer.certified
        assert not (answer.exact and is_late), property_
        on_time += not is_late
        exact += answer.exact
    assert exact > 0.9 * on_time > 0


RECENT = Once("once y within 2 ns", Y, 2)
ONLY_ONCE = p.Never(p.Now(ltl.And(Y, Previously("previously once y", Once("once y", Y)))))
LATE: dict[str, Property] = {
    "one clock decides another": p.Within(1, p.Always(p.Now(Once("once y within 3 ns", Y, 3)))),
    "what changes as a clock expires": p.And(
        ONLY_ONCE, p.Always(p.Now(ltl.Or(ltl.And(X, ltl.Not(RECENT)), ltl.And(ltl.Not(X), RECENT))))
    ),
}


@pytest.mark.parametrize("property_", LATE.values(), ids=LATE)
def test_a_monitor_that_is_late_is_certified_but_not_exactly(property_: Property) -> None:
    found = certified(property_)
    assert judge(found.formula, found.monitor).missing > 0
    assert check(found) == Answer(certified=True, exact=False)


TWO_CLOCKS = p.And(
    p.Within(5, p.Eventually(p.Now(Y))), p.Always(p.Implies(p.Now(X), p.Within(2, p.Eventually(p.Now(Y)))))
)


def test_while_two_clocks_run_either_may_expire_first_or_both_at_once() -> None:
    found, time = plays(TWO_CLOCKS)
    held = frozenset({"x"})
    one, other = (held | {atom} for tracker in time.trackers for atom in tracker.atoms)
    both = one | other
    words = [Lasso(stem, (both,)) for stem in ((held, one, both), (held, other, both), (held, both))]
    assert found.suffice(words, time.initial)
    for word in words:
        assert not found.suffice([each for each in words if each != word], time.initial)


def plays(property_: Property) -> tuple[Plays, ResetMachine]:
    time = ResetMachine(encode(property_, EPISODE))
    return Plays(time, lambda _: None), time


YOUNG = Age("age(n) <= 3 ns", ARRIVAL, 3)
NEWS, NEVER = frozenset({ARRIVAL.name, YOUNG.name}), frozenset({YOUNG.name})


def test_messages_one_after_the_other_keep_an_age_young_for_ever() -> None:
    found, time = plays(p.Always(p.Now(YOUNG)))
    assert found.suffice([Lasso((NEWS, NEVER), (NEWS, NEVER))], time.initial)


def test_no_play_is_longer_than_the_checker_can_go() -> None:
    found, time = plays(p.Always(p.Now(YOUNG)))
    assert found.suffice([Lasso((NEWS, NEVER) * (LONGEST_STEM // 2), (NEWS, NEVER))], time.initial)
    assert not found.suffice([Lasso((NEWS, NEVER) * 10_000, (NEWS, NEVER))], time.initial)


@pytest.mark.parametrize("loop", [(NEWS,), (NEVER,), (NEVER, NEWS)])
def test_what_takes_no_time_or_keeps_a_clock_from_its_bound_does_not_go_on_for_ever(
    loop: tuple[frozenset[str]],
) -> None:
    found, time = plays(p.Always(p.Now(YOUNG)))
    assert not found.suffice([Lasso((NEWS, NEVER), loop)], time.initial)


def test_a_run_may_begin_in_a_session_of_any_age_but_not_of_two() -> None:
    old = Age("age(n) <= 5 ns", ARRIVAL, 5)
    found, time = plays(p.Now(ltl.And(YOUNG, old)))
    ages = [set(), {old.name}, {YOUNG.name, old.name}, {YOUNG.name}]
    assert [bool(found.at_once(time.initial, frozenset(each))) for each in ages] == [True, True, True, False]
