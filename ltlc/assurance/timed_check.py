"""The cross-check in time: the monitor of a property with clocks against the denotation on instants."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

from ltlc.assurance.runs import Agreement, Mismatch, judging_letters
from ltlc.assurance.walks import Walks, taken, word_of
from ltlc.compiler import Compiled
from ltlc.semantics.denotation import READINGS, satisfies
from ltlc.semantics.instants import Instant, Observation, Step
from ltlc.semantics.timed_run import TimedRun
from ltlc.semantics.verdicts import Verdict

CONTINUATIONS = 3
"""How many ways to go on are tried of a run with a permanent verdict."""


def timed_check(compiled: Compiled) -> Agreement | Mismatch:
    """Compare the monitor of `compiled` with the reference; the same input gives the same runs."""
    judge = _Judge(compiled)
    planned = list(judge.walks.telling(judge.letters))
    for walk in sorted(planned, key=lambda walk: (len(walk.steps), walk.until)):
        if mismatch := judge.mismatch(walk):
            return mismatch
    return Agreement(len(planned), max(len(walk.steps) for walk in planned), 0)


MOST_EXPIRIES = 50
"""How often clocks expire while a letter is held, unless one that is wrong starts itself again."""


class _Judge:
    """What decides on one walk whether a monitor's verdict is right."""

    def __init__(self, compiled: Compiled) -> None:
        self.walks = Walks(compiled)
        self.letters = judging_letters(compiled)
        self._monitor = compiled.monitor
        self._property = compiled.specification.property
        self._reading = READINGS[compiled.encoding.name]

    def mismatch(self, walk: Observation) -> Mismatch | None:
        """What is wrong with the monitor's verdict at the end of `walk`, if anything."""
        run = self.walks.run(walk.session)
        judged = [instant for step in walk.steps for instant in taken(run, step)] + list(run.hold(walk.until))
        verdicts = self._monitor.run(judged)
        verdict = verdicts[-1]
        if any(earlier.is_permanent and earlier is not verdict for earlier in verdicts):
            return _mismatch(walk, verdict, "a permanent verdict was given before and cannot change")
        if not verdict.is_permanent:
            holds = self._holds(walk, judged)
            said = "satisfied" if holds else "not satisfied"
            return (
                None if holds == verdict.holds else _mismatch(walk, verdict, f"{said} as a run up to {walk.until} ns")
            )
        for longer, instants in self._continued(walk, run, judged):
            if self._holds(longer, instants) != verdict.holds:
                later = _steps_text(longer.steps[len(walk.steps) :])
                return _mismatch(walk, verdict, f"not permanent: it changes if the run continues with {later} forever")
        return None

    def _holds(self, walk: Observation, judged: list[Instant]) -> bool:
        word = word_of(self._property, walk, (instant.time for instant in judged))
        return satisfies(word, self._property, self._reading)

    def _continued(
        self, walk: Observation, run: TimedRun, judged: list[Instant]
    ) -> Iterator[tuple[Observation, list[Instant]]]:
        """Longer runs, their last letters held until no clock runs: what holds of one then, holds if that goes on."""
        time = walk.until
        for _ in range(CONTINUATIONS):
            for due in islice(iter(run.due, None), MOST_EXPIRIES):
                judged, time = [*judged, *run.hold(due)], due
            if run.due() is not None:
                return
            longer = walk._replace(until=time)
            yield longer, judged
            step = Step(time, self.walks.with_news(self.walks.chance.choice(self.letters)))
            walk = walk._replace(steps=(*walk.steps, step))
            judged = [*judged, *run.step(*step)]


def _mismatch(walk: Observation, verdict: Verdict, expected: str) -> Mismatch:
    return Mismatch(tuple(Instant(*step) for step in walk.steps), verdict, expected)


def _steps_text(steps: tuple[Step, ...]) -> str:
    return " ; ".join(f"{{{', '.join(sorted(letter))}}} at {time} ns" for time, letter in steps) or "its last letter"
