"""Properties in plain English: what has to happen when, in the words of their signals."""

from __future__ import annotations

import re
from typing import assert_never

from ltlc.analysis.atom_words import AT_OPENING, RELATIONS, atom_text, has_verb, heard_text, predicate_words
from ltlc.semantics import ltl
from ltlc.semantics import properties as p
from ltlc.semantics.durations import Nanoseconds, duration_text
from ltlc.semantics.encodings import reads_time
from ltlc.semantics.ltl import Formula
from ltlc.semantics.properties import Property
from ltlc.semantics.timed_atoms import (
    Age,
    Historically,
    News,
    Occurred,
    Once,
    Previously,
    Since,
    atoms_within,
    messages_of,
)
from ltlc.specification.atoms import Atom
from ltlc.specification.expressions import IsTrue, New, Relation, openings, operands
from ltlc.specification.specification import Instances, PropertySpecification, Slicing
from ltlc.specification.text import as_written

_STARTS = {"": "at the first {}, ", " from then on": "at that {}, "}
"""When a state predicate is read that no keyword stands before, by when the property around it is judged."""


class English:
    """Puts the parts of one property into words."""

    def __init__(self, specification: PropertySpecification) -> None:
        self._atoms = {atom.name: atom for atom in specification.atoms}
        self._property = specification.property
        self._slicing = specification.slicing
        self._signals = specification.signals()
        self._step = "moment" if reads_time(specification.property) else "step"

    def sentence(self) -> str:
        """The property as one sentence; a name with which it begins stays as it is."""
        words = self.clause()
        names = {name for signal in self._signals for name in (signal.name, signal.name.partition(".")[0])}
        first = re.match(r"[\w.]*", words)
        return f"{words}." if first and first[0] in names else f"{words[0].upper()}{words[1:]}."

    def clause(self) -> str:
        """The property as a part of a sentence."""
        match self._slicing:
            case None:
                return self._clause(self._property, "")
            case Instances(signal):
                assert isinstance(self._property, p.After)
                clause = self._clause(self._property.body, " from there on")
                return f"for each message of {heard_text(signal)}: {clause}"
            case Slicing(keys, variable):
                names = " or ".join(key.name for key in keys)
                clause = self._clause(self._property, "")
                return f"for each value {variable} of {names}, in its messages: {clause}"
            case _:
                assert_never(self._slicing)

    def _clause(self, node: Property, later: str) -> str:
        """`node` as a clause; `later` is from when on it is judged, if not from the start."""
        match node:
            case p.Now(predicate):
                return f"{_STARTS.get(later, '').format(self._step)}{self.predicate(predicate)}"
            case p.Within(duration, body, 0):
                return self._bounded(body, "in the", f"{'next' if later else 'first'} {duration_text(duration)}")
            case p.Within(duration, body, start):
                when = "later" if later else "after the start"
                return self._bounded(body, "from", f"{duration_text(start)} to {duration_text(duration)} {when}")
            case p.Throughout(predicate) | p.Always(p.Now(predicate)):
                return f"at every {self._step}{later}, {self._rule(predicate)}"
            case p.Never(p.Now(predicate)):
                return self._never(predicate, later)
            case p.SOME_STEP:
                return f"there is a {self._step}{later}"
            case p.Eventually(p.Now(predicate)):
                return f"at some {self._step}{later}, {self.predicate(predicate)}"
            case p.Always(p.Implies(p.Now(predicate), then)):
                then_text = self._clause(then, " from there on")
                return f"at every {self._step}{later}, if {self.predicate(predicate)}, then {then_text}"
            case p.Always(operand):
                return f"at every {self._step}{later}, the following holds: {self._clause(operand, ' from there on')}"
            case p.Never(operand):
                return f"at no {self._step}{later} does the following hold: {self._clause(operand, ' from there on')}"
            case p.Eventually(operand):
                return f"at some {self._step}{later}, the following holds: {self._clause(operand, ' from there on')}"
            case p.Not(operand):
                return f"it is not the case that {self._side(operand, later)}"
            case p.And():
                return ", and ".join(self._side(part, later) for part in _joined(node, p.And))
            case p.Or():
                return "either " + ", or ".join(self._side(part, later) for part in _joined(node, p.Or))
            case p.Implies(left, right):
                return f"if {self._side(left, later)}, then {self._side(right, later)}"
            case _:
                return self._scope(node, later)

    def _bounded(self, body: Property, preposition: str, time: str) -> str:
        """`body` on the part of the run that `time` is about."""
        match body:
            case p.Always(p.Now()) | p.Never(p.Now()) | p.Eventually(p.Now()) | p.Throughout():
                return self._clause(body, f" {preposition} {time}")
            case _:
                part = "the" if preposition == "in the" else f"the time {preposition}"
                return f"considering only {part} {time}: {self._clause(body, '')}"

    def _never(self, predicate: Formula, later: str) -> str:
        """That `predicate` holds at no step: `v is never more than 2`, where its verb is that of one comparison."""
        atom = self._atoms.get(predicate.name) if isinstance(predicate, ltl.Atom) else None
        if atom is None or not has_verb(atom) or later not in ("", *_STARTS, " from there on"):
            return f"there is no {self._step}{later} at which {self.predicate(predicate)}"
        return f"{later.strip()}, {self.words_of(atom, 'is never')}".removeprefix(", ")

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
                words = RELATIONS[Relation.LESS if strictly else Relation.AT_MOST][not holds]
                return f"the last message of {self._signal(news)} {verb} {words} {limit} old"
            case Once(operand=Occurred() as count):
                return self._atom(count, verb, holds=holds)
            case Previously() | Once() | Historically() | Since() | Occurred():
                words = self._past(atom, holds=holds)
                return words if verb == "is" else f"it {verb} the case that ({words})"
            case _:
                return self.words_of(self._atoms[atom.name], verb, holds=holds)

    def atoms(self) -> list[tuple[str, str]]:
        """The atoms that the author wrote, as written and in words; an age, not the messages that it counts from."""
        made = isinstance(self._slicing, Instances) and self._slicing.made
        parts = [atom for part in p.predicates(self._property) for atom in atoms_within(part)]
        hidden = messages_of(parts)
        written = [a for a in self._atoms.values() if a.name not in hidden and not (made and _news_of(a) in made)]
        ages = [each for each in dict.fromkeys(parts) if isinstance(each, Age)]
        return [
            *((as_written(atom.name), self.words_of(atom)) for atom in written),
            *((as_written(each.name), self._atom(each, "is", holds=True)) for each in ages),
        ]

    def words_of(self, atom: Atom, verb: str = "is", *, holds: bool = True) -> str:
        """What it means that `atom` holds, or does not; the scope of an instance opens at its message."""
        words = atom_text(atom, holds, verb)
        taken = {opening.scope for side in operands(atom.condition) for opening in openings(side)}
        is_own = isinstance(self._slicing, Instances) and taken == {1}
        return words.replace(AT_OPENING, "at that message") if is_own else words

    def _past(self, atom: Previously | Once | Historically | Since | Occurred, *, holds: bool) -> str:
        """What has been, and whether it has."""
        match atom:
            case Occurred(_, operand, times, within, begins, presumed):
                often = f"{'at least' if holds else 'fewer than'} {times}"
                span = "so far" if within is None else f"in the last {duration_text(within)}"
                said = self._counted(operand, often, "" if times == 1 else "s", span, begins)
                unless = "or the start was at most" if holds else "and the start was more than"
                return f"{said}, {unless} {duration_text(within or 0)} ago" if presumed else said
            case Previously(_, operand):
                words = f"{self._operand(operand, 'was')} just before"
            case Once(_, operand, within):
                moment = "some moment" if holds else "no moment"
                return f"{self._operand(operand, 'has been')} at {moment} {_so_far(within)}"
            case Historically(_, operand, None):
                words = f"{self._operand(operand, 'has been')} at all times so far"
            case Historically(_, operand, lasting):
                words = f"{self._operand(operand, 'has been')} for the last {duration_text(lasting or 0)}"
            case Since(_, kept, start, within):
                since = f"ever since a moment {_so_far(within)} at which {self._operand(start, 'was')}"
                words = f"{self._operand(kept, 'has been')} {since}"
        return words if holds else f"it is not the case that {words}"

    def _counted(self, operand: Formula, often: str, plural: str, span: str, begins: bool) -> str:
        """How `often` something occurred in a `span`: messages, steps at which it held, or beginnings of it."""
        if isinstance(operand, News):
            return f"{often} message{plural} of {self._signal(operand)} arrived {span}"
        if begins:
            became = isinstance(operand, ltl.Atom) and has_verb(self._atoms[operand.name])
            if became:
                return f"{self.predicate(operand, None, 'became')} {often} time{plural} {span}"
            return f"it happened {often} time{plural} {span} that {self.predicate(operand, None, 'was')}"
        return f"{self._operand(operand, 'was')} {often} time{plural} {span}"

    def _operand(self, formula: Formula, verb: str) -> str:
        words = self.predicate(formula, None, verb)
        return f"({words})" if isinstance(formula, ltl.And | ltl.Or) else words

    def _signal(self, news: News) -> str:
        condition = self._atoms[news.name].condition
        assert isinstance(condition, IsTrue)
        assert isinstance(condition.operand, New)
        return heard_text(condition.operand.signal)


def _news_of(atom: Atom) -> str | None:
    """The name of the signal of which the atom is `new`; None for other atoms."""
    match atom.condition:
        case IsTrue(New(signal)):
            return signal.name
        case _:
            return None


def _so_far(within: Nanoseconds | None) -> str:
    return "so far" if within is None else f"in the last {duration_text(within)}"


def _joined(node: Property, connective: type[p.And | p.Or]) -> list[Property]:
    """The properties that a chain of one connective joins."""
    if not isinstance(node, connective):
        return [node]
    return [*_joined(node.left, connective), *_joined(node.right, connective)]
