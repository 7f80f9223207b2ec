"""Where emitted C keeps the samples of signals, and the text with which it reads them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from pycparser import c_ast
from pycparser.c_ast import Node

from ltlc.assurance.reading.c.paces import Pace
from ltlc.assurance.reading.c.text import Definitions, members, shown
from ltlc.assurance.reading.language import NotUnderstoodError
from ltlc.assurance.reading.letters import Judged
from ltlc.assurance.reading.meaning import Given
from ltlc.assurance.reading.names import recalls
from ltlc.specification.evaluation import evaluate
from ltlc.specification.expressions import Field, New, Past, Signal, Slope, inputs
from ltlc.specification.specification import topics_of
from ltlc.specification.wire import as_double


class Samples:
    """What is kept of the signals of all properties that are judged at one pace. Raises NotUnderstoodError."""

    def __init__(self, definitions: Definitions, judged: Sequence[Judged], pace: Pace) -> None:
        self.judged = judged
        self.pace = pace
        self._definitions = definitions
        self._kept = members(definitions.type(f"{definitions.prefix}_{pace.signals}"))
        wanted = [i for each in judged for i in each.specification.inputs()]
        self._signals = _in_order(i.signal for i in wanted if not isinstance(i, New))
        self._names = self._named()
        self._flags, self.values = self._read(pace)
        self._topics = self._heard([i for i in wanted if isinstance(i, New)])

    def _named(self) -> dict[Signal, str]:
        """The member that keeps each signal: those that recall it, in the order of first use."""
        left = [name for name in self._kept if not name.startswith("has_") and name not in ("together", "ticks")]
        found: dict[Signal, str] = {}
        for signal in self._signals:
            if _constant(signal) is not None:
                continue
            words = "_".join(re.findall(r"[A-Za-z0-9]+", signal.name))
            name = next((n for n in left if recalls(n, signal.name, [words, f"signal_{words}", "signal"])), None)
            if name is None:
                raise NotUnderstoodError(f"no sample of `{signal.name}` is kept")
            left.remove(name)
            found[signal] = name
        return found

    def _read(self, pace: Pace) -> tuple[dict[str, set[str]], dict[str, Node]]:
        """The flags with which what is kept is new, and what is computed that is no signal."""
        flags: dict[str, set[str]] = {}
        values: dict[str, Node] = {}
        for node in _statements(pace.statements):
            assert isinstance(node.iftrue, c_ast.Compound)
            sources = set(re.findall(r"samples->(has_\w+)", shown(node.cond)))
            for each in node.iftrue.block_items:
                for name in re.findall(r"^signals->(\w+?)(?:\[[^=]*\])? = ", shown(each)):
                    flags.setdefault(name, set()).update(sources)
                    values |= {name: each.rvalue} if name not in self._names.values() else {}
        return flags, {name: value for name, value in values.items() if self._kept.get(name) == "double"}

    def _heard(self, news: Sequence[New]) -> dict[str, str]:
        """The flag that says that a message has come on each topic."""
        called: dict[str, list[str]] = {}
        for each in news:
            for topic in topics_of(each.signal):
                words = "_".join(re.findall(r"[A-Za-z0-9]+", f"new {each.signal.name}"))
                called.setdefault(topic, []).append(words)
        left = [name for name, type_ in self._kept.items() if type_ == "bool" and not name.startswith("has_")]
        left = [name for name in left if name not in self._names.values()]
        found: dict[str, str] = {}
        for topic, news_of in called.items():
            flag = next((name for name in left if any(recalls(name, word, [word]) for word in news_of)), None)
            if flag is None:
                raise NotUnderstoodError(f"nothing says that a message has come on `{topic}`")
            left.remove(flag)
            found[topic] = flag
        return found

    def topic_of_flags(self) -> dict[str, str]:
        """The topic of each flag with which samples, or news, come."""
        read = ((name, s.definition.topic) for s, name in self._names.items() if isinstance(s.definition, Field))
        found = {flag: topic for name, topic in read for flag in self._flags.get(name, ())}
        return found | {flag: topic for topic, flag in self._topics.items()}

    def news(self, given: Given) -> list[str]:
        """The texts of which some hold if a message of a signal has come."""
        return [f"signals->{self._topics[topic]}" for topic in topics_of(given.read.signal)]

    def reading(self, given: Given) -> tuple[str, str]:
        """The text with which it is read, and its type; that of what stands there as it is, if it is constant."""
        read = given.read
        if isinstance(read, New):
            parts = self.news(given)
            text = parts[0]
            for part in parts[1:]:
                text = f"({text}) || ({part})" if " || " in text else f"{text} || {part}"
            return text, "bool"
        if _constant(read.signal) is not None:
            return f"constant {read.signal.name}", "double"
        name = self._names[read.signal]
        type_, depth = self._kept[name], 1
        if found := re.fullmatch(r"(.*)\[(\d+)\]", type_):
            type_, depth = found[1].strip(), int(found[2])
        samples = read.samples if isinstance(read, Past) else 1 if isinstance(read, Slope) else 0
        if samples >= depth or (samples and not self._is_shared("past")):
            raise NotUnderstoodError(f"`{name}` has too few samples")
        if isinstance(read, Slope):
            return self._slope(name, type_, depth), "double"
        return _ago(name, samples, depth), type_

    def _is_shared(self, function: str) -> bool:
        """Whether a function is the one that files share, or is not there because nothing calls it."""
        return function not in self._definitions or self._definitions.is_known(function)

    def _slope(self, name: str, type_: str, depth: int) -> str:
        if not self._is_shared("slope"):
            raise NotUnderstoodError("`slope` is not defined")
        cast = "" if type_ == "double" else "((double) "
        end = ")" if cast else ""
        now, before = (f"{cast}{_ago(name, samples, depth)}{end}" for samples in (0, 1))
        times = (_ago(f"{name}_times", samples, depth, name) for samples in (0, 1))
        return f"slope({now} - {before}, {' - '.join(times)})"

    def constant(self, given: Given) -> str | None:
        """The text of a signal that is computed from nothing; None if it is none."""
        value = None if isinstance(given.read, New) else _constant(given.read.signal)
        return None if value is None else repr(value)

    def flags(self, wanted: Sequence[Given]) -> set[str]:
        """The flags with which what is read is new."""
        read = {i.read.signal for i in wanted if not isinstance(i.read, New)}
        parts = _in_order(iter(read))
        fields = [s for s in parts if isinstance(s.definition, Field) and s in self._names]
        found: set[str] = set()
        for signal in fields:
            found |= self._flags.get(self._names[signal], {f"has_{self._names[signal]}"})
        return found

    def counts(self, wanted: Sequence[Given]) -> set[str]:
        """What has to hold so that histories have as many samples as are read."""
        found: set[str] = set()
        for given in wanted:
            if not isinstance(given.read, New):
                found |= set(self._counts(given.read))
        return found

    def _counts(self, read: object) -> Iterator[str]:
        assert not isinstance(read, New)
        signal = read.signal  # type: ignore[attr-defined]
        reach = read.samples + 1 if isinstance(read, Past) else 2 if isinstance(read, Slope) else 1
        if signal not in self._names:
            return
        if reach > 1:
            yield f"signals->{self._names[signal]}_count >= {reach}u"
        elif not isinstance(signal.definition, Field):
            for part in inputs(signal.definition):
                yield from self._counts(part)


def _statements(nodes: Sequence[Node]) -> Iterator[c_ast.If]:
    """The `if` among what keeps samples, whether or not all come together."""
    for node in nodes:
        match node:
            case c_ast.If(cond=c_ast.ID(name="all"), iffalse=c_ast.Compound(block_items=inside)):
                yield from _statements(inside)
            case c_ast.If(cond=cond) if shown(cond) != "!signals->has_started":
                yield node


def _ago(name: str, samples: int, depth: int, of: str | None = None) -> str:
    latest = f"signals->{of or name}_latest"
    if depth == 1:
        return f"signals->{name}"
    return f"signals->{name}[{f'past({latest}, {samples}u, {depth}u)' if samples else latest}]"


def _in_order(signals: Iterator[Signal]) -> list[Signal]:
    """Signals in the order of first use, each after its parts."""
    found: dict[Signal, None] = {}

    def enter(signal: Signal) -> None:
        if signal in found:
            return
        for part in () if isinstance(signal.definition, Field) else inputs(signal.definition):
            enter(part.signal)
        found[signal] = None

    for each in signals:
        enter(each)
    return list(found)


def _constant(signal: Signal) -> float | None:
    """The value of a signal that is computed from nothing."""
    if isinstance(signal.definition, Field) or any(True for _ in inputs(signal.definition)):
        return None
    value = evaluate(signal.definition, {})
    return as_double(value) if isinstance(value, int | float) else None
