"""Makes cases: draws specifications and runs, and keeps the least that tells the definition from wrong readings.

A case is made for one to three readings, and is minimal among those that tell all of these from the definition: no row
or message can be dropped, no part of the property put in the place of the whole, and no bound left out.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from random import Random
from time import process_time
from typing import Any

from benchmarks.conformance.cases import Case
from benchmarks.conformance.definition import Definition, definition
from benchmarks.conformance.readings import NOT_READ, READINGS, tells, that_matter
from benchmarks.differential.draw import Draw
from benchmarks.differential.each import DrawEach
from benchmarks.differential.samples import Recording, Row
from benchmarks.differential.shrink import smaller_recordings, smaller_texts
from ltlc.base.source import Source
from ltlc.frontend.language import load_text
from ltlc.frontend.syntax.parse import parse

MOST_ROWS = 7
MOST_LETTERS = 150
NEWS, ARRAYS = re.compile("new |rate"), re.compile(r"\[\]|Array|ranges")
"""What takes the reference long beside one another: what it waits for, it finds by trying values."""

MOST_TICKED = 4 * 10**9
"""So long a run is at most, in ns, where `_rate_` makes steps."""

MOST_SECONDS = 1.5
"""After so much CPU time no other run is drawn of a specification."""

RUNS = 6
"""So many runs are drawn of a specification."""

SETS = 8
"""So many sets of readings are chosen of a run."""

ENOUGH = 150
"""For a reading that has so many cases no more are made."""

EACH = 0.08
"""The share of specifications with `each`."""

ANY, TRIES = re.compile(""), 100

DRAWN = [name for name, reading in READINGS.items() if reading.family != "ids" and reading.matters.pattern[0] != "_"]
"""The readings that a property can be drawn for; others depend on settings, or on `each`."""

RAREST = 25
"""Half of the properties are such that one of so many readings can matter that have the fewest cases."""


class Small(Draw):
    """Draws properties of few parts, with a pattern that is `wanted`: what is small at first is soon minimal."""

    def __init__(self, chance: Random, wanted: re.Pattern[str]) -> None:
        super().__init__(chance)
        self._wanted = wanted

    def _accepted(self, text: str) -> str:
        while True:
            drawn = (self._property() for _ in range(TRIES))
            line = next((each for each in drawn if self._wanted.search(each)), None) or self._property()
            if load_text(Source("props.txt", f"{text}p: {line}\n"))[0] is not None:
                return line

    def _temporal(self, depth: int, is_anchor: bool) -> str:
        return super()._temporal(min(depth, self.chance.choice([0, 1, 1, 2])), is_anchor)

    def _event(self, depth: int = 1) -> str:
        return super()._event(depth if self.chance.random() < 0.4 else 0)


class SmallEach(Small, DrawEach):
    """The same with `each`."""


class Maker:
    """Draws from a seed; `known` has the keys of what was made before, `made` how often a reading was told."""

    def __init__(self, seed: int, known: set[str], made: Counter[str]) -> None:
        self.chance = Random(f"conformance {seed}")
        self.known, self.made = known, made

    def cases(self) -> list[Case]:
        """What is made of one specification."""
        rarest = sorted(DRAWN, key=self._rank)[:RAREST]
        wanted = READINGS[self.chance.choice(rarest)].matters if self.chance.random() < 0.5 else ANY
        draw = (SmallEach if self.chance.random() < EACH else Small)(self.chance, wanted)
        text = declared(draw.specification(1).replace("p0: ", "p: "))
        if len(text.splitlines()[-1]) > MOST_LETTERS or (NEWS.search(text) and ARRAYS.search(text)):
            return []
        try:
            of = definition(text)
        except NOT_READ:
            return []
        found, end = [], process_time() + MOST_SECONDS
        for _ in range(RUNS):
            if process_time() > end:
                break
            for case in self._of_run(text, self._run(draw, of)):
                if key(case) not in self.known:
                    self.known.add(key(case))
                    self.made.update(case.readings)
                    found.append(case)
        return found

    def _run(self, draw: Draw, of: Definition) -> Recording:
        topics = sorted(of.topics) or ["/flag"]
        drawn = draw.recording(topics, self.chance.random() < 0.3)
        first = self.chance.randrange(max(1, len(drawn.rows) - MOST_ROWS))
        rows = [read_of(row, of) for row in drawn.rows[first : first + MOST_ROWS]]
        rows = rows if of.names.rate is None else [row for row in rows if row.time - rows[0].time < MOST_TICKED]
        return Recording(rows, rows[0].time, rows[-1].time + max(0, drawn.end - drawn.rows[-1].time))

    def _of_run(self, text: str, recording: Recording) -> Iterator[Case]:
        """The least cases of some of the readings that a run tells: of those first which have the fewest cases."""
        expected = definition(text).verdicts(recording)
        told = [name for name in that_matter(text) if tells(name, text, recording, expected)]
        if "p: each " in text and all(READINGS[name].family != "ids" for name in told):
            return
        rare = [name for name in told if self.made[name] < ENOUGH]
        for first in sorted(rare, key=self._rank)[:SETS]:
            others = self.chance.sample(told, min(len(told), self.chance.choice([0, 0, 1, 1, 2])))
            yield least(Case(0, tuple(sorted({first, *others})), text, recording, expected))

    def _rank(self, name: str) -> tuple[bool, int, float]:
        """Those of ids first, which no other specification tells; then those with the fewest cases."""
        return READINGS[name].family != "ids", self.made[name], self.chance.random()


def declared(text: str) -> str:
    """A specification of the property `p` without declarations that it does not need."""
    *lines, last = text.splitlines()
    if "fast" in last or "soon" in last:
        names = {
            word: line.partition(" = ")[2] for line in lines for word in [line.split()[0]] if word in ("fast", "soon")
        }
        last = re.sub(r"\bsoon\b", names.get("soon", ""), re.sub(r"\bfast\b", f"({names.get('fast', '')})", last))
    kept = []
    for line in lines:
        first, name, *_ = line.split()
        used = first.startswith("_") or (
            first in ("decl", "object", "zone") and re.search(rf"(?<![\w/]){name}\b", last.removeprefix("p: "))
        )
        if used or (name == "key" and " of key" in last):
            kept.append(line)
    return "\n".join([*kept, re.sub(" +(?=$|[),])", "", last)]) + "\n"


def read_of(row: Row, of: Definition) -> Row:
    """A row of what is declared, and of an odometer only what is read."""
    return Row(row.time, {topic: kept for topic, values in row.messages.items() if (kept := _read(values, of))})


def _read(values: Mapping[str, Any], of: Definition) -> dict[str, Any]:
    known = {name: value for name, value in values.items() if name in of.names.signals}
    kept = {name: value for name, value in known.items() if "." not in name or name in of.signals}
    return kept or dict([*known.items()][:1])


def least(case: Case) -> Case:
    """A case that is minimal, smaller or the same."""
    while True:
        before = case
        for smaller in (_fewer_rows, _nearer_times, _shorter_texts):
            while (found := next((each for each in smaller(case) if each is not None), None)) is not None:
                case = found
        if case is before:
            return case


def _fewer_rows(case: Case) -> Iterator[Case | None]:
    return (_kept(replace(case, recording=recording)) for recording in smaller_recordings(case.recording))


def _nearer_times(case: Case) -> Iterator[Case | None]:
    """With the end of the run at its last row, and its beginning at 0."""
    rows, end = case.recording.rows, case.recording.end
    if end > rows[-1].time:
        yield _kept(replace(case, recording=Recording(rows, rows[0].time, rows[-1].time)))
    if rows[0].time:
        moved = [Row(row.time - rows[0].time, row.messages) for row in rows]
        yield _kept(replace(case, recording=Recording(moved, 0, end - rows[0].time)))


def _shorter_texts(case: Case) -> Iterator[Case | None]:
    """Without a setting, without a part of the property, or without parentheses."""
    for line in case.text.splitlines(keepends=True)[:-1]:
        if line.startswith("_"):
            yield _kept(replace(case, text=case.text.replace(line, "")), is_new_text=True)
    yield from (_kept(replace(case, text=text), is_new_text=True) for text in _shorter(case.text))
    yield from (replace(case, text=text) for text in without_parentheses(case.text))


@lru_cache(4096)
def _shorter(text: str) -> Sequence[str]:
    """Specifications of a part of the property; of those that differ in parentheses only, one."""
    found = {each.translate(WITHOUT_PARENTHESES): each for each in map(declared, smaller_texts(text))}
    return [each for each in found.values() if len(each) < len(text)]


WITHOUT_PARENTHESES = str.maketrans("", "", "()")


@lru_cache(4096)
def _is_accepted(text: str) -> bool:
    return load_text(Source("props.txt", text))[0] is not None


@lru_cache(4096)
def without_parentheses(text: str) -> Sequence[str]:
    """The same specification without two parentheses that make no difference to it, in all ways."""
    found, meant, start = list[str](), _meaning(text), text.index("p: ")
    open_: list[int] = []
    for place, char in enumerate(text):
        if char == "(":
            open_.append(place)
        elif char == ")" and open_ and (first := open_.pop()) > start:
            less = f"{text[:first]}{text[first + 1 : place].strip()}{text[place + 1 :]}"
            if _meaning(less) == meant:
                found.append(less)
    return found


def _meaning(text: str) -> str:
    tree, problems = parse(Source("props.txt", text))
    return "" if problems else re.sub(r"span=Span\([^)]*\)", "", repr(tree.commands[-1]))


def _kept(case: Case, *, is_new_text: bool = False) -> Case | None:
    """A case with its verdicts, if it still tells all its readings and the language has it."""
    try:
        of = definition(case.text)
        rows = [read_of(row, of) for row in case.recording.rows]
        rows = [Row(row.time, {t: v for t, v in row.messages.items() if t in of.topics}) for row in rows]
        rows = [row for row in rows if row.messages] if of.topics else rows
        if not rows:
            return None
        recording = Recording(rows, rows[0].time, max(case.recording.end, rows[-1].time))
        expected = of.verdicts(recording)
    except NOT_READ:
        return None
    if not all(tells(name, case.text, recording, expected) for name in case.readings):
        return None
    if is_new_text and not _is_accepted(case.text):
        return None
    return replace(case, recording=recording, expected=expected)


def key(case: Case) -> str:
    """What cases differ in: the property but for its numbers, the readings, and the verdicts in their order."""
    shape = re.sub(r"\d+(\.\d+)?", "0", case.sentence)
    settings = "".join(line.split()[0] for line in case.text.splitlines() if line.startswith("_"))
    verdicts = " ".join(verdict for _, verdict in case.expected.changes)
    return f"{settings} {shape} {len(case.recording.rows)} {verdicts} {','.join(case.readings)}"
