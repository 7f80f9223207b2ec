"""By how much state predicates hold along a run, also those that look back: `semantics/robustness.py`, by pieces."""

from __future__ import annotations

from collections.abc import Mapping
from functools import reduce

import numpy as np

from ltlc.inputs.recordings.blocks import Array, Places
from ltlc.monitoring.columns.bits import union
from ltlc.monitoring.columns.extremes import Clamps, backwards, extremes_from, extremes_of_windows, over_windows
from ltlc.monitoring.columns.margins import combined
from ltlc.monitoring.columns.ranks import nth_greatest
from ltlc.monitoring.columns.timeline import Pieces, Timeline, least, negated, pieces_at, together
from ltlc.semantics import ltl
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.ltl import Formula
from ltlc.semantics.robustness import FALSE, TRUE, margin
from ltlc.semantics.timed_atoms import Age, Historically, Late, News, Occurred, Once, Previously, Since, news_of


class Predicates:
    """The margins of state predicates in a run, of whose atoms `margins` are at steps."""

    def __init__(self, line: Timeline, margins: Mapping[str, Array], since: Mapping[str, Nanoseconds]) -> None:
        """Before the first message at a step, ages count from `since`, by the name of their news."""
        self._line = line
        self._margins = margins
        self._since_when = since
        self._known: dict[Formula, Pieces] = {}

    def of(self, predicate: Formula) -> Pieces:
        """By how much it holds at each instant."""
        if predicate not in self._known:
            of_atoms = {atom.name: self._atom(atom) for atom in _atoms(predicate)}
            self._known[predicate] = self._combined(predicate, of_atoms)
        return self._known[predicate]

    def in_segment(self, predicate: Formula, ended: Pieces) -> Pieces:
        """Where the segment has ended no atom holds."""
        inside = negated(ended)
        return self._combined(predicate, {a.name: least(self.of(a), inside) for a in _atoms(predicate)})

    def _combined(self, predicate: Formula, atoms: Mapping[str, Pieces]) -> Pieces:
        after = margin(predicate, dict.fromkeys(atoms, FALSE))
        starts = together(*(each.starts for each in atoms.values())) if atoms else self._line.steps[:1]
        margins = combined(predicate, {name: each.at(starts) for name, each in atoms.items()})
        return Pieces(starts, np.broadcast_to(margins, len(starts)), after)

    def _atom(self, atom: ltl.Atom) -> Pieces:
        match atom:
            case Previously(_, operand):
                found = self.of(operand)
                starts = self._line.within(found.starts + 1)
                return Pieces(np.insert(starts, 0, 0), np.insert(found.margins[: len(starts)], 0, FALSE))
            case Once(_, operand, within):
                return self._once(self.of(operand), within)
            case Historically(_, operand, None):
                return self._historically(self.of(operand))
            case Historically(_, operand, int(lasting)):
                return self._lasting(self.of(operand), self._line.clipped(lasting))
            case Since(_, kept, start, within):
                return self._since(self.of(kept), self.of(start), within)
            case News(name):
                return self._news(self._margins[name])
            case Age(_, news, most):
                return self._age(news.name, most)
            case Occurred():
                return self._occurred(atom)
            case Late():
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

    def _occurred(self, of: Occurred) -> Pieces:
        """As often as it is counted so far, or in the last `within`."""
        line, operand = self._line, self.of(of.operand)
        occurs = operand.at(line.steps)
        if of.begins:
            occurs = np.append(occurs[:1], np.minimum(occurs[1:], -operand.at(line.steps[1:] - 1)))
        else:
            occurs = np.minimum(occurs, reduce(np.maximum, [self._margins[n.name] for n in news_of(of.operand)]))
        if of.within is None:
            return Pieces(
                line.steps, nth_greatest(of.times, occurs, np.zeros_like(line.steps), np.arange(len(occurs)) + 1)
            )
        duration = line.clipped(of.within)
        starts = together(line.steps, line.within(line.first_at(line.times + duration + 1)))
        firsts = line.times.searchsorted(line.time(starts) - duration)
        found = nth_greatest(of.times, occurs, firsts, pieces_at(line.steps, starts) + 1)
        is_presumed = of.presumed & (firsts == 0)
        return Pieces(starts, np.where(is_presumed, TRUE, found))

    def _historically(self, operand: Pieces) -> Pieces:
        """At all instants so far."""
        return Pieces(operand.starts, extremes_from(np.minimum, operand.margins[::-1], TRUE)[::-1])

    def _once(self, operand: Pieces, within: Nanoseconds | None) -> Pieces:
        """At some instant so far, or of the last `within`."""
        if within is None:
            return Pieces(operand.starts, extremes_from(np.maximum, operand.margins[::-1], FALSE)[::-1])
        starts, firsts, ends = self._recent(operand.starts, within)
        return Pieces(starts, extremes_of_windows(np.maximum, operand.margins, firsts, ends))

    def _recent(self, inputs: Places, within: Nanoseconds) -> tuple[Places, Places, Places]:
        """Where the pieces of the last `within` change, and which they are there, from one to before another."""
        line = self._line
        duration = line.clipped(within)
        leaves = line.first_at(line.time(inputs[1:] - 1) + duration + 1)
        starts = together(inputs, line.within(leaves))
        firsts = pieces_at(inputs, line.first_at(line.time(starts) - duration))
        return starts, firsts, pieces_at(inputs, starts) + 1

    def _lasting(self, operand: Pieces, duration: Nanoseconds) -> Pieces:
        """At all instants since one that is `duration` ago or more."""
        line, inputs = self._line, operand.starts
        times = line.time(inputs)
        starts = together(inputs, line.within(line.first_at(times + duration)))
        ago = line.time(starts) - duration
        firsts = np.maximum(times.searchsorted(ago, "right") - 1, 0)
        found = extremes_of_windows(np.minimum, operand.margins, firsts, pieces_at(inputs, starts) + 1)
        return Pieces(starts, np.where(ago < line.times[0], FALSE, found))

    def _since(self, kept: Pieces, start: Pieces, within: Nanoseconds | None) -> Pieces:
        """At an instant: `start`, or `kept` as well as x at the one before. So all is taken in reverse."""
        inputs = together(kept.starts, start.starts)
        reverse = Clamps(start.at(inputs)[::-1], kept.at(inputs)[::-1])
        if within is None:
            return Pieces(inputs, backwards(reverse, FALSE)[::-1])
        starts, firsts, ends = self._recent(inputs, within)
        count = len(inputs)
        return Pieces(starts, over_windows(reverse, count - ends, count - firsts, FALSE))


def _atoms(predicate: Formula) -> list[ltl.Atom]:
    return [each for each in ltl.subformulas(predicate) if isinstance(each, ltl.Atom)]
