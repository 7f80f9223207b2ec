"""Emitted Rust is read back to the machine that it was written from, and whatever is changed in it is refused."""

from __future__ import annotations

import random
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
from conditions_support import CONDITIONS, DECLARED
from effort import share_of
from lowered import texts
from stepping import from_text
from test_backends_rust import AGED, KEPT, OPENED, PAST, RATED, SIGNALS, TIMED, fit
from test_each_c import RESPONSE
from test_each_message_c import ANSWERED

from ltlc.assurance.reading.c.files import WrittenInC
from ltlc.assurance.reading.outcomes import Difference, ReadBack
from ltlc.assurance.reading.rust import require_same, written
from ltlc.assurance.reading.trees import NotUnderstoodError
from ltlc.backends.rust import emit, in_c
from ltlc.cli import main
from ltlc.compiler import Compiled
from ltlc.specification.specification import Specification


def read(text: str, compiled: list[Compiled], whole: Specification) -> Sequence[WrittenInC | Difference]:
    files = in_c(compiled, whole)
    return written(text, files.header, files.source, compiled, whole.rate, whole.timeout)


def outcome(text: str, compiled: list[Compiled], whole: Specification) -> ReadBack | Difference:
    (part,) = read(text, compiled, whole)
    return part if isinstance(part, Difference) else part.read_back()


def test_every_feature_is_read_back() -> None:
    count = 0
    for text in (*texts(), *RATED, DECLARED + "".join(f"never {condition}\n" for condition in CONDITIONS)):
        compiled, whole = from_text(text)
        some = fit(compiled, whole)
        for number, part in enumerate(read(emit(some, whole), some, whole) if some else ()):
            assert not isinstance(part, Difference)
            assert isinstance(part.read_back(), ReadBack), some[number].specification.text
            count += 1
    assert count > 150


OTHERS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "&&": "||", "||": "&&", "==": "!=", "!=": "==", "+": "-"}
OTHERS |= {"any": "all"}
TOKEN = re.compile(r"(?<= )(?:<=|>=|<|>|&&|\|\||==|!=|\+)(?= )|\bany\b|\b\d+(?:\.\d+)?\b(?!_)|(?<=Verdict::)\w+")


def other(token: str) -> str:
    if token in OTHERS:
        return OTHERS[token]
    if token.isdigit():
        return str(int(token) + 1)
    return f"{token}7" if token[0].isdigit() else "Violated" if token != "Violated" else "Satisfied"


def mutants(text: str) -> Iterator[tuple[str, str]]:
    """Each line that can be left out, or changed in one place, and the text after that."""
    lines = text.split("\n")
    for number, line in enumerate(lines):
        if line.strip().startswith("//"):
            continue
        changed = [""] if line.endswith(";") else []
        changed += [line[: m.start()] + other(m[0]) + line[m.end() :] for m in TOKEN.finditer(line)]
        for each in changed:
            yield line.strip(), "\n".join([*lines[:number], each, *lines[number + 1 :]])


AGES, COUNTED = "always age(scan) <= 1 s and age(v) <= 2 s", "never count(scan < v) >= 2"
OCCURS = "always (not once v > 2 3 times within 2 s or rate(scan) >= 4 Hz over 1 s)"


WHOLE = [SIGNALS + property_ for property_ in (TIMED, OPENED, AGED, PAST, KEPT, AGES, COUNTED, OCCURS)]


@pytest.mark.parametrize("text_", [*WHOLE, RATED[1], RESPONSE, ANSWERED])
def test_whatever_is_changed_in_the_text_is_refused(text_: str) -> None:
    compiled, whole = from_text(text_)
    text = emit(compiled, whole)
    part, *_ = read(text, compiled, whole)
    assert isinstance(part, WrittenInC)
    labels = [each.specification.label for each in compiled]
    found = [(line, changed) for line, changed in mutants(text) if changed != text]
    assert len(found) > 80
    tried = random.Random(text_).sample(found, share_of(len(found)))
    missed = [line for line, changed in tried if not is_refused(changed, part, labels)]
    assert missed == []


def is_refused(text: str, part: WrittenInC, labels: list[str]) -> bool:
    try:
        require_same(text, part.definitions, labels)
    except NotUnderstoodError:
        return True
    return False


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("start: i64, stop: i64)", "stop: i64, start: i64)"),
        ("struct Line4 {", "#[cfg(any())] struct Line4 {"),
        ("fn step(&mut self, time: i64, v: f64", "fn step(&mut self, time: i64, v: f32"),
        ("Option<f64>", "Option<f32>"),
        ("self.line_4.step(time, self.signals.v[", "self.line_4.step(time, self.signals.w["),
        ("let state = self.state;", "let mut state = self.state; state = 0;"),
        ("    fn expire(&mut self) {", "    fn expire(&mut self) {}\n    fn expire(&mut self) {"),
        ("steps: self.signals.together", "steps: self.signals.v_count"),
        ("impl Property {", "mod hidden {} impl Property {"),
        ("            Property::Line4 => ", "            Property::Line4 if false => "),
    ],
)
def test_what_a_property_rests_on_is_read_too(right: str, wrong: str) -> None:
    compiled, whole = from_text(SIGNALS + TIMED)
    text = emit(compiled, whole)
    assert right in text
    assert isinstance(outcome(text.replace(right, wrong), compiled, whole), Difference)


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
    Path("p.rs").write_text(Path("p.rs").read_text().replace("latest + depth - ago", "latest + ago - depth"))
    assert main(command) == 1
    assert "latest + ago - depth };` where ltlc emits `return if ago <= latest" in capsys.readouterr().out
