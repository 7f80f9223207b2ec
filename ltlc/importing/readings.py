"""Where the readings of a formula part: at points, and over signals whose values change at points and hold in between.

Over signals a formula is judged at all times. If nothing in it changes but at points, its truth is the same everywhere
between two of them: so it is two formulas of points, of what holds at a point, and of what holds from there on.
"""

from __future__ import annotations

from functools import reduce
from math import gcd
from typing import NamedTuple

from ltlc.importing import formulas as f
from ltlc.importing.conditions import NotComparedError, States
from ltlc.importing.showing import compare
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.durations import Nanoseconds

SECOND: Nanoseconds = 10**9


class Parting(NamedTuple):
    """Shortest runs of points, `step` apart, that a formula accepts in one of its readings only; empty if none."""

    step: Nanoseconds
    at_points: str
    over_signals: str


def parting(formula: f.Formula, step: Nanoseconds | None, states: States, possible: Alphabet) -> Parting | None:
    """Where the readings of `formula` part, if they do and that is found out.

    Its bounds count points a `step` apart; if that is None, nanoseconds, and points are a second apart or closer.

    To be called in a child process: it may take any time.
    """
    if step is None:
        step = reduce(gcd, _bounds(formula), SECOND)
        formula = _in_steps(formula, step)
    try:
        signals = over_signals(formula)
        if signals == formula:
            return None
        found = compare(formula, signals, states, possible)
    except NotComparedError:
        return None
    return None if found.is_equal else Parting(step, found.formula_only, found.property_only)


def over_signals(formula: f.Formula) -> f.Formula:
    """What `formula`, read over signals, says at the first point, as a formula of points. Raises NotComparedError."""
    return _read(formula).at


class _Read(NamedTuple):
    """Whether a formula holds at a point, and everywhere between it and the next one, as formulas of points."""

    at: f.Formula
    after: f.Formula


def _read(formula: f.Formula) -> _Read:
    match formula:
        case f.Atom() | f.Truth():
            return _Read(formula, formula)
        case f.Not(operand):
            return _Read(*map(f.negated, _read(operand)))
        case f.And(left, right):
            return _Read(*map(f.conjoined, _read(left), _read(right)))
        case f.Or(left, right):
            return _Read(*map(f.disjoined, _read(left), _read(right)))
        case f.Previous(operand, 1) if f.is_boolean(operand):  # what was held until then
            return _Read(formula, operand)
        case f.Until(f.Truth(), right, start, stop):
            return _eventually(_read(right), start, stop)
        case f.Since(f.Truth(), right, start, stop):
            return _once(_read(right), start, stop)
        case f.Until(left, right, start, stop) if f.is_boolean(left) and f.is_boolean(right):
            return _Read(formula, _held_too(formula))
        case f.Since(left, right, 0, _) if f.is_boolean(left) and f.is_boolean(right):
            return _Read(formula, formula)
        case _:  # such as `p since[1,2] q`, which changes between two points
            raise NotComparedError("over signals it is not a formula of points")


def _held_too(formula: f.Until) -> f.Formula:
    """As `formula` reads between two points: where the interval begins, `left` is still needed."""
    left, right, start, stop = formula.left, formula.right, formula.start, formula.stop
    if not start:
        return formula
    nearest = f.Until(left, f.conjoined(left, right), start, start)
    return nearest if stop == start else f.disjoined(nearest, f.Until(left, right, start + 1, stop))


def _eventually(of: _Read, start: int, stop: int | None) -> _Read:
    """From a point, the interval is from point `start` to point `stop`; from between two, it begins and ends there."""
    if of.at == of.after:
        whole: f.Formula = f.Until(f.TRUE, of.at, start, stop)
        return _Read(whole, whole)
    if stop is None:
        later = f.Until(f.TRUE, f.disjoined(of.at, of.after), start)
        return _Read(later, f.disjoined(f.Until(f.TRUE, of.at, start + 1), f.Until(f.TRUE, of.after, start)))
    return _Read(
        _some(f.Until, (of.at, start, stop), (of.after, start, stop - 1)),
        _some(f.Until, (of.at, start + 1, stop), (of.after, start, stop)),
    )


def _once(of: _Read, start: int, stop: int | None) -> _Read:
    if of.at == of.after:
        whole: f.Formula = f.Since(f.TRUE, of.at, start, stop)
        return _Read(whole, whole)
    if stop is None:
        earlier = f.disjoined(f.Since(f.TRUE, of.at, start), f.Since(f.TRUE, of.after, start))
        return _Read(f.disjoined(f.Since(f.TRUE, of.at, start), f.Since(f.TRUE, of.after, start + 1)), earlier)
    return _Read(
        _some(f.Since, (of.at, start, stop), (of.after, start + 1, stop)),
        _some(f.Since, (of.at, start, stop - 1), (of.after, start, stop)),
    )


def _some(kind: type[f.Until | f.Since], *parts: tuple[f.Formula, int, int]) -> f.Formula:
    """One of the parts, each in its interval, unless that is empty."""
    found = f.FALSE
    for operand, start, stop in parts:
        if start <= stop:
            found = f.disjoined(found, kind(f.TRUE, operand, start, stop))
    return found


def _bounds(formula: f.Formula) -> list[int]:
    """All numbers of intervals in `formula`."""
    parts = (part for part in f.subformulas(formula) if isinstance(part, f.Until | f.Since))
    return [bound for part in parts for bound in (part.start, part.stop) if bound]


def _in_steps(formula: f.Formula, step: Nanoseconds) -> f.Formula:
    """`formula` with intervals in steps."""
    match formula:
        case f.Atom() | f.Truth():
            return formula
        case f.Not(operand):
            return f.Not(_in_steps(operand, step))
        case f.And(left, right) | f.Or(left, right):
            return type(formula)(_in_steps(left, step), _in_steps(right, step))
        case f.Next(operand, steps) | f.Previous(operand, steps):
            return type(formula)(_in_steps(operand, step), steps)
        case f.Until(left, right, start, stop) | f.Since(left, right, start, stop):
            ends = start // step, None if stop is None else stop // step
            return type(formula)(_in_steps(left, step), _in_steps(right, step), *ends)
