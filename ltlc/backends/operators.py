"""Expressions as C and Rust write them, in one line or laid out on several."""

from __future__ import annotations

from collections.abc import Sequence

from ltlc.backends.notation import Notation
from ltlc.backends.trees import INDENT, LINE_LENGTH, Call, Code, Infix

_C = Notation({"and": "&&", "or": "||", "not ": "!"}, negation=6, contexts={"or": (2, 2), "and": (1, 1)}, chains=False)

flat = _C.flat
"""An expression in one line; what a compiler would ask parentheses for has them."""


def layout(prefix: str, code: Code, suffix: str) -> list[str]:
    """`prefix`, `code` and `suffix`: in one line, or broken before the outermost operators, or after commas."""
    line = f"{prefix}{flat(code)}{suffix}"
    if len(line) <= LINE_LENGTH:
        return [line]
    inner = prefix[: len(prefix) - len(prefix.lstrip())] + INDENT * 2
    match code:
        case Infix():
            pieces = _C.pieces(code)
        case Call(function, arguments):
            prefix, suffix = f"{prefix}{function}(", f"){suffix}"
            pieces = [f"{flat(a)}," for a in arguments[:-1]] + [flat(a) for a in arguments[-1:]]
        case _:
            return [line]
    return filled(prefix, pieces, suffix, inner)


def filled(prefix: str, pieces: Sequence[str], suffix: str, indent: str) -> list[str]:
    """`pieces` between `prefix` and `suffix`, as many on a line as fit; further lines are indented by `indent`."""
    lines, current = [], prefix
    for number, piece in enumerate(pieces):
        text = piece + (suffix if number == len(pieces) - 1 else "")
        gap = " " if current[-1:] not in ("", " ", "(") else ""
        if number and len(current) + len(gap) + len(text) > LINE_LENGTH:
            lines.append(current)
            current, gap = indent, ""
        current += gap + text
    return [*lines, current if pieces else prefix + suffix]
