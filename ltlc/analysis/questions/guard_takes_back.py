"""Does a guard let commands through that it then has to take back?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.findings import Finding
from ltlc.analysis.guards.game import Step
from ltlc.analysis.guards.passing import Guarded, games, harmless, in_words
from ltlc.analysis.guards.solution import Solution
from ltlc.analysis.subjects import Study
from ltlc.analysis.wording import listed
from ltlc.base.diagnostics import Label
from ltlc.semantics.arenas import Ticks
from ltlc.semantics.diagrams import Diagram
from ltlc.semantics.timed_atoms import Age
from ltlc.specification.guards import Guard


def ask(study: Study) -> Iterator[Finding]:
    """A note for each guard that has to send a fallback only because it let a command through."""
    for guarded in games(study):
        for guard in guarded.guards:
            taken = dict(_taken_back(guarded.solution, guard))
            if taken:
                yield _finding(guarded, guard, taken)


def _taken_back(solution: Solution, guard: Guard) -> Iterator[tuple[int, Diagram]]:
    """After which letters a clock runs that the command has started and only the guard stops, by the part with it."""
    game, found = solution.game, dict[int, Diagram]()
    for step, letters in harmless(solution, guard.out):
        for part in {part for part, _ in _started(solution, step)}:
            own: Ticks = frozenset(tick for tick in _started(solution, step) if tick[0] == part)
            late = {s: those for s, those in game.steps(step.joint, None).items() if s.passing & own}
            answered = game.lead_to(late, lambda s: solution.answered(s.joint))
            needs = game.diagrams.conjunction(solution.resting(step.joint), game.diagrams.negation(answered))
            found[part] = game.any_of((found.get(part, game.diagrams.false), game.diagrams.conjunction(letters, needs)))
    return ((part, letters) for part, letters in found.items() if letters != game.diagrams.false)


def _started(solution: Solution, step: Step) -> Ticks:
    """The clocks that the command starts, but for ages, which any command starts."""
    parts = solution.game.arena.parts
    return frozenset((k, n) for k, n in step.fresh if not isinstance(parts[k].time.trackers[n].subject, Age))


def _finding(guarded: Guarded, guard: Guard, taken: dict[int, Diagram]) -> Finding:
    subjects = [guarded.subjects[part] for part in sorted(taken)]
    letters = guarded.solution.game.any_of(taken.values())
    return Finding(
        "LTL613",
        guard.span,
        f"commands pass{in_words(guarded, letters)}, and are taken back later",
        label=f"{listed([f'`{subject.label}`' for subject in subjects])} gives each of them some time",
        secondary=tuple(Label(subject.specification.span) for subject in subjects),
        help="to hold them back from the start, add a property about new commands: `always (new s and P implies Q)`",
    )
