"""What is wanted of messages, and which elements of their lists that leads to."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from ltlc.inputs.recordings.blocks import Array, Places, Ragged, Samples, joined
from ltlc.specification.expressions import Each, Match, Parallel, PathStep

Path = tuple[PathStep, ...]

Tree = dict[PathStep | None, "Tree"]
"""What is wanted of a value: of its parts, by the step to each; of itself, if it has None."""


def tree(paths: Iterable[Path]) -> Tree:
    """What is wanted, from the paths to it."""
    root: Tree = {}
    for path in paths:
        part = root
        for step in path:
            part = part.setdefault(step, {})
        part[None] = {}
    return root


class Choice:
    """Which elements of a list are wanted, and what of them has been found."""

    def __init__(self, wanted: Tree, messages: int, indexes: Mapping[Parallel, Places]) -> None:
        self._wanted = wanted
        self._messages = messages
        self._indexes = indexes
        self._paths = {step: list(_paths(part)) for step, part in wanted.items() if step is not None}
        if None in wanted:
            self._paths[Each()] = [()]
        self._pieces: dict[Path, list[tuple[int, Samples]]] = {}
        self._met = {step: np.zeros(messages, np.bool_) for step in wanted if isinstance(step, Match)}
        self.inside = tree(
            [path for paths in self._paths.values() for path in paths] + [(step.key,) for step in self._met]
        )

    @property
    def end(self) -> int:
        """How many elements have to be looked at; nothing is wanted of those behind."""
        ends = [step + 1 if isinstance(step, int) else 1 << 62 for step in self._paths]
        return max(ends, default=0)

    def take(self, number: int, rows: Places, element: Mapping[Path, Samples]) -> None:
        """Take what was found in the element with this number, which the messages in `rows` have."""
        for step, paths in self._paths.items():
            where = self._where(step, number, rows, element)
            if where is None:
                continue
            for path in (path for path in paths if path in element):
                samples = element[path]
                kept = samples.taken(np.flatnonzero(where[samples.rows]))
                self._pieces.setdefault((step, *path), []).append((number, kept))

    def _where(
        self, step: PathStep, number: int, rows: Places, element: Mapping[Path, Samples]
    ) -> NDArray[np.bool_] | None:
        """In which messages `step` leads to this element; None: in none."""
        match step:
            case Each():
                return np.ones(self._messages, np.bool_)
            case int():
                return np.ones(self._messages, np.bool_) if step == number else None
            case Parallel():
                there: NDArray[np.bool_] = self._indexes[step] == number
                return there
            case Match():
                keys, met = element[(step.key,)], self._met[step]
                here = np.zeros(self._messages, np.bool_)
                here[keys.rows] = keys.values == step.value
                here &= ~met
                met |= here
                return here
            case _:
                raise AssertionError(step)

    def found(self, rows: Places, counts: Places) -> dict[Path, Samples]:
        """What was found, by what was wanted; the messages are `rows`, with so many elements."""
        found: dict[Path, Samples] = {}
        for step, paths in self._paths.items():
            for path in paths:
                pieces = self._pieces.get((step, *path), [])
                if isinstance(step, Each):
                    whole: Path = () if None in self._wanted and path == () else (step, *path)
                    found[whole] = _gathered(pieces, rows, counts)
                elif pieces:
                    found[(step, *path)] = in_order([samples for _, samples in pieces])
        return found


def _paths(wanted: Tree) -> Iterator[Path]:
    """The paths that `wanted` was made of."""
    for step, part in wanted.items():
        if step is None:
            yield ()
        else:
            yield from ((step, *path) for path in _paths(part))


def _gathered(pieces: list[tuple[int, Samples]], rows: Places, counts: Places) -> Samples:
    """The elements of each message side by side, from those of each number."""
    if not pieces:
        return Samples(rows, Ragged(np.array([], np.float64), counts))
    of = np.concatenate([samples.rows for _, samples in pieces])
    numbers = np.concatenate([np.full(len(samples.rows), number) for number, samples in pieces])
    elements: Array = np.concatenate([samples.values for _, samples in pieces])
    return Samples(rows, Ragged(elements[np.lexsort((numbers, of))], counts))


def in_order(parts: list[Samples]) -> Samples:
    """The samples of all parts, in the order of their rows."""
    whole = joined(parts)
    return whole if len(parts) == 1 else whole.taken(whole.rows.argsort(kind="stable"))
