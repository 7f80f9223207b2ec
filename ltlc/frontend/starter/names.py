"""What signals and labels of a specification to start with are called."""

from __future__ import annotations

import re
from itertools import chain, count

from ltlc.frontend.syntax.lexer import (
    CONTEXTUAL,
    FOREIGN_PREFIXES,
    FOREIGN_WORDS,
    FUNCTIONS,
    KEYWORDS,
    QUANTIFIERS,
    RESERVED,
)
from ltlc.semantics.durations import UNITS

_WORDS = frozenset(
    [*KEYWORDS, *CONTEXTUAL, *RESERVED, *FUNCTIONS, *QUANTIFIERS, *UNITS, *FOREIGN_WORDS, "opening"]
    + [word.lower() for word in FOREIGN_PREFIXES]
)
"""Words that names avoid."""


PX4 = "/fmu/out/"
"""What the topics of PX4 begin with: names are shorter without it."""


class Names:
    """Names of signals and labels, each given once."""

    def __init__(self, others: Names | None = None) -> None:
        self._taken: set[str] = set(others._taken) if others else set()

    def new(self, wanted: str) -> str:
        """`wanted`, or that with a number."""
        name = next(n for n in chain([wanted], (f"{wanted}_{k}" for k in count(2))) if n not in self._taken)
        self._taken.add(name)
        return name


def name_of(topic: str) -> str:
    """What signals of `topic` are called."""
    name = re.sub(r"[\W_]+", "_", topic.removeprefix(PX4)).strip("_")
    return f"topic_{name}".rstrip("_") if not name or name[0].isdigit() or name.lower() in _WORDS else name
