"""A file of emitted Rust as the functions of its types; those that monitors call have to be the known ones."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

from ltlc.assurance.reading.rust_text import Parser, tokens
from ltlc.assurance.reading.trees import Block, NotUnderstoodError
from ltlc.backends.rust.functions import FUNCTIONS

_STRANGE = frozenset({"cfg", "cfg_attr", "extern", "include", "include!", "macro", "mod", "unsafe", "use"})
_BRACKETS = {"{": "}", "[": "]"}


class Function(NamedTuple):
    """A function in a file: the names of its parameters, and the tokens of its body, braces included."""

    parameters: tuple[str, ...]
    body: Sequence[str]

    def block(self) -> Block:
        """Its statements."""
        return Parser(self.body).block()


class RustFile:
    """The functions of a file by the type that they are of. Raises NotUnderstoodError."""

    def __init__(self, text: str) -> None:
        self._tokens = [token.text for token in tokens(text)]
        self.types: dict[str, dict[str, Function]] = {}
        if strange := _STRANGE.intersection(self._tokens):
            raise NotUnderstoodError(f"`{min(strange)}` does not occur in emitted Rust")
        at = 0
        while at < len(self._tokens):
            match self._tokens[at]:
                case "impl":
                    at = self._impl(at)
                case "fn":
                    at = self._known(at)
                case "{":
                    at = self._closed(at)
                case _:
                    at += 1

    def _known(self, at: int) -> int:
        """A function that monitors call, which has to be the known one."""
        name, end = self._tokens[at + 1], self._closed(self._tokens.index("{", at))
        right = [token.text for token in tokens(FUNCTIONS.get(name, ""))]
        if self._tokens[at:end] != right[len(right) - (end - at) :]:
            raise NotUnderstoodError(f"`{name}` is the wrong function")
        return end

    def _closed(self, at: int) -> int:
        """Where the brackets end that begin at a token."""
        begins, ends = self._tokens[at], _BRACKETS[self._tokens[at]]
        depth = 0
        for end in range(at, len(self._tokens)):
            depth += (self._tokens[end] == begins) - (self._tokens[end] == ends)
            if depth == 0:
                return end + 1
        raise NotUnderstoodError(f"a `{begins}` is not closed")

    def _impl(self, at: int) -> int:
        begin = self._tokens.index("{", at)
        head = [token for token in self._tokens[at + 1 : begin] if token not in ("<", ">", "'", "a")]
        end = self._closed(begin)
        if len(head) == 1:
            if head[0] in self.types:
                raise NotUnderstoodError(f"`{head[0]}` is defined twice")
            functions = list(self._functions(begin + 1, end - 1))
            self.types[head[0]] = dict(functions)
            if len(self.types[head[0]]) < len(functions):
                raise NotUnderstoodError(f"`{head[0]}` has two functions of one name")
        return end

    def _functions(self, at: int, end: int) -> Iterator[tuple[str, Function]]:
        while at < end:
            if self._tokens[at] in ("pub", "const"):
                at += 1
                continue
            if self._tokens[at] != "fn":
                at = self._constant(at)
                continue
            begin = self._tokens.index("{", at)
            close = self._closed(begin)
            given = self._tokens[at + 2 : begin]
            named = tuple(name for name, colon in pairwise(given) if colon == ":")
            yield self._tokens[at + 1], Function(named, self._tokens[begin:close])
            at = close

    def _constant(self, at: int) -> int:
        """A constant of a type, which ends with a semicolon; nothing else stands between functions."""
        if self._tokens[at - 1] != "const":
            raise NotUnderstoodError(f"`{self._tokens[at]}` stands between functions")
        while self._tokens[at] != ";":
            at = self._closed(at) if self._tokens[at] in _BRACKETS else at + 1
        return at + 1

    def function(self, type_: str, name: str) -> Function:
        """A function of a type."""
        if name not in self.types.get(type_, {}):
            raise NotUnderstoodError(f"`{type_}` has no `{name}`")
        return self.types[type_][name]
