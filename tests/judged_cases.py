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
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from test_semantics_certificate_text import entry
from timed import ARRIVAL, MARK, Draw, X, Y, ordinary_atoms

from ltlc.assurance.evidence.claims import refusal
from ltlc.assurance.evidence.counting import stated_count
from ltlc.assurance.evidence.document import Claim, Document, Head, Line, StatedAtom, Summed, digest, printed
from ltlc.base.provenance import FileDigest
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.certificate_reader import UnreadableError, parse
from ltlc.semantics.certificate_text import Entry, to_text
from ltlc.semantics.encodings import EPISODE, encode
from ltlc.semantics.intervals import without_intervals
from ltlc.semantics.ltl import And, Formula, Not
from ltlc.semantics.properties import After
from ltlc.semantics.timed_atoms import News, Occurred, TimedAtom, atoms_within, news_of
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
    """The certificate of a random property with bounds and the past; of every third, not all letters exist.

    Every fifth is of instances.
    """
    property_ = Draw(seed).property(depth=1 + seed % 2)
    if seed % 5 == 4:
        draw = Draw(seed)
        bodies = (draw.property(depth=0) for _ in range(100))
        property_ = After(MARK, next(each for each in bodies if without_intervals(each) == each))
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


def drawn_counts(of: Entry, chance: random.Random) -> tuple[Occurred, ...]:
    """An atom of the certificate is a count of the others; none, if it has no such atom."""
    if "z" not in atoms_of(of):
        return ()
    some: list[Formula] = [X, Not(Y), And(X, Y), ARRIVAL, And(ARRIVAL, X), Y]
    operand = chance.choice(some)
    within = chance.choice((None, 1, 2, 4))
    is_presumed = within is not None and chance.random() < 1 / 3
    return (Occurred("z", operand, chance.randint(1, 3), within, not news_of(operand), is_presumed),)


def names_of(of: Entry, counts: Sequence[Occurred] = ()) -> tuple[str, ...]:
    """The names of the atoms that evidence needs, if some of those of the certificate are counts of others."""
    counted = (atom.name for count in counts for atom in atoms_within(count.operand))
    found = dict.fromkeys((*atoms_of(of), *counted))
    return tuple(name for name in found if name not in {count.name for count in counts})


def claim(
    of: Entry, session: int, lines: Sequence[Line], until: int, verdict: Verdict, counts: Sequence[Occurred] = ()
) -> Claim:
    """A claim about a run with these letters, made at its end."""
    names = names_of(of, counts)
    stated = tuple(StatedAtom(name, {}) for name in names)
    counted = tuple(stated_count(count, {name: n for n, name in enumerate(names)}) for count in counts)
    return Claim(
        of.label,
        "drawn",
        stated,
        session,
        tuple(lines),
        until,
        verdict,
        until,
        counts=counted,
        opens=names.index(MARK.name) if MARK.name in names else None,
    )


def random_claim(of: Entry, chance: random.Random) -> Claim:
    """A claim about any lines, true or not: times may go back, and letters may be none that exist."""
    time, lines = chance.choice((5, 10**18)), list[Line]()
    counts = drawn_counts(of, chance) if chance.random() < 1 / 2 else ()
    session = time - chance.randint(0, 3)
    for _ in range(chance.randint(1, 7)):
        held = tuple(n for n in range(len(names_of(of, counts))) if chance.random() < 1 / 2)
        lines.append(Line(time, held))
        time += chance.choice((0, 0, 1, 1, 2, 3, 5))
    until = time if chance.random() < 0.95 else lines[-1].time - 1
    some = lines if chance.random() < 0.98 else ()
    found = claim(of, session, some, until, chance.choice([*Verdict, *SOME, *SOME, *SOME]), counts)
    return found if chance.random() < 0.9 or not names_of(of) else replace(found, opens=chance.choice((None, 0)))


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
