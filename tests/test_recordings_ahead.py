"""Pieces on which other threads work ahead: in order, not too many, and no thread is left over."""

from __future__ import annotations

import random
import struct
import threading
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
from bag_support import ODOMETRY, mcap, odometry

from ltlc.inputs.recordings import open_recording
from ltlc.inputs.recordings.ahead import DEPTH, each_ahead, one_thread
from ltlc.inputs.recordings.bags import mcap as storage
from ltlc.inputs.recordings.bags import merging
from ltlc.inputs.recordings.rows import RecordingError
from ltlc.runtime.times import SECOND
from ltlc.specification.expressions import Field, Signal, ValueType

X = Signal("x", ValueType.NUMBER, Field("/odom", ODOMETRY, ("pose", "pose", "position", "x")))
COUNT = 400


def test_what_is_made_comes_in_the_order_of_the_pieces() -> None:
    gates = [threading.Event() for _ in range(20)]

    def work(number: int) -> int:
        gates[number ^ 1].set()
        gates[number].wait()  # until the other of a pair has begun: the second may end before the first
        return number

    assert list(each_ahead(range(20), work)) == list(range(20))


def test_few_pieces_are_taken_before_they_are_asked_for() -> None:
    taken: list[int] = []

    def pieces() -> Iterator[int]:
        for number in range(1, 100):
            taken.append(number)
            yield number

    with closing(each_ahead(pieces(), str)) as made:
        for number in range(1, 50):
            assert next(made) == str(number)
            assert len(taken) < number + DEPTH


def test_a_fault_comes_after_what_was_made_of_the_pieces_before_it() -> None:
    made = each_ahead([1, 2, 0, 3], lambda number: 6 // number)
    assert [next(made), next(made)] == [6, 3]
    with pytest.raises(ZeroDivisionError):
        next(made)


def test_within_one_thread_no_other_is_started() -> None:
    with one_thread():
        assert list(each_ahead(range(3), lambda _: threading.current_thread())) == [threading.current_thread()] * 3
    assert threading.current_thread() not in each_ahead(range(3), lambda _: threading.current_thread())


def packed(path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A bag of many chunks, each of which is read by itself, and gives a block."""
    monkeypatch.setattr(storage, "ENOUGH", 500)
    monkeypatch.setattr(merging, "ENOUGH", 1)
    sent = [odometry(number * SECOND // 100, pose__pose__position__x=random.random()) for number in range(COUNT)]
    return mcap(path, sent, "ZSTD", chunk_size=2000)


def test_no_thread_is_left_when_a_bag_is_put_down(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = threading.active_count()
    blocks = open_recording(packed(tmp_path / "a.mcap", monkeypatch), {"x": X}).blocks()
    next(blocks)
    assert threading.active_count() > before
    del blocks
    assert threading.active_count() == before


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.9])
def test_all_before_a_damaged_chunk_is_read(tmp_path: Path, share: float, monkeypatch: pytest.MonkeyPatch) -> None:
    path = packed(tmp_path / "a.mcap", monkeypatch)
    data = bytearray(path.read_bytes())
    recording = open_recording(path, {"x": X})
    starts = [place for place in range(len(data) - 9) if data[place] == 6 and is_chunk(data, place)]
    chunk = starts[int(share * len(starts))]
    data[chunk + 9 + 24] ^= 1  # its checksum
    path.write_bytes(data)
    (first,) = struct.unpack_from("<Q", data, chunk + 9)
    times: list[int] = []
    before = threading.active_count()
    with pytest.raises(RecordingError, match=f"the chunk at byte {chunk} has the wrong checksum"):
        times.extend(time for block in recording.blocks() for time in block.times.tolist())
    assert threading.active_count() == before
    assert times == list(range(0, first, SECOND // 100))


def is_chunk(data: bytearray, place: int) -> bool:
    """Whether a chunk's record begins there: its compression follows its head."""
    return data[place + 9 + 32 : place + 9 + 36] == b"zstd"
