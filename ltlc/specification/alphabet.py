"""Which letters exist: atoms that compare the same things do not hold independently of one another.

Three kinds of groups: comparisons of one expression with constants, comparisons of one pair of expressions, and
equalities of one string with constants. All other atoms are free, and groups are free of one another.

Lemma: every letter that the reference (`evaluation.letter`) gives for some values is allowed. By groups: the sides of a
comparison are numbers other than NaN, or there is no step; equal expressions have one value at a step; and

- with constants: each of the numbers of `numbers_of` gives a valuation of the group (`cells.samples`);
- of a pair: each pair of doubles gives a valuation of its groups (`pairs`);
- of strings: a string equals at most one of several different constants.

The valuations of the first and the last kind are all given by some such number, or some string: of a field by one that
its type has. Of what is computed, only the sign is asked for: `abs(v) < 0` cannot hold, but `v * v == 2`, which no
double solves, may. Pairs are taken for doubles whatever their types: `u > w + 300` may hold of two bytes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial

from ltlc.dataclass import dataclass
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.words import Letter
from ltlc.specification.atoms import Atom
from ltlc.specification.cells import holds, samples
from ltlc.specification.expressions import (
    Comparison,
    Expression,
    Number,
    Relation,
    Same,
    String,
)
from ltlc.specification.numbers import numbers_of
from ltlc.specification.pairs import pair_valuations
from ltlc.specification.wire import Numbers

Compared = dict[str, Comparison]
"""Comparisons by the names of their atoms."""


def alphabet(atoms: Iterable[Atom]) -> Alphabet:
    """The letters over `atoms` that some values of the signals give."""
    listed = tuple(atoms)
    groups = [*_constant_groups(listed), *_pair_groups(listed), *_string_groups(listed)]
    names = tuple(atom.name for atom in listed)
    tight = [group for group in groups if len(group.valuations) < 2 ** len(group.atoms)]
    return Alphabet(names, tuple(sorted(tight, key=lambda group: names.index(group.atoms[0]))))


def _constant_groups(atoms: Sequence[Atom]) -> Iterator[Group]:
    """Comparisons with constants, by the expression that is compared."""
    by_expression: dict[Expression, Compared] = {}
    for atom in atoms:
        match atom.condition:
            case Comparison(expression, _, Number()) | Comparison(Number(), _, expression):
                by_expression.setdefault(expression, {})[atom.name] = atom.condition
            case _:
                pass
    for expression, compared in by_expression.items():
        yield Group(tuple(compared), _line_valuations(compared, numbers_of(expression)))


def _line_valuations(compared: Compared, numbers: Numbers) -> tuple[Letter, ...]:
    """What can hold of comparisons of one of `numbers` with constants, from the smallest of them up.

    Lemma: no condition changes twice between two neighbouring constants, nor beyond them all. Sums and differences with
    a constant are rounded, but never fall where the number rises; so an ordering changes once on the whole line, and
    the distance to a constant c falls up to c and rises from there; of an infinite one, no margin has another number.
    Coq: `valuations`, `valuations_exact`.
    """
    conditions = {name: _condition(comparison) for name, comparison in compared.items()}
    pivots = [side.value for c in compared.values() for side in (c.left, c.right) if isinstance(side, Number)]
    values = samples(list(conditions.values()), pivots, numbers)
    letters = (frozenset(name for name, condition in conditions.items() if condition(v)) for v in values)
    return tuple(dict.fromkeys(letters))


def _condition(comparison: Comparison) -> Callable[[float], bool]:
    """`comparison` as a condition on the value of the side that is not constant."""
    if isinstance(comparison.right, Number):
        constant = comparison.right.value
        return lambda value: holds(comparison, value, constant)
    assert isinstance(comparison.left, Number)
    return partial(holds, comparison, comparison.left.value)


def _pair_groups(atoms: Sequence[Atom]) -> Iterator[Group]:
    """Comparisons of two expressions that are not constant, by the pair.

    A margin speaks of doubles: of integers that are none, those with a margin are a pair of their own.
    """
    pairs: dict[tuple[Expression, Expression, bool], _Pair] = {}
    for atom in atoms:
        match atom.condition:
            case Comparison(left, _, right, margin) if not isinstance(left, Number) and not isinstance(right, Number):
                rounded = margin != 0 and (numbers_of(left).is_wide or numbers_of(right).is_wide)
                sides = (right, left) if (right, left, rounded) in pairs else (left, right)
                pairs.setdefault((*sides, rounded), _Pair(sides, {}, {})).add(atom.name, atom.condition)
    for pair in pairs.values():
        yield from pair.groups()


@dataclass(frozen=True, slots=True)
class _Pair:
    """The comparisons of two expressions: in the order of `sides`, and the orderings with a margin the other way."""

    sides: tuple[Expression, Expression]
    forward: Compared
    backward: Compared

    def add(self, name: str, comparison: Comparison) -> None:
        """Enter a comparison; without a margin, `b < a` is `a > b`, and equality is the same both ways."""
        if comparison.left == self.sides[0]:
            self.forward[name] = comparison
        elif comparison.margin == 0 or comparison.relation is Relation.EQUAL:
            left, right = self.sides
            self.forward[name] = Comparison(left, comparison.relation.flipped, right, comparison.margin)
        else:
            self.backward[name] = comparison

    def groups(self) -> Iterator[Group]:
        """At most one group for each direction."""
        for compared in (self.forward, self.backward):
            if compared:
                yield Group(tuple(compared), pair_valuations(compared))


def _string_groups(atoms: Sequence[Atom]) -> Iterator[Group]:
    """Equalities of one string with constants: at most one holds."""
    by_expression: dict[Expression, list[str]] = {}
    for atom in atoms:
        if isinstance(atom.condition, Same) and isinstance(atom.condition.right, String):
            by_expression.setdefault(atom.condition.left, []).append(atom.name)
    for names in by_expression.values():
        one: list[Letter] = [frozenset({name}) for name in names]
        yield Group(tuple(names), (frozenset(), *one))
