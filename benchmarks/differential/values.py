"""Values of expressions and state predicates without the past, by `docs/language.md`, 'Values' and 'Signals'.

What has no value (NaN, 0/0, the smallest of no elements) raises NoValueError. All is looked at, also where one side of
`or` decides: a step on which anything has no value is none.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import product
from operator import eq, ge, gt, le, lt, ne
from statistics import median_high, median_low
from typing import Any

import numpy as np

from benchmarks.differential.names import Said, number
from benchmarks.differential.polygons import Point, Polygon, away, is_within
from benchmarks.differential.things import derived
from ltlc.frontend.syntax import tree as s

MOST_COMBINATIONS = 10**6
"""Beyond, a count has no value."""


class NoValueError(Exception):
    """An expression has no value at a step."""


Key = tuple[str, int]
"""A signal and how many of its samples ago."""


@dataclass
class Frame:
    """What is known at a step: samples, what signals were when scopes opened, the elements looked at, and news."""

    samples: Mapping[Key, Any]
    opened: Mapping[int, Mapping[Key, Any]] = field(default_factory=dict)
    elements: tuple[int, ...] = (0,)
    news: frozenset[str] = frozenset()


Value = Callable[[Frame], Any]


@dataclass(frozen=True)
class Latched:
    """The value of the signal `name` where `holds` of what `keys` and the news of `topics` say."""

    name: str
    holds: Value
    keys: frozenset[Key]
    topics: frozenset[str]


@dataclass(frozen=True)
class Computed:
    """What is computed `of` the samples in `keys`: a sample of one of them is a sample of it.

    Of a predicate only where it has a value.
    """

    of: Value
    keys: frozenset[Key]
    topics: frozenset[str] = frozenset()
    is_predicate: bool = False


@dataclass(frozen=True)
class Typed:
    """How an expression is computed; `kind` is float64, float32, integer, literal, boolean, string or array."""

    of: Value
    kind: str
    elements: str = ""
    literal: float | int | None = None


RELATIONS = {"==": eq, "!=": ne, "<": lt, "<=": le, ">": gt, ">=": ge}
ORDERINGS = frozenset({"<", "<=", ">", ">="})


def single(value: float) -> float:
    """The nearest number of binary32."""
    return float(np.float32(value))


def valued(value: Any) -> Any:
    """`value`, if it is one."""
    if value != value:
        raise NoValueError
    return value


def looked_at(sides: Iterable[Value], f: Frame) -> list[Any]:
    """The values of `sides`. One without a value is found also beside one whose samples have not come (KeyError)."""
    found, missing = [], None
    for side in sides:
        try:
            found.append(valued(side(f)))
        except KeyError as error:
            missing = error
    if missing is not None:
        raise missing
    return found


@dataclass
class Reader:
    """Makes functions of expressions; what they read is kept in `keys`.

    `scope` is the number of the scope around, which `opening` means; `favour` is 1 under an even number of negations.
    The `units` are what is read as one; of what is in `past`, more than the present value is read.
    """

    names: Said
    scope: int = 0
    favour: int = 1
    keys: set[Key] = field(default_factory=set)
    scopes: set[int] = field(default_factory=set)
    units: set[frozenset[Key]] = field(default_factory=set)
    past: set[str] = field(default_factory=set)
    made: dict[str, Latched | Computed] = field(default_factory=dict)
    topics: set[str] = field(default_factory=set)
    arrays: list[tuple[int, Value]] | None = None
    lists: dict[str, int] = field(default_factory=dict)
    singles: list[Value] = field(default_factory=list)

    def predicate(self, node: s.Node) -> Value:
        """Whether a state predicate without the past, ages and news holds."""
        match node:
            case s.BooleanLiteral(_, value):
                return lambda _: value
            case s.Negation(_, operand):
                self.favour = -self.favour
                inner = self.predicate(operand)
                self.favour = -self.favour
                return lambda f: not inner(f)
            case s.Connective(_, left, operator, right):
                return self._connective(left, operator.text, right)
            case s.Comparison(_, left, operator, right, margin):
                return self._comparison(left, operator.text, right, margin)
            case s.Membership(_, operand, _, items):
                each = [self._comparison(operand, "==", item, None) for item in items]
                return lambda f: max([one(f) for one in each])
            case s.Quantified(_, quantifier, _) if quantifier.text in ("any", "all"):
                holding = self._counted(node)
                if quantifier.text == "any":
                    return lambda f: holding(f)[0] > 0
                return lambda f: holding(f)[0] == holding(f)[1]
            case s.Call(_, s.Word(text="inside"), arguments):
                return self._of_zone(arguments, is_within)
            case _:
                pass
        found = self.expression(node)
        assert found.kind == "boolean", node
        return found.of

    def _connective(self, left: s.Node, operator: str, right: s.Node) -> Value:
        if operator == "implies":
            self.favour = -self.favour
        a = self.predicate(left)
        if operator == "implies":
            self.favour = -self.favour
        b = self.predicate(right)
        if operator == "and":
            return lambda f: a(f) & b(f)
        return (lambda f: a(f) | b(f)) if operator == "or" else (lambda f: (not a(f)) | b(f))

    def _comparison(self, left: s.Node, operator: str, right: s.Node, margin: s.Node | None) -> Value:
        vectors = self.vector(left), self.vector(right)
        if vectors[0] and vectors[1]:
            return self._same_vectors(vectors[0], operator, vectors[1], margin)
        a, b = beside([self._side(left), self._side(right)])
        numeric = a.kind not in ("string", "boolean")
        by = 0.0 if margin is None else float(number(margin))
        if margin is None and operator in ("==", "!=") and numeric:
            by = self.names.margin or 0.0
        x, y = a.of, b.of
        if by == 0:
            relation = RELATIONS[operator]
            return lambda f: relation(*looked_at((x, y), f))
        if operator in ORDERINGS:
            relation, relaxed = RELATIONS[operator], self.favour * (by if operator[0] == "<" else -by)

            def related(f: Frame) -> bool:
                one, other = map(float, looked_at((x, y), f))
                return bool(relation(one, valued(other + relaxed)))

            return related

        def close(f: Frame) -> bool:
            one, other = map(float, looked_at((x, y), f))
            return one == other or abs(one - other) <= by

        return close if operator == "==" else lambda f: not close(f)

    def _same_vectors(self, a: list[Value], operator: str, b: list[Value], margin: s.Node | None) -> Value:
        by = (self.names.margin or 0.0) if margin is None else float(number(margin))

        def same(f: Frame) -> bool:
            apart = [valued(x(f)) - valued(y(f)) for x, y in zip(a, b, strict=True)]
            return not any(apart) if by == 0 else math.hypot(*apart) <= by

        return same if operator == "==" else lambda f: not same(f)

    def _side(self, node: s.Node) -> Typed:
        """A side of a comparison; beside elements, one without any must have a value, or there is no step."""
        before = None if self.arrays is None else len(self.arrays)
        found = self.expression(node)
        if self.arrays is not None and len(self.arrays) == before:
            self.singles.append(found.of)
        return found

    def vector(self, node: s.Node) -> list[Value] | None:
        """The components of what is a vector."""
        match node:
            case s.Reference(_, name, (s.Word(text="position"),)) if name.text in self.names.things:
                return [self.signal(f"{name.text}.position.{axis}").of for axis in "xyz"]
            case s.Arithmetic(_, left, operator, right):
                one, other = self.vector(left), self.vector(right)
                if not one or not other:
                    return None
                sign = 1 if operator.text == "+" else -1
                return [_sum(x, y, sign) for x, y in zip(one, other, strict=True)]
            case _:
                return None

    def signal(self, name: str, ago: int = 0) -> Typed:
        """A signal, or what it was some samples ago."""
        of = self.names.signals[name]
        if of.topic is None:
            return Typed(lambda _: of.fixed, "float64")
        key = (name, ago)
        self.keys.add(key)
        self.units.add(frozenset({key}))
        self.past |= {name} if ago else set()
        return Typed(lambda f: f.samples[key], *of.kind)

    def expression(self, node: s.Node) -> Typed:
        """A number, boolean, string or array."""
        match node:
            case s.NumberLiteral():
                literal = number(node)
                return Typed(lambda _: literal, "literal", literal=literal)
            case s.StringLiteral(_, text):
                return Typed(lambda _: text, "string")
            case s.BooleanLiteral(_, truth):
                return Typed(lambda _: truth, "boolean")
            case s.Minus(_, operand):
                inner = self.expression(operand)
                negative = None if inner.literal is None else -inner.literal
                return Typed(lambda f: -inner.of(f), inner.kind, literal=negative)
            case s.Arithmetic(_, left, operator, right):
                return self._arithmetic(self.expression(left), operator.text, self.expression(right))
            case s.History(_, signal, offset):
                return self._looked_back(node, signal, offset)
            case s.Recent(_, signal, offset):
                return self._element(node, self._recent(signal, int(offset.operand.text)))  # type: ignore[attr-defined]
            case s.Latch(_, s.Reference(_, name, ()), condition):
                return self._element(node, self._latched(name.text, condition))
            case s.News(_, s.Reference(_, name, ())):
                topic = self.names.signals[name.text].topic
                assert topic is not None
                self.topics.add(topic)
                return Typed(lambda f: topic in f.news, "boolean")
            case s.Call(_, function, arguments):
                return self._call(function.text, arguments)
            case s.Quantified():
                holding = self._counted(node)
                return Typed(lambda f: holding(f)[0], "integer")
            case s.Selection(_, base, steps):
                return self._element(node, self._sliced(self.array_or_number(base), steps))
            case s.Reference():
                return self._element(node, self._reference(node))
            case _:
                raise AssertionError(node)

    def array_or_number(self, node: s.Node) -> Typed:
        """As `expression`, but an array is not taken for its elements."""
        aside, self.arrays = self.arrays, None
        found = self.expression(node)
        self.arrays = aside
        return found

    def _element(self, node: s.Node, found: Typed) -> Typed:
        """In the condition of a quantifier, an array stands for each of its elements."""
        if found.kind != "array" or self.arrays is None:
            return found
        number = self.lists.get(_said(node), 0)
        self.arrays.append((number, found.of))
        return Typed(lambda f: valued(found.of(f)[f.elements[number]]), found.elements)

    def _reference(self, node: s.Reference) -> Typed:
        name = node.name.text
        if name in self.names.signals:
            return self._sliced(self.signal(name), node.steps)
        words = [step.text for step in node.steps if isinstance(step, s.Word)]
        inside = replace(self, keys=set(), units=set())
        found = Typed(derived(name, words, lambda part: inside.signal(part).of), "float64")
        self.keys |= inside.keys
        self.units |= {frozenset(inside.keys)} if inside.keys else set()
        return found

    def _sliced(self, found: Typed, steps: tuple[s.Step, ...]) -> Typed:
        for step in steps:
            assert isinstance(step, s.Range), step
            start, stop = (None if end is None else int(end.text) for end in (step.start, step.stop))
            found = Typed(_cut(found.of, start, stop), "array", found.elements)
        return found

    def _looked_back(self, node: s.Node, signal: s.Node, offset: s.Node) -> Typed:
        if not isinstance(signal, s.Reference):
            return self._computed(signal, int(offset.operand.text))  # type: ignore[attr-defined]
        parts = [signal.name.text, *(step.text for step in signal.steps if isinstance(step, s.Word))]
        name = ".".join(parts)
        if isinstance(offset, s.Minus):
            return self._element(node, self.signal(name, int(offset.operand.text)))  # type: ignore[attr-defined]
        scope, key = self.scope, (name, 0)
        self.signal(name)
        self.past.add(name)
        self.scopes.add(scope)
        return self._element(node, Typed(lambda f: f.opened[scope][key], *self.names.signals[name].kind))

    def _recent(self, signal: s.Node, ago: int) -> Typed:
        """The last samples, the oldest first; none of them may have no value."""
        each = [
            self._looked_back(signal, signal, s.Minus(signal.span, s.NumberLiteral(signal.span, str(n))))
            for n in range(ago, -1, -1)
        ]
        return Typed(lambda f: [valued(one.of(f)) for one in each], "array", each[0].kind)

    def _computed(self, node: s.Node, ago: int) -> Typed:
        """What was computed some samples ago."""
        inner = Reader(self.names)
        is_predicate = isinstance(node, s.Comparison | s.Connective | s.Negation)
        of = inner.predicate(node) if is_predicate else inner.expression(node).of
        key = f"computed {len(self.made)}", ago
        self.made[key[0]] = Computed(of, frozenset(inner.keys), is_predicate=is_predicate)
        self.keys.add(key)
        self.units.add(frozenset({key}))
        self.past.add(key[0])
        return Typed(lambda f: f.samples[key], "boolean" if is_predicate else "float64")

    def _latched(self, name: str, condition: s.Node) -> Typed:
        """What a signal was when something held last."""
        inner = Reader(self.names)
        holds = inner.predicate(condition)
        key = f"{name} latched {len(self.made)}", 0
        self.made[key[0]] = Latched(name, holds, frozenset({*inner.keys, (name, 0)}), frozenset(inner.topics))
        self.keys.add(key)
        self.units.add(frozenset({key}))
        self.past.add(key[0])
        return Typed(lambda f: f.samples[key], *self.names.signals[name].kind)

    def _arithmetic(self, a: Typed, operator: str, b: Typed) -> Typed:
        x, y = a.of, b.of

        def divided(f: Frame) -> float:
            above, below = float(valued(x(f))), float(valued(y(f)))
            if below:
                return float(valued(above / below))
            return float(valued(math.nan if not above else math.copysign(math.inf, above) * math.copysign(1.0, below)))

        match operator:
            case "+":
                return Typed(lambda f: valued(float(x(f)) + float(y(f))), "float64")
            case "-":
                return Typed(lambda f: valued(float(x(f)) - float(y(f))), "float64")
            case "*":
                return Typed(lambda f: valued(float(x(f)) * float(y(f))), "float64")
            case _:
                return Typed(divided, "float64")

    def _call(self, function: str, arguments: tuple[s.Node, ...]) -> Typed:
        if len(arguments) == 1 and function in ("min", "max", "sum", "mean", "median", "len"):
            return _fold(function, self.array_or_number(arguments[0]))
        if function == "nearest":
            sought, among = self.expression(arguments[0]).of, self.array_or_number(arguments[1]).of
            return Typed(lambda f: _nearest(float(valued(sought(f))), among(f)), "float64")
        if function == "distance":
            return Typed(self._of_zone(arguments, away), "float64")
        inner = [self.expression(each) for each in arguments]
        first = inner[0].of
        if function == "abs":
            return Typed(lambda f: abs(first(f)), inner[0].kind)
        if function in OF_DOUBLES:
            compute = OF_DOUBLES[function]
            return Typed(lambda f: _within_domain(compute, [float(valued(each.of(f))) for each in inner]), "float64")
        inner = beside(inner)
        kinds = {each.kind for each in inner}
        if kinds == {"integer", "literal"} and all(isinstance(each.literal, int | None) for each in inner):
            kinds = {"integer"}
        kind, choose = kinds.pop() if len(kinds) == 1 else "float64", {"min": min, "max": max}[function]
        as_one: Any = float if kind == "float64" else valued
        return Typed(lambda f: choose([as_one(valued(each.of(f))) for each in inner]), kind)

    def _of_zone(self, arguments: tuple[s.Node, ...], function: Callable[[Point, Polygon], Any]) -> Value:
        """A function of a point and of a zone."""
        *place, zone = arguments
        corners = self.names.zones[zone.name.text]  # type: ignore[attr-defined]
        if len(place) == 1:
            name = place[0].name.text  # type: ignore[attr-defined]
            x, y = (self.signal(f"{name}.position.{axis}").of for axis in "xy")
        else:
            x, y = (self._side(each).of for each in place)
        return lambda f: function((float(valued(x(f))), float(valued(y(f)))), corners)

    def _counted(self, node: s.Quantified) -> Callable[[Frame], tuple[int, int]]:
        """How many elements satisfy the condition, and of how many it says something."""
        aside, self.arrays, self.singles = self.arrays, [], []
        self.lists = {_said(array): number for number, arrays in enumerate(node.over) for array in arrays}
        condition, arrays, singles = self.predicate(node.condition), self.arrays, self.singles
        self.arrays = aside

        def counted(f: Frame) -> tuple[int, int]:
            holding = asked = 0
            looked_at(singles, f)
            ends = [min(len(of(f)) for at, of in arrays if at == number) for number in range(len(node.over) or 1)]
            if math.prod(ends) > MOST_COMBINATIONS:
                raise NoValueError
            for indexes in product(*map(range, ends)):
                try:
                    holding += condition(Frame(f.samples, f.opened, indexes))
                    asked += 1
                except NoValueError:
                    pass
            return holding, asked

        return counted


def _said(node: s.Node) -> str:
    """How a node is written, wherever that is."""
    return re.sub(r"span=Span\([^)]*\)", "", repr(node))


def _sum(x: Value, y: Value, sign: int) -> Value:
    return lambda f: x(f) + sign * y(f)


def _cut(of: Value, start: int | None, stop: int | None) -> Value:
    return lambda f: of(f)[start:stop]


def _within_domain(function: Callable[..., float], arguments: list[float]) -> float:
    """The value of a function of doubles; infinite where it is too large."""
    try:
        return valued(float(function(*arguments)))  # type: ignore[no-any-return]
    except OverflowError:
        return math.inf
    except (ValueError, ZeroDivisionError):
        raise NoValueError from None


def _next_integer(rounded: Callable[[float], int]) -> Callable[[float], float]:
    return lambda value: value if math.isinf(value) else rounded(value)


def _logarithm(value: float) -> float:
    return math.log(value) if value else -math.inf


def _left_over(value: float, divisor: float) -> float:
    return value % divisor + 0.0


def _apart(left: float, right: float) -> float:
    return abs(math.remainder(left - right, 2 * math.pi))


def _nearest(sought: float, elements: Any) -> float:
    kept = [float(each) for each in elements if each == each]
    if not kept:
        raise NoValueError
    return sorted(kept, key=lambda each: 0.0 if each == sought else abs(each - sought))[0]


OF_DOUBLES: Mapping[str, Callable[..., float]] = {
    **{name: getattr(math, name) for name in ("sqrt", "exp", "sin", "cos", "tan", "asin", "acos", "atan2", "hypot")},
    "floor": _next_integer(math.floor),
    "ceil": _next_integer(math.ceil),
    "log": _logarithm,
    "mod": _left_over,
    "sign": lambda value: (value > 0) - (value < 0),
    "angle_between": _apart,
}
"""Functions of numbers that compute in doubles."""


def beside(sides: list[Typed]) -> list[Typed]:
    """Literals as what they stand beside has them: beside a float32 or a double, the nearest of these."""
    kind = next((kind for kind in ("float32", "float64") if any(side.kind == kind for side in sides)), None)
    if kind is None:
        return sides

    def rounded(side: Typed) -> Typed:
        if side.literal is None:
            return side
        nearest = single(side.literal) if kind == "float32" else float(side.literal)
        return Typed(lambda _: nearest, kind)

    return [rounded(side) for side in sides]


def _median(kept: list[float]) -> float:
    if not kept:
        raise NoValueError
    low, high = median_low(kept), median_high(kept)
    if math.isfinite(low) and math.isfinite(high):
        return float((Fraction(low) + Fraction(high)) / 2)
    return float(valued(low + high))


def _fold(function: str, array: Typed) -> Typed:
    of = array.of

    def least(f: Frame) -> Any:
        kept = [each for each in of(f) if each == each]
        if not kept:
            raise NoValueError
        return min(kept) if function == "min" else max(kept)

    def total(f: Frame) -> float:
        elements = [float(valued(each)) for each in of(f)]
        infinite = {each for each in elements if abs(each) == math.inf}
        if infinite:
            return float(infinite.pop()) if len(infinite) == 1 else valued(math.nan)
        try:
            return math.fsum(elements)
        except OverflowError:
            raise NoValueError from None

    if function in ("min", "max"):
        return Typed(least, array.elements)

    def average(f: Frame) -> float:
        kept = [float(each) for each in of(f) if each == each]
        if not kept:
            raise NoValueError
        return float(valued(sum(kept) if math.isinf(sum(map(abs, kept))) else math.fsum(kept))) / len(kept)

    if function == "mean":
        return Typed(average, "float64")
    if function == "median":
        return Typed(lambda f: _median([float(each) for each in of(f) if each == each]), "float64")
    return Typed(total, "float64") if function == "sum" else Typed(lambda f: len(of(f)), "integer")
