"""Monitors in C99: a header, a source file, and a header that wraps them for C++17."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import PurePath

from ltlc import __version__
from ltlc.backends.c.code import comment, layout, lines, literal, remark
from ltlc.backends.c.expressions import C
from ltlc.backends.c.functions import texts
from ltlc.backends.c.monitors import PropertyWriter, none_nan
from ltlc.backends.c.names import member_names, property_names
from ltlc.backends.c.signals import Signals
from ltlc.backends.c.types import plural, pointer
from ltlc.backends.python.code import INDENT, Chain, Code, Text
from ltlc.backends.python.names import variable
from ltlc.backends.python.statements import If, conjunction, disjunction
from ltlc.backends.spelling import NotInTargetError
from ltlc.backends.templates import template
from ltlc.compiler import Compiled
from ltlc.runtime.times import NEVER, SECOND
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.expressions import Signal
from ltlc.specification.specification import Specification

__all__ = ["Bound", "Files", "emit", "prefix_of"]

_MEANINGS = {
    Verdict.NOT_STARTED: "no step yet",
    Verdict.VIOLATED: "whatever follows",
    Verdict.PRESUMABLY_VIOLATED: "something is still owed",
    Verdict.PRESUMABLY_SATISFIED: "nothing is owed so far",
    Verdict.SATISFIED: "whatever follows",
}


@dataclass(frozen=True, slots=True)
class Bound:
    """How many conditions of properties one call asks at most: at a step, and for each clock step that is due."""

    step: int
    clock_step: int

    def __str__(self) -> str:
        later = f", and {self.clock_step} for each clock step that is due" if self.clock_step else ""
        return f"at most {self.step} condition{'' if self.step == 1 else 's'} a step{later}"


@dataclass(frozen=True, slots=True)
class Files:
    """The texts of the header, the source file and the header for C++, and what a step costs at most.

    `signals` and `properties` are what the texts were made from.
    """

    stem: str
    prefix: str
    header: str
    source: str
    wrapper: str
    bound: Bound
    signals: Signals
    properties: tuple[PropertyWriter, ...]

    def signals_of(self, number: int) -> list[Signal]:
        """The fields that the property with this number is computed from."""
        groups = self.properties[number].groups
        return [signal for group in groups for signal in group.readings]

    def text_of(self, number: int) -> list[str]:
        """What the files say of the property with this number: its own code, and that of what it reads."""
        writer = self.properties[number]
        return [
            *writer.members(),
            *writer.schedule,
            *writer.clock_step,
            *writer.step,
            *writer.is_due,
            *writer.hearing(),
            *writer.heard(),
            *writer.session(),
            *(f"{parameter} = {given};" for parameter, given in writer.arguments),
            *self.signals.taken_of(writer.inputs, writer.parameters),
            *(text for name, text in self.signals.helpers.counts.values() if any(name in line for line in writer.step)),
        ]

    def names_of(self, number: int) -> list[str]:
        """The names in that text that come from those of the specification."""
        writer = self.properties[number]
        kept = [kept.name for kept in [*self.signals.kept.values(), *self.signals.values.values()]]
        return [
            writer.name,
            writer.type,
            *(f"{writer.name}_{what}" for what in ("step", "is_due", "expire", "schedule", "hear")),
            *(f"{name}{what}" for name in kept for what in ("", "_latest", "_count", "_times")),
            *(f"has_{group.name}" for group in self.signals.groups),
            *(heard.name for heard in self.signals.heard.values()),
            *self.signals.fields.values(),
            *(named.text for named in (*writer.parameters.values(), *writer.late.values(), *writer.openings.values())),
            *(name for name, _ in self.signals.helpers.counts.values()),
        ]


def prefix_of(stem: str) -> str:
    """What all public names begin with in files with this name."""
    return member_names().unique(variable(stem).lower())


def emit(compiled: Sequence[Compiled], specification: Specification, stem: str | None = None) -> Files:
    """The files for `compiled`, to be called `stem`, or as the specification. Raises NotInTargetError."""
    stem = stem or PurePath(specification.source.name).stem
    prefix = prefix_of(stem)
    helpers = C(prefix)
    signals = Signals(compiled, helpers)
    return _File(compiled, specification, stem, prefix, signals).files()


def _require_one_pace(properties: Sequence[PropertyWriter]) -> None:
    """Raise NotInTargetError where ticks of properties begin at several times: with what each reads, or the session."""
    starts = {p: None if p.from_session else frozenset(p.topics).union(g.topic for g in p.groups) for p in properties}
    ticking = [(p, topics) for p, topics in starts.items() if topics != frozenset()]
    if any(topics != ticking[0][1] for _, topics in ticking):
        raise NotInTargetError(
            f"ticks that begin with other topics than those of `{ticking[0][0].specification.label}`"
        )


class _File:
    """What the parts of one file of properties have in common."""

    def __init__(
        self, compiled: Sequence[Compiled], specification: Specification, stem: str, prefix: str, signals: Signals
    ) -> None:
        self.compiled = compiled
        self.specification = specification
        self.stem = stem
        self.prefix = prefix
        self.signals = signals
        members = property_names(prefix)
        self.properties = [
            PropertyWriter(c, members.unique(variable(c.specification.label)), prefix, signals) for c in compiled
        ]
        constants = member_names(*(verdict.name for verdict in Verdict), "NEVER", "H", "HPP")
        self.constants = [f"{prefix.upper()}_{constants.unique(p.name.upper())}" for p in self.properties]
        self.is_timed = any(p.clock_step for p in self.properties)
        self.is_rated = specification.rate is not None
        self.ends = specification.timeout is not None
        for p in self.properties:
            p.write_due(self.is_rated)
        if self.is_rated:
            _require_one_pace(self.properties)
        self.reads_session = any(p.from_session or p.ages for p in self.properties)

    def files(self) -> Files:
        """All of them."""
        bounds = [p.decisions() for p in self.properties]
        bound = Bound(sum(step for step, _ in bounds), max((clock for _, clock in bounds), default=0))
        source = self._source(bound)
        context = self._context(bound)
        header = template(__name__, "header.h.jinja").render(context)
        wrapper = template(__name__, "wrapper.hpp.jinja").render(context)
        return Files(self.stem, self.prefix, header, source, wrapper, bound, self.signals, tuple(self.properties))

    def _context(self, bound: Bound) -> dict[str, object]:
        source = self.specification.source.name
        helpers = self.signals.helpers
        return {
            "prefix": self.prefix,
            "guard": self.prefix.upper() + "_H",
            "stem": self.stem,
            "never": NEVER,
            "constant": self.prefix.upper(),
            "about_wrapper": comment(f"The monitors that {self.stem}.h declares, for C++17."),
            "about": self._about(source, bound),
            "verdicts": [(f"{self.prefix.upper()}_{v.name}", v.name, meaning) for v, meaning in _MEANINGS.items()],
            "properties": [
                (p.name, constant, literal(p.specification.label), remark(f"line {p.specification.line}"))
                for p, constant in zip(self.properties, self.constants, strict=True)
            ],
            "structs": [line for p in self.properties for line in p.members()],
            "given": self.signals.given(),
            "stored": self.signals.stored(),
            "arrays": [(f"{self.prefix}_{plural(t)}", pointer(t)) for t in helpers.arrays],
            "timed": self.is_timed,
            "rated": self.is_rated,
            "ends": self.ends,
            "advances": self.is_timed or self.is_rated or self.ends,
            "session": self.reads_session,
            "is_empty": not self.signals.groups and not self.signals.heard,
        }

    def _about(self, source: str, bound: Bound) -> list[str]:
        first = f"Runtime monitors for the properties of {source}, made by ltlc {__version__}."
        of_each = [f"{c.specification.label}: {c.specification.text}" for c in self.compiled]
        rules = (
            "Compile with -ffp-contract=off and without -ffast-math: numbers are compared as the property language "
            "says, which asks for IEEE 754 arithmetic as it is written."
        )
        cost = (
            f"The worst case: {bound}, beside what keeps and computes the samples. No heap, no recursion, no globals."
        )
        return comment(first, *of_each, rules, cost)

    def _source(self, bound: Bound) -> str:
        judge, taken = self._judge(), self.signals.taken()
        properties = [[*p.schedule, *p.clock_step, *p.step, *p.is_due, *p.hearing()] for p in self.properties]
        code = "\n".join([*judge, *taken, *(line for each in properties for line in each)])
        # What a property reads has a name, also where no condition asks for it.
        called = self.signals.helpers.called - {name for name in ("past", "slope") if f"{name}(" not in code}
        own = {"least", "greatest"} & called
        functions = texts([*sorted(called), *own], self.signals.helpers.arrays, self.prefix)
        uses_math = (
            "math.h" in called
            or any(w in "".join(functions) for w in ("sqrt(", "fabs(", "INFINITY", "NAN"))
            or called & {"sqrt", "fabs", "fabsf"}
        )
        return template(__name__, "source.c.jinja").render(
            prefix=self.prefix,
            stem=self.stem,
            about=comment(f"The monitors that {self.stem}.h declares; see there."),
            math=bool(uses_math),
            soonest="sooner" in called,
            functions=functions,
            counts=[text for _, text in self.signals.helpers.counts.values()],
            properties=["\n".join(each) for each in properties],
            members=[(p.name, c) for p, c in zip(self.properties, self.constants, strict=True)],
            judge=judge,
            taken=taken,
            constant=self.prefix.upper(),
            timed=self.is_timed,
            timed_names=[p.name for p in self.properties if p.clock_step],
            dues=[(p.name, due) for p in self.properties if p.timed for due in dict.fromkeys([*p.clocks, "due"])],
            timed_out=self._timeout([self._has_started(p) for p in self.properties]),
            held=[line for p in self.properties if p.clock_step for line in self._held(p)],
            rated=self.is_rated,
            period=self._period() if self.is_rated else (0, 0, 0),
            timeout=self.specification.timeout,
            ends=self.ends,
            advances=self.is_timed or self.is_rated or self.ends,
            from_session=any(p.from_session for p in self.properties),
            starts=self._starts(),
            merged=self._merged() if self.is_rated else [],
            heard=self._hearing(),
            renewed=[line for p in self.properties for line in p.heard()],
            forgotten=[f"{INDENT}monitors->signals.{h.name} = false;" for h in self.signals.heard.values()],
            session=self.reads_session,
            begun=[line for p in self.properties for line in p.session()],
            first=[line for p in self.properties if p.from_session for line in self._first(p)],
        )

    def _held(self, p: PropertyWriter) -> list[str]:
        member = f"monitors->{p.name}"
        return [
            f"{INDENT}while (time > {member}.due) {{",
            f"{INDENT * 2}{p.name}_expire(&{member});",
            f"{INDENT}}}",
        ]

    def _judge(self) -> list[str]:
        """The statements that judge one moment, at which `samples` have come."""
        text = []
        properties = self.properties
        together: list[Code] = [Text("monitors->has_started"), Text("all")]
        if not self.is_rated:
            together += [disjunction(p.triggers(False)) for p in properties if not p.groups and p.topics]
        together += none_nan(self.signals.numbers())
        text += layout(f"{INDENT}const bool together = ", conjunction(together), ";")
        text += [f"{INDENT}monitors->together += together ? 1u : 0u;"]
        for p in properties:
            if not p.triggers(self.is_rated):
                continue
            due = f"{p.name}_is_due(monitors, time, samples)"
            if p.step:
                text += lines([If(Text(f"together || {due}"), (self._step(p, "time"),))], INDENT)
            else:
                text += lines([If(Text("!together"), (f"(void){due}",))], INDENT)
        started = [self._has_started(p) for p in properties]
        text += [
            f"{INDENT}if (!monitors->has_started) {{",
            *layout(f"{INDENT * 2}monitors->has_started = ", conjunction(started), ";"),
            f"{INDENT}}}",
        ]
        return text + self._timeout(started)

    def _has_started(self, p: PropertyWriter) -> Code:
        return Chain((Text(f"monitors->{p.name}.verdict"), Text(f"{self.prefix.upper()}_NOT_STARTED")), ("!=",))

    def _timeout(self, started: Sequence[Code]) -> list[str]:
        if not self.ends:
            return []
        is_first = conjunction(
            [Chain((Text("monitors->end"), Text(f"{self.prefix.upper()}_NEVER")), ("==",)), disjunction(started)]
        )
        return lines([If(is_first, (f"monitors->end = time + INT64_C({self.specification.timeout})",))], INDENT)

    def _step(self, p: PropertyWriter, time: str, news: str | None = None) -> str:
        """The call that takes a step of a property; of all its news, `news` may be known."""
        given = [time if n == "time" else news or value for n, value in p.arguments]
        return f"{p.name}_step({', '.join([f'&monitors->{p.name}', *given])})"

    def _first(self, p: PropertyWriter) -> list[str]:
        """A property that reads nothing but news begins with the session."""
        member = f"monitors->{p.name}"
        start = [line.replace("self->", f"{member}.") for line in p.start(INDENT)]
        head, *body = start
        step = [f"{INDENT * 2}{self._step(p, 'time', 'false')};"] if p.step else []
        return [head, *body[:-1], f"{INDENT * 2}{member}.apart++;", *step, body[-1]]

    def _period(self) -> tuple[int, int, int]:
        """The time between ticks: whole nanoseconds, and a fraction of one."""
        period = SECOND / Fraction(repr(self.specification.rate))
        whole, rest = divmod(period.numerator, period.denominator)
        return min(whole, NEVER), rest, period.denominator

    def _hearing(self) -> list[str]:
        text = []
        for heard in self.signals.heard.values():
            target = f"monitors->signals.{heard.name}"
            code = self.signals.news(heard)
            if self.is_rated:
                code = disjunction([Text(target), code])
            text += layout(f"{INDENT}{target} = ", code, ";")
        return text

    def _starts(self) -> list[str]:
        """Ticks begin with the first sample, or news, of what is read."""
        flags = [f"has_{group.name}" for group in self.signals.groups]
        flags += [heard.name for heard in self.signals.heard.values() if heard.has_flag]
        if not flags:
            return []
        any_ = disjunction([Text(f"samples->{flag}") for flag in flags])
        guard = conjunction([Text("!monitors->is_ticking"), any_])
        return lines([If(guard, ("monitors->is_ticking = true", "monitors->tick = time"))], INDENT)

    def _merged(self) -> list[str]:
        """Statements that keep samples for the next tick."""
        text = []
        for group in self.signals.groups:
            kept = [
                f"monitors->latest.{self.signals.fields[s]} = samples->{self.signals.fields[s]}" for s in group.readings
            ]
            body = (*kept, f"monitors->latest.has_{group.name} = true")
            text += lines([If(Text(f"samples->has_{group.name}"), body)], INDENT)
        return text
