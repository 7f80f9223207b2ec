"""What only z3 can decide about atoms: which can hold together, and numbers that make a run of given letters."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import z3  # noqa: TID251

from ltlc.analysis.arithmetic import Taken, Term, Translator, real, to_float
from ltlc.analysis.groups import key, reads_of
from ltlc.analysis.thresholds import Values
from ltlc.semantics.words import Letter, Word
from ltlc.specification.atoms import Atom
from ltlc.specification.evaluation import letter

WORK = 800_000
"""What one question to z3 may take, in z3's own steps: a quarter of a second of an idle core, and the same answer on
every machine at any load."""

MOST_VALUATIONS = 512
"""A group with more valuations than these is left free: nothing that uses them all would end."""

MOST_DIGITS = 4
"""Numbers in examples are rounded to at most this many digits after the point, where they can be."""


def valuations(atoms: Sequence[Atom]) -> list[Letter] | None:
    """The sets of `atoms` that can hold together; None if z3 does not know, or if there are too many of them."""
    translator, solver = _translated(atoms)
    # Variables of their own: z3 does not evaluate every condition over irrational numbers to true or false.
    holds = [z3.Bool(f"atom{number}") for number in range(len(atoms))]
    for variable, atom in zip(holds, atoms, strict=True):
        solver.add(variable == translator.condition(atom.condition))
    solver.add(translator.facts())
    found: list[Letter] = []
    while len(found) <= MOST_VALUATIONS:
        answer = solver.check()
        if answer == z3.unsat:
            return sorted(found, key=lambda v: [atom.name in v for atom in atoms])
        if answer != z3.sat:
            return None
        model = solver.model()
        truths = [z3.is_true(model.eval(variable, model_completion=True)) for variable in holds]
        found.append(frozenset(atom.name for atom, truth in zip(atoms, truths, strict=True) if truth))
        solver.add(z3.Or([z3.Not(v) if truth else v for v, truth in zip(holds, truths, strict=True)]))
    return None


def _translated(
    atoms: Sequence[Atom],
    linked: bool = False,
    exact_norms: bool = False,
    taken: Taken | None = None,
    knows_zones: bool = False,
) -> tuple[Translator, Any]:
    values = [value for atom in atoms for value in reads_of(atom.condition)]
    solver = z3.Solver()
    solver.set("rlimit", WORK)
    related = frozenset(key(value) for value in values)
    return Translator(related, linked, exact_norms, taken, knows_zones), solver


def realise(atoms: Sequence[Atom], word: Word, linked: bool, taken: Taken) -> list[Values] | None:
    """Values of what `atoms` read at each step that give the letters of `word`; None if none are found.

    If `linked`, every step is a sample of every signal: what x is now, `@{x, -1}` is at the next step. `taken` says
    where values at an opening come from.
    """
    # Without squares there are simpler numbers, if not always the right ones.
    found = (_realise(atoms, word, linked, exact_norms, taken) for exact_norms in (False, True))
    return next((steps for steps in found if steps is not None), None)


def _realise(atoms: Sequence[Atom], word: Word, linked: bool, exact_norms: bool, taken: Taken) -> list[Values] | None:
    inputs = [value for atom in atoms for value in reads_of(atom.condition)]
    translator, solver = _translated(atoms, linked, exact_norms, taken, knows_zones=True)
    for translator.step, letter_ in enumerate(word):
        for atom in atoms:
            condition = translator.condition(atom.condition)
            solver.add(condition if atom.name in letter_ else z3.Not(condition))
    solver.add(*translator.facts(), *translator.measured())
    if solver.check() != z3.sat:
        return None
    model = _simplified(solver, translator.numbers)
    steps = []
    for translator.step in range(len(word)):
        steps.append({value: translator.value(model, value) for value in inputs})
    exact = all(letter(tuple(atoms), values) == wanted for values, wanted in zip(steps, word, strict=True))
    return steps if exact else None


def _simplified(solver: Any, numbers: Sequence[Term]) -> Any:
    """A model of what `solver` holds in which as many of `numbers` as `WORK` allows have few digits."""
    model = solver.model()
    solver.set("rlimit", WORK // 10)
    most = _work(solver) + WORK
    for number in numbers:
        if _work(solver) > most:
            break
        value = to_float(model, number)
        for digits in range(-1, MOST_DIGITS):
            solver.push()
            solver.add(number == real(round(value, digits)))
            if solver.check() == z3.sat:
                model = solver.model()
                break
            solver.pop()
    return model


def _work(solver: Any) -> int:
    """The steps that z3 has made so far."""
    return int(solver.statistics().get_key_value("rlimit count"))
