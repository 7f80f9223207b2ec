"""Which requirement is verified by which property, with which verdicts, and what is not covered."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field
from enum import Enum
from pathlib import PurePath
from typing import Any

from ltlc.base.source import Source
from ltlc.dataclass import dataclass
from ltlc.monitoring.campaigns.outcomes import Outcome, PropertyOutcome
from ltlc.monitoring.campaigns.tally import Result, kind_of
from ltlc.specification.requirements import Requirement
from ltlc.specification.specification import PropertySpecification, Specification


class State(Enum):
    """How a requirement or a property stands, the worst first; results that are stale count for nothing."""

    VIOLATED = "violated"
    NO_PROPERTY = "no property"
    NOT_RUN = "not run"
    OPEN = "open"
    """An obligation is open, or a property never began, or a recording was not judged whole."""
    IDLE = "never triggered"
    HOLDS = "holds"


@dataclass(frozen=True, slots=True)
class Judged:
    """What a recording has shown of a property.

    `recording` is its name as the campaign had it, `files` are its files with their SHA-256, as in `provenance`. The
    property was `triggered` so many times, None if it has neither scopes nor instances. It was decided at `offset`
    seconds since the beginning of the recording. The result `is_stale` if it is of another text of the specification;
    `error` is what kept the recording from being judged whole.
    """

    recording: str
    files: Sequence[Mapping[str, Any]]
    result: Result
    triggered: int | None
    offset: float | None
    is_stale: bool
    error: str | None

    @property
    def state(self) -> State:
        """How the property stands after this recording alone."""
        if self.is_stale:
            return State.NOT_RUN
        if self.error is not None and self.result is not Result.VIOLATED:
            return State.OPEN
        return _STATES[self.result]


_STATES = {
    Result.VIOLATED: State.VIOLATED,
    Result.OWED: State.OPEN,
    Result.NOT_STARTED: State.OPEN,
    Result.NEVER_TRIGGERED: State.IDLE,
    Result.PRESUMABLY_SATISFIED: State.HOLDS,
    Result.SATISFIED: State.HOLDS,
}


@dataclass(slots=True)
class Traced:
    """A property, the requirement that it states, and what recordings have shown of it."""

    source: Source
    label: str
    line: int
    text: str
    requirement: Requirement | None
    judged: list[Judged] = field(default_factory=list)

    @property
    def place(self) -> str:
        """Where it stands: `nav.ltlc:6`."""
        return f"{self.source.name}:{self.line}"

    @property
    def ids(self) -> dict[str, str]:
        """The requirements that it verifies, each with the attribute that says so: its own, and what that derives from.

        A requirement without an id is none of them.
        """
        attributes = self.requirement.attributes if self.requirement else {}
        return {id: key for key in ("id", "verifies") for id in attributes.get(key, ())}

    @property
    def fresh(self) -> list[Judged]:
        """What recordings have shown of the property as it is now."""
        return [each for each in self.judged if not each.is_stale]

    @property
    def triggered(self) -> int | None:
        """How often it was, in all recordings; None if it has neither scopes nor instances, or was not run."""
        counts = [each.triggered for each in self.fresh if each.triggered is not None]
        return sum(counts) if counts else None

    @property
    def state(self) -> State:
        """The worst of all recordings, but that one in which it was triggered is enough."""
        states = {each.state for each in self.fresh}
        if State.HOLDS in states:
            states.discard(State.IDLE)
        return worst(states)


@dataclass(slots=True)
class Covered:
    """A requirement by its id, its text if that is known, and the properties that verify it."""

    id: str
    text: str
    properties: list[Traced] = field(default_factory=list)
    is_listed: bool = True

    @property
    def is_derived_from(self) -> bool:
        """Whether it is that of another document, and not only a property's own."""
        return any(each.ids[self.id] == "verifies" for each in self.properties)

    @property
    def state(self) -> State:
        """The worst of its properties; without any it is not covered."""
        return worst(each.state for each in self.properties) if self.properties else State.NO_PROPERTY


def worst(states: Iterable[State]) -> State:
    """The worst of `states`; without any, nothing was run."""
    order = list(State)
    return min(states, key=order.index, default=State.NOT_RUN)


@dataclass(slots=True)
class Matrix:
    """Requirements and properties with what recordings have shown.

    `unread` are recordings that could not be judged at all, each with the reason; `stale` are names of specifications
    whose results are of another text, each with the number of recordings; `foreign` the same of specifications that
    were not given. It `has_results` if some were given, and a `has_list` of requirements that have to be covered.
    """

    sources: list[Source]
    requirements: list[Covered]
    properties: list[Traced]
    has_list: bool
    has_results: bool = False
    unread: list[tuple[str, str]] = field(default_factory=list)
    stale: dict[str, int] = field(default_factory=dict)
    foreign: dict[str, int] = field(default_factory=dict)

    @property
    def uncovered(self) -> list[Covered]:
        """The requirements that no property verifies."""
        return [each for each in self.requirements if not each.properties]

    @property
    def unlisted(self) -> list[Covered]:
        """The requirements that properties derive from and the list does not have, which may be misspelt."""
        return [each for each in self.requirements if self.has_list and not each.is_listed and each.is_derived_from]

    @property
    def untraced(self) -> list[Traced]:
        """The properties that verify no requirement."""
        return [each for each in self.properties if not each.ids]

    @property
    def not_run(self) -> list[Traced]:
        """The properties that no recording tests as they are now."""
        return [each for each in self.properties if not each.fresh]

    @property
    def exit_code(self) -> int:
        """1 if a requirement is violated or has no property; otherwise 3 if one does not hold yet; otherwise 0.

        Without results only properties are asked for.
        """
        states = {each.state for each in self.requirements} | {each.state for each in self.properties}
        if states & {State.VIOLATED, State.NO_PROPERTY}:
            return 1
        return 3 if self.has_results and (self.unread or states & {State.NOT_RUN, State.OPEN, State.IDLE}) else 0


def matrix_of(specifications: Sequence[Specification], listed: Mapping[str, str] | None) -> Matrix:
    """The matrix of the properties, without results; `listed` are the requirements that must be covered, with texts."""
    properties = [_traced(each, spec.source) for spec in specifications for each in spec.properties]
    covered = {id: Covered(id, text) for id, text in (listed or {}).items()}
    for each in properties:
        for id, key in each.ids.items():
            found = covered.setdefault(id, Covered(id, "", is_listed=False))
            found.properties.append(each)
            if key == "id" and each.requirement:
                found.text = found.text or each.requirement.text
    return Matrix([each.source for each in specifications], list(covered.values()), properties, listed is not None)


def _traced(of: PropertySpecification, source: Source) -> Traced:
    return Traced(source, of.label, of.line, of.text, of.requirement)


def add_results(matrix: Matrix, outcomes: Iterable[Outcome]) -> None:
    """Take in what a campaign has kept: the results of properties by specification and label."""
    matrix.has_results = True
    by_name = {(each.source.name, each.label): each for each in matrix.properties}
    for outcome in outcomes:
        made_of = outcome.report.get("provenance", {"specifications": [], "recordings": []})
        [judged_by] = made_of["specifications"] or [{"name": "", "sha256": ""}]
        source = _source_of(matrix, judged_by, outcome)
        name = outcome.place.name
        if source is None:
            told = judged_by["name"] or "a specification"
            matrix.foreign[told] = matrix.foreign.get(told, 0) + 1
            continue
        is_stale = judged_by["sha256"] != source.sha256
        if is_stale:
            matrix.stale[source.name] = matrix.stale.get(source.name, 0) + 1
        elif not outcome.is_judged and outcome.error is not None:
            matrix.unread.append((name, str(outcome.error["message"])))
        for found in outcome.properties:
            if traced := by_name.get((source.name, found.label)):
                traced.judged.append(_judged(name, made_of["recordings"], outcome, found, is_stale))


def _source_of(matrix: Matrix, judged_by: Mapping[str, str], outcome: Outcome) -> Source | None:
    """The specification that a result is of: the same text, or the same name, or the same file in another folder."""
    file = next((str(each.report["file"]) for each in outcome.properties), judged_by["name"])
    by_text = (each for each in matrix.sources if each.sha256 == judged_by["sha256"])
    by_name = (each for each in matrix.sources if each.name == judged_by["name"])
    by_file = (each for each in matrix.sources if PurePath(each.name).name == PurePath(file).name)
    return next((found for found in (*by_text, *by_name, *by_file)), None)


def _judged(
    recording: str, files: Sequence[Mapping[str, Any]], outcome: Outcome, found: PropertyOutcome, is_stale: bool
) -> Judged:
    decided, error = found.report["decided_at"], outcome.error
    unread = "only a part of it was judged" if outcome.report.get("is_part") else None
    offset = None if decided is None else decided.get("offset")
    return Judged(
        recording,
        files,
        kind_of(found),
        _triggered(found),
        offset,
        is_stale,
        unread if error is None else error["message"],
    )


def _triggered(found: PropertyOutcome) -> int | None:
    """How many episodes opened, or how many ids or messages a property was judged for."""
    episodes: int | None = found.report["episodes"]
    each = found.report.get("each")
    if episodes is not None or each is None:
        return episodes
    started: int | None = each.get("started")
    return started
