"""Conditions that have every primitive of the table of functions, and values on which to ask for them."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from typing import Any

from edges import drawn
from language_support import compiled

from ltlc.program.types import DOUBLE, SINGLE, type_of
from ltlc.specification.evaluation import truth
from ltlc.specification.expressions import Call, Comparison, Condition, Current, Field, Read, Signal, operands, reads
from ltlc.specification.functions import INSIDE, WRITTEN, Function

FIELDS = {
    "i8": "Int8", "u8": "UInt8", "i16": "Int16", "i32": "Int32", "u32": "UInt32", "i64": "Int64", "j64": "Int64",
    "u64": "UInt64", "w64": "UInt64", "s": "Float32", "t": "Float32", "x": "Float64", "y": "Float64", "z": "Float64",
    "on": "Bool", "off": "Bool", "mode": "String", "other": "String", "scan": "Float32MultiArray",
    "xs": "Float64MultiArray", "ids": "Int64MultiArray", "uids": "UInt64MultiArray", "bytes": "UInt8MultiArray",
}  # fmt: skip
DECLARED = "\n".join(
    [
        *(f"decl {name} /{name} std_msgs/{type_}.data" for name, type_ in FIELDS.items()),
        "decl names /joints JointState.name",
        "model robot: position /odom Odometry.pose.pose.position orientation /odom Odometry.pose.pose.orientation ;",
        "object sign at (1, 2, 3)",
        "object cart /cart Odometry",
        "object van /van Odometry",
        "zone hall = [(0, 0), (2, 0), (2, 0.3), (1.1, 0.1), (-0.3, 3)]",
        "",
    ]
)
PROPERTIES = """\
i8 > 2.5 | i8 >= -2.5 | u8 < 256 | u8 == 0.5 | u8 <= 3 | 3 < u8 | u8 >= 2.5 | u8 == u8 | i8 < i8 | i16 < i32 | u32 <= 7
i64 < j64 | i64 < u64 | u64 <= i64 | u64 > w64 | i64 == 9007199254740993 | i64 > 2.5 | i64 < x | x >= u64 | s < i64
i32 < i64 | u8 < u64 | u32 >= i64 | i8 == u64 | i64 == u64 | u64 == x | i64 == x | u64 > 18446744073709551614
s <= 0.3 | s > 0.5 | 0.5 < s | s < x | s == t | s =={0.1} 0.5 | x =={0.1} 0 | 0 =={0.5} x | x =={0.1} y | s =={0.1} t
x <{0.5} y | x >{0.5} 2 | abs(i64) > 5 | abs(i64) + 1 > x | -i64 < 3 | -u8 < 3 | abs(i8) > 3 | -s < t | abs(s) > 0.3
min(i64, j64) > 5 | min(i64, 3) > x | max(x, y, 3) > 5 | max(u64, i64) + 1 > 4 | min(s, 0.3) < 0.2 | min(u8, i8) < 1
max(i64, 3, j64) - x > 2 | x / y > 3 | x / 2 > 3 | x * y - 3 + s > 3 | (x + y) * (x - 1) < 0 - y
1 / x > 3 | on | on == off | on == true | on == false | mode == "a" | mode == other | mode in {"a", "b"} | mode == mode
min(scan) < 0.3 | max(scan[1:]) > 2 | sum(bytes) > 201 | len(scan[1:-1]) < 3 | len(mode_names) > 1
min(ids) == 9007199254740993 | min(ids) + 1 > 5 | max(uids) / 2 > x | min(bytes) < 3 | max(ids) < i64 | sum(ids) > x
median(ids) > x | 1 / median(xs[1:]) < 0 | median(bytes) == 2.5
any(scan < 0.3) | all(scan < 0.3) | count(scan < 0.3) >= 2 | any(scan < x) | any(not scan < x) | any(scan > i64)
any(i64 <= scan) | any(abs(scan) > u64) | count(-scan < y) == 1 | any(ids == 5 or ids < j64) | any(uids > i64)
all(xs == x) | any(bytes > i8) | any(sqrt(xs) > 1) | any(mode_names == mode) | count(xs * x > y) > 1
any(xs[1:] > xs) | any(ids > x) | count(not (xs < y or xs == x)) > 0 | all(min(xs, y) < 1) | any(-ids > i64)
any(xs / y > x) | max(min(u8, 5), i64) > 3 | min(abs(i8), -u8, u64) > 1 | max(len(scan), i64) > 2
any(inside(xs, x, hall)) | all(inside(xs, xs, hall)) | count(distance(scan, y, hall) < 1) > 1
any(nearest(scan, xs) > x) | 1 / nearest(x, xs) < 0
inside(robot.position, hall)
robot.distance.cart < 1 | robot.distanceZ.cart < 1 | robot.orientation.roll > 1 | robot.orientation.pitch > 1
robot.orientation.yaw > 1 | robot.orientation_between.cart < 1 | robot.distance.sign > 1
robot.position =={0.5} cart.position | cart.position == van.position | robot.position =={0.5} sign.position
""".replace("mode_names", "names")


def _calls() -> Iterator[str]:
    """Each function of the language of what it takes."""
    for name, function in WRITTEN.items():
        for numbers in [("x", "y", "z"), ("s", "i64", "u8")]:
            if function.takes.zone:
                yield f"{name}({numbers[0]}, {numbers[1]}, hall){'' if name == INSIDE else ' > 0.5'}"
            elif function.takes.among:
                yield from (f"{name}({numbers[0]}, {array}) > 1" for array in ("xs", "scan[1:]", "ids", "bytes"))
            elif function.takes.least:
                yield f"{name}({', '.join(numbers[: function.takes.least])}) > 1"
        yield from (f"{name}({array}) > 1" for array in ("xs", "scan", "ids", "bytes") if function.takes.array)


COMPLETE = [f"complete({array}) > 1" for array in ("xs", "scan", "ids")]
"""What no author can call: it is computed of samples as an array."""
CONDITIONS = [*(text.strip() for line in PROPERTIES.splitlines() for text in line.split("|")), *_calls()]
EVERY = [*CONDITIONS, *COMPLETE]
ROUNDS = 60


@cache
def conditions(text: str) -> list[Condition]:
    """The conditions of `never TEXT`; of a signal that is computed, of what it is computed as."""
    (found,) = compiled(f"{DECLARED}never {text.replace('complete', 'len')}\n").properties
    return [_written_out(atom.condition, text in COMPLETE) for atom in found.atoms]


def _written_out(what: Condition, is_complete: bool) -> Condition:
    match what:
        case Comparison(Call(Function.LEN, arguments)) if is_complete:
            return replace(what, left=Call(Function.COMPLETE, arguments))
        case Comparison(Current(Signal(definition=definition))) if not isinstance(definition, Field):
            return replace(what, left=definition)
        case _:
            return what


def wanted(what: Condition) -> list[Read]:
    """What a condition reads."""
    return list(dict.fromkeys(each for operand in operands(what) for each in reads(operand)))


def cases(text: str) -> Iterator[tuple[Condition, dict[Read, Any]]]:
    """Values at which a condition is asked for: none that it compares is NaN."""
    chance = random.Random(text)
    for what in conditions(text):
        for _ in range(ROUNDS):
            values = {each: drawn(type_of(each.signal), chance) for each in wanted(what)}
            if truth(what, values) is not None:
                yield what, values


def hostile(what: Condition, chance: random.Random) -> dict[Read, Any]:
    """Values of what a condition reads, NaN among those that can be."""
    found = {each: drawn(type_of(each.signal), chance) for each in wanted(what)}
    may_be_nan = [each for each in found if type_of(each.signal) in (SINGLE, DOUBLE)]
    return found | {each: math.nan for each in may_be_nan if chance.random() < 1 / 6}
