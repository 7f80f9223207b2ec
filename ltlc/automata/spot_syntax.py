"""Reads formulas in Spot's syntax, with Spot's own parser, into core LTL."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ltlc.automata.engine import spot
from ltlc.semantics.ltl import (
    FALSE,
    TRUE,
    And,
    Atom,
    Formula,
    Next,
    Not,
    Until,
    conjunction,
    disjunction,
    eventually,
    globally,
    implies,
    release,
    strong_release,
    weak_next,
    weak_until,
)

MOST_CHARACTERS = 50_000
"""A longer text is not tried: Spot's parser has no bound on its stack."""

MOST_NESTED = 150
"""Operators inside one another: what comes after the parser works on trees by recursion."""

_UNARY: dict[str, Callable[[Formula], Formula]] = {
    "Not": Not,
    "X": weak_next,
    "strong_X": Next,
    "F": eventually,
    "G": globally,
}
_BINARY: dict[str, Callable[[Formula, Formula], Formula]] = {
    "U": Until,
    "R": release,
    "W": weak_until,
    "M": strong_release,
    "Implies": implies,
    "Equiv": lambda left, right: And(implies(left, right), implies(right, left)),
    "Xor": lambda left, right: Not(And(implies(left, right), implies(right, left))),
}
_MANY: dict[str, Callable[[list[Formula]], Formula]] = {"And": conjunction, "Or": disjunction}
_CONSTANTS: dict[str, Formula] = {"tt": TRUE, "ff": FALSE}


class SpotSyntaxError(ValueError):
    """A text is not a formula of LTL; `offset` is the place, in characters from 0."""

    def __init__(self, reason: str, offset: int) -> None:
        super().__init__(reason)
        self.offset = offset


def parse(text: str) -> Formula:
    """The formula that `text` is in Spot's syntax; `X` is the weak next, `X[!]` the strong one.

    Raises SpotSyntaxError.
    """
    if len(text) > MOST_CHARACTERS:
        raise SpotSyntaxError(f"a formula of more than {MOST_CHARACTERS} characters", 0)
    _check_brackets(text)
    try:
        formula = spot.formula(text)
    except SyntaxError as error:
        raise _explained(str(error), text) from None
    except RuntimeError as error:
        raise SpotSyntaxError(str(error), 0) from None
    if not formula.is_ltl_formula():
        raise SpotSyntaxError("this is a formula of PSL, not of LTL", 0)
    return _converted(formula, MOST_NESTED)


def _check_brackets(text: str) -> None:
    """Refuse brackets that are nested too deeply: where they do not close, Spot takes time and memory without bound."""
    depth = 0
    for offset, character in enumerate(text):
        depth += (character in "([{") - (character in ")]}")
        if depth > MOST_NESTED:
            raise SpotSyntaxError("the formula is nested too deeply", offset)


def _explained(message: str, text: str) -> SpotSyntaxError:
    """The first complaint of Spot's, three lines: the text after `>>> `, a mark under the place, the reason."""
    lines = [line for line in message.splitlines() if line.strip()]
    marks = [k for k, line in enumerate(lines) if line.strip(" ^") == ""]
    if not marks or marks[0] + 1 >= len(lines):
        return SpotSyntaxError(message.strip() or "not a formula", 0)
    column = lines[marks[0]].index("^") - len(">>> ")
    # Spot counts bytes.
    offset = len(text.encode()[: max(0, column)].decode(errors="ignore"))
    return SpotSyntaxError(lines[marks[0] + 1].removeprefix("syntax error, "), offset)


def _converted(formula: Any, depth: int) -> Formula:
    if depth == 0:
        raise SpotSyntaxError("the formula is nested too deeply", 0)
    kind = formula.kindstr()
    if kind == "ap":
        return Atom(str(formula.ap_name()))
    if kind in _CONSTANTS:
        return _CONSTANTS[kind]
    parts = [_converted(part, depth - 1) for part in formula]
    if kind in _UNARY:
        return _UNARY[kind](*parts)
    if kind in _BINARY:
        return _BINARY[kind](*parts)
    if kind in _MANY:
        return _MANY[kind](parts)
    raise SpotSyntaxError(f"`{formula}` is not LTL", 0)
