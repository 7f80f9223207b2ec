"""Keeps the last seconds of topics, and writes them when a property is violated."""

from __future__ import annotations

import os
from collections import Counter, deque
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from rclpy.node import Node

from ltlc.backends.ros2.node.clock import RosTime
from ltlc.backends.ros2.node.definitions import definition_text, quality_text
from ltlc.backends.ros2.node.files import UnusableError
from ltlc.backends.ros2.node.intake import Listener
from ltlc.backends.ros2.node.options import CutOptions
from ltlc.backends.ros2.node.topics import Topic
from ltlc.runtime.mcap import McapFile, metadata
from ltlc.runtime.reports import counted, topic_names
from ltlc.runtime.sampling import Value
from ltlc.runtime.times import SECOND, seconds_text, span_text


class KeptMessage(NamedTuple):
    """A message on a topic, when it was received and sent, and its number."""

    time: int
    topic: str
    sequence: int
    sent: int
    data: bytes


class Keeper(Listener):
    """Listens to a topic of which nothing is read."""

    def _values(self, message: bytes) -> Sequence[Value] | None:
        return ()


@dataclass(frozen=True, slots=True)
class ExtractWindow:
    """What was received from `since` to `until`, around a violation at `time`."""

    label: str
    time: int
    since: int
    until: int


class Extracts:
    """The last messages on some topics, in no more than a number of bytes.

    When a property is violated, what was received from so long before to so long after
    goes to a file, each property's to its own. A thread writes it, so that nothing else
    waits for the disk. Times are those that messages are judged by.
    """

    OVERHEAD = 300
    """How many bytes a message takes beside its data, about."""
    PATIENCE = 0.1

    def __init__(
        self,
        node: Node,
        cut: CutOptions,
        clock: RosTime,
        labels: Sequence[str],
        listeners: Sequence[Listener],
        sent: Sequence[str],
    ) -> None:
        """Keep what `listeners` hear and what is `sent`, unless topics are named."""
        self.have_failed = False
        self._node, self._cut, self._clock = node, cut, clock
        self._names = dict(zip(labels, topic_names(labels), strict=True))
        self._listeners: dict[str, Listener] = {}
        self._heard = Counter[str]()
        self._messages: deque[KeptMessage] = deque()
        self._size = self._dropped = 0
        self._windows: list[ExtractWindow] = []
        self._writer = ThreadPoolExecutor(1)
        self._written: deque[tuple[str, Future[str]]] = deque()
        names = [node.resolve_topic_name(name) for name in cut.topics]
        for listener in listeners:
            if not names or listener.full_name in names:
                self._keep(listener)
        wanted = names or sent
        self._missing = [name for name in wanted if name not in self._listeners]

    def _keep(self, listener: Listener) -> None:
        self._listeners[listener.full_name] = listener
        listener.keep = partial(self._add, listener.full_name)

    def _add(self, topic: str, received: int, info: Any, data: bytes) -> None:
        """A message came in."""
        time = self._clock.now() if self._clock.is_simulated else received
        number, sent = info["publication_sequence_number"], info["source_timestamp"]
        sequence = (number or 0) & 0xFFFFFFFF
        self._messages.append(KeptMessage(time, topic, sequence, sent or time, data))
        self._heard[topic] += 1
        self._size += len(data) + self.OVERHEAD
        # What is reported late, or decided by time, may be about an earlier moment.
        since = min(
            [time - SECOND - self._cut.before, *(w.since for w in self._windows)]
        )
        while self._messages[0].time < since:
            self._drop()
        while self._size > self._cut.most:
            self._dropped = self._messages[0].time
            self._drop()

    def _drop(self) -> None:
        self._size -= len(self._messages.popleft().data) + self.OVERHEAD

    def violated(self, label: str, time: int) -> None:
        """A property was violated then: what is around that is to be written."""
        since, until = max(0, time - self._cut.before), time + self._cut.after
        self._windows.append(ExtractWindow(label, time, since, until))

    def look(self, is_due: bool) -> None:
        """Hear topics that are published by now; write what is complete.

        If it `is_due`, see whether publishers are others, which takes a while.
        """
        for name in list(self._missing):
            self._find(name)
        for name, listener in self._listeners.items():
            if isinstance(listener, Keeper) and (is_due or not self._heard[name]):
                listener.fit(self._heard[name])
        now = self._clock.surely()
        for window in [each for each in self._windows if each.until < now]:
            self._write(window)
        while self._written and self._written[0][1].done():
            self._tell(*self._written.popleft())

    def _find(self, name: str) -> None:
        """Listen to a topic, if it is published."""
        offers = self._node.get_publishers_info_by_topic(name)
        if not offers:
            return
        self._missing.remove(name)
        topic = Topic(name, min(each.topic_type for each in offers), lambda message: ())
        try:
            self._keep(Keeper(self._node, topic, lambda *message: None, self._lose))
        except UnusableError as error:
            self._node.get_logger().error(f"extracts lack {name}: {error}")
            self.have_failed = True

    def _lose(self, topic: str, count: int | None) -> None:
        number = "messages" if count is None else counted(count, "message")
        self._node.get_logger().warning(f"extracts may lack {number} on {topic}")

    def end_run(self) -> None:
        """Time does not go on: write what there is, and forget it."""
        for window in list(self._windows):
            self._write(window)
        self._messages.clear()
        self._size = self._dropped = 0

    def close(self, beat: Callable[[], None]) -> None:
        """Wait until all is written, and show all the time that the node lives."""
        while self._written:
            label, written = self._written.popleft()
            while not wait([written], self.PATIENCE).done:
                beat()
            self._tell(label, written)

    def _write(self, window: ExtractWindow) -> None:
        """Have a window written."""
        self._windows.remove(window)
        kept = [m for m in self._messages if window.since <= m.time <= window.until]
        log = self._node.get_logger()
        if window.since <= self._dropped:
            begins = kept[0].time if kept else window.until
            log.warning(
                f"cut_mb is too small: the extract of {window.label} lacks "
                f"{span_text(begins - window.since)} of what came before the violation"
            )
        for name in self._missing:
            log.warning(f"the extract of {window.label} lacks {name}: no publisher")
        topics = {
            name: (one.topic.message, quality_text(one.others()))
            for name, one in self._listeners.items()
        }
        name = f"{self._names[window.label]}_{seconds_text(window.time)}"
        work = partial(write_extract, self._cut.folder, name, topics, kept)
        self._written.append((window.label, self._writer.submit(work)))

    def _tell(self, label: str, written: Future[str]) -> None:
        try:
            self._node.get_logger().info(f"extract of {label}: {written.result()}")
        except Exception as error:  # noqa: BLE001  the monitor goes on
            self.have_failed = True
            text = f"the extract of {label} cannot be written: {error}"
            self._node.get_logger().error(text)


def write_extract(
    folder: Path,
    name: str,
    topics: Mapping[str, tuple[str, str]],
    messages: Sequence[KeptMessage],
) -> str:
    """Write a file, which others see when it is complete; what was written where.

    Of `topics` there are the types and the quality of service. What is there is not
    replaced: the next free name is taken.
    """
    folder.mkdir(parents=True, exist_ok=True)
    part = folder / f".{name}.{os.getpid()}.part"
    try:
        with part.open("wb") as file:
            mcap = McapFile(file, "ros2", "ltlc")
            types = {
                type_: n for n, type_ in enumerate({t for t, _ in topics.values()}, 1)
            }
            for type_, number in types.items():
                text = definition_text(type_).encode()
                mcap.add_schema(number, type_, "ros2msg", text)
            channels = {topic: number for number, topic in enumerate(topics, 1)}
            for topic, (type_, quality) in topics.items():
                more = metadata({"offered_qos_profiles": quality})
                mcap.add_channel(channels[topic], types[type_], topic, "cdr", more)
            for time, topic, sequence, sent, data in messages:
                mcap.add(channels[topic], sequence, time, sent, data)
            mcap.end()
        path, number = folder / f"{name}.mcap", 1
        while path.exists():
            number += 1
            path = folder / f"{name}_{number}.mcap"
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
    return f"wrote {path}, {counted(len(messages), 'message')}"
