"""Shortest runs of monitors side by side, breadth first, one letter for each way on that exists.

Where time matters, the ways on are clock steps too, and steps after a while or at the last moment before one.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import takewhile
from typing import NamedTuple

from ltlc.automata.folding import fold
from ltlc.semantics.alphabet import Alphabet, Answers
from ltlc.semantics.durations import UNITS, Nanoseconds
from ltlc.semantics.ltl import Formula, conjunction
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.timed_atoms import News, news_of
from ltlc.semantics.timed_monitor import Effect, TimedMonitor
from ltlc.semantics.timed_run import TimedRun
from ltlc.semantics.trackers import trackers_of
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Letter, Word

Wanted = Callable[[Sequence[Verdict]], bool]
"""Whether a run on which the monitors say this is what is searched for."""

MOST_STATES, MOST_TIMES = 20_000, 1_000
"""A search that has seen more states side by side than this gives up, and sooner where each has times."""

FURTHER_AWAY = 4
"""Of so many smallest bounds, half of each is a while."""


class Running(NamedTuple):
    """Where one monitor is: its state, how long until each clock is due, and whether a clock step is next at once."""

    state: int
    due: tuple[Nanoseconds | None, ...]
    again: bool = False

    @property
    def left(self) -> Nanoseconds | None:
        """How long no clock step comes."""
        times = [0] if self.again else [due for due in self.due if due is not None]
        return min(times, default=None)


class Node(NamedTuple):
    """Where all monitors are, and the letter that is held, where that matters."""

    running: tuple[Running, ...]
    letter: Letter


class Move(NamedTuple):
    """A step with `letter`, or a clock step, so long after the last one."""

    after: Nanoseconds
    letter: Letter | None


def shortest(monitored: Sequence[tuple[Formula, Monitor]], alphabet: Alphabet, wanted: Wanted) -> Word | None:
    """A shortest word, not empty, after which the monitors say what is `wanted`; None if none is found."""
    return next(all_shortest(monitored, alphabet, wanted), None)


def all_shortest(monitored: Sequence[tuple[Formula, Monitor]], alphabet: Alphabet, wanted: Wanted) -> Iterator[Word]:
    """Words, not empty, after which the monitors say what is `wanted`, each getting there in another way, short first.

    `monitored` are formulas with their monitors. Where some have timed atoms, the words are runs in time.
    """
    formula = conjunction(formula for formula, _ in monitored)
    search = _Search([fold(each, alphabet, monitor) for each, monitor in monitored], alphabet, news_of(formula))
    return (_word(formula, moves) for moves in search.all_shortest(wanted))


def _word(formula: Formula, moves: Sequence[Move]) -> Word:
    """The letters along `moves`; the session begins with the first step."""
    trackers = trackers_of(formula)
    if not trackers and not news_of(formula):
        return tuple(move.letter for move in moves if move.letter is not None)
    run, time = TimedRun(trackers, news_of(formula), 0), 0
    word: list[Letter] = []
    for move in moves:
        time += move.after
        word += run.hold(time) if move.letter is None else run.step(time, move.letter)
    return tuple(word)


class _Search:
    """Where `programs` can be together, breadth first."""

    def __init__(self, programs: Sequence[TimedMonitor], alphabet: Alphabet, news: Iterable[News]) -> None:
        self._programs = programs
        self._alphabet = alphabet
        self._news = frozenset(each.name for each in news)
        self._read = frozenset(atom for program in programs if program.held_edges for atom in program.atoms)
        bounds = {a.duration for program in programs for outcome in program.outcomes for a in outcome.actions}
        self._whiles = [(bound + 1) // 2 for bound in sorted(bounds - {0})[:FURTHER_AWAY]] or [UNITS["s"]]

    def all_shortest(self, wanted: Wanted) -> Iterator[list[Move]]:
        """The moves of the runs that are searched for."""
        ages = [[due and due.duration for due in program.initially_due] for program in self._programs]
        start = Node(tuple(Running(0, tuple(due)) for due in ages), frozenset())
        ways: dict[Node, list[Move]] = {start: []}
        waiting = deque([start])
        while waiting and len(ways) < (MOST_TIMES if self._read else MOST_STATES):
            node = waiting.popleft()
            for move, target in self._moves(node, ways[node]):
                moves = [*ways[node], move]
                if wanted([p.verdicts[each.state] for p, each in zip(self._programs, target.running, strict=True)]):
                    yield moves
                if target not in ways:
                    ways[target] = moves
                    waiting.append(target)

    def _moves(self, node: Node, before: Sequence[Move]) -> Iterator[tuple[Move, Node]]:
        held = sum(move.after for move in takewhile(lambda move: move.letter is None, reversed(before)))
        left = [each.left for each in node.running if each.left is not None]
        for after in self._delays(held, min(left, default=None)) if before else [0]:
            for letter in self._letters(node):
                running = (self._stepped(*each, after, letter) for each in self._side_by_side(node))
                yield Move(after, letter), Node(tuple(running), letter & self._read)
        if left and before:
            after = min(left) + 1
            running = (self._held(*each, after, node.letter) for each in self._side_by_side(node))
            yield Move(after, None), Node(tuple(running), node.letter - self._news)

    def _delays(self, held: Nanoseconds, left: Nanoseconds | None) -> list[Nanoseconds]:
        """When a step may come: after a while or, if a clock step is next, at the last moment before it."""
        if not self._read:
            return [0]
        delays = [each * (held // each + 1) - held for each in self._whiles]
        return delays if left is None else [*(delay for delay in delays if delay < left), *([left] if left else [])]

    def _side_by_side(self, node: Node) -> Iterator[tuple[TimedMonitor, Running]]:
        return zip(self._programs, node.running, strict=True)

    def _letters(self, node: Node) -> Iterator[Letter]:
        """A letter that exists for each way on."""
        edges = [program.edges[each.state] for program, each in self._side_by_side(node)]
        for answers in _ways(self._programs, edges, {}):
            letter = self._alphabet.completed(answers)
            if letter is not None:
                yield letter

    def _stepped(self, program: TimedMonitor, running: Running, after: Nanoseconds, letter: Letter) -> Running:
        return _led(program, running, program.edges[running.state], after, 0, letter)

    def _held(self, program: TimedMonitor, running: Running, after: Nanoseconds, letter: Letter) -> Running:
        """A clock step, of the monitors for which it is the time."""
        if running.left is None or running.left + 1 > after:
            return Running(running.state, tuple(None if due is None else due - after for due in running.due))
        return _led(program, running, program.held_edges[running.state], after, 1, letter - self._news)


def _led(
    program: TimedMonitor, running: Running, target: int, after: Nanoseconds, held: Nanoseconds, letter: Letter
) -> Running:
    """Where `target` leads, so long after the last instant; the letter before was held up to `held` before this one."""
    due = [None if each is None else each - after for each in running.due]
    while target < 0:
        decision = program.decisions[~target]
        if decision.atom < len(program.atoms):
            answer = program.atoms[decision.atom] in letter
        else:
            left = due[decision.atom - len(program.atoms)]
            answer = left is not None and left < 0
        target = decision.high if answer else decision.low
    outcome = program.outcomes[target]
    for clock, effect, duration in outcome.actions:
        match effect:
            case Effect.START:
                due[clock] = duration
            case Effect.RELEASE:
                due[clock] = duration - held
            case Effect.EXTEND:
                due[clock] = (due[clock] or 0) + duration
            case Effect.STOP:
                due[clock] = None
    return Running(outcome.state, tuple(due), outcome.again)


def _ways(programs: Sequence[TimedMonitor], edges: Sequence[int], answers: Answers) -> Iterator[Answers]:
    """The combinations of answers that lead through the decisions of all monitors, one after the other."""
    if not programs:
        yield answers
        return
    first, *others = programs
    edge, *rest = edges
    if edge >= 0:
        yield from _ways(others, rest, answers)
        return
    decision = first.decisions[~edge]
    if decision.atom >= len(first.atoms):  # no clock is past its due time at a step
        yield from _ways(programs, [decision.low, *rest], answers)
        return
    atom = first.atoms[decision.atom]
    for answer, target in ((False, decision.low), (True, decision.high)):
        if answers.get(atom, answer) == answer:
            yield from _ways(programs, [target, *rest], {**answers, atom: answer})
