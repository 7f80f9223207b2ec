"""What a notebook shows of results, as HTML that stands by itself in a cell; all text is escaped."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from hashlib import sha256
from html import escape
from typing import TYPE_CHECKING

from ltlc.analysis.comparison.forms import as_fragment
from ltlc.analysis.comparison.tables import VERDICTS, Table
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.render.full import printable
from ltlc.base.render.table import example_lines
from ltlc.compiler import Compiled
from ltlc.interfaces.pages.machines import machine_picture
from ltlc.monitoring.judging.run import RunReport
from ltlc.runtime import reports
from ltlc.runtime.session import Session
from ltlc.runtime.times import Scale
from ltlc.runtime.tracking import Track
from ltlc.semantics.verdicts import Verdict

if TYPE_CHECKING:
    from ltlc.interfaces.api.check import PropertyCheck


def check_html(properties: Sequence[PropertyCheck], diagnostics: Sequence[Diagnostic]) -> str:
    """Findings with the runs that show them, and what each property can do."""
    findings = Table(("", "code", "at", "finding", "help"), tuple(map(_finding, diagnostics)))
    examples = ((f"{each.code}: {each.message}", _example(each)) for each in diagnostics if each.example)
    rows = tuple((printable(each.label), printable(each.text), each.summary) for each in properties)
    found = as_fragment([findings]) if diagnostics else "<p>No problems found.</p>\n"
    can = as_fragment([Table(("property", "text", "verdicts it can give"), rows)]) if rows else ""
    return found + _folded(examples) + can


def _finding(each: Diagnostic) -> tuple[str, ...]:
    place = None if each.primary is None else each.source.position(each.primary.span.start)
    at = f"{place.line}:{place.column}" if place else ""
    return each.severity.value, each.code, at, printable(each.message), printable(each.help)


def _example(each: Diagnostic) -> str:
    return "\n".join(map(printable, example_lines(each.example or {})))


def run_html(report: RunReport, page: str = "") -> str:
    """Verdicts with failing states, and below them the `page` about the run, in a frame that nothing leaves."""
    session = report.session
    assert session is not None
    head = ("property", "verdict", "at", "details")
    table = Table(head, tuple(_verdict(session, track) for track in session.tracks))
    violated = [track for track in session.tracks if track.verdict is Verdict.VIOLATED]
    figures = ((f"The failing state of {printable(t.property.label)}", reports.figure(session, t)) for t in violated)
    return as_fragment([table]) + _folded(figures) + (_frame(page) if page else "")


def _verdict(session: Session, track: Track) -> tuple[str, ...]:
    at = "" if track.decided_at is None else reports.moment_text(track.decided_at, session.scale)
    remarks = "; ".join(reports.explanation(session, track))
    return printable(track.property.label), VERDICTS[track.verdict], at, remarks


_ON_LOAD = """const frame = this;
window.addEventListener("message", (event) => {
  if (event.source === frame.contentWindow && event.data > 0) frame.style.height = `${event.data}px`;
});
const scrolled = () => frame.contentWindow?.postMessage("scrolled", "*");
window.addEventListener("scroll", scrolled, { capture: true, passive: true });
frame.contentWindow.postMessage("height", "*");
"""
"""What the notebook does for a frame, with `frame.js` in it; where scripts are off, the frame keeps its height."""


def _frame(page: str) -> str:
    style = "box-sizing: content-box; width: calc(100% - 2px); height: 40em; border: 1px solid #8888; resize: vertical"
    return (
        f'<iframe sandbox="allow-scripts" title="verdicts over the signals" style="{style}" '
        f'onload="{escape(_ON_LOAD)}" srcdoc="{escape(page)}"></iframe>\n'
    )


def build_html(judgements: Mapping[str, str], compiled: Sequence[Compiled]) -> str:
    """The gate's result for each property, and its monitor as a picture."""
    rows = tuple((printable(label), told) for label, told in judgements.items())
    return as_fragment([Table(("property", "monitor"), rows)]) + "".join(map(_picture, compiled))


def _picture(compiled: Compiled) -> str:
    """The monitor of a property, and what the letters in its labels stand for."""
    label = printable(compiled.specification.label)
    name = f"monitor-{sha256(repr((label, compiled.formula)).encode()).hexdigest()[:12]}"
    picture = machine_picture(compiled, None, Scale(), name)
    letters = as_fragment([Table(("", "condition"), picture.letters)]) if picture.letters else ""
    remark = f"<p>{escape(picture.remark)}</p>\n" if picture.remark else ""
    return f"<figure><figcaption><b>{escape(label)}</b></figcaption>{picture.svg}{remark}{letters}</figure>\n"


def _folded(texts: Iterable[tuple[str, str]]) -> str:
    """Texts as they are, each under a line that shows it."""
    return "".join(
        f"<details><summary>{escape(printable(summary))}</summary><pre>{escape(text)}</pre></details>\n"
        for summary, text in texts
    )
