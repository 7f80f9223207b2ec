"""`ltlc certify` checks the regions of guards: that they are of these guards, and closed."""

from __future__ import annotations

from pathlib import Path

import pytest
from quick_gate import quick_gate

from ltlc.cli import main

PROPERTIES = """decl speed /cmd_vel Twist.linear.x
decl scan /scan LaserScan.ranges
message stop {linear.x: 0}
message slow {linear.x: 0.1}
guard /cmd_vel_raw to /cmd_vel else stop
assume sane: always min(scan) >= 0
at_once: always (new speed and min(scan) < 0.5 implies speed <= 0.2)
soon: always (min(scan) < 0.5 implies eventually speed <= 0.2 within 100 ms)
"""


@pytest.fixture(scope="module")
def certificates(tmp_path_factory: pytest.TempPathFactory) -> str:
    """What `ltlc build` writes of PROPERTIES."""
    folder = tmp_path_factory.mktemp("guards")
    (folder / "p.txt").write_text(PROPERTIES, encoding="utf-8")
    options = ["-t", "json", "-o", str(folder / "p.json"), "--certificate", str(folder / "p.cert")]
    with quick_gate():
        assert main(["build", str(folder / "p.txt"), *options]) == 0
    return (folder / "p.cert").read_text(encoding="utf-8")


def said(folder: Path, capsys: pytest.CaptureFixture[str], properties: str, text: str) -> tuple[int, list[str]]:
    (folder / "p.txt").write_text(properties, encoding="utf-8")
    (folder / "p.cert").write_text(text, encoding="utf-8")
    capsys.readouterr()
    code = main(["certify", str(folder / "p.txt"), str(folder / "p.cert")])
    output = capsys.readouterr()
    lines = output.out.splitlines()
    return code, [line for line in lines if line.startswith(("guard", "  "))] or output.err.splitlines()


def test_the_region_of_a_guard_is_certified(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], certificates: str
) -> None:
    assert said(tmp_path, capsys, PROPERTIES, certificates) == (
        0,
        ["guard /cmd_vel_raw to /cmd_vel: certified", "  keeping at_once, soon", "  relying on sane"],
    )


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        (
            "\na2 m0 speed",
            "\na2 m1 speed",
            "it is of another guard: 'a2 m1 speed <= 0.2' should be 'a2 m0 speed <= 0.2'",
        ),
        (
            "u0 assumes",
            "u0 keeps",
            "it is of another guard: 'u0 keeps 0 begins silent' should be 'u0 assumes 0 begins silent'",
        ),
        ("\nu2 keeps 2 begins 1", "", "it is of another guard"),
        ("g0 m0 stop a2 true", "g0 m0 stop", "it is of another guard: 'g0 m0 stop' should be 'g0 m0 stop a2 true'"),
        ("lead 10000000", "lead 1", "it is of another guard: 'lead 1' should be 'lead 10000000'"),
        ("assumption d1", "assumption d0", "it assumes more about its conditions than their arithmetic gives"),
        ("ahead r6 2.1 g0 true\n", "", "r6: no answer to the passage of time"),
    ],
)
def test_a_region_of_something_else_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], certificates: str, old: str, new: str, reason: str
) -> None:
    assert certificates.count(old) == 1
    code, (line, *_) = said(tmp_path, capsys, PROPERTIES, certificates.replace(old, new))
    assert (code, line) == (1, f"guard /cmd_vel_raw to /cmd_vel: not certified: {reason}")


def test_a_guard_with_another_fallback_has_another_region(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], certificates: str
) -> None:
    code, (line, *_) = said(tmp_path, capsys, PROPERTIES.replace("else stop", "else stop, slow"), certificates)
    assert code == 1
    assert line.startswith("guard /cmd_vel_raw to /cmd_vel: not certified: it is of another guard")


def test_a_guard_without_a_region_and_a_region_without_a_guard_are_reported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], certificates: str
) -> None:
    alone = certificates[: certificates.index("\nguard ")].replace(" guards 1", "")
    code, (line, *_) = said(tmp_path, capsys, PROPERTIES, alone)
    assert (code, line) == (1, "guard /cmd_vel_raw to /cmd_vel: not certified: it has no region")
    watched = PROPERTIES.replace("guard /cmd_vel_raw to /cmd_vel else stop\n", "").replace("assume ", "")
    code, (line, *_) = said(tmp_path, capsys, watched, certificates)
    assert (code, line) == (1, "guard /cmd_vel_raw to /cmd_vel: not certified: the specification has no such guard")


def test_a_guard_needs_certificates_of_what_it_keeps(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], certificates: str
) -> None:
    code, (line, *_) = said(tmp_path, capsys, PROPERTIES, certificates.replace("remains k1.f13", "remains k1.f6", 1))
    if code == 1:
        assert line == "guard /cmd_vel_raw to /cmd_vel: not certified: soon is not"
    _, _, soon = certificates.partition("property soon")
    witness = next(each for each in soon.splitlines() if each.startswith("witness q1"))
    changed = certificates.replace(f"{witness}\n", "").replace("witness q1", "# witness q1")
    code, lines = said(tmp_path, capsys, PROPERTIES, changed)
    assert (code, lines[0]) == (1, "guard /cmd_vel_raw to /cmd_vel: not certified: soon is not")


def test_what_is_no_line_of_a_guard_makes_the_file_unusable(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], certificates: str
) -> None:
    code, lines = said(tmp_path, capsys, PROPERTIES, certificates.replace("ahead r6 2.1 g0", "ahead r6 2.7 g0"))
    number = certificates.split("\n").index("ahead r6 2.1 g0 true") + 1
    assert code == 2
    assert any(f":{number}: " in line for line in lines)


def test_only_what_runs_is_refused_for_a_guard(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A module would hold back nothing; a monitor as data does not seem to."""
    (tmp_path / "p.txt").write_text(PROPERTIES, encoding="utf-8")
    with quick_gate():
        codes = [
            main(["build", str(tmp_path / "p.txt"), "-t", target, "-o", str(tmp_path / name)])
            for target, name in (("python", "p.py"), ("rust", "p.rs"), ("json", "p.json"), ("dot", "p.dot"))
        ]
    assert codes == [2, 2, 0, 0]
    said = capsys.readouterr().err
    assert "the target `python` has no guards" in said
    assert "the target `rust` has no guards" in said
