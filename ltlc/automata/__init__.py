"""From core LTL to monitors: complete deterministic Moore machines. The only package that imports Spot.

Spot is imported when it is first needed: that takes 40 ms, and not every command needs it.

Spot makes nondeterministic automata and answers questions; powerset, product and minimisation are ours, on decision
diagrams (`semantics/diagrams.py`), canonical by construction, and nothing enumerates letters. Finite words are not
Spot's `from_ltlf`, whose naming traps are many, but the reduction that it implements, written as Spot formulas
(`alive` up to the end).

There are two constructions. The second, progression, is an oracle in tests, and in builds what is tried when Spot has
used half of the budget. Both give the same monitor, as data. They share the diagrams, the exploration of states, the
minimisation and Spot's emptiness check, so that they agree says nothing of these. What shares none of them is the
tableau in `tests/`, and Spot's own way (`scc_filter`, `purge_dead_states`, `minimize_monitor`), a third construction
in tests for formulas of four atoms: it is exact but enumerates letters, 10 s at 20 atoms, out of memory at 24.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence

from ltlc.automata.errors import SpotMissing
from ltlc.base.limits import Budget, Exceeded, Limit, Watch
from ltlc.dataclass import dataclass
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Monitor

__all__ = [
    "Budget",
    "Exceeded",
    "Limit",
    "SpotMissing",
    "Task",
    "translate",
    "translate_all",
    "translate_by_progression",
    "watching",
]


@dataclass(frozen=True, slots=True)
class Task:
    """A formula to translate, and the letters over which."""

    formula: Formula
    alphabet: Alphabet


def translate(formula: Formula, alphabet: Alphabet) -> Monitor:
    """The monitor of `formula` over the letters of `alphabet`: the canonical minimal one, with the four verdicts.

    Its atoms are those of `formula`, in the order of `alphabet`, and equivalent formulas with the same atoms have equal
    monitors. It runs in this process, without limits. Raises SpotMissing; ValueError if `formula` has an atom that
    `alphabet` lacks, or if no letter exists; RecursionError if it is nested too deeply.
    """
    from ltlc.automata import spot_translation

    return spot_translation.translate(formula, alphabet)


def watching(event: Formula, alphabet: Alphabet) -> Monitor:
    """Says, after each letter, whether it has `event`, a state predicate: presumably satisfied if it has."""
    from ltlc.automata.machine import watcher

    return watcher(event, alphabet)


def translate_by_progression(formula: Formula, alphabet: Alphabet) -> Monitor:
    """The same monitor as `translate` gives, by another construction: progression of the formula.

    Faster than `translate` where the formula has many `Next`, slower where its residuals are many.
    """
    from ltlc.automata import progression

    return progression.translate(formula, alphabet)


def translate_all(
    tasks: Sequence[Task],
    budget: Budget,
    watch: Watch | None = None,
    known: dict[Hashable, Monitor | Exceeded] | None = None,
) -> list[Monitor | Exceeded]:
    """The monitor of each task, in order, or which limit of `budget` its translation ran into.

    Translation runs in child processes, as many at a time as there are CPUs; tasks that differ in the names of atoms
    only are translated once, and `known` keeps what was found from one call to the next. What Spot has not done in half
    of the time is done by progression in the other half. Raises SpotMissing and ValueError as `translate` does.
    """
    from ltlc.automata import batch

    return batch.translate_all([(task.formula, task.alphabet) for task in tasks], budget, watch, known)
