"""Processes that a test has started, and what they have started."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path


def children_of(process: int) -> set[int]:
    """The processes that `process` has started."""
    found: set[int] = set()
    for thread in Path(f"/proc/{process}/task").iterdir():
        with suppress(FileNotFoundError, ProcessLookupError):  # a thread may end meanwhile
            found.update(map(int, (thread / "children").read_text().split()))
    return found
