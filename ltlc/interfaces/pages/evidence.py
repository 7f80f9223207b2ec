"""What an assessor reads, and what prints: evidence, requirement by requirement, and what each check has shown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ltlc.assurance.evidence.document import Claim, Document, NotCovered, Summed
from ltlc.assurance.evidence.outcomes import Check, CheckedClaim
from ltlc.assurance.evidence.statement import Result, State
from ltlc.assurance.evidence.words import atoms_in_words, settings_in_words
from ltlc.base.provenance import FileDigest
from ltlc.monitoring.documents import document
from ltlc.runtime.times import seconds_text
from ltlc.semantics.verdicts import Verdict

SAYS = {
    Verdict.VIOLATED: "Violated: whatever had come after, the property could not have held any more",
    Verdict.SATISFIED: "Satisfied: whatever had come after, the property would have held",
    Verdict.PRESUMABLY_SATISFIED: "Holds on the whole recording; later it could still have been violated",
    Verdict.PRESUMABLY_VIOLATED: "Not fulfilled at the end of the recording: something was still owed",
    Verdict.NOT_STARTED: "Not judged: something that it reads never had a value",
}
"""What a verdict means for a recording."""

_CLAIMED = {"accepted": "", "unchecked": "Claimed, but not checked whole: ", "refused": "NOT shown, but claimed: "}
"""What stands before a verdict."""

CHECKED = {
    "recorded": "from the recording to the letters",
    "judge": "from the letters to the verdict",
    "specification": "from the specification to what the letters are",
}
"""What each check is about."""


def page(
    evidence: FileDigest,
    results: Sequence[Result],
    state: State,
    requirements: Mapping[str, str],
    english: Mapping[str, str],
) -> str:
    """The page about a file of evidence in this `state`; texts of requirements, and what properties mean, by labels."""
    recordings = [
        _recording(document, found, requirements, english, f"recording-{number}")
        for number, (document, found) in enumerate(results)
    ]
    head = results[0][0].head
    return document(
        __package__,
        "evidence.html.jinja",
        evidence=evidence,
        specification=head.specification,
        certificates=head.certificates,
        version=head.version,
        recordings=recordings,
        state=state.value,
    )


def _recording(
    document: Document,
    found: Sequence[CheckedClaim],
    requirements: Mapping[str, str],
    english: Mapping[str, str],
    id_: str,
) -> dict[str, Any]:
    """What is shown of the evidence of one recording."""
    return {
        "name": document.head.recording,
        "files": document.head.recordings,
        "settings": list(settings_in_words(document.head)),
        "claims": [
            {
                "id": f"{id_}-{number}",
                "requirement": requirements.get(each.of.label, ""),
                "english": english.get(each.of.label, ""),
                **_claim(each.of, each),
            }
            for number, each in enumerate(found)
            if isinstance(each.of, Claim)
        ],
        "not_covered": [each.of for each in found if isinstance(each.of, NotCovered)],
    }


def _claim(claim: Claim, found: CheckedClaim) -> dict[str, Any]:
    state = "refused" if found.is_refused else "accepted" if found.is_accepted else "unchecked"
    return {
        "claim": claim,
        "says": f"{_CLAIMED[state]}{SAYS[claim.verdict]}, at {seconds_text(claim.decided)} s of the recording's clock",
        "colour": claim.verdict.value if state == "accepted" else state,
        "atoms": list(atoms_in_words(claim)),
        "lines": _lines(claim) if claim.key is None else f"letters of {len(claim.slices)} ids, each with its verdict",
        "state": state,
        "checks": [_check(each) for each in found.checks],
    }


def _lines(claim: Claim) -> str:
    is_summed = isinstance(claim.letters, Summed)
    lines = claim.letters.count if isinstance(claim.letters, Summed) else len(claim.letters)
    return f"{lines} {'line' if lines == 1 else 'lines'} of letters{', as their SHA-256' * is_summed}"


def _check(check: Check) -> dict[str, str]:
    state = "unchecked" if not check.was_done else "accepted" if check.refusal is None else "refused"
    return {"what": CHECKED[check.what], "by": check.by, "state": state, "says": check.refusal or check.shown}
