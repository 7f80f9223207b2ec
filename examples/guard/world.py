"""A mobile robot with a lidar, an arm and a load among people and walls, simulated with MuJoCo; no ROS here.

The robot does what it is told by messages, and is asked for messages with what it senses: a `Message` is a topic and
the fields of a message on it, by paths such as `linear/x`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import mujoco

Message = tuple[str, Mapping[str, object]]
Point = tuple[float, float]

TICK = 10
"""How often sensors, controllers and the robot get to run, in ms."""

STEPS = 5
"""So many steps of the physics are in a tick."""

BEAMS = 90
SEEN = 10.0
"""So far the lidar sees, in m."""

TIMEOUT = 0.5
"""So long after the last command, in s, the base stops by itself, as controllers of bases do."""

WHEEL_RADIUS = 0.1
WHEEL_DISTANCE = 0.4


@dataclass(frozen=True)
class Person:
    """Somebody who stands at `start`, or from `leaves` s on walks to `end` at a walking pace."""

    start: Point
    end: Point | None = None
    leaves: float = 0.0

    def at(self, time: float) -> Point:
        """Where they are."""
        if self.end is None:
            return self.start
        way = math.dist(self.start, self.end)
        share = min(1.0, max(0.0, (time - self.leaves) * 1.2 / way))
        return (
            self.start[0] + share * (self.end[0] - self.start[0]),
            self.start[1] + share * (self.end[1] - self.start[1]),
        )


@dataclass(frozen=True)
class Layout:
    """What the robot, which starts at (0, 0) and looks along the x axis, is put into.

    walls: each by its centre and half its extent along x and y, in m
    floor: the far end of the floor along x; beyond it, things fall
    places: those that the robot can be sent to by name
    charge: how full the battery is; `drain` is what a second takes of it
    """

    people: tuple[Person, ...] = ()
    walls: tuple[tuple[float, float, float, float], ...] = ()
    floor: float = 30.0
    has_load: bool = False
    places: Mapping[str, Point] = field(default_factory=dict)
    charge: float = 1.0
    drain: float = 0.0


def _xml(layout: Layout) -> str:
    people = "".join(
        f'<body name="person{n}" mocap="true" pos="{p.start[0]} {p.start[1]} 0.9">'
        '<geom type="capsule" size="0.2 0.7" rgba="0.9 0.6 0.1 1"/></body>'
        for n, p in enumerate(layout.people)
    )
    walls = "".join(
        f'<body name="wall{n}" pos="{x} {y} 0.5"><geom type="box" size="{dx} {dy} 0.5" rgba="0.5 0.5 0.6 1"/></body>'
        for n, (x, y, dx, dy) in enumerate(layout.walls)
    )
    angles = [2 * math.pi * beam / BEAMS for beam in range(BEAMS)]
    sites = "".join(
        f'<site name="beam{n}" pos="0 0 0.3" zaxis="{math.cos(a)} {math.sin(a)} 0"/>' for n, a in enumerate(angles)
    )
    beams = "".join(f'<rangefinder site="beam{n}" cutoff="{SEEN}"/>' for n in range(BEAMS))
    wheels = "".join(
        f'<body pos="0.1 {side * WHEEL_DISTANCE / 2} 0"><joint name="{name}" axis="0 1 0"/>'
        f'<geom type="ellipsoid" size="{WHEEL_RADIUS} 0.03 {WHEEL_RADIUS}" mass="0.5"/></body>'
        for name, side in (("left", 1), ("right", -1))
    )
    casters = "".join(
        f'<geom type="sphere" size="0.04" pos="{x} 0 {z}" friction="0 0 0" mass="0.1"/>'
        for x, z in ((-0.2, -0.06), (0.24, -0.055))
    )
    load = '<body name="load" pos="0 0 0.4"><freejoint/><geom type="box" size="0.07 0.07 0.2" mass="1"/></body>'
    return f"""
<mujoco>
  <option timestep="{TICK / STEPS / 1000}" integrator="implicitfast"/>
  <visual><headlight ambient="0.5 0.5 0.5"/></visual>
  <asset><texture type="skybox" builtin="flat" rgb1="1 1 1" rgb2="1 1 1" width="64" height="64"/></asset>
  <worldbody>
    <light pos="2 -3 8" dir="0 0.3 -1"/>
    <geom name="floor" type="box" size="{(layout.floor + 30) / 2} 30 0.1" pos="{(layout.floor - 30) / 2} 0 -0.1"
      rgba="0.85 0.85 0.85 1"/>
    {people}{walls}
    <body name="robot" pos="0 0 {WHEEL_RADIUS}">
      <freejoint/>
      <geom name="base" type="box" size="0.25 0.16 0.05" pos="0 0 0.05" mass="8" rgba="0.2 0.4 0.7 1"/>
      {casters}{wheels}{sites}
      <body name="arm" pos="0.2 0.13 0.14">
        <joint name="arm" axis="0 0 -1" range="0 100" limited="true" damping="1"/>
        <geom type="capsule" size="0.03" fromto="0 0 0 -0.45 0 0" mass="0.5" rgba="0.8 0.2 0.2 1"/>
      </body>
    </body>
    {load if layout.has_load else ""}
  </worldbody>
  <contact><exclude body1="robot" body2="arm"/></contact>
  <actuator>
    <velocity name="left" joint="left" kv="4"/>
    <velocity name="right" joint="right" kv="4"/>
    <position name="arm" joint="arm" kp="8" dampratio="1"/>
  </actuator>
  <sensor>{beams}</sensor>
</mujoco>
"""


@dataclass(frozen=True)
class Hit:
    """The robot, at a `speed` in m/s, or its arm or load, hit something: `what` that was."""

    time: float
    what: str
    speed: float


class World:
    """The physics, and a robot that does what it is told last."""

    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        self.model = mujoco.MjModel.from_xml_string(_xml(layout))
        self.data = mujoco.MjData(self.model)
        self.charge = layout.charge
        self.hit: Hit | None = None
        self.driven = 0.0
        self.nearest = math.inf
        self._twist = (0.0, 0.0)
        self._told = 0.0
        self._target: Point | None = None
        self._limit = 1.0
        self._obeys: Mapping[str, Callable[[Mapping[str, object]], None]] = {
            "/cmd_vel": self._turn_wheels,
            "/arm": self._swing,
            "/goal": self._go_to_place,
            "/goto": self._go_to,
            "/speed_limit": self._cap,
        }
        mujoco.mj_forward(self.model, self.data)

    @property
    def time(self) -> float:
        """The simulated time, in s."""
        return round(float(self.data.time), 6)

    @property
    def position(self) -> Point:
        """Where the robot is, in m."""
        x, y, _ = map(float, self.data.body("robot").xpos)
        return x, y

    @property
    def yaw(self) -> float:
        """Where the robot looks, in rad: 0 along the x axis, positive to the left."""
        w, x, y, z = map(float, self.data.body("robot").xquat)
        return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))

    @property
    def speed(self) -> float:
        """How fast the robot moves forwards, in m/s."""
        vx, vy, _ = map(float, self.data.joint(0).qvel[:3])
        return vx * math.cos(self.yaw) + vy * math.sin(self.yaw)

    @property
    def has_fallen(self) -> bool:
        """Whether the robot has fallen off the floor."""
        return float(self.data.body("robot").xpos[2]) < 0

    @property
    def tilt(self) -> float:
        """How far the load has tilted, in degrees."""
        return math.degrees(math.acos(max(-1.0, min(1.0, float(self.data.body("load").xmat[8])))))

    def obey(self, message: Message) -> None:
        """A command has come."""
        topic, values = message
        self._obeys[topic](values)

    def _turn_wheels(self, values: Mapping[str, object]) -> None:
        self._twist = _number(values, "linear/x"), _number(values, "angular/z")
        self._told, self._target = self.time, None

    def _swing(self, values: Mapping[str, object]) -> None:
        self.data.ctrl[2] = _number(values, "data")

    def _go_to_place(self, values: Mapping[str, object]) -> None:
        self._target = self.layout.places[str(values["data"])]

    def _go_to(self, values: Mapping[str, object]) -> None:
        x, y = _number(values, "pose/position/x"), _number(values, "pose/position/y")
        self._target = (x, y) if math.isfinite(x + y) else None

    def _cap(self, values: Mapping[str, object]) -> None:
        self._limit = _number(values, "data")

    def step(self) -> None:
        """Let a tick pass."""
        forward, turn = self._twist if self.time - self._told < TIMEOUT else (0.0, 0.0)
        if self._target is not None:
            forward, turn = self._towards(self._target)
        if self.charge <= 0:
            forward = turn = 0.0
        difference = turn * WHEEL_DISTANCE / 2
        self.data.ctrl[:2] = (forward - difference) / WHEEL_RADIUS, (forward + difference) / WHEEL_RADIUS
        for n, person in enumerate(self.layout.people):
            self.data.mocap_pos[n, :2] = person.at(self.time)
        before, speed = self.position, self.speed
        mujoco.mj_step(self.model, self.data, STEPS)
        self.driven += math.dist(before, self.position)
        self._charge()
        self.nearest = min(self.nearest, self._clearance())
        self.hit = self.hit or self._contact(speed)

    def _towards(self, place: Point) -> tuple[float, float]:
        """What the robot's own navigation does to get to a place: straight there, whatever is in the way."""
        (x, y), distance = self.position, math.dist(self.position, place)
        bearing = math.remainder(math.atan2(place[1] - y, place[0] - x) - self.yaw, 2 * math.pi)
        if distance < 0.1:
            return 0.0, 0.0
        return min(self._limit, distance) * max(0.0, math.cos(bearing)) ** 4, 3 * bearing

    def _charge(self) -> None:
        """The battery drains, and is charged at the dock."""
        dock = self.layout.places.get("dock")
        if dock is not None and math.dist(dock, self.position) < 0.3:
            self.charge = min(1.0, self.charge + 0.05 * TICK / 1000)
        else:
            self.charge = max(0.0, self.charge - self.layout.drain * TICK / 1000)

    def _clearance(self) -> float:
        """How far the nearest person is from the base, in m; 0 where they touch."""
        base = self.model.geom("base").id
        gaps = (
            mujoco.mj_geomDistance(self.model, self.data, base, self.model.body(f"person{n}").geomadr[0], SEEN, None)
            for n in range(len(self.layout.people))
        )
        return max(0.0, min(gaps, default=math.inf))

    def _contact(self, speed: float) -> Hit | None:
        """What the robot touches that it should not."""
        for pair in self.data.contact.geom:
            one, other = map(self._named, pair)
            for own, what in ((one, other), (other, one)):
                if own in {"robot", "load"} and what.startswith(("person", "wall")):
                    return Hit(self.time, what.rstrip("0123456789"), abs(speed))
        return None

    def _named(self, geom: int) -> str:
        """The thing that `geom` is a part of."""
        name: str = self.model.body(self.model.body_rootid[self.model.geom_bodyid[geom]]).name
        return name

    def scan(self) -> Message:
        """What the lidar sees."""
        ranges = [math.inf if beam < 0 or beam >= SEEN else beam for beam in map(float, self.data.sensordata)]
        return "/scan", {"range_max": SEEN, "angle_increment": 2 * math.pi / BEAMS, "ranges": ranges}

    def odometry(self) -> Message:
        """Where the robot is and how it moves."""
        x, y = self.position
        pose = {"pose/pose/position/x": x, "pose/pose/position/y": y}
        turned = {"pose/pose/orientation/z": math.sin(self.yaw / 2), "pose/pose/orientation/w": math.cos(self.yaw / 2)}
        return "/odom", {**pose, **turned, "twist/twist/linear/x": self.speed}

    def joints(self) -> Message:
        """How far the arm is swung out, in rad."""
        return "/joint_states", {"name": ["arm"], "position": [float(self.data.joint("arm").qpos[0])]}

    def battery(self) -> Message:
        """How full the battery is, 0 to 1."""
        return "/battery", {"percentage": self.charge}


def _number(values: Mapping[str, object], path: str) -> float:
    value = values[path]
    assert isinstance(value, int | float)
    return float(value)
