"""What `ltlc.monitoring.measuring` measures in a recording, and the limits that are made of it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import field
from decimal import Decimal

from ltlc.dataclass import dataclass
from ltlc.semantics.durations import Nanoseconds, duration_text
from ltlc.specification.text import outwards
from ltlc.specification.wire import DOUBLES, Kind, Numbers

MOST_DIFFERENT = 8
"""At most so many different values of an expression are distinguished."""

ROOM = Decimal("0.2")
"""By this share limits on values are wider than what was measured."""

ROOM_IN_TIME = 2
"""So many times as long as what was measured are limits on time."""


@dataclass(frozen=True, slots=True)
class Probe:
    """What is measured: the values of a number or a string, or whether a state predicate holds; `text` says it."""

    text: str
    kind: str

    @property
    def property(self) -> str:
        """A property whose steps are those at which it is measured."""
        beside = {"number": " > 0", "string": ' == ""', "predicate": ""}
        return f"never ({self.text}){beside[self.kind]}"


@dataclass(slots=True)
class Values:
    """The values of a probe at `count` steps, NaN left out.

    `different` has them, unless they are more than `MOST_DIFFERENT`. Numbers `only_grow` if none is less than the one
    before it; if they are fields as they are, or elements, they are among the `possible` ones.
    """

    count: int = 0
    least: float = math.inf
    most: float = -math.inf
    different: set[float | bool | str] = field(default_factory=set)
    only_grow: bool = True
    possible: Numbers = DOUBLES

    @property
    def are_few(self) -> bool:
        """Whether `different` has all."""
        return len(self.different) <= MOST_DIFFERENT

    def limit(self, is_upper: bool) -> str | None:
        """A number that no value is beyond, with `ROOM`, rounded outwards.

        None if the values are all the same, and if none that is possible is beyond.

        The room is a share of how far the values are from 0, or from one another if that is less.
        """
        if not self.count or not 0 < self.most - self.least < math.inf:
            return None
        extreme, other = (Decimal(repr(each)) for each in (self.most, self.least))
        spread = extreme - other
        if not is_upper:
            extreme = other
        room = ROOM * (min(abs(extreme), spread) or spread)
        finest = 0 if self.possible.kind is Kind.INTEGER else -400
        step = Decimal(1).scaleb(max(finest, (room / 2).adjusted()))
        rounded = outwards(extreme + room if is_upper else extreme - room, step, is_upper)
        is_possible = self.possible.least < rounded < self.possible.most
        return f"{rounded.normalize():f}" if is_possible else None


@dataclass(frozen=True, slots=True)
class Arrivals:
    """When the `count` messages on a topic came.

    The first came `start` after the recording began. `gap` is the longest time without one from then on, the end of
    the recording included, `usual` the median time between two. There were at least `fewest` in any `window`.
    """

    count: int
    start: Nanoseconds
    gap: Nanoseconds
    usual: Nanoseconds
    window: Nanoseconds
    fewest: int

    @property
    def are_regular(self) -> bool:
        """Whether messages come again and again."""
        return self.count >= LEAST_REGULAR and self.gap <= MOST_IRREGULAR * max(self.usual, 1)


LEAST_REGULAR, MOST_IRREGULAR = 10, 10
"""So many messages are a stream at least, the longest gap between which is at most so many times the usual one."""


@dataclass(frozen=True, slots=True)
class Measured:
    """What a recording shows of probes, as far as that could be computed, and of topics."""

    values: Mapping[Probe, Values]
    arrivals: Mapping[str, Arrivals]


def time_limit(measured: Nanoseconds, least: Nanoseconds) -> Nanoseconds:
    """`ROOM_IN_TIME` times as long as what was `measured`, of two digits rounded up, and not less than `least`."""
    limit = ROOM_IN_TIME * measured
    step: int = 10 ** max(0, len(str(limit)) - 2)
    return max(-(-limit // step) * step, least)


def duration(time: Nanoseconds) -> str:
    """A duration to three digits."""
    return duration_text(round(time, -max(0, len(str(time)) - 3)))
