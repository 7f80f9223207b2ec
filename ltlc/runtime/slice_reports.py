"""What a run has shown of a property that is judged for each id, as text and data."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from heapq import nsmallest
from itertools import islice
from typing import Any

from ltlc.dataclass import dataclass
from ltlc.runtime.documents import failure_report, json_value, moment_report
from ltlc.runtime.episodes import latest
from ltlc.runtime.properties import Moment, Opening
from ltlc.runtime.reports import counted, failure_text, printable
from ltlc.runtime.session import Session
from ltlc.runtime.slice_ids import Ids, Violation
from ltlc.runtime.slice_keys import Cut, Id
from ltlc.runtime.times import NEVER, Scale, seconds, span_text
from ltlc.runtime.tracking import Track
from ltlc.semantics.verdicts import Verdict

MOST = 20
"""How many ids are named in a line, and how many violations shown in full."""
LACKS = " (its beginning may be missing)"


@dataclass(frozen=True, slots=True)
class Owed:
    """An obligation is open for an id; how long it can wait, None without a limit.

    Of an instance, `opened` has its message first.
    """

    id: Id
    opened: tuple[Opening, ...]
    since: Moment
    left: int | None
    lacks_beginning: bool


def id_text(id_: Id) -> str:
    """An id as a reader knows it: a text that would not stand alone in quotes."""
    if isinstance(id_, str) and (not id_ or any(mark in id_ for mark in ',;:"')):
        return printable(json.dumps(id_, ensure_ascii=False))
    return printable(str(id_).lower() if isinstance(id_, bool) else str(id_))


class ToldSlices:
    """The slices of a `track` in a `session`, and what to report of them.

    `cut` says what slices it, `ids` has what is known of each; in one of the states
    `as_new` an id is forgotten.
    """

    noun = "id"

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

    @property
    def _scale(self) -> Scale:
        """How times are shown to a reader."""
        return self.session.scale

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

    def _all(self) -> str | None:
        """What came, if that is known."""
        came = self._came()
        return None if came is None else self._number(came)

    def _number(self, number: int) -> str:
        return counted(number, self.noun)

    def _named(self, id_: Id, opened: Sequence[Opening]) -> str:
        """A slice as a reader knows it."""
        return id_text(id_)

    @property
    def _which(self) -> str:
        """What a reader knows slices by, before the name of one."""
        return f"{self.cut.variable} ="

    def owed(self) -> list[Owed]:
        """The open obligations, the most urgent first."""
        now = self.session.time
        found = []
        for one in self.ids.slices.values():
            since, deadline = one.open_since, None
            if since is None:
                continue
            deadline = one.deadline()
            left = None if deadline is None or now is None else deadline - 1 - now
            opened = latest(one.scopes)
            found.append(Owed(one.id, opened, since, left, one.id in self.ids.lacking))
        return nsmallest(
            MOST, found, key=lambda each: NEVER if each.left is None else each.left
        )

    def since(self) -> str:
        """Which ids violated the property, and when; empty if none did."""
        violated, failed, came = self.ids.violated, self.ids.failed, self._all()
        if not violated:
            return ""
        told = [self._violated(*each) for each in first_shown(violated.items())]
        share = self._number(failed) if came is None else f"{failed} of {came}"
        return f" by {share}: {listed_text(told, len(violated))}"

    def _violated(self, id_: Id, each: Violation) -> str:
        lacks = LACKS if each.lacks_beginning else ""
        return f"{id_text(id_)} at {self._scale.text(each.failure.time)}{lacks}"

    def untold(self) -> Iterator[tuple[str, str]]:
        """The report on each violation that was not reported yet, also as JSON."""
        violated = self.ids.violated
        while self._told < len(violated):
            told = [*islice(violated.items(), self._told, None)]
            self._told += len(told)
            for id_, each in told:
                yield self._figure(id_, each), json.dumps(self._line(id_, each))

    def listed(self) -> dict[str, str]:
        """The ids that violate the property, and those with an open obligation."""
        shown = first_shown(self.ids.violated.items())
        violated = [self._named(id_, each.failure.opened) for id_, each in shown]
        owed = [self._named(each.id, each.opened) for each in self.owed()]
        return {
            f"violated {self.noun}s": listed_text(violated, len(self.ids.violated)),
            f"open {self.noun}s": listed_text(owed, self._owed_in_all()),
        }

    def _owed_in_all(self) -> int:
        """How many ids have an open obligation."""
        slices = self.ids.slices.values()
        return sum(one.open_since is not None for one in slices)

    def _waiting(self) -> int:
        """How many slices have had no step."""
        slices = self.ids.slices.values()
        return sum(one.verdict is Verdict.NOT_STARTED for one in slices)

    def remarks(self) -> list[str]:
        """Further remarks: what is open, what came, what was omitted."""
        told = []
        if open_ := self._owed_in_all():
            listed = [self._owed(each) for each in self.owed()]
            told.append(f"still open: {listed_text(listed, open_)}")
        came = self._all()
        if not self.ids.violated and came is not None:
            told.append(came)
        if self.ids.well:
            told.append(f"{self.ids.well} satisfied")
        return [*told, *self._more()]

    def _owed(self, each: Owed) -> str:
        left = "" if each.left is None else f" ({span_text(each.left)} left)"
        return f"{self._owing(each)}{left}{LACKS if each.lacks_beginning else ''}"

    def _owing(self, each: Owed) -> str:
        """What an obligation is open for, and since when."""
        return f"{id_text(each.id)} since {self._scale.text(each.since.time)}"

    def _more(self) -> Iterator[str]:
        """Remarks on messages."""
        if waiting := self._waiting():
            yield f"{waiting} not started"
        yield messages_text(self.ids.messages)
        if self.ids.without_id:
            yield f"{messages_text(self.ids.without_id)} without an id"
        if self.ids.left_out:
            reason = f"of ids beyond the limit of {self.ids.limit}"
            yield f"{messages_text(self.ids.left_out)} {reason} left out"

    def figure(self) -> str:
        """What is reported of the violations, each with its id."""
        shown = list(first_shown(self.ids.violated.items()))
        texts = [self._figure(*each) for each in shown]
        if more := len(self.ids.violated) - len(shown):
            texts.append(f"... and {self._number(more)} more\n")
        return "\n".join(texts)

    def document(self) -> dict[str, Any]:
        """The ids in the JSON document of `ltlc run`."""
        came, zero = self._came(), self.session.beginning
        constants = self.track.property.constants
        return {
            "keys": [key.name for key in self.cut.keys.values()],
            "ids": came,
            "started": None if came is None else came - self._waiting(),
            "satisfied": self.ids.well,
            "violated": [
                {
                    "id": json_value(id_),
                    "decided_at": failure_report(each.failure, zero, constants),
                    "may_lack_beginning": each.lacks_beginning,
                }
                for id_, each in self.ids.violated.items()
            ],
            "owed": [owed_report(each, zero) for each in self.owed()],
            "left_out": self.ids.left_out,
            "without_id": self.ids.without_id,
            "messages": self.ids.messages,
        }

    def _figure(self, id_: Id, violation: Violation) -> str:
        of, failure = self.track.property, violation.failure
        label = f"{of.label}[{self._which} {self._named(id_, failure.opened)}]"
        text = failure_text(replace(of, label=label), failure, self._scale)
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
            **moment_report(violation.failure, self.session.beginning),
            "may_lack_beginning": violation.lacks_beginning,
            **of.traced(),
        }


def first_shown(
    items: Iterable[tuple[Id, Violation]],
) -> Iterable[tuple[Id, Violation]]:
    """Those that are shown."""
    return (pair for pair, _ in zip(items, range(MOST), strict=False))


def listed_text(told: Sequence[str], number: int) -> str:
    """What is reported of some of so many."""
    more = f" and {number - len(told)} more" if number > len(told) else ""
    return f"{', '.join(told)}{more}"


def owed_report(each: Owed, zero: int | None) -> dict[str, Any]:
    """The open obligations, in the JSON document of `ltlc run`."""
    return {
        "id": json_value(each.id),
        "open_since": moment_report(each.since, zero),
        "left": None if each.left is None else seconds(each.left),
        "left_ns": each.left,
        "may_lack_beginning": each.lacks_beginning,
    }


def messages_text(number: int) -> str:
    """So many messages."""
    return counted(number, "message")
