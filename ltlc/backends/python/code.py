"""Python expressions as trees, and their layout: lines broken where ruff's formatter breaks them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

LINE_LENGTH = 88
INDENT = "    "


@dataclass(frozen=True, slots=True)
class Text:
    """A name or a literal."""

    text: str


@dataclass(frozen=True, slots=True)
class Prefix:
    """`operator` before its operand: `-` or `not `."""

    operator: str
    operand: Code


@dataclass(frozen=True, slots=True)
class Infix:
    """`operator` between its operands, two or more; `a - b - c` is one tree."""

    operator: str
    operands: tuple[Code, ...]


@dataclass(frozen=True, slots=True)
class Chain:
    """A comparison, as `left < right` or `low <= value <= high`: operands and the operators between them."""

    operands: tuple[Code, ...]
    operators: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Call:
    """A function of arguments."""

    function: str
    arguments: tuple[Code, ...]


Code = Text | Prefix | Infix | Chain | Call

_STRENGTHS = {"or": 0, "and": 1, "not ": 2, "+": 4, "-": 4, "*": 5, "/": 5}
_COMPARISON, _NEGATIVE, _PRIMARY = 3, 6, 7


def strength(code: Code) -> int:
    """How tightly the outermost operator binds."""
    match code:
        case Prefix("not ", _):
            return _STRENGTHS["not "]
        case Prefix():
            return _NEGATIVE
        case Infix(operator, _):
            return _STRENGTHS[operator]
        case Chain():
            return _COMPARISON
        case Text(text) if text.startswith("-"):
            return _NEGATIVE
        case _:
            return _PRIMARY


def flat(code: Code) -> str:
    """`code` in one line."""
    match code:
        case Text(text):
            return text
        case Prefix(operator, operand):
            return operator + _operand(operand, strength(code))
        case Infix():
            return "".join(_pieces(code))
        case Chain(operands, operators):
            parts = [_operand(operand, _COMPARISON + 1) for operand in operands]
            pairs = zip(operators, parts[1:], strict=True)
            return parts[0] + "".join(f" {operator} {part}" for operator, part in pairs)
        case Call(function, arguments):
            return f"{function}({', '.join(map(flat, arguments))})"


def _operand(code: Code, context: int) -> str:
    return f"({flat(code)})" if strength(code) < context else flat(code)


def _pieces(code: Infix) -> list[str]:
    """The first operand, then each further one behind the operator."""
    own = strength(code)
    first, *rest = code.operands
    further = [_operand(operand, own + 1) for operand in rest]
    return [_operand(first, own), *(f" {code.operator} {piece}" for piece in further)]


def layout(prefix: str, code: Code, suffix: str = "") -> list[str]:
    """The lines of a statement that consists of `prefix`, `code` and `suffix`; `prefix` starts with its indentation."""
    line = f"{prefix}{flat(code)}{suffix}"
    if len(line) <= LINE_LENGTH:
        return [line]
    indent = prefix[: len(prefix) - len(prefix.lstrip())]
    match code:
        case Call(function, arguments):
            return bracketed(f"{prefix}{function}(", [flat(a) for a in arguments], f"){suffix}")
        case Infix():
            inner = [f"{indent}{INDENT}{piece.strip()}" for piece in _pieces(code)]
            return [f"{prefix}(", *inner, f"{indent}){suffix}"]
        case _ if len(indent) + len(INDENT) + len(flat(code)) <= LINE_LENGTH:
            return [f"{prefix}(", f"{indent}{INDENT}{flat(code)}", f"{indent}){suffix}"]
        case _:
            return [line]


def bracketed(opening: str, items: Sequence[str], closing: str) -> list[str]:
    """`opening` and `closing` bracket around `items`: in one line, the items in one line, or a line for each."""
    line = f"{opening}{', '.join(items)}{closing}"
    if len(line) <= LINE_LENGTH or not items:
        return [line]
    indent = opening[: len(opening) - len(opening.lstrip())]
    together = f"{indent}{INDENT}{', '.join(items)}"
    if len(together) <= LINE_LENGTH:
        return [opening, together, f"{indent}{closing}"]
    return exploded(opening, items, closing)


def exploded(opening: str, items: Iterable[str], closing: str) -> list[str]:
    """`opening` and `closing` bracket with a line for each of `items`, which may have several lines themselves."""
    indent = opening[: len(opening) - len(opening.lstrip())]
    lines = [f"{indent}{INDENT}{line}" for item in items for line in f"{item},".split("\n")]
    return [opening, *lines, f"{indent}{closing}"]


@dataclass(frozen=True, slots=True)
class Group:
    """Data in code: items between brackets, in one line if they fit there and `wide` is not set."""

    opening: str
    items: tuple[Group | str, ...]
    closing: str
    wide: bool = False
    is_tuple: bool = False

    def lines(self, indent: str = "", suffix: str = "") -> list[str]:
        """The text, with `suffix` behind it."""
        line = f"{indent}{self}{suffix}"
        if not self._is_wide() and len(line) <= LINE_LENGTH:
            return [line]
        inner = indent + INDENT
        return [
            f"{indent}{self.opening}",
            *(line for item in self.items for line in _item_lines(item, inner)),
            f"{indent}{self.closing}{suffix}",
        ]

    def _is_wide(self) -> bool:
        return self.wide or any(isinstance(item, Group) and item._is_wide() for item in self.items)

    def __str__(self) -> str:
        comma = "," if self.is_tuple and len(self.items) == 1 else ""
        return f"{self.opening}{', '.join(map(str, self.items))}{comma}{self.closing}"


def _item_lines(item: Group | str, indent: str) -> list[str]:
    return [f"{indent}{item},"] if isinstance(item, str) else item.lines(indent, ",")


def tuple_of(items: Iterable[Group | str], opening: str = "(", wide: bool = False) -> Group:
    """A tuple; `opening` may name what it is given to."""
    parts = tuple(items)
    return Group(opening, parts, ")", wide and len(parts) > 1, is_tuple=True)


def literal(text: str) -> str:
    """`text` as a string literal in ASCII, in the quotes that a formatter would choose."""
    quote = "'" if text.count('"') > text.count("'") else '"'
    return quote + "".join(_escaped(character, quote) for character in text) + quote


def _escaped(character: str, quote: str) -> str:
    if character == quote:
        return f"\\{character}"
    return character if character in "'\"" else ascii(character)[1:-1]


def prose(text: str) -> str:
    """`text` fit for a comment or a docstring, where it must neither end it nor look like something else.

    ASCII only, nothing that a terminal or an editor acts on; a backslash or a triple quote cannot be mistaken.
    """
    escaped = "".join(c if c.isascii() and c.isprintable() else ascii(c)[1:-1] for c in text)
    return escaped.replace("\\", "\\\\").replace('"""', '\\"\\"\\"')
