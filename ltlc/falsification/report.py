"""What a search found, as text and as a JSON document."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from ltlc.base.provenance import FileDigest, provenance
from ltlc.base.source import Source
from ltlc.falsification.assignment import Assignment, text_of
from ltlc.falsification.falsify import Falsification
from ltlc.falsification.simulation import Simulated
from ltlc.runtime.reports import counted, figure
from ltlc.semantics.verdicts import Verdict


def text(made: Falsification, left_out: Sequence[str] = ()) -> str:
    """What `ltlc falsify` prints, if it was not to search for violations of those that are `left_out`."""
    return "".join(f"{line}\n" for line in _lines(made, left_out))


def simulated_text(simulated: Simulated, what_for: str) -> str:
    """One simulation on a line: what it was given, and what came of it, of the property that it was for first."""
    told = simulated.failure
    if simulated.violated is not None:
        told = f"{simulated.violated.property.label} is violated"
    elif not told:
        known = {label: margin for label, margin in simulated.margins.items() if math.isfinite(margin)}
        first = sorted(known, key=lambda label: (label != what_for, known[label]))
        told = ", ".join(f"{label} {known[label]:.4g}" for label in first[:3]) or "nothing is violated"
    return f"{simulated.number}: {simulated.assignment}: {told}"


def document(
    made: Falsification, source: Source, left_out: Sequence[str] = (), recordings: Sequence[FileDigest] = ()
) -> dict[str, Any]:
    """The JSON document of `ltlc falsify`, with the files of the recording that is kept."""
    return {
        "found": None if made.found is None else _violation(made.found),
        "smallest": None if made.smallest is None else _violation(made.smallest),
        "seed": made.seed,
        "simulations": len(made.simulations),
        "shrinking": made.shrinking,
        "exhaustive": made.exhaustive,
        "interrupted": made.is_interrupted,
        "failed": [_told(each) | {"reason": each.failure} for each in made.failed],
        "properties": [_property(made, label) for label in _labels(made)],
        "not_searched": list(left_out),
        "provenance": provenance([source], recordings),
    }


def _violation(simulated: Simulated) -> dict[str, Any]:
    assert simulated.violated is not None
    return {"property": simulated.violated.property.label, **_told(simulated), "offset": simulated.ended}


def _told(simulated: Simulated) -> dict[str, Any]:
    return {"simulation": simulated.number, "assignment": simulated.assignment.document()}


def _property(made: Falsification, label: str) -> dict[str, Any]:
    closest = _closest(made, label)
    return {
        "label": label,
        "verdicts": {verdict.value: len(_with(made, label, verdict)) for verdict in Verdict},
        "not_measured": made.unmeasured.get(label),
        "not_triggered": sum(label in each.untriggered for each in made.simulations),
        "left_out": [each.number for each in made.simulations if label in each.left_out],
        "closest": None if closest is None else {**_told(closest), "margin": closest.margins[label]},
    }


def _labels(made: Falsification) -> list[str]:
    """Those of all properties; the first simulation has not failed."""
    return list(made.simulations[0].verdicts)


def _with(made: Falsification, label: str, verdict: Verdict) -> list[Simulated]:
    return [each for each in made.simulations if each.verdicts.get(label) is verdict]


def _closest(made: Falsification, label: str) -> Simulated | None:
    """The simulation in which a property came closest to failing; None if that is not known of any."""
    known = [each for each in made.simulations if math.isfinite(each.margins.get(label, math.inf))]
    return min(known, key=lambda each: each.margins[label], default=None)


def _lines(made: Falsification, left_out: Sequence[str]) -> Iterator[str]:
    count = counted(len(made.simulations), "simulation")
    if made.is_interrupted:
        yield "Interrupted: the report is about what was simulated before."
    if made.found is not None:
        yield from _found_lines(made, made.found)
    elif made.exhaustive:
        yield f"No property is violated in any simulation: all {count} were run."
    else:
        yield f"No property is violated in {count} (seed {made.seed}), which proves nothing."
    if made.found is None:
        yield from (f"  {label}: {_state(made, label)}" for label in _labels(made))
        yield from (f"  {label}: not searched" for label in left_out)
    if made.failed:
        first = made.failed[0]
        yield f"{counted(len(made.failed), 'simulation')} failed, the first of them {first.number}: {first.failure}"
        yield f"  {first.assignment}"


def _found_lines(made: Falsification, found: Simulated) -> Iterator[str]:
    violated = found.violated
    assert violated is not None
    label = violated.property.label
    where = "with all defaults" if found.number == 1 else f"in simulation {found.number} (seed {made.seed})"
    yield f"{label} is violated {where}."
    shown = made.smallest
    if shown is None and not made.shrinking:
        yield "It was not simulated again, so it was not shrunk:"
        shown = found
    elif shown is None:
        yield "The same parameters did not violate it again, so they were not shrunk: the simulation is not repeatable."
        shown = found
    else:
        yield f"Shrunk in {counted(made.shrinking, 'more simulation')}:"
    yield from _assigned(made, shown.assignment)
    assert shown.session is not None
    track = next(track for track in shown.session.tracks if track.property.label == label)
    yield ""
    yield figure(shown.session, track).rstrip()


def _assigned(made: Falsification, assignment: Assignment) -> Iterator[str]:
    """A line for each parameter, beside its default."""
    defaults = made.space.defaults()
    width = max(map(len, assignment.values))
    for name, value in assignment.values.items():
        default = defaults.values[name]
        beside = "default" if value == default else f"default {text_of(default)}"
        yield f"  {name:<{width}}  {text_of(value)}  ({beside})"
    if assignment.seconds is not None and assignment.seconds != made.space.seconds:
        yield f"  for {assignment.seconds:g} s instead of {made.space.seconds:g}"


def _state(made: Falsification, label: str) -> str:
    """How a property that was not violated did."""
    told = []
    closest = _closest(made, label)
    if reason := made.unmeasured.get(label):
        told.append(f"not measured, so it did not guide the search: {reason}")
    elif closest is not None:
        told.append(f"{closest.margins[label]:.4g} at least, in simulation {closest.number}: {closest.assignment}")
    else:
        told.append("no comparison of numbers decides it, so it did not guide the search")
    if idle := _with(made, label, Verdict.NOT_STARTED):
        told.append("never started" if len(idle) == len(made.simulations) else f"not started in {len(idle)}")
    if untriggered := [each for each in made.simulations if label in each.untriggered]:
        is_all = len(untriggered) == len(made.simulations)
        told.append("never triggered" if is_all else f"not triggered in {len(untriggered)}")
    if lacking := [each for each in made.simulations if label in each.left_out]:
        number, first = counted(len(lacking), "simulation"), lacking[0]
        told.append(f"steps left out in {number}, as of {first.number}: {first.left_out[label]}")
    if owed := _with(made, label, Verdict.PRESUMABLY_VIOLATED):
        told.append(f"open at the end of {counted(len(owed), 'simulation')}, as of {owed[0].number}")
    return "; ".join(told)
