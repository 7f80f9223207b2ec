"""A tableau: does some infinite word satisfy a residual? Answered with such a word, or with levels that show why not.

The nodes are conjunctions of obligations; an edge says what one step can leave of them. An infinite path is a word that
satisfies its first node if every eventuality on it is met. Nothing here is trusted: the certificate checker judges it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from ltlc.assurance.residuals import Cube, Residuals
from ltlc.semantics.certificate import Level
from ltlc.semantics.diagrams import Diagram
from ltlc.semantics.ltl import Until
from ltlc.semantics.words import Lasso, Letter

MOST_NODES = 3000
MOST_EDGES = 60_000


class TooLargeError(Exception):
    """The tableau outgrew its bounds."""


@dataclass(frozen=True, slots=True)
class Edge:
    """One step: the node after it, the eventualities of the node before it that it meets, by level, and its letter."""

    target: Cube
    met: frozenset[int]
    letter: Letter


class Tableau:
    """The tableau of the residuals that are asked about, built as far as that needs."""

    def __init__(self, residuals: Residuals) -> None:
        self._residuals = residuals
        self._edges: dict[Cube, list[Edge]] = {}
        self._edge_count = 0

    def _eventualities(self, node: Cube) -> list[int]:
        """The levels of the `until` formulas that `node` asserts."""
        return [level for level, asserted in node if asserted and isinstance(self._residuals.obligation(level), Until)]

    def _step(self, node: Cube) -> Diagram:
        """What one possible step demands and leaves, with marks for the eventualities that are met at it."""
        residuals, diagrams = self._residuals, self._residuals.diagrams
        result = diagrams.conjunction(residuals.possible, residuals.progress(residuals.of_cube(node)))
        for level in self._eventualities(node):
            goal = residuals.obligation(level)
            assert isinstance(goal, Until)
            met = residuals.now(goal.right)
            mark = diagrams.variable(residuals.mark(level))
            result = diagrams.conjunction(result, diagrams.choose(met, mark, diagrams.negation(mark)))
        return result

    def edges(self, node: Cube) -> list[Edge]:
        """Every way to take a step from `node`, up to the letter. Raises TooLargeError."""
        if node not in self._edges:
            found: dict[tuple[Cube, frozenset[int]], Edge] = {}
            for residual, letter in self._residuals.after_letters(self._step(node)).items():
                for cube in self._residuals.cubes(residual):
                    edge = self._edge(node, cube, letter)
                    found.setdefault((edge.target, edge.met), edge)
                    if len(self._edges) >= MOST_NODES or self._edge_count + len(found) > MOST_EDGES:
                        raise TooLargeError
            self._edges[node] = list(found.values())
            self._edge_count += len(found)
        return self._edges[node]

    def _edge(self, node: Cube, cube: Cube, letter: Letter) -> Edge:
        """The edge to what `cube` says of obligations, marked as it says."""
        target = frozenset(literal for literal in cube if self._residuals.is_obligation(literal[0]))
        met = frozenset(level for level in self._eventualities(node) if (self._residuals.mark(level), True) in cube)
        return Edge(target, met, letter)

    def components(self, roots: Iterable[Cube]) -> list[list[Cube]]:
        """The strongly connected components of what is reachable from `roots`, successors first (Tarjan 1972)."""
        index: dict[Cube, int] = {}
        low: dict[Cube, int] = {}
        open_nodes: list[Cube] = []
        is_open: set[Cube] = set()
        found: list[list[Cube]] = []
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
                        component: list[Cube] = []
                        while not component or component[-1] != node:
                            component.append(open_nodes.pop())
                            is_open.discard(component[-1])
                        found.append(component)
        return found

    def judge(self, roots: Iterable[Diagram]) -> tuple[Level, ...] | Lasso:
        """An infinite word that satisfies one of the residuals `roots`, or levels that show that there is none.

        Raises TooLargeError.
        """
        cubes = [cube for root in roots for cube in self._residuals.cubes(root)]
        levels = []
        for component in self.components(cubes):
            inside = set(component)
            if not any(edge.target in inside for node in component for edge in self.edges(node)):
                levels.append(self._level(component, None))
                continue
            unmet = self._unmet(component, inside)
            if unmet is None:
                return self._lasso(cubes, component)
            levels.append(self._level(component, unmet))
        return tuple(reversed(levels))

    def _level(self, component: list[Cube], unmet: int | None) -> Level:
        residuals = self._residuals
        eventuality = None if unmet is None else residuals.obligation(unmet)
        assert eventuality is None or isinstance(eventuality, Until)
        return Level(eventuality, tuple(residuals.formula(residuals.of_cube(node)) for node in component))

    def _unmet(self, component: list[Cube], inside: set[Cube]) -> int | None:
        """An eventuality that every node of the component asserts and that no edge inside it meets."""
        common = set(self._eventualities(component[0]))
        for node in component:
            common &= set(self._eventualities(node))
            for edge in self.edges(node):
                if edge.target in inside:
                    common -= edge.met
        return min(common, default=None)

    def _lasso(self, roots: list[Cube], component: list[Cube]) -> Lasso:
        """A word whose path leads into the component and goes round in it, meeting every eventuality."""
        inside = set(component)
        start = component[0]
        stem = [] if start in roots else self._path(roots, lambda edge: edge.target == start, None)
        loop: list[tuple[Cube, Edge]] = []
        here = start
        for level in sorted({level for node in component for level in self._eventualities(node)}):
            if not any(_meets(edge, level) for _, edge in loop):
                loop += self._path([here], lambda edge, level=level: _meets(edge, level), inside)  # type: ignore[misc]
                here = loop[-1][1].target
        if here != start or not loop:
            loop += self._path([here], lambda edge: edge.target == start, inside)
        return Lasso(tuple(edge.letter for _, edge in stem), tuple(edge.letter for _, edge in loop))

    def _path(
        self, sources: list[Cube], is_last: Callable[[Edge], bool], inside: set[Cube] | None
    ) -> list[tuple[Cube, Edge]]:
        """A shortest path from one of `sources` that ends with an edge of the kind wanted; there is one."""
        came_by: dict[Cube, tuple[Cube, Edge] | None] = dict.fromkeys(sources)
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


def _meets(edge: Edge, level: int) -> bool:
    """Whether no promise of this eventuality survives the edge."""
    return level in edge.met or (level, True) not in edge.target


def _back(node: Cube, came_by: dict[Cube, tuple[Cube, Edge] | None]) -> list[tuple[Cube, Edge]]:
    """The path by which the search came to `node`."""
    path: list[tuple[Cube, Edge]] = []
    step = came_by[node]
    while step is not None:
        path.append(step)
        step = came_by[step[0]]
    return path[::-1]
