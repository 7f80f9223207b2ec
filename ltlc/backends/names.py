"""Names of emitted code: identifiers made from what the author of a specification wrote."""

from __future__ import annotations

import builtins
import keyword
import re
from typing import assert_never

from ltlc.program.expressions import Held, Kept, News, Read, Recent, Slope

_AMBIGUOUS = {"l", "O", "I"}
"""Names that style guides refuse because they look like digits."""

RESERVED = frozenset({*keyword.kwlist, *keyword.softkwlist, *dir(builtins), *_AMBIGUOUS, "self", "state", "math"})


class Names:
    """Identifiers that are used once only."""

    def __init__(self, taken: frozenset[str] = frozenset()) -> None:
        self._taken = set(RESERVED | taken)

    def unique(self, wanted: str) -> str:
        """`wanted`, with a number behind it if it is taken; it is taken from now on."""
        name, count = wanted, 2
        while name in self._taken:
            name = f"{wanted}_{count}"
            count += 1
        self._taken.add(name)
        return name


def variable(text: str) -> str:
    """A lower-case identifier that recalls `text`: `robot.velocity.x` is `robot_velocity_x`."""
    words = "_".join(re.findall(r"[A-Za-z0-9]+", text))
    return words if words[:1].isalpha() else f"signal_{words}".rstrip("_")


def class_name(label: str) -> str:
    """A class name that recalls `label`: `stop_at_sign` is `StopAtSign`, `line 3.2` is `Line3_2`."""
    name = ""
    for word in re.findall(r"[A-Za-z0-9]+", label):
        between = "_" if name[-1:].isdigit() and word[0].isdigit() else ""
        name += between + word[0].upper() + word[1:]
    return name if name[:1].isalpha() else f"Property{name}"


def input_name(read: Read) -> str:
    """A lower-case identifier that recalls what is read: `@{v, -3}` is `v_3_ago`."""
    name = variable(read.signal)
    match read:
        case Held(_, 0):
            return name
        case Held(_, ago):
            return f"{name}_{ago}_ago"
        case Recent(_, ago):
            return f"{name}_last_{ago + 1}"
        case Slope():
            return f"{name}_slope"
        case Kept():
            return f"{name}_opening"
        case News():
            return f"new_{name}"
        case _:
            assert_never(read)
