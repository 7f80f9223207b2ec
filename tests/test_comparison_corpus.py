"""Ways to make a monitor side by side: they agree, and a way that is wrong is found."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from ltlc.analysis.comparison import constructors
from ltlc.analysis.comparison.constructors import CONSTRUCTORS, Built, measure
from ltlc.automata import Budget, Exceeded
from ltlc.automata.corpora import CORPORA, corpus
from ltlc.cli import main
from ltlc.interfaces.api.corpus import measure_corpus
from ltlc.semantics.ltl import Atom, Next, eventually, globally, implies, size

A, B = Atom("a"), Atom("b")
BUDGET = Budget(seconds=20.0)


@pytest.mark.parametrize(("name", "formulas"), [("dac", 55), ("eh", 12), ("hkrss", 55), ("p", 20)])
def test_a_collection_is_whole(name: str, formulas: int) -> None:
    found = corpus(name)
    assert len(found) == formulas
    assert len({label for label, _ in found}) == formulas


def test_random_formulas_come_from_their_seed() -> None:
    assert corpus("random", seed=1, count=5) == corpus("random", seed=1, count=5)
    assert corpus("random", seed=1, count=5) != corpus("random", seed=2, count=5)
    assert all(size(formula) < 200 for _, formula in corpus("random", count=50))


@pytest.mark.parametrize("name", ["eh", "p"])
def test_all_ways_give_the_same_monitor(name: str) -> None:
    done = measure_corpus(name, budget=BUDGET)
    assert done.agrees
    assert done.is_complete
    assert all(len(trial.agrees) >= 2 for trial in done.trials)


def test_all_ways_give_the_same_monitor_of_random_formulas_and_of_constants() -> None:
    formulas = [*corpus("random", seed=7, count=15), ("true", implies(A, A)), ("next", globally(Next(A)))]
    for trial in measure(formulas, BUDGET):
        assert all(trial.agrees.values()), trial


@pytest.mark.skipif(shutil.which("mona") is None, reason="mona is not installed")
def test_mona_is_one_of_the_ways() -> None:
    [trial] = measure([("response", globally(implies(A, eventually(B))))], BUDGET)
    assert trial.agrees["mona"]


def test_a_way_that_is_wrong_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = replace(CONSTRUCTORS[1], construct=lambda formula, alphabet: CONSTRUCTORS[0].construct(A, alphabet))
    monkeypatch.setattr(constructors, "CONSTRUCTORS", (CONSTRUCTORS[0], wrong, *CONSTRUCTORS[2:]))
    [trial] = measure([("response", globally(implies(A, eventually(B))))], BUDGET)
    assert not trial.agrees["progression"]


def test_a_formula_that_takes_too_long_is_a_line_like_the_others() -> None:
    hard = dict(corpus("blowup"))["kv-psi(2)"]
    [trial] = measure([("kv-psi(2)", hard)], Budget(seconds=0.05))
    assert isinstance(trial.outcomes["product"], Exceeded)


def test_the_command_prints_a_table_of_all_ways(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["compare", "--corpus", "random", "--count", "5", "--format", "json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["corpus"] == "random"
    assert [c["name"] for c in document["constructors"]][:2] == ["product", "progression"]
    assert document["constructors"][1]["agree"] == 5
    assert len(document["formulas"]) == 5
    assert document["formulas"][0]["results"][0]["states"] >= 1


def test_formulas_in_a_file_are_a_corpus(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("own.tsv").write_text("# two\nresponse\tG(a -> F b)\nsafety\tG !a\n")
    assert main(["compare", "--corpus", "own.tsv"]) == 0
    assert "product" in capsys.readouterr().out
    assert main(["compare", "--corpus", "nothing"]) == 2
    error = capsys.readouterr().err
    assert all(name in error for name in CORPORA)


def test_what_each_way_made_has_its_size() -> None:
    [trial] = measure([("absence", globally(A))], BUDGET)
    built = trial.outcomes["product"]
    assert isinstance(built, Built)
    assert constructors.sizes(built.monitor) == (2, 3)
