"""Emitted files: which class is the monitor of which property, and what its step is given."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from ltlc.assurance.reading.comparison import read_back
from ltlc.assurance.reading.language import Apply, NotUnderstoodError, StepClass, Term
from ltlc.assurance.reading.letters import Judged
from ltlc.assurance.reading.meaning import Given
from ltlc.assurance.reading.names import recalls
from ltlc.assurance.reading.outcomes import Difference, ReadBack
from ltlc.assurance.reading.python import PythonFile
from ltlc.assurance.reading.truths import LOOSE, RAW
from ltlc.semantics.timed_atoms import Age, timed_atoms
from ltlc.semantics.trackers import trackers_of
from ltlc.specification.expressions import Current, Input, New, Past, Slope, ValueType


@dataclass(frozen=True)
class Written:
    """What is the monitor of a property in a file: the class called `name`, whose step takes `parameters`."""

    judged: Judged
    file: PythonFile
    name: str
    parameters: tuple[Term, ...]
    ages: ast.expr | None = None

    def read_back(self) -> ReadBack | Difference:
        """Compare the class with the certified monitor, and what the runtime renews of it."""
        try:
            found = self.file.step_class(self.name)
            if self.ages is not None and not _is(self.ages, _ages(self.judged, found)):
                return Difference("the ages that messages renew are not those of the property")
            return read_back(self.judged, replace(found, hears=self.ages is None), self.parameters)
        except NotUnderstoodError as error:
            return Difference(str(error))


READABLE = ("python", "ros2")
"""The targets whose text in Python is read back."""


def written(code: str, judged: Sequence[Judged]) -> Sequence[Written | Difference]:
    """What is written of each of `judged` in a file of a target that can be read back, or what is wrong with it."""
    try:
        file = PythonFile(code)
        return _of_node(file, judged) if "plan" in file.names.bound else _of_module(file, judged)
    except NotUnderstoodError as error:
        return [Difference(str(error))] * len(judged)


def _of_module(file: PythonFile, judged: Sequence[Judged]) -> list[Written]:
    """Of a file whose classes take signals by name, and whose class `Monitors` steps them all."""
    monitors = _monitors(file.names.only("Monitors"))
    if len(monitors) != len(judged):
        raise NotUnderstoodError(f"`Monitors` has {len(monitors)} monitors, not {len(judged)}")
    found, signals = [], dict[str, Term]()
    for each, (label, _, name) in zip(judged, monitors, strict=True):
        if not recalls(label, each.specification.label, [each.specification.label]):
            raise NotUnderstoodError(f"`{label}` in `Monitors` is not `{each.specification.label}`")
        wanted = tuple(dict.fromkeys(_told(i) for i in each.specification.inputs()))
        names = _signals(file, name, is_timed(each))
        if len(names) != len(wanted):
            raise NotUnderstoodError(f"the step of `{name}` takes {len(names)} signals, not {len(wanted)}")
        for parameter, given in zip(names, wanted, strict=True):
            if signals.setdefault(parameter, given) != given or not _recalls_signal(parameter, given):
                raise NotUnderstoodError(f"`{parameter}` of `{name}` does not recall its signal")
        found.append(Written(each, file, name, wanted))
    right = _monitors_text(file, judged, monitors)
    if _bare(file.names.only("Monitors")) != _bare(ast.parse(right).body[0]):
        raise NotUnderstoodError("`Monitors` does not step each monitor once, with its signals")
    return found


def is_timed(judged: Judged) -> bool:
    """Whether the monitor is given times."""
    return bool(timed_atoms(judged.formula))


def _told(wanted: Input) -> Term:
    """What a step is told of an input by a caller, who may give integers and NumPy's arrays."""
    if isinstance(wanted, New):
        return Given(wanted)
    given = Given(Current(wanted.signal))
    if wanted.signal.type.element is not None:
        return Apply(RAW, (given,))
    is_number = wanted.signal.type is ValueType.NUMBER and not given.is_wide
    return Apply(LOOSE, (given,)) if is_number else given


def _signals(file: PythonFile, name: str, timed: bool) -> list[str]:
    """The parameters of the step of a class, the time left out."""
    definition = file.names.only(name)
    steps = [f for f in getattr(definition, "body", []) if isinstance(f, ast.FunctionDef) and f.name == "step"]
    if len(steps) != 1:
        raise NotUnderstoodError(f"the class `{name}` has no step")
    return [argument.arg for argument in steps[0].args.args][2 if timed else 1 :]


def _recalls_signal(name: str, term: Term) -> bool:
    given = term.arguments[0] if isinstance(term, Apply) else term
    assert isinstance(given, Given)
    called = given.read.signal.name
    words = "_".join(re.findall(r"[A-Za-z0-9]+", f"new {called}" if isinstance(given.read, New) else called))
    return recalls(name, called, [words, f"signal_{words}", "signal"])


def _monitors(definition: ast.stmt) -> list[tuple[str, str, str]]:
    """Of each entry of the class `Monitors`: its label, the attribute of the monitor, and the class of that."""
    made: dict[str, str] = {}
    entries: list[tuple[str, str]] = []
    for node in ast.walk(definition):
        match node:
            case ast.Assign([ast.Attribute(ast.Name("self"), attribute)], ast.Call(ast.Name(name))):
                made[attribute] = name
            case ast.Dict(keys, values) if not entries:
                entries = list(_entries(keys, values))
    try:
        return [(label, attribute, made[attribute]) for label, attribute in entries]
    except KeyError as missing:
        raise NotUnderstoodError(f"`Monitors` has no {missing}") from None


def _entries(keys: Sequence[ast.expr | None], values: Sequence[ast.expr]) -> Iterator[tuple[str, str]]:
    for key, value in zip(keys, values, strict=True):
        match key, value:
            case ast.Constant(str(label)), ast.Call(ast.Attribute(ast.Attribute(ast.Name("self"), attribute), "step")):
                yield label, attribute
            case _:
                raise NotUnderstoodError("`Monitors` steps something else")


def _monitors_text(file: PythonFile, judged: Sequence[Judged], monitors: Sequence[tuple[str, str, str]]) -> str:
    """What the class `Monitors` has to say."""
    timed = [is_timed(each) for each in judged]
    names = [_signals(file, name, each) for (_, _, name), each in zip(monitors, timed, strict=True)]
    session, time = (["session"], ["time"]) if any(timed) else ([], [])
    signals = dict.fromkeys(name for each in names for name in each)
    lines = ["class Monitors:", f" def __init__({', '.join(['self', *session])}):"]
    for (_, attribute, name), each in zip(monitors, timed, strict=True):
        lines.append(f"  self.{attribute} = {name}({'session' if each else ''})")
    lines += [f" def step({', '.join(['self', *time, *signals])}):", "  return {"]
    for (label, attribute, _), each, given in zip(monitors, timed, names, strict=True):
        lines.append(f"   {label!r}: self.{attribute}.step({', '.join([*(time if each else []), *given])}),")
    lines.append("  }")
    if time:
        lines.append(" def advance(self, time):")
        for (_, attribute, _), each in zip(monitors, timed, strict=True):
            lines += [f"  while time > self.{attribute}.due:", f"   self.{attribute}.expire()"] if each else []
        answers = (f"{label!r}: self.{attribute}.verdict" for label, attribute, _ in monitors)
        lines.append(f"  return {{{', '.join(answers)}}}")
    return "\n".join(lines)


def _bare(definition: ast.stmt) -> str:
    """A class without docstrings and annotations, which do nothing."""
    copied = ast.parse(ast.unparse(definition)).body[0]
    for node in ast.walk(copied):
        match node:
            case ast.arg():
                node.annotation = None
            case (
                ast.FunctionDef(body=[ast.Expr(ast.Constant(str())), *rest])
                | ast.ClassDef(body=[ast.Expr(ast.Constant(str())), *rest])
            ):
                node.body = rest
            case _:
                pass
        if isinstance(node, ast.FunctionDef):
            node.returns = None
    return ast.dump(copied)


def _of_node(file: PythonFile, judged: Sequence[Judged]) -> list[Written]:
    """Of a file whose function `plan` says what each class is given, in the runtime's terms."""
    match file.names.only("plan"):
        case ast.FunctionDef(
            body=[ast.Expr(ast.Constant(str())), ast.Return(ast.Call(ast.Name("Plan"), [], keywords))]
        ):
            match {each.arg: each.value for each in keywords}.get("properties"):
                case ast.Tuple(elts) if len(elts) == len(judged):
                    pairs = zip(elts, judged, strict=True)
                    return [_of_property(file, node, each) for node, each in pairs]
        case _:
            pass
    raise NotUnderstoodError(f"`plan` does not make {len(judged)} properties")


def _of_property(file: PythonFile, node: ast.expr, judged: Judged) -> Written:
    label = judged.specification.label
    match node:
        case ast.Call(ast.Name("MonitoredProperty"), [], keywords):
            said = {each.arg: each.value for each in keywords}
            inputs = judged.specification.inputs()
            right = f"({''.join(f'{_input(i)}, ' for i in inputs)})"
            timed = _is(said.get("timed"), "True")
            is_right = _is(said.get("label"), repr(label)) and _is(said.get("inputs"), right)
            if is_right and timed == is_timed(judged):
                match said.get("monitor"):
                    case ast.Name(name):
                        ages = said.get("ages", ast.Tuple([], ast.Load()))
                        return Written(judged, file, name, tuple(map(Given, inputs)), ages)
                    case _:
                        pass
        case _:
            pass
    raise NotUnderstoodError(f"the property `{label}` is not given what it reads")


def _ages(judged: Judged, found: StepClass) -> str:
    """The ages of signals, the attributes with their due times, and their bounds, in the runtime's terms."""
    clocks = [tracker for tracker in trackers_of(judged.formula) if tracker.bounds]
    if judged.monitor.verdicts[0].is_permanent or len(clocks) != len(found.dues):
        return "()"
    entries = (
        f"Age({judged.specification.arrival(tracker.subject.news.name).signal.name!r}, {due!r}, {tracker.bounds[0]}), "
        for tracker, due in zip(clocks, found.dues, strict=True)
        if isinstance(tracker.subject, Age)
    )
    return f"({''.join(entries)})"


def _is(node: ast.expr | None, right: str) -> bool:
    return node is not None and ast.dump(node) == ast.dump(ast.parse(right, mode="eval").body)


def _input(wanted: Input) -> str:
    """An input in the runtime's terms."""
    name = repr(wanted.signal.name)
    match wanted:
        case Current():
            return f"Input({name})"
        case Past(_, samples):
            return f"Input({name}, {samples})"
        case Slope():
            return f"Slope({name})"
        case New():
            return f"New({name})"
