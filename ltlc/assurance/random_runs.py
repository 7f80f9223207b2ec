"""Random runs of the cross-check, by hypothesis, which makes a counterexample small."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from hypothesis import HealthCheck, Phase, find, settings
from hypothesis import strategies as st
from hypothesis.errors import NoSuchExample

from ltlc.assurance.runs import Mismatch
from ltlc.semantics.words import Letter, Word

COUNT = 50
LONGEST = 12


def mismatch(letters: Sequence[Letter], judged: Callable[[Word], Mismatch | None]) -> Mismatch | None:
    """What `judged` finds wrong on the smallest run that hypothesis finds, the same each time; None if on none."""
    runs = st.lists(_any_of(letters), max_size=LONGEST).map(tuple)
    configuration = settings(
        max_examples=COUNT,
        derandomize=True,
        database=None,
        deadline=None,
        phases=(Phase.generate, Phase.shrink),
        suppress_health_check=list(HealthCheck),
    )
    try:
        return judged(find(runs, lambda run: judged(run) is not None, settings=configuration))
    except NoSuchExample:
        return None


def _any_of(letters: Sequence[Letter]) -> st.SearchStrategy[Letter]:
    """One of `letters`, drawn bit by bit.

    Into all that is no bit, hypothesis mixes constants that it finds in the sources of the running program: it would
    parse every module of a checkout of ltlc, for a second, and what is drawn would depend on them.
    """
    bits = st.tuples(*[st.booleans()] * (len(letters) - 1).bit_length())
    return bits.map(lambda drawn: letters[sum(bit << place for place, bit in enumerate(drawn)) % len(letters)])
