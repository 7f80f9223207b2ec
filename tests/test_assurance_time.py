"""The gate judges properties with clocks: in time, and what is wrong by a nanosecond is noticed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import pytest
from stepping import from_text
from test_backends_time import PRELUDE, compiled
from timed import X, Y, Z

from ltlc.assurance.cross_check import cross_check
from ltlc.assurance.programs import load
from ltlc.assurance.replay import Deviation, Replayed, replay
from ltlc.assurance.runs import Agreement, Mismatch
from ltlc.assurance.sources import given, without_news
from ltlc.assurance.timed_program import TimedClass
from ltlc.assurance.values import Samples
from ltlc.backends.python.functions import function_texts, names_used
from ltlc.backends.python.monitors import runtime_class
from ltlc.compiler import Compiled
from ltlc.semantics import ltl
from ltlc.semantics import properties as p
from ltlc.semantics.properties import Property
from ltlc.semantics.timed_atoms import Historically, Once

MS = 10**6


def response(within: int) -> Property:
    return p.Always(p.Implies(p.Now(X), p.Within(within, p.Eventually(p.Now(Y)))))


def prevention(within: int) -> Property:
    return p.Always(p.Implies(p.Now(X), p.Within(within, p.Never(p.Now(Y)))))


def recent(within: int) -> Property:
    return p.Always(p.Now(ltl.implies(X, Once("recently", Y, within))))


def lasting(duration: int) -> Property:
    return p.Never(p.Now(Historically("long", X, duration)))


KINDS = {
    "response": response,
    "prevention": prevention,
    "after": lambda bound: p.After(X, p.Within(bound, p.Eventually(p.Now(Y)))),
    "within": lambda bound: p.Within(bound, p.Always(p.Now(X))),
    "episodes": lambda bound: p.AfterUntil(X, Z, p.Within(bound, p.Eventually(p.Now(Y)))),
    "recent": recent,
    "lasting": lasting,
}


@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
def test_a_monitor_of_a_property_with_clocks_is_as_defined(kind) -> None:
    assert isinstance(cross_check(compiled(kind(100 * MS))), Agreement)


@pytest.mark.parametrize("wrong", [100 * MS - 1, 10 * MS])
@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
def test_the_cross_check_notices_a_bound_that_is_wrong(kind, wrong: int) -> None:
    """Of which monitor, certificate and code would be made."""
    other = compiled(kind(wrong))
    specification = replace(other.specification, property=kind(100 * MS))
    assert isinstance(cross_check(replace(other, specification=specification)), Mismatch)


def replayed(made: Compiled, text: str) -> Replayed | Deviation:
    functions = "\n".join(function_texts(sorted(names_used([text])))) + "\n"
    program = TimedClass(load(PRELUDE + functions + text, "emitted")["Emitted"], made.specification.inputs())
    specification = without_news(made.specification)
    return replay(made, program.start, program.runs(made, Samples(specification, given(specification))))


def wrong_texts(text: str) -> Iterator[str]:
    """Emitted code with one bound, comparison or start of a clock changed."""
    for old, new in (
        ("100_000_000", "100_000_001"),
        ("100_000_000", "99_999_999"),
        ("= time + ", "= time - 1 + "),
        ("= time - 1 + ", "= time + "),
        ("while time > self.due", "while time > self.due + 1"),
    ):
        start = text.index("def step")
        place = text.find(old, start)
        while place >= 0:
            yield text[:place] + new + text[place + len(old) :]
            place = text.find(old, place + 1)


@pytest.mark.parametrize("kind", [response, prevention, KINDS["after"], KINDS["within"], recent, lasting])
def test_the_replay_notices_emitted_code_that_is_wrong_by_a_nanosecond(kind) -> None:
    made = compiled(kind(100 * MS))
    text = runtime_class(made, "Emitted", "props.txt").text
    assert isinstance(replayed(made, text), Replayed)
    outcomes = {wrong: replayed(made, wrong) for wrong in wrong_texts(text)}
    missed = [wrong for wrong, outcome in outcomes.items() if isinstance(outcome, Replayed)]
    assert outcomes
    assert not missed, missed[0]


HISTORY = {
    "past samples": "always (robot.velocity > 1 implies once robot.velocity - @{robot.velocity, -2} > 1 within 2 s)",
    "a watchdog": "decl scan /scan LaserScan.range_min\nalways age(scan) <= 200 ms",
    "news": "decl goal /goal Bool.data\ndecl done /done Bool.data\n"
    "always (new goal implies eventually new done within 30 s)",
    "NaN": "decl x /x Float64.data\nnever historically sqrt(x) > 1 for 1 s",
}


@pytest.mark.parametrize("text", HISTORY.values(), ids=HISTORY)
def test_news_history_and_values_that_are_none_are_replayed(text: str) -> None:
    ((made,), _) = from_text(text)
    assert isinstance(replayed(made, runtime_class(made, "Emitted", "props.txt").text), Replayed)
