"""Makes and applies fixes, so that the hint for a person and the edit for a program are the same."""

from __future__ import annotations

from bisect import bisect, insort
from collections.abc import Iterable, Sequence
from dataclasses import replace

from ltlc.base.diagnostics import Diagnostic, Fix, Help
from ltlc.base.nearest import is_slip, nearest
from ltlc.base.source import Span


def writing(span: Span, text: str, *, is_certain: bool = False) -> Fix:
    """The fix that puts `text` in place of `span`."""
    return Fix(f"write `{' '.join(text.split())}`", ((span, text),), is_certain)


def write(*fixes: Fix) -> Help:
    """The advice to choose one of `fixes`, which are of `writing`."""
    return Help("write " + " or ".join(fix.title.removeprefix("write ") for fix in fixes), fixes)


def put(place: int, text: str, *, is_certain: bool = False) -> Fix:
    """The fix that puts `text` in before the character at `place`."""
    return Fix(f"insert `{text.strip()}`", ((Span(place, place), text),), is_certain)


def around(title: str, span: Span, before: str, after: str) -> Fix:
    """The fix that `title` orders: `before` and `after` put around what stands at `span`."""
    return Fix(title, ((Span(span.start, span.start), before), (Span(span.end, span.end), after)))


def respell(span: Span, name: str, known: Iterable[str], *, is_closed: bool = False) -> Help | None:
    """The question whether, by `name` at `span`, the nearest of the `known` names is meant; None if none is near.

    The fix is certain if nobody can add to the known names, for their list `is_closed`, and `name` is a slip of the
    pen of one of them only.
    """
    names = list(known)
    found = nearest(name, names)
    if found is None:
        return None
    slips = [each for each in names if is_slip(name, each)]
    return Help(f"did you mean `{found}`?", (writing(span, found, is_certain=is_closed and slips == [found]),))


def uncertain(found: Diagnostic) -> Diagnostic:
    """`found`, with fixes that are a person's to choose."""
    return replace(found, fixes=tuple(replace(fix, is_certain=False) for fix in found.fixes))


def apart(fixes: Iterable[Fix]) -> list[Fix]:
    """`fixes` without those that touch what an earlier one changes: such have to wait for the next reading."""
    chosen: list[Fix] = []
    taken: list[Span] = []
    for fix in fixes:
        if not any(_touches(span, taken) for span, _ in fix.edits):
            chosen.append(fix)
            for span, _ in fix.edits:
                insort(taken, span)
    return chosen


def with_fixes(text: str, fixes: Iterable[Fix]) -> str:
    """`text` with the `fixes` carried out, which are `apart`."""
    for span, written in sorted((edit for fix in fixes for edit in fix.edits), reverse=True):
        text = text[: span.start] + written + text[span.end :]
    return text


def _touches(span: Span, others: Sequence[Span]) -> bool:
    """Whether `span` touches one of `others`, which are in order and do not touch one another."""
    place = bisect(others, span)
    return any(span.start <= other.end and other.start <= span.end for other in others[max(0, place - 1) : place + 1])
