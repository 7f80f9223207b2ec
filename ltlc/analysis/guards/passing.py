"""What commands pass: for each set of guards in one game, its solution and the questions that `check` puts to it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache, cached_property

from ltlc.analysis.atom_words import atom_text
from ltlc.analysis.errors import NotDecidedError
from ltlc.analysis.examples import Example, Setting, rows_of, shown
from ltlc.analysis.guards.controls import with_any_command
from ltlc.analysis.guards.game import Game, Step
from ltlc.analysis.guards.plays import Turn, letter_of, play
from ltlc.analysis.guards.solution import Solution, TooManyPlacesError, solve
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.thresholds import Values
from ltlc.analysis.wording import listed
from ltlc.automata import translate
from ltlc.dataclass import dataclass
from ltlc.runtime.plays import Move
from ltlc.runtime.sampling import Value
from ltlc.semantics.arenas import Arena, Outcome, Part, Ticks
from ltlc.semantics.diagrams import Diagram, Diagrams
from ltlc.semantics.durations import duration_text
from ltlc.semantics.words import Letter
from ltlc.specification import evaluation
from ltlc.specification.arenas import Property, arena_of, conditions_held, is_in_game, together
from ltlc.specification.atoms import Atom
from ltlc.specification.expressions import Current, Past
from ltlc.specification.guards import Guard
from ltlc.specification.specification import topics_of


@dataclass(frozen=True)
class Guarded:
    """Guards in one game, and the properties in it; with `any_command` they may send whatever exists."""

    study: Study
    guards: tuple[Guard, ...]
    subjects: tuple[Subject, ...]
    any_command: bool = False

    @cached_property
    def solution(self) -> Solution:
        """The game, solved. Raises NotDecidedError."""
        arena = arena_of(self.guards, self._properties())
        try:
            return solve(with_any_command(arena) if self.any_command else arena)
        except TooManyPlacesError as error:
            raise NotDecidedError(f"the game {error}") from None

    def passes(self, out: str) -> bool:
        """Whether anything is ever let through on the topic `out`."""
        return self.solution.let_through(out) != self.solution.game.diagrams.false

    def _properties(self) -> Iterator[Property]:
        for subject in self.subjects:
            if subject.monitor is None:
                raise NotDecidedError(f"`{subject.label}` has no monitor")
            # z3 may know fewer letters than those that run; over these some atoms say nothing that fallbacks decide.
            letters = subject.specification.alphabet
            is_same = subject.alphabet == letters
            monitor = subject.monitor if is_same else _translated(subject.formula, letters)
            yield Property(subject.specification, subject.formula, monitor)

    @property
    def may_be_strict(self) -> bool:
        """Whether the game may be lost only because it does not know which of several clocks ends first."""
        return self.solution.game.arena.has_several_clocks

    @property
    def kept(self) -> tuple[Subject, ...]:
        """The properties that are kept."""
        return tuple(subject for subject in self.subjects if not subject.specification.is_assumed)

    def without(self, left_out: Subject) -> Guarded:
        """The same guards with a property less."""
        return replace(self, subjects=tuple(each for each in self.subjects if each is not left_out))

    def because_of(self, holds: Callable[[Guarded], bool]) -> Guarded:
        """As few of the kept properties as go, of which what `holds` of all of them still does."""
        found = self
        for subject in self.kept:
            fewer = found.without(subject)
            if fewer.kept and holds(fewer):
                found = fewer
        return found


_translated = cache(translate)
"""For games without one property after the other, the monitors of the others are made once."""


def games(study: Study) -> list[Guarded]:
    """The games of the guards of a specification that have something to keep."""
    specification = study.specification
    found = (game_of(study, guards) for guards in together(specification.guards, specification.properties))
    return [each for each in found if each.kept]


def game_of(study: Study, guards: tuple[Guard, ...], *, any_command: bool = False) -> Guarded:
    """The game of `guards` with the properties that they keep or rely on."""
    subjects = tuple(subject for subject in study.subjects if is_in_game(subject.specification, guards))
    return Guarded(study, guards, subjects, any_command)


def of_commands(game: Game, letters: Diagram, out: str) -> Diagram:
    """What `letters` say of commands alone: some values of everything else go with them."""
    others = [level for level, atom in enumerate(game.atoms) if game.arena.read[atom] != {out}]
    for level in others:
        letters = game.any_of(game.diagrams.given({level: holds}, letters) for holds in (False, True))
    return letters


def harmless(solution: Solution, out: str) -> Iterator[tuple[Step, Diagram]]:
    """The steps by commands on `out`, from where the guards may rest, that violate nothing by themselves."""
    outcome = solution.game.arena.outcome
    return ((step, letters) for step, letters in solution.commands(out) if outcome(step.joint) is None)


def held_back(solution: Solution, out: str) -> Diagram:
    """The commands that violate nothing by themselves and are never let through."""
    game, d = solution.game, solution.game.diagrams
    may = of_commands(game, game.any_of(letters for _, letters in harmless(solution, out)), out)
    return d.conjunction(may, d.negation(of_commands(game, solution.let_through(out), out)))


def shortest_play(solution: Solution, out: str, commands: Diagram) -> tuple[Letter, list[Turn]] | None:
    """What is held after one of `commands` that is held back, and a shortest way in which it would end badly."""
    d, found = solution.game.diagrams, []
    for step, letters in harmless(solution, out):
        bad = d.conjunction(d.conjunction(letters, commands), d.negation(solution.resting(step.joint)))
        letter = letter_of(solution.game, bad, {})
        if letter is not None:
            found.append((letter, play(solution, step.joint, letter)))
    return min(found, key=lambda each: len(each[1]), default=None)


def in_words(guarded: Guarded, letters: Diagram) -> str:
    """Some letters in the words of their conditions, to go on with; of several sorts, one of the simplest."""
    game = guarded.solution.game
    atoms = conditions_held(guarded.guards, (subject.specification for subject in guarded.subjects))
    sort = _simplest(game.diagrams, letters)
    others = (game.diagrams.given({level: not holds}, letters) for level, holds in sort.items())
    is_all = all(other == game.diagrams.false for other in others)
    words = dict.fromkeys(condition_text(game.atoms[level], atoms, holds=answer) for level, answer in sort.items())
    return f"{'' if is_all else ', for example'} where {' and '.join(words) or 'anything holds'}"


def _simplest(diagrams: Diagrams, letters: Diagram) -> dict[int, bool]:
    """A shortest way through a diagram to where it is true: the levels with their answers."""

    @cache
    def shortest(node: Diagram) -> dict[int, bool] | None:
        if diagrams.is_terminal(node):
            return {} if diagrams.value(node) else None
        level, low, high = diagrams.split(node)
        found = [{level: h, **rest} for h, side in ((False, low), (True, high)) if (rest := shortest(side)) is not None]
        return min(found, key=len, default=None)

    return shortest(letters) or {}


def condition_text(name: str, atoms: Mapping[str, Atom], *, holds: bool) -> str:
    """A condition in words; a count has its name."""
    return atom_text(atoms[name], holds) if name in atoms else f"`{name}` {'holds' if holds else 'does not hold'}"


def example(guarded: Guarded, first: Letter, turns: Sequence[Turn], caption: str) -> Example | None:
    """A play as a run with numbers, whose first row is a command; None if no numbers for it are found."""
    arena = guarded.solution.game.arena
    conditions = conditions_held(guarded.guards, (subject.specification for subject in guarded.subjects))
    own = guarded.study.setting(*guarded.subjects)
    setting = replace(own, atoms=tuple({**{atom.name: atom for atom in own.atoms}, **conditions}.values()))
    found = rows_of(setting, word_of(setting, first, turns), None)
    rows = None if found is None else rows_along(setting, first, turns, found)
    if rows is None:
        return None
    columns = [name for name in shown(setting, rows)[0] if not name.startswith("new ")]
    values_shown = tuple(tuple(row[name] for name in columns) for row in shown(setting, rows))
    return Example(caption, tuple(columns), values_shown, ("the command", *(_remark(arena, turn) for turn in turns)))


def word_of(setting: Setting, first: Letter, turns: Sequence[Turn]) -> tuple[Letter, ...]:
    """The letters along a play, those of the atoms that `setting` has."""
    held = {atom.name for atom in setting.atoms}
    return tuple(letter & held for letter in (first, *(turn.letter for turn in turns)))


def rows_along(
    setting: Setting, first: Letter, turns: Sequence[Turn], rows: Sequence[Values], *, linked: bool = False
) -> list[Values] | None:
    """`rows` along a play, where each message changes what is read on its topic; None if those are other letters.

    If `linked`, the sample before is that of the row before.
    """
    found: list[Values] = []
    topics = (None, *(turn.topic for turn in turns))
    for topic, letter, row in zip(topics, word_of(setting, first, turns), rows, strict=True):
        values = {v: now if not found or topic in topics_of(v.signal) else found[-1][v] for v, now in row.items()}
        if linked and found:
            pasts = (v for v in row if isinstance(v, Past) and v.samples == 1 and topic in topics_of(v.signal))
            values |= {v: found[-1].get(Current(v.signal), values[v]) for v in pasts}
        if evaluation.letter(setting.atoms, values) != letter:
            return None
        found.append(values)
    return found


def move_of(arena: Arena, turn: Turn, values: Mapping[str, Value]) -> Move:
    """What happens in a turn, in words, with some `values`."""
    event = _time(arena.parts, turn.step.passing) if turn.topic is None else f"a message on {turn.topic}"
    parts = zip(arena.parts, turn.step.joint.standings, strict=True)
    violated = tuple(part.label for part, at in parts if at is Outcome.VIOLATED and not part.is_assumed)
    is_tried = turn.step.passing or not violated
    tried = (arena.fallbacks[number].name for number in turn.vain if is_tried)
    return Move(event, values, violated, tuple(filter(None, tried)), is_deadline=bool(turn.step.passing))


def _remark(arena: Arena, turn: Turn) -> str:
    move = move_of(arena, turn, {})
    violated = [f"`{label}`" for label in move.violated]
    is_violated = f": {listed(violated)} {'is' if len(violated) == 1 else 'are'} violated" if violated else ""
    return "; ".join([f"{move.event}{is_violated}", *move.vain()])


def _time(parts: Sequence[Part], passing: Ticks) -> str:
    """That some clocks pass a bound."""
    bounds = {parts[part].time.trackers[tracker].bounds[-1] for part, tracker in passing}
    return (
        f"more than {listed([duration_text(bound) for bound in sorted(bounds)])} later"
        if bounds
        else "an instant later"
    )
