"""Time in runs: verdicts and their times against the denotation on instants, one nanosecond after the other."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from random import Random

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from stepping import from_text
from timed import Draw, clocks, compiled, specification
from timed_sessions import NEWS, Judge, Row, rows, timed_properties

from ltlc.backends.python.load import load_plan
from ltlc.monitoring.judging.run import run
from ltlc.runtime.properties import Change
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Session
from ltlc.runtime.times import NEVER, seconds_text
from ltlc.runtime.tracking import Track
from ltlc.semantics import properties as p
from ltlc.semantics.denotation import opened
from ltlc.semantics.ltl import Atom
from ltlc.semantics.properties import Property


def begun(property_: Property, rate: float | None = None) -> ByRows:
    of = [compiled(property_)]
    return ByRows(Session(load_plan(of, specification(of, rate))))


def feed(rows: ByRows, row: Row) -> list[Change]:
    known = {name: value for name, value in row.values.items() if f"/{name}" in rows.session.messages}
    return rows.samples(row.time, tuple(known), tuple(known.values()))


def take(judge: Judge, row: Row) -> None:
    judge.take(row.time, row.values, row.values, is_step=True)


@settings(max_examples=60, deadline=None)
@given(timed_properties(), rows(), st.integers(0, 5))
def test_verdicts_are_those_of_the_denotation_at_every_nanosecond(
    property_: Property, recorded: list[Row], further: int
) -> None:
    rows, judge = begun(property_), Judge(property_)
    [track], monitor = rows.tracks, compiled(property_).monitor
    for row, end in zip(recorded, [*(r.time for r in recorded[1:]), recorded[-1].time + further], strict=True):
        feed(rows, row)
        take(judge, row)
        for time in range(row.time, end + 1):
            rows.advance(time)
            assert judge.agrees(track.verdict, time)
            assert track.verdict is judge.verdict(monitor, time)


@settings(max_examples=40, deadline=None)
@given(timed_properties(), rows(), st.integers(0, 9))
def test_a_change_has_its_own_time_however_late_the_clock_catches_up(
    property_: Property, recorded: list[Row], further: int
) -> None:
    often, seldom = begun(property_), begun(property_)
    seen: list[Change] = []
    for row in recorded:
        for time in range(often.session.time or row.time, row.time):
            seen += often.advance(time)
        seen += feed(often, row)
    end = recorded[-1].time + further
    for time in range(recorded[-1].time, end + 1):
        seen += often.advance(time)
    late = [change for row in recorded for change in feed(seldom, row)] + seldom.advance(end)
    assert [told(change) for change in seen] == [told(change) for change in late]


@settings(max_examples=60, deadline=None)
@given(st.lists(timed_properties(), min_size=2, max_size=3), rows(), st.booleans(), st.sampled_from([None, 1e9, 3e8]))
def test_however_many_properties_there_are_each_has_taken_the_clock_steps_that_are_due(
    properties: list[Property], recorded: list[Row], is_begun: bool, rate: float | None
) -> None:
    of = [compiled(each, f"p{number}") for number, each in enumerate(properties)]
    rows = ByRows(Session(load_plan(of, specification(of, rate))))
    if is_begun:
        rows.begin(recorded[0].time - 1)
    for row, end in zip(recorded, [*(r.time for r in recorded[1:]), recorded[-1].time + 9], strict=True):
        feed(rows, row)
        for time in range(row.time if rate is None else row.time + 1, end):
            soonest = 1 + min(track.until for track in rows.tracks)
            assert time <= (rows.due() or NEVER) <= soonest
            rows.advance(time)


def told(change: Change) -> tuple[object, ...]:
    return (change.previous, change.current, change.moment.step, change.moment.time, change.moment.by_time)


@settings(max_examples=60, deadline=None)
@given(timed_properties(), rows(), st.sampled_from([None, 1e9, 5e8, 3e8]))
def test_what_a_property_does_not_read_changes_nothing_but_the_beginning_of_the_session(
    property_: Property, recorded: list[Row], rate: float | None
) -> None:
    """`w` is read by another property; without its messages the times are the same, and so are the ticks."""
    other = compiled(p.Never(p.Now(Atom("w"))), "other")
    both = ByRows(Session(load_plan([compiled(property_), other], specification([compiled(property_), other], rate))))
    alone = begun(property_, rate)
    for number, row in enumerate(recorded):
        feed(both, row)
        without = {name: value for name, value in row.values.items() if name != "w"}
        if without or number == 0:
            feed(alone, Row(row.time, without))
    both.advance(recorded[-1].time)
    alone.advance(recorded[-1].time)
    assert outline(both.tracks[0]) == outline(alone.tracks[0])


def outline(track: Track) -> tuple[object, ...]:
    decided = track.decided_at
    return (track.verdict, track.steps, decided and (decided.step, decided.time, decided.by_time), track.deadline())


@settings(max_examples=60, deadline=None)
@given(timed_properties(), rows(), st.integers(0, 30), st.integers(1, 4))
def test_with_a_rate_the_steps_are_the_ticks(
    property_: Property, recorded: list[Row], further: int, period: int
) -> None:
    """The ticks and what they see, found here from all rows at once."""
    rows, judge = begun(property_, 1e9 / period), Judge(property_)
    end = recorded[-1].time + further
    for row in recorded:
        feed(rows, row)
    rows.advance(end)
    read = rows.session.messages
    heard = [row for row in recorded if any(f"/{name}" in read for name in row.values)]
    judge.take(recorded[0].time, {}, (), is_step=False)
    starts = recorded if rows.tracks[0].property.from_session else heard
    ticks = range(starts[0].time, end + 1, period) if starts else range(0)
    latest: dict[str, bool] = {}
    came: list[Row] = []
    for moment in sorted([*heard, *ticks], key=lambda each: (each, 1) if isinstance(each, int) else (each.time, 0)):
        if isinstance(moment, Row):
            latest |= moment.values
            came.append(moment)
            if moment.time not in ticks:
                judge.hear(moment.time, moment.values)
            continue
        judge.values |= latest
        new = judge.told(name for row in came for name in row.values)
        messages = judge.told(name for row in came if row.time == moment for name in row.values)
        judge.step(moment, {name for name in new if name.startswith("new ")} | messages)
        came.clear()
    [track] = rows.tracks
    assert track.steps == judge.taken
    assert judge.agrees(track.verdict, end)


def write(path: Path, recorded: Sequence[Row]) -> Path:
    cells = [
        ",".join([seconds_text(row.time), *(str(row.values.get(n, "")).lower() for n in "xyznw")]) for row in recorded
    ]
    path.write_text("\n".join(["time,x,y,z,n,w", *cells]) + "\n")
    return path


@settings(max_examples=40, deadline=None)
@given(property_=timed_properties(), recorded=rows(), until=st.integers(10, 40))
def test_a_recording_is_judged_up_to_until(
    tmp_path_factory: pytest.TempPathFactory, property_: Property, recorded: list[Row], until: int
) -> None:
    start = 1_700_000_000 * 10**9
    moved = [Row(start + row.time, row.values) for row in recorded]
    path = write(tmp_path_factory.mktemp("run") / "run.csv", moved)
    of = [compiled(property_)]
    report = run(of, specification(of), path, until=start + until)
    if until < recorded[0].time:
        assert report.session is None
        return
    assert report.session is not None
    judge = Judge(property_)
    for row in recorded:
        if row.time <= until:
            take(judge, row)
    assert judge.agrees(report.session.tracks[0].verdict, until)


SPIKES = range(39)


@pytest.mark.parametrize("spike", SPIKES)
def test_no_tick_misses_a_row_at_a_time_of_today(tmp_path: Path, spike: int) -> None:
    cells = [f"{1_700_000_000 + (k + 1) // 10}.{(k + 1) % 10},{'true' if k == spike else 'false'}" for k in SPIKES]
    path = tmp_path / "run.csv"
    path.write_text("\n".join(["time,x", *cells]) + "\n")
    of = [compiled(p.Never(p.Now(Atom("x"))))]
    session = run(of, specification(of, 10.0), path).session
    assert session is not None
    decided = session.tracks[0].decided_at
    assert decided is not None
    assert decided.time == (17_000_000_001 + spike) * 10**8
    assert sum(session.unseen.values()) == 0


def test_what_is_owed_is_told_with_what_is_left(tmp_path: Path) -> None:
    of = [compiled(p.Always(p.Implies(p.Now(Atom("x")), p.Within(10**8, p.Eventually(p.Now(Atom("y")))))), "stop")]
    path = tmp_path / "run.csv"
    path.write_text("time,x,y\n1700000000.1,true,false\n1700000000.12,false,\n")
    report = run(of, specification(of), path)
    owed = of[0].specification.text
    assert f"unmet since +0 s (step 0): {owed}; 0.08 s left" in report.text()
    assert '"left_ns": 80000000' in report.json()
    assert "0.08 s left" in report.junit()
    in_time, late = (run(of, specification(of), path, until=1_700_000_000_200_000_000 + k) for k in (0, 1))
    assert (in_time.exit_code, late.exit_code) == (3, 1)
    assert "At +0.1 s (after step 1)." in late.text()


def test_messages_that_no_tick_saw_are_counted() -> None:
    rows = begun(p.Never(p.Now(Atom("x"))), 10.0)
    for time in (0, 20, 40, 100, 130):
        feed(rows, Row(time * 10**6, {"x": False}))
    rows.advance(200 * 10**6)
    assert rows.session.unseen == {"/x": 2}


@pytest.mark.parametrize(("between", "decided"), [("", 5 * 10**8), ("0.4,1,\n", None)])
def test_an_age_counts_from_messages_before_the_first_step(tmp_path: Path, between: str, decided: int | None) -> None:
    of = from_text(
        "decl moving /moving std_msgs/Bool.data\ndecl scan /scan std_msgs/Float64.data\n"
        "always (moving implies age(scan) <= 200 ms)\n"
    )
    path = tmp_path / "run.csv"
    path.write_text(f"time,scan,moving\n0,1,\n{between}0.5,,true\n")
    session = run(*of, path).session
    assert session is not None
    found = session.tracks[0].decided_at
    assert (found and found.time) == decided


def scopes() -> st.SearchStrategy[Property]:
    """Scopes, up to two of them inside one another, that may open and close by what the past decides."""
    return st.randoms(use_true_random=False).map(_scopes).filter(lambda property_: clocks(property_) <= 2)


def _scopes(chance: Random) -> Property:
    events = [Atom("x"), Atom("y"), *Draw(chance, NEWS).past()]
    body: Property = p.Eventually(p.Now(Atom("z")))
    for _ in range(chance.randint(1, 2)):
        scopes: list[Property] = [
            p.After(chance.choice(events), body),
            p.AfterUntil(chance.choice(events), chance.choice(events), body),
        ]
        body = chance.choice(scopes)
    return body


@settings(max_examples=80, deadline=None)
@given(scopes(), rows(), st.integers(0, 9))
def test_episodes_that_time_or_the_past_opens_are_those_of_the_denotation(
    property_: Property, recorded: list[Row], further: int
) -> None:
    rows, judge = begun(property_), Judge(property_)
    [track], end = rows.tracks, recorded[-1].time + further
    for row in recorded:
        feed(rows, row)
        if track.decided_at is None or not track.decided_at.by_time:
            take(judge, row)
        if track.decided_at is not None:
            end = track.decided_at.time
            break
    rows.advance(max(end, recorded[-1].time))
    assume(judge.steps)
    end = track.decided_at.time if track.decided_at else end
    assert track.episodes == opened(judge.word(end), property_)


OPENS_LATE = """decl cmd /cmd Bool.data
decl moving /moving Bool.data
stuck: after_until historically (cmd and not moving) for 2 s, moving, never cmd for 9 s
begins: after (moving and not previously moving), eventually not cmd
"""


def recorded(tmp_path: Path, text: str, rows: str, until: int | None = None) -> dict[str, Track]:
    path = tmp_path / "run.csv"
    path.write_text(rows)
    session = run(*from_text(text), path, until=until).session
    assert session is not None
    return {track.property.label: track for track in session.tracks}


def test_an_episode_that_time_opens_is_told_with_its_time(tmp_path: Path) -> None:
    rows = "time,cmd,moving\n0,true,false\n1,true,false\n4,true,true\n"
    stuck = "after_until historically (cmd and not moving) for 2 s, moving, never cmd"
    [track] = recorded(tmp_path, OPENS_LATE.partition("stuck:")[0] + f"stuck: {stuck}\n", rows).values()
    assert track.decided_at is not None
    [opening] = track.decided_at.opened
    assert (opening.step, opening.time, opening.by_time) == (1, 2 * 10**9, True)


def test_scopes_that_the_past_never_opens_are_never_triggered(tmp_path: Path) -> None:
    rows = "time,cmd,moving\n0,false,false\n1,true,false\n2,false,false\n"
    tracks = recorded(tmp_path, OPENS_LATE.replace("never cmd for 9 s", "never cmd"), rows)
    assert {label: track.episodes for label, track in tracks.items()} == {"stuck": 0, "begins": 0}
    assert all(track.never_triggered for track in tracks.values())


@pytest.mark.parametrize(
    ("answer", "because"),
    [
        (None, ["more than 1 s since the first asked"]),
        (0.05, ["told", "more than 100 ms since the first asked"]),
    ],
)
def test_of_a_clock_with_several_bounds_the_one_that_matters_is_named(
    tmp_path: Path, answer: float | None, because: list[str]
) -> None:
    text = "decl asked /a Bool.data\ndecl told /b Bool.data\n"
    text += "p: after asked, (never told within 100 ms) and (eventually told within 1 s)\n"
    rows = "time,asked,told\n0,true,false\n" + (f"{answer},true,true\n" if answer else "5,true,false\n")
    [track] = recorded(tmp_path, text, rows).values()
    assert track.decided_at is not None
    assert [condition.text for condition in track.decided_at.because] == because


@pytest.mark.parametrize(
    ("text", "because"),
    [
        ("eventually told within [1 s, 5 s]", "more than 5 s since the beginning"),
        ("after asked, eventually told within [1 s, 5 s]", "more than 5 s since the first asked"),
        ("within [1 s, 9 s], always (asked implies eventually told within 2 s)", "1 s after the beginning"),
        (
            "after asked, always (late implies eventually told within 1 s)",
            "the first late without told after the first asked",
        ),
        ("after_until asked, late, eventually told within 1 s", "more than 1 s since asked opened the scope"),
        ("until late, eventually told within 1 s", "more than 1 s since the beginning"),
        (
            "after asked and not (told or once late), eventually told within 1 s",
            'since the first "asked and not (told or once late)"',
        ),
    ],
)
def test_reasons_name_what_a_clock_counts_from_as_a_person_would(tmp_path: Path, text: str, because: str) -> None:
    declared = "decl asked /a Bool.data\ndecl told /b Bool.data\ndecl late /c Bool.data\n"
    late = "true" if "late implies" in text else "false"
    [track] = recorded(
        tmp_path, f"{declared}p: {text}\n", f"time,asked,told,late\n0,true,false,{late}\n6,true,false,false\n"
    ).values()
    assert track.decided_at is not None
    assert any(because in condition.text for condition in track.decided_at.because)
