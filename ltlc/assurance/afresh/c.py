"""C compared token by token and, where parentheses differ, as trees: whether these are redundant is what a parser says.

Files that belong together are compared as one text, with a line between them that says nothing to the preprocessor.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import zip_longest

from pycparser.c_ast import FuncDef, Node
from pycparser.c_parser import CParser, ParseError

from ltlc.assurance.afresh.outcomes import Equal, Unequal, instead
from ltlc.assurance.reading.c.lexing import Token, tokens
from ltlc.assurance.reading.c.text import STANDARD

MOST_PARENTHESES = 1_000
"""How many more a file may have than what is emitted."""

BETWEEN = "\n#\n"
"""What stands between the texts of two files."""

_MACROS = frozenset({"INT64_C", "UINT64_C"})
"""What makes a literal of one: the macro, a parenthesis, the literal, a parenthesis."""

_PARENTHESES = frozenset("()")
_IDENTIFIER = re.compile(r"[A-Za-z_]\w*", re.A)
_OTHER = "has other parentheses than what ltlc emits"


def compare(found: str, emitted: str, is_c: bool = True) -> Equal | Unequal:
    """Whether two texts are the same program; unless it `is_c`, parentheses have to be the same, too."""
    left, right = _Reader(found), _Reader(emitted)
    if different := _without_parentheses(left, right):
        return different
    places = zip_longest(left.kept, right.kept)
    place = next((token for token, other in places if token is None or other is None or token.text != other.text), None)
    functions = tuple(right.functions)
    if place is None and len(left.kept) == len(right.kept):
        return Equal("token by token", functions, "comments")
    if not is_c:
        return Unequal(f"`{_line(left, place)}` {_OTHER}", place.line if place else None)
    return _as_trees(left, right) or Equal("as a tree", functions, "comments")


@dataclass
class _Reader:
    """A text, token by token, parentheses put aside, with its functions and the one that the last token is in."""

    text: str
    kept: list[Token] = field(default_factory=list)
    functions: list[str] = field(default_factory=list)
    parentheses: int = 0
    _depth: int = 0
    _name: str = ""

    def __iter__(self) -> Iterator[Token]:
        """The tokens that are no parentheses."""
        for token in tokens(self.text):
            if not token.directive:
                self._note(token.text)
            self.kept.append(token)
            if token.text in _PARENTHESES:
                self.parentheses += 1
            else:
                yield token

    @property
    def function(self) -> str:
        """The one that the last token is in, if any."""
        return self._name if self._depth else ""

    def _note(self, text: str) -> None:
        match text:
            case "(" if not self._depth and not self._name and self.kept:
                self._name = self.kept[-1].text if _IDENTIFIER.fullmatch(self.kept[-1].text) else ""
            case "{":
                if not self._depth and self._name:
                    self.functions.append(self._name)
                self._depth += 1
            case "}":
                self._depth -= 1
                self._name = self._name if self._depth else ""
            case ";" if not self._depth:
                self._name = ""


def _line(reader: _Reader, token: Token | None) -> str | None:
    return None if token is None else reader.text.split("\n")[token.line - 1].strip()


def _without_parentheses(left: _Reader, right: _Reader) -> Unequal | None:
    """The first token that differs, at which reading ends; None if none but parentheses do."""
    for token, other in zip_longest(left, right):
        if left.parentheses > right.parentheses + MOST_PARENTHESES:
            reason = f"it has over {MOST_PARENTHESES:,} parentheses more than what ltlc emits"
            return Unequal(reason, left.kept[-1].line, left.function)
        if token is None or other is None or token.text != other.text:
            number = left.text.count("\n") + 1 if token is None else token.line
            return Unequal(instead(_line(left, token), _line(right, other)), number, left.function)
    return None


def _as_trees(left: _Reader, right: _Reader) -> Unequal | None:
    """The first place where parentheses make another tree, or are read by the preprocessor."""
    for token, other in zip_longest(_preprocessed(left), _preprocessed(right)):
        if token is None or other is None or token.text != other.text:
            return Unequal(f"`{_line(left, token)}` {_OTHER}", token.line if token else None)
    tree = _tree(left)
    if isinstance(tree, Unequal):
        return tree
    emitted = _tree(right)
    assert not isinstance(emitted, Unequal), emitted
    place = _difference(tree, emitted)
    if place is None:
        return None
    number, function = place
    line = left.text.split("\n")[number - 1].strip()
    return Unequal(f"`{line}` {_OTHER}, and is something else by them", number, function)


def _directives(reader: _Reader) -> list[Token]:
    """What is said to the preprocessor, and what stands where it may not be read."""
    found, inside = [], False
    for number, token in enumerate(reader.kept):
        begins = token.directive and token.text == "#" and number + 1 < len(reader.kept)
        word = reader.kept[number + 1].text if begins else ""
        inside = inside or word in ("ifdef", "if")
        if inside or token.directive:
            found.append(token)
        inside = inside and word != "endif"
    return found


def _preprocessed(reader: _Reader) -> Iterator[Token]:
    """What only the preprocessor reads: directives, and what its macros are given."""
    yield from _directives(reader)
    for number, token in enumerate(reader.kept):
        if token.text in _MACROS:
            yield from reader.kept[number : number + 4]


def _tree(reader: _Reader) -> Node | Unequal:
    """The tree of all but the directives, with the lines that the text has."""
    left_out = set(map(id, _directives(reader)))
    lines: list[list[str]] = [[] for _ in reader.text.split("\n")]
    for token in reader.kept:
        if id(token) not in left_out:
            lines[token.line - 1].append(token.text)
    types = "".join(f"typedef int {name};" for name in STANDARD)
    try:
        return CParser().parse(types + "\n".join(map(" ".join, lines)))
    except ParseError as error:
        return Unequal(f"it {_OTHER}, and is not C: {error}")
    except RecursionError:
        return Unequal("its parentheses are nested too deeply")


def _difference(found: Node, emitted: Node) -> tuple[int, str] | None:
    """The line and the function of the first node that differs."""
    todo: Sequence[tuple[Node, Node, int, str]]
    todo = [(found, emitted, 1, "")]
    while todo:
        left, right, line, function = todo.pop()
        line = left.coord.line if left.coord else line
        if isinstance(left, FuncDef):
            function = left.decl.name
        parts, others = left.children(), right.children()
        is_same = type(left) is type(right) and [name for name, _ in parts] == [name for name, _ in others]
        if not is_same or any(getattr(left, name) != getattr(right, name) for name in left.attr_names):
            return line, function
        pairs = zip(parts, others, strict=True)
        todo += reversed([(one, other, line, function) for (_, one), (_, other) in pairs])
    return None
