"""What documents were made of: version, commit, and SHA-256 of specification and recording, as sha256sum has it."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from bag_support import odometry, rosbag2

from ltlc import __version__
from ltlc.backends import FILE_NAMES
from ltlc.base.revision import commit_text
from ltlc.cli import main
from ltlc.interfaces.api.monitor import monitor

TEXT = b"\xef\xbb\xbfdecl v /v Float64.data\r\nslow: never v > 2\n"
"""With a byte order mark and line ends that a reader could drop, which the SHA-256 must not."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "props.txt").write_bytes(TEXT)
    (tmp_path / "a.csv").write_text("time,v\n0,1\n1,2\n")
    (tmp_path / "b.csv").write_text("time,v\n0,1\n1,3\n")
    return tmp_path


def made_of(folder: Path, *recordings: str) -> dict[str, Any]:
    """What a document made of the specification and the `recordings` has to say."""
    files = [folder / name for name in recordings]
    return {
        "ltlc": __version__,
        "commit": commit_text() or None,
        "specifications": [{"name": "props.txt", "sha256": sha256(TEXT).hexdigest()}],
        "recordings": [
            {"name": file.name, "bytes": len(file.read_bytes()), "sha256": sha256(file.read_bytes()).hexdigest()}
            for file in files
        ],
    }


Document = Callable[..., dict[str, dict[str, object]]]


@pytest.fixture
def document(capsys: pytest.CaptureFixture[str]) -> Document:
    def printed(*arguments: str) -> dict[str, dict[str, object]]:
        main([*arguments, "--format", "json"])
        found: dict[str, dict[str, object]] = json.loads(capsys.readouterr().out)
        return found

    return printed


@pytest.mark.parametrize(
    ("arguments", "recordings"),
    [
        (("check", "props.txt"), ()),
        (("run", "props.txt", "a.csv"), ("a.csv",)),
        (("compare", "props.txt", "--recording", "b.csv"), ("b.csv",)),
    ],
)
def test_a_document_says_what_it_was_made_of(
    folder: Path, document: Document, arguments: tuple[str, ...], recordings: tuple[str, ...]
) -> None:
    assert document(*arguments)["provenance"] == made_of(folder, *recordings)


def test_mined_values_say_what_they_were_found_in(folder: Path, document: Document) -> None:
    (folder / "mine.txt").write_bytes(TEXT.replace(b"2", b"?"))
    found = document("mine", "mine.txt", "a.csv", "b.csv")["provenance"]
    assert found["recordings"] == made_of(folder, "a.csv", "b.csv")["recordings"]
    assert found["specifications"] == [
        {"name": "mine.txt", "sha256": sha256((folder / "mine.txt").read_bytes()).hexdigest()}
    ]


def test_a_campaign_says_it_of_each_recording(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main(["run", "props.txt", "a.csv", "b.csv", "--format", "json"])
    first, second = json.loads(capsys.readouterr().out)["recordings"]
    assert first["provenance"] == made_of(folder, "a.csv")
    assert second["provenance"] == made_of(folder, "b.csv")


def test_a_campaign_keeps_it_in_the_table(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("pyarrow")
    import pyarrow.parquet

    main(["run", "props.txt", "a.csv", "--results", "results.parquet"])
    capsys.readouterr()
    [row] = pyarrow.parquet.read_table("results.parquet").to_pylist()
    assert json.loads(row["recording_report"])["provenance"] == made_of(folder, "a.csv")


@pytest.mark.parametrize("arguments", [("a.csv",), ("a.csv", "a.csv", "--jobs", "1")])
def test_junit_says_it_as_properties_of_a_suite(
    folder: Path, capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...]
) -> None:
    main(["run", "props.txt", *arguments, "--format", "junit"])
    root = ElementTree.fromstring(capsys.readouterr().out)
    suite = root if root.tag == "testsuite" else root[0]
    assert [(each.get("name"), each.get("value")) for each in suite.findall("properties/property")] == [
        ("ltlc", __version__),
        *([("commit", commit_text())] if commit_text() else []),
        ("specification", f"props.txt sha256:{sha256(TEXT).hexdigest()}"),
        ("recording", f"a.csv sha256:{sha256((folder / 'a.csv').read_bytes()).hexdigest()}"),
    ]


def test_sarif_says_it_in_its_own_terms(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main(["check", "props.txt", "--format", "sarif"])
    [run] = json.loads(capsys.readouterr().out)["runs"]
    assert run["artifacts"] == [{"location": {"uri": "props.txt"}, "hashes": {"sha-256": sha256(TEXT).hexdigest()}}]
    assert run["tool"]["driver"].get("properties", {}).get("commit", "") == commit_text()


OUTPUTS = {
    "check json": "check props.txt --format json",
    "check sarif": "check props.txt --format sarif",
    "run json": "run props.txt a.csv --format json",
    "run junit": "run props.txt a.csv --format junit",
    "run --output": "run props.txt a.csv --output out.mcap",
    "run --evidence": "run props.txt a.csv --evidence out",
    "build ros2": "build props.txt --target ros2 -o out.py",
    "build ament": "build props.txt --target ament -o props_monitor",
    "build json": "build props.txt --target json -o out",
    "build hoa": "build props.txt --target hoa -o out",
    "build tests": "build props.txt --target tests -o out",
    "mine json": "mine props.txt a.csv --format json",
    "falsify json": "falsify props.txt --simulate \"sh -c 'cp a.csv {recording}.csv' {v}\" --parameter v=0..1"
    " --simulations 1 --format json",
    "compare json": "compare props.txt --format json",
    "matrix json": "matrix props.txt --format json",
    "matrix reqif": "matrix props.txt --format reqif",
    "matrix needs": "matrix props.txt --format needs",
}
"""What other programs read, and how it is written."""

FOR_PEOPLE = {"text", "full", "concise", "html", "md", "csv", "dot", "python", "c", "rust"}
"""Forms of output for people, and code that has no output of its own."""


def test_the_list_of_outputs_is_complete(capsys: pytest.CaptureFixture[str]) -> None:
    formats = {f"build {target}" for target in FILE_NAMES if target not in FOR_PEOPLE}
    for command in (
        "new",
        "check",
        "format",
        "run",
        "mine",
        "matrix",
        "certify",
        "compare",
        "explain",
        "falsify",
        "serve",
    ):
        with pytest.raises(SystemExit):
            main([command, "--help"])
        found = re.search(r"--format \{([a-z,]+)\}", capsys.readouterr().out)
        of_command = set(found[1].split(",")) if found else set()
        formats |= {f"{command} {each}" for each in of_command - FOR_PEOPLE}
    assert formats == {name for name in OUTPUTS if "--" not in name}


@pytest.mark.parametrize("name", OUTPUTS)
def test_every_output_for_programs_has_version_commit_and_specification(
    folder: Path, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    before = {*folder.rglob("*")}
    if "mine" in name:
        (folder / "props.txt").write_bytes(TEXT.replace(b"> 2", b"> ?"))
    main(shlex.split(OUTPUTS[name]))
    written = [path.read_bytes() for path in {*folder.rglob("*")} - before if path.is_file()]
    found = b"".join([*written, capsys.readouterr().out.encode()])
    digest = sha256((folder / "props.txt").read_bytes()).hexdigest()
    assert all(part.encode() in found for part in (__version__, commit_text(), digest))


def test_of_a_bag_all_files_are_named(folder: Path, document: Document) -> None:
    rosbag2(folder / "bag", [odometry(0), odometry(1)])
    (folder / "bag" / "notes.txt").write_text("no part of the recording")
    names = ["bag.db3", "metadata.yaml"]
    found = document("run", "props.txt", "bag")["provenance"]["recordings"]
    wanted = made_of(folder, *(f"bag/{name}" for name in names))["recordings"]
    assert found == [each | {"name": f"bag/{each['name']}"} for each in wanted]


def test_what_is_in_no_file_has_no_digest(folder: Path) -> None:
    live = monitor("decl v /v Float64.data\nnever v > 2\n")
    live.step({"v": 1.0})
    (folder / "rows").write_text("not what was judged")
    assert live.finish().document()["provenance"]["recordings"] == []


def test_a_document_is_the_same_twice(folder: Path, document: Document) -> None:
    assert document("run", "props.txt", "a.csv") == document("run", "props.txt", "a.csv")
