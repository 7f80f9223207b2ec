"""Which values a property does not wait for: those that make no difference while no message brings them.

By `docs/language.md`, 'When a run begins', found by trying values: of what is read, and of all that stands beside it.
What is computed counts as if it could hold or fail, as ltlc has it.
"""

from __future__ import annotations

import math
import random
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import product
from typing import Any

from benchmarks.differential.forms import Form, Leaf, News, parts, value
from benchmarks.differential.names import Kind, Said
from benchmarks.differential.values import Computed, Frame, Key, Latched, NoValueError

TRIED = 300
"""So many combinations of values are tried of what a predicate reads."""

MOST = 8
"""With more parts that do not read a value, only some of what they can be is tried."""

Unit = frozenset[Key]
"""What is read as one: a signal, or the parts of one that is computed."""


class Trial:
    """Values of what the state predicates `roots` read, near the `constants` that they have.

    `made` is what is latched or computed among it.
    """

    def __init__(
        self,
        roots: Sequence[Form],
        names: Said,
        constants: Collection[Any],
        made: Mapping[str, Latched | Computed],
    ) -> None:
        self._roots, self._names, self._made = roots, names, made
        self._numbers = [n for n in constants if not isinstance(n, str)]
        self._texts = [c for c in constants if isinstance(c, str)]

    def is_excused(self, unit: Unit) -> bool:
        """Whether no root depends on `unit` where the news of one of its topics is out, whichever that is."""
        topics = {self._names.signals[name].topic for name, _ in unit}
        told = {part.topic for root in self._roots for part in parts(root) if isinstance(part, News)}
        return topics <= told and all(self._ignores(root, unit, topic) for root in self._roots for topic in topics)

    def _ignores(self, root: Form, unit: Unit, topic: str | None) -> bool:
        every = list(dict.fromkeys(parts(root)))
        own = [part for part in every if isinstance(part, Leaf) and part.keys & unit]
        if not own:
            return True
        found = self._answers(own, unit)
        free = [part for part in every if part not in own and part != News(topic or "")]
        return bool(found) and all(
            len(
                {
                    value(root, {News(topic or ""): False, **dict(zip(free, others, strict=True)), **each})
                    for each in found
                }
            )
            == 1
            for others in _tried(len(free))
        )

    def _answers(self, own: Sequence[Leaf], unit: Unit) -> list[dict[Form, bool]]:
        """What the leaves `own` can be together; none if nothing stands in for `unit` with which all have a value."""
        chance = random.Random(0)
        keys = sorted(unit.union(*(leaf.keys for leaf in own)))
        others = [{key: self._draw(key, chance) for key in keys} for _ in range(TRIED)]
        found: dict[tuple[bool, ...], None] = {}
        stands_in = False
        for here in others:
            mine = {key: here[key] for key in unit}
            samples = [{**each, **mine} for each in others[:40]]
            answers = [[_answer(leaf, each) for leaf in own] for each in samples]
            stands_in = stands_in or not any(answer is None for each in answers for answer in each)
            found |= dict.fromkeys(tuple(bool(a) for a in each) for each in answers if None not in each)
        if any(leaf.asks_openings or leaf.is_computed for leaf in own):
            sides = [
                (False, True) if leaf.asks_openings or leaf.is_computed else _sides(n, found)
                for n, leaf in enumerate(own)
            ]
            found = dict.fromkeys(product(*sides))
        return [dict(zip(own, each, strict=True)) for each in found] if stands_in else []

    def _draw(self, key: Key, chance: random.Random) -> Any:
        kind = self._kind(key[0])
        if kind[0] == "array":
            return tuple(self._of(kind[1:], chance) for _ in range(chance.choice([0, 1, 1, 2, 5])))
        return self._of(kind, chance)

    def _kind(self, name: str) -> Kind:
        match self._made.get(name):
            case Computed(is_predicate=is_predicate):
                return ("boolean" if is_predicate else "float64",)
            case Latched(latched):
                return self._names.signals[latched].kind
            case None:
                return self._names.signals[name].kind

    def _of(self, kind: Kind | tuple[str, ...], chance: random.Random) -> Any:
        match kind[0]:
            case "boolean":
                return chance.random() < 1 / 2
            case "string":
                return chance.choice([*self._texts, "", "another"])
            case "integer":
                return round(chance.choice([*self._numbers, 0, 1])) + chance.choice([-1, 0, 1])
            case _:
                far = [0.0, 1.0, -1.0, math.inf, -math.inf, 1e6, -1e6, 0.5]
                return chance.choice([*map(float, self._numbers), *far]) + chance.choice(
                    [-1.0, -1e-3, 0.0, 0.0, 1e-3, 1.0]
                )


def _sides(number: int, found: Collection[tuple[bool, ...]]) -> set[bool]:
    return {answers[number] for answers in found}


def _answer(leaf: Leaf, samples: Mapping[Key, Any]) -> bool | None:
    if leaf.asks_openings:
        return False
    try:
        return bool(leaf.of(Frame(samples)))
    except NoValueError:
        return None


def _tried(count: int) -> Iterator[tuple[bool, ...]]:
    if count <= MOST:
        yield from product((False, True), repeat=count)
        return
    chance = random.Random(0)
    yield from (tuple(chance.random() < 1 / 2 for _ in range(count)) for _ in range(2**MOST))
