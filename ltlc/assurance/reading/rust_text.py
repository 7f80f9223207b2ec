"""The text of emitted Rust as trees: a lexer, and a parser of the statements that functions consist of."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ltlc.assurance.reading.plain import Tree, joined
from ltlc.assurance.reading.trees import NotUnderstoodError
from ltlc.semantics.verdicts import Verdict

_TOKEN = re.compile(
    r"\s+|//[^\n]*"
    r'|(?P<token>"(?:[^"\\]|\\u\{[0-9a-f]+\})*"|0x[0-9a-f_]+|\d[\d_]*(?:\.\d+)?(?:e[+-]?\d+)?(?:[iuf]\d+)?|\w+(?:::\w+)*!?'
    r"|\.\.|\^=|&&|\|\||[-<>=!+]=|->|=>|[-+*/%<>=!&|.,;:()\[\]{}#'$])"
)
_LEVELS = (("||",), ("&&",), ("<", "<=", ">", ">=", "==", "!="), (">>",), ("+", "-"), ("*", "/", "%"))
_CASTS = {"f64": "double", "i64": "int64_t", "u32": "uint32_t", "u64": "uint64_t"}
_WORDS = {"f64::INFINITY": "INFINITY", "f64::NAN": "NAN", "i64::MAX": "INT64_MAX", "i64::MIN": "INT64_MIN"}
_WORDS |= {"i32::MIN": "INT32_MIN", "u32::MAX": "UINT32_MAX", "None": "NULL", "Self::NEW": "Self::NEW"} | {
    f"Verdict::{v.name.title().replace('_', '')}": v.name for v in Verdict
}


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
    """Reads trees from tokens, from the one with number `at` on; all raise NotUnderstoodError.

    Trees are plain ones, as `c.plain` makes them of C.
    """

    def __init__(self, found: Sequence[str], at: int = 0) -> None:
        self._tokens = [*found, ""]
        self.at = at

    @property
    def _next(self) -> str:
        """The token that comes next; empty at the end."""
        return self._tokens[self.at]

    def _take(self, *right: str) -> str:
        """The next token, which has to be one of these, if any are given."""
        token = self._next
        if not token or (right and token not in right):
            raise NotUnderstoodError(f"`{token}` instead of `{' or '.join(right)}`")
        self.at += 1
        return token

    def _has(self, token: str) -> bool:
        """Take the next token if it is this one."""
        found = self._next == token
        self.at += found
        return found

    def block(self) -> tuple[Tree, ...]:
        """Statements in braces."""
        self._take("{")
        found: list[Tree] = []
        while not self._has("}"):
            found.append(self._statement())
        return tuple(found)

    def _statement(self) -> Tree:
        match self._next:
            case "if":
                return self._if()
            case "while":
                self._take()
                return "while", self._expression(), self.block()
            case "return":
                self._take()
                found: Tree = ("return", "" if self._ends() else self._expression())
            case "let":
                self._take()
                self._has("mut")
                name = self._take()
                self._take("=")
                found = "let", name, self._expression()
            case _:
                found = self._simple()
                if self._next == "}" and found[0] == "do":
                    return "return", found[1]
        self._take(";")
        return found

    def _ends(self) -> bool:
        return self._next == ";"

    def _if(self) -> Tree:
        self._take("if")
        guard, then = self._given() if self._next == "let" else self._expression(), self.block()
        if not self._has("else"):
            return "if", guard, then, ()
        return "if", guard, then, (self._if(),) if self._next == "if" else self.block()

    def _given(self) -> Tree:
        """Whether there are samples, which a block is about."""
        for right in ("let", "Some", "(", "samples", ")", "=", "samples"):
            self._take(right)
        return "!=", "samples", "NULL"

    def _simple(self) -> Tree:
        """An assignment, or an expression by itself; what a counter wraps around is added to it."""
        place = self._expression()
        if self._next in ("+=", "-=", "^="):
            return self._take(), place, self._expression()
        if not self._has("="):
            return "do", place
        match self._expression():
            case ("call", ".wrapping_add", same, more) if same == place:
                return "+=", place, more
            case ("call", ".wrapping_mul", same, factor) if same == place:
                return "*=", place, factor
            case value:
                return "=", place, value

    def _expression(self, level: int = 0) -> Tree:
        """One whose operators bind at least as tightly as those of a level."""
        if level == len(_LEVELS):
            return self._cast()
        left = self._expression(level + 1)
        while operator := self._operator(level):
            left = joined(operator, left, self._expression(level + 1))
        return left

    def _operator(self, level: int) -> str:
        """The operator of a level that comes next, if one does; `>>` is two tokens, as it is in types."""
        if _LEVELS[level] != (">>",):
            return self._take() if self._next in _LEVELS[level] else ""
        is_next = self._tokens[self.at : self.at + 2] == [">", ">"]
        self.at += 2 * is_next
        return ">>" if is_next else ""

    def _cast(self) -> Tree:
        """What is made another type, which binds less tightly than `-`; an index is what it is."""
        found = self._unary()
        while self._has("as"):
            type_ = self._take("usize", *_CASTS)
            found = found if type_ == "usize" else ("cast", _CASTS[type_], found)
        return found

    def _unary(self) -> Tree:
        if self._next in ("-", "!"):
            return self._take(), self._unary()
        if self._has("&"):
            self._has("mut")
            if self._has("{"):  # a copy
                found = self._expression()
                self._take("}")
                return found
            return ("{}", *self._list("]")) if self._has("[") else self._unary()
        return self._postfix()

    def _postfix(self) -> Tree:
        found = self._primary()
        while self._next in (".", "["):
            if self._take() == "[":
                found = "[]", found, self._expression()
                self._take("]")
                continue
            name = self._take()
            found = _method(found, name, self._list(")")) if self._has("(") else (".", found, name)
        return found

    def _list(self, end: str) -> tuple[Tree, ...]:
        found: list[Tree] = []
        while not self._has(end):
            found.append(self._expression())
            if self._next != end:
                self._take(",")
        return tuple(found)

    def _primary(self) -> Tree:
        token = self._take()
        if token in _WORDS:
            return _WORDS[token]
        if token == "(":
            found = self._expression()
            self._take(")")
            return found
        if token == "Some":
            return self._primary()
        if token == "Monitors::new":
            return "call", token, *(self._take("(") and self._list(")"))
        if token == "if":
            guard = self._expression()
            return "?", guard, self._side(), self._take("else") and self._side()
        if token[0] == '"':
            return "text", re.sub(r"\\u\{(\w+)\}", lambda code: chr(int(code[1], 16)), token[1:-1])
        if token.isidentifier():
            return ("call", token, *self._list(")")) if self._has("(") else token
        if token[0].isdigit():
            return token if token.startswith("0x") else token.replace("f32", "f")
        raise NotUnderstoodError(f"`{token}` is not a value")

    def _side(self) -> Tree:
        self._take("{")
        found = self._expression()
        self._take("}")
        return found


def _method(of: Tree, name: str, arguments: tuple[Tree, ...]) -> Tree:
    """What is called of a value: of samples, of a number, of an array, or of what a property remembers."""
    match name, of, arguments:
        case "is_some" | "unwrap_or_default", (".", "samples", field), ():
            return name, field
        case "is_nan", _, ():
            return "nan", of
        case "len" | "as_ptr", _, ():
            return ".", of, {"len": "length", "as_ptr": "elements"}[name]
        case _:
            return "call", f".{name}", of, *arguments
