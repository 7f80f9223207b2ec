"""A certificate as it is read, line by line: what has come so far, and whether the whole is one that can be checked."""

from __future__ import annotations

import operator
from collections.abc import Iterable, Sequence
from dataclasses import field

from ltlc.dataclass import dataclass
from ltlc.semantics import properties
from ltlc.semantics.certificate import Certificate, Level, Place, Progress
from ltlc.semantics.certificate_text import Entry
from ltlc.semantics.certificate_words import WrongError, exists
from ltlc.semantics.conditions import Conditions
from ltlc.semantics.control_text import ControlDraft
from ltlc.semantics.encodings import ENCODINGS, ManyClocksError, encode, has_bounds
from ltlc.semantics.ltl import Atom, Formula, Next, Until, atoms, subformulas
from ltlc.semantics.monitor import Decision, Monitor, Target
from ltlc.semantics.properties import Property, predicates
from ltlc.semantics.reset_machine import WITHOUT_CLOCKS, Clocks
from ltlc.semantics.timed_atoms import Late, operands
from ltlc.semantics.trackers import Tracker, trackers_of
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Lasso

LARGEST_FORMULA = 100_000
"""Nodes of a formula written out as a tree."""
MOST_TEMPORAL = 5_000
"""Different next and until formulas of one property."""
DEEPEST_PROPERTY = 40
DEEPEST_PREDICATE = 300
LARGEST_ENCODING = 1_000_000
"""A bound on the nodes of the formulas that a property and its parts are encoded as."""
LARGEST_TASK = 1_000_000_000
"""A bound on the work of evaluating witnesses, and of comparing dead formulas, for one property."""
MOST_TRACKERS = 50
"""Clocks and atoms of the past in one property."""
LONGEST_TEXT = 100_000_000
"""A bound on the characters in the names of the atoms that clocks are late."""

ONCE = ("line", "encoding", "subject", "formula", "assumption")
"""The lines that a certificate has one of each."""


Spot = tuple[int | None, int]
"""A place by its numbers: the state of the reset machine, if there is one, and the formula that remains."""


@dataclass(slots=True)
class Draft:
    """What has been read of one entry.

    `sizes` and `heights` are those of formulas written out, with what defines their atoms; `definitions` has them by
    atom. `bounds` are on the nodes of the encodings of properties.
    """

    label: str
    line: int | None = None
    encoding: str | None = None
    atoms: list[Atom] = field(default_factory=list)
    definitions: dict[int, tuple[int, int]] = field(default_factory=dict)
    formulas: list[Formula] = field(default_factory=list)
    sizes: list[int] = field(default_factory=list)
    heights: list[int] = field(default_factory=list)
    temporal: int = 0
    properties: list[Property] = field(default_factory=list)
    depths: list[int] = field(default_factory=list)
    bounds: list[int] = field(default_factory=list)
    subject: int | None = None
    formula: int | None = None
    assumption: int | None = None
    clocks: list[Clocks] = field(default_factory=list)
    verdicts: list[Verdict] = field(default_factory=list)
    edges: list[Target] = field(default_factory=list)
    annotations: list[list[Spot]] = field(default_factory=list)
    decisions: list[Decision] = field(default_factory=list)
    levels: list[tuple[list[Spot], Progress]] = field(default_factory=list)
    witnesses: dict[int, list[Lasso]] = field(default_factory=dict)
    program: ControlDraft = field(default_factory=ControlDraft)

    def add_formula(self, formula: Formula, parts: Iterable[tuple[int, int]]) -> None:
        """`formula`, whose parts have these sizes and heights."""
        parts = list(parts)
        self.temporal += isinstance(formula, Next | Until)
        self.formulas.append(formula)
        self.sizes.append(1 + sum(size for size, _ in parts))
        self.heights.append(1 + max((height for _, height in parts), default=0))
        if self.sizes[-1] > LARGEST_FORMULA or self.temporal > MOST_TEMPORAL:
            raise WrongError("the formula is too large")

    def measure(self, number: int) -> tuple[int, int]:
        """The size and the height of a formula."""
        return self.sizes[number], self.heights[number]

    def define(self, number: int, atom: Atom, operands: list[int]) -> None:
        """`atom` is what is known so far by its number and name only; `operands` are the formulas that decide it."""
        if number in self.definitions or any(formula is self.atoms[number] for formula in self.formulas):
            raise WrongError(f"a{number} is defined or used already")
        if len(self.definitions) == MOST_TRACKERS:
            raise WrongError(f"more than {MOST_TRACKERS} atoms are defined")
        self.atoms[number] = atom
        size = 1 + sum(self.sizes[operand] for operand in operands)
        height = 1 + max((self.heights[operand] for operand in operands), default=0)
        self.definitions[number] = size, height
        if size > LARGEST_FORMULA or height > DEEPEST_PREDICATE:
            raise WrongError("the definition is too large")

    def entry(self) -> Entry:
        """All that has been read. Raises WrongError if something is missing or does not fit together."""
        self._complete()
        assert self.line is not None
        assert self.encoding is not None
        assert self.subject is not None
        assert self.formula is not None
        assert self.assumption is not None
        subject, formula = self.properties[self.subject], self.formulas[self.formula]
        if has_bounds(subject):
            formula = self._with_clocks(subject, formula)
        self._fits(trackers_of(formula))
        names = tuple(atom.name for atom in self.atoms)
        certificate = Certificate(
            formula,
            self.formulas[self.assumption],
            Monitor(names, tuple(self.verdicts), tuple(self.edges), tuple(self.decisions)),
            tuple(self._places(spots) for spots in self.annotations),
            tuple(Level(progress, self._places(spots)) for spots, progress in self.levels),
            tuple(tuple(self.witnesses.get(state, [])) for state in range(len(self.verdicts))),
        )
        return Entry(self.label, self.line, subject, self.encoding, certificate, self.program.followed())

    def _complete(self) -> None:
        """Whether all is there, and not too large to be checked."""
        for keyword in ONCE:
            if getattr(self, keyword) is None:
                raise WrongError(f"the property has no '{keyword}'")
        if not self.verdicts:
            raise WrongError("the property has no state")
        if len({atom.name for atom in self.atoms}) < len(self.atoms):
            raise WrongError("two atoms have one name")
        targets = [*self.edges, *(t for decision in self.decisions for t in (decision.low, decision.high))]
        for target in targets:
            exists(target, "q", len(self.verdicts), "d", len(self.decisions))
        if self._task() > LARGEST_TASK:
            raise WrongError("the certificate is too large to be checked")

    def _with_clocks(self, subject: Property, formula: Formula) -> Formula:
        """`formula`, in which a clock that is late is an atom with a name, as the encoding of `subject` has it.

        What is not that encoding is left as it is: it is no formula of the property.
        """
        assert self.encoding is not None
        assert self.subject is not None
        longest = max((len(atom.name) for atom in self.atoms), default=0)
        if longest * self.bounds[self.subject] > LONGEST_TEXT:
            raise WrongError("the names of atoms are too long")
        try:
            encoded = encode(subject, ENCODINGS[self.encoding])
        except ManyClocksError:
            raise WrongError("the property has a bound that takes many clocks") from None
        late = {part.name for part in subformulas(encoded) if isinstance(part, Late)}
        deciding = [operand for number in self.definitions for operand in operands(self.atoms[number])]
        if not late.isdisjoint(name for formula in (*predicates(subject), *deciding) for name in atoms(formula)):
            raise WrongError("that a clock is late decides no part of the property itself")
        conditions = Conditions()
        return encoded if conditions.number(encoded) == conditions.number(formula) else formula

    def _fits(self, trackers: Sequence[Tracker]) -> None:
        """Whether `clocks` can be states of the reset machine with these `trackers`, and all places have one."""
        if len(trackers) > MOST_TRACKERS:
            raise WrongError(f"the property has more than {MOST_TRACKERS} clocks")
        most = [len(tracker.bounds) for tracker in trackers]
        for number, clocks in enumerate(self.clocks):
            passed = [state.passed for state in clocks.states]
            if len(passed) != len(most) or any(map(operator.gt, passed, most)):
                raise WrongError(f"k{number} is no state of the clocks of the property")
        spots = [spot for spots in (*self.annotations, *(spots for spots, _ in self.levels)) for spot in spots]
        if trackers and any(clocks is None for clocks, _ in spots):
            raise WrongError("it is not said where the clocks are: k0.f0")
        open_pairs = [pair for pair in self.program.pairs if not self.verdicts[pair.judged].is_permanent]
        if any(len(pair.stand) < len(trackers) for pair in open_pairs):
            raise WrongError("it is not said where the clocks are: pair s0 q0 k0")

    def _places(self, spots: Iterable[Spot]) -> tuple[Place, ...]:
        return tuple(
            Place(WITHOUT_CLOCKS if clocks is None else self.clocks[clocks], self.formulas[formula])
            for clocks, formula in spots
        )

    def _task(self) -> int:
        """About how much evaluation the certificate asks for, beyond what the checker counts itself."""
        assert self.subject is not None
        assert self.assumption is not None
        task = 0
        walk = 4 * self.bounds[self.subject] if self.clocks else 0
        for state, spots in enumerate(self.annotations):
            annotated = sum(self.sizes[number] for _, number in spots) + 1
            positions = [len(word.stem) + len(word.loop) for word in self.witnesses.get(state, [])]
            task += annotated + sum(n * n * (annotated + self.sizes[self.assumption]) for n in positions)
            task += sum(n * walk * len(spots) for n in positions)
        dead = [number for spots, _ in self.levels for _, number in spots]
        return task + (len(dead) + len(self.levels)) * sum(self.sizes[number] + 1 for number in dead)


def bound_of(property_: Property, predicates: list[int], bodies: list[int]) -> int:
    """A bound on the nodes of the encoding of a property, from the sizes of its predicates and its bodies' bounds."""
    match property_:
        case properties.AfterUntil():
            opening, closing = predicates
            return 2 * (2 * (opening + closing) + bodies[0] * (2 * closing + 6) + 14) + closing + 10
        case properties.After() | properties.Until():
            return 2 * predicates[0] + bodies[0] * (2 * predicates[0] + 6) + 12
        case properties.Within():
            return 8 * bodies[0] + 12
        case properties.Implies(properties.Now(), body) if has_bounds(body):  # each conjunct of it has the trigger
            return bodies[1] + (bodies[0] + 8) * (bodies[1] // 6 + 1) + 6
    return sum(predicates) + sum(bodies) + 6
