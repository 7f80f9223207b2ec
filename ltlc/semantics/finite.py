"""The LTLf reference interpreter: core LTL on finite words. Coq: `holds` in `proofs/Ltl.v`."""

from __future__ import annotations

from typing import assert_never

from ltlc.semantics.ltl import And, Atom, Formula, Next, Not, Or, Truth, Until
from ltlc.semantics.words import Word


def holds(formula: Formula, word: Word) -> bool:
    """Whether the finite `word`, possibly empty, satisfies `formula` (LTLf; De Giacomo and Vardi 2013)."""
    match formula:
        case Truth():
            return True
        case Atom(name):
            return bool(word) and name in word[0]
        case Not(operand):
            return not holds(operand, word)
        case And(left, right):
            return holds(left, word) and holds(right, word)
        case Or(left, right):
            return holds(left, word) or holds(right, word)
        case Next(operand):
            return len(word) > 1 and holds(operand, word[1:])
        case Until(left, right):
            return any(
                holds(right, word[k:]) and all(holds(left, word[i:]) for i in range(k)) for k in range(len(word))
            )
        case _:
            assert_never(formula)
