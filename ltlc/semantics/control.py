"""What runs, reduced to its control: it asks atoms and clocks, shows verdicts and sets clocks, and knows no timed atom.

Coq: `proofs/Program.v`, where its meaning is defined (`runs`).
"""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

from ltlc.dataclass import dataclass
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.ltl import TRUE, Formula
from ltlc.semantics.trackers import State
from ltlc.semantics.verdicts import Verdict


class Base(Enum):
    """From when the time counts at which a clock is due. Coq: `anchor`."""

    NOW = "now"
    JUST_BEFORE = "before"
    """A nanosecond before this instant."""
    DUE = "due"
    """When the clock was due."""
    NEVER = "never"
    """The clock is not due; the duration is 0."""


class Setting(NamedTuple):
    """The clock is due a `duration` after `base`. Coq: `setting`."""

    clock: int
    base: Base
    duration: Nanoseconds


class Outcome(NamedTuple):
    """Where an instant leads. With `again`, a clock step comes a nanosecond later. Coq: `outcome`."""

    state: int
    settings: tuple[Setting, ...] = ()
    again: bool = False


Way = int
"""An outcome if it is not negative, else the branch with the number `~way`."""


class Branch(NamedTuple):
    """Asks whether an atom holds, or whether the clock with a number is past its due time. Coq: `branch`."""

    asked: str | int
    if_so: Way
    if_not: Way


class Stance(NamedTuple):
    """What a state shows; where a step leads from it, and where a clock step does, if one can come. Coq: `stance`."""

    verdict: Verdict
    step: Way
    clock_step: Way | None = None


@dataclass(frozen=True, slots=True)
class Control:
    """A machine whose initial state is `stances[0]`. Coq: `program`.

    Clock c is first due `first_due[c]` after the session has begun; None: not before it is set.
    """

    stances: tuple[Stance, ...]
    branches: tuple[Branch, ...]
    outcomes: tuple[Outcome, ...]
    first_due: tuple[Nanoseconds | None, ...] = ()


class Pair(NamedTuple):
    """A state of the control, and one of a monitor, in which the two can be at the same time. Coq: `pair`.

    While the monitor's verdict is not permanent, the trackers of the property are then in the states `stand`, and the
    last letter satisfies `last_letter`, which says nothing of time and news; `looks_again` if a clock step comes next.
    """

    state: int
    judged: int
    stand: tuple[State, ...] = ()
    looks_again: bool = False
    last_letter: Formula = TRUE


@dataclass(frozen=True, slots=True)
class Followed:
    """A control, and the pairs in which it follows the monitor of its property."""

    control: Control
    pairs: tuple[Pair, ...]
