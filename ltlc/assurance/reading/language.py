"""The small language of step functions: what the emitted text of any target is parsed into before it is compared.

A front end (`python` here) makes a `StepClass` of text, or raises NotUnderstoodError: what has no form in this language
is refused, never passed over. Nothing here knows of monitors, and nothing of how code is written.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass

from ltlc.semantics.verdicts import Verdict


class NotUnderstoodError(Exception):
    """The text has a part that this language has no form for; the message names it."""


class Term:
    """What has a value: a number, a truth value, a string, an array, a time, a verdict."""

    __slots__ = ()


@dataclass(frozen=True, slots=True, eq=False)
class Constant(Term):
    """A literal; equal ones are of one type, and bit for bit one value: `1`, `1.0`, `True`, 0.0 and -0.0 differ."""

    value: bool | int | float | str | Verdict

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Constant) and self._exact == other._exact

    def __hash__(self) -> int:
        return hash(self._exact)

    @property
    def _exact(self) -> tuple[type, Hashable]:
        return type(self.value), repr(self.value) if isinstance(self.value, float) else self.value


@dataclass(frozen=True, slots=True)
class Variable(Term):
    """A parameter of a method, or a variable of its own."""

    name: str


@dataclass(frozen=True, slots=True)
class Attribute(Term):
    """What the monitor remembers under this name from one call to the next."""

    name: str


@dataclass(frozen=True, slots=True)
class Moment(Term):
    """`offset` nanoseconds after `base`; front ends write `NEVER` only."""

    base: str
    offset: int = 0


NEVER = Moment("never")
"""Later than any time."""


@dataclass(frozen=True, slots=True)
class Apply(Term):
    """A function or operator of terms.

    `+ - * /` and `negative` are those of IEEE 754 on doubles, division by 0 included, and exact on integers and
    times. `abs`, `least`, `greatest`, `square_root`, `gap`, `norm`, `roll`, `pitch`, `yaw`, `angle`, and of arrays
    `smallest`, `largest`, `sum_of`, `median_of`, `length_of`, are those of `ltlc.runtime.functions`. `number` makes a
    double of what a caller gives, `double` of an integer, `elements` and `doubles` an array of what a caller gives.
    `< <= > >= ==` are false of NaN, `!=` is true; `and`, `or`, `not` are those of logic. `min` is the earliest of
    times, `tuple` several values, `slice` has an array and two indexes or `NONE`. `length` is how many samples a
    history has, `ago` that one of them after which so many were added.
    """

    function: str
    arguments: tuple[Term, ...]


NONE = Apply("none", ())
"""No index."""


@dataclass(frozen=True, slots=True)
class Elements(Term):
    """How many indexes there are, up to the end of the shortest array, at whose elements, `names`, `guard` is true."""

    names: tuple[str, ...]
    arrays: tuple[Term, ...]
    guard: Term


@dataclass(frozen=True, slots=True)
class Choice(Term):
    """`then` if `guard` is true, else `otherwise`."""

    guard: Term
    then: Term
    otherwise: Term


@dataclass(frozen=True, slots=True)
class Assign:
    """The target has the value from now on."""

    target: Variable | Attribute
    value: Term


@dataclass(frozen=True, slots=True)
class Unpack:
    """The variables have the values that `value`, a tuple of as many, consists of."""

    targets: tuple[str, ...]
    value: Term


@dataclass(frozen=True, slots=True)
class Push:
    """A sample is added to the history in the attribute `history`, which forgets its oldest one when it is full."""

    history: str
    value: Term


@dataclass(frozen=True, slots=True)
class If:
    """The statements of one side."""

    guard: Term
    then: Block
    otherwise: Block


@dataclass(frozen=True, slots=True)
class While:
    """The statements of `body` again and again, as long as `guard` is true before them."""

    guard: Term
    body: Block


@dataclass(frozen=True, slots=True)
class Do:
    """A method of the monitor is called; what it returns is dropped."""

    method: str
    arguments: tuple[Term, ...]


@dataclass(frozen=True, slots=True)
class Return:
    """The method ends with a value, or with that of another call."""

    value: Term | Do


Statement = Assign | Unpack | Push | If | While | Do | Return
Block = tuple[Statement, ...]


@dataclass(frozen=True, slots=True)
class Method:
    """A method with the names of its parameters, the monitor itself left out."""

    parameters: tuple[str, ...]
    body: Block


@dataclass(frozen=True, slots=True)
class StepClass:
    """The emitted monitor of one property.

    `methods` has `start`, which makes it ready (of a monitor with clocks, for a session that begins at its parameter),
    `step`, `expire` if it takes clock steps, and what these call. The attributes `state`, `verdict`, `invalid`, the
    number of invalid steps, and `due`, the last time before the next clock step, are called so. `kept` are the
    attributes that hold values taken at openings, `dues` those that hold the due times of clocks, `histories` those
    that hold samples with how many of them: in the order in which the text declares them. `has_integers`: what is read
    of a field of integers is one of these, never NaN. It `hears`: its `step` is told of messages, and renews ages.
    """

    name: str
    methods: Mapping[str, Method]
    kept: tuple[str, ...]
    dues: tuple[str, ...]
    histories: tuple[tuple[str, int], ...]
    has_integers: bool = False
    hears: bool = False
