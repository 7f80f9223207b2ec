"""Values at the opening of a scope: where they can be read, which value they are, and that emitted code takes them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from language_support import codes_of, findings, marked
from replaying import missed_changes, outcomes
from stepping import emitted, from_text, session

from ltlc.analysis.analyse import study_of
from ltlc.analysis.examine import examine
from ltlc.analysis.explanation import explain
from ltlc.assurance.exactness import checked_certificate
from ltlc.assurance.replay import Deviation, Replayed
from ltlc.automata import Budget
from ltlc.backends.python import standalone_classes
from ltlc.base import fixes
from ltlc.base.diagnostics import Severity
from ltlc.base.source import Source
from ltlc.compiler import Compiled
from ltlc.frontend.language import load_text
from ltlc.runtime.reports import failure_text
from ltlc.runtime.times import Scale
from ltlc.semantics.certificate import Certificate
from ltlc.semantics.denotation import satisfies
from ltlc.semantics.encodings import EPISODE
from ltlc.semantics.ltl import Atom
from ltlc.semantics.openings import open_part
from ltlc.semantics.timed_atoms import BEGINNING, AfterOpened, UntilScope
from ltlc.semantics.words import Word

BUDGET = Budget(30.0, 1024)
SIGNALS = "decl x /x Bool.data\ndecl y /y Bool.data\ndecl d /d Float64.data\n"
DOCK = "after_until x, y, always d <= @{d, opening} + 0.1"
TEXTS = {
    "an episode": DOCK,
    "a closing event": "after_until x, y and d =={0.5} @{d, opening}, never d > 3",
    "after": "after x, eventually d < @{d, opening} - 1",
    "the run": "always abs(d) <= @{d, opening} + 2",
    "until": "until y, d >= @{d, opening}",
    "a scope in a scope": "after x, after_until y, d > @{d, opening} + 1, eventually d < @{d, opening}",
    "the opening of an inner scope": "after x, after_until d > @{d, opening}, y, never d < @{d, opening} - 1",
    "two scopes": "(after x, eventually d < @{d, opening}) and (always d < @{d, opening} + 10)",
    "the difference": "after_until x, y, always abs(d - @{d, opening}) < 0.5",
    "what always holds": "always (d > @{d, opening} or true)",
}


@pytest.mark.parametrize("target", ["python", "ros2"])
@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_emitted_code_takes_the_values_that_the_definition_says(text: str, target: str) -> None:
    assert all(isinstance(outcome, Replayed) for outcome in outcomes(SIGNALS + text, target))


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_its_monitor_is_certified_for_any_value_at_the_opening(text: str) -> None:
    [compiled], _ = from_text(SIGNALS + text)
    assert isinstance(checked_certificate(compiled), Certificate)


TAKEN = "d_opening = d if self.state == 0 else self._d_opening"
FAULTS = {
    "once only": TAKEN.replace("self.state == 0", "not hasattr(self, '_d_opening')"),
    "at every step": TAKEN.replace("self.state == 0", "True"),
    "in another state, too": TAKEN.replace("self.state == 0", "self.state in (0, 2)"),
}


@pytest.mark.parametrize("wrong", FAULTS.values(), ids=FAULTS)
@pytest.mark.parametrize("target", ["python", "ros2"])
def test_code_that_takes_a_value_at_the_wrong_step_is_refused(target: str, wrong: str) -> None:
    assert any(isinstance(outcome, Deviation) for outcome in outcomes(SIGNALS + DOCK, target, TAKEN, wrong))


def test_every_change_of_the_code_that_changes_a_verdict_is_caught() -> None:
    _, missed = missed_changes(SIGNALS + DOCK)
    assert {line for line in missed if "self.invalid" not in line} == {
        # Where the scope opens, d is what it is there: nothing violates the property at that step.
        "if d <= d_opening + 1.1:",
        "self.state = 0",
        "self.state = 2",
    }


Step = dict[str, float]
Reading = Callable[[Sequence[Step], int], float]
"""Which value of d is meant at a step of a run."""


def of_episode(run: Sequence[Step], now: int) -> float:
    opened: int | None = None
    for k in range(now):
        if opened is None and run[k]["x"] and not run[k]["y"]:
            opened = k
        elif opened is not None and run[k]["y"]:
            opened = None
    return run[now if opened is None else opened]["d"]


def of_episode_that_its_value_closes(run: Sequence[Step], now: int) -> float:
    opened: int | None = None
    for k in range(now):
        if opened is None and run[k]["x"] and not run[k]["y"]:
            opened = k
        elif opened is not None and run[k]["y"] and abs(run[k]["d"] - run[opened]["d"]) <= 0.5:
            opened = None
    return run[now if opened is None else opened]["d"]


def since_x(run: Sequence[Step], now: int) -> float:
    return run[next((k for k in range(now) if run[k]["x"]), now)]["d"]


ORACLES: dict[str, tuple[Reading, Callable[[Step, float], set[str]]]] = {
    DOCK: (of_episode, lambda s, o: {"d <= @{d, opening 1 of line 4} + 0.1"} if s["d"] <= o + 0.1 else set()),
    TEXTS["a closing event"]: (
        of_episode_that_its_value_closes,
        lambda s, o: (
            ({"d =={0.5} @{d, opening 1 of line 4}"} if abs(s["d"] - o) <= 0.5 else set())
            | ({"d > 3"} if s["d"] > 3 else set())
        ),
    ),
    TEXTS["after"]: (since_x, lambda s, o: {"d < @{d, opening 1 of line 4} - 1"} if s["d"] < o - 1 else set()),
    TEXTS["until"]: (
        lambda run, _: run[0]["d"],
        lambda s, o: {"d >= @{d, opening of line 4}"} if s["d"] >= o else set(),
    ),
}
RUNS = st.lists(
    st.fixed_dictionaries(
        {"x": st.booleans(), "y": st.booleans(), "d": st.sampled_from([0.0, 0.05, 0.1, 0.2, 1.0, 2.5, 4.0, -1.0])}
    ),
    min_size=1,
    max_size=9,
)


@cache
def built(text: str) -> tuple[Compiled, Any, list[str]]:
    """The property `text`, the class that is emitted for it, and the names of what its steps take."""
    (compiled,), _ = from_text(SIGNALS + text)
    (written,) = standalone_classes([compiled], "props.txt")
    return compiled, emitted([compiled])["Line4"], [name for name, _ in written.parameters]


@pytest.mark.parametrize("text", ORACLES)
@given(run=RUNS)
@settings(max_examples=150, deadline=None)
def test_a_verdict_is_that_of_the_run_with_the_values_at_its_openings(text: str, run: list[Step]) -> None:
    reading, holding = ORACLES[text]
    word: Word = tuple(
        frozenset(holding(step, reading(run, n)) | {name for name in ("x", "y") if step[name]})
        for n, step in enumerate(run)
    )
    compiled, class_, names = built(text)
    monitor = class_()
    for end, step in enumerate(run, 1):
        verdict = monitor.step(**{name: step[name] for name in names})
        assert (verdict.value in ("satisfied", "presumably_satisfied")) == satisfies(
            word[:end], compiled.specification.property
        )


def test_a_step_without_a_value_takes_none() -> None:
    _, class_, _ = built(DOCK)
    monitor = class_()
    monitor.step(x=True, y=False, d=math.nan)
    assert monitor.step(x=True, y=False, d=1.0).value == "presumably_satisfied"
    assert monitor.step(x=False, y=False, d=1.05).value == "presumably_satisfied"
    assert monitor.step(x=False, y=False, d=1.2).value == "violated"


def violated(text: str, *steps: tuple[bool, bool, float]) -> Any:
    """The track of the only property after these steps, which violate it."""
    run = session(SIGNALS + text)
    for n, (x, y, d) in enumerate(steps):
        for topic, value in (("/d", d), ("/y", y), ("/x", x)):
            if topic in run.session.messages:
                run.message(n * 10**9, topic, [value])
    (track,) = run.tracks
    assert track.decided_at is not None
    return track


def test_a_report_shows_the_value_at_the_opening() -> None:
    track = violated(DOCK, (False, False, 9.0), (True, False, 2.0), (True, False, 2.05), (True, False, 3.0))
    assert track.decided_at is not None
    lines = failure_text(track.property, track.decided_at, Scale(0)).splitlines()
    assert "  @{d, opening}: 2.0" in lines
    assert "  d <= @{d, opening} + 0.1: false, 3.0 > 2.1 by 0.9" in lines
    assert dict(track.decided_at.values)["@{d, opening}"] == 2.0


def test_two_scopes_of_a_property_are_told_apart_in_its_report() -> None:
    text = "(after x, always d > @{d, opening} - 1) and (always d < @{d, opening} + 10)"
    track = violated(text, (False, False, 1.0), (True, False, 5.0), (True, False, 4.0))
    assert track.decided_at is not None
    assert {"@{d, opening 1}", "@{d, opening}"} <= dict(track.decided_at.values).keys()


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("always (x implies d <= @{d, opening})", "d <= @{d, opening}"),
        ("after y, always (x implies eventually d < @{d, opening})", "d < @{d, opening}"),
        ("always after_until x, y, d <= @{d, opening}", "d <= @{d, opening}"),
        ("limit = @{d, opening}\nnever (x and (y implies d > limit))", "d > limit"),
    ],
)
def test_where_there_is_no_one_opening_that_is_an_error(text: str, place: str) -> None:
    (found,) = [each for each in findings(SIGNALS + text) if each.code == "LTL312"]
    assert marked(found) == place


@pytest.mark.parametrize(
    ("text", "value", "mended"),
    [
        (
            "after_until x, y, always (x implies d <= @{d, opening})",
            "the value when the scope around opened, or when `x` began to hold?",
            "after_until x, y, always (not x or (d <= @{d, opening}))",
        ),
        (
            "always (x implies y or d > 1 implies eventually d < @{d, opening})",
            "the value when the run began, or when `y or d > 1` began to hold?",
            "always (not x or (not (y or d > 1) or (eventually d < @{d, opening})))",
        ),
        ("always(x implies(eventually d < @{d, opening}))", "", "always(not x or (eventually d < @{d, opening}))"),
    ],
)
def test_behind_implies_both_values_are_named_and_that_of_the_scope_can_be_had(
    text: str, value: str, mended: str
) -> None:
    (found,) = [each for each in findings(SIGNALS + text) if each.code == "LTL312"]
    assert value in found.message
    assert "any number" not in found.message
    (fix,) = found.fixes
    assert fixes.with_fixes(SIGNALS + text, [fix]) == SIGNALS + mended
    assert not [each for each in findings(SIGNALS + mended) if each.severity is Severity.ERROR]


@pytest.mark.parametrize(
    ("text", "is_offered"),
    [
        ("limit = y implies d > @{d, opening}\nalways (x implies limit)", True),
        ("always (x implies eventually d < @{d, opening} within 2 s)", False),
        ("soon = within 2 s, eventually d < @{d, opening}\nalways (x implies soon)", False),
    ],
)
def test_what_cannot_be_written_with_or_is_not_offered(text: str, is_offered: bool) -> None:
    (found,) = [each for each in findings(SIGNALS + text) if each.code == "LTL312"]
    assert not found.fixes
    assert ("`not (P) or …`" in found.help) == is_offered


@pytest.mark.parametrize(
    "text",
    [
        "x implies eventually d < @{d, opening}",
        "(always (x implies eventually y)) and (after x, d < @{d, opening})",
        "after_until x, y, never d > @{d, opening}",
    ],
)
def test_where_there_is_one_opening_it_is_none(text: str) -> None:
    assert "LTL312" not in codes_of(SIGNALS + text)


def test_only_signals_have_a_value_at_the_opening() -> None:
    assert codes_of(SIGNALS + "after x, d < @{d + 1, opening}") == ["LTL210"]


def test_an_association_is_read_in_the_scope_in_which_it_is_used() -> None:
    text = "limit = @{d, opening} + 1\na: after x, d < limit\nb: after_until y, x, d < limit\nc: never d > limit"
    compiled, _ = from_text(SIGNALS + text)
    assert [str(clock) for each in compiled for clock in each.specification.openings().values()] == [
        "after x",
        "after y until x",
        "the beginning",
    ]


def test_a_name_calle_d_opening_is_still_a_name() -> None:
    assert codes_of(SIGNALS.replace("decl d", "decl opening") + "never opening > @{opening, -1}") == []


@pytest.mark.parametrize("text", [TEXTS["a closing event"], TEXTS["the run"], DOCK])
def test_an_example_begins_a_scope_with_the_value_of_its_first_step(text: str) -> None:
    specification, _ = load_text(Source("props.txt", SIGNALS + text))
    assert specification is not None
    [explained] = explain(study_of(specification, EPISODE, Budget(30.0, 1024)), Budget(30.0, 1024))
    violated = next(example for example in explained.examples if "violated" in example.caption)
    rows = [dict(zip(violated.signals, step, strict=True)) for step in violated.steps]
    opened = next(n for n, row in enumerate(rows) if row.get("x", True))
    assert all(row["@{d, opening}"] == rows[opened]["d"] for row in rows[opened:])


def test_a_whole_number_is_compared_with_its_value_at_the_opening_exactly() -> None:
    whole = "decl u /u UInt8.data\ndecl on /on Bool.data\n"
    text = f"{whole}after on, always u == @{{u, opening}} + 1\nafter on, eventually u - @{{u, opening}} == 3"
    assert "LTL520" not in [each.code for each in examine(Source("p", text), [], EPISODE, BUDGET).diagnostics]


def test_a_finding_and_an_explanation_show_a_value_at_the_opening_as_it_is_written_or_in_words() -> None:
    text = f"{SIGNALS}limit = d == @{{d, opening}}\np: after x, eventually limit\nq: after x, d < @{{d, opening}} + 1"
    examined = examine(Source("p", text), [], EPISODE, BUDGET)
    (found,) = [each for each in examined.diagnostics if each.code == "LTL520"]
    assert found.message.startswith("`d == @{d, opening}` compares measured numbers exactly")
    assert "as in `d =={0.01} @{d, opening}`" in found.help
    assert examined.specification is not None
    _, explained = explain(study_of(examined.specification, EPISODE, BUDGET), BUDGET)
    assert explained.conditions[-1] == (
        "d < @{d, opening} + 1",
        "d is less than (what d was when the scope opened) + 1",
    )
    assert explained.english.endswith(
        "at every step from then on, d is less than (what d was when the scope opened) + 1."
    )


def test_a_value_at_an_opening_is_explained_in_words_within_a_calculation() -> None:
    specification, _ = load_text(Source("props.txt", SIGNALS + "p: " + DOCK))
    assert specification is not None
    [explained] = explain(study_of(specification, EPISODE, Budget(30.0, 1024)), Budget(30.0, 1024))
    assert explained.english.endswith("at every step, d is at most (what d was when the scope opened) + 0.1.")
    assert explained.conditions[2][0] == "d <= @{d, opening} + 0.1"


def test_the_part_that_is_open_up_to_an_event_is_the_word_without_it() -> None:
    a, b = frozenset("a"), frozenset("b")
    after_a, until_b = AfterOpened(BEGINNING, Atom("a")), UntilScope(BEGINNING, Atom("b"))
    assert open_part((a, a), until_b) == (a, a)
    assert open_part((a, b, a), until_b) is None
    assert open_part((b, a, a), after_a) == (a, a)
    assert open_part((b, b), after_a) is None
