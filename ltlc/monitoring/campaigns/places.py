"""Where recordings are: files, folders and patterns of a command line become places, each of one recording."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import field
from glob import glob, has_magic
from hashlib import sha256
from pathlib import Path

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.source import Source
from ltlc.dataclass import dataclass
from ltlc.inputs.recordings import is_recording


@dataclass(frozen=True, slots=True)
class Location:
    """Where a recording is, a path of this machine or an address such as `s3://bucket/drive.mcap`.

    A recording has changed if its `size` in bytes or its `version` are others than before, or nothing is known of them.
    """

    name: str
    size: int | None = None
    version: str = ""


@dataclass(slots=True)
class Found:
    """What was found: places, files that were skipped as they are not recordings, names of what was given twice."""

    places: list[Location] = field(default_factory=list)
    left_alone: int = 0
    doubled: list[str] = field(default_factory=list)
    problems: list[Diagnostic] = field(default_factory=list)

    @property
    def paths(self) -> list[Path]:
        """The recordings on this machine."""
        return [Path(place.name) for place in self.places if not is_address(place.name)]


def is_address(name: str) -> bool:
    """Whether `name` is an address of some storage, and no path of this machine."""
    return "://" in name


def is_one(arguments: Sequence[str]) -> bool:
    """Whether `arguments` name one recording of this machine by itself, neither a folder of them nor a pattern."""
    if len(arguments) != 1 or is_address(arguments[0]):
        return False
    path = Path(arguments[0])
    if path.is_dir():
        return is_recording(path)
    return path.exists() or not has_magic(arguments[0])


def find(arguments: Sequence[str], results: Path | None = None) -> Found:
    """The recordings that `arguments` mean, in their order, in folders sorted; a table of `results` is none.

    What is named by itself is taken for a recording, whatever it is called; it shows when it is judged.
    """
    found = Found()
    seen = set() if results is None else {os.path.realpath(results)}
    for argument in arguments:
        problems = len(found.problems)
        places = list(_remote(argument, found) if is_address(argument) else _local(argument, found))
        if not places and len(found.problems) == problems:
            found.problems.append(_nothing(argument))
        for place in places:
            identity = place.name if is_address(place.name) else os.path.realpath(place.name)
            if identity not in seen:
                seen.add(identity)
                found.places.append(place)
            elif results is None or identity != os.path.realpath(results):
                found.doubled.append(place.name)
    return found


def _nothing(argument: str) -> Diagnostic:
    if not argument:
        return diagnostic(
            "LTL830", Source(argument, ""), None, "an empty name is not a recording", help="`.` is this folder"
        )
    what = "matches no recording" if has_magic(argument) else "contains no recording"
    help = "check the pattern: `**` stands for folders at any depth" if has_magic(argument) else ""
    return diagnostic("LTL830", Source(argument, ""), None, f"`{argument}` {what}", help=help)


def _remote(address: str, found: Found) -> Iterator[Location]:
    from ltlc.monitoring.campaigns.storage import StorageError, listed

    try:
        places, left_alone = listed(address)
    except StorageError as error:
        found.problems.append(error.diagnostic)
        return
    found.left_alone += left_alone
    yield from places


def _local(argument: str, found: Found) -> Iterator[Location]:
    if not argument:
        return
    path = Path(argument)
    if path.exists() or not has_magic(argument):
        yield from _below(path, found) if _is_folder_of_others(path) else [place_of(path)]
        return
    for match in map(Path, sorted(glob(argument, recursive=True))):
        if _is_folder_of_others(match):
            # `**` matches folders and what is in them, which would be taken twice
            yield from () if "**" in argument else _below(match, found)
        elif is_recording(match):
            yield place_of(match)
        else:
            found.left_alone += 1


def _is_folder_of_others(path: Path) -> bool:
    return path.is_dir() and not is_recording(path)


def _below(folder: Path, found: Found) -> Iterator[Location]:
    """The recordings in `folder` and its folders, links included, without hidden ones."""
    seen: set[str] = set()
    for name, folders, files in os.walk(folder, onerror=lambda error: _unreadable(error, found), followlinks=True):
        here = Path(name)
        if os.path.realpath(here) in seen:
            folders.clear()
            continue
        seen.add(os.path.realpath(here))
        bags = sorted(each for each in folders if is_recording(here / each))
        folders[:] = sorted(each for each in folders if each not in bags and not each.startswith("."))
        shown = sorted(each for each in files if not each.startswith("."))
        recordings = [each for each in shown if is_recording(here / each)]
        found.left_alone += len(shown) - len(recordings)
        yield from (place_of(here / each) for each in sorted([*bags, *recordings]))


def _unreadable(error: OSError, found: Found) -> None:
    """Keep that a folder cannot be looked into; the others are judged all the same."""
    message = f"`{error.filename}` cannot be read: {error.strerror}"
    found.problems.append(diagnostic("LTL902", Source(str(error.filename), ""), None, message))


def place_of(path: Path) -> Location:
    """The place of the recording at `path`; its version is when it was changed, that of a bag's folder of all files."""
    files = sorted(each for each in path.rglob("*") if each.is_file()) if path.is_dir() else [path]
    try:
        states = [(str(each.relative_to(path)), each.stat()) for each in files]
    except OSError:  # gone, or never there: reported when it is judged
        return Location(str(path))
    size = sum(state.st_size for _, state in states)
    if path.is_dir():
        told = repr([(name, state.st_size, state.st_mtime_ns) for name, state in states])
        return Location(str(path), size, sha256(told.encode()).hexdigest()[:32])
    return Location(str(path), size, str(states[0][1].st_mtime_ns))
