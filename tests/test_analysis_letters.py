"""Which letters exist, and values that give them: compared with letters that random values give."""

from __future__ import annotations

import random
from collections.abc import Sequence

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ltlc.analysis import solving, thresholds
from ltlc.analysis.analyse import analyse
from ltlc.analysis.bounds import Interval, bounds
from ltlc.analysis.groups import reads_of
from ltlc.analysis.letters import letters_of, steps_of
from ltlc.automata import Budget
from ltlc.base.diagnostics import Severity
from ltlc.base.source import Source
from ltlc.frontend.language import load_text
from ltlc.semantics.encodings import EPISODE
from ltlc.specification.alphabet import alphabet
from ltlc.specification.atoms import Atom
from ltlc.specification.evaluation import letter
from ltlc.specification.expressions import Call, Number
from ltlc.specification.functions import Function

DECLARATIONS = "decl x /x Float64.data\ndecl y /y Float64.data\ndecl on /on Bool.data\ndecl mode /mode String.data\n"
VALUES = (-3.0, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0, 3.0)

terms = st.sampled_from(["x", "y", "x + y", "x - y", "2 * x", "abs(x)", "min(x, y)", "max(x, y)", "x * y", "-y"])
comparisons = st.builds(
    "{} {}{} {}".format,
    terms,
    st.sampled_from(["<", "<=", ">", ">=", "=="]),
    st.sampled_from(["", "", "{0.5}"]),
    st.sampled_from(["-1", "0", "0.5", "1", "2", "x", "y"]),
)
others = st.sampled_from(["on", 'mode == "a"', 'mode != "b"'])
conditions = st.lists(st.one_of(comparisons, comparisons, others), min_size=1, max_size=4)


def atoms_of(text: str) -> tuple[Atom, ...]:
    """The atoms of the properties in `text`."""
    specification, diagnostics = load_text(Source("props.txt", DECLARATIONS + text))
    assert specification is not None, [d.message for d in diagnostics]
    return tuple(atom for stated in specification.properties for atom in stated.atoms)


def valuations(text: str) -> set[frozenset[str]]:
    """The letters that exist over the atoms of `text`."""
    atoms = atoms_of(text)
    return set(letters_of([atoms], solving.valuations).alphabet(atom.name for atom in atoms).letters())


@settings(max_examples=80)
@given(conditions)
def test_a_letter_that_some_values_give_exists(written: list[str]) -> None:
    atoms = atoms_of("".join(f"eventually ({each})\n" for each in written))
    alphabet = letters_of([atoms], solving.valuations).alphabet(atom.name for atom in atoms)
    chance = random.Random(0)
    inputs = {i for atom in atoms for i in reads_of(atom.condition)}
    pools = {"x": VALUES, "y": VALUES, "on": (False, True), "mode": ("a", "b", "c")}
    for _ in range(100):
        values = {i: chance.choice(pools[i.signal.name]) for i in inputs}
        given_ = letter(atoms, values)
        assert given_ is None or alphabet.allows(given_)


@settings(max_examples=60)
@given(conditions)
def test_a_letter_that_exists_has_values_that_give_it(written: list[str]) -> None:
    atoms = atoms_of("".join(f"eventually ({each})\n" for each in written))
    letters = letters_of([atoms], solving.valuations)
    if letters.undecided:
        return
    for wanted in letters.alphabet(atom.name for atom in atoms).letters():
        steps = steps_of(atoms, (wanted,), letters, linked=False, taken={})
        # Over irrational numbers there may be no doubles; these terms have none but for products.
        if steps is None:
            assert any("x * y" in each or "abs" in each for each in written)
            continue
        assert letter(atoms, steps[0]) == wanted


@pytest.mark.parametrize("text", ["never abs(x) < 0.05", "never x - y > 1 and x < 2", "always max(x, y) < 1 or on"])
def test_z3_is_not_asked_where_plain_numbers_show_that_every_letter_exists(text: str) -> None:
    def solve(atoms: Sequence[Atom]) -> None:
        raise AssertionError(atoms)

    atoms = atoms_of(text)
    letters = letters_of([atoms], solve)
    every = list(letters.alphabet(atom.name for atom in atoms).letters())
    assert len(every) == 1 << len(atoms)
    for wanted in every:
        steps = steps_of(atoms, (wanted,), letters, linked=False, taken={})
        assert steps is not None
        assert letter(atoms, steps[0]) == wanted


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("never x < 1 or x > 1", 3),
        ("never x < 1 or x < 2 or x < 3", 4),
        ("never robot.velocity < 0 or robot.velocity > 1", 2),
        ("never robot.orientation > 4 or robot.orientation < -4", 1),
        ("never robot.velocity > 1 or robot.velocity.x > 1", 3),
        ('never mode == "a" or mode == "b"', 3),
        ("never x > y or y > x", 3),
        ("never x > 1 or y > 1", 4),
        ("never sqrt(x) < 0 or x < -1", 2),
        ("never x * x < 0 or x > 1", 2),
        ("never x / 2 > 1 or x > 2", 2),
        ("never x / y > 1 or y > 0 or x > 0", 7),
    ],
)
def test_letters_are_as_many_as_the_numbers_allow(text: str, count: int) -> None:
    assert len(valuations(text)) == count


@pytest.mark.parametrize(
    "text",
    [
        "eventually x > 1.7976931348623157e308",
        "never x =={1} 1e999 or x < 1e999",
        "eventually x =={0.1} 0.3 and x < 0.2",
        "eventually x =={0.1} 1 and x > 1.1",
        "eventually robot.velocity =={0.1} 0.3 and robot.velocity < 0.2",
        "eventually min(scan) > 1.7976931348623157e308",
    ],
)
def test_over_one_signal_the_letters_are_those_of_doubles(text: str) -> None:
    """What only an infinity gives, or a number that is rounded, can hold as well."""
    atoms = atoms_of(f"decl scan /scan LaserScan.ranges\n{text}")
    found = thresholds.valuations(atoms)
    assert found is not None
    assert found.keys() == set(alphabet(atoms).letters())
    for letter_, values in found.items():
        assert letter(atoms, values) == letter_


@pytest.mark.parametrize(
    "text",
    ["eventually x + 1 == x", "eventually x + 0.1 + 0.2 > x + 0.3 and x < y"],
)
def test_what_only_rounding_gives_is_not_called_impossible(text: str) -> None:
    specification, _ = load_text(Source("props.txt", DECLARATIONS + text))
    assert specification is not None
    found = analyse(specification, EPISODE, Budget(60))
    assert not any(d.severity is Severity.ERROR for d in found.diagnostics)


def test_history_that_follows_from_the_steps_before_is_shown_so() -> None:
    atoms = atoms_of("eventually x < 1 and @{x, -1} > 5\n")
    letters = letters_of([atoms], solving.valuations)
    low, both = frozenset({atoms[0].name}), frozenset(atom.name for atom in atoms)
    assert steps_of(atoms, (low, both), letters, linked=True, taken={}) is None
    steps = steps_of(atoms, (frozenset({atoms[1].name}), both), letters, linked=True, taken={})
    assert steps is not None
    now, past = steps[0].keys()
    assert steps[1][past] == steps[0][now]


def test_two_names_of_one_signal_constrain_one_another() -> None:
    text = "decl z /x Float64.data\nnever x > 1 or z < 0"
    assert len(valuations(text)) == 3


@pytest.mark.parametrize(
    ("function", "expected"), [(Function.NORM, Interval(low=0.0)), (Function.ANGLE, Interval(0.0, 3.141592653589793))]
)
def test_the_bounds_of_functions_are_known(function: Function, expected: Interval) -> None:
    assert bounds(Call(function, (Number(1.0),))) == expected
