"""The compiler on one page: the passes in order, and nothing else.

    text ─load→ specification ─encode→ core LTL ─translate→ monitor ─emit→ code ─gate→ file

| pass | from | to | code | proof |
|---|---|---|---|---|
| load | text | specification | `ltlc.frontend.language` | |
| encode | specification | core LTL | `ltlc.semantics.encodings` | `proofs/Encodings.v` |
| translate | core LTL | monitor | `ltlc.automata` | a certificate for each monitor |
| emit | monitor | code | `ltlc.backends` | |
| gate | all of these | what may be written | `ltlc.assurance` | `proofs/Certificate.v` |
"""

from __future__ import annotations

from functools import cached_property

from ltlc.automata import Budget, Exceeded, Task, translate_all
from ltlc.automata.batch import Known
from ltlc.automata.folding import fold
from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.limits import Watch
from ltlc.dataclass import dataclass
from ltlc.program.machine import Machine
from ltlc.program.properties import machine_of
from ltlc.semantics.encodings import Encoding, encode
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Monitor
from ltlc.specification.specification import PropertySpecification, Specification


@dataclass(frozen=True)
class Compiled:
    """A property, its formula of core LTL under `encoding`, and the monitor made of that formula."""

    specification: PropertySpecification
    encoding: Encoding
    formula: Formula
    monitor: Monitor

    @cached_property
    def machine(self) -> Machine:
        """What runs: the monitor together with the clocks that its atoms speak of, and typed expressions for these."""
        of = self.specification
        return machine_of(of, fold(self.formula, of.alphabet, self.monitor, of.scopes()))


def compile_specification(
    specification: Specification,
    encoding: Encoding,
    budget: Budget,
    watch: Watch | None = None,
    known: Known | None = None,
) -> tuple[list[Compiled], list[Diagnostic]]:
    """Every property of `specification` with its monitor, and a diagnostic for each that `budget` does not suffice for.

    `known` keeps what was found from one call to the next. Raises SpotMissing.
    """
    properties = specification.properties
    formulas = [encode(p.property, encoding) for p in properties]
    tasks = [Task(formula, p.alphabet) for p, formula in zip(properties, formulas, strict=True)]
    compiled, problems = [], []
    outcomes = translate_all(tasks, budget, watch, known)
    for property_, formula, outcome in zip(properties, formulas, outcomes, strict=True):
        if isinstance(outcome, Exceeded):
            problems.append(_too_hard(specification, property_, outcome))
        else:
            compiled.append(Compiled(property_, encoding, formula, outcome))
    return compiled, problems


def _too_hard(specification: Specification, property_: PropertySpecification, outcome: Exceeded) -> Diagnostic:
    return diagnostic(
        "LTL701",
        specification.source,
        property_.span,
        f"no monitor for `{property_.label}`: its translation {outcome}",
        help="split the property into several, or raise the limits with `--budget SECONDS,MB`",
    )
