"""Pieces of a recording that are worked on in other threads, some pieces ahead of the consumer."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from functools import partial
from typing import TYPE_CHECKING, Generic, TypeVar

import numpy as np

from ltlc.inputs.recordings.arrow import OddError, check_order
from ltlc.inputs.recordings.blocks import Block, blocks_of
from ltlc.inputs.recordings.rows import Column, RecordingError, Row
from ltlc.inputs.recordings.text import Text
from ltlc.semantics.durations import Nanoseconds

if TYPE_CHECKING:
    from concurrent.futures import Future, ThreadPoolExecutor

Piece = TypeVar("Piece")
Made = TypeVar("Made")

THREADS, DEPTH = 2, 4
"""How many pieces are worked on at once, and how many are held: those that wait to be taken, too."""

_HAS_THREADS = ContextVar("has_threads", default=True)


@contextmanager
def one_thread() -> Iterator[None]:
    """Recordings are read in this thread alone meanwhile: others are read side by side with it, in other processes."""
    before = _HAS_THREADS.set(False)
    try:
        yield
    finally:
        _HAS_THREADS.reset(before)


class Ahead(Generic[Piece, Made]):
    """The pieces that `take` gives, up to None, each with what `work` makes of it; a context that ends its threads.

    It has none without `has_threads`, and within `one_thread`: then it works on a piece once that is to be taken.
    """

    def __init__(
        self, take: Callable[[], Piece | None], work: Callable[[Piece], Made], has_threads: bool = True
    ) -> None:
        self._take = take
        self._work = work
        self._pool: ThreadPoolExecutor | None = None
        if has_threads and _HAS_THREADS.get():
            from concurrent.futures import ThreadPoolExecutor  # is loaded for long recordings only

            self._pool = ThreadPoolExecutor(THREADS)
        self._pieces: deque[tuple[Piece, Future[Made]]] = deque()

    def __enter__(self) -> Ahead[Piece, Made]:
        return self

    def __exit__(self, *_: object) -> None:
        if self._pool is not None:
            self._pool.shutdown(cancel_futures=True)

    def next(self) -> tuple[Piece, Made] | None:
        """The next piece; None when all have been taken. Raises RecordingError, after what could be read before it."""
        if self._pool is None:
            taken = self._take()
            return None if taken is None else (taken, self._work(taken))
        while len(self._pieces) < DEPTH:
            try:
                piece = self._take()
            except RecordingError:
                if self._pieces:
                    break
                raise
            if piece is None:
                break
            self._pieces.append((piece, self._pool.submit(self._work, piece)))
        if not self._pieces:
            return None
        piece, made = self._pieces.popleft()
        return piece, made.result()

    def given_back(self) -> Iterator[Piece]:
        """The pieces that were not taken, the last one first: work on them is given up."""
        while self._pieces:
            piece, made = self._pieces.pop()
            made.cancel()
            yield piece


def each_ahead(
    pieces: Iterable[Piece], work: Callable[[Piece], Made], has_threads: bool = True
) -> Generator[Made, None, None]:
    """What `work` makes of each of the pieces, in their order."""
    with Ahead(partial(next, iter(pieces), None), work, has_threads) as ahead:
        while found := ahead.next():
            _, made = found
            yield made


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
    with Ahead(lambda: text.piece() or None, by_columns) as pieces:
        while found := pieces.next():
            piece, block = found
            if block is None or not _follows(block, time):
                for untaken in pieces.given_back():  # for lines may be put back that come before them
                    text.put_back(untaken)
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
