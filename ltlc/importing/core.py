"""Formulas with bounds and a past in core LTL, as automata read it: two of them, side by side."""

from __future__ import annotations

from dataclasses import field, replace
from typing import assert_never

from ltlc.dataclass import dataclass
from ltlc.importing import formulas as f
from ltlc.importing.conditions import Abstraction, NotComparedError
from ltlc.semantics import ltl

MOST_STEPS = 12
"""So many positions are unrolled in all."""


@dataclass(frozen=True)
class Core:
    """Makes core LTL of formulas; `definitions` are of the atoms for the past. With `unrolls`, bounds are unrolled."""

    states: Abstraction
    unrolls: bool
    definitions: list[ltl.Formula] = field(default_factory=list)
    _known: dict[tuple[str, ltl.Formula, ltl.Formula], ltl.Formula] = field(default_factory=dict)
    _opaque: dict[tuple[str, ltl.Formula, ltl.Formula, int, int | None], ltl.Formula] = field(default_factory=dict)

    def of(self, formula: f.Formula) -> ltl.Formula:
        """`formula` in core LTL. Raises NotComparedError."""
        if f.is_boolean(formula):
            return self.states.of(formula)
        match formula:
            case f.Atom() | f.Truth():
                return self.states.of(formula)
            case f.Not(operand):
                return ltl.Not(self.of(operand))
            case f.And(left, right):
                return ltl.And(self.of(left), self.of(right))
            case f.Or(left, right):
                return ltl.Or(self.of(left), self.of(right))
            case f.Next(operand, steps):
                found = self.of(operand)
                if steps > MOST_STEPS and not self.unrolls:
                    return self._hidden("X", ltl.TRUE, found, steps, steps)
                self._check(steps)
                for _ in range(steps):
                    found = ltl.weak_next(found)
                return found
            case f.Previous(operand, steps) if f.is_boolean(operand):
                return self._previous(self.of(operand), steps)
            case f.Previous(f.And(left, right), steps):
                return ltl.And(self.of(f.Previous(left, steps)), self.of(f.Previous(right, steps)))
            case f.Previous(f.Or(left, right), steps):
                return ltl.Or(self.of(f.Previous(left, steps)), self.of(f.Previous(right, steps)))
            case f.Previous(f.Not(operand), steps):
                began, held = self.of(f.Previous(f.TRUE, steps)), self.of(f.Previous(operand, steps))
                return ltl.And(began, ltl.Not(held))
            case f.Previous(f.Previous(operand, more), steps):
                return self.of(f.Previous(operand, steps + more))
            case f.Previous(operand, steps):
                return self._previous(self.of(operand), steps)
            case f.Until(left, right, start, stop):
                return self._until(left, right, start, stop)
            case f.Since(left, right, start, stop):
                sooner = _sooner(formula) if _has_previous(right) else None
                return self._since(left, right, start, stop) if sooner is None else self.of(f.Previous(sooner))
            case _:
                assert_never(formula)

    def _check(self, steps: int) -> None:
        if steps > MOST_STEPS:
            raise NotComparedError("the bounds are too long to be unrolled")

    def _until(self, left: f.Formula, right: f.Formula, start: int, stop: int | None) -> ltl.Formula:
        p, q = self.of(left), self.of(right)
        if stop is None and not start:
            return ltl.Until(p, q)
        if not self.unrolls:
            if not start and left != f.TRUE:
                return ltl.And(ltl.Until(p, q), self._hidden("F", ltl.TRUE, q, start, stop))
            return self._hidden("F", p, q, start, stop)
        self._check(stop or start)
        found = q if stop is not None else ltl.Until(p, q)
        for _ in range((stop or start) - start):
            found = ltl.Or(q, ltl.And(p, ltl.Next(found)))
        for _ in range(start):
            found = ltl.And(p, ltl.Next(found))
        return found

    def _since(self, left: f.Formula, right: f.Formula, start: int, stop: int | None) -> ltl.Formula:
        p, q = self.of(left), self.of(right)
        if stop is not None and not self.unrolls:
            return self._hidden("O", p, q, start, stop)
        self._check(stop or start)
        found = q if stop is not None else self._defined("since", p, q)
        for _ in range((stop or start) - start):
            found = ltl.Or(q, ltl.And(p, self._previous(found, 1)))
        for _ in range(start):
            found = ltl.And(p, self._previous(found, 1))
        return found

    def _hidden(self, word: str, p: ltl.Formula, q: ltl.Formula, start: int, stop: int | None) -> ltl.Formula:
        """An atom for what is the same wherever it is written the same; it is known that `eventually` follows."""
        key = (word, p, q, start, stop)
        if key not in self._opaque:
            atom = ltl.Atom(f"bounded {len(self._opaque)}")
            later = ltl.Until(p, q) if word == "F" else ltl.TRUE
            self.definitions.append(ltl.globally(ltl.implies(atom, later)))
            if not start:
                self.definitions.append(ltl.globally(ltl.implies(q, atom)))
            for (other, left, right, *bounds), same in self._opaque.items():
                if (other, *bounds) == (word, start, stop):
                    alike = ltl.globally(ltl.And(_same(left, p), _same(right, q)))
                    self.definitions.append(ltl.implies(alike, ltl.globally(_same(same, atom))))
            self._opaque[key] = atom
        return self._opaque[key]

    def _previous(self, operand: ltl.Formula, steps: int) -> ltl.Formula:
        if steps > MOST_STEPS:
            if self.unrolls:
                self._check(steps)
            return self._hidden("Y", ltl.TRUE, operand, steps, steps)
        for _ in range(steps):
            operand = self._defined("previous", ltl.TRUE, operand)
        return operand

    def _defined(self, word: str, p: ltl.Formula, q: ltl.Formula) -> ltl.Formula:
        """The atom that is true where `p since q` is, or where `q` was at the position before; defined once."""
        key = (word, p, q)
        if key not in self._known:
            atom = self._known[key] = ltl.Atom(f"{word} {len(self._known)}")
            first: ltl.Formula = ltl.Not(atom)
            after = q
            if word == "since":
                first, after = _same(atom, q), ltl.Or(ltl.Next(q), ltl.And(ltl.Next(p), atom))
            is_last = ltl.Not(ltl.Next(ltl.TRUE))
            self.definitions.extend((first, ltl.globally(ltl.Or(is_last, _same(ltl.Next(atom), after)))))
        return self._known[key]


def _sooner(formula: f.Formula) -> f.Formula | None:
    """What holds at a position if `formula` does at the next one; None if that depends on the next one itself."""
    match formula:
        case f.Truth():
            return formula
        case f.Previous(operand, steps):
            return operand if steps == 1 else f.Previous(operand, steps - 1)
        case f.Not(operand):
            inner = _sooner(operand)
            return None if inner is None else f.Not(inner)
        case f.And(left, right) | f.Or(left, right) | f.Since(left, right, _, _):
            p, q = _sooner(left), _sooner(right)
            return None if p is None or q is None else replace(formula, left=p, right=q)
        case f.Atom() | f.Next() | f.Until():
            return None
        case _:
            assert_never(formula)


def _has_previous(formula: f.Formula) -> bool:
    """Whether `formula` is false at the first position, as can be seen."""
    match formula:
        case f.Previous():
            return True
        case f.And(left, right):
            return _has_previous(left) or _has_previous(right)
        case f.Or(left, right):
            return _has_previous(left) and _has_previous(right)
        case f.Since(_, right, _, _):
            return _has_previous(right)
        case _:
            return False


def _same(left: ltl.Formula, right: ltl.Formula) -> ltl.Formula:
    return ltl.And(ltl.implies(left, right), ltl.implies(right, left))
