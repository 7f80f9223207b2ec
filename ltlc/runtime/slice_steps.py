"""Slices of a run are judged: they are born, take steps, fall due, and are dropped."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from heapq import heappop, heappush

from ltlc.runtime.courses import Course
from ltlc.runtime.properties import Change, Moment
from ltlc.runtime.sampling import Value
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
        self._begins = 0
        self._names: tuple[str, ...] | None = None
        self._topics: frozenset[str] | None = None
        self._row: Row
        self._is_recounted = False
        self._goes_by_time = track.property.timed or bool(track.property.events)
        self._no_times: tuple[tuple[int, ...], ...] = ((),) * len(cut.deep)
        self._last_heard: dict[str, int] = {}
        self._loaded: Slice | None = None
        self._can_reuse = not (track.property.scopes or track.property.kept)
        self._spare: Slice | None = None
        self._due: list[tuple[int, int, Slice]] = []
        self._gone: dict[str, set[Id]] = {
            topic: set() for topic, key in cut.keys.items() if key.gone is not None
        }

    @property
    def left_out(self) -> int:
        """How many messages were not judged, because their id found no place."""
        return self.ids.left_out

    # What comes in.

    def begin(self, time: int) -> None:
        """The session begins."""
        self._begins = time
        if self.openings is not None:
            self.openings.before.track.begin(time)

    def first_step(self, time: int) -> list[Change]:
        """Step what begins with the session and has not: no message was a step."""
        if self.openings is None or not self.track.property.from_session:
            return []
        before = self.openings.before
        if not before.track.steps and not before.track.invalid:
            self._step(time, before, ())
            self._settle(before)
        return self._tell(time)

    def take(
        self,
        time: int,
        names: tuple[str, ...],
        topics: frozenset[str],
        values: Sequence[Value],
    ) -> list[Change]:
        """Samples of `names` came in, and messages on `topics`; all is held to then."""
        if names is not self._names or topics is not self._topics:
            self._names, self._topics = names, topics
            self._row = self.cut.row(names, topics)
        row = self._row
        if row.only is not None:
            self._take_one(time, *row.only, values)
        else:
            self._take_all(time, row, values)
        return self._tell(time) if self._is_recounted or self.openings else []

    def _take_one(
        self, time: int, place: int, part: Part, values: Sequence[Value]
    ) -> None:
        """A row is a message of the slice with the id at a place, and nothing else."""
        value = values[place]
        # Most values are ids; of bytes, the id has yet to be made.
        one = self.ids.slices.get(value)
        if one is not None:
            self.ids.messages += 1
        elif (id_ := self.ids.counted(value)) is not None:
            one = self.ids.slices.get(id_) or self._new(time, id_)
        if one is not None:
            self._give(time, one, part, values)

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
            for one in [s for s in self._going_on() if s.id not in reached]:
                self._give(time, one, row.rest, values)

    def _going_on(self) -> list[Slice]:
        """The slices that are not decided; after instances, the run before any."""
        before = () if self.openings is None else (self.openings.before,)
        return [*self.ids.slices.values(), *before]

    def _share(self, time: int, part: Part, given: Sequence[Value]) -> None:
        """Take what all slices share."""
        self._last_heard |= dict.fromkeys(part.aged, time)
        self._hear(part.news)
        part.update.take(time, given)

    def _hear(self, news: tuple[int, ...]) -> None:
        """What stands at these places is new: values may be latched because of that."""
        if self.cut.sampler.heard is not news:
            self.cut.sampler.hear(news)

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
        """Whether this is no slice, but the run before any instance."""
        return self.openings is not None and one is self.openings.before

    def _counts(self, one: Slice) -> bool:
        """Whether the steps of a slice are those of the property."""
        return self.openings is None or one is self.openings.before

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
        if not self.ids.find_place(id_):
            return None
        one = self._born(time, id_)
        if id_ in self.ids.forgotten:  # and all was well
            one.counted = one.track.verdict = Verdict.PRESUMABLY_SATISFIED
        return one

    def _born(self, time: int, id_: Id) -> Slice:
        """A slice begins: ages of what is its own count from now."""
        if self._spare is not None:
            one, self._spare = self._spare, None
            one.track.verdict, one.track.steps = Verdict.NOT_STARTED, 0
            one.id, one.lacks_beginning = id_, self.ids.left_out > 0
            one.is_full, one.counted, one.scheduled = False, Verdict.NOT_STARTED, NEVER
        else:
            of = self.track
            track = Course(of.property, of.invalid_because, self._begins)
            for signal, heard in self._last_heard.items():
                track.hear(heard, {signal})
            if self.cut.own_ages:
                track.hear(time, self.cut.own_ages)
            one = Slice(id_, track, self.left_out > 0)
        one.times = self._no_times
        one.samples = self.cut.samples(id_)
        return one

    # Slices that were judged elsewhere.

    def resumed(
        self, time: int, id_: Id, names: tuple[str, ...], values: Sequence[Value]
    ) -> Slice:
        """A slice that got these `values` last, and all of whose past is forgotten."""
        [topic] = self.cut.keys
        part = self.cut.own_part(self.cut.row(names, frozenset({topic})), (topic,))
        one = self._born(time, id_)
        self._load(one)
        self._hear(part.news)
        part.update.take(time, values)
        one.track.judged_on = self.cut.window.values()
        return one

    def keep(self, one: Slice) -> None:
        """A slice goes on here, from what its track has seen elsewhere."""
        self.ids.keep(one)
        self._settle(one)

    # Steps.

    def _give(self, time: int, one: Slice, part: Part, given: Sequence[Value]) -> None:
        """A slice gets its part of a row."""
        track = one.track
        if part.aged:
            track.hear(time, part.aged)
        self._load(one)
        self._hear(part.news)
        part.update.take(time, given)
        if part.is_step:
            self._step(time, one, part.news)
        elif track.property.from_session and not track.steps and not track.invalid:
            self._step(time, one, ())
        if self.cut.ages and track.is_renewed:
            track.renew(time)
        self._settle(one)

    def _load(self, one: Slice) -> None:
        """Have the samples of a slice, and save those of the slice before."""
        cut, last = self.cut, self._loaded
        if last is one or not cut.new:
            return
        known = cut.sampler.known
        if last is not None:
            last.samples = known[cut.places]
        known[cut.places] = one.samples
        if cut.deep:
            if last is not None:
                last.times = tuple(samples.times for samples in cut.deep)
            for samples, times in zip(cut.deep, one.times, strict=True):
                samples.times = times
        self._loaded = one

    def _step(self, time: int, one: Slice, news: tuple[int, ...]) -> None:
        """A slice of which the samples are loaded takes a step, if all has a value."""
        self._hear(news)
        values, track = self.cut.window.values(), one.track
        if not one.is_full:
            if None in values and not track.property.is_ready(values):
                return
            one.is_full = True
        whole = self.track
        steps, track.steps = track.steps, whole.steps
        track.step(time, values)
        if not self._counts(one):
            return
        if track.steps == whole.steps:
            track.steps = steps
            whole.monitor.invalid += 1
            return
        whole.steps = track.steps
        if not self.session.has_begun:
            self.session.begin_run(time)
        if whole.verdicts is not None:
            self._is_recounted |= self.ids.count(one)
            whole.verdicts.append(self.ids.verdict())
            whole.times.append(time)
            whole.values.append(track.judged_on)

    # Time.

    def hold(self, time: int) -> list[Change]:
        """Take the clock steps up to and including `time`, in their order."""
        changes: list[Change] = []
        until = min(time, self.session.end)
        while self._due and (now := self._due[0][0]) <= until:
            while self._due and self._due[0][0] == now:
                one = heappop(self._due)[2]
                if self._goes_on(one) and one.scheduled == now:
                    one.scheduled = NEVER
                    one.track.hold(now)
                    self._settle(one)
            changes += self._tell(now, by_time=True)
        return changes

    def _goes_on(self, one: Slice) -> bool:
        """Whether a slice has not been dropped."""
        return self._is_before(one) or self.ids.slices.get(one.id) is one

    def advance(self, time: int) -> list[Change]:
        """Take what is due by `time`."""
        return self.hold(time)

    def due(self) -> int:
        """Before this time, no clock step comes, unless a step comes first."""
        return self._due[0][0] if self._due else NEVER

    # Verdicts.

    def _settle(self, one: Slice) -> None:
        """Keep and count a slice, unless it is decided, or as new."""
        track = one.track
        has_started = track.verdict is not Verdict.NOT_STARTED
        if not has_started and self.openings and self.openings.withdraws(one):
            self._drop(one)
            return
        if track.monitor.state in self.as_new and self.is_as_new(one):
            self._forget(one)
            return
        if not one.number:
            self.ids.keep(one)
        if track.verdict is not one.counted:
            self._is_recounted |= self.ids.count(one)
        if track.decided_at is not None and not self._is_before(one):
            self._drop(one)
            self.ids.decide(one, track.decided_at)
        elif self._goes_by_time and (next_ := track.next) < one.scheduled:
            one.scheduled = next_
            heappush(self._due, (next_, one.number, one))

    def _forget(self, one: Slice) -> None:
        """Drop a slice that is as new; most were never kept."""
        if one.counted is not one.track.verdict:
            self._is_recounted |= self.ids.count(one)
        self._drop(one)
        self.ids.forget(one.id)
        if self._can_reuse:
            one.number = 0
            self._spare = one

    def is_as_new(self, one: Slice) -> bool:
        """Whether a slice need not be kept."""
        track = one.track
        return (
            track.monitor.state in self.as_new
            and track.verdict is Verdict.PRESUMABLY_SATISFIED
            and track.next >= NEVER
        )

    def _drop(self, one: Slice) -> None:
        self.ids.slices.pop(one.id, None)
        for gone in self._gone.values():
            gone.discard(one.id)
        if self._loaded is one:
            self._loaded = None
        if self.track.scopes:
            for whole, scope in zip(self.track.scopes, one.track.scopes, strict=True):
                whole.count += scope.count

    def _tell(self, time: int, *, by_time: bool = False) -> list[Change]:
        """What has become of the verdict of the whole."""
        if self.openings is not None:
            for one in self.openings.alike():
                self._drop(one)
        if not self._is_recounted:
            return []
        self._is_recounted = False
        track, verdict = self.track, self.ids.verdict()
        if verdict is track.verdict:
            return []
        moment = Moment(max(0, track.steps - 1), time, by_time=by_time)
        change = Change(track.property, track.verdict, verdict, moment)
        track.verdict = verdict
        track.open_since = moment if verdict is Verdict.PRESUMABLY_VIOLATED else None
        if verdict is Verdict.VIOLATED:
            track.decided_at = next(iter(self.ids.violated.values())).failure
        if track.verdicts is not None:
            track.changes.append(change)
        if track.observer is not None:
            track.observer.changed(change)
        return [change]

    def courses(self) -> Iterator[Course]:
        """Those of the slices that are kept; of others, the whole has the episodes."""
        return (one.track for one in self.ids.slices.values())
