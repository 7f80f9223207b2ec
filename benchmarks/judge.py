"""The judges of evidence, measured: CPU time a line, and memory, of the one from Coq and of the one in Python.

    make -C proofs && python -m benchmarks.judge [lines]

The one in Python gets a million of these lines at most.

The property has a bound and an operator of the past; every other letter is held beyond both, so that its line is cut.
"""

from __future__ import annotations

import hashlib
import re
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from itertools import chain, islice
from pathlib import Path

from ltlc.assurance.evidence.claims import refusal
from ltlc.assurance.evidence.document import Claim, Document, Head, Line, StatedAtom, digest, letters_text, printed
from ltlc.base.provenance import FileDigest
from ltlc.semantics.certificate_text import to_text
from ltlc.semantics.ltl import And, Atom
from ltlc.semantics.properties import Always, Eventually, Implies, Now, Within
from ltlc.semantics.timed_atoms import Once
from ltlc.semantics.verdicts import Verdict

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))
from test_semantics_certificate_text import entry

JUDGE = Path(__file__).parent.parent / "proofs" / "checker" / "judge"
SECOND = 10**9
IN_PYTHON = 10**6
NEAR, STOPPED = Atom("near"), Atom("stopped")
PROPERTY = Always(
    Implies(
        Now(And(NEAR, Once("once near within 3 s", NEAR, 3 * SECOND))),
        Within(2 * SECOND, Eventually(Now(STOPPED))),
    )
)


def lines(count: int) -> Iterator[Line]:
    """Near, and after a second stopped, again and again."""
    for number in range(count):
        pair, is_stopped = divmod(number, 2)
        yield Line((pair * 9 // 2 + 1) * SECOND + is_stopped * SECOND, (is_stopped,))


def judged(*names: Path) -> tuple[str, float, float]:
    """What the judge from Coq says, its seconds of CPU time, and the most megabytes that it took."""
    before, most = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime, 0
    with subprocess.Popen([JUDGE, *names], stdout=subprocess.PIPE, text=True) as process:
        status = Path(f"/proc/{process.pid}/status")
        while process.poll() is None:
            found = re.search(r"VmHWM:\s+(\d+) kB", status.read_text())
            most = int(found[1]) if found else most
            time.sleep(0.01)
        assert process.stdout is not None
        said = process.stdout.read()
    return said, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before, most / 1000


def write(path: Path, document: Document, found: Iterator[Line]) -> int:
    """Write a document, with these lines in its only claim, piece by piece; the length of its text."""
    before, word, after = printed(document).rpartition("end sha256 ")[0].partition("until ")
    sha256, length, texts = hashlib.sha256(), 0, letters_text(found)
    pieces = iter(lambda: "".join(islice(texts, 1 << 16)), "")
    with path.open("w", encoding="utf-8") as file:
        for text in chain([before], pieces, [word + after]):
            sha256.update(text.encode())
            length += file.write(text)
        file.write(f"end sha256 {sha256.hexdigest()}\n")
    return length


def claimed(count: int, letters: tuple[Line, ...] = ()) -> Claim:
    """What is claimed of a run with so many lines."""
    until = (((count - 1) // 2 * 9) // 2 + 2 + (count - 1) % 2) * SECOND
    atoms = (StatedAtom("near", {}), StatedAtom("stopped", {}))
    return Claim("response", "response", atoms, 0, letters, until, Verdict.PRESUMABLY_SATISFIED, until)


def main(count: int) -> None:
    of = entry("response", PROPERTY)
    certificates, file = to_text([of]), FileDigest("run.mcap", 1, "0" * 64)
    head = Head("1", ("props.txt", "0" * 64), digest(certificates), (file,))
    with tempfile.TemporaryDirectory() as folder:
        names = [Path(folder) / name for name in ("certificates", "evidence")]
        names[0].write_text(certificates, encoding="utf-8")
        length = write(names[1], Document(head, (claimed(count),)), lines(count))
        said, seconds, megabytes = judged(*names)
    assert said.endswith(", as claimed\n"), said
    print(f"{count:,} lines, {length / 1e6:.1f} MB of text")
    print(f"from Coq: {seconds / count * 1e6:.2f} µs of CPU time a line, {megabytes:.1f} MB")
    some = min(count, IN_PYTHON)
    found, start = tuple(lines(some)), time.process_time()
    assert refusal(claimed(some), found, of) is None
    print(f"in Python: {(time.process_time() - start) / some * 1e6:.1f} µs of CPU time a line, without reading")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000)
