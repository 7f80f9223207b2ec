"""Runs in time: steps with their times, and the instants that the language judges (`docs/language.md`, Time).

What has a value keeps it: between two steps, and after the last one, the letter is held, without its news. The instants
of a run are its steps and every nanosecond at which a letter is held, up to and including the time of the next step, at
which the held instant comes first.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Collection, Iterable, Sequence
from functools import partial
from typing import Any, NamedTuple

from ltlc.semantics import finite
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.ltl import Formula
from ltlc.semantics.timed_atoms import Age, Historically, News, Occurred, Once, PastAtom, Previously, Since
from ltlc.semantics.words import Letter


class Instant(frozenset[str]):
    """A letter at a time; a word of instants is a timed word. `by_time` says that it is no step: a letter is held."""

    time: Nanoseconds
    by_time: bool

    def __new__(cls, time: Nanoseconds, letter: Iterable[str], *, by_time: bool = False) -> Instant:
        """The instant at `time` at which the atoms of `letter` hold."""
        instant = super().__new__(cls, letter)
        instant.time = time
        instant.by_time = by_time
        return instant

    def __reduce__(self) -> tuple[Any, ...]:
        """How it is taken from one process to another."""
        return partial(Instant, by_time=self.by_time), (self.time, frozenset(self))


class Step(NamedTuple):
    """A step of a run: the atoms that hold from then on, and those that are news then."""

    time: Nanoseconds
    letter: Letter


class Observation(NamedTuple):
    """What has been seen of a run up to a time `until`, in a session that began at `session`."""

    steps: tuple[Step, ...]
    until: Nanoseconds
    session: Nanoseconds


def instants(
    steps: Sequence[Step],
    until: Nanoseconds,
    news: Iterable[News] = (),
    among: Collection[Nanoseconds] | None = None,
) -> tuple[Instant, ...]:
    """The instants of the run of `steps`, times not decreasing, that has been looked at up to `until`.

    With `among`, held instants at other times are omitted.
    """
    pulses = frozenset(each.name for each in news)
    ends = [step.time for step in steps[1:]] + [until]
    held = None if among is None else sorted(among)
    return tuple(
        instant
        for (time, letter), end in zip(steps, ends, strict=True)
        for instant in (
            Instant(time, letter),
            *(Instant(later, letter - pulses) for later in _between(time + 1, end + 1, held)),
        )
    )


def _between(start: Nanoseconds, end: Nanoseconds, among: list[Nanoseconds] | None) -> Sequence[Nanoseconds]:
    return range(start, end) if among is None else among[bisect_left(among, start) : bisect_left(among, end)]


def with_past(
    word: tuple[Instant, ...], atoms: Iterable[PastAtom], session: Nanoseconds | None = None
) -> tuple[Instant, ...]:
    """`word` with each of `atoms` added where it holds, an atom after those that decide it.

    The session began at `session`, by default at the first instant.
    """
    for atom in atoms:
        at = _once_each(word)
        held = [holds_at(atom, word, n, session, at) for n in range(len(word))]
        word = tuple(
            Instant(instant.time, instant | {atom.name}) if now else instant
            for instant, now in zip(word, held, strict=True)
        )
    return word


At = Callable[[Formula, int], bool]
"""Whether a state predicate holds at an instant of a word."""


def _once_each(word: tuple[Instant, ...]) -> At:
    """Looks at each instant of `word` once for each predicate: definitions ask again and again."""
    known: dict[tuple[int, int], bool] = {}

    def at(predicate: Formula, k: int) -> bool:
        if (id(predicate), k) not in known:
            known[id(predicate), k] = finite.holds(predicate, word[k : k + 1])
        return known[id(predicate), k]

    return at


def holds_at(atom: PastAtom, word: tuple[Instant, ...], n: int, session: Nanoseconds | None, at: At) -> bool:
    """Whether `atom` holds at the instant n of `word`, which `at` describes: its definition."""

    def ago(k: int) -> Nanoseconds:
        return word[n].time - word[k].time

    match atom:
        case Previously(_, operand):
            return n > 0 and at(operand, n - 1)
        case Once(_, operand, within):
            return any(at(operand, k) for k in range(n + 1) if within is None or ago(k) <= within)
        case Historically(_, operand, None):
            return all(at(operand, k) for k in range(n + 1))
        case Historically(_, operand, int(lasting)):
            return any(ago(k) >= lasting and all(at(operand, j) for j in range(k, n + 1)) for k in range(n + 1))
        case Since(_, kept, start, within):
            return any(
                at(start, k) and all(at(kept, j) for j in range(k + 1, n + 1))
                for k in range(n + 1)
                if within is None or ago(k) <= within
            )
        case Age(_, news, most):
            arrivals = [word[k].time for k in range(n + 1) if at(news, k)]
            began = word[0].time if session is None else session
            return word[n].time - (arrivals[-1] if arrivals else began) <= most
        case Occurred(_, operand, times, within, begins, presumed):
            recent = [k for k in range(n + 1) if within is None or ago(k) <= within]
            occurred = (k for k in recent if at(operand, k) and not (begins and k > 0 and at(operand, k - 1)))
            return sum(1 for _ in occurred) >= times or (presumed and 0 in recent)
        case _:
            raise TypeError(f"not an atom of the past: {atom!r}")
