"""`ltlc certify --program`: what runs is accepted if it follows the certified monitor, and is what ltlc makes."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest
from quick_gate import quick_gate

from ltlc import cli

PROPERTIES = """\
decl d /d Float32.data
decl v /v Float64.data
near: never (d < 1 and v > 2)
sign: after_until d < 1, d > 3, eventually v == 0
"""
OPENINGS = """\
decl a /a Float64.data
decl b /b Bool.data
decl e /e Bool.data
opened: after_until b, new e, never @{a, opening} < 1
"""
CLOCKS = "owed: always (v > 1 implies eventually d < 2 within 3 s)\n"


def build(folder: Path, properties: str, *options: str) -> int:
    """The exit code of `ltlc build`, which leaves all in `folder`."""
    (folder / "props.txt").write_text(properties)
    files = [str(folder / "props.txt"), "-o", str(folder / "monitors.json")]
    return cli.main(["build", *files, "--target", "json", "-q", *options])


Once = Callable[[str, bool], Path]
"""Where some properties were built, with certificates and, if asked for, with programs."""


@pytest.fixture(scope="module")
def once(tmp_path_factory: pytest.TempPathFactory) -> Once:
    @cache
    def made(properties: str, with_programs: bool) -> Path:
        folder = tmp_path_factory.mktemp("built")
        options = ["--certificate", str(folder / "props.cert"), *["--program"][:with_programs]]
        with quick_gate():
            assert build(folder, properties, *options) == 0
        return folder

    return made


class Built:
    """A specification and its certificates in a folder, to be changed."""

    def __init__(self, folder: Path, once: Once, capsys: pytest.CaptureFixture[str]) -> None:
        self.properties, self.certificate, self.capsys = folder / "props.txt", folder / "props.cert", capsys
        self._once = once

    def build(self, properties: str, with_programs: bool = True) -> None:
        shutil.copytree(self._once(properties, with_programs), self.properties.parent, dirs_exist_ok=True)

    def certify(self) -> tuple[int, list[str]]:
        """What is said of the programs, and the exit code."""
        self.capsys.readouterr()
        exit_code = cli.main(["certify", str(self.properties), str(self.certificate), "--program", "-q"])
        return exit_code, [line for line in self.capsys.readouterr().out.splitlines() if "program" in line]

    def change(self, right: str, wrong: str) -> None:
        text = self.certificate.read_text()
        assert right in text
        self.certificate.write_text(text.replace(right, wrong, 1))


@pytest.fixture
def built(tmp_path: Path, once: Once, capsys: pytest.CaptureFixture[str]) -> Built:
    made = Built(tmp_path, once, capsys)
    made.build(PROPERTIES)
    return made


def test_the_programs_of_a_build_follow_their_monitors(built: Built) -> None:
    built.build(PROPERTIES + CLOCKS)
    said = [f"{label}: its program follows the certified monitor" for label in ("near", "sign", "owed")]
    assert built.certify() == (0, said)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("s0 presumably_satisfied", "s0 presumably_violated"),
        ("\no1 s1\n", "\no1 s0\n"),
        ("then o1 else o0", "then o0 else o1"),
        ("\npair s1 q1", ""),
    ],
    ids=["a wrong verdict", "a wrong state", "a swapped branch", "a pair left out"],
)
def test_a_program_that_does_something_else_is_refused(built: Built, right: str, wrong: str) -> None:
    built.change(right, wrong)
    exit_code, (near, sign) = built.certify()
    assert exit_code == 1
    assert near == "near: its program is NOT shown to be right: the pairs do not show it"
    assert sign == "sign: its program follows the certified monitor"


def test_a_program_that_is_right_but_not_what_ltlc_makes_is_refused(built: Built) -> None:
    built.change("s1 violated o1", "s1 violated b2")
    built.change("\no0 s0\n", "\nb2 a0 then o1 else o1\no0 s0\n")
    exit_code, (near, _) = built.certify()
    assert exit_code == 1
    assert "it follows the monitor, but differs from the program that ltlc" in near


def test_a_certificate_without_programs_is_said_to_have_none(built: Built) -> None:
    built.build(PROPERTIES, with_programs=False)
    exit_code, said = built.certify()
    assert exit_code == 1
    assert all("the certificate has no program" in line for line in said)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("c0 now 3000000000", "c0 now 3000000001"),
        (" c0 never", ""),
        ("s1 presumably_violated b2 expires o5", "s1 presumably_violated b2"),
        ("\nc0\n", "\nc0 first 9\n"),
    ],
    ids=["a late deadline", "a clock that runs on", "no clock step", "a clock that runs at first"],
)
def test_a_program_with_a_clock_that_goes_wrong_is_refused(built: Built, right: str, wrong: str) -> None:
    built.build(PROPERTIES + CLOCKS)
    built.change(right, wrong)
    exit_code, (*untimed, owed) = built.certify()
    assert exit_code == 1
    assert all("follows" in line for line in untimed)
    assert owed == "owed: its program is NOT shown to be right: the pairs do not show it"


def test_values_at_openings_that_a_clock_step_takes_are_said_not_to_be_covered(built: Built) -> None:
    built.build(PROPERTIES + OPENINGS)
    exit_code, (*others, opened) = built.certify()
    assert exit_code == 1
    assert all("follows" in line for line in others)
    assert "it takes values at openings at clock steps, which is not covered yet" in opened


def test_a_program_of_a_monitor_that_is_not_certified_is_not_looked_at(built: Built) -> None:
    built.change("q1 violated q1", "q1 satisfied q1")
    exit_code, (near, sign) = built.certify()
    assert exit_code == 1
    assert "no certified monitor" in near
    assert "follows" in sign


def test_programs_are_not_written_without_certificates(tmp_path: Path) -> None:
    assert build(tmp_path, PROPERTIES, "--program") == 2
