"""The control of what runs: a machine in the form that the certificate checker compares with a monitor."""

from __future__ import annotations

from ltlc.compiler import Compiled
from ltlc.program.machine import Clock
from ltlc.program.machine import Outcome as Done
from ltlc.program.properties import questions
from ltlc.semantics.control import Base, Branch, Control, Outcome, Setting, Stance
from ltlc.semantics.monitor import Decision
from ltlc.semantics.trackers import trackers_of


def control_of(compiled: Compiled) -> Control:
    """The control of the property's machine. What its atoms say is no part of it, nor values kept at openings.

    It has a clock for each that the trackers of the property have; a machine that never asks them has none.
    """
    machine, asked = compiled.machine, questions(compiled.specification)
    clocks = machine.clocks or (Clock(),) * sum(bool(tracker.bounds) for tracker in trackers_of(compiled.formula))

    def branch(decision: Decision) -> Branch:
        number, low, high = decision
        if number >= len(machine.atoms):
            return Branch(number - len(machine.atoms), high, low)
        name, holds = asked[machine.atoms[number]]
        return Branch(name, high, low) if holds else Branch(name, low, high)

    return Control(
        tuple(Stance(*state) for state in machine.states),
        tuple(map(branch, machine.decisions)),
        tuple(map(_outcome, machine.outcomes)),
        tuple(clock.age and clock.age.duration for clock in clocks),
    )


def _outcome(done: Done) -> Outcome:
    settings = (Setting(clock, Base[base.name], duration) for clock, base, duration in done.sets)
    return Outcome(done.state, tuple(settings), done.again)
