"""The meaning of the property language on finite words, read off `docs/language.md` clause by clause.

The reference for the whole compiler. Coq: `satisfies` in `proofs/Properties.v`.

The scope keywords have more than one published reading. `EPISODE` is the language's own; the others say on words what
the other encodings say in core LTL (`docs/language.md`), so that each encoding has something to be checked against.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import assert_never

from ltlc.dataclass import dataclass
from ltlc.semantics import finite, ltl
from ltlc.semantics.diagrams import Diagrams, of_predicate
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.instants import Instant
from ltlc.semantics.ltl import Atom, Formula
from ltlc.semantics.properties import (
    After,
    AfterUntil,
    Always,
    And,
    Eventually,
    Implies,
    Never,
    Not,
    Now,
    Or,
    Property,
    Throughout,
    Until,
    Within,
    children,
)
from ltlc.semantics.timed_atoms import News, timed_atoms
from ltlc.semantics.words import Letter, Word

Judgement = Callable[[Word], bool]
"""Whether the body of a scope holds on a word."""


@dataclass(frozen=True, slots=True)
class Reading:
    """What the three scope keywords mean on a word, given what their body means.

    `bare_body` says whether a state predicate as a body is read at one step, or, as the language has it, throughout.
    """

    name: str
    after: Callable[[Word, Formula, Judgement], bool]
    until: Callable[[Word, Formula, Judgement], bool]
    after_until: Callable[[Word, Formula, Formula, Judgement], bool]
    bare_body: bool = False


def first_step(word: Word, event: Formula, start: int = 0) -> int | None:
    """The first step of `word` from `start` on at which `event` holds, or None."""
    return next((k for k in range(start, len(word)) if finite.holds(event, word[k:])), None)


def part_in_time(word: Word, start: Nanoseconds, end: Nanoseconds) -> Word:
    """The instants of a timed word that are from `start` to `end` later than its first, both included."""
    return tuple(instant for instant in word if start <= _time(instant) - _time(word[0]) <= end)


def _time(letter: Letter) -> Nanoseconds:
    if not isinstance(letter, Instant):
        raise TypeError("a bound is judged on instants, which have times")
    return letter.time


def episodes(word: Word, opening: Formula, closing: Formula) -> list[tuple[int, int]]:
    """The episodes of `after_until opening, closing, …` on `word`, as pairs (first step, step after the last)."""
    found = []
    position = 0
    while position < len(word):
        if not _opens(word, position, opening, closing):
            position += 1
            continue
        end = _end_of_segment(word, position, closing)
        found.append((position, end))
        position = end
    return found


def opened(word: Word, property_: Property) -> int | None:
    """How many episodes open on `word` in the scopes of `property_` that no other encloses; None if it has none.

    Scopes inside `until` do not count. One under `always`, `never` or `eventually` is judged on every rest of the run,
    so each step at which it opens on some rest counts.
    """
    counts = list(_opened(word, property_, [0]))
    return sum(counts) if counts else None


def time_opens(property_: Property) -> bool:
    """Whether an episode in a scope of `property_` can open or close between steps."""
    match property_:
        case After(event, _):
            opens = opens_by_itself(event, None)
        case AfterUntil(opening, closing, _):
            opens = opens_by_itself(opening, closing)
        case _:
            opens = False
    return opens or any(map(time_opens, children(property_)))


def opens_by_itself(opening: Formula, closing: Formula | None) -> bool:
    """Whether an episode can open or close between steps: where the past decides, and where the end of news does.

    So `b` opens the next episode of `after_until b, new d, …` a nanosecond after d has closed one.
    """
    ends = ltl.FALSE if closing is None else closing
    for event in (ltl.And(opening, ltl.Not(ends)), ends):
        timed = timed_atoms(event)
        if not all(isinstance(atom, News) for atom in timed) or (timed and _can_hold_without(timed, event)):
            return True
    return False


def _can_hold_without(news: Sequence[Atom], event: Formula) -> bool:
    diagrams = Diagrams()
    levels = {name: level for level, name in enumerate(ltl.atoms(event))}
    holds = of_predicate(event, diagrams, levels)
    return diagrams.given({levels[each.name]: False for each in news}, holds) != diagrams.false


def _opened(word: Word, property_: Property, starts: Sequence[int]) -> Iterator[int]:
    """For each scope, how many episodes open on the rests of `word` from one of `starts` on."""
    match property_:
        case After(event, _):
            first = (first_step(word, event, start) for start in starts)
            yield len({k for k in first if k is not None})
        case AfterUntil(opening, closing, _):
            yield len({start + k for start in starts for k, _ in episodes(word[start:], opening, closing)})
        case Until():
            return
        case Always() | Never() | Eventually():
            yield from _opened(word, property_.operand, range(len(word)))
        case _:
            for part in children(property_):
                yield from _opened(word, part, starts)


def _opens(word: Word, step: int, opening: Formula, closing: Formula) -> bool:
    return finite.holds(opening, word[step:]) and not finite.holds(closing, word[step:])


def _end_of_segment(word: Word, start: int, closing: Formula) -> int:
    """The first step after `start` at which `closing` holds, or the end of the word."""
    end = first_step(word, closing, start + 1)
    return len(word) if end is None else end


def _episode_after(word: Word, event: Formula, body: Judgement) -> bool:
    k = first_step(word, event)
    return k is None or body(word[k:])


def _episode_until(word: Word, event: Formula, body: Judgement) -> bool:
    k = first_step(word, event)
    return k is not None and body(word[:k])


def _episode_after_until(word: Word, opening: Formula, closing: Formula, body: Judgement) -> bool:
    return all(body(word[k:m]) for k, m in episodes(word, opening, closing))


def _dwyer_after_until(word: Word, opening: Formula, closing: Formula, body: Judgement) -> bool:
    """Every step with the opening and not the closing event opens a scope of its own."""
    starts = (k for k in range(len(word)) if _opens(word, k, opening, closing))
    return all(body(word[k : _end_of_segment(word, k, closing)]) for k in starts)


def _pointwise_after(word: Word, event: Formula, body: Judgement) -> bool:
    """From each step with the event, the body holds on every rest of the run."""
    k = first_step(word, event)
    return k is None or all(body(rest) for rest in _rests(word[k:]))


def _pointwise_until(word: Word, event: Formula, body: Judgement) -> bool:
    """The event comes, and the body holds on the rest of the run from every step before it."""
    k = first_step(word, event)
    return k is not None and all(body(word[i:]) for i in range(k))


def _pointwise_after_until(word: Word, opening: Formula, closing: Formula, body: Judgement) -> bool:
    """From each step that opens, up to the closing event or the end, the body holds on every rest of the run."""
    return all(
        _pointwise_until(rest, closing, body) or all(body(later) for later in _rests(rest))
        for rest in _rests(word)
        if finite.holds(opening, rest)
    )


def _pointwise_strong_after_until(word: Word, opening: Formula, closing: Formula, body: Judgement) -> bool:
    """As `_pointwise_after_until`, but the closing event must come."""
    return all(_pointwise_until(rest, closing, body) for rest in _rests(word) if finite.holds(opening, rest))


EPISODE = Reading("episode", _episode_after, _episode_until, _episode_after_until)
DWYER = Reading("dwyer", _episode_after, _episode_until, _dwyer_after_until)
POINTWISE = Reading("pointwise", _pointwise_after, _pointwise_until, _pointwise_after_until, bare_body=True)
POINTWISE_STRONG = Reading(
    "pointwise-strong", _pointwise_after, _pointwise_until, _pointwise_strong_after_until, bare_body=True
)

READINGS = {reading.name: reading for reading in (EPISODE, POINTWISE, POINTWISE_STRONG, DWYER)}
"""The readings by the name of the encoding that writes them in core LTL."""


def satisfies(word: Word, property_: Property, reading: Reading = EPISODE) -> bool:
    """Whether the finite `word`, possibly empty, satisfies `property_`, scopes read as `reading` has them.

    A property with bounds is judged on a timed word, whose letters are instants; the atoms of the past are in them.
    """
    match property_:
        case Now(predicate):
            return finite.holds(predicate, word)
        case Throughout(predicate):
            return all(finite.holds(predicate, rest) for rest in _rests(word))
        case Not(operand):
            return not satisfies(word, operand, reading)
        case And(left, right):
            return satisfies(word, left, reading) and satisfies(word, right, reading)
        case Or(left, right):
            return satisfies(word, left, reading) or satisfies(word, right, reading)
        case Implies(left, right):
            return satisfies(word, right, reading) or not satisfies(word, left, reading)
        case Always(operand):
            return all(satisfies(rest, operand, reading) for rest in _rests(word))
        case Never(operand):
            return not any(satisfies(rest, operand, reading) for rest in _rests(word))
        case Eventually(operand):
            return any(satisfies(rest, operand, reading) for rest in _rests(word))
        case After(event, body):
            return reading.after(word, event, _judgement(body, reading))
        case Until(event, body):
            return reading.until(word, event, _judgement(body, reading))
        case AfterUntil(opening, closing, body):
            return reading.after_until(word, opening, closing, _judgement(body, reading))
        case Within(duration, body, start):
            return satisfies(part_in_time(word, start, duration), body, reading)
        case _:
            assert_never(property_)


def _judgement(body: Property, reading: Reading) -> Judgement:
    judged = _bare(body) if reading.bare_body else body
    return lambda word: satisfies(word, judged, reading)


def _bare(body: Property) -> Property:
    """`body` with the state predicates among its conjuncts read at one step."""
    match body:
        case Throughout(predicate):
            return Now(predicate)
        case And(left, right):
            return And(_bare(left), _bare(right))
        case _:
            return body


def _rests(word: Word) -> Iterator[Word]:
    """Every non-empty u[k..) of the word u."""
    return (word[k:] for k in range(len(word)))
