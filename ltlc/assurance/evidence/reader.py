"""`recorded.py` as a process of its own: what it finds of each claim, and the letters that it has computed."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from ltlc.assurance.evidence.document import Claim, Document, printed
from ltlc.assurance.evidence.parsing import UnreadableEvidence, parsed
from ltlc.dataclass import dataclass

READER = Path(__file__).with_name("recorded.py")
REFUSED, NOT_COVERED = "REFUSED: ", "NOT COVERED: "
"""How it says that something is not as written, and that it cannot check something."""


@dataclass(frozen=True, slots=True)
class Read:
    """What the reader says of each claim of a document, in their order; and the document with all letters.

    `refusal` is why the recording as a whole is not the one of the document, if it is not.
    """

    said: tuple[str, ...]
    filled: Document
    refusal: str | None = None


class NotReadError(Exception):
    """The reader could not be run to its end, for a reason."""


def recordings_of(document: Document, recordings: Iterable[Path]) -> list[Path]:
    """Those `recordings` that may be the one of `document`, by their names: the reader compares their digests."""
    names = {file.name.partition("/")[0] for file in document.head.recordings}
    return [path for path in recordings if path.resolve().name in names]


def read(document: Document, recordings: Sequence[Path]) -> Read:
    """What the reader finds of a document in the one of `recordings` that has its digests. Raises NotReadError."""
    with TemporaryDirectory() as folder:
        evidence, filled = Path(folder) / "evidence", Path(folder) / "filled"
        evidence.write_text(printed(document), encoding="utf-8", newline="\n")
        command = [sys.executable, "-I", str(READER), str(evidence), *map(str, recordings), "--fill", str(filled)]
        run = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", check=False)
        if run.stderr or not filled.exists():
            raise NotReadError((run.stderr or run.stdout).strip().rpartition("\n")[2].removeprefix("recorded.py: "))
        found = parsed(filled.read_text(encoding="utf-8"))
    if isinstance(found, UnreadableEvidence):
        raise NotReadError(f"line {found.line} of what it wrote: {found.message}")
    lines = run.stdout.splitlines()
    last = lines[-1] if lines else ""
    return Read(_said(lines, document), found, last.removeprefix(REFUSED) if last.startswith(REFUSED) else None)


def _said(lines: Sequence[str], document: Document) -> tuple[str, ...]:
    """What is said of each claim. What is said of the whole recording comes last, and is said of all of them."""
    claims = [each for each in document.properties if isinstance(each, Claim)]
    if lines and lines[-1].startswith((REFUSED, NOT_COVERED)):
        return (lines[-1],) * len(claims)
    found = lines[len(document.properties) - len(claims) :]
    pairs = zip(found, claims, strict=True)
    return tuple(line.removeprefix(f"{claim.label}: ") for line, claim in pairs)
