"""Looks for a short infinite run that satisfies some formulas and not others (Biere and others, *Bounded model
checking*, 2003; Latvala and others, *Simple bounded LTL model checking*, 2004).

Another procedure than Spot's, which builds automata: it finds runs of many formulas where products of automata explode,
and what Spot says has no run must have none here.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Reversible, Sequence
from typing import Any, assert_never

import z3  # noqa: TID251

from ltlc.analysis.errors import DisagreementError
from ltlc.analysis.timed_steps import TimedSteps
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.lasso import holds_on_lasso
from ltlc.semantics.ltl import And, Atom, Formula, Next, Not, Or, Truth, Until, conjunction
from ltlc.semantics.timed_atoms import timed_atoms
from ltlc.semantics.words import Lasso, Letter, Word

Term = Any
"""A term of z3's."""

LENGTHS = (1, 2, 3, 5)
"""How many different steps the runs have that are tried first."""

WORK = 5_000_000
"""What one question to z3 may take, in z3's own steps: some seconds of an idle core, at any load."""


class LassoSearch:
    """The runs over `alphabet` with `length` different steps, the last of which leads back to an earlier one.

    Where nothing is found, there is nothing, unless z3 `gave_up`.
    """

    def __init__(self, formulas: Sequence[Formula], alphabet: Alphabet, length: int) -> None:
        self._formulas = formulas
        self._length = length
        self.gave_up = False
        timed = timed_atoms(conjunction(formulas))
        names = (*alphabet.atoms, *(atom.name for atom in timed))
        self._steps = [{a: z3.Bool(f"{n}@{step}") for n, a in enumerate(names)} for step in range(length)]
        self._back = [z3.Bool(f"back@{step}") for step in range(length)]
        self._read = [_bits(step.values()) for step in self._steps]
        self._known: dict[int, tuple[Formula, list[Term]]] = {}
        self._solver = z3.Solver() if timed else z3.SolverFor("QF_FD")
        self._solver.set("rlimit", WORK)
        self._solver.add(z3.PbEq([(back, 1) for back in self._back], 1))
        for group in alphabet.groups:
            for step in self._steps:
                self._solver.add(_exists(group, step))
        self._time = TimedSteps(conjunction(formulas), self._steps, self._back, self._truth) if timed else None
        self._solver.add(list(self._time.constraints()) if self._time else [])
        self._asked = [z3.Bool(f"formula@{number}") for number in range(len(formulas))]
        for asked, formula in zip(self._asked, formulas, strict=True):
            self._solver.add(asked == self._truth(formula)[0])

    def find(self, wanted: Mapping[int, bool]) -> Lasso | None:
        """A run on which the formulas with these numbers hold or fail as `wanted`, and no other matters."""
        assumed = [self._asked[n] if holds else z3.Not(self._asked[n]) for n, holds in wanted.items()]
        model = self._model(assumed)
        if model is None:
            return None
        letters = [
            _letter(step, model.eval(bits, model_completion=True).as_long())
            for step, bits in zip(self._steps, self._read, strict=True)
        ]
        back = next(step for step in range(self._length) if z3.is_true(model[self._back[step]]))
        word: Word = self._time.run(model, letters, back) if self._time else tuple(letters)
        lasso = Lasso(word[:back], word[back:])
        self._check(lasso, wanted)
        return lasso

    def _model(self, assumed: list[Term]) -> Any:
        """What z3 finds, with steps only, or with round times, where there are any; None if it finds nothing."""
        answer = self._solver.check(assumed)
        self.gave_up |= answer == z3.unknown
        if answer != z3.sat:
            return None
        model = self._solver.model()
        for preference in self._time.preferences if self._time else ():
            if self._solver.check([*assumed, *preference]) == z3.sat:
                return self._solver.model()
        return model

    def _check(self, lasso: Lasso, wanted: Mapping[int, bool]) -> None:
        """Judge the run by the reference."""
        for number, holds in wanted.items():
            if holds_on_lasso(self._formulas[number], lasso) != holds:
                raise DisagreementError("how a run is judged")

    def _truth(self, formula: Formula) -> list[Term]:
        """The truth of `formula` at each step."""
        if id(formula) not in self._known:
            self._known[id(formula)] = formula, self._new_truth(formula)  # holding it keeps its number from another
        return self._known[id(formula)][1]

    def _new_truth(self, formula: Formula) -> list[Term]:
        match formula:
            case Truth():
                return [z3.BoolVal(True)] * self._length
            case Atom(name):
                return [step[name] for step in self._steps]
            case Not(operand):
                return [z3.Not(value) for value in self._truth(operand)]
            case And(left, right):
                return [z3.And(a, b) for a, b in zip(self._truth(left), self._truth(right), strict=True)]
            case Or(left, right):
                return [z3.Or(a, b) for a, b in zip(self._truth(left), self._truth(right), strict=True)]
            case Next(operand):
                values = self._truth(operand)
                return [*values[1:], self._after_last(values)]
            case Until(left, right):
                return self._until(self._truth(left), self._truth(right))
            case _:
                assert_never(formula)

    def _until(self, left: list[Term], right: list[Term]) -> list[Term]:
        """The second time through the loop, what was not fulfilled never will be."""
        second = self._backwards(left, right, z3.BoolVal(False))
        return self._backwards(left, right, self._after_last(second))

    def _backwards(self, left: list[Term], right: list[Term], last: Term) -> list[Term]:
        values: list[Term] = []
        for a, b in zip(reversed(left), reversed(right), strict=True):
            last = z3.Or(b, z3.And(a, last))
            values.append(last)
        return values[::-1]

    def _after_last(self, values: list[Term]) -> Term:
        """The value at the step to which the last one leads back."""
        return z3.Or([z3.And(back, value) for back, value in zip(self._back, values, strict=True)])


def _bits(variables: Iterable[Term]) -> Term:
    """`variables` as one number, the first its highest digit: reading many of a model one by one takes long."""
    one, zero = z3.BitVecVal(1, 1), z3.BitVecVal(0, 1)
    return z3.Concat(zero, zero, *(z3.If(variable, one, zero) for variable in variables))


def _letter(atoms: Reversible[str], bits: int) -> Letter:
    return frozenset(atom for place, atom in enumerate(reversed(atoms)) if bits >> place & 1)


def _exists(group: Group, step: Mapping[str, Term]) -> Term:
    """The atoms of `group` have one of its valuations."""
    return z3.Or(
        [
            z3.And([step[a] if a in valuation else z3.Not(step[a]) for a in group.atoms])
            for valuation in group.valuations
        ]
    )


def find_lasso(formulas: Iterable[Formula], alphabet: Alphabet, lengths: Iterable[int] = LENGTHS) -> Lasso | None:
    """A run with one of these numbers of different steps that satisfies all `formulas`; the first that is found."""
    wanted = list(formulas)
    for length in lengths:
        found = LassoSearch(wanted, alphabet, length).find(dict.fromkeys(range(len(wanted)), True))
        if found is not None:
            return found
    return None
