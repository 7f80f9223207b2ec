"""Moore machines over symbolic letters: exploring, determinising, multiplying and minimising them, in pure Python.

A machine has for each state an output and a decision diagram whose terminals are the successor states. Nothing here
enumerates letters, and nothing here knows Spot.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from enum import Enum
from itertools import pairwise
from typing import Any, NamedTuple

from ltlc.dataclass import dataclass
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.diagrams import Diagram, Diagrams, of_predicate
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Decision, Monitor, Target
from ltlc.semantics.ordered_machine import OrderedMachine
from ltlc.semantics.reset_machine import Letters as Guard
from ltlc.semantics.reset_machine import Narrowed, ResetMachine
from ltlc.semantics.timed_atoms import TimedAtom, atoms_within
from ltlc.semantics.verdicts import Verdict


class Letter(Enum):
    """Where a letter that does not exist leads: one value for all such letters keeps diagrams canonical."""

    IMPOSSIBLE = "impossible"


class Leap(NamedTuple):
    """A successor of a machine that also acts: the state, and what is done on the way there."""

    state: Any
    actions: Hashable


def _moved(target: Any, to: Callable[[Any], Hashable]) -> Hashable:
    """`target` with its state replaced by what `to` gives for it."""
    if target is Letter.IMPOSSIBLE:
        return target
    return Leap(to(target.state), target.actions) if target.__class__ is Leap else to(target)


class TooManyStatesError(Exception):
    """An exploration found more states than it was allowed to."""


class Move(NamedTuple):
    """A step of the reset machine: the number of its next state, and the fairness sets in which the step is."""

    target: int
    fair: frozenset[int]


@dataclass(frozen=True, slots=True)
class RunsInTime:
    """The reset machine with its states numbered, 0 the initial one.

    `moves[k]` is a diagram whose values are the `Move` by a letter from state k, or None; `sets` is as there.
    """

    moves: tuple[Diagram, ...]
    sets: int


@dataclass(frozen=True, slots=True)
class Letters:
    """The letters that machines read: `atoms[k]` is level k of `diagrams`; `possible` is true for those that exist.

    `time` says which words of them are runs in time; for a formula without timed atoms, all are.
    """

    atoms: tuple[str, ...]
    diagrams: Diagrams
    possible: Diagram
    time: RunsInTime

    def lasting(self, clocks: int) -> Diagram:
        """The letters that exist and can be repeated forever from the state `clocks` of `time`."""

        def stays(move: Any) -> bool:
            return move is not None and move.target == clocks and len(move.fair) == self.time.sets

        return self.diagrams.conjunction(self.possible, self.diagrams.combine(stays, self.time.moves[clocks]))

    def restrict(self, diagram: Diagram) -> Diagram:
        """`diagram`, with the letters that do not exist leading to `IMPOSSIBLE`."""
        return self.diagrams.choose(self.possible, diagram, self.diagrams.terminal(Letter.IMPOSSIBLE))


@dataclass(frozen=True, slots=True)
class Machine:
    """A deterministic Moore machine; state 0 is initial, successors are states, `Leap`s to them, or `IMPOSSIBLE`."""

    letters: Letters
    outputs: list[Any]
    successors: list[Diagram]


@dataclass(frozen=True, slots=True)
class Automaton:
    """A nondeterministic automaton: a state's diagram gives the set (`frozenset`) of its successors."""

    initial: frozenset[int]
    successors: list[Diagram]


def read_by(formula: Formula, alphabet: Alphabet) -> Alphabet:
    """What of `alphabet` concerns `formula`: the atoms that decide it, in the order of `alphabet`, timed ones last.

    Raises ValueError if `formula` has an atom that is not in `alphabet`, and is not timed.
    """
    used = {atom.name: atom for atom in atoms_within(formula)}
    timed = [name for name, atom in used.items() if isinstance(atom, TimedAtom) and name not in alphabet.atoms]
    unknown = [atom for atom in used if atom not in alphabet.atoms and atom not in timed]
    if unknown:
        raise ValueError(f"not in the alphabet: {', '.join(unknown)}")
    return alphabet.restricted_to([*(atom for atom in alphabet.atoms if atom in used), *timed])


def letters_of(formula: Formula, alphabet: Alphabet) -> Letters:
    """The letters that `formula` reads, with fresh diagrams.

    Raises ValueError if `formula` has an atom that is not in `alphabet`, or if no letter exists at all.
    """
    restricted = read_by(formula, alphabet)
    diagrams = Diagrams()
    possible = diagrams.true
    for group in restricted.groups:
        possible = diagrams.conjunction(possible, valuations(diagrams, restricted.atoms, group))
    if possible == diagrams.false:
        raise ValueError("the alphabet has no letter")
    return Letters(restricted.atoms, diagrams, possible, runs_in_time(formula, restricted.atoms, diagrams))


def runs_in_time(formula: Formula, atoms: tuple[str, ...], diagrams: Diagrams) -> RunsInTime:
    """The reset machine of `formula` over letters of `diagrams`, of whose levels `atoms` are the names."""
    machine, levels = ResetMachine(formula), {atom: level for level, atom in enumerate(atoms)}

    def narrowed(letters: Diagram, predicate: Formula) -> Diagram | None:
        found = diagrams.conjunction(letters, of_predicate(predicate, diagrams, levels))
        return None if found == diagrams.false else found

    none = diagrams.terminal(None)
    rows = [none]
    for state, move, letters in edges_in_time(machine, diagrams.true, narrowed):
        rows += [none] * (move.target + 1 - len(rows))
        rows[state] = diagrams.choose(letters, diagrams.terminal(move), rows[state])
    return RunsInTime(tuple(rows), machine.sets)


def edges_in_time(
    machine: ResetMachine | OrderedMachine, letters: Guard, narrowed: Narrowed[Guard]
) -> Iterator[tuple[int, Move, Guard]]:
    """The moves of `machine` by `letters`, with the number of the state that each leaves and the letters it is by."""
    numbers: dict[Any, int] = {machine.initial: 0}
    queue: list[Any] = [machine.initial]
    for state in queue:
        for move in machine.moves(state, letters, narrowed):
            if move.target not in numbers:
                numbers[move.target] = len(queue)
                queue.append(move.target)
            yield numbers[state], Move(numbers[move.target], move.fair), move.letters


def valuations(diagrams: Diagrams, atoms: tuple[str, ...], group: Group) -> Diagram:
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
        if key not in numbers:
            if most is not None and len(keys) >= most:
                raise TooManyStatesError
            numbers[key] = len(keys)
            keys.append(key)
        return numbers[key]

    outputs, successors = [], []
    for key in keys:
        outputs.append(output(key))
        row = letters.restrict(step(key))
        successors.append(letters.diagrams.combine(lambda target: _moved(target, number), row))
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
    return machine.letters.diagrams.relabel(lambda target: _moved(target, classes.__getitem__), machine.successors)


def _number(items: Iterable[Hashable]) -> list[int]:
    """The number of each item among the different ones, in the order of first occurrence."""
    numbers: dict[Hashable, int] = {}
    return [numbers.setdefault(item, len(numbers)) for item in items]


def verdict_machine(satisfiable: Machine, falsifiable: Machine, finite: Machine, empty: bool) -> Machine:
    """The four verdicts from three Boolean machines that read the same word side by side.

    `satisfiable` and `falsifiable` say whether some infinite continuation satisfies, or fails, the formula, `finite`
    whether the word itself satisfies it; for the empty word, that is `empty`. Words that no run in time has lead to
    `IMPOSSIBLE`.
    """
    letters = satisfiable.letters
    parts = (satisfiable, falsifiable, finite)
    runs = [letters.diagrams.combine(_move, row) for row in letters.time.moves]

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
        *states, clocks = (0, 0, 0, 0) if key is None else key
        rows = (part.successors[state] for part, state in zip(parts, states, strict=True))
        return letters.diagrams.combine(next_, *rows, runs[clocks])

    def output(key: Any) -> Verdict:
        if isinstance(key, Verdict):
            return key
        holds = empty if key is None else finite.outputs[key[2]]
        return Verdict.PRESUMABLY_SATISFIED if holds else Verdict.PRESUMABLY_VIOLATED

    settled = settle(0, 0, 0, 0)
    return explore(letters, settled if isinstance(settled, Verdict) else None, step, output)


def _move(move: Any) -> Hashable:
    return Letter.IMPOSSIBLE if move is None else move.target


def watcher(event: Formula, alphabet: Alphabet) -> Monitor:
    """The monitor of whether the last letter has `event`, a state predicate."""
    letters = letters_of(event, alphabet)
    levels = {atom: level for level, atom in enumerate(letters.atoms)}
    row = letters.restrict(letters.diagrams.combine(int, of_predicate(event, letters.diagrams, levels)))
    return to_monitor(Machine(letters, [Verdict.PRESUMABLY_VIOLATED, Verdict.PRESUMABLY_SATISFIED], [row, row]))


def join_compatible(machine: Machine) -> Machine:
    """`machine` with states joined that agree on every letter that is possible in both, one pair after the other.

    What is possible next depends on the clocks, so that there may be fewer states than there are classes of equal ones.
    The fewest are hard to find (Pfleeger, *State reduction in incompletely specified finite-state machines*, 1973).
    """
    classes = list(range(len(machine.outputs)))
    for high in range(1, len(classes)):
        for low in range(high):
            if classes[high] == high and classes[low] == low:
                classes = _joined(machine, classes, low, high) or classes
    diagrams = machine.letters.diagrams
    joined = {c: diagrams.combine(first_possible, *_rows(machine, classes, c)) for c in set(classes)}
    return explore(machine.letters, classes[0], joined.__getitem__, machine.outputs.__getitem__)


def _joined(machine: Machine, classes: list[int], low: int, high: int) -> list[int] | None:
    """`classes` with those of two states joined, and all that they lead to by one letter; None if their outputs differ.

    A class is known by the smallest state in it.
    """
    classes = list(classes)
    pairs = [(low, high)]
    while pairs:
        one, other = sorted(classes[state] for state in pairs.pop())
        if one == other:
            continue
        if machine.outputs[one] != machine.outputs[other]:
            return None
        classes = [one if c == other else c for c in classes]
        rows = _rows(machine, classes, one)
        for targets in machine.letters.diagrams.values(machine.letters.diagrams.combine(_all_possible, *rows)):
            leaps = [target if target.__class__ is Leap else Leap(target, None) for target in targets]
            if len({leap.actions for leap in leaps}) > 1:
                return None
            pairs += pairwise(sorted(leap.state for leap in leaps))
    return classes


def _rows(machine: Machine, classes: list[int], class_: int) -> list[Diagram]:
    """The different rows of the states in a class, with the classes of their successors for the successors."""
    rows = [row for row, c in zip(machine.successors, classes, strict=True) if c == class_]
    relabelled = machine.letters.diagrams.relabel(lambda target: _moved(target, classes.__getitem__), rows)
    return list(dict.fromkeys(relabelled))


def _all_possible(*targets: Any) -> frozenset[Any]:
    return frozenset(targets) - {Letter.IMPOSSIBLE}


def first_possible(*targets: Any) -> Hashable:
    """The first of `targets` that is possible; `IMPOSSIBLE` if none is."""
    return next((target for target in targets if target is not Letter.IMPOSSIBLE), Letter.IMPOSSIBLE)


def to_monitor(machine: Machine) -> Monitor:
    """The canonical `Monitor` of a machine whose outputs are verdicts: minimal, where every word is a run in time."""
    minimal = minimise(machine)
    if minimal.letters.time.sets:
        minimal = join_compatible(minimal)
    edges, decisions = decided(minimal.letters.diagrams, minimal.successors, lambda state: state)
    return Monitor(minimal.letters.atoms, tuple(minimal.outputs), edges, decisions)


def decided(
    diagrams: Diagrams, rows: Iterable[Diagram], number: Callable[[Any], int]
) -> tuple[tuple[Target, ...], tuple[Decision, ...]]:
    """The targets that `rows` are, and the decisions behind them; `number` gives those of their values."""
    asked = [_drop_idle_questions(diagrams, row) for row in rows]
    nodes = [node for node in diagrams.reachable(*asked) if not diagrams.is_terminal(node)]
    numbers = {node: place for place, node in enumerate(nodes)}

    def target(node: Diagram) -> Target:
        return number(diagrams.value(node)) if diagrams.is_terminal(node) else ~numbers[node]

    def decision(node: Diagram) -> Decision:
        level, low, high = diagrams.split(node)
        return Decision(level, target(low), target(high))

    return tuple(map(target, asked)), tuple(map(decision, nodes))


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
