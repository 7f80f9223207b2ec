"""What guards may do, solved: against the same game by brute force, and guards as people write them."""

from __future__ import annotations

import random
from dataclasses import replace

import pytest
from effort import share_of
from guarding import MS, Brute, Drawn, Event, Followed, drawn, loaded

import ltlc
from ltlc.analysis.analyse import study_of
from ltlc.analysis.errors import NotDecidedError
from ltlc.analysis.guards.plays import play
from ltlc.analysis.guards.solution import solve
from ltlc.analysis.questions import (
    exact_equality,
    guard_holds_back,
    guard_passes_nothing,
    guard_takes_back,
    uncontrollable,
)
from ltlc.automata import Budget
from ltlc.semantics.arenas import Outcome
from ltlc.semantics.encodings import EPISODE

MOMENTS = [0, 1, 5 * MS, 10 * MS, 10 * MS + 1, 20 * MS, 20 * MS + 1]
"""What lies between two messages, in ns: about the bounds of drawn guards."""


def positions(guard: Drawn, chance: random.Random) -> list[tuple[tuple[Event, ...], int, bool]]:
    """A run of a drawn guard as far as it has come each time, the time then, and whether the guard may rest there."""
    specification, arenas = loaded(guard.text)
    solution = solve(arenas[0])
    followed, found = Followed(specification, solution.game, guard), []
    events: tuple[Event, ...] = ()
    now = 1000 * MS
    first = chance.sample([t for t in guard.values if t != guard.out], len(guard.values) - 1)
    for topic in [*first, *chance.choices([*guard.values, guard.out], k=chance.randrange(1, 4))]:
        now += 0 if len(events) < len(first) else chance.choice(MOMENTS)
        event = (now, topic, chance.choice(list(guard.messages(topic))))
        followed.take(event)
        events = (*events, event)
        if Outcome.VIOLATED in followed.joint.standings:
            break
        if followed.joint.sent is not None and Outcome.WAITING not in followed.joint.standings:
            found.append((events, now, followed.rests(solution.rests)))
    return found


@pytest.mark.parametrize(
    ("seed", "as_one"),
    [*((n, False) for n in range(share_of(100))), *((n, True) for n in range(share_of(30)))],
)
def test_where_a_guard_may_rest_the_world_forces_no_violation(seed: int, as_one: bool) -> None:
    chance = random.Random(seed)
    guard = drawn(chance, as_one=as_one)
    brute = Brute(guard)
    for events, now, rests in positions(guard, chance):
        assert not rests or not (brute.is_violated(events, now) or brute.is_forced(events, now, 2)), events


@pytest.mark.parametrize("seed", range(share_of(100)))
def test_where_a_guard_without_clocks_may_not_rest_the_world_forces_a_violation(seed: int) -> None:
    chance = random.Random(seed)
    guard = drawn(chance, timed=False)
    brute = Brute(guard)
    for events, now, rests in positions(guard, chance):
        assert rests or any(brute.is_forced(events, now, depth) for depth in (1, 2, 3)), events


@pytest.mark.parametrize("seed", range(share_of(50)))
def test_a_play_from_where_a_guard_may_not_rest_ends_in_a_violation(seed: int) -> None:
    _, (arena, *_) = loaded(drawn(random.Random(seed)).text)
    solution = solve(arena)
    d = solution.game.diagrams
    for joint, rests in solution.rests.items():
        for path, outside in d.paths(d.conjunction(solution.game.possible, d.negation(rests))):
            if outside and arena.outcome(joint) is None:
                letter = frozenset(solution.game.atoms[level] for level, holds in path.items() if holds)
                turns = play(solution, joint, letter)
                assert arena.outcome(turns[-1].step.joint) is Outcome.VIOLATED
                assert all(arena.outcome(turn.step.joint) is None for turn in turns[:-1])


BASE = """decl speed /cmd_vel geometry_msgs/Twist.linear.x
decl scan /scan sensor_msgs/LaserScan.ranges
decl held /frozen std_msgs/Bool.data
message stop {linear.x: 0}
guard /cmd_vel_raw to /cmd_vel"""

PASSES_NOTHING, BEGINS_NEVER, HOLDS_BACK, TAKES_BACK = "LTL610", "LTL611", "LTL612", "LTL613"
UNCONTROLLABLE, CONTROLLABLE, NOT_DECIDED = "LTL616", "LTL617", "LTL690"

AS_WRITTEN: dict[str, tuple[str, set[str]]] = {
    "slow near obstacles, at once": ("else stop\np: always (min(scan) < 0.5 implies speed <= 0.2)", {HOLDS_BACK}),
    "slow near obstacles, an instant later": (
        "else stop\np: always (min(scan) < 0.5 and previously min(scan) < 0.5 implies speed <= 0.2)",
        set(),
    ),
    "slow near obstacles, in time": (
        "else stop\np: always (min(scan) < 0.5 implies eventually speed <= 0.2 within 100 ms)",
        {TAKES_BACK},
    ),
    "slow near obstacles, in time, and no new fast command": (
        "else stop\np: always (min(scan) < 0.5 implies eventually speed <= 0.2 within 100 ms)\n"
        "q: always (new speed and min(scan) < 0.5 implies speed <= 0.2)",
        set(),
    ),
    "a deadline that only a message keeps, which nothing sends": (
        "\np: always (min(scan) < 0.5 implies eventually speed <= 0.2 within 100 ms)",
        {HOLDS_BACK},
    ),
    "a fallback that does not help": (
        "else go\nmessage go {linear.x: 1}\np: always not held or speed > 2",
        {HOLDS_BACK},
    ),
    "what the world decides": (
        "else stop\np: always (new speed implies speed <= 1)\nq: never (held and speed < 100)",
        {PASSES_NOTHING},
    ),
    "no way to begin": ("\np: always abs(speed - @{speed, -1}) <= 0.2", {BEGINS_NEVER}),
    "a fallback to begin with": ("else stop\np: always abs(speed - @{speed, -1}) <= 0.2", set()),
    "at most so often": ("\np: always (new speed implies not previously once new speed within 20 ms)", set()),
    "a silent operator": ("else stop\np: always (age(held) > 500 ms implies speed == 0)", set()),
    "a limit that a sensor sets, below zero too": (
        "else stop\np: always (speed > min(scan) implies eventually speed <= min(scan) within 200 ms)",
        {PASSES_NOTHING},
    ),
    "a limit that a sensor sets, not below zero": (
        "else stop\nassume always min(scan) >= 0\n"
        "p: always (speed > min(scan) implies eventually speed <= min(scan) within 200 ms)",
        {TAKES_BACK},
    ),
    "what follows for any command, but is not known of a fallback": (
        "else stop\np: always (new speed and min(scan) > 3 implies speed == 0 or speed * min(scan) <= 0)\n"
        "q: always (min(scan) > 3 implies eventually (speed == 0 or speed * min(scan) <= 0) within 50 ms)",
        set(),
    ),
    "a heartbeat": ("else stop\np: always age(speed) <= 100 ms", set()),
    "what counts": ("else stop\np: never once new speed 4 times within 10 s", {PASSES_NOTHING}),
    "a value at an opening": (
        "else stop\np: after_until held, not held, always (not (new speed) or speed <= @{speed, opening})",
        set(),
    ),
    "two properties at odds": (
        "else stop\np: always (min(scan) < 0.5 implies eventually speed <= 0.2 within 100 ms)\n"
        "q: never (new speed and held)",
        {HOLDS_BACK},
    ),
}


@pytest.mark.parametrize("name", AS_WRITTEN)
def test_a_guard_as_people_write_it_has_its_findings(name: str) -> None:
    text, expected = AS_WRITTEN[name]
    specification, _ = loaded(f"{BASE} {text}\n")
    study = study_of(specification, EPISODE, Budget())
    asked = (guard_passes_nothing, guard_holds_back, guard_takes_back)
    assert {finding.code for question in asked for finding in question.ask(study)} == expected


SELDOM = "always (new speed implies not previously once new speed within 20 ms)"
IN_TIME = "always (min(scan) < 0.5 implies eventually speed <= 0.2 within 100 ms)"


@pytest.mark.parametrize("text", [f"p: {SELDOM}\nq: {IN_TIME}", f"p: ({SELDOM}) and ({IN_TIME})"])
def test_where_a_guard_does_not_know_which_clock_ends_first_it_is_said_that_it_may_be_too_strict(text: str) -> None:
    specification, _ = loaded(f"{BASE} else stop\n{text}\n")
    [finding] = guard_holds_back.ask(study_of(specification, EPISODE, Budget()))
    assert finding.code == HOLDS_BACK
    assert "speed is more than 0.2" in finding.message
    assert "may be stricter than it must be" in finding.message


def test_what_helps_against_a_guard_that_is_too_strict_is_not_to_limit_its_fallback() -> None:
    text = f"p: {SELDOM.replace('new speed implies', 'new speed and speed > 0.2 implies')}\nq: {IN_TIME}"
    specification, _ = loaded(f"{BASE} else stop\n{text}\n")
    assert not [*guard_holds_back.ask(study_of(specification, EPISODE, Budget()))]


BEATS = f"p: {SELDOM}\nq: always age(speed) <= 100 ms"


def test_a_guard_that_nothing_passes_since_it_does_not_know_which_clock_ends_first_says_so() -> None:
    specification, _ = loaded(f"{BASE} else stop\n{BEATS}\n")
    [finding] = guard_passes_nothing.ask(study_of(specification, EPISODE, Budget()))
    assert finding.code == PASSES_NOTHING
    assert "does not know which clock of `p` and `q` ends first" in finding.message


def test_what_a_controller_can_keep_is_not_said_to_be_impossible_for_want_of_the_order_of_clocks() -> None:
    text = f"decl speed /cmd_vel geometry_msgs/Twist.linear.x\n{BEATS}\n"
    monitor = ltlc.monitor(text)
    for time in range(0, 1000, 50):
        monitor.step({"speed": 0.0}, time_ns=time * MS)
    assert ltlc.Verdict.VIOLATED not in monitor.verdicts.values()
    specification, _ = loaded(text)
    study = replace(study_of(specification, EPISODE, Budget()), controls=("/cmd_vel",))
    with pytest.raises(NotDecidedError, match="any order"):
        [*uncontrollable.ask(study)]


COMMANDS = """decl speed /cmd_vel geometry_msgs/Twist.linear.x
decl near /near std_msgs/Bool.data
decl x /odom nav_msgs/Odometry.pose.pose.position.x
"""

CONTROLLED: dict[str, tuple[str, set[str]]] = {
    "where the robot is": ("p: always x <= 10 or speed > 5", {CONTROLLABLE}),
    "where the robot is, and a limit": (
        "p: always (x <= 10 or speed > 5)\nq: always (x > 9 implies speed < 1)",
        {UNCONTROLLABLE},
    ),
    "slow in time": ("p: always (near implies eventually speed <= 0 within 100 ms)", {CONTROLLABLE}),
    "both within a time, with one message each": (
        "p: always (near implies eventually speed > 1 within 100 ms)\n"
        "q: always (near implies eventually speed < 0 within 100 ms)",
        {CONTROLLABLE},
    ),
    "a goal again and again": ("p: always eventually speed > 1", {CONTROLLABLE}),
    "a goal that the world forbids": (
        "p: always eventually speed > 1\nq: always (near implies speed <= 0)",
        {CONTROLLABLE, UNCONTROLLABLE},
    ),
    "a goal of the world's": ("p: always (eventually near or speed > 1)", {CONTROLLABLE}),
    "a goal, some time after a message": (
        "p: always (new near implies eventually speed > 1)",
        {CONTROLLABLE, NOT_DECIDED},
    ),
    "nothing to command": ("p: always (near implies eventually x > 1)", set()),
}


@pytest.mark.parametrize("name", CONTROLLED)
def test_whether_a_controller_can_keep_properties_is_answered(name: str) -> None:
    text, expected = CONTROLLED[name]
    specification, _ = loaded(f"{COMMANDS}{text}\n")
    study = replace(study_of(specification, EPISODE, Budget()), controls=("/cmd_vel",))
    found = [*uncontrollable.ask(study), *uncontrollable.ask_of_obligations(study)]
    assert {finding.code for finding in found} == expected


def test_a_condition_and_what_denies_it_are_named_once() -> None:
    specification, _ = loaded(
        f"{BASE} else stop\np: always (speed <= 0.2 or not held)\n"
        "q: always (speed > 0.2 implies eventually held within 1 s)\n"
    )
    found = [finding.message for finding in guard_holds_back.ask(study_of(specification, EPISODE, Budget()))]
    assert found == ["no command passes where speed is more than 0.2, though it violates nothing by itself"]


def test_what_a_guard_sends_may_be_compared_exactly() -> None:
    lift = "decl v /lift Float64.data\np: always (new v and v == 0 implies previously v == 0)\n"
    for text, codes in ((lift, ["LTL520"]), (f"guard /raw to /lift else halt\nmessage halt {{}}\n{lift}", [])):
        specification, _ = loaded(text)
        assert [each.code for each in exact_equality.ask(study_of(specification, EPISODE, Budget()))] == codes


def test_guards_that_share_a_property_are_one_game() -> None:
    """One closes while the other is open: whoever sends may break it, so both have to know."""
    text = (
        "guard /a_raw to /a else off\nguard /b_raw to /b else off\nguard /c_raw to /c\nmessage off {}\n"
        "decl a /a std_msgs/Bool.data\ndecl b /b std_msgs/Bool.data\ndecl c /c std_msgs/Bool.data\n"
        "p: never (a and b)\nq: never (new c and c)\n"
    )
    _, arenas = loaded(text)
    assert [arena.outs for arena in arenas] == [("/a", "/b"), ("/c",)]
    solution = solve(arenas[0])
    assert all(solution.game.exists(solution.let_through(out)) for out in ("/a", "/b"))
    letters = solution.game.diagrams.conjunction(solution.game.atom("a"), solution.game.atom("b"))
    both = solution.game.diagrams.conjunction(solution.let_through("/a"), letters)
    assert both == solution.game.diagrams.false


def test_an_emergency_stop_that_was_released_before_the_first_command_is_not_forgotten() -> None:
    """The property waits for no command, so it begins before the first one leaves, while the guard is silent."""
    text = (
        "decl speed /cmd Float64.data\ndecl pressed /estop Bool.data\ndecl reset /reset Bool.data\n"
        "decl near /near Bool.data\nguard /raw to /cmd\n"
        "p: after_until pressed, reset, always (new speed implies speed <= 0)\nq: never (new speed and near)\n"
    )
    guard = Drawn(text, {}, {}, [])
    specification, (arena,) = loaded(text)
    solution = solve(arena)
    rests = []
    for was_pressed in (False, True):
        followed = Followed(specification, solution.game, guard)
        followed.take((0, "/reset", (("reset", False),)))
        followed.take((1, "/estop", (("pressed", was_pressed),)))
        followed.take((2, "/estop", (("pressed", False),)))
        followed.take((3, "/near", (("near", False),)))
        assert followed.joint in solution.visited
        followed.take((4, "/cmd", (("speed", 1.0),)))
        rests.append(followed.rests(solution.rests))
    assert rests == [True, False]


def test_a_guard_does_not_break_an_assumption_by_itself() -> None:
    text = (
        "guard /raw to /cmd else stop\nmessage stop {}\ndecl speed /cmd Float64.data\n"
        "assume always speed <= 5\np: always speed <= 9\n"
    )
    _, (arena,) = loaded(text)
    solution = solve(arena)
    d = solution.game.diagrams
    assert d.conjunction(solution.let_through("/cmd"), d.negation(solution.game.atom("speed <= 5"))) == d.false
