"""A slice that takes messages by itself, because one of its clocks comes due."""

from __future__ import annotations

from dataclasses import field

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Places
from ltlc.monitoring.columns.elements import Elements
from ltlc.runtime.properties import Change
from ltlc.runtime.slice_ids import Slice
from ltlc.runtime.slice_steps import Slices
from ltlc.semantics.durations import Nanoseconds

Place = tuple[int, Nanoseconds]
"""Where something happens in a block: before its message n, or at it, as 2 n or 2 n + 1; and when."""


@dataclass
class Alone:
    """What a slice went through: it took so many messages, and is kept again from the one that `returned` it."""

    count: int = 0
    changes: list[tuple[Place, Change]] = field(default_factory=list)
    returned: int | None = None


def take_alone(
    slices: Slices, one: Slice, messages: Elements, those: Places, steps: Places, until: Nanoseconds
) -> Alone:
    """Have a slice take `those` messages, whose steps have the numbers in `steps`, and time, until it is decided."""
    found = Alone()
    for message in those.tolist():
        time = int(messages.times[message])
        if _is_decided(found, one, messages, time):
            return found
        was_new = slices.is_as_new(one)
        if messages.is_own[message]:
            one.hear(time, slices.cut.own_ages)
        one.steps = int(steps[message])
        previous = one.step(time, messages.values(slices.cut, message, one))
        changes = [] if previous is None else [one.change(previous, time)]
        changes += one.renew(time) if one.is_renewed else []
        found.changes += [((2 * message + 1, time), each) for each in changes]
        found.count += 1
        if was_new and not slices.is_as_new(one):
            found.returned = message
        if one.verdict.is_permanent:
            return found
    _is_decided(found, one, messages, until)
    return found


def _is_decided(found: Alone, one: Slice, messages: Elements, time: Nanoseconds) -> bool:
    """Let a slice take its clock steps up to and including `time`; whether that decides it."""
    for change in one.hold(time):
        now = change.moment.time
        found.changes.append(((2 * int(messages.times.searchsorted(now)), now), change))
    return one.verdict.is_permanent
