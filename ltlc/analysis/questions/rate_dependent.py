"""Does the verdict depend on how often, and in which order, messages happen to arrive?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.findings import Finding
from ltlc.analysis.groups import inputs_of
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import listed
from ltlc.language.expressions import Expression, Past, inputs
from ltlc.language.specification import Atom, Comparison, IsTrue, Relation, fields
from ltlc.language.values import text


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """Without `_rate_`, a warning for history, and for equality between topics that arrive one after the other."""
    if study.specification.rate is not None:
        return
    for atom in subject.specification.atoms:
        past = next((value for value in inputs_of(atom.condition) if isinstance(value, Past)), None)
        if past is not None:
            yield _history(atom, past)
        elif _compares_topics(atom):
            yield _apart(atom)


def _history(atom: Atom, past: Past) -> Finding:
    samples = f"{past.samples} message{'' if past.samples == 1 else 's'}"
    return Finding(
        "LTL521",
        atom.span,
        f"`{text(past)}` is {samples} ago, however long that is: `{atom.name}` depends on how often they arrive",
        help="set `_rate_`, for example `_rate_ = 30`: then a sample is a thirtieth of a second",
    )


def _compares_topics(atom: Atom) -> bool:
    """Whether exact equality is asked of values of which one arrives before the other."""
    condition = atom.condition
    if isinstance(condition, IsTrue):
        return False
    if isinstance(condition, Comparison) and (condition.relation is not Relation.EQUAL or condition.margin > 0):
        return False
    left, right = _topics(condition.left), _topics(condition.right)
    return bool(left and right and left != right)


def _apart(atom: Atom) -> Finding:
    read = sorted({field.topic for value in inputs_of(atom.condition) for _, field in fields(value.signal)})
    return Finding(
        "LTL521",
        atom.span,
        f"`{atom.name}` compares topics that arrive one after the other: between two messages it can fail",
        label=f"reads {listed(read)}",
        help="set `_rate_`, or compare with a margin",
    )


def _topics(expression: Expression) -> set[str]:
    return {field.topic for value in inputs(expression) for _, field in fields(value.signal)}
