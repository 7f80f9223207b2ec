"""The second opinion: runs judged by the reference interpreters, which know nothing of automata.

Every run that is shown is judged here first, and every claim that there is no such run is tried on all short ones.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice

from ltlc.analysis.comparison.results import Candidate, Confirmation, Relation
from ltlc.analysis.comparison.shortest import representatives
from ltlc.automata.queries import words_of
from ltlc.dataclass import dataclass
from ltlc.semantics import finite
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.durations import seconds_text
from ltlc.semantics.instants import Instant
from ltlc.semantics.lasso import holds_on_lasso
from ltlc.semantics.ltl import Formula
from ltlc.semantics.words import Lasso, Letter, Word, all_words

MOST_LETTERS = 16
"""Runs are tried over all letters if there are at most this many, else over one of each kind, and so many of those."""

MOST_RUNS, LONGEST = 1000, 6
"""Runs are tried up to the length up to which there are at most so many, and no longer; those of one step always."""


class Contradiction(Exception):  # noqa: N818  not a mistake of the user's
    """The automata and the reference interpreter disagree: a fault of ltlc or of Spot."""


def holds(candidate: Candidate, run: Word | Lasso) -> bool:
    """Whether `run` satisfies `candidate`. Raises Contradiction if its formula does not mean what it should."""
    if isinstance(run, Lasso):
        return holds_on_lasso(candidate.formula, run)
    verdict = finite.holds(candidate.formula, run)
    if candidate.satisfied_by is not None and candidate.satisfied_by(run) != verdict:
        raise Contradiction(f"the formula of {candidate.name}, {candidate.formula}, is not its reading on {shown(run)}")
    return verdict


def check_separation(left: Candidate, right: Candidate, run: Word | Lasso) -> None:
    """Raise Contradiction unless `run` satisfies `left` and not `right`."""
    if not holds(left, run) or holds(right, run):
        raise Contradiction(f"{shown(run)} should satisfy {left.formula}, and not {right.formula}, but does not")


@dataclass(frozen=True)
class Trials:
    """Runs on which a claim is tried, by their length: over `letters`, finite or infinite ones."""

    letters: Sequence[Letter]
    all_letters: bool
    infinite: bool
    in_time: bool = False

    def runs(self, length: int) -> Iterator[Word | Lasso]:
        """Every word of `length` letters, or every lasso of that many, stem and loop together."""
        for word in all_words(self.letters, length):
            if self.infinite:
                yield from (Lasso(word[:k], word[k:]) for k in range(length))
            else:
                yield word

    def number(self, length: int) -> int:
        """How many `runs` there are."""
        return int(len(self.letters) ** length) * (length if self.infinite else 1)


def confirm(left: Candidate, right: Candidate, claim: Relation, trials: Trials) -> Confirmation:
    """Try `claim` on all `trials` that are short enough. Raises Contradiction if one is against it."""
    tried, length = 0, 1
    while True:
        for run in trials.runs(length):
            tried += 1
            _check(left, right, claim, run)
        if length == LONGEST or tried + trials.number(length + 1) > MOST_RUNS:
            return Confirmation(length, tried, trials.all_letters, trials.in_time)
        length += 1


def _check(left: Candidate, right: Candidate, claim: Relation, run: Word | Lasso) -> None:
    in_left, in_right = holds(left, run), holds(right, run)
    if in_left and not in_right and claim in (Relation.EQUIVALENT, Relation.STRONGER):
        raise Contradiction(f"{left.formula} should imply {right.formula}, but does not on {shown(run)}")
    if in_right and not in_left and claim in (Relation.EQUIVALENT, Relation.WEAKER):
        raise Contradiction(f"{right.formula} should imply {left.formula}, but does not on {shown(run)}")


def trial_letters(alphabet: Alphabet, formulas: Sequence[Formula]) -> tuple[list[Letter], bool]:
    """The letters over which runs are tried, and whether those are all; if not, automata of `formulas` choose them."""
    letters = list(islice(alphabet.letters(), MOST_LETTERS + 1))
    if len(letters) <= MOST_LETTERS:
        return letters, True
    machines = words_of(formulas, alphabet)
    rows = (row for machine in machines for row in machine.successors)
    kinds = dict.fromkeys(letter for row in rows for letter, _ in representatives(machines[0].letters, row))
    return list(kinds)[:MOST_LETTERS], False


def shown(run: Word | Lasso) -> str:
    """A run in one line: `{near}; {}`, and of a lasso the part that repeats in parentheses."""
    if isinstance(run, Lasso):
        stem = "".join(f"{_letter(letter)}; " for letter in run.stem)
        return f"{stem}({'; '.join(map(_letter, run.loop))}) for ever"
    return "; ".join(map(_letter, run))


def _letter(letter: Letter) -> str:
    if not isinstance(letter, Instant):
        return "{" + ", ".join(sorted(letter)) + "}"
    time = f"{seconds_text(letter.time)} s"
    return f"until {time}" if letter.by_time else f"{{{', '.join(sorted(letter))}}} at {time}"
