"""Python as text: expressions and statements laid out, lines broken where ruff's formatter breaks them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ltlc.backends.notation import Notation, clauses
from ltlc.backends.statements import Do, If, Statement
from ltlc.backends.trees import INDENT, LINE_LENGTH, Call, Chain, Code, Each, Infix, Prefix
from ltlc.dataclass import dataclass

_PYTHON = Notation({}, negation=2, contexts={}, chains=True)

flat, strength = _PYTHON.flat, _PYTHON.strength
"""An expression in one line, and how tightly its outermost operator binds."""


def layout(prefix: str, code: Code, suffix: str = "") -> list[str]:
    """The lines of a statement that consists of `prefix`, `code` and `suffix`; `prefix` starts with its indentation."""
    line = f"{prefix}{flat(code)}{suffix}"
    if len(line) <= LINE_LENGTH:
        return [line]
    indent = prefix[: len(prefix) - len(prefix.lstrip())]
    if isinstance(code, Call):
        return _call_lines(f"{prefix}{code.function}(", code.arguments, f"){suffix}")
    inner = _spread(code, indent + INDENT)
    if len(inner) == 1 and len(inner[0]) > LINE_LENGTH:
        return [line]
    return [f"{prefix}(", *inner, f"{indent}){suffix}"]


def _spread(code: Code, indent: str, before: str = "", after: str = "") -> list[str]:
    """Lines of `code` inside brackets, between `before` and `after`: broken before operators where that is needed."""
    line = f"{indent}{before}{flat(code)}{after}"
    if len(line) <= LINE_LENGTH:
        return [line]
    match code:
        case Call(function, arguments):
            return _call_lines(f"{indent}{before}{function}(", arguments, f"){after}")
        case Each():
            return [line for start, part in clauses(code) for line in _spread(part, indent, start)]
        case Prefix(operator, operand) if strength(operand) >= strength(code):
            return _spread(operand, indent, before + operator, after)
        case Infix(operator, operands):
            return _spread_operands(operands, [operator] * (len(operands) - 1), strength(code), indent, before, after)
        case Chain(operands, operators):
            return _spread_operands(operands, operators, strength(code), indent, before, after)
        case _:
            return [line]


def _spread_operands(
    operands: Sequence[Code], operators: Sequence[str], context: int, indent: str, before: str, after: str
) -> list[str]:
    """A line or more for each operand; the first may bind as tightly as the operator, the others more."""
    lines = []
    starts = [before, *(f"{operator} " for operator in operators)]
    for number, (start, operand) in enumerate(zip(starts, operands, strict=True)):
        end = after if number == len(operators) else ""
        if strength(operand) < context + (number > 0):
            lines.append(f"{indent}{start}({flat(operand)}){end}")
        else:
            lines += _spread(operand, indent, start, end)
    return lines


def _call_lines(opening: str, arguments: Sequence[Code], closing: str) -> list[str]:
    """A call whose arguments do not fit behind it."""
    indent = opening[: len(opening) - len(opening.lstrip())]
    together = f"{indent}{INDENT}{', '.join(map(flat, arguments))}"
    if len(together) <= LINE_LENGTH:
        return [opening, together, f"{indent}{closing}"]
    after = "," if len(arguments) > 1 else ""
    inner = [line for argument in arguments for line in _spread(argument, indent + INDENT, after=after)]
    return [opening, *inner, f"{indent}{closing}"]


def lines(statements: Iterable[Statement], indent: str) -> list[str]:
    """The statements as text."""
    return [line for statement in statements for line in _lines(statement, indent)]


def _lines(statement: Statement, indent: str) -> list[str]:
    match statement:
        case If():
            return _if(statement, indent, "if")
        case Do(prefix, code):
            return layout(indent + prefix, code)
        case str():
            return [indent + statement]


def _if(statement: If, indent: str, word: str) -> list[str]:
    suffix = f":  # {statement.remark}" if statement.remark else ":"
    text = layout(f"{indent}{word} ", statement.guard, suffix) + lines(statement.then, indent + INDENT)
    match statement.otherwise:
        case ():
            return text
        case (If() as further,):
            return text + _if(further, indent, "elif")
        case _:
            return [*text, f"{indent}else:", *lines(statement.otherwise, indent + INDENT)]


def bracketed(opening: str, items: Sequence[str], closing: str) -> list[str]:
    """`opening` and `closing` bracket around `items`: in one line, the items in one line, or a line for each.

    A formatter gives the only parameter of a definition a line that ends with a comma.
    """
    line = f"{opening}{', '.join(items)}{closing}"
    if len(line) <= LINE_LENGTH or not items:
        return [line]
    indent = opening[: len(opening) - len(opening.lstrip())]
    together = f"{indent}{INDENT}{', '.join(items)}"
    is_only_parameter = len(items) == 1 and opening.startswith("def ")
    if len(together) <= LINE_LENGTH and not is_only_parameter:
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
