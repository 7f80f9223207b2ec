"""What a run has shown, as JUnit XML."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from ltlc.runtime.reports import figure, printable, sentence, unseen
from ltlc.runtime.session import Session
from ltlc.runtime.silence import lost, malformed
from ltlc.runtime.tracking import Track
from ltlc.semantics.verdicts import Verdict


def junit(
    name: str,
    session: Session,
    more: Sequence[Case] = (),
    remarks: Sequence[str] = (),
) -> str:
    """A JUnit XML report: a test suite `name` with one test case for each property.

    After these come `more`, and then `remarks` on all of it.

    What is violated or still owed at the end fails; what never started is an error, and
    so is what would hold if no message had been lost.
    """
    cases = [*(_case(session, track) for track in session.tracks), *more]
    return f"{XML_HEAD}{suite_text(name, cases, [*unseen(session), *remarks])}"


XML_HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n'


@dataclass(frozen=True, slots=True)
class Case:
    """A test case: what there is to say about it in a line, and if it failed in full.

    `element` is what a case has that did not pass: `failure`, `error`, or None.
    """

    name: str
    element: str | None
    kind: str
    message: str
    details: str


def suite_text(name: str, cases: Sequence[Case], remarks: Sequence[str]) -> str:
    """A JUnit test suite as an element of XML."""
    elements = [case.element for case in cases]
    failures, errors = elements.count("failure"), elements.count("error")
    told = "".join(f"{escape(remark, quote=False)}\n" for remark in remarks)
    output = f"  <system-out>{told}</system-out>\n" if told else ""
    return (
        f'<testsuite name={_attribute(name)} tests="{len(cases)}" '
        f'failures="{failures}" errors="{errors}">\n'
        f"{''.join(_case_text(name, case) for case in cases)}{output}</testsuite>\n"
    )


def _case_text(suite: str, case: Case) -> str:
    head = f"classname={_attribute(suite)} name={_attribute(case.name)}"
    message = escape(printable(case.message), quote=False)
    body = f"<system-out>{message}</system-out>"
    if case.element is not None:
        kind = f'message={_attribute(case.message)} type="{case.kind}"'
        details = escape(case.details, quote=False)
        body = f"<{case.element} {kind}>{details}</{case.element}>"
    return f"  <testcase {head}>{body}</testcase>\n"


_FAILURES = (Verdict.VIOLATED, Verdict.PRESUMABLY_VIOLATED)


def _case(session: Session, track: Track) -> Case:
    message = sentence(session, track)
    is_violated = track.verdict is Verdict.VIOLATED
    details = figure(session, track) if is_violated else f"{printable(message)}\n"
    element = case_element(track.verdict, has_lost=_misses(session, track))
    name = track.property.label
    return Case(name, element, track.verdict.value, message, details)


def _misses(session: Session, track: Track) -> bool:
    """Whether something that a property reads could not be judged."""
    left_out = track.slices is not None and track.slices.left_out > 0
    return bool(lost(session, track) or malformed(session, track)) or left_out


def case_element(verdict: Verdict, has_lost: bool = False) -> str | None:
    """What a test case has that did not pass."""
    if verdict in _FAILURES:
        return "failure"
    return None if verdict.holds and not has_lost else "error"


def _attribute(text: str) -> str:
    return f'"{escape(printable(text))}"'
