"""A guard in C: beside the monitors, a header and a source file with what decides over commands.

It tries what it might do on copies of the monitors, and asks whether it may rest there.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property

from ltlc import __version__
from ltlc.backends.c import Bound, Files
from ltlc.backends.c.code import comment, lines, literal
from ltlc.backends.c.expressions import C
from ltlc.backends.c.functions import texts, uses_math
from ltlc.backends.c.names import member_names
from ltlc.backends.c.samples import Group
from ltlc.backends.c.signals import Signals
from ltlc.backends.names import variable
from ltlc.backends.operators import flat
from ltlc.backends.spelling import NotInTargetError
from ltlc.backends.statements import Do, conjunction, disjunction
from ltlc.backends.templates import template
from ltlc.backends.trees import INDENT, Code, Text
from ltlc.dataclass import dataclass
from ltlc.program.expressions import Literal
from ltlc.program.guards import GuardProgram
from ltlc.program.lowering import lowered, read
from ltlc.program.normal import normal
from ltlc.program.resting import Held
from ltlc.program.types import type_of
from ltlc.runtime.guard_plans import Asked, Asks
from ltlc.semantics.monitor import Target
from ltlc.specification.expressions import Signal
from ltlc.specification.fallbacks import value_in
from ltlc.specification.guards import Fallback
from ltlc.specification.specification import topics


@dataclass(frozen=True, slots=True)
class Cost:
    """How many conditions of properties, and decisions of the guard, one call asks at most."""

    asked: int

    def __str__(self) -> str:
        return f"at most {self.asked} conditions and decisions"


@dataclass(frozen=True, slots=True)
class GuardFiles:
    """The texts of the header and the source file of a guard, named `stem`, and what a call costs at most.

    Public names begin with `prefix`. `others` has the topics other than that of commands by their names there, `sent`
    those of the fallbacks.
    """

    stem: str
    prefix: str
    header: str
    source: str
    bound: Cost
    others: dict[str, str]
    sent: tuple[str, ...]

    @property
    def texts(self) -> dict[str, str]:
        """By the endings of their names."""
        return {".c": self.source, ".h": self.header}


def emit(files: Files, programs: Sequence[GuardProgram]) -> GuardFiles:
    """The guard beside the monitors in `files`. Raises NotInTargetError."""
    if len(programs) != 1 or len(programs[0].guards) != 1:
        raise NotInTargetError("more than one guard")
    return _File(files, programs[0]).files()


class _File:
    def __init__(self, files: Files, program: GuardProgram) -> None:
        self.of, self.program = files, program
        (self.guard,) = program.guards
        self.prefix = f"{files.prefix}_guard"
        self.helpers = C(files.prefix)
        self.parts = [files.properties[number] for number in program.parts]
        self.signals: Signals = self.parts[0].signals
        self._require_written()
        self.speller = self.helpers.speller(
            {read(i): self.signals.named(i).text for held in program.resting.conditions for i in held.inputs}
            | {normal(lowered(part)): kept.latest for part, kept in self.signals.values.items()}
        )
        names = member_names()
        self.others = {topic: names.unique(variable(topic.strip("/"))) for topic in self._topics()}
        constants = member_names("HOLD", "PASS")
        self.sent = [constants.unique(each.name.upper()) for each in self.guard.fallbacks]

    def _require_written(self) -> None:
        """Raise NotInTargetError for what has no form here."""
        for writer in self.parts:
            if writer.openings:
                raise NotInTargetError("a value at an opening, which a guard would have to follow")
        for writer in self.of.properties:
            if writer.name.startswith("guard"):
                raise NotInTargetError("a name that begins with `guard`, as those of the guard do")
        for group in self._groups(self.guard.out):
            for signal in group.readings:
                for fallback in self.guard.fallbacks:
                    if value_in(fallback, signal) is None:
                        raise NotInTargetError(f"the array `{signal.name}` of what the guard sends")

    def _groups(self, topic: str) -> list[Group]:
        return [group for group in self.of.samples.groups if group.topic == topic]

    def _topics(self) -> Iterator[str]:
        """The topics other than that of commands that a property reads which the guard keeps or relies on."""
        read_ = dict.fromkeys(topic for writer in self.parts for topic in topics(writer.specification))
        return (topic for topic in read_ if topic != self.guard.out)

    def files(self) -> GuardFiles:
        """Both."""
        context = self._context()
        header = template(__name__, "guard.h.jinja").render(context)
        asked = [code for _, code, _, _ in self._decisions()]
        code = "\n".join([*asked, *self._counts()])
        functions = texts(code, self.helpers.arrays, self.of.prefix)
        source = template(__name__, "guard.c.jinja").render(
            context,
            functions=functions,
            counts=self._counts(),
            math=uses_math("\n".join([*functions, code])),
        )
        stem = f"{self.of.stem}_guard"
        return GuardFiles(stem, self.prefix, header, source, self._bound, self.others, tuple(self.sent))

    def _counts(self) -> list[str]:
        return [text for _, text in self.helpers.counts.values()]

    def _context(self) -> dict[str, object]:
        return {
            "prefix": self.of.prefix,
            "constant": self.of.prefix.upper(),
            "guard": self.prefix,
            "upper": self.prefix.upper(),
            "stem": self.of.stem,
            "about": self._about(),
            "about_source": comment(f"The guard that {self.of.stem}_guard.h declares; see there."),
            "raw": self.guard.raw,
            "out": self.guard.out,
            "sent": [
                (f"{self.prefix.upper()}_{name}", literal(fallback.name), self._filled(fallback))
                for name, fallback in zip(self.sent, self.guard.fallbacks, strict=True)
            ],
            "topics": [
                (name, topic, self._copied(topic), topic in self.program.spoken) for topic, name in self.others.items()
            ],
            "command": self._copied(self.guard.out),
            "heard": [name for topic, name in self.others.items() if topic in self.program.spoken],
            "ready": flat(conjunction(self._ready())),
            "parts": [writer.name for writer in self.parts],
            "blind": self._blind(),
            "decisions": [*self._decisions()],
            "root": self.program.resting.root,
            "most": self.program.most[0],
            "lead": self.program.lead,
            "timed": any(writer.clock_step for writer in self.of.properties),
        }

    def _about(self) -> list[str]:
        otherwise = f" else {', '.join(each.name for each in self.guard.fallbacks)}" if self.guard.fallbacks else ""
        kept = ", ".join(w.specification.label for w in self.parts if not w.specification.is_assumed)
        return comment(
            f"The guard {self.guard.raw} to {self.guard.out}{otherwise}, made by ltlc {__version__}.",
            f"It keeps {kept}: nothing that leaves it violates one of them.",
            f"Worst case: {self._bound} a call, plus storing and computing samples, "
            "and copies of the monitors. No heap, no recursion, no globals.",
        )

    def _copied(self, topic: str) -> list[str]:
        """Statements that take over what samples have of a message on a topic."""
        fields, found = self.of.samples.fields, list[str]()
        for group in self._groups(topic):
            found += [f"own.{fields[signal]} = samples->{fields[signal]}" for signal in group.readings]
            found.append(f"own.has_{group.name} = samples->has_{group.name}")
        return lines([*found, *self._news(topic)], INDENT)

    def _news(self, topic: str) -> list[str]:
        return [
            f"own.{each.name} = true"
            for each in self.of.samples.heard.values()
            if each.has_flag and each.topic == topic
        ]

    def _filled(self, fallback: Fallback) -> list[str]:
        """Statements that make the samples of a fallback."""
        fields, found = self.of.samples.fields, list[Do | str]()
        for group in self._groups(self.guard.out):
            for signal in group.readings:
                found.append(Do(f"own.{fields[signal]} = ", self._constant(fallback, signal)))
            found.append(f"own.has_{group.name} = true")
        return lines([*found, *self._news(self.guard.out)], INDENT * 2)

    def _constant(self, fallback: Fallback, signal: Signal) -> Code:
        constant, type_ = value_in(fallback, signal), type_of(signal)
        assert constant is not None
        value = int(constant.value) if type_.scalar.is_integer else constant.value
        return self.helpers.speller({}).code(Literal(value, type_))

    def _ready(self) -> list[Code]:
        """All of these hold once the guard is not silent: its topics have spoken, and have values."""
        spoken = [Text(f"run->heard_{name}") for topic, name in self.others.items() if topic in self.program.spoken]
        return [*spoken, *self.signals.ready(self.program.awaited)] or [Text("true")]

    def _blind(self) -> list[tuple[str, str]]:
        """Of each part where a value is missing or NaN."""
        found = ((writer.name, [*writer.unfit()]) for writer in self.parts)
        return [(name, flat(disjunction(unfit))) for name, unfit in found if unfit]

    def _decisions(self) -> Iterator[tuple[int, str, int, int]]:
        """Each decision as a target, with what it asks, and where it leads if that is so, and if not."""
        resting = self.program.resting
        for number, (question, no, yes) in enumerate(resting.decisions):
            yield ~number, self._asked(resting.questions[question]), yes, no

    def _asked(self, question: Asked) -> str:
        """A condition that can stand before `?`."""
        asks, of, number = question
        not_started = f"{self.of.prefix.upper()}_NOT_STARTED"
        match asks:
            case Asks.SILENT:
                return "run->is_silent"
            case Asks.SENT:
                return f"run->sent == {number}u"
            case Asks.WAITS:
                return f"monitors->{self.parts[of].name}.verdict == {not_started}"
            case Asks.STANDS:
                name = f"monitors->{self.parts[of].name}"
                return f"({name}.verdict != {not_started} && {name}.state == {number}u)"
            case Asks.KNOWN:
                return f"({flat(conjunction(self._known(self.program.resting.conditions[of])))})"
            case Asks.HOLDS:
                return f"({flat(self.speller.asked(self.program.resting.conditions[of].holds, True))})"

    def _known(self, held: Held) -> list[Code]:
        numbers = [] if isinstance(held.known, Literal) else [self.speller.asked(held.known, True)]
        return [*self.signals.ready(held.inputs), *numbers] or [Text("true")]

    @cached_property
    def _bound(self) -> Cost:
        """That of a call which tries all that there is."""
        decisions = self.program.resting.decisions

        def deepest(target: Target) -> int:
            return 0 if target >= 0 else 1 + max(map(deepest, decisions[~target][1:]))

        rest, fallbacks = deepest(self.program.resting.root), len(self.guard.fallbacks)
        bound: Bound = self.of.bound
        tried = bound.step + rest
        answered = bound.clock_step + rest + fallbacks * tried
        return Cost((1 + fallbacks) * tried + answered + fallbacks * (tried + answered))
