"""Whatever judges a run says, once for each property, whose verdicts may come late; of others, nothing is said."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from effort import share_of
from timed import Draw, compiled

import ltlc
from ltlc.assurance.certify import NotCertified
from ltlc.assurance.exactness import checked_certificate, late_verdicts
from ltlc.automata import Budget
from ltlc.base.codes import CODES
from ltlc.base.source import Source
from ltlc.cli import main
from ltlc.interfaces.commands.common import without_notes
from ltlc.interfaces.serve.answers import ANSWERS
from ltlc.monitoring.mining.mine import mine
from ltlc.monitoring.mining.template import load
from ltlc.semantics.certificate import Certificate
from ltlc.semantics.reset_machine import ResetMachine

pytest_plugins = ["pytester"]

RECENT = """decl seen /seen Bool.data
decl speed /speed Float64.data
recent: within 1 s, always once seen within 3 s
again: never (not (age(seen) <= 3 ns)) within 1 ns
slow: never speed > 2
soon: always (seen implies eventually speed < 1 within 1 s)
"""
SAID = [
    f"the verdict of `{label}` may come later than it could; `ltlc build` refuses this monitor"
    for label in ("recent", "again")
]
ROWS = "time,seen,speed\n0,true,1\n1,true,0\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "props.txt").write_text(RECENT)
    for name in ("a.csv", "b.csv"):
        (tmp_path / name).write_text(ROWS)
    return tmp_path


def late(diagnostics: Any) -> list[str]:
    """What is said of late verdicts, in diagnostics or in their JSON."""
    pairs = [(d["code"], d["message"]) if isinstance(d, dict) else (d.code, d.message) for d in diagnostics]
    return [message for code, message in pairs if code == "LTL709"]


@pytest.mark.parametrize("options", [[], ["--verdicts"], ["--report", "page.html"]])
@pytest.mark.parametrize("recordings", [["a.csv"], ["a.csv", "b.csv"]])
def test_run_says_once_for_each_property_that_its_verdicts_may_come_late(
    folder: Path, capsys: Any, recordings: list[str], options: list[str]
) -> None:
    main(["run", "props.txt", *recordings, "--format", "json", *options])
    shown = capsys.readouterr()
    document = json.loads(shown.out)
    of_each = document.get("recordings", [document])
    assert [late(each["diagnostics"]) for each in of_each] == [SAID] * len(recordings)
    assert [shown.err.count(f"warning[LTL709]: {said}\n") for said in SAID] == [1, 1]
    assert shown.err.count("LTL709") == 2


@pytest.mark.parametrize("recordings", [["a.csv"], ["a.csv", "b.csv"]])
@pytest.mark.usefixtures("folder")
def test_the_junit_report_says_what_may_come_late(capsys: Any, recordings: list[str]) -> None:
    main(["run", "props.txt", *recordings, "--format", "junit"])
    root = ElementTree.fromstring(capsys.readouterr().out)
    suites = [root] if root.tag == "testsuite" else root
    assert [(suite.findtext("system-out") or "").splitlines() for suite in suites] == [SAID] * len(recordings)


def test_the_functions_of_python_and_the_page_of_serve_say_what_may_come_late() -> None:
    rows: list[dict[str, Any]] = [{"time": 0.0, "seen": True, "speed": 1.0}]
    live = ltlc.monitor(RECENT)
    live.step(rows[0])
    of_page = json.loads(ANSWERS["judge"](json.dumps({"text": RECENT, "steps": rows}).encode(), ()))
    for diagnostics in (live.finish().diagnostics, ltlc.run(RECENT, rows).diagnostics, of_page["diagnostics"]):
        assert late(diagnostics) == SAID


def test_a_test_of_pytest_is_warned_of_what_may_come_late(
    pytester: pytest.Pytester, request: pytest.FixtureRequest
) -> None:
    pytester.makefile(".txt", props=RECENT)
    pytester.makepyfile(
        """
        def test_drive(ltlc_monitor):
            ltlc_monitor.load("props.txt", allow_open=True)
            ltlc_monitor.step({"seen": True, "speed": 0.0}, 0.0)
        """
    )
    is_installed = request.config.pluginmanager.has_plugin("ltlc")
    options = [] if is_installed else ["-p", "ltlc.pytest_plugin"]
    result = pytester.runpytest_inprocess("-p", "no:cacheprovider", "-W", "always", *options)
    result.assert_outcomes(passed=1, warnings=2)
    result.stdout.fnmatch_lines([f"*UserWarning: {said}" for said in SAID])


def test_mine_says_of_the_values_that_it_finds_what_may_come_late(tmp_path: Path) -> None:
    (tmp_path / "props.txt").write_text(
        "decl seen /seen Bool.data\ndecl speed /speed Float64.data\n"
        "recent: within 1 s, always once (seen and speed < ?) within 3 s\nslow: never speed > ?\n"
    )
    (tmp_path / "a.csv").write_text(ROWS)
    template, problems = load(tmp_path / "props.txt", [])
    assert template is not None, problems
    mined = mine(template, [tmp_path / "a.csv"], Budget())
    assert late(mined.diagnostics) == [SAID[0].replace("recent", f"recent[{mined.findings[0].trial.text}]")]
    assert mined.exit_code == 0


@pytest.mark.usefixtures("folder")
def test_build_refuses_what_run_warns_of_and_says_it_once(capsys: Any) -> None:
    assert main(["build", "props.txt"]) == 1
    shown = capsys.readouterr().err
    assert (shown.count("LTL705"), shown.count("LTL709")) == (2, 0)
    with pytest.raises(ltlc.UnusableInput) as refused:
        ltlc.build(RECENT, "hoa")
    assert [each.code for each in without_notes(refused.value.diagnostics)] == ["LTL705", "LTL705"]


def test_properties_of_one_shape_are_warned_of_each_by_its_name() -> None:
    text = "forall r in {a, b}: within 1 s, always once r.velocity > 1 within 3 s"
    diagnostics = ltlc.run(text, [{"time": 0.0, "a.velocity": 2, "b.velocity": 2}]).diagnostics
    assert ["`line 1[a]`" in late(diagnostics)[0], "`line 1[b]`" in late(diagnostics)[1]] == [True, True]


@pytest.mark.parametrize("seed", range(share_of(240)))
def test_a_warning_is_given_exactly_where_there_is_no_exact_certificate(seed: int) -> None:
    each = compiled(Draw(seed).property())
    found = checked_certificate(each)
    warned = [diagnostic.code for diagnostic in late_verdicts(Source("p", ""), [each], Budget())]
    if isinstance(found, NotCertified) and not found.too_late:
        assert not ResetMachine(each.formula).words_are_runs or found.too_large
    else:
        assert warned == ([] if isinstance(found, Certificate) else ["LTL709"])


def test_a_late_verdict_is_a_warning_and_changes_no_exit_code(folder: Path, capsys: Any) -> None:
    (folder / "props.txt").write_text(f"decl seen /seen Bool.data\n{RECENT.splitlines()[2]}\n")
    (folder / "a.csv").write_text("time,seen\n0,true\n9,true\n")
    assert main(["run", "props.txt", "a.csv"]) == 0
    assert capsys.readouterr().err.startswith(f"warning[LTL709]: {SAID[0]}\n")
    assert CODES["LTL709"].severity.value == "warning"
