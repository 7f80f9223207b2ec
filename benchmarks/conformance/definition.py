"""The verdicts of a run by definition: of the reference of `benchmarks.differential`, which shares only the parser."""

from __future__ import annotations

from functools import lru_cache

from benchmarks.conformance.cases import Verdicts
from benchmarks.differential import reference
from benchmarks.differential.compare import last_of_each_time
from benchmarks.differential.each import SLICED, Each
from benchmarks.differential.names import said
from benchmarks.differential.reference import Judged, Property, judged_alone, whole_run
from benchmarks.differential.samples import Recording
from ltlc.frontend.syntax import tree as s

WORST_FIRST = ("violated", "presumably_violated", "presumably_satisfied")


class Definition:
    """A specification of one property, read once for many runs. Raises AssertionError where it cannot be read."""

    def __init__(self, text: str) -> None:
        self.names = said(text)
        self.each = Each(text) if "\np: each " in text else None
        body = None if self.each is None else self.each.body
        self.property: Property | None = None
        if self.each is None:
            [self.property] = reference.properties(text).values()
            self.reads = self.property.reads
        elif isinstance(body, s.EachOf):
            self.reads = Property(self.names, body.body).reads
        else:
            self.property = self.each.whole()
            self.reads = self.property.reads
        keyed = isinstance(body, s.EachOf)
        self.topics = self.reads.all_topics | ({SLICED} if keyed else set())
        self.signals = self.reads.signals | ({"key"} if keyed else set())

    def judged(self, recording: Recording) -> Judged:
        """What the property is on a run; not of a property of each id, of which there is no single run."""
        assert self.property is not None
        return judged_alone(self.property, whole_run({"p": self.property}, recording))

    def verdicts(self, recording: Recording) -> Verdicts:
        """The verdicts on a run."""
        if self.property is None:
            return self._of_slices(recording)
        judged = self.judged(recording)
        changes = last_of_each_time(judged.changes)
        if self.each is not None:  # another message may come
            shown = [(time, "presumably_satisfied" if v == "satisfied" else v) for time, v in changes]
            changes = last_of_each_time(shown)
        return Verdicts(changes, [step.time for step in judged.run.steps])

    def _of_slices(self, recording: Recording) -> Verdicts:
        """Violated where a slice is; satisfied only so far, since another id may come."""
        assert self.each is not None
        parts = [judged_alone(part, recording) for part in self.each.slices(recording).values()]
        moments = sorted({time for part in parts for time, _ in part.changes})
        changes: list[tuple[int, str]] = []
        for moment in moments:
            now = {Verdicts(part.changes, ()).at(moment) for part in parts}
            verdict = next((each for each in WORST_FIRST if each in now), "presumably_satisfied")
            if not changes or changes[-1][1] != verdict:
                changes.append((moment, verdict))
        steps = sorted(step.time for part in parts for step in part.run.steps)
        return Verdicts(changes, steps)


definition = lru_cache(4096)(Definition)
"""The same, kept: to read a specification takes longer than to judge a run."""
