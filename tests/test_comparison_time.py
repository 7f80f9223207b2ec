"""Timed sentences side by side: what is claimed of them is true of runs that are judged by the definition."""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import pytest
from effort import share_of
from timed import Draw, holds, ordinary_atoms

from ltlc.analysis.comparison.other_bounds import LARGEST, Bound, NotKnownError
from ltlc.analysis.comparison.relate import Pair, relate_on_finite_runs, relate_on_infinite_runs
from ltlc.analysis.comparison.results import Candidate, Question, Related, Relation
from ltlc.analysis.errors import NotDecidedError
from ltlc.analysis.time_bounds import time_bounds, with_bound
from ltlc.automata import translate
from ltlc.cli import main
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.encodings import EPISODE, encode
from ltlc.semantics.instants import Instant, Observation, Step
from ltlc.semantics.ltl import FALSE, And, Atom, Formula, Not, Or
from ltlc.semantics.properties import After, Always, Eventually, Now, Property, Within
from ltlc.semantics.timed_atoms import Once, news_of
from ltlc.semantics.words import Word, all_letters

X, Y = Atom("x"), Atom("y")
LONG = 40
"""After so many ns nothing changes any more by itself in properties that are drawn."""


def pair(left: Formula, right: Formula) -> Pair:
    alphabet = Alphabet(tuple(dict.fromkeys([*ordinary_atoms(left), *ordinary_atoms(right)])))
    one, other = Candidate("left", left), Candidate("right", right)
    question = Question("test", None, "", alphabet, alphabet, (one, other))
    return Pair(question, one, other, translate(left, alphabet), translate(right, alphabet))


def drawn(seeds: range) -> Iterator[Property]:
    """Properties over two signals, or one and news, whose short runs can all be tried."""
    for seed in seeds:
        property_ = Draw(seed).property(depth=1)
        formula = encode(property_, EPISODE)
        if len(ordinary_atoms(formula)) + len(news_of(formula)) <= 2:
            yield property_


def short_runs(signals: tuple[str, ...]) -> Iterator[Observation]:
    """All runs of one or two steps with short times."""
    for first, second in product(all_letters(signals), repeat=2):
        for gap, rest in product(range(5), repeat=2):
            yield Observation((Step(0, first),), gap, 0)
            yield Observation((Step(0, first), Step(gap, second)), gap + rest, 0)


def observed(word: Word) -> Observation:
    instants = [instant for instant in word if isinstance(instant, Instant)]
    return Observation(tuple(Step(i.time, i) for i in instants if not i.by_time), instants[-1].time, 0)


def sides(related: Related, left: Property, right: Property) -> list[tuple[Any, Property, Property]]:
    return [(related.left_only, left, right), (related.right_only, right, left)]


def with_other_bounds() -> Iterator[tuple[Property, Property]]:
    """Properties, and what they are with one bound a nanosecond longer."""
    for property_ in drawn(range(30)):
        for bound in time_bounds(property_):
            yield property_, with_bound(property_, bound.path, bound.duration + 1)


@pytest.mark.parametrize(("left", "right"), list(with_other_bounds()))
def test_what_is_said_of_finite_runs_in_time_is_so(left: Property, right: Property) -> None:
    compared = pair(encode(left, EPISODE), encode(right, EPISODE))
    related = relate_on_finite_runs(compared)
    for run, accepted, refused in sides(related, left, right):
        if run is not None:
            assert holds(accepted, observed(run.letters))
            assert not holds(refused, observed(run.letters))
            continue
        for other in short_runs(compared.question.atoms):
            assert holds(refused, other) or not holds(accepted, other)


def test_bounds_order_encodings_of_one_sentence() -> None:
    longer, shorter = (After(X, Within(bound, Eventually(Now(Y)))) for bound in (5, 2))
    compared = pair(encode(longer, EPISODE), encode(shorter, EPISODE))
    for relate in (relate_on_finite_runs, relate_on_infinite_runs):
        related = relate(compared)
        assert related.relation is Relation.WEAKER
        assert related.left_only is not None
        assert 2 < next(i.time for i in related.left_only.letters if isinstance(i, Instant) and "y" in i) <= 5


def test_a_difference_that_no_run_shows_is_not_claimed() -> None:
    once = Once("once x within 2 ns", X, 2)
    follows = Always(Now(Or(And(Y, Not(once)), And(Not(Y), once))))
    formula = And(encode(follows, EPISODE), encode(After(X, Eventually(Now(Y))), EPISODE))
    with pytest.raises(NotDecidedError, match="no run shows one"):
        relate_on_infinite_runs(pair(And(formula, encode(Eventually(Now(X)), EPISODE)), FALSE))


@pytest.mark.parametrize("seed", range(share_of(12)))
def test_other_bounds_end_as_the_definition_has_it(seed: int) -> None:
    draw = Draw(seed)
    property_ = draw.property(depth=1)
    run = draw.run(most=4)
    for bound in time_bounds(property_):
        alphabet = Alphabet(ordinary_atoms(encode(property_, EPISODE)))
        try:
            ranges = Bound(property_, bound.path, EPISODE, alphabet).ranges(run)
        except NotKnownError:
            continue
        assert [each.least for each in ranges] == [1, *(each.most + 1 for each in ranges[:-1])]
        assert ranges[-1].most == LARGEST
        for each in ranges:
            for duration in {each.least, min(each.most, each.least + 9), min(each.most, 30)}:
                later = LONG if each.verdict.is_permanent else 0
                assert holds(with_bound(property_, bound.path, duration), run._replace(until=run.until + later)) is (
                    each.verdict.holds
                )


def test_a_bound_that_matters_nearly_everywhere_is_not_listed() -> None:
    property_ = Within(5, Eventually(Always(Now(X))))
    steps = tuple(Step(10 * n, frozenset({"x"} if n % 2 else ())) for n in range(60))
    with pytest.raises(NotKnownError, match="more than 20 values"):
        Bound(property_, (), EPISODE, Alphabet(("x",))).ranges(Observation(steps, 600, 0))


PROPS = """decl bumper /bumper Bool.data
decl stopped /stopped Bool.data
decl far /far Bool.data
halt: always (bumper implies eventually stopped within 200 ms)
zone: after_until bumper, far, eventually stopped within 5 s
past: after_until once bumper within 2 s, far, eventually stopped
"""
RUN = """time,bumper,stopped,far
0,false,false,false
1,true,false,false
1.1,false,false,false
1.236,false,true,false
2,false,false,false
9,false,false,true
"""
OWN = """encoding hasty
after X, Z          = G(X -> next(G Z))
until X, Z          = Z U X
after_until X, Y, Z = G(X -> next(Z W Y))
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "props.txt").write_text(PROPS)
    (tmp_path / "run.csv").write_text(RUN)
    (tmp_path / "own.txt").write_text(OWN)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def compared(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict[str, Any]:
    assert main(["compare", "props.txt", *arguments, "--format", "json"]) == 0
    return {each["label"]: each for each in json.loads(capsys.readouterr().out)["properties"]}


@pytest.mark.usefixtures("folder")
def test_an_encoding_without_a_clock_for_a_bound_is_refused_by_itself(capsys: pytest.CaptureFixture[str]) -> None:
    found = compared(capsys, "--encodings", "episode,dwyer,dwyer-2")
    assert [each["name"] for each in found["zone"]["encodings"]] == ["episode"]
    assert all("5 s anew" in each["reason"] for each in found["zone"]["undefined"])
    assert len(found["halt"]["encodings"]) == 3
    assert {each["finite"]["relation"] for each in found["halt"]["comparisons"]} == {"equivalent"}


@pytest.mark.usefixtures("folder")
def test_an_encoding_that_speaks_of_the_next_step_is_refused_where_time_passes(
    capsys: pytest.CaptureFixture[str],
) -> None:
    found = compared(capsys, "--encoding-file", "own.txt", "--encodings", "episode,hasty")
    reasons = {each["name"]: each["reason"] for each in found["past"]["undefined"]}
    assert "time, which passes between steps" in reasons["hasty"]


@pytest.mark.usefixtures("folder")
def test_runs_that_tell_encodings_apart_have_times(capsys: pytest.CaptureFixture[str]) -> None:
    found = compared(capsys, "--encodings", "episode,dwyer")["past"]
    [relation] = found["comparisons"]
    assert relation["finite"]["relation"] == relation["infinite"]["relation"] == "weaker"
    steps = relation["finite"]["left_only"]["steps"]
    assert [step["by_time"] for step in steps] == [False, False]
    assert steps[0]["values"] == {"bumper": True, "far": False, "stopped": True}
    assert steps[0]["time_ns"] == 0 < steps[1]["time_ns"] <= 2 * 10**9
    assert found["encodings"][0]["earliest_violation"]["steps"][-1]["time_ns"] <= 2 * 10**9


@pytest.mark.usefixtures("folder")
def test_on_a_recording_other_bounds_are_told_with_the_step_that_matters(capsys: pytest.CaptureFixture[str]) -> None:
    found = compared(capsys, "--recording", "run.csv", "--encodings", "episode,dwyer")
    [recorded] = found["halt"]["recordings"]
    [bound] = recorded["bounds"]
    assert (bound["names"], bound["bound_ns"]) == (["episode", "dwyer"], 200_000_000)
    below, from_ = bound["endings"]
    assert (below["verdict"], below["most_ns"], below["step"]) == ("violated", 235_999_999, None)
    assert (from_["verdict"], from_["least_ns"], from_["most_ns"]) == ("presumably_satisfied", 236_000_000, None)
    assert (from_["step"], from_["time_ns"]) == (3, 1_236_000_000)
    assert from_["values"] == {"bumper": False, "stopped": True}
    [parting] = found["past"]["recordings"][0]["differences"]
    assert (parting["step"], parting["time_ns"], parting["by_time"]) == (4, 2 * 10**9, False)
    assert parting["values"] == {"bumper": False, "far": False, "stopped": False}


@pytest.mark.usefixtures("folder")
def test_the_text_has_times_and_other_bounds(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["compare", "props.txt", "--recording", "run.csv", "--encodings", "episode,dwyer"]) == 0
    out = capsys.readouterr().out
    assert "time in s" in out
    assert "more than 200 ms since the first bumper without stopped" in out
    assert "below 236 ms (as written)  violated" in out
    assert "from 236 ms                presumably satisfied  step 3, 1.236 s  bumper = false, stopped = true" in out
