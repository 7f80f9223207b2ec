"""Judges many recordings side by side; one that takes its process down, or cannot be fetched, is tried again."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Protocol

from ltlc.base.diagnostics import Diagnostic
from ltlc.base.limits import UNBOUNDED, Exceeded, run_each
from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.ahead import one_thread
from ltlc.monitoring.campaigns.outcomes import Outcome, lost, not_judged, of_report
from ltlc.monitoring.campaigns.places import Location
from ltlc.monitoring.campaigns.storage import StorageError, fetched
from ltlc.monitoring.judging.run import Judge, RunReport, Watcher

TRIES = 3
"""How often a recording is begun that ends its process or cannot be fetched."""


@dataclass(frozen=True, slots=True)
class Failure:
    """A recording was not judged to its end, for this `reason`; `told` is the report if retries fail, too."""

    reason: str
    told: Diagnostic | None = None


Workers = Callable[[Judge, Sequence[Location]], Iterator[tuple[int, Outcome | Failure]]]
"""Judge places, in any order: the number of each with what has come of it. What they do ends with the iterator."""


def judge_all(judge: Judge, places: Sequence[Location], workers: Workers) -> Iterator[Outcome]:
    """What each of the recordings at `places` shows, in the order in which they get ready."""
    judge.prepare()
    waiting = list(places)
    failures: dict[Location, Failure] = {}
    for tries in range(1, TRIES + 1):
        failures = dict.fromkeys(waiting, Failure("no result"))
        for number, found in workers(judge, waiting) if waiting else ():
            if isinstance(found, Failure):
                failures[waiting[number]] = found
            else:
                del failures[waiting[number]]
                yield replace(found, tries=tries)
        waiting = list(failures)
    for place, failure in failures.items():
        told = failure.told
        yield lost(place, failure.reason, TRIES) if told is None else replace(not_judged(place, told), tries=TRIES)


class Judging(Protocol):
    """What judges as `Judge` does."""

    def judge(self, path: Path, watchers: Sequence[Watcher], name: str) -> RunReport:
        """What the recording at `path` shows, which has this name among others."""
        ...


def judge_one(judge: Judging, place: Location) -> Outcome | Failure:
    """What the recording at `place` shows, of which a copy is read if it is elsewhere."""
    start = perf_counter()
    try:
        with fetched(place.name) as path:
            found = judge.judge(path, (), place.name)
            return of_report(place, found, perf_counter() - start)
    except StorageError as error:
        return Failure(str(error), error.diagnostic)
    except Exception as error:
        return Failure(f"{type(error).__name__}: {error}")


def judge_beside_others(judging: Judging, place: Location) -> Outcome | Failure:
    """As `judge_one`, in a process that is one of several."""
    with one_thread():
        return judge_one(judging, place)


def here(judging: Judging) -> Workers:
    """No workers: recordings are judged by `judging` in this process, one after the other."""
    return lambda _, places: ((number, judge_one(judging, place)) for number, place in enumerate(places))


def on_this_machine(jobs: int | None) -> Workers:
    """Workers that are children of this process, as many as `jobs` (None: one for each CPU).

    A child that ends by itself takes one recording with it, and another takes its place. Children have the monitors
    from the parent, and nothing is loaded anew.
    """

    def work(judge: Judge, places: Sequence[Location]) -> Iterator[tuple[int, Outcome | Failure]]:
        for number, found in run_each(
            [partial(judge_beside_others, judge, place) for place in places], UNBOUNDED, jobs
        ):
            yield number, Failure(_end_of(found)) if isinstance(found, Exceeded) else found

    return work


def _end_of(found: Exceeded) -> str:
    return found.detail or "its process ran out of memory or crashed"
