"""What a method does, for all values at once: its effects as a decision diagram over what can be true of the values.

Two things are kept apart that the text mixes: a step that comes after a clock step was due only says so (`CaughtUp`),
since what it then does is to take the clock step and to begin anew; all others say what has become of the attributes.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

from ltlc.assurance.reading.language import (
    Apply,
    Assign,
    Attribute,
    Block,
    Choice,
    Constant,
    Do,
    Elements,
    If,
    Moment,
    NotUnderstoodError,
    Push,
    Return,
    Statement,
    StepClass,
    Term,
    Unpack,
    Variable,
    While,
)
from ltlc.assurance.reading.meaning import Given
from ltlc.assurance.reading.text import text
from ltlc.assurance.reading.times import is_least, of_times
from ltlc.assurance.reading.truths import LOOSE, Truths, bare, element, tight
from ltlc.semantics.diagrams import Diagram
from ltlc.specification.expressions import Current, Opening, Past

DEEPEST = 100
"""Calls nested deeper than this are not followed."""


@dataclass(frozen=True, slots=True)
class Left:
    """A method ended, returned a value or none, and left the attributes so."""

    attributes: frozenset[tuple[str, Term]]
    returned: Term | None

    def __getitem__(self, name: str) -> Term | None:
        return dict(self.attributes).get(name)


@dataclass(frozen=True, slots=True)
class CaughtUp:
    """The clock steps that are due are taken, after these `changes`; `anew`: then the step is taken, else none."""

    changes: frozenset[tuple[str, Term]]
    anew: bool


class _Flow(NamedTuple):
    """The attributes and variables after a statement; `returned` is what the method has ended with."""

    attributes: frozenset[tuple[str, Term]]
    variables: frozenset[tuple[str, Term]]
    returned: Term | None = None
    has_ended: bool = False


class _Place(NamedTuple):
    """The attributes and variables before a statement."""

    attributes: dict[str, Term]
    variables: dict[str, Term]

    def flow(self, returned: Term | None = None, has_ended: bool = False) -> _Flow:
        return _Flow(frozenset(self.attributes.items()), frozenset(self.variables.items()), returned, has_ended)


@dataclass(frozen=True, slots=True)
class Openings:
    """The attributes that keep values taken at openings; those of scopes that are not `open` have to be taken anew.

    None for `open`: it does not matter.
    """

    kept: Mapping[str, Opening]
    open: frozenset[Opening] | None


def remembered(opening: Opening) -> Term:
    """What an attribute has kept of an opening up to now."""
    return Apply("kept", (Given(opening),))


class Execution:
    """The methods of `monitor` from one state on, in which its attributes have values."""

    def __init__(self, monitor: StepClass, truths: Truths, attributes: Mapping[str, Term], openings: Openings) -> None:
        self._monitor = monitor
        self._truths = truths
        self._diagrams = truths.diagrams
        self._before = dict(attributes)
        self._openings = openings
        self._known: dict[Hashable, Diagram] = {}
        self._arguments: tuple[Term, ...] = ()

    def run(self, method: str, arguments: tuple[Term, ...]) -> Diagram:
        """What `method` leads to. Raises NotUnderstoodError."""
        if method not in self._monitor.methods:
            raise NotUnderstoodError(f"there is no method `{method}`")
        self._arguments = arguments
        body = self._monitor.methods[method].body
        place = _Place(dict(self._before), self._parameters(method, arguments))
        match body:
            case (While(guard) as first, *rest) if method == "step" and _catches_up(first):
                begun = self._diagrams.terminal(CaughtUp(frozenset(), anew=True))
                after = self._block(tuple(rest), place, 0)
                return self._ended(self._diagrams.choose(self._guard(guard, place), begun, after))
        return self._ended(self._block(body, place, 0))

    def _ended(self, flows: Diagram) -> Diagram:
        def left(flow: object) -> Hashable:
            return Left(flow.attributes, flow.returned) if isinstance(flow, _Flow) else flow

        return self._diagrams.relabel(left, [flows])[0]

    def _parameters(self, method: str, arguments: tuple[Term, ...]) -> dict[str, Term]:
        names = self._monitor.methods[method].parameters
        if len(names) != len(arguments):
            raise NotUnderstoodError(f"`{method}` takes {len(names)} values, not {len(arguments)}")
        return dict(zip(names, arguments, strict=True))

    def _block(self, statements: Block, place: _Place, depth: int) -> Diagram:
        """The flows after `statements`."""
        place = _Place(dict(place.attributes), dict(place.variables))
        for number, statement in enumerate(statements):
            rest = statements[number + 1 :]
            match statement:
                case Assign(target, value):
                    self._assign(target, value, place)
                case Unpack(targets, value):
                    self._unpack(targets, self._value(value, place), place)
                case Push(history, value):
                    self._push(history, self._value(value, place), place)
                case Return(Do()):
                    raise NotUnderstoodError("a step is taken within a step")
                case Return(Constant() | Attribute() | Variable() as value):
                    return self._diagrams.terminal(place.flow(self._value(value, place), has_ended=True))
                case If() | While() | Do():
                    return self._then(self._branched(statement, rest, place, depth), rest, depth)
                case _:
                    raise NotUnderstoodError(f"`{statement}` is nothing that a step does")
        return self._diagrams.terminal(place.flow())

    def _then(self, flows: Diagram, rest: Block, depth: int) -> Diagram:
        """`rest` after each of `flows` that goes on."""
        diagrams, known = self._diagrams, dict[Diagram, Diagram]()

        def visit(diagram: Diagram) -> Diagram:
            if diagram in known:
                return known[diagram]
            if diagrams.is_terminal(diagram):
                flow = diagrams.value(diagram)
                found = diagram
                if isinstance(flow, _Flow) and not flow.has_ended:
                    found = self._block(rest, _Place(dict(flow.attributes), dict(flow.variables)), depth)
            else:
                level, low, high = diagrams.split(diagram)
                found = diagrams.choose(diagrams.variable(level), visit(high), visit(low))
            known[diagram] = found
            return found

        return visit(flows)

    def _branched(self, statement: If | While | Do, rest: Block, place: _Place, depth: int) -> Diagram:
        """The flows after a statement that has several."""
        match statement:
            case If(guard, then, otherwise):
                where = self._guard(guard, place)
                if where == self._diagrams.true:
                    return self._block(then, place, depth)
                if where == self._diagrams.false:
                    return self._block(otherwise, place, depth)
                after_then = self._block(then, place, depth)
                return self._diagrams.choose(where, after_then, self._block(otherwise, self._long(where, place), depth))
            case While():
                return self._waited(statement, rest, place)
            case Do("expire", ()) if len(rest) == 1:
                return self._begun_anew(rest[0], place)
            case Do(method, arguments) if method not in ("start", "step", "expire") and depth < DEEPEST:
                return self._called(method, arguments, place, depth)
        raise NotUnderstoodError(f"`{statement.method}` is not called so")

    def _long(self, where: Diagram, place: _Place) -> _Place:
        """`place` where not `where`: histories that are short only there have all their samples."""
        found = dict(place.variables)
        for name, most in self._monitor.histories:
            short = self._truths.truth(Apply("short", (Attribute(name), Constant(most))))
            if self._diagrams.conjunction(short, where) == short:
                found[_whole(name)] = Constant(True)
        return _Place(place.attributes, found)

    def _waited(self, statement: While, rest: Block, place: _Place) -> Diagram:
        """The clock steps that are due, after which nothing more is done."""
        if not _catches_up(statement) or rest != (Return(Attribute("verdict")),):
            raise NotUnderstoodError("a loop that does more than take the clock steps that are due")
        caught_up = self._diagrams.terminal(CaughtUp(self._changes(place), anew=False))
        return self._diagrams.choose(
            self._guard(statement.guard, place), caught_up, self._diagrams.terminal(place.flow())
        )

    def _begun_anew(self, after: Statement, place: _Place) -> Diagram:
        """A clock step, then the same step again."""
        match after:
            case Return(Do("step", arguments)):
                values = tuple(bare(self._value(each, place)) for each in arguments)
                if values == tuple(map(bare, self._arguments)):
                    return self._diagrams.terminal(CaughtUp(self._changes(place), anew=True))
            case _:
                pass
        raise NotUnderstoodError("after a clock step, the step is not taken with the values that it was given")

    def _changes(self, place: _Place) -> frozenset[tuple[str, Term]]:
        return frozenset(pair for pair in place.attributes.items() if self._before.get(pair[0]) != pair[1])

    def _called(self, method: str, arguments: tuple[Term, ...], place: _Place, depth: int) -> Diagram:
        """A method that decisions share, whatever leads to it."""
        if method not in self._monitor.methods:
            raise NotUnderstoodError(f"there is no method `{method}`")
        variables = self._parameters(method, tuple(self._value(each, place) for each in arguments))
        inner = _Place(place.attributes, variables)
        key = method, inner.flow()
        if key not in self._known:
            self._known[key] = self._block(self._monitor.methods[method].body, inner, depth + 1)
        own = frozenset(place.variables.items())

        def back(flow: object) -> Hashable:
            if not isinstance(flow, _Flow):
                return flow
            return _Flow(flow.attributes, own)

        return self._diagrams.relabel(back, [self._known[key]])[0]

    def _assign(self, target: Variable | Attribute, value: Term, place: _Place) -> None:
        if isinstance(target, Attribute):
            place.attributes[target.name] = self._value(value, place)
            return
        kept = [part.name for part in _attributes(value) if part.name in self._openings.kept]
        found = self._value(value, place)
        place.variables[target.name] = self._opened(kept[0], found, place) if kept else found

    def _opened(self, attribute: str, value: Term, place: _Place) -> Term:
        """The value at an opening, which is the latest one where the scope is not open, else what was kept.

        It is a double if the latest one has been made one.
        """
        opening = self._openings.kept[attribute]
        latest = Given(Current(opening.signal))
        right = remembered(opening) if opening in (self._openings.open or ()) else latest
        if self._openings.open is not None and tight(value) != right:
            raise NotUnderstoodError(f"the value at an opening in `{attribute}` is taken elsewhere")
        is_double = latest in place.variables.values()
        return Given(opening) if is_double else Apply(LOOSE, (Given(opening),))

    def _unpack(self, targets: tuple[str, ...], value: Term, place: _Place) -> None:
        match value:
            case Apply("tuple", parts) if len(parts) == len(targets):
                place.variables.update(zip(targets, parts, strict=True))
                return
        raise NotUnderstoodError(f"`{', '.join(targets)}` are not the values that were kept")

    def _push(self, history: str, value: Term, place: _Place) -> None:
        if place.attributes.get(history) != Apply("history", (Attribute(history),)):
            raise NotUnderstoodError(f"`{history}` has more than one sample of a step")
        place.attributes[history] = Apply("pushed", (value,))

    def _guard(self, term: Term, place: _Place) -> Diagram:
        return self._truths.truth(self._value(term, place))

    def _value(self, term: Term, place: _Place) -> Term:
        """The value of a term, in what was read and in what the attributes were."""
        match term:
            case Variable(name) if name in place.variables:
                return place.variables[name]
            case Attribute(name) if name in place.attributes:
                return place.attributes[name]
            case Variable() | Attribute():
                raise NotUnderstoodError(f"`{text(term)}` has no value yet")
            case Choice(guard, then, otherwise):
                where = self._guard(guard, place)
                if where in (self._diagrams.true, self._diagrams.false):
                    return self._value(then if where == self._diagrams.true else otherwise, place)
                raise NotUnderstoodError(f"`{text(term)}` is chosen by more than the state")
            case Elements(names, arrays, guard):
                values = tuple(self._value(each, place) for each in arrays)
                inner = dict(zip(names, map(element, values), strict=True))
                guarded = self._value(guard, _Place(place.attributes, place.variables | inner))
                return self._truths.counted(values, guarded)
            case Apply(function, arguments):
                return self._applied(function, arguments, place)
            case _:
                return term

    def _applied(self, function: str, arguments: tuple[Term, ...], place: _Place) -> Term:
        match function, arguments:
            case "ago", (Attribute(history), Constant(int(samples))):
                return self._ago(history, samples, place)
            case ("<", (Apply("length", (Attribute(history) as of,)), Constant() as most)):
                self._pushed(history, place)
                return Apply("short", (of, most))
            case _:
                pass
        values = tuple(self._value(each, place) for each in arguments)
        if any(isinstance(each, Moment) or is_least(each) for each in values):
            return of_times(function, values)
        return self._truths.applied(function, values)

    def _pushed(self, history: str, place: _Place) -> Term:
        match place.attributes.get(history):
            case Apply("pushed", (value,)):
                return value
            case _:
                raise NotUnderstoodError(f"`{history}` is read before the latest sample is in it")

    def _ago(self, history: str, samples: int, place: _Place) -> Term:
        pushed = self._pushed(history, place)
        most = dict(self._monitor.histories)[history]
        match tight(pushed):
            case Given(Current(signal)) if 1 <= samples < most and _whole(history) in place.variables:
                past = Given(Past(signal, samples))
                return past if tight(pushed) == pushed else Apply(LOOSE, (past,))
        raise NotUnderstoodError(f"`{history}` may have no sample that is {samples} samples old")


def _whole(history: str) -> str:
    """What stands among the variables where a history is known to have all its samples."""
    return f"samples of {history}"


def _catches_up(statement: Statement) -> bool:
    """Whether it takes clock steps, again and again."""
    return isinstance(statement, While) and statement.body == (Do("expire", ()),)


def _attributes(term: Term) -> list[Attribute]:
    match term:
        case Attribute():
            return [term]
        case Choice(_, then, otherwise):
            return [*_attributes(then), *_attributes(otherwise)]
        case _:
            return []
