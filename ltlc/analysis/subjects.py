"""What the questions of `check` are asked about: properties with their formulas, letters and monitors, made once."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from functools import cached_property
from itertools import chain
from typing import TYPE_CHECKING

from ltlc.analysis.errors import DisagreementError
from ltlc.analysis.examples import Example, Setting, example_of
from ltlc.analysis.letters import Letters
from ltlc.analysis.predicates import possible_letter
from ltlc.analysis.search import ALL_OPEN, Shut
from ltlc.dataclass import dataclass
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.denotation import READINGS, satisfies
from ltlc.semantics.encodings import Encoding, ManyClocksError, encode
from ltlc.semantics.instants import Instant
from ltlc.semantics.lasso import holds_on_lasso
from ltlc.semantics.ltl import Formula, Not, conjunction
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.properties import Property
from ltlc.semantics.timed_atoms import atoms_within, news_of, timed_atoms
from ltlc.semantics.timed_run import TimedRun
from ltlc.semantics.trackers import trackers_of
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Lasso, Word
from ltlc.specification.shapes import Shape
from ltlc.specification.specification import PropertySpecification, Specification, topics

if TYPE_CHECKING:
    from ltlc.analysis.lassos import LassoSearch
    from ltlc.automata.languages import Language, Languages

MANY_CLOCKS = 3
"""With so many clocks, a run is searched for before automata are made, which know in what order these pass bounds."""

SEARCHED_LENGTH = 3
"""How many different steps the runs have that are searched for among many properties."""


@dataclass(frozen=True)
class Subject:
    """A property, what it is in core LTL, the letters that exist for it, and its monitor.

    Where there is none, `obstacle` says why. `shut` has the letters where scopes are not open.
    """

    number: int
    specification: PropertySpecification
    formula: Formula
    alphabet: Alphabet
    monitor: Monitor | None
    obstacle: str = ""
    shut: Shut = ALL_OPEN

    @property
    def label(self) -> str:
        """How a message names it."""
        return self.specification.label

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys by which the runs that it is about are sliced."""
        slicing = self.specification.slicing
        return () if slicing is None else tuple(sorted(key.name for key in slicing.keys))

    @cached_property
    def is_timed(self) -> bool:
        """Whether time, or the past, decides it."""
        return bool(timed_atoms(self.formula))

    @cached_property
    def counts(self) -> bool:
        """Whether it counts: then no example is shown."""
        return bool(self.specification.counts())

    @property
    def never_holds(self) -> bool:
        """Whether no run satisfies it."""
        return self.monitor is not None and self.monitor.verdicts[0] is Verdict.VIOLATED

    @property
    def always_holds(self) -> bool:
        """Whether every run satisfies it."""
        return self.monitor is not None and self.monitor.verdicts[0] is Verdict.SATISFIED

    @property
    def is_contingent(self) -> bool:
        """Whether, as far as is known, some runs satisfy it and others do not."""
        return not (self.never_holds or self.always_holds)


@dataclass(frozen=True)
class Study:
    """A specification with what its analyses share; `pedantic` says that opinions are asked for.

    It is asked what a controller can do that sends on the topics `controls`, if there are any.

    `monitors` are those made so far, by their shapes, for later translations of the same properties.
    """

    specification: Specification
    encoding: Encoding
    letters: Letters
    subjects: tuple[Subject, ...]
    monitors: Mapping[Hashable, Monitor]
    pedantic: bool = False
    controls: tuple[str, ...] = ()

    def setting(self, *subjects: Subject) -> Setting:
        """What examples about `subjects` are made with."""
        atoms = {atom.name: atom for subject in subjects for atom in subject.specification.atoms}
        read = {topic for subject in subjects for topic in topics(subject.specification)}
        linked = self.specification.rate is not None or len(read) == 1
        openings = {o: clock for subject in subjects for o, clock in subject.specification.openings().items()}
        return Setting(tuple(atoms.values()), self.letters, linked, openings, any(each.counts for each in subjects))

    def example_step(self, predicate: Formula, caption: str, *subjects: Subject) -> Example | None:
        """A step of `subjects` on which `predicate` holds; None if there is none, or no values for it are found.

        None for a predicate that the past decides: a step alone does not show it.
        """
        if timed_atoms(predicate):
            return None
        letter = possible_letter(predicate, self.alphabet(subjects))
        return None if letter is None else example_of(self.setting(*subjects), (letter,), caption)

    def verdicts(self, subject: Subject, word: Word) -> list[str]:
        """The verdict after each step, in words, judged by the reference.

        Raises DisagreementError if the reference does not confirm what the monitor says: of the finite run, and of the
        run that stays as it is at its end. Where time decides, that run need not agree with a presumable verdict.
        """
        if subject.monitor is None:
            raise ValueError(f"there is no monitor of {subject.label}")
        given = subject.monitor.run(word)
        reading = READINGS[self.encoding.name]
        for count, verdict in enumerate(given, 1):
            seen = word[:count]
            finite = satisfies(seen, subject.specification.property, reading)
            staying = holds_on_lasso(subject.formula, self._staying(subject, seen))
            if finite != verdict.holds or (staying != verdict.holds and (verdict.is_permanent or not subject.is_timed)):
                raise DisagreementError("how a run is judged")
        return [verdict.value.replace("_", " ") for verdict in given]

    def _staying(self, subject: Subject, word: Word) -> Lasso:
        """The run that stays as it is at the end of `word`, the session of which began with the first step."""
        if not subject.is_timed:
            return Lasso(word, word[-1:])
        instants = [instant for instant in word if isinstance(instant, Instant)]
        run = TimedRun(trackers_of(subject.formula), news_of(subject.formula), instants[0].time)
        seen: list[Instant] = []
        for instant in instants:
            seen += run.hold(instant.time) if instant.by_time else run.step(instant.time, instant)
        while (due := run.due()) is not None:
            seen += run.hold(due)
        return Lasso(tuple(seen), (seen[-1],))

    def shape(self, subjects: Sequence[Subject]) -> Hashable:
        """What is left of `subjects`, and of the letters that exist for them, without the names in them."""
        shape = Shape()
        for subject in subjects:
            shape.add_property(subject.specification, subject.formula)
            shape.add(subject.specification.slicing)
            shape.add(subject.monitor)
        shape.add(self.alphabet(subjects))
        return shape.key

    def alphabet(self, subjects: Iterable[Subject]) -> Alphabet:
        """The letters over the atoms of `subjects`."""
        return self.letters.alphabet(chain.from_iterable(subject.alphabet.atoms for subject in subjects))

    @cached_property
    def languages(self) -> Languages:
        """Where the questions about several properties are put to Spot."""
        from ltlc.automata.languages import Languages

        return Languages(self.letters.alphabet(atom.name for atom in self.letters.atoms))

    @cached_property
    def words(self) -> Sequence[Language]:
        """The infinite words of each property."""
        return [self.languages.of(subject.formula) for subject in self.subjects]

    def language(self, property_: Property) -> Language | None:
        """The infinite words of a property that is not in the file; None if its bounds take too many clocks."""
        try:
            return self.languages.of(encode(property_, self.encoding))
        except ManyClocksError:
            return None

    def can_hold(self, subjects: Sequence[Subject]) -> bool:
        """Whether some run satisfies all of `subjects`, which are few."""
        return self.compatible([self.words[subject.number] for subject in subjects])

    def compatible(self, languages: Sequence[Language]) -> bool:
        """Whether some run in time is in all of `languages`, which are few."""
        formulas = [language.formula for language in languages]
        return self._has_short_run(formulas) or self.languages.compatible(languages)

    def implies(self, given: Sequence[Language], then: Language) -> bool:
        """Whether every run in time that is in all of `given`, which are few, is in `then`."""
        formulas = [*(language.formula for language in given), Not(then.formula)]
        return not self._has_short_run(formulas) and self.languages.implies(given, then)

    def _has_short_run(self, formulas: Sequence[Formula]) -> bool:
        """Whether a short run is found that satisfies all `formulas`; not looked for where automata are small."""
        formula = conjunction(formulas)
        if sum(bool(tracker.bounds) for tracker in trackers_of(formula)) < MANY_CLOCKS:
            return False
        from ltlc.analysis.lassos import find_lasso

        return find_lasso(formulas, self.letters.alphabet(atom.name for atom in atoms_within(formula))) is not None

    @cached_property
    def common_runs(self) -> LassoSearch:
        """Where short runs are searched for that satisfy some properties and not others."""
        from ltlc.analysis.lassos import LassoSearch

        return LassoSearch(
            [subject.formula for subject in self.subjects], self.alphabet(self.subjects), SEARCHED_LENGTH
        )

    @cached_property
    def neighbours(self) -> Sequence[frozenset[int]]:
        """For each property the numbers of the contingent others that it shares signals with.

        Those of whole runs and of slices, or of slices by different keys, share none: an `each` is about other runs.
        """
        related = [self.letters.related(a.name for a in subject.specification.atoms) for subject in self.subjects]
        reading: dict[tuple[object, str], set[int]] = {}
        for subject in self.subjects:
            for atom in related[subject.number] if subject.is_contingent else ():
                reading.setdefault((subject.keys, atom), set()).add(subject.number)
        return [
            frozenset[int]().union(*(reading.get((subject.keys, atom), ()) for atom in related[subject.number]))
            - {subject.number}
            for subject in self.subjects
        ]

    @cached_property
    def components(self) -> Sequence[tuple[Subject, ...]]:
        """The contingent properties in sets that share no signal."""
        left = {subject.number for subject in self.subjects if subject.is_contingent}
        found = []
        while left:
            reached = {min(left)}
            frontier = set(reached)
            while frontier:
                frontier = {n for number in frontier for n in self.neighbours[number]} - reached
                reached |= frontier
            left -= reached
            found.append(tuple(self.subjects[number] for number in sorted(reached)))
        return found
