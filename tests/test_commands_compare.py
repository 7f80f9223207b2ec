"""`ltlc compare`: what it prints and how it ends."""

import csv
import io
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

import ltlc
from ltlc.cli import main

STOP = """
_margin_ = 0.01
stop: after_until robot.distance.stop_sign < 1, robot.distance.stop_sign > 1, eventually robot.velocity == 0
"""
DRIVES_ON = "time,robot.distance.stop_sign,robot.velocity\n0,5,1\n1,0.5,0\n2,0.6,1\n3,2,1\n"
OWN = """encoding patient
after X, Z          = G(X -> G Z)
until X, Z          = Z U X
after_until X, Y, Z = G((X & !Y & F Y) -> rel(Y, Z))
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "props.txt").write_text(STOP)
    (tmp_path / "run.csv").write_text(DRIVES_ON)
    (tmp_path / "own.txt").write_text(OWN)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def compare(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = main(["compare", *arguments])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def document(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict[str, Any]:
    code, out, _ = compare(capsys, *arguments, "--format", "json")
    assert code == 0
    loaded: dict[str, Any] = json.loads(out)
    return loaded


def test_json_has_the_encodings_and_how_each_pair_relates(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    [stop] = document(capsys, "props.txt")["properties"]
    assert (stop["label"], stop["line"]) == ("stop", 3)
    assert [e["name"] for e in stop["encodings"]] == ["episode", "pointwise", "pointwise-strong", "dwyer"]
    assert all(e["states"] > 1 and e["formula"] for e in stop["encodings"])
    assert len(stop["comparisons"]) == 6
    [found] = [c for c in stop["comparisons"] if (c["left"], c["right"]) == ("episode", "dwyer")]
    assert found["finite"]["relation"] == "weaker"
    assert found["finite"]["right_only"] is None
    run = found["finite"]["left_only"]
    assert run["loop"] is None
    assert run["steps"][-1]["left"] == "presumably_satisfied"
    assert run["steps"][-1]["right"] == "presumably_violated"
    distances = [step["values"]["robot.distance.stop_sign"] for step in run["steps"]]
    assert all(0 <= distance < 1 for distance in distances)
    assert found["infinite"]["left_only"]["loop"] is not None


def test_a_recording_tells_where_the_choice_would_have_mattered(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    [stop] = document(capsys, "props.txt", "--encodings", "episode,dwyer", "--recording", "run.csv")["properties"]
    [recorded] = stop["recordings"]
    assert recorded["verdicts"] == {"episode": "presumably_satisfied", "dwyer": "violated"}
    [difference] = recorded["differences"]
    assert difference["step"] == 2
    _, out, _ = compare(capsys, "props.txt", "--encoding", "episode,dwyer", "--recording", "run.csv", "--format", "csv")
    assert {row["recordings"] for row in csv.DictReader(io.StringIO(out))} == {"run.csv: step 2"}


def test_an_encoding_of_the_users_goes_through_the_same_questions(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ("props.txt", "--encoding-file", "own.txt", "--encodings", "dwyer,patient")
    [stop] = document(capsys, *arguments)["properties"]
    assert stop["comparisons"][0]["infinite"]["relation"] == "stronger"


def test_an_encoding_that_says_nothing_about_a_sentence_is_named(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "props.txt").write_text("after robot.velocity > 1, until robot.velocity > 2, robot.velocity < 3\n")
    [found] = document(capsys, "props.txt", "--encodings", "episode,dwyer-1")["properties"]
    assert [each["name"] for each in found["undefined"]] == ["dwyer-1"]
    assert [each["name"] for each in found["encodings"]] == ["episode"]


def test_scopes_inside_scopes_that_grow_too_large_are_named(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    sentence = "robot.velocity > 0"
    for k in range(12):
        sentence = f"after_until robot.velocity > {k}, robot.velocity < {k}, eventually ({sentence})"
    (folder / "props.txt").write_text(sentence + "\n")
    [found] = document(capsys, "props.txt", "--encodings", "episode,pointwise", "--budget", "2")["properties"]
    assert [each["name"] for each in found["undefined"]] == ["episode"]


def test_runs_that_the_numbers_do_not_allow_tell_nothing_apart(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "props.txt").write_text(
        "object sign at (10, 0, 0)\n"
        "until car.position.x > 45, always (car.distance.sign < 1 implies car.velocity < 1)\n"
    )
    [found] = document(capsys, "props.txt", "--encodings", "episode,pointwise")["properties"]
    for kind in ("infinite", "finite"):
        related = found["comparisons"][0][kind]
        for run in (related["left_only"], related["right_only"]):
            assert run is None or all(step["values"] is not None for step in run["steps"])


def test_formulas_are_compared_as_they_are_given(capsys: pytest.CaptureFixture[str]) -> None:
    [found] = document(capsys, "--ltl", "F a", "!G !a", "a", "--reading", "infinite")["properties"]
    relations = {(c["left"], c["right"]): c["infinite"]["relation"] for c in found["comparisons"]}
    assert relations == {("F a", "!G !a"): "equivalent", ("F a", "a"): "weaker", ("!G !a", "a"): "weaker"}
    assert "finite" not in found["comparisons"][0]


def test_formulas_that_are_called_alike_are_numbered(capsys: pytest.CaptureFixture[str]) -> None:
    [found] = document(capsys, "--ltl", "G a", "F a", "G a", "G a")["properties"]
    assert found["text"] == "G a / F a / G a (2) / G a (3)"


def test_a_table_of_formulas_is_compared_line_by_line(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "two.tsv").write_text("pattern\tfirst edition\tsecond edition\nabsence\tG !p\tG !p\nexistence\tF p\t-\n")
    absence, existence = document(capsys, "--ltl-file", "two.tsv")["properties"]
    assert (absence["label"], absence["line"]) == ("absence", 2)
    assert absence["comparisons"][0]["right"] == "second edition"
    assert existence["comparisons"] == []


def test_csv_has_a_row_for_each_pair_and_kind_of_runs(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _, out, _ = compare(capsys, "props.txt", "--encodings", "episode,dwyer", "--format", "csv")
    rows = list(csv.DictReader(io.StringIO(out)))
    assert [(row["runs"], row["relation"]) for row in rows] == [("infinite", "weaker"), ("finite", "weaker")]


def test_text_markdown_and_html_show_the_values_and_both_verdicts(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for form in ("text", "md", "html"):
        code, out, _ = compare(capsys, "props.txt", "--encodings", "episode,dwyer", "--format", form)
        assert code == 0
        for expected in ("robot.distance.stop", "presumably violated", "is weaker than"):
            assert expected in out.replace("\\", "")


def test_html_is_well_formed_whatever_a_formula_is_called(capsys: pytest.CaptureFixture[str]) -> None:
    _, out, _ = compare(capsys, "--ltl", '"<b>&" U a', "a", "--format", "html")
    ElementTree.fromstring(out.replace("<!DOCTYPE html>", "").replace('<meta charset="utf-8">', ""))


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (["missing.txt"], 2, "LTL901"),
        (["props.txt", "--encodings", "episod"], 2, "did you mean `episode`"),
        (["--ltl", "a U (b"], 1, "LTL321"),
        (["--ltl", "F[0:20]" * 20 + "a", "--budget=0.3"], 2, "to read the formulas takes longer than 0.3 s"),
        (["--ltl", *(f"p{k}" for k in range(1001))], 2, "1001 formulas would be compared with one another"),
        (["--ltl", "a", "--recording", "run.csv"], 2, "--recording needs PROPS"),
        (["props.txt", "--recording", "missing.csv"], 2, "LTL901"),
        (["props.txt", "--encoding-file", "props.txt"], 1, "LTL32"),
        (["--ltl-file", "missing.tsv"], 2, "LTL901"),
    ],
)
def test_unusable_input_is_refused_with_the_reason(
    folder: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], code: int, said: str
) -> None:
    ended, out, err = compare(capsys, *arguments)
    assert (ended, out) == (code, "")
    assert said in err


def test_without_spot_the_command_says_how_to_get_it(tmp_path: Path) -> None:
    (tmp_path / "spot.py").write_text("raise ImportError('not here')\n")
    command = [sys.executable, "-c", "from ltlc.cli import main; raise SystemExit(main(['compare', '--ltl', 'a']))"]
    paths = os.pathsep.join([str(tmp_path), *sys.path])
    environment = {**os.environ, "PYTHONPATH": paths}
    done = subprocess.run(command, check=False, capture_output=True, text=True, env=environment)
    assert (done.returncode, done.stdout) == (2, "")
    assert "pip install spottl" in done.stderr
    assert "Traceback" not in done.stderr


def test_the_python_interface_gives_the_same_answers(folder: Path) -> None:
    table = ltlc.compare(Path("props.txt"), encodings=["episode", "dwyer"])
    assert [row["relation"] for row in table.rows()] == ["weaker", "weaker"]
    assert table["stop"].measured[0].name == "episode"
    assert "<table>" in table._repr_html_()
    assert ltlc.compare(STOP, encodings=["episode", "dwyer"]).rows()[0]["left_only"] == table.rows()[0]["left_only"]


def test_the_python_interface_raises_what_the_command_reports() -> None:
    with pytest.raises(ltlc.UnusableInput, match="no encoding"):
        ltlc.compare(STOP, encodings=["episode", "nonsense"])
    with pytest.raises(ltlc.UnusableInput, match="Spot's syntax"):
        ltlc.compare(ltl=["a U"])
