"""The emitted node writes what came around each violation to a file that other tools read, or asks a recorder to."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from ros_support import Network, Node, emitted
from rosbags.highlevel import AnyReader  # noqa: TID251
from rosbags.typesys import get_types_from_msg  # noqa: TID251

from ltlc.cli import main
from ltlc.inputs.messages.definitions import PLACEHOLDER, shipped
from ltlc.inputs.messages.texts import defined

pytestmark = pytest.mark.ros
pytest.importorskip("rclpy", reason="needs ROS 2: install ltlc[ros]")

PROPERTIES = """
decl x /x std_msgs/Float64.data
low: never x > 5
also: never x > 4
"""


@pytest.fixture(scope="module")
def script(folder: Path) -> Path:
    return emitted(PROPERTIES, folder)


def found_in(path: Path) -> list[tuple[str, int, bytes]]:
    """The topic, number and bytes of each message, by two readers that agree on times, topics and bytes."""
    with path.open("rb") as file:
        read = [(c.topic, m.log_time, m.sequence, m.data) for _, c, m in make_reader(file).iter_messages()]
    with AnyReader([path]) as reader:
        others = [(c.topic, time_, bytes(data)) for c, time_, data in reader.messages()]
    assert sorted((topic, time_, data) for topic, time_, _, data in read) == sorted(others)
    return [(topic, sequence, data) for topic, _, sequence, data in read]


def numbers_in(path: Path) -> list[float]:
    """What came on /x after the first ones."""
    with AnyReader([path]) as reader:
        read: list[Any] = [reader.deserialize(d, c.msgtype) for c, _, d in reader.messages() if c.topic == "/x"]
    return [each.data for each in read if each.data != FIRST]


FIRST = 0.5
"""What is sent until the node has heard it."""


def publisher(network: Network, node: Node) -> Any:
    """A publisher of x that the node hears; one that counts as matched may be so with a node that has ended."""
    from std_msgs.msg import Float64

    made = network.publisher(Float64, "/x")

    def is_heard() -> bool:
        made.publish(Float64(data=FIRST))
        return len(node.changes) >= 2

    network.wait_until(is_heard, "first verdicts")
    return made


def test_two_properties_that_are_violated_together_have_a_file_each_with_what_came_around(
    script: Path, network: Network, tmp_path: Path
) -> None:
    from std_msgs.msg import Float64, String

    noting = network.publisher(String, "/notes")
    topics = "[/x, /notes]"
    with Node(script, tmp_path, cut=tmp_path / "cut", cut_topics=topics, cut_before=60.0, cut_after=2.0) as node:
        sending = publisher(network, node)
        network.matched([noting])
        for number in (1.0, 2.0, 9.0, 3.0):
            noting.publish(String(data=f"before {number}"))
            sending.publish(Float64(data=number))
        network.wait_until(lambda: len(list((tmp_path / "cut").glob("*.mcap"))) == 2, "extracts")
        assert node.end() == 1
    first, second = sorted((tmp_path / "cut").iterdir())
    assert [first.name.partition("_")[0], second.name.partition("_")[0]] == ["also", "low"]
    for path in (first, second):
        assert numbers_in(path) == [1.0, 2.0, 9.0, 3.0]
        assert [topic for topic, _, _ in found_in(path)].count("/notes") == 4
    assert "extract of low: wrote" in node.log
    (tmp_path / "p.ltlc").write_text(PROPERTIES)
    assert main(["run", str(tmp_path / "p.ltlc"), str(first)]) == 1


def test_a_window_has_every_message_that_was_judged_in_it(script: Path, network: Network, tmp_path: Path) -> None:
    from std_msgs.msg import Float64

    record, cut = tmp_path / "drive.jsonl", tmp_path / "cut"
    with Node(script, tmp_path, cut=cut, cut_before=60.0, cut_after=1.0, record=record) as node:
        sending = publisher(network, node)
        began, count = time.monotonic(), 6000

        def is_violated() -> bool:
            """Whether 9 has come, which may be lost as any other."""
            sending.publish(Float64(data=9.0))
            return ("low", "violated") in node.changes

        for number in range(count):
            if number == count // 2:
                network.wait_until(is_violated, "the violation")
            sending.publish(Float64(data=number / 1e4))
            time.sleep(max(0.0, began + (number + 1) / 2000 - time.monotonic()))
        network.wait_until(lambda: len(list(cut.glob("*.mcap"))) == 2, "extracts")
        node.end()
    judged = [each["x"] for each in map(json.loads, record.read_text().splitlines()) if each.get("x", FIRST) != FIRST]
    for path in cut.iterdir():
        numbers = numbers_in(path)
        assert numbers == judged[: len(numbers)]
        assert len(numbers) > judged.index(9.0)


def test_what_the_bound_in_bytes_cuts_off_is_reported(script: Path, network: Network, tmp_path: Path) -> None:
    from std_msgs.msg import Float64

    with Node(script, tmp_path, cut=tmp_path / "cut", cut_before=60.0, cut_after=0.1, cut_mb=0.01) as node:
        sending = publisher(network, node)
        for number in range(101):
            sending.publish(Float64(data=9.0 if number == 100 else number / 100))
        network.wait_until(lambda: len(list((tmp_path / "cut").glob("*.mcap"))) == 2, "extracts")
        node.end()
    numbers = numbers_in(next((tmp_path / "cut").glob("low*")))
    assert 20 < len(numbers) < 40
    assert numbers[-1] == 9.0
    assert "cut_mb is too small: the extract of low lacks" in node.log


def test_a_run_that_ends_before_the_window_does_is_written_up_to_its_end(
    script: Path, network: Network, tmp_path: Path
) -> None:
    from std_msgs.msg import Float64

    (tmp_path / "cut").mkdir()
    with Node(script, tmp_path, cut=tmp_path / "cut", cut_after=3600.0, on_violation="end") as node:
        sending = publisher(network, node)
        sending.publish(Float64(data=9.0))
        assert node.exit_code() == 1
    assert [numbers_in(path) for path in (tmp_path / "cut").iterdir()] == [[9.0], [9.0]]


def test_an_extract_that_cannot_be_written_is_reported_and_the_run_goes_on(
    script: Path, network: Network, tmp_path: Path
) -> None:
    from std_msgs.msg import Float64

    cut = tmp_path / "cut"
    with Node(script, tmp_path, cut=cut, cut_after=0.1) as node:
        sending = publisher(network, node)
        cut.write_text("a file in the place of the folder")
        sending.publish(Float64(data=4.5))
        network.wait_until(lambda: "the extract of also cannot be written" in node.log, "the error")
        sending.publish(Float64(data=9.0))
        network.wait_until(lambda: ("low", "violated") in node.changes, "a verdict")
        assert node.end() == 1


def test_a_folder_that_cannot_be_one_is_refused(script: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for value, told in (("file/cut", "is not a folder"), ("5", "it must be a name")):
        given = tmp_path / value if "/" in value else value
        with Node(script, tmp_path, cut=given) as node:
            assert node.exit_code() == 2
        assert told in node.log


STAND_IN = "from lifecycle_msgs.srv import ChangeState as Snapshot\n"
"""What answers as the service of a recorder does; its package is none that can be installed here."""


@pytest.mark.parametrize(("is_well", "told"), [(True, "snapshot of low: taken"), (False, "the recorder answers that")])
def test_a_recorder_is_asked_for_a_snapshot(
    script: Path, network: Network, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, is_well: bool, told: str
) -> None:
    from lifecycle_msgs.srv import ChangeState
    from std_msgs.msg import Float64

    package = tmp_path / "rosbag2_interfaces"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "srv.py").write_text(STAND_IN)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))

    def take(request: Any, response: Any) -> Any:
        response.success = is_well
        return response

    service = network.node.create_service(ChangeState, "/recorder/snapshot", take)
    with Node(script, tmp_path, snapshot="/recorder/snapshot") as node:
        sending = publisher(network, node)
        network.hear_verdicts("/watch_monitor/verdicts")  # who knows of this listener knows of the service before
        network.wait_until(lambda: network.verdicts, "the verdicts so far")
        sending.publish(Float64(data=9.0))
        network.wait_until(lambda: told in node.log, "the answer")
        assert node.end() == 1
    network.node.destroy_service(service)


def test_a_snapshot_that_nobody_takes_is_reported(
    script: Path, network: Network, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from std_msgs.msg import Float64

    with Node(script, tmp_path, snapshot="/nobody/snapshot") as node:
        assert node.exit_code() == 2
    assert "install the ROS 2 package rosbag2_interfaces" in node.log
    package = tmp_path / "rosbag2_interfaces"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "srv.py").write_text(STAND_IN)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with Node(script, tmp_path, snapshot="/nobody/snapshot") as node:
        publisher(network, node).publish(Float64(data=9.0))
        network.wait_until(lambda: "nobody offers this service" in node.log, "the error")
        node.end()


@pytest.mark.parametrize(
    "name",
    [
        "std_msgs/msg/Empty",
        "nav_msgs/msg/Odometry",
        "sensor_msgs/msg/PointCloud2",
        "sensor_msgs/msg/BatteryState",
        "diagnostic_msgs/msg/DiagnosticArray",
        "rcl_interfaces/msg/ParameterEvent",
        "rcl_interfaces/msg/Log",
        "action_msgs/msg/GoalStatusArray",
    ],
)
def test_definitions_are_those_of_the_messages(name: str) -> None:
    from ltlc.backends.ros2.node.definitions import definition_text

    text = definition_text(name)
    for of, message in defined(name, "ros2msg", text).items():
        fields = {field: str(type_) for field, type_ in message.fields.items()}
        assert fields == {field: str(type_) for field, type_ in shipped()[of].fields.items()}
    if PLACEHOLDER not in shipped()[name].fields:
        assert name in get_types_from_msg(text, name)
