"""The Coq development checks, assumes what it says, and its extracted checker answers as the Python one does."""

from __future__ import annotations

import random
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest
from cases import TABLE
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from strategies import alphabets, properties
from test_semantics_certificate_text import SPEEDING, TEXT, entry, mangled
from test_semantics_certificate_time import TEXT as TIMED
from timed_cases import TABLE as TIMED_TABLE

from ltlc.semantics.certificate import check, possible
from ltlc.semantics.certificate_reader import UnreadableError, parse
from ltlc.semantics.certificate_text import in_words, to_text
from ltlc.semantics.conditions import Conditions
from ltlc.semantics.encodings import ENCODINGS, encode
from ltlc.semantics.ltl import TRUE, And, Atom, Not

SPEED = Atom("speed > 2")
PROOFS = Path(__file__).parent.parent / "proofs"

pytestmark = pytest.mark.skipif(
    shutil.which("coqc") is None or shutil.which("ocamlopt") is None or shutil.which("make") is None,
    reason="the proofs need coqc, ocamlopt and make (Debian: coq libcoq-stdlib ocaml make)",
)


@pytest.fixture(scope="module")
def certify(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The extracted checker, built from a copy of `proofs`; that the build succeeds is the audit of the assumptions."""
    folder = tmp_path_factory.mktemp("proofs")
    kept = shutil.ignore_patterns(
        "*.vo*", "*.glob", ".*.aux", "*.cm*", "*.o", "kernel.*", "certify", "assumptions.found"
    )
    shutil.copytree(PROOFS, folder, dirs_exist_ok=True, ignore=kept)
    built = subprocess.run(["make", "-C", str(folder)], capture_output=True, text=True, check=False)
    assert built.returncode == 0, built.stdout + built.stderr
    return folder / "checker" / "certify"


def run(certify: Path, *arguments: str, text: str = "") -> subprocess.CompletedProcess[str]:
    return subprocess.run([str(certify), *arguments], input=text, capture_output=True, text=True, check=False)


def python_answer(text: str) -> tuple[int, list[str]]:
    """What the Python checker says of a file, as the extracted one says it."""
    try:
        entries = parse(text)
    except UnreadableError as error:
        return 2, [f"line {error.line}"]
    code, lines = 0, []
    for each in entries:
        numbers = Conditions()
        encoded = numbers.number(encode(each.subject, ENCODINGS[each.encoding]))
        about = numbers.number(each.certificate.formula) == encoded
        answer = check(each.certificate)
        code = max(code, 0 if about and answer.exact else 1)
        exactly = "certified exactly" if answer.exact else "certified"
        said = exactly if about and answer.certified else "not certified"
        if not possible(each.certificate.assumption):
            said = "not certified: no letter is found that its assumption allows"
        lines.append(f"{each.label}: {said}")
        if each.certificate.assumption != TRUE:
            lines.append(f"  assuming {in_words(each.certificate.assumption)}")
    return code, lines


def coq_answer(certify: Path, file: Path, text: str) -> tuple[int, list[str]]:
    file.write_text(text, encoding="utf-8")
    found = run(certify, str(file))
    assert not found.stderr, found.stderr
    if found.returncode == 2:
        return 2, [found.stdout.removeprefix(f"{file}: ").split(":")[0]]
    return found.returncode, found.stdout.splitlines()


def test_every_theorem_checks_and_assumes_what_is_listed(certify: Path) -> None:
    listed = (PROOFS / "assumptions.txt").read_text(encoding="utf-8")
    assert (certify.parent.parent / "assumptions.found").read_text(encoding="utf-8") == listed
    answers = {line.rpartition(": ")[2] if "classic" not in line else line for line in listed.splitlines()}
    assert answers == {
        "Closed under the global context",
        "Axioms:",
        "Classical_Prop.classic : forall P : Prop, P \\/ ~ P",
    }


@pytest.mark.parametrize("file", [TABLE, TIMED_TABLE], ids=["untimed", "timed"])
def test_the_table_of_cases_is_what_the_extracted_evaluators_say(certify: Path, file: Path) -> None:
    table = file.read_text(encoding="utf-8")
    assert run(certify, "--table", text=table).stdout == table


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(property_=properties(), encoding=st.sampled_from(list(ENCODINGS.values())), alphabet=alphabets())
def test_both_checkers_accept_certificates_of_random_properties(
    certify: Path, tmp_path: Path, property_, encoding, alphabet
) -> None:
    text = to_text([entry("any", property_, encoding, alphabet)])
    code, (said, *assuming) = coq_answer(certify, tmp_path / "one", text)
    assert (code, said) == (0, "any: certified exactly")
    assert (code, [said, *assuming]) == python_answer(text)


@settings(max_examples=80, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(property_=properties(), alphabet=alphabets(), chance=st.randoms(use_true_random=False))
def test_both_checkers_say_the_same_of_a_mangled_certificate(
    certify: Path, tmp_path: Path, property_, alphabet, chance: random.Random
) -> None:
    text = mangled(to_text([entry("any", property_, alphabet=alphabet)]), chance)
    assert coq_answer(certify, tmp_path / "one", text) == python_answer(text)


def test_both_checkers_refuse_a_false_assumption(certify: Path, tmp_path: Path) -> None:
    certificate = replace(SPEEDING.certificate, assumption=And(SPEED, Not(SPEED)))
    text = to_text([replace(SPEEDING, certificate=certificate)])
    said = ["line 4: not certified: no letter is found that its assumption allows"]
    assumed = ["  assuming speed > 2 and not speed > 2"]
    assert coq_answer(certify, tmp_path / "one", text) == python_answer(text) == (1, said + assumed)


@pytest.mark.parametrize("text", ["", "garbage", TEXT[:-5], TEXT.replace("episode", "dwyer")])
def test_both_checkers_refuse_what_is_no_certificate_of_its_property(certify: Path, tmp_path: Path, text: str) -> None:
    code, lines = python_answer(text)
    assert coq_answer(certify, tmp_path / "one", text) == (code, lines)
    assert code != 0


def test_the_extracted_checker_says_that_it_does_not_know_clocks_yet(certify: Path, tmp_path: Path) -> None:
    file = tmp_path / "timed"
    file.write_text(TIMED, encoding="utf-8")
    found = run(certify, str(file))
    assert found.returncode == 2
    assert "a property with clocks: this checker does not know them yet" in found.stdout
