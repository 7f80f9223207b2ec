"""Jobs in children: their results, and what becomes of those that take too much."""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NoReturn

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ltlc.automata import (
    Budget,
    Exceeded,
    Limit,
    Task,
    batch,
    spot_translation,
    translate,
    translate_all,
    translate_by_progression,
)
from ltlc.base.limits import UNBOUNDED, children, in_order, run_all, run_each
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.ltl import And, Atom, Formula, Next, Not, Or, Until, atoms, eventually, globally, implies
from ltlc.semantics.timed_atoms import BEGINNING, late

pytestmark = pytest.mark.live

A, B = Atom("a"), Atom("b")
AMPLE = Budget(60)
BRIEF = Budget(0.5, 500)


def task(formula: Formula) -> Task:
    return Task(formula, Alphabet(atoms(formula)))


def nested_next(depth: int) -> Formula:
    formula: Formula = A
    for _ in range(depth):
        formula = Next(formula)
    return formula


def bounded_response(steps: int) -> Formula:
    """`G(a -> b within steps)`, unrolled: Spot takes very long over it."""
    within: Formula = B
    for _ in range(steps):
        within = Or(B, Next(within))
    return globally(implies(A, within))


def limit_of(job: Callable[[], Any], budget: Budget) -> Limit:
    [outcome] = run_all([job], budget)
    assert isinstance(outcome, Exceeded)
    assert outcome.budget == budget
    return outcome.limit


def loop() -> None:
    while True:
        pass


def wait_for_ever() -> None:
    threading.Event().wait()


def overflow_spots_stack() -> None:
    from ltlc.automata.engine import spot

    formula = spot.formula.ap("a")
    for _ in range(200_000):
        formula = spot.formula.X(formula)
    spot.translator(spot.make_bdd_dict()).run(formula)


def fail_as_spot_does() -> NoReturn:
    raise RuntimeError("Too many acceptance sets used.")


def refuse() -> None:
    raise ValueError("not in the alphabet: b")


def test_results_come_in_the_order_of_the_jobs() -> None:
    assert run_all([partial(pow, 2, k) for k in range(7)], AMPLE) == [1, 2, 4, 8, 16, 32, 64]


def test_no_jobs_have_no_results() -> None:
    assert run_all([], AMPLE) == []


def test_results_larger_than_a_pipe_arrive() -> None:
    assert run_all([lambda: bytes(3_000_000), lambda: b"small"], AMPLE) == [bytes(3_000_000), b"small"]


def test_jobs_share_children_that_are_not_this_process() -> None:
    of_jobs = run_all([os.getpid] * 50, AMPLE)
    assert len(set(of_jobs)) < len(of_jobs)
    assert os.getpid() not in of_jobs


def test_long_jobs_run_side_by_side(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(children, "_cpus", lambda: 2)
    reading, writing = os.pipe()
    with os.fdopen(reading), os.fdopen(writing, "w"):
        # Each needs the other: the first waits for what the second writes.
        both = run_all([lambda: os.read(reading, 1), lambda: os.write(writing, b"!")], Budget(30))
    assert both == [b"!", 1]


def test_a_job_may_run_in_a_thread_of_the_parent() -> None:
    results: list[object] = []
    thread = threading.Thread(target=lambda: results.extend(run_all([lambda: 1], AMPLE)))
    thread.start()
    thread.join()
    assert results == [1]


@pytest.mark.parametrize("job", [loop, wait_for_ever, partial(translate, bounded_response(40), Alphabet(("a", "b")))])
def test_what_takes_too_long_is_stopped(job: Callable[[], Any]) -> None:
    assert limit_of(job, Budget(0.2)) is Limit.TIME


@pytest.mark.parametrize("job", [loop, overflow_spots_stack, lambda: bytearray(2**40), fail_as_spot_does])
def test_a_job_beyond_its_budget_is_given_up_and_the_rest_done(job: Callable[[], Any]) -> None:
    powers: list[Callable[[], Any]] = [partial(pow, 2, k) for k in range(4)]
    outcomes = run_all([*powers, job, *powers], BRIEF)
    assert isinstance(outcomes.pop(4), Exceeded)
    assert outcomes == [1, 2, 4, 8, 1, 2, 4, 8]


def test_when_the_time_for_all_is_over_the_rest_is_not_begun(tmp_path: Path) -> None:
    outcomes = run_all([*[loop] * 50, (tmp_path / "begun").touch], AMPLE, 0.3)
    assert all(isinstance(outcome, Exceeded) and outcome.limit is Limit.TIME for outcome in outcomes)
    assert not (tmp_path / "begun").exists()


def test_who_watches_is_told_how_many_jobs_are_done() -> None:
    told: list[tuple[int, int]] = []
    run_all([partial(pow, 2, k) for k in range(7)], AMPLE, watch=lambda done, of: told.append((done, of)))
    assert told == sorted(told)
    assert told[-1] == (7, 7)


def test_who_watches_is_told_while_a_job_takes_long() -> None:
    told: list[tuple[int, int]] = []
    run_all([wait_for_ever], Budget(1.0), watch=lambda done, of: told.append((done, of)))
    assert told.count((0, 1)) > 1


def test_what_needs_too_much_memory_is_stopped() -> None:
    assert limit_of(lambda: bytearray(300 * 2**20), Budget(60, 100)) is Limit.MEMORY


def test_memory_that_jobs_before_have_kept_does_not_count() -> None:
    kept: list[bytearray] = []

    def keep() -> int:
        kept.append(bytearray(30 * 2**20))
        return len(kept)

    assert not any(isinstance(outcome, Exceeded) for outcome in run_all([keep] * 10, Budget(60, 40)))


def test_memory_that_the_parent_has_does_not_count() -> None:
    ballast = bytearray(50 * 2**20)
    assert run_all([lambda: len(bytearray(10 * 2**20))], Budget(60, 40)) == [10 * 2**20]
    assert ballast


def test_spot_running_out_of_memory_is_the_limit_of_memory() -> None:
    assert limit_of(partial(translate, bounded_response(40), Alphabet(("a", "b"))), Budget(60, 15)) is Limit.MEMORY


def test_spot_running_out_of_stack_is_nesting() -> None:
    assert limit_of(overflow_spots_stack, Budget(60, 4096)) is Limit.NESTING


def test_what_spot_refuses_is_a_limit_of_the_engine_in_its_own_words() -> None:
    [outcome] = run_all([fail_as_spot_does], AMPLE)
    assert str(outcome) == "is beyond the automata library: Too many acceptance sets used."


def test_a_child_that_is_killed_is_reported() -> None:
    assert limit_of(lambda: os.kill(os.getpid(), signal.SIGKILL), AMPLE) is Limit.ENGINE


def test_other_exceptions_are_raised_in_the_parent() -> None:
    with pytest.raises(ValueError, match="not in the alphabet: b"):
        run_all([refuse], AMPLE)
    with pytest.raises(ChildProcessError):
        os.waitpid(-1, os.WNOHANG)


def test_a_result_that_cannot_be_sent_is_an_error_here() -> None:
    with pytest.raises((AttributeError, TypeError, pickle.PicklingError)):
        run_all([threading.Lock], AMPLE)


INTERRUPTED = """
import os, pathlib, signal, sys, threading
from ltlc.base.limits import Budget, run_all

signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell lets what it runs in the background ignore it

def interrupt_parent():
    pathlib.Path(sys.argv[1]).write_text(str(os.getpid()))
    os.kill(os.getppid(), signal.SIGINT)
    threading.Event().wait()

try:
    run_all([interrupt_parent, lambda: threading.Event().wait()], Budget(60))
except KeyboardInterrupt:
    sys.exit(7)
"""


def test_an_interrupt_leaves_no_child(tmp_path: Path) -> None:
    note = tmp_path / "pid"
    # In a process with one thread, as `ltlc` has: a second one, such as a test runner's, takes signals at any time.
    done = subprocess.run([sys.executable, "-c", INTERRUPTED, str(note)], timeout=60, check=False)
    assert done.returncode == 7
    with pytest.raises(ProcessLookupError):
        os.kill(int(note.read_text()), 0)


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux ends a process with its parent")
def test_a_child_that_is_killed_leaves_none_of_its_own_behind() -> None:
    def orphan_itself() -> None:
        os.kill(os.getppid(), signal.SIGKILL)
        threading.Event().wait()

    outcomes: list[object] = []
    job = partial(run_all, [orphan_itself], AMPLE)
    # As long as the child of the child lives, it keeps the pipe open on which the answer was to come.
    waiting = threading.Thread(target=lambda: outcomes.extend(run_all([job], AMPLE)))
    waiting.start()
    waiting.join(AMPLE.seconds / 2)
    assert [type(outcome) for outcome in outcomes] == [Exceeded]


@pytest.mark.parametrize(("seconds", "megabytes"), [(0, 10), (-1, 10), (1, 0)])
def test_a_budget_of_nothing_is_refused(seconds: float, megabytes: int) -> None:
    with pytest.raises(ValueError, match="positive"):
        Budget(seconds, megabytes)


def test_translations_in_children_are_those_made_here() -> None:
    tasks = [task(eventually(A)), task(globally(implies(A, eventually(B)))), task(Until(B, A))]
    assert translate_all(tasks, AMPLE) == [translate(t.formula, t.alphabet) for t in tasks]


def test_one_task_that_exceeds_its_budget_leaves_the_others_alone() -> None:
    first, second, third = translate_all([task(A), task(nested_next(200_000)), task(B)], AMPLE)
    assert (first, third) == (translate(A, Alphabet(("a",))), translate(B, Alphabet(("b",))))
    assert isinstance(second, Exceeded)


def test_what_takes_too_long_says_how_long_it_had() -> None:
    assert str(Exceeded(Limit.TIME, Budget(0.5))) == "takes longer than 0.5 s"


def test_formulas_nested_beyond_pythons_own_limit_are_translated() -> None:
    [monitor] = translate_all([task(nested_next(400))], AMPLE)
    assert not isinstance(monitor, Exceeded)
    assert len(monitor.verdicts) == 403


def test_formulas_nested_too_deeply_exceed_a_limit_and_crash_nothing() -> None:
    [outcome] = translate_all([task(nested_next(200_000))], AMPLE)
    assert isinstance(outcome, Exceeded)
    assert outcome.limit is Limit.NESTING
    assert str(outcome) == "is nested too deeply"


def test_what_spot_cannot_do_is_done_by_progression(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(spot_translation, "translate", lambda formula, alphabet: fail_as_spot_does())
    response = task(globally(implies(A, eventually(B))))
    assert translate_all([response], AMPLE) == [translate_by_progression(response.formula, response.alphabet)]


def test_tasks_that_differ_in_names_only_are_translated_once(monkeypatch: pytest.MonkeyPatch) -> None:
    counted: list[int] = []

    def counting(jobs: list[Callable[[], Any]], *arguments: Any, **others: Any) -> list[Any]:
        counted.append(len(jobs))
        return run_all(jobs, *arguments, **others)

    monkeypatch.setattr(batch, "run_all", counting)
    tasks = [task(Until(A, B)), task(Until(B, A)), task(Until(Atom("x"), Atom("y"))), task(Until(A, A))]
    monitors = translate_all(tasks, AMPLE)
    assert counted == [2, 0]
    assert monitors == [translate(t.formula, t.alphabet) for t in tasks]


def test_tasks_over_different_letters_are_translated_apart() -> None:
    formula = eventually(And(A, B))
    exclusive = Alphabet(("a", "b"), (Group(("a", "b"), (frozenset("a"), frozenset("b"))),))
    tasks = [Task(formula, Alphabet(("a", "b"))), Task(formula, exclusive), Task(formula, Alphabet(("b", "a")))]
    assert translate_all(tasks, AMPLE) == [translate(t.formula, t.alphabet) for t in tasks]


def test_a_mistake_in_a_task_is_raised_before_any_child_starts() -> None:
    with pytest.raises(ValueError, match="not in the alphabet: b"):
        translate_all([Task(And(A, B), Alphabet(("a",)))], AMPLE)


def test_what_has_one_bound_is_translated_once_whatever_the_bound_is(monkeypatch: pytest.MonkeyPatch) -> None:
    def owed(bound: int) -> Task:
        over = late(BEGINNING, bound)
        return Task(Until(Not(over), And(Not(over), A)), Alphabet(("a",)))

    known: dict[Any, Any] = {}
    tasks = [owed(bound) for bound in (2, 3, 10**9)]
    assert translate_all(tasks, AMPLE, known=known) == [translate(t.formula, t.alphabet) for t in tasks]
    assert len(known) == 1
    monkeypatch.setattr(batch, "_translate_each", lambda tasks, **_: [fail_as_spot_does() for _ in tasks])
    assert translate_all([owed(7)], AMPLE, known=known) == [translate(owed(7).formula, owed(7).alphabet)]


@pytest.mark.parametrize("workers", [1, 2, 3])
def test_results_come_from_so_many_workers_as_they_get_ready(workers: int, tmp_path: Path) -> None:
    def meet(number: int) -> int:
        (tmp_path / str(number)).touch()
        while len(list(tmp_path.iterdir())) < workers:
            pass
        return os.getpid()

    outcomes = dict(run_each([partial(meet, number) for number in range(6)], UNBOUNDED, workers))
    assert sorted(outcomes) == list(range(6))
    assert len(set(outcomes.values())) == workers


def test_a_job_that_kills_its_process_is_told_and_the_others_are_done() -> None:
    def job(number: int) -> int:
        if number == 1:
            os.kill(os.getpid(), signal.SIGKILL)
        return number

    outcomes = dict(run_each([partial(job, number) for number in range(4)], UNBOUNDED, 2))
    killed = outcomes.pop(1)
    assert isinstance(killed, Exceeded)
    assert killed.reason == "its process ended with signal 9"
    assert outcomes == {0: 0, 2: 2, 3: 3}


@given(st.permutations(range(6)))
def test_results_are_given_in_the_order_of_their_numbers_whenever_they_arrive(order: Sequence[int]) -> None:
    assert list(in_order((number, str(number)) for number in order)) == list("012345")
