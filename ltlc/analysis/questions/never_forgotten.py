"""Can a property keep an id, or a message, forever, until a limit excludes others?"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from math import inf
from typing import TYPE_CHECKING, assert_never

from ltlc.analysis.findings import Finding
from ltlc.analysis.subjects import Study, Subject
from ltlc.automata import translate
from ltlc.semantics.monitor import below
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.expressions import Signal, ValueType
from ltlc.specification.specification import MOST_IDS, Instances, Slicing
from ltlc.specification.wire import Kind

if TYPE_CHECKING:
    from ltlc.program.machine import Machine, State


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A note if there may be more of them than places, and no run need bring the machine to where one is dropped."""
    of = subject.specification.slicing
    if of is None or not _may_be_many(subject, of):
        return
    machine = _machine(study, subject)
    if _always_leads(machine, _dropped(study, subject, machine, of)):
        return
    kept, help = _WORDS[type(of)]
    most, where = (of.limit, "") if of.limit else (MOST_IDS, "in a node ")
    message = f"`{subject.label}` can keep {kept} forever: {where}number {most + 1:,} may be ignored"
    yield Finding("LTL525", subject.specification.span, message, help=help)


_WORDS = {
    Slicing: (
        "an id",
        "set `limit` to the number of ids in a run; an id is forgotten if it has no open obligation and the property "
        "reads one topic, without ages, history or `_rate_`",
    ),
    Instances: ("a message", "say how long it has to hold, as in `until EVENT, …` or `within D, …`"),
}


def _may_be_many(subject: Subject, of: Slicing | Instances) -> bool:
    """Whether there are more ids than places; or messages that a value at the opening keeps apart."""
    match of:
        case Slicing():
            return _all_ids(of) > (of.limit or MOST_IDS)
        case Instances():
            return bool(subject.specification.openings())
        case _:
            assert_never(of)


def _all_ids(of: Slicing) -> float:
    """How many ids there are."""
    if not all(map(_is_integer, of.keys)):
        return inf
    numbers = [key.numbers for key in of.keys]
    return max(each.most for each in numbers) - min(each.least for each in numbers) + 1


def _is_integer(key: Signal) -> bool:
    return key.type in (ValueType.NUMBER, ValueType.NUMBERS) and key.numbers.kind is Kind.INTEGER


def _machine(study: Study, subject: Subject) -> Machine:
    """The machine that runs, of which it is decided there what is dropped."""
    from ltlc.compiler import Compiled  # few properties need machines

    specification = subject.specification
    monitor = translate(subject.formula, specification.alphabet)
    return Compiled(specification, study.encoding, subject.formula, monitor).machine


def _dropped(study: Study, subject: Subject, machine: Machine, of: Slicing | Instances) -> Collection[int]:
    """The states in which a slice, or an instance, is dropped without a trace."""
    match of:
        case Slicing():
            from ltlc.program.as_new import states_as_new

            return states_as_new(machine, subject.specification, of) if study.specification.rate is None else ()
        case Instances():
            return [number for number, state in enumerate(machine.states) if state.verdict is Verdict.SATISFIED]
        case _:
            assert_never(of)


def _always_leads(machine: Machine, dropped: Collection[int]) -> bool:
    """Whether each state that is not violated leads to one of `dropped`."""
    leading = set(dropped)
    after = [set(_successors(machine, state)) for state in machine.states]
    while more := {state for state, following in enumerate(after) if following & leading} - leading:
        leading |= more
    return all(n in leading or state.verdict is Verdict.VIOLATED for n, state in enumerate(machine.states))


def _successors(machine: Machine, state: State) -> Iterator[int]:
    targets = [state.step] if state.expire is None else [state.step, state.expire]
    return (machine.outcomes[end].state for end in below(machine.decisions, targets) if end >= 0)
