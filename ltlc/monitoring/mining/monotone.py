"""Whether more runs satisfy a property, or fewer, as its parameter grows.

It is read off two trees of the same property with different values in that one place. A connective or a keyword hands
on the way of its part or turns it round; where the parameter stands on both sides, or decides where a scope begins or
ends, nothing can be said.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ltlc.semantics import ltl, properties
from ltlc.semantics.ltl import Atom, Formula
from ltlc.semantics.properties import Property, children
from ltlc.semantics.timed_atoms import Historically, Occurred, TimedAtom, duration_of, operands
from ltlc.specification.expressions import Comparison, Condition, Count, Expression, Number, Relation
from ltlc.specification.numbers import numbers_of
from ltlc.specification.specification import PropertySpecification
from ltlc.specification.wire import Numbers

WEAKER, STRONGER, NEITHER = 1, -1, 0
"""What satisfied a property satisfies it with a larger value, too; the other way round; it has no such value."""

Conditions = Mapping[str, Condition]
"""What atoms are, by their names."""


class NotMonotoneError(Exception):
    """With a larger value, a property may become true of some runs and false of others.

    `reason` says why, `help` what to write instead.
    """

    def __init__(self, reason: str, help: str) -> None:
        super().__init__(reason)
        self.reason = reason
        self.help = help


class Monotony:
    """How a property depends on its parameter, from `smaller` and `larger`, which have different values there.

    `direction` is WEAKER or STRONGER; `numbers` are those among which is what is compared with the parameter, None if
    that is a margin or a duration. Raises NotMonotoneError.
    """

    def __init__(self, smaller: PropertySpecification, larger: PropertySpecification) -> None:
        self.numbers: Numbers | None = None
        conditions = [{atom.name: atom.condition for atom in each.atoms} for each in (smaller, larger)]
        self.direction = self._property(smaller.property, larger.property, *conditions)
        if self.direction == NEITHER:
            raise NotMonotoneError("it is compared with a constant", "compare it with something measured")

    def _property(self, one: Property, other: Property, *conditions: Conditions) -> int:
        match one, other:
            case properties.Now(a) | properties.Throughout(a), properties.Now(b) | properties.Throughout(b):
                return self._predicate(a, b, *conditions)
            case properties.Within(a, body), properties.Within(b, _) if a != b:
                return _of_longer(body)
        if _events(one) != _events(other):
            reason = "it decides where a scope begins or ends, which can help or harm the body"
            raise NotMonotoneError(reason, "give the event a value, and write `?` in the body")
        ways = [self._property(a, b, *conditions) for a, b in zip(children(one), children(other), strict=True)]
        if isinstance(one, properties.Not | properties.Never | properties.Implies):
            ways[0] = -ways[0]
        return _together(ways)

    def _predicate(self, one: Formula, other: Formula, *conditions: Conditions) -> int:
        if one == other:
            return NEITHER
        if isinstance(one, Occurred) and isinstance(other, Occurred) and one.within == other.within:
            if one.begins:
                reason = "it decides how often something begins, which may be more or less"
                raise NotMonotoneError(reason, "count a condition on messages, `new s and …`")
            return self._predicate(one.operand, other.operand, *conditions)
        if isinstance(one, TimedAtom) and isinstance(other, TimedAtom):
            if duration_of(one) != duration_of(other):
                return STRONGER if isinstance(one, Historically) else WEAKER
            parts = zip(operands(one), operands(other), strict=True)
        elif isinstance(one, Atom) and isinstance(other, Atom):
            return self._condition(*(found[atom.name] for found, atom in zip(conditions, (one, other), strict=True)))
        elif type(one) is not type(other):
            return NEITHER
        else:
            parts = zip(ltl.children(one), ltl.children(other), strict=True)
        found = _together(self._predicate(a, b, *conditions) for a, b in parts)
        return -found if isinstance(one, ltl.Not) else found

    def _condition(self, one: Condition, other: Condition) -> int:
        if one == other or not (isinstance(one, Comparison) and isinstance(other, Comparison)):
            return NEITHER
        if one.relation is Relation.EQUAL:
            if one.left == other.left and one.right == other.right:
                return WEAKER
            reason = "`==` holds for one number, and not for those on either side"
            raise NotMonotoneError(reason, "write an ordering, or mine the margin: `=={?} 0`")
        left = self._expression(one.left, other.left, one.right)
        right = self._expression(one.right, other.right, one.left)
        grows = right - left
        return grows if one.relation in (Relation.LESS, Relation.AT_MOST) else -grows

    def _expression(self, one: Expression, other: Expression, beside: Expression) -> int:
        """WEAKER if the value of the expression grows with the parameter."""
        match one, other:
            case Number(a), Number(b) if a != b:
                self.numbers = numbers_of(beside)
                return WEAKER if b > a else STRONGER
            case Count(a), Count(b):
                return self._predicate(a, b, dict(one.conditions), dict(other.conditions))
            case _:
                pass
        if one != other:
            raise NotMonotoneError("it is only a part of one side", "make `?` one side of the comparison")
        return NEITHER


def _events(property_: Property) -> tuple[Formula, ...]:
    match property_:
        case properties.After(event, _) | properties.Until(event, _):
            return (event,)
        case properties.AfterUntil(opening, closing, _):
            return opening, closing
        case _:
            return ()


def _together(ways: Iterable[int]) -> int:
    """The way of what several parts make."""
    found = {way for way in ways if way != NEITHER}
    if len(found) > 1:
        reason = "it occurs both under a negation and outside one, so a larger value both helps and harms"
        raise NotMonotoneError(reason, "split the property in two, with the `?` in one of them")
    return found.pop() if found else NEITHER


def _of_longer(body: Property) -> int:
    """The way of `within D, body` as D grows."""
    stays = {longer for longer in (True, False) if _stays(body, longer)}
    if not stays:
        reason = "with more time, the bounded property can become true as well as false"
        raise NotMonotoneError(reason, "put bounds on `eventually` and on `always` or `never` into separate properties")
    if len(stays) > 1:
        reason = "the bounded property is about a single step, so the bound makes no difference"
        raise NotMonotoneError(reason, "omit the bound")
    return WEAKER if stays.pop() else STRONGER


def _stays(body: Property, longer: bool) -> bool:
    """Whether `body`, where it is true of a part of a run, surely is of a `longer` one with that beginning, or shorter.

    What reads its first step only would, of any that is not empty; no bound makes a difference to it.
    """
    match body:
        case properties.Now():
            return True
        case properties.Throughout():
            return not longer
        case properties.Not(operand):
            return _stays(operand, not longer)
        case properties.Implies(left, right):
            return _stays(left, not longer) and _stays(right, longer)
        case properties.Never(operand):
            return not longer and _stays(operand, not longer)
        case properties.Eventually():
            return longer and _stays(body.operand, longer)
        case properties.Until():
            return longer
        case properties.Always() | properties.After() | properties.AfterUntil() if longer:
            return False
    return all(_stays(part, longer) for part in children(body))
