"""A property in Rust: a struct with its state, a method that takes a step, and one that takes a clock step."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence, Set

from ltlc.backends.clock_steps import ClockSteps
from ltlc.backends.counts import ages, countings, heard, noted, presumed
from ltlc.backends.inputs import is_from_session
from ltlc.backends.names import Names, input_name
from ltlc.backends.rust.code import comment, lines
from ltlc.backends.rust.expressions import default, instead_text, is_borrowed, rust_speller, type_text
from ltlc.backends.rust.names import RESERVED
from ltlc.backends.rust.signals import Signals
from ltlc.backends.statements import Do, If, Statement, conjunction, disjunction
from ltlc.backends.steps import Steps, clock_names, scheduled
from ltlc.backends.trees import INDENT, Call, Code, Text, prose
from ltlc.backends.wording import Wording
from ltlc.compiler import Compiled
from ltlc.program.expressions import Apply, Expression
from ltlc.program.functions import Primitive
from ltlc.program.lowering import read
from ltlc.program.machine import Instead
from ltlc.program.types import BOOL, DOUBLE, SINGLE, type_of
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.expressions import Input, New
from ltlc.specification.specification import topics_of

_INVALID = "self.judgement.invalid = self.judgement.invalid.wrapping_add(1)"


def verdict_name(verdict: Verdict) -> str:
    """The variant of `Verdict`."""
    return "".join(word.capitalize() for word in verdict.name.split("_"))


WORDING = Wording(
    own="self.",
    judgement="self.judgement.",
    verdicts={verdict: f"Verdict::{verdict_name(verdict)}" for verdict in Verdict},
    is_dated=True,
    never="NEVER",
    duration="{}",
    sooner=lambda times: Text(f"{times[0]}{''.join(f'.min({other})' for other in times[1:])}"),
    noted=lambda times, most: ((f"self.{times}.push(time)",), Text(f"self.{times}.has({most})")),
    first=lambda times, most: f"self.{times}.ago({most - 1})",
    method="self.",
)


class PropertyWriter:
    """The parts of one property, whose struct is called `type_name` and whose member of the monitors `name`."""

    def __init__(self, compiled: Compiled, name: str, type_name: str, signals: Signals) -> None:
        self.compiled = compiled
        self.specification = compiled.specification
        self.machine = compiled.machine
        self.name, self.type_name = name, type_name
        self.signals = signals
        self.from_session = is_from_session(compiled)
        self.clocks = clock_names(self.machine)
        self.ages = ages(self.machine)
        self.counts = countings(self.machine)
        self._name_values()
        self._write()

    @property
    def borrows(self) -> bool:
        """Whether it keeps what lies elsewhere."""
        return any(is_borrowed(register.kept.type) for register in self.machine.registers)

    def _name_values(self) -> None:
        """Locals of a step, by what they are the values of; those of registers are members, too."""
        self._local = Names(RESERVED)
        self.inputs = self.specification.inputs()
        self.given: dict[Expression, str] = {read(i): self._local.unique(input_name(read(i))) for i in self.inputs}
        self.registers = {r.kept: self._local.unique(input_name(r.kept)) for r in self.machine.registers}
        named = {*self.given, *self.registers}
        self.values = {
            guard: self._local.unique("value") for guard in map(_as_number, self.machine.guards) if guard not in named
        }
        self.names: dict[Expression, str] = self.given | self.registers | self.values

    def _write(self) -> None:
        speller = rust_speller(self.names)

        def ask(atom: int, holds: bool) -> Code:
            return speller.asked(self.machine.atoms[atom], holds)

        parameters = {"time": "i64"} | {name: type_text(key.type, "") for key, name in self.names.items()}
        steps = Steps(self.machine, ask, list(parameters), WORDING)
        self.clock_steps = ClockSteps(self.machine, WORDING, self.registers)
        self.methods = [*self._step(steps, parameters), *self._expire(), *self._schedule(), *self._hear()]

    def _step(self, steps: Steps, parameters: dict[str, str]) -> Iterator[str]:
        _, statements = steps.statements()
        typed = [f"{name}: {type_}" for name, type_ in parameters.items()]
        lifetime = "<'a>" if self.borrows else ""
        yield from _method(
            f"fn step(&mut self, time: i64, signals: &Signals{lifetime})",
            "Takes a step, unless a value is NaN.",
            [*self._read(), *self._valid(), *self._kept(), *_stated(statements)],
        )
        for decision, block in steps.shared():
            yield from _method(f"fn {steps.method(decision)}(&mut self, {', '.join(typed)})", "", block)

    def _read(self) -> Iterator[Statement]:
        """The values of inputs, of registers, and of what can be NaN though these are not."""
        yield from (f"let {self.given[read(i)]} = {self._value(i)}" for i in self.inputs)
        yield from (If(each, (_INVALID, "return")) for each in self._missed())
        for register in self.machine.registers:
            name, value = self.registers[register.kept], self.given[register.latest]
            if len(register.closed) < len(self.machine.states):
                closed = " || ".join(f"self.state == {state}" for state in sorted(register.closed))
                value = f"if {closed} {{ {value} }} else {{ self.{name} }}"
            yield f"let {name} = {value}"
        speller = rust_speller(self.given | self.registers)
        yield from (Do(f"let {name} = ", speller.code(value)) for value, name in self.values.items())

    def _value(self, wanted: Input) -> str:
        """The value of an input; until there is one of what is not waited for, what stands in."""
        value = self.signals.text(wanted, "signals")
        instead: dict[Expression, Instead] = {each.input: each.instead for each in self.machine.excused}
        if read(wanted) not in instead:
            return value
        other = instead_text(instead[read(wanted)], type_of(wanted.signal))
        return f"if {self._has(wanted)} {{ {value} }} else {{ {other} }}"

    def _has(self, wanted: Input) -> str:
        (has,) = self.signals.ready([wanted], "signals")
        assert isinstance(has, Text)
        return has.text

    def _missed(self) -> Iterator[Code]:
        """Where one of these holds, messages have come without the value that they should bring."""
        by_read = {read(i): i for i in self.inputs}
        for wanted, news, _ in self.machine.excused:
            yield conjunction([Text(f"!{self._has(by_read[wanted])}"), *(Text(self.given[each]) for each in news)])

    def _valid(self) -> Iterator[Statement]:
        """A step with NaN is none, and not counted as one."""
        guards = dict.fromkeys(map(_as_number, self.machine.guards))
        numbers = [self.names[guard] for guard in guards if guard.type in (SINGLE, DOUBLE)]
        if numbers:
            yield If(disjunction([Text(f"{name}.is_nan()") for name in numbers]), (_INVALID, "return"))
        yield "self.judgement.steps = self.judgement.steps.wrapping_add(1)"

    def _kept(self) -> Iterator[Statement]:
        """Registers stay, what occurs is noted, and the first step sets the verdict.

        Clock steps judge what held at the last step, or would have, with values taken anew.
        """
        speller = rust_speller(self.names)
        yield from (f"self.{name} = {name}" for name in self.registers.values())
        yield from (If(WORDING.is_new(), (each,)) for each in presumed(self.counts, WORDING))
        yield from noted(self.counts, WORDING, speller.asked)
        yield WORDING.begun(self.machine.states[0].verdict)
        yield from self.clock_steps.kept(speller)

    def _expire(self) -> Iterator[str]:
        if not self.machine.is_timed:
            return
        steps = self.clock_steps.steps
        _, statements = steps.statements()
        about = "Takes the clock step that comes next: what changes by itself after `due`."
        yield from _method("fn expire(&mut self)", about, ["let time = self.due + 1", *_stated(statements)])
        for decision, block in steps.shared():
            yield from _method(f"fn {steps.method(decision)}(&mut self, time: i64)", "", block)

    def _schedule(self) -> Iterator[str]:
        if all(clock.is_set for clock in self.machine.clocks):
            return
        statements = scheduled(self.machine, WORDING)
        about = "The next clock step is that of the first clock to be due that is set, or asked and not late."
        yield from _method("fn _schedule(&mut self, time: i64)", about, statements)

    def _hear(self) -> Iterator[str]:
        """What makes ages count from messages: where one was late, a clock step is due, or a step."""
        if not self.ages:
            return
        statements = heard(self.machine, self._aged(), WORDING)
        heads = ", ".join(f"{name}: bool" for name in self._aged().values())
        about = "Messages have come at `time`, from which ages count; where one was late, a clock step is due."
        yield from _method(f"fn hear(&mut self, time: i64, {heads})", about, statements)

    def _aged(self) -> dict[str, str]:
        """The signals whose ages are asked for, with the parameters of `hear` that tell of them."""
        signals = dict.fromkeys(age.signal for _, age in self.ages)
        return {signal: f"has_{number}" for number, signal in enumerate(signals)}

    def heard(self) -> list[str]:
        """The call of `hear`."""
        topics = {i.signal.name: topics_of(i.signal) for i in self.inputs if isinstance(i, New)}
        came = tuple(self.signals.news(topics[signal]) for signal in self._aged())
        call = Do("", Call(f"self.{self.name}.hear", (Text("time"), *came)))
        return lines([call]) if came else []

    def judged(self) -> list[str]:
        """Statements that take a step where one is due: something that is read is new, and all of it has a value."""
        news = [Text(f"self.signals.{name}") for name in self._news()]
        fresh = self.signals.fresh(self.inputs)
        triggers = [*([] if fresh == Text("false") else [fresh]), *news]
        if not triggers:
            return []
        waited = [i for i in self.inputs if read(i) in self.machine.waits_for]
        due = conjunction([disjunction(triggers), *self.signals.ready(waited, "self.signals")])
        return lines([If(due, (f"self.{self.name}.step(time, &self.signals)",))])

    def _news(self) -> Set[str]:
        topics = dict.fromkeys(t for i in self.inputs if isinstance(i, New) for t in topics_of(i.signal))
        return dict.fromkeys(self.signals.heard[topic] for topic in topics).keys()

    def members(self) -> Iterator[tuple[str, str, str]]:
        """Its members: name, type, and what they are at first."""
        yield "judgement", "Judgement", "Judgement::NEW"
        yield "state", "u32", "0"
        due = ["due"] if self.machine.is_timed else []
        late = {each.clock: "-NEVER" for each in self.counts}
        yield from ((name, "i64", late.get(name, "NEVER")) for name in dict.fromkeys([*self.clocks, *due]))
        for each in self.counts:
            yield each.times, f"Times<{each.of.times}>", f"Times::<{each.of.times}>::new(0)"
            yield from ((held, "bool", "false") for held in each.members())
        yield from ((name, "bool", "false") for name in self.clock_steps.conditions())
        for kept, name in (*self.registers.items(), *self.clock_steps.taken.items()):
            yield name, type_text(kept.type), default(kept.type)

    @property
    def label(self) -> str:
        """What the property is called, fit for a comment."""
        return prose(self.specification.label)

    def about(self) -> list[str]:
        """What it judges, as a comment."""
        return comment("///", f"Line {self.specification.line}: {self.specification.text}")

    def begun(self) -> list[str]:
        """Statements at the beginning of a session, from which ages count."""
        return lines([f"self.{self.name}.{clock} = time + {age.duration}" for clock, age in self.ages])


def _as_number(guard: Expression) -> Expression:
    """A guard as what may be NaN: integers that are calculated are looked at as doubles, samples as they are."""
    is_calculated = isinstance(guard, Apply) and guard.type not in (SINGLE, DOUBLE, BOOL)
    return Apply(Primitive.TO_DOUBLE, (guard,)) if is_calculated else guard


def _stated(statements: Sequence[Statement]) -> Sequence[Statement]:
    return ["let state = self.state", *statements] if statements else []


def _method(head: str, about: str, body: Iterable[Statement]) -> list[str]:
    described = comment("///", about, indent=INDENT) if about else []
    return ["", *described, f"{INDENT}{head} {{", *lines(body), f"{INDENT}}}"]
