"""The letters of a property as sets of values: as decision diagrams over what its conditions can ask of these."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ltlc.assurance.lowered.clocks import Moment
from ltlc.assurance.lowered.meaning import compared, said, truth
from ltlc.assurance.lowered.truths import DiffersError, Truths
from ltlc.dataclass import dataclass
from ltlc.semantics.diagrams import Diagram, Diagrams, of_diagrams, rows
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.reset_machine import Clocks, ResetMachine
from ltlc.semantics.timed_atoms import Age, atoms_within, messages_of
from ltlc.semantics.trackers import Case
from ltlc.semantics.words import Letter
from ltlc.specification.expressions import New, Opening, inputs, openings, operands
from ltlc.specification.specification import PropertySpecification


@dataclass(frozen=True, slots=True)
class Judged:
    """A property, its formula of core LTL, and the certified monitor of that."""

    specification: PropertySpecification
    formula: Formula
    monitor: Monitor


class Letters:
    """What can be asked at a step: of the values, and whether a clock that is due at one of `dues` is late.

    What is counted, by its name, has been reached unless the moment is past at which it is `over`.

    `possible` are the letters that exist, `undefined` where a step is none because something is NaN, `with_news` those
    with news that conditions of the formula ask for.
    """

    def __init__(self, judged: Judged, time: ResetMachine, dues: Sequence[Moment], over: Mapping[str, Moment]) -> None:
        self.diagrams = Diagrams()
        self.truths = Truths(self.diagrams)
        self.nothing = self.diagrams.terminal(None)
        self._judged, self._time = judged, time
        specification = judged.specification
        self._messages = messages_of(tracker.subject for tracker in time.trackers)
        conditions = {a.name: a.condition for a in specification.atoms if a.name not in self._messages}
        ordered = [name for name in judged.monitor.atoms if name in conditions]
        holds = {name: self.truths.holds(truth(conditions[name])) for name in dict.fromkeys([*ordered, *conditions])}
        self._readers = {
            name: found
            for name, condition in conditions.items()
            if (found := frozenset(o for side in operands(condition) for o in openings(side)))
        }
        sides = (side for condition in conditions.values() for side in compared(condition))
        self.undefined = self.truths.some(map(self.truths.is_nan, sides))
        self.defined = self._none_of(self.undefined)
        self._truths = {name: self.diagrams.given(self.defined, each) for name, each in holds.items()}
        self._dues = (*dues, *over.values())
        for due in self._dues:
            self.truths.asked(due)
        self._truths |= {name: self.diagrams.negation(self.truths.asked(moment)) for name, moment in over.items()}
        for name in (*sorted(self._messages), *(name for tracker in time.trackers for name in tracker.atoms)):
            self._truths[name] = self.truths.asked(name)
        unknown = set(judged.monitor.atoms) - self._truths.keys()
        if unknown:
            raise DiffersError(f"the monitor asks `{min(unknown)}`, which the property does not")
        self.possible = self._possible()
        monitor = judged.monitor
        row = rows(self.diagrams, monitor.decisions, lambda atom: self._truths[monitor.atoms[atom]])
        self._rows = list(map(row, monitor.edges))
        self._told = {i: self.truths.holds(said(i)) for i in specification.inputs() if isinstance(i, New)}
        read = {atom.name for atom in atoms_within(judged.formula)} & conditions.keys()
        asked = {i for name in read for side in operands(conditions[name]) for i in inputs(side)}
        self.with_news = self.truths.some(news for i, news in self._told.items() if i in asked)
        self.truths.close()

    def _possible(self) -> Diagram:
        """The valuations that exist of each group of atoms."""
        no, truths = self.diagrams.negation, self._truths
        return self.truths.every(
            self.truths.some(
                self.truths.every(truths[atom] if atom in valuation else no(truths[atom]) for atom in group.atoms)
                for valuation in group.valuations
            )
            for group in self._judged.specification.alphabet.groups
        )

    def where(self, predicate: Formula) -> Diagram:
        """Where a state predicate holds."""
        return of_diagrams(predicate, self.diagrams, self._truths.__getitem__)

    def level(self, fact: Moment | str) -> int:
        """The level that asks whether a clock that is due then is late, or what a tracker or a message decides."""
        return self.truths.levels[fact]

    def _none_of(self, asked: Diagram) -> dict[int, bool]:
        """The answers with which `asked`, some of several things, is false."""
        found = self.diagrams.reachable(asked)
        return {self.diagrams.split(each)[0]: False for each in found if not self.diagrams.is_terminal(each)}

    def side_by_side(self, clocks: Clocks, among: Diagram) -> Iterator[tuple[Diagram, tuple[Case, ...]]]:
        """What the trackers may do together, each with the letters of `among` by which they do."""
        for letters, cases in self._time.side_by_side(clocks, among, self._narrowed):
            yield self.diagrams.given(self._decided(cases), letters), cases

    def _narrowed(self, among: Diagram, event: Formula) -> Diagram | None:
        found = self.diagrams.conjunction(among, self.where(event))
        return None if found == self.diagrams.false else found

    def _decided(self, cases: tuple[Case, ...]) -> dict[int, bool]:
        """The answers of the trackers, and whether a message has come that makes a late age young."""
        found: dict[int, bool] = {}
        for tracker, case in zip(self._time.trackers, cases, strict=True):
            found |= {self.level(name): name in case.holding for name in tracker.atoms}
            if isinstance(tracker.subject, Age):
                found[self.level(tracker.subject.news.name)] = case.starts
        return found

    def row(self, state: int, cases: tuple[Case, ...]) -> Diagram:
        """Where the monitor goes on from `state`, where the trackers do `cases`."""
        return self.diagrams.given(self._decided(cases), self._rows[state])

    def without_news(self, letters: Diagram) -> Diagram:
        """`letters` as they are held: their news is over."""
        held = self._any_answer([self.diagrams.split(news)[0] for news in self._told.values()], letters)
        return self.diagrams.conjunction(held, self.diagrams.negation(self.with_news))

    def whatever_is_taken(self, taken: frozenset[Opening], letters: Diagram) -> Diagram:
        """`letters`, whatever holds of the values `taken` at openings."""
        parts = (self._truths[name] for name, reads in self._readers.items() if reads & taken)
        found = self.diagrams.reachable(*parts)
        levels = {self.diagrams.split(each)[0] for each in found if not self.diagrams.is_terminal(each)}
        return self.diagrams.conjunction(self._any_answer(sorted(levels), letters), self.possible)

    def signals(self, letters: Diagram) -> Diagram:
        """`letters`, whatever clocks are late."""
        return self._any_answer([self.level(due) for due in self._dues], letters)

    def _any_answer(self, levels: Sequence[int], letters: Diagram) -> Diagram:
        for level in levels:
            sides = (self.diagrams.given({level: answer}, letters) for answer in (False, True))
            letters = self.diagrams.disjunction(*sides)
        return letters

    def example(self, letters: Diagram, cases: tuple[Case, ...] = ()) -> Letter:
        """One of `letters`, at which the trackers do `cases`."""
        answers = next(path for path, holds in self.diagrams.paths(letters) if holds)
        decided = self._messages.union(*(tracker.atoms for tracker in self._time.trackers))
        held = {name for case in cases for name in case.holding}
        for name, holds in self._truths.items():
            if name not in decided and self.diagrams.evaluate(holds, lambda level: answers.get(level, False)):
                held.add(name)
        return frozenset(held)
