"""The emitted node hears what services and actions publish of themselves."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import pytest
from ros_support import Network, Node, emitted

pytestmark = pytest.mark.ros
pytest.importorskip("rclpy", reason="needs ROS 2: install ltlc[ros]")

PROPERTIES = """
decl event /asked/_service_event lifecycle_msgs/GetState_Event.info.event_type
decl label /asked/_service_event lifecycle_msgs/srv/GetState_Event.response[0].current_state.label
decl status /go/_action/status action_msgs/GoalStatusArray.status_list[0].status
answered: eventually event == ServiceEventInfo.RESPONSE_SENT
active: never label == "active"
aborted: never status == GoalStatus.STATUS_ABORTED
"""


def service(network: Network) -> Any:
    """A client of a service that tells of its calls."""
    names = importlib.import_module("lifecycle_msgs.srv")
    introspection = importlib.import_module("rclpy.service_introspection").ServiceIntrospectionState.CONTENTS
    profile = importlib.import_module("rclpy.qos").qos_profile_system_default

    def answer(_: Any, response: Any) -> Any:
        response.current_state.label = "active"
        return response

    server = network.node.create_service(names.GetState, "/asked", answer)
    server.configure_introspection(network.node.get_clock(), profile, introspection)
    return network.node.create_client(names.GetState, "/asked")


def test_calls_of_services_and_states_of_goals_are_heard(network: Network, tmp_path: Path) -> None:
    names = importlib.import_module("action_msgs.msg")
    client, goals = service(network), network.publisher(names.GoalStatusArray, "/go/_action/status")
    with Node(emitted(PROPERTIES, tmp_path), tmp_path) as node:
        network.matched([goals])
        goals.publish(names.GoalStatusArray(status_list=[names.GoalStatus(status=names.GoalStatus.STATUS_ABORTED)]))
        wanted = {("answered", "satisfied"), ("active", "violated"), ("aborted", "violated")}

        def are_heard() -> bool:
            """Whether a call has been heard: the node may not yet listen to the service."""
            client.call_async(client.srv_type.Request())
            return wanted <= set(node.changes)

        network.wait_until(are_heard, "verdicts")
        assert node.end() == 1
    assert "also published as" not in node.log
