"""Is there a part of the text that makes no difference to the meaning?

Inherent vacuity (Fisman, Kupferman, Sheinvald-Faragy and Vardi, *A framework for inherent vacuity*, 2009), on the tree
of the language: a part makes no difference if the property means the same with it always true, or always false.

An episode opens with X and not Y, so what opens it may follow from what closes it, as in `after_until not p, p, …`. Of
an event, therefore, a part makes no difference if the event holds at the same steps without it, or if it does not
matter which of the two replaces it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ltlc.analysis.findings import Finding
from ltlc.analysis.predicates import is_possible
from ltlc.analysis.questions.held_trigger import broken_at_once
from ltlc.analysis.questions.never_triggered import impossible
from ltlc.analysis.reasons import constant
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import all_parts, part_at, part_text, with_part
from ltlc.semantics import ltl
from ltlc.semantics.ltl import FALSE, TRUE, Formula
from ltlc.semantics.properties import (
    SOME_STEP,
    After,
    AfterUntil,
    Eventually,
    Implies,
    Not,
    Now,
    Property,
    Throughout,
    Until,
    Within,
)
from ltlc.specification.arenas import topics_read
from ltlc.specification.specification import Path, parts


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A warning for each part that can be omitted, the smallest such parts; none inside another.

    None in a scope that no run opens, nor about an interval that excludes its own trigger: that is reported.
    """
    if not subject.is_contingent:
        return
    found = vacuous(study, subject)
    dead = [event.path[:-1] for event in impossible(study, subject) if event.opens] if found else []
    dead += [interval.path[:-1] for interval in broken_at_once(subject)]
    for path, truth in found:
        if any(path[: len(scope)] == scope for scope in dead) or _leaves_again(subject, path):
            continue
        if not _fallbacks_need(study, subject, path):
            yield _finding(study, subject, path, truth)


def _fallbacks_need(study: Study, subject: Subject, path: Path) -> bool:
    """Whether the part asks for what a fallback of a guard sends.

    After `stop` a guard knows the first of `speed == 0 or speed * x <= 0`, but not the second, from which it follows.
    """
    sent = {guard.out for guard in study.specification.guards if guard.fallbacks}
    asked = ltl.atoms(_predicate(part_at(subject.specification.property, path)))
    atoms = (atom for atom in subject.specification.atoms if atom.name in asked)
    return any(not sent.isdisjoint(topics_read(atom)) for atom in atoms)


def _leaves_again(subject: Subject, path: Path) -> bool:
    """Whether the part is P in `P implies eventually Q`, where Q only says that P ends: the plain way to say so."""
    match part_at(subject.specification.property, path[:-1]):
        case Implies(Now(premise), Eventually(Now(goal)) | Within(_, Eventually(Now(goal)))) if path[-1] == 0:
            neither = ltl.And(ltl.Not(premise), ltl.Not(goal))
            return constant(premise, subject) is None and not is_possible(neither, subject.alphabet)
    return False


def _finding(study: Study, subject: Subject, path: Path, truth: bool) -> Finding:
    text = part_text(study.specification.source, subject.specification, path)
    always = "always" if truth else "never"
    is_fixed = constant(_predicate(part_at(subject.specification.property, path)), subject) is not None
    return Finding(
        "LTL504",
        subject.specification.spans[path],
        f"`{text}` {f'{always} holds: it ' if is_fixed else ''}makes no difference to `{subject.label}`",
        label="" if is_fixed else f"the property means the same if this {always} holds",
        help="omit it, or check that it says what you mean",
    )


def _predicate(part: Property | Formula) -> Formula:
    """The state predicate that `part` is; of a temporal property, one that depends on nothing."""
    if isinstance(part, Now | Throughout):
        return part.predicate
    return part if isinstance(part, Formula) else TRUE


def vacuous(study: Study, subject: Subject) -> list[tuple[Path, bool]]:
    """The parts that make no difference, each with the truth it can be replaced by.

    They are replaced one after the other, those on the right first: of two equal parts one has to stay. Where all that
    a part consists of makes no difference, it is the part itself that does not. Of `p == q` no part is asked about:
    what it means has each side twice, the text once.
    """
    found: dict[Path, bool] = {}
    current = subject.specification.property
    equivalences = [path for path, part in all_parts(current) if _is_equivalence(part)]
    for path, part in all_parts(subject.specification.property):
        if not path or _is_constant(part) or part == SOME_STEP:
            continue
        if any(path != whole and path[: len(whole)] == whole for whole in equivalences):
            continue
        inside = [other for other in found if other[: len(path)] == path]
        if inside and not _is_all_of(part, [other[len(path) :] for other in inside]):
            continue
        truths = _truths(study, subject, current, path)
        if not truths:
            continue
        for other in inside:
            del found[other]
        found[path] = truths[0]
        current = replaced(current, path, truths[0])
    return sorted(found.items())


def _is_constant(part: Property | Formula) -> bool:
    return part in (TRUE, FALSE, Now(TRUE), Now(FALSE), Throughout(TRUE), Throughout(FALSE))


def _is_equivalence(part: Property | Formula) -> bool:
    """Whether `part` is what `p == q` means."""
    match part.predicate if isinstance(part, Now | Throughout) else part:
        case ltl.Or(ltl.And(left, right), ltl.And(ltl.Not(other_left), ltl.Not(other_right))):
            return left == other_left and right == other_right
        case _:
            return False


def _is_all_of(part: Property | Formula, inside: Sequence[Path]) -> bool:
    """Whether the parts `inside` it are all that `part` consists of: two or more, what is negated, or has a bound."""
    predicate = part.predicate if isinstance(part, Now | Throughout) else part
    if isinstance(predicate, Within):
        return (0, 0) in inside
    count = sum(len(path) == 1 for path in inside)
    return count >= len(parts(part)) and (count > 1 or isinstance(predicate, Not | ltl.Not))


def _event_around(node: Property | Formula, path: Path) -> Path | None:
    """The path of the event of a scope that the part at `path` belongs to, or is."""
    for depth, index in enumerate(path, 1):
        events = 2 if isinstance(node, AfterUntil) else 1 if isinstance(node, After | Until) else 0
        if index < events:
            return path[:depth]
        node = parts(node)[index]
    return None


def _truths(study: Study, subject: Subject, current: Property, path: Path) -> Sequence[bool]:
    """The truths that the part at `path` of `current` can be replaced by without a difference."""
    languages, original = study.languages, study.words[subject.number]
    same = []
    for truth in (True, False):
        other = study.language(replaced(current, path, truth))
        if other is not None and languages.equal(original, other):
            same.append(truth)
    event = _event_around(current, path)
    if event is None or len(same) == 2:
        return same
    return [truth for truth in same if _is_same_event(subject, current, event, path, truth)]


def _is_same_event(subject: Subject, current: Property, event: Path, path: Path, truth: bool) -> bool:
    """Whether the event holds at the same steps with `truth` at `path`; that it never holds is reported elsewhere."""
    before = part_at(current, event)
    after = with_part(before, path[len(event) :], TRUE if truth else FALSE)
    if not isinstance(before, Formula) or not isinstance(after, Formula):
        raise TypeError(f"not a state predicate: {before!r}")
    differs = ltl.Or(ltl.And(before, ltl.Not(after)), ltl.And(after, ltl.Not(before)))
    return after != FALSE and not is_possible(differs, subject.alphabet)


def replaced(property_: Property, path: Path, truth: bool) -> Property:
    """`property_` with `true` or `false` for the part at `path`."""
    constant = TRUE if truth else FALSE
    part = part_at(property_, path)
    result = with_part(property_, path, constant if isinstance(part, Formula) else Now(constant))
    if not isinstance(result, Property):
        raise TypeError(f"not a property: {result!r}")
    return result
