"""How recordings are read."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from ltlc.semantics.durations import Nanoseconds


class Stamp(Enum):
    """Which time a message of a bag has."""

    LOG = "log"
    """When it was recorded."""
    HEADER = "header"
    """That in its header; without a header, when it was recorded."""


@dataclass(frozen=True, slots=True)
class ReadOptions:
    """Of bags: the clock, and folders with definitions of messages that neither the bag nor ROS 2 Jazzy has.

    A reader may omit rows before `since` and after `until`, in ns; None is no limit.
    """

    stamp: Stamp = Stamp.LOG
    message_paths: tuple[str, ...] = ()
    since: Nanoseconds | None = None
    until: Nanoseconds | None = None


DEFAULT = ReadOptions()
"""All of a recording, at the times of recording."""
