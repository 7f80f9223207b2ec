"""Extremes of rows of margins: from each on, and over windows; and what clamps make of a margin, one after the other.

What an operator does at an instant with its value at the next one is a *clamp*, x ↦ max(low, min(high, x)). Clamps are
closed under composition, so that of many is one, and to take it several times at a piece is to take it once.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ltlc.inputs.recordings.blocks import Array, Places
from ltlc.semantics.robustness import FALSE, TRUE

BLOCK = 1024
"""So many margins are looked at together."""

LANE, LANES = 16, 1 << 16
"""So many clamps are taken one after the other, side by side with others; and so many altogether."""

WINDOWS = 1 << 14
"""So many windows are looked at together, or more, if they are long."""


def empty(extreme: np.ufunc) -> float:
    """The least or the greatest of no margins."""
    return TRUE if extreme is np.minimum else FALSE


def extremes_from(extreme: np.ufunc, margins: Array, last: float) -> Array:
    """The least or greatest from each margin on, with `last`: that of what comes after a block, in most blocks."""
    of_blocks = extreme.reduceat(margins, np.arange(0, len(margins), BLOCK))
    after = extreme.accumulate(np.append(of_blocks[1:], last)[::-1])[::-1]
    found: Array = np.repeat(after, BLOCK)[: len(margins)]
    for number in np.flatnonzero(extreme(of_blocks, after) != after).tolist():
        block = slice(number * BLOCK, (number + 1) * BLOCK)
        extreme(extreme.accumulate(margins[block][::-1])[::-1], after[number], out=found[block])
    return found


def extremes_of_windows(extreme: np.ufunc, margins: Array, firsts: Places, ends: Places) -> Array:
    """The least or greatest of the margins from each of `firsts` to before its end, which is later.

    All are looked at in blocks that are longer than the longest window.
    """
    found = np.empty(len(firsts))
    size = max(WINDOWS, 4 * int((ends - firsts).max(initial=0)))
    for start in range(0, len(firsts), size):
        block = slice(start, start + size)
        first, end = int(firsts[block].min()), int(ends[block].max())
        _of_halves(extreme, margins[first:end], firsts[block] - first, ends[block] - first, found[block])
    return found


def _of_halves(extreme: np.ufunc, margins: Array, firsts: Places, ends: Places, found: Array) -> None:
    """Each is that of two halves that overlap, both a power of two long."""
    lengths = ends - firsts
    least, most = int(lengths.min()), int(lengths.max())
    for level in range(most.bit_length()):
        half = 1 << level
        if half <= least and most < 2 * half:
            extreme(margins[firsts], margins[ends - half], out=found)
        elif 2 * half > least:
            at = np.flatnonzero(lengths >> level == 1)
            found[at] = extreme(margins[firsts[at]], margins[ends[at] - half])
        margins = extreme(margins[:-half], margins[half:])


class Clamps(NamedTuple):
    """x ↦ max(low, min(high, x)), for each piece."""

    low: Array
    high: Array

    def of(self, inner: Clamps) -> Clamps:
        """These, of what `inner` makes."""
        return Clamps(np.maximum(self.low, np.minimum(self.high, inner.low)), np.minimum(self.high, inner.high))

    def taken(self, places: Places | slice) -> Clamps:
        """Those at `places`."""
        return Clamps(self.low[places], self.high[places])

    def of_value(self, inner: Array | float) -> Array:
        """What they make of a margin."""
        found: Array = np.maximum(self.low, np.minimum(self.high, inner))
        return found


def backwards(clamps: Clamps, last: float) -> Array:
    """For each piece, what all clamps from it on make of `last`, the one at the piece last of all."""
    found = np.empty(len(clamps.low))
    for start in range((len(found) - 1) // LANES * LANES, -1, -LANES):
        block = slice(start, start + LANES)
        _backwards(clamps.taken(block), last, found[block])
        last = float(found[start])
    return found


def _backwards(clamps: Clamps, last: float, found: Array) -> None:
    """Lanes side by side: first what all clamps of each are together, then from lane to lane, then within each."""
    lanes = len(found) // LANE
    whole = lanes * LANE
    for piece in range(len(found) - 1, whole - 1, -1):
        found[piece] = last = max(float(clamps.low[piece]), min(float(clamps.high[piece]), last))
    if not lanes:
        return
    low, high = (part[:whole].reshape(lanes, LANE).T.copy() for part in clamps)
    of_lanes = Clamps(low[-1], high[-1])
    for place in range(LANE - 2, -1, -1):
        of_lanes = Clamps(low[place], high[place]).of(of_lanes)
    margins = np.empty(lanes)
    _backwards(of_lanes, last, margins)
    margins = np.append(margins[1:], last)
    for place in range(LANE - 1, -1, -1):
        margins = np.maximum(low[place], np.minimum(high[place], margins), out=low[place])
    found[:whole].reshape(lanes, LANE)[:] = low.T


def over_windows(clamps: Clamps, firsts: Places, ends: Places, last: Array | float) -> Array:
    """What the clamps of the pieces from each of `firsts` to before its end make of `last`, that at the first last."""
    found = Clamps(np.full(len(firsts), FALSE), np.full(len(firsts), TRUE))
    at, rest, level = firsts.copy(), ends - firsts, 0
    while rest.any():
        has = np.flatnonzero(rest & 1)
        if len(has):
            found.low[has], found.high[has] = found.taken(has).of(clamps.taken(at[has]))
            at[has] += 1 << level
        rest >>= 1
        half = 1 << level
        clamps = clamps.taken(slice(None, -half)).of(clamps.taken(slice(half, None)))
        level += 1
    return found.of_value(last)
