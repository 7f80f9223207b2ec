"""Whether a property means what the formula says from which it was written: decided by automata.

Both are read at positions. A bound is unrolled where that is small; else it stands for itself, the same on both sides:
then only equality can be shown. What the past has at a position is an atom with its definition.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from typing import assert_never

from ltlc.analysis.comparison.reference import shown
from ltlc.analysis.comparison.relate import distinguishing_lasso
from ltlc.automata.languages import Language, Languages
from ltlc.dataclass import dataclass
from ltlc.importing import formulas as f
from ltlc.importing.conditions import Abstraction, NotComparedError, States
from ltlc.importing.core import Core
from ltlc.semantics import ltl, properties, timed_atoms
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.encodings import EPISODE, encode
from ltlc.semantics.words import Lasso, Word
from ltlc.specification.expressions import Boolean, Current, IsTrue, Past, When
from ltlc.specification.specification import PropertySpecification


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
    try:
        pair = _Pair(formula, written, Core(Abstraction(states, possible), unrolls=True))
        return pair.on_finite_runs() if pair.is_equal else pair.on_infinite_runs()
    except NotComparedError as error:
        hidden = _Pair(formula, written, Core(Abstraction(states, possible), unrolls=False))
        if not hidden.is_equal:
            raise
        shown_so = hidden.on_finite_runs()
        return Shown(only_infinite=str(error)) if shown_so.finite else shown_so


class _Pair:
    """A formula and the property that is written for it, in core LTL, and the letters that their runs have.

    Each of their parts that must hold is an automaton of its own, and so is each definition: of all together, it would
    be large. What shares no atom with a part, directly or through others, is first left out.
    """

    def __init__(self, formula: f.Formula, written: f.Formula, core: Core) -> None:
        self._theirs, self._ours = list(_parts(core.of(formula))), list(_parts(core.of(written)))
        self._known, self._states = core.definitions, core.states
        read = ltl.atoms(ltl.conjunction((*self._theirs, *self._ours, *self._known)))
        letters = core.states.alphabet()
        self._alphabet = Alphabet(tuple(dict.fromkeys((*letters.atoms, *read))), letters.groups)
        self._space = Languages(self._alphabet)
        self._translated: dict[tuple[ltl.Formula, bool], Language] = {}

    @cached_property
    def is_equal(self) -> bool:
        """Whether no infinite run tells them apart."""
        ways = ((self._theirs, self._ours), (self._ours, self._theirs))
        return all(self._implied(given, then) for given, parts in ways for then in parts)

    def _implied(self, given: list[ltl.Formula], then: ltl.Formula) -> bool:
        return any(
            self._space.implies([self._words(each, False) for each in some], self._words(then, False))
            for some in self._premises(given, then)
        )

    def _premises(self, given: list[ltl.Formula], then: ltl.Formula) -> Iterator[list[ltl.Formula]]:
        """Some of `given` and of what is known, which concern `then`; and all of it, if that is more."""
        found, others, read = [], [*given, *self._known], set(ltl.atoms(then))
        while near := [each for each in others if not read.isdisjoint(ltl.atoms(each))]:
            found += near
            read.update(*map(ltl.atoms, near))
            others = [each for each in others if each not in near]
        yield found
        if others:
            yield [*given, *self._known]

    def _words(self, formula: ltl.Formula, finite: bool) -> Language:
        """What is known of the past has no end: it is the same at each position of a run that ends."""
        key = formula, finite and formula not in self._known
        if key not in self._translated:
            self._translated[key] = self._space.of(*key)
        return self._translated[key]

    def on_infinite_runs(self) -> Shown:
        """Shortest infinite runs that tell them apart."""
        theirs, ours = map(ltl.conjunction, (self._theirs, self._ours))
        known = ltl.conjunction(self._known)
        pairs = ((theirs, ltl.Not(ours)), (ours, ltl.Not(theirs)))
        found = (distinguishing_lasso(ltl.conjunction((known, *pair)), self._alphabet)[0] for pair in pairs)
        one, other = (shown(self._told(run)) if run else "" for run in found)
        return Shown(one, other)

    def on_finite_runs(self) -> Shown:
        """Shortest finite runs that tell them apart, if any do."""
        found = self._shortest(self._theirs, self._ours), self._shortest(self._ours, self._theirs)
        one, other = (shown(self._told(word)) if word else "" for word in found)
        return Shown(one, other, finite=bool(one or other))

    def _shortest(self, given: list[ltl.Formula], parts: list[ltl.Formula]) -> Word | None:
        """A shortest finite run of which all of `given` hold, and one of `parts` does not; None if there is none."""
        words: list[Word] = []
        for part in parts:
            for some in self._premises(given, part):
                opposite = self._words(ltl.Not(part), True)
                word = self._space.shortest_word([opposite, *(self._words(each, True) for each in some)])
                if word is None:
                    break
            else:
                words += [word] if word else []
        return min(words, key=len, default=None)

    def _told(self, run: Word | Lasso) -> Word | Lasso:
        """`run` with the atoms of the property."""
        if isinstance(run, Lasso):
            return Lasso(*(tuple(map(self._states.letter, part)) for part in (run.stem, run.loop)))
        return tuple(map(self._states.letter, run))


def _parts(formula: ltl.Formula) -> Iterator[ltl.Formula]:
    """Formulas that all hold if `formula` does."""
    match formula:
        case ltl.And(left, right):
            yield from _parts(left)
            yield from _parts(right)
        case ltl.Not(ltl.Or(left, right)):
            yield from _parts(ltl.Not(left))
            yield from _parts(ltl.Not(right))
        case ltl.Not(ltl.Not(operand)):
            yield from _parts(operand)
        case ltl.Not(ltl.Until(ltl.Truth(), operand)):
            yield from map(ltl.globally, _parts(ltl.Not(operand)))
        case _:
            yield formula
