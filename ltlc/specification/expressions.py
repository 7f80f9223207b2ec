"""Typed expressions, signals and conditions: what the values of a specification are computed from, and asked.

The one definition of a signal: the type checker makes it, the live node, the replay and the solver read it.
Vectors do not occur here: the resolver writes them out as their components.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import field
from enum import Enum
from typing import assert_never

from ltlc.dataclass import dataclass
from ltlc.semantics.ltl import Formula
from ltlc.specification.functions import Function
from ltlc.specification.wire import DOUBLES, Numbers, double_or_integer


class ValueType(Enum):
    """The kind of a value. Numbers are IEEE doubles, or integers where some of these are not doubles."""

    NUMBER = "number"
    BOOLEAN = "boolean"
    STRING = "string"
    NUMBERS = "array of numbers"
    BOOLEANS = "array of booleans"
    STRINGS = "array of strings"

    @property
    def element(self) -> ValueType | None:
        """The kind of an array's elements; None for other values."""
        return _ELEMENTS.get(self)

    @property
    def array(self) -> ValueType:
        """An array of such. Raises ValueError of an array."""
        return ValueType(f"array of {self.value}s")


_ELEMENTS = {
    ValueType.NUMBERS: ValueType.NUMBER,
    ValueType.BOOLEANS: ValueType.BOOLEAN,
    ValueType.STRINGS: ValueType.STRING,
}


@dataclass(frozen=True, slots=True)
class Match:
    """In a path, after a list of messages: the first element whose field `key` is the string `value`.

    `tf2_msgs/TFMessage.transforms` has its entries distinguished by `child_frame_id`.
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


@dataclass(frozen=True, slots=True)
class Each:
    """In a path, after a list of messages: each of them: what follows makes an array. At most once in a path."""


@dataclass(frozen=True, slots=True)
class Bytes:
    """At the end of a path, after a `uint8` array of fixed length: these bytes as text, 16 of them as a UUID."""


@dataclass(frozen=True, slots=True)
class OfSlice:
    """In a path that no message has: the element of the array before that belongs to the id of a slice.

    At the end of one, `is_missing` says whether there is none.
    """

    is_missing: bool = False


PathStep = str | int | Match | Parallel | Each | Bytes | OfSlice
"""One step from a message to a value in it: a field, the index of an array element, an entry found by name, or all."""


@dataclass(frozen=True, slots=True)
class Field:
    """A value in the messages of a topic.

    `topic` is absolute or private (`/odom`, `~/x`), `message` a full name (`nav_msgs/msg/Odometry`). A message in which
    `path` leads nowhere (no such entry, array too short) carries no sample of it. Of a number, or of the elements of an
    array of them, `numbers` are the possible ones.
    """

    topic: str
    message: str
    path: tuple[PathStep, ...]
    numbers: Numbers = DOUBLES

    @property
    def list(self) -> Field:
        """The list that the elements of an array are in: itself, or the messages that it is a field of each of."""
        depth = self.path.index(Each()) if Each() in self.path else len(self.path)
        return Field(self.topic, self.message, self.path[:depth])

    def is_beside(self, other: Field) -> bool:
        """Whether two arrays are fields of one array of messages, or are side by side in a message."""
        if Each() in self.path or Each() in other.path:
            return self.list == other.list
        return self.topic == other.topic and self.path[:-1] == other.path[:-1]


@dataclass(frozen=True, slots=True)
class Signal:
    """A named value that changes over time, with where it comes from.

    `name` is how the author writes it (`robot.velocity`, `robot_position.x`), and how a recording's column is headed.
    `definition` is a field of a topic's messages, or an expression over other signals, which has a sample where one of
    these has, with `when` only where that holds; a recording may give the signal itself instead. Before its first
    sample it is `otherwise`, if that is not None. Two signals of one specification with the same name are equal. The
    component of a vector or an orientation has the name of the `whole`.
    """

    name: str
    type: ValueType
    definition: Field | Expression
    when: When | None = None
    otherwise: Number | Boolean | String | None = None
    whole: str = field(default="", compare=False)

    def __hash__(self) -> int:
        return hash(self.name)

    @property
    def heard(self) -> str:
        """The name that its messages go by."""
        return self.whole or self.name

    @property
    def is_message(self) -> bool:
        """Whether it is the messages of a topic, and no field of them: `true` at each."""
        return isinstance(self.definition, Field) and not self.definition.path

    @property
    def is_constant(self) -> bool:
        """Whether it is computed from nothing."""
        return not isinstance(self.definition, Field) and not self.inputs

    @property
    def is_taken(self) -> bool:
        """Whether its samples are some of those of another signal, as `@{s, when p}` and `@{s, -1 else 0}`."""
        return self.when is not None or self.otherwise is not None

    @property
    def numbers(self) -> Numbers:
        """The numbers that its value, or the elements of it, can be: what is computed is a double."""
        match self.definition:
            case Field():
                return self.definition.numbers
            case Current(signal) | Past(signal) if self.is_taken:
                return signal.numbers
            case _:
                return DOUBLES

    @property
    def inputs(self) -> tuple[Input, ...]:
        """What it is computed from, each once; of a field, nothing."""
        if isinstance(self.definition, Field):
            return ()
        asked = () if self.when is None else self.when.sides
        return tuple(dict.fromkeys(i for side in (self.definition, *asked) for i in inputs(side)))


@dataclass(frozen=True, slots=True)
class When:
    """Whether the state predicate `predicate` holds, over `conditions` by their names.

    Where it decides whether a signal has a sample, nothing that is compared may be NaN.
    """

    predicate: Formula
    conditions: tuple[tuple[str, Condition], ...]

    @property
    def sides(self) -> tuple[Expression, ...]:
        """What the conditions compare."""
        return tuple(side for _, condition in self.conditions for side in operands(condition))


@dataclass(frozen=True, slots=True, eq=False)
class Number:
    """A constant number: a double, or an integer that is not one. A `single` one is a binary32, and written as such.

    Equal numbers are the same: 1 / (x * 0) and 1 / (x * -0) are different expressions. If it was written as a constant
    of a message, `constants` are the values that go by such names there.
    """

    value: float
    single: bool = False
    constants: tuple[tuple[float, str], ...] = ()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Number) and self._exact == other._exact

    def __hash__(self) -> int:
        return hash(self._exact)

    @property
    def _exact(self) -> str:
        return repr(double_or_integer(self.value) if isinstance(self.value, int) else float(self.value))


@dataclass(frozen=True, slots=True)
class Boolean:
    """`true` or `false`."""

    value: bool


@dataclass(frozen=True, slots=True)
class String:
    """A constant string."""

    value: str


@dataclass(frozen=True, slots=True)
class Current:
    """The latest sample of `signal`."""

    signal: Signal


@dataclass(frozen=True, slots=True)
class Past:
    """`@{signal, -samples}`: the sample of `signal` that many samples of it ago; `samples` is at least 1."""

    signal: Signal
    samples: int


@dataclass(frozen=True, slots=True)
class Recent:
    """`@{signal, -samples:}`: the last samples of `signal` and the latest, oldest first, an array of `samples` + 1.

    A NaN among them makes no step.
    """

    signal: Signal
    samples: int


@dataclass(frozen=True, slots=True)
class Slope:
    """The difference quotient of the last two samples of `signal` over time, per second.

    The speed of an object of which only positions are known. Invalid if the two samples have the same time.
    """

    signal: Signal


@dataclass(frozen=True, slots=True)
class New:
    """`new signal`, a boolean: whether a message on the topic of `signal` arrived at this very instant.

    Under a rate: since the tick before.
    """

    signal: Signal


Input = Current | Past | Recent | Slope | New
"""What is taken from the samples and messages of a signal."""


@dataclass(frozen=True, slots=True)
class Opening:
    """`@{signal, opening}`: the value that `signal` had at the step at which the scope around it opened.

    At a step at which that scope is not open, and does not open, it is the latest sample. `scope` counts the keywords
    `after` and `after_until` of the property called `label`, in the order of its text, from 1; 0 is the whole run.
    """

    signal: Signal
    scope: int = 0
    label: str = ""


Read = Input | Opening
"""What an expression reads of signals."""


@dataclass(frozen=True, slots=True)
class Slice:
    """The elements of `array` from the index `start` up to, not including, `stop`, as in Python.

    A negative index counts from the end; None is the beginning, or the end. What is beyond the array is cut off.
    """

    array: Expression
    start: int | None
    stop: int | None


@dataclass(frozen=True, slots=True)
class Element:
    """An element of `array`: in the conditions of a `Count`, each one after the other."""

    array: Expression


class Operator(Enum):
    """Arithmetic as in IEEE 754: `1 / 0` is infinite and `0 / 0` is NaN."""

    PLUS = "+"
    MINUS = "-"
    TIMES = "*"
    OVER = "/"


@dataclass(frozen=True, slots=True)
class Negative:
    """`-operand`."""

    operand: Expression


@dataclass(frozen=True, slots=True)
class Arithmetic:
    """`left operator right` on numbers."""

    operator: Operator
    left: Expression
    right: Expression


@dataclass(frozen=True, slots=True)
class Call:
    """`function` of `arguments`; of a `zone`, whose corners are the last ones, by its name."""

    function: Function
    arguments: tuple[Expression, ...]
    zone: str = ""

    @property
    def array(self) -> Expression | None:
        """The array that the function is applied to; None if it is applied to numbers."""
        is_of_array = len(self.arguments) == 1 and self.function.takes.array
        return self.arguments[0] if is_of_array else None


class Relation(Enum):
    """How a comparison compares. `!=` does not occur: it is the negation of `==`."""

    LESS = "<"
    AT_MOST = "<="
    EQUAL = "=="
    AT_LEAST = ">="
    GREATER = ">"

    @property
    def flipped(self) -> Relation:
        """The relation with its sides exchanged: `a < b` is `b > a`."""
        return Relation(self.value.translate(str.maketrans("<>", "><")))

    @property
    def opposite(self) -> Relation | None:
        """The ordering that holds of two numbers exactly where this one does not; None for equality."""
        return _OPPOSITES.get(self)


_OPPOSITES = {
    Relation.LESS: Relation.AT_LEAST,
    Relation.AT_MOST: Relation.GREATER,
    Relation.AT_LEAST: Relation.LESS,
    Relation.GREATER: Relation.AT_MOST,
}


@dataclass(frozen=True, slots=True)
class Comparison:
    """`left relation right` on numbers, margin included; both sides are valid (not NaN), or there is no step.

    For the orderings `margin` is signed and moves the right side: `left < right + margin`. For `==` it is the largest
    difference that counts as equal: `abs(left - right) <= margin`, or both are the same infinity. Plain equality where
    it is 0.
    """

    left: Expression
    relation: Relation
    right: Expression
    margin: float = 0.0


@dataclass(frozen=True, slots=True)
class Same:
    """`left` and `right` are the same string, or the same boolean."""

    left: Expression
    right: Expression


@dataclass(frozen=True, slots=True)
class IsTrue:
    """A boolean value is true."""

    operand: Expression


Condition = Comparison | Same | IsTrue


@dataclass(frozen=True, slots=True)
class Count:
    """How many elements of arrays satisfy `predicate`, a state predicate over `conditions` by their names.

    Each `Element` in the conditions stands for the elements of its array one after the other, side by side with those
    of the other arrays, as far as the shortest goes. Those that are in different lists of `over`, which then has each
    once, are combined: every one of a list with every one of the others. Where something that the conditions compare
    is NaN, the elements are no measurement and do not count. The count itself is NaN if a part without elements is, or
    if there are more than `MOST_COMBINATIONS`.
    """

    predicate: Formula
    conditions: tuple[tuple[str, Condition], ...]
    over: tuple[tuple[Element, ...], ...] = ()

    @property
    def elements(self) -> tuple[Element, ...]:
        """The elements that its conditions read, each once."""
        found = (part for part in subexpressions(self) if isinstance(part, Element))
        return tuple(dict.fromkeys(found))

    @property
    def lists(self) -> tuple[tuple[Element, ...], ...]:
        """The elements that go side by side; those of different lists are combined."""
        return self.over or (self.elements,)

    @property
    def singles(self) -> tuple[Expression, ...]:
        """The largest parts that read no element, each once; and what is NaN where there are too many elements."""
        found = dict.fromkeys(single for side in children(self) for single in _singles(side))
        return (*found, *_limits(self.over))


MOST_COMBINATIONS = 10**6
"""At most so many combinations of elements are looked at."""


def _limits(over: tuple[tuple[Element, ...], ...]) -> Iterator[Expression]:
    """0 divided by how many more combinations there could be: NaN if there are too many."""
    if len(over) < 2:
        return
    count: Expression = Number(1.0)
    for elements in over:
        lengths = tuple(Call(Function.LEN, (element.array,)) for element in elements)
        length = lengths[0] if len(lengths) == 1 else Call(Function.MIN, lengths)
        count = length if count == Number(1.0) else Arithmetic(Operator.TIMES, count, length)
    left = Arithmetic(Operator.MINUS, Number(MOST_COMBINATIONS + 1.0), count)
    yield Arithmetic(Operator.OVER, Number(0.0), Call(Function.MAX, (Number(0.0), left)))


def _singles(expression: Expression) -> Iterator[Expression]:
    if not any(isinstance(part, Element) for part in subexpressions(expression)):
        yield expression
    elif not isinstance(expression, Element):
        for child in children(expression):
            yield from _singles(child)


Expression = (
    Number
    | Boolean
    | String
    | Current
    | Past
    | Recent
    | Slope
    | New
    | Opening
    | Slice
    | Element
    | Negative
    | Arithmetic
    | Call
    | Count
    | When
)
"""An expression with one value at each step; it is invalid where its value is NaN."""


def operands(condition: Condition) -> tuple[Expression, ...]:
    """The expressions that `condition` compares."""
    match condition:
        case Comparison(left, _, right, _) | Same(left, right):
            return (left, right)
        case IsTrue(operand):
            return (operand,)


def children(expression: Expression) -> tuple[Expression, ...]:
    """The immediate parts of `expression`; what a signal is computed from is not a part of it."""
    match expression:
        case Number() | Boolean() | String() | Current() | Past() | Recent() | Slope() | New() | Opening():
            return ()
        case Slice(array) | Element(array):
            return (array,)
        case Negative(operand):
            return (operand,)
        case Arithmetic(_, left, right):
            return (left, right)
        case Call(_, arguments):
            return arguments
        case Count(_, conditions) | When(_, conditions):
            return tuple(side for _, condition in conditions for side in operands(condition))
        case _:
            assert_never(expression)


def subexpressions(expression: Expression) -> Iterator[Expression]:
    """`expression` and all that is inside it, outermost and leftmost first, with repetitions."""
    yield expression
    for child in children(expression):
        yield from subexpressions(child)


def inputs(expression: Expression) -> Iterator[Input]:
    """The values of signals that `expression` is computed from, left to right, with repetitions.

    A value at an opening has been a current one.
    """
    return (Current(part.signal) if isinstance(part, Opening) else part for part in reads(expression))


def reads(expression: Expression) -> Iterator[Read]:
    """What `expression` reads of signals, left to right, with repetitions."""
    return (part for part in subexpressions(expression) if isinstance(part, Read))


def value_type(read: Read) -> ValueType:
    """The kind of value that is read; news is a boolean, for any message."""
    match read:
        case New():
            return ValueType.BOOLEAN
        case Recent(signal):
            return signal.type.array
        case Current(signal) | Past(signal) | Slope(signal) | Opening(signal):
            return signal.type


def openings(expression: Expression) -> Iterator[Opening]:
    """The values at an opening that `expression` reads, left to right, with repetitions."""
    return (part for part in reads(expression) if isinstance(part, Opening))
