"""Guards: what stands between a controller and what it commands, and the messages that a guard sends by itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field

from ltlc.base.source import Span
from ltlc.dataclass import dataclass
from ltlc.semantics.durations import UNITS, Nanoseconds
from ltlc.specification.expressions import Boolean, Number, Signal, String

LEAD: Nanoseconds = 10 * UNITS["ms"]
"""How long before a deadline a guard acts, unless the file sets `_lead_`."""

Constant = Number | Boolean | String
"""A value that does not change."""

FieldPath = tuple[str, ...]
"""The way from a message to a value in it, field by field."""


@dataclass(frozen=True, slots=True)
class Fallback:
    """`message name {path: constant, …}`, which a guard may send.

    The fields that `values` does not have are zero, false or empty; arrays of any length are empty.
    """

    name: str
    values: Mapping[FieldPath, Constant] = field(hash=False)
    span: Span = field(compare=False)


@dataclass(frozen=True, slots=True)
class Guard:
    """`guard raw to out else fallbacks`: commands come on the topic `raw`, and what is let through leaves on `out`.

    Messages on both are of the type `message`, a full name, which the text `definition` defines in the form `ros2msg`.
    Of the `fallbacks` the first that helps is sent. The signals `asked` are those declared on `raw`; in a table they
    are the columns with the commands.
    """

    raw: str
    out: str
    message: str
    fallbacks: tuple[Fallback, ...]
    span: Span = field(compare=False)
    asked: tuple[Signal, ...] = field(default=(), compare=False)
    definition: str = field(default="", compare=False)

    @property
    def text(self) -> str:
        """It as its author wrote it, on one line."""
        fallbacks = f" else {', '.join(each.name for each in self.fallbacks)}" if self.fallbacks else ""
        return f"guard {self.raw} to {self.out}{fallbacks}"
