"""The Coq development checks, assumes what it says, and its extracted checker answers as the Python one does."""

from __future__ import annotations

import math
import random
import re
import shutil
import subprocess
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cases import TABLE
from control_mutants import control_mutants
from effort import share_of
from evidencing import (
    OPENINGS,
    SLICES,
    entries_of,
    evidence_of,
    judge_of,
    random_rows,
    said_of,
    specification,
    write_bag,
)
from guarding import certified
from guarding import drawn as guard_drawn
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from judged_cases import TABLE as JUDGED_TABLE
from judged_cases import Case, answer, cases, drawn, evidence, random_claim
from quick_gate import quick_gate
from strategies import alphabets, properties
from test_semantics_certificate_text import SPEEDING, STOP_SIGN, TEXT, entry, mangled
from test_semantics_certificate_time import TEXT as TIMED
from test_semantics_robustness import measured_run
from timed import Draw, ordinary_atoms
from timed_cases import TABLE as TIMED_TABLE

from ltlc.assurance.evidence.checked import checked
from ltlc.assurance.evidence.document import Claim, Document, Summed, digest, printed
from ltlc.assurance.evidence.parsing import parsed
from ltlc.assurance.evidence.reader import Read
from ltlc.assurance.pairs import pairs_of
from ltlc.cli import main
from ltlc.monitoring.columns.robustness import still_possible
from ltlc.monitoring.columns.series import UnsupportedError
from ltlc.monitoring.columns.timeline import Timeline
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.arenas import Arena
from ltlc.semantics.certificate import Certificate, Place, check, is_run, possible
from ltlc.semantics.certificate_reader import UnreadableError, parse
from ltlc.semantics.certificate_text import Entry, in_words, to_text
from ltlc.semantics.conditions import Conditions
from ltlc.semantics.control import Followed
from ltlc.semantics.encodings import ENCODINGS, EPISODE, Encoding, ManyClocksError, encode
from ltlc.semantics.finite import holds
from ltlc.semantics.following import follows_monitor
from ltlc.semantics.lasso import holds_on_lasso
from ltlc.semantics.ltl import TRUE, And, Atom, Formula, Not
from ltlc.semantics.properties import Property, Within, children, predicates
from ltlc.semantics.region_check import objection
from ltlc.semantics.region_reader import guards_of, read_region
from ltlc.semantics.reset_machine import ResetMachine
from ltlc.semantics.robustness import held, robustness, with_past
from ltlc.semantics.timed_atoms import News, atoms_within
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Lasso

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
    shutil.copytree(PROOFS, folder, dirs_exist_ok=True)  # with what has been checked before: make checks the rest
    built = subprocess.run(["make", "-C", str(folder)], capture_output=True, text=True, check=False)
    assert built.returncode == 0, built.stdout + built.stderr
    return folder / "checker" / "certify"


def run(certify: Path, *arguments: str, text: str = "") -> subprocess.CompletedProcess[str]:
    return subprocess.run([str(certify), *arguments], input=text, capture_output=True, text=True, check=False)


OVER_WORDS = "certified, exactly over the words of its reset machine"


def exact_over_words(certificate: Certificate) -> bool:
    """Whether the witnesses are words of the reset machine that leave the verdict open: what Coq calls `exact`."""
    time = ResetMachine(certificate.formula)

    def is_open(place: Place, words: Sequence[Lasso]) -> bool:
        runs = [word for word in words if is_run(time, place.clocks, word)]
        return {holds_on_lasso(place.remains, word) for word in runs} == {True, False}

    letters = [letter for words in certificate.witnesses for word in words for letter in (*word.stem, *word.loop)]
    places = zip(certificate.annotations, certificate.witnesses, strict=True)
    return all(holds(certificate.assumption, (letter,)) for letter in letters) and all(
        is_open(place, words) for some, words in places for place in some
    )


def judged(certify: Path, folder: Path, certificates: str, document: str) -> tuple[int, list[str]]:
    """What the judge from Coq says of the claims in evidence."""
    (folder / "certificates").write_text(certificates, encoding="utf-8")
    (folder / "evidence").write_text(document, encoding="utf-8")
    said = run(certify.with_name("judge"), str(folder / "certificates"), str(folder / "evidence"))
    assert not said.stderr, said.stderr
    return said.returncode, [line for line in said.stdout.splitlines() if line != "evidence of run.mcap"]


def python_said(each: Entry) -> str:
    """What the Python checker says of a certificate, as the extracted one says it, which knows no strategies."""
    certificate, numbers = each.certificate, Conditions()
    if not possible(certificate.assumption):
        return "not certified: no letter is found that its assumption allows"
    answer = check(certificate)
    encoded = numbers.number(encode(each.subject, ENCODINGS[each.encoding]))
    if numbers.number(certificate.formula) != encoded or not answer.certified:
        return "not certified"
    if ResetMachine(certificate.formula).words_are_runs:
        return "certified exactly" if answer.exact else "certified"
    assert exact_over_words(certificate) or not answer.exact
    return OVER_WORDS if exact_over_words(certificate) else "certified"


def python_answer(text: str) -> tuple[int, list[str]]:
    """What the Python checker says of a file, as the extracted one says it."""
    try:
        entries = parse(text)
    except UnreadableError as error:
        return 2, [f"line {error.line}"]
    lines = []
    for each in entries:
        said = f"{each.label}: {python_said(each)}"
        lines.append(said)
        if each.certificate.assumption != TRUE:
            lines.append(f"  assuming {in_words(each.certificate.assumption)}")
        if each.program is not None and ": not certified" not in said:
            lines.append(f"  its program {'follows' if follows(each) else NOT_SHOWN} the monitor")
    wrong = (line.endswith(": certified") or ": not certified" in line or NOT_SHOWN in line for line in lines)
    return int(any(wrong)), lines


NOT_SHOWN = "is not shown to follow"


def follows(each: Entry) -> bool:
    certificate = each.certificate
    assert each.program is not None
    return follows_monitor(certificate.formula, certificate.assumption, certificate.monitor, each.program).follows


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
    assert listed == (
        "constructive: Closed under the global context\n"
        "classical: Axioms:\n"
        "Classical_Prop.classic : forall P : Prop, P \\/ ~ P\n"
    )


@pytest.mark.parametrize("file", [TABLE, TIMED_TABLE], ids=["untimed", "timed"])
def test_the_table_of_cases_is_what_the_extracted_evaluators_say(certify: Path, file: Path) -> None:
    table = file.read_text(encoding="utf-8")
    assert run(certify, "--table", text=table).stdout == table


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(property_=properties(), encoding=st.sampled_from(list(ENCODINGS.values())), alphabet=alphabets())
def test_both_checkers_accept_certificates_of_random_properties(
    certify: Path, tmp_path: Path, property_: Property, encoding: Encoding, alphabet: Alphabet
) -> None:
    text = to_text([entry("any", property_, encoding, alphabet)])
    code, (said, *assuming, follows) = coq_answer(certify, tmp_path / "one", text)
    assert (code, said, follows) == (0, "any: certified exactly", "  its program follows the monitor")
    assert (code, [said, *assuming, follows]) == python_answer(text)


@settings(max_examples=80, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(property_=properties(), alphabet=alphabets(), chance=st.randoms(use_true_random=False))
def test_both_checkers_say_the_same_of_a_mangled_certificate(
    certify: Path, tmp_path: Path, property_: Property, alphabet: Alphabet, chance: random.Random
) -> None:
    text = mangled(to_text([entry("any", property_, alphabet=alphabet)]), chance)
    assert coq_answer(certify, tmp_path / "one", text) == python_answer(text)


def with_mutants(each: Entry) -> str:
    """An entry for the program of `each`, and one for some of its mutants."""
    certificate = each.certificate
    assert each.program is not None
    mutants = [*control_mutants(each.program.control)]
    controls = [each.program.control, *random.Random(1).sample(mutants, share_of(len(mutants) // 3))]
    arguments = certificate.formula, certificate.monitor, certificate.assumption
    programs = [Followed(control, pairs_of(control, *arguments)) for control in controls]
    return to_text(replace(each, label=f"{n}", program=program) for n, program in enumerate(programs))


def test_both_checkers_say_the_same_of_mutants_of_a_program(certify: Path, tmp_path: Path) -> None:
    for each in (STOP_SIGN, *(parse(timed_text(seed))[0] for seed in range(1))):
        text = with_mutants(each)
        code, (_, follows, *lines) = coq_answer(certify, tmp_path / "one", text)
        assert (code, ["0: " + python_said(each), follows, *lines]) == python_answer(text)
        assert follows == "  its program follows the monitor"
        assert sum(NOT_SHOWN in line for line in lines) > 0.3 * len(lines)


def test_both_checkers_refuse_a_false_assumption(certify: Path, tmp_path: Path) -> None:
    certificate = replace(SPEEDING.certificate, assumption=And(SPEED, Not(SPEED)))
    text = to_text([replace(SPEEDING, certificate=certificate)])
    said = ["line 4: not certified: no letter is found that its assumption allows"]
    assumed = ["  assuming speed > 2 and not speed > 2"]
    answer = coq_answer(certify, tmp_path / "one", text)
    assert answer == python_answer(text)
    assert (answer[0], answer[1][:2]) == (1, said + assumed)


@pytest.mark.parametrize("text", ["", "garbage", TEXT[:-5], TEXT.replace("episode", "dwyer")])
def test_both_checkers_refuse_what_is_no_certificate_of_its_property(certify: Path, tmp_path: Path, text: str) -> None:
    code, lines = python_answer(text)
    assert coq_answer(certify, tmp_path / "one", text) == (code, lines)
    assert code != 0


TIME = Path(__file__).parent / "fixtures" / "check" / "time.txt"


def test_both_checkers_certify_every_sentence_about_time(certify: Path, tmp_path: Path) -> None:
    certificate = tmp_path / "certificate"
    options = ["--target", "json", "-o", str(tmp_path / "out"), "--certificate", str(certificate), "--program"]
    with quick_gate():
        built = main(["build", str(TIME), *options])
    text = certificate.read_text(encoding="utf-8")
    code, lines = coq_answer(certify, tmp_path / "one", text)
    assert (built, code, lines) == (0, *python_answer(text))
    assert code == 0
    assert len(lines) == 2 * 16 - 1  # s4 asks for an age: what runs of it is not covered


BOUNDS = (
    "7 ns",
    "1234 ns",
    "999 us",
    "1.0005 ms",
    "12.4 ms",
    "1.5 s",
    "1.234567891 s",
    "61 s",
    "2 min",
    "1.5 h",
    "4 h",
)


def test_both_checkers_read_every_bound_as_it_is_written(certify: Path, tmp_path: Path) -> None:
    properties, certificate = tmp_path / "bounds.txt", tmp_path / "certificate"
    states = [f"eventually v > 1 within {bound}" for bound in BOUNDS]
    properties.write_text("\n".join(["decl v /v Float64.data", *states, "always v < 1 for [0.3 s, 2 s]", ""]), "utf-8")
    options = ["--target", "json", "-o", str(tmp_path / "out"), "--certificate", str(certificate)]
    with quick_gate():
        assert main(["build", str(properties), *options]) == 0
    text = certificate.read_text(encoding="utf-8")
    code, lines = coq_answer(certify, tmp_path / "one", text)
    assert (code, lines) == python_answer(text)
    assert (code, len(lines)) == (0, len(BOUNDS) + 1)


@pytest.mark.parametrize("seed", range(share_of(60)))
def test_both_checkers_say_the_same_of_the_region_of_a_guard_and_of_mangled_ones(
    certify: Path, tmp_path: Path, seed: int
) -> None:
    chance = random.Random(seed)
    (arena,), text = certified(guard_drawn(chance).text)
    start = text.index("\nassumption ", text.index("\nguard ")) + 1
    for changed in (text, *(text[:start] + altered_region(text[start:], chance) for _ in range(8))):
        code, lines = coq_answer(certify, tmp_path / "one", changed)
        assert python_said_of_guard(arena, changed) in (lines[:1] if code == 2 else lines)


def python_said_of_guard(arena: Arena, text: str) -> str:
    (lines,) = guards_of(text)
    try:
        why = objection(arena, read_region(lines, arena))
    except UnreadableError as error:
        return f"line {error.line}"
    return f"guard /raw to /cmd: {'certified' if why is None else f'not certified: {why}'}"


def altered_region(text: str, chance: random.Random) -> str:
    """Its lines, of which one is lost, or has a word exchanged for one of its sort."""
    lines = text.splitlines()
    here = chance.randrange(len(lines) - 1)
    first, *words = lines[here].split(" ")
    if chance.random() < 0.2 or not words:
        del lines[here]
    else:
        place = chance.randrange(len(words))
        sort = re.sub(r"\d+", "0", words[place])
        alike = [w for each in text.split("\n") for w in each.split(" ")[1:] if re.sub(r"\d+", "0", w) == sort]
        words[place] = chance.choice([*alike, "true", "false"] if sort in ("d0", "true", "false") else alike)
        lines[here] = " ".join([first, *words])
    return "\n".join(lines) + "\n"


GUARDED = """decl speed /cmd_vel Twist.linear.x
decl scan /scan LaserScan.ranges
at_once: always (new speed and min(scan) < 0.5 implies speed <= 0.2)
soon: always (min(scan) < 0.5 implies eventually speed <= 0.2 within 100 ms)
"""
GUARD = """
guard 5 /cmd_vel_raw to /cmd_vel
lead 10000000
m0 /cmd_vel
m1 /scan
a0 m1 min(scan) < 0.5
a1 m0 speed <= 0.2
n0 m0 new speed
g0 m0 stop a1 true
u0 keeps 0 begins 1
u1 keeps 1 begins 1
d0 a1 then false else true
assumption true
k0 read running 0 idle
k1 read running 0 running 0
r0 silent waits waits rests true
r1 0 waits waits rests true
r2 1 q0 k0.q0 rests true
r3 1 q0 k1.q1 rests d0
ahead r3 1.1 g0 d0
end
"""
"""What is near is answered by `stop`, before the clock of `soon` passes its bound."""


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The certificates of GUARDED, and then GUARD."""
    folder = tmp_path_factory.mktemp("guarded")
    properties, certificate = folder / "properties.txt", folder / "certificate"
    properties.write_text(GUARDED, encoding="utf-8")
    with quick_gate():
        assert (
            main(
                [
                    "build",
                    str(properties),
                    "--target",
                    "json",
                    "-o",
                    str(folder / "out"),
                    "--certificate",
                    str(certificate),
                ]
            )
            == 0
        )
    text = certificate.read_text(encoding="utf-8")
    return text.replace("properties 2\n", "properties 2 guards 1\n") + GUARD


def test_the_checker_from_coq_certifies_a_guard_with_two_properties_and_a_clock(
    certify: Path, tmp_path: Path, guarded: str
) -> None:
    properties = ["at_once: certified exactly", "soon: certified exactly"]
    guard = ["guard /cmd_vel_raw to /cmd_vel: certified", "  keeping at_once, soon"]
    assert coq_answer(certify, tmp_path / "one", guarded) == (0, properties + guard)


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("r3 1 q0 k1.q1 rests d0\nahead r3 1.1 g0 d0\n", "", "r2: no answer to a message on /scan"),
        ("r2 1 q0 k0.q0", "r2 1 q0 waits", "r3: it may not rest after stop ahead"),
        ("r1 0 waits waits", "r1 1 waits waits", "r0: no answer to a message on /scan"),
        ("k0.q0 rests true", "k0.q0 rests d0", "r3: it may not rest after stop ahead"),
        (
            "r0 silent waits waits rests true",
            "r0 silent waits waits rests d0",
            "it may not rest in r0, where it starts",
        ),
        ("r0 silent waits waits rests true", "r0 silent waits waits rests true g0 true", "r0: it may not send here"),
        ("k1.q1 rests", "k0.q1 rests", "r2: no answer to a message on /scan"),
        ("k1 read running 0 running 0", "k1 read running 0 running 1", "r2: no answer to a message on /scan"),
        ("ahead r3 1.1 g0 d0\n", "", "r3: no answer to the passage of time"),
        ("ahead r3 1.1 g0 d0", "ahead r3 1.0 g0 d0", "r3: no answer to the passage of time"),
        ("g0 m0 stop a1 true", "g0 m0 stop a1 false", "r3: it may not rest after stop ahead"),
        ("g0 m0 stop a1 true", "g0 m0 stop a1 a0", "r3: it may not rest after stop ahead"),
        ("g0 m0 stop a1 true", "g0 m0 stop", "r3: it may not rest after stop ahead"),
        ("begins 1\nu1", "begins session\nu1", "r0: no answer to a message on /scan"),
        ("begins 1\nu1", "begins silent\nu1", "r0: no answer to a message on /scan"),
        ("begins 1\nd0", "begins 2\nd0", "r3: it may not rest after stop ahead"),
        ("n0 m0 new speed\n", "", "r2: no answer to a message on /scan"),
        ("a1 m0 speed", "a1 loose m0 speed", "r3: it may not rest after stop ahead"),
        ("assumption true", "assumption false", "nothing is found that its assumption allows"),
        ("\nq1 violated q1\nd0 a0", "\nq1 violated q0\nd0 a0", "at_once is not"),
    ],
)
def test_the_checker_from_coq_says_what_is_wrong_with_a_changed_guard(
    certify: Path, tmp_path: Path, guarded: str, old: str, new: str, reason: str
) -> None:
    assert guarded.count(old) == 1
    code, lines = coq_answer(certify, tmp_path / "one", guarded.replace(old, new))
    assert (code, lines[2]) == (1, f"guard /cmd_vel_raw to /cmd_vel: not certified: {reason}")


def test_a_guard_relies_on_what_it_assumes(certify: Path, tmp_path: Path, guarded: str) -> None:
    """That what is near has been answered in time is then for others to see to."""
    text = guarded.replace("u1 keeps", "u1 assumes").replace("ahead r3 1.1 g0 d0\n", "")
    code, lines = coq_answer(certify, tmp_path / "one", text)
    assert (code, lines[2:]) == (
        0,
        ["guard /cmd_vel_raw to /cmd_vel: certified", "  keeping at_once", "  relying on soon"],
    )


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("guards 1", "guards 2", None),
        ("\nend\n", "\n", None),
        ("m1 /scan", "m2 /scan", "m2 /scan"),
        ("a1 m0 speed", "a1 m2 speed", "a1 m2 speed <= 0.2"),
        ("a1 m0 speed <= 0.2", "a1 m0 min(scan) < 0.5", "a1 m0 min(scan) < 0.5"),
        ("g0 m0", "g0 m1", "g0 m1 stop a1 true"),
        ("stop a1 true", "stop a1 maybe", "g0 m0 stop a1 maybe"),
        ("keeps 1 begins", "keeps 2 begins", "u1 keeps 2 begins 1"),
        ("begins 1\nd0", "begins 1,0\nd0", "u1 keeps 1 begins 1,0"),
        ("r2 1 q0 k0.q0", "r2 1 q0 q0", "r2 1 q0 q0 rests true"),
        ("r2 1 q0 k0.q0", "r2 1 q0", "r2 1 q0 rests true"),
        ("r2 1 q0 k0.q0", "r2 1 k0.q0 k0.q0", "r2 1 k0.q0 k0.q0 rests true"),
        ("r2 1 q0 k0.q0", "r2 1 q0 k0.q7", "r2 1 q0 k0.q7 rests true"),
        ("ahead r3 1.1 g0", "ahead r3 1.2 g0", "ahead r3 1.2 g0 d0"),
        ("ahead r3 1.1 g0", "ahead r3 g0", "ahead r3 g0 d0"),
        ("ahead r3 1.1 g0", "ahead r4 1.1 g0", "ahead r4 1.1 g0 d0"),
        ("lead 10000000", "lead soon", "lead soon"),
        ("k1 read", "x1 read", "x1 read running 0 running 0"),
    ],
)
def test_a_line_that_a_guard_cannot_have_is_named(
    certify: Path, tmp_path: Path, guarded: str, old: str, new: str, line: str | None
) -> None:
    before, found, after = guarded.rpartition(old)
    assert found
    text = f"{before}{new}{after}"
    lines = text.split("\n")
    assert coq_answer(certify, tmp_path / "one", text) == (2, [f"line {1 + lines.index(line) if line else len(lines)}"])


def timed_text(seed: int) -> str:
    """The certificate of a random property with bounds or a past, in an encoding that has a clock for each bound."""
    property_ = Draw(seed).property(depth=1 + seed % 2)
    for encoding in (list(ENCODINGS.values())[seed % len(ENCODINGS)], EPISODE):
        with suppress(ManyClocksError):
            alphabet = Alphabet(ordinary_atoms(encode(property_, encoding)))
            return to_text([entry("any", property_, encoding, alphabet)])
    raise AssertionError(property_)


def test_both_checkers_accept_certificates_of_random_properties_with_clocks(certify: Path, tmp_path: Path) -> None:
    answers: Counter[str] = Counter()
    programs = 0
    for seed in range(tried := share_of(80)):
        text = timed_text(seed)
        code, lines = coq_answer(certify, tmp_path / "one", text)
        assert (code, lines) == python_answer(text)
        answers.update(lines)
        programs += "\npair s" in text
    assert answers["  its program follows the monitor"] == programs > 0.85 * tried
    exactly, over_words = answers["any: certified exactly"], answers[f"any: {OVER_WORDS}"]
    assert exactly > 0.35 * tried
    assert over_words > 0.1 * tried
    assert exactly + over_words + answers["any: certified"] == tried
    assert exactly + over_words > 0.85 * tried


def altered(text: str, chance: random.Random) -> str:
    """The text with one or two words exchanged for others of their sort: it is still a certificate, often."""
    lines = text.splitlines()
    body = [n for n, line in enumerate(lines) if n > 3 and " " in line and not line.startswith("#")]
    for _ in range(chance.randint(1, 2)):
        here = chance.choice(body)
        first, *words = lines[here].split(" ")
        place = chance.randrange(len(words))
        words[place] = another(words[place], chance)
        lines[here] = " ".join([first, *words])
    return "\n".join(lines) + "\n"


ALIKE = (
    ("read", "unread"),
    ("idle", "first", "held", "always"),
    ("violated", "presumably_violated", "presumably_satisfied", "satisfied"),
    ("not", "next"),
    ("and", "or", "until", "since"),
    ("always", "never", "eventually", "not"),
    ("once", "historically", "previously"),
    ("running", "begun"),
)


def another(word: str, chance: random.Random) -> str:
    """A word of the sort of `word`."""
    alike = [words for words in ALIKE if word in words]
    if alike:
        return chance.choice(chance.choice(alike))
    digits = len(word) - len(word.rstrip("0123456789"))
    if not digits:
        return word
    start, number = word[:-digits], int(word[-digits:])
    return f"{start}{max(0, number + chance.choice((-2, -1, 1, 2)))}"


def test_both_checkers_say_the_same_of_changed_certificates_of_properties_with_clocks(
    certify: Path, tmp_path: Path
) -> None:
    answers: Counter[int] = Counter()
    for seed in range(share_of(50)):
        text, chance = timed_text(seed), random.Random(seed)
        for change in [altered] * 12 + [mangled] * 4:
            changed = change(text, chance)
            answer = python_answer(changed)
            assert coq_answer(certify, tmp_path / "one", changed) == answer, changed
            answers[answer[0]] += 1
    assert min(answers[code] for code in (0, 1, 2)) > share_of(20)


CLOCK_IN_PREDICATE = """ltlc-certificate 1
properties 1
property p
line 1
encoding episode
a0 more than 3 ns since the beginning
f0 a0
f1 not f0
f2 and f1 f0
f3 true
p0 now f0
p1 within 3 p0
subject p1
formula f2
assumption f3
q0 violated q0
end
"""
NO_SUCH_CLOCK = """ltlc-certificate 1
properties 1
property p
line 1
encoding episode
a0 a
f0 a0
f1 not f0
f2 true
f3 until f2 f1
f4 not f3
p0 now f0
p1 always p0
subject p1
formula f4
assumption f2
q0 violated q0
dead f4 clock 7
end
"""
(PAST,) = re.findall(r"^(f[0-9]+) a2$", TIMED, flags=re.MULTILINE)


@pytest.mark.parametrize(
    "text",
    [
        CLOCK_IN_PREDICATE,
        CLOCK_IN_PREDICATE.replace("subject p1", "p2 and p0 p1\nsubject p2"),
        NO_SUCH_CLOCK,
        re.sub("assumption f[0-9]+", f"assumption {PAST}", TIMED),
        re.sub("^q0 [a-z_]+", "q0 violated", TIMED, count=1, flags=re.MULTILINE),
        TIMED.replace("once f0 2000000000", "once f0"),
    ],
    ids=[
        "a clock in a predicate",
        "a clock beside its bound",
        "no such clock",
        "an assumption about the past",
        "a wrong verdict",
        "without a bound",
    ],
)
def test_both_checkers_refuse_what_is_wrong_about_time(certify: Path, tmp_path: Path, text: str) -> None:
    code, lines = python_answer(text)
    assert coq_answer(certify, tmp_path / "one", text) == (code, lines)
    assert code != 0


def certificates_of(some: Sequence[Case]) -> str:
    return to_text({case.entry.label: case.entry for case in some}.values())


def test_the_table_of_judged_cases_is_what_the_extracted_judge_says(certify: Path, tmp_path: Path) -> None:
    some = [*cases()]
    certificates = certificates_of(some)
    document = evidence((case.claim for case in some), certificates)
    _, *table = JUDGED_TABLE.read_text(encoding="utf-8").splitlines()
    assert judged(certify, tmp_path, certificates, document) == (1, table)


def test_both_judges_say_the_same_of_claims_that_are_not_in_the_table(certify: Path, tmp_path: Path) -> None:
    some = [*cases(range(500, 540), 20)]
    certificates = certificates_of(some)
    document = evidence((case.claim for case in some), certificates)
    assert judged(certify, tmp_path, certificates, document) == (1, [*map(answer, some)])
    right = [case for case in some if answer(case).endswith("as claimed")]
    assert len(right) > 20
    document = evidence((case.claim for case in right), certificates)
    assert judged(certify, tmp_path, certificates, document) == (0, [*map(answer, right)])


def is_certified(each: Entry) -> bool:
    return not python_said(each).startswith("not certified")


def test_both_judges_say_the_same_by_changed_certificates(certify: Path, tmp_path: Path) -> None:
    answers: Counter[bool] = Counter()
    for seed in range(600, 640):
        chance = random.Random(seed)
        try:
            (changed,) = parse(text := altered(to_text([drawn(seed)]), chance))
        except UnreadableError:
            continue
        some = [Case(random_claim(changed, chance), changed) for _ in range(5)]
        found = is_certified(changed)
        said = [answer(c) if found else f"{changed.label}: REFUSED: its monitor is not certified" for c in some]
        assert judged(certify, tmp_path, text, evidence((case.claim for case in some), text))[1] == said
        answers[found] += 1
    assert min(answers.values()) > 5


def small_document() -> tuple[str, str]:
    """Certificates, and a document that is right."""
    case = next(case for case in cases() if answer(case).endswith("as claimed"))
    certificates = certificates_of([case])
    return certificates, evidence([case.claim], certificates)


def test_the_extracted_judge_notices_every_byte_that_is_changed(certify: Path, tmp_path: Path) -> None:
    certificates, document = small_document()
    assert judged(certify, tmp_path, certificates, document)[0] == 0
    for place, old in enumerate(document):
        new = "1" if old == "0" else "0"
        by = new if place % 4 else ""
        assert judged(certify, tmp_path, certificates, document[:place] + by + document[place + 1 :])[0] != 0


def edits(claim: Claim) -> Iterator[Claim]:
    """The claim with other scopes, slices or verdicts."""
    yield replace(claim, verdict=Verdict.PRESUMABLY_VIOLATED)
    if claim.scopes:
        [first, *others] = claim.scopes
        yield replace(claim, scopes=(first._replace(number=first.number + 1), *others))
        assert not isinstance(claim.letters, Summed)
        scope = len(claim.atoms)
        for n, line in enumerate(claim.letters):
            flipped = line._replace(atoms=tuple(sorted({*line.atoms} ^ {scope})))
            yield replace(claim, letters=(*claim.letters[:n], flipped, *claim.letters[n + 1 :]))
    for n, each in enumerate(claim.slices):
        before, after = claim.slices[:n], claim.slices[n + 1 :]
        yield replace(claim, slices=(*before, *after))
        yield replace(claim, slices=(*before, each, each, *after))
        yield replace(claim, slices=(*before, replace(each, verdict=Verdict.PRESUMABLY_VIOLATED), *after))
        yield replace(claim, slices=(*before, replace(each, until=each.until - 1, decided=each.until - 1), *after))


def test_both_judges_say_the_same_of_scopes_and_slices_that_are_edited(certify: Path, tmp_path: Path) -> None:
    text, answers = specification([*OPENINGS, *SLICES]), Counter[bool]()
    bag = write_bag(tmp_path / "bag", random_rows(random.Random(4)))
    said_of(evidence_of(text, bag), bag, fill=tmp_path / "filled")
    filled = parsed((tmp_path / "filled").read_text(encoding="utf-8"))
    assert isinstance(filled, Document)
    entries = entries_of(text)
    certificates = to_text([*entries.values()])
    head = replace(filled.head, certificates=digest(certificates))
    claims = [each for each in filled.properties if isinstance(each, Claim)]
    assert judged(certify, tmp_path, certificates, printed(Document(head, tuple(claims))))[0] == 0
    for claim in (edit for each in claims for edit in edits(each)):
        document = Document(head, (claim,))
        [found] = checked(document, judge_of(text).specification, entries, Read(("",), document))
        is_right = found.checks[0].refusal is None
        assert judged(certify, tmp_path, certificates, printed(document))[0] == (0 if is_right else 1), claim
        answers[is_right] += 1
    assert answers[False] > 40


def test_the_extracted_judge_takes_no_other_certificates_than_those_that_are_named(
    certify: Path, tmp_path: Path
) -> None:
    certificates, document = small_document()
    code, said = judged(certify, tmp_path, certificates + "# the same\n", document)
    assert (code, said[0]) == (1, "REFUSED: the certificates are not those that the evidence names")


def test_the_extracted_judge_reads_evidence_of_several_recordings(certify: Path, tmp_path: Path) -> None:
    certificates, document = small_document()
    code, said = judged(certify, tmp_path, certificates, document * 3)
    assert (code, len(said)) == (0, 3)
    assert judged(certify, tmp_path, certificates, document + document[:-1])[0] == 2


MEASURED = """From Coq Require Import List ZArith.
Import ListNotations.
Require Import Properties Robustness Bands.
Definition at_instants (rows : list (list margin)) k a := nth a (nth k rows []) Lowest.
"""


def in_coq(part: Property | Formula, atoms: Sequence[str]) -> str:
    """A term of Coq, whose constructors have the names of the classes here."""
    match part:
        case Atom(name):
            return f"(PAtom {atoms.index(name)})"
        case Within(duration, body):
            return f"(Within 0 {duration} {in_coq(body, atoms)})"
        case _:
            parts = (in_coq(getattr(part, name), atoms) for name in part.__match_args__)
            return f"({'P' * isinstance(part, Formula)}{type(part).__name__} {' '.join(parts)})"


def margin_in_coq(found: float) -> str:
    """All that are drawn are halves."""
    return f"(Finite ({int(found * 2)}))" if math.isfinite(found) else "Highest" if found > 0 else "Lowest"


def has_interval(property_: Property) -> bool:
    """Whether there is one inside it, which is no property of Coq."""
    return any(has_interval(each) or (isinstance(each, Within) and each.start > 0) for each in children(property_))


def measured_in_coq(seed: int) -> Iterator[str]:
    """What Python says of the beginning of a run, as equations in Coq: its robustness, and what is still possible."""
    property_, steps, until, past, seen = measured_run(seed)
    if has_interval(property_):
        return
    chance = random.Random(seed)
    if seed % 3 == 0 and not (isinstance(property_, Within) and property_.start):
        property_ = Within(5, property_, chance.randrange(1, 4))
    count = chance.randrange(1, len(steps) + 1)
    steps, until = steps[:count], steps[count].time if count < len(steps) else until
    news = {each.name for part in predicates(property_) for each in atoms_within(part) if isinstance(each, News)}
    run = with_past(held(steps, until, news), past, seen.session)
    atoms = sorted(run[0].margins)
    rows = "; ".join(f"[{'; '.join(margin_in_coq(each.margins[a]) for a in atoms)}]" for each in run)
    times = "; ".join(str(each.time - run[0].time) for each in run)
    of = f"(at_instants [{rows}]) (fun k => nth k [{times}] 0) {len(run)}"
    yield equation(of, "None", property_, atoms, robustness(run, property_))
    margins = {name: np.array([step.margins[name] for step in steps]) for name in steps[0].margins}
    line = Timeline(np.array([step.time for step in steps]), until)
    with suppress(UnsupportedError):
        low, high = still_possible(property_, line, margins, dict.fromkeys(news, seen.session))
        yield equation(of, "(Some Lowest)", property_, atoms, low)
        yield equation(of, "(Some Highest)", property_, atoms, high)


def equation(run: str, future: str, property_: Property, atoms: Sequence[str], found: float) -> str:
    """That this is what is `found`."""
    text = in_coq(property_, atoms)
    term = f"still_possible {run} {future} {text} never_ends false 0"
    if isinstance(property_, Within) and property_.start:
        enough = str(robustness((), property_.body) > 0).lower()
        bounds = f"{property_.start} {property_.duration - property_.start}"
        term = f"possible_interval {run} {future} {enough} {bounds} {in_coq(property_.body, atoms)} never_ends 0"
    elif future == "None":
        term = f"robustness {run} {text} never_ends false 0"
    return f"Goal {term} = {margin_in_coq(found)}. Proof. vm_compute. reflexivity. Qed."


def test_by_how_much_a_run_holds_and_what_is_still_possible_is_what_coq_says(certify: Path) -> None:
    drawn = [equation for seed in range(share_of(900)) for equation in measured_in_coq(seed)]
    assert sum("(Some Highest)" in each for each in drawn) > len(drawn) / 5
    assert sum("possible_interval" in each for each in drawn) > len(drawn) / 10
    folder = certify.parent.parent
    (folder / "Measured.v").write_text(MEASURED + "\n".join(drawn), encoding="utf-8")
    checked = subprocess.run(["coqc", "-q", "Measured.v"], cwd=folder, capture_output=True, text=True, check=False)
    assert checked.returncode == 0, checked.stderr
