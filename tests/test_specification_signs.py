"""What is claimed of signs, against the reference, at all special doubles and at random ones."""

from __future__ import annotations

import itertools
import math
import random

import pytest
from doubles import EXPRESSIONS, SPECIAL, VALUES, V, W, number_signal
from hypothesis import example, given, settings

from ltlc.runtime import functions
from ltlc.specification.evaluation import apply, evaluate
from ltlc.specification.expressions import (
    Arithmetic,
    Call,
    Current,
    Expression,
    Input,
    Negative,
    Number,
    Operator,
    Past,
    Slope,
)
from ltlc.specification.functions import Function
from ltlc.specification.signs import Sign, never_negative, sign

X, Y = Current(V), Current(W)

OF_EACH_SIGN: list[tuple[Expression, list[float]]] = [
    (X, SPECIAL),
    (Call(Function.SQRT, (X,)), [x for x in SPECIAL if x >= 0]),
    (Call(Function.ABS, (X,)), [abs(x) for x in SPECIAL]),
    (Call(Function.MAX, (X, Number(5e-324))), [x for x in SPECIAL if x > 0]),
]
"""An expression of each sign, with values that it has."""


def is_as_claimed(claim: Sign, value: float) -> bool:
    match claim:
        case Sign.NOT_BELOW_ZERO:
            return math.isnan(value) or value >= 0
        case Sign.UNSIGNED:
            return math.isnan(value) or math.copysign(1, value) > 0
        case Sign.POSITIVE:
            return math.isnan(value) or value > 0
        case Sign.UNKNOWN:
            return True


def test_there_is_an_expression_of_each_sign() -> None:
    assert [sign(expression) for expression, _ in OF_EACH_SIGN] == list(Sign)


def combined(make: object, arity: int) -> list[tuple[Expression, list[tuple[float, ...]]]]:
    """`make` of expressions of all signs, with all special values of these."""
    return [
        (make(*(e for e, _ in parts)), list(itertools.product(*(values for _, values in parts))))  # type: ignore[operator]
        for parts in itertools.product(OF_EACH_SIGN, repeat=arity)
    ]


@pytest.mark.parametrize("operator", Operator)
def test_the_sign_of_an_operation_holds_of_all_special_values(operator: Operator) -> None:
    for expression, operands in combined(lambda a, b: Arithmetic(operator, a, b), 2):
        for a, b in operands:
            value = evaluate(Arithmetic(operator, X, Y), {X: a, Y: b})
            assert is_as_claimed(sign(expression), value), (expression, a, b)  # type: ignore[arg-type]


@pytest.mark.parametrize("function", [Function.MIN, Function.MAX, Function.NORM, Function.MOD, Function.ANGLE_BETWEEN])
def test_the_sign_of_a_function_of_two_holds_of_all_special_values(function: Function) -> None:
    for expression, operands in combined(lambda a, b: Call(function, (a, b)), 2):
        for a, b in operands:
            assert is_as_claimed(sign(expression), apply(function, [a, b])), (expression, a, b)


OF_ONE = [function for function in Function if function.takes.most == 1]


@pytest.mark.parametrize("function", OF_ONE)
def test_the_sign_of_a_function_of_one_holds_of_all_special_values(function: Function) -> None:
    for expression, operands in combined(lambda a: Call(function, (a,)), 1):
        for (a,) in operands:
            assert is_as_claimed(sign(expression), apply(function, [a])), (expression, a)


def test_an_angle_has_no_sign_whatever_the_orientations() -> None:
    chance = random.Random(0)
    claim = sign(Call(Function.ANGLE, (X,) * 8))
    assert claim is Sign.UNSIGNED
    for _ in range(3000):
        orientations = chance.choices(SPECIAL, k=8)
        for value in (apply(Function.ANGLE, orientations), functions.angle(*orientations)):
            assert is_as_claimed(claim, value), orientations


def test_norms_of_emitted_code_have_no_sign() -> None:
    for components in itertools.product(SPECIAL, repeat=2):
        assert is_as_claimed(Sign.UNSIGNED, functions.norm(*components)), components


@settings(max_examples=250)
@example(Arithmetic(Operator.OVER, Number(1.0), Call(Function.SQRT, (X,))), dict.fromkeys([X], -0.0))
@given(EXPRESSIONS, VALUES)
def test_the_sign_of_an_expression_holds_of_its_values(expression: Expression, values: dict[Input, float]) -> None:
    assert is_as_claimed(sign(expression), evaluate(expression, values))  # type: ignore[arg-type]


def test_what_is_computed_keeps_its_sign_as_a_signal_but_for_zero() -> None:
    """A recording may give a speed itself, and as -0.0."""
    speed = number_signal("speed", Call(Function.NORM, (X, Y)))
    assert sign(Current(speed)) is sign(Past(speed, 1)) is Sign.NOT_BELOW_ZERO
    assert sign(Current(V)) is sign(Slope(speed)) is Sign.UNKNOWN


def test_what_may_be_minus_zero_tells_nothing_of_what_it_divides() -> None:
    root, distance = Call(Function.SQRT, (X,)), Call(Function.NORM, (X, Y))
    assert never_negative(root)
    assert not never_negative(Arithmetic(Operator.OVER, Number(1.0), root))
    assert never_negative(Arithmetic(Operator.OVER, Number(1.0), distance))
    assert never_negative(Arithmetic(Operator.OVER, root, Call(Function.MAX, (root, Number(0.1)))))
    assert not never_negative(Negative(distance))
    assert not never_negative(Arithmetic(Operator.TIMES, Number(-0.0), X))
