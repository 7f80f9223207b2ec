"""Doubles at which arithmetic is special, and random expressions over them."""

from __future__ import annotations

import math
import sys

from hypothesis import strategies as st

from ltlc.specification.expressions import (
    Arithmetic,
    Call,
    Current,
    Expression,
    Field,
    Negative,
    Number,
    Operator,
    Past,
    Signal,
    ValueType,
)
from ltlc.specification.functions import Function

LARGEST, LEAST_NORMAL, LEAST = sys.float_info.max, sys.float_info.min, 5e-324

MAGNITUDES = [
    *(0.0, LEAST, 2 * LEAST, math.nextafter(LEAST_NORMAL, 0), LEAST_NORMAL, math.nextafter(LEAST_NORMAL, 1)),
    *(0.1, math.nextafter(1, 0), 1.0, math.nextafter(1, 2), 3.0, 2.0**53, math.sqrt(LARGEST)),
    *(math.nextafter(LARGEST, 0), LARGEST, math.inf),
]
SPECIAL = [sign * magnitude for magnitude in MAGNITUDES for sign in (1, -1)]
"""Zeros, subnormals, the ends of the normal numbers, ones with their neighbours, infinities; of both signs."""

DOUBLES = st.one_of(st.sampled_from(SPECIAL), st.floats(allow_nan=False))


def number_signal(name: str, definition: Expression | None = None) -> Signal:
    """A signal that is read from a topic, or computed as `definition`."""
    field = Field(f"/{name}", "std_msgs/msg/Float64", ("data",))
    return Signal(name, ValueType.NUMBER, definition or field)


V, W = number_signal("v"), number_signal("w")
SPEED = number_signal("robot.velocity", Call(Function.NORM, (Current(V), Current(W))))
INPUTS: list[Current | Past] = [Current(V), Current(W), Past(V, 1), Current(SPEED), Past(SPEED, 2)]
"""Two numbers, their norm, and history. A recording may give the norm itself: it is at least 0, perhaps -0.0."""

VALUES = st.fixed_dictionaries(
    {wanted: DOUBLES.map(abs) | st.just(-0.0) if wanted.signal is SPEED else DOUBLES for wanted in INPUTS}
)
"""Values of the inputs."""

_ARITIES = {each: range(each.takes.least, min(each.takes.most or 3, 3) + 1) for each in Function if each.takes.least}


def _calls(parts: st.SearchStrategy[Expression]) -> st.SearchStrategy[Expression]:
    """Functions of `parts`."""
    arguments = [
        st.builds(Call, st.just(function), st.tuples(*[parts] * arity))
        for function, arities in _ARITIES.items()
        for arity in arities
    ]
    return st.one_of(arguments)


EXPRESSIONS: st.SearchStrategy[Expression] = st.recursive(
    st.one_of(st.sampled_from(INPUTS), st.sampled_from(INPUTS), st.builds(Number, DOUBLES)),
    lambda parts: st.one_of(
        st.builds(Arithmetic, st.sampled_from(Operator), parts, parts), st.builds(Negative, parts), _calls(parts)
    ),
    max_leaves=6,
)
"""Numbers computed from the inputs."""
