"""A tableau: does some run in time satisfy a residual? Answered with such a word, or with levels that show why not.

The nodes are conjunctions of obligations, with where the clocks are; an edge says what one step can leave of them. An
infinite path is a run that satisfies its first node if every eventuality on it is met, and time goes on: each fairness
set recurs. Nothing here is trusted: the certificate checker judges it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import NamedTuple

from ltlc.assurance.residuals import Cube, Residuals
from ltlc.dataclass import dataclass
from ltlc.semantics.certificate import Level, Place, Progress
from ltlc.semantics.diagrams import Diagram
from ltlc.semantics.ltl import Until
from ltlc.semantics.reset_machine import Clocks, Move, ResetMachine
from ltlc.semantics.words import Lasso, Letter

MOST_NODES = 3000
MOST_EDGES = 60_000


class TooLargeError(Exception):
    """The tableau outgrew its bounds."""


class Node(NamedTuple):
    """Where the clocks are, and the obligations."""

    clocks: Clocks
    cube: Cube


@dataclass(frozen=True, slots=True)
class Edge:
    """One step: the node after it, the eventualities of the node before it that it meets, by level, and its letter.

    `fair` are the fairness sets of time that it is in.
    """

    target: Node
    met: frozenset[int]
    fair: frozenset[int]
    letter: Letter


class Tableau:
    """The tableau of the residuals that are asked about, built as far as that needs."""

    def __init__(self, residuals: Residuals, time: ResetMachine) -> None:
        self._residuals = residuals
        self._time = time
        self._edges: dict[Node, list[Edge]] = {}
        self._edge_count = 0

    def _eventualities(self, cube: Cube) -> list[int]:
        """The levels of the `until` formulas that `cube` asserts."""
        return [level for level, asserted in cube if asserted and isinstance(self._residuals.obligation(level), Until)]

    def _step(self, cube: Cube) -> Diagram:
        """What one step demands and leaves, with marks for the eventualities that are met at it."""
        residuals, diagrams = self._residuals, self._residuals.diagrams
        result = residuals.progress(residuals.of_cube(cube))
        for level in self._eventualities(cube):
            goal = residuals.obligation(level)
            assert isinstance(goal, Until)
            met = residuals.now(goal.right)
            mark = diagrams.variable(residuals.mark(level))
            result = diagrams.conjunction(result, diagrams.choose(met, mark, diagrams.negation(mark)))
        return result

    def edges(self, node: Node) -> list[Edge]:
        """Every way to take a step from `node`, up to the letter. Raises TooLargeError."""
        if node not in self._edges:
            found: dict[tuple[Node, frozenset[int], frozenset[int]], Edge] = {}
            step = self._step(node.cube)
            for move in self._residuals.moves(self._time, node.clocks):
                for edge in self._edges_of(node.cube, move, self._residuals.diagrams.conjunction(move.letters, step)):
                    found.setdefault((edge.target, edge.met, edge.fair), edge)
                    if len(self._edges) >= MOST_NODES or self._edge_count + len(found) > MOST_EDGES:
                        raise TooLargeError
            self._edges[node] = list(found.values())
            self._edge_count += len(found)
        return self._edges[node]

    def _edges_of(self, node: Cube, move: Move[Diagram], step: Diagram) -> Iterator[Edge]:
        """The edges by `move` to what `step` leaves of obligations, marked as it says."""
        for residual, letter in self._residuals.after_letters(step).items():
            for cube in self._residuals.cubes(residual):
                target = frozenset(literal for literal in cube if self._residuals.is_obligation(literal[0]))
                met = (level for level in self._eventualities(node) if (self._residuals.mark(level), True) in cube)
                yield Edge(Node(move.target, target), frozenset(met), move.fair, letter)

    def components(self, roots: Iterable[Node]) -> list[list[Node]]:
        """The strongly connected components of what is reachable from `roots`, successors first (Tarjan 1972)."""
        index: dict[Node, int] = {}
        low: dict[Node, int] = {}
        open_nodes: list[Node] = []
        is_open: set[Node] = set()
        found: list[list[Node]] = []
        for root in roots:
            if root in index:
                continue
            work = [(root, 0)]
            while work:
                node, position = work.pop()
                if position == 0:
                    index[node] = low[node] = len(index)
                    open_nodes.append(node)
                    is_open.add(node)
                edges = self.edges(node)
                if position:
                    low[node] = min(low[node], low[edges[position - 1].target])
                while position < len(edges):
                    target = edges[position].target
                    position += 1
                    if target not in index:
                        work += [(node, position), (target, 0)]
                        break
                    if target in is_open:
                        low[node] = min(low[node], index[target])
                else:
                    if low[node] == index[node]:
                        component: list[Node] = []
                        while not component or component[-1] != node:
                            component.append(open_nodes.pop())
                            is_open.discard(component[-1])
                        found.append(component)
        return found

    def judge(self, roots: Iterable[tuple[Clocks, Diagram]]) -> tuple[Level, ...] | Lasso:
        """A run in time that satisfies the residual of one of `roots` from there, or levels that show that none does.

        Raises TooLargeError.
        """
        nodes = [Node(clocks, cube) for clocks, residual in roots for cube in self._residuals.cubes(residual)]
        levels = []
        for component in self.components(nodes):
            inside = set(component)
            if not any(edge.target in inside for node in component for edge in self.edges(node)):
                levels.append(self._level(component, None))
                continue
            unmet = self._unmet(component, inside)
            if unmet is None:
                return self._lasso(nodes, component)
            levels.append(self._level(component, unmet))
        return tuple(reversed(levels))

    def _level(self, component: list[Node], progress: Progress) -> Level:
        residuals = self._residuals
        places = (Place(clocks, residuals.formula(residuals.of_cube(cube))) for clocks, cube in component)
        return Level(progress, tuple(places))

    def _unmet(self, component: list[Node], inside: set[Node]) -> Progress:
        """An eventuality that every node of the component asserts and no edge in it meets, or a set without an edge."""
        inner = [edge for node in component for edge in self.edges(node) if edge.target in inside]
        asserted = (set(self._eventualities(node.cube)) for node in component)
        unmet = set.intersection(*asserted).difference(*(edge.met for edge in inner))
        if unmet:
            eventuality = self._residuals.obligation(min(unmet))
            assert isinstance(eventuality, Until)
            return eventuality
        return min(set(range(self._time.sets)).difference(*(edge.fair for edge in inner)), default=None)

    def _lasso(self, roots: list[Node], component: list[Node]) -> Lasso:
        """A word whose path leads into the component and goes round in it, meeting all that has to recur."""
        inside = set(component)
        start = component[0]
        stem = [] if start in roots else self._path(roots, lambda edge: edge.target == start, None)
        loop: list[tuple[Node, Edge]] = []
        here = start
        eventualities = sorted({level for node in component for level in self._eventualities(node.cube)})
        wanted = [partial(_meets, level) for level in eventualities]
        wanted += [partial(_is_in, fair_set) for fair_set in range(self._time.sets)]
        for meets in wanted:
            if not any(meets(edge) for _, edge in loop):
                loop += self._path([here], meets, inside)
                here = loop[-1][1].target
        if here != start or not loop:
            loop += self._path([here], lambda edge: edge.target == start, inside)
        return Lasso(tuple(edge.letter for _, edge in stem), tuple(edge.letter for _, edge in loop))

    def _path(
        self, sources: list[Node], is_last: Callable[[Edge], bool], inside: set[Node] | None
    ) -> list[tuple[Node, Edge]]:
        """A shortest path from one of `sources` that ends with an edge of the kind wanted; there is one."""
        came_by: dict[Node, tuple[Node, Edge] | None] = dict.fromkeys(sources)
        queue = list(came_by)
        for node in queue:
            for edge in self.edges(node):
                if inside is not None and edge.target not in inside:
                    continue
                if is_last(edge):
                    return [*_back(node, came_by), (node, edge)]
                if edge.target not in came_by:
                    came_by[edge.target] = (node, edge)
                    queue.append(edge.target)
        raise AssertionError("a component is connected")


def _meets(level: int, edge: Edge) -> bool:
    """Whether no promise of this eventuality survives the edge."""
    return level in edge.met or (level, True) not in edge.target.cube


def _is_in(fair_set: int, edge: Edge) -> bool:
    return fair_set in edge.fair


def _back(node: Node, came_by: dict[Node, tuple[Node, Edge] | None]) -> list[tuple[Node, Edge]]:
    """The path by which the search came to `node`."""
    path: list[tuple[Node, Edge]] = []
    step = came_by[node]
    while step is not None:
        path.append(step)
        step = came_by[step[0]]
    return path[::-1]
