"""Publishes observations of the simulation on ROS 2, as a simulator's bridge does."""

from __future__ import annotations

import time
from types import TracebackType
from typing import Any, Self

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.duration import Duration
from rclpy.signals import SignalHandlerOptions
from rclpy.time import Time
from rosgraph_msgs.msg import Clock
from simulation import Motion, Observation

TRUTH_OF_ROBOT = "/model/robot/odometry"
TRUTH_OF_SIGN = "/model/stop_sign/odometry"
BELIEVED = "/odom"
COMMANDED = "/cmd_vel"
CLOCK = "/clock"

DEPTH = 1000
"""Messages that are kept for a slow subscriber: faster than real time, none shall be lost."""

PATIENCE = Duration(seconds=20)
"""How long to wait for a subscriber to confirm what it got; so long DDS takes a process for alive that died."""


class Bridge:
    """The publishers; to be used in a `with` statement."""

    def __init__(self, clock: bool) -> None:
        rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
        self._node = rclpy.create_node("robot")
        types: dict[str, Any] = {
            COMMANDED: Twist,
            BELIEVED: Odometry,
            TRUTH_OF_SIGN: Odometry,
            TRUTH_OF_ROBOT: Odometry,
        }
        if clock:
            types[CLOCK] = Clock
        self._publishers = {topic: self._node.create_publisher(type_, topic, DEPTH) for topic, type_ in types.items()}
        self._heard: set[str] = set()

    def wait_for_subscribers(self, topics: list[str], patience: float) -> None:
        """Return when each of `topics` has a subscriber; after `patience` seconds, `TimeoutError`."""
        deadline = time.monotonic() + patience
        while silent := [t for t in topics if not self._publishers[t].get_subscription_count()]:
            if time.monotonic() > deadline:
                raise TimeoutError(f"nobody subscribes to {', '.join(silent)}")
            time.sleep(0.02)

    def publish(self, observation: Observation) -> None:
        """One message on each topic; the truth about the robot comes last."""
        stamp = Time(nanoseconds=round(observation.time * 1e9)).to_msg()
        if CLOCK in self._publishers:
            self._publish(CLOCK, Clock(clock=stamp))
        twist = Twist()
        twist.linear.x, twist.angular.z = observation.command.forward, observation.command.turn
        self._publish(COMMANDED, twist)
        self._publish(BELIEVED, odometry(observation.believed, "odom", "base_link", stamp))
        self._publish(TRUTH_OF_SIGN, odometry(observation.stop_sign, "world", "stop_sign", stamp))
        self._publish(TRUTH_OF_ROBOT, odometry(observation.robot, "world", "robot", stamp))

    def _publish(self, topic: str, message: Any) -> None:
        """The first message on a topic is waited for: its reader may not yet have matched, and gets it late."""
        self._publishers[topic].publish(message)
        if topic not in self._heard:
            self._heard.add(topic)
            self._publishers[topic].wait_for_all_acked(PATIENCE)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: BaseException | TracebackType | None) -> None:
        """Shut down; all that was published is delivered first."""
        if kind is None:
            for publisher in self._publishers.values():
                publisher.wait_for_all_acked(PATIENCE)
        self._node.destroy_node()
        rclpy.try_shutdown()


def odometry(motion: Motion, frame: str, child: str, stamp: Any) -> Odometry:
    """A message that says how `child` moves, seen from `frame`."""
    message = Odometry()
    message.header.stamp = stamp
    message.header.frame_id = frame
    message.child_frame_id = child
    pose, twist = message.pose.pose, message.twist.twist
    pose.position.x, pose.position.y, pose.position.z = motion.position
    pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w = motion.orientation
    twist.linear.x, twist.linear.y, twist.linear.z = motion.linear
    twist.angular.x, twist.angular.y, twist.angular.z = motion.angular
    return message
