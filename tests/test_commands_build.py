"""`ltlc build`, `certify` and `run` as a user calls them: what is written, what is said, and the exit codes."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from ltlc.assurance.certify import NotCertified
from ltlc.assurance.foresight import Foreseen, Unforeseen
from ltlc.assurance.gate import Judgement
from ltlc.assurance.reading.outcomes import Difference
from ltlc.assurance.replay import Deviation
from ltlc.assurance.runs import Agreement, Mismatch
from ltlc.automata import Budget, Exceeded, Limit, batch
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.limits import Watch
from ltlc.cli import main
from ltlc.compiler import Compiled, compile_specification
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.certificate import check
from ltlc.semantics.encodings import EPISODE
from ltlc.semantics.instants import Instant
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.specification import Specification

PROPERTIES = "slow: never robot.velocity > 2\nafter robot.velocity > 1, eventually robot.velocity =={0.1} 0\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "props.txt").write_text(PROPERTIES)
    return tmp_path


@pytest.mark.parametrize(
    ("target", "name"),
    [
        ("ros2", "props_monitor.py"),
        ("python", "props_monitor.py"),
        ("hoa", "props.hoa"),
        ("dot", "props.dot"),
        ("json", "props.json"),
    ],
)
def test_build_writes_its_output_where_one_stands_and_says_what_was_checked(
    folder: Path, capsys: Any, target: str, name: str
) -> None:
    assert main(["build", "props.txt", "--target", target]) == 0
    assert sorted(path.name for path in folder.iterdir()) == sorted(["props.txt", name])
    shown = capsys.readouterr().out.splitlines()
    assert shown[0].startswith("slow: 2 states, 2 letters; certified; as defined on ")
    assert shown[1].startswith("line 2: ")
    assert shown[2] == f"wrote {name}"


def test_a_signal_may_be_called_what_an_emitted_class_calls_its_own(folder: Path) -> None:
    text = "decl values /v Float64.data\nalways (once values > 3 within 1 s or @{values, -1} > 0)\n"
    (folder / "values.txt").write_text(text)
    assert main(["build", "values.txt", "--target", "python", "-o", "values.py"]) == 0


@pytest.mark.usefixtures("quickly")
def test_the_same_file_gives_the_same_bytes(folder: Path) -> None:
    main(["build", "props.txt", "-o", "one.py", "--certificate", "one.cert"])
    main(["build", "props.txt", "-o", "two.py", "--certificate", "two.cert"])
    assert (folder / "one.py").read_bytes() == (folder / "two.py").read_bytes()
    assert (folder / "one.cert").read_bytes() == (folder / "two.cert").read_bytes()


@pytest.mark.usefixtures("quickly")
def test_six_places_are_patrolled_with_a_certificate(folder: Path, capsys: Any) -> None:
    places = "\n".join(f"decl l{n} /l{n} Bool.data" for n in range(6))
    patrol = " and ".join(f"(always eventually l{n})" for n in range(6))
    (folder / "props.txt").write_text(f"{places}\npatrol: {patrol}\n")
    assert main(["build", "props.txt", "--target", "hoa", "--certificate", "props.cert"]) == 0
    assert main(["certify", "props.txt", "props.cert"]) == 0
    assert "patrol: certified, exactly" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("bound", "said"), [({"work": 10}, "takes more work"), ({"depth": 1}, "nested case distinctions")]
)
def test_a_certificate_beyond_a_bound_says_which_and_how_to_go_on(
    folder: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch, bound: dict[str, Any], said: str
) -> None:
    monkeypatch.setattr("ltlc.assurance.exactness.check", partial(check, **bound))
    assert main(["build", "props.txt"]) == 1
    shown = capsys.readouterr().err
    assert "error[LTL705]: the monitor of `line 2` is not certified" in shown
    assert said in shown
    assert "as a separate property" in shown
    assert [path.name for path in folder.iterdir()] == ["props.txt"]


def test_judging_that_takes_too_long_says_how_to_allow_more(
    folder: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []

    def exceeded(compiled: Sequence[object], _: object, __: object, budget: Budget, *___: object) -> list[Exceeded]:
        asked.append(budget)
        return [Exceeded(Limit.TIME, budget)] * len(compiled)

    monkeypatch.setattr("ltlc.interfaces.building.build.judge_all", exceeded)
    assert main(["build", "props.txt", "--budget", "20,512"]) == 1
    assert asked == [Budget(120, 1024)]
    shown = capsys.readouterr().err
    assert "error[LTL704]: judging `slow` takes longer than 120 s" in shown
    assert "`--budget SECONDS,MB`" in shown


def test_build_leaves_its_output_and_nothing_else(folder: Path) -> None:
    environment = {name: value for name, value in os.environ.items() if not name.startswith("HYPOTHESIS")}
    subprocess.run([sys.executable, "-m", "ltlc", "build", "props.txt"], env=environment, check=True)
    assert sorted(path.name for path in folder.iterdir()) == ["props.txt", "props_monitor.py"]


@pytest.mark.parametrize("options", [["-o"], ["--certificate"], ["--target", "c", "-o"]])
@pytest.mark.parametrize("path", ["no/such/folder.py", ".", "fifo"])
def test_what_cannot_be_written_is_said_before_any_work(
    folder: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch, options: list[str], path: str
) -> None:
    os.mkfifo(folder / "fifo")
    monkeypatch.setattr("ltlc.interfaces.commands.build.compile_file", lambda *_, **__: pytest.fail("work was done"))
    assert main(["build", "props.txt", *options, path]) == 2
    assert f"{path} cannot be written: " in capsys.readouterr().err
    assert sorted(each.name for each in folder.iterdir()) == ["fifo", "props.txt"]


AGREED = Agreement(1, 1, 1)
RUN = (frozenset("ba"), frozenset[str](), Instant(5, "a"))
DIFFERS = Deviation(1, "the time 0.0 s", {"steps": 1, "verdict": "violated"}, {"steps": 2, "verdict": "violated"})
DEFINED, NO_CODE = "as defined on 1 run (all to length 1)", "not replayed: the output is not code"
MISJUDGED = {
    "LTL702": (
        Judgement(NotCertified(""), Foreseen(2), Mismatch(RUN, Verdict.VIOLATED, "not so"), None),
        f"; NOT certified; NOT as defined; {NO_CODE}",
        "the monitor of `slow` reports violated after `a` and `b`; none of the atoms; `a` at 5 ns, but: not so",
    ),
    "LTL703": (
        Judgement(NotCertified(""), Foreseen(2), AGREED, DIFFERS),
        f"; NOT certified; {DEFINED}; the code behaves DIFFERENTLY",
        "of `slow` behaves incorrectly: steps = 2 instead of steps = 1 after 1 event, the last being the time 0",
    ),
    "LTL704": (Exceeded(Limit.TIME, Budget(2.0, 64)), "; not judged", "judging `slow` takes longer than 2 s"),
    "LTL705": (
        Judgement(NotCertified("too large"), Foreseen(2), AGREED, None),
        f"; NOT certified; {DEFINED}; {NO_CODE}",
        "the monitor of `slow` is not certified: too large",
    ),
    "LTL706": (
        Judgement(NotCertified(""), Unforeseen(frozenset({"a"}), ()), AGREED, None),
        f"; some letters NOT covered; NOT certified; {DEFINED}; {NO_CODE}",
        "the alphabet of `slow` excludes `a`, but ",
    ),
    "LTL707": (
        Judgement(NotCertified(""), Foreseen(2), AGREED, None, Difference("`state` is not a number", 1)),
        f"; NOT certified; {DEFINED}; {NO_CODE}, read back, NOT equal",
        "the text of the code of `slow` does not match its monitor: ",
    ),
    "LTL710": (
        Judgement(NotCertified(""), Foreseen(2), AGREED, None, machine=Difference("other inputs are read")),
        f"; NOT certified; {DEFINED}; {NO_CODE}",
        "the lowered machine of `slow` does not match its monitor: other inputs are read",
    ),
}


@pytest.mark.parametrize("code", MISJUDGED)
def test_nothing_is_written_if_the_gate_refuses_one_property_and_it_is_said_why(
    folder: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch, code: str
) -> None:
    judged, line, message = MISJUDGED[code]
    monkeypatch.setattr("ltlc.interfaces.building.build.judge_all", lambda compiled, *_: [judged] * len(compiled))
    assert main(["build", "props.txt", "--certificate", "props.cert"]) == 1
    assert [path.name for path in folder.iterdir()] == ["props.txt"]
    said = capsys.readouterr()
    assert said.out.splitlines()[0] == f"slow: 2 states, 2 letters{line}"
    assert f"error[{code}]" in said.err
    assert message in said.err


@pytest.mark.parametrize(
    ("letters", "shown"), [(1, "1 letter"), (999_999, "999,999 letters"), (10**6, "1.0e+06 letters")]
)
def test_a_count_of_a_million_and_more_is_rounded(
    folder: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch, letters: int, shown: str
) -> None:
    judged = MISJUDGED["LTL704"][0]
    monkeypatch.setattr("ltlc.interfaces.building.build.judge_all", lambda compiled, *_: [judged] * len(compiled))
    monkeypatch.setattr(Alphabet, "count", lambda _: letters)
    assert main(["build", "props.txt"]) == 1
    assert capsys.readouterr().out.startswith(f"slow: 2 states, {shown}; not judged\n")


def test_a_property_whose_verdict_may_come_late_is_not_built_and_it_is_said_what_to_do(
    folder: Path, capsys: Any
) -> None:
    recent = "within 1 s, always once seen within 3 s"
    (folder / "props.txt").write_text(f"decl seen /seen Bool.data\nrecent: {recent}\n")
    assert main(["build", "props.txt"]) == 1
    assert [path.name for path in folder.iterdir()] == ["props.txt"]
    told = capsys.readouterr().err
    assert "error[LTL705]: the monitor of `recent` is not certified: it is not shown that every verdict" in told
    assert "if one of several bounds decides the outcome of another, omit that other" in told


def test_a_letter_that_the_alphabet_lacks_is_told_with_the_values_that_give_it(
    folder: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "props.txt").write_text("decl x /x Float64.data\nroot: never 1 / sqrt(x) < 0\n")
    monkeypatch.setattr("ltlc.compiler.compile_specification", compiled_over_too_few_letters)
    assert main(["build", "props.txt", "--target", "hoa"]) == 1
    message = "the alphabet of `root` excludes `1 / sqrt(x) < 0`, but x = -0.0 leads to it"
    assert f"error[LTL706]: {message}" in capsys.readouterr().err
    assert [path.name for path in folder.iterdir()] == ["props.txt"]


def compiled_over_too_few_letters(specification: Specification, *_: object) -> tuple[list[Compiled], list[Diagnostic]]:
    """As if a quotient of numbers that are not negative could not be negative."""
    [root] = specification.properties
    small = replace(root, alphabet=Alphabet(root.alphabet.atoms, (Group(root.alphabet.atoms, (frozenset(),)),)))
    return compile_specification(replace(specification, properties=(small,)), EPISODE, Budget())


@pytest.mark.usefixtures("quickly")
def test_what_the_analyses_have_translated_is_not_translated_again(
    folder: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    translated: list[batch.Task] = []
    translate_each = batch._translate_each

    def noted(tasks: Sequence[batch.Task], *, budget: Budget, watch: Watch | None) -> list[Monitor | Exceeded]:
        translated.extend(tasks)
        return translate_each(tasks, budget, watch)

    monkeypatch.setattr(batch, "_translate_each", noted)
    assert main(["build", "props.txt", "--target", "hoa"]) == 0
    assert translated == []


def test_a_translation_that_exceeds_its_budget_names_the_property_and_writes_nothing(folder: Path, capsys: Any) -> None:
    pairs = (f"always (a{n}.velocity > 1 implies eventually b{n}.velocity > 1)" for n in range(14))
    (folder / "props.txt").write_text("big: " + " and ".join(pairs))
    assert main(["build", "props.txt", "--budget", "0.5,512"]) == 1
    assert "error[LTL701]: no monitor for `big`" in capsys.readouterr().err
    assert [path.name for path in folder.iterdir()] == ["props.txt"]


def test_errors_of_the_file_are_findings_and_a_file_that_is_not_there_is_unusable(folder: Path, capsys: Any) -> None:
    (folder / "bad.txt").write_text("never robot.velocty > 2")
    assert main(["build", "bad.txt"]) == 1
    assert main(["build", "nowhere.txt"]) == 2
    assert main(["build", "props.txt", "-o", "no/such/folder.py"]) == 2
    shown = capsys.readouterr().err
    assert "did you mean `velocity`?" in shown
    assert "no/such/folder.py cannot be written" in shown


def test_what_the_analyses_find_is_shown_and_does_not_keep_build_from_building(folder: Path, capsys: Any) -> None:
    (folder / "props.txt").write_text("never robot.velocity > 2\neventually robot.velocity > 3\n")
    assert main(["build", "props.txt"]) == 0
    assert "error[LTL601]" in capsys.readouterr().err


@pytest.mark.usefixtures("quickly")
def test_certificates_are_accepted_and_tampered_ones_are_not(folder: Path, capsys: Any) -> None:
    main(["build", "props.txt", "--certificate", "props.cert"])
    assert main(["certify", "props.txt", "props.cert"]) == 0
    assert "slow: certified, exactly" in capsys.readouterr().out
    certificate = folder / "props.cert"
    certificate.write_text(certificate.read_text().replace("presumably_satisfied", "satisfied", 1))
    assert main(["certify", "props.txt", "props.cert"]) == 1
    assert "slow: NOT certified" in capsys.readouterr().out


@pytest.mark.parametrize("target", ["python", "ros2"])
@pytest.mark.usefixtures("quickly")
def test_certify_compares_code_and_says_where_it_is_not_what_is_emitted(folder: Path, capsys: Any, target: str) -> None:
    main(["build", "props.txt", "--target", target, "-o", "code.py", "--certificate", "props.cert"])
    capsys.readouterr()
    assert main(["certify", "props.txt", "props.cert", "--code", "code.py"]) == 0
    assert "slow: its steps, read back, match the certified monitor" in capsys.readouterr().out
    code = folder / "code.py"
    code.write_text(code.read_text().replace("robot_velocity > 2.0", "robot_velocity >= 2.0"))
    assert main(["certify", "props.txt", "props.cert", "--code", "code.py"]) == 1
    said = capsys.readouterr().out
    assert "in `Slow.step`, `if robot_velocity >= 2.0:` where ltlc emits `if robot_velocity > 2.0:`" in said


@pytest.mark.usefixtures("quickly")
def test_code_that_is_not_python_is_refused_and_a_file_that_is_not_there_is_unusable(folder: Path, capsys: Any) -> None:
    main(["build", "props.txt", "--certificate", "props.cert"])
    (folder / "code.py").write_text("def f(:")
    assert main(["certify", "props.txt", "props.cert", "--code", "code.py"]) == 1
    assert "code.py: it is not Python in line 1: " in capsys.readouterr().out
    (folder / "code.py").write_bytes(b"\xff")
    assert main(["certify", "props.txt", "props.cert", "--code", "code.py"]) == 2
    assert main(["certify", "props.txt", "props.cert", "--code", "nowhere.py"]) == 2


@pytest.mark.usefixtures("quickly")
def test_certify_prints_what_the_certificates_assume(folder: Path, capsys: Any) -> None:
    (folder / "props.txt").write_text("never (robot.velocity > 2 and robot.velocity < 1)\n")
    main(["build", "props.txt", "--certificate", "props.cert"])
    capsys.readouterr()
    assert main(["certify", "props.txt", "props.cert"]) == 0
    assumption = capsys.readouterr().out.splitlines()[1]
    assert assumption.startswith("  assuming ")
    assert "robot.velocity > 2 and not robot.velocity < 1" in assumption


@pytest.mark.parametrize("content", [b"", b"\xff\xfe", b"ltlc-certificate 1\nproperties 9\n"])
def test_what_is_no_certificate_is_unusable(folder: Path, content: bytes) -> None:
    (folder / "bad.cert").write_bytes(content)
    assert main(["certify", "props.txt", "bad.cert"]) == 2
    assert main(["certify", "props.txt", "nowhere.cert"]) == 2


@pytest.mark.parametrize(
    ("speeds", "code"),
    [([1.0, 0.0], 0), ([3.0, 0.0], 1), ([2.0, 0.0, 0.0], 0), ([2.0], 3), ([], 3)],
    ids=["no event", "violated", "all well", "owed", "not started"],
)
def test_run_exits_with_the_outcome(folder: Path, speeds: list[float], code: int) -> None:
    rows = [f"{step},{speed}" for step, speed in enumerate(speeds)]
    (folder / "run.csv").write_text("\n".join(["time,robot.velocity", *rows]) + "\n")
    assert main(["run", "props.txt", "run.csv"]) == code


@pytest.mark.parametrize(
    ("text", "column"),
    [("decl x /x Float64.data\nnever 1 / sqrt(x) < 0", "x"), ("never 1 / robot.velocity < 0", "robot.velocity")],
)
def test_minus_zero_violates_what_it_divides(folder: Path, text: str, column: str) -> None:
    (folder / "props.txt").write_text(text)
    for values, code in (([1.0, 0.0, 1.0], 0), ([1.0, -0.0, 1.0], 1)):
        rows = [f"{step},{value}" for step, value in enumerate(values)]
        (folder / "run.csv").write_text("\n".join([f"time,{column}", *rows]) + "\n")
        assert main(["run", "props.txt", "run.csv"]) == code


def test_run_of_a_recording_that_is_not_there_is_unusable(folder: Path) -> None:
    assert main(["run", "props.txt", "nowhere.csv"]) == 2


def test_run_does_not_repeat_what_the_file_suppresses(folder: Path, capsys: Any) -> None:
    unused = "decl spare /odom Odometry.pose.pose.position"
    (folder / "run.csv").write_text("time,robot.velocity\n0,1\n")
    for comment, expected in (("", True), ("  # ltlc: ignore LTL104", False)):
        (folder / "props.txt").write_text(f"{unused}{comment}\nnever robot.velocity > 2\n")
        assert main(["run", "props.txt", "run.csv"]) == 0
        assert ("LTL104" in capsys.readouterr().err) is expected
