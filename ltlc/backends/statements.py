"""Nested `if` statements as trees, put as a person would: nothing twice, no `if` that could be an `and`."""

from __future__ import annotations

from collections.abc import Sequence

from ltlc.backends.trees import Chain, Code, Infix
from ltlc.dataclass import dataclass

_ASCENDING, _DESCENDING = ("<", "<="), (">", ">=")


@dataclass(frozen=True, slots=True)
class If:
    """`if guard: then else: otherwise`; `remark` is a comment behind the guard. `then` is not empty."""

    guard: Code
    then: tuple[Statement, ...]
    otherwise: tuple[Statement, ...] = ()
    remark: str = ""


@dataclass(frozen=True, slots=True)
class Do:
    """The statement that consists of `prefix`, such as `value = `, and an expression."""

    prefix: str
    code: Code


Statement = If | Do | str


def choice(guard: Code, then: tuple[Statement, ...], otherwise: tuple[Statement, ...]) -> If:
    """`if guard: then else: otherwise`, of which `then` is not empty, in the plainest form."""
    match then, otherwise:
        case (If(inner, body, (), remark),), ():
            return If(conjunction([guard, inner]), body, (), remark)
        case _, (If(second, same, rest, _),) if then == same:
            return choice(disjunction([guard, second]), then, rest)
    return If(guard, then, otherwise)


def conjunction(parts: Sequence[Code]) -> Code:
    """All of `parts`; `a < b` and `b < c` are one comparison."""
    joined: list[Code] = []
    for part in _flattened(parts, "and"):
        chain = _chain(joined[-1], part) if joined else None
        joined[-1:] = [chain] if chain else [*joined[-1:], part]
    return joined[0] if len(joined) == 1 else Infix("and", tuple(joined))


def disjunction(parts: Sequence[Code]) -> Code:
    """At least one of `parts`."""
    joined = _flattened(parts, "or")
    return joined[0] if len(joined) == 1 else Infix("or", tuple(joined))


def _flattened(parts: Sequence[Code], operator: str) -> list[Code]:
    flat: list[Code] = []
    for part in parts:
        flat += part.operands if isinstance(part, Infix) and part.operator == operator else (part,)
    return flat


def _chain(left: Code, right: Code) -> Chain | None:
    """`a < b` and `b < c` as `a < b < c`."""
    if not isinstance(left, Chain) or not isinstance(right, Chain) or left.operands[-1] != right.operands[0]:
        return None
    operators = left.operators + right.operators
    if any(all(o in direction for o in operators) for direction in (_ASCENDING, _DESCENDING)):
        return Chain(left.operands + right.operands[1:], operators)
    return None
