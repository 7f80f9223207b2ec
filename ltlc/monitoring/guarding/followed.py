"""Where the properties of guards are along a run, by the reference interpreters, and whether guards may rest there."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property

from ltlc.dataclass import dataclass
from ltlc.runtime.guarding import Values
from ltlc.runtime.sampling import Input, Sampler, Value, Wanted, Window, mark
from ltlc.runtime.sampling import Recent as RecentSamples
from ltlc.runtime.sampling import Slope as SlopeOfSamples
from ltlc.runtime.session import Plan
from ltlc.semantics import finite
from ltlc.semantics.arenas import Arena, Joint, Outcome, Part, Place, Region, Sent, Standing, standing
from ltlc.semantics.ltl import Formula
from ltlc.semantics.ordered_machine import OrderedMachine, Timed, is_inside
from ltlc.semantics.reset_machine import Clocks, ResetMachine
from ltlc.semantics.timed_atoms import counts_of
from ltlc.semantics.timed_run import TimedRun
from ltlc.semantics.words import Letter, letters_over
from ltlc.specification.arrivals import waited_for
from ltlc.specification.atoms import Atom
from ltlc.specification.evaluation import truth
from ltlc.specification.expressions import Current, New, Opening, Past, Read, Recent, Slope, operands, reads
from ltlc.specification.specification import PropertySpecification, topics_of


@dataclass(frozen=True)
class _Asked:
    """A condition, what it reads, and where the values of that stand."""

    atom: Atom
    window: Window
    wanted: tuple[Read, ...]

    def answer(self, known: list[Value]) -> bool | _Nan | None:
        """Whether it holds; None if a value has not come, NAN if it is not a number."""
        values = self.window.values(known)
        if any(value is None for value in values):
            return None
        found = truth(self.atom.condition, dict(zip(self.wanted, values, strict=True)))
        return NAN if found is None else found


class _Nan:
    """What a condition is that compares what is not a number."""


NAN = _Nan()


@dataclass(frozen=True)
class _PartPlan:
    """What a part reads: the conditions that are its atoms, what makes a step of it, what it waits for."""

    part: Part
    atoms: frozenset[str]
    window: Window
    waits: Window
    own: frozenset[str]

    def begins_with(self, known: list[Value]) -> bool:
        """Whether all that it waits for has a value."""
        return all(value is not None for value in self.waits.values(known))


class Arrangement:
    """What does not change along a run: an arena with its region, and where the samples of a plan stand."""

    def __init__(
        self,
        arena: Arena,
        region: Region,
        conditions: Mapping[str, Atom],
        properties: Mapping[str, PropertySpecification],
        plan: Plan,
    ) -> None:
        """`conditions` are the atoms of values in the arena, `properties` its parts by their labels."""
        self.arena, self.region = arena, region
        self._clocks: dict[tuple[int, Clocks | Timed, Letter], Clocks | Timed] = {}
        self._resting: dict[tuple[Joint, Letter, frozenset[str]], bool] = {}
        of_parts = [properties[part.label] for part in arena.parts]
        asked = [_reads_of(atom) for atom in conditions.values()]
        inputs = [wanted_of(read) for read in (*(r for own in asked for r in own), *_all_inputs(of_parts))]
        self.sampler = Sampler(plan.signals, inputs)
        window = self.sampler.window
        self.asked = {
            name: _Asked(atom, window(map(wanted_of, own)), own)
            for (name, atom), own in zip(conditions.items(), asked, strict=True)
        }
        self.plans = [self._plan(part, each) for part, each in zip(arena.parts, of_parts, strict=True)]
        self.awaited = window(
            wanted_of(read)
            for each in of_parts
            if waited_for(each)
            for read in waited_for(each)
            if set(topics_of(read.signal)).isdisjoint(arena.outs)
        )
        self.spoken = frozenset[str]().union(*(p.topics for p in arena.parts if p.waits)).difference(arena.outs)

    def _plan(self, part: Part, of: PropertySpecification) -> _PartPlan:
        values = frozenset(name for name in part.monitor.atoms if name in self.asked)
        window = self.sampler.window
        return _PartPlan(
            part,
            values,
            window(map(wanted_of, of.inputs())),
            window(map(wanted_of, waited_for(of))),
            frozenset({*values, *part.news}),
        )

    @cached_property
    def _places(self) -> dict[Joint, list[Joint]]:
        """The joint places where guards may rest, by what they are without the order of clocks."""
        found: dict[Joint, list[Joint]] = {}
        for joint in self.region.rests:
            found.setdefault(_without_order(joint), []).append(joint)
        return found

    @cached_property
    def machines(self) -> list[ResetMachine | OrderedMachine]:
        """Of each part: that of its clocks, with their order where the region's places have it."""
        places = (at for joint in self.region.rests for at in joint.standings)
        is_ordered = any(isinstance(at, Place) and isinstance(at.clocks, Timed) for at in places)
        return [OrderedMachine(p.time) if is_ordered and p.has_order else p.time for p in self.arena.parts]

    def clocks_after(self, k: int, at: Place, letter: Letter) -> Clocks | Timed:
        """The clocks of part k once `letter` has come where it is `at`."""
        key = (k, at.clocks, letter)
        if key not in self._clocks:
            machine = self.machines[k]
            (move,) = self.arena.parts[k].time.moves(
                at.reset, letter, lambda held, p: held if finite.holds(p, (held,)) else None
            )
            self._clocks[key] = move.target
            if isinstance(machine, OrderedMachine) and isinstance(at.clocks, Timed):
                zone = machine.after(at.clocks, move.cases)
                assert zone is not None
                self._clocks[key] = Timed(move.target, zone)
        return self._clocks[key]

    def rests(self, joint: Joint, letter: Letter, unknown: frozenset[str]) -> bool:
        """Whether guards may rest at `joint`, where atoms hold as in `letter`, whatever the `unknown` ones are."""
        key = (joint, letter, unknown)
        if key not in self._resting:
            around = (other for other in self._places.get(_without_order(joint), ()) if _is_inside(joint, other))
            self._resting[key] = any(self._holds_in_all(self.region.rests[o], letter, unknown) for o in around)
        return self._resting[key]

    def _holds_in_all(self, formula: Formula, letter: Letter, unknown: frozenset[str]) -> bool:
        whole = (letter | some for some in letters_over(sorted(unknown)))
        return all(finite.holds(formula, (each,)) for each in whole if self.arena.alphabet.allows(each))


def _without_order(joint: Joint) -> Joint:
    """`joint` without the order of clocks."""
    return Joint(joint.sent, tuple(Place(a.state, a.reset) if isinstance(a, Place) else a for a in joint.standings))


def _is_inside(joint: Joint, other: Joint) -> bool:
    """Whether what clocks can read at `joint`, they can at `other`, which is the same without their order."""
    pairs = zip(joint.standings, other.standings, strict=True)
    clocks = ((a.clocks, b.clocks) for a, b in pairs if isinstance(a, Place) and isinstance(b, Place))
    return all(is_inside(a.zone, b.zone) for a, b in clocks if isinstance(a, Timed) and isinstance(b, Timed))


def _reads_of(atom: Atom) -> tuple[Read, ...]:
    return tuple(dict.fromkeys(read for operand in operands(atom.condition) for read in reads(operand)))


def _all_inputs(properties: Iterable[PropertySpecification]) -> Iterator[Read]:
    return (read for each in properties for read in each.inputs())


def wanted_of(read: Read) -> Wanted:
    """What the runtime calls what is read; nothing is read at openings here."""
    match read:
        case Current(signal):
            return Input(signal.name)
        case Past(signal, samples):
            return Input(signal.name, samples)
        case Recent(signal, samples):
            return RecentSamples(signal.name, samples)
        case Slope(signal):
            return SlopeOfSamples(signal.name)
        case New(signal):
            from ltlc.runtime.sampling import New as NewSample

            return NewSample(signal.name)
        case Opening():
            raise ValueError(f"a value at an opening is not followed: {read}")


class Followed:
    """A run along an arrangement, as `ltlc.runtime.guarding.Watched`; the session began at `began`."""

    def __init__(self, arrangement: Arrangement, began: int) -> None:
        self._of, self._began = arrangement, began
        self.time = began
        self.is_blind = False
        self.joint = arrangement.arena.start
        self._known = [*arrangement.sampler.known]
        self._answers: dict[str, bool | _Nan | None] = {
            name: asked.answer(self._known) for name, asked in arrangement.asked.items()
        }
        self._runs: list[TimedRun | None] = [None] * len(arrangement.plans)
        self._heard: dict[str, int] = {}

    def fork(self) -> Followed:
        """The same, to go on by itself."""
        other = object.__new__(Followed)
        vars(other).update(vars(self))
        other._known, other._answers, other._heard = [*self._known], {**self._answers}, {**self._heard}
        other._runs = [run and run.fork() for run in self._runs]
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
        held = frozenset(name for name, answer in self._answers.items() if answer is True)
        unknown = frozenset(name for name in self._of.arena.read if not isinstance(self._answers.get(name), bool))
        return self._of.rests(self.joint, held, unknown)

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
        fresh = self._take(time, topic, values)
        self._heard[topic] = time
        before = self.joint.sent
        sent = self._sent_after(topic)
        at = list(self.joint.standings)
        for k, plan in enumerate(self._of.plans):
            at[k] = self._at_message(k, plan, at[k], time, topic, fresh, before, sent)
        self.joint = Joint(sent, tuple(at))
        self.is_blind = any(
            self._lacks(plan) for plan, now in zip(self._of.plans, at, strict=True) if isinstance(now, Place)
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
            if topic in self._of.arena.read[name]:
                self._answers[name] = asked.answer(known)
        return update.fresh

    def _sent_after(self, topic: str) -> Sent:
        sent = self.joint.sent
        if sent is not None:
            return self._of.arena.sent_after(sent, topic)[0]
        values = self._of.awaited.values(self._known)
        is_over = self._of.spoken <= self._heard.keys() and None not in values
        return self._of.arena.sent_after(None, topic)[1 if is_over else 0]

    def _at_message(
        self,
        k: int,
        plan: _PartPlan,
        at: Standing,
        time: int,
        topic: str,
        fresh: frozenset[str],
        before: Sent,
        sent: Sent,
    ) -> Standing:
        """Where part k is after a message."""
        news = frozenset(name for name, of in plan.part.news.items() if of == topic)
        if at is Outcome.WAITING:
            may = self._of.arena.beginnings(plan.part, before, sent, topic)
            if True not in may or not plan.begins_with(self._known) or self._lacks(plan):
                return at
            self._runs[k], at = self._begun(plan.part), Place(0, self._of.machines[k].initial)
        run = self._runs[k]
        if run is None or not isinstance(at, Place) or topic not in plan.part.topics:
            return at
        window = plan.window
        if self._lacks(plan) or (fresh.isdisjoint(window.signals) and topic not in window.topics):
            return self._along(k, at, run.hear(time, news))
        held = frozenset(name for name in plan.atoms if self._answers[name] is True)
        return self._along(k, at, run.step(time, held | news))

    def _begun(self, part: Part) -> TimedRun:
        """A run of a part that begins now: ages count from what has come before."""
        run = TimedRun(part.time.trackers, part.time.news, self._began, counts=counts_of(part.formula))
        for name, topic in part.news.items():
            if topic in self._heard:
                list(run.hear(self._heard[topic], [name]))
        return run

    def _lacks(self, plan: _PartPlan) -> bool:
        """Whether something that a part compares is not a number."""
        return any(self._answers[name] is NAN for name in plan.atoms)

    def _along(self, k: int, at: Standing, letters: Iterable[Letter]) -> Standing:
        part = self._of.arena.parts[k]
        for letter in letters:
            if isinstance(at, Place):
                at = standing(part, part.monitor.step(at.state, letter), self._of.clocks_after(k, at, letter))
        return at
