"""`ltlc mine`: the values found are the tightest that there are, what has none is refused, and what is told of them."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path
from random import Random
from typing import Any

import pytest
from bag_support import odometry, rosbag2
from effort import share_of
from hypothesis import assume, given
from hypothesis import strategies as st
from stepping import FLAG, X, from_text
from strategies import predicates, properties

from ltlc.automata import Budget, translate
from ltlc.base.source import Source, Span
from ltlc.cli import main
from ltlc.frontend.language import load_text
from ltlc.frontend.language.parameters import Role
from ltlc.inputs.recordings import open_recording
from ltlc.monitoring.judging.run import run
from ltlc.monitoring.mining import oracle
from ltlc.monitoring.mining.mine import Finding, Mined, Result, mine
from ltlc.monitoring.mining.monotone import WEAKER, Monotony, NotMonotoneError
from ltlc.monitoring.mining.search import Search
from ltlc.monitoring.mining.template import load
from ltlc.monitoring.mining.values import values
from ltlc.semantics import properties as p
from ltlc.semantics import robustness
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.denotation import satisfies
from ltlc.semantics.encodings import EPISODE, encode
from ltlc.semantics.instants import Instant, with_past
from ltlc.semantics.timed_atoms import PastAtom, timed_atoms
from ltlc.specification import expressions as e
from ltlc.specification import margins as margins_of
from ltlc.specification.atoms import Atom
from ltlc.specification.evaluation import is_true
from ltlc.specification.expressions import Comparison, Input, IsTrue, Relation
from ltlc.specification.shapes import renamed
from ltlc.specification.specification import PropertySpecification
from ltlc.specification.wire import DOUBLES, SINGLES, Kind, Numbers

DECLARATIONS = """
decl v /odom Odometry.twist.twist.linear.x
decl w /odom Odometry.twist.twist.linear.y
decl s /scan LaserScan.range_max
decl n /image Image.height
decl on /flag std_msgs/Bool.data
decl r1 /r1 std_msgs/Float64.data
decl r2 /r2 std_msgs/Float64.data
"""


def text(*properties_: str) -> str:
    return DECLARATIONS + "".join(f"{each}\n" for each in properties_)


def recording(path: Path, columns: str, rows: Sequence[Sequence[Any]], step: float = 1.0) -> Path:
    lines = [",".join(map(str, [f"{k * step:.9f}", *row])) for k, row in enumerate(rows)]
    path.write_text("\n".join([f"time,{columns}", *lines]) + "\n")
    return path


def mined(folder: Path, specification: str, *recordings: Path, each: bool = False, measures: bool = False) -> Mined:
    path = folder / "props.txt"
    path.write_text(specification)
    template, diagnostics = load(path, [])
    assert template is not None, diagnostics
    return mine(template, recordings, Budget(), each=each, measures=measures)


def found(folder: Path, property_: str, *recordings: Path) -> Finding:
    (finding,) = mined(folder, text(property_), *recordings).findings
    return finding


def written(folder: Path, property_: str, columns: str, *rows: Sequence[Any]) -> str:
    finding = found(folder, property_, recording(folder / "run.csv", columns, rows))
    assert finding.result is Result.FOUND
    return finding.trial.text


# --- against the definition -------------------------------------------------------------------------------------------

LEVELS = (-1.5, 0.0, 0.25, 1.0, 3.0)

THRESHOLDS = (
    "never v > ?",
    "never v >= ?",
    "always ? <= v",
    "eventually v < ?",
    "always (v > ? implies eventually w < 1)",
    "after_until w > 1, w < 0.5, always v <= ?",
    "after w >= 1, never not (v < ?)",
    "until w >= 3, v >= ?",
    "always (w > 0 and previously w < 1 implies v < ?)",
    "never (historically v > ?) and w > 1",
    "eventually (v > ? since w < 0)",
    "never v - w > ?",
    "not (eventually v > ? and eventually w < 0)",
)


APART = 2
"""So many nanoseconds are between two rows: enough for an instant at which `previously` has caught up."""


def read(filled: str, rows: Sequence[tuple[float, float]]) -> tuple[PropertySpecification, list[dict[Input, float]]]:
    """The one property of the specification `filled`, and what its inputs are in each of `rows`."""
    specification, diagnostics = load_text(Source("props.txt", filled))
    assert specification is not None, diagnostics
    (property_,) = specification.properties
    named = {i.signal.name: i for i in property_.inputs()}
    return property_, [{i: v if name == "v" else w for name, i in named.items()} for v, w in rows]


def holds(filled: str, rows: Sequence[tuple[float, float]]) -> bool:
    """Whether the run of `rows`, each of which is held for an instant, satisfies the property of `filled`."""
    property_, values = read(filled, rows)
    letters = [frozenset(a.name for a in property_.atoms if is_true(a.condition, row)) for row in values]
    word = tuple(Instant(k, letters[k // APART]) for k in range(APART * (len(letters) - 1) + 1))
    return satisfies(with_the_past(word, property_), property_.property)


def with_the_past(word: tuple[Instant, ...], property_: PropertySpecification) -> tuple[Instant, ...]:
    """`word` with what the past decides at its steps."""
    return with_past(word, looking_back(property_))


def looking_back(property_: PropertySpecification) -> list[PastAtom]:
    found = {atom.name: atom for each in p.predicates(property_.property) for atom in timed_atoms(each)}
    return [atom for atom in found.values() if isinstance(atom, PastAtom)]


def by_how_much_it_holds(filled: str, rows: Sequence[tuple[float, float]]) -> float:
    """The robustness of the run of `rows`, by definition; one comes `APART` after the other."""
    property_, values = read(filled, rows)
    margins = [{a.name: margins_of.by_how_much(a.condition, row) for a in property_.atoms} for row in values]
    steps = [robustness.Measured(k * APART, each) for k, each in enumerate(margins)]
    run_ = robustness.with_past(robustness.held(steps, steps[-1].time), looking_back(property_))
    return robustness.robustness(run_, property_.property)


def tightest(template: str, runs: Sequence[Sequence[tuple[float, float]]], is_upward: bool) -> float | None:
    """By trying all values that can decide, the strongest of those with which all runs satisfy the property.

    It becomes weaker upward, or downward.
    """
    differences = {a - b for a in LEVELS for b in LEVELS} if "v - w" in template else set()
    values = sorted(
        {math.nextafter(at, way) for at in {*LEVELS, *differences} for way in (-math.inf, at, math.inf)}
        | {-1.7976931348623157e308, 1.7976931348623157e308}
    )
    passing = [c for c in values if all(holds(text(template.replace("?", repr(c))), run_) for run_ in runs)]
    if not passing:
        return None
    return passing[0] if is_upward else passing[-1]


@pytest.mark.parametrize("template", THRESHOLDS)
def test_a_threshold_is_the_tightest_with_which_all_runs_satisfy_the_property(tmp_path: Path, template: str) -> None:
    random = Random(template)
    for case in range(share_of(2)):
        runs = [
            [(random.choice(LEVELS), random.choice(LEVELS)) for _ in range(random.randint(1, 4))]
            for _ in range(random.randint(1, 2))
        ]
        files = [recording(tmp_path / f"{case}_{k}.csv", "v,w", rows) for k, rows in enumerate(runs)]
        finding = found(tmp_path, template, *files)
        expected = tightest(template, runs, finding.sought.values.direction == WEAKER)
        assert finding.passes == (expected is not None), runs
        if expected is not None:
            assert finding.sought.values.at(finding.number) == expected, runs


@pytest.mark.parametrize("template", THRESHOLDS)
def test_each_recording_has_the_robustness_of_the_definition_with_the_values_found(
    tmp_path: Path, template: str
) -> None:
    random = Random(template)
    for case in range(share_of(2)):
        runs = [[(random.choice(LEVELS), random.choice(LEVELS)) for _ in range(3)] for _ in range(2)]
        runs = [[(v + 0.12345, w) for v, w in run_] for run_ in runs]  # so that what is found has digits to round
        names = [tmp_path / f"{case}_{k}.csv" for k in range(len(runs))]
        files = [recording(name, "v,w", rows, APART * 1e-9) for name, rows in zip(names, runs, strict=True)]
        (finding,) = mined(tmp_path, text(template), *files, measures=True).findings
        values = {finding.trial, finding.trial.rounded} if finding.result is Result.FOUND else set()
        assert set(finding.measured) == values
        for trial in values:
            filled = text(template.replace("?", trial.text))
            margins = {each.recording: each.report["margin"] for each in finding.measured[trial]}
            expected = [by_how_much_it_holds(filled, rows) for rows in runs]
            assert margins == {
                path: None if math.isinf(number) else number for path, number in zip(files, expected, strict=True)
            }
            assert min(expected) >= 0


BOUNDS = (
    "within ?, eventually w > 1",
    "always (v > 0 implies eventually w > 1 within ?)",
    "always (v > 0 implies always w < 3 for ?)",
    "always (v > 0 implies never w > 1 within ?)",
    "after v > 0, within ?, eventually w < 0.5",
    "not (within ?, eventually w > 1)",
    "always once w < 1 within ?",
    "never historically w > 0 for ?",
    "always (w < 3 since v > 0 within ?)",
    "always age(v) <= ?",
    "eventually age(v) > ?",
    "(eventually v > 0) and (within ?, always w < 3)",
)


def passes(filled: str, path: Path) -> bool:
    """Whether `ltlc run` says that the property holds at the end of the recording."""
    report = run(*from_text(filled), path)
    assert report.session is not None
    return report.session.tracks[0].verdict.holds


@pytest.mark.parametrize("template", BOUNDS)
def test_a_bound_is_the_tightest_with_which_every_recording_passes(tmp_path: Path, template: str) -> None:
    random = Random(template)
    rows = [(random.choice((0, 1)), random.choice((0, 2, 4))) for _ in range(4)]
    path = recording(tmp_path / "run.csv", "v,w", rows, step=2e-9)
    outcomes = [passes(text(template.replace("?", f"{d} ns")), path) for d in [*range(1, 8), 10**15]]
    finding = found(tmp_path, template, path)
    assert finding.passes == any(outcomes), rows
    if outcomes[-1] and not outcomes[0]:
        assert finding.sought.values.at(finding.number) == outcomes.index(True) + 1, rows
    elif outcomes[0] and not outcomes[-1]:
        assert finding.sought.values.at(finding.number) == outcomes.index(False), rows
    elif any(outcomes):
        assert (finding.number, finding.result) == (0, Result.EVERY), rows


# --- which way a property goes ----------------------------------------------------------------------------------------

SMALL, LARGE = "x < 1", "x < 2"


def specification(property_: p.Property, bound: float) -> PropertySpecification:
    below = Comparison(e.Current(X), Relation.LESS, e.Number(bound))
    atoms = (Atom(f"x < {bound:g}", below, Span(0, 0)), Atom("b", IsTrue(e.Current(FLAG)), Span(0, 0)))
    return PropertySpecification("p", 1, Span(0, 0), "", property_, atoms, Alphabet(tuple(a.name for a in atoms)), {})


LETTERS = [frozenset(x) | frozenset(b) for x, b in product([(), (LARGE,), (SMALL, LARGE)], [(), ("b",)])]


@given(properties((SMALL, "b"), 3), st.lists(st.sampled_from(LETTERS), max_size=5).map(tuple))
def test_a_run_that_satisfies_a_property_satisfies_what_is_called_weaker(property_: p.Property, word: Any) -> None:
    other = renamed(property_, {SMALL: LARGE})
    assume(other != property_)
    try:
        way = Monotony(specification(property_, 1.0), specification(other, 2.0)).direction
    except NotMonotoneError:
        return
    strong, weak = (property_, other) if way == WEAKER else (other, property_)
    assert satisfies(word, weak) or not satisfies(word, strong)


def bounded(duration: int, body: p.Property, around: int, event: Any) -> p.Property:
    inner = p.Within(duration, body)
    contexts = (
        inner,
        p.Not(inner),
        p.Always(p.Implies(p.Now(event), inner)),
        p.Never(inner),
        p.Eventually(inner),
        p.Implies(inner, p.Now(event)),
        p.After(event, inner),
        p.Until(event, inner),
    )
    return contexts[around]


@given(
    properties((SMALL, "b"), 2),
    st.integers(0, 7),
    predicates((SMALL, "b")),
    st.lists(st.tuples(st.integers(0, 2), st.sampled_from(LETTERS)), max_size=5),
)
def test_a_run_that_satisfies_a_bound_satisfies_what_is_called_weaker(
    body: p.Property, around: int, event: Any, steps: list[tuple[int, frozenset[str]]]
) -> None:
    short, long = (bounded(duration, body, around, event) for duration in (2, 4))
    try:
        way = Monotony(specification(short, 1.0), specification(long, 1.0)).direction
    except NotMonotoneError:
        return
    times = [sum(gap for gap, _ in steps[: k + 1]) for k in range(len(steps))]
    word = tuple(Instant(time, letter) for time, (_, letter) in zip(times, steps, strict=True))
    strong, weak = (short, long) if way == WEAKER else (long, short)
    assert satisfies(word, weak) or not satisfies(word, strong)


WAYS = [
    ("never v > ?", WEAKER),
    ("always v > ?", -WEAKER),
    ("not (eventually v > ?)", WEAKER),
    ("(eventually v > ?) implies eventually on", WEAKER),
    ("(eventually on) implies eventually v > ?", -WEAKER),
    ("eventually not (v > ?)", WEAKER),
    ("always v <= ?", WEAKER),
    ("always ? <= v", -WEAKER),
    ("always ? < v", -WEAKER),
    ("eventually any(r <= ?)", WEAKER),
    ("never v =={?} 1", -WEAKER),
    ("eventually historically on for ?", -WEAKER),
    ("eventually once on within ?", WEAKER),
    ("eventually (on since v > 1 within ?)", WEAKER),
    ("always on for ?", -WEAKER),
    ("never on within ?", -WEAKER),
    ("within ?, not (eventually on)", -WEAKER),
    ("within ?, not (always on)", WEAKER),
    ("within ?, (eventually on) implies always v > 1", -WEAKER),
    ("within ?, (always on) implies eventually v > 1", WEAKER),
    ("within ?, never eventually on", -WEAKER),
    ("within ?, eventually eventually on", WEAKER),
    ("within ?, until on, v > 1", WEAKER),
    ("within ?, after on, v > 1", -WEAKER),
    ("within ?, after_until on, v > 1, v < 3", -WEAKER),
    ("within ?, (eventually on) and eventually v > 1", WEAKER),
    ("within ?, eventually on or never on", None),
    ("within ?, eventually always on", None),
    ("within ?, (eventually on) and always v > 1", None),
    ("within ?, never always on", None),
    ("within ?, not (until on, v > 1)", -WEAKER),
    ("within ?, after on, eventually v > 1", None),
    ("within ?, after_until on, v > 1, eventually v < 3", None),
    ("after_until v > ?, on, never v > 3", None),
    ("after_until on, v > ?, never v > 3", None),
    ("(never v > ?) and eventually v > 1", WEAKER),
    ("never (v > ? and on) or (on and not v > 2)", WEAKER),
    ("never once (new v and v > ?) 3 times within 2 s", WEAKER),
    ("never once new v 3 times within ?", -WEAKER),
    ("never once v > ? 3 times within 2 s", None),
]


@pytest.mark.parametrize(("property_", "way"), WAYS)
def test_which_way_a_property_goes_as_its_value_grows(tmp_path: Path, property_: str, way: int | None) -> None:
    declared = f"{DECLARATIONS}decl r /scan LaserScan.ranges\n{property_}\n"
    (tmp_path / "props.txt").write_text(declared)
    template, diagnostics = load(tmp_path / "props.txt", [])
    if way is None:
        assert [each.code for each in diagnostics if each.severity.value == "error"] == ["LTL842"]
        return
    assert template is not None, diagnostics
    values = template.sought[0].values
    assert (values.at(0) < values.at(values.last)) == (way == WEAKER)


# --- values -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("property_", "columns", "rows", "value"),
    [
        ("never v > ?", "v", [[0.1], [0.30000000000000004], [0.2]], "0.30000000000000004"),
        ("never v > ?", "v", [[-3], [-2.5]], "-2.5"),
        ("always v >= ?", "v", [[1e300], [1e-300]], "1e-300"),
        ("never ? < v", "v", [[0], ["inf"], [2]], None),
        ("never s > ?", "s", [[0.3], [0.1]], "0.3"),
        ("never s >= ?", "s", [[0.3], [0.1]], "0.30000004"),
        ("never n > ?", "n", [[7], [480]], "480"),
        ("never n >= ?", "n", [[7], [480]], "481"),
        ("always n > ?", "n", [[7], [480]], "6"),
        ("never n > ?", "n", [[0]], "0"),
        ("always v =={?} 1", "v", [[0.75], [1.5]], "0.5"),
        ("never v !={?} 1", "v", [[1], [1]], "0"),
        ("never any(ranges > ?)", "ranges[0],ranges[1]", [[1, 5], [2, "nan"]], "5"),
        ("always count(ranges > 1) <= ?", "ranges[0],ranges[1]", [[1, 5], [2, 3]], "2"),
        ("always count(ranges > ?) < 2", "ranges[0],ranges[1]", [[1, 5], [2, 3]], "2"),
        ("eventually on within ?", "on", [[0], [0], [1]], "2 s"),
        ("within ?, eventually on", "on", [[0], *[[0]] * 1499, [1]], "25 min"),
    ],
)
def test_a_value_is_written_so_that_it_reads_back_exactly(
    tmp_path: Path, property_: str, columns: str, rows: Sequence[Sequence[Any]], value: str | None
) -> None:
    more = "decl ranges /laser LaserScan.ranges\n"
    path = recording(tmp_path / "run.csv", columns, rows)
    mined_ = mined(tmp_path, more + text(property_), path)
    if value is None:
        assert mined_.findings[0].result is Result.NONE
        return
    assert mined_.findings[0].trial.text == value
    values = mined_.values(exact=True)
    assert values is not None
    filled = mined_.template.text(values)
    assert filled == more + text(property_.replace("?", value))
    assert passes(filled, path)


@pytest.mark.parametrize(
    ("step", "value"),
    [(0.05, "50 ms"), (2.5, "2.5 s"), (1.000000001, "1.000000001 s"), (0.0123456, "12.3456 ms"), (60, "1 min")],
)
def test_a_duration_is_written_in_a_unit_that_is_easy_to_read(tmp_path: Path, step: float, value: str) -> None:
    path = recording(tmp_path / "run.csv", "on", [[0], [1]], step)
    assert found(tmp_path, "eventually on within ?", path).trial.text == value


def test_an_integer_of_64_bits_is_exact(tmp_path: Path) -> None:
    (tmp_path / "props.txt").write_text("decl big /big std_msgs/UInt64.data\nnever big > ?\n")
    template, _ = load(tmp_path / "props.txt", [])
    assert template is not None
    path = recording(tmp_path / "run.csv", "big", [[2**64 - 1], [3]])
    (finding,) = mine(template, [path], Budget()).findings
    assert finding.trial.text == str(2**64 - 1)


def test_all_that_a_forall_stands_for_has_one_value(tmp_path: Path) -> None:
    path = recording(tmp_path / "run.csv", "r1,r2", [[1, 2], [4, 3]])
    finding = found(tmp_path, "fast: forall r in {r1, r2}: never r > ?", path)
    assert (finding.trial.text, finding.sought.label) == ("4", "fast")
    assert finding.failure is not None
    assert finding.failure.answer.failing.property.text == "never r1 > 3.9999999999999996"


def test_of_a_forall_that_starts_in_part_the_rest_is_told(tmp_path: Path) -> None:
    path = recording(tmp_path / "run.csv", "r1", [[1], [4]])
    finding = found(tmp_path, "forall r in {r1, r2}: never r > ?", path)
    assert finding.trial.text == "4"
    assert finding.not_started == {path: ["the recording has no column `r2`", "0 steps"]}


def test_a_search_ends_at_the_first_number_that_passes_wherever_the_hints_are() -> None:
    random = Random(5)
    for _ in range(share_of(300)):
        last = random.choice([0, 1, 2, 10, 2**62])
        first = random.randint(0, last + 1)
        search, looks = Search(0, last), 0
        while not search.is_done:
            numbers = search.numbers()
            assert numbers, (search, first)
            search.learn({number: number >= first for number in numbers})
            search.hints = [random.randint(0, last) for _ in range(random.randint(0, 2))]
            looks += 1
        assert search.found == (first if first <= last else None)
        assert looks <= 64


# --- rounding ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("property_", "columns", "rows", "step", "value"),
    [
        ("never v > ?", "v", [[2.34567]], 1, "2.35"),
        ("never v > ?", "v", [[0.30000000000000004]], 1, "0.301"),
        ("never v >= ?", "v", [[2.5]], 1, "2.51"),
        ("never v > ?", "v", [[2.5]], 1, "2.5"),
        ("never v > ?", "v", [[9.999]], 1, "10"),
        ("never v > ?", "v", [[-2.34567]], 1, "-2.34"),
        ("always v >= ?", "v", [[2.34567]], 1, "2.34"),
        ("always v >= ?", "v", [[-2.34567]], 1, "-2.35"),
        ("always v >= ?", "v", [[0]], 1, "0"),
        ("never v > ?", "v", [[5250123.4]], 1, "5250124"),
        ("never v > ?", "v", [[1.23456e-9]], 1, "1.24e-09"),
        ("never v > ?", "v", [[5e-324]], 1, "5e-324"),
        ("never v > ?", "v", [[1.7976931348623157e308]], 1, "1.7976931348623157e+308"),
        ("never v >= ?", "v", [[-1.7976931348623157e308]], 1, "-1.7976931348623155e+308"),
        ("never s > ?", "s", [[0.3]], 1, "0.3"),
        ("never s >= ?", "s", [[0.3]], 1, "0.301"),
        ("always s > ?", "s", [[0.3]], 1, "0.299"),
        ("never s > ?", "s", [[3.4028235e38]], 1, "3.4028235e+38"),
        ("never n > ?", "n", [[123457]], 1, "123457"),
        ("never n >= ?", "n", [[2**32 - 1]], 1, "4294967296"),
        ("always v =={?} 1", "v", [[1.23456]], 1, "0.235"),
        ("always v !={?} 1", "v", [[1.23456]], 1, "0.234"),
        ("always v !={?} 1", "v", [[1.0000000000000002]], 1, "2.22e-16"),
        ("eventually on within ?", "on", [[0], [1]], 0.000123456, "124 us"),
        ("eventually on within ?", "on", [[0], [1]], 0.0123456, "12.4 ms"),
        ("eventually on within ?", "on", [[0], [1]], 0.000000002, "2 ns"),
        ("eventually on within ?", "on", [[0], [1]], 1.000000001, "1.01 s"),
        ("eventually on within ?", "on", [[0], [1]], 5025.678, "5026 s"),
        ("eventually on within ?", "on", [[0], [1]], 1500, "25 min"),
        ("within ?, never on", "on", [[0], [1]], 1.23456, "1.23 s"),
        ("within ?, never on", "on", [[0], [1]], 0.000000002, "1 ns"),
    ],
)
def test_a_value_is_rounded_to_three_digits_or_to_whole_numbers_on_the_weaker_side(
    tmp_path: Path, property_: str, columns: str, rows: Sequence[Sequence[Any]], step: float, value: str
) -> None:
    path = recording(tmp_path / "run.csv", columns, rows, step)
    mined_ = mined(tmp_path, text(property_), path)
    values = mined_.values()
    assert values is not None
    assert [each.text for each in values] == [value]
    filled = mined_.template.text(values)
    assert filled == text(property_.replace("?", value))
    assert passes(filled, path)


def drawn(chance: Random) -> float:
    return chance.uniform(-4, 4) * 10.0 ** chance.choice((-3, 0, 0, 0, 4))


@pytest.mark.parametrize("template", [*THRESHOLDS, *BOUNDS, "always v =={?} w", "never s >= ?", "always s > ?"])
def test_all_recordings_pass_what_is_rounded_and_one_fails_what_is_tighter_than_exact(
    tmp_path: Path, template: str
) -> None:
    chance = Random(template)
    for case in range(share_of(2)):
        files = [
            recording(
                tmp_path / f"{case}_{k}.csv",
                "v,w,s",
                [(drawn(chance), drawn(chance), drawn(chance)) for _ in range(chance.randint(2, 6))],
                step=chance.uniform(1e-6, 4),
            )
            for k in range(2)
        ]
        mined_ = mined(tmp_path, text(template), *files)
        rounded, exact = mined_.values(), mined_.values(exact=True)
        if rounded is None or exact is None:
            continue
        assert all(passes(mined_.template.text(each), path) for each in (rounded, exact) for path in files)
        (found_,) = exact
        if found_.number > 0:
            tighter = mined_.template.text([replace(found_, number=found_.number - 1)])
            assert not all(passes(tighter, path) for path in files)
        (one, other) = (each.sought.values.at(each.number) for each in (*exact, *rounded))
        assert abs(one - other) <= max(1e-2 * abs(one), 1 if found_.sought.values.numbers is None else 0)


def test_what_is_rounded_already_stays_and_only_gets_weaker() -> None:
    chance = Random(7)
    for direction, numbers in product((WEAKER, -WEAKER), (None, DOUBLES, SINGLES, Numbers(Kind.INTEGER, 0, 255))):
        role = Role.DURATION if numbers is None else Role.THRESHOLD
        among = values(role, direction, [numbers])
        for _ in range(share_of(300)):
            number = chance.randint(0, among.last)
            rounded = among.rounded(number)
            assert number <= rounded <= among.last
            assert among.rounded(rounded) == rounded
        assert (among.rounded(0), among.rounded(among.last)) == (0, among.last)


# --- several recordings -----------------------------------------------------------------------------------------------


def three(folder: Path) -> list[Path]:
    return [recording(folder / f"{k}.csv", "v", [[0], [top], [0]]) for k, top in enumerate((1, 3, 2))]


def test_the_recording_that_decides_is_told_with_how_the_next_tighter_value_fails(tmp_path: Path) -> None:
    finding = found(tmp_path, "never v > ?", *three(tmp_path))
    assert finding.trial.text == "3"
    assert finding.failure is not None
    assert finding.failure.recording.name == "1.csv"
    decided = finding.failure.answer.failing.decided_at
    assert decided is not None
    assert (decided.step, dict(decided.values)) == (1, {"v": 3.0})


def test_with_each_every_recording_has_its_own_value(tmp_path: Path) -> None:
    mined_ = mined(tmp_path, text("never v > ?"), *three(tmp_path), each=True)
    (finding,) = mined_.findings
    values = {path.name: finding.sought.values.at(n) for path, n in finding.alone.items() if n is not None}
    assert values == {"0.csv": 1.0, "1.csv": 3.0, "2.csv": 2.0}
    assert finding.trial.text == "3"


def test_a_recording_that_passes_already_is_looked_at_once(tmp_path: Path) -> None:
    one, two, _ = three(tmp_path)
    alone = mined(tmp_path, text("never v > ?"), two).looks
    assert mined(tmp_path, text("never v > ?"), two, one).looks == alone + 1


@pytest.mark.parametrize("is_kept", [True, False])
def test_a_recording_is_read_once_or_again_if_it_is_too_large_to_keep(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, is_kept: bool
) -> None:
    opened: list[Path] = []

    def counted(path: Path, *arguments: Any) -> Any:
        opened.append(path)
        return open_recording(path, *arguments)

    monkeypatch.setattr(oracle, "open_recording", counted)
    if not is_kept:
        monkeypatch.setattr(oracle, "MOST_KEPT", 10)
    recordings = three(tmp_path)
    assert found(tmp_path, "never v > ?", *recordings).trial.text == "3"
    assert (len(opened) == len(recordings)) == is_kept


def test_a_recording_in_which_a_property_never_starts_is_told_and_does_not_count(tmp_path: Path) -> None:
    first = recording(tmp_path / "first.csv", "w", [[1], [2]])
    finding = found(tmp_path, "never v > ?", first, *three(tmp_path))
    assert (finding.trial.text, [path.name for path in finding.not_started]) == ("3", ["first.csv"])
    assert found(tmp_path, "never v > ?", first).result is Result.NOT_STARTED


def test_what_never_happens_has_no_value_that_passes(tmp_path: Path) -> None:
    path = recording(tmp_path / "run.csv", "on", [[0], [0]])
    finding = found(tmp_path, "eventually on within ?", path)
    assert finding.result is Result.NONE
    assert finding.failure is not None
    assert (finding.failure.recording, finding.failure.answer.failing.open_since is not None) == (path, True)


@pytest.mark.parametrize(
    "template", ["always (v > 0 implies always w < 1 for ?)", "always v =={?} w", "never v - w > ?"]
)
def test_infinite_values_end_no_search(tmp_path: Path, template: str) -> None:
    path = recording(tmp_path / "run.csv", "v,w", [[0, 0], [1, "inf"], ["inf", "inf"], ["-inf", "inf"], [0, 0]])
    assert isinstance(found(tmp_path, template, path).result, Result)


def test_what_is_owed_at_the_end_of_a_recording_does_not_pass(tmp_path: Path) -> None:
    path = recording(tmp_path / "run.csv", "v,on", [[0, 0], [1, 0], [0, 1], [1, 0]])
    assert found(tmp_path, "always (v > 0 implies eventually on within ?)", path).result is Result.NONE


def test_where_nothing_triggers_every_value_passes(tmp_path: Path) -> None:
    path = recording(tmp_path / "run.csv", "v,w", [[0, 0], [1, 1]])
    finding = found(tmp_path, "after_until w > 5, w < 1, always v < ?", path)
    assert (finding.result, finding.never_triggered) == (Result.EVERY, True)
    assert not found(tmp_path, "eventually v == 0 within ?", path).never_triggered


def test_ticks_begin_with_the_first_message_of_any_property_as_in_a_run(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("time,v,w\n0,,1\n0.5,1,\n0.9,5,\n1.2,2,\n2.5,0,\n")
    both = text("_rate_ = 1", "never w > 3", "never v > ?")
    assert mined(tmp_path, both, path).findings[0].trial.text == "5"
    assert mined(tmp_path, both.replace("never w > 3", ""), path).findings[0].trial.text == "2"


# --- what is refused --------------------------------------------------------------------------------------------------


def codes(folder: Path, specification: str) -> list[str]:
    (folder / "props.txt").write_text(specification)
    template, diagnostics = load(folder / "props.txt", [])
    errors = [d.code for d in diagnostics if d.severity.value == "error"]
    assert (template is None) == bool(errors)
    return errors


@pytest.mark.parametrize(
    "property_",
    [
        "never v > 2 * ?",
        "never v > -?",
        "never v in {1, ?}",
        "never max(v, ?) > 1",
        "never v > ? and w > ?",
        "never v =={?} ?",
        "always ?",
        "fast = v > ?\nnever fast",
        "limit = ?\nnever v > limit",
        "_rate_ = ?\nnever v > ?",
        "never v >{?} 1",
        "eventually on within ? s",
        "never v > ? m/s",
    ],
)
def test_a_parameter_stands_by_itself_and_once_in_a_property(tmp_path: Path, property_: str) -> None:
    assert codes(tmp_path, text(property_)) == ["LTL841"]


@pytest.mark.parametrize(
    ("property_", "reason"),
    [
        ("never v == ?", "`==` holds for one number"),
        ("never (v > ?) == on", "both under a negation and outside one"),
        ("never 3 > ?", "a constant"),
        ("after v > ?, never on", "where a scope begins or ends"),
        ("until v > ?, never on", "where a scope begins or ends"),
        ("after_until v > 1, once on within ?, never w > 3", "where a scope begins or ends"),
        ("after_until v > 1, v < 1, within ?, always eventually on", "can become true as well as false"),
        ("within ?, initially on", "is about a single step"),
    ],
)
def test_a_property_that_is_not_monotone_is_refused_with_the_reason(
    tmp_path: Path, property_: str, reason: str
) -> None:
    (tmp_path / "props.txt").write_text(text(property_))
    template, diagnostics = load(tmp_path / "props.txt", [])
    assert template is None
    (error,) = [d for d in diagnostics if d.severity.value == "error"]
    assert error.code == "LTL842"
    assert reason in error.message
    assert error.help
    assert error.primary is not None
    assert error.source.text[error.primary.span.start] == "?"


def test_a_file_without_a_parameter_is_refused(tmp_path: Path) -> None:
    assert codes(tmp_path, text("never v > 1")) == ["LTL843"]


def test_other_mistakes_are_found_where_they_stand(tmp_path: Path) -> None:
    assert codes(tmp_path, text("never vv > ?")) == ["LTL101"]
    assert codes(tmp_path, text("never on > ?")) == ["LTL205"]
    assert codes(tmp_path, text("never v >")) == ["LTL006"]


@pytest.mark.parametrize("command", ["check", "build", "run", "explain"])
def test_other_commands_say_that_the_value_is_to_be_found_first(
    tmp_path: Path, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "props.txt"
    path.write_text("decl v /odom Odometry.twist.twist.linear.x\nnever v > ?\n")
    recordings = [str(recording(tmp_path / "run.csv", "v", [[1]]))] if command == "run" else []
    assert main([command, str(path), *recordings]) == (2 if command == "run" else 1)
    shown = "".join(capsys.readouterr())
    assert "LTL840" in shown
    assert "ltlc mine PROPS RECORDING" in shown
    assert "props.txt:2:11" in shown


# --- the command ------------------------------------------------------------------------------------------------------

PROPS = """decl v /odom Odometry.twist.twist.linear.x
decl on /flag std_msgs/Bool.data
top: never v > ?  # the fastest
# how long it takes
eventually on within ?
always v < 100
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("props.txt").write_text(PROPS)
    recording(Path("a.csv"), "v,on", [[1, 0], [2.5, 0], [0, 1]])
    recording(Path("b.csv"), "v,on", [[1, 0], [2, 1]])
    recording(Path("never.csv"), "v,on", [[1, 0], [2, 0]])
    recording(Path("other.csv"), "v", [[1], [2]])
    Path("damaged.csv").write_text("time,v,on\n0,1,0\n1,x,1\n")
    return tmp_path


def test_the_report_has_the_property_to_paste_and_the_moment_that_decides(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["mine", "props.txt", "a.csv", "b.csv"]) == 0
    assert (
        capsys.readouterr().out
        == """\
line 3 of props.txt (top):
  top: never v > 2.5
  decided by a.csv: with 2.4999999999999996 it is violated at +1 s (step 1)
    Error at line 3 of props.txt (top[2.4999999999999996]):
      never v > 2.4999999999999996
    Failing state:
      v: 2.5
    Because:
      v > 2.4999999999999996: true, 2.5 > 2.4999999999999996 by 4.44089e-16
    At +1 s (step 1).
    1 violation, for 1 s
  passes in 2 recordings

line 5 of props.txt:
  eventually on within 2 s
  decided by a.csv: with 1.999999999 s it is violated at +2 s (after step 1)
    Error at line 5 of props.txt (line 5[1.999999999 s]):
      eventually on within 1.999999999 s
    Failing state:
      on: false
    Because:
      more than 1.999999999 s since the beginning: true
    Unmet since +0 s (step 0): eventually on within 1.999999999 s
    At +2 s (after step 1).
    1 violation, at an instant
  passes in 2 recordings
"""
    )


ROUNDED = """\
line 3 of props.txt (top):
  top: never v > 2.35
  rounded outwards; `--exact` gives 2.34567
"""


def test_values_are_rounded_outwards_which_is_reported_unless_they_are_to_be_exact(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording(Path("c.csv"), "v,on", [[1.23456, 0], [2.34567, 1]], step=1.23456)
    arguments = ["mine", "props.txt", "b.csv", "c.csv", "--each", "--write", "tight.txt"]
    assert main(arguments) == 0
    shown = capsys.readouterr().out
    assert shown.startswith(ROUNDED)
    assert "  c.csv by itself: 2.35\n" in shown
    assert "  eventually on within 1.24 s\n  rounded outwards; `--exact` gives 1.23456 s\n" in shown
    assert Path("tight.txt").read_text() == PROPS.replace("> ?", "> 2.35").replace("within ?", "within 1.24 s")
    assert main([*arguments, "--exact"]) == 0
    shown = capsys.readouterr().out
    assert "rounded" not in shown
    assert "  top: never v > 2.34567\n" in shown
    assert "  c.csv by itself: 2.34567\n" in shown
    assert Path("tight.txt").read_text() == PROPS.replace("> ?", "> 2.34567").replace("within ?", "within 1.23456 s")


def test_the_json_document_has_the_exact_value_and_the_rounded_one(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording(Path("c.csv"), "v,on", [[2.34567, 0], [1, 1]], step=1.23456)
    for more in ([], ["--exact"]):
        assert main(["mine", "props.txt", "c.csv", "--format", "json", *more]) == 0
        top, bound = json.loads(capsys.readouterr().out)["properties"]
        assert (top["value"], top["text"]) == (2.34567, "top: never v > 2.34567")
        assert top["rounded"] == {"value": 2.35, "value_ns": None, "written": "2.35", "text": "top: never v > 2.35"}
        assert (bound["value_ns"], bound["rounded"]["value_ns"]) == (1_234_560_000, 1_240_000_000)


def test_with_robustness_the_recording_that_comes_closest_is_reported_and_with_each_all(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording(Path("c.csv"), "v,on", [[2.34567, 0], [1, 1]])
    arguments = ["mine", "props.txt", "b.csv", "c.csv"]
    closest = "  passes in 2 recordings\n  closest to failing: c.csv, robustness 0.00433 at +0 s: v > 2.35\n"
    assert main([*arguments, "--robustness"]) == 0
    shown = capsys.readouterr().out
    assert f"{closest}\nline 5" in shown
    assert shown.endswith("  passes in 2 recordings\n  robustness: none: no comparison of numbers decides it\n")
    assert main([*arguments, "--robustness", "--each"]) == 0
    assert (
        f"{closest}"
        "  b.csv by itself: 2; robustness with 2.35: 0.35 at +1 s: v > 2.35\n"
        "  c.csv by itself: 2.35; robustness with 2.35: 0.00433 at +0 s: v > 2.35\n"
    ) in capsys.readouterr().out
    assert main([*arguments, "--robustness", "--exact"]) == 0
    assert "  closest to failing: c.csv, robustness 0 at +0 s: v > 2.34567\n" in capsys.readouterr().out
    assert main([*arguments, "--each"]) == 0
    assert "robustness" not in capsys.readouterr().out


def test_json_has_the_robustness_of_each_recording_with_the_exact_value_and_with_the_rounded_one(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording(Path("c.csv"), "v,on", [[1, 0], [2.34567, 1]])
    arguments = ["mine", "props.txt", "b.csv", "c.csv", "--format", "json"]
    assert main([*arguments, "--robustness"]) == 0
    document = json.loads(capsys.readouterr().out)
    top, bound = document["properties"]
    assert [(each["recording"], each["label"]) for each in top["robustness"]] == [
        ("b.csv", "top[2.34567]"),
        ("c.csv", "top[2.34567]"),
    ]
    assert [each["margin"] for each in top["robustness"]] == [2.34567 - 2, 0]
    assert [each["margin"] for each in top["rounded"]["robustness"]] == [2.35 - 2, 2.35 - 2.34567]
    assert top["rounded"]["robustness"][1] | {"margin": 0} == {
        "recording": "c.csv",
        "label": "top[2.35]",
        "margin": 0,
        "reason": None,
        "comparison": "v > 2.35",
        "time": 1.0,
        "time_ns": 1_000_000_000,
        "offset": 1.0,
    }
    assert [each["reason"] for each in bound["robustness"]] == ["no comparison of numbers decides it"] * 2
    assert main(arguments) == 0
    without = json.loads(capsys.readouterr().out)
    assert document["looks"] == without["looks"] + 2
    assert "robustness" not in without["properties"][0] | without["properties"][0]["rounded"]


def test_what_cannot_be_measured_in_a_recording_is_counted_with_the_reason(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("some.txt").write_text(
        "decl v /v std_msgs/Int64.data\ndecl w /w std_msgs/Int64.data\nall: forall x in {v, w}: never x < ?\n"
    )
    small = recording(Path("small.csv"), "v,w", [[2, 5], [3, 7]])
    large = recording(Path("large.csv"), "v,w", [[2, 2**60 + 1], [3, 9]])
    partly = recording(Path("partly.csv"), "v", [[4], [5]])
    assert main(["mine", "some.txt", *map(str, (small, large, partly)), "--robustness", "--each"]) == 0
    shown = capsys.readouterr().out
    assert ("  all: forall x in {v, w}: never x < 2\n") in shown
    assert (
        "  closest to failing: small.csv, robustness 0 at +0 s: v < 2\n"
        "  robustness: none in 1 of 3 recordings: integers that are not doubles\n"
        "  small.csv by itself: 2; robustness with 2: 0 at +0 s: v < 2\n"
        "  large.csv by itself: 2; robustness with 2: none: integers that are not doubles\n"
        "  partly.csv by itself: 4; robustness with 2: 2 at +0 s: v < 2\n"
    ) in shown


def test_the_specification_is_written_with_its_comments(folder: Path) -> None:
    assert main(["mine", "props.txt", "a.csv", "b.csv", "--write", "tight.txt"]) == 0
    expected = PROPS.replace("> ?", "> 2.5").replace("within ?", "within 2 s")
    assert Path("tight.txt").read_text() == expected
    assert main(["run", "tight.txt", "a.csv"]) == 0


@pytest.mark.parametrize(
    ("recordings", "code"),
    [
        (["a.csv", "never.csv"], 1),
        (["a.csv", "damaged.csv"], 2),
        (["a.csv", "missing.csv"], 2),
        (["other.csv"], 3),
    ],
)
def test_the_exit_code_says_whether_all_was_found_and_else_nothing_is_written(
    folder: Path, recordings: list[str], code: int, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["mine", "props.txt", *recordings, "--write", "tight.txt"]) == code
    assert not Path("tight.txt").exists()
    assert "tight.txt is not written" in capsys.readouterr().err


def test_a_file_that_cannot_be_written_is_told_before_anything_is_read(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["mine", "props.txt", "a.csv", "--write", "."]) == 2
    shown = capsys.readouterr()
    assert (shown.out, "cannot be written" in shown.err) == ("", True)


def test_what_has_no_value_is_told_in_words(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main(["mine", "props.txt", "other.csv", "never.csv", "a.csv"])
    shown = capsys.readouterr().out
    assert "no value passes: in never.csv, even with 878400 h it is presumably violated; unmet since +0 s" in shown
    assert "not started in other.csv: " in shown
    assert shown.endswith("  not examined, as no value would pass: a.csv\n")


def test_a_part_of_a_recording_says_what_a_recording_of_that_part_says(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = [(k, Random(k).randint(0, 50), int(k > 6)) for k in range(9)]
    for name, part in (("whole", rows), ("part", rows[2:8])):
        Path(f"{name}.csv").write_text("time,v,on\n" + "".join(f"{t},{v},{on}\n" for t, v, on in part))
    values = []
    for arguments in (["whole.csv", "--from", "2", "--until", "7"], ["part.csv"]):
        assert main(["mine", "props.txt", *arguments, "--format", "json"]) == 0
        values.append([each["value"] for each in json.loads(capsys.readouterr().out)["properties"]])
    assert values[0] == values[1]


def test_the_times_of_a_bag_are_those_in_headers_if_they_are_asked_for(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    seconds = [10**9 * (1_700_000_000 + k) for k in range(9)]
    sent = [odometry(seconds[k], stamp=seconds[2 * k], pose__pose__position__x=float(k)) for k in range(5)]
    rosbag2(folder / "bag", sent)
    Path("props.txt").write_text("decl x /odom Odometry.pose.pose.position.x\neventually x >= 4 within ?\n")
    for stamp, value in (("log", "4 s"), ("header", "8 s")):
        assert main(["mine", "props.txt", "bag", "--stamp", stamp]) == 0
        assert f"eventually x >= 4 within {value}" in capsys.readouterr().out


def test_the_json_document_has_values_and_moments(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["mine", "props.txt", "a.csv", "b.csv", "damaged.csv", "--format", "json", "--each"]) == 2
    document = json.loads(capsys.readouterr().out)
    top, bound = document["properties"]
    assert (top["result"], top["value"], top["written"], top["text"]) == ("found", 2.5, "2.5", "top: never v > 2.5")
    assert (bound["value"], bound["value_ns"], bound["written"]) == (2.0, 2_000_000_000, "2 s")
    assert top["decided_by"]["recording"] == "a.csv"
    assert top["decided_by"]["property"]["decided_at"]["time_ns"] == 1_000_000_000
    assert [each["value"] for each in top["alone"]] == [2.5, 2.0]
    assert document["unusable"] == ["damaged.csv"]
    assert [each["code"] for each in document["diagnostics"]] == ["LTL803"]


# --- monitors of one shape --------------------------------------------------------------------------------------------

ONE_BOUND = (
    *BOUNDS,
    "always age(v) < ?",
    "always (new v implies eventually w > 1 within ?)",
    "until v > 1, within ?, eventually w > 1",
)


@pytest.mark.parametrize("template", ONE_BOUND)
def test_the_monitor_of_a_property_with_one_bound_is_the_same_for_every_bound(template: str) -> None:
    def monitor(bound: str) -> Any:
        specification, _ = load_text(Source("props.txt", text(template.replace("?", bound))))
        assert specification is not None
        (property_,) = specification.properties
        made = translate(encode(property_.property, EPISODE), property_.alphabet)
        return replace(made, atoms=tuple(str(k) for k in range(len(made.atoms))))

    assert monitor("3 ns") == monitor("4 ns") == monitor("1 s") == monitor("1000 h")
