"""On a recording: the monitors' verdicts, from which step on the choice matters, and which bounds would change it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from pathlib import Path

from ltlc.analysis.comparison.other_bounds import LARGEST, Bound, NotKnownError, Range
from ltlc.analysis.comparison.results import Answer, Ending, Measured, Monitored, OtherBounds, Parting, Recorded, Values
from ltlc.analysis.time_bounds import TimeBound, time_bounds
from ltlc.analysis.wording import part_text
from ltlc.base.diagnostics import Diagnostic
from ltlc.compiler import Compiled
from ltlc.monitoring.judging.run import run
from ltlc.runtime.properties import Change
from ltlc.runtime.tracking import Track
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.encodings import Encoding, reads_time
from ltlc.semantics.instants import Observation, Step
from ltlc.semantics.timed_atoms import Age, timed_atoms
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.evaluation import letter
from ltlc.specification.specification import PropertySpecification, Specification


def judge_recording(
    path: Path, specification: Specification, answers: Sequence[Answer], encodings: Sequence[Encoding]
) -> tuple[list[Recorded] | None, tuple[Diagnostic, ...]]:
    """What the recording at `path` shows of each of `answers`, which are those of `specification` in its order.

    None if it cannot be used; the diagnostics say why, or what is odd about it.
    """
    by_name = {encoding.name: encoding for encoding in encodings}
    compiled, owners = [], []
    for number, (property_, answer) in enumerate(zip(specification.properties, answers, strict=True)):
        for measured in answer.measured:
            if isinstance(measured.monitored, Monitored):
                labelled = replace(property_, label=f"{property_.label} ({measured.name})")
                compiled.append(
                    Compiled(labelled, by_name[measured.name], measured.formula, measured.monitored.monitor)
                )
                owners.append((number, measured))
    report = run(compiled, specification, path, keep_verdicts=True)
    if report.session is None:
        return None, report.diagnostics
    tracks: list[dict[str, Track]] = [{} for _ in answers]
    bounds: list[list[OtherBounds]] = [[] for _ in answers]
    observed: dict[int, Observation] = {}
    for (number, measured), of, track in zip(owners, compiled, report.session.tracks, strict=True):
        tracks[number][measured.name] = track
        if track.steps and reads_time(of.specification.property):
            if number not in observed:
                observed[number] = _observed(of.specification, track, report.session.time or 0)
            bounds[number] += _other_bounds(specification, of, measured, track, observed[number])
    found = zip(tracks, bounds, strict=True)
    return [_recorded(str(path), *of_property) for of_property in found], report.diagnostics


def _recorded(recording: str, tracks: Mapping[str, Track], bounds: Sequence[OtherBounds]) -> Recorded:
    steps = max((track.steps for track in tracks.values()), default=0)
    final = {name: track.verdict for name, track in tracks.items()}
    partings = (_parting(*pair, tracks) for pair in combinations(tracks, 2))
    return Recorded(recording, steps, final, tuple(p for p in partings if p is not None), tuple(_joined(bounds)))


def _joined(bounds: Sequence[OtherBounds]) -> list[OtherBounds]:
    """Those that differ in their candidates only as one."""
    found: list[OtherBounds] = []
    for each in bounds:
        same = next((n for n, other in enumerate(found) if replace(other, names=each.names) == each), None)
        if same is None:
            found.append(each)
        else:
            found[same] = replace(each, names=(*found[same].names, *each.names))
    return found


def _parting(left: str, right: str, tracks: Mapping[str, Track]) -> Parting | None:
    """Where the verdicts of two candidates are different first."""
    said = {left: Verdict.NOT_STARTED, right: Verdict.NOT_STARTED}
    changes = [(_order(change), name, change) for name in said for change in tracks[name].changes]
    changes.sort(key=lambda each: each[0])
    for number, (order, name, change) in enumerate(changes, 1):
        said[name] = change.current
        is_last = number == len(changes) or changes[number][0] != order
        if is_last and said[left] is not said[right]:
            moment = change.moment
            values = _values(tracks[left], moment.step)
            return Parting(left, right, moment.step, said[left], said[right], moment.time, moment.by_time, values)
    return None


def _order(change: Change) -> tuple[int, Nanoseconds, bool]:
    """Clock steps come after their step, and before the next."""
    moment = change.moment
    return moment.step, moment.time, moment.by_time


def _values(track: Track, step: int) -> Values:
    """The values that a step was judged on."""
    return dict(zip(map(str, track.property.inputs), track.values[step], strict=True))


def _other_bounds(
    specification: Specification, compiled: Compiled, measured: Measured, track: Track, observed: Observation
) -> Iterator[OtherBounds]:
    """For each bound on time of a property, what others would have shown."""
    for bound in time_bounds(compiled.specification.property):
        text = part_text(specification.source, compiled.specification, bound.path)
        try:
            endings = tuple(_ending(each, track) for each in _ranges(compiled, bound, observed))
            yield OtherBounds((measured.name,), text, bound.duration, endings)
        except NotKnownError as error:
            yield OtherBounds((measured.name,), text, bound.duration, (), str(error))


def _ranges(compiled: Compiled, bound: TimeBound, observed: Observation) -> list[Range]:
    """Raises NotKnownError."""
    ages = any(isinstance(atom, Age) for atom in timed_atoms(compiled.formula))
    if ages and compiled.machine.waits_for:
        raise NotKnownError("an age is measured from before the first step")
    of = Bound(compiled.specification.property, bound.path, compiled.encoding, compiled.specification.alphabet)
    return of.ranges(observed)


def _observed(property_: PropertySpecification, track: Track, end: Nanoseconds) -> Observation:
    """The run that a property was judged on."""
    reads = property_.reads()
    steps: list[Step] = []
    for time, values, before in zip(track.times, track.values, [None, *track.values], strict=False):
        same = steps[-1].letter if values == before else None
        now = same or letter(property_.atoms, dict(zip(reads, track.property.given(values), strict=True)))
        steps.append(Step(time, now or frozenset()))
    return Observation(tuple(steps), end, track.times[0])


def _ending(of: Range, track: Track) -> Ending:
    most = None if of.most == LARGEST else of.most
    if of.step is None:
        return Ending(of.least, most, of.verdict)
    return Ending(of.least, most, of.verdict, of.step, track.times[of.step], _values(track, of.step))
