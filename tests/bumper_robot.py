"""A robot on a rail, simulated with MuJoCo as fast as real time goes, that publishes what it senses over ROS 2.

It drives towards a box, which its bumper feels, and which stands before a wall; a lidar measures how far the wall is.
"""

from __future__ import annotations

import argparse
import threading
import time
from typing import Any

import mujoco
import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool, Float64

TIME_STEP = 0.002
PERIOD = 0.02
"""Between two observations, in s."""

AFTERWARDS = 0.5
"""How long it tells that it is held, in s."""

SPEED = 0.5
PATIENCE = 300.0

WORLD = f"""
<mujoco>
  <option timestep="{TIME_STEP}" integrator="implicitfast"/>
  <worldbody>
    <geom type="plane" size="5 5 0.1"/>
    <geom type="box" size="0.1 1 0.5" pos="1.7 0 0.5"/>
    <body name="box" pos="0.8 0 0.2">
      <joint type="slide" axis="1 0 0" frictionloss="2"/>
      <geom type="box" size="0.1 0.2 0.15" mass="1"/>
    </body>
    <body name="robot" pos="0 0 0.2">
      <joint name="drive" type="slide" axis="1 0 0"/>
      <geom type="box" size="0.2 0.15 0.1" mass="5"/>
      <site name="bumper" type="box" size="0.02 0.15 0.1" pos="0.21 0 0"/>
      <site name="lidar" pos="0 0 0.3" zaxis="1 0 0"/>
    </body>
  </worldbody>
  <actuator>
    <velocity joint="drive" kv="200" forcerange="-60 60"/>
  </actuator>
  <sensor>
    <touch site="bumper"/>
    <rangefinder site="lidar"/>
  </sensor>
</mujoco>
"""


class Robot:
    """The physics, and a driver that stops `reaction` s after the bumper was hit first; None: never.

    Once it `is_held` it does not move, whatever the driver wants.
    """

    def __init__(self, reaction: float | None) -> None:
        self._model = mujoco.MjModel.from_xml_string(WORLD)
        self._data = mujoco.MjData(self._model)
        self._reaction = reaction
        self._hit: float | None = None
        self.commanded = SPEED
        self.is_held = False
        mujoco.mj_forward(self._model, self._data)

    @property
    def time(self) -> float:
        return float(self._data.time)

    @property
    def bumper(self) -> bool:
        return bool(self._data.sensordata[0] > 0)

    @property
    def distance(self) -> float:
        return float(self._data.sensordata[1])

    @property
    def speed(self) -> float:
        return abs(float(self._data.joint("drive").qvel[0]))

    def drive(self) -> None:
        """Go on for a period."""
        if self.bumper and self._hit is None:
            self._hit = self.time
        if self._hit is not None and self._reaction is not None and self.time >= self._hit + self._reaction:
            self.commanded = 0.0
        if self.is_held:
            self.commanded = 0.0
        self._data.ctrl[0] = self.commanded
        for _ in range(round(PERIOD / TIME_STEP)):
            mujoco.mj_step(self._model, self._data)


class Bridge:
    """The robot's topics."""

    def __init__(self) -> None:
        rclpy.init()
        self._hit: float | None = None
        self._node = rclpy.create_node("robot")
        kinds = {"/bumper": Bool, "/speed": Float64, "/commanded": Float64, "/scan": LaserScan}
        self._publishers = {topic: self._node.create_publisher(kind, topic, 1000) for topic, kind in kinds.items()}

    def wait(self) -> None:
        """Until somebody listens to each topic."""
        deadline = time.monotonic() + PATIENCE
        while not all(p.get_subscription_count() for p in self._publishers.values()):
            if time.monotonic() > deadline:
                raise TimeoutError("nobody listens")
            time.sleep(0.02)

    def obey(self, robot: Robot, lock: str) -> None:
        """Hold the robot as soon as what is published on `lock` is true, and say how long after a hit that was."""

        def hold(message: Bool) -> None:
            if message.data and self._hit is not None and not robot.is_held:
                robot.is_held = True
                print(f"held {1e3 * (time.monotonic() - self._hit):.3f} ms after it told of the hit", flush=True)

        profile = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._node.create_subscription(Bool, lock, hold, profile)
        threading.Thread(target=rclpy.spin, args=(self._node,), daemon=True).start()
        deadline = time.monotonic() + PATIENCE
        while not self._node.count_publishers(lock):
            if time.monotonic() > deadline:
                raise TimeoutError("there is no lock")
            time.sleep(0.02)

    def publish(self, robot: Robot, has_lidar: bool) -> None:
        messages: dict[str, Any] = {
            "/commanded": Float64(data=robot.commanded),
            "/speed": Float64(data=robot.speed),
            "/bumper": Bool(data=robot.bumper),
        }
        if has_lidar:
            messages["/scan"] = LaserScan(ranges=[robot.distance])
        if robot.bumper and self._hit is None:
            self._hit = time.monotonic()
        for topic, message in messages.items():
            self._publishers[topic].publish(message)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--seconds", type=float, required=True, help="how long it drives before it says so, and goes on"
    )
    parser.add_argument("--reaction", type=float, help="after so many seconds at the box it stops")
    parser.add_argument("--blind-after", type=float, default=float("inf"), help="when its lidar falls silent, in s")
    parser.add_argument(
        "--lock", metavar="TOPIC", help="it is held once a message on TOPIC is true, and has driven some time later"
    )
    arguments = parser.parse_args()
    robot, bridge = Robot(arguments.reaction), Bridge()
    bridge.wait()
    if arguments.lock:
        bridge.obey(robot, arguments.lock)
    due, until = time.monotonic(), arguments.seconds
    while True:
        bridge.publish(robot, robot.time < arguments.blind_after)
        robot.drive()
        due = max(due + PERIOD, time.monotonic())  # time lost is not made up for
        time.sleep(max(0.0, due - time.monotonic()))
        if arguments.lock and not robot.is_held:
            until = robot.time + AFTERWARDS
        if robot.time >= until:
            print("has driven", flush=True)


if __name__ == "__main__":
    main()
