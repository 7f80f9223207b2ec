"""Samples of signals in C: what is kept of what a step is given, and what is computed from it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from ltlc.backends.c.code import lines
from ltlc.backends.c.expressions import C
from ltlc.backends.c.functions import of_array
from ltlc.backends.c.names import member_names
from ltlc.backends.c.samples import Group, Samples
from ltlc.backends.names import Names, variable
from ltlc.backends.operators import flat as text_of
from ltlc.backends.statements import Do, If, Statement, conjunction, disjunction
from ltlc.backends.trees import INDENT, Chain, Code, Text
from ltlc.dataclass import dataclass
from ltlc.program.lowering import double, first_value, has_sample, lowered, read, undefined_parts
from ltlc.program.types import BOOL, DOUBLE, TEXT, Type, kept_as, recent_of
from ltlc.specification import expressions as e
from ltlc.specification.expressions import Expression, Field, Input, New, Past, Recent, Signal, Slope, ValueType
from ltlc.specification.samples import depth_of, in_order, reach
from ltlc.specification.specification import PropertySpecification, news_within, topics_of


@dataclass(frozen=True, slots=True)
class Named:
    """What a value is called where it is used, and its type."""

    text: str
    type: Type


@dataclass(frozen=True, slots=True)
class Kept:
    """What is kept of a signal, or of an expression that can be NaN: so many of its last values.

    If these are read as arrays, each stands in two places, so that they always stand in a row.
    """

    name: str
    of: Signal
    type: Type
    depth: int
    has_times: bool = False
    has_arrays: bool = False

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

    @property
    def is_computed(self) -> bool:
        """Whether it is not read from messages."""
        return not isinstance(self.of.definition, Field)

    def recent(self, count: int) -> Named:
        """So many of its last values, as an array."""
        given = f"signals->{self.name}, signals->{self.name}_latest, {self.depth}u, {count}u"
        return Named(f"{of_array('recent', self.type)}({given})", self.type._replace(is_array=True))

    @property
    def places(self) -> int:
        """In how many places its values stand."""
        return 2 * self.depth if self.has_arrays else self.depth

    def _place(self, samples: int) -> str:
        latest = f"signals->{self.name}_latest"
        return f"past({latest}, {samples}u, {self.depth}u)" if samples else latest


_OF_A_PACE = ("has_started", "ticks", "together")
"""The members beside those that keep samples."""


@dataclass(frozen=True, slots=True)
class Ticks:
    """Those that begin with the first message on one of `topics`, or with the session where that is None."""

    topics: frozenset[str] | None


class Signals:
    """The signals that properties read whose steps see the same samples: those of messages or, with a rate, of `ticks`.

    They are kept in one member of the monitors, whose name, as all that is called after it, ends with `suffix`. For
    those that are `excused`, some property does not wait.
    """

    def __init__(
        self,
        properties: Sequence[PropertySpecification],
        given: Samples,
        helpers: C,
        suffix: str = "",
        ticks: Ticks | None = None,
        excused: frozenset[Signal] = frozenset(),
    ) -> None:
        self.given = given
        self.excused = excused
        self.helpers = helpers
        self.suffix = suffix
        self.ticks = ticks
        self.name = f"signals{suffix}"
        self.type = f"{helpers.prefix}_{self.name}"
        self._properties = properties
        wanted = [i for p in properties for i in p.inputs()]
        signals = in_order(wanted)
        self.groups = [group for group in given.groups if not set(signals).isdisjoint(group.readings)]
        news = {topic for i in wanted if isinstance(i, New) for topic in topics_of(i.signal)}
        self.heard = {topic: heard for topic, heard in given.heard.items() if topic in news}
        needed = [*wanted, *(i for signal in signals for i in signal.inputs)]
        flags = (*(f"has_{group.name}" for group in self.groups), *(h.name for h in self.heard.values()))
        local = member_names("has", *_OF_A_PACE, *flags)
        self.kept = {signal: self._kept(signal, needed, local) for signal in signals if not signal.is_constant}
        parts = (part for p in properties for atom in p.atoms for part in undefined_parts(atom.condition))
        self.values: dict[Expression, Kept] = {}
        for part in dict.fromkeys(p for p in parts if not any(e.openings(p)) and any(True for _ in e.inputs(p))):
            self.values[part] = Kept(local.unique("value"), Signal("value", ValueType.NUMBER, part), DOUBLE, 1)

    @property
    def is_rated(self) -> bool:
        """Whether samples are looked at with ticks."""
        return self.ticks is not None

    def _kept(self, signal: Signal, needed: Sequence[Input], local: Names) -> Kept:
        name = local.unique(variable(signal.name))
        read_of = [i for i in needed if i.signal == signal]
        has_times, has_arrays = (any(isinstance(i, each) for i in read_of) for each in (Slope, Recent))
        return Kept(name, signal, kept_as(signal), depth_of(signal, read_of), has_times, has_arrays)

    def ready(self, wanted: Iterable[Input]) -> list[Code]:
        """All of these hold if every input has a value, as those have that have one before their first sample."""
        wanted = [i for i in wanted if not isinstance(i, New) and not _has_value_at_first(i.signal)]
        parts = [Text(f"signals->has_{group.name}") for group in self.given.sources(wanted)]
        return [*parts, *dict.fromkeys(code for i in wanted for code in self._long_enough(i))]

    def _long_enough(self, wanted: Input) -> Iterator[Code]:
        kept = self.kept[wanted.signal]
        if reach(wanted) > 1 or wanted.signal.when is not None:
            yield Chain((Text(f"signals->{kept.name}_count"), Text(f"{reach(wanted)}u")), (">=",))
        else:
            for part in wanted.signal.inputs:
                if not _has_value_at_first(part.signal):
                    yield from self._long_enough(part)

    def named(self, wanted: Input) -> Named:
        """Where the value of an input is, where a step is judged."""
        if isinstance(wanted, New):
            flags = [f"signals->{self.heard[topic].name}" for topic in topics_of(wanted.signal)]
            return Named(" || ".join(flags), BOOL)
        if wanted.signal.is_constant:
            assert not isinstance(wanted.signal.definition, Field)
            return Named(text_of(self.helpers.speller({}).code(double(wanted.signal.definition))), DOUBLE)
        kept = self.kept[wanted.signal]
        match wanted:
            case Past(_, samples):
                return Named(kept.ago(samples), kept.type)
            case Recent(_, samples):
                self.helpers.type_text(recent_of(wanted.signal))
                return kept.recent(samples + 1)
            case Slope():
                cast = "" if kept.type == DOUBLE else "(double)"
                change = f"{cast}{kept.ago(0)} - {cast}{kept.ago(1)}"
                return Named(f"slope({change}, {kept.time(0)} - {kept.time(1)})", DOUBLE)
            case _:
                return Named(kept.latest, kept.type)

    def made_ready(self) -> list[str]:
        """Statements without which something has not its value before the first sample: a string is none if it is 0."""
        found: list[Statement] = []
        for signal, kept in self.kept.items():
            place = f"monitors->{self.name}.{kept.name}{'[0]' if kept.depth > 1 else ''}"
            if (first := first_value(signal)) is not None:
                found.append(Do(f"{place} = ", self.helpers.speller({}).code(first)))
            elif signal in self.excused and kept.type == TEXT:
                found.append(f'{place} = ""')
        return lines(found, INDENT)

    def numbers(self) -> list[str]:
        """Where all values are of which one that is NaN makes a step of some property invalid."""
        wanted = dict.fromkeys(i for p in self._properties for i in p.inputs())
        found = [name for i in wanted for name in [self.nan_of(i)] if name]
        return list(dict.fromkeys([*found, *(kept.latest for kept in self.values.values())]))

    def nan_of(self, wanted: Input) -> str | None:
        """Where the value of an input is if it can be NaN."""
        if isinstance(wanted, New) or wanted.signal.is_constant:
            return None
        named = self.named(wanted)
        return None if not named.type.is_number or named.type.scalar.is_integer else named.text

    def stored(self) -> list[str]:
        """The fields of what is kept of samples, and of when it changes."""
        lines = []
        for kept in [*self.kept.values(), *self.values.values()]:
            if kept.depth == 1:
                lines.append(f"{self.helpers.declared(kept.type, kept.name)};")
                continue
            lines.append(f"{self.helpers.declared(kept.type, f'{kept.name}[{kept.places}]')};")
            if kept.has_times:
                lines.append(f"int64_t {kept.name}_times[{kept.depth}];")
            lines += [f"uint32_t {kept.name}_latest;", f"uint32_t {kept.name}_count;"]
        lines += [f"{self.helpers.prefix}_ticks ticks;"] if self.is_rated else []
        lines += ["uint32_t together;", "bool has_started : 1;"]
        lines += [f"bool has_{group.name} : 1;" for group in self.groups]
        lines += [f"bool {heard.name} : 1;" for heard in self.heard.values()]
        return [f"{INDENT}{line}" for line in lines]

    def taken(self) -> list[str]:
        """Statements that keep what has come in `samples`, and compute what depends on it."""
        seen = tuple(f"signals->has_{g.name} = signals->has_{g.name} || samples->has_{g.name}" for g in self.groups)
        # Where something is excused, some may come later than all properties have started.
        found: list[Statement] = [If(Text("!signals->has_started"), seen)] if seen and not self.excused else [*seen]
        every = [Text(f"samples->has_{group.name}") for group in self.groups] or [Text("true")]
        found.append(Do("const bool all = ", conjunction(every)))
        found += self._taken_together()
        found += [each for kept in [*self.kept.values(), *self.values.values()] for each in self._computed(kept)]
        return lines(found, INDENT)

    def _taken_together(self) -> list[Statement]:
        """Where samples of all come at once, as where a program reads all sensors and steps, flags are asked once."""
        plain = [group for group in self.groups if all(kept.depth == 1 for _, kept in self._of(group))]
        each: list[Statement] = [*map(self._taken, plain)]
        if len(plain) > 1:
            at_once = tuple(statement for group in plain for statement in self._taken(group).then)
            each = [If(Text("all"), at_once, tuple(each))]
        return [*each, *(self._taken(group) for group in self.groups if group not in plain)]

    def _taken(self, group: Group) -> If:
        given = ((kept, Text(f"samples->{self.given.fields[signal]}")) for signal, kept in self._of(group))
        pushed = tuple(statement for kept, value in given for statement in self._pushed(kept, value))
        return If(Text(f"samples->has_{group.name}"), pushed)

    def _of(self, group: Group) -> list[tuple[Signal, Kept]]:
        """What is kept of the fields of a group, of which other properties may read more."""
        return [(signal, self.kept[signal]) for signal in group.readings if signal in self.kept]

    def taken_of(self, wanted: Iterable[Input], values: Iterable[Expression]) -> list[str]:
        """Those of these statements that matter to inputs and to values that can be NaN."""
        parts: dict[Signal, None] = {}

        def need(signal: Signal) -> None:
            if signal not in parts:
                for part in signal.inputs:
                    if not isinstance(part, New):
                        need(part.signal)
            parts[signal] = None

        for each in wanted:
            if not isinstance(each, New):
                need(each.signal)
        kept = [self.kept[signal] for signal in parts if signal in self.kept]
        kept += [self.values[value] for value in values if value in self.values]
        found = [*map(self._taken, self.given.sources(wanted)), *(each for of in kept for each in self._computed(of))]
        return lines(found, "")

    def _computed(self, kept: Kept) -> tuple[If, ...]:
        definition, parts = kept.of.definition, kept.of.inputs
        if isinstance(definition, Field):
            return ()
        speller = self.helpers.speller({read(part): self.named(part).text for part in parts})
        news = dict.fromkeys(topic for new in news_within(parts) for topic in topics_of(new.signal))
        fresh = [*self.given.fresh(parts), *(Text(f"signals->{self.heard[topic].name}") for topic in news)]
        value = double(definition) if kept.type == DOUBLE else lowered(definition)
        when = conjunction([disjunction(fresh), *self.ready(parts)]) if fresh else Text("false")
        pushed = self._pushed(kept, speller.code(value))
        if kept.of.when is not None:
            pushed = (If(speller.code(has_sample(kept.of)), pushed),)
        return (If(when, pushed),)

    def _pushed(self, kept: Kept, value: Code) -> tuple[Statement, ...]:
        """Statements that keep a new value."""
        name, depth = f"signals->{kept.name}", kept.depth
        if depth == 1:
            return (Do(f"{name} = ", value),)
        return (
            f"{name}_latest = {name}_latest + 1u < {depth}u ? {name}_latest + 1u : 0u",
            Do(f"{name}[{name}_latest] = ", value),
            *((f"{name}[{name}_latest + {depth}u] = {name}[{name}_latest]",) if kept.has_arrays else ()),
            *((f"{name}_times[{name}_latest] = time",) if kept.has_times else ()),
            If(Text(f"{name}_count < {depth}u"), (f"{name}_count++",)),
        )


def _has_value_at_first(signal: Signal) -> bool:
    """Whether there is a value before any sample."""
    return signal.is_constant or signal.otherwise is not None
