"""The results of a campaign so far, in numbers: the outcomes of each property, and where it failed first."""

from __future__ import annotations

from collections import Counter
from dataclasses import field
from enum import Enum
from statistics import median
from typing import NamedTuple

from ltlc.dataclass import dataclass
from ltlc.monitoring.campaigns.outcomes import Outcome, PropertyOutcome
from ltlc.runtime import reports
from ltlc.runtime.guard_reports import counts_text
from ltlc.runtime.guarding import Action
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.verdicts import Verdict


class Result(Enum):
    """How a property came out on a recording; each has one of these."""

    VIOLATED = "violated"
    OWED = "still open"
    """Presumably violated."""
    NOT_STARTED = "not started"
    NEVER_TRIGGERED = "never triggered"
    """It holds, and no episode of it opened."""
    PRESUMABLY_SATISFIED = "presumably satisfied"
    SATISFIED = "satisfied"


_KINDS = {
    Verdict.VIOLATED: Result.VIOLATED,
    Verdict.PRESUMABLY_VIOLATED: Result.OWED,
    Verdict.NOT_STARTED: Result.NOT_STARTED,
    Verdict.PRESUMABLY_SATISFIED: Result.PRESUMABLY_SATISFIED,
    Verdict.SATISFIED: Result.SATISFIED,
}


def kind_of(found: PropertyOutcome) -> Result:
    """How the property came out."""
    kind = _KINDS[found.verdict]
    holds = kind in (Result.PRESUMABLY_SATISFIED, Result.SATISFIED)
    return Result.NEVER_TRIGGERED if holds and found.report["never_triggered"] else kind


@dataclass(frozen=True, slots=True)
class Failing:
    """A property is violated in `recording`, which is from `beginning` to `end`, both None if that is not known."""

    recording: str
    found: PropertyOutcome
    beginning: Nanoseconds | None
    end: Nanoseconds | None


class Margin(NamedTuple):
    """By how much a property holds in a recording, or is violated."""

    number: float
    recording: str


@dataclass(slots=True)
class PropertyTally:
    """How often a property came out how; where it was violated, in the order of the recordings, as far as is listed.

    If recordings were measured, `margins` are those with a number, in their order.
    """

    label: str
    text: str
    counts: dict[Result, int] = field(default_factory=lambda: dict.fromkeys(Result, 0))
    failing: list[Failing] = field(default_factory=list)
    margins: list[Margin] = field(default_factory=list)

    @property
    def median(self) -> float:
        """The middle one of the margins, of which there is one, or the mean of the middle two."""
        return median(each.number for each in self.margins)

    @property
    def is_idle(self) -> bool:
        """Whether no recording tests it: it never started, or was never triggered."""
        return not any(n for kind, n in self.counts.items() if kind not in (Result.NOT_STARTED, Result.NEVER_TRIGGERED))


LISTED = 1000
"""How many recordings that violate a property are remembered."""


@dataclass(slots=True)
class Tally:
    """What recordings have shown together: of each property, and how many recordings came out how."""

    properties: dict[str, PropertyTally] = field(default_factory=dict)
    recordings: int = 0
    codes: dict[int, int] = field(default_factory=lambda: dict.fromkeys((0, 1, 2, 3), 0))
    errors: list[tuple[str, str]] = field(default_factory=list)
    cut_short: int = 0
    """Those that were not judged to the end, and have a violation before that."""
    kept: int = 0
    again: int = 0
    extracts: int = 0
    guards: dict[str, Counter[Action]] = field(default_factory=dict)

    def add(self, outcome: Outcome, is_kept: bool = False) -> None:
        """Count a recording; one that `is_kept` was judged by an earlier campaign."""
        self.recordings += 1
        self.kept += is_kept
        self.again += outcome.tries > 1
        self.extracts += len(outcome.extracts)
        self.codes[outcome.exit_code] += 1
        is_violated = any(found.verdict is Verdict.VIOLATED for found in outcome.properties)
        self.cut_short += outcome.exit_code == 2 and is_violated
        for out, counts in outcome.guards.items():
            self.guards.setdefault(out, Counter()).update(counts)
        if outcome.error is not None:
            self.errors.append((outcome.place.name, str(outcome.error["message"])))
        for found in outcome.properties:
            of_one = self.properties.setdefault(found.label, PropertyTally(found.label, str(found.report["text"])))
            of_one.counts[kind_of(found)] += 1
            if (margin := (found.report.get("robustness") or {}).get("margin")) is not None:
                of_one.margins.append(Margin(margin, outcome.place.name))
            if found.verdict is Verdict.VIOLATED and len(of_one.failing) < LISTED:
                times = (outcome.report.get(name) for name in ("beginning_ns", "end_ns"))  # not in an older table
                of_one.failing.append(Failing(outcome.place.name, found, *times))

    @property
    def exit_code(self) -> int:
        """2 if a recording was not judged to its end, or there was none; else 1 if one violates; else 3; else 0.

        3 is a property that is still open or has not started.
        """
        if self.codes[2] or not self.recordings:
            return 2
        return next((code for code in (1, 3) if self.codes[code]), 0)

    @property
    def measured(self) -> list[PropertyTally]:
        """The properties with margins, those first that are violated most, or come closest to it."""
        return sorted((each for each in self.properties.values() if each.margins), key=lambda each: min(each.margins))

    def document(self) -> dict[str, object]:
        """The tally as an object of JSON."""
        guards = [{"out": out, **{a.value: counts[a] for a in Action}} for out, counts in self.guards.items()]
        return {
            "recordings": self.recordings,
            "violated": self.codes[1],
            "owed_or_not_started": self.codes[3],
            "hold": self.codes[0],
            "not_judged_whole": self.codes[2],
            "violated_not_judged_whole": self.cut_short,
            "judged_before": self.kept,
            "tried_again": self.again,
            "properties": [
                {"label": each.label} | {kind.name.lower(): n for kind, n in each.counts.items()} | _robustness(each)
                for each in self.properties.values()
            ],
            **({"guard": guards} if guards else {}),
        }

    def guard_sentences(self) -> list[str]:
        """What the guards did in all recordings, a line for each."""
        return [
            counts_text(out, counts, f"it lost {reports.counted(counts[Action.LOST], 'time')}")
            for out, counts in self.guards.items()
        ]

    def sentence(self) -> str:
        """The tally in one line."""
        among = f", {self.cut_short} of these with a violation before that" if self.cut_short else ""
        told = {
            f"with a violation{' or a guard that lost' if self.guards else ''}": self.codes[1],
            "with something still open or not started": self.codes[3],
            "in which all properties hold": self.codes[0],
            f"not judged to the end{among}": self.codes[2],
            "judged before": self.kept,
            "tried again": self.again,
        }
        parts = [f"{count} {what}" for what, count in told.items() if count]
        return f"{reports.counted(self.recordings, 'recording')}: {', '.join(parts) or 'nothing was judged'}"


def _robustness(of_one: PropertyTally) -> dict[str, object]:
    if not of_one.margins:
        return {}
    least, recording = min(of_one.margins)
    found = {"least": least, "recording": recording, "median": of_one.median, "measured": len(of_one.margins)}
    return {"robustness": found}


def brief(outcome: Outcome) -> str:
    """A line for a recording: how many of its properties came out how, and what kept it from being judged whole."""
    kinds = [kind_of(found) for found in outcome.properties]
    parts = [f"{kinds.count(kind)} {kind.value}" for kind in Result if kind in kinds]
    if outcome.error is not None:
        parts.append(f"{'judged up to the damage' if outcome.is_judged else 'not judged'}: {outcome.error['message']}")
    if outcome.not_cut:
        parts.append(f"an extract is missing: {outcome.not_cut}")
    return reports.printable(f"{outcome.place.name}: {', '.join(parts)}")
