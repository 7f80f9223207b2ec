"""How columns are headed: by the name of a signal, or by topic and field, `/odom/twist/twist/linear/x`."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.rows import RecordingError, failure
from ltlc.specification.expressions import Each, Field, PathStep, Signal

TIMES = ("time", "__time", "timestamp")
"""Heads of the column of times; PlotJuggler writes the second."""

MOST_HEADS = 100_000
"""No table has more columns."""

_DOTTED = re.compile(r"\.([0-9]{1,9})(?=[./]|$)")
_ELEMENT = re.compile(r"(.+)\[([0-9]{1,9})\]")


def too_many(path: Path) -> RecordingError:
    """The error about a table with more columns than there can be."""
    message = f"`{path}` has more than {MOST_HEADS} columns"
    return failure("LTL801", path, message, "store measurements as values, not as names of columns")


def time_head(heads: Sequence[str]) -> str | None:
    """Which of `heads` is that of the times."""
    return next((head for head in TIMES if head in heads), None)


def standard(head: str) -> str:
    """`head` with indexes as PlotJuggler writes them today; it wrote `/scan/ranges.3` once.

    A field may stand after a dot, as in a declaration: names of topics have none.
    """
    return _DOTTED.sub(r"[\1]", head).replace(".", "/") if head.startswith("/") else head


def array_and_index(head: str) -> tuple[str, int] | None:
    """The array and the index, if `head` is that of an element."""
    match = _ELEMENT.fullmatch(head)
    return (match.group(1), int(match.group(2))) if match else None


@dataclass(frozen=True, slots=True)
class Spelling:
    """A way to head columns of a signal: one column, or one for each of its elements, `before[3]after`."""

    whole: str
    before: str
    after: str = ""

    def element(self, index: int) -> str:
        """The head of the element at `index`."""
        return f"{self.before}[{index}]{self.after}"

    def index(self, head: str) -> int | None:
        """Which element `head` is that of."""
        middle = head[len(self.before) : len(head) - len(self.after)]
        found = array_and_index(f"_{middle}")
        return found[1] if found and head == self.element(found[1]) else None


def spellings(signal: Signal) -> Iterator[Spelling]:
    """How its columns may be headed, the best first."""
    yield Spelling(signal.name, signal.name)
    if not isinstance(signal.definition, Field):
        return
    topic, path = signal.definition.topic, signal.definition.path
    if not all(isinstance(step, str | int | Each) for step in path):
        return
    if Each() in path:
        place = path.index(Each())
        before, after = topic + _written(path[:place]), _written(path[place + 1 :])
        yield Spelling(f"{before}[]{after}", before, after)
    else:
        whole = topic + _written(path)
        yield Spelling(whole, whole)


def _written(path: Sequence[PathStep]) -> str:
    return "".join(f"[{step}]" if isinstance(step, int) else f"/{step}" for step in path)
