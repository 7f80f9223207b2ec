"""Emitted files of C: which functions are the monitor of which property, and that all others are what they have to be.

A step of a property is what `NAME_is_due` does before it is taken, then `NAME_step`; clock steps that are due come
first, in `hold`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import replace
from functools import cached_property

from pycparser import c_ast
from pycparser.c_ast import Node

from ltlc.assurance.reading.beginnings import CATCH_UP, INVALID, joined
from ltlc.assurance.reading.c.around import Around
from ltlc.assurance.reading.c.definitions import Definitions, shaped, statements, type_text
from ltlc.assurance.reading.c.front import C, Named, Scope, not_understood, rounded, type_of
from ltlc.assurance.reading.c.functions import CLOCK, block, called, given_to, method
from ltlc.assurance.reading.c.members import Kept, Members, Pace, Property, Struct
from ltlc.assurance.reading.c.parsing import shown
from ltlc.assurance.reading.counted import IS_FIRST
from ltlc.assurance.reading.differences import difference
from ltlc.assurance.reading.expressions import Reader
from ltlc.assurance.reading.machines import machine_in
from ltlc.assurance.reading.outcomes import Difference, ReadBack
from ltlc.assurance.reading.trees import (
    NEVER,
    TIME,
    VERDICT,
    Apply,
    Assign,
    Attribute,
    Block,
    Choice,
    Constant,
    If,
    Method,
    NotUnderstoodError,
    Return,
    Statement,
    StepClass,
    Tree,
    Variable,
)
from ltlc.dataclass import dataclass
from ltlc.program.expressions import Expression
from ltlc.program.lowering import double, has_sample, lowered, read
from ltlc.program.machine import Clock
from ltlc.program.normal import normal
from ltlc.program.types import DOUBLE
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.verdicts import Verdict
from ltlc.specification import expressions as e
from ltlc.specification.expressions import New
from ltlc.specification.text import text


def written(
    header: str,
    source: str,
    properties: Sequence[Property],
    rate: float | None = None,
    timeout: Nanoseconds | None = None,
    is_grouped: bool = True,
) -> Sequence[WrittenInC | Difference]:
    """What is written of each of `properties` in a header and a source file, or their errors.

    `rate`, in Hz, and `timeout` are those of their specification. Unless samples are `is_grouped`, each has a flag.
    """
    try:
        with shaped():
            return _File(header, source, properties, rate, timeout, is_grouped).written()
    except NotUnderstoodError as error:
        return [Difference(str(error))] * len(properties)


class _File:
    """All but the steps of properties is compared with what it has to be. Raises NotUnderstoodError."""

    def __init__(
        self,
        header: str,
        source: str,
        properties: Sequence[Property],
        rate: float | None,
        timeout: Nanoseconds | None,
        is_grouped: bool,
    ) -> None:
        self.definitions = Definitions(header, source)
        self.members = Members(self.definitions, properties, rate is not None, is_grouped)
        stepped, expiring = (
            [each.name for each in self.members.structs if f"{each.name}_{end}" in self.definitions]
            for end in ("step", "expire")
        )
        self.around = Around(self.members, stepped, expiring, rate, timeout)

    def written(self) -> list[WrittenInC]:
        """What is written of each property."""
        self.definitions.require_types(self.around.types())
        left_open = self.definitions.left_open(self.around.functions())
        self._require_known(left_open.keys())
        found: dict[str, WrittenInC] = {}
        for pace in self.members.paces:
            values = left_open[f"judge{pace.suffix}"]
            self._require_derived(pace, values)
            self._require_first(pace, left_open.get(f"{self.definitions.prefix}_init", {}))
            for struct in pace.properties:
                calls = [nodes.get(f"_step_{struct.name}") for nodes in left_open.values()]
                call = next((each for each in calls if each is not None), None)
                first = left_open.get("first_steps", {}).get(f"_first_{struct.name}")
                found[struct.name] = WrittenInC(self.definitions, self.around, pace, struct, values, call, first)
        return [found[struct.name] for struct in self.members.structs]

    def _require_known(self, around: Set[str]) -> None:
        """There is no function but these, those that files share, and what the steps of properties consist of."""
        own = tuple(f"{each.name}_" for each in self.members.structs)
        for name in self.definitions.functions.keys() - around - self.definitions.shared:
            if not name.startswith(own) and not self.definitions.is_counting(name):
                raise NotUnderstoodError(f"`{name}` is not a function of such a file")

    def _require_derived(self, pace: Pace, values: Mapping[str, Node]) -> None:
        """What signals are computed from is what they are defined as."""
        for number, kept in enumerate(pace.kept.values()):
            definition, parts = kept.of.definition, kept.of.inputs
            if isinstance(definition, e.Field):
                continue
            scope = Scope(self.definitions, {}, readings(self.definitions, pace, parts))
            reader = Reader(C, {text(part): read(part) for part in parts}, {})
            right = {f"_value_{number}": double(definition) if kept.type == DOUBLE else lowered(definition)}
            if kept.of.when is not None:
                right[f"_when_{number}"] = has_sample(kept.of)
            for name, expression in right.items():
                if reader.expression(scope.tree(values[name])) != rounded(normal(expression)):
                    raise NotUnderstoodError(f"`{kept.name}` is not computed as it is defined")

    def _require_first(self, pace: Pace, values: Mapping[str, Node]) -> None:
        """What has a value before its first sample has the right one."""
        for number, kept in enumerate(pace.kept.values()):
            if kept.of.otherwise is None:
                continue
            found: object = None
            right = kept.of.otherwise.value
            match Scope(self.definitions, {}, {}).tree(values[f"_first{pace.suffix}_{number}"]):
                case Constant(value):
                    found = value
                case Apply("-", (Constant(float() as value),)):
                    found = -value
                case _:
                    pass
            if kept.type.is_number:
                right = int(right) if kept.type.scalar.is_integer else float(right)
            if repr(found) != repr(right):  # which distinguishes true from 1, and -0.0 from 0.0
                raise NotUnderstoodError(f"`{kept.name}` does not begin as it is defined")


def readings(definitions: Definitions, pace: Pace, inputs: Sequence[e.Input]) -> dict[str, Named]:
    """Where inputs are read when a step is judged, by the text of that; they are called as the specification does."""
    texts = [pace.place(each) for each in inputs]
    types = [type_of(definitions.prefix, pace.type(each)) for each in inputs]
    named = zip(definitions.places(texts), map(text, inputs), types, strict=True)
    return {place: Named(Variable(name), type_) for place, name, type_ in named}


@dataclass(frozen=True)
class WrittenInC:
    """What is the monitor of a property in files of C.

    `values` are what its pace computes, `call` and `first` the calls of its step, with a message and with the session.
    """

    definitions: Definitions
    around: Around
    pace: Pace
    struct: Struct
    values: Mapping[str, Node]
    call: Node | None
    first: Node | None

    def read_back(self) -> ReadBack | Difference:
        """Compare the machine that the functions are with the one that it has to be."""
        said = self.struct.of.machine
        atoms, guards = (tuple(map(rounded, each)) for each in (said.atoms, said.guards))
        machine = replace(said, atoms=atoms, guards=guards, clocks=tuple(map(_rounded, said.clocks)))
        try:
            with shaped():
                if not self.around.triggers(self.pace, self.struct) and not self.struct.is_from_session:
                    return ReadBack(1)  # of which there is never a step
                found = machine_in(self.step_class(), machine, machine.inputs, C)
        except NotUnderstoodError as error:
            return Difference(str(error))
        wrong = difference(found, machine)
        return ReadBack(len(found.states)) if wrong is None else Difference(wrong)

    @property
    def _is_timed(self) -> bool:
        """Whether clock steps may come; they need not change anything."""
        return bool(self.struct.dues)

    @property
    def _type(self) -> str:
        return f"{self.definitions.prefix}_{self.struct.name}"

    @cached_property
    def _readings(self) -> dict[str, Named]:
        """What is read where a step is judged, by its text; of values that can be NaN, these themselves."""
        values = {kept.ago(): Named(Variable(kept.name), "double") for kept in self._values}
        return {**readings(self.definitions, self.pace, self.struct.inputs), **values}

    @property
    def _values(self) -> list[Kept]:
        """What it reads that is computed, and can be NaN though no sample is."""
        return [self.pace.values[value] for value in self.struct.values]

    def step_class(self) -> StepClass:
        """The functions of the property in the small language. Raises NotUnderstoodError."""
        name, time = self.struct.name, (TIME.name,) if self._is_timed else ()
        names = self._handed()
        inputs = map(text, self.struct.inputs)
        methods = {"start": self._start(), "step": Method((*time, *inputs), self._step(names))}
        if self._is_timed:
            methods["expire"] = Method((), ())
        if name in self.around.expires:
            methods["expire"] = method(self.definitions, f"{name}_expire", self._type, Scope(self.definitions, {}, {}))
        todo = called(each.body for each in methods.values()) - methods.keys()
        scope = Scope(self.definitions, CLOCK | names | self._locals(), {})
        while todo:
            key = todo.pop()
            methods[key] = method(self.definitions, key, self._type, scope, self._is_timed)
            todo |= called([methods[key].body]) - methods.keys()
        ages = {due: (age.signal, age.duration) for due, age in self.struct.ages.items()}
        return StepClass(name, methods, self.struct.kept, tuple(self.struct.histories.items()), ages)

    def _start(self) -> Method:
        """All is 0 but for what is due, as the session begins; that is what it has to be."""
        body = [
            Assign(Attribute("state"), Constant(0)),
            Assign(VERDICT, Constant(Verdict.NOT_STARTED)),
            Assign(Attribute("invalid"), Constant(0)),
        ]
        if not self._is_timed:
            return Method((), tuple(body))
        for name in self.struct.dues:
            age = self.struct.ages.get(name)
            due = Apply("+", (Variable("session"), Constant(age.duration))) if age else NEVER
            body.append(Assign(Attribute(name), Apply("-", (due,)) if name in self.struct.counts else due))
        body += [Assign(Attribute(name), Constant(False)) for name in self.struct.occurring]
        return Method(("session",), tuple(body))

    def _handed(self) -> dict[str, Named]:
        """What the parameters of the step stand for: what it is called with, of the same types."""
        call = self.first if self.call is None else self.call
        if f"{self.struct.name}_step" not in self.definitions or call is None:
            return {}
        places = self._places(call)
        if self.first is not None and self._places(self.first) != [self._at_first(place) for place in places]:
            raise NotUnderstoodError(f"`{self.struct.name}_step` receives a different first argument")
        unknown = next((place for place in places if place not in self._readings and place != "time"), None)
        if unknown is not None:
            raise NotUnderstoodError(f"`{unknown}` is not an argument of `{self.struct.name}_step`")
        handed = [CLOCK["time"] if place == "time" else self._readings[place] for place in places]
        wanted = given_to(self.definitions, f"{self.struct.name}_step", self._type)
        if [(name == "time", type_) for name, type_ in wanted] != [(n.tree == TIME, n.type) for n in handed]:
            raise NotUnderstoodError(f"`{self.struct.name}_step` receives an argument of the wrong kind")
        return dict(zip((name for name, _ in wanted), handed, strict=True))

    def _places(self, call: Node) -> list[str]:
        """What a call hands on after the struct."""
        match call:
            case c_ast.FuncCall(name=c_ast.ID(name=function), args=c_ast.ExprList(exprs=[first, *rest])):
                if (function, shown(first)) != (f"{self.struct.name}_step", f"&monitors->{self.struct.name}"):
                    raise not_understood(call)
                return [shown(each) or "" for each in rest]
            case _:
                raise not_understood(call)

    def _at_first(self, place: str) -> str:
        """The arguments at the session's beginning, in place of those of a message: there is no news."""
        news = self.definitions.places([self.pace.place(each) for each in self.struct.inputs if isinstance(each, New)])
        return "false" if place in news else place.replace("signals->", f"monitors->{self.pace.name}.")

    def _locals(self) -> dict[str, Named]:
        body = self._statements()
        return {n.name: Named(Variable(n.name), type_text(n)) for n in body if isinstance(n, c_ast.Decl)}

    def _statements(self) -> list[Node]:
        name = f"{self.struct.name}_step"
        return statements(self.definitions.function(name)) if name in self.definitions else []

    def _step(self, names: Mapping[str, Named]) -> Block:
        """What is due, what is asked before a step, and the step."""
        body = list(block(self._statements(), Scope(self.definitions, names, {}), self._is_timed))
        computed = [*self._computed(), *_taken(body)]
        self._require_doubles(computed)
        undefined = self._undefined()
        match body[:1]:
            case [If(test, (first, Return()), ())] if first == INVALID:
                undefined += test.arguments if isinstance(test, Apply) and test.function == "or" else (test,)
                body.pop(0)
            case _:
                pass
        presumed = self._presumed()
        is_late = self.struct.undefined != self.struct.values
        if is_late and (not body or body.pop(0) != self._started(*presumed)):
            raise NotUnderstoodError(f"`{self.struct.name}_step` does not record that it is the first")
        guard = [If(joined("or", undefined), (INVALID, Return(VERDICT)))] if undefined else []
        last = len(self.struct.kept) + len(self.struct.counts)
        kept, rest = body[:last], body[last:]
        at_first = [If(IS_FIRST, (each,)) for each in presumed]
        due = [CATCH_UP] if self.struct.name in self.around.expires else []
        return (*due, *computed, *guard, *at_first, *kept, self._started(), *rest, Return(VERDICT))

    def _computed(self) -> list[Statement]:
        """The values that can be NaN though no sample is."""
        scope = Scope(self.definitions, {}, readings(self.definitions, self.pace, self.struct.inputs))
        every = [*self.pace.kept.values(), *self.pace.values.values()]
        nodes = ((kept, self.values[f"_value_{every.index(kept)}"]) for kept in self._values)
        return [Assign(Variable(kept.name), scope.tree(node)) for kept, node in nodes]

    def _undefined(self) -> list[Tree]:
        """Where a step is none before it is taken; that is what it has to be."""
        numbers = self.pace.numbers(self.struct)
        return [
            Apply("not", (Apply("measured", (self._readings[each].tree,)),))
            for each in self.definitions.places(numbers)
        ]

    def _presumed(self) -> list[Statement]:
        """What the first step presumes; that is what it has to be."""
        counts = ((name, count.duration or 0) for name, count in self.struct.counts.items() if count.presumed)
        return [Assign(Attribute(name), Apply("+", (TIME, Constant(duration)))) for name, duration in counts]

    def _started(self, *also: Statement) -> Statement:
        """The first step sets the verdict."""
        return If(IS_FIRST, (Assign(VERDICT, Constant(self.struct.of.machine.states[0].verdict)), *also))

    def _require_doubles(self, computed: Iterable[Statement]) -> None:
        """What is computed is a double, as its variable is: C would make one of anything."""
        machine = self.struct.of.machine
        known: dict[str, Expression] = {text(each): read(each) for each in self.struct.inputs}
        kept = iter(machine.registers)
        for each in computed:
            assert isinstance(each, Assign)
            if isinstance(each.value, Choice | Variable):
                known[each.target.name] = next(kept).kept
                continue
            known[each.target.name] = Reader(C, known, {}).expression(each.value)
            if known[each.target.name].type != DOUBLE:
                raise NotUnderstoodError(f"`{each.target.name}` is not a double")


def _rounded(clock: Clock) -> Clock:
    """A clock whose condition, if it counts, is as C computes it."""
    count = clock.occurrences
    return clock if count is None else Clock(occurrences=count._replace(condition=rounded(count.condition)))


def _is_local(statement: Statement) -> bool:
    match statement:
        case Assign(Variable(name)):
            return name != "state"
        case _:
            return False


def _taken(body: list[Statement]) -> list[Statement]:
    """The variables at the beginning of `body`, which are taken off it."""
    count = next((n for n, each in enumerate(body) if not _is_local(each)), len(body))
    found = body[:count]
    del body[:count]
    return found
