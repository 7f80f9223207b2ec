"""Messages that never came in: gaps in their numbers, a queue that was full."""

from __future__ import annotations

from collections.abc import Callable, Sequence


class Losses:
    """What is missing on one topic, seen from what came in on it.

    Each publisher numbers its messages. rclpy does not say which of several publishers
    sent one; but each number follows an earlier one, and whichever is assumed, the gaps
    add up to the same in the end.

    What is missing before the first message of a publisher leaves no gap, what one of
    several loses only later. Such doubt remains where the queue may have been full:
    where `depth` messages have come in since it was last empty, or after the first one
    of a publisher some are missing. It was empty if a message arrived after the one
    before it, by its number, was taken.
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

    def before(
        self, number: int | None, arrived: int, taken: int
    ) -> Sequence[int | None]:
        """How many messages are missing before one that is taken; None: perhaps some.

        Both may be, or neither.
        `number` is its publisher's, None if there is none; `arrived` and `taken` are
        times in ns, `arrived` is 0 if the middleware does not know.
        """
        latest = self._latest
        follows = number is None or not latest or number - 1 in latest
        if follows and (arrived > self._taken or not arrived):
            self._waited = 0
            self._is_unsure = False
        self._waited += 1
        self._taken = taken
        if latest and number is not None and latest[-1] == number - 1:
            latest[-1] = number
            missing: int | None = 0
        else:
            missing = self._gap(number)
        known = () if missing == 0 else (missing,)
        was_full = self._waited == self._depth
        is_unsure = was_full and len(self._latest) > 1
        is_unsure |= self._is_unsure and (was_full or not follows)
        return (*known, None) if is_unsure and missing is not None else known

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
