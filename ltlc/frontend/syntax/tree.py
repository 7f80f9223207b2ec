"""The syntax tree of a specification file: what the author wrote, with its places, before names have a meaning."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field

from ltlc.base.source import Span
from ltlc.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Node:
    """A part of the text; `span` covers all of it, the parentheses around it included."""

    span: Span


@dataclass(frozen=True, slots=True)
class Word(Node):
    """A name, a topic or the type of a message with a path, as it is written; in `forall`, `{r}_battery` is a name."""

    text: str


@dataclass(frozen=True, slots=True)
class NumberLiteral(Node):
    """A number; `text` distinguishes an integer from a decimal fraction."""

    text: str


@dataclass(frozen=True, slots=True)
class DurationLiteral(Node):
    """A number and a unit: `0.5 s`."""

    number: str
    unit: str


@dataclass(frozen=True, slots=True)
class Parameter(Node):
    """`?`: the place of a number or a duration that `ltlc mine` finds."""


@dataclass(frozen=True, slots=True)
class StringLiteral(Node):
    """A string, its escapes replaced."""

    value: str


@dataclass(frozen=True, slots=True)
class BooleanLiteral(Node):
    """`true` or `false`."""

    value: bool


@dataclass(frozen=True, slots=True)
class Range(Node):
    """`start:stop`, between the brackets of a slice; None where an end is omitted."""

    start: NumberLiteral | None
    stop: NumberLiteral | None


Step = Word | NumberLiteral | Range
"""What follows a value after a dot or in brackets; an index may be negative here."""


@dataclass(frozen=True, slots=True)
class Reference(Node):
    """A name and what follows it after dots and in brackets: `scan`, `robot.distance.stop_sign`, `scan[80:100]`."""

    name: Word
    steps: tuple[Step, ...] = ()


@dataclass(frozen=True, slots=True)
class Selection(Node):
    """What follows an expression other than a name: `(goal - robot.position).x`, `@{goal, -1}.x`."""

    base: Node
    steps: tuple[Step, ...]


@dataclass(frozen=True, slots=True)
class MessageConstant(Node):
    """A constant of a message whose package is named: `action_msgs/msg/GoalStatus.STATUS_ABORTED`."""

    message: Word
    name: Word


@dataclass(frozen=True, slots=True)
class Call(Node):
    """`function(arguments)`."""

    function: Word
    arguments: tuple[Node, ...]


@dataclass(frozen=True, slots=True)
class Quantified(Node):
    """`quantifier(condition over (array, …), …)`, the quantifier one of `any all count`; without `over`, no lists."""

    quantifier: Word
    condition: Node
    over: tuple[tuple[Node, ...], ...] = ()


@dataclass(frozen=True, slots=True)
class History(Node):
    """`@{signal, offset}`, `@{signal, offset else otherwise}`."""

    signal: Node
    offset: Node
    otherwise: Node | None = None


@dataclass(frozen=True, slots=True)
class Recent(Node):
    """`@{signal, offset:}`."""

    signal: Node
    offset: Node


@dataclass(frozen=True, slots=True)
class Latch(Node):
    """`@{signal, when condition}`."""

    signal: Node
    condition: Node


@dataclass(frozen=True, slots=True)
class Gone(Node):
    """`gone key`."""

    key: Node


@dataclass(frozen=True, slots=True)
class News(Node):
    """`new signal`."""

    signal: Node


@dataclass(frozen=True, slots=True)
class Minus(Node):
    """`-operand`."""

    operand: Node


@dataclass(frozen=True, slots=True)
class Arithmetic(Node):
    """`left operator right`, the operator one of `+ - * /`."""

    left: Node
    operator: Word
    right: Node


@dataclass(frozen=True, slots=True)
class Comparison(Node):
    """`left operator{margin} right`, the operator one of `== != < <= > >=`."""

    left: Node
    operator: Word
    right: Node
    margin: Node | None = None


@dataclass(frozen=True, slots=True)
class Rate(Node):
    """`rate(signal) operator hertz Hz over duration`."""

    signal: Node
    operator: Word
    hertz: NumberLiteral
    duration: Node


@dataclass(frozen=True, slots=True)
class Membership(Node):
    """`operand in {items}`."""

    operand: Node
    operator: Word
    items: tuple[Node, ...]


@dataclass(frozen=True, slots=True)
class Negation(Node):
    """`not operand`."""

    operand: Node


@dataclass(frozen=True, slots=True)
class Connective(Node):
    """`left operator right`, the operator one of `and or implies`."""

    left: Node
    operator: Word
    right: Node


@dataclass(frozen=True, slots=True)
class Interval(Node):
    """`[start, end]`, in place of the duration of a bound."""

    start: Node
    end: Node


@dataclass(frozen=True, slots=True)
class Bound(Node):
    """`within duration` or `for duration`."""

    keyword: Word
    duration: Node


@dataclass(frozen=True, slots=True)
class Temporal(Node):
    """A temporal keyword and its arguments: two for `after until`, three for `after_until`, else one.

    `bound` stands after the arguments, if one does.
    """

    keyword: Word
    arguments: tuple[Node, ...]
    bound: Bound | None = None


@dataclass(frozen=True, slots=True)
class Within(Node):
    """`within duration, body`; a `bound` after that has no meaning."""

    duration: Node
    body: Node
    bound: Bound | None = None


@dataclass(frozen=True, slots=True)
class Past(Node):
    """`once historically previously` and the state predicate after it, or the two around `since`; `once p 3 times`."""

    keyword: Word
    arguments: tuple[Node, ...]
    bound: Bound | None = None
    times: NumberLiteral | None = None


@dataclass(frozen=True, slots=True)
class StrayBound(Node):
    """A bound with no keyword before it that it could belong to: `speed > 2 for 3 s`."""

    body: Node
    bound: Bound


@dataclass(frozen=True, slots=True)
class Declaration(Node):
    """`decl NAME TOPIC TYPE`; also one attribute of a model, `ATTRIBUTE TOPIC TYPE`."""

    name: Word
    topic: Word
    type: Word


@dataclass(frozen=True, slots=True)
class Model(Node):
    """`model NAME: attributes;`."""

    name: Word
    attributes: tuple[Declaration, ...]


@dataclass(frozen=True, slots=True)
class ObjectFromTopic(Node):
    """`object NAME TOPIC TYPE`."""

    name: Word
    topic: Word
    type: Word


@dataclass(frozen=True, slots=True)
class ObjectAtPlace(Node):
    """`object NAME at (x, y, z)`."""

    name: Word
    coordinates: tuple[Node, Node, Node]


@dataclass(frozen=True, slots=True)
class Corner(Node):
    """`(x, y)`."""

    x: Node
    y: Node


@dataclass(frozen=True, slots=True)
class Zone(Node):
    """`zone NAME = [(x, y), …]`."""

    name: Word
    corners: tuple[Corner, ...]


@dataclass(frozen=True, slots=True)
class Association(Node):
    """`NAME = value`, the value an expression or a property."""

    name: Word
    value: Node


@dataclass(frozen=True, slots=True)
class Guard(Node):
    """`guard raw to out else fallbacks`; without `else`, none."""

    raw: Word
    out: Word
    fallbacks: tuple[Word, ...]


@dataclass(frozen=True, slots=True)
class Constant(Node):
    """`path: value`, in a message."""

    path: Reference
    value: Node


@dataclass(frozen=True, slots=True)
class Message(Node):
    """`message NAME {constants}`."""

    name: Word
    constants: tuple[Constant, ...]


@dataclass(frozen=True, slots=True)
class Setting(Node):
    """`_name_ = value`; the value of `_simulator_` may be a topic, which is a `Word`."""

    name: Word
    value: Node


@dataclass(frozen=True, slots=True)
class Forall(Node):
    """`forall variables in {names}: body`, the body a property, another `forall` or one of each id or message."""

    variables: tuple[Word, ...]
    names: tuple[Word, ...]
    body: Node


@dataclass(frozen=True, slots=True)
class Entry(Node):
    """`key value …`, an attribute of a requirement; the values as they are meant, strings without their quotes."""

    key: Word
    values: tuple[Word, ...]


@dataclass(frozen=True, slots=True)
class AttributeLine(Node):
    """`[entries]`, in front of a property."""

    entries: tuple[Entry, ...]


@dataclass(frozen=True, slots=True)
class EachOf(Node):
    """`each variable of keys limit N: body`; without `limit`, None."""

    variable: Word
    keys: tuple[Node, ...]
    limit: NumberLiteral | None
    body: Node


@dataclass(frozen=True, slots=True)
class EachMessage(Node):
    """`each news limit N: body`; without `limit`, None."""

    news: News
    limit: NumberLiteral | None
    body: Node


@dataclass(frozen=True, slots=True)
class PropertyCommand(Node):
    """`[LABEL:] property`, or `assume [LABEL:] property`.

    Of a property that `forall` has written out, it has the names of its variables, too. The `attributes` in front of it
    are outside its `span`.
    """

    label: Word | None
    property: Node
    names: Mapping[str, Word] = field(default_factory=dict)
    attributes: tuple[AttributeLine, ...] = ()
    is_assumed: bool = False

    def whole(self) -> Span:
        """The place of all of it, the attributes included."""
        return self.attributes[0].span.to(self.span) if self.attributes else self.span


Command = (
    Declaration
    | Model
    | ObjectFromTopic
    | ObjectAtPlace
    | Zone
    | Association
    | Guard
    | Message
    | Setting
    | PropertyCommand
)


@dataclass(frozen=True, slots=True)
class SyntaxTree:
    """The commands of a file in their order, those that could be parsed.

    `lost` is the text of the others, in which names may be defined and used; None if there are no others.
    """

    commands: tuple[Command, ...]
    lost: str | None = None


def children(node: Node) -> tuple[Node, ...]:
    """The expressions and properties immediately inside `node`, in the order of the text."""
    match node:
        case Call(_, _, arguments):
            return arguments
        case Temporal(_, _, arguments, bound) | Past(_, _, arguments, bound):
            return arguments if bound is None else (*arguments, bound)
        case Within(_, duration, body, bound):
            return (duration, body) if bound is None else (duration, body, bound)
        case StrayBound(_, body, bound):
            return (body, bound)
        case History(_, signal, which) | Recent(_, signal, which) | Latch(_, signal, which):
            return (signal, which)
        case Minus(_, operand) | Negation(_, operand) | Selection(_, operand, _) | News(_, operand) | Gone(_, operand):
            return (operand,)
        case Quantified(_, _, condition, over):
            return (condition, *(array for arrays in over for array in arrays))
        case Membership(_, operand, _, items):
            return (operand, *items)
        case Bound(_, _, duration):
            return (duration,)
        case Interval(_, start, end):
            return (start, end)
        case Rate(_, signal, _, _, duration):
            return (signal, duration)
        case Forall(_, _, _, body):
            return (body,)
        case EachOf(_, _, keys, _, body):
            return (*keys, body)
        case EachMessage(_, news, _, body):
            return (news, body)
        case Comparison(_, left, _, right, margin):
            return (left, right) if margin is None else (left, margin, right)
        case Arithmetic(_, left, _, right) | Connective(_, left, _, right):
            return (left, right)
        case Association(_, _, value) | Setting(_, _, value) | PropertyCommand(_, _, value):
            return (value,)
        case ObjectAtPlace(_, _, coordinates):
            return coordinates
        case Zone(_, _, corners):
            return corners
        case Message(_, _, constants):
            return constants
        case Constant(_, _, value):
            return (value,)
        case Corner(_, x, y):
            return (x, y)
        case _:
            return ()


def runs_on(text: str, first: Node, second: Node) -> bool:
    """Whether a property without a label begins behind another command on its line, with only blanks between them.

    What begins behind a declaration may be its path, and behind a guard one more fallback.
    """
    if not isinstance(first, PropertyCommand | Declaration | Guard) or not isinstance(second, PropertyCommand):
        return False
    between = text[first.span.end : second.span.start]
    return second.label is None and first.span != second.span and between.strip(" \t") == ""


def walk(node: Node) -> Iterator[tuple[Node, int]]:
    """`node` and all that is inside it, with its depth in the tree; without recursion, for trees of any depth."""
    stack = [(node, 1)]
    while stack:
        current, depth = stack.pop()
        yield current, depth
        stack.extend((child, depth + 1) for child in reversed(children(current)))
