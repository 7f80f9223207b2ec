"""What is asked of a specification: one file for each question, in the order in which they are asked."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from ltlc.analysis.findings import Finding
from ltlc.analysis.questions import (
    encodings_differ,
    events_gap,
    events_overlap,
    exact_equality,
    excluded_deadline,
    guard_holds_back,
    guard_passes_nothing,
    guard_takes_back,
    held_trigger,
    idle_bound,
    inconsistent,
    never_decided,
    never_forgotten,
    never_triggered,
    no_finite_run,
    presumed_rate,
    rate_dependent,
    redundant,
    same_signal,
    short_bound,
    short_for_guard,
    uncontrollable,
    unreachable_count,
    unsatisfiable,
    vacuous_part,
    valid,
    waits_for_others,
    waits_for_topic,
    watched_only,
)
from ltlc.analysis.subjects import Study, Subject
from ltlc.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Question:
    """A question about one property; `text` completes 'not decided: whether …'."""

    text: str
    ask: Callable[[Study, Subject], Iterable[Finding]]


OF_ONE = (
    Question("any run satisfies it", unsatisfiable.ask),
    Question("any finite run satisfies it", no_finite_run.ask),
    Question("it can fail", valid.ask),
    Question("it depends on the rate of messages", rate_dependent.ask),
    Question("its events overlap", events_overlap.ask),
    Question("a part of it makes no difference", vacuous_part.ask),
    Question("a bound on time makes no difference", idle_bound.ask),
    Question("an interval excludes what begins it", held_trigger.ask_at_once),
    Question("a bound on time is shorter than a tick", short_bound.ask),
    Question("a count is of more than there are ticks", unreachable_count.ask),
    Question("a rate that holds at first decides it", presumed_rate.ask),
    Question("it keeps ids or messages forever", never_forgotten.ask),
    Question("a deadline waits for a topic", waits_for_topic.ask),
    Question("a part of it waits for the others", waits_for_others.ask),
    Question("a bound on time is too short for a guard", short_for_guard.ask),
    Question("a guard keeps it", watched_only.ask),
)
"""About a property by itself."""

PEDANTIC = (
    Question("a run can decide it", never_decided.ask),
    Question("its events leave a gap", events_gap.ask),
    Question("an interval begins with its trigger", held_trigger.ask),
    Question("the readings of its scopes differ", encodings_differ.ask),
)
"""About a property by itself, on demand: what is found may well be as it should be."""

AMONG_OTHERS = (
    Question("its events can occur while others hold", never_triggered.ask),
    Question("it follows from others", redundant.ask),
    Question("its deadlines leave others their time", excluded_deadline.ask),
)
"""About a property among the others of the file."""


@dataclass(frozen=True, slots=True)
class JointQuestion:
    """A question about several properties that share signals."""

    text: str
    ask: Callable[[Study, Sequence[Subject]], Iterable[Finding]]


OF_SEVERAL = (JointQuestion("they can hold together", inconsistent.ask),)
"""About all properties that hang together by their signals."""


@dataclass(frozen=True, slots=True)
class FileQuestion:
    """A question about the whole file."""

    text: str
    ask: Callable[[Study], Iterable[Finding]]


OF_FILES = (
    FileQuestion("two names are one signal", same_signal.ask),
    FileQuestion("measured numbers are compared exactly", exact_equality.ask),
    FileQuestion("a guard lets nothing through", guard_passes_nothing.ask),
    FileQuestion("a guard never lets some commands through", guard_holds_back.ask),
    FileQuestion("a guard takes commands back", guard_takes_back.ask),
    FileQuestion("a controller can prevent violations", uncontrollable.ask),
    FileQuestion("a controller can fulfil what is owed", uncontrollable.ask_of_obligations),
)
"""About the whole file."""
