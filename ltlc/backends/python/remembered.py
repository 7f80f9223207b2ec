"""What states of a machine say of the instant before: by that a violation of what asks `previously` is explained.

Of a predicate, a state knows whether it held when the state was entered, if each way into the state decides that.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ltlc.program.properties import Words
from ltlc.runtime.properties import Remembered
from ltlc.semantics.diagrams import Diagram, Diagrams, of_predicate
from ltlc.semantics.ltl import Atom, Formula, subformulas
from ltlc.semantics.monitor import Target
from ltlc.semantics.timed_atoms import Previously, atoms_within, operands


def remembered(formula: Formula, of: Words) -> Iterator[Remembered]:
    """What is asked about the instant before, by atoms of the property alone."""
    atoms = list(atoms_within(formula))
    parts = [formula, *(part for atom in atoms if not isinstance(atom, Previously) for part in operands(atom))]
    now = {part.name for each in parts for part in subformulas(each) if isinstance(part, Atom)}
    numbers = {name: number for number, name in enumerate(of.atoms)}
    for each in atoms:
        if isinstance(each, Previously):
            names = {part.name for part in subformulas(each.operand) if isinstance(part, Atom)}
            if names <= numbers.keys():
                only = tuple(sorted(numbers[name] for name in names - now))
                yield each.name, tuple(_held(each.operand, of, numbers)), only


def _held(predicate: Formula, of: Words, numbers: Mapping[str, int]) -> Iterator[bool | None]:
    """Of each state, whether the predicate held when it was entered; at the beginning, it had not."""
    diagrams = Diagrams()
    asked = of_predicate(predicate, diagrams, numbers)
    found = {(0, False)}
    for root in of.steps:
        for state, held in _ends(root, of, diagrams, asked):
            found |= {(state, each) for each in (False, True) if held in (each, None)}
    waiting = list(found)
    for before, value in waiting:
        for state, held in _ends(of.expires[before], of, diagrams, asked):
            entered = state, value if held is None else held
            if entered not in found:
                found.add(entered)
                waiting.append(entered)
    for state, verdict in enumerate(of.verdicts):
        values = {held for entered, held in found if entered == state}
        yield values.pop() if len(values) == 1 and not verdict.is_permanent else None


def _ends(root: Target, of: Words, diagrams: Diagrams, asked: Diagram) -> set[tuple[int, bool | None]]:
    """The states that `root` leads to, and whether what is `asked` holds on the way, if that decides it."""
    reached = [(root, asked)]
    seen = set(reached)
    for target, left in reached:
        if target < 0:
            number, low, high = of.decisions[~target]
            for next_, answer in ((low, False), (high, True)):
                way = next_, diagrams.given({number: answer}, left)
                if way not in seen:
                    seen.add(way)
                    reached.append(way)
    return {
        (target, bool(diagrams.value(left)) if diagrams.is_terminal(left) else None)
        for target, left in reached
        if target >= 0
    }
