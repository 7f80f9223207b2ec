"""Why guards do not let a command through after which nothing is violated yet: the play that they avoid, in numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
from functools import cached_property

from ltlc.analysis.examples import Setting, rows_of
from ltlc.analysis.guards.passing import condition_text, move_of, rows_along, word_of
from ltlc.analysis.guards.plays import Turn, letter_of, play
from ltlc.analysis.guards.solution import Solution
from ltlc.analysis.letters import letters_of
from ltlc.analysis.thresholds import Values
from ltlc.dataclass import dataclass
from ltlc.runtime.plays import Move, Play
from ltlc.runtime.sampling import Value
from ltlc.semantics.arenas import Joint
from ltlc.semantics.words import Letter
from ltlc.specification.atoms import Atom
from ltlc.specification.expressions import Current, Read
from ltlc.specification.specification import topics_of
from ltlc.specification.text import text


@dataclass(frozen=True)
class _Found:
    """A play from where `letter` is held, and values along it, if there are any."""

    letter: Letter
    turns: list[Turn]
    rows: list[Values] | None


def setting_of(conditions: Mapping[str, Atom], *, is_known: bool) -> Setting:
    """What numbers for runs are found with in which `conditions` are followed, if `is_known` what they read."""
    atoms = tuple(conditions.values())
    return Setting(atoms, letters_of([atoms], lambda _: None), linked=False, openings={}, counts=not is_known)


@dataclass
class Reasons:
    """The plays that guards avoid that follow `conditions`, as their game is solved; each is looked for once."""

    solution: Solution
    conditions: Mapping[str, Atom]
    _known: dict[tuple[Joint, Letter, frozenset[str]], _Found | None] = field(default_factory=dict)

    @cached_property
    def _setting(self) -> Setting:
        return setting_of(self.conditions, is_known=not self.solution.game.arena.loose)

    def __call__(
        self, joint: Joint, letter: Letter, unknown: frozenset[str], values: Mapping[Read, Value]
    ) -> Play | None:
        """A shortest play from `joint`, where the atoms in `letter` hold, and what is read has these `values`.

        It is not known whether the `unknown` atoms hold. None where the guards may rest.
        """
        key = (joint, letter, unknown)
        if key not in self._known:
            self._known[key] = self._found(*key)
        found = self._known[key]
        if found is None:
            return None
        rows = None
        if found.rows is not None:
            held = [{**found.rows[0], **values}, *found.rows[1:]]
            rows = rows_along(self._setting, found.letter, found.turns, held)
        told = [{}] * len(found.turns) if rows is None else map(_told, found.turns, rows[1:])
        before = [found.letter, *(turn.letter for turn in found.turns)]
        return Play(tuple(map(self._move, before, found.turns, told)))

    def _move(self, before: Letter, turn: Turn, values: Mapping[str, Value]) -> Move:
        """A turn from where the letter `before` is held; what may change at any instant is said as a condition."""
        move = move_of(self.solution.game.arena, turn, values)
        changed = sorted((before ^ turn.letter) & self.solution.game.arena.loose)
        words = [condition_text(name, self.conditions, holds=name in turn.letter) for name in changed]
        return replace(move, event=f"{move.event}, if then {' and '.join(words)}") if words else move

    def _found(self, joint: Joint, letter: Letter, unknown: frozenset[str]) -> _Found | None:
        game, d = self.solution.game, self.solution.game.diagrams
        answers = {atom: atom in letter for atom in game.atoms if atom not in unknown}
        held = letter_of(game, d.negation(self.solution.resting(joint)), answers)
        if held is None:
            return None
        turns = play(self.solution, joint, held)
        return _Found(held, turns, rows_of(self._setting, word_of(self._setting, held, turns), None))


def _told(turn: Turn, row: Values) -> dict[str, Value]:
    """What the message of a turn says."""
    own = (read for read in row if isinstance(read, Current) and turn.topic in topics_of(read.signal))
    return {text(read): row[read] for read in own}
