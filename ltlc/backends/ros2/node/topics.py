"""The topics that a node reads and sends on, and how entries of messages are found."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from ltlc.runtime.sampling import Value


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic that is read: its name, the full name of its messages' type.

    `read` takes from a message the fields of the plan, in their order, each None where
    the message has no such entry. If names alone lead to each, so that every message
    has it, `paths` are these names.
    """

    name: str
    message: str
    read: Callable[[Any], Sequence[Value]]
    paths: tuple[tuple[str, ...], ...] = ()


@dataclass(frozen=True, slots=True)
class Fallback:
    """A message that a guard may send: values of `fields`, the rest zero or empty."""

    name: str
    fields: tuple[tuple[tuple[str, ...], Value], ...]


@dataclass(frozen=True, slots=True)
class GuardedTopic:
    """A topic `out` that a guard sends on; commands for it come on `raw`."""

    raw: str
    out: str
    fallbacks: tuple[Fallback, ...]


def entry(messages: Any, key: str, value: str) -> Any:
    """The first of `messages` whose field `key` is `value`; None if there is none."""
    return next((m for m in messages if getattr(m, key) == value), None)


def parallel(items: Any, names: Any, value: str) -> Any:
    """The one of `items` at the place that `value` has in `names`; None if none is."""
    return next((i for i, n in zip(items, names, strict=False) if n == value), None)


def item(items: Any, index: int) -> Any:
    """The item of an array at `index`; None if the array is shorter."""
    return items[index] if index < len(items) else None
