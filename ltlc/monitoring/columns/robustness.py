"""By how much properties hold at each step of a run, over columns: `semantics/robustness.py`, piece by piece.

No operator takes more than so many passes over the pieces as a window of it has doublings.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import assert_never

import numpy as np

from ltlc.inputs.recordings.blocks import Array
from ltlc.monitoring.columns.extremes import Clamps, backwards, empty, extremes_from, extremes_of_windows, over_windows
from ltlc.monitoring.columns.past import Predicates
from ltlc.monitoring.columns.series import UnsupportedError
from ltlc.monitoring.columns.timeline import (
    Pieces,
    StepsAlone,
    Timeline,
    ends_at,
    greatest,
    least,
    negated,
    pieces_at,
    together,
)
from ltlc.semantics import ltl
from ltlc.semantics.durations import Nanoseconds
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
    children,
    predicates,
)
from ltlc.semantics.robustness import FALSE, TRUE
from ltlc.semantics.timed_atoms import timed_atoms

Ended = Pieces | None
"""By how much a segment has ended; None: it ends with the run."""


def at_steps(
    property_: Property, line: Timeline, margins: Mapping[str, Array], since: Mapping[str, Nanoseconds]
) -> Array:
    """That of `property_` at each step, of whose atoms `margins` are. Raises UnsupportedError of what is not measured.

    Before the first message at a step, ages count from `since`, by the name of their news. If nothing happens between
    steps that is not known from them, other instants are not looked at.
    """
    if _is_of_steps(property_) and not any(map(timed_atoms, predicates(property_))):
        line = StepsAlone(line.times, line.until)
    return Robustness(line, Predicates(line, margins, since)).of(property_).at(line.steps)


def still_possible(
    property_: Property, line: Timeline, margins: Mapping[str, Array], since: Mapping[str, Nanoseconds]
) -> tuple[float, float]:
    """Between which numbers it is of the whole run, however that continues. Raises UnsupportedError as `at_steps`."""
    predicates = Predicates(line, margins, since)
    low, high = (Robustness(line, predicates, future).of(property_).margins[0] for future in (FALSE, TRUE))
    return float(low), float(high)


class Robustness:
    """The robustness of properties on the rest of a run from each instant on.

    If the run continues, this is the least or the greatest that it can still become: `future` is the margin of whatever
    is said of instants that have not come. Predicates are known where the run is. Coq: `proofs/Bands.v`.
    """

    def __init__(self, line: Timeline, predicates: Predicates, future: float | None = None) -> None:
        self._line = line
        self._predicates = predicates
        self._future = future

    @property
    def _opposite(self) -> Robustness:
        """The future that is best for what is negated is the worst."""
        return self if self._future is None else Robustness(self._line, self._predicates, -self._future)

    def _beyond(self, none: float) -> float:
        """What follows the last instant: `none`, unless the run continues."""
        return none if self._future is None else self._future

    def of(self, property_: Property, ended: Ended = None, is_inside: bool = False) -> Pieces:
        """That of `property_`. Raises UnsupportedError of what cannot be measured."""
        match property_:
            case Now(predicate):
                if is_inside or ended is None:
                    return self._predicates.of(predicate)
                return self._predicates.in_segment(predicate, ended)
            case Throughout(predicate):
                return self._always(self._predicates.of(predicate), ended)
            case Not(operand):
                return negated(self._opposite.of(operand, ended, is_inside))
            case And(left, right):
                return least(self.of(left, ended, is_inside), self.of(right, ended, is_inside))
            case Or(left, right):
                return greatest(self.of(left, ended, is_inside), self.of(right, ended, is_inside))
            case Implies(left, right):
                return greatest(negated(self._opposite.of(left, ended, is_inside)), self.of(right, ended, is_inside))
            case Always(operand):
                return self._always(self.of(operand, ended, True), ended)
            case Never(operand):
                return negated(self._opposite.of(Eventually(operand), ended), is_new=True)
            case Eventually(operand):
                return self._eventually(self.of(operand, ended, True), ended)
            case After(event, body):
                return self._after(self._predicates.of(event), self.of(body, ended, True), ended)
            case Until(event, body):
                comes = self._predicates.of(event)
                return least(self._eventually(comes, ended), self.of(body, _either(ended, comes)))
            case AfterUntil(opening, closing, body):
                closes = self._predicates.of(closing)
                opens = self._predicates.of(ltl.And(opening, ltl.Not(closing)))
                first = self._after(opens, self.of(body, _either(ended, closes), True), ended)
                return least(first, self._always(greatest(negated(closes), first), ended))
            case Within(duration, body, 0):
                return self._within(self._line.clipped(duration), body, ended, is_inside)
            case Within(duration, body, start):
                found = self._within(self._line.clipped(duration - start), body, ended, True)
                return self._later(found, self._line.clipped(start), ended)
            case _:
                assert_never(property_)

    def _always(self, operand: Pieces, ended: Ended) -> Pieces:
        return self._rest(np.minimum, operand, ended)

    def _eventually(self, operand: Pieces, ended: Ended) -> Pieces:
        return self._rest(np.maximum, operand, ended)

    def _rest(self, extreme: np.ufunc, operand: Pieces, ended: Ended) -> Pieces:
        """The extreme from each instant up to where the segment has ended."""
        none = empty(extreme)
        if ended is None:
            return Pieces(operand.starts, extremes_from(extreme, operand.margins, self._beyond(none)), none)
        starts = together(operand.starts, ended.starts)
        clamps = _clamps(extreme, operand.at(starts), ended.at(starts))
        return Pieces(starts, backwards(clamps, self._beyond(none)), none)

    def _after(self, event: Pieces, body: Pieces, ended: Ended) -> Pieces:
        """At an instant: the segment has ended, or, as x is later, the body if it is the event, and x if it is not."""
        starts = together(event.starts, body.starts, *([] if ended is None else [ended.starts]))
        comes = event.at(starts)
        here = np.maximum(-comes, body.at(starts))
        low = np.minimum(here, comes)
        clamps = Clamps(low if ended is None else np.maximum(ended.at(starts), low), here)
        return Pieces(starts, backwards(clamps, self._beyond(TRUE)), TRUE)

    def _within(self, duration: Nanoseconds, body: Property, ended: Ended, is_inside: bool) -> Pieces:
        """On the part of the rest from each instant that is at most `duration` later."""

        def of(part: Property, of: Robustness = self) -> Pieces:
            return of._within(duration, part, ended, is_inside)

        match body:
            case Now():
                return self.of(body, ended, is_inside)
            case Not(operand):
                return negated(of(operand, self._opposite))
            case And(left, right):
                return least(of(left), of(right))
            case Or(left, right):
                return greatest(of(left), of(right))
            case Implies(left, right):
                return greatest(negated(of(left, self._opposite)), of(right))
            case Throughout(predicate):
                return self._window(np.minimum, duration, self._predicates.of(predicate), ended)
            case Always(operand) if _is_local(operand):
                return self._window(np.minimum, duration, self.of(operand, ended, True), ended)
            case Never(operand) if _is_local(operand):
                within = self._opposite._within(duration, Eventually(operand), ended, is_inside)
                return negated(within, is_new=True)
            case Eventually(operand) if _is_local(operand):
                return self._window(np.maximum, duration, self.of(operand, ended, True), ended)
            case Within(inner, operand, 0):
                return self._within(min(duration, self._line.clipped(inner)), operand, ended, is_inside)
            case _:
                raise UnsupportedError("a bound on temporal operators inside one another")

    def _window(self, extreme: np.ufunc, duration: Nanoseconds, operand: Pieces, ended: Ended) -> Pieces:
        """The extreme of the next `duration` from each instant, up to where the segment has ended."""
        line, none = self._line, empty(extreme)
        inputs = operand.starts if ended is None else together(operand.starts, ended.starts)
        times = line.time(inputs)
        starts = together(
            inputs, line.reaching(times if self._future is None else np.append(times, line.until), duration)
        )
        firsts = pieces_at(inputs, starts)
        until = line.time(starts) + duration
        ends = ends_at(times, until)
        beyond = none if self._future is None else np.where(until < line.until, none, self._future)
        if ended is None:
            found = extremes_of_windows(extreme, operand.margins, firsts, ends)
            return Pieces(starts, found if self._future is None else extreme(found, beyond), none)
        clamps = _clamps(extreme, operand.at(inputs), ended.at(inputs))
        return Pieces(starts, over_windows(clamps, firsts, ends, beyond), none)

    def _later(self, found: Pieces, start: Nanoseconds, ended: Ended) -> Pieces:
        """What is `found` at the first instant that is `start` later; as on no instants if the segment has ended."""
        line = self._line
        inputs = found.starts if ended is None else together(found.starts, ended.starts)
        changes = line.first_at(line.time(inputs[1:] - 1) - start + 1)  # the first whose interval begins in a piece
        last = line.first_at(np.array([line.until - start + 1]))
        starts = line.within(together(inputs, np.insert(changes, 0, 0), last))
        at = line.first_at(line.time(starts) + start)
        is_some = at < line.count
        margins = np.where(is_some, found.at(np.minimum(at, line.count - 1)), self._beyond(found.after))
        if ended is None:
            return Pieces(starts, margins, found.after)
        ends = np.where(is_some, pieces_at(inputs, at) + 1, len(inputs))
        over = extremes_of_windows(np.maximum, ended.at(inputs), pieces_at(inputs, starts), ends)
        inside = np.maximum(over, margins) if found.after > 0 else np.minimum(-over, margins)
        return Pieces(
            starts, inside if self._future is not None else np.where(is_some, inside, found.after), found.after
        )


def _clamps(extreme: np.ufunc, margins: Array, ended: Array) -> Clamps:
    """What `extreme` makes at each instant of its value at the next one: nothing more once the segment has ended."""
    if extreme is np.minimum:
        return Clamps(ended, margins)
    inside = -ended
    return Clamps(np.minimum(inside, margins), inside)


def _is_of_steps(property_: Property) -> bool:
    """Whether the robustness at each step is the same as if time did not pass between steps."""
    match property_:
        case Now() | Throughout():
            return True
        case Not(operand):
            return _is_of_steps(operand)
        case And(left, right) | Or(left, right) | Implies(left, right):
            return _is_of_steps(left) and _is_of_steps(right)
        case Within():
            return property_.start == 0
        case Always(operand):
            return _does_not(operand, falls=True)
        case Never(operand) | Eventually(operand):
            return _does_not(operand, falls=False)
        case _:
            return not _has_bound(property_)


def _has_bound(property_: Property) -> bool:
    return isinstance(property_, Within) or any(map(_has_bound, children(property_)))


def _does_not(property_: Property, *, falls: bool) -> bool:
    """Whether the robustness on the rest of the run is known not to fall between two steps; or, not to rise.

    There, nothing changes but that a window reaches further.
    """
    match property_:
        case Not(operand):
            return _does_not(operand, falls=not falls)
        case And(left, right) | Or(left, right):
            return _does_not(left, falls=falls) and _does_not(right, falls=falls)
        case Implies(left, right):
            return _does_not(left, falls=not falls) and _does_not(right, falls=falls)
        case Within(_, Eventually(operand), 0):
            return falls and _is_local(operand)
        case Within(_, Always(operand) | Never(operand), 0):
            return not falls and _is_local(operand)
        case _:
            return not _has_bound(property_)


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


def _either(ended: Ended, event: Pieces) -> Pieces:
    return event if ended is None else greatest(ended, event)
