"""Do guards let anything through?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.findings import Finding
from ltlc.analysis.guards.passing import Guarded, example, games, shortest_play
from ltlc.analysis.subjects import Study
from ltlc.analysis.wording import listed
from ltlc.base.diagnostics import Label
from ltlc.semantics.arenas import Outcome
from ltlc.specification.guards import Guard


def ask(study: Study) -> Iterator[Finding]:
    """An error for each guard that lets nothing through, with the properties that are to blame."""
    for guarded in games(study):
        for guard in guarded.guards:
            if guarded.passes(guard.out):
                continue
            waiting = _waiting(guarded)
            if waiting and not guard.fallbacks:
                yield _begins_never(guard, waiting)
            else:
                yield _nothing(guarded, guard)


def _waiting(guarded: Guarded) -> list[str]:
    """The properties that never begin."""
    arena, visited = guarded.solution.game.arena, guarded.solution.visited
    begun = {k for joint in visited for k, at in enumerate(joint.standings) if at is not Outcome.WAITING}
    return [part.label for k, part in enumerate(arena.parts) if k not in begun]


def _begins_never(guard: Guard, waiting: list[str]) -> Finding:
    names = listed([f"`{label}`" for label in waiting])
    return Finding(
        "LTL611",
        guard.span,
        f"nothing can be the first message on `{guard.out}`: {names} {'begins' if len(waiting) == 1 else 'begin'} only "
        "after that",
        label="without a fallback, it never begins",
        help="add a fallback, which may leave first: `… else stop`",
    )


def _nothing(guarded: Guarded, guard: Guard) -> Finding:
    cause = guarded.because_of(lambda fewer: not fewer.passes(guard.out))
    names = listed([f"`{subject.label}`" for subject in cause.kept])
    counting = [f"`{subject.label}`" for subject in cause.kept if subject.counts]
    if counting:
        why = f"a guard does not know how often something has occurred, and {listed(counting)} counts"
    elif cause.may_be_strict:
        why = f"a guard does not know which clock of {names} ends first, and is ready for any order"
    elif len(cause.kept) > 1:
        why = f"{names} are at odds: what keeps one violates another"
    else:
        why = f"whatever is sent, {names} can be violated"
    found = shortest_play(cause.solution, guard.out, cause.solution.game.diagrams.true)
    shown = None if found is None else example(cause, *found, f"after a command, the guard cannot keep {names}:")
    return Finding(
        "LTL610",
        guard.span,
        f"nothing is ever let through to `{guard.out}`: {why}",
        secondary=tuple(Label(subject.specification.span) for subject in cause.kept),
        help="`assume` what the world never does, add a fallback that helps, or let the property be about other topics "
        "only, so that it is watched",
        example=shown,
    )
