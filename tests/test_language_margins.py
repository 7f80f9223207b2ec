"""Margins: what they do to equalities, and whom they favour in orderings."""

from __future__ import annotations

import math
from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st
from language_support import codes_of, findings, marked, only_atom, only_comparison, only_property

from ltlc.semantics.denotation import satisfies
from ltlc.specification.evaluation import truth
from ltlc.specification.expressions import Comparison, Current, Expression, Number, Relation, reads

INF = math.inf

EVENTS = ["after {}, flag", "until {}, flag", "after_until {}, flag, flag"]


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("always v <{0.5} 2", "v < 2.5"),
        ("always v <={0.5} 2", "v <= 2.5"),
        ("always v >{0.5} 2", "v > 1.5"),
        ("always v >={0.5} 2", "v >= 1.5"),
        ("never v >{0.1} 2", "v > 2.1"),
        ("never v <{0.5} 2", "v < 1.5"),
        ("never not v <{0.5} 2", "v < 2.5"),
        ("always (v <{0.5} 2 implies flag)", "v < 1.5"),
        ("always (flag implies v <{0.5} 2)", "v < 2.5"),
        ("never (v <{0.5} 2 implies flag)", "v < 2.5"),
        ("eventually v <{0.5} 2", "v < 2.5"),
        ("after v <{0.5} 2, flag", "v < 1.5"),
        ("after flag, v <{0.5} 2", "v < 2.5"),
        ("until v <{0.5} 2, flag", "v < 2.5"),
        ("until flag, v <{0.5} 2", "v < 2.5"),
        ("after_until v <{0.5} 2, flag, flag", "v < 1.5"),
        ("after_until flag, flag, v <{0.5} 2", "v < 2.5"),
        ("never after v <{0.5} 2, flag", "v < 2.5"),
        ("v <{0.5} 2", "v < 2.5"),
        ("not v <{0.5} 2", "v < 1.5"),
        ("always v <{0.5} w", "v < w + 0.5"),
        ("never v <{0.5} w", "v < w - 0.5"),
        ("always 2 <{0.5} v", "2 < v + 0.5"),
        ("always 2 < v", "v > 2"),
        ("never v =={0.5} 2", "v =={0.5} 2"),
        ("never 2 =={0.5} v", "v =={0.5} 2"),
        ("never v !={0.5} 2", "v =={0.5} 2"),
        ("after_until flag, v =={0.5} 2, flag", "v =={0.5} 2"),
        ("m = 0.25 always v <{2 * m} 2", "v < 2.5"),
        ("always v <{0} 2", "v < 2"),
    ],
)
def test_a_margin_moves_a_bound_in_favour_of_the_property(text: str, name: str) -> None:
    atoms = [atom.name for atom in only_property(text).atoms if atom.name != "flag"]
    assert atoms == [name]


def test_an_association_is_relaxed_where_it_is_used() -> None:
    found = only_property("near = v <{0.5} 2  always (near and never near)")
    assert [atom.name for atom in found.atoms] == ["v < 2.5", "v < 1.5"]


@pytest.mark.parametrize(
    "text",
    [
        "after_until flag, v <{0.5} 2, flag",
        "after_until flag, not v <{0.5} 2, flag",
        "never after_until flag, flag and v <{0.5} 2, flag",
        "never (v <{0.5} 2) == flag",
        "never flag != (flag implies v <{0.5} 2)",
    ],
)
def test_an_ordering_that_is_in_nobodys_favour_has_no_margin(text: str) -> None:
    (found,) = findings("decl v /v Float64.data decl flag /f Bool.data\n" + text)
    assert found.code == "LTL304"
    assert marked(found) == "0.5"


def test_without_a_margin_such_an_ordering_is_fine() -> None:
    assert codes_of("decl v /v Float64.data decl flag /f Bool.data after_until flag, v <{0} 2, flag") == []


def test_a_default_margin_is_for_equality_of_numbers_and_vectors_only() -> None:
    header = "_margin_ = 0.25 "
    assert only_comparison(header + "never v == 2").margin == 0.25
    assert only_comparison(header + "never v =={0} 2").margin == 0
    assert only_comparison(header + "never v < 2").margin == 0
    assert only_comparison(header + "never robot.position == sign.position").margin == 0.25
    assert only_atom(header + 'never mode == "a"').name == 'mode == "a"'


def test_vectors_are_equal_if_their_distance_is_within_the_margin() -> None:
    condition = only_comparison("never robot.position =={0.5} sign.position")
    assert condition.relation is Relation.EQUAL
    assert condition.margin == 0.5
    assert only_atom("never robot.position =={0.5} sign.position").name == "robot.position =={0.5} sign.position"


@pytest.mark.parametrize(
    ("one", "other", "apart"),
    [
        ((INF, 0, 0), (INF, 0, 0), 0),
        ((INF, 3, 0), (INF, 0, 4), 5),
        ((INF, -INF, INF), (INF, -INF, INF), 0),
        ((INF, 0, 0), (-INF, 0, 0), INF),
        ((INF, 0, 0), (0, 0, 0), INF),
        ((1, 2, 3), (1, 2, 3), 0),
        ((1, 2, 3), (1, 5, 7), 5),
    ],
)
@pytest.mark.parametrize("margin", ["", "{4.5}", "{5}"])
def test_equal_infinities_in_two_vectors_are_no_distance_apart(
    one: tuple[float, ...], other: tuple[float, ...], apart: float, margin: str
) -> None:
    condition = only_comparison(f"never robot.position =={margin} sign.position")
    values = dict(
        zip(reads(condition.left), (each for pair in zip(one, other, strict=True) for each in pair), strict=True)
    )
    assert truth(condition, values) is (apart <= float(margin.strip("{}") or 0))


@dataclass(frozen=True)
class Written:
    """A property with and without margins, as text."""

    strict: str
    relaxed: str


def joined(form: str, *parts: Written) -> Written:
    return Written(form.format(*(p.strict for p in parts)), form.format(*(p.relaxed for p in parts)))


COMPARISONS = st.builds(
    lambda left, o, right: Written(f"{left} {o} {right}", f"{left} {o}{{1}} {right}"),
    st.sampled_from(["v", "w"]),
    st.sampled_from(["<", "<=", ">", ">="]),
    st.sampled_from(["0", "1", "2", "v", "w"]),
)

PREDICATES = st.recursive(
    COMPARISONS,
    lambda inner: st.one_of(
        st.builds(lambda p: joined("(not {})", p), inner),
        st.builds(
            lambda p, q, o: joined(f"({{}} {o} {{}})", p, q), inner, inner, st.sampled_from(["and", "or", "implies"])
        ),
    ),
    max_leaves=4,
)

PROPERTIES = st.recursive(
    st.builds(lambda k, p: joined(f"({k} {{}})", p), st.sampled_from(["always", "never", "eventually"]), PREDICATES),
    lambda inner: st.one_of(
        st.builds(
            lambda k, p: joined(f"({k} {{}})", p), st.sampled_from(["always", "never", "eventually", "not"]), inner
        ),
        st.builds(
            lambda p, q, o: joined(f"({{}} {o} {{}})", p, q), inner, inner, st.sampled_from(["and", "or", "implies"])
        ),
    ),
    max_leaves=3,
)

RUNS = st.lists(st.tuples(st.integers(-1, 3), st.integers(-1, 3)), min_size=1, max_size=4)


def satisfied(text: str, run: list[tuple[int, int]]) -> bool:
    """Whether a run of values of v and w satisfies the property."""
    found = only_property(text)
    word = tuple(
        frozenset(a.name for a in found.atoms if isinstance(a.condition, Comparison) and at(a.condition, v, w))
        for v, w in run
    )
    return satisfies(word, found.property)


def at(comparison: Comparison, v: int, w: int) -> bool:
    values = {"v": float(v), "w": float(w)}

    def number(side: Expression) -> float:
        if isinstance(side, Current):
            return values[side.signal.name]
        assert isinstance(side, Number)
        return side.value

    left, bound = number(comparison.left), number(comparison.right) + comparison.margin
    relation = comparison.relation.value
    return {"<": left < bound, "<=": left <= bound, ">": left > bound, ">=": left >= bound}[relation]


@given(PROPERTIES, RUNS)
def test_a_run_that_satisfies_a_property_satisfies_it_with_margins(
    written: Written, run: list[tuple[int, int]]
) -> None:
    assert satisfied(written.relaxed, run) or not satisfied(written.strict, run)
