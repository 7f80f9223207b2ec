"""Reads the right side of an encoding's equation: a formula over named letters, operators and `rel`.

    G((X & !Y) -> rel(Y, Z))

The operators are Spot's, with its strengths: `-> <->`, then `|`, `&`, `U W R M` (all to the right), then `! F G`.
Since X is a letter here, next is a function: `next(φ)` is the strong one, `weak_next(φ)` the other. `rel(Y, φ)` is φ
judged on the segment that ends before the next Y.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.nearest import did_you_mean
from ltlc.base.source import Source, Span
from ltlc.dataclass import dataclass
from ltlc.semantics.encodings import relativise
from ltlc.semantics.ltl import (
    FALSE,
    TRUE,
    And,
    Atom,
    Formula,
    Next,
    Not,
    Or,
    Until,
    eventually,
    globally,
    implies,
    is_propositional,
    release,
    strong_release,
    weak_next,
    weak_until,
)

MOST_NESTED = 50
"""Operators inside one another: what comes after the parser works on trees by recursion."""

Term = Callable[[Mapping[str, Formula]], Formula]
"""A formula that waits for what its letters stand for."""


@dataclass(frozen=True)
class Equation:
    """The right side of an equation: `of(letters)` is the formula, `uses` the letters in it."""

    of: Term
    uses: frozenset[str]


class EquationError(Exception):
    """The text is not a formula; the diagnostic says where and why."""

    def __init__(self, found: Diagnostic) -> None:
        super().__init__(found.message)
        self.diagnostic = found


@dataclass(frozen=True, slots=True)
class _Token:
    text: str
    span: Span


_TOKEN = re.compile(r"\s*(<->|<=>|->|=>|&&|\|\||<>|\[\]|[A-Za-z_]\w*|\d+|\S)")

_SYMBOLS = {
    **dict.fromkeys(("!", "~", "¬", "not"), "!"),
    **dict.fromkeys(("&", "&&", "∧", "and"), "&"),
    **dict.fromkeys(("|", "||", "∨", "or"), "|"),
    **dict.fromkeys(("->", "=>", "→", "implies"), "->"),
    **dict.fromkeys(("<->", "<=>", "↔"), "<->"),
    **dict.fromkeys(("F", "<>", "◇", "eventually"), "F"),
    **dict.fromkeys(("G", "[]", "□", "always"), "G"),
    **dict.fromkeys(("true", "1", "⊤"), "true"),
    **dict.fromkeys(("false", "0", "⊥"), "false"),
}
"""The ways to write an operator or a constant."""

_BINARY: tuple[dict[str, Callable[[Formula, Formula], Formula]], ...] = (
    {"->": implies, "<->": lambda left, right: And(implies(left, right), implies(right, left))},
    {"|": Or},
    {"&": And},
    {"U": Until, "W": weak_until, "R": release, "M": strong_release},
)
"""The binary operators, from the loosest to the tightest."""

_UNARY: dict[str, Callable[[Formula], Formula]] = {"!": Not, "F": eventually, "G": globally}
_FUNCTIONS: dict[str, Callable[[Formula], Formula]] = {"next": Next, "weak_next": weak_next}
_CONSTANTS: dict[str, Formula] = {"true": TRUE, "false": FALSE}


def parse_equation(source: Source, span: Span, letters: Collection[str], events: Collection[str]) -> Equation:
    """The formula that `source` has in `span`, over `letters`, of which `events` are state predicates.

    Raises EquationError.
    """
    parser = _Parser(source, span, tuple(letters), frozenset(events))
    return Equation(parser.whole(), frozenset(parser.uses))


class _Parser:
    """Recursive descent, one method per level; an error ends it."""

    def __init__(self, source: Source, span: Span, letters: tuple[str, ...], events: frozenset[str]) -> None:
        self._source = source
        self._letters = letters
        self._events = events
        self._tokens = [
            _Token(match[1], Span(match.start(1), match.end(1)))
            for match in _TOKEN.finditer(source.text, span.start, span.end)
        ]
        self._end = Span(span.end, span.end)
        self._next = 0
        self._depth = 0
        self.uses: set[str] = set()

    def whole(self) -> Term:
        term = self._binary(0)
        if (token := self._peek()) is not None:
            hint = "there is no opening parenthesis for it" if token.text == ")" else "an operator is missing before it"
            raise self._error("LTL321", token.span, f"`{token.text}` cannot follow here", hint)
        return term

    def _binary(self, level: int) -> Term:
        if level == len(_BINARY):
            return self._unary()
        left = self._binary(level + 1)
        operator = _BINARY[level].get(self._symbol())
        if operator is None:
            return left
        self._next += 1
        right = self._nested(lambda: self._binary(level))
        return lambda meaning: operator(left(meaning), right(meaning))

    def _unary(self) -> Term:
        token = self._peek()
        if token is None:
            raise self._error("LTL321", self._end, "a formula is missing here", "")
        self._next += 1
        symbol = _SYMBOLS.get(token.text, token.text)
        if symbol in _UNARY:
            unary, operand = _UNARY[symbol], self._nested(self._unary)
            return lambda meaning: unary(operand(meaning))
        if symbol in _CONSTANTS:
            return lambda _: _CONSTANTS[symbol]
        if symbol == "(":
            inner = self._nested(lambda: self._binary(0))
            self._close(token)
            return inner
        if symbol in _FUNCTIONS:
            function, (argument,) = _FUNCTIONS[symbol], self._arguments(token, 1)
            return lambda meaning: function(argument(meaning))
        if symbol == "rel":
            return self._relativised(token)
        return self._letter(token)

    def _nested(self, read: Callable[[], Term]) -> Term:
        """What `read` reads inside the operator, function or parenthesis that has just begun."""
        if self._depth == MOST_NESTED:
            place = self._tokens[self._next - 1].span
            raise self._error("LTL321", place, "the formula is nested too deeply", f"at most {MOST_NESTED} levels")
        self._depth += 1
        term = read()
        self._depth -= 1
        return term

    def _letter(self, token: _Token) -> Term:
        name = token.text
        if name in self._letters:
            self.uses.add(name)
            return lambda meaning: meaning[name]
        if not name[0].isalpha():
            raise self._error("LTL321", token.span, f"`{name}` cannot stand where a formula begins", "")
        help = self._hint(name) or f"the letters here are {', '.join(self._letters)}"
        raise self._error("LTL322", token.span, f"`{name}` is not a letter of this equation", help)

    def _hint(self, name: str) -> str:
        """What may have been meant by an unknown name."""
        if name in ("X", "Y", "Z"):
            return f"`{name}` is missing from the left side; the next operator is written next(…)"
        if len(name) > 1 and name[0] in "FGX" and name[1:] in self._letters:
            return f"write `{'next(' + name[1:] + ')' if name[0] == 'X' else name[0] + ' ' + name[1:]}`"
        return did_you_mean(name, [*self._letters, "rel", "next", "weak_next"])

    def _relativised(self, token: _Token) -> Term:
        end, body = self._arguments(token, 2)
        if not self._is_event(end):
            events = " and ".join(sorted(self._events))
            message = (
                f"the first argument of `rel` must be an event: a formula over {events} without temporal operators"
            )
            raise self._error("LTL324", token.span, message, "rel(Y, Z) is Z judged on the segment before the next Y")
        return lambda meaning: relativise(end(meaning), body(meaning))

    def _is_event(self, term: Term) -> bool:
        """Whether `term` is about the current step, if its letters other than events are not."""
        meaning = {name: Atom(name) if name in self._events else Next(Atom(name)) for name in self._letters}
        return is_propositional(term(meaning))

    def _arguments(self, function: _Token, count: int) -> list[Term]:
        """The arguments of `function`, in parentheses."""
        opening = self._peek()
        if opening is None or opening.text != "(":
            raise self._error("LTL321", function.span, f"`{function.text}` needs arguments in parentheses", "")
        self._next += 1
        arguments = [self._nested(lambda: self._binary(0))]
        while self._symbol() == ",":
            self._next += 1
            arguments.append(self._nested(lambda: self._binary(0)))
        self._close(opening)
        if len(arguments) != count:
            wanted = "one argument" if count == 1 else f"{count} arguments"
            message = f"`{function.text}` takes {wanted}, not {len(arguments)}"
            raise self._error("LTL324", function.span, message, "rel(Y, Z)" if count == 2 else "next(Z)")
        return arguments

    def _close(self, opening: _Token) -> None:
        token = self._peek()
        if token is None:
            raise self._error("LTL321", opening.span, "this parenthesis is not closed", "")
        if token.text != ")":
            raise self._error(
                "LTL321", token.span, f"`{token.text}` cannot follow here", "an operator, or `)`, is missing"
            )
        self._next += 1

    def _peek(self) -> _Token | None:
        return self._tokens[self._next] if self._next < len(self._tokens) else None

    def _symbol(self) -> str:
        """The operator that comes next, in its one form, or the text as it is."""
        token = self._peek()
        return "" if token is None else _SYMBOLS.get(token.text, token.text)

    def _error(self, code: str, span: Span, message: str, help: str) -> EquationError:
        return EquationError(diagnostic(code, self._source, span, message, help=help))
