"""C as trees of pycparser, without empty parts: how they are made of text, and where two of them differ.

What is said to the preprocessor is put aside, line by line, with all that stands where it may not be read.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from typing import NamedTuple

from pycparser.c_ast import ID, FuncDef, Node, Typedef
from pycparser.c_generator import CGenerator
from pycparser.c_parser import CParser, ParseError

from ltlc.assurance.reading.c.lexing import Token, tokens
from ltlc.assurance.reading.trees import NotUnderstoodError
from ltlc.dataclass import dataclass

STANDARD = ("bool", "size_t", *(f"{sign}int{bits}_t" for sign in ("", "u") for bits in (8, 16, 32, 64)))
"""Types of the C library that are used."""

_MACROS = frozenset({"INT64_C", "UINT64_C"})
"""What makes a literal of one: the macro, a parenthesis, the literal, a parenthesis."""


_UNREAD = frozenset({'"', "'", "_Pragma"})
"""A string without an end, and what may be anything."""


class Directive(NamedTuple):
    """What is said to the preprocessor in one line or, of what may not be read, in several; `line` is the first."""

    words: tuple[str, ...]
    line: int


@dataclass(frozen=True)
class Text:
    """A header or a source file: its directives, and its declarations and definitions."""

    directives: Sequence[Directive]
    nodes: Sequence[Node]

    @property
    def types(self) -> tuple[str, ...]:
        """The names of the types that it defines."""
        return tuple(node.name for node in self.nodes if isinstance(node, Typedef))

    def items(self) -> list[Directive | Node]:
        """All of it, in order."""
        return sorted([*self.directives, *self.nodes], key=line_of)


def line_of(item: Directive | Node) -> int:
    """The line where it begins."""
    return item.line if isinstance(item, Directive) else item.coord.line if item.coord else 1


@lru_cache(maxsize=32)  # of a file that is compared and read back, both want the tree
def parsed(text: str, types: Sequence[str] = ()) -> Text:
    """The trees of `text`, in which `types` are known. Raises NotUnderstoodError."""
    found = list(_plain(tokens(text)))
    directives = list(_directives(found))
    aside = {id(token) for each in directives for token in each}
    lines: list[list[str]] = [[] for _ in range(text.count("\n") + 1)]
    for token in found:
        if id(token) not in aside:
            lines[token.line - 1].append(token.text)
    named = {token.text for token in found}
    known = [name for name in (*STANDARD, *types) if name in named]
    before = "".join(f"typedef int {name};" for name in known)
    try:
        tree = CParser().parse(before + "\n".join(map(" ".join, lines)))
    except ParseError as error:
        raise NotUnderstoodError(f"it is not C: {error}") from None
    except RecursionError:
        raise NotUnderstoodError("it is nested too deeply") from None
    return Text(list(map(_directive, directives)), tree.ext[len(known) :])


def _directive(group: Sequence[Token]) -> Directive:
    words = [token.text for token in group]
    return Directive(tuple(words[:-1] if words[-1] == "\n" else words), group[0].line)


def _directives(found: Sequence[Token]) -> Iterator[list[Token]]:
    """The directives: each line, or all lines from an `#if` to its `#endif`."""
    group: list[Token] = []
    line: list[str] = []
    for token in found:
        if not token.directive and not group:
            continue
        group.append(token)
        line = [*line, token.text] if token.directive else []
        if token.text == "\n":
            if group[1].text not in ("if", "ifdef") or line[:2] == ["#", "endif"]:
                yield group
                group = []
            line = []
    if group:
        yield group


def _plain(found: Iterable[Token]) -> Iterator[Token]:
    """Tokens, up to one of which a compiler may make something else than a parser; then raises NotUnderstoodError."""
    awaited: list[str] = []
    for token in found:
        wanted = awaited.pop() if awaited else ""
        if token.text in _UNREAD or "??" in token.text or (wanted and token.text != wanted):
            raise NotUnderstoodError(f"`{token.text}` is not supported here")
        if token.text in _MACROS:
            awaited = [")", "", "("]
        elif token.text == "-" and awaited == [")"]:
            awaited.append("")
        yield token


class Place(NamedTuple):
    """Where two trees differ: the innermost nodes, None where one has no such part; the line, and the function."""

    found: Node | None
    right: Node | None
    line: int
    function: str


def difference(found: Node | None, right: Node | None, left_open: dict[str, Node] | None = None) -> Place | None:
    """The first place where two trees differ.

    What `right` calls `_name` is put into `left_open`, whatever it is. Nothing here goes deeper than the stack, however
    the trees are nested.
    """
    todo: list[Place] = [Place(found, right, 1, "")]
    while todo:
        place = todo.pop()
        one, other, line, function = place
        if one is None or other is None:
            return place
        line = one.coord.line if one.coord else line
        if left_open is not None and isinstance(other, ID) and other.name.startswith("_"):
            left_open[other.name] = one
            continue
        if type(one) is not type(other) or any(getattr(one, name) != getattr(other, name) for name in one.attr_names):
            return place._replace(line=line)
        function = one.decl.name if isinstance(one, FuncDef) else function
        parts, others = dict(one.children()), dict(other.children())
        names = list(dict.fromkeys([*parts, *others]))
        todo += [Place(parts.get(name), others.get(name), line, function) for name in reversed(names)]
    return None


def shown(node: Node | None) -> str | None:
    """`node` in one line."""
    try:
        return None if node is None else " ".join(CGenerator().visit(node).split())
    except RecursionError:
        return "what is nested too deeply"
