"""The guards of two files, tried on runs until one lets a command through that the other one does not.

What comes is drawn, the same each time: values that conditions are compared with, at times when clocks expire. What is
found needs no proof, since the guards themselves part; that nothing is found proves nothing.
"""

from __future__ import annotations

import math
import random
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

from ltlc.analysis.guards.differences import Difference
from ltlc.analysis.guards.replaying import Replay
from ltlc.analysis.guards.rows import Rows
from ltlc.analysis.guards.shrinking import Move, Shrinking
from ltlc.assurance.messages import Messages
from ltlc.assurance.sources import read_at
from ltlc.assurance.values import Draws
from ltlc.monitoring.guarding.report import Done
from ltlc.runtime.guarding import Action
from ltlc.runtime.times import SECOND
from ltlc.semantics.durations import UNITS, Nanoseconds
from ltlc.specification.evaluation import Single, Value
from ltlc.specification.expressions import Field, Signal

MOST_STEPS = 2000
"""Runs are tried until they have so many messages and times at which clocks expire."""

MOST_DRAWN = 10
"""So many messages are drawn in search of one without empty arrays, of which little has a value."""

MOST_MOVES = 20
"""So many messages a run has at most."""


class _Taken(NamedTuple):
    """What both guards did before a move and after it, if that is `alike`, and the file whose guard `passes` it alone.

    If nothing is alike, and none passes, they part in another way, or have lost.
    """

    before: Sequence[Done] = ()
    after: Sequence[Done] = ()
    is_alike: bool = False
    passes: str | None = None


class Trial:
    """Tries the guards of two files, which send on `out`."""

    def __init__(self, sides: Sequence[Replay], out: str, messages: Messages) -> None:
        """`messages` are those of both files."""
        self._sides, self._out = sides, out
        self._draws = _draws(sides, messages)
        outs = [topic for side in sides for topic in side.raws]
        self._sources = {topic: draws.sources for topic, draws in self._draws.items()}
        self._shared = {topic for topic in outs if all(topic in side.raws for side in sides)}
        self._topics = dict.fromkeys([*self._draws, *outs])
        self._first = [topic for topic in self._draws if any(topic in side.heard for side in sides)]
        self._chance = random.Random(0)
        self._time: Nanoseconds = SECOND
        self._steps = 0
        self.tried = 0
        """So many runs were tried."""

    def checked(self, difference: Difference) -> Difference:
        """A difference without its example if that does not make it."""
        named = {side.name: side for side in self._sides}
        makes_it = named[difference.passes].passes(difference) and not named[difference.refuses].passes(difference)
        return difference if makes_it else replace(difference, example=None)

    def differences(self, wanted: Collection[str]) -> dict[str, Difference]:
        """Runs at whose end the guard of a file `wanted` lets a command through that the other's does not, by file."""
        found: dict[str, Difference] = {}
        while self._steps < MOST_STEPS and not found.keys() >= set(wanted):
            self.tried += 1
            moves, passes = self._drawn()
            if passes is not None and passes in wanted and passes not in found:
                shrinking = Shrinking(partial(self._parts, passes), len(self._first), self._sources)
                found[passes] = self._difference(shrinking(moves))
        return found

    def _drawn(self) -> tuple[list[Move], str | None]:
        """A run up to where the guards part, and the file whose guard then lets a command through, if one does."""
        self._begin()
        moves: list[Move] = []
        for number in range(MOST_MOVES):
            is_first = number < len(self._first)
            topic = self._first[number] if is_first else self._chance.choice([self._out, self._out, *self._topics])
            moves.append(Move(1 if is_first else self._delay(), topic, self._values(topic, moves)))
            taken = self._take(moves[-1])
            if not taken.is_alike:
                return moves, taken.passes
        return moves, None

    def _begin(self, *, explained: bool = False) -> None:
        self._time = SECOND
        for side in self._sides:
            side.begin(explained=explained)

    def _delay(self) -> Nanoseconds:
        """Until a clock expires, or a nanosecond before or after that; or some time."""
        dues = self._dues()
        if dues and self._chance.random() < 0.5:
            return max(0, self._chance.choice(dues) + self._chance.choice([-1, 0, 1]) - self._time)
        return self._chance.choice([0, 1, 1, UNITS["ms"], 10 * UNITS["ms"], 100 * UNITS["ms"], SECOND])

    def _values(self, topic: str, moves: Sequence[Move]) -> Mapping[Signal, Value]:
        """What a message on a topic says; often what the last one has said."""
        if topic not in self._draws:
            return {}
        said = [move.values for move in moves if move.topic == topic]
        if said and self._chance.random() < 0.25:
            return said[-1]
        draws = self._draws[topic]
        drawn = (draws.even() if self._chance.random() < 0.5 else draws.draw() for _ in range(MOST_DRAWN))
        frame = next((each for each in drawn if () not in each.sample.values()), None) or draws.draw()
        return draws.sources.possible({signal: _finite(value) for signal, value in frame.sample.items()})

    def _fields(self, move: Move) -> dict[Field, Value]:
        return {self._sources[move.topic].places[signal].field: value for signal, value in move.values.items()}

    def _take(self, move: Move) -> _Taken:
        self._time += move.delay
        before: list[Done] = []
        while (due := min(self._dues(), default=None)) is not None and due <= self._time:
            acted = [side.take(due, None, {}) for side in self._sides]
            self._steps += 1
            if not self._is_alike(acted):
                return _Taken()
            before += acted[0]
        values = self._fields(move)
        after = [side.take(self._time, move.topic, values) for side in self._sides]
        self._steps += 1
        if move.topic == self._out:
            passing = [side.name for side in self._sides if side.last(self._out).deed.action is Action.PASSED]
            if len(passing) == 1:
                return _Taken(before, passes=passing[0])
        return _Taken(before, after[0], is_alike=self._is_alike(after))

    def _dues(self) -> list[Nanoseconds]:
        """When something may happen by time alone."""
        return [due for side in self._sides if (due := side.due()) is not None]

    def _is_alike(self, done: Iterable[Sequence[Done]]) -> bool:
        """Whether the same has left both sides, and none has lost, or changed what is no command for the other one."""
        left: list[list[object]] = []
        for side, some in zip(self._sides, done, strict=True):
            left.append([])
            for deed in (each.deed for each in some):
                is_shared = self._shared.issuperset(deed.outs)
                if deed.action is Action.LOST or not (is_shared or deed.action is Action.PASSED):
                    return False
                if is_shared and deed.action is not Action.HELD:
                    left[-1].append((deed.time, deed.outs, side.content(deed)))
        return left[0] == left[1]

    def _parts(self, passes: str, moves: Sequence[Move]) -> bool:
        """Whether a run is alike up to its last command, which the guard of that file alone lets through."""
        self._begin()
        return all(self._take(move).is_alike for move in moves[:-1]) and self._take(moves[-1]).passes == passes

    def _difference(self, moves: Sequence[Move]) -> Difference:
        """A run that parts the guards, as it is shown."""
        self._begin(explained=True)
        read = [each for sources in self._sources.values() for each in sources.places.items()]
        rows = Rows(self._sides[0], {place.field: signal.name for signal, place in read if not signal.is_message})
        taken = _Taken()
        for move in moves:
            taken = self._take(move)
            rows.sent(taken.before)
            kind = "command" if move.topic in self._shared else "message"
            rows.message(self._time, self._fields(move), f"a {kind} on {move.topic}")
            rows.sent(taken.after)
        assert taken.passes is not None
        (refusing,) = (side for side in self._sides if side.name != taken.passes)
        topics, delays, _ = zip(*moves, strict=True)
        example, reason = rows.example(), refusing.last(self._out).reason()
        return Difference(taken.passes, refusing.name, reason, example.remarks, topics, delays, example, by_trying=True)


def _draws(sides: Sequence[Replay], messages: Messages) -> dict[str, Draws]:
    """What draws messages on each topic that is read; a name that means two things is replaced by topic and field."""
    conditions = [a.condition for side in sides for each in side.specification.properties for a in each.atoms]
    named: dict[Field, Signal] = {}
    for side in sides:
        for name, field in side.fields.items():
            is_taken = name in {signal.name for signal in named.values()}
            column = "/".join([field.topic, *map(str, field.path)]) if is_taken else name
            named.setdefault(field, replace(side.signals[name], name=column))
    topics = dict.fromkeys(field.topic for field in named)
    own = {topic: [(signal, field) for field, signal in named.items() if field.topic == topic] for topic in topics}
    return {topic: Draws(conditions, read_at(some, messages)) for topic, some in own.items()}


def _finite(value: Value) -> Value:
    """Zero where a number is none, or infinite."""
    return tuple(map(_zeroed, value)) if isinstance(value, tuple) else _zeroed(value)


def _zeroed(value: Single) -> Single:
    return value if isinstance(value, bool | str) or math.isfinite(value) else 0.0
