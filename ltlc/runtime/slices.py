"""A property for each id: a run is sliced, and each slice is judged as a run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from heapq import heappop, heappush
from typing import Any
from uuid import UUID

from ltlc.runtime import slice_reports
from ltlc.runtime.sampling import (
    Derived,
    New,
    Reading,
    Sampler,
    Update,
    Value,
    topics_of,
)
from ltlc.runtime.session import Session
from ltlc.runtime.slice_reports import Id, Violation
from ltlc.runtime.ticks import Ticks
from ltlc.runtime.times import NEVER
from ltlc.runtime.tracking import Change, Moment, Track
from ltlc.semantics.verdicts import Verdict


@dataclass(frozen=True, slots=True)
class Key:
    """What slices the messages on `topic`: the reading `name` has their ids.

    If that is an array, each element is a message of its own, and of the arrays in
    `elements` it has the element beside it, as the reading of a slice that is named
    there. `gone` is a reading of a slice that says whether the last message had no
    element with its id.
    """

    topic: str
    name: str
    elements: Mapping[str, str] = field(default_factory=dict)
    gone: str | None = None


@dataclass(frozen=True, slots=True)
class Slicing:
    """A property is judged for each id, on the slice of the run for it.

    `signals` are those of a slice, each after its parts; in it, `variable` has the id.
    At most `limit` ids are kept, None is any number. Of a slice whose monitor is in one
    of the states `as_new`, with no clock running, nothing need be kept.
    """

    signals: tuple[Reading | Derived, ...]
    keys: tuple[Key, ...]
    variable: str
    limit: int | None = None
    as_new: frozenset[int] = frozenset()

    def start(self, track: Track, session: Session) -> Slices:
        """Judge the property of `track` so, in a session that begins."""
        return Slices(self, track, session)


class Slice:
    """The run of one id, as far as it is known.

    track: what is known of the property in it
    samples, times: those of its own signals, while those of others are looked at
    is_full: whether all that the property reads has a value
    counted: the verdict as which it was counted
    scheduled: when time may change it, as it was noted
    lacks_beginning: whether messages before its first one may have found no place
    latest, heard: what the next tick sees of it, where there are ticks
    """

    __slots__ = (
        "counted",
        "heard",
        "id",
        "is_full",
        "lacks_beginning",
        "latest",
        "samples",
        "scheduled",
        "times",
        "track",
    )

    def __init__(self, id_: Id, track: Track, lacks_beginning: bool) -> None:
        self.id = id_
        self.track = track
        self.samples: list[Value] = []
        self.times: tuple[tuple[int, ...], ...] = ()
        self.is_full = False
        self.counted = Verdict.NOT_STARTED
        self.scheduled = NEVER
        self.lacks_beginning = lacks_beginning
        self.latest: dict[str, Value] | None = None
        self.heard: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class Part:
    """The part of a row that a slice gets, or that all slices share.

    It has samples of `names`, which stand at `places` of the row and which `update`
    takes, and messages on `topics`, which are `news` at these places and renew the
    ages of the signals in `aged`. It `is_step` if the property reads something of it.
    """

    names: tuple[str, ...]
    places: tuple[int, ...]
    topics: frozenset[str]
    update: Update
    news: tuple[int, ...]
    aged: frozenset[str]
    is_step: bool

    def of(self, values: Sequence[Value]) -> list[Value]:
        """The values of this part of a row."""
        return [values[place] for place in self.places]


@dataclass(frozen=True)
class Row:
    """What rows with the same names and topics are to slices.

    `keys` are those of sliced topics with a message, each with the place of its id, or
    None if the row has none. `shared` is what all slices share, `rest` what that is to
    one that gets nothing else. `own` has what the slice of the ids on some topics gets.
    """

    names: tuple[str, ...]
    keys: tuple[tuple[Key, int | None], ...]
    shared: Part
    rest: Part
    own: dict[tuple[str, ...], Part] = field(default_factory=dict)

    @cached_property
    def only(self) -> int | None:
        """The place of the id, if a row is a message of one slice and no more."""
        if len(self.keys) != 1 or self.shared.topics or self.keys[0][0].elements:
            return None
        return self.keys[0][1]


Message = tuple[Id, Part, Sequence[Value]]
"""A message of a slice, with its values."""


class Slices:
    """Judges a property for each id, in a `session` in which it is the `track`.

    The messages on sliced topics belong to the slice of their id, the others to all. A
    slice begins with its first message, and with it the session of the slice; what
    other topics said before is known to it. A slice that is decided is dropped, and its
    id kept; one that is as new is dropped without a trace.

    One sampler serves all slices: it has the samples of one of them at a time. Steps of
    the property are those of all slices, in their order.

    slices: those that are not decided
    violated, satisfied: the ids of the others
    seen: all ids that came, if there is no limit on them; `births` counts slices
    messages: how many messages had an id; of others, `without_id` counts those that had
    none, `left_out` those of which the id found no place
    """

    def __init__(self, slicing: Slicing, track: Track, session: Session) -> None:
        self.slicing = slicing
        self.track = track
        self.session = session
        self.slices: dict[Id, Slice] = {}
        self.violated: dict[Id, Violation] = {}
        self.satisfied: set[Id] = set()
        self.seen: set[Id] = set()
        self.births = self.messages = self.without_id = self.left_out = 0
        self._has_started = self._is_recounted = False
        self._owed = self._failed = 0
        self._goes_by_time = track.is_timed or bool(track.property.events)
        self._keys = {key.topic: key for key in slicing.keys}
        self._as_new = frozenset() if session.plan.rate else slicing.as_new
        topics = topics_of(slicing.signals)
        shared_first = sorted(
            slicing.signals, key=lambda s: not topics[s.name].isdisjoint(self._keys)
        )
        self._sampler = Sampler(shared_first, track.property.inputs)
        self._window = self._sampler.window(track.property.inputs)
        self._topic = {
            s.name: s.topic for s in slicing.signals if isinstance(s, Reading)
        }
        own = [s for name, s in self._sampler.samples.items() if self._is_own(name)]
        news = {i.signal for i in track.property.inputs if isinstance(i, New)}
        end = len(self._sampler.known) - len(news)
        self._places = slice(min((s.first for s in own), default=end), end)
        self._own = [s for s in own if s.depth > 1]
        self._has_id = slicing.variable in self._sampler.samples
        self._none = self._new_samples()
        self._no_times: tuple[tuple[int, ...], ...] = ((),) * len(self._own)
        self._ages = _ages(track)
        self._own_ages = frozenset(name for name in self._ages if self._is_own(name))
        self._last_heard: dict[str, int] = {}
        self._loaded: Slice | None = None
        self._can_reuse = not (track.property.scopes or track.property.kept)
        self._spare: Slice | None = None
        self._due: list[tuple[int, int, Slice]] = []
        self._noted = 0
        self._rows: dict[tuple[tuple[str, ...], frozenset[str]], Row] = {}
        self._ticks: Ticks | None = None
        self._latest: dict[str, Value] = {}
        self._news: frozenset[str] = frozenset()
        self._quiet = 0
        self._gone: dict[str, set[Id]] = {key.topic: set() for key in slicing.keys}

    def _is_own(self, signal: str) -> bool:
        """Whether each slice has samples of the signal of its own."""
        return not self._sampler.topics[signal].isdisjoint(self._keys)

    # What comes in.

    def begin(self, time: int) -> None:
        """The session begins."""
        if self.session.plan.rate is not None and self.track.property.from_session:
            self._ticks = Ticks(self.session.plan.rate, time)

    def take(
        self,
        time: int,
        names: tuple[str, ...],
        topics: frozenset[str],
        values: Sequence[Value],
    ) -> list[Change]:
        """Samples of `names` came in, and messages on `topics`; all is held to then."""
        row = self._rows.get((names, topics)) or self._meet(names, topics)
        if row.only is not None and self._ticks is None:
            return self._take_one(time, row, row.only, values)
        shared = row.shared
        if not row.keys and not shared.topics:
            return []
        rate = self.session.plan.rate
        if rate is not None and self._ticks is None:
            self._ticks = Ticks(rate, time)
        reached: set[Id] = set()
        if shared.topics:
            self._share(time, shared, shared.of(values))
        for id_, part, given in self._messages(row, values):
            one = self._slice(time, id_)
            if one is not None:
                reached.add(id_)
                self._give(time, one, part, given)
        for key, place in row.keys:
            if key.gone is not None and place is not None:
                self._miss(time, key, key.gone, set(map(_id_of, values[place])))
        if shared.topics:
            given = row.rest.of(values)
            for one in [s for s in self.slices.values() if s.id not in reached]:
                self._give(time, one, row.rest, given)
        return self._tell(time)

    def _take_one(
        self, time: int, row: Row, place: int, values: Sequence[Value]
    ) -> list[Change]:
        """Such a row is a message of one slice, and of nothing else."""
        value = values[place]
        one = self.slices.get(value)  # equal numbers are one key, whatever their type
        if one is not None:
            self.messages += 1
        elif (id_ := self._counted(value)) is not None:
            one = self._slice(time, id_)
        if one is not None:
            part = self._own_part(row, (row.keys[0][0].topic,))
            self._give(time, one, part, [values[each] for each in part.places])
        return self._tell(time)

    def _meet(self, names: tuple[str, ...], topics: frozenset[str]) -> Row:
        """What such rows are to slices; found once for all."""
        keys = tuple(
            (key, names.index(key.name) if key.name in names else None)
            for key in self.slicing.keys
            if key.topic in topics
        )
        read = self._window.topics.union(
            *(self._sampler.topics[n] for n in [*self._window.signals, *self._ages])
        )
        others = (topics & read).difference(self._keys)
        row = Row(
            names,
            keys,
            self._part(names, others, is_own=False),
            self._part(names, others, is_own=True),
        )
        self._rows[names, topics] = row
        return row

    def _part(
        self, names: Sequence[str], topics: frozenset[str], *, is_own: bool
    ) -> Part:
        """What samples of `names` on `topics` are to a slice, or to all of them."""
        places = tuple(
            p for p, name in enumerate(names) if self._topic.get(name) in topics
        )
        taken = tuple(names[place] for place in places)
        found, window = self._sampler.update(taken, topics), self._window
        own = range(self._places.start, self._places.stop)
        update = Update(
            found.fresh,
            found.known,
            tuple(pair for pair in found.plain if (pair[1] in own) is is_own),
            tuple(pair for pair in found.deep if (pair[1].first in own) is is_own),
            (),
            tuple(each for each in found.derived if (each[0].first in own) is is_own),
        )
        has_id = self._has_id and not topics.isdisjoint(self._keys)
        is_step = has_id or not (
            window.signals.isdisjoint(found.fresh) and window.topics.isdisjoint(topics)
        )
        aged = frozenset(
            n for n in self._ages if not self._sampler.topics[n].isdisjoint(topics)
        )
        news = self._sampler.news(topics)
        return Part(taken, places, topics, update, news, aged, is_step)

    def _messages(self, row: Row, values: Sequence[Value]) -> Iterator[Message]:
        """The messages of slices in a row: those with one id are one, but of arrays."""
        topics: dict[Id, tuple[str, ...]] = {}
        for key, place in row.keys:
            if key.elements:
                yield from self._elements(row, key, place, values)
                continue
            id_ = self._counted(None if place is None else values[place])
            if id_ is not None:
                topics[id_] = (*topics.get(id_, ()), key.topic)
        for id_, of in topics.items():
            part = self._own_part(row, of)
            yield id_, part, part.of(values)

    def _elements(
        self, row: Row, key: Key, place: int | None, values: Sequence[Value]
    ) -> Iterator[Message]:
        """The elements of a message, as far as the shortest array goes."""
        if key.gone is not None:
            values = (*values, False)
        part = self._own_part(row, (key.topic,))
        own = set(key.elements.values())
        pairs = zip(part.places, part.names, strict=True)
        arrays = {place for place, name in pairs if name in own}
        ids = self._ids(place, values)
        count = min([len(ids), *(len(values[p]) for p in arrays)])
        for number, id_ in enumerate(map(self._counted, ids[:count])):
            if id_ is not None:
                given = [
                    values[p][number] if p in arrays else values[p] for p in part.places
                ]
                yield id_, part, given

    def _miss(self, time: int, key: Key, name: str, here: set[Id | None]) -> None:
        """A message came with the ids that are `here`: all others are gone."""
        gone = self._gone[key.topic]
        gone -= here
        part = self._part((name,), frozenset({key.topic}), is_own=True)
        part = replace(part, topics=frozenset(), news=(), aged=frozenset())
        for one in list(self.slices.values()):
            if one.id not in here and one.id not in gone:
                gone.add(one.id)
                self._give(time, one, part, (True,))

    def _ids(self, place: int | None, values: Sequence[Value]) -> Sequence[Value]:
        """The array of ids at a place of a row; one that is not there is a message."""
        if place is None:
            self.without_id += 1
            return ()
        found: Sequence[Value] = values[place]
        return found

    def _counted(self, value: Value) -> Id | None:
        """The id of a message; None if it has none."""
        id_ = None if value is None else _id_of(value)
        if id_ is None:
            self.without_id += 1
        else:
            self.messages += 1
        return id_

    def _own_part(self, row: Row, topics: tuple[str, ...]) -> Part:
        """What a slice gets of a row whose messages on these topics have its id."""
        part = row.own.get(topics)
        if part is None:
            of = row.shared.topics.union(topics)
            keys = [self._keys[topic] for topic in topics]
            arrays = {name: own for key in keys for name, own in key.elements.items()}
            names = [arrays.get(name, name) for name in row.names]
            names += [key.gone for key in keys if key.gone is not None]
            part = row.own[topics] = self._part(names, of, is_own=True)
        return part

    def _share(self, time: int, part: Part, given: Sequence[Value]) -> None:
        """Take what all slices share."""
        for signal in part.aged:
            self._last_heard[signal] = time
        if self._ticks is None:
            part.update.take(time, given)
            return
        self._latest.update(zip(part.names, given, strict=True))
        self._news |= part.topics
        self._quiet = 0

    def _slice(self, time: int, id_: Id) -> Slice | None:
        """The slice of an id; None if it is decided, or finds no place."""
        found = self.slices.get(id_)
        if found is not None or id_ in self.satisfied or id_ in self.violated:
            return found
        limit = self.slicing.limit
        if limit is not None and self._kept() >= limit:
            self.left_out += 1
            return None
        self.births += 1
        one = self.slices[id_] = self._born(time, id_)
        if id_ in self.seen:  # it was forgotten, and all was well
            one.counted = one.track.verdict = Verdict.PRESUMABLY_SATISFIED
        elif limit is None:
            self.seen.add(id_)
        return one

    def _kept(self) -> int:
        """How many ids are kept."""
        return len(self.slices) + len(self.satisfied) + len(self.violated)

    def _born(self, time: int, id_: Id) -> Slice:
        """A slice begins: ages of what is its own count from now."""
        if self._spare is not None:
            return self._reborn(id_, self._spare)
        whole, track = self.track, Track(self.track.property)
        track.invalid_because = whole.invalid_because
        # Nothing is ever put into these, and each would take its place.
        track.times, track.values, track.changes = (
            whole.times,
            whole.values,
            whole.changes,
        )
        track.begin(time if self.session.began is None else self.session.began)
        for signal, heard in self._last_heard.items():
            track.hear(heard, {signal})
        track.hear(time, self._own_ages)
        if not whole.property.events:
            track.watchers = whole.watchers
        if not whole.scopes:
            track.scopes = whole.scopes
        one = Slice(id_, track, self.left_out > 0)
        self._empty(one)
        return one

    def _reborn(self, id_: Id, one: Slice) -> Slice:
        """A slice begins, with what was made for one that was as new."""
        self._spare = None
        one.track.verdict, one.track.steps = Verdict.NOT_STARTED, 0
        one.id, one.lacks_beginning = id_, self.left_out > 0
        one.is_full, one.counted, one.scheduled = False, Verdict.NOT_STARTED, NEVER
        self._empty(one)
        return one

    def _empty(self, one: Slice) -> None:
        """A slice has no samples yet, but for its id."""
        one.times = self._no_times
        one.samples = self._none.copy()
        if self._has_id:
            place = self._sampler.samples[self.slicing.variable].first
            one.samples[place - self._places.start] = one.id

    def _give(self, time: int, one: Slice, part: Part, given: Sequence[Value]) -> None:
        """A slice gets its part of a row."""
        track = one.track
        if part.aged:
            track.hear(time, part.aged)
        if self._ticks is not None:
            self._keep(one, part, given)
            if track.is_renewed and self._ticks.next() != time:
                track.renew(time)
            self._settle(one)
            return
        self._load(one)
        part.update.take(time, given)
        if part.is_step:
            self._step(time, one, part.news)
        elif track.property.from_session and not track.steps and not track.invalid:
            self._step(time, one, ())
        if track.is_renewed:
            track.renew(time)
        self._settle(one)

    # One sampler for all.

    def _load(self, one: Slice) -> None:
        """Have the samples of a slice, and save those of the slice before."""
        known, last = self._sampler.known, self._loaded
        if last is one:
            return
        if last is not None:
            last.samples = known[self._places]
        known[self._places] = one.samples
        if self._own:
            if last is not None:
                last.times = tuple(samples.times for samples in self._own)
            for samples, times in zip(self._own, one.times, strict=True):
                samples.times = times
        self._loaded = one

    def _new_samples(self) -> list[Value]:
        """What a slice has before its first message: no id is gone."""
        found: list[Value] = [None] * (self._places.stop - self._places.start)
        for name in (key.gone for key in self.slicing.keys if key.gone is not None):
            found[self._sampler.samples[name].first - self._places.start] = False
        return found

    # Steps, of rows and of ticks.

    def _step(self, time: int, one: Slice, news: tuple[int, ...]) -> None:
        """A slice of which the samples are loaded takes a step, if all has a value."""
        if self._sampler.heard is not news:
            self._sampler.hear(news)
        values, track = self._window.values(), one.track
        if not one.is_full:
            if None in values and not track.is_ready(values):
                return
            one.is_full = True
        whole = self.track
        steps, track.steps = track.steps, whole.steps
        track.step(time, values)
        if track.steps == whole.steps:
            track.steps = steps
            whole.monitor.invalid += 1
            return
        whole.steps = track.steps
        if not self.session.has_begun:
            self.session.begin_run(time)
        if whole.verdicts is not None:
            if track.verdict is not one.counted:
                self._count(one)
            whole.verdicts.append(self._verdict())
            whole.times.append(time)
            whole.values.append(track.judged_on)

    def _keep(self, one: Slice, part: Part, given: Sequence[Value]) -> None:
        """Keep what the next tick sees of a slice."""
        own = (
            pair
            for pair in zip(part.names, given, strict=True)
            if self._is_own(pair[0])
        )
        one.latest = {**(one.latest or {}), **dict(own)}
        one.heard |= part.topics
        self._quiet = 0

    def _tick(self, time: int) -> list[Change]:
        """A tick is a step of every slice."""
        assert self._ticks is not None
        changes = self._hold(time)
        self._ticks.count += 1
        self._quiet += 1
        self.session.steps += 1
        names, given = tuple(self._latest), tuple(self._latest.values())
        self._tick_part(names, is_own=False).update.take(time, given)
        for one in list(self.slices.values()):
            self._load(one)
            latest = one.latest or {}
            part = self._tick_part((*latest, *names), is_own=True)
            part.update.take(time, (*latest.values(), *given))
            self._step(time, one, self._sampler.news(self._news | one.heard))
            one.heard = frozenset()
            if one.track.is_renewed:
                one.track.renew(time)
            self._settle(one)
        self._news = frozenset()
        return changes + self._tell(time)

    def _tick_part(self, names: tuple[str, ...], *, is_own: bool) -> Part:
        return self._part(names, frozenset(self._topic.values()), is_own=is_own)

    # Time.

    def hold(self, time: int) -> list[Change]:
        """Take the ticks before `time`, and the clock steps up to and including it."""
        return self._tick_before(time) + self._hold(min(time, self.session.end))

    def advance(self, time: int) -> list[Change]:
        """Take what is due by `time`, ticks at `time` included."""
        return self._tick_before(time + 1) + self._hold(min(time, self.session.end))

    def _tick_before(self, time: int) -> list[Change]:
        changes: list[Change] = []
        while self._ticks is not None and self._ticks.next() < min(
            time, self.session.end + 1
        ):
            changes += self._tick(self._ticks.next())
            self._skip(min(time, self.session.end + 1, self.due()))
        return changes

    def is_calm(self, time: int) -> bool:
        """Whether nothing is due before the messages at `time`."""
        return self._ticks is None and (not self._due or self._due[0][0] > time)

    def due(self) -> int:
        """Before this time, no clock step comes, unless a step comes first."""
        return self._due[0][0] if self._due else NEVER

    def _hold(self, time: int) -> list[Change]:
        """Take the clock steps up to and including `time`, in their order."""
        changes: list[Change] = []
        while self._due and (now := self._due[0][0]) <= time:
            while self._due and self._due[0][0] == now:
                one = heappop(self._due)[2]
                if self.slices.get(one.id) is one and one.scheduled == now:
                    one.scheduled = NEVER
                    one.track.hold(now)
                    self._settle(one)
            changes += self._tell(now, by_time=True)
        return changes

    def _skip(self, until: int) -> None:
        """Count ticks before `until` without taking them, if they all do the same."""
        tracks = [one.track for one in self.slices.values()]
        assert self._ticks is not None
        times = (
            self._ticks.before(until) - 1
        )  # the last is taken: slopes ask for its time
        is_settled = self._quiet > self._sampler.reach + 1 and all(
            track.is_settled for track in tracks
        )
        if times <= 0 or not is_settled or self.track.verdicts is not None:
            return
        self._ticks.count += times
        self.session.steps += times
        for track in tracks:
            invalid, steps = track.invalid, track.steps
            track.repeat(times, ())
            self.track.monitor.invalid += track.invalid - invalid
            if track.steps > steps:
                self.track.steps += times
                track.steps = self.track.steps

    # Verdicts.

    def _settle(self, one: Slice) -> None:
        """Count a slice that may have changed; drop it if it is decided, or as new."""
        track = one.track
        verdict = track.verdict
        if verdict is not one.counted:
            self._count(one)
        if track.decided_at is not None:
            self._drop(one)
            if verdict is Verdict.VIOLATED:
                self.violated[one.id] = Violation(track.decided_at, one.lacks_beginning)
            else:
                self.satisfied.add(one.id)
            return
        next_ = track.next if self._goes_by_time else NEVER
        if next_ < one.scheduled:
            one.scheduled = next_
            self._noted += 1
            heappush(self._due, (next_, self._noted, one))
        is_well = verdict is Verdict.PRESUMABLY_SATISFIED and next_ >= NEVER
        if is_well and track.monitor.state in self._as_new:
            self._drop(one)
            if self._can_reuse:
                self._spare = one

    def _count(self, one: Slice) -> None:
        """Count a slice by its verdict, which is new."""
        verdict = one.track.verdict
        self._owed += verdict is Verdict.PRESUMABLY_VIOLATED
        self._owed -= one.counted is Verdict.PRESUMABLY_VIOLATED
        self._failed += verdict is Verdict.VIOLATED
        self._failed -= one.counted is Verdict.VIOLATED
        one.counted = verdict
        self._has_started = self._is_recounted = True

    def _drop(self, one: Slice) -> None:
        del self.slices[one.id]
        for key in self.slicing.keys:
            self._gone[key.topic].discard(one.id)
        if self._loaded is one:
            self._loaded = None
        if self.track.scopes:
            for whole, scope in zip(self.track.scopes, one.track.scopes, strict=True):
                whole.count += scope.count

    def _verdict(self) -> Verdict:
        """That of the whole: never satisfied, for another id may come."""
        if self._failed:
            return Verdict.VIOLATED
        if self._owed:
            return Verdict.PRESUMABLY_VIOLATED
        is_well = self._has_started
        return Verdict.PRESUMABLY_SATISFIED if is_well else Verdict.NOT_STARTED

    def _tell(self, time: int, *, by_time: bool = False) -> list[Change]:
        """What has become of the verdict of the whole."""
        if not self._is_recounted:
            return []
        self._is_recounted = False
        track, verdict = self.track, self._verdict()
        if verdict is track.verdict:
            return []
        moment = Moment(max(0, track.steps - 1), time, by_time=by_time)
        change = Change(track.property, track.verdict, verdict, moment)
        track.verdict = verdict
        track.open_since = moment if verdict is Verdict.PRESUMABLY_VIOLATED else None
        if verdict is Verdict.VIOLATED:
            track.decided_at = next(iter(self.violated.values())).failure
        if track.verdicts is not None:
            track.changes.append(change)
        if track.observer is not None:
            track.observer.changed(change)
        return [change]

    # What is told.

    def tracks(self) -> Iterator[Track]:
        """Those of the slices that are kept; of others, the whole has the episodes."""
        return (one.track for one in self.slices.values())

    def since(self) -> str:
        """Which ids violated the property, and when; empty if none did."""
        return slice_reports.since(self)

    def remarks(self) -> list[str]:
        """What else there is to say."""
        return slice_reports.remarks(self)

    def figure(self) -> str:
        """What is told of the violations."""
        return slice_reports.figure(self)

    def document(self) -> dict[str, Any]:
        """The ids, in the JSON document of `ltlc run`."""
        return slice_reports.document(self)


def _id_of(value: Value) -> Id | None:
    """A value as an id; NaN is none, and a number that is whole is an integer."""
    if value.__class__ is tuple:
        return bytes_text(bytes(map(int, value)))
    if value.__class__ is not float:
        found: Id = value
        return found
    if value != value:
        return None
    return int(value) if value.is_integer() else float(value)


def bytes_text(value: bytes) -> str:
    """Bytes as text: hexadecimal, 16 of them as UUIDs are written."""
    return str(UUID(bytes=value)) if len(value) == 16 else value.hex()


def _ages(track: Track) -> frozenset[str]:
    """The signals of which the property asks for ages."""
    of = track.property
    ages = (*of.ages, *(age for event in of.events for age in event.ages))
    return frozenset(age.signal for age in ages)
