"""Is a measured number compared for exact equality?"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

from ltlc.analysis.findings import Finding
from ltlc.analysis.subjects import Study, Subject
from ltlc.messages.definitions import FieldType, MessageTypes, message_types
from ltlc.specification.atoms import Atom, Comparison, Relation
from ltlc.specification.expressions import (
    Arithmetic,
    Call,
    Current,
    Expression,
    Field,
    Negative,
    Number,
    Operator,
    Past,
)
from ltlc.specification.text import text

FLOATS = frozenset({"float", "float32", "float64", "float128", "double"})
"""The primitive types whose values are measured; the others count."""

USUAL_MARGIN = 0.01
"""A centimetre, a hundredth of a radian: the margin that is proposed where the numbers suggest no other."""


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A warning for each such comparison, with the margin to write."""
    exact = [atom for atom in subject.specification.atoms if _is_exact(atom)]
    if not exact:
        return
    types, _ = message_types(study.message_paths)
    for atom in exact:
        if isinstance(atom.condition, Comparison) and not _is_whole(atom.condition, types):
            yield _finding(study.specification.source.excerpt(atom.span), atom, atom.condition)


def _is_exact(atom: Atom) -> bool:
    condition = atom.condition
    return isinstance(condition, Comparison) and condition.relation is Relation.EQUAL and condition.margin == 0


def _is_whole(comparison: Comparison, types: MessageTypes) -> bool:
    """Whether both sides are computed from whole numbers only."""
    return _counts(comparison.left, types) and _counts(comparison.right, types)


def _counts(expression: Expression, types: MessageTypes) -> bool:
    """Whether `expression` is exact: a constant, or computed from whole numbers without division."""
    match expression:
        case Number():
            return True
        case Current(signal) | Past(signal, _):
            definition = signal.definition
            if isinstance(definition, Field):
                return _field_type(definition, types).base not in FLOATS
            return _counts(definition, types)
        case Negative(operand):
            return _counts(operand, types)
        case Arithmetic(operator, left, right):
            return operator is not Operator.OVER and _counts(left, types) and _counts(right, types)
        case Call(function, arguments):
            return function.value in ("abs", "min", "max") and all(_counts(a, types) for a in arguments)
    return False


def _field_type(field: Field, types: MessageTypes) -> FieldType:
    """The type of the value that `field` reads."""
    found = FieldType(field.message)
    for step in field.path:
        # A step that is no name picks an element of a list, which has the list's base.
        found = types.messages[found.base].fields[step] if isinstance(step, str) else FieldType(found.base)
    return found


def _finding(excerpt: str, atom: Atom, comparison: Comparison) -> Finding:
    margin = f"{_margin(comparison):g}"
    better = re.sub("==|!=", lambda match: f"{match.group()}{{{margin}}}", excerpt, count=1)
    if better == excerpt:  # the place of a name that stands for the comparison
        better = f"{text(comparison.left)} =={{{margin}}} {text(comparison.right)}"
    return Finding(
        "LTL520",
        atom.span,
        f"`{atom.name}` compares measured numbers exactly: it hardly ever holds",
        help=f"allow a margin, as in `{better}`, or for the whole file with `_margin_ = {margin}`",
    )


def _margin(comparison: Comparison) -> float:
    """A hundredth of the order of magnitude of the constant that is compared with."""
    constants = [abs(side.value) for side in (comparison.left, comparison.right) if isinstance(side, Number)]
    if not constants or constants[0] == 0 or not math.isfinite(constants[0]):
        return USUAL_MARGIN
    return float(10.0 ** (math.floor(math.log10(constants[0])) - 2))
