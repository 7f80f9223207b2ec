"""Can a controller keep the properties, whatever the world does?"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ltlc.analysis.errors import NotDecidedError
from ltlc.analysis.findings import Finding
from ltlc.analysis.groups import reads_of
from ltlc.analysis.guards.controls import controllers
from ltlc.analysis.guards.passing import Guarded, example, game_of, shortest_play
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import listed
from ltlc.base.diagnostics import Label
from ltlc.semantics.ltl import conjunction
from ltlc.specification.specification import topics_of


def ask(study: Study) -> Iterator[Finding]:
    """An error if the world can violate a property whatever is sent on `controls`, with a play; otherwise a note."""
    if not study.controls:
        return
    game = game_of(study, controllers(study.controls), any_command=True)
    if not game.kept:
        return
    counting = next((subject for subject in game.kept if subject.counts), None)
    if counting is not None:
        raise NotDecidedError(f"`{counting.label}` counts")
    if _is_possible(game):
        yield _possible(study, game.kept)
        return
    cause = game.because_of(lambda fewer: not _is_possible(fewer))
    if cause.may_be_strict:
        raise NotDecidedError(f"{_named(cause.kept)} can be violated if their clocks may end in any order")
    yield _impossible(study, cause)


def _is_possible(game: Guarded) -> bool:
    return any(game.passes(out) for out in game.study.controls)


def _possible(study: Study, kept: Sequence[Subject]) -> Finding:
    return Finding(
        "LTL617",
        kept[0].specification.span,
        f"as far as conditions tell, a controller of {_on(study)} can prevent that {_named(kept, 'or')} is violated",
        secondary=_places(kept[1:]),
    )


def _impossible(study: Study, cause: Guarded) -> Finding:
    d, shown = cause.solution.game.diagrams, None
    plays = [found for out in study.controls if (found := shortest_play(cause.solution, out, d.true))]
    if plays:
        found = min(plays, key=lambda each: len(each[1]))
        shown = example(cause, *found, "whatever follows, the world can go on like this:")
    return Finding(
        "LTL616",
        cause.kept[0].specification.span,
        f"no controller of {_on(study)} can keep {_named(cause.kept)}: the world can violate "
        f"{'it' if len(cause.kept) == 1 else 'one of them'}, whatever is sent",
        secondary=_places(cause.kept[1:]),
        help="`assume` what the world never does, or give the controller time to answer",
        example=shown,
    )


def ask_of_obligations(study: Study) -> Iterator[Finding]:
    """An error if the world can keep properties without clocks from being fulfilled; a note for others to be fulfilled.

    Here the world sets its values at each step first, in favour of the controller.
    """
    if not study.controls:
        return
    own = [s for s in game_of(study, controllers(study.controls)).kept if s.is_contingent]
    owed = [subject for subject in own if not study.languages.is_closed(study.words[subject.number])]
    for subject in owed:
        if not _is_plain(subject):
            yield _not_decided(study, subject)
    cause = [subject for subject in own if _is_plain(subject)]
    if any(subject in owed for subject in cause) and not _can_fulfil(study, cause):
        for subject in sorted(cause, key=owed.__contains__):
            fewer = [each for each in cause if each is not subject]
            cause = cause if _can_fulfil(study, fewer) else fewer
        if any(subject in owed for subject in cause):
            yield _unfulfilled(study, cause)


def _is_plain(subject: Subject) -> bool:
    """Whether neither time nor the past decides a property."""
    return not subject.is_timed


def _can_fulfil(study: Study, subjects: Sequence[Subject]) -> bool:
    from ltlc.automata.queries import can_be_kept

    atoms = {atom.name: atom.condition for subject in subjects for atom in subject.specification.atoms}
    sent = {
        name
        for name, condition in atoms.items()
        if any(topic in study.controls for read in reads_of(condition) for topic in topics_of(read.signal))
    }
    return can_be_kept(conjunction(subject.formula for subject in subjects), sent, study.alphabet(subjects))


def _unfulfilled(study: Study, cause: Sequence[Subject]) -> Finding:
    return Finding(
        "LTL616",
        cause[0].specification.span,
        f"no controller of {_on(study)} can fulfil {_named(cause)}, not even one that answers at once: the world can "
        "prevent it forever",
        secondary=_places(cause[1:]),
        help="where it depends on what the world does, say so: `P implies Q`; here `assume` is not taken into account",
    )


def _not_decided(study: Study, subject: Subject) -> Finding:
    return Finding(
        "LTL690",
        subject.specification.span,
        f"not decided for `{subject.label}`: whether a controller of {_on(study)} can fulfil what is owed at its end",
        help="that is decided only where neither time nor the past matters",
    )


def _on(study: Study) -> str:
    return listed([f"`{topic}`" for topic in study.controls])


def _named(subjects: Sequence[Subject], word: str = "and") -> str:
    return listed([f"`{subject.label}`" for subject in subjects], word)


def _places(subjects: Sequence[Subject]) -> tuple[Label, ...]:
    return tuple(Label(subject.specification.span) for subject in subjects)
