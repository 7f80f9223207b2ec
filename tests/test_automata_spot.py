"""A third construction as an oracle: Spot's own determinising and minimising, which shares none of ours.

`translate` and progression share decision diagrams, minimisation and Spot's emptiness. Here Spot's nondeterministic
automaton is filtered, purged and made a minimal monitor by Spot alone. That is exact, but only for few atoms: it takes
10 s at 20 atoms, and runs out of memory at 24.
"""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given, settings
from strategies import formulas

from ltlc.automata import translate
from ltlc.automata.engine import buddy, spot
from ltlc.semantics import finite
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.ltl import And, Atom, Formula, Next, Not, Or, Truth, Until, eventually, globally
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Letter, Word, all_letters

ATOMS = ("a", "b", "c", "d")


class SpotMonitor:
    """Which words can go on to satisfy a formula, by Spot: the states of a minimal monitor, None where they cannot."""

    def __init__(self, formula: Formula) -> None:
        nondeterministic = spot.translate(spot.formula(spelled(formula)), "any", "low")
        automaton = spot.scc_filter(nondeterministic)
        automaton.purge_dead_states()
        automaton.set_acceptance(0, spot.acc_code("t"))
        self._automaton = spot.minimize_monitor(automaton)
        self._variables = {a: self._automaton.register_ap(f"p{k}") for k, a in enumerate(ATOMS)}
        self.initial = None if nondeterministic.is_empty() else self._automaton.get_init_state_number()

    def step(self, state: int | None, letter: Letter) -> int | None:
        """The state after `letter`."""
        if state is None:
            return None
        guard = buddy.bddtrue
        for atom, variable in self._variables.items():
            guard &= buddy.bdd_ithvar(variable) if atom in letter else buddy.bdd_nithvar(variable)
        found = [edge.dst for edge in self._automaton.out(state) if (edge.cond & guard) != buddy.bddfalse]
        assert len(found) <= 1
        return found[0] if found else None


def spelled(formula: Formula) -> str:
    """`formula` in Spot's syntax, every operator in parentheses."""
    match formula:
        case Truth():
            return "1"
        case Atom(name):
            return f"p{ATOMS.index(name)}"
        case Not(operand):
            return f"!({spelled(operand)})"
        case And(left, right):
            return f"(({spelled(left)}) & ({spelled(right)}))"
        case Or(left, right):
            return f"(({spelled(left)}) | ({spelled(right)}))"
        case Next(operand):
            return f"X({spelled(operand)})"
        case Until(left, right):
            return f"(({spelled(left)}) U ({spelled(right)}))"
    raise TypeError(formula)


def assert_verdicts_are_spots(formula: Formula) -> None:
    """On all words: by walking our monitor and Spot's two side by side."""
    monitor = translate(formula, Alphabet(ATOMS))
    satisfiable, falsifiable = SpotMonitor(formula), SpotMonitor(Not(formula))
    reached: dict[Any, Word] = {(0, satisfiable.initial, falsifiable.initial): ()}
    for (state, can_hold, can_fail), word in (queue := list(reached.items())):
        verdict = monitor.verdicts[state]
        assert (verdict is Verdict.VIOLATED) == (can_hold is None), word
        assert (verdict is Verdict.SATISFIED) == (can_fail is None), word
        assert verdict.is_permanent or verdict.holds == finite.holds(formula, word), word
        for letter in all_letters(ATOMS):
            after = (
                monitor.step(state, letter),
                satisfiable.step(can_hold, letter),
                falsifiable.step(can_fail, letter),
            )
            if after not in reached:
                reached[after] = (*word, letter)
                queue.append((after, reached[after]))


@settings(max_examples=100)
@given(formulas(ATOMS, max_leaves=8))
def test_permanent_verdicts_of_random_formulas_are_those_of_spots_own_construction(formula: Formula) -> None:
    assert_verdicts_are_spots(formula)


@pytest.mark.parametrize(
    "formula",
    [
        And(eventually(Atom("b")), Next(Next(And(globally(Not(Atom("b"))), globally(eventually(Atom("c"))))))),
        And(eventually(globally(Atom("a"))), globally(eventually(Not(Atom("a"))))),
        Not(Truth()),
        Truth(),
    ],
)
def test_formulas_that_break_naive_constructions_are_those_of_spots_own(formula: Formula) -> None:
    assert_verdicts_are_spots(formula)
