"""What a machine does not wait for makes no difference while its news is out, or has the value said for that time."""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.assurance.lowered.meaning import said
from ltlc.assurance.lowered.truths import DiffersError
from ltlc.program.expressions import Held, Read
from ltlc.program.machine import Machine
from ltlc.semantics import properties
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.finite import holds
from ltlc.semantics.ltl import Formula, atoms
from ltlc.semantics.timed_atoms import Age, atoms_within
from ltlc.semantics.timed_atoms import operands as decided_by
from ltlc.semantics.words import Letter
from ltlc.specification.atoms import Atom
from ltlc.specification.expressions import IsTrue, inputs, operands
from ltlc.specification.specification import PropertySpecification, topics_of

MOST_LETTERS = 2**14
"""Predicates with more letters are not looked at here."""


def require_excused(machine: Machine, specification: PropertySpecification) -> None:
    """Raises DiffersError if a state predicate depends on a value that the machine does not wait for.

    What has another value at first is not waited for either, and has that value.
    """
    wanted = {said(each): each for each in specification.inputs()}
    conditions = {a.name: a.condition for a in specification.atoms if a.name not in specification.messages()}
    names = {
        read: name for name, c in conditions.items() if isinstance(c, IsTrue) for read in map(said, inputs(c.operand))
    }
    for excused in machine.excused:
        if (constant := wanted[excused.input].signal.otherwise) is not None:
            if excused.news or excused.instead != constant.value:
                raise DiffersError(f"`{excused.input.signal}` is not {constant.value} at first")
            continue
        topics = {topic for new in excused.news for topic in topics_of(wanted[new].signal)}
        if not topics >= set(topics_of(wanted[excused.input].signal)):
            raise DiffersError(
                f"it does not wait for `{excused.input.signal}`, although it does not have all of its news"
            )
        for predicate in _predicates(specification):
            if any(_depends(predicate, excused.input, names[new], specification) for new in excused.news):
                raise DiffersError(
                    f"it does not wait for `{excused.input.signal}`, although `{predicate}` depends on it"
                )


def _predicates(specification: PropertySpecification) -> Iterator[Formula]:
    for predicate in properties.predicates(specification.property):
        yield predicate
        for atom in atoms_within(predicate):
            yield from () if isinstance(atom, Age) else decided_by(atom)


def _depends(predicate: Formula, wanted: Held, news: str, specification: PropertySpecification) -> bool:
    """Whether `predicate` differs at letters without `news` that differ in what is asked of the input `wanted` only."""
    names, read = atoms(predicate), {atom.name: _read(atom) for atom in specification.atoms}
    own = {name for name in names if wanted in read.get(name, ())}
    alphabet = Alphabet(names, specification.alphabet.restricted_to(n for n in names if n in read).groups)
    if not own or alphabet.count() > MOST_LETTERS:
        return False
    values: dict[Letter, bool] = {}
    silent = (letter for letter in alphabet.letters() if news not in letter)
    found = ((letter - own, holds(predicate, (letter,))) for letter in silent)
    return any(values.setdefault(rest, value) != value for rest, value in found)


def _read(atom: Atom) -> set[Read]:
    return {said(i) for side in operands(atom.condition) for i in inputs(side)}
