"""Runs that take a monitor to all its states and along all its edges: for testing what a robot sends it.

An edge is a pair of states, the second after one letter from the first. Those that can be taken are found on the
monitor and its reset machine: with clocks, that may be a few more than time allows.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain

from ltlc.assurance.courses import Courses
from ltlc.assurance.histories import Sample
from ltlc.assurance.messages import Messages
from ltlc.assurance.replay import Run
from ltlc.assurance.sources import read, without_news
from ltlc.assurance.traffic import Begun, Event, Followed, Follower, Heard, Passed, Settings, Traffic
from ltlc.assurance.values import PERIOD, Frames, Samples
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.semantics.diagrams import Diagram, Diagrams, of_predicate, rows
from ltlc.semantics.ltl import Formula, atoms
from ltlc.semantics.reset_machine import ResetMachine

ROUNDS = 4
"""So many times more runs are drawn for edges that are still missing."""

Edge = tuple[int, int]
"""From a state of a monitor to another, or the same."""


@dataclass(frozen=True, slots=True)
class Cover:
    """`runs` that take the edges `taken`, of those that `can_be`; each takes one that no other does."""

    runs: Sequence[Run[Event]]
    taken: frozenset[Edge]
    can_be: frozenset[Edge]

    @property
    def missing(self) -> list[Edge]:
        """The edges that no run takes."""
        return sorted(self.can_be - self.taken)

    @property
    def states(self) -> tuple[set[int], set[int]]:
        """Those that the runs reach, and all that can be reached."""
        reached, all_ = ({0, *chain.from_iterable(some)} for some in (self.taken, self.can_be | self.taken))
        return reached, all_

    def __str__(self) -> str:
        reached, all_ = self.states
        edges = f"{len(self.taken)} of {len(self.can_be | self.taken)} edges"
        return f"{len(reached)} of {len(all_)} states, {edges}, in {len(self.runs)} runs"


def covering(compiled: Compiled, messages: Messages, settings: Settings) -> Cover:
    """Runs of messages on the topics that a property reads, by definition what they mean.

    The verdict after each event is that of `Expectation`. The property is judged once, not for each id.
    """
    samples = Samples(without_news(compiled.specification), read(compiled.specification, messages))
    can_be, taken = possible(compiled), frozenset[Edge]()
    found: list[tuple[Run[Event], frozenset[Edge]]] = []
    for run in _drawn(compiled, samples, settings):
        kept, edges = _until_nothing_is_new(run, compiled, taken)
        if edges - taken:
            found.append((kept, edges))
            taken |= edges
        if taken >= can_be:
            break
    return Cover(_needed(found), taken, can_be)


def possible(compiled: Compiled) -> frozenset[Edge]:
    """The edges of a monitor that letters which exist lead along, as far as its reset machine tells."""
    monitor, time = compiled.monitor, ResetMachine(compiled.formula)
    diagrams, levels = Diagrams(), dict[str, int]()

    def of(predicate: Formula) -> Diagram:
        for name in sorted(atoms(predicate)):
            levels.setdefault(name, len(levels))
        return of_predicate(predicate, diagrams, levels)

    def narrowed(letters: Diagram, predicate: Formula) -> Diagram | None:
        both = diagrams.conjunction(letters, of(predicate))
        return None if both == diagrams.false else both

    allowed = of(compiled.specification.alphabet.as_formula())
    for name in monitor.atoms:
        levels.setdefault(name, len(levels))
    after = rows(diagrams, monitor.decisions, lambda atom: diagrams.variable(levels[monitor.atoms[atom]]))
    nowhere = diagrams.terminal(None)
    edges = set[Edge]()
    todo = [(0, time.initial)]
    places = {*todo}
    while todo:
        state, clocks = todo.pop()
        for move in time.moves(clocks, allowed, narrowed):
            for target in diagrams.values(diagrams.choose(move.letters, after(monitor.edges[state]), nowhere)):
                if target is None:
                    continue
                edges.add((state, target))
                place = (target, move.target)
                if not monitor.verdicts[target].is_permanent and place not in places:
                    places.add(place)
                    todo.append(place)
    return frozenset(edges)


def _drawn(compiled: Compiled, samples: Samples, settings: Settings) -> Iterator[Run[Event]]:
    """Runs along each transition, then at random and around the times at which clocks expire."""
    traffic, followed = Traffic(samples), Followed(compiled, samples.sources)
    if not traffic.sources.topics():
        return
    for course in Courses(samples, compiled.monitor).guided():
        events = tuple(_one_by_one(traffic, course))
        follower = Follower(followed, settings)
        if all(map(_is_recorded, events)):
            yield Run(events, [follower.take(event) for event in events], settings)
    for _ in range(ROUNDS):
        for run in chain(traffic.in_time(compiled, settings), traffic.at_random(compiled, settings)):
            if run.settings == settings and all(map(_is_recorded, run.events)):
                yield run


def _one_by_one(traffic: Traffic, course: Frames) -> Iterator[Event]:
    """A message on each topic on which something changes, time after time: in recordings they come one by one."""
    before: dict[str, Sample] = {}
    for number, frame in enumerate(course):
        for said in traffic.all(frame):
            if before.get(said.topic) != said.sample:
                yield Heard(number * PERIOD, said)
            before[said.topic] = said.sample
        yield Passed(number * PERIOD)


def _is_recorded(event: Event) -> bool:
    """Whether tables have it: a session begins with a message, messages say something, no cell is empty."""
    if isinstance(event, Heard):
        return bool(event.said.sample) and "" not in event.said.sample.values()
    return not isinstance(event, Begun)


def _until_nothing_is_new(
    run: Run[Event], compiled: Compiled, taken: frozenset[Edge]
) -> tuple[Run[Event], frozenset[Edge]]:
    """The run up to the last event by which it takes another edge, and all the edges it takes."""
    monitor, state = compiled.monitor, 0
    edges: dict[Edge, int] = {}
    for number, letters in enumerate(run.steps):
        for letter in letters:
            if letter is not None and not monitor.verdicts[state].is_permanent:
                before, state = state, monitor.step(state, letter)
                edges.setdefault((before, state), number)
    end = 1 + max((number for edge, number in edges.items() if edge not in taken), default=-1)
    kept = Run(run.events[:end], run.steps[:end], run.settings)
    return kept, frozenset(edge for edge, number in edges.items() if number < end)


def _needed(found: Sequence[tuple[Run[Event], frozenset[Edge]]]) -> list[Run[Event]]:
    """Those without which an edge is missing; the last ones that were found are asked first."""
    kept = list(found)
    for each in reversed(found):
        others = frozenset(chain.from_iterable(edges for run, edges in kept if run is not each[0]))
        if each[1] <= others:
            kept.remove(each)
    return [run for run, _ in kept]
