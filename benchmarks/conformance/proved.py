"""The judge that is extracted from Coq, asked whether each verdict of a case is right from its time on.

From the letters of the run, which ltlc computes, and a certificate of the property, which the judge checks first. A
claim is about the run up to a moment: of a permanent verdict, that it is right from then on for every continuation, and
was not known a nanosecond before; of another, that it is the verdict at each step, where it begins and where it ends.
"""

from __future__ import annotations

import subprocess
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.conformance.cases import Case
from benchmarks.conformance.ways import monitors
from benchmarks.differential import targets
from benchmarks.differential.compare import PERMANENT
from ltlc.assurance.evidence.certified import certificates
from ltlc.assurance.evidence.conditions import NotCoveredError, stated_atoms, stated_counts
from ltlc.assurance.evidence.document import Claim, Document, Head, StatedAtom, StatedCount, Summed, digest, printed
from ltlc.base.provenance import FileDigest
from ltlc.inputs.recordings.blocks import blocks_of
from ltlc.inputs.recordings.rows import Row as Cells
from ltlc.monitoring.columns.session import ByBlocks
from ltlc.monitoring.later import JudgedTrack
from ltlc.monitoring.letters import Letters
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Session
from ltlc.semantics.verdicts import Verdict

JUDGE = Path(__file__).parents[2] / "proofs" / "checker" / "judge"
UNREADABLE = 2
"""Its exit code where it cannot read the certificate."""


@dataclass(frozen=True)
class Stated:
    """The claims of a case, and the certificate that they rest on; or why there are none."""

    case: Case
    certificate: str = ""
    claims: tuple[Claim, ...] = ()
    reason: str = ""


@lru_cache(8)
def _certified(text: str) -> tuple[str, tuple[StatedAtom, ...], tuple[StatedCount, ...], str]:
    """The certificate of a property, its atoms, and what it counts; or why there is none."""
    [of] = monitors(text).compiled
    try:
        atoms = stated_atoms(of.specification, of.encoding)
    except NotCoveredError as error:
        return "", (), (), str(error)
    certificate, reasons = certificates([of], targets.BUDGET)
    return certificate, atoms, stated_counts(of.specification), reasons.get("p", "")


def stated(case: Case) -> Stated:
    """What is claimed of a case: that each of its verdicts is right, from its time up to the next."""
    if not case.expected.changes:
        return Stated(case, reason="it does not start")
    if case.sentence.startswith("each "):
        return Stated(case, reason="it is judged for each id or message")
    certificate, atoms, counts, reason = _certified(case.text)
    if reason:
        return Stated(case, reason=reason)
    began, letters = _letters(case)
    if letters.are_ages_apart:
        return Stated(case, reason="its ages count from different messages before its first step")
    if isinstance(letters.lines, Summed):
        return Stated(case, reason="its letters are too long")
    claims = []
    for moment in _moments(case):
        if isinstance(scopes := letters.scopes(moment), str):
            return Stated(case, reason=scopes)
        known = tuple(line for line in letters.lines if line.time <= moment)
        verdict = Verdict(case.expected.at(moment))
        session = began if letters.session is None else letters.session
        claim = Claim("p", case.sentence, atoms, session, known, moment, verdict, moment, counts=counts, scopes=scopes)
        claims.append(claim)
    return Stated(case, certificate, tuple(claims))


def _letters(case: Case) -> tuple[int, Letters]:
    """When the session of a case begins, and the letters of its property."""
    of = monitors(case.text)
    [specification] = (each.specification for each in of.compiled)
    letters = Letters(specification, of.specification.rate is not None)
    session = Session(of.judge.plan(()), False, None, lambda p, keep, see: JudgedTrack(p, keep, see, False, letters))
    blocks = ByBlocks(session, of.judge.prepared)
    for block in blocks_of([Cells(row.time, of.cells(row)) for row in case.recording.rows], of.columns):
        blocks.take(block)
        letters.settle(None)
    ByRows(blocks.session).advance(case.recording.end)
    letters.settle(None, is_over=True)
    assert session.began is not None
    return session.began, letters


def _moments(case: Case) -> list[int]:
    """Where verdicts begin and end, the steps, and the end; a permanent verdict is decided once."""
    changes, end = case.expected.changes, case.recording.end
    if changes[-1][1] in PERMANENT:
        end = changes[-1][0]
    found = {*(time for time, _ in changes), *(time - 1 for time, _ in changes[1:]), *case.expected.steps, end}
    return sorted(moment for moment in found if changes[0][0] <= moment <= end)


def proof(case: Case, judge: Path = JUDGE) -> tuple[bool, list[str]]:
    """Whether the judge accepts all that is claimed of a case; and what it refuses.

    Nothing is refused where nothing is claimed, or where it cannot read the certificate.
    """
    of = stated(case)
    if not of.claims:
        return False, []
    file = FileDigest("run.csv", 1, "0" * 64)
    head = Head("1", ("props.txt", digest(case.text)), digest(of.certificate), (file,))
    with TemporaryDirectory() as folder:
        certificate, evidence = Path(folder) / "certificates", Path(folder) / "evidence"
        certificate.write_text(of.certificate)
        evidence.write_text("".join(printed(Document(head, (claim,))) for claim in of.claims))
        done = subprocess.run([judge, certificate, evidence], capture_output=True, text=True, check=False)
    if done.returncode == UNREADABLE:
        return False, []
    said = [line for line in done.stdout.splitlines() if not line.startswith("evidence of ")]
    if len(said) != len(of.claims):
        return False, [f"{len(of.claims)} claims, but {len(said)} answers"]
    refused = [line for line in said if not line.endswith(", as claimed")]
    return not refused, refused
