"""What a reference stands for, in words: its kind, its unit, and the topic that it is read from."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ltlc.analysis.atom_words import signal_text
from ltlc.frontend.language.primitives import unit
from ltlc.frontend.language.signals import Landmark, Thing, Tracked
from ltlc.frontend.language.values import AgeOf, Array, Duration, Scalar, Value, expressions
from ltlc.frontend.syntax import tree as syntax
from ltlc.inputs.messages.definitions import MessageTypes
from ltlc.interfaces.editor.document import Document
from ltlc.semantics.durations import duration_text
from ltlc.specification.expressions import Bytes, Current, Each, Field, Match, Number, Parallel, PathStep, inputs
from ltlc.specification.specification import fields
from ltlc.specification.text import number_text


def described(document: Document, node: syntax.Reference) -> str | None:
    """What `node` stands for, in Markdown; None if that is unknown."""
    value = document.value(node)
    if value is None:
        return None
    lines = [f"{_kind(value)}{_unit(document, node)}", *_sources(value, document.reading.checker.types)]
    written = ".".join(w.text for w in (node.name, *node.steps) if isinstance(w, syntax.Word))
    return f"`{written}`: " + "\n\n".join(lines)


def _kind(value: Value) -> str:
    match value:
        case Duration(nanoseconds):
            return f"a duration, {duration_text(nanoseconds)}"
        case AgeOf():
            return "an age"
        case Scalar(Number(number, single)):
            return f"a number, {number_text(number, single)}"
        case Scalar(Current(signal)) if (words := signal_text(signal)) != signal.name:
            return f"{words}, a number"
        case Array() if value.noun == "an array":
            return "an array of numbers"
    return value.noun


def _unit(document: Document, node: syntax.Reference) -> str:
    """The unit of a primitive; a value from a message has the unit in which it is published."""
    steps = [step.text for step in node.steps if isinstance(step, syntax.Word)]
    found = unit(steps) if document.is_thing(node.name.text) else ""
    return f", in {found}" if found else ""


def _sources(value: Value, types: MessageTypes) -> Iterator[str]:
    """The fields of messages that `value` is read from."""
    parts = [part for expression in expressions(value) for part in inputs(expression)]
    found = dict.fromkeys(field for part in parts for _, field in fields(part.signal))
    if isinstance(value, AgeOf):
        found = dict.fromkeys(field for _, field in fields(value.signal))
    siblings: dict[Field, list[PathStep]] = {}
    for field in found:
        if not field.path:
            yield f"Arrives on `{field.topic}`: `{_path(field)}`, without a value"
            continue
        siblings.setdefault(replace(field, path=field.path[:-1]), []).append(field.path[-1])
    for parent, last in siblings.items():
        whole = parent if len(last) > 1 else replace(parent, path=(*parent.path, *last))
        type_ = types.along(whole.message, whole.path)[-1]
        yield f"Read from `{whole.topic}`: `{_path(whole)}`, {type_}"


def _path(field: Field) -> str:
    """The path of `field` as a declaration has it, as far as it can be declared."""
    text = field.message.replace("/msg/", "/")
    for step in field.path:
        match step:
            case Each():
                text += "[]"
            case int():
                text += f"[{step}]"
            case Match(key, value):
                text += f"[{key} is {value}]"
            case Parallel(names, value):
                text += f"[{names} is {value}]"
            case Bytes():
                pass
            case _:
                text += f".{step}"
    return text


def thing_described(document: Document, name: str) -> str:
    """What the object or the model `name` is, in Markdown."""
    names = document.reading.checker.names
    lines = [f"`{name}`: {_truth(names.objects.get(name), name in names.undeclared, document, name)}"]
    for attribute, found in names.models.get(name, {}).items():
        sources = " ".join(_sources(found.value, document.reading.checker.types)) if found.value else ""
        lines.append(f"- believes `{attribute}`: {sources}".rstrip(": "))
    return "\n\n".join(lines[:1] + ["\n".join(lines[1:])] * (len(lines) > 1))


def _truth(thing: Thing | None, is_undeclared: bool, document: Document, name: str) -> str:
    match thing:
        case Landmark(_, (x, y, z)):
            return f"an object at ({number_text(x)}, {number_text(y)}, {number_text(z)}), m"
        case Tracked(_, topic, message):
            return f"an object, its ground truth on `{topic}`, {message}"
        case _:
            pass
    if not is_undeclared:
        return "a model, what the robot believes about itself"
    simulator = document.reading.checker.names.simulator
    topic = simulator.topic.replace("{name}", name)
    return f"an undeclared object: by `_simulator_`, its ground truth is on `{topic}`, {simulator.message}"
