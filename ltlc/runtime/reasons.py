"""Why a property is violated, and why a step is invalid."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from math import isnan

from ltlc.runtime.properties import (
    Clock,
    Condition,
    Elements,
    Moment,
    MonitoredProperty,
)
from ltlc.runtime.sampling import Value

Before = tuple[int, Sequence[int]]
"""The state of a monitor before a step, and when each of its clocks was due."""


def because(
    of: MonitoredProperty,
    before: Before,
    moment: Moment,
    values: Sequence[Value],
    bounds: Sequence[int],
    lapsed: Sequence[int | None],
) -> tuple[Condition, ...]:
    """The conditions that led to a violation, when so many `bounds` had passed.

    Clocks that are not due were so when they `lapsed`. At a clock step some clock is
    late, which the monitor may well not ask.
    """
    state, dues = before
    late = [due < moment.time for due in dues]
    given = of.given(values)
    found = list(of.conditions(*given))
    holds = [*(condition.holds for condition in found), *late]
    for clock, due, n in zip(of.clocks, dues, bounds, strict=True):
        found.append(_of_clock(clock, due, moment.time, n))
    edges = of.held_edges if moment.by_time else of.edges
    unknown = {n for e in of.excused if values[e.place] is None for n in e.conditions}
    numbers = decisive(of, edges[state], holds, unknown)
    past = tuple(_remembered(of, edges, state, holds))
    if past:
        aside = {number for _, _, only in of.remembered for number in only}
        numbers = tuple(number for number in numbers if number not in aside)
    first = len(holds) - len(late)
    if moment.by_time and not any(number >= first for number in numbers):
        passed = (n for n, is_late in enumerate(late, first) if is_late)
        numbers = (*numbers, *passed)
    for n, clock in enumerate(of.clocks, first):
        if not clock.bounds or moment.by_time:
            continue
        due = dues[n - first]
        if _came_early(of, state, n, holds):
            so_long = moment.time - due + clock.bounds[bounds[n - first]]
            found[n] = _with_time(clock, found[n], so_long)
        elif (last := lapsed[n - first]) is not None and _came_late(
            of, state, n, holds
        ):
            so_long = moment.time - last + clock.bounds[0]
            found[n] = replace(found[n], holds=clock.late, ago=so_long)
        else:
            continue
        numbers = (*numbers, *({n} - {*numbers}))
    elements = {each.condition: each for each in of.elements}
    return past + tuple(
        with_element(of, elements[n], given, found[n]) if n in elements else found[n]
        for n in numbers
    )


def _remembered(
    of: MonitoredProperty, edges: Sequence[int], state: int, holds: Sequence[bool]
) -> Iterator[Condition]:
    """What was so at the instant before, if all would have led elsewhere otherwise."""
    now = dict(enumerate(holds))
    (target,) = _targets(of, edges[state], now)
    for text, values, _ in of.remembered:
        known, rest = values[state], [r for _, r, _ in of.remembered if r is not values]
        otherwise = [
            _targets(of, edges[s], now)
            for s, value in enumerate(values)
            if value is (not known)
            and all(None in (r[s], r[state]) or r[s] == r[state] for r in rest)
        ]
        if known is not None and otherwise and {target} not in otherwise:
            yield Condition(text, known)


def _came_early(
    of: MonitoredProperty, state: int, clock: int, holds: Sequence[bool]
) -> bool:
    """Whether a step leads elsewhere if the clock with this number had run out before.

    It has not; `holds` has the conditions at the step. A clock step that asks nothing
    is one of this clock.
    """
    if holds[clock]:
        return False
    held, last = of.held_edges[state], range(len(holds) - len(of.clocks), len(holds))
    in_time = _targets(of, held, dict.fromkeys(last, False) | {clock: True})
    if held < 0:
        in_time -= _targets(of, held, dict.fromkeys(last, False))
    now = dict(enumerate(holds))
    target, then = _targets(of, of.edges[state], now), now | {clock: True}
    return any(_targets(of, of.edges[s], then) != target for s in in_time - {state})


def _came_late(
    of: MonitoredProperty, state: int, clock: int, holds: Sequence[bool]
) -> bool:
    """Whether a step would have led elsewhere before this recent clock ran out."""
    if not of.clocks[clock - len(holds)].is_recent:
        return False
    last = range(len(holds) - len(of.clocks), len(holds))
    lapses = dict.fromkeys(last, False) | {clock: True}
    now = dict(enumerate(holds))
    target = _targets(of, of.edges[state], now)
    return any(
        s != state
        and state in _targets(of, held, lapses)
        and _targets(of, of.edges[s], now | {clock: False}) != target
        for s, held in enumerate(of.held_edges)
    )


def _with_time(clock: Clock, condition: Condition, so_long: int) -> Condition:
    """What a clock decides that has run for so long."""
    if clock.is_recent:
        return replace(condition, ago=so_long)
    return replace(condition, lasted=so_long)


def _of_clock(clock: Clock, due: int, time: int, passed: int) -> Condition:
    """What a clock that is `due` then, so many bounds of which have passed, decides.

    An age that has just passed its bound is not reported.
    """
    age = None
    if clock.is_age and time > due + 1:
        age = time - due + clock.bounds[passed]
    return Condition(clock.texts[passed], (due < time) == clock.late, age=age)


def with_element(
    of: MonitoredProperty,
    elements: Elements,
    values: Sequence[Value],
    condition: Condition,
) -> Condition:
    """A condition with the element of its arrays that decides it, if there is one."""
    arrays = [values[place] for place in elements.places]
    length = min(map(len, arrays))

    def shown(first: int) -> Value:
        """What the condition has of the first elements."""
        part = list(values)
        for place, array in zip(elements.places, arrays, strict=True):
            part[place] = array[:first]
        found = list(of.conditions(*part))[elements.condition]
        return found.left if elements.is_extreme else found.holds

    wanted = condition.left if elements.is_extreme else condition.holds
    least = bisect_left(range(length), True, key=lambda n: shown(n + 1) == wanted)
    if least == length or shown(least) == wanted:
        return condition
    names = (str(of.inputs[place]) for place in elements.places)
    told = tuple((name, a[least]) for name, a in zip(names, arrays, strict=True))
    return replace(condition, element=(least, told))


def decisive(
    property_: MonitoredProperty,
    edge: int,
    holds: Sequence[bool],
    unknown: Collection[int] = (),
) -> tuple[int, ...]:
    """The conditions that lead from `edge` where all do; no fewer do.

    Those that are `unknown` are no reason where the others are enough.
    """
    asked, target = [], edge
    while target < 0:
        number, low, high = property_.decisions[~target]
        asked.append(number)
        target = high if holds[number] else low
    if unknown:
        known = [n for n in range(len(holds)) if n not in unknown]
        if _targets(property_, edge, {n: holds[n] for n in known}) == {target}:
            asked = known
    needed = dict.fromkeys(sorted(asked))
    for number in asked:
        others = {n: holds[n] for n in needed if n != number}
        if _targets(property_, edge, others) == {target}:
            del needed[number]
    return tuple(needed)


def _targets(
    property_: MonitoredProperty, edge: int, holds: Mapping[int, bool]
) -> set[int]:
    """Where `edge` can lead, if of the conditions only those in `holds` are known."""
    reached = [edge]
    for target in reached:
        if target < 0:
            number, low, high = property_.decisions[~target]
            known = holds.get(number)
            next_ = (low, high) if known is None else ((low, high)[known],)
            reached += [t for t in next_ if t not in reached]
    return {target for target in reached if target >= 0}


def reason_of_none(property_: MonitoredProperty, values: Sequence[Value]) -> str:
    """Why there is no step where the inputs have these values, of which a NaN came."""
    if any(map(_is_nan, values)):
        return "a value was NaN"
    causes = [
        f"all of {property_.inputs[place]} was NaN"
        if value
        else f"{property_.inputs[place]} was empty"
        for place in property_.needed
        if (value := values[place]) is not None and all(map(_is_nan, value))
    ]
    said = "an expression had no value"
    return f"{said}: {', '.join(causes)}" if causes else said


def _is_nan(value: Value) -> bool:
    return value.__class__ is float and isnan(value)
