"""Ways to make a monitor on a corpus, laid out: a line for each way, and the formulas that were too much for it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from statistics import median
from typing import Any

from ltlc.analysis.comparison.constructors import CONSTRUCTORS, Built, Constructor, Trial, sizes
from ltlc.analysis.comparison.tables import Block, Heading, Paragraph, Table, count
from ltlc.base.limits import Exceeded


def document(corpus: str, trials: Sequence[Trial]) -> dict[str, Any]:
    """The JSON document of `ltlc compare --corpus`: a summary for each constructor, and every result."""
    return {
        "corpus": corpus,
        "constructors": [_summary(constructor, trials) for constructor in _present(trials)],
        "formulas": [
            {"name": trial.name, "formula": str(trial.formula), "results": list(_results(trial))} for trial in trials
        ],
    }


def rows_of(trials: Sequence[Trial]) -> list[dict[str, Any]]:
    """A row for each formula and constructor, as a data frame or CSV has it."""
    return [
        {"name": trial.name, "formula": str(trial.formula), **result} for trial in trials for result in _results(trial)
    ]


def _present(trials: Sequence[Trial]) -> list[Constructor]:
    """The constructors that were tried."""
    return [c for c in CONSTRUCTORS if any(c.name in trial.outcomes for trial in trials)]


def _results(trial: Trial) -> Iterator[dict[str, Any]]:
    for name, outcome in trial.outcomes.items():
        states, edges = sizes(outcome.monitor) if isinstance(outcome, Built) else (None, None)
        yield {
            "constructor": name,
            "seconds": outcome.seconds if isinstance(outcome, Built) else None,
            "states": states,
            "edges": edges,
            "agrees": trial.agrees.get(name),
            "limit": outcome.limit.value if isinstance(outcome, Exceeded) else None,
        }


def _summary(constructor: Constructor, trials: Sequence[Trial]) -> dict[str, Any]:
    outcomes = [trial.outcomes[constructor.name] for trial in trials]
    built = [outcome for outcome in outcomes if isinstance(outcome, Built)]
    seconds = sorted(each.seconds for each in built)
    measured = [sizes(each.monitor) for each in built]
    agreements = [trial.agrees[constructor.name] for trial in trials if constructor.name in trial.agrees]
    return {
        "name": constructor.name,
        "description": constructor.description,
        "formulas": len(outcomes),
        "built": len(built),
        "median_seconds": median(seconds) if seconds else None,
        "largest_seconds": max(seconds, default=None),
        "total_seconds": sum(seconds),
        "states": sum(states for states, _ in measured),
        "largest_states": max((states for states, _ in measured), default=None),
        "edges": sum(edges for _, edges in measured),
        "compared": len(agreements),
        "agree": sum(agreements),
    }


def blocks_of(corpus: str, trials: Sequence[Trial]) -> Iterator[Block]:
    """What is to be shown of `trials` on `corpus`."""
    yield Heading(1, f"{corpus}: {count(len(trials), 'formula')}")
    summaries = [_summary(constructor, trials) for constructor in _present(trials)]
    head = ("constructor", "built", "median", "largest", "total", "states", "most states", "edges", "agree", "which is")
    yield Table(head, tuple(_summary_row(summary) for summary in summaries))
    yield from _list(
        "Beyond the limits of", ((t, n) for t in trials for n, o in t.outcomes.items() if isinstance(o, Exceeded))
    )
    yield from _list("Different by", ((t, n) for t in trials for n, agrees in t.agrees.items() if not agrees))


def _summary_row(summary: dict[str, Any]) -> tuple[str, ...]:
    return (
        summary["name"],
        f"{summary['built']} of {summary['formulas']}",
        _milliseconds(summary["median_seconds"]),
        _milliseconds(summary["largest_seconds"]),
        f"{summary['total_seconds']:.2f} s",
        f"{summary['states']:,}",
        "" if summary["largest_states"] is None else f"{summary['largest_states']:,}",
        f"{summary['edges']:,}",
        f"{summary['agree']} of {summary['compared']}" if summary["compared"] else "",
        summary["description"],
    )


def _milliseconds(seconds: float | None) -> str:
    return "" if seconds is None else f"{seconds * 1000:.1f} ms"


def _list(caption: str, found: Iterator[tuple[Trial, str]]) -> Iterator[Block]:
    """For each constructor, the formulas for which it is listed."""
    names: dict[str, list[str]] = {}
    for trial, constructor in found:
        names.setdefault(constructor, []).append(trial.name)
    for constructor, formulas in names.items():
        yield Paragraph(f"{caption} {constructor}: {', '.join(formulas)}")
