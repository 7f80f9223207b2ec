"""Properties that take values at openings, drawn at random, and what they are by definition, nanosecond by nanosecond.

Written from `docs/language.md` alone: nothing here but the text of a property comes from ltlc or goes there.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from random import Random
from typing import Any

DECLARATIONS = "decl x /x Bool.data\ndecl y /y Bool.data\ndecl d /d Float64.data\ndecl g /g Bool.data\n"

Node = tuple[Any, ...]
"""A state predicate or a property: its keyword, then its parts and numbers."""

RUN: Node = ("run",)
"""In the place of the way to a scope: the whole run."""


@dataclass(frozen=True)
class Row:
    """What came in at a time, in ns: `values` by the names of signals, each on its own topic."""

    time: int
    values: Mapping[str, Any]


class Draw:
    """Draws properties and runs."""

    def __init__(self, chance: Random) -> None:
        self.chance = chance
        self.divides = chance.random() < 0.15

    def property(self) -> Node:
        """A property in whose scopes values are taken, scopes that reopen by themselves among them."""
        kind = self.chance.random()
        if kind < 0.15:
            return ("after", self._event(), self._scope())
        if kind < 0.3:
            return ("within", self.chance.randint(4, 15), self._scope())
        if kind < 0.4:
            return (self.chance.choice(["both", "either"]), self._scope(), self._scope())
        return self._scope()

    def _scope(self, depth: int = 1) -> Node:
        body = self._scope(depth - 1) if depth and self.chance.random() < 0.3 else self._body()
        if self.chance.random() < 0.15:
            return ("until", self._event(), body)
        if self.chance.random() < 0.15:
            return ("after", self._event(), body)
        opening = self._atom() if self.chance.random() < 0.6 else self._event()
        return ("after_until", opening, self._pulse() if self.chance.random() < 0.6 else self._event(), body)

    def _pulse(self) -> Node:
        """What closes a scope for a moment, so that it reopens by itself."""
        held = self._atom()
        return ("new",) if not self.divides and self.chance.random() < 0.5 else _begins(held)

    def _body(self) -> Node:
        one, bound = self._event(), self.chance.randint(1, 5)
        return self.chance.choice(
            [
                ("always", one),
                ("always", self._kept()),
                ("never", self._kept()),
                ("never", ("and", self._kept(), one)),
                ("eventually", self._kept()),
                ("within", bound, ("eventually", self._kept())),
                ("within", bound, ("always", self._kept())),
                ("both", ("always", one), ("within", bound, ("eventually", self._kept()))),
            ]
        )

    def _event(self, depth: int = 1) -> Node:
        kind = self.chance.random()
        if depth == 0 or kind < 0.4:
            return self._atom()
        if kind < 0.5:
            return ("not", self._event(depth - 1))
        if kind < 0.75:
            return (self.chance.choice(["and", "or"]), self._event(depth - 1), self._event(depth - 1))
        bound = self.chance.choice([None, 1, 2, 4])
        return self.chance.choice(
            [
                ("previously", self._event(depth - 1)),
                ("once", self._event(depth - 1), bound),
                ("historically", self._event(depth - 1), bound),
                ("since", self._event(depth - 1), self._event(depth - 1), bound),
            ]
        )

    def _atom(self) -> Node:
        kind = self.chance.random()
        if kind < 0.45:
            return (self.chance.choice("xy"),)
        if kind < 0.6:
            return self._kept()
        if kind < 0.65:
            return ("above", self.chance.choice([0, 1]))
        if self.divides:
            return (self.chance.choice("xy"),)
        return ("new",) if kind < 0.9 else ("age", self.chance.choice([1, 3]))

    def _kept(self) -> Node:
        if self.divides and self.chance.random() < 0.4:
            return ("ratio", self.chance.choice([0, 1]))
        return self.chance.choice([("over", 0), ("over", 1), ("same",), ("other",), ("far", 1), ("taken", 1)])

    def rows(self) -> list[Row]:
        """A run whose first row has all that has a value; in some, d changes only where another scope may open."""
        time, found = 10, list[Row]()
        together, steady = self.chance.choice([False, True]), self.chance.choice([0.0, 0.7])
        last = {"x": False, "y": False}
        for number in range(self.chance.randint(2, 9)):
            values: dict[str, Any] = {name: self.chance.random() < 0.6 for name in "xy" if self.chance.random() < 0.5}
            if self.chance.random() < 0.4:
                values["g"] = True
            turns = "g" in values or any(value and not last[name] for name, value in values.items())
            if turns if together else self.chance.random() < 0.6:
                values["d"] = self._level(steady)
            if number == 0:
                values = {"x": True, "y": True, "d": self._level(steady), **values}
            last |= {name: values[name] for name in "xy" if name in values}
            found.append(Row(time, values))
            time += self.chance.choice([0, 1, 1, 2, 3, 5])
        return found

    def _level(self, steady: float) -> float:
        """A value of d, most of them the same if the run is a `steady` one: what is kept differs from it at times."""
        return 1.0 if self.chance.random() < steady else float(self.chance.randint(0, 3))


def _begins(predicate: Node) -> Node:
    return ("and", predicate, ("not", ("previously", predicate)))


_JOINED = {"both": "and", "either": "or"}
_COMPARED = {
    "over": "d > @{{d, opening}} + {}",
    "same": "d == @{{d, opening}}",
    "other": "d != @{{d, opening}}",
    "far": "abs(d - @{{d, opening}}) > {}",
    "taken": "@{{d, opening}} > {}",
    "ratio": "d / @{{d, opening}} > {}",
    "above": "d > {}",
    "age": "age(g) <= {} ns",
    "new": "new g",
    "x": "x",
    "y": "y",
}


def text(node: Node) -> str:
    """A node as its author writes it."""
    match node:
        case ("not" | "previously" as keyword, part):
            return f"({keyword} {text(part)})"
        case ("and" | "or" | "both" | "either" as keyword, left, right):
            return f"({text(left)} {_JOINED.get(keyword, keyword)} {text(right)})"
        case ("once" as keyword, part, bound):
            return f"({keyword} {text(part)}{'' if bound is None else f' within {bound} ns'})"
        case ("historically" as keyword, part, bound):
            return f"({keyword} {text(part)}{'' if bound is None else f' for {bound} ns'})"
        case ("since", kept, start, bound):
            return f"({text(kept)} since {text(start)}{'' if bound is None else f' within {bound} ns'})"
        case ("always" | "never" | "eventually" as keyword, part):
            return f"({keyword} {text(part)})"
        case ("within", bound, part):
            return f"(within {bound} ns, {text(part)})"
        case ("after" | "until" as keyword, event, part):
            return f"({keyword} {text(event)}, {text(part)})"
        case ("after_until", opening, closing, part):
            return f"(after_until {text(opening)}, {text(closing)}, {text(part)})"
        case _:
            return _COMPARED[node[0]].format(*node[1:])


@dataclass
class Instant:
    """A time, what is known at it, whether it is a step, and what each scope has taken, by the way to the scope."""

    time: int
    values: dict[str, Any]
    new: bool
    is_step: bool
    taken: dict[Node, float] = field(default_factory=dict)


class Run:
    """A run of a property: its instants up to now, and which of its scopes are open."""

    def __init__(self, node: Node, session: int) -> None:
        self.node, self.session = node, session
        self.instants: list[Instant] = []
        self.opened: dict[Node, int | None] = {}
        self.ended: set[Node] = set()
        self.scopes = [RUN, *_scopes(node, ())]
        self.known: dict[Any, bool] = {}

    def step(self, time: int, values: Mapping[str, Any], new: bool) -> bool:
        """A step, or none where something has no value."""
        now = Instant(time, dict(values), new, True, dict(self.instants[-1].taken) if self.instants else {})
        for scope in self.scopes:
            if self.opened.get(scope) is None and (scope != RUN or not self.instants):
                now.taken[scope] = values["d"]
        if any(_is_undefined(values["d"], now.taken[scope]) for scope in _dividing(self.node, (), RUN)):
            return False
        self._go_on(now)
        return True

    def hold(self, until: int) -> None:
        """Every nanosecond up to `until` at which what holds is held."""
        while self.instants and self.instants[-1].time < until:
            last = self.instants[-1]
            self._go_on(Instant(last.time + 1, last.values, False, False, dict(last.taken)))

    def _go_on(self, now: Instant) -> None:
        self.instants.append(now)
        self._turn(self.node, (), RUN, len(self.instants) == 1, True)

    def _turn(self, node: Node, way: Node, scope: Node, is_fresh: bool, is_open: bool) -> None:
        """Open and close the scopes of `node`, in the scope around it, which is open or not, and may just open."""
        n = len(self.instants) - 1
        match node:
            case ("both" | "either", left, right):
                self._turn(left, (*way, 0), scope, is_fresh, is_open)
                self._turn(right, (*way, 1), scope, is_fresh, is_open)
            case ("within", _, part):
                self._turn(part, (*way, 0), scope, is_fresh, is_open)
            case ("until", event, part):
                if is_fresh:
                    self.ended.discard(way)
                if is_open and self.holds(event, scope, n):
                    self.ended.add(way)
                self._turn(part, (*way, 0), scope, is_fresh, is_open and way not in self.ended)
            case ("after" | "after_until", opening, *closing, part):

                def closes() -> bool:
                    return bool(closing) and self.holds(closing[0], way, n)

                def opens() -> bool:
                    return is_open and self.holds(opening, scope, n) and not closes()

                was_open = self.opened.get(way) is not None and not is_fresh
                if was_open:
                    now_open = is_open and not closes()
                else:
                    now_open = opens()
                    if now_open and not self.instants[n].is_step:
                        self.instants[n].taken[way] = self.instants[n].values["d"]
                        self.known.clear()
                        now_open = opens()
                begins = now_open and not was_open
                self.opened[way] = n if begins else self.opened.get(way) if now_open else None
                self._turn(part, (*way, 0), way, begins, now_open)
            case _:
                pass

    def holds(self, predicate: Node, scope: Node, n: int) -> bool:
        """Whether a state predicate that stands in a scope holds at the instant n."""
        key = predicate, scope, n
        if key not in self.known:
            self.known[key] = self._holds(predicate, scope, n)
        return self.known[key]

    def _holds(self, predicate: Node, scope: Node, n: int) -> bool:
        now = self.instants[n]

        def at(part: Node, k: int) -> bool:
            return self.holds(part, scope, k)

        def since(k: int) -> int:
            return now.time - self.instants[k].time

        match predicate:
            case ("x" | "y" as name,):
                return bool(now.values[name])
            case ("new",):
                return now.new
            case ("age", int(most)):
                heard = [each.time for each in self.instants[: n + 1] if each.new]
                return now.time - (heard[-1] if heard else self.session) <= most
            case ("not", part):
                return not at(part, n)
            case ("and", left, right):
                return at(left, n) and at(right, n)
            case ("or", left, right):
                return at(left, n) or at(right, n)
            case ("previously", part):
                return n > 0 and at(part, n - 1)
            case ("once", part, bound):
                return any(at(part, k) for k in range(n + 1) if bound is None or since(k) <= bound)
            case ("historically", part, None):
                return all(at(part, k) for k in range(n + 1))
            case ("historically", part, bound):
                return any(since(k) >= bound and all(at(part, j) for j in range(k, n + 1)) for k in range(n + 1))
            case ("since", kept, start, bound):
                return any(
                    at(start, k) and all(at(kept, j) for j in range(k + 1, n + 1))
                    for k in range(n + 1)
                    if bound is None or since(k) <= bound
                )
            case _:
                return _compares(predicate, now.values["d"], now.taken[scope])

    def satisfies(self, end: int) -> bool:
        """Whether the first `end` instants satisfy the property."""
        return self._satisfies(self.node, (), RUN, 0, end)

    def _satisfies(self, node: Node, way: Node, scope: Node, first: int, end: int) -> bool:
        """Whether the instants from the `first` to before the `end` do."""

        def inside(number: int, start: int, stop: int, of: Node = scope) -> bool:
            part = node[-2:][number] if node[0] in ("both", "either") else node[-1]
            return self._satisfies(part, (*way, number), of, start, stop)

        def where(event: Node, start: int, of: Node) -> int | None:
            return next((k for k in range(start, end) if self.holds(event, of, k)), None)

        match node:
            case ("both", _, _):
                return inside(0, first, end) and inside(1, first, end)
            case ("either", _, _):
                return inside(0, first, end) or inside(1, first, end)
            case ("always", part):
                return all(self.holds(part, scope, k) for k in range(first, end))
            case ("never", part):
                return not any(self.holds(part, scope, k) for k in range(first, end))
            case ("eventually", part):
                return any(self.holds(part, scope, k) for k in range(first, end))
            case ("within", bound, _):
                stop = [k for k in range(first, end) if self.instants[k].time - self.instants[first].time <= bound]
                return inside(0, first, stop[-1] + 1 if stop else first)
            case ("after", event, _):
                k = where(event, first, scope)
                return k is None or inside(0, k, end, way)
            case ("until", event, _):
                k = where(event, first, scope)
                return k is not None and inside(0, first, k)
            case _:
                return all(inside(0, k, m, way) for k, m in self._episodes(node, way, scope, first, end))

    def _episodes(self, node: Node, way: Node, scope: Node, first: int, end: int) -> Iterator[tuple[int, int]]:
        _, opening, closing, _ = node
        k = first
        while k < end:
            if self.holds(opening, scope, k) and not self.holds(closing, way, k):
                m = next((m for m in range(k + 1, end) if self.holds(closing, way, m)), end)
                yield k, m
                k = m
            else:
                k += 1


def _compares(predicate: Node, now: float, taken: float) -> bool:
    match predicate:
        case ("above", int(than)):
            return now > than
        case ("over", int(by)):
            return now > taken + by
        case ("same",):
            return now == taken
        case ("other",):
            return now != taken
        case ("far", int(by)):
            return abs(now - taken) > by
        case ("taken", int(than)):
            return taken > than
        case ("ratio", int(than)):
            return not _is_undefined(now, taken) and (math.inf if taken == 0 else now / taken) > than
        case _:
            raise ValueError(predicate)


def _is_undefined(now: float, taken: float) -> bool:
    return now == taken == 0


def _scopes(node: Node, way: Node) -> Iterator[Node]:
    """The ways to the scopes of a property, outer ones first."""
    if node[0] in ("after", "after_until"):
        yield way
    if node[0] in ("both", "either"):
        yield from (each for number, part in enumerate(node[1:]) for each in _scopes(part, (*way, number)))
    elif node[0] in ("within", "until", "after", "after_until"):
        yield from _scopes(node[-1], (*way, 0))


def _dividing(node: Node, way: Node, scope: Node) -> Iterator[Node]:
    """The scopes in which something is divided by what was taken."""
    match node:
        case ("ratio", _):
            yield scope
        case ("after", event, part):
            yield from _dividing(event, way, scope)
            yield from _dividing(part, (*way, 0), way)
        case ("after_until", opening, closing, part):
            yield from _dividing(opening, way, scope)
            yield from _dividing(closing, way, way)
            yield from _dividing(part, (*way, 0), way)
        case ("both" | "either", left, right):
            yield from _dividing(left, (*way, 0), scope)
            yield from _dividing(right, (*way, 1), scope)
        case ("until" | "within", first, part):
            if isinstance(first, tuple):
                yield from _dividing(first, way, scope)
            yield from _dividing(part, (*way, 0), scope)
        case _:
            for part in node[1:]:
                if isinstance(part, tuple):
                    yield from _dividing(part, way, scope)


def read_by(node: Node) -> frozenset[str]:
    """The topics that a property reads."""
    return frozenset(re.findall(r"\b[xydg]\b", text(node)))


def is_step(row: Row, node: Node, is_first: bool) -> bool:
    """Whether a row is a step; what reads only which messages come begins with the session."""
    read = read_by(node)
    return bool(read & row.values.keys()) or (is_first and read <= {"g"})
