"""Runs: messages are judged as they arrive, changes of verdict are reported."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from operator import itemgetter
from typing import Any

from rclpy.node import Node

from ltlc.backends.ros2.node.absences import Absences
from ltlc.backends.ros2.node.clock import RosTime
from ltlc.backends.ros2.node.commands import Commands
from ltlc.backends.ros2.node.deeds import Deeds
from ltlc.backends.ros2.node.diagnosis import Diagnosis
from ltlc.backends.ros2.node.extracts import Extracts
from ltlc.backends.ros2.node.intake import Listener
from ltlc.backends.ros2.node.locks import Locks
from ltlc.backends.ros2.node.options import Options
from ltlc.backends.ros2.node.outlets import Outlets
from ltlc.backends.ros2.node.snapshot import Snapshot
from ltlc.backends.ros2.node.topics import GuardedTopic, Topic
from ltlc.backends.ros2.node.watchdog import UNUSABLE, Pulse
from ltlc.runtime.guarding import Deed, Values
from ltlc.runtime.properties import Change
from ltlc.runtime.reports import counted, exit_code, figure, summary
from ltlc.runtime.rows import ByRows
from ltlc.runtime.sampling import Value
from ltlc.runtime.session import Plan, Session
from ltlc.runtime.silence import news
from ltlc.runtime.times import SECOND, Times, duration, seconds_text
from ltlc.runtime.tracking import Track
from ltlc.semantics.verdicts import Verdict

Arrival = tuple[int, int, str, Sequence[Value] | None]
"""The time to judge it by, when it was received, its topic, and what it says.

None is what a malformed message says.
"""

LetIn = Callable[[int], bool]


class Watch:
    """Judges the messages on the topics; a new run begins when the clock goes back.

    Times are ROS time, in ns: that at which the middleware received a message, or under
    `use_sim_time` that of the latest /clock. A run begins when there is a time, and, if
    its properties want to know of messages, when such have come, or `DISCOVERY` s after
    the node has subscribed. What comes before is kept, and judged then.
    """

    HOUSEKEEPING = 0.1
    DIAGNOSIS = 1.0
    REST = 10
    """No diagnosis follows another for so many times as long as that one took."""
    DISCOVERY = 3.0
    KEPT = 10_000
    THOROUGH = 10
    BACKLOG = 1_000_000
    """How long, in ns, a message has waited if others may have to be judged before."""
    PUNCTUAL = 20_000_000
    """How much later than what decides it, in ns, a verdict is reported at most."""

    def __init__(
        self,
        node: Node,
        plan: Plan,
        topics: Sequence[Topic],
        guarded: Sequence[GuardedTopic],
        options: Options,
        provenance: Mapping[str, Any],
        pulse: Pulse,
    ) -> None:
        self.messages = 0
        self.has_ended = False
        self._node = node
        self._pulse = pulse
        self._clock = RosTime(node)
        timeout = None if options.timeout is None else duration(options.timeout)
        self._plan = replace(plan, rate=options.rate, timeout=timeout)
        self._ends_on_violation = options.ends_on_violation
        self._verdicts: list[Verdict] = []
        self._waiting: list[Arrival] = []
        self._deeds = Deeds(node, guarded)
        self._outlets = Outlets(node, options, provenance, self._deeds)
        self._diagnosis = Diagnosis(node, provenance, self._deeds)
        self._locks = Locks(node, [each.label for each in plan.properties])
        service = options.snapshot
        self._snapshot = Snapshot(node, service) if service else None
        sent = {each.out for each in guarded}
        self._listeners = [
            Listener(node, topic, self._receive, self._lose)
            for topic in topics
            if topic.name not in sent
        ]
        by_name = {each.name: each for each in topics}
        self._commands = Commands(
            node, self._plan, guarded, by_name, self._samples, self._note
        )
        for listener in self._listeners:
            if listener.full_name == self._diagnosis.full_name:
                listener.own = self._diagnosis.echo()
        self.most_waiting = Listener.DEPTH * len(topics)
        labels = [each.label for each in plan.properties]
        cut = options.cut
        self._extracts = None
        if cut:
            outs = [way.full_name for way in self._commands.ways.values()]
            heard = self._listeners
            self._extracts = Extracts(node, cut, self._clock, labels, heard, outs)
        self._is_incomplete = self._has_failed = False
        self._absences = Absences(node, self._listeners)
        began = time.monotonic()
        self._discovered = began + self.DISCOVERY
        self._next_diagnosis = self._next_housekeeping = self._rested = began
        self._new_session()
        self._news = set[str]().union(
            *(news(self._session, track) for track in self._session.tracks)
        )
        guards = "".join(f", guarding {each.out}" for each in guarded)
        self._node.get_logger().info(
            f"watching {counted(len(plan.properties), 'property', 'properties')} "
            f"on {counted(len(topics), 'topic')}{guards}"
        )

    def _new_session(self) -> None:
        """A run is to begin, with the messages that wait."""
        self._has_begun = False
        self._due: int | None = None
        self._commands.end_run()
        self._deeds.begin()
        self._session = Session(self._plan)
        self._session.times = Times.BOTH
        self._tracks = {id(track.property): track for track in self._session.tracks}
        self._rows = ByRows(self._session)
        for _, _, topic, _ in self._waiting:
            self._session.messages[topic] += 1

    def _receive(
        self, received: int, topic: str, values: Sequence[Value] | None
    ) -> None:
        """A message came in; if simulated time has gone back, into a new run."""
        time_ = received
        if self._clock.is_simulated:
            time_ = self._clock.now()
            if self._waiting and time_ < self._waiting[-1][0]:
                self._judge(self._waiting[-1][0])
        self.messages += 1
        self._session.messages[topic] += 1
        self._waiting.append((time_, received, topic, values))

    def _lose(self, topic: str, count: int | None) -> None:
        """Messages are missing before the next one; None: perhaps some."""
        self._session.lose(topic, count)

    def patience(self) -> float:
        """How long to wait for a message, in s of a monotonic clock."""
        wait = self._next_housekeeping - time.monotonic()
        if not self._clock.is_simulated:
            if self._due is not None:
                wait = min(wait, (self._due - self._clock.surely()) / SECOND)
            if (due := self._commands.due()) is not None:
                wait = min(wait, (due - self._clock.now()) / SECOND)
        return max(wait, 0.0)

    def attend(self, let_in: LetIn) -> None:
        """Judge what came in, and do what is due; to be called often.

        `let_in` takes what else has been received, until that many looks in a row have
        found nothing, and tells whether this is all.
        """
        self._pulse.beat()
        is_time = time.monotonic() >= self._next_housekeeping
        if is_time or self._is_due():
            self.catch_up(let_in)
        elif self._commands.are_waiting:
            let_in(1)
            self._judge(self._clock.now())
        elif self._waiting:
            if time.time_ns() - self._waiting[0][1] > self.BACKLOG:
                let_in(1)
            self._judge(self._clock.now())
        self._tell_ids()
        self._due = self._rows.due() if self._has_begun else None
        if is_time:
            self._next_housekeeping = time.monotonic() + self.HOUSEKEEPING
            self.keep_house()

    def _is_due(self) -> bool:
        """Whether time alone has decided something."""
        due = self._commands.due()
        if due is not None and due <= self._clock.now():
            return True
        return self._due is not None and self._due <= self._clock.surely()

    def catch_up(self, let_in: LetIn) -> bool:
        """Judge all that has been received, then what the time brings; if it is all."""
        until = self._clock.surely()
        is_all = let_in(self.THOROUGH)
        now = self._clock.now()
        self._judge(now)
        if is_all and self._has_begun:
            until = max(min(until, now), self._session.time or 0)
            self._tell(self._rows.advance(until))
        self.has_ended |= self._session.is_over
        return is_all

    def _judge(self, now: int) -> None:
        """Judge the messages that wait, in the order in which they were received."""
        if self._session.time is not None and now < self._session.time:
            self._begin_anew(self._session.time, now)
        if not self._has_begun and not self._begin(now):
            self._commands.let_through(now)
            return
        waiting, self._waiting = self._waiting, []
        if len(waiting) > 1:
            waiting.sort(key=itemgetter(0, 1))
        has_guards = bool(self._commands.ways)
        self._commands.act(now)
        for time_, _, topic, values in waiting:
            self._pulse.beat()
            # The run of guards is theirs: by when they take a message.
            received = min(max(time_ or now, self._session.time or 0), now)
            at = now if has_guards else received
            self._take(at, topic, values)
            if has_guards:
                self._commands.hear(at, topic, self._samples(topic, values))
        self._commands.let_through(now)

    def _take(self, at: int, topic: str, values: Sequence[Value] | None) -> None:
        """Judge a message; None is what a malformed one says."""
        if values is not None and self._outlets.are_recording:
            self._outlets.record(at, self._samples(topic, values).items())
        changes = self._rows.judge(at, topic, values)
        if changes:
            self._tell(changes)

    def _note(self, deed: Deed) -> None:
        """A guard did something; what has left it is judged as any other message."""
        if deed.values is not None:
            (out,) = deed.outs
            values = [deed.values.get(name) for name in self._session.fields[out]]
            self._session.messages[out] += 1
            self._take(max(deed.time, self._session.time or 0), out, values)
        self._outlets.deed(deed, self._session)

    def _samples(self, topic: str, values: Sequence[Value] | None) -> Values:
        """The samples of a message, as they are kept; none of a malformed one."""
        if values is None:
            return {}
        return self._session.sampler.converted(self._session.fields[topic], values)

    def _begin(self, now: int) -> bool:
        """Begin a run; False if it is too early, for what it is to be judged by."""
        for _, _, topic, _ in self._waiting[: -self.KEPT]:
            self._lose(topic, 1)
        del self._waiting[: -self.KEPT]
        others = self._news - self._commands.ways.keys()
        heard = all(self._session.messages[topic] for topic in others)
        may_begin = heard or time.monotonic() >= self._discovered
        if now == 0 or not (may_begin and self._commands.are_settled):
            return False
        self._has_begun = True
        if self._news:
            self._outlets.record(now)
            self._tell(self._rows.begin(now))
        self._commands.begin(now)
        return True

    def _begin_anew(self, before: int, now: int) -> None:
        """The clock has gone back: a new run begins."""
        self._node.get_logger().warning(
            f"the clock went back from {seconds_text(before)} s "
            f"to {seconds_text(now)} s: the run ends and a new one begins"
        )
        self._end_run()
        self._new_session()
        self._locks.show(self._session)
        self._leave_words()
        for listener in self._listeners:
            if listener.is_latched:
                listener.renew()

    def _tell(self, changes: Sequence[Change]) -> None:
        for change in changes:
            self._outlets.tell(change)
            track = self._tracks[id(change.property)]
            if change.moment.by_time:
                self._notice_delay(track, change.moment.time)
            if change.current is Verdict.VIOLATED:
                self._locks.show(self._session)
                if self._extracts:
                    self._extracts.violated(track.property.label, change.moment.time)
                if self._snapshot:
                    self._snapshot.violated(track.property.label)
                if track.slices is None:
                    self._node.get_logger().error(figure(self._session, track).rstrip())
                self.has_ended |= self._ends_on_violation
            self._next_diagnosis = 0.0

    def _tell_ids(self) -> None:
        """Tell which ids have violated a property that is judged for each."""
        for slices in self._session.sliced:
            for text, line in slices.untold():
                self._node.get_logger().error(text.rstrip())
                self._outlets.line(line)

    def _notice_delay(self, track: Track, due: int) -> None:
        """The time `due` has decided; see whether the node has woken in time for it."""
        delay = 0 if self._clock.is_simulated else self._clock.now() - due
        if delay > self.PUNCTUAL:
            track.count_delay(delay)

    def keep_house(self) -> None:
        """Check and report the state now and then."""
        self._clock.look()
        start = time.monotonic()
        is_due = start >= max(self._next_diagnosis, self._rested)
        self._absences.look(self._session, is_due)
        for bypass in self._commands.look(is_due):
            self._node.get_logger().error(bypass)
        if self._extracts:
            self._extracts.look(is_due)
        if is_due:
            self._next_diagnosis = start + self.DIAGNOSIS
            self._outlets.save()
            self._locks.show(self._session)
            self._diagnose()
            now = time.monotonic()
            self._rested = now + self.REST * (now - start)
        self._absences.warn(self._session, self._remarks)

    def _remarks(self) -> list[str]:
        """What is amiss, or may be."""
        heard = [remark for one in self._listeners for remark in one.remarks]
        return [*self._clock.remarks, *heard, *self._commands.remarks]

    def _diagnose(self) -> None:
        remarks, of_guards = self._clock.remarks, self._commands.remarks
        self._diagnosis.publish(self._session, self._listeners, remarks, of_guards)
        self._leave_words()

    def _leave_words(self) -> None:
        """Tell the watchdog what to report if the node hangs or dies from now on."""
        verdicts = [*self._verdicts, *(track.verdict for track in self._session.tracks)]
        is_violated = Verdict.VIOLATED in verdicts or self._commands.have_lost
        words = self._outlets.words(self._session)
        self._pulse.leave({"is_violated": is_violated, **words})

    def _end_run(self) -> None:
        self._tell_ids()
        if self._extracts:
            self._extracts.end_run()
        self._verdicts += [track.verdict for track in self._session.tracks]
        self._is_incomplete |= self._session.is_incomplete
        self._outlets.end(self._session)
        found = summary(self._session) + self._deeds.text
        lines = [found.rstrip(), *self._remarks()]
        self._node.get_logger().info("\n".join(["final verdicts:", *lines]))

    def hurry(self) -> None:
        """The node must end: begin with what there is."""
        self._discovered = 0.0

    def leave_the_rest(self) -> None:
        """The node must end though messages wait, on topics that are not known."""
        for listener in self._listeners:
            self._lose(listener.topic.name, None)

    def fail(self, traceback: str) -> None:
        """The node cannot go on."""
        self._has_failed = True
        self._node.get_logger().fatal(
            f"the run ends because the node failed:\n{traceback}"
        )

    def end(self) -> int:
        """The last run ends; report its verdicts. Returns the exit code of the node."""
        self._end_run()
        if self._extracts:
            self._extracts.close(self._pulse.beat)
        code = self._exit_code()
        self._pulse.finish(code)
        self._diagnose()
        self._outlets.close()
        return code

    def _exit_code(self) -> int:
        is_violated = Verdict.VIOLATED in self._verdicts or self._commands.have_lost
        reporters = (self._outlets, self._extracts, self._snapshot)
        have_failed = any(each and each.have_failed for each in reporters)
        if not is_violated and (self._has_failed or have_failed):
            return UNUSABLE
        if self._commands.have_lost:
            return 1
        is_incomplete = self._is_incomplete or self._commands.is_bypassed
        return exit_code(self._verdicts, is_incomplete)
