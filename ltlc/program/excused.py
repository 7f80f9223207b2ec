"""What stands in for a signal that a property does not wait for, while no message has brought it.

No state predicate depends on it then (`specification.arrivals`). So any of its values will do: the letter is one that
exists, and each predicate has the value that it has. One is chosen with which every expression that is computed has a
value; where there is none, the property waits.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from ltlc.program.expressions import Held, News, may_be_nan
from ltlc.program.lowering import lowered, undefined_parts
from ltlc.program.machine import Excused, Instead
from ltlc.program.types import type_of
from ltlc.specification.arrivals import read_with_news
from ltlc.specification.evaluation import number
from ltlc.specification.expressions import (
    Arithmetic,
    Call,
    Current,
    Element,
    Expression,
    Negative,
    Number,
    Slice,
    ValueType,
    inputs,
    openings,
    subexpressions,
)
from ltlc.specification.numbers import numbers_of
from ltlc.specification.specification import PropertySpecification

_NOTHING: dict[ValueType, Instead] = {ValueType.BOOLEAN: False, ValueType.STRING: ""}


def excused(specification: PropertySpecification) -> tuple[Excused, ...]:
    """The inputs that a property does not wait for, in the order of its inputs."""
    computed = [part for atom in specification.atoms for part in undefined_parts(atom.condition)]
    found = []
    for wanted, news in read_with_news(specification).items():
        reading = [part for part in computed if wanted in inputs(part)]
        instead = next((v for v in _values(wanted, reading) if all(_has_value(p, wanted, v) for p in reading)), None)
        if instead is not None:
            found.append(Excused(_held(wanted), tuple(News(new.signal.name) for new in news), instead))
    at_first = ((i, i.signal.otherwise) for i in specification.inputs() if isinstance(i, Current))
    return (*found, *(Excused(_held(i), (), constant.value) for i, constant in at_first if constant is not None))


def _held(wanted: Current) -> Held:
    return Held(wanted.signal.name, 0, type_of(wanted.signal))


def _values(wanted: Current, reading: Sequence[Expression]) -> Iterator[Instead]:
    """Values of a signal, 0 or nothing first; with the constants that it is computed with, and numbers beside them."""
    inside = [part for expression in reading for part in subexpressions(expression)]
    match wanted.signal.type:
        case ValueType.NUMBER:
            numbers = numbers_of(wanted)
            constants = [0.0, *(part.value for part in inside if isinstance(part, Number))]
            beside = [numbers.nearest(constant + side) for constant in constants for side in (0, 1, -1)]
            yield from (value for value in beside if numbers.has(value))
        case ValueType.NUMBERS:
            ends = (abs(end) for part in inside if isinstance(part, Slice) for end in (part.start, part.stop) if end)
            yield from ((0.0,) * length for length in (0, 1, max(ends, default=0) + 1))
        case other:
            yield _NOTHING.get(other, ())


def _has_value(part: Expression, wanted: Current, value: Instead) -> bool:
    """Whether `part` has a value whatever else it reads; 0 has to be one that it can have, since C takes that for it.

    What is compared with a value at an opening is computed by C at each step, of zeros.
    """
    is_kept = any(True for _ in openings(part))
    return not is_kept and numbers_of(part).has(0.0) and not may_be_nan(lowered(_with(part, wanted, value)))


def _with(part: Expression, wanted: Current, value: Instead) -> Expression:
    """`part` with numbers in place of what is computed of `wanted` alone."""
    if set(inputs(part)) == {wanted} and not isinstance(part, Slice | Element) and not _is_array(part):
        return Number(number(part, {wanted: value}))
    match part:
        case Negative(operand):
            return Negative(_with(operand, wanted, value))
        case Arithmetic(operator, left, right):
            return Arithmetic(operator, _with(left, wanted, value), _with(right, wanted, value))
        case Call(_, arguments) if part.array is None:
            return replace(part, arguments=tuple(_with(argument, wanted, value) for argument in arguments))
        case _:
            return part


def _is_array(part: Expression) -> bool:
    return isinstance(part, Current) and part.signal.type.element is not None
