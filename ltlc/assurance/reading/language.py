"""Terms: what the conditions of a specification say, as `meaning` has it, and what machines say, to be compared."""

from __future__ import annotations

from collections.abc import Hashable
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
