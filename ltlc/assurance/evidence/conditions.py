"""The atoms of a property as JSON: all that has to be known to compute them from a recording, down to the fields.

This is one side of the seam: `recorded.py`, which shares nothing with it, computes what is written here, and
`seam.py` compares it with what a specification says. `docs/evidence.md` describes the form.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple, assert_never

from ltlc.assurance.evidence.counting import stated_count
from ltlc.assurance.evidence.document import Data, StatedAtom, StatedCount, StatedSignal
from ltlc.inputs.recordings.lacks import signals_of
from ltlc.program.excused import excused
from ltlc.program.machine import Instead
from ltlc.semantics import ltl
from ltlc.semantics.encodings import EPISODE, Encoding
from ltlc.semantics.intervals import without_intervals
from ltlc.semantics.openings import scope_clocks
from ltlc.semantics.properties import Property, predicates
from ltlc.semantics.timed_atoms import (
    Age,
    Clock,
    Late,
    News,
    Previously,
    atoms_within,
    clock_operands,
    duration_of,
    timed_atoms,
)
from ltlc.specification import expressions as e
from ltlc.specification.functions import Function
from ltlc.specification.numbers import numbers_of
from ltlc.specification.specification import Instances, PropertySpecification, Slicing, fields, topics_of
from ltlc.specification.wire import PRIMITIVES, double_or_integer

Json = object
"""What JSON can say."""


class NotCoveredError(Exception):
    """Evidence cannot say this, for a reason."""


class _Standing(NamedTuple):
    """What an input is before it has a value, and the topics without whose news it is not read; none: until then."""

    value: Instead
    topics: tuple[str, ...]


def stated_atoms(of: PropertySpecification, encoding: Encoding = EPISODE) -> tuple[StatedAtom, ...]:
    """The atoms of a property with what they are. Raises NotCoveredError."""
    if isinstance(of.slicing, Slicing):
        _check_slices(of, of.slicing)
    elif of.slicing is not None:
        if of.openings():
            raise NotCoveredError("it reads values at openings, from each message on")
        if without_intervals(of.property) != of.property:
            raise NotCoveredError("it has an interval, from each message on")
        of = whole_run(of, of.slicing)
    scopes = numbered_scopes(of)
    if any(isinstance(atom, Age) for clock in scopes for part in clock_operands(clock) for atom in atoms_within(part)):
        raise NotCoveredError("an age opens or closes a scope at whose opening it reads a value")
    if encoding is not EPISODE:
        raise NotCoveredError(f"verdicts under the encoding `{encoding.name}` are not proved")
    if asks_between_steps(of.property):
        raise NotCoveredError("it asks what held a nanosecond ago of what changes while nothing happens")
    if len(of.atoms) + len(scopes) > MOST_ATOMS:
        raise NotCoveredError(f"it has more than {MOST_ATOMS} atoms")
    names = {each.input.signal: each for each in excused(of)}
    standing = {
        wanted: _Standing(each.instead, tuple(t for n in each.news for t in _topics(of, n.signal)))
        for wanted in of.inputs()
        if isinstance(wanted, e.Current) and (each := names.get(wanted.signal.name)) is not None
    }
    openings = {opening: scopes[clock] for opening, clock in of.openings().items()}
    writer, messages = _Writer(standing, openings), of.messages()
    return tuple(
        StatedAtom(a.name, _message(a.condition) if a.name in messages else _as_data(writer.condition(a.condition)))
        for a in of.atoms
    )


def _as_data(said: Json) -> Data:
    return said if isinstance(said, dict) else _call("and", said)


def _check_slices(of: PropertySpecification, by: Slicing) -> None:
    """Raise NotCoveredError if evidence does not cover what is judged for each id."""
    if len(by.keys) > 1:
        raise NotCoveredError("it is judged for each id on several topics")
    if by.keys[0].type.element is not None and not by.arrays:
        raise NotCoveredError("its ids are bytes")
    if of.openings():
        raise NotCoveredError("it reads values at openings, for each id")
    if of.messages():
        raise NotCoveredError("it reads ages, for each id")
    steps = (step for each in of.inputs() for _, field in fields(each.signal) for step in field.path)
    if e.OfSlice(is_missing=True) in steps:
        raise NotCoveredError("it reads whether ids are gone")


def stated_key(of: PropertySpecification) -> Data | None:
    """What has the ids of a property that is judged for each; None if it is not."""
    if not isinstance(of.slicing, Slicing):
        return None
    [key] = of.slicing.keys
    assert isinstance(key.definition, e.Field)
    return _field(key.definition)


def whole_run(of: PropertySpecification, by: Instances) -> PropertySpecification:
    """What `each new s: P` says of instances, of a run in which all its messages open one."""
    mark, news = e.IsTrue(e.New(by.mark)), e.IsTrue(e.New(by.signal))
    atoms = tuple(replace(atom, condition=news) if atom.condition == mark else atom for atom in of.atoms)
    return replace(of, atoms=atoms, slicing=None)


def opening_atom(of: PropertySpecification) -> int | None:
    """The number of the atom that opens instances; None if there are none."""
    if not isinstance(of.slicing, Instances):
        return None
    mark = e.IsTrue(e.New(of.slicing.mark))
    return next(number for number, atom in enumerate(of.atoms) if atom.condition == mark)


def numbered_scopes(of: PropertySpecification) -> dict[Clock, int]:
    """The scopes at whose opening values are taken, with their numbers in the property of the certificate."""
    clocks = scope_clocks(without_intervals(of.property))
    found = {clock: clocks.index(clock) for clock in of.openings().values()}
    return dict(sorted(found.items(), key=lambda pair: pair[1]))


def stated_counts(of: PropertySpecification) -> tuple[StatedCount, ...]:
    """What a property counts, by the numbers of its atoms."""
    numbers = {atom.name: number for number, atom in enumerate(of.atoms)}
    return tuple(stated_count(each, numbers) for each in of.counts())


def stated_signals(properties: Iterable[PropertySpecification]) -> tuple[StatedSignal, ...]:
    """What a column of a table may be: fields, and what the author has named. Raises NotCoveredError."""
    writer = _Writer({}, {})
    read = signals_of(properties).values()
    found = (each for each in read if not (each.is_taken or each.is_constant or " " in each.name))
    return tuple(StatedSignal(each.name, _type(each), writer.definition(each)) for each in found)


def _type(signal: e.Signal) -> str:
    """The type of the values of a signal, as ROS 2 has it."""
    one = signal.type if signal.type.element is None else signal.type.element
    numbers = next(name for name, numbers in PRIMITIVES.items() if numbers == signal.numbers)
    names = {e.ValueType.BOOLEAN: "bool", e.ValueType.STRING: "string"}
    return names.get(one, numbers) + ("" if one is signal.type else "[]")


def asks_between_steps(property_: Property) -> bool:
    """Whether `previously` is asked of what can change while nothing happens."""
    atoms = (atom for part in predicates(property_) for atom in atoms_within(part))
    return any(isinstance(atom, Previously) and _changes_by_itself(atom.operand) for atom in atoms)


def _changes_by_itself(formula: ltl.Formula) -> bool:
    """Whether `formula` can change between two steps: by news that is over, by time, or by a nanosecond."""
    return any(
        isinstance(atom, News | Age | Late | Previously) or duration_of(atom) is not None
        for atom in timed_atoms(formula)
    )


MOST_ATOMS = 62
"""The letters of a property are bits of an integer."""


def _topics(of: PropertySpecification, signal: str) -> tuple[str, ...]:
    """The topics of the news of a signal that a property reads."""
    [news] = {i.signal for i in of.inputs() if isinstance(i, e.New) and i.signal.name == signal}
    return topics_of(news)


def _message(condition: e.Condition) -> dict[str, object]:
    match condition:
        case e.IsTrue(e.New(signal)):
            return {"message": sorted(topics_of(signal))}
        case _:
            raise TypeError(f"not that a message comes: {condition}")


class _Writer:
    """Writes conditions and expressions; some inputs are something in place of a first value.

    Values at `openings` are taken in the scopes with these numbers.
    """

    def __init__(self, standing: Mapping[e.Current, _Standing], openings: Mapping[e.Opening, int]) -> None:
        self.standing = standing
        self.openings = openings

    def condition(self, what: e.Condition) -> Json:
        """A condition."""
        match what:
            case e.Comparison(left, e.Relation.EQUAL, right, margin) if margin:
                apart = _call("gap", self.expression(left), self.expression(right))
                return _call("<=", _call("abs", apart), _number(margin))
            case e.Comparison(left, relation, right, margin) if margin:
                moved = _call("+", self.expression(right), _number(margin))
                return _call(relation.value, self._in_doubles(left), moved)
            case e.Comparison(left, relation, right):
                return _call(relation.value, self.expression(left), self.expression(right))
            case e.Same(left, right):
                return _call("==", self.expression(left), self.expression(right))
            case e.IsTrue(operand):
                return self.expression(operand)

    def expression(self, of: e.Expression) -> Json:
        """An expression."""
        match of:
            case e.Number(value):
                return _number(value)
            case e.Boolean(value) | e.String(value):
                return value
            case e.Current(signal):
                return self._current(of, signal)
            case e.Past(signal, ago):
                return self.expression(_definition(signal)) if signal.is_constant else {"ago": ago, **self._of(signal)}
            case e.Recent(signal, ago):
                return {"recent": ago, **self._of(signal)}
            case e.Slope(signal):
                return {"slope": True, **self._of(signal)}
            case e.New(signal):
                return {"new": sorted(topics_of(signal))}
            case e.Opening(signal):
                return {"opening": self._latest(signal), "scope": self.openings[of]}
            case e.Slice(array, start, stop):
                return _call("slice", self.expression(array), start, stop)
            case e.Negative(operand):
                return _call("neg", self.expression(operand))
            case e.Arithmetic(operator, left, right):
                return _call(operator.value, self._in_doubles(left), self._in_doubles(right))
            case e.Call(function, [array]) if of.array is not None:
                return _call(_OF_ARRAYS.get(function, function.value), self.expression(array))
            case e.Call(function, arguments) if numbers_of(of).is_wide:
                return _call(function.value, *map(self.expression, arguments))
            case e.Call(function, arguments):
                return _call(function.value, *map(self._in_doubles, arguments))
            case e.Count(predicate, conditions):
                inside = _OfElements(self, of)
                said = inside.predicate(predicate, dict(conditions))
                lists = [[self.expression(each.array) for each in elements] for elements in of.lists]
                return {"count": said, "over": lists, "beside": [self.expression(each) for each in inside.beside]}
            case e.When(predicate, conditions):
                return self.predicate(predicate, dict(conditions))
            case e.Element():
                raise TypeError("an element outside of a count")
            case _:
                assert_never(of)

    def _in_doubles(self, of: e.Expression) -> Json:
        """An expression that is no integer which could be no double."""
        said = self.expression(of)
        return _call("double", said) if numbers_of(of).is_wide and not isinstance(of, e.Number) else said

    def definition(self, signal: e.Signal) -> dict[str, object]:
        """What a signal is: a field, or an expression, whose latest value it is."""
        if isinstance(signal.definition, e.Field):
            return _field(signal.definition)
        found = self.expression(signal.definition)
        assert isinstance(found, dict), "it is computed from other signals"
        return found

    def _current(self, wanted: e.Current, signal: e.Signal) -> Json:
        if (standing := self.standing.get(wanted)) is not None:
            news = {"news": sorted(standing.topics)} if standing.topics else {}
            return {"instead": _instead(standing.value), **news, "of": self._latest(signal)}
        if signal.otherwise is not None:
            raise NotCoveredError("it computes with a value that stands in for a sample")
        return self._latest(signal)

    def _latest(self, signal: e.Signal) -> Json:
        """The latest sample; of what is computed from latest samples, and of all of them, that is computed anew."""
        if isinstance(signal.definition, e.Field) or signal.when is not None:
            return self._of(signal)["of"]
        return self.expression(signal.definition)

    def _of(self, signal: e.Signal) -> dict[str, object]:
        """The samples of a signal."""
        if isinstance(signal.definition, e.Field):
            return {"of": _field(signal.definition)}
        sampled: dict[str, object] = {"sampled": self.expression(signal.definition)}
        if signal.when is not None:
            sampled["when"] = self.predicate(signal.when.predicate, dict(signal.when.conditions))
            asked = ltl.atoms(signal.when.predicate)
            others = (each for name, each in signal.when.conditions if name not in asked)
            for side in (self.expression(side) for each in others for side in e.operands(each)):
                sampled["when"] = _call("and", sampled["when"], _call("==", side, side))  # it has to be no NaN
        return {"of": sampled}

    def predicate(self, formula: ltl.Formula, conditions: Mapping[str, e.Condition]) -> Json:
        """A state predicate over conditions by their names."""
        match formula:
            case ltl.Truth():
                return True
            case ltl.Atom(name):
                return self.condition(conditions[name])
            case ltl.Not(operand):
                return _call("not", self.predicate(operand, conditions))
            case ltl.And(left, right) | ltl.Or(left, right):
                name = "and" if isinstance(formula, ltl.And) else "or"
                return _call(name, *(self.predicate(each, conditions) for each in (left, right)))
            case _:
                raise TypeError(f"not a state predicate: {formula}")


class _OfElements(_Writer):
    """Writes the predicate of a count: of elements, by the numbers of their arrays, and of what is `beside` them."""

    def __init__(self, outer: _Writer, of: e.Count) -> None:
        super().__init__(outer.standing, outer.openings)
        self._elements = [each for elements in of.lists for each in elements]
        inside = {*e.subexpressions(of)}
        self.beside = [each for each in of.singles if each in inside and any(True for _ in e.reads(each))]

    def expression(self, of: e.Expression) -> Json:
        """An expression."""
        numbered = [*self._elements, *self.beside]
        return {"element": numbered.index(of)} if of in numbered else super().expression(of)


_OF_ARRAYS = {Function.MIN: "least", Function.MAX: "greatest"}
"""Functions of one array that are called as a function of numbers is."""


def _call(name: str, *of: Json) -> dict[str, object]:
    return {"call": name, "of": list(of)}


def _definition(signal: e.Signal) -> e.Expression:
    assert not isinstance(signal.definition, e.Field)
    return signal.definition


def _instead(value: Instead) -> Json:
    if isinstance(value, tuple):
        return [_instead(each) for each in value]
    return value if isinstance(value, bool | str) else _number(value)


def _number(value: float) -> Json:
    """A number as JSON; one that JSON does not have, as text."""
    exact = double_or_integer(value) if isinstance(value, int) else value
    return exact if math.isfinite(exact) else _call("number", repr(exact))


def _field(field: e.Field) -> dict[str, object]:
    return {"topic": field.topic, "type": field.message, "path": list(_path(field.path))}


def _path(steps: Iterable[e.PathStep]) -> Iterator[Json]:
    for step in steps:
        match step:
            case str() | int():
                yield step
            case e.Match(key, value):
                yield ["match", key, value]
            case e.Parallel(names, value):
                yield ["parallel", names, value]
            case e.Each():
                yield ["each"]
            case e.Bytes():
                yield ["bytes"]
            case e.OfSlice():
                yield ["own"]
            case _:
                assert_never(step)
