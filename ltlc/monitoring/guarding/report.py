"""What guards did with a recording, as text and as JSON."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from ltlc.dataclass import dataclass
from ltlc.runtime.documents import json_value
from ltlc.runtime.guarding import Action, Deed, Values
from ltlc.runtime.reports import value_text
from ltlc.runtime.session import Session
from ltlc.runtime.times import seconds
from ltlc.specification.guards import Guard

MOST_LINES = 10
"""So many deeds of a guard are listed unless all are wanted."""

_WORDS = {
    Action.PASSED: "passed",
    Action.CHANGED: "changed",
    Action.HELD: "held back",
    Action.SENT: "sent by itself",
    Action.LOST: "lost",
}


@dataclass(frozen=True)
class GuardReport:
    """What `guards` did in one run, in the order of time.

    It `is_unguarded` if the recording has no commands, and what was recorded behind the guard was taken for them.
    """

    guards: Sequence[Guard]
    deeds: Sequence[Deed]
    is_unguarded: bool

    @property
    def has_lost(self) -> bool:
        """Whether one could no longer keep its properties."""
        return any(deed.action is Action.LOST for deed in self.deeds)

    def text(self, session: Session, with_all: bool) -> str:
        """A paragraph for each guard; of what it did, the first deeds, or all but what passed."""
        return "".join("\n".join(self._lines(guard, session, with_all)) + "\n" for guard in self.guards)

    def _lines(self, guard: Guard, session: Session, with_all: bool) -> Iterator[str]:
        own = self._of(guard)
        counts = {action: sum(deed.action is action for deed in own) for action in Action}
        shown = (f"{counts[action]:,} {_WORDS[action]}" for action in Action if action is not Action.LOST)
        yield f"guard of {guard.out}: {', '.join(shown)}{'; it lost' if counts[Action.LOST] else ''}"
        if self.is_unguarded:
            yield f"  {guard.raw} was not recorded: what was recorded on {guard.out} is taken for its commands"
        acted = [deed for deed in own if deed.action is not Action.PASSED]
        listed = acted if with_all else acted[:MOST_LINES]
        for deed in listed:
            yield f"  {session.scale.text(deed.time)}  {_WORDS[deed.action]}{_subject(deed)}: {deed.reason}"
        if len(listed) < len(acted):
            yield f"  and {len(acted) - len(listed):,} more: `--all` lists them"

    def _of(self, guard: Guard) -> list[Deed]:
        return [deed for deed in self.deeds if guard.out in deed.outs]

    def document(self, session: Session) -> list[dict[str, Any]]:
        """An object for each guard, with lists of what it passed, changed, held back and sent."""
        return [self._document(guard, session) for guard in self.guards]

    def _document(self, guard: Guard, session: Session) -> dict[str, Any]:
        own = self._of(guard)
        listed = {action.value: [_report(deed, session) for deed in own if deed.action is action] for action in Action}
        commands = guard.out if self.is_unguarded else guard.raw
        return {"raw": guard.raw, "out": guard.out, "commands_from": commands, **listed}


def _subject(deed: Deed) -> str:
    """What was asked for, and what left instead."""
    command = "" if deed.command is None else f" {_text(deed.command)}"
    if deed.message is None:
        return command
    return f"{command} to `{deed.message}`" if command else f" `{deed.message}`"


def _text(values: Values) -> str:
    return ", ".join(f"{name} = {value_text(value)}" for name, value in values.items()) or "a message"


def _report(deed: Deed, session: Session) -> dict[str, Any]:
    zero = session.beginning
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
    return None if values is None else {name: json_value(value) for name, value in values.items()}
