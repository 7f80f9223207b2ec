"""Values of signals for the replay: what the conditions of a property compare with, its neighbours, and some others."""

from __future__ import annotations

import math
import random
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import cycle, islice, pairwise

from ltlc.assurance.histories import History, Instant, Origins, Sample, sample_text
from ltlc.assurance.sources import Sources
from ltlc.dataclass import dataclass
from ltlc.semantics.instants import Instant as Judged
from ltlc.semantics.words import Letter
from ltlc.specification.atoms import nested
from ltlc.specification.evaluation import Single, Value, truth
from ltlc.specification.expressions import (
    Call,
    Comparison,
    Condition,
    Count,
    Expression,
    Input,
    Number,
    Signal,
    Slice,
    String,
    ValueType,
    inputs,
    operands,
    subexpressions,
)
from ltlc.specification.functions import Function
from ltlc.specification.specification import PropertySpecification

LONGEST_COUNTED = 100
"""Arrays are not drawn longer than this to reach a constant that may be compared with a count."""

RATE, PERIOD = 4.0, 250_000_000
"""In Hz, how often frames follow one another: the times are exact, and so are their differences."""

LONGEST_HISTORY = 50
"""Where a property looks back over more frames, letters are looked for at random only."""

TRIES = 200
"""Frames drawn in search of letters."""

EVEN = 50
"""Frames drawn in search of letters in which the numbers on a topic are the same."""

STARTS = 20
"""How often frames before the first step are drawn in search of such as a valid step can follow."""

SAMPLES_OF_A_LETTER = 4
"""How many frames of a letter are kept from the edges of each condition, and from those drawn at random."""

BASES = 10
"""In search of the edge of a condition: how often all other sources are drawn, and how many values of one are tried."""

EDGES = 4
"""How many edges of a condition are looked for."""

CLOSE = 1e-9
"""How far apart, relatively, values are left where the last bit of what is computed may differ between languages."""


@dataclass(frozen=True, eq=False, slots=True)
class Frame:
    """A sample of all sources at the same instant, less those that messages say nothing of."""

    sample: Sample

    def __str__(self) -> str:
        return sample_text(self.sample)


Frames = tuple[Frame, ...]
"""Frames one after the other, as often as `RATE` says."""


class Draws:
    """Draws samples of `sources`: of what `conditions` compare with, its neighbours, and some others."""

    def __init__(self, conditions: Sequence[Condition], sources: Sources) -> None:
        self.sources = sources
        self.chance = random.Random(0)
        compared = [e for condition in conditions for operand in operands(condition) for e in _within(operand)]
        inner = [each for condition in conditions for each in nested(condition)]
        margins = {each.margin for each in inner if isinstance(each, Comparison)}
        constants = {e.value for e in compared if isinstance(e, Number)}
        self._numbers = _interesting(constants, margins)
        self._lengths = _lengths(compared, constants)
        self._strings = [*dict.fromkeys(e.value for e in compared if isinstance(e, String)), "", "something else"]

    def draw(self) -> Frame:
        """One sample of every source."""
        return Frame(self.sources.possible({signal: self._value(signal.type) for signal in self.sources.signals}))

    def even(self) -> Frame:
        """A sample in which all numbers are the same, so that one differs where it is varied."""
        number = self.chance.choice(self._numbers)
        drawn = {s: number if s.type is ValueType.NUMBER else self._value(s.type) for s in self.sources.signals}
        return Frame(self.sources.possible(drawn))

    def _value(self, type_: ValueType) -> Value:
        return self._single(type_) if type_.element is None else self._array(type_.element)

    def _array(self, type_: ValueType) -> Value:
        """An array of one length or another; of few different elements, or of many."""
        length = self.chance.choice(self._lengths)
        drawn = [self._single(type_) for _ in range(min(length, self.chance.choice([1, 2, length])))]
        return tuple(self.chance.choice(drawn) for _ in range(length))

    def _single(self, type_: ValueType) -> Single:
        match type_:
            case ValueType.BOOLEAN:
                return self.chance.random() < 1 / 2
            case ValueType.STRING:
                return self.chance.choice(self._strings)
            case _:
                return self._number()

    def _number(self) -> float:
        if self.chance.random() < 1 / 4:
            return self.chance.gauss(0.0, 10.0)
        return self.chance.choice(self._numbers)


class Samples(Draws):
    """Draws samples for one property; the same property draws the same ones.

    `start` are as many frames as come before the first step. `found` has each letter seen so far, and where.
    """

    def __init__(self, specification: PropertySpecification, sources: Sources) -> None:
        super().__init__([atom.condition for atom in specification.atoms], sources)
        self.specification = specification
        self.origins = Origins(specification, sources.signals)
        self.reach = self.origins.reach
        self.found: dict[Letter, Frames] = {}
        self._letters: dict[Frames, Letter | None] = {}
        self._known: dict[Frames, dict[Letter, list[Frame]]] = {}
        self.start = self._start() if self.reach <= LONGEST_HISTORY else ()

    def _start(self) -> Frames:
        """Frames after which there can be a step that is valid, if such are found."""
        for _ in range(STARTS):
            frames = self.course(self.reach - 1)
            if any(self.letter((*frames, self.next(frames))) is not None for _ in range(STARTS)):
                break
        return frames

    def course(self, length: int) -> Frames:
        """Frames at random."""
        frames: list[Frame] = []
        for _ in range(length):
            frames.append(self.next(frames))
        return tuple(frames)

    def next(self, before: Sequence[Frame]) -> Frame:
        """A frame to come after `before`: any, an even one, or the same again.

        Where values are taken at openings, often but one source differs, so that a scope stays or opens with another.
        """
        following = [self.draw(), self.even(), *before[-1:]]
        if self.origins.remembers and before:
            following += [self._varied(before[-1])] * 2
        return self.chance.choice(following)

    def _varied(self, frame: Frame) -> Frame:
        """`frame` with another value of one source."""
        signal = self.chance.choice(list(self.sources.signals))
        return Frame(self.sources.possible({**frame.sample, signal: self._value(signal.type)}))

    def letter(self, frames: Frames) -> Letter | None:
        """The letter of the last of `frames`, as many as reach back to `start`; None where something is NaN."""
        seen = frames if self.origins.remembers else frames[-self.reach :]
        if seen not in self._letters:
            found = self.origins.steps(instants_of(seen))
            self._letters[seen] = letter = found[-1].letter if found else None
            if letter is not None:
                self.found.setdefault(letter, seen)
        return self._letters[seen]

    def letters(self, course: Frames) -> list[list[Judged | None]]:
        """The step at each frame of a course, once there is one."""
        found: list[list[Judged | None]] = [[] for _ in course]
        if self.reach <= LONGEST_HISTORY and not self.origins.remembers:
            for end in range(self.reach - 1, len(course)):
                found[end] = [_judged(end, self.letter(course[: end + 1]))]
            return found
        for step in self.origins.steps(instants_of(course)):
            found[step.instant] = [_judged(step.instant, step.letter)]
            if step.letter is not None:
                self.found.setdefault(step.letter, course[step.instant + 1 - self.reach : step.instant + 1])
        return found

    def by_letter(self, before: Frames) -> dict[Letter, list[Frame]]:
        """A few frames for each letter that one can have after `before`, on the edges of conditions and at random."""
        before = before if self.origins.remembers else before[len(before) - self.reach + 1 :]
        if before not in self._known:
            found: dict[Letter, list[Frame]] = {}
            drawn, calm = (self.draw() for _ in range(TRIES)), (self._even_on_topics() for _ in range(EVEN))
            for source in (*self._edges(before), before, drawn, calm):
                taken: Counter[Letter] = Counter()
                for frame in source:
                    seen = self.letter((*before, frame))
                    if seen is not None and taken[seen] < SAMPLES_OF_A_LETTER:
                        taken[seen] += 1
                        found.setdefault(seen, []).append(frame)
            self._known[before] = found
        return self._known[before]

    def invalid(self) -> Frame | None:
        """A frame that makes no step, because something is NaN; None if none is found."""
        return next((frame for frame in (self.draw() for _ in range(TRIES)) if self.letter((frame,)) is None), None)

    def _edges(self, before: Frames) -> Iterator[list[Frame]]:
        """For each condition, frames between which its truth differs: neighbouring values of one source."""
        history = self.origins.after(instants_of(before))
        for atom in self.specification.atoms:
            wanted = [i for operand in operands(atom.condition) for i in inputs(operand)]
            edge = _Edge(atom.condition, wanted, self.origins, self.sources, before, history)
            varied = [s for s in self.origins.sources(wanted) if s.type is ValueType.NUMBER]
            tried = (self._edge(edge, signal) for signal in islice(cycle(varied), BASES if varied else 0))
            pairs = list(islice((pair for found in tried for pair in found), EDGES))
            self.chance.shuffle(pairs)
            yield [frame for pair in pairs for frame in pair]

    def _edge(self, edge: _Edge, signal: Signal) -> Iterator[tuple[Frame, Frame]]:
        base = self.next(edge.before)
        finite = sorted({x for x in (self._number() for _ in range(BASES)) if math.isfinite(x)})
        for low, high in pairwise(edge.at(base, signal, x) for x in finite):
            if edge.truth(low) != edge.truth(high):
                yield edge.narrowed(base, signal, low, high)

    def _even_on_topics(self) -> Frame:
        """A sample in which all numbers on a topic are the same: so a norm of several can be small, or none."""
        numbers = {topic: self.chance.choice(self._numbers) for topic in self.sources.topics()}
        evened = {s: numbers[p.field.topic] for s, p in self.sources.places.items() if s.type is ValueType.NUMBER}
        drawn = {s: self._value(s.type) for s in self.sources.signals if s not in evened}
        return Frame(self.sources.possible(evened | drawn))


@dataclass(frozen=True, slots=True)
class _Edge:
    """The search for where the truth of a condition, whose inputs are `wanted`, changes at the frame after `before`."""

    condition: Condition
    wanted: Sequence[Input]
    origins: Origins
    sources: Sources
    before: Frames
    passed: History

    def at(self, base: Frame, signal: Signal, value: float) -> Frame:
        """`base` with another value of one source."""
        return Frame(self.sources.possible({**base.sample, signal: value}))

    def truth(self, frame: Frame) -> bool | None:
        """Whether the condition holds at `frame`; None where it has no value."""
        values = History(self.origins, instants_of((*self.before, frame))).values(self.wanted, len(self.before))
        return None if values is None else truth(self.condition, self.passed.openings.read(values))

    def _is_last_bit_open(self) -> bool:
        """Whether the last bit may differ between languages: of a norm that lies in the middle of two doubles."""
        parts = (part for operand in operands(self.condition) for part in subexpressions(operand))
        return any(isinstance(part, Call) and part.function is Function.NORM for part in parts)

    def narrowed(self, base: Frame, signal: Signal, low: Frame, high: Frame) -> tuple[Frame, Frame]:
        """The interval from `low` to `high`, on which the truth of the condition differs, until nothing is between."""
        truth, is_last_bit_open = self.truth(low), self._is_last_bit_open()
        while True:
            a, b = low.sample[signal], high.sample[signal]
            assert isinstance(a, float | int)
            assert isinstance(b, float | int)
            middle = self.at(base, signal, (a + b) // 2 if isinstance(a, int) else a / 2 + b / 2)
            if middle.sample[signal] in (a, b) or (is_last_bit_open and math.isclose(a, b, rel_tol=CLOSE)):
                return low, high
            if self.truth(middle) == truth:
                low = middle
            else:
                high = middle


def _judged(number: int, letter: Letter | None) -> Judged | None:
    return None if letter is None else Judged(number * PERIOD, letter)


def instants_of(frames: Sequence[Frame]) -> list[Instant]:
    """The instants of `frames`, one `PERIOD` after the other."""
    return [Instant(number * PERIOD, frame.sample, concerns_all=True) for number, frame in enumerate(frames)]


def _within(expression: Expression) -> Iterator[Expression]:
    """`expression` and its parts, and those of the signals that it is computed from."""
    for part in subexpressions(expression):
        yield part
        if isinstance(part, Input) and isinstance(part.signal.definition, Expression):
            yield from _within(part.signal.definition)


def _lengths(compared: Sequence[Expression], constants: set[float]) -> Sequence[int]:
    """How long arrays are: 0 to 3, and as long as it takes to reach where slices end, and what is counted to."""
    ends = {end for e in compared if isinstance(e, Slice) for end in (e.start, e.stop) if end is not None}
    is_counted = any(isinstance(e, Count) or (isinstance(e, Call) and e.function is Function.LEN) for e in compared)
    counts = {int(c) for c in constants if is_counted and abs(c) < LONGEST_COUNTED}
    return sorted({0, 1, 2, 3, *(abs(n) + more for n in ends | counts for more in (0, 1))})


def _interesting(constants: set[float], margins: set[float]) -> Sequence[float]:
    """Each constant, moved by each margin or not, its nearest neighbours; small numbers; the ends of the line; NaN."""
    centres = {c + side * m for c in constants | {0.0} for m in margins | {0.0} for side in (-1, 1)}
    near = {math.nextafter(c, to) for c in centres for to in (-math.inf, math.inf)}
    return [*sorted(constants | centres | near | {1.0, -1.0, 0.5, 1e9, math.inf, -math.inf}), -0.0, math.nan]
