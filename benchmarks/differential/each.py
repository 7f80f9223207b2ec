"""Properties of each id and each message: drawn, judged by rows, columns, in files, C and Rust, and by definition.

By `docs/language.md`, 'One property for each id': of a slice, rows are left out, and what is left is a run.
`each new s: P` is `always (new s implies P)`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any

from benchmarks.differential import each_compiled, files, targets
from benchmarks.differential.campaign import Difference, Outcome, live
from benchmarks.differential.compare import PERMANENT, Continued, compared, refuted
from benchmarks.differential.draw import DECLARATIONS, Draw
from benchmarks.differential.forms import is_state
from benchmarks.differential.names import said
from benchmarks.differential.reference import Judged, Property, judged_alone
from benchmarks.differential.samples import Recording, Run, Sampler
from benchmarks.differential.targets import Found, Monitors
from benchmarks.differential.values import single
from ltlc.base.source import Source
from ltlc.frontend.language import load_text
from ltlc.frontend.syntax import tree as s
from ltlc.inputs.recordings.blocks import blocks_of
from ltlc.inputs.recordings.rows import Row as Cells
from ltlc.interfaces.api.monitor import LiveRun
from ltlc.interfaces.api.prepare import Prepared
from ltlc.monitoring.columns.session import ByBlocks
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Session
from ltlc.runtime.slice_steps import Slices

SLICED = "/part"
MOST = 150
"""So many rows at most are judged."""

OWN = ("part", "level")
TEXT = DECLARATIONS + (
    "decl key /part JoyFeedback.id\ndecl part /part JoyFeedback.type\ndecl level /part JoyFeedback.intensity\n"
    "soon = 500 ms\n"
)


class DrawEach(Draw):
    """Draws one property of each id, or of each message, and recordings."""

    def specification(self, count: int = 1) -> str:
        """A specification of one property."""
        self.held = {}
        while True:
            line = self._of_each() if self.chance.random() < 2 / 3 else self._of_messages()
            text = f"{TEXT}p: {line}\n"
            if "opening" not in line and load_text(Source("props.txt", text))[0] is not None:
                return text

    def _of_each(self) -> str:
        self.is_timed = self.chance.random() < 0.6
        others = self.chance.sample(
            ["v", "w", "small", "flag", "mode", "bump", "i"], self.chance.choice([0, 0, 1, 1, 2])
        )
        return f"each k of key: {self._over([*self.chance.sample(OWN, self.chance.choice([1, 1, 2])), *others])}"

    def _of_messages(self) -> str:
        self.is_timed = self.chance.random() < 0.7
        names = self.chance.sample(["v", "w", "small", "flag", "mode", "bump", "i"], self.chance.choice([1, 2, 2, 3]))
        return f"each new {self.chance.choice(names)}: {self._over(names)}"

    def _atom(self, names: Sequence[str]) -> str:
        """Most atoms are such that columns take them."""
        name = self.chance.choice(names)
        if name in ("bump", "flag", "mode") or self.chance.random() < 0.2:
            return super()._atom(names)
        return f"{name} {self.chance.choice(['<', '<=', '>', '==', '!='])} {self.chance.choice(['0', '1', '2', '0.5'])}"

    def recording(self, topics: Sequence[str], is_together: bool) -> Recording:
        """A recording that is not long: each id has a part of it only, and each message is judged from there on."""
        drawn = super().recording(topics, is_together)
        rows = drawn.rows[:MOST]
        return drawn if rows == drawn.rows else Recording(rows, drawn.begin, rows[-1].time)

    def _message(self, topic: str) -> dict[str, Any]:
        if topic != SLICED:
            return super()._message(topic)
        pick = self.chance.choice
        level = single(self._double())
        return {"key": pick([0, 1, 1, 2, 3, 200]), "part": pick([0, 0, 1, 2, 3]), "level": level}


class Slice(Property):
    """A property of the slice of one id."""

    id: int = 0

    def run(self, recording: Recording) -> Run:
        """Its steps: before its first message, what others say is known and no step."""
        sampler, reads, is_born = Sampler(self.reads, self._truths), self.reads, False
        for row in recording.rows:
            messages = {t: v for t, v in row.messages.items() if t != SLICED or v["key"] == self.id}
            mine = reads.all_topics & messages.keys()
            fresh = frozenset(name for topic in mine for name in messages[topic])
            begins = not is_born and SLICED in messages
            is_born |= begins
            for topic in mine:
                sampler.sample(messages[topic])
            if is_born and (mine or (begins and reads.from_session)):
                sampler.look(row.time, dict.fromkeys(mine, row.time), fresh)
            elif mine:
                sampler.know(row.time, mine, fresh)
        return sampler.run


@dataclass
class Each:
    """A specification of one property, by definition."""

    text: str

    @cached_property
    def body(self) -> s.Node:
        """The property as it is written."""
        return said(self.text).properties["p"]

    def slices(self, recording: Recording) -> dict[int, Slice]:
        """What is judged of each id."""
        assert isinstance(self.body, s.EachOf)
        found: dict[int, Slice] = {}
        for row in recording.rows:
            if SLICED in row.messages and row.messages[SLICED]["key"] not in found:
                one = found[row.messages[SLICED]["key"]] = Slice(said(self.text), self.body.body)
                one.id = row.messages[SLICED]["key"]
        return found

    def whole(self) -> Property:
        """`each new s: P` as a property of the whole run."""
        head, _, body = self.text.splitlines()[-1].removeprefix("p: each ").partition(": ")
        assert isinstance(self.body, s.EachMessage)
        body = f"always ({body})" if is_state(self.body.body) else body
        text = "".join(self.text.splitlines(keepends=True)[:-1]) + f"p: always ({head} implies ({body}))\n"
        names = said(text)
        return Property(names, names.properties["p"])


def outcome(seed: int, recordings: int = 6) -> Outcome:
    """What is drawn from a seed, judged and compared."""
    chance, found = Random(f"each {seed}"), Outcome()
    draw = DrawEach(chance)
    text = draw.specification()
    try:
        case = Case(text)
    except targets.UnusableError:
        found.runs["not translated"] += 1
        return found
    topics = sorted(
        {f"/{name}" for name in ("v", "w", "small", "flag", "mode", "bump", "i") if name in text.splitlines()[-1]}
    )
    for _ in range(recordings):
        recording = draw.recording([*topics, SLICED], chance.random() < 0.6)
        judge_one(found, case, recording, chance)
    return found


def again(of: Difference) -> Difference | None:
    """The first difference that is found when a case is judged anew; None if all is the same."""
    found = Outcome()
    try:
        judge_one(found, Case(of.text), of.recording, Random(0))
    except (targets.UnusableError, AssertionError, KeyError, StopIteration):
        return None
    return next(iter(found.differences), None)


class Case:
    """A specification of one property: by definition, and what is made of it. Raises UnusableError."""

    def __init__(self, text: str) -> None:
        self.each = Each(text)
        self.of = targets.monitors(text)
        self.compiled = each_compiled.load(text)
        self.is_sliced = isinstance(self.each.body, s.EachOf)


def judge_one(found: Outcome, case: Case, recording: Recording, chance: Random) -> None:
    """A recording, in every way."""
    each = case.each
    parts: Mapping[Any, Property] = each.slices(recording) if case.is_sliced else {None: each.whole()}
    if not case.is_sliced:  # While there is news, ltlc may know of an instance already what becomes of it.
        recording = Recording(recording.rows, recording.begin, recording.end + 1)
    wanted = {id_: (judged_alone(part, recording), refuted(part, recording)) for id_, part in parts.items()}
    judged = {id_: expected for id_, (expected, _) in wanted.items()}
    for way, session in _sessions(case.of, recording, chance):
        results = _of_slices(session, judged, recording.end) if case.is_sliced else {None: _of_messages(session)}
        problems, is_near = _compared(found, way, wanted, results, case.is_sliced)
        if case.is_sliced and not is_near and not problems:
            problems += _of_whole(session, judged)
        found.differences += [Difference(way, "p", problem, each.text, recording) for problem in problems]
    for language, library in case.compiled.items():
        results_ = each_compiled.found_by(library, case.of, recording, judged)
        if results_ is not None:
            problems, _ = _compared(found, language, wanted, results_, case.is_sliced)
            found.differences += [Difference(language, "p", problem, each.text, recording) for problem in problems]


def _compared(
    found: Outcome,
    way: str,
    wanted: Mapping[Any, tuple[Judged, Continued]],
    results: Mapping[Any, Found],
    is_sliced: bool,
) -> tuple[list[str], bool]:
    """What differs in each id, or of all messages, and whether a verdict came at another time than by definition."""
    found.runs[way] += 1
    problems, is_near = [], False
    for id_, (expected, is_refuted) in wanted.items():
        found.steps[way] += live(expected)
        one = compared(expected if is_sliced else _never_satisfied(expected), results[id_], is_refuted)
        found.early += one.early
        found.late += one.late
        is_near |= one.early or one.late
        problems += [f"id {id_}: {one.problem}"] if one.problem else []
    return problems, is_near


def _never_satisfied(of: Judged) -> Judged:
    """Another message may come."""
    changes: list[tuple[int, str]] = []
    for time, verdict in of.changes:
        shown = "presumably_satisfied" if verdict == "satisfied" else verdict
        changes += [(time, shown)] if not changes or changes[-1][1] != shown else []
    verdicts = ["presumably_satisfied" if verdict == "satisfied" else verdict for verdict in of.verdicts]
    return replace(of, changes=changes, verdicts=verdicts)


def _of_messages(session: Session) -> Found:
    [track] = session.tracks
    decided = None if track.decided_at is None else track.decided_at.time
    return Found(track.verdict.value, None, decided, track.steps)


def _of_slices(session: Session, expected: Mapping[int, Judged], end: int) -> dict[int, Found]:
    """What is found of each id; of one that was forgotten, all is well. It is not said when one was satisfied."""
    [slices] = session.sliced
    assert isinstance(slices, Slices)
    found: dict[Any, Found] = {id_: Found("presumably_satisfied") for id_ in slices.ids.forgotten}
    found |= {id_: Found(one.verdict.value) for id_, one in slices.ids.slices.items()}
    found |= {id_: Found("violated", None, each.failure.time) for id_, each in slices.ids.violated.items()}
    for id_ in slices.ids.satisfied:
        of = expected[int(id_)]
        found[id_] = Found("satisfied", None, of.changes[-1][0] if of.verdict == "satisfied" else end)
    return {int(id_): each for id_, each in found.items()}


def _of_whole(session: Session, expected: Mapping[int, Judged]) -> list[str]:
    """What is wrong of the whole, where all is well with each id."""
    [track], verdicts = session.tracks, {of.verdict for of in expected.values()}
    order = ("violated", "presumably_violated", "presumably_satisfied", "not_started")
    shown = next((each for each in order if each in verdicts), "not_started")
    if "satisfied" in verdicts and shown == "not_started":
        shown = "presumably_satisfied"
    found = [] if track.verdict.value == shown else [f"{track.verdict.value}, but {shown}"]
    if verdicts.intersection(PERMANENT):  # of several steps at the time of a verdict, it is not said after which
        return found
    steps = sum(of.steps for of in expected.values())
    invalid = sum(of.invalid for of in expected.values())
    found += [] if track.steps == steps else [f"{track.steps} steps, but {steps}"]
    found += [] if track.invalid == invalid else [f"{track.invalid} invalid steps, but {invalid}"]
    return found


def _sessions(of: Monitors, recording: Recording, chance: Random) -> Iterator[tuple[str, Session]]:
    session = Session(of.judge.plan(()))
    rows = ByRows(session)
    for row in recording.rows:
        cells = of.cells(row)
        heard = [topic for topic in row.messages if topic in session.messages]
        rows.samples(row.time, tuple(cells), list(cells.values()), heard)
    rows.advance(recording.end)
    yield "rows", session
    by_blocks = ByBlocks(Session(of.judge.plan(())), of.judge.prepared)
    given = [Cells(row.time, of.cells(row)) for row in recording.rows]
    ends = sorted(chance.randint(0, len(given)) for _ in range(chance.choice([0, 0, 1, 3])))
    for a, b in zip([0, *ends], [*ends, len(given)], strict=True):
        for block in blocks_of(given[a:b], of.columns) if b > a else ():
            by_blocks.take(block)
    way = "rows for columns" if by_blocks.ways[0].because else "columns"
    session = by_blocks.session
    ByRows(session).advance(recording.end)
    yield way, session
    yield "ltlc.monitor", _monitored(of, recording)
    form = chance.choice([*files.TABLES, *files.bag_forms(recording.rows)])
    with TemporaryDirectory() as folder:
        path = files.write(form, Path(folder), of, recording)
        yield form, targets.session_of_file(of, path, None, recording.end)


def _monitored(of: Monitors, recording: Recording) -> Session:
    """The session of `ltlc.monitor`, a dictionary at a time."""
    run = LiveRun(Prepared(of.specification, of.compiled, (), targets.BUDGET), of.signals)
    for row in recording.rows:
        run.step(of.cells(row), time_ns=row.time)
    run.step({}, time_ns=recording.end)
    session = run.finish()._report.session
    assert session is not None
    return session
