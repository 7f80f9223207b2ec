"""Whether a property is violated, for what acts on it: a lock that holds the robot."""

from __future__ import annotations

from collections.abc import Sequence

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Bool

from ltlc.runtime.reports import topic_names
from ltlc.runtime.session import Session
from ltlc.semantics.verdicts import Verdict


class Locks:
    """Publishes whether any property is violated, on ~/violated, and each on its own.

    The topic of one property is ~/violated/LABEL. Who subscribes late gets the last of
    each; that of all comes again at every `show`, so that a lock with a time-out
    notices when the monitor is gone.
    """

    def __init__(self, node: Node, labels: Sequence[str]) -> None:
        profile = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        names = [f"~/violated/{name}" for name in topic_names(labels)]
        self._all = node.create_publisher(Bool, "~/violated", profile)
        self._each = [node.create_publisher(Bool, name, profile) for name in names]
        self._shown: list[bool | None] = [None] * len(names)

    def show(self, session: Session) -> None:
        """Publish what is violated now, of each property if that has changed."""
        found = [track.verdict is Verdict.VIOLATED for track in session.tracks]
        self._all.publish(Bool(data=any(found)))
        for number, is_violated in enumerate(found):
            if self._shown[number] is not is_violated:
                self._each[number].publish(Bool(data=is_violated))
        self._shown = [*found]
