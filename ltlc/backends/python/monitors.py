"""A property as a class with a method `step`: for programs that step it themselves, and for the runtime."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from ltlc.backends.counts import Counting, ages, countings, heard, noted, presumed
from ltlc.backends.names import Names, input_name
from ltlc.backends.python.code import bracketed, literal
from ltlc.backends.python.code import lines as lines_of
from ltlc.backends.python.expressions import RUNTIME_FUNCTIONS, calculated_inputs, python_speller
from ltlc.backends.python.wording import PYTHON, dispatched
from ltlc.backends.statements import Do, If, Statement, conjunction, disjunction
from ltlc.backends.steps import Late, Steps, clock_names, scheduled
from ltlc.backends.trees import INDENT, LINE_LENGTH, Call, Chain, Code, Prefix, Text, prose, wrapped
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.program.expressions import Expression, Kept, News, reads_of
from ltlc.program.lowering import condition, read
from ltlc.program.machine import Clock, Instead, Machine
from ltlc.semantics.timed_atoms import timed_atoms
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.expressions import (
    Current,
    Input,
    New,
    Opening,
    Past,
    Read,
    Recent,
    Signal,
    ValueType,
    value_type,
)
from ltlc.specification.samples import reach
from ltlc.specification.specification import PropertySpecification

TYPES = {
    ValueType.NUMBER: "float",
    ValueType.BOOLEAN: "bool",
    ValueType.STRING: "str",
    ValueType.NUMBERS: "Sequence[float]",
    ValueType.BOOLEANS: "Sequence[bool]",
    ValueType.STRINGS: "Sequence[str]",
}
MODULE_NAMES = RUNTIME_FUNCTIONS | {
    *("Any", "Enum", "Fraction", "INFINITY", "Monitors", "NEVER", "Sequence", "Verdict", "annotations", "deque", "eq"),
    "plan",
    *(verdict.name for verdict in Verdict),
}
"""Names of the emitted file that those of signals and properties must not hide."""

VERDICTS = f"{', '.join(verdict.name for verdict in Verdict)} = Verdict"
"""What binds the verdicts to names of their own: looking them up in their class takes as long as a step."""

_BODY = INDENT * 2

_CAUGHT_UP = ("while time > self.due:", f"{INDENT}self.expire()")
"""The clock steps that are due are taken."""

_ATTRIBUTES = frozenset({"_schedule", "_values", "due", "expire", "invalid", "state", "step", "verdict"})


@dataclass(frozen=True)
class MonitorClass:
    """An emitted class: its name, its text, and what `step` takes.

    That of a `timed` one takes the time before the parameters, of which those that are `optional` may be None.
    """

    name: str
    text: str
    timed: bool
    parameters: tuple[tuple[str, Signal], ...]
    optional: frozenset[str]


def standalone_class(compiled: Compiled, name: str, source: str, signals: Mapping[Signal, str]) -> MonitorClass:
    """A monitor whose `step` takes the values of signals, called as in `signals`; it keeps their history itself."""
    return _Writer(compiled, name, source, compiled.specification.inputs(), signals).written()


def runtime_class(compiled: Compiled, name: str, source: str, inputs: Sequence[Input] | None = None) -> MonitorClass:
    """A monitor whose `step` takes the values of `inputs`, by default the specification's, numbers as floats, in order.

    It is a `ltlc.runtime.properties.Monitor`.
    """
    return _Writer(compiled, name, source, inputs or compiled.specification.inputs(), None).written()


class _Writer:
    """What the parts of one class have in common."""

    def __init__(
        self,
        compiled: Compiled,
        name: str,
        source: str,
        inputs: Sequence[Input],
        signals: Mapping[Signal, str] | None,
    ) -> None:
        self.inputs = inputs
        self.specification: PropertySpecification = compiled.specification
        self.machine = compiled.machine
        self.timed = bool(timed_atoms(compiled.formula))
        self.name = name
        self.source = source
        self.standalone = signals is not None
        names = Names(MODULE_NAMES | {"time"} | frozenset((signals or {}).values()))
        self.names: dict[Expression, str] = {}
        self.parameters = self._inputs(names) if signals is None else self._signals(signals)
        self.past = {} if signals is None else self._past(names)
        self.openings = opening_names(compiled)
        self.names |= {read(opening): names.unique(input_name(read(opening))) for opening in self.openings}
        self.histories = self._histories()
        self.undefined = self._undefined(names)
        self.ages = ages(self.machine)
        self.counts = counted(compiled, self.histories.values())
        self.excused = self.machine.excused if self.standalone else ()

    def _inputs(self, names: Names) -> tuple[tuple[str, Signal], ...]:
        """A parameter for each input, whoever keeps the history."""
        self.names |= {read(i): names.unique(input_name(read(i))) for i in self.inputs}
        return tuple((self._name(i), replace(told(i), type=value_type(i))) for i in self.inputs)

    def _name(self, wanted: Read) -> str:
        """What the value of an input, or at an opening, is called in `step`."""
        return self.names[read(wanted)]

    def _signals(self, signals: Mapping[Signal, str]) -> tuple[tuple[str, Signal], ...]:
        """A parameter for each signal."""
        given = {i if isinstance(i, New) else Current(i.signal): signals[told(i)] for i in self.inputs}
        self.names |= {read(i): name for i, name in given.items()}
        return tuple((signals[signal], signal) for signal in dict.fromkeys(map(told, self.inputs)))

    def _past(self, names: Names) -> dict[Signal, list[Past | Recent]]:
        """The past values wanted of each signal."""
        past: dict[Signal, list[Past | Recent]] = {}
        for wanted in self.inputs:
            if isinstance(wanted, Past | Recent):
                past.setdefault(wanted.signal, []).append(wanted)
                self.names[read(wanted)] = names.unique(input_name(read(wanted)))
        return past

    def _histories(self) -> dict[Signal, str]:
        """The attributes that have the last samples of signals whose past is wanted."""
        attributes = _attributes(self.machine, self.openings.values())
        return {signal: attributes.unique(f"_{self._name(Current(signal))}") for signal in self.past}

    def _undefined(self, names: Names) -> dict[Expression, str]:
        """Local variables for what can be NaN though no input is: computed at each step, whatever the state asks."""
        computed = (guard for guard in self.machine.guards if guard not in self.machine.inputs)
        return {guard: names.unique("value") for guard in computed}

    def written(self) -> MonitorClass:
        """The class."""
        speller = python_speller(self.names | self.undefined)

        def ask(atom: int, holds: bool) -> Code:
            return speller.asked(self.machine.atoms[atom], holds)

        steps = Steps(self.machine, ask, self._handed_on(), PYTHON)
        clock_steps = Steps(self.machine, ask, self._handed_on(), PYTHON, held=True, take=self._take)
        head = [f"class {self.name}:", *self._docstring(), "", *self._slots(clock_steps), ""]
        lines = [*head, *self._initial(), "", *self._step(steps, clock_steps)]
        for number, body in steps.shared():
            lines += ["", *self._method(steps.method(number), body)]
        if self.timed:
            lines += self._clock_steps(clock_steps)
        if self.ages or self.counts:
            lines += self._schedule()
        written = "".join(f"{line}\n" for line in lines)
        return MonitorClass(self.name, written, self.timed, self.parameters, self._optional())

    def _docstring(self) -> list[str]:
        where = f"Line {self.specification.line} of {self.source}"
        return docstring(f"{where}:", self.specification.text)

    def _slots(self, clock_steps: Steps) -> list[str]:
        """What a monitor has, and nothing else: without a dictionary it takes 40 bytes less."""
        names = {"state", "verdict", "invalid", *self.openings.values(), *self.histories.values()}
        names.update(*((each.times, *each.members()) for each in self.counts))
        if self.timed:
            names |= {"due", *clock_names(self.machine)}
        if self._judges_values(clock_steps):
            names.add("_values")
        return bracketed(f"{INDENT}__slots__ = (", [literal(name) for name in sorted(names)], ")")

    def _initial(self) -> list[str]:
        head = f"{INDENT}def __init__(self{', session: int' if self.timed else ''}) -> None:"
        members: list[Statement] = ["self.state = 0", "self.verdict = NOT_STARTED", "self.invalid = 0"]
        members += self._initial_clocks() if self.timed else ()
        members += [f"self.{name}: {TYPES[o.signal.type]}" for o, name in self.openings.items()]
        for signal, past in self.past.items():
            typed = f"self.{self.histories[signal]}: deque[{TYPES[signal.type]}] = "
            members.append(Do(typed, Call("deque", (Text(f"maxlen={max(map(reach, past))}"),))))
        return [head, *lines_of(members, _BODY)]

    def _initial_clocks(self) -> Iterator[Statement]:
        clocks = clock_names(self.machine)
        for name, clock in zip(clocks, self.machine.clocks, strict=True):
            yield f"self.{name} = {_first_due(clock)}"
        if clocks != ["due"]:
            yield "self.due = NEVER"
        for each in self.counts:
            yield f"self.{each.times}: deque[int] = deque(maxlen={each.of.times})"
            yield from (f"self.{held} = False" for held in each.members())

    def _step(self, steps: Steps, clock_steps: Steps) -> list[str]:
        time = ["time: int"] if self.timed else []
        items = ["self", *time, *self._parameters()]
        lines = bracketed(f"{INDENT}def step(", items, ") -> Verdict:")
        lines.append(f'{_BODY}"""Judge one more step; it is skipped if a value is NaN."""')
        is_plain = not (self.past or self.openings or self.ages or self.counts or self.excused)
        asks_late = self.timed and is_plain
        statements = [
            *(_CAUGHT_UP if self.timed and not asks_late else ()),
            *(self._told() if self.standalone else ()),
            *self._taken(),
            *self._values(self.undefined),
            *self._validity(asks_late),
            *self._openings_kept(),
            *self._counted(),
            *dispatched(steps, self._begun_anew(clock_steps) if asks_late else None),
            *self._kept(clock_steps),
            "return self.verdict",
        ]
        return [*lines, *lines_of(statements, _BODY)]

    def _told(self) -> Iterator[Statement]:
        """How samples from a program are taken, without history."""
        yield from self._hearing()
        yield from self._stand_ins()
        yield from self._conversions()
        yield from self._history()

    def _taken(self) -> Iterator[Statement]:
        """At a step at which a scope is not open, the values at its opening are the latest."""
        for register, (opening, kept) in zip(self.machine.registers, self.openings.items(), strict=True):
            latest, states = self.names[register.latest], sorted(register.closed)
            within = f"== {states[0]}" if len(states) == 1 else f"in {tuple(states)}"
            always = len(states) == len(self.machine.states)
            value = latest if always else f"{latest} if self.state {within} else self.{kept}"
            yield Do(f"{self._name(opening)} = ", Text(value))

    def _openings_kept(self) -> list[str]:
        """If the step is one."""
        return [f"self.{kept} = {self._name(opening)}" for opening, kept in self.openings.items()]

    def _counted(self) -> Iterator[Statement]:
        """What the first step presumes, and what occurs."""
        yield from (If(PYTHON.is_new(), (each,)) for each in presumed(self.counts, PYTHON))
        yield from noted(self.counts, PYTHON, python_speller(self.names | self.undefined).asked)

    def _begun_anew(self, clock_steps: Steps) -> Late:
        """A step that comes after a clock step: only states in which a clock runs have to ask for that.

        Not where history is kept, which a step that begins anew would keep twice, nor where values are taken at an
        opening, nor where messages renew ages.
        """
        again = Call("self.step", tuple(map(Text, ["time", *(name for name, _ in self.parameters)])))
        past_due = Chain((Text("time"), Text("self.due")), (">",))
        return Late(clock_steps.busy().keys(), past_due, ("self.expire()", Do("return ", again)))

    def _parameters(self) -> list[str]:
        """What a step is told, with types: of what is not waited for, None if it has no value yet."""
        optional = self._optional()
        return [f"{n}: {TYPES[s.type]}{' | None' if n in optional else ''}" for n, s in self.parameters]

    def _optional(self) -> frozenset[str]:
        return frozenset(self.names[each.input] for each in self.excused)

    def _stand_ins(self) -> Iterator[Statement]:
        """Something else is given for what has no value; if that has come nevertheless, there is no step."""
        for wanted, news, instead in self.excused:
            name = self.names[wanted]
            came = conjunction([Text(self.names[each]) for each in news])
            none = (If(came, self._invalid(bool(self.ages))),) if news else ()
            missing = Chain((Text(name), Text("None")), ("is",))
            yield If(missing, (*none, Do(f"{name} = ", Text(instead_text(instead)))))

    def _invalid(self, catches_up: bool) -> tuple[Statement, ...]:
        """There is no step; where messages renew ages, what makes none may be a clock step."""
        return ("self.invalid += 1", *(_CAUGHT_UP if catches_up else ()), "return self.verdict")

    def _conversions(self) -> Iterator[Statement]:
        """Numbers that are calculated with are made doubles; others are compared, exactly, as they are.

        The elements of an array are made Python's own, which compare as doubles, and faster. Integers that may be no
        doubles are made such where they are calculated with.
        """
        conditions = (condition(atom.condition) for atom in self.specification.atoms)
        signals = calculated_inputs([*conditions, *self.machine.guards])
        for name, signal in self.parameters:
            if signal.type.element is not None:
                is_calculated = signal.name in signals and not signal.numbers.is_wide
                function = "doubles_of" if is_calculated and signal.type is ValueType.NUMBERS else "elements_of"
                yield Do(f"{name} = ", Call(function, (Text(name),)))
            elif signal.name in signals and signal.type is ValueType.NUMBER and not signal.numbers.is_wide:
                other = Chain((Call("type", (Text(name),)), Text("float")), ("is not",))
                yield If(other, (Do(f"{name} = ", Call("number", (Text(name),))),))

    def _history(self) -> Iterator[Statement]:
        for signal, history in self.histories.items():
            yield Do("", Call(f"self.{history}.append", (Text(self._name(Current(signal))),)))
        if short := [self._is_short(signal) for signal in self.past]:
            yield If(disjunction(short), ("return self.verdict",))
        for signal, past in self.past.items():
            history = self.histories[signal]
            for wanted in past:
                kept = f"self.{history}" if isinstance(wanted, Past) else f"tuple(self.{history})"
                place = f"[-{reach(wanted)}{':' if isinstance(wanted, Recent) else ''}]"
                yield Do(f"{self._name(wanted)} = ", Text(f"{kept}{place}"))

    def _hearing(self) -> list[Statement]:
        """Ages count from a message, whether or not it makes a step; if it makes none, one that was late is due."""
        can_be_none = bool(self._undefined_values() or self.excused)
        came = {age.signal: self.names[News(age.signal)] for _, age in self.ages}
        return heard(self.machine, came, PYTHON, can_be_none)

    def _is_short(self, signal: Signal) -> Code:
        depth = max(map(reach, self.past[signal]))
        return Chain((Text(f"len(self.{self.histories[signal]})"), Text(str(depth))), ("<",))

    def _take(self, registers: Sequence[int]) -> tuple[Statement, ...]:
        """At a clock step at which a scope opens, the values at its opening are those that are held."""
        kept = list(self.openings.values())
        return tuple(f"self.{kept[n]} = {self.names[self.machine.registers[n].latest]}" for n in registers)

    def _values(self, parts: Iterable[Expression]) -> list[Statement]:
        speller = python_speller(self.names)
        return [Do(f"{self.undefined[part]} = ", speller.code(part)) for part in parts]

    def _validity(self, asks_late: bool) -> list[Statement]:
        """NaN is the only number that is not at most infinite; that goes for integers of any size, too."""
        checks = [Prefix("not ", Chain((Text(name), Text("INFINITY")), ("<=",))) for name in self._undefined_values()]
        catches_up = asks_late or bool(self.ages and self.standalone)
        return [If(disjunction(checks), self._invalid(catches_up))] if checks else []

    def _undefined_values(self) -> list[str]:
        """What can be NaN."""
        sampled = [i for i in self.inputs if not isinstance(i, New)]
        return [*(self._name(i) for i in sampled if value_type(i) is ValueType.NUMBER), *self.undefined.values()]

    def _handed_on(self) -> list[str]:
        """The local variables that conditions use."""
        time = ["time"] if self.timed else []
        names = (self._name(i) for i in self._read())
        return [*dict.fromkeys([*time, *names, *self.undefined.values()])]

    def _read(self) -> list[Read]:
        """What conditions read: not the messages that only renew ages."""
        asked = {each for atom in self.machine.atoms for each in reads_of(atom)}
        return [i for i in (*self.inputs, *self.openings) if not isinstance(i, New) or read(i) in asked]

    def _method(self, name: str, body: Sequence[Statement]) -> list[str]:
        types = {self._name(i): TYPES[value_type(i)] for i in self._read()} | {"time": "int"}
        items = ["self", *(f"{name}: {types.get(name, 'float')}" for name in self._handed_on())]
        return [*bracketed(f"{INDENT}def {name}(", items, ") -> None:"), *lines_of(body, _BODY)]

    def _kept(self, steps: Steps) -> list[str]:
        """Clock steps judge the values of the last step, if they judge any."""
        return [f"self._values = {self._values_held()}"] if self._judges_values(steps) else []

    def _judges_values(self, steps: Steps) -> bool:
        return bool(steps.asked_atoms()) or any(outcome.taken for outcome in self.machine.outcomes)

    def _values_held(self) -> str:
        """What does not depend on values at openings, which are kept by themselves."""
        apart = {"time", *map(self._name, self.openings), *(self.undefined[p] for p in self._undefined_anew())}
        values = [name for name in self._handed_on() if name not in apart]
        return ", ".join(values) + ("," if len(values) == 1 else "")

    def _undefined_anew(self) -> list[Expression]:
        """What can be NaN though no input is, and depends on values at openings."""
        return [part for part in self.undefined if any(isinstance(each, Kept) for each in reads_of(part))]

    def _values_anew(self) -> Iterator[Statement]:
        """The values of the last step, and those at openings as they are now."""
        yield f"{self._values_held()} = self._values"
        yield from (f"{self._name(opening)} = self.{kept}" for opening, kept in self.openings.items())
        yield from self._values(self._undefined_anew())

    def _clock_steps(self, steps: Steps) -> list[str]:
        """The method that takes the next clock step, and those that it shares decisions with."""
        body = lines_of(dispatched(steps), _BODY)
        reads_time = any(re.search(r"\btime\b", line) for line in body)
        lines = [
            "",
            f"{INDENT}def expire(self) -> None:",
            f'{_BODY}"""Take the next clock step: what changes by itself after `due`."""',
            f"{_BODY}if self.due >= NEVER:",
            f'{_BODY}{INDENT}raise ValueError("times are before 2**62 ns, the year 2116")',
            *([f"{_BODY}time = self.due + 1"] if reads_time else []),
            *lines_of(self._values_anew() if self._judges_values(steps) else (), _BODY),
            *body,
        ]
        for number, shared in steps.shared():
            lines += ["", *self._method(steps.method(number), shared)]
        return lines

    def _schedule(self) -> list[str]:
        """The method that says when the next clock step is due."""
        return [
            "",
            f"{INDENT}def _schedule(self, time: int) -> None:",
            f'{_BODY}"""The next clock step is due when a clock is that is set, or asked and not late."""',
            *lines_of(scheduled(self.machine, PYTHON), _BODY),
        ]


def _first_due(clock: Clock) -> str:
    """When a clock is due as the session begins: what is counted is late."""
    if clock.age is not None:
        return f"session + {clock.age.duration:_}"
    return "NEVER" if clock.is_set else "-NEVER"


def counted(compiled: Compiled, histories: Iterable[str] = ()) -> list[Counting]:
    """What the emitted class of a property counts, which has these attributes for histories."""
    names = _attributes(compiled.machine, [*opening_names(compiled).values(), *histories])
    return countings(compiled.machine, lambda what, number: names.unique(f"_{what}"))


def opening_names(compiled: Compiled) -> dict[Opening, str]:
    """The attributes of the emitted class that have the values at an opening."""
    names = _attributes(compiled.machine)
    return {opening: names.unique(f"_{input_name(read(opening))}") for opening in compiled.specification.openings()}


def _attributes(machine: Machine, taken: Iterable[str] = ()) -> Names:
    """The attributes of the emitted class, to which others may be added."""
    return Names(_ATTRIBUTES | frozenset(clock_names(machine)) | frozenset(taken))


def told(wanted: Input) -> Signal:
    """What a step is told for `wanted`: the value of its signal; of news, whether there is any."""
    if isinstance(wanted, New):
        return replace(wanted.signal, name=f"new {wanted.signal.name}", type=ValueType.BOOLEAN)
    return wanted.signal


def docstring(first: str, text: str, indent: str = INDENT) -> list[str]:
    """A docstring with a first line and a paragraph that may hold anything."""
    paragraph = wrapped([prose(text)], LINE_LENGTH - len(indent))
    return [f'{indent}"""{prose(first)}', "", *(indent + line for line in paragraph), f'{indent}"""']


def instead_text(value: Instead) -> str:
    """What stands in for a value, as a literal."""
    if isinstance(value, str):
        return literal(value)
    return repr(value)
