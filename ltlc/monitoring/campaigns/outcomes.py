"""What a recording has shown, as data: it goes from process to process, into a table and out of it again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from ltlc.assurance.evidence.document import digest, printed
from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.source import Source
from ltlc.dataclass import dataclass
from ltlc.monitoring.campaigns.places import Location
from ltlc.monitoring.judging.run import RunReport
from ltlc.runtime import reports
from ltlc.runtime.guarding import Action
from ltlc.semantics.verdicts import Verdict


@dataclass(frozen=True, slots=True)
class PropertyOutcome:
    """What a recording has shown of a property: its JSON object, its line, and if it is violated the error message."""

    report: Mapping[str, Any]
    sentence: str
    figure: str = ""

    @property
    def label(self) -> str:
        """What the property is called."""
        return str(self.report["label"])

    @property
    def verdict(self) -> Verdict:
        """The verdict at the end of the recording."""
        return Verdict(self.report["verdict"])


@dataclass(frozen=True, slots=True)
class Outcome:
    """What the recording at `place` has shown.

    `report` is its JSON document, in which `properties` is null if nothing could be judged, and otherwise empty.
    `remarks` are lines about the whole recording; `diagnostics` are reported, and are not kept in tables, nor is the
    `evidence`, which is empty if there is none.
    It took `seconds`, and as many `tries`.
    """

    place: Location
    report: Mapping[str, Any]
    properties: tuple[PropertyOutcome, ...] = ()
    remarks: tuple[str, ...] = ()
    diagnostics: tuple[Diagnostic, ...] = ()
    seconds: float = 0.0
    tries: int = 1
    evidence: str = ""

    @property
    def is_judged(self) -> bool:
        """Whether there are verdicts, be it up to the damage only."""
        return self.report["properties"] is not None

    @property
    def error(self) -> Mapping[str, Any] | None:
        """What kept the recording from being judged whole, as an object of JSON; None if nothing did."""
        if self.is_judged and not self.report["is_damaged"]:
            return None
        last: Mapping[str, Any] = self.report["diagnostics"][-1]
        return last

    @property
    def extracts(self) -> list[Mapping[str, Any]]:
        """What was written around violations, as objects of JSON."""
        return [each for of_one in self.properties for each in of_one.report.get("extracts", ())]

    @property
    def not_cut(self) -> str:
        """Why not all extracts that were asked for could be written; empty if they were."""
        return str((self.report.get("cut") or {}).get("error") or "")

    @property
    def guards(self) -> Mapping[str, Mapping[Action, int]]:
        """How often each guard did what, by the topic on which it sends; none if it was not asked for."""
        guards = self.report.get("guard", ())
        return {each["out"]: {action: len(each[action.value]) for action in Action} for each in guards}

    @property
    def exit_code(self) -> int:
        """That of `ltlc run` on this recording alone."""
        if self.error is not None or self.not_cut:
            return 2
        if any(counts[Action.LOST] for counts in self.guards.values()):
            return 1
        left_out = any("each" in each.report and each.report["each"]["left_out"] for each in self.properties)
        return reports.exit_code([each.verdict for each in self.properties], left_out)

    def document(self) -> dict[str, Any]:
        """The JSON document of `ltlc run` on this recording alone."""
        properties = [dict(each.report) for each in self.properties] if self.is_judged else None
        return {**self.report, "properties": properties}


def of_report(place: Location, found: RunReport, seconds: float) -> Outcome:
    """The outcome of `found`, the report on the recording at `place` or a copy of it."""
    document = found.document()
    document["recording"] = place.name
    for told in document["diagnostics"]:
        told["message"] = told["message"].replace(found.recording, place.name)
    tracks = found.session.tracks if found.session is not None else ()
    properties = tuple(
        PropertyOutcome(
            report,
            reports.sentence(found.session, track),
            reports.figure(found.session, track) if track.verdict is Verdict.VIOLATED else "",
        )
        for report, track in zip(document["properties"] or (), tracks, strict=True)
        if found.session is not None
    )
    remarks = () if found.session is None else tuple(reports.unseen(found.session))
    if found.session is not None:
        document["properties"] = []
    diagnostics = tuple(_renamed(each, found.recording, place.name) for each in found.diagnostics)
    evidence = "" if found.evidence is None else printed(found.evidence)
    if evidence:
        document["evidence"] = digest(evidence)
    return Outcome(place, document, properties, remarks, diagnostics, seconds, evidence=evidence)


def _renamed(told: Diagnostic, name: str, to: str) -> Diagnostic:
    """A diagnostic that calls the recording as its user does."""
    if name == to:
        return told
    source = Source(to, "") if told.source.name == name else told.source
    return replace(told, source=source, message=told.message.replace(name, to))


def not_judged(place: Location, told: Diagnostic) -> Outcome:
    """The outcome of a recording with nothing but the error `told`."""
    return of_report(place, RunReport(place.name, None, (told,)), 0.0)


def lost(place: Location, reason: str, tries: int) -> Outcome:
    """That of a recording that no process has judged to its end, after so many `tries`."""
    message = f"`{place.name}` was not judged: {reason}, {tries} times"
    help = "out of memory? `--jobs 1` judges one recording at a time"
    told = diagnostic("LTL832", Source(place.name, ""), None, message, help=help)
    return replace(not_judged(place, told), tries=tries)
