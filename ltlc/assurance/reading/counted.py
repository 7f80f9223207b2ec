"""What a step counts: what occurs is noted with its time, and when as many times are over."""

from __future__ import annotations

from typing import NamedTuple

from ltlc.assurance.reading.trees import (
    NEVER,
    TIME,
    VERDICT,
    Ago,
    Apply,
    Assign,
    Attribute,
    Block,
    Constant,
    If,
    NotUnderstoodError,
    Push,
    Statement,
    Tree,
)
from ltlc.semantics.verdicts import Verdict

IS_FIRST = Apply("==", (VERDICT, Constant(Verdict.NOT_STARTED)))
"""A step is the first one."""


class Counted(NamedTuple):
    """A clock, by its attribute, that is due when the first of `times` occurrences of `condition` is over.

    The times are in the attribute `history`; what `begins` has whether the condition held in the attribute `held`.
    """

    clock: str
    condition: Tree
    held: str | None
    history: str
    times: int
    duration: int | None


def presumed(statement: Statement) -> tuple[str, int] | None:
    """The clock that is due so much later than the first step, if `statement` says that."""
    match statement:
        case If(guard, (Assign(Attribute(clock), Apply("+", (time, Constant(int(duration))))),), ()):
            return (clock, duration) if guard == IS_FIRST and time == TIME else None
        case _:
            return None


def counted(statement: Statement) -> Counted | None:
    """What `statement` counts, if it does. Raises NotUnderstoodError if it does so in another way."""
    match statement:
        case If(condition, (Push(history, time), _) as noted, ()) if time == TIME:
            return _noted(condition, None, history, noted)
        case If(
            condition,
            (If(Apply("not", (Attribute(held),)), (Assign(Attribute(same), Constant(True)), *noted), ()),),
            (Assign(Attribute(lost), Constant(False)),),
        ) if held == same == lost:
            match noted:
                case [Push(history, time), _] if time == TIME:
                    return _noted(condition, held, history, tuple(noted))
                case _:
                    pass
    return None


def _noted(condition: Tree, held: str | None, history: str, noted: Block) -> Counted:
    match noted[1]:
        case If(
            Apply("==", (Apply("len", (Attribute(same),)), Constant(int(times)))), (Assign(Attribute(clock), over),), ()
        ) if same == history:
            return Counted(clock, condition, held, history, times, _duration(history, times, over))
        case _:
            raise NotUnderstoodError(f"`{history}` is not as long as the count")


def _duration(history: str, times: int, over: Tree) -> int | None:
    match over:
        case Apply("+", (Ago(same, before), Constant(int(duration)))) if (same, before) == (history, times - 1):
            return duration
        case _ if over == NEVER:
            return None
        case _:
            raise NotUnderstoodError(f"what is counted in `{history}` is over at another time")
