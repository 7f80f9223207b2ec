"""Which properties what comes in concerns, and which time does."""

from __future__ import annotations

from collections.abc import Iterable

from ltlc.runtime.properties import Change
from ltlc.runtime.sampling import Window
from ltlc.runtime.times import NEVER
from ltlc.runtime.tracking import Track

Stepped = tuple[Track, Window]
"""A property in a run, and what it reads."""


class Readers:
    """The properties that are stepped, by what they read.

    Which of them something concerns is found once, since the same comes in again.
    """

    def __init__(self, stepped: Iterable[Stepped]) -> None:
        self.stepped = tuple(stepped)
        self._signals: dict[str, list[int]] = {}
        self._topics: dict[str, list[int]] = {}
        self._concerned: dict[
            tuple[frozenset[str], frozenset[str]], tuple[Stepped, ...]
        ] = {}
        for number, (_, window) in enumerate(self.stepped):
            for name in window.signals:
                self._signals.setdefault(name, []).append(number)
            for topic in window.topics:
                self._topics.setdefault(topic, []).append(number)

    def concerned(
        self, fresh: frozenset[str], topics: frozenset[str]
    ) -> tuple[Stepped, ...]:
        """Those that read a signal with a new sample, or want the news of a topic."""
        found = self._concerned.get((fresh, topics))
        if found is None:
            numbers = {n for name in fresh for n in self._signals.get(name, ())}
            numbers |= {n for topic in topics for n in self._topics.get(topic, ())}
            found = tuple(self.stepped[number] for number in sorted(numbers))
            self._concerned[fresh, topics] = found
        return found


class Clocks:
    """The properties that time alone may change.

    None changes up to `soon`, unless it has a step first; of those that had no step
    since it was worked out, none up to `_next`. Both are bounds from below.
    """

    def __init__(self, tracks: Iterable[Track]) -> None:
        timed = [track for track in tracks if track.property.timed]
        self._places = {track: place for place, track in enumerate(timed)}
        self._stepped: set[Track] = set()
        self.soon = self._next = NEVER
        for track in timed:
            self.note(track)

    def begin(self, time: int) -> None:
        """The session begins; ages count from then."""
        for track in self._places:
            track.begin(time)
            self.note(track)

    def note(self, track: Track) -> None:
        """One of these properties has had a step, and may change sooner or later."""
        self._stepped.add(track)
        if (until := track.until) < self.soon:
            self.soon = until

    def hold(self, time: int) -> list[Change]:
        """Take the clock steps up to and including `time`, in their order."""
        if time <= self.soon:
            return []
        tracks: Iterable[Track] = self._places
        if time <= self._next:
            tracks = sorted(self._stepped, key=self._places.__getitem__)
        else:
            self._next = NEVER
        changes = [change for track in tracks for change in track.hold(time)]
        self.soon = self._next = min([self._next, *(track.until for track in tracks)])
        self._stepped.clear()
        return sorted(changes, key=lambda change: change.moment.time)
