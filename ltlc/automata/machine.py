"""Moore machines over symbolic letters: exploring, determinising, multiplying and minimising them, in pure Python.

A machine has for each state an output and a decision diagram whose terminals are the successor states. Nothing here
enumerates letters, and nothing here knows Spot.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any

from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.diagrams import Diagram, Diagrams
from ltlc.semantics.ltl import Formula
from ltlc.semantics.ltl import atoms as formula_atoms
from ltlc.semantics.monitor import Decision, Monitor, Target
from ltlc.semantics.verdicts import Verdict


class Letter(Enum):
    """Where a letter that does not exist leads: one value for all such letters keeps diagrams canonical."""

    IMPOSSIBLE = "impossible"


class TooManyStatesError(Exception):
    """An exploration found more states than it was allowed to."""


@dataclass(frozen=True, slots=True)
class Letters:
    """The letters that machines read: `atoms[k]` is level k of `diagrams`; `possible` is true for those that exist."""

    atoms: tuple[str, ...]
    diagrams: Diagrams
    possible: Diagram

    def restrict(self, diagram: Diagram) -> Diagram:
        """`diagram`, with the letters that do not exist leading to `IMPOSSIBLE`."""
        return self.diagrams.choose(self.possible, diagram, self.diagrams.terminal(Letter.IMPOSSIBLE))


@dataclass(frozen=True, slots=True)
class Machine:
    """A deterministic Moore machine; state 0 is initial, successors are states or `IMPOSSIBLE`."""

    letters: Letters
    outputs: list[Any]
    successors: list[Diagram]


@dataclass(frozen=True, slots=True)
class Automaton:
    """A nondeterministic automaton: a state's diagram gives the set (`frozenset`) of its successors."""

    initial: frozenset[int]
    successors: list[Diagram]


def read_by(formula: Formula, alphabet: Alphabet) -> Alphabet:
    """What of `alphabet` concerns `formula`: its atoms, in the order of `alphabet`.

    Raises ValueError if `formula` has an atom that is not in `alphabet`.
    """
    used = dict.fromkeys(formula_atoms(formula))
    unknown = [atom for atom in used if atom not in alphabet.atoms]
    if unknown:
        raise ValueError(f"not in the alphabet: {', '.join(unknown)}")
    return alphabet.restricted_to(atom for atom in alphabet.atoms if atom in used)


def letters_of(formula: Formula, alphabet: Alphabet) -> Letters:
    """The letters that `formula` reads, with fresh diagrams.

    Raises ValueError if `formula` has an atom that is not in `alphabet`, or if no letter exists at all.
    """
    restricted = read_by(formula, alphabet)
    diagrams = Diagrams()
    possible = diagrams.true
    for group in restricted.groups:
        possible = diagrams.conjunction(possible, _valuations(diagrams, restricted.atoms, group))
    if possible == diagrams.false:
        raise ValueError("the alphabet has no letter")
    return Letters(restricted.atoms, diagrams, possible)


def _valuations(diagrams: Diagrams, atoms: tuple[str, ...], group: Group) -> Diagram:
    """True where the atoms of `group` have one of its valuations."""
    levels = sorted(((atoms.index(atom), atom) for atom in group.atoms), reverse=True)
    result = diagrams.false
    for valuation in group.valuations:
        cube = diagrams.true
        for level, atom in levels:
            low, high = (diagrams.false, cube) if atom in valuation else (cube, diagrams.false)
            cube = diagrams.decision(level, low, high)
        result = diagrams.disjunction(result, cube)
    return result


def explore(
    letters: Letters,
    start: Hashable,
    step: Callable[[Any], Diagram],
    output: Callable[[Any], Hashable],
    most: int | None = None,
) -> Machine:
    """The machine of everything reachable from `start`, by `step`, a diagram whose values are keys of states.

    States are numbered breadth first, the successor by the smallest existing letter first (an atom's absence before
    its presence): the numbers depend on the machine only, not on the keys. Raises TooManyStatesError beyond `most`.
    """
    numbers = {start: 0}
    keys = [start]

    def number(key: Hashable) -> Hashable:
        if key is Letter.IMPOSSIBLE:
            return key
        if key not in numbers:
            if most is not None and len(keys) >= most:
                raise TooManyStatesError
            numbers[key] = len(keys)
            keys.append(key)
        return numbers[key]

    outputs, successors = [], []
    for key in keys:
        outputs.append(output(key))
        successors.append(letters.diagrams.combine(number, letters.restrict(step(key))))
    return Machine(letters, outputs, successors)


def determinise(
    letters: Letters,
    automaton: Automaton,
    output: Callable[[frozenset[int]], Hashable],
    most: int | None = None,
) -> Machine:
    """The subset construction: the state after a word is the set of the states that `automaton` can be in."""
    none_ = letters.diagrams.terminal(frozenset())

    def step(states: frozenset[int]) -> Diagram:
        return letters.diagrams.combine(_union, none_, *(automaton.successors[q] for q in sorted(states)))

    return explore(letters, automaton.initial, step, output, most)


def _union(*sets: frozenset[int]) -> frozenset[int]:
    return frozenset().union(*sets)


def successor_sets(diagrams: Diagrams, guards: Mapping[int, Diagram]) -> Diagram:
    """The diagram of the sets of states to which letters lead, given for each state the guard of the way there."""
    none_ = diagrams.terminal(frozenset())
    parts = [diagrams.choose(guard, diagrams.terminal(frozenset({q})), none_) for q, guard in guards.items()]
    while len(parts) > 1:  # halves of about the same size: adding one state at a time copies a large diagram each time
        parts = [diagrams.combine(_union, *parts[k : k + 2]) for k in range(0, len(parts), 2)]
    return parts[0] if parts else none_


def minimise(machine: Machine) -> Machine:
    """The smallest machine with the same outputs on every word, canonically numbered (Moore 1956).

    States start in one class per output; a class is split while its states' diagrams, with classes for states, differ.
    """
    classes = _number(machine.outputs)
    while True:
        quotient = _quotient(machine, classes)
        finer = _number(zip(classes, quotient, strict=True))
        if max(finer) == max(classes):
            break
        classes = finer
    member = {class_: state for state, class_ in reversed(list(enumerate(classes)))}
    return explore(
        machine.letters,
        classes[0],
        lambda class_: quotient[member[class_]],
        lambda class_: machine.outputs[member[class_]],
    )


def _quotient(machine: Machine, classes: list[int]) -> list[Diagram]:
    """The diagram of each state, with the classes of its successors for the successors."""

    def class_of(state: Any) -> Hashable:
        return state if state is Letter.IMPOSSIBLE else classes[state]

    return machine.letters.diagrams.relabel(class_of, machine.successors)


def _number(items: Iterable[Hashable]) -> list[int]:
    """The number of each item among the different ones, in the order of first occurrence."""
    numbers: dict[Hashable, int] = {}
    return [numbers.setdefault(item, len(numbers)) for item in items]


def verdict_machine(satisfiable: Machine, falsifiable: Machine, finite: Machine, empty: bool) -> Machine:
    """The four verdicts from three Boolean machines that read the same word side by side.

    `satisfiable` and `falsifiable` say whether some infinite continuation satisfies, or fails, the formula, `finite`
    whether the word itself satisfies it; for the empty word, that is `empty`.
    """
    letters = satisfiable.letters
    parts = (satisfiable, falsifiable, finite)

    def settle(*states: int) -> Hashable:
        """Permanent verdicts are one state each; `None` marks the start."""
        if not satisfiable.outputs[states[0]]:
            return Verdict.VIOLATED
        if not falsifiable.outputs[states[1]]:
            return Verdict.SATISFIED
        return states

    def next_(*states: Any) -> Hashable:
        return Letter.IMPOSSIBLE if Letter.IMPOSSIBLE in states else settle(*states)

    def step(key: Any) -> Diagram:
        if isinstance(key, Verdict):
            return letters.diagrams.terminal(key)
        states = (0, 0, 0) if key is None else key
        rows = (part.successors[state] for part, state in zip(parts, states, strict=True))
        return letters.diagrams.combine(next_, *rows)

    def output(key: Any) -> Verdict:
        if isinstance(key, Verdict):
            return key
        holds = empty if key is None else finite.outputs[key[2]]
        return Verdict.PRESUMABLY_SATISFIED if holds else Verdict.PRESUMABLY_VIOLATED

    settled = settle(0, 0, 0)
    return explore(letters, settled if isinstance(settled, Verdict) else None, step, output)


def to_monitor(machine: Machine) -> Monitor:
    """The canonical minimal `Monitor` of a machine whose outputs are verdicts."""
    minimal = minimise(machine)
    diagrams = minimal.letters.diagrams
    rows = [_drop_idle_questions(diagrams, row) for row in minimal.successors]
    decisions = [node for node in diagrams.reachable(*rows) if not diagrams.is_terminal(node)]
    numbers = {node: number for number, node in enumerate(decisions)}

    def target(node: Diagram) -> Target:
        return diagrams.value(node) if diagrams.is_terminal(node) else ~numbers[node]

    def decision(node: Diagram) -> Decision:
        level, low, high = diagrams.split(node)
        return Decision(level, target(low), target(high))

    return Monitor(
        minimal.letters.atoms,
        tuple(minimal.outputs),
        tuple(target(row) for row in rows),
        tuple(decision(node) for node in decisions),
    )


def _drop_idle_questions(diagrams: Diagrams, root: Diagram) -> Diagram:
    """`root` without the questions that make no difference to any existing letter.

    Where `d < 1` does not hold, `d > 1` decides; where it does, `d > 1` does not hold anyway, so asking `d > 1` is
    enough. Both sides of such a question agree wherever both are possible (Coudert and Madre 1990, `restrict`).
    """
    conflict = object()

    def meet(low: Hashable, high: Hashable) -> Hashable:
        if low is Letter.IMPOSSIBLE:
            return high
        return low if high in (Letter.IMPOSSIBLE, low) else conflict

    known: dict[Diagram, Diagram] = {}

    def visit(node: Diagram) -> Diagram:
        if diagrams.is_terminal(node):
            return node
        if node not in known:
            level, low, high = diagrams.split(node)
            both = diagrams.combine(meet, low, high)
            agree = conflict not in diagrams.values(both)
            known[node] = visit(both) if agree else diagrams.decision(level, visit(low), visit(high))
        return known[node]

    return visit(root)
