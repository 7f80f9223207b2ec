"""The words, numbers and signs of formulas."""

from __future__ import annotations

import re

from ltlc.dataclass import dataclass
from ltlc.importing.values import FormulaError

_TOKEN = re.compile(
    r"""\s*(?:(?P<number>(?:\d+(?:\.\d+)?|(?<![.\w])\.\d+)(?:[eE][-+]?\d+)?)|(?P<string>"[^"\n]*"|'[^'\n]*')
    |(?P<word>@?[A-Za-z_$][\w$]*(?:\.[A-Za-z_]\w*)*)
    |(?P<sign><->|<=>|->|=>|!==|===|\*\*|==|!=|<=|>=|&&|\|\||[-+*/%^<>=!~&|()\[\]{}:,.;?¬∧∨→↔≠≤≥])|(?P<strange>\S))""",
    re.VERBOSE,
)


@dataclass(frozen=True)
class Token:
    """A number, a string, a word or a sign, or the end, with its place in characters from 0."""

    kind: str
    text: str
    offset: int


def tokens_of(text: str) -> list[Token]:
    """The tokens of a formula. Raises FormulaError."""
    found = [Token(m.lastgroup or "", m[m.lastgroup or 0], m.start(m.lastgroup or 0)) for m in _TOKEN.finditer(text)]
    for token in found:
        if token.kind == "strange":
            raise FormulaError(f"`{token.text}` is not expected here", token.offset)
    return [*found, Token("end", "", len(text.rstrip()))]
