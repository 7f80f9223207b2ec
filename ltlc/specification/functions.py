"""The functions of expressions: what each takes and is, and how authors write it."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple


class Takes(NamedTuple):
    """What a function takes, in words: so many numbers, at least and at most, or one array, or either."""

    words: str
    least: int = 0
    most: int | None = 0
    array: bool = False


ONE = Takes("one number", 1, 1)
SEVERAL = Takes("two or more numbers, or one array", 2, None, array=True)
ARRAY = Takes("one array", array=True)
NUMBERS = Takes("one array of numbers", array=True)


class Function(Enum):
    """What a `Call` computes, a number of numbers. Angles are radians, orientations unit quaternions x, y, z, w.

    A function is its name, what it `takes`, and, if authors can call it, the `form` in which they do, what that says,
    and what it gives of one value, a noun. Primitives of objects are computed by the others.
    """

    _value_: str
    takes: Takes
    form: str
    says: str
    noun: str

    def __new__(cls, name: str, takes: Takes, form: str = "", says: str = "", noun: str = "") -> Function:
        """A function called `name`."""
        found = object.__new__(cls)
        found._value_, found.takes, found.form, found.says, found.noun = name, takes, form, says, noun
        return found

    ABS = "abs", ONE, "abs(x)", "the absolute value", "absolute value"
    """The absolute value of one number."""
    MIN = "min", SEVERAL, "min(a)", "the smallest element of an array, or number of several", "smallest"
    """The smallest of two or more numbers, or of those elements of one array that are not NaN; of none: NaN."""
    MAX = "max", SEVERAL, "max(a)", "the largest element of an array, or number of several", "largest"
    """The largest of two or more numbers, or of those elements of one array that are not NaN; of none: NaN."""
    SQRT = "sqrt", ONE, "sqrt(x)", "the square root; of a negative number there is none", "square root"
    """The square root of one number; of a negative one: NaN."""
    SUM = "sum", NUMBERS, "sum(a)", "the sum of the elements, each the nearest double, rounded once; of none, 0", "sum"
    """The double nearest to the sum of the elements of one array, 0.0 of none; NaN if one is, or if it has no sum."""
    MEDIAN = (
        *("median", NUMBERS, "median(a)"),
        *("the middle element by size, of an even number the mean of the middle two", "median"),
    )
    """The middle by size of those elements of one array that are not NaN, each as the nearest double; of none: NaN.

    Of an even number, the double nearest to the mean of the middle two. It is never -0.0.
    """
    LEN = "len", ARRAY, "len(a)", "how many elements there are", "length"
    """How many elements one array has, those that are NaN included."""
    GAP = "gap", Takes("two numbers", 2, 2)
    """The first of two numbers less the second; 0 where they are equal, be they infinite."""
    NORM = "norm", Takes("two or three components", 2, 3)
    """The Euclidean norm of two or three components."""
    ROLL = "roll", Takes("an orientation", 4, 4)
    """The rotation about x of the orientation (x, y, z, w), −π … π; yaw, then pitch, then roll."""
    PITCH = "pitch", Takes("an orientation", 4, 4)
    """The rotation about y of the orientation (x, y, z, w), −π/2 … π/2."""
    YAW = "yaw", Takes("an orientation", 4, 4)
    """The rotation about z of the orientation (x, y, z, w), −π … π."""
    ANGLE = "angle", Takes("two orientations", 8, 8)
    """The angle of the rotation between two orientations (x, y, z, w, x, y, z, w), 0 … π."""


WRITTEN = {function.value: function for function in Function if function.form}
"""Those that authors can call, by their names."""
