"""Writing files: under a temporary name in the same folder first, then renamed, so that no reader sees half a file."""

from __future__ import annotations

import json
import os
import tempfile
from codecs import BOM_UTF8
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from errno import EACCES, EISDIR
from pathlib import Path
from stat import S_IMODE
from typing import Any, BinaryIO

_NO_FILE = "it is not a file"


def write_text(path: Path, text: str) -> None:
    """Write `text` to `path` as UTF-8, replacing what is there, with the permissions a new file gets.

    Raises OSError if the folder cannot be written; then nothing is left behind.
    """
    write_bytes(path, text.encode())


def write_all(contents: Mapping[Path, bytes | str]) -> None:
    """Write all of these or none, in folders that are made if they are not there: files of one build belong together.

    Each is written aside first, as by `write_bytes`, and all are renamed when all are there. Raises OSError, whose
    `filename` is the path that cannot be written; then each file is as it was.
    """
    aside: dict[Path, str] = {}
    made: list[Path] = []
    path = Path()
    try:
        for path, content in contents.items():
            made += _make_folders(path.parent)
            aside[path] = _written_aside(path, content if isinstance(content, bytes) else content.encode())
        for path in list(aside):
            os.replace(aside[path], path)
            del aside[path]
    except BaseException as error:
        for temporary in aside.values():
            os.unlink(temporary)
        for folder in reversed(made):
            with suppress(OSError):
                folder.rmdir()
        if isinstance(error, OSError):
            error.filename, error.filename2 = str(path), None
        raise


def _make_folders(folder: Path) -> list[Path]:
    """Make `folder` and those around it; which were not there, from the outermost on."""
    missing = [each for each in (folder, *folder.parents) if not each.exists()][::-1]
    folder.mkdir(parents=True, exist_ok=True)
    return missing


def rewrite_text(path: Path, text: str) -> None:
    """Write `text` in place of what is in the file at `path`; its permissions and byte order mark stay.

    Raises OSError if the file cannot be written; then it is as it was.
    """
    if not os.access(path, os.W_OK):
        raise PermissionError(EACCES, os.strerror(EACCES))
    file = path.resolve()
    if not file.is_file():
        raise OSError(_NO_FILE)
    mark = BOM_UTF8 if file.read_bytes().startswith(BOM_UTF8) else b""
    write_bytes(file, mark + text.encode(), S_IMODE(file.stat().st_mode))


def write_bytes(path: Path, content: bytes, permissions: int | None = None) -> None:
    """Write `content` to `path`, as `write_text` does, with these `permissions` if they are given."""
    temporary = _written_aside(path, content, permissions)
    try:
        os.replace(temporary, path)
    except BaseException:
        os.unlink(temporary)
        raise


@contextmanager
def written(path: Path) -> Iterator[BinaryIO]:
    """A file that becomes the one at `path` once all of it has been written; otherwise nothing is left behind.

    Raises OSError.
    """
    temporary = _written_aside(path, b"")
    try:
        with open(temporary, "wb") as file:
            yield file
        os.replace(temporary, path)
    except BaseException:
        os.unlink(temporary)
        raise


def _written_aside(path: Path, content: bytes, permissions: int | None = None) -> str:
    """The name of a file beside `path` that has `content`. Raises OSError, and leaves nothing then."""
    descriptor, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(content)
        os.chmod(temporary, _of_new_files() if permissions is None else permissions)
    except BaseException:
        os.unlink(temporary)
        raise
    return temporary


def _of_new_files() -> int:
    """The permissions that a new file gets."""
    umask = os.umask(0)
    os.umask(umask)
    return 0o666 & ~umask


def refuse_unwritable(path: Path) -> None:
    """Raise the OSError that `write_text` would, and one if `path` exists but is not a file; nothing is left behind."""
    if path.is_dir():
        raise IsADirectoryError(EISDIR, os.strerror(EISDIR))
    if path.exists() and not path.is_file():
        raise OSError(_NO_FILE)
    with tempfile.TemporaryFile(dir=path.parent):
        pass


class ScratchError(OSError):
    """A temporary file cannot be written; the text says where, and what helps."""


@contextmanager
def scratch() -> Iterator[Path]:
    """A folder that is there for as long as the context. Raises ScratchError where it cannot be used."""
    try:
        with tempfile.TemporaryDirectory() as folder:
            yield Path(folder)
    except OSError as error:
        reason = f"{error.strerror or error}; free some space, or set TMPDIR to another folder"
        raise ScratchError(error.errno, reason, error.filename or tempfile.tempdir) from None


def compact_json(data: dict[str, Any]) -> str:
    """`data` as JSON with one line for each entry of its tables, so that changes can be read."""
    parts = []
    for key, value in data.items():
        items = value.items() if isinstance(value, dict) else enumerate(value)
        lines = (f"{json.dumps(k)}: {json.dumps(v)}" if isinstance(value, dict) else json.dumps(v) for k, v in items)
        opening, closing = "{}" if isinstance(value, dict) else "[]"
        parts.append(f"{json.dumps(key)}: {opening}\n" + ",\n".join(lines) + f"\n{closing}")
    return "{\n" + ",\n".join(parts) + "\n}\n"
