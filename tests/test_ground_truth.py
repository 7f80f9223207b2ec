"""What every primitive says of every source of ground truth, by tables and geometry of its own."""

from __future__ import annotations

import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest
from ros_support import emitted_text

from ltlc.assurance.programs import load


def xyz(x: float, y: float, z: float) -> SimpleNamespace:
    return SimpleNamespace(x=x, y=y, z=z)


BEFORE, POSITION = xyz(1.0, 2.0, 4.0), xyz(2.0, 0.0, 5.0)
LINEAR, ANGULAR = xyz(3.0, 4.0, 12.0), xyz(0.25, -0.5, 0.5)
ORIENTATION = SimpleNamespace(x=0.1, y=-0.4, z=0.2, w=0.6)
SECONDS = 0.5
"""Between the two messages; in the first one the position is BEFORE."""


def of(one: Any, other: Any) -> list[Any]:
    """Lists in which the robot is neither first nor the only one."""
    return [other, one, other]


def pose(position: Any) -> SimpleNamespace:
    return SimpleNamespace(position=position, orientation=ORIENTATION)


def transform(name: str, position: Any) -> SimpleNamespace:
    moved = SimpleNamespace(translation=position, rotation=ORIENTATION)
    return SimpleNamespace(child_frame_id=name, header=SimpleNamespace(frame_id="map"), transform=moved)


NOWHERE, AT_REST = pose(xyz(9.0, 9.0, 9.0)), SimpleNamespace(linear=xyz(7.0, 7.0, 7.0), angular=xyz(8.0, 8.0, 8.0))
TWIST = SimpleNamespace(linear=LINEAR, angular=ANGULAR)
MESSAGES: dict[str, Callable[[Any], Any]] = {
    "Odometry": lambda at: SimpleNamespace(pose=SimpleNamespace(pose=pose(at)), twist=SimpleNamespace(twist=TWIST)),
    "PoseStamped": lambda at: SimpleNamespace(pose=pose(at)),
    "Pose": pose,
    "TFMessage": lambda at: SimpleNamespace(transforms=of(transform("robot", at), transform("cone", xyz(9, 9, 9)))),
    "ModelStates": lambda at: SimpleNamespace(
        name=of("robot", "cone"), pose=of(pose(at), NOWHERE), twist=of(TWIST, AT_REST)
    ),
}


def rotated(vector: tuple[float, float, float]) -> tuple[float, float, float]:
    """q v q*, for the quaternion q of ORIENTATION."""
    q = (ORIENTATION.w, ORIENTATION.x, ORIENTATION.y, ORIENTATION.z)
    _, x, y, z = times(times(q, (0.0, *vector)), (q[0], -q[1], -q[2], -q[3]))
    return x, y, z


Quaternion = tuple[float, float, float, float]


def times(p: Quaternion, q: Quaternion) -> Quaternion:
    """Hamilton's product; the real part comes first."""
    (a, b, c, d), (e, f, g, h) = p, q
    return (
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g - b * h + c * e + d * f,
        a * h + b * g - c * f + d * e,
    )


AHEAD, LEFT, UP = rotated((1, 0, 0)), rotated((0, 1, 0)), rotated((0, 0, 1))
YAW = math.atan2(AHEAD[1], AHEAD[0])
POSES = {
    "position.x": 2.0,
    "position.y": 0.0,
    "position.z": 5.0,
    "distance.sign": 5.0,
    "distanceZ.sign": 13.0,
    "orientation": YAW,
    "orientation.yaw": YAW,
    "orientation.pitch": math.atan2(-AHEAD[2], math.hypot(AHEAD[0], AHEAD[1])),
    "orientation.roll": math.atan2(LEFT[2], UP[2]),
}
TWISTS = {
    "velocity": 13.0,
    "velocity.x": 3.0,
    "velocity.y": 4.0,
    "velocity.linear.z": 12.0,
    "velocity.angular.x": 0.25,
    "velocity.angular.y": -0.5,
    "velocity_angular": 0.75,
}
SLOPES = {"velocity.x": 2.0, "velocity.y": -4.0, "velocity.linear.z": 2.0, "velocity": math.sqrt(24.0)}
TRUTH = {kind: POSES | (TWISTS if kind in ("Odometry", "ModelStates") else SLOPES) for kind in MESSAGES}


@pytest.mark.parametrize("kind", MESSAGES)
def test_a_primitive_is_what_geometry_says_of_the_messages(kind: str) -> None:
    lines = [f"object robot /truth {kind}", "object sign at (5, -4, 17)"]
    lines += [f"never robot.{primitive} == 1e9" for primitive in TRUTH[kind]]
    node = load(emitted_text("\n".join(lines)), "node")
    session = node["Session"](node["plan"]())
    rows = node["ByRows"](session)
    [topic] = node["topics_to_read"]()
    for time, position in ((10**9, BEFORE), (10**9 + round(SECONDS * 10**9), POSITION)):
        rows.message(time, topic.name, topic.read(MESSAGES[kind](position)))
    signals = [track.property.inputs[0].signal for track in session.tracks]
    found = [session.sampler.values(signal)[0] for signal in signals]
    assert dict(zip(TRUTH[kind], found, strict=True)) == pytest.approx(TRUTH[kind])


def test_the_angle_between_two_orientations_is_that_of_the_rotation_from_one_to_the_other() -> None:
    text = "object robot /a Pose\nobject cone /b Pose\nnever robot.orientation_between.cone == 1e9"
    node = load(emitted_text(text), "node")
    session = node["Session"](node["plan"]())
    rows = node["ByRows"](session)
    turned = SimpleNamespace(x=0.0, y=0.0, z=math.sin(0.4), w=math.cos(0.4))
    for topic, orientation in zip(node["topics_to_read"](), (ORIENTATION, turned), strict=True):
        message = SimpleNamespace(position=POSITION, orientation=orientation)
        rows.message(10**9, topic.name, topic.read(message))
    q, p = ORIENTATION, turned
    cosine = (q.x * p.x + q.y * p.y + q.z * p.z + q.w * p.w) / math.hypot(q.x, q.y, q.z, q.w)
    [found] = session.sampler.values("robot.orientation_between.cone")
    assert found == pytest.approx(2 * math.acos(abs(cosine)))
