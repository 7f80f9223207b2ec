"""What two guards did with the same recording, command by command."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

from ltlc.dataclass import dataclass
from ltlc.monitoring.guarding.report import Done, GuardReport, entry
from ltlc.runtime.guard_reports import ACTION_WORDS, actions_text
from ltlc.runtime.guarding import Action
from ltlc.runtime.reports import value_text
from ltlc.runtime.session import Session


class Differs(NamedTuple):
    """A command that only one of two guards let through, and what each did with it."""

    left: Done
    right: Done


@dataclass(frozen=True)
class Compared:
    """What the guards of two files that send on `out` did with a `recording`, whose times are those of `session`."""

    out: str
    recording: str
    names: tuple[str, str]
    reports: tuple[GuardReport, GuardReport]
    session: Session

    @property
    def differences(self) -> list[Differs]:
        """The commands that only one lets through: they are the same in both runs, in the same order."""
        left, right = ([each for each in done if each.deed.command is not None] for done in self._done())
        pairs = map(Differs._make, zip(left, right, strict=True))
        return [each for each in pairs if _passes(each.left) != _passes(each.right)]

    def _done(self) -> Iterator[list[Done]]:
        for report in self.reports:
            (guard,) = (guard for guard in report.guards if guard.out == self.out)
            yield report.of(guard)

    def counts(self) -> list[dict[Action, int]]:
        """How often each did what."""
        return [{a: sum(each.deed.action is a for each in done) for a in Action} for done in self._done()]

    def lines(self, most: int | None) -> Iterator[str]:
        """How often each did what, and the commands that only one lets through, so many at `most`."""
        yield f"on {self.recording}"
        for name, counts in zip(self.names, self.counts(), strict=True):
            yield f"  {name}: {actions_text(counts)}"
        found = self.differences
        for each in found[:most]:
            values = each.left.deed.command or {}
            command = ", ".join(f"{name} = {value_text(value)}" for name, value in values.items()) or "a message"
            yield f"  {self.session.scale.text(each.left.deed.time)}  {command}"
            for name, done in zip(self.names, each, strict=True):
                yield f"    {name}: {_said(done)}"
        if not found:
            yield "  they let the same commands through"
        if len(found) > len(found[:most]):
            yield f"  and {len(found) - len(found[:most]):,} more: `--format json` has them all"

    def document(self) -> dict[str, Any]:
        """It as JSON."""
        return {
            "recording": self.recording,
            "counts": [{action.value: count for action, count in counts.items()} for counts in self.counts()],
            "differences": [
                [entry(done, self.session) | {"action": done.deed.action.value} for done in each]
                for each in self.differences
            ],
        }


def _passes(done: Done) -> bool:
    return done.deed.action is Action.PASSED


def _said(done: Done) -> str:
    instead = "" if done.deed.message is None else f" to `{done.deed.message}`"
    reason = done.reason()
    return f"{ACTION_WORDS[done.deed.action]}{instead}{f': {reason}' if reason else ''}"
