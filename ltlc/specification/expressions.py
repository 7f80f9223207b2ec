"""Typed expressions and signals: what the numbers, booleans and strings of a specification are computed from.

The one definition of a signal: the type checker makes it, the live node, the replay and the solver read it.
Vectors do not occur here: the resolver writes them out as their components.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum


class ValueType(Enum):
    """What a value is. Numbers are IEEE doubles."""

    NUMBER = "number"
    BOOLEAN = "boolean"
    STRING = "string"
    NUMBERS = "array of numbers"


@dataclass(frozen=True, slots=True)
class Match:
    """In a path, after a list of messages: the first element whose field `key` is the string `value`.

    `tf2_msgs/TFMessage.transforms` has its entries told apart by `child_frame_id`.
    """

    key: str
    value: str


@dataclass(frozen=True, slots=True)
class Parallel:
    """In a path, after a list: the element at the index at which the message's list `names` has the string `value`.

    `gazebo_msgs/ModelStates` has the lists `name`, `pose` and `twist`, which belong together.
    """

    names: str
    value: str


PathStep = str | int | Match | Parallel
"""One step from a message to a value in it: a field, the index of an array element, or an entry found by name."""


@dataclass(frozen=True, slots=True)
class Field:
    """A value in the messages of a topic.

    `topic` is absolute or private (`/odom`, `~/x`), `message` a full name (`nav_msgs/msg/Odometry`). A message in which
    `path` leads nowhere (no such entry, array too short) carries no sample of it.
    """

    topic: str
    message: str
    path: tuple[PathStep, ...]


@dataclass(frozen=True, slots=True)
class Signal:
    """A named value that changes over time, with where it comes from.

    `name` is how the author writes it (`robot.velocity`, `robot_position.x`), and how a recording's column is headed.
    `definition` is a field of a topic's messages, or an expression over other signals; a recording may give the signal
    itself instead. Two signals of one specification with the same name are equal.
    """

    name: str
    type: ValueType
    definition: Field | Expression

    def __hash__(self) -> int:
        return hash(self.name)


class Expression:
    """An expression with one value at each step; it is invalid where its value is NaN."""

    __slots__ = ()


@dataclass(frozen=True, slots=True, eq=False)
class Number(Expression):
    """A constant number. Equal numbers are the same double: 1 / (x * 0) and 1 / (x * -0) are different expressions."""

    value: float

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Number) and repr(float(self.value)) == repr(float(other.value))

    def __hash__(self) -> int:
        return hash(repr(float(self.value)))


@dataclass(frozen=True, slots=True)
class Boolean(Expression):
    """`true` or `false`."""

    value: bool


@dataclass(frozen=True, slots=True)
class String(Expression):
    """A constant string."""

    value: str


@dataclass(frozen=True, slots=True)
class Current(Expression):
    """The latest sample of `signal`."""

    signal: Signal


@dataclass(frozen=True, slots=True)
class Past(Expression):
    """`@{signal, -samples}`: the sample of `signal` that many samples of it ago; `samples` is at least 1."""

    signal: Signal
    samples: int


@dataclass(frozen=True, slots=True)
class Slope(Expression):
    """The difference quotient of the last two samples of `signal` over time, per second.

    A speed where the simulation only tells positions. Invalid if the two samples have the same time.
    """

    signal: Signal


@dataclass(frozen=True, slots=True)
class New(Expression):
    """`new signal`, a boolean: whether a message on the topic of `signal` arrived at this very instant.

    Under a rate: since the tick before.
    """

    signal: Signal


Input = Current | Past | Slope | New
"""What is taken from the samples and messages of a signal."""


class Function(Enum):
    """What a `Call` computes, a number of numbers. Angles are radians, orientations unit quaternions x, y, z, w."""

    ABS = "abs"
    """The absolute value of one number."""
    MIN = "min"
    """The smallest of two or more numbers, or of one array; of an empty array: NaN."""
    MAX = "max"
    """The largest of two or more numbers, or of one array; of an empty array: NaN."""
    SQRT = "sqrt"
    """The square root of one number; of a negative one: NaN."""
    NORM = "norm"
    """The Euclidean norm of two or three components."""
    ROLL = "roll"
    """The rotation about x of the orientation (x, y, z, w), −π … π; yaw, then pitch, then roll."""
    PITCH = "pitch"
    """The rotation about y of the orientation (x, y, z, w), −π/2 … π/2."""
    YAW = "yaw"
    """The rotation about z of the orientation (x, y, z, w), −π … π."""
    ANGLE = "angle"
    """The angle of the rotation between two orientations (x, y, z, w, x, y, z, w), 0 … π."""


class Operator(Enum):
    """Arithmetic as in IEEE 754: `1 / 0` is infinite and `0 / 0` is NaN."""

    PLUS = "+"
    MINUS = "-"
    TIMES = "*"
    OVER = "/"


@dataclass(frozen=True, slots=True)
class Negative(Expression):
    """`-operand`."""

    operand: Expression


@dataclass(frozen=True, slots=True)
class Arithmetic(Expression):
    """`left operator right` on numbers."""

    operator: Operator
    left: Expression
    right: Expression


@dataclass(frozen=True, slots=True)
class Call(Expression):
    """`function` of `arguments`."""

    function: Function
    arguments: tuple[Expression, ...]


def children(expression: Expression) -> tuple[Expression, ...]:
    """The immediate parts of `expression`; what a signal is computed from is not a part of it."""
    match expression:
        case Negative(operand):
            return (operand,)
        case Arithmetic(_, left, right):
            return (left, right)
        case Call(_, arguments):
            return arguments
        case _:
            return ()


def subexpressions(expression: Expression) -> Iterator[Expression]:
    """`expression` and all that is inside it, outermost and leftmost first, with repetitions."""
    yield expression
    for child in children(expression):
        yield from subexpressions(child)


def inputs(expression: Expression) -> Iterator[Input]:
    """The values of signals that `expression` is computed from, left to right, with repetitions."""
    return (part for part in subexpressions(expression) if isinstance(part, Input))
