"""What is written about evidence for others: statements, signatures and the assessor's page."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from collections.abc import Iterator
from copy import deepcopy
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest
from bag_support import odometry, rosbag2

from ltlc.assurance.evidence.conditions import stated_atoms
from ltlc.assurance.evidence.words import in_words
from ltlc.base.source import Source
from ltlc.cli import main
from ltlc.frontend.language import load_text

TEXT = """decl v /odom Odometry.twist.twist.linear.x
## It is <slow> & "safe".
[id "REQ-1", verifies "SYS-1" "H-7"]
slow: never v > 2
[id "REQ-2"]
fast: never v > 0.5
owed: eventually v > 5
forgotten: always (new v implies not previously new v)
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A specification, a bag, and the evidence of it."""
    monkeypatch.chdir(tmp_path)
    Path("props.txt").write_text(TEXT)
    rosbag2(tmp_path / "drive", [odometry(n * 10**9, twist__twist__linear__x=float(n) / 2) for n in range(1, 4)])
    assert main(["run", "props.txt", "drive", "--evidence", "e.evidence", "-q"]) == 1
    return tmp_path


def certified(*arguments: str, recordings: tuple[str, ...] = ("drive",), evidence: str = "e.evidence") -> int:
    return main(["certify", "props.txt", "--evidence", evidence, *recordings, "-q", *arguments])


def forged(old: str, new: str) -> str:
    """The name of evidence in which something else is said, with the right SHA-256 at its end."""
    body = Path("e.evidence").read_text().rpartition("end sha256")[0]
    assert old in body
    body = body.replace(old, new)
    Path("forged.evidence").write_text(f"{body}end sha256 {sha256(body.encode()).hexdigest()}\n")
    return "forged.evidence"


@pytest.mark.usefixtures("folder")
def test_a_statement_names_the_recording_and_all_that_was_used_by_digest() -> None:
    assert certified("--statement", "s.jsonl") == 3  # nothing is claimed of `forgotten`
    [found] = map(json.loads, Path("s.jsonl").read_text().splitlines())
    assert (found["_type"], found["predicateType"]) == (
        "https://in-toto.io/Statement/v1",
        "https://in-toto.io/attestation/test-result/v0.1",
    )
    digests = {each["name"]: each["digest"]["sha256"] for each in found["subject"]}
    assert digests == {f"drive/{file.name}": sha256(file.read_bytes()).hexdigest() for file in Path("drive").iterdir()}
    used = {each["name"]: each["digest"]["sha256"] for each in found["predicate"]["configuration"]}
    assert list(used) == ["props.txt", "certificates", "e.evidence"]
    for name in ("props.txt", "e.evidence"):
        assert used[name] == sha256(Path(name).read_bytes()).hexdigest()


@pytest.mark.usefixtures("folder")
def test_only_what_holds_has_passed() -> None:
    certified("--statement", "s.jsonl")
    predicate = json.loads(Path("s.jsonl").read_text())["predicate"]
    assert predicate["result"] == "FAILED"
    assert predicate["passedTests"] == ["slow"]
    assert predicate["failedTests"] == ["fast", "owed", "forgotten"]
    slow, fast, owed = predicate["ltlc"]["properties"]
    assert (slow["requirement"], slow["verifies"], slow["verdict"]) == (
        "REQ-1",
        ["SYS-1", "H-7"],
        "presumably_satisfied",
    )
    assert (fast["verdict"], fast["decided_ns"], owed["verdict"]) == ("violated", 2 * 10**9, "presumably_violated")
    assert [each["property"] for each in predicate["ltlc"]["not_covered"]] == ["forgotten"]


@pytest.mark.usefixtures("folder")
def test_equal_evidence_gives_equal_statements_and_pages() -> None:
    for name in ("one", "two"):
        certified("--statement", f"{name}.jsonl", "--page", f"{name}.html")
    assert Path("one.jsonl").read_bytes() == Path("two.jsonl").read_bytes()
    assert Path("one.html").read_bytes() == Path("two.html").read_bytes()


@pytest.mark.usefixtures("folder")
def test_a_recording_of_several_files_is_called_as_its_folder(capsys: pytest.CaptureFixture[str]) -> None:
    certified("--page", "p.html")
    assert "<h2>drive</h2>" in Path("p.html").read_text()
    assert "evidence of drive, by ltlc" in capsys.readouterr().out


@pytest.mark.usefixtures("folder")
def test_a_statement_and_a_page_say_which_part_of_a_recording_was_judged() -> None:
    assert main(["run", "props.txt", "drive", "--from", "+0.5", "--until", "+1", "--evidence", "e.evidence", "-q"]) == 1
    assert certified("--statement", "s.jsonl", "--page", "p.html") == 3
    found = json.loads(Path("s.jsonl").read_text())["predicate"]["ltlc"]
    assert (found["from_ns"], found["to_ns"], found["stamp"]) == (1_500_000_000, 2_000_000_000, "log")
    assert "only up to 2 s" in Path("p.html").read_text()


def test_evidence_of_several_recordings_has_a_statement_for_each(folder: Path) -> None:
    rosbag2(folder / "other", [odometry(10**9, twist__twist__linear__x=0.25)])
    main(["run", "props.txt", "drive", "other", "--evidence", "e.evidence", "-q"])
    assert certified("--statement", "s.jsonl", recordings=("drive", "other")) == 3
    found = [json.loads(line)["subject"][0]["name"] for line in Path("s.jsonl").read_text().splitlines()]
    assert [name.partition("/")[0] for name in found] == ["drive", "other"]


@pytest.mark.usefixtures("folder")
def test_of_forged_evidence_nothing_is_stated_and_the_page_says_so(
    capsys: pytest.CaptureFixture[str],
) -> None:
    name = forged("verdict presumably_satisfied", "verdict satisfied")
    Path("p.html.sig").write_text("of an earlier page")
    assert certified("--statement", "s.jsonl", "--page", "p.html", "--sign", "none.key", evidence=name) == 1
    assert "nothing is stated or signed" in capsys.readouterr().err
    assert not Path("s.jsonl").exists()
    assert not Path("p.html.sig").exists()
    html = Path("p.html").read_text()
    assert "Do not rely on this evidence." in html
    assert "NOT shown, but claimed: Satisfied" in html
    assert not re.search(r'class="(verdict )?satisfied"', html)


@pytest.mark.usefixtures("folder")
def test_a_document_that_is_refused_as_a_whole_is_not_stated() -> None:
    name = forged(sha256(TEXT.encode()).hexdigest(), "0" * 64)
    assert certified("--statement", "s.jsonl", "--page", "p.html", evidence=name) == 1
    assert not Path("s.jsonl").exists()
    assert "Do not rely on this evidence." in Path("p.html").read_text()


@pytest.mark.usefixtures("folder")
def test_what_was_not_checked_whole_is_not_stated() -> None:
    assert certified("--statement", "s.jsonl", "--page", "p.html", recordings=()) == 3
    assert not Path("s.jsonl").exists()
    assert "Checked in part" in Path("p.html").read_text()
    assert "Claimed, but not checked whole: Violated" in Path("p.html").read_text()


@pytest.mark.usefixtures("folder")
@pytest.mark.skipif(shutil.which("ssh-keygen") is None, reason="needs ssh-keygen (Debian: openssh-client)")
def test_a_signature_is_of_the_statement_and_of_nothing_else() -> None:
    subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", "key"], check=True)
    Path("signers").write_text(f"assessor {' '.join(Path('key.pub').read_text().split()[:2])}\n")
    for _ in range(2):  # an earlier signature is replaced
        assert certified("--statement", "s.jsonl", "--page", "p.html", "--sign", "key") == 3
    for name in ("s.jsonl", "p.html"):
        command = ["ssh-keygen", "-Y", "verify", "-f", "signers", "-I", "assessor", "-n", "ltlc-evidence"]
        command += ["-s", f"{name}.sig"]
        content = Path(name).read_bytes()
        assert subprocess.run(command, input=content, capture_output=True, check=False).returncode == 0
        changed = content.replace(b"presumably", b"certainly")
        assert subprocess.run(command, input=changed, capture_output=True, check=False).returncode != 0


@pytest.mark.usefixtures("folder")
def test_a_key_that_is_none_is_unusable(capsys: pytest.CaptureFixture[str]) -> None:
    assert certified("--statement", "s.jsonl", "--sign", "none.key") == 2
    assert "nothing is written, as it cannot be signed: " in capsys.readouterr().err
    assert not Path("s.jsonl").exists()


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--sign", "key"), "--sign needs --statement or --page"),
        (("--statement", "e.evidence"), "e.evidence is not written"),
        (("--statement", "x", "--page", "x"), "x is not written"),
        (("--page", "none/p.html", "--statement", "props.txt"), "props.txt is not written"),
    ],
)
def test_options_that_do_not_fit_are_refused_before_anything_is_checked(
    capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...], said: str
) -> None:
    assert certified(*arguments) == 2
    shown = capsys.readouterr()
    assert said in shown.err
    assert "certified" not in shown.out


@pytest.mark.usefixtures("folder")
def test_without_evidence_there_is_nothing_to_state(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["certify", "props.txt", "none.cert", "--statement", "s.jsonl"]) == 2
    assert "are about --evidence" in capsys.readouterr().err


@pytest.mark.usefixtures("folder")
def test_the_page_has_requirement_text_english_digests_and_what_is_trusted_and_loads_nothing() -> None:
    certified("--page", "p.html")
    html = Path("p.html").read_text()
    for said in (
        "It is &lt;slow&gt; &amp; &#34;safe&#34;.",
        "REQ-1",
        "Verifies SYS-1, H-7.",
        "never v &gt; 2",
        "v is never more than 2",
        "twist.twist.linear.x of /odom (nav_msgs/msg/Odometry) is greater than 2",
        sha256(Path("e.evidence").read_bytes()).hexdigest(),
        sha256(next(Path("drive").glob("*.db3")).read_bytes()).hexdigest(),
        "Violated: whatever had come after",
        "All claims are accepted by all three checks.",
        "forgotten",
        "evidence_of_lines",
    ):
        assert said in html
    assert not re.search(r"(src)=|url\(|@import", html)


WORDED = """decl v /odom Odometry.twist.twist.linear.x
decl scan /scan LaserScan.ranges
decl names /report diagnostic_msgs/DiagnosticArray.status[].name
decl level /report diagnostic_msgs/DiagnosticArray.status[].level
decl mode /mode std_msgs/String.data
model robot: velocity /odom Odometry.twist.twist.linear ;
model cart: position /cart Odometry.pose.pose.position ;
a: never v > 2 and not (mode == "dock" or @{v, -3} <= -1.5)
b: always min(scan[10:20]) =={0.25} 3
c: never any(names == "arm" and level > 1)
d: always (new mode and mode == "go" implies once new v)
e: never robot.velocity > 1 and @{v, when mode == "go"} < 0.5
f: never max(@{v, -4:}) > 1 or cart.velocity > 5
"""


def changed(data: Any) -> Iterator[Any]:
    """The same with one number, string or key that says something changed, over and over."""
    match data:
        case dict():
            for key, value in data.items():
                yield from ({**data, key: other} for other in changed(value))
        case list():
            for number, value in enumerate(data):
                yield from ([*data[:number], other, *data[number + 1 :]] for other in changed(value))
        case bool():
            yield not data
        case int() | float():
            yield data + 1
        case str():
            yield f"{data}x"
        case _:
            raise AssertionError(data)


def test_whatever_is_changed_in_what_an_atom_is_changes_its_words() -> None:
    specification, found = load_text(Source("worded", WORDED))
    assert specification is not None, found
    count = 0
    for of in specification.properties:
        for atom in stated_atoms(of):
            words = in_words(atom.condition)
            assert "{" not in words
            for other in changed(deepcopy(atom.condition)):
                assert in_words(other) != words, other
                count += 1
    assert count > 80
