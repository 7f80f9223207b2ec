"""What guards did: counted, logged, published."""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from typing import Any

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

from ltlc.backends.ros2.node.topics import GuardedTopic
from ltlc.runtime.guard_reports import Tally, deed_report, deed_text
from ltlc.runtime.guarding import Action, Deed
from ltlc.runtime.session import Session


class Deeds:
    """What the guard of each topic did in a run; ~/guard has all but what passed."""

    KEPT = 1000
    AGAIN = 5.0
    """For how many seconds the log does not repeat what is done for the same reason."""

    def __init__(self, node: Node, guarded: Sequence[GuardedTopic]) -> None:
        self._node, self._guarded = node, guarded
        self._logged: dict[tuple[tuple[str, ...], Action, str], float] = {}
        self._publisher: Any = None
        if guarded:
            kept = DurabilityPolicy.TRANSIENT_LOCAL
            profile = QoSProfile(depth=self.KEPT, durability=kept)
            self._publisher = node.create_publisher(String, "~/guard", profile)
        self.begin()

    def begin(self) -> None:
        """A run begins."""
        self._tallies = {each.out: Tally(each.raw, each.out) for each in self._guarded}

    def add(self, deed: Deed, session: Session) -> str | None:
        """Count, log and publish it; as a line of JSON, unless a command has passed."""
        for out in deed.outs:
            self._tallies[out].add(deed)
        if deed.action is Action.PASSED:
            return None
        self._log(deed, session)
        head = {"guards": list(deed.outs), "action": deed.action.value}
        line = json.dumps({**head, **deed_report(deed, None)})
        self._publisher.publish(String(data=line))
        return line

    def _log(self, deed: Deed, session: Session) -> None:
        why, now = (deed.outs, deed.action, deed.reason), time.monotonic()
        if now - self._logged.get(why, -self.AGAIN) < self.AGAIN:
            return
        self._logged[why] = now
        when, outs = session.scale.text(deed.time), " and ".join(deed.outs)
        text = f"guard of {outs}, {when}: {deed_text(deed)}: {deed.reason}"
        logger = self._node.get_logger()
        if deed.action is Action.LOST:
            logger.error(text)
        else:
            logger.warning(text)

    @property
    def text(self) -> str:
        """A line for each guard: how often it did what."""
        return "".join(f"{tally.text}\n" for tally in self._tallies.values())

    def document(self, session: Session) -> dict[str, Any]:
        """What a report says of guards, if there are any."""
        zero = session.beginning
        guards = [tally.document(zero) for tally in self._tallies.values()]
        return {"guard": guards} if guards else {}

    def statuses(self, name: str, remarks: Sequence[str]) -> list[DiagnosticStatus]:
        """A status for each guard of the node called `name`, for /diagnostics."""
        return [self._status(name, tally, remarks) for tally in self._tallies.values()]

    def _status(
        self, name: str, tally: Tally, remarks: Sequence[str]
    ) -> DiagnosticStatus:
        head, _, did = tally.text.partition(": ")
        lost = tally.last(Action.LOST)
        level = DiagnosticStatus.ERROR if lost else DiagnosticStatus.OK
        if remarks and not lost:
            level = DiagnosticStatus.WARN
        reasons = [] if lost is None else [f"lost: {lost.reason}"]
        return DiagnosticStatus(
            level=level,
            name=f"{name.removeprefix('/')}: {head}",
            message="; ".join([*reasons, did, *remarks]),
            hardware_id=name,
            values=[
                KeyValue(key=action.value.replace("_", " "), value=str(count))
                for action, count in tally.counts.items()
            ],
        )
