"""`?` in properties: the places of numbers and durations that are to be found, and what is put there.

A value stands in place of its `?` as a name does in that of a variable of `forall`: several values make as many
properties, which are distinguished by it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, replace
from enum import Enum
from typing import Any

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic, Label
from ltlc.base.source import Source, Span
from ltlc.dataclass import dataclass
from ltlc.frontend.syntax import tree as syntax
from ltlc.semantics.durations import Nanoseconds

NAME = "?"
"""How a parameter is called among the names that the variables of a property stand for."""


class Role(Enum):
    """What a parameter is the place of."""

    THRESHOLD = "threshold"
    """A side of a comparison of numbers."""
    MARGIN = "margin"
    DURATION = "duration"
    """A bound on time, or what an age is compared with."""


@dataclass(frozen=True, slots=True, eq=False)
class Parameter:
    """The one `?` of a property, at `span`: all that a `forall` stands for has its value."""

    command: syntax.PropertyCommand
    span: Span
    role: Role


def parameters(source: Source, tree: syntax.SyntaxTree) -> tuple[list[Parameter], list[Diagnostic]]:
    """The parameters of the properties of `tree`, and what is wrong with those that cannot be found."""
    found: list[Parameter] = []
    problems: list[Diagnostic] = []
    values = {c.name.text: c.value for c in tree.commands if isinstance(c, syntax.Association)}
    for command in tree.commands:
        places = list(_places(command, values))
        spans = [span for span, _ in places]
        if not places:
            continue
        (span, role), *others = places
        if not isinstance(command, syntax.PropertyCommand):
            help = "write `?` directly in the property"
            problems += [_misplaced(source, each, "only properties can contain `?`", help) for each in spans]
        elif others:
            help = "give all but one a value, mine that one, then the next"
            message = "a property can have only one `?`"
            problems.append(_misplaced(source, others[0][0], message, help, Label(span, "the first")))
        elif role is None:
            message = "`?` stands by itself: on one side of a comparison, as the margin of `==`, or as a bound on time"
            help = "move everything else to the other side, as in `a - b > ?`"
            problems.append(_misplaced(source, span, message, help))
        else:
            found.append(Parameter(command, span, role))
    return found, problems


def _misplaced(source: Source, place: Span, message: str, help: str, *labels: Label) -> Diagnostic:
    return diagnostic("LTL841", source, place, message, secondary=labels, help=help)


def _places(command: syntax.Node, values: Mapping[str, syntax.Node]) -> Iterator[tuple[Span, Role | None]]:
    """The parameters in `command`, with their roles; None for one that has none."""
    for node, _ in syntax.walk(command):
        for child in syntax.children(node):
            if isinstance(child, syntax.Parameter):
                yield child.span, _role(node, child, values)


def _role(parent: syntax.Node, node: syntax.Parameter, values: Mapping[str, syntax.Node]) -> Role | None:
    match parent:
        case syntax.Bound():
            return Role.DURATION
        case syntax.Within(_, duration) if duration is node:
            return Role.DURATION
        case syntax.Comparison(_, _, operator, _, margin) if margin is node:
            return Role.MARGIN if operator.text in ("==", "!=") else None
        case syntax.Comparison(_, left, _, right):
            return Role.DURATION if _is_age(right if left is node else left, values) else Role.THRESHOLD
        case _:
            return None


def _is_age(node: syntax.Node, values: Mapping[str, syntax.Node]) -> bool:
    """Whether `node` is an age, or a name for one; names defined in a circle are not."""
    seen: set[str] = set()
    while isinstance(node, syntax.Reference) and node.name.text in values and node.name.text not in seen:
        seen.add(node.name.text)
        node = values[node.name.text]
    return isinstance(node, syntax.Call) and node.function.text == "age"


def literal(span: Span, value: str | Nanoseconds) -> syntax.Node:
    """A number as it is written, or a duration, at `span`."""
    if isinstance(value, Nanoseconds):
        return syntax.DurationLiteral(span, str(value), "ns")
    if value.startswith("-"):
        return syntax.Minus(span, syntax.NumberLiteral(span, value[1:]))
    return syntax.NumberLiteral(span, value)


def filled(parameter: Parameter, value: str | Nanoseconds, written: str) -> syntax.PropertyCommand:
    """The property of `parameter` with `value` in its place; `written`, the text there, distinguishes copies."""
    property_ = _with(parameter.span, literal(parameter.span, value), parameter.command.property)
    return replace(parameter.command, property=property_, names={NAME: syntax.Word(parameter.span, written)})


def _with(span: Span, value: syntax.Node, node: Any) -> Any:
    """`node`, or a tuple of nodes, with `value` in place of the parameter at `span`."""
    if isinstance(node, tuple):
        return tuple(_with(span, value, each) for each in node)
    if isinstance(node, syntax.Parameter) and node.span == span:
        return value
    if not isinstance(node, syntax.Node) or isinstance(node, syntax.Word):
        return node
    return replace(
        node, **{f.name: _with(span, value, getattr(node, f.name)) for f in fields(node) if f.name != "span"}
    )


def with_copies(
    tree: syntax.SyntaxTree, copies: Mapping[Parameter, Sequence[syntax.PropertyCommand]]
) -> syntax.SyntaxTree:
    """`tree` with the `copies` of a parameter's property in its place."""
    instead = {parameter.command.span: commands for parameter, commands in copies.items()}
    commands = (each for command in tree.commands for each in instead.get(command.span, (command,)))
    return replace(tree, commands=tuple(commands))
