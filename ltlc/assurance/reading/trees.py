"""The small language of step functions: what emitted text of any target is taken apart into, before it is read.

A front end makes a `StepClass` of text by the parser of its target, and raises NotUnderstoodError for what has no form
here: nothing is passed over. It knows what names and operators of its target there are; what they mean, `expressions`
and `machines` say, once for all targets. Nothing here knows of monitors.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from typing import assert_never

from ltlc.dataclass import dataclass
from ltlc.program.types import Type
from ltlc.semantics.verdicts import Verdict


class NotUnderstoodError(Exception):
    """The text has a part that has no form in this language, or says what no machine does; the message names it."""


@dataclass(frozen=True, slots=True, eq=False)
class Constant:
    """A literal, of a `type` if the target has literals of types; `1`, `1.0`, `True`, 0.0 and -0.0 differ."""

    value: bool | int | float | str | Verdict
    type: Type | None = None

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Constant) and self._exact() == other._exact()

    def __hash__(self) -> int:
        return hash(self._exact())

    def _exact(self) -> object:
        exactly: Hashable = repr(self.value) if isinstance(self.value, float) else self.value
        return type(self.value), exactly, self.type


@dataclass(frozen=True, slots=True)
class Variable:
    """A parameter of a method, or a variable of its own; `time` is the time of the instant."""

    name: str


@dataclass(frozen=True, slots=True)
class Attribute:
    """What the monitor remembers under this name from one call to the next."""

    name: str


@dataclass(frozen=True, slots=True)
class Apply:
    """An operator or a function of trees, by the name that the table of functions spells it with for the target.

    `and`, `or`, `not`, `<`, `<=`, `>`, `>=`, `==`, `!=` and `-` before one operand are called so for all targets.
    `measured` says that a number is not NaN, however the target does; `min` is the earliest of times, `tuple` several
    values.
    """

    function: str
    arguments: tuple[Tree, ...]


@dataclass(frozen=True, slots=True)
class Part:
    """The elements of an array from an index, None for the first, up to, not including, another."""

    array: Tree
    start: int | None
    stop: int | None


@dataclass(frozen=True, slots=True)
class Elements:
    """For how many combinations of indexes `guard` is true of the elements, called as in `names`.

    There are `lists` of so many of the arrays, one after the other, each with an index up to the end of its shortest;
    without, there is one. With `is_any`, whether there is such a combination.
    """

    names: tuple[str, ...]
    arrays: tuple[Tree, ...]
    guard: Tree
    is_any: bool
    lists: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Ago:
    """The sample in the history in an attribute after which so many were added; or `all` from that one on."""

    history: str
    samples: int
    all: bool = False


@dataclass(frozen=True, slots=True)
class Choice:
    """`then` if `guard` is true, else `otherwise`."""

    guard: Tree
    then: Tree
    otherwise: Tree


Tree = Constant | Variable | Attribute | Apply | Part | Elements | Ago | Choice

TIME, DUE, VERDICT = Variable("time"), Attribute("due"), Attribute("verdict")
NEVER = Apply("never", ())
"""Later than any time."""


@dataclass(frozen=True, slots=True)
class Assign:
    """The target has the value from now on."""

    target: Variable | Attribute
    value: Tree


@dataclass(frozen=True, slots=True)
class Unpack:
    """The variables have the values that `value`, several, consists of."""

    targets: tuple[str, ...]
    value: Tree


@dataclass(frozen=True, slots=True)
class Push:
    """A sample is added to a history, which forgets its oldest one when it is full."""

    history: str
    value: Tree


@dataclass(frozen=True, slots=True)
class If:
    """The statements of one side."""

    guard: Tree
    then: Block
    otherwise: Block = ()


@dataclass(frozen=True, slots=True)
class While:
    """The statements of `body` again and again, as long as `guard` is true before them."""

    guard: Tree
    body: Block


@dataclass(frozen=True, slots=True)
class Do:
    """A method of the monitor is called; what it returns is dropped."""

    method: str
    arguments: tuple[Tree, ...] = ()


@dataclass(frozen=True, slots=True)
class Return:
    """The method ends with a value, or with that of another call."""

    value: Tree | Do


Statement = Assign | Unpack | Push | If | While | Do | Return
Block = tuple[Statement, ...]


@dataclass(frozen=True, slots=True)
class Method:
    """A method with the names of its parameters, the monitor itself omitted."""

    parameters: tuple[str, ...]
    body: Block


@dataclass(frozen=True, slots=True)
class StepClass:
    """The emitted monitor of one property.

    `methods` has `start`, which makes it ready (of a monitor with clocks, for a session that begins at its parameter),
    `step`, `expire` if it takes clock steps, and what these call. The attributes `state`, `verdict`, `invalid`, the
    number of invalid steps, and `due`, the last time before the next clock step, are called so. `kept` are the
    attributes that hold values taken at openings, `histories` those that hold samples with how many of them: in the
    order in which the text declares them. `ages`: of each clock that is an age, by its attribute, the signal and the
    duration, where the text says that elsewhere than in `step`.
    """

    name: str
    methods: Mapping[str, Method]
    kept: tuple[str, ...] = ()
    histories: tuple[tuple[str, int], ...] = ()
    ages: Mapping[str, tuple[str, int]] | None = None


def shown(tree: Tree) -> str:
    """`tree` in one line, for messages."""
    match tree:
        case Constant(value):
            return value.name if isinstance(value, Verdict) else repr(value)
        case Variable(name) | Attribute(name):
            return name
        case Apply(function, (left, right)) if not function.isidentifier() or function in ("and", "or"):
            return f"{shown(left)} {function} {shown(right)}"
        case Apply(function, arguments):
            return f"{function}({', '.join(map(shown, arguments))})"
        case Part(array, start, stop):
            return f"{shown(array)}[{start or ''}:{'' if stop is None else stop}]"
        case Elements(_, arrays):
            return f"the elements of {' and '.join(map(shown, arrays))}"
        case Ago(history, samples, all):
            return f"{history}[-{samples + 1}{':' if all else ''}]"
        case Choice(guard, then, otherwise):
            return f"{shown(then)} if {shown(guard)} else {shown(otherwise)}"
        case _:
            assert_never(tree)
