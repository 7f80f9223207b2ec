"""Properties in plain English: what has to happen when, in the words of their signals."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import assert_never

from ltlc.base.source import Span
from ltlc.semantics import ltl
from ltlc.semantics import properties as p
from ltlc.semantics.durations import Nanoseconds, duration_text
from ltlc.semantics.encodings import reads_time
from ltlc.semantics.ltl import Formula
from ltlc.semantics.properties import Property
from ltlc.semantics.timed_atoms import Age, Historically, News, Occurred, Once, Previously, Since
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
)
from ltlc.specification.functions import Function
from ltlc.specification.specification import Instances, PropertySpecification, Slicing, gone_name
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

_AT_OPENING = "when the scope opened"

_RELATIONS = {
    Relation.LESS: ("less than", "at least"),
    Relation.AT_MOST: ("at most", "more than"),
    Relation.GREATER: ("more than", "at most"),
    Relation.AT_LEAST: ("at least", "less than"),
    Relation.EQUAL: ("exactly", "not exactly"),
}
"""How a comparison reads after `is` when it holds, and when it does not."""

_ARRIVES = {"is": "arrives", "was": "arrived", "has been": "has arrived"}
"""What a message does in the tenses in which atoms are."""

_STARTS = {"": "at the first {}, ", " from then on": "at that {}, "}
"""When a state predicate is read that no keyword stands before, by when the property around it is judged."""


class English:
    """Puts the parts of one property into words."""

    def __init__(self, specification: PropertySpecification) -> None:
        self._atoms = {atom.name: atom for atom in specification.atoms}
        self._property = specification.property
        self._slicing = specification.slicing
        self._step = "moment" if reads_time(specification.property) else "step"

    def sentence(self) -> str:
        """The property as one sentence."""
        words = self.clause()
        return f"{words[0].upper()}{words[1:]}."

    def clause(self) -> str:
        """The property as a part of a sentence."""
        match self._slicing:
            case None:
                return self._clause(self._property, "")
            case Instances(signal):
                assert isinstance(self._property, p.After)
                clause = self._clause(self._property.body, " from there on")
                return f"for each message of {signal.name}: {clause}"
            case Slicing(keys, variable):
                names = " or ".join(key.name for key in keys)
                clause = self._clause(self._property, "")
                return f"for each value {variable} that {names} ever has, in its messages: {clause}"
            case _:
                assert_never(self._slicing)

    def _clause(self, node: Property, later: str) -> str:
        """`node` as a clause; `later` says from when on it is judged, if not from the start."""
        match node:
            case p.Now(predicate):
                return f"{_STARTS.get(later, '').format(self._step)}{self.predicate(predicate)}"
            case p.Within(duration, body, 0):
                return self._bounded(body, "of the", f"{'next' if later else 'first'} {duration_text(duration)}")
            case p.Within(duration, body, start):
                when = "later" if later else "after the start"
                return self._bounded(body, "from", f"{duration_text(start)} to {duration_text(duration)} {when}")
            case p.Throughout(predicate) | p.Always(p.Now(predicate)):
                return f"at every {self._step}{later}, {self._rule(predicate)}"
            case p.Never(p.Now(predicate)):
                return f"at no {self._step}{later}: {self.predicate(predicate)}"
            case p.SOME_STEP:
                return f"there is a {self._step}{later}"
            case p.Eventually(p.Now(predicate)):
                return f"at some {self._step}{later}, {self.predicate(predicate)}"
            case p.Always(p.Implies(p.Now(predicate), then)):
                then_text = self._clause(then, " from there on")
                return f"at every {self._step}{later}, if {self.predicate(predicate)}, then {then_text}"
            case p.Always(operand):
                return f"at every {self._step}{later}, this holds: {self._clause(operand, ' from there on')}"
            case p.Never(operand):
                return f"at no {self._step}{later} does this hold: {self._clause(operand, ' from there on')}"
            case p.Eventually(operand):
                return f"at some {self._step}{later}, this holds: {self._clause(operand, ' from there on')}"
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

    def _bounded(self, body: Property, preposition: str, time: str) -> str:
        """`body` on the part of the run that `time` speaks of."""
        match body:
            case p.Always(p.Now()) | p.Never(p.Now()) | p.Eventually(p.Now()) | p.Throughout():
                return self._clause(body, f" {preposition} {time}")
            case _:
                part = "on the" if preposition == "of the" else preposition
                return f"judged {part} {time} alone: {self._clause(body, '')}"

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
                ends = f"there is a {self._step}{later} at which {self.predicate(event)}"
                return f"{ends}; before that, {self._clause(body, '')}"
            case p.AfterUntil(opening, closing, body):
                ends = f"opens when {self.predicate(opening)} and lasts until {self.predicate(closing)}"
                return f"in each episode that {ends}: {self._clause(body, '')}"
            case _:
                raise TypeError(f"not a property: {node!r}")

    def _rule(self, predicate: Formula) -> str:
        """A state predicate that holds at every step, an implication as such."""
        match predicate:
            case ltl.Or(ltl.Not(condition), then):
                return f"if {self.predicate(condition)}, then {self.predicate(then, ltl.Or)}"
            case _:
                return self.predicate(predicate)

    def predicate(self, formula: Formula, context: type[Formula] | None = None, verb: str = "is") -> str:
        """A state predicate in words, in the tense of `verb`; in parentheses where `and` and `or` meet."""
        return predicate_words(formula, lambda atom, holds: self._atom(atom, verb, holds=holds), context)

    def _atom(self, atom: ltl.Atom, verb: str, *, holds: bool) -> str:
        match atom:
            case Age(name, news, most):
                strictly = " < " in name
                limit = duration_text(most + strictly)
                words = _RELATIONS[Relation.LESS if strictly else Relation.AT_MOST][not holds]
                return f"the last message of {self._signal(news)} {verb} {words} {limit} old"
            case Once(operand=Occurred() as count):
                return self._atom(count, verb, holds=holds)
            case Previously() | Once() | Historically() | Since() | Occurred():
                words = self._past(atom, holds=holds)
                return words if verb == "is" else f"it {verb} so that ({words})"
            case _:
                return self.words_of(self._atoms[atom.name], verb, holds=holds)

    def atoms(self) -> list[tuple[str, str]]:
        """The atoms that the author wrote, as they are written and in words."""
        made = isinstance(self._slicing, Instances) and self._slicing.made
        written = [a for a in self._atoms.values() if not (made and _news_of(a) in made)]
        return [(as_written(atom.name), self.words_of(atom)) for atom in written]

    def words_of(self, atom: Atom, verb: str = "is", *, holds: bool = True) -> str:
        """What it means that `atom` holds, or does not; the scope of an instance opens at its message."""
        words = atom_text(atom, holds, verb)
        taken = {opening.scope for side in operands(atom.condition) for opening in openings(side)}
        is_own = isinstance(self._slicing, Instances) and taken == {1}
        return words.replace(_AT_OPENING, "at that message") if is_own else words

    def _past(self, atom: Previously | Once | Historically | Since | Occurred, *, holds: bool) -> str:
        """What has been, and whether it has."""
        match atom:
            case Occurred(_, operand, times, within, begins, presumed):
                often = f"{'at least' if holds else 'fewer than'} {times}"
                span = "so far" if within is None else f"in the last {duration_text(within)}"
                said = self._counted(operand, often, "" if times == 1 else "s", span, begins)
                unless = f"{'or at most' if holds else 'and more than'} {duration_text(within or 0)}"
                return f"{said}, {unless} has passed since the beginning" if presumed else said
            case Previously(_, operand):
                words = f"{self._operand(operand, 'was')} just before"
            case Once(_, operand, within):
                moment = "some moment" if holds else "no moment"
                return f"{self._operand(operand, 'has been')} at {moment} {_so_far(within)}"
            case Historically(_, operand, None):
                words = f"{self._operand(operand, 'has been')} all the time so far"
            case Historically(_, operand, lasting):
                words = f"{self._operand(operand, 'has been')} for the last {duration_text(lasting or 0)}"
            case Since(_, kept, start, within):
                since = f"ever since a moment {_so_far(within)} at which {self._operand(start, 'was')}"
                words = f"{self._operand(kept, 'has been')} {since}"
        return words if holds else f"it is not so that {words}"

    def _counted(self, operand: Formula, often: str, plural: str, span: str, begins: bool) -> str:
        """How `often` something occurred in a `span`: messages, steps at which it held, or beginnings of it."""
        if isinstance(operand, News):
            return f"{often} message{plural} of {self._signal(operand)} arrived {span}"
        if begins:
            return f"it came about {often} time{plural} {span} that {self.predicate(operand, None, 'was')}"
        return f"{self._operand(operand, 'was')} {often} time{plural} {span}"

    def _operand(self, formula: Formula, verb: str) -> str:
        words = self.predicate(formula, None, verb)
        return f"({words})" if isinstance(formula, ltl.And | ltl.Or) else words

    def _signal(self, news: News) -> str:
        condition = self._atoms[news.name].condition
        assert isinstance(condition, IsTrue)
        assert isinstance(condition.operand, New)
        return signal_text(condition.operand.signal)


def _news_of(atom: Atom) -> str | None:
    """The name of the signal whose message the atom says comes; None if it says something else."""
    match atom.condition:
        case IsTrue(New(signal)):
            return signal.name
        case _:
            return None


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


def _so_far(within: Nanoseconds | None) -> str:
    return "so far" if within is None else f"of the last {duration_text(within)}"


def _joined(node: Property, connective: type[p.And | p.Or]) -> list[Property]:
    """The properties that a chain of one connective joins."""
    if not isinstance(node, connective):
        return [node]
    return [*_joined(node.left, connective), *_joined(node.right, connective)]


def atom_text(atom: Atom, holds: bool, verb: str = "is") -> str:
    """What it means that `atom` holds, or does not, or did, in the tense of `verb`."""
    match atom.condition:
        case Comparison(Call(Function.NORM, _), Relation.EQUAL, Number(0.0), margin):
            # Two vectors, which the name still has.
            left, _, right = atom.name.partition(" ==")
            equal = f"{verb} {'' if holds else 'not '}{f'within {number_text(margin)} of' if margin else 'exactly'}"
            return f"{left} {equal} {right.partition('} ')[2] or right.strip()}"
        case Comparison(Count() as count, Relation.AT_LEAST | Relation.LESS as relation, Number(1.0)):
            is_any = relation is Relation.AT_LEAST
            if windows := {element.array for element in count.elements if isinstance(element.array, Recent)}:
                return _of_samples(expression_text(windows.pop()), count, is_any, holds, verb)
            return f"for {'some' if is_any == holds else 'no'} {_combined(count)}, {_holding(count, verb)}"
        case Comparison(Call(Function.INSIDE, (x, y, *_), zone), relation):
            where = "inside" if holds == (relation is Relation.AT_LEAST) else "outside"
            return f"{_point(x, y)} {verb} {where} {zone}"
        case Comparison(left, Relation.EQUAL, right, margin) if margin > 0:
            within = f"{verb} {'' if holds else 'not '}within"
            return f"{expression_text(left)} {within} {number_text(margin)} of {expression_text(right)}"
        case Comparison(left, relation, Number(value, single), margin):
            bound = number_text(value + margin if margin else value, single)
            return f"{expression_text(left)} {verb} {_RELATIONS[relation][not holds]} {bound}"
        case Comparison(left, relation, right, margin):
            moved = f" {'plus' if margin > 0 else 'minus'} {number_text(abs(margin))}" if margin else ""
            compared = f"{verb} {_RELATIONS[relation][not holds]}"
            return f"{expression_text(left)} {compared} {expression_text(right)}{moved}"
        case Same(left, right):
            return f"{expression_text(left)} {verb} {'' if holds else 'not '}{expression_text(right)}"
        case IsTrue(Past(Signal(_, _, When() as predicate), samples)):
            return f"{_ago(samples)} {_holding(predicate, 'was', holds)}"
        case IsTrue(New(signal)):
            return f"{'a' if holds else 'no'} message of {signal_text(signal)} {_ARRIVES[verb]}"
        case IsTrue(Current(Signal(name))) if name.startswith(gone_name("")):
            return f"it {verb} {'' if holds else 'not '}missing in the last {name.removeprefix(gone_name(''))}"
        case IsTrue(operand):
            return f"{expression_text(operand)} {verb} {'true' if holds else 'false'}"


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
    """What holds of any, or, if what is counted is what fails, of all `samples`; or that it does not."""
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
            return f"{signal_text(signal)} {_AT_OPENING if scope else 'when the run began'}"
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
    """What is calculated, as it is written, but for what is read of the past and of openings."""
    written = text(expression)
    for read in dict.fromkeys(reads(expression)):
        if isinstance(read, Past | Recent | Opening) or read.signal.is_taken:
            written = written.replace(text(read), f"({expression_text(read)})")
            written = re.sub(rf"(?<=\w)\(({re.escape(f'({expression_text(read)})')})\)", r"\1", written)
    return written


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
