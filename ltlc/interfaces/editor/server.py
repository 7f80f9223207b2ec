"""`ltlc lsp`: speaks the Language Server Protocol over stdin and stdout.

The front end answers at once. Analyses begin after a pause, in child processes, and end with the next key.
"""

from __future__ import annotations

import asyncio
import gc
import logging
import os
import signal
import tempfile
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from lsprotocol import types  # noqa: TID251
from pygls.exceptions import JsonRpcException, JsonRpcInvalidParams  # noqa: TID251
from pygls.lsp.server import LanguageServer  # noqa: TID251
from pygls.protocol import LanguageServerProtocol  # noqa: TID251
from pygls.uris import from_fs_path, to_fs_path  # noqa: TID251

from ltlc import __version__
from ltlc.automata import Budget, SpotMissing
from ltlc.base import codes
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.files import write_text
from ltlc.base.limits import Exceeded
from ltlc.base.source import Source, Span
from ltlc.dataclass import dataclass
from ltlc.frontend.language import in_order, types_for
from ltlc.frontend.language.suppression import unsuppressed
from ltlc.frontend.layout import layout
from ltlc.interfaces.editor import messages
from ltlc.interfaces.editor.automaton import automaton_page
from ltlc.interfaces.editor.background import analysed, in_child
from ltlc.interfaces.editor.completion import completions
from ltlc.interfaces.editor.document import Document, document
from ltlc.interfaces.editor.fixes import fixes
from ltlc.interfaces.editor.hover import hover
from ltlc.interfaces.editor.lens import lenses
from ltlc.interfaces.editor.messages import View
from ltlc.interfaces.editor.navigation import RefusedError, definitions, references, rename, renamed
from ltlc.interfaces.editor.outline import outline
from ltlc.interfaces.editor.tokens import tokens
from ltlc.semantics.encodings import Encoding

BURST, PAUSE = 0.01, 0.4
"""Seconds without a key before the front end looks at the text, and before analyses begin after that."""

SHOW_AUTOMATON, SHOW_PAGE = "ltlc.showAutomaton", "ltlc.showPage"

Result = TypeVar("Result")


@dataclass
class Opened:
    """A text in an editor, its latest findings, and the task that looks for more."""

    text: str
    version: int
    view: View | None = None
    findings: Sequence[Diagnostic] = ()
    summaries: Mapping[str, str] = field(default_factory=dict)
    task: asyncio.Task[None] | None = None


@dataclass(frozen=True, slots=True)
class _BadRequest:
    """A request whose parameters are not as they should be."""

    id: int | str


class _Protocol(LanguageServerProtocol):
    """The protocol, in which every request has an answer: pygls gives none where it cannot read the parameters."""

    def structure_message(self, data: dict[str, Any]) -> Any:
        """What `data`, a part of a message or all of it, is."""
        try:
            return super().structure_message(data)
        except JsonRpcException:
            if isinstance(data.get("id"), int | str) and "method" in data:
                return _BadRequest(data["id"])
            raise

    def handle_message(self, message: Any) -> None:
        """Answer a request, or take note of something."""
        if isinstance(message, _BadRequest):
            self._send_response(message.id, error=JsonRpcInvalidParams().to_response_error())
        else:
            super().handle_message(message)


class Server(LanguageServer):
    """The server, with the texts that are open in the editor, and a folder for the pages that it makes."""

    def __init__(self, message_paths: Sequence[str], encoding: Encoding, budget: Budget, folder: str) -> None:
        kind = types.TextDocumentSyncKind.Full
        super().__init__("ltlc", __version__, text_document_sync_kind=kind, protocol_cls=_Protocol)
        self.types, self.bad_paths = types_for(Source("", ""), message_paths)
        self.encoding = encoding
        self.budget = budget
        self.folder = Path(folder)
        self.opened: dict[str, Opened] = {}
        self.was_shut_down = False
        self.is_without_spot = False

    def at(self, uri: str) -> Opened:
        """The text at `uri` as it stands in the editor; an empty one if it is not open."""
        return self.opened.get(uri) or Opened("", 0)

    def view(self, uri: str) -> View:
        """The text at `uri`, read as far as it can be."""
        opened = self.at(uri)
        if opened.view is None:
            source = Source(to_fs_path(uri) or uri, opened.text)
            units = types.PositionEncodingKind(self.workspace.position_encoding or "utf-16").value
            opened.view = View(uri, document(source, self.types, self.encoding), units)
        return opened.view

    def changed(self, uri: str, text: str, version: int, delay: float) -> None:
        """Take a new text, and publish its findings after `delay` seconds."""
        last = self.closed(uri)
        self.opened[uri] = Opened(text, version, summaries=last.summaries if last else {})
        self.opened[uri].task = asyncio.create_task(self._follow(uri, self.opened[uri], delay))

    def closed(self, uri: str) -> Opened | None:
        """Forget the text at `uri`, and end what goes on about it."""
        last = self.opened.pop(uri, None)
        if last is not None and last.task is not None:
            last.task.cancel()
        return last

    async def _follow(self, uri: str, opened: Opened, delay: float) -> None:
        """Publish the front end's findings, then those of the analyses; cancelled when the text changes."""
        await asyncio.sleep(delay)
        read = self.view(uri).document
        self._publish(uri, opened, self._at_once(read))
        if not read.is_sound or self.bad_paths or self.is_without_spot:
            return
        await asyncio.sleep(PAUSE)
        job = partial(analysed, read.reading.sound, read.diagnostics, self.encoding, self.budget)
        found = await self.in_child(job)
        if found is not None:
            opened.summaries = found.summaries
            self._publish(uri, opened, found.diagnostics)
            self._refresh_lenses()

    def _at_once(self, read: Document) -> list[Diagnostic]:
        """What is known without analyses."""
        return in_order([*unsuppressed(read.diagnostics), *self.bad_paths])

    def _publish(self, uri: str, opened: Opened, findings: Sequence[Diagnostic]) -> None:
        opened.findings = findings
        view = self.view(uri)
        listed = [messages.diagnostic(view, found) for found in findings]
        self.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri, listed, opened.version))

    def _refresh_lenses(self) -> None:
        workspace = self.client_capabilities.workspace
        if workspace and workspace.code_lens and workspace.code_lens.refresh_support:
            self.workspace_code_lens_refresh(None)

    async def in_child(self, job: Callable[[], Result]) -> Result | None:
        """What `job` returns in a child process, ended if this is cancelled; None, after a message, if it fails."""
        stop = threading.Event()
        try:
            found = await asyncio.to_thread(in_child, job, stop)
        except SpotMissing as error:
            self.is_without_spot = True
            self.say(str(error))
            return None
        finally:
            stop.set()
        if isinstance(found, Exceeded):
            self.say(f"there is no answer: {found.reason}")
            return None
        return found

    def say(self, message: str) -> None:
        """Show a warning to the person."""
        self.window_show_message(types.ShowMessageParams(types.MessageType.Warning, f"ltlc: {message}"))

    async def show(self, path: Path, *, in_browser: bool) -> str:
        """Show a file, in an editor that can; its path."""
        window = self.client_capabilities.window
        if window and window.show_document and window.show_document.support:
            uri = from_fs_path(str(path)) or ""
            await self.window_show_document_async(types.ShowDocumentParams(uri, in_browser, take_focus=True))
        return str(path)


def _did_open(ls: Server, params: types.DidOpenTextDocumentParams) -> None:
    opened = params.text_document
    ls.changed(opened.uri, opened.text, opened.version, delay=0)


def _did_change(ls: Server, params: types.DidChangeTextDocumentParams) -> None:
    uri = params.text_document.uri
    ls.changed(uri, ls.workspace.get_text_document(uri).source, params.text_document.version, delay=BURST)


def _did_close(ls: Server, params: types.DidCloseTextDocumentParams) -> None:
    ls.closed(params.text_document.uri)
    ls.text_document_publish_diagnostics(types.PublishDiagnosticsParams(params.text_document.uri, []))


def _shutdown(ls: Server, _: None) -> None:
    ls.was_shut_down = True
    for uri in list(ls.opened):
        ls.closed(uri)


def _hover(ls: Server, params: types.HoverParams) -> types.Hover | None:
    view = ls.view(params.text_document.uri)
    found = hover(view.document, view.offset(params.position), ls.at(view.uri).findings)
    return types.Hover(messages.markdown(found.text), view.range(found.span)) if found else None


def _completion(ls: Server, params: types.CompletionParams) -> types.CompletionList:
    view = ls.view(params.text_document.uri)
    return messages.completion_list(view, completions(view.document, view.offset(params.position)))


def _definition(ls: Server, params: types.DefinitionParams) -> list[types.Location]:
    view = ls.view(params.text_document.uri)
    return [view.location(span) for span in definitions(view.document, view.offset(params.position))]


def _references(ls: Server, params: types.ReferenceParams) -> list[types.Location]:
    view = ls.view(params.text_document.uri)
    with_definitions = params.context.include_declaration
    found = references(view.document, view.offset(params.position), with_definitions=with_definitions)
    return [view.location(span) for span in found]


def _highlight(ls: Server, params: types.DocumentHighlightParams) -> list[types.DocumentHighlight]:
    view = ls.view(params.text_document.uri)
    found = references(view.document, view.offset(params.position))
    return [types.DocumentHighlight(view.range(span)) for span in found]


def _prepare_rename(ls: Server, params: types.PrepareRenameParams) -> types.Range | None:
    view = ls.view(params.text_document.uri)
    try:
        return view.range(renamed(view.document, view.offset(params.position)).span)
    except RefusedError as refused:
        raise _failed(refused) from None


def _rename(ls: Server, params: types.RenameParams) -> types.WorkspaceEdit:
    view = ls.view(params.text_document.uri)
    try:
        return view.change(rename(view.document, view.offset(params.position), params.new_name))
    except RefusedError as refused:
        raise _failed(refused) from None


def _failed(refused: RefusedError) -> JsonRpcException:
    return JsonRpcException(str(refused), types.LSPErrorCodes.RequestFailed)


def _actions(ls: Server, params: types.CodeActionParams) -> list[types.CodeAction]:
    view = ls.view(params.text_document.uri)
    place = view.span(params.range)
    if params.context.only and not any(types.CodeActionKind.QuickFix.startswith(kind) for kind in params.context.only):
        return []
    found = [(each, each.primary.span) for each in ls.at(view.uri).findings if each.primary]
    about = [each for each, span in found if span.start <= place.end and place.start <= span.end]
    actions = [messages.action(view, each, fix) for each in about for fix in fixes(each)]
    for code in dict.fromkeys(each.code for each in about):
        title = f"show the page of {code} ({codes.CODES[code].name})"
        shown = messages.command(title, SHOW_PAGE, [code])
        actions.append(types.CodeAction(title, types.CodeActionKind.QuickFix, command=shown))
    return actions


def _formatting(ls: Server, params: types.DocumentFormattingParams) -> list[types.TextEdit] | None:
    """The text in its canonical layout; nothing where its syntax has errors, which are shown anyway."""
    view = ls.view(params.text_document.uri)
    source = view.document.source
    text = layout(source)
    if not isinstance(text, str) or text == source.text:
        return None
    return [types.TextEdit(view.range(Span(0, len(source.text))), text)]


def _symbols(
    ls: Server, params: types.DocumentSymbolParams
) -> list[types.DocumentSymbol] | list[types.SymbolInformation]:
    view = ls.view(params.text_document.uri)
    entries = list(outline(view.document))
    known = ls.client_capabilities.text_document
    if known and known.document_symbol and known.document_symbol.hierarchical_document_symbol_support:
        return [messages.symbol(view, entry) for entry in entries]
    return list(messages.flat_symbols(view, entries))


def _tokens(ls: Server, params: types.SemanticTokensParams) -> types.SemanticTokens:
    view = ls.view(params.text_document.uri)
    return messages.semantic_tokens(view, tokens(view.document))


def _lenses(ls: Server, params: types.CodeLensParams) -> list[types.CodeLens]:
    view = ls.view(params.text_document.uri)
    return [
        types.CodeLens(view.range(lens.span), messages.command(lens.title, SHOW_AUTOMATON, [view.uri, lens.label]))
        for lens in lenses(view.document, ls.at(view.uri).summaries)
    ]


async def _show_automaton(ls: Server, uri: str, label: str) -> str | None:
    """Show the automaton of the property with this label; the path of the page."""
    specification = ls.view(uri).document.reading.sound
    chosen = next((each for each in specification.properties if each.label == label), None)
    if chosen is None:
        ls.say(f"there is no longer a property {label}")
        return None
    page = await ls.in_child(partial(automaton_page, specification, chosen, ls.encoding, ls.budget))
    if page is None:
        return None
    path = ls.folder / f"{specification.properties.index(chosen)}.html"
    write_text(path, page)
    return await ls.show(path, in_browser=True)


async def _show_page(ls: Server, code: str) -> str | None:
    """Show the page of a diagnostic; its path."""
    return await ls.show(codes.page_path(code), in_browser=False) if code in codes.CODES else None


_FEATURES: dict[str, tuple[Callable[..., Any], Any]] = {
    types.TEXT_DOCUMENT_DID_OPEN: (_did_open, None),
    types.TEXT_DOCUMENT_DID_CHANGE: (_did_change, None),
    types.TEXT_DOCUMENT_DID_CLOSE: (_did_close, None),
    types.SHUTDOWN: (_shutdown, None),
    types.TEXT_DOCUMENT_HOVER: (_hover, None),
    types.TEXT_DOCUMENT_COMPLETION: (_completion, types.CompletionOptions([".", "/", "_"])),
    types.TEXT_DOCUMENT_DEFINITION: (_definition, None),
    types.TEXT_DOCUMENT_REFERENCES: (_references, None),
    types.TEXT_DOCUMENT_DOCUMENT_HIGHLIGHT: (_highlight, None),
    types.TEXT_DOCUMENT_PREPARE_RENAME: (_prepare_rename, None),
    types.TEXT_DOCUMENT_RENAME: (_rename, None),
    types.TEXT_DOCUMENT_CODE_ACTION: (_actions, types.CodeActionOptions([types.CodeActionKind.QuickFix])),
    types.TEXT_DOCUMENT_FORMATTING: (_formatting, None),
    types.TEXT_DOCUMENT_DOCUMENT_SYMBOL: (_symbols, None),
    types.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL: (_tokens, messages.LEGEND),
    types.TEXT_DOCUMENT_CODE_LENS: (_lenses, None),
}
"""The handler of each request and notification, with the options that are registered for it."""


def _is_fault(record: logging.LogRecord) -> bool:
    """Whether a log record is not about a request that was refused, which the editor learns from the answer."""
    if record.getMessage().startswith("Unable to deserialize message"):
        return False
    error = record.exc_info[1] if record.exc_info else None
    return not (isinstance(error, JsonRpcException) and error.code == types.LSPErrorCodes.RequestFailed)


def _end(pages: tempfile.TemporaryDirectory[str], number: int, _: object) -> None:
    """End at once by a signal, without the folder; children end with this process.

    An exception would not do: Python would wait for the thread that reads what the editor says.
    """
    pages.cleanup()
    signal.signal(number, signal.SIG_DFL)
    os.kill(os.getpid(), number)


def serve(message_paths: Sequence[str], encoding: Encoding, budget: Budget) -> bool:
    """Speak with the editor at stdin and stdout until it ends; whether that was in good order."""
    gc.freeze()  # else the collector looks through all that is imported, at some keys
    logging.getLogger("pygls.protocol.json_rpc").addFilter(_is_fault)
    pages = tempfile.TemporaryDirectory(prefix="ltlc-")
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, partial(_end, pages))
    with pages as folder:
        server = Server(message_paths, encoding, budget, folder)
        for name, (answer, options) in _FEATURES.items():
            server.feature(name, options)(answer)
        server.command(SHOW_AUTOMATON)(_show_automaton)
        server.command(SHOW_PAGE)(_show_page)
        server.start_io()
    return server.was_shut_down
