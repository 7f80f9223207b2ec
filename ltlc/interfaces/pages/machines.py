"""The monitor of a property with the way that a run took through it, as a picture."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from ltlc.backends.clock_words import lateness
from ltlc.backends.guards import Cube, TooManyCubesError, cubes
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.trails import Trail
from ltlc.interfaces.pages.graphs import Edge, graph_svg
from ltlc.program.properties import Words, words
from ltlc.runtime.properties import Moment
from ltlc.runtime.reports import printable
from ltlc.runtime.times import Scale
from ltlc.semantics.monitor import Monitor, below
from ltlc.semantics.timed_atoms import Clock
from ltlc.semantics.trackers import Tracker, trackers_of

MOST_STATES = 20
"""Of a monitor with more states, only the way that was taken is shown."""


@dataclass(frozen=True, slots=True)
class Picture:
    """A monitor as SVG; `letters` says what the letters in its labels stand for, `remark` what was left out, if any."""

    svg: str
    letters: tuple[tuple[str, str], ...]
    remark: str


def machine_picture(compiled: Compiled, trail: Trail | None, scale: Scale, name: str) -> Picture:
    """The monitor of a property, and the edges of it that are in `trail`, of a recording that `began` then.

    Without a trail, the monitor by itself. `name` is that of the picture on its page.
    """
    told = words(compiled.specification, compiled.machine)
    conditions = _conditions(compiled, told)
    named = tuple(zip(map(_letter, range(len(conditions))), conditions, strict=True))
    found = (*_at_steps(told), *_at_clock_steps(told, len(compiled.machine.clocks)))
    if trail is None:
        return _alone(told, found, named, name)
    edges = [_taken(edge, trail.edges, scale) for edge in found]
    remark = ""
    if len(told.verdicts) > MOST_STATES:
        edges = [edge for edge in edges if edge.taken]
        remark = f"Only the path taken is shown: the monitor has {len(told.verdicts)} states."
    return Picture(graph_svg(told.verdicts, edges, trail.state, name), named, remark)


def _alone(told: Words, edges: Sequence[Edge], letters: tuple[tuple[str, str], ...], name: str) -> Picture:
    """The monitor itself, if it is small enough to be looked at."""
    if len(told.verdicts) > MOST_STATES:
        return Picture("", letters, f"It has {len(told.verdicts)} states: `ltlc build --target dot` draws it.")
    return Picture(graph_svg(told.verdicts, edges, None, name), letters, "")


def _conditions(compiled: Compiled, told: Words) -> list[str]:
    """What the monitor asks: its conditions, and then whether the bounds on its clocks have passed."""
    asked = (*told.atoms, *(_of_clock(each) for each in trackers_of(compiled.formula) if each.bounds))
    return [printable(compiled.specification.as_written(name)) for name in asked]


def _of_clock(tracker: Tracker) -> str:
    """What a clock decides when its first bound passes."""
    if isinstance(tracker.subject, Clock):
        return lateness(tracker.subject, tracker.bounds[0])
    return tracker.atoms[0]


def _letter(number: int) -> str:
    """A, B and so on up to Z, then A1."""
    return chr(ord("A") + number % 26) + (str(number // 26) if number > 25 else "")


def _taken(edge: Edge, taken: Mapping[tuple[int, int], Moment], scale: Scale) -> Edge:
    moment = taken.get((edge.source, edge.target))
    if moment is None or moment.by_time != edge.by_time:
        return edge
    order = list(taken).index((edge.source, edge.target)) + 1
    return replace(edge, taken=f"{order}. at {scale.text(moment.time)}")


def _at_steps(told: Words) -> Iterator[Edge]:
    """The edges that steps take, with the letters that lead along them."""
    monitor = Monitor(told.atoms, told.verdicts, told.steps, told.decisions)

    def way(cube: Cube) -> str:
        return " and ".join(f"{'' if holds else 'not '}{_letter(atom)}" for atom, holds in cube) or "always"

    for state in range(len(monitor.verdicts)):
        for target, letters in _cubes(monitor, state).items():
            yield Edge(state, target, tuple(map(way, letters)) or ("…",))


def _at_clock_steps(told: Words, clocks: int) -> Iterator[Edge]:
    """The edges that time alone takes, with the clocks whose bounds have passed."""
    monitor = Monitor(told.atoms, told.verdicts, told.expires, told.decisions)
    first = len(monitor.atoms)
    only = (_letter(first),) if clocks == 1 else ("time passes",)
    for state in range(len(monitor.edges)):
        for target, letters in _cubes(monitor, state).items():
            asked = dict.fromkeys(atom for cube in letters for atom, holds in cube if holds and atom >= first)
            if target != state:
                yield Edge(state, target, tuple(map(_letter, asked)) or only, by_time=True)


def _cubes(monitor: Monitor, state: int) -> dict[int, list[Cube]]:
    """For each target the letters that lead there; none where they are too many to be listed."""
    try:
        return cubes(monitor, state)
    except TooManyCubesError:
        return {target: [] for target in below(monitor.decisions, [monitor.edges[state]]) if target >= 0}
