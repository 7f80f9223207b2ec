"""What each piece of a text is, for its colour: names by what they stand for, everything else as the lexer reads it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

from ltlc.base.source import Span
from ltlc.frontend.syntax.lexer import CONTEXTUAL, END, KEYWORDS, next_token
from ltlc.interfaces.editor.document import Document
from ltlc.interfaces.editor.words import Word, WordKind
from ltlc.specification.specification import DefinitionKind

_COMMENT = re.compile(r"#[^\n]*")

_NAMES = {
    DefinitionKind.DECLARATION: "variable",
    DefinitionKind.ASSOCIATION: "macro",
    DefinitionKind.MODEL: "class",
    DefinitionKind.OBJECT: "class",
    DefinitionKind.ZONE: "class",
    DefinitionKind.MESSAGE: "macro",
}

_WORDS = {
    WordKind.VARIABLE: "parameter",
    WordKind.LABEL: "event",
    WordKind.ATTRIBUTE: "property",
    WordKind.MEMBER: "property",
    WordKind.TEMPLATE: "macro",
    WordKind.SETTING: "property",
    WordKind.TOPIC: "namespace",
    WordKind.TYPE: "type",
    WordKind.CONSTANT: "enumMember",
    WordKind.FUNCTION: "function",
    WordKind.KEY: "decorator",
}

_TERMINALS = {
    "NUMBER": "number",
    "DURATION": "number",
    "PARAMETER": "number",
    "STRING": "string",
    "FUNCTION": "function",
    "QUANTIFIER": "function",
    "SETTING": "property",
    "NAME": "variable",
    **dict.fromkeys(KEYWORDS | CONTEXTUAL, "keyword"),
    **dict.fromkeys(("==", "!=", "<", "<=", ">", ">=", "=", "+", "-", "*", "/"), "operator"),
}

KINDS = tuple(dict.fromkeys(["comment", *_NAMES.values(), *_WORDS.values(), *_TERMINALS.values()]))
"""The kinds of tokens, by the names that editors have for them."""


class ColouredToken(NamedTuple):
    """A piece of the text within one line, its kind, one of `KINDS`, and whether it defines a name."""

    span: Span
    kind: str
    defines: bool = False


def tokens(document: Document) -> Iterator[ColouredToken]:
    """The pieces of the text that have a kind, in its order; they do not overlap."""
    text, offset = document.text, 0
    known = {word.span.start: word for word in reversed(document.words) if word.kind is not WordKind.TEMPLATE}
    while offset < len(text):
        token = next_token(text, offset, CONTEXTUAL)
        yield from _comments(text, offset, token.span.start)
        word = known.get(token.span.start)
        if token.terminal == END:
            return
        if word is not None:
            yield ColouredToken(word.span, _kind(document, word), word.defines)
        elif token.terminal in _TERMINALS:
            yield ColouredToken(token.span, _TERMINALS[token.terminal])
        offset = word.span.end if word is not None else token.span.end


def token_at(document: Document, offset: int) -> ColouredToken | None:
    """The piece that the character at `offset`, or the one before it, belongs to."""
    touching = [token for token in tokens(document) if token.span.start <= offset <= token.span.end]
    return touching[-1] if touching else None


def _comments(text: str, start: int, end: int) -> Iterator[ColouredToken]:
    """The comments in the white space from `start` to `end`."""
    for match in _COMMENT.finditer(text, start, end):
        yield ColouredToken(Span(match.start(), match.start() + len(match.group().rstrip("\r"))), "comment")


def _kind(document: Document, word: Word) -> str:
    if word.kind is not WordKind.NAME:
        return _WORDS[word.kind]
    definitions = document.reading.checker.names.definitions
    kind = next((kind for kind, name in definitions if name.text == word.text), DefinitionKind.OBJECT)
    return _NAMES[kind]
