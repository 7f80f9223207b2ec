"""Which signals a property reads with their news only: it need not wait for their first values.

A signal is *read with its news* if it makes no difference to any state predicate while no message brings it; that is
decided on the predicate as a decision diagram, over the letters that exist. `new s and s == 1` reads s so.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import reduce

from ltlc.semantics import properties
from ltlc.semantics.diagrams import Diagram, Diagrams, of_predicate
from ltlc.semantics.ltl import Formula, atoms
from ltlc.semantics.timed_atoms import Age, Occurred, atoms_within
from ltlc.semantics.timed_atoms import operands as decided_by
from ltlc.specification.atoms import Atom
from ltlc.specification.expressions import Current, Field, Input, IsTrue, New, Signal, inputs, operands
from ltlc.specification.specification import PropertySpecification, topics_of


def read_with_news(specification: PropertySpecification) -> Mapping[Current, tuple[New, ...]]:
    """The inputs that the property reads with their news, and the inputs that are this news, one for each topic."""
    told = specification.messages()
    news = (_new(atom) for atom in specification.atoms if atom.name not in told)
    by_topic = {topic: new for new in news if new for topic in topics_of(new.signal)}
    found: dict[Current, tuple[New, ...]] = {}
    if by_topic:
        predicates = _Predicates(specification)
        for wanted in specification.inputs():
            if isinstance(wanted, Current) and _has_only_present_values(specification, wanted.signal):
                topics = topics_of(wanted.signal)
                if topics and by_topic.keys() >= set(topics) and all(predicates.ignore(wanted, t) for t in topics):
                    found[wanted] = tuple(by_topic[topic] for topic in topics)
    return found


def waited_for(specification: PropertySpecification) -> tuple[Input, ...]:
    """The inputs that the property does wait for."""
    excused = read_with_news(specification)
    return tuple(
        i for i in specification.inputs() if not isinstance(i, New) and i not in excused and i.signal.otherwise is None
    )


def _new(atom: Atom) -> New | None:
    match atom.condition:
        case IsTrue(New() as new):
            return new
        case _:
            return None


def _is_news_of(atom: Atom, topic: str) -> bool:
    new = _new(atom)
    return new is not None and topic in topics_of(new.signal)


def _has_only_present_values(specification: PropertySpecification, signal: Signal) -> bool:
    """Whether neither the past of `signal` is read, nor any of what it is computed from."""
    own = (each for each in specification.reads() if each.signal == signal)
    return all(isinstance(each, Current | New) for each in own) and _is_computed_at_once(signal)


def _is_computed_at_once(signal: Signal) -> bool:
    if isinstance(signal.definition, Field):
        return True
    return signal.when is None and all(isinstance(i, Current) and _is_computed_at_once(i.signal) for i in signal.inputs)


class _Predicates:
    """The state predicates of a property as diagrams, the operands of its past operators included."""

    def __init__(self, specification: PropertySpecification) -> None:
        self._atoms = {atom.name: atom for atom in specification.atoms}
        predicates = dict.fromkeys(_predicates(properties.predicates(specification.property)))
        names = dict.fromkeys([*self._atoms, *(name for p in predicates for name in atoms(p))])
        self._levels = {name: level for level, name in enumerate(names)}
        self._diagrams = Diagrams()
        self._said = [(self._diagram(p), self._existing(specification, p)) for p in predicates]

    def _diagram(self, predicate: Formula) -> Diagram:
        return of_predicate(predicate, self._diagrams, self._levels)

    def _existing(self, specification: PropertySpecification, predicate: Formula) -> Diagram:
        """The letters over the atoms of `predicate` that exist."""
        asked = [name for name in atoms(predicate) if name in self._atoms]
        return self._diagram(specification.alphabet.restricted_to(asked).as_formula())

    def ignore(self, wanted: Current, topic: str) -> bool:
        """Whether `wanted` makes no difference to any predicate while there is no news of `topic`."""
        silent = {self._levels[a.name]: False for a in self._atoms.values() if _is_news_of(a, topic)}
        compared = [self._levels[a.name] for a in self._atoms.values() if wanted in _inputs(a)]
        return all(
            self._is_apart(self._diagrams.given(silent, said), letters, compared) for said, letters in self._said
        )

    def _is_apart(self, said: Diagram, letters: Diagram, levels: Iterable[int]) -> bool:
        """Whether `said` is the same for all `letters` that differ only in what `levels` ask."""
        diagrams = self._diagrams
        holds, fails = (
            reduce(self._some, levels, diagrams.conjunction(letters, side)) for side in (said, diagrams.negation(said))
        )
        return diagrams.conjunction(holds, fails) == diagrams.false

    def _some(self, diagram: Diagram, level: int) -> Diagram:
        """Where `diagram` is true whether or not `level` holds."""
        low, high = (self._diagrams.given({level: answer}, diagram) for answer in (False, True))
        return self._diagrams.disjunction(low, high)


def _predicates(predicates: Iterable[Formula]) -> Iterator[Formula]:
    """Each of `predicates`, and the operands of the past operators in it; the age of a message reads no value."""
    for predicate in predicates:
        yield predicate
        for atom in atoms_within(predicate):
            if isinstance(atom, Occurred):
                yield atom.operand
            elif not isinstance(atom, Age):
                yield from decided_by(atom)


def _inputs(atom: Atom) -> set[Input]:
    return {i for operand in operands(atom.condition) for i in inputs(operand)}
