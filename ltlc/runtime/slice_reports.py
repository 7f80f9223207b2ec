"""What a run has shown of a property that is judged for each id, as text and data."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from heapq import nsmallest
from typing import TYPE_CHECKING, Any

from ltlc.runtime import reports
from ltlc.runtime.slice_ids import Violation
from ltlc.runtime.slice_keys import Id
from ltlc.runtime.times import NEVER, seconds, seconds_text
from ltlc.runtime.tracking import Moment, Track
from ltlc.semantics.verdicts import Verdict

if TYPE_CHECKING:
    from ltlc.runtime.slice_steps import Slices

MOST = 20
"""How many ids are named in a line, and how many violations shown in full."""


@dataclass(frozen=True, slots=True)
class Owed:
    """Something is owed for an id, and for how long it can wait; None is for ever."""

    id: Id
    since: Moment
    left: int | None
    lacks_beginning: bool


def id_text(id_: Id) -> str:
    """An id as a reader knows it."""
    return reports.printable(str(id_).lower() if isinstance(id_, bool) else str(id_))


def count(slices: Slices) -> int | None:
    """How many ids came; None if that is not known: with a limit, not all are kept."""
    if slices.ids.limit is None:
        return len(slices.ids.seen)
    return None if slices.as_new else slices.ids.births


def owed(slices: Slices, most: int = MOST) -> list[Owed]:
    """What is owed, that which can wait for the shortest time first."""
    now = slices.session.time
    found = []
    for one in slices.ids.slices.values():
        since, deadline = one.track.open_since, None
        if since is None:
            continue
        deadline = one.track.deadline()
        left = None if deadline is None or now is None else deadline - 1 - now
        found.append(Owed(one.id, since, left, one.lacks_beginning))
    return nsmallest(
        most, found, key=lambda each: NEVER if each.left is None else each.left
    )


def since(slices: Slices) -> str:
    """Which ids violated the property, and when; empty if none did."""
    violated = slices.ids.violated
    if not violated:
        return ""
    told = [
        f"{id_text(id_)} at {seconds_text(each.failure.time)} s{_marked(each)}"
        for id_, each in _first(violated.items())
    ]
    came = count(slices)
    number = "" if came is None else f"{len(violated)} of "
    ids = _ids(len(violated) if came is None else came)
    return f" by {number}{ids}: {_listed(told, len(violated))}"


def remarks(slices: Slices) -> list[str]:
    """What else there is to say: what is owed, how many ids came, what was left out."""
    open_ = [
        one for one in slices.ids.slices.values() if one.track.open_since is not None
    ]
    waiting = sum(
        one.counted is Verdict.NOT_STARTED for one in slices.ids.slices.values()
    )
    told = []
    if open_:
        listed = [_owed(each) for each in owed(slices)]
        told.append(f"still open: {_listed(listed, len(open_))}")
    came = count(slices)
    if not slices.ids.violated and came is not None:
        told.append(_ids(came))
    if slices.ids.satisfied:
        told.append(f"{len(slices.ids.satisfied)} satisfied")
    if waiting:
        told.append(f"{waiting} not started")
    told.append(_messages(slices.ids.messages))
    if slices.ids.without_id:
        told.append(f"{_messages(slices.ids.without_id)} without an id")
    if slices.ids.left_out:
        reason = f"of ids beyond the limit of {slices.ids.limit}"
        told.append(f"{_messages(slices.ids.left_out)} {reason} left out")
    return told


def figure(slices: Slices) -> str:
    """What is told of the violations, each with its id."""
    shown = list(_first(slices.ids.violated.items()))
    texts = [_figure(slices.track, slices.cut.variable, *each) for each in shown]
    more = len(slices.ids.violated) - len(shown)
    if more:
        texts.append(f"... and {_ids(more)} more\n")
    return "\n".join(texts)


def document(slices: Slices) -> dict[str, Any]:
    """The ids in the JSON document of `ltlc run`."""
    waiting = sum(
        one.counted is Verdict.NOT_STARTED for one in slices.ids.slices.values()
    )
    came = count(slices)
    return {
        "keys": [key.name for key in slices.cut.keys.values()],
        "ids": came,
        "started": None if came is None else came - waiting,
        "satisfied": len(slices.ids.satisfied),
        "violated": [
            {
                "id": id_,
                "decided_at": reports.failure_report(each.failure),
                "may_lack_beginning": each.lacks_beginning,
            }
            for id_, each in slices.ids.violated.items()
        ],
        "owed": [_owed_report(each) for each in owed(slices)],
        "left_out": slices.ids.left_out,
        "without_id": slices.ids.without_id,
        "messages": slices.ids.messages,
    }


def _figure(track: Track, variable: str, id_: Id, violation: Violation) -> str:
    label = f"{track.property.label}[{variable} = {id_text(id_)}]"
    text = reports.failure_text(replace(track.property, label=label), violation.failure)
    return (
        f"{text}Its beginning may be missing.\n" if violation.lacks_beginning else text
    )


def _first(items: Iterable[tuple[Id, Violation]]) -> Iterable[tuple[Id, Violation]]:
    return (pair for pair, _ in zip(items, range(MOST), strict=False))


def _listed(told: Sequence[str], number: int) -> str:
    more = f" and {number - len(told)} more" if number > len(told) else ""
    return f"{', '.join(told)}{more}"


def _owed(each: Owed) -> str:
    left = "" if each.left is None else f" ({seconds_text(each.left)} s left)"
    lacks = " (its beginning may be missing)" if each.lacks_beginning else ""
    return f"{id_text(each.id)} since {seconds_text(each.since.time)} s{left}{lacks}"


def _owed_report(each: Owed) -> dict[str, Any]:
    return {
        "id": each.id,
        "open_since": reports.moment_report(each.since),
        "left": None if each.left is None else seconds(each.left),
        "left_ns": each.left,
        "may_lack_beginning": each.lacks_beginning,
    }


def _marked(each: Violation) -> str:
    return " (its beginning may be missing)" if each.lacks_beginning else ""


def _ids(number: int) -> str:
    return f"{number} id" if number == 1 else f"{number} ids"


def _messages(number: int) -> str:
    return f"{number} message" if number == 1 else f"{number} messages"
