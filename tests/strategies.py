"""What hypothesis draws: formulas, properties, alphabets, words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from hypothesis import strategies as st

from ltlc.semantics import ltl
from ltlc.semantics import properties as p
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.ltl import Formula
from ltlc.semantics.words import Lasso, Letter, Word, all_letters

ABC = ("a", "b", "c")

HARD_NAMES = (
    "alive",
    "Fault",
    "Xerror",
    "GPS_ok",
    "1",
    "p1",
    "two words",
    'quo"te',
    "back\\slash",
    "größe",
    "U",
    "xor",
    "",
)
"""Names of atoms that an engine may read as something else."""


def predicates(atoms: Sequence[str] = ABC) -> st.SearchStrategy[Formula]:
    """State predicates over `atoms`."""
    constants: list[Formula] = [ltl.TRUE, ltl.FALSE]
    leaves = st.one_of(st.sampled_from(atoms).map(ltl.Atom), st.sampled_from(constants))
    return st.recursive(leaves, _boolean, max_leaves=4)


def _boolean(inner: st.SearchStrategy[Formula]) -> st.SearchStrategy[Formula]:
    return st.one_of(inner.map(ltl.Not), st.builds(ltl.And, inner, inner), st.builds(ltl.Or, inner, inner))


def formulas(
    atoms: Sequence[str] = ABC, max_leaves: int = 12, max_temporal: int | None = None
) -> st.SearchStrategy[Formula]:
    """Formulas of core LTL over `atoms`; `max_temporal` bounds the operators `Next` and `Until` in each."""
    unary: tuple[Any, ...] = (ltl.Not,)
    binary: tuple[Any, ...] = (ltl.And, ltl.Or, ltl.implies)
    if max_temporal != 0:
        unary += (ltl.Next, ltl.eventually, ltl.globally, ltl.weak_next)
        binary += (ltl.Until, ltl.weak_until, ltl.release, ltl.strong_release)

    def extend(inner: st.SearchStrategy[Formula]) -> st.SearchStrategy[Formula]:
        return st.one_of(
            *(inner.map(operator) for operator in unary),
            *(st.builds(operator, inner, inner) for operator in binary),
        )

    leaves = st.one_of(st.sampled_from(atoms).map(ltl.Atom), st.just(ltl.TRUE))
    drawn = st.recursive(leaves, extend, max_leaves=max_leaves)
    if max_temporal is None:
        return drawn
    return drawn.filter(lambda f: len(set(temporal_subformulas(f))) <= max_temporal)


def temporal_subformulas(formula: Formula) -> list[Formula]:
    """The subformulas of `formula` that are a `Next` or an `Until`."""
    return [f for f in ltl.subformulas(formula) if isinstance(f, ltl.Next | ltl.Until)]


def properties(atoms: Sequence[str] = ABC, depth: int = 3) -> st.SearchStrategy[p.Property]:
    """Properties of the language over `atoms`, with at most `depth` keywords inside one another."""
    events = predicates(atoms)
    leaves = st.one_of(events.map(p.Now), events.map(p.Throughout))
    if depth == 0:
        return leaves
    body = properties(atoms, depth - 1)
    return st.one_of(
        leaves,
        *(st.builds(keyword, body) for keyword in (p.Not, p.Always, p.Never, p.Eventually)),
        *(st.builds(keyword, body, body) for keyword in (p.And, p.Or, p.Implies)),
        *(st.builds(keyword, events, body) for keyword in (p.After, p.Until)),
        st.builds(p.AfterUntil, events, events, body),
    )


@st.composite
def alphabets(draw: st.DrawFn, atoms: Sequence[str] = ABC) -> Alphabet:
    """Alphabets over `atoms`, some of which constrain one another; each has a letter."""
    order = draw(st.permutations(atoms))
    first, second = sorted((draw(st.integers(0, len(order))), draw(st.integers(0, len(order)))))
    groups = []
    for members in (order[:first], order[first:second]):
        if members:
            valuations = draw(st.lists(st.sampled_from(all_letters(members)), min_size=1, unique=True))
            groups.append(Group(tuple(members), tuple(valuations)))
    return Alphabet(tuple(atoms), tuple(groups))


def letters(atoms: Sequence[str] = ABC) -> st.SearchStrategy[Letter]:
    """Any letter over `atoms`."""
    return st.frozensets(st.sampled_from(atoms))


def words(of: st.SearchStrategy[Letter] | None = None, max_size: int = 6) -> st.SearchStrategy[Word]:
    """Finite words, possibly empty."""
    return st.lists(letters() if of is None else of, max_size=max_size).map(tuple)


def lassos(of: st.SearchStrategy[Letter] | None = None, max_size: int = 4) -> st.SearchStrategy[Lasso]:
    """Ultimately periodic words."""
    of = letters() if of is None else of
    loops = st.lists(of, min_size=1, max_size=max_size).map(tuple)
    return st.builds(Lasso, words(of, max_size), loops)
