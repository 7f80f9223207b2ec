"""Whether what a way of ltlc finds is what the reference says."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from random import Random
from typing import Any

from benchmarks.differential.reference import Judged, Property, judged_alone
from benchmarks.differential.samples import Recording, Row
from benchmarks.differential.targets import Found

PERMANENT = ("violated", "satisfied")
HOLDS = {"satisfied": True, "presumably_satisfied": True, "violated": False, "presumably_violated": False}
AGAIN = 30
"""So often messages come again where it is asked what can still be."""

FOR_EVER = 20 * 10**9
"""Longer than all durations that are drawn, one after the other: by then nothing changes any more."""


@dataclass(frozen=True)
class Compared:
    """What differs, if something does; whether ltlc decided `early`, before the reference could.

    `late` is the nanosecond that `docs/assurance.md` allows where a message is news or `previously` catches up.
    """

    problem: str = ""
    early: bool = False
    late: bool = False


Continued = Callable[[str, int], bool]
"""Whether some run that begins as this one up to a time shows that a permanent verdict at that time is wrong."""


def compared(expected: Judged, found: Found, is_refuted: Continued) -> Compared:
    """Compare a property on a recording."""
    decided = found.decided
    if decided is None and found.verdict in PERMANENT and found.changes:
        decided = found.changes[-1][0]
    ours, changes = _decided(expected), list(expected.changes)
    if found.verdict not in PERMANENT or decided is None or (ours is not None and decided > ours + 1):
        return Compared(_difference(expected, found, changes, decided, False))
    if ours is not None and decided == ours + 1 and expected.is_news_or_previous:
        changes[-1] = (decided, changes[-1][1])
        problem = _difference(expected, found, changes, decided, True)
        return Compared(problem, late=not problem)
    problem = _difference(expected, found, changes, decided, False)
    if not problem:
        return Compared()
    if (ours is not None and decided > ours) or is_refuted(found.verdict, decided):
        return Compared(problem)
    changes = [*(change for change in changes if change[0] < decided), (decided, found.verdict)]
    problem = _difference(expected, found, changes, decided, True)
    return Compared(problem, early=not problem)


def _difference(
    expected: Judged, found: Found, changes: list[tuple[int, str]], decided: int | None, is_near: bool
) -> str:
    verdict = changes[-1][1] if changes else "not_started"
    if found.verdict != verdict:
        return f"{found.verdict} at {decided}, but {_text(expected)}"
    if verdict in PERMANENT and decided is not None and decided != changes[-1][0]:
        return f"{verdict} at {decided}, but {_text(expected)}"
    if found.changes is not None:
        shown = last_of_each_time if found.shows_last else list
        if not _same(shown(changes), shown(found.changes), is_near):
            return f"changes {list(found.changes)}, but {_text(expected)}"
    if verdict in PERMANENT:
        return ""
    if found.steps not in (None, expected.steps):
        return f"{found.steps} steps, but {_text(expected)}"
    if found.invalid not in (None, expected.invalid):
        return f"{found.invalid} invalid steps, but {expected.invalid}; {_text(expected)}"
    if found.at_steps is not None and list(found.at_steps) != expected.at_steps:
        return f"at steps {list(found.at_steps)}, but {expected.at_steps}"
    return ""


def _same(wanted: Sequence[tuple[int, str]], found: Sequence[tuple[int, str]], is_near: bool) -> bool:
    """Whether the changes are the same; just before a verdict that comes at another time, others may be left out."""
    if not is_near:
        return list(wanted) == list(found)
    end = found[-1][0]
    return [w for w in wanted if w[0] < end - 1] == [f for f in found if f[0] < end - 1] and wanted[-1] == found[-1]


def last_of_each_time(changes: Sequence[tuple[int, str]]) -> list[tuple[int, str]]:
    """What the changes of verdict are where those at one time are seen as one."""
    found: list[tuple[int, str]] = []
    for time, verdict in dict(changes).items():
        if not found or found[-1][1] != verdict:
            found.append((time, verdict))
    return found


def refuted(of: Property, recording: Recording) -> Continued:
    """By runs that go on otherwise: in silence for ever, as the recording does and then so, or with messages again.

    The last are drawn from the recording. That something holds in one of them for ever is taken from that it does at
    every instant of the last third, by when intervals have begun. With a rate they come later: a tick has seen all
    messages of its own time.
    """
    chance = Random(len(recording.rows))
    first = 0 if of.names.rate is None else 1

    @cache
    def is_refuted(verdict: str, decided: int) -> bool:
        before = [row for row in recording.rows if row.time <= decided]
        for rows in (before, recording.rows):
            silent = Recording(rows, recording.begin, max(recording.end, decided) + FOR_EVER)
            if HOLDS.get(judged_alone(of, silent).verdict) is not HOLDS[verdict]:
                return True
        for apart in (1, 10**8, 1, 10**8):
            again = _again(recording.rows, chance)
            rows = [*before, *(Row(decided + number * apart, again) for number in range(first, first + AGAIN))]
            if rows[-1].time <= decided + of.waits:
                continue
            found = judged_alone(of, Recording(rows, recording.begin, rows[-1].time)).verdicts
            if found and {HOLDS[each] for each in found[-AGAIN // 3 :]} == {not HOLDS[verdict]}:
                return True
        return False

    return is_refuted


def _again(rows: Sequence[Row], chance: Random) -> dict[str, Mapping[str, Any]]:
    """A message of each topic, one of those that came."""
    found: dict[str, Mapping[str, Any]] = {}
    for row in chance.sample(list(rows), len(rows)):
        found = {**row.messages, **found}
    return found


def _decided(expected: Judged) -> int | None:
    return expected.changes[-1][0] if expected.changes and expected.changes[-1][1] in PERMANENT else None


def _text(expected: Judged) -> str:
    return f"{expected.changes} in {expected.steps} steps"
