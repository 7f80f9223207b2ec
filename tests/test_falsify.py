"""`ltlc falsify`: what is found violates a property, is shrunk to something that does, and follows from the seed."""

from __future__ import annotations

import math
import os
import signal
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import groupby, islice
from random import Random
from threading import Lock
from typing import Any

import pytest
from effort import share_of

import ltlc
from ltlc.falsification import search
from ltlc.falsification.assignment import Assignment
from ltlc.falsification.parameters import Choices, Integers, Reals, Space, space_of
from ltlc.falsification.search import Losses, Point, batches, ranked
from ltlc.falsification.shrinking import shrink, simpler, size
from ltlc.semantics.verdicts import Verdict

DECLARATIONS = """
decl v /v std_msgs/Float64.data
decl w /w std_msgs/Float64.data
decl on /on std_msgs/Bool.data
"""
SLOW = f"{DECLARATIONS}slow: never v > 2"

Rows = list[tuple[float, dict[str, Any]]]


def constant(**values: Any) -> Rows:
    """A run of 1 s in which nothing changes."""
    return [(0.0, values), (1.0, values)]


def valley(given: Mapping[str, Any]) -> Rows:
    """A speed that is above 2 close to one point only: in a millionth of the space."""
    return constant(v=2.001 - math.dist((given["a"], given["b"], given["c"]), (0.83, 0.21, 0.55)) ** 2)


UNIT = ["a=0..1", "b=0..1", "c=0..1"]


def test_what_is_found_violates_the_property_that_is_named() -> None:
    found = ltlc.falsify(SLOW, lambda given: constant(v=given["gain"] * 3), ["gain=0..0.1..1"])
    assert (found.violated, found.exit_code) == ("slow", 1)
    assert found.parameters is not None
    assert found.run is not None
    again = ltlc.run(SLOW, constant(v=found.parameters["gain"] * 3))
    assert [each.label for each in again.violations] == ["slow"]
    assert found.run.verdicts == again.verdicts


@pytest.mark.parametrize("seed", range(4))
def test_a_small_fault_is_found_where_robustness_leads_to_it(seed: int) -> None:
    found = ltlc.falsify(SLOW, valley, UNIT, simulations=400, seed=seed)
    assert found.violated == "slow"


def test_where_all_runs_seem_alike_such_a_fault_is_not_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ltlc.falsification.falsify._losses", lambda _: {"slow": 1.0})
    found = ltlc.falsify(SLOW, valley, UNIT, simulations=400)
    assert (found.violated, found.parameters, found.run) == (None, None, None)


def test_everything_follows_from_the_seed() -> None:
    documents = [ltlc.falsify(SLOW, valley, UNIT, simulations=30, seed=seed).document() for seed in (5, 5, 6)]
    assert documents[0] == documents[1]
    assert documents[0]["properties"] != documents[2]["properties"]


def test_no_other_random_numbers_are_touched() -> None:
    import numpy as np

    np.random.seed(1)
    before = str(np.random.get_state(legacy=False))
    ltlc.falsify(SLOW, valley, UNIT, simulations=60)
    assert str(np.random.get_state(legacy=False)) == before


def test_a_violation_with_all_defaults_needs_no_search() -> None:
    found = ltlc.falsify(SLOW, lambda given: constant(v=3), ["gain=0..1"])
    assert "slow is violated with all defaults." in str(found)
    assert found.document()["simulations"] == 1
    assert found.parameters == {"gain": 0.5}


def test_nothing_found_proves_nothing_and_says_how_close_it_was() -> None:
    found = ltlc.falsify(SLOW, lambda given: constant(v=given["gain"]), ["gain=0..1"], simulations=20)
    assert found.exit_code == 0
    assert "No property is violated in 20 simulations (seed 0), which proves nothing." in str(found)
    [slow] = found.document()["properties"]
    assert slow["closest"]["margin"] == pytest.approx(2 - slow["closest"]["assignment"]["gain"])
    assert slow["closest"]["margin"] < 1.05


def test_few_choices_are_all_tried_whatever_guides() -> None:
    seen = []

    def simulate(given: Mapping[str, Any]) -> Rows:
        seen.append((given["floor"], given["boxes"]))
        return constant(on=True)

    found = ltlc.falsify(
        f"{DECLARATIONS}lit: always on", simulate, ["floor=dry,wet,ice", "boxes:int=1..4"], simulations=12
    )
    assert (len(seen), len(set(seen))) == (12, 12)
    assert found.exit_code == 0
    assert "No property is violated in any simulation: all 12 simulations were run." in str(found)


def test_no_assignment_is_simulated_twice_in_a_search() -> None:
    seen = []

    def simulate(given: Mapping[str, Any]) -> Rows:
        seen.append(given["boxes"])
        return constant(v=0)

    ltlc.falsify(SLOW, simulate, ["boxes:int=1..10"], simulations=9)
    assert sorted(seen) == sorted(set(seen))
    assert len(seen) == 9


def test_a_property_without_a_margin_is_judged_and_reported_as_no_guide() -> None:
    text = f"{DECLARATIONS}counted: never once new v 4 times\nslow: never v > 2\n"
    text += "opened: after historically v < 9 for 1 ns, never v > @{v, opening} + 9"

    def simulate(given: Mapping[str, Any]) -> Rows:
        return [(k / 10, {"v": 0}) for k in range(given["messages"])]

    found = ltlc.falsify(text, simulate, ["messages:int=1..1..2"], simulations=2)
    assert "counted: no comparison of numbers decides it, so it did not guide the search" in str(found)
    assert "opened: not measured, so it did not guide the search: time opens or closes a scope" in str(found)
    assert ltlc.falsify(text, simulate, ["messages:int=1..1..9"], simulations=9).violated == "counted"


def test_simulations_that_fail_are_counted_and_the_search_goes_on() -> None:
    def simulate(given: Mapping[str, Any]) -> Rows:
        if given["gain"] > 0.6:
            raise RuntimeError("the wheels came off")
        return constant(v=0)

    found = ltlc.falsify(SLOW, simulate, ["gain=0..1"], simulations=20)
    assert found.exit_code == 2
    assert "RuntimeError: the wheels came off" in str(found)
    failed = found.document()["failed"]
    assert failed
    assert all(each["assignment"]["gain"] > 0.6 for each in failed)


@pytest.mark.parametrize(
    ("given", "reason"),
    [
        ([(0, {"v": "fast"})], "fast"),
        (7, "7 is not a recording"),
        ([(0, {"v": 1}), (-1, {"v": 1})], "its recording cannot be judged"),
        ("nowhere.csv", "there is no file `nowhere.csv`"),
    ],
)
def test_a_first_simulation_that_cannot_be_judged_ends_it(given: Any, reason: str) -> None:
    with pytest.raises(ltlc.UnusableInput, match="the first simulation, with all defaults, failed: ") as raised:
        ltlc.falsify(SLOW, lambda _: given, ["gain=0..1"])
    assert reason in str(raised.value)


def test_what_is_open_at_the_end_or_never_starts_is_not_taken_for_well() -> None:
    text = f"{DECLARATIONS}ends: eventually v > 5\nidle: never w > 2"
    found = ltlc.falsify(text, lambda given: constant(v=given["gain"]), ["gain=0..1"], simulations=10)
    assert found.exit_code == 3
    assert re_lines(str(found)) == {"ends": "open at the end of 10 simulations, as of 1", "idle": "never started"}


def re_lines(text: str) -> dict[str, str]:
    """The last remark on each property."""
    lines = [line.strip().partition(": ") for line in text.splitlines() if line.startswith("  ")]
    return {label: told.rpartition("; ")[2] for label, _, told in lines}


def test_what_was_not_looked_at_is_reported() -> None:
    text = f"{DECLARATIONS}slow: never v > 2\nquiet: after w > 5, never v > 1"

    def simulate(given: Mapping[str, Any]) -> Rows:
        return constant(v=math.nan if given["n"] == 2 else 0, w=given["n"])

    some = ltlc.falsify(text, simulate, ["n:int=1..1..6"], simulations=6)
    remarks = re_lines(str(some))
    assert remarks["slow"] == "steps left out in 1 simulation, as of 2: a value was NaN"
    assert "not triggered in 4; steps left out" in str(some)
    document = some.document()["properties"]
    assert [(each["not_triggered"], each["left_out"]) for each in document] == [(0, [2]), (4, [2])]
    none = ltlc.falsify(text, simulate, ["n:int=3..3..5"], simulations=3)
    assert re_lines(str(none))["quiet"] == "never triggered"


def test_what_a_run_leaves_open_at_its_end_does_not_guide() -> None:
    text = f"{DECLARATIONS}answers: always (v > 1 implies eventually w > 1 within 1 s)"
    rows: Rows = [(0.0, {"v": 2, "w": 0}), (1.0, {"v": 0, "w": 1.25}), (2.0, {"v": 3, "w": 0})]
    found = ltlc.falsify(text, lambda _: rows, ["gain=0..1"], simulations=3)
    [answers] = found.document()["properties"]
    assert answers["closest"]["margin"] == 0.25
    assert found.exit_code == 3


def test_a_simulation_that_does_not_repeat_itself_is_not_shrunk() -> None:
    speeds = iter([0, 3, *[0] * 100])
    found = ltlc.falsify(SLOW, lambda _: constant(v=next(speeds)), ["gain=0..1"], simulations=10)
    assert found.violated == "slow"
    assert "the simulation is not repeatable" in str(found)
    assert found.document()["smallest"] is None
    assert found.run is not None
    assert found.run.violations


def test_what_is_found_does_not_depend_on_jobs() -> None:
    def simulate(given: Mapping[str, Any]) -> Rows:
        return constant(v=2.05 - math.dist((given["a"], given["b"]), (0.83, 0.21)) ** 2)

    found = [ltlc.falsify(SLOW, simulate, UNIT[:2], jobs=jobs) for jobs in (1, 3)]
    assert found[0].document() == found[1].document()
    assert str(found[0]) == str(found[1])
    assert found[0].run is not None
    assert found[1].run is not None
    assert found[0].run.document() == found[1].run.document()


@pytest.mark.parametrize(("chosen", "left_out"), [("fast", ["high"]), ("fast[w]", ["fast[v]", "high"])])
def test_the_label_of_a_forall_chooses_all_that_it_stands_for(chosen: str, left_out: list[str]) -> None:
    text = f"{DECLARATIONS}fast: forall r in {{v, w}}: never r > 2\nhigh: never v > 9"
    found = ltlc.falsify(text, lambda _: constant(v=0, w=0), ["gain=0..1"], simulations=1, properties=[chosen])
    assert found.document()["not_searched"] == left_out


def test_a_function_that_several_jobs_call_need_not_be_picklable_but_what_it_gives() -> None:
    lock: Any = Lock()

    def simulate(given: Mapping[str, Any]) -> Iterator[tuple[float, dict[str, Any]]]:
        with lock:
            yield from constant(v=given["gain"] * 3)

    assert ltlc.falsify(SLOW, simulate, ["gain=0..0.1..1"], jobs=2).violated == "slow"
    with pytest.raises(ltlc.UnusableInput, match="what it gave cannot be pickled, as several jobs need: TypeError: "):
        ltlc.falsify(SLOW, lambda _: [lock], ["gain=0..1"], jobs=2)


@pytest.mark.parametrize(
    ("crash", "reason"),
    [
        (lambda: os.kill(os.getpid(), signal.SIGSEGV), "its process crashed, or ran out of memory"),
        (lambda: sys.exit("no licence"), "SystemExit: no licence"),
        (lambda: 1 / 0, "ZeroDivisionError: division by zero"),
    ],
)
def test_a_function_that_ends_its_process_is_a_simulation_that_failed(crash: Callable[[], object], reason: str) -> None:
    def simulate(given: Mapping[str, Any]) -> Rows:
        if given["floor"] == "ice":
            crash()
        return constant(v=0)

    found = ltlc.falsify(SLOW, simulate, ["floor=dry,wet,ice,sand"], simulations=9, jobs=2)
    [failed] = found.document()["failed"]
    assert failed["reason"].startswith(reason)
    assert (failed["assignment"], found.document()["simulations"]) == ({"floor": "ice"}, 4)


def test_the_error_of_the_first_simulation_has_its_traceback() -> None:
    with pytest.raises(ltlc.UnusableInput) as raised:
        ltlc.falsify(SLOW, lambda given: given["gian"], ["gain=0..1"])
    assert isinstance(raised.value.__cause__, KeyError)


def test_an_interrupted_search_is_interrupted_in_python() -> None:
    def simulate(given: Mapping[str, Any]) -> Rows:
        if given["gain"] != 0.5:
            raise KeyboardInterrupt
        return constant(v=0)

    with pytest.raises(KeyboardInterrupt):
        ltlc.falsify(SLOW, simulate, ["gain=0..1"])


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ({"jobs": 0}, "0 jobs: a number from 1 on"),
        ({"properties": ["slw"]}, "there is no property `slw`: did you mean"),
    ],
)
def test_options_that_cannot_be_are_refused(options: dict[str, Any], reason: str) -> None:
    with pytest.raises(ltlc.UnusableInput, match=reason):
        ltlc.falsify(SLOW, lambda _: constant(v=0), ["gain=0..1"], **options)


def test_the_property_that_was_found_is_shrunk_and_no_other() -> None:
    text = f"{DECLARATIONS}slow: never v > 2\nlow: never w > 0.5"

    def simulate(given: Mapping[str, Any]) -> Rows:
        return [(0.0, {"v": 0, "w": 0}), (1.0, {"v": given["a"] * 3, "w": 0}), (2.0, {"v": 0, "w": given["b"]})]

    found = ltlc.falsify(text, simulate, ["a=0..0..1", "b=0..0..1"], simulations=50)
    assert found.parameters is not None
    changed = {"slow": {"a"}, "low": {"b"}}[str(found.violated)]
    assert {name for name, value in found.parameters.items() if value != 0} == changed


def test_inputs_change_at_their_control_points_and_are_shrunk_in_time() -> None:
    def simulate(given: Mapping[str, Any]) -> Rows:
        speed, rows = 0.0, []
        for k in range(round(given["seconds"] * 10)):
            push = [value for time, value in given["push"] if time <= k / 10][-1]
            speed += push * 0.1
            rows.append((k / 10, {"v": speed}))
        return rows

    found = ltlc.falsify(SLOW, simulate, inputs=["push=-1..1@5"], seconds=10, simulations=200)
    assert found.violated == "slow"
    assert found.parameters is not None
    assert len(found.parameters["push"]) == 1
    assert found.parameters["seconds"] < 10
    assert ltlc.run(SLOW, simulate(found.parameters)).violations


def test_runs_that_violate_by_their_inputs_are_tried_first() -> None:
    text = f"{DECLARATIONS}handshake: after v > 0.95, after v < 0.02, after v > 0.97, never v < 0.01"

    def simulate(given: Mapping[str, Any]) -> Rows:
        return [
            (k / 10, {"v": [value for time, value in given["v"] if time <= k / 10][-1]})
            for k in range(round(given["seconds"] * 10))
        ]

    found = ltlc.falsify(text, simulate, inputs=["v=0..1@8"], seconds=4, simulations=20)
    assert found.violated == "handshake"
    assert found.document()["found"]["simulation"] == 2


def test_runs_that_violate_by_the_choices_of_an_input_are_tried_first() -> None:
    blinks = "after on, after not on, after on, after not on, after on, after not on, never on"

    def simulate(given: Mapping[str, Any]) -> Rows:
        return [
            (k / 10, {"on": [word for time, word in given["on"] if time <= k / 10][-1] == "true"})
            for k in range(round(given["seconds"] * 10))
        ]

    found = ltlc.falsify(DECLARATIONS + blinks, simulate, inputs=["on=false,true@8"], seconds=4, simulations=2)
    assert found.exit_code == 1
    assert found.document()["found"]["simulation"] == 2


def test_runs_of_signals_that_are_no_inputs_are_no_beginning() -> None:
    found = ltlc.falsify(SLOW, lambda _: constant(v=0), inputs=["push=0..1@8"], seconds=4, simulations=2)
    assert found.exit_code == 0


SPACE = space_of(["a=0..1", "n:int=0..20", "floor=dry,wet,ice"], ["u=-1..1@6"], 10.0)


class Failing:
    """A simulation that fails: `shrink` needs no more of it."""

    def __init__(self, assignment: Assignment) -> None:
        self.assignment = assignment
        self.ended = 4.2


@pytest.mark.parametrize("seed", range(share_of(40)))
def test_what_is_shrunk_still_fails_and_is_no_larger_and_no_step_makes_it_smaller(seed: int) -> None:
    random = Random(seed)
    names = [each.name for each in SPACE.parameters]
    matters = random.sample(names, random.randrange(1, 4))
    begin = SPACE.assignment([random.random() for _ in range(SPACE.dimension)])

    def fails(assignment: Assignment) -> Failing | None:
        near = SPACE.point(assignment) if assignment.seconds == 10 else None
        held = all(_like(assignment.values[name], begin.values[name]) for name in matters)
        return Failing(assignment) if held and near is not None else None

    tried = set()

    def failing(assignments: Iterator[Assignment]) -> Failing | None:
        for each in assignments:
            assert each.key not in tried
            tried.add(each.key)
            if found := fails(each):
                return found
        return None

    shrunk = shrink(Failing(begin), SPACE, failing, tried).assignment
    assert fails(shrunk)
    assert size(shrunk, SPACE) <= size(begin, SPACE)
    smaller = [s for s in simpler(shrunk, SPACE, 4.2) if size(s, SPACE) < size(shrunk, SPACE)]
    assert not any(map(fails, smaller))
    defaults = SPACE.defaults().values
    assert all(shrunk.values[name] == defaults[name] for name in names if name not in matters)


def _like(value: Any, wanted: Any) -> bool:
    """Whether a value is on the same side: words are the same, numbers as large, an input begins so."""
    if isinstance(value, tuple):
        return _like(value[0][1], wanted[0][1])
    if isinstance(value, str):
        return bool(value == wanted)
    return bool(value >= wanted if wanted > 0 else value <= wanted)


def test_every_simpler_assignment_is_one_of_the_space() -> None:
    random = Random(3)
    for _ in range(50):
        begin = SPACE.assignment([random.random() for _ in range(SPACE.dimension)])
        for each in simpler(begin, SPACE, 3.3):
            point = SPACE.point(Assignment(each.values, 10.0))
            assert all(0 <= coordinate <= 1 for coordinate in point)
            course = each.values["u"]
            assert isinstance(course, tuple)
            times = [time for time, _ in course]
            assert times == sorted(set(times))
            assert times[0] == 0
            assert each.seconds is not None
            assert times[-1] < each.seconds


def searched(
    begin: Sequence[Sequence[float]], count: int, seed: int, loss: Callable[[Point, int], Losses]
) -> Iterator[tuple[Point, str | None]]:
    """The points of a search one by one, and what is pursued with each; `loss` says what is found at which of them."""
    search, number = batches([tuple(each) for each in begin], count, seed), 0
    batch = next(search)
    while True:
        losses = []
        for point in batch.points:
            yield point, batch.pursued
            losses.append(loss(point, number))
            number += 1
        batch = search.send(losses)


def taken(losses: Sequence[Losses], count: int) -> list[tuple[Point, str | None]]:
    """So many points if these losses are found in turn, the last one again and again."""
    return list(islice(searched([(0.5, 0.5)], 60, 0, lambda _, number: losses[min(number, len(losses) - 1)]), count))


def test_a_search_begins_where_it_is_told_and_spreads_then() -> None:
    found = [point for point, _ in taken([{"p": 1.0}], 9)]
    assert found[0] == (0.5, 0.5)
    for axis in zip(*found[1:], strict=True):
        assert sorted(int(number * 8) for number in axis) == list(range(8))


def test_the_property_that_is_closest_to_failing_beside_its_usual_margin_is_pursued() -> None:
    near = [{"far": 900.0 + n, "near": 0.5, "none": math.inf} for n in range(7)] + [
        {"far": 1000.0, "near": 0.01, "none": math.inf}
    ]
    found = taken(near, 40)
    assert [name for name, _ in groupby(pursued for _, pursued in found)][:3] == [None, "near", "far"]


def test_properties_take_turns() -> None:
    found = taken([{"p": 1.0, "q": 0.5}], 59)
    pursued = [name for _, name in found if name]
    turns = [(name, len(list(each))) for name, each in groupby(pursued)]
    assert [name for name, _ in turns[:6]] == ["p", "q"] * 3
    assert len({length for _, length in turns[:6]}) == 1


def test_where_nothing_is_measured_points_are_drawn_from_everywhere() -> None:
    found = [point for point, pursued in taken([{"p": math.inf}], 60) if pursued is None]
    assert len(found) == 60
    assert len(set(found)) == 60


def test_a_descent_comes_closer() -> None:
    wanted = (0.7, 0.2, 0.6)
    found = islice(searched([(0.1, 0.9, 0.4)], 120, 1, lambda point, _: {"p": math.dist(point, wanted)}), 120)
    distances = [math.dist(point, wanted) for point, _ in found]
    assert min(distances) < 0.1 < min(distances[:9])


@pytest.mark.parametrize("dimension", [1, 2, 9])
def test_all_points_are_in_the_cube(dimension: int) -> None:
    found = searched([(1.0,) * dimension], 80, 2, lambda point, _: {"p": -sum(point)})
    for point, _ in islice(found, 80):
        assert len(point) == dimension
        assert all(0 <= coordinate <= 1 for coordinate in point)


def test_a_ranking_has_only_what_is_known() -> None:
    assert ranked([search.Tried((0.5,), {"p": math.inf, "q": 2.0})]) == ["q"]


def test_the_default_is_the_middle_or_what_is_written_between() -> None:
    space = space_of(["a=0.2..1.5", "b=0..0.1..2", "n:int=0..5", "m:int=0..5..5", "floor=dry,wet"], [], None)
    assert space.defaults().values == {"a": 0.85, "b": 0.1, "n": 2, "m": 5, "floor": "dry"}


@pytest.mark.parametrize("domain", [Reals(-0.5, 3.0, 1.0), Integers(-3, 9, 0), Choices(("dry", "wet", "ice"))])
def test_every_value_is_reached_and_comes_back_from_its_place(domain: Reals | Integers | Choices) -> None:
    values = [domain.at(k / 1000) for k in range(1001)]
    assert [domain.at(domain.place(value)) for value in values] == values
    if isinstance(domain, Reals):
        assert (values[0], values[-1]) == (domain.low, domain.high)
    else:
        assert len(set(values)) == len(domain)


def test_there_are_as_many_assignments_as_are_counted() -> None:
    space = space_of(["n:int=1..3", "floor=dry,wet"], [], None)
    found = [each.key for each in space.all()]
    assert len(found) == len(set(found)) == space.size == 6


@pytest.mark.parametrize(
    ("parameters", "inputs", "seconds", "reason"),
    [
        ([], [], None, "nothing can be changed: declare a parameter, such as speed=0.2..1.5"),
        (["speed"], [], None, "`speed` declares no parameter: write speed=0.2..1.5"),
        (["speed="], [], None, "`speed` has no range and no choices"),
        (["speed=1"], [], None, "`speed` has no range and no choices"),
        (["speed=1..fast"], [], None, "`fast` in the range of `speed` is not a number"),
        (["speed=1..nan"], [], None, "`nan` in the range of `speed` is not a number"),
        (["speed=2..1"], [], None, "the range of `speed` must go up"),
        (["speed=1..1"], [], None, "the range of `speed` must go up"),
        (["speed=1..5..2"], [], None, "the range of `speed` must go up"),
        (["speed=-1e300..1e300"], [], None, "too narrow or too wide"),
        (["n:int=0..1.5"], [], None, "`1.5` in the range of `n` is not a whole number"),
        (["n:int=5"], [], None, "the range of `n` must go up"),
        (["floor=dry,dry"], [], None, "`floor` has the same choice twice"),
        (["floor=dry,"], [], None, "`floor` has no range and no choices"),
        (["recording=0..1"], [], None, "a parameter cannot be called `recording`"),
        (["a=0..1", "a=0..2"], [], None, "`a` is declared twice"),
        (["a=0..1@3"], [], None, "`a` has control points, so it is an input, not a parameter"),
        ([], ["u=0..1"], 5, "the input `u` needs a number of control points from 1 to 1000: write u=0..1@8"),
        ([], ["u=0..1@0"], 5, "the input `u` needs a number of control points"),
        ([], ["u=0..1@4"], None, "how long a simulation runs is not given"),
        (["a=0..1"], [], 0, "a simulation cannot run for 0 seconds"),
        (["a=0..1"], [], math.nan, "a simulation cannot run for nan seconds"),
    ],
)
def test_a_declaration_that_cannot_be_is_refused_with_what_to_write(
    parameters: list[str], inputs: list[str], seconds: float | None, reason: str
) -> None:
    with pytest.raises(ltlc.UnusableInput) as raised:
        ltlc.falsify(SLOW, lambda _: constant(v=0), parameters, inputs=inputs, seconds=seconds)
    assert reason in str(raised.value)


def test_an_input_has_equally_long_pieces_and_says_only_where_it_changes() -> None:
    space: Space = space_of([], ["u=0..1@4"], 10.0)
    assert space.assignment((0.0, 0.5, 0.5, 1.0)).values["u"] == ((0.0, 0.0), (2.5, 0.5), (7.5, 1.0))
    assert list(islice(space.times(space.parameters[0]), 4)) == [0.0, 2.5, 5.0, 7.5]
    thirds = space_of([], ["u=0..1@3"], 1.0)
    assert thirds.times(thirds.parameters[0]) == [0.0, 0.333333333, 0.666666667]


def test_verdicts_of_all_simulations_are_counted() -> None:
    found = ltlc.falsify(SLOW, lambda given: constant(v=given["gain"]), ["gain=0..1"], simulations=15)
    [slow] = found.document()["properties"]
    assert {name: number for name, number in slow["verdicts"].items() if number} == {
        Verdict.PRESUMABLY_SATISFIED.value: 15
    }
