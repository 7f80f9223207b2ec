"""Slices of a run are judged: they are born, take steps, fall due, and are dropped."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from heapq import heappop, heappush

from ltlc.runtime.courses import Course
from ltlc.runtime.properties import Change, Moment, Monitor
from ltlc.runtime.sampling import Value, mark
from ltlc.runtime.session import Session
from ltlc.runtime.slice_ids import Ids, Slice
from ltlc.runtime.slice_keys import Cut, Id, Key, Part, Row, id_of
from ltlc.runtime.slice_openings import Openings
from ltlc.runtime.slice_reports import ToldSlices
from ltlc.runtime.times import NEVER
from ltlc.runtime.tracking import Track
from ltlc.semantics.verdicts import Verdict


class Slices(ToldSlices):
    """Judges a property for each id, in a `session` in which it is the `track`.

    The messages on sliced topics belong to the slice of their id, the others to all, as
    `cut` says. A slice begins with its first message, and with it the session of the
    slice; what other topics said before is known to it. A slice that is decided is
    dropped, and its id kept; one in a state in `as_new` is dropped without a trace, if
    no clock runs.

    Steps of the property are those of all slices, in their order. Where there are
    `openings`, messages open instances: slices that have all that comes from there on.
    Up to `soon`, no clock step comes, unless a step comes first.
    """

    def __init__(
        self,
        track: Track,
        session: Session,
        cut: Cut,
        ids: Ids,
        as_new: frozenset[int],
        openings: Openings | None = None,
    ) -> None:
        super().__init__(track, session, cut, ids, as_new)
        self.openings = openings
        self.soon = NEVER
        self._look = cut.window.values
        self._place = cut.window.place
        self._has_ages = bool(cut.ages)
        self._begins = 0
        self._is_recounted = False
        self._goes_by_time = track.property.timed or bool(track.property.events)
        self._last_heard: dict[str, int] = {}
        self._due: list[tuple[int, Id]] = []
        self._gone: dict[str, set[Id]] = {
            topic: set() for topic, key in cut.keys.items() if key.gone is not None
        }
        of = track.property
        has_more = bool(of.scopes or of.kept or of.events or cut.ages)
        can_pass = as_new and not has_more and session.plan.rate is None
        self._probe = self._fresh() if can_pass else None

    @property
    def left_out(self) -> int:
        """How many messages were not judged, because their id found no place."""
        return self.ids.left_out

    # What comes in.

    def begin(self, time: int) -> None:
        """The session begins."""
        self._begins = time
        if self.openings is not None:
            self.openings.before.begin(time)

    def first_step(self, time: int) -> list[Change]:
        """Step what begins with the session and has not: no message was a step."""
        if self.openings is None:
            return []
        before, changes = self.openings.before, list[Change]()
        if self._begins_now(before):
            self._step(time, before)
            self._settle(before)
        self._tell(time, changes)
        return changes

    def take(
        self, time: int, row: Row, values: Sequence[Value], changes: list[Change]
    ) -> None:
        """Samples and messages came in, all is held to then; `changes` grows."""
        if row.only is None:
            self._take_all(time, row, values)
        else:  # most rows are a message of one slice, and nothing else
            place, part = row.only
            value, ids = values[place], self.ids
            # Most values are ids; of bytes, the id has yet to be made.
            one = ids.slices.get(value)
            if one is not None:
                ids.messages += 1
            elif (id_ := ids.counted(value)) is not None:
                one = ids.slices.get(id_)
                if one is None and not self._passes(time, id_, part, values):
                    one = self._new(time, id_)
            if one is not None:
                self._give(time, one, part, values)
        if self._is_recounted or self.openings is not None:
            self._tell(time, changes)

    def _take_all(self, time: int, row: Row, values: Sequence[Value]) -> None:
        """A row has messages of some slices, of all, or of none."""
        reached: set[Id] = set()
        shared = row.shared
        if shared.topics:
            self._share(time, shared, values)
        for id_, part, given in self.cut.messages(row, values, self.ids.counted):
            one = self.ids.slices.get(id_) or self._new(time, id_)
            if one is not None:
                reached.add(id_)
                self._give(time, one, part, given)
        if row.opening is not None and (opened := self._open(time, row, values)):
            reached.add(opened.id)
        for key, place in row.keys:
            if key.gone is not None and place is not None:
                self._miss(time, key, key.gone, set(map(id_of, values[place])))
        if shared.topics:
            going_on = [s for s in self._going_on() if s.id not in reached]
            for one in self._changed(time, row.rest, going_on):
                self._give(time, one, row.rest, values)

    def _going_on(self) -> list[Slice]:
        """The slices that are not decided; after instances, the run before any."""
        before = () if self.openings is None else (self.openings.before,)
        return [*self.ids.slices.values(), *before]

    def _changed(self, time: int, part: Part, given: list[Slice]) -> list[Slice]:
        """Those of the slices that their part of a row may change; others have it."""
        if self.openings is None or not part.is_step:
            return given
        known = self.openings.before.known
        mark(known, part.news, is_new=True)
        values = self._look(known)
        mark(known, part.news, is_new=False)
        return self.openings.changed(time, values, self.track.steps, given)

    def _share(self, time: int, part: Part, given: Sequence[Value]) -> None:
        """Take what all slices share."""
        self._last_heard |= dict.fromkeys(part.aged, time)
        self.cut.sampler.hear(part.news)
        part.update.take(self.cut.sampler.known, time, given)
        self.cut.sampler.hear(())
        if self.cut.keys:
            for one in self.ids.slices.values():
                self.cut.share(one.known)

    def _miss(self, time: int, key: Key, name: str, here: set[Id | None]) -> None:
        """A message came with the ids that are `here`: all others are gone."""
        gone = self._gone[key.topic]
        gone -= here
        part = self.cut.gone_part(key, name)
        for one in list(self.ids.slices.values()):
            if one.id not in here and one.id not in gone:
                gone.add(one.id)
                self._give(time, one, part, (True,))

    def _is_before(self, one: Slice) -> bool:
        """Whether this is the run before any instance, rather than a slice."""
        return self.openings is not None and one is self.openings.before

    # Slices begin.

    def _open(self, time: int, row: Row, values: Sequence[Value]) -> Slice | None:
        """A message opens an instance, and is its first step."""
        assert self.openings is not None
        assert row.opening is not None
        one = self.openings.open()
        if one is not None:
            self._give(time, one, row.opening, values)
        return one

    def _new(self, time: int, id_: Id) -> Slice | None:
        """The slice of an id begins; None if it is decided, or finds no place."""
        if self.ids.is_decided(id_) or not self.ids.find_place():
            return None
        one = self._born(time, id_)
        one.counted = self.ids.calm
        if id_ in self.ids.forgotten:  # and all was well
            one.verdict = Verdict.PRESUMABLY_SATISFIED
        if self.ids.left_out:
            self.ids.lacking.add(id_)
        self.ids.keep(one)
        return one

    def _fresh(self) -> Monitor:
        """A monitor that has had no step."""
        of = self.track.property
        return of.monitor(self._begins) if of.timed else of.monitor()

    def _passes(self, time: int, id_: Id, part: Part, given: Sequence[Value]) -> bool:
        """Whether a slice that is not kept is as new after a message; it has taken it.

        Most messages are like that, and one monitor steps for all of these slices.
        """
        ids, whole, probe = self.ids, self.track, self._probe
        if probe is None or whole.verdicts is not None or not part.is_step:
            return False
        if ids.calm is Verdict.NOT_STARTED:
            return False
        is_met = id_ in ids.forgotten
        if not is_met and (ids.is_decided(id_) or not ids.has_place()):
            return False
        known = self.cut.known(id_)
        part.take(known, time, given)
        place = self._place
        values = (known[place],) if place >= 0 else self._look(known)
        if None in values:
            return False
        if whole.property.timed:
            verdict = probe.step(time, *values)
        else:
            verdict = probe.step(*values)
        is_well = verdict is Verdict.PRESUMABLY_SATISFIED and not probe.invalid
        is_still = not whole.property.timed or probe.due >= NEVER
        if not (is_well and is_still and probe.state in self.as_new):
            self._probe = self._fresh()
            return False
        whole.steps += 1
        if not is_met and ids.limit is None:
            ids.forgotten.add(id_)
        return True

    def _born(self, time: int, id_: Id) -> Slice:
        """A slice begins: ages of what is its own count from now."""
        of = self.track
        known, because = self.cut.known(id_), of.invalid_because
        one = Slice(id_, of.property, because, known, time)
        for signal in self.cut.shared_ages:
            one.hear(self._last_heard.get(signal, self._begins), {signal})
        return one

    # Slices that were judged elsewhere.

    def resumed(
        self, time: int, id_: Id, names: tuple[str, ...], values: Sequence[Value]
    ) -> Slice:
        """A slice that got these `values` last, and all of whose past is forgotten."""
        [topic] = self.cut.keys
        part = self.cut.own_part(self.cut.row(names, frozenset({topic})), (topic,))
        one = self._born(time, id_)
        part.take(one.known, time, values)
        one.judged_on = self._look(one.known)
        mark(one.known, part.news, is_new=False)
        return one

    def keep(self, one: Slice) -> None:
        """A slice goes on here, from what it has seen elsewhere."""
        self.ids.keep(one)
        self._settle(one)

    # Steps.

    def _give(self, time: int, one: Slice, part: Part, given: Sequence[Value]) -> None:
        """A slice gets its part of a row."""
        known = one.known
        if part.aged:
            one.hear(time, part.aged)
        part.take(known, time, given)
        if part.is_step or self._begins_now(one):
            self._step(time, one)
        if part.news:
            mark(known, part.news, is_new=False)
        if self._has_ages and one.is_renewed:
            one.renew(time)
        self._settle(one)

    def _begins_now(self, one: Slice) -> bool:
        """Whether the first step of a slice is now, whatever it gets."""
        return one.property.from_session and not one.steps and not one.invalid

    def _step(self, time: int, one: Slice) -> None:
        """A slice takes a step, if all has a value."""
        place, known, whole = self._place, one.known, self.track
        values = (known[place],) if place >= 0 else self._look(known)
        before = one.steps
        if not before and None in values and not one.property.is_ready(values):
            return
        one.steps = steps = whole.steps
        one.step(time, values)
        if self.openings is not None and not self._is_before(one):
            return
        if one.steps == steps:
            one.steps = before
            whole.monitor.invalid += 1
            return
        whole.steps = one.steps
        if not self.session.has_begun:
            self.session.begin_run(time)
        if whole.verdicts is not None:
            if one.verdict is not one.counted:
                self._recount(one)
            whole.verdicts.append(self.ids.verdict())
            whole.times.append(time)
            whole.values.append(one.judged_on)

    # Time.

    def hold(self, time: int) -> list[Change]:
        """Take the clock steps up to and including `time`, in their order."""
        changes: list[Change] = []
        until = min(time, self.session.end)
        while (last := self.soon) < until:
            while self._due and self._due[0][0] == last:
                one = self._kept(heappop(self._due)[1])
                if one is not None and one.scheduled == last:
                    one.scheduled = NEVER
                    one.hold(last + 1)
                    self._settle(one)
            self.soon = self._due[0][0] if self._due else NEVER
            self._tell(last + 1, changes, by_time=True)
        return changes

    def _kept(self, id_: Id) -> Slice | None:
        """The slice of an id, or the run before instances; None if it was dropped."""
        if self.openings is not None and id_ == self.openings.before.id:
            return self.openings.before
        return self.ids.slices.get(id_)

    def advance(self, time: int) -> list[Change]:
        """Take what is due by `time`."""
        return self.hold(time)

    # Verdicts.

    def _settle(self, one: Slice) -> None:
        """Count a slice, and drop it if it is decided, or as new."""
        verdict = one.verdict
        if verdict is Verdict.NOT_STARTED and self._withdraws(one):
            self._drop(one)
            return
        if verdict is not one.counted:
            self._recount(one)
        if one.monitor.state in self.as_new and self.is_as_new(one):
            self._forget(one)
            return
        if one.decided_at is not None and not self._is_before(one):
            self.ids.decide(one, one.decided_at)
            self._drop(one)
        elif self._goes_by_time and (until := one.until) < one.scheduled:
            one.scheduled = until
            heappush(self._due, (until, one.id))
            self.soon = self._due[0][0]

    def _withdraws(self, one: Slice) -> bool:
        """Whether a message opened nothing, for there was no step."""
        return self.openings is not None and self.openings.withdraws(one)

    def _recount(self, one: Slice) -> None:
        self.ids.count(one)
        self._is_recounted = True

    def _forget(self, one: Slice) -> None:
        """Drop a slice that is as new."""
        self._drop(one)
        if self.ids.limit is None:
            self.ids.forgotten.add(one.id)

    def is_as_new(self, one: Slice) -> bool:
        """Whether a slice need not be kept."""
        return (
            one.monitor.state in self.as_new
            and one.verdict is Verdict.PRESUMABLY_SATISFIED
            and (not self._goes_by_time or one.until >= NEVER)
        )

    def _drop(self, one: Slice) -> None:
        self.ids.slices.pop(one.id, None)
        self.ids.lacking.discard(one.id)
        for gone in self._gone.values():
            gone.discard(one.id)
        if self.track.scopes:
            for whole, scope in zip(self.track.scopes, one.scopes, strict=True):
                whole.count += scope.count

    def _tell(self, time: int, changes: list[Change], *, by_time: bool = False) -> None:
        """What has become of the verdict of the whole; `changes` grows."""
        if self.openings is not None:
            for one in self.openings.alike():
                self._drop(one)
        if not self._is_recounted:
            return
        self._is_recounted = False
        track, verdict = self.track, self.ids.verdict()
        if verdict is track.verdict:
            return
        moment = Moment(max(0, track.steps - 1), time, by_time=by_time)
        change = Change(track.property, track.verdict, verdict, moment)
        track.verdict = verdict
        track.owe(moment.step, time, by_time=by_time)
        if verdict is Verdict.VIOLATED:
            track.decided_at = next(iter(self.ids.violated.values())).failure
        if track.verdicts is not None:
            track.changes.append(change)
        if track.observer is not None:
            track.observer.changed(change)
        changes.append(change)

    def courses(self) -> Iterator[Course]:
        """Those of the slices that are kept; of others, the whole has the episodes."""
        return iter(self.ids.slices.values())
