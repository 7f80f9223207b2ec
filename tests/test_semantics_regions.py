"""Regions of guards survive being written and read; what is changed in one is refused, or it is still closed."""

from __future__ import annotations

import random
import re
from contextlib import suppress

import pytest
from effort import share_of
from guarding import certified, drawn
from test_semantics_certificate_text import mangled

from ltlc.analysis.guards.solution import solve
from ltlc.semantics.arenas import Arena
from ltlc.semantics.certificate_reader import UnreadableError, parse
from ltlc.semantics.diagrams import Diagram, formulas, of_predicate
from ltlc.semantics.ltl import FALSE, Atom, Formula
from ltlc.semantics.region_check import objection
from ltlc.semantics.region_reader import RegionRead, guards_of, read_region

NEAR = """decl speed /cmd_vel Twist.linear.x
decl scan /scan LaserScan.ranges
message stop {linear.x: 0}
guard /cmd_vel_raw to /cmd_vel else stop
at_once: always (new speed and min(scan) < 0.5 implies speed <= 0.2)
soon: always (min(scan) < 0.5 implies eventually speed <= 0.2 within 100 ms)
"""


def read(arena: Arena, text: str) -> RegionRead:
    (lines,) = guards_of(text)
    return read_region(lines, arena)


def answer(arena: Arena, text: str) -> str | None:
    """Why the region in a file is not closed; None if it is."""
    return objection(arena, read(arena, text))


@pytest.mark.parametrize("seed", range(share_of(60)))
def test_the_region_of_a_guard_is_closed_if_it_may_rest_where_it_starts(seed: int) -> None:
    (arena,), text = certified(drawn(random.Random(seed)).text)
    begins = solve(arena).region().rests.get(arena.start, FALSE) != FALSE
    assert answer(arena, text) == (None if begins else "it may not rest in r0, where it starts")


@pytest.mark.parametrize("seed", range(share_of(30)))
def test_a_region_that_is_written_can_be_read(seed: int) -> None:
    (arena,), text = certified(drawn(random.Random(seed)).text)
    region, found = solve(arena).region(), read(arena, text)
    levels = {name: level for level, name in enumerate(arena.read)}

    def of(predicate: Formula) -> Diagram:
        return of_predicate(predicate, found.diagrams, levels)

    places = [joint for joint in found.spots if found.spots[joint].rests != found.diagrams.false]
    assert {joint: found.spots[joint].rests for joint in places} == {
        joint: of(rests) for joint, rests in region.rests.items() if arena.outcome(joint) is None
    }
    assert {(j, n): d for j, spot in found.spots.items() for n, d in spot.answers.items()} == {
        key: of(answers) for key, answers in region.answers.items() if arena.outcome(key[0]) is None
    }
    assert {(j, *key): d for j, spot in found.spots.items() for key, d in spot.acts.items()} == {
        key: of(acts) for key, acts in region.acts.items()
    }


@pytest.mark.parametrize("seed", range(share_of(40)))
def test_a_greatest_region_to_which_letters_are_added_is_refused(seed: int) -> None:
    (arena,), text = certified(drawn(random.Random(seed)).text)
    found = read(arena, text)
    if objection(arena, found) is None:
        assert_no_letters_can_be_added(arena, found)


def assert_no_letters_can_be_added(arena: Arena, found: RegionRead) -> None:
    for joint, spot in found.spots.items():
        possible = found.diagrams.conjunction(found.assumption or 0, found.diagrams.negation(spot.rests))
        if possible != found.diagrams.false:
            found.spots[joint] = spot._replace(rests=found.diagrams.true)
            name = formulas(lambda level: Atom(list(arena.read)[level]), found.diagrams)
            assert objection(arena, found) is not None, (joint, name(possible))
            found.spots[joint] = spot


SEVERAL_CLOCKS = [
    "(always (new speed implies not previously once new speed within 20 ms)) and "
    "(always (min(scan) < 0.5 implies eventually speed <= 0.2 within 100 ms))",
    "always (age(scan) > 200 ms implies eventually speed <= 0.2 within 100 ms)",
    "always (min(scan) < 0.5 implies (eventually speed <= 0.2 within 0.1 s) and (eventually speed <= 0 within 0.5 s))",
]


@pytest.mark.parametrize("property_", SEVERAL_CLOCKS)
def test_the_region_of_a_guard_with_several_clocks_in_a_property_is_closed_and_no_greater_one_is(
    property_: str,
) -> None:
    (arena,), text = certified(f"{NEAR[: NEAR.index('at_once')]}p: {property_}\n")
    assert arena.has_several_clocks
    found = read(arena, text)
    assert objection(arena, found) is None
    assert_no_letters_can_be_added(arena, found)


def test_what_a_guard_keeps_is_in_its_lines() -> None:
    _, text = certified(NEAR)
    _, _, guard = text.partition("\n\nguard ")
    assert guard.splitlines() == [
        "4 /cmd_vel_raw to /cmd_vel",
        "lead 10000000",
        "m0 /cmd_vel",
        "m1 /scan",
        "a0 m1 min(scan) < 0.5",
        "a1 m0 speed <= 0.2",
        "n0 m0 new speed",
        "g0 m0 stop a1 true",
        "u0 keeps 0 begins silent",
        "u1 keeps 1 begins 1",
        "assumption true",
        "k0 read running 0 idle",
        "k1 read running 0 running 0",
        "r0 silent waits waits rests true",
        "r1 silent q0 waits rests true",
        "r2 0 q0 waits rests true",
        "r3 1 q0 k0.q0 rests true",
        "r4 1 q0 k1.q1 rests true",
        "ahead r4 1.1 g0 true",
        "end",
    ]


CHANGES = [
    (r"r4 .*\nahead.*\n", "", "r3: no answer to a message on /scan"),
    (r"ahead.*\n", "", "r4: no answer to the passage of time"),
    (r"ahead r4 1.1", "ahead r4 1.0", "r4: no answer to the passage of time"),
    (r"r3 1 q0 k0.q0", "r3 0 q0 k0.q0", "r3: no answer to a message on /scan"),
    (r"r0 (.*) rests true", r"r0 \1 rests false", "it may not rest in r0, where it starts"),
    (r"r0 (.*) rests true", r"r0 \1 rests true g0 true", "r0: it may not send here"),
    (r"k1 read running 0 running 0", "k1 read running 0 running 1", "r3: no answer to a message on /scan"),
    (r"assumption true", "assumption false", "nothing is found that its assumption allows"),
]


@pytest.mark.parametrize(("old", "new", "reason"), CHANGES)
def test_a_region_that_is_not_closed_is_refused_with_the_place(old: str, new: str, reason: str) -> None:
    (arena,), text = certified(NEAR)
    changed, count = re.subn(old, new, text)
    assert count == 1
    assert answer(arena, changed) == reason


@pytest.mark.parametrize("seed", range(share_of(200)))
def test_a_mangled_region_is_refused_or_answered(seed: int) -> None:
    (arena,), text = certified(NEAR)
    start, guard = text[: text.index("\nguard ") + 1], text[text.index("\nguard ") + 1 :]
    with suppress(UnreadableError):
        changed = start + mangled(guard, random.Random(seed))
        parse(changed)
        for lines in guards_of(changed):
            objection(arena, read_region(lines, arena))


@pytest.mark.parametrize(
    "line", ["d0 a9 then true else false", "r5 2 q0 q0 rests true", "r5 1 q0 k0.q0 rests true", "ahead r4 9.1 g0 true"]
)
def test_a_line_that_a_region_cannot_have_is_named(line: str) -> None:
    (arena,), text = certified(NEAR)
    lines = text.split("\n")
    number = lines.index("ahead r4 1.1 g0 true") if not line.startswith("d") else lines.index("assumption true")
    with pytest.raises(UnreadableError) as error:
        read(arena, "\n".join([*lines[:number], line, *lines[number:]]))
    assert error.value.line == number + 1
