"""Is a measured number compared for exact equality?"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence

from ltlc.analysis.findings import Finding
from ltlc.analysis.subjects import Study
from ltlc.base.diagnostics import Fix, Help, Label
from ltlc.base.source import Source, Span
from ltlc.specification.atoms import Atom, nested
from ltlc.specification.expressions import (
    Arithmetic,
    Call,
    Comparison,
    Condition,
    Count,
    Current,
    Element,
    Expression,
    Field,
    Negative,
    Number,
    Opening,
    Operator,
    Past,
    Relation,
    Same,
    Slice,
    operands,
)
from ltlc.specification.functions import Function
from ltlc.specification.text import as_written, text
from ltlc.specification.wire import Kind

COMMANDS = frozenset({"geometry_msgs/msg/Twist"})
"""Messages whose numbers a program has chosen: the command to stop is exactly 0."""

USUAL_MARGIN = 0.01
"""A centimetre, a hundredth of a radian: the margin that is proposed where the numbers suggest no other."""


def ask(study: Study) -> Iterator[Finding]:
    """A warning for each such comparison, with the margin to write, where it stands first."""
    uses: dict[str, list[Atom]] = {}
    sent = frozenset(guard.out for guard in study.specification.guards)
    for atom in measured_equalities([a for subject in study.subjects for a in subject.specification.atoms], sent):
        uses.setdefault(atom.name, []).append(atom)
    for first, *others in uses.values():
        yield _finding(study.specification.source, first, [atom.span for atom in others])


def measured_equalities(atoms: Sequence[Atom], sent: frozenset[str] = frozenset()) -> list[Atom]:
    """Those of `atoms` that compare measured numbers for equality without a margin, other than to see a change.

    Numbers on topics that guards have `sent` on are not measured.
    """
    exact = [atom for atom in atoms if any(map(_is_exact, nested(atom.condition)))]
    if not exact:
        return []
    return [atom for atom in exact if any(_is_measured(each, sent) for each in nested(atom.condition))]


def _is_measured(condition: Condition, sent: frozenset[str]) -> bool:
    return _is_exact(condition) and not all(_counts(operand, sent) for operand in operands(condition))


def _is_exact(condition: Condition) -> bool:
    is_equality = isinstance(condition, Comparison) and condition.relation is Relation.EQUAL and condition.margin == 0
    return is_equality and not is_change(condition)


def is_change(condition: Condition) -> bool:
    """Whether `condition` compares a sample of a signal with the one before it, without a number between them."""
    match condition:
        case Comparison(margin=margin) if margin != 0:
            return False
        case Comparison() | Same():
            sides = {condition.left, condition.right}
            return any({side, Past(side.signal, 1)} == sides for side in sides if isinstance(side, Current))
        case _:
            return False


def _counts(expression: Expression, sent: frozenset[str]) -> bool:
    """Whether `expression` is exact: a constant, or computed from whole numbers and commands without division."""
    match expression:
        case Number() | Count() | Call(Function.LEN | Function.FLOOR | Function.CEIL | Function.SIGN):
            return True
        case Slice(array) | Element(array):
            return _counts(array, sent)
        case Current(signal) | Past(signal, _) | Opening(signal):
            definition = signal.definition
            if isinstance(definition, Field):
                is_command = definition.message in COMMANDS or definition.topic in sent
                return is_command or definition.numbers.kind is Kind.INTEGER
            return _counts(definition, sent)
        case Negative(operand):
            return _counts(operand, sent)
        case Arithmetic(operator, left, right):
            return operator is not Operator.OVER and _counts(left, sent) and _counts(right, sent)
        case Call(function, arguments):
            is_exact = function.value in ("abs", "min", "max", "sum", "mod")
            return is_exact and all(_counts(argument, sent) for argument in arguments)
        case _:
            return False


def _finding(source: Source, atom: Atom, others: Sequence[Span]) -> Finding:
    left, right = operands(next(condition for condition in nested(atom.condition) if _is_exact(condition)))
    margin = f"{_margin(left, right):g}"
    setting = Fix(f"add `_margin_ = {margin}` as the first line", ((Span(0, 0), f"_margin_ = {margin}\n"),))
    equality = re.compile("==|!=").search(source.text, atom.span.start, atom.span.end)
    if equality is None:  # the place of a name that stands for the comparison
        better, fixes = as_written(f"{text(left)} =={{{margin}}} {text(right)}"), [setting]
    else:
        edits = {Span(equality.end(), equality.end()): f"{{{margin}}}"}
        better = " ".join(source.replaced(atom.span, edits).split())
        fixes = [Fix(f"write `{better}`", tuple(edits.items())), setting]
    return Finding(
        "LTL520",
        atom.span,
        f"`{as_written(atom.name)}` compares measured numbers exactly and hardly ever holds",
        secondary=tuple(Label(span, "and here") for span in others),
        help=Help(f"allow a margin, as in `{better}`, or `_margin_ = {margin}` for the whole file", tuple(fixes)),
    )


def _margin(left: Expression, right: Expression) -> float:
    """A hundredth of the order of magnitude of the constant that is compared with."""
    constants = [abs(side.value) for side in (left, right) if isinstance(side, Number)]
    if not constants or constants[0] == 0 or not math.isfinite(constants[0]):
        return USUAL_MARGIN
    return float(10.0 ** (math.floor(math.log10(constants[0])) - 2))
