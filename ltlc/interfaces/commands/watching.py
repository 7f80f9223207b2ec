"""`--watch`: a command again and again, whenever a file that it reads has changed."""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable, Collection, Iterable, Iterator
from glob import glob
from pathlib import Path

from ltlc.interfaces.commands.common import unusable

EVERY_SECONDS = 0.2
"""How often files are looked at; a change counts when nothing has changed for as long."""

TEXT = ("text", "full", "concise")
"""The forms that are for people."""

Files = dict[str, tuple[int, int, int]]
"""What changes when a file does: its identity, its size, and when it was last written."""


def add_watch(parser: argparse.ArgumentParser) -> None:
    """The option."""
    parser.add_argument("--watch", action="store_true", help="run again whenever a file changes, until Ctrl-C")


def watched(
    run: Callable[[argparse.Namespace], int],
    options: argparse.Namespace,
    read: Iterable[str | Path],
    written: Collection[Path] = (),
) -> int:
    """Call `run` now and whenever what is `read` changes, but for what it has `written`; its last result at Ctrl-C."""
    names = [str(each) for each in read]
    for name in names:
        if name == "-" or "://" in name:
            return unusable(f"--watch needs files, and `{name}` is none that can be watched")
    if options.format not in TEXT:
        return unusable(f"--watch prints a report again and again, which {options.format} cannot be")
    ignored = {os.path.realpath(each) for each in written}
    code = None
    try:
        while True:
            seen = files_at(names, ignored)
            if sys.stdout.isatty():
                sys.stdout.write("\x1b[H\x1b[2J")
            code = run(options)
            sys.stdout.flush()
            if not options.quiet:
                print("ltlc: waiting for a change, Ctrl-C ends", file=sys.stderr)
            _wait(lambda: files_at(names, ignored), seen)
    except KeyboardInterrupt:
        if code is None:
            raise
        return code


def _wait(look: Callable[[], Files], seen: Files) -> None:
    """Return when files are not as they were `seen`, and have stopped changing."""
    before = seen
    while (now := look()) == seen or now != before:
        before = now
        time.sleep(EVERY_SECONDS)


def files_at(names: Iterable[str], ignored: Collection[str] = ()) -> Files:
    """The files with these names, in these folders, or that these patterns match, but for hidden ones."""
    found = {}
    for path in (file for name in names for place in glob(name, recursive=True) or [name] for file in _below(place)):
        try:
            of = os.stat(path)
        except OSError:
            continue  # an editor is about to put another in its place
        if os.path.realpath(path) not in ignored:
            found[path] = (of.st_ino, of.st_size, of.st_mtime_ns)
    return found


def _below(place: str) -> Iterator[str]:
    if not os.path.isdir(place):
        yield place
    for folder, _, files in os.walk(place):
        yield from (os.path.join(folder, file) for file in files if not file.startswith("."))
