"""What guards did, as text and as JSON."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from ltlc.runtime.documents import json_value
from ltlc.runtime.guarding import Action, Deed, Values
from ltlc.runtime.reports import value_text
from ltlc.runtime.times import seconds

ACTION_WORDS = {
    Action.PASSED: "passed",
    Action.CHANGED: "changed",
    Action.HELD: "held back",
    Action.SENT: "sent by itself",
    Action.LOST: "lost",
}


def counts_text(out: str, counts: Mapping[Action, int], lost: str = "it lost") -> str:
    """How often the guard of the topic `out` did what; that it `lost`, if it did."""
    return f"guard of {out}: {actions_text(counts, lost)}"


def actions_text(counts: Mapping[Action, int], lost: str = "it lost") -> str:
    """How often what was done; that it `lost`, if it did."""
    did = (action for action in Action if action is not Action.LOST)
    shown = (f"{counts[action]:,} {ACTION_WORDS[action]}" for action in did)
    return f"{', '.join(shown)}{f'; {lost}' if counts[Action.LOST] else ''}"


def deed_text(deed: Deed) -> str:
    """What was done with which command, and what left instead."""
    word = ACTION_WORDS[deed.action]
    command = "" if deed.command is None else f" {_values_text(deed.command)}"
    if deed.message is None:
        return f"{word}{command}"
    instead = f" to `{deed.message}`" if command else f" `{deed.message}`"
    return f"{word}{command}{instead}"


def _values_text(values: Values) -> str:
    texts = (f"{name} = {value_text(value)}" for name, value in values.items())
    return ", ".join(texts) or "a message"


def deed_report(deed: Deed, zero: int | None) -> dict[str, Any]:
    """A deed, in JSON; with its offset, if it is known when the recording began."""
    return {
        "time": seconds(deed.time),
        "time_ns": deed.time,
        **({} if zero is None else {"offset": seconds(deed.time - zero)}),
        "command": _json(deed.command),
        "sent": _json(deed.values),
        "message": deed.message,
        "reason": deed.reason,
    }


def _json(values: Values | None) -> dict[str, Any] | None:
    if values is None:
        return None
    return {name: json_value(value) for name, value in values.items()}


class Tally:
    """What the guard of one topic did so far: counts, and the last of each action."""

    KEPT = 1000

    def __init__(self, raw: str, out: str) -> None:
        self.raw, self.out = raw, out
        self.counts = Counter[Action]()
        self._last = {action: deque[Deed](maxlen=self.KEPT) for action in Action}

    def add(self, deed: Deed) -> None:
        """The guard did something."""
        self.counts[deed.action] += 1
        self._last[deed.action].append(replace(deed, otherwise=None))

    def last(self, action: Action) -> Deed | None:
        """What it did last of an action."""
        return self._last[action][-1] if self._last[action] else None

    @property
    def text(self) -> str:
        """How often it did what."""
        return counts_text(self.out, self.counts)

    def document(self, zero: int | None) -> dict[str, Any]:
        """What is in the list `guard` of a report, as `ltlc run --guard` makes it."""
        counts = {action.value: self.counts[action] for action in Action}
        return {
            "raw": self.raw,
            "out": self.out,
            "commands_from": self.raw,
            "counts": counts,
            **{a.value: _reports(deeds, zero) for a, deeds in self._last.items()},
        }


def _reports(deeds: Iterable[Deed], zero: int | None) -> list[dict[str, Any]]:
    return [deed_report(deed, zero) for deed in deeds]
