"""Emitted files of C: which functions are the monitor of which property, and what these are given.

A step of a property is what `NAME_is_due` does before it is taken, then `NAME_step`; clock steps that are due come
first, in `hold`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from pycparser import c_ast
from pycparser.c_ast import Node

from ltlc.assurance.reading.c.expressions import Scope, not_understood
from ltlc.assurance.reading.c.functions import VERDICT, Functions, Struct, called
from ltlc.assurance.reading.c.judging import Judging
from ltlc.assurance.reading.c.paces import Taken
from ltlc.assurance.reading.c.samples import Samples
from ltlc.assurance.reading.c.text import Definitions, conjuncts, disjuncts, shaped, shown
from ltlc.assurance.reading.c.ticks import check_ticks
from ltlc.assurance.reading.c.types import SIGNED_64, Typed, type_of
from ltlc.assurance.reading.comparison import read_back
from ltlc.assurance.reading.language import (
    Apply,
    Assign,
    Attribute,
    Block,
    Constant,
    Do,
    If,
    Method,
    NotUnderstoodError,
    Return,
    Statement,
    StepClass,
    Term,
    Variable,
    While,
)
from ltlc.assurance.reading.letters import Judged
from ltlc.assurance.reading.meaning import Given
from ltlc.assurance.reading.names import recalls
from ltlc.assurance.reading.outcomes import Difference, ReadBack
from ltlc.assurance.reading.times import TIME
from ltlc.semantics.timed_atoms import Age, timed_atoms
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.expressions import New


def written(header: str, source: str, judged: Sequence[Judged]) -> Sequence[WrittenInC | Difference]:
    """What is written of each of `judged` in a header and a source file, or what is wrong with these."""
    try:
        with shaped():
            return _written(header, source, judged)
    except NotUnderstoodError as error:
        return [Difference(str(error))] * len(judged)


def _written(header: str, source: str, judged: Sequence[Judged]) -> list[WrittenInC]:
    definitions = Definitions(header, source)
    _check_verdicts(definitions)
    judging = Judging(definitions, len(judged))
    if len(judging.names) != len(judged):
        raise NotUnderstoodError(f"there are {len(judging.names)} monitors, not {len(judged)}")
    named = {_named(name, each): each for each, name in zip(judged, judging.names, strict=True)}
    samples: dict[str, Samples] = {}
    for pace in judging.paces:
        own = {name: each for name, each in named.items() if judging.pace(name) is pace}
        samples |= dict.fromkeys(own, Samples(definitions, list(own.values()), pace))
    if judging.is_rated:
        check_ticks(definitions, list(samples.values()))
    return [WrittenInC(each, definitions, judging, samples[name], name) for name, each in named.items()]


def _named(name: str, judged: Judged) -> str:
    label = judged.specification.label
    if not recalls(name, label, ["_".join(re.findall(r"[A-Za-z0-9]+", label)), label]):
        raise NotUnderstoodError(f"`{name}` is not `{label}`")
    return name


def _check_verdicts(definitions: Definitions) -> None:
    """Verdicts are those that there are, and what is 0 is the first."""
    declared = definitions.type(f"{definitions.prefix}_verdict").values.enumerators
    names = [each.name for each in declared if each.value is None]
    right = {f"{definitions.prefix.upper()}_{verdict.name}" for verdict in Verdict}
    is_first = names[:1] == [f"{definitions.prefix.upper()}_{Verdict.NOT_STARTED.name}"]
    if not is_first or set(names) != right or len(names) != len(declared) or len(names) != len(right):
        raise NotUnderstoodError("the verdicts are not those that there are")


_CATCH_UP = While(Apply(">", (Variable("time"), Attribute("due"))), (Do("expire", ()),))
"""The clock steps that are due."""


@dataclass(frozen=True, slots=True)
class _First:
    """How a property begins with the session: what comes before the step, and the step."""

    before: Block
    taken: Taken


@dataclass(frozen=True)
class WrittenInC:
    """What is the monitor of a property in files of C: the functions whose names begin with `name`."""

    judged: Judged
    definitions: Definitions
    judging: Judging
    samples: Samples
    name: str

    def read_back(self) -> ReadBack | Difference:
        """Compare the functions with the certified monitor."""
        try:
            with shaped():
                if not self._inputs and not self._is_timed and self._is_never_stepped():
                    return ReadBack(1)
                found = self.step_class()
            return read_back(self.judged, found, tuple(self._inputs))
        except NotUnderstoodError as error:
            return Difference(str(error))

    @cached_property
    def _inputs(self) -> list[Given]:
        return [Given(each) for each in self.judged.specification.inputs()]

    @property
    def _is_timed(self) -> bool:
        return bool(timed_atoms(self.judged.formula))

    def _is_never_stepped(self) -> bool:
        """Whether nothing is done to a property that reads nothing, of which there is never a step."""
        is_set = self.judging.starts(self.name) or self.judging.sessions(self.name) or self.judging.holds(self.name)
        return not is_set and self.samples.pace.taken.get(self.name) is None and self._first() is None

    @cached_property
    def _functions(self) -> Functions:
        return Functions(self.definitions, Struct.of(self.definitions, f"{self.definitions.prefix}_{self.name}"))

    @cached_property
    def _readings(self) -> dict[str, Typed]:
        """What is read where a step is judged, by its text."""
        found: dict[str, Typed] = {}
        for number, given in enumerate(self._inputs):
            text, type_ = self.samples.reading(given)
            if type_ != type_of(given, self.definitions.prefix):
                raise NotUnderstoodError(f"`{text}` is of another type than its field")
            found[text] = Typed(Variable(f"input {number}"), type_)
        scope = Scope(self.definitions, {}, {}, found)
        for name, node in self.samples.values.items():
            try:
                found[f"signals->{name}"] = Typed(scope.double(node), "double")
            except NotUnderstoodError:
                continue  # of another property
        return found

    def step_class(self) -> StepClass:
        """The functions of the property in the small language. Raises NotUnderstoodError."""
        functions, name = self._functions, self.name
        dues = tuple(each for each in self.judging.starts(name) if each != "due")
        time = ("time",) if self._is_timed else ()
        step = Method((*time, *(f"input {n}" for n in range(len(self._inputs)))), self._step())
        methods = {"start": self._start(dues), "step": step} | self._hear()
        if f"{name}_expire" in self.definitions:
            methods["expire"] = functions.method(f"{name}_expire")
        todo = {f"{name}_step"} & set(self.definitions.functions) | {f"{name}_expire"} & methods.keys()
        todo = {each for key in todo for each in called(functions.body(key))}
        while todo:
            key = todo.pop()
            if key in ("start", "step", "expire"):
                raise NotUnderstoodError(f"`{key}` is no name for a function")
            methods[key] = functions.method(key)
            todo |= called(methods[key].body) - methods.keys()
        kept = functions.struct.kept(dues)
        return StepClass(name, methods, kept, dues, (), has_integers=True, hears=self._hears)

    @property
    def _is_decided(self) -> bool:
        return self.judged.monitor.verdicts[0].is_permanent

    @property
    def _hears(self) -> bool:
        """Whether ages count from messages at steps."""
        return "hear" in self._hear() and not self.judging.is_rated

    def _hear(self) -> dict[str, Method]:
        """What makes ages count from messages, given what a step is; with a rate, it is no part of that."""
        name = f"{self.name}_hear"
        if not any(isinstance(atom, Age) for atom in timed_atoms(self.judged.formula)) or self._is_decided:
            return {}
        flags = {text.removeprefix("signals->"): typed.term for text, typed in self._readings.items()}
        told = self.judging.heard(self.name)
        if len(told) != len(self._functions.given(name)) - 1 or not flags.keys() >= set(told):
            raise NotUnderstoodError(f"`{name}` is not given what it takes")
        given = (Variable("time"), *(flags[each] for each in told))
        inputs = (f"input {n}" for n in range(len(self._inputs)))
        return {name: self._functions.method(name), "hear": Method(("time", *inputs), (Do(name, given),))}

    def _start(self, dues: Sequence[str]) -> Method:
        """All is 0 but for what is said otherwise; then the session begins."""
        first: dict[str, Term] = {
            "state": Constant(0),
            "verdict": Constant(Verdict.NOT_STARTED),
            "invalid": Constant(0),
        }
        first |= self._terms(self.judging.starts(self.name), "session")
        first |= self._terms(self.judging.sessions(self.name), "session")
        body = tuple(Assign(Attribute(name), value) for name, value in first.items())
        return Method(("session",) if self._is_timed else (), body)

    def _terms(self, nodes: Mapping[str, Node], time: str) -> dict[str, Term]:
        scope = Scope(self.definitions, {"time": Typed(Variable(time), SIGNED_64)}, {}, {})
        return {name: scope.typed(node).term for name, node in nodes.items() if self._is_due_time(name)}

    def _is_due_time(self, name: str) -> bool:
        if self._functions.struct.members.get(name) != SIGNED_64 or name == "since":
            raise NotUnderstoodError(f"`{name}` of `{self.name}` is no time")
        return True

    def _step(self) -> Block:
        """What is due, then the step with what it is given."""
        found: list[Statement] = []
        if self.judging.holds(self.name):
            found.append(_CATCH_UP)
        if not self._is_timed:
            found.append(Assign(Variable("time"), TIME))
        if self._hears:
            found += self._hear()["hear"].body
        taken = self.samples.pace.taken.get(self.name)
        first = self._first()
        if taken is not None:
            before = self._before()
            if first is not None and first.before != before:
                raise NotUnderstoodError(f"`{self.name}` does not begin with the session as with a message")
        elif first is not None and not self._inputs:
            taken, before = first.taken, first.before
        else:
            raise NotUnderstoodError(f"`{self.name}` is never judged")
        found += before
        if taken.arguments is not None:
            found += self._given(taken.arguments)
            found += self._functions.body(f"{self.name}_step")
        return (*found, Return(VERDICT))

    def _given(self, arguments: Sequence[Node]) -> Iterator[Statement]:
        """The step is given what its parameters are called after."""
        scope = replace(self._scope({**self._readings, **self._constants()}), members={})
        wanted = self._functions.given(f"{self.name}_step")
        if len(wanted) != len(arguments):
            raise NotUnderstoodError(f"`{self.name}_step` is not given what it takes")
        for (parameter, type_), node in zip(wanted, arguments, strict=True):
            found = scope.typed(node)
            if found.type != type_:
                raise NotUnderstoodError(f"`{parameter}` of `{self.name}_step` is given another kind of thing")
            if (parameter == "time") != (shown(node) == "time"):
                raise NotUnderstoodError(f"`{self.name}_step` is given `{shown(node)}` for `{parameter}`")
            if parameter != "time":
                yield Assign(Variable(parameter), found.term)

    def _constants(self) -> dict[str, Typed]:
        """Signals that are computed from nothing, which stand where a step is taken as what they are."""
        found = {}
        for number, given in enumerate(self._inputs):
            value = self.samples.constant(given)
            if value is not None:
                found[value] = Typed(Variable(f"input {number}"), "double")
        return found

    def _first(self) -> _First | None:
        """How the property begins with the session; None if it does not."""
        if "first_steps" not in self.definitions:
            return None
        started = f"self->verdict == {self.definitions.prefix.upper()}_{Verdict.NOT_STARTED.name}"
        for node in self.definitions.function("first_steps", self.name).body.block_items or ():
            if isinstance(node, c_ast.If) and shown(node.cond) == started:
                return self._first_of(node)
        return None

    def _first_of(self, node: c_ast.If) -> _First:
        items = list(node.iftrue.block_items)
        places = [n for n, each in enumerate(items) if shown(each) == "self->apart++"]
        if len(places) != 1:
            raise not_understood(node)
        scope = self._scope({})
        start = If(scope.condition(node.cond), self._functions.statements(items[: places[0]], scope), ())
        match items[places[0] + 1 :]:
            case []:
                return _First((start,), Taken(None))
            case [c_ast.FuncCall(name=c_ast.ID(name=function), args=c_ast.ExprList(exprs=[first, *given]))]:
                names = [name for name, _ in self._functions.given(f"{self.name}_step")]
                right = ["time" if name == "time" else "false" for name in names]
                is_step = function == f"{self.name}_step" and shown(first) == f"&monitors->{self.name}"
                if is_step and [shown(each) for each in given] == right:
                    return _First((start,), Taken(given))
            case _:
                pass
        raise not_understood(node)

    def _scope(self, readings: Mapping[str, Typed]) -> Scope:
        time = {"time": Typed(Variable("time"), SIGNED_64)}
        return Scope(self.definitions, time, self._functions.struct.members, readings)

    def _before(self) -> Block:
        """What comes before the step: NaN is counted, and the first step sets the verdict."""
        body = list(self.definitions.function(f"{self.name}_is_due").body.block_items)
        kept = self.samples.pace.signals
        heads = {
            f"{self._functions.struct.name} * const self = &monitors->{self.name}",
            f"const {self.definitions.prefix}_{kept} * const signals = &monitors->{kept}",
        }
        while isinstance(body[0], c_ast.Decl) and " ".join(shown(body[0]).replace("*", "* ").split()) in heads:
            body.pop(0)
        body = [each for each in body if not isinstance(each, c_ast.Cast)]
        begin = next((n for n, each in enumerate(body) if shown(each) == "self->apart++"), None)
        if begin is None or shown(body[-1]).rstrip(";") != "return true":
            raise NotUnderstoodError(f"`{self.name}_is_due` does not say when a step is")
        self._check_due(body[:begin])
        scope = self._scope(self._readings)
        found = [self._of_no_step(each, scope) for each in body[begin + 1 : -1]]
        self._check_together(body[begin + 1 : -1])
        return tuple(found)

    def _of_no_step(self, node: Node, scope: Scope) -> Statement:
        """What is done where a step is none, or at the first step."""
        match node:
            case c_ast.If(iftrue=c_ast.Compound(block_items=[*inside, c_ast.Return() as last]), iffalse=None):
                if shown(last).rstrip(";") == "return false":
                    held = (_CATCH_UP,) if self._hears else ()
                    then = (*self._functions.statements(inside, scope), *held, Return(VERDICT))
                    return If(scope.condition(node.cond), then, ())
            case c_ast.If(iffalse=None):
                (found,) = self._functions.statements([node], scope)
                return found
            case _:
                pass
        raise not_understood(node)

    def _check_due(self, statements: Sequence[Node]) -> None:
        """A step is due if something that it reads is new, and all that it reads has a value."""
        news = {t for given in self._inputs if isinstance(given.read, New) for t in self.samples.news(given)}
        flags = self.samples.flags(self._inputs)
        ready = {f"signals->{flag}" for flag in flags} | self.samples.counts(self._inputs)
        triggers = {f"samples->{flag}" for flag in flags} | news
        rest = list(statements)
        if not (news and self.judging.is_rated):
            self._check_none(rest, disjuncts, triggers)
        if ready:
            self._check_none(rest, conjuncts, ready)
        if rest:
            raise not_understood(rest[0])

    def _check_none(self, rest: list[Node], parts: object, right: set[str]) -> None:
        """The next statement returns unless such parts of a condition hold."""
        match rest[:1]:
            case [
                c_ast.If(
                    cond=c_ast.UnaryOp(op="!", expr=cond),
                    iftrue=c_ast.Compound(block_items=[c_ast.Return() as last]),
                    iffalse=None,
                ) as node
            ]:
                is_right = set(parts(cond)) == right and shown(last).rstrip(";") == "return false"  # type: ignore[operator]
                if is_right:
                    rest.pop(0)
                    return
                raise NotUnderstoodError(f"`{shown(node.cond)}` is not when `{self.name}` is judged")
            case _:
                raise NotUnderstoodError(f"`{self.name}_is_due` does not say when a step is")

    def _check_together(self, statements: Sequence[Node]) -> None:
        """Where all samples come at once, and none is NaN, nothing would be done before the step."""
        asked = {
            part
            for each in statements
            if isinstance(each, c_ast.If) and isinstance(each.iftrue.block_items[-1], c_ast.Return)
            for part in disjuncts(each.cond)
        }
        first = f"self->verdict == {self.definitions.prefix.upper()}_{Verdict.NOT_STARTED.name}"
        for each in statements:
            is_none = isinstance(each, c_ast.If) and isinstance(each.iftrue.block_items[-1], c_ast.Return)
            if not is_none and not (isinstance(each, c_ast.If) and shown(each.cond) == first):
                raise not_understood(each)
        if not {part.replace("!=", "==") for part in asked} <= self.samples.pace.together:
            raise NotUnderstoodError(f"`together` does not ask what `{self.name}_is_due` does")
        flags = self.samples.flags(self._inputs)
        news = {t for given in self._inputs if isinstance(given.read, New) for t in self.samples.news(given)}
        is_new = bool(flags) or self.judging.is_rated or self.samples.pace.knows_some(news)
        if not is_new or not flags <= self.samples.pace.all_flags:
            raise NotUnderstoodError(f"`together` does not say that `{self.name}` is due")
