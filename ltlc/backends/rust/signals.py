"""Samples and signals in Rust: what a step is given, what is kept of it, and what is computed from that."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from ltlc.backends.inputs import origin
from ltlc.backends.names import Names, input_name, variable
from ltlc.backends.operators import flat
from ltlc.backends.rust.code import comment, lines
from ltlc.backends.rust.expressions import default, is_borrowed, rust_speller, type_text
from ltlc.backends.rust.names import RESERVED
from ltlc.backends.statements import Do, If, Statement, conjunction, disjunction
from ltlc.backends.trees import INDENT, Call, Code, Text
from ltlc.program.expressions import Expression
from ltlc.program.lowering import double, has_sample, lowered, read
from ltlc.program.types import DOUBLE, Type, kept_as
from ltlc.specification import expressions as e
from ltlc.specification.expressions import Field, Input, New, Recent, Signal, Slope
from ltlc.specification.samples import entry, in_order, reach
from ltlc.specification.specification import PropertySpecification, fields, news_within, topics_of


@dataclass(frozen=True, slots=True)
class Kept:
    """The last `depth` values of a signal, and their times, if these are asked for; as arrays, if these are."""

    name: str
    type: Type
    depth: int
    has_times: bool
    has_arrays: bool


class Signals:
    """The signals that properties read, which are members of `Signals`, and of `Samples` if messages bring them."""

    def __init__(self, properties: Sequence[PropertySpecification]) -> None:
        wanted = [i for p in properties for i in p.inputs()]
        signals = in_order(wanted)
        local = Names(RESERVED)
        needed = [*wanted, *(i for signal in signals for i in signal.inputs)]
        self.kept = {s: _kept(s, needed, local.unique(variable(s.name))) for s in signals if not s.is_constant}
        self.given = [signal for signal in signals if isinstance(signal.definition, Field)]
        news = dict.fromkeys(i for i in wanted if isinstance(i, New))
        self.heard = {topic: local.unique(input_name(read(i))) for i in news for topic in topics_of(i.signal)}
        always = {entry(s.definition) for s in self.given if isinstance(s.definition, Field)}
        self.flags = [topic for topic in self.heard if topic not in always]
        """The topics of which samples have to say that a message has come: no value tells it."""

    @property
    def borrows(self) -> bool:
        """Whether samples lie elsewhere."""
        return any(is_borrowed(kept.type) for kept in self.kept.values())

    def samples(self) -> Iterator[str]:
        """The members of `Samples`."""
        for signal in self.given:
            yield from comment("///", origin(signal), indent=INDENT)
            yield f"{INDENT}pub {self.kept[signal].name}: Option<{type_text(self.kept[signal].type)}>,"
        for topic in self.flags:
            yield from comment("///", f"a message on {topic} has come", indent=INDENT)
            yield f"{INDENT}pub {self.heard[topic]}: bool,"

    def members(self) -> Iterator[tuple[str, str, str]]:
        """The members of `Signals`: name, type, and what they are at first."""
        for kept in self.kept.values():
            places = 2 * kept.depth if kept.has_arrays else kept.depth
            history = f"History<{type_text(kept.type)}, {kept.depth}, {places}>"
            yield kept.name, history, f"History::new({default(kept.type)})"
            if kept.has_times:
                yield f"{kept.name}_times", f"History<i64, {kept.depth}, {kept.depth}>", "History::new(0)"
        for name in self.heard.values():
            yield name, "bool", "false"

    def taken(self) -> list[str]:
        """The body of what keeps the samples that have come at `time`."""
        found: list[Statement] = [Do(f"self.{name} = ", self.news([topic])) for topic, name in self.heard.items()]
        for signal, kept in self.kept.items():
            if isinstance(signal.definition, Field):
                found.append(If(Text(f"let Some(value) = samples.{kept.name}"), _pushed(kept, Text("value"))))
            else:
                found.append(self._computed(kept, signal, signal.definition))
        return lines(found)

    def _computed(self, kept: Kept, signal: Signal, definition: e.Expression) -> Statement:
        names: dict[Expression, str] = {read(part): self.text(part, "self") for part in signal.inputs}
        speller = rust_speller(names)
        news = [self.text(new, "self") for new in dict.fromkeys(news_within(signal.inputs))]
        fresh = _any([*self._fresh(signal.inputs), *news])
        asked = [] if signal.when is None else [speller.code(has_sample(signal))]
        guard = conjunction([fresh, *self.ready(signal.inputs, "self"), *asked])
        value = double(definition) if kept.type == DOUBLE else lowered(definition)
        return If(guard, _pushed(kept, speller.code(value)))

    def fresh(self, wanted: Iterable[Input]) -> Code:
        """Whether a sample of an input has come."""
        return _any(self._fresh(wanted))

    def _fresh(self, wanted: Iterable[Input]) -> Iterator[str]:
        sources = dict.fromkeys(s for i in wanted if not isinstance(i, New) for s, _ in fields(i.signal))
        return (f"samples.{self.kept[source].name}.is_some()" for source in sources)

    def news(self, topics: Iterable[str]) -> Code:
        """Whether samples tell of a message on one of the topics."""
        among = frozenset(topics)
        came = [f"samples.{self.heard[topic]}" for topic in self.flags if topic in among]
        came += [
            f"samples.{self.kept[s].name}.is_some()"
            for s in self.given
            if isinstance(s.definition, Field) and s.definition.topic in among
        ]
        return _any(came)

    def ready(self, wanted: Iterable[Input], signals: str) -> list[Code]:
        """All of these hold if every input has a value."""
        needed: dict[str, int] = {}
        for i in wanted:
            if i.signal in self.kept and not isinstance(i, New):
                name = self.kept[i.signal].name
                needed[name] = max(reach(i), needed.get(name, 1))
        return [Text(f"{signals}.{name}.has({count})") for name, count in needed.items()]

    def text(self, wanted: Input, signals: str) -> str:
        """The value of an input."""
        if isinstance(wanted, New):
            return " || ".join(f"{signals}.{self.heard[topic]}" for topic in topics_of(wanted.signal))
        if wanted.signal not in self.kept:
            assert not isinstance(wanted.signal.definition, Field)
            return flat(rust_speller({}).code(double(wanted.signal.definition)))
        name = f"{signals}.{self.kept[wanted.signal].name}"
        if isinstance(wanted, Recent):
            return f"{name}.recent({reach(wanted)})"
        if not isinstance(wanted, Slope):
            return f"{name}.ago({reach(wanted) - 1})"
        change = f"double({name}.ago(0)) - double({name}.ago(1))"
        return f"slope({change}, {name}_times.ago(0) - {name}_times.ago(1))"


def _kept(signal: Signal, needed: Sequence[Input], name: str) -> Kept:
    own = [i for i in needed if i.signal == signal]
    has_times, has_arrays = (any(isinstance(i, each) for i in own) for each in (Slope, Recent))
    return Kept(name, kept_as(signal), max(1, *map(reach, own)), has_times, has_arrays)


def _pushed(kept: Kept, value: Code) -> tuple[Statement, ...]:
    times = (f"self.{kept.name}_times.push(time)",) if kept.has_times else ()
    return (Do("", Call(f"self.{kept.name}.push", (value,))), *times)


def _any(conditions: Iterable[str]) -> Code:
    found = [Text(condition) for condition in conditions]
    return disjunction(found) if found else Text("false")
