"""Records the drive of the tutorial as a bag: a robot drives towards a wall, sees it, and is slow to brake.

python examples/first_drive.py drive
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from rosbags.rosbag2 import StoragePlugin, Writer  # noqa: TID251
from rosbags.typesys import Stores, get_typestore  # noqa: TID251

STORE = get_typestore(Stores.ROS2_JAZZY)
START, SECOND, TICK = 1_700_000_000_000_000_000, 1_000_000_000, 0.05
WALL, NEAR, REACTION, CRUISE, BRAKE = 3.0, 0.6, 0.65, 0.4, 0.5
"""Metres to the wall, metres at which it is seen, seconds until the brake bites, m/s, and m/s²."""
BEAMS = np.linspace(-0.2, 0.2, 3)


def drive() -> Iterator[tuple[float, float, float]]:
    """Time, position and measured speed at each tick; a speed that is measured is never quite 0."""
    position = speed = 0.0
    seen = math.inf
    for tick in range(220):
        time = tick * TICK
        if WALL - position < NEAR:
            seen = min(seen, time)
        pushed = -BRAKE if time - seen > REACTION else BRAKE
        speed = min(max(speed + pushed * TICK, 0.0), CRUISE)
        position += speed * TICK
        yield time, position, speed + 0.002 * math.sin(7 * time)


def header(time: float, frame: str) -> object:
    """The header of a message that was measured at `time`."""
    stamp = START + round(time * SECOND)
    moment = STORE.types["builtin_interfaces/msg/Time"](sec=stamp // SECOND, nanosec=stamp % SECOND)
    return STORE.types["std_msgs/msg/Header"](stamp=moment, frame_id=frame)


def odometry(time: float, position: float, speed: float) -> object:
    """What the wheels say."""
    types, covariance = STORE.types, np.zeros(36)
    vector, point = types["geometry_msgs/msg/Vector3"], types["geometry_msgs/msg/Point"]
    pose = types["geometry_msgs/msg/Pose"](
        position=point(x=position, y=0.0, z=0.0),
        orientation=types["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=0.0, w=1.0),
    )
    twist = types["geometry_msgs/msg/Twist"](linear=vector(x=speed, y=0.0, z=0.0), angular=vector(x=0.0, y=0.0, z=0.0))
    return types["nav_msgs/msg/Odometry"](
        header=header(time, "odom"),
        child_frame_id="base_link",
        pose=types["geometry_msgs/msg/PoseWithCovariance"](pose=pose, covariance=covariance),
        twist=types["geometry_msgs/msg/TwistWithCovariance"](twist=twist, covariance=covariance),
    )


def scan(time: float, position: float) -> object:
    """What the lidar says of the wall."""
    ranges = ((WALL - position) / np.cos(BEAMS)).astype(np.float32)
    return STORE.types["sensor_msgs/msg/LaserScan"](
        header=header(time, "laser"),
        angle_min=float(BEAMS[0]),
        angle_max=float(BEAMS[-1]),
        angle_increment=float(BEAMS[1] - BEAMS[0]),
        time_increment=0.0,
        scan_time=2 * TICK,
        range_min=0.1,
        range_max=12.0,
        ranges=ranges,
        intensities=np.zeros(0, np.float32),
    )


def record(folder: Path) -> None:
    """Write the bag, which must not be there yet."""
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as bag:
        odom, laser = (
            (bag.add_connection(topic, kind, typestore=STORE), kind)
            for topic, kind in (("/odom", "nav_msgs/msg/Odometry"), ("/scan", "sensor_msgs/msg/LaserScan"))
        )
        for tick, (time, position, speed) in enumerate(drive()):
            stamp = START + round(time * SECOND)
            bag.write(odom[0], stamp, STORE.serialize_cdr(odometry(time, position, speed), odom[1]))
            if tick % 2 == 0:
                bag.write(laser[0], stamp, STORE.serialize_cdr(scan(time, position), laser[1]))


if __name__ == "__main__":
    record(Path(sys.argv[1]))
