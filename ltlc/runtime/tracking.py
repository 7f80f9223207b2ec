"""What is known of one property while a run goes on: verdict, steps, episodes."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import (
    Callable,
    Collection,
    Container,
    Iterable,
    Iterator,
    Mapping,
    Sequence,
)
from copy import copy
from dataclasses import dataclass, field
from itertools import pairwise
from math import isnan
from typing import Any, NamedTuple, Protocol

from ltlc.runtime.sampling import Excused, New, Value, Wanted
from ltlc.runtime.times import NEVER
from ltlc.semantics.verdicts import Verdict


class SlicedBy(Protocol):
    """How a run is cut into slices, each of which is judged."""

    def start(self, track: Track, session: Any) -> Sliced:
        """Judge the property of `track` so, in a session that begins."""
        ...


class Sliced(Protocol):
    """Judges a property on slices of a run, one for each id, and tells of them.

    `take` is for messages at a time to which all is held, and `hold` takes the ticks
    before a time and the clock steps up to and including it, `advance` all that is due
    by it; before `due`, time changes nothing. `left_out` messages were not judged.
    """

    track: Track

    @property
    def left_out(self) -> int:
        """How many messages were not judged, because they found no place."""
        ...

    def begin(self, time: int) -> None:
        """The session begins."""
        ...

    def first_step(self, time: int) -> list[Change]:
        """Step what begins with the session and has not: no message was a step."""
        ...

    def take(
        self,
        time: int,
        names: tuple[str, ...],
        topics: frozenset[str],
        values: Sequence[Value],
    ) -> list[Change]:
        """Samples of `names` came in, and messages on `topics`."""
        ...

    def hold(self, time: int) -> list[Change]:
        """Do what is due before the messages at `time`."""
        ...

    def advance(self, time: int) -> list[Change]:
        """Do what is due by `time`."""
        ...

    def due(self) -> int:
        """When time may change something, if no message comes."""
        ...

    def is_calm(self, time: int) -> bool:
        """Whether nothing is due before the messages at `time`."""
        ...

    def tracks(self) -> Iterable[Track]:
        """Those of the slices that are kept; of others, the whole has the episodes."""
        ...

    def topics(self) -> frozenset[str]:
        """Those that are read."""
        ...

    def news(self) -> frozenset[str]:
        """The topics of which the property wants to know that a message came."""
        ...

    def since(self) -> str:
        """Which ids violated the property, and when; empty if none did."""
        ...

    def untold(self) -> Iterable[tuple[str, str]]:
        """What there is to tell of each violation that was not told, also as JSON."""
        ...

    def listed(self) -> dict[str, str]:
        """The ids that violate the property, and those for which something is owed."""
        ...

    def remarks(self) -> list[str]:
        """What else there is to say."""
        ...

    def figure(self) -> str:
        """What is told of the violations."""
        ...

    def document(self) -> dict[str, Any]:
        """The ids, in the JSON document of `ltlc run`."""
        ...


class Monitor(Protocol):
    """A generated monitor: `step` takes the values of the property's inputs in order.

    A step that is invalid because some value is NaN changes nothing but `invalid`. That
    of a property with clocks is made for the session that begins at a time; its `step`
    takes the time first. `due` is the last time before the next clock step, the moment
    at which a clock's answer changes, and `expire` takes that step.
    """

    state: int
    verdict: Verdict
    invalid: int
    due: int

    def step(self, *values: Value) -> Verdict:
        """Judge one more step."""
        ...

    def expire(self) -> None:
        """Take the clock step at `due + 1`."""
        ...


@dataclass(frozen=True, slots=True)
class Scope:
    """A scope of a property, and when it is open; `inner` are the scopes of its body.

    `opens` and `closes` judge the values that the property reads at a step, or are
    numbers of events of the property; without `closes` an episode lasts to the end of
    the run. `limit` is how many episodes can open, None for any number. With
    `overlapping` (the scope is under `always`, `never` or `eventually`) an episode
    opens inside an open one too.
    """

    text: str
    opens: Callable[..., bool] | int
    closes: Callable[..., bool] | int | None = None
    limit: int | None = None
    overlapping: bool = False
    inner: tuple[Scope, ...] = ()


@dataclass(frozen=True, slots=True)
class Condition:
    """A condition of a property at a step; `left` and `right` are what it compares.

    They include its margin, and are None where a boolean is not compared to anything.
    """

    text: str
    holds: bool
    left: Value = None
    right: Value = None


@dataclass(frozen=True, slots=True)
class Kept:
    """A value at an opening, which the monitor keeps in `attribute`."""

    text: str
    attribute: str

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True, slots=True)
class Clock:
    """A clock of a monitor: the attribute with its due time, and what it decides.

    There is a condition in `texts` for each of its `bounds`, ascending. Whether that
    holds is `late` from when on the clock is past the bound.
    """

    due: str
    texts: tuple[str, ...]
    bounds: tuple[int, ...]
    late: bool

    def passed(self, passed: int, before: int, after: int) -> int:
        """How many bounds have passed once its due time changes; none, if it starts."""
        gained = [b - a for a, b in pairwise(self.bounds)][passed : passed + 1]
        if [after - before] == gained:
            return passed + 1
        return passed if after == before else 0


Decision = tuple[int, int, int]
"""The number of a condition, where it leads if it fails, and where if it holds: to a
state, or, if negative, to the decision with the number `~target`. What a clock answers
counts as a condition, after the others: whether it is past its due time."""


@dataclass(frozen=True, slots=True)
class Age:
    """An age of `signal` that is asked for; messages renew it, no step does.

    It is over `bound` after the last message; `due` is the attribute that holds when.
    """

    signal: str
    due: str
    bound: int


@dataclass(frozen=True, slots=True)
class PastEvent:
    """An event that the past decides: what watches it is like a monitor with clocks.

    It happens as long as the verdict is that it holds. Of `ages`, as of a property.
    """

    watcher: Callable[[int], Monitor]
    ages: tuple[Age, ...] = ()


@dataclass(frozen=True, slots=True)
class MonitoredProperty:
    """A property, the monitor that judges it and the values that this monitor wants.

    What is read are the values of `inputs` and those that the monitor has `kept`, in
    this order. The property is `timed` if its monitor has clocks; then it may begin
    `from_session`, because it waits for no value: inputs that are `excused` are not
    waited for. `needed` has the places among `inputs` of arrays that must have a
    measurement. `scopes` are those that no other encloses, `events` those of their
    events that the past decides, `obligations` those parts of `text` that a run may
    leave open. `edges` has where each state of the monitor leads at a step,
    `held_edges` where at a clock step, through `decisions` about what `conditions`
    gives for the values that are read, and about `clocks`; all are empty where nothing
    violates the property. With a `slicing` it is judged for each id,
    and all of this is said of one slice.
    """

    label: str
    file: str
    line: int
    text: str
    inputs: tuple[Wanted, ...]
    monitor: Callable[..., Monitor]
    kept: tuple[Kept, ...] = ()
    timed: bool = False
    from_session: bool = False
    excused: tuple[Excused, ...] = ()
    needed: tuple[int, ...] = ()
    scopes: tuple[Scope, ...] = ()
    events: tuple[PastEvent, ...] = ()
    obligations: tuple[str, ...] = ()
    conditions: Callable[..., Iterable[Condition]] = lambda *values: ()
    clocks: tuple[Clock, ...] = ()
    ages: tuple[Age, ...] = ()
    edges: tuple[int, ...] = ()
    held_edges: tuple[int, ...] = ()
    decisions: tuple[Decision, ...] = ()
    slicing: SlicedBy | None = None

    @property
    def waits(self) -> tuple[bool, ...]:
        """Of each input, whether the property waits for it; news always has a value."""
        excused = {each.place for each in self.excused}
        return tuple(place not in excused for place in range(len(self.inputs)))


@dataclass(frozen=True, slots=True)
class Moment:
    """A step of a property, counted from 0, or a clock step after it; its time in ns.

    It is a clock step, and no step of the run, if the verdict changed `by_time`.
    """

    step: int
    time: int
    by_time: bool = field(default=False, kw_only=True)


@dataclass(frozen=True, slots=True)
class Opening(Moment):
    """The step at which an episode of `scope` opened."""

    scope: str


@dataclass(frozen=True, slots=True)
class Failure(Moment):
    """What decided a property, with the values that it was judged on.

    `because` are the conditions that violated it, whatever the others were: no fewer of
    them do. `open_since` is when something was owed last, `opened` has the latest
    episode, the latest inside that one, and so on.
    """

    values: tuple[tuple[str, Value], ...]
    because: tuple[Condition, ...]
    open_since: Moment | None
    opened: tuple[Opening, ...]


@dataclass(frozen=True, slots=True)
class Change:
    """A change of verdict, and the moment from which on `current` held."""

    property: MonitoredProperty
    previous: Verdict
    current: Verdict
    moment: Moment


def decisive(
    property_: MonitoredProperty,
    edge: int,
    holds: Sequence[bool],
    unknown: Collection[int] = (),
) -> tuple[int, ...]:
    """The conditions that lead from `edge` where all do; no fewer do.

    Those that are `unknown` are no reason where the others are enough.
    """
    asked, target = [], edge
    while target < 0:
        number, low, high = property_.decisions[~target]
        asked.append(number)
        target = high if holds[number] else low
    if unknown:
        known = [n for n in range(len(holds)) if n not in unknown]
        if _targets(property_, edge, {n: holds[n] for n in known}) == {target}:
            asked = known
    needed = dict.fromkeys(sorted(asked))
    for number in asked:
        others = {n: holds[n] for n in needed if n != number}
        if _targets(property_, edge, others) == {target}:
            del needed[number]
    return tuple(needed)


def _targets(
    property_: MonitoredProperty, edge: int, holds: Mapping[int, bool]
) -> set[int]:
    """Where `edge` can lead, if of the conditions only those in `holds` are known."""
    reached = [edge]
    for target in reached:
        if target < 0:
            number, low, high = property_.decisions[~target]
            known = holds.get(number)
            next_ = (low, high) if known is None else ((low, high)[known],)
            reached += [t for t in next_ if t not in reached]
    return {target for target in reached if target >= 0}


class Episodes:
    """Counts the episodes of one scope, and those inside its latest one."""

    __slots__ = ("count", "inner", "is_open", "opened", "opened_last", "scope")

    def __init__(self, scope: Scope) -> None:
        self.scope = scope
        self.inner: list[Episodes] = []
        self.count = 0
        self.is_open = False
        self.opened_last = False
        self.opened: Opening | None = None

    def step(
        self,
        step: int,
        time: int,
        values: Sequence[Value],
        past: Sequence[bool] = (),
        *,
        by_time: bool = False,
    ) -> None:
        """Open or close an episode; of the events that the past decides, `past` hold.

        At a clock step, which is `by_time`, nothing opens inside an open one.
        """
        scope = self.scope
        self.opened_last = False
        if scope.closes is not None and _happens(scope.closes, values, past):
            self.is_open = False
            return
        can_open = not self.is_open or (scope.overlapping and not by_time)
        may_open = can_open and self.count != scope.limit
        if may_open and _happens(scope.opens, values, past):
            self._open(Opening(step, time, scope.text, by_time=by_time))
        if self.is_open:
            for inner in self.inner:
                inner.step(step, time, values, past, by_time=by_time)

    def _open(self, opening: Opening) -> None:
        self.count += 1
        self.opened_last = True
        if not self.is_open:
            self.opened = opening
            self.inner = [Episodes(scope) for scope in self.scope.inner]
        self.is_open = True

    def repeat(self, times: int) -> None:
        """Do what the last step did, `times` more times."""
        if self.opened_last and self.scope.overlapping:
            self.count += times


def _happens(
    event: Callable[..., bool] | int, values: Sequence[Value], past: Sequence[bool]
) -> bool:
    return past[event] if isinstance(event, int) else event(*values)


class Watchers:
    """Those of the events of a property that the past decides, in a session.

    There is one of the `machines` for each.
    """

    def __init__(self, events: Sequence[PastEvent], session: int) -> None:
        self._events = events
        self.machines = [event.watcher(session) for event in events]

    def fork(self) -> Watchers:
        """Those that go on from here by themselves."""
        other = copy(self)
        other.machines = [forked(machine) for machine in self.machines]
        return other

    def hear(self, time: int, signals: Container[str]) -> tuple[Monitor, ...]:
        """Messages come: the ages of these signals count anew; where one was late."""
        pairs = zip(self._events, self.machines, strict=True)
        return tuple(w for e, w in pairs if count_anew(w, e.ages, time, signals))

    def step(self, time: int, values: Sequence[Value]) -> bool:
        """A step is taken; whether it changes nothing, and time alone will not."""
        before = [watcher.state for watcher in self.machines]
        for watcher in self.machines:
            watcher.step(time, *values)
        after = [watcher.state for watcher in self.machines]
        return before == after and self.due() >= NEVER

    def due(self) -> int:
        """When the next event may begin or end, unless a step comes first."""
        return min((watcher.due + 1 for watcher in self.machines), default=NEVER)

    def expire(self) -> None:
        """Take the clock steps that are due."""
        due = self.due()
        for watcher in self.machines:
            if watcher.due + 1 == due:
                watcher.expire()

    def happen(self) -> list[bool]:
        """Whether each event happens."""
        return [watcher.verdict.holds for watcher in self.machines]


def forked(monitor: Monitor) -> Monitor:
    """A monitor that goes on from here by itself, and counts by itself."""
    other = copy(monitor)
    for name, value in vars(monitor).items():
        if value.__class__ is deque:
            setattr(other, name, value.copy())
    return other


def state_of(monitor: Monitor) -> tuple[object, ...]:
    """What decides how a monitor goes on."""
    values = vars(monitor).values()
    return tuple(tuple(v) if v.__class__ is deque else v for v in values)


def count_anew(
    monitor: Monitor, ages: Iterable[Age], time: int, signals: Container[str]
) -> bool:
    """The ages of these signals count from `time`; whether one was late."""
    was_late = False
    for age in ages:
        if age.signal in signals:
            was_late |= time > getattr(monitor, age.due)
            setattr(monitor, age.due, time + age.bound)
    return was_late


def latest(scopes: Sequence[Episodes]) -> tuple[Opening, ...]:
    """The latest episode of `scopes`, the latest inside that one, and so on."""
    opened = [(one.opened.step, one) for one in scopes if one.opened is not None]
    if not opened:
        return ()
    _, last = max(opened, key=lambda pair: pair[0])
    assert last.opened is not None
    return (last.opened, *latest(last.inner))


class Before(NamedTuple):
    """The state of a monitor before a step, and when each of its clocks was due."""

    state: int
    dues: Sequence[int]


def reason(property_: MonitoredProperty, values: Sequence[Value]) -> str:
    """Why there is no step where the inputs have these values, of which a NaN came."""
    if any(map(_is_nan, values)):
        return "a value was NaN"
    causes = [
        f"all of {property_.inputs[place]} was NaN"
        if value
        else f"{property_.inputs[place]} was empty"
        for place in property_.needed
        if (value := values[place]) is not None and all(map(_is_nan, value))
    ]
    said = "an expression had no value"
    return f"{said}: {', '.join(causes)}" if causes else said


def _is_nan(value: Value) -> bool:
    return value.__class__ is float and isnan(value)


class Observer(Protocol):
    """Is told of what a property goes through until it is decided, as it happens."""

    def moved(
        self, track: Track, before: int, moment: Moment, change: Change | None
    ) -> None:
        """A step or clock step was taken from the state `before`."""
        ...

    def scoped(self, track: Track, moment: Moment) -> None:
        """Episodes may have opened and closed."""
        ...

    def changed(self, change: Change) -> None:
        """The verdict on all slices is new."""
        ...


class Track:
    """One property in one run.

    It `began` with its first step, before which so many messages were `skipped` of each
    topic that it reads, because something had no value yet. `scopes` are its episodes,
    and `judged_on` the values at the last step before it was decided. If they are kept,
    `verdicts`, `times` and `values` have one for each step, the last what it was judged
    on, and `changes` all changes of the verdict. If it is judged for each id, `slices`
    has what is known of these.
    """

    __slots__ = (
        "_counts_bounds",
        "_excuses",
        "_has_events",
        "_invalid_last",
        "_keeps",
        "_passed",
        "_reads",
        "_renewed",
        "began",
        "changes",
        "decided_at",
        "delays",
        "invalid_because",
        "is_settled",
        "is_timed",
        "judged_on",
        "longest_delay",
        "monitor",
        "observer",
        "open_since",
        "property",
        "scopes",
        "skipped",
        "slices",
        "steps",
        "times",
        "values",
        "verdict",
        "verdicts",
        "watchers",
    )

    def __init__(
        self,
        property_: MonitoredProperty,
        keep_verdicts: bool = False,
        observer: Observer | None = None,
    ) -> None:
        self.property = property_
        self.observer = observer
        self.slices: Sliced | None = None
        self.is_timed, self._keeps = property_.timed, bool(property_.kept)
        self._has_events = bool(property_.events)
        self._excuses = bool(property_.excused)
        self._reads = (*property_.inputs, *property_.kept)
        self.verdicts: list[Verdict] | None = [] if keep_verdicts else None
        self.times: list[int] = []
        self.values: list[Sequence[Value]] = []
        self.changes: list[Change] = []
        self.begin(0)
        self.verdict = Verdict.NOT_STARTED
        self.steps = 0
        self.began: int | None = None
        self.skipped: dict[str, int] = {}
        self.decided_at: Failure | None = None
        self.open_since: Moment | None = None
        self.delays = 0
        self.longest_delay = 0
        self.is_settled = True
        self.scopes = [Episodes(scope) for scope in property_.scopes]
        self.invalid_because: Counter[str] = Counter()
        self._passed = [0] * len(property_.clocks)
        self._counts_bounds = any(len(clock.bounds) > 1 for clock in property_.clocks)
        self._invalid_last: str | None = None
        self._renewed: tuple[Monitor, ...] = ()
        self.judged_on: Sequence[Value] = ()

    def fork(self) -> Track:
        """What goes on from here by itself, of a property no scope of which is open.

        What is kept for whole runs only, such as `skipped`, is shared.
        """
        other = copy(self)
        other.monitor = forked(self.monitor)
        if self._has_events:
            other.watchers = self.watchers.fork()
        if self.scopes:
            other.scopes = [copy(scope) for scope in self.scopes]
        if self._counts_bounds:
            other._passed = self._passed.copy()
        return other

    def __copy__(self) -> Track:
        other = Track.__new__(Track)
        for name in Track.__slots__:
            setattr(other, name, getattr(self, name))
        return other

    def begin(self, session: int) -> None:
        """The session begins; ages count from then."""
        make = self.property.monitor
        self.monitor = make(session) if self.property.timed else make()
        self.watchers = Watchers(self.property.events, session)

    def hear(self, time: int, signals: Container[str]) -> None:
        """Messages come: the ages of these signals count anew, whatever the values.

        If one was late and no step is taken now, the next thing is to `renew`.
        """
        if self.decided_at is not None:
            return
        if count_anew(self.monitor, self.property.ages, time, signals):
            self._renewed += (self.monitor,)
        if self.property.events:
            self._renewed += self.watchers.hear(time, signals)

    @property
    def is_renewed(self) -> bool:
        """Whether an age that was late is no more, and no step has been taken since."""
        return bool(self._renewed)

    def renew(self, time: int) -> list[Change]:
        """Take the clock step at which a late age is young, by what makes no step."""
        renewed, self._renewed = self._renewed, ()
        if not self.steps:
            return []
        for monitor in renewed:
            monitor.due = time - 1
        return self.hold(time)

    def count_delay(self, delay: int) -> None:
        """A verdict that time decided was told so much too late."""
        self.delays += 1
        self.longest_delay = max(self.longest_delay, delay)

    @property
    def invalid(self) -> int:
        """How many steps were none because some value was NaN."""
        return self.monitor.invalid

    @property
    def episodes(self) -> int | None:
        """How many episodes opened; None for a property without scopes."""
        if not self.scopes:
            return None
        others = () if self.slices is None else self.slices.tracks()
        count = sum(scope.count for scope in self.scopes)
        return count + sum(track.episodes or 0 for track in others)

    @property
    def never_triggered(self) -> bool:
        """Whether the property holds only because no scope of it ever opened."""
        holds = self.verdict in (Verdict.SATISFIED, Verdict.PRESUMABLY_SATISFIED)
        return holds and self.episodes == 0

    @property
    def due(self) -> int:
        """When the next clock step comes, unless a step comes first."""
        return self.monitor.due + 1 if self.property.timed else NEVER

    @property
    def next(self) -> int:
        """When `hold` has something to do next, unless a step comes first."""
        due = self.monitor.due + 1 if self.property.timed else NEVER
        if self.property.events and self.decided_at is None:
            due = min(due, self.watchers.due())
        return due

    def deadline(self) -> int | None:
        """When time alone violates the property; None if it never does."""
        ahead, moment = copy(self.monitor), None
        while self.property.timed and ahead.due < NEVER:
            moment = ahead.due + 1
            ahead.expire()
        return moment if ahead.verdict is Verdict.VIOLATED else None

    def hold(self, time: int) -> list[Change]:
        """Take the clock steps up to and including `time`, with no step until then."""
        changes = []
        while self.due <= time:
            moment = Moment(self.steps - 1, self.due, by_time=True)
            self._take(moment.time)
            self._watch(moment.time)
            change = self._expire(moment)
            if change is not None:
                changes.append(change)
        self._watch(time)
        return changes

    def _take(self, time: int) -> None:
        """If a scope opens at `time`, the values at its opening are those held.

        The monitor takes them in clock steps of their own, after which the next one is
        due as before.
        """
        if not self.property.kept:
            return
        self._watch(time - 1)
        while self.due == time:
            ahead = copy(self.monitor)
            ahead.expire()
            if ahead.due + 1 != time:
                return
            self.monitor = ahead

    def _expire(self, moment: Moment) -> Change | None:
        """Take the clock step that is due at `moment`."""
        before = Before(self.monitor.state, self._dues())
        self.monitor.expire()
        change = None
        if self.monitor.verdict is not self.verdict:
            change = self._change(before, moment, self._held())
        if self._counts_bounds:
            self._count_bounds(before.dues)
        if self.observer is not None:
            self.observer.moved(self, before.state, moment, change)
        return change

    def _watch(self, time: int) -> None:
        """Open and close the episodes that time opens and closes up to `time`."""
        if not self.property.events:
            return
        while self.decided_at is None and (due := self.watchers.due()) <= time:
            self.watchers.expire()
            self._open_and_close(self.steps - 1, due, self._held(), by_time=True)

    def _open_and_close(
        self, step: int, time: int, values: Sequence[Value], *, by_time: bool = False
    ) -> None:
        past = self.watchers.happen() if self.property.events else ()
        if self._excuses:
            values = self.given(values)
        for scope in self.scopes:
            scope.step(step, time, values, past, by_time=by_time)
        if self.observer is not None:
            self.observer.scoped(self, Moment(step, time, by_time=by_time))

    def _dues(self) -> list[int]:
        """When each clock is due."""
        monitor = self.monitor
        return [getattr(monitor, clock.due) for clock in self.property.clocks]

    def _count_bounds(self, before: Sequence[int]) -> None:
        """Count the bounds that have passed on each clock, which was due `before`."""
        for number, clock in enumerate(self.property.clocks):
            after = getattr(self.monitor, clock.due)
            passed = clock.passed(self._passed[number], before[number], after)
            self._passed[number] = passed

    def _held(self) -> tuple[Value, ...]:
        """The values of the last step, without its news, and those at openings."""
        # What is not there yet is not read: before the first step no scope is open.
        inputs = zip(self.property.inputs, self.judged_on, strict=False)
        held = (False if isinstance(i, New) else value for i, value in inputs)
        return (*held, *self._kept())

    def _kept(self) -> Iterator[Value]:
        """The values at openings, as they are now."""
        return (getattr(self.monitor, each.attribute) for each in self.property.kept)

    def step(self, time: int, values: Sequence[Value]) -> Change | None:
        """Judge one more step, to whose time the property was held."""
        given = values
        if self._excuses and None in values:
            if (missed := self._missed(values)) is not None:
                self._count_none(f"a message had no value of {missed}")
                return None
            given = self.given(values)
        monitor, is_timed = self.monitor, self.is_timed
        state, invalid = monitor.state, monitor.invalid
        dues = self._dues() if is_timed else ()
        verdict = monitor.step(time, *given) if is_timed else monitor.step(*given)
        self.is_settled = state == monitor.state
        if invalid != monitor.invalid:
            self._invalid_last = reason(self.property, given)
            self.invalid_because[self._invalid_last] += 1
            return None
        self._invalid_last = None
        self._renewed = ()
        if self._keeps:
            values = (*values, *self._kept())
        if self.verdicts is not None:
            self.verdicts.append(verdict)
            self.times.append(time)
            self.values.append(values)
        step = self.steps
        self.steps = step + 1
        if self.decided_at is not None:
            return None
        self.judged_on = values
        if self._has_events:
            self.is_settled &= self.watchers.step(time, given)
        if self.scopes:
            self._open_and_close(step, time, values)
        change = None
        if verdict is not self.verdict:
            change = self._change(Before(state, dues), Moment(step, time), values)
        if self._counts_bounds:
            self._count_bounds(dues)
        if self.observer is not None:
            self.observer.moved(self, state, Moment(step, time), change)
        return change

    def is_ready(self, values: Sequence[Value]) -> bool:
        """Whether all that the property waits for has a value, if not all has."""
        if not self._excuses:
            return False
        pairs = zip(values, self.property.waits, strict=True)
        return not any(waits and value is None for value, waits in pairs)

    def given(self, values: Sequence[Value]) -> Sequence[Value]:
        """`values` with others, which make no difference, for those missing."""
        given = list(values)
        for each in self.property.excused:
            if given[each.place] is None:
                given[each.place] = each.instead
        return given

    def _missed(self, values: Sequence[Value]) -> Wanted | None:
        """What has no value though all its news came, as by a message without one."""
        for each in self.property.excused:
            if values[each.place] is None and all(values[n] for n in each.news):
                return self.property.inputs[each.place]
        return None

    def _count_none(self, because: str) -> None:
        """A step is none, though no value is NaN."""
        self.monitor.invalid += 1
        self.is_settled, self._invalid_last = True, because
        self.invalid_because[because] += 1

    def _change(
        self, before: Before, moment: Moment, values: Sequence[Value]
    ) -> Change:
        """The verdict at `moment` is new, as it is at the first step."""
        if self.began is None:
            self.began = moment.time
        verdict = self.monitor.verdict
        if verdict.is_permanent:
            self.decided_at = self._failure(before, moment, values)
        previous, self.verdict = self.verdict, verdict
        is_open = verdict is Verdict.PRESUMABLY_VIOLATED
        self.open_since = moment if is_open else None
        change = Change(self.property, previous, verdict, moment)
        if self.verdicts is not None:
            self.changes.append(change)
        return change

    def _failure(
        self, before: Before, moment: Moment, values: Sequence[Value]
    ) -> Failure:
        """What there is to know of the moment that decided the property."""
        because: tuple[Condition, ...] = ()
        if self.monitor.verdict is Verdict.VIOLATED:
            because = self._reasons(before, moment, values)
        return Failure(
            moment.step,
            moment.time,
            tuple(zip(map(str, self._reads), values, strict=True)),
            because,
            self.open_since,
            latest(self.scopes),
            by_time=moment.by_time,
        )

    def _reasons(
        self, before: Before, moment: Moment, values: Sequence[Value]
    ) -> tuple[Condition, ...]:
        """The conditions that led to the violation.

        At a clock step some clock is late, which the monitor may well not ask.
        """
        of = self.property
        late = [due < moment.time for due in before.dues]
        found = list(of.conditions(*self.given(values)))
        holds = [*(condition.holds for condition in found), *late]
        for clock, is_late, n in zip(of.clocks, late, self._passed, strict=True):
            found.append(Condition(clock.texts[n], is_late == clock.late))
        edges = of.held_edges if moment.by_time else of.edges
        unknown = {
            n for e in of.excused if values[e.place] is None for n in e.conditions
        }
        numbers = decisive(of, edges[before.state], holds, unknown)
        first = len(holds) - len(late)
        if moment.by_time and not any(number >= first for number in numbers):
            passed = (n for n, is_late in enumerate(late, first) if is_late)
            numbers = (*numbers, *passed)
        return tuple(found[number] for number in numbers)

    def repeat(self, times: int, at: Iterable[int]) -> None:
        """Judge the last step `times` more times, `at` the times that it gives.

        The monitor must have settled on that step, and no clock step come in between.
        """
        if self._invalid_last is not None:
            self.monitor.invalid += times
            self.invalid_because[self._invalid_last] += times
            return
        if not self.steps:
            return
        self.steps += times
        if self.verdicts is not None:
            self.verdicts += [self.verdict] * times
            self.times += at
            self.values += [self.values[-1]] * times
        if self.decided_at is None:
            for scope in self.scopes:
                scope.repeat(times)
