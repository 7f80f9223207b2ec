"""Types of values as programs compute with them: those of the fields of messages, and exact integers of any size."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

from ltlc.specification.expressions import Field, Signal, ValueType
from ltlc.specification.wire import PRIMITIVES, Kind, Numbers


class Scalar(Enum):
    """What one value is: what a field holds, or INTEGER, an integer of any size."""

    BOOL, TEXT, INTEGER = "bool", "string", "integer"
    INT8, INT16, INT32, INT64 = "int8", "int16", "int32", "int64"
    UINT8, UINT16, UINT32, UINT64 = "uint8", "uint16", "uint32", "uint64"
    SINGLE, DOUBLE = "float32", "float64"

    @property
    def bits(self) -> int:
        """How many bits a field of integers has; 0 of what is no such field."""
        return int(self.value.removeprefix("u").removeprefix("int")) if self in _FIELDS else 0

    @property
    def is_unsigned(self) -> bool:
        """Whether it is a field of integers that are not negative."""
        return self in _FIELDS and self.value.startswith("u")

    @property
    def is_integer(self) -> bool:
        """Whether its values are integers."""
        return self is Scalar.INTEGER or self in _FIELDS

    @property
    def is_wide(self) -> bool:
        """Whether some of its values are integers and no doubles."""
        return self in (Scalar.INTEGER, Scalar.INT64, Scalar.UINT64)

    @property
    def is_number(self) -> bool:
        """Whether its values are numbers."""
        return self not in (Scalar.BOOL, Scalar.TEXT)

    @property
    def integers(self) -> Numbers | None:
        """The integers that a field of them can hold; None of what is no such field."""
        return PRIMITIVES[self.value] if self in _FIELDS else None


_FIELDS = frozenset(s for s in Scalar if s.value.removeprefix("u").removeprefix("int").isdecimal())
_BY_NUMBERS = {PRIMITIVES[s.value]: s for s in _FIELDS}


class Type(NamedTuple):
    """A scalar, or an array of such."""

    scalar: Scalar
    is_array: bool = False

    @property
    def element(self) -> Type:
        """The type of the elements of an array."""
        return Type(self.scalar)

    @property
    def is_number(self) -> bool:
        """Whether a value is one number."""
        return self.scalar.is_number and not self.is_array


BOOL, TEXT, INTEGER, SINGLE, DOUBLE = map(
    Type, (Scalar.BOOL, Scalar.TEXT, Scalar.INTEGER, Scalar.SINGLE, Scalar.DOUBLE)
)
SIGNED, UNSIGNED = Type(Scalar.INT64), Type(Scalar.UINT64)


def type_of(signal: Signal) -> Type:
    """The type of the samples of `signal`: that of its field, or of what it is computed as."""
    return Type(_scalar(signal.type.element or signal.type, signal.numbers), signal.type.element is not None)


def recent_of(signal: Signal) -> Type:
    """The type of the last samples of `signal`, which is no array, as one."""
    return type_of(signal)._replace(is_array=True)


def kept_as(signal: Signal) -> Type:
    """The type in which samples of `signal` are kept: numbers that are computed are doubles."""
    is_computed = not isinstance(signal.definition, Field) and not signal.is_taken
    return DOUBLE if is_computed and signal.type is ValueType.NUMBER else type_of(signal)


def _scalar(single: ValueType, numbers: Numbers) -> Scalar:
    if single is ValueType.BOOLEAN:
        return Scalar.BOOL
    if single is ValueType.STRING:
        return Scalar.TEXT
    if numbers.kind is Kind.INTEGER:
        return _BY_NUMBERS[numbers]
    return Scalar.SINGLE if numbers.kind is Kind.SINGLE else Scalar.DOUBLE
