"""What stands behind a value: components of vectors, angles of orientations, elements of arrays."""

from __future__ import annotations

from collections.abc import Sequence

from ltlc.language.names import Checker
from ltlc.language.signals import signal
from ltlc.language.types import MAX_DIGITS
from ltlc.language.values import Array, Orientation, Scalar, Value, Vector
from ltlc.nearest import did_you_mean
from ltlc.specification.expressions import Current, Field
from ltlc.syntax import tree as syntax


def member(checker: Checker, steps: Sequence[syntax.Word | syntax.NumberLiteral], base: Value) -> Value | None:
    """What `steps` select in `base`: components of vectors, angles of orientations, elements of arrays."""
    current: Value | None = base
    for step in steps:
        if current is None:
            return None
        if isinstance(step, syntax.NumberLiteral):
            current = _element(checker, step, current)
        else:
            current = _component(checker, step, current)
    return current


def _component(checker: Checker, step: syntax.Word, base: Value) -> Value | None:
    choices: dict[str, Value] = {}
    if isinstance(base, Vector):
        choices = dict(zip("xyz", map(Scalar, base.components), strict=True))
    if isinstance(base, Orientation):
        choices = {angle: Scalar(e) for angle, e in base.angles}
        choices |= dict(zip("xyzw", map(Scalar, base.components), strict=True))
    if step.text in choices:
        return choices[step.text]
    help = did_you_mean(step.text, choices) or " ".join(f"`.{c}`" for c in choices)
    checker.report("LTL105", step.span, f"{base.noun} has no `{step.text}`", help=help)
    return None


def _element(checker: Checker, step: syntax.NumberLiteral, base: Value) -> Value | None:
    """An element of an array that is a signal; a signal itself."""
    if not isinstance(base, Array) or not isinstance(base.expression, Current):
        what = "the past of an array" if isinstance(base, Array) else base.noun
        checker.report("LTL212", step.span, f"{what} has no elements")
        return None
    if not step.text.isdigit() or len(step.text) > MAX_DIGITS:
        checker.report("LTL212", step.span, f"`{step.text}` is not an index", help="an index looks like `[0]`")
        return None
    array = base.expression.signal
    assert isinstance(array.definition, Field)
    index = int(step.text)
    field = Field(array.definition.topic, array.definition.message, (*array.definition.path, index))
    return Scalar(signal(f"{array.name}[{index}]", field))
