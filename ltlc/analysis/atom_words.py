"""What is read and asked of signals in plain English: atoms, values and state predicates."""

from __future__ import annotations

import re
from collections.abc import Callable

from ltlc.base.source import Span
from ltlc.semantics import ltl
from ltlc.semantics.ltl import Formula
from ltlc.specification.atoms import Atom
from ltlc.specification.expressions import (
    Call,
    Comparison,
    Count,
    Current,
    Element,
    Expression,
    Field,
    IsTrue,
    New,
    Number,
    Opening,
    Past,
    Recent,
    Relation,
    Same,
    Signal,
    Slope,
    When,
    openings,
    operands,
    reads,
    subexpressions,
)
from ltlc.specification.functions import Function
from ltlc.specification.specification import gone_name
from ltlc.specification.text import as_written, number_text, text

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
    (r"(\w+)\[(\w+)\]", "{} of {}"),
)
"""What the simulation primitives are called, and elements that belong to an id."""

AT_OPENING, AT_BEGINNING = "when the scope opened", "when the run began"

RELATIONS = {
    Relation.LESS: ("less than", "at least"),
    Relation.AT_MOST: ("at most", "more than"),
    Relation.GREATER: ("more than", "at most"),
    Relation.AT_LEAST: ("at least", "less than"),
    Relation.EQUAL: ("exactly", "not exactly"),
}
"""How a comparison reads after `is` when it holds, and when it does not."""

_ARRIVES = {"is": "arrives", "is never": "never arrives", "was": "arrived", "has been": "has arrived"}
"""What a message does in the tenses in which atoms are."""


def predicate_words(
    formula: Formula, atom_words: Callable[[ltl.Atom, bool], str], context: type[Formula] | None = None
) -> str:
    """A state predicate, in parentheses where `and` and `or` meet; `atom_words` puts an atom that holds, or not."""
    match formula:
        case ltl.Truth():
            return "true holds"
        case ltl.Not(ltl.Truth()):
            return "false holds"
        case ltl.Atom():
            return atom_words(formula, True)
        case ltl.Not(ltl.Atom() as atom):
            return atom_words(atom, False)
        case ltl.Not(operand):
            return f"not ({predicate_words(operand, atom_words)})"
        case ltl.And(left, right) | ltl.Or(left, right):
            kind = type(formula)
            word = "and" if kind is ltl.And else "or"
            words = f" {word} ".join(predicate_words(side, atom_words, kind) for side in (left, right))
            return words if context in (None, kind) else f"({words})"
        case _:
            raise TypeError(f"not a state predicate: {formula!r}")


def atom_text(atom: Atom, holds: bool, verb: str = "is") -> str:
    """What it means that `atom` holds, or does not, or did, in the tense of `verb`."""
    match atom.condition:
        case Comparison(Call(Function.NORM, _), Relation.EQUAL, Number(0.0), margin):
            # Two vectors, which the name still has.
            left, _, right = as_written(atom.name).partition(" ==")
            right = right.strip() if margin == 0 else right.partition("} ")[2]
            equal = f"{verb} {'' if holds else 'not '}{f'within {number_text(margin)} of' if margin else 'exactly'}"
            scopes = [opening.scope for side in operands(atom.condition) for opening in openings(side)]
            when = AT_OPENING if any(scopes) else AT_BEGINNING
            words = re.sub(r"@\{(.*?), opening\}", rf"what \1 was {when}", f"{left} {equal} {right}")
            return re.sub(r"@\{(.*?), -(\d+)\}", lambda past: f"what {past[1]} was {_ago(int(past[2]))}", words)
        case Comparison(Count() as count, Relation.AT_LEAST | Relation.LESS as relation, Number(1.0)):
            is_any = relation is Relation.AT_LEAST
            if windows := {element.array for element in count.elements if isinstance(element.array, Recent)}:
                return _of_samples(expression_text(windows.pop()), count, is_any, holds, verb)
            if holds and not is_any:  # what is counted is what fails
                return f"for every {_combined(count)}, {_holding(count, verb, holds=False)}"
            return f"for {'no' if is_any and not holds else 'some'} {_combined(count)}, {_holding(count, verb)}"
        case Comparison(Call(Function.INSIDE, (x, y, *_), zone), relation):
            where = "inside" if holds == (relation is Relation.AT_LEAST) else "outside"
            return f"{_point(x, y)} {verb} {where} {zone}"
        case Comparison(left, Relation.EQUAL, right, margin) if margin > 0:
            within = f"{verb} {'' if holds else 'not '}within"
            return f"{expression_text(left)} {within} {number_text(margin)} of {expression_text(right)}"
        case Comparison(left, relation, Number(value, single), margin):
            bound = number_text(value + margin if margin else value, single)
            return f"{expression_text(left)} {verb} {RELATIONS[relation][not holds]} {bound}"
        case Comparison(left, relation, right, margin):
            moved = f" {'plus' if margin > 0 else 'minus'} {number_text(abs(margin))}" if margin else ""
            compared = f"{verb} {RELATIONS[relation][not holds]}"
            return f"{expression_text(left)} {compared} {expression_text(right)}{moved}"
        case Same(left, right):
            return f"{expression_text(left)} {verb} {'' if holds else 'not '}{expression_text(right)}"
        case IsTrue(Past(Signal(_, _, When() as predicate), samples)):
            return f"{_ago(samples)} {_holding(predicate, 'was', holds)}"
        case IsTrue(New(signal)):
            return f"{'a' if holds else 'no'} message of {heard_text(signal)} {_ARRIVES[verb]}"
        case IsTrue(Current(Signal(name))) if name.startswith(gone_name("")):
            return f"it {verb} {'' if holds else 'not '}missing in the last {name.removeprefix(gone_name(''))}"
        case IsTrue(operand):
            return f"{expression_text(operand)} {verb} {'true' if holds else 'false'}"


def has_verb(atom: Atom) -> bool:
    """Whether the verb that `atom_text` puts in is that of the whole: not in `for some element, a is less than 1`."""
    match atom.condition:
        case Comparison(Count(), Relation.AT_LEAST | Relation.LESS, Number(1.0)) | IsTrue(Past()):
            return False
        case _:
            return True


def _combined(count: Count, plural: bool = False) -> str:
    """What a count counts: elements, or combinations of elements of several lists."""
    noun = {1: "element", 2: "pair"}.get(len(count.lists), "combination") + "s" * plural
    if len(count.lists) == 1:
        return noun
    return f"{noun} of elements of {' and '.join(expression_text(elements[0].array) for elements in count.lists)}"


def _holding(what: Count | When, verb: str, holds: bool = True) -> str:
    """What holds of elements, or at a step; or that it does not."""
    atoms = {name: Atom(name, condition, Span(0, 0)) for name, condition in what.conditions}
    predicate = what.predicate if holds else _negated(what.predicate)
    return predicate_words(predicate, lambda atom, holds: atom_text(atoms[atom.name], holds, verb))


def _negated(predicate: Formula) -> Formula:
    """The negation, of atoms alone."""
    match predicate:
        case ltl.Not(operand):
            return operand
        case ltl.And(left, right):
            return ltl.Or(_negated(left), _negated(right))
        case ltl.Or(left, right):
            return ltl.And(_negated(left), _negated(right))
        case _:
            return ltl.Not(predicate)


def _of_samples(samples: str, count: Count, is_any: bool, holds: bool, verb: str) -> str:
    """What holds of any of the `samples`, or of all, if failures are counted; or that it does not."""
    which = ("one" if holds else "none") if is_any else ("each" if holds else "one")
    said = _holding(count, verb, is_any or not holds)
    if isinstance(count.predicate, ltl.And | ltl.Or):
        return f"for {which} of {samples}, {said}"
    return said.replace("it ", f"{which} of {samples} ", 1)


def _ago(samples: int) -> str:
    return f"{samples} sample{'' if samples == 1 else 's'} ago"


def expression_text(expression: Expression) -> str:
    """A value in words."""
    match expression:
        case Current(signal):
            return signal_text(signal)
        case Past(signal, samples):
            return f"{signal_text(signal)} {_ago(samples)}"
        case Recent(signal, samples):
            return f"the last {samples + 1} samples of {signal_text(signal)}"
        case Opening(signal, scope):
            return f"what {signal_text(signal)} was {AT_OPENING if scope else AT_BEGINNING}"
        case Slope(signal):
            return f"the rate of change of {signal_text(signal)}"
        case Element(Recent()):
            return "it"
        case Element(array):
            return expression_text(array)
        case Count(elements=(Element(Recent() as window), *_)):
            several = isinstance(expression.predicate, ltl.And | ltl.Or)
            which = f"for which {_holding(expression, 'is')}" if several else f"that {_holding(expression, 'are')[3:]}"
            return f"the number of {expression_text(window)} {which}"
        case Count():
            return f"the number of {_combined(expression, plural=True)} for which {_holding(expression, 'is')}"
        case Call(_, (x, y, *_), zone) if zone:
            return f"the distance of {_point(x, y)} from {zone}"
        case Call(Function.NEAREST, (sought, array)):
            return f"the element of {expression_text(array)} nearest to {expression_text(sought)}"
        case Call(Function.ANGLE_BETWEEN, (one, other)):
            return f"the angle between {expression_text(one)} and {expression_text(other)}"
        case Call(Function.MOD, (one, other)):
            return f"the remainder of {expression_text(one)} divided by {expression_text(other)}"
        case Call(Function.NORM, components):
            vector = text(components[0]).removesuffix(".x")
            if list(map(text, components)) == [f"{vector}.{axis}" for axis in "xyz"]:
                return f"the length of {vector}"
            return f"the length of ({', '.join(map(expression_text, components))})"
        case Call(function, (operand,)) if function.noun:
            return f"the {function.noun} of {expression_text(operand)}"
        case _:
            return _calculated(expression)


def _point(x: Expression, y: Expression) -> str:
    """A point, if it can be by what it is the position of."""
    one, other = expression_text(x), expression_text(y)
    thing = one.removeprefix("the x position of ")
    return thing if other == f"the y position of {thing}" else f"the point ({one}, {other})"


def _calculated(expression: Expression) -> str:
    """What is calculated, as it is written, but for what is said of arrays, and read of the past and of openings."""
    written = text(expression)
    for part in subexpressions(expression):
        if isinstance(part, Call) and part.array is not None:
            written = written.replace(text(part), f"({expression_text(part)})")
    for read in dict.fromkeys(reads(expression)):
        if isinstance(read, Past | Recent | Opening) or read.signal.is_taken:
            written = written.replace(text(read), f"({expression_text(read)})")
            written = re.sub(rf"(?<=\w)\(({re.escape(f'({expression_text(read)})')})\)", r"\1", written)
    return written


def heard_text(signal: Signal) -> str:
    """What the messages of a signal are called: those of a vector by its name."""
    return signal.whole or signal_text(signal)


def signal_text(signal: Signal) -> str:
    """What a signal is called: a primitive of the simulation in words, anything else by its name."""
    if isinstance(signal.definition, When):
        return f"whether {_holding(signal.definition, 'is')}"
    if signal.otherwise is not None and not isinstance(signal.definition, Field):
        return f"{expression_text(signal.definition)} ({expression_text(signal.otherwise)} before there is one)"
    if signal.when is not None and not isinstance(signal.definition, Field):
        return f"{expression_text(signal.definition)} when last {_holding(signal.when, 'was')}"
    for pattern, words in _PRIMITIVES:
        match = re.fullmatch(pattern, signal.name)
        if match:
            return words.format(*match.groups())
    return signal.name
