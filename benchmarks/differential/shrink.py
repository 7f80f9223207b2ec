"""Makes a case in which something differs small: fewer properties, smaller expressions, fewer rows and messages."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from random import Random
from time import monotonic

from benchmarks.differential import campaign, reference, targets
from benchmarks.differential.campaign import Case, Difference, Outcome
from benchmarks.differential.files import cut, is_bag
from benchmarks.differential.samples import Recording, Row
from ltlc.base.source import Source
from ltlc.frontend.syntax import tree as s
from ltlc.frontend.syntax.parse import parse

SECONDS = 60.0
"""For how long a case is made smaller."""


Anew = Callable[[Difference], Difference | None]
"""Judges a case anew, and gives the first difference; None if all is the same."""


def shrunk(found: Difference, seconds: float = SECONDS, anew: Anew | None = None) -> Difference:
    """A smaller case in which the same way differs, judged `anew`."""
    end, now = monotonic() + seconds, found
    is_smaller = True
    while is_smaller and monotonic() < end:
        is_smaller = False
        for candidate in _smaller(now):
            if monotonic() > end:
                break
            kept = (anew or again)(candidate)
            if kept is not None and _size(kept) < _size(now):
                now, is_smaller = kept, True
                break
    return now


def again(of: Difference) -> Difference | None:
    """The first difference that is found when a case is judged anew; None if all is the same."""
    try:
        monitors = targets.monitors(of.text)
    except (targets.UnusableError, AssertionError):
        return None
    try:
        properties = reference.properties(of.text)
        part = of.recording
        if of.way not in targets.IN_MEMORY and of.way != "Python":
            kept = cut(of.recording, is_bag(of.way), of.since, of.until)
            if kept is None:
                return None
            part = kept
        part = reference.whole_run(properties, part)
        expected = campaign.expected(properties, part)
    except (AssertionError, KeyError, StopIteration):
        return None
    outcome = Outcome()
    case = Case(of.way, of.recording, part, of.since, of.until)
    campaign.take(outcome, monitors, properties, case, expected, Random(0))
    crashed = not of.label
    return next((each for each in outcome.differences if crashed == (not each.label)), None)


def _size(of: Difference) -> tuple[int, int, int]:
    messages = sum(len(row.messages) for row in of.recording.rows)
    return (messages + len(of.recording.rows), len(of.text), (of.since is not None) + (of.until is not None))


def _smaller(of: Difference) -> Iterator[Difference]:
    """Smaller cases, those that save most first."""
    yield from _without_properties(of)
    yield from (replace(of, recording=each) for each in smaller_recordings(of.recording))
    yield from _without_times(of)
    yield from (replace(of, text=each) for each in smaller_texts(of.text))


def _without_properties(of: Difference) -> Iterator[Difference]:
    lines = of.text.splitlines()
    own = [line for line in lines if line.startswith(("decl", "object", "_", "soon", "fast"))]
    rest = [line for line in lines if line not in own]
    mine = [line for line in rest if of.label and line.startswith(f"{of.label.split('[')[0]}:")]
    if mine and len(rest) > 1:
        yield replace(of, text="\n".join([*own, *mine]) + "\n")
    if len(rest) > 1:
        for line in rest:
            yield replace(of, text="\n".join(each for each in lines if each != line) + "\n")
    for line in own:
        yield replace(of, text="\n".join(each for each in lines if each != line) + "\n")


def smaller_recordings(of: Recording) -> Iterator[Recording]:
    """Recordings without some rows, without a topic, or without one message of a row."""
    rows = list(of.rows)
    size = len(rows) // 2
    while size:
        for start in range(0, len(rows), size):
            yield from _recording(of, rows[:start] + rows[start + size :])
        size //= 2
    for topic in sorted({topic for row in rows for topic in row.messages}):
        kept = [Row(row.time, {t: v for t, v in row.messages.items() if t != topic}) for row in rows]
        yield from _recording(of, [row for row in kept if row.messages])
    for number, row in enumerate(rows):
        if len(row.messages) > 1:
            for topic in row.messages:
                less = Row(row.time, {t: v for t, v in row.messages.items() if t != topic})
                yield from _recording(of, [*rows[:number], less, *rows[number + 1 :]])


def _recording(of: Recording, rows: list[Row]) -> Iterator[Recording]:
    """A recording of some rows, if there are any."""
    if rows:
        yield Recording(rows, rows[0].time, max(of.end, rows[-1].time))


def _without_times(of: Difference) -> Iterator[Difference]:
    if of.since is not None:
        yield replace(of, since=None)
    if of.until is not None:
        yield replace(of, until=None)


def smaller_texts(text: str) -> Iterator[str]:
    """A part of an expression in the place of the whole, or no bound."""
    tree, problems = parse(Source("props.txt", text))
    if problems:
        return
    for command in tree.commands:
        if isinstance(command, s.PropertyCommand | s.Association):
            for node, _ in s.walk(command):
                for part in list(s.walk(node))[1:]:
                    inside = part[0].span
                    if node is not command and not isinstance(part[0], s.Bound):
                        instead = text[inside.start : inside.end]
                        yield _put(text, node, f"({instead})")
                        yield _put(text, node, instead)
                if isinstance(node, s.Temporal | s.Past) and node.bound is not None:
                    yield _put(text, node.bound, "")


def _put(text: str, node: s.Node, instead: str) -> str:
    return text[: node.span.start] + instead + text[node.span.end :]
