"""Small changes to what runs: whoever compares it with its monitor has to notice."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from mutants import VERDICTS, set_at

from ltlc.semantics.control import Base, Control, Outcome, Setting


def control_mutants(control: Control) -> Iterator[Control]:
    """Every control with one verdict, way, outcome or due time changed."""
    yield from _changed_stances(control)
    for number, branch in enumerate(control.branches):
        swapped = branch._replace(if_so=branch.if_not, if_not=branch.if_so)
        yield replace(control, branches=set_at(control.branches, number, swapped))
    for number, outcome in enumerate(control.outcomes):
        for changed in _changed_outcomes(outcome, len(control.stances)):
            yield replace(control, outcomes=set_at(control.outcomes, number, changed))
    for clock, first in enumerate(control.first_due):
        yield replace(control, first_due=set_at(control.first_due, clock, 1 if first is None else first + 1))


def _changed_stances(control: Control) -> Iterator[Control]:
    for number, stance in enumerate(control.stances):
        changed = [stance._replace(verdict=verdict) for verdict in VERDICTS if verdict is not stance.verdict]
        changed += [stance._replace(step=way) for way in range(len(control.outcomes)) if way != stance.step]
        if control.first_due:
            ways = [None, *range(len(control.outcomes))]
            changed += [stance._replace(clock_step=way) for way in ways if way != stance.clock_step]
        for other in changed:
            yield replace(control, stances=set_at(control.stances, number, other))


def _changed_outcomes(outcome: Outcome, states: int) -> Iterator[Outcome]:
    for state in range(states):
        if state != outcome.state:
            yield outcome._replace(state=state)
    yield outcome._replace(again=not outcome.again)
    for number, setting in enumerate(outcome.settings):
        yield outcome._replace(settings=(*outcome.settings[:number], *outcome.settings[number + 1 :]))
        for changed in _changed_settings(setting):
            yield outcome._replace(settings=set_at(outcome.settings, number, changed))


def _changed_settings(setting: Setting) -> Iterator[Setting]:
    for base in Base:
        if base is not setting.base:
            yield setting._replace(base=base, duration=0 if base is Base.NEVER else setting.duration)
    if setting.base is not Base.NEVER:
        yield setting._replace(duration=setting.duration + 1)
