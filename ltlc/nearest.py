"""'Did you mean': the known name that is nearest to an unknown one."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

MIN_LENGTH, MAX_LENGTH = 3, 100
"""Shorter names are like too many others; comparing longer ones takes long."""


def nearest(name: str, known: Iterable[str]) -> str | None:
    """The name of `known` that is most like `name`, ignoring case; None if none is alike."""
    if not MIN_LENGTH <= len(name) <= MAX_LENGTH:
        return None
    candidates = {candidate.lower(): candidate for candidate in known}
    matches = get_close_matches(name.lower(), candidates, n=1, cutoff=0.7)
    return candidates[matches[0]] if matches else None


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """A sentence that offers the nearest name, or nothing."""
    found = nearest(name, known)
    return f"did you mean `{found}`?" if found else ""
