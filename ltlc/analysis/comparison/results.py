"""What a comparison is asked and what it answers, as data; the forms of output are made from it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field
from enum import Enum
from functools import cached_property
from typing import Any

from ltlc.automata.queries import Size, TemporalClass
from ltlc.base.limits import Exceeded
from ltlc.dataclass import dataclass
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.ltl import Formula, conjunction
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.timed_atoms import TimedAtom, news_of, timed_atoms
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Lasso, Word

Values = Mapping[str, Any]
"""The value of each signal at a step."""


@dataclass(frozen=True)
class Candidate:
    """One of the formulas that are compared, under the name of its encoding or of its own.

    `satisfied_by`, where there is one, says on finite words what the formula is meant to say, from a definition of
    another kind: the reading of the sentence.
    """

    name: str
    formula: Formula
    satisfied_by: Callable[[Word], bool] | None = None


def _no_values(_word: Word, _loop: int | None) -> None:
    """Nothing is known of values."""


@dataclass(frozen=True)
class Question:
    """A group of formulas that are compared with one another: a sentence's encodings, or formulas as given.

    Monitors are made over `alphabet`; formulas are related on runs over `possible`, which may know more of what numbers
    allow: that nothing is both within 1 m of a sign at x = 10 and beyond x = 45.

    `undefined` has the encodings that do not define this sentence, and why. `values` gives, for the letters of a
    run and the step from which on it repeats, if it does, values of the signals at each step, if it finds any.
    """

    label: str
    line: int | None
    text: str
    alphabet: Alphabet
    possible: Alphabet
    candidates: tuple[Candidate, ...]
    undefined: Mapping[str, str] = field(default_factory=dict)
    values: Callable[[Word, int | None], Sequence[Values] | None] = _no_values

    @cached_property
    def atoms(self) -> tuple[str, ...]:
        """What a run has at each step: the atoms that hold, and the news."""
        return (*self.alphabet.atoms, *(news.name for news in news_of(self._formula)))

    @cached_property
    def timed(self) -> tuple[TimedAtom, ...]:
        """The atoms of its formulas that time and the past decide."""
        return timed_atoms(self._formula)

    @cached_property
    def _formula(self) -> Formula:
        return conjunction(candidate.formula for candidate in self.candidates)


class Relation(Enum):
    """How the runs of the left formula relate to those of the right; 'stronger' says that left implies right."""

    EQUIVALENT = "equivalent"
    STRONGER = "stronger"
    WEAKER = "weaker"
    INCOMPARABLE = "incomparable"

    @staticmethod
    def of(left_only: bool, right_only: bool) -> Relation:
        """The relation, from whether some run satisfies the left, or the right, formula only."""
        if left_only:
            return Relation.INCOMPARABLE if right_only else Relation.WEAKER
        return Relation.STRONGER if right_only else Relation.EQUIVALENT


@dataclass(frozen=True, slots=True)
class SeparatingRun:
    """A run that satisfies one formula and not the other, with the verdicts of both monitors after each step.

    Of a run in time the letters are instants, without those at which only time has passed and no verdict changes.
    From step `loop` on, an infinite run repeats itself forever; a finite one has None there. `is_shortest` says
    whether none with fewer steps exists.
    """

    letters: Word
    loop: int | None
    left_verdicts: tuple[Verdict, ...]
    right_verdicts: tuple[Verdict, ...]
    is_shortest: bool = True

    @property
    def word(self) -> Word | Lasso:
        """The run as a word of its kind."""
        if self.loop is None:
            return self.letters
        return Lasso(self.letters[: self.loop], self.letters[self.loop :])


@dataclass(frozen=True, slots=True)
class Confirmation:
    """Both formulas were judged by the reference interpreter on all `runs` runs of up to `length` steps.

    `all_letters` says whether those were runs over every letter that exists, or over one of each kind; `in_time`,
    whether with steps at each bound, and just past it.
    """

    length: int
    runs: int
    all_letters: bool
    in_time: bool = False


@dataclass(frozen=True, slots=True)
class Related:
    """How two formulas relate on the runs of one kind, finite or infinite."""

    relation: Relation
    left_only: SeparatingRun | None
    right_only: SeparatingRun | None
    confirmation: Confirmation


class Runs(Enum):
    """The kinds of runs on which formulas are compared."""

    INFINITE = "infinite"
    FINITE = "finite"


@dataclass(frozen=True, slots=True)
class Comparison:
    """How two formulas of a question relate on each kind of runs asked for, or the limit that was met."""

    left: str
    right: str
    related: Mapping[Runs, Related | Exceeded]


class Monitorability(Enum):
    """Whether a permanent verdict can still come (Pnueli and Zaks 2006): from every state, from some, or from none."""

    ALWAYS = "always"
    SOMETIMES = "sometimes"
    NEVER = "never"


@dataclass(frozen=True, slots=True)
class Monitored:
    """A formula's monitor, the time that its translation took, and what it can decide.

    `earliest_violation` is a shortest run, of one step at least, after which the verdict is `violated`, if any is.
    """

    monitor: Monitor
    seconds: float
    edges: int
    monitorability: Monitorability
    earliest_violation: Word | None


@dataclass(frozen=True, slots=True)
class Measured:
    """What one formula costs and allows; where a limit was met, that limit. `size` counts nodes of core LTL."""

    name: str
    formula: Formula
    size: int
    temporal_class: TemporalClass | Exceeded
    monitored: Monitored | Exceeded
    nondeterministic: Size | Exceeded
    deterministic: Size | Exceeded


@dataclass(frozen=True)
class Answer:
    """The answer to one question."""

    question: Question
    measured: tuple[Measured, ...]
    comparisons: tuple[Comparison, ...]


@dataclass(frozen=True, slots=True)
class Parting:
    """The first step, from 0, after which the verdicts of two candidates differ.

    At its time or, if that is `by_time`, later, when nothing but time has passed. `values` are those of the step.
    """

    left: str
    right: str
    step: int
    left_verdict: Verdict
    right_verdict: Verdict
    time: Nanoseconds
    by_time: bool
    values: Values


@dataclass(frozen=True, slots=True)
class Ending:
    """With the bounds from `least` to `most` (None: and all above) a recording ends with `verdict`.

    `step` comes in time for these, and not for those below, at `time`, with `values`; None where no step decides.
    """

    least: Nanoseconds
    most: Nanoseconds | None
    verdict: Verdict
    step: int | None = None
    time: Nanoseconds | None = None
    values: Values = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class OtherBounds:
    """What a recording would have shown, judged as each candidate in `names`, with other bounds on the part `text`.

    The bound that is written is `duration`. Without `endings`, `obstacle` says why they are not known.
    """

    names: tuple[str, ...]
    text: str
    duration: Nanoseconds
    endings: tuple[Ending, ...]
    obstacle: str = ""


@dataclass(frozen=True, slots=True)
class Recorded:
    """What one recording shows of one question.

    It has the verdict of each candidate at the end, where they part, and what other bounds on time would have shown.
    """

    recording: str
    steps: int
    verdicts: dict[str, Verdict]
    partings: tuple[Parting, ...]
    bounds: tuple[OtherBounds, ...] = ()
