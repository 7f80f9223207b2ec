"""What the node says is missing on a topic, against a queue and publishers of which all is known."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

from hypothesis import given
from hypothesis import strategies as st

from ltlc.backends.ros2.node.losses import Losses

DEPTH = 5


def losses(publishers: int = 1) -> Losses:
    return Losses(DEPTH, lambda: frozenset(map(str, range(publishers))))


def judged(queue: Sequence[tuple[int | None, int, int]]) -> list[Sequence[int | None]]:
    """What is missing before each message: its number, when it arrived, when it was taken."""
    found = losses()
    return [found.before(*message) for message in queue]


def known(missing: Sequence[int | None]) -> int:
    """How many messages are known to be missing."""
    return sum(count or 0 for count in missing)


@given(st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)), max_size=30))
def test_what_one_publisher_loses_after_its_first_message_is_counted(turns: list[tuple[int, int]]) -> None:
    """In each turn some messages come into the queue, which drops the oldest, and some are taken from it."""
    queue: deque[tuple[int, int]] = deque(maxlen=DEPTH)
    found, number, time, taken, missing = losses(), 1, 1, 1, 0
    found.before(1, 1, 1)
    for arriving, leaving in turns:
        for _ in range(arriving):
            number, time = number + 1, time + 1
            queue.append((number, time))
        for _ in range(min(leaving, len(queue))):
            time += 1
            before = found.before(*queue.popleft(), time)
            assert None not in before
            taken, missing = taken + 1, missing + known(before)
    for message in queue:
        taken, missing = taken + 1, missing + known(found.before(*message, time))
    assert taken + missing == number


@given(st.lists(st.tuples(st.integers(0, 2), st.booleans()), max_size=40))
def test_what_several_publishers_lose_is_noticed_in_the_end(sent: list[tuple[int, bool]]) -> None:
    found, numbers, dropped, missing = losses(3), [0, 0, 0], 0, 0
    everything = [*((each, True) for each in range(3)), *sent, *((each, True) for each in (0, 1, 2) * 4)]
    for time, (publisher, arrives) in enumerate(everything, 1):
        numbers[publisher] += 1
        if not arrives:
            dropped += 1
            continue
        missing += known(found.before(numbers[publisher], 2 * time, 2 * time + 1))
    assert missing == dropped


def test_a_full_queue_before_the_first_message_is_a_reason_to_doubt() -> None:
    full = [(100 + n, 1, 10 + n) for n in range(DEPTH)]
    assert judged(full) == [(), (), (), (), (None,)]
    assert judged(full[:-1]) == [()] * 4
    assert judged([*full[:-1], (104, 14, 15), (105, 14, 16)]) == [()] * 6


def test_the_first_message_of_all_has_none_before_it() -> None:
    assert judged([(1 + n, 1, 10 + n) for n in range(2 * DEPTH)]) == [()] * 2 * DEPTH


def test_without_numbers_every_full_queue_is_a_reason_to_doubt() -> None:
    assert judged([(None, 1, 10 + n) for n in range(DEPTH)])[-1] == (None,)
    assert judged([(None, 10 * n, 10 * n + 1) for n in range(1, 2 * DEPTH)]) == [()] * (2 * DEPTH - 1)


def test_without_stamps_nothing_is_said_of_the_queue() -> None:
    assert judged([(None, 0, 10 + n) for n in range(DEPTH)]) == [()] * DEPTH


def test_a_gap_that_may_be_the_start_of_another_publisher_is_a_reason_to_doubt() -> None:
    found = losses(2)
    assert [found.before(n, n, n) for n in (1, 2, 9, 10)] == [(), (), (None,), ()]


def test_a_publisher_that_starts_anew_loses_nothing() -> None:
    now = ["a"]
    found = Losses(DEPTH, lambda: frozenset(now))
    assert [found.before(n, n, n) for n in (1, 2, 3)] == [()] * 3
    now[0] = "b"
    assert [found.before(n, 10 + n, 10 + n) for n in (1, 2, 3, 5)] == [(), (), (), (1,)]


def test_a_full_queue_of_several_publishers_is_a_reason_to_doubt() -> None:
    found = losses(2)
    assert [found.before(number, 1, 10) for number in (1, 1, 2, 2, 3)] == [(), (), (), (), (None,)]


def test_a_gap_in_a_full_queue_that_hides_more_is_counted_and_a_reason_to_doubt() -> None:
    numbers = [100, 101, 102, 103, 109]
    assert judged([(n, 1, 10) for n in numbers])[-1] == (5, None)


@given(st.integers(1, 9), st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)), min_size=1, max_size=30))
def test_what_is_not_counted_of_one_publisher_is_a_reason_to_doubt(start: int, turns: list[tuple[int, int]]) -> None:
    """As above, but the first messages may be lost, or the publisher may have begun before the node."""
    queue: deque[tuple[int, int]] = deque(maxlen=DEPTH)
    found, number, time, taken = losses(), start - 1, 1, 0
    missing: list[int | None] = []
    for arriving, leaving in [*turns, (0, DEPTH)]:
        for _ in range(arriving):
            number, time = number + 1, time + 1
            queue.append((number, time))
        for _ in range(min(leaving, len(queue))):
            time += 1
            missing += found.before(*queue.popleft(), time)
            taken += 1
    is_all = taken + known(missing) == number - start + 1
    assert is_all or None in missing
