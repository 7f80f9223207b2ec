"""Commands come in, and what the guards let through leaves, bit for bit."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import reduce
from typing import Any

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import LivelinessPolicy, QoSProfile
from rclpy.serialization import serialize_message

from ltlc.backends.ros2.node.files import UnusableError
from ltlc.backends.ros2.node.intake import Listener, message_class
from ltlc.backends.ros2.node.topics import GuardedTopic, Topic
from ltlc.backends.ros2.node.wire import message_reader
from ltlc.runtime.guard_plans import GuardPlan
from ltlc.runtime.guarding import Action, Deed, Guard, Guards, Message, Values
from ltlc.runtime.sampling import Value
from ltlc.runtime.session import Plan
from ltlc.runtime.watching import Watching

LEASE = 0.5
"""For how many seconds who listens to a guard may take it to be alive."""

UNNAMED = "_NODE_NAME_UNKNOWN_"
"""What a node is called as long as only its publisher has been found."""


class CommandListener(Listener):
    """Listens to commands: an old one is none."""

    DEPTH = 1
    TAKES_KEPT = False


class Way:
    """The way of commands from the topic `of.raw` to the topic `of.out`.

    values: what the fallbacks say, by their names
    waiting: commands that have come, with what they say, None if malformed
    bypasses: who else publishes on OUT
    """

    def __init__(self, node: Node, of: GuardedTopic, topic: Topic) -> None:
        """`topic` is that of OUT."""
        self.of = of
        self.waiting: deque[tuple[bytes, Sequence[Value] | None]] = deque()
        self.bypasses: list[str] = []
        self.count = 0
        self._node, self._latest = node, b""
        type_ = message_class(topic)
        self.listener = CommandListener(
            node, replace(topic, name=of.raw), self._receive, lambda *_: None
        )
        self.listener.keep = self._keep
        self._publisher = node.create_publisher(type_, of.out, quality())
        if self._publisher.topic_name == self.listener.full_name:
            raise UnusableError(
                f"{of.raw} and {of.out} are the same topic, {self.full_name}"
            )
        self._fallbacks = {
            each.name: serialize_message(filled(type_(), each.fields))
            for each in of.fallbacks
        }
        read = message_reader(topic, type_)
        self.values = {name: read(data) for name, data in self._fallbacks.items()}

    @property
    def full_name(self) -> str:
        """The name of OUT as the network knows it."""
        name: str = self._publisher.topic_name
        return name

    def _keep(self, received: int, info: Any, data: bytes) -> None:
        self._latest = data

    def _receive(
        self, received: int, topic: str, values: Sequence[Value] | None
    ) -> None:
        self.count += 1
        self.waiting.append((self._latest, values))

    def send(self, message: str) -> None:
        """Let the fallback called `message` leave."""
        self.pass_on(self._fallbacks[message])

    def pass_on(self, data: bytes) -> None:
        """Let a message leave as it came."""
        self._publisher.publish(data)

    def look(self, is_due: bool) -> list[str]:
        """Show that the guard lives; who has begun to publish on OUT beside it.

        If it `is_due`, see whether the publishers of commands are others.
        """
        self._publisher.assert_liveliness()
        self.listener.silence.look(self.count)
        if is_due or not self.count:
            self.listener.fit(self.count)
        before, self.bypasses = self.bypasses, self._others()
        return [name for name in self.bypasses if name not in before]

    def _others(self) -> list[str]:
        """The nodes that publish on OUT, but for one publisher of this one."""
        found = self._node.get_publishers_info_by_topic(self.full_name)
        names = [f"{p.node_namespace.rstrip('/')}/{p.node_name}" for p in found]
        own: str = self._node.get_fully_qualified_name()
        if own in names:
            names.remove(own)
        return ["another node" if UNNAMED in name else name for name in names]

    @property
    def remarks(self) -> list[str]:
        """What is wrong, or may be, with what comes in and what leaves."""
        others = " and ".join(sorted(set(self.bypasses)))
        beside = f"{self.full_name} is also published by {others}"
        return [*self.listener.remarks, *([beside] if others else [])]


def quality() -> QoSProfile:
    """That of what leaves: the last command, and whether the guard lives."""
    return QoSProfile(
        depth=1,
        liveliness=LivelinessPolicy.MANUAL_BY_TOPIC,
        liveliness_lease_duration=Duration(seconds=LEASE),
    )


def filled(message: Any, fields: Sequence[tuple[tuple[str, ...], Value]]) -> Any:
    """`message` with values in some fields, each as the field's type has it."""
    for (*parents, name), value in fields:
        place = reduce(getattr, parents, message)
        is_byte = isinstance(getattr(place, name), bytes)
        new = bytes([int(value)]) if is_byte else type(getattr(place, name))(value)
        setattr(place, name, new)
    return message


class Commands:
    """The commands of a node, and its guards; there may be none.

    The guards begin anew with every run, but one that has lost has lost for good. They
    do not begin before `SETTLING` s have passed, in which other publishers are found.
    """

    SETTLING = 1.0

    def __init__(
        self,
        node: Node,
        plan: Plan,
        guarded: Sequence[GuardedTopic],
        topics: Mapping[str, Topic],
        samples: Callable[[str, Sequence[Value] | None], Values],
        note: Callable[[Deed], None],
    ) -> None:
        """`samples` are those of what a message on a topic says.

        `note` is told what a guard did, once what leaves has left.
        """
        if guarded and plan.rate:
            raise UnusableError("rate is set, but a guard judges every message")
        self._plan, self._samples, self._note = plan, samples, note
        self.ways = {each.out: Way(node, each, topics[each.out]) for each in guarded}
        self._guards: Guards | None = None
        self._command = b""
        self._lost: dict[str, str] = {}
        self._has_sent = self.is_bypassed = False
        self._settled = time.monotonic() + self.SETTLING if guarded else 0.0

    @property
    def are_waiting(self) -> bool:
        """Whether commands have come in."""
        return any(way.waiting for way in self.ways.values())

    @property
    def are_settled(self) -> bool:
        """Whether the guards may begin."""
        return time.monotonic() >= self._settled

    @property
    def have_lost(self) -> bool:
        """Whether a guard can no longer keep its properties."""
        return bool(self._lost)

    def end_run(self) -> None:
        """A run ends; nothing leaves before the next one begins."""
        self._guards = None

    def begin(self, now: int) -> None:
        """A run begins."""
        made = [self._guard(each, now) for each in self._plan.guards]
        self._guards = Guards(made, self._done)

    def _guard(self, plan: GuardPlan, now: int) -> Guard:
        fallbacks = [
            Message(name, out, self._samples(out, values))
            for out in plan.outs
            for name, values in self.ways[out].values.items()
        ]
        watched = Watching(self._plan, plan, now)
        guard = Guard(watched, plan.outs, fallbacks, plan.lead)
        guard.lost = next((self._lost[o] for o in plan.outs if o in self._lost), None)
        return guard

    def hear(self, time_: int, topic: str, values: Values) -> None:
        """A message has come on another topic."""
        if self._guards:
            self._guards.hear(time_, topic, values)

    def due(self) -> int | None:
        """When to call `act`; None: never."""
        return self._guards.due() if self._guards else None

    def act(self, now: int) -> None:
        """It is `now`: do what is due."""
        if self._guards:
            self._guards.act(now)

    def let_through(self, now: int) -> None:
        """Decide about the commands that wait."""
        for out, way in self.ways.items():
            while way.waiting:
                self._command, values = way.waiting.popleft()
                samples = self._samples(out, values)
                if values is not None and self._guards is not None:
                    self._guards.command(now, out, samples)
                else:
                    why = "it is malformed" if values is None else "it is too early"
                    held = Deed(now, Action.HELD, (out,), samples, reason=why)
                    self._note(held)

    def _done(self, deed: Deed) -> None:
        """A guard did something: what leaves, leaves first of all."""
        if deed.values is not None:
            way = self.ways[deed.outs[0]]
            if deed.message is None:
                way.pass_on(self._command)
            else:
                way.send(deed.message)
            self._has_sent = True
        elif deed.action is Action.LOST:
            self._lost |= dict.fromkeys(deed.outs, deed.reason)
        self._note(deed)

    def look(self, is_due: bool) -> list[str]:
        """Look after topics; what is to be reported at once.

        Raises UnusableError if somebody else publishes what the guard is to let through
        before anything has left it.
        """
        found = []
        for way in self.ways.values():
            for name in way.look(is_due):
                what = f"{way.full_name} is also published by {name}"
                if not self._has_sent:
                    raise UnusableError(
                        f"{what}, which would not be guarded: "
                        f"have it publish on {way.listener.full_name}"
                    )
                self.is_bypassed = True
                found.append(f"{what}, which is not guarded")
        return found

    @property
    def remarks(self) -> list[str]:
        """What is amiss, or may be."""
        return [remark for way in self.ways.values() for remark in way.remarks]
