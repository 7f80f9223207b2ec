"""Which ids came, which of them are kept, and the verdict of their slices together."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection

from ltlc.dataclass import dataclass
from ltlc.runtime.courses import Course
from ltlc.runtime.episodes import Episodes, forked
from ltlc.runtime.properties import Failure, MonitoredProperty
from ltlc.runtime.sampling import Value
from ltlc.runtime.slice_keys import Id, id_of
from ltlc.runtime.times import NEVER
from ltlc.semantics.verdicts import Verdict


class Slice(Course):
    """The run of one id, as far as it is known.

    known: its samples, and those that all slices share
    counted: the verdict as which it was counted
    scheduled: up to when time does not change it, as it was noted
    """

    __slots__ = ("counted", "id", "known", "scheduled")

    def __init__(
        self,
        id_: Id,
        property_: MonitoredProperty,
        invalid_because: Counter[str],
        known: list[Value],
        session: int = 0,
    ) -> None:
        super().__init__(property_, invalid_because, session)
        self.id = id_
        self.known = known
        self.counted = Verdict.NOT_STARTED
        self.scheduled = NEVER

    def fork(self) -> Slice:
        """What goes on from here by itself, of a property no scope of which opened."""
        other = Slice.__new__(Slice)
        for name in (*Course.__slots__, *Slice.__slots__):
            setattr(other, name, getattr(self, name))
        other.monitor = forked(self.monitor)
        other.scopes = tuple(map(Episodes, self.property.scopes))
        other.watchers = self.watchers.fork()
        return other


@dataclass(frozen=True, slots=True)
class Violation:
    """What decided a slice, whose beginning may be missing, and `more` like it."""

    failure: Failure
    lacks_beginning: bool
    more: int = 0


class Ids:
    """The ids that came, of which at most `limit` are kept, None is any number.

    slices: those that are not decided
    violated, satisfied: the ids of the others
    forgotten: all others that came, if there is no limit; `births` counts slices
    lacking: those of them of which messages before the first may have found no place
    calm: the verdict if no obligation is open and nothing is violated
    messages: how many messages had an id; of others, `without_id` counts those that had
    none, `left_out` those of which the id found no place
    """

    def __init__(self, limit: int | None) -> None:
        self.limit = limit
        self.slices: dict[Id, Slice] = {}
        self.violated: dict[Id, Violation] = {}
        self.satisfied: set[Id] = set()
        self.forgotten: set[Id] = set()
        self.lacking: set[Id] = set()
        self.births = self.messages = self.without_id = self.left_out = 0
        self.calm = Verdict.NOT_STARTED
        self._owed = self._failed = 0

    def counted(self, value: Value) -> Id | None:
        """The id of a message; None if it has none."""
        id_ = None if value is None else id_of(value)
        if id_ is None:
            self.without_id += 1
        else:
            self.messages += 1
        return id_

    def is_decided(self, id_: Id) -> bool:
        """Whether the slice of an id was decided."""
        return id_ in self.satisfied or id_ in self.violated

    def find_place(self) -> bool:
        """Whether another slice can begin; if not, a message is left out."""
        has_place = self.has_place()
        self.left_out += not has_place
        return has_place

    def has_place(self) -> bool:
        """Whether there is a place for another slice."""
        return self.limit is None or self._kept() < self.limit

    def _kept(self) -> int:
        """How many ids are kept."""
        return len(self.slices) + len(self.satisfied) + len(self.violated)

    @property
    def came(self) -> int:
        """How many ids came, if there is no limit."""
        return self._kept() + len(self.forgotten)

    def keep(self, one: Slice) -> None:
        """A slice is kept from now on."""
        self.births += 1
        self.slices[one.id] = one
        self.forgotten.discard(one.id)

    def meet(self, ids: Collection[Id], *, has_started: bool) -> None:
        """These came elsewhere; if a slice has started that is not kept, it is well."""
        decided = self.satisfied.union(self.violated)
        self.forgotten.update(id_ for id_ in ids if id_ not in decided)
        if has_started:
            self.calm = Verdict.PRESUMABLY_SATISFIED

    def count(self, one: Slice) -> None:
        """Count a slice by its verdict."""
        verdict, before = one.verdict, one.counted
        one.counted = verdict
        self._owed += verdict is Verdict.PRESUMABLY_VIOLATED
        self._owed -= before is Verdict.PRESUMABLY_VIOLATED
        self._failed += verdict is Verdict.VIOLATED
        self._failed -= before is Verdict.VIOLATED
        if verdict is not Verdict.NOT_STARTED:
            self.calm = Verdict.PRESUMABLY_SATISFIED

    def decide(self, one: Slice, failure: Failure) -> None:
        """A slice was decided, and dropped; its id is kept."""
        if one.verdict is Verdict.VIOLATED:
            self.violated[one.id] = Violation(failure, one.id in self.lacking)
        else:
            self.satisfied.add(one.id)

    @property
    def well(self) -> int:
        """How many slices are satisfied."""
        return len(self.satisfied)

    @property
    def failed(self) -> int:
        """How many slices are violated."""
        return len(self.violated)

    def verdict(self) -> Verdict:
        """That of the whole: never satisfied, for another id may come."""
        if self._failed:
            return Verdict.VIOLATED
        return Verdict.PRESUMABLY_VIOLATED if self._owed else self.calm


class Messages(Ids):
    """Messages by their numbers: each opens an instance, at most `limit` are open.

    An instance is a slice that has all that comes after its message, for itself and for
    `more` that go on like it and are not kept. `unopened` counts the messages from
    which on nothing was judged, because something had no value.
    """

    def __init__(self, limit: int | None) -> None:
        super().__init__(limit)
        self.more: Counter[Id] = Counter()
        self.unopened = self._well = 0

    def number(self) -> int:
        """That of a message which comes now, counted from 1."""
        self.messages += 1
        return self.messages

    def _kept(self) -> int:
        """How many instances are open."""
        return len(self.slices)

    @property
    def well(self) -> int:
        """From how many messages on the property is satisfied."""
        return self._well

    @property
    def failed(self) -> int:
        """From how many messages on the property is violated."""
        return sum(1 + each.more for each in self.violated.values())

    def withdraw(self) -> None:
        """An instance has not opened, after all."""
        self.births -= 1
        self.unopened += 1

    def merge(self, one: Slice, other: Slice) -> None:
        """What becomes of `one` becomes of `other`, which is dropped."""
        self._owed -= other.counted is Verdict.PRESUMABLY_VIOLATED
        self.more[one.id] += 1 + self.more.pop(other.id, 0)

    def decide(self, one: Slice, failure: Failure) -> None:
        """An instance was decided, and dropped."""
        more = self.more.pop(one.id, 0)
        if one.verdict is Verdict.VIOLATED:
            self.violated[one.id] = Violation(failure, False, more)
        else:
            self._well += 1 + more
