"""Columns of booleans packed into bits, and where they change."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ltlc.recordings.blocks import Places

Bytes = NDArray[np.uint8]
Mask = NDArray[np.bool_]

FEW = 32
"""One byte of so many that changes is few: their places are listed."""


@dataclass(frozen=True, slots=True)
class Bits:
    """Booleans, eight in each of the bytes `packed`, the first in its lowest bit; the last one is repeated to its end.

    `places` are the bytes, the first one included, that are not eight times the boolean before them; None where these
    are many.
    """

    packed: Bytes
    places: Places | None


def pack(mask: Mask) -> Bits:
    """`mask`, which is not empty, as bits."""
    packed = packed_bytes(mask)
    return Bits(packed, few(differing(packed, None), len(packed)))


def packed_bytes(mask: Mask) -> Bytes:
    """The bytes of `mask`, which is not empty; its last boolean is repeated to the end of the last byte."""
    packed = np.packbits(mask, bitorder="little")
    rest = len(mask) % 8
    if rest and mask[-1]:
        packed[-1] |= 0xFF << rest & 0xFF
    return packed


def differing(packed: Bytes, before: bool | None) -> Places:
    """The bytes that are not eight times the boolean before them; for the first that is `before`, None if unknown."""
    copies = np.empty(len(packed), np.int8)
    copies[0] = -1 if before else 0
    np.right_shift(packed[:-1].view(np.int8), 7, out=copies[1:])
    differs = packed.view(np.int8) != copies
    if before is None:
        differs[0] = True
    return np.flatnonzero(differs)


def few(places: Places, count: int) -> Places | None:
    """`places`, unless they are many of `count`."""
    return places if len(places) * FEW <= count else None


def unpack(bits: Bits, count: int) -> Mask:
    """The first `count` booleans."""
    return np.unpackbits(bits.packed, count=count, bitorder="little").view(np.bool_)


def merged(columns: Sequence[Bits]) -> Places | None:
    """The bytes in which one of the `columns` changes; None for all of them, where these are many."""
    places = [bits.places for bits in columns]
    listed = [each for each in places if each is not None]
    if len(listed) < len(places) or sum(map(len, listed)) * FEW > len(columns[0].packed):
        return _where(columns)
    return listed[0] if len(listed) == 1 else union(listed)


def _where(columns: Sequence[Bits]) -> Places | None:
    """As `merged`, by looking at every byte."""
    differs = np.zeros(len(columns[0].packed), np.bool_)
    for bits in columns:
        if bits.places is None:
            packed = bits.packed.view(np.int8)
            differs[1:] |= packed[1:] != packed[:-1] >> 7
        else:
            differs[bits.places] = True
    differs[0] = True
    count = np.count_nonzero(differs)
    return None if 2 * count > len(differs) else np.flatnonzero(differs)


def union(parts: Iterable[Places]) -> Places:
    """The places in any of the `parts`, each once, ascending."""
    together = np.concatenate(tuple(parts))
    together.sort(kind="stable")
    if not len(together):
        return together
    return together[np.concatenate(([True], together[1:] != together[:-1]))]
