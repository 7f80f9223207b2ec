"""Where guards may rest, in terms of the machines that run: one more condition per state.

A region speaks of monitors and of clocks. Which of these a machine is at follows from its state (`Placed`, as the
comparison of the machine with its monitor finds them), so a region is a decision about states, about what has begun
and left, and about the conditions that are held. It is lowered once, for no particular target.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import field
from functools import cached_property
from itertools import product
from typing import NamedTuple

from ltlc.dataclass import dataclass
from ltlc.program.expressions import Apply, Expression, Literal
from ltlc.program.functions import Primitive
from ltlc.program.lowering import condition, joined, read
from ltlc.program.machine import Machine
from ltlc.program.normal import normal
from ltlc.program.properties import guards
from ltlc.program.types import BOOL
from ltlc.runtime.guard_plans import NO, YES, Asked, Asks
from ltlc.semantics.arenas import Arena, Joint, Outcome, Place, Region, Standing
from ltlc.semantics.diagrams import Diagram, Diagrams, of_predicate
from ltlc.semantics.monitor import Decision, Target
from ltlc.semantics.trackers import State
from ltlc.specification.atoms import Atom
from ltlc.specification.evaluation import Value
from ltlc.specification.expressions import Current, Input, inputs, operands


@dataclass(frozen=True, slots=True)
class Placed:
    """A machine, and where the monitor of its property and its clocks can be, by the state of the machine.

    It is nowhere once the verdict is permanent.
    """

    machine: Machine
    places: Mapping[int, Collection[Place]]

    def states(self, at: Standing) -> list[int]:
        """The states in which the machine can be where the property stands."""
        if isinstance(at, Outcome):
            verdicts = enumerate(each.verdict for each in self.machine.states)
            return [state for state, verdict in verdicts if verdict.value == at.value]
        # Whether a clock has just begun, the time tells.
        return [q for q, of in self.places.items() if (at.state, at.clocks.states) in _without_begun(of)]


class Held(NamedTuple):
    """A condition on values that is held: `known` if nothing that it compares is NaN, and whether it `holds`."""

    inputs: tuple[Input, ...]
    known: Expression
    holds: Expression

    @property
    def first(self) -> tuple[Value | None, ...]:
        """What each input is before there is a sample, if that is something."""
        constants = (i.signal.otherwise if isinstance(i, Current) else None for i in self.inputs)
        return tuple(None if each is None else each.value for each in constants)


@dataclass(frozen=True, slots=True)
class Resting:
    """Where guards may rest: `root` leads through `decisions` about `questions` to NO or YES.

    Questions about properties have the numbers of the arena's parts, those about conditions of `conditions`, whose
    atoms have these `names`.
    """

    names: tuple[str, ...] = field(compare=False)
    conditions: tuple[Held, ...]
    questions: tuple[Asked, ...]
    decisions: tuple[Decision, ...]
    root: Target


class NotToldError(Exception):
    """The states of machines do not tell whether guards may rest; the message says why."""


def resting(arena: Arena, region: Region, conditions: Mapping[str, Atom], parts: Sequence[Placed]) -> Resting:
    """The `region` of an arena with these `parts`, whose atoms of values are `conditions`. Raises NotToldError."""
    return _Lowered(arena, conditions, parts).resting(region)


def held(atom: Atom) -> Held:
    """The condition of an atom, which is not known where something in it is NaN."""
    wanted = tuple(dict.fromkeys(i for operand in operands(atom.condition) for i in inputs(operand)))
    numbers = guards(map(read, wanted), [atom])
    measured = tuple(Apply(Primitive.MEASURED, (n,)) for n in numbers if not n.type.scalar.is_integer)
    known = normal(joined(Primitive.AND, measured)) if measured else Literal(True, BOOL)
    return Held(wanted, known, normal(condition(atom.condition)))


class _Axis(NamedTuple):
    """Questions of which at most one is so, with the value that there is then; `otherwise`, if none is.

    Where one is, none of those that it `excludes` is so, which are asked later.
    """

    asked: tuple[tuple[Asked, object], ...]
    otherwise: object = None
    excludes: tuple[Asked, ...] = ()


Where = Mapping[tuple[object, ...], Diagram]
"""Predicates on what is held, by the values on those axes that are yet to be asked."""


class _Lowered:
    """Diagrams `before` are over the atoms of the arena, those of the result over questions."""

    def __init__(self, arena: Arena, conditions: Mapping[str, Atom], parts: Sequence[Placed]) -> None:
        self.arena, self.parts = arena, parts
        self.conditions = conditions
        self.levels = {name: level for level, name in enumerate(arena.read)}
        self.before, self.diagrams = Diagrams(), Diagrams()
        self.impossible = self.before.negation(of_predicate(arena.alphabet.as_formula(), self.before, self.levels))
        self.axes = [*_sent_axes(arena.most), *(_part_axis(k, part.machine) for k, part in enumerate(parts))]
        asked = [question for axis in self.axes for question, _ in axis.asked]
        numbers = {name: number for number, name in enumerate(conditions)}
        self.known = {name: (Asked(Asks.KNOWN, n), Asked(Asks.HOLDS, n)) for name, n in numbers.items()}
        self.questions = (*asked, *(each for both in self.known.values() for each in both))
        self._variables = {question: self.diagrams.variable(level) for level, question in enumerate(self.questions)}
        self._asking: dict[Diagram, Diagram] = {}

    def resting(self, region: Region) -> Resting:
        """A region as decisions."""
        where: dict[tuple[object, ...], Diagram] = {}
        for joint, formula in region.rests.items():
            letters = of_predicate(formula, self.before, self.levels)
            for key in self._keys(joint) if self.arena.outcome(joint) is None else ():
                if where.setdefault(key, letters) != letters:
                    raise NotToldError("the states of its machines do not tell where it may rest")
        return self._packed(self._along(where, self.axes))

    def _keys(self, joint: Joint) -> list[tuple[object, ...]]:
        """The values on all axes with which a joint place is reached."""
        counts = product(*(range(most + 1) for most in self.arena.most)) if joint.sent is None else [joint.sent]
        keys: list[tuple[object, ...]] = [(joint.sent is None, *sent) for sent in counts]
        for part, at in zip(self.parts, joint.standings, strict=True):
            ways: Sequence[object] = [at] if at is Outcome.WAITING else part.states(at)
            keys = [(*key, way) for key in keys for way in ways]
        return keys

    def _along(self, where: Where, axes: Sequence[_Axis]) -> Diagram:
        """Where a predicate holds, once all `axes` have been asked."""
        if not axes or not where:
            return self._held(where[()]) if where else self.diagrams.false
        by_value: dict[object, dict[tuple[object, ...], Diagram]] = {}
        for (value, *rest), letters in where.items():
            by_value.setdefault(value, {})[tuple(rest)] = letters
        axis, *further = axes
        found = self._along(by_value.get(axis.otherwise, {}), further)
        otherwise = self.diagrams.given({self.questions.index(each): False for each in axis.excludes}, found)
        for question, value in reversed(axis.asked):
            there = self._along(by_value.get(value, {}), further)
            if there != otherwise:
                found = self.diagrams.choose(self._variables[question], there, found)
        return found

    def _held(self, letters: Diagram) -> Diagram:
        """That a predicate holds, whatever the conditions are that are not known."""
        if letters not in self._asking:
            self._asking[letters] = self._knowing(self._related(letters), (), letters)
        return self._asking[letters]

    def _related(self, letters: Diagram) -> list[str]:
        """The atoms that a predicate is about, and those that constrain them."""
        asked = {self.before.split(n)[0] for n in self.before.reachable(letters) if not self.before.is_terminal(n)}
        about = {name for name, level in self.levels.items() if level in asked}
        for group in self.arena.alphabet.groups:
            about |= set(group.atoms) if about.intersection(group.atoms) else set()
        return [name for name in self.levels if name in about]

    def _knowing(self, names: Sequence[str], unknown: tuple[str, ...], letters: Diagram) -> Diagram:
        if not names:
            return self._translated(self._whatever(unknown, letters) if unknown else letters)
        name, *rest = names
        if name not in self.known or name in self.arena.loose:
            return self._knowing(rest, (*unknown, name), letters)
        known, _ = self.known[name]
        with_it, without = self._knowing(rest, unknown, letters), self._knowing(rest, (*unknown, name), letters)
        return self.diagrams.choose(self._variables[known], with_it, without)

    def _whatever(self, unknown: Iterable[str], letters: Diagram) -> Diagram:
        """Where all letters that exist are among `letters`, whatever these atoms are."""
        found = self.before.disjunction(self.impossible, letters)
        for name in unknown:
            sides = (self.before.given({self.levels[name]: answer}, found) for answer in (False, True))
            found = self.before.conjunction(*sides)
        return found

    def _translated(self, letters: Diagram) -> Diagram:
        """A predicate as questions."""
        if self.before.is_terminal(letters):
            return self.diagrams.terminal(self.before.value(letters))
        level, low, high = self.before.split(letters)
        _, holds = self.known[self.arena_names[level]]
        return self.diagrams.choose(self._variables[holds], self._translated(high), self._translated(low))

    @cached_property
    def arena_names(self) -> list[str]:
        """The atoms of the arena, by level."""
        return [*self.levels]

    def _packed(self, root: Diagram) -> Resting:
        """The only numbering: decisions as met from the root, questions and conditions in their order."""
        nodes = [node for node in self.diagrams.reachable(root) if not self.diagrams.is_terminal(node)]
        targets = {self.diagrams.false: NO, self.diagrams.true: YES} | {node: ~n for n, node in enumerate(nodes)}
        levels = sorted({self.diagrams.split(node)[0] for node in nodes})
        asked = [self.questions[level] for level in levels]
        numbers = sorted({each.of for each in asked if each.asks in (Asks.KNOWN, Asks.HOLDS)})
        conditions = {old: new for new, old in enumerate(numbers)}
        questions = tuple(
            each._replace(of=conditions[each.of]) if each.asks in (Asks.KNOWN, Asks.HOLDS) else each for each in asked
        )
        split = (self.diagrams.split(node) for node in nodes)
        decisions = (Decision(levels.index(level), targets[low], targets[high]) for level, low, high in split)
        names = tuple([*self.conditions][n] for n in numbers)
        asked_of = tuple(held(self.conditions[name]) for name in names)
        return Resting(names, asked_of, questions, tuple(decisions), targets[root])


def _sent_axes(most: Sequence[int]) -> Iterator[_Axis]:
    """Whether the guards are silent, and how many messages have left on each topic."""
    sent = [
        _Axis(tuple((Asked(Asks.SENT, out, n), n) for n in range(1, limit + 1)), 0) for out, limit in enumerate(most)
    ]
    yield _Axis(((Asked(Asks.SILENT), True),), False, tuple(question for axis in sent for question, _ in axis.asked))
    yield from sent


def _part_axis(k: int, machine: Machine) -> _Axis:
    """Whether a property has begun, and the state of its machine."""
    states = ((Asked(Asks.STANDS, k, state), state) for state in range(len(machine.states)))
    return _Axis(((Asked(Asks.WAITS, k), Outcome.WAITING), *states))


def _without_begun(places: Collection[Place]) -> set[tuple[int, tuple[State, ...]]]:
    return {(place.state, place.clocks.states) for place in places}
