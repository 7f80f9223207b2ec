"""Types of emitted C, as far as reading it back depends on them: what a comparison or a conversion keeps exact."""

from __future__ import annotations

from dataclasses import dataclass

from ltlc.assurance.reading.language import Constant, NotUnderstoodError, Term
from ltlc.assurance.reading.meaning import Given
from ltlc.specification.expressions import Field, New, Slope, ValueType
from ltlc.specification.wire import Kind

INT, UNSIGNED, SIGNED_64, UNSIGNED_64 = "int", "unsigned", "int64_t", "uint64_t"
INTEGERS: dict[str, tuple[int, int]] = {
    **{f"int{bits}_t": (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) for bits in (8, 16, 32, 64)},
    **{f"uint{bits}_t": (0, 2**bits - 1) for bits in (8, 16, 32, 64)},
    INT: (-(2**31), 2**31 - 1),
    UNSIGNED: (0, 2**32 - 1),
}
"""The types of integers, with the least and the most that they have."""

NUMBERS = ("float", "double")
TEXT = "char *"


@dataclass(frozen=True, slots=True)
class Typed:
    """A term and its type in C."""

    term: Term
    type: str

    @property
    def is_integer(self) -> bool:
        """Whether it is of a type of integers."""
        return self.type in INTEGERS

    @property
    def within(self) -> tuple[int, int]:
        """Of an integer, the least and the most that it can be."""
        match self.term:
            case Constant(int(value)):
                return value, value
            case _:
                return INTEGERS[self.type]


def are_comparable(left: Typed, right: Typed) -> bool:
    """Whether C compares the two as what they are: what it converts them to has both."""
    if left.type in NUMBERS and right.type in NUMBERS:
        return True
    if left.is_integer and right.is_integer:
        least, most = INTEGERS[_common(left.type, right.type)]
        return all(least <= end <= most for side in (left, right) for end in side.within)
    return left.type == right.type and left.type in ("bool", "verdict")


def _common(left: str, right: str) -> str:
    """The type in which C compares two integers."""
    for wide in (UNSIGNED_64, SIGNED_64):
        if wide in (left, right):
            return wide
    return UNSIGNED if {UNSIGNED, "uint32_t"} & {left, right} else INT


def holds(type_: str, value: int) -> bool:
    """Whether a type of integers has `value`."""
    least, most = INTEGERS[type_]
    return least <= value <= most


def type_of(given: Given, prefix: str) -> str:
    """The type that what is read of a signal has to have; names of types of arrays begin with `prefix`."""
    read = given.read
    if isinstance(read, New):
        return "bool"
    single = _single(given)
    if read.signal.type.element is None:
        return single
    plural = "texts" if single == TEXT else single.removesuffix("_t") + "s"
    return f"{prefix}_{plural}"


def _single(given: Given) -> str:
    signal = given.read.signal
    match signal.type.element or signal.type:
        case ValueType.BOOLEAN:
            return "bool"
        case ValueType.STRING:
            return TEXT
        case _:
            return _number(given)


def _number(given: Given) -> str:
    signal = given.read.signal
    is_computed = isinstance(given.read, Slope) or not isinstance(signal.definition, Field)
    if is_computed and signal.type.element is None:
        return "double"
    if signal.numbers.kind is not Kind.INTEGER:
        return "float" if signal.numbers.kind is Kind.SINGLE else "double"
    for name, (least, most) in INTEGERS.items():
        if signal.numbers.least == least and signal.numbers.most == most:
            return name
    raise NotUnderstoodError(f"there is no type for `{signal.name}`")
