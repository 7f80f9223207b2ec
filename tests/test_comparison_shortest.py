"""Shortest separating runs: against all runs that are no longer."""

from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import alphabets, formulas

from ltlc.analysis.comparison.shortest import shortest_lasso, shortest_word
from ltlc.automata.machine import Machine, letters_of
from ltlc.automata.queries import Buchi, buchi, is_satisfiable, words_of
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.finite import holds
from ltlc.semantics.lasso import holds_on_lasso
from ltlc.semantics.ltl import And, Atom, Formula, Not, atoms, eventually, globally
from ltlc.semantics.words import Lasso, Letter, all_words

AB = ("a", "b")
LONGEST = 3


@settings(max_examples=120)
@given(formulas(AB, max_leaves=5), formulas(AB, max_leaves=5), alphabets(AB))
def test_no_shorter_finite_run_tells_two_formulas_apart(left: Formula, right: Formula, alphabet: Alphabet) -> None:
    found = shortest_word(tuple(words_of([left, right], alphabet)), lambda a, b: a and not b)
    longest = LONGEST if found is None else len(found) - 1
    if found is not None:
        used = set(atoms(And(left, right)))
        assert set(found) <= {letter & used for letter in alphabet.letters()}
        assert holds(left, found)
        assert not holds(right, found)
    for length in range(1, min(longest, LONGEST) + 1):
        assert not any(holds(left, w) and not holds(right, w) for w in all_words(alphabet.letters(), length))


@settings(max_examples=120)
@given(formulas(AB, max_leaves=5), alphabets(AB))
def test_no_shorter_lasso_satisfies_a_formula(formula: Formula, alphabet: Alphabet) -> None:
    found = shortest_lasso(buchi(formula, alphabet))
    assert (found is not None) == is_satisfiable(formula, alphabet)
    longest = LONGEST
    if found is not None:
        assert holds_on_lasso(formula, found)
        longest = len(found.stem) + len(found.loop) - 1
    for length in range(1, min(longest, LONGEST) + 1):
        for word in all_words(alphabet.letters(), length):
            assert not any(holds_on_lasso(formula, Lasso(word[:k], word[k:])) for k in range(length))


STATES = 4


@st.composite
def automata(draw: st.DrawFn) -> Buchi:
    """Büchi automata over the atom a: for each state, the edges by letters without and with it."""
    letters = letters_of(Atom("a"), Alphabet(("a",)))
    edges = st.frozensets(st.integers(0, 2 * STATES - 1), max_size=2)
    diagrams = letters.diagrams

    def row() -> int:
        return diagrams.decision(0, diagrams.terminal(draw(edges)), diagrams.terminal(draw(edges)))

    return Buchi(letters, [row() for _ in range(STATES)])


def accepts(automaton: Buchi, lasso: Lasso) -> bool:
    """Whether some way of states and positions comes back to itself over an accepting edge."""

    def edges_at(row: int, letter: Letter) -> frozenset[int]:
        edges: frozenset[int] = automaton.letters.diagrams.evaluate(row, lambda _: "a" in letter)
        return edges

    word = lasso.stem + lasso.loop
    steps: dict[tuple[int, int], set[tuple[tuple[int, int], bool]]] = {}
    for position, letter in enumerate(word):
        after = position + 1 if position + 1 < len(word) else len(lasso.stem)
        for state, row in enumerate(automaton.successors):
            steps[state, position] = {((edge >> 1, after), bool(edge & 1)) for edge in edges_at(row, letter)}

    def reachable(start: tuple[int, int]) -> set[tuple[int, int]]:
        found, pending = {start}, [start]
        while pending:
            for after, _ in steps[pending.pop()]:
                if after not in found:
                    found.add(after)
                    pending.append(after)
        return found

    return any(
        is_accepting and place in reachable(after)
        for place in reachable((0, 0))
        for after, is_accepting in steps[place]
    )


@settings(max_examples=300)
@given(automata())
def test_no_shorter_lasso_is_accepted_by_an_automaton(automaton: Buchi) -> None:
    found = shortest_lasso(automaton)
    longest = 5
    if found is not None:
        assert accepts(automaton, found)
        longest = len(found.stem) + len(found.loop) - 1
    for length in range(1, min(longest, 5) + 1):
        for word in all_words((frozenset(), frozenset("a")), length):
            assert not any(accepts(automaton, Lasso(word[:k], word[k:])) for k in range(length))


@settings(max_examples=200)
@given(st.lists(st.tuples(st.booleans(), st.integers(0, 7), st.integers(0, 7)), min_size=8, max_size=8))
def test_no_shorter_word_reaches_a_wanted_output(states: list[tuple[bool, int, int]]) -> None:
    letters = letters_of(Atom("a"), Alphabet(("a",)))
    rows = [
        letters.diagrams.decision(0, letters.diagrams.terminal(low), letters.diagrams.terminal(high))
        for _, low, high in states
    ]
    found = shortest_word((Machine(letters, [output for output, _, _ in states], rows),), bool)
    reached, length = {0}, 0
    while length < len(states):
        reached, length = {q for state in reached for q in states[state][1:]}, length + 1
        if any(states[q][0] for q in reached):
            assert found is not None
            assert len(found) == length
            return
    assert found is None


def test_a_loop_that_has_to_alternate_is_found() -> None:
    a = Atom("a")
    both_for_ever = And(globally(eventually(a)), globally(eventually(Not(a))))
    found = shortest_lasso(buchi(both_for_ever, Alphabet(("a",))))
    assert found is not None
    assert (len(found.stem), len(found.loop)) == (0, 2)


def test_a_letter_that_does_not_exist_separates_nothing() -> None:
    a, b = Atom("a"), Atom("b")
    never_both = Alphabet(AB, (Group(AB, (frozenset(), frozenset("a"), frozenset("b"))),))
    machines = tuple(words_of([eventually(a), eventually(And(a, Not(b)))], never_both))
    assert shortest_word(machines, lambda left, right: left != right) is None
    assert shortest_lasso(buchi(eventually(And(a, b)), never_both)) is None
