"""Memory that this process may take for a while: more of it is a MemoryError, and not the end of the machine."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_SIZES = Path("/proc/self/statm")
_DATA = 5
"""Which of these sizes, in pages, is that of the data."""


@contextmanager
def at_most(megabytes: int) -> Iterator[None]:
    """Within the context, this process can take so much more memory; an allocation beyond that raises MemoryError.

    Nothing is bounded without `/proc`, or if there are other threads, which could get the MemoryError instead.
    """
    if threading.active_count() > 1 or not _SIZES.exists():
        yield
        return
    import resource  # here, since Windows has none

    before, hard = resource.getrlimit(resource.RLIMIT_DATA)
    present = int(_SIZES.read_text(encoding="ascii").split()[_DATA]) * resource.getpagesize()
    wanted = present + megabytes * 2**20
    least = min((each for each in (before, hard) if each != resource.RLIM_INFINITY), default=wanted)
    resource.setrlimit(resource.RLIMIT_DATA, (min(wanted, least), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, (before, hard))
