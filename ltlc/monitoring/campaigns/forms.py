"""The report on many recordings, on stdout: as text while they arrive, as one JSON document, as one JUnit report."""

from __future__ import annotations

import json
from typing import Protocol

from ltlc.base.render.table import aligned
from ltlc.monitoring.campaigns.outcomes import Outcome, PropertyOutcome
from ltlc.monitoring.campaigns.places import Found
from ltlc.monitoring.campaigns.tally import Result, Tally, brief
from ltlc.monitoring.judging.run import unread_case, warnings
from ltlc.runtime import junit, reports
from ltlc.runtime.guard_reports import counts_text
from ltlc.semantics.durations import Nanoseconds


class Form(Protocol):
    """A form of output; what it returns is to be written to stdout."""

    def add(self, outcome: Outcome) -> str:
        """The recording that is next in their order."""
        ...

    def end(self, tally: Tally, found: Found) -> str:
        """All recordings were added."""
        ...


class Text:
    """A line for each recording, and each guard; errors as that of one recording has them; a table, lines for all."""

    def __init__(self) -> None:
        self._has_blank_line = False

    def add(self, outcome: Outcome) -> str:
        """The recording's line and errors."""
        errors = [_placed(each.figure, outcome.place.name) for each in outcome.properties if each.figure]
        self._has_blank_line = bool(errors)
        guards = [f"  {counts_text(out, counts)}" for out, counts in outcome.guards.items()]
        return "\n".join([brief(outcome), *guards, *errors]) + "\n"

    def end(self, tally: Tally, found: Found) -> str:
        """How often each property came out how, and a line for all recordings."""
        head = ["property", *(kind.value for kind in Result)]
        rows = [
            [reports.printable(each.label), *(str(each.counts[kind] or "") for kind in Result)]
            for each in tally.properties.values()
        ]
        table = aligned([head, *rows], right=range(1, len(head))) if rows else []
        said = ["; ".join([tally.sentence(), *remarks(found)]), *tally.guard_sentences()]
        lines = [*([] if self._has_blank_line else [""]), *table, *_closest(tally), "", *said]
        return "".join(f"{line}\n" for line in lines)


def _closest(tally: Tally) -> list[str]:
    """The least margin of each property that was measured, and in which recording it was."""
    rows = [
        [reports.printable(each.label), f"{least:.6g}", f"{each.median:.6g}", reports.printable(recording)]
        for each in tally.measured
        for least, recording in [min(each.margins)]
    ]
    head = ["closest to failing", "least margin", "median", "recording"]
    return ["", *aligned([head, *rows], right=range(1, 3))] if rows else []


def remarks(found: Found) -> list[str]:
    """What to know of what was not taken for a recording."""
    told = []
    if found.left_alone:
        kind = "a recording" if found.left_alone == 1 else "recordings"
        told.append(f"{reports.counted(found.left_alone, 'file')} skipped: not {kind}")
    if found.doubled:
        told.append(f"{reports.counted(len(found.doubled), 'recording')} given twice, judged once")
    return told


def _placed(figure: str, recording: str) -> str:
    """The error of a property, with the recording in its first line."""
    head, rest = figure.split("\n", 1)
    return f"{head.removesuffix(':')}, in {reports.printable(recording)}:\n{rest}"


class Json:
    """One document: each recording's own, and what they show together."""

    def __init__(self) -> None:
        self._documents: list[str] = []

    def add(self, outcome: Outcome) -> str:
        """Nothing yet."""
        self._documents.append(json.dumps(outcome.document(), indent=2, allow_nan=False))
        return ""

    def end(self, tally: Tally, found: Found) -> str:
        """The document."""
        summary = tally.document() | {"left_alone": found.left_alone, "given_twice": found.doubled}
        summary["not_found"] = [each.message for each in found.problems]
        documents = ",\n".join(self._documents)
        return f'{{"recordings": [\n{documents}\n],\n"summary": {json.dumps(summary, indent=2)}}}\n'


class JUnit:
    """One report with a test suite for each recording; what kept one from being judged whole is an error in it.

    A folder or a pattern without recordings has a suite, too.
    """

    def __init__(self) -> None:
        self._suites: list[str] = []

    def add(self, outcome: Outcome) -> str:
        """Nothing yet."""
        cases = [
            junit.Case(
                name=each.label,
                element=junit.case_element(each.verdict, has_lost="lost_messages" in each.report),
                kind=each.verdict.value,
                message=each.sentence,
                details=each.figure or f"{each.sentence}\n",
                file=each.report["file"],
                line=each.report["line"],
                time=_judged_for(outcome, each),
                requirement=each.report.get("requirement", {}),
            )
            for each in outcome.properties
        ]
        cases += map(junit.guard_case, outcome.report.get("guard", ()))
        if outcome.error is not None:
            cases.append(unread_case(str(outcome.error["code"]), str(outcome.error["message"])))
        remarks = [*outcome.remarks, *warnings(outcome.report["diagnostics"])]
        made_of = junit.provenance_pairs(outcome.report.get("provenance", {}))
        self._suites.append(junit.suite_text(outcome.place.name, cases, remarks, made_of))
        return ""

    def end(self, tally: Tally, found: Found) -> str:
        """The report."""
        for problem in found.problems:
            case = unread_case(problem.code, problem.message)
            self._suites.append(junit.suite_text(problem.source.name, [case], ()))
        return f"{junit.XML_HEAD}<testsuites>\n{''.join(self._suites)}</testsuites>\n"


def _judged_for(outcome: Outcome, found: PropertyOutcome) -> Nanoseconds | None:
    """How long a property was judged, in the time of the recording; None if that is not known."""
    decided = found.report["decided_at"]
    beginning, end = (outcome.report.get(name) for name in ("beginning_ns", "end_ns"))  # not in an older table
    end = end if decided is None else decided["time_ns"]
    return None if beginning is None or end is None else int(end - beginning)


FORMS: dict[str, type[Form]] = {"text": Text, "json": Json, "junit": JUnit}
