"""Extracts of recordings as MCAP files: written where a recording is judged, reported as data."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field
from errno import EINVAL
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ltlc.base.files import written
from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.digests import files_of
from ltlc.inputs.recordings.rows import RecordingError
from ltlc.monitoring.judging.extracts import Extract, extracts
from ltlc.runtime.session import Session
from ltlc.runtime.times import seconds
from ltlc.semantics.durations import Nanoseconds

if TYPE_CHECKING:
    from ltlc.inputs.recordings.bags.copying import Copier

LONGEST = 100
"""So many characters of a recording's name are in that of its folder."""


@dataclass(frozen=True)
class Cut:
    """The extracts of a recording that were written, in the form of the JSON document, by the labels of properties.

    `settings` is what they were made by, in that form. `error` says why one could not be made; empty if all were.
    """

    settings: Mapping[str, Any]
    written: Mapping[str, Sequence[Mapping[str, Any]]]
    error: str = ""

    @property
    def extracts(self) -> list[Mapping[str, Any]]:
        """Those of all properties."""
        return [each for of_one in self.written.values() for each in of_one]

    def document(self) -> dict[str, Any]:
        """The object `cut` of the JSON document."""
        return {**self.settings, "error": self.error or None}


@dataclass(frozen=True)
class Cutting:
    """Cuts recordings: what was recorded from so long `before` a violation to so long `after` it, as files in `folder`.

    Each of several recordings has a folder in that, which `folders` have by its name. What databases lack is defined in
    `message_paths`.
    """

    folder: Path
    before: Nanoseconds
    after: Nanoseconds
    message_paths: tuple[str, ...] = ()
    folders: Mapping[str, str] = field(default_factory=dict)

    def folder_of(self, name: str) -> Path:
        """Where the extracts of the recording with this name are."""
        return self.folder / self.folders.get(name, "")

    def cut(self, session: Session, path: Path, name: str) -> Cut:
        """Write the extracts of the bag at `path`, the recording called `name`, which the session has judged."""
        found: dict[str, list[dict[str, Any]]] = {track.property.label: [] for track in session.tracks}
        parts, error = list(extracts(session, self.before, self.after)), ""
        if parts:
            from ltlc.inputs.recordings.bags.copying import Copier

            target = folder = self.folder_of(name)
            try:
                folder.mkdir(parents=True, exist_ok=True)
                with Copier(path, self.message_paths) as copier:
                    for each in parts:
                        target = folder / each.name
                        if any(target.exists() and target.samefile(file) for _, file in files_of(path)):
                            raise OSError(EINVAL, "it is the recording")
                        found[each.label].append(_written(copier, each, target))
            except RecordingError as of_recording:
                error = of_recording.diagnostic.message
            except OSError as of_file:
                error = f"{target} cannot be written: {of_file.strerror or of_file}"
        return Cut(self._settings(), found, error)

    def has(self, cut: Any, extracts: Iterable[Mapping[str, Any]]) -> bool:
        """Whether what was `cut` by the JSON document on a recording is what would be now, and the `extracts` exist."""
        return cut == Cut(self._settings(), {}).document() and all(os.path.isfile(each["file"]) for each in extracts)

    def _settings(self) -> dict[str, Any]:
        return {"folder": str(self.folder), "before_ns": self.before, "after_ns": self.after}


def folders_of(names: Iterable[str]) -> dict[str, str]:
    """A folder for each of several recordings, with its name; characters other than letters, digits and `-` are `_`."""
    found: dict[str, str] = {}
    taken: set[str] = set()
    for name in names:
        folder = wanted = re.sub(r"[^\w-]+", "_", name).strip("_")[-LONGEST:] or "recording"
        number = 1
        while folder in taken:
            number += 1
            folder = f"{wanted}_{number}"
        taken.add(folder)
        found[name] = folder
    return found


def _written(copier: Copier, extract: Extract, target: Path) -> dict[str, Any]:
    """Write an extract, and say so as the JSON document does. Raises RecordingError and OSError."""
    is_there = target.exists()
    # Time has gone on up to a violation that time alone decided only if a message says so.
    until = max(extract.until, copier.first_from(extract.last) or extract.until)
    with written(target) as file:
        count = copier.copy(extract.since, until, file)
    return {
        "file": str(target),
        "about": extract.text,
        "since": seconds(extract.since),
        "since_ns": extract.since,
        "until": seconds(until),
        "until_ns": until,
        "messages": count,
        "replaced": is_there,
    }
