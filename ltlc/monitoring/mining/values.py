"""The values that a parameter can have, in the order in which they make its property weaker.

They are numbered: the finite numbers of the field's own type, one after the other without any between, or durations in
whole nanoseconds. Number 0 makes the strongest property, `last` the weakest. Integers go one further than the type on
either side, so that a threshold which nothing is compared with is not taken for one that the smallest integer decides.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from decimal import Decimal
from math import inf

from ltlc.dataclass import dataclass
from ltlc.frontend.language.durations import LONGEST
from ltlc.frontend.language.parameters import Role
from ltlc.monitoring.mining.monotone import STRONGER, WEAKER
from ltlc.semantics.durations import UNITS, Nanoseconds, duration_text, seconds_text
from ltlc.specification.text import number_text, outwards
from ltlc.specification.wire import DOUBLES, EXACT, Kind, Numbers

DIGITS = 3
"""Significant digits of a rounded value, which has more where whole numbers, or whole seconds, have more."""


@dataclass(frozen=True, slots=True)
class Values:
    """Values from the rank `least` to `most`: of `numbers`, durations if that is None."""

    numbers: Numbers | None
    least: int
    most: int
    direction: int

    @property
    def last(self) -> int:
        """The number of the weakest value."""
        return self.most - self.least

    def at(self, number: int) -> float | Nanoseconds:
        """The value with that number."""
        rank = self._rank(number)
        return rank if self.numbers is None else self.numbers.at(rank)

    def number(self, value: float | Nanoseconds) -> int:
        """The number of the value that is nearest to `value` below or at it, if it is one of these."""
        rank = int(value) if self.numbers is None else self.numbers.rank(value)
        return self.most - rank if self.direction == STRONGER else rank - self.least

    def literal(self, number: int) -> str | Nanoseconds:
        """The value with that number for the syntax tree: a number as it is written, or a duration."""
        return self._rank(number) if self.numbers is None else self.text(number)

    def text(self, number: int) -> str:
        """The value with that number as the language writes it, which reads as exactly that."""
        if self.numbers is None:
            return duration_text(self._rank(number))
        return number_text(self.numbers.at(self._rank(number)), self.numbers.kind is Kind.SINGLE)

    def rounded(self, number: int) -> int:
        """The number of the value with that `number`, or of the next weaker one that has `DIGITS`.

        Integers stay as they are: they are counts and the like, none of whose digits is noise.
        """
        if self.numbers is not None and self.numbers.kind is Kind.INTEGER:
            return number
        exact = Decimal(seconds_text(self._rank(number)) if self.numbers is None else self.text(number))
        step = Decimal(1).scaleb(min(0, exact.adjusted() - DIGITS + 1))
        easy = outwards(exact, step, is_upper=self.direction == WEAKER)
        return self.number(int(easy * UNITS["s"]) if self.numbers is None else self.numbers.nearest(float(easy)))

    def _rank(self, number: int) -> int:
        return self.most - number if self.direction == STRONGER else self.least + number


def values(role: Role, direction: int, beside: Iterable[Numbers | None]) -> Values:
    """The values of a parameter in that role; a threshold is compared with what is among the numbers `beside`."""
    match role:
        case Role.DURATION:
            return Values(None, 1, LONGEST, direction)
        case Role.MARGIN:
            return Values(DOUBLES, 0, DOUBLES.rank(inf) - 1, direction)
        case _:
            pass
    numbers = _finest([each for each in beside if each is not None])
    if numbers.kind is not Kind.INTEGER:
        return Values(numbers, 1 - numbers.rank(inf), numbers.rank(inf) - 1, direction)
    least, most = int(numbers.least) - 1, int(numbers.most) + 1
    if not numbers.is_wide:
        least, most = max(least, -EXACT), min(most, EXACT)
    return Values(numbers, least, most, direction)


def _finest(beside: Sequence[Numbers]) -> Numbers:
    """The numbers of the kind of all those `beside`, if they have one, or else doubles."""
    kinds = {each.kind for each in beside}
    if kinds != {Kind.INTEGER}:
        return Numbers(kinds.pop()) if len(kinds) == 1 else DOUBLES
    return Numbers(Kind.INTEGER, min(each.least for each in beside), max(each.most for each in beside))
