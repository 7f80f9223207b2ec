"""Letters that doubles give where real numbers do not: x + 1 == x holds of 1e16, and of infinity."""

from __future__ import annotations

import math
import random
from collections.abc import Hashable, Sequence

from ltlc.analysis.groups import inputs_of, key
from ltlc.semantics.words import Letter
from ltlc.specification.atoms import Atom, operands
from ltlc.specification.evaluation import Value, evaluate, letter
from ltlc.specification.expressions import (
    Current,
    Field,
    Input,
    Number,
    Past,
    Slope,
    String,
    ValueType,
    inputs,
    subexpressions,
)

DRAWS = 400
"""How often values are drawn for the signals of a group."""

_NUMBERS = (0.0, -0.0, 1.0, -1.0, 0.1, 0.2, 0.3, 1e16, -1e16, 1e308, -1e308, 5e-324, -5e-324, math.inf, -math.inf)


def reached(atoms: Sequence[Atom]) -> dict[Letter, dict[Input, Value]]:
    """Letters over `atoms` that drawn values give by the reference, each with such values; the same for the same atoms.

    Not all that there are: it is a search among numbers at which rounding shows.
    """
    chance = random.Random(0)
    constants = {e for atom in atoms for operand in operands(atom.condition) for e in subexpressions(operand)}
    numbers = [*_NUMBERS, *sorted(e.value for e in constants if isinstance(e, Number) and not math.isnan(e.value))]
    strings = [*sorted(e.value for e in constants if isinstance(e, String)), "other"]
    wanted = [value for atom in atoms for value in inputs_of(atom.condition)]
    found: dict[Letter, dict[Input, Value]] = {}
    for _ in range(DRAWS):
        drawn: dict[Hashable, Value] = {}
        values = {value: _value(value, 0, drawn, chance, numbers, strings) for value in wanted}
        seen = letter(tuple(atoms), values)
        if seen is not None:
            found.setdefault(seen, values)
    return found


def _value(
    wanted: Input,
    ago: int,
    drawn: dict[Hashable, Value],
    chance: random.Random,
    numbers: Sequence[float],
    strings: Sequence[str],
) -> Value:
    """The value of `wanted` as it was `ago` samples before: computed by its definition from what is drawn of fields."""
    ago += wanted.samples if isinstance(wanted, Past) else 0
    definition = wanted.signal.definition
    if not isinstance(definition, Field) and not isinstance(wanted, Slope):
        return evaluate(definition, {i: _value(i, ago, drawn, chance, numbers, strings) for i in inputs(definition)})
    name = key(wanted if isinstance(wanted, Slope) else Current(wanted.signal)), ago
    if name not in drawn:
        pool: dict[ValueType, Sequence[Value]] = {ValueType.BOOLEAN: (False, True), ValueType.STRING: strings}
        drawn[name] = chance.choice(pool.get(wanted.signal.type, numbers))
        if wanted.signal.type is ValueType.NUMBERS:
            drawn[name] = tuple(chance.choices(numbers, k=2))
    return drawn[name]
