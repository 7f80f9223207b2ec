"""Core LTL: seven constructors, and the usual operators as abbreviations of them.

One syntax, two readings: on finite words LTLf (De Giacomo and Vardi, *Linear temporal logic and linear dynamic logic on
finite traces*, 2013), in `finite`; on infinite words LTL (Pnueli 1977), in `lasso`. A truth condition below speaks of
both: 'some step from here on' means a step that the word has. On the empty word an atom, `next_` and `until` are false.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from functools import reduce
from typing import assert_never

from ltlc.dataclass import dataclass


class _Formula:
    __slots__ = ()

    def __str__(self) -> str:
        assert isinstance(self, Formula)
        return to_text(self)


@dataclass(frozen=True, slots=True)
class Truth(_Formula):
    """`true`: holds on every word, the empty one included."""


@dataclass(frozen=True, slots=True)
class Atom(_Formula):
    """An atom holds where there is a step and the atom is in that step's letter."""

    name: str


@dataclass(frozen=True, slots=True)
class Not(_Formula):
    """`not operand`: holds where `operand` does not, on the empty word as well."""

    operand: Formula


@dataclass(frozen=True, slots=True)
class And(_Formula):
    """`left and right`: both hold."""

    left: Formula
    right: Formula


@dataclass(frozen=True, slots=True)
class Or(_Formula):
    """`left or right`: at least one of them holds."""

    left: Formula
    right: Formula


@dataclass(frozen=True, slots=True)
class Next(_Formula):
    """Strong next: there is a next step, and `operand` holds from it on; false at the last step of a finite word."""

    operand: Formula


@dataclass(frozen=True, slots=True)
class Until(_Formula):
    """`left U right`: some step from here on satisfies `right`, and every step before it satisfies `left`.

    On a finite word that step must exist: at the last step, `left U right` is `right`; on the empty word it is false.
    """

    left: Formula
    right: Formula


Formula = Truth | Atom | Not | And | Or | Next | Until
"""A formula of core LTL; equal formulas are the same tree."""

TRUE = Truth()
FALSE = Not(TRUE)


def implies(left: Formula, right: Formula) -> Formula:
    """`left -> right`: `right` holds or `left` does not."""
    return Or(Not(left), right)


def weak_next(operand: Formula) -> Formula:
    """Weak next: if there is a next step, `operand` holds from it on; true at the last step of a finite word."""
    return Not(Next(Not(operand)))


def eventually(operand: Formula) -> Formula:
    """`F operand`: `operand` holds at some step from here on; false on the empty word."""
    return Until(TRUE, operand)


def globally(operand: Formula) -> Formula:
    """`G operand`: `operand` holds at every step from here on; true on the empty word."""
    return Not(eventually(Not(operand)))


def weak_until(left: Formula, right: Formula) -> Formula:
    """`left W right`: `left` holds at every step before the first that satisfies `right`, always if none does."""
    return Not(Until(Not(right), And(Not(left), Not(right))))


def release(left: Formula, right: Formula) -> Formula:
    """`left R right`: `right` holds up to and including the first step that satisfies `left`, always if none does."""
    return Not(Until(Not(left), Not(right)))


def strong_release(left: Formula, right: Formula) -> Formula:
    """`left M right`: some step satisfies `left`, and `right` holds up to and including the first such step."""
    return Until(right, And(left, right))


def conjunction(formulas: Iterable[Formula]) -> Formula:
    """All of `formulas`; `true` if there are none."""
    items = list(formulas)
    return reduce(And, items) if items else TRUE


def disjunction(formulas: Iterable[Formula]) -> Formula:
    """At least one of `formulas`; `false` if there are none."""
    items = list(formulas)
    return reduce(Or, items) if items else FALSE


def children(formula: Formula) -> tuple[Formula, ...]:
    """The immediate subformulas, from left to right."""
    match formula:
        case Not(operand) | Next(operand):
            return (operand,)
        case And(left, right) | Or(left, right) | Until(left, right):
            return (left, right)
        case _:
            return ()


def subformulas(formula: Formula) -> Iterator[Formula]:
    """`formula` and all that is inside it, outermost and leftmost first; a subtree that is shared comes once."""
    seen: set[int] = set()
    stack = [formula]
    while stack:
        current = stack.pop()
        if id(current) in seen:
            continue
        seen.add(id(current))
        yield current
        stack.extend(reversed(children(current)))


def parts_first(formula: Formula) -> Iterator[Formula]:
    """The same as `subformulas`, but whatever is inside a subformula comes before it."""
    seen: set[int] = set()
    stack = [(formula, False)]
    while stack:
        current, parts_done = stack.pop()
        if id(current) in seen:
            continue
        if parts_done:
            seen.add(id(current))
            yield current
            continue
        stack.append((current, True))
        stack.extend((child, False) for child in reversed(children(current)))


def atoms(formula: Formula) -> tuple[str, ...]:
    """The names of the atoms of `formula`, each once, in the order of first use."""
    return tuple(dict.fromkeys(f.name for f in subformulas(formula) if isinstance(f, Atom)))


def renamed(formula: Formula, names: Mapping[str, str]) -> Formula:
    """`formula` with every atom called as `names` has it."""
    if isinstance(formula, Atom):
        return Atom(names[formula.name])
    return type(formula)(*(renamed(child, names) for child in children(formula)))


def size(formula: Formula) -> int:
    """The number of nodes of the tree of core constructors; a subtree that is shared counts as often as it stands."""
    sizes: dict[int, int] = {}
    for part in parts_first(formula):
        sizes[id(part)] = 1 + sum(sizes[id(child)] for child in children(part))
    return sizes[id(formula)]


def is_propositional(formula: Formula) -> bool:
    """Whether `formula` is about the current step only: it contains neither `Next` nor `Until`."""
    return not any(isinstance(f, Next | Until) for f in subformulas(formula))


def is_next_free(formula: Formula) -> bool:
    """Whether `formula` contains no `Next`; every property of the language is next-free."""
    return not any(isinstance(f, Next) for f in subformulas(formula))


_IDENTIFIER = re.compile(r"[a-z_][a-z0-9_]*")
_RESERVED = frozenset({"true", "false", "xor"})

_BINARY, _OR, _AND, _UNARY = 0, 1, 2, 3
"""How tightly the operators of `to_text` bind; arguments of `U R W M ->` get parentheses unless they are unary."""


def to_text(formula: Formula) -> str:
    """`formula` in Spot's syntax, abbreviations recognised; strong next is `X[!]`, weak next `X`.

    Atoms that are not lower-case identifiers are put in double quotes, as Spot writes them.
    """
    return _text(formula, _BINARY)


def _text(formula: Formula, context: int) -> str:
    text, strength = _operator(formula)
    return f"({text})" if strength < context else text


def _operator(formula: Formula) -> tuple[str, int]:
    """The text of `formula` and how tightly its outermost operator binds."""
    match formula:
        case Truth():
            return "1", _UNARY
        case Not(Truth()):
            return "0", _UNARY
        case Atom(name):
            return _atom_text(name), _UNARY
        case Not(Until(Truth(), Not(operand))):
            return f"G{_argument(operand)}", _UNARY
        case Not(Until(Truth(), operand)):
            return f"G{_argument(Not(operand))}", _UNARY
        case Not(Next(Not(operand))):
            return f"X{_argument(operand)}", _UNARY
        case Not(Until(Not(right), And(Not(left), Not(again)))) if right == again:
            return f"{_text(left, _UNARY)} W {_text(right, _UNARY)}", _BINARY
        case Not(Until(Not(left), Not(right))):
            return f"{_text(left, _UNARY)} R {_text(right, _UNARY)}", _BINARY
        case Not(operand):
            return f"!{_text(operand, _UNARY)}", _UNARY
        case Next(operand):
            return f"X[!]{_argument(operand)}", _UNARY
        case Until(Truth(), operand):
            return f"F{_argument(operand)}", _UNARY
        case Until(right, And(left, again)) if right == again:
            return f"{_text(left, _UNARY)} M {_text(right, _UNARY)}", _BINARY
        case Until(left, right):
            return f"{_text(left, _UNARY)} U {_text(right, _UNARY)}", _BINARY
        case Or(Not(left), right):
            return f"{_text(left, _UNARY)} -> {_text(right, _UNARY)}", _BINARY
        case Or(left, right):
            return f"{_text(left, _OR)} | {_text(right, _OR)}", _OR
        case And(left, right):
            return f"{_text(left, _AND)} & {_text(right, _AND)}", _AND
        case _:
            assert_never(formula)


def _argument(operand: Formula) -> str:
    """What follows a unary operator that is a letter: a blank keeps `G a` from being read as one name."""
    text = _text(operand, _UNARY)
    return text if text.startswith("(") else f" {text}"


def _atom_text(name: str) -> str:
    if _IDENTIFIER.fullmatch(name) and name not in _RESERVED:
        return name
    escaped = name.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
