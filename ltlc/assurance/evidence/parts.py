"""Letters that are held: what operators of the past and clocks are meanwhile, and what of them has to be remembered.

Coq: `proofs/Held.v`, with the same names, and the proof that `next_part` is right: `next_part_right`. This is the same
algorithm in Python.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, assert_never

from ltlc.semantics import finite
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.ltl import Formula
from ltlc.semantics.timed_atoms import (
    AfterOpened,
    Age,
    Clock,
    EpisodeOpened,
    FirstOpen,
    Historically,
    LastTrigger,
    Late,
    Occurred,
    Once,
    Previously,
    Since,
    UntilScope,
)
from ltlc.semantics.trackers import outer_clock
from ltlc.semantics.words import Letter

Past = Previously | Once | Historically | Since | Age
"""An operator of the past that a certificate defines."""

Kept = tuple[bool, Nanoseconds] | None
"""What an operator of the past remembers: the time of one instant, and something that holds of it."""

Opened = tuple[Nanoseconds | None, ...]
"""When a scope and those around it opened, the innermost first; None where it is closed."""

ClockState = tuple[Nanoseconds | None, Opened]
"""What a clock remembers: from when it counts, and its scopes."""

Tally = tuple[tuple[Nanoseconds, ...], bool, Nanoseconds]
"""Of a count the times at which it occurred last, whether that is held, and the time of the first instant."""

Memory = tuple[tuple[Kept, ...], tuple[ClockState, ...]]
"""What all operators of the past and all clocks remember."""

NOTHING: Memory = ((), ())
"""What is remembered before the first instant."""


class Part(NamedTuple):
    """Some instants, one after the other, with one letter; of a `single` one it is known that it is only one.

    `start` and `end` are the times of the first and of the last.
    """

    letter: Letter
    start: Nanoseconds
    end: Nanoseconds
    single: bool = False

    def has(self, predicate: Formula) -> bool:
        """Whether a state predicate holds at its instants."""
        return finite.holds(predicate, (self.letter,))


def _within(bound: Nanoseconds | None, start: Nanoseconds, time: Nanoseconds) -> bool:
    return bound is None or time <= start + bound


def past_part(began: Nanoseconds, atom: Past, is_first: bool, kept: Kept, part: Part) -> tuple[bool, bool, Kept]:
    """The value of `atom` at the first and at the last instant of a part, and what is remembered then."""
    now = (False, part.end)
    match atom:
        case Previously(_, operand):
            before, holds = kept is not None and kept[0], part.has(operand)
            return before, before if part.single else holds, (holds, 0)
        case Once(_, operand, bound):
            return (True, True, now) if part.has(operand) else _counting(bound, kept, part)
        case Historically(_, operand, duration):
            if not part.has(operand):
                return False, False, None
            kept = kept or (is_first, part.start)
            if duration is None:
                return kept[0], kept[0], kept
            return kept[1] + duration <= part.start, kept[1] + duration <= part.end, kept
        case Since(_, holding, start, bound):
            if part.has(start):
                return True, True, now
            return _counting(bound, kept, part) if part.has(holding) else (False, False, None)
        case Age(_, news, most):
            if part.has(news):
                return True, True, now
            last = began if kept is None else kept[1]
            return part.start <= last + most, part.end <= last + most, kept
        case _:
            assert_never(atom)


def _counting(bound: Nanoseconds | None, kept: Kept, part: Part) -> tuple[bool, bool, Kept]:
    """What is true until `bound` has passed since what is remembered."""
    if kept is None:
        return False, False, kept
    return _within(bound, kept[1], part.start), _within(bound, kept[1], part.end), kept


def count_part(count: Occurred, is_first: bool, before: Tally | None, part: Part) -> tuple[bool, bool, Tally] | None:
    """Whether a count is reached at the first and at the last instant of a part, and what is remembered then.

    None: that depends on how many instants the part has.
    """
    old, held, first = before if before is not None and not is_first else ((), False, part.start)
    here = part.has(count.operand)
    if here and not count.begins and not part.single:
        return None
    now = (*old, part.start)[-count.times :] if here and not (count.begins and held) else old

    def is_reached(time: Nanoseconds) -> bool:
        is_presumed = count.presumed and count.within is not None and time <= first + count.within
        return is_presumed or (len(now) == count.times and _within(count.within, now[0], time))

    return is_reached(part.start), is_reached(part.end), (now, here, first)


def counted_parts(
    counts: Sequence[Occurred], is_first: bool, before: Sequence[Tally], part: Part
) -> tuple[Part, tuple[Tally, ...]] | None:
    """A part with its counts, and what is remembered then; None: they are not the same at all of its instants."""
    tallies: list[Tally] = []
    for number, count in enumerate(counts):
        found = count_part(count, is_first, None if is_first else before[number], part)
        if found is None or found[0] != found[1]:
            return None
        part = part._replace(letter=part.letter | {count.name} if found[0] else part.letter - {count.name})
        tallies.append(found[2])
    return part, tuple(tallies)


def open_part(scope: Clock, part: Part, is_first: bool, before: Opened) -> tuple[Opened, bool]:
    """Since when a scope and those around it are open at a part, and whether it opens there."""
    since = before[0] if before else None
    if (outer := outer_clock(scope)) is None:
        return (part.start if is_first else since,), is_first
    around, is_fresh = open_part(outer, part, is_first, before[1:])
    match scope:
        case _ if around[0] is None:
            return (None, *around), False
        case UntilScope(_, closing) | EpisodeOpened(_, _, closing) if part.has(closing):
            return (None, *around), False
        case UntilScope():
            return (part.start if is_fresh else since, *around), is_fresh
        case _ if since is not None and not is_fresh:
            return (since, *around), False
        case AfterOpened(_, opening) | EpisodeOpened(_, opening, _):
            opens = part.has(opening)
            return (part.start if opens else None, *around), opens
        case _:
            raise AssertionError(f"not a scope: {scope}")


def _is_past(bound: Nanoseconds, start: Nanoseconds | None, time: Nanoseconds) -> bool:
    return start is not None and start + bound < time


def clock_part(
    clock: Clock, bound: Nanoseconds, part: Part, is_first: bool, before: ClockState
) -> tuple[bool, bool, ClockState]:
    """Whether `clock` is past `bound` at the first and at the last instant of a part, and what is remembered then."""

    def ends(first: Nanoseconds | None, last: Nanoseconds | None, then: ClockState) -> tuple[bool, bool, ClockState]:
        return _is_past(bound, first, part.start), _is_past(bound, last, part.end), then

    match clock:
        case FirstOpen(outer, trigger, goal):
            scopes, is_fresh = open_part(outer, part, is_first, before[1])
            if scopes[0] is None:
                return False, False, (None, scopes)
            start = None if is_fresh else before[0]
            opens = start is None and part.has(trigger)
            after = None if part.has(goal) else part.start if opens else start
            return ends(start, start if part.single else after, (after, scopes))
        case LastTrigger(outer, trigger):
            scopes, is_fresh = open_part(outer, part, is_first, before[1])
            if scopes[0] is None:
                return False, False, (None, scopes)
            if part.has(trigger):
                return False, False, (part.end, scopes)
            start = None if is_fresh else before[0]
            return ends(start, start, (start, scopes))
        case _:
            scopes, _ = open_part(clock, part, is_first, before[1])
            return ends(scopes[0], scopes[0], (None, scopes))


def next_part(
    began: Nanoseconds, past: Sequence[Past], timers: Sequence[Late], is_first: bool, memory: Memory, part: Part
) -> tuple[Letter, Memory] | None:
    """The letter of a part with its `past` and its `timers`, and what is remembered then.

    None: some of these are not the same at its first and at its last instant. An operator of the past comes after those
    that it is made of.
    """
    kept: list[Kept] = []
    for number, operator in enumerate(past):
        first, last, then = past_part(began, operator, is_first, None if is_first else memory[0][number], part)
        if first != last:
            return None
        part = part._replace(letter=part.letter | {operator.name} if first else part.letter - {operator.name})
        kept.append(then)
    late: set[str] = set()
    states: list[ClockState] = []
    for number, timer in enumerate(timers):
        before = (None, ()) if is_first else memory[1][number]
        first, last, state = clock_part(timer.clock, timer.bound, part, is_first, before)
        if first != last:
            return None
        late |= {timer.name} if first else set()
        states.append(state)
    return part.letter - {timer.name for timer in timers} | late, (tuple(kept), tuple(states))
