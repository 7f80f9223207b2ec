"""Work for an editor that the next key ends: in child processes, since Spot and z3 hold the interpreter they run in."""

from __future__ import annotations

import math
import os
import threading
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, TypeVar

from ltlc.base.diagnostics import Diagnostic
from ltlc.base.limits import UNBOUNDED, Budget, Exceeded, run_all
from ltlc.dataclass import dataclass
from ltlc.semantics.encodings import Encoding
from ltlc.specification.specification import Specification

if TYPE_CHECKING:
    from ltlc.interfaces.api.check import PropertyCheck

Result = TypeVar("Result")


PATIENCE = 10
"""How nice analyses are to other processes, as the system counts."""


class StoppedError(Exception):
    """Nobody wants the result any more."""


@dataclass(frozen=True, slots=True)
class Analysed:
    """All findings about a file, and of each property, by its text, what its monitor can do."""

    diagnostics: tuple[Diagnostic, ...]
    summaries: Mapping[str, str]


def in_child(job: Callable[[], Result], stop: threading.Event) -> Result | Exceeded:
    """What `job` returns in a child process, which is ended soon after `stop` is set.

    Raises StoppedError then, SpotMissing, and what `job` raises.
    """

    def watch(*_: int) -> None:
        if stop.is_set():
            raise StoppedError

    _prepare()
    (outcome,) = run_all([job], UNBOUNDED, math.inf, watch)
    return outcome


@cache
def _prepare() -> None:
    """Import the engines once here, not in each child."""
    from ltlc.analysis import solving  # noqa: F401
    from ltlc.automata import engine  # noqa: F401
    from ltlc.interfaces.api import check  # noqa: F401


def analysed(
    specification: Specification, diagnostics: Sequence[Diagnostic], encoding: Encoding, budget: Budget
) -> Analysed:
    """What `ltlc check` says of `specification`, of which the front end says `diagnostics`. Raises SpotMissing.

    The process and its children have a low priority, so that typing is not slowed down.
    """
    from ltlc.analysis.examine import examine_loaded
    from ltlc.interfaces.api.check import check_of

    os.nice(PATIENCE)
    found = check_of(examine_loaded(specification, diagnostics, encoding, budget), specification.source)
    return Analysed(found.diagnostics, {each.text: _summary(each) for each in found.properties})


def _summary(found: PropertyCheck) -> str:
    """How large its monitor is, and verdicts it can give."""
    if found.states is None:
        return found.summary
    return f"{found.states} state{'' if found.states == 1 else 's'}, {found.summary}"
