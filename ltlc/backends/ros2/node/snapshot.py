"""Asks a recorder of rosbag2 to write what it keeps in memory."""

from __future__ import annotations

import importlib
from typing import Any

from rclpy.node import Node

from ltlc.backends.ros2.node.files import UnusableError


class Snapshot:
    """The service of a recorder that was started with `--snapshot-mode`."""

    def __init__(self, node: Node, service: str) -> None:
        try:
            self._type = importlib.import_module("rosbag2_interfaces.srv").Snapshot
        except ImportError as error:
            raise UnusableError(
                f"snapshot is {service!r}, but {error}: "
                "install the ROS 2 package rosbag2_interfaces"
            ) from error
        self.have_failed = False
        self._node = node
        self._client = node.create_client(self._type, service)

    def violated(self, label: str) -> None:
        """A property was violated: ask."""
        if self._client.service_is_ready():
            future = self._client.call_async(self._type.Request())
            future.add_done_callback(lambda done: self._tell(label, done))
        else:
            self._fail(label, "nobody offers this service")

    def _tell(self, label: str, done: Any) -> None:
        """The recorder has answered."""
        if done.exception() is not None:
            self._fail(label, str(done.exception()))
        elif not done.result().success:
            self._fail(label, "the recorder answers that it has failed")
        else:
            self._node.get_logger().info(f"{self._client.srv_name} of {label}: taken")

    def _fail(self, label: str, why: str) -> None:
        self.have_failed = True
        text = f"{self._client.srv_name} of {label} is not taken: {why}"
        self._node.get_logger().error(text)
