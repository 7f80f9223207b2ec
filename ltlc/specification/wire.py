"""Numbers as they are on the wire: which values a number in a message can have, in their order."""

from __future__ import annotations

import math
from enum import Enum
from struct import Struct

from ltlc.dataclass import dataclass

EXACT = 2**53
"""Up to here, and down to minus this, every integer is a double."""


class Kind(Enum):
    """What numbers there are between any two."""

    DOUBLE = "IEEE binary64"
    SINGLE = "IEEE binary32"
    """All of these are doubles."""
    INTEGER = "integer"


_DOUBLE, _SINGLE = (Struct(">d"), Struct(">Q")), (Struct(">f"), Struct(">I"))
"""A number and its bits: those of what is not negative are its rank."""


@dataclass(frozen=True, slots=True)
class Numbers:
    """The numbers of a kind from `least` to `most`, which are two of them; NaN is none.

    Each has a *rank*: neighbours have neighbouring ranks, that of 0 and of -0.0 is 0. An integer is its own.
    """

    kind: Kind
    least: float = -math.inf
    most: float = math.inf

    @property
    def is_wide(self) -> bool:
        """Whether some are integers and no doubles: their values are `int`, which compare exactly, others `float`."""
        return self.kind is Kind.INTEGER and (self.least < -EXACT or self.most > EXACT)

    def between(self, least: float, most: float) -> Numbers:
        """Those of the same kind from `least` to `most`."""
        return Numbers(self.kind, least, most)

    def has(self, value: float) -> bool:
        """Whether `value` is one of them."""
        if not self.least <= value <= self.most:
            return False
        return value % 1 == 0 if self.kind is Kind.INTEGER else self.nearest(value) == value

    def nearest(self, value: float) -> float:
        """The one nearest to `value`, of integers the even one of two; for NaN itself, or 0 of integers."""
        if self.kind is not Kind.INTEGER:
            return as_double(value) if self.kind is Kind.DOUBLE else _single(as_double(value))
        within = 0 if value != value else round(max(self.least, min(self.most, value)))
        return within if self.is_wide else float(within)

    def rank(self, value: float) -> int:
        """The rank of the largest number of the kind that is not above `value`; integers are asked for finite ones."""
        if self.kind is Kind.INTEGER:
            return math.floor(value)
        number, bits = _DOUBLE if self.kind is Kind.DOUBLE else _SINGLE
        nearest = self.nearest(value)
        rank: int = bits.unpack(number.pack(abs(nearest)))[0]
        return (rank if nearest > 0 else -rank) - (nearest > value)

    def at(self, rank: int) -> float:
        """The number with that rank."""
        if self.kind is Kind.INTEGER:
            return rank if self.is_wide else float(rank)
        number, bits = _DOUBLE if self.kind is Kind.DOUBLE else _SINGLE
        value: float = number.unpack(bits.pack(abs(rank)))[0]
        return value if rank >= 0 else -value


def as_double(value: float) -> float:
    """The double nearest to `value`; an integer beyond their range is infinite."""
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def _single(value: float) -> float:
    try:
        rounded: float = _SINGLE[0].unpack(_SINGLE[0].pack(value))[0]
    except OverflowError:
        return math.copysign(math.inf, value)
    return rounded


def double_or_integer(value: int) -> float:
    """`value` as a double if it is one, else as it is."""
    double = as_double(value)
    return double if double == value else value


DOUBLES, SINGLES = Numbers(Kind.DOUBLE), Numbers(Kind.SINGLE)


def _signed(bits: int) -> Numbers:
    return Numbers(Kind.INTEGER, -(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


def _unsigned(bits: int) -> Numbers:
    return Numbers(Kind.INTEGER, 0, 2**bits - 1)


PRIMITIVES = {
    **dict.fromkeys(("float64", "double", "float128"), DOUBLES),
    **dict.fromkeys(("float32", "float"), SINGLES),
    **{f"int{bits}": _signed(bits) for bits in (8, 16, 32, 64)},
    **{f"uint{bits}": _unsigned(bits) for bits in (8, 16, 32, 64)},
    **dict.fromkeys(("byte", "octet", "char"), _unsigned(8)),
}
"""The primitive types whose values are numbers. The 128 bits of `float128` reach Python as a double."""
