"""Plays: words that show that an outcome stays possible in time, whatever clocks read and however they expire.

The reset machine does not know how much time is left on a clock, so not every fair word of it is a run from where a run
has come to. But some ways to go on there always are: to take a step with any signals *at once*, before time passes; and
to *wait* until the letter changes by itself, of which time decides how. Words that have a letter for each way in which
time may decide, wherever they wait, are all plays of one strategy: one of them can come about.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import NamedTuple

from ltlc.semantics import finite
from ltlc.semantics.ltl import And, Atom, Formula, Not
from ltlc.semantics.reset_machine import Clocks, Move, ResetMachine, starts
from ltlc.semantics.timed_atoms import Age
from ltlc.semantics.words import Lasso, Letter, Word

LONGEST_STEM = 100
"""Letters before the loop of a play: no certificate can make the checker recurse deeper."""

COST = 50
"""What it costs to look at one word at one letter, in the unit of the checker's work."""


class Among(NamedTuple):
    """The letters with these atoms and any of the `open` ones."""

    letter: Letter
    open: frozenset[str]


Ways = dict[Letter, Move[Among]]
"""The letters that may come next, with what the reset machine does."""


class Plays:
    """How runs can go on in time, from states of the reset machine `time`."""

    def __init__(self, time: ResetMachine, spend: Callable[[int], None]) -> None:
        self._time = time
        self._spend = spend
        self._decided = frozenset(atom for tracker in time.trackers for atom in tracker.atoms)
        self._news = frozenset(each.name for each in time.news)
        self._known: dict[tuple[Clocks, Letter], Ways] = {}
        self._at_once: dict[tuple[Clocks, Letter], Ways] = {}

    def at_once(self, clocks: Clocks, letter: Letter) -> Ways:
        """The step with the signals of `letter` before time passes; a run may begin in a session of any age."""
        if (clocks, letter) not in self._at_once:
            self._at_once[clocks, letter] = self._steps(clocks, letter)
        return self._at_once[clocks, letter]

    def _steps(self, clocks: Clocks, letter: Letter) -> Ways:
        ways = self._ways(clocks, letter - self._decided)
        if clocks.is_first:
            ways = {letter: ways[letter]} if letter in ways and self._has_a_session(ways[letter]) else {}
        return {after: move for after, move in ways.items() if not self._time.passing(clocks, move.cases)}

    def _has_a_session(self, move: Move[Among]) -> bool:
        """Whether the ages at the first step can count from one beginning."""
        aged = [
            (case.passed, tracker.bounds[0])
            for tracker, case in zip(self._time.trackers, move.cases, strict=True)
            if isinstance(tracker.subject, Age) and case.passed is not None
        ]
        return all(over < under for passed, over in aged if passed for still, under in aged if not still)

    def waits(self, clocks: Clocks, letter: Letter) -> Ways:
        """How `letter`, which led to `clocks`, may change by itself; if it is held long enough, it does in some way."""
        held = self._ways(clocks, letter - self._decided - self._news)
        return {after: move for after, move in held.items() if (after, move.target) != (letter, clocks)}

    def _ways(self, clocks: Clocks, signals: Letter) -> Ways:
        if (clocks, signals) not in self._known:
            moves = self._time.moves(clocks, Among(signals, self._decided), self._narrowed)
            self._known[clocks, signals] = {move.letters.letter: move for move in moves}
        return self._known[clocks, signals]

    def suffice(self, words: Iterable[Lasso], clocks: Clocks) -> bool:
        """Whether some of `words` are all plays of a strategy from `clocks` on, whatever letter is held there."""
        return self._suffice([(word.stem, word.loop) for word in words if len(word.stem) <= LONGEST_STEM], clocks, None)

    def _suffice(self, words: list[tuple[Word, Word]], clocks: Clocks, last: Letter | None) -> bool:
        """As `suffice`, after the letter `last`; `words` are their letters from there on."""
        self._spend(COST * (1 + len(words)))
        if any(not stem and self.lasts(clocks, loop) for stem, loop in words):
            return True
        after: dict[Letter, list[tuple[Word, Word]]] = {}
        for stem, loop in words:
            if stem:
                after.setdefault(stem[0], []).append((stem[1:], loop))
        choices = [self.at_once(clocks, letter) for letter in after]
        if last is not None:
            choices.append(self.waits(clocks, last))
        return any(
            ways and all(way in after and self._suffice(after[way], move.target, way) for way, move in ways.items())
            for ways in choices
        )

    def lasts(self, clocks: Clocks, loop: Word) -> bool:
        """Whether time can go on forever with `loop`: nothing but its letters comes, and they take time."""
        here, last, started, takes_time = clocks, None, set[int](), False
        for letter in loop:
            ways = self.at_once(here, letter)
            if letter not in ways and last is not None:
                ways, takes_time = self.waits(here, last), True
            if list(ways) != [letter]:
                return False
            move = ways[letter]
            started |= {k for k, case in enumerate(move.cases) if starts(here.states[k], case)}
            here, last = move.target, letter
        return here == clocks and (takes_time or self._can_be_held(clocks, loop[-1], started))

    def _can_be_held(self, clocks: Clocks, letter: Letter, started: set[int]) -> bool:
        """Whether a nanosecond more of `letter` changes nothing: no clock runs out that has just `started`."""
        held = self.at_once(clocks, letter - self._news)
        if letter not in held or held[letter].target != clocks:
            return False
        return all(
            k in started and tracker.bounds[0] > 0
            for k, tracker in enumerate(self._time.trackers)
            if tracker.is_running(clocks.states[k])
        )

    def _narrowed(self, among: Among, predicate: Formula) -> Among | None:
        """Those with `predicate`, which tells of open atoms that they hold or not, and nothing else."""
        self._spend(1)
        match predicate:
            case And(left, right):
                first = self._narrowed(among, left)
                return None if first is None else self._narrowed(first, right)
            case Atom(name) if name in among.open:
                return Among(among.letter | {name}, among.open - {name})
            case Not(Atom(name)) if name in among.open:
                return Among(among.letter, among.open - {name})
        return among if finite.holds(predicate, (among.letter,)) else None
