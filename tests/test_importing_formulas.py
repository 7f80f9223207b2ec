"""Formulas of other tools: what they mean, position by position, how they are said, and how the two are compared."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from ltlc.base.limits import Budget
from ltlc.base.source import Source
from ltlc.frontend.language import read, types_for
from ltlc.importing import formulas as f
from ltlc.importing.conditions import NotComparedError
from ltlc.importing.conversion import convert
from ltlc.importing.names import Kind, Signals
from ltlc.importing.readings import over_signals, parting
from ltlc.importing.requirement import Requirement
from ltlc.importing.showing import compare, of_property
from ltlc.importing.writing import Reading, UnsayableError, Writer
from ltlc.semantics.alphabet import Alphabet

STEP = 10**9
POINTS = Reading(STEP)
P, Q, R = (f.Atom(name) for name in "abc")
DECLARED = "_rate_ = 1\n" + "".join(f"decl {name} /{name} std_msgs/Bool.data\n" for name in "abc")

Word = Sequence[frozenset[str]]


def holds(formula: f.Formula, word: Word, at: int) -> bool:
    """Whether `formula` holds at a position of a run that stays as it is after `word`: its definition, as it stands.

    The last positions of `word` are to be alike, more of them than any bound reaches.
    """
    at = min(at, len(word) - 1)
    match formula:
        case f.Atom(text):
            return text in word[at]
        case f.Truth():
            return True
        case f.Not(operand):
            return not holds(operand, word, at)
        case f.And(left, right):
            return holds(left, word, at) and holds(right, word, at)
        case f.Or(left, right):
            return holds(left, word, at) or holds(right, word, at)
        case f.Next(operand, steps):
            return holds(operand, word, at + steps)
        case f.Previous(operand, steps):
            return at >= steps and holds(operand, word, at - steps)
        case f.Until(left, right, start, stop):
            last = len(word) + start if stop is None else at + stop
            return any(
                holds(right, word, k) and all(holds(left, word, j) for j in range(at, k))
                for k in range(at + start, last + 1)
            )
        case f.Since(left, right, start, stop):
            first = 0 if stop is None else max(0, at - stop)
            return any(
                holds(right, word, k) and all(holds(left, word, j) for j in range(k + 1, at + 1))
                for k in range(first, at - start + 1)
            )


STATES = st.sampled_from([P, Q, R, f.Not(P), f.And(P, Q), f.Or(f.Not(Q), R)])
BOUNDS = st.sampled_from([(0, None), (0, 1), (0, 3), (1, 1), (1, 3), (2, 4)])
BOUNDED = st.sampled_from([(0, 0), (0, 1), (0, 2), (1, 2), (2, 2)])


def past(inner: st.SearchStrategy[f.Formula]) -> st.SearchStrategy[f.Formula]:
    return st.one_of(
        st.builds(lambda p, q, b: f.Since(p, q, *b), STATES, inner, BOUNDS),
        st.builds(lambda q, b: f.Since(f.TRUE, q, *b), inner, BOUNDS),
        st.builds(f.Previous, inner, st.integers(1, 2)),
        st.builds(f.negated, inner),
        st.builds(f.conjoined, inner, STATES),
        st.builds(f.disjoined, STATES, inner),
    )


def future(
    inner: st.SearchStrategy[f.Formula], bounds: st.SearchStrategy[tuple[int, int | None]]
) -> st.SearchStrategy[f.Formula]:
    return st.one_of(
        st.builds(lambda p, q, b: f.Until(p, q, *b), STATES, inner, bounds),
        st.builds(lambda q, b: f.eventually(q, *b), inner, bounds),
        st.builds(lambda q, b: f.always(q, *b), inner, bounds),
        st.builds(f.Next, inner),
        st.builds(f.negated, inner),
        st.builds(f.implies, STATES, inner),
        st.builds(f.conjoined, inner, inner),
        st.builds(f.disjoined, inner, inner),
    )


PAST = st.recursive(STATES, past, max_leaves=3)
SHORT = st.recursive(PAST, lambda inner: future(inner, BOUNDED), max_leaves=3)
ANY = st.recursive(PAST, lambda inner: future(inner, st.one_of(BOUNDS, BOUNDED)), max_leaves=4)
LETTERS = st.frozensets(st.sampled_from("abc"))
WORDS = st.lists(LETTERS, min_size=1, max_size=5)


def staying(word: Word) -> Word:
    return [*word, *[word[-1]] * 20]


@settings(max_examples=150, deadline=None, derandomize=True)
@given(SHORT, WORDS, st.integers(0, 3))
def test_what_held_earlier_is_decided_by_the_positions_up_to_here(formula: f.Formula, word: Word, more: int) -> None:
    steps = f.horizon(formula)
    assert steps is not None
    then = f.earlier(formula, steps + more)
    assert f.is_state(then)
    run = staying(word)
    for at in range(9):
        expected = at >= steps + more and holds(formula, run, at - steps - more)
        assert holds(then, run, at) == expected


@settings(max_examples=100, deadline=None, derandomize=True)
@given(ANY, WORDS)
def test_a_property_that_is_written_for_a_formula_holds_of_the_same_runs(formula: f.Formula, word: Word) -> None:
    try:
        text = Writer(POINTS, "a").property(formula)
    except (UnsayableError, f.UndecidedError):
        assume(False)
    source = Source("x", f"{DECLARED}x: {text}")
    found = read(source, types_for(source, ())[0])
    assume(found.sound.properties)
    try:
        written = of_property(found.sound.properties[0], STEP)
    except NotComparedError:
        assume(False)
    run = staying(word)
    assert holds(written, run, 0) == holds(formula, run, 0), text


@settings(max_examples=60, deadline=None, derandomize=True)
@given(SHORT, SHORT, WORDS)
def test_only_formulas_that_hold_of_the_same_runs_are_shown_equal(
    left: f.Formula, right: f.Formula, word: Word
) -> None:
    left, right = f.always(left), f.always(right)
    try:
        shown = compare(left, right, {}, Alphabet(("a", "b", "c")))
    except NotComparedError:
        return
    run = staying(word)
    if holds(left, run, 0) != holds(right, run, 0):
        assert not shown.is_equal
        assert (shown.formula_only if holds(left, run, 0) else shown.property_only) != ""


FINE = 3
"""So many instants are between a point and the next one, where a run is looked at over signals."""

CHANGING = st.recursive(
    STATES,
    lambda inner: st.one_of(
        st.builds(f.Previous, STATES),
        st.builds(lambda p, b: f.eventually(p, *b), inner, BOUNDS),
        st.builds(lambda p, b: f.Since(f.TRUE, p, *b), inner, BOUNDS),
        st.builds(lambda p, q, b: f.Until(p, q, *b), STATES, STATES, BOUNDS),
        st.builds(lambda p, q, stop: f.Since(p, q, 0, stop), STATES, STATES, st.sampled_from([None, 0, 2])),
        st.builds(f.negated, inner),
        st.builds(f.conjoined, STATES, inner),
    ),
    max_leaves=3,
)


def finer(formula: f.Formula) -> f.Formula:
    """`formula` with its intervals in instants."""
    match formula:
        case f.Atom() | f.Truth():
            return formula
        case f.Not(operand):
            return f.Not(finer(operand))
        case f.And(left, right) | f.Or(left, right):
            return type(formula)(finer(left), finer(right))
        case f.Next(operand, steps) | f.Previous(operand, steps):
            return type(formula)(finer(operand), steps)
        case f.Until(left, right, start, stop) | f.Since(left, right, start, stop):
            ends = FINE * start, None if stop is None else FINE * stop
            return type(formula)(finer(left), finer(right), *ends)


def over_instants(formula: f.Formula, word: Word) -> bool:
    """Whether `formula` holds over the signals that have the values of `word` from each point up to the next one."""
    return holds(finer(formula), [letter for letter in word for _ in range(FINE)], 0)


@settings(max_examples=150, deadline=None, derandomize=True)
@given(STATES, CHANGING, LETTERS, WORDS)
def test_what_a_formula_says_over_signals_is_what_it_says_at_all_instants(
    trigger: f.Formula, formula: f.Formula, first: frozenset[str], word: Word
) -> None:
    said = f.always(f.implies(trigger, formula))
    run = [first, *word, *[word[-1]] * 8]
    assert holds(over_signals(said), run, 0) == over_instants(said, run)


PARTING = {
    "until": (f.always(f.implies(P, f.Until(Q, R, 2, 4))), "{a, b}; {b}; ({c}) for ever", ""),
    "an edge": (f.always(f.implies(P, f.Previous(Q))), "({b}; {a}) for ever", ""),
    "previous": (f.eventually(f.conjoined(P, f.Previous(Q))), "", "{a, b}; ({b}) for ever"),
}


@pytest.mark.parametrize(("formula", "at_points", "signals"), PARTING.values(), ids=list(PARTING))
def test_a_shortest_run_is_told_on_which_the_readings_part(formula: f.Formula, at_points: str, signals: str) -> None:
    found = parting(formula, STEP, {}, Alphabet(("a", "b", "c")))
    assert found == (STEP, at_points, signals)
    letters = [frozenset(each) for each in ("", "a", "b", "c", "ab", "ac", "bc", "abc")]
    for length in (1, 2, 3):
        for word in product(letters, repeat=length):
            run = [*word, *[word[-1]] * 8]
            if holds(formula, run, 0) != over_instants(formula, run):
                assert len(at_points.split(";")) <= length or len(signals.split(";")) <= length


@pytest.mark.parametrize("formula", [f.always(f.implies(P, f.eventually(Q, 2, 5))), f.always(f.Since(P, Q))])
def test_of_most_formulas_the_readings_are_one(formula: f.Formula) -> None:
    assert parting(formula, STEP, {}, Alphabet(("a", "b", "c"))) is None
    assert parting(formula, None, {}, Alphabet(("a", "b", "c"))) is None


def importing(formula: f.Formula, reading: Reading = POINTS) -> tuple[str, str]:
    """The property for a formula, and what is shown of it."""
    signals = Signals()
    for name in "abc":
        signals.use(name, Kind.BOOLEAN)
        signals.keep(name)
    (found,) = convert([Requirement("1", "", "", None, formula, (formula,))], signals, reading, Budget())
    return found.text, "equal" if found.shown and found.shown.is_equal else found.problem or "different"


EDGE = f.And(P, f.Not(f.Previous(P)))


def after(opening: f.Formula, body: f.Formula) -> f.Formula:
    """`body` from the first position with `opening` on."""
    return f.Or(f.Until(f.Not(opening), f.And(opening, body)), f.Not(f.eventually(opening)))


SAID = {
    "always a": f.always(P),
    "never (a and b)": f.always(f.Not(f.And(P, Q))),
    "eventually a": f.eventually(P),
    "until b, always a": f.Until(P, Q),
    "(always a) or (until b, always a)": f.weak_until(P, Q),
    "always (a implies eventually b within 500 s)": f.always(f.implies(P, f.eventually(Q, 0, 500))),
    "always (@{a, -20 else false} implies eventually b within 30 s)": f.always(f.implies(P, f.eventually(Q, 20, 50))),
    "always (a and not @{a, -1 else false} implies b)": f.always(f.implies(EDGE, Q)),
    "always (@{a, -1 else false} implies b)": f.always(f.implies(P, f.Next(Q))),
    "after @{a or not a, -3 else false}, never a": f.always(f.Not(P), 3),
    "after a, never b": f.Or(f.Until(f.Not(P), f.And(P, f.always(f.Not(Q)))), f.Not(f.eventually(P))),
    "initially a": P,
    "after c, always (once @{c, -1 else false} and @{a, -1 else false} implies b)": after(
        R, f.always(f.implies(P, f.Next(Q)))
    ),
    "eventually b within [2 s, 5 s]": f.eventually(Q, 2, 5),
    "always (a since b within 4 s)": f.always(f.Since(P, Q, 0, 4)),
}


@pytest.mark.parametrize(("text", "formula"), SAID.items(), ids=list(SAID))
def test_a_formula_is_said_in_idiomatic_words_and_shown_equal(text: str, formula: f.Formula) -> None:
    mark = "b" if "@{a or not a" not in text and "a" not in text.split() else "a"
    assert Writer(POINTS, mark).property(formula) == text
    if "20" not in text:
        assert importing(formula)[1] == "equal"


INSIDE = {
    "next": f.Next(Q),
    "eventually, later": f.eventually(Q, 2),
    "never, later": f.always(f.Not(Q), 2),
    "a response to what was": f.always(f.implies(P, f.eventually(Q, 1, 3))),
    "another after": after(P, f.always(f.implies(Q, f.Next(f.Not(Q))))),
    "next in a conjunction": f.And(f.always(f.implies(P, f.Next(Q))), f.Next(f.always(f.Not(R)), 2)),
}


@pytest.mark.parametrize("body", INSIDE.values(), ids=list(INSIDE))
@pytest.mark.parametrize("scope", [lambda body: after(R, body), f.Next], ids=["after", "next"])
def test_inside_a_scope_what_looks_ahead_does_not_look_back_before_it(
    scope: Callable[[f.Formula], f.Formula], body: f.Formula
) -> None:
    assert importing(scope(body))[1] == "equal"


UNEQUAL = {
    "within a step less": (
        f.always(f.implies(P, f.eventually(Q, 0, 3))),
        f.always(f.implies(P, f.eventually(Q, 0, 2))),
    ),
    "a next that is none": (f.always(f.implies(P, f.Next(Q))), f.always(f.implies(P, Q))),
    "a previous that is weak": (f.always(f.Previous(P)), f.always(f.Not(f.Previous(f.Not(P))))),
    "since for until": (f.always(f.Since(P, Q)), f.always(f.Until(P, Q))),
    "once for historically": (f.always(f.Since(f.TRUE, P)), f.always(f.Not(f.Since(f.TRUE, f.Not(P))))),
}


@pytest.mark.parametrize(("left", "right"), UNEQUAL.values(), ids=list(UNEQUAL))
def test_formulas_that_differ_are_told_apart_by_a_run(left: f.Formula, right: f.Formula) -> None:
    shown = compare(left, right, {}, Alphabet(("a", "b")))
    assert not shown.is_equal
    assert shown.formula_only or shown.property_only


def test_bounds_that_are_too_long_to_be_unrolled_are_equal_only_where_they_are_the_same() -> None:
    response = f.always(f.implies(P, f.eventually(Q, 0, 500)))
    assert compare(response, response, {}, Alphabet(("a", "b"))).is_equal
    with pytest.raises(NotComparedError):
        compare(response, f.always(f.implies(P, f.eventually(Q, 0, 499))), {}, Alphabet(("a", "b")))


def test_runs_that_end_are_compared_where_infinite_ones_tell_nothing_apart() -> None:
    last = f.Next(f.FALSE)
    shown = compare(
        f.always(f.implies(P, f.eventually(f.Or(Q, last)))),
        f.always(f.implies(P, f.eventually(Q))),
        {},
        Alphabet(("a", "b")),
    )
    assert shown.is_equal
    assert shown.finite
    assert shown.formula_only == "{a}"


def test_over_signals_positions_are_not_counted() -> None:
    text, shown = importing(f.always(f.implies(P, f.Next(Q))), Reading(None))
    assert not text
    assert "--reading points" in shown
