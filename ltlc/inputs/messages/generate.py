"""Makes `jazzy.json`, the message definitions of ROS 2 Jazzy: `python -m ltlc.inputs.messages.generate`.

They are those that rosbags ships, and some more. Importing rosbags would take longer than compiling a specification.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rosbags.typesys import Stores, get_typestore  # noqa: TID251

from ltlc.base.files import compact_json, write_text
from ltlc.inputs.messages.distributions import from_rosbags
from ltlc.inputs.messages.texts import interface

BESIDE = {
    "gazebo_msgs/msg/ModelStates": "string[] name\ngeometry_msgs/Pose[] pose\ngeometry_msgs/Twist[] twist\n",
    "action_msgs/srv/CancelGoal": (
        "GoalInfo goal_info\n---\nint8 ERROR_NONE=0\nint8 ERROR_REJECTED=1\nint8 ERROR_UNKNOWN_GOAL_ID=2\n"
        "int8 ERROR_GOAL_TERMINATED=3\nint8 return_code\nGoalInfo[] goals_canceling\n"
    ),
    "lifecycle_msgs/srv/ChangeState": "Transition transition\n---\nbool success\n",
    "lifecycle_msgs/srv/GetState": "---\nState current_state\n",
    "std_srvs/srv/Empty": "---\n",
    "std_srvs/srv/SetBool": "bool data\n---\nbool success\nstring message\n",
    "std_srvs/srv/Trigger": "---\nbool success\nstring message\n",
}
"""What rosbags does not ship: Gazebo Classic's ground truth, which is not part of ROS 2, and common services."""


def jazzy_definitions() -> dict[str, Any]:
    """What `jazzy.json` holds: for each message its fields and constants."""
    shipped = get_typestore(Stores.ROS2_JAZZY).fielddefs
    messages = {name: from_rosbags(definition) for name, definition in shipped.items()}
    for name, text in BESIDE.items():
        messages |= interface(name, text)
    return {
        "messages": {
            name: ({field: str(type_) for field, type_ in message.fields.items()}, message.constants)
            for name, message in sorted(messages.items())
        }
    }


def main() -> None:
    """Write the file beside this one."""
    write_text(Path(__file__).parent / "jazzy.json", compact_json(jazzy_definitions()))


if __name__ == "__main__":
    main()
