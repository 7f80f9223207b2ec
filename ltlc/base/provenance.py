"""What a document was made of: version and commit of ltlc, and SHA-256 of the specification and the recording.

Everything in it follows from the inputs: it has no date, and no paths but those that the user gave.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import Any

from ltlc import __version__
from ltlc.base.revision import commit_text
from ltlc.base.source import Source
from ltlc.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class FileDigest:
    """A file by its name, its size in bytes, and its SHA-256 in hexadecimal digits."""

    name: str
    bytes: int
    sha256: str


def digest_of(path: Path, name: str) -> FileDigest:
    """The file at `path`, called `name`. Raises OSError."""
    from hashlib import file_digest  # takes time, and few commands ask

    with path.open("rb") as file:
        found = file_digest(file, "sha256").hexdigest()
        return FileDigest(name, file.tell(), found)


def provenance(specifications: Iterable[Source], recordings: Iterable[FileDigest] = ()) -> dict[str, Any]:
    """The object `provenance` of a JSON document; `commit` is null where it is not known."""
    return {
        "ltlc": __version__,
        "commit": _commit() or None,
        "specifications": [{"name": each.name, "sha256": each.sha256} for each in specifications],
        "recordings": [asdict(each) for each in recordings],
    }


@cache
def _commit() -> str:
    return commit_text()
