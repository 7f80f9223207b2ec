"""A robot with two driven wheels and a stop sign beside its way, simulated with MuJoCo; no ROS here."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import mujoco
import numpy as np

SIGN = (4.0, 0.6)
"""Where the stop sign stands, in m; the robot starts at (0, 0) and drives along the x axis."""

RATE = 50.0
"""Observations, and decisions of the driver, in a simulated second."""

TIME_STEP = 0.002
TOO_LATE = 120.0
WHEEL_RADIUS = 0.1
WHEEL_DISTANCE = 0.36

WORLD = f"""
<mujoco>
  <option timestep="{TIME_STEP}" integrator="implicitfast"/>
  <worldbody>
    <geom type="plane" size="20 20 0.1"/>
    <body name="stop_sign" pos="{SIGN[0]} {SIGN[1]} 0">
      <geom type="cylinder" size="0.03 0.5" pos="0 0 0.5"/>
      <geom type="box" size="0.02 0.2 0.2" pos="0 0 1" rgba="1 0 0 1"/>
    </body>
    <body name="robot" pos="0 0 {WHEEL_RADIUS}">
      <freejoint/>
      <geom type="box" size="0.2 0.15 0.05" mass="5"/>
      <geom type="sphere" size="0.04" pos="-0.15 0 -0.06" friction="0 0 0" mass="0.1"/>
      <body pos="0.05 {WHEEL_DISTANCE / 2} 0">
        <joint name="left" axis="0 1 0"/>
        <geom type="cylinder" size="{WHEEL_RADIUS} 0.02" euler="90 0 0" mass="0.3"/>
      </body>
      <body pos="0.05 {-WHEEL_DISTANCE / 2} 0">
        <joint name="right" axis="0 1 0"/>
        <geom type="cylinder" size="{WHEEL_RADIUS} 0.02" euler="90 0 0" mass="0.3"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <velocity joint="left" kv="2"/>
    <velocity joint="right" kv="2"/>
  </actuator>
</mujoco>
"""


@dataclass(frozen=True, slots=True)
class Motion:
    """Where a body is and how it moves, as nav_msgs/Odometry has it.

    Position in m and orientation (x, y, z, w) are in the world; velocities in m/s and rad/s are in the body's frame.
    """

    position: tuple[float, float, float]
    orientation: tuple[float, float, float, float]
    linear: tuple[float, float, float]
    angular: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Command:
    """What the driver asks of the wheels: forward speed in m/s and turning rate in rad/s."""

    forward: float = 0.0
    turn: float = 0.0


@dataclass(frozen=True, slots=True)
class Observation:
    """The world at one time, in s: the truth, what the robot believes of itself, and what it has been told to do."""

    time: float
    stop_sign: Motion
    robot: Motion
    believed: Motion
    command: Command


@dataclass(frozen=True, slots=True)
class To:
    """Drive to a place, in m."""

    x: float
    y: float


@dataclass(frozen=True, slots=True)
class Halt:
    """Stand still for `seconds`."""

    seconds: float


Leg = To | Halt

DRIVES: dict[str, tuple[Leg, ...]] = {
    "runs": (Halt(0.5), To(6, 0)),
    "stops": (Halt(0.5), To(3.5, 0), Halt(1.5), To(6, 0)),
    "stops-then-runs": (Halt(0.5), To(3.5, 0), Halt(1.5), To(6, 0), To(6, 1.2), To(2, 1.2)),
}
"""What the robot can be asked to do. 'In the zone' is within 1 m of the sign: from x = 3.2 to 4.8 on the way there."""


class World:
    """The physics: wheels turn as commanded, and friction does the rest."""

    def __init__(self, drift: float = 0.0) -> None:
        self._model = mujoco.MjModel.from_xml_string(WORLD)
        self._data = mujoco.MjData(self._model)
        self._odometry = WheelOdometry(drift)
        self._command = Command()
        mujoco.mj_forward(self._model, self._data)

    @property
    def time(self) -> float:
        """The simulated time, in s."""
        return round(float(self._data.time), 6)

    def step(self, command: Command) -> None:
        """Let the robot follow `command` for the shortest time that is simulated."""
        self._command = command
        difference = command.turn * WHEEL_DISTANCE / 2
        self._data.ctrl[:] = [
            (command.forward - difference) / WHEEL_RADIUS,
            (command.forward + difference) / WHEEL_RADIUS,
        ]
        mujoco.mj_step(self._model, self._data)
        left, right = (float(self._data.joint(wheel).qvel[0]) for wheel in ("left", "right"))
        self._odometry.step(left, right, TIME_STEP)

    def observe(self) -> Observation:
        """The world as it is now."""
        return Observation(
            self.time, self._truth("stop_sign"), self._truth("robot"), self._odometry.motion(), self._command
        )

    def _truth(self, name: str) -> Motion:
        """The ground truth of a body, as a simulator's bridge publishes it."""
        body = self._data.body(name)
        velocity = np.zeros(6)
        kind = mujoco.mjtObj.mjOBJ_BODY
        mujoco.mj_objectVelocity(self._model, self._data, kind, body.id, velocity, True)
        x, y, z, vx, vy, vz = map(float, [*body.xpos, *velocity[3:]])
        qw, qx, qy, qz = map(float, body.xquat)
        wx, wy, wz = map(float, velocity[:3])
        return Motion((x, y, z), (qx, qy, qz, qw), (vx, vy, vz), (wx, wy, wz))


class WheelOdometry:
    """What the robot believes of itself: dead reckoning from how far its wheels have turned.

    With `drift` 0.1 it takes its wheels for 10 % larger than they are, and believes itself ever further ahead.
    """

    def __init__(self, drift: float) -> None:
        self._radius = WHEEL_RADIUS * (1 + drift)
        self._x = self._y = self._heading = 0.0
        self._forward = self._turn = 0.0

    def step(self, left: float, right: float, duration: float) -> None:
        """The wheels turned at `left` and `right` rad/s for `duration` s."""
        self._forward = (left + right) / 2 * self._radius
        self._turn = (right - left) * self._radius / WHEEL_DISTANCE
        self._heading += self._turn * duration
        self._x += self._forward * math.cos(self._heading) * duration
        self._y += self._forward * math.sin(self._heading) * duration

    def motion(self) -> Motion:
        """Where the robot believes to be."""
        orientation = (0.0, 0.0, math.sin(self._heading / 2), math.cos(self._heading / 2))
        position = (self._x, self._y, WHEEL_RADIUS)
        return Motion(position, orientation, (self._forward, 0.0, 0.0), (0.0, 0.0, self._turn))


class Driver:
    """Follows the legs of a drive: turns towards the next place, and brakes in time to halt there."""

    ACCELERATION = 2.0
    NEAR_ENOUGH = 0.25

    def __init__(self, legs: tuple[Leg, ...], speed: float) -> None:
        self._legs = list(legs)
        self._speed = speed
        self._forward = 0.0
        self._halted_at: float | None = None

    @property
    def has_arrived(self) -> bool:
        """Whether all legs are done."""
        return not self._legs

    def command(self, time: float, robot: Motion, duration: float) -> Command:
        """What to do for the next `duration` s, with the robot where it truly is."""
        while self._legs and self._is_done(self._legs[0], time, robot):
            self._legs.pop(0)
            self._halted_at = None
        forward, turn = self._wanted(robot)
        step = self.ACCELERATION * duration
        self._forward += max(-step, min(step, forward - self._forward))
        return Command(self._forward, turn)

    def _is_done(self, leg: Leg, time: float, robot: Motion) -> bool:
        if isinstance(leg, To):
            return _distance(robot, leg) < self.NEAR_ENOUGH
        self._halted_at = time if self._halted_at is None else self._halted_at
        return time - self._halted_at >= leg.seconds

    def _wanted(self, robot: Motion) -> tuple[float, float]:
        """Speed and turning rate that the present leg wants."""
        match self._legs:
            case [To() as place, Halt(), *_]:
                braking = math.sqrt(2 * self.ACCELERATION * _distance(robot, place))
                return _towards(robot, place, min(self._speed, braking))
            case [To() as place, *_]:
                return _towards(robot, place, self._speed)
            case _:
                return 0.0, 0.0


def _towards(robot: Motion, place: To, speed: float) -> tuple[float, float]:
    """Drive at `speed` if `place` is ahead, slower the more the robot has to turn for it."""
    bearing = _bearing(robot, place)
    return speed * max(0.1, math.cos(bearing)), 2 * bearing


def _distance(robot: Motion, place: To) -> float:
    return math.hypot(place.x - robot.position[0], place.y - robot.position[1])


def _bearing(robot: Motion, place: To) -> float:
    """The direction of `place` as the robot sees it, in rad: 0 is straight ahead, positive is to the left."""
    _, _, qz, qw = robot.orientation
    heading = 2 * math.atan2(qz, qw)
    direction = math.atan2(place.y - robot.position[1], place.x - robot.position[0])
    return math.remainder(direction - heading, 2 * math.pi)


def simulate(drive: str, *, speed: float, drift: float) -> Iterator[Observation]:
    """Drive, and observe the world `RATE` times a second until the robot has arrived, or has gone astray."""
    world = World(drift)
    driver = Driver(DRIVES[drive], speed)
    while not driver.has_arrived and world.time < TOO_LATE:
        observation = world.observe()
        yield observation
        command = driver.command(observation.time, observation.robot, 1 / RATE)
        for _ in range(round(1 / RATE / TIME_STEP)):
            world.step(command)
