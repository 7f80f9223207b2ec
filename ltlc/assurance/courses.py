"""Courses: frames after one another that take each transition of a monitor, and some at random.

Where a property has history, what follows depends on what was before, so a course is found step by step: a frame that
gives the next letter, in place of the last one or, where that has no say in it, of an earlier one.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice, product, zip_longest

from ltlc.assurance.runs import access_words, distinguishing_words
from ltlc.assurance.values import LONGEST_HISTORY, TRIES, Frames, Samples
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.words import Letter, Word

RANDOM_COURSES, RANDOM_FRAMES = 30, 20
MOST_GUIDED = 1000
MOST_FRAMES = 10_000
"""How many frames the courses of a kind may have, all together, if there is more than one."""

CANDIDATES = 12
"""How many frames are tried in one place of a course in search of a letter."""


class Courses:
    """The courses for the monitor of one property."""

    def __init__(self, samples: Samples, monitor: Monitor) -> None:
        self.samples = samples
        self.monitor = monitor

    def random(self) -> Iterator[Frames]:
        """Frames drawn without regard to the monitor; as many more as the property looks back over."""
        length = self.samples.reach - 1 + RANDOM_FRAMES
        for _ in range(max(1, min(RANDOM_COURSES, MOST_FRAMES // length))):
            yield self.samples.course(length)

    def guided(self) -> Iterator[Frames]:
        """To each state, then each letter, then each word that tells states apart, as far as such a course is found.

        Each letter comes in each of the ways that are known of it.
        """
        if self.samples.reach > LONGEST_HISTORY:
            return
        frames = 0
        for course in islice(self._transitions(), MOST_GUIDED):
            frames += len(course)
            if frames > MOST_FRAMES:
                return
            yield course

    def _transitions(self) -> Iterator[Frames]:
        letters = self._letters()
        access = [self._led(self.samples.start, word) for word in access_words(self.monitor, letters).values()]
        suffixes = distinguishing_words(self.monitor, letters)
        turns = max((len(known) for before in access for known in self.samples.by_letter(before).values()), default=0)
        for turn, before, letter in product(range(turns), access, letters):
            known = self.samples.by_letter(before).get(letter)
            course = (*before, known[turn % len(known)]) if known else self._led(before, (letter,))
            yield from (self._led(course, suffix) for suffix in suffixes)

    def _letters(self) -> list[Letter]:
        """The letters that are known to exist, of which some may need another past than `start`."""
        found = dict.fromkeys(self.samples.by_letter(self.samples.start))
        if self.samples.start:
            drawn = (self.samples.letter(self.samples.course(self.samples.reach)) for _ in range(TRIES))
            found |= dict.fromkeys(letter for letter in drawn if letter is not None)
        return list(found)

    def _led(self, course: Frames, word: Word) -> Frames:
        """`course` continued so that its next letters are those of `word`, as far as that is found."""
        for letter in word:
            longer = next(self._continued(course, letter), None)
            if longer is None:
                break
            course = longer
        return course

    def _continued(self, course: Frames, letter: Letter) -> Iterator[Frames]:
        """Ways to give `course` one more frame, with `letter` at it; an earlier frame is changed if need be."""
        known = self.samples.by_letter(self.samples.start)
        others = [frame for frames in zip_longest(*known.values()) for frame in frames if frame is not None]
        likely = [*course[-1:], *known.get(letter, ()), *others][:CANDIDATES]
        for frame in likely:
            if self.samples.letter((*course, frame)) == letter:
                yield (*course, frame)
        for place in range(len(course) - 1, len(course) - self.samples.reach, -1):
            for frame, last in product(likely, others[: len(known)]):
                changed = (*course[:place], frame, *course[place + 1 :])
                if self._same_letters(course, changed, place) and self.samples.letter((*changed, last)) == letter:
                    yield (*changed, last)

    def _same_letters(self, one: Frames, other: Frames, place: int) -> bool:
        """Whether two courses have the same letters from a place on."""
        ends = range(place + 1, len(one) + 1)
        return all(self.samples.letter(one[:end]) == self.samples.letter(other[:end]) for end in ends)
