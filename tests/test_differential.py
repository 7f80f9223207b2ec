"""What differed from the definition once, in every way in which ltlc judges, and a part of the campaign."""

from __future__ import annotations

from collections import Counter
from itertools import accumulate, count, product
from pathlib import Path
from random import Random

import pytest
from effort import share_of

from benchmarks.differential import campaign, draw, each, files, fixtures, reference, shrink, targets
from benchmarks.differential.campaign import Case, Difference, Outcome
from benchmarks.differential.reference import Property
from benchmarks.differential.samples import Recording, Row
from ltlc.base.source import Source
from ltlc.frontend.language import load_text
from ltlc.semantics.denotation import satisfies

FOLDER = Path(__file__).parent / "fixtures" / "differential"
NAMES = sorted(path.stem for path in FOLDER.glob("*.ltlc"))


@pytest.mark.parametrize("name", NAMES)
def test_the_reference_says_what_was_written_down(name: str) -> None:
    fixture = fixtures.load(FOLDER, name)
    judged = reference.judged(reference.properties(fixture.text), fixture.recording)
    assert {label: each.changes for label, each in judged.items()} == fixture.expected


@pytest.mark.parametrize("name", NAMES)
def test_what_differed_once_is_the_same_in_every_way(name: str) -> None:
    fixture = fixtures.load(FOLDER, name)
    of, recording = targets.monitors(fixture.text), fixture.recording
    properties = reference.properties(fixture.text)
    whole = reference.whole_run(properties, recording)
    wanted, found = campaign.expected(properties, whole), Outcome()
    for way in [*targets.IN_MEMORY, "Python", *files.TABLES, *files.bag_forms(recording.rows)]:
        case = Case(way, recording, whole, None, recording.end)
        campaign.take(found, of, properties, case, wanted, Random(0))
    assert not [(each.way, each.problem) for each in found.differences]


@pytest.mark.parametrize("seed", [11, 13, 14][: share_of(3)])
def test_what_is_drawn_is_judged_as_the_definition_says(seed: int) -> None:
    found = campaign.outcome(seed, properties=6, recordings=2)
    assert not [(each.way, each.label, each.problem) for each in found.differences]
    assert found.steps.total() > 900


def test_what_is_drawn_of_each_id_and_each_message_is_judged_as_the_definition_says() -> None:
    steps, seeds = Counter[str](), count(5)
    while steps["rows"] < share_of(1000) or not steps["columns"]:
        found = each.outcome(next(seeds), recordings=2)
        assert not [(one.way, one.text.splitlines()[-1], one.problem) for one in found.differences]
        steps.update(found.steps)


@pytest.mark.parametrize(("constant", "waits"), [("0.5", False), ("0", True)])
def test_the_reference_does_not_wait_for_a_value_that_decides_nothing_beside_another(
    constant: str, waits: bool
) -> None:
    """No int8 is 0.5: whatever `v` is, `small` makes no difference."""
    text = "decl v /v Float64.data\ndecl small /small Int8.data\n"
    text += f"p: after_until new small, small != {constant} and v > 0.5, v > 0.5\n"
    [of] = reference.properties(text).values()
    assert (frozenset({("small", 0)}) in of.reads.waited) == waits


def test_a_case_that_differs_is_made_small(monkeypatch: pytest.MonkeyPatch) -> None:
    text = "decl v /v Float64.data\ndecl w /w Float64.data\np: always (v < 3 or w > 1)\nq: never w > 5\n"
    rows = [Row(number * 10**9, {"/v": {"v": float(number)}, "/w": {"w": 0.0}}) for number in range(9)]
    first = Difference("rows", "p", "", text, Recording(rows, 0, rows[-1].time))
    honest = targets.by_rows

    def lying(*arguments: object) -> targets.By:
        found = honest(*arguments)  # type: ignore[arg-type]
        return {name: targets.Found("presumably_satisfied", []) if name == "p" else f for name, f in found.items()}

    monkeypatch.setitem(targets.IN_MEMORY, "rows", lying)
    small = shrink.shrunk(first, 30.0)
    assert len(small.text.splitlines()) == 2
    assert len(small.recording.rows) == 1


@pytest.mark.parametrize("seed", range(share_of(4)))
def test_the_instants_that_are_looked_at_are_enough(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The verdicts, and when they come, are those of a run of which every nanosecond is looked at."""
    monkeypatch.setattr(draw, "DURATIONS", ("1 ns", "2 ns", "3 ns", "5 ns"))
    chance = Random(seed)
    drawing = draw.Draw(chance)
    text = "".join(line for line in drawing.specification(12).splitlines(True) if line[0] != "_")
    text = text.replace("soon = 500 ms", "soon = 4 ns")
    of = reference.properties(text)
    topics = sorted({topic for each in of.values() for topic in each.reads.all_topics})
    drawn = drawing.recording(topics, True).rows[:12]
    times = accumulate(chance.choice([0, 1, 1, 2, 3, 4, 7]) for _ in drawn)
    rows = [Row(time, row.messages) for time, row in zip(times, drawn, strict=True)]
    recording = Recording(rows, rows[0].time, rows[-1].time + 9)
    some = {label: each.changes for label, each in reference.judged(of, recording).items()}
    monkeypatch.setattr(
        Property, "_places", lambda _, on, __: [(k, t) for k, (a, b) in enumerate(on) for t in range(a, b + 1)]
    )
    assert some == {label: each.changes for label, each in reference.judged(of, recording).items()}


@pytest.mark.parametrize(
    "property_",
    [
        "always (a implies eventually b)",
        "after a, never b",
        "until a, always not b",
        "after_until a, b, eventually c",
        "(initially a) or (eventually b)",
        "after_until a, b, after c, never a",
    ],
)
def test_a_run_so_far_holds_as_the_definition_of_the_compiler_says(property_: str) -> None:
    """The reference and `ltlc.semantics` share nothing."""
    text = "".join(f"decl {name} /{name} Bool.data\n" for name in "abc") + f"p: {property_}\n"
    specification, _ = load_text(Source("props.txt", text))
    assert specification is not None
    [checked], [mine] = specification.properties, reference.properties(text).values()
    for word in product(product([False, True], repeat=3), repeat=3):
        rows = [Row(n, {f"/{k}": {k: v} for k, v in zip("abc", each, strict=True)}) for n, each in enumerate(word)]
        found = reference.judged_alone(mine, Recording(rows, 0, len(rows) - 1)).verdict
        letters = tuple(frozenset(name for name, holds in zip("abc", each, strict=True) if holds) for each in word)
        assert found.endswith("satisfied") == satisfies(letters, checked.property), (word, found)
