"""What reading back can end with, and how two things that an instant leaves behind are compared."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from ltlc.assurance.reading.execution import Left
from ltlc.assurance.reading.language import Apply, Constant, Term
from ltlc.assurance.reading.text import text
from ltlc.assurance.reading.truths import bare, tight
from ltlc.semantics.words import Letter


@dataclass(frozen=True, slots=True)
class ReadBack:
    """The text does what the monitor does, in all `situations`: its states, each with where its clocks can be."""

    situations: int


@dataclass(frozen=True, slots=True)
class Difference:
    """What the text does otherwise or, where that cannot be told, what in it is not understood.

    `state` is that of the class, None if it is about all of it; `letter` what holds there, None if it is so whatever
    holds; `by_time`: at a clock step.
    """

    reason: str
    state: int | None = None
    letter: Letter | None = None
    by_time: bool = False

    def __str__(self) -> str:
        if self.state is None:
            return self.reason
        held = " and ".join(f"`{atom}`" for atom in sorted(self.letter or ())) or "none of the conditions"
        verb = "holds" if len(self.letter or ()) < 2 else "hold"
        instant = " at a clock step" if self.by_time else ""
        where = "" if self.letter is None else f" where {held} {verb}"
        return f"in state {self.state}{instant}{where}, {self.reason}"


class Written(Protocol):
    """What is written of a property in emitted files."""

    def read_back(self) -> ReadBack | Difference:
        """Compare the text with the certified monitor."""


class DiffersError(Exception):
    """What the text does is not what it should; the message says both."""


def left_by(found: Hashable) -> dict[str, Term]:
    """The attributes after an instant. Raises DiffersError if a clock step comes before it."""
    if not isinstance(found, Left):
        raise DiffersError("a clock step is taken that is not due")
    return dict(found.attributes)


def state_in(attributes: Mapping[str, Term]) -> int:
    """The number of the state. Raises DiffersError if there is none."""
    match attributes.get("state"):
        case Constant(int(value)) if not isinstance(value, bool):
            return value
    raise DiffersError("`state` is no number")


def require_equal(found: Mapping[str, Term], right: Mapping[str, Term]) -> None:
    """Raises DiffersError if some attribute is not what it should be."""
    for name in sorted({*found, *right}):
        if _plain(found.get(name)) != _plain(right.get(name)):
            has, wants = (text(each[name]) if name in each else "not set" for each in (found, right))
            raise DiffersError(f"`{name}` is {has} instead of {wants}")


def _plain(term: Term | None) -> Term | None:
    """A term, or what is added to a history, whether or not it has been made a double."""
    match term:
        case Apply("pushed", (value,)):
            return Apply("pushed", (bare(value),))
        case _:
            return None if term is None else tight(term)


def require_verdict_answered(found: Any) -> None:
    """Raises DiffersError if a step does not answer with the verdict."""
    if found.returned != left_by(found)["verdict"]:
        raise DiffersError("what it answers is not the verdict")
