"""Scopes of a property at which values can be taken: when they are open, by definition, and which clock they start."""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.semantics.denotation import episodes, first_step
from ltlc.semantics.intervals import start_of
from ltlc.semantics.properties import After, AfterUntil, Always, Eventually, Never, Property, Until, Within, children
from ltlc.semantics.timed_atoms import (
    BEGINNING,
    AfterOpened,
    Beginning,
    Clock,
    EpisodeOpened,
    UntilScope,
)
from ltlc.semantics.words import Word


def scope_clocks(property_: Property) -> tuple[Clock | None, ...]:
    """The clocks that start where the scopes of `property_` open: that of the run, then those of the keywords.

    These are `after` and `after_until`, in the order of the text. None where a scope may be open several times at once.
    """
    return (BEGINNING, *_scope_clocks(property_, BEGINNING))


def _scope_clocks(property_: Property, clock: Clock | None) -> Iterator[Clock | None]:
    inner = clock
    match property_:
        case After(event, _):
            inner = clock and AfterOpened(clock, event)
            yield inner
        case AfterUntil(opening, closing, _):
            inner = clock and EpisodeOpened(clock, opening, closing)
            yield inner
        case Until(event, _):
            inner = clock and UntilScope(clock, event)
        case Within(_, _, start) if start:
            inner = clock and AfterOpened(clock, start_of(clock, start))
        case Always() | Never() | Eventually():
            inner = None
        case _:
            pass
    for child in children(property_):
        yield from _scope_clocks(child, inner)


def open_part(word: Word, clock: Clock) -> Word | None:
    """The part of `word` in the scope that `clock` measures and that a next step belongs to; None if none does."""
    match clock:
        case Beginning():
            return word or None
        case AfterOpened(outer, event) if (part := open_part(word, outer)) is not None:
            first = first_step(part, event)
            return None if first is None else part[first:]
        case UntilScope(outer, event) if (part := open_part(word, outer)) is not None:
            return part if first_step(part, event) is None else None
        case EpisodeOpened(outer, opening, closing) if (part := open_part(word, outer)) is not None:
            latest = episodes(part, opening, closing)[-1:]
            return next((part[start:] for start, end in latest if end == len(part)), None)
    return None
