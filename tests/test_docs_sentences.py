"""The sentences that the documentation shows mean, on the runs that it shows, what it says."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from stepping import from_text

from ltlc.backends.python.load import load_plan
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Plan, Session
from ltlc.runtime.times import nanoseconds
from ltlc.specification.expressions import Current, Signal, ValueType

PAGE = (Path(__file__).parents[1] / "docs" / "sentences.md").read_text(encoding="utf-8")
*SENTENCES, SIGNALS = re.findall(r"```ltlc\n(.*?)```\n(.*?)(?=```|\Z)", PAGE, re.DOTALL)

Value = bool | float


def runs() -> Iterator[tuple[str, str, str]]:
    """Each sentence with each run in the table below it, and the verdict there."""
    for sentence, below in SENTENCES:
        for run, verdict in re.findall(r"^\| (\d.*?) \| (.*?) \|", below, re.MULTILINE):
            yield sentence.strip(), run, verdict


def told(assignments: str) -> dict[str, Value]:
    """What `stopped, not near, tilt = 0.4` gives to which signals."""
    values: dict[str, Value] = {}
    for each in filter(None, assignments.split(", ")):
        name, is_number, number = each.removeprefix("not ").partition(" = ")
        values[name] = float(number) if is_number else not each.startswith("not ")
    return values


@cache
def planned(sentence: str) -> tuple[Plan, tuple[Signal, ...]]:
    """What monitors `sentence`, and the signals whose values it reads."""
    compiled, specification = from_text(SIGNALS[0] + sentence)
    (property_,) = specification.properties
    read = tuple(each.signal for each in property_.inputs() if isinstance(each, Current))
    return load_plan(compiled, specification), read


def verdict_of(sentence: str, run: str) -> str:
    plan, read = planned(sentence)
    rows = ByRows(Session(plan))
    values: dict[str, Value] = {each.name: 0.0 if each.type is ValueType.NUMBER else False for each in read}
    for step in run.split("; "):
        time, _, assignments = step.partition(" s")
        values |= told(assignments.strip())
        if values:
            rows.samples(nanoseconds(time), tuple(values), tuple(values.values()))
        rows.advance(nanoseconds(time))
        values = {}
    return rows.tracks[0].verdict.value.replace("_", " ")


@pytest.mark.parametrize(("sentence", "run", "verdict"), list(runs()))
def test_a_run_has_the_verdict_that_the_page_shows(sentence: str, run: str, verdict: str) -> None:
    assert verdict_of(sentence, run) == verdict


def test_there_are_sixteen_sentences_and_each_has_runs() -> None:
    assert len(SENTENCES) == len({sentence for sentence, _, _ in runs()}) == 16
