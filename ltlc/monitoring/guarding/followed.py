"""Where the properties of guards are along a run, by the reference interpreters, and whether guards may rest there."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from ltlc.monitoring.guarding.arrangement import NAN, Arrangement, Nan, PartPlan
from ltlc.monitoring.guarding.openings import Openings
from ltlc.runtime.guarding import Values
from ltlc.runtime.plays import Play
from ltlc.runtime.sampling import mark
from ltlc.semantics.arenas import Joint, Outcome, Part, Place, Sent, Standing, standing
from ltlc.semantics.instants import Instant
from ltlc.semantics.timed_atoms import counts_of
from ltlc.semantics.timed_run import TimedRun, as_held
from ltlc.semantics.words import Letter


class _Heard(NamedTuple):
    """A message on a topic: the signals with new samples, and what was `sent` before it and is after it."""

    time: int
    topic: str
    fresh: frozenset[str]
    before: Sent
    sent: Sent


class Followed:
    """A run along an arrangement, as `ltlc.runtime.guarding.Watched`; the session began at `began`."""

    def __init__(self, arrangement: Arrangement, began: int) -> None:
        self._of, self._began = arrangement, began
        self.time = began
        self.is_blind = False
        self.joint = arrangement.arena.start
        self._known = [*arrangement.sampler.known]
        self._answers: dict[str, bool | Nan | None] = {
            name: asked.answer(self._known) for name, asked in arrangement.asked.items()
        }
        self._openings = [Openings(p.at_openings, p.openings) if p.openings else None for p in arrangement.plans]
        self._runs: list[TimedRun | None] = [None] * len(arrangement.plans)
        self._heard: dict[str, int] = {}

    def fork(self) -> Followed:
        """The same, to go on by itself."""
        other = object.__new__(Followed)
        vars(other).update(vars(self))
        other._known, other._answers, other._heard = [*self._known], {**self._answers}, {**self._heard}
        other._openings = [opened and opened.fork() for opened in self._openings]
        pairs = zip(self._runs, other._openings, strict=True)
        other._runs = [run and run.fork(retake=opened.clock_step if opened else None) for run, opened in pairs]
        return other

    @property
    def is_silent(self) -> bool:
        """Whether something that is waited for has not come."""
        return self.joint.sent is None

    @property
    def has_begun(self) -> bool:
        """Whether all properties have begun."""
        return Outcome.WAITING not in self.joint.standings

    @property
    def violated(self) -> tuple[str, bool] | None:
        """The label of a property that is violated, first of all an assumption, and whether it is one."""
        parts = zip(self._of.arena.parts, self.joint.standings, strict=True)
        over = [(not part.is_assumed, part.label) for part, at in parts if at is Outcome.VIOLATED]
        return next(((label, not is_kept) for is_kept, label in sorted(over)), None)

    @property
    def rests(self) -> bool:
        """Whether the guards may rest, whatever the conditions are that have no value yet."""
        if self._of.arena.outcome(self.joint) is not None:
            return False
        return self._of.rests(self.joint, *self._held())

    def _held(self) -> tuple[Letter, frozenset[str]]:
        """The conditions that hold, and those of which that is not known."""
        held = frozenset(name for name, answer in self._answers.items() if answer is True)
        return held, frozenset(name for name in self._of.arena.read if not isinstance(self._answers.get(name), bool))

    def play(self) -> Play | None:
        """How a violation comes about that can no longer be avoided; None if one is there already, or need not come."""
        if self.is_silent or self.is_blind or self._of.arena.outcome(self.joint) is not None:
            return None
        values = {
            read: value
            for asked in self._of.asked.values()
            for read, value in zip(asked.wanted, asked.window.values(self._known), strict=True)
            if value is not None
        }
        return self._of.find_play(self.joint, *self._held(), values)

    def due(self) -> int | None:
        """When something changes by time alone next."""
        return min((due for run in self._runs if run and (due := run.due()) is not None), default=None)

    def expiring(self, due: int) -> Sequence[str]:
        """The labels of the properties of which something changes then."""
        runs = zip(self._of.arena.parts, self._runs, strict=True)
        return [part.label for part, run in runs if run is not None and run.due() == due]

    def hold(self, until: int) -> None:
        """Nothing comes up to and including `until`."""
        at = list(self.joint.standings)
        for k, run in enumerate(self._runs):
            if run is not None:
                at[k] = self._along(k, at[k], run.hold(until))
        self.joint, self.time = Joint(self.joint.sent, tuple(at)), max(self.time, until)

    def hear(self, time: int, topic: str, values: Values) -> None:
        """A message has come on a topic, or left on one."""
        self.hold(time)
        if not any(topic in part.topics for part in self._of.arena.parts):
            return
        fresh = self._take(time, topic, values)
        self._heard[topic] = time
        heard = _Heard(time, topic, fresh, self.joint.sent, self._sent_after(topic))
        standings = enumerate(zip(self._of.plans, self.joint.standings, strict=True))
        at = [self._at_message(k, plan, before, heard) for k, (plan, before) in standings]
        self.joint = Joint(heard.sent, tuple(at))
        self.is_blind = any(
            self._lacks(plan) if isinstance(now, Place) else self._is_stuck(k, plan, now)
            for k, (plan, now) in enumerate(zip(self._of.plans, at, strict=True))
        )

    def _take(self, time: int, topic: str, values: Values) -> frozenset[str]:
        """Take the samples of a message; the names of the signals that have new ones."""
        sampler, known = self._of.sampler, self._known
        news = sampler.news((topic,))
        mark(known, news, is_new=True)
        taken = sampler.converted(values.keys(), values.values())
        update = sampler.update(tuple(taken), frozenset({topic}))
        update.take(known, time, tuple(taken.values()))
        mark(known, news, is_new=False)
        for name, asked in self._of.asked.items():
            if topic in self._of.arena.read[name] and not asked.is_at_opening:
                self._answers[name] = asked.answer(known)
        return update.fresh

    def _sent_after(self, topic: str) -> Sent:
        sent = self.joint.sent
        if sent is not None:
            return self._of.arena.sent_after(sent, topic)[0]
        values = self._of.awaited.values(self._known)
        parts = enumerate(zip(self._of.plans, self.joint.standings, strict=True))
        is_over = (
            self._of.spoken <= self._heard.keys()
            and None not in values
            and not any(self._is_stuck(k, plan, at) for k, (plan, at) in parts)
        )
        return self._of.arena.sent_after(None, topic)[1 if is_over else 0]

    def _is_stuck(self, k: int, plan: PartPlan, at: Standing) -> bool:
        """Whether part k has all that it waits for, and cannot begin, because something that it compares is NaN."""
        if at is not Outcome.WAITING or not plan.begins_with(self._known):
            return False
        opened = self._openings[k]
        return self._lacks(plan) or (opened is not None and NAN in opened.answers(self._known).values())

    def _at_message(self, k: int, plan: PartPlan, at: Standing, heard: _Heard) -> Standing:
        """Where part k is after a message."""
        begins, opened = at is Outcome.WAITING, self._openings[k]
        if not (self._may_begin(plan, heard) if begins else heard.topic in plan.part.topics):
            return at
        is_step = begins or not heard.fresh.isdisjoint(plan.window.signals) or heard.topic in plan.window.topics
        if opened is not None and is_step:
            self._answers.update(opened.answers(self._known))
        lacks = self._lacks(plan)
        if begins and not lacks:
            self._runs[k], at = self._begun(k, plan.part), Place(0, plan.part.time.initial)
        run = self._runs[k]
        if run is None or not isinstance(at, Place):
            return at
        news = frozenset(name for name, topic in plan.part.news.items() if topic == heard.topic)
        if lacks or not is_step:
            return self._along(k, at, run.hear(heard.time, news))
        if opened is not None:
            opened.step(self._known)
        held = frozenset(name for name in plan.atoms if self._answers[name] is True)
        return self._along(k, at, run.step(heard.time, held | news))

    def _may_begin(self, plan: PartPlan, heard: _Heard) -> bool:
        """Whether a part begins with a message."""
        may = self._of.arena.beginnings(plan.part, heard.before, heard.sent, heard.topic)
        return True in may and plan.begins_with(self._known)

    def _begun(self, k: int, part: Part) -> TimedRun:
        """A run of a part that begins now: ages count from what has come before."""
        opened = self._openings[k]
        retake = as_held if opened is None else opened.clock_step
        run = TimedRun(part.time.trackers, part.time.news, self._began, retake, counts_of(part.formula))
        for name, topic in part.news.items():
            if topic in self._heard:
                list(run.hear(self._heard[topic], [name]))
        return run

    def _lacks(self, plan: PartPlan) -> bool:
        """Whether something that a part compares is not a number."""
        return any(self._answers[name] is NAN for name in plan.atoms)

    def _along(self, k: int, at: Standing, letters: Iterable[Instant]) -> Standing:
        part, opened = self._of.arena.parts[k], self._openings[k]
        for letter in letters:
            if opened is not None:
                opened.note(letter)
                self._answers |= {a: a in letter for a in opened.asked if self._answers[a] is not NAN}
            if isinstance(at, Place):
                at = standing(part, part.monitor.step(at.state, letter), self._of.clocks_after(k, at, letter))
        return at
