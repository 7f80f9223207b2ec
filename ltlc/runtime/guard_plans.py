"""What a guard is by its program: the properties that it keeps, and where it may rest.

Standard library only.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from typing import NamedTuple

from ltlc.dataclass import dataclass
from ltlc.runtime.sampling import Value, Wanted


class Asks(Enum):
    """What a decision about rest asks; `of` and `number` are those of its `Asked`.

    SILENT: whether a topic that is waited for has not spoken, or lacks a value
    SENT: whether `number` messages have left on the guards' topic `of`, as counted
    WAITS: whether the property `of` has not begun
    STANDS: whether the property `of` has begun and its machine is in the state `number`
    KNOWN: whether the condition `of` has all its values, and compares no NaN
    HOLDS: whether the condition `of` holds
    """

    SILENT = "silent"
    SENT = "sent"
    WAITS = "waits"
    STANDS = "stands"
    KNOWN = "known"
    HOLDS = "holds"


class Asked(NamedTuple):
    """A question; properties go by their numbers in `parts` of the plan."""

    asks: Asks
    of: int = 0
    number: int = 0


NO, YES = 0, 1
"""Where decisions about rest lead in the end."""


@dataclass(frozen=True, slots=True)
class HeldCondition:
    """A condition on values: if it compares no NaN (`known`), whether it `holds`.

    Before there are samples, its inputs have the values `first`, None where there is
    none; with none at all, that is empty.
    """

    inputs: tuple[Wanted, ...]
    known: Callable[..., bool]
    holds: Callable[..., bool]
    first: tuple[Value, ...] = ()


@dataclass(frozen=True, slots=True)
class GuardPlan:
    """Guards that share properties, to be run: they send on the topics `outs`.

    They keep the properties `parts`, by their numbers in the plan, but rely on those
    `assumed`, and act `lead` ns before a deadline. They are silent until the topics
    `spoken` have, and all that is `awaited` has a value; on each of the topics `outs`,
    messages are counted up to `most`. They may rest where `decisions` lead to YES from
    the target `rests`: each has the number of a question, and where it leads if that is
    not so, and if it is; below 0, to the decision `~target`.
    """

    outs: tuple[str, ...]
    lead: int
    parts: tuple[int, ...]
    assumed: tuple[int, ...]
    spoken: tuple[str, ...]
    awaited: tuple[Wanted, ...]
    most: tuple[int, ...]
    conditions: tuple[HeldCondition, ...]
    questions: tuple[Asked, ...]
    decisions: tuple[tuple[int, int, int], ...]
    rests: int
