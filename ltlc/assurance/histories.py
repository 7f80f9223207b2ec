"""The samples that signals have in a run, by definition: the reference for the runtime, with which it shares nothing.

A run is a sequence of instants. At each some sources have a sample: fields of messages, or whatever is given in the
place of a computed signal. All else is computed from the sources, and the whole of it is kept.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from operator import itemgetter

from ltlc.dataclass import dataclass
from ltlc.program.excused import excused
from ltlc.program.lowering import measured_parts, read
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.instants import Instant as TimedInstant
from ltlc.semantics.openings import open_part, scope_clocks
from ltlc.semantics.words import Letter, Word
from ltlc.specification.atoms import Atom
from ltlc.specification.evaluation import Value, calculate, evaluate, is_nan, is_true, letter, sample
from ltlc.specification.expressions import (
    Current,
    Expression,
    Input,
    New,
    Opening,
    Operator,
    Past,
    Read,
    Recent,
    Signal,
    Slope,
    operands,
    reads,
)
from ltlc.specification.specification import PropertySpecification, fields, news_within

Sample = Mapping[Signal, Value]
"""Sources with a sample at the same instant, and its values."""


def sample_text(sample: Sample) -> str:
    """A sample for a reader."""
    return ", ".join(f"{signal.name} = {value!r}" for signal, value in sample.items()) or "nothing"


@dataclass(frozen=True, slots=True)
class Instant:
    """At `time`, in ns, the sources in `taken` have a sample, and messages on the topics `heard` have come.

    If it `concerns_all`, it is a step of every property of which all that it reads has a value.
    """

    time: Nanoseconds
    taken: Sample
    heard: frozenset[str] = frozenset()
    concerns_all: bool = False

    def has_news(self, sources: Iterable[Signal], topics: frozenset[str]) -> bool:
        """Whether one of `sources` has a sample, or a message has come on one of `topics`."""
        return not topics.isdisjoint(self.heard) or any(source in self.taken for source in sources)


@dataclass(frozen=True, slots=True)
class Step:
    """A step of a property, at the instant with this number: its letter, or None where something is NaN."""

    instant: int
    letter: Letter | None


class Origins:
    """What a property reads, down to the sources: which each signal is computed from, and how."""

    def __init__(self, specification: PropertySpecification, sources: Collection[Signal]) -> None:
        self.specification = specification
        self.wanted = specification.inputs()
        by_read = {read(each): each for each in self.wanted}
        self.excused = {by_read[e.input]: [by_read[new] for new in e.news] for e in excused(specification) if e.news}
        """The inputs that the property does not wait for, each with the news without which it makes no difference."""
        self.awaited = [each for each in self.wanted if each not in self.excused]
        self.parts: dict[Signal, tuple[Input, ...]] = {}
        self.topics: dict[Signal, frozenset[str]] = dict.fromkeys(sources, frozenset())
        """The topics whose messages can bring a signal a sample."""
        self.sources_of: dict[Signal, tuple[Signal, ...]] = {signal: (signal,) for signal in sources}
        for each in self.wanted:
            self._enter(each.signal)
        self.sources_wanted, self.topics_wanted = self.sources(self.wanted), _heard(self.wanted)
        self.asked = {atom: _reads(atom) for atom in specification.atoms}
        """The atoms, each with what its condition reads."""
        self.clocks = specification.openings()
        scopes = dict.fromkeys(clock for clock in scope_clocks(specification.property) if clock is not None)
        self.outer_first = [clock for clock in scopes if clock in self.clocks.values()]
        """The clocks of the scopes at whose opening values are taken."""
        self.reach = max((self._reach(each) for each in self.wanted), default=1)
        """Over how many samples of the sources, the latest included, the property looks back, openings apart."""
        self.remembers = bool(self.clocks) or any(signal.is_taken for signal in self.parts)
        """Whether something long ago may matter, such as a value at an opening, or its absence."""

    def _enter(self, signal: Signal) -> None:
        if signal in self.sources_of:
            return
        assert isinstance(signal.definition, Expression)
        self.parts[signal] = signal.inputs
        self.topics[signal] = _heard(self.parts[signal])
        for part in self.parts[signal]:
            self._enter(part.signal)
        self.sources_of[signal] = self.sources(self.parts[signal])

    def sources(self, wanted: Iterable[Input]) -> tuple[Signal, ...]:
        """The sources that the inputs `wanted` are computed from, each once."""
        return tuple(dict.fromkeys(source for each in wanted for source in self.sources_of[each.signal]))

    def _reach(self, wanted: Input) -> int:
        parts = self.parts.get(wanted.signal, ())
        return _length(wanted) + max((self._reach(part) for part in parts), default=1) - 1

    def steps(self, run: Iterable[Instant]) -> list[Step]:
        """The steps of the property in `run`."""
        return list(self._steps(History(self), run))

    def after(self, run: Iterable[Instant]) -> History:
        """The samples of `run`, and what was judged of it, if something that is remembered depends on that."""
        history = History(self)
        if self.remembers:
            list(self._steps(history, run))
        return history

    def _steps(self, history: History, run: Iterable[Instant]) -> Iterator[Step]:
        for instant in run:
            if (step := history.step(instant)) is not None:
                if step.letter is not None:
                    history.openings.note(step.letter)
                yield step


class Openings:
    """The values at an opening along one run of a property, whose instants so far are noted."""

    def __init__(self, origins: Origins) -> None:
        self._asked, self._alphabet = origins.asked, origins.specification.alphabet
        self._clocks, self._outer_first = origins.clocks, origins.outer_first
        self._word: Word = ()
        self._latest: Mapping[Read, Value] = {}

    def note(self, instant: Letter) -> None:
        """The run goes on with `instant`."""
        self._word += (instant,)

    def step(self, values: Mapping[Read, Value]) -> Letter | None:
        """The letter of the next step, at which the inputs have `values`; None, for no step, if something is NaN.

        Of an input without a value nothing depends on which letter that is, as long as it exists. What is compared
        with it and has no value makes no step nevertheless.
        """
        if any(_is_nan(wanted, value) for wanted, value in values.items()):
            return None
        told = self.read(values)
        known = tuple(atom for atom, asked in self._asked.items() if told.keys() >= asked)
        beside = (part for atom in self._asked.keys() - {*known} for part in measured_parts(atom.condition))
        seen = letter(known, told)
        if seen is None or any(told.keys() >= {*reads(part)} and is_nan(evaluate(part, told)) for part in beside):
            return None
        self._latest = told
        if len(known) < len(self._asked):
            seen = self._alphabet.completed({atom.name: atom.name in seen for atom in known})
        return seen

    def read(self, values: Mapping[Read, Value]) -> Mapping[Read, Value]:
        """What the next step reads if the inputs have `values`; where a scope is not open, they are taken."""
        shut = [o for o, clock in self._clocks.items() if open_part(self._word, clock) is None]
        taken: dict[Read, Value] = {o: values[now] for o in shut if (now := Current(o.signal)) in values}
        kept: dict[Read, Value] = {o: self._latest[o] for o in self._clocks if o in self._latest}
        return {**values, **kept, **taken}

    def clock_step(self, instant: TimedInstant, judged: Callable[[Letter], TimedInstant]) -> TimedInstant:
        """What the next clock step is: `instant`, or, if a scope opens at it, that of the letter `judged` anew.

        The scope takes the values that are held; then what is inside it may open in turn.
        """
        for clock in self._outer_first:
            is_shut = open_part(self._word, clock) is None
            if is_shut and open_part((*self._word, instant), clock) is not None:
                taken = [opening for opening, other in self._clocks.items() if other == clock]
                self._latest = {**self._latest, **{o: self._latest[Current(o.signal)] for o in taken}}
                instant = judged(self._asked_anew(instant, taken))
        return instant

    def _asked_anew(self, held: Letter, taken: Collection[Opening]) -> Letter:
        """`held` with the answers to what compares with the values `taken`; what has no value then does not hold."""
        reading = [atom for atom, asked in self._asked.items() if not asked.isdisjoint(taken)]
        holding = {atom.name for atom in reading if is_true(atom.condition, self._latest)}
        return (held - {atom.name for atom in reading}) | holding


def _is_nan(wanted: Read, value: Value) -> bool:
    """Whether a value is NaN, or, of samples, one of them."""
    each = value if isinstance(wanted, Recent) and isinstance(value, tuple) else (value,)
    return any(isinstance(sample, float) and math.isnan(sample) for sample in each)


def _reads(atom: Atom) -> set[Read]:
    return {each for operand in operands(atom.condition) for each in reads(operand)}


def _length(wanted: Input) -> int:
    """How many samples of its signal an input needs."""
    match wanted:
        case Current() | New():
            return 1
        case Past(_, samples) | Recent(_, samples):
            return samples + 1
        case Slope():
            return 2


class History:
    """All samples of all signals in a run, which can go on; whoever judges it notes that in `openings`."""

    def __init__(self, origins: Origins, run: Iterable[Instant] = ()) -> None:
        self._origins = origins
        self.openings = Openings(origins)
        self._run = [*run]
        self._samples: dict[Signal, tuple[int, list[tuple[int, Value]]]] = {}

    def know(self, instant: Instant) -> None:
        """The run goes on with `instant`, before the property is judged."""
        self._run.append(instant)

    def step(self, instant: Instant) -> Step | None:
        """The run goes on with `instant`: the step of the property there, if there is one.

        That is where something that it reads has a sample, or news that it wants has come, and all that it waits for
        has a value. If what has come should have brought another value, and did not, that is as if something were NaN.
        """
        self.know(instant)
        number = len(self._run) - 1
        origins = self._origins
        if not (instant.concerns_all or instant.has_news(origins.sources_wanted, origins.topics_wanted)):
            return None
        values = self.values(origins.awaited, number)
        if values is None:
            return None
        for each, news in origins.excused.items():
            value = self._value(each, number)
            if value is not None:
                values[each] = value
            elif all(values[new] for new in news):
                return Step(number, None)
        return Step(number, self.openings.step(values))

    def samples(self, signal: Signal) -> list[tuple[int, Value]]:
        """The samples of `signal`, each with the number of its instant.

        A sample of a part is a sample of what it is part of, once all parts have a value.
        """
        done, found = self._samples.setdefault(signal, (0, []))
        if done < len(self._run):
            found += self._made(signal, done)
            self._samples[signal] = len(self._run), found
        return found

    def _made(self, signal: Signal, start: int) -> Iterator[tuple[int, Value]]:
        parts, topics = self._origins.parts.get(signal), self._origins.topics[signal]
        sources = self._origins.sources_of[signal]
        for number, instant in enumerate(self._run[start:], start):
            if not instant.has_news(sources, topics):
                continue
            if parts is None:
                yield number, instant.taken[signal]
            elif (values := self.values(parts, number)) is not None and (found := sample(signal, values)) is not None:
                yield number, found

    def values(self, wanted: Iterable[Input], instant: int) -> dict[Read, Value] | None:
        """The values of the inputs at the instant; None if one has none yet."""
        found: dict[Read, Value] = {}
        for each in wanted:
            value = self._value(each, instant)
            if value is None:
                return None
            found[each] = value
        return found

    def _value(self, wanted: Input, instant: int) -> Value | None:
        signal = wanted.signal
        if isinstance(wanted, New):
            return not self._run[instant].heard.isdisjoint(topics_of(wanted))
        if self._origins.parts.get(signal) == ():
            return sample(signal, {})
        samples = self.samples(signal)
        count = bisect_right(samples, instant, key=itemgetter(0))
        if count < _length(wanted):
            return None if signal.otherwise is None else signal.otherwise.value
        if isinstance(wanted, Slope):
            return self._slope(samples[count - 2], samples[count - 1])
        if isinstance(wanted, Recent):
            return tuple(value for _, value in samples[count - _length(wanted) : count])  # type: ignore[misc]
        return samples[count - _length(wanted)][1]

    def _slope(self, before: tuple[int, Value], now: tuple[int, Value]) -> float:
        """The difference quotient over time, per second; NaN where no time has passed."""
        duration = self._run[now[0]].time - self._run[before[0]].time
        assert isinstance(now[1], float)
        assert isinstance(before[1], float)
        return math.nan if duration == 0 else calculate(Operator.OVER, now[1] - before[1], duration / 10**9)


def _heard(wanted: Iterable[Input]) -> frozenset[str]:
    """The topics whose news the inputs `wanted`, or what they are computed from, depend on."""
    return frozenset(topic for each in news_within(wanted) for topic in topics_of(each))


def topics_of(wanted: New) -> frozenset[str]:
    """The topics of the messages whose coming is its news."""
    return frozenset(field.topic for _, field in fields(wanted.signal))
