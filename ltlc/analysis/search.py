"""Shortest runs of monitors side by side, breadth first, one letter for each way on that exists.

Where time matters, the ways on are clock steps too. All times are tried at once: how far the moments at which clocks
are due lie apart is kept as a *zone* (Dill, *Timing assumptions*, 1989). Times are chosen for the runs that are found.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from itertools import chain, combinations
from math import inf
from types import MappingProxyType
from typing import NamedTuple

from ltlc.automata.folding import fold
from ltlc.semantics.alphabet import Alphabet, Answers
from ltlc.semantics.durations import UNITS, Nanoseconds
from ltlc.semantics.ltl import Formula, conjunction
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.ordered_machine import Distances, Zone, is_inside
from ltlc.semantics.timed_atoms import Clock, News, news_of
from ltlc.semantics.timed_monitor import AgeDue, Effect, Outcome, TimedMonitor
from ltlc.semantics.timed_run import TimedRun
from ltlc.semantics.trackers import trackers_of
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Letter, Word

Wanted = Callable[[Sequence[Verdict]], bool]
"""Whether a run with these verdicts of the monitors is one that is searched for."""

FURTHER_AWAY = 4
"""Of so many smallest bounds, half of each is a while."""

Moment = tuple[int, int]
"""When a clock is due: the number of its program, and its own; or one of the two that follow."""

NOW, THEN = (-1, 0), (-1, 1)
"""The instant that a move begins at, and the one that it leads to."""

Rule = tuple[Moment, Moment, Nanoseconds]
"""The first moment is at most that much later than the second."""

Due = tuple[Moment, Nanoseconds]
"""A moment that is so much later than another."""


class Running(NamedTuple):
    """Where one monitor is, and whether a clock step is next at once."""

    state: int
    again: bool = False


class Node(NamedTuple):
    """Where all monitors are, the clocks that run, and the letter that is held, where that matters.

    The clock of an age runs until it is late.
    """

    running: tuple[Running, ...]
    clocks: tuple[Moment, ...]
    letter: Letter


class Move(NamedTuple):
    """A step with `letter`, or a clock step, to a node; when its clocks are due, and what times it may take."""

    letter: Letter | None
    target: Node
    dues: tuple[Due, ...]
    rules: tuple[Rule, ...]


class Way(NamedTuple):
    """A run up to its last move, with the zone there: the distances of the instant, then of what is due."""

    before: Way | None
    move: Move
    zone: Zone

    def moves(self) -> list[Move]:
        """All moves, the first one first; before it was the beginning of the session."""
        found: list[Move] = []
        way: Way | None = self
        while way is not None:
            found.append(way.move)
            way = way.before
        return found[::-1]


class Shut(NamedTuple):
    """The letters of a step at which scopes are not open, by the numbers of these: values at their opening are current.

    `scopes` are theirs, each with the atoms that read such values.
    """

    scopes: Mapping[Clock, Collection[str]] = MappingProxyType({})
    letters: Mapping[frozenset[int], Alphabet] = MappingProxyType({})


ALL_OPEN = Shut()
"""Nothing is taken at any opening."""


def shortest(
    monitored: Sequence[tuple[Formula, Monitor]], alphabet: Alphabet, wanted: Wanted, shut: Shut = ALL_OPEN
) -> Word | None:
    """A shortest word, not empty, after which the verdicts are `wanted`; None if there is none."""
    return next(all_shortest(monitored, alphabet, wanted, shut), None)


def all_shortest(
    monitored: Sequence[tuple[Formula, Monitor]], alphabet: Alphabet, wanted: Wanted, shut: Shut = ALL_OPEN
) -> Iterator[Word]:
    """Words, not empty, after which the verdicts are `wanted`, each reaching them in another way, short first.

    `monitored` are formulas with their monitors, of one property if values are taken at the opening of its scopes.
    Where some have timed atoms, the words are runs in time, whose session begins with the first step.
    """
    formula = conjunction(formula for formula, _ in monitored)
    programs = [fold(each, alphabet, monitor, shut.scopes) for each, monitor in monitored]
    search = _Search(programs, alphabet, news_of(formula), shut)
    return (_word(formula, way.moves(), search.whiles) for way in search.all_shortest(wanted))


def _word(formula: Formula, moves: Sequence[Move], whiles: Sequence[Nanoseconds]) -> Word:
    """The letters along `moves`."""
    trackers = trackers_of(formula)
    if not trackers and not news_of(formula):
        return tuple(move.letter for move in moves if move.letter is not None)
    run = TimedRun(trackers, news_of(formula), 0)
    word: list[Letter] = []
    for move, time in zip(moves, _times(moves, whiles), strict=True):
        word += run.hold(time) if move.letter is None else run.step(time, move.letter)
    return tuple(word)


def _times(moves: Sequence[Move], whiles: Sequence[Nanoseconds]) -> list[Nanoseconds]:
    """A time for each of `moves`; steps come after a while where they may, else at the last moment, if there is one."""
    apart = _apart(moves)
    times, last_step = [0], 0
    for n, move in enumerate(moves, 1):
        low = max(time - int(apart.most(k, n)) for k, time in enumerate(times) if apart.most(k, n) < inf)
        high = min(time + apart.most(n, k) for k, time in enumerate(times))
        times.append(_after_a_while(last_step, low, high, whiles) if low < high else low)
        last_step = last_step if move.letter is None else times[-1]
    return times[1:]


def _after_a_while(since: Nanoseconds, low: Nanoseconds, high: float, whiles: Sequence[Nanoseconds]) -> Nanoseconds:
    rounded = (since + each * max(1, -((since - low) // each)) for each in whiles)
    return next((time for time in rounded if low <= time <= high), int(high) if high < inf else low)


def _apart(moves: Sequence[Move]) -> Distances:
    """How far the instants of a run lie apart, from the beginning of the session on."""
    apart = Distances(len(moves) + 1)
    dues: dict[Moment, tuple[int, Nanoseconds]] = {}

    def at(moment: Moment, n: int) -> tuple[int, Nanoseconds]:
        """The instant that `moment` is so much later than; n is the one that a move leads to."""
        return (n - 1, 0) if moment == NOW else (n, 0) if moment == THEN else dues[moment]

    def later(due: Due, n: int) -> tuple[int, Nanoseconds]:
        instant, offset = at(due[0], n)
        return instant, offset + due[1]

    for n, move in enumerate(moves, 1):
        for first, second, most in move.rules:
            (i, offset), (j, other) = at(first, n), at(second, n)
            apart.at_most(i, j, most - offset + other)
        dues = {clock: later(due, n) for clock, due in zip(move.target.clocks, move.dues, strict=True)}
    apart.close()
    return apart


class _Search:
    """Where `programs` can be together, breadth first. After a `while`, people expect the next step."""

    def __init__(self, programs: Sequence[TimedMonitor], alphabet: Alphabet, news: Iterable[News], shut: Shut) -> None:
        self._programs = programs
        self._alphabet = alphabet
        self._shut = shut.letters
        self._news = frozenset(each.name for each in news)
        self._read = frozenset(atom for program in programs if program.held_edges for atom in program.atoms)
        self._ages: dict[Moment, AgeDue] = {
            (number, clock): age
            for number, program in enumerate(programs)
            for clock, age in enumerate(program.ages)
            if age is not None
        }
        messages = sorted({age.news for age in self._ages.values()})
        self._messages = [frozenset(some) for n in range(len(messages) + 1) for some in combinations(messages, n)]
        bounds = {a.duration for program in programs for outcome in program.outcomes for a in outcome.actions}
        bounds |= {age.duration for age in self._ages.values()}
        self.whiles = [(bound + 1) // 2 for bound in sorted(bounds - {0})[:FURTHER_AWAY]] or [UNITS["s"]]

    def all_shortest(self, wanted: Wanted) -> Iterator[Way]:
        """The runs that are searched for."""
        seen: dict[Node, list[Zone]] = {}
        waiting: deque[Way | None] = deque([None])
        while waiting:
            before = waiting.popleft()
            for move in self._first_steps() if before is None else self._moves(before.move.target, before.zone):
                zone = self._zone(before, move)
                if zone is None:
                    continue
                way, target = Way(before, move, zone), move.target
                if wanted([p.verdicts[each.state] for p, each in zip(self._programs, target.running, strict=True)]):
                    yield way
                zones = seen.setdefault(target, [])
                if not any(is_inside(zone, known) for known in zones):
                    zones.append(zone)
                    waiting.append(way)

    def _zone(self, before: Way | None, move: Move) -> Zone | None:
        """The zone that `move` leads to; None if it can be taken at no time."""
        running = before.move.target.clocks if before else ()
        if not running and not move.dues:
            return ((0,),)
        numbers = {moment: n for n, moment in enumerate((NOW, *running, THEN))}
        apart = Distances(len(numbers))
        for i, row in enumerate(before.zone if before else ()):
            for j, most in enumerate(row):
                apart.at_most(i, j, most)
        for first, second, most in move.rules:
            apart.at_most(numbers[first], numbers[second], most)
        if not apart.close():
            return None
        places = [(numbers[moment], offset) for moment, offset in ((THEN, 0), *move.dues)]
        return tuple(tuple(apart.most(i, j) + a - b for j, b in places) for i, a in places)

    def _first_steps(self) -> Iterator[Move]:
        """The session begins with the first step; ages count from then."""
        ages = {moment: (NOW, age.duration) for moment, age in self._ages.items()}
        at_once = ((NOW, THEN, 0), (THEN, NOW, 0))
        running = tuple(Running(0) for _ in self._programs)
        yield from self._steps(running, ages, at_once)

    def _moves(self, node: Node, zone: Zone) -> Iterator[Move]:
        dues: dict[Moment, Due] = {clock: (clock, 0) for clock in node.clocks}
        at_once = any(each.again for each in node.running)
        later: tuple[Rule, ...] = ((NOW, THEN, 0), *((THEN, clock, 0) for clock in node.clocks))
        for late in self._next_late(node.clocks, zone, at_once):
            passing = chain.from_iterable(((THEN, c, 1), (c, THEN, -1)) for c in sorted(late))
            others = ((THEN, clock, 0) for clock in node.clocks if clock not in late)
            time: tuple[Rule, ...] = ((NOW, THEN, -1), (THEN, NOW, 1)) if at_once else ((NOW, THEN, 0),)
            held = node.letter - self._news
            yield from self._move(node.running, dues, None, held, (*time, *passing, *others), late)
        yield from self._steps(node.running, dues, (*later, (THEN, NOW, 0)) if at_once else later)

    def _steps(self, running: Sequence[Running], dues: Mapping[Moment, Due], rules: tuple[Rule, ...]) -> Iterator[Move]:
        """Steps with any letter and any messages, from which ages count."""
        for messages in self._messages:
            renewed = {m: (THEN, age.duration) for m, age in self._ages.items() if age.news in messages}
            after = {**dues, **renewed}
            for letter in self._letters(running, messages, self._late_ages(after)):
                yield from self._move(running, after, letter, letter, rules, frozenset())

    def _late_ages(self, dues: Mapping[Moment, Due]) -> frozenset[Moment]:
        return frozenset(moment for moment in self._ages if moment not in dues)

    def _next_late(self, clocks: Sequence[Moment], zone: Zone, at_once: bool) -> Iterator[frozenset[Moment]]:
        """The sets of clocks that may pass their bounds first, all at one instant."""
        may = [clock for n, clock in enumerate(clocks, 1) if all(row[n] >= 0 for row in zone[1:])]
        for count in range(0 if at_once else 1, len(may) + 1):
            yield from map(frozenset, combinations(may, count))

    def _move(
        self,
        running: Sequence[Running],
        dues: Mapping[Moment, Due],
        letter: Letter | None,
        held: Letter,
        rules: tuple[Rule, ...],
        late: frozenset[Moment],
    ) -> Iterator[Move]:
        """A step with `letter`, or the clock step, with the letter `held`, at which the clocks in `late` pass.

        None where the clock step takes values at an opening: which letter is held then depends on these.
        """
        passed = late | self._late_ages(dues)
        dues = {moment: due for moment, due in dues.items() if moment not in late or moment not in self._ages}
        after = []
        for number, (program, each) in enumerate(zip(self._programs, running, strict=True)):
            if letter is None and not each.again and all(of != number for of, _ in late):
                after.append(each)
                continue
            edges = program.edges if letter is not None else program.held_edges
            outcome = _outcome(program, edges[each.state], held, {clock for of, clock in passed if of == number})
            if outcome.taken:
                return
            if program.verdicts[outcome.state].is_permanent:
                dues = {moment: due for moment, due in dues.items() if moment[0] != number}
            _act(outcome, number, letter is None, dues)
            after.append(Running(outcome.state, outcome.again))
        clocks = tuple(sorted(dues))
        yield Move(letter, Node(tuple(after), clocks, held & self._read), tuple(dues[c] for c in clocks), rules)

    def _letters(self, running: Sequence[Running], messages: Letter, late: frozenset[Moment]) -> Iterator[Letter]:
        """A letter with these messages that exists, for each way on where of all clocks the ages in `late` are late."""
        edges = [program.edges[each.state] for program, each in zip(self._programs, running, strict=True)]
        closed = (program.closed[each.state] for program, each in zip(self._programs, running, strict=True))
        alphabet = self._shut.get(frozenset(chain.from_iterable(closed)), self._alphabet)
        heard = {name: name in messages for name in self._messages[-1]}
        for answers in _ways(self._programs, edges, heard, late):
            letter = alphabet.completed(answers)
            if letter is not None:
                yield letter


def _outcome(program: TimedMonitor, target: int, letter: Letter, late: set[int]) -> Outcome:
    """Where `target` leads by `letter`, where the clocks in `late` are past their due times."""
    while target < 0:
        decision = program.decisions[~target]
        clock = decision.atom - len(program.atoms)
        answer = clock in late if clock >= 0 else program.atoms[decision.atom] in letter
        target = decision.high if answer else decision.low
    return program.outcomes[target]


def _act(outcome: Outcome, program: int, is_held: bool, dues: dict[Moment, Due]) -> None:
    """Set the clocks of a program; at a clock step, the letter before was held up to the nanosecond before."""
    for clock, effect, duration in outcome.actions:
        moment = program, clock
        match effect:
            case Effect.START:
                dues[moment] = THEN, duration
            case Effect.RELEASE:
                dues[moment] = THEN, duration - is_held
            case Effect.EXTEND:
                base, offset = dues[moment]
                dues[moment] = base, offset + duration
            case Effect.STOP:
                dues.pop(moment, None)


def _ways(
    programs: Sequence[TimedMonitor], edges: Sequence[int], answers: Answers, late: frozenset[Moment], number: int = 0
) -> Iterator[Answers]:
    """The combinations of answers that lead through the decisions of all monitors, one after the other.

    No clock is past its due time at a step but the ages in `late`; the first of `programs` has this `number`.
    """
    if not programs:
        yield answers
        return
    first, *others = programs
    edge, *rest = edges
    if edge >= 0:
        yield from _ways(others, rest, answers, late, number + 1)
        return
    decision = first.decisions[~edge]
    clock = decision.atom - len(first.atoms)
    if clock >= 0:
        target = decision.high if (number, clock) in late else decision.low
        yield from _ways(programs, [target, *rest], answers, late, number)
        return
    atom = first.atoms[decision.atom]
    for answer, target in ((False, decision.low), (True, decision.high)):
        if answers.get(atom, answer) == answer:
            yield from _ways(programs, [target, *rest], {**answers, atom: answer}, late, number)
