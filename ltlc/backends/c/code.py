"""C as text: statements of emitted code, laid out; comments and string literals that hold anything."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from ltlc.backends.braces import Braces
from ltlc.backends.trees import INDENT, LINE_LENGTH, prose, wrapped

lines = Braces("(", ") {", "/* {} */").lines
"""Statements as text, all of which are indented."""


def mentions(name: str, texts: Sequence[str]) -> bool:
    """Whether code uses the name, not only as that of a member."""
    return any(re.search(rf"\b{re.escape(name)}\b", re.sub(r"/\*.*?\*/|->\w+|\.\w+", "", line)) for line in texts)


def unused(names: Iterable[str], texts: Sequence[str]) -> list[str]:
    """Statements that name those parameters which code does not use, of which compilers warn."""
    return [f"{INDENT}(void){name};" for name in names if not mentions(name, texts)]


def remark(text: str) -> str:
    """`text` fit for the inside of a comment: ASCII, and it neither ends the comment nor begins one, nor a trigraph."""
    return prose(text).replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?")


def comment(*paragraphs: str, indent: str = "") -> list[str]:
    """A comment of paragraphs that may hold anything."""
    width = LINE_LENGTH - len(indent) - 3
    text = wrapped(map(remark, paragraphs), width)
    if len(text) == 1 and len(indent) + len(text[0]) + 6 <= LINE_LENGTH:
        return [f"{indent}/* {text[0]} */"]
    inner = [f"{indent} * {line}".rstrip() for line in text]
    return [f"{indent}/*", *inner, f"{indent} */"]


def literal(text: str) -> str:
    """`text`, which has no NUL, as a string literal: its bytes in UTF-8."""
    return f'"{"".join(map(_escaped, text.encode()))}"'


def _escaped(byte: int) -> str:
    character = chr(byte)
    if character in '"\\?':
        return f"\\{character}"
    return character if 32 <= byte < 127 else f"\\{byte:03o}"
