"""All violations of a property: what remains of a run is judged anew after each, from the next instant on."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from stepping import from_text

from ltlc.automata import Budget, Exceeded
from ltlc.backends.python.load import load_plan
from ltlc.base.limits import Limit
from ltlc.monitoring.judging.run import Judge, RunReport
from ltlc.monitoring.later import MOST, all_violations, violation_at
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Plan, Session
from ltlc.semantics import instants as semantics
from ltlc.semantics.instants import Step, with_past
from ltlc.semantics.ltl import And, Atom, Not
from ltlc.semantics.timed_atoms import Age, Historically, News, Occurred, Once, PastAtom, Previously, Since
from ltlc.semantics.verdicts import Verdict

HEAD = "decl a /a std_msgs/Bool.data\ndecl b /b std_msgs/Bool.data\n"

Row = tuple[int, bool, bool]
"""A time in ns, and what a and b are from then on."""

Found = list[tuple[int, int | None]]
"""When each violation was, and the first instant after it."""

PROPERTIES = [
    "never a",
    "always (a or b)",
    "always (a implies b)",
    "never (a and not b)",
    "always (a implies eventually b)",
    "always (a implies eventually b within 3 ns)",
    "always (a implies always b for 2 ns)",
    "always (a implies never b within 4 ns)",
    "always eventually b within 5 ns",
    "after_until a, b, never b",
    "after_until a, not a, eventually b",
    "after_until a, not a, eventually b within 3 ns",
    "after_until a, b, always a for 2 ns",
    "after a, always b",
    "until a, not b",
    "eventually b within 4 ns",
    "initially a",
    "(always a) or (always b)",
    "(never a) and after_until a, not a, eventually b",
    "after_until a, not a, b == @{b, opening}",
    "after_until a, not a and b, always (b != @{b, opening} implies a) for 2 ns",
    "after_until a, not a, eventually b != @{b, opening} within 3 ns",
    "after a, never b == @{b, opening}",
]


def judged(folder: Path, text: str, rows: Sequence[Row]) -> RunReport:
    """What `ltlc run` finds."""
    lines = [f"{time / 1e9:.9f},{str(a).lower()},{str(b).lower()}" for time, a, b in rows]
    path = folder / "run.csv"
    path.write_text("\n".join(["time,a,b", *lines, ""]))
    return judge_of(text).judge(path)


@cache
def judge_of(text: str) -> Judge:
    """Judges by a property of a and b."""
    return Judge(*from_text(HEAD + text))


def found_in(report: RunReport) -> Found:
    assert report.session is not None
    [track] = report.session.tracks
    found = all_violations(track)
    assert found is not None
    first = track.decided_at if track.verdict is Verdict.VIOLATED else None
    assert [each.moment for each in found[:1]] == ([] if first is None else [violation_at(first).moment])
    return [(each.moment.time, each.until) for each in found]


def instants(rows: Sequence[Row]) -> list[Row]:
    """Every nanosecond of a run, with what is held then."""
    found: list[Row] = []
    for row, (following, *_) in zip(rows, [*rows[1:], (rows[-1][0], 0, 0)], strict=True):
        found.append(row)
        found += [(time, *row[1:]) for time in range(row[0] + 1, following + 1)]
    return found


def by_definition(text: str, rows: Sequence[Row]) -> Found:
    """A run of its own on each part of it that is judged anew, an instant at a time."""
    return parts_judged(HEAD + text, [(time, {"a": a, "b": b}) for time, a, b in instants(rows)])


@cache
def plan_of(text: str) -> Plan:
    """The plan of a specification."""
    return load_plan(*from_text(text))


def parts_judged(text: str, each: Iterable[tuple[int, Mapping[str, bool]]]) -> Found:
    """The same, with what every signal is at `each` instant."""
    plan = plan_of(text)
    found: Found = []
    judge, is_violated = None, False
    for time, values in each:
        if judge is None:
            judge = ByRows(Session(plan))
        names = [name for name in values if name in judge.session.sampler.samples]
        judge.samples(time, tuple(names), [values[name] for name in names])
        verdict = judge.tracks[0].verdict
        if verdict is Verdict.VIOLATED:
            found += [] if is_violated else [(time, None)]
            judge, is_violated = None, True
        elif is_violated and verdict is not Verdict.PRESUMABLY_VIOLATED:
            found[-1] = (found[-1][0], time)
            is_violated = False
    return found


gaps = st.lists(st.tuples(st.integers(1, 5), st.booleans(), st.booleans()), min_size=1, max_size=9)


def timed(drawn: Iterable[tuple[int, bool, bool]]) -> list[Row]:
    """Rows with such gaps after them."""
    rows, time = [], 0
    for gap, a, b in drawn:
        rows.append((time, a, b))
        time += gap
    return rows


@pytest.mark.parametrize("text", PROPERTIES)
@given(drawn=gaps)
def test_violations_are_those_of_the_rest_of_the_run_judged_anew(
    tmp_path_factory: pytest.TempPathFactory, text: str, drawn: list[tuple[int, bool, bool]]
) -> None:
    rows = timed(drawn)
    assert found_in(judged(tmp_path_factory.mktemp("run"), text, rows)) == by_definition(text, rows)


A, B, NEWS = Atom("a"), Atom("b"), News("new a")

PAST: list[tuple[str, str, PastAtom]] = [
    ("never (a and previously b)", "never (a and c)", Previously("c", B)),
    ("never (a and once b)", "never (a and c)", Once("c", B)),
    ("always (a implies once b within 3 ns)", "always (a implies c)", Once("c", B, 3)),
    ("never (new a and once b within 3 ns)", "never (new_a and c)", Once("c", B, 3)),
    ("never historically a for 3 ns", "never c", Historically("c", A, 3)),
    ("always (b implies historically a)", "always (b implies c)", Historically("c", A)),
    ("always (a since b within 4 ns implies b)", "always (c implies b)", Since("c", A, B, 4)),
    ("never once (new a and a) 2 times within 4 ns", "never c", Occurred("c", And(NEWS, A), 2, 4, False)),
    ("always once b 2 times within 6 ns", "always c", Occurred("c", B, 2, 6, True)),
    (
        "always (a and once b within 3 ns implies eventually not b within 2 ns)",
        "always (a and c implies eventually not b within 2 ns)",
        Once("c", B, 3),
    ),
    ("always ((a and not previously a) implies b)", "always ((a and not c) implies b)", Previously("c", A)),
    ("after_until once a within 2 ns, b, never a", "after_until c, b, never a", Once("c", A, 2)),
    ("after_until a, once not a within 2 ns, eventually b", "after_until a, c, eventually b", Once("c", Not(A), 2)),
    (
        "after_until once a within 3 ns, not a, eventually b within 2 ns",
        "after_until c, not a, eventually b within 2 ns",
        Once("c", A, 3),
    ),
    ("after once (a and b), always b", "after c, always b", Once("c", And(A, B))),
    ("eventually (b and once a) within 4 ns", "eventually (b and c) within 4 ns", Once("c", A)),
    ("initially (a and not once b)", "initially (a and not c)", Once("c", B)),
    ("never (a and age(a) <= 2 ns and once b)", "never (a and age_a and c)", Once("c", B)),
    ("(always a) or always once b within 3 ns", "(always a) or always c", Once("c", B, 3)),
    (
        "after_until once a within 2 ns, not a and b, b == @{a, opening}",
        "after_until c, not a and b, b == @{a, opening}",
        Once("c", A, 2),
    ),
]


def with_past_told(text: str, atom: PastAtom, rows: Sequence[Row]) -> Found:
    """As `by_definition`, of `text`, to which a signal of its own says where `atom` holds, by its definition."""
    steps = [Step(time, frozenset({"new a", *("a" * a), *("b" * b)})) for time, a, b in rows]
    word = with_past(semantics.instants(steps, rows[-1][0], [NEWS]), [atom, Age("age_a", NEWS, 2)])
    names = ("a", "b", "c", "new_a", "age_a")
    head = "".join(f"decl {name} /{name} std_msgs/Bool.data\n" for name in names)
    told = [{**{name: name in each for name in names}, "new_a": "new a" in each} for each in word]
    return parts_judged(head + text, [(each.time, values) for each, values in zip(word, told, strict=True)])


@pytest.mark.parametrize(("text", "told", "atom"), PAST, ids=[text for text, _, _ in PAST])
@given(drawn=gaps)
def test_what_is_judged_anew_knows_the_whole_past(
    tmp_path_factory: pytest.TempPathFactory,
    text: str,
    told: str,
    atom: PastAtom,
    drawn: list[tuple[int, bool, bool]],
) -> None:
    rows = timed(drawn)
    assert found_in(judged(tmp_path_factory.mktemp("run"), text, rows)) == with_past_told(told, atom, rows)


def found_in_seconds(folder: Path, text: str, *rows: str) -> list[str]:
    """What `ltlc run --all` lists of a property that reads a and b."""
    path = folder / "run.csv"
    path.write_text("\n".join(["time,a,b", *rows, ""]))
    report = Judge(*from_text(HEAD + text)).judge(path).text(with_all=True)
    lines = report.splitlines()
    start = next(number for number, line in enumerate(lines) if line.endswith(("violation:", "violations:")))
    return [line.strip() for line in lines[start + 1 : lines.index("", start)]]


def test_a_violation_at_a_message_does_not_last(tmp_path: Path) -> None:
    rows = ("0,true,", "1,true,", "2,false,", "3,true,")
    assert found_in_seconds(tmp_path, "never new a and a", *rows) == ["+0 s (step 0)", "+1 s (step 1)", "+3 s (step 3)"]


def test_a_silent_topic_violates_its_watchdog_up_to_its_next_message(tmp_path: Path) -> None:
    rows = ("0,true,true", "1,,true", "3.5,true,", "4,,true", "6,,true")
    assert found_in_seconds(tmp_path, "always age(a) <= 1 s", *rows) == [
        "+1 s (after step 0) for 2.5 s",
        "+4.5 s (after step 1) for 1.5 s, up to the end",
    ]


def test_an_answer_that_is_late_ends_the_violation(tmp_path: Path) -> None:
    rows = ("0,true,false", "0.5,false,", "4,,true", "5,true,false", "5.5,,true")
    text = "always (a implies eventually b within 1 s)"
    assert found_in_seconds(tmp_path, text, *rows) == ["+1 s (after step 1)"]
    assert found_in_seconds(tmp_path, text, rows[0], *rows[2:]) == ["+1 s (after step 0) for 3 s"]


def test_text_lists_all_violations_of_a_property_that_reads_the_past(tmp_path: Path) -> None:
    rows = ("0,true,true", "1,false,false", "5,true,", "6,false,", "7.5,,true", "8,true,", "8.5,,false", "9,,false")
    assert found_in_seconds(tmp_path, "always (a implies once b within 1 s)", *rows) == [
        "+5 s (step 2) for 1 s",
    ]
    assert found_in_seconds(tmp_path, "never a and not previously a", *rows) == [
        "+0 s (step 0)",
        "+5 s (step 2)",
        "+8 s (step 4)",
    ]


def test_text_says_so_if_later_violations_could_not_be_looked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    exceeded = Exceeded(Limit.TIME, Budget())
    monkeypatch.setattr(
        "ltlc.monitoring.restarting.translate_all", lambda tasks, budget, known: [exceeded for _ in tasks]
    )
    rows = [(0, True, False), (10, False, False), (20, True, False), (30, False, False)]
    (tmp_path / "run.csv").write_text("\n".join(["time,a,b", *(f"{t},{a},{b}".lower() for t, a, b in rows), ""]))
    report = Judge(*from_text(HEAD + "never a and not previously a")).judge(tmp_path / "run.csv")
    assert "Only the first violation is known: the monitor for later ones" in report.text(with_all=True)
    assert report.document()["properties"][0]["violations"] is None


def test_json_has_when_each_violation_was_and_how_long_it_lasted(tmp_path: Path) -> None:
    report = judged(tmp_path, "never a", [(0, True, False), (10, False, False), (20, True, False), (25, True, False)])
    [found] = report.document()["properties"]
    told = [(each["time_ns"], each["until_ns"], each["lasted_ns"]) for each in found["violations"]]
    assert told == [(0, 10, 10), (20, None, 5)]
    assert found["decided_at"]["time_ns"] == 0
    assert "2 violations" in report.text()


def test_what_holds_has_no_violations(tmp_path: Path) -> None:
    [found] = judged(tmp_path, "never a", [(0, False, False)]).document()["properties"]
    assert found["violations"] == []


def test_no_more_violations_than_the_most_are_looked_for(tmp_path: Path) -> None:
    report = judged(tmp_path, "never a", [(10 * n, n % 2 == 0, False) for n in range(2 * MOST + 10)])
    assert len(found_in(report)) == MOST
    assert f"{MOST} violations or more:" in report.text(with_all=True)
