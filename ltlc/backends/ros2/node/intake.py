"""Messages come in: subscriptions that fit their publishers."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable, Sequence
from inspect import Parameter, Signature
from typing import Any

from rclpy.event_handler import (
    SubscriptionEventCallbacks,
    UnsupportedEventTypeError,
)
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.subscription import Subscription
from rclpy.utilities import get_rmw_implementation_identifier

from ltlc.backends.ros2.node.classes import class_of
from ltlc.backends.ros2.node.files import UnusableError
from ltlc.backends.ros2.node.losses import Losses
from ltlc.backends.ros2.node.topics import Topic
from ltlc.backends.ros2.node.wire import MALFORMED, fields_reader, message_reader
from ltlc.runtime.sampling import Value


def message_class(topic: Topic) -> Any:
    """The Python class of the messages of `topic`; it must be what `read` expects."""
    try:
        found = class_of(topic.message)
    except (ImportError, AttributeError) as error:
        package = topic.message.split("/")[0]
        raise UnusableError(
            f"{topic.name} needs {topic.message}, which cannot be loaded ({error}): "
            f"install the ROS 2 package {package} and source its setup file"
        ) from error
    try:
        topic.read(found())
    except AttributeError as error:
        raise UnusableError(
            f"{topic.name} needs another version of {topic.message}: {error}"
        ) from error
    return found


class Silence:
    """How long nothing has come, against how long that took before."""

    PATIENCE = 5.0

    def __init__(self) -> None:
        self._count = 0
        self._since = math.inf
        self._longest = 0.0

    def look(self, count: int) -> None:
        """There have been `count` messages by now."""
        if count == self._count:
            return
        if self._count:
            self._longest = max(self._longest, self.seconds)
        self._count, self._since = count, time.monotonic()

    @property
    def seconds(self) -> float:
        """For how long nothing has come; negative if nothing ever has."""
        return time.monotonic() - self._since

    @property
    def text(self) -> str:
        """For how long nothing has come."""
        return f" for {self.seconds:.0f} s" if self._count else " yet"

    @property
    def is_unusual(self) -> bool:
        """Whether that is far longer than ever before; what came once may rest."""
        usual = max(self.PATIENCE, 10 * self._longest)
        return self._longest > 0 and self.seconds > usual


class Listener:
    """The subscription to one topic, of a quality of service that fits its publishers.

    A reliable subscription hears nothing from a publisher that makes its best effort,
    one that wants kept messages nothing from a publisher that keeps none.
    """

    DEPTH = 1000
    TAKES_KEPT = True
    """Whether it takes what publishers have kept for newcomers."""

    __signature__ = Signature(
        [Parameter(name, Parameter.POSITIONAL_ONLY) for name in ("message", "info")]
    )
    """What rclpy looks at to see whether a callback wants to know about a message."""

    def __init__(
        self,
        node: Node,
        topic: Topic,
        receive: Callable[[int, str, Sequence[Value] | None], None],
        lose: Callable[[str, int | None], None],
    ) -> None:
        """What is done with messages.

        `receive` is told when one was received, in ns, and what it says, None if it is
        malformed; `lose` how many are missing before it.
        """
        self.topic = topic
        self.own: deque[bytes] = deque()
        self.keep: Callable[[int, Any, bytes], None] | None = None
        self.foreign: list[str] = []
        self._node = node
        self._receive = receive
        self._lose = lose
        self._type = message_class(topic)
        decoded = message_reader(topic, self._type)
        self._read = fields_reader(topic, self._type, decoded) or decoded
        self._losses = Losses(self.DEPTH, self._publishers)
        self._latest = 0
        self.silence = Silence()
        self._is_published = True
        self._has_offers = False
        self._has_warned = False
        self._reliability = ReliabilityPolicy.RELIABLE
        self._durability = DurabilityPolicy.VOLATILE
        self._subscription = self._subscribed()

    def __call__(self, message: Any, info: Any = None) -> None:
        """A message came in, with what the middleware knows of it.

        The events executor of rclpy 7.1 passes both as one tuple.
        """
        if info is None:
            message, info = message
        received, taken = info["received_timestamp"], time.time_ns()
        number = info["publication_sequence_number"]
        if message in self.own:
            self.own.remove(message)
            return
        for missing in self._losses.before(number, received, taken):
            self._lose(self.topic.name, missing)
        self._latest = min(max(received or self._unstamped(), self._latest), taken)
        if self.keep is not None:
            self.keep(self._latest, info, message)
        self._receive(self._latest, self.topic.name, self._values(message))

    def _values(self, message: bytes) -> Sequence[Value] | None:
        """The contents of a message; None if it is malformed."""
        try:
            return self._read(message)
        except MALFORMED as error:
            if not self._has_warned:
                self._has_warned = True
                self._node.get_logger().warning(
                    f"malformed message on {self.full_name}, and there may be others: "
                    f"{type(error).__name__}: {error}"
                )
            return None

    def _unstamped(self) -> int:
        """When a message is taken: the middleware does not say when it was received."""
        self._node.get_logger().warning(
            "the middleware reports no times of receipt: "
            "messages are judged by the times at which the node reads them",
            once=True,
        )
        return time.time_ns()

    def _publishers(self) -> frozenset[str]:
        """The identities of the publishers that there are now, but for its own."""
        return frozenset(str(each.endpoint_gid) for each in self.others())

    @property
    def full_name(self) -> str:
        """The topic's name as the network knows it: namespace and remapping applied."""
        name: str = self._subscription.topic_name
        return name

    @property
    def remarks(self) -> list[str]:
        """What is wrong, or may be, with what is heard on this topic."""
        also = [f"{self.full_name} is also published as {t}" for t in self.foreign]
        remarks = [self.misfit] if self.misfit else also
        if self._reliability is ReliabilityPolicy.BEST_EFFORT:
            remarks.append(f"{self.full_name} is published without delivery guarantee")
        if not self._is_published:
            remarks.append(f"{self.full_name} no longer has a publisher")
        if self.silence.is_unusual:
            remarks.append(f"no message on {self.full_name}{self.silence.text}")
        return remarks

    @property
    def misfit(self) -> str:
        """That all that is published on the topic is of other types; else empty."""
        if not self.foreign or self._has_offers:
            return ""
        types = " and ".join(self.foreign)
        return f"{self.full_name} is published as {types}, not as {self.topic.message}"

    def fit(self, heard: int) -> None:
        """Adapt to the publishers that there are now; `heard` messages came so far."""
        publishers = self.others()
        self._is_published = bool(publishers) or not heard
        types = {publisher.topic_type for publisher in publishers}
        self.foreign = sorted(types - {self.topic.message})
        offers = [p.qos_profile for p in publishers if p.topic_type not in self.foreign]
        self._has_offers = bool(offers)
        if not offers:
            return
        reliability, durability = self._reliability, self._durability
        if any(o.reliability == ReliabilityPolicy.BEST_EFFORT for o in offers):
            reliability = ReliabilityPolicy.BEST_EFFORT
        if any(o.durability != DurabilityPolicy.TRANSIENT_LOCAL for o in offers):
            durability = DurabilityPolicy.VOLATILE
        elif heard == 0 and self.TAKES_KEPT:
            durability = DurabilityPolicy.TRANSIENT_LOCAL
        if (reliability, durability) != (self._reliability, self._durability):
            self._reliability, self._durability = reliability, durability
            self.renew()

    def others(self) -> list[Any]:
        """The publishers on the topic that there are now, but for the node's own."""
        own = (self._node.get_name(), self._node.get_namespace())
        publishers = self._node.get_publishers_info_by_topic(self.full_name)
        return [p for p in publishers if (p.node_name, p.node_namespace) != own]

    def renew(self) -> None:
        """Subscribe anew; a publisher that keeps messages for newcomers sends them."""
        self._node.destroy_subscription(self._subscription)
        self._subscription = self._subscribed()

    @property
    def is_latched(self) -> bool:
        """Whether the topic's messages are kept for newcomers."""
        return self._durability is DurabilityPolicy.TRANSIENT_LOCAL

    def _subscribed(self) -> Subscription:
        profile = QoSProfile(
            depth=self.DEPTH, reliability=self._reliability, durability=self._durability
        )
        try:
            return self._subscribed_with(profile, self._on_loss())
        except UnsupportedEventTypeError:
            return self._subscribed_with(profile, None)

    def _on_loss(self) -> Callable[[Any], None] | None:
        """What the middleware is to call; it may be best not to ask it.

        In rmw_fastrtps, who asks for an event and who brings one wait for each other's
        lock, in opposite order; numbers tell of losses there.
        """
        is_fast = get_rmw_implementation_identifier().startswith("rmw_fastrtps")
        return None if is_fast else self._count_lost

    def _subscribed_with(
        self, profile: QoSProfile, on_loss: Callable[[Any], None] | None
    ) -> Subscription:
        """A subscription to bytes: to take them apart here is what can go wrong."""
        return self._node.create_subscription(
            self._type,
            self.topic.name,
            self,
            profile,
            event_callbacks=SubscriptionEventCallbacks(
                message_lost=on_loss, use_default_callbacks=False
            ),
            raw=True,
        )

    def _count_lost(self, event: Any) -> None:
        """The middleware reports a loss; numbers, where there are any, show more."""
        if not self._losses.are_numbered:
            self._lose(self.topic.name, event.total_count_change)
