"""Is there a part of the text that makes no difference to the meaning?

Inherent vacuity (Fisman, Kupferman, Sheinvald-Faragy and Vardi, *A framework for inherent vacuity*, 2009), on the tree
of the language: a part makes no difference if the property means the same with it always true, or always false. An
event as a whole must make no difference in both ways: what opens a scope may follow from what closes it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ltlc.analysis.findings import Finding
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import all_parts, part_text
from ltlc.semantics.encodings import encode
from ltlc.semantics.ltl import FALSE, TRUE, Formula
from ltlc.semantics.properties import After, AfterUntil, Now, Property, Throughout, Until
from ltlc.specification.specification import Path, parts


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A warning for each part that can be left out, the smallest such parts; none inside another."""
    if not subject.is_contingent:
        return
    source, specification = study.specification.source, subject.specification
    for path, truth in vacuous(study, subject):
        text = part_text(source, specification, path)
        yield Finding(
            "LTL504",
            specification.spans[path],
            f"`{text}` makes no difference to `{subject.label}`",
            label=f"the property means the same if this {'always' if truth else 'never'} holds",
            help="leave it out, or check whether it says what is meant",
        )


def vacuous(study: Study, subject: Subject) -> list[tuple[Path, bool]]:
    """The parts that make no difference, each with the truth it can be replaced by.

    They are replaced one after the other, those on the right first: of two equal parts one has to stay. Where all that
    a part consists of makes no difference, it is the part itself that does not.
    """
    found: dict[Path, bool] = {}
    current = subject.specification.property
    for path, part in all_parts(subject.specification.property):
        if not path or _is_constant(part):
            continue
        inside = [other for other in found if other[: len(path)] == path]
        if inside and sum(len(other) == len(path) + 1 for other in inside) < max(2, len(parts(part))):
            continue
        truths = _truths(study, subject, current, path)
        if not truths or (_is_event(subject.specification.property, path) and len(truths) < 2):
            continue
        for other in inside:
            del found[other]
        found[path] = truths[0]
        current = replaced(current, path, truths[0])
    return sorted(found.items())


def _is_constant(part: Property | Formula) -> bool:
    return part in (TRUE, FALSE, Now(TRUE), Now(FALSE), Throughout(TRUE), Throughout(FALSE))


def _is_event(node: Property | Formula, path: Path) -> bool:
    """Whether the part at `path` is an event of a scope."""
    for index in path[:-1]:
        node = parts(node)[index]
    events = 2 if isinstance(node, AfterUntil) else 1 if isinstance(node, After | Until) else 0
    return path[-1] < events


def _truths(study: Study, subject: Subject, current: Property, path: Path) -> Sequence[bool]:
    """The truths that the part at `path` of `current` can be replaced by without a difference."""
    languages, original = study.languages, study.words[subject.number]
    same = []
    for truth in (True, False):
        other = languages.of(encode(replaced(current, path, truth), study.encoding))
        if languages.implies([original], other) and languages.implies([other], original):
            same.append(truth)
    return same


def replaced(property_: Property, path: Path, truth: bool) -> Property:
    """`property_` with `true` or `false` for the part at `path`."""
    if not path:
        return Now(TRUE if truth else FALSE)
    result = _replaced(property_, path, TRUE if truth else FALSE)
    if not isinstance(result, Property):
        raise TypeError(f"not a property: {result!r}")
    return result


def _replaced(node: Property | Formula, path: Path, constant: Formula) -> Property | Formula:
    if not path:
        return constant if isinstance(node, Formula) else Now(constant)
    inside = list(parts(node))
    inside[path[0]] = _replaced(inside[path[0]], path[1:], constant)
    if isinstance(node, Now | Throughout):
        return type(node)(type(node.predicate)(*inside))
    return type(node)(*inside)
