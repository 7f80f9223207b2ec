"""`ltlc run`: a recorded run, judged by the monitors that a node would have."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import field
from functools import cached_property
from pathlib import Path
from time import perf_counter_ns
from typing import TYPE_CHECKING, Any

from ltlc.backends.python.load import load_plan
from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic, Severity
from ltlc.base.provenance import FileDigest, provenance
from ltlc.base.source import Source
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.inputs.recordings import Block, Recording, RecordingError, open_recording
from ltlc.inputs.recordings.checks import checks_of
from ltlc.inputs.recordings.digests import digests
from ltlc.inputs.recordings.lacks import remarks, signals_of
from ltlc.inputs.recordings.reading import DEFAULT, Limit, ReadOptions
from ltlc.inputs.recordings.rows import failure
from ltlc.inputs.recordings.trails import Trail, Trailing
from ltlc.monitoring.columns.prepared import Prepared, prepare_all
from ltlc.monitoring.columns.session import ByBlocks
from ltlc.monitoring.judging.part import Part
from ltlc.monitoring.judging.violations import violations_report, violations_text
from ltlc.monitoring.later import JudgedTrack
from ltlc.monitoring.restarting import Restarting, can_recur, restarting
from ltlc.runtime import documents, junit, reports, sampling
from ltlc.runtime.properties import MonitoredProperty
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Plan, Session
from ltlc.runtime.times import seconds
from ltlc.runtime.tracking import Observer, Track
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.expressions import Field, Signal
from ltlc.specification.specification import PropertySpecification, Specification

if TYPE_CHECKING:
    from ltlc.assurance.evidence.document import Document
    from ltlc.monitoring.columns.curves import Band, Curve
    from ltlc.monitoring.columns.measuring import Measuring
    from ltlc.monitoring.guarding.recording import GuardedRecording, Guarding
    from ltlc.monitoring.guarding.report import GuardReport
    from ltlc.monitoring.judging.cutting import Cut, Cutting
    from ltlc.monitoring.judging.evidence import Evidence
    from ltlc.monitoring.judging.whole_runs import WholeRuns
    from ltlc.monitoring.letters import Letters

Watcher = Callable[[Block], None]
"""What is reported about each block once it has been judged."""


@dataclass(frozen=True)
class RunReport:
    """What a recording has shown: the state of the session at its end, or None if nothing of it could be read.

    If it `is_damaged`, it was judged up to the damage; the last of the diagnostics says what that is. There are
    `trails`, one for each property, if they were asked for. `reading` and `judging` took so long. `definitions` say by
    topic who defines its messages. `blocks` judged the session, if anything could be read. The `specification` is what
    was judged by. The recording is what is in the `file`, if it is in one; its SHA-256 is taken for a document.
    There is `evidence` if it was asked for and all could be read. It `is_part` if only the rows of some time were asked
    for. If extracts were asked for, they have been `cut`. It is the run that left guards, if there is a `guard` report.
    """

    recording: str
    session: Session | None
    diagnostics: tuple[Diagnostic, ...]
    is_damaged: bool = False
    trails: tuple[Trail, ...] = ()
    reading: Nanoseconds = 0
    judging: Nanoseconds = 0
    definitions: Mapping[str, str] = field(default_factory=dict)
    blocks: ByBlocks | None = None
    specification: Source | None = None
    file: Path | None = None
    evidence: Document | None = None
    is_part: bool = False
    cut: Cut | None = None
    guard: GuardReport | None = None
    robustness: Mapping[str, Curve] = field(default_factory=dict)
    bands: Mapping[str, Band] = field(default_factory=dict)

    @property
    def exit_code(self) -> int:
        """0 all hold; 1 one is violated, or a guard lost; 2 unusable or damaged; 3 one is unmet or never started."""
        if self.session is None or self.is_damaged or (self.cut is not None and self.cut.error):
            return 2
        if self.guard is not None and self.guard.has_lost:
            return 1
        left_out = any(slices.left_out for slices in self.session.sliced)
        return reports.exit_code([track.verdict for track in self.session.tracks], left_out)

    def text(self, with_all: bool = False) -> str:
        """The errors, each with its failing state, and a line for each property.

        If it is `with_all` violations, those after the first one follow its failing state.
        """
        session = self.session
        if session is None:
            return ""
        figures = []
        for track in session.tracks:
            if track.verdict is Verdict.VIOLATED:
                more = violations_text(session, track) if with_all and track.slices is None else ""
                figures.append(f"{reports.figure(session, track)}{more}\n")
        guarded = "" if self.guard is None else f"\n{self.guard.text(session, with_all)}"
        return "".join([*figures, reports.summary(session), self._robustness_text(session), guarded])

    def _robustness_text(self, session: Session) -> str:
        if not self.robustness:
            return ""
        from ltlc.monitoring.judging.robustness import robustness_text  # which few ask for

        return robustness_text(session, self.robustness)

    def json(self) -> str:
        """The JSON document of `ltlc run`, as text."""
        return json.dumps(self.document(), indent=2, allow_nan=False) + "\n"

    def document(self) -> dict[str, Any]:
        """The JSON document of `ltlc run`; one with `properties` null if the recording cannot be used."""
        document: dict[str, Any] = {"recording": self.recording, "steps": 0, "properties": None}
        if self.session is not None:
            document = documents.document(self.recording, self.session)
            end = self.session.time
            document |= {"end": None if end is None else seconds(end), "end_ns": end}
            for each, track in zip(document["properties"], self.session.tracks, strict=True):
                each.update(violations_report(self.session, track))
                if self.cut is not None:
                    each["extracts"] = list(self.cut.written[track.property.label])
            if self.robustness:
                from ltlc.monitoring.judging.robustness import robustness_report

                for each, curve in zip(document["properties"], self.robustness.values(), strict=True):
                    each["robustness"] = robustness_report(self.session, curve)
            if self.guard is not None:
                document["guard"] = self.guard.document(self.session)
        document["is_damaged"] = self.is_damaged
        document["is_part"] = self.is_part
        document["definitions"] = dict(self.definitions)
        document["diagnostics"] = self._diagnostics()
        if self.cut is not None:
            document["cut"] = self.cut.document()
        document["provenance"] = self.provenance()
        return document

    def provenance(self) -> dict[str, Any]:
        """What the run was judged with, and on: the object `provenance` of the JSON document."""
        return provenance(filter(None, [self.specification]), self._files)

    @cached_property
    def _files(self) -> tuple[FileDigest, ...]:
        """The files of the recording with their SHA-256, which is computed once."""
        if self.file is None:
            return ()
        return digests(self.file) if self.evidence is None else self.evidence.head.recordings

    def _diagnostics(self) -> list[dict[str, str]]:
        return [
            {"code": d.code, "name": d.name, "severity": d.severity.value, "message": d.message, "help": d.help}
            for d in self.diagnostics
        ]

    def junit(self) -> str:
        """A JUnit XML report; what kept the recording from being judged whole is an error in it."""
        told = self.diagnostics[-1:] if self.session is None or self.is_damaged else ()
        unread = [unread_case(each.code, each.message) for each in told]
        made_of = list(junit.provenance_pairs(self.provenance()))
        if self.session is None:
            return f"{junit.XML_HEAD}{junit.suite_text(self.recording, unread, (), made_of)}"
        guards = [] if self.guard is None else map(junit.guard_case, self.guard.document(self.session))
        return junit.junit(self.recording, self.session, [*guards, *unread], warnings(self._diagnostics()), made_of)


def warnings(diagnostics: Sequence[Mapping[str, str]]) -> list[str]:
    """The warnings among the `diagnostics` of a JSON document, as JUnit has them."""
    return [reports.printable(d["message"]) for d in diagnostics if d["severity"] == Severity.WARNING.value]


def unread_case(code: str, message: str) -> junit.Case:
    """The test case of a recording that was not judged to the end."""
    return junit.Case("recording", "error", code, message, f"{reports.printable(message)}\n")


class Stopwatch:
    """How long it took to get what was iterated over."""

    def __init__(self) -> None:
        self.nanoseconds = 0

    def over(self, blocks: Iterator[Block]) -> Iterator[Block]:
        """The same, watched."""
        while True:
            start = perf_counter_ns()
            try:
                block = next(blocks, None)
            finally:
                self.nanoseconds += perf_counter_ns() - start
            if block is None:
                return
            yield block


def run(
    compiled: Sequence[Compiled],
    specification: Specification,
    path: Path,
    keep_verdicts: bool = False,
    since: Limit = None,
    until: Limit = None,
) -> RunReport:
    """Judge the recording at `path`, as `Judge` does."""
    return Judge(compiled, specification, ReadOptions(since=since, until=until), keep_verdicts).judge(path)


Open = Callable[[Path, Mapping[str, Signal], ReadOptions], Recording]
"""Opens a recording, of which these signals are wanted."""


@dataclass(frozen=True)
class Judge:
    """Judges recordings by the monitors of a specification.

    With `keep_verdicts` a report has the verdict after each step, with `keep_trails` what each property went through.
    Rows are taken from the time `reading.since` on, up to and including `reading.until`. `remarks` are on the monitors,
    and stand in each report before those on the recording. It `finds_all` violations of a property, or the first one.
    The documents of its reports have the SHA-256 of the recording if it is `hashed`, which takes a moment.
    With `evidence` a report has that of its recording. With `cutting`, extracts of recordings are written. With
    `guarding`, what is judged is what guards let through. If it `measures`, reports say by how much properties hold; if
    it `foresees`, too, what that could still come to, whatever follows.
    """

    compiled: Sequence[Compiled]
    specification: Specification
    reading: ReadOptions = DEFAULT
    keep_verdicts: bool = False
    keep_trails: bool = False
    open: Open = open_recording
    remarks: tuple[Diagnostic, ...] = ()
    finds_all: bool = True
    hashed: bool = True
    evidence: Evidence | None = None
    cutting: Cutting | None = None
    guarding: Guarding | None = None
    measures: bool = False
    foresees: bool = False

    def prepare(self) -> None:
        """Make what takes other processes, before several of them judge by copies."""
        self.restarting  # noqa: B018

    def judge(self, path: Path, watchers: Sequence[Watcher] = (), name: str = "") -> RunReport:
        """What the recording at `path` shows, which has a `name` among others.

        `watchers` get what was judged, block by block.
        """
        try:
            recording, guarded = self._opened(path)
        except RecordingError as error:
            return RunReport(str(path), None, (error.diagnostic,), **self._made_of(path))
        found = self.remarks_on(path, recording)
        plan, observe = self.plan(recording.columns), Trailing if self.keep_trails else None
        session = Session(plan, self.keep_verdicts, observe, self._maker(recording.columns))
        absent = (name for name in readings(plan) if name not in recording.columns)
        session.absences = {name: recording.absence(name) for name in absent}
        digests = None if self.evidence is None else self.evidence.digests(path)
        whole = self._whole_runs(recording.columns)
        blocks, watch, start = ByBlocks(session, self.prepared, self.prepared_again), Stopwatch(), perf_counter_ns()
        damage, part = None, Part(path, recording, self.reading)
        measuring = self._measuring(session)
        try:
            self._run(blocks, whole, path, part, watch, recording.columns, watchers, measuring)
        except RecordingError as error:
            damage = error.diagnostic
        times = (watch.nanoseconds, perf_counter_ns() - start - watch.nanoseconds)
        found += [*part.remarks(), *recording.remarks(), *self._left_out(session)]
        session.zero, session.times = part.zero, self.reading.times
        if guarded is not None and session.zero is None:
            session.zero = guarded.first  # what came first may have been held back
        trails = tuple(t.observer.trail for t in session.tracks if isinstance(t.observer, Trailing))
        if damage is not None:
            found.append(damage)
        end = session.time if part.until is None else part.until
        judged = None if damage is not None and session.time is None else blocks
        evidence = None
        if self.evidence is not None and digests is not None and damage is None:
            from ltlc.monitoring.judging.evidence import Kept

            kept = Kept(_letters(session, whole), whole)
            evidence = self.evidence.document(session, kept, part, recording, self.reading, digests.files())
            found += self.evidence.not_covered(evidence, self.specification.source)
        return RunReport(
            str(path),
            None if judged is None else judged.session,
            tuple(found),
            damage is not None,
            trails,
            *times,
            recording.definitions,
            judged,
            evidence=evidence,
            cut=None if judged is None or self.cutting is None else self.cutting.cut(session, path, name),
            guard=None if guarded is None else guarded.report(part.since, part.until),
            robustness={} if measuring is None else measuring.curves(end),
            bands={} if measuring is None or not self.foresees or end is None else measuring.bands(end),
            **self._made_of(path),
        )

    def _opened(self, path: Path) -> tuple[Recording, GuardedRecording | None]:
        """The recording at `path`, and the same as guards would have let it through. Raises RecordingError."""
        if self.guarding is None:
            return self.open(path, self.signals, self.reading), None
        guarded = self.guarding.through(self.plan, self.open, path, self.signals, self.reading)
        return guarded, guarded

    def _whole_runs(self, columns: Collection[str]) -> WholeRuns | None:
        """Those that evidence needs, where samples of these signals come in themselves."""
        compiled = [] if self.evidence is None else self.evidence.whole_runs(self.compiled)
        if self.evidence is None or not compiled:
            return None
        from ltlc.monitoring.judging.whole_runs import WholeRuns  # which only evidence needs

        return WholeRuns(compiled, self.specification, self._given(columns), self.evidence.kept)

    def _measuring(self, session: Session) -> Measuring | None:
        if not self.measures:
            return None
        from ltlc.monitoring.columns.measuring import Measuring  # which few ask for

        return Measuring(session, self.compiled, self.prepared)

    def _made_of(self, path: Path) -> dict[str, Any]:
        """The provenance of a report; recordings that were opened in another way are not in files."""
        file = path if self.hashed and self.open is open_recording else None
        is_part = (self.reading.since, self.reading.until) != (None, None)
        return {"specification": self.specification.source, "file": file, "is_part": is_part}

    @cached_property
    def signals(self) -> dict[str, Signal]:
        """What is read, and what that is computed from."""
        return signals_of(self._properties)

    @property
    def _properties(self) -> list[PropertySpecification]:
        return [each.specification for each in self.compiled]

    @cached_property
    def prepared(self) -> list[Prepared]:
        """What judging by columns needs of the properties."""
        return prepare_all(self.compiled, self.specification.source)

    @cached_property
    def prepared_again(self) -> dict[str, Prepared]:
        """The same of those machines that restart, by label."""
        prepared = prepare_all(self.restarting, self.specification.source)
        return {each.specification.label: of for each, of in zip(self.restarting, prepared, strict=True)}

    def _maker(self, columns: Collection[str]) -> Callable[[MonitoredProperty, bool, Observer | None], Track]:
        """Makes tracks, where samples of these signals come in themselves."""
        again = self.again(columns)
        recurring = {each.specification.label for each in self.compiled if can_recur(each, again)}

        def track(property_: MonitoredProperty, keep: bool, observer: Observer | None) -> Track:
            letters = None if self.evidence is None else self.evidence.letters(property_.label)
            is_all = self.finds_all and property_.label in recurring
            return JudgedTrack(property_, keep, observer, is_all, letters, again.get(property_.label))

        return track

    @cached_property
    def restarting(self) -> list[Restarting]:
        """The properties that need a machine that restarts."""
        return restarting(self.compiled) if self.finds_all else []

    @cached_property
    def _plans(self) -> dict[tuple[bool, frozenset[str]], Plan]:
        """Those made so far: whether its machines restart, by the signals that come in themselves."""
        return {}

    def plan(self, columns: Collection[str]) -> Plan:
        """What is monitored where samples of these signals come in themselves."""
        return self._plan(self.compiled, False, columns)

    def again(self, columns: Collection[str]) -> dict[str, MonitoredProperty]:
        """The properties with a machine that restarts, by label."""
        made = self._plan(self.restarting, True, columns).properties if self.restarting else ()
        return {each.label: each for each in made}

    def _plan(self, compiled: Sequence[Compiled], restarts: bool, columns: Collection[str]) -> Plan:
        key = restarts, self._given(columns)
        if key not in self._plans:
            self._plans[key] = load_plan(compiled, self.specification, key[1])
        return self._plans[key]

    def _given(self, columns: Collection[str]) -> frozenset[str]:
        """The signals that are computed from others and come in themselves."""
        computed = (name for name, signal in self.signals.items() if not isinstance(signal.definition, Field))
        return frozenset(computed).intersection(columns)

    def remarks_on(self, path: Path, recording: Recording) -> list[Diagnostic]:
        """Those on the monitors; columns of the recording at `path` that nothing reads, signals that nothing gives."""
        is_guarded = self.guarding is not None
        return [
            *self.remarks,
            *remarks(self._properties, self.specification, path, recording, is_guarded=is_guarded),
        ]

    def _left_out(self, session: Session) -> Iterator[Diagnostic]:
        """A warning for each property some messages of which found no place."""
        for track, of in zip(session.tracks, self._properties, strict=True):
            if of.slicing is not None and track.slices is not None and track.slices.left_out:
                number = track.slices.left_out
                told = "1 message was" if number == 1 else f"{number} messages were"
                message = f"{told} ignored by `{of.label}`, which has a limit of {of.slicing.limit}"
                help = "raise or omit the `limit`; the verdict is about the others"
                yield diagnostic("LTL850", self.specification.source, of.span, message, help=help)

    def _run(
        self,
        by_blocks: ByBlocks,
        whole: WholeRuns | None,
        path: Path,
        part: Part,
        watch: Stopwatch,
        columns: Collection[str],
        watchers: Sequence[Watcher],
        measuring: Measuring | None,
    ) -> None:
        """Take the rows in `part`, which have samples of `columns`; `watch` how long reading takes.

        Raises RecordingError.
        """
        session = by_blocks.session
        checks = checks_of(self.signals[name] for name in readings(session.plan) if name in columns)
        for block in watch.over(part.blocks()):
            checks.check(block, path)
            if self.keep_verdicts and len(block.times):
                first = block.times[0] if session.time is None else session.time
                _check_steps(session, int(block.times[-1] - first), path)
            if measuring is not None:
                measuring.take(block)
            by_blocks.take(block)
            if whole is not None:
                whole.take(block)
            _settle(session, whole)
            for watcher in watchers:
                watcher(block)
            if session.is_over:
                break
        end = session.time if part.until is None else part.until
        if end is not None:
            if measuring is not None:
                measuring.finish(end)
            ByRows(by_blocks.session).advance(end)
            for track in session.tracks:
                track.hold(min(end, session.end))
            if whole is not None:
                whole.end(end)
        _settle(session, whole, is_over=True)


def _letters(session: Session, whole: WholeRuns | None) -> dict[str, Letters]:
    """Those that are kept, by the labels of properties."""
    pairs = ((track.property.label, track.letters) for track in session.tracks if isinstance(track, JudgedTrack))
    found = {label: letters for label, letters in pairs if letters is not None}
    return found if whole is None else found | whole.letters


def _settle(session: Session, whole: WholeRuns | None, *, is_over: bool = False) -> None:
    """The letters of properties that are decided end there."""
    kept = _letters(session, whole)
    for track in session.tracks:
        if (letters := kept.get(track.property.label)) is not None and not letters.is_settled:
            letters.settle(None if track.decided_at is None else track.decided_at.time, is_over=is_over)


MOST_VERDICTS = 10_000_000
"""Verdicts of single steps that are kept: a gigabyte of them."""


def _check_steps(session: Session, time: Nanoseconds, path: Path) -> None:
    """Raise RecordingError if a run so long has more steps than can be listed."""
    rate, timeout = session.plan.rate or 0, session.plan.timeout
    verdicts = seconds(min(time, timeout or time)) * rate * len(session.tracks)
    if verdicts > MOST_VERDICTS:
        message = f"a run at this `_rate_` has more than {MOST_VERDICTS} verdicts, too many to list"
        raise failure("LTL804", path, message, "omit --verdicts, or check that all times are from one clock")


def readings(plan: Plan) -> list[str]:
    """The names of the signals that come in themselves."""
    return [signal.name for signal in plan.signals if isinstance(signal, sampling.Reading)]
