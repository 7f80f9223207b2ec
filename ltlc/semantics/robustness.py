"""By how much a run satisfies a property: its denotation, with numbers for truth. Coq: `proofs/Robustness.v`.

An atom has a margin, positive where it holds and negative where it does not; what is true or false without measure has
an infinite one. `and` and `all` are the least, `or` and `some` the greatest, `not` changes the sign (Fainekos and
Pappas, *Robustness of temporal logic specifications for continuous-time signals*, 2009). A positive robustness means
that the property is satisfied, a negative one that it is violated, in any run whose margins differ by less than that;
at 0 it is not known: a strict comparison does not hold where its margin is 0, one with equality does.

A segment ends where a scope closes or a bound is over, by some margin as well: `ended`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import assert_never

from ltlc.dataclass import dataclass
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
from ltlc.semantics.timed_atoms import Age, Historically, Occurred, Once, PastAtom, Previously, Since, news_of

TRUE, FALSE = math.inf, -math.inf


@dataclass(frozen=True, slots=True)
class Measured:
    """An instant: its time, the margin of each atom, by name, and by how much the segment judged has ended there.

    `by_time` says that it is no step: margins are held.
    """

    time: Nanoseconds
    margins: Mapping[str, float]
    ended: float = FALSE
    by_time: bool = False


Run = tuple[Measured, ...]


def robustness(run: Run, property_: Property, is_inside: bool = False) -> float:
    """By how much `run`, possibly empty, satisfies `property_`, clause by clause as `satisfies` has it.

    If it `is_inside`, that the first instant is in the segment has been asked, and is not asked again.
    """
    match property_:
        case Now(predicate):
            return margin(predicate, run[0].margins) if is_inside else _seen(predicate, run)
        case Throughout(predicate):
            return _least(max(_outside(run, k), margin(predicate, run[k].margins)) for k in range(len(run)))
        case Not(operand):
            return -robustness(run, operand, is_inside)
        case And(left, right):
            return min(robustness(run, left, is_inside), robustness(run, right, is_inside))
        case Or(left, right):
            return max(robustness(run, left, is_inside), robustness(run, right, is_inside))
        case Implies(left, right):
            return max(-robustness(run, left, is_inside), robustness(run, right, is_inside))
        case Always(operand):
            return _least(max(_outside(run, k), robustness(run[k:], operand, True)) for k in range(len(run)))
        case Never(operand):
            return _least(max(_outside(run, k), -robustness(run[k:], operand, True)) for k in range(len(run)))
        case Eventually(operand):
            return _greatest(min(-_outside(run, k), robustness(run[k:], operand, True)) for k in range(len(run)))
        case After(event, body):
            return _least(max(-_first(run, event, k), robustness(run[k:], body, True)) for k in range(len(run)))
        case Until(event, body):
            comes = _greatest(min(-_outside(run, k), margin(event, run[k].margins)) for k in range(len(run)))
            return min(comes, robustness(_ended_by(run, event), body))
        case AfterUntil(opening, closing, body):
            opens = ltl.And(opening, ltl.Not(closing))
            return _least(
                max(-_opens(run, opens, closing, k), robustness(_ended_by(run[k:], closing), body, True))
                for k in range(len(run))
            )
        case Within(duration, body, 0):
            return robustness(_part(run, duration), body, is_inside)
        case Within(duration, body, start):
            return _interval(run, start, Within(duration - start, body))
        case _:
            assert_never(property_)


def margin(predicate: Formula, margins: Mapping[str, float]) -> float:
    """By how much a state predicate holds."""
    match predicate:
        case ltl.Truth():
            return TRUE
        case ltl.Atom(name):
            return margins[name]
        case ltl.Not(operand):
            return -margin(operand, margins)
        case ltl.And(left, right):
            return min(margin(left, margins), margin(right, margins))
        case ltl.Or(left, right):
            return max(margin(left, margins), margin(right, margins))
        case _:
            raise TypeError(f"not a state predicate: {predicate}")


def _least(margins: Iterable[float]) -> float:
    return min(margins, default=TRUE)


def _greatest(margins: Iterable[float]) -> float:
    return max(margins, default=FALSE)


def _seen(predicate: Formula, run: Run) -> float:
    """Where the segment has ended no atom holds."""
    inside = -run[0].ended if run else FALSE
    margins = {name: min(run[0].margins[name], inside) if run else FALSE for name in ltl.atoms(predicate)}
    return margin(predicate, margins)


def _outside(run: Run, k: int) -> float:
    """By how much the segment has ended at the instant k or before."""
    return _greatest(instant.ended for instant in run[: k + 1])


def _first(run: Run, event: Formula, k: int) -> float:
    """By how much k is the first instant of the segment with `event`."""
    earlier = _greatest(margin(event, instant.margins) for instant in run[:k])
    return min(-_outside(run, k), margin(event, run[k].margins), -earlier)


def _opens(run: Run, opens: Formula, closing: Formula, k: int) -> float:
    """By how much an episode opens at k: at the first chance from the beginning, or from a closing event on."""
    after_closing = (
        min(-_outside(run, j), margin(closing, run[j].margins), _first(run[j:], opens, k - j)) for j in range(k + 1)
    )
    return max(_first(run, opens, k), _greatest(after_closing))


def _ended_by(run: Run, event: Formula) -> Run:
    """The segment before the next `event`."""
    return tuple(replace(each, ended=max(each.ended, margin(event, each.margins))) for each in run)


def _part(run: Run, duration: Nanoseconds) -> Run:
    """The instants that are at most `duration` later than the first."""
    return tuple(each for each in run if each.time - run[0].time <= duration)


def _interval(run: Run, start: Nanoseconds, bounded: Within) -> float:
    """As a scope says it that opens when `start` has passed, `interval_means` in `proofs/Intervals.v`.

    Where the segment has ended before, there are no instants, which is enough for some properties.
    """
    is_enough = robustness((), bounded) > 0
    first = next((k for k, each in enumerate(run) if each.time - run[0].time >= start), None)
    if first is None:
        return TRUE if is_enough else FALSE
    found, ended = robustness(run[first:], bounded, True), _outside(run, first)
    return max(ended, found) if is_enough else min(-ended, found)


def held(steps: Sequence[Measured], until: Nanoseconds, news: Collection[str] = ()) -> Run:
    """The instants of the run of `steps` up to `until`, of which `news` is over a nanosecond after each."""
    ends = [step.time for step in steps[1:]] + [until]
    return tuple(
        instant
        for step, end in zip(steps, ends, strict=True)
        for quiet in [{name: FALSE if name in news else number for name, number in step.margins.items()}]
        for instant in (step, *(Measured(time, quiet, by_time=True) for time in range(step.time + 1, end + 1)))
    )


def with_past(run: Run, atoms: Iterable[PastAtom], session: Nanoseconds | None = None) -> Run:
    """`run` with the margin of each of `atoms`, those that decide an atom before it.

    The session began at `session`, by default at the first instant.
    """
    for atom in atoms:
        found = [_looking_back(atom, run, n, session) for n in range(len(run))]
        run = tuple(
            replace(each, margins={**each.margins, atom.name: number}) for each, number in zip(run, found, strict=True)
        )
    return run


def _looking_back(atom: PastAtom, run: Run, n: int, session: Nanoseconds | None) -> float:
    """The margin of `atom` at the instant n, as `instants.holds_at` has it."""

    def of(predicate: Formula) -> Callable[[int], float]:
        return lambda k: margin(predicate, run[k].margins)

    def ago(k: int) -> Nanoseconds:
        return run[n].time - run[k].time

    match atom:
        case Previously(_, operand):
            return of(operand)(n - 1) if n else FALSE
        case Once(_, operand, within):
            return _greatest(of(operand)(k) for k in range(n + 1) if within is None or ago(k) <= within)
        case Historically(_, operand, None):
            return _least(map(of(operand), range(n + 1)))
        case Historically(_, operand, int(lasting)):
            return _greatest(_least(map(of(operand), range(k, n + 1))) for k in range(n + 1) if ago(k) >= lasting)
        case Since(_, kept, start, within):
            return _greatest(
                min(of(start)(k), _least(map(of(kept), range(k + 1, n + 1))))
                for k in range(n + 1)
                if within is None or ago(k) <= within
            )
        case Age(_, news, most):
            arrivals = [run[k].time for k in range(n + 1) if of(news)(k) > 0]
            began = run[0].time if session is None else session
            return TRUE if run[n].time - (arrivals[-1] if arrivals else began) <= most else FALSE
        case Occurred(_, _, times, within, _, presumed):
            recent = [k for k in range(n + 1) if within is None or ago(k) <= within]
            if presumed and 0 in recent:
                return TRUE
            greatest = sorted((_occurs(atom, run, k) for k in recent), reverse=True)
            return greatest[times - 1] if len(greatest) >= times else FALSE
        case _:
            raise TypeError(f"not a margin: {atom!r}")


def _occurs(count: Occurred, run: Run, k: int) -> float:
    """By how much what is counted occurs at the instant k: at steps only."""
    if run[k].by_time:
        return FALSE
    here = margin(count.operand, run[k].margins)
    if not count.begins:
        return min(here, _greatest(run[k].margins[news.name] for news in news_of(count.operand)))
    return min(here, -margin(count.operand, run[k - 1].margins)) if k else here
