"""Whether the regions in a file of certificates are those of a specification's guards, and closed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ltlc.assurance.certificates import Checked, Unreadable
from ltlc.dataclass import dataclass
from ltlc.semantics.arenas import Arena, Region
from ltlc.semantics.certificate_reader import UnreadableError, parse
from ltlc.semantics.certificate_text import Entry
from ltlc.semantics.diagrams import of_predicate
from ltlc.semantics.encodings import ENCODINGS, encode
from ltlc.semantics.intervals import without_intervals
from ltlc.semantics.region_check import objection
from ltlc.semantics.region_reader import RegionRead, guards_of, read_region
from ltlc.semantics.region_text import GuardEntry, heading
from ltlc.specification.arenas import Property, arena_of, is_in_game, together
from ltlc.specification.guards import Guard
from ltlc.specification.specification import PropertySpecification, Specification


@dataclass(frozen=True, slots=True)
class GuardChecked:
    """What was found of guards that are one game, and the properties that they keep and rely on."""

    label: str
    objection: str | None
    keeps: tuple[str, ...]
    assumes: tuple[str, ...]


def check_guards(
    specification: Specification, checked: Sequence[Checked], text: str, encoding: str
) -> list[GuardChecked] | Unreadable:
    """What the regions in `text` prove of the guards of `specification`; its certificates are `checked`."""
    numbers = {entry.label: number for number, entry in enumerate(parse(text))}
    found = list(guards_of(text))
    sets = together(specification.guards, specification.properties)
    answers = []
    for number, guards in enumerate(sets):
        own = [each for each in specification.properties if is_in_game(each, guards)]
        lines = found[number] if number < len(found) else None
        try:
            why = _objection(specification, guards, _entries(own, checked), numbers, lines, encoding)
        except UnreadableError as error:
            return Unreadable(error.line, error.message)
        labels = ([p.label for p in own if p.is_assumed is assumed] for assumed in (False, True))
        name = ", ".join(f"{guard.raw} to {guard.out}" for guard in guards)
        answers.append(GuardChecked(name, why, *map(tuple, labels)))
    surplus = (" ".join(lines[0][1].split(" ")[2:]) for lines in found[len(sets) :])
    return answers + [GuardChecked(label, "the specification has no such guard", (), ()) for label in surplus]


def _entries(
    properties: Sequence[PropertySpecification], checked: Sequence[Checked]
) -> list[tuple[PropertySpecification, Entry | None]]:
    """The certificate of each property, if it shows what the guard needs: of one that is kept, that it is exact."""
    by_label = {each.label: each for each in checked}
    return [
        (each, by_label[each.label].certified if each.is_assumed or by_label[each.label].passed else None)
        for each in properties
    ]


def _objection(
    specification: Specification,
    guards: tuple[Guard, ...],
    entries: Sequence[tuple[PropertySpecification, Entry | None]],
    numbers: Mapping[str, int],
    lines: list[tuple[int, str]] | None,
    encoding: str,
) -> str | None:
    """Why the region in `lines` does not show that `guards` keep their properties. Raises UnreadableError."""
    if lines is None:
        return "it has no region"
    properties = []
    for each, entry in entries:
        if entry is None:
            return f"{each.label} is not"
        formula = encode(without_intervals(each.property), ENCODINGS[encoding])
        properties.append(Property(each, formula, entry.certificate.monitor))
    arena = arena_of(guards, properties)
    region = read_region(lines, arena)
    at = tuple((specification.source.position(guard.span.start).line, guard.raw, guard.out) for guard in guards)
    own = GuardEntry(
        at, specification.lead, arena, Region({}, {}, {}), tuple(numbers[each.label] for each, _ in entries)
    )
    for expected, said in zip(heading(own), region.heading, strict=False):
        if expected != said:
            return f"it is of another guard: '{said}' should be '{expected}'"
    if len(heading(own)) != len(region.heading):
        return "it is of another guard"
    if not _is_assumption(arena, region):
        return "it assumes more about its conditions than their arithmetic gives"
    return objection(arena, region)


def _is_assumption(arena: Arena, region: RegionRead) -> bool:
    """Whether every letter that exists is one that the region speaks of."""
    assert region.assumption is not None
    diagrams, levels = region.diagrams, {name: level for level, name in enumerate(arena.read)}
    possible = of_predicate(arena.alphabet.as_formula(), diagrams, levels)
    return diagrams.conjunction(possible, diagrams.negation(region.assumption)) == diagrams.false
