"""`once p N times`: how often something has occurred, so far or in the last while."""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path

import pytest
from effort import share_of
from hypothesis import given, settings
from hypothesis import strategies as st
from stepping import from_text, ns, session
from timed_sessions import Judge, Row, rows

from ltlc.assurance import c_library, rust_library
from ltlc.assurance.c_library import Library
from ltlc.assurance.compiled_program import VERDICTS
from ltlc.assurance.library import Loaded
from ltlc.assurance.lowered.equality import Equal, compare
from ltlc.assurance.lowered.letters import Judged
from ltlc.assurance.rust_library import RustLibrary
from ltlc.backends import c, rust
from ltlc.base.source import Source
from ltlc.cli import main
from ltlc.compiler import Compiled
from ltlc.frontend.language import load_text
from ltlc.monitoring.judging import run
from ltlc.runtime.rows import ByRows
from ltlc.semantics.instants import Step, instants, with_past
from ltlc.semantics.ltl import Atom
from ltlc.semantics.timed_atoms import Occurred
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.evaluation import Value
from ltlc.specification.specification import Specification

needs_compilers = pytest.mark.skipif(
    None in (c_library.compiler(), rust_library.compiler()), reason="there is no compiler of C or Rust here"
)

DECLARED = "".join(f"decl {name} /{name} std_msgs/Bool.data\n" for name in "xyzn")
V = "decl v /v std_msgs/Float64.data\n"
EDGES = [
    "never once x 2 times within 4 ns",
    "always (y or not once x 2 times)",
    "eventually (y and not once x 3 times)",
    "always (once (x and not y) 2 times within 3 ns implies eventually y within 2 ns)",
    "never (once x 2 times within 5 ns and not once x 2 times within 3 ns and y)",
    "never (once x 1 times within 3 ns and not once x within 3 ns)",
    "after_until once x 2 times within 4 ns, y, eventually z within 3 ns",
    "always (previously once x 2 times within 3 ns implies once y 1 times within 4 ns or x)",
]
MESSAGES = [
    "always (x or y or not once new n 2 times within 3 ns)",
    "always (x or y or not once new n 3 times)",
    "always (once (new x and x) 2 times within 4 ns implies y or once (new y or new n) 3 times within 5 ns)",
    "until once (new y and x) 2 times within 6 ns, always (x implies eventually y within 4 ns)",
    "always (x or rate(n) >= 5e8 Hz over 4 ns)",
    "always (rate(y) < 3e8 Hz over 10 ns implies eventually x within 3 ns)",
    "always (age(n) <= 3 ns or not once new n 2 times within 5 ns or x)",
]


@pytest.mark.parametrize("text", [*EDGES, *MESSAGES])
@settings(max_examples=25, deadline=None)
@given(drawn=rows(), further=st.integers(0, 6))
def test_verdicts_are_those_of_the_definition_at_every_nanosecond(text: str, drawn: list[Row], further: int) -> None:
    [compiled], _ = from_text(DECLARED + text)
    live, judge = session(DECLARED + text), Judge(compiled.specification.property)
    recorded = [Row(5, dict.fromkeys("xyzn", False)), *drawn]
    for row, end in zip(recorded, [*(r.time for r in recorded[1:]), recorded[-1].time + further], strict=True):
        known = {name: value for name, value in row.values.items() if name in live.session.sampler.samples}
        live.samples(row.time, tuple(known), tuple(known.values()))
        judge.take(row.time, row.values, row.values)
        for time in range(row.time, end + 1):
            live.advance(time)
            assert judge.agrees(live.tracks[0].verdict, time)
            assert live.tracks[0].verdict is judge.verdict(compiled.monitor, time)


@pytest.mark.parametrize("text", [*EDGES, *MESSAGES])
def test_what_runs_is_shown_equal_to_the_certified_monitor(text: str) -> None:
    [compiled], _ = from_text(DECLARED + text)
    judged = Judged(compiled.specification, compiled.formula, compiled.monitor)
    assert isinstance(compare(compiled.machine, judged), Equal)


def test_a_count_is_over_a_nanosecond_after_its_duration() -> None:
    text = f"{V}always once new v 2 times within 1 s or v < 5\n"
    live = fed(text, (0, 1.0), (0.25, 1.0), (0.5, 9.0))
    live.advance(ns(1.25))
    assert live.tracks[0].verdict is Verdict.PRESUMABLY_SATISFIED
    live.advance(ns(2))
    decided = live.tracks[0].decided_at
    assert decided is not None
    assert (decided.time, decided.by_time) == (ns(1.25) + 1, True)


def test_messages_at_one_time_occur_each_by_itself() -> None:
    assert fed(f"{V}never once new v 3 times within 1 s\n", *[(1, 0.0)] * 3).tracks[0].verdict is Verdict.VIOLATED


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("never once new v 3 times within 1 s", {"once new v 3 times within 1 s": True}),
        ("always (v < 5 or once v < 5 3 times within 9 s)", {"v < 5": False, "once v < 5 3 times within 9 s": False}),
    ],
)
def test_a_violation_says_whether_it_occurred_so_often_with_the_step_that_violates(
    text: str, expected: dict[str, bool]
) -> None:
    decided = fed(f"{V}{text}\n", (0, 0.0), (0.5, 0.0), (1, 9.0)).tracks[0].decided_at
    assert decided is not None
    assert {condition.text: condition.holds for condition in decided.because} == expected


def test_what_goes_on_holding_occurs_once() -> None:
    text = f"{V}never once v > 2 2 times within 9 s\n"
    assert fed(text, (0, 3.0), (1, 4.0), (2, 5.0)).tracks[0].verdict is Verdict.PRESUMABLY_SATISFIED
    assert fed(text, (0, 3.0), (1, 1.0), (2, 5.0)).tracks[0].verdict is Verdict.VIOLATED


def test_what_is_not_a_number_neither_occurs_nor_ends() -> None:
    text = f"{V}never once v > 2 2 times within 9 s\n"
    assert fed(text, (0, 3.0), (1, float("nan")), (2, 5.0)).tracks[0].verdict is Verdict.PRESUMABLY_SATISFIED


def test_under_a_rate_it_is_ticks_that_occur() -> None:
    text = f"_rate_ = 10\n{V}never once new v 3 times within 1 s\n"
    live = fed(text, *((0.01 * n, 1.0) for n in range(16)))
    before = live.tracks[0].verdict
    live.advance(ns(0.2))
    assert (before, live.tracks[0].verdict) == (Verdict.PRESUMABLY_SATISFIED, Verdict.VIOLATED)


def fed(text: str, *messages: tuple[float, float]) -> ByRows:
    """A run of these messages on /v."""
    live = session(text)
    for time, value in messages:
        live.samples(ns(time), ("v",), (value,))
    return live


@settings(max_examples=60, deadline=None)
@given(st.lists(st.integers(0, 4), min_size=1, max_size=9), st.integers(0, 7))
def test_a_rate_is_asked_of_every_window_after_the_first(gaps: list[int], further: int) -> None:
    times = [sum(gaps[: n + 1]) for n in range(len(gaps))]
    end = times[-1] + further
    live = session(f"{V}always rate(v) >= 5e8 Hz over 4 ns\n")
    for time in times:
        live.samples(time, ("v",), (1.0,))
    live.advance(end)
    # Before the messages at a time comes the instant at which all is held up to it.
    late = (t for t in range(times[0] + 5, end + 1) if sum(t - 4 <= time < t for time in times) < 2)
    first = next(late, None)
    decided = live.tracks[0].decided_at
    assert (None if decided is None else decided.time) == first


@pytest.mark.parametrize(
    ("begins", "within", "table"),
    [(False, 2, "0001111101"), (True, 2, "0001000001"), (False, None, "0001111111"), (True, None, "0001111111")],
)
def test_a_count_holds_where_its_table_says(begins: bool, within: int | None, table: str) -> None:
    """Of two; a step each nanosecond."""
    steps = [Step(n, frozenset({"p"} if held == "1" else ())) for n, held in enumerate("0101110101")]
    word = with_past(instants(steps, len(steps) - 1, among=()), [Occurred("two", Atom("p"), 2, within, begins)])
    assert "".join(str(int("two" in instant)) for instant in word) == table


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("never once x 0 times", "a count must be a whole number from 1"),
        ("never once x 1.5 times within 3 s", "a count must be a whole number from 1"),
        ("never historically x 3 times", "`historically` does not count"),
        ("never once (previously x) 3 times", "looks back"),
        ("never once (not new n) 3 times", "both with and without a new message"),
        ("always rate(x) >= 3 Hz over 500 ms", "1.5 messages"),
        ("always rate(x) > 4 Hz over 500 ms", "`>=` or `<`"),
        ("_rate_ = 10 always rate(x) >= 4 Hz over 500 ms", "the steps are ticks"),
    ],
)
def test_what_cannot_be_counted_is_said(text: str, said: str) -> None:
    found, diagnostics = load_text(Source("props.txt", DECLARED + text))
    assert found is None
    [diagnostic] = [each for each in diagnostics if each.code == "LTL232"]
    assert said in diagnostic.message


def test_a_rate_that_is_compared_otherwise_is_answered_with_both_limits() -> None:
    _, diagnostics = load_text(Source("props.txt", f"{DECLARED}always rate(x) <= 4 Hz over 500 ms"))
    [told] = [each for each in diagnostics if each.code == "LTL232"]
    upper = "never once new x 3 times within 500 ms"
    assert told.help == f"for a lower limit, write `>= 4 Hz`; for an upper limit, `{upper}`"
    from_text(DECLARED + upper)


def test_a_rate_without_its_unit_is_answered_with_how_rates_are_compared() -> None:
    _, diagnostics = load_text(Source("props.txt", f"{DECLARED}always rate(x) >= 3 over 1 s"))
    [diagnostic] = [each for each in diagnostics if each.code == "LTL107"]
    assert "as in `rate(v) >= 10 Hz over 1 s`" in str(diagnostic.help)


def test_rate_is_a_name_where_no_frequency_is_asked_for() -> None:
    from_text("decl rate /t std_msgs/Float64.data\nnever rate > 3 and rate(rate) >= 4 Hz over 500 ms\n")


def test_times_is_a_name_where_no_number_stands_before_it() -> None:
    from_text("decl times /t std_msgs/Float64.data\nnever times > 3\ntimes_2: never 3 < times\n")


def test_a_recording_is_judged_as_a_live_run_is(tmp_path: Path) -> None:
    """Letters that come again are other steps: nothing may be skipped."""
    text = f"{V}never once new v 4 times within 1 s\n"
    (tmp_path / "run.csv").write_text("time,v\n" + "".join(f"{n / 10},1\n" for n in range(9)), encoding="utf-8")
    judged = run.Judge(*from_text(text)).judge(tmp_path / "run.csv").session
    assert judged is not None
    decided = judged.tracks[0].decided_at
    assert decided is not None
    assert decided.time == ns(0.3)


def in_c(compiled: list[Compiled], whole: Specification) -> Loaded:
    return Library(c.emit(compiled, whole), str(c_library.compiler()))


def in_rust(compiled: list[Compiled], whole: Specification) -> Loaded:
    return RustLibrary(rust.file_of(compiled, whole), str(rust_library.compiler()))


@needs_compilers
@pytest.mark.parametrize("emitted", [in_c, in_rust])
def test_compiled_code_counts_as_rows_do(emitted: Callable[[list[Compiled], Specification], Loaded]) -> None:
    text = DECLARED + "".join(f"{each}\n" for each in [*EDGES, *MESSAGES])
    compiled, whole = from_text(text)
    library, chance = emitted(compiled, whole), random.Random(4)
    for _ in range(share_of(15)):
        monitors, live, time = library.monitors(), session(text), 0
        for _ in range(40):
            time += chance.choice([0, 1, 1, 2, 3, 6])
            came = chance.sample("xyzn", chance.randint(1, 3))
            values: dict[str, Value] = {name: chance.random() < 1 / 2 for name in came}
            live.samples(time, tuple(values), tuple(values.values()))
            given_ = {s: values[s.name] for s in library.numbers if s.name in values}
            assert monitors.step(time, given_, [f"/{name}" for name in came])
            shown = [VERDICTS[monitors.show(number)[0]] for number in range(len(compiled))]
            assert shown == [track.verdict for track in live.tracks]


@pytest.mark.usefixtures("quickly")
def test_a_property_that_counts_is_certified_from_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    props, certificate = tmp_path / "props.txt", tmp_path / "props.cert"
    props.write_text(f"{V}never once new v 4 times within 1 s\nuntil once v > 2 3 times, v < 9\n", encoding="utf-8")
    given = [str(props), "--target", "hoa", "-o", str(tmp_path / "props.hoa"), "-q"]
    assert main(["build", *given, "--certificate", str(certificate)]) == 0
    assert main(["certify", str(props), str(certificate)]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said == [f"line {line}: certified, exactly except where only counting could decide" for line in (2, 3)]


def test_a_report_says_a_count_without_a_bound_as_it_is_written() -> None:
    live = fed(f"{V}never once v > 1 2 times\n", (0, 2), (1, 0), (2, 3))
    decided = live.tracks[0].decided_at
    assert decided is not None
    assert [condition.text for condition in decided.because] == ["once v > 1 2 times so far"]
