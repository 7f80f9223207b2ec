"""Values that are likely to be on an edge of their type."""

from __future__ import annotations

import math
import random
import struct
from typing import Any

from ltlc.program.types import Scalar, Type

EDGES = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.3,
    0.30000001192092896,
    0.1,
    0.5,
    2.0,
    2.5,
    1e-320,
    1e300,
    math.inf,
    -math.inf,
    2.0**53,
]
WIDE = [0, 1, 5, 2**53, 2**53 + 1, 2**63 - 1, 2**62]


def drawn(type_: Type, chance: random.Random) -> Any:
    """A value of a type, likely to be on an edge."""
    if type_.is_array:
        count = chance.choice([0, 1, 2, 3])
        nan = type_.scalar in (Scalar.SINGLE, Scalar.DOUBLE) and chance.random() < 1 / 3
        found = [drawn(type_.element, chance) for _ in range(count)]
        return tuple(math.nan if nan and chance.random() < 1 / 2 else value for value in found)
    match type_.scalar:
        case Scalar.BOOL:
            return chance.random() < 1 / 2
        case Scalar.TEXT:
            return chance.choice(["a", "b", "", "ä", "ab"])
        case Scalar.SINGLE:
            value = chance.choice(EDGES)
            return struct.unpack("f", struct.pack("f", value if abs(value) < 1e38 or math.isinf(value) else 1.0))[0]
        case Scalar.DOUBLE:
            return chance.choice([*EDGES, float(2**63), float(2**64)])
        case whole:
            numbers = whole.integers
            assert numbers is not None
            pool = [*WIDE, *(-n for n in WIDE), int(numbers.least), int(numbers.most), 2, 3]
            value = chance.choice([n for n in pool if numbers.least <= n <= numbers.most])
            return value if whole.is_wide else float(value)
