"""Parts of properties as text: in the language, as an author would write them, and in lists in English."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, assert_never

from ltlc.base.source import Source
from ltlc.semantics import properties as p
from ltlc.semantics.durations import duration_text
from ltlc.semantics.ltl import Formula
from ltlc.semantics.properties import Property
from ltlc.semantics.timed_atoms import Historically, Occurred, Once, Previously, Since
from ltlc.specification import timed
from ltlc.specification.specification import Path, PropertySpecification, parts
from ltlc.specification.text import Strength, as_written, predicate_form


def written(node: Property | Formula) -> str:
    """`node` in the language; atoms are written with their margins."""
    return as_written(_written(node, Strength.TEMPORAL))


def _written(node: Property | Formula, context: Strength) -> str:
    text, strength = predicate_form(node) if isinstance(node, Formula) else _form(node)
    return f"({text})" if strength < context else text


def _form(node: Property) -> tuple[str, Strength]:
    """The text of `node` and how tightly it binds."""
    match node:
        case p.Now(predicate) | p.Throughout(predicate):
            return predicate_form(predicate)
        case p.And(p.SOME_STEP, p.Now(predicate)):
            return f"initially {_written(predicate, Strength.TEMPORAL)}", Strength.TEMPORAL
        case p.Not(operand):
            return f"not {_written(operand, Strength.NOT)}", Strength.NOT
        case p.And(left, right):
            return f"{_written(left, Strength.AND)} and {_written(right, Strength.AND)}", Strength.AND
        case p.Or(left, right):
            return f"{_written(left, Strength.OR)} or {_written(right, Strength.OR)}", Strength.OR
        case p.Implies(left, right):
            return f"{_written(left, Strength.OR)} implies {_written(right, Strength.OR)}", Strength.TEMPORAL
        case p.Always(operand) | p.Never(operand) | p.Eventually(operand):
            return f"{_keyword(node)} {_written(operand, Strength.TEMPORAL)}", Strength.TEMPORAL
        case p.Within(_, p.Always(operand) | p.Never(operand) | p.Eventually(operand)):
            preposition = "for" if isinstance(node.body, p.Always) else "within"
            bound = f"{preposition} {_time(node)}"
            return f"{_keyword(node.body)} {_written(operand, Strength.ATOM)} {bound}", Strength.NOT
        case p.Within(_, body):
            return f"within {_time(node)}, {_body(body)}", Strength.TEMPORAL
        case p.After(event, body) | p.Until(event, body):
            return f"{_keyword(node)} {written(event)}, {_body(body)}", Strength.TEMPORAL
        case p.AfterUntil(opening, closing, body):
            return f"after_until {written(opening)}, {written(closing)}, {_body(body)}", Strength.TEMPORAL
        case _:
            assert_never(node)


def _time(node: p.Within) -> str:
    """The time of a bound: how long, or from when to when."""
    end = duration_text(node.duration)
    return f"[{duration_text(node.start)}, {end}]" if node.start else end


def _keyword(node: Property) -> str:
    return type(node).__name__.lower()


def _body(node: Property) -> str:
    """What a scope judges, in which a state predicate that is read at one step is read at the first."""
    return f"initially {written(node)}" if isinstance(node, p.Now) else written(node)


def part_text(source: Source, specification: PropertySpecification, path: Path) -> str:
    """The part at `path` as the author wrote it; of an association, the part written out."""
    span = specification.spans[path]
    inside = any(specification.spans.get(path[:k]) == span for k in range(len(path)))
    return written(part_at(specification.property, path)) if inside else _bare(specification.excerpt(source, span))


def _bare(text: str) -> str:
    """`text` without parentheses around all of it."""
    depth = 0
    for number, character in enumerate(text):
        depth += {"(": 1, ")": -1}.get(character, 0)
        if depth == 0:
            return _bare(text[1:-1].strip()) if number == len(text) - 1 and text[0] == "(" else text
    return text


def part_at(node: Property | Formula, path: Path) -> Property | Formula:
    """The part of `node` at `path`."""
    for index in path:
        node = parts(node)[index]
    return node


def with_part(node: Property | Formula, path: Path, part: Property | Formula) -> Property | Formula:
    """`node` with `part` in place of the part at `path`."""
    if not path:
        return part
    inside: list[Any] = list(parts(node))
    inside[path[0]] = with_part(inside[path[0]], path[1:], part)
    return _rebuilt(node, inside)


def _rebuilt(node: Property | Formula, inside: Sequence[Any]) -> Property | Formula:
    """`node` with other parts."""
    match node:
        case p.Now(predicate) | p.Throughout(predicate):
            other: Any = _rebuilt(predicate, inside)
            return type(node)(other)
        case p.Within(duration, _, start):
            return p.Within(duration, inside[0], start)
        case Previously():
            return timed.previously(inside[0])
        case Once(_, _, duration):
            return timed.once(inside[0], duration)
        case Occurred(times=times, within=duration, presumed=presumed):
            return replace(timed.count(inside[0], times, duration), presumed=presumed)
        case Historically(_, _, duration):
            return timed.historically(inside[0], duration)
        case Since(_, _, _, duration):
            return timed.since(inside[0], inside[1], duration)
        case _:
            return type(node)(*inside)


def all_parts(node: Property | Formula, path: Path = ()) -> Iterator[tuple[Path, Property | Formula]]:
    """Every part of `node` with its path, inner parts before outer ones, those on the right first."""
    for index, part in reversed(list(enumerate(parts(node)))):
        yield from all_parts(part, (*path, index))
    yield path, node


def listed(items: Sequence[str], word: str = "and") -> str:
    """`a`, `a and b`, `a, b and c`."""
    *most, last = items
    return f"{', '.join(most)} {word} {last}" if most else last
