"""The folder of what was found: the recording, the parameters, and the report."""

from __future__ import annotations

import os
import shutil
import tempfile
from errno import EEXIST
from pathlib import Path

REPORT = "falsified.json"
"""The file of the report; a folder with it was written by us, and may be replaced."""


def refuse(folder: Path) -> None:
    """Raise OSError if `folder` cannot be written, or has something else in it."""
    if folder.exists() and not (folder / REPORT).is_file() and not (folder.is_dir() and not any(folder.iterdir())):
        raise OSError(EEXIST, "it contains something other than what ltlc falsify keeps")
    with tempfile.TemporaryFile(dir=folder.absolute().parent):
        pass


def keep(simulated: Path, folder: Path, report: str) -> None:
    """Copy what is in `simulated` to `folder`, with the `report`: all of it or nothing. Raises OSError."""
    with tempfile.TemporaryDirectory(dir=folder.absolute().parent, prefix=f".{folder.name}.") as aside:
        made = Path(aside, "made")
        shutil.copytree(simulated, made)
        (made / REPORT).write_text(report, encoding="utf-8")
        before = Path(aside, "before")
        if folder.exists():
            os.rename(folder, before)
        try:
            os.rename(made, folder)
        except OSError:
            if before.exists():
                os.rename(before, folder)
            raise
