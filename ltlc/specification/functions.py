"""The functions of expressions: what each takes and is, and how authors write it."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple


class Takes(NamedTuple):
    """What a function takes, in words: so many numbers, at least and at most, or one array, or either.

    What looks `among` elements takes one number, then an array. Of a `zone`, the numbers are the coordinates of a point
    and of three or more corners.
    """

    words: str
    least: int = 0
    most: int | None = 0
    array: bool = False
    zone: bool = False
    among: bool = False


ONE = Takes("one number", 1, 1)
TWO = Takes("two numbers", 2, 2)
SEVERAL = Takes("two or more numbers, or one array", 2, None, array=True)
ARRAY = Takes("one array", array=True)
OF_A_ZONE = Takes("a point, or its x and y, and a zone", 8, None, zone=True)
AMONG = Takes("one number and one array of numbers", among=True)
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
    SQRT = "sqrt", ONE, "sqrt(x)", "the square root, of a number that is not negative", "square root"
    """The square root of one number; of a negative one: NaN."""
    SUM = (
        "sum",
        NUMBERS,
        "sum(a)",
        "the sum of the elements, each the nearest double, rounded once; 0 if there are none",
        "sum",
    )
    """The double nearest to the sum of the elements of one array, 0.0 of none; NaN if one is, or if it has no sum."""
    MEDIAN = (
        *("median", NUMBERS, "median(a)"),
        *("the middle element by size; of an even number, the mean of the middle two", "median"),
    )
    """The middle by size of those elements of one array that are not NaN, each as the nearest double; of none: NaN.

    Of an even number, the double nearest to the mean of the middle two. It is never -0.0.
    """
    MEAN = "mean", NUMBERS, "mean(a)", "the sum of the elements, divided by their number", "mean"
    """The sum of those elements of one array that are not NaN, as `SUM` has it, by how many these are; of none: NaN."""
    NEAREST = "nearest", AMONG, "nearest(x, a)", "the first of the elements that differ least from x"
    """The element of an array, as a double, that differs least from a number; the first of several.

    Elements that are NaN are omitted; of none: NaN. Differences are those of `GAP`, in doubles, without their sign.
    """
    LEN = "len", ARRAY, "len(a)", "the number of elements", "length"
    """How many elements one array has, those that are NaN included."""
    COMPLETE = "complete", NUMBERS
    """How many elements one array has; NaN if one of them is."""
    FLOOR = "floor", ONE, "floor(x)", "the largest integer that is not greater", "floor"
    """The largest integer that is not greater than a number, never -0.0; an infinite number itself."""
    CEIL = "ceil", ONE, "ceil(x)", "the smallest integer that is not less", "ceiling"
    """The smallest integer that is not less than a number, never -0.0; an infinite number itself."""
    SIGN = "sign", ONE, "sign(x)", "1 if positive, −1 if negative, 0 if zero", "sign"
    """1.0 of a number above 0, -1.0 of one below, 0.0 of 0."""
    MOD = "mod", TWO, "mod(x, y)", "the remainder of x divided by y, with the sign of y"
    """The first of two numbers less the largest multiple of the second that leaves 0 or a number of its sign, rounded.

    Never -0.0. NaN by 0 and of an infinite number; by an infinite one of the other sign, that one.
    """
    EXP = "exp", ONE, "exp(x)", "e to the power of x", "exponential"
    """e to the power of one number."""
    LOG = "log", ONE, "log(x)", "the natural logarithm, of 0 −∞", "logarithm"
    """The natural logarithm of one number; of 0 -∞, of a negative one NaN."""
    SIN = "sin", ONE, "sin(x)", "the sine of an angle in rad", "sine"
    """The sine of one number; of an infinite one NaN."""
    COS = "cos", ONE, "cos(x)", "the cosine of an angle in rad", "cosine"
    """The cosine of one number; of an infinite one NaN."""
    TAN = "tan", ONE, "tan(x)", "the tangent of an angle in rad", "tangent"
    """The tangent of one number; of an infinite one NaN."""
    ASIN = "asin", ONE, "asin(x)", "the angle, −π/2 … π/2, with this sine", "arc sine"
    """The angle from -π/2 to π/2 with this sine; of a number beyond 1 and -1 NaN."""
    ACOS = "acos", ONE, "acos(x)", "the angle, 0 … π, with this cosine", "arc cosine"
    """The angle from 0 to π with this cosine; of a number beyond 1 and -1 NaN."""
    ATAN2 = "atan2", TWO, "atan2(y, x)", "the angle, −π … π, of the direction (x, y)"
    """The angle from -π to π of the direction (x, y), given y and x, as in IEEE 754."""
    ANGLE_BETWEEN = "angle_between", TWO, "angle_between(a, b)", "how far apart two directions are, 0 … π, in rad"
    """The angle from 0 to π between the directions with two angles; if one is infinite, or their difference, NaN."""
    INSIDE = "inside", OF_A_ZONE, "inside(x, y, ZONE)", "the point lies in the zone, or on its border"
    """1.0 if the point of the first two numbers lies in the polygon of the others, decided exactly; else 0.0."""
    DISTANCE = "distance", OF_A_ZONE, "distance(x, y, ZONE)", "the distance of the point from the zone, 0 inside"
    """The distance of the point of the first two numbers from the polygon of the others, in doubles; inside 0.0."""
    GAP = "gap", TWO
    """The first of two numbers less the second; 0 where they are equal, be they infinite."""
    NORM = "hypot", Takes("two or three numbers", 2, 3), "hypot(x, y)", "the length of the vector (x, y), or (x, y, z)"
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

INSIDE = Function.INSIDE.value
"""The one function that is a predicate."""
