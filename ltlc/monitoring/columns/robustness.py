"""By how much properties hold at each step of a run, over columns: `semantics/robustness.py`, piece by piece.

No operator takes more than so many passes over the pieces as a window of it has doublings.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import reduce
from typing import assert_never

import numpy as np

from ltlc.inputs.recordings.blocks import Array
from ltlc.monitoring.columns.bits import union
from ltlc.monitoring.columns.margins import combined
from ltlc.monitoring.columns.series import UnsupportedError
from ltlc.monitoring.columns.timeline import (
    Clamps,
    Pieces,
    Timeline,
    backwards,
    least_from,
    least_of_windows,
    over_windows,
    together,
)
from ltlc.semantics import ltl
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.ltl import Formula
from ltlc.semantics.properties import (
    After,
    AfterUntil,
    Always,
    And,
    Eventually,
    Implies,
    Never,
    Not,
    Now,
    Or,
    Property,
    Throughout,
    Until,
    Within,
)
from ltlc.semantics.robustness import FALSE, TRUE, margin
from ltlc.semantics.timed_atoms import (
    Age,
    Historically,
    Late,
    News,
    Occurred,
    Once,
    Previously,
    Since,
    timed_atoms,
)

Ended = Pieces | None
"""By how much a segment has ended; None: it ends with the run."""


class Robustness:
    """The robustness of properties on the rest of a run from each instant on, of whose atoms `margins` are at steps."""

    def __init__(
        self,
        timeline: Timeline,
        margins: Mapping[str, Array],
        since: Mapping[str, Nanoseconds],
        is_at_steps: bool = False,
    ) -> None:
        """Before the first message at a step, ages count from `since`, by the name of their news.

        If it `is_at_steps`, windows are looked at from steps alone, as if time did not pass between them.
        """
        self._line = timeline
        self._margins = margins
        self._since_when = since
        self._known: dict[Formula, Pieces] = {}
        self._is_at_steps = is_at_steps

    def at_steps(self, property_: Property) -> Array:
        """That of `property_` at each step. Raises UnsupportedError of what cannot be measured.

        The least of what does not fall between steps is at one, so fewer instants are looked at.
        """
        match property_:
            case Not(operand):
                return -self.at_steps(operand)
            case And(left, right):
                return np.minimum(self.at_steps(left), self.at_steps(right))
            case Or(left, right):
                return np.maximum(self.at_steps(left), self.at_steps(right))
            case Implies(left, right):
                return np.maximum(-self.at_steps(left), self.at_steps(right))
            case Always(operand) if _does_not(operand, falls=True):
                return self._from_steps(property_)
            case Never(operand) if _does_not(operand, falls=False):
                return self._from_steps(property_)
            case Within(_, _, 0):
                return self._from_steps(property_)
            case _:
                return self.of(property_).at(self._line.steps)

    def _from_steps(self, property_: Property) -> Array:
        coarse = Robustness(self._line, self._margins, self._since_when, is_at_steps=True)
        return coarse.of(property_).at(self._line.steps)

    def of(self, property_: Property, ended: Ended = None, is_inside: bool = False) -> Pieces:
        """That of `property_`. Raises UnsupportedError of what cannot be measured."""
        match property_:
            case Now(predicate):
                return self._predicate(predicate) if is_inside else self._now(predicate, ended)
            case Throughout(predicate):
                return self._always(self._predicate(predicate), ended)
            case Not(operand):
                return _negated(self.of(operand, ended, is_inside))
            case And(left, right):
                return _least(self.of(left, ended, is_inside), self.of(right, ended, is_inside))
            case Or(left, right):
                return _greatest(self.of(left, ended, is_inside), self.of(right, ended, is_inside))
            case Implies(left, right):
                return _greatest(_negated(self.of(left, ended, is_inside)), self.of(right, ended, is_inside))
            case Always(operand):
                return self._always(self.of(operand, ended, True), ended)
            case Never(operand):
                return self._always(_negated(self.of(operand, ended, True)), ended)
            case Eventually(operand):
                return self._eventually(self.of(operand, ended, True), ended)
            case After(event, body):
                return self._after(self._predicate(event), self.of(body, ended, True), ended)
            case Until(event, body):
                comes = self._predicate(event)
                return _least(self._eventually(comes, ended), self.of(body, _either(ended, comes)))
            case AfterUntil(opening, closing, body):
                closes = self._predicate(closing)
                opens = self._predicate(ltl.And(opening, ltl.Not(closing)))
                first = self._after(opens, self.of(body, _either(ended, closes), True), ended)
                return _least(first, self._always(_greatest(_negated(closes), first), ended))
            case Within(duration, body, 0):
                return self._within(self._line.clipped(duration), body, ended, is_inside)
            case Within(duration, body, start):
                found = self._within(self._line.clipped(duration - start), body, ended, True)
                return self._later(found, self._line.clipped(start), ended)
            case _:
                assert_never(property_)

    def _predicate(self, predicate: Formula) -> Pieces:
        if predicate not in self._known:
            of_atoms = {
                atom.name: self._atom(atom) for atom in ltl.subformulas(predicate) if isinstance(atom, ltl.Atom)
            }
            self._known[predicate] = _combined(predicate, of_atoms, self._line)
        return self._known[predicate]

    def _now(self, predicate: Formula, ended: Ended) -> Pieces:
        """Where the segment has ended no atom holds."""
        if ended is None:
            return self._predicate(predicate)
        inside, atoms = _negated(ended), [each for each in ltl.subformulas(predicate) if isinstance(each, ltl.Atom)]
        return _combined(predicate, {each.name: _least(self._predicate(each), inside) for each in atoms}, self._line)

    def _atom(self, atom: ltl.Atom) -> Pieces:
        match atom:
            case Previously(_, operand):
                found = self._predicate(operand)
                starts = self._line.within(found.starts + 1)
                return Pieces(np.insert(starts, 0, 0), np.insert(found.margins[: len(starts)], 0, FALSE))
            case Once(_, operand, within):
                return _negated(self._historically(_negated(self._predicate(operand)), within))
            case Historically(_, operand, None):
                return self._historically(self._predicate(operand), None)
            case Historically(_, operand, int(lasting)):
                return self._lasting(self._predicate(operand), self._line.clipped(lasting))
            case Since(_, kept, start, within):
                return self._since(self._predicate(kept), self._predicate(start), within)
            case News(name):
                return self._news(self._margins[name])
            case Age(_, news, most):
                return self._age(news.name, most)
            case Occurred() | Late():
                raise TypeError(f"not a margin: {atom!r}")
            case _:
                return Pieces(self._line.steps, self._margins[atom.name])

    def _news(self, margins: Array) -> Pieces:
        """It is over at the instant after each step, if that is no step."""
        starts = together(self._line.steps, self._line.within(self._line.steps + 1))
        at = Pieces(self._line.steps, margins).at(starts)
        is_step = self._line.steps[self._line.steps.searchsorted(starts, "right") - 1] == starts
        return Pieces(starts, np.where(is_step, at, FALSE))

    def _age(self, news: str, most: Nanoseconds) -> Pieces:
        """Whether the last message is at most so long ago."""
        line, comes, since = self._line, self._margins[news] > 0, self._since_when[news]
        arrivals, times = line.steps[comes], line.times[comes]
        late = line.first_at(np.append(times + line.clipped(most), since + most) + 1)
        starts = line.within(union([np.zeros(1, np.int64), arrivals, late]))
        last = np.insert(times, 0, since).take(arrivals.searchsorted(starts, "right"))
        return Pieces(starts, np.where(line.time(starts) - last <= most, TRUE, FALSE))

    def _always(self, operand: Pieces, ended: Ended) -> Pieces:
        if ended is None:
            return Pieces(operand.starts, least_from(operand.margins), TRUE)
        starts = together(operand.starts, ended.starts)
        low, kept = ended.at(starts), operand.at(starts)
        return Pieces(starts, backwards(Clamps(low, kept), TRUE), TRUE)

    def _eventually(self, operand: Pieces, ended: Ended) -> Pieces:
        return _negated(self._always(_negated(operand), ended))

    def _after(self, event: Pieces, body: Pieces, ended: Ended) -> Pieces:
        """At an instant: the segment has ended, or, as x is later, the body if it is the event, and x if it is not."""
        starts = together(event.starts, body.starts, *([] if ended is None else [ended.starts]))
        comes = event.at(starts)
        here = np.maximum(-comes, body.at(starts))
        low = np.minimum(here, comes)
        clamps = Clamps(low if ended is None else np.maximum(ended.at(starts), low), here)
        return Pieces(starts, backwards(clamps, TRUE), TRUE)

    def _within(self, duration: Nanoseconds, body: Property, ended: Ended, is_inside: bool) -> Pieces:
        """On the part of the rest from each instant that is at most `duration` later."""

        def of(part: Property) -> Pieces:
            return self._within(duration, part, ended, is_inside)

        match body:
            case Now():
                return self.of(body, ended, is_inside)
            case Not(operand):
                return _negated(of(operand))
            case And(left, right):
                return _least(of(left), of(right))
            case Or(left, right):
                return _greatest(of(left), of(right))
            case Implies(left, right):
                return _greatest(_negated(of(left)), of(right))
            case Throughout(predicate):
                return self._always_within(duration, self._predicate(predicate), ended)
            case Always(operand) if _is_local(operand):
                return self._always_within(duration, self.of(operand, ended, True), ended)
            case Never(operand) if _is_local(operand):
                return self._always_within(duration, _negated(self.of(operand, ended, True)), ended)
            case Eventually(operand) if _is_local(operand):
                return _negated(self._always_within(duration, _negated(self.of(operand, ended, True)), ended))
            case Within(inner, operand, 0):
                return self._within(min(duration, self._line.clipped(inner)), operand, ended, is_inside)
            case _:
                raise UnsupportedError("a bound on temporal operators inside one another")

    def _always_within(self, duration: Nanoseconds, operand: Pieces, ended: Ended) -> Pieces:
        line = self._line
        inputs = operand.starts if ended is None else together(operand.starts, ended.starts)
        times = line.time(inputs)
        moves = line.steps if self._is_at_steps else line.within(line.first_at(times - duration))
        starts = together(inputs, moves)
        firsts = _pieces_at(inputs, starts)
        ends = times.searchsorted(line.time(starts) + duration, "right")
        if ended is None:
            return Pieces(starts, least_of_windows(operand.margins, firsts, ends), TRUE)
        clamps = Clamps(ended.at(inputs), operand.at(inputs))
        return Pieces(starts, over_windows(clamps, firsts, ends, TRUE), TRUE)

    def _later(self, found: Pieces, start: Nanoseconds, ended: Ended) -> Pieces:
        """What is `found` at the first instant that is `start` later; as on no instants if the segment has ended."""
        line = self._line
        inputs = found.starts if ended is None else together(found.starts, ended.starts)
        begins = line.first_at(line.time(inputs[1:] - 1) - start + 1)  # the first whose interval begins in a piece
        last = line.first_at(np.array([line.until - start + 1]))
        starts = line.within(together(inputs, np.insert(begins, 0, 0), last))
        at = line.first_at(line.time(starts) + start)
        is_some = at < line.count
        margins = np.where(is_some, found.at(np.minimum(at, line.count - 1)), found.after)
        if ended is None:
            return Pieces(starts, margins, found.after)
        ends = np.where(is_some, _pieces_at(inputs, at) + 1, 0)
        over = -least_of_windows(-ended.at(inputs), np.where(is_some, _pieces_at(inputs, starts), 0), ends)
        found_inside = np.maximum(over, margins) if found.after > 0 else np.minimum(-over, margins)
        return Pieces(starts, np.where(is_some, found_inside, found.after), found.after)

    def _historically(self, operand: Pieces, within: Nanoseconds | None) -> Pieces:
        """At all instants so far, or of the last `within`."""
        if within is None:
            return Pieces(operand.starts, least_from(operand.margins[::-1])[::-1])
        starts, firsts, ends = self._recent(operand, within)
        return Pieces(starts, least_of_windows(operand.margins, firsts, ends))

    def _recent(self, operand: Pieces, within: Nanoseconds) -> tuple[Array, Array, Array]:
        """Where the pieces of the last `within` change, and which they are there, from one to before another."""
        line, inputs = self._line, operand.starts
        duration = line.clipped(within)
        leaves = line.first_at(line.time(inputs[1:] - 1) + duration + 1)
        starts = together(inputs, line.within(leaves))
        firsts = _pieces_at(inputs, line.first_at(line.time(starts) - duration))
        return starts, firsts, _pieces_at(inputs, starts) + 1

    def _lasting(self, operand: Pieces, duration: Nanoseconds) -> Pieces:
        """At all instants since one that is `duration` ago or more."""
        line, inputs = self._line, operand.starts
        times = line.time(inputs)
        starts = together(inputs, line.within(line.first_at(times + duration)))
        ago = line.time(starts) - duration
        firsts = np.maximum(times.searchsorted(ago, "right") - 1, 0)
        found = least_of_windows(operand.margins, firsts, _pieces_at(inputs, starts) + 1)
        return Pieces(starts, np.where(ago < line.times[0], FALSE, found))

    def _since(self, kept: Pieces, start: Pieces, within: Nanoseconds | None) -> Pieces:
        """At an instant: `start`, or `kept` as well as x at the one before. So all is taken in reverse."""
        inputs = together(kept.starts, start.starts)
        clamps = Clamps(start.at(inputs), np.maximum(start.at(inputs), kept.at(inputs)))
        reverse = Clamps(*(part[::-1] for part in clamps))
        if within is None:
            return Pieces(inputs, backwards(reverse, FALSE)[::-1])
        starts, firsts, ends = self._recent(Pieces(inputs, clamps.low), within)
        count = len(inputs)
        return Pieces(starts, over_windows(reverse, count - ends, count - firsts, FALSE))


def _does_not(property_: Property, *, falls: bool) -> bool:
    """Whether the robustness on the rest of the run is known not to fall between two steps; or, not to rise.

    There, nothing changes but that a window reaches further.
    """
    match property_:
        case Now(predicate):
            return not timed_atoms(predicate)
        case Not(operand):
            return _does_not(operand, falls=not falls)
        case And(left, right) | Or(left, right):
            return _does_not(left, falls=falls) and _does_not(right, falls=falls)
        case Implies(left, right):
            return _does_not(left, falls=not falls) and _does_not(right, falls=falls)
        case Within(_, Eventually(operand), 0):
            return falls and _is_local(operand) and _does_not(operand, falls=True)
        case Within(_, Always(operand) | Never(operand), 0):
            return not falls and _is_local(operand) and _does_not(operand, falls=True)
        case _:
            return False


def _is_local(property_: Property) -> bool:
    """Whether it is judged at the first instant alone."""
    match property_:
        case Now():
            return True
        case Not(operand):
            return _is_local(operand)
        case And(left, right) | Or(left, right) | Implies(left, right):
            return _is_local(left) and _is_local(right)
        case _:
            return False


def _pieces_at(starts: Array, instants: Array) -> Array:
    """Which piece each of `instants` is in."""
    if instants is starts:
        return np.arange(len(starts))
    found: Array = starts.searchsorted(instants, "right") - 1
    return found


def _combined(predicate: Formula, atoms: Mapping[str, Pieces], line: Timeline) -> Pieces:
    after = margin(predicate, dict.fromkeys(atoms, FALSE))
    starts = together(*(each.starts for each in atoms.values())) if atoms else line.steps[:1]
    margins = combined(predicate, {name: each.at(starts) for name, each in atoms.items()})
    return Pieces(starts, np.broadcast_to(margins, len(starts)), after)


def _negated(pieces: Pieces) -> Pieces:
    return Pieces(pieces.starts, -pieces.margins, -pieces.after)


def _least(*parts: Pieces) -> Pieces:
    starts = together(*(part.starts for part in parts))
    return Pieces(starts, reduce(np.minimum, [part.at(starts) for part in parts]), min(part.after for part in parts))


def _greatest(*parts: Pieces) -> Pieces:
    return _negated(_least(*map(_negated, parts)))


def _either(ended: Ended, event: Pieces) -> Pieces:
    return event if ended is None else _greatest(ended, event)
