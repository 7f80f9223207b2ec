"""Are there commands that violate nothing by themselves, and that a guard never lets through?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.findings import Finding
from ltlc.analysis.guards.passing import Guarded, example, games, held_back, in_words, shortest_play
from ltlc.analysis.subjects import Study
from ltlc.analysis.wording import listed
from ltlc.base.diagnostics import Label
from ltlc.specification.guards import Guard

TO_ANSWER = (
    "let the guard answer what comes: `P and previously P implies Q`, or `P implies eventually Q within 100 ms`, "
    "instead of `P implies Q`; or ask it of new commands only: `new s and P implies Q`"
)
IN_ANY_ORDER = (
    "do not limit what the fallback sends: `new s and s > 0.2 implies not previously once …`; a guard is ready for any "
    "order of its clocks, also for one that cannot come"
)
AT_ODDS = "let one of them give way where the other holds, or add a fallback that both allow"


def ask(study: Study) -> Iterator[Finding]:
    """A warning for each guard that has such commands, with the properties that are to blame."""
    for guarded in games(study):
        for guard in guarded.guards:
            if guarded.passes(guard.out) and _holds_some_back(guarded, guard):
                yield _finding(guarded, guard)


def _holds_some_back(guarded: Guarded, guard: Guard) -> bool:
    return held_back(guarded.solution, guard.out) != guarded.solution.game.diagrams.false


def _finding(guarded: Guarded, guard: Guard) -> Finding:
    cause = guarded.because_of(lambda fewer: _holds_some_back(fewer, guard))
    names = listed([f"`{subject.label}`" for subject in cause.kept])
    commands = held_back(cause.solution, guard.out)
    found = shortest_play(cause.solution, guard.out, commands)
    caption = "if such a command were let through:"
    what = f"no command passes{in_words(cause, commands)}, though it violates nothing by itself"
    label = f"{names} are at odds there" if len(cause.kept) > 1 else f"{names} could not be kept any more"
    help_ = AT_ODDS if len(cause.kept) > 1 else TO_ANSWER
    if cause.may_be_strict:
        what += ": that may be stricter than it must be"
        label = f"a guard does not know which clock of {names} ends first"
        help_ = IN_ANY_ORDER
        caption = "if such a command were let through, the guard would have to be ready for this:"
    return Finding(
        "LTL612",
        guard.span,
        what,
        label=label,
        secondary=tuple(Label(subject.specification.span) for subject in cause.kept),
        help=help_,
        example=None if found is None else example(cause, *found, caption),
    )
