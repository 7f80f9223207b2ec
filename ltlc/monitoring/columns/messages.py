"""The messages of slices in a block: by columns, a row for each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ltlc.inputs.recordings.blocks import Array, Block, Places, Ragged, Samples
from ltlc.monitoring.columns.atoms import bits_of, prepare
from ltlc.monitoring.columns.bits import Bytes, Mask, union, unpack
from ltlc.monitoring.columns.derived import derive
from ltlc.monitoring.columns.prepared import Prepared
from ltlc.monitoring.columns.series import Columns, Steps, UnsupportedError
from ltlc.monitoring.columns.values import not_numbers
from ltlc.runtime.sampling import Derived, Reading, Value
from ltlc.runtime.slice_keys import Cut, Id, Key


@dataclass(frozen=True)
class Messages:
    """Those with one of `ids`, a step of its slice each, but for the `invalid` ones; `without_id` counts the others.

    Their `letters` say which atoms hold, `latest` has the samples of the readings.
    """

    cut: Cut
    ids: Array
    without_id: int
    steps: Steps
    letters: Bytes
    invalid: Mask | None
    latest: Mapping[str, Array]

    def __len__(self) -> int:
        return len(self.ids)

    @property
    def times(self) -> Places:
        """The time of each."""
        return self.steps.columns.times

    def values(self, message: int, id_: Id) -> list[Value]:
        """What the property reads at one of them, which has this id."""
        cut = self.cut
        return [id_ if i.signal == cut.variable else self.steps.value(i, message) for i in cut.window.inputs]


def messages_of(block: Block, cut: Cut, key: Key, read: Sequence[str], of: Prepared) -> Messages:
    """Those in `block` on the topic of the `key`, of which the signals `read` are. Raises UnsupportedError."""
    rows = _rows(block, key.topic, read)
    ids, has_id = _ids(block, key.name, rows)
    readings = [s for s in cut.signals if isinstance(s, Reading) and s.name != cut.variable]
    latest = {reading.name: _values(block, reading.name, rows)[has_id] for reading in readings}
    at = np.arange(len(ids))
    samples = {name: Samples(at, values) for name, values in latest.items()}
    if len(readings) < sum(isinstance(s, Reading) for s in cut.signals):
        samples[cut.variable] = Samples(at, ids)
    given = Block(block.times[rows[has_id]], samples, {key.topic: at})
    columns = Columns(given, cut.sampler, [s for s in cut.signals if isinstance(s, Reading)], are_ticks=True)
    derive(columns, [s for s in cut.signals if isinstance(s, Derived)], cut.sampler, of.definitions)
    steps = columns.steps(cut.window.inputs, [key.topic])
    if any(len(of) < len(ids) for name, of in columns.series.items() if cut.is_own(name)):
        raise UnsupportedError("a signal of slices without a value at some messages")
    prepare(of.compare, steps)
    letters = _letters(of, steps)
    return Messages(cut, ids, len(rows) - len(ids), steps, letters, not_numbers(of.guards, steps), latest)


def _letters(of: Prepared, steps: Steps) -> Bytes:
    """Of each of `steps` its letter: bit i says whether atom i holds."""
    letters = np.zeros(len(steps), np.uint8)
    for number, atom in enumerate(of.atoms if len(steps) else ()):
        letters |= unpack(bits_of(atom, steps), len(steps)).view(np.uint8) << np.uint8(number)
    return letters


def _rows(block: Block, topic: str, read: Sequence[str]) -> Places:
    """The rows of `block` with a message on a topic, of which the signals `read` are."""
    parts = [block.samples[name].rows for name in read if name in block.samples]
    parts += [block.messages[topic]] if topic in block.messages else []
    if parts and all(
        len(part) == len(parts[0]) and (part is parts[0] or np.array_equal(part, parts[0])) for part in parts
    ):
        return parts[0]
    return union([np.empty(0, np.int64), *parts])


def _ids(block: Block, name: str, rows: Places) -> tuple[Array, Places | slice]:
    """The ids of the messages in `rows`, and which of them have one. Raises UnsupportedError."""
    found = block.samples.get(name)
    if found is None:
        return np.empty(0), slice(0)
    if isinstance(found.values, Ragged):
        raise UnsupportedError("ids in arrays")
    values, has_id = found.values, np.isin(rows, found.rows) if len(found.rows) < len(rows) else None
    if values.dtype.kind == "f" and np.isnan(np.min(values, initial=0)):
        is_number = ~np.isnan(values)
        has_id = np.isin(rows, found.rows[is_number])
        values = values[is_number]
    return values, slice(None) if has_id is None else np.flatnonzero(has_id)


def _values(block: Block, name: str, rows: Places) -> Array:
    """The values of a signal in all of `rows`. Raises UnsupportedError."""
    found = block.samples.get(name)
    if found is None or len(found.rows) < len(rows):
        raise UnsupportedError(f"messages without a value of {name}")
    if isinstance(found.values, Ragged):
        raise UnsupportedError("arrays of slices")
    return found.values
