"""Small changes to what runs: whoever compares it with its monitor has to notice."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from mutants import VERDICTS, set_at

from ltlc.semantics.control import Control


def control_mutants(control: Control) -> Iterator[Control]:
    """Every control with one verdict, one way, or one outcome changed."""
    for number, stance in enumerate(control.stances):
        for verdict in VERDICTS:
            if verdict is not stance.verdict:
                yield replace(control, stances=set_at(control.stances, number, stance._replace(verdict=verdict)))
        for way in range(len(control.outcomes)):
            if way != stance.step:
                yield replace(control, stances=set_at(control.stances, number, stance._replace(step=way)))
    for number, branch in enumerate(control.branches):
        swapped = branch._replace(if_so=branch.if_not, if_not=branch.if_so)
        yield replace(control, branches=set_at(control.branches, number, swapped))
    for number, outcome in enumerate(control.outcomes):
        for state in range(len(control.stances)):
            if state != outcome.state:
                yield replace(control, outcomes=set_at(control.outcomes, number, outcome._replace(state=state)))
