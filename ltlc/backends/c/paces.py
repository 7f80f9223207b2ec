"""Paces: which properties of a file see the same samples, and what is done at a moment at which these are looked at."""

from __future__ import annotations

from collections.abc import Sequence

from ltlc.backends.c.code import comment, lines, unused
from ltlc.backends.c.expressions import C
from ltlc.backends.c.monitors import PropertyWriter, none_nan
from ltlc.backends.c.samples import Samples
from ltlc.backends.c.signals import Signals, Ticks
from ltlc.backends.inputs import is_from_session
from ltlc.backends.statements import Do, If, Statement, conjunction, disjunction
from ltlc.backends.trees import INDENT, Chain, Code, Text
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.specification.specification import topics


@dataclass(frozen=True)
class Pace:
    """Properties whose steps see the same samples, of which `signals` are kept; a run lasts `timeout` ns, if given."""

    signals: Signals
    properties: tuple[PropertyWriter, ...]
    timeout: int | None

    @property
    def member(self) -> str:
        """What it keeps, in the monitors."""
        return f"monitors->{self.signals.name}"

    @property
    def begins_with_session(self) -> bool:
        """Whether it has ticks, and they do."""
        return self.signals.ticks == Ticks(None)

    @property
    def about(self) -> list[str]:
        """What it keeps, as a comment."""
        ticks = self.signals.ticks
        if ticks is None:
            return comment("The stored samples.")
        begin = "the session" if ticks.topics is None else " or ".join(sorted(ticks.topics))
        return comment(f"The stored samples of ticks that begin with {begin}.")

    def hearing(self) -> list[str]:
        """Statements that note which messages are news; with a rate, up to the next tick."""
        found: list[Statement] = []
        for heard in self.signals.heard.values():
            if heard.topic in self.signals.given.marks:
                continue
            target = f"{self.member}.{heard.name}"
            before = [Text(target)] if self.signals.is_rated else []
            found.append(Do(f"{target} = ", disjunction([*before, *self.signals.given.news([heard.topic])])))
        return lines(found, INDENT)

    def forgotten(self) -> list[str]:
        """Statements after which nothing is news."""
        return [f"{INDENT}{self.member}.{heard.name} = false;" for heard in self.signals.heard.values()]

    def starts(self) -> list[str]:
        """Ticks begin with the first sample, or news, on a topic that is read."""
        ticks = self.signals.ticks
        if ticks is None or not ticks.topics:
            return []
        own = f"{self.member}.ticks"
        guard = conjunction([Text(f"!{own}.have_begun"), disjunction(self.signals.given.news(ticks.topics))])
        return lines([If(guard, (f"{own}.have_begun = true", f"{own}.next = time"))], INDENT)

    def held(self) -> list[str]:
        """Statements that take the clock steps up to and including a time; none if no property has clocks."""
        text = []
        for p in self.properties:
            member = f"monitors->{p.name}"
            if p.clock_step:
                text += [
                    f"{INDENT}while (time > {member}.due) {{",
                    f"{INDENT * 2}{p.name}_expire(&{member});",
                    f"{INDENT}}}",
                ]
        return text

    @property
    def has_ages(self) -> bool:
        """Whether messages renew ages of its properties."""
        return any(p.ages for p in self.properties)

    def judge(self) -> list[str]:
        """The statements that judge one moment, at which `samples` have come."""
        taken, found = self.signals.taken(), list[Statement]()
        together: list[Code] = [Text("signals->has_started"), Text("all")]
        if not self.signals.is_rated:
            together += [disjunction(p.triggers()) for p in self.properties if not p.groups and p.topics]
        together += none_nan(self.signals.numbers())
        found += [Do("const bool together = ", conjunction(together)), "signals->together += together ? 1u : 0u"]
        for p in self.properties:
            if not p.triggers():
                continue
            due = f"{p.name}_is_due(monitors, time, samples)"
            found.append(
                If(Text(f"together || {due}"), (p.call(),)) if p.step else If(Text("!together"), (f"(void){due}",))
            )
        started = Do("signals->has_started = ", conjunction(self._started()))
        found.append(If(Text("!signals->has_started"), (started,)))
        text = [*taken, *lines(found, INDENT), *self.timed_out()]
        return [*unused(("time", "samples"), text), *text]

    def timed_out(self) -> list[str]:
        """Once a property has started, it is known when the run ends."""
        if self.timeout is None:
            return []
        never = f"{self.signals.helpers.prefix.upper()}_NEVER"
        is_first = conjunction([Chain((Text("monitors->end"), Text(never)), ("==",)), disjunction(self._started())])
        return lines([If(is_first, (f"monitors->end = time + INT64_C({self.timeout})",))], INDENT)

    def _started(self) -> list[Code]:
        not_started = Text(f"{self.signals.helpers.prefix.upper()}_NOT_STARTED")
        return [Chain((Text(f"monitors->{p.name}.verdict"), not_started), ("!=",)) for p in self.properties]


def signals_of(compiled: Sequence[Compiled], given: Samples, helpers: C, is_rated: bool) -> list[Signals]:
    """For each property what is kept of the signals that it reads: with a rate, one for all whose ticks begin alike."""
    begins = [_begins(each) if is_rated else frozenset[str]() for each in compiled]
    # What reads nothing is never judged, whatever ticks there are.
    ticking = [topics for topics in dict.fromkeys(begins) if topics != frozenset()] or [frozenset[str]()]
    numbers = [ticking.index(topics) if topics in ticking else 0 for topics in begins]
    found = []
    for number, topics_ in enumerate(ticking):
        members = [c for c, of in zip(compiled, numbers, strict=True) if of == number]
        own = [c.specification for c in members]
        names = {each.input.signal for c in members for each in c.machine.excused}
        excused = frozenset(i.signal for of in own for i in of.inputs() if i.signal.name in names)
        suffix = f"_{number + 1}" if number else ""
        found.append(Signals(own, given, helpers, suffix, Ticks(topics_) if is_rated else None, excused))
    return [found[number] for number in numbers]


def _begins(compiled: Compiled) -> frozenset[str] | None:
    """The topics with which the ticks of a property begin; None: with the session."""
    return None if is_from_session(compiled) else frozenset(topics(compiled.specification))
