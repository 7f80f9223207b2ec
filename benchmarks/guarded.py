"""Random runs against guards: what leaves them is judged by `ltlc.monitor`, which must find no violation.

    python -m benchmarks.guarded 100000 [NAME…]     # so many events for each guard

Messages come where it is hardest, many at the same time or a nanosecond before, at and after deadlines.
"""

from __future__ import annotations

import argparse
import random
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from time import perf_counter
from typing import Any

import ltlc
from ltlc.automata import Budget
from ltlc.backends.python.load import load_plan
from ltlc.base.source import Source
from ltlc.compiler import compile_specification
from ltlc.frontend.language import load_text
from ltlc.inputs.recordings.lacks import signals_of
from ltlc.interfaces.api.guard import solved
from ltlc.monitoring.guarding.arrangement import Arrangement
from ltlc.monitoring.guarding.followed import Followed
from ltlc.monitoring.guarding.recording import Event, GuardedRun, Guarding
from ltlc.monitoring.guarding.report import Done
from ltlc.runtime.guarding import Action
from ltlc.semantics.encodings import EPISODE
from ltlc.specification.expressions import Field

MS = 1_000_000
LONGEST = 400
"""So many events a run has at most: what is rare at its beginning comes often."""


@dataclass(frozen=True)
class Example:
    """A guard as people write it, and what may come on each topic, by signals; commands by those of what is let out."""

    text: str
    values: Mapping[str, Mapping[str, Sequence[object]]]


CMD = """guard /cmd_vel_raw to /cmd_vel else stop
message stop {linear.x: 0}
decl speed /cmd_vel geometry_msgs/Twist.linear.x
"""
SCAN = "decl scan /scan sensor_msgs/LaserScan.ranges\n"
SPEEDS: dict[str, Mapping[str, Sequence[object]]] = {"/cmd_vel": {"speed": [0.0, 0.1, 0.2, 0.5, 1.0]}}
SCANS: dict[str, Mapping[str, Sequence[object]]] = {"/scan": {"scan": [(0.25, 2.0), (0.625, 2.0), (5.0, 1.25)]}}


def _flags(*topics: str) -> dict[str, Mapping[str, Sequence[object]]]:
    return {f"/{name}": {name: [True, False]} for name in topics}


EXAMPLES: dict[str, Example] = {
    "near": Example(
        CMD + SCAN + "p: always (min(scan) < 0.5 implies eventually speed <= 0.2 within 100 ms)\n"
        "q: always (new speed and min(scan) < 0.5 implies speed <= 0.2)",
        SPEEDS | SCANS,
    ),
    "near, an instant later": Example(
        CMD + SCAN + "p: always (min(scan) < 0.5 and previously min(scan) < 0.5 implies speed <= 0.2)", SPEEDS | SCANS
    ),
    "e-stop until reset": Example(
        CMD + "decl estop /estop std_msgs/Bool.data\ndecl reset /reset std_msgs/Bool.data\n"
        "p: after_until estop, reset and not estop, (within 50 ms, eventually speed == 0)\n"
        "q: after_until estop, reset and not estop, always (new speed implies speed == 0)",
        SPEEDS | _flags("estop", "reset"),
    ),
    "slew rate": Example(
        CMD + "p: always abs(speed - @{speed, -1}) <= 0.25", {"/cmd_vel": {"speed": [-0.5, -0.2, 0.0, 0.2, 0.4, 1.0]}}
    ),
    "dead man": Example(
        CMD + "decl joy /joy sensor_msgs/Joy.axes[0]\np: always (age(joy) > 500 ms implies speed == 0)",
        SPEEDS | {"/joy": {"joy": [0.0, 1.0]}},
    ),
    "heartbeat and near": Example(
        CMD + SCAN + "p: always age(speed) <= 100 ms\nq: always (new speed and min(scan) < 0.5 implies speed <= 0.2)",
        SPEEDS | SCANS,
    ),
    "heartbeat": Example(CMD + "p: always age(speed) <= 100 ms", SPEEDS),
    "rate of commands": Example(
        CMD + "p: always (new speed implies not previously once new speed within 20 ms)", SPEEDS
    ),
    "rate and near, as one": Example(
        CMD + SCAN + "p: (always (new speed implies not previously once new speed within 20 ms)) and "
        "(always (min(scan) < 0.5 implies eventually speed <= 0.2 within 100 ms))",
        SPEEDS | SCANS,
    ),
    "battery low": Example(
        'guard /goal_raw to /goal else dock\nmessage dock {data: "dock"}\ndecl goal /goal std_msgs/String.data\n'
        "decl battery /battery std_msgs/Float32.data\n"
        'p: always (new goal and battery < 0.2 implies goal == "dock")\n'
        'q: always (battery < 0.1 implies eventually goal == "dock" within 2 s)',
        {"/goal": {"goal": ["dock", "kitchen"]}, "/battery": {"battery": [0.0625, 0.15625, 0.75]}},
    ),
    "room, assumed": Example(
        CMD + SCAN + "assume a: always min(scan) / 2 >= 0\n"
        "p: always (speed > min(scan) / 2 implies eventually speed <= min(scan) / 2 within 200 ms)",
        SPEEDS | SCANS,
    ),
    "two fallbacks": Example(
        CMD.replace("else stop", "else crawl, stop")
        + "message crawl {linear.x: 0.2}\n"
        + SCAN
        + "decl estop /estop std_msgs/Bool.data\n"
        "p: always (min(scan) < 0.5 implies eventually speed <= 0.2 within 100 ms)\n"
        "q: always (estop implies eventually speed == 0 within 50 ms)\n"
        "r: always (new speed and estop implies speed == 0)",
        SPEEDS | SCANS | _flags("estop"),
    ),
    "slew rate from the start": Example(
        CMD + "p: always abs(speed - @{speed, -1 else 0}) <= 0.25",
        {"/cmd_vel": {"speed": [-0.5, -0.2, 0.0, 0.2, 0.4, 1.0]}},
    ),
    "lights out": Example(
        "guard /lights_raw to /lights else dark\nmessage dark {}\ndecl lights /lights std_msgs/Float64MultiArray.data\n"
        "decl night /night std_msgs/Bool.data\np: always (new lights and night implies all(lights <= 0.5))",
        {"/lights": {"lights": [(), (0.25,), (1.0, 0.0)]}} | _flags("night"),
    ),
    "no faster than when it got hot": Example(
        CMD + "decl hot /hot std_msgs/Bool.data\n"
        "p: after_until hot, not hot, always (not new speed or speed <= @{speed, opening})",
        SPEEDS | _flags("hot"),
    ),
    "no faster than when the stick fell silent": Example(
        CMD + "decl joy /joy sensor_msgs/Joy.axes[0]\n"
        "p: after_until age(joy) > 50 ms, new joy, always (not new speed or speed <= @{speed, opening})\n"
        "q: after_until joy > 0, joy <= 0, within 100 ms, eventually speed < @{joy, opening}",
        SPEEDS | {"/joy": {"joy": [0.0, 0.125, 1.0]}},
    ),
    "two guards": Example(
        CMD + "guard /grip_raw to /grip else hold\nmessage hold {}\ndecl grip /grip std_msgs/Float64.data\n"
        "p: never (speed > 0.2 and grip < 0)\nq: always (speed > 0.2 implies eventually speed <= 0.2 within 1 s)",
        SPEEDS | {"/grip": {"grip": [-1.0, 0.0, 1.0]}},
    ),
    "no faster than a share of the first speed": Example(
        CMD + "decl joy /joy sensor_msgs/Joy.axes[0]\n"
        "p: after_until joy > 0, joy <= 0, always (not new speed or speed / @{speed, opening} <= 1)",
        SPEEDS | {"/joy": {"joy": [0.0, 0.125, 1.0]}},
    ),
    "a sure pose": Example(
        "guard /pose_raw to /pose else home, away\nmessage home {}\nmessage away {pose.pose.position.x: 1}\n"
        "decl x /pose geometry_msgs/PoseWithCovarianceStamped.pose.pose.position.x\n"
        "decl spread /pose geometry_msgs/PoseWithCovarianceStamped.pose.covariance\n"
        "decl last /pose geometry_msgs/PoseWithCovarianceStamped.pose.covariance[35]\ndecl ok /ok std_msgs/Bool.data\n"
        "p: always (new x and not ok implies all(spread <= 1) and x >= 0.5)\n"
        "q: always (ok implies eventually last <= 0 within 100 ms)",
        {"/pose": {"x": [0.0, 1.0], "spread": [(0.0,) * 36, (2.0,) * 36], "last": [0.0, 0.5]}, **_flags("ok")},
    ),
    "three guards, two that share": Example(
        CMD + "guard /grip_raw to /grip else open\nguard /lamp_raw to /lamp\nmessage open {data: 1}\n"
        "decl grip /grip std_msgs/Float64.data\ndecl lamp /lamp std_msgs/Float64.data\n"
        "p: always (speed <= 0.2 or grip > 0)\nq: always age(grip) <= 200 ms\n"
        "r: always (new lamp implies not previously once new lamp within 20 ms)",
        SPEEDS | {"/grip": {"grip": [-1.0, 0.0, 1.0]}, "/lamp": {"lamp": [0.0, 1.0]}},
    ),
}


class Driven:
    """A guard whose runs are drawn."""

    def __init__(self, example: Example) -> None:
        specification, problems = load_text(Source("guard", example.text))
        assert specification is not None, [each.message for each in problems]
        compiled, too_hard = compile_specification(specification, EPISODE, Budget())
        assert not too_hard
        self.example, self.specification = example, specification
        self.signals = signals_of(specification.properties)
        self.plan = load_plan(compiled, specification)
        self.guarding = Guarding(specification, solved(specification, compiled))
        self.raws = {guard.out: guard.raw for guard in specification.guards}
        names = [name for of in example.values.values() for name in of]
        judged = "\n".join(
            line for line in example.text.splitlines() if not line.startswith(("guard", "message", "_lead_"))
        )
        self.judge = ltlc.monitor(judged.replace("assume ", ""), signals=names)
        self.bounds = [20 * MS, 50 * MS, 90 * MS, 100 * MS, 200 * MS, 500 * MS, 1000 * MS, 2000 * MS]
        self.labels = [each.label for each in specification.properties if not each.is_assumed]

    def run(self, chance: random.Random, events: int) -> Counter[str]:
        """One run of so many events; what the guards did, how often, and `violated` if a property is."""
        run = self.begun()
        self.judge.reset()
        found: Counter[str] = Counter()
        time = 0
        for time, values in self.rows(chance, events):
            run.row(time, values, ())
            for event in run.taken:
                self.judge.step(dict(event.values), time_ns=event.time)
            run.taken.clear()
        run.act(time)
        self.judge.step({}, time_ns=time)
        found.update(each.deed.action.value for each in run.done)
        found["violated"] = sum(self.judge.verdicts[label] is ltlc.Verdict.VIOLATED for label in self.labels)
        assert all(one.deed.time <= other.deed.time for one, other in pairwise(run.done))
        return found

    def held_back(self, chance: random.Random, events: int) -> Iterator[tuple[list[Event], Done]]:
        """The commands of a run that violate nothing by themselves and do not pass, with what was heard before."""
        run = self.begun()
        heard: list[Event] = []
        for time, values in self.rows(chance, events):
            before = len(run.done)
            run.row(time, values, ())
            for done in run.done[before:]:
                if done.play is not None and done.deed.command is not None:
                    left = 1 if done.deed.action is Action.CHANGED else 0
                    yield [*heard, *run.taken[: len(run.taken) - left]], done
            heard += run.taken
            run.taken.clear()

    def begun(self) -> GuardedRun:
        """A run at its beginning, of which commands have the names of what is let through."""
        sent = {
            name: name
            for name, s in self.signals.items()
            if isinstance(s.definition, Field) and s.definition.topic in self.raws
        }
        return GuardedRun(self.guarding, self.signals, sent, self.plan)

    def followed(self, began: int) -> list[Followed]:
        """Where the properties of each set of guards are in a session that begins."""
        properties = {each.label: each for each in self.specification.properties}
        return [Followed(Arrangement(some, properties, self.plan), began) for some in self.guarding.solved]

    def topic_of(self, values: Mapping[str, object]) -> str:
        """The topic of a message with these values."""
        return next(topic for topic, of in self.example.values.items() if not values.keys().isdisjoint(of))

    def rows(self, chance: random.Random, events: int) -> Iterator[tuple[int, dict[str, Any]]]:
        """Messages with their times, one after another; at the beginning one on each topic but those of commands."""
        time = 1000 * MS
        topics = [*self.example.values]
        others = [topic for topic in topics if topic not in self.raws]
        for number in range(events):
            time += self._gap(chance)
            for topic in others if number == 0 else [chance.choice([*topics, *self.raws])]:
                yield time, {name: chance.choice(of) for name, of in self.example.values[topic].items()}

    def _gap(self, chance: random.Random) -> int:
        about = chance.choice(self.bounds) - chance.choice([0, 0, 10 * MS]) + chance.choice([-1, 0, 1, 2])
        return chance.choice([0, 0, 1, MS, 10 * MS, 30 * MS, about])


def main(arguments: Sequence[str]) -> int:
    """Drive each guard through random events; the exit code is 1 if a property was violated."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("events", type=int)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args(arguments)
    violated = 0
    for name, example in EXAMPLES.items():
        if options.names and name not in options.names:
            continue
        driven, chance, start, left = (
            Driven(example),
            random.Random(f"{name} {options.seed}"),
            perf_counter(),
            options.events,
        )
        found: Counter[str] = Counter()
        while left > 0:
            length = min(left, chance.randint(2, LONGEST))
            found += driven.run(chance, length)
            left -= length
        counts = ", ".join(f"{found[action.value]:,} {action.value}" for action in Action)
        print(f"{name}: {counts}, {found['violated']} violated; {perf_counter() - start:.0f} s", flush=True)
        violated += found["violated"]
    return int(violated > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
