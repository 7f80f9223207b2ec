"""Which letters exist over what is said of elements: none that arrays give is missing, and few are there in vain."""

from __future__ import annotations

import math
import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from language_support import compiled

import ltlc
from ltlc.analysis import solving, thresholds
from ltlc.analysis.analyse import study_of
from ltlc.analysis.explanation import explain
from ltlc.analysis.groups import reads_of
from ltlc.analysis.letters import Letters, letters_of, steps_of
from ltlc.automata import Budget
from ltlc.base.source import Source
from ltlc.frontend.language import load_text
from ltlc.semantics.encodings import EPISODE
from ltlc.specification.alphabet import alphabet
from ltlc.specification.atoms import Atom
from ltlc.specification.evaluation import Value, letter
from ltlc.specification.expressions import Read, ValueType

DECLARATIONS = (
    "decl scan /scan LaserScan.ranges\n"
    "decl names /d DiagnosticArray.status[].name\n"
    "decl levels /d DiagnosticArray.status[].level\n"
    "decl limit /limit Float64.data\n"
    "decl others /others Float64MultiArray.data\n"
)
NUMBERS = (-1.0, 0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, math.nan, math.inf)

bounds = st.sampled_from(["1", "2", "1", "2", "limit", "max(others)"])
relations = st.sampled_from(["<", "<=", ">", ">=", "==", "!="])
elements = st.builds(
    "{} {} {}".format, st.sampled_from(["scan", "scan", "scan[1:]", "abs(scan)", "sqrt(scan - 1)"]), relations, bounds
)
entries = st.sampled_from(['names == "a"', "levels >= 2", 'names in {"a", "b"} and levels < 1'])
predicates = st.one_of(elements, elements, st.builds("({}) or {}".format, elements, elements), entries)
said = st.one_of(
    st.builds("{}({})".format, st.sampled_from(["any", "all"]), predicates),
    st.builds("count({}) {} {}".format, predicates, relations, st.sampled_from(["1", "2"])),
    st.builds("{}(scan) {} {}".format, st.sampled_from(["min", "max", "median", "len", "sum"]), relations, bounds),
)
lists_said = st.lists(said, min_size=1, max_size=4)


def atoms_of(text: str) -> tuple[Atom, ...]:
    """The atoms of all that `text` states, each once."""
    stated = compiled(DECLARATIONS + text).properties
    return tuple({atom.name: atom for each in stated for atom in each.atoms}.values())


def known(atoms: tuple[Atom, ...]) -> Letters:
    return letters_of([atoms], solving.valuations)


@settings(max_examples=25)
@given(lists_said)
def test_a_letter_that_some_arrays_give_exists(written: list[str]) -> None:
    atoms = atoms_of("".join(f"eventually {each}\n" for each in written))
    names = [atom.name for atom in atoms]
    exist, monitored = known(atoms).alphabet(names), alphabet(atoms)
    inputs = {i for atom in atoms for i in reads_of(atom.condition)}
    chance = random.Random(0)
    for _ in range(150):
        length = chance.randrange(4)
        pools = {ValueType.NUMBERS: NUMBERS, ValueType.STRINGS: ("a", "b", "c"), ValueType.NUMBER: NUMBERS}
        values: dict[Read, Value] = {
            i: tuple(chance.choices(pools[i.signal.type], k=length))
            if i.signal.type.element
            else chance.choice(pools[i.signal.type])
            for i in inputs
        }
        found = letter(atoms, values)
        assert found is None or exist.allows(found)
        assert found is None or monitored.allows(found)


@settings(max_examples=20)
@given(st.lists(st.sampled_from(["scan < 1", "scan < 2", "scan >= 1", "scan == 1"]), min_size=1, max_size=3))
def test_a_letter_that_exists_has_arrays_that_give_it(written: list[str]) -> None:
    forms = ["any({})", "all({})", "count({}) >= 2", "count({}) == 1"]
    text = "".join(f"eventually {form.format(each)}\n" for form, each in zip(forms, written, strict=False))
    atoms = atoms_of(f"{text}eventually len(scan) > 2\n")
    letters = known(atoms)
    for wanted in letters.alphabet(atom.name for atom in atoms).letters():
        steps = steps_of(atoms, (wanted,), letters, linked=False, taken={})
        assert steps is not None
        assert letter(atoms, steps[0]) == wanted


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("never any(scan < 1) or any(scan < 2)", 3),
        ("never any(scan < 1) or all(scan >= 1)", 2),
        ("never any(scan < 1) or all(scan < 1)", 4),
        ("never any(scan < 1) or min(scan) < 1", 2),
        ("never all(scan > 1) or max(scan) > 1", 4),
        ("never count(scan < 1) >= 2 or count(scan < 1) >= 3", 3),
        ("never count(scan < 1) > 0 or count(scan < 1) < 1", 2),
        ("never count(scan < 1) >= 2 or any(scan < 2)", 3),
        ("never count(scan < 1) == 0.5", 1),
        ("never len(scan) < 0 or len(scan) < 1", 2),
        ("never any(scan < 1) or len(scan) == 0", 3),
        ("never any(scan < 1) or any(scan[1:] < 1)", 4),
        ('never any(names == "a") or all(names == "b")', 3),
        ('never any(names == "a") or all(names == "a")', 4),
        ('never any(names == "a" and levels > 1) or any(names == "a" and levels > 2)', 3),
        ("never any(scan < limit) or all(scan >= limit)", 2),
        ("never any(scan < 0) or any(sqrt(scan) > 1) or all(sqrt(scan) > 1)", 8),
        ("never any(scan < limit) or any(scan <= limit)", 3),
        ("never count(scan < 1) > 5000 or any(scan < 2)", 3),
    ],
)
def test_letters_are_as_many_as_arrays_allow(text: str, count: int) -> None:
    atoms = atoms_of(text)
    assert len(set(known(atoms).alphabet(atom.name for atom in atoms).letters())) == count


@pytest.mark.parametrize(
    "text",
    [
        "never any(scan < 1)",
        "never count(scan < 1 or scan > 2) >= 3 or count(scan < 1 or scan > 2) < 2",
        'never any(names == "a")',
        "never len(scan) > 3 or len(scan) == 2",
        "never sum(scan) > 3",
        "never any(scan < 1 and scan > 2)",
    ],
)
def test_what_is_said_of_one_array_needs_no_solver(text: str) -> None:
    atoms = atoms_of(text)
    found = thresholds.valuations(atoms)
    assert found is not None
    for wanted, values in found.items():
        assert letter(atoms, values) == wanted


def test_an_example_of_many_elements_is_not_made() -> None:
    assert thresholds.valuations(atoms_of("never count(scan < 1) > 1e9")) is None


@pytest.mark.parametrize(
    "condition",
    [
        "any(abs(q) > 3.2)",
        "any(-q > 3.2)",
        "any(q - 1 >= 3.2)",
        "any(q + 1 < 0.5 and abs(q) > 7)",
        "any(sqrt(q) > 3)",
        "any(q * q > 40)",
        "any(max(q, 1) > 3)",
        "not all(abs(q) < 3.2)",
        "count(q + 1 > 3.2) > 2",
        "any(abs(q) > 3.2) and any(q < -3.2) and not any(q > 3.2)",
    ],
)
def test_what_is_computed_from_elements_is_shown_in_a_run_that_violates(condition: str) -> None:
    declared = "decl q /js JointState.position\n"
    text = declared + f"p: never {condition}"
    specification, _ = load_text(Source("props.txt", text))
    assert specification is not None
    budget = Budget(30.0, 1024)
    (explained,) = explain(study_of(specification, EPISODE, budget), budget)
    (example,) = [example for example in explained.examples if example.remarks[-1] == "violated"]
    rows = [{"time": float(k), **dict(zip(example.signals, r, strict=True))} for k, r in enumerate(example.steps)]
    assert ltlc.run(text, rows)["p"].verdict is ltlc.Verdict.VIOLATED
