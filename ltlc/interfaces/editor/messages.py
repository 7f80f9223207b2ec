"""Messages to editors, as data of their protocol: places become lines and units, kinds become its kinds."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property

from lsprotocol import types  # noqa: TID251

from ltlc.base.diagnostics import Diagnostic, Fix, Severity
from ltlc.base.render.table import example_lines
from ltlc.base.source import Span
from ltlc.dataclass import dataclass
from ltlc.interfaces.editor.completion import Completions
from ltlc.interfaces.editor.document import Document
from ltlc.interfaces.editor.keywords import meaning
from ltlc.interfaces.editor.outline import Entry, EntryKind
from ltlc.interfaces.editor.positions import Lines
from ltlc.interfaces.editor.tokens import KINDS, ColouredToken

LEGEND = types.SemanticTokensLegend(token_types=list(KINDS), token_modifiers=["declaration"])
"""What the numbers of semantic tokens stand for."""

UNUSED = "LTL104"

_SEVERITIES = {
    Severity.ERROR: types.DiagnosticSeverity.Error,
    Severity.WARNING: types.DiagnosticSeverity.Warning,
    Severity.NOTE: types.DiagnosticSeverity.Information,
}

_SYMBOLS = {
    EntryKind.DECLARATION: types.SymbolKind.Variable,
    EntryKind.MODEL: types.SymbolKind.Class,
    EntryKind.ATTRIBUTE: types.SymbolKind.Field,
    EntryKind.OBJECT: types.SymbolKind.Object,
    EntryKind.ASSOCIATION: types.SymbolKind.Constant,
    EntryKind.GUARD: types.SymbolKind.Interface,
    EntryKind.MESSAGE: types.SymbolKind.Constant,
    EntryKind.SETTING: types.SymbolKind.Property,
    EntryKind.PROPERTY: types.SymbolKind.Event,
}

_ITEMS = {
    "keyword": types.CompletionItemKind.Keyword,
    "declaration": types.CompletionItemKind.Variable,
    "association": types.CompletionItemKind.Constant,
    "model": types.CompletionItemKind.Class,
    "object": types.CompletionItemKind.Class,
    "zone": types.CompletionItemKind.Class,
    "message": types.CompletionItemKind.Constant,
    "variable": types.CompletionItemKind.Variable,
    "function": types.CompletionItemKind.Function,
    "setting": types.CompletionItemKind.Property,
    "attribute": types.CompletionItemKind.Property,
    "field": types.CompletionItemKind.Field,
    "constant": types.CompletionItemKind.EnumMember,
    "type": types.CompletionItemKind.Struct,
    "topic": types.CompletionItemKind.Reference,
    "code": types.CompletionItemKind.Value,
}


@dataclass(frozen=True)
class View:
    """A document as an editor sees it, in the units of whose `encoding` its lines are counted."""

    uri: str
    document: Document
    encoding: str

    @cached_property
    def lines(self) -> Lines:
        """The lines of its text."""
        return Lines(self.document.text, self.encoding)

    def position(self, offset: int) -> types.Position:
        """Where `offset` is."""
        return types.Position(*self.lines.position(offset))

    def range(self, span: Span) -> types.Range:
        """Where `span` is."""
        return types.Range(self.position(span.start), self.position(span.end))

    def offset(self, position: types.Position) -> int:
        """The offset at `position`."""
        return self.lines.offset(position.line, position.character)

    def span(self, range_: types.Range) -> Span:
        """The characters of `range_`."""
        return Span(self.offset(range_.start), self.offset(range_.end))

    def location(self, span: Span) -> types.Location:
        """Where `span` is, with the file."""
        return types.Location(self.uri, self.range(span))

    def change(self, edits: Iterable[tuple[Span, str]]) -> types.WorkspaceEdit:
        """What to write in the places of the text."""
        return types.WorkspaceEdit({self.uri: [types.TextEdit(self.range(span), text) for span, text in edits]})


def diagnostic(view: View, found: Diagnostic) -> types.Diagnostic:
    """A finding, with its help."""
    label = found.primary.text if found.primary else ""
    helped = f"help: {found.help}" if found.help else ""
    return types.Diagnostic(
        range=view.range(found.primary.span if found.primary else Span(0, 0)),
        message="\n".join(filter(None, [found.message, label, helped])),
        severity=_SEVERITIES[found.severity],
        code=found.code,
        source="ltlc",
        related_information=[
            types.DiagnosticRelatedInformation(
                view.location(other.span), other.text or found.source.excerpt(other.span)
            )
            for other in found.secondary
        ],
        tags=[types.DiagnosticTag.Unnecessary] if found.code == UNUSED else None,
        data={"name": found.name, "help": found.help, "example": example_lines(found.example) if found.example else []},
    )


def action(view: View, found: Diagnostic, fix: Fix) -> types.CodeAction:
    """A way to deal with a finding."""
    return types.CodeAction(
        title=fix.title,
        kind=types.CodeActionKind.QuickFix,
        diagnostics=[diagnostic(view, found)],
        is_preferred=fix.is_certain or None,
        edit=view.change(fix.edits),
    )


def symbol(view: View, entry: Entry) -> types.DocumentSymbol:
    """An entry of the outline."""
    return types.DocumentSymbol(
        name=entry.name,
        detail=entry.detail,
        kind=_SYMBOLS[entry.kind],
        range=view.range(entry.span),
        selection_range=view.range(entry.name_span),
        children=[symbol(view, child) for child in entry.children],
    )


def flat_symbols(view: View, entries: Iterable[Entry]) -> Iterator[types.SymbolInformation]:
    """Entries of the outline for an editor that knows no others: without those inside of them."""
    for entry in entries:
        yield types.SymbolInformation(view.location(entry.span), entry.name, _SYMBOLS[entry.kind])


def completion_list(view: View, found: Completions) -> types.CompletionList:
    """What may be written."""
    range_ = view.range(found.span)
    items = [
        types.CompletionItem(
            label=suggestion.text,
            kind=_ITEMS[suggestion.kind],
            detail=suggestion.detail or None,
            documentation=markdown(said) if (said := meaning(suggestion.text)) else None,
            text_edit=types.TextEdit(range_, suggestion.text),
        )
        for suggestion in found.suggestions
    ]
    return types.CompletionList(is_incomplete=False, items=items)


def markdown(text: str) -> types.MarkupContent:
    """`text` in Markdown."""
    return types.MarkupContent(types.MarkupKind.Markdown, text)


def semantic_tokens(view: View, tokens: Iterable[ColouredToken]) -> types.SemanticTokens:
    """Five numbers for each token: lines and units after the last one's beginning, length, kind, whether it defines."""
    data: list[int] = []
    last = (0, 0)
    for token in tokens:
        line, character = view.lines.position(token.span.start)
        since = character - last[1] if line == last[0] else character
        length = view.lines.length(token.span.start, token.span.end)
        data += [line - last[0], since, length, KINDS.index(token.kind), int(token.defines)]
        last = (line, character)
    return types.SemanticTokens(data)


def command(title: str, name: str, arguments: Sequence[str]) -> types.Command:
    """Something that the server does when it is asked to."""
    return types.Command(title, name, arguments=list(arguments))
