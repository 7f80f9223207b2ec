"""Many recordings: one worker and two, on this machine and of Dask, and one of them killed while it judges.

    python -m benchmarks.campaign [--recordings 1000] [--rows 500] [--rounds 3] [--engine]

Recordings are CSV files of one drive each; their verdicts differ. Each round judges all of them with one worker and
with two, one after the other, and keeps the results in a table. The rate is that between the first outcome and the
last, so that starting is apart. `busy` is what share of that time the workers spent in judging: on a machine that
others load, too, two workers are slower for that alone, and busy of two by busy of one is what is lost between the
processes. `CPU` is that of all processes, starting included. Verdicts have to be the same each time, and those with a
worker killed, too.
"""

from __future__ import annotations

import argparse
import os
import random
import resource
import signal
import statistics
import tempfile
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from time import perf_counter

import psutil

from ltlc.automata import Budget
from ltlc.base.source import Source
from ltlc.compiler import compile_specification
from ltlc.frontend.language import load_text
from ltlc.monitoring.campaigns.campaign import Workers, judge_all, on_this_machine
from ltlc.monitoring.campaigns.engine import on_engine
from ltlc.monitoring.campaigns.outcomes import Outcome
from ltlc.monitoring.campaigns.places import Location, find
from ltlc.monitoring.campaigns.results import Results
from ltlc.monitoring.judging.run import Judge
from ltlc.semantics.encodings import EPISODE

PROPERTIES = """
decl distance /distance std_msgs/Float64.data
decl speed /speed std_msgs/Float64.data
decl battery /battery std_msgs/Float64.data
absence: never speed > 2
response: always (distance < 1 implies eventually speed < 0.1)
stop: after_until distance < 1, distance > 1, eventually speed < 0.1
low: after battery < 0.5, never speed > 2
existence: eventually battery < 0.01
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--recordings", type=int, default=1000)
    parser.add_argument("--rows", type=int, default=500)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--engine", action="store_true", help="Dask's workers, too")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="ltlc-campaign-") as folder:
        drives = Path(folder) / "drives"
        drives.mkdir()
        for number in range(options.recordings):
            write_drive(drives / f"{number:05}.csv", number, options.rows)
        places = find([str(drives)]).places
        measure("children", lambda jobs: nullcontext(on_this_machine(jobs)), places, options.rounds)
        if options.engine:
            measure("Dask", lambda jobs: on_engine("local", jobs), places, options.rounds)


def write_drive(path: Path, seed: int, rows: int) -> None:
    """A drive of 100 Hz: a distance that comes and goes, a speed, a battery that runs low."""
    chance = random.Random(seed)
    distance, lines = chance.uniform(0, 10), ["time,distance,speed,battery"]
    for row in range(rows):
        distance = abs(distance + chance.uniform(-0.3, 0.3))
        speed = 0.05 if chance.random() < 0.02 else chance.uniform(0.1, 2.0008)
        lines.append(f"{row / 100},{distance:.6f},{speed:.6f},{1 - row / rows / chance.uniform(1, 1.1):.6f}")
    path.write_text("\n".join(lines) + "\n")


def judge() -> Judge:
    specification, _ = load_text(Source("props.txt", PROPERTIES))
    assert specification is not None
    compiled, problems = compile_specification(specification, EPISODE, Budget())
    assert not problems
    return Judge(compiled, specification)


MakesWorkers = Callable[[int], AbstractContextManager[Workers]]


def measure(name: str, workers: MakesWorkers, places: list[Location], rounds: int) -> None:
    starts: dict[int, list[float]] = {1: [], 2: []}
    rates: dict[int, list[float]] = {1: [], 2: []}
    shares: dict[int, list[float]] = {1: [], 2: []}
    used: dict[int, list[float]] = {1: [], 2: []}
    verdicts = None
    for _ in range(rounds):
        for jobs in (1, 2):
            before = cpu()
            start, rate, outcomes = timed(workers, jobs, places)
            used[jobs].append((cpu() - before) / len(outcomes) * 1000)
            starts[jobs].append(start)
            rates[jobs].append(rate)
            shares[jobs].append(sum(each.seconds for each in outcomes) * rate / len(outcomes) / jobs)
            verdicts = verdicts or verdicts_of(outcomes)
            assert verdicts_of(outcomes) == verdicts
    efficiency = statistics.median(two / one / 2 for one, two in zip(rates[1], rates[2], strict=True))
    between = statistics.median(two / one for one, two in zip(shares[1], shares[2], strict=True))
    for jobs in (1, 2):
        start, rate, busy, each = (statistics.median(each[jobs]) for each in (starts, rates, shares, used))
        told = f"{rate:.0f} recordings/s, busy {busy:.2f}, CPU {each:.1f} ms each"
        print(f"{name}, {jobs}: first outcome after {start:.2f} s, {told}")
    told = f"{efficiency:.2f} of two times one by rates, {between:.2f} by busy"
    print(f"{name}: two are {told}; medians of {rounds} pairs", flush=True)
    start, rate, outcomes = timed(workers, 2, places, kill_after=len(places) // 3)
    assert verdicts_of(outcomes) == verdicts
    again = sum(outcome.tries > 1 for outcome in outcomes)
    print(f"{name}, 2 workers, one killed: {rate:.0f} recordings a second, {again} tried again, all verdicts the same")


def cpu() -> float:
    """Seconds of CPU that this process and those that it has started and ended have used."""
    both = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(used.ru_utime + used.ru_stime for used in both)


def timed(
    workers: MakesWorkers, jobs: int, places: list[Location], kill_after: int = -1
) -> tuple[float, float, list[Outcome]]:
    """When the first outcome came, in s, and how many a second from then on; they are kept in a table as they come."""
    begin = perf_counter()
    with (
        tempfile.TemporaryDirectory() as folder,
        Results(Path(folder) / "r.parquet", "", places) as results,
        workers(jobs) as these,
    ):
        arriving = arrivals(judge_all(judge(), places, these), results, kill_after)
        moments, outcomes = zip(*arriving, strict=True)
    return moments[0] - begin, (len(moments) - 1) / (moments[-1] - moments[0]), list(outcomes)


def arrivals(outcomes: Iterator[Outcome], results: Results, kill_after: int) -> Iterator[tuple[float, Outcome]]:
    for number, outcome in enumerate(outcomes):
        results.add(outcome)
        if number == kill_after:
            kill_a_worker()
        yield perf_counter(), outcome


def kill_a_worker() -> None:
    """End the one of the processes below this one that has worked most."""
    below = psutil.Process().children(recursive=True)
    os.kill(max(below, key=lambda process: process.cpu_times().user).pid, signal.SIGKILL)


def verdicts_of(outcomes: list[Outcome]) -> dict[str, list[str]]:
    return {outcome.place.name: [each.sentence for each in outcome.properties] for outcome in outcomes}


if __name__ == "__main__":
    main()
