"""The judges of evidence, measured: CPU time a line, and memory, of the one from Coq and of the one in Python.

    make -C proofs && python -m benchmarks.judge [lines]

The property has a bound and an operator of the past; every other letter is held beyond both, so that its line is cut.
"""

from __future__ import annotations

import re
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from ltlc.assurance.evidence.claims import refusal
from ltlc.assurance.evidence.document import Claim, Document, Head, Line, StatedAtom, digest, printed
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


def main(count: int) -> None:
    of = entry("response", PROPERTY)
    certificates = to_text([of])
    found = tuple(lines(count))
    until = found[-1].time + SECOND
    atoms = (StatedAtom("near", {}), StatedAtom("stopped", {}))
    claim = Claim("response", "response", atoms, 0, found, until, Verdict.PRESUMABLY_SATISFIED, until)
    file = FileDigest("run.mcap", 1, "0" * 64)
    text = printed(Document(Head("1", ("props.txt", "0" * 64), digest(certificates), (file,)), (claim,)))
    with tempfile.TemporaryDirectory() as folder:
        names = [Path(folder) / name for name in ("certificates", "evidence")]
        for name, content in zip(names, (certificates, text), strict=True):
            name.write_text(content, encoding="utf-8")
        said, seconds, megabytes = judged(*names)
    assert said.endswith(", as claimed\n"), said
    print(f"{count:,} lines, {len(text) / 1e6:.1f} MB of text")
    print(f"from Coq: {seconds / count * 1e6:.2f} µs of CPU time a line, {megabytes:.1f} MB")
    start = time.process_time()
    assert refusal(claim, found, of) is None
    print(f"in Python: {(time.process_time() - start) / count * 1e6:.1f} µs of CPU time a line, without reading")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000)
