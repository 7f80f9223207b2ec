"""Encodings: four ways to write the property language in core LTL; `episode` is what the language means.

`docs/language.md`, Core LTL. Coq: `encode` in `proofs/Encodings.v`, with the theorem `encode_correct` for `episode`;
where the encodings agree and where they do not is proved in `proofs/Agreement.v`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import assert_never

from ltlc.dataclass import dataclass
from ltlc.semantics import ltl
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.intervals import without_intervals
from ltlc.semantics.ltl import Formula, eventually, globally, implies, weak_until
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
    predicates,
)
from ltlc.semantics.timed_atoms import (
    BEGINNING,
    AfterOpened,
    Clock,
    EpisodeOpened,
    FirstOpen,
    LastTrigger,
    UntilScope,
    late,
    timed_atoms,
)


@dataclass(frozen=True, slots=True)
class Encoding:
    """What the three scope keywords are in core LTL; all else has one reading.

    `after(X, Z)`, `until(X, Z)` and `after_until(X, Y, Z)` take the events and the encoded body. `bare_body` says what
    becomes of a state predicate as a body: it stays as it is, or, as the language has it, is read as `always` it.
    `segments` are the keywords whose scope is a segment of the run, judged once: there, a clock counts from its start.
    """

    name: str
    description: str
    after: Callable[[Formula, Formula], Formula]
    until: Callable[[Formula, Formula], Formula]
    after_until: Callable[[Formula, Formula, Formula], Formula]
    bare_body: bool = False
    segments: frozenset[str] = frozenset()


class ManyClocksError(ValueError):
    """`bound` would need any number of clocks: several obligations may be open there that different things settle."""

    def __init__(self, bound: Within) -> None:
        super().__init__("several obligations may be open here that different things settle")
        self.bound = bound


def encode(property_: Property, encoding: Encoding) -> Formula:
    """`property_` in core LTL; with `EPISODE`, a word satisfies the result exactly if it satisfies `property_`.

    A bound becomes an atom, that the `clock` of its place is late, which closes the scope of the bound: so that is a
    word to which these atoms have been added. Raises ManyClocksError for a bound where there is no such clock.
    """
    return _encode(without_intervals(property_), encoding, BEGINNING)


def encode_from(event: Formula, property_: Property, encoding: Encoding) -> Formula:
    """`encode` of `property_` on the rest of the run from the first step with `event` on; true if there is none."""
    whole = without_intervals(After(event, property_))
    assert isinstance(whole, After)
    return _first(event, _encode(whole.body, encoding, AfterOpened(BEGINNING, event)))


def _encode(property_: Property, encoding: Encoding, clock: Clock | None) -> Formula:
    """`property_` in core LTL, where `clock` is that of its place."""
    match property_:
        case Now(predicate):
            return predicate
        case Throughout(predicate):
            return globally(predicate)
        case Not(operand):
            return ltl.Not(_encode(operand, encoding, clock))
        case And(left, right):
            return ltl.And(_encode(left, encoding, clock), _encode(right, encoding, clock))
        case Or(left, right):
            return ltl.Or(_encode(left, encoding, clock), _encode(right, encoding, clock))
        case Implies(left, right):
            return implies(_encode(left, encoding, clock), _encode(right, encoding, clock))
        case Always(operand) if clock is not None:
            return _encode_always(ltl.TRUE, operand, encoding, clock)
        case Always(operand):
            return globally(_encode(operand, encoding, None))
        case Never(operand):
            return globally(ltl.Not(_encode(operand, encoding, None)))
        case Eventually(operand):
            return eventually(_encode(operand, encoding, None))
        case After(event, body):
            inner = clock and "after" in encoding.segments and AfterOpened(clock, event)
            return encoding.after(event, _encode_body(body, encoding, inner or None))
        case Until(event, body):
            inner = clock and "until" in encoding.segments and UntilScope(clock, event)
            return encoding.until(event, _encode_body(body, encoding, inner or None))
        case AfterUntil(opening, closing, body):
            inner = clock and "after_until" in encoding.segments and EpisodeOpened(clock, opening, closing)
            return encoding.after_until(opening, closing, _encode_body(body, encoding, inner or None))
        case Within(duration, body, 0) if clock is not None:
            return relativise(late(opening_of(clock), duration), _encode(body, encoding, clock))
        case Within():
            raise ManyClocksError(property_)
        case _:
            assert_never(property_)


def bounds(property_: Property) -> Iterator[Within]:
    """The parts of `property_` that have a bound on time, outer ones first."""
    if isinstance(property_, Within):
        yield property_
    for child in children(property_):
        yield from bounds(child)


def has_bounds(property_: Property) -> bool:
    """Whether some part of `property_` has a bound on time."""
    return next(bounds(property_), None) is not None


def reads_time(property_: Property) -> bool:
    """Whether what holds can change between steps: by a bound, or by an atom that time decides."""
    return has_bounds(property_) or any(timed_atoms(predicate) for predicate in predicates(property_))


def opening_of(clock: Clock) -> Clock:
    """The clock that has started where the segment that `clock` measures began."""
    return opening_of(clock.outer) if isinstance(clock, UntilScope) else clock


def _encode_always(trigger: Formula, operand: Property, encoding: Encoding, clock: Clock) -> Formula:
    """`always (trigger implies operand)`, whose bounds begin anew at each step with `trigger`; each conjunct by itself.

    Of the obligations of a response the earliest counts, for its goal settles them all; of those of a prevention the
    latest. Coq: `each_always`, `obligation_of`; `distribute_means_the_same`, `response_earliest`, `prevention_latest`.
    """
    match operand:
        case _ if not has_bounds(operand):
            encoded = _encode(operand, encoding, None)
            return globally(encoded if trigger == ltl.TRUE else implies(trigger, encoded))
        case And(left, right):
            sides = (_encode_always(trigger, side, encoding, clock) for side in (left, right))
            return ltl.And(*sides)
        case Implies(Now(predicate), body):
            both = predicate if trigger == ltl.TRUE else ltl.And(trigger, predicate)
            return _encode_always(both, body, encoding, clock)
        case Within(duration, Eventually(Now(goal)), 0):
            obligation = relativise(late(FirstOpen(clock, trigger, goal), duration), eventually(goal))
            return globally(implies(trigger, obligation))
        case Within(duration, Always(Now(kept)) | Throughout(kept), 0):
            return _prevention(trigger, kept, duration, clock)
        case Within(duration, Never(Now(bad)), 0):
            return _prevention(trigger, ltl.Not(bad), duration, clock)
        case _:
            raise ManyClocksError(next(bounds(operand)))


def _prevention(trigger: Formula, kept: Formula, duration: Nanoseconds, clock: Clock) -> Formula:
    return globally(implies(trigger, relativise(late(LastTrigger(clock, trigger), duration), globally(kept))))


def _encode_body(body: Property, encoding: Encoding, clock: Clock | None) -> Formula:
    """The last argument of a scope keyword; its conjuncts are in scope position too."""
    if not encoding.bare_body:
        return _encode(body, encoding, clock)
    match body:
        case Throughout(predicate):
            return predicate
        case And(left, right):
            return ltl.And(_encode_body(left, encoding, clock), _encode_body(right, encoding, clock))
        case _:
            return _encode(body, encoding, clock)


def relativise(end: Formula, formula: Formula) -> Formula:
    """`rel_end(formula)`: `formula` judged on the segment that ends before the next step with `end`, possibly empty.

    Subtrees that `formula` shares are shared in the result: scopes inside scopes would grow eightfold a level.
    Coq: `relativise`, `relativise_correct` in `proofs/Relativise.v`.
    """
    known: dict[int, Formula] = {}

    def within(part: Formula) -> Formula:
        if id(part) not in known:
            known[id(part)] = _relativised(end, part, within)
        return known[id(part)]

    return within(formula)


def _relativised(end: Formula, formula: Formula, within: Callable[[Formula], Formula]) -> Formula:
    """`rel_end(formula)`, where `within` gives that of its parts."""
    match formula:
        case ltl.Truth():
            return formula
        case ltl.Atom():
            return ltl.And(ltl.Not(end), formula)
        case ltl.Not(operand):
            return ltl.Not(within(operand))
        case ltl.And(left, right):
            return ltl.And(within(left), within(right))
        case ltl.Or(left, right):
            return ltl.Or(within(left), within(right))
        case ltl.Next(operand):
            return ltl.And(ltl.Not(end), ltl.Next(ltl.And(ltl.Not(end), within(operand))))
        case ltl.Until(left, right):
            return ltl.Until(ltl.And(ltl.Not(end), within(left)), ltl.And(ltl.Not(end), within(right)))
        case _:
            assert_never(formula)


def _first(event: Formula, body: Formula) -> Formula:
    """If `event` ever holds, `body` holds from its first step on: `!event W (event & body)`."""
    return weak_until(ltl.Not(event), ltl.And(event, body))


def _episode_until(event: Formula, body: Formula) -> Formula:
    return ltl.And(eventually(event), relativise(event, body))


def _episode_after_until(opening: Formula, closing: Formula, body: Formula) -> Formula:
    opens = ltl.And(opening, ltl.Not(closing))
    next_episode = _first(opens, relativise(closing, body))
    return ltl.And(next_episode, globally(implies(closing, next_episode)))


def _dwyer_after_until(opening: Formula, closing: Formula, body: Formula) -> Formula:
    return globally(implies(ltl.And(opening, ltl.Not(closing)), relativise(closing, body)))


def _pointwise_after(event: Formula, body: Formula) -> Formula:
    return globally(implies(event, globally(body)))


def _pointwise_until(event: Formula, body: Formula) -> Formula:
    return ltl.Until(body, event)


EPISODE = Encoding(
    "episode",
    "what the language means: a scope is a segment of the run, judged once",
    _first,
    _episode_until,
    _episode_after_until,
    segments=frozenset({"after", "until", "after_until"}),
)

POINTWISE = Encoding(
    "pointwise",
    "the paper's sentences read literally, with weak until: after_until X, Y, Z is G(X -> (Z W Y))",
    _pointwise_after,
    _pointwise_until,
    lambda opening, closing, body: globally(implies(opening, weak_until(body, closing))),
    bare_body=True,
)

POINTWISE_STRONG = Encoding(
    "pointwise-strong",
    "as pointwise, but the closing event must come: after_until X, Y, Z is G(X -> (Z U Y))",
    _pointwise_after,
    _pointwise_until,
    lambda opening, closing, body: globally(implies(opening, ltl.Until(body, closing))),
    bare_body=True,
)

DWYER = Encoding(
    "dwyer",
    "specification patterns: every step with X and not Y opens a scope of its own",
    _first,
    _episode_until,
    _dwyer_after_until,
    segments=frozenset({"after", "until"}),
)

ENCODINGS = {encoding.name: encoding for encoding in (EPISODE, POINTWISE, POINTWISE_STRONG, DWYER)}
"""The encodings that ltlc knows, by name; the first is the default."""
