"""Slices of a run that is looked at in ticks, each a step of every slice."""

from __future__ import annotations

from collections.abc import Sequence

from ltlc.runtime.properties import Change
from ltlc.runtime.sampling import Value, mark
from ltlc.runtime.session import Session
from ltlc.runtime.slice_ids import Ids, Slice
from ltlc.runtime.slice_keys import Cut, Id, Part, Row
from ltlc.runtime.slice_openings import Openings
from ltlc.runtime.slice_steps import Slices
from ltlc.runtime.ticks import Ticks
from ltlc.runtime.tracking import Track

NOTHING: frozenset[str] = frozenset()


class TickedSlices(Slices):
    """The same with a `rate`, in Hz: messages are kept for the next tick.

    The ticks are those of the whole, and begin with the first message that any slice or
    all of them read. A slice that is as new is kept: each tick is a step of it.
    """

    def __init__(
        self,
        track: Track,
        session: Session,
        cut: Cut,
        ids: Ids,
        rate: float,
        openings: Openings | None = None,
    ) -> None:
        super().__init__(track, session, cut, ids, frozenset(), openings)
        self._rate = rate
        self._ticks: Ticks | None = None
        self._latest: dict[str, Value] = {}
        self._news: frozenset[str] = frozenset()
        self._own_latest: dict[Id, dict[str, Value]] = {}
        self._own_news: dict[Id, frozenset[str]] = {}
        self._quiet = 0

    def begin(self, time: int) -> None:
        """The session begins, and the ticks of what waits for no message."""
        super().begin(time)
        if self.track.property.from_session:
            self._ticks = Ticks(self._rate, time)

    def take(
        self, time: int, row: Row, values: Sequence[Value], changes: list[Change]
    ) -> None:
        """Samples and messages came in, all is held to then; `changes` grows."""
        if self._ticks is None:
            self._ticks = Ticks(self._rate, time)
        self._take_all(time, row, values)
        self._tell(time, changes)

    def _share(self, time: int, part: Part, given: Sequence[Value]) -> None:
        """Keep what all slices share for the next tick."""
        self._last_heard |= dict.fromkeys(part.aged, time)
        self._latest |= part.of(given)
        self._news |= part.topics
        self._quiet = 0

    def _give(self, time: int, one: Slice, part: Part, given: Sequence[Value]) -> None:
        """Keep what the next tick sees of a slice."""
        assert self._ticks is not None
        if part.aged:
            one.hear(time, part.aged)
        own = {n: value for n, value in part.of(given).items() if self.cut.is_own(n)}
        self._own_latest.setdefault(one.id, {}).update(own)
        self._own_news[one.id] = self._own_news.get(one.id, NOTHING) | part.topics
        self._quiet = 0
        if one.is_renewed and self._ticks.next() != time:
            one.renew(time)
        self._settle(one)

    def _changed(self, time: int, part: Part, given: list[Slice]) -> list[Slice]:
        """All: each keeps what it gets for the next tick."""
        return given

    def _drop(self, one: Slice) -> None:
        super()._drop(one)
        self._own_latest.pop(one.id, None)
        self._own_news.pop(one.id, None)

    def _open(self, time: int, row: Row, values: Sequence[Value]) -> Slice | None:
        """A message opens nothing: the next tick does, if it has heard of any."""
        return None

    def hold(self, time: int) -> list[Change]:
        """Take the ticks before `time`, and the clock steps up to and including it."""
        return self._tick_before(time) + super().hold(time)

    def advance(self, time: int) -> list[Change]:
        """Take what is due by `time`, ticks at `time` included."""
        return self._tick_before(time + 1) + super().hold(time)

    def _tick_before(self, time: int) -> list[Change]:
        changes: list[Change] = []
        # The first step, which a tick may be, says when the run ends.
        while (ticks := self._ticks) is not None and ticks.next() < self._until(time):
            changes += self._tick(ticks)
            self._skip(ticks, min(self._until(time), self.soon + 1))
        return changes

    def _until(self, time: int) -> int:
        """Before this, and the end of the run, ticks are taken."""
        return min(time, self.session.end + 1)

    def _tick(self, ticks: Ticks) -> list[Change]:
        """A tick is a step of every slice."""
        time, cut = ticks.next(), self.cut
        changes = super().hold(time)
        ticks.count += 1
        self._quiet += 1
        self.session.steps += 1
        names, given = tuple(self._latest), tuple(self._latest.values())
        shared = cut.tick_part(names, is_own=False)
        cut.sampler.hear(cut.sampler.news(self._news))
        shared.update.take(cut.sampler.known, time, given)
        cut.sampler.hear(())
        self._open_by_news()
        for one in self._going_on():
            known, latest = one.known, self._own_latest.get(one.id, {})
            if cut.keys:
                cut.share(known)
            news = cut.sampler.news(self._news | self._own_news.pop(one.id, NOTHING))
            mark(known, news, is_new=True)
            part = cut.tick_part((*latest, *names), is_own=True)
            part.update.take(known, time, (*latest.values(), *given))
            self._step(time, one)
            mark(known, news, is_new=False)
            if one.is_renewed:
                one.renew(time)
            self._settle(one)
        self._news = frozenset()
        self._tell(time, changes)
        return changes

    def _open_by_news(self) -> None:
        """Open an instance if there is news of messages that open one."""
        if self.openings is None or self.openings.opener.topic not in self._news:
            return
        opened = self.openings.open()
        if opened is not None:
            self._own_news[opened.id] = frozenset({self.openings.opener.mark})

    def _skip(self, ticks: Ticks, until: int) -> None:
        """Count ticks before `until` without taking them, if they all do the same."""
        going_on = self._going_on()
        # The last is taken: slopes ask for its time.
        times = ticks.before(until) - 1
        is_settled = self._quiet > self.cut.sampler.reach + 1 and all(
            one.is_settled for one in going_on
        )
        if times <= 0 or not is_settled or self.track.verdicts is not None:
            return
        ticks.count += times
        self.session.steps += times
        for one in going_on:
            invalid, steps = one.invalid, one.steps
            one.repeat(times, ())
            has_steps = one.steps > steps
            if self.openings is None or self._is_before(one):
                self.track.monitor.invalid += one.invalid - invalid
                self.track.steps += times * has_steps
            if has_steps:
                one.steps = self.track.steps
