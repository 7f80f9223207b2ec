"""Values of signals for the replay: what the conditions of a property compare with, its neighbours, and some others."""

from __future__ import annotations

import math
import random
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import pairwise

from ltlc.semantics.words import Letter
from ltlc.specification.atoms import Comparison, Condition, operands
from ltlc.specification.evaluation import Input, Value, is_true, is_undefined, letter
from ltlc.specification.expressions import (
    Current,
    Expression,
    Number,
    Past,
    Signal,
    Slope,
    String,
    ValueType,
    children,
    inputs,
)
from ltlc.specification.specification import PropertySpecification

Sample = dict[Signal, Value]
"""The value of each signal at one step."""

TRIES = 400
"""Samples drawn in search of letters."""

SAMPLES_OF_A_LETTER = 4
"""How many samples of a letter are kept from the edges of each condition, and from those drawn at random."""

BASES = 10
"""In search of the edge of a condition: how often all other signals are drawn, and how many values of one are tried."""


class Samples:
    """Draws samples for one property; the same property draws the same ones."""

    def __init__(self, specification: PropertySpecification) -> None:
        self.specification = specification
        self.signals = tuple(dict.fromkeys(i.signal for i in specification.inputs()))
        self._chance = random.Random(0)
        conditions = [atom.condition for atom in specification.atoms]
        expressions = [e for condition in conditions for operand in operands(condition) for e in _within(operand)]
        margins = {c.margin for c in conditions if isinstance(c, Comparison)}
        self._numbers = _interesting({e.value for e in expressions if isinstance(e, Number)}, margins)
        self._strings = [*dict.fromkeys(e.value for e in expressions if isinstance(e, String)), "", "something else"]

    def draw(self) -> Sample:
        """One sample of every signal."""
        return {signal: self._value(signal.type) for signal in self.signals}

    def by_letter(self) -> dict[Letter, list[Sample]]:
        """A few samples for each letter found, on the edges of the conditions and at random; without history."""
        found: dict[Letter, list[Sample]] = {}
        for source in (*self._edges_of_conditions(), (self.draw() for _ in range(TRIES))):
            taken: Counter[Letter] = Counter()
            for sample in source:
                seen = letter(self.specification.atoms, _now(sample))
                if seen is not None and taken[seen] < SAMPLES_OF_A_LETTER:
                    taken[seen] += 1
                    found.setdefault(seen, []).append(sample)
        return found

    def _edges_of_conditions(self) -> Iterator[list[Sample]]:
        """For each condition and each number in it, neighbouring doubles for which its truth differs."""
        for atom in self.specification.atoms:
            for signal in dict.fromkeys(i.signal for e in operands(atom.condition) for i in inputs(e)):
                if signal.type is ValueType.NUMBER:
                    yield self._edges(atom.condition, signal)

    def _edges(self, condition: Condition, signal: Signal) -> list[Sample]:
        found: list[Sample] = []
        for base in (self.draw() for _ in range(BASES)):
            finite = sorted({x for x in (self._number() for _ in range(BASES)) if math.isfinite(x)})
            pairs = ((base | {signal: a}, base | {signal: b}) for a, b in pairwise(finite))
            for low, high in pairs:
                if _truth(condition, low) != _truth(condition, high):
                    found += _narrowed(condition, signal, low, high)
        self._chance.shuffle(found)
        return found

    def _value(self, type_: ValueType) -> Value:
        match type_:
            case ValueType.NUMBER:
                return self._number()
            case ValueType.BOOLEAN:
                return self._chance.random() < 1 / 2
            case ValueType.STRING:
                return self._chance.choice(self._strings)
            case ValueType.NUMBERS:
                return tuple(self._number() for _ in range(self._chance.randrange(4)))

    def _number(self) -> float:
        if self._chance.random() < 1 / 4:
            return self._chance.gauss(0.0, 10.0)
        return self._chance.choice(self._numbers)


def _now(sample: Sample) -> dict[Input, Value]:
    return {Current(signal): value for signal, value in sample.items()}


def _truth(condition: Condition, sample: Sample) -> bool | None:
    """Whether `condition` holds; None where it has no value."""
    values = _now(sample)
    return None if is_undefined(condition, values) else is_true(condition, values)


def _narrowed(condition: Condition, signal: Signal, low: Sample, high: Sample) -> tuple[Sample, Sample]:
    """The interval from `low` to `high`, on which the truth of `condition` differs, halved until nothing is between."""
    while True:
        a, b = low[signal], high[signal]
        assert isinstance(a, float)
        assert isinstance(b, float)
        middle = low | {signal: a / 2 + b / 2}
        if middle[signal] in (a, b):
            return low, high
        if _truth(condition, middle) == _truth(condition, low):
            low = middle
        else:
            high = middle


def _within(expression: Expression) -> Iterator[Expression]:
    yield expression
    for child in children(expression):
        yield from _within(child)


def _interesting(constants: set[float], margins: set[float]) -> Sequence[float]:
    """Each constant, moved by each margin or not, its nearest neighbours; small numbers; the ends of the line; NaN."""
    centres = {c + side * m for c in constants | {0.0} for m in margins | {0.0} for side in (-1, 1)}
    near = {math.nextafter(c, to) for c in centres for to in (-math.inf, math.inf)}
    return [*sorted(centres | near | {1.0, -1.0, 0.5, 1e9, math.inf, -math.inf}), math.nan]


def inputs_along(specification: PropertySpecification, run: Sequence[Sample]) -> list[dict[Input, Value] | None]:
    """The values of the property's inputs at each step of `run`, each of which samples every signal.

    None where history does not reach back far enough yet.
    """
    return [_inputs_at(specification.inputs(), run, step) for step in range(len(run))]


def _inputs_at(inputs: Sequence[Input], run: Sequence[Sample], step: int) -> dict[Input, Value] | None:
    values: dict[Input, Value] = {}
    for wanted in inputs:
        if isinstance(wanted, Slope):
            raise TypeError("a slope is an input of signals, not of properties")
        ago = wanted.samples if isinstance(wanted, Past) else 0
        if ago > step:
            return None
        values[wanted] = run[step - ago][wanted.signal]
    return values
