"""Random bags and the evidence of them: whether what columns and rows found is what `recorded.py` computes anew."""

from __future__ import annotations

import csv
import io
import json
import shutil
from collections.abc import Callable, Iterator, Sequence
from contextlib import redirect_stderr, redirect_stdout
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pyarrow as pa
from pyarrow import parquet
from rosbags.rosbag2 import StoragePlugin, Writer  # noqa: TID251
from rosbags.typesys import Stores, get_typestore  # noqa: TID251

from ltlc.assurance.evidence import recorded
from ltlc.assurance.evidence.certified import certificates
from ltlc.assurance.evidence.checked import checked
from ltlc.assurance.evidence.document import Document, printed
from ltlc.assurance.evidence.parsing import parsed
from ltlc.assurance.evidence.reader import Read
from ltlc.automata import Budget
from ltlc.base.source import Source
from ltlc.inputs.recordings.reading import DEFAULT, ReadOptions
from ltlc.interfaces.api.prepare import prepare
from ltlc.monitoring.judging.evidence import evidence_by
from ltlc.monitoring.judging.run import Judge
from ltlc.runtime.times import seconds_text
from ltlc.semantics.certificate_reader import parse
from ltlc.semantics.certificate_text import Entry
from ltlc.semantics.encodings import EPISODE

HEAD = """
decl x /x Float64.data
decl y /y Float32.data
decl b /b Bool.data
decl m /m String.data
decl i /i Int64.data
decl z /z std_msgs/Empty
decl scan /scan LaserScan.ranges
decl pos /j JointState.position
decl pos1 /j JointState.position[1]
decl vel /j JointState.velocity
decl status /g action_msgs/GoalStatusArray.status_list[].status
decl goal /g action_msgs/GoalStatusArray.status_list[].goal_info.goal_id
decl jn /j JointState.name
decl position /j JointState.position
decl tx /tf TFMessage.transforms[].transform.translation.x
decl ty /tf TFMessage.transforms[].transform.translation.y
decl tn /tf TFMessage.transforms[].child_frame_id
object base /tf TFMessage
object arm /tf TFMessage
object thing /q PoseStamped
zone room = [(0, 0), (2, 0), (2, 2), (0, 2)]
"""

PROPERTIES = """
never x > 2
always (x > 2 implies eventually y <= 0.3 within 2 s)
never abs(x - @{x, -1}) > 1.5
after_until b, not b, eventually x < 1
never (m == "go" and x > 2)
always x + y * 2 <{0.1} 6
always x =={0.5} y
always sqrt(x) < 1.8
always x / y < 4
never (x > 2 and not once y < 1 within 3 s)
always historically x < 3 for 500 ms
always (b since x < 2)
always (x > 1 and not previously x > 1 implies eventually b within 1 s)
always age(x) <= 1 s
always age(z) <= 2 s
never new z
always (x > 2 implies age(b) <= 1 s)
never (age(x) > 1 s and age(y) > 1 s)
never (age(x) > 1 s and age(y) > 1 s and b)
always (new x implies eventually new y within 2 s)
always (new m and m == "go" implies eventually b within 1 s)
never min(scan) < 0.2
always (max(scan[1:3]) < 5 implies eventually b within 1 s)
always len(scan) >= 2
always (sum(scan) < 20 or not b)
always scan[0] > 0.2
always median(scan) < 3 and mean(scan) < 3
always nearest(x, scan) < 5
never any(scan < 0.2)
always all(scan > 0.2 or scan > x)
always count(scan > 1) >= 2
never any(scan - @{scan, -1} > 0.5)
never any(tx > 1 and ty > 1)
never any(tn == "base" and tx < 0)
never any(status in {4, 6})
always count(pos < vel over (pos), (vel)) < 5
never any(hypot(tx - pos, ty) < 1 over (tx, ty), (pos))
never pos1 > 1
never i == 9007199254740993
never i > 9007199254740992
always abs(i) < 5
always min(i, 3) < 4
always i - 1 < 7
always base.position.x < 2
always base.distance.arm < 3
always thing.velocity < 3
always thing.orientation.yaw < 1
always base.orientation_between.arm < 2
always inside(thing.position, room)
always distance(thing.position, room) < 1
always max(@{x, -3:}) < 3
always count(@{b, -3:}) <= 2
always sum(@{x, -2:}) < 5
always abs(x - @{x, -1 else 0}) < 1.5
always x - @{x, when new y} < 2
always x - @{x, when b and y > 0.4} < 2
always @{x - y, -1} < 2
always @{x > 1 and b, -1}
always mod(x, 2) < 1.5
always floor(x) + ceil(y) < 4
always atan2(x, y) < 1
always angle_between(x, y) < 2
always sin(x) < 0.9 and exp(x) < 10 and log(x) < 1
always max(hypot(x, y), sign(x)) < 3
never max(i, 0.5) > 9007199254740992
always count(not scan > 1 and scan < 4) < 3
always x - @{x, when not b or y > 0.4} < 2
never any(nearest(tx, scan) < 1)
never any(abs(tx - median(scan)) > 3)
""".strip().splitlines()
"""All forms that evidence covers, except those of time, whose atoms are these, and the next ones."""

COUNTS = """
never once new b 4 times within 10 s
always (b implies not once x > 2 3 times)
never once (new b and x > 1) 2 times
after_until b, x > 3, eventually once y > 1 2 times within 3 s
always (once x > 1 2 times within 1 s implies eventually b within 1 s)
never once (x > 1 or b) 3 times
always (once new m 2 times within 500 ms implies age(x) <= 1 s)
always historically not once new x 2 times within 300 ms for 1 s
""".strip().splitlines()

OPENINGS = """
after b, always x <= @{x, opening} + 1
(after_until b, x > 1.5, never x < @{x, opening}) and x < @{x, opening} + 3
after_until b and x > 0, x > @{x, opening} + 1, never y > 2
never x > @{x, opening} + 2
after_until b, x > @{x, opening}, age(y) <= 1 s
after_until once b within 2 s, x < 1, y <= @{y, opening} + x / @{x, opening}
after new b, within 2 s, after x > 1, always x <= @{x, opening}
after_until once x > 1 2 times within 3 s, new m, y <= @{y, opening}
until b, x <= @{x, opening} + 1 and y < 3
after_until x > 0, x < 0, after_until y > 0, y > @{y, opening}, x >= @{x, opening} - 1
after m == "go", m == @{m, opening} or x > @{x, opening} - 1
""".strip().splitlines()

INSTANCES = """
each new b: eventually x > 1 within 2 s
each new x: (eventually b within 3 s) and (after x > 1, eventually y < 1 within 2 s)
each new m limit 100: not (b and x > 2)
each new b: eventually new x within 500 ms
each new x: after_until b, x > 2, never y > 1
each new z: once b 2 times within 2 s or x < 1
each new m: eventually (new m and m == "go") within 1 s
each new b: always age(x) <= 3 s
each new b: eventually once x > 1 within 1 s within 2 s
""".strip().splitlines()

SLICES = """
each a of i: eventually x > 1 and new i within 2 s
each j of jn: always (position > 1 implies eventually b within 1 s)
each c of tn: never (tx > 1 and ty > 1)
each c of tn: never abs(tx - @{tx, -1}) > 1.5
each j of jn: never position + vel > 3
each mode of m: always (new m implies eventually x > 1 within 1 s)
each c of tn: after_until tx > 0, tx < 0, eventually ty > 1
each j of jn: never once new position 3 times within 2 s
each c of tn: always (new b implies once tx > 0.5 within 3 s)
each a of i: never (a > 5 and x > 2)
each g of goal: eventually status in {4, 6} within 1 s
""".strip().splitlines()

EVERY = (*PROPERTIES, *COUNTS, *OPENINGS, *INSTANCES, *SLICES)

TYPES = {
    "/x": "std_msgs/msg/Float64",
    "/y": "std_msgs/msg/Float32",
    "/b": "std_msgs/msg/Bool",
    "/m": "std_msgs/msg/String",
    "/i": "std_msgs/msg/Int64",
    "/z": "std_msgs/msg/Empty",
    "/scan": "sensor_msgs/msg/LaserScan",
    "/j": "sensor_msgs/msg/JointState",
    "/g": "action_msgs/msg/GoalStatusArray",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/q": "geometry_msgs/msg/PoseStamped",
}
STORE = get_typestore(Stores.ROS2_JAZZY)
BEGINNING = 1_700_000_000 * 10**9 + 7
GAPS = (0, 0, 1, 1000, 10**7, 10**8, 2 * 10**8, 333_333_333, 10**9)


class Messages:
    """Messages drawn at random: ties of values, NaN, infinities, lists of all lengths."""

    def __init__(self, chance: Random) -> None:
        self._chance = chance

    def of(self, topic: str) -> Any:
        choose, name = self._chance.choice, TYPES[topic]
        match topic:
            case "/b":
                return make(name, data=choose([True, False]))
            case "/m":
                return make(name, data=choose(["go", "stop"]))
            case "/i":
                return make(name, data=choose([0, 1, -5, 7, 2**53, 2**53 + 1, -(2**53) - 1, 2**62]))
            case "/z":
                return make(name, structure_needs_at_least_one_member=0)
            case "/scan":
                some = [choose([0.1, 0.3, 1.0, 4.0, np.nan, np.inf]) for _ in range(choose([0, 1, 3, 5]))]
                rest = ("angle_min", "angle_max", "angle_increment", "time_increment", "scan_time", "range_min")
                empty = np.array([], np.float32)
                zeros = dict.fromkeys((*rest, "range_max"), 0.0)
                return make(name, header=header(), ranges=np.array(some, np.float32), intensities=empty, **zeros)
            case "/j":
                count = choose([0, 1, 2, 3])
                joints = [choose("abc") for _ in range(count)]
                position = np.array([self._usual() for _ in range(count)], np.float64)
                velocity = np.array([self._any() for _ in range(choose([count, 0]))], np.float64)
                return make(
                    name, header=header(), name=joints, position=position, velocity=velocity, effort=np.array([])
                )
            case "/g":
                goals = [self._goal() for _ in range(choose([0, 1, 2]))]
                return make(name, status_list=goals)
            case "/tf":
                return make(name, transforms=[self._transform() for _ in range(choose([0, 1, 2, 3]))])
            case "/q":
                pose = make("geometry_msgs/msg/Pose", position=self._vector("Point"), orientation=self._quaternion())
                return make(name, header=header(), pose=pose)
            case _:
                return make(name, data=self._any())

    def _any(self) -> float:
        return self._chance.choice([0.0, 0.3, 0.5, 1.0, 1.7, 2.5, 3.9, -1.0, -0.0, np.nan, np.inf])

    def _usual(self) -> float:
        return self._chance.choice([0.0, 0.3, 0.5, 1.0, 1.7, 2.5, -1.0])

    def _goal(self) -> Any:
        goal = make("unique_identifier_msgs/msg/UUID", uuid=np.full(16, self._chance.choice([0, 1]), np.uint8))
        info = make("action_msgs/msg/GoalInfo", goal_id=goal, stamp=stamp())
        return make("action_msgs/msg/GoalStatus", goal_info=info, status=self._chance.choice([1, 2, 4, 6]))

    def _vector(self, of: str) -> Any:
        return make(f"geometry_msgs/msg/{of}", x=self._usual(), y=self._usual(), z=self._usual())

    def _quaternion(self) -> Any:
        parts = {name: self._usual() for name in "xyzw"}
        return make("geometry_msgs/msg/Quaternion", **parts)

    def _transform(self) -> Any:
        child = self._chance.choice(["base", "arm", "cup"])
        moved = make("geometry_msgs/msg/Transform", translation=self._vector("Vector3"), rotation=self._quaternion())
        return make("geometry_msgs/msg/TransformStamped", header=header(), child_frame_id=child, transform=moved)


def make(name: str, /, **fields: Any) -> Any:
    return STORE.types[name](**fields)


def stamp() -> Any:
    return make("builtin_interfaces/msg/Time", sec=0, nanosec=0)


def header() -> Any:
    return make("std_msgs/msg/Header", stamp=stamp(), frame_id="")


def write_bag(path: Path, rows: Sequence[tuple[int, str, Any]], storage: StoragePlugin = StoragePlugin.MCAP) -> Path:
    """A bag of messages, which are a time, a topic and a message each."""
    shutil.rmtree(path, ignore_errors=True)
    with Writer(path, version=9, storage_plugin=storage) as writer:
        topics = dict.fromkeys(topic for _, topic, _ in rows)
        connections = {topic: writer.add_connection(topic, TYPES[topic], typestore=STORE) for topic in topics}
        for time, topic, message in rows:
            writer.write(connections[topic], time, STORE.serialize_cdr(message, TYPES[topic]))
    return path


CELLS: dict[str, Callable[[Any], dict[str, Any]]] = {
    "/x": lambda message: {"x": message.data},
    "/y": lambda message: {"/y/data": message.data},
    "/b": lambda message: {"b": message.data},
    "/m": lambda message: {"m": message.data},
    "/i": lambda message: {"i": message.data},
    "/z": lambda message: {"z": True},
    "/scan": lambda message: {f"scan[{number}]": float(each) for number, each in enumerate(message.ranges)},
    "/j": lambda message: {"/j/position": message.position.tolist(), "vel": message.velocity.tolist()},
    "/tf": lambda message: (
        {"base.position.x": message.transforms[0].transform.translation.x} if message.transforms else {}
    ),
    "/q": lambda message: {"thing.velocity": abs(message.pose.position.y)},
}
"""What a table has in place of messages on a topic: columns by name, by topic, by element, and of what is computed."""


def write_table(path: Path, rows: Sequence[tuple[int, str, Any]]) -> Path:
    """The same messages in a table, by the end of its name."""
    table = [(time, CELLS[topic](message)) for time, topic, message in rows if topic in CELLS]
    heads = list(dict.fromkeys(head for _, cells in table for head in cells))
    match path.suffix:
        case ".parquet":
            columns = {head: [cells.get(head) for _, cells in table] for head in heads}
            parquet.write_table(pa.table({"time": [time for time, _ in table], **columns}), path)
        case ".jsonl":
            lines = [
                f'{{"time": {seconds_text(time)}, {json.dumps(cells)[1:]}'.replace(", }", "}") for time, cells in table
            ]
            path.write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")
        case _:
            with path.open("w", encoding="utf-8", newline="") as file:
                writer = csv.writer(file)
                writer.writerow(["__time", *heads])
                for time, cells in table:
                    texts = [json.dumps(cell) if isinstance(cell, list) else cell for cell in map(cells.get, heads)]
                    writer.writerow([seconds_text(time), *texts])
    return path


def random_rows(chance: Random) -> list[tuple[int, str, Any]]:
    """Messages on most topics, some at the same time, some after a second of silence."""
    topics, messages = chance.sample(list(TYPES), chance.choice([len(TYPES) - 2, len(TYPES)])), Messages(chance)
    time, rows = BEGINNING, []
    for _ in range(chance.choice([3, 30, 120])):
        topic = chance.choice(topics)
        rows.append((time, topic, messages.of(topic)))
        time += chance.choice(GAPS)
    return rows


@cache
def judge_of(text: str, reading: ReadOptions = DEFAULT) -> Judge:
    """What judges by a specification, and gives evidence."""
    prepared = prepare(Source("props.txt", text), [], EPISODE, Budget(60.0, 4000))
    evidence = evidence_by(prepared.compiled, prepared.specification, Budget(60.0, 4000))
    return Judge(prepared.compiled, prepared.specification, reading, evidence=evidence)


def evidence_of(text: str, path: Path, reading: ReadOptions = DEFAULT) -> Document:
    """The evidence of a recording."""
    found = judge_of(text, reading).judge(path).evidence
    assert found is not None
    return found


def said_of(document: Document | str, *paths: Path, fill: Path | None = None) -> tuple[int, list[str]]:
    """What `recorded.py` says of an evidence and a recording: its exit code, and its lines."""
    text = document if isinstance(document, str) else printed(document)
    file = paths[0].parent / "evidence.txt"
    file.write_text(text, encoding="utf-8")
    output = io.StringIO()
    with redirect_stdout(output), redirect_stderr(output):
        code = recorded.main([str(file), *map(str, paths), *(() if fill is None else ("--fill", str(fill)))])
    return code, output.getvalue().splitlines()


def specification(properties: Sequence[str], settings: str = "") -> str:
    lines = [f"c{number}: {text}\n" for number, text in enumerate(properties)]
    return f"{settings}{HEAD}{''.join(lines)}"


def disagreements(seed: int, folder: Path, properties: Sequence[str] = EVERY) -> Iterator[str]:
    """What `recorded.py` does not find as ltlc has it, of `properties` on a random bag, with a rate or without.

    The same messages are in a table, too, as far as tables have them.
    """
    chance = Random(seed)
    text = specification(properties, chance.choice(["", "", "_rate_ = 5\n", "_rate_ = 3\n"]))
    rows, storage = random_rows(chance), chance.choice([StoragePlugin.MCAP, StoragePlugin.SQLITE3])
    ending = chance.choice([".csv", ".jsonl", ".parquet"])
    for recording in (write_bag(folder / "bag", rows, storage), write_table(folder / f"table{ending}", rows)):
        code, lines = said_of(evidence_of(text, recording), recording)
        fine = ("the letters are as stated", "nothing is claimed")
        yield from (f"{recording.name}: {line}" for line in lines if not any(each in line for each in fine))
        if code:
            yield f"{recording.name}: exit code {code}"


@cache
def entries_of(text: str) -> dict[str, Entry]:
    """The certificates of a specification, by label."""
    found, _ = certificates(judge_of(text).compiled, Budget(60.0, 4000))
    return {entry.label: entry for entry in parse(found)}


def refusals(document: Document, text: str, bag: Path) -> list[str]:
    """What each check of `document` says that does not accept one of its claims, with the name of the check."""
    lines = said_of(document, bag, fill=bag.parent / "filled")[1]
    filled = parsed((bag.parent / "filled").read_text(encoding="utf-8"))
    assert isinstance(filled, Document)
    read = Read(tuple(line.partition(": ")[2] for line in lines[: len(document.properties)]), filled)
    checks = (
        check
        for each in checked(document, judge_of(text).specification, entries_of(text), read)
        for check in each.checks
    )
    return [f"{check.what}: {check.refusal}" for check in checks if check.refusal is not None]
