"""What has not come: topics that are silent, and properties that wait for them."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from rclpy.node import Node

from ltlc.backends.ros2.node.intake import Listener
from ltlc.runtime.reports import sentence
from ltlc.runtime.session import Session
from ltlc.semantics.verdicts import Verdict


class Absences:
    """Looks after the listeners of a node, and warns of what nothing was heard of."""

    PATIENCE = 5.0
    """After how many s properties that have not started are named, once."""
    SILENCE = 30.0
    """How often, in s, topics are named that have been silent for as long."""

    def __init__(self, node: Node, listeners: Sequence[Listener]) -> None:
        self._node = node
        self._listeners = listeners
        self._began = time.monotonic()
        self._has_warned = False
        self._next_silence = self._began + self.SILENCE

    def look(self, session: Session, is_due: bool) -> None:
        """Note how long topics have been silent, and why if their messages do not fit.

        Those that have been heard are asked about their types only if it `is_due`.
        """
        for listener in self._listeners:
            heard = session.messages[listener.topic.name]
            listener.silence.look(heard)
            if is_due or not heard:
                listener.fit(heard)
                session.absences.pop(listener.topic.name, None)
                if listener.misfit:
                    session.absences[listener.topic.name] = listener.misfit

    def warn(self, session: Session, remarks: Callable[[], Sequence[str]]) -> None:
        """Log what has not started, early enough to be fixed, and what is silent."""
        now = time.monotonic()
        if not self._has_warned and now > self._began + self.PATIENCE:
            self._has_warned = True
            waiting = [
                sentence(session, track)
                for track in session.tracks
                if track.verdict is Verdict.NOT_STARTED
            ]
            for text in (*waiting, *remarks()):
                self._node.get_logger().warning(text)
        if now > self._next_silence:
            self._next_silence = now + self.SILENCE
            if silent := self._silent():
                self._node.get_logger().warning("; ".join(silent))

    def _silent(self) -> list[str]:
        """The topics on which nothing came, or not for `SILENCE` s."""
        silent = []
        for listener in self._listeners:
            silence = listener.silence
            is_long = silence.is_unusual and silence.seconds >= self.SILENCE
            if is_long or silence.seconds < 0:
                text = f"no message on {listener.full_name}{silence.text}"
                silent.append(listener.misfit or text)
        return silent
