"""Comments by which an author says that a finding is known: `# ltlc: ignore LTL512`, `# ltlc: ignore-file LTL512`."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from ltlc.base.codes import CODES, diagnostic, find
from ltlc.base.diagnostics import Diagnostic, Fix, Help, Severity
from ltlc.base.source import Source, Span
from ltlc.dataclass import dataclass
from ltlc.frontend.syntax import tree as syntax
from ltlc.frontend.syntax.parse import parse
from ltlc.specification.specification import Specification

_STRING_OR_COMMENT = re.compile(r'"(?:[^"\\\n]|\\.)*"|#[^\n]*')
_SUPPRESSION = re.compile(r"#\s*ltlc:\s*(ignore-file|ignore)\b([^#\n]*)")
_WORD = re.compile(r"[\w-]+")

ANALYSES = ("LTL5", "LTL6")
"""How the codes of analyses begin: these findings can be suppressed even where they are errors."""


@dataclass(frozen=True, slots=True)
class Suppression:
    """One code in a comment: `span` is its place, `lines` those it is about (from 1); None for the whole file."""

    code: str
    span: Span
    lines: range | None


def suppressions(source: Source, properties: Sequence[Span] = ()) -> list[Suppression]:
    """The suppressions in `source`; one that touches a property is about all its lines."""
    found = []
    for comment in _STRING_OR_COMMENT.finditer(source.text):
        match = _SUPPRESSION.match(comment.group())
        if match is None:
            continue
        lines = None if match.group(1) == "ignore-file" else _lines(source, comment.start(), properties)
        for code, place in _codes(match):
            span = Span(comment.start() + place.start, comment.start() + place.end)
            found.append(Suppression(code, span, lines))
    return found


def _codes(match: re.Match[str]) -> Iterator[tuple[str, Span]]:
    """The codes in a comment, with their places in it; a remark may follow them."""
    for number, word in enumerate(_WORD.finditer(match.string, match.start(2))):
        code = find(word.group())
        if code is None and number > 0 and not word.group().upper().startswith("LTL"):
            return
        yield code or word.group(), Span(*word.span())


def _lines(source: Source, start: int, properties: Sequence[Span]) -> range:
    """The lines that a comment at `start` is about: its own or, if it is alone there, the next with something in it."""
    line = source.position(start).line
    last = source.position(len(source.text)).line
    if not source.line(line)[: source.position(start).column - 1].strip():
        line += 1
        while line < last and source.line(line).partition("#")[0].strip() == "":
            line += 1
    for span in properties:
        first, end = source.position(span.start).line, source.position(span.end).line
        if first <= line <= end:
            return range(first, end + 1)
    return range(line, line + 1)


def suppress(
    specification: Specification, diagnostics: Sequence[Diagnostic], *, pedantic: bool = False
) -> list[Diagnostic]:
    """`diagnostics` without those that a comment in the file suppresses, and a note for each that suppresses none.

    None for a code that is reported on demand only, unless `pedantic` says that it was asked for.
    """
    source = specification.source
    asked = suppressions(source, [p.whole() for p in specification.properties])
    kept = [each for each in diagnostics if not any(_is_about(s, each) for s in asked)]
    idle = [s for s in asked if not any(_is_about(s, each) for each in diagnostics)]
    unasked = set() if pedantic else {code for code, known in CODES.items() if known.pedantic}
    return kept + [_idle(source, each) for each in idle if each.code not in unasked]


def unsuppressed(diagnostics: Sequence[Diagnostic]) -> list[Diagnostic]:
    """`diagnostics` of the front end without those that a comment in their text suppresses, whatever errors that has.

    Whether a comment suppresses nothing is only known with the analyses.
    """
    asked = {source: _in_text(source) for source in {each.source for each in diagnostics}}
    return [each for each in diagnostics if not any(_is_about(s, each) for s in asked[each.source])]


def _in_text(source: Source) -> list[Suppression]:
    if not suppressions(source):
        return []
    tree, _ = parse(source)
    return suppressions(source, [c.whole() for c in tree.commands if isinstance(c, syntax.PropertyCommand)])


def _is_about(suppression: Suppression, each: Diagnostic) -> bool:
    if each.code != suppression.code or (each.severity is Severity.ERROR and not each.code.startswith(ANALYSES)):
        return False
    if suppression.lines is None:
        return True
    return each.primary is not None and each.source.position(each.primary.span.start).line in suppression.lines


def _idle(source: Source, suppression: Suppression) -> Diagnostic:
    if suppression.code not in CODES:
        message = f"there is no diagnostic `{suppression.code}`"
        return diagnostic("LTL691", source, suppression.span, message, help="`ltlc explain CODE` explains a code")
    name = CODES[suppression.code].name
    message = f"no finding `{suppression.code}` ({name}) here to suppress"
    return diagnostic("LTL691", source, suppression.span, message, help=_without(source, suppression))


def _without(source: Source, idle: Suppression) -> Help:
    """How to be rid of an idle suppression: its comment can go, or its code if that is one of several."""
    text = source.text
    comment = next(c for c in _STRING_OR_COMMENT.finditer(text) if c.end() >= idle.span.end)
    match = _SUPPRESSION.match(comment.group())
    if match is None or len(list(_codes(match))) > 1:
        rest = text[idle.span.end : comment.end()]
        place = Span(idle.span.start, idle.span.end + len(rest) - len(rest.lstrip(" ,")))
        return Help("remove the comment", (Fix(f"remove `{idle.code}` from the comment", ((place, ""),)),))
    start, end = len(text[: comment.start()].rstrip(" \t")), comment.start() + len(comment.group().rstrip("\r"))
    if text[start - 1 : start] in ("", "\n"):
        end = comment.end() + 1
    return Help("remove the comment", (Fix("remove the comment", ((Span(start, min(end, len(text))), ""),)),))
