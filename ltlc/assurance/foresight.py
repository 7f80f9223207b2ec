"""Whether the alphabet has every letter that values lead to: certificate, cross-check and monitor rely on it."""

from __future__ import annotations

from ltlc.assurance.courses import Courses
from ltlc.assurance.values import LONGEST_HISTORY, Frames, Samples
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.semantics.words import Letter


@dataclass(frozen=True, slots=True)
class Foreseen:
    """The alphabet allows the `letters` different letters that were found."""

    letters: int


@dataclass(frozen=True, slots=True)
class Unforeseen:
    """The alphabet excludes `letter`, which the samples in `frames`, one after the other, lead to."""

    letter: Letter
    frames: Frames


def foresight(compiled: Compiled, samples: Samples) -> Foreseen | Unforeseen:
    """Look for letters on the edges of conditions and at random, by the reference for values."""
    if samples.reach <= LONGEST_HISTORY:
        samples.by_letter(samples.start)
    for course in Courses(samples, compiled.monitor).random():
        samples.letters(course)
    for letter, frames in samples.found.items():
        if not compiled.specification.alphabet.allows(letter):
            return Unforeseen(letter, frames)
    return Foreseen(len(samples.found))
