"""The part of an emitted node that speaks ROS 2; it needs rclpy.

The text of `MODULES` is written into emitted nodes behind that of `ltlc.runtime`, in
that order and without its imports of ltlc. `life.main` is what such a node runs.
"""

MODULES = (
    "ltlc.backends.ros2.node.files",
    "ltlc.backends.ros2.node.watchdog",
    "ltlc.backends.ros2.node.options",
    "ltlc.backends.ros2.node.losses",
    "ltlc.backends.ros2.node.classes",
    "ltlc.backends.ros2.node.topics",
    "ltlc.backends.ros2.node.wire",
    "ltlc.backends.ros2.node.intake",
    "ltlc.backends.ros2.node.clock",
    "ltlc.backends.ros2.node.commands",
    "ltlc.backends.ros2.node.deeds",
    "ltlc.backends.ros2.node.recorder",
    "ltlc.backends.ros2.node.outlets",
    "ltlc.backends.ros2.node.definitions",
    "ltlc.runtime.mcap",
    "ltlc.backends.ros2.node.extracts",
    "ltlc.backends.ros2.node.snapshot",
    "ltlc.backends.ros2.node.diagnosis",
    "ltlc.backends.ros2.node.locks",
    "ltlc.backends.ros2.node.absences",
    "ltlc.backends.ros2.node.watch",
    "ltlc.backends.ros2.node.life",
)
"""What an emitted node needs, each after what it imports."""
