"""A value for each parameter, and for each input what it is from which time on."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from ltlc.dataclass import dataclass

Scalar = float | int | str
Course = tuple[tuple[float, Scalar], ...]
"""What an input is from each time on, in s since the simulation began; the first is 0."""


@dataclass(frozen=True)
class Assignment:
    """The `values` by name, of inputs with their times, and for how many `seconds` to simulate, if that is not None."""

    values: Mapping[str, Scalar | Course]
    seconds: float | None = None

    def document(self) -> dict[str, Any]:
        """What a simulation gets as JSON: `values`, and `seconds` among them."""
        found: dict[str, Any] = {
            name: [list(step) for step in value] if isinstance(value, tuple) else value
            for name, value in self.values.items()
        }
        return found if self.seconds is None else {**found, "seconds": self.seconds}

    @property
    def key(self) -> str:
        """A text that only equal assignments have."""
        return json.dumps(self.document())

    def __str__(self) -> str:
        """On one line: `speed=0.7 throttle=0.2,1@3.5`."""
        parts = [f"{name}={text_of(value)}" for name, value in self.values.items()]
        return " ".join(parts if self.seconds is None else [*parts, f"seconds={self.seconds:g}"])


def at(course: Course, time: float) -> Scalar:
    """What an input is at a time, in s."""
    return next(value for since, value in reversed(course) if since <= time)


def merged(course: Course) -> Course:
    """The same, without control points at which nothing changes."""
    return tuple(step for n, step in enumerate(course) if not n or course[n - 1][1] != step[1])


def text_of(value: Scalar | Course) -> str:
    """A value for people: of an input, after `@`, from which second on it has the next one."""
    if not isinstance(value, tuple):
        return scalar_text(value)
    return ",".join(scalar_text(each) if not time else f"{scalar_text(each)}@{time:.9g}" for time, each in value)


def scalar_text(value: Scalar) -> str:
    """A number without a superfluous point, or a word."""
    return f"{value:.12g}" if isinstance(value, float) else str(value)
