"""The topics that guards send on: a function that says where commands come from, and what is sent instead."""

from __future__ import annotations

from collections.abc import Sequence

from ltlc.backends.python.code import Group, literal, tuple_of
from ltlc.backends.trees import INDENT
from ltlc.specification.expressions import Boolean, Number, String
from ltlc.specification.guards import Constant, Fallback, FieldPath, Guard


def guarded_code(guards: Sequence[Guard]) -> list[str]:
    """The lines of `topics_to_guard`."""
    made = tuple_of(map(_topic, guards), "return (", wide=True) if guards else Group("return (", (), ")")
    return [
        "def topics_to_guard() -> Sequence[GuardedTopic]:",
        f'{INDENT}"""The topics that guards send on."""',
        *made.lines(INDENT),
    ]


def _topic(guard: Guard) -> Group:
    fallbacks = tuple_of(map(_fallback, guard.fallbacks))
    return Group("GuardedTopic(", (literal(guard.raw), literal(guard.out), fallbacks), ")")


def _fallback(fallback: Fallback) -> Group:
    fields = tuple_of(_field(path, value) for path, value in fallback.values.items())
    return Group("Fallback(", (literal(fallback.name), fields), ")")


def _field(path: FieldPath, value: Constant) -> Group:
    return tuple_of((tuple_of(map(literal, path)), _constant(value)))


def _constant(constant: Constant) -> str:
    match constant:
        case Number(value):
            return repr(value)
        case Boolean(value):
            return repr(value)
        case String(value):
            return literal(value)
