"""Samples of signals in C: what a step is given, what is kept of it, what is computed from it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from ltlc.backends.c.code import comment, layout
from ltlc.backends.c.code import flat as text_of
from ltlc.backends.c.expressions import C
from ltlc.backends.c.names import member_names
from ltlc.backends.python.code import INDENT, Chain, Code, Text
from ltlc.backends.python.names import input_name, variable
from ltlc.backends.python.statements import conjunction, disjunction
from ltlc.compiler import Compiled
from ltlc.program.lowering import double, lowered, read, undefined_parts
from ltlc.program.types import BOOL, DOUBLE, Type, type_of
from ltlc.specification import expressions as e
from ltlc.specification.expressions import Each, Expression, Field, Input, Match, New, Parallel, Past, Signal, Slope
from ltlc.specification.specification import fields, topics_of


@dataclass
class Group:
    """Fields that are always in a message together: a sample has all of them or none, as the flag `has_name` says."""

    topic: str
    name: str = ""
    readings: list[Signal] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Heard:
    """The messages on `topic` are news: of those groups, or what the flag `name` of the samples says besides."""

    topic: str
    name: str
    groups: tuple[Group, ...]
    has_flag: bool


@dataclass(frozen=True, slots=True)
class Named:
    """What a value is called where it is used, and its type."""

    text: str
    type: Type


@dataclass(frozen=True, slots=True)
class Kept:
    """What is kept of a signal, or of an expression that can be NaN: so many of its last values."""

    name: str
    type: Type
    depth: int
    has_times: bool
    definition: Expression | None

    @property
    def latest(self) -> str:
        """Where its last value is."""
        return f"signals->{self.name}" if self.depth == 1 else self.ago(0)

    def ago(self, samples: int) -> str:
        """Where its value from so many samples ago is."""
        return f"signals->{self.name}[{self._place(samples)}]"

    def time(self, samples: int) -> str:
        """Where the time of its sample from so many samples ago is."""
        return f"signals->{self.name}_times[{self._place(samples)}]"

    def _place(self, samples: int) -> str:
        latest = f"signals->{self.name}_latest"
        return f"past({latest}, {samples}u, {self.depth}u)" if samples else latest


class Signals:
    """The signals that properties read, in the order of first use, each after its parts."""

    def __init__(self, compiled: Sequence[Compiled], helpers: C) -> None:
        self.helpers = helpers
        self._properties = [c.specification for c in compiled]
        wanted = [i for p in self._properties for i in p.inputs()]
        self.order: dict[Signal, None] = {}
        for each in wanted:
            if not isinstance(each, New):
                self._enter(each.signal)
        self.groups = list(self._grouped())
        self.group_of = {signal: group for group in self.groups for signal in group.readings}
        news = dict.fromkeys(i for i in wanted if isinstance(i, New))
        self.heard = {heard.topic: heard for heard in self._heard(news)}
        self._name_groups()
        self.fields = self._fields()
        needed = [
            *wanted,
            *(i for s in self.order if not isinstance(s.definition, Field) for i in e.inputs(s.definition)),
        ]
        local = member_names(
            "has", *(f"has_{group.name}" for group in self.groups), *(h.name for h in self.heard.values())
        )
        self.kept = {signal: self._kept(signal, needed, local) for signal in self.order if not self.is_constant(signal)}
        parts = (part for p in self._properties for atom in p.atoms for part in undefined_parts(atom.condition))
        self.values: dict[Expression, Kept] = {}
        for part in dict.fromkeys(p for p in parts if not any(e.openings(p)) and any(True for _ in e.inputs(p))):
            self.values[part] = Kept(local.unique("value"), DOUBLE, 1, False, part)

    def _enter(self, signal: Signal) -> None:
        if signal in self.order:
            return
        if not isinstance(signal.definition, Field):
            for part in e.inputs(signal.definition):
                self._enter(part.signal)
        self.order[signal] = None

    def is_constant(self, signal: Signal) -> bool:
        """Whether the signal is computed from nothing."""
        return not isinstance(signal.definition, Field) and not any(True for _ in e.inputs(signal.definition))

    def _grouped(self) -> Iterator[Group]:
        found: dict[object, Group] = {}
        for signal in self.order:
            if isinstance(signal.definition, Field):
                group = found.setdefault(_entry(signal.definition), Group(signal.definition.topic))
                group.readings.append(signal)
        yield from found.values()

    def _heard(self, news: Iterable[New]) -> Iterator[Heard]:
        local = member_names()
        for topic in dict.fromkeys(topic for each in news for topic in topics_of(each.signal)):
            name = next(input_name(read(each)) for each in news if topic in topics_of(each.signal))
            groups = tuple(group for group in self.groups if group.topic == topic)
            always = any(
                isinstance(s.definition, Field) and _entry(s.definition) == topic for g in groups for s in g.readings
            )
            yield Heard(topic, local.unique(name), groups, not always)

    def _name_groups(self) -> None:
        local = member_names()
        for group in self.groups:
            [first, *more] = group.readings
            assert isinstance(first.definition, Field)
            entries = [s.value for s in first.definition.path if isinstance(s, Match | Parallel)]
            name = " ".join([group.topic, *entries]) if more else first.name
            group.name = local.unique(variable(name))

    def _fields(self) -> dict[Signal, str]:
        """What a step is given of each reading."""
        flags = [f"has_{group.name}" for group in self.groups]
        local = member_names(*flags, *(heard.name for heard in self.heard.values()))
        return {signal: local.unique(variable(signal.name)) for group in self.groups for signal in group.readings}

    def _kept(self, signal: Signal, needed: Sequence[Input], local: object) -> Kept:
        name = local.unique(variable(signal.name))  # type: ignore[attr-defined]
        of_signal = [i for i in needed if i.signal == signal]
        depth = max((_reach(i) for i in of_signal), default=1)
        definition = None if isinstance(signal.definition, Field) else signal.definition
        type_ = type_of(signal) if definition is None or signal.type.value != "number" else DOUBLE
        return Kept(name, type_, max(1, depth), any(isinstance(i, Slope) for i in of_signal), definition)

    def sources(self, wanted: Iterable[Input]) -> list[Group]:
        """The groups that inputs are computed from."""
        read = (signal for i in wanted if not isinstance(i, New) for signal, _ in fields(i.signal))
        return list({id(group): group for group in (self.group_of[signal] for signal in read)}.values())

    def fresh(self, wanted: Iterable[Input]) -> list[Code]:
        """One of these holds if a sample of an input comes in."""
        return [Text(f"samples->has_{group.name}") for group in self.sources(wanted)]

    def ready(self, wanted: Iterable[Input]) -> list[Code]:
        """All of these hold if every input has a value."""
        wanted = [i for i in wanted if not isinstance(i, New) and not self.is_constant(i.signal)]
        parts = [Text(f"signals->has_{group.name}") for group in self.sources(wanted)]
        return [*parts, *dict.fromkeys(code for i in wanted for code in self._long_enough(i))]

    def _long_enough(self, wanted: Input) -> Iterator[Code]:
        kept = self.kept[wanted.signal]
        if _reach(wanted) > 1:
            yield Chain((Text(f"signals->{kept.name}_count"), Text(f"{_reach(wanted)}u")), (">=",))
        elif kept.definition is not None:
            for part in e.inputs(kept.definition):
                if not self.is_constant(part.signal):
                    yield from self._long_enough(part)

    def named(self, wanted: Input) -> Named:
        """Where the value of an input is, where a step is judged."""
        if isinstance(wanted, New):
            flags = [f"signals->{self.heard[topic].name}" for topic in topics_of(wanted.signal)]
            return Named(" || ".join(flags), BOOL)
        if self.is_constant(wanted.signal):
            assert not isinstance(wanted.signal.definition, Field)
            return Named(text_of(self.helpers.speller({}).code(double(wanted.signal.definition))), DOUBLE)
        kept = self.kept[wanted.signal]
        match wanted:
            case Past(_, samples):
                self.helpers.called.add("past")
                return Named(kept.ago(samples), kept.type)
            case Slope():
                self.helpers.called |= {"past", "slope", "math.h"}
                cast = "" if kept.type == DOUBLE else "(double)"
                change = f"{cast}{kept.ago(0)} - {cast}{kept.ago(1)}"
                return Named(f"slope({change}, {kept.time(0)} - {kept.time(1)})", DOUBLE)
            case _:
                return Named(kept.latest, kept.type)

    def numbers(self) -> list[str]:
        """Where all values are of which one that is NaN makes a step of some property invalid."""
        wanted = dict.fromkeys(i for p in self._properties for i in p.inputs())
        found = [name for i in wanted for name in [self.nan_of(i)] if name]
        return list(dict.fromkeys([*found, *(kept.latest for kept in self.values.values())]))

    def nan_of(self, wanted: Input) -> str | None:
        """Where the value of an input is if it can be NaN."""
        if isinstance(wanted, New) or self.is_constant(wanted.signal):
            return None
        named = self.named(wanted)
        is_float = named.type.is_number and not named.type.scalar.is_integer
        return named.text if is_float else None

    def given(self) -> list[str]:
        """The fields of the samples that a step is given."""
        lines = []
        for group in self.groups:
            for signal in group.readings:
                assert isinstance(signal.definition, Field)
                declared = self.helpers.declared(type_of(signal), self.fields[signal])
                lines += [*comment(_origin(signal), indent=INDENT), f"{INDENT}{declared};"]
        lines += [f"{INDENT}bool has_{group.name} : 1;" for group in self.groups]
        for heard in self.heard.values():
            if heard.has_flag:
                lines += comment(f"a message on {heard.topic} has come", indent=INDENT)
                lines.append(f"{INDENT}bool {heard.name} : 1;")
        return lines

    def stored(self) -> list[str]:
        """The fields of what is kept of samples."""
        lines = []
        for kept in [*self.kept.values(), *self.values.values()]:
            if kept.depth == 1:
                lines.append(f"{self.helpers.declared(kept.type, kept.name)};")
                continue
            lines.append(f"{self.helpers.declared(kept.type, f'{kept.name}[{kept.depth}]')};")
            if kept.has_times:
                lines.append(f"int64_t {kept.name}_times[{kept.depth}];")
            lines += [f"uint32_t {kept.name}_latest;", f"uint32_t {kept.name}_count;"]
        lines += [f"bool has_{group.name} : 1;" for group in self.groups]
        lines += [f"bool {heard.name} : 1;" for heard in self.heard.values()]
        return [f"{INDENT * 2}{line}" for line in lines]

    def taken(self) -> list[str]:
        """Statements that keep what has come in `samples`, and compute what depends on it."""
        seen = [f"{INDENT}signals->has_{g.name} = signals->has_{g.name} || samples->has_{g.name};" for g in self.groups]
        lines = ["if (!monitors->has_started) {", *seen, "}"] if seen else []
        every = conjunction([Text(f"samples->has_{group.name}") for group in self.groups] or [Text("true")])
        lines += layout("const bool all = ", every, ";")
        lines += self._taken_together()
        for kept in [*self.kept.values(), *self.values.values()]:
            if kept.definition is not None:
                lines += self._computed(kept, kept.definition)
        return [INDENT + line for line in lines]

    def _taken_together(self) -> list[str]:
        """Where samples of all come at once, as where a program reads all sensors and steps, flags are asked once."""
        plain = [group for group in self.groups if all(self.kept[s].depth == 1 for s in group.readings)]
        each = [line for group in plain for line in self._taken(group)]
        if len(plain) > 1:
            at_once = [line for group in plain for line in self._taken(group) if line.startswith(INDENT)]
            each = ["if (all) {", *at_once, "} else {", *(INDENT + line for line in each), "}"]
        return [*each, *(line for group in self.groups if group not in plain for line in self._taken(group))]

    def _taken(self, group: Group) -> list[str]:
        given = ((self.kept[s], Text(f"samples->{self.fields[s]}")) for s in group.readings)
        body = [line for kept, value in given for line in self._pushed(kept, value)]
        return [f"if (samples->has_{group.name}) {{", *body, "}"]

    def taken_of(self, wanted: Iterable[Input], values: Iterable[Expression]) -> list[str]:
        """Those of these statements that matter to inputs and to values that can be NaN."""
        parts: dict[Signal, None] = {}

        def need(signal: Signal) -> None:
            if signal not in parts and not isinstance(signal.definition, Field):
                for part in e.inputs(signal.definition):
                    need(part.signal)
            parts[signal] = None

        for each in wanted:
            if not isinstance(each, New):
                need(each.signal)
        kept = [self.kept[signal] for signal in parts if signal in self.kept]
        kept += [self.values[value] for value in values if value in self.values]
        lines = [line for group in self.sources(wanted) for line in self._taken(group)]
        return [*lines, *(line for k in kept if k.definition is not None for line in self._computed(k, k.definition))]

    def _computed(self, kept: Kept, definition: Expression) -> list[str]:
        parts = list(dict.fromkeys(e.inputs(definition)))
        speller = self.helpers.speller({read(part): self.named(part).text for part in parts})
        fresh = self.fresh(parts)
        value = double(definition) if kept.type == DOUBLE else lowered(definition)
        when = conjunction([disjunction(fresh), *self.ready(parts)]) if fresh else Text("false")
        return [
            *layout("if (", when, ") {"),
            *self._pushed(kept, speller.code(value)),
            "}",
        ]

    def _pushed(self, kept: Kept, value: Code) -> list[str]:
        """Statements that keep a new value."""
        name, depth = f"signals->{kept.name}", kept.depth
        if depth == 1:
            return layout(f"{INDENT}{name} = ", value, ";")
        lines = [
            f"{INDENT}{name}_latest = {name}_latest + 1u < {depth}u ? {name}_latest + 1u : 0u;",
            *layout(f"{INDENT}{name}[{name}_latest] = ", value, ";"),
        ]
        if kept.has_times:
            lines.append(f"{INDENT}{name}_times[{name}_latest] = time;")
        return [*lines, f"{INDENT}if ({name}_count < {depth}u) {{", f"{INDENT * 2}{name}_count++;", f"{INDENT}}}"]

    def news(self, heard: Heard) -> Code:
        """Whether the samples tell of a message on the topic."""
        flags = [f"samples->has_{group.name}" for group in heard.groups]
        return disjunction([Text(flag) for flag in ([f"samples->{heard.name}"] if heard.has_flag else []) + flags])


def _entry(field_: Field) -> object:
    """What a field is always together with: the messages of its topic, or an entry of them."""
    depth = next((n for n, step in enumerate(field_.path) if not isinstance(step, str | Each)), None)
    if depth is None:
        return field_.topic
    step = field_.path[depth]
    return (field_.topic, step) if isinstance(step, Parallel) else (field_.topic, field_.path[: depth + 1])


def _origin(signal: Signal) -> str:
    """Where a reading comes from, as a declaration would say it."""
    assert isinstance(signal.definition, Field)
    steps = []
    for step in signal.definition.path:
        match step:
            case str():
                steps.append(f".{step}")
            case int():
                steps.append(f"[{step}]")
            case Each():
                steps.append("[]")
            case Match(_, value) | Parallel(_, value):
                steps.append(f"[{value}]")
    return f"{signal.name}: {signal.definition.topic} {signal.definition.message}{''.join(steps)}"


def _reach(wanted: Input) -> int:
    """How many samples of its signal an input looks at."""
    match wanted:
        case Past(_, samples):
            return samples + 1
        case Slope():
            return 2
        case New():
            return 0
        case _:
            return 1
