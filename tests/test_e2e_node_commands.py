"""A node with a guard: what leaves it, bit for bit or instead, and when it refuses, loses, or begins anew."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from ros_support import Network, Node, emitted

pytestmark = pytest.mark.ros
pytest.importorskip("rclpy", reason="needs ROS 2: install ltlc[ros]")

GUARD = """guard /raw to /out else stop
message stop {linear.y: -1, angular.z: 0.5}
decl speed /out geometry_msgs/Twist.linear.x
decl near /near std_msgs/Bool.data
decl battery /battery std_msgs/Float64.data
"""
PROPERTIES = """
near: always (near implies eventually speed <= 0.2 within 100 s)
slow: always (new speed and near implies speed <= 0.2)
level: never speed > 5 and not near
charged: always battery > 0.1
"""
"""`charged` is about no command: it is watched. So long a bound passes only on the clock that the test sets."""

STATUS = "watch_monitor: guard of /out"
"""The guard's on /diagnostics."""


@pytest.fixture(scope="module")
def script(folder: Path) -> Path:
    return emitted(GUARD + PROPERTIES, folder)


def twist(x: float) -> Any:
    """A command; what no property reads is not zero."""
    from geometry_msgs.msg import Twist

    message = Twist()
    message.linear.x, message.linear.z, message.angular.y = x, 0.1, 1e-300
    return message


def data(message: Any) -> bytes:
    from rclpy.serialization import serialize_message

    return bytes(serialize_message(message))


def stop() -> bytes:
    from geometry_msgs.msg import Twist

    message = Twist()
    message.linear.y, message.angular.z = -1.0, 0.5
    return data(message)


class Drive:
    """The test's controller, sensor and robot around a node whose guard has begun to listen."""

    def __init__(self, network: Network, node: Node) -> None:
        from geometry_msgs.msg import Twist
        from std_msgs.msg import Bool, Float64, String

        self.network, self.node = network, node
        self.left: list[bytes] = []
        self.deeds: list[dict[str, Any]] = []
        network.node.create_subscription(Twist, "/out", lambda m: self.left.append(bytes(m)), 1000, raw=True)
        network.listen(String, "/watch_monitor/guard", lambda m: self.deeds.append(json.loads(m.data)))
        self._commands, self._near = network.publisher(Twist, "/raw", 1), network.publisher(Bool, "/near")
        network.tell_time(100)
        self.battery = network.publisher(Float64, "/battery")
        network.matched([self._commands, self._near, self.battery])

    def command(self, x: float) -> None:
        self._commands.publish(twist(x))

    def ask(self, x: float) -> dict[str, Any] | None:
        """Command `x`, and wait for what the guard does with it; None: it has passed."""
        before, left = len(self.deeds), len(self.left)

        def about_it() -> list[dict[str, Any]]:
            return [deed for deed in self.deeds[before:] if deed["command"] == {"speed": x}]

        self.command(x)
        self.network.wait_until(lambda: about_it() or data(twist(x)) in self.left[left:], "an answer")
        return next(iter(about_it()), None)

    def asks_until(self, x: float, action: str) -> dict[str, Any]:
        """Command `x` until the guard has done `action`."""
        before = len(self.deeds)
        self.network.wait_until(
            lambda: self.ask(x) and any(deed["action"] == action for deed in self.deeds[before:]), action
        )
        return next(deed for deed in self.deeds[before:] if deed["action"] == action)

    def loses(self) -> str:
        """Why the guard has lost, once it has."""
        self.network.wait_until(lambda: self.did("lost"), "a loss")
        (lost,) = self.did("lost")
        return str(lost["reason"])

    def passes(self, x: float) -> None:
        """Command `x` until it has passed."""
        self.network.wait_until(lambda: self.ask(x) is None, "a command that passes")

    def did(self, action: str) -> list[dict[str, Any]]:
        """The deeds of an action so far."""
        return [deed for deed in self.deeds if deed["action"] == action]

    def near(self, is_near: bool) -> None:
        from std_msgs.msg import Bool

        self._near.publish(Bool(data=is_near))

    def heard(self, count: int, topic: str = "/near", label: str = "level") -> None:
        """Wait until the node has taken so many messages on a topic, which the property `label` reads."""
        name, key = f"watch_monitor: {label}", f"messages on {topic}"

        def is_heard() -> bool:
            status = self.network.statuses.get(name)
            values = {each.key: each.value for each in status.values} if status else {}
            return values.get(key) == str(count)

        self.network.wait_until(is_heard, f"{count} messages on {topic}")


@pytest.fixture
def drive(script: Path, network: Network, tmp_path: Path) -> Iterator[Drive]:
    with Node(script, tmp_path, use_sim_time="true") as node:
        yield Drive(network, node)


def begun(drive: Drive) -> None:
    """The sensors have spoken, and a fast command has passed."""
    from std_msgs.msg import Float64

    drive.battery.publish(Float64(data=1.0))
    drive.heard(1, "/battery", "charged")
    drive.near(False)
    drive.passes(1.0)


def guard_of(drive: Drive) -> dict[str, Any]:
    """What the node reports of its guard in the end."""
    found: list[dict[str, Any]] = next(line for line in reversed(drive.node.lines) if line.get("final"))["guard"]
    assert len(found) == 1
    return found[0]


def test_nothing_leaves_before_the_sensors_have_spoken_and_then_commands_pass_bit_for_bit(drive: Drive) -> None:
    drive.network.wait_until(
        lambda: (drive.ask(1.0) or {}).get("reason") == "a topic has not spoken yet",
        "a command that is held back by the guard",
    )
    assert drive.left == []
    begun(drive)
    assert set(drive.left) == {data(twist(1.0))}
    assert {deed["action"] for deed in drive.deeds} == {"held_back"}
    assert drive.node.end() == 0
    found = guard_of(drive)
    assert (found["raw"], found["out"], found["commands_from"]) == ("/raw", "/out", "/raw")
    assert found["counts"]["passed"] == len(found["passed"]) == len(drive.left) == 1
    written = [line["action"] for line in drive.node.lines if "action" in line]
    assert written == ["held_back"] * found["counts"]["held_back"]
    assert "guard of /out: " in drive.node.log


def test_what_would_violate_is_replaced_by_the_fallback_and_reported(drive: Drive) -> None:
    begun(drive)
    drive.near(True)
    drive.heard(2)
    deed = drive.ask(2.0)
    assert deed is not None
    assert (deed["guards"], deed["message"], deed["reason"]) == (["/out"], "stop", "it would violate `slow`")
    assert (deed["command"], deed["sent"]) == ({"speed": 2.0}, {"speed": 0.0})
    drive.network.wait_until(lambda: stop() in drive.left, "the fallback")
    drive.passes(0.125)
    assert data(twist(2.0)) not in drive.left
    assert drive.node.end() == 0
    assert deed in drive.node.lines


def test_a_property_about_no_command_is_watched_in_the_same_node(drive: Drive) -> None:
    from std_msgs.msg import Float64

    begun(drive)
    drive.near(True)
    drive.battery.publish(Float64(data=0.05))
    drive.network.wait_until(lambda: ("charged", "violated") in drive.node.changes, "the violation")
    drive.asks_until(2.0, "changed")
    assert drive.node.end() == 1
    (run,) = drive.node.runs
    verdicts = {label: run[label]["verdict"] for label in run}
    assert verdicts["slow"] == "presumably_satisfied"
    assert guard_of(drive)["counts"]["lost"] == 0


def test_the_fallback_leaves_by_itself_ahead_of_a_deadline(drive: Drive) -> None:
    begun(drive)
    drive.near(True)
    drive.heard(2)
    assert stop() not in drive.left
    drive.network.tell_time(200)
    drive.network.wait_until(lambda: drive.did("sent") and stop() in drive.left, "the fallback")
    (deed,) = drive.did("sent")
    assert (deed["reason"], deed["time"], deed["command"]) == ("ahead of a deadline of `near`", 200, None)
    drive.network.tell_time(300)
    assert drive.node.end() == 0
    assert drive.node.runs[0]["near"]["verdict"] == "presumably_satisfied"


def test_a_node_that_was_stopped_over_a_deadline_has_lost_and_lets_nothing_forbidden_through(drive: Drive) -> None:
    from diagnostic_msgs.msg import DiagnosticStatus

    begun(drive)
    drive.near(True)
    drive.heard(2)
    before = len(drive.left)
    drive.node.pause()
    drive.network.tell_time(500)
    drive.node.resume()
    why = drive.loses()
    assert why == "it was late, 300 s after a deadline of `near`"
    for x in (3.0, 0.125):
        changed = drive.ask(x)
        assert changed is not None
        assert (changed["action"], changed["reason"]) == ("changed", f"the guard has lost: {why}")
    assert set(drive.left[before:]) <= {stop()}
    drive.network.wait_until(lambda: "lost" in drive.network.message(STATUS), "a diagnosis")
    status = drive.network.statuses[STATUS]
    assert (status.level, {each.key: each.value for each in status.values}["lost"]) == (DiagnosticStatus.ERROR, "1")
    assert drive.node.end() == 1
    assert guard_of(drive)["counts"]["lost"] == 1
    assert f"guard of /out, +400 s: lost: {why}\n" in drive.node.log


def test_what_was_commanded_while_a_node_was_stopped_is_decided_by_what_it_knows(drive: Drive) -> None:
    begun(drive)
    drive.near(True)
    drive.heard(2)
    before = len(drive.left)
    drive.node.pause()
    for _ in range(20):
        drive.command(3.0)
    drive.node.resume()
    drive.network.wait_until(lambda: drive.did("changed") and len(drive.left) > before, "the fallback")
    assert set(drive.left[before:]) == {stop()}


def test_a_guard_that_lost_guards_again_once_it_is_restarted(
    drive: Drive, script: Path, network: Network, tmp_path: Path
) -> None:
    begun(drive)
    drive.near(True)
    drive.heard(2)
    drive.node.pause()
    network.tell_time(500)
    drive.node.resume()
    drive.loses()
    network.tell_time(50)  # a new run; the loss remains
    network.wait_until(lambda: len(drive.node.runs) == 1, "a new run")
    drive.near(False)
    assert drive.asks_until(0.125, "changed")["reason"].startswith("the guard has lost")
    assert drive.node.end() == 1
    folder = tmp_path / "again"
    folder.mkdir()
    with Node(script, folder, use_sim_time="true") as node:
        again = Drive(network, node)
        begun(again)
        assert node.end() == 0


def test_a_node_refuses_to_guard_what_another_one_publishes(script: Path, network: Network, tmp_path: Path) -> None:
    from geometry_msgs.msg import Twist

    network.publisher(Twist, "/out")
    with Node(script, tmp_path) as node:
        assert node.exit_code() == 2
    (error,) = [line for line in node.log.splitlines() if line.startswith("watch_monitor: ")]
    assert error.removeprefix("watch_monitor: ") in [
        f"/out is also published by {name}, which would not be guarded: have it publish on /raw"
        for name in ("/test", "another node")
    ]


def test_who_begins_to_publish_later_beside_the_guard_is_reported(drive: Drive) -> None:
    from diagnostic_msgs.msg import DiagnosticStatus
    from geometry_msgs.msg import Twist

    begun(drive)
    other = drive.network.publisher(Twist, "/out")
    drive.network.wait_until(lambda: "/out is also published by /test" in drive.network.message(STATUS), "a report")
    assert drive.network.statuses[STATUS].level == DiagnosticStatus.WARN
    drive.network.node.destroy_publisher(other)
    assert drive.node.end() == 3
    assert re.search("/out is also published by (/test|another node), which is not guarded", drive.node.log)


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("-r", "/raw:=/out"), "/raw and /out are the same topic, /out"),
        (("-p", "rate:=10.0"), "rate is set, but a guard judges every message"),
    ],
)
def test_what_no_guard_can_do_is_refused(
    arguments: tuple[str, ...], reason: str, script: Path, folder: Path, tmp_path: Path
) -> None:
    with Node(script, tmp_path, *arguments) as node:
        assert node.exit_code() == 2
    assert node.log == f"watch_monitor: {reason}\n"


def test_what_leaves_shows_that_the_guard_lives_and_its_silence_that_it_hangs(drive: Drive) -> None:
    from geometry_msgs.msg import Twist
    from rclpy.duration import Duration
    from rclpy.event_handler import SubscriptionEventCallbacks
    from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy

    drive.network.wait_until(lambda: drive.network.node.count_publishers("/out"), "the publisher")
    (found,) = drive.network.node.get_publishers_info_by_topic("/out")
    offered = found.qos_profile
    assert offered.liveliness == LivelinessPolicy.MANUAL_BY_TOPIC
    assert offered.liveliness_lease_duration.nanoseconds == 5 * 10**8
    assert (offered.reliability, offered.durability) == (ReliabilityPolicy.RELIABLE, DurabilityPolicy.VOLATILE)
    alive: list[int] = []
    drive.network.node.create_subscription(
        Twist,
        "/out",
        lambda _: None,
        QoSProfile(
            depth=1,
            liveliness=LivelinessPolicy.MANUAL_BY_TOPIC,
            liveliness_lease_duration=Duration(seconds=1),
        ),
        event_callbacks=SubscriptionEventCallbacks(liveliness=lambda event: alive.append(event.alive_count)),
    )
    drive.network.wait_until(lambda: alive[-1:] == [1], "a guard that lives")
    drive.node.pause()
    drive.network.wait_until(lambda: alive[-1:] == [0], "a guard that hangs")
    drive.node.resume()
    drive.network.wait_until(lambda: alive[-1:] == [1], "a guard that lives again")
