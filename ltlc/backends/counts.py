"""Clocks that outcomes do not set: ages, which messages renew, and counts of what occurs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple

from ltlc.backends.statements import If, Statement
from ltlc.backends.steps import clock_names
from ltlc.backends.trees import Code, Prefix, Text
from ltlc.backends.wording import Wording
from ltlc.program.expressions import Expression
from ltlc.program.machine import Age, Machine, Occurrences


def ages(machine: Machine) -> list[tuple[str, Age]]:
    """The clocks of `machine` that are ages, each with what it is called."""
    clocks = zip(clock_names(machine), machine.clocks, strict=True)
    return [(name, clock.age) for name, clock in clocks if clock.age is not None]


def heard(machine: Machine, news: Mapping[str, str], wording: Wording, can_be_due: bool = True) -> list[Statement]:
    """Statements that renew ages: of a signal, where what is called as in `news` holds."""
    of_signals = dict.fromkeys(age.signal for _, age in ages(machine))
    renewed = {of: {name: age.duration for name, age in ages(machine) if age.signal == of} for of in of_signals}
    return [wording.heard(news[of], clocks, can_be_due) for of, clocks in renewed.items()]


class Counting(NamedTuple):
    """A clock that is a count: what it is called, and the attributes that have the last times and what held."""

    clock: str
    of: Occurrences
    times: str
    held: str

    def members(self) -> tuple[str, ...]:
        """What is kept beside the clock and the times: whether the condition held, if that is what begins."""
        return (self.held,) if self.of.begins else ()


def countings(machine: Machine, named: Callable[[str, int], str] = "{}_{}".format) -> list[Counting]:
    """The clocks of `machine` that count; the attributes are `named` by what they have and the clock's number."""
    clocks = zip(clock_names(machine), machine.clocks, strict=True)
    return [
        Counting(name, clock.occurrences, named("times", number), named("occurs", number))
        for number, (name, clock) in enumerate(clocks)
        if clock.occurrences is not None
    ]


def presumed(counted: list[Counting], wording: Wording) -> tuple[Statement, ...]:
    """What the first step does: for a while it is presumed that there are as many."""
    return tuple(wording.clock(c.clock, "time", c.of.duration or 0) for c in counted if c.of.presumed)


def noted(counted: list[Counting], wording: Wording, ask: Callable[[Expression, bool], Code]) -> Iterator[Statement]:
    """What a step notes, and when that is over; `ask` is code for a condition."""
    for clock, of, times, held in counted:
        note, is_full = wording.noted(times, of.times)
        first = "" if of.duration is None else wording.first(times, of.times)
        noting = (*note, If(is_full, (wording.clock(clock, first, of.duration or 0),)))
        occurs, attribute = ask(of.condition, True), f"{wording.own}{held}"
        if not of.begins:
            yield If(occurs, noting)
            continue
        no, yes = (f"{attribute} = {word}" for word in wording.words)
        yield If(occurs, (If(Prefix("not ", Text(attribute)), (yes, *noting)),), (no,))
