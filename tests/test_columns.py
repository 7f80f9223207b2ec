"""Recordings judged by columns, beside the session that judges them row by row."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from columns_support import DECLARATIONS, Draw, Drawn, judged, sizes, state, trails
from effort import share_of
from hypothesis import given, settings
from hypothesis import strategies as st
from stepping import FLAG, FLAGS, MODE, NAMES, SAMPLES, SCAN, X, Y, Z, from_text, numeric

from ltlc.backends.python.load import load_plan
from ltlc.cli import main
from ltlc.inputs.recordings.blocks import Block, Samples, blocks_of, packed
from ltlc.inputs.recordings.rows import Column, Row
from ltlc.inputs.recordings.trails import Trailing
from ltlc.monitoring.columns import bits, follow, thresholds, tracks
from ltlc.monitoring.columns.bits import pack, unpack
from ltlc.monitoring.columns.prepared import prepare_all
from ltlc.monitoring.columns.series import Columns, Steps
from ltlc.monitoring.columns.session import ByBlocks
from ltlc.monitoring.columns.thresholds import compared
from ltlc.monitoring.columns.ticks import times_of
from ltlc.monitoring.columns.values import value, wanted_of
from ltlc.program.expressions import Kept
from ltlc.program.lowering import lowered, read
from ltlc.runtime.sampling import Reading, Sampler
from ltlc.runtime.session import Session
from ltlc.runtime.ticks import Ticks
from ltlc.specification import expressions as e
from ltlc.specification.evaluation import compare, evaluate
from ltlc.specification.expressions import Count, Relation, ValueType
from ltlc.specification.wire import PRIMITIVES


@pytest.mark.parametrize("seed", range(share_of(50)))
def test_what_columns_find_is_what_the_session_finds_row_by_row(seed: int) -> None:
    drawn = Draw(Random(seed)).drawn()
    with sizes(Random(seed)):
        reference, fast = judged(drawn)
    assert state(fast.session) == state(reference), drawn.text


@pytest.mark.parametrize("seed", range(share_of(30)))
def test_what_properties_go_through_is_by_columns_what_it_is_row_by_row(seed: int) -> None:
    drawn = Draw(Random(seed)).drawn()
    reference, fast = judged(drawn, Trailing)
    assert state(fast.session) == state(reference), drawn.text
    assert trails(fast.session) == trails(reference), drawn.text


def test_a_trail_has_each_deadline_that_a_message_moves() -> None:
    text = DECLARATIONS + "(always age(v) <= 2 s) and eventually w > 5"
    reference, fast = judged(Drawn(text, [rows(20, v=lambda _: 2.0, w=lambda _: 0.0)]), Trailing)
    assert [way.because for way in fast.ways] == [{}]
    assert "Deadline(since=0, due=2000000001, until=100000000)" in trails(reference)[0]
    assert trails(fast.session) == trails(reference)


def rows(count: int, **columns: Any) -> list[Row]:
    """A row each 0.1 s; what is called gives the value of a row."""
    return [Row(i * 10**8, {name: of(i) for name, of in columns.items()}) for i in range(count)]


def both(text: str, parts: Sequence[Sequence[Row]]) -> tuple[list[Any], list[Any], list[str]]:
    """What rows and columns find, and why what was judged by rows was."""
    reference, fast = judged(Drawn(DECLARATIONS.replace("decl n /n Int64.data", "decl n /n UInt64.data") + text, parts))
    return state(reference), state(fast.session), [reason for way in fast.ways for reason in way.because]


@pytest.mark.parametrize(
    "text",
    [
        "never v > 3.5",
        "always (v < 1 implies eventually w > 1.5)",
        "after_until v < 1, v > 3, eventually w > 1.5",
        "always (after_until v < 1, v > 3, eventually w > 1.5)",
        "after v < 1, after_until w > 1, w < 0.5, never v > 3.9",
        "always (v < 1 implies eventually w > 1.5 within 2 s)",
        "always (v > 3 implies never w > 1.9 within 3 s)",
        "never historically w > 1.5 for 4 s",
        "always (w > 1.9 implies once v > 3 within 5 s)",
    ],
)
def test_long_recordings_in_several_blocks_are_judged_alike(text: str) -> None:
    found = rows(3000, v=lambda i: 2 + 1.95 * math.cos(i / 70), w=lambda i: 1 + math.sin(i / 31))
    reference, fast, because = both(f"p: {text}\n", [found[:7], found[7:1800], found[1800:]])
    assert (fast, because) == (reference, [])


FORMS = (
    "never {v} > {high} + 1",
    "always ({v} < {low} implies eventually {w} > {high})",
    "after_until {v} < {low}, {v} > {high}, eventually {w} > {high}",
    "after {v} > {high}, never {w} < {low}",
)


def fleet(chance: Random, count: int) -> str:
    """Properties of a few shapes, some with the same thresholds, some with NaN now and then."""
    text = ""
    for number in range(count):
        v, w = chance.sample(["v", "w", "pair_x"], 2)
        low, high = chance.choice([0.25, 0.5, chance.random()]), chance.choice([1.5, 1 + chance.random()])
        text += f"p{number}: {FORMS[number % 4].format(v=v, w=w, low=low, high=high)}\n"
    return text


@pytest.mark.parametrize("period", [400, 60, 2])
def test_many_properties_of_equal_shapes_are_judged_as_each_alone(period: int) -> None:
    chance, gap = Random(period), math.nan if period == 60 else 0.0
    found = rows(
        1500,
        v=lambda i: 1 + math.cos(i / period),
        w=lambda i: 1 + chance.choice([0, 0, 0.01]) + math.sin(i / period / 1.3),
        pair_x=lambda i: gap if i % 97 == 5 else 1 + math.cos(i / period * 2),
        pair_y=lambda i: 0.0,
    )
    reference, fast, because = both(fleet(chance, 40), [found[:700], found[700:1201], found[1201:]])
    assert (fast, because) == (reference, [])


def test_properties_of_equal_shapes_are_taken_together(monkeypatch: pytest.MonkeyPatch) -> None:
    found, run, together = rows(3000, v=lambda i: math.cos(i / 70), w=lambda i: math.sin(i / 31)), follow.run, []

    def counted(tables: Any, columns: Any, *others: Any) -> Any:
        together.append(len(columns))
        return run(tables, columns, *others)

    monkeypatch.setattr(tracks, "run", counted)
    text = "".join(f"p{n}: always (v > 0.{n} implies eventually w > 0.{n})\n" for n in range(1, 10))
    both(text + "q: eventually v > 2\n", [found])
    assert sorted(together) == [1, 9]


def test_letters_may_change_at_every_sample_of_a_long_recording() -> None:
    chance = Random(3)
    found = rows(9000, v=lambda i: chance.choice([0.0, 2.0]), w=lambda i: chance.choice([0.0, 2.0, 2.0]))
    text = "p: always (v > 1 implies eventually w > 1)\nq: always (after_until v > 1, w < 1, eventually v < 1)\n"
    reference, fast, because = both(text, [found])
    assert (fast, because) == (reference, [])


def test_more_atoms_than_a_table_has_are_judged_by_columns_all_the_same() -> None:
    atoms = " or ".join(f"v == {number}" for number in range(10))
    found = rows(500, v=lambda i: float(i // 40 % 12), w=lambda i: float(i % 9))
    text = f"p: always (({atoms}) implies eventually w > 7)\nq: after_until w > 7, w < 1, eventually ({atoms})\n"
    reference, fast, because = both(text, [found[:100], found[100:]])
    assert (fast, because) == (reference, [])


def test_overlapping_episodes_are_counted() -> None:
    text = "p: always (after_until v > 1, v < 0.5, eventually w > 1)\n"
    found = rows(100, v=lambda i: [0.0, 2.0, 2.0, 2.0, 0.7][i % 5], w=lambda i: 2.0)
    reference, fast, because = both(text, [found[:33], found[33:]])
    assert (fast, because) == (reference, [])
    assert "60 episodes" in fast[1]


def test_integers_that_are_no_doubles_are_judged_by_rows_where_they_occur() -> None:
    found = rows(60, n=lambda i: 2**60 + 1 if i == 45 else i)
    reference, fast, because = both("p: never n == 1152921504606846977\n", [found[:40]])
    assert (fast, because) == (reference, ["an integer that is not a double"])
    reference, fast, because = both("p: never n > 1000\n", [found[:40], found[40:]])
    assert (fast, because) == (reference, ["integers that are not doubles"])


@pytest.mark.parametrize("past", ["when v > 1", "-1 else 1"])
def test_integers_of_the_past_are_reported_as_integers(past: str) -> None:
    drawn = Drawn(f"{DECLARATIONS}p: never n > @{{n, {past}}} + 5\n", [rows(20, v=lambda _: 2.0, n=lambda i: i * i)])
    reference, fast = judged(drawn)
    assert state(fast.session) == state(reference)


@pytest.mark.parametrize("largest", [3, 2**63 - 1, 2**64 - 1])
def test_an_integer_is_held_through_a_block_without_any(largest: int) -> None:
    declared = "decl n /n UInt64.data\ndecl v /v Float64.data\n"
    compiled, specification = from_text(declared + "p: never n > 2 and v > 5\n")
    session = Session(load_plan(compiled, specification, {"n", "v"}))
    fast = ByBlocks(session, prepare_all(compiled, specification.source))
    first = [Row(0, {"n": largest})]
    rest = [Row(second * 10**9, {"v": float(second)}) for second in range(1, 9)]
    for part, columns in (
        (first, {"n": Column(ValueType.NUMBER, PRIMITIVES["uint64"])}),
        (rest, {"v": Column(ValueType.NUMBER)}),
    ):
        for block in blocks_of(part, columns):
            fast.take(block)
    decided = session.tracks[0].decided_at
    assert decided is not None
    assert decided.time == 6 * 10**9


@pytest.mark.parametrize("edge", [-(2**63), -(2**62), -(2**53), 2**53, 2**62, 2**63 - 1])
@pytest.mark.parametrize(
    "text",
    [
        "never n == {near}",
        "never n < {near}",
        "always n <= {near}",
        "never n == @{{n, -1}}",
        "never n > @{{n, -1}}",
        "always (n == {edge} implies eventually n > {edge})",
        "after_until n == {edge}, n > @{{n, opening}}, never n < @{{n, opening}}",
        "never n > v",
        "never n == v",
    ],
)
def test_large_integers_of_either_sign_are_compared_exactly(text: str, edge: int) -> None:
    """Of the integers around 2^53 and -2^53 every other one is a double, further out fewer, and none is rounded to."""
    for seed in range(share_of(4)):
        chance = Random(seed)
        least, most = max(-(2**63), edge - 3), min(2**63 - 1, edge + 3)
        near = chance.randint(least, most)
        numbers = [chance.randint(least, most) for _ in range(40)]
        found = rows(40, n=numbers.__getitem__, v=lambda i: float(edge))
        lines = DECLARATIONS + "p: " + text.format(near=near, edge=edge) + "\n"
        reference, fast = judged(Drawn(lines, [found[:7], found[7:]]))
        assert state(fast.session) == state(reference), numbers


@pytest.mark.parametrize("sign", [-1, 1])
@pytest.mark.parametrize(
    "text", ["never v == 1 and n + 0 == {odd}", "after n == {odd}, never v == 1 and n == @{{n, opening}}"]
)
def test_an_integer_that_is_no_double_is_no_neighbour_that_is_one(text: str, sign: int) -> None:
    """Nor where it is a constant, or was kept, and the block has doubles alone."""
    odd, beside = sign * (2**53 + 1), sign * 2**53
    found = rows(12, n=lambda i: odd if i == 3 else beside, v=lambda i: float(i > 5))
    reference, fast = judged(Drawn(f"{DECLARATIONS}p: {text.format(odd=odd)}\n", [found[:6], found[6:]]))
    assert state(fast.session) == state(reference)


def test_an_array_is_held_between_its_messages() -> None:
    """And over the end of a block; of the one before, `@` knows, too."""
    scans = {3: (1.0, 2.0), 4: (0.5,), 21: (3.0, 0.25, 7.0), 40: ()}
    found = [Row(i * 10**8, {"v": float(i % 7)} | ({"scan": scans[i]} if i in scans else {})) for i in range(60)]
    text = (
        "p: always (min(scan) < 0.5 implies eventually v > 5)\nq: never count(scan > 2) > v\n"
        "r: never max(@{scan, -1}) > v\ns: never any(scan > 6.5)\n"
    )
    reference, fast, because = both(text, [found[:10], found[10:30], found[30:]])
    assert (fast, because) == (reference, [])


@pytest.mark.parametrize("rate", ["", "_rate_ = 30\n", "_rate_ = 3\n"])
def test_parts_and_elements_of_arrays_are_judged_by_columns(rate: str) -> None:
    scans = {3: (1.0, 2.0), 4: (0.5,), 21: (3.0, math.nan, 0.25, 7.0), 40: (), 41: (2.0, 0.125, 9.0)}
    marks = {2: ((1, 2), ("a", "b")), 30: ((1, 0, 1), ("b", "a", "a"))}
    found = [Row(i * 10**8, {"v": float(i % 7), "mode": "ab"[i // 9 % 2]}) for i in range(60)]
    for number, scan in scans.items():
        found[number].values.update(scan=scan)
    for number, (ids, kinds) in marks.items():
        found[number].values.update(ids=ids, kinds=kinds)
    text = (
        "p: always (min(scan[:2]) < 0.5 implies eventually v > 5)\nq: never count(scan[1:] > v) >= 2\n"
        "r: never any(scan - @{scan, -1} > v)\ns: never any(scan[-2:] > 6.5)\n"
        "t: never any(ids == 1 and kinds == mode)\n"
        "u: always (any(scan > 100 / v) implies eventually max(@{scan, -1}[1:3]) > 2)\n"
        "x: never count(scan > ids over (scan), (ids)) > 2 or any(scan == ids + v over (ids), (scan))\n"
    )
    reference, fast, because = both(rate + text, [found[:10], found[10:30], found[30:]])
    assert (fast, because) == (reference, [])


def test_a_recording_may_have_no_array(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "props.txt").write_text(DECLARATIONS + "p: always (max(scan) < 9 or v > 100)\n")
    (tmp_path / "run.csv").write_text("time,v\n0,1\n1,2\n")
    assert main(["run", str(tmp_path / "props.txt"), str(tmp_path / "run.csv")]) == 3
    assert "p: not started" in capsys.readouterr().out


@pytest.mark.parametrize(
    "text",
    [
        "after_until v > 4, v < 1, always w <= @{w, opening} + 3",
        "after_until v > 4, w == @{w, opening} + 0.25, always v > 1",
        "after_until v > 4, v < 1, eventually w > @{w, opening}",
        "after_until v > 4, v < 1, eventually (w > @{w, opening} or v < 1.5)",
        "after_until v > 4, v < 1, eventually (w / @{w, opening} > 1.5 or v < 1.5)",
        "after v < 1, after_until v > @{v, opening} + 4, v < 1, eventually historically v >= @{v, opening} for 1 s",
    ],
)
def test_values_at_openings_are_judged_by_columns(text: str) -> None:
    """Also where what is divided by them has no value, and in a scope that is open at the end of a block."""
    for seed in range(share_of(8)):
        w = Random(seed).choices([0.0, 0.0, -1.0, 0.25, 0.5], k=300)
        found = rows(150 + seed * 3, v=lambda i: 3 + 3 * math.cos(i / 4), w=w.__getitem__)
        reference, fast = judged(Drawn(f"{DECLARATIONS}p: {text}\n", [found[:7], found[7:120], found[120:]]), Trailing)
        assert [way.because for way in fast.ways] == [{}]
        assert (state(fast.session), trails(fast.session)) == (state(reference), trails(reference))


def test_the_last_values_are_told_also_where_a_scope_with_values_is_not_open() -> None:
    found = rows(50, v=float, w=float)
    reference, fast, because = both("p: after v > 90, always w <= @{w, opening}\n", [found[:20], found[20:]])
    assert (fast, because) == (reference, [])


def test_news_of_an_array_beside_a_value_at_an_opening_are_judged_by_columns() -> None:
    text = DECLARATIONS + "after_until new scan, age(scan) > 300 ms, never v > @{v, opening}"
    parts = [rows(20, v=lambda n: n % 7), rows(20, v=lambda n: n % 5, scan=lambda n: (float(n),))]
    reference, fast = judged(Drawn(text, [parts[0]]))
    assert state(fast.session) == state(reference)
    reference, fast = judged(Drawn(text, [parts[1]]))
    assert [way.because for way in fast.ways] == [{}]
    assert state(fast.session) == state(reference)


def test_an_age_counts_from_the_last_message_before_the_first_step() -> None:
    heard, began = rows(6, v=float), rows(30, w=float)[20:]
    text = "p: always (age(v) <= 1700 ms or w > 100)\nq: always (age(v) <= 1900 ms or w > 100)\n"
    reference, fast, because = both(text, [heard[:3], heard[3:] + began])
    assert (fast, because) == (reference, [])
    assert "p: violated at +2.2 s" in fast[1]


def test_the_run_is_over_at_its_timeout() -> None:
    found = rows(600, v=lambda i: float(i % 7))
    text = "_timeout_ = 30\np: eventually v > 9\nq: eventually v > 9 within 20 s\n"
    reference, fast, because = both(text, [found[:280], found[280:]])
    assert (fast, because) == (reference, [])


COMPARED: dict[np.ufunc, Relation] = {
    np.less: Relation.LESS,
    np.less_equal: Relation.AT_MOST,
    np.equal: Relation.EQUAL,
    np.greater_equal: Relation.AT_LEAST,
    np.greater: Relation.GREATER,
}


def doubles() -> st.SearchStrategy[list[float]]:
    return st.lists(st.sampled_from(SAMPLES), min_size=1, max_size=40)


@given(
    doubles(),
    st.lists(st.tuples(st.sampled_from(list(COMPARED)), st.sampled_from([s for s in SAMPLES if s == s])), max_size=5),
    st.randoms(use_true_random=False),
)
def test_comparisons_with_constants_are_those_of_each_number(
    values: list[float], wanted: list[thresholds.Threshold], chance: Random
) -> None:
    with sizes(chance):
        found, has_nan = compared(np.array(values), wanted)
    assert has_nan == any(map(math.isnan, values))
    for (function, constant), each in zip(wanted, found, strict=True):
        assert unpack(each, len(values)).tolist() == [compare(x, COMPARED[function], constant) for x in values]


@pytest.mark.parametrize("seed", range(share_of(20)))
def test_comparisons_in_small_parts_are_those_of_each_number(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, size in {"MANY": 0, "MOST": 1, "SMALL": 8, "WIDER": 1}.items():
        monkeypatch.setattr(thresholds, name, size)
    monkeypatch.setattr(bits, "FEW", 1)
    chance = np.random.default_rng(seed)
    levels = np.array([-math.inf, 0.0, -0.0, 1.0, 2.0, math.nan if seed % 4 == 0 else 3.0])
    parts = np.where(chance.random((12, 1)) < 0.5, chance.choice(levels, (12, 1)), chance.choice(levels, (12, 8)))
    values = parts.reshape(-1)[: chance.integers(1, 97)]
    wanted = [(function, constant) for function in COMPARED for constant in (-math.inf, 0.0, 1.0, 1.5, 2.0, math.inf)]
    found, has_nan = compared(values, wanted)
    assert has_nan == np.isnan(values).any()
    for (function, constant), each in zip(wanted, found, strict=True):
        assert unpack(each, len(values)).tolist() == [compare(x, COMPARED[function], constant) for x in values.tolist()]


@given(st.lists(st.booleans(), min_size=1, max_size=70), st.randoms(use_true_random=False))
def test_bytes_that_are_not_listed_repeat_the_boolean_before_them(mask: list[bool], chance: Random) -> None:
    with sizes(chance):
        packed_mask = pack(np.array(mask))
    padded = [*mask, *[mask[-1]] * (-len(mask) % 8)]
    assert unpack(packed_mask, len(padded)).tolist() == padded
    if packed_mask.places is not None:
        changing = [n for n in range(1, len(padded) // 8) if set(padded[n * 8 : n * 8 + 8]) != {padded[n * 8 - 1]}]
        assert packed_mask.places.tolist() == [0, *changing]


COLUMNS: Mapping[e.Signal, st.SearchStrategy[Any]] = {
    X: st.sampled_from(SAMPLES),
    Y: st.sampled_from(SAMPLES),
    Z: st.sampled_from(SAMPLES),
    FLAG: st.booleans(),
    MODE: st.sampled_from("ab"),
    SCAN: st.lists(st.sampled_from(SAMPLES), max_size=4).map(tuple),
    NAMES: st.lists(st.sampled_from("ab"), max_size=4).map(tuple),
    FLAGS: st.lists(st.booleans(), max_size=4).map(tuple),
}


def steps_of(expression: e.Expression, samples: Mapping[e.Signal, Sequence[Any]], count: int) -> Steps:
    wanted = [wanted_of(each) for each in map(read, e.inputs(expression)) if not isinstance(each, Kept)]
    readings = [Reading(signal.name, signal.name, signal.type.value) for signal in samples]
    every = np.arange(count)
    columns = {s.name: Samples(every, packed(of, Column(s.type))) for s, of in samples.items()}
    return Columns(Block(every, columns, {}), Sampler(readings, wanted), readings).steps(wanted)


@settings(max_examples=300)
@given(numeric(), st.data())
def test_expressions_at_all_steps_are_the_same_doubles_as_at_each(
    expression: e.Expression, data: st.DataObject
) -> None:
    """But for counts beside something that is NaN: there is no step where that is so."""
    count = data.draw(st.integers(1, 6))
    samples = {s: data.draw(st.lists(of, min_size=count, max_size=count)) for s, of in COLUMNS.items()}
    steps = steps_of(expression, samples, count)
    found = np.broadcast_to(value(lowered(expression), steps), len(steps)).tolist()
    single = {part for each in e.subexpressions(expression) if isinstance(each, Count) for part in each.singles}
    for row, each in zip(steps.rows().tolist(), found, strict=True):
        here = {i: samples[i.signal][row - (i.samples if isinstance(i, e.Past) else 0)] for i in e.inputs(expression)}
        expected = evaluate(expression, here)
        assert repr(each) == repr(expected) or any(evaluate(part, here) != evaluate(part, here) for part in single)


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path]:
    specification, recording = tmp_path / "props.txt", tmp_path / "run.csv"
    specification.write_text(
        "decl v /v Float64.data\ndecl n /n Int64.data\nslow: never v > 2\nlarge: never n == 9007199254740993\n"
    )
    recording.write_text("time,v,n\n0,0,1\n1,1.5,2\n2,1,3\n")
    return specification, recording


def test_timing_says_which_way_each_property_went_and_why(
    files: tuple[Path, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", *map(str, files), "--timing"]) == 0
    said = capsys.readouterr()
    assert "timing" not in said.out
    first, slow, large = said.err.splitlines()
    assert first.startswith("timing: reading ")
    assert slow.startswith("timing: slow: by columns, ")
    assert large == "timing: large: by rows: an integer that is not a double"


def test_timing_says_that_lists_of_verdicts_are_made_by_rows(
    files: tuple[Path, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    main(["run", *map(str, files), "--timing", "--verdicts", "--format", "json"])
    assert "timing: slow: by rows: the verdict after each step is listed" in capsys.readouterr().err


@pytest.mark.parametrize("rate", ["1e-300", "1e-9", "0.3", "7"])
def test_ticks_come_when_they_are_due_however_far_they_are_apart(rate: str) -> None:
    exact = Ticks(float(rate), 5)
    before = 10**10
    assert times_of(exact, before).tolist() == [exact.at(number) for number in range(exact.before(before))]


@pytest.mark.parametrize("steps", [1, 3])
def test_steps_that_an_operation_makes_invalid_are_told_with_their_reason(steps: int) -> None:
    """Those whose values are numbers, of which an expression has none."""
    found = rows(12, v=lambda i: -1.0 if 4 <= i < 4 + steps else 1.0)
    reference, fast = judged(Drawn(f"{DECLARATIONS}p: never sqrt(v) > 2\n", [found[:6], found[6:]]))
    assert state(fast.session) == state(reference)
    assert [list(track.invalid_because.values()) for track in reference.tracks] == [[steps]]
