"""Emitted files of Python: which class is the monitor of which property, and what its step is given."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from ltlc.assurance.reading.differences import difference
from ltlc.assurance.reading.guards import require_guarded_topics, require_guards
from ltlc.assurance.reading.machines import machine_in
from ltlc.assurance.reading.names import recalls
from ltlc.assurance.reading.outcomes import Difference, ReadBack
from ltlc.assurance.reading.python import PythonFile, without_docstring
from ltlc.assurance.reading.signals import PYTHON, data, input_data, require_signals
from ltlc.assurance.reading.slicing import require_slicing
from ltlc.assurance.reading.trees import NotUnderstoodError
from ltlc.dataclass import dataclass
from ltlc.program.expressions import Held, News, Read, Recent, reads_of
from ltlc.program.guards import GuardProgram
from ltlc.program.machine import Excused, Machine
from ltlc.specification.specification import PropertySpecification


@dataclass(frozen=True)
class Written:
    """What is to be `machine` in a file: the class called `name`, whose step takes `given` after the time.

    `ages` are those that whoever runs it renews, by the attribute with the due time; None if it does that itself, and
    takes what its caller has.
    """

    machine: Machine
    file: PythonFile
    name: str
    given: tuple[Read, ...]
    ages: Mapping[str, tuple[str, int]] | None = None

    def read_back(self) -> ReadBack | Difference:
        """Compare the machine that the class is with the one that it has to be."""
        try:
            of = replace(self.file.step_class(self.name), ages=self.ages)
            found = machine_in(of, self.machine, self.given, PYTHON, loose=self.ages is None)
            self.file.require_slots(self.name)
        except NotUnderstoodError as error:
            return Difference(str(error))
        wrong = difference(found, self.machine)
        return ReadBack(len(found.states)) if wrong is None else Difference(wrong)


def written(
    code: str,
    machines: Sequence[Machine],
    specifications: Sequence[PropertySpecification],
    guards: Sequence[GuardProgram] = (),
) -> Sequence[Written | Difference]:
    """What is written of each of `machines` in a file of a target that can be read back, or its errors.

    `specifications` tell where the signals come from that these read; `guards` keep some of them.
    """
    try:
        file = PythonFile(code)
        if "plan" not in file.names.bound:
            return _of_module(file, machines)
        return _of_node(file, machines, specifications, guards)
    except NotUnderstoodError as error:
        return [Difference(str(error))] * len(machines)


@dataclass(frozen=True, slots=True)
class _Member:
    """A monitor in the class `Monitors`: its label and attribute, its class, whether it takes times, its arguments."""

    label: str
    attribute: str
    name: str
    is_timed: bool
    given: tuple[str, ...]


def _of_module(file: PythonFile, machines: Sequence[Machine]) -> list[Written]:
    """Of a file whose classes take signals by name, and whose class `Monitors` steps them all."""
    members = _members(file.names.only("Monitors"))
    if len(members) != len(machines):
        raise NotUnderstoodError(f"`Monitors` has {len(members)} monitors, not {len(machines)}")
    found, signals = [], dict[str, Read]()
    for machine, member in zip(machines, members, strict=True):
        if not recalls(member.label, machine.label, [machine.label]):
            raise NotUnderstoodError(f"`{member.label}` in `Monitors` is not `{machine.label}`")
        wanted = tuple(dict.fromkeys(told(read) for read in machine.inputs))
        parameters = file.step_class(member.name).methods["step"].parameters
        if parameters != member.given or len(parameters) != len(wanted) + member.is_timed:
            raise NotUnderstoodError("`Monitors` does not step each monitor once, with its signals")
        for parameter, read in zip(parameters[int(member.is_timed) :], wanted, strict=True):
            if signals.setdefault(parameter, read) != read or not _recalls_signal(parameter, read):
                raise NotUnderstoodError(f"`{parameter}` of `{member.name}` does not recall its signal")
        found.append(Written(machine, file, member.name, wanted))
    return found


def told(read: Read) -> Read:
    """What a caller passes a step of an input: the latest value, from which it keeps older ones."""
    match read:
        case Held(signal, _, type_):
            return Held(signal, 0, type_)
        case Recent(signal, _, array):
            return Held(signal, 0, array.element)
        case _:
            return read


def _recalls_signal(name: str, read: Read) -> bool:
    words = "_".join(re.findall(r"[A-Za-z0-9]+", f"new {read.signal}" if isinstance(read, News) else read.signal))
    return recalls(name, read.signal, [words, f"signal_{words}", "signal"])


def _members(definition: ast.stmt) -> list[_Member]:
    """The monitors in the class `Monitors`, if it makes and steps each of them, and does nothing else."""
    if not isinstance(definition, ast.ClassDef) or definition.bases or definition.decorator_list:
        raise NotUnderstoodError("`Monitors` contains more than its methods")
    methods = {each.name: each for each in definition.body if isinstance(each, ast.FunctionDef)}
    made = dict(map(_made, _body(methods, "__init__")))
    stepped = list(_entries(_body(methods, "step")))
    if [attribute for _, attribute, _ in stepped] != [*made]:
        raise NotUnderstoodError("`Monitors` does not step each monitor once")
    members = [_Member(label, attribute, *made[attribute], given) for label, attribute, given in stepped]
    timed = [member.attribute for member in members if member.is_timed]
    time, session = (["time"], ["session"]) if timed else ([], [])
    given = dict.fromkeys([*time, *(name for member in members for name in member.given)])
    right = {"__init__": ["self", *session], "step": ["self", *given]}
    right |= {"advance": ["self", "time"]} if timed else {}
    if {name: [each.arg for each in method.args.args] for name, method in methods.items()} != right:
        raise NotUnderstoodError("`Monitors` does not receive the inputs of its monitors")
    if timed and list(map(_caught_up, _body(methods, "advance")[:-1])) != timed:
        raise NotUnderstoodError("`Monitors` does not take the clock steps of each monitor")
    if timed and list(_verdicts(_body(methods, "advance"))) != [(label, attribute) for label, attribute, _ in stepped]:
        raise NotUnderstoodError("`Monitors` does not return the verdict of each monitor")
    return members


def _body(methods: Mapping[str, ast.FunctionDef], name: str) -> list[ast.stmt]:
    if name not in methods:
        raise NotUnderstoodError(f"`Monitors` has no `{name}`")
    return list(without_docstring(methods[name].body))


def _made(statement: ast.stmt) -> tuple[str, tuple[str, bool]]:
    """The attribute that a monitor is made for, its class, and whether it is given the session."""
    match statement:
        case ast.Assign([ast.Attribute(ast.Name("self"), attribute)], ast.Call(ast.Name(name), [], [])):
            return attribute, (name, False)
        case ast.Assign(
            [ast.Attribute(ast.Name("self"), attribute)], ast.Call(ast.Name(name), [ast.Name("session")], [])
        ):
            return attribute, (name, True)
        case _:
            raise NotUnderstoodError("`Monitors` creates something other than monitors")


def _answer(body: Sequence[ast.stmt]) -> Iterator[tuple[str, ast.expr]]:
    """The values of the dictionary that a method answers with, by their labels."""
    match body[-1:]:
        case [ast.Return(ast.Dict(keys, values))]:
            for key, value in zip(keys, values, strict=True):
                match key:
                    case ast.Constant(str(label)):
                        yield label, value
                    case _:
                        raise NotUnderstoodError("`Monitors` returns an unlabelled verdict")
        case _:
            raise NotUnderstoodError("`Monitors` does not return verdicts")


def _entries(body: Sequence[ast.stmt]) -> Iterator[tuple[str, str, tuple[str, ...]]]:
    """The labels of the monitors that are stepped, their attributes, and what their steps are given."""
    for label, value in _answer(body):
        match value:
            case ast.Call(ast.Attribute(ast.Attribute(ast.Name("self"), attribute), "step"), arguments, []) if len(
                body
            ) == 1 and all(isinstance(each, ast.Name) for each in arguments):
                yield label, attribute, tuple(each.id for each in arguments if isinstance(each, ast.Name))
            case _:
                raise NotUnderstoodError("`Monitors` does not step each monitor once, with its signals")


def _verdicts(body: Sequence[ast.stmt]) -> Iterator[tuple[str, str]]:
    for label, value in _answer(body):
        match value:
            case ast.Attribute(ast.Attribute(ast.Name("self"), attribute), "verdict"):
                yield label, attribute
            case _:
                yield label, ""


def _caught_up(statement: ast.stmt) -> str | None:
    """The attribute of the monitor whose clock steps are taken."""
    match statement:
        case ast.While(
            ast.Compare(
                ast.Name("time"), [ast.Gt()], [ast.Attribute(ast.Attribute(ast.Name("self"), attribute), "due")]
            ),
            [ast.Expr(ast.Call(ast.Attribute(ast.Attribute(ast.Name("self"), same), "expire"), [], []))],
            [],
        ) if attribute == same:
            return attribute
        case _:
            return None


def _of_node(
    file: PythonFile,
    machines: Sequence[Machine],
    specifications: Sequence[PropertySpecification],
    guards: Sequence[GuardProgram],
) -> list[Written]:
    """Of a file whose function `plan` says what each class is given, in the runtime's terms."""
    match file.names.only("plan"):
        case ast.FunctionDef(
            body=[ast.Expr(ast.Constant(str())), ast.Return(ast.Call(ast.Name("Plan"), [], keywords))]
        ):
            said = {each.arg: each.value for each in keywords}
            match said.get("properties"):
                case ast.Tuple(elts) if len(elts) == len(machines):
                    require_guards(file, said.get("guards"), guards)
                    require_guarded_topics(file, guards)
                    require_signals(file, said.get("signals"), (s for each in specifications for s in each.signals()))
                    return [_of_property(file, *each) for each in zip(elts, machines, specifications, strict=True)]
        case _:
            pass
    raise NotUnderstoodError(f"`plan` does not make {len(machines)} properties")


def _of_property(file: PythonFile, node: ast.expr, machine: Machine, specification: PropertySpecification) -> Written:
    """Raise NotUnderstoodError unless what the runtime gets for a property is as in its machine."""
    match node:
        case ast.Call(ast.Name("MonitoredProperty"), [], keywords):
            said = {each.arg or "": each.value for each in keywords}
        case _:
            raise NotUnderstoodError(f"`{machine.label}` is not a property in `plan`")
    match said.get("monitor"):
        case ast.Name(name):
            of = file.step_class(name)
        case _:
            raise NotUnderstoodError(f"`{machine.label}` has no monitor")
    found = {key: data(said[key]) for key in _SAID if key in said}
    is_timed = "expire" in of.methods
    right: dict[str, Any] = {
        "label": machine.label,
        "line": machine.line,
        "text": machine.text,
        "inputs": tuple(map(input_data, machine.inputs)),
    }
    right |= {"timed": True} if is_timed else {}
    if not machine.waits_for:
        right["from_session"] = True
    if machine.excused:
        right["excused"] = tuple(_excused_data(machine, each) for each in machine.excused)
    if specification.requirement:
        right["requirement"] = specification.requirement.document()
    ages, kept = found.pop("ages", ()), found.pop("kept", ())
    if found != right or tuple(map(_last, kept)) != of.kept:
        raise NotUnderstoodError(f"the property `{machine.label}` does not receive what it reads")
    require_slicing(file, said.get("slicing"), machine, specification)
    return Written(machine, file, name, machine.inputs, dict(map(_age, ages)))


_SAID = ("label", "line", "text", "inputs", "timed", "from_session", "excused", "ages", "kept", "requirement")
"""What `plan` says of a property and its machine or class does, too."""


def _excused_data(machine: Machine, excused: Excused) -> tuple[Any, ...]:
    """An input that is not waited for in the runtime's terms."""
    place, *news = map(machine.inputs.index, (excused.input, *excused.news))
    reading = tuple(n for n, atom in enumerate(machine.atoms) if news and excused.input in reads_of(atom))
    return "Excused", place, tuple(news), excused.instead, *([reading] if reading else [])


def _age(data: Any) -> tuple[str, tuple[str, int]]:
    match data:
        case ("Age", str(signal), str(due), int(duration)):
            return due, (signal, duration)
        case _:
            raise NotUnderstoodError(f"`{data}` is not an age")


def _last(data: Any) -> str | None:
    """The attribute that keeps a value at an opening."""
    match data:
        case ("Kept", str(), str(name)):
            return name
        case _:
            return None
