"""Conditions as decision diagrams, those of a specification and those of a machine alike: equal ones are one number.

The machine need not say them as the specification does. These are all the rewritings under which the two are the same:

- `a > b` is `b < a`. Of numbers, `a <= b` is `not b < a`, and `a != b` is `not a == b`; and, or, not as in logic.
- `x <= INFINITY` says that x is not NaN, for no number is more than that, or less than -INFINITY. A comparison holds of
  no NaN, and `!=` of every one.
- A result is NaN where an operand is. By itself only that of `+ - * /` may be, unless one side is a finite constant (a
  factor or divisor also not 0), of `square_root`, of a function of angles, and of `smallest`, `largest`, `sum_of` and
  `median_of`.
  `smallest`, `largest` and `median_of` an array, and what counts its elements, leave NaN out.
- `x - c` is `x + (-c)` for a constant c, and `c - d` and `abs(c)` of constants are constants. `double(x)` is x where x
  is a double already. `least(least(a, b), c)` is `least(a, b, c)`, and a slice from 0 on one from the first element on.
- Where what is read is an integer of so many bits by its type, `q < 2.5` is `q <= 2`, and what is true of all these
  integers, or of none, is a constant; `least(double(a), 3)` is `least(a, 3)` where all that it can be are doubles.

Nothing else is the same: numbers and texts bit for bit, operands and their order as they stand.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterator, Mapping
from operator import eq, ge, gt, le, lt, ne
from typing import Any

from ltlc.assurance.lowered.language import NONE, Apply, Constant, DiffersError, Term
from ltlc.assurance.lowered.meaning import Counted, ElementOf, Given
from ltlc.assurance.lowered.text import text
from ltlc.semantics.diagrams import Diagram, Diagrams
from ltlc.specification.expressions import Current, Field, Opening, Past, Signal, ValueType
from ltlc.specification.wire import EXACT, Kind, Numbers, as_double

_RELATIONS: Mapping[str, Callable[[Any, Any], bool]] = {"<": lt, "<=": le, ">": gt, ">=": ge, "==": eq, "!=": ne}
_MIRRORED = {"<": ">", "<=": ">=", ">": "<", ">=": "<=", "==": "==", "!=": "!="}
_EXACT = frozenset({"slice", "smallest", "largest", "negative", "abs", "least", "greatest"})
_DEFINED = frozenset({"negative", "abs", "least", "greatest", "gap", "norm", "double", "length_of"})


class Truths:
    """Diagrams whose levels are what can be true or false of the values at a step.

    Levels are made until `close` is called; then a condition that asks anything else raises DiffersError. Up to
    then, `singles` are collected: what speaks of no element in what is counted. A number of elements is never NaN by
    itself: that these have values is for the step to check.
    """

    def __init__(self, diagrams: Diagrams) -> None:
        self.diagrams = diagrams
        self.levels: dict[Hashable, int] = {}
        self._is_closed = False
        self._known: dict[tuple[Term, bool], Diagram] = {}
        self.singles: dict[Term, None] = {}

    def close(self) -> None:
        """From now on nothing new is asked."""
        self._is_closed = True

    def asked(self, fact: Hashable, shown: str) -> Diagram:
        """True where `fact` is; `shown` is how it reads."""
        if fact not in self.levels:
            if self._is_closed:
                raise DiffersError(f"`{shown}` is no condition of the property")
            self.levels[fact] = len(self.levels)
        return self.diagrams.variable(self.levels[fact])

    def normal(self, term: Term) -> Term:
        """A term of the specification as `applied` makes those of the text."""
        match term:
            case Apply(function, arguments):
                return self.applied(function, tuple(map(self.normal, arguments)))
            case ElementOf(array):
                return ElementOf(self.normal(array))
            case Counted(arrays, guard):
                return self.counted(tuple(map(self.normal, arrays)), self.normal(guard))
            case _:
                return term

    def applied(self, function: str, arguments: tuple[Term, ...]) -> Term:
        """A function of terms that are normal."""
        if function == "double" and not _may_be_integer(arguments[0]):
            return _as_double(arguments[0])
        if found := _least_of_integers(function, arguments):
            return found
        match function, arguments:
            case "slice", (array, Constant(0), end):
                return Apply("slice", (array, NONE, end))
            case "least" | "greatest", (Apply(before, first), *rest) if before == function:
                return Apply(function, (*first, *rest))
            case "abs", (Constant(float() as value),):
                return Constant(abs(value))
            case "-", (Constant(float() as value), Constant(float() as other)):
                return Constant(value - other)
            case "-", (left, Constant(float() as value)):
                return Apply("+", (left, Constant(-value)))
            case _:
                return Apply(function, arguments)

    def counted(self, arrays: tuple[Term, ...], guard: Term) -> Counted:
        """How many elements satisfy `guard`, which is made a diagram."""
        found = Counted(frozenset(arrays), Constant(self.truth(guard, within=True)))
        if not self._is_closed:
            self.singles |= dict.fromkeys(_singles(guard))
        return found

    def truth(self, term: Term, within: bool = False) -> Diagram:
        """Where a term that is normal is true; `within` is the guard of what is counted."""
        key = term, within
        if key not in self._known:
            self._known[key] = self._truth(term, within)
        return self._known[key]

    def _truth(self, term: Term, within: bool) -> Diagram:
        diagrams = self.diagrams
        match term:
            case Constant(bool() as value):
                return diagrams.terminal(value)
            case Apply("not", (operand,)):
                return diagrams.negation(self.truth(operand, within))
            case Apply("and", parts):
                return self._all([self.truth(part, within) for part in parts])
            case Apply("or", parts):
                return diagrams.negation(self._all([diagrams.negation(self.truth(part, within)) for part in parts]))
            case Apply("measured", (operand,)):
                return diagrams.negation(self.undefined(operand, within))
            case Apply(relation, (left, right)) if relation in _RELATIONS:
                return self._compared(relation, left, right, within)
        return self.asked(("holds", term), text(term))

    def _all(self, parts: list[Diagram]) -> Diagram:
        found = self.diagrams.true
        for part in reversed(parts):
            found = self.diagrams.conjunction(part, found)
        return found

    def _compared(self, relation: str, left: Term, right: Term, within: bool) -> Diagram:
        diagrams = self.diagrams
        if isinstance(left, Constant) and isinstance(right, Constant):
            return self.diagrams.terminal(_of_literals(relation, left, right))
        if relation == "!=":
            return self.diagrams.negation(self._compared("==", left, right, within))
        for integer, other in ((left, right), (right, left)):
            numbers = self._integers(integer)
            if numbers and isinstance(other, Constant) and isinstance(other.value, int | float):
                if math.isnan(other.value):
                    return diagrams.false
                turned = relation if integer is left else _MIRRORED[relation]
                is_number = diagrams.negation(self.undefined(integer, within))
                return diagrams.conjunction(is_number, self._integer(turned, integer, numbers, other.value))
        sides = dict.fromkeys((left, right))
        if any(map(_is_array, sides)) or (relation != "==" and not all(map(_may_be_number, sides))):
            raise DiffersError(f"`{text(Apply(relation, (left, right)))}` compares what is no number")
        are_numbers = self._all([self.diagrams.negation(self.undefined(side, within)) for side in sides])
        shown = text(Apply(relation, (left, right)))
        match relation:
            case "==":
                holds = self._equal(left, right, shown)
            case "<":
                holds = self._less(left, right, shown)
            case ">":
                holds = self._less(right, left, shown)
            case "<=":
                holds = self.diagrams.negation(self._less(right, left, shown))
            case _:
                holds = self.diagrams.negation(self._less(left, right, shown))
        return self.diagrams.conjunction(are_numbers, holds)

    def _integers(self, term: Term) -> Numbers | None:
        """Which integers a term can be; None if it may be something else."""
        match term:
            case Given(Current() | Past() | Opening() as read) | ElementOf(
                Given(Current() | Past() | Opening() as read)
            ):
                signal = read.signal
                is_integer = signal.numbers.kind is Kind.INTEGER and isinstance(signal.definition, Field)
                is_number = ValueType.NUMBER in (signal.type, signal.type.element)
                return signal.numbers if is_integer and is_number else None
            case ElementOf(Apply("slice", (array, *_))):
                return self._integers(ElementOf(array))
            case _:
                return None

    def _integer(self, relation: str, term: Term, numbers: Numbers, value: float) -> Diagram:
        """An integer compared with a constant."""
        if relation == ">" or relation == ">=":
            return self.diagrams.negation(self._integer("<=" if relation == ">" else "<", term, numbers, value))
        if relation == "==":
            if not numbers.has(value):
                return self.diagrams.false
            return self.asked(("equal", frozenset({term, Constant(int(value))})), f"{text(term)} == {value}")
        if math.isinf(value) or not numbers.least <= value <= numbers.most:
            return self.diagrams.terminal(value > 0)
        last = math.floor(value) if relation == "<=" else math.ceil(value) - 1
        if last < numbers.least or last >= numbers.most:
            return self.diagrams.terminal(last >= numbers.most)
        return self.asked(("at most", term, last), f"{text(term)} {relation} {value}")

    def _equal(self, left: Term, right: Term, shown: str) -> Diagram:
        """Of two that are not NaN."""
        return self.diagrams.true if left == right else self.asked(("equal", frozenset({left, right})), shown)

    def _less(self, left: Term, right: Term, shown: str) -> Diagram:
        """Of two that are not NaN."""
        if left == right or left == Constant(math.inf) or right == Constant(-math.inf):
            return self.diagrams.false
        return self.asked(("less", left, right), shown)

    def undefined(self, term: Term, within: bool = False) -> Diagram:
        """Where `term` is NaN. Within what is counted, what speaks of no element is not: that is checked before."""
        if within and not any(isinstance(part, ElementOf) for part in _parts(term)):
            return self.diagrams.false
        match term:
            case Constant(value):
                return self.diagrams.terminal(isinstance(value, float) and math.isnan(value))
            case Given(Opening(signal)):
                return self.undefined(Given(Current(signal)), within)
            case Given():
                return self.asked(("nan", term), text(term)) if term.is_number else self.diagrams.false
            case ElementOf(array):
                return self.asked(("nan", term), text(term)) if _are_numbers(array) else self.diagrams.false
            case Apply("slice"):
                return self.diagrams.false
            case Apply(_, arguments):
                found = self._some(self.undefined(part, within) for part in arguments if not _is_array(part))
                if _is_defined(term):
                    return found
                return self.diagrams.disjunction(found, self.asked(("undefined", term), text(term)))
            case _:
                return self.diagrams.false

    def _some(self, parts: Iterator[Diagram]) -> Diagram:
        found = self.diagrams.false
        for part in parts:
            found = self.diagrams.disjunction(found, part)
        return found


def _of_literals(relation: str, left: Constant, right: Constant) -> bool:
    try:
        return _RELATIONS[relation](left.value, right.value)
    except TypeError:
        raise DiffersError(f"`{text(Apply(relation, (left, right)))}` compares two kinds of things") from None


def _as_double(term: Term) -> Term:
    return Constant(as_double(term.value)) if isinstance(term, Constant) and type(term.value) is int else term


def _may_be_integer(term: Term) -> bool:
    """Whether the value may be an integer that is no double."""
    match term:
        case Given():
            return term.is_wide
        case ElementOf(array):
            return _may_be_integer(array)
        case Apply(function, arguments):
            return function in _EXACT and any(map(_may_be_integer, arguments))
        case _:
            return False


def _least_of_integers(function: str, terms: tuple[Term, ...]) -> Term | None:
    """The least or greatest of wide integers that were made doubles; rounding keeps order, and what is a double."""
    if function == "double" and _is_narrow(terms[0]):
        return terms[0]
    if function not in ("least", "greatest"):
        return None
    exact = tuple(t.arguments[0] if isinstance(t, Apply) and t.function == "double" else t for t in terms)
    found = Apply(function, exact)
    return found if exact != terms and _is_narrow(found) else None


def _is_narrow(term: Term) -> bool:
    """Whether it is the least or greatest of integers, and all that it can be are doubles."""
    ends = _ends(term) if isinstance(term, Apply) and term.function in ("least", "greatest") else None
    return ends is not None and ends[0] >= -EXACT and ends[1] <= EXACT


def _ends(term: Term) -> tuple[float, float] | None:
    """The least and the most that an integer can be; None if it may be another number."""
    match term:
        case Constant(int() | float() as value) if value % 1 == 0:
            return value, value
        case Given(Current(Signal(numbers=numbers, definition=Field()))) if numbers.kind is Kind.INTEGER:
            return numbers.least, numbers.most
        case Apply("least" | "greatest" as function, parts):
            ends = [_ends(part) for part in parts]
            choose = min if function == "least" else max
            if None not in ends:
                return choose(end[0] for end in ends if end), choose(end[1] for end in ends if end)
        case _:
            pass
    return None


def _is_defined(term: Apply) -> bool:
    """Whether a function is NaN only where an operand is."""
    match term:
        case Apply("+" | "-", (left, right)):
            return _is_finite(left) or _is_finite(right)
        case Apply("*", sides):
            return any(_is_finite(side) and _is_nonzero(side) for side in sides)
        case Apply("/", (_, right)):
            return _is_finite(right) and _is_nonzero(right)
        case _:
            return term.function in _DEFINED


def _is_finite(term: Term) -> bool:
    return isinstance(term, Constant) and isinstance(term.value, float) and math.isfinite(term.value)


def _is_nonzero(term: Term) -> bool:
    return isinstance(term, Constant) and term.value != 0


def _are_numbers(array: Term) -> bool:
    """Whether the elements of an array are numbers."""
    return any(isinstance(part, Given) and part.read.signal.type is ValueType.NUMBERS for part in _parts(array))


def _may_be_number(term: Term) -> bool:
    """Whether a term that is no array is a number, as far as what is read tells."""
    match term:
        case Given():
            return term.is_number
        case ElementOf(array):
            return _are_numbers(array)
        case Constant(value):
            return isinstance(value, int | float) and not isinstance(value, bool)
        case _:
            return True


def _is_array(term: Term) -> bool:
    match term:
        case Given(read):
            return read.signal.type.element is not None
        case Apply("slice", _):
            return True
        case _:
            return False


def _parts(term: Term) -> Iterator[Term]:
    """A term and what it consists of; what is counted is one part."""
    yield term
    match term:
        case Apply(_, arguments):
            for each in arguments:
                yield from _parts(each)
        case ElementOf(array):
            yield from _parts(array)
        case _:
            pass


def _singles(guard: Term) -> Iterator[Term]:
    """The largest parts of what is compared in a guard that speak of no element."""
    match guard:
        case Apply("not" | "and" | "or", parts):
            for part in parts:
                yield from _singles(part)
        case Apply(_, sides):
            for side in sides:
                yield from _single_parts(side)
        case _:
            pass


def _single_parts(term: Term) -> Iterator[Term]:
    if not any(isinstance(part, ElementOf) for part in _parts(term)):
        yield term
        return
    if isinstance(term, Apply):
        for part in term.arguments:
            yield from _single_parts(part)
