"""Evidence by all three checks: the judge, the reader of the recording, and the comparison with the specification."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from ltlc.assurance.evidence.claims import refusal, refusal_of_all
from ltlc.assurance.evidence.document import Claim, Document, Summed, summed
from ltlc.assurance.evidence.outcomes import Check, CheckedClaim
from ltlc.assurance.evidence.reader import NOT_COVERED, REFUSED, Read
from ltlc.assurance.evidence.seam import difference
from ltlc.semantics.certificate_text import Entry
from ltlc.specification.specification import Specification

JUDGE, RECORDED, SEAM = "judge.py", "recorded.py", "seam.py"
"""Which programs check."""


def checked(
    document: Document, specification: Specification, entries: Mapping[str, Entry], read: Read | None
) -> tuple[CheckedClaim, ...]:
    """What the checks find of each property of `document`, by the certificates that are accepted, by label.

    `read` is what the reader found, None if it was given no recording.
    """
    said = iter(() if read is None else read.said)
    filled: Sequence[object] = (document if read is None else read.filled).properties
    return tuple(
        CheckedClaim(claim, tuple(_checks(claim, with_letters, specification, entries, next(said, None))))
        if isinstance(claim, Claim) and isinstance(with_letters, Claim)
        else CheckedClaim(claim)
        for claim, with_letters in zip(document.properties, filled, strict=True)
    )


def _checks(
    claim: Claim, filled: Claim, specification: Specification, entries: Mapping[str, Entry], said: str | None
) -> Iterator[Check]:
    yield _judged(claim, filled, entries.get(claim.label))
    yield _read(said)
    yield Check(
        "specification", SEAM, difference(claim, specification), shown="its text, requirement and atoms are the same"
    )


def _judged(claim: Claim, filled: Claim, entry: Entry | None) -> Check:
    """What the judge finds by an accepted certificate; the letters are in `filled`, if only their digest is stated."""
    if entry is None:
        return Check("judge", JUDGE, "no certificate of it is accepted")
    if claim.key is not None:
        return _judged_slices(claim, filled, entry)
    lines = filled.letters
    if isinstance(lines, Summed):
        return Check("judge", JUDGE, "only the digest of its letters is stated, and they were not computed", False)
    if replace(filled, letters=claim.letters) != claim or claim.letters not in (lines, summed(lines)):
        return Check("judge", JUDGE, "the letters that were computed are not those of its digest")
    return Check("judge", JUDGE, refusal(claim, lines, entry), shown=_shown(claim, len(lines)))


def _judged_slices(claim: Claim, filled: Claim, entry: Entry) -> Check:
    """What the judge finds of each slice, and of all together."""
    if [each.id for each in filled.slices] != [each.id for each in claim.slices]:
        return Check("judge", JUDGE, "the letters that were computed are those of other ids")
    for each, computed in zip(claim.slices, filled.slices, strict=True):
        found = _judged(claim.of_slice(each), filled.of_slice(computed), entry)
        if found.refusal is not None:
            return found._replace(refusal=f"slice {each.id}: {found.refusal}")
    shown = (
        f"each of the {len(claim.slices)} slices has its verdict (evidence_of_lines); that of the whole is the worst"
    )
    return Check("judge", JUDGE, refusal_of_all(claim), shown=shown)


def _shown(claim: Claim, lines: int) -> str:
    has = {0: "no lines have", 1: "the line has"}.get(lines, f"the {lines} lines have")
    return f"{has} this verdict ({'evidence_of_lines' if claim.opens is None else 'evidence_of_instances'})"


def _read(said: str | None) -> Check:
    if said is None:
        return Check("recorded", RECORDED, "no recording of its name was given", was_done=False)
    for mark in (REFUSED, NOT_COVERED):
        if said.startswith(mark):
            return Check("recorded", RECORDED, said.removeprefix(mark), was_done=mark == REFUSED)
    return Check("recorded", RECORDED, None, shown=said)
