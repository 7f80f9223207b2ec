"""A run that was found by trying, made simpler: fewer messages, rounder delays and values."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple

from ltlc.assurance.sources import Sources
from ltlc.dataclass import dataclass
from ltlc.semantics.durations import UNITS, Nanoseconds
from ltlc.specification.evaluation import Single, Value
from ltlc.specification.expressions import Signal

MOST_TRIED = 1000
"""So many runs are tried at most to make one simpler."""

MOST_DIGITS = 6
"""To so many decimal places numbers are rounded."""


class Move(NamedTuple):
    """A message on a topic, or a command, so long after what came before, with the values of signals."""

    delay: Nanoseconds
    topic: str
    values: Mapping[Signal, Value]


@dataclass(frozen=True)
class Shrinking:
    """Makes runs simpler that stay `wanted`; the `first` messages remain. `sources` are those of each topic."""

    wanted: Callable[[list[Move]], bool]
    first: int
    sources: Mapping[str, Sources]

    def __call__(self, moves: list[Move]) -> list[Move]:
        """The simplest run like `moves` that was found."""
        left = MOST_TRIED
        for simpler in (self._shorter, self._sooner, self._rounder, self._shorter):
            for number in reversed(range(len(moves))):
                others = simpler(moves, number)
                while left and (other := next(others, None)) is not None:
                    left -= 1
                    if self.wanted(other):
                        moves, others = other, simpler(other, number)
        return moves

    def _shorter(self, moves: list[Move], number: int) -> Iterator[list[Move]]:
        if self.first <= number < len(moves) - 1:
            gone, after = moves[number : number + 2]
            for delay in (after.delay, gone.delay + after.delay):
                yield [*moves[:number], after._replace(delay=delay), *moves[number + 2 :]]

    def _sooner(self, moves: list[Move], number: int) -> Iterator[list[Move]]:
        for delay in _rounder_delays(moves[number].delay):
            yield [*moves[:number], moves[number]._replace(delay=delay), *moves[number + 1 :]]

    def _rounder(self, moves: list[Move], number: int) -> Iterator[list[Move]]:
        move = moves[number]
        for signal, value in move.values.items():
            for other in _simpler_values(value):
                values = self.sources[move.topic].possible({**move.values, signal: other})
                if values != move.values:
                    yield [*moves[:number], move._replace(values=values), *moves[number + 1 :]]


def _rounder_delays(delay: Nanoseconds) -> Iterator[Nanoseconds]:
    """An instant, then delays with fewer digits."""
    units = (UNITS["s"], UNITS["s"] // 10, UNITS["s"] // 100, UNITS["ms"])
    near = {delay // unit * unit + more for unit in units for more in (0, unit)} - {0}
    yield from (each for each in sorted({1, *near}, key=_length) if _length(each) < _length(delay))


def _length(delay: Nanoseconds) -> tuple[bool, int, Nanoseconds]:
    return delay != 1, len(str(delay).rstrip("0")), delay


def _simpler_values(value: Value) -> Iterator[Value]:
    """Shorter arrays, and numbers with fewer digits."""
    if isinstance(value, tuple):
        yield from (value[:n] + value[n + 1 :] for n in range(len(value)) if len(value) > 1)
        yield from ((*value[:n], e, *value[n + 1 :]) for n, old in enumerate(value) for e in _simpler(old))
    else:
        yield from _simpler(value)


def _simpler(value: Single) -> Iterator[Single]:
    if isinstance(value, bool):
        yield from [False] if value else []
    elif isinstance(value, str):
        yield from [""] if value else []
    else:
        scales = [10.0**digits for digits in range(MOST_DIGITS + 1)]
        near = {round_(value * scale) / scale for scale in scales for round_ in (math.floor, math.ceil)}
        yield from (each for each in sorted({0.0, 1.0, *near}, key=_digits) if _digits(each) < _digits(value))


def _digits(number: float) -> tuple[int, float]:
    return len(repr(float(number))), abs(number)
