"""What share of planted faults the tests notice: `python -m benchmarks.planted FOLDER --count 300 --seed 1`.

Each fault is one small change of one room, chosen at random. First the tests that run the changed line run on a copy of
the project that has it, then those of its room, the fastest first, until one fails; a fault that they pass with is a
survivor. Which test runs which line is recorded before (`--record`), in FOLDER, which also keeps a journal: a run that
is ended goes on where it was. Only tests that pass without a fault while that is recorded are asked.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from benchmarks.planted.copies import Copy, Ran, copied, in_child
from benchmarks.planted.faults import Fault, chosen
from benchmarks.planted.recording import Recorded, Recorder, times_of
from benchmarks.planted.rooms import ROOMS, named_for


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="what has been recorded, and the journal")
    parser.add_argument("--record", action="store_true", help="record which tests run which lines, and plant nothing")
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rooms", nargs="+", choices=ROOMS, default=list(ROOMS))
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--tests", nargs="+", help="the files of tests to record (all of the rooms)")
    parser.add_argument(
        "--seconds", type=float, default=20.0, help="of a processor, that the tests of a fault may take"
    )
    options = parser.parse_args()
    folder = options.folder.absolute()
    folder.mkdir(parents=True, exist_ok=True)
    if options.record:
        record(folder, options.tests or sorted({test for room in options.rooms for test in named_for(room)}))
    else:
        plant(folder, chosen(options.rooms, options.count, options.seed), options.jobs, options.seconds)
        print(summary(folder))


def record(folder: Path, names: Sequence[str]) -> None:
    """Record what tests run, file by file, but of those that have been; of one that takes over 90 s, times only."""
    copy = copied(folder / "whole")
    for name in names:
        if not times_of(folder, name).exists():
            ran = in_child(copy, [name], folder / "recording.log", 90, partial(Recorder, folder, name))
            while (outcome := ran.ended()) is None:
                time.sleep(0.1)
            if not times_of(folder, name).stat().st_size:
                times_of(folder, name).unlink()
            print(f"{'passed' if outcome == 'survived' else outcome}  {name}", flush=True)


def plant(folder: Path, faults: Sequence[Fault], jobs: int, seconds: float) -> None:
    """Judge the faults that the journal does not have yet, some at a time, and write each down."""
    recorded = Recorded(folder)
    known = {entry["fault"] for entry in journal(folder)}
    waiting = [fault for fault in dict.fromkeys(faults) if str(fault) not in known]
    if unknown := sorted({fault.room for fault in waiting if not suitable(recorded, fault, seconds)}):
        sys.exit(f"no test has been recorded for {', '.join(unknown)}; see --record")
    free = [copied(folder / f"copy{number}") for number in range(jobs)]
    running: dict[Copy, tuple[Fault, int, Ran]] = {}
    while waiting or running:
        while waiting and free:
            fault, copy = waiting.pop(0), free.pop()
            asked = suitable(recorded, fault, seconds)
            copy.plant(fault.path, fault.text)
            log = folder / f"{copy.folder.name}.log"
            running[copy] = fault, len(asked), in_child(copy, asked, log, 60 + 20 * seconds)
        time.sleep(0.2)
        for copy, (fault, asked_count, ran) in list(running.items()):
            if (outcome := ran.ended()) is not None:
                copy.restore()
                del running[copy]
                free.append(copy)
                write(folder, fault, outcome, asked_count)


def suitable(recorded: Recorded, fault: Fault, seconds: float) -> list[str]:
    """The tests to ask of a fault, in their order: those that run its lines, then those of its room."""
    room = tuple(f"{name}::" for name in named_for(fault.room))
    times = recorded.seconds
    running = sorted(recorded.running(fault.path, fault.lines), key=times.__getitem__)
    others = sorted((test for test in times if test.startswith(room)), key=times.__getitem__)
    found: list[str] = []
    for test in dict.fromkeys([*running, *others]):
        if times[test] <= seconds or not found:
            found.append(test)
            seconds -= times[test]
    return found


def write(folder: Path, fault: Fault, outcome: str, asked: int) -> None:
    entry = {"room": fault.room, "fault": str(fault), "outcome": outcome, "asked": asked}
    with (folder / "journal.jsonl").open("a", encoding="utf-8") as file:
        print(json.dumps(entry), file=file)
    print(f"{outcome:50} {fault}", flush=True)


def journal(folder: Path) -> list[dict[str, str]]:
    try:
        return [json.loads(line) for line in (folder / "journal.jsonl").read_text(encoding="utf-8").splitlines()]
    except FileNotFoundError:
        return []


def summary(folder: Path) -> str:
    """By room, how many faults were planted and killed; then the survivors."""
    entries = journal(folder)
    planted = Counter(entry["room"] for entry in entries)
    survivors = [entry for entry in entries if entry["outcome"] == "survived"]
    alive = Counter(entry["room"] for entry in survivors)
    rows = [f"| {room} | {planted[room]} | {planted[room] - alive[room]} |" for room in sorted(planted)]
    head = ["| room | planted | killed |", "|---|---|---|"]
    total = f"| all | {planted.total()} | {planted.total() - alive.total()} |"
    return "\n".join([*head, *rows, total, *(f"survived: {entry['fault']}" for entry in survivors)])


if __name__ == "__main__":
    main()
