"""What wrong readings have in the place of the definition's functions; each differs from its original in one way."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from statistics import median_low
from typing import Any

import numpy as np

from benchmarks.conformance.cases import Verdicts
from benchmarks.conformance.definition import definition
from benchmarks.differential import judge, past, polygons, values
from benchmarks.differential.judge import MAYBE, Opened, Vector
from benchmarks.differential.names import said
from benchmarks.differential.past import Truth
from benchmarks.differential.samples import Recording, Row, Sampler, Step
from benchmarks.differential.values import Frame, NoValueError, Reader

_EPISODES, _WITHIN, _UNTIL = judge.AfterUntil.episodes, judge.Within.judged, judge.Until.judged
_INITIALLY, _OPENED, _STEP = judge.Initially.judged, judge._opened, Sampler._step
_COUNTED, _FOLD = Reader._counted, values._fold

Episode = tuple[int, int, int]


def every_episode(of: judge.AfterUntil, i: int, m: int, opened: Opened) -> list[Episode]:
    found = []
    for k in range(i, m):
        inside = judge._opened(opened, of.scope, of.of.places[k][0])
        if of.opens.at(k, opened) and not of.closes.at(k, inside):
            end = next((c for c in range(k + 1, m) if of.closes.at(c, inside)), m)
            found.append((k, end, of.of.places[k][0]))
    return found


def first_episode(of: judge.AfterUntil, i: int, m: int, opened: Opened) -> list[Episode]:
    return _EPISODES(of, i, m, opened)[:1]


def closed_episodes(of: judge.AfterUntil, i: int, m: int, opened: Opened) -> list[Episode]:
    return [each for each in _EPISODES(of, i, m, opened) if each[1] < m]


def longer_episodes(of: judge.AfterUntil, i: int, m: int, opened: Opened) -> list[Episode]:
    return [(o, min(c + 1, m), kept) for o, c, kept in _EPISODES(of, i, m, opened)]


def eager_episodes(of: judge.AfterUntil, i: int, m: int, opened: Opened) -> list[Episode]:
    found: list[Episode] = []
    k = i
    while k < m:
        if of.opens.at(k, opened):
            step = of.of.places[k][0]
            inside = judge._opened(opened, of.scope, step)
            end = next((c for c in range(k + 1, m) if of.closes.at(c, inside)), m)
            found.append((k, end, step))
            k = end
        else:
            k += 1
    return found


def after_late(of: judge.After, i: int, m: int, opened: Opened) -> Vector:
    k = next((k for k in range(i, m) if of.event.at(k, opened)), None)
    if k is None:
        return of.of.empty(m, judge.MAYBE | judge.HOLDS, 7)
    inside = judge._opened(opened, of.scope, of.of.places[k][0])
    return of.of.before(k, judge.MAYBE | judge.HOLDS, of.body.value(min(k + 1, m), m, inside))


def after_each(of: judge.After, i: int, m: int, opened: Opened) -> Vector:
    found = of.of.empty(m, judge.MAYBE | judge.HOLDS, 7)
    for k in reversed([k for k in range(i, m) if of.event.at(k, opened)]):
        inside = judge._opened(opened, of.scope, of.of.places[k][0])
        found = of.of.before(k, judge.MAYBE | judge.HOLDS, of.body.value(k, m, inside) & found)
    return found


def until_weak(of: judge.Until, i: int, m: int, opened: Opened) -> Vector:
    if any(of.event.at(k, opened) for k in range(i, m)):
        return _UNTIL(of, i, m, opened)
    return of.body.value(i, m, opened)


def until_with_end(of: judge.Until, i: int, m: int, opened: Opened) -> Vector:
    k = next((k for k in range(i, m) if of.event.at(k, opened)), None)
    if k is None:
        return _UNTIL(of, i, m, opened)
    body = of.body.value(i, k + 1, opened)
    return of.of.before(k, body & np.uint8(MAYBE), body)


def initially_of_run(of: judge.Initially, i: int, m: int, opened: Opened) -> Vector:
    return _INITIALLY(of, 0, max(m, 1), opened)


def initially_of_nothing(of: judge.Initially, i: int, m: int, opened: Opened) -> Vector:
    return of.of.empty(m, MAYBE, 7) if i >= m else _INITIALLY(of, i, m, opened)


def opened_at_first(opened: Opened, scope: int | None, step: int | None) -> Opened:
    return _OPENED(opened, scope, None if step is None else 0)


def _within_from(start: int, end: int, of: judge.Within, i: int, m: int, opened: Opened) -> Vector:
    changed = judge.Within(of.of, start, end, of.inner)
    return _WITHIN(changed, i, m, opened)


def within_open(of: judge.Within, i: int, m: int, opened: Opened) -> Vector:
    return _within_from(of.start, of.end - 1, of, i, m, opened)


def within_ever(of: judge.Within, i: int, m: int, opened: Opened) -> Vector:
    return of.inner.value(i, m, opened)


def within_longer(of: judge.Within, i: int, m: int, opened: Opened) -> Vector:
    return _within_from(of.start, of.start + of.end, of, i, m, opened)


def within_later(of: judge.Within, i: int, m: int, opened: Opened) -> Vector:
    return _within_from(of.start + bool(of.start), of.end, of, i, m, opened)


def within_earlier(of: judge.Within, i: int, m: int, opened: Opened) -> Vector:
    return _within_from(0, of.end, of, i, m, opened)


def previous_step(of: Truth) -> Truth:
    before = [False, *(pieces[0][1] for pieces in of.pieces[:-1])]
    return past.constant(of.on, before)


def previously_at_first(of: Truth) -> Truth:
    found = _PAST["previously"](of)
    (start, _), *rest = found.pieces[0]
    return Truth(of.on, [[(start, True), *(rest or [(start + 1, of.pieces[0][0][1])])], *found.pieces[1:]])


def historically_as_mtl(of: Truth, duration: int | None) -> Truth:
    return past.negation(past.once(past.negation(of), duration))


def since_both(left: Truth, right: Truth, within: int | None) -> Truth:
    return _PAST["since"](left, past.combined(lambda a, b: a and b, left, right), within)


def age_of_steps(on: Sequence[past.Segment], heard: Sequence[tuple[int, int, int]], began: int, duration: int) -> Truth:
    valid = [each for each in heard if each[0] >= 0 and on[each[0]][0] == each[1]]
    return _PAST["age_at_most"](on, valid, began, duration)


_PAST: Mapping[str, Callable[..., Truth]] = {
    name: getattr(past, name) for name in ("age_at_most", "previously", "since")
}


def row_with(row: Row, changed: Callable[[Any], Any]) -> Row:
    """A row with other values."""
    return Row(row.time, {t: {n: changed(v) for n, v in of.items()} for t, of in row.messages.items()})


def a_moment_later(rows: Sequence[Row]) -> list[Row]:
    return [rows[0], *(Row(row.time + 1, row.messages) for row in rows[1:])]


def last_of_a_time(rows: Sequence[Row]) -> list[Row]:
    return list({row.time: row for row in rows}.values())


def merged(rows: Sequence[Row]) -> list[Row]:
    found: dict[int, Row] = {}
    for row in rows:
        before = found[row.time].messages if row.time in found else {}
        found[row.time] = Row(row.time, {**before, **row.messages})
    return list(found.values())


def filled(rows: Sequence[Row]) -> list[Row]:
    known: dict[str, Mapping[str, Any]] = {}
    found = []
    for row in rows:
        known |= row.messages
        found.append(Row(row.time, dict(known)))
    return found


def that_change(rows: Sequence[Row]) -> list[Row]:
    known: dict[str, Mapping[str, Any]] = {}
    found = []
    for row in rows:
        kept = {topic: of for topic, of in row.messages.items() if topic not in known or known[topic] != of}
        known |= kept
        found += [Row(row.time, kept)] if kept else []
    return found


def begun(text: str, rows: Sequence[Row]) -> list[Row]:
    """The first row has a message of every topic, of zeros where it had none."""
    zeros: dict[str, Any] = {"array": (), "boolean": False, "message": True, "string": "", "integer": 0}
    messages: dict[str, dict[str, Any]] = {}
    read = definition(text).signals
    for name, signal in said(text).signals.items():
        if signal.topic is not None and name in read:
            messages.setdefault(signal.topic, {})[name] = zeros.get(signal.kind[0], 0.0)
    return [Row(rows[0].time, {**messages, **rows[0].messages}), *rows[1:]]


def held_over_nan(rows: Sequence[Row]) -> list[Row]:
    known: dict[str, Any] = {}
    found = []
    for row in rows:
        held = {t: {n: known.get(n, v) if v != v else v for n, v in of.items()} for t, of in row.messages.items()}
        for of in held.values():
            known |= {n: v for n, v in of.items() if v == v}
        found.append(Row(row.time, held))
    return found


def without_nan(rows: Sequence[Row]) -> list[Row]:
    return [row for row in rows if not any(_has_nan(v) for of in row.messages.values() for v in of.values())]


def _has_nan(value: Any) -> bool:
    return isinstance(value, tuple) and any(each != each for each in value)


def of_first_id(rows: Sequence[Row]) -> list[Row]:
    first = next((of["key"] for row in rows for of in row.messages.values() if "key" in of), None)
    return [row for row in rows if all(of.get("key", first) == first for of in row.messages.values())]


def step_anyway(sampler: Sampler, time: int, news: frozenset[str]) -> None:
    """A step whose values may be NaN."""
    steps, invalid = len(sampler.run.steps), sampler.run.invalid
    _STEP(sampler, time, news)
    if len(sampler.run.steps) > steps or sampler.run.invalid == invalid:
        return
    found = {(n, ago): sampler.history[n][-1 - ago] for n, ago in sampler.reads.keys if len(sampler.history[n]) > ago}
    truths = sampler.truths(found)
    if truths is not None:
        sampler.run.steps.append(Step(time, found, news, truths))


def counted(of: Reader, node: Any) -> Callable[[Frame], tuple[int, int]]:
    inner = _COUNTED(of, node)

    def some(frame: Frame) -> tuple[int, int]:
        holding, asked = inner(frame)
        return (holding, asked) if asked else (0, 1)

    return some


def exchanged(text: str) -> str:
    """`any` for `all`, and the other way round."""
    return text.replace("any(", "each_(").replace("all(", "any(").replace("each_(", "all(")


def fold(function: str, array: values.Typed) -> values.Typed:
    found = _FOLD(function, array)
    if function not in ("min", "max"):
        return found

    def extreme(frame: Frame) -> Any:
        try:
            return found.of(frame)
        except NoValueError:
            return math.inf if function == "min" else -math.inf

    return values.Typed(extreme, found.kind)


def lower_median(kept: list[float]) -> float:
    if not kept:
        raise NoValueError
    return median_low(kept)


def in_box(point: polygons.Point, polygon: polygons.Polygon) -> bool:
    return all(min(of) <= x <= max(of) for x, of in zip(point, zip(*polygon, strict=True), strict=True))


def inside_only(point: polygons.Point, polygon: polygons.Polygon) -> bool:
    edges = zip(polygon, polygon[1:] + polygon[:1], strict=True)
    return polygons.is_within(point, polygon) and all(polygons._from_edge(point, a, b) > 0 for a, b in edges)


def _nearly(left: Any, right: Any) -> bool:
    is_number = isinstance(left, float) or isinstance(right, float)
    return bool(abs(left - right) <= 1e-9) if is_number and left != right else bool(left == right)


RELATIONS = {**values.RELATIONS, "==": _nearly, "!=": lambda a, b: not _nearly(a, b)}


def always_in_favour(names: Any, scope: int = 0, favour: int = 1, **more: Any) -> Reader:
    """A reader to which nothing is negated."""
    return _Favouring(names, scope, 1, **more)


class _Favouring(Reader):
    def _comparison(self, *given: Any) -> Any:
        self.favour, before = 1, self.favour
        found = super()._comparison(*given)
        self.favour = before
        return found


def singles_as_doubles(text: str) -> str:
    """Fields of binary32 as doubles."""
    return text.replace("Float32.data", "Float64.data").replace("LaserScan.ranges", "Float64MultiArray.data")


def integers_as_doubles(text: str, recording: Recording) -> Verdicts:
    changed = text
    for kind in ("UInt64", "Int64"):
        changed = changed.replace(f"{kind}MultiArray.data", "Float64MultiArray.data").replace(
            f"{kind}.data", "Float64.data"
        )
    rows = [row_with(row, _double) for row in recording.rows]
    return definition(changed).verdicts(Recording(rows, recording.begin, recording.end))


def _double(value: Any) -> Any:
    if isinstance(value, tuple):
        return tuple(map(_double, value))
    return float(value) if type(value) is int and abs(value) > 2**31 else value


def latched_anyway(what: values.Latched, frame: Frame) -> list[Any]:
    value = frame.samples[what.name, 0]
    return [] if value != value else [value]


def first_instance(text: str, recording: Recording) -> Verdicts:
    return _once_opened(text, recording, "after {head}, {body}")


def later_instances(text: str, recording: Recording) -> Verdicts:
    return _once_opened(text, recording, "always (previously ({head}) implies ({body}))")


def _once_opened(text: str, recording: Recording, form: str) -> Verdicts:
    *others, line = text.splitlines()
    head, _, body = line.removeprefix("p: each ").partition(": ")
    found = definition("\n".join([*others, "p: " + form.format(head=head, body=body)]) + "\n").verdicts(recording)
    shown = [(time, "presumably_satisfied" if verdict == "satisfied" else verdict) for time, verdict in found.changes]
    return Verdicts(shown, found.steps)
