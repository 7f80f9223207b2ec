"""What a node with a guard makes of the messages that are handed to it: their order, and those that are none."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from ros_support import emitted_text, inside, own_domain

from ltlc.assurance.programs import load

pytestmark = pytest.mark.ros
pytest.importorskip("rclpy", reason="needs ROS 2: install ltlc[ros]")

GUARD = """guard /raw to /out else stop
message stop {linear.x: -1}
decl speed /out geometry_msgs/Twist.linear.x
decl near /near std_msgs/Bool.data
slow: always (new speed and near implies speed <= 0.2)
"""


class Handed:
    """The inside of a node with a guard, what leaves it, and what it does."""

    def __init__(self, names: dict[str, Any], folder: Path) -> None:
        self.jsonl = folder / "deeds.jsonl"
        self.node, self.watch = inside(names, {"jsonl": self.jsonl})
        self.listeners = {each.topic_name: each.callback for each in self.node.subscriptions}
        self.left: list[bytes] = []
        (way,) = self.watch._commands.ways.values()
        way.pass_on = self.left.append

    def hand(self, topic: str, data: bytes) -> None:
        self.listeners[topic](data, {"received_timestamp": time.time_ns(), "publication_sequence_number": None})

    def attend(self) -> None:
        self.watch.attend(lambda looks: True)

    @property
    def deeds(self) -> list[tuple[str, str]]:
        """What the guard did but pass commands, and why."""
        lines = self.jsonl.read_text(encoding="utf-8").splitlines() if self.jsonl.exists() else []
        return [(line["action"], line["reason"]) for line in map(json.loads, lines) if "action" in line]


@pytest.fixture
def handed(tmp_path: Path) -> Iterator[Callable[..., Handed]]:
    import rclpy

    def make(text: str = GUARD, settling: float = 0.0) -> Handed:
        names = load(emitted_text(text), "watch")
        names["import_ros"]()
        names["Commands"].SETTLING = settling
        return Handed(names, tmp_path)

    with own_domain(tmp_path):
        yield make
        rclpy.shutdown()


def twist(x: float) -> bytes:
    from geometry_msgs.msg import Twist
    from rclpy.serialization import serialize_message

    message = Twist()
    message.linear.x, message.angular.y = x, 2.0
    return bytes(serialize_message(message))


def is_near(data: bool) -> bytes:
    from rclpy.serialization import serialize_message
    from std_msgs.msg import Bool

    return bytes(serialize_message(Bool(data=data)))


def test_what_waits_on_other_topics_is_taken_before_commands(handed: Callable[..., Handed]) -> None:
    one = handed()
    one.hand("/near", is_near(False))
    one.hand("/raw", twist(1.0))
    one.attend()
    assert one.left == [twist(1.0)]
    one.hand("/raw", twist(1.0))
    one.hand("/near", is_near(True))
    one.attend()
    assert one.deeds == [("changed", "it would violate `slow`")]


def test_a_command_that_waits_has_all_that_was_received_looked_for(handed: Callable[..., Handed]) -> None:
    one = handed()
    one.hand("/near", is_near(False))
    one.attend()
    one.hand("/raw", twist(1.0))

    def let_in(looks: int) -> bool:
        one.hand("/near", is_near(True))
        return True

    one.watch.attend(let_in)
    assert one.deeds == [("changed", "it would violate `slow`")]


def test_nothing_leaves_before_other_publishers_have_been_looked_for(handed: Callable[..., Handed]) -> None:
    one = handed(settling=1e9)
    one.hand("/near", is_near(False))
    one.hand("/raw", twist(1.0))
    one.attend()
    assert one.left == []
    assert one.deeds == [("held_back", "it is too early")]


def test_the_log_does_not_repeat_what_is_done_for_the_same_reason(handed: Callable[..., Handed]) -> None:
    one = handed()
    logged: list[str] = []
    one.watch._deeds._node.get_logger = lambda: SimpleNamespace(warning=logged.append, error=logged.append)
    one.hand("/near", is_near(True))
    for _ in range(3):
        one.hand("/raw", twist(1.0))
        one.attend()
    assert len(one.deeds) == 3
    (line,) = logged
    assert line.endswith("changed speed = 1.0 to `stop`: it would violate `slow`")


@pytest.mark.parametrize(("data", "reason"), [(b"", "it is malformed"), (twist, "it has no value")])
def test_what_cannot_be_read_or_compared_does_not_leave(
    data: object, reason: str, handed: Callable[..., Handed]
) -> None:
    one = handed()
    one.hand("/near", is_near(False))
    one.hand("/raw", twist(float("nan")) if callable(data) else b"")
    one.attend()
    action = "changed" if callable(data) else "held_back"
    assert one.deeds == [(action, reason)]
    assert twist(float("nan")) not in one.left


def test_a_new_run_waits_for_the_sensors_again(handed: Callable[..., Handed]) -> None:
    one = handed()
    one.hand("/near", is_near(False))
    one.hand("/raw", twist(1.0))
    one.attend()
    one.watch._begin_anew(2, 1)
    one.hand("/raw", twist(1.0))
    one.attend()
    one.attend()
    assert one.left == [twist(1.0)]
    one.hand("/near", is_near(False))
    one.hand("/raw", twist(1.0))
    one.attend()
    assert one.left == [twist(1.0)] * 2


@pytest.mark.parametrize(
    ("kind", "written", "value"),
    [
        ("std_msgs/Int16", "data: 3", 3),
        ("std_msgs/Bool", "data: true", True),
        ("std_msgs/String", 'data: "dock"', "dock"),
        ("std_msgs/Byte", "data: 7", b"\x07"),
        ("std_msgs/Float32", "data: 0.1", pytest.approx(0.1)),
    ],
)
def test_a_fallback_has_its_constants_as_the_fields_have_them(
    kind: str, written: str, value: object, handed: Callable[..., Handed]
) -> None:
    from rclpy.serialization import deserialize_message

    from ltlc.backends.ros2.node.classes import class_of

    compared = {"std_msgs/Bool": "x", "std_msgs/String": 'x == "dock"'}.get(kind, "x < 100")
    one = handed(
        f"guard /raw to /out else f\nmessage f {{{written}}}\ndecl x /out {kind}.data\nkept: always {compared}\n"
    )
    (way,) = one.watch._commands.ways.values()
    way.send("f")
    (data,) = one.left
    package, name = kind.split("/")
    assert deserialize_message(data, class_of(f"{package}/msg/{name}")).data == value
