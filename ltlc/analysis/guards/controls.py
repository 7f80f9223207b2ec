"""Can any controller keep the properties that it has in hand? The game of a guard that may send whatever exists."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from ltlc.analysis.errors import NotDecidedError
from ltlc.base.source import Span
from ltlc.semantics.arenas import Arena, Sending
from ltlc.semantics.words import Letter
from ltlc.specification.guards import Guard

MOST_COMMANDS = 256
"""With more kinds of commands, the question is not decided."""


def controllers(topics: Iterable[str]) -> tuple[Guard, ...]:
    """What commands on `topics`, as guards that have no message of their own."""
    return tuple(Guard("", topic, "", (), Span(0, 0)) for topic in topics)


def with_any_command(arena: Arena) -> Arena:
    """`arena` where every kind of command that exists can be sent. Raises NotDecidedError.

    What has to be known of other topics to choose the numbers is left out, in favour of the controller: that none can
    keep the properties is certain, as far as letters exist.
    """
    sendings = [Sending("", out, effect) for out in arena.outs for effect in _effects(arena, out)]
    return replace(arena, fallbacks=tuple(sendings))


def _effects(arena: Arena, out: str) -> Sequence[dict[str, bool | str | None]]:
    own = [atom for atom, topics in arena.read.items() if out in topics]
    kinds = arena.alphabet.restricted_to(own)
    if kinds.count() > MOST_COMMANDS:
        raise NotDecidedError(f"there are more than {MOST_COMMANDS} kinds of messages on `{out}`")
    return [_effect(arena, own, letter) for letter in kinds.letters()]


def _effect(arena: Arena, own: Sequence[str], letter: Letter) -> dict[str, bool | str | None]:
    return {a: a in letter if a in own else None if a in arena.loose else a for a in arena.read}
