"""Evidence with random letters, for both judges; and the table that ties them, which is what the one from Coq says.

`data/judged_cases.txt` is made by

    python tests/judged_cases.py FOLDER
    proofs/checker/judge FOLDER/certificates FOLDER/evidence > tests/data/judged_cases.txt

After the first line, a line is what the judge says of one of the `cases`, in their order.
"""

from __future__ import annotations

import random
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from test_semantics_certificate_text import entry
from timed import Draw, ordinary_atoms

from ltlc.assurance.evidence.document import Claim, Document, Head, Line, StatedAtom, Summed, digest, printed
from ltlc.assurance.evidence.judge import refusal
from ltlc.base.provenance import FileDigest
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.certificate_reader import UnreadableError, parse
from ltlc.semantics.certificate_text import Entry, to_text
from ltlc.semantics.encodings import EPISODE, encode
from ltlc.semantics.timed_atoms import News, TimedAtom, atoms_within
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import letters_over

TABLE = Path(__file__).parent / "data" / "judged_cases.txt"
PROPERTIES = 120
CLAIMS = 10
"""Of each property."""

SOME = [verdict for verdict in Verdict if verdict is not Verdict.NOT_STARTED]
"""The verdicts of runs that have started."""


class Case(NamedTuple):
    """A claim, and the certificate that it names."""

    claim: Claim
    entry: Entry


def drawn(seed: int) -> Entry:
    """The certificate of a random property with bounds and the past; of every third, not all letters exist."""
    property_ = Draw(seed).property(depth=1 + seed % 2)
    atoms = ordinary_atoms(encode(property_, EPISODE))
    chance = random.Random(seed)
    letters = [*letters_over(atoms)]
    some = chance.sample(letters, chance.randint(2 * len(letters) // 3, len(letters)))
    groups = (Group(atoms, tuple(some)),) if atoms and seed % 3 == 0 else ()
    (read,) = parse(to_text([entry(f"p{seed}", property_, alphabet=Alphabet(atoms, groups))]))
    return read


def atoms_of(of: Entry) -> tuple[str, ...]:
    """The names of the atoms that evidence needs for a certificate: of those that nothing defines, and of news."""
    defined = {
        atom.name: isinstance(atom, News)
        for atom in atoms_within(of.certificate.formula)
        if isinstance(atom, TimedAtom)
    }
    return tuple(name for name in of.certificate.monitor.atoms if defined.get(name, True))


def claim(of: Entry, session: int, lines: Sequence[Line], until: int, verdict: Verdict) -> Claim:
    """A claim about a run with these letters, made at its end."""
    stated = tuple(StatedAtom(name, {}) for name in atoms_of(of))
    return Claim(of.label, "drawn", stated, session, tuple(lines), until, verdict, until)


def random_claim(of: Entry, chance: random.Random) -> Claim:
    """A claim about any lines, true or not: times may go back, and letters may be none that exist."""
    time, lines = chance.choice((5, 10**18)), []
    session = time - chance.randint(0, 3)
    for _ in range(chance.randint(1, 7)):
        held = tuple(n for n in range(len(atoms_of(of))) if chance.random() < 1 / 2)
        lines.append(Line(time, held))
        time += chance.choice((0, 0, 1, 1, 2, 3, 5))
    until = time if chance.random() < 0.95 else lines[-1].time - 1
    return claim(
        of, session, lines if chance.random() < 0.98 else (), until, chance.choice([*Verdict, *SOME, *SOME, *SOME])
    )


def cases(seeds: Iterable[int] = range(PROPERTIES), claims: int = CLAIMS) -> Iterator[Case]:
    """Random claims about random properties, but for those that are too large to be read."""
    for seed in seeds:
        with suppress(UnreadableError):
            of, chance = drawn(seed), random.Random(seed)
            yield from (Case(random_claim(of, chance), of) for _ in range(claims))


def evidence(claims: Iterable[Claim], certificates: str) -> str:
    """The document with these claims."""
    file = FileDigest("run.mcap", 1, "0" * 64)
    return printed(Document(Head("1.0", ("props.txt", "0" * 64), digest(certificates), (file,)), tuple(claims)))


def answer(case: Case) -> str:
    """What the judge in Python finds, in the words of the one from Coq."""
    stated, lines = case.claim, case.claim.letters
    assert not isinstance(lines, Summed)
    why = refusal(stated, lines, case.entry)
    if why is not None:
        return f"{stated.label}: REFUSED: {why}"
    if stated.verdict is Verdict.NOT_STARTED:
        return f"{stated.label}: not_started, as claimed"
    return f"{stated.label}: {stated.verdict.value} from {stated.decided} on, as claimed"


if __name__ == "__main__":
    drawn_cases = [*cases()]
    text = to_text({case.entry.label: case.entry for case in drawn_cases}.values())
    folder = Path(sys.argv[1])
    (folder / "certificates").write_text(text, encoding="utf-8")
    (folder / "evidence").write_text(evidence((case.claim for case in drawn_cases), text), encoding="utf-8")
