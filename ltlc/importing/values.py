"""What stands in formulas of other tools: expressions as the language writes them, and arrays of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import reduce
from itertools import combinations

from ltlc.dataclass import dataclass
from ltlc.importing import formulas as f
from ltlc.importing.names import Kind


class FormulaError(ValueError):
    """A text is no formula of its form, or cannot be said; `offset` is the place, in characters from 0."""

    def __init__(self, reason: str, offset: int = 0) -> None:
        super().__init__(reason)
        self.offset = offset


COMPARISON, SUM, PRODUCT, POWER = 10, 11, 12, 13
"""How tightly comparisons and the operators of numbers bind; those of formulas bind less tightly."""


@dataclass(frozen=True)
class Value:
    """An expression that is no condition, as it is written in the language; `name` if it is a name of the file."""

    text: str
    kind: Kind
    level: int = POWER + 1
    name: str = ""

    def within(self, level: int) -> str:
        """The text as an operand of an operator that binds so tightly."""
        return self.text if self.level >= level else f"({self.text})"


@dataclass(frozen=True)
class Structure:
    """Several values: an array, by numbers, or what has fields, by their names."""

    parts: Mapping[str, Part]

    def part(self, name: str, offset: int) -> Part:
        """A part by its name. Raises FormulaError."""
        if name not in self.parts:
            raise FormulaError(f"there is no `{name}` in it", offset)
        return self.parts[name]


@dataclass(frozen=True)
class Choice:
    """One of two values: `then` where `given` holds."""

    given: f.Formula
    then: Value
    otherwise: Value


Part = Value | f.Formula | Structure | Choice


def array(parts: Iterable[Part]) -> Structure:
    """An array of `parts`."""
    return Structure({str(number): part for number, part in enumerate(parts)})


AGGREGATES = frozenset(("foreach", "forsome", "foratleast", "foratmost", "forexactly"))
MOST_COUNTED = 6
"""Elements of which any number may have to satisfy a condition: the choices are written out."""


def counted(found: list[f.Formula], word: str, number: str, offset: int) -> f.Formula:
    """That all of `found` hold, some, or so many as `number` says. Raises FormulaError."""
    if word in ("foreach", "forsome"):
        return reduce(
            f.conjoined if word == "foreach" else f.disjoined,
            found,
            f.Not(f.TRUE) if word == "forsome" else f.TRUE,
        )
    if not number.isdigit() or len(found) > MOST_COUNTED:
        raise FormulaError(f"`{word}` is written out for up to {MOST_COUNTED} elements, and a number", offset)

    def at_least(n: int) -> f.Formula:
        chosen = (reduce(f.conjoined, some, f.TRUE) for some in combinations(found, n))
        return reduce(f.disjoined, chosen, f.FALSE)

    n = int(number)
    if word == "foratleast":
        return at_least(n)
    at_most = f.negated(at_least(n + 1))
    return at_most if word == "foratmost" else f.conjoined(at_least(n), at_most)


def power(base: str, exponent: str, offset: int) -> Value:
    """`base` to the power of a small whole number, written out. Raises FormulaError."""
    if not exponent.isdigit() or not 1 <= int(exponent) <= 8:
        raise FormulaError("only small whole powers can be said", offset)
    return Value(" * ".join([base] * int(exponent)), Kind.NUMBER, PRODUCT)
