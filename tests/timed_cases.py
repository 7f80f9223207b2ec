"""The table of timed cases that ties Coq and Python: properties with bounds and the past, judged on short observations.

`data/timed_cases.txt` is the output of the evaluators extracted from Coq, made by

    python tests/timed_cases.py 20261121 | proofs/checker/certify --table > tests/data/timed_cases.txt

A line is `timed` or `news`, the text of a property, and its values on all `OBSERVATIONS`, as digits. The session begins
at 0, with the first step. After `news`, the atom a1 is news: held letters do not have it.
"""

from __future__ import annotations

import itertools
import random
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from cases import LETTERS, Kind

from ltlc.semantics import ltl
from ltlc.semantics import properties as p
from ltlc.semantics.certificate_text import PROPERTY_WORDS
from ltlc.semantics.instants import Step
from ltlc.semantics.ltl import Atom, Formula
from ltlc.semantics.properties import Property
from ltlc.semantics.timed_atoms import Age, Historically, News, Once, Previously, Since

TABLE = Path(__file__).parent / "data" / "timed_cases.txt"
NEWS = News("a1")


def _observations(length: int, gaps: Sequence[int], tails: Sequence[int]) -> Iterator[tuple[tuple[Step, ...], int]]:
    for letters in itertools.product(LETTERS, repeat=length):
        for between in itertools.product(gaps, repeat=length - 1):
            times = list(itertools.accumulate(between, initial=0))
            for tail in tails:
                yield tuple(map(Step, times, letters)), times[-1] + tail


OBSERVATIONS: list[tuple[tuple[Step, ...], int]] = [
    *_observations(1, (), (0, 3)),
    *_observations(2, (0, 1, 3), (0, 2)),
    *_observations(3, (0, 2), (2,)),
]
"""Steps and the time up to which they have been looked at, in the order of the table."""

_KINDS: dict[str, Kind] = {word: kind for kind, word in PROPERTY_WORDS.items()}
_EVENTS: dict[Kind, int] = {p.Now: 1, p.Throughout: 1, p.After: 1, p.Until: 1, p.AfterUntil: 2}
_BODIES: dict[Kind, int] = {p.Now: 0, p.Throughout: 0, p.And: 2, p.Or: 2, p.Implies: 2}


class Reader:
    """Reads a property in prefix notation; `words` are what is left of it."""

    def __init__(self, text: str) -> None:
        kind, *words = text.split()
        self.words = iter(words)
        self.news = (NEWS,) if kind == "news" else ()

    def property(self) -> Property:
        word = next(self.words)
        if word == "within":
            return p.Within(int(next(self.words)), self.property())
        kind = _KINDS[word]
        events = [self.predicate() for _ in range(_EVENTS.get(kind, 0))]
        return kind(*events, *(self.property() for _ in range(_BODIES.get(kind, 1))))

    def predicate(self) -> Formula:
        match next(self.words):
            case "t":
                return ltl.TRUE
            case "!":
                return ltl.Not(self.predicate())
            case "&":
                return ltl.And(self.predicate(), self.predicate())
            case "|":
                return ltl.Or(self.predicate(), self.predicate())
            case "a1" if self.news:
                return NEWS
            case "a0" | "a1" as name:
                return Atom(name)
            case word:
                return self._past(word)

    def _past(self, word: str) -> Formula:
        bound = "-" if word == "previously" else next(self.words)
        most = None if bound == "-" else int(bound)
        operand = self.predicate()
        if word == "since":
            start = self.predicate()
            return Since(f"({operand}) since {bound} ({start})", operand, start, most)
        name = f"{word} {bound} ({operand})"
        match word:
            case "previously":
                return Previously(name, operand)
            case "once":
                return Once(name, operand, most)
            case "historically":
                return Historically(name, operand, most)
            case _:
                assert word == "age"
                assert isinstance(operand, News)
                assert most is not None
                return Age(name, operand, most)


class Drawer:
    """Draws properties in the fragment where one clock a bound is enough."""

    def __init__(self, chance: random.Random, has_news: bool) -> None:
        self.chance = chance
        self.has_news = has_news

    def predicate(self, depth: int = 2) -> str:
        past = ["previously", "once", "historically", "since", *(["age"] if self.has_news else [])]
        kind = self.chance.choice(["atom", "atom", "atom", "!", "&", "|", *past]) if depth else "atom"
        if kind == "atom":
            return self.chance.choice(["a0", "a1"])
        if kind == "age":
            return f"age {self.chance.choice('0123')} a1"
        bound = [self.chance.choice("-123")] if kind in ("once", "historically", "since") else []
        operands = (self.predicate(depth - 1) for _ in range(2 if kind in ("&", "|", "since") else 1))
        return " ".join([kind, *bound, *operands])

    def anchored(self, depth: int) -> str:
        """Of a property at the beginning of the run or of a scope."""
        choose = self.chance.choice
        if not depth:
            return f"{choose(['now', 'throughout'])} {self.predicate()}"
        inner = [self.anchored(depth - 1) for _ in range(2)]
        match choose(
            ["not", "and", "or", "implies", "after", "until", "after_until", *["within"] * 4, *["always"] * 3]
        ):
            case "not":
                return f"not {inner[0]}"
            case "and" | "or" | "implies" as word:
                return f"{word} {inner[0]} {inner[1]}"
            case "after" | "until" as word:
                return f"{word} {self.predicate()} {inner[0]}"
            case "after_until":
                return f"after_until {self.predicate()} {self.predicate()} {inner[0]}"
            case "within":
                return f"within {choose('1234')} {choose([inner[0], self._unbounded()])}"
            case _:
                return f"always {self._duties()}"

    def _unbounded(self) -> str:
        words = ["always", "never", "eventually", "always eventually", "eventually always"]
        return f"{self.chance.choice(words)} now {self.predicate()}"

    def _duties(self) -> str:
        duties = [f"within {self.chance.choice('123')} {self._goal()}" for _ in range(self.chance.choice([1, 1, 2]))]
        asked = duties[0] if len(duties) == 1 else f"and {duties[0]} {duties[1]}"
        for _ in range(self.chance.choice([0, 1, 1, 2])):
            asked = f"implies now {self.predicate(1)} {asked}"
        return asked

    def _goal(self) -> str:
        return f"{self.chance.choice(['eventually now', 'always now', 'never now', 'throughout'])} {self.predicate(1)}"


def draw(seed: int) -> Iterator[str]:
    """The properties of the table."""
    chance = random.Random(seed)
    for kind in ("timed", "news"):
        drawer = Drawer(chance, kind == "news")
        yield from dict.fromkeys(f"{kind} {drawer.anchored(chance.choice([1, 1, 2, 2, 3]))}" for _ in range(40))


if __name__ == "__main__":
    print("\n".join(draw(int(sys.argv[1]))))
