"""Values of signals for the replay: what the conditions of a property compare with, its neighbours, and some others."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator, Mapping, Sequence

from ltlc.language.expressions import Current, Expression, Number, Past, Signal, Slope, String, ValueType, children
from ltlc.language.specification import Comparison, PropertySpecification, operands
from ltlc.semantics.values import Input, Value, letter
from ltlc.semantics.words import Letter

Sample = Mapping[Signal, Value]
"""The value of each signal at one step."""

TRIES = 400
"""Samples drawn in search of letters."""


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

    def by_letter(self) -> dict[Letter, Sample]:
        """A sample for each letter that drawing finds; for a property without history."""
        found: dict[Letter, Sample] = {}
        for _ in range(TRIES):
            sample = self.draw()
            seen = letter(self.specification.atoms, {Current(signal): value for signal, value in sample.items()})
            if seen is not None:
                found.setdefault(seen, sample)
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
