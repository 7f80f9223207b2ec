"""Typed expressions as Python; the code agrees with `ltlc.specification.evaluation`."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from inspect import isfunction

from ltlc.backends.names import Names
from ltlc.backends.python.code import flat, literal
from ltlc.backends.spelling import Speller, Target
from ltlc.backends.trees import Call, Chain, Code, Text
from ltlc.backends.trees import Each as EachCode
from ltlc.program.expressions import (
    Apply,
    Count,
    Each,
    Expression,
    Held,
    Kept,
    Literal,
    Recent,
    Slice,
    children,
    reads_of,
)
from ltlc.program.functions import ROWS, Primitive, Spelling, Types
from ltlc.runtime import functions


class Python(Target):
    """How Python writes what the table of functions leaves to the target."""

    def spelling(self, primitive: Primitive, types: Types) -> Spelling | None:
        """By the table."""
        return ROWS[primitive].python(types)

    def literal(self, speller: Speller, literal_: Literal) -> Code:
        """The same double, boolean, string or integer; the integers of narrow fields are floats."""
        value = literal_.value
        if isinstance(value, str):
            return Text(literal(value))
        if isinstance(value, float) and not math.isfinite(value):
            return Text({math.inf: "math.inf", -math.inf: "-math.inf"}.get(value, "math.nan"))
        is_narrow = literal_.type.scalar.is_number and not literal_.type.scalar.is_wide
        return Text(repr(float(value)) if is_narrow else repr(value))

    def slice(self, speller: Speller, slice_: Slice) -> Code:
        """As in the language."""
        ends = ("" if end is None else str(end) for end in (slice_.start, slice_.stop))
        return Text(f"{flat(speller.code(slice_.array))}[{':'.join(ends)}]")

    def count(self, speller: Speller, count: Count) -> Code:
        """`any` or `sum` of a generator."""
        local = Names(frozenset(speller.names.values()))
        names: dict[Expression, str] = {
            Each(array): local.unique(f"each_{speller.names[next(reads_of(array))]}") for array in count.arrays
        }
        inner = Speller({**speller.names, **names}, self)
        result = Text("True" if count.is_any else "1")
        loops = []
        for arrays in count.lists:
            codes = tuple(map(speller.code, arrays))
            items = codes[0] if len(codes) == 1 else Call("zip", (*codes, Text("strict=False")))
            loops.append(Chain((Text(", ".join(names[Each(array)] for array in arrays)), items), ("in",)))
        found = EachCode(result, tuple(loops), inner.code(count.guard))
        return Call("any", (found,)) if count.is_any else Call("float", (Call("sum", (found,)),))

    def at_most_infinite(self, speller: Speller, argument: Expression) -> Code:
        """Also of integers of any size."""
        return Chain((speller.code(argument), Text("INFINITY")), ("<=",))


def python_speller(names: Mapping[Expression, str]) -> Speller:
    """What writes expressions over inputs and local variables that are called as in `names`."""
    return Speller(names, Python())


RUNTIME_FUNCTIONS = frozenset(
    name for name, value in vars(functions).items() if isfunction(value) and value.__module__ == functions.__name__
)
"""The functions of `ltlc.runtime.functions` that emitted code may call."""


def calculated_inputs(conditions: Iterable[Expression]) -> set[str]:
    """The signals of which samples are calculated with, not only compared: these must be doubles."""
    return {signal for condition in conditions for signal in _calculated(condition)}


_KEPT_AS_GIVEN = frozenset(
    {
        Primitive.LESS,
        Primitive.AT_MOST,
        Primitive.EQUAL,
        Primitive.SAME,
        Primitive.NOT,
        Primitive.AND,
        Primitive.OR,
        Primitive.MEASURED,
        Primitive.SMALLEST,
        Primitive.LARGEST,
        Primitive.LENGTH,
        Primitive.TO_DOUBLE,
        Primitive.TO_SIGNED,
        Primitive.TO_UNSIGNED,
    }
)


def _calculated(expression: Expression) -> Iterator[str]:
    match expression:
        case Apply(primitive) if primitive not in _KEPT_AS_GIVEN:
            yield from (read.signal for read in reads_of(expression) if isinstance(read, Held | Recent | Kept))
        case _:
            for child in children(expression):
                yield from _calculated(child)
