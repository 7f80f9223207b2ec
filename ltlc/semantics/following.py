"""Whether a control follows a monitor: whether both show the same verdict after every run.

The pairs of states in which the two can be are given, and need not be trusted: in each, both have to show the same, and
every letter that is allowed has to lead to such a pair again. A control that sets a clock is refused: properties with
clocks are not covered yet.

Coq: `proofs/Follows.v`, with the same names, and the proof that the answer may be believed: `follows_monitor_sound`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

from ltlc.semantics.certificate import DEPTH, WORK
from ltlc.semantics.conditions import FALSE_CONDITION, Bound, Condition, Conditions, Memory
from ltlc.semantics.control import Followed, Outcome, Pair, Way
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Monitor, Target

Result = TypeVar("Result")

Answered = Mapping[str, bool]
"""The atoms that have been asked for on the way. Coq: `answered`."""


@dataclass(frozen=True, slots=True)
class Following:
    """Whether the control is shown to follow the monitor; if not, the bound that was `met`, if any."""

    follows: bool
    met: Bound | None = None


def follows_monitor(
    assumption: Formula, monitor: Monitor, followed: Followed, depth: int = DEPTH, work: int = WORK
) -> Following:
    """Whether `followed` shows the verdicts of `monitor` over the letters that satisfy `assumption`.

    Coq: `follows_monitor`.
    """
    checker = _Checker(assumption, monitor, followed, depth, work)
    follows = checker.is_right()
    return Following(follows, None if follows else checker.memory.met)


class _Decides(NamedTuple):
    """A question with what follows 'yes' and 'no'. Coq: `Decides`."""

    asked: str | int
    if_so: int
    if_not: int


class _Checker:
    def __init__(self, assumption: Formula, monitor: Monitor, followed: Followed, depth: int, work: int) -> None:
        self.control, self.monitor = followed.control, monitor
        self.pairs = frozenset(followed.pairs)
        self.depth = depth
        self.conditions = Conditions()
        self.memory = Memory(work)
        self.allowed = self.conditions.unfold(assumption)

    def is_right(self) -> bool:
        return (
            Pair(0, 0) in self.pairs
            and not self.control.first_due
            and all(self.pair_is_right(pair) for pair in sorted(self.pairs))
        )

    def pair_is_right(self, pair: Pair) -> bool:
        """Coq: `pair_is_right`."""
        stance = self.control.stances[pair.state]
        if stance.verdict is not self.monitor.verdicts[pair.judged]:
            return False
        return self.lead_to_pairs(stance.step, self.monitor.edges[pair.judged])

    def lead_to_pairs(self, way: Way, target: Target) -> bool:
        """Whether every letter that is allowed leads from both to a pair. Coq: `lead_to_pairs`."""

        def ends(outcome: Outcome, known: Answered, letters: Condition) -> bool:
            def judges(judged: int, _: Answered, letters: Condition) -> bool:
                sets_nothing = not outcome.settings and not outcome.again
                return sets_nothing and self.by_cases(
                    self.depth, letters, lambda: Pair(outcome.state, judged) in self.pairs
                )

            return self.walk(self.look_of_monitor, self.depth, target, known, letters, judges)

        return self.walk(self.look_of_control, self.depth, way, {}, self.allowed, ends)

    def look_of_control(self, way: Way) -> Outcome | _Decides:
        """Coq: `look_of_program`."""
        return self.control.outcomes[way] if way >= 0 else _Decides(*self.control.branches[~way])

    def look_of_monitor(self, target: Target) -> int | _Decides:
        """Coq: `look_of_monitor`."""
        if target >= 0:
            return target
        atom, low, high = self.monitor.decisions[~target]
        return _Decides(self.monitor.atoms[atom], high, low)

    def walk(
        self,
        look: Callable[[int], Result | _Decides],
        fuel: int,
        node: int,
        known: Answered,
        letters: Condition,
        judge: Callable[[Result, Answered, Condition], bool],
    ) -> bool:
        """Whether `judge` accepts every end to which `letters` lead that answer as is `known`. Coq: `walk`."""
        if letters == FALSE_CONDITION:
            return True
        if not self.memory.descend(fuel) or not self.memory.spend(self.conditions.node(letters).weight):
            return False
        seen = look(node)
        if not isinstance(seen, _Decides):
            return judge(seen, known, letters)
        match seen.asked:
            case int():  # no clock runs
                return self.walk(look, fuel - 1, seen.if_not, known, letters, judge)
            case atom if atom in known:
                after = seen.if_so if known[atom] else seen.if_not
                return self.walk(look, fuel - 1, after, known, letters, judge)
            case atom:
                fact = self.conditions.fact_of_atom(atom)
                return all(
                    self.walk(
                        look, fuel - 1, after, {**known, atom: v}, self.conditions.assign(fact, v, letters), judge
                    )
                    for v, after in ((True, seen.if_so), (False, seen.if_not))
                )

    def by_cases(self, fuel: int, letters: Condition, judge: Callable[[], bool]) -> bool:
        """Whether `judge` accepts, or `letters` turn out to be none. Coq: `by_cases`."""
        if letters == FALSE_CONDITION:
            return True
        atom = self.conditions.node(letters).first_atom
        if fuel == 0 or atom is None or not self.memory.spend(self.conditions.node(letters).weight):
            return judge()
        fact = self.conditions.fact_of_atom(atom)
        return judge() or all(
            self.by_cases(fuel - 1, self.conditions.assign(fact, value, letters), judge) for value in (True, False)
        )
