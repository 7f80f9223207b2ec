"""The gate judges properties with clocks: in time, and what is wrong by a nanosecond is noticed."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial
from itertools import islice
from typing import TypeVar

import pytest
from code_mutants import mutations
from replaying import judged, outcomes, samples
from stepping import from_text
from timed import ARRIVAL, MESSAGE, X, Y, Z, compiled
from timed_mutants import class_text, clock_mutants, clocks_differ, code_differs, emitted_class, progressing

from ltlc.assurance.cross_check import cross_check
from ltlc.assurance.replay import Deviation, Replayed, replay
from ltlc.assurance.runs import Agreement, Mismatch
from ltlc.assurance.timed_program import TimedClass
from ltlc.compiler import Compiled
from ltlc.semantics import ltl
from ltlc.semantics import properties as p
from ltlc.semantics.properties import Property
from ltlc.semantics.timed_atoms import Age, Historically, Once, Previously, Since
from ltlc.semantics.trackers import trackers_of

T = TypeVar("T")
Kind = Callable[[int], Property]

MS = 10**6


def response(within: int) -> Property:
    return p.Always(p.Implies(p.Now(X), p.Within(within, p.Eventually(p.Now(Y)))))


def prevention(within: int) -> Property:
    return p.Always(p.Implies(p.Now(X), p.Within(within, p.Never(p.Now(Y)))))


def recent(within: int) -> Property:
    return p.Always(p.Now(ltl.implies(X, Once("recently", Y, within))))


def lasting(duration: int) -> Property:
    return p.Never(p.Now(Historically("long", X, duration)))


def since(within: int) -> Property:
    return p.Always(p.Now(ltl.implies(Z, Since("lately", X, Y, within))))


def aged(most: int) -> Property:
    return p.Always(p.Implies(p.Now(X), p.Now(Age("age", MESSAGE, most))))


def begun(within: int) -> Property:
    begins = ltl.And(X, ltl.Not(Previously("before", X)))
    return p.Always(p.Implies(p.Now(begins), p.Within(within, p.Eventually(p.Now(Y)))))


def answered(within: int) -> Property:
    return p.Always(p.Implies(p.Now(ARRIVAL), p.Within(within, p.Eventually(p.Now(Y)))))


def both(within: int) -> Property:
    kept, answer = p.Within(within, p.Never(p.Now(Y))), p.Within(3 * within, p.Eventually(p.Now(Y)))
    return p.Always(p.Implies(p.Now(X), p.And(kept, answer)))


KINDS = {
    "response": response,
    "prevention": prevention,
    "hold": lambda bound: p.Always(p.Implies(p.Now(X), p.Within(bound, p.Always(p.Now(Y))))),
    "recurrence": lambda bound: p.Always(p.Within(bound, p.Eventually(p.Now(Y)))),
    "both": both,
    "after": lambda bound: p.After(X, p.Within(bound, p.Eventually(p.Now(Y)))),
    "until": lambda bound: p.Until(Z, response(bound)),
    "within": lambda bound: p.Within(bound, p.Always(p.Now(X))),
    "interval": lambda bound: p.Within(3 * bound, p.Eventually(p.Now(X)), bound),
    "episodes": lambda bound: p.AfterUntil(X, Z, p.Within(bound, p.Eventually(p.Now(Y)))),
    "recent": recent,
    "lasting": lasting,
    "since": since,
    "age": aged,
    "previously": begun,
    "new": answered,
}

FEW = 3
"""Of the many changes of a kind, how many are tried here; `benchmarks/gate.py` tries all."""


def few(pairs: Iterable[tuple[T, T]], changes_a_verdict: Callable[[T], bool]) -> list[T]:
    """Of pairs of a change with short bounds and the same with long ones, the latter."""
    found = list(pairs)
    random.Random(0).shuffle(found)
    return list(islice((long for short, long in found if changes_a_verdict(short)), FEW))


@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
def test_a_monitor_of_a_property_with_clocks_is_as_defined(kind: Kind) -> None:
    assert isinstance(cross_check(compiled(kind(100 * MS))), Agreement)


@pytest.mark.parametrize("wrong", [100 * MS - 1, 100 * MS + 1, 10 * MS])
@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
def test_the_cross_check_notices_a_bound_that_is_wrong(kind: Kind, wrong: int) -> None:
    """Of which monitor, certificate and code would be made."""
    other = compiled(kind(wrong))
    specification = replace(other.specification, property=kind(100 * MS))
    assert isinstance(cross_check(replace(other, specification=specification)), Mismatch)


@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
def test_the_cross_check_notices_clocks_that_change_a_verdict(kind: Kind, monkeypatch: pytest.MonkeyPatch) -> None:
    small, large = compiled(kind(3)), compiled(kind(100 * MS))
    pairs = zip(clock_mutants(small.formula), clock_mutants(large.formula), strict=True)
    wrong = few(pairs, partial(clocks_differ, small))
    assert wrong
    for mutant in wrong:
        monkeypatch.setattr("ltlc.assurance.walks.trackers_of", lambda _, mutant=mutant: mutant)
        assert is_noticed(large), mutant


def is_noticed(mutant: Compiled) -> bool:
    """Clocks that contradict themselves are noticed at once."""
    try:
        return isinstance(cross_check(mutant), Mismatch)
    except ValueError:
        return True


def program_of(made: Compiled, text: str) -> TimedClass:
    return TimedClass(progressing(emitted_class(text)), made.specification.inputs())


@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
def test_the_replay_notices_emitted_code_that_changes_a_verdict(kind: Kind) -> None:
    small, large = compiled(kind(3)), compiled(kind(100 * MS))
    right = program_of(large, class_text(large))
    runs = list(right.runs(large, samples(large)))
    assert isinstance(replay(large, right.start, runs), Replayed)
    assert not code_differs(small, class_text(small))
    pairs = zip(*(mutations(class_text(made), "Emitted") for made in (small, large)), strict=True)

    def changes_a_verdict(mutant: Callable[[], str]) -> bool:
        return code_differs(small, mutant())

    wrong = [mutant() for mutant in few(pairs, changes_a_verdict)]
    assert wrong
    missed = [mutant for mutant in wrong if isinstance(replay(large, program_of(large, mutant).start, runs), Replayed)]
    assert not missed, missed[0]


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        (
            "elif state == 3:  # presumably violated\n            if time > self.due_1",
            "elif state == 3:\n            if time >= self.due_1",
        ),
        ("time = self.due + 1", "time = self.due + 2"),
    ],
)
def test_a_fault_that_shows_where_a_clock_expires_a_nanosecond_before_another_is_noticed(
    right: str, wrong: str
) -> None:
    made = compiled(both(100 * MS))
    text = class_text(made)
    assert right in text
    assert isinstance(judged(made, program_of(made, text.replace(right, wrong))), Deviation)


def test_an_interval_that_never_begins_is_noticed_though_no_clock_expires_in_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made = compiled(KINDS["interval"](100 * MS))
    begun = next(each.subject for each in trackers_of(made.formula) if isinstance(each.subject, Historically))
    never = replace(begun, operand=ltl.Not(begun.operand))
    (mutant,) = (each for each in clock_mutants(made.formula) if never in {tracker.subject for tracker in each})
    monkeypatch.setattr("ltlc.assurance.walks.trackers_of", lambda _: mutant)
    assert is_noticed(made)


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
    assert isinstance(judged(made, program_of(made, class_text(made))), Replayed)


BUTTONS = "decl bumper /bumper Bool.data\ndecl stopped /stopped Bool.data\n"
STOP = BUTTONS + "always (bumper implies eventually stopped within 100 ms)"
WHILE = "_timeout_ = 300 ms\n" + STOP
SCAN = "decl scan /scan LaserScan.range_min\nalways age(scan) <= 200 ms"
MOVING = "decl scan /scan LaserScan.range_min\n" + BUTTONS + "always (bumper implies age(scan) <= 200 ms)"
NOISE = (
    "decl scan /scan LaserScan.range_min\ndecl v /v Float64.data\n"
    "never (age(scan) <= 100 ms and previously age(scan) > 100 ms and v > 5 and scan > 0)"
)
GOAL = "decl goal /goal Bool.data\ndecl done /done Bool.data\nalways (new goal implies eventually new done within 30 s)"
SESSIONS = {
    "response": STOP,
    "response at a rate": "_rate_ = 30\n" + STOP,
    "response for a while": WHILE,
    "prevention": BUTTONS + "always (bumper implies never stopped within 100 ms)",
    "watchdog": SCAN,
    "watchdog at a rate": "_rate_ = 10\n" + SCAN,
    "age beside values": MOVING,
    "news at a rate": "_rate_ = 10\n" + GOAL,
    "episodes that news opens": BUTTONS + "after_until new bumper, stopped, eventually new stopped within 1 s",
    "episodes that the past opens": BUTTONS + "after bumper and not previously bumper, eventually stopped within 1 s",
    "a model at a rate": "_rate_ = 5\n_timeout_ = 4 s\nalways (robot.velocity > 1 implies "
    "once robot.velocity - @{robot.velocity, -2} > 1 within 2 s)",
} | HISTORY


@pytest.mark.parametrize("text", SESSIONS.values(), ids=SESSIONS)
def test_the_session_of_an_emitted_node_does_in_time_what_the_language_says(text: str) -> None:
    assert [type(outcome) for outcome in outcomes(text, "ros2")] == [Replayed]


FAULTS = {
    "a deadline that is early": (STOP, "self.monitor.due + 1 if", "self.monitor.due if"),
    "a deadline that is late": (STOP, "self.monitor.due + 1 if", "self.monitor.due + 2 if"),
    "a clock step that is skipped": (STOP, "while self.due <= time:", "while self.due < time:"),
    "a clock step that is told late": (STOP, "Moment(self.steps - 1, self.due,", "Moment(self.steps - 1, time,"),
    "clock steps that only the class takes": (
        STOP,
        "return self._clocks.hold(min(time, session.end))",
        "return []",
    ),
    "clock steps after the end": (
        WHILE,
        "self._clocks.hold(min(time, session.end))",
        "self._clocks.hold(time)",
    ),
    "a timer that rings late": (
        STOP,
        "return due if due <= self.session.end",
        "return due + 1 if due <= self.session.end",
    ),
    "no timer": (SCAN, "return due if due <= self.session.end and due < NEVER else None", "return None"),
    "the age of another topic": (MOVING, "self._aging.get(topic, ())", "sum(self._aging.values(), [])"),
    "a message that renews no age": (NOISE, "track.hear(time, heard)", "pass"),
    "a message without a step that leaves an age late": (NOISE, "changes += track.renew(time)", "pass"),
    "an instant before a tick": ("_rate_ = 10\n" + NOISE, "paces.without_tick(time, renewed)", "renewed"),
    "an age that counts from before the message": (MOVING, "time + age.bound)", "time + age.bound - 1)"),
    "an age from the beginning of time": (SCAN, "self.monitor = make(session)", "self.monitor = make(0)"),
    "a session that never begins": (
        MOVING,
        "        self._begin_session(time)\n        self._soon",
        "        self._soon",
    ),
    "news lost at a tick": ("_rate_ = 10\n" + GOAL, "self.heard.update(numbers)", "self.heard = set(numbers)"),
    "news at every tick": ("_rate_ = 10\n" + GOAL, "self.heard.clear()", "pass"),
    "news that is taken for held": (GOAL, "known[place] = is_new", "known[place] = True"),
    "ticks before clock steps": (
        "_rate_ = 30\n" + STOP,
        "changes = self._clocks.hold(time)",
        "changes: list[Change] = []",
    ),
    "a step after which no clock is looked at": (STOP, "self._clocks.note(track)", "pass"),
}


@pytest.mark.parametrize(("text", "right", "wrong"), FAULTS.values(), ids=FAULTS)
def test_a_fault_in_the_session_of_a_node_is_noticed(text: str, right: str, wrong: str) -> None:
    assert [type(outcome) for outcome in outcomes(text, "ros2", right, wrong)] == [Deviation]
