"""What end-to-end tests need: emitted nodes as processes, in a ROS domain of their own, and ways to wait for them."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Self

from stepping import from_text

from ltlc.backends import emit
from ltlc.falsification.domains import free_domains
from ltlc.interfaces.building.guards import guard_entries, guard_programs

PATIENCE = 300.0
"""How long to wait for what has to happen, in s: so long that only what will never happen is given up."""


PROFILES = """<dds xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles"><profiles>
<data_writer profile_name="writers" is_default_profile="true">
<qos><data_sharing><kind>OFF</kind></data_sharing></qos>
<times><heartbeatPeriod><nanosec>20000000</nanosec></heartbeatPeriod></times>
<historyMemoryPolicy>PREALLOCATED_WITH_REALLOC</historyMemoryPolicy>
</data_writer>
<data_reader profile_name="readers" is_default_profile="true">
<qos><data_sharing><kind>OFF</kind></data_sharing></qos>
<historyMemoryPolicy>PREALLOCATED_WITH_REALLOC</historyMemoryPolicy>
</data_reader>
</profiles></dds>
"""
"""Publishers as rmw_fastrtps makes them, but that ask every 20 ms, not every 3 s, whether a message was lost.

A reader holds back what follows a lost message on its topic, while other topics go on.
"""

Send = Callable[..., None]
"""Sends values of x."""


def wait_until(happens: Callable[[], object], what: str, meanwhile: Callable[[], object] | None = None) -> None:
    """Return as soon as `happens()`; do `meanwhile` between looks."""
    deadline = time.monotonic() + PATIENCE
    while not happens():
        assert time.monotonic() < deadline, f"waited for {PATIENCE} s in vain: {what}"
        if meanwhile is None:
            time.sleep(0.02)
        else:
            meanwhile()


@contextmanager
def own_domain(folder: Path) -> Iterator[None]:
    """A ROS domain that nobody else on this machine uses, for this process and its children."""
    profiles = folder / "profiles.xml"
    profiles.write_text(PROFILES, encoding="utf-8")
    with free_domains(1) as [domain]:
        changes = {
            "FASTRTPS_DEFAULT_PROFILES_FILE": str(profiles),
            "RMW_FASTRTPS_USE_QOS_FROM_XML": "1",
            "ROS_DOMAIN_ID": str(domain),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "ROS_LOG_DIR": str(folder),
        }
        before = {name: os.environ.get(name) for name in changes}
        os.environ.update(changes)
        try:
            yield
        finally:
            for name, value in before.items():
                os.environ.pop(name, None)
                if value is not None:
                    os.environ[name] = value


def emitted_text(text: str, name: str = "watch.txt") -> str:
    """The emitted node for a specification in a file called `name`."""
    compiled, specification = from_text(text, name)
    guards = guard_programs(specification, compiled, guard_entries(specification, compiled))
    return emit("ros2", compiled, specification, guards)


def emitted(text: str, folder: Path, name: str = "watch") -> Path:
    """The emitted node for a specification, beside the specification."""
    specification, node = folder / f"{name}.txt", folder / f"{name}_monitor.py"
    specification.write_text(text, encoding="utf-8")
    node.write_text(emitted_text(text, specification.name), encoding="utf-8")
    return node


def inside(names: Mapping[str, Any], parameters: Mapping[str, object]) -> tuple[Any, Any]:
    """The ROS node called `watch`, and what judges its messages, of the emitted node that defines `names`."""
    import rclpy
    from rclpy.signals import SignalHandlerOptions

    arguments = [word for name, value in parameters.items() for word in ("-p", f"{name}:={value}")]
    rclpy.init(args=["--ros-args", *arguments], signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("watch", automatically_declare_parameters_from_overrides=True)
    plan = names["plan"]()
    options = names["read_options"](node, plan)
    topics, guarded = names["topics_to_read"](), names["topics_to_guard"]()
    return node, names["Watch"](node, plan, topics, guarded, options, names["PROVENANCE"], names["Pulse"]())


class Program:
    """A Python program in a process of its own, its output in files; to be used in a `with` statement."""

    def __init__(self, script: Path, *arguments: str, folder: Path) -> None:
        self.log_path = folder / f"{script.stem}.log"
        with self.log_path.open("w") as log:
            command = [sys.executable, str(script), *arguments]
            self.process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT, start_new_session=True)

    @property
    def log(self) -> str:
        return self.log_path.read_text(encoding="utf-8")

    @property
    def has_ended(self) -> bool:
        return self.process.poll() is not None

    def end(self, number: int = signal.SIGINT) -> int:
        """Send a signal; the exit code."""
        self.process.send_signal(number)
        return self.exit_code()

    def pause(self) -> None:
        """Stop it with all its processes, until `resume`."""
        os.killpg(self.process.pid, signal.SIGSTOP)

    def resume(self) -> None:
        os.killpg(self.process.pid, signal.SIGCONT)

    def exit_code(self) -> int:
        """That with which the program ends."""
        return self.process.wait(PATIENCE)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if not self.has_ended:
            self.process.kill()
            self.process.wait()


class Node(Program):
    """An emitted node that writes its verdicts to files."""

    def __init__(self, script: Path, folder: Path, *arguments: str, **parameters: object) -> None:
        self.jsonl, self.junit = folder / "verdicts.jsonl", folder / "verdicts.xml"
        given = {"jsonl": self.jsonl, "junit": self.junit, **parameters}
        options = [word for name, value in given.items() for word in ("-p", f"{name}:={value}")]
        super().__init__(script, "--ros-args", *options, *arguments, folder=folder)

    @property
    def child(self) -> int:
        """The process that the watchdog looks after, in which the node does its work."""
        (child,) = Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children").read_text().split()
        return int(child)

    @property
    def lines(self) -> list[dict[str, Any]]:
        """What the node has written so far."""
        if not self.jsonl.exists():
            return []
        complete = self.jsonl.read_text(encoding="utf-8").split("\n")[:-1]
        return [json.loads(line) for line in complete]

    @property
    def changes(self) -> list[tuple[str, str]]:
        """The changes of verdict so far, as label and verdict."""
        return [(line["label"], line["verdict"]) for line in self.lines if "label" in line]

    @property
    def runs(self) -> list[dict[str, dict[str, Any]]]:
        """The final reports of each run that has ended, by label."""
        return [by_label(line) for line in self.lines if line.get("final")]


def by_label(report: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """The properties of a report."""
    return {each["label"]: each for each in report["properties"]}


class Network:
    """The test's own end of ROS: publishers, and what is heard on /diagnostics and of verdicts."""

    def __init__(self) -> None:
        import rclpy
        from diagnostic_msgs.msg import DiagnosticArray
        from rclpy.executors import SingleThreadedExecutor
        from rclpy.signals import SignalHandlerOptions

        rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
        self.node = rclpy.create_node("test")
        self.statuses: dict[str, Any] = {}
        self.latest_diagnosis = (0, 0)
        self.verdicts: list[dict[str, Any]] = []
        self._clock: Any = None
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self.node)
        self.node.create_subscription(DiagnosticArray, "/diagnostics", self._diagnosed, 100)

    def _diagnosed(self, array: Any) -> None:
        self.latest_diagnosis = (array.header.stamp.sec, array.header.stamp.nanosec)
        self.statuses.update({status.name: status for status in array.status})

    def message(self, name: str) -> str:
        """The latest message of the status called `name`; nothing before the first."""
        return str(self.statuses[name].message) if name in self.statuses else ""

    def hear_verdicts(self, topic: str) -> None:
        """Take what comes on `topic`, and what came before."""
        from std_msgs.msg import String

        self.listen(String, topic, lambda m: self.verdicts.append(json.loads(m.data)))

    def listen(self, kind: Any, topic: str, take: Callable[[Any], object]) -> None:
        """Take what comes on `topic`, and what is kept of what came before."""
        from rclpy.qos import DurabilityPolicy, QoSProfile

        profile = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.node.create_subscription(kind, topic, take, profile)

    def publisher(self, kind: Any, topic: str, profile: Any = 1000) -> Any:
        return self.node.create_publisher(kind, topic, profile)

    def tell_time(self, seconds: int) -> None:
        """It is `seconds` on /clock from now on.

        That is said again and again, as simulations do: what comes before a reader of /clock has matched, it misses.
        """
        from rosgraph_msgs.msg import Clock

        if self._clock is None:
            self._clock = self.publisher(Clock, "/clock")
            self._told = Clock()
            self.node.create_timer(0.05, lambda: self._clock.publish(self._told))
        self._told.clock.sec = seconds
        self._clock.publish(self._told)

    def withdraw(self, topic: str) -> None:
        """Publish on `topic` no more."""
        for publisher in [p for p in self.node.publishers if p.topic_name == topic]:
            self.node.destroy_publisher(publisher)

    def matched(self, publishers: Sequence[Any]) -> None:
        """Wait until somebody has subscribed to each of `publishers`."""
        self.wait_until(lambda: all(p.get_subscription_count() for p in publishers), "a subscriber")

    def wait_until(self, happens: Callable[[], object], what: str) -> None:
        wait_until(happens, what, lambda: self._executor.spin_once(timeout_sec=0.02))

    def close(self) -> None:
        from rclpy.utilities import try_shutdown

        self._executor.shutdown()
        self.node.destroy_node()
        try_shutdown()
