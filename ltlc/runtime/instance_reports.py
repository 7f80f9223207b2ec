"""What a run has shown of a property that is judged from each message on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from ltlc.runtime.properties import Opening
from ltlc.runtime.reports import failure_report, failure_text, moment_report
from ltlc.runtime.sampling import New
from ltlc.runtime.slice_ids import Violation
from ltlc.runtime.slice_keys import Id
from ltlc.runtime.slice_openings import Openings
from ltlc.runtime.slice_reports import (
    Owed,
    ToldSlices,
    first_shown,
    listed_text,
    messages_text,
    owed_report,
)
from ltlc.runtime.times import seconds_text


class ToldInstances(ToldSlices):
    """The instances that the messages of `openings` opened, and what there is to tell.

    It stands before what judges them, and tells instead of that.
    """

    openings: Openings | None

    @property
    def _openings(self) -> Openings:
        assert self.openings is not None
        return self.openings

    def since(self) -> str:
        """From which messages on the property is violated; empty if from none."""
        messages, name = self._openings.messages, self._openings.opener.name
        violated = messages.violated
        if not violated:
            return ""
        told = [self._violated(each) for _, each in first_shown(violated.items())]
        came = messages_text(messages.births)
        listed = listed_text(told, len(violated))
        return f" by {messages.failed} of {came} of {name}: {listed}"

    def remarks(self) -> list[str]:
        """What else there is to say: what is owed, what came, what was left out."""
        messages, name = self._openings.messages, self._openings.opener.name
        owed = self.owed()
        told = []
        if owed:
            texts = [self._owed(each) for each in owed]
            shown = listed_text(texts, self._owed_in_all())
            told.append(f"still open: {shown}")
        if not messages.violated:
            told.append(f"{messages_text(messages.births)} of {name}")
        if messages.well:
            told.append(f"{messages.well} satisfied")
        if messages.unopened:
            told.append(f"{messages_text(messages.unopened)} of {name} made no step")
        if messages.left_out:
            reason = f"beyond the limit of {messages.limit} left out"
            told.append(f"{messages_text(messages.left_out)} of {name} {reason}")
        return told

    def figure(self) -> str:
        """What is told of the violations, each with its message."""
        violated = self._openings.messages.violated
        texts = [self._figure(*each) for each in first_shown(violated.items())]
        if more := len(violated) - len(texts):
            texts.append(f"... and {messages_text(more)} more\n")
        return "\n".join(texts)

    def document(self) -> dict[str, Any]:
        """The messages in the JSON document of `ltlc run`."""
        messages = self._openings.messages
        return {
            "new": self._openings.opener.name,
            "messages": messages.messages,
            "judged": messages.births,
            "satisfied": messages.well,
            "violated": [
                {
                    "message": number,
                    "opened_at": moment_report(each.failure.opened[0]),
                    "decided_at": failure_report(each.failure),
                    "more": each.more,
                }
                for number, each in messages.violated.items()
            ],
            "owed": [
                {"opened_at": moment_report(each.opened[0]), **owed_report(each)}
                for each in self.owed()
            ],
            "left_out": messages.left_out,
            "no_step": messages.unopened,
        }

    def listed(self) -> dict[str, str]:
        """From when on the property is violated, and from when on something is owed."""
        violated = self._openings.messages.violated
        shown = first_shown(violated.items())
        failed = [self._time(each.failure.opened) for _, each in shown]
        owed = [self._time(each.opened) for each in self.owed()]
        return {
            "violated messages": listed_text(failed, len(violated)),
            "open messages": listed_text(owed, self._owed_in_all()),
        }

    def _line(self, id_: Id, violation: Violation) -> dict[str, Any]:
        """The violation from a message on as data; the message by its number."""
        found = super()._line(id_, violation)
        del found["id"], found["may_lack_beginning"]
        opened = moment_report(violation.failure.opened[0])
        return {**found, "message": id_, "opened_at": opened, "more": violation.more}

    def _figure(self, id_: Id, violation: Violation) -> str:
        of, failure, opener = (
            self.track.property,
            violation.failure,
            self._openings.opener,
        )
        label = f"{of.label}[{opener.name} at {self._time(failure.opened)}]"
        made = str(New(opener.mark))
        values = tuple(pair for pair in failure.values if pair[0] != made)
        shown = replace(failure, values=values)
        return failure_text(replace(of, label=label), shown)

    def _violated(self, each: Violation) -> str:
        more = f", and {each.more} more like it" if each.more else ""
        at = seconds_text(each.failure.time)
        return f"that at {self._time(each.failure.opened)} (decided at {at} s{more})"

    def _owed(self, each: Owed) -> str:
        left = "" if each.left is None else f" ({seconds_text(each.left)} s left)"
        return f"that at {self._time(each.opened)}{left}"

    def _time(self, opened: Sequence[Opening]) -> str:
        """When the message came: what opened first is the instance."""
        return f"{seconds_text(opened[0].time)} s"
