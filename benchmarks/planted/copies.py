"""Copies of the project in which faults are planted, and children that run tests in them."""

from __future__ import annotations

import importlib
import os
import shutil
import signal
import sys
import time
import traceback
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from benchmarks.planted.rooms import PROJECT

LEFT_OUT = shutil.ignore_patterns(".git", ".venv", ".hypothesis", ".*_cache", "__pycache__", "node_modules")


@dataclass(eq=False)
class Copy:
    """The project in a folder of its own, with a fault or without."""

    folder: Path
    right: tuple[Path, str, int] | None = None
    """The file that has a fault: its text and the time of its last change without it."""
    version: int = 0

    def plant(self, path: Path, text: str) -> None:
        """Put a text with a fault in the place of a file's."""
        place = self.folder / path
        self.right = place, place.read_text(encoding="utf-8"), place.stat().st_mtime_ns
        place.write_text(text, encoding="utf-8")
        self.version += 1
        os.utime(place, ns=(0, self.version * 10**9))  # by the second of it, Python tells what is compiled anew

    def restore(self) -> None:
        """Take the fault away."""
        if self.right:
            place, text, changed = self.right
            place.write_text(text, encoding="utf-8")
            os.utime(place, ns=(changed, changed))
            self.right = None


def copied(folder: Path) -> Copy:
    """A fresh copy of the project at `folder`."""
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(PROJECT, folder, ignore=LEFT_OUT)
    shared = PROJECT.parent / "shared"
    with suppress(FileExistsError):
        (folder.parent / "shared").symlink_to(shared)
    return Copy(folder)


class Ran:
    """Tests that run in a child: what came of them, once it has ended."""

    def __init__(self, process: int, killer: Path, seconds: float) -> None:
        self.process = process
        self.killer = killer
        self.until = time.monotonic() + seconds

    def ended(self) -> str | None:
        """'survived', or by what the fault was killed; None as long as they run. Who hangs is ended."""
        process, status = os.waitpid(self.process, os.WNOHANG)
        late = not process and time.monotonic() > self.until
        if not process and not late:
            return None
        with suppress(ProcessLookupError):
            os.killpg(self.process, signal.SIGKILL)
        if late:
            os.waitpid(self.process, 0)
            return "killed: it hangs"
        if status == 0:
            return "survived"
        killer = self.killer.read_text(encoding="utf-8") if self.killer.exists() else "the tests do not begin"
        return f"killed: {killer}"


@dataclass
class First:
    """A plugin of pytest that keeps the order that was asked for, and writes down the first test that fails."""

    asked: Sequence[str]
    killer: Path
    places: dict[str, int] = field(default_factory=dict)

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Put the tests in the order that was asked for."""
        self.places = {name: place for place, name in enumerate(self.asked)}
        items.sort(key=lambda item: self.places.get(item.nodeid, 0))

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Write down the test that fails."""
        if report.failed:
            self.killer.write_text(report.nodeid, encoding="utf-8")


def in_child(
    copy: Copy, asked: Sequence[str], log: Path, seconds: float, recorder: Callable[[], object] | None = None
) -> Ran:
    """Run tests in a copy, in a child: the first that fails ends it, unless a recorder is to see all of them."""
    libraries()
    killer = log.with_suffix(".killer")
    killer.unlink(missing_ok=True)
    process = os.fork()
    if process:
        return Ran(process, killer, seconds)
    try:
        os.setsid()
        output = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(output, 1)
        os.dup2(output, 2)
        os.chdir(copy.folder)
        os.environ |= {"PYTHONPATH": str(copy.folder), "CI": "1"}
        sys.path[:] = [str(copy.folder), *(p for p in sys.path if p not in ("", str(PROJECT)))]
        status = pytest.main(
            [*asked] if recorder else ["-x", *asked], [recorder() if recorder else First(asked, killer)]
        )
    except BaseException:
        traceback.print_exc()
        status = 70
    os._exit(int(status))


def libraries() -> None:
    """Import once what takes long and has no faults, for all children."""
    for name in ("jinja2", "numpy", "pyarrow", "spot", "z3"):
        importlib.import_module(name)
