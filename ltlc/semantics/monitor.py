"""The monitor: a complete, deterministic Moore machine over letters, whose outputs are the four verdicts.

It is data, without Spot behind it: `ltlc.automata` makes monitors, the gate judges them, the backends write them out.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from ltlc.dataclass import dataclass
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Letter

Target = int
"""Where an edge leads: a state if it is not negative, else the decision with the number `~target`."""


class Decision(NamedTuple):
    """A question about one atom of the letter: go on with `high` if it holds, else with `low`."""

    atom: int
    low: Target
    high: Target


@dataclass(frozen=True, slots=True)
class Monitor:
    """A monitor of one property.

    States are numbered from 0, the initial one; `verdicts[q]` is the output of state q. For the initial state that is
    the verdict on the empty word. `edges[q]` says where a letter leads from q: through `decisions`, which are shared
    between states, ask atoms in the order of `atoms` (that of first use in the property), each at most once, and only
    those that matter. Letters that the alphabet excludes lead anywhere.

    Monitors are minimal and numbered canonically (breadth first, the smallest letter first): two monitors of the same
    property over the same alphabet are equal as data.
    """

    atoms: tuple[str, ...]
    verdicts: tuple[Verdict, ...]
    edges: tuple[Target, ...]
    decisions: tuple[Decision, ...]

    def step(self, state: int, letter: Letter) -> int:
        """The state after `letter`."""
        target = self.edges[state]
        while target < 0:
            decision = self.decisions[~target]
            target = decision.high if self.atoms[decision.atom] in letter else decision.low
        return target

    def run(self, word: Iterable[Letter]) -> list[Verdict]:
        """The verdict after each letter of `word`."""
        state = 0
        verdicts = []
        for letter in word:
            state = self.step(state, letter)
            verdicts.append(self.verdicts[state])
        return verdicts


def below(decisions: Sequence[Decision], targets: Iterable[Target]) -> list[Target]:
    """These targets, and all that decisions lead to from them, each once."""
    found = dict.fromkeys(targets)
    todo = list(found)
    for target in todo:
        for after in decisions[~target][1:] if target < 0 else ():
            if after not in found:
                found[after] = None
                todo.append(after)
    return todo
