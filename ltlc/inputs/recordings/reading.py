"""How recordings are read."""

from __future__ import annotations

from dataclasses import field
from enum import Enum

from ltlc.dataclass import dataclass
from ltlc.runtime.times import Times, nanoseconds
from ltlc.semantics.durations import Nanoseconds


class Stamp(Enum):
    """Which time a message of a bag has."""

    LOG = "log"
    """When it was recorded."""
    HEADER = "header"
    """That in its header; without a header, when it was recorded."""


@dataclass(frozen=True, slots=True)
class Offset:
    """A time so many ns after the beginning of a recording."""

    time: Nanoseconds


Limit = Nanoseconds | Offset | None
"""A time of a recording's clock, or one that counts from its beginning; None is no limit."""


def limit(text: str) -> Limit:
    """The time in seconds that `text` is; with `+`, since the beginning. Raises ValueError."""
    time = nanoseconds(text)
    return Offset(time) if text.strip().startswith("+") else time


@dataclass(frozen=True, slots=True)
class ReadOptions:
    """Of bags: the clock, and folders with definitions of messages that neither the bag nor ROS 2 Jazzy has.

    A reader may omit rows before `since` and after `until`. Messages about it give `times` as these say. Blocks of bags
    have the messages on `kept` topics as samples, each by `kept_name`.
    """

    stamp: Stamp = Stamp.LOG
    message_paths: tuple[str, ...] = ()
    since: Limit = None
    until: Limit = None
    times: Times = Times.OFFSET
    kept: frozenset[str] = field(default=frozenset(), repr=False)

    def limits(self, beginning: Nanoseconds | None) -> tuple[Nanoseconds | None, Nanoseconds | None]:
        """`since` and `until` of a recording that begins then, as times of its clock; None also where unknown."""
        return _limit(self.since, beginning), _limit(self.until, beginning)


def _limit(limit: Limit, beginning: Nanoseconds | None) -> Nanoseconds | None:
    if isinstance(limit, Offset):
        return None if beginning is None else beginning + limit.time
    return limit


def kept_name(topic: str) -> str:
    """The name by which the messages on `topic` are samples, in CDR."""
    return f"messages on {topic}"


DEFAULT = ReadOptions()
"""All of a recording, at the times of recording."""
