"""Where a search begins: the runs with which `ltlc explain` shows how a property is violated, as inputs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, assert_never

from ltlc.analysis.analyse import study_of
from ltlc.analysis.examples import Example
from ltlc.analysis.explanation import CAPTIONS, explain
from ltlc.base.limits import Budget
from ltlc.falsification.assignment import Assignment, Course, Scalar, merged
from ltlc.falsification.parameters import Choices, Domain, Integers, Parameter, Reals, Space
from ltlc.semantics.encodings import Encoding
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.specification import Specification


def examples(specification: Specification, encoding: Encoding, space: Space, budget: Budget) -> list[Assignment]:
    """An assignment for each property with a run that violates it by values of inputs, which are called as signals are.

    They are found within `budget`; fewer, if it does not suffice. Raises SpotMissing.
    """
    if not any(each.points for each in space.parameters):
        return []
    explained = explain(study_of(specification, encoding, budget), budget)
    runs = [run for each in explained for run in each.examples if run.caption == CAPTIONS[Verdict.VIOLATED]]
    return list(filter(None, (_assignment(run, space) for run in runs)))


def _assignment(run: Example, space: Space) -> Assignment | None:
    """The defaults with the inputs that are signals of `run`; None if there are none."""
    courses = {each.name: _course(run, each, space) for each in space.parameters if each.name in run.signals}
    found = {name: course for name, course in courses.items() if course}
    defaults = space.defaults()
    return replace(defaults, values={**defaults.values, **found}) if found else None


def _course(run: Example, input_: Parameter, space: Space) -> Course:
    """The values of a signal, spread over the control points of an input; none if one of them is none of its values."""
    values = [_nearest(step[run.signals.index(input_.name)], input_.domain) for step in run.steps]
    known = [value for value in values if value is not None]
    if not input_.points or len(known) < len(values):
        return ()
    times: Sequence[float] = space.times(input_)
    return merged(tuple((time, known[n * len(known) // len(times)]) for n, time in enumerate(times)))


def _nearest(value: Any, domain: Domain) -> Scalar | None:
    """The value of `domain` that is nearest to one of a run; None if there is none."""
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    match domain:
        case Reals(low, high):
            return min(max(float(value), low), high) if is_number else None
        case Integers(low, high):
            return round(min(max(value, low), high)) if is_number else None
        case Choices(words):
            word = str(value).lower() if isinstance(value, bool) else str(value)
            return word if word in words else None
        case _:
            assert_never(domain)
