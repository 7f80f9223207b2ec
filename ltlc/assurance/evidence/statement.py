"""Evidence that all checks accept, as a statement that can be signed: in-toto Statement v1, predicate test-result v0.1.

Properties are its tests; the field `ltlc` of the predicate, which other readers pass over, has verdicts, times and
requirements, and which part of a recording was judged. There is no date in it: equal evidence gives equal bytes.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from enum import Enum
from hashlib import sha256
from pathlib import Path
from typing import Any

from ltlc.assurance.evidence.document import Claim, Document, NotCovered
from ltlc.assurance.evidence.outcomes import CheckedClaim
from ltlc.base.provenance import FileDigest

TYPE = "https://in-toto.io/Statement/v1"
PREDICATE = "https://in-toto.io/attestation/test-result/v0.1"


class State(Enum):
    """What the checks have found of a file of evidence."""

    ACCEPTED = "accepted"
    UNCHECKED = "unchecked"
    """None refuses it, but not all of it was checked."""
    REFUSED = "refused"


Result = tuple[Document, Sequence[CheckedClaim]]
"""The evidence of one recording, and what the checks have found of each property."""


def evidence_file(path: Path, content: bytes) -> FileDigest:
    """How a file of evidence is named."""
    return FileDigest(path.name, len(content), sha256(content).hexdigest())


def statements(evidence: FileDigest, results: Iterable[Result]) -> str:
    """A statement for each recording, one a line, as in-toto has bundles; all checks must have accepted all claims."""
    return "".join(
        f"{json.dumps(statement(evidence, *each), ensure_ascii=False, allow_nan=False)}\n" for each in results
    )


def statement(evidence: FileDigest, document: Document, checked: Sequence[CheckedClaim]) -> dict[str, Any]:
    """The statement about one recording. What is still owed, never began or is not covered has not passed."""
    head, of = document.head, [each.of for each in checked]
    claims = [each for each in of if isinstance(each, Claim)]
    passed = [claim.label for claim in claims if claim.verdict.holds]
    failed = [each.label for each in of if each.label not in passed]
    return {
        "_type": TYPE,
        "subject": [_descriptor(file.name, file.sha256) for file in head.recordings],
        "predicateType": PREDICATE,
        "predicate": {
            "result": "FAILED" if failed else "PASSED",
            "configuration": [
                _descriptor(*head.specification),
                _descriptor("certificates", head.certificates),
                _descriptor(evidence.name, evidence.sha256),
            ],
            "passedTests": passed,
            "warnedTests": [],
            "failedTests": failed,
            "ltlc": {
                "version": head.version,
                "from_ns": head.since,
                "to_ns": head.until,
                "stamp": "header" if head.is_by_header else "log",
                "properties": [_property(claim) for claim in claims],
                "not_covered": [
                    {"property": each.label, "reason": each.reason} for each in of if isinstance(each, NotCovered)
                ],
            },
        },
    }


def _descriptor(name: str, digest: str) -> dict[str, Any]:
    return {"name": name, "digest": {"sha256": digest}}


def _property(claim: Claim) -> dict[str, Any]:
    return {
        "property": claim.label,
        "text": claim.text,
        "requirement": claim.requirement,
        "verifies": list(claim.verifies),
        "verdict": claim.verdict.value,
        "decided_ns": claim.decided,
        "until_ns": claim.until,
    }
