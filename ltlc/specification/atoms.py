"""Atoms: the conditions on values that a property is made of.

Thirty thresholds on one signal have thirty-one valuations, and between two neighbours among the binary32 there is
none: the letters that exist are computed on the line of the numbers that the field's type has
(`specification/wire.py`). A condition on the elements of arrays is a comparison of one number, too: `any(C)` is
`count(C) >= 1`, `all(C)` is `count(not C) < 1`. `analysis/` knows more (arithmetic over several signals, by z3, over
the reals); monitors do not use that, because rounding could make a letter that the reals exclude. Letters that some
hundreds of drawn doubles give count as possible there, too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import fields
from typing import Any

from ltlc.base.source import Span
from ltlc.dataclass import dataclass
from ltlc.specification.expressions import Condition, Count, Expression, Opening, Read, operands, subexpressions


@dataclass(frozen=True, slots=True)
class Atom:
    """An atom of core LTL and when it holds.

    `name` is the condition written out in the language, margins applied (`robot.velocity > 2.1`): the same condition
    has the same name wherever it stands. `span` is where it stands first.
    """

    name: str
    condition: Condition
    span: Span


def placed(part: Any, scope: int, label: str) -> Any:
    """A condition, or a part of one, where it stands in the scope number `scope` of the property `label`."""
    return with_openings(part, lambda opening: Opening(opening.signal, scope, label))


def with_openings(part: Any, change: Callable[[Opening], Expression]) -> Any:
    """A condition, or a part of one, with what `change` makes of the values at an opening in it."""
    return with_reads(part, lambda read: change(read) if isinstance(read, Opening) else read)


def with_reads(part: Any, change: Callable[[Read], Expression]) -> Any:
    """A condition, or a part of one, with what `change` makes of everything that is read in it."""
    if isinstance(part, Read):
        return change(part)
    if isinstance(part, tuple):
        return tuple(with_reads(each, change) for each in part)
    if not isinstance(part, Expression | Condition):
        return part
    return type(part)(*(with_reads(getattr(part, each.name), change) for each in fields(part)))


def nested(condition: Condition) -> Iterator[Condition]:
    """`condition`, and those that are asked of elements in it."""
    yield condition
    for part in (part for operand in operands(condition) for part in subexpressions(operand)):
        if isinstance(part, Count):
            yield from (inner for _, inner in part.conditions)
