"""The monitor of a property with clocks as it is run: a machine that asks and sets clocks, without the atoms of time.

It is data, like `Monitor`: `ltlc.automata.folding` makes it of one and of what its clocks are, the backends write it
out, the gate judges what they wrote.
"""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

from ltlc.dataclass import dataclass
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.monitor import Decision, Monitor, Target
from ltlc.semantics.verdicts import Verdict


class Effect(Enum):
    """What is done to a clock, which is known by the time at which it will be due."""

    START = "due a duration after this instant"
    RELEASE = "due a duration after the last instant at which the letter before this one was held"
    EXTEND = "due a duration later than it was"
    STOP = "not due"


class Action(NamedTuple):
    """An effect on the clock with this number; `duration` is 0 for `STOP`."""

    clock: int
    effect: Effect
    duration: Nanoseconds


class Outcome(NamedTuple):
    """Where an instant leads. With `again`, a clock step comes a nanosecond later: the letter changes by itself.

    `taken` are scopes, by number, that would open at this clock step: the values held are taken at their openings, no
    clock changes, and the clock step is asked anew, from `state`.
    """

    state: int
    actions: tuple[Action, ...] = ()
    again: bool = False
    taken: tuple[int, ...] = ()


class AgeDue(NamedTuple):
    """A clock that is due a `duration` after the last message that `news` is of, or the beginning of the session."""

    news: str
    duration: Nanoseconds


@dataclass(frozen=True, slots=True)
class TimedMonitor:
    """A monitor over `atoms` and `clocks`; targets that are no decisions are numbers of `outcomes`.

    `edges[q]` says where a step leads from state q, which comes after the clock steps up to its time. `held_edges[q]`
    says where a clock step does, with the letter held and without news. A decision whose `atom` is len(atoms) + c asks
    whether clock c is past its due time.

    If `ages[c]` is None, outcomes set clock c, which does not run before the first step. Otherwise whoever runs the
    monitor keeps it: every message renews the age at its own time, also one that makes no step. A clock step comes when
    an age gets late, and when a message that makes no step renews one that was.

    `closed[q]` are the scopes, by number, whose opening has not come yet, or whose end has: at a step from q the values
    at their opening are the latest ones.

    Of what is counted, `atoms` has atoms that clock steps may change, too.
    """

    atoms: tuple[str, ...]
    verdicts: tuple[Verdict, ...]
    edges: tuple[Target, ...]
    held_edges: tuple[Target, ...]
    decisions: tuple[Decision, ...]
    outcomes: tuple[Outcome, ...]
    ages: tuple[AgeDue | None, ...]
    closed: tuple[tuple[int, ...], ...]


def timeless(monitor: Monitor) -> TimedMonitor:
    """`monitor`, none of whose atoms is timed, in this form: the outcome of a number is the state of that number."""
    outcomes = tuple(map(Outcome, range(len(monitor.verdicts))))
    closed = ((),) * len(outcomes)
    return TimedMonitor(
        monitor.atoms, monitor.verdicts, monitor.edges, (), monitor.decisions, outcomes, ages=(), closed=closed
    )
