"""`ltlc certify --evidence`: evidence passes if all three checks accept it; whatever is forged is refused by one."""

from __future__ import annotations

import hashlib
import random
from collections import Counter
from pathlib import Path

import pytest
from bag_support import Sent, made, mcap
from effort import share_of
from quick_gate import quick_gate

from ltlc import cli
from ltlc.assurance.evidence.certified import certificates
from ltlc.assurance.evidence.claims import refusal
from ltlc.assurance.evidence.document import END, Claim, NotCovered, Summed
from ltlc.assurance.evidence.parsing import UnreadableEvidence, parsed
from ltlc.base.limits import Budget
from ltlc.frontend.language import read_source
from ltlc.interfaces.api.prepare import prepare
from ltlc.monitoring.judging.evidence import evidence_by
from ltlc.monitoring.judging.run import Judge
from ltlc.semantics.certificate_reader import parse
from ltlc.semantics.encodings import EPISODE
from ltlc.semantics.verdicts import Verdict

FLOAT = "std_msgs/msg/Float64"
SECOND = 10**9
START = 1_700_000_000 * SECOND
PROPERTIES = """\
decl v /v Float64.data
decl w /w Float64.data
slow: never v > 2
react: always (v > 1 implies eventually w < 1 within 2 s)
stays: always (new v implies not previously new v)
"""


def sent(*values: tuple[float, str, float]) -> list[Sent]:
    """Messages: seconds since the start, a topic and its number."""
    return [Sent(topic, FLOAT, START + round(at * SECOND), made(FLOAT, data=value)) for at, topic, value in values]


DRIVE = sent((0, "/v", 0.5), (0.5, "/w", 3.0), (1, "/v", 1.5), (2, "/w", 0.5), (3, "/v", 2.5), (3.5, "/w", 0.25))


class Made:
    """A specification, its certificates, a recording and the evidence of it, in a folder."""

    def __init__(self, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
        self.capsys = capsys
        self.properties, self.certificates = folder / "props.txt", folder / "props.cert"
        self.recording, self.evidence = folder / "drive.mcap", folder / "drive.evidence"

    def make(self, properties: str = PROPERTIES, drive: list[Sent] = DRIVE) -> None:
        self.properties.write_text(properties, encoding="utf-8")
        mcap(self.recording, drive)
        output = str(self.properties.with_suffix(".json"))
        to = ["--certificate", str(self.certificates)]
        with quick_gate():
            assert cli.main(["build", str(self.properties), "--target", "json", "-o", output, *to, "-q"]) == 0
        self.run()

    def run(self) -> None:
        arguments = [str(self.properties), str(self.recording), "--evidence", str(self.evidence), "-q"]
        assert cli.main(["run", *arguments]) in (0, 1, 3)

    def certify(self, *arguments: str) -> tuple[int, list[str], str]:
        """The exit code, what is reported of the evidence, and what is on stderr."""
        self.capsys.readouterr()
        code = cli.main(["certify", str(self.properties), *arguments])
        out, errors = self.capsys.readouterr()
        return code, out.partition("evidence of ")[2].splitlines(), errors

    def check(self) -> tuple[int, list[str]]:
        arguments = [str(self.certificates), "--evidence", str(self.evidence), str(self.recording), "-q"]
        return self.certify(*arguments)[:2]

    def forge(self, old: str, new: str) -> None:
        """The evidence with another text in it, and the digest set right."""
        text = self.evidence.read_text(encoding="utf-8")
        text = text[: text.index(END)]
        assert old in text
        text = text.replace(old, new, 1)
        self.evidence.write_text(f"{text}{END}{hashlib.sha256(text.encode()).hexdigest()}\n", encoding="utf-8")


@pytest.fixture(scope="module")
def files() -> dict[str, bytes]:
    """What is made of PROPERTIES and DRIVE, once it has been made."""
    return {}


@pytest.fixture
def drive(tmp_path: Path, capsys: pytest.CaptureFixture[str], files: dict[str, bytes]) -> Made:
    found = Made(tmp_path, capsys)
    if not files:
        found.make()
        files |= {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    for name, content in files.items():
        (tmp_path / name).write_bytes(content)
    return found


def test_every_claim_is_shown_by_all_three_checks_and_where_there_is_none_not_all_is_shown(drive: Made) -> None:
    code, lines, _ = drive.certify(str(drive.certificates), "--evidence", str(drive.evidence), str(drive.recording))
    assert code == 3
    assert lines[1:9] == [
        "slow: violated from 1700000003 s on",
        "  judge: the 2 lines have this verdict (evidence_of_lines)",
        "  recorded: the letters are as stated; instants: 3, lines: 2",
        "  specification: its text, requirement and atoms are the same",
        "react: presumably satisfied at 1700000003.5 s",
        "  judge: the 3 lines have this verdict (evidence_of_lines)",
        "  recorded: the letters are as stated; instants: 5, lines: 3",
        "  specification: its text, requirement and atoms are the same",
    ]
    assert (
        lines[9]
        == "stays: nothing is claimed: it asks what held a nanosecond ago of what changes while nothing happens"
    )
    assert "Not checked: that a property says what its requirement means" in lines[-2]


def test_certificates_that_are_omitted_are_made_anew(drive: Made) -> None:
    code, lines, _ = drive.certify("--evidence", str(drive.evidence), str(drive.recording), "-q")
    assert (code, lines[1:3]) == (
        3,
        ["slow: violated from 1700000003 s on", "react: presumably satisfied at 1700000003.5 s"],
    )


def test_without_the_recording_the_letters_are_not_checked(drive: Made) -> None:
    code, lines, _ = drive.certify("--evidence", str(drive.evidence), "-q")
    assert code == 3
    assert lines[1] == "slow: not completely checked: violated from 1700000003 s on"
    assert "  recorded: not checked: no recording of its name was given" in lines


@pytest.mark.parametrize(
    ("old", "new", "refused"),
    [
        ("verdict violated", "verdict satisfied", "  judge: REFUSED: the verdict is violated"),
        ("+3000000000 a0\n", "+2000000000\n+1000000000 a0\n", "  recorded: REFUSED"),
        ('["data"]},2.0]', '["data"]},2.25]', "  specification: REFUSED: `v > 2` is"),
        ("text never v > 2", "text never v > 3", "  specification: REFUSED: the specification says `never v > 2`"),
        ("never v > 2\n", "never v > 2\nverifies X-1\n", "  specification: REFUSED: the specification states another"),
        ("atom v > 2\n", "atom v > 9\n", "  judge: REFUSED: 'v > 2' is missing"),
    ],
)  # fmt: skip
def test_what_is_forged_is_refused(drive: Made, old: str, new: str, refused: str) -> None:
    drive.forge(old, new)
    code, lines = drive.check()
    assert code == 1
    assert any(line.startswith("slow: NOT shown") for line in lines)
    assert any(line.startswith(refused) for line in lines), lines


@pytest.mark.parametrize(
    ("old", "new", "refused"),
    [
        ("specification props.txt sha256 ", "0" * 64, "it is about a specification with another SHA-256"),
        ("certificates sha256 ", "0" * 64, "it names certificates with another SHA-256"),
        ("\n\nproperty slow", "\nrate 5.0\n\nproperty slow", "it has the rate 5.0, the specification None"),
        ("\n\nproperty slow", "\ntimeout 5\n\nproperty slow", "it has the timeout 5, the specification None"),
        ("property react", "property other", "it has `other` where the specification has `react`"),
    ],
)  # fmt: skip
def test_a_document_that_is_about_something_else_shows_nothing(drive: Made, old: str, new: str, refused: str) -> None:
    text = drive.evidence.read_text(encoding="utf-8")
    digest = text.partition(old)[2][:64] if old.endswith("sha256 ") else ""
    drive.forge(old + digest, old + new if digest else new)
    code, lines = drive.check()
    assert code == 1
    assert any(line.startswith("  REFUSED: ") and refused in line for line in lines), lines
    assert all("NOT shown" in line for line in lines if line.startswith(("slow", "react", "other")))


def test_another_recording_of_the_same_name_is_refused(drive: Made) -> None:
    mcap(drive.recording, [*DRIVE[:-1], *sent((3.5, "/w", 0.125))])
    code, lines = drive.check()
    assert code == 1
    assert sum(line.startswith("  recorded: REFUSED: ") and "drive.mcap" in line for line in lines) == 2


@pytest.mark.parametrize(("forge", "given", "code"), [(False, True, 3), (False, False, 3), (True, True, 1)])
def test_a_recording_of_which_nothing_is_claimed_is_looked_at_all_the_same(
    drive: Made, forge: bool, given: bool, code: int
) -> None:
    drive.make("decl v /v Float64.data\nalways (new v implies not previously new v)\n")
    if forge:
        drive.forge(hashlib.sha256(drive.recording.read_bytes()).hexdigest(), "0" * 64)
    arguments = ["--evidence", str(drive.evidence), *([str(drive.recording)] if given else []), "-q"]
    found, lines, _ = drive.certify(str(drive.certificates), *arguments)
    assert found == code
    assert (
        any(
            line.startswith("  REFUSED: no recording has the files, sizes and SHA-256 that are written: drive.mcap")
            for line in lines
        )
        == forge
    )


def test_a_recording_without_evidence_is_named_and_not_passed_over(drive: Made) -> None:
    other = drive.recording.with_name("other.mcap")
    mcap(other, DRIVE)
    arguments = ["--evidence", str(drive.evidence), str(drive.recording), str(other), "-q"]
    code, lines, _ = drive.certify(str(drive.certificates), *arguments)
    assert (code, lines[-1]) == (3, f"there is no evidence of {other}")


def test_what_is_reported_says_which_part_of_a_recording_was_judged(drive: Made) -> None:
    arguments = [str(drive.properties), str(drive.recording), "--until", "+2.5", "--evidence", str(drive.evidence)]
    assert cli.main(["run", *arguments, "-q"]) in (0, 1, 3)
    code, lines = drive.check()
    assert (code, lines[1:3]) == (
        3,
        ["  only up to 1700000002.5 s", "slow: presumably satisfied at 1700000002.5 s"],
    )


def test_a_byte_that_is_changed_makes_a_text_that_is_no_evidence(drive: Made) -> None:
    text = drive.evidence.read_text(encoding="utf-8")
    for place in range(0, len(text), 37):
        drive.evidence.write_text(
            text[:place] + ("1" if text[place] == "0" else "0") + text[place + 1 :], encoding="utf-8"
        )
        code, _, errors = drive.certify(str(drive.certificates), "--evidence", str(drive.evidence))
        assert (code, "drive.evidence:" in errors) == (2, True)


def test_letters_of_which_only_the_digest_is_stated_are_judged_as_they_are_in_the_recording(drive: Made) -> None:
    values = [(0.01 * n, "/v", 1.5 * (n % 2)) for n in range(3000)]
    drive.make(PROPERTIES.replace("decl w /w", "decl w /v"), sent(*values))
    document = parsed(drive.evidence.read_text(encoding="utf-8"))
    assert not isinstance(document, UnreadableEvidence)
    assert any(isinstance(each, Claim) and isinstance(each.letters, Summed) for each in document.properties)
    assert drive.check()[0] == 3
    code, lines, _ = drive.certify("--evidence", str(drive.evidence), "-q")
    assert code == 3
    assert any(line.startswith("  judge: not checked: only the digest") for line in lines)


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ([], "give CERTIFICATE, or evidence with --evidence"),
        (["--evidence", "none.evidence"], "none.evidence cannot be read"),
        (["--evidence", "props.txt"], "props.txt:1: expected `ltlc-evidence 2`"),
        (["--evidence", "drive.evidence", "missing/drive.mcap"], "missing/drive.mcap"),
    ],
)
def test_files_that_cannot_be_used_are_named(
    drive: Made, monkeypatch: pytest.MonkeyPatch, arguments: list[str], reason: str
) -> None:
    monkeypatch.chdir(drive.properties.parent)
    code, _, errors = drive.certify(*arguments)
    assert code == 2
    assert reason in errors


TIMED = """\
never p
eventually q
always (p implies eventually q)
always (p implies eventually q within 3 s)
always (p implies eventually q within 2 ns)
always eventually q within 4 s
always (p implies always q for 2 s)
always (p implies never q within 3 s)
within 5 s, eventually p
within 5 s, (eventually p and eventually q)
within [1 s, 4 s], eventually p
after_until p, q, eventually r
after_until p, q, eventually r within 2 s
after_until p, q, within 3 s, eventually r
after p, always (q implies eventually r within 2 s)
until r, always (p implies eventually q within 2 s)
after_until p, r, always (q implies eventually p within 1 s)
never (p and not once q within 3 s)
always (p implies historically q for 2 s)
never (p since q within 4 s)
eventually historically p for 3 s
always (p implies previously not p)
always (p and not previously p implies eventually q within 2 s)
always age(x) <= 3 s
always (new x implies p)
always (new x implies eventually p within 2 s)
always (once p within 2 s implies eventually q within 3 s)
after once p within 2 s, never historically q for 3 s
(after p, eventually q within 3 s) and (until r, never q)
within 6 s, after p, within 2 s, eventually q
(always (p implies eventually q within 2 s)) and (always (q implies eventually r within 3 s))
after_until p, q, after_until r, p, eventually q within 3 s
"""
HEAD = "decl x /x Float64.data\np = x > 2\nq = x < 1\nr = x >= 1 and x < 1.5 or x > 3\n"
GAPS = (0, 0, 1, 2, 3, SECOND // 2, SECOND, 2 * SECOND, 2 * SECOND + 1, 3 * SECOND, 3 * SECOND + 1, 5 * SECOND)


@pytest.mark.parametrize("rate", [None, 3])
def test_the_judge_finds_every_verdict_of_random_runs_of_all_operators(tmp_path: Path, rate: int | None) -> None:
    source, chance, verdicts = tmp_path / "props.txt", random.Random(5), Counter[Verdict]()
    of_rate = "" if rate is None else f"_rate_ = {rate}\n"
    source.write_text(of_rate + HEAD + "".join(f"c{n}: {line}\n" for n, line in enumerate(TIMED.splitlines())))
    prepared = prepare(read_source(source), [], EPISODE, Budget())
    by = evidence_by(prepared.compiled, prepared.specification, Budget())
    entries = {each.label: each for each in parse(certificates(prepared.compiled, Budget())[0])}
    judge = Judge(prepared.compiled, prepared.specification, evidence=by)
    for number in range(share_of(25)):
        time, messages = START, list[Sent]()
        for _ in range(chance.choice((1, 2, 5, 20, 60))):
            value = chance.choice((0.5, 1.2, 1.7, 2.5, 3.5, float("nan")))
            messages.append(Sent("/x", FLOAT, time, made(FLOAT, data=value)))
            time += chance.choice(GAPS)
        document = judge.judge(mcap(tmp_path / f"{number}.mcap", messages)).evidence
        assert document is not None
        for claim in document.properties:
            assert not isinstance(claim, NotCovered), claim
            assert not isinstance(claim.letters, Summed)
            assert refusal(claim, claim.letters, entries[claim.label]) is None, (claim, messages)
            verdicts[claim.verdict] += 1
    assert all(verdicts[verdict] > 10 for verdict in Verdict if verdict is not Verdict.NOT_STARTED)
