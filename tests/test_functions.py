"""Functions of numbers: what the runtime computes, against exact arithmetic and known values."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction

import pytest
from doubles import DOUBLES, SPECIAL
from hypothesis import given
from hypothesis import strategies as st
from language_support import codes_of, compiled, findings

from ltlc.runtime import functions as f
from ltlc.specification.evaluation import apply
from ltlc.specification.expressions import Comparison, Number
from ltlc.specification.functions import WRITTEN, Function

FINITE = st.floats(allow_nan=False, allow_infinity=False) | st.sampled_from([x for x in SPECIAL if math.isfinite(x)])
RENAMED = {"floor": "rounded_down", "ceil": "rounded_up", "sign": "sign_of", "mod": "modulo"}
OF_NUMBERS = [
    function
    for function in WRITTEN.values()
    if function.takes.most in (1, 2) and function not in (Function.ABS, Function.SQRT)
]
"""Functions of so many numbers, all but those that `test_runtime_functions.py` has."""


def emitted(function: Function) -> Callable[..., float]:
    found: Callable[..., float] = getattr(f, RENAMED.get(function.value, function.value))
    return found


def same(left: float, right: float) -> bool:
    """Bit for bit, but that one NaN is as good as another."""
    return repr(left) == repr(right)


@pytest.mark.parametrize("function", OF_NUMBERS)
@given(values=st.tuples(DOUBLES | st.just(math.nan), DOUBLES | st.just(math.nan)))
def test_a_function_is_the_reference_to_the_bit(function: Function, values: tuple[float, float]) -> None:
    arguments = values[: function.takes.least]
    assert same(emitted(function)(*arguments), apply(function, arguments)), arguments


@given(FINITE)
def test_floor_and_ceil_are_the_integers_next_to_a_number_and_never_minus_zero(value: float) -> None:
    below, above = f.rounded_down(value), f.rounded_up(value)
    assert Fraction(below) == Fraction(value) // 1
    assert Fraction(above) == -(-Fraction(value) // 1)
    assert "-0.0" not in (repr(below), repr(above))


@given(FINITE, FINITE.filter(bool))
def test_mod_is_exact_but_for_one_rounding_and_has_the_sign_of_the_divisor(dividend: float, divisor: float) -> None:
    rest = f.modulo(dividend, divisor)
    exact = Fraction(dividend) - Fraction(divisor) * (Fraction(dividend) // Fraction(divisor))
    assert same(rest, float(exact))
    assert rest * math.copysign(1.0, divisor) >= 0
    assert abs(rest) <= abs(divisor)


@given(st.floats(-1e6, 1e6), st.integers(-1000, 1000))
def test_an_angle_between_two_directions_is_at_most_half_a_turn_and_does_not_count_whole_ones(
    angle: float, turns: int
) -> None:
    found = f.angle_between(angle + turns * math.tau, angle)
    assert 0 <= found <= math.pi
    assert found == pytest.approx(0, abs=1e-6)
    assert f.angle_between(angle, angle + math.pi) == pytest.approx(math.pi, abs=1e-6)
    assert f.angle_between(0.0, angle) == f.angle_between(angle, 0.0)


@pytest.mark.parametrize(
    ("function", "arguments", "value"),
    [
        ("mod", (-1.0, 3.0), 2.0),
        ("mod", (1.0, -3.0), -2.0),
        ("mod", (-1.0, math.inf), math.inf),
        ("mod", (-1e-20, 360.0), 360.0),
        ("mod", (1.0, 0.0), math.nan),
        ("mod", (math.inf, 2.0), math.nan),
        ("log", (0.0,), -math.inf),
        ("log", (-0.0,), -math.inf),
        ("log", (-1.0,), math.nan),
        ("exp", (1e9,), math.inf),
        ("exp", (-math.inf,), 0.0),
        ("sin", (math.inf,), math.nan),
        ("asin", (1.0000000000000002,), math.nan),
        ("acos", (-1.0,), math.pi),
        ("atan2", (0.0, -1.0), math.pi),
        ("atan2", (-0.0, -1.0), -math.pi),
        ("angle_between", (3.0, -3.0), math.tau - 6.0),
        ("angle_between", (math.inf, 0.0), math.nan),
        ("sign", (-0.0,), 0.0),
        ("ceil", (-0.5,), 0.0),
        ("floor", (-math.inf,), -math.inf),
    ],
)
def test_a_function_has_the_value_that_the_reference_page_gives(
    function: str, arguments: tuple[float, ...], value: float
) -> None:
    assert same(apply(WRITTEN[function], arguments), value)


def test_norm_and_hypot_say_the_same_of_a_vector() -> None:
    declared = "decl p /p PointStamped.point\n"
    norm, hypot = (compiled(f"{declared}never {text} > 2\n") for text in ("norm(p)", "hypot(p.x, p.y, p.z)"))
    assert norm.properties[0].atoms[0].condition == hypot.properties[0].atoms[0].condition


@pytest.mark.parametrize(
    ("call", "message"),
    [
        ("norm(x)", "`norm` takes one vector, but `x` is a number"),
        ("norm(p, p)", "`norm` takes one vector, not 2"),
        ("hypot(p)", "`hypot` takes numbers, but `p` is a vector"),
        ("hypot(x)", "`hypot` takes two or three numbers, not 1"),
        ("mod(x)", "`mod` takes two numbers, not 1"),
    ],
)
def test_a_function_says_what_it_takes(call: str, message: str) -> None:
    declared = "decl p /p PointStamped.point\ndecl x /x Float64.data\n"
    (found,) = findings(f"{declared}never {call} > 2\n")
    assert (found.code, found.message) == ("LTL207", message)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("180 deg", math.pi),
        ("90deg", math.pi / 2),
        ("-45 deg", -math.pi / 4),
        ("1 rad", 1.0),
        ("2 * 30 deg", math.pi / 3),
    ],
)
def test_an_angle_may_have_a_unit(text: str, value: float) -> None:
    condition = compiled(f"decl x /x Float64.data\nnever x > {text}\n").properties[0].atoms[0].condition
    assert isinstance(condition, Comparison)
    assert condition.right == Number(value)


@pytest.mark.parametrize(
    "text",
    ["decl deg /d Float64.data\ndecl b /b Bool.data\nnever deg > 3\ndeg: never b", "x = 3\nrad = 4\nnever x > rad"],
)
def test_units_of_angles_are_names_where_no_number_stands_before_them(text: str) -> None:
    assert compiled(text).properties


def test_an_angle_is_no_index() -> None:
    assert codes_of("decl scan /scan LaserScan.ranges\nnever scan[1 rad] > 1\n") != []


def test_names_of_functions_are_names_where_nothing_is_called() -> None:
    words = [
        "floor",
        "ceil",
        "mod",
        "sign",
        "norm",
        "hypot",
        "exp",
        "log",
        "sin",
        "cos",
        "tan",
        "asin",
        "acos",
        "atan2",
        "angle_between",
    ]
    declared = "\n".join(f"decl {word} /{word} Bool.data" for word in words)
    for word in words:
        assert len(compiled(f"{declared}\nnever {word}\n\n(always {word} implies not {words[0]})\n").properties) == 2
