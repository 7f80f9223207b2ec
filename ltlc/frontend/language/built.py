"""Properties with the places of their parts, and how they are put together."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import field, replace
from functools import partial
from itertools import count

from ltlc.base.diagnostics import Label
from ltlc.base.source import Span
from ltlc.dataclass import dataclass
from ltlc.frontend.syntax import tree as syntax
from ltlc.semantics import ltl
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.ltl import Formula
from ltlc.semantics.properties import Property
from ltlc.semantics.timed_atoms import News
from ltlc.specification import timed
from ltlc.specification.atoms import Atom, placed
from ltlc.specification.expressions import Condition, IsTrue, New, Signal, openings, operands
from ltlc.specification.specification import Path, topics_of
from ltlc.specification.text import opening_text


@dataclass(frozen=True, slots=True)
class Built:
    """A property or state predicate, its place, and its parts in the order of `specification.parts`."""

    node: Property | Formula
    span: Span
    parts: tuple[Built, ...] = ()

    @property
    def formula(self) -> Formula:
        """The node, which is known to be a state predicate."""
        assert isinstance(self.node, Formula)
        return self.node

    @property
    def property(self) -> Property:
        """The node, which is known to be a property."""
        assert isinstance(self.node, Property)
        return self.node

    def spans(self, path: Path = ()) -> Iterator[tuple[Path, Span]]:
        """The place of every part, by its path."""
        yield path, self.span
        for index, part in enumerate(self.parts):
            yield from part.spans((*path, index))


def apply(constructor: Callable[..., Property | Formula], span: Span, *parts: Built) -> Built:
    """`constructor` of the nodes of `parts`."""
    return Built(constructor(*(part.node for part in parts)), span, parts)


def truth(value: bool, span: Span) -> Built:
    """The state predicate `true` or `false`."""
    true = Built(ltl.TRUE, span)
    return true if value else apply(ltl.Not, span, true)


def implication(span: Span, left: Built, right: Built) -> Built:
    """The state predicate `left implies right`."""
    return apply(ltl.Or, span, apply(ltl.Not, left.span, left), right)


def equivalence(span: Span, left: Built, right: Built) -> Built:
    """The state predicate that holds where both or neither of `left` and `right` do; `p == true` is p."""
    for constant, other in ((left, right), (right, left)):
        if constant.node == ltl.TRUE:
            return replace(other, span=span)
        if constant.node == ltl.FALSE:
            return apply(ltl.Not, span, other)
    neither = apply(ltl.And, span, apply(ltl.Not, left.span, left), apply(ltl.Not, right.span, right))
    return apply(ltl.Or, span, apply(ltl.And, span, left, right), neither)


@dataclass(frozen=True)
class Context:
    """Where a part of a property stands.

    `polarity` is 1 under an even number of negations, -1 under an odd number, 0 where neither side is in favour of the
    property. `place` is the use of the association that the part belongs to, if it does. `atoms` collects the
    conditions of the property, which is called `label`, by their names. `scope` is the number of the scope around, as
    `Opening` counts; `numbers` has those that are left. `anew` says that the part is judged at every step of that
    scope, `overlapping` that the scope may be open several times; it is so behind each `implies` of `triggers`.
    `may_be_empty` says that the part may be judged on a segment without steps, as before an `until` or in an interval.
    """

    label: str = ""
    atoms: dict[str, Atom] = field(default_factory=dict)
    numbers: Iterator[int] = field(default_factory=partial(count, 1))
    polarity: int = 1
    place: Span | None = None
    scope: int = 0
    anew: bool = False
    triggers: tuple[syntax.Connective, ...] = ()
    overlapping: bool = False
    may_be_empty: bool = False

    def negated(self) -> Context:
        """The context of what stands under one more negation."""
        return replace(self, polarity=-self.polarity)

    def unfavoured(self) -> Context:
        """The context of what stands on both sides of a negation."""
        return replace(self, polarity=0)

    def inside(self, use: Span) -> Context:
        """The context of what an association stands for that is used at `use`."""
        return replace(self, place=self.place or use)

    def opened(self) -> Context:
        """The context of what stands in one more scope."""
        overlapping = self.anew or self.overlapping
        scope = next(self.numbers)
        return replace(self, scope=scope, anew=False, triggers=(), overlapping=overlapping, may_be_empty=False)

    def maybe_empty(self) -> Context:
        """The context of what is judged before an event, or in an interval: on steps of which there may be none."""
        return replace(self, may_be_empty=True)

    def each_step(self) -> Context:
        """The context of what is judged at every step of the scope around."""
        return replace(self, anew=True, may_be_empty=False)

    def implied(self, node: syntax.Connective) -> Context:
        """The context of what stands behind the `implies` of `node`."""
        return replace(self, triggers=(*self.triggers, node)) if self.anew else self

    def at(self, span: Span) -> Span:
        """The place of a part written at `span`: for an association, that of its use."""
        return self.place or span

    def inner(self, span: Span) -> tuple[Label, ...]:
        """What to show beside a finding at the use of an association: the part of it that is meant."""
        return (Label(span, "this part of it"),) if self.place else ()

    def atom(self, name: str, condition: Condition, span: Span) -> Built:
        """The atom `name`; the same name has the same condition, and reads the same scope's opening."""
        if any(True for operand in operands(condition) for _ in openings(operand)):
            name = name.replace(", opening}", f", {opening_text(self.scope, self.label)}}}")
            condition = placed(condition, self.scope, self.label)
        self.atoms.setdefault(name, Atom(name, condition, span))
        return Built(ltl.Atom(name), span)

    def heard(self, signal: Signal) -> Signal:
        """The signal by which the property calls the messages on the topic of `signal`: the first that it names."""
        named = [atom.condition.operand for atom in self.atoms.values() if isinstance(atom.condition, IsTrue)]
        arrivals = [part.signal for part in named if isinstance(part, New)]
        return next((other for other in arrivals if topics_of(other) == topics_of(signal)), signal)

    def news(self, signal: Signal, span: Span) -> Built:
        """The timed atom that a message arrives, which the run reports like the other atoms."""
        return Built(self._arrival(timed.news(signal), signal, span), span)

    def age(self, signal: Signal, duration: Nanoseconds, span: Span, *, strictly: bool) -> Built:
        """The timed atom that the age of `signal` is at most `duration`, and what it counts from."""
        young = timed.age(signal, duration, strictly=strictly)
        self._arrival(young.news, signal, span)
        return Built(young, span)

    def _arrival(self, atom: News, signal: Signal, span: Span) -> News:
        self.atoms.setdefault(atom.name, Atom(atom.name, IsTrue(New(signal)), span))
        return atom
