"""Can the properties hold together?"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

from ltlc.analysis.english import English
from ltlc.analysis.errors import DisagreementError, NotDecidedError
from ltlc.analysis.examples import Example, example_of_lasso
from ltlc.analysis.findings import Finding
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import listed
from ltlc.diagnostics import Label
from ltlc.semantics.words import Lasso

LENGTHS = (1, 2, 3, 5)
"""How many different steps the runs have that are tried first."""

LARGEST_PRODUCT = 5
"""Products of more automata than this are not tried: they explode."""

MOST_SETS = 20_000
"""How many sets of properties are looked at before the question is given up."""


def ask(study: Study, component: Sequence[Subject]) -> Iterator[Finding]:
    """An error for each smallest set that cannot; `component` are properties that share signals.

    A run that satisfies all of them settles it. Otherwise pairs are tried, then triples, and so on; once a set is
    found, the question is asked of the others again, without its last property.
    """
    left = list(component)
    while len(left) > 1 and not _can_hold_together(study, left):
        conflict = _smallest_conflict(study, left)
        if conflict is None:
            raise NotDecidedError("no run and no conflict was found")
        yield _finding(study, conflict)
        left.remove(conflict[-1])


def _can_hold_together(study: Study, subjects: Sequence[Subject]) -> bool:
    """Whether some run is known that satisfies all `subjects`."""
    if len(subjects) <= LARGEST_PRODUCT:
        return study.can_hold(subjects)
    return common_run(study, subjects) is not None


def common_run(study: Study, subjects: Sequence[Subject]) -> Lasso | None:
    """A short run that satisfies all `subjects`; None if none is found."""
    from ltlc.analysis.lassos import find_lasso

    return find_lasso([subject.formula for subject in subjects], study.alphabet(subjects), LENGTHS)


def _smallest_conflict(study: Study, subjects: Sequence[Subject]) -> tuple[Subject, ...] | None:
    """A smallest set that no run satisfies."""
    tried = 0
    for size in range(2, min(LARGEST_PRODUCT, len(subjects)) + 1):
        for chosen in combinations(subjects, size):
            tried += 1
            if tried > MOST_SETS:
                return None
            if _is_connected(study, chosen) and not study.can_hold(chosen):
                return chosen
    return None


def _is_connected(study: Study, subjects: Sequence[Subject]) -> bool:
    """Whether the properties hang together by signals; otherwise a smaller set would be in conflict."""
    numbers = {subject.number for subject in subjects}
    reached = {subjects[0].number}
    frontier = set(reached)
    while frontier:
        frontier = {n for number in frontier for n in study.neighbours[number] & numbers} - reached
        reached |= frontier
    return reached == numbers


def _finding(study: Study, conflict: Sequence[Subject]) -> Finding:
    first, *others = conflict
    *most, last = conflict
    names = listed([f"`{subject.label}`" for subject in conflict])
    if common_run(study, conflict) is not None:
        raise DisagreementError("whether properties can hold together")
    return Finding(
        "LTL601",
        first.specification.span,
        f"{names} cannot hold together: every run violates one of them",
        label=English(first.specification).clause(),
        secondary=tuple(Label(s.specification.span, English(s.specification).clause()) for s in others),
        help="change one of them; without any one of them, the rest can hold",
        example=_without(study, most, last),
    )


def _without(study: Study, kept: Sequence[Subject], left_out: Subject) -> Example | None:
    """A run that satisfies the properties that are `kept`."""
    run = common_run(study, kept)
    caption = f"a run that satisfies all but `{left_out.label}`"
    return None if run is None else example_of_lasso(study.setting(*kept), run, caption)
