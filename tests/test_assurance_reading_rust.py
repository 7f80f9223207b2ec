"""Emitted Rust is read back to the machine that it was written from, and whatever is changed in it is refused."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from conditions_support import CONDITIONS, DECLARED
from lowered import texts
from stepping import from_text
from test_backends_rust import AGED, KEPT, OPENED, PAST, SIGNALS, TIMED, fit

from ltlc.assurance.reading.outcomes import Difference, ReadBack
from ltlc.assurance.reading.rust import is_read, written
from ltlc.backends.rust import emit
from ltlc.cli import main


def outcome(text: str, number: int, machines: list[Any]) -> ReadBack | Difference | None:
    part = written(text, machines)[number]
    return part if part is None or isinstance(part, Difference) else part.read_back()


def test_every_feature_is_read_back_or_said_to_be_unread() -> None:
    read = 0
    for text in (*texts(), DECLARED + "".join(f"never {condition}\n" for condition in CONDITIONS)):
        compiled, whole = from_text(text)
        some = fit(compiled, whole)
        if not some:
            continue
        machines = [each.machine for each in some]
        for number, part in enumerate(written(emit(some, whole), machines)):
            assert (part is None) == (not is_read(machines[number]))
            if part is not None:
                assert not isinstance(part, Difference)
                assert isinstance(part.read_back(), ReadBack), some[number].specification.text
                read += 1
    assert read > 130


OTHERS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "&&": "||", "||": "&&", "==": "!=", "!=": "==", "+": "-"}
OTHERS |= {"any": "all"}
TOKEN = re.compile(r"(?<= )(?:<=|>=|<|>|&&|\|\||==|!=|\+)(?= )|\bany\b|\b\d+(?:\.\d+)?\b(?!_)|(?<=Verdict::)\w+")
HARMLESS = (
    "let time = self.due + 1;",
    "let state = self.state;",
    "v_opening: 0.0,",
    "times_0: Times<3>,",
    "times_1: Times<4>,",
)
"""Times of verdicts are not read; without one, or with another type, text does not compile. Others change nothing."""


def other(token: str) -> str:
    if token in OTHERS:
        return OTHERS[token]
    if token.isdigit():
        return str(int(token) + 1)
    return f"{token}7" if token[0].isdigit() else "Violated" if token != "Violated" else "Satisfied"


def mutants(text: str) -> Iterator[tuple[str, str]]:
    """Each line of a property that can be left out, or changed in one place, and the text after that."""
    lines = text.split("\n")
    begin = next(n for n, line in enumerate(lines) if line.startswith("struct Line4"))
    end = next(n for n, line in enumerate(lines) if line.startswith("/// The monitors of all"))
    for number in range(begin, end):
        line = lines[number]
        if line.strip().startswith("//"):
            continue
        changed = [""] if line.endswith(";") else []
        changed += [line[: m.start()] + other(m[0]) + line[m.end() :] for m in TOKEN.finditer(line)]
        for each in changed:
            yield line.strip(), "\n".join([*lines[:number], each, *lines[number + 1 :]])


AGES, COUNTED = "always age(scan) <= 1 s and age(v) <= 2 s", "never count(scan < v) >= 2"
OCCURS = "always (not once v > 2 3 times within 2 s or rate(scan) >= 4 Hz over 1 s)"


@pytest.mark.parametrize("property_", [TIMED, OPENED, AGED, PAST, KEPT, AGES, COUNTED, OCCURS])
def test_whatever_is_changed_in_the_text_of_a_property_is_refused(property_: str) -> None:
    compiled, whole = from_text(SIGNALS + property_)
    machines = [compiled[0].machine]
    assert isinstance(outcome(emit(compiled, whole), 0, machines), ReadBack)
    found = list(mutants(emit(compiled, whole)))
    missed = [line for line, text in found if isinstance(outcome(text, 0, machines), ReadBack)]
    assert len(found) > 20
    assert set(missed) <= set(HARMLESS)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("while time > self.line_4.due {", "while time >= self.line_4.due {"),
        (
            "fn slice<T>(array: &[T], start: i64, stop: i64)",
            "fn slice<T>(array: &[T], stop: i64, start: i64)",
        ),
        ("struct Line4 {", "#[cfg(any())] struct Line4 {"),
        ("let v = signals.v.ago(0);", "let v = signals.v.ago(1);"),
        ("let v = signals.v.ago(0);", "let v = signals.scan.ago(0);"),
        ("    fn expire(&mut self) {", "    fn expire(&mut self) {}\n    fn expire(&mut self) {"),
    ],
)
def test_what_a_property_rests_on_is_read_too(right: str, wrong: str) -> None:
    compiled, whole = from_text(SIGNALS + TIMED)
    text = emit(compiled, whole)
    assert right in text
    assert isinstance(outcome(text.replace(right, wrong), 0, [compiled[0].machine]), Difference)


def test_certify_compares_and_reads_a_file_of_rust(
    tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("p.txt").write_text(f"{SIGNALS}slow: {TIMED}\n")
    assert main(["build", "p.txt", "--target", "rust", "--certificate", "p.cert"]) == 0
    assert "read back" in capsys.readouterr().out
    command = ["certify", "p.txt", "p.cert", "--code", "p.rs"]
    Path("p.rs").write_text(Path("p.rs").read_text().replace("\n\n", "\n// a comment\n"))
    assert main(command) == 0
    said = capsys.readouterr().out
    assert "p.rs: equal, token by token" in said
    assert "slow: its steps, read back, match the certified monitor" in said
    Path("p.rs").write_text(Path("p.rs").read_text().replace("self.count >= count", "self.count > count"))
    assert main(command) == 1
    assert "`self.count > count` where ltlc emits `self.count >= count`" in capsys.readouterr().out
