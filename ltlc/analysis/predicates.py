"""Questions about state predicates: whether some step, or every step, satisfies them."""

from __future__ import annotations

from ltlc.analysis.search import completed
from ltlc.semantics import ltl
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.diagrams import Diagram, Diagrams
from ltlc.semantics.ltl import And, Atom, Formula, Not, Or, Truth
from ltlc.semantics.words import Letter


def possible_letter(predicate: Formula, alphabet: Alphabet) -> Letter | None:
    """A letter that exists and satisfies `predicate`; None if there is none."""
    names = ltl.atoms(predicate)
    diagrams = Diagrams()
    levels = {name: level for level, name in enumerate(names)}
    restricted = alphabet.restricted_to(names)
    for answers, value in diagrams.paths(diagram(predicate, diagrams, levels)):
        if value:
            letter = completed(restricted, {names[level]: answer for level, answer in answers.items()})
            if letter is not None:
                return letter
    return None


def is_possible(predicate: Formula, alphabet: Alphabet) -> bool:
    """Whether some step can satisfy `predicate`."""
    return possible_letter(predicate, alphabet) is not None


def diagram(predicate: Formula, diagrams: Diagrams, levels: dict[str, int]) -> Diagram:
    """`predicate` as a decision diagram; `levels` says which level asks which atom."""
    match predicate:
        case Truth():
            return diagrams.true
        case Atom(name):
            return diagrams.variable(levels[name])
        case Not(operand):
            return diagrams.negation(diagram(operand, diagrams, levels))
        case And(left, right):
            return diagrams.conjunction(diagram(left, diagrams, levels), diagram(right, diagrams, levels))
        case Or(left, right):
            return diagrams.disjunction(diagram(left, diagrams, levels), diagram(right, diagrams, levels))
    raise TypeError(f"not a state predicate: {predicate!r}")
