"""Intervals, said by bounds and by the past, are what their definition says, on random words of instants."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from timed import Draw, X, Y, Z, compiled, holds, word_of

from ltlc.assurance.certify import certify
from ltlc.semantics import properties as p
from ltlc.semantics.certificate import Certificate, check
from ltlc.semantics.denotation import part_in_time, satisfies
from ltlc.semantics.encodings import EPISODE, ManyClocksError, encode
from ltlc.semantics.intervals import without_intervals
from ltlc.semantics.ltl import Not
from ltlc.semantics.properties import Property

IN_AN_INTERVAL: dict[str, Property] = {
    "now": p.Now(X),
    "now, of no instant": p.Now(Not(X)),
    "throughout": p.Throughout(X),
    "not": p.Not(p.Eventually(p.Now(X))),
    "and": p.And(p.Eventually(p.Now(X)), p.Never(p.Now(Y))),
    "or": p.Or(p.Always(p.Now(X)), p.Eventually(p.Now(Y))),
    "implies": p.Implies(p.Eventually(p.Now(X)), p.Eventually(p.Now(Y))),
    "a response": p.Always(p.Implies(p.Now(X), p.Eventually(p.Now(Y)))),
    "what never comes": p.Never(p.And(p.Now(X), p.Eventually(p.Now(Y)))),
    "after": p.After(X, p.Always(p.Now(Y))),
    "until": p.Until(X, p.Eventually(p.Now(Y))),
    "after_until": p.AfterUntil(X, Y, p.Eventually(p.Now(Z))),
    "an interval in it": p.Within(2, p.Eventually(p.Now(X)), 1),
    "a bound in it": p.Within(2, p.Always(p.Now(X))),
    "an interval in a scope in it": p.After(X, p.Within(2, p.Eventually(p.Now(Y)), 1)),
}
ANCHORS: dict[str, Callable[[Property], Property]] = {
    "the run": lambda inner: inner,
    "after": lambda inner: p.After(Y, inner),
    "until": lambda inner: p.Until(Z, inner),
    "after_until": lambda inner: p.AfterUntil(Y, Z, inner),
    "after, in an episode": lambda inner: p.AfterUntil(Y, Z, p.After(X, inner)),
    "not, in a bound": lambda inner: p.Not(p.Within(7, inner)),
}


@pytest.mark.parametrize("body", IN_AN_INTERVAL.values(), ids=IN_AN_INTERVAL)
@pytest.mark.parametrize("anchor", ANCHORS.values(), ids=ANCHORS)
def test_what_is_said_of_an_interval_is_said_without_one(
    anchor: Callable[[Property], Property], body: Property
) -> None:
    draw = Draw(len(str(body)))
    for _ in range(25):
        start = draw.chance.randint(1, 3)
        property_ = anchor(p.Within(start + draw.chance.randint(1, 3), body, start))
        run = draw.run()
        assert holds(without_intervals(property_), run) is holds(property_, run), (property_, run)


@pytest.mark.parametrize("body", [p.Eventually(p.Now(X)), p.Always(p.Now(X)), p.Never(p.Now(X))], ids=str)
@pytest.mark.parametrize("anchor", [ANCHORS[name] for name in ("the run", "after", "until", "after_until")])
def test_an_interval_is_certified_exactly(anchor: Callable[[Property], Property], body: Property) -> None:
    each = compiled(anchor(p.Within(5, body, 2)))
    certificate = certify(each.formula, each.specification.alphabet, each.monitor)
    assert isinstance(certificate, Certificate)
    assert check(certificate).exact


def test_an_interval_is_judged_on_its_instants_alone() -> None:
    draw = Draw(0)
    for _ in range(200):
        body, run = draw.property(), draw.run()
        word = word_of(body, run)
        assert satisfies(word, p.Within(4, body, 1)) is satisfies(part_in_time(word, 1, 4), body)


def test_an_interval_that_begins_anew_at_each_step_has_no_clock() -> None:
    interval = p.Within(3, p.Eventually(p.Now(Y)), 1)
    with pytest.raises(ManyClocksError) as error:
        encode(p.Always(p.Implies(p.Now(X), interval)), EPISODE)
    assert error.value.bound is interval
