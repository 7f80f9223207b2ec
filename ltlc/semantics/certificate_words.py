"""The words of a certificate: numbers, durations, and references to its parts."""

from __future__ import annotations

import re

from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.verdicts import Verdict

PART = re.compile(r"([atfpkqdcsbomngur])(0|[1-9][0-9]{0,8})")
VERDICTS = {v.value: v for v in Verdict if v is not Verdict.NOT_STARTED}
_NUMBER = re.compile(r"(0|[1-9][0-9]{0,8})")
_DURATION = re.compile(r"(0|[1-9][0-9]{0,17})")


class WrongError(Exception):
    """What has been read is not a certificate, and why."""


def natural(word: str) -> int:
    """A number."""
    if not _NUMBER.fullmatch(word):
        raise WrongError(f"'{word[:40]}' is not a number")
    return int(word)


def duration(word: str) -> Nanoseconds:
    """A number of nanoseconds."""
    if not _DURATION.fullmatch(word):
        raise WrongError(f"'{word[:40]}' is not a duration in nanoseconds")
    return int(word)


def refer(word: str, sort: str, count: int) -> int:
    """The number in a reference to something of a sort, of which there are `count`."""
    part = PART.fullmatch(word)
    if part is None or part[1] != sort or int(part[2]) >= count:
        existing = f"is not one of {sort}0 … {sort}{count - 1}"
        raise WrongError(f"'{word[:40]}' {existing}" if count else f"there is no '{word[:40]}'")
    return int(part[2])


def later(word: str, end: str, question: str) -> int:
    """A reference to something that may come later: by its number to an `end`, by `~` of it to a `question`."""
    part = PART.fullmatch(word)
    if part is None or part[1] not in (end, question):
        raise WrongError(f"'{word[:40]}' is neither {end}0 … nor {question}0 …")
    return int(part[2]) if part[1] == end else ~int(part[2])


def exists(target: int, end: str, ends: int, question: str, questions: int) -> None:
    """Whether what was referred to did come. Raises WrongError if not."""
    if target >= ends or ~target >= questions:
        raise WrongError(f"there is no {f'{end}{target}' if target >= 0 else f'{question}{~target}'}")


def next_number(word: str, count: int) -> None:
    """Things of a sort are numbered in order. Raises WrongError if not."""
    if int(word[1:]) != count:
        raise WrongError(f"'{word}' should be {word[0]}{count}")


def arguments(words: list[str], count: int) -> list[str]:
    """What follows on the line, as many words as `count`."""
    if len(words) != count:
        raise WrongError(f"'{words[0][:40] if words else ''}': expected {count} parts here")
    return words
