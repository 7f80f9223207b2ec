"""`ltlc check` and `ltlc explain` as a user calls them: what goes where, and the exit codes."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
from sarif_schema import problems

from ltlc.cli import main

CLEAN = "limit: never robot.velocity > 2\n"
WARNED = "still: eventually robot.velocity == 0\n"
NOTED = "near: after_until robot.distance.sign < 1, robot.distance.sign > 1, robot.velocity < 0.1\n"
UNBOUNDED = "calm: always (robot.velocity > 1 implies eventually robot.velocity < 0.1)\n"
WRONG = "band: always (robot.velocity < 1 and robot.velocity > 2)\n"


@pytest.fixture
def check(tmp_path: Path) -> Any:
    def run(text: str, *arguments: str) -> int:
        path = tmp_path / "props.txt"
        path.write_text(text, encoding="utf-8")
        return main(["check", str(path), *arguments])

    return run


@pytest.mark.parametrize(
    ("text", "strict", "code"),
    [(CLEAN, 0, 0), (CLEAN, 1, 0), (WARNED, 0, 0), (WARNED, 1, 1), (NOTED, 1, 0), (WRONG, 0, 1), ("never", 0, 1)],
)
def test_errors_fail_and_warnings_fail_if_strict(check: Any, text: str, strict: int, code: int) -> None:
    assert check(text, *["--strict"] * strict) == code


def test_a_file_that_is_not_there_is_unusable(tmp_path: Path) -> None:
    assert main(["check", str(tmp_path / "none.txt")]) == 2


def test_diagnostics_go_to_stderr_and_a_line_for_each_property_to_stdout(check: Any, capsys: Any) -> None:
    check(CLEAN + WARNED + "odd: never robot.distance.wall < 0\n" + WRONG)
    output = capsys.readouterr()
    assert output.out == "limit: can hold, can fail\nstill: can hold, can fail\nodd: cannot fail\nband: cannot hold\n"
    assert "warning[LTL520]" in output.err
    assert "error[LTL501]" in output.err


def test_an_example_is_shown_as_a_table(check: Any, capsys: Any) -> None:
    check(NOTED, "--pedantic")
    lines = [line.strip() for line in capsys.readouterr().err.splitlines()]
    head = lines.index("step  robot.distance.sign  robot.velocity")
    assert lines[head + 1].split()[:2] == ["0", "1"]


def test_json_is_one_document_with_properties_and_diagnostics(check: Any, capsys: Any) -> None:
    check(NOTED, "--pedantic", "--format", "json")
    output = capsys.readouterr()
    document = json.loads(output.out)
    assert output.err == ""
    (stated,) = document["properties"]
    assert (stated["label"], stated["can_hold"], stated["can_fail"]) == ("near", True, True)
    (found,) = document["diagnostics"]
    assert (found["code"], found["name"], found["severity"]) == ("LTL511", "events-gap", "note")
    assert found["span"]["start"] == {"line": 1, "column": 19}
    assert found["example"]["steps"][0]["values"]["robot.distance.sign"] == 1


def test_opinions_are_told_on_demand_and_can_be_ignored_all_the_same(check: Any, capsys: Any) -> None:
    for text, arguments in ((NOTED, ()), (f"# ltlc: ignore events-gap\n{NOTED}", ()), (UNBOUNDED, ("--strict",))):
        assert check(text, *arguments) == 0
        assert capsys.readouterr().err == ""
    assert check(f"# ltlc: ignore events-gap\n{NOTED}", "--pedantic") == 0
    assert capsys.readouterr().err == ""
    assert check(UNBOUNDED, "--strict", "--pedantic") == 1
    assert "warning[LTL506]" in capsys.readouterr().err


def test_json_of_a_file_with_errors_has_no_properties(check: Any, capsys: Any) -> None:
    check("never", "--format", "json")
    assert json.loads(capsys.readouterr().out)["properties"] == []


@pytest.mark.parametrize("text", [CLEAN, WARNED + NOTED, WRONG, "never", "", CLEAN + "mild: never robot.velocity > 3"])
def test_sarif_is_as_the_standard_has_it(check: Any, capsys: Any, text: str) -> None:
    check(text, "--format", "sarif")
    assert problems(json.loads(capsys.readouterr().out)) == []


def test_the_check_of_sarif_sees_what_is_wrong() -> None:
    log = {"version": "2.0", "runs": [{"tool": {"driver": {"rules": []}}, "results": [], "extra": 1}]}
    assert len(problems(log)) == 3


def test_a_small_budget_ends_with_what_was_not_decided(check: Any, capsys: Any) -> None:
    assert check(CLEAN + WARNED, "--budget", "0.001", "--format", "json") == 0
    document = json.loads(capsys.readouterr().out)
    assert {d["name"] for d in document["diagnostics"]} == {"not-decided"}
    assert document["properties"][0]["can_hold"] is None


def test_a_property_that_explodes_leaves_the_others_their_findings(check: Any, capsys: Any) -> None:
    declarations = "".join(f"decl s{k} /s{k} Bool.data\n" for k in range(14))
    many = " and ".join(f"(always (s{k} implies eventually s{k + 1}))" for k in range(13))
    check(f"{declarations}{WARNED}many: {many}\n", "--budget", "4", "--format", "json")
    found = {(d["name"], d["span"]["start"]["line"]) for d in json.loads(capsys.readouterr().out)["diagnostics"]}
    assert ("exact-equality", 15) in found
    assert any(name == "not-decided" for name, _ in found)


def test_another_encoding_is_analysed_as_such(check: Any, capsys: Any) -> None:
    text = "now: after_until robot.velocity > 1, robot.velocity > 2, robot.velocity > 3\n"
    check(text, "--encoding", "pointwise-strong", "--format", "json")
    assert json.loads(capsys.readouterr().out)["properties"][0]["can_hold"] is True


def test_explain_shows_the_page_of_a_code(capsys: Any) -> None:
    assert main(["explain", "vacuous-part"]) == 0
    assert capsys.readouterr().out.startswith("# LTL504: vacuous-part\n")


def test_explain_says_what_a_property_means_and_shows_a_run_for_each_verdict(tmp_path: Path, capsys: Any) -> None:
    path = tmp_path / "props.txt"
    path.write_text("brake: after robot.position.x > 5, eventually robot.velocity =={0.01} 0\n", encoding="utf-8")
    assert main(["explain", str(path)]) == 0
    output = capsys.readouterr().out
    sentence = "Once the x position of robot is more than 5 for the first time: at some step from then on, the speed of"
    assert sentence in output
    assert (
        "\n  atom     robot.position.x > 5: the x position of robot is more than 5\n"
        "  atom     robot.velocity =={0.01} 0: the speed of robot is within 0.01 of 0\n"
        "  topics   /model/robot/odometry\n"
        "  begins   when /model/robot/odometry has delivered a value that it reads\n"
        "  class    obligation: a Boolean combination of safety and guarantee\n"
        "  monitor  3 states; while the robot runs it can report satisfied, presumably satisfied and presumably"
    ) in output
    for caption in ("satisfied, whatever follows", "presumably satisfied", "presumably violated"):
        assert f"\n  {caption}\n" in output
    assert "never violated" in output


def test_explain_shows_a_message_that_opens_a_scope_and_then_gets_old(tmp_path: Path, capsys: Any) -> None:
    (tmp_path / "p.txt").write_text("decl s /odom Odometry.twist.twist.linear.x\nafter new s, always age(s) <= 1.7 s\n")
    assert main(["explain", str(tmp_path / "p.txt")]) == 0
    shown = capsys.readouterr().out
    assert re.search(r"violated at the earliest\n.*\n +0 +0 +true .*\n +1\.700000001 +false  violated\n", shown)


def test_explain_of_what_is_neither_a_file_nor_a_code_is_unusable() -> None:
    assert main(["explain", "nonsense"]) == 2


def test_explain_of_a_code_that_there_is_not_says_so(capsys: Any) -> None:
    assert main(["explain", "LTL999"]) == 2
    assert "no diagnostic is called LTL999" in capsys.readouterr().err


COMMANDED = "decl speed /cmd_vel Twist.linear.x\ndecl x /odom Odometry.pose.pose.position.x\n"


def test_what_no_controller_can_keep_is_a_finding(check: Any, capsys: Any) -> None:
    assert check(f"{COMMANDED}p: always (x <= 10 and speed <= 1)", "--controls", "/cmd_vel") == 1
    assert "error[LTL616]" in capsys.readouterr().err


def test_a_controller_of_what_no_property_reads_is_a_usage_error(check: Any, capsys: Any) -> None:
    assert check(f"{COMMANDED}p: always speed <= 1", "--controls", "/cmd_vl") == 2
    assert "did you mean `/cmd_vel`?" in capsys.readouterr().err
