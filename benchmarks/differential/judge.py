"""The verdict after each instant of a run, from the definition in `docs/language.md`, 'What they mean' and 'Verdicts'.

A part of a property is judged on a segment of the run that begins at an instant i and ends before an instant m, or has
no end yet, for all prefixes of the run at once: a vector has, for each number e of instants seen so far, three bits.
HOLDS: it holds on the segment as far as it has been seen. SURELY: it does, whatever comes. MAYBE: something can come
with which it does. Of a segment whose end has been seen (e > m) the three are one. A run is violated where the whole
property has lost MAYBE, satisfied where it has SURELY.

SURELY and MAYBE go from parts to the whole as in Eisner et al., *Reasoning with temporal logic on truncated paths*
(2003). So they are right, but not always as early as they could be: of `(eventually p) and never p` both sides are
still open. Where ltlc decides earlier, it is compared what the rest of the run shows, and what shows if nothing comes.

**Which instants are looked at.** Those at which something changes, or can: each step; the beginning of each piece of
time on which all state predicates are constant (`past.py` computes these exactly); for each of these times c and each
duration D in a bound, c + D and c + D + 1; and the last instant before each of them. That is enough. Between two
neighbours among these the letter is the same, and no bound is passed that was opened where a letter began or ended. A
scope, a run or an obligation begins where a letter does. What is said of all instants of a piece with p, as in
`always (p implies …)`, the one place where bounds begin at every instant, is said by its first, which is late first,
and by its last, which reaches furthest. No temporal operator has a 'next', so that an instant which repeats its
neighbour changes no truth, nor when a verdict comes. A test compares this with a look at every nanosecond.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.differential.samples import Step
from benchmarks.differential.values import Frame

HOLDS, SURELY, MAYBE = 1, 2, 4
Vector = NDArray[np.uint8]

_NOT = np.array([sum(new for new, old in ((1, 1), (2, 4), (4, 2)) if not bits & old) for bits in range(8)], np.uint8)

Instant = tuple[int, int]
"""A step and a time at which it is held, or at which it is."""


@dataclass
class Instants:
    """What is looked at of a run, and what was read at its steps; of each place, `segments` has that of its truths."""

    places: Sequence[Instant]
    steps: Sequence[Step]
    segments: Sequence[Instant]
    opened: dict[tuple[tuple[int, int], ...], dict[int, Mapping[Any, Any]]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.times = [time for _, time in self.places]
        self.ends = np.arange(len(self.places) + 1)
        self._known: dict[tuple[int, int, int], Vector] = {}

    def after(self, i: int, duration: int) -> int:
        """The first instant that is more than `duration` later than i; the number of instants if there is none."""
        return bisect_right(self.times, self.times[i] + duration)

    def before(self, i: int, early: Vector | int, late: Vector | int) -> Vector:
        """`early` as long as i has not been seen, then `late`."""
        return np.where(self.ends <= i, early, late).astype(np.uint8)

    def empty(self, i: int, still_open: int, closed: int) -> Vector:
        """What holds of the segment that begins and ends at i, before and after that is seen."""
        key = (i, still_open, closed)
        if key not in self._known:
            self._known[key] = self.before(i, still_open, closed)
        return self._known[key]


Opened = tuple[tuple[int, int], ...]
"""For each scope that is open and asked for, the step whose values it keeps."""


class State:
    """A state predicate: at which instants it holds."""

    def __init__(self, of: Instants, holds: Callable[[int, Opened], bool]) -> None:
        self._of, self._holds = of, holds
        self._known: dict[tuple[int, Opened], bool] = {}

    def at(self, i: int, opened: Opened) -> bool:
        """Whether it holds at the instant i."""
        key = (i, opened)
        if key not in self._known:
            self._known[key] = self._holds(i, opened)
        return self._known[key]


class Part:
    """A part of a property."""

    def __init__(self, of: Instants) -> None:
        self.of = of
        self._known: dict[tuple[int, int, Opened], Vector] = {}

    def value(self, i: int, m: int, opened: Opened) -> Vector:
        """Whether it holds on the instants from i on and before m."""
        key = (i, m, opened)
        if key not in self._known:
            self._known[key] = self.judged(i, m, opened)
        return self._known[key]

    def judged(self, i: int, m: int, opened: Opened) -> Vector:
        """As `value`."""
        raise NotImplementedError


class Now(Part):
    """A state predicate that is read at the current instant."""

    def __init__(self, of: Instants, state: State) -> None:
        super().__init__(of)
        self.state = state
        self._both = [np.full(len(of.places) + 1, bits, np.uint8) for bits in (0, 7)]

    def value(self, i: int, m: int, opened: Opened) -> Vector:
        """Only asked of instants that there are."""
        return self._both[self.state.at(i, opened)]


class Initially(Part):
    """`initially p`: of no instant it is false."""

    def __init__(self, of: Instants, state: State) -> None:
        super().__init__(of)
        self.state = state

    def judged(self, i: int, m: int, opened: Opened) -> Vector:
        """Whether p holds at the first instant."""
        if i >= m or i >= len(self.of.places):
            return self.of.empty(m, MAYBE, 0)
        return self.of.empty(i, MAYBE, 7 * self.state.at(i, opened))


class Not(Part):
    """`not P`."""

    def __init__(self, of: Instants, inner: Part) -> None:
        super().__init__(of)
        self.inner = inner

    def judged(self, i: int, m: int, opened: Opened) -> Vector:
        """What is sure to hold cannot fail, and the other way round."""
        found: Vector = _NOT[self.inner.value(i, m, opened)]
        return found


class Both(Part):
    """`P and Q`, or `P or Q`."""

    def __init__(self, of: Instants, left: Part, right: Part, is_or: bool) -> None:
        super().__init__(of)
        self.left, self.right, self.is_or = left, right, is_or

    def judged(self, i: int, m: int, opened: Opened) -> Vector:
        """Each side on the same segment."""
        a, b = self.left.value(i, m, opened), self.right.value(i, m, opened)
        found: Vector = a | b if self.is_or else a & b
        return found


class Always(Part):
    """`always P`, or `eventually P`: P from each instant on, or from one."""

    def __init__(self, of: Instants, inner: Part, is_some: bool) -> None:
        super().__init__(of)
        self.inner, self.is_some = inner, is_some
        self._from: dict[tuple[int, Opened], int] = {}

    def value(self, i: int, m: int, opened: Opened) -> Vector:
        """Built up from the end, since the rest from the next instant on is a part of it."""
        if i >= m:
            return self.of.empty(m, MAYBE if self.is_some else MAYBE | HOLDS, 0 if self.is_some else 7)
        low = self._from.get((m, opened), m)
        if i >= low:
            return self._known[i, m, opened]
        rest, unseen = self.value(low, m, opened), MAYBE if self.is_some else MAYBE | HOLDS
        for k in range(low - 1, i - 1, -1):
            here = self.inner.value(k, m, opened)
            rest = here | rest if self.is_some else here & rest
            rest[: k + 1] = unseen
            self._known[k, m, opened] = rest
        self._from[m, opened] = i
        return rest


class Within(Part):
    """`within [A, B], P`: P from A to B after the first instant; with D alone, A is 0."""

    def __init__(self, of: Instants, start: int, end: int, inner: Part) -> None:
        super().__init__(of)
        self.start, self.end, self.inner = start, end, inner

    def judged(self, i: int, m: int, opened: Opened) -> Vector:
        """The bound ends the segment, or its end does."""
        if i >= m or i >= len(self.of.places):
            return self.inner.value(i, m, opened)
        start, end = max(i, self.of.after(i, self.start - 1)), self.of.after(i, self.end)
        return self.inner.value(min(m, start), min(m, end), opened)


class After(Part):
    """`after X, Y`; `scope` is the number that values at its opening have, None if nobody asks for them."""

    def __init__(self, of: Instants, event: State, body: Part, scope: int | None) -> None:
        super().__init__(of)
        self.event, self.body, self.scope = event, body, scope

    def judged(self, i: int, m: int, opened: Opened) -> Vector:
        """Y from the first X on."""
        k = next((k for k in range(i, m) if self.event.at(k, opened)), None)
        if k is None:
            return self.of.empty(m, MAYBE | HOLDS, 7)
        inside = _opened(opened, self.scope, self.of.places[k][0])
        return self.of.before(k, MAYBE | HOLDS, self.body.value(k, m, inside))


class Until(Part):
    """`until X, Y`."""

    def __init__(self, of: Instants, event: State, body: Part) -> None:
        super().__init__(of)
        self.event, self.body = event, body

    def judged(self, i: int, m: int, opened: Opened) -> Vector:
        """X comes, and Y holds before the first."""
        k = next((k for k in range(i, m) if self.event.at(k, opened)), None)
        if k is None:
            return self.of.before(m, self.body.value(i, m, opened) & np.uint8(MAYBE), 0)
        body = self.body.value(i, k, opened)
        return self.of.before(k, body & np.uint8(MAYBE), body)


class AfterUntil(Part):
    """`after_until X, Y, Z`."""

    def __init__(self, of: Instants, opens: State, closes: State, body: Part, scope: int | None) -> None:
        super().__init__(of)
        self.opens, self.closes, self.body, self.scope = opens, closes, body, scope

    def judged(self, i: int, m: int, opened: Opened) -> Vector:
        """Z on each episode."""
        found: Vector = self.of.empty(m, MAYBE | HOLDS, 7)
        for o, c, kept in reversed(self.episodes(i, m, opened)):
            inside = _opened(opened, self.scope, kept)
            found = self.of.before(o, MAYBE | HOLDS, self.body.value(o, c, inside) & found)
        return found

    def episodes(self, i: int, m: int, opened: Opened) -> list[tuple[int, int, int]]:
        """Of each episode between i and m, its first instant, that before which it ends, and the step it opened at.

        While no episode is open, what the closing event asks of the opening is the latest value; but while the step is
        held at which one closed, it is still that of the one before.
        """
        places, found = self.of.places, []
        o = kept = closed = None
        for k in range(i, m):
            step = places[k][0]
            if o is None:
                latest = kept if closed == step else step
                if self.opens.at(k, opened) and not self.closes.at(k, _opened(opened, self.scope, latest)):
                    o, kept = k, step
            elif self.closes.at(k, _opened(opened, self.scope, kept)):
                assert kept is not None
                found.append((o, k, kept))
                o, closed = None, step
        if o is not None:
            assert kept is not None
            found.append((o, m, kept))
        return found


def _opened(opened: Opened, scope: int | None, step: int | None) -> Opened:
    if scope is None:
        return opened
    assert step is not None
    return (*(pair for pair in opened if pair[0] != scope), (scope, step))


def frame(steps: Sequence[Step], step: int, opened: Opened) -> Frame:
    """What is known at a step, or while it is held."""
    return Frame(steps[step].samples, {scope: steps[at].samples for scope, at in opened})


def verdicts(root: Part) -> list[str]:
    """The verdict after each instant."""
    of = root.of
    bits = root.value(0, len(of.places), ((0, 0),))[1:]
    words = []
    for each in bits.tolist():
        if not each & MAYBE:
            words.append("violated")
        elif each & SURELY:
            words.append("satisfied")
        else:
            words.append("presumably_satisfied" if each & HOLDS else "presumably_violated")
    return words
