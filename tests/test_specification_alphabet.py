"""The letters that exist, against direct evaluation at doubles around every threshold."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest
from cases import TABLE, double
from doubles import DOUBLES, EXPRESSIONS, VALUES
from hypothesis import given, settings
from hypothesis import strategies as st
from language_support import SIGNALS, compiled, only_property

from ltlc.base.source import Span
from ltlc.specification import evaluation
from ltlc.specification.alphabet import alphabet
from ltlc.specification.atoms import Atom
from ltlc.specification.evaluation import Value
from ltlc.specification.expressions import (
    Call,
    Comparison,
    Current,
    Expression,
    Field,
    Number,
    Read,
    Relation,
    Same,
    Signal,
    String,
    ValueType,
)
from ltlc.specification.functions import Function
from ltlc.specification.specification import PropertySpecification
from ltlc.specification.wire import DOUBLES as ALL_DOUBLES
from ltlc.specification.wire import SINGLES, Kind, Numbers

ORDERINGS: dict[Relation, Callable[[float, float], bool]] = {
    Relation.LESS: lambda a, b: a < b,
    Relation.AT_MOST: lambda a, b: a <= b,
    Relation.AT_LEAST: lambda a, b: a >= b,
    Relation.GREATER: lambda a, b: a > b,
}

ROUND = st.sampled_from([0.0, -0.0, 0.1, 0.2, 0.3, 1.0, 1.1, 2.0, 1e16, 1e300, 5e-324, 1e-3, -1.0, -0.1])
NEAR = st.builds(lambda x, n: neighbour(x, n), ROUND, st.integers(-3, 3))  # noqa: PLW0108 (defined below)
THRESHOLDS = st.one_of(ROUND, NEAR, st.floats(allow_nan=False, allow_infinity=False))
MARGINS = st.one_of(st.sampled_from([0.0, 0.1, 0.2, 1.0, 1e-16, 5e-324, 1e16]), st.floats(0, 1e300))
NUMBERS = st.one_of(THRESHOLDS, st.sampled_from([math.inf, -math.inf]), st.floats(allow_nan=False))
OPERATORS = st.sampled_from(["<", "<=", "==", "!=", ">=", ">"])


def neighbour(value: float, steps: int) -> float:
    """The double so many steps above, or below, `value`."""
    for _ in range(abs(steps)):
        value = math.nextafter(value, math.copysign(math.inf, steps))
    return value


def written(value: float) -> str:
    return f"-{-value!r}" if math.copysign(1, value) < 0 else repr(value)


def holds(atom: Atom, v: float, w: float) -> bool:
    """The condition of `atom`, by its definition in `specification`."""
    comparison = atom.condition
    assert isinstance(comparison, Comparison)
    left, right = side(comparison.left, v, w), side(comparison.right, v, w)
    if comparison.relation is Relation.EQUAL:
        return left == right or (comparison.margin > 0 and abs(left - right) <= comparison.margin)
    return ORDERINGS[comparison.relation](left, right + comparison.margin)


def side(expression: Expression, v: float, w: float) -> float:
    if isinstance(expression, Number):
        return expression.value
    assert isinstance(expression, Current)
    return {"v": v, "w": w}[expression.signal.name]


def letter(found: PropertySpecification, v: float, w: float = 0.0) -> frozenset[str]:
    return frozenset(atom.name for atom in found.atoms if holds(atom, v, w))


def disjunction(comparisons: list[str]) -> PropertySpecification:
    return only_property("never (" + " or ".join(comparisons) + ")")


def on_constants(left: str) -> st.SearchStrategy[str]:
    return st.builds(
        lambda o, m, t, flip: f"{written(t)} {o}{{{m!r}}} {left}" if flip else f"{left} {o}{{{m!r}}} {written(t)}",
        OPERATORS,
        MARGINS,
        THRESHOLDS,
        st.booleans(),
    )


ON_PAIRS = st.builds(
    lambda o, m, flip: f"w {o}{{{m!r}}} v" if flip else f"v {o}{{{m!r}}} w", OPERATORS, MARGINS, st.booleans()
)


def around(found: PropertySpecification) -> list[float]:
    """Doubles at, and a few steps from, every place where a comparison with a constant may change."""
    points = [0.0, math.inf, -math.inf]
    for atom in found.atoms:
        comparison = atom.condition
        assert isinstance(comparison, Comparison)
        for constant in (comparison.left, comparison.right):
            if isinstance(constant, Number):
                points += [constant.value, constant.value + comparison.margin, constant.value - comparison.margin]
    return [neighbour(point, step) for point in points for step in range(-4, 5)]


@given(st.lists(on_constants("v"), min_size=1, max_size=5), st.lists(NUMBERS, max_size=5))
def test_what_comparisons_with_constants_give_is_a_letter(comparisons: list[str], values: list[float]) -> None:
    found = disjunction(comparisons)
    for value in [*values, *around(found)]:
        assert found.alphabet.allows(letter(found, value)), value


@given(st.lists(on_constants("v"), min_size=1, max_size=5))
def test_every_letter_over_comparisons_with_constants_is_given_by_a_double(comparisons: list[str]) -> None:
    found = disjunction(comparisons)
    seen = {letter(found, value) for value in around(found)}
    for group in found.alphabet.groups:
        assert set(group.valuations) <= {one & frozenset(group.atoms) for one in seen}


KINDS = ("line ", "singles ", "integers ")
LINES = [line.split(" ; ") for line in TABLE.read_text(encoding="utf-8").splitlines() if line.startswith(KINDS)]


def compared(words: list[str], number: Expression) -> list[Atom]:
    """The comparisons of a line of the table of cases, numbered."""
    found = []
    for index, (side, relation, margin, constant) in enumerate(zip(*(words[k::4] for k in range(4)), strict=True)):
        sides = (Number(double(constant)), number) if side == "left" else (number, Number(double(constant)))
        comparison = Comparison(sides[0], Relation(relation), sides[1], double(margin))
        found.append(Atom(str(index), comparison, Span(0, 0)))
    return found


def number_of(words: list[str]) -> tuple[Expression, list[str]]:
    """A number as the first words of a line say, and the others."""
    match words:
        case "line", least, *rest:
            numbers, from_zero = ALL_DOUBLES, double(least) == 0
        case "singles", least, *rest:
            numbers, from_zero = SINGLES, least == "0"
        case _, least, most, *rest:
            numbers, from_zero = Numbers(Kind.INTEGER, int(least), int(most)), False
        case _:
            raise ValueError(words)
    number = Current(Signal("n", ValueType.NUMBER, Field("/n", "any/msg/Number", ("n",), numbers)))
    return Call(Function.ABS, (number,)) if from_zero else number, rest


def test_the_letters_of_comparisons_with_constants_are_those_of_coq() -> None:
    assert len(LINES) > 500
    for text, letters in LINES:
        number, words = number_of(text.split())
        atoms = compared(words, number)
        expected = {
            frozenset(a.name for a, bit in zip(atoms, each, strict=True) if bit == "1") for each in letters.split()
        }
        assert set(alphabet(atoms).letters()) == expected, text


@given(st.lists(ON_PAIRS, min_size=1, max_size=5), st.lists(st.tuples(NUMBERS, NUMBERS), max_size=5), NUMBERS)
def test_what_comparisons_of_a_pair_give_is_a_letter(
    comparisons: list[str], pairs: list[tuple[float, float]], base: float
) -> None:
    found = disjunction(comparisons)
    margins = [a.condition.margin for a in found.atoms if isinstance(a.condition, Comparison)]
    near = [
        (neighbour(base + m, step), base) for m in [0.0, *margins] for step in (-1, 0, 1) if not math.isnan(base + m)
    ]
    for v, w in [*pairs, *near, *((w, v) for v, w in near)]:
        assert found.alphabet.allows(letter(found, v, w)), (v, w)


MODE = Current(Signal("mode", ValueType.STRING, Field("/mode", "std_msgs/msg/String", ("data",))))
WORDS = st.sampled_from(["", "a", "b", "A", '"', "\\", "a "])


def atoms_of(conditions: list[Comparison | Same]) -> tuple[Atom, ...]:
    return tuple(Atom(f"{number}", condition, Span(0, 0)) for number, condition in enumerate(conditions))


@st.composite
def related(draw: st.DrawFn) -> tuple[Atom, ...]:
    """Comparisons among few expressions and constants, so that many speak of the same."""
    sides = draw(st.lists(EXPRESSIONS, min_size=1, max_size=2)) + draw(
        st.lists(st.builds(Number, DOUBLES), min_size=1, max_size=2)
    )
    side = st.sampled_from(sides)
    margins = st.one_of(st.just(0.0), MARGINS)
    equal = st.builds(Comparison, side, st.just(Relation.EQUAL), side, margins)
    ordered = st.builds(Comparison, side, st.sampled_from(list(ORDERINGS)), side, margins | margins.map(lambda m: -m))
    words = WORDS.map(lambda word: Same(MODE, String(word)))
    conditions = draw(st.lists(st.one_of(equal, ordered, ordered, words), min_size=1, max_size=6, unique_by=repr))
    return atoms_of(conditions)


@settings(max_examples=200)
@given(related(), st.lists(VALUES, min_size=1, max_size=8), WORDS)
def test_what_the_reference_reaches_is_a_letter(
    atoms: tuple[Atom, ...], tried: list[dict[Read, Value]], mode: str
) -> None:
    letters = alphabet(atoms)
    for values in tried:
        reached = evaluation.letter(atoms, {**values, MODE: mode})
        assert reached is None or letters.allows(reached), (values, reached)


@pytest.mark.parametrize(
    ("text", "v"),
    [
        ("never 1 / sqrt(v) < 0", -0.0),
        ("never 1 / (v * 0) > 1 and 1 / (v * -0) < -1", 1.0),
        ("never 1 / max(-0, abs(v)) < 0", 0.0),
        ("never abs(v) / min(v, 0) < 0", -5e-324),
        ("never abs(v) * abs(v) > 0 or abs(v) * abs(v) == 0", 5e-324),
        ("never v > 1.7976931348623157e308", math.inf),
        ("never v =={1} 1e999 or v == 1e999", math.inf),
        ("never v + 1e16 > 1e16 or v > 0", 1.0),
    ],
)
def test_the_letter_of_a_rare_value_is_one(text: str, v: float) -> None:
    found = only_property(text)
    reached = evaluation.letter(found.atoms, dict.fromkeys(found.inputs(), v))
    assert reached is not None
    assert found.alphabet.allows(reached)


@given(st.floats(allow_nan=False), st.sampled_from([ALL_DOUBLES, SINGLES]))
def test_the_rank_of_what_lies_between_two_numbers_is_that_of_the_lower(value: float, numbers: Numbers) -> None:
    rank = numbers.rank(value)
    assert numbers.at(rank) <= value
    assert value == math.inf or value < numbers.at(rank + 1)


@given(st.floats(-1e6, 1e6))
def test_the_rank_of_what_lies_between_two_integers_is_the_lower(value: float) -> None:
    integers = Numbers(Kind.INTEGER, -(2**31), 2**31 - 1)
    assert integers.rank(value) <= value < integers.rank(value) + 1


@given(st.floats(allow_nan=False))
def test_ranks_number_the_doubles(value: float) -> None:
    assert ALL_DOUBLES.at(ALL_DOUBLES.rank(value)) == value
    assert value == math.inf or ALL_DOUBLES.rank(math.nextafter(value, math.inf)) == ALL_DOUBLES.rank(value) + 1


def valuations(text: str) -> set[frozenset[str]]:
    (group,) = only_property(text).alphabet.groups
    return set(group.valuations)


def test_below_and_above_a_threshold_exclude_each_other() -> None:
    assert valuations("never (v < 1 and v > 1)") == {frozenset(), frozenset({"v < 1"}), frozenset({"v > 1"})}


def test_a_pair_without_margins_has_three_cells() -> None:
    assert valuations("never (v < w or v == w or v > w)") == {
        frozenset({"v < w"}),
        frozenset({"v == w"}),
        frozenset({"v > w"}),
    }


def test_a_pair_is_the_same_the_other_way_round() -> None:
    assert valuations("never (v < w and w < v)") == {frozenset(), frozenset({"v < w"}), frozenset({"w < v"})}


def test_a_pair_with_a_distant_margin_is_not_close() -> None:
    assert frozenset({"v > w + 2", "v =={1} w"}) not in valuations("after v >{2} w, v =={1} w")


def test_a_string_has_one_value() -> None:
    assert valuations('never (mode == "a" and mode != "b")') == {
        frozenset(),
        frozenset({'mode == "a"'}),
        frozenset({'mode == "b"'}),
    }


def test_norms_and_absolute_values_are_never_negative() -> None:
    for expression in ("robot.velocity", "abs(v)", "robot.distance.sign", "max(v, abs(w))", "2 * abs(v) + 1"):
        (found,) = compiled(f"{SIGNALS} never {expression} < 0").properties
        assert found.alphabet.groups[0].valuations == (frozenset(),), expression


def test_numbers_that_may_be_negative_are_free() -> None:
    for expression in ("v", "abs(v) - 1", "min(v, abs(w))", "-abs(v)", "robot.velocity.x", "robot.orientation"):
        (found,) = compiled(f"{SIGNALS} never {expression} < 0").properties
        assert found.alphabet.groups == (), expression


def test_atoms_on_different_signals_and_booleans_are_free() -> None:
    assert only_property("never (v < 1 and w > 1 and flag)").alphabet.groups == ()


def test_thirty_thresholds_have_sixty_one_cells_not_a_billion() -> None:
    found = only_property("never (" + " or ".join(f"v < {i} or v > {i}" for i in range(30)) + ")")
    assert len(list(found.alphabet.letters())) == 61
