"""Rust compared token by token: whatever differs in more than blanks and comments is another program."""

from __future__ import annotations

from itertools import pairwise, zip_longest

from ltlc.assurance.afresh.outcomes import Equal, Unequal, instead
from ltlc.assurance.reading.rust_text import Token, tokens
from ltlc.assurance.reading.trees import NotUnderstoodError


def compare(found: str, emitted: str) -> Equal | Unequal:
    """Whether two texts are the same program."""
    right = list(tokens(emitted))
    try:
        left = list(tokens(found))
    except NotUnderstoodError as error:
        return Unequal(str(error))
    for token, other in zip_longest(left, right):
        if token is None or other is None or token.text != other.text:
            line = found.count("\n") + 1 if token is None else token.line
            return Unequal(instead(_line(found, token), _line(emitted, other)), line)
    functions = tuple(name.text for word, name in pairwise(right) if word.text == "fn")
    return Equal("token by token", tuple(dict.fromkeys(functions)), "comments")


def _line(text: str, token: Token | None) -> str | None:
    return None if token is None else text.split("\n")[token.line - 1].strip()
