"""Words: finite runs as sequences of letters, and ultimately periodic ('lasso') words for infinite runs.

A letter is the set of the atoms that hold at a step; every other atom is false there.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, combinations, product

from ltlc.dataclass import dataclass

Letter = frozenset[str]
Word = tuple[Letter, ...]


@dataclass(frozen=True, slots=True)
class Lasso:
    """The infinite word that starts with `stem` and then repeats `loop`, which is not empty, forever."""

    stem: Word
    loop: Word

    def __post_init__(self) -> None:
        if not self.loop:
            raise ValueError("the loop of a lasso word must have at least one letter")


def letters_over(atoms: Sequence[str]) -> Iterator[Letter]:
    """The 2^n letters over `atoms`, one after the other, by number of atoms and then in their order."""
    return map(frozenset, chain.from_iterable(combinations(atoms, k) for k in range(len(atoms) + 1)))


def all_letters(atoms: Sequence[str]) -> list[Letter]:
    """The same as a list. For tests and small n only."""
    return list(letters_over(atoms))


def all_words(letters: Iterable[Letter], length: int) -> Iterator[Word]:
    """Every word of exactly `length` letters."""
    return product(tuple(letters), repeat=length)
