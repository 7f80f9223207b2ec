"""Taking a track forward by many steps: to the state in which it would be after one after the other."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property

import numpy as np

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Places
from ltlc.monitoring.columns.atoms import bits_of
from ltlc.monitoring.columns.bits import Bits, batches, pack, unpack
from ltlc.monitoring.columns.counts import Count
from ltlc.monitoring.columns.follow import run
from ltlc.monitoring.columns.groups import Passed
from ltlc.monitoring.columns.kept import KeptLetters
from ltlc.monitoring.columns.prepared import Prepared
from ltlc.monitoring.columns.series import Steps, UnsupportedError
from ltlc.monitoring.columns.tables import Tables
from ltlc.monitoring.columns.values import not_numbers, predicate, value
from ltlc.monitoring.later import Later, is_followed, later_of, letters_of
from ltlc.runtime.courses import Course
from ltlc.runtime.episodes import Episodes
from ltlc.runtime.properties import Moment, Opening, Scope
from ltlc.runtime.reasons import reason_of_none
from ltlc.runtime.tracking import Track


@dataclass(frozen=True)
class Stretch:
    """Those of `steps` of a property at which nothing that it compares is NaN, and how its atoms are at each.

    `numbers` are their numbers; None for all. Of a property that counts, `counts` say how often something has occurred,
    and `atoms` has behind the others where that is often enough. Of one that reads values at openings, these are all
    steps, and `kept` tells where its letter changes.
    """

    steps: Steps
    numbers: Places | range | None
    atoms: tuple[Bits, ...]
    kept: KeptLetters | None = None
    counts: tuple[Count, ...] = ()

    def __len__(self) -> int:
        return len(self.steps) if self.numbers is None else len(self.numbers)

    @cached_property
    def times(self) -> Places:
        """The time of each."""
        return self.steps.times if self.numbers is None else self.steps.times[self.numbers]

    def number(self, step: int) -> int:
        """Which of `steps` it is."""
        return step if self.numbers is None else int(self.numbers[step])

    def part(self, first: int, end: int) -> Stretch:
        """Those from the `first` to before the `end`; both are multiples of eight, or `end` is that of all."""
        numbers = range(first, end) if self.numbers is None else self.numbers[first:end]
        atoms = tuple(bits.part(first >> 3, (end + 7) >> 3) for bits in self.atoms)
        return Stretch(self.steps, numbers, atoms)


def stretch(track: Track, of: Prepared, steps: Steps) -> Stretch:
    """The valid ones of `steps`; where `track` is decided for good, without its atoms. Raises UnsupportedError."""
    if not len(steps):
        return Stretch(steps, None, ())
    is_judged = is_followed(track)
    ages = is_judged and has_ages(track)
    if of.openings:
        if letters_of(track) is not None:
            raise UnsupportedError("values at openings, of which there is to be evidence")
        return Stretch(steps, None, (), KeptLetters(track, of, steps))
    found = tuple([bits_of(atom, steps) for atom in of.atoms]) if is_judged else ()
    course = later_of(track) or track
    counted = of.counts if course.decided_at is None else ()
    holds = [np.broadcast_to(np.asarray(value(each.of.condition, steps), np.bool_), len(steps)) for each in counted]
    mask, numbers = not_numbers(of.guards, steps), None
    if mask is not None:
        numbers = np.flatnonzero(~mask)
        if ages and len(numbers) < len(steps):
            raise UnsupportedError("messages that make no step, from which ages count")
        if not len(numbers):
            return Stretch(steps, numbers, found)
        found = tuple(pack(unpack(bits, len(steps)).take(numbers)) for bits in found)
        holds = [each.take(numbers) for each in holds]
    times = steps.times if numbers is None else steps.times[numbers]
    counts = tuple(Count(each, course.monitor, of_it, times) for each, of_it in zip(counted, holds, strict=True))
    return Stretch(steps, numbers, (*found, *(pack(each.is_reached) for each in counts)), None, counts)


def has_ages(track: Course) -> bool:
    """Whether messages renew ages that the property asks for."""
    return bool(track.property.ages) or any(event.ages for event in track.property.events)


def values_at(track: Course, steps: Steps, step: int) -> list[object]:
    """The values of the inputs of a property at one of `steps`."""
    return [steps.value(wanted, step) for wanted in track.property.inputs]


def count_invalid(track: Track, found: Stretch) -> None:
    """Count the messages that make no step by reason, in the order in which the reasons came up."""
    if found.numbers is None:
        return
    mask = np.ones(len(found.steps), np.bool_)
    mask[found.numbers] = False
    invalid = np.flatnonzero(mask)
    reasons: dict[str, list[int]] = {}
    for text, steps in _reasons(track, found.steps, invalid):
        reasons.setdefault(text, []).extend(steps.tolist())
    for text, numbers in sorted(reasons.items(), key=lambda item: min(item[1], default=0)):
        if numbers:
            track.invalid_because[text] += len(numbers)
    track.monitor.invalid += len(invalid)


def _reasons(track: Track, steps: Steps, invalid: Places) -> Iterator[tuple[str, Places]]:
    """Why the messages `invalid` make no step."""
    inputs = track.property.inputs
    columns = [steps.column(wanted) for wanted in inputs if not steps.is_array(wanted)]
    masks = [np.isnan(column[invalid]) for column in columns if column.dtype == np.float64]
    is_input = np.logical_or.reduce(masks) if masks else np.zeros(len(invalid), np.bool_)
    nothing = invalid[~is_input]
    if is_input.any():
        first = int(invalid[is_input.argmax()])
        yield reason_of_none(track.property, values_at(track, steps, first)), invalid[is_input]
    if len(columns) == len(inputs) and len(nothing):
        yield reason_of_none(track.property, values_at(track, steps, int(nothing[0]))), nothing
        return
    for number in range(len(nothing)):
        part = nothing[number : number + 1]
        yield reason_of_none(track.property, values_at(track, steps, int(part[0]))), part


@dataclass(frozen=True)
class Forward:
    """Takes a property forward by its `tables`."""

    track: Course
    of: Prepared
    tables: Tables

    @property
    def can_leap(self) -> bool:
        """Whether nothing but a verdict for good is waited for, or the next violation."""
        lasts = isinstance(self.track, Later) and self.track.lasts
        return self.track.decided_at is None and not lasts

    def finish(self, passed: Passed, found: Stretch) -> None:
        """Take the steps of `found` with their table entries, and the one that decides by itself."""
        track, steps, base = self.track, found.steps, self.track.steps
        self.restore(passed, found)
        if passed.steps < len(found):
            step = found.number(passed.steps)
            track.step(steps.time(step), values_at(track, steps, step))
        track.steps = base + len(found)

    def state(self) -> int:
        """The number of the state that the track is in."""
        track = self.track
        episodes = _in_order(track.property.scopes, track.scopes)
        is_open = sum(1 << number for number, one in enumerate(episodes) if one is not None and one.is_open)
        return self.tables.machine.numbers[track.monitor.state if track.steps else -1, is_open]

    def restore(self, passed: Passed, found: Stretch) -> None:
        """Put the track in the state after the steps that were passed."""
        if not passed.steps:
            return
        track = self.track
        if isinstance(track, Track) and track.began is None:
            track.began = found.steps.time(found.number(0))
        track.monitor.state, is_open = self.tables.machine.states[passed.state]
        track.monitor.verdict = track.verdict = self.of.states[track.monitor.state].verdict
        if passed.changed >= 0:
            since = self._moment(passed.changed, found)
            track.owe(since.step, since.time)
        if self.of.slots:
            self._reopen(passed, is_open, found)
        track.steps += passed.steps
        track.judged_on = values_at(track, found.steps, found.number(passed.steps - 1))

    def _moment(self, step: int, found: Stretch) -> Moment:
        return Moment(self.track.steps + step, found.steps.time(found.number(step)))

    def _reopen(self, passed: Passed, is_open: int, found: Stretch) -> None:
        """Put the scopes of the track in the state after the steps that were passed."""
        numbers = iter(range(len(self.of.slots)))

        def visit(one: Episodes | None, scope: Scope, since: int) -> None:
            """A scope, in the body of one that opened at the step `since`, if any did, and those in its own body."""
            number = next(numbers)
            opened = passed.opened[number]
            if one is not None:
                if opened >= since:
                    moment = self._moment(opened, found)
                    one.opened = Opening(moment.step, moment.time, scope.text)
                    one.inner = [Episodes(inner) for inner in scope.inner]
                    since = opened
                one.is_open = bool(is_open >> number & 1)
                is_outer = self.of.slots[number].parent is None
                one.count = one.count + self._count(number, passed, found) if is_outer else int(one.opened is not None)
            inside = one.inner if one is not None and one.inner else [None] * len(scope.inner)
            for inner, part in zip(inside, scope.inner, strict=True):
                visit(inner, part, since)

        for one in self.track.scopes:
            visit(one, one.scope, 0)

    def _count(self, number: int, passed: Passed, found: Stretch) -> int:
        """How many episodes of a scope opened."""
        slot = self.of.slots[number]
        if not slot.overlapping:
            return passed.counts[number]
        pairs = zip(self.of.atoms, found.atoms, strict=False)  # Behind atoms there are counts.
        holds = {atom.name: unpack(bits, passed.steps) for atom, bits in pairs}
        opens = predicate(slot.opening, holds)
        closes = predicate(slot.closing, holds) if slot.closing is not None else np.False_
        return int(np.count_nonzero(np.broadcast_to(opens & ~closes, passed.steps)))


def take_together(properties: Iterable[tuple[Forward, Stretch]]) -> None:
    """Take steps with several properties, those with equal tables and as many steps together."""
    groups: dict[tuple[int, int], list[tuple[Forward, Stretch]]] = {}
    for forward, found in properties:
        if forward.track.decided_at is None and len(found):
            groups.setdefault((id(forward.tables), len(found)), []).append((forward, found))
        else:
            forward.track.steps += len(found)
    for (_, count), members in groups.items():
        for numbers in batches([found.atoms for _, found in members]):
            batch = [members[number] for number in numbers]
            columns, states = [found.atoms for _, found in batch], [forward.state() for forward, _ in batch]
            for passed, (forward, found) in zip(run(batch[0][0].tables, columns, count, states), batch, strict=True):
                forward.finish(passed, found)


def _in_order(scopes: Sequence[Scope], episodes: Sequence[Episodes]) -> Iterator[Episodes | None]:
    """The episodes of `scopes`, each before those in its body; None where there were none yet."""
    for number, scope in enumerate(scopes):
        one = episodes[number] if episodes else None
        yield one
        yield from _in_order(scope.inner, one.inner if one is not None else ())
