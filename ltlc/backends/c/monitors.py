"""A property in C: a struct with its state, a function that takes a step, and one that takes a clock step."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from ltlc.backends.c.code import comment, lines, mentions, unused
from ltlc.backends.c.expressions import C
from ltlc.backends.c.names import local_names
from ltlc.backends.c.signals import Named, Signals
from ltlc.backends.clock_steps import ClockSteps
from ltlc.backends.counts import ages, countings, heard, noted, presumed
from ltlc.backends.inputs import is_from_session
from ltlc.backends.names import input_name
from ltlc.backends.operators import filled, flat
from ltlc.backends.spelling import Speller
from ltlc.backends.statements import Do, If, Statement, conjunction, disjunction
from ltlc.backends.steps import Steps, clock_names, scheduled
from ltlc.backends.trees import INDENT, Call, Chain, Code, Prefix, Text
from ltlc.backends.wording import Wording
from ltlc.compiler import Compiled
from ltlc.program.lowering import double, lowered, read, undefined_parts
from ltlc.program.normal import normal
from ltlc.program.types import DOUBLE, Scalar, type_of
from ltlc.semantics.monitor import Target
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.expressions import Current, Expression, New
from ltlc.specification.specification import Instances, topics_of


def _wording(prefix: str, name: str) -> Wording:
    """What a step of the property `name` does, to the struct `self`; verdicts have names that begin with `prefix`."""
    return Wording(
        own="self->",
        verdicts={verdict: f"{prefix}_{verdict.name}" for verdict in Verdict},
        is_dated=True,
        never=f"{prefix}_NEVER",
        duration="INT64_C({})",
        sooner=_sooner,
        noted=_noted,
        first=lambda times, most: f"self->{times}[self->{times}_count % {most}u]",
        method=name,
        handed=("self",),
    )


def _sooner(times: Sequence[str]) -> Code:
    *others, last = times
    return Call("sooner", (_sooner(others), Text(last))) if others else Text(last)


def _noted(times: str, most: int) -> tuple[tuple[Statement, ...], Code]:
    given = (f"self->{times}", f"&self->{times}_count", f"{most}u", "time")
    return (), Call("occurred", tuple(map(Text, given)))


class PropertyWriter:
    """The parts of one property, called `name`; all public names begin with `prefix`."""

    def __init__(self, compiled: Compiled, name: str, prefix: str, signals: Signals) -> None:
        self.compiled = compiled
        self.specification = compiled.specification
        self.name = name
        self.prefix = prefix
        self.type = f"{prefix}_{name}"
        self.signals = signals
        self.helpers: C = signals.helpers
        self.wording = _wording(prefix.upper(), name)
        self.machine = compiled.machine
        self.timed = self.machine.is_timed
        self.clocks = clock_names(self.machine)
        self.ages = ages(self.machine)
        self.counts = countings(self.machine)
        arrivals = {i.signal.name: i for i in self.specification.inputs() if isinstance(i, New)}
        self.aged = list(dict.fromkeys(arrivals[age.signal] for _, age in self.ages))
        self.inputs = self.specification.inputs()
        self.from_session = is_from_session(compiled)
        self.groups = signals.given.sources(self.inputs)
        self.topics = list(dict.fromkeys(t for i in self.inputs if isinstance(i, New) for t in topics_of(i.signal)))
        self.decided: list[str] = []
        self._name_values()
        self._write()
        self._write_due()

    def _name_values(self) -> None:
        """Parameters for inputs and for what is calculated of them; locals and members for the rest."""
        local = local_names()
        self.given: dict[Expression, Named] = {}
        self.parameters: dict[Expression, Named] = {}
        for i in self.inputs:
            self.given[i] = self.signals.named(i)
            self.parameters[i] = Named(local.unique(input_name(read(i))), self.given[i].type)
        parts = dict.fromkeys(p for atom in self.specification.atoms for p in undefined_parts(atom.condition))
        self.late: dict[Expression, Named] = {}
        for part in parts:
            named = Named(local.unique("value"), DOUBLE)
            if part in self.signals.values:
                self.given[part] = Named(self.signals.values[part].latest, DOUBLE)
                self.parameters[part] = named
            else:
                self.late[part] = named
        clocks = self.specification.openings()
        self.openings = {o: Named(local.unique(input_name(read(o))), type_of(o.signal)) for o in clocks}

    def _write(self) -> None:
        """Everything that has to be known before the struct can be written."""
        speller = self._speller(self.parameters | self.late | self.openings)

        def ask(atom: int, holds: bool) -> Code:
            return speller.asked(self.machine.atoms[atom], holds)

        handed_on = self._handed_on()
        steps = Steps(self.machine, ask, [name for name, _ in handed_on], self.wording)
        named = zip(self.machine.registers, self.openings.values(), strict=True)
        registers = {register.kept: opening.text for register, opening in named}
        self.clock_steps = ClockSteps(self.machine, self.wording, registers)
        self.clock_step = self._clock_step() if self.timed else []
        self.step = self._step(steps, speller, handed_on)
        called = mentions(f"{self.name}_schedule", [*self.step, *self.clock_step])
        self.schedule = self._schedule() if called else []

    def _speller(self, names: Mapping[Expression, Named]) -> Speller:
        return self.helpers.speller({normal(lowered(part)): named.text for part, named in names.items()})

    def _handed_on(self) -> list[tuple[str, str]]:
        """What functions of shared decisions take, each with its declaration."""
        named = (*self.parameters.values(), *self.late.values(), *self.openings.values())
        return [("time", "int64_t time"), *((n.text, self.helpers.declared(n.type, n.text)) for n in named)]

    def _step(self, steps: Steps, speller: Speller, handed_on: Sequence[tuple[str, str]]) -> list[str]:
        """The function that takes a step, after those that it calls."""
        is_alone, statements = steps.statements()
        shared = self._shared(steps, handed_on)
        before = [
            *self._opened(),
            *self._calculated(),
            *noted(self.counts, self.wording, speller.asked),
            *self.clock_steps.kept(speller),
        ]
        body = lines([*before, *(() if is_alone or not statements else (_STATE,)), *statements], INDENT)
        given = [("time", "time"), *((p.text, self.given[key].text) for key, p in self.parameters.items())]
        self.arguments = [(name, value) for name, value in given if mentions(name, body)]
        wanted = {name for name, _ in self.arguments}
        if not body:
            return []
        heads = [declared for name, declared in handed_on if name in wanted]
        return [*shared, *self._function(self._described(), "step", heads, body)]

    def _function(self, about: Sequence[str], what: str, heads: Sequence[str], body: Sequence[str]) -> list[str]:
        return [*about, *self._head(f"{self.name}_{what}", heads, ""), "{", *body, "}", ""]

    def _shared(self, steps: Steps, handed_on: Sequence[tuple[str, str]]) -> list[str]:
        """The functions that shared decisions become, all of which are declared first."""
        prototypes: list[str] = []
        functions: list[str] = []
        for decision, block in steps.shared():
            name, body = f"{self.name}{steps.method(decision)}", lines(block, INDENT)
            declared = [each for _, each in handed_on]
            self.decided.append(name)
            prototypes += self._head(name, declared, ";")
            aside = unused(("self", *(parameter for parameter, _ in handed_on)), body)
            functions += [*self._head(name, declared, ""), "{", *aside, *body, "}", ""]
        return [*prototypes, *functions]

    def _described(self) -> list[str]:
        return comment(f"Line {self.specification.line}:", self.specification.text)

    def _head(self, name: str, declarations: Sequence[str], end: str) -> list[str]:
        pieces = [f"{self.type} *self", *declarations]
        pieces = [f"{p}," for p in pieces[:-1]] + pieces[-1:]
        return filled(f"static void {name}(", pieces, f"){end}", INDENT * 2)

    def _opened(self) -> Iterator[Statement]:
        """At a step at which a scope is not open, the values at its opening are the latest."""
        for register, (opening, named) in zip(self.machine.registers, self.openings.items(), strict=True):
            latest = self.parameters[Current(opening.signal)].text
            always = len(register.closed) == len(self.machine.states)
            states = [] if always else sorted(register.closed)
            declared = "" if named.type.scalar is Scalar.TEXT and not named.type.is_array else "const "
            declared += self.helpers.declared(named.type, named.text)
            closed = " || ".join(f"self->state == {state}" for state in states)
            yield f"{declared} = {f'{closed} ? {latest} : self->{named.text}' if states else latest}"

    def _calculated(self) -> Iterator[Statement]:
        """What can be NaN though no input is, and depends on an opening; if the step is one, openings are kept."""
        speller = self._speller(self.parameters | self.openings)
        for part, named in self.late.items():
            yield Do(f"const double {named.text} = ", speller.code(double(part)))
        if self.late:
            yield If(nan([named.text for named in self.late.values()]), ("self->invalid++", "return"))
            yield self._start(self.wording)
        yield from (f"self->{named.text} = {named.text}" for named in self.openings.values())

    def _start(self, wording: Wording) -> If:
        """The first step sets the verdict, and presumes that something has occurred."""
        return wording.begun(self.machine.states[0].verdict, *presumed(self.counts, wording))

    def _clock_step(self) -> list[str]:
        """The function that takes a clock step, after those that it calls."""
        steps = self.clock_steps.steps
        is_alone, statements = steps.statements()
        shared = self._shared(steps, [("time", "int64_t time")])
        body = lines(statements, INDENT)
        if not body:
            return []
        time = ["const int64_t time = self->due + 1"] if mentions("time", body) else []
        read = lines([*time, *([] if is_alone else [_STATE])], INDENT)
        about = comment(f"The next clock step of {self.specification.label}: what changes by itself after `due`.")
        return [*shared, *self._function(about, "expire", [], [*read, *body])]

    @property
    def state_type(self) -> str:
        """The type of the state of its monitor."""
        return f"uint{next(bits for bits in (8, 16, 32) if len(self.machine.states) < 2**bits)}_t"

    @property
    def dues(self) -> list[str]:
        """The members that say when clocks are due, and the next clock step."""
        return list(dict.fromkeys([*self.clocks, "due"])) if self.timed else []

    def members(self) -> list[str]:
        """The struct."""
        fields = [
            "int64_t since; /* when the verdict came, in ns */",
            *(f"int64_t {name};" for name in self.dues),
            *(f"int64_t {each.times}[{each.of.times}];" for each in self.counts),
            *(f"uint32_t {each.times}_count;" for each in self.counts),
            "uint32_t invalid; /* steps skipped because a value was NaN */",
            "uint32_t apart;",
            *(f"{self.helpers.declared(named.type, named.text)};" for named in self.openings.values()),
            *(f"{self.helpers.declared(kept.type, name)};" for kept, name in self.clock_steps.taken.items()),
            f"{self.state_type} state;",
            "uint8_t verdict; /* one of the verdicts */",
            *(f"bool {name} : 1;" for name in self.clock_steps.conditions()),
            *(f"bool {held} : 1;" for each in self.counts for held in each.members()),
        ]
        return [*self._described(), "typedef struct {", *(INDENT + line for line in fields), f"}} {self.type};", ""]

    def first_dues(self) -> list[str]:
        """Statements after which no clock is due, and counts are late."""
        late = {each.clock for each in self.counts}
        never = f"{self.prefix.upper()}_NEVER"
        return [f"{INDENT}monitors->{self.name}.{due} = {'-' * (due in late)}{never};" for due in self.dues]

    def triggers(self) -> list[Code]:
        """One of these holds where a step of the property may be due; with a rate, any tick is one of its news.

        A message that opens an instance is a step of all of them.
        """
        if self.signals.is_rated and (self.topics or self.from_session):
            return [Text("true")]
        given, slicing = self.signals.given, self.specification.slicing
        opening = given.news(topics_of(slicing.signal)) if isinstance(slicing, Instances) else ()
        news = (Text(f"signals->{self.signals.heard[topic].name}") for topic in self.topics)
        return list(dict.fromkeys([*given.fresh(self.inputs), *news, *opening]))

    def _write_due(self) -> None:
        """The function for whether a step is due; without anything to read, none ever is."""
        self.is_due: list[str] = []
        triggers = self.triggers()
        if not triggers:
            self.step = self.step if self.from_session else []
            return
        found: list[Statement] = []
        ready = self.signals.ready([i for i in self.inputs if read(i) in self.machine.waits_for])
        if triggers != [Text("true")]:
            found.append(If(Prefix("not ", disjunction(triggers)), ("return false",)))
        if ready:
            found.append(If(_not_all(ready), ("return false",)))
        found.append("self->apart++")
        found += [If(each, ("self->invalid++", "return false")) for each in self.unfit()]
        if not self.late:
            found.append(self._start(self.wording))
        text = lines(found, INDENT)
        self_ = [f"{INDENT}{self.type} *const self = &monitors->{self.name};"]
        if mentions("signals", text):
            self_.append(f"{INDENT}const {self.signals.type} *const signals = &monitors->{self.signals.name};")
        label = self.specification.label
        about = comment(
            f"Whether {label} is to be judged: something that it reads is new, all that it waits for has a value."
        )
        head = [f"{self.prefix}_monitors *monitors,", "int64_t time,", f"const {self.prefix}_samples *samples"]
        self.is_due = [
            *about,
            *filled(f"static bool {self.name}_is_due(", head, ")", INDENT * 2),
            "{",
            *self_,
            *unused(("time", "samples"), text),
            *text,
            f"{INDENT}return true;",
            "}",
            "",
        ]

    def _schedule(self) -> list[str]:
        """The function for when the next clock step is due."""
        statements = scheduled(self.machine, self.wording)
        about = comment(f"The next clock step of {self.specification.label} is that of the first clock to be due.")
        return self._function(about, "schedule", ["int64_t time"], lines(statements, INDENT))

    def hearing(self) -> list[str]:
        """The function that makes ages count from messages: where one was late, a clock step is due, or a step."""
        if not self.ages:
            return []
        statements = heard(self.machine, {n.signal.name: self.parameters[n].text for n in self.aged}, self.wording)
        about = comment(f"Messages at `time`, from which ages of {self.specification.label} count: a late one is due.")
        heads = ["int64_t time", *(f"bool {self.parameters[new].text}" for new in self.aged)]
        return self._function(about, "hear", heads, lines(statements, INDENT))

    def heard(self) -> list[str]:
        """The call of it."""
        came = [flat(disjunction(self.signals.given.news(topics_of(n.signal)))) for n in self.aged]
        call = Call(f"{self.name}_hear", (Text(f"&monitors->{self.name}"), Text("time"), *map(Text, came)))
        return lines([Do("", call)], INDENT) if self.ages else []

    def unfit(self) -> Iterator[Code]:
        """Where one of these holds, what has come makes no step: a value is missing, or something is NaN."""
        yield from self._missed()
        numbers = [name for i in self.inputs for name in [self.signals.nan_of(i)] if name]
        numbers += [self.signals.values[part].latest for part in self.parameters if part in self.signals.values]
        if numbers:
            yield nan(numbers)

    def _missed(self) -> Iterator[Code]:
        """Where one of these holds, messages have come without the value that they should bring."""
        by_read = {read(i): i for i in self.inputs}
        for wanted, news, _ in self.machine.excused:
            if not news:  # it has a value before the first one
                continue
            came = [Text(self.given[by_read[each]].text) for each in news]
            yield conjunction([_not_all(self.signals.ready([by_read[wanted]])), *came])

    def call(self, news: str | None = None) -> str:
        """The call that takes a step; of all its news, `news` may be known."""
        own = {self.parameters[i].text for i in self.inputs if isinstance(i, New)}
        given = [(news or value) if name in own else value for name, value in self.arguments]
        return f"{self.name}_step({', '.join([f'&monitors->{self.name}', *given])})"

    def first(self) -> list[str]:
        """What waits for no value begins with the session."""
        member = f"monitors->{self.name}"
        start = self._start(replace(self.wording, own=f"{member}."))
        call = self.call("false").replace("signals->", f"monitors->{self.signals.name}.")
        # A first message may have been none.
        guard = [start.guard, *([Text(f"{member}.invalid == 0")] if self.machine.excused else [])]
        step = (call,) if self.step else ()
        return lines([If(conjunction(guard), (*start.then, f"{member}.apart++", *step))], INDENT)

    def session(self) -> list[str]:
        """What is done when the session begins."""
        member = f"monitors->{self.name}"
        return [f"{INDENT}{member}.{name} = time + INT64_C({age.duration});" for name, age in self.ages]

    def decisions(self) -> tuple[int, int]:
        """How many conditions a step asks at most, and a clock step."""
        depth: dict[Target, int] = {}

        def deepest(target: Target) -> int:
            if target >= 0:
                return 0
            if target not in depth:
                decision = self.machine.decisions[~target]
                depth[target] = 1 + max(deepest(decision.low), deepest(decision.high))
            return depth[target]

        for number in reversed(range(len(self.machine.decisions))):
            deepest(~number)
        states = self.machine.states
        both = [state.step for state in states], [state.expire for state in states if state.expire is not None]
        step, clock_step = (max(map(deepest, edges), default=0) for edges in both)
        return step + len(self.clock_steps.conditions()) + len(self.counts), clock_step


_STATE = "const unsigned state = self->state"


def nan(numbers: Sequence[str]) -> Code:
    """Whether one of the numbers is NaN."""
    return disjunction([Chain((Text(name), Text(name)), ("!=",)) for name in numbers])


def none_nan(numbers: Sequence[str]) -> list[Code]:
    """All of these hold if none of the numbers is NaN."""
    return [Chain((Text(name), Text(name)), ("==",)) for name in numbers]


def _not_all(parts: Sequence[Code]) -> Code:
    return Prefix("not ", conjunction(parts))
