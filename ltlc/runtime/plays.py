"""How a property would be broken that no guard could keep any more.

It is why a guard does not let a command through that violates nothing by itself.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ltlc.dataclass import dataclass
from ltlc.runtime.documents import json_value
from ltlc.runtime.guarding import Values
from ltlc.runtime.reports import value_text

MOST_MOVES = 3
"""So many moves of a play are said in a line."""


@dataclass(frozen=True, slots=True)
class Move:
    """Something that may happen: an `event` in words, with values of a message.

    The properties with the labels `violated` are violated by it. The fallbacks
    `in_vain` would not help after it, or before it, if it is a deadline.
    """

    event: str
    values: Values
    violated: tuple[str, ...]
    in_vain: tuple[str, ...]
    is_deadline: bool

    def text(self) -> str:
        """The event with its values."""
        values = [f"{name} = {value_text(v)}" for name, v in self.values.items()]
        return f"{self.event} with {', '.join(values)}" if values else self.event

    def vain(self) -> Iterator[str]:
        """A remark on the fallbacks that would not help, if there are any."""
        if self.in_vain:
            *most, last = [f"`{name}`" for name in self.in_vain]
            names = f"{', '.join(most)} or {last}" if most else last
            yield f"{names}{' before that' if self.is_deadline else ''} would not help"

    def document(self) -> dict[str, Any]:
        """It as JSON."""
        return {
            "event": self.event,
            "values": {name: json_value(value) for name, value in self.values.items()},
            "violated": list(self.violated),
            "in_vain": list(self.in_vain),
        }


@dataclass(frozen=True, slots=True)
class Play:
    """A shortest way to a violation, whatever a guard does."""

    moves: tuple[Move, ...]

    @property
    def labels(self) -> str:
        """Those of the properties that are violated."""
        return " and ".join(f"`{label}`" for label in self.moves[-1].violated)

    def text(self, *, whole: bool) -> str:
        """Its moves on one line; only how it ends, if it is long and not `whole`."""
        said = [
            "; ".join([move.text(), *(move.vain() if whole else ())])
            for move in self.moves
        ]
        if len(said) > MOST_MOVES and not whole:
            said = ["…", *said[-MOST_MOVES:]]
        return ", then ".join(said)

    def document(self) -> list[dict[str, Any]]:
        """Its moves as JSON."""
        return [move.document() for move in self.moves]
