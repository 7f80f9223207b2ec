"""Columns of booleans packed into bits, and where they change."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Places

Bytes = NDArray[np.uint8]
Mask = NDArray[np.bool_]

FEW = 32
"""One byte of so many that changes is few: their places are listed."""

BATCH = 1 << 20
"""How many bytes of properties with equal tables are looked at together."""


@dataclass(frozen=True, slots=True)
class Bits:
    """Booleans, eight in each of `size` bytes, the first in its lowest bit; the last one is repeated to its end.

    `places` are the bytes, the first one included, that are not eight times the boolean before them, and `packed` has
    these; where they are many, `places` is None and `packed` has all.
    """

    packed: Bytes
    places: Places | None
    size: int

    def bytes(self) -> Bytes:
        """All of them."""
        if self.places is None:
            return self.packed
        lasts = (self.packed.view(np.int8) >> 7).view(np.uint8)
        found = lasts.repeat(lengths(self.places, self.size))
        found[self.places] = self.packed
        return found

    def part(self, first: int, end: int) -> Bits:
        """The bytes from the `first` to before the `end`."""
        if self.places is None:
            return Bits(self.packed[first:end], None, end - first)
        begin, stop = self.places.searchsorted((first + 1, end)).tolist()
        packed, places = self.packed[begin - 1 : stop].copy(), self.places[begin - 1 : stop] - first
        if places[0] < 0:
            packed[0], places[0] = 0xFF * (packed[0] >> 7), 0
        return Bits(packed, places, end - first)

    def at(self, places: Places | None) -> Bytes:
        """The bytes at `places`, among which are all that change; None for all."""
        if places is None:
            return self.bytes()
        if self.places is None:
            return self.packed.take(places)
        return Bits(self.packed, places.searchsorted(self.places), len(places)).bytes()


def lengths(starts: Places, end: int) -> Places:
    """How far it is from each of the `starts`, of which there is one, to the next, and from the last to the `end`."""
    found = np.empty_like(starts)
    np.subtract(starts[1:], starts[:-1], out=found[:-1])
    found[-1] = end - starts[-1]
    return found


def as_bits(packed: Bytes) -> Bits:
    """Bits of all these bytes."""
    words = _changing_words(packed)
    if is_few(len(words), len(packed)):
        places = _changing_bytes(packed, words)
        if is_few(len(places), len(packed)):
            return Bits(packed.take(places), places, len(packed))
    return Bits(packed, None, len(packed))


def _changing_words(packed: Bytes) -> Places:
    """Which eight bytes are not 64 times the boolean before them; the first ones are, and so is an incomplete rest."""
    words = packed[: len(packed) // 8 * 8].view(np.int64)
    differs = np.ones(-(-len(packed) // 8), np.bool_)
    np.not_equal(words[1:], words[:-1] >> 63, out=differs[1 : len(words)])
    return np.flatnonzero(differs)


def _changing_bytes(packed: Bytes, words: Places) -> Places:
    """The first byte, and those of the `words` that are not eight times the boolean before them."""
    places = (words[:, None] * 8 + np.arange(8)).reshape(-1)
    places = places[: places.searchsorted(len(packed))]
    differs = packed.take(places).view(np.int8) != packed.take(places - 1).view(np.int8) >> 7
    differs[0] = True
    found: Places = places[differs]
    return found


def pack(mask: Mask) -> Bits:
    """`mask`, which is not empty, as bits."""
    return as_bits(packed_bytes(mask))


def packed_bytes(mask: Mask) -> Bytes:
    """The bytes of `mask`, which is not empty; its last boolean is repeated to the end of the last byte."""
    packed = np.packbits(mask, bitorder="little")
    rest = len(mask) % 8
    if rest and mask[-1]:
        packed[-1] |= 0xFF << rest & 0xFF
    return packed


def is_few(places: int, size: int) -> bool:
    """Whether so many of `size` bytes are few."""
    return places * FEW <= size


def unpack(bits: Bits, count: int) -> Mask:
    """The first `count` booleans."""
    return np.unpackbits(bits.bytes(), count=count, bitorder="little").view(np.bool_)


def joined(columns: Sequence[Bits]) -> Bits:
    """Columns one after the other; the first byte of each is listed, or they all have all bytes."""
    if len(columns) == 1:
        return columns[0]
    *firsts, size = accumulate((bits.size for bits in columns), initial=0)
    places = [bits.places + first for bits, first in zip(columns, firsts, strict=True) if bits.places is not None]
    if len(places) == len(columns):
        return Bits(np.concatenate([bits.packed for bits in columns]), np.concatenate(places), size)
    return Bits(np.concatenate([bits.bytes() for bits in columns]), None, size)


def merged(columns: Sequence[Bits], size: int) -> Places | None:
    """The bytes in which one of the `columns` changes, which are joined of some of this size; None for all of them."""
    places = [bits.places for bits in columns]
    known = [each for each in places if each is not None]
    if len(known) < len(places) or not is_few(sum(map(len, known)), columns[0].size):
        return _where(columns, size)
    return known[0] if len(known) == 1 else union(known)


def _where(columns: Sequence[Bits], size: int) -> Places | None:
    """As `merged`, by looking at every byte."""
    differs = np.zeros(columns[0].size, np.bool_)
    for bits in columns:
        if bits.places is None:
            packed = bits.packed.view(np.int8)
            differs[1:] |= packed[1:] != packed[:-1] >> 7
        else:
            differs[bits.places] = True
    differs[::size] = True
    count = np.count_nonzero(differs)
    return None if 2 * count > len(differs) else np.flatnonzero(differs)


def union(parts: Iterable[Places]) -> Places:
    """The places in any of the `parts`, each once, ascending."""
    together = np.concatenate(tuple(parts))
    together.sort(kind="stable")
    if not len(together):
        return together
    return together[np.concatenate(([True], together[1:] != together[:-1]))]


def batches(columns: Sequence[Sequence[Bits]]) -> Iterator[list[int]]:
    """Which properties, of which these are the atoms, to take together: few at a time where many bytes change."""
    for are_listed in (True, False):
        batch: list[int] = []
        size = 0
        for number, atoms in enumerate(columns):
            if all(bits.places is not None for bits in atoms) is not are_listed:
                continue
            more = sum(len(bits.packed) for bits in atoms)
            if batch and size + more > BATCH:
                yield batch
                batch, size = [], 0
            batch.append(number)
            size += more
        if batch:
            yield batch
