"""A guard in C: beside the monitors, a header and a source file with what decides over commands.

It tries what it might do on copies of the monitors, and asks whether it may rest there.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import permutations

from ltlc import __version__
from ltlc.backends.c import Bound, Files
from ltlc.backends.c.code import comment, lines, literal
from ltlc.backends.c.expressions import C
from ltlc.backends.c.functions import texts, uses_math
from ltlc.backends.c.names import member_names
from ltlc.backends.c.samples import Group
from ltlc.backends.c.signals import Signals
from ltlc.backends.c.types import pointer
from ltlc.backends.names import variable
from ltlc.backends.operators import filled, flat
from ltlc.backends.spelling import NotInTargetError
from ltlc.backends.statements import Do, Statement, conjunction, disjunction
from ltlc.backends.templates import template
from ltlc.backends.trees import INDENT, Chain, Code, Text
from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.bags.fallbacks import samples_in
from ltlc.program.expressions import Literal
from ltlc.program.guards import GuardProgram
from ltlc.program.lowering import lowered, read
from ltlc.program.normal import normal
from ltlc.program.resting import Held
from ltlc.program.types import Type, type_of
from ltlc.runtime.guard_plans import Asked, Asks
from ltlc.semantics.monitor import Target
from ltlc.specification.arrivals import waited_for
from ltlc.specification.evaluation import Value
from ltlc.specification.expressions import Signal
from ltlc.specification.guards import Fallback, Guard
from ltlc.specification.specification import topics, topics_of


@dataclass(frozen=True, slots=True)
class Cost:
    """How many conditions of properties, and decisions of the guard, one call asks at most."""

    asked: int

    def __str__(self) -> str:
        return f"at most {self.asked} conditions and decisions"


@dataclass(frozen=True, slots=True)
class GuardFiles:
    """The header and the source file, named `stem`, of guards that share properties, and what a call costs at most.

    Public names begin with `prefix`. `commands` are the functions that take commands, by the topics on which these are
    to leave; `others` has the other topics by their names there, `sent` those of the fallbacks.
    """

    stem: str
    prefix: str
    header: str
    source: str
    bound: Cost
    commands: dict[str, str]
    others: dict[str, str]
    sent: tuple[str, ...]

    @property
    def texts(self) -> dict[str, str]:
        """By the names of the files: what is included comes first."""
        return {f"{self.stem}.h": self.header, f"{self.stem}.c": self.source}


def emit(files: Files, programs: Sequence[GuardProgram]) -> list[GuardFiles]:
    """The guards beside the monitors in `files`, a pair of files for each that share properties.

    Raises NotInTargetError.
    """
    return [_File(files, program, end).files() for program, end in zip(programs, endings(programs), strict=True)]


def endings(programs: Sequence[GuardProgram]) -> list[str]:
    """What comes behind the names of the monitors' files: where there are several, the topic that a guard sends on.

    Raises NotInTargetError.
    """
    names = member_names()
    found = [f"_guard_{names.unique(_name(program.guards[0].out))}" for program in programs]
    for one, other in permutations(found, 2):
        if other.startswith(f"{one}_"):
            raise NotInTargetError(f"guards whose topics begin alike in C, as in `{one[1:]}` and `{other[1:]}`")
    return found if len(found) > 1 else ["_guard"] * len(found)


def _name(topic: str) -> str:
    return variable(topic.strip("/"))


class _File:
    """One pair; all names begin with those of the monitors, and `end` follows."""

    def __init__(self, files: Files, program: GuardProgram, end: str) -> None:
        self.of, self.program, self.end = files, program, end
        self.outs = [guard.out for guard in program.guards]
        self.prefix = f"{files.prefix}{end}"
        self.helpers = C(files.prefix)
        self.arrays: list[str] = []
        self.parts = [files.properties[number] for number in program.parts]
        self.signals: Signals = self.parts[0].signals
        self._require_written()
        self.speller = self.helpers.speller(
            {read(i): self.signals.named(i).text for held in program.resting.conditions for i in held.inputs}
            | {normal(lowered(part)): kept.latest for part, kept in self.signals.values.items()}
        )
        names = member_names()
        self.others = {topic: names.unique(_name(topic)) for topic in self._topics()}
        self.commands = dict(zip(self.outs, self._commands(), strict=True))
        constants = member_names("HOLD", "PASS")
        self.fallbacks = [(guard, fallback) for guard in program.guards for fallback in guard.fallbacks]
        upper = self.prefix.upper()
        self.sent = [f"{upper}_{constants.unique(self._called(*each))}" for each in self.fallbacks]

    def _require_written(self) -> None:
        """Raise NotInTargetError for what has no form here."""
        for writer in self.of.properties:
            if writer.name.startswith("guard"):
                raise NotInTargetError("a name that begins with `guard`, as those of the guard do")

    def _commands(self) -> list[str]:
        """The functions that take commands; of one guard alone it has the name of all."""
        names = member_names(
            "act", "decision", "due", "init", "run", *(f"hear_{name}" for name in self.others.values())
        )
        found = [f"{self.prefix}_{names.unique(_name(out))}" for out in self.outs]
        return found if len(found) > 1 else [self.prefix]

    def _called(self, guard: Guard, fallback: Fallback) -> str:
        of = f"{_name(guard.out)}_" if len(self.outs) > 1 else ""
        return f"{of}{fallback.name}".upper()

    def _groups(self, topic: str) -> list[Group]:
        return [group for group in self.of.samples.groups if group.topic == topic]

    def _topics(self) -> Iterator[str]:
        """The topics other than those of commands that a property reads which the guards keep or rely on."""
        read_ = dict.fromkeys(topic for writer in self.parts for topic in topics(writer.specification))
        return (topic for topic in read_ if topic not in self.outs)

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
        sent = tuple(self.sent)
        return GuardFiles(self.stem, self.prefix, header, source, self._bound, self.commands, self.others, sent)

    @property
    def stem(self) -> str:
        """What the files are called."""
        return f"{self.of.stem}{self.end}"

    def _counts(self) -> list[str]:
        return [text for _, text in self.helpers.counts.values()]

    def _context(self) -> dict[str, object]:
        return {
            "prefix": self.of.prefix,
            "constant": self.of.prefix.upper(),
            "guard": self.prefix,
            "upper": self.prefix.upper(),
            "of": self.of.stem,
            "stem": self.stem,
            "about": self._about(),
            "about_source": comment(f"What {self.stem}.h declares; see there."),
            "sent": [
                (name, literal(fallback.name), guard.out, self.outs.index(guard.out), self._filled(guard, fallback))
                for name, (guard, fallback) in zip(self.sent, self.fallbacks, strict=True)
            ],
            "arrays": self.arrays,
            "first": self.sent[0] if self.sent else f"{self.prefix.upper()}_HOLD",
            "outs": [*self._outs()],
            "topics": [
                (name, topic, self._copied(topic), topic in self.program.spoken) for topic, name in self.others.items()
            ],
            "heard": [name for topic, name in self.others.items() if topic in self.program.spoken],
            "ready": flat(conjunction(self._ready())),
            "parts": [writer.name for writer in self.parts],
            "late": [(writer.name, writer.signals.name) for writer in self.parts if writer.late],
            "blind": self._blind(),
            "decisions": [*self._decisions()],
            "root": self.program.resting.root,
            "most": self.program.most,
            "lead": self.program.lead,
            "timed": any(writer.clock_step for writer in self.of.properties),
        }

    def _outs(self) -> Iterator[tuple[str, Guard, list[str], str, int]]:
        """Of each guard: what takes its commands, with what it copies; its first fallback, and how many it has."""
        for guard in self.program.guards:
            own = [name for name, (of, _) in zip(self.sent, self.fallbacks, strict=True) if of is guard]
            first = own[0] if own else f"{self.prefix.upper()}_HOLD"
            yield self.commands[guard.out], guard, self._copied(guard.out), first, len(own)

    def _about(self) -> list[str]:
        guards = " and ".join(guard.text for guard in self.program.guards)
        kept = ", ".join(w.specification.label for w in self.parts if not w.specification.is_assumed)
        return comment(
            f"The {guards}, made by ltlc {__version__}.",
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

    def _filled(self, guard: Guard, fallback: Fallback) -> list[str]:
        """Statements that make the samples of a fallback; what an empty array would have has none."""
        groups = self._groups(guard.out)
        read_ = {signal.name: signal for group in groups for signal in group.readings}
        samples, found = samples_in(fallback, guard, read_), list[Statement]()
        for group in groups:
            if all(signal.name in samples for signal in group.readings):
                for signal in group.readings:
                    found += self._given(signal, samples[signal.name])
                found.append(f"own.has_{group.name} = true")
        return lines([*found, *self._news(guard.out)], INDENT * 2)

    def _given(self, signal: Signal, value: Value) -> Iterator[Statement]:
        """Statements that give samples a value; an array has no elements before."""
        field, type_ = f"own.{self.of.samples.fields[signal]}", type_of(signal)
        if not isinstance(value, tuple):
            yield Do(f"{field} = ", self._constant(value, type_))
        elif value:
            elements = [f"{flat(self._constant(each, type_.element))}," for each in value]
            name = f"{self.of.samples.fields[signal]}_{len(self.arrays) + 1}"
            self.arrays += filled(f"{INDENT}static {pointer(type_)[:-1]}{name}[] = {{", elements, "};", INDENT * 2)
            yield f"{field}.elements = {name}"
            yield f"{field}.length = {len(value)}"

    def _constant(self, value: Value, type_: Type) -> Code:
        assert isinstance(value, bool | int | float | str)
        return self.helpers.speller({}).code(Literal(int(value) if type_.scalar.is_integer else value, type_))

    def _ready(self) -> list[Code]:
        """All of these hold once the guard is not silent: its topics have spoken, and have values.

        What waits for no command has begun by then, unless a value is NaN.
        """
        spoken = [Text(f"run->heard_{name}") for topic, name in self.others.items() if topic in self.program.spoken]
        not_started = Text(f"{self.of.prefix.upper()}_NOT_STARTED")
        begun = [
            Chain((Text(f"run->monitors.{writer.name}.verdict"), not_started), ("!=",))
            for writer in self.parts
            if not any(topic in self.outs for i in waited_for(writer.specification) for topic in topics_of(i.signal))
        ]
        return [*spoken, *self.signals.ready(self.program.awaited), *begun] or [Text("true")]

    def _blind(self) -> list[tuple[str, str]]:
        """Of each part where a value is missing or NaN, as far as the last step that was none does not say it."""
        found = ((writer.name, [*writer.unfit()]) for writer in self.parts if not writer.late)
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
                return f"run->sent[{of}] == {number}u"
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

        rest, fallbacks = deepest(self.program.resting.root), len(self.fallbacks)
        bound: Bound = self.of.bound
        tried = bound.step + rest
        answered = bound.clock_step + rest + fallbacks * tried
        return Cost((1 + fallbacks) * tried + answered + fallbacks * (tried + answered))
