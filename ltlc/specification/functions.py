"""The functions that the language has: what each takes, and what it means in a line."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from ltlc.specification.expressions import Function


class Described(NamedTuple):
    """A function as authors know it: how it is written, what it says, and what it gives of one value, in a word.

    It takes numbers, at least and at most so many, where `numbers` says so; what it takes of arrays, `FOLDS` says.
    """

    form: str
    says: str
    noun: str
    numbers: tuple[int, int | None] | None = None


WRITTEN: Mapping[Function, Described] = {
    Function.ABS: Described("abs(x)", "the absolute value", "absolute value", (1, 1)),
    Function.MIN: Described("min(a)", "the smallest element of an array, or number of several", "smallest", (2, None)),
    Function.MAX: Described("max(a)", "the largest element of an array, or number of several", "largest", (2, None)),
    Function.SQRT: Described("sqrt(x)", "the square root; of a negative number there is none", "square root", (1, 1)),
    Function.SUM: Described(
        "sum(a)", "the sum of the elements, each the nearest double, rounded once; of none, 0", "sum"
    ),
    Function.MEDIAN: Described(
        "median(a)", "the middle element by size, of an even number the mean of the middle two", "median"
    ),
    Function.LEN: Described("len(a)", "how many elements there are", "length"),
}
"""The others have no name in the language: primitives of objects are computed by them."""

NAMES = tuple(function.value for function in WRITTEN)
