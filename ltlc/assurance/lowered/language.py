"""Terms: what the conditions of a specification and the expressions of a machine are said in, to be compared."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass


class DiffersError(Exception):
    """What a machine does is not what it should, or has no form in terms; the message says what."""


class Term:
    """What has a value: a number, a truth value, a string, an array, a time."""

    __slots__ = ()


@dataclass(frozen=True, slots=True, eq=False)
class Constant(Term):
    """A literal; equal ones are of one type, and bit for bit one value: `1`, `1.0`, `True`, 0.0 and -0.0 differ."""

    value: bool | int | float | str

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Constant) and self._exact == other._exact

    def __hash__(self) -> int:
        return hash(self._exact)

    @property
    def _exact(self) -> tuple[type, Hashable]:
        return type(self.value), repr(self.value) if isinstance(self.value, float) else self.value


@dataclass(frozen=True, slots=True)
class Moment(Term):
    """`offset` nanoseconds after `base`."""

    base: str
    offset: int = 0


NEVER = Moment("never")
"""Later than any time."""


@dataclass(frozen=True, slots=True)
class Apply(Term):
    """A function or operator of terms.

    `+ - * /` and `negative` are those of IEEE 754 on doubles, division by 0 included. `abs`, `least`, `greatest`,
    `square_root`, `norm`, `gap`, `roll`, `pitch`, `yaw`, `angle`, and of arrays `smallest`, `largest`, `sum_of`,
    `median_of`, `length_of`, are those of `ltlc.runtime.functions`; `double` makes a double of an integer. `< <= >
    >= ==` are false of NaN, `!=` is true; `and`, `or`, `not` are those of logic. `slice` has an array and two
    indexes or `NONE`.
    """

    function: str
    arguments: tuple[Term, ...]


NONE = Apply("none", ())
"""No index."""
