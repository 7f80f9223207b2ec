"""Do the published readings of the scope keywords give the property another meaning?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.errors import DisagreementError
from ltlc.analysis.examples import example_of
from ltlc.analysis.findings import Finding
from ltlc.analysis.search import shortest
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import listed, part_text
from ltlc.automata import translate
from ltlc.semantics.denotation import READINGS, satisfies
from ltlc.semantics.encodings import DWYER, EPISODE, POINTWISE, encode, has_bounds
from ltlc.semantics.properties import After, AfterUntil, Property, Throughout, children
from ltlc.semantics.words import Word

COMPARED = (EPISODE, POINTWISE, DWYER)

NAMES = {
    EPISODE.name: "as episodes",
    POINTWISE.name: "literally",
    DWYER.name: "as in the specification patterns",
}
"""What the readings are called in messages."""


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A note with the shortest run on which the readings differ; none of bounds, for which there is one reading."""
    property_ = subject.specification.property
    if not _has_scope(property_) or has_bounds(property_):
        return
    word = _shortest_difference(subject)
    if word is None:
        return
    judged = {e.name: satisfies(word, subject.specification.property, READINGS[e.name]) for e in COMPARED}
    if len(set(judged.values())) == 1:
        raise DisagreementError("how a run is judged")
    yield Finding(
        "LTL512",
        subject.specification.span,
        f"the readings of `{subject.label}` differ: {_verdicts(judged)}",
        help=_help(study, subject),
        example=example_of(study.setting(subject), word, "the shortest run on which the readings differ"),
    )


def _has_scope(property_: Property) -> bool:
    return isinstance(property_, After | AfterUntil) or any(map(_has_scope, children(property_)))


def _shortest_difference(subject: Subject) -> Word | None:
    """The shortest run that not all readings judge alike."""
    formulas = dict.fromkeys(encode(subject.specification.property, encoding) for encoding in COMPARED)
    if len(formulas) == 1:
        return None
    monitored = [(formula, translate(formula, subject.alphabet)) for formula in formulas]
    return shortest(monitored, subject.alphabet, lambda verdicts: len({v.holds for v in verdicts}) > 1, subject.shut)


def _verdicts(judged: dict[str, bool]) -> str:
    """The verdicts of the readings on the run."""
    yes = [NAMES[name] for name, holds in judged.items() if holds]
    no = [NAMES[name] for name, holds in judged.items() if not holds]
    return f"{listed(yes)}, the run below satisfies it; {listed(no)}, it does not"


def _help(study: Study, subject: Subject) -> str:
    """How to write another reading."""
    chosen = f"this is read with `--encoding {study.encoding.name}`"

    def text(*path: int) -> str:
        return part_text(study.specification.source, subject.specification, path)

    if subject.specification.openings():  # under `always`, there are several openings
        return f"{chosen}; `ltlc compare` shows the others"
    match subject.specification.property:
        case AfterUntil():
            return f"{chosen}; to judge anew from every step with the event, write `always ({text()})`"
        case After(_, body):
            again = f"always {text(1)}" if isinstance(body, Throughout) else text(1)
            anew = f"always ({text(0)} implies always ({again}))"
            return f"{chosen}; to judge anew from every later step, write `{anew}`"
        case _:
            return f"{chosen}; `ltlc compare` shows the others"
