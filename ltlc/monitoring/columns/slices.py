"""A property of each id by columns: its slices are followed one after the other, as if they were one run.

What is known of a slice between two blocks is a state and some numbers, until the slices `settle`: then there are
tracks, as if all had gone row by row, and that is how it goes on. A track is also made for a slice in which a clock
comes due, and takes the rest of the block by itself; and for the step that violates the property.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import chain

import numpy as np

from ltlc.inputs.recordings.blocks import Block, Places
from ltlc.monitoring.columns.alone import Place, take_alone
from ltlc.monitoring.columns.bits import Mask
from ltlc.monitoring.columns.following import Followed, follow
from ltlc.monitoring.columns.ids import Runs, runs_in, runs_of
from ltlc.monitoring.columns.known import Known
from ltlc.monitoring.columns.messages import Messages, messages_of
from ltlc.monitoring.columns.prepared import Prepared
from ltlc.monitoring.columns.series import UnsupportedError
from ltlc.monitoring.columns.tables import Tables
from ltlc.monitoring.columns.tracks import Stretch, count_invalid
from ltlc.runtime.session import Plan
from ltlc.runtime.slice_ids import Slice
from ltlc.runtime.slice_steps import Slices
from ltlc.runtime.times import NEVER
from ltlc.runtime.tracking import Failure, Moment
from ltlc.semantics.verdicts import Verdict

OWED = list(Verdict).index(Verdict.PRESUMABLY_VIOLATED)
WELL = list(Verdict).index(Verdict.SATISFIED)


@dataclass(frozen=True)
class Part:
    """Those of the runs that were `followed` of which `are_taken` is true; their clocks are then due at `dues`."""

    followed: Followed
    dues: Sequence[Places]
    are_taken: Mask


@dataclass
class Taken:
    """What a block has done: the `parts`, by number the messages that slices take by themselves, and what came of it.

    Something was `owed` in so many slices before it. `steps` has the number of the step that each message is, or, if it
    is none, of that after it. `opened` has the messages from which on something is owed.
    """

    messages: Messages
    until: int
    parts: Sequence[Part]
    alone: Mapping[int, Places]
    owed: int
    steps: Places = field(default_factory=lambda: np.empty(0, np.int64))
    opened: list[Places] = field(default_factory=list)
    changes: list[tuple[Place, int]] = field(default_factory=list)
    violated: list[tuple[Place, int, Slice, Failure]] = field(default_factory=list)


def refusal(plan: Plan, slices: Slices, of: Prepared) -> str:
    """Why columns cannot judge a property of each id; empty if they can."""
    property_, cut = slices.track.property, slices.cut
    topics = frozenset().union(*cut.sampler.topics.values())
    reasons = {
        "a rate or a timeout": plan.rate is not None or plan.timeout is not None,
        "several keys": len(cut.keys) > 1,
        "ids in arrays": any(key.elements or key.gone for key in cut.keys.values()),
        "a limit on ids": slices.ids.limit is not None,
        "scopes": bool(property_.scopes),
        "topics that are not sliced": not topics <= cut.keys.keys(),
        "history of slices": bool(cut.deep),
        "signals that are waited for": bool(property_.excused),
        "its conditions": of.tables is None or not of.tables.machine.rests,
        "a picture of it": slices.track.observer is not None,
    }
    return next((reason for reason, is_so in reasons.items() if is_so), "")


class BySlices:
    """Judges a property for each id by columns, until its `slices` settle."""

    def __init__(self, slices: Slices, of: Prepared, tables: Tables, read: Sequence[str]) -> None:
        """The signals `read` are those on the topic that is sliced."""
        self.slices = slices
        self._of = of
        self._tables = tables
        self._read = read
        self._known = Known(slices, of, tables.machine)
        self._count = self._owed = 0

    def take(self, block: Block) -> None:
        """Take the rows of `block`, of which there is one. Raises UnsupportedError; then nothing has changed."""
        [key] = self.slices.cut.keys.values()
        messages = messages_of(block, self.slices.cut, key, self._read, self._of)
        if messages.invalid is not None and self._tables.clocks:
            raise UnsupportedError("messages that make no step, and clocks")
        known, ids = self._known, self.slices.ids
        known.require(messages.latest)
        ids.messages += len(messages)
        ids.without_id += messages.without_id
        numbers = known.number(messages.ids)
        was_decided = known.is_decided.take(numbers)
        runs = self._runs(messages, numbers, was_decided)
        taken = self._follow(messages, self._valid(messages, runs, numbers), int(block.times[-1]))
        for part in taken.parts:
            self._advance(messages, part)
        self._number(taken, numbers, was_decided)
        for part in taken.parts:
            self._date(taken, part)
        for number, those in taken.alone.items():
            self._take_alone(taken, number, those)
        known.see(runs.numbers, messages.latest, runs.lasts())
        self._conclude(taken)
        self._count += len(messages)

    def _runs(self, messages: Messages, numbers: Places, was_decided: Mask) -> Runs:
        """The messages of slices that are not decided before."""
        at = np.flatnonzero(~was_decided) if was_decided.any() else np.arange(len(messages))
        runs = runs_of(at, numbers.take(at))
        self._known.begin(runs.numbers, self._count + runs.order.take(runs.firsts))
        return runs

    def _valid(self, messages: Messages, runs: Runs, numbers: Places) -> Runs:
        """Those of the `runs`, of messages with the ids `numbers`, that are steps."""
        if messages.invalid is None:
            return runs
        order = runs.order[~messages.invalid.take(runs.order)]
        return runs_in(order, numbers.take(order))

    def _follow(self, messages: Messages, runs: Runs, until: int) -> Taken:
        """Follow `runs` up to where a clock comes due; from there on, slices alone."""
        known, parts, alone = self._known, [], {}
        if len(runs.numbers):
            followed = follow(self._tables, runs, messages.atoms, known.states[runs.numbers])
            dues, first = followed.dues(messages.times, [due[runs.numbers] for due in known.dues], until)
            parts.append(Part(followed, dues, first == NEVER))
            late = np.flatnonzero(first < NEVER)
            counts = np.zeros(len(late), np.int64)
            for place, at in enumerate(late.tolist()):
                run = runs.run(at)
                counts[place] = messages.times[run].searchsorted(first[at], "right")
                alone[int(runs.numbers[at])] = run[counts[place] :]
            if counts.any():
                before = runs.taken(late[counts > 0], counts[counts > 0])
                followed = follow(self._tables, before, messages.atoms, known.states[before.numbers])
                dues, _ = followed.dues(messages.times, [due[before.numbers] for due in known.dues], until)
                parts.append(Part(followed, dues, np.ones(len(before.numbers), np.bool_)))
        silent = np.setdiff1d(np.flatnonzero(known.next < until), runs.numbers, assume_unique=True)
        alone |= dict.fromkeys(silent.tolist(), runs.order[:0])
        return Taken(messages, until, parts, alone, self._owed)

    def _advance(self, messages: Messages, part: Part) -> None:
        """Put slices into the states after the messages that they took."""
        known, groups, numbers = self._known, part.followed.groups, part.followed.runs.numbers
        outputs = self._tables.machine.outputs
        going = np.flatnonzero(part.are_taken & (groups.deciding < 0))
        of, states = numbers[going], groups.lasts[going]
        taken = numbers[part.are_taken]
        self._owed -= int(np.count_nonzero(outputs[known.states[taken]] == OWED))
        self._owed += int(np.count_nonzero(outputs[states] == OWED))
        known.states[of] = states
        for due, after in zip(known.dues, part.dues, strict=True):
            due[taken] = after[part.are_taken]
        if known.dues:
            known.see(taken, messages.latest, part.followed.runs.lasts()[part.are_taken])
            known.next[of] = np.minimum.reduce([due[of] for due in known.dues])
        at, _, _ = part.followed.decisions
        known.decide(numbers[at[part.are_taken[at]]])

    def _number(self, taken: Taken, numbers: Places, was_decided: Mask) -> None:
        """Count the messages that are steps, and those that are none."""
        messages, track = taken.messages, self.slices.track
        lasts = np.full(len(self._known.states), len(messages))
        for part in taken.parts:
            at, steps, _ = part.followed.decisions
            is_taken = part.are_taken[at]
            runs, at, steps = part.followed.runs, at[is_taken], steps[is_taken]
            lasts[runs.numbers[at]] = runs.message(at, steps)
        for number, those in taken.alone.items():
            tried, steps_ = self._known.slice(number), np.arange(len(messages))
            count = take_alone(self.slices, tried, messages, those, steps_, taken.until).count
            if count < len(those):
                lasts[number] = those[count] - 1
        if messages.invalid is None and not was_decided.any() and (lasts == len(messages)).all():
            taken.steps = track.steps + np.arange(len(messages) + 1)
        else:
            is_counted = ~was_decided & (np.arange(len(messages)) <= lasts.take(numbers))
            if messages.invalid is not None:
                counted = np.flatnonzero(~(is_counted & messages.invalid))
                count_invalid(track, Stretch(messages.steps, counted, ()))
                is_counted &= ~messages.invalid
            taken.steps = track.steps + np.concatenate(([0], is_counted.cumsum()))
        track.steps = int(taken.steps[-1])

    def _date(self, taken: Taken, part: Part) -> None:
        """Note when what became of slices did, and take the steps that violate the property."""
        known, messages, machine = self._known, taken.messages, self._tables.machine
        followed, runs, steps = part.followed, part.followed.runs, taken.steps
        going = np.flatnonzero(part.are_taken & (followed.groups.deciding < 0))
        numbers = runs.numbers[going]
        known.stepped[numbers] = steps[runs.lasts()[going]]
        is_owed = (machine.outputs[followed.groups.lasts[going]] == OWED) & (followed.changed[going] >= 0)
        at = going[is_owed]
        since = runs.message(at, followed.changed[at])
        taken.opened.append(since)
        known.owed[runs.numbers[at]], known.owed_at[runs.numbers[at]] = steps[since], messages.times[since]
        if self._tables.returns is not None:
            returned = followed.groups.last(self._tables.returns)[going]
            at = going[returned >= 0]
            known.begins[runs.numbers[at]] = self._count + runs.message(at, returned[returned >= 0])
        places, deciding, states = followed.decisions
        for place, step, state in zip(places.tolist(), deciding.tolist(), states.tolist(), strict=True):
            if not part.are_taken[place]:
                continue
            number, message = int(runs.numbers[place]), int(runs.order[runs.firsts[place] + step])
            if machine.outputs[state] == WELL:
                self.slices.ids.satisfied.add(known.numbers.id(number))
                continue
            passed = followed.before(place)
            known.states[number] = passed.state
            if passed.changed >= 0:
                since_ = int(runs.order[runs.firsts[place] + passed.changed])
                known.owed[number], known.owed_at[number] = steps[since_], messages.times[since_]
            if known.dues:
                known.next[number] = min(int(due[number]) for due in known.dues)
            time = int(messages.times[message])
            one = known.slice(number, time)
            known.next[number] = NEVER
            one.track.steps = int(steps[message])
            one.track.hear(time, self.slices.cut.own_ages)
            one.track.step(time, messages.values(message, one.id))
            assert one.track.decided_at is not None
            taken.violated.append(((2 * message + 1, time), int(known.begins[number]), one, one.track.decided_at))

    def _take_alone(self, taken: Taken, number: int, those: Places) -> None:
        """Have a slice take messages by itself."""
        known, one = self._known, self._known.slice(number)
        track, since = one.track, one.track.open_since
        alone = take_alone(self.slices, one, taken.messages, those, taken.steps, taken.until)
        for place, change in alone.changes:
            change_ = (change.current is Verdict.PRESUMABLY_VIOLATED) - (change.previous is Verdict.PRESUMABLY_VIOLATED)
            taken.changes.append((place, change_))
            self._owed += change_
        if alone.returned is not None:
            known.begins[number] = self._count + alone.returned
        if track.decided_at is not None:
            known.decide(number)
            if track.verdict is Verdict.VIOLATED:
                taken.violated.append((alone.changes[-1][0], int(known.begins[number]), one, track.decided_at))
            else:
                self.slices.ids.satisfied.add(one.id)
            return
        known.put(number, track)
        if track.open_since is not None and track.open_since is not since:
            taken.opened.append(np.array([alone.changes[-1][0][0] >> 1]))

    def _conclude(self, taken: Taken) -> None:
        """The verdict of the whole."""
        ids, track = self.slices.ids, self.slices.track
        for _, _, one, failure in sorted(taken.violated, key=lambda each: each[:2]):
            ids.count(one)
            ids.decide(one, failure)
        if ids.violated:
            track.decided_at = next(iter(ids.violated.values())).failure
            track.verdict, track.open_since = Verdict.VIOLATED, None
        elif self._owed:
            track.verdict, track.open_since = Verdict.PRESUMABLY_VIOLATED, self._since(taken)
        elif track.steps:
            track.verdict, track.open_since = Verdict.PRESUMABLY_SATISFIED, None

    def _since(self, taken: Taken) -> Moment | None:
        """From when on something has been owed in some slice, whichever."""
        opened = np.concatenate([np.empty(0, np.int64), *taken.opened])
        if len(opened) < self._owed:  # in some slice it has been since before
            return self.slices.track.open_since
        until = 2 * int(opened.min()) + 1
        found = [(np.array([key]), np.array([time]), np.array([by])) for (key, time), by in taken.changes]
        found += chain.from_iterable(map(partial(self._changes, taken, until), taken.parts))
        keys, times, changes = (np.concatenate(column) for column in zip(*found, strict=True))
        order = np.lexsort((times, keys))
        keys, times, counts = keys[order], times[order], taken.owed + changes[order].cumsum()
        is_last = np.append((keys[1:] != keys[:-1]) | (times[1:] != times[:-1]), True)
        keys, times, counts = keys[is_last], times[is_last], counts[is_last]
        rises = np.flatnonzero((counts > 0) & (np.concatenate(([taken.owed], counts[:-1])) == 0))
        if not len(rises):
            return self.slices.track.open_since
        key, time = int(keys[rises[-1]]), int(times[rises[-1]])
        step = int(taken.steps[(key + 1) >> 1]) - 1
        return Moment(max(0, step), time, by_time=not key % 2)

    def _changes(self, taken: Taken, until: int, part: Part) -> Iterator[tuple[Places, Places, Places]]:
        """Where in slices something is owed from a step on, or no more, and when, up to some place."""
        runs, outputs = part.followed.runs, self._tables.machine.outputs
        for places, steps, before, after in part.followed.groups.changes():
            change = (outputs[after] == OWED).astype(np.int64) - (outputs[before] == OWED)
            messages = runs.message(places, steps)
            at = np.flatnonzero((change != 0) & part.are_taken[places] & (2 * messages < until))
            yield 2 * messages[at] + 1, taken.messages.times[messages[at]], change[at]

    def settle(self) -> None:
        """Have tracks of the slices that are kept, as if rows had judged them; no more is taken here."""
        known = self._known
        self.slices.ids.meet(known.numbers.ids(), has_started=self.slices.track.steps > 0)
        for number in known.kept().tolist():
            self.slices.keep(known.slice(number))
        self._known = Known(self.slices, self._of, self._tables.machine)
