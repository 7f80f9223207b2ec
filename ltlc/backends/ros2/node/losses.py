"""Messages that never came in: gaps in their numbers, a queue that was full."""

from __future__ import annotations

from collections.abc import Callable


class Losses:
    """What is missing on one topic, seen from what came in on it.

    Each publisher numbers its messages. Which of several publishers a message is from,
    rclpy does not tell; but each number follows an earlier one, and whichever is taken
    for it, the gaps add up to the same in the end.

    What is missing before the first message of a publisher leaves no gap, what one of
    several loses only later. Such doubt remains where the queue may have been full:
    where `depth` messages have come in since it was last empty, as it was if a message
    arrived after the one before was taken.
    """

    def __init__(self, depth: int, publishers: Callable[[], frozenset[str]]) -> None:
        """`publishers` finds out which publishers the topic has now."""
        self._depth = depth
        self._publishers = publishers
        self._known: frozenset[str] = frozenset()
        self._latest: list[int] = []
        self._taken = 0
        self._waited = 0
        self._is_unsure = False

    @property
    def are_numbered(self) -> bool:
        """Whether the messages that came in have numbers."""
        return bool(self._latest)

    def before(self, number: int | None, arrived: int, taken: int) -> int | None:
        """How many messages are missing before one that is taken; None: perhaps some.

        `number` is its publisher's, None if there is none; `arrived` and `taken` are
        times in ns, `arrived` is 0 if the middleware does not know.
        """
        if arrived > self._taken or not arrived:
            self._waited = 0
            self._is_unsure = False
        self._waited += 1
        self._taken = taken
        latest = self._latest
        if latest and number is not None and latest[-1] == number - 1:
            latest[-1] = number
            missing: int | None = 0
        else:
            missing = self._gap(number)
        is_unsure = self._is_unsure or len(latest) > 1
        if is_unsure and self._waited == self._depth:
            return missing or None
        return missing

    def _gap(self, number: int | None) -> int | None:
        latest = self._latest
        if number is None:
            self._is_unsure = True
            return 0
        if number - 1 in latest:
            latest.remove(number - 1)
            latest.append(number)
            return 0
        publishers = self._publishers()
        earlier = max((n for n in latest if n < number), default=None)
        if earlier is None:
            self._is_unsure |= number > 1
        elif publishers <= self._known and len(publishers) <= len(latest):
            latest.remove(earlier)
            latest.append(number)
            return number - earlier - 1
        self._known |= publishers
        self._latest = [*latest, number][-max(1, len(publishers)) :]
        return 0 if earlier is None else None
