"""Properties in plain English: what has to happen when, in the words of their signals."""

from __future__ import annotations

import re

from ltlc.semantics import ltl
from ltlc.semantics import properties as p
from ltlc.semantics.ltl import Formula
from ltlc.semantics.properties import Property
from ltlc.specification.atoms import Atom, Comparison, IsTrue, Relation, Same
from ltlc.specification.expressions import Call, Current, Expression, Function, Number, Past, Signal, Slope
from ltlc.specification.specification import PropertySpecification
from ltlc.specification.text import number_text, text

_PRIMITIVES = (
    (r"(\w+)\.distance\.(\w+)", "the distance from {} to {}"),
    (r"(\w+)\.distanceZ\.(\w+)", "the distance in space from {} to {}"),
    (r"(\w+)\.velocity", "the speed of {}"),
    (r"(\w+)\.velocity_angular", "the angular speed of {}"),
    (r"(\w+)\.position\.([xyz])", "the {1} position of {0}"),
    (r"(\w+)\.velocity(?:\.linear)?\.([xyz])", "the velocity of {0} along {1}"),
    (r"(\w+)\.velocity\.angular\.([xyz])", "the angular velocity of {0} about {1}"),
    (r"(\w+)\.orientation", "the yaw of {}"),
    (r"(\w+)\.orientation\.(roll|pitch|yaw)", "the {1} of {0}"),
    (r"(\w+)\.orientation_between\.(\w+)", "the angle between the orientations of {} and {}"),
    (r"(\w+)\.(localization|velocity|orientation)_error", "the {1} error of {0}"),
)
"""What the simulation primitives are called."""

_RELATIONS = {
    Relation.LESS: ("is less than", "is at least"),
    Relation.AT_MOST: ("is at most", "is more than"),
    Relation.GREATER: ("is more than", "is at most"),
    Relation.AT_LEAST: ("is at least", "is less than"),
    Relation.EQUAL: ("is exactly", "is not exactly"),
}
"""How a comparison reads when it holds, and when it does not."""

_FOLDS = {Function.ABS: "absolute value", Function.MIN: "smallest", Function.MAX: "largest"}
"""What a function of one value is called; the smallest and the largest are those of an array."""


class English:
    """Puts the parts of one property into words."""

    def __init__(self, specification: PropertySpecification) -> None:
        self._atoms = {atom.name: atom for atom in specification.atoms}
        self._property = specification.property

    def sentence(self) -> str:
        """The property as one sentence."""
        words = self.clause()
        return f"{words[0].upper()}{words[1:]}."

    def clause(self) -> str:
        """The property as a part of a sentence."""
        return self._clause(self._property, "")

    def _clause(self, node: Property, later: str) -> str:
        """`node` as a clause; `later` says from when on it is judged, if not from the start."""
        match node:
            case p.Now(predicate):
                return self.predicate(predicate)
            case p.Throughout(predicate) | p.Always(p.Now(predicate)):
                return f"at every step{later}, {self._rule(predicate)}"
            case p.Never(p.Now(predicate)):
                return f"at no step{later}: {self.predicate(predicate)}"
            case p.Eventually(p.Now(predicate)):
                return f"at some step{later}, {self.predicate(predicate)}"
            case p.Always(p.Implies(p.Now(predicate), then)):
                then_text = self._clause(then, " from there on")
                return f"at every step{later}, if {self.predicate(predicate)}, then {then_text}"
            case p.Always(operand):
                return f"at every step{later}, this holds: {self._clause(operand, ' from there on')}"
            case p.Never(operand):
                return f"at no step{later} does this hold: {self._clause(operand, ' from there on')}"
            case p.Eventually(operand):
                return f"at some step{later}, this holds: {self._clause(operand, ' from there on')}"
            case p.Not(operand):
                return f"it is not so that {self._side(operand, later)}"
            case p.And():
                return ", and ".join(self._side(part, later) for part in _joined(node, p.And))
            case p.Or():
                return "either " + ", or ".join(self._side(part, later) for part in _joined(node, p.Or))
            case p.Implies(left, right):
                return f"if {self._side(left, later)}, then {self._side(right, later)}"
            case _:
                return self._scope(node, later)

    def _side(self, node: Property, later: str) -> str:
        """What a connective joins, or negates; in parentheses if it is one itself."""
        words = self._clause(node, later)
        return f"({words})" if isinstance(node, p.And | p.Or | p.Implies) else words

    def _scope(self, node: Property, later: str) -> str:
        """A scope keyword as a clause."""
        match node:
            case p.After(event, body):
                first = f"once {self.predicate(event)}{' for the first time' if not later else ''}"
                return f"{first}: {self._clause(body, ' from then on')}"
            case p.Until(event, body):
                return f"there is a step{later} at which {self.predicate(event)}; before that, {self._clause(body, '')}"
            case p.AfterUntil(opening, closing, body):
                ends = f"opens when {self.predicate(opening)} and lasts until {self.predicate(closing)}"
                return f"in each episode that {ends}: {self._clause(body, '')}"
        raise TypeError(f"not a property: {node!r}")

    def _rule(self, predicate: Formula) -> str:
        """A state predicate that holds at every step, an implication as such."""
        match predicate:
            case ltl.Or(ltl.Not(condition), then):
                return f"if {self.predicate(condition)}, then {self.predicate(then, ltl.Or)}"
            case _:
                return self.predicate(predicate)

    def predicate(self, formula: Formula, context: type[Formula] | None = None) -> str:
        """A state predicate in words; in parentheses where `and` and `or` meet."""
        match formula:
            case ltl.Truth():
                return "true holds"
            case ltl.Not(ltl.Truth()):
                return "false holds"
            case ltl.Atom(name):
                return atom_text(self._atoms[name], holds=True)
            case ltl.Not(ltl.Atom(name)):
                return atom_text(self._atoms[name], holds=False)
            case ltl.Not(operand):
                return f"not ({self.predicate(operand)})"
            case ltl.And(left, right) | ltl.Or(left, right):
                kind = type(formula)
                word = "and" if kind is ltl.And else "or"
                words = f"{self.predicate(left, kind)} {word} {self.predicate(right, kind)}"
                return words if context in (None, kind) else f"({words})"
        raise TypeError(f"not a state predicate: {formula!r}")


def _joined(node: Property, connective: type[p.And | p.Or]) -> list[Property]:
    """The properties that a chain of one connective joins."""
    if not isinstance(node, connective):
        return [node]
    return [*_joined(node.left, connective), *_joined(node.right, connective)]


def atom_text(atom: Atom, holds: bool) -> str:
    """What it means that `atom` holds, or does not."""
    match atom.condition:
        case Comparison(Call(Function.NORM, _), Relation.EQUAL, Number(0.0), margin):
            # Two vectors, which the name still has.
            left, _, right = atom.name.partition(" ==")
            equal = f"is {'' if holds else 'not '}{f'within {number_text(margin)} of' if margin else 'exactly'}"
            return f"{left} {equal} {right.partition('} ')[2] or right.strip()}"
        case Comparison(left, Relation.EQUAL, right, margin) if margin > 0:
            within = "is within" if holds else "is not within"
            return f"{expression_text(left)} {within} {number_text(margin)} of {expression_text(right)}"
        case Comparison(left, relation, Number(value), margin):
            return f"{expression_text(left)} {_RELATIONS[relation][not holds]} {number_text(value + margin)}"
        case Comparison(left, relation, right, margin):
            moved = f" {'plus' if margin > 0 else 'minus'} {number_text(abs(margin))}" if margin else ""
            return f"{expression_text(left)} {_RELATIONS[relation][not holds]} {expression_text(right)}{moved}"
        case Same(left, right):
            return f"{expression_text(left)} is {'' if holds else 'not '}{expression_text(right)}"
        case IsTrue(operand):
            return f"{expression_text(operand)} is {'true' if holds else 'false'}"


def expression_text(expression: Expression) -> str:
    """A value in words."""
    match expression:
        case Current(signal):
            return signal_text(signal)
        case Past(signal, samples):
            return f"{signal_text(signal)} {samples} sample{'' if samples == 1 else 's'} ago"
        case Slope(signal):
            return f"the rate of change of {signal_text(signal)}"
        case Call(Function.ABS | Function.MIN | Function.MAX as function, (operand,)):
            return f"the {_FOLDS[function]} of {expression_text(operand)}"
        case _:
            return text(expression)


def signal_text(signal: Signal) -> str:
    """What a signal is called: a primitive of the simulation in words, anything else by its name."""
    for pattern, words in _PRIMITIVES:
        match = re.fullmatch(pattern, signal.name)
        if match:
            return words.format(*match.groups())
    return signal.name
