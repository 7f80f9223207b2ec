"""A guard as it runs: what it does with a command, and what it sends by itself.

It knows where its properties are by a `Watched`, which says whether the guard may rest
there: whether it can keep them from there on, whatever comes. What it might do is tried
on forks. Standard library only.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import Enum
from typing import Protocol

from ltlc.dataclass import dataclass
from ltlc.runtime.sampling import Value

Values = Mapping[str, Value]
"""The samples of a message, by the names of signals."""


class Watched(Protocol):
    """Where the properties of a guard are.

    time: that of the last event, in ns
    is_silent: whether a topic that is waited for has not spoken, or lacks a value
    has_begun: whether all properties have begun
    is_blind: whether a value that is not a number keeps a property from taking steps
    violated: the label of a property that is violated, and whether it is an assumption
    rests: whether the guard may rest
    """

    time: int
    is_blind: bool

    @property
    def is_silent(self) -> bool: ...  # noqa: D102

    @property
    def has_begun(self) -> bool: ...  # noqa: D102

    @property
    def violated(self) -> tuple[str, bool] | None: ...  # noqa: D102

    @property
    def rests(self) -> bool: ...  # noqa: D102

    def fork(self) -> Watched:
        """The same, to go on by itself."""
        ...

    def hear(self, time: int, topic: str, values: Values) -> None:
        """A message has come on a topic, or left on one."""
        ...

    def hold(self, until: int) -> None:
        """Nothing comes up to and including `until`."""
        ...

    def due(self) -> int | None:
        """When something changes by time alone next; None: never."""
        ...

    def expiring(self, due: int) -> Sequence[str]:
        """The labels of the properties of which something changes then."""
        ...


@dataclass(frozen=True, slots=True)
class Message:
    """A message `name` that a guard may send on the topic `out`."""

    name: str
    out: str
    values: Values


class Action(Enum):
    """What a guard did."""

    PASSED = "passed"
    CHANGED = "changed"
    HELD = "held_back"
    SENT = "sent"
    LOST = "lost"


@dataclass(frozen=True, slots=True)
class Deed:
    """What a guard did at a `time`, in ns, on one of the topics `outs`, and why.

    A `command` is what was asked for, if something was; `message` the name of what was
    sent instead of it, or by itself; `values` what left.
    """

    time: int
    action: Action
    outs: tuple[str, ...]
    command: Values | None = None
    message: str | None = None
    values: Values | None = None
    reason: str = ""


_Plan = tuple[int, Message | None, str]
"""When something is due, and why: a message, or a look at the clocks."""


class Guard:
    """Decides for one set of guards that share properties, over `watched`.

    It acts `lead` ns before a deadline. All times are in ns and must not decrease; what
    is due before an event is done by `act`, which comes first.
    """

    def __init__(
        self,
        watched: Watched,
        outs: Sequence[str],
        fallbacks: Sequence[Message],
        lead: int,
    ) -> None:
        """What leaves, leaves on `outs`; of the `fallbacks` the first that helps."""
        self.watched = watched
        self.outs = tuple(outs)
        self.fallbacks = tuple(fallbacks)
        self.lead = lead
        self.lost: str | None = None
        self._planned: tuple[_Plan | None] | None = None

    def hear(self, time: int, topic: str, values: Values) -> list[Deed]:
        """A message has come on a topic other than that of commands."""
        self._take(time, topic, values)
        return self._respond(time, f"after a message on {topic}")

    def command(self, time: int, out: str, values: Values) -> Deed:
        """A command has come that asks to leave on the topic `out`."""
        why = self._refusal()
        if why is None and (why := self._objection(time, out, values)) is None:
            self._take(time, out, values)
            return Deed(time, Action.PASSED, (out,), values, None, values)
        message = self._instead(time, out)
        if message is None:
            return Deed(time, Action.HELD, (out,), values, reason=why or "")
        self._take(time, out, message.values)
        sent = message.values
        return Deed(time, Action.CHANGED, (out,), values, message.name, sent, why or "")

    def due(self) -> int | None:
        """When to call `act`, if nothing comes before; None: never."""
        plan = self._plan()
        return None if plan is None else plan[0]

    def act(self, time: int) -> list[Deed]:
        """It is `time` now: do what is due by then."""
        deeds: list[Deed] = []
        while (plan := self._plan()) is not None and plan[0] <= time:
            moment, message, why = plan
            if message is None:
                self._hold(moment)
                deeds += self._respond(moment, "when time had passed")
            else:
                deeds.append(self._send(moment, message, why))
        self._hold(time)
        return deeds

    def _take(self, time: int, topic: str, values: Values) -> None:
        self._planned = None
        self.watched.hear(time, topic, values)

    def _hold(self, until: int) -> None:
        self._planned = None
        self.watched.hold(until)

    def _plan(self) -> _Plan | None:
        """What is due next; found once for what is known."""
        if self._planned is None:
            self._planned = (self._found(),)
        return self._planned[0]

    def _found(self) -> _Plan | None:
        due = self.watched.due()
        if due is None:
            return None
        if self.lost is not None or self.watched.is_silent or self._outlasts(due):
            return due, None, ""
        moment = max(self.watched.time, due - 1 - self.lead)
        for message in self.fallbacks:
            after = self._having_sent(self.watched, moment, message)
            if after is not None:
                after.hold(due)
                if self._is_answered(after, due):
                    labels = " and ".join(f"`{n}`" for n in self.watched.expiring(due))
                    return moment, message, f"ahead of a deadline of {labels}"
        return due, None, ""

    def _outlasts(self, due: int) -> bool:
        """Whether it is enough to answer what time does then."""
        then = self.watched.fork()
        then.hold(due)
        return self._is_answered(then, due)

    def _is_answered(self, watched: Watched, time: int) -> bool:
        """Whether the guard may rest, or may once it has sent one message at once."""
        return watched.rests or any(
            self._having_sent(watched, time, message) for message in self.fallbacks
        )

    def _respond(self, time: int, when: str) -> list[Deed]:
        """Answer what has come, if something has to be."""
        violated = self.watched.violated
        if self.lost is not None or (
            violated is None and (self.watched.is_blind or self.watched.rests)
        ):
            return []
        for message in () if self.watched.is_silent else self.fallbacks:
            if self._having_sent(self.watched, time, message) is not None:
                return [self._send(time, message, when)]
        self.lost = "a violation can no longer be avoided"
        if violated is not None:
            label, is_assumed = violated
            what = "the assumption " if is_assumed else ""
            self.lost = f"{what}`{label}` is violated"
        return [Deed(time, Action.LOST, self.outs, reason=self.lost)]

    def _send(self, time: int, message: Message, why: str) -> Deed:
        self._take(time, message.out, message.values)
        values = message.values
        return Deed(time, Action.SENT, (message.out,), None, message.name, values, why)

    def _refusal(self) -> str | None:
        """Why no command passes now; None if one may."""
        if self.lost is not None:
            return f"the guard has lost: {self.lost}"
        if self.watched.is_silent:
            return "a topic has not spoken yet"
        return "a value is missing" if self.watched.is_blind else None

    def _objection(self, time: int, out: str, values: Values) -> str | None:
        """Why a command may not pass; None if it may."""
        after = self.watched.fork()
        after.hear(time, out, values)
        if after.is_blind:
            return "it has no value"
        if after.violated is not None:
            return f"it would violate `{after.violated[0]}`"
        if not after.rests:
            return "a violation could no longer be avoided after it"
        return None if after.has_begun else "not all properties have begun"

    def _instead(self, time: int, out: str) -> Message | None:
        """What is sent in place of a command; None: nothing."""
        own = [message for message in self.fallbacks if message.out == out]
        if self.watched.is_silent:
            return None
        if self.lost is not None or self.watched.is_blind:
            return own[0] if own else None
        tried = (m for m in own if self._having_sent(self.watched, time, m) is not None)
        return next(tried, None)

    def _having_sent(
        self, watched: Watched, time: int, message: Message
    ) -> Watched | None:
        """Where all is once `message` has left; None if it may not rest there."""
        after = watched.fork()
        after.hear(time, message.out, message.values)
        rests = not after.is_blind and after.violated is None and after.rests
        return after if rests else None
