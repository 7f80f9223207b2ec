"""From core LTL to the monitor by Spot: what can still be satisfied, what can still fail, what holds if it ends here.

Three automata read the run side by side: the exact safety closures of the formula and of its negation, for the
permanent verdicts, and the automaton of its finite words, for the presumable ones. Spot makes them nondeterministic;
determinising, multiplying and minimising are done on decision diagrams in `machine`.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import Any, assert_never

from ltlc.automata.engine import buddy, spot
from ltlc.automata.machine import (
    Automaton,
    Letters,
    Machine,
    Move,
    RunsInTime,
    TooManyStatesError,
    determinise,
    letters_of,
    minimise,
    successor_sets,
    to_monitor,
    verdict_machine,
)
from ltlc.semantics import finite
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.diagrams import Diagram
from ltlc.semantics.ltl import And, Atom, Formula, Next, Not, Or, Truth, Until
from ltlc.semantics.monitor import Monitor

SMALL_POWERSET = 5000
"""States of a determinised automaton above which Spot is asked for a smaller, slower nondeterministic one."""

FAST = (spot.postprocessor.Small, spot.postprocessor.Low)
REDUCED = (spot.postprocessor.Small, spot.postprocessor.High)


def translate(formula: Formula, alphabet: Alphabet) -> Monitor:
    """The canonical minimal monitor of `formula` over the letters of `alphabet`."""
    session = Session(letters_of(formula, alphabet))
    return to_monitor(
        verdict_machine(
            session.satisfiable(formula),
            session.satisfiable(Not(formula)),
            session.finitely_satisfied(formula),
            finite.holds(formula, ()),
        )
    )


class Session:
    """One formula's dealings with Spot.

    Atoms are called p0, p1, … there, because Spot reads names such as `Fault` as operators. Every session has BDD
    variables of its own, in the order of the atoms, so that results do not depend on what was translated before.
    """

    def __init__(self, letters: Letters) -> None:
        self.letters = letters
        self._dict = spot.make_bdd_dict()
        self._registry = spot.make_twa_graph(self._dict)  # its registrations keep the variables alive and in order
        self._variables = [self._registry.register_ap(f"p{level}") for level in range(len(letters.atoms))]
        self._names = {name: spot.formula.ap(f"p{level}") for level, name in enumerate(letters.atoms)}
        self._alive = buddy.bdd_ithvar(self._registry.register_ap("alive"))
        self._levels = {variable: level for level, variable in enumerate(self._variables)}
        self._possible = self._to_bdd(letters.possible)
        self._guards: dict[int, tuple[Any, Diagram]] = {}
        self._time = self._reset_automaton(letters.time)

    def satisfiable(self, formula: Formula) -> Machine:
        """Whether some infinite continuation of the word satisfies `formula`: its exact safety closure.

        Not Spot's `translate('monitor', 'det')`, which keeps some words that no continuation satisfies
        (`Fb & XX(G!b & GFc)` after two steps without b).
        """
        spot_formula = self.to_spot(formula, finite=False)

        def closure(effort: tuple[Any, Any], most: int | None) -> Machine:
            automaton = self._in_time(self._run(spot_formula, effort))
            return determinise(self.letters, self._useful(automaton), bool, most)

        return _determinised(closure)

    def finitely_satisfied(self, formula: Formula) -> Machine:
        """Whether the word, which is not empty, satisfies `formula` as a finite word.

        A finite word is read as an infinite one in which `alive` holds up to its end and never again (De Giacomo and
        Vardi 2013): it is accepted where the rest can be accepted with `alive` false forever.
        """
        spot_formula = self.ending(self.to_spot(formula, finite=True))

        def words(effort: tuple[Any, Any], most: int | None) -> Machine:
            automaton = self._run(spot_formula, effort)
            ending = useful_states(self._restricted(automaton, -self._alive))
            living = self._useful(self._restricted(automaton, self._alive & self._possible), everything=True)
            return determinise(self.letters, living, lambda states: not ending.isdisjoint(states), most)

        return _determinised(words)

    def ending(self, spot_formula: Any) -> Any:
        """`spot_formula` on words in which `alive` holds at first, up to some step and never again."""
        alive, dead = spot.formula.ap("alive"), spot.formula.Not(spot.formula.ap("alive"))
        return spot.formula.And([alive, spot.formula.U(alive, spot.formula.G(dead)), spot_formula])

    def is_satisfiable(self, spot_formula: Any, clocks: int = 0) -> bool:
        """Whether a formula of Spot's is satisfied by some run in time, whose clocks are in the state `clocks`."""
        if self._time is not None:
            self._time.set_init_state(clocks)
        automaton = self._in_time(self._run(spot_formula, FAST))
        return automaton.get_init_state_number() in useful_states(automaton)

    def to_spot(self, formula: Formula, finite: bool) -> Any:
        """`formula` as Spot's; if `finite`, so that it is judged on the steps with `alive`."""
        alive = spot.formula.ap("alive") if finite else spot.formula.tt()
        known: dict[int, Any] = {}  # by identity: encodings share subtrees, and hashing a tree reads all of it

        def living(operand: Formula) -> Any:
            return spot.formula.And([alive, visit(operand)])

        def build(node: Formula) -> Any:
            match node:
                case Truth():
                    return spot.formula.tt()
                case Atom(name):
                    return self._names[name]
                case Not(operand):
                    return spot.formula.Not(visit(operand))
                case And(left, right):
                    return spot.formula.And([visit(left), visit(right)])
                case Or(left, right):
                    return spot.formula.Or([visit(left), visit(right)])
                case Next(operand):
                    return spot.formula.X(living(operand))
                case Until(left, right):
                    return spot.formula.U(visit(left), living(right))
                case _:
                    assert_never(node)

        def visit(node: Formula) -> Any:
            if id(node) not in known:
                known[id(node)] = build(node)
            return known[id(node)]

        return visit(formula)

    def _run(self, spot_formula: Any, effort: tuple[Any, Any]) -> Any:
        """A generalised Büchi automaton of `spot_formula`."""
        translator = spot.translator(self._dict)
        translator.set_type(spot.postprocessor.GeneralizedBuchi)
        translator.set_pref(effort[0])
        translator.set_level(effort[1])
        # Spot replaces the formula object that it is given by a simplified one: give it another object.
        return translator.run(spot.formula.And([spot_formula]))

    def _in_time(self, automaton: Any) -> Any:
        """`automaton` on words of existing letters that are runs in time: its product with the reset machine."""
        restricted = self._restricted(automaton, self._possible)
        return restricted if self._time is None else spot.product(restricted, self._time)

    def _reset_automaton(self, time: RunsInTime) -> Any:
        """The reset machine as an automaton of Spot's; None if every word is a run."""
        if not time.sets:
            return None
        diagrams, automaton = self.letters.diagrams, self._automaton_in_time(time.sets)
        for state, row in enumerate(time.moves):
            moves = (move for move in diagrams.values(row) if move is not None)
            add_edges(automaton, ((state, m, self._to_bdd(diagrams.combine(partial(_is, m), row))) for m in moves))
        return automaton

    def _automaton_in_time(self, sets: int) -> Any:
        """An automaton with so many fairness sets and one state, the initial one."""
        automaton = spot.make_twa_graph(self._dict)
        automaton.copy_ap_of(self._registry)
        automaton.set_generalized_buchi(sets)
        automaton.new_state()
        return automaton

    def _restricted(self, automaton: Any, letters: Any) -> Any:
        """`automaton` without the edges that none of `letters`, a BDD, can take."""
        result = spot.make_twa_graph(self._dict)
        result.copy_ap_of(automaton)
        result.copy_acceptance_of(automaton)
        result.new_states(automaton.num_states())
        result.set_init_state(automaton.get_init_state_number())
        for edge in automaton.edges():
            guard = edge.cond & letters
            if guard != buddy.bddfalse:
                result.new_edge(edge.src, edge.dst, guard, edge.acc)
        return result

    def _useful(self, automaton: Any, everything: bool = False) -> Automaton:
        """`automaton` over our diagrams, of `everything` or of the states from which an infinite word is accepted."""
        states = set(range(automaton.num_states())) if everything else useful_states(automaton)
        successors = [
            successor_sets(self.letters.diagrams, self._guards_to(states, automaton.out(state)))
            for state in range(automaton.num_states())
        ]
        return Automaton(frozenset({automaton.get_init_state_number()} & states), successors)

    def _guards_to(self, states: set[int], edges: Iterable[Any]) -> dict[int, Diagram]:
        """The letters by which `edges` lead to each of `states`."""
        guards: dict[int, Any] = {}
        for edge in edges:
            if edge.dst in states:
                guards[edge.dst] = guards.get(edge.dst, buddy.bddfalse) | edge.cond
        return {state: self._to_diagram(guard) for state, guard in guards.items()}

    def _to_bdd(self, condition: Diagram) -> Any:
        """A diagram with values true and false as a BDD of Spot's."""
        diagrams = self.letters.diagrams
        known = {diagrams.true: buddy.bddtrue, diagrams.false: buddy.bddfalse}

        def visit(node: Diagram) -> Any:
            if node not in known:
                level, low, high = diagrams.split(node)
                known[node] = buddy.bdd_ite(buddy.bdd_ithvar(self._variables[level]), visit(high), visit(low))
            return known[node]

        return visit(condition)

    def _to_diagram(self, guard: Any) -> Diagram:
        """A BDD over the atoms as a diagram; `alive`, where it occurs, is true."""
        diagrams = self.letters.diagrams
        if guard == buddy.bddtrue:
            return diagrams.true
        if guard == buddy.bddfalse:
            return diagrams.false
        if guard.id() not in self._guards:
            low, high = self._to_diagram(buddy.bdd_low(guard)), self._to_diagram(buddy.bdd_high(guard))
            level = self._levels.get(buddy.bdd_var(guard))
            found = high if level is None else diagrams.choose(diagrams.variable(level), high, low)
            self._guards[guard.id()] = (guard, found)  # holding the BDD keeps its number from being used again
        return self._guards[guard.id()][1]


def add_edges(automaton: Any, edges: Iterable[tuple[int, Move, Any]]) -> None:
    """Add moves to an automaton in time: from which state, and by which letters, a BDD."""
    for state, move, guard in edges:
        automaton.new_states(max(0, move.target + 1 - automaton.num_states()))
        automaton.new_edge(state, move.target, guard, spot.mark_t(sorted(move.fair)))


def _is(wanted: object, value: object) -> bool:
    return value == wanted


def _determinised(construction: Any) -> Machine:
    """`construction` from the automaton that Spot makes fastest or, if its powerset is large, from a reduced one."""
    try:
        return minimise(construction(FAST, SMALL_POWERSET))
    except TooManyStatesError:
        return minimise(construction(REDUCED, None))


def useful_states(automaton: Any) -> set[int]:
    """The states, reachable or not, from which some infinite word is accepted."""
    everywhere = spot.scc_info_options_ALL | spot.scc_info_options_PROCESS_UNREACHABLE_STATES
    components = spot.scc_info_with_options(automaton, everywhere)
    return {state for state in range(automaton.num_states()) if components.is_useful_scc(components.scc_of(state))}
