"""Where the properties of guards are, by the monitors that run.

Standard library only.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence

from ltlc.runtime.episodes import count_anew
from ltlc.runtime.guard_plans import YES, Asked, Asks, GuardPlan
from ltlc.runtime.guarding import Values
from ltlc.runtime.properties import Monitor, MonitoredProperty
from ltlc.runtime.sampling import Sampler, Value, Window, mark
from ltlc.runtime.session import Plan
from ltlc.runtime.times import NEVER
from ltlc.semantics.verdicts import Verdict


class _Part:
    """What does not change of a property: what it reads, and of which topics."""

    def __init__(
        self, of: MonitoredProperty, sampler: Sampler, is_assumed: bool
    ) -> None:
        self.of, self.is_assumed = of, is_assumed
        self.window = sampler.window(of.inputs)
        self.ages: dict[str, set[str]] = {}
        for age in of.ages:
            for topic in sampler.topics[age.signal]:
                self.ages.setdefault(topic, set()).add(age.signal)

    def topics(self) -> frozenset[str]:
        """The topics that it reads."""
        return self.window.read.union(self.ages)


class Watching:
    """Guards of a `plan` along a run, as `ltlc.runtime.guarding.Watched`.

    The session began at `began`, in ns.
    """

    def __init__(self, plan: Plan, guards: GuardPlan, began: int) -> None:
        self.time = began
        self.is_blind = False
        self._plan = guards
        properties = [plan.properties[number] for number in guards.parts]
        wanted = [i for of in properties for i in of.inputs]
        wanted += [i for condition in guards.conditions for i in condition.inputs]
        self._sampler = Sampler(plan.signals, [*wanted, *guards.awaited])
        self._parts = [
            _Part(of, self._sampler, number in guards.assumed)
            for number, of in zip(guards.parts, properties, strict=True)
        ]
        window = self._sampler.window
        self._windows = [window(each.inputs) for each in guards.conditions]
        self._read = frozenset(guards.outs).union(*map(_Part.topics, self._parts))
        self._awaited = window(guards.awaited)
        self._unheard = frozenset(guards.spoken)
        self._has_begun = False
        self._known = [*self._sampler.known]
        self._nan = frozenset[int]()
        self._monitors = [
            of.monitor(began) if of.timed else of.monitor() for of in properties
        ]
        is_silent = bool(guards.spoken or guards.awaited)
        self._sent = None if is_silent else (0,) * len(guards.outs)

    def fork(self) -> Watching:
        """The same, to go on by itself."""
        other = object.__new__(Watching)
        vars(other).update(vars(self))
        other._known = [*self._known]
        other._monitors = list(map(_forked, self._monitors))
        return other

    @property
    def is_silent(self) -> bool:
        """Whether something that is waited for has not come."""
        return self._sent is None

    @property
    def has_begun(self) -> bool:
        """Whether all properties have begun."""
        return all(m.verdict is not Verdict.NOT_STARTED for m in self._monitors)

    @property
    def violated(self) -> tuple[str, bool] | None:
        """The label of a property that is violated, first of all an assumption."""
        pairs = zip(self._parts, self._monitors, strict=True)
        over = [
            (not part.is_assumed, part.of.label)
            for part, monitor in pairs
            if monitor.verdict is Verdict.VIOLATED
        ]
        return next(((label, not is_kept) for is_kept, label in sorted(over)), None)

    @property
    def rests(self) -> bool:
        """Whether the guards may rest."""
        target, decisions = self._plan.rests, self._plan.decisions
        while target < 0:
            question, low, high = decisions[~target]
            target = high if self._answer(self._plan.questions[question]) else low
        return target == YES

    def _answer(self, asked: Asked) -> bool:
        match asked.asks:
            case Asks.SILENT:
                return self._sent is None
            case Asks.SENT:
                return self._sent is not None and self._sent[asked.of] == asked.number
            case Asks.WAITS:
                return self._monitors[asked.of].verdict is Verdict.NOT_STARTED
            case Asks.STANDS:
                monitor = self._monitors[asked.of]
                has_begun = monitor.verdict is not Verdict.NOT_STARTED
                return has_begun and monitor.state == asked.number
            case Asks.KNOWN:
                values = self._values(asked.of)
                is_there = all(value is not None for value in values)
                return is_there and self._plan.conditions[asked.of].known(*values)
            case Asks.HOLDS:
                return self._plan.conditions[asked.of].holds(*self._values(asked.of))

    def _values(self, number: int) -> Sequence[Value]:
        """What a condition reads."""
        values = self._windows[number].values(self._known)
        if first := self._plan.conditions[number].first:
            pairs = zip(values, first, strict=True)
            return [other if value is None else value for value, other in pairs]
        return values

    def due(self) -> int | None:
        """When something changes by time alone next."""
        due = min([NEVER, *(1 + m.due for _, m in self._timed())])
        return due if due < NEVER else None

    def expiring(self, due: int) -> Sequence[str]:
        """The labels of the properties of which something changes then."""
        return [part.of.label for part, m in self._timed() if m.due + 1 == due]

    def _timed(self) -> Iterator[tuple[_Part, Monitor]]:
        pairs = zip(self._parts, self._monitors, strict=True)
        return ((part, monitor) for part, monitor in pairs if part.of.timed)

    def hold(self, until: int) -> None:
        """Nothing comes up to and including `until`."""
        for _, monitor in self._timed():
            while until > monitor.due:
                monitor.expire()
        self.time = max(self.time, until)

    def hear(self, time: int, topic: str, values: Values) -> None:
        """A message has come on a topic, or left on one."""
        self.hold(time)
        if topic not in self._read:
            return
        fresh = self._take(time, topic, values)
        self._unheard -= {topic}
        is_first, self._has_begun = not self._has_begun, True
        for k, part in enumerate(self._parts):
            monitor, of = self._monitors[k], part.of
            was_late = count_anew(monitor, of.ages, time, part.ages.get(topic, ()))
            stepped = _concerns(part.window, fresh, topic) and self._step(k, time)
            has_begun = monitor.verdict is not Verdict.NOT_STARTED
            if was_late and has_begun and not stepped:
                monitor.due = time - 1
                self.hold(time)
        mark(self._known, self._sampler.news((topic,)), is_new=False)
        if is_first:
            self._first_steps(time)
        self._count(topic)
        lacking = (self._monitors[k].verdict for k in self._nan)
        self.is_blind = not all(verdict.is_permanent for verdict in lacking)

    def _take(self, time: int, topic: str, values: Values) -> frozenset[str]:
        """Take a message; the names of the signals that may have new samples."""
        sampler, known = self._sampler, self._known
        mark(known, sampler.news((topic,)), is_new=True)
        taken = sampler.converted(values.keys(), values.values())
        update = sampler.update(tuple(taken), frozenset({topic}))
        update.take(known, time, tuple(taken.values()))
        return update.fresh

    def _count(self, topic: str) -> None:
        """Count a message that left; if all has come, the guards are not silent now.

        All properties have begun then that wait for no command, unless a value is NaN.
        """
        if self._sent is None:
            are_stuck = (
                self._monitors[k].verdict is Verdict.NOT_STARTED for k in self._nan
            )
            values = self._awaited.values(self._known)
            if not (self._unheard or None in values or any(are_stuck)):
                self._sent = (0,) * len(self._plan.outs)
            return
        counted = zip(self._sent, self._plan.outs, self._plan.most, strict=True)
        self._sent = tuple(min(n + (out == topic), most) for n, out, most in counted)

    def _first_steps(self, time: int) -> None:
        """What waits for no value begins with the session."""
        for k, part in enumerate(self._parts):
            monitor = self._monitors[k]
            has_begun = monitor.verdict is not Verdict.NOT_STARTED
            if part.of.from_session and not (has_begun or monitor.invalid):
                self._step(k, time)

    def _step(self, k: int, time: int) -> bool:
        """A step of the property k, once it has all that it waits for, if it is one."""
        of, monitor = self._parts[k].of, self._monitors[k]
        values: Sequence[Value] = self._parts[k].window.values(self._known)
        if None in values:
            is_waiting = monitor.verdict is Verdict.NOT_STARTED
            if is_waiting and not of.is_ready(values):
                return False
            if of.missed(values) is not None:
                self._nan |= {k}
                return False
            values = of.given(values)
        invalid, at = monitor.invalid, (time,) if of.timed else ()
        monitor.step(*at, *values)
        is_step = monitor.invalid == invalid
        self._nan = self._nan - {k} if is_step else self._nan | {k}
        return is_step


def _concerns(window: Window, fresh: frozenset[str], topic: str) -> bool:
    """Whether there may be a step of what looks at `window`."""
    return topic in window.topics or not fresh.isdisjoint(window.signals)


def _forked(monitor: Monitor) -> Monitor:
    """The same, to go on by itself."""
    other: Monitor = object.__new__(type(monitor))
    for name in monitor.__slots__:
        value = getattr(monitor, name, None)
        setattr(other, name, value.copy() if isinstance(value, deque) else value)
    return other
