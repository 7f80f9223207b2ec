"""C as tokens, as the language takes a text apart: the longest that fits, lines counting in directives only."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ltlc.dataclass import dataclass

_LEXEME = re.compile(
    r"""
    (?P<blank>[ \t\v\f]+)
  | (?P<comment>/\*.*?(?:\*/|\Z)|//[^\n]*)
  | (?P<line>\n)
  | (?P<token>
        (?:u8|[uUL])?"(?:\\.|[^"\\\n])*"
      | (?:u8|[uUL])?'(?:\\.|[^'\\\n])*'
      | \.?[0-9](?:[eEpP][-+]|[\w.])*
      | [A-Za-z_]\w*
      | <<=|>>=|\.\.\.|->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||\#\#|::|[-+*/%&|^]=
      | .
    )
    """,
    re.X | re.S | re.A,
)
_SPLICE = re.compile(r"\\[ \t\v\f\r]*(?:\n|\Z)|\?\?")


@dataclass(frozen=True, slots=True)
class Token:
    """A token and its line; a `directive` is for the preprocessor, the end of the line included."""

    text: str
    line: int
    directive: bool = False


def tokens(text: str) -> Iterator[Token]:
    """The tokens of `text`, comments omitted, as they are asked for.

    What another compiler could take apart in another way is a token that no file has: lines that go on, trigraphs, a
    carriage return alone, a comment without an end.
    """
    line, at_start, directive = 1, True, False
    for found in _LEXEME.finditer(text):
        token = found[0]
        match found.lastgroup:
            case "line":
                if directive:
                    yield Token(token, line, directive=True)
                line, at_start, directive = line + 1, True, False
            case "comment":
                if _SPLICE.search(token) or (token.startswith("/*") and (len(token) < 4 or not token.endswith("*/"))):
                    yield Token(token, line)
                line += token.count("\n")
            case "token":
                directive = directive or (at_start and token == "#")
                at_start = False
                yield Token(token, line, directive)
                line += token.count("\n")
            case _:
                pass
