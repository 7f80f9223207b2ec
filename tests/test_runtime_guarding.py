"""A guard under a live clock: it acts as of now, and knows when it was late."""

from __future__ import annotations

import pytest

from benchmarks.guarded import CMD, MS, SCAN, Driven, Example
from ltlc.monitoring.guarding.arrangement import Arrangement
from ltlc.monitoring.guarding.followed import Followed
from ltlc.runtime.guarding import Action, Deed, Guard, Guards, Message

NEAR = CMD + SCAN + "near: always (min(scan) < 0.5 implies eventually speed <= 0.2 within 100 ms)\n"
ANSWERED = (
    CMD + "decl joy /joy sensor_msgs/Joy.axes[0]\n"
    "dead: always (age(joy) > 500 ms and previously age(joy) > 500 ms implies speed == 0)\n"
)
STOP = Message("stop", "/cmd_vel", {"speed": 0.0})


def guards(text: str) -> list[Guard]:
    """The guards of a file, whose session begins at 0."""
    driven = Driven(Example(text, {}))
    properties = {each.label: each for each in driven.specification.properties}
    found = []
    for some in driven.guarding.solved:
        arrangement = Arrangement(some, properties, driven.plan)
        own = [message for message in (STOP,) if message.out in some.arena.outs]
        found.append(Guard(Followed(arrangement, 0), some.arena.outs, own, driven.specification.lead))
    return found


@pytest.fixture
def near() -> Guard:
    """A guard of which something near demands to be slow 100 ms after the time 0; it is to act at 90 ms."""
    (guard,) = guards(NEAR)
    guard.hear(0, "/scan", {"scan": (5.0,)})
    assert guard.command(0, "/cmd_vel", {"speed": 1.0}).action is Action.PASSED
    assert not guard.hear(0, "/scan", {"scan": (0.25,)})
    assert guard.due() == 90 * MS
    return guard


@pytest.mark.parametrize("now", [90 * MS, 93 * MS, 100 * MS])
def test_what_is_sent_ahead_leaves_when_the_guard_gets_to_act(near: Guard, now: int) -> None:
    (deed,) = near.act(now)
    assert (deed.action, deed.time, deed.reason) == (Action.SENT, now, "ahead of a deadline of `near`")
    assert near.act(300 * MS) == []


def test_a_guard_that_finds_a_bound_passed_has_lost(near: Guard) -> None:
    (deed,) = near.act(250 * MS)
    why = "it was late, 0.15 s after a deadline of `near`"
    assert deed == Deed(250 * MS, Action.LOST, ("/cmd_vel",), reason=why)
    changed = near.command(251 * MS, "/cmd_vel", {"speed": 0.1})
    assert (changed.message, changed.reason) == ("stop", f"the guard has lost: {why}")
    assert near.act(10_000 * MS) == []


@pytest.mark.parametrize(("late", "action"), [(0, Action.SENT), (10, Action.SENT), (11, Action.LOST)])
def test_an_answer_to_time_counts_at_its_time_and_is_late_after_the_lead(late: int, action: Action) -> None:
    (guard,) = guards(ANSWERED)
    guard.hear(0, "/joy", {"joy": 1.0})
    assert guard.command(0, "/cmd_vel", {"speed": 1.0}).action is Action.PASSED
    due = guard.due()
    assert due == 500 * MS + 1
    (deed,) = guard.act(due + late * MS)
    assert deed.action is action
    assert deed.time == (due if action is Action.SENT else due + late * MS)


def test_what_one_guard_sends_another_hears_before_what_comes_later() -> None:
    deeds: list[Deed] = []
    other = "guard /b_raw to /b\ndecl b /b std_msgs/Float64.data\nheard: never (new b and speed > 0.2)\n"
    found = guards(NEAR + other)
    run = Guards(found, deeds.append)
    run.hear(0, "/scan", {"scan": (5.0,)})
    run.command(0, "/cmd_vel", {"speed": 1.0})
    run.command(1, "/b", {"b": 1.0})
    run.hear(2, "/scan", {"scan": (0.25,)})
    due = run.due()
    assert due is not None
    run.act(due + MS)
    run.command(due + 2 * MS, "/b", {"b": 1.0})
    acted = [(deed.action, deed.outs) for deed in deeds]
    assert (Action.HELD, ("/b",)) in acted
    assert acted[-2:] == [(Action.SENT, ("/cmd_vel",)), (Action.PASSED, ("/b",))]
