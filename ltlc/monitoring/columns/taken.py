"""What became of the slices of a property in some messages that they took, by columns and by themselves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from functools import cached_property

import numpy as np

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Places
from ltlc.monitoring.columns.alone import Place
from ltlc.monitoring.columns.bits import Mask
from ltlc.monitoring.columns.elements import Elements
from ltlc.monitoring.columns.following import Followed
from ltlc.runtime.properties import Failure
from ltlc.runtime.slice_ids import Slice

Violated = tuple[Place, int, Slice, Failure]
"""Where a slice was violated, when it began, and how."""


@dataclass(frozen=True)
class Part:
    """Those of the runs that were `followed` of which `are_taken` is true; their clocks are then due at `dues`."""

    followed: Followed
    dues: Sequence[Places]
    are_taken: Mask

    @cached_property
    def taken(self) -> Places:
        """Those of them, by place."""
        return np.flatnonzero(self.are_taken)

    @cached_property
    def going(self) -> Places:
        """Those of them that nothing decides, by place."""
        return np.flatnonzero(self.are_taken & (self.followed.groups.deciding < 0))


@dataclass
class Taken:
    """What a block has done: the `parts`, by number the messages that slices take by themselves, and what came of it.

    Something was `owed` in so many slices before it. `steps` has the number of the step that each message is, or, if it
    is none, of that after it. `opened` has the messages from which on an obligation is open.
    """

    messages: Elements
    parts: Sequence[Part]
    alone: Mapping[int, Places]
    owed: int
    steps: Places = field(default_factory=lambda: np.empty(0, np.int64))
    opened: list[Places] = field(default_factory=list)
    changes: list[tuple[Place, int]] = field(default_factory=list)
    violated: list[Violated] = field(default_factory=list)

    @property
    def is_disturbed(self) -> bool:
        """Whether some slice is decided, or takes messages by itself."""
        return bool(self.alone) or any(len(part.followed.decisions[0]) for part in self.parts)
