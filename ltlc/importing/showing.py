"""Whether a property means what the formula says from which it was written: decided by automata.

Both are read at positions. A bound is unrolled where that is small; else it stands for itself, the same on both sides:
then only equality can be shown. What the past has at a position is an atom with its definition.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
from functools import cached_property
from typing import assert_never

from ltlc.analysis.comparison.reference import shown
from ltlc.analysis.comparison.relate import distinguishing_lasso
from ltlc.automata.languages import Languages
from ltlc.dataclass import dataclass
from ltlc.importing import formulas as f
from ltlc.semantics import ltl, properties, timed_atoms
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.encodings import EPISODE, encode
from ltlc.semantics.words import Lasso, Word
from ltlc.specification.expressions import Boolean, Current, IsTrue, Past, When
from ltlc.specification.specification import PropertySpecification

MOST_STEPS = 12
"""So many positions are unrolled in all."""

States = Mapping[str, ltl.Formula]
"""What conditions are, by their texts: formulas over the atoms of properties."""


class NotComparedError(Exception):
    """A property, or a formula, is not of a form that is compared; the message says why."""


def of_property(property_: PropertySpecification, step: Nanoseconds) -> f.Formula:
    """What a property means, read at positions that are `step` apart. Raises NotComparedError."""
    return _Reader(property_, step).property(property_.property)


@dataclass(frozen=True)
class _Reader:
    """Reads the parts of a property; those that `is_first` says are judged at the first position only."""

    specification: PropertySpecification
    step: Nanoseconds
    is_first: bool = True

    def property(self, of: properties.Property) -> f.Formula:
        if not _is_bounded(of) and not isinstance(of, properties.After):
            return self.formula(encode(of, EPISODE))
        match of:
            case properties.Now(predicate):
                return self.formula(predicate)
            case properties.Throughout(predicate):
                return f.always(self.formula(predicate))
            case properties.Not(operand):
                return f.negated(self.property(operand))
            case properties.And(left, right):
                return f.And(self.property(left), self.property(right))
            case properties.Or(left, right):
                return f.Or(self.property(left), self.property(right))
            case properties.Implies(left, right):
                return f.implies(self.property(left), self.property(right))
            case properties.Always(operand):
                return f.always(self._later(operand))
            case properties.Never(operand):
                return f.Not(f.eventually(self._later(operand)))
            case properties.Eventually(operand):
                return f.eventually(self._later(operand))
            case properties.After(event, body):
                opened = self.formula(event)
                if self.is_first and isinstance(opened, f.Previous) and opened.operand == f.TRUE:
                    return f.Next(self._later(body), opened.steps)
                return f.weak_until(f.negated(opened), f.And(opened, self._later(body)))
            case properties.Within(duration, body, start):
                return self._within(body, self._steps(start), self._steps(duration))
            case properties.Until(event, properties.Always(properties.Now(kept)) | properties.Throughout(kept)):
                return f.Until(self.formula(kept), self.formula(event))
            case properties.Until() | properties.AfterUntil():
                raise NotComparedError("a bound inside a scope is not compared")
            case _:
                assert_never(of)

    def _later(self, of: properties.Property) -> f.Formula:
        return replace(self, is_first=False).property(of)

    def _within(self, body: properties.Property, start: int, stop: int) -> f.Formula:
        match body:
            case properties.Eventually(properties.Now(predicate)):
                return f.eventually(self.formula(predicate), start, stop)
            case properties.Always(properties.Now(predicate)):
                return f.always(self.formula(predicate), start, stop)
            case properties.Never(properties.Now(predicate)):
                return f.always(f.negated(self.formula(predicate)), start, stop)
            case _:
                raise NotComparedError("a bound around more than a condition is not compared")

    def _steps(self, duration: Nanoseconds) -> int:
        steps, rest = divmod(duration, self.step)
        if rest:
            raise NotComparedError("a bound is no whole number of steps")
        return steps

    def formula(self, of: ltl.Formula) -> f.Formula:
        """A formula of core LTL, its timed atoms written out."""
        match of:
            case ltl.Truth():
                return f.TRUE
            case ltl.Not(operand):
                return f.negated(self.formula(operand))
            case ltl.And(left, right):
                return f.conjoined(self.formula(left), self.formula(right))
            case ltl.Or(left, right):
                return f.disjoined(self.formula(left), self.formula(right))
            case ltl.Next():
                raise NotComparedError("a property about the next step is not compared")
            case ltl.Until(left, right):
                return f.Until(self.formula(left), self.formula(right))
            case timed_atoms.Previously(_, operand):
                return f.Previous(self.formula(operand))
            case timed_atoms.Once(_, operand, within):
                return f.Since(f.TRUE, self.formula(operand), 0, None if within is None else self._steps(within))
            case timed_atoms.Historically(_, operand, None):
                return f.Not(f.Since(f.TRUE, f.negated(self.formula(operand))))
            case timed_atoms.Since(_, kept, start, within):
                stop = None if within is None else self._steps(within)
                return f.Since(self.formula(kept), self.formula(start), 0, stop)
            case timed_atoms.News(name):
                return f.Atom(name)
            case ltl.Atom(name) if not isinstance(of, timed_atoms.TimedAtom):
                return self._atom(name)
            case _:
                raise NotComparedError(f"`{of}` is not compared")

    def _atom(self, name: str) -> f.Formula:
        """An atom; whether a condition held so many steps ago is written out."""
        (atom,) = (atom for atom in self.specification.atoms if atom.name == name)
        match atom.condition:
            case IsTrue(Current(signal)) if isinstance(signal.definition, Past):
                past, otherwise = signal.definition, signal.otherwise
                if not isinstance(otherwise, Boolean):
                    raise NotComparedError("what waits for earlier samples is not compared")
                definition = past.signal.definition
                inner: f.Formula = f.Atom(past.signal.name)
                if isinstance(definition, When):
                    inner = self._plain(definition.predicate)
                    inner = f.TRUE if isinstance(inner, f.Or) and inner.right == f.negated(inner.left) else inner
                if not otherwise.value:
                    return f.Previous(inner, past.samples)
                return f.Not(f.Previous(f.negated(inner), past.samples))
            case _:
                return f.Atom(name)

    def _plain(self, of: ltl.Formula) -> f.Formula:
        """A condition of one step, whose atoms need not be atoms of the property."""
        match of:
            case ltl.Atom(name):
                return f.Atom(name)
            case ltl.Truth():
                return f.TRUE
            case ltl.Not(operand):
                return f.negated(self._plain(operand))
            case ltl.And(left, right):
                return f.conjoined(self._plain(left), self._plain(right))
            case ltl.Or(left, right):
                return f.disjoined(self._plain(left), self._plain(right))
            case _:
                raise NotComparedError(f"`{of}` is not compared")


def _is_bounded(of: properties.Property) -> bool:
    return isinstance(of, properties.Within) or any(map(_is_bounded, properties.children(of)))


@dataclass(frozen=True)
class Core:
    """Makes core LTL of formulas; `definitions` are of the atoms for the past. With `unrolls`, bounds are unrolled."""

    states: States
    unrolls: bool
    definitions: list[ltl.Formula] = field(default_factory=list)
    _known: dict[tuple[str, ltl.Formula, ltl.Formula], ltl.Formula] = field(default_factory=dict)
    _opaque: dict[tuple[str, ltl.Formula, ltl.Formula, int, int | None], ltl.Formula] = field(default_factory=dict)

    def of(self, formula: f.Formula) -> ltl.Formula:
        """`formula` in core LTL. Raises NotComparedError."""
        match formula:
            case f.Atom(text):
                return self.states.get(text, ltl.Atom(text))
            case f.Truth():
                return ltl.TRUE
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
            case f.Previous(f.And(left, right), steps):
                return ltl.And(self.of(f.Previous(left, steps)), self.of(f.Previous(right, steps)))
            case f.Previous(f.Or(left, right), steps):
                return ltl.Or(self.of(f.Previous(left, steps)), self.of(f.Previous(right, steps)))
            case f.Previous(f.Not(operand), steps) if operand != f.TRUE:
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

    @property
    def hides(self) -> bool:
        """Whether bounds stand for themselves."""
        return bool(self._opaque)

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


@dataclass(frozen=True)
class Shown:
    """How a property relates to a formula: what tells them apart, a run that only one of them accepts.

    `finite` is about finite runs, where infinite ones tell nothing apart. Without either, they are equal, on finite
    runs as well unless `only_infinite` says why these are not compared.
    """

    formula_only: str = ""
    property_only: str = ""
    finite: bool = False
    only_infinite: str = ""

    @property
    def is_equal(self) -> bool:
        """Whether no infinite run tells them apart."""
        return self.finite or not (self.formula_only or self.property_only)


def compare(formula: f.Formula, written: f.Formula, states: States, possible: Alphabet) -> Shown:
    """How `formula` relates to the property that is `written` for it. Raises NotComparedError.

    Steps have letters of `possible`. To be called in a child process: it may take any time.
    """
    hidden = _Pair(formula, written, Core(states, unrolls=False), possible)
    try:
        whole = _Pair(formula, written, Core(states, unrolls=True), possible) if hidden.core.hides else hidden
    except NotComparedError as error:
        if not hidden.is_equal:
            raise
        shown_so = hidden.on_finite_runs()
        return Shown(only_infinite=str(error)) if shown_so.finite else shown_so
    return whole.on_finite_runs() if hidden.is_equal or whole.is_equal else whole.on_infinite_runs()


class _Pair:
    """A formula and the property that is written for it, in core LTL, and the letters that their runs have.

    Each formula is an automaton of its own, and so is each definition: of all together, it would be large.
    """

    def __init__(self, formula: f.Formula, written: f.Formula, core: Core, possible: Alphabet) -> None:
        self.core = core
        self._formulas = core.of(formula), core.of(written)
        read = ltl.atoms(ltl.conjunction((*self._formulas, *core.definitions)))
        self._alphabet = Alphabet(read, tuple(group for group in possible.groups if set(group.atoms) <= set(read)))
        states = (*core.states.values(), *map(ltl.Atom, possible.atoms))
        self._plain = frozenset(name for state in states for name in ltl.atoms(state))

    @cached_property
    def is_equal(self) -> bool:
        """Whether no infinite run tells them apart."""
        space = Languages(self._alphabet)
        theirs, ours = map(space.of, self._formulas)
        known = [space.of(each) for each in self.core.definitions]
        return space.implies([theirs, *known], ours) and space.implies([ours, *known], theirs)

    def on_infinite_runs(self) -> Shown:
        """Shortest infinite runs that tell them apart."""
        theirs, ours = self._formulas
        known = ltl.conjunction(self.core.definitions)
        pairs = ((theirs, ltl.Not(ours)), (ours, ltl.Not(theirs)))
        found = (distinguishing_lasso(ltl.conjunction((known, *pair)), self._alphabet)[0] for pair in pairs)
        return Shown(*(shown(self._told(run)) if run else "" for run in found))

    def on_finite_runs(self) -> Shown:
        """Shortest finite runs that tell them apart, if any do."""
        space = Languages(self._alphabet, finite=True)
        theirs, ours = self._formulas
        known = [space.of(each) for each in self.core.definitions]
        pairs = ((theirs, ltl.Not(ours)), (ours, ltl.Not(theirs)))
        found = (space.shortest_word([*map(space.of, pair), *known]) for pair in pairs)
        told = [shown(self._told(word)) if word else "" for word in found]
        return Shown(*told, finite=any(told))

    def _told(self, run: Word | Lasso) -> Word | Lasso:
        """`run` with the atoms of the property only."""
        if isinstance(run, Lasso):
            return Lasso(*(tuple(letter & self._plain for letter in part) for part in (run.stem, run.loop)))
        return tuple(letter & self._plain for letter in run)
