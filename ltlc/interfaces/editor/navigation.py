"""Where a name is defined and used, and what to write to give it another one."""

from __future__ import annotations

from collections.abc import Sequence

from ltlc.base.source import Source, Span
from ltlc.frontend.language.signals import SOURCES, Tracked
from ltlc.frontend.syntax import tree as syntax
from ltlc.interfaces.editor.document import Document, document
from ltlc.interfaces.editor.words import Symbol, Word, WordKind

_RENAMED = (WordKind.NAME, WordKind.VARIABLE, WordKind.LABEL, WordKind.ATTRIBUTE)


class RefusedError(Exception):
    """A name cannot be changed, and why."""


def definitions(document: Document, offset: int) -> list[Span]:
    """Where the name at `offset` is defined; several places for one that a `forall` composes."""
    word = document.word_at(offset)
    if word is None:
        return []
    symbols = [word.symbol, *_composed(document, word)]
    return [other.span for symbol in symbols for other in document.occurrences(symbol) if other.defines]


def references(document: Document, offset: int, *, with_definitions: bool = True) -> list[Span]:
    """Where the name at `offset` is used, names that a `forall` composes included."""
    word = document.word_at(offset)
    if word is None:
        return []
    found = [o.span for o in document.occurrences(word.symbol) if with_definitions or not o.defines]
    templates = (other for other in document.words if other.kind is WordKind.TEMPLATE)
    composed = [other.span for other in templates if word.symbol in _composed(document, other)]
    return sorted([*found, *composed])


def _composed(document: Document, word: Word) -> list[Symbol]:
    """The names that a word with a variable in it stands for."""
    if word.kind is not WordKind.TEMPLATE:
        return []
    nodes = document.references_at(word.span.start)
    parts = (part for node in nodes for part in (node.name, *node.steps) if part.span == word.span)
    names = dict.fromkeys(part.text for part in parts if isinstance(part, syntax.Word))
    return [Symbol(WordKind.NAME, name) for name in names]


def renamed(document: Document, offset: int) -> Word:
    """The name at `offset`, which can be changed. Raises RefusedError."""
    word = document.word_at(offset)
    if word is None or word.kind not in _RENAMED:
        raise RefusedError("this file defines no name at this place")
    if document.tree.lost is not None:
        raise RefusedError("the file has syntax errors, which could hide other uses of the name")
    if template := next((t for t in document.words if word.symbol in _composed(document, t)), None):
        raise RefusedError(f"`{template.text}` generates this name: change that first")
    if not any(other.defines for other in document.occurrences(word.symbol)) or _is_of_simulation(document, word):
        help = f"`object {word.text} TOPIC TYPE` would declare where its ground truth is"
        raise RefusedError(f"`{word.text}` is its name in the simulation: {help}")
    return word


def _is_of_simulation(document: Document, word: Word) -> bool:
    """Whether the name of an object is looked for in topics or messages, so that another would be another object."""
    names = document.reading.checker.names
    if word.kind is not WordKind.NAME:
        return False
    thing = names.objects.get(word.text)
    if isinstance(thing, Tracked):
        return SOURCES[thing.message]("one") != SOURCES[thing.message]("another")
    return word.text in names.undeclared


def rename(document: Document, offset: int, name: str) -> list[tuple[Span, str]]:
    """What to write, and where, so that the name at `offset` becomes `name`, and nothing else changes.

    Raises RefusedError.
    """
    word = renamed(document, offset)
    if name == word.text:
        return []
    if any(other.text == name and other.kind in _space(word.kind) for other in document.words):
        raise RefusedError(f"`{name}` has another meaning in this file")
    edits = [(other.span, name) for other in document.occurrences(word.symbol)]
    _check(document, edits)
    return edits


def _space(kind: WordKind) -> tuple[WordKind, ...]:
    """The kinds of words that must not be called the same as one of this kind."""
    return (WordKind.NAME, WordKind.VARIABLE) if kind in (WordKind.NAME, WordKind.VARIABLE) else (kind,)


def _check(before: Document, edits: Sequence[tuple[Span, str]]) -> None:
    """Raise RefusedError with the first finding that these edits would bring."""
    source = before.source
    text = source.replaced(Span(0, len(source.text)), dict(edits))
    after = document(Source(source.name, text), types=before.reading.checker.types)
    known = [found.code for found in before.diagnostics]
    for found in after.diagnostics:
        if found.code not in known:
            raise RefusedError(f"with this name, {found.message}")
        known.remove(found.code)
