"""Which files a recording consists of, and their SHA-256."""

from __future__ import annotations

from pathlib import Path

from ltlc.base.provenance import FileDigest, digest_of
from ltlc.inputs.recordings.bags.folders import bag_at
from ltlc.inputs.recordings.rows import RecordingError


def digests(path: Path) -> tuple[FileDigest, ...]:
    """The files with messages of the recording at `path`, in their order; none if one of them cannot be read."""
    try:
        return tuple(map(digest_of, bag_at(path).files))
    except (OSError, RecordingError):
        return ()
