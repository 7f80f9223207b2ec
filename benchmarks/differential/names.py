"""What a parsed specification says, by `docs/language.md`: signals, settings, properties without names and `forall`.

Only the syntax tree is ltlc's; which name means what is found out here, anew.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass, replace
from fractions import Fraction
from itertools import permutations
from typing import Any

from ltlc.base.source import Source
from ltlc.frontend.syntax import tree as s
from ltlc.frontend.syntax.parse import parse

UNITS = {"ns": 1, "us": 10**3, "ms": 10**6, "s": 10**9, "min": 60 * 10**9, "h": 3600 * 10**9}

Kind = tuple[str] | tuple[str, str]
"""What a value is; of an array, what its elements are, too."""

TYPES: Mapping[str, Kind] = {
    "Float64.data": ("float64",),
    "Float32.data": ("float32",),
    **{f"{sign}Int{bits}.data": ("integer",) for sign in ("", "U") for bits in (8, 16, 32, 64)},
    "Bool.data": ("boolean",),
    "std_msgs/Empty": ("message",),
    "MarkerArray": ("message",),
    "String.data": ("string",),
    "Vector3.x": ("float64",),
    "Vector3.y": ("float64",),
    "JoyFeedback.id": ("integer",),
    "JoyFeedback.type": ("integer",),
    "JoyFeedback.intensity": ("float32",),
    "LaserScan.ranges": ("array", "float32"),
    "Float64MultiArray.data": ("array", "float64"),
    "Int64MultiArray.data": ("array", "integer"),
    "UInt64MultiArray.data": ("array", "integer"),
    "MarkerArray.markers[].id": ("array", "integer"),
    "MarkerArray.markers[].ns": ("array", "string"),
    "MarkerArray.markers[].frame_locked": ("array", "boolean"),
}
"""The kind of each type of field that is drawn."""

PARTS = {
    "position": ("x", "y", "z"),
    "velocity": ("x", "y", "z"),
    "velocity.angular": ("x", "y", "z"),
    "orientation": ("x", "y", "z", "w"),
}
"""The numbers that an odometer gives of a thing, all in one message."""


@dataclass(frozen=True)
class Signal:
    """A value that comes with the messages of a topic; fixed ones have no topic."""

    name: str
    topic: str | None
    kind: Kind
    fixed: float = 0.0


@dataclass
class Said:
    """What a specification says."""

    signals: dict[str, Signal] = field(default_factory=dict)
    things: set[str] = field(default_factory=set)
    zones: dict[str, list[tuple[float, float]]] = field(default_factory=dict)
    properties: dict[str, s.Node] = field(default_factory=dict)
    margin: float | None = None
    rate: Fraction | None = None
    timeout: int | None = None


def said(text: str) -> Said:
    """What the text of a specification, in which there is no error, says."""
    tree, problems = parse(Source("props.txt", text))
    assert not problems, problems
    found, known = Said(), dict[str, s.Node]()
    for command in tree.commands:
        match command:
            case s.Declaration(_, name, topic, type_):
                found.signals[name.text] = Signal(name.text, _absolute(topic.text), TYPES[type_.text])
            case s.ObjectAtPlace(_, name, coordinates):
                _add_place(found, name.text, [float(number(each)) for each in coordinates])
            case s.ObjectFromTopic(_, name, topic, _):
                _add_thing(found, name.text, _absolute(topic.text), PARTS)
            case s.Model(_, name, attributes):
                for attribute in attributes:
                    parts = [part for part in PARTS if part.split(".")[0] == attribute.name.text]
                    _add_thing(found, name.text, _absolute(attribute.topic.text), parts)
            case s.Zone(_, name, corners):
                found.zones[name.text] = [(float(number(each.x)), float(number(each.y))) for each in corners]
            case s.Association(_, name, value):
                known[name.text] = put_in(value, known)
            case s.Setting(_, name, value):
                _set(found, name.text, value)
            case s.PropertyCommand(_, label, body):
                line = text.count("\n", 0, command.span.start) + 1
                called = f"line {line}" if label is None else label.text
                for suffix, each in _written_out(body):
                    found.properties[called + suffix] = put_in(each, known)
            case s.Guard() | s.Message():
                pass  # what is monitored does not depend on them
    return found


def number(node: s.Node) -> float | int:
    """The number that a literal is; an integer where it is written as one."""
    if isinstance(node, s.Minus):
        return -number(node.operand)
    assert isinstance(node, s.NumberLiteral)
    return int(node.text) if node.text.isdigit() else float(node.text)


def nanoseconds(node: s.Node) -> int:
    """The duration that is written."""
    assert isinstance(node, s.DurationLiteral), node
    exact = Fraction(node.number) * UNITS[node.unit]
    assert exact.denominator == 1
    return int(exact)


def put_in(node: Any, known: Mapping[str, s.Node]) -> Any:
    """`node` with what names stand for in their place."""
    match node:
        case s.Reference(_, name, ()) if name.text in known:
            return known[name.text]
        case tuple():
            return tuple(put_in(each, known) for each in node)
        case s.Node() if is_dataclass(node):
            inside = {f.name: put_in(getattr(node, f.name), known) for f in fields(node) if f.name != "span"}
            return replace(node, **inside)
        case _:
            return node


def _absolute(topic: str) -> str:
    return topic if topic.startswith("/") else f"/{topic}"


def _add_thing(found: Said, name: str, topic: str, parts: Sequence[str] | Mapping[str, object]) -> None:
    found.things.add(name)
    for part in parts:
        for axis in PARTS[part]:
            whole = f"{name}.{part}.{axis}"
            found.signals[whole] = Signal(whole, topic, ("float64",))


def _add_place(found: Said, name: str, at: Sequence[float]) -> None:
    found.things.add(name)
    for part, axes in PARTS.items():
        values = at if part == "position" else [0.0, 0.0, 0.0, 1.0]
        for axis, value in zip(axes, values, strict=False):
            whole = f"{name}.{part}.{axis}"
            found.signals[whole] = Signal(whole, None, ("float64",), value)


def _set(found: Said, name: str, value: s.Node) -> None:
    match name:
        case "_margin_":
            found.margin = float(number(value))
        case "_rate_":
            assert isinstance(value, s.NumberLiteral)
            found.rate = Fraction(value.text)
        case "_timeout_":
            found.timeout = nanoseconds(value) if isinstance(value, s.DurationLiteral) else int(number(value) * 10**9)
        case _:
            raise AssertionError(name)


def _written_out(body: s.Node) -> list[tuple[str, s.Node]]:
    """A property for each name, or for each order of several, with what follows its label."""
    if not isinstance(body, s.Forall):
        return [("", body)]
    found = []
    for names in permutations(body.names, len(body.variables)):
        by = {variable.text: name.text for variable, name in zip(body.variables, names, strict=True)}
        for suffix, each in _written_out(_renamed(body.body, by)):
            mine = ", ".join(name.text for name in names)
            inner = suffix[1:-1]
            found.append((f"[{mine}, {inner}]" if inner else f"[{mine}]", each))
    return found


def _renamed(node: Any, by: Mapping[str, str]) -> Any:
    """`node` with names in the place of variables, whole or in braces."""
    match node:
        case s.Word():
            text = by.get(node.text, node.text)
            for variable, name in by.items():
                text = text.replace(f"{{{variable}}}", name)
            return replace(node, text=text)
        case tuple():
            return tuple(_renamed(each, by) for each in node)
        case s.Node():
            inside = {f.name: _renamed(getattr(node, f.name), by) for f in fields(node) if f.name != "span"}
            return replace(node, **inside)
        case _:
            return node
