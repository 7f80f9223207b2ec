"""What a run has shown of a property that is judged from each message on."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from ltlc.runtime.documents import failure_report, moment_report
from ltlc.runtime.properties import Opening
from ltlc.runtime.sampling import New
from ltlc.runtime.slice_ids import Violation
from ltlc.runtime.slice_keys import Id
from ltlc.runtime.slice_openings import Openings
from ltlc.runtime.slice_reports import (
    Owed,
    ToldSlices,
    first_shown,
    messages_text,
    owed_report,
)
from ltlc.runtime.times import Scale


class ToldInstances(ToldSlices):
    """The instances that the messages of `openings` opened, and what to report of them.

    It stands in front of what judges them, and reports instead.
    """

    noun = "message"
    openings: Openings | None

    @property
    def _scale(self) -> Scale:
        """Fine enough to distinguish the messages that are named."""
        violated = first_shown(self.ids.violated.items())
        named = [each.failure.opened for _, each in violated]
        named += [each.opened for each in self.owed()]
        return self.session.scale.among(opened[0].time for opened in named)

    @property
    def _openings(self) -> Openings:
        assert self.openings is not None
        return self.openings

    def _all(self) -> str:
        """How many instances there were."""
        return f"{self._number(self.ids.births)} of {self._openings.opener.name}"

    def _named(self, id_: Id, opened: Sequence[Opening]) -> str:
        """When the message came: what opened first is the instance."""
        return self._scale.text(opened[0].time)

    @property
    def _which(self) -> str:
        return f"{self._openings.opener.name} at"

    def _violated(self, id_: Id, each: Violation) -> str:
        more = f", and {each.more} more like it" if each.more else ""
        at = self._scale.text(each.failure.time)
        made = self._named(id_, each.failure.opened)
        return f"that at {made} (decided at {at}{more})"

    def _owing(self, each: Owed) -> str:
        return f"that at {self._named(each.id, each.opened)}"

    def _more(self) -> Iterator[str]:
        messages, name = self._openings.messages, self._openings.opener.name
        if messages.unopened:
            yield f"{messages_text(messages.unopened)} of {name} made no step"
        if messages.left_out:
            reason = f"beyond the limit of {messages.limit} left out"
            yield f"{messages_text(messages.left_out)} of {name} {reason}"

    def document(self) -> dict[str, Any]:
        """The messages in the JSON document of `ltlc run`."""
        messages, zero = self._openings.messages, self.session.beginning
        constants = self.track.property.constants
        return {
            "new": self._openings.opener.name,
            "messages": messages.messages,
            "judged": messages.births,
            "satisfied": messages.well,
            "violated": [
                {
                    "message": number,
                    "opened_at": moment_report(each.failure.opened[0], zero),
                    "decided_at": failure_report(each.failure, zero, constants),
                    "more": each.more,
                }
                for number, each in messages.violated.items()
            ],
            "owed": [
                {
                    "opened_at": moment_report(each.opened[0], zero),
                    **owed_report(each, zero),
                }
                for each in self.owed()
            ],
            "left_out": messages.left_out,
            "no_step": messages.unopened,
        }

    def _line(self, id_: Id, violation: Violation) -> dict[str, Any]:
        """The violation from a message on as data; the message by its number."""
        found = super()._line(id_, violation)
        del found["id"], found["may_lack_beginning"]
        zero = self.session.beginning
        opened = moment_report(violation.failure.opened[0], zero)
        return {**found, "message": id_, "opened_at": opened, "more": violation.more}

    def _figure(self, id_: Id, violation: Violation) -> str:
        failure, made = violation.failure, str(New(self._openings.opener.mark))
        values = tuple(pair for pair in failure.values if pair[0] != made)
        shown = replace(violation, failure=replace(failure, values=values))
        return super()._figure(id_, shown)
