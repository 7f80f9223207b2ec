"""The conformance suite: cases are what they say, ltlc gets a sample of them right, scores show what is wrong."""

from __future__ import annotations

import json
import sys
from collections import Counter
from dataclasses import replace
from itertools import count
from pathlib import Path

import pytest

from benchmarks.conformance import cases as suite
from benchmarks.conformance import journal, make, peers, proved, score, ways
from benchmarks.conformance.__main__ import main, problems_of
from benchmarks.conformance.cases import Case, Verdicts, case_of, load
from benchmarks.conformance.export import export
from benchmarks.conformance.make import Maker, least
from benchmarks.conformance.readings import BY_PARTS, READINGS
from benchmarks.conformance.score import Outside, scored
from benchmarks.differential import targets
from benchmarks.differential.samples import Recording, Row
from ltlc.assurance import c_library
from ltlc.assurance.evidence.claims import refusal
from ltlc.assurance.evidence.document import Summed
from ltlc.semantics.certificate_reader import parse

SAMPLE = range(1, 10_000, 60)
CASES = load(numbers=SAMPLE)
FEW = load(numbers=range(1, 10_000, 700))
LINES = [json.loads(line) for line in suite.FILE.read_text().splitlines()[1:]]


def test_cases_have_numbers_of_their_own_in_order_and_the_page_says_how_many_there_are() -> None:
    assert [line["id"] for line in LINES] == [*range(1, len(LINES) + 1)]
    assert suite.head()["version"] == suite.VERSION
    page = (suite.FILE.parents[2] / "docs" / "conformance.md").read_text()
    assert f"\n{len(LINES):,} numbered cases" in page


def test_every_reading_is_told_by_a_case_and_every_case_names_one() -> None:
    told = Counter(name for line in LINES for name in line["readings"])
    assert told.keys() == {*READINGS, BY_PARTS}
    assert all(line["readings"] for line in LINES)


def test_no_two_cases_have_the_same_specification_run_and_readings() -> None:
    seen = Counter(json.dumps([line["specification"], line["run"], line["readings"]]) for line in LINES)
    assert seen.most_common(1)[0][1] == 1


@pytest.mark.parametrize("case", CASES, ids=lambda case: str(case.number))
def test_a_case_is_what_the_definition_says(case: Case) -> None:
    assert problems_of(case, None) == []
    assert json.loads(json.dumps(case_of(case.document()).document())) == case.document()


@pytest.mark.parametrize("way", ["ltlc by rows", "ltlc by columns"])
def test_ltlc_gets_a_sample_right(way: str) -> None:
    found = scored(way, CASES, ways.answers(way, CASES))
    assert (found.wrong, found.missing, found.outside) == ({}, [], {})
    assert len(found.in_time) == len(CASES)


def test_a_clock_of_one_id_decides_between_messages_by_columns_too() -> None:
    cases = load(numbers=[2922, 3090, 4588])
    found = scored("ltlc by columns", cases, ways.answers("ltlc by columns", cases))
    assert (found.wrong, len(found.in_time)) == ({}, len(cases))


@pytest.mark.skipif(c_library.compiler() is None, reason="there is no C compiler here")
def test_c_has_no_warnings_where_a_whole_number_is_compared_with_itself_at_an_opening() -> None:
    cases = load(numbers=[1487])
    found = scored("ltlc in C", cases, ways.answers("ltlc in C", cases))
    assert (found.wrong, len(found.in_time)) == ({}, 1)


def test_the_judge_accepts_what_is_proved_and_no_other_verdict_or_time() -> None:
    judged = 0
    for case in (each for each in CASES if each.proved):
        stated = proved.stated(case)
        [certificate] = parse(stated.certificate)
        for claim in stated.claims:
            assert not isinstance(claim.letters, Summed)
            assert refusal(claim, claim.letters, certificate) is None
        time, verdict = case.expected.changes[-1]
        if verdict in ("violated", "satisfied"):
            later = Verdicts([*case.expected.changes[:-1], (time + 1, verdict)], case.expected.steps)
            recording = replace(case.recording, end=max(case.recording.end, time + 1))
            claims = proved.stated(replace(case, expected=later, recording=recording)).claims
            assert any(refusal(claim, claim.letters, certificate) for claim in claims)  # type: ignore[arg-type]
            judged += 1
    assert judged > 5


@pytest.mark.parametrize("case", FEW, ids=lambda case: str(case.number))
def test_nothing_can_be_left_out_of_a_case(case: Case) -> None:
    if BY_PARTS not in case.readings:
        found = least(case)
        assert (found.text, found.recording) == (case.text, case.recording)


def test_what_is_drawn_tells_its_readings_and_ltlc_finds_the_same() -> None:
    found = next(filter(None, (Maker(seed, set(), Counter()).cases() for seed in count(3000))))
    for case in found:
        assert problems_of(case, None) == []
        assert ways.agreement(case) in (ways.Agreement.SAME, ways.Agreement.EARLY, ways.Agreement.LATE)


def judge_that_says(word: str, folder: Path) -> Path:
    """A judge that answers each claim with `word`."""
    path = folder / "judge"
    claims = "sum(line.startswith('verdict ') for line in open(sys.argv[2]))"
    path.write_text(f"#!{sys.executable}\nimport sys\nfor _ in range({claims}):\n    print('p: {word}')\n")
    path.chmod(0o755)
    return path


def test_new_cases_are_numbered_after_those_that_there_are_and_none_comes_twice(tmp_path: Path) -> None:
    known, made = [replace(case, number=n) for n, case in enumerate(CASES[:2], 1)], tmp_path / "journal"
    lines = [{**case.document(), "outcome": "same"} for case in (CASES[0], *CASES[2:5], CASES[2])]
    lines.append({**CASES[5].document(), "outcome": "refuted"})
    made.write_text("".join(json.dumps(line) + "\n" for line in lines))
    found = journal.chosen(known, [made], 4)
    assert [case.number for case in found] == [3, 4]
    assert len(journal.chosen(known, [made], 100)) == 3
    assert main(["add", str(made), "--suite", str(tmp_path / "own"), "--most", "4"]) == 0
    assert [case.number for case in load(tmp_path / "own")] == [1, 2, 3, 4]


def test_a_case_is_proved_if_the_judge_accepts_it_and_not_taken_if_it_refuses_it(tmp_path: Path) -> None:
    case = next(case for case in CASES if case.proved and BY_PARTS not in case.readings)
    accepted = journal.settled(replace(case, proved=False), judge_that_says("violated, as claimed", tmp_path))
    assert accepted == ("same", case)
    outcome, _ = journal.settled(case, judge_that_says("REFUSED: no", tmp_path))
    assert outcome not in journal.TAKEN


def test_what_is_made_is_appended_to_a_journal_with_what_became_of_it(tmp_path: Path) -> None:
    made = tmp_path / "journal"
    judge = judge_that_says("violated, as claimed", tmp_path)
    assert main(["make", str(made), "--seconds", "0.1", "--seed", "3000", "--judge", str(judge)]) == 0
    found = [*journal.journalled(made)]
    assert found
    assert len({make.key(case) for case, _ in found}) == len(found)


TOOL = """
import json, sys
known = {}
for line in list(open(sys.argv[1]))[1:]:
    case = json.loads(line)
    known[case["id"]] = case["verdicts"]
for line in sys.stdin:
    question = json.loads(line)
    assert question.keys() == {"id", "specification", "run", "until"}
    number, verdicts = question["id"], known[question["id"]]
    match number % 5:
        case 0:
            print(json.dumps({"id": number, "outside": "too hard"}))
        case 1:
            print(json.dumps({"id": number, "verdicts": verdicts}))
        case 2:
            print(json.dumps({"id": number, "verdicts": [[time - 1, verdict] for time, verdict in verdicts]}))
        case 3:
            print(json.dumps({"id": number, "verdicts": [[0, "violated"]]}))
"""


def test_a_tool_that_is_wrong_in_places_has_a_score_that_shows_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    chosen = [case for case in load(numbers=range(1, 400)) if case.expected.changes]
    chosen = [case for case in chosen if case.expected.changes != [(0, "violated")]]
    some = [replace(case, number=number) for number, case in enumerate(chosen[:50], 1)]
    tool, own = tmp_path / "tool.py", tmp_path / "cases.jsonl"
    tool.write_text(TOOL)
    suite.save(some, own)
    command = [sys.executable, str(tool), str(own)]
    found = scored("tool", some, score.asked(command, some, 60))
    assert [*found.outside] == [number for number in range(1, 51) if number % 5 == 0]
    assert found.missing == [number for number in range(1, 51) if number % 5 == 4]
    assert found.in_time == [number for number in range(1, 51) if number % 5 == 1]
    assert [*found.wrong] == [number for number in range(1, 51) if number % 5 in (2, 3)]
    assert {number for number in range(1, 51) if number % 5 in (1, 2)} <= {*found.end}
    assert main(["--suite", str(own), "--tool", " ".join(command), "--wrong"]) == 1
    printed = capsys.readouterr().out
    assert "| 40 (80%) |" in printed
    assert "| 10 (25.0%) | 10 |" in printed
    assert printed.count(": case ") == 20


def test_a_verdict_at_the_end_at_each_step_and_in_time_are_three_things() -> None:
    recording = Recording([Row(0, {}), Row(10, {})], 0, 20)
    expected = Verdicts([(0, "presumably_violated"), (5, "violated")], [0, 10])
    case = Case(1, (), "decl v /v Float64.data\np: v\n", recording, expected)
    late = scored("", [case], {1: Verdicts([(0, "presumably_violated"), (15, "violated")], ())})
    early = scored("", [case], {1: Verdicts([(0, "presumably_violated"), (7, "violated")], ())})
    right = scored("", [case], {1: Verdicts([(0, "presumably_violated"), (5, "violated"), (9, "violated")], ())})
    assert [(each.end, each.at_steps, each.in_time) for each in (late, early, right)] == [
        ([1], [], []),
        ([1], [1], []),
        ([1], [1], [1]),
    ]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("garbage", "line 1"),
        ('{"verdicts": []}', "there is no `id`"),
        ('{"id": 1}', "'verdicts'"),
        ('{"id": 1, "verdicts": [[0.5, "violated"]]}', "whole nanoseconds"),
        ('{"id": 1, "verdicts": [[0, "false"]]}', "presumably_satisfied"),
        ('{"id": 1, "verdicts": [[5, "violated"], [4, "satisfied"]]}', "the times go back"),
        ('{"id": 1, "verdicts": []}\n{"id": 1, "verdicts": []}', "line 2: case 1 has two answers"),
    ],
)
def test_what_is_no_answer_is_refused_with_its_line(
    text: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "answers"
    path.write_text(text + "\n")
    assert main(["--answers", str(path), "--cases", "1-3"]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--tool", "no-such-tool"], "cannot be run"),
        (["--tool", "false"], "exit code 1"),
        (["--tool", "sleep 9", "--timeout", "0.2"], "--timeout"),
        (["--answers", "no/such/file"], "cannot be read"),
        (["--suite", "no/such/file"], "No such file"),
    ],
)
def test_a_tool_that_cannot_be_asked_is_reported(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*arguments, "--cases", "1"]) == 2
    assert message in capsys.readouterr().err


def test_exported_files_are_judged_as_the_case_says(tmp_path: Path) -> None:
    some = [case for case in CASES if case.names.rate is None][:25]
    export(some, tmp_path)
    bags = 0
    for case in some:
        folder = tmp_path / f"{case.number:05}"
        assert case_of(json.loads((folder / "case.json").read_text())).document() == case.document()
        of = targets.monitors((folder / "props.ltlc").read_text())
        for path in sorted(folder.glob("run.*")):
            bags += path.suffix == ".mcap"
            [found] = targets.by_file(of, path, None, case.recording.end).values()
            assert found.verdict == case.expected.at(case.recording.end), path
    assert bags > 10


def formula(sentence: str, language: peers.Language = peers.REELAY) -> peers.Formula:
    declarations = "decl v /v Float64.data\ndecl w /w Float64.data\ndecl flag /flag Bool.data\n"
    case = Case(1, (), f"{declarations}p: {sentence}\n", Recording([Row(0, {})], 0, 0), Verdicts([], []))
    [node] = case.names.properties.values()
    return peers.Translator(language, case).formula(node)


def test_a_peer_is_asked_a_formula_of_the_past() -> None:
    never = formula("never v > 2")
    assert (never.text, never.holds, never.fails) == (
        "historically(not({v > 2.0}))",
        "presumably_satisfied",
        "violated",
    )
    assert formula("eventually flag", peers.RTAMT) == peers.Formula(
        "once((flag >= 1))", "satisfied", "presumably_violated"
    )
    assert formula("always (v < 1 implies eventually w > 2)").text == (
        "not(((not({w > 2.0})) since (({v < 1.0}) and not({w > 2.0}))))"
    )
    assert formula("after flag, never v > 1").text == "historically((once({flag})) -> (not({v > 1.0})))"


@pytest.mark.parametrize(
    ("sentence", "because"),
    [
        ("eventually flag within 1 s", "bounds"),
        ("never once flag within 1 s", "bounds"),
        ("never previously flag", "previously"),
        ("always new v", "news"),
        ("never v >{0.1} 1", "margins"),
        ("after_until flag, v > 1, never w > 1", "after_until"),
    ],
)
def test_what_a_peer_cannot_say_with_the_same_meaning_is_outside(sentence: str, because: str) -> None:
    with pytest.raises(peers.OutsideError, match=because):
        formula(sentence)


def test_what_a_peer_shows_becomes_verdicts_with_the_times_of_its_samples() -> None:
    text = "decl v /v Float64.data\np: never v > 2\n"
    rows = [Row(1, {"/v": {"v": 0.0}}), Row(5, {"/v": {"v": 3.0}}), Row(9, {"/v": {"v": 0.0}})]
    case = Case(1, (), text, Recording(rows, 1, 9), Verdicts([], []))
    asked: list[str] = []

    def shows(said: str, samples: object) -> list[bool]:
        asked.append(said)
        return [True, False, False]

    found = peers.answer(peers.Peer(peers.REELAY, shows), case)
    assert found == Verdicts([(1, "presumably_satisfied"), (5, "violated")], ())
    assert asked == ["historically(not({v > 2.0}))"]
    assert isinstance(
        peers.answer(peers.Peer(peers.REELAY, shows), replace(case, text=text.replace("v > 2", "new v"))), Outside
    )


def test_a_peer_that_is_not_installed_is_named_with_how_to_install_it(capsys: pytest.CaptureFixture[str]) -> None:
    names = [name for name, _ in peers.answers([], None)]
    said = capsys.readouterr().err
    assert all(name in names or (name in said and "pip install" in said) for name in peers.PEERS)
