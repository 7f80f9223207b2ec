"""The table of functions: of each its types, what NaN does, how exact it is, and how each target spells it.

A row without a spelling for a target makes that target refuse what needs it. Every
spelling is run on edge values against the reference for values (`ltlc.specification.evaluation`), which shares nothing
with this file, in `tests/test_program_functions.py` and `test_columns_functions.py`.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from typing import NamedTuple

from ltlc.dataclass import dataclass
from ltlc.program.types import BOOL, DOUBLE, INTEGER, SIGNED, SINGLE, UNSIGNED, Scalar, Type
from ltlc.specification.functions import Function as Named


class Primitive(Enum):
    """What an `Apply` computes; `ROWS` has the rest."""

    NEGATE, ABS = "negative", "absolute value"
    ADD, SUBTRACT, TIMES, OVER = "sum", "difference", "product", "quotient"
    LEAST, GREATEST = "least", "greatest"
    SQRT, NORM = "square root", "norm"
    FLOOR, CEIL, SIGN, MOD = "floor", "ceiling", "sign", "remainder"
    EXP, LOG, SIN, COS, TAN = "exponential", "logarithm", "sine", "cosine", "tangent"
    ASIN, ACOS, ATAN2, ANGLE_BETWEEN = "arc sine", "arc cosine", "angle of a direction", "angle between directions"
    GAP = "difference, 0 of equal infinities"
    INSIDE, DISTANCE = "place in a zone", "distance from a zone"
    ROLL, PITCH, YAW, ANGLE = "roll", "pitch", "yaw", "angle"
    SMALLEST, LARGEST, NEAREST = "smallest element", "largest element", "nearest element"
    SUM, MEAN, MEDIAN, LENGTH = "sum of elements", "mean of elements", "median of elements", "number of elements"
    COMPLETE = "number of elements, none of which is NaN"
    TO_DOUBLE = "nearest double"
    TO_SIGNED, TO_UNSIGNED = "the same integer in 64 bits", "the same integer in 64 bits without a sign"
    LESS, AT_MOST, EQUAL, SAME = "less", "at most", "equal", "the same"
    NOT, AND, OR = "not", "and", "or"
    MEASURED = "not NaN"


class Nan(Enum):
    """What NaN does to a result."""

    NEVER = "the result is never NaN"
    STRICT = "the result is NaN exactly if an argument is"
    PARTIAL = "the result is NaN if an argument is, and for some arguments that are not"
    SKIPS = "elements that are NaN do not count; the result is NaN if none is left"
    FALSE = "false of NaN"


class Exactness(Enum):
    """In what two targets can differ."""

    EXACT = "the same value everywhere"
    ROUNDED = "correctly rounded, so the same double everywhere"
    LIBRARY = "as the platform's mathematical functions: the last bit may differ"


class Infix(NamedTuple):
    """`left operator right`, of any number of operands if it groups to the left; of comparisons, `opposite` negates."""

    operator: str
    opposite: str = ""


class Order(NamedTuple):
    """`function(left, right) operator 0.0`, or with sides exchanged: the function orders numbers of two types."""

    function: str
    operator: str
    opposite: str
    is_mirrored: bool


class Prefix(NamedTuple):
    """An operator in front of its operand."""

    operator: str


class Function(NamedTuple):
    """A function of all arguments."""

    name: str


class Folded(NamedTuple):
    """A function of two, from left to right: `f(f(a, b), c)`."""

    name: str


class OfArray(NamedTuple):
    """A function, the last of whose arguments is an array.

    It has the name of the elements' type behind its own where the target has one for each type.
    """

    name: str


class Components(NamedTuple):
    """A function of doubles as one array; `counted`: and of how many these are."""

    name: str
    counted: bool = False


class Quotient(NamedTuple):
    """`/` where the divisor is a constant other than 0, else a function."""

    name: str


class Member(NamedTuple):
    """A member of an array, made a double."""

    name: str


class AtMostInfinite(NamedTuple):
    """The argument is at most infinite, which is so of every number and not of NaN."""


class Silent(NamedTuple):
    """No text: the target does it by itself."""


class OfDoubles(NamedTuple):
    """Of integers of any size, which the target lacks, but of the doubles nearest to them: where one is wanted.

    What is spelled so grows with its arguments, so rounding them first gives the same double.
    """

    spelling: Prefix | Function | Folded | OfArray


Spelling = (
    Infix
    | Order
    | Prefix
    | Function
    | Folded
    | OfArray
    | Components
    | Quotient
    | Member
    | AtMostInfinite
    | Silent
    | OfDoubles
)
Types = tuple[Type, ...]
Choice = Callable[[Types], Spelling | None]
"""How it is spelled for arguments of these types; None if the target cannot."""
Typed = Callable[[Types], Type | None]
"""The type of the result for arguments of these; None if it takes no such."""


@dataclass(frozen=True, slots=True)
class Row:
    """A primitive; `of` is the function of the language that it computes, of arguments of these types."""

    typed: Typed
    nan: Nan
    exactness: Exactness
    python: Choice
    c: Choice
    of: Named | None = None


def _always(spelling: Spelling) -> Choice:
    return lambda types: spelling


def _doubles(least: int, most: int | None = None) -> Typed:
    def typed(types: Types) -> Type | None:
        is_count = least <= len(types) and (most is None or len(types) <= most)
        return DOUBLE if is_count and set(types) <= {DOUBLE} else None

    return typed


def _kept(types: Types) -> Type | None:
    """Of one double or binary32, the same; of one wide integer, an integer."""
    if len(types) != 1 or types[0].is_array:
        return None
    return INTEGER if types[0].scalar.is_wide else types[0] if types[0] in (DOUBLE, SINGLE) else None


def _extreme(types: Types) -> Type | None:
    """Of several doubles, a double; with wide integers among them, an integer: doubles beside these are integers."""
    if len(types) < 2 or any(t.is_array for t in types):
        return None
    if set(types) == {DOUBLE}:
        return DOUBLE
    are_exact = all(t.scalar.is_integer or t == DOUBLE for t in types) and any(t.scalar.is_wide for t in types)
    return INTEGER if are_exact else None


def _of_numbers(types: Types) -> Type | None:
    return DOUBLE if len(types) == 1 and types[0].is_array and types[0].scalar.is_number else None


def _among(types: Types) -> Type | None:
    """Of a double and an array of numbers."""
    return _of_numbers(types[1:]) if types[:1] == (DOUBLE,) else None


def _extreme_element(types: Types) -> Type | None:
    found = _of_numbers(types)
    return INTEGER if found and types[0].scalar.is_wide else found


def _length(types: Types) -> Type | None:
    return DOUBLE if len(types) == 1 and types[0].is_array else None


def _nearest(types: Types) -> Type | None:
    return DOUBLE if len(types) == 1 and types[0].is_number and types[0] != DOUBLE else None


def _widened(result: Type) -> Typed:
    def typed(types: Types) -> Type | None:
        if len(types) != 1 or types[0].is_array or types[0] == result:
            return None
        scalar = types[0].scalar
        fits = scalar.is_unsigned or (result == SIGNED and scalar.bits > 0)
        return result if fits and scalar is not Scalar.UINT64 else None

    return typed


def _compared(types: Types) -> Type | None:
    """Of two numbers of one type; or exactly, of a wide integer and another number."""
    if len(types) != 2 or not all(t.is_number for t in types):
        return None
    return BOOL if types[0] == types[1] or any(t.scalar.is_wide for t in types) else None


def _same(types: Types) -> Type | None:
    return BOOL if len(types) == 2 and types[0] == types[1] and types[0] in (BOOL, Type(Scalar.TEXT)) else None


def _logic(count: int | None = None) -> Typed:
    return lambda types: BOOL if set(types) == {BOOL} and count in (None, len(types)) else None


def _measured(types: Types) -> Type | None:
    return BOOL if len(types) == 1 and types[0].is_number else None


def _in_c(spelling: Prefix | Function | Folded | OfArray) -> Choice:
    """C has no integers of any size."""
    return lambda types: OfDoubles(spelling) if any(t.scalar.is_wide for t in types) else spelling


def _order_in_c(operator: str, opposite: str) -> Choice:
    """Numbers of one type by an operator, of two by a function, which needs a type that both have, or one of each."""
    functions = {
        (UNSIGNED, DOUBLE): "order_unsigned",
        (SIGNED, DOUBLE): "order_signed",
        (SIGNED, UNSIGNED): "order_integers",
    }

    def choose(types: Types) -> Spelling | None:
        left, right = types
        if INTEGER in types:
            return None
        if left == right:
            return Infix(operator, opposite)
        if (left, right) in functions:
            return Order(functions[left, right], operator, opposite, is_mirrored=False)
        if (right, left) in functions:
            return Order(functions[right, left], MIRRORED[operator], MIRRORED[opposite], is_mirrored=True)
        return None

    return choose


MIRRORED = {"<": ">", "<=": ">=", ">": "<", ">=": "<=", "==": "==", "!=": "!="}


def _comparison(operator: str, opposite: str) -> Row:
    infix = Infix(operator, opposite)
    return Row(_compared, Nan.FALSE, Exactness.EXACT, _always(infix), _order_in_c(operator, opposite))


def _arithmetic(operator: str) -> Row:
    infix = Infix(operator)
    return Row(_doubles(2, 2), Nan.PARTIAL, Exactness.ROUNDED, _always(infix), _always(infix))


def _row(of: Named, nan: Nan, exactness: Exactness, python: Spelling, c: Spelling, typed: Typed | None = None) -> Row:
    """A function that is spelled alike whatever it takes; that is as many doubles as it does, unless `typed` says."""
    return Row(typed or _doubles(of.takes.least, of.takes.most), nan, exactness, _always(python), _always(c), of)


def _angle(of: Named) -> Row:
    return _row(of, Nan.PARTIAL, Exactness.LIBRARY, Function(of.value), Components(of.value))


def _of_some(of: Named, nan: Nan, exactness: Exactness, name: str = "") -> Row:
    """A function of doubles that Python and C call by one name."""
    return _row(of, nan, exactness, Function(name or of.value), Function(name or of.value))


def _of_elements(of: Named, nan: Nan) -> Row:
    """A function of the numbers of an array, rounded once."""
    return _row(of, nan, Exactness.ROUNDED, Function(f"{of.value}_of"), OfArray(of.value), _of_numbers)


def _of_zone(of: Named, exactness: Exactness) -> Row:
    return _row(of, Nan.STRICT, exactness, Function(f"{of.value}_of"), Components(of.value, counted=True))


def _extreme_row(name: str, of: Named) -> Row:
    return Row(_extreme, Nan.STRICT, Exactness.EXACT, _always(Function(name)), _in_c(Folded(name)), of)


def _extreme_element_row(name: str, of: Named) -> Row:
    found = OfArray(name)
    return Row(_extreme_element, Nan.SKIPS, Exactness.EXACT, _always(found), _in_c(found), of)


def _to_double_in_python(types: Types) -> Spelling:
    """Other numbers are floats already."""
    return Function("float") if types[0].scalar.is_wide else Silent()


def _absolute_in_c(types: Types) -> Spelling | None:
    return _in_c(Function("fabsf" if types[0] == SINGLE else "fabs"))(types)


def _same_in_c(types: Types) -> Spelling:
    return Function("same_text") if types[0].scalar is Scalar.TEXT else Infix("==", "!=")


P = Primitive

ROWS: dict[Primitive, Row] = {
    P.NEGATE: Row(_kept, Nan.STRICT, Exactness.EXACT, _always(Prefix("-")), _in_c(Prefix("-"))),
    P.ABS: Row(_kept, Nan.STRICT, Exactness.EXACT, _always(Function("abs")), _absolute_in_c, Named.ABS),
    P.ADD: _arithmetic("+"),
    P.SUBTRACT: _arithmetic("-"),
    P.TIMES: _arithmetic("*"),
    P.OVER: Row(_doubles(2, 2), Nan.PARTIAL, Exactness.ROUNDED, _always(Quotient("divide")), _always(Infix("/"))),
    P.LEAST: _extreme_row("least", Named.MIN),
    P.GREATEST: _extreme_row("greatest", Named.MAX),
    P.SQRT: _row(Named.SQRT, Nan.PARTIAL, Exactness.ROUNDED, Function("square_root"), Function("sqrt")),
    P.FLOOR: _of_some(Named.FLOOR, Nan.STRICT, Exactness.EXACT, "rounded_down"),
    P.CEIL: _of_some(Named.CEIL, Nan.STRICT, Exactness.EXACT, "rounded_up"),
    P.SIGN: _of_some(Named.SIGN, Nan.STRICT, Exactness.EXACT, "sign_of"),
    P.MOD: _of_some(Named.MOD, Nan.PARTIAL, Exactness.ROUNDED, "modulo"),
    P.EXP: _of_some(Named.EXP, Nan.STRICT, Exactness.LIBRARY),
    P.LOG: _of_some(Named.LOG, Nan.PARTIAL, Exactness.LIBRARY),
    P.SIN: _of_some(Named.SIN, Nan.PARTIAL, Exactness.LIBRARY),
    P.COS: _of_some(Named.COS, Nan.PARTIAL, Exactness.LIBRARY),
    P.TAN: _of_some(Named.TAN, Nan.PARTIAL, Exactness.LIBRARY),
    P.ASIN: _of_some(Named.ASIN, Nan.PARTIAL, Exactness.LIBRARY),
    P.ACOS: _of_some(Named.ACOS, Nan.PARTIAL, Exactness.LIBRARY),
    P.ATAN2: _of_some(Named.ATAN2, Nan.STRICT, Exactness.LIBRARY),
    P.ANGLE_BETWEEN: _of_some(Named.ANGLE_BETWEEN, Nan.PARTIAL, Exactness.ROUNDED),
    P.GAP: _of_some(Named.GAP, Nan.STRICT, Exactness.ROUNDED),
    P.NORM: _row(Named.NORM, Nan.STRICT, Exactness.ROUNDED, Function("norm"), Components("norm", True)),
    P.INSIDE: _of_zone(Named.INSIDE, Exactness.EXACT),
    P.DISTANCE: _of_zone(Named.DISTANCE, Exactness.ROUNDED),
    P.ROLL: _angle(Named.ROLL),
    P.PITCH: _angle(Named.PITCH),
    P.YAW: _angle(Named.YAW),
    P.ANGLE: _angle(Named.ANGLE),
    P.SMALLEST: _extreme_element_row("smallest", Named.MIN),
    P.LARGEST: _extreme_element_row("largest", Named.MAX),
    P.SUM: _of_elements(Named.SUM, Nan.PARTIAL),
    P.NEAREST: Row(
        _among,
        Nan.PARTIAL,
        Exactness.EXACT,
        _always(Function("nearest_of")),
        _always(OfArray("nearest")),
        Named.NEAREST,
    ),
    P.MEAN: _of_elements(Named.MEAN, Nan.SKIPS),
    P.MEDIAN: _of_elements(Named.MEDIAN, Nan.SKIPS),
    P.COMPLETE: _row(
        *(Named.COMPLETE, Nan.PARTIAL, Exactness.EXACT),
        *(Function("complete"), OfArray("complete"), _of_numbers),
    ),
    P.LENGTH: _row(Named.LEN, Nan.NEVER, Exactness.EXACT, Function("length_of"), Member("length"), _length),
    P.TO_DOUBLE: Row(_nearest, Nan.STRICT, Exactness.ROUNDED, _to_double_in_python, _always(Prefix("(double)"))),
    P.TO_SIGNED: Row(_widened(SIGNED), Nan.NEVER, Exactness.EXACT, _always(Silent()), _always(Prefix("(int64_t)"))),
    P.TO_UNSIGNED: Row(
        _widened(UNSIGNED), Nan.NEVER, Exactness.EXACT, _always(Silent()), _always(Prefix("(uint64_t)"))
    ),
    P.LESS: _comparison("<", ">="),
    P.AT_MOST: _comparison("<=", ">"),
    P.EQUAL: _comparison("==", "!="),
    P.SAME: Row(_same, Nan.NEVER, Exactness.EXACT, _always(Infix("==", "!=")), _same_in_c),
    P.NOT: Row(_logic(1), Nan.NEVER, Exactness.EXACT, _always(Prefix("not ")), _always(Prefix("not "))),
    P.AND: Row(_logic(), Nan.NEVER, Exactness.EXACT, _always(Infix("and")), _always(Infix("and"))),
    P.OR: Row(_logic(), Nan.NEVER, Exactness.EXACT, _always(Infix("or")), _always(Infix("or"))),
    P.MEASURED: Row(_measured, Nan.FALSE, Exactness.EXACT, _always(AtMostInfinite()), _always(AtMostInfinite())),
}


def primitive_of(function: Named, types: Types) -> Primitive:
    """What computes a function of the language of arguments of these types; each is found once in the table."""
    (found,) = (primitive for primitive, row in ROWS.items() if row.of is function and row.typed(types) is not None)
    return found
