"""What monitors require of samples: speeds not negative, arrays of equal length."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import MOST_ELEMENTS, Block, Ragged
from ltlc.inputs.recordings.rows import RecordingError, failure
from ltlc.runtime.sampling import Value
from ltlc.runtime.times import seconds_text
from ltlc.semantics.durations import Nanoseconds
from ltlc.specification.expressions import Current, Field, Signal
from ltlc.specification.signs import never_negative


@dataclass(frozen=True, slots=True)
class Checks:
    """Signals of which no sample is negative, and arrays that have as many elements each in every row."""

    unsigned: Sequence[str]
    lists: Sequence[Sequence[str]]

    def check(self, block: Block, path: Path) -> None:
        """Raise RecordingError if a row of `block`, of the recording at `path`, cannot be."""
        _check_sizes(block, path)
        _check_signs(block, self.unsigned, path)
        _check_lengths(block, self.lists, path)

    def check_row(self, time: Nanoseconds, values: Mapping[str, Value], path: Path) -> None:
        """Raise RecordingError if a row cannot be that has these values by signal."""
        for name in self.unsigned:
            if name in values and values[name] < 0:
                raise _negative(path, time, name, values[name])
        for names in self.lists:
            lengths = {name: len(values[name]) if name in values else -1 for name in names}
            if len(set(lengths.values())) > 1:
                raise _uneven(path, time, lengths)


def checks_of(signals: Iterable[Signal]) -> Checks:
    """What is to be checked of samples of these `signals`."""
    lists: dict[Field, list[str]] = {}
    unsigned = []
    for signal in signals:
        if not isinstance(signal.definition, Field):
            unsigned += [signal.name] if never_negative(Current(signal)) else []
        elif signal.type.element is not None:
            lists.setdefault(signal.definition.list, []).append(signal.name)
    return Checks(unsigned, [sorted(names) for names in lists.values()])


def _check_sizes(block: Block, path: Path) -> None:
    """Raise RecordingError for an array that is too large to be held."""
    for name, samples in block.samples.items():
        if (
            isinstance(samples.values, Ragged)
            and (large := np.flatnonzero(samples.values.lengths > MOST_ELEMENTS)).size
        ):
            time, length = int(block.times[samples.rows[large[0]]]), int(samples.values.lengths[large[0]])
            message = f"at {seconds_text(time)} s `{name}` has {length} elements; the maximum is {MOST_ELEMENTS}"
            raise failure("LTL803", path, message, "record the part to be judged as a separate field or topic")


def _check_signs(block: Block, unsigned: Iterable[str], path: Path) -> None:
    """Raise RecordingError for a negative distance or speed: monitors are made for letters that exist."""
    for name in unsigned:
        samples = block.samples[name]
        assert not isinstance(samples.values, Ragged)
        negative = np.flatnonzero(samples.values < 0)
        if negative.size:
            row = samples.rows[negative[0]]
            raise _negative(path, int(block.times[row]), name, float(samples.values[negative[0]]))


def _negative(path: Path, time: Nanoseconds, name: str, value: float) -> RecordingError:
    message = f"at {seconds_text(time)} s `{name}` is {value!r}, but this quantity is never negative"
    return failure("LTL803", path, message, "for a signed speed, record and use a component, such as `.velocity.x`")


def _check_lengths(block: Block, lists: Sequence[Sequence[str]], path: Path) -> None:
    """Raise RecordingError for fields of the messages of one array that have not as many elements each."""
    for names in lists:
        lengths = {name: _lengths(block, name) for name in names}
        if any((lengths[name] != lengths[names[0]]).any() for name in names):
            row = min(int(np.flatnonzero(lengths[name] != lengths[names[0]])[0]) for name in names[1:])
            raise _uneven(path, int(block.times[row]), {name: int(n[row]) for name, n in lengths.items()})


def _uneven(path: Path, time: Nanoseconds, lengths: Mapping[str, int]) -> RecordingError:
    told = [f"`{name}` has {'no sample' if length < 0 else length}" for name, length in lengths.items()]
    message = f"at {seconds_text(time)} s {', '.join(told)}: they are fields of the messages of one array"
    return failure("LTL803", path, message, "give all of them the same number of elements, or none of them a sample")


def _lengths(block: Block, name: str) -> NDArray[np.int64]:
    """How many elements each row has of an array; -1 if it has no sample."""
    lengths = np.full(len(block.times), -1, np.int64)
    samples = block.samples.get(name)
    if samples is not None and isinstance(samples.values, Ragged):
        lengths[samples.rows] = samples.values.lengths
    return lengths
