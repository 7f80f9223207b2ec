"""The evidence of a campaign: the documents of its recordings one after the other, appended as results come."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from errno import EEXIST
from os import SEEK_END
from pathlib import Path
from typing import Self

from ltlc.assurance.evidence.document import HEADER, digest, printed
from ltlc.assurance.evidence.parsing import UnreadableEvidence, parsed
from ltlc.base.provenance import FileDigest
from ltlc.monitoring.campaigns.places import Location, is_address
from ltlc.monitoring.judging.evidence import Digests, Evidence

_FIRST = f"{HEADER}\n".encode()
"""How a bundle begins."""


class BundleError(Exception):
    """The file cannot be read or written, for the reason that `error` gives."""

    def __init__(self, error: OSError) -> None:
        super().__init__(str(error))
        self.error = error


class Bundle:
    """The file at `path`. What is there by the same `evidence` is kept where it is asked for again.

    What is added is in the order of the recordings, so that it is the same file however often a campaign was stopped;
    a document that was not written to its end is written again.
    """

    def __init__(self, path: Path, evidence: Evidence) -> None:
        self._path = path
        with _writing():
            self._before = path.read_bytes() if path.exists() else b""
            if not (self._before.startswith(_FIRST) or _FIRST.startswith(self._before)):
                raise FileExistsError(EEXIST, "another file is there that is not evidence")
            self._file = path.open("r+b" if path.exists() else "w+b", buffering=0)
        self._end = 0
        self._known = dict(_documents(self._before, evidence))
        self._of_place: dict[str, str] = {}
        self.lacking: list[str] = []

    def has(self, place: Location, sha256: object) -> bool:
        """Whether there is evidence of the recording at `place` as it is now, with the SHA-256 that it had."""
        if not self._known or is_address(place.name):
            return False
        try:
            files = Digests(Path(place.name)).files()
        except OSError:
            return False
        self._of_place[place.name] = text = self._known.get(files, "")
        return digest(text) == sha256

    def keep(self, place: Location) -> None:
        """Take over what there `has` been of the recording at `place`."""
        self.add(place, self._of_place[place.name])

    def add(self, place: Location, text: str) -> None:
        """Append the evidence of the recording at `place`, the next one; empty without evidence."""
        if not text:
            self.lacking.append(place.name)
            return
        data, end = text.encode(), self._end
        self._end += len(data)
        if self._before[end : self._end] == data:
            return
        with _writing():
            if self._before:
                self._before = b""
                self._file.truncate(end)
            self._file.seek(end)
            self._file.write(data)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        """What follows in the file is of recordings that are not judged any more, unless the campaign was stopped."""
        with _writing():
            if exception == (None, None, None) and self._file.seek(0, SEEK_END) > self._end:
                self._file.truncate(self._end)
            self._file.close()
            if not self._end and exception == (None, None, None):
                self._path.unlink()


@contextmanager
def _writing() -> Iterator[None]:
    """Raises BundleError for errors of the system."""
    try:
        yield
    except OSError as error:
        raise BundleError(error) from None


def _documents(data: bytes, evidence: Evidence) -> Iterator[tuple[tuple[FileDigest, ...], str]]:
    """The whole documents in a file that are by the same `evidence`, with the files that they are of."""
    first = f"{HEADER}\n"
    for part in data.decode("utf-8", errors="replace").split(first)[1:]:
        document = parsed(first + part)
        if isinstance(document, UnreadableEvidence):
            continue
        head = document.head
        made = (head.version, head.specification, head.certificates)
        if made == (evidence.version, evidence.specification, evidence.certificates):
            yield head.recordings, printed(document)
