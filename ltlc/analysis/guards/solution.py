"""Where guards may rest: the greatest region of an arena, as a greatest fixed point on decision diagrams.

Every guard with the same fallbacks that is sure to keep the properties rests nowhere else, as far as letters tell, and
whichever of several clocks passes its bound first (Coq: `necessary`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import field
from functools import cached_property

from ltlc.analysis.guards.game import Game, Step
from ltlc.dataclass import dataclass
from ltlc.semantics.arenas import Arena, Joint, Outcome, Region, Ticks
from ltlc.semantics.diagrams import Diagram, formulas
from ltlc.semantics.ltl import Atom


class TooManyPlacesError(RuntimeError):
    """The game has more joint places than it may."""


@dataclass
class Solution:
    """The game on an arena with a region: what is asked of one, whether it is the greatest yet or not."""

    game: Game
    rests: Mapping[Joint, Diagram]
    wider: Solution | None = None
    """The region before, of which this one has what is safe; None of the first, which has all that is not violated."""
    _answered: dict[Joint, Diagram] = field(default_factory=dict)

    def resting(self, joint: Joint) -> Diagram:
        """The letters at which the guards may rest there."""
        return self.rests.get(joint, self.game.diagrams.false)

    def answers(self, joint: Joint) -> Iterator[tuple[int, Diagram]]:
        """The letters after which a fallback may be sent at once, by its number."""
        return self._sending(joint, self.sent_well)

    def sent_well(self, step: Step) -> Diagram:
        """The letters at which it is good to have sent something: the guards may rest, and broke no assumption."""
        is_over = self.game.arena.outcome(step.joint) is not None
        return self.game.diagrams.false if is_over else self.resting(step.joint)

    def answered(self, joint: Joint) -> Diagram:
        """The letters after which the guards may rest, or send a fallback at once."""
        if joint not in self._answered:
            answers = (letters for _, letters in self.answers(joint))
            self._answered[joint] = self.game.any_of((self.resting(joint), *answers))
        return self._answered[joint]

    def acts(self, joint: Joint, passing: Ticks) -> Iterator[tuple[int, Diagram]]:
        """The letters at which a fallback may be sent before the clocks `passing` pass their bounds.

        Whenever those pass that it neither stopped nor started anew, the guards have an answer, without another one
        ahead: otherwise they could send for ever at one moment.
        """

        def safe(step: Step) -> Diagram:
            left = passing - step.fresh
            late = {s: letters for s, letters in self.game.steps(step.joint, None).items() if s.passing & left}
            good = self.game.before_message(None, self.game.lead_to(late, self._is_answered))
            return self.game.diagrams.conjunction(self.sent_well(step), good)

        return self._sending(joint, safe)

    def _sending(self, joint: Joint, good: Callable[[Step], Diagram]) -> Iterator[tuple[int, Diagram]]:
        if joint.sent is None or self.game.arena.outcome(joint) is not None:
            return
        for number, fallback in enumerate(self.game.arena.fallbacks):
            led = self.game.lead_to(self.game.steps(joint, fallback.out), good)
            yield number, self.game.before_fallback(fallback, led)

    def _is_answered(self, step: Step) -> Diagram:
        return self.answered(step.joint)

    def safe(self, joint: Joint) -> Diagram:
        """The letters at which, whatever message comes and whatever clocks pass, there is an answer."""
        game = self.game
        messages = (
            game.before_message(topic, game.lead_to(game.steps(joint, topic), self._is_answered))
            for topic in game.arena.others
        )
        return game.all_of((*messages, self._safe_in_time(joint)))

    def _safe_in_time(self, joint: Joint) -> Diagram:
        game, found = self.game, self.game.diagrams.true
        for passing, steps in by_clocks(game.steps(joint, None)).items():
            good = game.before_message(None, game.lead_to(steps, self._is_answered))
            if passing and good != game.diagrams.true:
                good = game.any_of((good, *(letters for _, letters in self.acts(joint, passing))))
            found = game.diagrams.conjunction(found, good)
        return found

    def narrowed(self) -> Solution:
        """What is safe of it; itself, if all is."""
        outcome = self.game.arena.outcome
        rests = {
            joint: self.game.diagrams.conjunction(letters, self.safe(joint)) if outcome(joint) is None else letters
            for joint, letters in self.rests.items()
        }
        return self if rests == self.rests else Solution(self.game, rests, self)

    @cached_property
    def visited(self) -> Mapping[Joint, Diagram]:
        """The joint places to which guards that keep to the region can come, and the letters that lead there.

        Until all properties have begun, nothing but fallbacks leaves them.
        """
        game, arena, found = self.game, self.game.arena, {self.game.arena.start: self.game.possible}
        for joint in (queue := list(found)):
            if arena.outcome(joint) is not None:
                continue
            for topic in (None, *arena.others, *(() if joint.sent is None else arena.outs)):
                for step, letters in game.steps(joint, topic).items():
                    good = game.diagrams.conjunction(letters, self._comes_to(step, topic))
                    if game.exists(good):
                        if step.joint not in found:
                            queue.append(step.joint)
                        found[step.joint] = game.any_of((found.get(step.joint, game.diagrams.false), good))
        return found

    def _comes_to(self, step: Step, topic: str | None) -> Diagram:
        """The letters at which guards let a step happen."""
        arena = self.game.arena
        if topic not in arena.outs:
            return self.answered(step.joint)
        has_fallback = any(sending.out == topic for sending in arena.fallbacks)
        is_possible = has_fallback or Outcome.WAITING not in step.joint.standings
        return self.sent_well(step) if is_possible else self.game.diagrams.false

    def commands(self, out: str) -> Iterator[tuple[Step, Diagram]]:
        """The steps by commands on the topic `out`, from where the guards may rest once all properties have begun."""
        game = self.game
        for joint, letters in self.visited.items():
            if joint.sent is not None and game.arena.outcome(joint) is None:
                before = game.after_message(out, game.diagrams.conjunction(letters, self.resting(joint)))
                for step, led in game.steps(joint, out).items():
                    if Outcome.WAITING not in step.joint.standings:
                        yield step, game.all_of((before, led, game.possible))

    def let_through(self, out: str) -> Diagram:
        """The letters after some message on the topic `out` that is let through, wherever the guards rested before."""
        d = self.game.diagrams
        return self.game.any_of(d.conjunction(letters, self.sent_well(step)) for step, letters in self.commands(out))

    def region(self) -> Region:
        """As data, for checkers and for what runs."""
        game, false = self.game, self.game.diagrams.false
        formula = formulas(lambda level: Atom(game.atoms[level]), game.diagrams)
        rests = {joint: letters for joint, letters in self.rests.items() if game.exists(letters)}
        inside = [joint for joint in rests if game.arena.outcome(joint) is None]
        answers = {
            (joint, number): game.diagrams.conjunction(letters, game.diagrams.negation(self.resting(joint)))
            for joint in self.rests
            for number, letters in self.answers(joint)
        }
        acts = {
            (joint, passing, number): letters
            for joint in inside
            for passing, steps in by_clocks(game.steps(joint, None)).items()
            if passing and game.before_message(None, game.lead_to(steps, self._is_answered)) != game.diagrams.true
            for number, letters in self.acts(joint, passing)
        }
        return Region(
            {joint: formula(letters) for joint, letters in rests.items()},
            {key: formula(letters) for key, letters in answers.items() if letters != false},
            {key: formula(letters) for key, letters in acts.items() if letters != false},
        )


def by_clocks(steps: Mapping[Step, Diagram]) -> dict[Ticks, dict[Step, Diagram]]:
    """The steps of time by the clocks that pass their bounds."""
    found: dict[Ticks, dict[Step, Diagram]] = {}
    for step, letters in steps.items():
        found.setdefault(step.passing, {})[step] = letters
    return found


MOST_PLACES = 20_000
"""A game with more joint places is not solved."""


def solve(arena: Arena) -> Solution:
    """The greatest region of `arena`. Raises TooManyPlacesError."""
    game, violated = Game(arena), Outcome.VIOLATED
    rests = {joint: game.diagrams.terminal(arena.outcome(joint) is not violated) for joint in reachable(game)}
    solution = Solution(game, rests)
    while (narrowed := solution.narrowed()) is not solution:
        solution = narrowed
    return solution


def reachable(game: Game) -> Iterable[Joint]:
    """The joint places that can be reached without a guard."""
    found = {game.arena.start: None}
    for joint in (queue := list(found)):
        if game.arena.outcome(joint) is not None:
            continue
        sending = () if joint.sent is None else game.arena.outs
        for topic in (None, *sending, *game.arena.others):
            for step, letters in game.steps(joint, topic).items():
                if step.joint not in found and game.exists(letters):
                    found[step.joint] = None
                    queue.append(step.joint)
                    if len(found) > MOST_PLACES:
                        raise TooManyPlacesError(f"has more than {MOST_PLACES:,} places")
    return found
