"""'Did you mean': the known name that is nearest to an unknown one."""

from __future__ import annotations

import re
from collections.abc import Iterable
from difflib import get_close_matches

MIN_LENGTH, MAX_LENGTH = 3, 100
"""Shorter names are like too many others; comparing longer ones takes long."""

MOST_ALIKE = 5
"""So many names are put first because they are alike."""


def nearest(name: str, known: Iterable[str]) -> str | None:
    """The name of `known` that is most like `name`, ignoring case; None if none is alike."""
    if not MIN_LENGTH <= len(name) <= MAX_LENGTH:
        return None
    candidates = {candidate.lower(): candidate for candidate in known}
    matches = get_close_matches(name.lower(), candidates, n=1, cutoff=0.7)
    return candidates[matches[0]] if matches else None


def nearest_first(name: str, known: Iterable[str]) -> list[str]:
    """The `known` names, those that are most like `name` first, the others in their order."""
    names = list(dict.fromkeys(known))
    comparable = [each for each in names if len(each) <= MAX_LENGTH] if len(name) <= MAX_LENGTH else []
    return list(dict.fromkeys(get_close_matches(name, comparable, n=MOST_ALIKE, cutoff=0.2) + names))


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """A sentence that offers the nearest name, or nothing."""
    found = nearest(name, known)
    return f"did you mean `{found}`?" if found else ""


MIN_SLIP = 4
"""In shorter words, a letter makes another word."""

_WORD = re.compile(r"[^\W\d_]+")


Words = tuple[str, ...]


def words(name: str) -> Words:
    """The words of a name: `front_door2` has `front` and `door`."""
    return tuple(_WORD.findall(name))


def slip(name: Words, other: Words) -> tuple[str, str] | None:
    """The word of one name that is probably a slip of the pen, and that of the other which it should be.

    They differ in nothing else, and by case or a letter: omitted, put in, replaced, or exchanged with the next one.
    Names that differ in their numbers have the same words, for they are of several things of a kind; so are `door_a`
    and `door_b`.
    """
    if len(name) != len(other):
        return None
    different = [pair for pair in zip(name, other, strict=True) if pair[0] != pair[1]]
    return different[0] if len(different) == 1 and _one_letter_apart(*different[0]) else None


def is_slip(name: str, other: str) -> bool:
    """Whether `name` is probably a slip of the pen for `other`."""
    found = slip(words(name), words(other))
    return found is not None and name.replace(*found) == other


def _one_letter_apart(one: str, two: str) -> bool:
    if one.lower() == two.lower():
        return True
    short, long = sorted((one.lower(), two.lower()), key=len)
    if len(short) < MIN_SLIP:
        return False
    first = next((k for k, (a, b) in enumerate(zip(short, long, strict=False)) if a != b), len(short))
    left, right = short[first:], long[first:]
    if len(short) < len(long):
        return left == right[1:]
    return left[1:] == right[1:] or (left[:2] == right[1::-1] and left[2:] == right[2:])
