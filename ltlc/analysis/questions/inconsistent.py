"""Can the properties hold together?"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations, islice

from ltlc.analysis.english import English
from ltlc.analysis.errors import DisagreementError, NotDecidedError
from ltlc.analysis.examples import Example, example_of_lasso
from ltlc.analysis.findings import Finding
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import listed
from ltlc.base.diagnostics import Label
from ltlc.semantics.words import Lasso

FEW = 5
"""Of so many properties, the product of their automata is made at once; of more, a run is searched for first."""

SMALL_SETS = (2, 3)
"""The sizes of the sets that are all tried."""

MOST_SETS = 20_000
"""How many of them are tried at most."""

LARGEST_PRODUCT = 24
"""A conflict of more properties is not confirmed: the product of so many automata explodes."""


def ask(study: Study, component: Sequence[Subject]) -> Iterator[Finding]:
    """An error for each smallest set that cannot; `component` are properties that share signals.

    A run that satisfies all of them settles it. Otherwise pairs and triples are tried, then properties are omitted as
    long as there is no run; once a set is found, the question is asked of the others again, without its last property.
    """
    left = list(component)
    while len(left) > 1 and not _can_hold_together(study, left):
        conflict = _small_conflict(study, left) or _conflict_by_leaving_out(study, left)
        if conflict is None and len(left) == len(component):
            raise NotDecidedError("neither a run nor a conflict was found")
        if conflict is None:
            return
        yield _finding(study, conflict)
        left.remove(conflict[-1])


def _can_hold_together(study: Study, subjects: Sequence[Subject]) -> bool:
    """Whether some run is known that satisfies all `subjects`."""
    if len(subjects) <= FEW:
        return study.can_hold(subjects)
    return common_run(study, subjects) is not None


def common_run(study: Study, subjects: Sequence[Subject]) -> Lasso | None:
    """A short run that satisfies all `subjects`; None if none is found."""
    from ltlc.analysis.lassos import find_lasso

    return find_lasso([subject.formula for subject in subjects], study.alphabet(subjects))


def _small_conflict(study: Study, subjects: Sequence[Subject]) -> tuple[Subject, ...] | None:
    """A pair or triple that no run satisfies."""
    sets = (chosen for size in SMALL_SETS for chosen in combinations(subjects, size))
    for chosen in islice(sets, MOST_SETS):
        if _is_connected(study, chosen) and not study.can_hold(chosen):
            return chosen
    return None


def _conflict_by_leaving_out(study: Study, subjects: Sequence[Subject]) -> tuple[Subject, ...] | None:
    """A set that no run satisfies, and of which a run satisfies all but any one; None if that is not confirmed."""
    from ltlc.analysis.lassos import LENGTHS, LassoSearch

    formulas = [subject.formula for subject in subjects]
    searches = [LassoSearch(formulas, study.alphabet(subjects), length) for length in LENGTHS]
    kept = dict.fromkeys(range(len(subjects)), True)
    for number in range(len(subjects)):
        rest = {other: True for other in kept if other != number}
        if not any(search.find(rest) for search in searches):
            kept = rest
    chosen = tuple(subjects[number] for number in kept)
    return chosen if len(chosen) <= LARGEST_PRODUCT and not study.can_hold(chosen) else None


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
        help="change one of them; if any one is omitted, the rest can hold",
        example=_without(study, most, last),
    )


def _without(study: Study, kept: Sequence[Subject], left_out: Subject) -> Example | None:
    """A run that satisfies the properties that are `kept`."""
    run = common_run(study, kept)
    caption = f"a run that satisfies all but `{left_out.label}`"
    return None if run is None else example_of_lasso(study.setting(*kept), run, caption)
