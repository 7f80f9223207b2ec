"""What `explain` says of when a property begins, and of the runs that it cannot show."""

from __future__ import annotations

import pytest
from language_support import compiled

from ltlc.analysis.analyse import study_of
from ltlc.analysis.explanation import Explanation, explain
from ltlc.analysis.questions import waits_for_others
from ltlc.base.limits import Budget
from ltlc.semantics.encodings import EPISODE
from ltlc.semantics.verdicts import Verdict

SIGNALS = "decl st /st Int32.data decl cx /cx Float64.data decl hps /hps Float64.data\n"
BUDGET = Budget(30.0, 1024)


def explained(text: str) -> Explanation:
    (found,) = explain(study_of(compiled(SIGNALS + text), EPISODE, BUDGET), BUDGET)
    return found


@pytest.mark.parametrize(
    ("text", "begins"),
    [
        ("never cx > 1", "when /cx has delivered a value that it reads"),
        ("never cx > hps", "when /cx and /hps have each delivered a value that it reads"),
        ("never cx > @{hps, -1}", "when /cx has delivered a value and /hps has delivered 2 values that it reads"),
        ("never cx > max(@{cx, -9:})", "when /cx has delivered 10 values that it reads"),
        ("never cx > @{cx, -1 else 0}", "when /cx has delivered a value that it reads"),
        ("_rate_ = 10 never cx > @{cx, -1}", "when /cx has delivered a value that it reads"),
        (
            "always (new cx and cx > 0 implies hps > 1)",
            "when /hps has delivered a value that it reads; it does not wait for /cx",
        ),
        (
            "after new st and st == 1, never new cx and not cx == 0",
            "with the session, whether or not any message arrives",
        ),
        ("always age(cx) < 1 s", "with the session, whether or not any message arrives"),
        ("always 1 < 2", "with the session, whether or not any message arrives"),
    ],
)
def test_when_a_property_begins_is_explained(text: str, begins: str) -> None:
    assert explained(text).begins == begins


def test_a_verdict_of_which_no_run_is_found_is_named() -> None:
    found = explained("never sin(cx) == 0.5 and cx > 7")
    assert found.not_shown == (Verdict.VIOLATED,)
    assert [example.caption for example in found.examples] == ["presumably satisfied"]


def test_nothing_is_said_of_runs_where_all_are_shown() -> None:
    assert explained("never cx > 7").not_shown == ()


@pytest.mark.parametrize(
    ("text", "waiting"),
    [
        ("(always age(cx) < 1 s) and never hps > 1", ["`always age(cx) < 1 s` waits for `hps`"]),
        ("(never hps > 1) and (never st == 1 or cx > 2) and never cx > 3", ["`never hps > 1` waits for `st` and `cx`"]),
        ("(never hps > 1) and eventually new cx and cx > 3", ["`eventually new cx and cx > 3` waits for `hps`"]),
        ("(never hps > 1) and eventually hps > 0", []),
        ("(never hps > 1) and until cx > 1, initially not hps > 3 or cx > 2", ["`never hps > 1` waits for `cx`"]),
        ("(never hps > 1) or never cx > 1", []),
        ("always (cx > 1 implies hps > 1)", []),
    ],
)
def test_a_part_that_waits_for_what_it_does_not_read_is_noted(text: str, waiting: list[str]) -> None:
    studied = study_of(compiled(SIGNALS + text), EPISODE, BUDGET)
    found = list(waits_for_others.ask(studied, studied.subjects[0]))
    assert [each.message.partition(",")[0] for each in found] == waiting


def test_a_property_of_each_id_is_shown_with_its_head() -> None:
    text = "decl id /t JoyFeedback.id\ndecl x /t JoyFeedback.intensity\neach g of id limit 9: never x > 1\n"
    assert explained(text).text == "each g of id limit 9: never x > 1"
