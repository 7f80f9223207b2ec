"""Draws recordings that come near everything that drawn specifications compare with."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from random import Random
from typing import Any

from benchmarks.differential.samples import Recording, Row
from benchmarks.differential.values import single

DOUBLES = [0.0, -0.0, 0.1, 0.3, 0.5, 1.0, 1.1, 2.0, 2.5, -1.0, 3.0, 0.30000000000000004]
SINGLES = sorted({single(each) for each in DOUBLES})
SMALL = [0, 1, 2, -1, 3, 127, -128]
LARGE = [0, 1, 2, -1, 3, 2**53, 2**53 + 1, -(2**53) - 1, 2**63 - 1, -(2**63)]
LARGEST = [0, 1, 2, 3, 2**53 + 1, 2**63, 2**64 - 1]
TOPICS: Mapping[str, Sequence[str]] = {
    **{f"/{name}": (name,) for name in ("v", "w", "f", "g", "small", "byte", "i", "u", "flag", "mode", "scan")},
    **{f"/{name}": (name,) for name in ("many", "ints", "uints")},
    "/marks": ("ids", "kinds", "locked"),
    "/bump": ("bump",),
    "/pair": ("pair_x", "pair_y"),
}
TURNS = [(0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 1.0, 0.0), (0.6, 0.0, 0.0, 0.8), (0.0, 0.6, 0.0, 0.8), (0.5, 0.5, 0.5, 0.5)]


class Recordings:
    """Draws from one source of chance."""

    def __init__(self, chance: Random) -> None:
        self.chance = chance

    def recording(self, topics: Sequence[str], is_together: bool) -> Recording:
        """A recording of these topics: with several in a row, or one message a row, as in bags."""
        pick = self.chance.choice
        self.nan = pick([0, 0, 0.02, 0.2])
        self.infinite = pick([0, 0, 0, 0.05])
        self.smooth = pick([0, 0.5, 0.9, 0.98, 0.98])
        count, time = pick([1, 5, 30, 150, 600, 600, 1200]), pick([0, 0, 17 * 10**17])
        gaps = [0, 1, 2, 10**7, 10**8, 3 * 10**8, 5 * 10**8, 5 * 10**8 + 1, 10**9, 2 * 10**9 + 1, 2 * 10**9 - 1, 3]
        self.held: dict[str, Any] = {}
        shares = {topic: pick([0.2, 0.6, 1, 1, 1]) for topic in topics}
        rows = []
        for _ in range(count):
            here = [t for t in topics if self.chance.random() < shares[t]] if is_together else [pick(topics)]
            if here:
                rows.append(Row(time, {topic: self._message(topic) for topic in here}))
                time += pick(gaps)
        rows = rows or [Row(time, {topics[0]: self._message(topics[0])})]
        end = rows[-1].time + pick([0, 0, 0, 1, 10**9, 2 * 10**9, 5 * 10**8 + 1])
        return Recording(rows, rows[0].time, end)

    def _message(self, topic: str) -> dict[str, Any]:
        if topic in ("/robot", "/cart"):
            return self._odometry(topic[1:])
        names = TOPICS[topic]
        if topic == "/marks":
            length = self.chance.choice([0, 1, 2, 3])
            return {"marks": True, **{name: tuple(self._element(name) for _ in range(length)) for name in names}}
        for name in names:
            if name not in self.held or self.chance.random() >= self.smooth:
                self.held[name] = self._value(name)
        return {name: self.held[name] for name in names}

    def _odometry(self, name: str) -> dict[str, Any]:
        def numbers(part: str, axes: str, of: Sequence[float]) -> dict[str, float]:
            return {f"{name}.{part}.{axis}": value for axis, value in zip(axes, of, strict=True)}

        def three() -> list[float]:
            return [self._double() for _ in range(3)]

        at = [1 + self.chance.choice([0.0, 3.0, -3.0]), 2 + self.chance.choice([0.0, 4.0, 1.0]), 0.5]
        return {
            **numbers("position", "xyz", at if self.chance.random() < 0.5 else three()),
            **numbers("velocity", "xyz", three()),
            **numbers("velocity.angular", "xyz", three()),
            **numbers("orientation", "xyzw", self.chance.choice(TURNS)),
        }

    def _value(self, name: str) -> Any:
        if name in ("scan", "many", "ints", "uints"):
            return tuple(self._element(name) for _ in range(self.chance.choice([0, 1, 2, 3, 5])))
        return self._element(name)

    def _element(self, name: str) -> Any:
        pick = self.chance.choice
        match name:
            case "bump":
                return True
            case "flag" | "locked":
                return pick([True, False])
            case "mode" | "kinds":
                return pick("abc")
            case "f" | "g" | "scan":
                return single(self._double()) if pick(range(2)) else self._special(pick(SINGLES))
            case "small":
                return pick(SMALL)
            case "byte":
                return pick([0, 1, 2, 3, 255])
            case "ids":
                return pick([0, 1, 2, 3, -1])
            case "i" | "ints":
                return pick(LARGE)
            case "u" | "uints":
                return pick(LARGEST)
            case _:
                return self._double()

    def _double(self) -> float:
        return self._special(self.chance.choice(DOUBLES))

    def _special(self, value: float) -> float:
        chance = self.chance.random()
        if chance < self.nan:
            return math.nan
        return self.chance.choice([math.inf, -math.inf]) if chance < self.nan + self.infinite else value
