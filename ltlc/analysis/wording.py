"""Parts of properties as text: in the language, as an author would write them, and in lists in English."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ltlc.semantics import ltl
from ltlc.semantics import properties as p
from ltlc.semantics.ltl import Formula
from ltlc.semantics.properties import Property
from ltlc.source import Source
from ltlc.specification.specification import Path, PropertySpecification, parts

_TEMPORAL, _OR, _AND, _NOT = range(4)
"""How tightly the forms of the language bind."""


def written(node: Property | Formula) -> str:
    """`node` in the language; atoms are written with their margins."""
    return _written(node, _TEMPORAL)


def _written(node: Property | Formula, context: int) -> str:
    text, strength = _form(node)
    return f"({text})" if strength < context else text


def _form(node: Property | Formula) -> tuple[str, int]:
    """The text of `node` and how tightly it binds."""
    match node:
        case p.Now(predicate) | p.Throughout(predicate):
            return _form(predicate)
        case ltl.Truth():
            return "true", _NOT
        case ltl.Atom(name):
            return name, _NOT
        case ltl.Not(ltl.Truth()):
            return "false", _NOT
        case ltl.Not(operand) | p.Not(operand):
            return f"not {_written(operand, _NOT)}", _NOT
        case ltl.And(left, right) | p.And(left, right):
            return f"{_written(left, _AND)} and {_written(right, _AND)}", _AND
        case ltl.Or(left, right) | p.Or(left, right):
            return f"{_written(left, _OR)} or {_written(right, _OR)}", _OR
        case p.Implies(left, right):
            return f"{_written(left, _OR)} implies {_written(right, _OR)}", _TEMPORAL
        case p.Always(operand) | p.Never(operand) | p.Eventually(operand):
            return f"{type(node).__name__.lower()} {_written(operand, _TEMPORAL)}", _TEMPORAL
        case p.After(event, body) | p.Until(event, body):
            return f"{type(node).__name__.lower()} {written(event)}, {written(body)}", _TEMPORAL
        case p.AfterUntil(opening, closing, body):
            return f"after_until {written(opening)}, {written(closing)}, {written(body)}", _TEMPORAL
    raise TypeError(f"not a property: {node!r}")


def part_text(source: Source, specification: PropertySpecification, path: Path) -> str:
    """The part at `path` as the author wrote it; of an association, the part written out."""
    span = specification.spans[path]
    inside = any(specification.spans.get(path[:k]) == span for k in range(len(path)))
    return written(part_at(specification.property, path)) if inside else _bare(source.excerpt(span))


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


def all_parts(node: Property | Formula, path: Path = ()) -> Iterator[tuple[Path, Property | Formula]]:
    """Every part of `node` with its path, inner parts before outer ones, those on the right first."""
    for index, part in reversed(list(enumerate(parts(node)))):
        yield from all_parts(part, (*path, index))
    yield path, node


def listed(items: Sequence[str], word: str = "and") -> str:
    """`a`, `a and b`, `a, b and c`."""
    *most, last = items
    return f"{', '.join(most)} {word} {last}" if most else last
