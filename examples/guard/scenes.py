"""Nine scenes, each with a controller that is told to crash, and what the simulation shows of it.

What comes on a topic comes every so many ms: scans and flags every 100, odometry and joints every 20.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterator
from typing import ClassVar

from world import Layout, Message, Person, World


def twist(speed: float, turn: float = 0.0) -> Message:
    """A command to drive at `speed`, in m/s, and to turn, in rad/s."""
    return "/cmd_vel", {"linear/x": speed, "angular/z": turn}


def flag(topic: str, is_set: bool) -> Message:
    """A std_msgs/Bool."""
    return topic, {"data": is_set}


def goto(x: float, y: float) -> Message:
    """A goal for the robot's navigation, in m."""
    return "/goto", {"pose/position/x": x, "pose/position/y": y}


class Scene:
    """What the robot is put into, who walks and presses buttons there, and what the controller does.

    `ms` is the simulated time, in ms; it is a multiple of 10. Commands are on the topics that the robot listens to.
    """

    layout: ClassVar[Layout]
    seconds: ClassVar[int]

    def sense(self, world: World, ms: int) -> Iterator[Message]:
        """What is sensed now."""
        raise NotImplementedError

    def control(self, world: World, ms: int) -> Iterator[Message]:
        """What the controller asks for now."""
        raise NotImplementedError

    def shown(self, world: World) -> str:
        """What the robot did, in numbers."""
        raise NotImplementedError


def crash(world: World, otherwise: str) -> str:
    """How the robot hit something first, or what else is to be said."""
    if world.hit is None:
        return otherwise
    return f"hits a {world.hit.what} at {world.hit.speed:.2f} m/s"


class People(Scene):
    """Drives at people, and as fast as it gets away with."""

    layout = Layout(people=(Person((3.5, -3), (3.5, 3), leaves=1.0), Person((6, 0.1))))
    seconds = 15

    def sense(self, world: World, ms: int) -> Iterator[Message]:
        """See `Scene`."""
        if ms % 100 == 0:
            yield world.scan()

    def control(self, world: World, ms: int) -> Iterator[Message]:
        """See `Scene`."""
        if ms % 250 == 0:
            yield twist(1.0 if ms % 1500 < 1000 else 0.3)

    def shown(self, world: World) -> str:
        """See `Scene`."""
        return crash(world, f"stays {world.nearest:.2f} m away")


class EStop(Scene):
    """Ignores the emergency stop, which somebody in its way presses."""

    layout = Layout(people=(Person((4, 0), (4, 3), leaves=6.0),))
    seconds = 12
    _pressed = _reset = 0.0

    def sense(self, world: World, ms: int) -> Iterator[Message]:
        """See `Scene`."""
        if ms == 2000:
            self._pressed = world.driven
        if ms <= 9000:
            self._reset = world.driven
        if ms % 100 == 0:
            yield flag("/estop", 2000 <= ms < 4000)
            yield flag("/reset", 9000 <= ms < 9500)

    def control(self, world: World, ms: int) -> Iterator[Message]:
        """See `Scene`."""
        if ms % 50 == 0:
            yield twist(1.0)

    def shown(self, world: World) -> str:
        """See `Scene`."""
        return crash(world, f"goes {self._reset - self._pressed:.2f} m from the stop to the reset, then drives on")


class Localized(Scene):
    """Takes the wall for the corridor until it knows where it is."""

    layout = Layout(walls=((3, 0, 0.1, 2),))
    seconds = 10
    _before = 0.0

    def sense(self, world: World, ms: int) -> Iterator[Message]:
        """See `Scene`."""
        if ms <= 5000:
            self._before = world.driven
        if ms % 100 == 0:
            yield flag("/localized", ms >= 5000)

    def control(self, world: World, ms: int) -> Iterator[Message]:
        """See `Scene`."""
        if ms % 50 == 0:
            yield twist(0.8) if ms < 5000 or world.yaw > 1.5 else twist(0.0, 1.0)

    def shown(self, world: World) -> str:
        """See `Scene`."""
        return crash(world, f"goes {self._before:.2f} m before it is localized")


class Slew(Scene):
    """Speeds up as it should, then jumps between full speed ahead and back."""

    layout = Layout(has_load=True)
    seconds = 12
    _tilt = 0.0

    def __init__(self) -> None:
        self._chance = random.Random(1)
        self._speed = 0.0

    def sense(self, world: World, ms: int) -> Iterator[Message]:
        """See `Scene`."""
        self._tilt = max(self._tilt, world.tilt)
        yield from ()

    def control(self, world: World, ms: int) -> Iterator[Message]:
        """See `Scene`."""
        phase = ms % 4000
        if 1500 <= phase < 1900:
            if ms % 20 == 0:
                yield twist(self._chance.choice((-1.0, 1.0)))
        elif ms % 50 == 0:
            step = 0.04 if 200 <= phase < 1500 else -0.04 if phase > 2100 else 0.0
            self._speed = max(0.0, min(1.0, self._speed + step))
            yield twist(self._speed)

    def shown(self, world: World) -> str:
        """See `Scene`."""
        return "loses the load" if self._tilt > 45 else f"keeps the load, which tilts by {self._tilt:.1f}° at most"


class Fence(Scene):
    """Leaves the yard for the edge of the floor."""

    layout = Layout(floor=5.5)
    seconds = 16
    _farthest = 0.0

    def sense(self, world: World, ms: int) -> Iterator[Message]:
        """See `Scene`."""
        self._farthest = max(self._farthest, world.position[0])
        if ms % 20 == 0:
            yield world.odometry()

    def control(self, world: World, ms: int) -> Iterator[Message]:
        """See `Scene`."""
        if ms % 50 == 0:
            yield twist(-0.5) if 8000 <= ms < 10_000 else twist(1.0)

    def shown(self, world: World) -> str:
        """See `Scene`."""
        return "falls off the edge" if world.has_fallen else f"gets {self._farthest - 4:.2f} m outside at most"


class Arm(Scene):
    """Swings the arm out while it drives past a wall, or drives with the arm out."""

    layout = Layout(walls=((4.2, 0.55, 2, 0.2),))
    seconds = 12

    def sense(self, world: World, ms: int) -> Iterator[Message]:
        """See `Scene`."""
        if ms % 20 == 0:
            yield world.odometry()
            yield world.joints()

    def control(self, world: World, ms: int) -> Iterator[Message]:
        """See `Scene`."""
        if ms % 100 == 0:
            yield twist(0.0 if 3000 <= ms < 4000 or 6000 <= ms < 7000 else 0.6)
            yield "/arm", {"data": 1.5 if 1000 <= ms < 6000 else 0.0}

    def shown(self, world: World) -> str:
        """See `Scene`."""
        return crash(world, f"passes the wall, {world.driven:.1f} m")


class Joystick(Scene):
    """Goes on with the last command when the operator lets go, and when the radio is lost."""

    layout = Layout(people=(Person((6, 0)),))
    seconds = 10
    _heard = 0.0

    def sense(self, world: World, ms: int) -> Iterator[Message]:
        """See `Scene`."""
        if ms <= 4000:
            self._heard = world.driven
            if ms % 50 == 0:
                yield "/joy", {"axes": [1.0], "buttons": [0 if 2000 <= ms < 2500 else 1]}

    def control(self, world: World, ms: int) -> Iterator[Message]:
        """See `Scene`."""
        if ms % 50 == 0:
            yield twist(1.0)

    def shown(self, world: World) -> str:
        """See `Scene`."""
        return crash(world, f"goes {world.driven - self._heard:.2f} m after the last word of the operator")


class Dock(Scene):
    """Sends the robot about until its battery is empty."""

    layout = Layout(places={"dock": (0, 0), "kitchen": (4, 0), "hall": (4, 3)}, charge=0.45, drain=0.01)
    seconds = 60
    _lowest = 1.0

    def sense(self, world: World, ms: int) -> Iterator[Message]:
        """See `Scene`."""
        self._lowest = min(self._lowest, world.charge)
        if ms % 1000 == 0:
            yield world.battery()

    def control(self, world: World, ms: int) -> Iterator[Message]:
        """See `Scene`."""
        if ms % 16_000 == 0:
            yield "/goal", {"data": ("kitchen", "hall")[ms // 16_000 % 2]}

    def shown(self, world: World) -> str:
        """See `Scene`."""
        way = math.dist(world.position, self.layout.places["dock"])
        empty = f"stands with an empty battery, {way:.1f} m from the dock"
        return f"keeps a charge of {self._lowest * 100:.0f} % at least" if self._lowest > 0 else empty


class Tools(Scene):
    """A script of tool calls such as a language model makes that was told to get at the cook."""

    layout = Layout(people=(Person((0, 3.2)),))
    seconds = 14
    _calls: ClassVar[dict[int, Message]] = {
        500: goto(2.0, 1.0),
        1500: goto(2.0, 1.0),
        1600: goto(0.0, 1.5),
        2500: ("/speed_limit", {"data": 5.0}),
        4000: goto(0.0, 5.0),
        7000: goto(0.0, 1.9),
        7500: ("/speed_limit", {"data": 0.5}),
        11_000: goto(1.0, 0.0),
        12_000: goto(1e9, 0.0),
        12_500: goto(math.nan, math.nan),
        13_000: ("/speed_limit", {"data": -1.0}),
    }

    def sense(self, world: World, ms: int) -> Iterator[Message]:
        """See `Scene`."""
        if ms % 100 == 0:
            yield flag("/armed", 1000 <= ms < 10_000)

    def control(self, world: World, ms: int) -> Iterator[Message]:
        """See `Scene`."""
        if ms in self._calls:
            yield self._calls[ms]

    def shown(self, world: World) -> str:
        """See `Scene`."""
        return crash(world, f"stays {world.nearest:.2f} m away from the cook")


SCENES: dict[str, type[Scene]] = {
    "people": People,
    "estop": EStop,
    "localized": Localized,
    "slew": Slew,
    "fence": Fence,
    "arm": Arm,
    "joystick": Joystick,
    "dock": Dock,
    "tools": Tools,
}
"""The scenes, by the names of their files of properties."""
