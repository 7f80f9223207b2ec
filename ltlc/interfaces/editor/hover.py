"""The hover text for the place under the mouse."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ltlc.analysis import guard_words
from ltlc.analysis.english import English
from ltlc.base.codes import CODES, page
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.render.table import example_lines
from ltlc.base.source import Span
from ltlc.frontend.language.primitives import RELATIONS
from ltlc.frontend.language.suppression import suppressions
from ltlc.frontend.syntax import tree as syntax
from ltlc.interfaces.editor.document import Document
from ltlc.interfaces.editor.keywords import KEYS, meaning
from ltlc.interfaces.editor.signals import described, thing_described
from ltlc.interfaces.editor.tokens import token_at
from ltlc.interfaces.editor.words import Word, WordKind
from ltlc.specification.specification import PropertySpecification


class Hover(NamedTuple):
    """A text in Markdown about the characters of a span."""

    span: Span
    text: str


def hover(document: Document, offset: int, diagnostics: Sequence[Diagnostic]) -> Hover | None:
    """The text about the character at `offset`, with `diagnostics` there; None if there is none."""
    word = document.word_at(offset)
    span, parts = (word.span, [*_of_word(document, word)]) if word else _of_text(document, offset)
    for found in diagnostics:
        if found.primary and found.primary.span.start <= offset <= found.primary.span.end:
            parts.append(_finding(found))
            span = span or found.primary.span
    return Hover(span, "\n\n---\n\n".join(parts)) if span and parts else None


def _of_word(document: Document, word: Word) -> Iterator[str]:
    match word.kind:
        case WordKind.FUNCTION | WordKind.SETTING:
            said = meaning(word.text)
            yield from [said] if said else []
        case WordKind.KEY:
            known = KEYS.get(word.text)
            yield from [f"`{known.form}`: {known.says}."] if known else []
        case WordKind.LABEL:
            yield from _english([p for p in document.properties if p.span.start == word.span.start])
        case WordKind.VARIABLE:
            names = dict.fromkeys(p.names.get(word.text, "") for p in document.properties if _holds(p.span, word.span))
            yield f"`{word.text}` stands for {', '.join(f'`{name}`' for name in names if name) or 'a name of the set'}"
            yield from _named(document, word)
        case WordKind.TOPIC | WordKind.TYPE:
            guards = document.reading.sound.guards
            yield from (guard_words.sentences(document.reading.sound, g) for g in guards if _holds(g.span, word.span))
            commands = (c for c in document.tree.commands if isinstance(c, syntax.Declaration))
            declared = [c.name for c in commands if _holds(c.span, word.span)]
            yield from (text for name in declared if (text := described(document, syntax.Reference(name.span, name))))
        case _:
            yield from _message(document, word)
            yield from _named(document, word)


def _message(document: Document, word: Word) -> Iterator[str]:
    """The message that a guard may send, if that is what a name stands for."""
    for command in document.tree.commands if word.kind is WordKind.NAME else ():
        if isinstance(command, syntax.Message) and command.name.text == word.text:
            yield f"`{document.source.excerpt(command.span)}`: fields that are not named are zero, false or empty"


def _named(document: Document, word: Word) -> Iterator[str]:
    """What a name, or a step after one, stands for; under a `forall`, for each name of the set."""
    nodes = [_up_to(node, word.span) for node in document.references_at(word.span.start)]
    if not nodes:
        nodes = [_reference(word)]
    for node in dict.fromkeys(nodes):
        name = next(
            (w.text for w in (node.name, *node.steps) if w.span == word.span and isinstance(w, syntax.Word)), ""
        )
        if word.kind is not WordKind.MEMBER and document.is_thing(name):
            yield thing_described(document, name)
        elif text := _association(document, node) + (described(document, node) or ""):
            yield text


def _reference(word: Word) -> syntax.Reference:
    """A use of a name that is defined here."""
    here = syntax.Word(word.span, word.text)
    if isinstance(word.symbol.scope, str):
        model = syntax.Word(Span(word.span.start, word.span.start), word.symbol.scope)
        return syntax.Reference(word.span, model, (here,))
    return syntax.Reference(word.span, here)


def _association(document: Document, node: syntax.Reference) -> str:
    """What the association stands for that `node` is the name of, if it is."""
    found = document.reading.checker.names.associations.get(node.name.text)
    if found is None or node.steps:
        return ""
    return f"`{node.name.text}` is `{document.source.excerpt(found.node.span)}`\n\n"


def _up_to(node: syntax.Reference, span: Span) -> syntax.Reference:
    """`node` without the steps behind `span`; a primitive of two objects keeps the second one."""
    count = sum(step.span.start <= span.start for step in node.steps)
    needs_other = count == 1 and isinstance(node.steps[0], syntax.Word) and node.steps[0].text in RELATIONS
    return syntax.Reference(node.span, node.name, node.steps[: count + needs_other])


def _holds(outer: Span, inner: Span) -> bool:
    return outer.start <= inner.start and inner.end <= outer.end


def _of_text(document: Document, offset: int) -> tuple[Span | None, list[str]]:
    """The text about a place other than a name: a keyword, or a code in a comment."""
    for each in suppressions(document.source):
        if each.span.start <= offset <= each.span.end and each.code in CODES:
            return each.span, [page(each.code)]
    token = token_at(document, offset)
    said = meaning(document.text[token.span.start : token.span.end]) if token else None
    if token is None or said is None:
        return _of_numbers(document, offset)
    around = document.property_at(offset)
    return token.span, [said, *_english([around] if around else [])]


def _of_numbers(document: Document, offset: int) -> tuple[Span | None, list[str]]:
    """The text about the numbers of a window of samples, or of an interval."""
    for node in (node for command in document.tree.commands for node, _ in syntax.walk(command)):
        if not node.span.start <= offset <= node.span.end:
            continue
        form = document.source.excerpt(node.span)
        match node:
            case syntax.Interval(_, start, end):
                since, until = (document.source.excerpt(each.span) for each in (start, end))
                return node.span, [f"`{form}`: from {since} to {until} after the first instant, both included"]
            case syntax.Recent(_, signal, before) if before.span.start <= offset <= before.span.end:
                of, count = document.source.excerpt(signal.span), document.source.excerpt(before.span).lstrip("- ")
                if count.isdigit():
                    says = (
                        f"the last {count} samples of `{of}` and the present one, oldest first: {int(count) + 1} values"
                    )
                    return node.span, [f"`{form}`: {says}"]
            case _:
                pass
    return None, []


def _english(properties: Sequence[PropertySpecification]) -> Iterator[str]:
    """Properties in plain English; of those of one `forall`, the first one."""
    for property_ in properties[:1]:
        yield f"**{property_.label}**: {English(property_).sentence()}"


def _finding(found: Diagnostic) -> str:
    """The run that shows a finding, and the page of its code."""
    example = "\n".join(example_lines(found.example)) if found.example else ""
    return (f"```\n{example}\n```\n\n" if example else "") + page(found.code)
