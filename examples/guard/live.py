"""A controller that is told to crash, and the node of its guard, over ROS 2 and in real time.

    python examples/guard/live.py [NAME]

Builds the node from NAME.txt (people unless given) as build/NAME_guard.py, lets the controller drive through it, and
prints what happened, what the node did, and how many properties are violated as `ltlc.run` judges what the node has
recorded. The exit code is 0 if none is and the guard has not lost.
"""

from __future__ import annotations

import argparse
import importlib
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Set
from contextlib import contextmanager
from functools import partial, reduce
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import rclpy
from crash import HERE, ZERO, Unguarded, drive, violated
from rclpy.signals import SignalHandlerOptions
from scenes import SCENES
from world import Message

PATIENCE = 300.0
"""How long to wait for the node, in s."""

SETTLING = 1.5
"""In the first second of a guard's node, in which it looks for others that publish on its topic, nothing passes."""


class Topics:
    """The way of commands over topics; messages arrive as time goes by.

    The guard's node is called `guard`, is the `process`, and reads what comes on `topics`. Raises TimeoutError if it
    does not come up.
    """

    def __init__(self, guard: str, process: subprocess.Popen[bytes], topics: Set[str]) -> None:
        self._process = process
        self.heard: list[tuple[int, Message]] = []
        self._node = rclpy.create_node("simulation")
        self._arrived: list[Message] = []
        read = self._read_by(guard, topics)
        self._publishers = {
            topic: self._node.create_publisher(message_class(types[0]), topic, 10) for topic, types in read.items()
        }
        for topic, types in read.items():
            if (out := topic.removesuffix("_raw")) != topic:
                self._node.create_subscription(message_class(types[0]), out, partial(self._receive, out), 10)
        self._wait(lambda: all(p.get_subscription_count() for p in self._publishers.values()), f"{guard} listens")
        self._wait(lambda: all(map(self._node.count_publishers, self._outs)), f"{guard} publishes")
        sleep(SETTLING)
        self._start = monotonic()

    @property
    def _outs(self) -> list[str]:
        return [topic.removesuffix("_raw") for topic in self._publishers if topic.endswith("_raw")]

    def _read_by(self, guard: str, topics: Set[str]) -> dict[str, list[str]]:
        """The topics that the guard's node reads, with their types, once it reads all of `topics`.

        A node's subscriptions become known one after another.
        """

        def found() -> dict[str, list[str]]:
            if (guard, "/") not in self._node.get_node_names_and_namespaces():
                return {}
            return dict(self._node.get_subscriber_names_and_types_by_node(guard, "/"))

        self._wait(lambda: topics <= found().keys(), f"{guard} starts")
        return found()

    def _wait(self, happens: Callable[[], object], what: str) -> None:
        deadline = monotonic() + PATIENCE
        while not happens():
            if monotonic() > deadline or self._process.poll() is not None:
                raise TimeoutError(f"waited in vain: {what}")
            sleep(0.05)

    def hear(self, time: int, message: Message) -> None:
        """See `crash.Way`."""
        self._publish(*message)

    def command(self, time: int, message: Message) -> None:
        """See `crash.Way`."""
        self._publish(f"{message[0]}_raw", message[1])

    def arrived(self, time: int) -> list[Message]:
        """See `crash.Way`; returns when the clock of this machine has got there."""
        while (left := self._start + time / 1e9 - monotonic()) > 0:
            rclpy.spin_once(self._node, timeout_sec=left)
        rclpy.spin_once(self._node, timeout_sec=0)
        arrived, self._arrived = self._arrived, []
        return arrived

    def _publish(self, topic: str, values: Mapping[str, object]) -> None:
        message = self._publishers[topic].msg_type()
        for path, value in values.items():
            *parents, name = path.split("/")
            setattr(reduce(getattr, parents, message), name, value)
        self._publishers[topic].publish(message)

    def _receive(self, topic: str, message: Any) -> None:
        values = {path: reduce(getattr, path.split("/"), message) for path in ZERO[topic]}
        self._arrived.append((topic, values))


def published(name: str) -> set[str]:
    """The topics on which the sensors and the controller of a scene publish."""
    way = Unguarded()
    drive(SCENES[name](), way)
    return {f"{topic}_raw" if topic in ZERO else topic for _, (topic, _) in way.heard}


def message_class(name: str) -> Any:
    """The class of the messages called `name`, such as geometry_msgs/msg/Twist."""
    package, folder, kind = name.split("/")
    return getattr(importlib.import_module(f"{package}.{folder}"), kind)


def set_alone() -> None:
    """Have ROS 2 speak to processes of this program only."""
    os.environ.setdefault("ROS_DOMAIN_ID", str(random.randint(1, 99)))
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"


@contextmanager
def guard_node(script: Path, folder: Path) -> Iterator[subprocess.Popen[bytes]]:
    """The node of a guard, which records to `folder`."""
    files = ["-p", f"record:={folder / 'run.jsonl'}", "-p", f"jsonl:={folder / 'report.jsonl'}"]
    print(f"$ python {script}", flush=True)
    node = subprocess.Popen([sys.executable, str(script), "--ros-args", *files])
    try:
        yield node
    finally:
        if node.poll() is None:
            node.kill()
            node.wait()


def main() -> int:
    """Build, drive, judge."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("name", nargs="?", choices=SCENES, default="people")
    name = parser.parse_args().name
    script = Path("build") / f"{name}_guard.py"
    script.parent.mkdir(exist_ok=True)
    command = ["build", str(HERE / f"{name}.txt"), "-o", str(script)]
    print(f"$ ltlc {' '.join(command)}", flush=True)
    if code := subprocess.run([sys.executable, "-m", "ltlc", *command], check=False).returncode:
        return code
    set_alone()
    with tempfile.TemporaryDirectory() as kept, guard_node(script, Path(kept)) as node:
        rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
        try:
            scene = SCENES[name]()
            world = drive(scene, Topics(f"{name}_monitor", node, published(name)))
        except TimeoutError as error:
            print(f"simulation: {error}", file=sys.stderr)
            return 2
        except KeyboardInterrupt:
            return 130
        finally:
            rclpy.try_shutdown()
        if node.poll() is not None:
            print(f"simulation: the node has ended with {node.returncode}", file=sys.stderr)
            return 2
        node.send_signal(signal.SIGINT)
        node.wait(PATIENCE)
        return report(scene.shown(world), name, Path(kept))


def report(shown: str, name: str, folder: Path) -> int:
    """Print what happened; the exit code."""
    *_, last = (folder / "report.jsonl").read_text(encoding="utf-8").splitlines()
    lost = sum(guard["counts"]["lost"] for guard in json.loads(last)["guard"])
    found = violated(name, folder / "run.jsonl")
    print(f"\nThe robot {shown}; {found} properties violated{', and the guard has lost' if lost else ''}.")
    return 0 if found.startswith("0 ") and not lost else 1


if __name__ == "__main__":
    sys.exit(main())
