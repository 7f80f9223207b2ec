"""A guard as it runs: what it does with a command, and what it sends by itself.

It knows where its properties are by a `Watched`, which says whether the guard may rest
there: whether it can keep them from there on, whatever comes. What it might do is tried
on forks. Standard library only.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from enum import Enum
from typing import NamedTuple, Protocol

from ltlc.dataclass import dataclass
from ltlc.runtime.sampling import Value
from ltlc.runtime.times import span_text

Values = Mapping[str, Value]
"""The samples of a message, by the names of signals."""


class Watched(Protocol):
    """Where the properties of a guard are.

    time: that of the last event, in ns
    is_silent: whether a topic that is waited for has not spoken, or lacks a value, or
        what it said is not a number for a property that is to begin with it
    has_begun: whether all properties have begun
    is_blind: whether a value that is not a number keeps a property from taking steps,
        or from beginning
    violated: the label of a property that is violated, and whether it is an assumption
    rests: whether the guard may rest
    """

    time: int
    is_blind: bool

    @property
    def is_silent(self) -> bool:
        """See above."""
        ...

    @property
    def has_begun(self) -> bool:
        """See above."""
        ...

    @property
    def violated(self) -> tuple[str, bool] | None:
        """See above."""
        ...

    @property
    def rests(self) -> bool:
        """See above."""
        ...

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
    sent instead of it, or by itself; `values` what left. Had the command passed, or had
    nothing been sent in answer, the properties would be where they are `otherwise`.
    """

    time: int
    action: Action
    outs: tuple[str, ...]
    command: Values | None = None
    message: str | None = None
    values: Values | None = None
    reason: str = ""
    otherwise: Watched | None = None


class _Plan(NamedTuple):
    """What is due at a `moment`: a message before the `bound`, or a look at clocks."""

    moment: int
    message: Message | None
    bound: int
    labels: str


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
        self._now = 0
        self._planned: tuple[_Plan | None] | None = None

    def hear(self, time: int, topic: str, values: Values) -> list[Deed]:
        """A message has come on a topic other than that of commands."""
        self._take(time, topic, values)
        return self._respond(time, f"after a message on {topic}", time)

    def command(self, time: int, out: str, values: Values) -> Deed:
        """A command has come that asks to leave on the topic `out`."""
        otherwise = None
        if (why := self._refusal()) is None:
            otherwise = self.watched.fork()
            otherwise.hear(time, out, values)
            why = self._objection(otherwise)
        if why is None:
            self._take(time, out, values)
            return Deed(time, Action.PASSED, (out,), values, None, values)
        held = Deed(time, Action.HELD, (out,), values, None, None, why, otherwise)
        message = self._instead(time, out)
        if message is None:
            return held
        self._take(time, out, message.values)
        sent = message.values
        return replace(held, action=Action.CHANGED, message=message.name, values=sent)

    def due(self) -> int | None:
        """When to call `act`, if nothing comes before; None: never."""
        plan = self._plan()
        return None if plan is None else plan.moment

    def act(self, time: int, now: int | None = None) -> list[Deed]:
        """Do what is due up to and including `time`; it is `now`, or just that time.

        What is to be sent ahead is sent now. Where its bound has passed by now, or what
        has to be answered is more than `lead` ago, the guard was late, and has lost.
        """
        now = time if now is None else now
        self._now, self._planned = max(self._now, now), None
        deeds: list[Deed] = []
        while (plan := self._plan()) is not None and plan.moment <= time:
            if plan.message is None:
                self._hold(plan.moment)
                deeds += self._respond(plan.moment, "when time had passed", now)
            elif now < plan.bound:
                why = f"ahead of a deadline of {plan.labels}"
                deeds.append(self._send(plan.moment, plan.message, why))
            else:
                delay = span_text(now - plan.bound + 1)
                why = f"it was late, {delay} after a deadline of {plan.labels}"
                deeds.append(self._lose(now, why))
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
            return _Plan(due, None, due, "")
        moment = max(self.watched.time, due - 1 - self.lead)
        if self._now < due:
            moment = max(moment, self._now)
        for message in self.fallbacks:
            after = self._having_sent(self.watched, moment, message)
            if after is not None:
                after.hold(due)
                if self._is_answered(after, due):
                    labels = " and ".join(f"`{n}`" for n in self.watched.expiring(due))
                    return _Plan(moment, message, due, labels)
        return _Plan(due, None, due, "")

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

    def _respond(self, time: int, when: str, now: int) -> list[Deed]:
        """Answer what has come at `time`, if something has to be."""
        violated, is_silent = self.watched.violated, self.watched.is_silent
        if self.lost is not None or (
            violated is None
            and (is_silent or self.watched.is_blind or self.watched.rests)
        ):
            return []
        otherwise = self.watched.fork()
        for message in () if is_silent else self.fallbacks:
            if self._having_sent(self.watched, time, message) is not None:
                if now - time > self.lead:
                    delay = span_text(now - time)
                    return [self._lose(now, f"it was late, {delay} {when}")]
                return [replace(self._send(time, message, when), otherwise=otherwise)]
        if violated is None:
            lost = self._lose(time, "a violation can no longer be avoided")
            return [replace(lost, otherwise=otherwise)]
        label, is_assumed = violated
        what = "the assumption " if is_assumed else ""
        return [self._lose(time, f"{what}`{label}` is violated")]

    def _lose(self, time: int, why: str) -> Deed:
        self._planned, self.lost = None, why
        return Deed(time, Action.LOST, self.outs, reason=why)

    def _send(self, time: int, message: Message, why: str) -> Deed:
        self._take(time, message.out, message.values)
        values = message.values
        return Deed(time, Action.SENT, (message.out,), None, message.name, values, why)

    def _refusal(self) -> str | None:
        """Why no command passes now; None if one may."""
        if self.lost is not None:
            return f"the guard has lost: {self.lost}"
        if self.watched.is_blind:
            return "a value is missing"
        return "a topic has not spoken yet" if self.watched.is_silent else None

    @staticmethod
    def _objection(after: Watched) -> str | None:
        """Why a command may not pass after which all is there; None if it may."""
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
            # What has not begun would not begin with a message now.
            may_send = self.lost is not None or self.watched.has_begun
            return own[0] if own and may_send else None
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


class Guards:
    """Guards side by side: what leaves one is a message for the others."""

    def __init__(self, guards: Sequence[Guard], done: Callable[[Deed], object]) -> None:
        """`done` is told what a guard did before the others hear of it."""
        self._guards, self._done = guards, done

    def hear(self, time: int, topic: str, values: Values) -> None:
        """A message has come on a topic other than those of commands."""
        for guard in self._guards:
            self._tell(guard, guard.hear(time, topic, values))

    def command(self, time: int, out: str, values: Values) -> None:
        """A command has come that asks to leave on the topic `out`."""
        for guard in self._guards:
            if out in guard.outs:
                self._tell(guard, [guard.command(time, out, values)])

    def due(self) -> int | None:
        """When to call `act`, if nothing comes before; None: never."""
        dues = (due for guard in self._guards if (due := guard.due()) is not None)
        return min(dues, default=None)

    def act(self, time: int) -> None:
        """It is `time` now: do what is due by then, in that order."""
        while (due := self.due()) is not None and due <= time:
            for guard in self._guards:
                if guard.due() == due:
                    self._tell(guard, guard.act(due, time))

    def _tell(self, sender: Guard, deeds: Sequence[Deed]) -> None:
        for deed in deeds:
            self._done(deed)
            if deed.values is None:
                continue
            for guard in self._guards:
                if guard is not sender:
                    heard = guard.hear(deed.time, deed.outs[0], deed.values)
                    self._tell(guard, heard)
