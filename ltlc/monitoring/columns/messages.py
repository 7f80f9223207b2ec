"""The messages of slices in a block: by columns, a row for each."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Array, Block, Places, Ragged, Samples
from ltlc.monitoring.columns.atoms import bits_of, prepare
from ltlc.monitoring.columns.bits import Bytes, Mask, union, unpack
from ltlc.monitoring.columns.derived import derive
from ltlc.monitoring.columns.prepared import Prepared
from ltlc.monitoring.columns.series import Columns, Steps, UnsupportedError
from ltlc.monitoring.columns.values import not_numbers
from ltlc.program.expressions import reads_of
from ltlc.runtime.sampling import Derived, Reading
from ltlc.runtime.slice_keys import Cut, Key


@dataclass(frozen=True)
class Messages:
    """Those with one of `ids`, in these `rows`; `without_id` counts the others. None of the `invalid` ones is a step.

    Their `letters` say which of the atoms hold that read nothing else, `latest` has the samples of the readings.
    """

    ids: Array
    rows: Places
    without_id: int
    steps: Steps
    letters: Bytes
    invalid: Mask | None
    latest: Mapping[str, Array]

    def __len__(self) -> int:
        return len(self.ids)


def messages_of(
    block: Block, cut: Cut, key: Key, read: Sequence[str], of: Prepared, others: Collection[int]
) -> Messages:
    """Those in `block` on the topic of the `key`, of which the signals `read` are. Raises UnsupportedError.

    The atoms with the numbers `others` read something else.
    """
    rows = rows_with(block, key.topic, read)
    ids, has_id = _ids(block, key.name, rows)
    signals = [s for s in cut.signals if cut.sampler.topics[s.name] <= {key.topic}]
    readings = [s for s in signals if isinstance(s, Reading)]
    latest = {s.name: _values(block, s.name, rows)[has_id] for s in readings if s.name != cut.variable}
    at, without_id, rows = np.arange(len(ids)), len(rows) - len(ids), rows[has_id]
    samples = {name: Samples(at, values) for name, values in latest.items()}
    if len(latest) < len(readings):
        samples[cut.variable] = Samples(at, ids)
    times = block.times if len(rows) == len(block.times) else block.times.take(rows)
    columns = Columns(Block(times, samples, {key.topic: at}), cut.sampler, readings, are_ticks=True)
    derive(columns, [s for s in signals if isinstance(s, Derived)], cut.sampler, of.definitions)
    names = {signal.name for signal in signals}
    steps = columns.steps([i for i in cut.window.inputs if i.signal in names], [key.topic])
    if any(len(of) < len(ids) for name, of in columns.series.items() if cut.is_own(name)):
        raise UnsupportedError("a signal of slices without a value at some messages")
    letters = letters_of(of, steps, [n for n in range(len(of.atoms)) if n not in others])
    guards = [guard for guard in of.guards if {r.signal for r in reads_of(guard)} <= names]
    return Messages(ids, rows, without_id, steps, letters, not_numbers(guards, steps), latest)


def letters_of(of: Prepared, steps: Steps, atoms: Collection[int]) -> Bytes:
    """The letter of each of `steps`, restricted to `atoms`: bit i is whether atom i holds."""
    names = {of.atoms[number].name for number in atoms}
    prepare((each for each in of.compare if each[0] in names), steps)
    letters = np.zeros(len(steps), np.uint8)
    for number in atoms if len(steps) else ():
        letters |= unpack(bits_of(of.atoms[number], steps), len(steps)).view(np.uint8) << np.uint8(number)
    return letters


def rows_with(block: Block, topic: str, read: Sequence[str]) -> Places:
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
