"""What machines do, as directly as possible: the reference for whatever prints or runs them.

Numbers are computed by the reference for values of specifications; the table of functions only says which function of
the language a primitive is.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from itertools import chain, product
from typing import Any, assert_never

from ltlc.program.expressions import Apply, Count, Each, Expression, Held, Kept, Literal, News, Recent, Slice, Slope
from ltlc.program.functions import ROWS, Primitive
from ltlc.program.machine import Base, Machine, Occurrences, Set
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.monitor import Target
from ltlc.semantics.verdicts import Verdict
from ltlc.specification import evaluation
from ltlc.specification.expressions import Operator
from ltlc.specification.wire import as_double

Value = Any
"""A number, a boolean, a string, or a tuple of such."""

Values = Mapping[Expression, Value]
"""The values of what is read and, in the guard of a count, of elements."""


class Run:
    """A machine from the beginning of a session on; see `ltlc.program.machine`.

    `due` has the due time of each clock, None for never.
    """

    def __init__(self, machine: Machine, session: Nanoseconds = 0) -> None:
        self.machine = machine
        self.state, self.verdict, self.invalid = 0, Verdict.NOT_STARTED, 0
        self.due = [None if clock.age is None else session + clock.age.duration for clock in machine.clocks]
        self.occurred: dict[Occurrences, list[Nanoseconds]] = {
            clock.occurrences: [] for clock in machine.clocks if clock.occurrences
        }
        self._held: set[Occurrences] = set()
        self._last: Nanoseconds | None = None
        self._again = False
        self._values: dict[Expression, Value] = {}

    def hear(self, time: Nanoseconds, signals: Collection[str]) -> None:
        """A message that these signals are read from makes no step."""
        self.hold(time)
        if self._renew(time, signals):
            self._clock_step(time)

    def step(self, time: Nanoseconds, inputs: Sequence[Value], heard: Collection[str] = ()) -> Verdict:
        """The clock steps up to and including `time`, then a step at it, if nothing is NaN.

        Of what is excused, an input may be None. At this time a message came that the signals `heard` are read from.
        """
        self.hold(time)
        is_fresh = self._renew(time, heard)
        told = dict(zip(self.machine.inputs, inputs, strict=True))
        missing = [each for each in self.machine.excused if told[each.input] is None]
        is_step = not any(each.news and all(told[new] for new in each.news) for each in missing)
        told |= {each.input: each.instead for each in missing}
        values = self._values | told
        values |= {r.kept: values[r.latest] for r in self.machine.registers if self.state in r.closed}
        if is_step and not any(is_nan(value(guard, values)) for guard in self.machine.guards):
            self._values = values
            self._count(time)
            self._arrive(time, self.machine.states[self.state].step)
            return self.verdict
        self.invalid += 1
        if is_fresh:
            self._clock_step(time)
        return self.verdict

    def _renew(self, time: Nanoseconds, signals: Collection[str]) -> bool:
        """Ages count from a message at `time`; whether one was late, and clock steps come."""
        was_late = False
        for number, clock in enumerate(self.machine.clocks):
            if clock.age is not None and clock.age.signal in signals:
                was_late = was_late or self._is_late(number, time)
                self.due[number] = time + clock.age.duration
        return was_late and self._last is not None and self.machine.states[self.state].expire is not None

    def _count(self, time: Nanoseconds) -> None:
        """Take note of what occurs at a step, and of when that is over."""
        for number, (_, count) in enumerate(self.machine.clocks):
            if count is None:
                continue
            if count.presumed and count.duration is not None and self._last is None:
                self.due[number] = time + count.duration
            holds = value(count.condition, self._values)
            if holds and not (count.begins and count in self._held):
                self.occurred[count] = [*self.occurred[count], time][-count.times :]
            self._held = self._held | {count} if holds else self._held - {count}
            if len(self.occurred[count]) == count.times and count.duration is not None:
                self.due[number] = self.occurred[count][0] + count.duration

    def _is_late(self, clock: int, time: Nanoseconds) -> bool:
        due, count = self.due[clock], self.machine.clocks[clock].occurrences
        if count is not None and not count.presumed and len(self.occurred[count]) < count.times:
            return True
        return due is not None and time > due

    def hold(self, until: Nanoseconds) -> None:
        """The clock steps up to and including `until`."""
        while (time := self.next()) is not None and time <= until:
            self._clock_step(time)

    def _clock_step(self, time: Nanoseconds) -> None:
        self._values |= {each: False for each in self._values if isinstance(each, News)}
        taken = True
        while taken:
            target = self.machine.states[self.state].expire
            assert target is not None
            taken = self._arrive(time, target)

    def next(self) -> Nanoseconds | None:
        """When the next clock step comes, unless a step comes first."""
        if self._last is None or self.machine.states[self.state].expire is None:
            return None
        last = self._last
        clocks = zip(self.due, self.machine.clocks, strict=True)
        dues = [due for due, clock in clocks if due is not None and (clock.is_set or due >= last)]
        return min((due + 1 for due in ([*dues, last] if self._again else dues)), default=None)

    def _arrive(self, time: Nanoseconds, target: Target) -> bool:
        """Do what `target` leads to; whether that was no more than to take values at openings."""
        outcome = self.machine.outcomes[self._decided(time, target)]
        self.state = outcome.state
        if outcome.taken:
            taken = [self.machine.registers[number] for number in outcome.taken]
            self._values |= {register.kept: self._values[register.latest] for register in taken}
            return True
        self.verdict = self.machine.states[self.state].verdict
        for each in outcome.sets:
            self.due[each.clock] = self._due(time, each)
        self._again, self._last = outcome.again, time
        return False

    def _decided(self, time: Nanoseconds, target: Target) -> int:
        """The number of the outcome that `target` leads to."""
        atoms = self.machine.atoms
        while target < 0:
            question, low, high = self.machine.decisions[~target]
            if question < len(atoms):
                holds = value(atoms[question], self._values)
            else:
                holds = self._is_late(question - len(atoms), time)
            target = high if holds else low
        return target

    def _due(self, time: Nanoseconds, set_: Set) -> Nanoseconds | None:
        match set_.base:
            case Base.NOW:
                return time + set_.duration
            case Base.JUST_BEFORE:
                return time - 1 + set_.duration
            case Base.DUE:
                before = self.due[set_.clock]
                return None if before is None else before + set_.duration
            case Base.NEVER:
                return None
            case _:
                assert_never(set_.base)


def is_nan(found: Value) -> bool:
    """Whether a value is NaN."""
    return isinstance(found, float) and math.isnan(found)


def value(expression: Expression, values: Values) -> Value:
    """The value of an expression where what it reads has these `values`."""
    match expression:
        case Literal(constant):
            return constant
        case Held() | Recent() | Slope() | News() | Kept() | Each():
            return values[expression]
        case Slice(array, start, stop):
            return value(array, values)[start:stop]
        case Count(lists, guard, is_any):
            here = product(*(_elements(arrays, values) for arrays in lists))
            found = float(sum(value(guard, {**values, **dict(chain(*rows))}) for rows in here))
            return found > 0 if is_any else found
        case Apply(primitive, arguments):
            return applied(primitive, [value(argument, values) for argument in arguments])
        case _:
            assert_never(expression)


def _elements(arrays: Sequence[Expression], values: Values) -> list[list[tuple[Expression, Value]]]:
    """The elements of `arrays` for each index up to the end of the shortest."""
    count = min(len(value(array, values)) for array in arrays)
    return [[(Each(array), value(array, values)[index]) for array in arrays] for index in range(count)]


_OPERATORS = {
    Primitive.ADD: Operator.PLUS,
    Primitive.SUBTRACT: Operator.MINUS,
    Primitive.TIMES: Operator.TIMES,
    Primitive.OVER: Operator.OVER,
}


def applied(primitive: Primitive, arguments: Sequence[Value]) -> Value:
    """The value of a primitive of arguments."""
    first, function = arguments[0], ROWS[primitive].of
    if primitive is Primitive.NEAREST:
        return evaluation.nearest(*arguments)
    if function is not None:
        return evaluation.fold(function, first) if isinstance(first, tuple) else evaluation.apply(function, arguments)
    match primitive:
        case Primitive.NEGATE:
            return -first
        case Primitive.ADD | Primitive.SUBTRACT | Primitive.TIMES | Primitive.OVER:
            return evaluation.calculate(_OPERATORS[primitive], *arguments)
        case Primitive.TO_DOUBLE:
            return as_double(first)
        case Primitive.TO_SIGNED | Primitive.TO_UNSIGNED:
            return first
        case Primitive.LESS:
            return first < arguments[1]
        case Primitive.AT_MOST:
            return first <= arguments[1]
        case Primitive.EQUAL | Primitive.SAME:
            return first == arguments[1]
        case Primitive.NOT:
            return not first
        case Primitive.AND:
            return all(arguments)
        case Primitive.OR:
            return any(arguments)
        case Primitive.MEASURED:
            return not is_nan(first)
        case _:
            raise TypeError(f"{primitive} is not a function, and has no case here")
