"""Recordings on other storage, through fsspec: what is there, and copies of it for as long as they are judged."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from glob import has_magic
from hashlib import sha256
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from typing import Any

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.libraries import command
from ltlc.base.source import Source
from ltlc.inputs.recordings import is_recording
from ltlc.monitoring.campaigns.places import Location, is_address

_CHANGES = {"etag", "md5", "contentmd5", "digest", "checksum", "version", "generation"} | {
    "modified", "mtime", "lastmodified", "created",
}  # fmt: skip
"""What storages call that which changes with a file, in small letters and without hyphens."""


class StorageError(Exception):
    """A storage cannot be read, for the reason that `diagnostic` gives."""

    def __init__(self, address: str, message: str, help: str = "") -> None:
        super().__init__(message)
        self.diagnostic: Diagnostic = diagnostic("LTL831", Source(address, ""), None, message, help=help)


def listed(address: str) -> tuple[list[Location], int]:
    """The recordings at `address`, which may be a folder or a pattern, sorted; and how many files there are none.

    Raises StorageError.
    """
    system, path = _opened(address)
    try:
        if has_magic(path):
            files = {name: state for name, state in system.glob(path, detail=True).items() if state["type"] == "file"}
        elif _names_a_file(path) or not system.isdir(path):
            return [_place(system, path, system.info(path))], 0
        else:
            files = system.find(path, detail=True)
    except Exception as error:  # each storage has exceptions of its own
        raise StorageError(address, f"`{address}` cannot be read: {_reason(error)}") from None
    bags = {str(PurePosixPath(name).parent) for name in files if PurePosixPath(name).name == "metadata.yaml"}
    places = [_bag(system, bag, files) for bag in bags]
    others = {name: state for name, state in files.items() if str(PurePosixPath(name).parent) not in bags}
    places += [_place(system, name, state) for name, state in others.items() if _names_a_file(name)]
    return sorted(places, key=lambda place: place.name), len(others) - sum(map(_names_a_file, others))


@contextmanager
def fetched(name: str) -> Iterator[Path]:
    """Where on this machine the recording `name` can be read: itself, or a copy that is removed afterwards.

    Raises StorageError.
    """
    if not is_address(name):
        yield Path(name)
        return
    system, path = _opened(name)
    with TemporaryDirectory(prefix="ltlc-") as folder:
        copy = Path(folder) / PurePosixPath(path).name
        try:
            system.get(path, str(copy), recursive=not _names_a_file(path))
        except Exception as error:  # each storage has exceptions of its own
            raise StorageError(name, f"`{name}` cannot be read: {_reason(error)}") from None
        yield copy


def _opened(address: str) -> tuple[Any, str]:
    """The storage at `address`, and the path in it. Raises StorageError."""
    try:
        import fsspec
    except ImportError:
        message = f"`{address}` needs fsspec, which is not installed"
        raise StorageError(address, message, command("campaigns")) from None
    try:
        system, path = fsspec.core.url_to_fs(address)
    except ImportError as error:
        help = "install the package for this kind of storage"
        raise StorageError(address, f"`{address}` cannot be read: {error}", help) from None
    except Exception as error:
        raise StorageError(address, f"`{address}` cannot be read: {_reason(error)}") from None
    return system, path


def _names_a_file(path: str) -> bool:
    """Whether the name ends like that of a recording in one file."""
    return is_recording(Path(PurePosixPath(path).name))


def _reason(error: Exception) -> str:
    if isinstance(error, FileNotFoundError):
        return "there is nothing"
    return f"{error}" or type(error).__name__


def _place(system: Any, path: str, state: dict[str, Any]) -> Location:
    state = state if state.get("size") is not None else system.info(path)
    return Location(system.unstrip_protocol(path), state.get("size"), _version([(path, state)]))


def _bag(system: Any, folder: str, files: dict[str, dict[str, Any]]) -> Location:
    parts = sorted((name, state) for name, state in files.items() if str(PurePosixPath(name).parent) == folder)
    size = sum(state.get("size") or 0 for _, state in parts)
    return Location(system.unstrip_protocol(folder), size, _version(parts))


def _version(parts: list[tuple[str, dict[str, Any]]]) -> str:
    """What changes with the files, by the storage's data on their content or age; empty if it has none for one."""
    told = [(name, state.get("size"), sorted(map(str, _changes(state)))) for name, state in parts]
    return sha256(repr(told).encode()).hexdigest()[:32] if all(changes for *_, changes in told) else ""


def _changes(state: dict[str, Any]) -> Iterator[tuple[str, str]]:
    names = ((key, key.lower().replace("-", "").replace("_", "")) for key in state)
    return ((name, str(state[key])) for key, name in names if name in _CHANGES and state[key] is not None)
