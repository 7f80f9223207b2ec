"""A property of each id by columns: its slices are followed one after the other, as if they were one run.

What is known of a slice between two blocks is a state and some numbers, until the slices `settle`: then there are
tracks, as if all had gone row by row, and that is how it goes on. A track is also made for a slice in which a clock
comes due, and takes the rest of the block by itself; and for the step that violates the property.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from itertools import chain

import numpy as np

from ltlc.inputs.recordings.blocks import Block, Places
from ltlc.monitoring.columns.alone import Place, take_alone
from ltlc.monitoring.columns.elements import Elements, elements
from ltlc.monitoring.columns.following import follow
from ltlc.monitoring.columns.ids import Runs
from ltlc.monitoring.columns.known import Known
from ltlc.monitoring.columns.messages import messages_of
from ltlc.monitoring.columns.others import Others
from ltlc.monitoring.columns.prepared import Prepared
from ltlc.monitoring.columns.series import UnsupportedError
from ltlc.monitoring.columns.tables import Tables
from ltlc.monitoring.columns.taken import Part, Taken, Violated
from ltlc.monitoring.columns.tracks import Stretch, count_invalid
from ltlc.runtime.properties import Moment
from ltlc.runtime.session import Plan
from ltlc.runtime.slice_ids import Slice
from ltlc.runtime.slice_keys import Id
from ltlc.runtime.slice_steps import Slices
from ltlc.runtime.times import NEVER
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.verdicts import Verdict

OWED = list(Verdict).index(Verdict.PRESUMABLY_VIOLATED)
WELL = list(Verdict).index(Verdict.SATISFIED)


def refusal(plan: Plan, slices: Slices, of: Prepared, others: Others) -> str:
    """Why columns cannot judge a property of each id that reads `others`; empty if they can."""
    property_, cut = slices.track.property, slices.cut
    reasons = {
        "a rate or a timeout": plan.rate is not None or plan.timeout is not None,
        "messages that open instances": not cut.keys,
        "several keys": len(cut.keys) > 1,
        "ids in arrays": any(key.elements or key.gone for key in cut.keys.values()),
        "a limit on ids": slices.ids.limit is not None,
        "scopes": bool(property_.scopes),
        "history of slices": bool(cut.deep),
        "signals that are waited for": bool(property_.excused),
        "its conditions": of.tables is None or not of.tables.machine.rests,
        "what is counted": bool(of.counts),
        "a picture of it": slices.track.observer is not None,
    }
    return next((reason for reason, is_so in reasons.items() if is_so), "") or others.refusal()


class BySlices:
    """Judges a property for each id by columns, until its `slices` settle."""

    def __init__(self, slices: Slices, of: Prepared, tables: Tables, read: Sequence[str], others: Others) -> None:
        """The signals `read` are those on the topic that is sliced."""
        self.slices = slices
        self._of = of
        self._tables = tables
        self._read = read
        self._known = Known(slices, of, tables.machine)
        self._others = others
        self._count = self._owed = 0

    def take(self, block: Block) -> None:
        """Take the rows of `block`, of which there is one. Raises UnsupportedError; then nothing has changed."""
        [key] = self.slices.cut.keys.values()
        own = messages_of(block, self.slices.cut, key, self._read, self._of, self._others.atoms)
        shared = self._others.of(block)
        if own.invalid is not None and (self._tables.clocks or shared.signals):
            raise UnsupportedError("messages that make no step, and clocks or topics that are not sliced")
        if self.slices.cut.own_ages and len(own) and own.rows[0] < shared.first:
            raise UnsupportedError("messages that make no step, from which ages count")
        ids = self.slices.ids
        self._known.require(own.latest)
        ids.messages += len(own)
        ids.without_id += own.without_id
        numbers = self._known.number(own.ids)
        for messages in elements(own, shared, self._known, numbers):
            self._take(messages)
        self._others.keep(shared)

    def _take(self, messages: Elements) -> None:
        """Take some messages."""
        known, runs = self._known, messages.runs
        known.begin(runs.numbers, self._count + runs.order.take(runs.firsts))
        taken = self._follow(messages, messages.steps, messages.until)
        for part in taken.parts:
            self._advance(part)
            if self._known.dues and taken.is_disturbed:
                self._see(messages, part.followed.runs, part.taken)
        self._number(taken, runs)
        for part in taken.parts:
            self._date(taken, part)
            self._decide(taken, part)
        for number, those in taken.alone.items():
            self._take_alone(taken, number, those)
        self._see(messages, runs, None)
        self._conclude(taken)
        self._count += len(messages)

    def _see(self, messages: Elements, runs: Runs, at: Places | None) -> None:
        """The slices of the `runs` at these places, None for all, know their last messages with an id."""
        lasts, numbers = messages.lasts.take(runs.lasts), runs.numbers
        if messages.shared.signals:
            has_one = np.flatnonzero(lasts >= 0)
            at = has_one if at is None else np.intersect1d(at, has_one, assume_unique=True)
        if at is not None:
            lasts, numbers = lasts.take(at), numbers.take(at)
        self._known.see(numbers, messages.own.latest, lasts)
        if messages.shared.signals:
            self._known.letters[numbers] = messages.shared.held(messages.own.letters).take(lasts)

    def _slice(self, taken: Taken, number: int, message: int | None, time: Nanoseconds = 0) -> Slice:
        """A slice as it is before a message, or, for None, at the end; before its first step, it begins at `time`."""
        messages = taken.messages
        messages.shared.load(self.slices.cut, messages.end - 1 if message is None else int(messages.rows[message]) - 1)
        return self._known.slice(number, time)

    def _follow(self, messages: Elements, runs: Runs, until: int) -> Taken:
        """Follow `runs` up to where a clock comes due; from there on, slices alone."""
        known, parts, alone = self._known, [], {}
        if len(runs.numbers):
            followed = follow(self._tables, runs, messages.letters, known.states[runs.numbers])
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
                followed = follow(self._tables, before, messages.letters, known.states[before.numbers])
                dues, _ = followed.dues(messages.times, [due[before.numbers] for due in known.dues], until)
                parts.append(Part(followed, dues, np.ones(len(before.numbers), np.bool_)))
        if known.dues:
            silent = np.setdiff1d(np.flatnonzero(known.next < until), runs.numbers, assume_unique=True)
            alone |= dict.fromkeys(silent.tolist(), runs.order[:0])
        return Taken(messages, parts, alone, self._owed)

    def _advance(self, part: Part) -> None:
        """Put slices into the states after the messages that they took, and before that which decides them."""
        known, groups, runs = self._known, part.followed.groups, part.followed.runs
        numbers, states = runs.numbers.take(part.taken), groups.lasts.take(part.going)
        is_owed = self._tables.machine.outputs == OWED
        self._owed -= int(np.count_nonzero(is_owed.take(known.states.take(numbers))))
        self._owed += int(np.count_nonzero(is_owed.take(states)))
        known.states[runs.numbers.take(part.going)] = states
        if not known.dues:
            return
        for due, after in zip(known.dues, part.dues, strict=True):
            due[numbers] = after.take(part.taken)
        known.next[numbers] = np.minimum.reduce([due.take(numbers) for due in known.dues])

    def _number(self, taken: Taken, runs: Runs) -> None:
        """Count the messages that make a step, and those that do not."""
        messages, track = taken.messages, self.slices.track
        late = self._late(taken, runs)
        if messages.invalid is None and not messages.early and not len(late):
            taken.steps = np.arange(track.steps, track.steps + len(messages) + 1)
        else:
            is_counted = np.ones(len(messages), np.bool_)
            is_counted[: messages.early] = is_counted[late] = False
            if messages.invalid is not None:
                is_none = np.zeros(len(messages.own), np.bool_)
                is_none[messages.lasts[is_counted & messages.invalid]] = True
                count_invalid(track, Stretch(messages.own.steps, np.flatnonzero(~is_none), ()))
                is_counted &= ~messages.invalid
            taken.steps = track.steps + np.concatenate(([0], is_counted.cumsum()))
        track.steps = int(taken.steps[-1])

    def _late(self, taken: Taken, runs: Runs) -> Places:
        """The messages of `runs` after those that decide them."""
        if not taken.is_disturbed:
            return runs.order[:0]
        lasts, numbers = np.full(len(runs.numbers), len(taken.messages)), np.arange(len(taken.messages))
        for part in taken.parts:
            at, steps, _ = part.followed.decisions
            at, steps = at[part.are_taken[at]], steps[part.are_taken[at]]
            of = part.followed.runs
            lasts[runs.numbers.searchsorted(of.numbers[at])] = of.message(at, steps)
        for number, those in taken.alone.items():
            tried = self._slice(taken, number, _first(those))
            count = take_alone(self.slices, tried, taken.messages, those, numbers, taken.messages.until).count
            if count < len(those):
                lasts[runs.numbers.searchsorted(number)] = those[count] - 1
        if (lasts == len(taken.messages)).all():
            return runs.order[:0]
        return runs.order[runs.order > lasts.repeat(runs.lengths)]

    def _date(self, taken: Taken, part: Part) -> None:
        """Note when what became of slices that are not decided did."""
        known, machine, groups, runs = self._known, self._tables.machine, part.followed.groups, part.followed.runs
        known.stepped[runs.numbers.take(part.going)] = taken.steps.take(runs.lasts.take(part.going))
        is_going = np.zeros(len(runs.numbers), np.bool_)
        is_going[part.going] = True
        changed = groups.last(self._tables.changes, is_going & (machine.outputs == OWED).take(groups.lasts))
        at = np.flatnonzero(changed >= 0)
        since, numbers = runs.message(at, changed[at]), runs.numbers[at]
        known.owed[numbers], known.owed_at[numbers] = taken.steps[since], taken.messages.times[since]
        taken.opened.append(since)
        if self._tables.returns is not None:
            returned = groups.last(self._tables.returns, is_going & ~machine.as_new.take(groups.lasts))
            at = np.flatnonzero(returned >= 0)
            known.begins[runs.numbers[at]] = self._count + runs.message(at, returned[at])

    def _decide(self, taken: Taken, part: Part) -> None:
        """Take the steps that decide slices."""
        groups, runs = part.followed.groups, part.followed.runs
        places, steps, states = part.followed.decisions
        is_well = self._tables.machine.outputs[states] == WELL
        well = runs.numbers[places[is_well & part.are_taken[places]]]
        self.slices.ids.satisfied.update(map(self._known.numbers.id, well.tolist()))
        at = np.flatnonzero(~is_well & part.are_taken[places])
        is_violated = np.zeros(len(runs.numbers), np.bool_)
        is_violated[places[at]] = True
        changed = groups.last(self._tables.changes, is_violated)
        for place, message in zip(places[at].tolist(), runs.message(places[at], steps[at]).tolist(), strict=True):
            passed, number = part.followed.before(place, int(changed[place])), int(runs.numbers[place])
            self._known.states[number] = passed.state
            if passed.changed >= 0:
                since = runs.run(place)[passed.changed]
                self._known.owed[number], self._known.owed_at[number] = taken.steps[since], taken.messages.times[since]
            self._violate(taken, number, message)
        self._known.decide(runs.numbers[places[part.are_taken[places]]])

    def _violate(self, taken: Taken, number: int, message: int) -> None:
        """Take the step by which a slice is violated."""
        time = int(taken.messages.times[message])
        one = self._slice(taken, number, message, time)
        one.steps = int(taken.steps[message])
        if taken.messages.is_own[message]:
            one.hear(time, self.slices.cut.own_ages)
        one.step(time, taken.messages.values(self.slices.cut, message, one))
        assert one.decided_at is not None
        begins = int(self._known.begins[number])
        taken.violated.append(((2 * message + 1, time), begins, one, one.decided_at))

    def _take_alone(self, taken: Taken, number: int, those: Places) -> None:
        """Have a slice take messages by itself."""
        known, one = self._known, self._slice(taken, number, _first(those))
        since = one.open_since
        alone = take_alone(self.slices, one, taken.messages, those, taken.steps, taken.messages.until)
        for place, change in alone.changes:
            change_ = (change.current is Verdict.PRESUMABLY_VIOLATED) - (change.previous is Verdict.PRESUMABLY_VIOLATED)
            taken.changes.append((place, change_))
            self._owed += change_
        if alone.returned is not None:
            known.begins[number] = self._count + alone.returned
        if one.decided_at is not None:
            known.decide(number)
            if one.verdict is Verdict.VIOLATED:
                taken.violated.append((alone.changes[-1][0], int(known.begins[number]), one, one.decided_at))
            else:
                self.slices.ids.satisfied.add(one.id)
            return
        known.put(number, one)
        if one.open_since not in (None, since):
            taken.opened.append(np.array([alone.changes[-1][0][0] >> 1]))

    def _conclude(self, taken: Taken) -> None:
        """The verdict of the whole."""
        ids, track = self.slices.ids, self.slices.track
        for _, _, one, failure in sorted(taken.violated, key=_in_order):
            ids.count(one)
            ids.decide(one, failure)
        if ids.violated:
            track.decided_at = next(iter(ids.violated.values())).failure
            track.verdict = Verdict.VIOLATED
        elif self._owed:
            if (since := self._since(taken)) is not None:
                track.owe(since.step, since.time, by_time=since.by_time)
            track.verdict = Verdict.PRESUMABLY_VIOLATED
        elif track.steps:
            track.verdict = Verdict.PRESUMABLY_SATISFIED

    def _since(self, taken: Taken) -> Moment | None:
        """Since when an obligation has been open in any slice; None if since before."""
        opened = np.concatenate([np.empty(0, np.int64), *taken.opened])
        if len(opened) < self._owed:
            return None
        rows = np.append(taken.messages.rows, taken.messages.end)  # time may open one after all messages
        until = int(rows.searchsorted(rows[opened.min()], "right"))
        found = [(np.array([key]), np.array([time]), np.array([by])) for (key, time), by in taken.changes]
        found += chain.from_iterable(map(partial(self._changes, taken, until), taken.parts))
        keys, times, changes = (np.concatenate(column) for column in zip(*found, strict=True))
        keys = 2 * rows[keys >> 1] + (keys & 1)
        order = np.lexsort((times, keys))
        keys, times, counts = keys[order], times[order], taken.owed + changes[order].cumsum()
        is_last = np.append((keys[1:] != keys[:-1]) | (times[1:] != times[:-1]), True)
        keys, times, counts = keys[is_last], times[is_last], counts[is_last]
        rises = np.flatnonzero((counts > 0) & (np.concatenate(([taken.owed], counts[:-1])) == 0))
        if not len(rises):
            return None
        key, time = int(keys[rises[-1]]), int(times[rises[-1]])
        step = int(taken.steps[rows.searchsorted((key + 1) >> 1)]) - 1
        return Moment(max(0, step), time, by_time=not key % 2)

    def _changes(self, taken: Taken, until: int, part: Part) -> Iterator[tuple[Places, Places, Places]]:
        """Where in slices an obligation is open from a step on, or no more, and when, before some message."""
        runs, outputs = part.followed.runs, self._tables.machine.outputs
        begin_before = part.are_taken & (runs.order.take(runs.firsts) < until)
        for places, steps, before, after in part.followed.groups.changes(begin_before):
            change = (outputs[after] == OWED).astype(np.int64) - (outputs[before] == OWED)
            messages = runs.message(places, steps)
            at = np.flatnonzero((change != 0) & (messages < until))
            yield 2 * messages[at] + 1, taken.messages.times[messages[at]], change[at]

    def settle(self) -> None:
        """Have tracks of the slices that are kept, as if rows had judged them; no more is taken here."""
        known = self._known
        self.slices.ids.meet(known.numbers.ids(), has_started=self.slices.track.steps > 0)
        for number in known.kept().tolist():
            self.slices.keep(known.slice(number))
        self._known = Known(self.slices, self._of, self._tables.machine)


def _in_order(violated: Violated) -> tuple[Place, Id]:
    """By what violations are ordered, as by rows: those of a clock at one time by their ids, of a step by age."""
    place, begins, one, failure = violated
    return place, one.id if failure.by_time else begins


def _first(messages: Places) -> int | None:
    return int(messages[0]) if len(messages) else None
