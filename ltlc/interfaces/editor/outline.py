"""What a text consists of: its definitions, settings and properties, for a list beside it."""

from __future__ import annotations

from collections.abc import Iterator
from enum import Enum
from typing import NamedTuple

from ltlc.base.source import Span
from ltlc.frontend.syntax import tree as syntax
from ltlc.interfaces.editor.document import Document

LONGEST = 80
"""How much of a text is shown beside a name."""


class EntryKind(Enum):
    """What an entry is."""

    DECLARATION = "declaration"
    MODEL = "model"
    ATTRIBUTE = "attribute"
    OBJECT = "object"
    ASSOCIATION = "association"
    GUARD = "guard"
    MESSAGE = "message"
    SETTING = "setting"
    PROPERTY = "property"


class Entry(NamedTuple):
    """A command: its name, its meaning, the span of its text, and that of its name."""

    kind: EntryKind
    name: str
    detail: str
    span: Span
    name_span: Span
    children: tuple[Entry, ...] = ()


def outline(document: Document) -> Iterator[Entry]:
    """An entry for each command that can be parsed."""
    for command in document.tree.commands:
        match command:
            case syntax.Declaration():
                yield _source(EntryKind.DECLARATION, command)
            case syntax.Model(span, name, attributes):
                children = tuple(_source(EntryKind.ATTRIBUTE, attribute) for attribute in attributes)
                yield Entry(EntryKind.MODEL, name.text, "", span, name.span, children)
            case syntax.ObjectFromTopic():
                yield _source(EntryKind.OBJECT, command)
            case syntax.ObjectAtPlace(span, name) | syntax.Zone(span, name):
                yield Entry(EntryKind.OBJECT, name.text, "", span, name.span)
            case syntax.Association(span, name, value):
                yield Entry(EntryKind.ASSOCIATION, name.text, _text(document, value.span), span, name.span)
            case syntax.Guard(span, raw, out):
                yield Entry(EntryKind.GUARD, out.text, raw.text, span, out.span)
            case syntax.Message(span, name):
                yield Entry(EntryKind.MESSAGE, name.text, "", span, name.span)
            case syntax.Setting(span, name, value):
                yield Entry(EntryKind.SETTING, name.text, _text(document, value.span), span, name.span)
            case syntax.PropertyCommand(span, label, property_):
                line = f"line {document.source.position(span.start).line}"
                name = label or syntax.Word(property_.span, line)
                yield Entry(EntryKind.PROPERTY, name.text, _text(document, property_.span), span, name.span)


def _source(kind: EntryKind, command: syntax.Declaration | syntax.ObjectFromTopic) -> Entry:
    detail = f"{command.topic.text} {command.type.text}"
    return Entry(kind, command.name.text, detail, command.span, command.name.span)


def _text(document: Document, span: Span) -> str:
    text = document.source.excerpt(span)
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…"
