"""The pairs of states in which a control and its monitor can be at the same time. Untrusted.

`ltlc.semantics.following` has the last word on whether the control follows the monitor.
"""

from __future__ import annotations

from ltlc.assurance.controls import control_of
from ltlc.compiler import Compiled
from ltlc.semantics.control import Control, Followed, Pair, Way
from ltlc.semantics.diagrams import Diagram, Diagrams, of_predicate
from ltlc.semantics.ltl import Formula, atoms
from ltlc.semantics.monitor import Monitor, Target
from ltlc.semantics.timed_atoms import timed_atoms


def is_covered(compiled: Compiled) -> bool:
    """Whether it can be checked that the control of `compiled` follows its monitor: with clocks, it cannot yet."""
    return not timed_atoms(compiled.formula)


def followed(compiled: Compiled, assumption: Formula) -> Followed | None:
    """The control of `compiled`, with its pairs over the letters that satisfy `assumption`; None if not covered."""
    if not is_covered(compiled):
        return None
    control = control_of(compiled.program)
    return Followed(control, pairs_of(control, compiled.monitor, assumption))


def pairs_of(control: Control, monitor: Monitor, assumption: Formula) -> tuple[Pair, ...]:
    """Every pair to which letters of `assumption` lead, from the initial states on."""
    return tuple(_Search(control, monitor, assumption).pairs())


class _Search:
    def __init__(self, control: Control, monitor: Monitor, assumption: Formula) -> None:
        self.control, self.monitor = control, monitor
        self.diagrams = Diagrams()
        asked = [branch.asked for branch in control.branches if isinstance(branch.asked, str)]
        self.levels = {name: n for n, name in enumerate(dict.fromkeys([*monitor.atoms, *asked, *atoms(assumption)]))}
        self.allowed = of_predicate(assumption, self.diagrams, self.levels)
        self.ways: dict[Way, Diagram] = {}
        self.targets: dict[Target, Diagram] = {}

    def pairs(self) -> list[Pair]:
        found = [Pair(0, 0)]
        seen = set(found)
        for state, judged in found:
            step = self.of_way(self.control.stances[state].step)
            together = self.diagrams.combine(Pair, step, self.of_target(self.monitor.edges[judged]))
            for after in self.diagrams.values(self.diagrams.choose(self.allowed, together, self.diagrams.false)):
                if after is not False and after not in seen:
                    seen.add(after)
                    found.append(after)
        return found

    def of_way(self, way: Way) -> Diagram:
        """Where letters lead from `way`, as a diagram whose values are states of the control."""
        if way not in self.ways:
            if way >= 0:
                self.ways[way] = self.diagrams.terminal(self.control.outcomes[way].state)
            else:
                asked, if_so, if_not = self.control.branches[~way]
                assert isinstance(asked, str), "no clock is asked"
                self.ways[way] = self.asking(asked, self.of_way(if_so), self.of_way(if_not))
        return self.ways[way]

    def of_target(self, target: Target) -> Diagram:
        """Where letters lead from `target`, as a diagram whose values are states of the monitor."""
        if target not in self.targets:
            if target >= 0:
                self.targets[target] = self.diagrams.terminal(target)
            else:
                atom, low, high = self.monitor.decisions[~target]
                self.targets[target] = self.asking(self.monitor.atoms[atom], self.of_target(high), self.of_target(low))
        return self.targets[target]

    def asking(self, atom: str, if_so: Diagram, if_not: Diagram) -> Diagram:
        return self.diagrams.choose(self.diagrams.variable(self.levels[atom]), if_so, if_not)
