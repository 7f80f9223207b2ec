"""The ages of a property, whose clocks messages renew: what these messages are, and how they fit what trackers do."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from ltlc.assurance.reading.attributes import Attributes, Place
from ltlc.assurance.reading.clocks import due_of_message
from ltlc.assurance.reading.language import Term
from ltlc.assurance.reading.letters import Letters
from ltlc.assurance.reading.times import late
from ltlc.semantics.diagrams import Diagram
from ltlc.semantics.reset_machine import ResetMachine
from ltlc.semantics.trackers import Case

Told = frozenset[int]
"""The messages that have come, by the levels that ask for them."""


class Ages:
    """The ages among the clocks of a class; none if its verdict is permanent from the beginning."""

    def __init__(self, attributes: Attributes, letters: Letters, time: ResetMachine) -> None:
        self._attributes, self._letters, self._diagrams = attributes, letters, letters.diagrams
        self._trackers = time.trackers
        self._told_by = {k: letters.told_by(k) for k in attributes.ages.values()}
        self._levels = sorted(set(self._told_by.values()))

    def __bool__(self) -> bool:
        return bool(self._told_by)

    def __contains__(self, clock: int) -> bool:
        return clock in self._told_by

    def messages(self) -> Iterator[Told]:
        """What messages can come together."""
        for count in range(len(self._levels) + 1):
            yield from map(frozenset, combinations(self._levels, count))

    def telling(self, told: Told) -> dict[int, bool]:
        """The answers to whether messages have come."""
        return {level: level in told for level in self._levels}

    def coming(self, told: Told, among: Diagram) -> Diagram:
        """Those `among` letters with which exactly these messages come."""
        for level in self._levels:
            came = self._diagrams.variable(level)
            among = self._diagrams.conjunction(among, came if level in told else self._diagrams.negation(came))
        return among

    def renewed(self, told: Told) -> dict[str, Term]:
        """When the clocks are due that these messages renew."""
        return {name: due_of_message(self._trackers[k]) for name, k in self._renewed(told)}

    def _renewed(self, told: Told) -> Iterator[tuple[str, int]]:
        return ((name, k) for name, k in self._attributes.ages.items() if self._told_by[k] in told)

    def late_before(self, place: Place, told: Told) -> Diagram:
        """Where these messages renew an age that was late at `place`, if the run has begun."""
        found = self._diagrams.false
        for _, k in () if place.first else self._renewed(told):
            found = self._diagrams.disjunction(found, self._letters.truths.truth(late(self._attributes.symbols[k])))
        return found

    def fit(self, place: Place, cases: tuple[Case, ...], told: Told | None) -> bool:
        """Whether messages come as `cases` say; if None is `told`, any may have.

        A message matters only where an age was late, and makes it young.
        """
        assert place.clocks is not None
        ages = [(cases[k], place.clocks.states[k].passed > 0, level) for k, level in self._told_by.items()]
        renewing = {level for case, was_late, level in ages if case.starts and was_late}
        if any(case.starts and level not in renewing for case, _, level in ages):
            return False
        return told is None or (renewing <= told and all(case.holding for case, _, level in ages if level in told))

    def are_renewed(self, cases: tuple[Case, ...]) -> bool:
        """Whether a message comes that matters: like news, it is over a nanosecond later."""
        return any(cases[k].starts for k in self._told_by)

    def answers(self, cases: tuple[Case, ...], told: Told | None) -> dict[int, bool]:
        """Which ages are late, as `cases` say; of those that are `told` to be young, none is asked."""
        asked = [k for k, level in self._told_by.items() if told is None or level not in told]
        return {self._letters.level(late(self._attributes.symbols[k])): not cases[k].holding for k in asked}
