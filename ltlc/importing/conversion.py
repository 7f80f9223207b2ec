"""Requirements of other tools as a specification: written, compiled, and compared with the formulas they come from."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

from ltlc.base.diagnostics import Diagnostic, Severity
from ltlc.base.limits import Budget, Exceeded, Watch, run_all
from ltlc.base.source import Source
from ltlc.dataclass import dataclass
from ltlc.frontend.language import ReadText, read, types_for
from ltlc.importing import formulas as f
from ltlc.importing.conditions import NotComparedError
from ltlc.importing.names import Signals
from ltlc.importing.readings import Parting, parting
from ltlc.importing.requirement import Requirement
from ltlc.importing.showing import Shown, compare, of_property
from ltlc.importing.writing import Reading, UnsayableError, Writer
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.properties import predicates
from ltlc.specification.alphabet import alphabet
from ltlc.specification.atoms import Atom
from ltlc.specification.specification import PropertySpecification


@dataclass(frozen=True)
class Imported:
    """A requirement with its property, and how that relates to its formula; without a property, why there is none.

    `shown` is None where nothing is shown: `problem` says why, unless the requirement has no formula. `parting` has
    runs on which its formula means something else in the other reading.
    """

    requirement: Requirement
    text: str
    shown: Shown | None
    problem: str
    parting: Parting | None = None


def convert(
    requirements: Sequence[Requirement], signals: Signals, reading: Reading, budget: Budget, watch: Watch | None = None
) -> list[Imported]:
    """Each requirement as far as it can be said."""
    candidates, problems = zip(*(_candidates(each, reading) for each in requirements), strict=True)
    texts = [text for found in candidates for text in found]
    meanings = [each.meaning for each in requirements if each.meaning is not None]
    loaded = _Loaded(texts, list(dict.fromkeys(text for each in meanings for text in _texts(each))), signals)
    trials = [
        _Trial(requirement, problem, [loaded.property(text) for text in found])
        for requirement, found, problem in zip(requirements, candidates, problems, strict=True)
    ]
    while waiting := [trial for trial in trials if trial.is_open]:
        jobs = [partial(_compare, trial, loaded, reading.step or 1) for trial in waiting]
        for trial, outcome in zip(waiting, run_all(jobs, budget, watch=watch), strict=True):
            trial.outcomes.append(outcome)
    metric = [trial for trial in trials if trial.properties and trial.requirement.has_readings]
    readings = [partial(_parting, trial, loaded, reading.step) for trial in metric]
    for trial, where in zip(metric, run_all(readings, budget, watch=watch), strict=True):
        if not isinstance(where, Exceeded):
            trial.parting = where
    return [replace(trial.imported(), parting=trial.parting) for trial in trials]


class _Trial:
    """The properties that may say a requirement, those before the next one compared: the first that is equal is it."""

    def __init__(self, requirement: Requirement, problem: str, found: Sequence[PropertySpecification | str]) -> None:
        self.requirement = requirement
        self.properties = [each for each in found if not isinstance(each, str)]
        self.problem = next((each for each in found if isinstance(each, str)), requirement.problem or problem)
        self.outcomes: list[Shown | NotComparedError | Exceeded] = []
        self.parting: Parting | None = None

    @property
    def is_open(self) -> bool:
        """Whether a property is left to be compared, and none is equal yet."""
        has_meaning = self.requirement.meaning is not None
        return has_meaning and len(self.outcomes) < len(self.properties) and self._equal() is None

    def _equal(self) -> int | None:
        """The number of the first property that is equal."""
        return next((n for n, each in enumerate(self.outcomes) if isinstance(each, Shown) and each.is_equal), None)

    def imported(self) -> Imported:
        """The property that is equal, else the first, and how it relates to the formula."""
        if not self.properties:
            return Imported(self.requirement, "", None, self.problem)
        number = self._equal() or 0
        text = self.properties[number].text
        if not self.outcomes:
            return Imported(self.requirement, text, None, "")
        match self.outcomes[number]:
            case Shown() as outcome:
                return Imported(self.requirement, text, outcome, "")
            case Exceeded() as outcome:
                return Imported(self.requirement, text, None, f"the comparison {outcome}")
            case NotComparedError() as outcome:
                return Imported(self.requirement, text, None, str(outcome))


def _candidates(requirement: Requirement, reading: Reading) -> tuple[list[str], str]:
    """Properties that may say a requirement, and why others cannot."""
    if requirement.said or not requirement.forms:
        return list(requirement.said), ""
    found, problem = [], ""
    for form in requirement.forms:
        mark = next(
            (part.text for part in f.subformulas(form) if isinstance(part, f.Atom) and "@{" not in part.text), ""
        )
        try:
            found.append(Writer(reading, mark).property(form))
        except (UnsayableError, f.UndecidedError) as error:
            problem = problem or str(error) or "it depends on too many positions"
        except RecursionError:
            problem = problem or "the formula is nested too deeply"
    return list(dict.fromkeys(found)), problem


def _texts(meaning: f.Formula) -> Iterator[str]:
    """Those of the conditions in a formula."""
    return (part.text for part in f.subformulas(meaning) if isinstance(part, f.Atom))


class _Loaded:
    """Properties and conditions, compiled side by side: `states` has the conditions over the atoms of properties."""

    def __init__(self, texts: Sequence[str], atoms: Sequence[str], signals: Signals) -> None:
        conditions = [f"always ({atom})" for atom in atoms]
        head = list(signals.declarations("\n".join((*texts, *atoms))))
        lines = [*head, *(f"c_{n}: {text}" for n, text in enumerate((*texts, *conditions)))]
        self._texts, self._first = texts, len(head) + 1
        self._source = Source("import", "\n".join(lines))
        self._read = _read(self._source)
        self._properties = {each.label: each for each in self._read.sound.properties}
        self.states = {}
        self._atoms: dict[str, Sequence[Atom]] = {}
        for number, atom in enumerate(atoms, len(texts)):
            if (property_ := self._properties.get(f"c_{number}")) is not None:
                (self.states[atom],) = predicates(property_.property)
                self._atoms[atom] = property_.atoms

    def property(self, text: str) -> PropertySpecification | str:
        """The property with this text, or why it is none."""
        number = self._texts.index(text)
        found = self._properties.get(f"c_{number}")
        return found or _error_at(self._read.diagnostics, self._first + number, self._source)

    def possible(self, property_: PropertySpecification, meaning: f.Formula) -> Alphabet:
        """The letters over the atoms of a property and of its formula."""
        read = (each for text in dict.fromkeys(_texts(meaning)) for each in self._atoms.get(text, ()))
        atoms = {each.name: each for each in (*property_.atoms, *read)}
        return alphabet(atoms.values())


def _read(source: Source) -> ReadText:
    types, _ = types_for(source, ())
    return read(source, types)


def _error_at(diagnostics: Sequence[Diagnostic], line: int, source: Source) -> str:
    """The first error on a line."""
    for each in diagnostics:
        at = each.primary and source.position(each.primary.span.start).line
        if each.severity is Severity.ERROR and at == line:
            return f"{each.message} ({each.code})"
    return "something that it reads cannot be said"


def _compare(trial: _Trial, loaded: _Loaded, step: Nanoseconds) -> Shown | NotComparedError:
    """The next property of `trial`, compared with the formula."""
    property_, meaning = trial.properties[len(trial.outcomes)], trial.requirement.meaning
    assert meaning is not None
    try:
        written = of_property(property_, step)
        return compare(meaning, written, loaded.states, loaded.possible(property_, meaning))
    except NotComparedError as error:
        return error


def _parting(trial: _Trial, loaded: _Loaded, step: Nanoseconds | None) -> Parting | None:
    """Where the readings of the formula part, if there is one."""
    meaning = trial.requirement.meaning
    if meaning is None:
        return None
    return parting(meaning, step, loaded.states, loaded.possible(trial.properties[0], meaning))
