"""What guards did with a recording, as text and as JSON."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from ltlc.dataclass import dataclass
from ltlc.runtime.guard_reports import counts_text, deed_report, deed_text
from ltlc.runtime.guarding import Action, Deed
from ltlc.runtime.plays import Play
from ltlc.runtime.session import Session
from ltlc.specification.guards import Guard

MOST_LINES = 10
"""So many deeds of a guard are listed unless all are wanted."""


class Done(NamedTuple):
    """What a guard did, and how the world could otherwise have broken a property, if that had to be avoided.

    Its command is the `message`, in CDR, if messages are kept.
    """

    deed: Deed
    play: Play | None = None
    message: bytes | None = None

    def reason(self, *, whole: bool = False) -> str:
        """Why, in words; with the whole play if that is wanted."""
        if self.play is None:
            return self.deed.reason
        violation, moves = f"a violation of {self.play.labels}", self.play.text(whole=whole)
        match self.deed.action:
            case Action.SENT:
                return f"{self.deed.reason}: otherwise {violation} could no longer be avoided: {moves}"
            case Action.LOST:
                return f"{violation} can no longer be avoided: {moves}"
            case _:
                return f"{violation} could no longer be avoided after it: {moves}"


@dataclass(frozen=True)
class GuardReport:
    """What `guards` have `done` in one run, in the order of time.

    It `is_unguarded` if the recording has no commands, and what was recorded behind the guard was taken for them. The
    texts `definitions` define the messages that leave, by topic, in the form `ros2msg`.
    """

    guards: Sequence[Guard]
    done: Sequence[Done]
    is_unguarded: bool
    definitions: Mapping[str, str]

    @property
    def has_lost(self) -> bool:
        """Whether one could no longer keep its properties."""
        return any(each.deed.action is Action.LOST for each in self.done)

    def text(self, session: Session, with_all: bool, *, whole: bool = False) -> str:
        """A paragraph for each guard; of what it did, the first deeds, or all but what passed, each with its reason."""
        return "".join("\n".join(self._lines(guard, session, with_all, whole)) + "\n" for guard in self.guards)

    def _lines(self, guard: Guard, session: Session, with_all: bool, whole: bool) -> Iterator[str]:
        own = self.of(guard)
        yield counts_text(guard.out, {action: sum(each.deed.action is action for each in own) for action in Action})
        if self.is_unguarded:
            yield f"  {guard.raw} was not recorded: what was recorded on {guard.out} is taken for its commands"
        acted = [each for each in own if each.deed.action is not Action.PASSED]
        listed = acted if with_all else acted[:MOST_LINES]
        for each in listed:
            yield f"  {session.scale.text(each.deed.time)}  {deed_text(each.deed)}: {each.reason(whole=whole)}"
        if len(listed) < len(acted):
            yield f"  and {len(acted) - len(listed):,} more: `--all` lists them"

    def of(self, guard: Guard) -> list[Done]:
        """What one of the guards has done."""
        return [each for each in self.done if guard.out in each.deed.outs]

    def document(self, session: Session) -> list[dict[str, Any]]:
        """An object for each guard, with lists of what it passed, changed, held back and sent."""
        return [self._document(guard, session) for guard in self.guards]

    def _document(self, guard: Guard, session: Session) -> dict[str, Any]:
        own = self.of(guard)
        listed = {a.value: [entry(each, session) for each in own if each.deed.action is a] for a in Action}
        commands = guard.out if self.is_unguarded else guard.raw
        return {"raw": guard.raw, "out": guard.out, "commands_from": commands, **listed}


def entry(done: Done, session: Session) -> dict[str, Any]:
    """What a guard did once, as JSON."""
    return {
        **deed_report(done.deed, session.beginning),
        "reason": done.reason(),
        "play": None if done.play is None else done.play.document(),
    }
