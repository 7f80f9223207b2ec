"""What is drawn of a signal: no spike is lost, and what is computed is what the monitors were given."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stepping import from_text, ns

from ltlc.inputs.recordings import blocks
from ltlc.interfaces.pages.panels import panels
from ltlc.interfaces.pages.series import Collector, Series
from ltlc.monitoring.judging.run import Judge
from ltlc.specification.evaluation import evaluate

NUMBERS = st.one_of(st.floats(-9, 9), st.just(math.nan), st.just(math.inf))


def fed(values: list[float], parts: int, most: int = 16, levels: tuple[float, ...] = ()) -> Series:
    series = Series(most, levels)
    for part in np.array_split(np.arange(len(values)), parts):
        series.add(part * 10, np.array(values)[part])
    return series


@given(st.lists(NUMBERS, min_size=1, max_size=16))
def test_few_samples_are_kept_as_they_are(values: list[float]) -> None:
    times, kept = fed(values, 3).samples()
    assert times.tolist() == [10 * n for n in range(len(values))]
    assert np.array_equal(kept, np.array(values), equal_nan=True)


@settings(max_examples=20)
@given(st.integers(0, 2**32), st.integers(1, 9), st.sampled_from([100, 300]), st.booleans())
def test_no_sample_sticks_out_of_those_that_are_kept_around_it(
    seed: int, parts: int, most: int, is_noise: bool
) -> None:
    random = np.random.default_rng(seed)
    noise = random.normal(size=3000)
    values = np.round(noise if is_noise else np.cumsum(noise), int(random.integers(0, 3)))
    values[random.integers(0, 3000, 20)] += random.normal(size=20) * 1000
    values[random.integers(0, 3000, 20)] = np.nan
    times, kept = fed(values.tolist(), parts, most, (0.0,)).samples()
    at = times // 10
    assert len(at) <= 2 * most
    assert np.array_equal(kept, values[at], equal_nan=True)
    assert (at[0], at[-1]) == (0, 2999)
    for n, value in enumerate(values):
        place = np.searchsorted(at, n)
        near = kept[max(0, place - 20) : place + 20]
        sticks_out = not (np.isnan(near).any() if math.isnan(value) else np.nanmin(near) <= value <= np.nanmax(near))
        assert not sticks_out, (n, value)


def test_where_a_limit_is_crossed_the_samples_on_both_sides_are_kept() -> None:
    values = [math.sin(n / 400) + 0.001 * (n % 7) for n in range(20_000)]
    times, kept = fed(values, 1, 200, (0.5,)).samples()
    above = np.array(values) > 0.5
    crossings = np.flatnonzero(above[1:] != above[:-1])
    drawn = set((times // 10).tolist())
    assert {int(crossings[0]), int(crossings[0]) + 1} <= drawn
    assert len(times) < 400
    ups = kept[:-1] <= 0.5
    assert np.count_nonzero(ups[1:] != ups[:-1]) >= 15


def test_what_repeats_costs_nothing_and_is_exact() -> None:
    series = fed([float(n // 1000) for n in range(10_000)], 7, 50)
    times, kept = series.samples()
    assert series.bucket == 1
    assert [int(time) // 10 for time in times] == [*range(0, 10_000, 1000), 9999]
    assert kept.tolist() == [*map(float, range(10)), 9.0]


def test_strings_are_numbered_by_their_first_use() -> None:
    series = Series(10)
    series.add(np.arange(3), np.array(["b", "a", "b"], object))
    assert (series.names, series.samples()[1].tolist()) == ({"b": 0, "a": 1}, [0.0, 1.0, 0.0])


SPEC = """model robot: position /odom Odometry.pose.pose.position velocity /odom Odometry.twist.twist.linear ;
object sign at (1, 2, 0)
decl a /a Float64.data
decl b /b Float64.data
decl far /c Bool.data
"""
CONDITIONS = [
    "a + 2 * b > 3",
    "robot.distance.sign < 2",
    "a > @{a, -2}",
    "robot.velocity > b",
    "abs(a - b) < 1",
    "a / b > 1",
    "far",
    "new b and a > 0",
    "a - @{a, when new b} > 1",
    "@{b, when a > @{a, -1}} > 0",
    "@{a - b, -1} > 1",
]
COLUMNS = ["a", "b", "far", *(f"robot.{of}.{axis}" for of in ("position", "velocity") for axis in "xyz")]


@st.composite
def recordings(draw: st.DrawFn) -> list[str]:
    cell = st.one_of(st.just(""), st.integers(-2, 4).map(str))
    rows = [",".join(["time", *COLUMNS])]
    for time in range(draw(st.integers(1, 14))):
        cells = [draw(st.sampled_from(["", "true", "false"])) if name == "far" else draw(cell) for name in COLUMNS]
        rows.append(",".join([str(time), *cells]))
    return rows


@settings(max_examples=20, deadline=None)
@given(recordings(), st.sampled_from(CONDITIONS), st.integers(1, 5))
def test_what_is_drawn_is_what_the_property_was_judged_on(rows: list[str], condition: str, size: int) -> None:
    compiled, specification = from_text(f"{SPEC}p: always (a >= 0 implies {condition})\n")
    of = compiled[0].specification
    found = panels(of, specification.source)
    collector = Collector({expression: () for panel in found for expression in panel.drawn}, 1000)
    with tempfile.TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        patch.setattr(blocks, "ROWS", size)
        (Path(folder) / "run.csv").write_text("".join(f"{row}\n" for row in rows))
        report = Judge(compiled, specification, keep_verdicts=True).judge(Path(folder) / "run.csv", [collector.take])
    assert report.session is not None
    track = report.session.tracks[0]
    for time, values in zip(track.times, track.values, strict=True):
        given_values = dict(zip(of.inputs(), values, strict=True))
        for panel in found:
            if panel.title.startswith("new "):
                assert (time in collector.series[panel.expression].samples()[0]) == values[-1] or track.times.count(
                    time
                ) > 1
                continue
            for expression in panel.drawn:
                times, kept = collector.series[expression].samples()
                drawn = kept[np.searchsorted(times, time, "right") - 1]
                wanted = float(evaluate(expression, given_values))  # type: ignore[arg-type]
                assert drawn == wanted or (math.isnan(drawn) and math.isnan(wanted))


def test_the_past_reaches_back_over_blocks() -> None:
    compiled, specification = from_text("decl a /a Float64.data\nnever a - @{a, -3} > 1\n")
    (panel,) = panels(compiled[0].specification, specification.source)
    collector = Collector({panel.expression: ()}, 100)
    for step in range(6):
        samples = blocks.Samples(np.array([0]), np.array([float(step**2)]))
        collector.take(blocks.Block(np.array([step]), {"a": samples}, {}))
    times, values = collector.series[panel.expression].samples()
    assert (times.tolist(), values.tolist()) == ([3, 4, 5], [9.0, 15.0, 21.0])


def test_news_are_those_of_any_part_of_a_signal() -> None:
    compiled, specification = from_text("always eventually new robot.velocity within 1 s\n")
    (panel,) = panels(compiled[0].specification, specification.source)
    collector = Collector({panel.expression: ()}, 100)
    samples = {f"robot.velocity.{axis}": blocks.Samples(np.array([n]), np.array([1.0])) for n, axis in enumerate("xyz")}
    collector.take(blocks.Block(np.array([1, 2, 3, 4, 5]), samples, {"/model/robot/odometry": np.array([3])}))
    assert collector.series[panel.expression].samples()[0].tolist() == [1, 2, 3, 4]


def test_a_slope_is_drawn_as_the_runtime_computes_it() -> None:
    from ltlc.specification.expressions import Current, Slope

    compiled, _ = from_text("decl a /a Float64.data\nnever a > 1\n")
    signal = compiled[0].specification.inputs()[0].signal
    collector = Collector({Slope(signal): (), Current(signal): ()}, 100)
    samples = blocks.Samples(np.array([0, 1, 2]), np.array([1.0, 3.0, 3.5]))
    collector.take(blocks.Block(np.array([0, ns(1), ns(1.5)]), {"a": samples}, {}))
    collector.take(blocks.Block(np.array([ns(2)]), {"a": blocks.Samples(np.array([0]), np.array([2.5]))}, {}))
    times, slopes = collector.series[Slope(signal)].samples()
    assert times.tolist() == [ns(1), ns(1.5), ns(2)]
    assert slopes.tolist() == [2.0, 1.0, -2.0]


@pytest.mark.parametrize("size", [1, 3, 100])
def test_of_messages_the_time_since_the_one_before_is_drawn(tmp_path: Path, size: int) -> None:
    compiled, specification = from_text("decl v /v Float64.data\ndecl w /w Float64.data\nalways age(v) <= 0.5 s\n")
    (panel,) = panels(compiled[0].specification, specification.source)
    collector = Collector({panel.expression: ()}, 1000)
    rows = ["time,v,w", "0,,1", "0.25,1,", "0.5,,1", "1.25,2,", "1.25,2,"]
    (tmp_path / "run.csv").write_text("".join(f"{row}\n" for row in rows))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(blocks, "ROWS", size)
        Judge(compiled, specification).judge(tmp_path / "run.csv", [collector.take])
    times, gaps = collector.series[panel.expression].samples()
    assert times.tolist() == [ns(0.25), ns(1.25), ns(1.25)]
    assert np.array_equal(gaps, [math.nan, 1.0, 0.0], equal_nan=True)
