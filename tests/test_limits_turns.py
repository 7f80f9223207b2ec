"""Jobs in turn: results keep their order, a job beyond its budget is given up, and the others go on."""

from __future__ import annotations

import os
from functools import partial

import pytest

from ltlc.limits.processes import Budget, Exceeded, Limit
from ltlc.limits.turns import JOBS_OF_A_CHILD, run_in_turn

BUDGET = Budget(10.0, 500)
SEVERAL = 3 * JOBS_OF_A_CHILD


def for_ever() -> int:
    while True:
        pass


def fill_memory() -> int:
    return len(bytearray(2**40))


def fail() -> int:
    raise ValueError("this job fails")


def give_up() -> int:
    raise RuntimeError("no answer")


def double(number: int) -> int:
    return 2 * number


def process(_: int) -> int:
    return os.getpid()


def jobs(count: int) -> list[partial[int]]:
    return [partial(double, number) for number in range(count)]


@pytest.mark.parametrize("count", [0, 1, SEVERAL])
def test_results_are_in_the_order_of_the_jobs(count: int) -> None:
    assert run_in_turn(jobs(count), BUDGET, 60.0) == [2 * number for number in range(count)]


def test_jobs_share_children_that_are_not_this_process() -> None:
    pids = run_in_turn([partial(process, number) for number in range(SEVERAL)], BUDGET, 60.0, most_children=2)
    assert len(set(pids)) == 2
    assert os.getpid() not in pids


def test_a_job_that_takes_too_long_is_given_up_and_the_rest_done() -> None:
    outcomes = run_in_turn([*jobs(2), for_ever, *jobs(4)], Budget(0.2, 500), 60.0)
    assert isinstance(outcomes[2], Exceeded)
    assert outcomes[2].limit is Limit.TIME
    assert outcomes[:2] + outcomes[3:] == [0, 2, 0, 2, 4, 6]


def test_a_job_that_needs_too_much_memory_is_given_up() -> None:
    first, second = run_in_turn([fill_memory, partial(double, 1)], BUDGET, 60.0)
    assert isinstance(first, Exceeded)
    assert first.limit is Limit.MEMORY
    assert second == 2


def test_an_engine_that_gives_up_says_why() -> None:
    (outcome,) = run_in_turn([give_up], BUDGET, 60.0)
    assert isinstance(outcome, Exceeded)
    assert "no answer" in str(outcome)


def test_when_the_time_for_all_is_over_the_rest_is_not_begun() -> None:
    outcomes = run_in_turn([for_ever, *jobs(3)], Budget(10.0, 500), 0.3, most_children=1)
    assert all(isinstance(outcome, Exceeded) for outcome in outcomes)


def test_an_exception_of_a_job_is_raised_here_and_no_child_is_left() -> None:
    with pytest.raises(ValueError, match="this job fails"):
        run_in_turn([*jobs(1), fail, *jobs(1)], BUDGET, 60.0)
    with pytest.raises(ChildProcessError):
        os.waitpid(-1, os.WNOHANG)
