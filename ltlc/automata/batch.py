"""Translates many properties, each shape once, in child processes under a budget."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import replace
from functools import partial

from ltlc.automata import progression, spot_translation
from ltlc.automata.machine import read_by
from ltlc.base.limits import Budget, Exceeded, Limit, Watch, run_all
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.ltl import Atom, Formula, children, parts_first
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.timed_atoms import Late, TimedAtom, duration_of, operands, timed_atoms
from ltlc.semantics.trackers import clocks_around

Task = tuple[Formula, Alphabet]
Translate = Callable[[Sequence[Task]], Sequence[Monitor | Exceeded]]
Known = dict[Hashable, Monitor | Exceeded]
"""The outcomes of earlier tasks, by their shapes."""


def translate_all(
    tasks: Sequence[Task], budget: Budget, watch: Watch | None = None, known: Known | None = None
) -> list[Monitor | Exceeded]:
    """See `ltlc.automata.translate_all`."""
    return once_for_each_shape(tasks, partial(_translate_each, budget=budget, watch=watch), known)


def once_for_each_shape(
    tasks: Sequence[Task], translate: Translate, known: Known | None = None
) -> list[Monitor | Exceeded]:
    """The outcome of each task, of which `translate` is given only one of those that differ in names.

    It is given none of a shape that is `known`; there, what it finds is added.
    """
    by_shape = {} if known is None else known
    first: dict[Hashable, Task] = {}
    shapes = [_shape(*task) for task in tasks]
    for task, shape in zip(tasks, shapes, strict=True):
        if shape not in by_shape:
            first.setdefault(shape, task)
    by_shape.update(zip(first, translate(list(first.values())), strict=True))
    return [_named(by_shape[shape], *task) for task, shape in zip(tasks, shapes, strict=True)]


def _translate_each(tasks: Sequence[Task], budget: Budget, watch: Watch | None) -> list[Monitor | Exceeded]:
    """The outcome of each task: by Spot in half of the time, or else by progression in the other half.

    Conjunctions of responses, of which Spot's automata have very many edges, are easy for progression.
    """
    half = replace(budget, seconds=budget.seconds / 2)
    outcomes = run_all([partial(spot_translation.translate, *task) for task in tasks], half, watch=watch)
    again = [k for k, outcome in enumerate(outcomes) if _is_worth_another_try(outcome)]
    retried = run_all([partial(progression.translate, *tasks[k]) for k in again], half, watch=watch)
    for k, outcome in zip(again, retried, strict=True):
        outcomes[k] = outcome
    return [replace(o, budget=budget) if isinstance(o, Exceeded) else o for o in outcomes]


def _is_worth_another_try(outcome: Monitor | Exceeded) -> bool:
    return isinstance(outcome, Exceeded) and outcome.limit is not Limit.NESTING


def _shape(formula: Formula, alphabet: Alphabet) -> Hashable:
    """What is left of a task without the names of its atoms; formulas of any depth."""
    alphabet = read_by(formula, alphabet)
    number = {atom: k for k, atom in enumerate(alphabet.atoms)}
    groups = tuple(
        (tuple(number[a] for a in group.atoms), frozenset(frozenset(number[a] for a in v) for v in group.valuations))
        for group in alphabet.groups
        if len(group.valuations) < 2 ** len(group.atoms)  # otherwise it excludes nothing
    )
    timed = timed_atoms(formula)
    durations = [duration for atom in timed if (duration := duration_of(atom)) is not None]
    most = _LONG if len(durations) == 1 else max(durations, default=0)
    return _structure(formula, number), groups, tuple(_definition(atom, number, most) for atom in timed)


_LONG = 2
"""ns; where one clock has one bound, this is as good as a longer one, and is only a moment."""


def _definition(atom: TimedAtom, number: Mapping[str, int], most: Nanoseconds) -> Hashable:
    """What is left of the definition of `atom`, which decides its translation, too; durations up to `most` count."""
    duration = duration_of(atom)
    clocks = [type(clock) for clock in clocks_around(atom.clock)] if isinstance(atom, Late) else []
    decided_by = tuple(_structure(operand, number) for operand in operands(atom))
    return (
        number[atom.name],
        type(atom),
        duration if duration is None else min(duration, most),
        tuple(clocks),
        decided_by,
    )


def _structure(formula: Formula, number: Mapping[str, int]) -> Hashable:
    """Each different subformula as what it is made of, by numbers: the same for equal trees, shared or not."""
    numbers: dict[Hashable, int] = {}
    known: dict[int, int] = {}
    for part in parts_first(formula):
        made_of = number[part.name] if isinstance(part, Atom) else tuple(known[id(child)] for child in children(part))
        known[id(part)] = numbers.setdefault((type(part), made_of), len(numbers))
    return tuple(numbers)


def _named(outcome: Monitor | Exceeded, formula: Formula, alphabet: Alphabet) -> Monitor | Exceeded:
    """The outcome of a task of the same shape, with the atoms of this one."""
    if isinstance(outcome, Exceeded):
        return outcome
    return replace(outcome, atoms=read_by(formula, alphabet).atoms)
