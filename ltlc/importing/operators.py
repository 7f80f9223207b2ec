"""How other tools write formulas: the tables of their operators, and what these mean."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field

from ltlc.dataclass import dataclass
from ltlc.importing import formulas as f
from ltlc.importing.values import POWER, PRODUCT, SUM, Part

Bounds = tuple[int, int | None]
Measure = Callable[[str, str], int]
"""How long a number with a unit is, which may be empty: in positions, or in nanoseconds. Raises FormulaError."""


@dataclass(frozen=True)
class Form:
    """How formulas are written: what each word and sign means, and how tightly what stands between two parts binds.

    The signs of `and`, `or`, `not` and comparisons are the same in all forms. Those in `right` are right-associative.
    Where `leads` is set, an `until` asks for its left side from the beginning of its interval on. `structures` have the
    fields of types, and `parts` what is defined.
    """

    words: Mapping[str, str]
    levels: Mapping[str, int]
    right: frozenset[str] = frozenset()
    leads: bool = False
    structures: Mapping[str, Sequence[str]] = field(default_factory=dict)
    parts: Mapping[str, Part] = field(default_factory=dict)
    functions: frozenset[str] = frozenset(("abs", "sqrt", "min", "max", "exp", "log", "sign", "floor", "ceil"))


SIGNS = {
    "&": "and",
    "&&": "and",
    "∧": "and",
    "|": "or",
    "||": "or",
    "∨": "or",
    "!": "not",
    "¬": "not",
    "~": "not",
    "->": "implies",
    "=>": "implies",
    "→": "implies",
    "<->": "iff",
    "<=>": "iff",
    "↔": "iff",
    "=": "==",
    "==": "==",
    "===": "==",
    "!=": "!=",
    "!==": "!=",
    "≠": "!=",
    "≤": "<=",
    "≥": ">=",
    "**": "^",
    **{sign: sign for sign in ("<", "<=", ">", ">=", "+", "-", "*", "/", "%", "^")},
}
COMPARED = frozenset(("==", "!=", "<", "<=", ">", ">="))
ARITHMETIC = {"+": SUM, "-": SUM, "*": PRODUCT, "/": PRODUCT, "%": PRODUCT, "mod": PRODUCT, "^": POWER}


def _release(p: f.Formula, q: f.Formula, start: int, stop: int | None) -> f.Formula:
    return f.Not(f.Until(f.negated(p), f.negated(q), start, stop))


def _trigger(p: f.Formula, q: f.Formula, start: int, stop: int | None) -> f.Formula:
    return f.Not(f.Since(f.negated(p), f.negated(q), start, stop))


def _weak_until(p: f.Formula, q: f.Formula, start: int, stop: int | None) -> f.Formula:
    """Unbounded `p W q`; within bounds, rtamt's `unless`: `p` always within them, or `p U q`."""
    if stop is None:
        return f.weak_until(p, q)
    return f.Or(f.always(p, 0, stop), f.Until(p, q, start, stop))


LOGICAL: Mapping[str, Callable[[f.Formula, f.Formula], f.Formula]] = {
    "and": f.conjoined,
    "or": f.disjoined,
    "implies": f.implies,
    "iff": f.equivalent,
    "xor": lambda p, q: f.Not(f.equivalent(p, q)),
}
BETWEEN: Mapping[str, Callable[[f.Formula, f.Formula, int, int | None], f.Formula]] = {
    "until": f.Until,
    "since": f.Since,
    "release": _release,
    "trigger": _trigger,
    "weak until": _weak_until,
}
BEFORE: Mapping[str, Callable[..., f.Formula]] = {
    "always": f.always,
    "eventually": f.eventually,
    "once": lambda p, start, stop: f.Since(f.TRUE, p, start, stop),
    "historically": lambda p, start, stop: f.Not(f.Since(f.TRUE, f.negated(p), start, stop)),
    "next": lambda p, start, stop: f.Next(p, start),
    "previous": lambda p, start, stop: f.Previous(p, start),
    "weak previous": lambda p, start, stop: f.Not(f.Previous(f.negated(p), start)),
}
ALONE: Mapping[str, f.Formula] = {"first": f.Not(f.Previous(f.TRUE)), "last": f.Next(f.FALSE)}
"""The first position, and the last one."""
DEFAULT: Mapping[str, Bounds] = {"next": (1, None), "previous": (1, None), "weak previous": (1, None)}
