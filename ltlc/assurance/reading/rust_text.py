"""The text of emitted Rust as trees: a lexer, and a parser of the statements that monitors consist of."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ltlc.assurance.reading.trees import (
    NEVER,
    VERDICT,
    Ago,
    Apply,
    Assign,
    Attribute,
    Block,
    Choice,
    Constant,
    Do,
    Elements,
    If,
    NotUnderstoodError,
    Part,
    Push,
    Return,
    Statement,
    Tree,
    Variable,
    While,
)
from ltlc.program.types import SINGLE, Scalar, Type
from ltlc.semantics.verdicts import Verdict

_TOKEN = re.compile(
    r"\s+|//[^\n]*"
    r'|(?P<token>"(?:[^"\\]|\\u\{[0-9a-f]+\})*"|\d[\d_]*(?:\.\d+)?(?:e[+-]?\d+)?(?:[iuf]\d+)?|\w+(?:::\w+)*!?'
    r"|\.\.|&&|\|\||[<>=!+]=|->|=>|[-+*/%<>=!&|.,;:()\[\]{}#'$])"
)
_NUMBER = re.compile(r"(\d+(?:\.\d+)?(?:e[+-]?\d+)?)([iuf]\d+)?")
_LEVELS = (("||",), ("&&",), ("<", "<=", ">", ">=", "==", "!="), ("+", "-"), ("*", "/"))
_NAMES = {"&&": "and", "||": "or", "!": "not"}
_TYPES = {
    f"{sign}{bits}": Type(Scalar(f"{name}{bits}"))
    for sign, name in (("i", "int"), ("u", "uint"))
    for bits in (8, 16, 32, 64)
}
_WORDS: dict[str, Tree] = {
    "true": Constant(True),
    "false": Constant(False),
    "NEVER": NEVER,
    "f64::INFINITY": Constant(float("inf")),
    "f64::NAN": Constant(float("nan")),
    "f32::INFINITY": Constant(float("inf"), SINGLE),
    **{f"Verdict::{v.name.title().replace('_', '')}": Constant(v) for v in Verdict},
}
SINCE = Attribute("judgement.since")
"""When the verdict came, which no monitor reads."""


class Token(NamedTuple):
    """A token, and the line that it is in."""

    text: str
    line: int


def tokens(text: str) -> Iterator[Token]:
    """The tokens of a text, comments and blanks omitted. Raises NotUnderstoodError."""
    end, line = 0, 1
    while end < len(text):
        match = _TOKEN.match(text, end)
        if match is None:
            raise NotUnderstoodError(f"`{text[end : end + 20]}` in line {line} does not occur in emitted Rust")
        if match["token"]:
            yield Token(match["token"], line)
        line += match[0].count("\n")
        end = match.end()


class Parser:
    """Reads trees from tokens, one after the other; all raise NotUnderstoodError."""

    def __init__(self, found: Sequence[str]) -> None:
        self._tokens = [*found, ""]
        self._at = 0

    @property
    def next(self) -> str:
        """The token that comes next; empty at the end."""
        return self._tokens[self._at]

    def take(self, *right: str) -> str:
        """The next token, which has to be one of these, if any are given."""
        token = self.next
        if not token or (right and token not in right):
            raise NotUnderstoodError(f"`{token}` instead of `{' or '.join(right)}`")
        self._at += 1
        return token

    def has(self, token: str) -> bool:
        """Take the next token if it is this one."""
        found = self.next == token
        self._at += found
        return found

    def block(self) -> Block:
        """Statements in braces."""
        self.take("{")
        found: list[Statement] = []
        while not self.has("}"):
            found += self._statement()
        return tuple(found)

    def _statement(self) -> Iterator[Statement]:
        word = self.next
        match word:
            case "if":
                yield self._if()
            case "while":
                self.take()
                yield While(self.expression(), self.block())
            case "return":
                self.take()
                yield Return(VERDICT if self.next == ";" else self.expression())
                self.take(";")
            case "let":
                self.take()
                name = self.take()
                self.take("=")
                yield Assign(Variable(name), self.expression())
                self.take(";")
            case _:
                yield self._simple()
                self.take(";")

    def _if(self) -> If:
        self.take("if")
        guard, then = self.expression(), self.block()
        if not self.has("else"):
            return If(guard, then)
        return If(guard, then, (self._if(),) if self.next == "if" else self.block())

    def _simple(self) -> Statement:
        """An assignment, or a call."""
        target = self._postfix()
        match target:
            case Apply(function, (Attribute(""), value)) if function.endswith(".push"):
                return Push(function.removesuffix(".push"), value)
            case Apply(function, (Attribute(""), *arguments)):
                return Do(function.removeprefix("."), tuple(arguments))
            case Attribute() if self.has("+="):
                return Assign(target, Apply("+", (target, self.expression())))
            case Attribute():
                self.take("=")
                return Assign(target, self.expression())
            case _:
                raise NotUnderstoodError(f"`{self.next}` follows something that is not a statement")

    def expression(self, level: int = 0) -> Tree:
        """One whose operators bind at least as tightly as those of a level."""
        if level == len(_LEVELS):
            return self._unary()
        left = self.expression(level + 1)
        while self.next in _LEVELS[level]:
            operator = self.take()
            right = self.expression(level + 1)
            left = _operated(_NAMES.get(operator, operator), left, right)
            if level == 2:
                break
        return left

    def _unary(self) -> Tree:
        if self.next in ("-", "!"):
            operator = self.take()
            return Apply(_NAMES.get(operator, operator), (self._unary(),))
        return self._postfix()

    def _postfix(self) -> Tree:
        found = self._primary()
        while self.has("."):
            name = self.take()
            if self.next == "(":
                found = _method(found, name, self._arguments())
            elif isinstance(found, Attribute):
                member = Attribute(f"{found.name}.{name}".lstrip("."))
                found = _OWN.get(member, member)
            else:
                raise NotUnderstoodError(f"`.{name}` of something without fields")
        return found

    def _arguments(self) -> tuple[Tree, ...]:
        """What a function is given; the elements of an array stand for themselves."""
        self.take("(")
        if self.has("["):
            found = self._list("]")
            self.take(")")
            return found
        return self._list(")")

    def _list(self, end: str) -> tuple[Tree, ...]:
        found: list[Tree] = []
        while not self.has(end):
            found.append(self._closure() if self.next in ("|", "||") else self.expression())
            if self.next != end:
                self.take(",")
        return tuple(found)

    def _closure(self) -> Tree:
        """What is asked of elements: their names, in the order of arrays, then the guard."""
        self.take("|")
        names = []
        while not self.has("|"):
            token = self.take()
            if token.isidentifier():
                names.append(token)
            elif token not in ("&", "&&", "(", ")", ","):
                raise NotUnderstoodError(f"`{token}` in the name of elements")
        return Elements(tuple(names), (), self.expression(), is_any=True)

    def _primary(self) -> Tree:
        token = self.take()
        if token in _WORDS:
            return _WORDS[token]
        if token in ("self", "signals"):
            return Attribute("" if token == "self" else token)
        if token == "(":
            found = self.expression()
            self.take(")")
            return found
        if token == "if":
            return self._choice()
        if token[0] == '"':
            return Constant(re.sub(r"\\u\{(\w+)\}", lambda code: chr(int(code[1], 16)), token[1:-1]))
        if token[0].isdigit():
            return _number(token)
        if token == "&" and self.has("["):
            return self._array()
        if self.next == "(" and re.fullmatch(r"\w+(?:::\w+)?", token):
            return _called(token, self._arguments())
        if token.isidentifier() or token == "i64::MAX":
            return Variable(token)
        raise NotUnderstoodError(f"`{token}` is not a value")

    def _array(self) -> Tree:
        found: list[Tree] = []
        while not self.has("]"):
            found.append(self.expression())
            if self.next != "]":
                self.take(",")
        return Apply("tuple", tuple(found))

    def _choice(self) -> Tree:
        guard = self.expression()
        self.take("{")
        then = self.expression()
        self.take("}")
        self.take("else")
        self.take("{")
        otherwise = self.expression()
        self.take("}")
        return Choice(guard, then, otherwise)


_OWN = {Attribute("judgement.verdict"): VERDICT, Attribute("judgement.invalid"): Attribute("invalid")}


def _number(token: str) -> Constant:
    found = _NUMBER.fullmatch(token.replace("_", ""))
    if found is None:
        raise NotUnderstoodError(f"`{token}` is not a number")
    value, suffix = found.groups()
    if suffix == "f32":
        return Constant(float(value), SINGLE)
    if "." in value or "e" in value:
        return Constant(float(value))
    return Constant(int(value), _TYPES[suffix] if suffix else None)


def _operated(operator: str, left: Tree, right: Tree) -> Tree:
    """Chains of `and` and `or` are one tree; that a number is at most infinite says that it is not NaN."""
    match operator, left, right:
        case "and" | "or", Apply(same, operands), _ if same == operator:
            return Apply(operator, (*operands, right))
        case "<=", Apply("double", (number,)), Constant(float() as value) if value == float("inf"):
            return Apply("measured", (number,))
        case "<=", _, Constant(float() as value) if value == float("inf"):
            return Apply("measured", (left,))
        case _:
            return Apply(operator, (left, right))


def _method(of: Tree, name: str, arguments: tuple[Tree, ...]) -> Tree:
    """What is called of a value: of `self`, of a signal, of a number, or of the elements of arrays."""
    match name, of, arguments:
        case "is_nan", _, ():
            return Apply("not", (Apply("measured", (of,)),))
        case "min", Apply("min", times), (other,):
            return Apply("min", (*times, other))
        case "min", _, (other,):
            return Apply("min", (of, other))
        case "wrapping_add", _, (Constant(1),):
            return Apply("+", (of, Constant(1)))
        case "ago" | "recent", Attribute(place), (Constant(int(samples)),):
            is_own = name == "ago" and not place.startswith("signals.")
            return Ago(place, samples) if is_own else Apply(name, (of, *arguments))
        case "has", Attribute(place), (Constant(int(count)),) if not place.startswith("signals."):
            return Apply("==", (Apply("len", (of,)), Constant(count)))
        case "has", Attribute(), (Constant(1),):
            return Apply("has", (of,))
        case "iter", _, ():
            return Apply("iter", (of,))
        case "zip", Apply("iter", arrays), (Apply("iter", (other,)),):
            return Apply("iter", (*arrays, other))
        case "any", Apply("iter", arrays), (Elements(names, (), guard),):
            return Elements(names, arrays, guard, is_any=True)
        case "filter", Apply("iter", arrays), (Elements(names, (), guard),):
            return Apply("filter", (Elements(names, arrays, guard, is_any=False),))
        case "count", Apply("filter", (Elements() as counted,)), ():
            return Apply("counted", (counted,))
        case _, Attribute(path), _:
            return Apply(f"{path}.{name}", (Attribute(""), *arguments))
        case _:
            raise NotUnderstoodError(f"`.{name}` is called on the wrong object")


def _called(function: str, arguments: tuple[Tree, ...]) -> Tree:
    match function, arguments:
        case "double", (Apply("counted", (Elements() as counted,)),):
            return counted
        case "slice", (array, start, stop):
            first, last = _index(start), _index(stop)
            return Part(array, first or None, last)
        case _:
            return Apply(function, arguments)


def _index(tree: Tree) -> int | None:
    """An index; None for the end."""
    match tree:
        case Variable("i64::MAX"):
            return None
        case Constant(int(value)):
            return value
        case Apply("-", (Constant(int(value)),)):
            return -value
        case _:
            raise NotUnderstoodError("an index is not a constant")
