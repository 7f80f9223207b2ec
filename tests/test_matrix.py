"""`ltlc matrix`: requirements, the properties that verify them, and what campaigns have shown of these."""

from __future__ import annotations

import json
import re
from hashlib import sha256
from importlib import import_module
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from ltlc.cli import main
from ltlc.monitoring.matrix.reqif import NAMESPACE

pytest.importorskip("pyarrow.parquet", reason="needs pyarrow (pip install '.[campaigns]')")

NAV = """decl v /v std_msgs/Float64.data
decl near /near std_msgs/Bool.data
## It stops <for> people & "things".
[id "REQ-1", verifies "SYS-1" "H-7"]
stops: always (near implies eventually v == 0)
## It is slow.
[id "REQ-2", verifies "SYS-1"]
slow: never v > 2
after near, v < 9
"""
ARM = 'decl w /w std_msgs/Float64.data\n[id "REQ-3", verifies "SYS-2"]\narm: never w > 1\n'
LISTED = "# ours\nSYS-1  Nobody is hurt.\nSYS-9\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two specifications, of which the first has results of two recordings, and a list of requirements."""
    monkeypatch.chdir(tmp_path)
    for name, text in (("nav.ltlc", NAV), ("arm.ltlc", ARM), ("system.txt", LISTED)):
        Path(name).write_text(text)
    Path("drives").mkdir()
    Path("drives/a.csv").write_text("time,v,near\n0,1,false\n1,1,true\n2,0,true\n")
    Path("drives/b.csv").write_text("time,v,near\n0,1,false\n1,3,false\n2,0,false\n")
    main(["run", "nav.ltlc", "drives", "--results", "nav.parquet", "-q"])
    return tmp_path


def printed(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    """The exit code of `ltlc matrix`, and what it prints."""
    capsys.readouterr()
    code = main(["matrix", *arguments])
    shown = capsys.readouterr()
    return code, shown.out, shown.err


def document(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, dict[str, Any]]:
    code, out, _ = printed(capsys, *arguments, "--format", "json")
    return code, json.loads(out)


def states(found: dict[str, Any]) -> dict[str, str]:
    return {each["id"]: each["state"] for each in found["requirements"]}


@pytest.mark.usefixtures("folder")
def test_a_requirement_is_open_where_only_a_part_of_a_recording_was_judged(capsys: pytest.CaptureFixture[str]) -> None:
    main(["run", "nav.ltlc", "drives/b.csv", "--until", "+0.5", "--results", "part.parquet", "-q"])
    code, found = document(capsys, "nav.ltlc", "--results", "part.parquet")
    assert (code, set(states(found).values())) == (3, {"open"})
    [judged] = found["properties"][0]["results"]
    assert judged["error"] == "only a part of it was judged"


@pytest.mark.usefixtures("folder")
def test_a_requirement_stands_as_the_worst_of_its_properties(capsys: pytest.CaptureFixture[str]) -> None:
    code, found = document(capsys, "nav.ltlc", "--results", "nav.parquet")
    assert code == 1
    assert states(found) == {"REQ-1": "holds", "SYS-1": "violated", "H-7": "holds", "REQ-2": "violated"}
    labels = [each["label"] for each in found["properties"]]
    assert labels == ["stops", "slow", "line 9"]
    by_id = {each["id"]: [labels[number] for number in each["properties"]] for each in found["requirements"]}
    assert by_id == {"REQ-1": ["stops"], "SYS-1": ["stops", "slow"], "H-7": ["stops"], "REQ-2": ["slow"]}


@pytest.mark.usefixtures("folder")
def test_a_result_names_its_recording_by_digest_and_says_how_often_it_was_triggered(
    capsys: pytest.CaptureFixture[str],
) -> None:
    _, found = document(capsys, "nav.ltlc", "--results", "nav.parquet")
    stops, slow, after = found["properties"]
    content = Path("drives/b.csv").read_bytes()
    violated = {"result": "violated", "offset": 1.0, "triggered": None, "is_stale": False, "error": None}
    assert slow["results"][1] == {
        "recording": "drives/b.csv",
        "files": [{"name": "b.csv", "bytes": len(content), "sha256": sha256(content).hexdigest()}],
        **violated,
    }
    assert [each["triggered"] for each in after["results"]] == [1, 0]
    assert [each["result"] for each in after["results"]] == ["presumably_satisfied", "never_triggered"]
    assert (after["state"], after["triggered"]) == ("holds", 1)
    assert stops["triggered"] is None


@pytest.mark.usefixtures("folder")
def test_what_is_not_covered_is_listed(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ("nav.ltlc", "arm.ltlc", "--results", "nav.parquet", "--requirements", "system.txt")
    code, found = document(capsys, *arguments)
    assert code == 1
    assert found["not_covered"] == {
        "requirements_without_property": ["SYS-9"],
        "requirements_not_listed": ["H-7", "SYS-2"],
        "properties_without_requirement": [2],
        "never_run": [3],
        "not_judged": [],
    }
    assert states(found)["SYS-9"] == "no_property"
    assert states(found)["SYS-2"] == "not_run"


@pytest.mark.usefixtures("folder")
def test_results_of_another_text_are_stale_and_count_for_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    Path("nav.ltlc").write_text(f"{NAV}# a comment\n")
    code, found = document(capsys, "nav.ltlc", "--results", "nav.parquet")
    assert code == 3
    assert set(states(found).values()) == {"not_run"}
    assert found["stale"] == {"nav.ltlc": 2}
    assert all(each["is_stale"] for of in found["properties"] for each in of["results"])
    assert "2 stale" in printed(capsys, "nav.ltlc", "--results", "nav.parquet")[1]
    main(["run", "nav.ltlc", "drives", "--results", "nav.parquet", "-q"])
    code, found = document(capsys, "nav.ltlc", "--results", "nav.parquet")
    assert (code, found["stale"], states(found)["SYS-1"]) == (1, {}, "violated")


@pytest.mark.usefixtures("folder")
def test_a_specification_in_another_folder_is_the_same_by_its_text(capsys: pytest.CaptureFixture[str]) -> None:
    Path("moved").mkdir()
    Path("nav.ltlc").rename("moved/other.ltlc")
    assert document(capsys, "moved/other.ltlc", "--results", "nav.parquet")[1]["stale"] == {}


@pytest.mark.usefixtures("folder")
def test_results_of_a_specification_that_was_not_given_are_reported(capsys: pytest.CaptureFixture[str]) -> None:
    code, found = document(capsys, "arm.ltlc", "--results", "nav.parquet")
    assert (code, found["of_other_specifications"]) == (3, {"nav.ltlc": 2})


@pytest.mark.usefixtures("folder")
def test_several_campaigns_are_taken_together(capsys: pytest.CaptureFixture[str]) -> None:
    Path("w.csv").write_text("time,w\n0,1\n")
    main(["run", "arm.ltlc", "w.csv", "--results", "arm.parquet", "-q"])
    found = document(capsys, "nav.ltlc", "arm.ltlc", "--results", "nav.parquet", "--results", "arm.parquet")[1]
    assert states(found)["SYS-2"] == "holds"


def test_a_recording_that_was_not_judged_leaves_open_what_it_could_have_shown(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("drives/b.csv").write_text("time,v,near\n0,1,false\n1,x,false\n")
    Path("drives/c.csv").write_text("")
    main(["run", "nav.ltlc", "drives", "--results", "nav.parquet", "-q"])
    code, found = document(capsys, "nav.ltlc", "--results", "nav.parquet")
    assert (code, states(found)["REQ-2"]) == (3, "open")
    assert [each["recording"] for each in found["not_covered"]["not_judged"]] == ["drives/c.csv"]


def test_all_that_holds_is_0_and_what_was_never_triggered_is_3(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("drives/b.csv").unlink()
    main(["run", "nav.ltlc", "drives", "--results", "nav.parquet", "-q"])
    assert document(capsys, "nav.ltlc", "--results", "nav.parquet")[0] == 0
    Path("drives/a.csv").write_text("time,v,near\n0,1,false\n")
    main(["run", "nav.ltlc", "drives", "--results", "nav.parquet", "-q"])
    code, found = document(capsys, "nav.ltlc", "--results", "nav.parquet")
    assert (code, found["properties"][2]["state"]) == (3, "idle")


def test_without_results_only_properties_are_asked_for(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = printed(capsys, "nav.ltlc")
    assert (code, "not run" in out) == (0, False)
    assert printed(capsys, "nav.ltlc", "--requirements", "system.txt")[0] == 1


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("nav.ltlc", "--results", "none.parquet"), "there is no table of results `none.parquet`"),
        (("nav.ltlc", "--results", "nav.ltlc"), "is not a table of results"),
        (("nav.ltlc", "--requirements", "none.txt"), "there is no file none.txt"),
        (("nav.ltlc", "--requirements", "twice.txt"), "twice.txt:2: `A` is listed twice"),
        (("none.ltlc",), "there is no file none.ltlc"),
    ],
)
def test_what_cannot_be_used_is_said_and_nothing_is_printed(
    folder: Path, capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...], said: str
) -> None:
    Path("twice.txt").write_text("A one\nA two\n")
    code, out, err = printed(capsys, *arguments)
    assert (code, out) == (2, "")
    assert said in err


def test_an_error_in_a_specification_is_1(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("bad.ltlc").write_text("never x > 2\n")
    code, out, err = printed(capsys, "bad.ltlc", "nav.ltlc")
    assert (code, out) == (1, "")
    assert "LTL101" in err


@pytest.mark.usefixtures("folder")
def test_an_unfinished_campaign_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    Path("nav.parquet.journal").write_text("[]\n")
    assert "has not finished" in printed(capsys, "nav.ltlc", "--results", "nav.parquet")[2]


ALL = ("nav.ltlc", "arm.ltlc", "--results", "nav.parquet", "--requirements", "system.txt", "--format")


@pytest.mark.usefixtures("folder")
def test_needs_have_links_to_what_they_verify(capsys: pytest.CaptureFixture[str]) -> None:
    found = json.loads(printed(capsys, *ALL, "needs")[1])
    needs = found["versions"][found["current_version"]]["needs"]
    assert needs["LTLC_NAV_LTLC_STOPS"]["links"] == ["REQ-1", "SYS-1", "H-7"]
    assert (needs["SYS-1"]["type"], needs["SYS-1"]["title"], needs["SYS-1"]["status"]) == (
        "req",
        "Nobody is hurt.",
        "violated",
    )
    assert all(link in needs for need in needs.values() for link in need["links"])


@pytest.mark.usefixtures("folder")
def test_ids_for_other_tools_are_different_for_different_properties(capsys: pytest.CaptureFixture[str]) -> None:
    Path("same.ltlc").write_text("decl v /v std_msgs/Float64.data\na: never v > 1\nA: never v > 2\n")
    found = json.loads(printed(capsys, "same.ltlc", "--format", "needs")[1])
    assert list(found["versions"]["1.0"]["needs"]) == ["LTLC_SAME_LTLC_A", "LTLC_SAME_LTLC_A_2"]


def tag(name: str) -> str:
    return f"{{{NAMESPACE}}}{name}"


@pytest.mark.usefixtures("folder")
def test_reqif_relates_properties_to_requirements_and_refers_to_nothing_else(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    text = printed(capsys, *ALL, "reqif")[1]
    root = ElementTree.fromstring(text)
    ids = [each.get("IDENTIFIER") or "" for each in root.iter() if each.get("IDENTIFIER")]
    assert len(set(ids)) == len(ids)
    assert all(re.fullmatch(r"[A-Za-z_][\w.-]*", id) for id in ids), "an xsd:ID"
    referred = [each.text for each in root.iter() if each.tag.endswith("-REF")]
    assert set(referred) <= set(ids)
    values = {
        made.get("IDENTIFIER"): [each.get("THE-VALUE") for each in made.iter(tag("ATTRIBUTE-VALUE-STRING"))]
        for made in root.iter(tag("SPEC-OBJECT"))
    }
    related = {
        tuple(values[each.text][0] for each in relation.iter(tag("SPEC-OBJECT-REF")))
        for relation in root.iter(tag("SPEC-RELATION"))
    }
    stops, slow, arm = "LTLC_NAV_LTLC_STOPS", "LTLC_NAV_LTLC_SLOW", "LTLC_ARM_LTLC_ARM"
    assert related == {
        *((stops, id) for id in ("REQ-1", "SYS-1", "H-7")),
        *((slow, id) for id in ("REQ-2", "SYS-1")),
        *((arm, id) for id in ("REQ-3", "SYS-2")),
    }
    assert ["REQ-1", 'It stops <for> people & "things".', "holds"] in values.values()
    assert set(re.findall(r'(?:LAST-CHANGE="|<CREATION-TIME>)([^"<]*)', text)) == {"1970-01-01T00:00:00+00:00"}


@pytest.mark.usefixtures("folder")
def test_reqif_is_valid_and_read_back_by_the_library_that_strictdoc_uses(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    reader: Any = import_module("reqif.parser")
    (tmp_path / "m.reqif").write_text(printed(capsys, *ALL, "reqif")[1])
    root = Path(reader.__file__).parents[1]
    monkeypatch.chdir(root)  # from where the schema finds its parts
    schema = import_module("xmlschema").XMLSchema(str(root / "reqif" / "reqif_schema" / "reqif.xsd"))
    schema.validate(str(tmp_path / "m.reqif"))
    bundle = reader.ReqIFParser.parse(str(tmp_path / "m.reqif"))
    content = bundle.core_content.req_if_content
    assert (len(content.spec_objects), len(content.spec_relations)) == (11, 7)
    [specification] = content.specifications
    assert len(list(bundle.iterate_specification_hierarchy(specification))) == 11


@pytest.mark.usefixtures("folder")
def test_the_page_has_all_of_it_as_text_and_loads_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    html = printed(capsys, *ALL, "html")[1]
    for said in (
        "It stops &lt;for&gt; people &amp; &#34;things&#34;.",
        sha256(Path("drives/a.csv").read_bytes()).hexdigest(),
        sha256(NAV.encode()).hexdigest(),
        "Requirements without a property",
        "1 violated, 1 presumably satisfied",
    ):
        assert said in html
    assert not re.search(r"(src|href)=|url\(|@import", html)
