"""Standalone Python monitors: one file without dependencies, a class with a method `step` for each property."""

from __future__ import annotations

from collections.abc import Sequence

from ltlc import __version__
from ltlc.backends.names import Names, class_name, variable
from ltlc.backends.python.code import bracketed, exploded, literal
from ltlc.backends.python.functions import function_texts, names_used
from ltlc.backends.python.monitors import MODULE_NAMES, TYPES, VERDICTS, MonitorClass, standalone_class, told
from ltlc.backends.spelling import NotInTargetError
from ltlc.backends.templates import template
from ltlc.backends.trees import INDENT, LINE_LENGTH, prose, wrapped
from ltlc.compiler import Compiled
from ltlc.runtime.times import NEVER
from ltlc.semantics.timed_atoms import timed_atoms
from ltlc.specification.specification import Specification

_IMPORTS = {
    "math": "import math",
    "deque": "from collections import deque",
    "Sequence": "from collections.abc import Sequence",
    "Enum": "from enum import Enum",
    "Fraction": "from fractions import Fraction",
    "eq": "from operator import eq",
    "Any": "from typing import Any",
}
"""What a name in emitted code is imported by, in the order of the import block."""


def emit(compiled: Sequence[Compiled], specification: Specification) -> str:
    """A Python module with a monitor for each of `compiled`, and a class `Monitors` that steps them all.

    Raises NotInTargetError.
    """
    if any(i.signal.when is not None for c in compiled for i in c.specification.inputs()):
        raise NotInTargetError("`@{…, when …}` or the history of a predicate: its classes store no values of signals")
    source = specification.source.name
    classes = standalone_classes(compiled, source)
    members = _members(compiled)
    code = "\n".join(c.text for c in classes)
    functions = function_texts(code)
    used = names_used("\n".join([*functions, code])) | {"Enum"}
    has_numbers = "INFINITY" in used
    return template(__name__, "template.py.jinja").render(
        source=prose(source),
        version=__version__,
        overview=[line for c in compiled for line in overview(c)],
        imports=[line for name, line in _IMPORTS.items() if name in used or (name == "math" and has_numbers)],
        has_optional=any(c.optional for c in classes),
        has_numbers=has_numbers,
        verdicts=VERDICTS,
        functions=functions,
        classes=[c.text.rstrip("\n") for c in classes],
        members=[(name, c.name, c.timed) for name, c in zip(members, classes, strict=True)],
        never=NEVER,
        is_timed=any(c.timed for c in classes),
        ages_at_ticks=specification.rate is not None and any(clock.age for c in compiled for clock in c.machine.clocks),
        step=_step(_labels(compiled), members, classes),
    )


def standalone_classes(compiled: Sequence[Compiled], source: str) -> list[MonitorClass]:
    """The classes of `compiled`; a signal has the same name in all of them, and none that of the time."""
    is_timed = any(timed_atoms(c.formula) for c in compiled)
    names = Names(MODULE_NAMES | ({"time"} if is_timed else set()))
    signals = dict.fromkeys(told(i) for c in compiled for i in c.specification.inputs())
    parameters = {signal: names.unique(variable(signal.name)) for signal in signals}
    classes = Names(MODULE_NAMES)
    return [
        standalone_class(c, classes.unique(class_name(c.specification.label)), source, parameters) for c in compiled
    ]


def overview(compiled: Compiled) -> list[str]:
    """The label and text of a property, as wide as the page."""
    text = f"{prose(compiled.specification.label)}: {prose(compiled.specification.text)}"
    first, *further = wrapped([text], LINE_LENGTH - 2)
    return [f"- {first}", *(f"  {line}" for line in further)]


def _labels(compiled: Sequence[Compiled]) -> list[str]:
    """The labels, each once: of equal ones, the second gets a number."""
    names = Names()
    return [names.unique(c.specification.label) for c in compiled]


def _members(compiled: Sequence[Compiled]) -> list[str]:
    """An attribute for each property."""
    names = Names(frozenset({"step", "advance"}))
    return [names.unique(variable(c.specification.label)) for c in compiled]


def _step(labels: Sequence[str], members: Sequence[str], classes: Sequence[MonitorClass]) -> list[str]:
    """The method of `Monitors` that steps all properties, and the one that takes clock steps."""
    signals = dict(parameter for c in classes for parameter in c.parameters)
    time = ["time: int"] if any(c.timed for c in classes) else []
    needed = {name for c in classes for name, _ in c.parameters if name not in c.optional}
    typed = (f"{n}: {TYPES[s.type]}{'' if n in needed else ' | None'}" for n, s in signals.items())
    items = ["self", *time, *typed]
    lines = bracketed(f"{INDENT}def step(", items, ") -> dict[str, Verdict]:")
    lines.append(f'{INDENT * 2}"""Judge one more step of every property."""')
    entries = [_entry(*entry) for entry in zip(labels, members, classes, strict=True)]
    lines += exploded(f"{INDENT * 2}return {{", entries, "}")
    return lines + _advance(labels, members, classes) if time else lines


def _advance(labels: Sequence[str], members: Sequence[str], classes: Sequence[MonitorClass]) -> list[str]:
    lines = [
        "",
        f"{INDENT}def advance(self, time: int) -> dict[str, Verdict]:",
        f'{INDENT * 2}"""The time is now `time`, without a step: take the clock steps up to it."""',
    ]
    for member, monitor in zip(members, classes, strict=True):
        if monitor.timed:
            lines.append(f"{INDENT * 2}while time > self.{member}.due:")
            lines.append(f"{INDENT * 3}self.{member}.expire()")
    entries = [f"{literal(label)}: self.{member}.verdict" for label, member in zip(labels, members, strict=True)]
    return lines + exploded(f"{INDENT * 2}return {{", entries, "}")


def _entry(label: str, member: str, monitor: MonitorClass) -> str:
    arguments = [*(["time"] if monitor.timed else []), *(name for name, _ in monitor.parameters)]
    lines = bracketed(f"{INDENT * 3}{literal(label)}: self.{member}.step(", arguments, ")")
    return "\n".join(line.removeprefix(INDENT * 3) for line in lines)
