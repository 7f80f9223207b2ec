"""A robot with two wheels follows a winding lane to a wall, simulated with MuJoCo; its software has a fault, or none.

python examples/falsify/robot.py FAULT PARAMETERS.json RECORDING.csv
"""

from __future__ import annotations

import csv
import json
import math
import sys
from collections import deque
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import mujoco

FAULTS = (
    "none",
    "a heavy load delays the brakes",
    "the planner expects more grip than any floor has",
    "the range is smoothed, so it lags",
    "the slope has the wrong sign",
    "commands are late when the battery is low",
    "the integrator of the speed controller winds up",
    "the damping of the yaw rate has the wrong sign when the robot turns fast",
    "the heading drifts in bends, the more so the heavier the load",
    "the brakes fade when the battery is low",
    "the stop button brakes too gently with a heavy load",
)
"""What is wrong, by number."""

PARAMETERS = (
    "cruise=0.4..0.8..1.4",
    "load=0..5..20",
    "grip=0.4..0.8..1",
    "slope=-0.12..0..0.12",
    "battery=21..25..29",
    "bend=0..0.5..1.5",
    "wall=3..4..6",
    "stop=1..4..8",
)
"""What may change: the speed (m/s), the load (kg), the friction of the floor, its slope (rad, positive downhill), the
battery (V), how often the lane winds (rad/m), where the wall is (m), and when the stop button is pressed (s).
"""

SECONDS = 8.0
TICK = 0.02
"""How long is simulated, and the period of the controller, in s."""

GRAVITY = 9.81
RADIUS = 0.1
WIDTH = 0.4
"""The radius of the wheels, and the distance between them, in m."""

RESERVE = 0.4
"""How far from the wall the robot is to stand, in m."""

SWAY = 0.4
"""How far the lane winds to each side, in m."""


class Robot:
    """The physics, the sensors, and the software, which has a fault."""

    def __init__(self, given: Mapping[str, Any], fault: int) -> None:
        self.given = given
        self.fault = fault
        self.model = mujoco.MjModel.from_xml_string(_world(given))
        self.data = mujoco.MjData(self.model)
        self.data.qpos[3] = math.atan(SWAY * given["bend"])
        self.mass = 16.0 + given["load"]
        self.integral = self.turned = self.wanted = self.rolled = 0.0
        self.seen = float(given["wall"])
        self.forces = deque([0.0] * 20, maxlen=20)

    @property
    def time(self) -> float:
        """The simulated time, in s."""
        return float(self.data.time)

    @property
    def yaw(self) -> float:
        """The heading, in rad."""
        return float(self.data.qpos[3])

    @property
    def speed(self) -> float:
        """Forwards, in m/s."""
        return float(self.data.qvel[0] * math.cos(self.yaw) + self.data.qvel[1] * math.sin(self.yaw))

    @property
    def range(self) -> float:
        """How far the wall is, in m."""
        return float(self.given["wall"] - self.data.qpos[0])

    @property
    def deviation(self) -> float:
        """How far the robot is to the left of its lane, in m."""
        return float(self.data.qpos[1]) - SWAY * math.sin(self.given["bend"] * self.data.qpos[0])

    @property
    def is_pressed(self) -> bool:
        """Whether the stop button is."""
        return self.time >= self.given["stop"]

    def row(self) -> dict[str, Any]:
        """What is recorded."""
        return {
            "time": round(self.time, 3),
            "range": self.range,
            "speed": self.speed,
            "deviation": self.deviation,
            "pressed": self.is_pressed,
            "rolled": self.rolled,
        }

    def step(self) -> None:
        """Let the controller run once, and the physics until it runs again."""
        bend, x = self.given["bend"], float(self.data.qpos[0])
        lane = math.atan(SWAY * bend * math.cos(bend * x))
        curvature = -SWAY * bend**2 * math.sin(bend * x) * math.cos(lane) ** 3
        force, torque = self._force(self._planned(curvature)), self._torque(lane, curvature)
        self.data.ctrl[:] = (force / 2 - torque / WIDTH) * RADIUS, (force / 2 + torque / WIDTH) * RADIUS
        mujoco.mj_step(self.model, self.data, round(TICK / self.model.opt.timestep))
        if self.is_pressed:
            self.rolled += self.speed * TICK

    def _planned(self, curvature: float) -> float:
        """The speed that the software wants, in m/s."""
        grip = 1.15 if self.fault == 2 else self.given["grip"]
        brake = 0.5 * GRAVITY * grip - self._downhill()
        self.seen += (0.22 if self.fault == 3 else 1.0) * (self.range - self.seen)
        fast = min(
            self.given["cruise"],
            math.sqrt(2 * 0.7 * brake * max(self.seen - RESERVE, 0.0)),
            math.sqrt(0.25 * GRAVITY * grip / max(abs(curvature), 1e-9)),
        )
        if not self.is_pressed:
            self.wanted = min(fast, self.wanted + 1.0 * TICK)
        else:
            gentle = 1 / (1 + 0.15 * self.given["load"]) if self.fault == 10 else 1.0
            self.wanted = max(0.0, min(fast, self.wanted - 0.7 * brake * gentle * TICK))
        return self.wanted

    def _downhill(self) -> float:
        """What the software takes for the acceleration by the slope, in m/s²."""
        found = GRAVITY * math.sin(self.given["slope"])
        return -found if self.fault == 4 else found

    def _force(self, wanted: float) -> float:
        """The force of the motors forwards, in N: a PI controller."""
        error = wanted - self.speed
        force = self.mass * (6 * error + self.integral - self._downhill())
        strongest = 0.75 * self.given["grip"] * GRAVITY * self.mass
        limited = max(-strongest, min(strongest, 2.0 * self.given["battery"], force))
        if limited == force or self.fault == 6:
            self.integral += 4 * error * TICK
        if self.fault == 9 and limited < 0:
            limited *= 1 - 0.055 * (29 - self.given["battery"])
        self.forces.append(limited)
        return self.forces[-1 - round(self._late(limited) / TICK)]

    def _late(self, force: float) -> float:
        """How long a force is delayed, in s."""
        if self.fault == 1 and force < 0:
            return float(0.009 * self.given["load"])
        if self.fault == 5:
            return float(0.02 * (29 - self.given["battery"]))
        return 0.0

    def _torque(self, lane: float, curvature: float) -> float:
        """The torque that the wheels turn the robot with, in Nm."""
        rate = float(self.data.qvel[3])
        self.turned += rate * TICK
        drift = 0.014 * self.given["load"] * self.turned if self.fault == 8 else 0.0
        wanted = curvature * self.speed - 3 * self.deviation * self.speed - 3 * (self.yaw + drift - lane)
        damping = rate * (1 - 0.22 * rate**2) if self.fault == 7 else rate
        inertia = 0.5 + 0.02 * self.given["load"]
        return max(-8.0, min(8.0, 10 * inertia * (wanted - damping)))


def _world(given: Mapping[str, Any]) -> str:
    slope, load = given["slope"], given["load"]
    return f"""
<mujoco>
  <option timestep="0.005" integrator="implicitfast" cone="elliptic" impratio="10"
          gravity="{GRAVITY * math.sin(slope)} 0 {-GRAVITY * math.cos(slope)}"/>
  <default><geom friction="0.01" condim="3"/><joint axis="0 1 0" armature="0.005"/></default>
  <worldbody>
    <geom type="plane" size="20 20 1" friction="{given["grip"]}"/>
    <body pos="0 0 {RADIUS}">
      <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/><joint type="slide" axis="0 0 1"/>
      <joint type="hinge" axis="0 0 1"/>
      <geom type="box" size="0.25 0.15 0.05" pos="0 0 0.1" mass="{15 + load}" contype="0" conaffinity="0"/>
      <body pos="0 {-WIDTH / 2} 0"><joint name="right"/><geom type="ellipsoid" size="0.1 0.02 0.1" mass="0.5"/></body>
      <body pos="0 {WIDTH / 2} 0"><joint name="left"/><geom type="ellipsoid" size="0.1 0.02 0.1" mass="0.5"/></body>
    </body>
  </worldbody>
  <actuator><motor joint="left"/><motor joint="right"/></actuator>
</mujoco>
"""


def simulate(given: Mapping[str, Any], fault: int) -> list[dict[str, Any]]:
    """The rows of a run with these parameters."""
    robot, rows = Robot(given, fault), []
    while robot.time < SECONDS - TICK / 2:
        rows.append(robot.row())
        robot.step()
    return rows


def main(arguments: Sequence[str]) -> None:
    """Simulate, and write a recording."""
    fault, parameters, recording = arguments
    rows = simulate(json.loads(Path(parameters).read_text(encoding="utf-8")), int(fault))
    with Path(recording).open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows({key: str(value).lower() for key, value in row.items()} for row in rows)


if __name__ == "__main__":
    main(sys.argv[1:])
