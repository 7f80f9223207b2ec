"""What a node makes of the messages that are handed to it: their order, and those that are none."""

from __future__ import annotations

import gc
import json
import random
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

PROPERTIES = """
decl a /a std_msgs/Float64.data
decl b /b std_msgs/Float64.data
low: never a > b + 1e9
"""

SECOND = 10**9


@pytest.fixture
def names() -> dict[str, Any]:
    """What the text of an emitted node defines."""
    names = load(emitted_text(PROPERTIES), "watch")
    names["import_ros"]()
    return names


@pytest.fixture
def watch(names: dict[str, Any], tmp_path: Path) -> Iterator[Callable[..., Any]]:
    """Makes the inside of a node that records what it judges, and what hands messages to it by topic."""
    import rclpy

    def make(**parameters: object) -> Any:
        given = {"record": str(tmp_path / "drive.jsonl"), "jsonl": str(tmp_path / "verdicts.jsonl"), **parameters}
        node, watch = inside(names, given)
        listeners = {each.topic_name: each.callback for each in node.subscriptions if each.topic_name in ("/a", "/b")}
        assert set(listeners) == {"/a", "/b"}
        return node, watch, listeners

    with own_domain(tmp_path):
        yield make
        rclpy.shutdown()


def handed(listener: Any, number: int, received: int, data: bytes) -> None:
    listener(data, {"received_timestamp": received, "publication_sequence_number": number})


def wire(value: float) -> bytes:
    from rclpy.serialization import serialize_message
    from std_msgs.msg import Float64

    return bytes(serialize_message(Float64(data=value)))


def recorded(folder: Path) -> list[float]:
    """The values that were judged, in their order."""
    found = [json.loads(line) for line in (folder / "drive.jsonl").read_text(encoding="utf-8").splitlines()]
    return [each[name] for each in found for name in ("a", "b") if name in each]


@pytest.mark.parametrize("is_simulated", [False, True])
def test_messages_are_judged_in_the_order_of_the_clock_and_then_of_their_receipt(
    is_simulated: bool, watch: Callable[..., Any], tmp_path: Path
) -> None:
    node, within, listeners = watch(use_sim_time=str(is_simulated).lower())
    draw, begun, clock = random.Random(1), time.time_ns() - 100 * SECOND, 0
    expected: list[float] = []
    numbers = dict.fromkeys(listeners, 0)
    for batch in range(40):
        waiting = []
        times = {topic: sorted(draw.sample(range(1000), draw.randrange(6))) for topic in ("/a", "/b")}
        for topic in draw.sample(["/a", "/b"], 2):
            if is_simulated:
                clock += draw.randrange(2)
                be_at(node, 7 + clock)
            for at in times[topic]:
                numbers[topic] += 1
                received = 1000 * batch + at
                handed(listeners[topic], numbers[topic], begun + received, wire(float(received)))
                waiting.append((clock, received))
        expected += [float(received) for _, received in sorted(waiting)]
        within.attend(lambda looks: True)
    within.end()
    assert recorded(tmp_path) == expected


def be_at(node: Any, seconds: int) -> None:
    """It is so late on the simulated clock of `node`."""
    from rclpy.clock import ClockType
    from rclpy.time import Time

    node.get_clock().set_ros_time_override(Time(seconds=seconds, clock_type=ClockType.ROS_TIME))


def test_a_malformed_message_is_counted_and_makes_no_step(watch: Callable[..., Any], tmp_path: Path) -> None:
    _, within, listeners = watch()
    begun = time.time_ns() - SECOND
    for number, data in enumerate([wire(1.0), b"", wire(1.0)[:7], wire(2.0)], 1):
        handed(listeners["/a"], number, begun + number, data)
        handed(listeners["/b"], number, begun + number, wire(float(number)))
    within.attend(lambda looks: True)
    assert within.end() == 3
    final = json.loads((tmp_path / "verdicts.jsonl").read_text(encoding="utf-8").splitlines()[-1])
    (low,) = final["properties"]
    assert (low["steps"], low["malformed_messages"], low["verdict"]) == (5, {"/a": 2}, "presumably_satisfied")
    assert recorded(tmp_path) == [1.0, 1.0, 2.0, 3.0, 2.0, 4.0]


def test_a_gap_and_a_doubt_add_up_to_no_number(watch: Callable[..., Any], tmp_path: Path) -> None:
    _, within, listeners = watch()
    handed(listeners["/b"], 1, time.time_ns(), wire(1.0))
    arrived = time.time_ns()
    for number in range(1100):
        handed(listeners["/a"], 7120 + number + 50 * (number > 1050), arrived, wire(1.0))
    within.attend(lambda looks: True)
    assert within.end() == 3
    final = json.loads((tmp_path / "verdicts.jsonl").read_text(encoding="utf-8").splitlines()[-1])
    assert final["properties"][0]["lost_messages"] == {"/a": None}
    assert final["properties"][0]["lost_at_least"] == {"/a": 50}


def test_a_diagnosis_that_took_long_is_not_made_again_at_once(
    watch: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    _, within, _ = watch()
    made: list[float] = []
    now = time.monotonic()
    monkeypatch.setattr(time, "monotonic", lambda: now)

    def diagnose() -> None:
        nonlocal now
        made.append(now)
        now += 0.05

    within._diagnose = diagnose
    for _ in range(3):
        within._next_diagnosis = 0.0  # as where a verdict has changed
        within.keep_house()
    assert len(made) == 1
    assert within._rested == pytest.approx(made[0] + 0.05 + 0.5)
    now = within._rested
    within.keep_house()
    assert len(made) == 2
    within.end()


def test_a_node_searches_for_garbage_more_rarely_than_python_would(names: dict[str, Any]) -> None:
    before, usual = gc.get_threshold(), 700
    names["watch_until"] = lambda *_: None
    try:
        gc.set_threshold(usual)
        assert names["watched"](None, None, SimpleNamespace(end=lambda: 0)) == 0
        assert gc.get_threshold()[0] > usual
    finally:
        gc.unfreeze()
        gc.set_threshold(*before)
