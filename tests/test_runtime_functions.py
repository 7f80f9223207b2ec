"""The arithmetic of emitted code against the reference value of expressions, and against known rotations."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ltlc.runtime import functions as f
from ltlc.specification.evaluation import apply, calculate
from ltlc.specification.expressions import Operator
from ltlc.specification.functions import Function

doubles = st.floats() | st.sampled_from([0.0, -0.0, math.inf, -math.inf, math.nan])
components = st.tuples(*[st.floats(-10, 10)] * 4).filter(lambda q: math.hypot(*q) > 1e-3)


def same(left: float, right: float) -> bool:
    """Equal, with the same sign; NaN is the same as NaN."""
    if math.isnan(left) or math.isnan(right):
        return math.isnan(left) and math.isnan(right)
    return left == right and math.copysign(1, left) == math.copysign(1, right)


@given(doubles, doubles)
def test_division_is_the_reference(left: float, right: float) -> None:
    assert same(f.divide(left, right), calculate(Operator.OVER, left, right))


@pytest.mark.parametrize(
    ("function", "reference"),
    [
        (f.square_root, Function.SQRT),
        (f.least, Function.MIN),
        (f.greatest, Function.MAX),
        (f.norm, Function.NORM),
    ],
)
@given(values=st.tuples(doubles, doubles, doubles))
def test_functions_are_the_reference_and_lose_no_nan(
    function: object, reference: Function, values: tuple[float, ...]
) -> None:
    assert callable(function)
    arguments = values[:1] if reference is Function.SQRT else values
    if math.isnan(sum(map(abs, arguments))):
        assert math.isnan(function(*arguments))
    else:
        assert function(*arguments) == apply(reference, list(arguments)) or reference is Function.SQRT


def test_the_smallest_and_largest_of_nothing_is_nan() -> None:
    assert math.isnan(f.smallest(()))
    assert math.isnan(f.largest(()))


def test_a_nan_anywhere_in_an_array_is_left_out() -> None:
    assert f.smallest((1.0, math.nan, 2.0)) == f.smallest((math.nan, 1.0)) == 1.0
    assert f.largest((math.nan, 1.0)) == f.largest((1.0, -math.inf, math.nan)) == 1.0
    assert math.isnan(f.smallest((math.nan, math.nan)))


def rotation(roll: float, pitch: float, yaw: float) -> tuple[float, float, float, float]:
    """The quaternion x, y, z, w of a rotation about x, then y, then z, by the product of the three."""
    x, y, z, w = 0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)
    for axis, angle in (((0.0, 1.0, 0.0), pitch), ((1.0, 0.0, 0.0), roll)):
        a, b, c = (component * math.sin(angle / 2) for component in axis)
        d = math.cos(angle / 2)
        x, y, z, w = (
            w * a + x * d + y * c - z * b,
            w * b - x * c + y * d + z * a,
            w * c + x * b - y * a + z * d,
            w * d - x * a - y * b - z * c,
        )
    return x, y, z, w


@given(st.floats(-3, 3), st.floats(-1.5, 1.5), st.floats(-3, 3), st.floats(0.01, 100))
def test_roll_pitch_and_yaw_are_those_that_the_rotation_was_made_of(
    roll: float, pitch: float, yaw: float, length: float
) -> None:
    orientation = [component * length for component in rotation(roll, pitch, yaw)]
    assert f.roll(*orientation) == pytest.approx(roll, abs=1e-9)
    assert f.pitch(*orientation) == pytest.approx(pitch, abs=1e-7)
    assert f.yaw(*orientation) == pytest.approx(yaw, abs=1e-9)


@given(st.floats(0, 3.14), st.floats(-3, 3), st.booleans())
def test_the_angle_between_orientations_is_that_of_the_turn(turn: float, start: float, negated: bool) -> None:
    sign = -1 if negated else 1
    other = [sign * component for component in rotation(0, 0, start + turn)]
    assert f.angle(*rotation(0, 0, start), *other) == pytest.approx(turn, abs=1e-9)


@given(components, components)
def test_rotations_are_the_reference(one: tuple[float, ...], other: tuple[float, ...]) -> None:
    for function, reference in ((f.roll, Function.ROLL), (f.pitch, Function.PITCH), (f.yaw, Function.YAW)):
        assert function(*one) == pytest.approx(apply(reference, list(one)), abs=1e-6)
    assert f.angle(*one, *other) == pytest.approx(apply(Function.ANGLE, [*one, *other]), abs=1e-9)


@given(components)
def test_the_angle_between_equal_orientations_is_0(orientation: tuple[float, ...]) -> None:
    assert f.angle(*orientation, *orientation) == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("orientation", [(0.0,) * 4, (math.nan, 0.0, 0.0, 1.0), (math.inf, 0.0, 0.0, 1.0)])
def test_what_is_no_orientation_has_no_angles(orientation: tuple[float, float, float, float]) -> None:
    answers = [f.roll(*orientation), f.pitch(*orientation), f.yaw(*orientation)]
    answers += [f.angle(*orientation, 0, 0, 0, 1), f.angle(0, 0, 0, 1, *orientation)]
    assert all(map(math.isnan, answers))
    assert math.isnan(apply(Function.YAW, list(orientation)))


def test_an_integer_beyond_the_doubles_is_infinite() -> None:
    assert f.number(10**400) == math.inf
    assert f.number(-(10**400)) == -math.inf
    assert f.number(True) == 1.0
