"""The meaning of the property language on finite words, read off `language.md` 3.1 clause by clause.

The reference for the whole compiler. Coq: `den` in `proofs/Dsl.v`.
"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.semantics import finite
from ltlc.semantics.ltl import Formula
from ltlc.semantics.properties import (
    After,
    AfterUntil,
    Always,
    And,
    Eventually,
    Implies,
    Never,
    Not,
    Now,
    Or,
    Property,
    Throughout,
    Until,
)
from ltlc.semantics.words import Word


def satisfies(word: Word, property_: Property) -> bool:
    """Whether the finite `word`, possibly empty, satisfies `property_`."""
    match property_:
        case Now(predicate):
            return finite.holds(predicate, word)
        case Throughout(predicate):
            return all(finite.holds(predicate, rest) for rest in _rests(word))
        case Not(operand):
            return not satisfies(word, operand)
        case And(left, right):
            return satisfies(word, left) and satisfies(word, right)
        case Or(left, right):
            return satisfies(word, left) or satisfies(word, right)
        case Implies(left, right):
            return satisfies(word, right) or not satisfies(word, left)
        case Always(operand):
            return all(satisfies(rest, operand) for rest in _rests(word))
        case Never(operand):
            return not any(satisfies(rest, operand) for rest in _rests(word))
        case Eventually(operand):
            return any(satisfies(rest, operand) for rest in _rests(word))
        case After(event, body):
            k = first_step(word, event)
            return k is None or satisfies(word[k:], body)
        case Until(event, body):
            k = first_step(word, event)
            return k is not None and satisfies(word[:k], body)
        case AfterUntil(opening, closing, body):
            return all(satisfies(word[k:m], body) for k, m in episodes(word, opening, closing))
    raise TypeError(f"not a property: {property_!r}")


def _rests(word: Word) -> Iterator[Word]:
    """Every non-empty u[k..) of the word u."""
    return (word[k:] for k in range(len(word)))


def first_step(word: Word, event: Formula, start: int = 0) -> int | None:
    """The first step of `word` from `start` on at which `event` holds, or None."""
    return next((k for k in range(start, len(word)) if finite.holds(event, word[k:])), None)


def episodes(word: Word, opening: Formula, closing: Formula) -> list[tuple[int, int]]:
    """The episodes of `after_until opening, closing, …` on `word`, as pairs (first step, step after the last)."""
    found = []
    position = 0
    while position < len(word):
        opens = finite.holds(opening, word[position:]) and not finite.holds(closing, word[position:])
        if not opens:
            position += 1
            continue
        end = first_step(word, closing, position + 1)
        end = len(word) if end is None else end
        found.append((position, end))
        position = end
    return found
