"""The table of cases that ties Coq and Python: properties and formulas in prefix notation, judged on every short run.

`data/evaluator_cases.txt` is the output of the evaluators extracted from Coq, made by

    python tests/cases.py 20261121 | proofs/checker/certify --table > tests/data/evaluator_cases.txt

A line is the text of a property, then for each encoding its values on all runs of up to three steps over two atoms,
then for each encoding those on all lassos with a stem of up to one step and a loop of one or two; or the same for a
formula. Values are hexadecimal digits, four to a digit.

Or it is `line`, the least value of a double, and comparisons of it with constants: the side of the constant, the
relation, the margin and the constant, doubles by their bits; then the letters that hold of some such number, a digit
for each comparison. Of a binary32 it is `singles`, and the rank of its least value; of an integer it is `integers`, and
its least and largest value.
"""

from __future__ import annotations

import math
import random
import struct
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from ltlc.semantics import ltl
from ltlc.semantics import properties as p
from ltlc.semantics.certificate_text import PROPERTY_WORDS
from ltlc.semantics.ltl import Formula
from ltlc.semantics.properties import Property
from ltlc.semantics.words import Lasso, Word

TABLE = Path(__file__).parent / "data" / "evaluator_cases.txt"
ATOMS = ("a0", "a1")
LETTERS = [frozenset(), frozenset({"a0"}), frozenset({"a1"}), frozenset({"a0", "a1"})]
"""In the order of the table: atom 0 is the lowest bit."""


def words(lengths: Iterable[int]) -> list[Word]:
    """All words of these lengths, in the order of the table."""
    return [word for length in lengths for word in _words(length)]


def _words(length: int) -> list[Word]:
    return [()] if length == 0 else [(letter, *rest) for letter in LETTERS for rest in _words(length - 1)]


RUNS = words(range(4))
LASSOS = [Lasso(stem, loop) for stem in words((0, 1)) for loop in words((1, 2))]


def digits(values: Iterable[bool]) -> str:
    """The values as the table writes them."""
    bits = "".join("1" if value else "0" for value in values)
    return "".join(f"{int(bits[k : k + 4].ljust(4, '0'), 2):x}" for k in range(0, len(bits), 4))


_SIGNS: dict[str, tuple[Callable[..., Formula], int]] = {
    "!": (ltl.Not, 1),
    "X": (ltl.Next, 1),
    "&": (ltl.And, 2),
    "|": (ltl.Or, 2),
    "U": (ltl.Until, 2),
}
_SIGN_OF: dict[Callable[..., Formula], str] = {kind: sign for sign, (kind, _) in _SIGNS.items()}
Kind = Callable[..., Property]
"""A keyword: what makes a property of its duration, its predicates and its operands."""

_WORDS: dict[str, Kind] = {word: kind for kind, word in PROPERTY_WORDS.items()}
_PREDICATES: dict[Kind, int] = {p.Now: 1, p.Throughout: 1, p.After: 1, p.Until: 1, p.AfterUntil: 2}
_BODIES: dict[Kind, int] = {p.Now: 0, p.Throughout: 0, p.And: 2, p.Or: 2, p.Implies: 2}


def read_formula(words: Iterator[str]) -> Formula:
    """A formula in prefix notation."""
    word = next(words)
    if word == "t":
        return ltl.TRUE
    if word in ATOMS:
        return ltl.Atom(word)
    kind, count = _SIGNS[word]
    return kind(*(read_formula(words) for _ in range(count)))


def read_property(words: Iterator[str]) -> Property:
    """A property in prefix notation."""
    kind = _WORDS[next(words)]
    events = [read_formula(words) for _ in range(_PREDICATES.get(kind, 0))]
    return kind(*events, *(read_property(words) for _ in range(_BODIES.get(kind, 1))))


def formula_text(formula: Formula) -> str:
    """A formula in prefix notation."""
    if isinstance(formula, ltl.Truth):
        return "t"
    if isinstance(formula, ltl.Atom):
        return formula.name
    return " ".join([_SIGN_OF[type(formula)], *map(formula_text, ltl.children(formula))])


def _predicate(chance: random.Random, depth: int) -> str:
    kind = chance.choice(["atom", "atom", "!", "&", "|", "t"]) if depth else "atom"
    if kind in "!&|":
        return " ".join([kind, *(_predicate(chance, depth - 1) for _ in range(_SIGNS[kind][1]))])
    return "t" if kind == "t" else chance.choice(ATOMS)


def _formula(chance: random.Random, depth: int) -> str:
    kind = chance.choice("!XX&|UU") if depth else "atom"
    if kind == "atom":
        return chance.choice([*ATOMS, "t"])
    return " ".join(
        [kind, *(_formula(chance, depth - 1 - chance.randrange(2) * (depth > 1)) for _ in range(_SIGNS[kind][1]))]
    )


def _property(chance: random.Random, depth: int) -> str:
    leaves, timed = ["now", "throughout"], "within"
    word = chance.choice([w for w in _WORDS if w not in (*leaves, timed)] if depth else leaves)
    kind = _WORDS[word]
    events = [_predicate(chance, 2) for _ in range(_PREDICATES.get(kind, 0))]
    bodies = [_property(chance, depth - 1) for _ in range(_BODIES.get(kind, 1))]
    return " ".join([word, *events, *bodies])


_NUMBERS = [0.0, -0.0, 1.0, -1.0, 0.1, 0.3, 5e-324, 2.0**53, 2.0**53 + 2, sys.float_info.max, math.inf, -math.inf]
SINGLE_INFINITE = 255 * 2**23
"""The rank of the infinite binary32."""

_MARGINS = [0.0, 0.0, 0.1, 0.5, 1e-9, 5e-324, 2.0, 1e308, sys.float_info.max]


def double_bits(value: float) -> str:
    """The bits of a double, as the table writes them."""
    return struct.pack(">d", value).hex()


def double(bits: str) -> float:
    """The double of these bits."""
    (value,) = struct.unpack(">d", bytes.fromhex(bits))
    return float(value)


def _comparison(chance: random.Random) -> str:
    relation = chance.choice(["<", "<=", "==", ">=", ">"])
    margin = chance.choice(_MARGINS) * (1 if relation == "==" else chance.choice([1, -1]))
    constant = chance.choice([*_NUMBERS, chance.uniform(-3, 3), _any_double(chance)])
    return f"{chance.choice(['left', 'right'])} {relation} {double_bits(margin)} {double_bits(constant)}"


def _any_double(chance: random.Random) -> float:
    return math.ldexp(chance.uniform(-1, 1), chance.randint(-1080, 1024))


def _line(chance: random.Random) -> str:
    least = chance.choice([0.0, -math.inf])
    return " ".join(["line", double_bits(least), *(_comparison(chance) for _ in range(chance.randint(1, 5)))])


def _typed_line(chance: random.Random) -> str:
    bits, signed = chance.choice([8, 16, 32]), chance.random() < 1 / 2
    least, most = (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) if signed else (0, 2**bits - 1)
    types = [f"singles {-SINGLE_INFINITE}", "singles 0", f"integers {least} {most}", "integers -3 4"]
    return " ".join([chance.choice(types), *(_comparison(chance) for _ in range(chance.randint(1, 3)))])


def draw(seed: int) -> Iterator[str]:
    """The properties and formulas of the table."""
    chance = random.Random(seed)
    yield from dict.fromkeys(_property(chance, chance.choice([1, 1, 2, 2, 3])) for _ in range(330))
    yield from dict.fromkeys(f"formula {_formula(chance, chance.randint(1, 4))}" for _ in range(300))
    yield from dict.fromkeys(_line(chance) for _ in range(400))
    yield from dict.fromkeys(_typed_line(chance) for _ in range(150))


if __name__ == "__main__":
    print("\n".join(draw(int(sys.argv[1]))))
