"""A property as it is judged during a run, and what is reported about its verdict."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import field
from itertools import pairwise
from operator import attrgetter
from typing import Any, Protocol

from ltlc.dataclass import dataclass
from ltlc.runtime.sampling import Excused, Value, Wanted
from ltlc.semantics.verdicts import Verdict


class SlicedBy(Protocol):
    """How a run is cut into slices, each of which is judged."""

    def start(self, track: Any, session: Any) -> Any:
        """Judge the property of a `track` so, in a session that begins: by `Slices`."""
        ...


class Monitor(Protocol):
    """A generated monitor: `step` takes the values of the property's inputs in order.

    A step that is invalid because some value is NaN changes nothing but `invalid`. That
    of a property with clocks is made for the session that begins at a time; its `step`
    takes the time first. `due` is the last time before the next clock step, the moment
    at which a clock's answer changes, and `expire` takes that step.
    """

    __slots__: tuple[str, ...]
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
    The `relation` is that of numbers in order, or empty. If it asks for an `age`, that
    is in ns, unless it has just passed the bound. If it fails since something has not
    `lasted` long enough, that is how long it had, in ns; if it asks whether something
    held of late, it last did so long `ago`. If one `element` of arrays makes it hold or
    fail, that is its index and, by the name of each array, its value.
    """

    text: str
    holds: bool
    left: Value = None
    right: Value = None
    relation: str = ""
    age: int | None = None
    lasted: int | None = None
    ago: int | None = None
    element: tuple[int, tuple[tuple[str, Value], ...]] | None = None


@dataclass(frozen=True, slots=True)
class Elements:
    """The condition with this number is about elements of the inputs at these places.

    Some first element decides it: the one whose value it compares (`is_extreme`), or
    else the first with which it holds, or fails.
    """

    condition: int
    places: tuple[int, ...]
    is_extreme: bool = False


Constants = Mapping[str, Mapping[Value, str]]
"""Of inputs, by name, what their messages call some of their values."""


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
    holds is `late` from when on the clock is past the bound. A count has no bounds: the
    clock moves with what occurs at a step, before the step asks for its one condition.
    That of an age (`is_age`) counts from the last message; if it `is_recent`, the clock
    of `once p within D`, from the last moment at which p held.
    """

    due: str
    texts: tuple[str, ...]
    bounds: tuple[int, ...]
    late: bool
    is_age: bool = False
    is_recent: bool = False

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


Remembered = tuple[str, tuple[bool | None, ...], tuple[int, ...]]
"""What is asked about the instant before, whether it is so in each state of a monitor,
if that is known, and the numbers of conditions that are asked for nothing else."""


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


def _dues(names: Sequence[str]) -> Callable[[Monitor], tuple[int, ...]]:
    """What takes the attributes `names` of a monitor."""
    if len(names) > 1:
        return attrgetter(*names)
    # Of one attribute, `attrgetter` would give no tuple.
    return lambda monitor: (getattr(monitor, names[0]),) if names else ()


@dataclass(frozen=True, slots=True)
class MonitoredProperty:
    """A property, the monitor that judges it and the values that this monitor wants.

    What is read are the values of `inputs` and those that the monitor has `kept`, in
    this order. The property is `timed` if its monitor has clocks. It begins
    `from_session` if it waits for no value: inputs that are `excused` are not waited
    for. `needed` has the places among `inputs` of arrays that must have a
    measurement. `scopes` are those that no other encloses, `events` those of their
    events that the past decides, `obligations` those parts of `text` that a run may
    leave open. `edges` has where each state of the monitor leads at a step,
    `held_edges` where at a clock step, through `decisions` about what `conditions`
    gives for the values that are read, and about `clocks`; all are empty where nothing
    violates the property. What its states say of the instant before is `remembered`. Of
    conditions about arrays, `elements` says what decides them; `constants` are names of
    values of inputs, and `written` what the author calls inputs by, where that is not
    their names. With a `slicing` it is judged for each id, and all of this is said of
    one slice. The `requirement` that it states is
    an object of JSON: its `id`, `text` and `attributes`; without any it is empty.

    It `waits` for those of its inputs that are not excused; news always has a value.
    `dues` of a monitor are when each of its clocks is due; with `counts_bounds`, some
    clock has several bounds; if it `recalls`, it is explained by when some were due. A
    step of it `has_more` than a step of the monitor where there are scopes, or values
    at openings.
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
    remembered: tuple[Remembered, ...] = ()
    elements: tuple[Elements, ...] = ()
    constants: Constants = field(default_factory=dict)
    written: Mapping[str, str] = field(default_factory=dict)
    slicing: SlicedBy | None = None
    requirement: Mapping[str, Any] = field(default_factory=dict)

    waits: tuple[bool, ...] = field(init=False, repr=False, compare=False)
    dues: Callable[[Monitor], tuple[int, ...]] = field(
        init=False, repr=False, compare=False
    )
    counts_bounds: bool = field(init=False, repr=False, compare=False)
    recalls: bool = field(init=False, repr=False, compare=False)
    has_more: bool = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        excused = {each.place for each in self.excused}
        names = [clock.due for clock in self.clocks]
        derived = {
            "waits": tuple(n not in excused for n in range(len(self.inputs))),
            "dues": _dues(names),
            "counts_bounds": any(len(clock.bounds) > 1 for clock in self.clocks),
            "recalls": self.slicing is None and any(c.is_recent for c in self.clocks),
            "has_more": bool(self.kept or self.scopes or self.events),
        }
        for name, value in derived.items():
            object.__setattr__(self, name, value)

    def traced(self) -> dict[str, Any]:
        """What a JSON object about the property has about its requirement."""
        return {"requirement": self.requirement} if self.requirement else {}

    def is_ready(self, values: Sequence[Value]) -> bool:
        """Whether all that the property waits for has a value, if not all has."""
        if not self.excused:
            return False
        pairs = zip(values, self.waits, strict=True)
        return not any(waits and value is None for value, waits in pairs)

    def given(self, values: Sequence[Value]) -> Sequence[Value]:
        """`values` with others for those missing."""
        return _with(self.excused, values)

    def shown(self, values: Sequence[Value]) -> Sequence[Value]:
        """`values`, with what signals without samples are, if that is defined."""
        return _with((each for each in self.excused if not each.news), values)

    def missed(self, values: Sequence[Value]) -> Wanted | None:
        """What has no value though all its news came, as by a message without one."""
        for each in self.excused:
            is_missing = each.news and values[each.place] is None
            if is_missing and all(values[n] for n in each.news):
                return self.inputs[each.place]
        return None


def stated(requirement: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """A requirement as pairs: its text, as `requirement`, and values of attributes."""
    if requirement.get("text"):
        yield "requirement", requirement["text"]
    for key, values in requirement.get("attributes", {}).items():
        yield from ((key, value) for value in values)


def _with(excused: Iterable[Excused], values: Sequence[Value]) -> Sequence[Value]:
    """`values` with what is given instead of those of them that are missing."""
    given = list(values)
    for each in excused:
        if given[each.place] is None:
            given[each.place] = each.instead
    return given


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
