"""Pieces of a text, on each of which work is done in other threads, some pieces ahead of who takes them."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Generic, TypeVar

import numpy as np

from ltlc.recordings.arrow import OddError, check_order
from ltlc.recordings.blocks import Block, blocks_of
from ltlc.recordings.rows import Column, RecordingError, Row
from ltlc.recordings.text import Text
from ltlc.semantics.durations import Nanoseconds

Made = TypeVar("Made")

THREADS, DEPTH = 2, 4
"""How many pieces are worked on at once, and how many are held: those that wait to be taken, too."""


class Ahead(Generic[Made]):
    """The pieces of `text`, each with what `work` makes of it; a context, which ends the threads."""

    def __init__(self, text: Text, work: Callable[[bytes], Made]) -> None:
        self._text = text
        self._work = work
        self._pool = ThreadPoolExecutor(THREADS)
        self._pieces: deque[tuple[bytes, Future[Made]]] = deque()

    def __enter__(self) -> Ahead[Made]:
        return self

    def __exit__(self, *_: object) -> None:
        self._pool.shutdown(cancel_futures=True)

    def next(self) -> tuple[bytes, Made] | None:
        """The next piece; None when all have been taken. Raises RecordingError, after what could be read before it."""
        while len(self._pieces) < DEPTH:
            try:
                piece = self._text.piece()
            except RecordingError:
                if self._pieces:
                    break
                raise
            if not piece:
                break
            self._pieces.append((piece, self._pool.submit(self._work, piece)))
        if not self._pieces:
            return None
        piece, made = self._pieces.popleft()
        return piece, made.result()

    def go_back(self) -> None:
        """Put back into the text what was read ahead, for lines may be put back that come before it."""
        while self._pieces:
            piece, made = self._pieces.pop()
            made.cancel()
            self._text.put_back(piece)


def blocks_ahead(
    text: Text,
    by_columns: Callable[[bytes], Block | None],
    by_rows: Callable[[bytes, Nanoseconds | None], Iterator[Row]],
    columns: Mapping[str, Column],
) -> Iterator[Block]:
    """The rows of `text`: of each piece by columns or, if it has none so, by rows, which also count the lines.

    Raises RecordingError, after the rows before the mistake.
    """
    time = None
    with Ahead(text, by_columns) as pieces:
        while found := pieces.next():
            piece, block = found
            if block is None or not _follows(block, time):
                pieces.go_back()
                blocks = blocks_of(by_rows(piece, time), columns)
            else:
                text.line += lines_in(piece)
                blocks = iter((block,))
            for block in blocks:
                time = int(block.times[-1]) if len(block.times) else time
                yield block


def _follows(block: Block, previous: Nanoseconds | None) -> bool:
    """Whether the times in `block` are in order, and after the time `previous`."""
    try:
        check_order(block.times, previous)
    except OddError:
        return False
    return True


def lines_in(piece: bytes) -> int:
    """How many line ends there are, counted faster than by `bytes.count`."""
    return int(np.count_nonzero(np.frombuffer(piece, np.uint8) == ord("\n")))
