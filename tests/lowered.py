"""The properties that lowering is tested on, each with its machine: the documentation's, and some for each feature."""

from __future__ import annotations

import random
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from edges import drawn
from program_reference import Run
from stepping import from_text

from ltlc.base.source import Source
from ltlc.compiler import Compiled
from ltlc.frontend.language import load_text
from ltlc.program.expressions import Literal, parts
from ltlc.program.machine import Machine
from ltlc.program.types import Type
from ltlc.specification.specification import Specification

PROJECT = Path(__file__).parents[1]

FEATURES = """
decl distance /distance std_msgs/Float64.data
decl speed /speed std_msgs/Float64.data
decl slow /slow std_msgs/Float32.data
decl scan /scan sensor_msgs/LaserScan.ranges
decl flags /flags std_msgs/UInt8MultiArray.data
decl ids /ids std_msgs/Int64MultiArray.data
decl big /big std_msgs/UInt64.data
decl count /count std_msgs/Int64.data
decl tiny /tiny std_msgs/Int8.data
decl on /on std_msgs/Bool.data
decl mode /mode std_msgs/String.data
model robot:
    position /odom Odometry.pose.pose.position
    orientation /odom Odometry.pose.pose.orientation
    velocity /odom Odometry.twist.twist.linear
;
object sign at (10, 0, 0)
stop: after_until distance < 1, distance > 1, eventually speed < 0.1
response: always (distance < 1 implies eventually speed < 0.1 within 2 s)
opening: after_until distance < 1, distance > 1, never speed > @{speed, opening} + 0.5
apart: after_until on, not on, always speed / @{distance, opening} < 2
history: always speed - @{speed, -2} <{0.05} 0.3
margin: always speed =={0.2} distance
zero: always speed =={0.2} 0
any: never any(scan[3:] < 0.2)
density: never count(scan < 0.5 and scan > 0.1) / len(scan) > 0.5
root: never min(scan) < sqrt(speed)
sum: always sum(flags) < 200
unsigned: always (big / 2 < 10 or big == 3) and big < 1e15
mixed: never big > count
elements: never any(scan < count) or min(ids) == 3
combined: never count(scan < ids over (scan), (ids)) > 3 or any(ids > speed + scan over (ids), (scan))
signed: always tiny < 2.5 and tiny > -200
single: always slow < 0.1 or slow > 0.25
text: after mode == "go", never mode != "go" and not on
nested: after_until on, not on, after_until distance < 1, distance > 1, eventually speed < 0.1
rules: always ((distance < 1 implies eventually speed < 0.1 within 1 s) and (on implies eventually not on within 2 s))
news: always (new distance implies eventually new speed within 1 s)
lasting: never historically speed > 1 for 500 ms
past: after_until on, mode == "x", always (previously on or once distance < 1 within 2 s)
taken: after once distance < 1 within 2 s, always speed < @{speed, opening} + 1
reopened: after_until on, new mode, never @{speed, opening} < 1
silent: always age(speed) <= 200 ms
watchdog: always (age(scan) > 1 s implies speed < 0.1 or distance > 2)
deadlines: always (on implies eventually not on within 1 s) and always (age(speed) < 200 ms or age(distance) < 1 s)
heard: never (age(speed) > 1 s and previously new speed)
overdue: after age(speed) > 2 s, always once on within 1 s
undefined: after_until on, new mode, never speed / @{speed, opening} > 2
both: always (distance < 1 implies speed < 1) and always (distance >= 1 implies speed < 2)
angles: never robot.orientation.roll > 0.5 or abs(robot.orientation.yaw) < 0.1
near: after_until robot.distance.sign < 1, robot.distance.sign > 1, eventually robot.velocity == 0
decided: always tiny < 200
before: always (speed > 1 implies previously tiny < tiny)
same: after_until new mode, speed == speed, eventually speed < speed within 1 s
soon: after count > 1, eventually tiny > 200 within 1 s
nowhere: after tiny > 200, always age(speed) < 1 s
recent: never all(@{speed, -2:} < 1) and max(@{distance, -3:}) - @{distance, -1} > 1
held: never @{on and speed > 1, -1} and any(@{on, -1:})
counted: never once new speed 3 times within 2 s
slips: after_until once speed / distance > 1 2 times, on, never tiny > 5
rated: always (rate(speed) >= 4 Hz over 1 s or once on 2 times within 1 s)
frozen: after on, always (speed < @{distance, opening} or not once new count 2 times within 500 ms)
"""


def texts() -> Iterator[str]:
    """Specifications."""
    yield FEATURES
    page = (PROJECT / "docs" / "sentences.md").read_text(encoding="utf-8")
    *sentences, signals = re.findall(r"```ltlc\n(.*?)```", page, re.DOTALL)
    yield signals + "".join(f"sentence{number}: {each}" for number, each in enumerate(sentences))
    for path in sorted((PROJECT / "examples").rglob("*.txt")):
        yield path.read_text(encoding="utf-8")


@cache
def labels() -> list[str]:
    """The name of each property, for which nothing is compiled: every process that collects tests asks."""
    specifications = [load_text(Source("props.txt", text))[0] for text in texts()]
    return [each.label for of in specifications if of is not None for each in of.properties]


@cache
def cases() -> list[tuple[Machine, Compiled, Specification]]:
    """Each property."""
    found = []
    for text in texts():
        compiled, specification = from_text(text)
        found += [(each.machine, each, specification) for each in compiled]
    return found


def value_of(type_: Type, machine: Machine, chance: random.Random) -> Any:
    """A value of that type, often a constant of the machine."""
    literals = [p.value for atom in machine.atoms for p in parts(atom) if isinstance(p, Literal) and p.type == type_]
    return chance.choice(literals) if literals and chance.random() < 1 / 2 else drawn(type_, chance)


def shown(machine: Machine, right: Machine, seed: int) -> list[object]:
    """What a machine shows on a drawn run of `right`."""
    chance, run, time, found = random.Random(seed), Run(machine), 0, list[object]()
    for _ in range(40):
        time += chance.choice([0, 1, 10**8, 5 * 10**8, 10**9, 10**9 + 1, 3 * 10**9])
        found += [run.next(), run.step(time, [value_of(each.type, right, chance) for each in right.inputs])]
        found += [run.invalid, run.next()]
    return found
