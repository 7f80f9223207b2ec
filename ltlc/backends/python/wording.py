"""How emitted Python states what a step does: attributes of `self`."""

from __future__ import annotations

from ltlc.backends.statements import Statement
from ltlc.backends.steps import Late, Steps
from ltlc.backends.trees import Call, Chain, Code, Text
from ltlc.backends.wording import Wording
from ltlc.semantics.verdicts import Verdict


def _noted(times: str, most: int) -> tuple[tuple[Statement, ...], Code]:
    return (f"self.{times}.append(time)",), Chain((Text(f"len(self.{times})"), Text(str(most))), ("==",))


PYTHON = Wording(
    own="self.",
    verdicts={verdict: verdict.name for verdict in Verdict},
    is_dated=False,
    never="NEVER",
    duration="{:_}",
    sooner=lambda times: Call("min", tuple(map(Text, times))),
    noted=_noted,
    first=lambda times, most: f"self.{times}[-{most}]",
    method="self.",
    same=("is", "is not"),
    words=("False", "True"),
)


def dispatched(steps: Steps, late: Late | None = None) -> tuple[Statement, ...]:
    """What takes `self.state` and `self.verdict` to their values after an instant."""
    is_alone, statements = steps.statements(late)
    return statements if is_alone else ("state = self.state", *statements)
