"""Specifications of a command line: files, all that a folder has of them, the standard input."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.source import Source

SUFFIX = ".ltlc"
"""How files end that are specifications: in a folder no other is looked at, for a text may be anything."""


def found_in(named: Sequence[Path]) -> tuple[list[Path], list[Diagnostic]]:
    """What is `named`, each once, with the specifications of folders in their place; and folders without any."""
    found: dict[str, Path] = {}
    problems = []
    for each in named:
        below = list(_below(each)) if each.is_dir() else [each]
        if not below:
            problems.append(_nothing(each))
        for path in below:
            found.setdefault(os.path.realpath(path), path)
    return list(found.values()), problems


def _below(folder: Path) -> Iterator[Path]:
    """The specifications in `folder` and its folders, without hidden ones."""
    for name, folders, files in os.walk(folder):
        folders[:] = sorted(each for each in folders if not each.startswith("."))
        yield from (Path(name) / each for each in sorted(files) if each.endswith(SUFFIX) and not each.startswith("."))


def _nothing(folder: Path) -> Diagnostic:
    message = f"there is no file *{SUFFIX} in {folder}"
    help = "name other specifications individually, as in `specs/*.txt`"
    return diagnostic("LTL901", Source(str(folder), ""), None, message, help=help)
