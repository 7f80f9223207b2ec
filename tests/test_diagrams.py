"""Decision diagrams against truth tables."""

from __future__ import annotations

from itertools import product

from hypothesis import given
from hypothesis import strategies as st

from ltlc.semantics.diagrams import Diagram, Diagrams

LEVELS = 3
LETTERS = list(product((False, True), repeat=LEVELS))
"""Every letter over three levels, smallest first: level 0 weighs most, and false comes before true."""

Table = tuple[object, ...]
"""The value at each letter, in the order of `LETTERS`."""

truths = st.tuples(*[st.booleans()] * len(LETTERS))
tables = st.tuples(*[st.sampled_from(["x", "y", 1, True, None])] * len(LETTERS))


def diagram_of(store: Diagrams, table: Table, level: int = 0) -> Diagram:
    if len(table) == 1:
        return store.terminal(table[0])
    half = len(table) // 2
    return store.decision(level, diagram_of(store, table[:half], level + 1), diagram_of(store, table[half:], level + 1))


def table_of(store: Diagrams, diagram: Diagram) -> Table:
    return tuple(store.evaluate(diagram, letter.__getitem__) for letter in LETTERS)


@given(tables)
def test_evaluation_gives_the_value_at_the_letter(table: Table) -> None:
    store = Diagrams()
    assert [(type(v), v) for v in table_of(store, diagram_of(store, table))] == [(type(v), v) for v in table]


@given(truths, truths)
def test_operations_are_those_of_logic(left: Table, right: Table) -> None:
    store = Diagrams()
    f, g = diagram_of(store, left), diagram_of(store, right)
    assert table_of(store, store.conjunction(f, g)) == tuple(a and b for a, b in zip(left, right, strict=True))
    assert table_of(store, store.disjunction(f, g)) == tuple(a or b for a, b in zip(left, right, strict=True))
    assert table_of(store, store.negation(f)) == tuple(not a for a in left)


@given(truths, tables, tables)
def test_choose_takes_one_side_where_the_condition_holds_and_the_other_elsewhere(c: Table, t: Table, e: Table) -> None:
    store = Diagrams()
    chosen = store.choose(*(diagram_of(store, table) for table in (c, t, e)))
    assert table_of(store, chosen) == tuple(x if b else y for b, x, y in zip(c, t, e, strict=True))


@given(tables, tables, tables)
def test_combine_applies_a_function_letter_by_letter(a: Table, b: Table, c: Table) -> None:
    store = Diagrams()
    combined = store.combine(lambda *values: values, *(diagram_of(store, table) for table in (a, b, c)))
    assert table_of(store, combined) == tuple(zip(a, b, c, strict=True))


@given(tables)
def test_combine_asks_for_each_value_once_that_of_the_smallest_letter_first(table: Table) -> None:
    store = Diagrams()
    asked: list[object] = []
    store.combine(lambda value: asked.append((type(value), value)), diagram_of(store, table))
    assert asked == list(dict.fromkeys((type(value), value) for value in table))


@given(tables, tables)
def test_relabel_replaces_the_values_of_each_diagram(a: Table, b: Table) -> None:
    store = Diagrams()
    relabelled = store.relabel(str, [diagram_of(store, a), diagram_of(store, b)])
    assert [table_of(store, d) for d in relabelled] == [tuple(map(str, a)), tuple(map(str, b))]


@given(truths, truths)
def test_the_same_function_is_the_same_number_however_it_was_made(left: Table, right: Table) -> None:
    store = Diagrams()
    f, g = diagram_of(store, left), diagram_of(store, right)
    by_de_morgan = store.negation(store.conjunction(store.negation(f), store.negation(g)))
    assert by_de_morgan == store.disjunction(f, g)
    assert (f == g) == (left == right)


@given(tables)
def test_values_come_once_each_that_of_the_smallest_letter_first(table: Table) -> None:
    store = Diagrams()
    values = store.values(diagram_of(store, table))
    assert [(type(v), v) for v in values] == list(dict.fromkeys((type(v), v) for v in table))


@given(tables)
def test_paths_ask_each_level_once_and_cover_every_letter_once(table: Table) -> None:
    store = Diagrams()
    paths = list(store.paths(diagram_of(store, table)))
    for letter, value in zip(LETTERS, table, strict=True):
        matching = [v for answers, v in paths if all(letter[level] == answer for level, answer in answers.items())]
        assert matching == [value]


@given(tables)
def test_decisions_ask_only_levels_that_matter(table: Table) -> None:
    store = Diagrams()
    diagram = diagram_of(store, table)
    for node in store.reachable(diagram):
        if not store.is_terminal(node):
            level, low, high = store.split(node)
            assert low != high
            assert all(store.is_terminal(d) or store.split(d)[0] > level for d in (low, high))


def test_values_that_python_takes_for_equal_are_told_apart() -> None:
    store = Diagrams()
    assert len({store.terminal(1), store.terminal(True), store.terminal(1.0)}) == 3


def test_thirty_levels_take_thirty_decisions() -> None:
    store = Diagrams()
    some = store.false
    for level in range(30):
        some = store.disjunction(some, store.variable(level))
    assert sum(not store.is_terminal(node) for node in store.reachable(some)) == 30
