"""What a run has shown of a property that is judged for each id, as text and data."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from heapq import nsmallest
from itertools import islice
from typing import Any

from ltlc.runtime.episodes import latest
from ltlc.runtime.properties import Moment, Opening
from ltlc.runtime.reports import (
    failure_report,
    failure_text,
    json_value,
    moment_report,
    printable,
)
from ltlc.runtime.session import Session
from ltlc.runtime.slice_ids import Ids, Violation
from ltlc.runtime.slice_keys import Cut, Id
from ltlc.runtime.times import NEVER, seconds, seconds_text
from ltlc.runtime.tracking import Track
from ltlc.semantics.verdicts import Verdict

MOST = 20
"""How many ids are named in a line, and how many violations shown in full."""


@dataclass(frozen=True, slots=True)
class Owed:
    """Something is owed for an id, and for how long it can wait; None is for ever.

    Of an instance, `opened` has its message first.
    """

    id: Id
    opened: tuple[Opening, ...]
    since: Moment
    left: int | None
    lacks_beginning: bool


def id_text(id_: Id) -> str:
    """An id as a reader knows it."""
    return printable(str(id_).lower() if isinstance(id_, bool) else str(id_))


class ToldSlices:
    """The slices of a `track` in a `session`, and what there is to tell of them.

    `cut` says what slices it, `ids` has what is known of each; in one of the states
    `as_new` an id is forgotten.
    """

    def __init__(
        self,
        track: Track,
        session: Session,
        cut: Cut,
        ids: Ids,
        as_new: frozenset[int],
    ) -> None:
        self.track = track
        self.session = session
        self.cut = cut
        self.ids = ids
        self.as_new = as_new
        self._told = 0

    def topics(self) -> frozenset[str]:
        """Those that are read: what slices, and what the property reads of a slice."""
        return self.cut.read

    def news(self) -> frozenset[str]:
        """The topics of which the property wants to know that a message came."""
        return self.cut.window.topics & self.cut.read

    def _came(self) -> int | None:
        """How many ids came; None if a limit and forgetting leave that unknown."""
        if self.ids.limit is None:
            return self.ids.came
        return None if self.as_new else self.ids.births

    def owed(self) -> list[Owed]:
        """What is owed, that which can wait for the shortest time first."""
        now = self.session.time
        found = []
        for one in self.ids.slices.values():
            since, deadline = one.track.open_since, None
            if since is None:
                continue
            deadline = one.track.deadline()
            left = None if deadline is None or now is None else deadline - 1 - now
            opened = latest(one.track.scopes)
            found.append(Owed(one.id, opened, since, left, one.lacks_beginning))
        return nsmallest(
            MOST, found, key=lambda each: NEVER if each.left is None else each.left
        )

    def since(self) -> str:
        """Which ids violated the property, and when; empty if none did."""
        violated = self.ids.violated
        if not violated:
            return ""
        told = [
            f"{id_text(id_)} at {seconds_text(each.failure.time)} s{_marked(each)}"
            for id_, each in first_shown(violated.items())
        ]
        came = self._came()
        number = "" if came is None else f"{len(violated)} of "
        ids = _ids(len(violated) if came is None else came)
        return f" by {number}{ids}: {listed_text(told, len(violated))}"

    def untold(self) -> Iterator[tuple[str, str]]:
        """What there is to tell of each violation that was not told, also as JSON."""
        violated = self.ids.violated
        while self._told < len(violated):
            told = [*islice(violated.items(), self._told, None)]
            self._told += len(told)
            for id_, each in told:
                yield self._figure(id_, each), json.dumps(self._line(id_, each))

    def listed(self) -> dict[str, str]:
        """The ids that violate the property, and those for which something is owed."""
        violated = [id_text(id_) for id_, _ in first_shown(self.ids.violated.items())]
        open_ = self._owed_in_all()
        owed = [id_text(each.id) for each in self.owed()]
        return {
            "violated ids": listed_text(violated, len(self.ids.violated)),
            "open ids": listed_text(owed, open_),
        }

    def _owed_in_all(self) -> int:
        """For how many ids something is owed."""
        slices = self.ids.slices.values()
        return sum(one.track.open_since is not None for one in slices)

    def remarks(self) -> list[str]:
        """What else there is to say: what is owed, what came, what was left out."""
        open_ = self._owed_in_all()
        waiting = sum(
            one.counted is Verdict.NOT_STARTED for one in self.ids.slices.values()
        )
        told = []
        if open_:
            listed = [_owed_text(each) for each in self.owed()]
            told.append(f"still open: {listed_text(listed, open_)}")
        came = self._came()
        if not self.ids.violated and came is not None:
            told.append(_ids(came))
        if self.ids.well:
            told.append(f"{self.ids.well} satisfied")
        if waiting:
            told.append(f"{waiting} not started")
        told.append(messages_text(self.ids.messages))
        if self.ids.without_id:
            told.append(f"{messages_text(self.ids.without_id)} without an id")
        if self.ids.left_out:
            reason = f"of ids beyond the limit of {self.ids.limit}"
            told.append(f"{messages_text(self.ids.left_out)} {reason} left out")
        return told

    def figure(self) -> str:
        """What is told of the violations, each with its id."""
        shown = list(first_shown(self.ids.violated.items()))
        texts = [self._figure(*each) for each in shown]
        more = len(self.ids.violated) - len(shown)
        if more:
            texts.append(f"... and {_ids(more)} more\n")
        return "\n".join(texts)

    def document(self) -> dict[str, Any]:
        """The ids in the JSON document of `ltlc run`."""
        waiting = sum(
            one.counted is Verdict.NOT_STARTED for one in self.ids.slices.values()
        )
        came = self._came()
        return {
            "keys": [key.name for key in self.cut.keys.values()],
            "ids": came,
            "started": None if came is None else came - waiting,
            "satisfied": self.ids.well,
            "violated": [
                {
                    "id": json_value(id_),
                    "decided_at": failure_report(each.failure),
                    "may_lack_beginning": each.lacks_beginning,
                }
                for id_, each in self.ids.violated.items()
            ],
            "owed": [owed_report(each) for each in self.owed()],
            "left_out": self.ids.left_out,
            "without_id": self.ids.without_id,
            "messages": self.ids.messages,
        }

    def _figure(self, id_: Id, violation: Violation) -> str:
        of = self.track.property
        label = f"{of.label}[{self.cut.variable} = {id_text(id_)}]"
        text = failure_text(replace(of, label=label), violation.failure)
        lacks = "Its beginning may be missing.\n" if violation.lacks_beginning else ""
        return f"{text}{lacks}"

    def _line(self, id_: Id, violation: Violation) -> dict[str, Any]:
        """The violation of an id as data."""
        of = self.track.property
        return {
            "label": of.label,
            "file": of.file,
            "line": of.line,
            "id": json_value(id_),
            "verdict": Verdict.VIOLATED.value,
            **moment_report(violation.failure),
            "may_lack_beginning": violation.lacks_beginning,
        }


def first_shown(
    items: Iterable[tuple[Id, Violation]],
) -> Iterable[tuple[Id, Violation]]:
    """Those that are shown."""
    return (pair for pair, _ in zip(items, range(MOST), strict=False))


def listed_text(told: Sequence[str], number: int) -> str:
    """What is told of some of so many."""
    more = f" and {number - len(told)} more" if number > len(told) else ""
    return f"{', '.join(told)}{more}"


def _owed_text(each: Owed) -> str:
    left = "" if each.left is None else f" ({seconds_text(each.left)} s left)"
    lacks = " (its beginning may be missing)" if each.lacks_beginning else ""
    return f"{id_text(each.id)} since {seconds_text(each.since.time)} s{left}{lacks}"


def owed_report(each: Owed) -> dict[str, Any]:
    """What is owed, in the JSON document of `ltlc run`."""
    return {
        "id": json_value(each.id),
        "open_since": moment_report(each.since),
        "left": None if each.left is None else seconds(each.left),
        "left_ns": each.left,
        "may_lack_beginning": each.lacks_beginning,
    }


def _marked(each: Violation) -> str:
    return " (its beginning may be missing)" if each.lacks_beginning else ""


def _ids(number: int) -> str:
    return f"{number} id" if number == 1 else f"{number} ids"


def messages_text(number: int) -> str:
    """So many messages."""
    return f"{number} message" if number == 1 else f"{number} messages"
