"""Names of emitted C: those that the Python target would choose, but for what is taken in C and C++."""

from __future__ import annotations

from ltlc.backends.c.library import FUNCTIONS
from ltlc.backends.names import Names

_KEYWORDS = """
alignas alignof and_eq asm auto bitand bitor bool case catch char compl concept const consteval constexpr constinit
const_cast default delete do double dynamic_cast enum explicit export extern false final float friend goto inline int
long mutable namespace new noexcept not_eq nullptr operator or_eq override private protected public register
reinterpret_cast requires restrict short signed sizeof static static_assert static_cast struct switch template this
thread_local throw true typedef typeid typename typeof union unsigned using virtual void volatile wchar_t xor xor_eq
"""
_TAKEN = """
NULL INFINITY NAN HUGE_VAL linux unix i386 main errno stdin stdout stderr assert
int8_t int16_t int32_t int64_t uint8_t uint16_t uint32_t uint64_t size_t ptrdiff_t std
acos asin atan atan2 ceil cos cosh exp fabs fabsf floor fmod frexp hypot isfinite isinf isnan j0 j1 jn ldexp log log10
modf pow signbit sin sinh sqrt tan tanh y0 y1 yn exp2 expm1 fma fmax fmin gamma lgamma log1p log2 logb rint round trunc
abort exit free malloc memcpy memset printf signal strcmp strlen
"""
_CALLED = (
    *FUNCTIONS,
    "judge",
    "begin_session",
    "counted",
    "find",
    "first_steps",
    "go_on",
    "hold",
    "is_alike",
    "is_as_new",
    "is_decided",
    "is_merged",
    "is_tick",
    "next_tick",
    "pass",
    "place_of",
    "release",
    "settle",
    "take",
    "tick",
)
_LOCAL = "all elements found held i length monitors samples self signals state time together"

_PUBLIC = """
advance begin init invalid_of monitors next_deadline property samples signals since_of step steps_of verdict verdict_of
bools doubles floats int16s int32s int64s int8s texts uint16s uint32s uint64s uint8s end has_session is_over latest
ticks time
"""


def member_names(*taken: str) -> Names:
    """Names of members of structs, beside those of C and C++ and `taken`."""
    return Names(frozenset(f"{_KEYWORDS} {_TAKEN}".split()) | frozenset(taken))


def property_names(prefix: str, *taken: str) -> Names:
    """Names of properties, which those of types, public functions and functions of the file are made from.

    None is in `taken`, or `prefix`, with which public names begin: `prefix_step` is the step of all properties.
    """
    return member_names(prefix, *_PUBLIC.split(), *taken)


def local_names(*taken: str) -> Names:
    """Names of parameters and variables, which hide no function that they stand beside."""
    return member_names(*_CALLED, *_LOCAL.split(), *taken)
