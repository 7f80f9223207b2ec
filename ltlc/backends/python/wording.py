"""How emitted Python says what a step does: attributes of `self`."""

from __future__ import annotations

from collections.abc import Sequence

from ltlc.backends.python.code import lines
from ltlc.backends.statements import Do, Statement
from ltlc.backends.steps import Late, Steps
from ltlc.backends.trees import Call, Chain, Code, Text
from ltlc.semantics.verdicts import Verdict


class _Python:
    """Attributes of `self`."""

    own = "self."
    words = ("False", "True")

    def starts(self, verdict: Verdict) -> tuple[Statement, ...]:
        return self.verdict(verdict)

    def state(self, number: int) -> Statement:
        return f"self.state = {number}"

    def verdict(self, verdict: Verdict) -> tuple[Statement, ...]:
        return (f"self.verdict = {verdict.name}",)

    def settled(self, verdict: Verdict) -> tuple[Statement, ...]:
        """The verdict is this one from now on."""
        return self.verdict(verdict)

    def clock(self, name: str, since: str, duration: int) -> Statement:
        if since == name:
            return f"self.{name} += {duration:_}"
        return f"self.{name} = {since} + {duration:_}" if since else f"self.{name} = NEVER"

    def noted(self, times: str, most: int) -> tuple[tuple[Statement, ...], Code]:
        is_full = Chain((Text(f"len(self.{times})"), Text(str(most))), ("==",))
        return (f"self.{times}.append(time)",), is_full

    def first(self, times: str, most: int) -> str:
        return f"self.{times}[-{most}]"

    def again(self) -> Statement:
        return "self.due = time"

    def soonest(self, clocks: Sequence[str]) -> Statement:
        return f"self.due = {least_due(clocks)}"

    def schedule(self) -> Statement:
        return "self._schedule(time)"

    def call(self, method: str, arguments: Sequence[str]) -> Statement:
        return Do("", Call(f"self.{method}", tuple(map(Text, arguments))))


PYTHON = _Python()


def least_due(clocks: Sequence[str]) -> str:
    """The earliest of the due times."""
    names = [f"self.{name}" for name in clocks]
    return f"min({', '.join(names)})" if len(names) > 1 else names[0] if names else "NEVER"


def dispatched(steps: Steps, indent: str, late: Late | None = None) -> list[str]:
    """Statements that take `self.state` and `self.verdict` to their values after an instant."""
    is_alone, statements = steps.statements(late)
    return lines(statements if is_alone else ("state = self.state", *statements), indent)
