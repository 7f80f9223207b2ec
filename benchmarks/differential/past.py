"""Truth over the instants of a run, by pieces of time; and the operators of the past on it.

A run's instants are pairs of a step k and a time t from that of step k up to that of the next, both included: at its
own time it is the step, later it is what is held. So each step has a segment of times, and time repeats where segments
touch. `Truth` says of each segment from which times on something is true or false. An operator of the past maps truths
to truths exactly: nothing is tried instant by instant, and no instant is left out.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

Segment = tuple[int, int]
"""The first and the last time of the instants of a step."""

Pieces = list[tuple[int, bool]]
"""Where pieces of a segment begin, in order, the first at its beginning, and what holds on each."""


@dataclass
class Truth:
    """For each segment of `on`, its pieces."""

    on: Sequence[Segment]
    pieces: list[Pieces]

    def at(self, k: int, time: int) -> bool:
        """Whether it holds at an instant."""
        found = self.pieces[k]
        return found[bisect_right(found, time, key=lambda piece: piece[0]) - 1][1]

    def spans(self, k: int) -> Iterator[tuple[int, int, bool]]:
        """The pieces of a segment with first and last time."""
        found, last = self.pieces[k], self.on[k][1]
        for number, (start, value) in enumerate(found):
            yield start, found[number + 1][0] - 1 if number + 1 < len(found) else last, value


def _joined(pieces: Pieces) -> Pieces:
    """The same with pieces as long as possible."""
    found: Pieces = []
    for start, value in pieces:
        if not found or found[-1][1] != value:
            found.append((start, value))
    return found


def constant(on: Sequence[Segment], values: Sequence[bool]) -> Truth:
    """What holds at each step, and is held."""
    return Truth(on, [[(start, value)] for (start, _), value in zip(on, values, strict=True)])


def combined(of: Callable[..., bool], *truths: Truth) -> Truth:
    """What holds where `of` the truths does."""
    on, pieces = truths[0].on, []
    for k in range(len(on)):
        starts = sorted({start for truth in truths for start, _ in truth.pieces[k]})
        pieces.append(_joined([(start, of(*(truth.at(k, start) for truth in truths))) for start in starts]))
    return Truth(on, pieces)


def negation(truth: Truth) -> Truth:
    """Where it does not hold."""
    return Truth(truth.on, [[(start, not value) for start, value in found] for found in truth.pieces])


def news(on: Sequence[Segment], fresh: Sequence[bool]) -> Truth:
    """At the steps that are `fresh`, not while these are held."""
    found: list[Pieces] = []
    for (start, last), is_new in zip(on, fresh, strict=True):
        found.append([(start, is_new)] + ([(start + 1, False)] if is_new and last > start else []))
    return Truth(on, found)


def _cut(start: int, last: int, true_until: int) -> Pieces:
    """True up to and including a time, then false."""
    if true_until < start:
        return [(start, False)]
    return [(start, True)] + ([(true_until + 1, False)] if true_until < last else [])


def _from(start: int, last: int, true_from: int) -> Pieces:
    """False up to a time, true from then on."""
    if true_from <= start:
        return [(start, True)]
    return [(start, False)] + ([(true_from, True)] if true_from <= last else [])


def previously(of: Truth) -> Truth:
    """It held at the instant before; false at the first instant."""
    found, before = [], False
    for k, (_, last) in enumerate(of.on):
        pieces: Pieces = [(of.on[k][0], before)]
        for start, value in of.pieces[k]:
            if start + 1 <= last:
                pieces.append((start + 1, value))
        before = of.pieces[k][-1][1]
        found.append(_joined(pieces))
    return Truth(of.on, found)


def once(of: Truth, within: int | None) -> Truth:
    """It held at some instant so far, or at most `within` ago."""
    found: list[Pieces] = []
    latest: int | None = None
    for k in range(len(of.on)):
        pieces: Pieces = []
        for start, last, value in of.spans(k):
            if value:
                pieces.append((start, True))
                latest = last
            elif latest is None:
                pieces.append((start, False))
            else:
                pieces += [(start, True)] if within is None else _cut(start, last, latest + within)
        found.append(_joined(pieces))
    return Truth(of.on, found)


def historically(of: Truth, duration: int | None) -> Truth:
    """It held at every instant so far; or without a break since an instant at least `duration` ago."""
    if duration is None:
        return negation(once(negation(of), None))
    found: list[Pieces] = []
    since: int | None = None
    for k in range(len(of.on)):
        pieces: Pieces = []
        for start, last, value in of.spans(k):
            if not value:
                since = None
                pieces.append((start, False))
            else:
                since = start if since is None else since
                pieces += _from(start, last, since + duration)
        found.append(_joined(pieces))
    return Truth(of.on, found)


def since(left: Truth, right: Truth, within: int | None) -> Truth:
    """`right` held at some instant so far, or of the last `within`, and `left` at every one after it."""
    found: list[Pieces] = []
    latest: int | None = None
    for k in range(len(left.on)):
        pieces: Pieces = []
        starts = sorted({start for truth in (left, right) for start, _ in truth.pieces[k]})
        ends = [*(start - 1 for start in starts[1:]), left.on[k][1]]
        for start, last in zip(starts, ends, strict=True):
            if right.at(k, start):
                pieces.append((start, True))
                latest = last
            elif not left.at(k, start) or latest is None:
                pieces.append((start, False))
                latest = None
            else:
                pieces += [(start, True)] if within is None else _cut(start, last, latest + within)
        found.append(_joined(pieces))
    return Truth(left.on, found)


def age_at_most(on: Sequence[Segment], heard: Sequence[tuple[int, int, int]], began: int, duration: int) -> Truth:
    """The time since the last message, or since the session began, is at most `duration`.

    Of each message that was heard: from which step and which time on it counts, and when it came.
    """
    found: list[Pieces] = []
    number, latest = 0, began
    for k, (start, last) in enumerate(on):
        pieces: Pieces = []
        at = start
        while at <= last:
            while number < len(heard) and heard[number][:2] <= (k, at):
                latest = heard[number][2]
                number += 1
            is_next_here = number < len(heard) and heard[number][0] == k
            until = min(last, heard[number][1] - 1) if is_next_here else last
            pieces += _cut(at, until, latest + duration)
            at = until + 1
        found.append(_joined(pieces))
    return Truth(on, found)


def counted(of: Truth, is_message: bool, times: int, within: int | None, presumed: bool) -> Truth:
    """It occurred `times` times so far, or at most `within` ago: at each step at which it holds or, unless
    `is_message`, at which it begins to. With `presumed`, it holds for the first `within` as well.
    """
    found: list[Pieces] = []
    occurred: list[int] = []
    before = False
    for k, (start, last) in enumerate(of.on):
        if of.at(k, start) and (is_message or not before):
            occurred.append(start)
        before = of.pieces[k][-1][1]
        since = occurred[-times] if len(occurred) >= times else of.on[0][0] if presumed else None
        if since is None:
            found.append([(start, False)])
        else:
            found.append([(start, True)] if within is None else _cut(start, last, since + within))
    return Truth(of.on, found)
