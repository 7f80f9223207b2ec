"""`ltlc certify --evidence`: whether recordings have the verdicts that evidence states, claim by claim."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from ltlc.assurance.afresh.files import UnusableError, text_at
from ltlc.assurance.evidence.checked import checked
from ltlc.assurance.evidence.document import Claim, Document, NotCovered
from ltlc.assurance.evidence.outcomes import Check, CheckedClaim
from ltlc.assurance.evidence.parsing import UnreadableEvidence, parsed_all
from ltlc.assurance.evidence.reader import NotReadError, Read, read, recordings_of
from ltlc.assurance.evidence.seam import differences
from ltlc.assurance.evidence.words import settings_in_words
from ltlc.interfaces.commands.common import FINDING, OK, UNDECIDED
from ltlc.interfaces.commands.progress import progress
from ltlc.semantics.certificate_text import Entry
from ltlc.semantics.durations import seconds_text
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.specification import Specification

MEANING = """\
judge: the verdict, and the time from which it is right, follow from the letters by the certificate of the property:
  theorem evidence_of_lines in proofs/Evidence.v; of `each new`, evidence_of_instances in proofs/Instances.v. It does
  not see the recording. Trusted: the statements of the theorems; which letters exist (`assuming`, above); judge.py, the
  judge extracted from Coq in Python. To run that one itself: proofs/checker/judge CERTIFICATES EVIDENCE. That no
  verdict comes late is what `certified, exactly` says.
recorded: the recording has these letters, if each atom is what it is stated to be as data. Trusted: recorded.py, which
  shares nothing with ltlc; numpy; rosbags. It takes values at openings where the judge finds that scopes opened.
specification: the properties, their requirements, and what each atom is, are those of the specification. Trusted: the
  front end of ltlc.
Not checked: that a property says what its requirement means, that the recording shows what happened, and why nothing
  is claimed of a property.
"""
"""What the checks show, and what they leave to trust."""


def documents_at(path: Path) -> tuple[Document, ...]:
    """The evidence in a file. Raises UnusableError."""
    found = parsed_all(text_at(path, "evidence"))
    if isinstance(found, UnreadableEvidence):
        raise UnusableError(f"{path}:{found.line}: {found.message}")
    return found


def check_evidence(
    documents: Sequence[Document],
    specification: Specification,
    certificates: tuple[str, Mapping[str, Entry]],
    recordings: Sequence[Path],
    quiet: bool,
) -> tuple[int, list[tuple[CheckedClaim, ...]]]:
    """Report on each claim what the checks have found; the exit code, and what was found of each document.

    `certificates` are their digest, and those that are accepted by their labels. Raises UnusableError.
    """
    found, code = [], OK
    for document in documents:
        objections = [*differences(document, specification)]
        if document.head.certificates != certificates[0]:
            objections.append(f"it names certificates with another SHA-256: {document.head.certificates}")
        read_ = _read(document, recordings, quiet)
        if read_ is not None and read_.refusal is not None and not read_.said:
            objections.append(read_.refusal)
        claims = checked(document, specification, certificates[1], read_)
        found.append(claims)
        print("\n".join(_report(document, objections, claims, quiet)))
        if objections or any(claim.is_refused for claim in claims):
            code = FINDING
        elif code == OK and (read_ is None or any(claim.checks and not claim.is_accepted for claim in claims)):
            code = UNDECIDED
    for path in _without_evidence(documents, recordings):
        print(f"there is no evidence of {path}")
        code = code or UNDECIDED
    if not quiet:
        print(f"\n{MEANING}", end="")
    return code, found


def _without_evidence(documents: Sequence[Document], recordings: Sequence[Path]) -> Iterator[Path]:
    of = {path for document in documents for path in recordings_of(document, recordings)}
    return (path for path in recordings if path not in of)


def _read(document: Document, recordings: Sequence[Path], quiet: bool) -> Read | None:
    """What the reader finds; None if no recording was given that it may be about."""
    paths = recordings_of(document, recordings)
    if not paths:
        return None
    with progress(f"reading {paths[0].name}", quiet):
        try:
            return read(document, paths)
        except NotReadError as error:
            raise UnusableError(f"{', '.join(map(str, paths))}: {error}") from None


def _report(
    document: Document, objections: Sequence[str], claims: Sequence[CheckedClaim], quiet: bool
) -> Iterator[str]:
    yield f"evidence of {document.head.recording}, by ltlc {document.head.version}"
    yield from (f"  {each}" for each in settings_in_words(document.head))
    yield from (f"  REFUSED: {each}" for each in objections)
    for claim in claims:
        yield f"{claim.of.label}: {_conclusion(claim, is_refused=bool(objections))}"
        if not (quiet and claim.is_accepted):
            yield from (f"  {check.what}: {_outcome(check)}" for check in claim.checks)


def _conclusion(claim: CheckedClaim, is_refused: bool) -> str:
    if isinstance(claim.of, NotCovered):
        return f"nothing is claimed: {claim.of.reason}"
    if is_refused or claim.is_refused:
        return f"NOT shown: {_stated(claim.of)}"
    return f"{'' if claim.is_accepted else 'not completely checked: '}{_stated(claim.of)}"


def _stated(claim: Claim) -> str:
    verdict, time = claim.verdict.value.replace("_", " "), f"{seconds_text(claim.decided)} s"
    if claim.verdict is Verdict.NOT_STARTED:
        return f"{verdict} up to {time}"
    return f"{verdict} from {time} on" if claim.verdict.is_permanent else f"{verdict} at {time}"


def _outcome(check: Check) -> str:
    if check.refusal is None:
        return check.shown
    return f"{'REFUSED' if check.was_done else 'not checked'}: {check.refusal}"
