"""Ways to make a monitor out of a formula, side by side: how long they take, how large it gets, whether they agree.

Some make the whole monitor, with all four verdicts; others a part of it: the finite half (does the run so far satisfy
the formula?) or the permanent half (is it decided?). A part is compared with the same part of the whole.
"""

from __future__ import annotations

import shutil
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path

from ltlc.analysis.comparison import mona
from ltlc.analysis.comparison.measure import edges, machine_of
from ltlc.automata import translate, translate_by_progression
from ltlc.automata.machine import Letters, Machine, letters_of, to_monitor, verdict_machine
from ltlc.automata.spot_translation import Session
from ltlc.base.limits import Budget, Exceeded, run_all
from ltlc.dataclass import dataclass
from ltlc.semantics import finite
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.ltl import Formula, Not, atoms, is_next_free
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.verdicts import Verdict

Construct = Callable[[Formula, Alphabet], Monitor]


def _same(verdict: Verdict) -> Verdict:
    return verdict


def _finite_half(verdict: Verdict) -> Verdict:
    """Whether the run so far satisfies the formula, as a presumable verdict."""
    return Verdict.PRESUMABLY_SATISFIED if verdict.holds else Verdict.PRESUMABLY_VIOLATED


def _permanent_half(verdict: Verdict) -> Verdict:
    """A permanent verdict, or one for 'undecided'."""
    return verdict if verdict.is_permanent else Verdict.PRESUMABLY_SATISFIED


@dataclass(frozen=True, slots=True)
class Constructor:
    """A way to make a monitor; `part` is the part of a whole monitor's verdicts that it gives."""

    name: str
    description: str
    construct: Construct
    part: Callable[[Verdict], Verdict] = _same
    is_there: Callable[[], bool] = lambda: True


def _through_ltlf(formula: Formula, alphabet: Alphabet) -> Monitor:
    letters = letters_of(formula, alphabet)
    return _finite_monitor(formula, Session(letters).finitely_satisfied(formula))


def _through_mona(formula: Formula, alphabet: Alphabet) -> Monitor:
    letters = letters_of(formula, alphabet)
    with tempfile.TemporaryDirectory() as folder:
        return _finite_monitor(formula, mona.automaton(formula, Path(folder)).machine(letters))


def _through_closures(formula: Formula, alphabet: Alphabet) -> Monitor:
    letters = letters_of(formula, alphabet)
    session = Session(letters)
    holding = _constant(letters, True)
    return to_monitor(verdict_machine(session.satisfiable(formula), session.satisfiable(Not(formula)), holding, True))


def _finite_monitor(formula: Formula, words: Machine) -> Monitor:
    undecided = _constant(words.letters, True)
    return to_monitor(verdict_machine(undecided, undecided, words, finite.holds(formula, ())))


def _constant(letters: Letters, output: bool) -> Machine:
    """The machine of one state whose output is always `output`."""
    return Machine(letters, [output], [letters.restrict(letters.diagrams.terminal(0))])


WHOLE = Constructor("product", "Spot's monitors of φ and ¬φ, times the automaton of its finite runs", translate)

FINITE_HALF = Constructor("ltlf", "finite half: Spot's automaton of the finite runs", _through_ltlf, _finite_half)

CONSTRUCTORS = (
    WHOLE,
    Constructor("progression", "what remains of φ after each letter", translate_by_progression),
    Constructor("closures", "permanent half: Spot's monitors of φ and of ¬φ", _through_closures, _permanent_half),
    FINITE_HALF,
    Constructor(
        "mona",
        "finite half: MONA's automaton",
        _through_mona,
        _finite_half,
        lambda: shutil.which("mona") is not None,
    ),
)
"""The ways that are compared; the first is the one that ltlc uses, and the one that the others are judged by."""


@dataclass(frozen=True, slots=True)
class Built:
    """One way tried on one formula: the monitor and how long it took, in seconds."""

    monitor: Monitor
    seconds: float


@dataclass(frozen=True, slots=True)
class Trial:
    """One formula, and what each way made of it. `agrees` is whether that is the same, where it is known."""

    name: str
    formula: Formula
    outcomes: Mapping[str, Built | Exceeded]
    agrees: Mapping[str, bool]


def measure(formulas: Sequence[tuple[str, Formula]], budget: Budget) -> list[Trial]:
    """Try every constructor that is there on each of `formulas`, each time with `budget`."""
    present = [constructor for constructor in CONSTRUCTORS if constructor.is_there()]
    jobs = [partial(_build, c.construct, formula) for _, formula in formulas for c in present]
    outcomes = iter(run_all(jobs, budget))
    return [_trial(name, formula, {c.name: next(outcomes) for c in present}) for name, formula in formulas]


def _build(construct: Construct, formula: Formula) -> Built:
    alphabet = Alphabet(atoms(formula))
    start = time.perf_counter()
    monitor = construct(formula, alphabet)
    return Built(monitor, time.perf_counter() - start)


def _trial(name: str, formula: Formula, outcomes: Mapping[str, Built | Exceeded]) -> Trial:
    return Trial(name, formula, outcomes, dict(_agreements(formula, outcomes)))


def _agreements(formula: Formula, outcomes: Mapping[str, Built | Exceeded]) -> Iterator[tuple[str, bool]]:
    """Whether each outcome is the part of the whole that it should be, where both are there.

    With a next operator a permanent verdict does not say whether the run so far, taken as finite, satisfies the
    formula; then the finite halves are compared with one another.
    """
    whole, halves = outcomes[WHOLE.name], outcomes[FINITE_HALF.name]
    for constructor in CONSTRUCTORS[1:]:
        built = outcomes.get(constructor.name)
        if not isinstance(built, Built):
            continue
        if constructor.part is not _finite_half or is_next_free(formula):
            if isinstance(whole, Built):
                yield constructor.name, built.monitor == part_of(whole.monitor, formula, constructor.part)
        elif constructor is not FINITE_HALF and isinstance(halves, Built):
            yield constructor.name, built.monitor == halves.monitor


def part_of(monitor: Monitor, formula: Formula, part: Callable[[Verdict], Verdict]) -> Monitor:
    """The smallest monitor that gives the `part` of the verdicts of `monitor`, which was made of `formula`."""
    machine = machine_of(monitor, formula, Alphabet(atoms(formula)))
    return to_monitor(Machine(machine.letters, [part(verdict) for verdict in machine.outputs], machine.successors))


def sizes(monitor: Monitor) -> tuple[int, int]:
    """States and edges."""
    return len(monitor.verdicts), edges(monitor)
