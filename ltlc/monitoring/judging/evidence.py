"""Evidence of a recording: the part common to all recordings is prepared once, the rest as each is judged."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path, PurePath
from threading import Thread
from typing import NamedTuple

from ltlc.assurance.evidence.conditions import (
    NotCoveredError,
    opening_atom,
    stated_atoms,
    stated_counts,
    stated_key,
    stated_signals,
    whole_run,
)
from ltlc.assurance.evidence.definitions import digests
from ltlc.assurance.evidence.document import Claim, Document, Head, NotCovered, StatedAtom, StatedSignal, digest
from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.limits import Budget
from ltlc.base.provenance import FileDigest, digest_of
from ltlc.base.revision import version_text
from ltlc.base.source import Source
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.inputs.recordings import Recording
from ltlc.inputs.recordings.bags import BagRecording
from ltlc.inputs.recordings.bags.plan import absolute
from ltlc.inputs.recordings.digests import files_of
from ltlc.inputs.recordings.lacks import signals_of
from ltlc.inputs.recordings.reading import ReadOptions, Stamp
from ltlc.monitoring.judging.part import Part
from ltlc.monitoring.judging.whole_runs import WholeRuns
from ltlc.monitoring.later import JudgedTrack
from ltlc.monitoring.letters import Letters
from ltlc.runtime.session import Session
from ltlc.semantics.durations import Nanoseconds
from ltlc.specification.specification import Instances, PropertySpecification, Specification, fields


class Kept(NamedTuple):
    """What was kept of a run: letters by the labels of properties, and those of `whole` runs."""

    letters: Mapping[str, Letters]
    whole: WholeRuns | None


@dataclass(frozen=True)
class Evidence:
    """The part common to all recordings that `properties` judge: by their labels, their atoms or why not.

    `signals` are what the columns of a table may be, or why that cannot be said.
    `version` is that of ltlc. `specification` is the name of the file and its digest, `certificates` a digest.
    """

    version: str
    specification: tuple[str, str]
    certificates: str
    properties: Sequence[PropertySpecification]
    stated: Mapping[str, tuple[StatedAtom, ...] | str]
    signals: tuple[StatedSignal, ...] | str
    rate: float | None
    timeout: Nanoseconds | None

    def letters(self, label: str) -> Letters | None:
        """Where the letters of a property are kept in a run; None if nothing is claimed of it, or of its instances."""
        [of] = (each for each in self.properties if each.label == label)
        return None if isinstance(self.stated[label], str) or of.slicing is not None else self.kept(of)

    def kept(self, of: PropertySpecification) -> Letters:
        """Where the letters of the run of a property are kept."""
        return Letters(of, self.rate is not None)

    def whole_runs(self, compiled: Iterable[Compiled]) -> list[Compiled]:
        """Those of the properties that are judged for ids or instances, to have the letters of all of them."""
        covered = [each for each in compiled if not isinstance(self.stated[each.specification.label], str)]
        return [
            replace(each, specification=whole_run(of, by)) if isinstance(by, Instances) else each
            for each in covered
            if (by := (of := each.specification).slicing) is not None
        ]

    def digests(self, path: Path) -> Digests:
        """Those of the files of a recording, which are computed while it is judged."""
        return Digests(path)

    def document(
        self,
        session: Session,
        kept: Kept,
        part: Part,
        recording: Recording,
        reading: ReadOptions,
        files: Iterable[FileDigest],
    ) -> Document:
        """The evidence of a run that has been judged, of a `part` of a recording with these `files`."""
        return _Judged(session, kept, part, recording, reading).document(self, files)

    def not_covered(self, document: Document, source: Source) -> Iterator[Diagnostic]:
        """A note for each property that `document` claims nothing of; `source` is the specification."""
        for each, of in zip(document.properties, self.properties, strict=True):
            if isinstance(each, NotCovered):
                message = f"the evidence does not cover `{each.label}`: {each.reason}"
                yield diagnostic("LTL851", source, of.span, message, help="its verdict is as without `--evidence`")


def evidence_by(compiled: Sequence[Compiled], specification: Specification, budget: Budget) -> Evidence:
    """The part of evidence common to all recordings; the certificate of each property may take that `budget`."""
    from ltlc.assurance.evidence.certified import certificates  # which imports what makes certificates

    text, reasons = certificates(compiled, budget)
    stated: dict[str, tuple[StatedAtom, ...] | str] = {}
    for each in compiled:
        label = each.specification.label
        try:
            stated[label] = stated_atoms(each.specification, each.encoding)
        except NotCoveredError as error:
            stated[label] = str(error)
        if label in reasons:
            stated[label] = f"it has no certificate: {reasons[label]}"
    return Evidence(
        version_text(),
        (PurePath(specification.source.name).name, specification.source.sha256),
        digest(text),
        tuple(each.specification for each in compiled),
        stated,
        _signals(tuple(each.specification for each in compiled)),
        specification.rate,
        specification.timeout,
    )


def _signals(properties: Sequence[PropertySpecification]) -> tuple[StatedSignal, ...] | str:
    """The signals that columns of a table may be, or why evidence of tables cannot say which."""
    try:
        return stated_signals(properties)
    except NotCoveredError as error:
        return str(error)


class Digests:
    """The digests of all files of a recording, which are computed while it is judged."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._files: tuple[FileDigest, ...] | OSError = ()
        self._thread = Thread(target=self._compute, daemon=True)
        self._thread.start()

    def _compute(self) -> None:
        try:
            self._files = tuple(digest_of(at, name) for name, at in files_of(self._path))
        except OSError as error:
            self._files = error

    def files(self) -> tuple[FileDigest, ...]:
        """The files, as soon as their digests are known. Raises OSError."""
        self._thread.join()
        if isinstance(self._files, OSError):
            raise self._files
        return self._files


@dataclass(frozen=True)
class _Judged:
    """A run that has been judged, of a `part` of a recording, read with these options."""

    session: Session
    kept: Kept
    part: Part
    recording: Recording
    reading: ReadOptions

    def document(self, evidence: Evidence, files: Iterable[FileDigest]) -> Document:
        """The evidence of it."""
        properties = tuple(self._properties(evidence))
        head = Head(
            evidence.version,
            evidence.specification,
            evidence.certificates,
            tuple(files),
            digests(self.recording.types) if isinstance(self.recording, BagRecording) else (),
            None if evidence.rate is None else repr(evidence.rate),
            evidence.timeout,
            self.reading.stamp is Stamp.HEADER,
            self.part.since,
            self.part.until,
            () if isinstance(self.recording, BagRecording) or isinstance(evidence.signals, str) else evidence.signals,
        )
        return Document(head, properties)

    def _properties(self, evidence: Evidence) -> Iterator[Claim | NotCovered]:
        found = [
            self._claim(evidence, of, track) for of, track in zip(evidence.properties, self.session.tracks, strict=True)
        ]
        depends_on_all = evidence.timeout is not None or self.reading.stamp is Stamp.HEADER
        if not depends_on_all or all(isinstance(each, Claim) for each in found):
            yield from found
            return
        why = "when the run begins and ends depends on all properties, and one of these is not covered"
        yield from (each if isinstance(each, NotCovered) else NotCovered(each.label, why) for each in found)

    def _claim(self, evidence: Evidence, of: PropertySpecification, track: object) -> Claim | NotCovered:
        stated = evidence.stated[of.label]
        if isinstance(stated, str):
            return NotCovered(of.label, stated)
        assert isinstance(track, JudgedTrack)
        began = self.session.began
        if began is None or self.session.time is None:
            return NotCovered(of.label, "the recording has no messages")
        if isinstance(self.recording, BagRecording) and self.recording.is_flight_log:
            return NotCovered(of.label, "the reader that shares nothing with ltlc does not read flight logs")
        if unread := self._unread(evidence, of):
            return NotCovered(of.label, unread)
        if track.slices is not None and track.slices.left_out:
            return NotCovered(of.label, "messages were ignored because of its limit")
        if began < 0:
            return NotCovered(of.label, "the recording has times before 0")
        end = min(self.session.time if self.part.until is None else self.part.until, self.session.end)
        until = end if track.decided_at is None else track.decided_at.time
        requirement = of.requirement
        claim = Claim(
            of.label,
            of.text,
            stated,
            began,
            (),
            until,
            track.verdict,
            until,
            None if requirement is None else requirement.id,
            () if requirement is None else tuple(requirement.attributes.get("verifies", ())),
            stated_counts(of),
            opens=opening_atom(of),
            key=stated_key(of),
        )
        return self._with_letters(claim) if claim.key is None else self._with_slices(claim, evidence, end)

    def _with_letters(self, claim: Claim) -> Claim | NotCovered:
        letters = self.kept.letters[claim.label]
        if letters.are_ages_apart:
            return NotCovered(claim.label, "its ages count from different messages before its first step")
        if (letters.first or 0) < 0:
            return NotCovered(claim.label, "the recording has times before 0")
        if isinstance(scopes := letters.scopes(claim.until), str):
            return NotCovered(claim.label, scopes)
        session = claim.session if letters.session is None else letters.session
        return replace(claim, session=session, letters=letters.lines, scopes=scopes)

    def _with_slices(self, claim: Claim, evidence: Evidence, end: Nanoseconds) -> Claim | NotCovered:
        assert self.kept.whole is not None
        whys = {
            "at ticks": evidence.rate is not None,
            "up to a timeout": evidence.timeout is not None,
            "over a table": not isinstance(self.recording, BagRecording),
        }
        for why in (why for why, is_so in whys.items() if is_so):
            return NotCovered(claim.label, f"it is judged for each id, {why}")
        slices = self.kept.whole.slices(claim.label, end)
        return NotCovered(claim.label, slices) if isinstance(slices, str) else replace(claim, slices=slices)

    def _unread(self, evidence: Evidence, of: PropertySpecification) -> str:
        """Why evidence cannot say what a property reads of the recording; empty if it can."""
        columns = self.recording.columns
        if not isinstance(self.recording, BagRecording):
            if isinstance(evidence.signals, str):
                return f"the recording is a table: {evidence.signals}"
            stated = {each.name for each in evidence.signals}
            other = next((name for name in signals_of([of]) if name in columns and name not in stated), None)
            return "" if other is None else f"the table has a column `{other}`, which is no field and no named signal"
        topics = {absolute(name) for name in self.recording.topics}
        for signal, field in (pair for each in of.signals() for pair in fields(each)):
            if field.topic in topics and signal.name not in columns:
                return f"`{signal.name}` is not read: {self.recording.absence(signal.name)}"
        return ""
