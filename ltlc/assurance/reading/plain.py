"""Plain trees: functions as two languages with the same statements have them, one printed from the other."""

from __future__ import annotations

Tree = str | tuple["Tree", ...]
"""A part of a function: a name or a number, or what it is, followed by its parts."""


def joined(operator: str, left: Tree, right: Tree) -> Tree:
    """An operator between two; of `&&` and `||`, all parts together; a number that differs from itself is NaN."""
    match operator:
        case "&&" | "||":
            return operator, *(part for side in (left, right) for part in _parts(operator, side))
        case "!=" if left == right:
            return "nan", left
        case "==" if left == right:
            return "!", ("nan", left)
        case _:
            return operator, left, right


def _parts(operator: str, side: Tree) -> tuple[Tree, ...]:
    return side[1:] if isinstance(side, tuple) and side[0] == operator else (side,)
