"""`each`: by which values a property is sliced, what the names of its slices are in it, and what begins it anew."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from typing import assert_never

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic, Label
from ltlc.base.source import Span
from ltlc.dataclass import dataclass
from ltlc.frontend.language.built import Built, Context, apply
from ltlc.frontend.language.evaluate import value
from ltlc.frontend.language.names import Checker
from ltlc.frontend.language.scopes import Scopes
from ltlc.frontend.language.signals import from_field
from ltlc.frontend.language.values import Array, Scalar, Text, Truth, Value
from ltlc.frontend.syntax import tree as syntax
from ltlc.semantics import properties
from ltlc.specification.expressions import Bytes, Current, Each, Field, New, OfSlice, Signal, ValueType
from ltlc.specification.specification import (
    Instances,
    PropertySpecification,
    Slicing,
    Specification,
    fields,
    gone_name,
    topics,
)
from ltlc.specification.wire import DOUBLES, PRIMITIVES

MOST_KEPT = 10**9
"""The largest `limit`."""


@dataclass(frozen=True, slots=True)
class Head:
    """What stands before the property in an `each`: its slices, and what names are in the property.

    `names` has the value of the variable and, where a key is an array, those of the elements of the arrays beside it,
    and whether it has the id.
    """

    slicing: Slicing
    names: Mapping[str, Value]


def head_of(checker: Checker, node: syntax.EachOf) -> Head | None:
    """The head of `node`; None if an error was reported."""
    variable = _variable(checker, node)
    keys = [_key(checker, each) for each in node.keys]
    limit = None if node.limit is None else _limit(checker, node.limit)
    known = [key for key in keys if key is not None]
    if not variable or len(known) < len(keys) or (node.limit is not None and limit is None):
        return None
    if not _are_of_different_topics(checker, node, known) or not _are_of_one_type(checker, node, known):
        return None
    keys_ = tuple(signal for _, signal in known)
    arrays = [array for key in keys_ for array in _arrays_beside(checker, key)]
    slicing = Slicing(keys_, node.variable.text, limit, tuple(arrays))
    names = {array.name: _element(array, slicing.element_of(array)) for array in arrays}
    names |= {gone_name(key.name): _gone(key) for key in keys_ if key.name in names}
    if not _stands_for_one_key(checker, node, keys_[0]):
        return None
    return Head(slicing, {**names, slicing.variable: _element(keys_[0], slicing.variable)})


def instances_of(checker: Checker, node: syntax.EachMessage) -> Instances | None:
    """What begins the property of `node` anew; None if an error was reported."""
    heard = value(checker, node.news)
    limit = None if node.limit is None else _limit(checker, node.limit)
    if heard is None or (node.limit is not None and limit is None):
        return None
    assert isinstance(heard, Truth)
    assert isinstance(heard.expression, New)
    return Instances(heard.expression.signal, limit)


def of_instance(scopes: Scopes, of: Instances, node: syntax.EachMessage, context: Context) -> Built | None:
    """The property of one instance: `after` its message; None if an error was reported."""
    mark = context.news(of.mark, node.news.span)
    body = scopes.property(node.body, context.opened(), in_scope=True)
    return body and apply(properties.After, node.span, mark, body)


@contextmanager
def inside(checker: Checker, head: Head, place: Span) -> Iterator[None]:
    """Names have the meaning that they have in the property of an `each`, whose variable stands at `place`."""
    names = checker.names
    around = names.declarations
    names.declarations = {**around, **head.names}
    names.everywhere[head.slicing.variable] = place
    try:
        yield
    finally:
        names.declarations = around
        del names.everywhere[head.slicing.variable]


def _arrays_beside(checker: Checker, key: Signal) -> Iterator[Signal]:
    """The declared arrays whose elements belong to those of `key`, which may be one of them.

    There are none if that is no array, or one of bytes that is an id as a whole.
    """
    for found in checker.names.declarations.values() if key.type.element is not None and not _is_bytes(key) else ():
        if isinstance(found, Array) and isinstance(found.expression, Current):
            signal = found.expression.signal
            of, its = key.definition, signal.definition
            if isinstance(of, Field) and isinstance(its, Field) and of.is_beside(its):
                yield signal


def _is_bytes(key: Signal) -> bool:
    """Whether a key is an array of bytes, an id as a whole."""
    is_array = isinstance(key.definition, Field) and Each() not in key.definition.path
    return is_array and key.type is ValueType.NUMBERS and key.numbers == PRIMITIVES["uint8"]


def _stands_for_one_key(checker: Checker, node: syntax.EachOf, key: Signal) -> bool:
    """Whether the variable has the ids of `key` all over the file: its signal is one."""
    known = checker.names.ids.setdefault(node.variable.text, (key, node.variable.span))
    if known[0] == key:
        return True
    message = f"`{node.variable.text}` stands for values of `{known[0].name}` in another property"
    help = "give the variable another name"
    checker.report("LTL113", node.variable.span, message, Label(known[1], "there"), help=help)
    return False


def _gone(key: Signal) -> Value:
    """Whether the id of the slice was missing in the last message on the topic of `key`."""
    assert isinstance(key.definition, Field)
    path = (*key.definition.path, OfSlice(is_missing=True))
    return from_field(gone_name(key.name), "boolean", replace(key.definition, path=path, numbers=DOUBLES))


def _element(signal: Signal, name: str) -> Value:
    """The value called `name` that a slice has of `signal`: itself, or an element of it."""
    field = signal.definition
    assert isinstance(field, Field)
    if signal.type.element is not None and not _is_bytes(signal):
        within = tuple(OfSlice() if step == Each() else step for step in field.path)
        field = replace(field, path=within if within != field.path else (*within, OfSlice()))
    return from_field(name, _type_of_id(signal).value, field)


def speaks_of_its_ids(checker: Checker, node: syntax.EachOf, found: PropertySpecification) -> bool:
    """Whether the slices of a property differ in something that it reads; else that is reported."""
    assert isinstance(found.slicing, Slicing)
    variable = found.slicing.variable
    if any(i.signal.name == variable and not isinstance(i, Current) for i in found.inputs()):
        message = f"`{variable}` is an id: it never changes and has no messages of its own"
        checker.report(
            "LTL113",
            node.body.span,
            message,
            help=f"use `new`, `age` and history with `{checker.written(node.keys[0])}`",
        )
        return False
    if not found.slicing.topics.isdisjoint(topics(found)):
        return True
    named = " and ".join(f"`{topic}`" for topic in sorted(found.slicing.topics))
    message = f"the property uses neither `{node.variable.text}` nor a value or news from {named}"
    checker.report(
        "LTL113", node.body.span, message, help=f"use `{node.variable.text}` in the property, or omit `each`"
    )
    return False


def refusals(specification: Specification, doing: str) -> list[Diagnostic]:
    """Why nothing is done with properties of each id or message where `doing` so, as `mined`, knows whole runs only."""
    return [
        diagnostic(
            "LTL711",
            specification.source,
            each.span,
            f"{reason}; such properties cannot be {doing} yet",
            help=f"`ltlc run` and `ltlc.monitor` judge it{_FOR_IDS if isinstance(each.slicing, Slicing) else ''}",
        )
        for each in specification.properties
        if (reason := _is_for_rows_only(each))
    ]


_FOR_IDS = "; for known names, use `forall`"


def _is_for_rows_only(of: PropertySpecification) -> str:
    """What in a property can only be judged in recordings, not live; empty if there is nothing."""
    match of.slicing:
        case Slicing(_, variable):
            return f"`{of.label}` is judged for each `{variable}`"
        case Instances(signal):
            return f"`{of.label}` is judged for each message of `{signal.name}`"
        case None:
            pass
        case _:
            assert_never(of.slicing)
    reads = (field for signal in of.signals() for _, field in fields(signal))
    return f"`{of.label}` reads bytes as an id" if any(Bytes() in field.path for field in reads) else ""


def _variable(checker: Checker, node: syntax.EachOf) -> bool:
    """Whether the variable of `node` can be one; else that is reported."""
    place = checker.names.everywhere.get(node.variable.text)
    if place is None:
        return True
    message = f"`{node.variable.text}` has another meaning in this file"
    help = "give the variable another name"
    checker.report("LTL113", node.variable.span, message, Label(place, "here"), help=help)
    return False


Key = tuple[Scalar | Truth | Text | Array, Signal]
"""A value that is an id, or an array of them, and the signal that has it."""


def _key(checker: Checker, node: syntax.Node) -> Key | None:
    found = value(checker, node)
    if found is None:
        return None
    if isinstance(found, Scalar | Truth | Text | Array) and isinstance(found.expression, Current):
        signal = found.expression.signal
        if isinstance(signal.definition, Field):
            return found, signal
    message = f"`{checker.written(node)}` is {found.noun}, not a field of a message that could be an id"
    checker.report("LTL113", node.span, message, help="an id is a number, a string or a boolean declared with `decl`")
    return None


def _type_of_id(key: Signal) -> ValueType:
    return ValueType.STRING if _is_bytes(key) else key.type.element or key.type


def _limit(checker: Checker, node: syntax.NumberLiteral) -> int | None:
    if node.text.isdigit() and 0 < int(node.text) <= MOST_KEPT:
        return int(node.text)
    message = f"`limit` is the most that are kept: a whole number from 1 to {MOST_KEPT:,}"
    checker.report("LTL113", node.span, message)
    return None


def _are_of_different_topics(checker: Checker, node: syntax.EachOf, keys: list[Key]) -> bool:
    first: dict[str, Span] = {}
    for written, (_, signal) in zip(node.keys, keys, strict=True):
        assert isinstance(signal.definition, Field)
        topic = signal.definition.topic
        if topic in first:
            message = f"`{topic}` has two keys, but a message has one id"
            checker.report("LTL113", written.span, message, Label(first[topic], "the other key"))
            return False
        first[topic] = written.span
    return True


def _are_of_one_type(checker: Checker, node: syntax.EachOf, keys: list[Key]) -> bool:
    for written, (found, signal) in zip(node.keys, keys, strict=True):
        if _type_of_id(signal) is not _type_of_id(keys[0][1]):
            message = f"`{checker.written(written)}` is {found.noun}, and `{checker.written(node.keys[0])}` is "
            message += f"{keys[0][0].noun}: they have no id in common"
            checker.report("LTL113", written.span, message)
            return False
    return True
