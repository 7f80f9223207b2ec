"""Traffic of which a property is judged for each id: messages with ids, and the steps of each slice, by definition."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any
from uuid import UUID

from ltlc.assurance.histories import Instant, Sample
from ltlc.assurance.many_traffic import ManyTraffic
from ltlc.assurance.messages import Content, Messages, Path
from ltlc.assurance.replay import Id
from ltlc.assurance.traffic import Begun, Event, Followed, Follower, Heard, Passed, Quiet, Said, Settings
from ltlc.assurance.values import Samples
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.instants import Instant as Judged
from ltlc.semantics.timed_run import TimedRun
from ltlc.specification.evaluation import Value
from ltlc.specification.expressions import Bytes, Each, Field, Signal
from ltlc.specification.specification import Slicing, gone_name

IDS = 3
MOST_ELEMENTS = 3
"""How many elements an array of ids has at most."""


@dataclass(frozen=True, slots=True)
class Ident:
    """An id: as it is reported, as the property reads it, and as it is in a message."""

    id: Id
    value: Value
    said: Value


Message = tuple[Ident, Sample]
"""What a slice gets of a message."""


@dataclass(frozen=True, slots=True)
class Told(Heard):
    """A message comes in, of which slices get these `parts`."""

    parts: Sequence[Message]

    def __str__(self) -> str:
        return Heard.__str__(self)


class SlicedTraffic(ManyTraffic):
    """Messages with a few ids, on the topics that slice a property, and others."""

    def __init__(self, samples: Samples, slicing: Slicing, messages: Messages) -> None:
        super().__init__(samples)
        self.slicing = slicing
        self.keys = {_field(key).topic: key for key in slicing.keys}
        self._message_types = messages
        self._elements = {slicing.element_of(array): array for array in slicing.arrays}
        gone = {gone_name(key.name): _field(key).topic for key in slicing.keys}
        self.gone = {signal: gone[signal.name] for signal in self.sources.signals if signal.name in gone}
        """The signals that are true while an id is gone, each with the topic of its key."""
        self._ids = self._drawn_ids()

    def is_id(self, signal: Signal) -> bool:
        """Whether a signal has the id of a slice."""
        elements = (self.slicing.element_of(key) for key in self.slicing.keys)
        return signal.name in (self.slicing.variable, *elements) or signal in self.slicing.keys

    def follower(self, compiled: Compiled, settings: Settings) -> SlicesFollower:
        """What follows all slices in one run."""
        return SlicesFollower(compiled, self, settings)

    def topics(self) -> list[str]:
        """Those that messages come on."""
        return [*dict.fromkeys((*self.sources.topics(), *self.keys))]

    def heard(self, time: Nanoseconds, topic: str) -> Event:
        """A message, and what each slice gets of it; if it is not sliced, that is the same for all."""
        if topic not in self.keys:
            sample = self._sample(topic)
            return Heard(time, Said(topic, self.sources.content(sample), sample))
        is_array = self._elements.keys() & {self.slicing.element_of(self.keys[topic])}
        count = self.samples.chance.randrange(MOST_ELEMENTS + 1) if is_array else 1
        parts: list[Message] = []
        for ident in self.samples.chance.choices(self._ids, k=count):
            own = {
                s: ident.said if s in self.slicing.keys else ident.value for s in self.sources.signals if self.is_id(s)
            }
            gone = {signal: False for signal, of in self.gone.items() if of == topic}
            first = parts[0][1] if parts else {}
            outer = {s: value for s, value in first.items() if s.name not in self._elements}
            parts.append((ident, {**self._sample(topic), **outer, **own, **gone}))
        return Told(time, Said(topic, self._content(topic, parts), parts[0][1] if parts else {}), parts)

    def _sample(self, topic: str) -> Sample:
        """The contents of a message on `topic`, without ids."""
        return {s: v for s, v in self.sample(topic).items() if s not in self.gone and not self.is_id(s)}

    def _content(self, topic: str, parts: Sequence[Message]) -> Content:
        """What stands where in the message of which slices get these parts."""
        key = self.keys[topic]
        signals = dict.fromkeys(s for _, sample in parts for s in sample if s not in self.gone and not self.is_id(s))
        content: dict[Path, Any] = {}
        for signal in signals:
            values = tuple(sample[signal] for _, sample in parts)
            array = self._elements.get(signal.name)
            content[_path(array or signal)] = values[0] if array is None else values
        is_array = self.slicing.element_of(key) in self._elements
        said = tuple(ident.said for ident, _ in parts)
        content[_path(key)] = said if is_array else said[0]
        return content

    def _drawn_ids(self) -> list[Ident]:
        """A few ids: such as the property compares them with, if it does, and others."""
        key = self.slicing.keys[0]
        if (length := self._length_of_bytes(key)) is not None:
            drawn = [bytes(self.samples.chance.choices(range(256), k=length)) for _ in range(IDS)]
            return [Ident(_told(each), _told(each), tuple(map(float, each))) for each in drawn]
        variable = next((s for s in self.sources.signals if s.name == self.slicing.variable), None)
        read = [self.samples.draw().sample[variable] for _ in range(IDS)] if variable else []
        others: dict[str, list[Value]] = {"boolean": [False, True], "string": ["a", "b", "c"]}
        kind = (key.type.element or key.type).value
        numbers: list[Value] = [key.numbers.nearest(float(n)) for n in (1, 2, 3)]
        found: dict[Value, Ident] = {}
        for value in [*read, *others.get(kind, numbers)]:
            if value == value:
                found.setdefault(value, Ident(_whole(value), value, value))
        return list(found.values())[: min(IDS + 1, self.slicing.limit or IDS)]

    def _length_of_bytes(self, key: Signal) -> int | None:
        field = _field(key)
        if Bytes() in field.path or (Each() not in field.path and key not in self.slicing.arrays):
            return self._message_types.type_at(field.message, _path(key)).length
        return None


class SlicesFollower(Follower):
    """What all slices make of events; by itself it knows what they share."""

    def __init__(self, compiled: Compiled, traffic: SlicedTraffic, settings: Settings) -> None:
        super().__init__(Followed(compiled, traffic.sources), settings)
        self._traffic = traffic
        self._began: Nanoseconds | None = None
        self._known: list[Instant] = []
        self._slices: dict[Id, SliceFollower] = {}

    def dues(self) -> list[Nanoseconds]:
        """When clocks of slices expire."""
        return [moment for one in self._slices.values() if one.run for _, moment in one.run.dues()]

    def take_all(self, event: Event) -> dict[Id, list[Judged | None]]:
        """The steps that `event` leads to in each slice; of a sliced message, these get `parts`."""
        if self._began is None:
            if not isinstance(event, Begun | Heard):
                return {}
            self._began = event.time
        if self._settings.rate is not None and self._start is None and (isinstance(event, Heard) or not self._of.waits):
            self._start = event.time
        found = {id_: one.take(Quiet(event.time)) for id_, one in self._slices.items() if isinstance(event, Heard)}
        self._known += self._ticks(event)
        match event:
            case Told(time, said, parts):
                for ident, sample in parts:
                    part = Heard(time, Said(said.topic, said.content, sample))
                    one = self._slices.get(ident.id) or self._born(time, ident)
                    found.setdefault(ident.id, []).extend(one.take(part))
                for id_ in self._slices.keys() - {ident.id for ident, _ in parts}:
                    found[id_] += self._slices[id_].miss(time, said.topic)
            case Heard(time, said):
                for id_, one in self._slices.items():
                    found[id_] += one.take(event)
                self._share(Instant(time, said.sample, frozenset({said.topic})))
            case Passed() | Quiet():
                found = {id_: one.take(event) for id_, one in self._slices.items()}
            case _:
                pass
        end = min((one.end for one in self._slices.values()), default=self._end)
        self._end = end
        for one in self._slices.values():
            one.end = end
        return found

    def _share(self, instant: Instant) -> None:
        """Something came that slices share: a tick sees it, or it is known at once."""
        self._came |= dict.fromkeys(instant.heard, instant.time)
        if self._settings.rate is None:
            self._known.append(instant)
            return
        self._latest |= instant.taken
        self._heard |= instant.heard

    def _born(self, time: Nanoseconds, ident: Ident) -> SliceFollower:
        assert self._began is not None
        one = SliceFollower(self._of, self._traffic, self._settings, ident)
        one.begin(self._began, time, self._known, self._came)
        one.tick_as(self)
        self._slices[ident.id] = one
        return one


class SliceFollower(Follower):
    """What a slice makes of its messages."""

    def __init__(self, of: Followed, traffic: SlicedTraffic, settings: Settings, ident: Ident) -> None:
        super().__init__(of, settings)
        self._gone = dict.fromkeys(traffic.gone, False)
        self._topics = traffic.gone
        self._is_born = False
        self._own = frozenset(traffic.keys)
        self._constants: Sample = {
            **{s: ident.value for s in traffic.sources.signals if s.name == traffic.slicing.variable},
            **self._gone,
        }

    @property
    def end(self) -> float:
        """When the run is over."""
        return self._end

    @end.setter
    def end(self, time: float) -> None:
        self._end = time

    def begin(
        self,
        began: Nanoseconds,
        time: Nanoseconds,
        known: Iterable[Instant],
        came: Mapping[str, Nanoseconds],
    ) -> None:
        """The slice begins at `time`, with what was `known` of other topics, on which messages `came`."""
        self.run = self._new_run(began)
        for instant in (*known, Instant(time, self._constants)):
            self._history.know(instant)
        for topic, at in sorted(came.items(), key=lambda each: each[1]):
            self._hear(self.run, at, {topic})
        self._hear(self.run, time, self._own)

    def tick_as(self, other: SlicesFollower) -> None:
        """The ticks are those of all slices, and see what these share."""
        self._start, self._tick, self._end = other._start, other._tick, other._end
        self._latest, self._heard = {**other._latest, **self._constants}, other._heard
        self._came |= other._came

    def take(self, event: Event) -> list[Judged | None]:
        """The steps that `event` leads to; a message has the id, so it is not gone."""
        if isinstance(event, Heard):
            self._gone |= {signal: False for signal, topic in self._topics.items() if topic == event.said.topic}
        return super().take(event)

    def _taken(
        self, run: TimedRun, time: Nanoseconds, sample: Sample, topics: frozenset[str]
    ) -> Iterable[Judged | None]:
        """With its first message the slice begins, and what waits for nothing, whatever that is about."""
        is_first, self._is_born = not self._is_born, True
        if is_first and not self._of.waits and self._settings.rate is None:
            return self._judged(run, Instant(time, sample, topics, concerns_all=True))
        return super()._taken(run, time, sample, topics)

    def miss(self, time: Nanoseconds, topic: str) -> list[Judged | None]:
        """A message on `topic` has not its id."""
        assert self.run is not None
        missed: Sample = {s: True for s, of in self._topics.items() if of == topic and not self._gone[s]}
        self._gone |= dict.fromkeys(missed, True)
        if not missed:
            return []
        if self._settings.rate is not None:
            self._latest |= missed
            return []
        return self._judged(self.run, Instant(time, missed))


def _field(signal: Signal) -> Field:
    assert isinstance(signal.definition, Field)
    return signal.definition


def _path(signal: Signal) -> Path:
    """Where a message has the value of a signal: bytes as numbers."""
    return tuple(step for step in _field(signal).path if step != Bytes())


def _told(id_: bytes) -> str:
    return str(UUID(bytes=id_)) if len(id_) == 16 else id_.hex()


def _whole(value: Value) -> Id:
    assert not isinstance(value, tuple)
    return int(value) if isinstance(value, float) and value.is_integer() else value
