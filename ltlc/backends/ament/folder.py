"""The folder of a package: what may be overwritten."""

from __future__ import annotations

from errno import ENOTDIR
from os import strerror
from pathlib import Path

from ltlc.backends.ament.metadata import Metadata, metadata_of
from ltlc.base.files import refuse_unwritable

MADE = "Made by ltlc"
"""The package.xml of a package that may be overwritten."""


def earlier(folder: Path) -> Metadata:
    """The manifest of the package in `folder`; if there is none, that of a new one.

    Raises OSError if `folder` cannot be written to, or has something else in it.
    """
    if folder.exists() and not folder.is_dir():
        raise NotADirectoryError(ENOTDIR, strerror(ENOTDIR))
    if not folder.exists():
        refuse_unwritable(folder)
        return Metadata()
    refuse_unwritable(folder / "package.xml")
    if not any(folder.iterdir()):
        return Metadata()
    path = folder / "package.xml"
    text = path.read_text(encoding="utf-8") if path.is_file() else ""
    if MADE not in text:
        raise OSError("the folder contains something other than a package made by ltlc")
    try:
        return metadata_of(text)
    except ValueError as error:
        raise OSError(f"its package.xml cannot be read: {error}") from None
