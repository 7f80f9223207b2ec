"""Questions about state predicates: whether some step, or every step, satisfies them."""

from __future__ import annotations

from ltlc.semantics import ltl
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.diagrams import Diagrams, of_predicate
from ltlc.semantics.ltl import Formula
from ltlc.semantics.words import Letter


def possible_letter(predicate: Formula, alphabet: Alphabet) -> Letter | None:
    """A letter that exists and satisfies `predicate`; None if there is none."""
    names = ltl.atoms(predicate)
    diagrams = Diagrams()
    levels = {name: level for level, name in enumerate(names)}
    for answers, value in diagrams.paths(of_predicate(predicate, diagrams, levels)):
        if value:
            letter = alphabet.completed({names[level]: answer for level, answer in answers.items()})
            if letter is not None:
                return letter
    return None


def is_possible(predicate: Formula, alphabet: Alphabet) -> bool:
    """Whether some step can satisfy `predicate`."""
    return possible_letter(predicate, alphabet) is not None
