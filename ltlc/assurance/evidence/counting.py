"""What a property counts, as a line of evidence has it: how often, in what time, and what, by the numbers of atoms."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

from ltlc.assurance.evidence.document import StatedCount
from ltlc.semantics.ltl import And, Atom, Formula, Not, Or, Truth
from ltlc.semantics.timed_atoms import News, Occurred

_COUNT = re.compile(r"([1-9][0-9]{0,8})( within [1-9][0-9]{0,17})?( begins)?( presumed)? (.+)")


def stated_count(of: Occurred, numbers: Mapping[str, int]) -> StatedCount:
    """What is counted, where atoms have these `numbers`."""
    within = "" if of.within is None else f" within {of.within}"
    words = " ".join(_words(of.operand, numbers))
    said = f"{of.times}{within}{' begins' * of.begins}{' presumed' * of.presumed} {words}"
    return StatedCount(of.name, said)


def _words(formula: Formula, numbers: Mapping[str, int]) -> Iterator[str]:
    """A state predicate, each operator before what it is of."""
    match formula:
        case Truth():
            yield "true"
        case News(name):
            yield from ("new", f"a{numbers[name]}")
        case Atom(name):
            yield f"a{numbers[name]}"
        case Not(operand):
            yield from ("not", *_words(operand, numbers))
        case And(left, right) | Or(left, right):
            yield "and" if isinstance(formula, And) else "or"
            yield from (*_words(left, numbers), *_words(right, numbers))
        case _:
            raise TypeError(f"not a state predicate: {formula}")


def counted(stated: StatedCount, names: Sequence[str]) -> Occurred:
    """What is counted, where the atoms have these `names`. Raises ValueError if that is not said."""
    found = _COUNT.fullmatch(stated.said)
    if found is None:
        raise ValueError(f"not a count: {stated.said}")
    times, within, begins, presumed, said = found.groups()
    words = iter(said.split(" "))
    operand = _formula(words, names)
    if next(words, None) is not None:
        raise ValueError(f"not a predicate: {said}")
    duration = None if within is None else int(within.rpartition(" ")[2])
    return Occurred(stated.name, operand, int(times), duration, begins is not None, presumed is not None)


def _formula(words: Iterator[str], names: Sequence[str]) -> Formula:
    match next(words, ""):
        case "true":
            return Truth()
        case "not":
            return Not(_formula(words, names))
        case "and":
            return And(_formula(words, names), _formula(words, names))
        case "or":
            return Or(_formula(words, names), _formula(words, names))
        case "new":
            return News(_name(next(words, ""), names))
        case word:
            return Atom(_name(word, names))


def _name(word: str, names: Sequence[str]) -> str:
    found = re.fullmatch(r"a(0|[1-9][0-9]{0,5})", word)
    if found is None or int(found[1]) >= len(names):
        raise ValueError(f"no atom: {word}")
    return names[int(found[1])]
