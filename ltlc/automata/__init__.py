"""From core LTL to monitors: complete deterministic Moore machines. The only package that imports Spot."""

from __future__ import annotations

from ltlc.automata.errors import SpotMissing
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Monitor

__all__ = ["SpotMissing", "translate"]


def translate(formula: Formula, alphabet: Alphabet) -> Monitor:
    """The monitor of `formula` over the letters of `alphabet`: the canonical minimal one, with the four verdicts.

    Its atoms are those of `formula`, in the order of `alphabet`. It runs in this process, without limits. Raises
    SpotMissing; ValueError if `formula` has an atom that `alphabet` lacks, or if no letter exists; RecursionError if
    it is nested too deeply.
    """
    # Here, not above: importing Spot takes 40 ms, and not every command needs it.
    from ltlc.automata import spot_translation

    return spot_translation.translate(formula, alphabet)
