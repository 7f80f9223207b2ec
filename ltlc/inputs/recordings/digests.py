"""Which files a recording consists of, and their SHA-256."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from ltlc.base.provenance import FileDigest, digest_of
from ltlc.inputs.recordings.bags.folders import METADATA, is_bag


def files_of(path: Path) -> Iterator[tuple[str, Path]]:
    """The files of the recording at `path`, each with its name: of a folder, all bags in it and its metadata."""
    if not path.is_dir():
        yield path.name, path
        return
    for each in sorted(path.iterdir()):
        if each.is_file() and (each.name == METADATA or is_bag(each)):
            yield f"{path.resolve().name}/{each.name}", each


def digests(path: Path) -> tuple[FileDigest, ...]:
    """The files of the recording at `path`; none if one of them cannot be read."""
    try:
        return tuple(digest_of(each, name) for name, each in files_of(path))
    except OSError:
        return ()
