"""Does the verdict depend on how often, and in which order, messages happen to arrive?"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ltlc.analysis.findings import Finding
from ltlc.analysis.questions.exact_equality import is_change, measured_equalities
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import listed
from ltlc.base.diagnostics import Fix, Help, Label
from ltlc.base.source import Span
from ltlc.specification.arenas import is_in_game
from ltlc.specification.atoms import Atom
from ltlc.specification.expressions import (
    Comparison,
    Condition,
    Count,
    Expression,
    IsTrue,
    Opening,
    Past,
    Recent,
    Relation,
    operands,
    reads,
)
from ltlc.specification.specification import fields
from ltlc.specification.text import as_written, text


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """Without `_rate_`, a warning for history, and for equality between topics that arrive one after the other.

    None for what compares a sample with the one before, and nothing else: that needs no clock; and for what a guard
    keeps, of its own run. Measured numbers need
    a margin first, which `exact-equality` reports.
    """
    specification = study.specification
    is_kept = bool(specification.guards) and is_in_game(subject.specification, specification.guards)
    if specification.rate is not None or is_kept:
        return
    atoms = [atom for atom in subject.specification.atoms if not is_change(atom.condition)]
    historical = [(atom, past) for atom in atoms for past in _history_in(atom.condition)]
    if historical:
        yield _history(historical)
    with_history = {atom for atom, _ in historical}
    apart = [atom for atom in atoms if atom not in with_history and _compares_topics(atom.condition)]
    measured = measured_equalities(apart)
    yield from (_apart(atom) for atom in apart if atom not in measured)


def _history_in(condition: Condition) -> Iterator[Past | Recent]:
    """The history that `condition` reads; of windows, those of which it does not say how many samples are so."""
    for side in operands(condition):
        for read in reads(side):
            if isinstance(read, Past) or (isinstance(read, Recent) and not isinstance(side, Count)):
                yield read


def _history(historical: Sequence[tuple[Atom, Past | Recent]]) -> Finding:
    """One finding for all history in a property, at the first place."""
    first, past = historical[0]
    samples = f"{past.samples} message{'' if past.samples == 1 else 's'} ago, however long ago that is"
    if isinstance(past, Recent):
        samples = f"of {past.samples + 1} messages, however long they take"
    others = {atom.span: Label(atom.span, "so does this") for atom, _ in historical if atom.span != first.span}
    return Finding(
        "LTL521",
        first.span,
        f"`{text(past)}` is {samples}: the verdict depends on how often they arrive",
        secondary=tuple(others.values()),
        help=Help(
            "set `_rate_`, for example `_rate_ = 30`: then a sample is a thirtieth of a second",
            (Fix("add `_rate_ = 30` as the first line", ((Span(0, 0), "_rate_ = 30\n"),)),),
        ),
    )


def _compares_topics(condition: Condition) -> bool:
    """Whether exact equality is asked of values of which one arrives before the other."""
    if isinstance(condition, IsTrue):
        return False
    if isinstance(condition, Comparison) and (condition.relation is not Relation.EQUAL or condition.margin > 0):
        return False
    left, right = _topics(condition.left), _topics(condition.right)
    return bool(left and right and left != right)


def _apart(atom: Atom) -> Finding:
    read = sorted({topic for side in operands(atom.condition) for topic in _topics(side)})
    return Finding(
        "LTL521",
        atom.span,
        f"`{as_written(atom.name)}` compares topics that do not arrive together: between two messages it can fail",
        label=f"reads {listed(read)}",
        help="set `_rate_`, or compare with a margin",
    )


def _topics(expression: Expression) -> set[str]:
    """The topics whose messages change what it is; a value at an opening stays."""
    read = (value for value in reads(expression) if not isinstance(value, Opening))
    return {field.topic for value in read for _, field in fields(value.signal)}
