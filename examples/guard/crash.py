"""Controllers that are told to crash, each once without its guard and once with it, in simulated time.

    python examples/guard/crash.py [NAME …] [--record FOLDER]

Prints a row of a table for each: what happened without and with the guard, how many of the properties are violated
as an independent monitor judges what the robot was told, and what the guard did. With `--record`, what the controllers
asked for without a guard is written to FOLDER/NAME.jsonl, for `ltlc run --guard NAME.txt FOLDER/NAME.jsonl`. The exit
code is 0 if each scene violates a property without its guard, and none does with it.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from pathlib import Path
from typing import Protocol

from scenes import SCENES, Scene
from world import TICK, Message, World

import ltlc

HERE = Path(__file__).resolve().parent
MS = 1_000_000

DID = ("passed", "changed", "held_back", "sent")
ZERO: Mapping[str, Mapping[str, object]] = {
    "/cmd_vel": {"linear/x": 0.0, "angular/z": 0.0},
    "/arm": {"data": 0.0},
    "/goal": {"data": ""},
    "/goto": {"pose/position/x": 0.0, "pose/position/y": 0.0},
    "/speed_limit": {"data": 0.0},
}
"""The fields of commands that the robot reads, as they are in a message in which nothing is set."""


class Way(Protocol):
    """The way of commands from the controller to the robot; sensors are heard on it.

    `heard` is what was sensed and what left for the robot, each with its time in ns, in order.
    """

    heard: list[tuple[int, Message]]

    def hear(self, time: int, message: Message) -> None:
        """Something was sensed."""
        ...

    def command(self, time: int, message: Message) -> None:
        """The controller asks for something."""
        ...

    def arrived(self, time: int) -> list[Message]:
        """What has arrived at the robot by now."""
        ...


@dataclass
class Unguarded:
    """The robot gets what the controller asks for."""

    heard: list[tuple[int, Message]] = field(default_factory=list)
    _arrived: list[Message] = field(default_factory=list)

    def hear(self, time: int, message: Message) -> None:
        """See `Way`."""
        self.heard.append((time, message))

    def command(self, time: int, message: Message) -> None:
        """See `Way`."""
        self.heard.append((time, message))
        self._arrived.append(message)

    def arrived(self, time: int) -> list[Message]:
        """See `Way`."""
        arrived, self._arrived = self._arrived, []
        return arrived


class Guarded(Unguarded):
    """A guard stands between them."""

    def __init__(self, guard: ltlc.LiveGuard) -> None:
        super().__init__()
        self.did: Counter[str] = Counter()
        self._guard = guard

    def hear(self, time: int, message: Message) -> None:
        """See `Way`."""
        self._act(time)
        super().hear(time, message)
        self._step(time, message)

    def command(self, time: int, message: Message) -> None:
        """See `Way`."""
        self._act(time)
        self._step(time, message, asked="_raw")

    def arrived(self, time: int) -> list[Message]:
        """See `Way`."""
        self._act(time)
        return super().arrived(time)

    def _act(self, time: int) -> None:
        """What the guard sends by itself by now comes before what is there now."""
        if (due := self._guard.due) is not None and due <= time:
            self._step(time, ("", {}))

    def _step(self, time: int, message: Message, asked: str = "") -> None:
        topic, values = message
        row = {f"{topic}{asked}/{path}": value for path, value in values.items()}
        for deed in self._guard.step(row, time_ns=time):
            self.did[deed.action.value] += 1
            if deed.values is not None:
                out = deed.outs[0]
                sent = values if deed.message is None else {**ZERO[out], **self._guard.fallbacks[deed.message]}
                super().command(deed.time, (out, sent))


def drive(scene: Scene, way: Way) -> World:
    """Let the robot be driven, and return the world as it is at the end."""
    world = World(scene.layout)
    for ms in range(0, scene.seconds * 1000, TICK):
        for message in scene.sense(world, ms):
            way.hear(ms * MS, message)
        for message in scene.control(world, ms):
            way.command(ms * MS, message)
        for message in way.arrived(ms * MS):
            world.obey(message)
        world.step()
    return world


def rows(heard: Sequence[tuple[int, Message]]) -> Iterator[tuple[Decimal, dict[str, object]]]:
    """What was heard as rows of a recording, each after its time in s."""
    for time, (topic, values) in heard:
        yield Decimal(time) / 1_000_000_000, {f"{topic}/{path}": value for path, value in values.items()}


def violated(name: str, recording: Path | Sequence[tuple[Decimal, dict[str, object]]]) -> str:
    """How many properties are violated by what the robot was told, of how many."""
    verdicts = ltlc.run(HERE / f"{name}.txt", recording).verdicts
    return f"{sum(each is ltlc.Verdict.VIOLATED for each in verdicts.values())} of {len(verdicts)}"


HEAD = """\
| | without the guard | violated | with the guard | violated | passed | changed | held back | sent |
|---|---|---|---|---|---|---|---|---|
"""


@dataclass(frozen=True)
class Row:
    """A row of the table."""

    name: str
    crash: str
    broken: str
    kept: str
    unbroken: str
    did: Mapping[str, int]

    def __str__(self) -> str:
        counts = " | ".join(f"{self.did[each]:,}" for each in DID)
        return f"| `{self.name}` | {self.crash} | {self.broken} | {self.kept} | {self.unbroken} | {counts} |"

    @property
    def is_good(self) -> bool:
        """Whether the guard kept what was violated without it."""
        return self.unbroken.startswith("0 ") and not self.broken.startswith("0 ") and not self.did["lost"]


def tried(name: str, folder: Path | None = None) -> Row:
    """A scene without its guard, of which a recording goes to `folder`, and with it."""
    before, after = SCENES[name](), SCENES[name]()
    way, guarded = Unguarded(), Guarded(ltlc.guard(HERE / f"{name}.txt"))
    crashed, kept = drive(before, way), drive(after, guarded)
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        lines = (json.dumps({"time": float(time), **row}) + "\n" for time, row in rows(way.heard))
        (folder / f"{name}.jsonl").write_text("".join(lines), encoding="utf-8")
    broken, unbroken = (violated(name, list(rows(each.heard))) for each in (way, guarded))
    return Row(name, before.shown(crashed), broken, after.shown(kept), unbroken, guarded.did)


def main() -> int:
    """Print the table; the exit code is 1 if it is not as it should be."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"{', '.join(SCENES)} (default: all)")
    parser.add_argument("--record", type=Path, metavar="FOLDER", help="write recordings of the drives without a guard")
    options = parser.parse_args()
    if unknown := [name for name in options.names if name not in SCENES]:
        parser.error(f"there is no scene {', '.join(unknown)}: the scenes are {', '.join(SCENES)}")
    print(HEAD, end="", flush=True)
    are_good = True
    for name in options.names or SCENES:
        row = tried(name, options.record)
        print(row, flush=True)
        are_good &= row.is_good
    return 0 if are_good else 1


if __name__ == "__main__":
    sys.exit(main())
