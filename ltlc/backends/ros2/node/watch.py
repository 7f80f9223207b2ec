"""Runs: messages are judged as they come, changes of verdict are told."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Sequence
from dataclasses import replace

from rclpy.node import Node

from ltlc.backends.ros2.node.diagnosis import Diagnosis
from ltlc.backends.ros2.node.intake import Listener, Silence, Topic
from ltlc.backends.ros2.node.options import UNUSABLE, Options
from ltlc.backends.ros2.node.outlets import Outlets
from ltlc.runtime.reports import exit_code, figure, sentence, summary
from ltlc.runtime.sampling import Value
from ltlc.runtime.session import Plan, Session
from ltlc.runtime.tracking import Change
from ltlc.semantics.verdicts import Verdict


class Watch:
    """Judges what the topics say; a new run begins when the clock goes back.

    Times are ROS time, in s, when a message is received. Under `use_sim_time` there is
    none as long as it is 0, before the first /clock: messages are kept until then.
    """

    HOUSEKEEPING = 0.1
    DIAGNOSIS = 1.0
    PATIENCE = 5.0
    KEPT = 10_000

    def __init__(
        self, node: Node, plan: Plan, topics: Sequence[Topic], options: Options
    ) -> None:
        self.messages = 0
        self.has_ended = False
        self._node = node
        self._clock = node.get_clock()
        self._is_simulated = self._clock.ros_time_is_active
        self._plan = replace(plan, rate=options.rate, timeout=options.timeout)
        self._ends_on_violation = options.ends_on_violation
        self._session = Session(self._plan)
        self._verdicts: list[Verdict] = []
        self._early: deque[tuple[str, Sequence[Value]]] = deque()
        self._outlets = Outlets(node, options)
        self._diagnosis = Diagnosis(node)
        self._listeners = [
            Listener(node, topic, self._receive, self._lose) for topic in topics
        ]
        self._has_lost = self._has_failed = False
        self._ticking = Silence()
        self._began = time.monotonic()
        self._next_diagnosis = self._next_housekeeping = self._began
        self._has_warned = False

    def _now(self) -> float:
        """ROS time: that of /clock, or else the system's (which rclpy tells slowly)."""
        if not self._is_simulated:
            return time.time_ns() / 1e9
        nanoseconds: int = self._clock.now().nanoseconds
        return nanoseconds / 1e9

    def _receive(self, topic: str, values: Sequence[Value]) -> None:
        """A message came in."""
        self.messages += 1
        now = self._now()
        self._notice_jump(now)
        if now == 0:
            self._keep(topic, values)
            return
        changes = self._early_changes(now) if self._early else []
        changes += self._session.message(now, topic, values)
        if changes:
            self._tell(changes)

    def _lose(self, topic: str, count: int | None) -> None:
        """Messages are missing before the next one; None: perhaps some."""
        self._has_lost = True
        self._session.lose(topic, count)

    def _keep(self, topic: str, values: Sequence[Value]) -> None:
        """Keep a message until there is a time; if there are too many, the first go."""
        self._session.messages[topic] += 1
        self._early.append((topic, values))
        if len(self._early) > self.KEPT:
            self._lose(self._early.popleft()[0], 1)

    def _early_changes(self, now: float) -> list[Change]:
        """Judge the messages that came before the clock had a time."""
        changes = []
        while self._early:
            changes += self._session.judge(now, *self._early.popleft())
        return changes

    def _notice_jump(self, now: float) -> None:
        """Begin a new run if the clock has gone back."""
        before = self._session.time
        if before is None or now >= before:
            return
        self._node.get_logger().warning(
            f"the clock went back from {before:.10g} s to {now:.10g} s: "
            "the run ends and a new one begins"
        )
        self._end_run()
        self._session = Session(self._plan)
        for listener in self._listeners:
            if listener.is_latched:
                listener.renew()

    def _tell(self, changes: Sequence[Change]) -> None:
        for change in changes:
            self._outlets.tell(change)
            if change.current is Verdict.VIOLATED:
                self._report_violation(change)
        self._next_diagnosis = 0.0

    def _report_violation(self, change: Change) -> None:
        tracks = self._session.tracks
        track = next(t for t in tracks if t.property is change.property)
        self._node.get_logger().error(figure(track).rstrip())
        self.has_ended |= self._ends_on_violation

    def attend(self) -> None:
        """Do what is due whether or not messages come; to be called often."""
        if time.monotonic() >= self._next_housekeeping:
            self._next_housekeeping = time.monotonic() + self.HOUSEKEEPING
            self.keep_house()

    def keep_house(self) -> None:
        """Tell what the time brings, and now and then how things are."""
        self._is_simulated = self._clock.ros_time_is_active
        now = self._now()
        self._notice_jump(now)
        self._ticking.look(round(now * 1e9) if self._is_simulated else 0)
        if now != 0:
            self._tell_if_any(self._early_changes(now) + self._session.advance(now))
        self.has_ended |= self._session.is_over
        is_due = time.monotonic() >= self._next_diagnosis
        for listener in self._listeners:
            heard = self._session.messages[listener.topic.name]
            listener.silence.look(heard)
            if is_due or not heard:
                listener.fit(heard)
        if is_due:
            self._next_diagnosis = time.monotonic() + self.DIAGNOSIS
            self._diagnose()
        if not self._has_warned and time.monotonic() > self._began + self.PATIENCE:
            self._has_warned = True
            self._warn_of_silence()

    def _tell_if_any(self, changes: Sequence[Change]) -> None:
        if changes:
            self._tell(changes)

    def _warn_of_silence(self) -> None:
        """Say once, early enough to be mended, what has not started."""
        waiting = [
            sentence(self._session, track)
            for track in self._session.tracks
            if track.verdict is Verdict.NOT_STARTED
        ]
        for text in (*waiting, *self._remarks()):
            self._node.get_logger().warning(text)

    def _remarks(self) -> list[str]:
        """What is amiss, or may be."""
        heard = [remark for one in self._listeners for remark in one.remarks]
        return [*self._general_remarks(), *heard]

    def _general_remarks(self) -> list[str]:
        """What is amiss for all properties."""
        if self._now() == 0:
            return ["use_sim_time is set, but no time came on /clock"]
        if self._ticking.is_unusual:
            return [f"/clock has stood still for {self._ticking.seconds:.0f} s"]
        return []

    def _diagnose(self) -> None:
        self._diagnosis.publish(self._session, self._listeners, self._general_remarks())

    def _end_run(self) -> None:
        self._verdicts += [track.verdict for track in self._session.tracks]
        self._outlets.end(self._session)
        lines = [summary(self._session).rstrip(), *self._remarks()]
        self._node.get_logger().info("\n".join(["final verdicts:", *lines]))

    def leave_the_rest(self) -> None:
        """The node must end, though messages wait: who knows on which topics."""
        for listener in self._listeners:
            self._lose(listener.topic.name, None)

    def fail(self, traceback: str) -> None:
        """The node cannot go on."""
        self._has_failed = True
        self._node.get_logger().fatal(
            f"the run ends, the node has failed:\n{traceback}"
        )

    def end(self) -> int:
        """The last run ends; tell its verdicts. Returns the exit code of the node."""
        self._end_run()
        self._diagnose()
        self._outlets.close()
        is_violated = Verdict.VIOLATED in self._verdicts
        if not is_violated and (self._has_failed or self._outlets.have_failed):
            return UNUSABLE
        return exit_code(self._verdicts, self._has_lost)
