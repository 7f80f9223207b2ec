"""By how much a run satisfies a property: what the signs say, how far they reach, and what each operator measures."""

from __future__ import annotations

import math
from collections.abc import Mapping

import pytest
from effort import share_of
from hypothesis import given
from hypothesis import strategies as st
from strategies import ABC, properties
from timed import Draw

from ltlc.semantics import instants
from ltlc.semantics.denotation import satisfies
from ltlc.semantics.ltl import Atom
from ltlc.semantics.ltl import Not as LtlNot
from ltlc.semantics.properties import (
    After,
    AfterUntil,
    Always,
    Eventually,
    Implies,
    Never,
    Now,
    Property,
    Throughout,
    Until,
    Within,
    predicates,
)
from ltlc.semantics.robustness import Measured, Run, held, robustness, with_past
from ltlc.semantics.timed_atoms import (
    Historically,
    News,
    Occurred,
    Once,
    PastAtom,
    Previously,
    Since,
    atoms_within,
    counts_of,
    news_that_counts,
)

P, Q, X, Y = map(Atom, "pqxy")
INFINITY = math.inf


def run(**margins: list[float]) -> Run:
    """A step each nanosecond, with these margins of atoms."""
    columns = zip(*margins.values(), strict=True)
    return tuple(Measured(time, dict(zip(margins, each, strict=True))) for time, each in enumerate(columns))


MEANINGS: list[tuple[Property, Run, float]] = [
    (Now(P), run(p=[2, -1]), 2),
    (Now(P), (), -INFINITY),
    (Now(LtlNot(P)), (), INFINITY),
    (Throughout(P), run(p=[2, 1, 3]), 1),
    (Always(Now(P)), run(p=[2, -1, 3]), -1),
    (Never(Now(P)), run(p=[-2, -1, -3]), 1),
    (Eventually(Now(P)), run(p=[-2, -1, -3]), -1),
    (Always(Implies(Now(P), Eventually(Now(Q)))), run(p=[3, -4, 2], q=[-1, 1, -1]), -1),
    # Between the event and the end of its scope counts what is nearer to change: 0.5 to when x comes, 1 to what p is.
    (Until(X, Throughout(P)), run(x=[-2, 3, 1], p=[1, -5, -5]), 1),
    (Until(X, Throughout(P)), run(x=[0.5, 3], p=[1, -5]), 1),
    (Until(X, Throughout(P)), run(x=[-2, -3], p=[1, 1]), -2),
    (After(X, Throughout(P)), run(x=[-2, 3, 1], p=[-9, 2, 4]), 2),
    (After(X, Throughout(P)), run(x=[-2, -1], p=[-9, -9]), 1),
    (AfterUntil(X, Y, Throughout(P)), run(x=[3, 3, 3, -3], y=[-2, -2, 2, -2], p=[4, 1, -7, -7]), 1),
    (Within(1, Eventually(Now(P))), run(p=[-1, -2, 5]), -1),
    (Within(2, Eventually(Now(P)), 1), run(p=[9, -2, 5, 7]), 5),
    (Within(5, Eventually(Now(P)), 4), run(p=[9, 9]), -INFINITY),
    (Within(5, Always(Now(P)), 4), run(p=[-9, -9]), INFINITY),
]


@pytest.mark.parametrize(("property_", "of", "expected"), MEANINGS)
def test_each_form_has_the_margin_that_decides_it(property_: Property, of: Run, expected: float) -> None:
    assert robustness(of, property_) == expected


@pytest.mark.parametrize(
    ("atom", "expected"),
    [
        (Previously("o", P), [-INFINITY, 1, -2, 3]),
        (Once("o", P), [1, 1, 3, 3]),
        (Once("o", P, 1), [1, 1, 3, 3]),
        (Historically("o", P), [1, -2, -2, -2]),
        (Historically("o", P, 1), [-INFINITY, -2, -2, -1]),
        (Since("o", P, Q), [5, -2, -2, -1]),
        (Since("o", P, Q, 1), [5, -2, -3, -1]),
        (Occurred("o", P, 1, None, begins=True), [1, 1, 2, 2]),
        (Occurred("o", P, 2, None, begins=True), [-INFINITY, -2, 1, 1]),
        (Occurred("o", P, 2, 1, begins=True), [-INFINITY, -2, -2, -3]),
        (Occurred("o", P, 2, 1, begins=True, presumed=True), [INFINITY, INFINITY, -2, -3]),
    ],
)
def test_the_past_has_the_margins_of_its_definition(atom: PastAtom, expected: list[float]) -> None:
    found = with_past(run(p=[1, -2, 3, -1], q=[5, -4, -3, -1]), [atom])
    assert [each.margins["o"] for each in found] == expected


MARGINS = st.sampled_from([-INFINITY, -2.0, -1.0, -0.5, 0.5, 1.0, 2.0, INFINITY])


def measured(rows: list[tuple[float, ...]]) -> Run:
    return tuple(Measured(time, dict(zip(ABC, row, strict=True))) for time, row in enumerate(rows))


def letters(of: Run) -> tuple[frozenset[str], ...]:
    return tuple(frozenset(name for name, margin in each.margins.items() if margin > 0) for each in of)


def says(found: float, holds: bool) -> bool:
    """Whether a robustness agrees with a verdict; 0 agrees with both."""
    return found == 0 or (found > 0) is holds


@given(properties(), st.lists(st.tuples(MARGINS, MARGINS, MARGINS), max_size=6))
def test_the_sign_is_the_verdict(property_: Property, rows: list[tuple[float, ...]]) -> None:
    of = measured(rows)
    found = robustness(of, property_)
    assert found != 0
    assert (found > 0) is satisfies(letters(of), property_)


@given(
    properties(),
    st.lists(st.tuples(MARGINS, MARGINS, MARGINS), max_size=5),
    st.lists(st.sampled_from([-0.4, 0.0, 0.4]), min_size=15, max_size=15),
)
def test_what_moves_all_margins_by_less_moves_no_verdict(
    property_: Property, rows: list[tuple[float, ...]], moves: list[float]
) -> None:
    moved = [tuple(m + moves[3 * k + n] for n, m in enumerate(row)) for k, row in enumerate(rows)]
    before, after = robustness(measured(rows), property_), robustness(measured(moved), property_)
    assert before == after or abs(before - after) <= 0.4 + 1e-12


@given(properties(), st.lists(st.tuples(*[st.sampled_from([-1.0, 0.0, 1.0])] * 3), max_size=5))
def test_at_a_margin_of_0_either_verdict_is_possible(property_: Property, rows: list[tuple[float, ...]]) -> None:
    of, strict = measured(rows), letters(measured(rows))
    equal = tuple(frozenset(name for name, margin in each.margins.items() if margin >= 0) for each in of)
    found = robustness(of, property_)
    assert says(found, satisfies(strict, property_))
    assert says(found, satisfies(equal, property_))


def measured_run(seed: int) -> tuple[Property, list[Measured], int, tuple[PastAtom, ...], instants.Observation]:
    """A property in time, and a run with margins of its letters."""
    draw = Draw(seed, may_count=True)
    property_, seen = draw.property(), draw.run(most=4)
    counted = [count.operand for part in predicates(property_) for count in counts_of(part)]
    atoms = dict.fromkeys(each for part in (*counted, *predicates(property_)) for each in atoms_within(part))
    news = {each.name for each in atoms if isinstance(each, News)}

    def margins(letter: frozenset[str]) -> Mapping[str, float]:
        sizes = {each.name: INFINITY if each.name in news else draw.chance.choice((0.5, 1.0, 2.0)) for each in atoms}
        return {name: size if name in letter else -size for name, size in sizes.items()}

    steps = [Measured(step.time, margins(step.letter)) for step in seen.steps]
    past = tuple(each for each in atoms if isinstance(each, PastAtom))
    return property_, steps, seen.until, past, seen


@pytest.mark.parametrize("seed", range(share_of(300)))
def test_in_time_the_sign_is_the_verdict_on_instants(seed: int) -> None:
    property_, steps, until, past, seen = measured_run(seed)
    news = [each for part in predicates(property_) for each in news_that_counts(part)]
    word = instants.with_past(instants.instants(seen.steps, until, news), past, seen.session)
    run = with_past(held(steps, until, {each.name for each in news}), past, seen.session)
    found = robustness(run, property_)
    assert found != 0
    assert (found > 0) is satisfies(word, property_)
