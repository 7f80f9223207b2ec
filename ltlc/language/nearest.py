"""'Did you mean': the known name that is nearest to an unknown one."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

MAX_LENGTH = 100
"""No one mistypes a longer name; comparing long ones takes long."""


def nearest(name: str, known: Iterable[str]) -> str | None:
    """The name of `known` that is most like `name`, ignoring case; None if none is alike."""
    if len(name) > MAX_LENGTH:
        return None
    candidates = {candidate.lower(): candidate for candidate in known}
    matches = get_close_matches(name.lower(), candidates, n=1, cutoff=0.6)
    return candidates[matches[0]] if matches else None


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """A sentence that offers the nearest name, or nothing."""
    found = nearest(name, known)
    return f"did you mean `{found}`?" if found else ""
