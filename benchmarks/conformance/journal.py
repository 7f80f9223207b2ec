"""Cases that were made, with what ltlc and the judge from Coq find of them; which of them become numbered cases."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from time import monotonic
from unittest.mock import patch

from benchmarks.conformance import proved, ways
from benchmarks.conformance.cases import Case, Verdicts, case_of
from benchmarks.conformance.definition import definition
from benchmarks.conformance.make import Maker, key
from benchmarks.conformance.readings import BY_PARTS, tells
from benchmarks.conformance.ways import Agreement
from benchmarks.differential import arrivals

TAKEN = ("same", "late", "other", "whole")
"""What becomes of cases that are numbered: others are not decided, or not in the language of all."""


def hunt(journal: Path, judge: Path, seed: int, seconds: float) -> Counter[str]:
    """Make cases, at least one, until the time is over, and append them to a journal with what became of each.

    What a property waits for is found by fewer trials than in the reference, which is asked again.
    """
    known, made, outcomes = set[str](), Counter[str](), Counter[str]()
    for case, _ in journalled(journal):
        known.add(key(case))
        made.update(case.readings)
    end = monotonic() + seconds
    while monotonic() < end or not outcomes:
        with patch.object(arrivals, "TRIED", 40):
            cases = Maker(seed, known, made).cases()
        for drawn in cases:
            outcome, case = settled(drawn, judge)
            if outcome == "whole" and key(case) in known:
                continue
            known.add(key(case))
            outcomes[outcome] += 1
            with journal.open("a") as file:
                file.write(json.dumps({**case.document(), "outcome": outcome}, allow_nan=False) + "\n")
        seed += 1
    return outcomes


def settled(case: Case, judge: Path) -> tuple[str, Case]:
    """What becomes of a case: `same`, `late` or `other` by what ltlc finds, and whether it is proved.

    It is `refuted` if the judge refuses it, `misread` if more trials find another beginning, and `early` if ltlc
    decides before the reference; where the judge accepts that, it becomes a case of the `whole` property.
    """
    if definition(case.text).verdicts(case.recording) != case.expected:
        return "misread", case
    found = ways.agreement(case)
    if found is Agreement.REFUSED:
        return "refused", case
    if found is Agreement.EARLY:
        shown = ways.by_rows(case)
        assert isinstance(shown, Verdicts)
        expected = Verdicts(shown.changes, case.expected.steps)
        told = (name for name in case.readings if tells(name, case.text, case.recording, expected))
        whole = replace(case, readings=(BY_PARTS, *told), expected=expected, proved=True)
        return ("whole", whole) if proved.proof(whole, judge)[0] else ("early", case)
    is_proved, refused = proved.proof(case, judge)
    return "refuted" if refused else found.value, replace(case, proved=is_proved)


def journalled(journal: Path) -> Iterator[tuple[Case, str]]:
    """The cases in a journal, with what became of them."""
    for line in journal.read_text().splitlines() if journal.exists() else ():
        document = json.loads(line)
        yield case_of(document), document["outcome"]


def chosen(known: Sequence[Case], journals: Iterable[Path], most: int) -> list[Case]:
    """New cases, numbered from those that are `known` on, so that there are `most` altogether.

    Cases come first whose readings have few before them, so that any first part of a suite has some of each.
    """
    seen, new = {key(case) for case in known}, list[Case]()
    for journal in journals:
        for case, outcome in journalled(journal):
            if outcome in TAKEN and key(case) not in seen:
                seen.add(key(case))
                new.append(case)
    made, ranks = Counter(name for case in known for name in case.readings), list[int]()
    for case in new:
        made.update(case.readings)
        ranks.append(min(made[name] for name in case.readings))
    ordered = [case for _, case in sorted(zip(ranks, new, strict=True), key=lambda each: each[0])]
    first = max((case.number for case in known), default=0) + 1
    taken = ordered[: max(0, most - len(known))]
    return [replace(case, number=number) for number, case in enumerate(taken, first)]
