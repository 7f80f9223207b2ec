"""Whether a simulation was recorded at another pace than its own, by the first and the last message on `/clock`."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from ltlc.inputs.recordings.bags.cdr import HEADER
from ltlc.inputs.recordings.bags.compressed import unpacked
from ltlc.inputs.recordings.bags.messages import Storage
from ltlc.inputs.recordings.bags.scalars import MisfitError
from ltlc.inputs.recordings.rows import RecordingError
from ltlc.runtime.times import SECOND, span_text
from ltlc.semantics.durations import Nanoseconds

CLOCK = "/clock"
TYPE = "rosgraph_msgs/msg/Clock"
NEAR = 10 * SECOND
"""So far from the ends of a recording the first and the last time on `/clock` are looked for."""

SLACK = SECOND // 10
"""So much the two clocks may differ, or by a hundredth: messages are recorded a little late."""

_Reading = tuple[Nanoseconds, Nanoseconds]
"""When a message on `/clock` was recorded, and the time that it has."""


def other_pace(first: Storage, last: Storage, begin: Nanoseconds, end: Nanoseconds) -> str:
    """How much time passed by `/clock`, and how much by the clock of the recorder, if the two differ; else empty.

    The recording lasts from `begin` to `end`; `first` and `last` are its files at these times.
    """
    try:
        opening = min(_readings(first, begin, begin + NEAR, np.argmin), default=None)
        closing = max(_readings(last, end - NEAR, end, np.argmax), default=None)
    except (RecordingError, MisfitError, struct.error):  # what cannot be read is reported where it is judged
        return ""
    if opening is None or closing is None:
        return ""
    recorded, simulated = closing[0] - opening[0], closing[1] - opening[1]
    if abs(simulated - recorded) <= max(SLACK, recorded // 100):
        return ""
    passed = f"by `{CLOCK}` {span_text(simulated)} passed while {span_text(recorded)} were recorded"
    return f"{passed}: times are those of recording"


def _readings(
    storage: Storage, since: Nanoseconds, until: Nanoseconds, which: Callable[[NDArray[np.int64]], np.intp]
) -> Iterator[_Reading]:
    """The first or the last of each batch in these times; none of a file without an index, which is long to read.

    Raises RecordingError, MisfitError and struct.error.
    """
    topic = storage.topics.get(CLOCK)
    if topic is None or topic.type != TYPE or storage.span is None:
        return
    for batch in storage.batches([CLOCK], since, until):
        messages = batch.messages.get(CLOCK)
        if messages is not None and len(messages):
            chosen = unpacked(messages.taken(np.array([which(messages.times)])))
            yield int(chosen.times[0]), _shown(chosen.raw()[0])


def _shown(raw: memoryview) -> Nanoseconds:
    """The time in a message, which is CDR. Raises struct.error."""
    is_little = struct.unpack_from("B", raw, 1)[0] & 1
    seconds, nanoseconds = struct.unpack_from("<iI" if is_little else ">iI", raw, HEADER)
    return int(seconds) * SECOND + int(nanoseconds)
