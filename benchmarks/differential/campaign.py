"""One case of the campaign: what is drawn from a seed, judged in every way, and compared with the reference."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

from benchmarks.differential import files, reference, targets
from benchmarks.differential.compare import PERMANENT, Continued, compared, refuted
from benchmarks.differential.draw import Draw
from benchmarks.differential.reference import Judged, Property
from benchmarks.differential.samples import Recording
from benchmarks.differential.targets import By, Monitors


@dataclass(frozen=True)
class Difference:
    """A property that a way judges otherwise than the reference, or a way that fails."""

    way: str
    label: str
    problem: str
    text: str
    recording: Recording
    since: int | None = None
    until: int | None = None


@dataclass
class Outcome:
    """What was compared: by way, the steps of properties up to their verdict; and what differs."""

    steps: Counter[str] = field(default_factory=Counter)
    runs: Counter[str] = field(default_factory=Counter)
    early: int = 0
    late: int = 0
    differences: list[Difference] = field(default_factory=list)


def outcome(seed: int, having: str = "", properties: int = 10, recordings: int = 12) -> Outcome:
    """All that is drawn from a seed, judged and compared: properties whose text has `having` in it."""
    chance = Random(seed)
    draw, found = Draw(chance, having), Outcome()
    text = draw.specification(properties)
    try:
        of = targets.monitors(text)
    except targets.UnusableError:
        found.runs["not translated"] += 1
        return found
    read = reference.properties(text)
    topics = sorted({topic for each in read.values() for topic in each.reads.all_topics} | {"/flag"})
    for _ in range(recordings):
        recording = draw.recording(topics, chance.random() < 0.6)
        judge_one(found, of, read, recording, chance)
    return found


def judge_one(
    found: Outcome, of: Monitors, properties: Mapping[str, Property], recording: Recording, chance: Random
) -> None:
    """A recording, in every way."""
    known: dict[tuple[int, int, int], dict[str, Expected]] = {}

    def expect(part: Recording) -> dict[str, Expected]:
        key = (part.begin, part.end, len(part.rows))
        if key not in known:
            known[key] = expected(properties, part)
        return known[key]

    whole = reference.whole_run(properties, recording)
    for way in [*targets.IN_MEMORY, "Python"]:
        take(found, of, properties, Case(way, recording, whole, None, None), expect(whole), chance)
    forms = [*files.TABLES, *files.bag_forms(recording.rows)]
    chosen = chance.sample(forms, min(3, len(forms)))
    for form in chosen:
        since, until = files.ends(chance, recording)
        part = files.cut(recording, files.is_bag(form), since, until)
        if part is None:
            continue
        part = reference.whole_run(properties, part)
        take(found, of, properties, Case(form, recording, part, since, until), expect(part), chance)


Expected = tuple[Judged, Continued]
"""What the reference says of a property, and what speaks against a verdict that comes before it says one."""


def expected(properties: Mapping[str, Property], part: Recording) -> dict[str, Expected]:
    """What the reference says of every property on a recording."""
    return {name: (reference.judged_alone(each, part), refuted(each, part)) for name, each in properties.items()}


@dataclass(frozen=True)
class Case:
    """A way, a recording, what is judged of it, and the times that were given for that."""

    way: str
    recording: Recording
    part: Recording
    since: int | None
    until: int | None


def take(
    found: Outcome,
    of: Monitors,
    properties: Mapping[str, Property],
    case: Case,
    wanted: Mapping[str, Expected],
    chance: Random,
) -> None:
    """Judge in one way, and compare."""
    try:
        results = judged(of, properties, case, wanted, chance)
    except Exception as error:  # whatever ltlc raises is a finding
        problem = f"{type(error).__name__}: {error}"
        found.differences.append(Difference(case.way, "", problem, of.text, case.recording, case.since, case.until))
        return
    for label, result in results.items():
        said, is_refuted = wanted[label]
        one = compared(said, result, is_refuted)
        found.steps[case.way] += live(said)
        found.runs[case.way] += 1
        found.early += one.early
        found.late += one.late
        if one.problem:
            what = Difference(case.way, label, one.problem, of.text, case.recording, case.since, case.until)
            found.differences.append(what)


def judged(
    of: Monitors, properties: Mapping[str, Property], case: Case, wanted: Mapping[str, Expected], chance: Random
) -> By:
    """What a way finds."""
    if case.way == "Python":
        return targets.by_python(of, case.part, properties, {label: said.run for label, (said, _) in wanted.items()})
    if case.way in targets.IN_MEMORY:
        return targets.IN_MEMORY[case.way](of, case.recording, chance)
    with TemporaryDirectory() as folder:
        path = files.write(case.way, Path(folder), of, case.recording)
        return targets.by_file(of, path, case.since, case.until)


def live(of: Judged) -> int:
    """The steps up to the permanent verdict: after it, no monitor does anything."""
    if of.verdict not in PERMANENT:
        return of.steps
    decided = of.changes[-1][0]
    return sum(step.time <= decided for step in of.run.steps)


def seeds(first: int, every: int, done: set[int]) -> Iterator[int]:
    """The seeds that are still to be taken."""
    seed = first
    while True:
        if seed not in done:
            yield seed
        seed += every
