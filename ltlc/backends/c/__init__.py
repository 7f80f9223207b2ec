"""Monitors in C99: a header, a source file, and a header that wraps them for C++17."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import PurePath

from ltlc import __version__
from ltlc.backends.c.code import comment, lines, literal, remark, unused
from ltlc.backends.c.expressions import C
from ltlc.backends.c.functions import texts, uses_math
from ltlc.backends.c.ids import Table, names_taken, require_a_table, table_of
from ltlc.backends.c.instances import OpenTable
from ltlc.backends.c.monitors import PropertyWriter
from ltlc.backends.c.names import member_names, property_names
from ltlc.backends.c.paces import Pace, signals_of
from ltlc.backends.c.samples import Samples
from ltlc.backends.c.types import plural, pointer
from ltlc.backends.inputs import require_no_bytes
from ltlc.backends.names import variable
from ltlc.backends.spelling import NotInTargetError
from ltlc.backends.statements import If
from ltlc.backends.templates import template
from ltlc.backends.trees import INDENT, Text
from ltlc.backends.wording import MEANINGS
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.program.lowering import undefined_parts
from ltlc.runtime.times import NEVER, SECOND
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.expressions import New, Signal, inputs
from ltlc.specification.specification import Specification
from ltlc.specification.text import text

__all__ = ["Bound", "Files", "emit", "prefix_of"]


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

    `samples`, `properties` and, where ids or messages are judged one by one, the `table` are what the texts were made
    from.
    """

    stem: str
    prefix: str
    header: str
    source: str
    wrapper: str
    bound: Bound
    samples: Samples
    properties: tuple[PropertyWriter, ...]
    table: Table | OpenTable | None = None

    def signals_of(self, number: int) -> list[Signal]:
        """The fields that the property with this number is computed from."""
        groups = self.properties[number].groups
        return [signal for group in groups for signal in group.readings]

    def text_of(self, number: int) -> list[str]:
        """What the files have for the property with this number: its own code, and that of what it reads."""
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
            *writer.signals.taken_of(writer.inputs, writer.parameters),
            *([] if self.table is None else self.table.text()),
            *(text for name, text in writer.helpers.counts.values() if any(name in line for line in writer.step)),
        ]

    def names_of(self, number: int) -> list[str]:
        """The names in that text that come from those of the specification."""
        writer = self.properties[number]
        signals = writer.signals
        kept = [kept.name for kept in [*signals.kept.values(), *signals.values.values()]]
        return [
            writer.name,
            writer.type,
            signals.name,
            signals.type,
            *(f"{writer.name}_{what}" for what in ("step", "is_due", "expire", "schedule", "hear")),
            *writer.decided,
            *(f"{name}{what}" for name in kept for what in ("", "_latest", "_count", "_times")),
            *(f"has_{group.name}" for group in signals.groups),
            *(heard.name for heard in signals.heard.values()),
            *self.samples.fields.values(),
            *(named.text for named in (*writer.parameters.values(), *writer.late.values(), *writer.openings.values())),
            *(name for name, _ in writer.helpers.counts.values()),
        ]


def prefix_of(stem: str) -> str:
    """What all public names begin with in files with this name."""
    return member_names().unique(variable(stem).lower())


def emit(
    compiled: Sequence[Compiled], specification: Specification, stem: str | None = None, is_grouped: bool = True
) -> Files:
    """The files for `compiled`, to be called `stem`, or as the specification. Raises NotInTargetError.

    Unless samples are `is_grouped`, each has a flag of its own.
    """
    require_no_bytes(compiled)
    require_a_table(compiled, specification)
    _require_known_at_first(compiled)
    stem = stem or PurePath(specification.source.name).stem
    prefix = prefix_of(stem)
    return _File(compiled, specification, stem, prefix, is_grouped).files()


def _require_known_at_first(compiled: Sequence[Compiled]) -> None:
    """Raise NotInTargetError if something that may be NaN is computed of nothing but values before the first sample."""
    for each in compiled:
        for part in (part for atom in each.specification.atoms for part in undefined_parts(atom.condition)):
            read = [i.signal for i in inputs(part) if not isinstance(i, New)]
            if read and all(signal.otherwise is not None for signal in read):
                raise NotInTargetError(f"`{read[0].name}` alone in `{text(part)}`, which may have no value")


class _File:
    """What the parts of one file of properties have in common."""

    def __init__(
        self,
        compiled: Sequence[Compiled],
        specification: Specification,
        stem: str,
        prefix: str,
        is_grouped: bool,
    ) -> None:
        self.compiled = compiled
        self.specification = specification
        self.stem = stem
        self.prefix = prefix
        self.is_rated = specification.rate is not None
        self.ends = specification.timeout is not None
        self.helpers = C(prefix)
        self.given = Samples([c.specification for c in compiled], self.helpers, is_grouped)
        signals = signals_of(compiled, self.given, self.helpers, self.is_rated)
        members = property_names(prefix, *names_taken(compiled), *(each.name for each in signals))
        self.properties = [
            PropertyWriter(c, members.unique(variable(c.specification.label)), prefix, kept)
            for c, kept in zip(compiled, signals, strict=True)
        ]
        self.table = table_of(self.properties)
        self.paces = [
            Pace(kept, tuple(p for p in self.properties if p.signals is kept), specification.timeout)
            for kept in {id(each): each for each in signals}.values()
        ]
        constants = member_names(*(verdict.name for verdict in Verdict), "NEVER", "H", "HPP")
        self.constants = [f"{prefix.upper()}_{constants.unique(p.name.upper())}" for p in self.properties]
        self.is_timed = any(p.clock_step for p in self.properties)
        self.reads_session = any(p.from_session or p.ages for p in self.properties)

    def files(self) -> Files:
        """All of them."""
        bounds = [p.decisions() for p in self.properties]
        bound = Bound(sum(step for step, _ in bounds), max((clock for _, clock in bounds), default=0))
        context = self._context(bound)
        source = self._source(context)
        header = template(__name__, "header.h.jinja").render(context)
        wrapper = template(__name__, "wrapper.hpp.jinja").render(context)
        return Files(
            self.stem, self.prefix, header, source, wrapper, bound, self.given, tuple(self.properties), self.table
        )

    def _context(self, bound: Bound) -> dict[str, object]:
        source = self.specification.source.name
        return {
            "prefix": self.prefix,
            "guard": self.prefix.upper() + "_H",
            "stem": self.stem,
            "never": NEVER,
            "constant": self.prefix.upper(),
            "about_wrapper": comment(f"The monitors that {self.stem}.h declares, for C++17."),
            "about": self._about(source, bound),
            "verdicts": [(f"{self.prefix.upper()}_{v.name}", v.name, meaning) for v, meaning in MEANINGS.items()],
            "properties": [
                (p.name, constant, literal(p.specification.label), remark(f"line {p.specification.line}"))
                for p, constant in zip(self.properties, self.constants, strict=True)
            ],
            "structs": [line for p in self.properties for line in p.members()],
            "given": self.given.declared(),
            "paces": self.paces,
            "arrays": [(f"{self.prefix}_{plural(t)}", pointer(t)) for t in self.helpers.arrays],
            "timed": self.is_timed,
            "rated": self.is_rated,
            "ends": self.ends,
            "advances": self.is_timed or self.is_rated or self.ends,
            "session": self.reads_session,
            "is_empty": not self.given.groups and not self.given.heard,
            "table": self.table,
        }

    def _about(self, source: str, bound: Bound) -> list[str]:
        first = f"Runtime monitors for the properties of {source}, made by ltlc {__version__}."
        of_each = [f"{c.specification.label}: {c.specification.text}" for c in self.compiled]
        rules = (
            "Compile with -ffp-contract=off and without -ffast-math: numbers are compared as the property language "
            "says, which asks for IEEE 754 arithmetic as it is written."
        )
        cost = f"Worst case: {bound}, plus storing and computing samples. No heap, no recursion, no globals."
        return comment(first, *of_each, rules, cost)

    def _source(self, context: Mapping[str, object]) -> str:
        judged = [(pace.signals, pace.judge()) for pace in self.paces]
        properties = [
            "\n".join([*p.schedule, *p.clock_step, *p.step, *p.is_due, *p.hearing()]) for p in self.properties
        ]
        counts = [text for _, text in self.helpers.counts.values()]
        table = ""
        if self.table is not None:
            table = template(__name__, "table.c.jinja").render({**context, **self.table.source()})
        code = "\n".join([*counts, *properties, *(line for _, statements in judged for line in statements), table])
        functions = texts(code, self.helpers.arrays, self.prefix)
        about = comment(f"The monitors that {self.stem}.h declares; see there.")
        return template(__name__, "source.c.jinja").render(
            {
                **context,
                "about": about,
                "properties": properties,
                "table_text": table,
            },
            math=uses_math("\n".join([*functions, code])),
            functions=functions,
            counts=counts,
            members=[(p.name, c, p.signals.name) for p, c in zip(self.properties, self.constants, strict=True)],
            judged=judged,
            timed_names=[p.name for p in self.properties if p.clock_step],
            dues=[due for p in self.properties for due in p.first_dues()],
            period=self._period() if self.is_rated else (0, 0, 0),
            taken=self._taken(),
            renewed=any(p.ages for p in self.properties),
            begun=[line for p in self.properties for line in p.session()],
            first=[line for p in self.properties if p.from_session for line in p.first()],
        )

    def _period(self) -> tuple[int, int, int]:
        """The time between ticks: whole nanoseconds, and a fraction of one."""
        period = SECOND / Fraction(repr(self.specification.rate))
        whole, rest = divmod(period.numerator, period.denominator)
        return min(whole, NEVER), rest, period.denominator

    def _taken(self) -> list[str]:
        """Take what has come: ticks begin, messages are news and renew ages, samples wait for a tick."""
        text = [line for pace in self.paces for line in (*pace.starts(), *pace.hearing())]
        text += [line for p in self.properties for line in p.heard()]
        if not self.is_rated:
            return text
        fields = self.given.fields
        for group in self.given.groups:
            kept = [f"monitors->latest.{fields[s]} = samples->{fields[s]}" for s in group.readings]
            body = (*kept, f"monitors->latest.has_{group.name} = true")
            text += lines([If(Text(f"samples->has_{group.name}"), body)], INDENT)
        return [*unused(["samples"], text), *text]
