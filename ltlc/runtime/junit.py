"""What a run has shown, as JUnit XML."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import field
from html import escape
from typing import Any

from ltlc.dataclass import dataclass
from ltlc.runtime.guard_reports import actions_text
from ltlc.runtime.guarding import Action
from ltlc.runtime.properties import stated
from ltlc.runtime.reports import figure, printable, sentence, unseen
from ltlc.runtime.session import Session
from ltlc.runtime.silence import lost, malformed
from ltlc.runtime.times import seconds_text
from ltlc.runtime.tracking import Track
from ltlc.semantics.verdicts import Verdict


def junit(
    name: str,
    session: Session,
    more: Sequence[Case] = (),
    remarks: Sequence[str] = (),
    properties: Iterable[Pair] = (),
) -> str:
    """A JUnit XML report: a test suite `name` with one test case for each property.

    After these come `more`, and then `remarks` on all of it; `properties` are of all.

    What is violated or unmet at the end fails; what never started is an error, and
    so is what would hold if no message had been lost.
    """
    cases = [*(_case(session, track) for track in session.tracks), *more]
    told = [*unseen(session), *remarks]
    return f"{XML_HEAD}{suite_text(name, cases, told, properties)}"


Pair = tuple[str, str]
"""The name of a property of a suite or a case, and its value."""


def provenance_pairs(made_of: Mapping[str, Any]) -> Iterator[Pair]:
    """What a report was made of, `provenance` in JSON, as names and values."""
    if made_of:
        yield "ltlc", made_of["ltlc"]
        if made_of["commit"]:
            yield "commit", made_of["commit"]
        for kind in ("specification", "recording"):
            for each in made_of[f"{kind}s"]:
                yield kind, f"{each['name']} sha256:{each['sha256']}"


XML_HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n'


@dataclass(frozen=True, slots=True)
class Case:
    """A test case: its result in a line, and in full if it failed.

    `element` is what a case has that did not pass: `failure`, `error`, or None. It
    stands at a `line` of a `file`, states a `requirement` (an object of JSON), and was
    judged for `time` ns of the run, None if that is not known.
    """

    name: str
    element: str | None
    kind: str
    message: str
    details: str
    file: str = ""
    line: int = 0
    time: int | None = None
    requirement: Mapping[str, Any] = field(default_factory=dict)


def suite_text(
    name: str,
    cases: Sequence[Case],
    remarks: Sequence[str],
    properties: Iterable[Pair] = (),
) -> str:
    """A JUnit test suite as an element of XML."""
    elements = [case.element for case in cases]
    failures, errors = elements.count("failure"), elements.count("error")
    told = "".join(f"{escape(remark, quote=False)}\n" for remark in remarks)
    output = f"  <system-out>{told}</system-out>\n" if told else ""
    return (
        f'<testsuite name={_attribute(name)} tests="{len(cases)}" '
        f'failures="{failures}" errors="{errors}">\n'
        f"{_properties_text(properties, '  ')}"
        f"{''.join(_case_text(name, case) for case in cases)}{output}</testsuite>\n"
    )


def guard_case(guard: Mapping[str, Any]) -> Case:
    """The guard of one topic, as the list `guard` of a report in JSON has it.

    That it lost is a failure.
    """
    counts = guard.get("counts") or {
        each.value: len(guard[each.value]) for each in Action
    }
    did = actions_text({each: counts[each.value] for each in Action})
    lost = [*map(_loss_text, guard[Action.LOST.value])]
    details = "".join(f"{printable(each)}\n" for each in (*lost, did))
    element, kind = ("failure", "lost") if counts[Action.LOST.value] else (None, "kept")
    return Case(f"guard of {guard['out']}", element, kind, (lost or [did])[0], details)


def _loss_text(entry: Mapping[str, Any]) -> str:
    at = f" at +{entry['offset']} s" if "offset" in entry else ""
    return f"lost{at}: {entry['reason']}"


def _case_text(suite: str, case: Case) -> str:
    head = f"classname={_attribute(suite)} name={_attribute(case.name)}"
    if case.file:
        head += f' file={_attribute(case.file)} line="{case.line}"'
    if case.time is not None:
        head += f' time="{seconds_text(case.time)}"'
    message = escape(printable(case.message), quote=False)
    body = f"<system-out>{message}</system-out>"
    if case.element is not None:
        kind = f'message={_attribute(case.message)} type="{case.kind}"'
        details = escape(case.details, quote=False)
        body = f"<{case.element} {kind}>{details}</{case.element}>"
    if properties := _properties_text(stated(case.requirement), "    "):
        body = f"\n{properties}    {body}\n  "
    return f"  <testcase {head}>{body}</testcase>\n"


def _properties_text(properties: Iterable[Pair], indent: str) -> str:
    """The properties as an element of XML; nothing if there are none."""
    told = "".join(
        f"{indent}  <property name={_attribute(name)} value={_attribute(value)}/>\n"
        for name, value in properties
    )
    return f"{indent}<properties>\n{told}{indent}</properties>\n" if told else ""


_FAILURES = (Verdict.VIOLATED, Verdict.PRESUMABLY_VIOLATED)


def _case(session: Session, track: Track) -> Case:
    message = sentence(session, track)
    is_violated = track.verdict is Verdict.VIOLATED
    details = figure(session, track) if is_violated else f"{printable(message)}\n"
    element = case_element(track.verdict, has_lost=_misses(session, track))
    of, zero, decided = track.property, session.beginning, track.decided_at
    end = session.time if decided is None else decided.time
    return Case(
        of.label,
        element,
        track.verdict.value,
        message,
        details,
        of.file,
        of.line,
        None if zero is None or end is None else end - zero,
        of.requirement,
    )


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
