"""What is drawn of a property: for each expression that it compares a panel, with the limits in it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import field
from enum import Enum

from ltlc.base.source import Source
from ltlc.dataclass import dataclass
from ltlc.runtime.times import seconds
from ltlc.semantics.properties import predicates
from ltlc.semantics.timed_atoms import Age, atoms_within
from ltlc.specification.atoms import Atom
from ltlc.specification.evaluation import evaluate, number
from ltlc.specification.expressions import (
    Boolean,
    Comparison,
    Condition,
    Current,
    Expression,
    IsTrue,
    New,
    Opening,
    Relation,
    Same,
    String,
    operands,
    reads,
)
from ltlc.specification.specification import PropertySpecification
from ltlc.specification.text import text


class Drawing(Enum):
    """How a panel is drawn."""

    NUMBER = "number"
    BOOLEAN = "boolean"
    STRING = "string"
    NEWS = "news"
    AGE = "age"


@dataclass(frozen=True, slots=True)
class Limit:
    """A constant that a number is compared with in the condition `text`, its margin in it.

    Where what is equal up to a margin counts, `reach` is that margin.
    """

    text: str
    value: float
    reach: float = 0.0


@dataclass(frozen=True, slots=True)
class Bound:
    """An expression that a number is compared with in the condition `text`, moved by `shift`; `reach` as of a limit."""

    text: str
    expression: Expression
    shift: float = 0.0
    reach: float = 0.0


@dataclass(slots=True)
class Panel:
    """The values of one `expression` over time, and what they are compared with.

    `wanted` are the strings that it is compared with; `remarks` say what cannot be drawn.
    """

    expression: Expression
    kind: Drawing
    limits: list[Limit] = field(default_factory=list)
    bounds: list[Bound] = field(default_factory=list)
    wanted: list[str] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)

    @property
    def title(self) -> str:
        """The expression as it is written; of an age, the `expression` is the news that it counts from."""
        if self.kind is Drawing.AGE and isinstance(self.expression, New):
            return f"age({self.expression.signal.heard})"
        return text(self.expression)

    @property
    def drawn(self) -> Iterator[Expression]:
        """All that there is to be drawn in it."""
        yield self.expression
        yield from (bound.expression for bound in self.bounds)


def panels(specification: PropertySpecification, source: Source) -> list[Panel]:
    """The panels of a property in `source`, in the order of the text."""
    found: dict[tuple[str, Expression], Panel] = {}
    for panel in _all(specification, source):
        known = found.setdefault((panel.title, panel.expression), panel)
        if known is not panel:
            known.limits += [limit for limit in panel.limits if limit not in known.limits]
            known.bounds += panel.bounds
            known.wanted += panel.wanted
            known.remarks += [remark for remark in panel.remarks if remark not in known.remarks]
    return list(found.values())


def _all(specification: PropertySpecification, source: Source) -> Iterator[Panel]:
    """The panels of each condition; those of ages stand for the messages that they count from."""
    counted = specification.messages()
    for atom in specification.atoms:
        if atom.name not in counted:
            yield from _panels(atom.condition, _text(specification, source, atom))
    for predicate in predicates(specification.property):
        for each in atoms_within(predicate):
            if isinstance(each, Age):
                limit = Limit(each.name, seconds(each.most))
                yield Panel(specification.arrival(each.news.name), Drawing.AGE, [limit])


def _text(specification: PropertySpecification, source: Source, atom: Atom) -> str:
    """A condition with its margin applied, and as its author wrote it, if that is not the same."""
    applied, written = specification.as_written(atom.name), specification.excerpt(source, atom.span)
    is_other = "{" in written and written.replace(" ", "") != applied.replace(" ", "")
    return f"{applied}, of {written}" if is_other else applied


def _panels(condition: Condition, said: str) -> Iterator[Panel]:
    """The panels of one condition."""
    if any(isinstance(read, Opening) for side in operands(condition) for read in reads(side)):
        yield from _without_openings(condition, said)
        return
    match condition:
        case IsTrue(New() as news):
            yield Panel(news, Drawing.NEWS)
        case IsTrue(operand):
            yield Panel(operand, Drawing.BOOLEAN)
        case Same(left, right):
            yield from _same(left, right)
        case Comparison(left, relation, right, margin):
            yield _comparison(left, relation, right, margin, said)


def _comparison(left: Expression, relation: Relation, right: Expression, margin: float, said: str) -> Panel:
    """The side that varies, in front of the other one."""
    reach, shift = (margin, 0.0) if relation is Relation.EQUAL else (0.0, margin)
    if _is_constant(left):
        left, right, shift = right, left, -shift
    panel = Panel(left, Drawing.NUMBER)
    if not _is_constant(right):
        panel.bounds.append(Bound(said, right, shift, reach))
    elif not _is_constant(left):
        panel.limits.append(Limit(said, number(right, {}) + shift, reach))
    return panel


def _same(left: Expression, right: Expression) -> Iterator[Panel]:
    wanted = [evaluate(side, {}) for side in (left, right) if isinstance(side, String)]
    for side in (left, right):
        if not _is_constant(side):
            is_string = wanted or not (isinstance(left, Boolean) or isinstance(right, Boolean))
            kind = Drawing.STRING if is_string and _is_string(side) else Drawing.BOOLEAN
            yield Panel(side, kind, wanted=[str(each) for each in wanted])


def _is_string(expression: Expression) -> bool:
    return any(read.signal.type.value == "string" for read in reads(expression))


def _without_openings(condition: Condition, said: str) -> Iterator[Panel]:
    """The signals alone: the values that they had at an opening are known to the monitor only."""
    kinds = {"number": Drawing.NUMBER, "boolean": Drawing.BOOLEAN, "string": Drawing.STRING}
    for side in operands(condition):
        for read in reads(side):
            kind = kinds.get(read.signal.type.value)
            if kind is not None:
                yield Panel(Current(read.signal), kind, remarks=[f"{said}: its value at the opening is not drawn"])


def _is_constant(expression: Expression) -> bool:
    return not any(True for _ in reads(expression))
