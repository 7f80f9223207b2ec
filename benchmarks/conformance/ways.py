"""What ltlc finds of cases: by rows, by columns, in C, and in files of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from enum import Enum
from functools import lru_cache
from random import Random

from benchmarks.conformance.cases import Case, Change, Verdicts
from benchmarks.conformance.definition import definition
from benchmarks.conformance.score import Answer, Outside
from benchmarks.differential import targets
from benchmarks.differential.compare import compared, last_of_each_time, refuted
from benchmarks.differential.reference import whole_run
from benchmarks.differential.samples import Recording
from benchmarks.differential.targets import Found, UnusableError

monitors = lru_cache(8)(targets.monitors)
"""Those of a specification, kept."""


class Agreement(Enum):
    """What ltlc finds by rows, beside the definition."""

    SAME = "same"
    EARLY = "early"
    LATE = "late"
    OTHER = "other"
    REFUSED = "refused"


def agreement(case: Case) -> Agreement:
    """Whether ltlc finds the same; it may be `early`, with a permanent verdict that nothing refutes."""
    try:
        of = monitors(case.text)
    except UnusableError:
        return Agreement.REFUSED
    found = targets.by_rows(of, case.recording, Random(0))["p"]
    assert found.changes is not None
    if last_of_each_time(found.changes) == list(case.expected.changes):
        return Agreement.SAME
    by = definition(case.text)
    if by.property is None or by.each is not None:
        return Agreement.EARLY if _decides_earlier(found.changes, case.expected) else Agreement.OTHER
    run = whole_run({"p": by.property}, case.recording)
    one = compared(by.judged(run), found, refuted(by.property, run))
    return Agreement.EARLY if one.early else Agreement.LATE if one.late else Agreement.OTHER


def _decides_earlier(changes: Sequence[Change], expected: Verdicts) -> bool:
    """Whether the last change is a violation, at a time at which it is not known yet, and nothing else differs."""
    if not changes or changes[-1][1] != "violated" or expected.at(changes[-1][0]) == "violated":
        return False
    before = [change for change in expected.changes if change[0] < changes[-1][0]]
    return before == [change for change in changes[:-1] if change[0] < changes[-1][0]]


def by_rows(case: Case) -> Answer:
    """The session, message by message."""
    return _answer(case, targets.by_rows(monitors(case.text), case.recording, Random(0)).get("p"))


def in_c(case: Case) -> Answer:
    """The emitted C, compiled and called."""
    of = monitors(case.text)
    if "C" not in of.libraries:
        return Outside("refused for C, or no compiler")
    return _answer(case, targets.by_compiled(of, case.recording, "C").get("p"))


def by_columns(case: Case) -> Answer:
    """Blocks of rows. They show no changes of the verdict, so it is asked at each row, and around each change due."""
    of, run = monitors(case.text), case.recording
    due = {moment for time, _ in case.expected.changes for moment in (time - 1, time)}
    moments = sorted({*due, *(row.time for row in run.rows), run.end})
    changes: list[Change] = []
    for moment in (each for each in moments if run.begin <= each <= run.end):
        part = Recording([row for row in run.rows if row.time <= moment], run.begin, moment)
        changes.append((moment, targets.by_columns(of, part, Random(moment))["p"].verdict))
    return Verdicts([change for change in last_of_each_time(changes) if change[1] != "not_started"], ())


def _answer(case: Case, found: Found | None) -> Answer:
    if found is None:
        return Outside("refused")
    assert found.changes is not None
    return Verdicts(found.changes, ())


WAYS: Mapping[str, Callable[[Case], Answer]] = {
    "ltlc by rows": by_rows,
    "ltlc by columns": by_columns,
    "ltlc in C": in_c,
}


def answers(way: str, cases: Iterable[Case]) -> dict[int, Answer]:
    """What a way of ltlc finds of some cases."""
    return {case.number: WAYS[way](case) for case in cases}
