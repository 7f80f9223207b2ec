"""What the conditions of properties are after a guard has sent a fallback."""

from __future__ import annotations

from typing import assert_never

from ltlc.specification.atoms import with_reads
from ltlc.specification.evaluation import truth
from ltlc.specification.expressions import (
    Boolean,
    Comparison,
    Condition,
    Current,
    Expression,
    Field,
    New,
    Number,
    Opening,
    Past,
    Read,
    Recent,
    Signal,
    Slope,
    String,
    ValueType,
    operands,
    reads,
)
from ltlc.specification.guards import Constant, Fallback
from ltlc.specification.specification import topics_of

_ZEROS: dict[ValueType, Constant] = {
    ValueType.NUMBER: Number(0.0),
    ValueType.BOOLEAN: Boolean(False),
    ValueType.STRING: String(""),
}


def condition_after(condition: Condition, out: str, fallback: Fallback) -> Condition | bool | None:
    """`condition` after `fallback` has been sent on the topic `out`, in terms of what was held before.

    It is a boolean where nothing that is held matters, and None where it is not known, or has no value (0/0). A
    condition that does not read `out` is itself.
    """
    after = {read: _after(read, out, fallback) for operand in operands(condition) for read in reads(operand)}
    known = {read: expression for read, expression in after.items() if expression is not None}
    if len(known) < len(after):
        return None
    changed: Condition = with_reads(condition, known.__getitem__)
    if not any(_is_held(operand) for operand in operands(changed)):
        return truth(changed, {})
    return changed if changed == condition else _in_order(changed)


def _is_held(expression: Expression) -> bool:
    return any(True for _ in reads(expression))


def _in_order(condition: Condition) -> Condition:
    """`condition` with a constant on the right, as the language has it, so that equal conditions are the same."""
    match condition:
        case Comparison(left, relation, right, margin) if not margin and not _is_held(left):
            return Comparison(right, relation.flipped, left)
        case _:
            return condition


def value_in(fallback: Fallback, signal: Signal) -> Constant | None:
    """The sample that `fallback`, a message of the signal's topic, has of `signal`; None if that is not one constant.

    It is not for arrays and their elements, and for what is computed.
    """
    if not isinstance(signal.definition, Field):
        return None
    path = tuple(step for step in signal.definition.path if isinstance(step, str))
    if not path or len(path) < len(signal.definition.path):
        return None
    return fallback.values.get(path, _ZEROS.get(signal.type))


def _after(read: Read, out: str, fallback: Fallback) -> Expression | None:
    if out not in topics_of(read.signal):
        return read
    match read:
        case New():
            return Boolean(True)
        case Current(signal):
            constant = value_in(fallback, signal)
            return _computed(signal, out, fallback) if constant is None else constant
        case Past(signal, 1):
            return Current(signal)
        case Past(signal, samples):
            return Past(signal, samples - 1)
        case Recent() | Slope() | Opening():
            return None
        case _:
            assert_never(read)


def _computed(signal: Signal, out: str, fallback: Fallback) -> Expression | None:
    """A signal that is computed from others, as it is after a fallback that brings it a sample."""
    if isinstance(signal.definition, Field) or signal.when is not None:
        return None
    after = {read: _after(read, out, fallback) for read in reads(signal.definition)}
    known = {read: expression for read, expression in after.items() if expression is not None}
    if len(known) < len(after):
        return None
    changed: Expression = with_reads(signal.definition, known.__getitem__)
    return changed
