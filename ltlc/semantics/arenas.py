"""Arenas and regions: what the game of a guard is played on, and where the guard may rest.

A guard and the world take turns: the world says something on another topic, or lets time pass; the guard may answer
with a fallback. A *joint place* is where each property is: its monitor and the clocks of its reset machine. What is
held of all topics, the letter, is not part of it: a region gives each joint place a state predicate.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum
from functools import cached_property
from typing import NamedTuple

from ltlc.dataclass import dataclass
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.reset_machine import Clocks, ResetMachine
from ltlc.semantics.verdicts import Verdict

Effect = Mapping[str, bool | str | None]
"""What each atom is after a message: a constant, what the atom of that name was before it, or unknown."""


@dataclass(frozen=True, slots=True)
class Sending:
    """A fallback as the game sees it: the guard can send it at any time, on the topic `out`."""

    name: str
    out: str
    effect: Effect


@dataclass(frozen=True)
class Part:
    """A property that is kept, or assumed.

    `topics` are those that it reads, `news` its atoms of messages, each with its topic. It begins when there are values
    on those that it `waits` for; for these, `history` messages have to leave a guard before the one at which it begins.
    """

    label: str
    formula: Formula
    monitor: Monitor
    topics: frozenset[str]
    waits: frozenset[str]
    news: Mapping[str, str]
    history: int = 0
    is_assumed: bool = False

    @cached_property
    def time(self) -> ResetMachine:
        """Which words are runs in time."""
        return ResetMachine(self.formula)


class Place(NamedTuple):
    """Where one property is: the state of its monitor, and its clocks."""

    state: int
    clocks: Clocks


class Outcome(Enum):
    """Where a property is whose monitor does not run: not yet, or no more."""

    WAITING = "waiting"
    SATISFIED = "satisfied"
    VIOLATED = "violated"


Standing = Place | Outcome


Sent = tuple[int, ...] | None
"""How many messages have left on each topic of a guard, as far as it matters; None while the guards are silent.

They are until each other topic has spoken that is read by a property which waits for any value.
"""


class Joint(NamedTuple):
    """Where all parts of an arena are."""

    sent: Sent
    standings: tuple[Standing, ...]


@dataclass(frozen=True)
class Arena:
    """Guards that share properties, and all that they have to keep.

    `outs` are the topics that they send on, `others` the rest of those that the properties read. `read` gives each atom
    of values the topics whose messages can change it; `loose` are those that may change at any instant. `alphabet` says
    which letters of them exist.
    """

    outs: tuple[str, ...]
    others: tuple[str, ...]
    alphabet: Alphabet
    read: Mapping[str, frozenset[str]]
    loose: frozenset[str]
    fallbacks: tuple[Sending, ...]
    parts: tuple[Part, ...]

    @property
    def has_several_clocks(self) -> bool:
        """Whether more than one clock may run: places do not tell which of them passes its bound first."""
        return sum(bool(tracker.bounds) for part in self.parts for tracker in part.time.trackers) > 1

    @property
    def start(self) -> Joint:
        """Before anything has come."""
        awaited = frozenset[str]().union(*(part.topics for part in self.parts if part.waits)).difference(self.outs)
        return Joint(None if awaited else (0,) * len(self.outs), (Outcome.WAITING,) * len(self.parts))

    @cached_property
    def most(self) -> tuple[int, ...]:
        """As far as messages are counted: so many suffice for all parts to have begun."""
        return tuple(1 + max([p.history for p in self.parts if out in p.waits], default=0) for out in self.outs)

    def sent_after(self, sent: Sent, topic: str) -> list[Sent]:
        """What may be `sent` after a message on `topic`; while the guards are silent, it may be the last awaited."""
        if sent is None:
            return [None, (0,) * len(self.outs)]
        return [tuple(min(n + (o == topic), most) for n, o, most in zip(sent, self.outs, self.most, strict=True))]

    def beginnings(self, part: Part, before: Sent, sent: Sent, topic: str) -> tuple[bool, ...]:
        """Whether `part`, which waits, may and has to begin with a message on `topic`: so much is `sent` after it."""
        awaited = part.waits.intersection(self.outs)
        if not part.waits:
            return (True,)
        if not awaited:  # its last value is one of those that the guards are silent for
            return (True, False) if sent is None else (before is None,)
        if sent is None or topic not in awaited:
            return (False,)
        return (all(n > part.history for n, out in zip(sent, self.outs, strict=True) if out in awaited),)

    def outcome(self, joint: Joint) -> Outcome | None:
        """SATISFIED where an assumption is broken, else VIOLATED where a kept property is, else None."""
        violated = [p for p, at in zip(self.parts, joint.standings, strict=True) if at is Outcome.VIOLATED]
        if any(part.is_assumed for part in violated):
            return Outcome.SATISFIED
        return Outcome.VIOLATED if violated else None


def standing(part: Part, state: int, clocks: Clocks) -> Standing:
    """Where `part` is when its monitor is in `state`."""
    match part.monitor.verdicts[state]:
        case Verdict.VIOLATED:
            return Outcome.VIOLATED
        case Verdict.SATISFIED:
            return Outcome.SATISFIED
        case _:
            return Place(state, clocks)


Ticks = frozenset[tuple[int, int]]
"""Clocks, each by the numbers of its part and of its tracker there."""


@dataclass(frozen=True)
class Region:
    """Where guards may rest, and what they do where they may not: the certificate of a guard.

    `rests` gives joint places the letters at which a guard may be silent whatever comes, `answers` those after which it
    sends a fallback at once, `acts` those at which it sends one before some clocks pass their bounds. Fallbacks go by
    their numbers in the arena.
    """

    rests: Mapping[Joint, Formula]
    answers: Mapping[tuple[Joint, int], Formula]
    acts: Mapping[tuple[Joint, Ticks, int], Formula]
