"""Comparison on runs in time: each difference is a run with times, judged by the definition on instants.

Automata know the order in which clocks pass their bounds only so far. That no run tells two formulas apart is believed
of them; that some run does, only once there is one.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import field
from functools import cached_property
from itertools import combinations, product

from ltlc.analysis.comparison.reference import Trials
from ltlc.analysis.errors import NotDecidedError
from ltlc.analysis.examples import telling
from ltlc.analysis.search import shortest
from ltlc.assurance.walks import word_of
from ltlc.automata.languages import Languages
from ltlc.automata.queries import ending
from ltlc.dataclass import dataclass
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.denotation import Reading, satisfies
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.instants import Instant, Observation, Step
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.properties import Property, predicates
from ltlc.semantics.timed_atoms import News, TimedAtom, atoms_within, duration_of, news_of, timed_atoms
from ltlc.semantics.timed_run import TimedRun
from ltlc.semantics.trackers import Tracker, trackers_of
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Lasso, Letter, Word

LONGEST_LASSO = 6
"""How many different instants the infinite runs have that are searched for."""

MOST_BOUNDS = 2
"""Runs are tried with steps at, and just past, so many bounds, the smallest ones."""


def told(letter: Letter, atoms: Collection[str]) -> Letter:
    """`letter` with nothing but `atoms`: what has happened, not what follows from it."""
    if isinstance(letter, Instant):
        return Instant(letter.time, letter.intersection(atoms), by_time=letter.by_time)
    return letter


def satisfies_in_time(word: Word, property_: Property, reading: Reading) -> bool:
    """Whether the run that takes the steps in `word` satisfies `property_`, by definition, up to its last instant."""
    instants = [instant for instant in word if isinstance(instant, Instant)]
    found = [atom for predicate in predicates(property_) for atom in atoms_within(predicate)]
    read = {atom.name for atom in found if isinstance(atom, News) or not isinstance(atom, TimedAtom)}
    steps = tuple(Step(instant.time, instant.intersection(read)) for instant in instants if not instant.by_time)
    run = Observation(steps, instants[-1].time, instants[0].time)
    return satisfies(word_of(property_, run, (instant.time for instant in instants)), property_, reading)


def earliest_in_time(monitor: Monitor, verdict: Verdict, formula: Formula, alphabet: Alphabet) -> Word | None:
    """A shortest run after which `monitor`, made of `formula`, says `verdict`, as it is shown."""
    word = shortest([(formula, monitor)], alphabet, lambda verdicts: verdicts[0] is verdict)
    if word is None:
        return None
    atoms = [*alphabet.atoms, *(news.name for news in news_of(formula))]
    return tuple(told(word[n], atoms) for n in telling(word, monitor.run(word), None))


def words_in_time(formulas: Sequence[Formula], alphabet: Alphabet) -> tuple[Word | None, Word | None]:
    """A shortest run that satisfies only the first of two formulas, and one that satisfies only the second."""
    monitored = [(formula, ending(formula, alphabet)) for formula in formulas]
    left_only = shortest(monitored, alphabet, lambda verdicts: verdicts[0].holds and not verdicts[1].holds)
    return left_only, shortest(monitored, alphabet, lambda verdicts: verdicts[1].holds and not verdicts[0].holds)


def lasso_in_time(formula: Formula, alphabet: Alphabet) -> tuple[Lasso | None, bool]:
    """An infinite run that satisfies `formula`, if there is one, and whether it is as short as any.

    Raises NotDecidedError where the automata allow one, and none is found.
    """
    languages = Languages(alphabet)
    if not languages.compatible([languages.of(formula)]):
        return None, True
    from ltlc.analysis.lassos import LassoSearch

    is_shortest = True
    for length in range(1, LONGEST_LASSO + 1):
        search = LassoSearch([formula], alphabet, length)
        lasso = search.find({0: True})
        if lasso is not None:
            return lasso, is_shortest
        is_shortest &= not search.gave_up
    raise NotDecidedError(
        "the automata, which know the order of clocks only approximately, allow a difference, but no run shows one"
    )


@dataclass(frozen=True)
class TimedTrials(Trials):
    """Runs with steps at once, at the bounds of `formula`, and just past them; infinite ones stay as they are."""

    in_time: bool = True
    formula: Formula = field(kw_only=True)

    def runs(self, length: int) -> Iterator[Word | Lasso]:
        """Every run of `length` steps."""
        for letters in product(self._letters(), repeat=length):
            for gaps in product(self._gaps(), repeat=length):
                yield self._run(letters, gaps)

    def number(self, length: int) -> int:
        """How many `runs` there are."""
        return int((len(self._letters()) * len(self._gaps())) ** length)

    @cached_property
    def _clocks(self) -> tuple[tuple[Tracker, ...], tuple[News, ...]]:
        return trackers_of(self.formula), news_of(self.formula)

    def _letters(self) -> list[Letter]:
        """Signals, with any news."""
        timed = {atom.name for atom in timed_atoms(self.formula)}
        news = [atom.name for atom in news_of(self.formula)]
        arrivals = [each for count in range(len(news) + 1) for each in combinations(news, count)]
        return list(dict.fromkeys((letter - timed).union(each) for letter in self.letters for each in arrivals))

    def _gaps(self) -> list[Nanoseconds]:
        durations = sorted({d for atom in timed_atoms(self.formula) if (d := duration_of(atom))})[:MOST_BOUNDS]
        return [0, *(duration + more for duration in durations for more in (0, 1))]

    def _run(self, letters: Sequence[Letter], gaps: Sequence[Nanoseconds]) -> Word | Lasso:
        run, time = TimedRun(*self._clocks, 0), 0
        seen: list[Instant] = []
        for letter, gap in zip(letters, gaps, strict=True):
            seen += run.step(time, letter)
            time += gap
        seen += run.hold(time)
        if not self.infinite:
            return tuple(seen)
        while (due := run.due()) is not None:
            seen += run.hold(due)
        return Lasso(tuple(seen), (seen[-1],))
