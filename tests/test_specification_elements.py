"""What is said of the elements of arrays: by definition, by plain Python, and by emitted code, on any numbers."""

from __future__ import annotations

import math
import statistics
from array import array
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cache
from itertools import product
from typing import Any

import numpy
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stepping import SAMPLES, SCAN, counts, emitted, from_text, never, samples, session

from ltlc.backends.python import standalone_classes
from ltlc.runtime import functions as f
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Letter
from ltlc.specification import expressions as e
from ltlc.specification.atoms import Atom
from ltlc.specification.evaluation import evaluate, letter
from ltlc.specification.expressions import Comparison, Count, Relation
from ltlc.specification.functions import Function

SCAN_OF = "decl scan /scan LaserScan.ranges\ndecl limit /limit Float64.data\n"
NUMBERS = st.one_of(st.sampled_from(SAMPLES), st.integers(-3, 3).map(float), st.floats())
ARRAYS = st.lists(NUMBERS, max_size=8).map(tuple)
NAN = math.nan


@cache
def atoms(said: str) -> tuple[Atom, ...]:
    compiled, _ = from_text(f"{SCAN_OF}never {said}")
    return compiled[0].specification.atoms


def by_definition(said: str, scan: Sequence[float], limit: float = 0.0) -> bool | None:
    """Whether the one atom of `said` holds; None for no step."""
    (atom,) = atoms(said)
    inputs = e.inputs(atom.condition.left) if isinstance(atom.condition, Comparison) else ()
    values = {i: tuple(scan) if i.signal.name == "scan" else limit for i in [*inputs, *e.inputs(_right(atom))]}
    found = letter((atom,), values)
    return None if found is None else bool(found)


def _right(atom: Atom) -> e.Expression:
    assert isinstance(atom.condition, Comparison)
    return atom.condition.right


@pytest.mark.parametrize(
    ("said", "scan", "expected"),
    [
        ("min(scan) < 0.15", (0.05, NAN, 3.0), True),
        ("min(scan) < 0.15", (NAN, 3.0), False),
        ("min(scan) < 0.15", (NAN, NAN), None),
        ("min(scan) < 0.15", (), None),
        ("max(scan) > 5", (NAN, 1.0, math.inf), True),
        ("any(scan < 0.25)", (), False),
        ("all(scan < 0.25)", (), True),
        ("any(scan < 0.25)", (NAN, 0.2), True),
        ("all(scan < 0.25)", (NAN, 0.2), True),
        ("all(scan != 0.25)", (NAN, 0.2), True),
        ("any(scan != 0.25)", (NAN, 0.25), False),
        ("any(scan != 0.25 or limit == 0)", (NAN,), False),
        ("count(scan < 0.25) >= 2", (0.1, NAN, 0.2), True),
        ("count(scan < 0.25) >= 2", (0.1, 0.25, 0.25), False),
        ("count(scan == 0.25) == 2", (0.1, 0.25, 0.25), True),
        ("len(scan) == 3", (NAN, 1.0, 2.0), True),
        ("sum(scan) == 3", (1.0, 2.0), True),
        ("sum(scan) == 0", (), True),
        ("sum(scan) > 3", (1.0, NAN), None),
        ("sum(scan) > 3", (math.inf, -math.inf), None),
        ("sum(scan) > 3", (math.inf, 1.0), True),
        ("any(sqrt(scan) > 1)", (-1.0, 0.5), False),
        ("all(sqrt(scan) > 1)", (-1.0, 4.0), True),
        ("any(scan[1:3] < 0.25)", (0.1, 0.5, 0.5, 0.1), False),
        ("any(scan[-2:] < 0.25)", (0.1,), True),
        ("any(scan[5:] < 0.25)", (0.1,), False),
        ("any(scan[1:] - scan[:-1] > 1)", (1.0, 1.5, 3.0), True),
        ("any(scan < limit / limit)", (0.1,), None),
        ("any(scan < 0.25 or limit / limit > 2)", (0.1,), None),
    ],
)
def test_the_definition_of_what_is_said_of_elements(said: str, scan: tuple[float, ...], expected: bool | None) -> None:
    assert by_definition(said, scan) is expected


OPERATORS: dict[str, Callable[[float, float], bool]] = {
    "<": lambda a, b: a < b,
    "<=": lambda a, b: a <= b,
    ">": lambda a, b: a > b,
    ">=": lambda a, b: a >= b,
    "==": lambda a, b: a == b,
    "!=": lambda a, b: a != b,
}


@settings(max_examples=60)
@given(st.sampled_from(sorted(OPERATORS)), st.sampled_from([0.0, 0.125, 1.0, 2.5]), ARRAYS)
def test_the_definition_is_what_python_says_of_the_elements_that_are_measured(
    operator: str, bound: float, scan: tuple[float, ...]
) -> None:
    holds = [OPERATORS[operator](x, bound) for x in scan if not math.isnan(x)]
    said = f"scan {operator} {bound}"
    assert by_definition(f"any({said})", scan) == any(holds)
    assert by_definition(f"all({said})", scan) == all(holds)
    for number in range(len(scan) + 2):
        assert by_definition(f"count({said}) == {number}", scan) == (sum(holds) == number)


@settings(max_examples=50)
@given(st.sampled_from([0.0, 0.1, 1.0, 2.5]), ARRAYS)
def test_the_smallest_is_below_a_bound_exactly_if_some_element_is(bound: float, scan: tuple[float, ...]) -> None:
    smallest = by_definition(f"min(scan) < {bound}", scan)
    assert smallest is None or smallest == by_definition(f"any(scan < {bound})", scan)
    largest = by_definition(f"max(scan) >= {bound}", scan)
    assert largest is None or largest == by_definition(f"any(scan >= {bound})", scan)
    assert (smallest is None) == all(map(math.isnan, scan))


@given(ARRAYS)
def test_functions_of_arrays_are_the_reference(scan: tuple[float, ...]) -> None:
    for function in (function for function in Function if function.takes.array):
        names = {"min": "smallest", "max": "largest", "len": "length_of", "complete": "complete"}
        emitted_ = getattr(f, names.get(function.value, f"{function.value}_of"))
        wanted = evaluate(e.Call(function, (e.Current(SCAN),)), {e.Current(SCAN): scan})
        assert isinstance(wanted, float)
        assert same(emitted_(scan), wanted)


def same(one: float, other: float) -> bool:
    return one == other or (math.isnan(one) and math.isnan(other))


@pytest.mark.parametrize(
    ("scan", "total"),
    [
        ((0.1,) * 10, 1.0),
        ((1e16, 1.0, -1e16), 1.0),
        ((1.7e308, 1.7e308, -1.7e308), 1.7e308),
        ((1.7e308, 1.7e308), math.inf),
        ((-1.7e308, -1.7e308), -math.inf),
        ((1.7e308, 1.7e308, -math.inf), -math.inf),
        ((1.7e308, 1.7e308, math.inf, -math.inf), NAN),
        ((1.7e308, 1.7e308, NAN), NAN),
    ],
)
def test_a_sum_is_rounded_once(scan: tuple[float, ...], total: float) -> None:
    assert same(f.sum_of(scan), total)
    assert same(float(evaluate(e.Call(Function.SUM, (e.Current(SCAN),)), {e.Current(SCAN): scan})), total)  # type: ignore[arg-type]


@given(st.lists(st.floats(allow_nan=False, min_value=-1e307, max_value=1e307), min_size=1, max_size=9))
def test_the_median_is_that_of_the_library_of_python(scan: list[float]) -> None:
    assert f.median_of([NAN, *scan]) == statistics.median(scan)


@pytest.mark.parametrize(
    ("scan", "median"),
    [
        ((), NAN),
        ((NAN,), NAN),
        ((3.0, NAN, 1.0, 2.0), 2.0),
        ((1.0, 2.0), 1.5),
        ((1.7e308, 1.7e308), 1.7e308),
        ((5e-324, 5e-324), 5e-324),
        ((-math.inf, 0.0, math.inf), 0.0),
        ((-math.inf, math.inf), NAN),
        ((math.inf, 1.0), math.inf),
    ],
)
def test_a_median_leaves_nan_out_and_neither_overflows_nor_underflows(scan: tuple[float, ...], median: float) -> None:
    assert same(f.median_of(scan), median)
    assert same(float(evaluate(e.Call(Function.MEDIAN, (e.Current(SCAN),)), {e.Current(SCAN): scan})), median)  # type: ignore[arg-type]


@given(st.lists(st.floats(allow_nan=False, min_value=-1e300, max_value=1e300), min_size=1, max_size=9))
def test_a_mean_leaves_nan_out_and_is_rounded_twice_at_most(scan: list[float]) -> None:
    exact = sum(map(Fraction, scan), Fraction())
    assert f.mean_of([NAN, *scan]) == f.mean_of(scan) == float(exact) / len(scan)


@pytest.mark.parametrize(
    ("scan", "mean"),
    [((), NAN), ((NAN,), NAN), ((NAN, 2.0, 3.0), 2.5), ((math.inf, 1.0), math.inf), ((-math.inf, math.inf, NAN), NAN)],
)
def test_a_mean_of_nothing_measured_is_none(scan: tuple[float, ...], mean: float) -> None:
    assert same(f.mean_of(scan), mean)
    assert same(float(evaluate(e.Call(Function.MEAN, (e.Current(SCAN),)), {e.Current(SCAN): scan})), mean)  # type: ignore[arg-type]


@given(st.floats(), ARRAYS)
def test_the_nearest_is_the_first_element_that_no_other_is_nearer_than(sought: float, scan: tuple[float, ...]) -> None:
    found = f.nearest_of(sought, scan)
    said = evaluate(e.Call(Function.NEAREST, (e.Number(sought), e.Current(SCAN))), {e.Current(SCAN): scan})
    assert repr(found) == repr(said)
    measured = [each for each in scan if not math.isnan(each)]
    if math.isnan(sought) or not measured:
        assert math.isnan(found)
        return
    apart = [0.0 if each == sought else abs(each - sought) for each in measured]
    assert repr(found) == repr(measured[apart.index(min(apart))])


@pytest.mark.parametrize(
    ("sought", "scan", "nearest"),
    [
        (2.0, (1.0, 3.0), 1.0),
        (2.0, (3.0, NAN, 1.0), 3.0),
        (math.inf, (1.0, math.inf), math.inf),
        (math.inf, (2.0, 1.0), 2.0),
        (1.0, (-math.inf, math.inf), -math.inf),
        (1.0, (NAN,), NAN),
    ],
)
def test_the_nearest_takes_the_first_of_equals(sought: float, scan: tuple[float, ...], nearest: float) -> None:
    assert same(f.nearest_of(sought, scan), nearest)


def test_a_median_is_never_negative_zero() -> None:
    assert math.copysign(1.0, f.median_of((-0.0,))) == math.copysign(1.0, f.median_of((-0.0, -0.0))) == 1.0


@given(st.lists(st.floats(allow_nan=False, allow_infinity=False, max_value=1e300, min_value=-1e300), max_size=20))
def test_a_sum_is_the_nearest_double(scan: list[float]) -> None:
    assert f.sum_of(scan) == float(sum(map(Fraction, scan), Fraction()))


@settings(max_examples=100)
@given(counts(), st.sampled_from([(Relation.AT_LEAST, 1.0), (Relation.LESS, 1.0), (Relation.EQUAL, 2.0)]), samples())
def test_the_emitted_count_is_the_definition(
    count: Count, compared: tuple[Relation, float], sample: dict[e.Signal, Any]
) -> None:
    relation, number = compared
    compiled = never(Comparison(count, relation, e.Number(number)))
    inputs = compiled.specification.inputs()
    wanted: Letter | None = letter(compiled.specification.atoms, {i: sample[i.signal] for i in inputs})
    [written] = standalone_classes([compiled], "props.txt")
    monitor = emitted([compiled])[written.name]()
    depth = max((getattr(i, "samples", 0) for i in inputs), default=0)
    for _ in range(depth + 1):
        verdict = monitor.step(**{name: sample[signal] for name, signal in written.parameters})
    expected = "not_started" if wanted is None else "violated" if wanted else "presumably_satisfied"
    assert verdict.value == expected


@pytest.mark.parametrize(
    "said",
    [
        "any(scan != 0.3)",
        "all(scan == 0.3)",
        "count(not scan == 1) == 2",
        "all(not scan =={0.5} 1)",
        "any(scan < 0.3 or scan[1:] > 1)",
        "any(scan[1:] == 1 or scan > 1 and scan < 3)",
        "all(scan - scan[1:] > 1 implies scan == 0.3)",
        "min(scan) < 0.3 or max(scan[1:]) > 1",
    ],
)
def test_an_element_that_is_nan_counts_nowhere(said: str) -> None:
    compiled, _ = from_text(f"{SCAN_OF}p: never {said}")
    stated, machine, run = compiled[0].specification, compiled[0].monitor, emitted(compiled)["P"]
    for scan in product([NAN, 0.3, 1.0, 2.0], repeat=3):
        found = letter(stated.atoms, dict.fromkeys(stated.inputs(), scan))
        expected = Verdict.NOT_STARTED if found is None else machine.verdicts[machine.step(0, found)]
        assert run().step(scan).value == expected.value


@pytest.mark.parametrize("kind", [tuple, list, lambda xs: array("d", xs), numpy.array])
@pytest.mark.parametrize(
    ("said", "scan", "verdict"),
    [
        ("any(scan < 0.3)", (1.0, NAN, 0.2), "violated"),
        ("any(scan < 0.3)", (1.0, NAN), "presumably_satisfied"),
        ("min(scan) < 0.3", (NAN, 0.2, 1.0), "violated"),
        ("min(scan) < 0.3", (NAN,), "not_started"),
        ("count(scan[1:] > 0.5) == 2", (9.0, 1.0, 0.5, 2.0), "violated"),
        ("sum(scan) > 3", (1.0, 2.5), "violated"),
        ("len(scan) > 3", (), "presumably_satisfied"),
        ("any(scan * 2 < 0.3)", (0.1,), "violated"),
    ],
)
def test_arrays_of_all_kinds_are_judged_alike(
    kind: Callable[[Sequence[float]], Any], said: str, scan: tuple[float, ...], verdict: str
) -> None:
    compiled, _ = from_text(f"{SCAN_OF}p: never {said}")
    assert emitted(compiled)["P"]().step(kind(scan)).value == verdict
    run = session(f"{SCAN_OF}p: never {said}")
    run.message(0, "/scan", [kind(scan)])
    assert run.tracks[0].verdict.value == verdict


@pytest.mark.parametrize("code", ["b", "H", "i", "Q", "f"])
def test_arrays_of_integers_and_single_floats_are_compared_by_their_values(code: str) -> None:
    compiled, _ = from_text(f"{SCAN_OF}p: never any(scan == 3) and sum(scan) == 7 and min(scan) < 1.5")
    values = [4, 3] if code == "f" else [1, 3, 3]
    for scan in (array(code, values), numpy.array(values, dtype=code)):
        expected = "presumably_satisfied" if code == "f" else "violated"
        assert emitted(compiled)["P"]().step(scan).value == expected
