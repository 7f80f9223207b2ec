"""The n-th greatest margin of each of many windows, in as many passes as their ranks have binary digits."""

from __future__ import annotations

import numpy as np

from ltlc.inputs.recordings.blocks import Array, Places
from ltlc.semantics.robustness import FALSE


def nth_greatest(count: int, margins: Array, firsts: Places, ends: Places) -> Array:
    """The margin with the place `count`, from 1 on, among those from each of `firsts` to before its end, by size.

    FALSE where there are fewer. All windows are followed through a wavelet matrix (Claude, Navarro and Ordóñez, *The
    wavelet matrix*, 2015): by each digit of their ranks, the greatest first, margins are parted into two halves.
    """
    found = np.full(len(firsts), FALSE)
    enough = np.flatnonzero(ends - firsts >= count)
    sizes, ranks = np.unique(margins, return_inverse=True)
    left, right, rest = firsts[enough], ends[enough], np.full(len(enough), count - 1)
    rank = np.zeros(len(enough), np.int64)
    for digit in reversed(range((len(sizes) - 1).bit_length())):
        is_one = ranks >> digit & 1 == 1
        ones = np.insert(is_one.cumsum(), 0, 0)
        from_ones, to_ones = ones[left], ones[right]
        is_there = rest < to_ones - from_ones
        zeros = len(ranks) - int(ones[-1])
        rest = np.where(is_there, rest, rest - to_ones + from_ones)
        left = np.where(is_there, zeros + from_ones, left - from_ones)
        right = np.where(is_there, zeros + to_ones, right - to_ones)
        rank |= is_there.astype(np.int64) << digit
        ranks = np.concatenate((ranks[~is_one], ranks[is_one]))
    found[enough] = sizes[rank]
    return found
