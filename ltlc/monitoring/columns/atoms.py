"""The atoms of all properties that step together, over the columns of a block."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from ltlc.monitoring.columns.bits import Bits, pack
from ltlc.monitoring.columns.series import Steps, UnsupportedError
from ltlc.monitoring.columns.thresholds import Threshold, compared
from ltlc.monitoring.columns.values import value
from ltlc.program.expressions import Apply, Expression, Literal
from ltlc.program.functions import Primitive
from ltlc.program.lowering import condition
from ltlc.specification import atoms as a
from ltlc.specification.wire import as_double


class LoweredAtom(NamedTuple):
    """An atom of a specification, and the expression that is true where it `holds`."""

    name: str
    holds: Expression


Compared = tuple[str, Expression, Threshold]
"""The name of an atom that compares with a constant, what it compares, and how."""

_COMPARISONS = {
    Primitive.LESS: (np.less, np.greater),
    Primitive.AT_MOST: (np.less_equal, np.greater_equal),
    Primitive.EQUAL: (np.equal, np.equal),
}
"""How what stands on the left of a constant is compared with it, and how what stands on the right."""


def lowered_atoms(atoms: Iterable[a.Atom]) -> tuple[LoweredAtom, ...]:
    """What columns compute of `atoms`."""
    return tuple(LoweredAtom(atom.name, condition(atom.condition)) for atom in atoms)


def comparisons(atoms: Iterable[LoweredAtom]) -> tuple[Compared, ...]:
    """Those of `atoms` that compare with constants that are doubles."""
    return tuple(found for name, holds in atoms for found in _comparison(name, holds))


def _comparison(name: str, holds: Expression) -> Iterator[Compared]:
    match holds:
        case Apply(primitive, (side, Literal(constant))) if primitive in _COMPARISONS:
            compare, _ = _COMPARISONS[primitive]
        case Apply(primitive, (Literal(constant), side)) if primitive in _COMPARISONS:
            _, compare = _COMPARISONS[primitive]
        case _:
            return
    if not isinstance(constant, str) and as_double(constant) == constant:
        yield name, _unconverted(side), (compare, float(constant))


def _unconverted(side: Expression) -> Expression:
    """What has the same column: there, all numbers are doubles."""
    match side:
        case Apply(Primitive.TO_DOUBLE | Primitive.TO_SIGNED | Primitive.TO_UNSIGNED, (number,)):
            return number
        case _:
            return side


def prepare(compare: Iterable[Compared], steps: Steps) -> None:
    """Compute what is wanted, one column after the other."""
    by_side: dict[Expression, dict[str, Threshold]] = {}
    for name, side, threshold in compare:
        if name not in steps.known:
            by_side.setdefault(side, {})[name] = threshold
    for side, wanted in by_side.items():
        try:
            column = value(side, steps)
        except UnsupportedError:
            continue
        if isinstance(column, np.ndarray) and column.size:
            bits, has_nan = compared(column, list(wanted.values()))
            steps.known.update(zip(wanted, bits, strict=True))
            if not has_nan:
                steps.known["NaN", side] = None


def bits_of(atom: LoweredAtom, steps: Steps) -> Bits:
    """Where `atom` holds. Raises UnsupportedError."""
    if atom.name not in steps.known:
        steps.known[atom.name] = pack(np.broadcast_to(np.asarray(value(atom.holds, steps), np.bool_), len(steps)))
    found: Bits = steps.known[atom.name]
    return found
