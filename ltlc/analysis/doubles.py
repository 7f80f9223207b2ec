"""Letters that values drawn at random give: plain ones, and doubles at which rounding shows.

Of 1e16, and of infinity, x + 1 == x holds; of no real number.
"""

from __future__ import annotations

import math
import random
from collections.abc import Hashable, Sequence
from dataclasses import field

from ltlc.analysis.groups import key, reads_of
from ltlc.dataclass import dataclass
from ltlc.semantics.words import Letter
from ltlc.specification.atoms import Atom
from ltlc.specification.evaluation import Single, Value, evaluate, letter
from ltlc.specification.expressions import (
    Current,
    Field,
    Number,
    Opening,
    Past,
    Read,
    Recent,
    Signal,
    Slope,
    String,
    ValueType,
    inputs,
    operands,
    subexpressions,
)

DRAWS = 400
"""How often values are drawn for the signals of a group."""

LONGEST = 3
"""How many elements arrays are drawn with at most."""

PLAIN_DRAWS = 100
"""How often plain values are drawn: they serve where letters are many and easily found."""

_PLAIN = (0.0, 1.0, -1.0, 0.5, 2.0)
_NUMBERS = (0.0, -0.0, 1.0, -1.0, 0.1, 0.2, 0.3, 1e16, -1e16, 1e308, -1e308, 5e-324, -5e-324, math.inf, -math.inf)


def reached(atoms: Sequence[Atom]) -> dict[Letter, dict[Read, Value]]:
    """Letters over `atoms` that drawn values give by the reference, each with such values; the same for the same atoms.

    Not all that there are: it is a search among numbers at which rounding shows.
    """
    return _reached(atoms, _NUMBERS, DRAWS)


def reached_plainly(atoms: Sequence[Atom]) -> dict[Letter, dict[Read, Value]]:
    """The same, but a search among numbers that examples can show."""
    return _reached(atoms, _PLAIN, PLAIN_DRAWS)


def _reached(atoms: Sequence[Atom], usual: Sequence[float], draws: int) -> dict[Letter, dict[Read, Value]]:
    chance = random.Random(0)
    constants = {e for atom in atoms for operand in operands(atom.condition) for e in subexpressions(operand)}
    numbers = [*usual, *sorted(e.value for e in constants if isinstance(e, Number) and not math.isnan(e.value))]
    strings = [*sorted(e.value for e in constants if isinstance(e, String)), "other"]
    wanted = [value for atom in atoms for value in reads_of(atom.condition)]
    found: dict[Letter, dict[Read, Value]] = {}
    for _ in range(draws):
        draw = _Draw(chance, numbers, strings, chance.randrange(LONGEST + 1))
        values = {value: draw.value(value) for value in wanted}
        seen = letter(tuple(atoms), values)
        if seen is not None:
            found.setdefault(seen, values)
        if len(found) == 1 << len(atoms):
            break
    return found


@dataclass(frozen=True, slots=True)
class _Draw:
    """Values of fields as they are drawn; all arrays are equally long, as fields of the messages of one array are."""

    chance: random.Random
    numbers: Sequence[float]
    strings: Sequence[str]
    length: int
    drawn: dict[Hashable, Value] = field(default_factory=dict)

    def value(self, wanted: Read, ago: int = 0) -> Value:
        """The value of `wanted` as it was `ago` samples before: computed by its definition from what is drawn."""
        if isinstance(wanted, Recent):
            each = (self.value(Current(wanted.signal), ago + back) for back in range(wanted.samples, -1, -1))
            return tuple(value for value in each if not isinstance(value, tuple))
        ago += wanted.samples if isinstance(wanted, Past) else 0
        definition = wanted.signal.definition
        is_drawn = isinstance(definition, Field) or wanted.signal.is_taken
        if not isinstance(definition, Field) and not is_drawn and not isinstance(wanted, Slope | Opening):
            parts: dict[Read, Value] = {each: self.value(each, ago) for each in inputs(definition)}
            return evaluate(definition, parts)
        name = key(wanted if isinstance(wanted, Slope | Opening) else Current(wanted.signal)), ago
        if name not in self.drawn:
            self.drawn[name] = self._any(wanted.signal)
        return self.drawn[name]

    def _any(self, signal: Signal) -> Value:
        pools: dict[ValueType, Sequence[Single]] = {ValueType.BOOLEAN: (False, True), ValueType.STRING: self.strings}
        fitting = [*map(signal.numbers.nearest, self.numbers)]
        pool = pools.get(signal.type.element or signal.type, fitting)
        if signal.type.element is None:
            return self.chance.choice(pool)
        return tuple(self.chance.choices(pool, k=self.length))
