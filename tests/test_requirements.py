"""The requirement that a property states: attributes in front of it and `##` comments; no monitor knows them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
import sarif_schema
from language_support import codes_of, compiled, findings, marked
from read_mutants import read_back
from stepping import from_text
from test_editor import offered, said

from ltlc.assurance.reading.outcomes import Difference, ReadBack
from ltlc.backends import emit
from ltlc.base.fixes import with_fixes
from ltlc.base.source import Source
from ltlc.cli import main
from ltlc.frontend.layout import layout
from ltlc.interfaces.api.check import check
from ltlc.interfaces.api.monitor import monitor
from ltlc.interfaces.api.run import run as api_run
from ltlc.monitoring.campaigns.forms import JUnit
from ltlc.monitoring.campaigns.outcomes import of_report
from ltlc.monitoring.campaigns.places import Found, Location
from ltlc.monitoring.campaigns.tally import Tally
from ltlc.monitoring.judging.run import run
from ltlc.runtime.documents import json_line
from ltlc.semantics.certificate_reader import parse

SPEED = "decl v /odom Odometry.twist.twist.linear.x\n"
NAV = """
## The robot stops for people
##  (ISO 13482, 5.10).
[id "REQ-NAV-012", verifies "SYS-4" "H-7", severity critical, owner "nav"]
[level 3]
stops: always (v > 1 implies eventually v < 0.1)
# a remark
never v > 2
"""
DOCUMENT: dict[str, Any] = {
    "id": "REQ-NAV-012",
    "text": "The robot stops for people (ISO 13482, 5.10).",
    "attributes": {
        "id": ["REQ-NAV-012"],
        "verifies": ["SYS-4", "H-7"],
        "severity": ["critical"],
        "owner": ["nav"],
        "level": ["3"],
    },
}


def texts(text: str) -> list[str | None]:
    """The texts of the requirements of properties."""
    return [p.requirement.text if p.requirement else None for p in compiled(SPEED + text).properties]


def test_attributes_and_comments_are_the_requirement() -> None:
    stops, slow = compiled(SPEED + NAV).properties
    assert stops.requirement is not None
    assert stops.requirement.document() == DOCUMENT
    assert slow.requirement is None
    assert (stops.label, stops.line, slow.label) == ("stops", 7, "line 9")


def test_comments_that_touch_the_property_or_its_attributes_are_the_text() -> None:
    assert texts("## one\n[id 1]\n## two\nnever v > 2\n## three\nnever v > 3\n") == ["one two", "three"]
    assert texts("## far\n\n[id 1]\nnever v > 2\n# plain\nnever v > 3\n") == ["", None]


def test_check_and_run_tell_it(tmp_path: Path) -> None:
    [stops, slow] = check(SPEED + NAV).document()["properties"]
    assert stops["requirement"] == DOCUMENT
    assert "requirement" not in slow
    (tmp_path / "a.csv").write_text("time,v\n0,1\n")
    [stops, slow] = json.loads(run(*from_text(SPEED + NAV), tmp_path / "a.csv", False).json())["properties"]
    assert stops["requirement"] == DOCUMENT
    assert "requirement" not in slow


def test_a_test_case_of_junit_has_it_as_properties(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("time,v\n5,1\n7.5,0\n9,3\n")
    suite = ElementTree.fromstring(run(*from_text(SPEED + NAV), tmp_path / "a.csv", False).junit())
    stops, slow = suite.findall("testcase")
    assert (stops.get("file"), stops.get("line"), stops.get("time")) == ("props.txt", "7", "4")
    assert [(each.get("name"), each.get("value")) for each in stops.findall("properties/property")] == [
        ("requirement", DOCUMENT["text"]),
        *((key, value) for key, values in DOCUMENT["attributes"].items() for value in values),
    ]
    assert slow.find("properties") is None


def test_a_campaign_tells_it_as_a_single_run_does(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("time,v\n5,1\n7.5,0\n9,3\n")
    (tmp_path / "b.csv").write_text("time,v\n5,1\n7.5,3\n9,3\n")
    form = JUnit()
    for name in ("a.csv", "b.csv"):
        report = run(*from_text(SPEED + NAV), tmp_path / name, False)
        form.add(of_report(Location(str(tmp_path / name)), report, 0.0))
        single = ElementTree.fromstring(report.junit())
        several = ElementTree.fromstring(form.end(Tally(), Found([])))[-1]
        assert ElementTree.tostring(single).split() == ElementTree.tostring(several).split()


def test_a_change_of_verdict_as_a_line_tells_it() -> None:
    live = monitor(SPEED + NAV)
    told = [json.loads(json_line(change)) for change in live.step({"v": 3.0})]
    assert [each.get("requirement") for each in told] == [DOCUMENT, None]


def test_a_finding_in_sarif_tells_that_of_its_property(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    stated = '## Never.\n[id "A"]\nnever v > 2 and v < 1\nnever v > 3 and v < 1\n'
    (tmp_path / "a.ltlc").write_text(SPEED + stated)
    main(["check", str(tmp_path / "a.ltlc"), "--format", "sarif"])
    log = json.loads(capsys.readouterr().out)
    assert not sarif_schema.problems(log)
    found = [each for each in log["runs"][0]["results"] if each["ruleId"] == "LTL503"]
    assert [each.get("properties", {}).get("requirement", {}).get("id") for each in found] == ["A", None]


def test_a_page_tells_it(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("time,v\n0,1\n")
    html = api_run(SPEED + NAV, tmp_path / "a.csv").page()
    assert html.count('<dl class="stated">') == 1
    for value in (DOCUMENT["text"], "REQ-NAV-012", "SYS-4", "H-7", "critical"):
        assert f"<dd>{value}</dd>" in html


@pytest.mark.usefixtures("quickly")
def test_a_certificate_tells_it_and_is_the_same_without(tmp_path: Path) -> None:
    (tmp_path / "a.ltlc").write_text(SPEED + NAV)
    certificate, bare = (tmp_path / name for name in ("a.cert", "b.cert"))
    code = str(tmp_path / "a.py")
    assert main(["build", str(tmp_path / "a.ltlc"), "-o", code, "--certificate", str(certificate)]) == 0
    text = certificate.read_text()
    assert "# id: REQ-NAV-012\n# verifies: SYS-4\n# verifies: H-7\n" in text
    bare.write_text("".join(line for line in text.splitlines(keepends=True) if not line.startswith("#")))
    assert parse(text) == parse(bare.read_text())


def test_an_emitted_node_has_it_and_is_read_back(tmp_path: Path) -> None:
    compiled, specification = from_text(SPEED + NAV)
    code = emit("ros2", compiled, specification)
    assert "REQ-NAV-012" in code
    assert all(isinstance(each, ReadBack) for each in read_back(code, compiled))
    assert isinstance(read_back(code.replace("REQ-NAV-012", "REQ-NAV-013"), compiled)[0], Difference)


def test_a_live_run_tells_it() -> None:
    live = monitor(SPEED + NAV)
    live.step({"v": 1.0})
    [stops, slow] = live.finish().document()["properties"]
    assert stops["requirement"] == DOCUMENT
    assert "requirement" not in slow


def test_copies_of_forall_share_the_id() -> None:
    both = compiled('[id "A"]\nforall r in {one, two}: never r.velocity > 2\n').properties
    assert [each.requirement and each.requirement.id for each in both] == ["A", "A"]


def test_an_id_is_given_once_in_a_file() -> None:
    [found] = findings('[id "A"]\na: never robot.velocity > 2\n[id "A"]\nb: never robot.velocity > 3\n')
    assert (found.code, marked(found)) == ("LTL111", '"A"')


def test_an_id_is_given_once_in_the_files_that_are_checked_together(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("a.ltlc", "b.ltlc"):
        (tmp_path / name).write_text('[id "A"]\nnever robot.velocity > 2\n')
    assert main(["check", str(tmp_path / "a.ltlc")]) == 0
    assert main(["check", str(tmp_path), "--format", "concise"]) == 1
    assert "b.ltlc:1:1: error[LTL111] the requirement `A` also occurs in" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("lines", "code"),
    [
        ('[id "A" "B"]', "LTL112"),
        ('[owner "a", owner "b"]', "LTL112"),
        ("[owner x]\n[owner y]", "LTL112"),
        ("[id]", "LTL006"),
        ('[id "A"', "LTL005"),
        ("[id REQ-1]", "LTL001"),
        ("[within 5 s]", "LTL006"),
        ('[id "A"]\ndecl w /w Float64.data', "LTL006"),
    ],
)
def test_what_is_wrong_with_attributes_is_told(lines: str, code: str) -> None:
    assert code in codes_of(f"{lines}\nnever robot.velocity > 2\n")


def test_an_id_before_a_colon_is_put_into_attributes() -> None:
    text = "REQ-001: never robot.velocity > 2\n"
    [found] = findings(text)
    [fix] = found.fixes
    assert with_fixes(text, [fix]) == '[id "REQ-001"]\nnever robot.velocity > 2\n'
    assert codes_of(with_fixes(text, [fix])) == []


def test_a_bracket_at_the_beginning_of_a_line_is_an_index_where_a_number_follows() -> None:
    assert codes_of("decl scan /scan LaserScan.ranges\nnever scan\n  [0] > 1\n") == []
    assert codes_of('decl on /on Bool.data\nnever on\n[id "A"]\nnever not on\n') == []


def test_a_suppression_above_the_attributes_is_about_the_property() -> None:
    always = "never v > 2 and v < 1\n"
    assert [d.code for d in check(f'{SPEED}# ltlc: ignore LTL503\n[id "A"]\n{always}').diagnostics] == []


def test_the_layout_keeps_each_line_of_attributes() -> None:
    text = '## why\n[ id   "A",owner nav ]# x\n[level\n3]\n## more\nnever   v > 2\n'
    laid_out = layout(Source("", text))
    assert laid_out == '## why\n[id "A", owner nav]  # x\n[level 3]\n## more\nnever v > 2\n'
    assert layout(Source("", laid_out)) == laid_out


def test_editors_know_the_attributes() -> None:
    assert "how bad a violation is" in said("[sever|ity high]\nnever robot.velocity > 2\n")
    assert {"id", "verifies", "rationale", "status"} <= set(offered("[|"))
    assert {"id", "owner"} <= set(offered('[id "A", |'))
    assert offered("[id |") == []
