"""The property language over atoms, after parsing and typing: what `denotation` and `encodings` give meaning to.

Every truth condition is that of `docs/language.md`: a property is judged on a word, a run or a segment of one, possibly
empty; u[k..) is the rest of the word u from its step k, u[i..m) the segment before m.
"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.dataclass import dataclass
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.ltl import TRUE, Formula, is_propositional
from ltlc.semantics.ltl import atoms as formula_atoms


@dataclass(frozen=True, slots=True)
class Now:
    """A state predicate read at the current step: `predicate`, a propositional formula, holds at the first step of u.

    On the empty word its atoms are false.
    """

    predicate: Formula

    def __post_init__(self) -> None:
        _check_predicate(self.predicate)


@dataclass(frozen=True, slots=True)
class Throughout:
    """A state predicate in scope position, where it means `always` it: `predicate` holds at every step of u.

    True on the empty word. It is kept apart from `Always(Now(…))`, which the author wrote out: the pointwise encodings
    read a bare predicate differently.
    """

    predicate: Formula

    def __post_init__(self) -> None:
        _check_predicate(self.predicate)


@dataclass(frozen=True, slots=True)
class Not:
    """`not P`: P does not hold on u."""

    operand: Property


@dataclass(frozen=True, slots=True)
class And:
    """`P and Q`: both hold on u."""

    left: Property
    right: Property


@dataclass(frozen=True, slots=True)
class Or:
    """`P or Q`: at least one holds on u."""

    left: Property
    right: Property


@dataclass(frozen=True, slots=True)
class Implies:
    """`P implies Q`: Q holds on u or P does not."""

    left: Property
    right: Property


@dataclass(frozen=True, slots=True)
class Always:
    """`always P`: P holds on every non-empty u[k..); true on the empty word."""

    operand: Property


@dataclass(frozen=True, slots=True)
class Never:
    """`never P`: P holds on no non-empty u[k..); true on the empty word."""

    operand: Property


@dataclass(frozen=True, slots=True)
class Eventually:
    """`eventually P`: P holds on some non-empty u[k..); false on the empty word."""

    operand: Property


@dataclass(frozen=True, slots=True)
class After:
    """`after X, P`: if X holds at some step of u, first at k, then P holds on u[k..); true if X never holds."""

    event: Formula
    body: Property

    def __post_init__(self) -> None:
        _check_predicate(self.event)


@dataclass(frozen=True, slots=True)
class Until:
    """`until X, P`: X holds at some step of u, first at k, and P holds on u[0..k), which is empty when k = 0.

    False on a word, the empty one included, where X never holds.
    """

    event: Formula
    body: Property

    def __post_init__(self) -> None:
        _check_predicate(self.event)


@dataclass(frozen=True, slots=True)
class AfterUntil:
    """`after_until X, Y, P`: P holds on every episode of u; true if there is none.

    The first episode opens at the first step k with X and not Y; it is u[k..m) up to the first later step m with Y, or
    u[k..) if there is none. The next opens at the first step from m on with X and not Y, and so on.
    """

    opening: Formula
    closing: Formula
    body: Property

    def __post_init__(self) -> None:
        _check_predicate(self.opening)
        _check_predicate(self.closing)


@dataclass(frozen=True, slots=True)
class Within:
    """`within D, P`: P holds on the part of u whose instants are at most `duration` later than its first.

    With `start`, `within [A, B], P`: on the instants of that part that are at least `start` later than the first. The
    part is empty if u has no such instants. `start` is at least 0, and less than `duration`.
    """

    duration: Nanoseconds
    body: Property
    start: Nanoseconds = 0

    def __post_init__(self) -> None:
        if not 0 <= self.start < self.duration:
            raise ValueError(f"an interval from {self.start} to {self.duration} ns")


Property = (
    Now | Throughout | Not | And | Or | Implies | Always | Never | Eventually | After | Until | AfterUntil | Within
)
"""A property over atoms; equal properties are the same tree."""


def _check_predicate(predicate: Formula) -> None:
    if not is_propositional(predicate):
        raise ValueError(f"not a state predicate: {predicate}")


def children(property_: Property) -> tuple[Property, ...]:
    """The immediate parts that are properties, left to right; events and state predicates are formulas."""
    match property_:
        case Not(operand) | Always(operand) | Never(operand) | Eventually(operand):
            return (operand,)
        case And(left, right) | Or(left, right) | Implies(left, right):
            return (left, right)
        case After(_, body) | Until(_, body) | AfterUntil(_, _, body) | Within(_, body, _):
            return (body,)
        case _:
            return ()


def predicates(property_: Property) -> Iterator[Formula]:
    """Every state predicate and event of `property_`, in the order of the text."""
    match property_:
        case Now(predicate) | Throughout(predicate):
            yield predicate
        case After(event, _) | Until(event, _):
            yield event
        case AfterUntil(opening, closing, _):
            yield opening
            yield closing
        case _:
            pass
    for child in children(property_):
        yield from predicates(child)


def atoms(property_: Property) -> tuple[str, ...]:
    """The names of the atoms of `property_`, each once, in the order of first use."""
    return tuple(dict.fromkeys(name for p in predicates(property_) for name in formula_atoms(p)))


SOME_STEP = Eventually(Now(TRUE))
"""There is a step: false on the empty word. `initially not p` says so besides where its segment may be empty."""
