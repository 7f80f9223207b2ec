"""The time that messages are judged by, and whether it goes on."""

from __future__ import annotations

import time

from rclpy.node import Node

from ltlc.backends.ros2.node.intake import Silence


class RosTime:
    """ROS time in ns: that of /clock under `use_sim_time`, or else the system's.

    Simulated time is 0, which is none, before the first /clock.
    """

    LEEWAY = 2_000_000
    """How long what has been received may be on its way to a queue, in ns."""

    def __init__(self, node: Node) -> None:
        self._clock = node.get_clock()
        self._ticking = Silence()
        self.is_simulated = self._clock.ros_time_is_active

    def now(self) -> int:
        """The time; that of the system is not taken from rclpy, which is slow."""
        if not self.is_simulated:
            return time.time_ns()
        nanoseconds: int = self._clock.now().nanoseconds
        return nanoseconds

    def surely(self) -> int:
        """Until when all that was received has reached the queues by now."""
        return self.now() if self.is_simulated else self.now() - self.LEEWAY

    def look(self) -> None:
        """See whether time is simulated, and goes on; to be called now and then."""
        self.is_simulated = self._clock.ros_time_is_active
        self._ticking.look(self.now() if self.is_simulated else 0)

    @property
    def remarks(self) -> list[str]:
        """What is amiss."""
        if self.now() == 0:
            return ["use_sim_time is set, but no time has arrived on /clock"]
        if self._ticking.is_unusual:
            return [f"/clock has stood still for {self._ticking.seconds:.0f} s"]
        return []
