"""Expressions in one line, as a language writes them: its operators, and where these ask for parentheses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from ltlc.backends.trees import Call, Chain, Code, Each, Infix, Prefix, Text

_STRENGTHS = {"or": 0, "and": 1, "+": 4, "-": 4, "*": 5, "/": 5}
_COMPARISON, _UNARY, _PRIMARY = 3, 6, 7


class Notation(NamedTuple):
    """How a language writes what trees call `and`, `or` and `not `, and how tightly `negation` binds there.

    Within `and` and `or`, what has no parentheses binds as tightly as `contexts` say of the first part and the further
    ones. With `chains`, `a < b < c` is a comparison.
    """

    operators: Mapping[str, str]
    negation: int
    contexts: Mapping[str, tuple[int, int]]
    chains: bool

    def strength(self, code: Code) -> int:
        """How tightly the outermost operator binds."""
        match code:
            case Prefix("not ", _):
                return self.negation
            case Infix(operator, _):
                return _STRENGTHS[operator]
            case Chain(operands, _):
                return _COMPARISON if self.chains or len(operands) == 2 else _STRENGTHS["and"]
            case Prefix():
                return _UNARY
            case Text(text) if text.startswith(("-", "(")):
                return _UNARY
            case _:
                return _PRIMARY

    def flat(self, code: Code) -> str:
        """`code` in one line."""
        match code:
            case Text(text):
                return text
            case Prefix(operator, operand):
                text = self.operand(operand, self.strength(code))
                sign = self.operators.get(operator, operator)
                return f"{sign}({text})" if sign == text[:1] == "-" else f"{sign}{text}"
            case Infix():
                return " ".join(self.pieces(code))
            case Chain(operands, operators):
                return self._compared([self.operand(each, _COMPARISON + 1) for each in operands], operators)
            case Call(function, arguments):
                return f"{function}({', '.join(map(self.flat, arguments))})"
            case Each():
                return " ".join(f"{start}{self.flat(part)}" for start, part in clauses(code))

    def operand(self, code: Code, context: int) -> str:
        """`code` beside an operator that binds so tightly."""
        return f"({self.flat(code)})" if self.strength(code) < context else self.flat(code)

    def pieces(self, code: Infix) -> list[str]:
        """The first operand, then each further one behind the operator."""
        own, operator = _STRENGTHS[code.operator], self.operators.get(code.operator, code.operator)
        first, further = self.contexts.get(code.operator, (own, own + 1))
        one, *others = code.operands
        return [self.operand(one, first), *(f"{operator} {self.operand(other, further)}" for other in others)]

    def _compared(self, parts: list[str], operators: tuple[str, ...]) -> str:
        links = [f"{operator} {right}" for operator, right in zip(operators, parts[1:], strict=True)]
        if self.chains:
            return " ".join([parts[0], *links])
        return " && ".join(f"{left} {link}" for left, link in zip(parts, links, strict=False))


def clauses(each: Each) -> Iterator[tuple[str, Code]]:
    """What a generator consists of, each part with the word before it."""
    yield "", each.result
    yield from (("for ", items) for items in each.loops)
    yield "if ", each.guard
