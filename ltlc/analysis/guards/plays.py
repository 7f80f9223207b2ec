"""How the world breaks a property that no guard with these fallbacks can keep any more: a shortest play."""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.guards.game import Game, Step
from ltlc.analysis.guards.solution import Solution, by_clocks
from ltlc.dataclass import dataclass
from ltlc.semantics.arenas import Joint, Outcome
from ltlc.semantics.diagrams import Diagram
from ltlc.semantics.words import Letter


@dataclass(frozen=True, slots=True)
class Turn:
    """A message on `topic`, or time if it is None, leads by `step` to where `letter` is held.

    It is in `vain` to send one of these fallbacks, by number, then or before clocks pass: something is violated all the
    same, at once or later.
    """

    topic: str | None
    step: Step
    letter: Letter
    vain: tuple[int, ...]


def play(solution: Solution, joint: Joint, letter: Letter) -> list[Turn]:
    """The moves of the world from where the guards may not rest, if these are silent, to a violation."""
    turns: list[Turn] = []
    while solution.game.arena.outcome(joint) is not Outcome.VIOLATED:
        while solution.wider is not None and not _holds(solution, solution.wider.resting(joint), letter):
            solution = solution.wider
        assert solution.wider is not None, "what is not violated is in the first region"
        turn = next(_breaking(solution.wider, joint, letter))
        turns.append(turn)
        joint, letter = turn.step.joint, turn.letter
    return turns


def _breaking(wider: Solution, joint: Joint, letter: Letter) -> Iterator[Turn]:
    """The moves after which the guards have no answer in a region; those that violate something at once first."""
    found = [turn for topic in (None, *wider.game.arena.others) for turn in _moves(wider, joint, letter, topic)]
    return iter(sorted(found, key=lambda turn: wider.game.arena.outcome(turn.step.joint) is not Outcome.VIOLATED))


def _moves(wider: Solution, joint: Joint, letter: Letter, topic: str | None) -> Iterator[Turn]:
    game = wider.game
    kept = {a for a, of in game.arena.read.items() if topic not in of} - game.arena.loose
    for passing, steps in by_clocks(game.steps(joint, topic)).items():
        if passing and any(_holds(wider, letters, letter) for _, letters in wider.acts(joint, passing)):
            continue
        for step, letters in steps.items():
            lost = game.diagrams.conjunction(letters, game.diagrams.negation(wider.answered(step.joint)))
            after = letter_of(game, lost, {atom: atom in letter for atom in kept})
            if after is not None:
                tried = wider.acts(joint, passing) if passing else wider.answers(step.joint)
                yield Turn(topic, step, after, tuple(number for number, _ in tried))


def letter_of(game: Game, letters: Diagram, answers: dict[str, bool]) -> Letter | None:
    """One of the `letters` that exist which gives these `answers`; None if there is none."""
    known = {level: answers[atom] for level, atom in enumerate(game.atoms) if atom in answers}
    left = game.diagrams.given(known, game.diagrams.conjunction(letters, game.possible))
    found = next((path for path, holds in game.diagrams.paths(left) if holds), None)
    if found is None:
        return None
    return frozenset(atom for level, atom in enumerate(game.atoms) if (known | found).get(level))


def _holds(solution: Solution, letters: Diagram, letter: Letter) -> bool:
    game = solution.game
    return bool(game.diagrams.evaluate(letters, lambda level: game.atoms[level] in letter))
