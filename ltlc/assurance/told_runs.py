"""The runs on which the gate judged a node, as data of JSON: for a test that replays them where it is installed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from ltlc.assurance.messages import Messages
from ltlc.assurance.programs import Monitored
from ltlc.assurance.replay import Expectation
from ltlc.assurance.sources import read, without_news
from ltlc.assurance.traffic import Begun, Event, Heard, Passed, Quiet, Together
from ltlc.assurance.values import Samples
from ltlc.compiler import Compiled
from ltlc.runtime.documents import json_value

MOST_RUNS, MOST_IN_ALL = 20, 2_000
"""How many runs are described for a property, and for all together if that leaves one for each."""


def told_runs(
    compiled: Sequence[Compiled], programs: Sequence[Monitored], messages: Messages
) -> list[list[dict[str, Any]]]:
    """For each property some of its runs, those first that lead to other verdicts than the runs before.

    A run has `rate` in Hz and `timeout` in ns, its `events` (`begun` and `passed` at a time in ns, `heard` with a topic
    and the values of what is read from it, `quiet` up to a time), and what it leads to by definition: `changes` of
    verdict with which moments end, with their times, and the last `verdict`.
    """
    most = max(1, min(MOST_RUNS, MOST_IN_ALL // max(1, len(compiled))))
    return [_told(*each, messages)[:most] for each in zip(compiled, programs, strict=True)]


def _told(compiled: Compiled, program: Monitored, messages: Messages) -> list[dict[str, Any]]:
    samples = Samples(without_news(compiled.specification), read(compiled.specification, messages))
    expectation = Expectation(compiled)
    first: list[dict[str, Any]] = []
    further: list[dict[str, Any]] = []
    seen = set()
    for run in program.runs(compiled, samples):
        shown = list(expectation.of(run))
        changes = [list(change) for each in shown for change in each["settled"]]
        told = {
            "rate": run.settings.rate,
            "timeout": run.settings.timeout,
            "events": [list(_event(program, event)) for event in run.events],
            "changes": changes,
            "verdict": shown[-1]["verdict"],
        }
        history = tuple(verdict for _, verdict in changes)
        (further if history in seen else first).append(told)
        seen.add(history)
    return [*first, *further]


def _event(program: Monitored, event: Event) -> Iterator[Any]:
    match event:
        case Begun(time):
            yield from ("begun", time)
        case Passed(time):
            yield from ("passed", time)
        case Quiet(time):
            yield from ("quiet", time)
        case Together():
            raise TypeError("a node takes messages one by one")
        case Heard(time, said):
            names = program.emitted.on_topic[said.topic]
            values = zip(names, map(_plain, program.read(said)), strict=True)
            yield from ("heard", time, said.topic, {name: json_value(value) for name, value in values})


def _plain(value: Any) -> Any:
    """A value without the types that only messages have."""
    value = value.tolist() if hasattr(value, "tolist") else value
    return tuple(value) if isinstance(value, list) else value
