"""Random runs of the cross-check; hypothesis makes a counterexample small."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence

from ltlc.assurance.runs import Mismatch
from ltlc.semantics.words import Letter, Word

COUNT = 50
LONGEST = 12


def mismatch(letters: Sequence[Letter], judged: Callable[[Word], Mismatch | None]) -> Mismatch | None:
    """What `judged` finds wrong on one of some random runs, the same each time; None if on none."""
    chance = random.Random(0)
    drawn = (tuple(chance.choices(letters, k=chance.randint(0, LONGEST))) for _ in range(COUNT))
    found = next((wrong for run in drawn if (wrong := judged(run))), None)
    return found and (_smallest(letters, judged) or found)


def _smallest(letters: Sequence[Letter], judged: Callable[[Word], Mismatch | None]) -> Mismatch | None:
    """What `judged` finds wrong on the smallest run that hypothesis finds; None if it finds none."""
    # Here, since a property is judged in less time than it takes to import hypothesis.
    from hypothesis import HealthCheck, Phase, find, settings
    from hypothesis import strategies as st
    from hypothesis.errors import NoSuchExample

    # Drawn bit by bit: into all that is no bit, hypothesis mixes constants that it finds in the sources of the running
    # program. It would parse every module of a checkout of ltlc, for a second, and what is drawn would depend on them.
    bits = st.tuples(*[st.booleans()] * (len(letters) - 1).bit_length())
    letter = bits.map(lambda drawn: letters[sum(bit << place for place, bit in enumerate(drawn)) % len(letters)])
    runs = st.lists(letter, max_size=LONGEST).map(tuple)
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
