"""Is a measured number compared for exact equality?"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence

from ltlc.analysis.findings import Finding
from ltlc.analysis.subjects import Study
from ltlc.diagnostics import Label
from ltlc.messages.definitions import FieldType, MessageTypes, message_types
from ltlc.source import Span
from ltlc.specification.atoms import Atom, Comparison, Condition, Relation, Same, operands
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

COMMANDS = frozenset({"geometry_msgs/msg/Twist"})
"""Messages whose numbers a program has chosen: a robot is told to stop with exactly 0."""

FLOATS = frozenset({"float", "float32", "float64", "float128", "double"})
"""The primitive types whose values are measured; the others count."""

USUAL_MARGIN = 0.01
"""A centimetre, a hundredth of a radian: the margin that is proposed where the numbers suggest no other."""


def ask(study: Study) -> Iterator[Finding]:
    """A warning for each such comparison, with the margin to write, where it stands first."""
    uses: dict[str, list[Atom]] = {}
    for atom in measured_equalities(study, [a for subject in study.subjects for a in subject.specification.atoms]):
        uses.setdefault(atom.name, []).append(atom)
    for first, *others in uses.values():
        yield _finding(study.specification.source.excerpt(first.span), first, [atom.span for atom in others])


def measured_equalities(study: Study, atoms: Sequence[Atom]) -> list[Atom]:
    """Those of `atoms` that compare measured numbers for equality without a margin, other than to see a change."""
    exact = [atom for atom in atoms if _is_exact(atom.condition) and not is_change(atom.condition)]
    if not exact:
        return []
    types, _ = message_types(study.message_paths)
    return [atom for atom in exact if not all(_counts(side, types) for side in operands(atom.condition))]


def _is_exact(condition: Condition) -> bool:
    return isinstance(condition, Comparison) and condition.relation is Relation.EQUAL and condition.margin == 0


def is_change(condition: Condition) -> bool:
    """Whether `condition` compares a sample of a signal with the one before it, without a number between them."""
    match condition:
        case Comparison(margin=margin) if margin != 0:
            return False
        case Comparison() | Same():
            sides = {condition.left, condition.right}
            return any({side, Past(side.signal, 1)} == sides for side in sides if isinstance(side, Current))
    return False


def _counts(expression: Expression, types: MessageTypes) -> bool:
    """Whether `expression` is exact: a constant, or computed from whole numbers and commands without division."""
    match expression:
        case Number():
            return True
        case Current(signal) | Past(signal, _):
            definition = signal.definition
            if isinstance(definition, Field):
                return definition.message in COMMANDS or _field_type(definition, types).base not in FLOATS
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


def _finding(excerpt: str, atom: Atom, others: Sequence[Span]) -> Finding:
    left, right = operands(atom.condition)
    margin = f"{_margin(left, right):g}"
    better = re.sub("==|!=", lambda match: f"{match.group()}{{{margin}}}", excerpt, count=1)
    if better == excerpt:  # the place of a name that stands for the comparison
        better = f"{text(left)} =={{{margin}}} {text(right)}"
    return Finding(
        "LTL520",
        atom.span,
        f"`{atom.name}` compares measured numbers exactly: it hardly ever holds",
        secondary=tuple(Label(span, "and here") for span in others),
        help=f"allow a margin, as in `{better}`, or for the whole file with `_margin_ = {margin}`",
    )


def _margin(left: Expression, right: Expression) -> float:
    """A hundredth of the order of magnitude of the constant that is compared with."""
    constants = [abs(side.value) for side in (left, right) if isinstance(side, Number)]
    if not constants or constants[0] == 0 or not math.isfinite(constants[0]):
        return USUAL_MARGIN
    return float(10.0 ** (math.floor(math.log10(constants[0])) - 2))
